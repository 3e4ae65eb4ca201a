// The explorer: the text of a scenario is its state. Controls, dragged points and the text itself change it, the engine answers,
// and everything is drawn from the answer.
"use strict";

const area = /** @type {HTMLTextAreaElement} */ (byId("text"));
const scrubber = /** @type {HTMLInputElement} */ (byId("position"));

/** What is wrong with the scenario, and with the last file. */
const wrong = { scenario: "", file: "" };

/** @param {string} message @param {keyof typeof wrong} [of] */
function fail(message, of = "scenario") {
  wrong[of] = message;
  byId("errors").hidden = !(wrong.scenario || wrong.file);
  byId("errors").textContent = [wrong.scenario, wrong.file].filter(Boolean).join("\n");
}

/** Asks for a preview; the answer to it asks for the full accuracy. */
function update(preview = true, /** @type {Part[]} */ parts = ["force", "stretches"]) {
  engine.ask(() => ({ text: state.text, changes: [...state.changes.values()], parts, position: state.position, preview }));
}

/** Puts a change in the place of an older one of the same thing. @param {string} what @param {Change} change */
function put(what, change) {
  state.changes.set(what, change);
  state.note = "";
  update();
}

/** @param {string} key @param {string | null} value as TOML */
const change = (key, value) => put(key, { key, value });

/** @param {string} key @param {LawChange} law */
const reshape = (key, law) => put(`${key} ${Object.keys(law)[0]} ${law.move?.handle ?? law.weight?.part}`, { key, law });

/** @param {number} x */
function scrub(x) {
  state.position = Math.min(Math.max(x, 0), distance());
  update();
}

/** Shows how far the work is where it takes longer than half a second. @param {number | null} fraction @param {number} milliseconds */
function progressed(fraction, milliseconds) {
  const bar = /** @type {HTMLProgressElement} */ (byId("progress"));
  bar.hidden = fraction === null || milliseconds < 500;
  bar.value = fraction ?? 0;
}

/** @param {Answer} answer @param {EngineRequest} request @param {number} milliseconds */
function receive(answer, request, milliseconds) {
  const { invalid } = answer;
  const where = invalid?.line ? `line ${invalid.line}: ` : "";
  fail([state.note, invalid && where + invalid.message, invalid?.help, ...(answer.failures ?? [])].filter(Boolean).join("\n"));
  for (const [what, change] of state.changes) if (request.changes.includes(change)) state.changes.delete(what);
  const current = request.text === state.text;
  if (current) {
    state.text = answer.text;
    if (area.value !== answer.text && (request.changes.length || document.activeElement !== area)) area.value = answer.text;
  }
  if (invalid) byId("status").textContent = "not valid: the last valid scenario is shown";
  if (invalid || !answer.scenario) {
    // A value that was refused leaves its field.
    if (request.changes.length && state.shown.scenario) show(request.preview);
    return;
  }
  // What was computed last is shown until the new is there, but not on another sheet.
  const sheet = sheetOf(answer.scenario);
  if (sheet !== byId("plots").dataset.sheet) state.shown = {};
  Object.assign(state.shown, answer);
  units = answer.units ?? {};
  // Of what was asked for nothing old is left; the full answer has all that there is.
  for (const part of request.preview ? request.parts : PARTS) if (!answer[part]) delete state.shown[part];
  if (answer.stretches && request.position === state.position) state.position = answer.stretches.position;
  byId("plots").dataset.sheet = sheet;
  if (current) texts[sheet] = state.text;
  for (const button of sheets) button.setAttribute("aria-current", button.dataset.sheet === sheet ? "page" : "false");
  show(request.preview);
  const cost = `${milliseconds.toFixed(0)} ms`;
  byId("status").textContent = request.preview ? `preview, ${cost} …` : `full accuracy, ${cost}`;
  if (request.preview && !engine.waiting) update(false, ["force", "stretches", ...details(answer.scenario)]);
}

/** @type {Part[]} */
const PARTS = ["force", "stretches", "block", "task", "critical_stiffness"];

