//! The tables of keys on the page of scenarios, from the JSON Schema of scenarios.

use std::collections::BTreeMap;

use asperity::scenario::Task;
use serde_json::Value;

/// A key of a scenario.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key {
    /// What stands in the column of defaults: one in TOML, `required`, or a dash.
    pub default: String,
    /// What it means, one sentence or several.
    pub meaning: String,
}

/// The line above the rows of a table of keys.
const HEAD: &str = "| key | default | meaning |";

/// The line above the list of tasks.
const TASKS: &str = "A file must contain `contacts` and exactly one task:";

/// Where the page explains a key further.
const LINKS: [(&str, &str); 7] = [
    ("contacts.background_force", "[theory](theory.md#background-force)"),
    ("contacts.temperature.barrier", "[theory](theory.md#time)"),
    ("contacts.temperature.hazard", "[theory](theory.md#temperature)"),
    ("pull.start", "[theory](theory.md#conventions)"),
    ("block.slip", "[theory](theory.md#a-block-of-finite-stiffness)"),
    ("interface.contacts", "[theory](theory.md#contacts-coupled-one-by-one)"),
    ("master_equation.tolerance", "[error budget](theory.md#error-budget)"),
];

/// The keys of scenarios, `pull.distance`, and the parameters of distributions, `gaussian.mean`.
pub fn keys(schema: &Value) -> [BTreeMap<String, Key>; 2] {
    let (mut keys, mut parameters) = (BTreeMap::new(), BTreeMap::new());
    add_keys(schema, schema, "", &mut keys);
    add_parameters(schema, &mut parameters);
    [keys, parameters]
}

/// The page with its list of tasks, and with all rows of its tables of keys as the schema has them: in their order, and those that
/// lack at the end.
pub fn page(page: &str, schema: &Value) -> String {
    let mut tables = keys(schema).into_iter();
    let mut lines = page.lines().peekable();
    let mut text = String::new();
    while let Some(line) = lines.next() {
        text += &format!("{line}\n");
        if line == TASKS {
            text += &format!("{}\n{}", lines.next().unwrap_or_default(), tasks());
            while lines.next_if(|item| item.starts_with("- `[")).is_some() {}
        }
        if line != HEAD {
            continue;
        }
        text += &format!("{}\n", lines.next().expect("the rule below the head"));
        let mut keys = tables.next().expect("two tables of keys");
        while let Some(row) = lines.next_if(|row| row.starts_with("| `")) {
            let name = row.split('`').nth(1).unwrap_or_default();
            text += &keys.remove(name).map(|key| shown(name, &key)).unwrap_or_default();
        }
        text.extend(keys.iter().map(|(name, key)| shown(name, key)));
    }
    text
}

/// What tasks do, as a list that is a sentence.
fn tasks() -> String {
    let sentences = Task::MEANINGS.iter().map(|meaning| meaning.trim().trim_end_matches('.'));
    let items: Vec<String> = sentences.map(|sentence| format!("- {sentence}")).collect();
    format!("{}.\n", items.join(";\n"))
}

fn shown(name: &str, Key { default, meaning }: &Key) -> String {
    let link =
        LINKS.iter().find(|(key, _)| *key == name).map_or(String::new(), |(_, link)| format!(" ({link})"));
    format!("| `{name}` | {default} | {}{link} |\n", meaning.trim_end_matches('.'))
}

/// The schema of what `schema` refers to, be it optional.
fn resolved<'a>(root: &'a Value, schema: &'a Value) -> (&'a Value, &'a str) {
    let schema = schema["anyOf"].as_array().map_or(schema, |choices| &choices[0]);
    let path = schema["$ref"].as_str().unwrap_or("#");
    let name = path.rsplit('/').next().unwrap_or_default();
    if path == "#" { (schema, "") } else { (root.pointer(&path[1..]).expect("a definition"), name) }
}

/// Every key below `schema`.
fn add_keys(root: &Value, schema: &Value, path: &str, found: &mut BTreeMap<String, Key>) {
    for (name, property) in schema["properties"].as_object().expect("properties of a table") {
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        let meaning = property["description"].as_str().unwrap_or_default().replace('\n', " ");
        let (inner, definition) = resolved(root, property);
        let (item, of) = resolved(root, &inner["items"]);
        if item["properties"].is_object() && of != "Law" {
            found.insert(path.clone(), Key { default: "–".to_owned(), meaning });
            add_keys(root, item, &format!("{path}[]"), found);
            continue;
        }
        if inner["properties"].is_object() && definition != "Law" {
            add_keys(root, inner, &path, found);
            continue;
        }
        let required = schema["required"].as_array().is_some_and(|all| all.contains(&name.as_str().into()));
        let default = match &property["default"] {
            Value::Null if required => "required".to_owned(),
            Value::Null => "–".to_owned(),
            value => format!("`{}`", as_toml(value)),
        };
        found.insert(path, Key { default, meaning });
    }
}

/// A default as it would be written in a scenario.
fn as_toml(value: &Value) -> String {
    match value {
        Value::Object(law) => {
            let (name, parameters) = law.iter().next().expect("one distribution");
            let inside = parameters.as_object().expect("its parameters").iter();
            let inside: Vec<_> = inside.map(|(key, value)| format!("{key} = {value}")).collect();
            format!("{name} = {{ {} }}", inside.join(", "))
        }
        other => other.to_string(),
    }
}

/// The parameters of every distribution, `gaussian.mean` or `mixture[].weight`.
fn add_parameters(root: &Value, found: &mut BTreeMap<String, Key>) {
    for law in root["$defs"]["Law"]["oneOf"].as_array().expect("distributions") {
        let (name, schema) =
            law["properties"].as_object().and_then(|one| one.iter().next()).expect("its name");
        let list = schema["type"] == "array";
        let (inner, _) = resolved(root, if list { &schema["items"] } else { schema });
        add_keys(root, inner, &format!("{name}{}", if list { "[]" } else { "" }), found);
    }
}
