// The explorer: the text of a scenario is its state, which controls and dragged points change; the engine says what is shown.
"use strict";

const state = {
  text: "",
  /** Changes that the text does not have yet, by what they change. @type {Map<string, Change | Change[]>} */
  changes: new Map(),
  position: 1,
  /** @type {Partial<Answer>} */
  shown: {},
  /** @type {{position: number[], force: number[], columns: string[]} | null} */
  measured: null,
  /** What the readings are, until something changes. */
  readings: "",
  /** What is wrong with the link by which the page was opened, or with a change that was refused. */
  note: "",
};

const area = /** @type {HTMLTextAreaElement} */ (byId("text"));
const scrubber = /** @type {HTMLInputElement} */ (byId("position"));
const plots = byId("plots");
const figures = Object.fromEntries(Array.from(plots.querySelectorAll("figure"), (figure) => [figure.id, new Figure(figure)]));
const distance = () => state.shown.force?.position.at(-1) ?? 12;

/** What an answer has at a path, such as `force.position`. @param {string} path @returns {(number | null)[]} */
const found = (path) => path.split(".").reduce((part, name) => part?.[name], /** @type {any} */ (state.shown)) ?? [];

/** Says what is shown. @param {string} words */
const say = (words) => void (byId("status").textContent = words);

/** Says what is wrong with the scenario, or with the last file. @param {string} message @param {"scenario" | "file"} [of] */
const fail = (message, of = "scenario") => void (byId(`wrong-${of}`).textContent = message);

/** Asks for a preview, 600 pixels wide until the page is laid out; the answer to it asks for the full accuracy. */
function update(preview = true, /** @type {Part[]} */ parts = ["force", "stretches"]) {
  const width = parseFloat(getComputedStyle(plots).gridTemplateColumns) || 600;
  const view = { width, whole: plots.clientWidth || width, readings: state.measured !== null };
  engine?.ask(() => ({ text: state.text, changes: [...state.changes.values()].flat(), parts, position: state.position, preview, view }));
}

/** Notes a change in the place of an older one of the same thing. @param {string} change in JSON, of which x and y fill places */
function put(change, x = "", y = "") {
  state.changes.set(change, JSON.parse(change.replace(/\$x/g, x).replace(/\$y/g, y)));
  state.note = state.readings = "";
  chosen.selectedIndex = 0;
  update();
}

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
  const wrong = [invalid && (invalid.line ? `line ${invalid.line}: ` : "") + invalid.message, invalid?.help, ...(answer.failures ?? [])].filter(Boolean).join("\n");
  for (const [what, change] of state.changes) if ([change].flat().every((one) => request.changes.includes(one))) state.changes.delete(what);
  const current = request.text === state.text;
  if (request.changes.length && !answer.view) {
    // A value that was refused leaves its field, and the text stays as it was.
    if (current && state.changes.size === 0) state.note = wrong;
    if (state.shown.view) showControls(state.shown.view.controls);
    return update();
  }
  fail([...new Set([state.note, wrong])].filter(Boolean).join("\n"));
  // The answer to a request that could not be read has no text.
  if (current && answer.text !== "") {
    state.text = answer.text;
    if (area.value !== answer.text && (request.changes.length || document.activeElement !== area)) area.value = answer.text;
  }
  if (!answer.view) return say(`${invalid ? "not valid" : "no answer"}: the last valid scenario is shown`);
  show(answer, request);
  if (current) texts[answer.view.sheet] = state.text;
  say(state.readings || `${request.preview ? "preview" : "full accuracy"}, ${milliseconds.toFixed(0)} ms${request.preview ? " …" : ""}`);
  if (request.preview && !engine.waiting) update(false, ["force", "stretches", ...answer.view.details]);
}

/** The pictures of what a preview has; others stay until the new ones are there. */
const QUICK = ["force", "laws", "stretches"];

/** Shows an answer. @param {Answer} answer @param {EngineRequest} request */
function show(answer, { preview, position }) {
  const { sheet, controls, panels, numbers, length } = /** @type {Shown} */ (answer.view);
  // What was computed last is not shown on another sheet.
  const stays = preview && sheet === plots.dataset.sheet;
  const { force, stretches, ...lasting } = state.shown;
  state.shown = stays ? { ...lasting, ...answer } : answer;
  plots.dataset.sheet = sheet;
  for (const button of sheets) button.setAttribute("aria-current", button.dataset.sheet === sheet ? "page" : "false");
  showControls(controls);
  for (const [id, figure] of Object.entries(figures)) {
    const before = stays && !QUICK.includes(id) ? figure.panel : null;
    figure.show(panels.find((panel) => panel.id === id) ?? before);
  }
  byId("numbers").innerHTML = numbers.map(([name, value]) => `<tr><td>${name}</td><td>${value}</td></tr>`).join("");
  if (!answer.stretches) return;
  if (position === state.position) state.position = answer.stretches.position;
  scrubber.value = String(Math.round((1000 * state.position) / distance()));
  byId("at").textContent = `X = ${rounded(state.position)}${length}`;
}

