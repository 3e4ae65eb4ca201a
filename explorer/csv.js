// Measured curves: two columns of a CSV file, a position and a force.
"use strict";

/**
 * The columns named position (or displacement, X) and force (or F, stress), or the first two.
 * @param {string} text
 * @returns {{position: number[], force: number[], columns: string[]}}
 */
function readCurve(text) {
  const lines = text.split(/\r?\n/).filter((line) => line.trim() && !line.startsWith("#"));
  const cut = (/** @type {string} */ line) => line.split(/[,;\t]/).map((cell) => cell.trim());
  const first = cut(lines[0] ?? "");
  const named = first.some((cell) => cell !== "" && Number.isNaN(Number(cell)));
  const find = (/** @type {RegExp} */ pattern, /** @type {number} */ otherwise) => {
    const found = first.findIndex((name) => pattern.test(name));
    return named && found >= 0 ? found : otherwise;
  };
  const [x, y] = [find(/^(position|displacement|x)\b/i, 0), find(/^(force|shear|stress|f)\b/i, 1)];
  const rows = lines.slice(named ? 1 : 0).map(cut);
  const number = (/** @type {string | undefined} */ cell) => (cell ? Number(cell) : NaN);
  const points = rows.map((row) => [number(row[x]), number(row[y])]);
  const bad = points.findIndex((point) => !point.every(Number.isFinite));
  if (points.length < 2) throw new Error("expected a CSV file with two columns, position and force, and two rows or more");
  if (bad >= 0) throw new Error(`expected numbers in row ${bad + 1 + Number(named)}, got ${rows[bad].join(",").slice(0, 60)}`);
  points.sort((a, b) => a[0] - b[0]);
  return {
    position: points.map((point) => point[0]),
    force: points.map((point) => point[1]),
    columns: named ? [first[x], first[y]] : ["column 1", "column 2"],
  };
}
