//! The engine of the explorer: the text of a scenario in, numbers and curves out.
//!
//! [`Engine`] answers a [`request`] by an [`answer`], in any process: in the command and in Python, and as WebAssembly in a
//! browser. It computes nothing of its own: the curves are those of the master equation and of tasks in `asperity`. For a page it
//! draws them (`panels`, `picture`) and describes what can be chosen (`controls`). [`page`] is the page that asks it.

pub mod answer;
mod controls;
mod digits;
mod edit;
mod engine;
mod handles;
mod law_change;
mod limits;
mod numbers;
pub mod page;
mod panels;
mod picture;
mod polygon;
mod replace;
pub mod request;
mod sheet;
pub mod shown;
mod slip_rule;
mod solved;
mod template;
mod width;
mod width_curve;

pub use engine::Engine;
pub use law_change::LawChange;
pub use limits::Limits;
