// Measured curves: two columns of a CSV file, a position and a force.
"use strict";

/** Names of columns, with their units or other words around them. */
const NAMES = {
  position: /(^|[^a-z])(position|displacement|x)([^a-z]|$)/i,
  force: /(^|[^a-z])(force|stress|shear|friction|f[tx]?)([^a-z]|$)/i,
};

/**
 * The columns named position (or displacement, X) and force (or F, stress), or the two that there are. Columns are separated by
 * tabs, semicolons or commas, by the first of these in the first line, or by blanks; where it is no comma, numbers may have decimal commas.
 * @param {string} text
 * @returns {{position: number[], force: number[], columns: string[]}}
 */
function readCurve(text) {
  const lines = text.split(/\r?\n/).map((line, i) => ({ line: line.trim(), number: i + 1 })).filter(({ line }) => line && !line.startsWith("#"));
  const separator = ["\t", ";", ","].find((mark) => lines[0]?.line.includes(mark)) ?? /\s+/;
  const cut = (/** @type {string} */ line) => line.split(separator).map((cell) => cell.trim().replace(/^"(.*)"$/, "$1"));
  const number = (/** @type {string | undefined} */ cell) => (cell ? Number(separator === "," ? cell : cell.replace(",", ".")) : NaN);
  const first = cut(lines[0]?.line ?? "");
  const named = first.some((cell) => cell !== "" && Number.isNaN(number(cell)));
  let rows = lines.slice(named ? 1 : 0).map(({ line, number }) => ({ cells: cut(line), number }));
  if (first.length < 2 || rows.length < 2) throw new Error("expected a CSV file with two columns, position and force, and two rows or more");
  let [x, y] = [0, 1];
  if (named) {
    x = first.findIndex((name) => NAMES.position.test(name));
    y = first.findIndex((name, i) => i !== x && NAMES.force.test(name));
    if (first.length === 2) [x, y] = x >= 0 ? [x, 1 - x] : y >= 0 ? [1 - y, y] : [0, 1];
    if (x < 0 || y < 0) throw new Error(`expected columns named position (or displacement, x) and force (or stress, f), got ${first.join(", ").slice(0, 80)}`);
    // A line of units.
    if (rows[0] && [x, y].every((i) => Number.isNaN(number(rows[0].cells[i])))) rows = rows.slice(1);
  }
  const points = rows.map(({ cells }) => (cells.length === first.length ? [number(cells[x]), number(cells[y])] : [NaN, NaN]));
  const bad = points.findIndex((point) => !point.every(Number.isFinite));
  if (bad >= 0) throw new Error(`expected ${first.length} columns and numbers in row ${rows[bad].number}, got ${rows[bad].cells.join(", ").slice(0, 60)}`);
  points.sort((a, b) => a[0] - b[0]);
  const [position, force] = [0, 1].map((i) => points.map((point) => point[i]));
  return { position, force, columns: named ? [first[x], first[y]] : ["column 1", "column 2"] };
}
