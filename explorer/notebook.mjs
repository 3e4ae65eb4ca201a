// Tests the explorer in a notebook: JupyterLab in a real browser.
// usage: node notebook.mjs PYTHON, where PYTHON has asperity, anywidget and jupyterlab

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { chromium } from "playwright-core";
import { LONG, browserAt, quiet } from "./browser.mjs";

const python = process.argv[2];
const TEXT = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\\npull.distance = 5.0\\n";
const cell = (source) => ({ cell_type: "code", id: source.slice(0, 8).replace(/\W/g, "x"), execution_count: null, metadata: {}, outputs: [], source });
const notebook = {
  cells: [
    cell(`import asperity as asp\nexplorer = asp.Explorer("${TEXT}")\nexplorer`),
    cell(`assert "std = 0.3" in explorer.scenario\nprint("found", explorer.result.kinetic_friction)`),
  ],
  metadata: { kernelspec: { name: "python3", display_name: "Python", language: "python" } },
  nbformat: 4,
  nbformat_minor: 5,
};

test("what is changed in the page is read by the next cell", async () => {
  const folder = mkdtempSync(join(tmpdir(), "explorer-"));
  writeFileSync(join(folder, "explorer.ipynb"), JSON.stringify(notebook));
  const options = ["--no-browser", "--allow-root", "--ServerApp.port=0", `--ServerApp.root_dir=${folder}`, "--IdentityProvider.token=t"];
  const lab = spawn(python, ["-m", "jupyterlab", ...options], { env: { ...process.env, JUPYTER_CONFIG_DIR: folder, JUPYTER_DATA_DIR: folder } });
  const browser = await chromium.launch({ executablePath: browserAt, args: quiet });
  try {
    const address = await new Promise((resolve, reject) => {
      let reported = "";
      lab.on("exit", () => reject(new Error(reported)));
      lab.stderr.on("data", (text) => {
        reported += text;
        const found = /http:\/\/127\.0\.0\.1:(\d+)\/lab/.exec(reported);
        if (found) resolve(`http://127.0.0.1:${found[1]}/lab/tree/explorer.ipynb?token=t`);
      });
    });
    const tab = await browser.newPage({ viewport: { width: 1500, height: 1000 } });
    tab.setDefaultTimeout(120000);
    await tab.goto(address);
    const first = tab.locator(".jp-CodeCell").first();
    await first.locator(".cm-content").click();
    await tab.waitForSelector('.jp-Notebook-ExecutionIndicator[data-status="idle"]');
    await tab.keyboard.press("Shift+Enter");
    const frame = tab.frameLocator('iframe[title="asperity explorer"]');
    await frame.locator('#status:has-text("full accuracy")').waitFor();
    await frame.locator('[id="contacts.thresholds.gaussian.std"]').fill("0.3");
    await frame.locator('[id="contacts.thresholds.gaussian.std"]').press("Enter");
    await frame.locator("#numbers").waitFor();
    // The answer to the change is in the text.
    const area = frame.locator("#text");
    for (let look = 0; look < 600 && !(await area.inputValue()).includes("std = 0.3"); look++) await tab.waitForTimeout(100);
    await frame.locator('#status:has-text("full accuracy")').waitFor();
    // Work of minutes is given up for what is asked next.
    const quick = await area.inputValue();
    await area.fill(LONG);
    await frame.locator("#progress:not([hidden])").waitFor();
    await area.fill(quick);
    await frame.locator('#plots[data-sheet="slider"]').waitFor();
    await frame.locator('#status:has-text("full accuracy")').waitFor();
    const reported = await frame.locator("#numbers tr:nth-child(3) td:last-child").textContent();
    if (process.env.PICTURE) await tab.screenshot({ path: process.env.PICTURE });
    await tab.locator(".jp-CodeCell").nth(1).locator(".cm-content").click();
    await tab.keyboard.press("Shift+Enter");
    const output = tab.locator('.jp-OutputArea-output pre:has-text("found")');
    await output.waitFor();
    // The last digit shown may be the next one. F_k = (mean² + std²)/(2 mean) but for one contact in 2000, whose threshold would be below 0.
    const found = Number((await output.textContent()).replace("found ", ""));
    assert.ok(Math.abs(found - Number(reported)) < 1e-9, `${found} ${reported}`);
    assert.ok(Math.abs(found - 0.545) < 1e-4, `${found}`);
  } finally {
    await browser.close();
    lab.kill("SIGTERM");
  }
});
