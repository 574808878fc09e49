// Opens pages of `laves report` in a browser without a window and does what a reader would:
//
//   node tests/report/browser.mjs PROGRAM [--large] [--shots FOLDER]
//
// --large: a mesh of five million tetrahedra as well, which takes some minutes. --shots: pictures of what was seen.
// Needs Chromium ($CHROMIUM, else Debian's), and `npm ci` in web/ for playwright-core (tools/setup report).
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

const root = path.resolve(import.meta.dirname, "../..");
const { chromium } = await import(pathToFileURL(path.join(root, "web/node_modules/playwright-core/index.mjs")));

const words = process.argv.slice(2), program = path.resolve(words[0]);
const large = words.includes("--large"), shots = words.includes("--shots") ? path.resolve(words[words.indexOf("--shots") + 1]) : null;
const browserPath = process.env.CHROMIUM ?? "/usr/bin/chromium";
if (shots) mkdirSync(shots, { recursive: true });

const folder = mkdtempSync(path.join(tmpdir(), "laves-report-"));
const laves = (...given) => execFileSync(program, given, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
const launch = () => chromium.launch({ executablePath: browserPath,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update"] });
let browser = await launch();

// A page that is ready, and what it asked the network for.
async function open(name, options = {}) {
  const context = await browser.newContext({ viewport: shots ? { width: 1280, height: 860 } : { width: 960, height: 640 }, offline: true, reducedMotion: "reduce", ...options });
  const page = await context.newPage(), wrong = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && !/GPU stall|GL Driver/.test(message.text()) && wrong.push(message.text()));
  page.on("pageerror", (error) => wrong.push(error.stack));
  page.on("request", (request) => request.url() !== url && wrong.push(`asked for ${request.url()}`));
  const url = pathToFileURL(path.join(folder, name)).href, start = Date.now();
  await page.goto(url, { waitUntil: "commit" });
  await page.waitForFunction(() => window.laves?.state().ready, null, { timeout: 60000 });
  const seconds = (Date.now() - start) / 1000;
  await page.waitForFunction(() => document.querySelectorAll("#worst button").length > 0);
  return { page, wrong, seconds, state: () => page.evaluate(() => window.laves.state()), close: () => context.close(),
    shot: async (to) => shots && page.screenshot({ path: path.join(shots, `${to}.png`) }) };
}

// Waits until what the state says holds: that state, or null after some seconds.
async function settles(at, holds, seconds = 10) {
  for (let i = 0; i < 20 * seconds; i++) {
    const state = await at.state();
    if (state.settled && holds(state)) return state;
    await at.page.waitForTimeout(50);
  }
  return null;
}

// The same, of what must come about.
async function until(at, holds, what) {
  return (await settles(at, holds)) ?? assert.fail(`${what}: ${JSON.stringify(await at.state())}`);
}

// Taps until it is heard. Of a tap no click comes if it only ends the fling of the gesture before, or if the machine stands still
// between the finger's coming and going, which makes a long press of it: a reader taps again, and so do we.
async function tap(at, target, holds, what) {
  for (let i = 0; i < 5; i++) {
    await target.tap();
    if (await settles(at, holds, 3)) return;
  }
  assert.fail(`${what}: ${JSON.stringify(await at.state())}`);
}

// Colours in the picture, as told by small copies of it: share of pixels that differ from the first, and their mean.
async function pixels(at) {
  const png = (await at.page.locator("#view").screenshot()).toString("base64");
  return at.page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = new OffscreenCanvas(200, 150), pen = canvas.getContext("2d");
    pen.drawImage(image, 0, 0, 200, 150);
    const all = pen.getImageData(0, 0, 200, 150).data, mean = [0, 0, 0];
    let drawn = 0, yellow = 0, pink = 0;
    for (let i = 0; i < all.length; i += 4) {
      const [r, g, b] = all.subarray(i, i + 3);
      mean.forEach((_, k) => (mean[k] += all[i + k] / (all.length / 4)));
      if (Math.abs(r - all[300]) + Math.abs(g - all[301]) + Math.abs(b - all[302]) > 24) drawn++;
      if (r > b + 50 && g > b + 30) yellow++;
      if (r > g + 90 && b > g + 40) pink++;
    }
    return { ground: [...all.subarray(300, 303)], drawn: drawn / 30000, yellow: yellow / 30000, pink: pink / 30000, mean };
  }, png);
}

