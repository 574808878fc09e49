// Builds the page that the program carries: bundles src/ and three.js, and puts script, style and licence into src/index.html.
//
//   node build.mjs           writes ../cli/report_template.html
//   node build.mjs FILE      writes FILE
import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const read = (path) => readFileSync(here(path), "utf8");
const shared = { bundle: true, minify: true, write: false, legalComments: "none", logLevel: "warning", absWorkingDir: here(".") };

const script = await build({ ...shared, entryPoints: ["src/main.js"], format: "iife", target: "es2022" });
const style = await build({ ...shared, entryPoints: ["src/style.css"] });
const parts = {
  "/*style*/": style.outputFiles[0].text.trim(),
  "/*script*/": script.outputFiles[0].text.trim(),
  "<!--licence-->": read("node_modules/three/LICENSE").replaceAll("&", "&amp;").replaceAll("<", "&lt;").trim(),
};
let page = read("src/index.html");
for (const [mark, text] of Object.entries(parts)) {
  if (page.split(mark).length !== 2) throw new Error(`src/index.html has not one ${mark}`);
  page = page.replace(mark, () => text);
}
for (const mark of ["<!--laves:data-->", "<!--laves:sections-->"])
  if (page.split(mark).length !== 2) throw new Error(`the page has not one ${mark}`);
writeFileSync(process.argv[2] ?? here("../cli/report_template.html"), page);
