//! Results as plain labelled arrays: what front ends write, plot or pass on.

use serde::{Deserialize, Serialize};

/// What a variable measures; front ends turn it into a unit label (`µm`, `MPa`, `1/µm`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Quantity {
    /// A length: stretches, positions.
    Length,
    /// A force.
    Force,
    /// A force squared: variances.
    ForceSquared,
    /// A force squared times a length: spectra.
    ForceSquaredLength,
    /// Per length: densities, hazards, breaking rates.
    PerLength,
    /// A force per length: stiffnesses.
    Stiffness,
    /// A force times a length.
    Energy,
    /// A length squared.
    Area,
    /// A length cubed: an area times a slip.
    Volume,
    /// A time.
    Time,
    /// A length per time.
    Velocity,
    /// Per time: rates.
    PerTime,
    /// A pure number.
    Number,
    /// A whole number: an index or a count.
    Count,
    /// Whether something holds: 1, otherwise 0.
    Flag,
}

impl Quantity {
    /// Every quantity, for tables of labels.
    pub const ALL: [Self; 15] = [
        Self::Length,
        Self::Force,
        Self::ForceSquared,
        Self::ForceSquaredLength,
        Self::PerLength,
        Self::Stiffness,
        Self::Energy,
        Self::Area,
        Self::Volume,
        Self::Time,
        Self::Velocity,
        Self::PerTime,
        Self::Number,
        Self::Count,
        Self::Flag,
    ];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Length => "length",
            Self::Force => "force",
            Self::ForceSquared => "force_squared",
            Self::ForceSquaredLength => "force_squared_length",
            Self::PerLength => "per_length",
            Self::Stiffness => "stiffness",
            Self::Energy => "energy",
            Self::Area => "area",
            Self::Volume => "volume",
            Self::Time => "time",
            Self::Velocity => "velocity",
            Self::PerTime => "per_time",
            Self::Number => "number",
            Self::Count => "count",
            Self::Flag => "flag",
        }
    }
}

/// What a variable is, without its values: each is declared once, and everything that shows it reads this.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Name in files.
    pub name: &'static str,
    /// Name for people.
    pub long_name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// Names of its dimensions, slowest first.
    pub dimensions: &'static [&'static str],
}

impl Column {
    /// A column along `dimensions`.
    pub const fn new(
        name: &'static str,
        long_name: &'static str,
        quantity: Quantity,
        dimensions: &'static [&'static str],
    ) -> Self {
        Self { name, long_name, quantity, dimensions }
    }

    /// The same along other dimensions.
    #[must_use]
    pub const fn along(self, dimensions: &'static [&'static str]) -> Self {
        Self { dimensions, ..self }
    }
}

/// A table of a result in CSV: a row for each place along the dimensions of the column that it needs.
#[derive(Debug, Clone, Copy)]
pub struct CsvTable {
    /// Name of the file.
    pub file: &'static str,
    /// Its columns in order, as far as a result has them; one with fewer dimensions than others is repeated along these.
    pub columns: &'static [Column],
    /// The column without which there is no such table.
    pub needed: Column,
}

/// A named array with named dimensions, in row-major order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// Name in files (`force`).
    pub name: String,
    /// Name for people (`friction force`).
    pub long_name: String,
    /// What it measures.
    pub quantity: Quantity,
    /// Names of its dimensions, slowest first; a variable named like its only dimension is a coordinate.
    pub dimensions: Vec<String>,
    /// The values.
    pub values: Vec<f64>,
}

/// The variables of a result; every dimension has one length, that of the variables along it alone.
///
/// ```
/// use asperity::scenario::Scenario;
///
/// let text = r#"{ "contacts": { "thresholds": { "point": { "at": 1.0 } } }, "pull": { "distance": 0.5, "points": 3 } }"#;
/// let scenario: Scenario = serde_json::from_str(text).expect("keys of a scenario");
/// let (_, record) = asperity::task::run(&scenario, &mut ())?;
/// assert_eq!(record.values("position"), Some([0.0, 0.25, 0.5].as_slice()));
/// assert_eq!(record.length("position"), Some(3));
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// In the order in which they were added.
    pub variables: Vec<Variable>,
}

