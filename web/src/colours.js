// Colours of faces. The scales are those of `laves view`.

const parse = (hex) => [parseInt(hex.slice(1, 3), 16), parseInt(hex.slice(3, 5), 16), parseInt(hex.slice(5, 7), 16)];

const SCORE = [[0, "#8c1c3a"], [0.3, "#d9482f"], [0.5, "#f2a541"], [0.7, "#f4e3a1"], [0.85, "#8cc5b4"], [1, "#3d7ea6"]];
const SIGNED = [[0, "#2c6aa8"], [0.35, "#9cc4e0"], [0.5, "#f3f0e8"], [0.65, "#eeb086"], [1, "#b23a2e"]];
export const SURFACE = "#8fb8dc", LAYER = "#e58f7b", TILE = "#ffd070", BCC = "#9fc66d", NEUTRAL = "#b9bdc4";
const GROUPS = ["#ffd070", "#9fc66d", "#e58f7b", "#b79ad6", "#6fc3c0", "#d9b48f", "#8fb8dc", "#e3a5c7", "#c9c46a", "#8d9ad0"];

export const groupColour = (index) => GROUPS[index % GROUPS.length];

function at(stops, value) {
  const v = Math.max(0, Math.min(1, value));
  let k = 0;
  while (k < stops.length - 2 && v > stops[k + 1][0]) k++;
  const t = (v - stops[k][0]) / (stops[k + 1][0] - stops[k][0]), low = parse(stops[k][1]), high = parse(stops[k + 1][1]);
  return [0, 1, 2].map((i) => Math.round(low[i] + t * (high[i] - low[i])));
}

const table = (stops) => Array.from({ length: 256 }, (_, i) => at(stops, i / 255));
const SCORES = table(SCORE), SIGNS = table(SIGNED);
const inTable = (colours, value) => colours[value > 0 ? (value < 1 ? Math.round(255 * value) : 255) : 0];

// 1 when all angles lie in [60, 75] degrees, 0 when flat.
export const dihedralScore = (least, most) => Math.min(least / 60, (180 - most) / 105);
// 1 for the regular tetrahedron, 0 from three times its value on.
export const edgeScore = (value) => (3 - value) / 2;

const CLASSES = [parse(LAYER), parse(TILE), parse(BCC)];
const neutral = parse(NEUTRAL), surface = parse(SURFACE);
const groups = GROUPS.map(parse);

// A function from an index into `side` (arrays of values, one of each tetrahedron) to a colour. `face`: of the boundary, or -1.
export function colourer(by, side, model) {
  const reach = Math.max(...model.facts.embedded.distance_range.map(Math.abs)) || 1;
  switch (by) {
    case "dihedral":
      return (t) => inTable(SCORES, dihedralScore(side.minDihedral[t], side.maxDihedral[t]));
    case "radius_ratio":
      return (t) => inTable(SCORES, side.radiusRatio[t]);
    case "radius_edge":
      return (t) => inTable(SCORES, edgeScore(side.radiusEdge[t]));
    case "distance":
      return (t, face) => (face < 0 ? neutral : inTable(SIGNS, 0.5 + (0.5 * model.distances[face]) / reach));
    case "region":
      return (t) => groups[(side.regions ? side.regions[t] : 0) % groups.length];
    case "tag":
      return (t, face) => (face < 0 ? neutral : groups[(model.tags ? model.tags[face] : 0) % groups.length]);
    default:
      return (t, face) => (face < 0 ? CLASSES[side.classes[t]] : surface);
  }
}

const gradient = (stops) => `linear-gradient(90deg, ${stops.map(([p, c]) => `${c} ${100 * p}%`).join(", ")})`;

// What the colours mean: either named swatches, or a bar with words at its ends.
export function legend(by, facts, format) {
  const scale = (low, high, stops = SCORE) => ({ gradient: gradient(stops), low, high });
  const reach = Math.max(...facts.embedded.distance_range.map(Math.abs));
  const named = (list, what) => list.map((g, i) => [groupColour(i), g.name ?? `${what} ${g.number}`, g.count]);
  switch (by) {
    case "dihedral":
      return scale("flat", "60° to 75°");
    case "radius_ratio":
      return scale("0", "1, regular");
    case "radius_edge":
      return scale("3 and more", "1, regular");
    case "distance":
      return scale(`${format(-reach)} inside`, `${format(reach)} outside`, SIGNED);
    case "region":
      return { swatches: named(facts.regions, "region") };
    case "tag":
      return { swatches: named(facts.tags, "tag") };
    default:
      return {
        swatches: [[SURFACE, "surface", null], [TILE, "lattice tile", facts.classes.tile], [LAYER, "boundary layer", facts.classes.layer],
          [BCC, "tile of BCC", facts.classes.bcc_tile]].filter(([, , count]) => count !== 0),
      };
  }
}
