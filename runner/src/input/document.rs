//! A TOML document as a tree that keeps the position of each key and value in the text.

use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::Fault;
use super::{Diagnostic, Mark, Source, short};

/// A scenario file with its overrides merged in.
#[derive(Debug, Clone)]
pub struct Document {
    /// The file, then each override.
    sources: Arc<Vec<(String, String)>>,
    pub root: Node,
}

/// The position of a key or value: source and byte range.
#[derive(Debug, Clone)]
pub struct Place {
    pub source: usize,
    pub span: Range<usize>,
}

#[derive(Debug, Clone)]
pub struct Node {
    /// Position of the key, or of the value itself in a list.
    pub key: Place,
    pub value: Place,
    pub kind: Kind,
}

#[derive(Debug, Clone)]
pub enum Kind {
    Text(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Date(String),
    List(Vec<Node>),
    /// Entries in the order of the text.
    Table(Vec<(String, Node)>),
}

impl Document {
    pub fn parse(name: &str, text: &str) -> Result<Self, Box<Diagnostic>> {
        let mut document = Self {
            sources: Arc::new(vec![(name.to_owned(), text.to_owned())]),
            root: Node { key: Place::end(text), value: Place::end(text), kind: Kind::Table(Vec::new()) },
        };
        let table = DeTable::parse(text).map_err(|e| document.syntax(0, &e))?;
        document.root.kind = Kind::read(DeValue::Table(table.into_inner()), 0);
        Ok(document)
    }

    /// Adds a source text.
    pub fn add_source(&mut self, name: &str, text: &str) -> usize {
        Arc::make_mut(&mut self.sources).push((name.to_owned(), text.to_owned()));
        self.sources.len() - 1
    }

    /// The error for a text that is not TOML.
    pub fn syntax(&self, source: usize, error: &toml::de::Error) -> Box<Diagnostic> {
        let message = error.message().trim().replace('\n', ", ");
        let span = error.span().unwrap_or(0..0);
        self.diagnose(&Fault::new("valid TOML", &message), Place { source, span }, &[])
    }

    /// Adds the position in the text to a fault.
    pub fn draw(&self, fault: Fault) -> Box<Diagnostic> {
        let mut node = &self.root;
        let mut path = &fault.path[..];
        while let Some((child, rest)) = node.along(path) {
            (node, path) = (child, rest);
        }
        let on_key = fault.on_key || matches!(node.kind, Kind::Table(_));
        let place = if on_key { node.key.clone() } else { node.value.clone() };
        let others: Vec<_> = fault.among.iter().filter_map(|key| node.child(key)).collect();
        self.diagnose(&fault, place, &others)
    }

    /// The fault, marked at `place`, or at all keys of which only one is allowed.
    pub fn diagnose(&self, fault: &Fault, place: Place, among: &[&Node]) -> Box<Diagnostic> {
        let (name, text) = &self.sources[place.source];
        let overrides: Vec<_> =
            self.sources[1..].iter().map(|(_, text)| format!("--set {}", short(text))).collect();
        let with =
            (place.source == 0 && !overrides.is_empty()).then(|| format!("with {}", overrides.join(" ")));
        let mut marks = Vec::new();
        for node in among.iter().filter(|node| node.key.source == place.source) {
            marks.push(Mark { span: node.key.span.clone(), label: "one of them".into() });
        }
        if marks.is_empty() {
            let label = if fault.on_key { "unknown".into() } else { format!("expected {}", fault.expected) };
            marks.push(Mark { span: place.span, label });
        }
        Box::new(Diagnostic {
            key: fault.path.join("."),
            expected: fault.expected.clone(),
            found: fault.found.clone(),
            help: fault.nearest.as_ref().map(|name| format!("did you mean {name}?")).or(with),
            source: Some(Source { name: name.clone(), text: text.clone(), marks }),
        })
    }
}

impl Place {
    /// The end of a text, where a missing key could be added.
    fn end(text: &str) -> Self {
        let end = text.trim_end().len();
        Self { source: 0, span: end..end }
    }
}

impl From<&str> for Node {
    /// The position of a value that is in no text.
    fn from(text: &str) -> Self {
        Self { key: Place::end(""), value: Place::end(""), kind: Kind::Text(text.to_owned()) }
    }
}

impl Node {
    pub fn read(key: Place, value: Spanned<DeValue<'_>>) -> Self {
        let source = key.source;
        Self {
            key,
            value: Place { source, span: value.span() },
            kind: Kind::read(value.into_inner(), source),
        }
    }