async function drag(page, from, to, steps = 8) {
  await page.mouse.move(...from);
  await page.mouse.down();
  for (let i = 1; i <= steps; i++) await page.mouse.move(from[0] + ((to[0] - from[0]) * i) / steps, from[1] + ((to[1] - from[1]) * i) / steps);
  await page.mouse.up();
}

const middle = async (page, selector) => {
  const box = await page.locator(selector).boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
};

// ---- what holds for every mesh ----

async function turns(at) {
  const { page } = at, before = await at.state(), [x, y] = await middle(page, "#view");
  await drag(page, [x, y], [x + 120, y - 40]);
  const after = await until(at, (s) => s.camera.position[0] !== before.camera.position[0], "dragging turns the mesh");
  assert.equal(after.picked, null, "a drag picks nothing");
  await page.keyboard.press("0");
  await page.locator("#home").click();
}

async function cuts(at) {
  const { page } = at, uncut = await at.state(), plain = await pixels(at);
  assert.ok(plain.drawn > 0.1, "the mesh is drawn");
  assert.equal(uncut.innerFaces, 0, "nothing of the inside is drawn");
  assert.equal(uncut.shownTets, uncut.embeddedTets);
  await page.locator("#axes span", { hasText: "y" }).first().click();
  const half = await until(at, (s) => s.cut.axis === "y" && s.innerFaces > 0, "a cut shows inner faces");
  assert.ok(half.shownTets < 0.7 * uncut.shownTets && half.shownTets > 0.3 * uncut.shownTets, "half of it is left");
  const open = await pixels(at);
  assert.ok(open.yellow > plain.yellow + 0.02, `tiles of the inside are seen: ${open.yellow} and ${plain.yellow}`);
  await at.shot("cut");
  // The grip is dragged away from the side that is kept: less is left.
  const grip = await middle(page, "#grip");
  await drag(page, grip, [grip[0] + 100, grip[1]]);
  const moved = await until(at, (s) => s.cut.at !== half.cut.at, "dragging the grip moves the plane");
  await drag(page, await middle(page, "#grip"), grip);
  // The slider by keys.
  await page.locator("#position").focus();
  await page.keyboard.press("Home");
  const least = await until(at, (s) => s.cut.at < Math.min(half.cut.at, moved.cut.at), "Home moves the plane to its end");
  await page.keyboard.press("End");
  const most = await until(at, (s) => s.cut.at > Math.max(half.cut.at, moved.cut.at), "End moves the plane to the other end");
  assert.ok(Math.abs(least.shownTets - most.shownTets) > (uncut.whole ? 0.8 : 0.5) * uncut.shownTets, `from nothing to all: ${least.shownTets}, ${most.shownTets} of ${uncut.shownTets}`);
  await page.locator("#axes span", { hasText: "none" }).click();
  await until(at, (s) => s.innerFaces === 0 && s.shownTets === s.embeddedTets, "no cut shows all");
}

async function brushes(at) {
  const { page } = at, before = await at.state(), canvas = page.locator("#plot-radius_ratio canvas");
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox(), y = box.y + box.height / 2;
  await drag(page, [box.x + 8, y], [box.x + 0.68 * box.width, y]);
  const some = await until(at, (s) => s.ranges.radius_ratio && s.shownTets < before.shownTets, "a brush filters");
  assert.ok(some.shownTets > 0 && some.innerFaces > 0, "what is in the range is drawn");
  const told = await page.locator("#plot-radius_ratio output").textContent();
  if (before.whole) assert.equal(Number(told.split(" of ")[0].replaceAll(",", "")), some.shownTets, "as many as the histogram counts are drawn");
  await page.waitForTimeout(300);
  await at.shot("brush");
  await page.locator("#plot-radius_ratio .clear").click();
  await until(at, (s) => !s.ranges.radius_ratio && s.shownTets === before.shownTets, "all is shown again");
  // The same without a mouse.
  await page.locator("#plot-dihedral .to").fill("45");
  await page.keyboard.press("Tab");
  await until(at, (s) => s.ranges.dihedral?.[1] === 45 && s.shownTets < before.shownTets, "a range that is typed filters");
  await page.locator("#plot-dihedral canvas").focus();
  await page.keyboard.press("ArrowRight");
  await until(at, (s) => s.ranges.dihedral?.[1] === 46, "arrows move the brush");
  await page.keyboard.press("Escape");
  await until(at, (s) => !s.ranges.dihedral, "Escape takes the brush away");
}

