// Marked places: what the certificate excepts, where the input is thin, and its defects.
import { count, degrees, make, number, place } from "./words.js";

const EXCEPTION = [214, 40, 120], THIN = [230, 140, 20], LOST = [200, 30, 30];
const DEFECTS = [[214, 39, 40], [255, 127, 14], [148, 103, 189], [140, 86, 75], [227, 119, 194], [127, 127, 127], [23, 190, 207], [188, 189, 34], [31, 119, 180]];
const ROWS_AT_MOST = 40;

// A list with a box to show or hide its marks, and a button for each place.
function list(view, host, name, title, colour, rows, go) {
  const box = make("input", { type: "checkbox", checked: true });
  box.addEventListener("change", () => view.showMarks(name, box.checked));
  const swatch = make("i", { className: "swatch" });
  swatch.style.background = `rgb(${colour})`;
  const items = rows.slice(0, ROWS_AT_MOST).map((row) => {
    const button = make("button", { type: "button", className: "place" }, row.text, make("small", { textContent: row.at ? ` at ${place(row.at)}` : "" }));
    button.addEventListener("click", () => go(row));
    return make("li", {}, button);
  });
  if (rows.length > ROWS_AT_MOST) items.push(make("li", { className: "note", textContent: `and ${count(rows.length - ROWS_AT_MOST)} more in the picture` }));
  host.append(make("details", { open: rows.length <= 6 }, make("summary", {}, make("label", {}, box, swatch, title)), make("ol", {}, ...items)));
}

// go(row): row.at is the place in the mesh's coordinates, row.tet a number of the mesh or -1, row.size how much is to be seen.
export function showPlaces(facts, view, host, go) {
  const { origin } = facts.embedded, relative = (p) => p.map((x, k) => x - origin[k % 3]);
  exceptionPlaces(facts, view, host, go, relative);
  thinPlaces(facts, view, host, go, relative);
  defectPlaces(facts, view, host, go, relative);
  return host.childElementCount > 0;
}

function exceptionPlaces(facts, view, host, go, relative) {
  const kinds = Map.groupBy ? Map.groupBy(facts.certificate.places, (p) => p.kind) : groupBy(facts.certificate.places);
  for (const [kind, places] of kinds) {
    if (kind === "thin") continue; // shown below, with their thickness
    const name = `exception-${kind}`, total = facts.certificate.exceptions[kind];
    const value = (p) => (p.value === null ? "" : /outside|sharp/.test(kind) ? (p.value >= 1 ? degrees(p.value) : `volume-length ${p.value.toFixed(3)}`) : `${number(p.value)} away`);
    const rows = places.map((p) => ({ at: p.place, tet: /outside|inverted|sharp/.test(kind) ? p.index : -1, text: `${value(p)}${p.cause ? `, ${p.cause}` : ""}` }));
    view.setMarks(name, { points: places.flatMap((p) => relative(p.place)) }, () => EXCEPTION);
    list(view, host, name, `${places[0].text}: ${count(total)}${total > places.length ? `, the worst ${places.length} shown` : ""}`, EXCEPTION, rows, go);
  }
}

function groupBy(places) {
  const kinds = new Map();
  for (const p of places) kinds.set(p.kind, [...(kinds.get(p.kind) ?? []), p]);
  return kinds;
}

function thinPlaces(facts, view, host, go, relative) {
  for (const lost of [true, false]) {
    const places = facts.thin.filter((p) => p.lost === lost), name = lost ? "lost" : "thin", colour = lost ? LOST : THIN;
    if (places.length === 0) continue;
    const rows = places.map((p) => ({ at: p.place, tet: -1, size: p.thickness, text: `${p.kind}${p.thickness === null ? "" : ` of ${number(p.thickness)}`}` }));
    view.setMarks(name, { points: places.flatMap((p) => relative(p.place)) }, () => colour);
    list(view, host, name, lost ? `lost walls and gaps: ${places.length}` : `walls and gaps below ${number(facts.thin_below)}, two sizes: ${places.length}`, colour, rows, go);
  }
}

function defectPlaces(facts, view, host, go, relative) {
  for (const [kind, { text, count: found, places: all, shown }] of (facts.defects?.kinds ?? []).entries()) {
    const places = facts.defects.places.filter((p) => p.kind === kind);
    if (places.length === 0) continue;
    const of = (corners) => places.filter((p) => p.corners.length === 3 * corners).flatMap((p) => relative(p.corners)), name = `defect-${kind}`;
    const rows = places.map((p) => {
      const n = p.corners.length / 3, at = [0, 1, 2].map((k) => p.corners.reduce((sum, x, i) => sum + (i % 3 === k ? x / n : 0), 0));
      return { at, tet: -1, text: ["point", "edge", "face"][n - 1] };
    });
    view.setMarks(name, { points: of(1), lines: of(2), faces: of(3) }, () => DEFECTS[kind]);
    list(view, host, name, `${text}: ${count(found)}${shown < all ? `, ${count(shown)} of ${count(all)} places shown` : ""}`, DEFECTS[kind], rows, go);
  }
}
