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

/** Which variables of a task are drawn, and how: a curve for each of `y`; of creep one for each force. @type {{title: string, x: string, y: string[], logarithmic: [boolean, boolean], words?: string, as?: "dots"}[]} */
const TASKS = [
  { title: "Friction against velocity", x: "velocity", y: ["kinetic_friction"], logarithmic: [true, false] },
  { title: "Healing", x: "hold", y: ["static_friction"], logarithmic: [true, false] },
  { title: "Noise of the force", x: "wave_number", y: ["spectrum"], logarithmic: [true, true], words: "power spectrum of F" },
  { title: "Creep", x: "creep_time", y: ["creep_position"], logarithmic: [true, false] },
  { title: "Stick-slip", x: "velocity", y: ["persistent_stiffness", "critical_stiffness", "critical_stiffness_sliding"], logarithmic: [true, true], words: "stiffness K" },
  { title: "Stick-slip", x: "stiffness", y: ["stick_slip"], logarithmic: [true, false], words: "none 0, transient 1, persistent 2", as: "dots" },
  { title: "Motion of the slider", x: "time", y: ["force"], logarithmic: [false, false] },
  { title: "Motion of the slider", x: "drive", y: ["spring_force"], logarithmic: [false, false] },
  { title: "Motion of the slider", x: "drive", y: ["force"], logarithmic: [false, false] },
];
/** The colour of a curve, and the dash of those after the last colour. @param {number} i */
const style = (i) => ({ color: ["blue", "orange", "green"][i % 3], dash: [[], [6, 4], [2, 3], [8, 3, 2, 3]][Math.floor(i / 3) % 4] });
/** Short words for curves that are drawn together. @type {Record<string, string>} */
const WORDS = { persistent_stiffness: "end of persistent stick-slip", critical_stiffness: "K_c of the first pull", critical_stiffness_sliding: "K_c of steady sliding" };
/** How the values of `stick_slip` are drawn at their velocities and stiffnesses. @type {Line[]} */
const ANSWERS = [{ label: "none", color: "quiet", as: "rings" }, { label: "transient", color: "blue", as: "dots" }, { label: "persistent", color: "orange", as: "dots" }];

/** What is drawn of the motion or the task. */
const motionKind = () => TASKS.find(({ x, y }) => traced(x).length && traced(y[0]).length === traced(x).length);
/** The columns of its events: where they are on the axis of the motion, and the force before them. */
const eventColumns = () => [motionKind()?.x === "time" ? "event_time" : "event_drive", "event_force_before"];

/** @typedef {{line: Line, x: (number | null)[], y: (number | null)[]}} Curve */

/** Where the slider is under each force, from the first point after loading on, and where it fails. @returns {Curve[]} */
function creepCurves() {
  const points = traced("creep_fraction").length;
  const unit = (units.force ?? "1") === "1" ? "" : ` ${units.force}`;
  const [x, y] = ["creep_time", "creep_position"].map((name) => (/** @type {number} */ i) => traced(name).slice(i * points + 1, (i + 1) * points));
  const curves = traced("imposed_force").map((force, i) => ({ line: { label: `X at F = ${rounded(force)}${unit}`, ...style(i) }, x: x(i), y: y(i) }));
  const failures = { line: /** @type {Line} */ ({ label: "failure", color: "ink", as: "dots" }), x: traced("failure_time"), y: traced("final_position") };
  return failures.x.some(Number.isFinite) ? [...curves, failures] : curves;
}

/** The velocities and stiffnesses of each answer. @returns {Curve[]} */
function answers() {
  const [velocity, stiffness, found] = ["velocity", "stiffness", "stick_slip"].map(traced);
  return ANSWERS.map((line, value) => {
    const own = found.flatMap((answer, i) => (answer === value ? [i] : []));
    return { line, x: own.map((i) => velocity[Math.floor(i / stiffness.length)]), y: own.map((i) => stiffness[i % stiffness.length]) };
  });
}

/** The curves of a task. @param {typeof TASKS[number]} task @returns {Curve[]} */
function curvesOf({ x, y, as }) {
  if (x === "creep_time") return creepCurves();
  const curves = y.map((name, i) => ({ line: { label: WORDS[name] ?? variable(name)?.long_name, as, ...style(i) }, x: traced(x), y: traced(name) }));
  return y.length > 1 ? [...curves, ...answers()].filter(({ y }) => y.some((value) => Number(value) > 0)) : curves;
}

/** Curves as columns over one list of places, where logarithmic axes have none for 0. @param {Curve[]} curves @param {[boolean, boolean]} logarithmic */
function columnsOf(curves, logarithmic) {
  const placed = (/** @type {number | null} */ value, /** @type {number} */ axis) => typeof value === "number" && (value > 0 || !logarithmic[axis]);
  const points = curves.flatMap(({ x, y }, curve) => x.map((at, i) => ({ curve, x: at, y: placed(y[i], 1) ? y[i] : null }))).filter(({ x }) => placed(x, 0));
  // One curve may go back and forth.
  if (curves.length > 1) points.sort((a, b) => Number(a.x) - Number(b.x));
  // What is undefined interrupts no curve.
  return [points.map(({ x }) => x), ...curves.map((_, own) => points.map(({ curve, y }) => (curve === own ? y : undefined)))];
}

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

/** What is dragged on the curves of the distributions. @returns {Handle[]} */
const lawHandles = () => (state.shown.handles ?? []).map(({ key, handle, stretch: x, density, weight, node }) => ({
  x, y: weight ? 0.9 * weight * (charts.laws.plot.scales.y.max ?? 1) : density,
  move: (stretch, density) => reshape(key, { move: { handle, stretch, density } }),
  remove: node ? () => reshape(key, { remove: handle }) : undefined,
}));

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
    keys() {
      const { force, block } = state.shown;
      /** @type {[unknown, Line][]} */
      const all = [
        [force?.force_std, { label: "± deviation, <i>N</i><sub>c</sub> contacts", color: "band", as: "band" }],
        [block?.summary.first_instability && stiffness(), { label: "spring", color: "orange", dash: [3, 3] }],
        [force?.static_friction, { label: "<i>F</i><sub>s</sub>", color: "blue", as: "dots" }],
        [state.measured, { label: "readings", color: "ink", as: "dots" }],
      ];
      return all.filter(([there]) => there).map(([, line]) => line);
    },
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
    handles: lawHandles,
    add(x) {
      const drawn = state.shown.handles?.find(({ node }) => node);
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
    keys: () => (traced(eventColumns()[0]).length ? [{ label: "slips", color: "orange", as: "dots" }] : []),
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
  const task = motionKind();
  charts.motion.element.hidden = !task;
  if (!task) return;
  const curves = curvesOf(task);
  const named = (/** @type {string} */ name) => /** @type {Named} */ ([variable(name)?.long_name, variable(name)?.quantity]);
  const [words, quantity] = named(task.y[0]);
  const shape = { x: named(task.x), y: /** @type {Named} */ ([task.words ?? words, quantity]), lines: curves.map(({ line }) => line), logarithmic: task.logarithmic };
  const { x, y, lines, logarithmic } = charts.motion.shape;
  if (JSON.stringify({ x, y, lines, logarithmic }) !== JSON.stringify(shape)) charts.motion.reshape(shape);
  charts.motion.title(task.title);
  charts.motion.set(/** @type {any} */ (columnsOf(curves, task.logarithmic)));
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
