//! The threads of parallel loops, which a fork leaves behind.

use std::cell::Cell;
use std::process;
use std::sync::OnceLock;

use rayon::ThreadPoolBuilder;

/// The process that first computed here, in which the threads of all parallel loops are.
static HOME: OnceLock<u32> = OnceLock::new();

thread_local! {
    /// Whether parallel loops of this thread are its own.
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Lets this thread do parallel loops alone where the process was forked after the first computation.
///
/// A fork copies the thread that calls it and no other; loops handed to those of the parent would wait for ever.
pub fn settle() {
    let home = HOME.get_or_init(process::id);
    if *home == process::id() || ALONE.replace(true) {
        return;
    }
    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    // It is this thread's for as long as it lives.
    std::mem::forget(pool.expect("a pool of the thread that asks for it"));
}
