// The page of `laves report`: reads the embedded mesh, draws it, and joins the controls to the picture.
import { readFacts } from "./blocks.js";
import { certificateTable } from "./certificate.js";
import { dihedralScore, legend } from "./colours.js";
import { Model } from "./model.js";
import { showPlaces } from "./places.js";
import { Plot } from "./plots.js";
import { Picture } from "./scene.js";
import { FACES, MEASURES } from "./shapes.js";
import { View } from "./view.js";
import { coordinate, count, degrees, make, number, place, setDiagonal } from "./words.js";

const by = (id) => document.getElementById(id);
const started = performance.now();
const facts = readFacts();
let model, view, picture, plots, picked = null, worstAt = -1, ready = false, readyAfter = null;

const ABOUT_PLOTS = {
  dihedral: { title: "Dihedral angles", unit: "°", what: "angles", ticks: [0, 30, 60, 90, 120, 150, 180], digits: 0, step: 1 },
  radius_ratio: { title: "Radius ratio 3r/R", unit: "", what: "tetrahedra", ticks: [0, 0.2, 0.4, 0.6, 0.8, 1], digits: 2, step: 0.01 },
  radius_edge: { title: "Radius-edge ratio, over the regular one’s", unit: "", what: "tetrahedra", ticks: [1, 1.5, 2, 2.5, 3], end: " and more", digits: 2, step: 0.02 },
};

// ---- the cut ----

const CHOICES = [["none", "none"], ["x", "x"], ["y", "y"], ["z", "z"], ["view", "facing me"]];

function buildAxes() {
  for (const [value, text] of CHOICES) {
    if (value === "view" && !model.whole) continue;
    const input = make("input", { type: "radio", name: "axis", value, checked: value === "none" });
    input.addEventListener("change", () => chooseAxis(value));
    by("axes").append(make("label", {}, input, make("span", { textContent: text })));
  }
  by("cut-note").textContent = model.whole ? "Whole tetrahedra are kept or left out, by their centroids."
    : "Whole tetrahedra are kept or left out, by their centroids. The mesh is large, so the plane goes in steps.";
  const slider = by("position");
  slider.addEventListener("input", () => moveTo(+slider.value));
  by("flip").addEventListener("click", () => picture.setCut({ flipped: !picture.cut.flipped }));
  by("lines").addEventListener("change", () => view.setLines(by("lines").checked));
}

// The side that the viewer sees is taken away, the plane in the middle.
async function chooseAxis(axis, at = null) {
  const { cut } = picture, direction = view.direction();
  document.querySelector(`input[name=axis][value=${axis}]`).checked = true;
  if (axis === "view") cut.normal = direction.map(Math.fround);
  const flipped = axis === "view" || axis === "none" ? false : direction["xyz".indexOf(axis)] < 0;
  if (axis !== "none" && axis !== "view") cut.normal = [0, 1, 2].map((k) => +(k === "xyz".indexOf(axis)));
  const slider = by("position"), steps = model.whole ? 1000 : (facts.embedded.cuts["xyz".indexOf(axis)]?.length ?? 1) - 1;
  Object.assign(slider, { min: 0, max: steps, step: 1, disabled: axis === "none" });
  by("flip").disabled = axis === "none";
  slider.value = at === null ? steps / 2 : at;
  cut.axis = axis;
  await moveTo(+slider.value, { flipped });
}

function moveTo(value, change = {}) {
  const { cut } = picture;
  if (model.whole) {
    const [low, high] = picture.reach(cut.normal);
    change.at = Math.fround(low + ((high - low) * value) / 1000);
  } else {
    change.step = value;
  }
  return picture.setCut({ axis: cut.axis, ...change });
}

function showCut() {
  const { axis } = picture.cut, along = "xyz".indexOf(axis);
  const where = axis === "none" ? "" : along >= 0 ? `${axis} = ${coordinate(picture.offset + facts.embedded.origin[along])}` : coordinate(picture.offset);
  by("position-value").textContent = where;
  by("position").setAttribute("aria-valuetext", where || "no cut");
  placeGrip();
}

// ---- the grip of the plane ----

function gripPlace() {
  const corners = picture.planeCorners();
  return corners && [0, 1, 2].map((k) => (corners[2][k] + corners[3][k]) / 2);
}