async function findsWorst(at, checked) {
  const { page } = at;
  await page.locator("#worst button").first().click();
  const state = await until(at, (s) => s.picked && !s.flying, "the worst tetrahedron is picked");
  assert.equal(state.picked.number, checked.tet, "it is that of the certificate");
  assert.ok(Math.abs(state.picked.minDihedral - checked.angle) < 0.02, "with its angle");
  const away = Math.hypot(...state.camera.position.map((x, k) => x - state.picked.centre[k]));
  assert.ok(state.camera.target.every((x, k) => Math.abs(x - state.picked.centre[k]) < 1e-3) && away < 2.5, `the camera is there, ${away} away`);
  const seen = await pixels(at);
  assert.ok(seen.pink > 0.0005, `it is marked: ${seen.pink}`);
  assert.ok(await page.locator("#picked").isVisible(), "its figures are shown");
  await at.shot("worst");
  await page.locator("#picked > button", { hasText: "Cut open here" }).click();
  await until(at, (s) => s.cut.axis !== "none" && s.innerFaces > 0, "the mesh is cut open there");
  await page.waitForTimeout(200);
  await at.shot("worst-open");
  await page.locator("#view").focus();
  await page.keyboard.press("w");
  await until(at, (s) => s.picked.number !== checked.tet, "w goes to the next");
  await page.keyboard.press("Escape");
  await until(at, (s) => s.picked === null, "Escape lets go");
  await page.keyboard.press("0");
}

async function picks(at) {
  const { page } = at;
  await page.locator("#home").click();
  await page.locator("#axes span", { hasText: "x" }).first().click();
  await until(at, (s) => s.cut.axis === "x" && s.innerFaces > 0, "a cut across x");
  const box = await page.locator("#view").boundingBox();
  for (const [u, v] of [[0.5, 0.5], [0.55, 0.4], [0.42, 0.5], [0.6, 0.6]]) {
    await page.mouse.click(box.x + u * box.width, box.y + v * box.height);
    if ((await at.state()).picked) break;
  }
  const { picked } = await until(at, (s) => s.picked, "a click picks a tetrahedron");
  assert.ok(picked.minDihedral > 0 && picked.minDihedral <= 70.6 && picked.radiusRatio > 0.3 && picked.radiusRatio <= 1, "with sensible figures");
  await page.locator("#picked .close").click();
  await page.locator("#axes span", { hasText: "none" }).click();
}

async function colours(at) {
  const { page } = at, before = await pixels(at), names = await page.locator("#colour option").evaluateAll((all) => all.map((o) => o.value));
  for (const wanted of ["class", "dihedral", "radius_ratio", "radius_edge", "distance", "region", "tag"]) assert.ok(names.includes(wanted), `a colour by ${wanted}`);
  for (const name of ["dihedral", "distance", "tag"]) {
    await page.locator("#colour").selectOption(name);
    await until(at, (s) => s.colour === name, `colour by ${name}`);
    await page.waitForTimeout(200);
    const now = await pixels(at);
    assert.ok(now.mean.some((x, k) => Math.abs(x - before.mean[k]) > 1), `${name} has other colours than class`);
    await at.shot(`colour-${name}`);
  }
  await page.locator("#colour").selectOption("class");
}

