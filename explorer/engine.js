// Engines, each a function that promises the answer to a request, and the order of the requests to them.
"use strict";

/** Milliseconds after which work that nobody waits for is ended: a new thread has nothing of what the old one has solved. */
const PATIENCE = 300;

/** Milliseconds after which a preview is given up for a newer request. */
const LONG = 1000;

/** The engine in this page: WebAssembly in a thread of its own. @returns {Promise<Engine>} */
async function browserEngine() {
  const stored = (/** @type {string} */ id) => document.getElementById(id)?.textContent ?? "";
  const packed = Uint8Array.from(atob(stored("engine").trim()), (letter) => letter.charCodeAt(0));
  const unpacked = new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip")));
  const module = await WebAssembly.compile(await unpacked.arrayBuffer());
  const source = URL.createObjectURL(new Blob([stored("worker")], { type: "text/javascript" }));
  const start = () => {
    const worker = new Worker(source);
    worker.postMessage({ module });
    return worker;
  };
  let worker = start();
  /** @type {Engine["compute"]} */
  const exchange = (request, signal, progress) =>
    new Promise((resolve, reject) => {
      signal.throwIfAborted();
      const begun = performance.now();
      let end = 0;
      const done = () => { signal.onabort = null; clearTimeout(end); };
      signal.onabort = () => {
        end = setTimeout(() => {
          worker.terminate();
          worker = start();
          reject(new Error("given up"));
        }, PATIENCE + begun - performance.now());
      };
      worker.onmessage = ({ data: { fraction, answer, failure } }) => {
        if (fraction !== undefined) return progress(fraction);
        done();
        if (answer) resolve(answer);
        else reject(new Error(failure));
      };
      worker.onerror = (event) => { done(); reject(new Error(event.message)); };
      worker.postMessage({ request });
    });
  /** @type {Promise<any>} */
  let last = Promise.resolve();
  return { compute: (...asked) => (last = last.catch(() => {}).then(() => exchange(...asked))) };
}

/** The command that has sent this page. @returns {Engine} */
function commandEngine() {
  const [, token] = location.pathname.split("/");
  const session = { "content-type": "application/octet-stream", "asperity-token": token, "asperity-session": crypto.randomUUID() };
  let number = 0;
  /** @type {Engine["compute"]} */
  const compute = async (request, signal, progress) => {
    const sent = { method: "POST", headers: { ...session, "asperity-number": String(++number) }, signal };
    const asking = setInterval(async () => {
      const reported = await fetch("/progress", sent).catch(() => null);
      if (reported?.ok) progress((await reported.json()).progress);
    }, 300);
    try {
      const answered = fetch("/compute", { ...sent, body: JSON.stringify(request) });
      const response = await answered.catch(() => Promise.reject(new Error("asperity explore does not answer: it has ended")));
      if (!response.ok) throw new Error(await response.text());
      return await response.json();
    } finally {
      clearInterval(asking);
    }
  };
  return { compute };
}

/** The notebook in which this page is a frame. @returns {Engine} */
function notebookEngine() {
  /** @type {Map<number, {resolve: (answer: Answer) => void, progress: (fraction: number) => void}>} */
  const asked = new Map();
  let number = 0;
  addEventListener("message", ({ source, data }) => {
    if (source !== parent) return;
    const { number, progress, answer } = data;
    if (!answer) return asked.get(number)?.progress(progress);
    asked.get(number)?.resolve(answer);
    asked.delete(number);
  });
  /** @type {Engine["compute"]} */
  const compute = (request, signal, progress) =>
    new Promise((resolve) => {
      const own = ++number;
      asked.set(own, { resolve, progress });
      // The kernel gives up what it computes for this page once it hears of another request.
      signal.onabort = () => asked.delete(own);
      parent.postMessage({ number: own, request }, "*");
    });
  return { compute };
}

/** Requests to an engine: one at work, one waiting; a newer one replaces the one that waits. */
class Requests {
  /** @param {Engine} engine @param {Page} page */
  constructor(engine, page) {
    this.engine = engine;
    this.page = page;
    /** @type {EngineRequest | null} */
    this.working = null;
    /** @type {(() => EngineRequest) | null} */
    this.waiting = null;
    this.giveUp = new AbortController();
    /** When the work began, in milliseconds. */
    this.begun = 0;
  }

  /** @param {() => EngineRequest} request made once it is sent, from what is known by then */
  ask(request) {
    this.waiting = request;
    // What takes long is given up; a preview is worth its while, unless it takes long, too.
    if (this.working && (!this.working.preview || performance.now() - this.begun > LONG)) {
      this.working = null;
      this.giveUp.abort();
    }
    this.next();
  }

  async next() {
    if (this.working || !this.waiting) return;
    const request = (this.working = this.waiting());
    this.waiting = null;
    this.giveUp = new AbortController();
    const begun = (this.begun = performance.now());
    const own = () => this.working === request;
    // What hears of the answer may ask for more, which is no reason to give this up.
    const ends = () => own() && !(this.working = null);
    const failed = (/** @type {unknown} */ error) => this.page.failed(error instanceof Error ? error.message : String(error));
    this.page.progressed(null, 0);
    await this.engine.compute(request, this.giveUp.signal, (fraction) => own() && this.page.progressed(fraction, performance.now() - begun)).then(
      (answer) => ends() && this.page.received(answer, request, performance.now() - begun),
      (error) => ends() && failed(error),
    ).catch(failed);
    if (!this.working) this.page.progressed(null, 0);
    this.next();
  }
}
