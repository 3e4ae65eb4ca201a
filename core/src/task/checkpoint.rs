//! What keeps the state of a long drive, so that it can go on later.

use crate::{Error, Result};

/// Where a drive keeps its state and the columns that it has recorded; a file mostly.
pub trait Checkpoints {
    /// Number of events that may pass before the next checkpoint is due, `since` of them having passed since the last one.
    fn events_left(&self, since: u64) -> u64;

    /// The checkpoint to go on from; `None` where the run begins at its start. A second call returns `None`.
    fn take(&mut self) -> Option<Checkpoint>;

    /// Keeps the state after `events` events, and the rows that every column has got since the last checkpoint.
    ///
    /// # Errors
    /// The state cannot be kept: [`Error::Stopped`].
    fn keep(&mut self, events: u64, state: Vec<u8>, rows: Vec<Vec<f64>>) -> Result<()>;

    /// The error of a run whose checkpoint cannot be read, for the reason `what`: [`Error::Stopped`].
    fn damaged(&mut self, what: String) -> Error;
}

/// A state that was kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// The state, in CBOR (RFC 8949).
    pub state: Vec<u8>,
    /// All columns recorded up to there.
    pub columns: Vec<Vec<f64>>,
}
