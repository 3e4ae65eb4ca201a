//! An error in a scenario, with all that is needed to draw it.

use std::ops::Range;
use std::path::Path;

/// What is wrong with a scenario, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Path of the key, empty where the whole is meant.
    pub key: String,
    /// What would have been accepted.
    pub expected: String,
    /// What came.
    pub found: String,
    /// A way out.
    pub help: Option<String>,
    /// The text at fault.
    pub source: Option<Source>,
}

/// A text and the parts of it that are at fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// A file, or `--set`.
    pub name: String,
    /// The whole text.
    pub text: String,
    /// The first mark is where to look.
    pub marks: Vec<Mark>,
}

/// A part of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// Bytes of the text.
    pub span: Range<usize>,
    /// What is said beside it.
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
    /// A scenario that cannot be read at all.
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
