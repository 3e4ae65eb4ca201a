//! `--set key.path=value`. The value is TOML, or plain text unless it begins like a table, a list or a string.
//! A distribution replaces the one in the file.

use asperity::scenario::Law;
use toml::de::{DeTable, DeValue};

use super::document::{Document, Kind, Node, Place};
use super::fault::Fault;
use super::{Diagnostic, short};

/// Merges one override into the document.
pub fn apply(document: &mut Document, argument: &str) -> Result<(), Box<Diagnostic>> {
    let source = document.add_source("--set", argument);
    let wrong = |found: String| {
        let fault = Fault::new("KEY=VALUE, such as contacts.count=100", &found);
        document.diagnose(&fault, Place { source, span: 0..argument.len() }, &[])
    };
    let Some((key, value)) = argument.split_once('=') else {
        return Err(wrong(format!("no = in \"{}\"", short(argument))));
    };
    let Ok(keys) = DeTable::parse(&format!("{key}=0")).map(|table| path(table.into_inner(), source)) else {
        return Err(wrong(format!("the key \"{}\"", short(key))));
    };
    let leaf = match DeTable::parse(argument) {
        Ok(table) => leaf(Kind::read(DeValue::Table(table.into_inner()), source), keys.len()),
        Err(error) if value.trim_start().starts_with(['{', '[', '"', '\'']) => {
            return Err(document.syntax(source, &error));
        }
        Err(_) => Node {
            key: keys.last().expect("TOML has no empty keys").1.clone(),
            value: Place { source, span: key.len() + 1..argument.len() },
            kind: plain(value.trim()),
        },
    };
    insert(&mut document.root, &keys, leaf).map_err(|fault| document.draw(fault))
}

/// The dotted key of a document with a single key.
fn path(table: DeTable<'_>, source: usize) -> Vec<(String, Place)> {
    let mut keys = Vec::new();
    let mut next = Some(table);
    while let Some((key, value)) = next.take().and_then(|table| table.into_iter().next()) {
        keys.push((key.get_ref().to_string(), Place { source, span: key.span() }));
        if let DeValue::Table(table) = value.into_inner() {
            next = Some(table);
        }
    }
    keys
}

/// The node `depth` keys down in a document with a single dotted key.
fn leaf(kind: Kind, depth: usize) -> Node {
    let Kind::Table(mut entries) = kind else { unreachable!("fewer tables than keys") };
    let node = entries.swap_remove(0).1;
    if depth == 1 { node } else { leaf(node.kind, depth - 1) }
}

/// Parses a value as it is typed: `.5` and `5.` are accepted as numbers, though not valid TOML.
fn plain(value: &str) -> Kind {
    value.parse().map_or_else(|_| Kind::Text(value.to_owned()), Kind::Float)
}

/// Puts a value under a dotted key. Faults are at the value's own place.
pub fn put(root: &mut Node, key: &str, leaf: Node) -> Result<(), Fault> {
    let keys: Vec<_> = key.split('.').map(|name| (name.to_owned(), leaf.key.clone())).collect();
    insert(root, &keys, leaf)
}

fn insert(node: &mut Node, keys: &[(String, Place)], leaf: Node) -> Result<(), Fault> {
    let Some(((key, place), rest)) = keys.split_first() else {
        *node = leaf;
        return Ok(());
    };
    if let Kind::List(items) = &mut node.kind {
        let expected = format!("an index below {}, counting from 0", items.len());
        let item = key.parse().ok().and_then(|i: usize| items.get_mut(i));
        let item = item.ok_or_else(|| Fault::new(&expected, &format!("\"{key}\"")))?;
        return insert(item, rest, leaf).map_err(|fault| fault.under(key));
    }
    if !matches!(node.kind, Kind::Table(_)) {
        *node = Node { kind: Kind::Table(Vec::new()), key: place.clone(), value: place.clone() };
    }
    let Kind::Table(entries) = &mut node.kind else { unreachable!("it was just made one") };
    let is_law = |name: &str| Law::NAMES.contains(&name);
    if is_law(key) {
        entries.retain(|(other, _)| other == key || !is_law(other));
    }
    let i = entries.iter().position(|(other, _)| other == key).unwrap_or_else(|| {
        let empty = Node { key: place.clone(), value: place.clone(), kind: Kind::Table(Vec::new()) };
        entries.push((key.clone(), empty));
        entries.len() - 1
    });
    insert(&mut entries[i].1, rest, leaf).map_err(|fault| fault.under(key))
}
