//! What is wrong with a value of a scenario: its key, what was expected and what was found.

use serde::de::{Error, Expected, Unexpected};

use super::short;

/// A fault and its key.
#[derive(Debug, Clone, Default)]
pub struct Fault {
    pub path: Vec<String>,
    pub expected: String,
    pub found: String,
    /// The most similar known name.
    pub nearest: Option<Box<str>>,
    /// Whether the key itself is wrong, not its value.
    pub on_key: bool,
    /// Keys in the table at `path` that exclude one another.
    pub among: Vec<String>,
}

impl Fault {
    pub fn new(expected: &str, found: &str) -> Self {
        Self { expected: expected.to_owned(), found: found.to_owned(), ..Self::default() }
    }

    /// The same fault under a dotted key.
    pub fn under(mut self, key: &str) -> Self {
        self.path.splice(0..0, key.split('.').map(str::to_owned));
        self
    }

    /// A value that is none of the names that were expected, if these are listed after "one of" and it is quoted.
    pub fn among_names(expected: &str, found: &str) -> Self {
        let name = found.strip_prefix('"').and_then(|found| found.strip_suffix('"'));
        let nearest = name.and_then(|name| nearest_expected(expected, name)).map(Box::from);
        Self { nearest, ..Self::new(expected, found) }
    }

    /// A name that is none of those that are known.
    pub fn wrong_name(name: &str, known: &[&'static str]) -> Self {
        let nearest = nearest(name, known.iter().copied()).map(Box::from);
        Self { nearest, on_key: true, ..Self::new(&one_of(known), &format!("\"{}\"", short(name))) }
    }
}

/// The known name that is most similar to `name`, if it is similar at all.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let nearest = known.max_by(|a, b| likeness(name, a).total_cmp(&likeness(name, b)));
    nearest.filter(|known| likeness(name, known) > 0.5)
}

/// The same of the names that were expected, if these are listed after "one of".
pub fn nearest_expected<'a>(expected: &'a str, name: &str) -> Option<&'a str> {
    nearest(name, expected.strip_prefix("one of ")?.split(", "))
}

fn likeness(a: &str, b: &str) -> f64 {
    strsim::normalized_damerau_levenshtein(&a.to_lowercase(), b)
}

/// The names in one sentence.
pub fn one_of(names: &[&str]) -> String {
    match names {
        [one] => format!("the key {one}"),
        [first @ .., last] => format!("one of {} and {last}", first.join(", ")),
        [] => "no key".into(),
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "expected {}, got {}", self.expected, self.found)
    }
}

impl std::error::Error for Fault {}

impl Error for Fault {
    fn custom<T: std::fmt::Display>(message: T) -> Self {
        Self::new("something else", &short(&message.to_string()))
    }

    fn invalid_type(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::new(&expected.to_string(), &unexpected.to_string())
    }

    fn invalid_value(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::invalid_type(unexpected, expected)
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Self::wrong_name(field, expected)
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Self::wrong_name(variant, expected)
    }

    fn missing_field(field: &'static str) -> Self {
        Self::new(&format!("the key {field}"), "no such key").under(field)
    }
}