/** What takes longer than a preview: the map where thresholds have a width, and the motion or the task. @param {any} scenario @returns {Part[]} */
function details(scenario) {
  const [law] = /** @type {any[]} */ (Object.values(scenario.contacts.thresholds ?? {}));
  /** @type {Part[]} */
  const motion = scenario.interface ? ["task"] : scenario.block && scenario.drive ? ["block"] : scenario.pull || scenario.drive ? [] : ["task"];
  return law?.std > 0 && !motion.includes("task") ? ["critical_stiffness", ...motion] : motion;
}

const editors = LAWS.map(({ name, key }) => {
  const parent = byId(name);
  return { key, editor: new LawEditor(parent, key, parent.querySelector("legend")?.textContent ?? "", [...FAMILIES, "mixture"]) };
});
/** The numbers that have a slider, where the scenario has them. @type {[string, string][]} */
const NUMBERS = [
  ["block.stiffness", "<i>K</i>"], ["contacts.count", "<i>N</i><sub>c</sub>"], ["contacts.stiffness", "⟨<i>k</i>⟩"], ["drive.distance", "distance"], ["drive.velocity", "velocity"],
  ["block.slip.damped.damping", "<i>γ</i>"], ["block.slip.inertial.mass", "<i>M</i>"], ["block.slip.inertial.damping", "<i>γ</i>"],
  ["contacts.temperature.energy", "<i>T</i>"], ["contacts.ageing.logarithmic.growth", "ageing"],
  ["interface.connection", "<i>K</i><sub>0</sub>"], ["interface.coupling.neighbours.stiffness", "<i>K</i><sub>int</sub>"], ["interface.disorder.std", "disorder"],
];
const rows = NUMBERS.map(([key, label]) => ({ key, row: new NumberRow(byId("slider"), key, label) }));
const slip = element("select", { id: "block.slip" });
slip.onchange = () => change("block.slip", JSON.stringify(slip.value));
const slipRow = element("div", { class: "row wide" }, '<label for="block.slip">slip rule</label>');
slipRow.append(slip);
byId("slider").append(slipRow);

/** Shows the rule of slip. One that has parameters is begun in the text. @param {string | Record<string, any> | undefined} rule */
function showSlip(rule) {
  slipRow.hidden = !rule;
  const name = typeof rule === "string" ? rule : Object.keys(rule ?? {})[0];
  slip.replaceChildren(...options([...new Set(["reset", "overdamped", "arrest", name])]));
  slip.value = name;
}

/** A number with the digits that are right, and its unit. @param {Extended | undefined | null} value @param {number} error relative @param {string} quantity */
function digits(value, error, quantity) {
  if (typeof value !== "number") return value ?? "—";
  const right = !(error > 0) ? 10 : Math.floor(-Math.log10(error));
  const shown = value === 0 ? "0" : value.toPrecision(Math.min(Math.max(right, 2), 10)).replace("e", " e");
  return (units[quantity] ?? "1") === "1" ? shown : `${shown} ${escaped(units[quantity])}`;
}

/** @param {number} error relative error of forces */
function numbers(error) {
  const { force, block, task } = state.shown;
  const sliding = block?.summary;
  const catalogue = task?.summary.catalogue;
  const found = /** @type {[string, Extended | undefined | null, number, string][]} */ ([
    ["static friction <i>F</i><sub>s</sub>", force && (force.static_friction?.value ?? "not reached"), error, "force"],
    ["at <i>X</i><sub>s</sub>", force?.static_friction?.position, Math.sqrt(error), "length"],
    ["kinetic friction <i>F</i><sub>k</sub>", force?.kinetic_friction, error, "force"],
    ["relaxation length <i>X</i>*", force?.relaxation_length, Math.sqrt(error), "length"],
    ["critical stiffness <i>K</i><sub>c</sub>", force?.critical_stiffness, 10 * error, "stiffness"],
  ]);
  if (sliding) found.push(["sliding", sliding.regime, 0, ""], ["slips", String(sliding.slips), 0, ""], ["period", sliding.period, 1e-6, "length"], ["mean force drop", sliding.mean_drop, 1e-6, "force"]);
  if (catalogue) found.push(["events", String(catalogue.events), 0, ""], ["cells of the largest", String(catalogue.largest?.cells ?? "—"), 0, ""]);
  byId("numbers").innerHTML = found.map(([name, ...value]) => `<tr><td>${name}</td><td>${digits(...value)}</td></tr>`).join("");
}

