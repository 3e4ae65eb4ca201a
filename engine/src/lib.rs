//! The engine of the explorer: the text of a scenario in, numbers and curves out.
//!
//! [`Engine`] answers a [`request`] by an [`answer`], in any process: in the command and in Python, and as WebAssembly in a
//! browser. It computes nothing of its own: the curves are those of the master equation and of tasks in `asperity`. [`page`] is the
//! page that asks it.

pub mod answer;
mod edit;
mod engine;
mod handles;
mod law_change;
mod limits;
pub mod page;
mod polygon;
mod replace;
pub mod request;
mod solved;
mod width_curve;

pub use engine::Engine;
pub use law_change::LawChange;
pub use limits::Limits;