async function isReachable(at) {
  const { page } = at, met = new Set();
  await page.locator("#theme").focus();
  for (let i = 0; i < 60; i++) {
    met.add(await page.evaluate(() => document.activeElement.id || document.activeElement.name || document.activeElement.className || document.activeElement.tagName));
    await page.keyboard.press("Tab");
  }
  for (const id of ["theme", "view", "home", "up", "axis", "colour", "from", "to", "clear", "worst-of"]) assert.ok(met.has(id), `Tab comes to ${id}`);
  await page.locator("#view").focus();
  const before = await at.state();
  for (const key of ["ArrowLeft", "ArrowUp", "+"]) await page.keyboard.press(key);
  await until(at, (s) => s.camera.position.every((x, k) => x !== before.camera.position[k]), "keys turn the mesh");
  await page.keyboard.press("0");
}

async function certificateIsShown(at, { tets, vertices }) {
  const text = await at.page.locator("#certificate").innerText();
  for (const n of [tets, vertices]) assert.ok(text.includes(n.toLocaleString("en")), `the certificate shows ${n}`);
  assert.ok(/valid\s+yes/.test(text), "and that the mesh is valid");
}

// ---- the tests ----

const facts = (name) => {
  const told = JSON.parse(laves("check", name, "-q", "--json", "-"));
  return { tets: told.tets, vertices: told.vertices, angle: told.min_dihedral };
};

// By default all of them.
async function everything(name, mesh, prefix, tests = [turns, cuts, picks, brushes, findsWorst, colours, isReachable, certificateIsShown]) {
  const checked = facts(mesh), at = await open(name), state = await at.state();
  checked.tet = await at.page.evaluate(() => JSON.parse(document.getElementById("facts").textContent).certificate.min_dihedral_tet);
  assert.equal(state.tets, checked.tets, "as many tets as the mesh");
  const shot = at.shot;
  at.shot = (to) => shot(`${prefix}-${to}`);
  await at.shot("whole");
  for (const test of tests) await test(at, checked);
  assert.deepEqual(at.wrong, [], "nothing went wrong, and nothing was asked of a network");
  await at.close();
  return { seconds: at.seconds, state };
}

async function phone(name) {
  const at = await open(name, { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true });
  const wide = await at.page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `a phone need not scroll sideways: ${wide}`);
  const size = await at.page.evaluate(() => parseFloat(getComputedStyle(document.body).fontSize));
  assert.ok(size >= 14, "words are large enough");
  await tap(at, at.page.locator("#axes span", { hasText: "y" }).first(), (s) => s.innerFaces > 0, "a tap cuts");
  const before = await at.state(), [x, y] = await middle(at.page, "#view");
  const touch = await at.page.context().newCDPSession(at.page), point = (px, py) => [{ x: px, y: py }];
  await touch.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: point(x, y) });
  for (let i = 1; i <= 5; i++) await touch.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: point(x + 12 * i, y) });
  await at.page.waitForTimeout(200); // at rest, so that no fling comes of it
  await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  await until(at, (s) => s.camera.position[0] !== before.camera.position[0], "a finger turns the mesh");
  await at.shot("phone");
  await tap(at, at.page.locator("#worst button").first(), (s) => s.picked, "a tap finds the worst");
  await at.page.waitForTimeout(300);
  await at.shot("phone-worst");
  assert.deepEqual(at.wrong, []);
  await at.close();
}

async function dark(name) {
  const at = await open(name, { colorScheme: "dark" }), night = await pixels(at);
  assert.ok(Math.max(...night.ground) < 40, `the ground of the picture is dark: ${night.ground}`);
  const ground = () => at.page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const before = await ground();
  await at.shot("dark");
  await at.page.locator("#theme").click();
  assert.notEqual(await ground(), before, "the button makes it light");
  await at.page.waitForTimeout(200);
  assert.ok(Math.min(...(await pixels(at)).ground) > 200, "the picture too");
  assert.deepEqual(at.wrong, []);
  await at.close();
}

