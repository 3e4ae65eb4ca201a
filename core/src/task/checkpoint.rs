//! Checkpoints of a long drive, from which it can be resumed.

use crate::{Error, Result};

/// Storage for the state of a drive and its recorded columns, usually a file.
pub trait Checkpoints {
    /// Number of events left until the next checkpoint is due, `since` events after the last one.
    fn events_left(&self, since: u64) -> u64;

    /// The checkpoint to resume from; `None` if the run begins at its start. A second call returns `None`.
    fn take(&mut self) -> Option<Checkpoint>;

    /// Stores the state after `events` events, and the rows added to every column since the last checkpoint.
    ///
    /// # Errors
    /// [`Error::Stopped`] if the state cannot be stored.
    fn keep(&mut self, events: u64, state: Vec<u8>, rows: Vec<Vec<f64>>) -> Result<()>;

    /// The error of a run whose checkpoint cannot be read, for the reason `what`: [`Error::Stopped`].
    fn damaged(&mut self, what: String) -> Error;
}

/// A stored state.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// The state, in CBOR (RFC 8949).
    pub state: Vec<u8>,
    /// All columns recorded up to that state.
    pub columns: Vec<Vec<f64>>,
}
