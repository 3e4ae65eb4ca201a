//! Loops on all threads, by rayon. WebAssembly has one thread: there they are loops, and rayon is left out.

#[cfg(not(target_family = "wasm"))]
pub use rayon::{current_num_threads, in_place_scope, prelude::*};
#[cfg(target_family = "wasm")]
pub use serial::*;

/// What of rayon is used, on one thread.
#[cfg(target_family = "wasm")]
mod serial {
    use std::slice::{Chunks, ChunksMut, Iter, IterMut};

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

    pub trait ParallelSlice<T> {
        fn par_iter(&self) -> Iter<'_, T>;
        fn par_iter_mut(&mut self) -> IterMut<'_, T>;
        fn par_chunks(&self, size: usize) -> Chunks<'_, T>;
        fn par_chunks_mut(&mut self, size: usize) -> ChunksMut<'_, T>;
    }

    impl<T> ParallelSlice<T> for [T] {
        fn par_iter(&self) -> Iter<'_, T> {
            self.iter()
        }

        fn par_iter_mut(&mut self) -> IterMut<'_, T> {
            self.iter_mut()
        }

        fn par_chunks(&self, size: usize) -> Chunks<'_, T> {
            self.chunks(size)
        }

        fn par_chunks_mut(&mut self, size: usize) -> ChunksMut<'_, T> {
            self.chunks_mut(size)
        }
    }

    pub trait IntoParallelIterator: IntoIterator + Sized {
        fn into_par_iter(self) -> Self::IntoIter {
            self.into_iter()
        }
    }

    impl<I: IntoIterator> IntoParallelIterator for I {}

    pub trait ParallelIterator: Iterator + Sized {
        fn with_min_len(self, _least: usize) -> Self {
            self
        }

        fn for_each_init<R>(self, tools: impl FnOnce() -> R, each: impl Fn(&mut R, Self::Item)) {
            let mut tools = tools();
            self.for_each(|item| each(&mut tools, item));
        }

        fn map_init<R, T>(
            self,
            tools: impl FnOnce() -> R,
            each: impl Fn(&mut R, Self::Item) -> T,
        ) -> impl Iterator<Item = T> {
            let mut tools = tools();
            self.map(move |item| each(&mut tools, item))
        }
    }

    impl<I: Iterator> ParallelIterator for I {}

    pub trait ParallelExtend<T> {
        fn par_extend(&mut self, items: impl IntoIterator<Item = T>);
    }

    impl<T> ParallelExtend<T> for Vec<T> {
        fn par_extend(&mut self, items: impl IntoIterator<Item = T>) {
            self.extend(items);
        }
    }
}
