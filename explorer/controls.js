// Controls of the numbers of a scenario: each shows a key, and says when it is changed.
"use strict";

/** A number as TOML. @param {number} value */
const toml = (value) => (Number.isInteger(value) && Math.abs(value) < 1e15 ? `${value}.0` : String(value));

/** @param {number} value */
const rounded = (value) => Number(value.toPrecision(4));

/** @param {string} name @param {Record<string, string>} [attributes] */
function element(name, attributes = {}) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** A slider and a field for a number above 0, or from 0 on where `linear` is its largest value. */
class NumberRow {
  /** @param {HTMLElement} parent @param {string} key @param {string} label @param {Changed} changed @param {{linear?: number}} [how] */
  constructor(parent, key, label, changed, { linear } = {}) {
    this.linear = linear;
    this.middle = 1;
    const row = (this.row = element("div", { class: "row" }));
    const name = element("label", { for: key });
    name.innerHTML = label;
    this.range = /** @type {HTMLInputElement} */ (element("input", { type: "range", min: "0", max: "1000", tabindex: "0", "aria-label": `${name.textContent}, slider` }));
    this.field = /** @type {HTMLInputElement} */ (element("input", { type: "number", step: "any", id: key }));
    this.range.oninput = () => {
      const value = rounded(this.of(Number(this.range.value) / 1000));
      this.field.value = String(value);
      changed(key, toml(value));
    };
    this.field.onchange = () => this.field.value !== "" && changed(key, toml(Number(this.field.value)));
    row.append(name, this.range, this.field);
    parent.append(row);
  }
  /** @param {number} share */
  of(share) {
    return this.linear ? share * this.linear : this.middle * 10 ** (4 * share - 2);
  }
  /** Shows a value; without one, the scenario has no such key, and the row is hidden. @param {number | undefined} value */
  show(value) {
    this.row.hidden = value === undefined;
    if (value === undefined) return;
    if (document.activeElement === this.range) return;
    if (this.linear) this.linear = Math.max(this.linear, 2 * value);
    else if (value > 0 && Math.abs(Math.log10(value / this.middle)) > 1.5) this.middle = 10 ** Math.round(Math.log10(value));
    const share = this.linear ? value / this.linear : (Math.log10(value / this.middle) + 2) / 4;
    this.range.value = String(Math.round(1000 * share));
    if (document.activeElement !== this.field) this.field.value = String(value);
  }
}

/** The families that controls can change to, each from a mean and a standard deviation. @type {Record<string, (mean: number, std: number) => Record<string, number>>} */
const families = {
  gaussian: (mean, std) => ({ mean, std }),
  gamma: (mean, std) => ({ mean, std }),
  lognormal: (mean, std) => ({ mean, std }),
  weibull: (mean, std) => ({ shape: rounded((std / mean) ** -1.086), scale: mean }),
  rectangular: (mean, std) => ({ min: rounded(Math.max(0, mean - 1.732 * std)), max: rounded(mean + 1.732 * std) }),
  exponential: (mean) => ({ mean }),
  point: (mean) => ({ at: mean }),
};

/** The choice of a distribution, and a row for each of its parameters. */
class LawEditor {
  /** @param {string} id @param {string} key @param {Changed} changed */
  constructor(id, key, changed) {
    this.key = key;
    this.changed = changed;
    /** @type {string | undefined} */
    this.family = undefined;
    this.parent = /** @type {HTMLElement} */ (document.getElementById(id));
    this.select = /** @type {HTMLSelectElement} */ (element("select", { "aria-label": `Distribution of ${this.parent.querySelector("legend")?.textContent}` }));
    this.select.onchange = () => this.change(this.select.value);
    this.rows = element("div");
    /** @type {Record<string, NumberRow>} */
    this.shown = {};
    this.parent.append(this.select, this.rows);
  }
  /** @param {string} family */
  change(family) {
    const { mean, std, at, scale, min, max } = /** @type {Record<string, number>} */ (this.parameters ?? {});
    const middle = mean ?? at ?? scale ?? ((min ?? 0) + (max ?? 2)) / 2;
    const wide = std ?? (max ? (max - min) / 3.464 : 0.2 * middle);
    const parameters = Object.entries(families[family](rounded(middle || 0.1), rounded(wide || 0.02)));
    const inside = parameters.map(([name, value]) => `${name} = ${toml(value)}`).join(", ");
    this.changed(this.key, `{ ${family} = { ${inside} } }`);
  }
  /** @param {Record<string, any> | undefined} law */
  show(law) {
    const [family, parameters] = Object.entries(law ?? { "—": {} })[0];
    if (family !== this.family) {
      this.family = family;
      this.rows.replaceChildren();
      this.shown = {};
      const names = families[family] || !law ? Object.keys(families) : [family, ...Object.keys(families)];
      this.select.replaceChildren(...names.map((name) => Object.assign(element("option"), { value: name, textContent: name })));
    }
    this.select.value = family;
    this.parameters = parameters;
    for (const [name, value] of Object.entries(parameters)) {
      if (typeof value !== "number") continue;
      const linear = name === "at" || name === "min" ? 2 : undefined;
      this.shown[name] ??= new NumberRow(this.rows, `${this.key}.${family}.${name}`, name, this.changed, { linear });
      this.shown[name].show(value);
    }
  }
}

/** The rule by which the slider slips. */
class SlipRule {
  /** @param {HTMLElement} parent @param {Changed} changed */
  constructor(parent, changed) {
    const row = (this.row = element("div", { class: "row wide" }));
    const rules = ["reset", "overdamped", "arrest"];
    this.select = /** @type {HTMLSelectElement} */ (element("select", { id: "block.slip" }));
    this.select.append(...rules.map((rule) => Object.assign(element("option"), { value: rule, textContent: rule })));
    this.select.onchange = () => changed("block.slip", JSON.stringify(this.select.value));
    const label = Object.assign(element("label", { for: "block.slip" }), { textContent: "slip rule" });
    row.append(label, this.select);
    parent.append(row);
  }
  /** @param {unknown} slip */
  show(slip) {
    this.row.hidden = slip === undefined;
    this.select.value = typeof slip === "string" ? slip : "";
  }
}
