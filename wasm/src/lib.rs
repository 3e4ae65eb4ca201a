//! The engine of the explorer as WebAssembly: a request is written to a buffer, the answer read from another.
//!
//! Only numbers pass, so that no tool need generate code on either side, and the module imports nothing.
#![allow(
    unsafe_code,
    reason = "names that JavaScript calls must not be mangled; nothing here reads or writes through a pointer"
)]

use std::cell::RefCell;

use asperity_engine::Engine;

/// The engine, the request and the answer of the one thread that there is.
#[derive(Default)]
struct Exchange {
    engine: Engine,
    request: Vec<u8>,
    answer: Vec<u8>,
}

thread_local! {
    static EXCHANGE: RefCell<Exchange> = RefCell::default();
}

/// Where a request of `length` bytes is to be written.
#[unsafe(no_mangle)]
pub extern "C" fn request_buffer(length: usize) -> *mut u8 {
    EXCHANGE.with_borrow_mut(|exchange| {
        exchange.request.clear();
        exchange.request.resize(length, 0);
        exchange.request.as_mut_ptr()
    })
}

/// Answers the request; the length of the answer in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn answer_request() -> usize {
    EXCHANGE.with_borrow_mut(|exchange| {
        exchange.answer = exchange.engine.answer_json(&exchange.request, &mut ());
        exchange.answer.len()
    })
}

/// Where the last answer is.
#[unsafe(no_mangle)]
pub extern "C" fn answer_buffer() -> *const u8 {
    EXCHANGE.with_borrow(|exchange| exchange.answer.as_ptr())
}
