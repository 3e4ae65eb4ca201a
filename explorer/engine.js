// Requests to the engine: one at work, one waiting; a newer one replaces the one that waits.
"use strict";

class Engine {
  /**
   * @param {string} script the code of the worker
   * @param {BufferSource} module the engine
   * @param {(answer: Answer, request: EngineRequest, milliseconds: number) => void} received
   * @param {(message: string) => void} failed
   */
  constructor(script, module, received, failed) {
    /** @type {EngineRequest | null} */
    this.working = null;
    /** @type {EngineRequest | null} */
    this.waiting = null;
    this.ready = false;
    this.received = received;
    this.worker = new Worker(URL.createObjectURL(new Blob([script], { type: "text/javascript" })));
    this.worker.onmessage = ({ data }) => {
      const request = this.working;
      this.working = null;
      if (data.ready) this.ready = true;
      else if (data.failure) failed(data.failure);
      else if (request) this.received(data.answer, request, data.milliseconds);
      this.next();
    };
    this.worker.onerror = (event) => failed(event.message);
    this.worker.postMessage({ module });
  }

  /** @param {EngineRequest} request */
  ask(request) {
    this.waiting = request;
    this.next();
  }

  next() {
    if (!this.ready || this.working || !this.waiting) return;
    [this.working, this.waiting] = [this.waiting, null];
    this.worker.postMessage({ request: this.working });
  }
}
