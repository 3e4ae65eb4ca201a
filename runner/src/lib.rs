//! Input and output shared by the command and the Python package: scenario files, checkpoints, results.

// WebAssembly reads scenarios and has no runs, which use the rest.
#![cfg_attr(target_family = "wasm", allow(dead_code, unused_imports))]

pub mod checkpoint;
pub mod duration;
mod folder;
pub mod input;
pub mod memory;
mod numbers;
pub mod output;
// The sampler of posteriors, which runs may need, asks an operating system for a clock and for random numbers; WebAssembly has
// neither.
#[cfg(not(target_family = "wasm"))]
pub mod posterior;
#[cfg(not(target_family = "wasm"))]
mod run;
#[cfg(not(target_family = "wasm"))]
pub mod sweep;
pub mod threads;

pub use output::StoredColumns;
#[cfg(not(target_family = "wasm"))]
pub use run::{run, run_with};
