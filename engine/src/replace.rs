//! Replaces a value in the text of a scenario by another, and leaves the comments beside it and beside its parts.

use toml_edit::{Array, ArrayOfTables, Decor, InlineTable, Item, Key, RawString, TableLike, Value};

/// Replaces the value of `key`, or adds it.
pub fn replace(table: &mut dyn TableLike, key: &str, value: Value) {
    let Some(old) = table.get_mut(key) else {
        table.insert(key, Item::Value(value));
        return;
    };
    if let (Some(old), true) = (old.as_value_mut(), number(&value).is_some()) {
        put(old, value);
        return;
    }
    let above = merge(old, value);
    if let (Some(above), Some(mut key)) = (above, table.key_mut(key)) {
        key.leaf_decor_mut().set_prefix(above);
    }
}

/// Makes an item the new value; what stands above its first part where its key must take that over.
fn merge(item: &mut Item, new: Value) -> Option<RawString> {
    match (item, new) {
        (Item::Value(old), new) => merge_value(old, new),
        (Item::Table(old), Value::InlineTable(new)) => merge_table(old, new),
        (Item::ArrayOfTables(old), Value::Array(new)) if new.iter().all(Value::is_inline_table) => {
            merge_tables(old, new);
        }
        (item, mut new) => {
            let (above, after) = around(item);
            if let Some(after) = after {
                new.decor_mut().set_suffix(after);
            }
            *item = Item::Value(new);
            return above;
        }
    }
    None
}

/// What stands above and after a value that is written with dotted keys.
fn around(item: &Item) -> (Option<RawString>, Option<RawString>) {
    let first = item.as_table().filter(|table| table.is_dotted());
    let Some((key, inner)) = first.and_then(|table| table.get_key_value(table.iter().next()?.0)) else {
        return (None, item.as_value().and_then(|value| value.decor().suffix().cloned()));
    };
    let (above, after) = around(inner);
    (above.or_else(|| key.leaf_decor().prefix().cloned()), after)
}

fn merge_value(old: &mut Value, new: Value) {
    match (old, new) {
        (Value::InlineTable(old), Value::InlineTable(new)) => {
            let count = old.len();
            merge_table(old, new);
            // Blanks belong to the first and the last part; a comment needs its line.
            let mut inside = old.clone();
            inside.decor_mut().clear();
            if old.len() != count && !inside.to_string().contains('#') {
                old.fmt();
            }
        }
        (Value::Array(old), Value::Array(new)) => merge_array(old, new),
        // A number that has the digits of the new one may have more of them.
        (old, new) if !same(old, &new) => put(old, new),
        _ => {}
    }
}

fn put(old: &mut Value, mut new: Value) {
    *new.decor_mut() = old.decor().clone();
    *old = new;
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| Some(value.as_integer()? as f64))
}

fn same(old: &Value, new: &Value) -> bool {
    let digits = |value| number(value).map(|number| format!("{number:.4e}"));
    digits(old).is_some_and(|old| Some(old) == digits(new))
}

/// Gives a table the keys and values of another. A key that goes leaves its place, and the comments beside it, to one that comes.
fn merge_table(table: &mut dyn TableLike, mut new: InlineTable) {
    let old: Vec<(Key, Item)> = take_all(table);
    let known = |name: &str| old.iter().any(|(key, _)| key.get() == name);
    let added: Vec<String> =
        new.iter().map(|(name, _)| name.to_owned()).filter(|name| !known(name)).collect();
    let mut added = added.into_iter();
    let mut left = String::new();
    for (key, mut item) in old {
        let name = if new.contains_key(key.get()) { Some(key.get().to_owned()) } else { added.next() };
        let Some((name, value)) = name.and_then(|name| Some((name.clone(), new.remove(&name)?))) else {
            left += &comments(&key, &item);
            continue;
        };
        let mut decor = key.leaf_decor().clone();
        if let Some(above) = merge(&mut item, value) {
            decor.set_prefix(above);
        }
        let key = Key::new(name).with_leaf_decor(decor).with_dotted_decor(key.dotted_decor().clone());
        table.entry_format(&key).or_insert(item);
    }
    for (name, value) in new {
        table.insert(&name, Item::Value(value));
    }
    let last = table.iter_mut().last().and_then(|(_, item)| item.as_value_mut());
    if let Some(last) = last.filter(|_| !left.is_empty()) {
        let before = last.decor().suffix().and_then(RawString::as_str).unwrap_or_default();
        let suffix = format!("{}{left}", before.trim_end());
        last.decor_mut().set_suffix(suffix);
    }
}

