//! The JSON Schema of scenarios in the form that editors expect: a mistake has one message, at the key that is wrong.
//!
//! Validators report what does not match one of several alternatives where these begin, as a whole, and editors underline all
//! of it. Alternatives are therefore written as tables with exactly one key, as lists of words, and as keys that exclude
//! others.

use serde_json::{Map, Value, json};

use super::schema::schema;

/// The schema that `asperity schema` prints.
pub fn editor_schema() -> String {
    let types = schema();
    let mut schema = types.clone();
    rewrite(&mut schema, &types);
    serde_json::to_string_pretty(&schema).expect("a schema is JSON")
}

/// Writes a schema and all that is in it anew; references are to `types`.
fn rewrite(schema: &mut Value, types: &Value) {
    match schema {
        Value::Object(table) => {
            for (key, written) in [
                ("oneOf", table.get("oneOf").and_then(|all| alternatives(all.as_array()?))),
                ("anyOf", table.get("anyOf").and_then(|all| variants(&flat(all.as_array()?, types)?))),
                ("not", table.get("not").and_then(excluded_pairs)),
            ] {
                if let Some(written) = written {
                    table.remove(key);
                    add(table, written);
                }
            }
            after_names(table);
            table.values_mut().for_each(|inner| rewrite(inner, types));
        }
        Value::Array(items) => items.iter_mut().for_each(|item| rewrite(item, types)),
        _ => {}
    }
}

/// A table with unknown keys gets a message about these alone: one of them may be a required key with another name. What a key excludes
/// or needs is written as conditions, as Taplo does not know `dependentSchemas` and `dependentRequired`, and within `then`, as it
/// does not explain a table that has `allOf`.
fn after_names(table: &mut Map<String, Value>) {
    let Some(known) = table.get("properties").and_then(Value::as_object) else { return };
    if table.get("additionalProperties") != Some(&false.into()) || table.contains_key("if") {
        return;
    }
    let names = json!({ "propertyNames": { "enum": known.keys().collect::<Vec<_>>() } });
    let mut rules = Map::new();
    for key in ["required", "anyOf"] {
        if table.get(key).is_some_and(|rule| key == "required" || is_of_required_keys(rule)) {
            rules.extend(table.remove_entry(key));
        }
    }
    // Where a required key is missing, another one that is needed would be a second message.
    if let (Some(required), Some(any)) = (rules.get("required").cloned(), rules.get("anyOf").cloned()) {
        rules.remove("anyOf");
        rules.insert("if".into(), json!({ "required": required }));
        rules.insert("then".into(), json!({ "anyOf": any }));
    }
    let conditions = conditions(table);
    if !conditions.is_empty() {
        rules.insert("allOf".into(), conditions.into());
    }
    if !rules.is_empty() {
        table.insert("if".into(), names);
        table.insert("then".into(), rules.into());
    }
}

/// What single keys exclude or need, taken out of a table.
fn conditions(table: &mut Map<String, Value>) -> Vec<Value> {
    let mut taken = |keyword: &str| match table.remove(keyword) {
        Some(Value::Object(rules)) => rules,
        _ => Map::new(),
    };
    let (schemas, needs) = (taken("dependentSchemas"), taken("dependentRequired"));
    let needs = needs.into_iter().map(|(key, needed)| (key, json!({ "required": needed })));
    schemas
        .into_iter()
        .chain(needs)
        .map(|(key, rule)| json!({ "if": { "required": [key] }, "then": rule }))
        .collect()
}

fn is_of_required_keys(rule: &Value) -> bool {
    let only = |choice: &Value| choice.as_object().is_some_and(|all| all.keys().eq(["required"]));
    rule.as_array().is_some_and(|choices| choices.iter().all(only))
}

/// Adds what a schema says of its own; dependencies are added to those that are there.
fn add(table: &mut Map<String, Value>, written: Map<String, Value>) {
    for (key, value) in written {
        match (key.as_str(), table.get_mut(&key), value) {
            ("dependentSchemas", Some(Value::Object(there)), Value::Object(more)) => merge(there, more),
            (_, _, value) => _ = table.insert(key, value),
        }
    }
}

/// Dependencies of two kinds; those of one key are schemas of `properties`, whose keys are joined.
fn merge(there: &mut Map<String, Value>, more: Map<String, Value>) {
    for (key, value) in more {
        let Some(known) = there.get_mut(&key) else {
            there.insert(key, value);
            continue;
        };
        let (Some(known), Value::Object(value)) = (known["properties"].as_object_mut(), &value["properties"])
        else {
            continue;
        };
        known.extend(value.clone());
    }
}

