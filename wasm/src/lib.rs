//! The engine of the explorer as WebAssembly: a request is written to a buffer, the answer read from another.
//!
//! Only numbers pass, so that no tool need generate code on either side. The module imports one function, by which the page hears of
//! the progress of work that it waits for: while a request is answered, nothing else can be asked.
#![allow(
    unsafe_code,
    reason = "names that JavaScript calls must not be mangled, and a function of it is called with a number; nothing here reads or \
              writes through a pointer"
)]

use std::cell::RefCell;
use std::ops::ControlFlow;

use asperity::monitor::Monitor;
use asperity_engine::Engine;

#[cfg(target_family = "wasm")]
#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Hears of the fraction of the work that is done.
    safe fn progress(fraction: f64);
}

/// Elsewhere the crate is only checked.
#[cfg(not(target_family = "wasm"))]
fn progress(_fraction: f64) {}

/// Tells the page how far the work is. A page that does not wait any longer ends the thread.
struct Page;

impl Monitor for Page {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        progress(fraction);
        ControlFlow::Continue(())
    }

    /// A quarter of what can be addressed.
    fn memory(&self) -> u64 {
        1 << 30
    }
}

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
        exchange.answer = exchange.engine.answer_json(&exchange.request, &mut Page);
        exchange.answer.len()
    })
}

/// Where the last answer is.
#[unsafe(no_mangle)]
pub extern "C" fn answer_buffer() -> *const u8 {
    EXCHANGE.with_borrow(|exchange| exchange.answer.as_ptr())
}
