//! The numbers that a fit has held at their first values.

use super::estimate::Estimate;
use super::estimates::Estimates;
use super::measurement::Machine;
use super::steady::SteadyEstimates;
use super::velocity_curve::{VelocityCurveEstimates, is_of_sliding};

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
        let contacts = self.equation().parameters().into_iter();
        let contacts = contacts.map(|parameter| (parameter.name.into_owned(), parameter.value));
        let machine = OF_MACHINE.iter().flat_map(|number| self.of_machine(*number));
        contacts.chain(machine).filter(|(name, _)| !is_free(&self.parameters, name)).collect()
    }

    /// A number of the machine, once if it is the same for all curves; none where it is 0.
    fn of_machine(&self, (name, of): MachineNumber) -> Vec<(String, f64)> {
        let values: Vec<f64> = (0..self.curves().len()).map(|curve| of(self.machine(curve))).collect();
        let named = match values.as_slice() {
            [first, others @ ..] if others.iter().all(|value| value == first) => {
                vec![(name.to_owned(), *first)]
            }
            _ => values.iter().enumerate().map(|(c, value)| (format!("curve.{c}.{name}"), *value)).collect(),
        };
        named.into_iter().filter(|(_, value)| *value != 0.0).collect()
    }
}

impl SteadyEstimates {
    /// The numbers of the contacts that were not free, with their values, and the offset if it is not 0.
    pub fn fixed(&self) -> Vec<(String, f64)> {
        let contacts = self.equation().parameters().into_iter();
        let contacts = contacts.map(|parameter| (parameter.name.into_owned(), parameter.value));
        let offset = (self.offset != 0.0).then(|| ("offset".to_owned(), self.offset));
        contacts.chain(offset).filter(|(name, _)| !is_free(&self.parameters, name)).collect()
    }
}

impl VelocityCurveEstimates {
    /// The numbers of the contacts that were not free, with their values, and background and offset if they are not 0.
    pub fn fixed(&self) -> Vec<(String, f64)> {
        let contacts = self.equation().parameters().into_iter();
        let contacts = contacts.map(|parameter| (parameter.name.into_owned(), parameter.value));
        let contacts = contacts.filter(|(name, _)| is_of_sliding(name));
        let constant = [("background", self.background), ("offset", self.offset)];
        let constant = constant.into_iter().filter(|(_, value)| *value != 0.0);
        let constant = constant.map(|(name, value)| (name.to_owned(), value));
        contacts.chain(constant).filter(|(name, _)| !is_free(&self.parameters, name)).collect()
    }
}

/// Whether a number is one of `free`, for all curves or for one of them.
fn is_free(free: &[Estimate], name: &str) -> bool {
    free.iter().any(|estimate| {
        let of_curve = estimate.name.strip_prefix("curve.").and_then(|rest| rest.split_once('.'));
        estimate.name == name || of_curve.is_some_and(|(_, quantity)| quantity == name)
    })
}
