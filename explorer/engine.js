// Engines, each a function that promises the answer to a request, and the order of the requests to them.
"use strict";

/** The engine in this page: WebAssembly in a thread of its own. @returns {Promise<Engine>} */
async function browserEngine() {
  const stored = (/** @type {string} */ id) => document.getElementById(id)?.textContent ?? "";
  const packed = Uint8Array.from(atob(stored("engine").trim()), (letter) => letter.charCodeAt(0));
  const module = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  const worker = new Worker(URL.createObjectURL(new Blob([stored("worker")], { type: "text/javascript" })));
  const exchange = (/** @type {{module: ArrayBuffer} | {request: EngineRequest}} */ message) =>
    new Promise((resolve, reject) => {
      worker.onmessage = ({ data }) => (data.failure ? reject(new Error(data.failure)) : resolve(data.answer));
      worker.onerror = (event) => reject(new Error(event.message));
      worker.postMessage(message);
    });
  await exchange({ module });
  return { compute: (request) => exchange({ request }), givesUp: false };
}

/** The command that has sent this page. @returns {Engine} */
function commandEngine() {
  const [, token] = location.pathname.split("/");
  const headers = { "content-type": "application/octet-stream", "asperity-token": token, "asperity-session": crypto.randomUUID() };
  let number = 0;
  const compute = async (/** @type {EngineRequest} */ request, /** @type {AbortSignal} */ signal) => {
    const sent = fetch("/compute", { method: "POST", headers: { ...headers, "asperity-number": String(++number) }, body: JSON.stringify(request), signal });
    const response = await sent.catch(() => Promise.reject(new Error("asperity explore does not answer: it has ended")));
    if (!response.ok) throw new Error(await response.text());
    return response.json();
  };
  return { compute, givesUp: true };
}

/** The notebook in which this page is a frame. @returns {Engine} */
function notebookEngine() {
  /** @type {Map<number, (answer: Answer) => void>} */
  const asked = new Map();
  let number = 0;
  addEventListener("message", ({ source, data }) => {
    if (source !== parent) return;
    asked.get(data.number)?.(data.answer);
    asked.delete(data.number);
  });
  const compute = (/** @type {EngineRequest} */ request) =>
    new Promise((/** @type {(answer: Answer) => void} */ resolve) => {
      asked.set(++number, resolve);
      parent.postMessage({ number, request }, "*");
    });
  return { compute, givesUp: false };
}

/** Requests to an engine: one at work, one waiting; a newer one replaces the one that waits. */
class Requests {
  /**
   * @param {Engine} engine
   * @param {(answer: Answer, request: EngineRequest, milliseconds: number) => void} received
   * @param {(message: string) => void} failed
   */
  constructor(engine, received, failed) {
    this.engine = engine;
    /** @type {EngineRequest | null} */
    this.working = null;
    /** @type {(() => EngineRequest) | null} */
    this.waiting = null;
    this.giveUp = new AbortController();
    this.received = received;
    this.failed = failed;
  }

  /** @param {() => EngineRequest} request made once it is sent, from what is known by then */
  ask(request) {
    this.waiting = request;
    // What takes long is given up by an engine that can; a preview is worth its while.
    if (this.engine.givesUp && this.working && !this.working.preview) {
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
    const begun = performance.now();
    try {
      const answer = await this.engine.compute(request, this.giveUp.signal);
      if (this.working === request) this.received(answer, request, performance.now() - begun);
    } catch (error) {
      if (this.working === request) this.failed(error instanceof Error ? error.message : String(error));
    }
    if (this.working !== request) return;
    this.working = null;
    this.next();
  }
}