    /// An entry of a table, or an item of a list.
    pub fn child(&self, key: &str) -> Option<&Self> {
        match &self.kind {
            Kind::Table(entries) => entries.iter().find(|(k, _)| k == key).map(|(_, node)| node),
            Kind::List(items) => items.get(key.parse::<usize>().ok()?),
            _ => None,
        }
    }

    /// The node at the beginning of a path, and the rest of the path. A key may have dots, as those of axes have.
    fn along<'a, 'p>(&'a self, path: &'p [String]) -> Option<(&'a Self, &'p [String])> {
        let first = path.first()?;
        // For values that were read from a file, the position is that of the file name.
        let own = self.child(first).or_else(|| self.file(first)).map(|node| (node, &path[1..]));
        own.or_else(|| (2..=path.len()).find_map(|n| Some((self.child(&path[..n].join("."))?, &path[n..]))))
    }

    /// The entry that names the file from which `key` was read.
    fn file(&self, key: &str) -> Option<&Self> {
        self.child("file").or_else(|| self.child(&format!("{key}_file")))
    }
}

impl Kind {
    pub fn read(value: DeValue<'_>, source: usize) -> Self {
        match value {
            DeValue::String(text) => Self::Text(text.into_owned()),
            DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
                Ok(integer) => Self::Integer(integer),
                Err(_) if number.radix() == 10 => Self::float(number.as_str()),
                // It is refused as too large for a whole number.
                Err(_) => Self::Float(
                    u128::from_str_radix(number.as_str(), number.radix())
                        .map_or(f64::INFINITY, |number| number as f64),
                ),
            },
            DeValue::Float(number) => Self::float(number.as_str()),
            DeValue::Boolean(truth) => Self::Boolean(truth),
            DeValue::Datetime(date) => Self::Date(date.to_string()),
            DeValue::Array(items) => {
                let place = |item: &Spanned<_>| Place { source, span: item.span() };
                Self::List(items.into_iter().map(|item| Node::read(place(&item), item)).collect())
            }
            DeValue::Table(table) => {
                let mut entries: Vec<_> = table
                    .into_iter()
                    .map(|(key, value)| {
                        let place = Place { source, span: key.span() };
                        (key.into_inner().into_owned(), Node::read(place, value))
                    })
                    .collect();
                entries.sort_by_key(|(_, node)| node.key.span.start);
                Self::Table(entries)
            }
        }
    }

    fn float(text: &str) -> Self {
        Self::Float(text.parse().unwrap_or(f64::NAN))
    }

    /// The found value, as text for messages.
    pub fn describe(&self) -> String {
        match self {
            Self::Text(text) => format!("the text \"{}\"", short(text)),
            Self::Integer(number) => number.to_string(),
            Self::Float(number) => format!("{number:?}"),
            Self::Boolean(truth) => truth.to_string(),
            Self::Date(date) => format!("the date {date}"),
            Self::List(items) => format!("a list of {}", items.len()),
            Self::Table(entries) => {
                let keys: Vec<_> = entries.iter().map(|(key, _)| key.as_str()).collect();
                let keys = if keys.is_empty() { "no keys".into() } else { short(&keys.join(", ")) };
                format!("a table with {keys}")
            }
        }
    }
}
