//! Scenario files in, results out: what every front end of asperity shares.

pub mod checkpoint;
pub mod duration;
mod folder;
pub mod input;
pub mod memory;
pub mod output;
mod run;

pub use run::{run, run_with};
