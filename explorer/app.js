// The explorer: the text of a scenario is its state. Controls, dragged points and the text itself change it, the engine answers,
// and everything is drawn from the answer.
"use strict";

const byId = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));
const area = /** @type {HTMLTextAreaElement} */ (byId("text"));
const scrubber = /** @type {HTMLInputElement} */ (byId("position"));

/** @param {string} message */
function fail(message) {
  byId("errors").hidden = !message;
  byId("errors").textContent = message;
}

/** Asks for a preview; the answer to it asks for the full accuracy. */
function update(preview = true, /** @type {Part[]} */ parts = ["force", "stretches"]) {
  const changes = () => [...state.changes].map(([key, value]) => ({ key, value }));
  engine.ask(() => ({ text: state.text, changes: changes(), parts, position: state.position, preview }));
}

/** @type {Changed} */
function change(key, value) {
  state.changes.set(key, value);
  state.note = "";
  update();
}

/** @param {number} x */
function scrub(x) {
  state.position = Math.min(Math.max(x, 0), distance());
  update();
}

/** @param {Answer} answer @param {EngineRequest} request @param {number} milliseconds */
function receive(answer, request, milliseconds) {
  const { invalid } = answer;
  const where = invalid?.line ? `line ${invalid.line}: ` : "";
  fail([state.note, invalid && where + invalid.message, invalid?.help, ...(answer.failures ?? [])].filter(Boolean).join("\n"));
  for (const { key, value } of request.changes) if (state.changes.get(key) === value) state.changes.delete(key);
  if (request.text === state.text) {
    state.text = answer.text;
    if (area.value !== answer.text && (request.changes.length || document.activeElement !== area)) area.value = answer.text;
  }
  if (invalid || !answer.scenario) return;
  Object.assign(state.shown, answer);
  units = answer.units ?? {};
  if (!request.preview && !answer.block) delete state.shown.block;
  if (!request.preview && !answer.task) delete state.shown.task;
  if (!request.preview && !answer.critical_stiffness) delete state.shown.critical_stiffness;
  show(request.preview);
  const cost = `${milliseconds.toFixed(0)} ms`;
  byId("status").textContent = request.preview ? `preview, ${cost}; the full accuracy is computed …` : `full accuracy, ${cost}`;
  if (request.preview && !engine.waiting) update(false, ["force", "stretches", ...details(answer.scenario)]);
}

/** What takes longer than a preview: the map where thresholds have a width, and the motion or the task. @param {any} scenario @returns {Part[]} */
function details(scenario) {
  const [law] = /** @type {any[]} */ (Object.values(scenario.contacts.thresholds ?? {}));
  /** @type {Part[]} */
  const motion = scenario.block && scenario.drive ? ["block"] : scenario.pull || scenario.drive ? [] : ["task"];
  return law?.std > 0 && !motion.includes("task") ? ["critical_stiffness", ...motion] : motion;
}

const editors = [
  { of: new LawEditor("thresholds", "contacts.thresholds", change), law: (/** @type {any} */ scenario) => scenario.contacts.thresholds },
  { of: new LawEditor("reforming", "contacts.reforming", change), law: (/** @type {any} */ scenario) => scenario.contacts.reforming },
  { of: new LawEditor("initial", "initial", change), law: (/** @type {any} */ scenario) => scenario.initial },
];
const slider = byId("slider");
const rows = [
  { of: new NumberRow(slider, "block.stiffness", "<i>K</i>", change), value: (/** @type {any} */ scenario) => scenario.block?.stiffness },
  { of: new NumberRow(slider, "contacts.count", "<i>N</i><sub>c</sub>", change), value: (/** @type {any} */ scenario) => scenario.contacts.count },
  { of: new NumberRow(slider, "contacts.stiffness", "⟨<i>k</i>⟩", change), value: (/** @type {any} */ scenario) => scenario.contacts.stiffness },
  { of: new NumberRow(slider, "drive.distance", "distance", change), value: (/** @type {any} */ scenario) => scenario.drive?.distance },
];
const slip = new SlipRule(slider, change);

/** A number with the digits that are right. @param {Extended | undefined | null} value @param {number} error */
function digits(value, error) {
  if (typeof value !== "number") return value ?? "—";
  if (value === 0) return "0";
  const right = !(error > 0) ? 10 : Math.floor(Math.log10(Math.abs(value) / error));
  return value.toPrecision(Math.min(Math.max(right, 2), 10)).replace("e", " e");
}

