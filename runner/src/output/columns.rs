//! Columns of results that outgrow the memory, in files beside the folder of results.

use std::io;
use std::path::{Path, PathBuf};

use asperity::record::Variable;
use asperity::task::ColumnStore;
use asperity::{Error, Result};

use crate::folder::{self, Made};
use crate::numbers::NumbersInFile;

use super::error;

/// Columns of results in files.
#[derive(Debug)]
pub struct StoredColumns {
    /// The folder of results.
    directory: PathBuf,
    in_memory: u64,
    columns: Vec<StoredColumn>,
    failure: Option<error::Error>,
    /// Dropped last, after the files.
    folders: Option<Made>,
}

/// One of them.
#[derive(Debug)]
pub struct StoredColumn {
    /// What it is, without its values.
    pub variable: Variable,
    /// Its values.
    pub values: NumbersInFile,
}

impl StoredColumns {
    /// None yet. They are put into files beside `directory` once they take more than `in_memory` bytes.
    pub fn beside(directory: &Path, in_memory: u64) -> Self {
        Self { directory: directory.to_owned(), in_memory, columns: Vec::new(), failure: None, folders: None }
    }

    /// All of them, in the order of their names: which come first depends on where a run was interrupted.
    pub fn columns(&self) -> &[StoredColumn] {
        &self.columns
    }

    /// Bytes that all of them take.
    pub fn bytes(&self) -> u64 {
        self.columns.iter().map(|column| (column.values.count() * size_of::<f64>()) as u64).sum()
    }

    /// The error that stopped the computation, if a column could not be stored or read.
    pub fn failure(&mut self) -> Option<error::Error> {
        self.failure.take()
    }

    fn failed(&mut self, action: &'static str, source: io::Error) -> Error {
        let path = folder::above(&self.directory).to_owned();
        self.failure = Some(error::Error::System { path, action, source });
        Error::Stopped
    }

    /// The file of a variable, which is created with its first values.
    fn column(&mut self, variable: &Variable) -> io::Result<&mut StoredColumn> {
        if self.folders.is_none() {
            self.folders = Some(Made::above(&self.directory)?);
        }
        let place = match self.columns.binary_search_by(|column| column.variable.name.cmp(&variable.name)) {
            Ok(place) => place,
            Err(place) => {
                let values = NumbersInFile::within(folder::above(&self.directory))?;
                let variable = Variable {
                    name: variable.name.clone(),
                    long_name: variable.long_name.clone(),
                    quantity: variable.quantity,
                    dimensions: variable.dimensions.clone(),
                    values: Vec::new(),
                };
                self.columns.insert(place, StoredColumn { variable, values });
                place
            }
        };
        Ok(&mut self.columns[place])
    }
}

impl ColumnStore for StoredColumns {
    fn in_memory(&self) -> u64 {
        self.in_memory
    }

    fn append(&mut self, variable: &Variable) -> Result<()> {
        let stored = self.column(variable).and_then(|column| column.values.append(&variable.values));
        stored.map_err(|error| self.failed("write a column of the results beside it, in", error))
    }

    fn values(&mut self, name: &str) -> Result<Vec<f64>> {
        let Some(column) = self.columns.iter().find(|column| column.variable.name == name) else {
            return Ok(Vec::new());
        };
        column
            .values
            .read(0, usize::MAX)
            .map_err(|error| self.failed("read a column of the results in", error))
    }
}
