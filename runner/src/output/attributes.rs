//! What describes a result as a whole in `result.nc` and in xarray: its title, version and seed, and every number of its
//! summary, by the rules of CF (climate and forecast metadata).

use asperity::task::summary::Summary;
use serde_json::Value;

/// The metadata conventions of `result.nc`.
const CONVENTIONS: &str = "CF-1.11";
/// The form of `result.nc` and `sweep.nc`. It rises when a reader of the last form could not read the new one; new variables and
/// attributes do not raise it.
pub const FORMAT: i64 = 1;
/// The attribute that states it.
pub(super) const FORMAT_ATTRIBUTE: &str = "format_version";
/// Entries of the summary that are attributes under their own rules, or of the variables.
const APART: [&str; 4] = ["title", "version", "seed", "units"];
/// What a summary has in the place of an infinite number.
const INFINITE: &str = "infinite";

/// The value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub enum Attribute {
    /// A text.
    Text(String),
    /// A whole number.
    Whole(i64),
    /// A seed.
    Seed(u64),
    /// A number.
    Number(f64),
}

/// The attributes of every result, also of one without a summary.
pub fn common() -> Vec<(String, Attribute)> {
    let text = |text: &str| Attribute::Text(text.to_owned());
    vec![
        ("Conventions".to_owned(), text(CONVENTIONS)),
        ("source".to_owned(), text("asperity")),
        (FORMAT_ATTRIBUTE.to_owned(), Attribute::Whole(FORMAT)),
    ]
}

/// The attributes of a result: title, version, seed, and the entries of its summary. Entries of tables and lists are named by
/// their place, joined by `_`: `static_friction_force`, `steps_0_duration`. What is infinite in the summary is an infinite
/// number, what is null is NaN; true is 1, false is 0.
///
/// # Panics
/// Never: a summary is plain data.
pub fn attributes(summary: &Summary) -> Vec<(String, Attribute)> {
    let mut found = common();
    found.push(("title".to_owned(), Attribute::Text(summary.title.clone())));
    found.push(("version".to_owned(), Attribute::Text(summary.version.clone())));
    found.extend(summary.seed.map(|seed| ("seed".to_owned(), Attribute::Seed(seed))));
    let Value::Object(mut entries) = serde_json::to_value(summary).expect("a summary is plain data") else {
        unreachable!("a summary is a table")
    };
    for name in APART {
        entries.remove(name);
    }
    entries.into_iter().for_each(|(name, value)| flatten(name, value, &mut found));
    found
}

fn flatten(name: String, value: Value, into: &mut Vec<(String, Attribute)>) {
    let attribute = match value {
        Value::Null => Attribute::Number(f64::NAN),
        Value::Bool(holds) => Attribute::Whole(holds.into()),
        Value::Number(number) => match (number.as_i64(), number.as_f64()) {
            (Some(whole), _) => Attribute::Whole(whole),
            (None, value) => Attribute::Number(value.unwrap_or(f64::NAN)),
        },
        Value::String(text) if text == INFINITE => Attribute::Number(f64::INFINITY),
        Value::String(text) => Attribute::Text(text),
        Value::Array(items) => {
            let each = |(place, item)| flatten(format!("{name}_{place}"), item, into);
            return items.into_iter().enumerate().for_each(each);
        }
        Value::Object(entries) => {
            let each = |(key, entry)| flatten(format!("{name}_{key}"), entry, into);
            return entries.into_iter().for_each(each);
        }
    };
    into.push((name, attribute));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_named_by_their_place() {
        let text = r#"{"a": {"b": 1, "c": [0.5, "infinite", null]}, "d": true, "e": "smooth"}"#;
        let mut found = Vec::new();
        let Value::Object(entries) = serde_json::from_str(text).unwrap() else { unreachable!() };
        entries.into_iter().for_each(|(name, value)| flatten(name, value, &mut found));
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["a_b", "a_c_0", "a_c_1", "a_c_2", "d", "e"]);
        assert_eq!(found[0].1, Attribute::Whole(1));
        assert_eq!(found[1].1, Attribute::Number(0.5));
        assert_eq!(found[2].1, Attribute::Number(f64::INFINITY));
        assert!(matches!(found[3].1, Attribute::Number(value) if value.is_nan()));
        assert_eq!(found[4].1, Attribute::Whole(1));
        assert_eq!(found[5].1, Attribute::Text("smooth".to_owned()));
    }
}
