// The figures: what each shows of the last answer, and what is dragged in it.
"use strict";

const byId = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));

const state = {
  text: "",
  /** Changes that the text does not have yet, by what they change. @type {Map<string, Change>} */
  changes: new Map(),
  position: 1,
  /** @type {Partial<Answer>} */
  shown: {},
  /** @type {{position: number[], force: number[], columns: string[]} | null} */
  measured: null,
  /** What is wrong with the link by which the page was opened. */
  note: "",
};

const distance = () => state.shown.force?.position.at(-1) ?? 12;
const stiffness = () => valueAt("block.stiffness");

/** The distributions of the contacts. @type {{name: "thresholds" | "reforming" | "initial", key: string, color: string, label: string}[]} */
const LAWS = [
  { name: "thresholds", key: "contacts.thresholds", color: "blue", label: "<i>P</i><sub>c</sub>" },
  { name: "reforming", key: "contacts.reforming", color: "green", label: "<i>R</i>" },
  { name: "initial", key: "initial", color: "orange", label: "<i>Q</i><sub>ini</sub>" },
];

/** The value at a key of the scenario. @param {string} key @returns {any} */
const valueAt = (key) => key.split(".").reduce((table, name) => table?.[name], state.shown.scenario);

/** Which variables of a task are drawn: across, up, and whether the axes are logarithmic. @type {[string, string, boolean, boolean][]} */
const TASKS = [
  ["velocity", "kinetic_friction", true, false],
  ["hold", "static_friction", true, false],
  ["wave_number", "spectrum", true, true],
  ["time", "force", false, false],
  ["drive", "spring_force", false, false],
  ["drive", "force", false, false],
];

/** What is drawn of the motion or the task. */
const motionKind = () => TASKS.find(([x, y]) => traced(x).length && traced(y).length === traced(x).length);
/** The columns of its events: where they are on the axis of the motion, and the force before them. */
const eventColumns = () => [motionKind()?.[0] === "time" ? "event_time" : "event_drive", "event_force_before"];

/** @param {string} name */
const variable = (name) => (state.shown.block ?? state.shown.task)?.record.variables.find((found) => found.name === name);
/** @param {string} name */
const traced = (name) => variable(name)?.values ?? [];
/** @param {Extended | undefined} value */
const finite = (value) => (typeof value === "number" && value > 0 ? value : null);

/** Point masses. @param {Pen} pen @param {Density} density @param {string} name */
function stems(pen, { at, weights }, name) {
  const top = 0.9 * (pen.plot.scales.y.max ?? 1);
  at.forEach((x, i) => {
    pen.line([[x, 0], [x, top * weights[i]]], name, { width: 2.5 });
    pen.dots([[x, top * weights[i]]], name, { radius: 3 });
  });
}

/** Point masses in the file of a plot. @param {string} label @param {Density | undefined} density @returns {[Named, number[]][]} */
const masses = (label, density) =>
  density?.at.length ? [[[`point masses of ${plain(label)}`, "length"], density.at], [["their weights", "number"], density.weights]] : [];

/** The density of a distribution as it is drawn. @param {"thresholds" | "reforming" | "initial"} name @param {number} x */
function height(name, x) {
  const { law_stretch: stretch = [], [name]: law } = state.shown.stretches ?? {};
  const after = Math.max(stretch.findIndex((other) => other >= x), 1);
  const [a, b] = [law?.values[after - 1] ?? 0, law?.values[after] ?? 0];
  return a + ((b - a) * (x - stretch[after - 1])) / (stretch[after] - stretch[after - 1]);
}

/** What is dragged on the curve of a distribution: its nodes, its mean and one standard deviation from it, or its point; of a mixture what is dragged of its parts, nodes aside. @returns {Handle[]} */
function handles(/** @type {{name: typeof LAWS[number]["name"], key: string}} */ { name, key }) {
  const law = valueAt(key);
  if (law?.mixture) return law.mixture.flatMap((/** @type {any} */ part, /** @type {number} */ i) => (part.law.tabulated ? [] : handles({ name, key: `${key}.mixture.${i}.law` })));
  const { stretch, density } = polygon(law);
  const highest = density.indexOf(Math.max(...density));
  const scale = height(name, stretch[highest]) / density[highest];
  /** @type {Handle[]} */
  const found = stretch.map((x, node) => ({
    x, y: scale * density[node], remove: () => reshape(key, { remove: node }), move: (x, y) => reshape(key, { move: { node, stretch: rounded(x), density: y } }),
  }));
  const [family, { mean, std, at }] = Object.entries(law ?? { none: {} })[0];
  const to = (/** @type {string} */ parameter, /** @type {number} */ value) => value > 0 && change(`${key}.${family}.${parameter}`, toml(rounded(value)));
  if (mean > 0) found.push({ x: mean, y: height(name, mean), move: (x) => to("mean", x) });
  if (mean > 0 && std > 0) found.push({ x: mean + std, y: height(name, mean + std), move: (x) => to("std", x - mean) });
  if (at >= 0) found.push({ x: at, y: 0.9 * (charts.laws.plot.scales.y.max ?? 1), move: (x) => to("at", x) });
  return found;
}

