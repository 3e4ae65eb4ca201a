//! Scenario files in, results out: what every front end of asperity shares.

pub mod checkpoint;
pub mod duration;
mod folder;
pub mod input;
pub mod memory;
pub mod output;
pub mod summary;
pub mod task;