fn take_all(table: &mut dyn TableLike) -> Vec<(Key, Item)> {
    let names: Vec<String> = table.iter().map(|(name, _)| name.to_owned()).collect();
    names.iter().filter_map(|name| Some((table.key(name)?.clone(), table.remove(name)?))).collect()
}

/// The comments above and after a value, each on a line of its own.
fn comments(key: &Key, item: &Item) -> String {
    let decors = [Some(key.leaf_decor()), item.as_value().map(Value::decor)];
    let texts = decors.into_iter().flatten().flat_map(|decor: &Decor| [decor.prefix(), decor.suffix()]);
    let lines = texts.flatten().filter_map(RawString::as_str).flat_map(str::lines);
    lines.map(str::trim).filter(|line| line.starts_with('#')).map(|line| format!("\n{line}")).collect()
}

fn merge_array(array: &mut Array, new: Array) {
    let mut left = String::new();
    while array.len() > new.len() {
        let removed = array.remove(array.len() - 1);
        let before = removed.decor().prefix().and_then(RawString::as_str).unwrap_or_default();
        if before.contains('#') {
            left.insert_str(0, before.trim_end());
        }
    }
    // A comment after the last comma stands before the bracket.
    if !left.is_empty() {
        let trailing = array.trailing().as_str().unwrap_or_default();
        let line = if trailing.starts_with('\n') { "" } else { "\n" };
        array.set_trailing(format!("{left}{line}{trailing}"));
    }
    let count = array.len();
    for (i, value) in new.into_iter().enumerate() {
        match array.get_mut(i) {
            Some(old) => merge_value(old, value),
            None => array.push_formatted(like_last(array, count, value)),
        }
    }
}

/// A value with the blanks before the last of `count` others.
fn like_last(array: &Array, count: usize, mut value: Value) -> Value {
    let last = count.checked_sub(1).and_then(|last| array.get(last));
    let prefix = last.and_then(|last| last.decor().prefix()).and_then(RawString::as_str).unwrap_or_default();
    // A comment is one of the value before.
    let line = prefix.rfind('\n').map_or(prefix, |at| &prefix[at..]);
    *value.decor_mut() = Decor::new(if line.is_empty() { " " } else { line }, "");
    value
}

fn merge_tables(tables: &mut ArrayOfTables, new: Array) {
    while tables.len() > new.len() {
        tables.remove(tables.len() - 1);
    }
    for (i, value) in new.into_iter().enumerate() {
        let Value::InlineTable(value) = value else { continue };
        match tables.get_mut(i) {
            Some(old) => merge_table(old, value),
            None => tables.push(value.into_table()),
        }
    }
}

#[cfg(test)]
mod tests {
    use toml_edit::DocumentMut;

    use super::*;

    fn replaced(text: &str, value: &str) -> String {
        let mut document: DocumentMut = text.parse().unwrap();
        replace(document.as_table_mut(), "law", value.parse().unwrap());
        let found = document.to_string();
        let read = |text: &str| text.parse::<DocumentMut>().unwrap().into_table();
        let (left, right) = (read(&found), read(&format!("law = {value}")));
        assert_eq!(plain(left["law"].clone()), plain(right["law"].clone()), "{found}");
        found
    }

    /// The same value without the places of its text.
    fn plain(item: Item) -> String {
        let mut value = item.into_value().unwrap();
        bare(&mut value);
        value.to_string()
    }

    fn bare(value: &mut Value) {
        if let Some(table) = value.as_inline_table_mut() {
            table.iter_mut().for_each(|(_, value)| bare(value));
            table.fmt();
            table.set_dotted(false);
        }
        if let Some(array) = value.as_array_mut() {
            array.iter_mut().for_each(bare);
            array.set_trailing("");
            array.fmt();
        }
        if let Some(number) = number(value) {
            *value = number.into();
        }
        value.decor_mut().clear();
    }

