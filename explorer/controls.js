// Controls of the numbers of a scenario: each shows a key, and says when it is changed.
"use strict";

/** A number as TOML. @param {number} value */
const toml = (value) => (Number.isInteger(value) && Math.abs(value) < 1e15 ? `${value}.0` : String(value));

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

/** A slider and a field for a number above 0, or from 0 on where `linear` is its largest value. */
class NumberRow {
  /** @param {HTMLElement} parent @param {string} key @param {string} label @param {{linear?: number}} [how] */
  constructor(parent, key, label, { linear } = {}) {
    this.linear = linear;
    this.middle = 1;
    this.row = element("div", { class: "row" });
    const name = element("label", { for: key }, label);
    this.range = element("input", { type: "range", min: "0", max: "1000", tabindex: "0", "aria-label": `${name.textContent}, slider` });
    this.field = element("input", { type: "number", step: "any", id: key });
    this.range.oninput = () => {
      const value = rounded(this.of(Number(this.range.value) / 1000));
      this.field.value = String(value);
      change(key, toml(value));
    };
    this.field.onchange = () => this.field.value !== "" && change(key, toml(Number(this.field.value)));
    this.row.append(name, this.range, this.field);
    parent.append(this.row);
  }
  /** @param {number} share */
  of(share) {
    return this.linear ? share * this.linear : this.middle * 10 ** (4 * share - 2);
  }
  /** Shows a value; without one, the scenario has no such key, and the row is hidden. @param {number | undefined} value */
  show(value) {
    this.row.hidden = value === undefined;
    if (value === undefined || document.activeElement === this.range) return;
    if (this.linear) this.linear = Math.max(this.linear, 2 * value);
    else if (value > 0 && Math.abs(Math.log10(value / this.middle)) > 1.5) this.middle = 10 ** Math.round(Math.log10(value));
    const share = this.linear ? value / this.linear : (Math.log10(value / this.middle) + 2) / 4;
    this.range.value = String(Math.round(1000 * share));
    if (document.activeElement !== this.field) this.field.value = String(value);
  }
}

/** The nodes of a polygon, each with fields of its stretch and its density, and buttons that add and remove one. */
class NodeRows {
  /** @param {HTMLElement} parent @param {string} key */
  constructor(parent, key) {
    this.key = key;
    this.rows = element("div");
    /** @type {HTMLInputElement[][]} */
    this.fields = [];
    this.add = element("button", {}, "Add node");
    this.add.onclick = () => reshape(key, { add: null });
    parent.append(this.rows, this.add);
  }
  /** @param {number} node */
  row(node) {
    const fields = ["stretch", "density"].map((name) => element("input", { type: "number", step: "any", "aria-label": `${name} of node ${node + 1}` }));
    for (const field of fields) field.onchange = () => reshape(this.key, { move: { node, stretch: Number(fields[0].value), density: Number(fields[1].value) } });
    const button = element("button", { "aria-label": `remove node ${node + 1}` }, "×");
    button.onclick = () => reshape(this.key, { remove: node });
    const row = element("div", { class: "row node" });
    row.append(...fields, button);
    this.rows.append(row);
    return fields;
  }
  /** @param {{stretch: number[], density: number[]}} polygon without nodes where there is none */
  show({ stretch, density }) {
    while (this.fields.length < stretch.length) this.fields.push(this.row(this.fields.length));
    while (this.fields.length > stretch.length) {
      this.fields.pop();
      this.rows.lastElementChild?.remove();
    }
    const show = (/** @type {HTMLInputElement} */ field, /** @type {number} */ value) => document.activeElement !== field && (field.value = String(value));
    this.fields.forEach((fields, node) => (show(fields[0], stretch[node]), show(fields[1], density[node])));
    this.add.hidden = !stretch.length;
    this.add.disabled = stretch.length >= NODES;
  }
}

/** Nodes of a polygon that is changed by hand. */
const NODES = 12;

/** The polygon that a distribution is; without nodes where it is none. @param {any} law @returns {{stretch: number[], density: number[]}} */
function polygon(law) {
  const { stretch, density } = law?.tabulated ?? {};
  return stretch && density && stretch.length <= NODES ? { stretch, density } : { stretch: [], density: [] };
}

const FAMILIES = ["gaussian", "gamma", "lognormal", "weibull", "rectangular", "exponential", "point", "tabulated"];

/** The choice of a distribution, and a row for each of its parameters or nodes. */
class LawEditor {
  /** @param {string} id @param {string} key */
  constructor(id, key) {
    this.key = key;
    /** @type {string | undefined} */
    this.family = undefined;
    const parent = byId(id);
    this.select = element("select", { "aria-label": `Distribution of ${parent.querySelector("legend")?.textContent}` });
    this.select.onchange = () => reshape(key, { family: this.select.value });
    this.rows = element("div");
    /** @type {Record<string, NumberRow>} */
    this.shown = {};
    parent.append(this.select, this.rows);
    this.nodes = new NodeRows(parent, key);
  }
  /** @param {Record<string, any> | undefined} law */
  show(law) {
    const [family, parameters] = Object.entries(law ?? { "—": {} })[0];
    if (family !== this.family) {
      this.family = family;
      this.rows.replaceChildren();
      this.shown = {};
      this.select.replaceChildren(...options([...new Set([family, ...FAMILIES])], { tabulated: "polygon" }));
    }
    this.select.value = family;
    for (const [name, value] of Object.entries(parameters)) {
      if (typeof value !== "number") continue;
      const linear = name === "at" || name === "min" ? 2 : undefined;
      this.shown[name] ??= new NumberRow(this.rows, `${this.key}.${family}.${name}`, name, { linear });
      this.shown[name].show(value);
    }
    this.nodes.show(polygon(law));
  }
}
