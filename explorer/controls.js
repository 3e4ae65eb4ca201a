// Controls as the engine describes them: rows of sliders, fields, choices and buttons, each with the change that it makes.
"use strict";

/** A number as TOML, which is JSON, too. @param {number} value */
const toml = (value) => (Number.isInteger(value) && Math.abs(value) < 1e15 ? `${value}.0` : String(value));

/** @param {number} value @param {number} digits */
const rounded = (value, digits = 4) => Number(value.toPrecision(digits));

/** @typedef {{element: HTMLElement, show: (item: Item) => void}} Control */

/** A slider. Its ends stay while it is used. @param {Item} item @returns {Control} */
function slider(item) {
  const element = Object.assign(document.createElement("input"), { type: "range", step: "any" });
  element.oninput = () => {
    const place = Number(element.value);
    put(item.change, toml(rounded(item.logarithmic ? 10 ** place : place)));
  };
  return { element, show: ({ ends: [min, max], value }) => void (document.activeElement === element || Object.assign(element, { min, max, value })) };
}

/** A field of a number. What is typed stays until it is entered; then the scenario may have another number. @param {Item} item @returns {Control} */
function field(item) {
  const element = Object.assign(document.createElement("input"), { type: "number", step: "any" });
  let [typing, last, change] = [false, "", item.change];
  element.oninput = () => (typing = true);
  element.onblur = () => (typing = false);
  element.onchange = () => {
    typing = false;
    if (element.value === "") element.value = last;
    else put(change, toml(Number(element.value)));
  };
  const show = (/** @type {Item} */ item) => {
    [last, change] = [item.value, item.change];
    if (!typing) element.value = last;
  };
  return { element, show };
}

/** A choice. @param {Item} item @returns {Control} */
function choice(item) {
  const element = document.createElement("select");
  element.onchange = () => put(item.change, element.value);
  const show = (/** @type {Item} */ { options, value }) => {
    if (options.join() !== Array.from(element.options, (option) => option.value).join()) {
      element.replaceChildren(...options.map((name) => new Option(name === "tabulated" ? "polygon" : name, name)));
    }
    element.value = value;
  };
  return { element, show };
}

/** A button. @param {Item} item @returns {Control} */
function button(item) {
  const element = document.createElement("button");
  element.onclick = () => put(item.change);
  return { element, show: ({ value, disabled }) => void Object.assign(element, { textContent: value, disabled }) };
}

const KINDS = { range: slider, number: field, select: choice, button };

/** The rows that are there, by their names. @type {Map<string, {element: HTMLElement, controls: Control[]}>} */
const rows = new Map();

/** @param {Row} row */
function makeRow({ class: name, label, items }) {
  const element = Object.assign(document.createElement("div"), { className: name });
  const controls = items.map((item) => {
    const control = KINDS[item.kind](item);
    if (item.id) control.element.id = item.id;
    if (item.name) control.element.ariaLabel = item.name;
    return control;
  });
  const words = Object.assign(document.createElement("label"), { innerHTML: label, htmlFor: items.at(-1)?.id });
  element.append(...(label ? [words] : []), ...controls.map((control) => control.element));
  return { element, controls };
}

/** Shows these rows; those that stay keep their place, and so what is typed or pointed at. @param {Row[]} list */
function showControls(list) {
  for (const [id, { element }] of rows) {
    if (list.some((row) => row.id === id)) continue;
    element.remove();
    rows.delete(id);
  }
  /** The last row of each group. @type {Record<string, Element>} */
  const last = {};
  for (const row of list) {
    const { element, controls } = rows.get(row.id) ?? makeRow(row);
    rows.set(row.id, { element, controls });
    const before = last[row.group] ?? byId(row.group).firstElementChild;
    if (before.nextElementSibling !== element) before.after(element);
    last[row.group] = element;
    controls.forEach((control, i) => control.show(row.items[i]));
  }
}
