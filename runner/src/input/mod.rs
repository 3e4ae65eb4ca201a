//! Reading of scenario files: overrides, inlined tables, checks, and errors with their position in the text.

mod columns;
mod deserialise;
mod diagnostic;
mod document;
mod editor_schema;
mod fault;
mod overrides;
mod schema;
mod sweep;
mod tables;
mod text;

use std::path::{Path, PathBuf};

use asperity::monitor::Monitor;
use asperity::scenario::{Figure, Scenario, Sweep, SweepAxes, SweepAxis};
use asperity::shape::Edges;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

pub use diagnostic::{Diagnostic, Mark, Source};
pub use editor_schema::editor_schema;
pub use fault::{nearest, nearest_expected};
pub use schema::schema;
pub(crate) use sweep::{Cases, Choice};

use crate::memory;
use deserialise::Reader;
use document::{Document, Node};
use fault::Fault;

/// A valid scenario, and its source text.
#[derive(Debug)]
pub struct Input {
    /// The scenario, with its tables inlined.
    pub scenario: Scenario,
    /// Warnings about valid values with unexpected consequences.
    pub warnings: Vec<String>,
    document: Document,
    /// The folder to which the paths of files are relative; without one, no file is read.
    directory: Option<PathBuf>,
}

/// Reads the scenario at `path`, with `overrides` of the form `key.path=value`.
///
/// # Errors
/// An invalid scenario, with the position of the error.
pub fn read(path: &Path, overrides: &[String]) -> Result<Input, Box<Diagnostic>> {
    let text = text::read(path).map_err(|why| Diagnostic::unreadable(path, &why))?;
    parse(&text, &path.display().to_string(), path.parent().unwrap_or(Path::new("")), overrides)
}

/// Reads a scenario from its text. `name` is used in messages; paths in `file` keys are relative to `directory`.
///
/// # Errors
/// An invalid scenario, with the position of the error.
pub fn parse(
    text: &str,
    name: &str,
    directory: &Path,
    overrides: &[String],
) -> Result<Input, Box<Diagnostic>> {
    parse_with(text, name, directory, overrides, &mut ())
}

/// The same with a monitor: a `[fit]` is checked with the life of its contacts.
///
/// # Errors
/// As [`parse`]; stopped by the monitor.
pub fn parse_with(
    text: &str,
    name: &str,
    directory: &Path,
    overrides: &[String],
    monitor: &mut dyn Monitor,
) -> Result<Input, Box<Diagnostic>> {
    let mut document = Document::parse(name, text)?;
    for argument in overrides {
        overrides::apply(&mut document, argument)?;
    }
    checked(read_document(document, Some(directory))?, monitor)
}

/// Reads a scenario from a text that holds all of it: keys that name files are refused.
///
/// # Errors
/// As [`parse`]; a key that names a file.
pub fn parse_complete(text: &str, name: &str) -> Result<Input, Box<Diagnostic>> {
    checked(read_complete(text, name)?, &mut ())
}

/// The same without a check of the values, for which there is [`Input::check`].
///
/// # Errors
/// A text that is no scenario; a key that names a file.
pub fn read_complete(text: &str, name: &str) -> Result<Input, Box<Diagnostic>> {
    read_document(Document::parse(name, text)?, None)
}

/// A text that holds all of a scenario: the given one, or where that names files, one with their tables and every value.
///
/// # Errors
/// As [`parse`].
pub fn complete(text: &str, name: &str, directory: &Path) -> Result<String, Box<Diagnostic>> {
    let input = parse(text, name, directory, &[])?;
    let names_files = parse_complete(text, name).is_err();
    Ok(if names_files { to_text(&input.scenario) } else { text.to_owned() })
}

/// What was read, if its values are valid.
fn checked(mut input: Input, monitor: &mut dyn Monitor) -> Result<Input, Box<Diagnostic>> {
    match input.check(monitor) {
        Ok(()) => Ok(input),
        Err(error) => Err(input.diagnose(&error)),
    }
}

/// The scenario that a document describes, with its tables inlined.
fn read_document(document: Document, directory: Option<&Path>) -> Result<Input, Box<Diagnostic>> {
    let scenario = Scenario::deserialize(Reader(&document.root)).map_err(|fault| document.draw(fault))?;
    let mut input =
        Input { scenario, warnings: Vec::new(), document, directory: directory.map(Path::to_owned) };
    tables::inline(&mut input.scenario, directory).map_err(|fault| input.document.draw(fault))?;
    Ok(input)
}

