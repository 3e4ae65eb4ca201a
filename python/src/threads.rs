//! Threads of parallel loops, which do not survive a fork.

use std::cell::Cell;
use std::process;
use std::sync::OnceLock;

use rayon::ThreadPoolBuilder;

/// The process in which the threads of parallel loops were started.
static HOME: OnceLock<u32> = OnceLock::new();

thread_local! {
    /// Whether this thread runs parallel loops alone.
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Whether this process was forked after the first computation.
pub fn is_forked() -> bool {
    HOME.get().is_some_and(|home| *home != process::id())
}

/// Makes this thread run parallel loops alone if the process was forked after the first computation.
///
/// A fork copies only the calling thread; loops given to threads of the parent process would wait for ever.
pub fn settle() {
    let home = HOME.get_or_init(process::id);
    if *home == process::id() || ALONE.replace(true) {
        return;
    }
    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    // The pool is leaked, because the thread uses it as long as it lives.
    std::mem::forget(pool.expect("a pool of the thread that asks for it"));
}
