//! Changes of values in the text of a scenario, which leave its comments and its order.

use asperity::scenario::{Contacts, Law, Scenario};
use asperity_runner::input;
use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike, Value};

use crate::law_change::{self, LawChange};
use crate::request::Change;

/// Mean of a distribution that replaces one of mean 0, in mean thresholds.
const SCALE: f64 = 0.1;

/// The text after `changes`.
///
/// # Errors
/// A text or a value that is not TOML, a key below a value that is no table, a distribution that cannot change so, in words.
pub fn changed(text: &str, changes: &[Change]) -> Result<String, String> {
    if changes.is_empty() {
        return Ok(text.to_owned());
    }
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| error.to_string())?;
    for change in changes {
        let value = match (&change.law, &change.value) {
            (Some(law), _) => Some(with_law(&document, &change.key, law)?),
            (None, Some(value)) => {
                let parsed = value.parse();
                Some(parsed.map_err(|_| format!("{}: expected a value in TOML, got {value}", change.key))?)
            }
            (None, None) => None,
        };
        apply(document.as_table_mut(), &change.key, value)?;
    }
    Ok(document.to_string())
}

/// The distribution at `key` after a change of it.
fn with_law(document: &DocumentMut, key: &str, change: &LawChange) -> Result<Value, String> {
    let input =
        input::parse_complete(&document.to_string(), "scenario").map_err(|error| error.to_string())?;
    let scenario = serde_json::to_value(&input.scenario).map_err(|error| error.to_string())?;
    let old = scenario.pointer(&format!("/{}", key.replace('.', "/"))).cloned();
    let old: Option<Law> = old.and_then(|law| serde_json::from_value(law).ok());
    let old = old.ok_or_else(|| format!("{key}: expected the key of a distribution"))?;
    let contacts = input.scenario.contacts.build().map_err(|error| error.to_string())?;
    let new = law_change::changed(&old, change, SCALE * contacts.thresholds.mean());
    let new = new.map_err(|words| format!("{key}.{}: {words}", old.name()))?;
    in_toml(&new).ok_or_else(|| format!("{key}: expected a distribution of plain numbers"))
}

/// A distribution as a value in one line; its numbers have the five digits that a hand can choose.
fn in_toml(law: &Law) -> Option<Value> {
    let law = serde_json::from_value(rounded(serde_json::to_value(law).ok()?)).ok()?;
    let contacts = Contacts { thresholds: Some(law), ..Contacts::default() };
    let mut document: DocumentMut = input::to_text(&Scenario::new(contacts)).parse().ok()?;
    let law = document.get_mut("contacts")?.as_table_like_mut()?.remove("thresholds")?;
    law.into_value().ok()
}

fn rounded(value: serde_json::Value) -> serde_json::Value {
    use serde_json::Value::{Array, Null, Number, Object};
    match value {
        Number(number) => {
            format!("{:.4e}", number.as_f64().unwrap_or(f64::NAN)).parse::<f64>().map_or(Null, Into::into)
        }
        Array(items) => items.into_iter().map(rounded).collect(),
        Object(items) => items.into_iter().map(|(key, value)| (key, rounded(value))).collect(),
        other => other,
    }
}

fn apply(root: &mut Table, whole: &str, value: Option<Value>) -> Result<(), String> {
    let mut keys: Vec<&str> = whole.split('.').collect();
    let last = keys.pop().unwrap_or_default();
    let mut table: &mut dyn TableLike = root;
    for (depth, key) in keys.into_iter().enumerate() {
        let missing =
            if depth == 0 { Item::Table(Table::new()) } else { Value::from(InlineTable::new()).into() };
        table = table
            .entry(key)
            .or_insert(missing)
            .as_table_like_mut()
            .ok_or_else(|| format!("{whole}: expected a table at {key}"))?;
    }
    match value {
        None => drop(table.remove(last)),
        Some(value) => replace(table, last, value),
    }
    Ok(())
}

