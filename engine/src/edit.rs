//! Changes of values in the text of a scenario, which leave its comments and its order.

use asperity::scenario::{Law, Scenario};
use asperity_runner::input;
use serde::Serialize;
use toml_edit::ser::ValueSerializer;
use toml_edit::{DocumentMut, Formatted, InlineTable, Item, Table, TableLike, Value};

use crate::law_change::{self, LawChange};
use crate::replace::replace;
use crate::request::Change;
use crate::slip_rule;

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
        let value = match change {
            Change { law: Some(law), .. } => Some(with_law(&document, &change.key, law)?),
            Change { slip: Some(name), .. } => Some(with_slip(&document, name)?),
            Change { value: Some(value), .. } => {
                let parsed = value.parse();
                Some(parsed.map_err(|_| format!("{}: expected a value in TOML, got {value}", change.key))?)
            }
            _ => None,
        };
        apply(document.as_table_mut(), &change.key, value)?;
    }
    Ok(document.to_string())
}

/// The distribution at `key` after a change of it; its numbers have the five digits that a hand can choose.
fn with_law(document: &DocumentMut, key: &str, change: &LawChange) -> Result<Value, String> {
    let scenario = scenario(document)?;
    let old = law_at(&scenario, key).ok_or_else(|| format!("{key}: expected the key of a distribution"))?;
    let contacts = scenario.contacts.build().map_err(|error| error.to_string())?;
    let new = law_change::changed(old, change, SCALE * contacts.thresholds.mean());
    let new = new.map_err(|words| format!("{key}.{}: {words}", old.name()))?;
    rounded(&new)
}

/// The rule of slip of this name, with numbers that belong to the scenario.
fn with_slip(document: &DocumentMut, name: &str) -> Result<Value, String> {
    let scenario = scenario(document)?;
    let rule = slip_rule::of_name(&scenario, name);
    rounded(&rule.ok_or_else(|| format!("block.slip: expected a rule of slip, got {name}"))?)
}

fn scenario(document: &DocumentMut) -> Result<Scenario, String> {
    let input = input::parse_complete(&document.to_string(), "scenario");
    Ok(input.map_err(|error| error.to_string())?.scenario)
}

fn rounded(new: &impl Serialize) -> Result<Value, String> {
    let mut value = new.serialize(ValueSerializer::new()).map_err(|error| error.to_string())?;
    round(&mut value);
    Ok(value)
}

/// The distribution at a key, which may be that of a part of a mixture.
fn law_at<'a>(scenario: &'a Scenario, key: &str) -> Option<&'a Law> {
    let contacts = &scenario.contacts;
    let (mut law, path) = [
        ("contacts.thresholds", contacts.thresholds.as_ref()),
        ("contacts.reforming", Some(&contacts.reforming)),
        ("initial", Some(&scenario.initial)),
    ]
    .into_iter()
    .find_map(|(of, law)| Some((law?, key.strip_prefix(of)?)))?;
    let mut path = path.split('.').skip(1);
    while path.next().is_some() {
        let Law::Mixture(parts) = law else { return None };
        law = &parts.get(path.next()?.parse::<usize>().ok()?)?.law;
        path.next();
    }
    Some(law)
}

fn round(value: &mut Value) {
    match value {
        Value::Float(number) => {
            let rounded = format!("{:.4e}", number.value()).parse();
            *number = Formatted::new(rounded.unwrap_or(f64::NAN));
        }
        Value::Array(items) => items.iter_mut().for_each(round),
        Value::InlineTable(items) => items.iter_mut().for_each(|(_, item)| round(item)),
        _ => {}
    }
}

fn apply(root: &mut Table, whole: &str, value: Option<Value>) -> Result<(), String> {
    let mut keys = whole.split('.');
    let last = keys.next_back().unwrap_or_default();
    let mut table: &mut dyn TableLike = root;
    let mut missing = Item::Table(Table::new());
    while let Some(key) = keys.next() {
        let mut item = table.entry(key).or_insert(missing);
        if item.is_array() || item.is_array_of_tables() {
            let index: Option<usize> = keys.next().and_then(|index| index.parse().ok());
            let part = index.and_then(|index| item.get_mut(index));
            item = part.ok_or_else(|| format!("{whole}: expected the number of an item of {key}"))?;
        }
        table = item.as_table_like_mut().ok_or_else(|| format!("{whole}: expected a table at {key}"))?;
        missing = Value::from(InlineTable::new()).into();
    }
    match value {
        None => drop(table.remove(last)),
        Some(value) => replace(table, last, value),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# A block.\n[contacts]\nthresholds.gaussian = { mean = 1.0, std = 0.05 }   # P_c\n\n[drive]\ndistance = 9.0 # far\n";

    fn change(key: &str, value: &str) -> Change {
        Change { key: key.into(), value: (!value.is_empty()).then(|| value.into()), ..Change::default() }
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
    fn parts_of_mixtures_change_where_they_are() {
        let inline = "pull.distance = 5.0\n[contacts]\nthresholds.mixture = [\n  { weight = 0.5, law.gaussian = { mean = 1.0, std = 0.1 } }, # a\n  { weight = 0.5, law.point.at = 2.0 },\n]\n";
        let tables = "pull.distance = 5.0\n[[contacts.thresholds.mixture]]\nweight = 0.5\nlaw.gaussian = { mean = 1.0, std = 0.1 } # a\n[[contacts.thresholds.mixture]]\nweight = 0.5\nlaw.point.at = 2.0\n";
        for text in [inline, tables] {
            let moved =
                changed(text, &[change("contacts.thresholds.mixture.0.law.gaussian.std", "0.2")]).unwrap();
            assert_eq!(moved, text.replace("std = 0.1", "std = 0.2"));
            let law = Some(LawChange::Family("point".to_owned()));
            let law = Change { law, ..change("contacts.thresholds.mixture.0.law", "") };
            let replaced = changed(text, &[law]).unwrap();
            assert!(replaced.contains("point = { at = 1.0 }") && replaced.contains("at = 2.0"), "{replaced}");
            for missing in ["2", "a"] {
                let error =
                    changed(text, &[change(&format!("contacts.thresholds.mixture.{missing}.weight"), "0.1")]);
                assert!(error.unwrap_err().contains("the number of an item"));
            }
        }
    }

    #[test]
    fn a_distribution_is_replaced() {
        let text = changed(TEXT, &[change("contacts.thresholds", "{ point = { at = 1.0 } }")]).unwrap();
        let scenario: DocumentMut = text.parse().unwrap();
        assert_eq!(scenario["contacts"]["thresholds"]["point"]["at"].as_float(), Some(1.0), "{text}");
        assert!(scenario["contacts"]["thresholds"].get("gaussian").is_none(), "{text}");
    }

    fn reshaped(text: &str, key: &str, law: LawChange) -> Result<String, String> {
        changed(text, &[Change { key: key.into(), law: Some(law), ..Change::default() }])
    }

    #[test]
    fn a_family_keeps_mean_and_width() {
        let text = reshaped(TEXT, "contacts.thresholds", LawChange::Family("rectangular".into())).unwrap();
        // 0.05 √3 = 0.0866.
        assert_eq!(
            text,
            TEXT.replace(
                "gaussian = { mean = 1.0, std = 0.05 }",
                "rectangular = { min = 0.9134, max = 1.0866 }"
            )
        );
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
        let text = reshaped(&text, key, LawChange::Move { handle: 4, stretch: 1.01, density: 9.0 }).unwrap();
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