/** Takes another text. @param {string} text @param {number} [example] its number, if it is one @param {string} [note] what is wrong with its link */
function take(text, example = -1, note = "") {
  chosen.selectedIndex = example + 1;
  say("computing …");
  state.text = text;
  state.changes.clear();
  [state.note, state.readings] = [note, ""];
  update();
}
area.oninput = () => take(area.value);
scrubber.oninput = () => scrub((Number(scrubber.value) / 1000) * distance());

/** Pictures have the width of the page. */
let drawn = plots.clientWidth;
new ResizeObserver(() => {
  if (drawn !== (drawn = plots.clientWidth)) update();
}).observe(plots);

let playing = 0;
/** @param {boolean} plays */
function play(plays) {
  clearInterval(playing);
  playing = plays ? setInterval(() => scrub(state.position >= distance() ? 0 : state.position + distance() / 300), 40) : 0;
  byId("play").setAttribute("aria-pressed", String(playing !== 0));
  byId("play").textContent = playing ? "Stop" : "Play";
}
byId("play").onclick = () => play(playing === 0);

/** The scenarios to begin with, the first of each sheet first. */
const examples = [.../** @type {NodeListOf<HTMLScriptElement>} */ (document.querySelectorAll("script.example"))];
const chosen = /** @type {HTMLSelectElement} */ (byId("examples"));
// A scenario of the user's own is none of them.
chosen.append(Object.assign(new Option("Examples"), { disabled: true }), ...examples.map(({ title }) => new Option(title, title)));

/** Replaces the scenario. @param {string} text @param {number} [example] its number, if it is one @param {string} [note] what is wrong with its link */
function begin(text, example = -1, note = "") {
  play(false);
  area.value = text.trimStart();
  take(area.value, example, note);
}
chosen.onchange = () => begin(examples[chosen.selectedIndex - 1].text, chosen.selectedIndex - 1);

/** The last text of each sheet. @type {Record<string, string>} */
const texts = {};
const sheets = [.../** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("#sheets button"))];
for (const sheet of sheets) {
  const name = sheet.dataset.sheet ?? "";
  sheet.onclick = () => {
    const here = plots.dataset.sheet ?? "";
    if (name === here) return;
    texts[here] = area.value;
    begin(texts[name] ?? examples.find((example) => example.dataset.sheet === name)?.text ?? "");
  };
}

/** A scenario whose first line names its schema to editors. @param {string} text */
const forEditors = (text) => (text.startsWith("#:schema") ? text : `#:schema asperity.schema.json\n${text}`);
byId("save").onclick = () => download(new Blob([forEditors(state.text)], { type: "application/toml" }), "scenario.toml");
/** @param {string} text @param {string} what */
const copy = (text, what) => navigator.clipboard.writeText(text).then(() => say(`${what} copied`), () => prompt(`Copy the ${what}:`, text));
byId("link").onclick = () => {
  location.hash = encodeURIComponent(state.text);
  copy(location.href, "link");
};
/** A text within three quotation marks of Python. @param {string} text */
const quoted = (text) => text.replace(/\\|'''|'$/g, (found) => found.replace(/./g, "\\$&"));
byId("python").onclick = () => copy(`import asperity as asp\n\nresult = asp.run('''\n${quoted(state.text)}''')\nprint(result)\nresult.plot()\n`, "Python");

/** Shows readings, or none. @param {typeof state.measured} readings */
function showReadings(readings, words = "") {
  state.measured = readings;
  state.readings = words;
  byId("forget").hidden = !readings;
  fail("", "file");
  update();
}
byId("forget").onclick = () => showReadings(null);

/** @param {File | undefined} file */
async function measured(file) {
  try {
    if (!file) return;
    if (file.size > 20e6) throw new Error(`expected a file below 20 MB, got ${(file.size / 1e6).toFixed(0)} MB`);
    const readings = readCurve(await file.text());
    const { position, force, columns } = readings;
    const words = `${position.length} readings: ${columns.join(" and ")}`;
    const { x, y } = figures.force.panel ?? {};
    const within = (/** @type {number} */ value, /** @type {Axis | undefined} */ axis) => !axis || (value >= axis.min && value <= axis.max);
    const outside = position.filter((at, i) => !within(at, x) || !within(force[i], y)).length;
    showReadings(readings, outside ? `${words}; ${outside} of them beyond the axes` : words);
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
  state.note = "";
  try {
    return decodeURIComponent(location.hash.slice(1)) || FIRST;
  } catch {
    state.note = "The link is damaged: it holds no scenario.";
    return FIRST;
  }
}

addEventListener("hashchange", () => {
  const text = linked();
  if (text !== state.text || state.note) begin(text, -1, state.note);
});

/** @type {Requests} */
let engine;
Promise.resolve({ browser: browserEngine, command: commandEngine, notebook: notebookEngine }[settings.engine]()).then((found) => {
  const failed = (/** @type {string} */ message) => { fail(message); say("no answer: the last valid scenario is shown"); };
  engine = new Requests(found, { received: receive, failed, progressed });
  begin(linked(), location.hash.length > 1 || settings.scenario ? -1 : 0, state.note);
}, (error) => fail(`The engine did not start: ${error}`));
