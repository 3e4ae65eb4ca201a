// Controls of the numbers of a scenario: each shows a key, and says when it is changed.
"use strict";

/** A number as TOML. @param {number} value */
const toml = (value) => (Number.isInteger(value) && Math.abs(value) < 1e15 ? `${value}.0` : String(value));

/** A number in a field: exponents for those that are too long. @param {number} value */
const brief = (value) => (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5) ? value.toExponential() : String(value));

/** @param {number} value */
const rounded = (value) => Number(value.toPrecision(4));

/** @template {keyof HTMLElementTagNameMap} T @param {T} name @param {Record<string, string>} [attributes] @param {string} [html] */
function element(name, attributes = {}, html = "") {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.innerHTML = html;
  return made;
}

/** @param {string[]} names @param {Record<string, string>} [labels] */
const options = (names, labels = {}) => names.map((name) => new Option(labels[name] ?? name, name));

/**
 * A field of a number. What is typed stays until it is entered; then the scenario may have another number.
 * @param {Record<string, string>} attributes @param {() => void} entered
 */
function numberField(attributes, entered) {
  const input = element("input", { type: "number", step: "any", ...attributes });
  let [typing, last] = [false, ""];
  const show = (/** @type {number} */ value) => {
    last = brief(value);
    if (!typing) input.value = last;
  };
  input.oninput = () => (typing = true);
  input.onblur = () => (typing = false);
  input.onchange = () => {
    typing = false;
    if (input.value === "") input.value = last;
    else entered();
  };
  return { input, show };
}

/** Has as many rows as there are values: makes those that are missing, and removes those that are too many. @template {{element: Element}} T @param {T[]} rows @param {number} count @param {(number: number) => T} make */
function resize(rows, count, make) {
  while (rows.length < count) rows.push(make(rows.length));
  for (const { element } of rows.splice(count)) element.remove();
}

/** A slider and a field for a number above 0, or from 0 on where `linear` is its largest value. */
class NumberRow {
  /** @param {HTMLElement} parent @param {string} key @param {string} label @param {{linear?: number, changed?: (value: number) => void}} [how] */
  constructor(parent, key, label, { linear, changed = (value) => change(key, toml(value)) } = {}) {
    this.linear = linear;
    this.middle = 1;
    this.row = element("div", { class: "row" });
    const name = element("label", { for: key }, label);
    this.range = element("input", { type: "range", min: "0", max: "1000", tabindex: "0", "aria-label": `${name.textContent}, slider` });
    this.field = numberField({ id: key }, () => changed(Number(this.field.input.value)));
    this.range.oninput = () => {
      const value = rounded(this.of(Number(this.range.value) / 1000));
      this.field.show(value);
      changed(value);
    };
    this.row.append(name, this.range, this.field.input);
    parent.append(this.row);
  }
  /** @param {number} share */
  of(share) {
    return this.linear ? share * this.linear : this.middle * 10 ** (4 * share - 2);
  }
  /** Shows a value; without one, the scenario has no such key, and the row is hidden. @param {number | undefined} value */
  show(value) {
    this.row.hidden = value === undefined;
    if (value === undefined) return;
    this.field.show(value);
    if (document.activeElement === this.range) return;
    if (this.linear) this.linear = value > this.linear ? 2 * value : this.linear;
    else if (value > 0 && Math.abs(Math.log10(value / this.middle)) > 1.5) this.middle = 10 ** Math.round(Math.log10(value));
    const share = this.linear ? value / this.linear : (Math.log10(value / this.middle) + 2) / 4;
    this.range.value = String(Math.round(1000 * share));
  }
}