function placeGrip() {
  const at = picture && gripPlace(), grip = by("grip");
  grip.hidden = !at;
  if (!at) return;
  const [x, y] = view.project(at), { clientWidth: width, clientHeight: height } = view.canvas;
  grip.hidden = !(x >= 0 && x <= width && y >= 0 && y <= height);
  grip.style.transform = `translate(${x - 14}px, ${y - 14}px)`;
}

// The pointer's way on the screen, along the picture of the normal, moves the plane.
function listenToGrip() {
  const grip = by("grip"), slider = by("position");
  let drag = null;
  grip.addEventListener("pointerdown", (event) => {
    grip.setPointerCapture(event.pointerId);
    const at = gripPlace(), step = 0.01 * view.diagonal, next = at.map((x, k) => x + step * picture.cut.normal[k]);
    const [x0, y0] = view.project(at), [x1, y1] = view.project(next), squared = (x1 - x0) ** 2 + (y1 - y0) ** 2;
    drag = { x: event.clientX, y: event.clientY, along: [x1 - x0, y1 - y0], scale: step / Math.max(squared, 1e-3), value: +slider.value, start: picture.offset };
  });
  grip.addEventListener("pointermove", (event) => {
    if (!drag) return;
    const moved = ((event.clientX - drag.x) * drag.along[0] + (event.clientY - drag.y) * drag.along[1]) * drag.scale;
    const [low, high] = picture.reach(), steps = +slider.max + (model.whole ? 0 : 2);
    const value = Math.max(0, Math.min(+slider.max, Math.round(drag.value + (moved / (high - low)) * steps)));
    if (value === +slider.value) return;
    slider.value = value;
    moveTo(value);
  });
  for (const end of ["pointerup", "pointercancel"]) grip.addEventListener(end, () => (drag = null));
}

// ---- colours ----

function buildColours() {
  const choices = [["class", "class: tile, boundary layer"], ["dihedral", "dihedral angle"], ["radius_ratio", "radius ratio"], ["radius_edge", "radius-edge ratio"]];
  if (model.distances) choices.push(["distance", facts.embedded.distance_rough ? "distance to the input, estimated" : "distance to the input"]);
  choices.push(["region", "region"], ["tag", "tag of the boundary"]);
  by("colour").append(...choices.map(([value, textContent]) => make("option", { value, textContent })));
  by("colour").addEventListener("change", () => {
    picture.colour = by("colour").value;
    showLegend();
    picture.repaint();
  });
}

function showLegend() {
  const host = by("legend"), about = legend(picture.colour, facts, number);
  host.replaceChildren();
  if (about.gradient) {
    const bar = make("div", { className: "bar" });
    bar.style.background = about.gradient;
    host.append(bar, make("div", { className: "ends" }, make("span", { textContent: about.low }), make("span", { textContent: about.high })));
    return;
  }
  for (const [colour, name] of about.swatches.slice(0, 12)) {
    const swatch = make("i", { className: "swatch" });
    swatch.style.background = colour;
    host.append(make("span", { className: "entry" }, swatch, name));
  }
  if (about.swatches.length > 12) host.append(make("span", { textContent: `and ${about.swatches.length - 12} more` }));
}

// ---- a picked tetrahedron ----

const CLASS_NAMES = ["boundary layer", "lattice tile", "tile of BCC"];

// t: embedded, or -1 with what a section knows of it.
function pick(found, { fly = false } = {}) {
  const t = found.tet ?? -1, side = found.side, i = found.index;
  const source = t >= 0 ? { ...model.shapes, classes: model.classes, regions: model.regions } : side, at = t >= 0 ? t : i;
  picked = { number: t >= 0 ? model.numberOf(t) : side.numbers[i], minDihedral: source.minDihedral[at], maxDihedral: source.maxDihedral[at],
    radiusRatio: source.radiusRatio[at], radiusEdge: source.radiusEdge[at], kind: CLASS_NAMES[source.classes[at]],
    region: source.regions ? facts.regions[source.regions[at]] : null, distance: found.face !== undefined && model.distances ? model.distances[found.face] : null };
  const positions = t >= 0 ? tetFaces(t) : sectionFaces(side, picked.number);
  picked.centre = [0, 1, 2].map((k) => positions.reduce((sum, x, j) => sum + (j % 3 === k ? x : 0), 0) / (positions.length / 3));
  let radius = 0;
  for (let p = 0; p < positions.length; p += 3) radius = Math.max(radius, Math.hypot(...picked.centre.map((x, k) => x - positions[p + k])));
  view.setPick(positions);
  if (fly) view.fly(picked.centre, Math.max(20 * radius, 4e-3 * view.diagonal));
  showPicked(t);
}

