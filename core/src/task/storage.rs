//! Where long computations put what does not stay in memory: checkpoints, and columns that grow.

use crate::Result;
use crate::record::Variable;

use super::Checkpoints;

/// Storage for the columns of a computation that outgrow the memory, usually files.
pub trait ColumnStore {
    /// Bytes of columns that may be kept in memory.
    fn in_memory(&self) -> u64;

    /// Appends the values of `variable` to those stored under its name.
    ///
    /// # Errors
    /// [`Error::Stopped`](crate::Error::Stopped) if they cannot be stored.
    fn append(&mut self, variable: &Variable) -> Result<()>;

    /// All values stored under a name; none if there are none.
    ///
    /// # Errors
    /// [`Error::Stopped`](crate::Error::Stopped) if they cannot be read.
    fn values(&mut self, name: &str) -> Result<Vec<f64>>;
}

/// The storage of a computation. Only `[drive]` and `[[protocol]]` of an `[interface]` use it.
#[derive(Default)]
pub struct Storage<'a> {
    /// Checkpoints, if any are kept.
    pub checkpoints: Option<&'a mut dyn Checkpoints>,
    /// Storage for columns; without it they stay in memory.
    pub columns: Option<&'a mut dyn ColumnStore>,
}

impl Storage<'_> {
    /// The same storage, for as long as it is borrowed.
    pub(super) fn borrowed(&mut self) -> Storage<'_> {
        Storage {
            checkpoints: self.checkpoints.as_mut().map(|kept| &mut **kept as &mut dyn Checkpoints),
            columns: self.columns.as_mut().map(|store| &mut **store as &mut dyn ColumnStore),
        }
    }
}

impl std::fmt::Debug for Storage<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (checkpoints, columns) = (self.checkpoints.is_some(), self.columns.is_some());
        f.debug_struct("Storage").field("checkpoints", &checkpoints).field("columns", &columns).finish()
    }
}
