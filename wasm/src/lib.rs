//! The engine of the explorer: the text of a scenario in, numbers and curves out.
//!
//! [`engine::Engine`] answers a [`request`] by an [`answer`], in any process. [`abi`] offers it to JavaScript as WebAssembly. It
//! computes nothing of its own: the curves are those of the master equation and of tasks in `asperity`.

pub mod abi;
pub mod answer;
pub mod edit;
pub mod engine;
pub mod request;
pub mod solved;
pub mod width_curve;