    #[test]
    fn comments_stay_beside_another_family() {
        let gamma = "{ gamma = { mean = 2.0, std = 0.5 } }";
        for (text, expected) in [
            (
                "# Above.\nlaw.gaussian = { mean = 1.0, std = 0.1 }   # P_c\n",
                "# Above.\nlaw.gamma = { mean = 2.0, std = 0.5 }   # P_c\n",
            ),
            (
                "# Above.\n[law.gaussian] # here\n# The mean.\nmean = 1.0 # m\nstd = 0.1 # s\n",
                "# Above.\n[law.gamma] # here\n# The mean.\nmean = 2.0 # m\nstd = 0.5 # s\n",
            ),
            (
                "# Above.\nlaw.gaussian.mean = 1 # m\nlaw.gaussian.std = 0.1 # s\n",
                "# Above.\nlaw.gamma.mean = 2.0 # m\nlaw.gamma.std = 0.5 # s\n",
            ),
            ("law = { point = { at = 1.0 } } # P_c\n", "law = { gamma = { mean = 2.0, std = 0.5 } } # P_c\n"),
        ] {
            assert_eq!(replaced(text, gamma), expected);
        }
        assert_eq!(
            replaced(
                "[law.gaussian]\nmean = 1.0 # m\n# The width.\nstd = 0.1 # s\n",
                "{ exponential = { mean = 1.0 } }"
            ),
            "[law.exponential]\nmean = 1.0 # m\n# The width.\n# s\n"
        );
        assert_eq!(
            replaced("# A.\nlaw.damped = { damping = 0.1 } # slow\n", "\"reset\""),
            "# A.\nlaw = \"reset\" # slow\n"
        );
    }

    #[test]
    fn comments_stay_in_a_mixture() {
        let text = "law.mixture = [ # parts\n  { weight = 0.5, law.point.at = 1.0 }, # a\n  { weight = 0.5, law.point.at = 2.0 }, # b\n] # all\n";
        let part = |weight: f64, at: f64| {
            format!("{{ weight = {weight:?}, law = {{ point = {{ at = {at:?} }} }} }}")
        };
        let of = |parts: &[String]| format!("{{ mixture = [{}] }}", parts.join(", "));
        assert_eq!(
            replaced(text, &of(&[part(0.25, 1.0), part(0.75, 2.0)])),
            text.replacen("0.5", "0.25", 1).replacen("weight = 0.5", "weight = 0.75", 1)
        );
        let three = replaced(text, &of(&[part(0.5, 1.0), part(0.25, 2.0), part(0.25, 3.0)]));
        assert!(["# parts", "# a", "# b", "# all"].iter().all(|word| three.contains(word)), "{three}");
        let one = replaced(text, &of(&[part(1.0, 2.0)]));
        assert!(["# parts", "# a", "# b", "# all"].iter().all(|word| one.contains(word)), "{one}");
        let single = replaced(text, "{ gaussian = { mean = 1.0, std = 0.1 } }");
        assert!(single.ends_with("} # all\n"), "{single}");
        let tables = "[[law.mixture]] # one\nweight = 0.5\nlaw.point.at = 1.0 # a\n[[law.mixture]]\nweight = 0.5\nlaw.point.at = 2.0 # b\n";
        assert_eq!(replaced(tables, &of(&[part(0.5, 1.0), part(0.5, 3.0)])), tables.replace("2.0", "3.0"));
        assert!(
            replaced(tables, &of(&[part(0.5, 1.0), part(0.25, 2.0), part(0.25, 3.0)]))
                .starts_with(&tables[..60])
        );
    }

    #[test]
    fn a_number_that_stays_keeps_its_digits() {
        let text = "law.gaussian = { mean = 1, std = 0.1234567 }\n";
        let moved = replaced_loosely(text, "{ gaussian = { mean = 2.0, std = 0.12346 } }");
        assert_eq!(moved, "law.gaussian = { mean = 2.0, std = 0.1234567 }\n");
        assert_eq!(replaced_loosely("law = 0.1234567\n", "0.12346"), "law = 0.12346\n");
    }

    fn replaced_loosely(text: &str, value: &str) -> String {
        let mut document: DocumentMut = text.parse().unwrap();
        replace(document.as_table_mut(), "law", value.parse().unwrap());
        document.to_string()
    }
}
