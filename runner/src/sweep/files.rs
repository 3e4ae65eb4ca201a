//! The folder of a finished sweep: the scenario, a summary, a table and `sweep.nc`.

use std::collections::HashMap;
use std::io;
use std::path::Path;

use serde::Serialize;

use super::dataset::{Axis, Dataset, Labelled, Values};
use super::error::Result;
use super::{netcdf, table};
use crate::output::{self, Attachment, NewFile, Written, scenario_file};

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
    ///
    /// # Errors
    /// The system refuses to read curves.
    pub fn new(dataset: &Dataset) -> io::Result<Self> {
        Ok(Self {
            title: dataset.title.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            sweep: dataset.hash.clone(),
            cases: dataset.cases(),
            failed: dataset.failed,
            axes: dataset.axes.iter().map(AxisReport::new).collect(),
            kept: dataset.variables.iter().map(KeptReport::new).collect::<io::Result<_>>()?,
        })
    }
}

impl AxisReport {
    /// The report of an axis.
    pub fn new(axis: &Axis) -> Self {
        Self {
            keys: axis.coordinates.iter().map(|coordinate| coordinate.key.clone()).collect(),
            values: axis.length,
            range: match &axis.coordinates[0].values {
                Values::Numbers(numbers) => range(numbers),
                _ => None,
            },
        }
    }
}

impl KeptReport {
    /// Numbers that are read at once.
    const PIECE: usize = 1 << 16;

    fn new(variable: &Labelled) -> io::Result<Self> {
        let (mut words, mut places) = (Vec::<(String, usize)>::new(), HashMap::new());
        if let Values::Texts(texts) = &variable.values {
            for text in texts.iter().filter(|text| !text.is_empty()) {
                let place = *places.entry(text.as_str()).or_insert(words.len());
                match words.get_mut(place) {
                    Some((_, count)) => *count += 1,
                    None => words.push((text.clone(), 1)),
                }
            }
        }
        let (name, units) = (variable.name.clone(), variable.units.clone());
        let mut found = None;
        for from in (0..variable.values.count()).step_by(Self::PIECE) {
            found = joined(found, range(&variable.values.read(from, Self::PIECE)?));
        }
        Ok(Self { name, units, range: found, words })
    }
}

/// The smallest and the largest finite number.
fn range(numbers: &[f64]) -> Option<[f64; 2]> {
    let finite = numbers.iter().filter(|number| number.is_finite());
    finite.fold(None, |found, &number| joined(found, Some([number, number])))
}

/// The range of two ranges.
fn joined(one: Option<[f64; 2]>, other: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let both = one.zip(other).map(|([a, b], [c, d])| [a.min(c), b.max(d)]);
    both.or(one).or(other)
}

/// Writes a sweep and its pictures as the folder `dir`, as [`output::write`] writes a run.
///
/// # Errors
/// `dir` was not made by asperity or cannot be written; results too large for one file.
pub fn write(dir: &Path, dataset: &Dataset, attachments: &[Attachment]) -> Result<Written> {
    let unread =
        |source| output::Error::System { path: dir.to_owned(), action: "read curves beside", source };
    let report = Report::new(dataset).map_err(unread)?;
    let mut summary = serde_json::to_vec_pretty(&report).expect("a report is plain data");
    summary.push(b'\n');
    let result = netcdf::assemble(dataset)?;
    let files = vec![
        scenario_file(dir, "scenario.toml", &dataset.scenario),
        NewFile::of("summary.json", summary),
        NewFile {
            name: "sweep.csv".to_owned(),
            write: Box::new(|to| table::write(dataset, to)),
            large: true,
        },
        NewFile { name: "sweep.nc".to_owned(), write: Box::new(move |to| result.write(to)), large: true },
    ];
    Ok(output::write_files(dir, files, attachments)?)
}
