//! Pictures of curves in SVG, and what a page needs to drag points in them.
//!
//! Colours are the variables of the style of the page, such as `var(--blue)`.

mod axis;
mod field;
mod legend;
mod panel;
mod pen;
mod png;
mod svg;
mod words;

pub use field::Field;
pub use legend::{Form, Key};
pub use panel::{Column, Handle, Panel};
pub use pen::{Curve, Frame, Pen, Series};
pub use svg::Stroke;
pub use words::{Labels, escaped, plain};
