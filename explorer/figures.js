// The figures: what each shows of the last answer, and what is dragged in it.
"use strict";

const state = {
  text: "",
  /** @type {Map<string, string | null>} */
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
const stiffness = () => state.shown.scenario?.block?.stiffness;

/** The distributions of the contacts. @type {["thresholds" | "reforming" | "initial", string, string][]} */
const LAWS = [["thresholds", "blue", "<i>P</i><sub>c</sub>"], ["reforming", "green", "<i>R</i>"], ["initial", "orange", "<i>Q</i><sub>ini</sub>"]];

/** Which variables of a task are drawn: across, up, and whether the axes are logarithmic. @type {[string, string, boolean, boolean][]} */
const TASKS = [
  ["velocity", "kinetic_friction", true, false],
  ["hold", "static_friction", true, false],
  ["wave_number", "spectrum", true, true],
  ["time", "force", false, false],
  ["drive", "spring_force", false, false],
];

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
    pen.dot(x, top * weights[i], name, { radius: 3 });
  });
}

/** Point masses in the file of a plot. @param {string} label @param {Density | undefined} density @returns {[Named, number[]][]} */
const masses = (label, density) =>
  density?.at.length ? [[[`point masses of ${plain(label)}`, "length"], density.at], [["their weights", "number"], density.weights]] : [];

/** @type {Record<"force" | "laws" | "motion" | "stretches" | "map", Chart>} */
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
      if (force.static_friction) pen.dot(force.static_friction.position, force.static_friction.value, "blue");
      state.measured?.position.forEach((x, i) => pen.dot(x, state.measured?.force[i] ?? 0, "ink", { radius: 1.5 }));
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
    x: ["stretch x", "length"], y: ["probability density", "per_length"], lines: LAWS.map(([, color, label]) => ({ label, color })),
    marks(pen) {
      for (const [name, of] of LAWS) if (state.shown.stretches) stems(pen, state.shown.stretches[name], of);
    },
    more: () => LAWS.flatMap(([name, , label]) => masses(label, state.shown.stretches?.[name])),
    handles() {
      const law = state.shown.scenario?.contacts.thresholds;
      const [family, { mean, std }] = Object.entries(law ?? { none: {} })[0];
      if (!(mean > 0)) return [];
      const key = `contacts.thresholds.${family}`;
      const height = 0.5 * (charts.laws.plot.scales.y.max ?? 1);
      const mover = { x: mean, y: height, label: "mean", move: (/** @type {number} */ x) => x > 0 && change(`${key}.mean`, toml(rounded(x))) };
      const wider = { x: mean + std, y: height / 2, label: "std", move: (/** @type {number} */ x) => x > mean && change(`${key}.std`, toml(rounded(x - mean))) };
      return std > 0 ? [mover, wider] : [mover];
    },
  }),
  motion: new Chart("motion", {
    x: ["drive", "length"], y: ["spring force", "force"], lines: [{ label: "spring force", color: "blue" }],
    marks(pen) {
      const forces = traced("event_force_before");
      traced("event_drive").forEach((x, i) => pen.dot(x, forces[i], "orange", { radius: 3 }));
    },
    more: () => ["event_drive", "event_force_before"].flatMap((name) => {
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
      const [family, { std }] = Object.entries(state.shown.scenario?.contacts.thresholds ?? { none: {} })[0];
      const k = stiffness();
      if (!(std > 0 && k > 0 && state.shown.critical_stiffness)) return [];
      const move = (/** @type {number} */ x, /** @type {number} */ y) => {
        state.changes.set("block.stiffness", toml(rounded(y)));
        change(`contacts.thresholds.${family}.std`, toml(rounded(x)));
      };
      return [{ x: std, y: k, label: "here", move }];
    },
  }),
};

/** Draws the motion of the block, or the task where it is another one. */
function showMotion() {
  const kind = TASKS.find(([x, y]) => traced(x).length && traced(y).length === traced(x).length);
  charts.motion.element.hidden = !kind;
  if (!kind) return;
  const [x, y, ...logarithmic] = kind;
  const named = (/** @type {string} */ name) => /** @type {Named} */ ([variable(name)?.long_name, variable(name)?.quantity]);
  const shape = { x: named(x), y: named(y), lines: [{ label: named(y)[0], color: "blue" }], logarithmic: /** @type {[boolean, boolean]} */ (logarithmic) };
  if (charts.motion.shape.x[0] !== shape.x[0] || charts.motion.shape.y[0] !== shape.y[0]) charts.motion.reshape(shape);
  charts.motion.set([traced(x), traced(y)]);
}
