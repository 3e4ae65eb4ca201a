//! Results as plain labelled columns: what every front end writes, draws or hands on.

/// What a variable measures; front ends turn it into a unit label (`µm`, `MPa`, `1/µm`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quantity {
    /// A length: stretches, positions.
    Length,
    /// A force.
    Force,
    /// Per length: densities, hazards, breaking rates.
    PerLength,
    /// A force per length: stiffnesses.
    Stiffness,
    /// A pure number.
    Number,
}

/// A named array with named dimensions, in row-major order.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name in files (`force`).
    pub name: &'static str,
    /// Name for people (`friction force`).
    pub long_name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// Names of its dimensions, slowest first; a variable named like its only dimension is a coordinate.
    pub dimensions: Vec<&'static str>,
    /// The values; the lengths of dimensions follow from the coordinates.
    pub values: Vec<f64>,
}

/// The variables of a result.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Record {
    /// In the order in which they were added.
    pub variables: Vec<Variable>,
}

impl Record {
    /// The variable called `name`.
    pub fn get(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|v| v.name == name)
    }

    /// The values of the variable called `name`.
    pub fn values(&self, name: &str) -> Option<&[f64]> {
        self.get(name).map(|v| v.values.as_slice())
    }

    /// Adds a variable.
    pub fn push(&mut self, variable: Variable) {
        self.variables.push(variable);
    }
}