impl Record {
    /// A record of these columns, without values.
    pub fn declared(lists: &[&[Column]]) -> Self {
        let mut record = Self::default();
        lists.iter().copied().flatten().for_each(|column| record.add(*column, Vec::new()));
        record
    }

    /// The same variables with `prefix` before their names and the names of their dimensions.
    #[must_use]
    pub fn prefixed(&self, prefix: &str) -> Self {
        let mut variables = self.variables.clone();
        for variable in &mut variables {
            variable.name.insert_str(0, prefix);
            variable.dimensions.iter_mut().for_each(|dimension| dimension.insert_str(0, prefix));
        }
        Self { variables }
    }

    /// The variable called `name`.
    pub fn get(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|v| v.name == name)
    }

    /// The values of the variable called `name`.
    pub fn values(&self, name: &str) -> Option<&[f64]> {
        self.get(name).map(|v| v.values.as_slice())
    }

    /// Row `row` of the variable called `name`: its values at one place along its first dimension.
    pub fn row(&self, name: &str, row: usize) -> Option<&[f64]> {
        let variable = self.get(name)?;
        let rows = self.length(variable.dimensions.first()?)?;
        let width = variable.values.len().checked_div(rows)?;
        if row < rows { variable.values.get(row * width..(row + 1) * width) } else { None }
    }

    /// The length of a dimension, from the first variable along it alone.
    pub fn length(&self, dimension: &str) -> Option<usize> {
        self.variables.iter().find(|v| v.dimensions == [dimension]).map(|v| v.values.len())
    }

    /// The dimensions and their lengths, in the order of first use.
    pub fn dimensions(&self) -> Vec<(&str, usize)> {
        let mut found: Vec<(&str, usize)> = Vec::new();
        for name in self.variables.iter().flat_map(|v| &v.dimensions) {
            if !found.iter().any(|(known, _)| known == name) {
                found.push((name, self.length(name).unwrap_or(0)));
            }
        }
        found
    }

    /// Adds the values of a column.
    pub fn add(&mut self, column: Column, values: Vec<f64>) {
        self.push(column.name, column.long_name, column.quantity, column.dimensions, values);
    }

    /// The same where there are values, and they are numbers.
    pub fn add_known(&mut self, column: Column, values: Vec<f64>) {
        if values.iter().any(|value| !value.is_nan()) {
            self.add(column, values);
        }
    }

    /// Bytes that all values take.
    pub fn bytes(&self) -> u64 {
        self.variables.iter().map(|variable| size_of_val(variable.values.as_slice()) as u64).sum()
    }

    /// Adds a variable along `dimensions`.
    pub fn push(
        &mut self,
        name: &str,
        long_name: &str,
        quantity: Quantity,
        dimensions: &[&str],
        values: Vec<f64>,
    ) {
        self.variables.push(Variable {
            name: name.to_owned(),
            long_name: long_name.to_owned(),
            quantity,
            dimensions: dimensions.iter().map(|&d| d.to_owned()).collect(),
            values,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Record {
        let mut record = Record::default();
        record.push("snapshot", "position", Quantity::Length, &["snapshot"], vec![0.0, 1.0]);
        record.push("stretch", "stretch", Quantity::Length, &["stretch"], vec![0.0, 0.5, 1.0]);
        let density = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        record.push("density", "density", Quantity::PerLength, &["snapshot", "stretch"], density);
        record
    }

    #[test]
    fn dimensions_take_their_lengths_from_one_dimensional_variables() {
        assert_eq!(sample().dimensions(), [("snapshot", 2), ("stretch", 3)]);
    }

    #[test]
    fn rows_run_along_the_first_dimension() {
        assert_eq!(sample().row("density", 1), Some([4.0, 5.0, 6.0].as_slice()));
        assert_eq!(sample().row("density", 2), None);
    }
}
