//! A distribution: its family, and its parameters, nodes or parts.

use asperity::scenario::{Component, Law};
use serde::Serialize as _;
use toml_edit::Value;
use toml_edit::ser::ValueSerializer;

use super::Row;
use super::item::{Item, number_row};
use crate::digits::rounded;
use crate::polygon::{MOST, Polygon};
use crate::template;

/// The families that can be chosen; a mixture is not part of another.
const FAMILIES: [&str; 9] = [
    "gaussian",
    "gamma",
    "lognormal",
    "weibull",
    "rectangular",
    "exponential",
    "point",
    "tabulated",
    "mixture",
];
/// Digits of the places of nodes, as in the text.
const DIGITS: usize = 5;
/// Where a distribution stands.
#[derive(Debug, Clone)]
pub struct Place {
    /// The group of its controls.
    pub group: &'static str,
    /// Its key.
    pub key: String,
    /// What it describes.
    pub of: String,
    /// Whether it is a part of a mixture.
    pub part: bool,
    /// The largest value of a slider that begins at 0.
    pub most: f64,
}

impl Place {
    fn row(&self, name: &str, class: &'static str, items: Vec<Item>) -> Row {
        Row { group: self.group, id: format!("{} {name}", self.key), class, label: String::new(), items }
    }

    fn class(&self, part: &'static str, whole: &'static str) -> &'static str {
        if self.part { part } else { whole }
    }

    fn only(&self) -> &'static str {
        self.class("row only part", "row only")
    }
}

/// Adds the controls of a distribution; without one only the choice.
pub fn add(rows: &mut Vec<Row>, place: Place, law: Option<&Law>) {
    let family = law.map_or("—", Law::name);
    let count = FAMILIES.len() - usize::from(place.part);
    let mut options = FAMILIES[..count].to_vec();
    if !options.contains(&family) {
        options.insert(0, family);
    }
    let change = template::law(&place.key, "family", "\"$x\"");
    let select = Item::select(format!("Distribution of {}", place.of), family, options, change);
    rows.push(place.row("family", place.only(), vec![select]));
    let Some(law) = law else { return };
    add_parameters(rows, &place, law);
    if let Ok(polygon) = Polygon::of(law) {
        add_nodes(rows, &place, &polygon);
    }
    if let Law::Mixture(parts) = law {
        add_parts(rows, &place, parts);
    }
}

/// Adds a row for each parameter that is a number.
fn add_parameters(rows: &mut Vec<Row>, place: &Place, law: &Law) {
    let Ok(Value::InlineTable(written)) = law.serialize(ValueSerializer::new()) else { return };
    let Some(parameters) = written.get(law.name()).and_then(Value::as_inline_table) else { return };
    for (name, value) in parameters {
        let Some(value) = value.as_float() else { continue };
        let key = format!("{}.{}.{name}", place.key, law.name());
        let most = matches!(name, "at" | "min").then_some(place.most);
        let row = number_row(place.group, &key, name, value, most);
        rows.push(Row { class: place.class("row part", "row"), ..row });
    }
}

/// Adds a row for each node of a polygon, and a button for another one.
fn add_nodes(rows: &mut Vec<Row>, place: &Place, polygon: &Polygon) {
    for (i, &(stretch, density)) in polygon.nodes.iter().enumerate() {
        let number = i + 1;
        let field = |name: &str, value, [x, y]: [String; 2]| {
            let to = format!("{{\"handle\":{i},\"stretch\":{x},\"density\":{y}}}");
            let change = template::law(&place.key, "move", &to);
            Item::number(String::new(), format!("{name} of node {number}"), rounded(value, DIGITS), change)
        };
        let remove = template::law(&place.key, "remove", &i.to_string());
        let items = vec![
            field("stretch", stretch, ["$x".to_owned(), json(density)]),
            field("density", density, [json(stretch), "$x".to_owned()]),
            Item::button("×", format!("remove node {number}"), remove),
        ];
        rows.push(place.row(&format!("node {i}"), place.class("row node part", "row node"), items));
    }
    let mut add = Item::button("Add node", String::new(), template::law(&place.key, "add", "null"));
    add.disabled = polygon.nodes.len() >= MOST;
    rows.push(place.row("add", place.only(), vec![add]));
}

/// A number in JSON.
fn json(value: f64) -> String {
    format!("{value:e}")
}

/// Adds the parts of a mixture: the weight and the distribution of each.
fn add_parts(rows: &mut Vec<Row>, place: &Place, parts: &[Component]) {
    for (i, part) in parts.iter().enumerate() {
        let key = format!("{}.mixture.{i}", place.key);
        let mut row = number_row(place.group, &format!("{key}.weight"), "weight", part.weight, Some(1.0));
        let change = template::law(&place.key, "weight", &format!("{{\"part\":{i},\"weight\":$x}}"));
        row.items.iter_mut().for_each(|item| item.change = change.clone());
        rows.push(Row { class: "row part first", ..row });
        let of = format!("part {} of {}", i + 1, place.of);
        let remove = template::law(&place.key, "remove_part", &i.to_string());
        let button = Item::button("Remove part", format!("remove {of}"), remove);
        let within = Place { key: format!("{key}.law"), of, part: true, ..place.clone() };
        add(rows, within.clone(), Some(&part.law));
        rows.push(within.row("remove", within.only(), vec![button]));
    }
    let split = Item::button("Add part", String::new(), template::law(&place.key, "split", "null"));
    rows.push(place.row("split", place.only(), vec![split]));
}
