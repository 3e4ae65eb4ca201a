//! The numbers that a fit has held at their first values.

use super::estimate::Estimate;
use super::estimates::Estimates;
use super::free::of_curve;
use super::measurement::Machine;
use super::steady::SteadyEstimates;
use super::velocity_curve::{VelocityCurveEstimates, is_of_sliding};
use crate::master::MasterEquation;

/// The name of a number of the machine, and its value.
type MachineNumber = (&'static str, fn(Machine) -> f64);

/// The numbers of the machine.
const OF_MACHINE: [MachineNumber; 5] = [
    ("compliance", |machine| machine.compliance),
    ("background", |machine| machine.background),
    ("offset", |machine| machine.offset),
    ("trend", |machine| machine.trend),
    ("origin", |machine| machine.origin),
];

impl Estimates {
    /// The numbers of the contacts that were not free, with their values, and those of the machine that are not 0. A number
    /// that differs between curves is reported for each.
    pub fn fixed(&self) -> Vec<(String, f64)> {
        let machine = OF_MACHINE.iter().flat_map(|number| self.of_machine(*number));
        fixed(self.equation(), machine, &self.parameters)
    }

    /// A number of the machine, once if it is the same for all curves.
    fn of_machine(&self, (name, of): MachineNumber) -> Vec<(String, f64)> {
        let values: Vec<f64> = (0..self.curves().len()).map(|curve| of(self.machine(curve))).collect();
        match values.as_slice() {
            [first, others @ ..] if others.iter().all(|value| value == first) => {
                vec![(name.to_owned(), *first)]
            }
            _ => values.iter().enumerate().map(|(c, value)| (format!("curve.{c}.{name}"), *value)).collect(),
        }
    }
}

impl SteadyEstimates {
    /// The numbers of the contacts that were not free, with their values, and the offset if it is not 0.
    pub fn fixed(&self) -> Vec<(String, f64)> {
        fixed(self.equation(), [("offset".to_owned(), self.offset)], &self.parameters)
    }
}

impl VelocityCurveEstimates {
    /// The numbers of the contacts that were not free, with their values, and background and offset if they are not 0.
    pub fn fixed(&self) -> Vec<(String, f64)> {
        let constant = [("background".to_owned(), self.background), ("offset".to_owned(), self.offset)];
        let mut all = fixed(self.equation(), constant, &self.parameters);
        all.retain(|(name, _)| is_of_sliding(name));
        all
    }
}

/// The numbers of the contacts and those of the `others` that are not 0, but for those that are `free`, for all curves or for one
/// of them.
fn fixed(
    equation: &MasterEquation,
    others: impl IntoIterator<Item = (String, f64)>,
    free: &[Estimate],
) -> Vec<(String, f64)> {
    let is_free = |name: &str| free.iter().any(|own| own.name == name || of_curve(&own.name).1 == name);
    let contacts = equation.parameters().into_iter();
    let contacts = contacts.map(|parameter| (parameter.name.into_owned(), parameter.value));
    let others = others.into_iter().filter(|(_, value)| *value != 0.0);
    contacts.chain(others).filter(|(name, _)| !is_free(name)).collect()
}
