//! The master equation beside an ensemble, where a run has both.

use std::collections::HashMap;
use std::path::Path;

/// How far they may be apart, in standard errors of the ensemble.
///
/// Of each case the last row is looked at, so that cases are independent. A Gaussian deviate is beyond 4 with a probability of
/// 6.3e-5: one of a hundred cases is so by chance in 0.6 % of the choices of seeds (Bonferroni). Seeds are fixed, and so is
/// the answer.
pub const ERRORS: f64 = 4.0;
/// What the solutions may be apart besides, of the largest force: twice the tolerance by default where thresholds diffuse in
/// time, the coarsest there is, and rounding where all contacts of an ensemble do the same and its error is 0.
const SOLVED: f64 = 2e-4;

/// How far the two are apart in the last row of one of the tables in a folder, in standard errors beyond what solutions may
/// miss; none where there is no such table.
pub fn deviation(results: &Path) -> Option<f64> {
    ["force.csv", "trace.csv", "velocity_curve.csv"]
        .into_iter()
        .find_map(|name| in_table(&results.join(name)))
}

fn in_table(path: &Path) -> Option<f64> {
    let text = std::fs::read_to_string(path).ok()?;
    let mut rows = text.lines();
    let names: Vec<_> = rows.next()?.split(',').collect();
    let column = |name: &str| names.iter().position(|one| *one == name);
    let force = column("force").or_else(|| column("kinetic_friction"))?;
    let (drawn, error) = (column("ensemble_force")?, column("ensemble_error")?);
    let numbers =
        |row: &str| row.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>();
    let rows: Vec<_> = rows.map(numbers).collect();
    let largest = rows.iter().map(|row| row[force].abs()).fold(0.0, f64::max);
    let last = rows.last()?;
    let beyond = ((last[drawn] - last[force]).abs() - SOLVED * largest).max(0.0);
    Some(if beyond == 0.0 { 0.0 } else { beyond / last[error] })
}

/// Deviations of cases.
#[derive(Debug, Default)]
pub struct Deviations(HashMap<u64, f64>);

impl Deviations {
    /// Notes one.
    pub fn note(&mut self, case: u64, deviation: f64) {
        self.0.insert(case, deviation);
    }

    /// Adds others.
    pub fn add(&mut self, others: Self) {
        self.0.extend(others.0);
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The largest.
    pub fn largest(&self) -> f64 {
        self.0.values().copied().fold(0.0, f64::max)
    }
}