function tetFaces(t) {
  const out = new Float32Array(36);
  FACES.forEach((corners, f) => corners.forEach((c, k) => {
    const v = 3 * model.tets[4 * t + c];
    out.set(model.points.subarray(v, v + 3), 9 * f + 3 * k);
  }));
  return out;
}

// The faces of a section that belong to a tetrahedron, which is not embedded itself.
function sectionFaces(side, wanted) {
  const out = [];
  side.numbers.forEach((n, i) => n === wanted && out.push(...picture.inner.positions.subarray(9 * i, 9 * i + 9)));
  return Float32Array.from(out);
}

function showPicked(t) {
  const card = by("picked"), rows = [["dihedral angles", `${degrees(picked.minDihedral)} to ${degrees(picked.maxDihedral)}`], ["radius ratio", picked.radiusRatio.toFixed(3)],
    ["radius-edge ratio", picked.radiusEdge.toFixed(3)], ["class", picked.kind], picked.region && facts.regions.length > 1 && ["region", picked.region.name ?? picked.region.number],
    picked.distance !== null && ["face to input", number(picked.distance)], ["at", place(picked.centre.map((x, k) => x + facts.embedded.origin[k]))]].filter(Boolean);
  const close = make("button", { type: "button", className: "close", ariaLabel: "Let go of the tetrahedron", textContent: "×" });
  close.addEventListener("click", unpick);
  const open = make("button", { type: "button", textContent: "Cut open here" });
  open.addEventListener("click", cutHere);
  card.replaceChildren(close, make("strong", { textContent: `Tetrahedron ${count(picked.number)}` }),
    make("dl", {}, ...rows.flatMap(([a, b]) => [make("dt", { textContent: a }), make("dd", {}, b)])), open);
  card.hidden = false;
  plots.dihedral.marks = t >= 0 ? [...model.shapes.angles.subarray(6 * t, 6 * t + 6)] : [picked.minDihedral, picked.maxDihedral];
  plots.radius_ratio.marks = [picked.radiusRatio];
  plots.radius_edge.marks = [picked.radiusEdge];
  for (const plot of Object.values(plots)) plot.draw();
}

function unpick() {
  picked = null;
  by("picked").hidden = true;
  view.setPick(null);
  for (const plot of Object.values(plots)) {
    plot.marks = [];
    plot.draw();
  }
}

// A plane through the picked tetrahedron that opens the mesh towards the viewer.
function cutHere() {
  const { centre } = picked, direction = view.direction();
  if (model.whole) {
    const along = direction.reduce((sum, n, k) => sum + Math.fround(n) * centre[k], 0), [low, high] = picture.reach(direction.map(Math.fround));
    return chooseAxis("view", Math.ceil((1000 * (along - low)) / (high - low)));
  }
  const axis = direction.map(Math.abs).indexOf(Math.max(...direction.map(Math.abs))), cuts = facts.embedded.cuts[axis];
  const nearest = cuts.reduce((best, x, i) => (Math.abs(x - centre[axis]) < Math.abs(cuts[best] - centre[axis]) ? i : best), 0);
  return chooseAxis("xyz"[axis], nearest);
}

function listenToCanvas() {
  const { canvas } = view;
  let down = null;
  canvas.addEventListener("pointerdown", (event) => (down = event.isPrimary ? [event.clientX, event.clientY] : null));
  canvas.addEventListener("pointerup", (event) => {
    if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
    const box = canvas.getBoundingClientRect(), found = picture.hit(view.ray(event.clientX - box.left, event.clientY - box.top));
    if (found) pick(found);
    else if (picked) unpick();
  });
  canvas.addEventListener("keydown", keyDown);
  by("home").addEventListener("click", () => view.home());
  by("up").addEventListener("change", () => view.setUp(by("up").value));
}

function keyDown(event) {
  const turn = 0.12, acts = { ArrowLeft: () => view.orbit(-turn, 0), ArrowRight: () => view.orbit(turn, 0), ArrowUp: () => view.orbit(0, turn), ArrowDown: () => view.orbit(0, -turn),
    "+": () => view.zoom(0.85), "=": () => view.zoom(0.85), "-": () => view.zoom(1 / 0.85), 0: () => view.home(), w: () => flyToWorst(worstAt + 1), Escape: () => unpick() };
  if (event.ctrlKey || event.metaKey || event.altKey || !acts[event.key]) return;
  event.preventDefault();
  acts[event.key]();
}

