//! Scenarios in other units: every number is multiplied by the unit of the dimension that the schema declares for it.

use asperity::scenario::Scenario;
use asperity_runner::input;
use serde_json::Value;

use super::Scale;

/// Parameters of distributions that are no lengths.
const NO_LENGTHS: [&str; 2] = ["shape", "weight"];

impl Scale {
    /// The unit of a dimension such as `force*time^2/length`.
    fn unit(self, dimension: &str) -> f64 {
        let (above, below) = dimension.split_once('/').unwrap_or((dimension, "1"));
        self.product(above) / self.product(below)
    }

    fn product(self, factors: &str) -> f64 {
        let Self { length, force, time } = self;
        let unit = |name: &str| match name {
            "1" => 1.0,
            "length" => length,
            "force" => force,
            "time" => time,
            other => panic!("{other} is neither length, force nor time"),
        };
        let power = |factor: &str| {
            let (name, power) = factor.split_once('^').unwrap_or((factor, "1"));
            unit(name).powi(power.parse().expect("a whole power"))
        };
        factors.split('*').map(power).product()
    }

    /// The same scenario in other units, of contacts whose stiffness is given, or 1.
    pub fn of_scenario(self, scenario: &Scenario) -> Scenario {
        let schema = input::schema();
        let mut scenario = scenario.clone();
        scenario.contacts.stiffness.get_or_insert(1.0);
        let mut value = serde_json::to_value(scenario).expect("a scenario is JSON");
        self.convert(&schema, &schema, "", &mut value);
        serde_json::from_value(value).expect("numbers remain numbers")
    }

    /// Converts what a `schema` describes, which is at `path`.
    fn convert(self, root: &Value, schema: &Value, path: &str, value: &mut Value) {
        let schema = resolved(root, schema);
        match value {
            Value::Number(number) if number.is_f64() => {
                let dimension = schema["x-dimension"].as_str();
                let dimension = dimension.unwrap_or_else(|| panic!("{path}: x-dimension is not declared"));
                *value = (self.unit(dimension) * value.as_f64().expect("a float")).into();
            }
            Value::Array(items) => {
                let mut each = resolved(root, &schema["items"]).clone();
                if each["x-dimension"].is_null() {
                    each["x-dimension"] = schema["x-dimension"].clone();
                }
                items.iter_mut().for_each(|item| self.convert(root, &each, path, item));
            }
            Value::Object(keys) => {
                for (key, value) in keys {
                    let here = format!("{path}.{key}");
                    let inner =
                        property(root, schema, key).unwrap_or_else(|| panic!("{here} is in no schema"));
                    if inner["$ref"].as_str().is_some_and(|name| name.ends_with("/Law")) {
                        self.lengths(key, value);
                    } else {
                        self.convert(root, inner, &here, value);
                    }
                }
            }
            _ => {}
        }
    }

    /// Converts the parameters of a distribution of lengths.
    fn lengths(self, key: &str, value: &mut Value) {
        match value {
            Value::Number(_) if NO_LENGTHS.contains(&key) => {}
            Value::Number(number) => *value = (self.length * number.as_f64().expect("a number")).into(),
            Value::Array(items) => items.iter_mut().for_each(|item| self.lengths(key, item)),
            Value::Object(keys) => keys.iter_mut().for_each(|(key, value)| self.lengths(key, value)),
            _ => {}
        }
    }
}

/// The schema that a reference leads to.
fn resolved<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    let path = schema["$ref"].as_str().and_then(|path| path.strip_prefix('#'));
    path.map_or(schema, |path| root.pointer(path).expect("what is referred to"))
}

/// The schema of a key, also of one that is the name of an alternative.
fn property<'a>(root: &'a Value, schema: &'a Value, key: &str) -> Option<&'a Value> {
    let schema = resolved(root, schema);
    let of_alternatives = || {
        let alternatives =
            ["oneOf", "anyOf"].into_iter().filter_map(|name| schema[name].as_array()).flatten();
        alternatives.into_iter().find_map(|alternative| property(root, alternative, key))
    };
    schema["properties"].get(key).or_else(of_alternatives)
}
