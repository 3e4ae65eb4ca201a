//! The cases of a scenario with `[sweep]`: values of axes are put under their keys, and faults are drawn where the axis has them.

use std::path::PathBuf;

use asperity::scenario::Scenario;

use super::document::{Document, Kind, Node};
use super::fault::Fault;
use super::{Diagnostic, Input, overrides, read_document, short};

/// A value of a key in a case.
#[derive(Debug, Clone, Copy)]
pub struct Choice<'a> {
    /// The key.
    pub key: &'a str,
    /// The index of the value in the list of the axis.
    pub index: usize,
    /// The value, if it is a number: axes may be ranges.
    pub number: Option<f64>,
}

/// What is needed to make the scenario of a case.
#[derive(Debug)]
pub struct Cases {
    /// The document without its table `[sweep]`.
    document: Document,
    directory: Option<PathBuf>,
    /// The values of keys, as the table has them.
    axes: Vec<(String, Node)>,
    /// The number of replicas.
    repeat: Option<Node>,
}

impl Cases {
    /// The cases of a scenario with `[sweep]`.
    pub fn new(input: &Input) -> Self {
        let mut document = input.document.clone();
        let Kind::Table(entries) = &mut document.root.kind else { unreachable!("a document is a table") };
        let place = entries.iter().position(|(key, _)| key == "sweep");
        let table = place.map(|place| entries.remove(place).1);
        let part = |name: &str| table.as_ref().and_then(|table| table.child(name)).cloned();
        let axes = match part("over").map(|over| over.kind) {
            Some(Kind::Table(axes)) => axes,
            _ => Vec::new(),
        };
        Self { document, directory: input.directory.clone(), axes, repeat: part("repeat") }
    }

    /// The scenario of a case, with seeds of its own. Its values are not checked.
    ///
    /// # Errors
    /// Values of the wrong type, unknown keys, keys that exclude one another, files that cannot be read.
    pub fn scenario(
        &self,
        choices: &[Choice<'_>],
        seeds: &[(&str, u64)],
    ) -> Result<Scenario, Box<Diagnostic>> {
        self.read(choices, seeds).map(|input| input.scenario)
    }

    /// The same, and every value is checked.
    ///
    /// # Errors
    /// As [`Self::scenario`]; invalid values.
    pub fn check(&self, choices: &[Choice<'_>], seeds: &[(&str, u64)]) -> Result<Scenario, Box<Diagnostic>> {
        let input = self.read(choices, seeds)?;
        match input.scenario.build() {
            Ok(_) => Ok(input.scenario),
            Err(error) => Err(self.reported(*input.diagnose(&error), choices)),
        }
    }

    fn read(&self, choices: &[Choice<'_>], seeds: &[(&str, u64)]) -> Result<Input, Box<Diagnostic>> {
        let mut document = self.document.clone();
        let put = |document: &mut Document, key: &str, node: Node| {
            overrides::put(&mut document.root, key, node).map_err(|fault| document.draw(fault))
        };
        for choice in choices {
            put(&mut document, choice.key, self.node(choice))?;
        }
        for &(key, seed) in seeds {
            let place = self.repeat.clone().unwrap_or_else(|| self.document.root.clone());
            put(&mut document, key, Node { kind: Kind::Integer(seed.cast_signed()), ..place })?;
        }
        for Choice { key, .. } in choices {
            if !holds(&document.root, key) {
                let fault =
                    Fault::new("keys that do not exclude one another", "a key that another one replaces");
                let fault = fault.under(&format!("sweep.over.{key}"));
                return Err(document.diagnose(&fault, self.axis(key).key.clone(), &[]));
            }
        }
        read_document(document, self.directory.as_deref())
            .map_err(|diagnostic| self.reported(*diagnostic, choices))
    }

    /// The values of a key, as the table has them.
    fn axis(&self, key: &str) -> &Node {
        self.axes.iter().find(|(other, _)| other == key).map(|(_, axis)| axis).expect("a key of an axis")
    }

    /// The value of a key, at its place in the text.
    fn node(&self, choice: &Choice<'_>) -> Node {
        let axis = self.axis(choice.key);
        match (&axis.kind, choice.number) {
            (Kind::List(items), _) => Node { key: axis.key.clone(), ..items[choice.index].clone() },
            (_, number) => Node { kind: Kind::Float(number.unwrap_or(f64::NAN)), ..axis.clone() },
        }
    }

    /// The diagnostic with the values of the other keys as its hint.
    fn reported(&self, diagnostic: Diagnostic, choices: &[Choice<'_>]) -> Box<Diagnostic> {
        let value = |choice: &Choice<'_>| format!("{} = {}", choice.key, self.node(choice).kind.describe());
        let values: Vec<_> = choices.iter().map(value).collect();
        let help = (!values.is_empty()).then(|| format!("in the case {}", short(&values.join(", "))));
        Box::new(Diagnostic { help: diagnostic.help.clone().or(help), ..diagnostic })
    }
}

/// Whether there is a value under a dotted key.
fn holds(root: &Node, key: &str) -> bool {
    key.split('.').try_fold(root, |node, name| node.child(name)).is_some()
}
