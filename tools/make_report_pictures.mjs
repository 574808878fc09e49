// Draws the pictures of docs/report.md anew: node tools/make_report_pictures.mjs [PROGRAM]
// Needs what the browser test needs (tools/setup report).
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

const root = path.resolve(import.meta.dirname, ".."), program = path.resolve(process.argv[2] ?? path.join(root, "build/laves"));
const { chromium } = await import(pathToFileURL(path.join(root, "web/node_modules/playwright-core/index.mjs")));
const folder = mkdtempSync(path.join(tmpdir(), "laves-pictures-"));
const laves = (...words) => execFileSync(program, words, { cwd: folder, stdio: ["ignore", "ignore", "inherit"] });
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });

// Opens a page, does what is to be done, and takes its picture.
async function draw(picture, name, act, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1000, height: 640 }, reducedMotion: "reduce", ...options });
  await page.goto(pathToFileURL(path.join(folder, name)).href);
  await page.waitForFunction(() => window.laves?.state().ready && document.querySelectorAll("#worst button").length > 0);
  await act(page);
  await page.waitForTimeout(800);
  await page.screenshot({ path: path.join(root, "docs/images", `report-${picture}.png`) });
  await page.close();
}

const choose = (page, axis) => page.locator("#axes span", { hasText: axis }).first().click();
const turn = async (page, right, up) => {
  await page.locator("#view").focus();
  for (let i = 0; i < Math.abs(right); i++) await page.keyboard.press(right > 0 ? "ArrowRight" : "ArrowLeft");
  for (let i = 0; i < Math.abs(up); i++) await page.keyboard.press(up > 0 ? "ArrowUp" : "ArrowDown");
  await page.evaluate(() => document.activeElement.blur());
};

try {
  laves("mesh", path.join(root, "demo/knot.ply"), "--tets", "30k", "-q", "-o", "knot.vtu", "--report", "knot.html");
  laves("mesh", path.join(root, "demo/socket.lua"), "--tets", "60k", "-q", "-o", "socket.vtu", "--report", "socket.html");
  laves("mesh", path.join(root, "demo/bracket.obj"), "--size", "0.16", "-q", "-o", "bracket.vtu", "--report", "bracket.html");
  await draw("cut", "socket.html", async (page) => {
    await choose(page, "y");
    await turn(page, -3, 1);
  });
  await draw("brush", "knot.html", async (page) => {
    await page.locator("#colour").selectOption("radius_ratio");
    await page.locator("#plot-radius_ratio .to").fill("0.7");
    await page.keyboard.press("Tab");
  }, { colorScheme: "dark" });
  await draw("worst", "knot.html", async (page) => {
    await page.locator("#colour").selectOption("dihedral");
    await page.locator("#worst button").first().click();
    await page.locator("#picked button", { hasText: "Cut open here" }).click();
    for (let i = 0; i < 4; i++) await page.locator("#view").press("-");
  });
  await draw("places", "bracket.html", async (page) => {
    await page.locator("#colour").selectOption("tag");
    await turn(page, -8, 0);
    await page.locator("#places-section").scrollIntoViewIfNeeded();
  });
  await draw("phone", "socket.html", async (page) => {
    await choose(page, "y");
    await page.locator("#colour").selectOption("distance");
  }, { viewport: { width: 390, height: 760 }, hasTouch: true, isMobile: true });
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}
