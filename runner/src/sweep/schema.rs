//! What schemas say of a dotted path: whether there is such an entry, its meaning and its dimension.

use asperity::record::Quantity;
use serde_json::{Map, Value};

/// An entry of a schema.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Entry {
    /// Its meaning, the first sentence of its documentation; empty if it has none.
    pub meaning: String,
    /// What it measures, if that is declared.
    pub quantity: Option<Quantity>,
}

/// The entry at a path: names of keys, and indices of items.
pub fn find(root: &Value, path: &str) -> Option<Entry> {
    let names: Vec<&str> = path.split('.').collect();
    along(root, root, &names)
}

/// The names under the entry at a path, for hints.
pub fn names(root: &Value, schema: &Value) -> Vec<String> {
    let mut found = Vec::new();
    collect(root, schema, &mut found);
    found
}

fn collect(root: &Value, schema: &Value, found: &mut Vec<String>) {
    let schema = resolved(root, schema);
    let keys = schema["properties"].as_object().into_iter().flat_map(Map::keys);
    found.extend(keys.cloned());
    alternatives(schema).for_each(|choice| collect(root, choice, found));
}

fn along(root: &Value, schema: &Value, names: &[&str]) -> Option<Entry> {
    let target = resolved(root, schema);
    let Some((first, rest)) = names.split_first() else {
        return Some(entry(target, schema));
    };
    let item = first.parse::<usize>().ok().and_then(|_| target.get("items"));
    let own = target["properties"].get(*first).or(item).and_then(|inner| along(root, inner, rest));
    own.or_else(|| alternatives(target).find_map(|choice| along(root, choice, names)))
}

/// The documentation beside a reference says more than that of its target.
fn entry(target: &Value, schema: &Value) -> Entry {
    let said = |key: &str| schema[key].as_str().or(target[key].as_str());
    let meaning = said("description").unwrap_or_default().replace('\n', " ");
    let end = [". ", "; "].into_iter().filter_map(|stop| meaning.find(stop)).min().unwrap_or(meaning.len());
    let meaning = meaning[..end].trim_end_matches('.').to_owned();
    Entry { meaning, quantity: said("x-dimension").and_then(quantity) }
}

fn alternatives(schema: &Value) -> impl Iterator<Item = &Value> {
    ["anyOf", "oneOf", "allOf"].into_iter().filter_map(|key| schema[key].as_array()).flatten()
}

fn resolved<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    let target = schema["$ref"].as_str().and_then(|path| root.pointer(path.strip_prefix('#')?));
    target.unwrap_or(schema)
}

/// The quantity of a declared dimension, if units have a label for it.
fn quantity(dimension: &str) -> Option<Quantity> {
    Some(match dimension {
        "1" => Quantity::Number,
        "length" => Quantity::Length,
        "force" => Quantity::Force,
        "1/length" => Quantity::PerLength,
        "force/length" => Quantity::Stiffness,
        "force*length" => Quantity::Energy,
        "time" => Quantity::Time,
        "length/time" => Quantity::Velocity,
        "1/time" => Quantity::PerTime,
        _ => return None,
    })
}