/** The nodes of a polygon, each with fields of its stretch and its density, and buttons that add and remove one. */
class NodeRows {
  /** @param {HTMLElement} parent @param {string} key */
  constructor(parent, key) {
    this.key = key;
    this.parent = element("div");
    /** @type {{element: HTMLElement, fields: ReturnType<typeof numberField>[]}[]} */
    this.rows = [];
    this.add = element("button", {}, "Add node");
    this.add.onclick = () => reshape(key, { add: null });
    parent.append(this.parent, this.add);
  }
  /** @param {number} node */
  row(node) {
    const moved = () => reshape(this.key, { move: { handle: node, stretch: Number(fields[0].input.value), density: Number(fields[1].input.value) } });
    const fields = ["stretch", "density"].map((name) => numberField({ "aria-label": `${name} of node ${node + 1}` }, moved));
    const button = element("button", { "aria-label": `remove node ${node + 1}` }, "×");
    button.onclick = () => reshape(this.key, { remove: node });
    const row = element("div", { class: "row node" });
    row.append(...fields.map(({ input }) => input), button);
    this.parent.append(row);
    return { element: row, fields };
  }
  /** @param {any} law which has nodes if it is a polygon that is changed by hand */
  show(law) {
    const { stretch = [], density = [] } = law?.tabulated ?? {};
    const count = stretch.length <= NODES ? density.length : 0;
    resize(this.rows, count, (node) => this.row(node));
    this.rows.forEach(({ fields }, node) => fields.forEach((field, i) => field.show([stretch, density][i][node])));
    this.add.hidden = !count;
    this.add.disabled = count >= NODES;
  }
}

/** Nodes of a polygon that is changed by hand. */
const NODES = 12;

const FAMILIES = ["gaussian", "gamma", "lognormal", "weibull", "rectangular", "exponential", "point", "tabulated"];

/** A part of a mixture: its weight and its distribution. */
class PartEditor {
  /** @param {HTMLElement} parent @param {string} key of the mixture @param {number} part @param {string} of what the mixture describes */
  constructor(parent, key, part, of) {
    this.element = element("div", { class: "part" });
    parent.append(this.element);
    const changed = (/** @type {number} */ weight) => reshape(key, { weight: { part, weight } });
    this.weight = new NumberRow(this.element, `${key}.mixture.${part}.weight`, "weight", { linear: 1, changed });
    this.law = new LawEditor(this.element, `${key}.mixture.${part}.law`, `part ${part + 1} of ${of}`, FAMILIES);
    const button = element("button", { "aria-label": `remove part ${part + 1} of ${of}` }, "Remove part");
    button.onclick = () => reshape(key, { remove_part: part });
    this.element.append(button);
  }
  /** @param {{weight: number, law: any}} part */
  show({ weight, law }) {
    this.weight.show(weight);
    this.law.show(law);
  }
}

/** The choice of a distribution, and a row for each of its parameters, nodes or parts. */
class LawEditor {
  /** @param {HTMLElement} parent @param {string} key @param {string} of what it describes @param {string[]} families */
  constructor(parent, key, of, families) {
    this.key = key;
    this.of = of;
    this.families = families;
    /** @type {string | undefined} */
    this.family = undefined;
    this.select = element("select", { "aria-label": `Distribution of ${of}` });
    this.select.onchange = () => reshape(key, { family: this.select.value });
    this.rows = element("div");
    /** @type {Record<string, NumberRow>} */
    this.shown = {};
    parent.append(this.select, this.rows);
    this.nodes = new NodeRows(parent, key);
    /** @type {PartEditor[]} */
    this.parts = [];
    this.partsElement = element("div");
    this.split = element("button", {}, "Add part");
    this.split.onclick = () => reshape(key, { split: null });
    parent.append(this.partsElement, this.split);
  }
  /** @param {Record<string, any> | undefined} law */
  show(law) {
    const [family, parameters] = Object.entries(law ?? { "—": {} })[0];
    if (family !== this.family) {
      this.family = family;
      this.rows.replaceChildren();
      this.shown = {};
      this.select.replaceChildren(...options([...new Set([family, ...this.families])], { tabulated: "polygon" }));
    }
    this.select.value = family;
    for (const [name, value] of Object.entries(parameters)) {
      if (typeof value !== "number") continue;
      const linear = name === "at" || name === "min" ? 2 : undefined;
      this.shown[name] ??= new NumberRow(this.rows, `${this.key}.${family}.${name}`, name, { linear });
      this.shown[name].show(value);
    }
    this.nodes.show(law);
    const parts = law?.mixture ?? [];
    resize(this.parts, parts.length, (part) => new PartEditor(this.partsElement, this.key, part, this.of));
    this.parts.forEach((part, i) => part.show(parts[i]));
    this.split.hidden = !parts.length;
  }
}