/** The forces along a chain at its drives or times; none where cells are no chain. */
function chain() {
  const along = traced("map_time").length ? "time" : "drive";
  const [at, cells, force] = [traced(`map_${along}`), traced("cell"), variable("cell_force")];
  return force && cells.length ? { along, at, cells: cells.length, values: force.values } : undefined;
}

/** The events in which a twentieth of the chain or more slipped: where, and the first and the last of these cells. */
function spans() {
  const found = chain();
  if (!found) return [];
  const [cells, at] = [traced("slipped_cell"), traced(`event_${found.along}`)];
  /** @type {Map<number, {at: number, first: number, last: number, count: number}>} */
  const events = new Map();
  traced("slipped_event").forEach((event, i) => {
    const { first, last, count } = events.get(event) ?? { first: Infinity, last: 0, count: 0 };
    events.set(event, { at: at[event - 1], first: Math.min(first, cells[i]), last: Math.max(last, cells[i]), count: count + 1 });
  });
  return [...events.values()].filter(({ count }) => count >= found.cells / 20);
}

/** @type {Record<"force" | "laws" | "chain" | "motion" | "stretches" | "map", Chart>} */
const charts = {
  force: new Chart("force", {
    x: ["position X of the slider", "length"], y: ["friction force F", "force"],
    lines: [{ label: "<i>F</i>(<i>X</i>)", color: "blue" }, { label: "<i>F</i><sub>k</sub>", color: "green", dash: [6, 4] }],
    scrub: (x) => scrub(x),
    marks(pen) {
      const { force, block } = state.shown;
      if (!force) return;
      const { position, force_std: std } = force;
      if (std) {
        const edge = (/** @type {number} */ sign) => position.map((x, i) => /** @type {[number, number]} */ ([x, force.force[i] + sign * std[i]]));
        pen.area([...edge(1), ...edge(-1).reverse()], "band");
      }
      const first = block?.summary.first_instability;
      const k = stiffness();
      if (first && k) pen.line([[first.position, first.force], [first.position + first.force / k, 0]], "orange", { dash: [3, 3] });
      if (force.static_friction) pen.dots([[force.static_friction.position, force.static_friction.value]], "blue");
      const { position: readings, force: read } = state.measured ?? { position: [], force: [] };
      pen.dots(readings.map((x, i) => [x, read[i]]), "ink", { radius: 1.5 });
      pen.line([[state.position, 0], [state.position, pen.plot.scales.y.max ?? 1]], "quiet", { width: 1 });
    },
    more() {
      const { force, block } = state.shown;
      const { static_friction: peak, force_std: std } = force ?? {};
      const first = block?.summary.first_instability;
      /** @type {[Named, number[]][]} */
      const found = std ? [[["standard deviation of F", "force"], std]] : [];
      if (peak) found.push([["X_s", "length"], [peak.position]], [["F_s", "force"], [peak.value]]);
      if (first) found.push([["X at the first instability", "length"], [first.position]], [["F there", "force"], [first.force]]);
      if (state.measured) found.push([["measured X", "length"], state.measured.position], [["measured F", "force"], state.measured.force]);
      return found;
    },
  }),
  laws: new Chart("laws", {
    x: ["stretch x", "length"], y: ["probability density", "per_length"], lines: LAWS,
    marks(pen) {
      for (const { name, color } of LAWS) if (state.shown.stretches) stems(pen, state.shown.stretches[name], color);
    },
    more: () => LAWS.flatMap(({ name, label }) => masses(label, state.shown.stretches?.[name])),
    handles: () => LAWS.flatMap(handles),
    add(x) {
      const drawn = LAWS.find(({ key }) => polygon(valueAt(key)).stretch.length);
      if (drawn) reshape(drawn.key, { add: rounded(x) });
    },
  }),
  chain: new Chart("chain", {
    x: ["drive", "length"], y: ["cell", "number"], lines: [],
    field: () => {
      const { at, cells, values } = chain() ?? { at: [0, 1], cells: 1, values: [0, 0] };
      return { at, cells, values, of: /** @type {Named} */ (["force of a cell", "force"]) };
    },
    marks(pen) {
      for (const { at, first, last } of spans()) pen.line([[at, first], [at, last + 1]], "ink", { width: 1.25 });
    },
    more() {
      const { at, cells, values, along } = chain() ?? { at: [], cells: 0, values: [], along: "drive" };
      const events = spans();
      const quantity = along === "time" ? "time" : "length";
      return [
        [[along, quantity], values.map((_, i) => at[Math.floor(i / cells)])], [["cell", "number"], values.map((_, i) => i % cells)], [["force of a cell", "force"], values],
        [[`${along} of a large event`, quantity], events.map((event) => event.at)], [["its first cell", "number"], events.map((event) => event.first)], [["its last cell", "number"], events.map((event) => event.last)],
      ];
    },
  }),
  motion: new Chart("motion", {
    x: ["drive", "length"], y: ["spring force", "force"], lines: [{ label: "spring force", color: "blue" }],
    marks(pen) {
      const [at, forces] = eventColumns().map(traced);
      pen.dots(at.map((x, i) => [x, forces[i]]), "orange", { radius: 3 });
    },
    more: () => eventColumns().flatMap((name) => {
      const { long_name: words, quantity, values } = variable(name) ?? {};
      return words && quantity && values ? [[[words, quantity], values]] : [];
    }),
  }),
  stretches: new Chart("stretches", {
    x: ["stretch x", "length"], y: ["probability density", "per_length"],
    lines: [{ label: "<i>Q</i>(<i>x</i>; <i>X</i>)", color: "blue" }, { label: "<i>Q</i><sub>s</sub>, in steady sliding", color: "green", dash: [6, 4] }],
    marks: (pen) => state.shown.stretches && stems(pen, state.shown.stretches.density, "blue"),
    more: () => [[["position X", "length"], [state.shown.stretches?.position ?? NaN]], ...masses("<i>Q</i>", state.shown.stretches?.density)],
  }),
  map: new Chart("map", {
    x: ["standard deviation σ of the thresholds", "length"], y: ["stiffness K", "stiffness"], logarithmic: [true, true],
    lines: [{ label: "<i>K</i><sub>c</sub>(σ)", color: "blue" }],
    marks(pen) {
      const curve = state.shown.critical_stiffness;
      if (!curve) return;
      const points = curve.width.map((width, i) => /** @type {[number, number | null]} */ ([width, finite(curve.critical_stiffness[i])]));
      const known = /** @type {[number, number][]} */ (points.filter((point) => point[1] !== null));
      if (!known.length) return;
      const floor = pen.plot.scales.y.min ?? 1e-6;
      pen.area([...known, [known[known.length - 1][0], floor], [known[0][0], floor]], "slip");
      pen.text(known[0][0] * 1.15, floor * 2, "stick-slip");
    },
    handles() {
      const [family, { std }] = Object.entries(valueAt("contacts.thresholds") ?? { none: {} })[0];
      const k = stiffness();
      if (!(std > 0 && k > 0 && state.shown.critical_stiffness)) return [];
      const move = (/** @type {number} */ x, /** @type {number} */ y) => {
        change("block.stiffness", toml(rounded(y)));
        change(`contacts.thresholds.${family}.std`, toml(rounded(x)));
      };
      return [{ x: std, y: k, move }];
    },
  }),
};

