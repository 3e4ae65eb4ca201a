// The browser of the tests: Chromium where it is, and how it stays quiet.

import { existsSync } from "node:fs";
import { join } from "node:path";

const folders = (process.env.PATH ?? "").split(":");
const names = ["chromium", "chromium-browser", "google-chrome"];

export const browserAt = process.env.CHROMIUM ?? names.flatMap((name) => folders.map((folder) => join(folder, name))).find(existsSync);
if (!browserAt || !existsSync(browserAt)) throw new Error("missing: Chromium (Debian: chromium; or the path of a browser made of it in CHROMIUM)");

export const quiet = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
