//! Loops on all threads, by rayon. WebAssembly has one thread: there they are loops, and rayon is left out.
//!
//! On threads they are compiled once for a type of items, not once for each caller. An item costs two indirect calls, little beside
//! work that is worth a thread. On one thread they are small, and smaller where they are compiled into their callers.

#[cfg(target_family = "wasm")]
pub use one_thread::*;
#[cfg(not(target_family = "wasm"))]
pub use threads::*;

#[cfg(not(target_family = "wasm"))]
mod threads {
    use rayon::prelude::*;
    pub use rayon::{current_num_threads, in_place_scope};

    /// Values of a function of the number of each item and of the item, in order.
    pub fn map<S: Send, T: Send>(items: Vec<S>, of: &(dyn Fn(usize, S) -> T + Sync)) -> Vec<T> {
        map_with(items, 1, &|| (), &|(), number, item| of(number, item))
    }

    /// The same with tools that are made for each share of the work, which has at least so many items.
    pub fn map_with<S: Send, W, T: Send>(
        items: Vec<S>,
        least: usize,
        tools: &(dyn Fn() -> W + Sync),
        of: &(dyn Fn(&mut W, usize, S) -> T + Sync),
    ) -> Vec<T> {
        let numbered = items.into_par_iter().enumerate().with_min_len(least);
        numbered.map_init(tools, |tools, (number, item)| of(tools, number, item)).collect()
    }
}

#[cfg(target_family = "wasm")]
mod one_thread {
    pub fn map<S, T>(items: Vec<S>, of: &impl Fn(usize, S) -> T) -> Vec<T> {
        items.into_iter().enumerate().map(|(number, item)| of(number, item)).collect()
    }

    pub fn map_with<S, W, T>(
        items: Vec<S>,
        _least: usize,
        tools: &impl Fn() -> W,
        of: &impl Fn(&mut W, usize, S) -> T,
    ) -> Vec<T> {
        let mut tools = tools();
        items.into_iter().enumerate().map(|(number, item)| of(&mut tools, number, item)).collect()
    }

    pub fn current_num_threads() -> usize {
        1
    }

    pub struct Scope;

    impl Scope {
        pub fn spawn(&self, work: impl FnOnce(&Self)) {
            work(self);
        }
    }

    pub fn in_place_scope<T>(work: impl FnOnce(&Scope) -> T) -> T {
        work(&Scope)
    }
}