/// Alternatives without `oneOf`, if they are of a known kind.
fn alternatives(choices: &[Value]) -> Option<Map<String, Value>> {
    variants(choices).or_else(|| keys(choices))
}

/// Choices of which some refer to types that are choices themselves; `None` if there are none of these.
fn flat(choices: &[Value], types: &Value) -> Option<Vec<Value>> {
    let target =
        |choice: &Value| types.pointer(choice["$ref"].as_str()?.strip_prefix('#')?)?["oneOf"].as_array();
    choices.iter().find_map(target)?;
    let inner = |choice: &Value| target(choice).cloned().unwrap_or_else(|| vec![choice.clone()]);
    Some(choices.iter().flat_map(inner).collect())
}

/// Words and tables with one key, of which there is exactly one.
fn variants(choices: &[Value]) -> Option<Map<String, Value>> {
    let (mut words, mut meanings, mut tables) = (Vec::new(), Vec::new(), Map::new());
    for choice in choices {
        if let Some(word) = choice.get("const") {
            words.push(word.clone());
            meanings.push(choice.get("description").cloned().unwrap_or_default());
            continue;
        }
        let (name, content) = choice["properties"].as_object().filter(|one| one.len() == 1)?.iter().next()?;
        if choice["required"] != json!([name]) {
            return None;
        }
        let mut content = content.clone();
        if let (Some(said), None) = (choice.get("description"), content.get("description")) {
            content["description"] = said.clone();
        }
        tables.insert(name.clone(), content);
    }
    let word = json!({ "enum": words, "x-taplo": { "docs": { "enumValues": meanings } } });
    let table = json!({
        "type": "object",
        "properties": tables,
        "additionalProperties": false,
        "minProperties": 1,
        "maxProperties": 1,
    });
    let (Value::Object(word), Value::Object(mut table)) = (word, table) else { return None };
    if tables_are_missing(&table) {
        return Some(word);
    }
    if words.is_empty() {
        return Some(table);
    }
    table.remove("type");
    table.insert("anyOf".into(), json!([word, { "type": "object" }]));
    Some(table)
}

fn tables_are_missing(table: &Map<String, Value>) -> bool {
    table["properties"].as_object().is_some_and(Map::is_empty)
}

/// Keys of which one alternative is required: one must be there, and each excludes those of later ones and what it says.
fn keys(choices: &[Value]) -> Option<Map<String, Value>> {
    let needed: Vec<Vec<&str>> = choices.iter().map(required).collect();
    let known = |choice: &Value| {
        choice.as_object().is_some_and(|all| {
            all.keys().all(|key| ["required", "not", "properties"].contains(&key.as_str()))
        })
    };
    if !choices.iter().all(known) {
        return None;
    }
    let mut dependent = Map::new();
    for (i, choice) in choices.iter().enumerate() {
        let Some(last) = needed[i].last() else { continue };
        let later = needed[i + 1..].iter().flatten().copied();
        let earlier: Vec<&str> = needed[..i].iter().flatten().copied().collect();
        let own = excluded(&choice["not"]).into_iter().filter(|key| !earlier.contains(key));
        let mut properties = choice["properties"].as_object().cloned().unwrap_or_default();
        for key in later.chain(own).filter(|key| !needed[i].contains(key)) {
            properties.insert(key.to_owned(), false.into());
        }
        if !properties.is_empty() {
            dependent.insert((*last).to_owned(), json!({ "properties": properties }));
        }
    }
    let mut written = Map::from_iter([("dependentSchemas".to_owned(), dependent.into())]);
    if needed.iter().all(|keys| !keys.is_empty()) {
        let any: Vec<Value> = needed.iter().map(|keys| json!({ "required": keys })).collect();
        written.insert("anyOf".into(), any.into());
    }
    Some(written)
}

fn required(schema: &Value) -> Vec<&str> {
    schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect()
}

/// The keys that must not be there, of `required` or `anyOf` of several of these.
fn excluded(not: &Value) -> Vec<&str> {
    let several = not["anyOf"].as_array().into_iter().flatten().flat_map(required);
    required(not).into_iter().chain(several).collect()
}

/// `not` with pairs of keys that exclude each other: the first excludes the second.
fn excluded_pairs(not: &Value) -> Option<Map<String, Value>> {
    let mut dependent = Map::new();
    for pair in not["anyOf"].as_array()? {
        let [first, second] = required(pair)[..] else { return None };
        dependent.entry(first).or_insert_with(|| json!({ "properties": {} }))["properties"][second] =
            false.into();
    }
    Some(Map::from_iter([("dependentSchemas".to_owned(), dependent.into())]))
}