/** @param {boolean} preview */
function show(preview) {
  const { force, stretches, critical_stiffness: curve, scenario } = state.shown;
  for (const { key, editor } of editors) editor.show(valueAt(key));
  for (const { key, row } of rows) row.show(valueAt(key));
  showSlip(scenario.block?.slip);
  charts.force.element.hidden = !force;
  charts.laws.element.hidden = charts.stretches.element.hidden = !stretches;
  charts.force.set(force ? [force.position, force.force, force.position.map(() => force.kinetic_friction)] : [[], [], []]);
  charts.laws.set(stretches ? [stretches.law_stretch, ...LAWS.map(({ name }) => stretches[name].values)] : [[], [], [], []]);
  charts.stretches.set(stretches ? [stretches.stretch, stretches.density.values, stretches.steady.values] : [[], [], []]);
  if (stretches) {
    scrubber.value = String(Math.round((1000 * state.position) / distance()));
    byId("at").textContent = `X = ${rounded(state.position)}`;
  }
  showMotion();
  showChain();
  charts.map.element.hidden = !curve;
  charts.map.set(curve ? [curve.width, curve.critical_stiffness.map(finite)] : [[], []]);
  // The accuracy is that of forces per stiffness of the contacts, a length.
  numbers(preview ? 3e-4 : Math.max((force?.accuracy ?? 0) / (force?.static_friction?.position ?? distance()), 1e-12));
}

area.oninput = () => {
  state.text = area.value;
  state.changes.clear();
  state.note = "";
  update();
};
scrubber.oninput = () => scrub((Number(scrubber.value) / 1000) * distance());

/** @type {number | undefined} */
let playing;
/** @param {boolean} plays */
function play(plays) {
  clearInterval(playing);
  playing = plays ? setInterval(() => scrub(state.position >= distance() ? 0 : state.position + distance() / 300), 40) : undefined;
  byId("play").setAttribute("aria-pressed", String(playing !== undefined));
  byId("play").textContent = playing === undefined ? "Play" : "Stop";
}
byId("play").onclick = () => play(playing === undefined);

/** The scenarios to begin with, the first of each sheet first. */
const examples = [.../** @type {NodeListOf<HTMLScriptElement>} */ (document.querySelectorAll("script.example"))];
const chosen = /** @type {HTMLSelectElement} */ (byId("examples"));
// A scenario of the user's own is none of them.
chosen.append(Object.assign(new Option("Examples"), { disabled: true }), ...options(examples.map((example) => example.title)));

/** Replaces the scenario. @param {string} text @param {number} [example] its number, if it is one @param {string} [note] what is wrong with its link */
function begin(text, example = -1, note = "") {
  play(false);
  chosen.selectedIndex = example + 1;
  state.text = area.value = text.trimStart();
  state.changes.clear();
  state.note = note;
  update();
}
chosen.onchange = () => begin(examples[chosen.selectedIndex - 1].text, chosen.selectedIndex - 1);

