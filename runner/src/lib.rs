//! Input and output shared by the command and the Python package: scenario files, checkpoints, results.

pub mod checkpoint;
mod columns;
pub mod duration;
mod folder;
pub mod input;
pub mod memory;
pub mod output;
pub mod posterior;
mod run;
pub mod threads;

pub use columns::StoredColumns;
pub use run::{run, run_with};
