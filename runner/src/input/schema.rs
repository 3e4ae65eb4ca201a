//! The JSON Schema of scenarios: that of their types, with the rules between tables.

use asperity::scenario::{Scenario, Task};
use serde_json::{Map, Value, json};

/// Identifies the schema; no address.
const ID: &str = concat!("urn:asperity:scenario:", env!("CARGO_PKG_VERSION"));

/// The JSON Schema of scenarios, with alternatives as their types have them, for programs that read it.
pub fn schema() -> Value {
    let mut schema = schemars::schema_for!(Scenario);
    schema.insert("$id".into(), ID.into());
    schema.insert("allOf".into(), combinations().into());
    without_null(schema.as_object_mut().expect("the schema of a table"));
    schema.to_value()
}

/// What the checks of the core refuse of tables and keys that are valid by themselves.
fn combinations() -> Vec<Value> {
    let timed = any(
        ["contacts.temperature", "contacts.ageing", "contacts.delay"].map(|rule| having(rule, json!({})))
    );
    let single = having("interface.contacts", json!({ "const": "one" }));
    let mass = key("interface.mass");
    let steady = any([
        // Only the first step may have a start; editors do not know the keyword for a first item.
        having("protocol", json!({ "contains": having("start", json!({ "const": "steady" })) })),
        having("pull.start", json!({ "const": "steady" })),
        having("drive.start", json!({ "const": "steady" })),
    ]);
    let mean_field = having("contacts.ageing.mean_field", json!({}));
    let quenched = having("ensemble.disorder", json!({ "const": "quenched" }));
    let edge = having("interface.loading", json!({ "const": "edge" }));
    let stability = having("velocity_curve.stability", json!({ "const": true }));
    vec![
        // Which tables belong to which task.
        never(
            "block",
            any(tasks_beside(["drive", "protocol", "velocity_curve", "stability"])
                .chain(["interface"])
                .map(key)),
        ),
        implies(all([key("block"), key("velocity_curve")]), stability.clone()),
        never("interface", any(tasks_beside(["drive", "protocol", "renormalisation"]).map(key))),
        implies(key("renormalisation"), key("interface")),
        implies(key("stability"), key("block")),
        implies(key("stability.simulations"), key("ensemble")),
        never("creep", key("ensemble")),
        refuses(having("contacts.free_friction.viscosity", json!({ "exclusiveMinimum": 0 })), key("creep")),
        refuses(
            all([key("contacts.stiffness_of_threshold"), not(key("interface"))]),
            any(["protocol", "protocol_file", "hold_curve", "creep"].map(key)),
        ),
        implies(key("drive.maps"), key("interface")),
        refuses(
            not(any(["pull", "protocol", "protocol_file", "velocity_curve", "hold_curve"].map(key))),
            key("compare"),
        ),
        refuses(any(["velocity_curve", "hold_curve"].map(key)), key("compare.position")),
        implies(key("compare.velocity"), key("velocity_curve")),
        implies(key("compare.hold"), key("hold_curve")),
        refuses(having("velocity_curve.temperatures", json!({ "minItems": 1 })), key("compare")),
        never("compare", key("interface")),
        never("compare.stiffness", any(["block", "pull", "velocity_curve", "hold_curve"].map(key))),
        implies(
            any(["compare.law", "compare.states"].map(key)),
            any(["compare.stiffness", "block"].map(key)),
        ),
        never("drive.force_to", any([key("block"), key("interface"), timed.clone()])),
        never("drive.turning_points", key("interface")),
        // Where contacts are time-dependent.
        implies(all([timed.clone(), key("pull")]), key("pull.velocity")),
        implies(all([timed.clone(), key("drive")]), key("drive.velocity")),
        implies(all([timed.clone(), key("spectrum")]), key("spectrum.velocity")),
        implies(
            all([timed.clone(), key("stability")]),
            having("stability.velocities", json!({ "minItems": 1 })),
        ),
        implies(
            all([timed.clone(), key("interface"), not(mass.clone()), not(single.clone())]),
            all([key("interface.viscosity"), having("interface.slip", json!({ "const": "overdamped" }))]),
        ),
        refuses(
            all([key("interface"), not(any([timed.clone(), mass.clone()]))]),
            any(["protocol", "protocol_file", "interface.slip_rates"].map(key)),
        ),
        // Cells with a mass move in time.
        implies(all([mass.clone(), key("drive")]), key("drive.velocity")),
        refuses(mass.clone(), any([key("interface.slip"), key("renormalisation")])),
        refuses(all([steady.clone(), timed.clone(), key("ensemble")]), any(["block", "interface"].map(key))),
        implies(having("velocity_curve.temperatures", json!({ "minItems": 1 })), key("contacts.temperature")),
        refuses(
            mean_field.clone(),
            any([
                key("ensemble"),
                key("contacts.temperature"),
                key("pull"),
                all([key("drive"), not(key("interface"))]),
                key("creep"),
                key("stability"),
                having("velocity_curve.stability", json!({ "const": true })),
            ]),
        ),
        refuses(
            all([mean_field.clone(), any(["protocol", "protocol_file", "hold_curve", "interface"].map(key))]),
            any(["contacts.stiffness_per_threshold", "contacts.areas"].map(key)),
        ),
        // Where steps of the normal load are not followed.
        refuses(
            any([key("block"), key("interface"), mean_field]),
            having(
                "protocol",
                json!({ "contains": having("relative_normal_load", not(json!({ "const": 1 }))) }),
            ),
        ),
        // Contacts that do not break by their own thresholds have no state where the velocity varies.
        refuses(
            having("contacts.temperature.hazard", json!({ "const": "additive" })),
            any([
                key("contacts.ageing"),
                any(["block", "interface", "drive", "protocol", "protocol_file"].map(key)),
                any(["hold_curve", "creep", "stability", "renormalisation"].map(key)),
                having("pull.start", json!({ "const": "steady" })),
                stability.clone(),
            ]),
        ),
        // Contacts that are coupled one by one, and cells of many.
        refuses(all([single.clone(), key("renormalisation")]), timed.clone()),
        implies(key("interface.main_shocks"), single.clone()),
        refuses(
            single,
            any([
                key("contacts.delay"),
                key("contacts.ageing.smoluchowski"),
                key("contacts.ageing.mean_field"),
                key("interface.slip_rates"),
                key("interface.slip"),
                key("interface.viscosity"),
                key("interface.mass"),
                key("interface.disorder"),
                key("interface.areas"),
                key("interface.coupling.half_space"),
                key("ensemble.size"),
                key("contacts.stiffness_per_threshold"),
                key("contacts.stiffness_of_threshold"),
                key("contacts.background_force"),
                key("contacts.background_coefficient"),
                edge.clone(),
            ]),
        ),
        refuses(
            edge,
            any(["contacts.background_force", "contacts.background_coefficient", "renormalisation"].map(key)),
        ),
        refuses(key("interface.areas"), key("interface.coupling.half_space")),
        refuses(
            key("interface.disorder.std"),
            any(["interface.disorder.file", "interface.disorder.scale"].map(key)),
        ),
        refuses(key("interface.disorder.file"), key("interface.disorder.scale")),
        implies(
            all([
                key("renormalisation"),
                key("interface"),
                not(having("interface.contacts", json!({ "const": "one" }))),
            ]),
            all([key("interface.disorder.std"), not(key("ensemble"))]),
        ),
        implies(
            all([
                key("ensemble"),
                key("interface"),
                not(having("interface.contacts", json!({ "const": "one" }))),
            ]),
            all([
                key("ensemble.size"),
                any([mass.clone(), having("interface.slip", json!({ "const": "overdamped" }))]),
            ]),
        ),
        implies(
            all([
                key("interface.coupling.neighbours"),
                not(having("interface.contacts", json!({ "const": "one" }))),
            ]),
            having("interface.coupling.neighbours.stiffness", json!({ "exclusiveMinimum": 0 })),
        ),
        implies(
            having("interface.edges", json!({ "const": "periodic" })),
            having("interface.cells", json!({ "items": { "minimum": 3 } })),
        ),
        implies(
            all([
                having("interface.edges", json!({ "const": "periodic" })),
                having("interface.contacts", json!({ "const": "one" })),
            ]),
            having("interface.connection", json!({ "exclusiveMinimum": 0 })),
        ),
        implies(
            all([key("renormalisation"), key("initial")]),
            having("initial.point.at", json!({ "const": 0 })),
        ),
        // Starts and noise.
        implies(
            key("protocol"),
            having(
                "protocol",
                json!({ "items": implies(
                    having("start", json!({ "const": "steady" })),
                    having("velocity", json!({ "exclusiveMinimum": 0 })),
                ) }),
            ),
        ),
        refuses(having("pull.start", json!({ "const": "steady" })), timed.clone()),
        without(&key("contacts.ageing.smoluchowski.mature.point")),
        refuses(steady, any([key("initial"), quenched.clone()])),
        refuses(key("spectrum"), quenched),
        refuses(
            key("compare.file"),
            any(["compare.position", "compare.velocity", "compare.hold", "compare.force"].map(key)),
        ),
        implies(key("sweep"), any(["sweep.over", "sweep.repeat"].map(key))),
        // What a fit is given.
        refuses(
            key("fit.steady"),
            any([
                "fit.file",
                "fit.position",
                "fit.drive",
                "fit.curve",
                "fit.range",
                "contacts.background_force",
                "contacts.background_coefficient",
            ]
            .map(key)),
        ),
        refuses(
            key("fit.velocity_curve"),
            any([
                "fit.file",
                "fit.position",
                "fit.drive",
                "fit.curve",
                "fit.steady",
                "fit.range",
                "fit.velocity",
            ]
            .map(key)),
        ),
        implies(
            all([key("fit.velocity_curve"), key("initial")]),
            having("initial.point.at", json!({ "const": 0 })),
        ),
        refuses(key("fit.curve"), any(["fit.file", "fit.position", "fit.drive"].map(key))),
        implies(key("fit.drive"), key("fit.compliance")),
        implies(
            all([any(["fit.position", "fit.drive"].map(key)), not(key("fit.force"))]),
            key("fit.reading"),
        ),
        refuses(
            having("fit.noise", json!({ "const": "white" })),
            having(
                "fit.free",
                all([
                    json!({ "contains": { "const": "contacts.count" } }),
                    json!({ "contains": { "const": "contacts.stiffness" } }),
                ]),
            ),
        ),
    ]
}