impl Input {
    /// Checks the values of the scenario, and keeps the warnings about them.
    ///
    /// # Errors
    /// An invalid value; stopped by the monitor.
    pub fn check(&mut self, monitor: &mut dyn Monitor) -> asperity::Result<()> {
        self.warnings = self.scenario.build_with(monitor)?.warnings;
        Ok(())
    }

    /// The diagnostic for an error of the core.
    pub fn diagnose(&self, error: &asperity::Error) -> Box<Diagnostic> {
        self.document.draw(match error {
            asperity::Error::Invalid { key, expected, found } => {
                Fault::among_names(expected, found).under(key)
            }
            asperity::Error::TooLarge { key, what, needed, allowed } => {
                let found = format!("{what}: {} or more", memory::words(*needed));
                let expected =
                    format!("what fits in the {} of memory that is allowed", memory::words(*allowed));
                Fault::new(&expected, &found).under(key)
            }
            asperity::Error::Accuracy { key, what, reached, wanted } if !key.is_empty() => {
                // Rounded up to two digits, so that the suggested tolerance is above the error that was reached.
                let enough = 1.05 * reached.0;
                let expected = if enough.is_finite() {
                    format!("{enough:.1e} or more, which {what} reaches, or no tolerance")
                } else {
                    format!("a larger one, to which {what} can be computed, or no tolerance")
                };
                Fault::new(&expected, &format!("{wanted:e}")).under(key)
            }
            other => Fault::new("a scenario that can be computed", &other.to_string()),
        })
    }
}

/// The beginning of a text, for messages.
fn short(text: &str) -> String {
    const MOST: usize = 80;
    let mut letters = text.chars();
    let begin: String = letters.by_ref().take(MOST).collect();
    let rest = letters.count();
    if rest == 0 { begin } else { format!("{begin}… ({rest} more letters)") }
}

/// Reads a value from a fixed set of words, such as `quenched`.
///
/// # Errors
/// A word that is not in the set.
pub fn word<T: DeserializeOwned>(key: &str, word: &str) -> asperity::Result<T> {
    let refused = |fault: Fault| asperity::Error::invalid(key, fault.expected, fault.found);
    T::deserialize(Reader(&Node::from(word))).map_err(refused)
}

/// How the pictures of a scenario are drawn, from its text as [`to_text`] writes it.
pub fn figure(text: &str) -> Figure {
    #[derive(Default, Deserialize)]
    struct Drawn {
        #[serde(default)]
        figure: Figure,
    }
    toml::from_str::<Drawn>(text).unwrap_or_default().figure
}

/// The edges of the interface of a scenario, from its text as [`to_text`] writes it; open without one.
pub fn edges(text: &str) -> Edges {
    #[derive(Default, Deserialize)]
    struct Cells {
        #[serde(default)]
        edges: Edges,
    }
    #[derive(Default, Deserialize)]
    struct Coupled {
        #[serde(default)]
        interface: Cells,
    }
    toml::from_str::<Coupled>(text).unwrap_or_default().interface.edges
}

/// A scenario as TOML with every value written out. Reading it gives the same scenario.
pub fn to_text(scenario: &Scenario) -> String {
    let Some(sweep) = &scenario.sweep else { return text_of(scenario) };
    text_of(&Scenario { sweep: None, ..scenario.clone() }) + &sweep_text(sweep)
}

fn text_of(value: &impl Serialize) -> String {
    toml::to_string(value).expect("every scenario can be written as TOML")
}

/// The table `[sweep]`, with each axis on one line: TOML writes tables behind other values, and the order of axes would be lost.
fn sweep_text(sweep: &Sweep) -> String {
    let own = Sweep { over: SweepAxes::default(), ..sweep.clone() };
    let inline = |value: &SweepAxis| toml::Value::try_from(value).expect("an axis can be written as TOML");
    let axis = |(key, axis): &(String, SweepAxis)| {
        format!("{} = {}\n", toml::Value::from(key.as_str()), inline(axis))
    };
    let entries = toml::Table::try_from(&own).expect("a sweep can be written as TOML");
    let entries: String = entries.iter().map(|(key, value)| format!("{key} = {value}\n")).collect();
    format!("\n[sweep]\n{entries}\n[sweep.over]\n{}", sweep.over.0.iter().map(axis).collect::<String>())
}