// Defects and thin places of the input: marks, and a flight to one of them.
async function places() {
  const at = await open("dirty.html"), rows = at.page.locator("#places details");
  assert.ok((await rows.count()) >= 2, "places are listed");
  const text = await at.page.locator("#places").innerText();
  assert.match(text, /open edges: \d+/);
  assert.match(text, /walls and gaps below/);
  const before = await at.state(), shown = await pixels(at);
  for (const box of await at.page.locator("#places summary input").all()) await box.uncheck();
  const bare = await pixels(at);
  assert.ok(shown.mean.some((x, k) => Math.abs(x - bare.mean[k]) > 0.02), "boxes hide the marks");
  for (const box of await at.page.locator("#places summary input").all()) await box.check();
  await at.page.locator("#places details").last().evaluate((list) => (list.open = true));
  await at.page.locator("#places .place").last().click();
  await until(at, (s) => s.camera.target.some((x, k) => x !== before.camera.target[k]), "the camera flies to a place");
  await at.page.locator("#places-section").scrollIntoViewIfNeeded();
  await at.page.locator("#home").click();
  await at.page.waitForTimeout(300);
  await at.shot("places");
  assert.deepEqual(at.wrong, []);
  await at.close();
}

// An open box with a wall of its own inside, thinner than the size.
const DIRTY = `v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1
f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n
v 1.1 0 0\nv 1.2 0 0\nv 1.2 1 0\nv 1.1 1 0\nv 1.1 0 1\nv 1.2 0 1\nv 1.2 1 1\nv 1.1 1 1
f 12 11 10 9\nf 13 14 15 16\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\n`;

async function main() {
  const solid = "sphere(1) - cylinder{r=0.4}";
  laves("mesh", solid, "--tets", "12k", "-q", "-o", "small.vtu", "--report", "small.html");
  laves("report", "small.vtu", "--surface", solid, "-q", "-o", "parts.html", "--whole", "1k");
  writeFileSync(path.join(folder, "dirty.obj"), DIRTY);
  laves("mesh", "dirty.obj", "--size", "0.12", "-q", "-o", "dirty.vtu", "--report", "dirty.html");
  await everything("small.html", "small.vtu", "small");
  console.log("a whole mesh: turned, cut, picked, brushed, coloured, by mouse and keys");
  await everything("parts.html", "small.vtu", "parts", [cuts, picks, brushes, findsWorst]);
  console.log("the same by sections");
  await phone("small.html");
  await dark("small.html");
  await places();
  console.log("phone, dark, places");
  if (!large) return;
  for (const [name, count] of [["medium", "50k"], ["large", "5M"]]) {
    laves("mesh", solid, "--tets", count, "-q", "-o", `${name}.vtu`, "--report", `${name}.html`);
    const { seconds, state } = await everything(`${name}.html`, `${name}.vtu`, name);
    const bytes = statSync(path.join(folder, `${name}.html`)).size;
    console.log(`${state.tets.toLocaleString("en")} tets: ${(bytes / 1e6).toFixed(2)} MB, drawn after ${seconds.toFixed(2)} s (of these in the script ${(state.readyAfter / 1000).toFixed(2)} s)`);
    await frames(`${name}.html`);
  }
}

// How long a step of the plane and a turn take until they are drawn; bounded by whatever draws here.
async function frames(name) {
  const at = await open(name), measured = await at.page.evaluate(async () => {
    const frame = () => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve))), slider = document.getElementById("position");
    document.querySelector("#axes input[value=y]").click();
    await new Promise((resolve) => setTimeout(resolve, 1000));
    const times = [];
    for (let i = 0; i < 12; i++) {
      const start = performance.now(), frames = window.laves.state().frames, before = window.laves.state().cut.at;
      slider.value = +slider.min + ((+slider.max - +slider.min) * (i + 1)) / 13;
      slider.dispatchEvent(new Event("input"));
      while (window.laves.state().cut.at === before || window.laves.state().frames === frames) await frame();
      times.push(performance.now() - start);
    }
    return times.sort((a, b) => a - b);
  });
  console.log(`  a step of the plane: ${measured[6].toFixed(0)} ms (median), ${measured[11].toFixed(0)} ms (largest)`);
  await at.close();
}

// A browser that ended by itself, of which nothing here is the cause, is started once more.
async function again(error) {
  if (browser.isConnected()) throw error;
  console.log(`the browser ended by itself (${error.message.split("\n")[0]}); all of it once more`);
  browser = await launch();
  await main();
}

try {
  await main().catch(again);
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
