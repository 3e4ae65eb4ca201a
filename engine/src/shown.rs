//! What a page shows of an answer.

use serde::Serialize;

use crate::controls::Row;
use crate::picture::Panel;
use crate::request::Part;

/// What a page shows of an answer.
#[derive(Debug, Serialize)]
pub struct Shown {
    /// The sheet to which the scenario belongs.
    pub sheet: &'static str,
    /// What takes longer than a preview, and can be asked for.
    pub details: Vec<Part>,
    /// The controls.
    pub controls: Vec<Row>,
    /// The pictures of what has changed.
    pub panels: Vec<Panel>,
    /// The table of numbers.
    pub numbers: Vec<NumberRow>,
    /// The label of the unit of length, after a blank.
    pub length: String,
}

/// A row of the table of numbers, in HTML: a name and a value.
#[derive(Debug, Serialize)]
pub struct NumberRow(pub &'static str, pub String);
