//! The folder of a finished sweep: the scenario, a summary, a table and `sweep.nc`.

use std::path::Path;

use serde::Serialize;

use super::dataset::{Dataset, Labelled, Values};
use super::error::Result;
use super::{netcdf, table};
use crate::output::{self, Attachment, NewFile, Written};

/// What a sweep has found, in `summary.json` and on the terminal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The title of the scenario.
    pub title: String,
    /// The version of asperity that ran it.
    pub version: String,
    /// The hash of all that determines the results.
    pub sweep: String,
    /// Number of cases.
    pub cases: usize,
    /// Number of cases that failed.
    pub failed: usize,
    /// The axes.
    pub axes: Vec<AxisReport>,
    /// What was kept.
    pub kept: Vec<KeptReport>,
}

/// An axis of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AxisReport {
    /// Its keys.
    pub keys: Vec<String>,
    /// Its number of values.
    pub values: usize,
    /// The smallest and the largest value of the first key; absent if they are no numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
}

/// What was kept under one name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KeptReport {
    /// The name.
    pub name: String,
    /// Label of the unit; empty where it is not known.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub units: String,
    /// The smallest and the largest finite number; absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
    /// Each word, and of how many cases it is.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub words: Vec<(String, usize)>,
}

impl Report {
    /// The report of a data set.
    pub fn new(dataset: &Dataset) -> Self {
        let axes = dataset.axes.iter().map(|axis| AxisReport {
            keys: axis.coordinates.iter().map(|coordinate| coordinate.key.clone()).collect(),
            values: axis.length,
            range: range(&axis.coordinates[0].values),
        });
        Self {
            title: dataset.title.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            sweep: dataset.hash.clone(),
            cases: dataset.cases(),
            failed: dataset.failed,
            axes: axes.collect(),
            kept: dataset.variables.iter().map(KeptReport::new).collect(),
        }
    }
}

impl KeptReport {
    fn new(variable: &Labelled) -> Self {
        let mut words: Vec<(String, usize)> = Vec::new();
        if let Values::Texts(texts) = &variable.values {
            for text in texts.iter().filter(|text| !text.is_empty()) {
                match words.iter_mut().find(|(word, _)| word == text) {
                    Some((_, count)) => *count += 1,
                    None => words.push((text.clone(), 1)),
                }
            }
        }
        let (name, units) = (variable.name.clone(), variable.units.clone());
        Self { name, units, range: range(&variable.values), words }
    }
}

/// The smallest and the largest finite number.
fn range(values: &Values) -> Option<[f64; 2]> {
    let Values::Numbers(numbers) = values else { return None };
    let finite = numbers.iter().copied().filter(|number| number.is_finite());
    finite.fold(None, |range, number| match range {
        None => Some([number, number]),
        Some([low, high]) => Some([number.min(low), number.max(high)]),
    })
}

/// Writes a sweep and its pictures as the folder `dir`, as [`output::write`] writes a run.
///
/// # Errors
/// `dir` was not made by asperity or cannot be written; results too large for one file.
pub fn write(dir: &Path, dataset: &Dataset, attachments: &[Attachment]) -> Result<Written> {
    let mut summary = serde_json::to_vec_pretty(&Report::new(dataset)).expect("a report is plain data");
    summary.push(b'\n');
    let files = vec![
        NewFile::of("scenario.toml", dataset.scenario.as_bytes()),
        NewFile::of("summary.json", summary),
        NewFile::of("sweep.csv", table::csv(dataset)),
        NewFile::of("sweep.nc", netcdf::encode(dataset)?),
    ];
    Ok(output::write_files(dir, files, attachments)?)
}
