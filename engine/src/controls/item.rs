//! A control: a slider, a field, a choice or a button.

use serde::Serialize;

use super::Row;
use crate::digits::brief;
use crate::picture::plain;
use crate::template;

/// Decades of a slider on either side of its middle.
const DECADES: f64 = 2.0;

/// A control of a row. Its change is JSON in which `$x` stands for the value.
#[derive(Debug, Default, Serialize)]
pub struct Item {
    /// The kind: `range`, `number`, `select` or `button`.
    pub kind: &'static str,
    /// Its name in the page; empty without one.
    pub id: String,
    /// Its name for screen readers; empty where a label has it.
    pub name: String,
    /// Its value, or the words on it.
    pub value: String,
    /// What it changes.
    pub change: String,
    /// What can be chosen.
    pub options: Vec<&'static str>,
    /// The ends of a range; exponents of 10 where it is logarithmic.
    pub ends: [f64; 2],
    /// Whether equal distances of a range are equal ratios.
    pub logarithmic: bool,
    /// Whether it cannot be used.
    pub disabled: bool,
}

impl Item {
    /// A button.
    pub fn button(value: &str, name: String, change: String) -> Self {
        Self { kind: "button", value: value.to_owned(), name, change, ..Self::default() }
    }

    /// A field of a number.
    pub fn number(id: String, name: String, value: f64, change: String) -> Self {
        Self { kind: "number", id, name, value: brief(value), change, ..Self::default() }
    }

    /// A choice.
    pub fn select(name: String, value: &str, options: Vec<&'static str>, change: String) -> Self {
        Self { kind: "select", name, value: value.to_owned(), options, change, ..Self::default() }
    }
}

/// A number with its slider: from 0 to `most`, or over four decades around the value.
pub fn number_row(group: &'static str, key: &str, label: &str, value: f64, most: Option<f64>) -> Row {
    let change = template::value(key);
    let (place, ends) = match most {
        Some(most) => (value, [0.0, if value > most { 2.0 * value } else { most }]),
        None => {
            // One at 0 begins around 1.
            let place = if value > 0.0 { value.log10() } else { -DECADES };
            let middle = if value > 0.0 { place.round() } else { 0.0 };
            (place, [middle - DECADES, middle + DECADES])
        }
    };
    let range = Item {
        kind: "range",
        name: format!("{}, slider", plain(label).replace('_', "")),
        value: place.to_string(),
        change: change.clone(),
        ends,
        logarithmic: most.is_none(),
        ..Item::default()
    };
    let field = Item::number(key.to_owned(), String::new(), value, change);
    Row { group, id: key.to_owned(), class: "row", label: label.to_owned(), items: vec![range, field] }
}
