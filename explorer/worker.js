// The engine in a thread of its own: the first message is the WebAssembly module, every other one a request.
"use strict";

/** @type {{memory: WebAssembly.Memory, request_buffer(length: number): number, answer_request(): number, answer_buffer(): number} | undefined} */
let compiled;
let reported = 0;

/** Says how far the work is, ten times in a second. @param {number} fraction */
function progress(fraction) {
  if (performance.now() < reported + 100) return;
  reported = performance.now();
  postMessage({ fraction });
}

/** @param {unknown} request */
function answer(request) {
  if (!compiled) throw new Error("the engine is not there yet");
  const bytes = new TextEncoder().encode(JSON.stringify(request));
  // The memory has another buffer once it has grown.
  const at = compiled.request_buffer(bytes.length);
  new Uint8Array(compiled.memory.buffer, at, bytes.length).set(bytes);
  const length = compiled.answer_request();
  const found = compiled.answer_buffer();
  return JSON.parse(new TextDecoder().decode(new Uint8Array(compiled.memory.buffer, found, length)));
}

addEventListener("message", ({ data }) => {
  try {
    if (data.module) compiled = /** @type {any} */ (new WebAssembly.Instance(data.module, { page: { progress } }).exports);
    else postMessage({ answer: answer(data.request) });
  } catch (error) {
    postMessage({ failure: String(error) });
  }
});