// ---- the worst ----

const WORST_LISTED = 8;
const WORST_KEYS = { minDihedral: "min_dihedral_tet", maxDihedral: "max_dihedral_tet", radiusRatio: "radius_ratio_tet", radiusEdge: "radius_edge_tet" };
let worst = [];

// The worst embedded tetrahedra by a measure: those of the whole mesh, since these are embedded first.
function findWorst(measure) {
  const values = model.shapes[measure], sign = measure === "maxDihedral" || measure === "radiusEdge" ? -1 : 1, found = [];
  for (let t = 0; t < model.tetCount; t++) {
    const value = Number.isNaN(values[t]) ? -Infinity : sign * values[t];
    if (found.length === WORST_LISTED && value >= found.at(-1).value) continue;
    const at = found.findIndex((other) => other.value > value);
    found.splice(at < 0 ? found.length : at, 0, { t, value });
    if (found.length > WORST_LISTED) found.pop();
  }
  // Of nearly equal ones the certificate, which has more digits, knows the first.
  const first = model.find(facts.certificate[WORST_KEYS[measure]]), rest = found.map(({ t }) => t);
  return first < 0 ? rest : [first, ...rest.filter((t) => t !== first)].slice(0, WORST_LISTED);
}

function showWorst() {
  const measure = by("worst-of").value, angle = measure.endsWith("Dihedral");
  worst = findWorst(measure);
  worstAt = -1;
  by("worst").replaceChildren(...worst.map((t, i) => {
    const value = model.shapes[measure][t], button = make("button", { type: "button" }, make("b", { textContent: angle ? degrees(value) : value.toFixed(3) }), make("small", { textContent: ` tet ${count(model.numberOf(t))}` }));
    button.addEventListener("click", () => flyToWorst(i));
    return make("li", {}, button);
  }));
}

function flyToWorst(i) {
  worstAt = i % worst.length;
  pick({ tet: worst[worstAt] }, { fly: true });
  [...by("worst").children].forEach((item, k) => item.firstChild.setAttribute("aria-pressed", String(k === worstAt)));
}

function goTo(row) {
  const t = row.tet >= 0 ? model.find(row.tet) : -1, relative = row.at.map((x, k) => x - facts.embedded.origin[k]);
  if (t >= 0) pick({ tet: t }, { fly: true });
  else view.fly(relative, Math.max(8 * (row.size ?? 0), 10 * facts.certificate.edge_mean));
}

// ---- plots ----

function buildPlots() {
  plots = {};
  for (const measure of MEASURES) {
    plots[measure] = new Plot(by(`plot-${measure}`), ABOUT_PLOTS[measure], facts.histograms[measure], (range) => {
      if (!picture) return;
      picture.ranges[measure] = range;
      picture.repaint();
    });
  }
  by("log").addEventListener("change", () => {
    for (const plot of Object.values(plots)) {
      plot.log = by("log").checked;
      plot.draw();
    }
  });
}

function showShown() {
  showCut();
  const { keptTets, filtered } = picture, all = count(facts.tets);
  const of = model.whole ? `${count(keptTets)} of ${all} tetrahedra shown` : filtered ? `${count(keptTets)} of the ${count(model.tetCount)} embedded tetrahedra shown`
    : picture.cut.axis === "none" ? `${all} tetrahedra` : `cut at ${by("position-value").textContent}`;
  by("status").textContent = of;
  by("filter-note").textContent = !filtered ? "" : model.whole ? "A tetrahedron is in the range of the dihedral angles when one of its six is." :
    "Of a mesh of this size the page holds the tetrahedra at the boundary and the worst ones; only of these those in the range are shown. The counts above are of all.";
}

// ---- words ----

function showHead() {
  const c = facts.certificate, s = c.statistics;
  document.title = `${facts.name}: laves report`;
  by("name").textContent = facts.name;
  const verdict = make("b", { className: c.valid ? "good" : "bad", textContent: c.valid ? "valid" : "not valid" });
  by("summary").append(verdict, ` ${count(facts.tets)} tetrahedra, ${count(facts.vertices)} vertices, dihedral angles ${degrees(s.min_dihedral.min, 1)} to ${degrees(s.max_dihedral.max, 1)}`);
}

