//! Writing of results: one folder, written under a temporary name and then moved into place.

mod attributes;
mod csv;
mod directory;
mod error;
mod fitted;
mod listing;
mod netcdf;
mod posterior;
mod read;

use std::path::Path;

use asperity::record::Record;
use asperity::task::summary::Summary;

pub use attributes::{Attribute, attributes, common};
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

/// A file in addition to the results, such as a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Name in the folder.
    pub name: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

/// What was written into a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The names of the files with results.
    pub results: Vec<String>,
    /// The names of the other files, such as pictures.
    pub attached: Vec<String>,
    /// Files of others that were renamed.
    pub renamed: Vec<Renamed>,
}

/// Writes `outcome` and `attachments` as the folder `dir`.
///
/// The files are written to a hidden folder next to `dir`, which then takes its place. After any error
/// `dir` is unchanged, and nothing is left next to it. An existing folder is replaced only if
/// it holds the file `.asperity`, which lists what asperity wrote. Other files in it, and files changed
/// since, are kept; those with the name of a result are renamed and returned.
///
/// # Errors
/// `dir` was not made by asperity or cannot be written; the results are too large for one file.
pub fn write(dir: &Path, outcome: &Outcome, attachments: &[Attachment]) -> Result<Written> {
    let mut files = vec![
        ("scenario.toml".to_owned(), outcome.scenario.clone().into_bytes()),
        ("summary.json".to_owned(), json(&outcome.summary)),
    ];
    files.extend(csv::tables(&outcome.record).map(|(name, text)| (name.to_owned(), text.into_bytes())));
    files.extend(fitted::fitted(outcome).into_iter().map(|(name, text)| (name, text.into_bytes())));
    files.push(("result.nc".to_owned(), netcdf::encode(outcome)?));
    files.extend(posterior::encode(outcome)?.map(|bytes| ("posterior.nc".to_owned(), bytes)));
    write_files(dir, files, attachments)
}

/// Makes `files` (names and contents) and `attachments` the folder `dir`, as [`write`] does.
pub(crate) fn write_files(
    dir: &Path,
    files: Vec<(String, Vec<u8>)>,
    attachments: &[Attachment],
) -> Result<Written> {
    let borrowed = files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
    let attached = attachments.iter().map(|a| (a.name.as_str(), a.bytes.as_slice()));
    let renamed = directory::replace(dir, borrowed.chain(attached))?;
    let attached = attachments.iter().map(|attachment| attachment.name.clone()).collect();
    Ok(Written { results: files.into_iter().map(|(name, _)| name).collect(), attached, renamed })
}

/// Writes `attachments` into the folder of results `dir`, in place of those with the same names; all other files stay. A
/// file that asperity did not write, or that was changed since, is renamed.
///
/// # Errors
/// `dir` was not made by asperity or cannot be written.
pub fn attach(dir: &Path, attachments: &[Attachment]) -> Result<Vec<Renamed>> {
    directory::add(dir, attachments.iter().map(|a| (a.name.as_str(), a.bytes.as_slice())))
}

fn json(summary: &Summary) -> Vec<u8> {
    let mut text = serde_json::to_vec_pretty(summary).expect("a summary is plain data");
    text.push(b'\n');
    text
}