/// A schema of what has the key, such as `interface.viscosity`.
fn key(key: &str) -> Value {
    having(key, json!({}))
}

/// A schema of what has the key, with a value of the given schema.
fn having(key: &str, value: Value) -> Value {
    let (first, value) = match key.split_once('.') {
        None => (key, value),
        Some((table, rest)) => (table, having(rest, value)),
    };
    json!({ "required": [first], "properties": { first: value } })
}

/// The tables that are tasks, without these.
fn tasks_beside<const N: usize>(these: [&str; N]) -> impl Iterator<Item = &'static str> {
    Task::NAMES.iter().copied().filter(move |name| !these.contains(name))
}

fn any(schemas: impl IntoIterator<Item = Value>) -> Value {
    json!({ "anyOf": schemas.into_iter().collect::<Vec<_>>() })
}

fn all<const N: usize>(schemas: [Value; N]) -> Value {
    json!({ "allOf": Vec::from(schemas) })
}

fn not(schema: Value) -> Value {
    json!({ "not": schema })
}

fn implies(condition: Value, then: Value) -> Value {
    json!({ "if": condition, "then": then })
}

fn refuses(condition: Value, other: Value) -> Value {
    implies(condition, without(&other))
}

/// A schema of what a schema does not describe. It is wrong at the key that is there, where this is one or one of several.
fn without(schema: &Value) -> Value {
    if let Some(several) = schema["anyOf"].as_array() {
        return json!({ "allOf": several.iter().map(without).collect::<Vec<_>>() });
    }
    let having = schema["required"].as_array().zip(schema["properties"].as_object());
    match having.and_then(|(_, properties)| properties.iter().next()) {
        Some((first, value)) if value == &json!({}) => json!({ "properties": { first: false } }),
        Some((first, value)) => json!({ "properties": { first: without(value) } }),
        None => not(schema.clone()),
    }
}

fn never(table: &str, other: Value) -> Value {
    refuses(key(table), other)
}

/// Leaves out the alternatives `null`, which TOML does not have: an editor would report both where the other is wrong.
fn without_null(schema: &mut Map<String, Value>) {
    if let Some(kinds) = schema.get_mut("type").and_then(Value::as_array_mut) {
        kinds.retain(|kind| kind != "null");
        if let [only] = kinds.as_slice() {
            let only = only.clone();
            schema.insert("type".into(), only);
        }
    }
    if let Some(choices) = schema.get_mut("anyOf").and_then(Value::as_array_mut) {
        let before = choices.len();
        choices.retain(|choice| choice.get("type") != Some(&"null".into()));
        if let (true, [Value::Object(only)]) = (choices.len() < before, choices.as_slice()) {
            let only = only.clone();
            schema.remove("anyOf");
            schema.extend(only);
        }
    }
    for value in schema.values_mut() {
        match value {
            Value::Object(inner) => without_null(inner),
            Value::Array(items) => items.iter_mut().filter_map(Value::as_object_mut).for_each(without_null),
            _ => {}
        }
    }
}
