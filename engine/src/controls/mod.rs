//! The controls of the page: what can be chosen of a scenario, and the change that each makes.

mod item;
mod law;
mod slider;

use asperity::scenario::{Law, Scenario};
use serde::Serialize;

use crate::digits::rounded;
use item::Item;

/// A row of controls.
#[derive(Debug, Serialize)]
pub struct Row {
    /// The name of the group in the page.
    pub group: &'static str,
    /// The name of the row, by which the page finds it again.
    pub id: String,
    /// The class of its style.
    pub class: &'static str,
    /// Words before the controls, in HTML.
    pub label: String,
    /// The controls.
    pub items: Vec<Item>,
}

/// The controls of a scenario, from above.
pub fn rows(scenario: &Scenario) -> Vec<Row> {
    let contacts = &scenario.contacts;
    let most = largest(contacts.thresholds.as_ref());
    let mut rows = vec![];
    for (group, key, of, law) in [
        ("thresholds", "contacts.thresholds", "Thresholds Pc", contacts.thresholds.as_ref()),
        ("reforming", "contacts.reforming", "Re-formed contacts R", Some(&contacts.reforming)),
        ("initial", "initial", "First stretches Qini", Some(&scenario.initial)),
    ] {
        let (key, of) = (key.to_owned(), of.to_owned());
        law::add(&mut rows, law::Place { group, key, of, part: false, most }, law);
    }
    slider::add(&mut rows, scenario);
    rows
}

/// The largest stretch of a slider that begins at 0: twice the mean threshold.
fn largest(thresholds: Option<&Law>) -> f64 {
    let mean = thresholds.and_then(|law| Some(law.build().ok()?.mean()));
    rounded(2.0 * mean.filter(|&mean| mean > 0.0).unwrap_or(1.0), 3)
}
