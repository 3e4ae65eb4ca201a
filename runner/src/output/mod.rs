//! Writing of results: one folder, written under a temporary name and then moved into place.

mod attributes;
mod columns;
mod csv;
mod directory;
mod drawn;
mod error;
mod fitted;
mod hdf5;
mod listing;
mod netcdf;
mod posterior;
mod read;
mod schema_line;
mod view;

use std::io;
use std::path::Path;

use asperity::record::Record;
use asperity::task::summary::Summary;

use view::Variables;

pub use attributes::{Attribute, FORMAT, attributes, common};
pub use columns::StoredColumns;
pub use csv::shortest;
pub(crate) use directory::NewFile;
pub use directory::{Renamed, check};
pub use drawn::drawn;
pub use error::{Error, Result};
pub(crate) use hdf5::{Array, Values as Place, place};
pub(crate) use netcdf::{text, write_numbers};
pub(crate) use read::{open, text as text_of};
pub use read::{read, read_drawn};
pub(crate) use schema_line::{scenario_file, without_schema};

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

/// Which files of results are written. The scenario is always among them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Only {
    /// `result.nc`, and `posterior.nc`.
    pub netcdf: bool,
    /// Tables.
    pub csv: bool,
    /// The summary.
    pub json: bool,
}

impl Only {
    /// All files.
    pub const ALL: Self = Self { netcdf: true, csv: true, json: true };
}

/// Writes `outcome` and `attachments` as the folder `dir`.
///
/// The files are written to a hidden folder next to `dir`, which then takes its place. After any error
/// `dir` is unchanged, and nothing is left next to it. An existing folder is replaced only if it is empty or
/// holds the file `.asperity`, which lists what asperity wrote. Other files in it, and results changed since,
/// are kept; those that were changed, or have the name of a result, are renamed and returned.
///
/// # Errors
/// `dir` was not made by asperity or cannot be written.
pub fn write(dir: &Path, outcome: &Outcome, attachments: &[Attachment]) -> Result<Written> {
    write_only(dir, (outcome, None), attachments, Only::ALL)
}

/// The same of an outcome some of whose columns are `stored`, and of these files alone.
///
/// # Errors
/// As [`write()`].
pub fn write_only(
    dir: &Path,
    (outcome, stored): (&Outcome, Option<&StoredColumns>),
    attachments: &[Attachment],
    only: Only,
) -> Result<Written> {
    /// Bytes of results whose files are written at the same time. To start a thread takes as long as to write some 50 kB of a table.
    const LARGE: u64 = 1 << 20;
    let variables = Variables { record: &outcome.record, stored };
    let large = variables.bytes() > LARGE;
    let mut files = vec![scenario_file(dir, "scenario.toml", &outcome.scenario)];
    if only.json {
        files.push(NewFile::of("summary.json", json(&outcome.summary)));
        files.extend(outcome.summary.numbers.fit().map(|fit| NewFile::of("fit.json", json(fit))));
    }
    if only.csv {
        files.extend(csv::tables(variables).map(|table| NewFile {
            name: table.file.to_owned(),
            write: Box::new(move |to| table.write(to)),
            large,
        }));
    }
    files.extend(fitted::fitted(outcome).iter().map(|(name, text)| scenario_file(dir, name, text)));
    if only.netcdf {
        let write = move |to: &mut dyn io::Write| {
            netcdf::assemble(outcome, variables).map_err(io::Error::other)?.write(to)
        };
        files.push(NewFile { name: "result.nc".to_owned(), write: Box::new(write), large });
        files.extend(posterior::encode(outcome)?.map(|bytes| NewFile::of("posterior.nc", bytes)));
    }
    write_files(dir, files, attachments)
}

/// Makes `files` and `attachments` the folder `dir`, as [`write`] does.
pub(crate) fn write_files<'a>(
    dir: &Path,
    mut files: Vec<NewFile<'a>>,
    attachments: &'a [Attachment],
) -> Result<Written> {
    let results = files.iter().map(|file| file.name.clone()).collect();
    files.extend(attachments.iter().map(|a| NewFile::of(a.name.as_str(), a.bytes.as_slice())));
    let renamed = directory::replace(dir, &files)?;
    let attached = attachments.iter().map(|attachment| attachment.name.clone()).collect();
    Ok(Written { results, attached, renamed })
}

/// Writes `attachments` into the folder of results `dir`, in place of those with the same names; all other files stay. A
/// file that asperity did not write, or that was changed since, is renamed.
///
/// # Errors
/// `dir` was not made by asperity or cannot be written.
pub fn attach(dir: &Path, attachments: &[Attachment]) -> Result<Vec<Renamed>> {
    let files = attachments.iter().map(|a| NewFile::of(a.name.as_str(), a.bytes.as_slice()));
    directory::add(dir, &files.collect::<Vec<_>>())
}

fn json(plain: &impl serde::Serialize) -> Vec<u8> {
    let mut text = serde_json::to_vec_pretty(plain).expect("a summary is plain data");
    text.push(b'\n');
    text
}