/** The sheet of a scenario. @param {any} scenario */
const sheetOf = (scenario) => (scenario.interface ? "chain" : scenario.velocity_curve || scenario.hold_curve || scenario.protocol || scenario.creep ? "time" : "slider");
/** The last text of each sheet. @type {Record<string, string>} */
const texts = {};
const sheets = [.../** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("#sheets button"))];
for (const sheet of sheets) {
  const name = sheet.dataset.sheet ?? "";
  sheet.onclick = () => {
    const here = byId("plots").dataset.sheet ?? "";
    if (name === here) return;
    texts[here] = area.value;
    begin(texts[name] ?? examples.find((example) => example.dataset.sheet === name)?.text ?? "");
  };
}

/** A scenario whose first line names its schema to editors. @param {string} text */
const forEditors = (text) => (text.startsWith("#:schema") ? text : `#:schema asperity.schema.json\n${text}`);
byId("save").onclick = () => download(new Blob([forEditors(state.text)], { type: "application/toml" }), "scenario.toml");
/** @param {string} text @param {string} what */
const copy = (text, what) => navigator.clipboard.writeText(text).then(() => (byId("status").textContent = `${what} copied`), () => prompt(`Copy the ${what}:`, text));
byId("link").onclick = () => {
  location.hash = encodeURIComponent(state.text);
  copy(location.href, "link");
};
/** A text within three quotation marks of Python. @param {string} text */
const quoted = (text) => text.replace(/\\|'''/g, (found) => found.replace(/./g, "\\$&"));
byId("python").onclick = () => copy(`import asperity as asp\n\nresult = asp.run('''\n${quoted(state.text)}''')\nprint(result)\nresult.plot()\n`, "Python");

/** Shows readings, or none. @param {typeof state.measured} readings */
function showReadings(readings) {
  state.measured = readings;
  byId("forget").hidden = !readings;
  fail("", "file");
  charts.force.plot.redraw(false);
}
byId("forget").onclick = () => showReadings(null);

/** @param {File | undefined} file */
async function measured(file) {
  try {
    if (!file) return;
    if (file.size > 20e6) throw new Error(`expected a file below 20 MB, got ${(file.size / 1e6).toFixed(0)} MB`);
    const readings = readCurve(await file.text());
    const { position, force, columns } = readings;
    showReadings(readings);
    byId("status").textContent = `${position.length} readings: ${columns.join(" and ")}`;
    const { x, y } = charts.force.plot.scales;
    const within = (/** @type {number} */ value, /** @type {uPlot.Scale} */ { min, max }) => value >= (min ?? 0) && value <= (max ?? 0);
    const outside = position.filter((at, i) => !within(at, x) || !within(force[i], y)).length;
    if (outside) byId("status").textContent += `; ${outside} of them beyond the axes`;
  } catch (error) {
    fail(`${file?.name}: ${error instanceof Error ? error.message : error}`, "file");
  }
}
const chooser = /** @type {HTMLInputElement} */ (byId("csv"));
chooser.onchange = () => {
  measured(chooser.files?.[0]);
  // The same file may have changed when it is chosen again.
  chooser.value = "";
};
document.body.ondragover = (event) => { event.preventDefault(); document.body.classList.add("dropping"); };
document.body.ondragleave = () => document.body.classList.remove("dropping");
document.body.ondrop = (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  measured(event.dataTransfer?.files[0]);
};

/** @type {{engine: "browser" | "command" | "notebook", scenario?: string | null}} */
const settings = JSON.parse(byId("settings").textContent ?? "");
const FIRST = settings.scenario ?? examples[0].text.trimStart();
// A link to a page of a command or a notebook ends with it.
byId("link").hidden = settings.engine !== "browser";

/** The text of the link, if it has one. */
function linked() {
  try {
    return decodeURIComponent(location.hash.slice(1)) || FIRST;
  } catch {
    state.note = "The link is damaged: it holds no scenario.";
    return FIRST;
  }
}

addEventListener("hashchange", () => {
  const text = linked();
  if (text !== state.text) begin(text, -1, state.note);
});

/** @type {Requests} */
let engine;
Promise.resolve({ browser: browserEngine, command: commandEngine, notebook: notebookEngine }[settings.engine]()).then((found) => {
  engine = new Requests(found, receive, fail, progressed);
  begin(linked(), location.hash.length > 1 || settings.scenario ? -1 : 0, state.note);
}, (error) => fail(`The engine did not start: ${error}`));
