//! An error in a scenario, with all that is needed to display it.

use std::ops::Range;
use std::path::Path;

/// An error in a scenario, and its position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Path of the key; empty if the whole scenario is meant.
    pub key: String,
    /// What was expected.
    pub expected: String,
    /// What was found.
    pub found: String,
    /// A hint for a correction.
    pub help: Option<String>,
    /// The text with the error.
    pub source: Option<Source>,
}

/// A text and its marked parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Name of the file, or `--set`.
    pub name: String,
    /// The whole text.
    pub text: String,
    /// Marked parts; the first one is the position of the error.
    pub marks: Vec<Mark>,
}

/// A marked part of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// Byte range in the text.
    pub span: Range<usize>,
    /// Label of the mark.
    pub label: String,
}

impl std::fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if !self.key.is_empty() {
            write!(f, "{}: ", self.key)?;
        }
        write!(f, "expected {}, got {}", self.expected, self.found)
    }
}

impl std::error::Error for Diagnostic {}

impl Diagnostic {
    /// The error for a scenario that cannot be read at all.
    pub(super) fn unreadable(path: &Path, why: &str) -> Box<Self> {
        Box::new(Self {
            key: String::new(),
            expected: "a scenario file".into(),
            found: format!("{}: {why}", path.display()),
            help: None,
            source: None,
        })
    }
}