/** Draws the motion of the block, or the task where it is another one. */
function showMotion() {
  const kind = motionKind();
  charts.motion.element.hidden = !kind;
  if (!kind) return;
  const [x, y, ...logarithmic] = kind;
  const named = (/** @type {string} */ name) => /** @type {Named} */ ([variable(name)?.long_name, variable(name)?.quantity]);
  const shape = { x: named(x), y: named(y), lines: [{ label: named(y)[0], color: "blue" }], logarithmic: /** @type {[boolean, boolean]} */ (logarithmic) };
  if (charts.motion.shape.x[0] !== shape.x[0] || charts.motion.shape.y[0] !== shape.y[0]) charts.motion.reshape(shape);
  // Logarithmic axes have no place for 0.
  const drawn = (/** @type {number} */ i) => [x, y].every((name, axis) => !logarithmic[axis] || traced(name)[i] > 0);
  charts.motion.set(/** @type {any} */ ([x, y].map((name) => traced(name).filter((_, i) => drawn(i)))));
}

/** Draws the forces along a chain. */
function showChain() {
  const found = chain();
  charts.chain.element.hidden = !found;
  if (!found) return;
  const { along, at, cells } = found;
  charts.chain.shape.x = [along, along === "time" ? "time" : "length"];
  charts.chain.set([[at[0], at[at.length - 1]], [0, cells]]);
}
