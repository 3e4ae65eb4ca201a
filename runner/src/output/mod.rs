//! What a run leaves on disk: one folder, written beside and then put in place whole.

mod csv;
mod directory;
mod error;
mod listing;
mod netcdf;
mod read;

use std::path::Path;

use asperity::record::Record;
use asperity::task::summary::Summary;

pub use csv::shortest;
pub use directory::{Renamed, check};
pub use error::{Error, Result};
pub use netcdf::check_size;
pub use read::read;

/// A finished run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The resolved scenario, as TOML.
    pub scenario: String,
    /// The summary.
    pub summary: Summary,
    /// Everything computed.
    pub record: Record,
}

/// A file beside the results, pictures mostly.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Its name in the folder.
    pub name: String,
    /// What is in it.
    pub bytes: Vec<u8>,
}

/// Writes `outcome` and `attachments` as the folder `dir`.
///
/// The files are written to a hidden folder beside `dir`, which then takes its place. Whatever goes
/// wrong, `dir` is as it was and nothing is left beside it. A folder in the way is replaced only if
/// it holds the file `.asperity`, which lists what asperity wrote. Other files there, and those that were
/// changed since, stay; those that are in the way of results get another name, and are returned.
///
/// # Errors
/// `dir` is not asperity's, cannot be written, or the results are too large for one file.
pub fn write(dir: &Path, outcome: &Outcome, attachments: &[Attachment]) -> Result<Vec<Renamed>> {
    let mut files = vec![
        ("scenario.toml".to_owned(), outcome.scenario.clone().into_bytes()),
        ("summary.json".to_owned(), json(&outcome.summary)),
    ];
    files.extend(csv::tables(&outcome.record).map(|(name, text)| (name.to_owned(), text.into_bytes())));
    files.push(("result.nc".to_owned(), netcdf::encode(outcome)?));
    let borrowed = files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    let attached = attachments.iter().map(|a| (a.name.as_str(), a.bytes.as_slice()));
    directory::replace(dir, borrowed.chain(attached))
}

fn json(summary: &Summary) -> Vec<u8> {
    let mut text = serde_json::to_vec_pretty(summary).expect("a summary is plain data");
    text.push(b'\n');
    text
}
