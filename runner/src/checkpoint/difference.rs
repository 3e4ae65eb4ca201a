//! Differences between a checkpoint and the run that would be resumed from it.

use std::path::Path;

use toml::{Table, Value};

use super::error::{Error, Result};
use super::file::Header;

/// Largest number of differences that are listed.
const LISTED: usize = 3;

/// Refuses a checkpoint of another version of asperity or of another scenario.
pub fn refuse(path: &Path, header: &Header, scenario: &str) -> Result<()> {
    let another =
        |expected: String, found: String| Err(Error::Another { path: path.to_owned(), expected, found });
    let version = env!("CARGO_PKG_VERSION");
    if header.version != version {
        return another(format!("asperity {version}"), format!("asperity {}", header.version));
    }
    if header.scenario == scenario {
        return Ok(());
    }
    let tree = |text: &str| text.parse::<Table>().map_or(Value::Boolean(false), Value::Table);
    let mut differences = Vec::new();
    compare("", Some(&tree(scenario)), Some(&tree(&header.scenario)), &mut differences);
    let more = differences.len().saturating_sub(LISTED);
    let side = |pick: fn(&Difference) -> &String| {
        let listed: Vec<_> =
            differences.iter().take(LISTED).map(|d| format!("{} = {}", d.key, pick(d))).collect();
        listed.join(", ")
    };
    let rest = if more > 0 { format!(" and {more} more differences") } else { String::new() };
    another(
        format!("a scenario with {}", side(|d| &d.here)),
        format!("a scenario with {}{rest}", side(|d| &d.there)),
    )
}

/// A key with different values.
struct Difference {
    key: String,
    here: String,
    there: String,
}

fn compare(key: &str, here: Option<&Value>, there: Option<&Value>, found: &mut Vec<Difference>) {
    if here == there {
        return;
    }
    let table = |value: Option<&Value>| match value {
        Some(Value::Table(table)) => Some(table.clone()),
        None => Some(Table::new()),
        Some(_) => None,
    };
    if let (Some(here), Some(there)) = (table(here), table(there)) {
        let others = there.keys().filter(|name| !here.contains_key(*name));
        for name in here.keys().chain(others) {
            let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            compare(&key, here.get(name), there.get(name), found);
        }
        return;
    }
    let [here, there] = [here, there].map(|value| value.map_or("nothing".into(), short));
    found.push(Difference { key: key.to_owned(), here, there });
}

/// A value on one line.
fn short(value: &Value) -> String {
    const MOST: usize = 60;
    let text = value.to_string();
    if text.chars().count() <= MOST { text } else { text.chars().take(MOST).chain(['…']).collect() }
}
