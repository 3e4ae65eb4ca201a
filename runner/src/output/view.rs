//! The variables of a result, wherever their values are: in memory or in files.

use std::borrow::Cow;
use std::io;

use asperity::record::{Record, Variable};

use super::columns::{StoredColumn, StoredColumns};

/// The variables of a result.
#[derive(Debug, Clone, Copy)]
pub struct Variables<'a> {
    /// Those in memory.
    pub record: &'a Record,
    /// The others.
    pub stored: Option<&'a StoredColumns>,
}

/// One of them.
#[derive(Debug, Clone, Copy)]
pub enum View<'a> {
    /// In memory.
    Kept(&'a Variable),
    /// In a file.
    Stored(&'a StoredColumn),
}

impl<'a> Variables<'a> {
    /// All variables.
    pub fn all(self) -> impl Iterator<Item = View<'a>> {
        let stored = self.stored.map_or(&[][..], StoredColumns::columns);
        stored.iter().map(View::Stored).chain(self.record.variables.iter().map(View::Kept))
    }

    /// Bytes that all of them take.
    pub fn bytes(self) -> u64 {
        self.record.bytes() + self.stored.map_or(0, StoredColumns::bytes)
    }

    /// The variable called `name`.
    pub fn get(self, name: &str) -> Option<View<'a>> {
        self.all().find(|view| view.variable().name == name)
    }

    /// The length of a dimension, from the first variable along it alone.
    pub fn length(self, dimension: &str) -> usize {
        let along = self.all().find(|view| view.variable().dimensions == [dimension]);
        along.map_or(0, View::len)
    }

    /// The dimensions and their lengths, in the order of first use.
    pub fn dimensions(self) -> Vec<(&'a str, usize)> {
        let mut found: Vec<(&str, usize)> = Vec::new();
        for name in self.all().flat_map(|view| &view.variable().dimensions) {
            if !found.iter().any(|(known, _)| known == name) {
                found.push((name, self.length(name)));
            }
        }
        found
    }
}

impl<'a> View<'a> {
    /// What it is; its values are elsewhere if it is stored.
    pub fn variable(self) -> &'a Variable {
        match self {
            Self::Kept(variable) => variable,
            Self::Stored(column) => &column.variable,
        }
    }

    /// Number of values.
    pub fn len(self) -> usize {
        match self {
            Self::Kept(variable) => variable.values.len(),
            Self::Stored(column) => column.values.count(),
        }
    }

    /// Values from an index on, at most `count`.
    ///
    /// # Errors
    /// The system refuses to read a file.
    pub fn read(self, from: usize, count: usize) -> io::Result<Cow<'a, [f64]>> {
        match self {
            Self::Kept(variable) => {
                let end = from.saturating_add(count).min(variable.values.len());
                Ok(Cow::Borrowed(&variable.values[from.min(end)..end]))
            }
            Self::Stored(column) => column.values.read(from, count).map(Cow::Owned),
        }
    }
}