function showAbout() {
  const e = facts.embedded, paragraphs = [];
  paragraphs.push(e.whole ? "Every tetrahedron of the mesh is in this page."
    : `Of the ${count(facts.tets)} tetrahedra this page holds the ${count(e.tets)} that have a boundary face or are among the worst ${count(e.worst)} by any measure, and the faces that lie open at ${e.cuts.map((x) => x.length).join(", ")} cuts across x, y, z. ` +
      "What else is inside is left out. Histograms and certificate are of all tetrahedra.");
  if (facts.input) paragraphs.push(`Distances are to ${facts.input.name}, from the middle of each boundary face${e.distance_rough ? ", estimated from the values and slopes of the implicit solid" : ""}; negative inside.`);
  if (!facts.input) paragraphs.push("No surface was given, so distances to one are not known (laves report --surface).");
  for (const warning of facts.warnings) paragraphs.push(`Warning: ${warning}.`);
  paragraphs.push(`Made by laves ${facts.version}. The page loads nothing and sends nothing.`);
  paragraphs.push("Mouse: drag turns, the right button moves, the wheel zooms, a click picks a tetrahedron. Touch: one finger turns, two move and zoom. Keys in the picture: arrows, + and -, 0 for the whole, w for the next of the worst, Escape.");
  by("about").append(...paragraphs.map((textContent) => make("p", { textContent })));
}

// ---- light and dark ----

const THEMES = ["auto", "light", "dark"], SIGNS = { auto: "◐", light: "☀", dark: "☾" };
let theme = "auto";

function applyTheme() {
  if (theme === "auto") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  by("theme").textContent = SIGNS[theme];
  by("theme").title = `Colours: ${theme}`;
  const style = getComputedStyle(document.documentElement);
  view?.setTheme(style.getPropertyValue("--stage").trim(), style.getPropertyValue("--accent").trim());
  for (const plot of Object.values(plots ?? {})) plot.draw();
}

function listenToTheme() {
  by("theme").addEventListener("click", () => {
    theme = THEMES[(THEMES.indexOf(theme) + 1) % 3];
    applyTheme();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", applyTheme);
}

// ---- what tests and people may look at ----

window.laves = {
  state: () => ({
    ready, settled: picture?.settled ?? false, readyAfter, frames: view?.frames ?? 0, tets: facts.tets, whole: facts.embedded.whole, embeddedTets: facts.embedded.tets,
    cut: picture && { axis: picture.cut.axis, at: picture.offset, flipped: picture.cut.flipped }, colour: picture?.colour,
    ranges: { ...picture?.ranges }, shownTets: picture?.keptTets, shownFaces: picture ? picture.shellFaces + picture.innerFaces : 0,
    innerFaces: picture?.innerFaces, boundaryFaces: picture?.shellFaces, picked: picked && { ...picked }, flying: !!view?.flight,
    camera: view && { position: view.camera.position.toArray(), target: view.controls.target.toArray() }, theme, score: picked && dihedralScore(picked.minDihedral, picked.maxDihedral),
  }),
};

function fail(error) {
  by("status").textContent = `The mesh cannot be shown: ${error.message}. The figures are in the certificate.`;
  by("status").classList.add("bad");
  console.error(error);
}

const nextFrame = () => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));

async function main() {
  setDiagonal(Math.hypot(...facts.embedded.upper.map((x, k) => x - facts.embedded.lower[k])));
  showHead();
  by("certificate").append(...certificateTable(facts.certificate));
  showAbout();
  buildPlots(); // these need no graphics
  listenToTheme();
  applyTheme();
  try {
    model = await Model.read(facts);
    view = new View(by("view"), model.points, facts.embedded);
    picture = new Picture(model, view);
    picture.onShown = showShown;
    view.onDraw = placeGrip;
    buildAxes();
    buildColours();
    showLegend();
    listenToGrip();
    listenToCanvas();
    by("places-section").hidden = !showPlaces(facts, view, by("places"), goTo);
    applyTheme();
    await picture.recut();
    await nextFrame();
    ready = true;
    readyAfter = performance.now() - started;
    // Measuring all tetrahedra takes a moment, and can wait until the mesh is seen.
    showWorst();
    by("worst-of").addEventListener("change", showWorst);
  } catch (error) {
    fail(error);
  }
}

main();
