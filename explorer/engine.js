// Requests to the engine: one at work, one waiting; a newer one replaces the one that waits.
"use strict";

/**
 * @typedef {{key: string, value: string | null}} Change
 * @typedef {{text: string, changes: Change[], parts: string[], position: number, preview: boolean}} EngineRequest
 * @typedef {{values: number[], at: number[], weights: number[]}} Density
 * @typedef {{variables: {name: string, values: number[]}[]}} Arrays
 * @typedef {{drive: number, position: number, force: number}} SliderState
 * @typedef {{regime: string, reason: string, slips: number, period?: number, mean_drop?: number, first_instability?: SliderState}} Sliding
 * @typedef {number | string} Extended
 * @typedef {object} ForceCurve
 * @property {number[]} position
 * @property {number[]} force
 * @property {number[]} [force_std]
 * @property {{position: number, value: number}} [static_friction]
 * @property {number} kinetic_friction
 * @property {Extended} relaxation_length
 * @property {Extended} critical_stiffness
 * @property {number} accuracy
 * @typedef {object} Answer
 * @property {string} text
 * @property {any} [scenario]
 * @property {{key: string, message: string, help: string | null, line: number | null}} [invalid]
 * @property {string[]} [failures]
 * @property {ForceCurve} [force]
 * @property {{stretch: number[], position: number, density: Density, steady: Density, thresholds: Density, reforming: Density, initial: Density}} [stretches]
 * @property {{width: number[], critical_stiffness: Extended[]}} [critical_stiffness]
 * @property {{summary: Sliding, record: Arrays}} [block]
 */

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
