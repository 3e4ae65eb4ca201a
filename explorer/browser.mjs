// What both tests share: Chromium where it is, how it stays quiet, and work of minutes.

import { existsSync } from "node:fs";
import { join } from "node:path";

const folders = (process.env.PATH ?? "").split(":");
const names = ["chromium", "chromium-browser", "google-chrome"];

export const browserAt = process.env.CHROMIUM ?? names.flatMap((name) => folders.map((folder) => join(folder, name))).find(existsSync);
if (!browserAt || !existsSync(browserAt)) throw new Error("missing: Chromium (Debian: chromium; or the path of a browser made of it in CHROMIUM)");

export const quiet = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

export const LONG = `[contacts]
thresholds.gaussian = { mean = 1.0, std = 0.1 }
[interface]
cells = [2000]
coupling.neighbours = { stiffness = 4.0 }
connection = 0.5
disorder = { std = 0.05, seed = 1 }
slip = "overdamped"
[drive]
distance = 90000.0
`;
