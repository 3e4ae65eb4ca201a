//! Checkpoints of a long drive, from which it can be resumed.

use std::io::{self, Write};

use serde::Serialize;

use crate::{Error, Result, cbor};

/// Writes the state of a drive, in CBOR (RFC 8949).
pub type WriteState<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

/// Writes a value in CBOR (RFC 8949).
///
/// # Errors
/// Those of `out`; a build without the feature `checkpoints`.
pub fn write_cbor<T: Serialize + ?Sized>(value: &T, out: &mut dyn Write) -> io::Result<()> {
    cbor::write(value, out)
}

/// Storage for the state of a drive and its recorded columns, usually a file.
pub trait Checkpoints {
    /// Number of events left until the next checkpoint is due, `since` events after the last one.
    fn events_left(&self, since: u64) -> u64;

    /// Passes on the rows of every column recorded up to the checkpoint to resume from, a piece at a time, and returns its
    /// state, in CBOR (RFC 8949); `None` if the run begins at its start.
    ///
    /// # Errors
    /// That of `rows`; [`Error::Stopped`] if they cannot be read.
    fn take(&mut self, rows: &mut dyn FnMut(Vec<Vec<f64>>) -> Result<()>) -> Result<Option<Vec<u8>>>;

    /// Stores the state after `events` events, which may take gigabytes and so is written piece by piece, and the rows added
    /// to every column since the last checkpoint.
    ///
    /// # Errors
    /// [`Error::Stopped`] if the state cannot be stored, or if storing it was given up because the run is to end.
    fn keep(&mut self, events: u64, state: &WriteState<'_>, rows: Vec<Vec<f64>>) -> Result<()>;

    /// The error of a run whose checkpoint cannot be read, for the reason `what`: [`Error::Stopped`].
    fn damaged(&mut self, what: String) -> Error;
}
