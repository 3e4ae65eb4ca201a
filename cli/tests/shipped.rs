//! What comes with asperity: scenarios, the schema, completions. `make results` runs the scenarios.

mod support;

use serde_json::Value;
use support::{Folder, scenarios, tomls};

#[test]
fn every_shipped_scenario_makes_sense() {
    let shipped = tomls(&scenarios());
    assert!(shipped.len() >= 10, "only {}", shipped.len());
    for path in shipped {
        Folder::new().succeed(&["check", path.to_str().unwrap()]);
    }
}

#[test]
fn an_example_can_be_printed_and_run_elsewhere() {
    let folder = Folder::new();
    assert!(folder.succeed(&["example"]).contains("compared"));
    folder.write("mine.toml", &folder.succeed(&["example", "compared"]));
    folder.write("first_loading.csv", &folder.succeed(&["example", "first_loading.csv"]));
    assert!(folder.succeed(&["check", "mine.toml"]).contains("mine.toml"));
}

/// The object that describes `schema`, references followed.
fn resolved<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    match schema["$ref"].as_str() {
        Some(path) => root.pointer(path.strip_prefix('#').unwrap()).unwrap(),
        None => schema,
    }
}

/// Checks that the schema knows every key of `value`.
fn knows(root: &Value, schema: &Value, value: &toml::Value, path: &str) {
    let schema = resolved(root, schema);
    let choices =
        schema["anyOf"].as_array().or(schema["oneOf"].as_array().filter(|_| schema["type"].is_null()));
    if let Some(choices) = choices {
        let fits = |choice: &&Value| match value {
            toml::Value::Table(table) => {
                let choice = resolved(root, choice);
                let properties = &choice["properties"];
                choice["oneOf"].is_array() || table.keys().all(|key| !properties[key].is_null())
            }
            _ => true,
        };
        let choice = choices.iter().find(fits).unwrap_or_else(|| panic!("{path}: not in the schema"));
        return knows(root, choice, value, path);
    }
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                let further = &schema["additionalProperties"];
                let own = &schema["properties"][key];
                let property = if own.is_null() && further.is_object() { further } else { own };
                assert!(!property.is_null(), "{path}.{key}: not in the schema");
                knows(root, property, value, &format!("{path}.{key}"));
            }
        }
        toml::Value::Array(items) => {
            items.iter().for_each(|item| knows(root, &schema["items"], item, &format!("{path}[]")));
        }
        _ => {}
    }
}

#[test]
fn the_schema_knows_every_key_of_every_shipped_scenario() {
    let schema = asperity_runner::input::schema();
    for path in tomls(&scenarios()) {
        let text = std::fs::read_to_string(&path).unwrap();
        knows(&schema, &schema, &toml::from_str(&text).unwrap(), path.file_name().unwrap().to_str().unwrap());
    }
}

#[test]
fn the_schema_states_the_defaults() {
    let schema = asperity_runner::input::schema();
    let default = |table: &str, key: &str| schema["$defs"][table]["properties"][key]["default"].clone();
    assert_eq!(default("Contacts", "count"), 1.0);
    assert_eq!(default("Contacts", "stiffness"), 1.0);
    assert_eq!(default("Pull", "points"), 2001);
    assert_eq!(default("Pull", "start"), "conditional");
    assert_eq!(default("MasterEquation", "tolerance"), 1e-10);
    assert_eq!(default("Ensemble", "size"), 100_000);
    assert_eq!(schema["additionalProperties"], false);
}

#[test]
fn completions_know_the_commands() {
    for shell in ["bash", "zsh", "fish"] {
        assert!(Folder::new().succeed(&["completions", shell]).contains("example"), "{shell}");
    }
}

#[test]
fn the_version_is_reported() {
    assert_eq!(Folder::new().succeed(&["--version"]), concat!("asperity ", env!("CARGO_PKG_VERSION"), "\n"));
}