/** @param {number} error relative error of forces */
function numbers(error) {
  const { force, block } = state.shown;
  const sliding = block?.summary;
  const found = /** @type {[string, Extended | undefined | null, number][]} */ ([
    ["static friction <i>F</i><sub>s</sub>", force?.static_friction?.value ?? "not reached", error],
    ["at <i>X</i><sub>s</sub>", force?.static_friction?.position, Math.sqrt(error)],
    ["kinetic friction <i>F</i><sub>k</sub>", force?.kinetic_friction, error],
    ["relaxation length <i>X</i>*", force?.relaxation_length, Math.sqrt(error)],
    ["critical stiffness <i>K</i><sub>c</sub>", force?.critical_stiffness, 10 * error],
    ["sliding", sliding?.regime ?? "no [block]", 0],
    ["slips", sliding ? String(sliding.slips) : null, 0],
    ["period", sliding?.period, 1e-6],
    ["mean force drop", sliding?.mean_drop, 1e-6],
  ]);
  byId("numbers").innerHTML = found.map(([name, value, wrong]) => `<tr><td>${name}</td><td>${digits(value, wrong)}</td></tr>`).join("");
}

/** @param {boolean} preview */
function show(preview) {
  const { force, stretches, critical_stiffness: curve, scenario } = state.shown;
  for (const { of, law } of editors) of.show(law(scenario));
  for (const { of, value } of rows) of.show(value(scenario));
  slip.show(scenario.block?.slip);
  if (force) charts.force.set([force.position, force.force, force.position.map(() => force.kinetic_friction)]);
  if (stretches) {
    charts.laws.set([stretches.law_stretch, ...LAWS.map(([name]) => stretches[name].values)]);
    charts.stretches.set([stretches.stretch, stretches.density.values, stretches.steady.values]);
    scrubber.value = String(Math.round((1000 * state.position) / distance()));
    byId("at").textContent = `X = ${rounded(state.position)}`;
  }
  showMotion();
  charts.map.element.hidden = !curve;
  charts.map.set(curve ? [curve.width, curve.critical_stiffness.map(finite)] : [[], []]);
  numbers(preview ? 1e-4 : Math.max(force?.accuracy ?? 0, 1e-12));
}

area.oninput = () => {
  state.text = area.value;
  state.changes.clear();
  update();
};
scrubber.oninput = () => scrub((Number(scrubber.value) / 1000) * distance());

/** @type {number | undefined} */
let playing;
byId("play").onclick = () => {
  playing = playing === undefined ? setInterval(() => scrub(state.position >= distance() ? 0 : state.position + distance() / 300), 40) : (clearInterval(playing), undefined);
  byId("play").setAttribute("aria-pressed", String(playing !== undefined));
  byId("play").textContent = playing === undefined ? "Play" : "Stop";
};

const examples = /** @type {HTMLSelectElement} */ (byId("examples"));
examples.append(...Object.keys(EXAMPLES).map((name) => Object.assign(element("option"), { value: name, textContent: name })));
examples.onchange = () => {
  state.text = area.value = EXAMPLES[examples.value];
  state.changes.clear();
  state.note = "";
  update();
};

byId("save").onclick = () => download(new Blob([state.text], { type: "application/toml" }), "scenario.toml");
/** @param {string} text @param {string} what */
const copy = (text, what) => navigator.clipboard.writeText(text).then(() => (byId("status").textContent = `${what} copied`), () => prompt(`Copy the ${what}:`, text));
byId("link").onclick = () => {
  location.hash = encodeURIComponent(state.text);
  copy(location.href, "link");
};
byId("python").onclick = () => copy(`import asperity as asp\n\nresult = asp.run('''\n${state.text}''')\nprint(result)\nresult.plot()\n`, "Python");

/** @param {File | undefined} file */
async function measured(file) {
  try {
    if (!file) return;
    if (file.size > 20e6) throw new Error(`expected a file below 20 MB, got ${(file.size / 1e6).toFixed(0)} MB`);
    state.measured = readCurve(await file.text());
    byId("status").textContent = `${state.measured.position.length} readings: ${state.measured.columns.join(" and ")}`;
    fail("");
    charts.force.plot.redraw(false);
  } catch (error) {
    fail(`${file?.name}: ${error instanceof Error ? error.message : error}`);
  }
}
byId("csv").onchange = () => measured(/** @type {HTMLInputElement} */ (byId("csv")).files?.[0]);
document.body.ondragover = (event) => { event.preventDefault(); document.body.classList.add("dropping"); };
document.body.ondragleave = () => document.body.classList.remove("dropping");
document.body.ondrop = (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  measured(event.dataTransfer?.files[0]);
};

/** @type {{engine: "browser" | "command" | "notebook", scenario?: string | null}} */
const settings = JSON.parse(byId("settings").textContent ?? "");
const FIRST = settings.scenario ?? EXAMPLES["Stick-slip"];
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

/** @type {Requests} */
let engine;
Promise.resolve({ browser: browserEngine, command: commandEngine, notebook: notebookEngine }[settings.engine]()).then((found) => {
  engine = new Requests(found, receive, fail);
  state.text = area.value = linked();
  update();
}, (error) => fail(`The engine did not start: ${error}`));