/// Replaces a value; what is written around it, such as a comment, stays.
fn replace(table: &mut dyn TableLike, key: &str, mut value: Value) {
    if let Some(old) = table.get(key).and_then(Item::as_value) {
        *value.decor_mut() = old.decor().clone();
    }
    table.insert(key, Item::Value(value));
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# A block.\n[contacts]\nthresholds.gaussian = { mean = 1.0, std = 0.05 }   # P_c\n\n[drive]\ndistance = 9.0 # far\n";

    fn change(key: &str, value: &str) -> Change {
        Change { key: key.into(), value: (!value.is_empty()).then(|| value.into()), law: None }
    }

    #[test]
    fn values_change_and_comments_stay() {
        let changes = [change("contacts.thresholds.gaussian.std", "0.2"), change("drive.distance", "4.0")];
        let expected = TEXT.replace("0.05", "0.2").replace("9.0", "4.0");
        assert_eq!(changed(TEXT, &changes).unwrap(), expected);
    }

    #[test]
    fn tables_are_added_and_removed() {
        let added = changed(TEXT, &[change("block.stiffness", "0.5")]).unwrap();
        assert!(added.starts_with(TEXT) && added.ends_with("[block]\nstiffness = 0.5\n"), "{added}");
        assert_eq!(changed(&added, &[change("block", "")]).unwrap(), TEXT);
    }

    #[test]
    fn a_distribution_is_replaced() {
        let text = changed(TEXT, &[change("contacts.thresholds", "{ point = { at = 1.0 } }")]).unwrap();
        let scenario: DocumentMut = text.parse().unwrap();
        assert_eq!(scenario["contacts"]["thresholds"]["point"]["at"].as_float(), Some(1.0), "{text}");
        assert!(scenario["contacts"]["thresholds"].get("gaussian").is_none(), "{text}");
    }

    fn reshaped(text: &str, key: &str, law: LawChange) -> Result<String, String> {
        changed(text, &[Change { key: key.into(), value: None, law: Some(law) }])
    }

    #[test]
    fn a_family_keeps_mean_and_width() {
        let text = reshaped(TEXT, "contacts.thresholds", LawChange::Family("rectangular".into())).unwrap();
        // 0.05 √3 = 0.0866.
        assert!(text.contains("thresholds = { rectangular = { min = 0.9134, max = 1.0866 } }"), "{text}");
        assert!(text.starts_with("# A block.") && text.ends_with("distance = 9.0 # far\n"), "{text}");
        let text = reshaped(TEXT, "contacts.reforming", LawChange::Family("gamma".into())).unwrap();
        assert!(text.contains("reforming = { gamma = { mean = 0.1, std = 0.02 } }"), "{text}");
        let error = reshaped(TEXT, "contacts.thresholds", LawChange::Family("normal".into())).unwrap_err();
        assert!(error.starts_with("contacts.thresholds.gaussian: expected one of gaussian, "), "{error}");
        assert!(
            reshaped(TEXT, "drive", LawChange::Family("gamma".into()))
                .unwrap_err()
                .contains("a distribution")
        );
    }

    #[test]
    fn a_polygon_is_drawn_by_hand() {
        let key = "contacts.thresholds";
        let text = reshaped(TEXT, key, LawChange::Family("tabulated".into())).unwrap();
        let text = reshaped(&text, key, LawChange::Move { node: 4, stretch: 1.01, density: 9.0 }).unwrap();
        let text = reshaped(&text, key, LawChange::Add(None)).unwrap();
        let text = reshaped(&text, key, LawChange::Remove(0)).unwrap();
        let scenario = input::parse_complete(&text, "scenario").unwrap().scenario;
        let Some(Law::Tabulated(table)) = &scenario.contacts.thresholds else { panic!("{text}") };
        assert_eq!(table.stretch.as_ref().unwrap().len(), 9);
        let error = reshaped(TEXT, key, LawChange::Add(None)).unwrap_err();
        assert!(error.contains("expected a tabulated density"), "{error}");
    }

    #[test]
    fn what_is_no_value_is_refused() {
        assert!(changed(TEXT, &[change("drive.distance", "= 3")]).unwrap_err().contains("drive.distance"));
        assert!(changed(TEXT, &[change("drive.distance.far", "3")]).unwrap_err().contains("a table"));
        assert!(changed("x =", &[change("x", "3")]).is_err());
    }
}
