//! Changes of values in the text of a scenario, which leave its comments and its order.

use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike, Value};

use crate::request::Change;

/// The text after `changes`.
///
/// # Errors
/// A text or a value that is not TOML, or a key below a value that is no table, in words.
pub fn changed(text: &str, changes: &[Change]) -> Result<String, String> {
    if changes.is_empty() {
        return Ok(text.to_owned());
    }
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| error.to_string())?;
    for change in changes {
        apply(document.as_table_mut(), change)?;
    }
    Ok(document.to_string())
}

fn apply(root: &mut Table, change: &Change) -> Result<(), String> {
    let mut keys: Vec<&str> = change.key.split('.').collect();
    let last = keys.pop().unwrap_or_default();
    let mut table: &mut dyn TableLike = root;
    for (depth, key) in keys.into_iter().enumerate() {
        let missing =
            if depth == 0 { Item::Table(Table::new()) } else { Value::from(InlineTable::new()).into() };
        table = table
            .entry(key)
            .or_insert(missing)
            .as_table_like_mut()
            .ok_or_else(|| format!("{}: expected a table at {key}", change.key))?;
    }
    match &change.value {
        None => drop(table.remove(last)),
        Some(value) => {
            let value: Value = value
                .parse()
                .map_err(|_| format!("{}: expected a value in TOML, got {value}", change.key))?;
            replace(table, last, value);
        }
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
        Change { key: key.into(), value: (!value.is_empty()).then(|| value.into()) }
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

    #[test]
    fn what_is_no_value_is_refused() {
        assert!(changed(TEXT, &[change("drive.distance", "= 3")]).unwrap_err().contains("drive.distance"));
        assert!(changed(TEXT, &[change("drive.distance.far", "3")]).unwrap_err().contains("a table"));
        assert!(changed("x =", &[change("x", "3")]).is_err());
    }
}
