// Puts the page together: one file with the engine, the scripts and the styles in it, which runs from any place, a disk too.
// `engine/src/page.rs` does the same for pages whose engine is the command or a notebook.
// usage: node build.mjs ENGINE.wasm OUTPUT.html

import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { gzipSync } from "node:zlib";

const here = (name) => readFileSync(new URL(name, import.meta.url), "utf8");
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const [, , module, output] = process.argv;
if (!module || !output) throw new Error("usage: node build.mjs ENGINE.wasm OUTPUT.html");

const style = here("explorer.css");
const scripts = ["engine.js", "csv.js", "controls.js", "panels.js", "app.js"].map(here);
const policy = [
  "default-src 'none'",
  `script-src 'wasm-unsafe-eval' ${scripts.map(hash).join(" ")} blob:`,
  "worker-src blob:",
  `style-src ${hash(style)}`,
  "img-src blob: data:",
  "base-uri 'none'",
  "form-action 'none'",
].join("; ");
const engine = gzipSync(readFileSync(module), { level: 9 }).toString("base64");
const parts = {
  policy,
  styles: `<style>${style}</style>`,
  settings: JSON.stringify({ engine: "browser" }),
  data: `<script id="engine" type="application/octet-stream">${engine}</script>\n<script id="worker" type="text/plain">${here("worker.js")}</script>`,
  scripts: scripts.map((script) => `<script>${script}</script>`).join("\n"),
};
const page = here("index.html").replace(/\{\{(\w+)\}\}/g, (_, name) => parts[name]);
mkdirSync(dirname(output), { recursive: true });
writeFileSync(output, page);
console.log(`${output}: ${(page.length / 1e6).toFixed(1)} MB, the engine ${(engine.length * 0.75 / 1e6).toFixed(2)} MB compressed`);
