//! The readings that contacts and a machine lead to, and their derivatives.

use faer::Mat;

use super::free::{FreeParameter, Role};
use super::measurement::{Machine, Measurement};
use crate::Result;
use crate::master::{AgainstDrive, Covariance, MasterEquation, Pull};
use crate::monitor::{Monitor, Part};

/// The readings expected at some values of the free numbers.
#[derive(Debug)]
pub(super) struct ExpectedReadings {
    pub equation: MasterEquation,
    pub machine: Machine,
    pub pull: Pull,
    /// The forces of the contacts, and where the slider is.
    pub driven: AgainstDrive,
    /// The expected readings: forces with offset and trend.
    pub forces: Vec<f64>,
}

impl ExpectedReadings {
    /// The readings at `values` of `free`; `None` where the machine of this compliance slips.
    ///
    /// # Errors
    /// A value outside of its range; errors of the solver; stopped by the monitor.
    pub fn new(
        (equation, measurement): (&MasterEquation, &Measurement),
        (free, values): (&[FreeParameter], &[f64]),
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Self>> {
        let machine = machine(measurement.machine, free, values);
        let of_contacts = free.iter().zip(values).filter(|(parameter, _)| parameter.role == Role::Contacts);
        let values: Vec<_> =
            of_contacts.map(|(parameter, &value)| (parameter.name.as_str(), value)).collect();
        let equation = equation.with_parameters(&values, &mut Part::new(monitor, 0.0, 0.5))?;
        let last = measurement.positions[measurement.positions.len() - 1] - machine.origin;
        let distance = last.max(f64::MIN_POSITIVE);
        let pull = equation.pull_with(distance, TOLERANCE, &mut Part::new(monitor, 0.5, 0.5))?;
        let drive: Vec<f64> = measurement.positions.iter().map(|y| y - machine.origin).collect();
        let Some(driven) = pull.against_drive(machine.compliance, &drive) else { return Ok(None) };
        let forces = driven.forces.iter().zip(&measurement.positions);
        let forces = forces.map(|(force, &y)| force + machine.offset + machine.trend * y).collect();
        Ok(Some(Self { equation, machine, pull, driven, forces }))
    }

    /// The derivative of each reading by the coordinate of each free number; columns of errors are 0.
    ///
    /// Those of the contacts and of the compliance are at a fixed position of the drive: see [`AgainstDrive`].
    ///
    /// # Errors
    /// Those of [`Pull::gradients`].
    pub fn derivatives(
        &self,
        measured: &[f64],
        (free, values): (&[FreeParameter], &[f64]),
        monitor: &mut dyn Monitor,
    ) -> Result<Mat<f64>> {
        let names: Vec<&str> = free
            .iter()
            .filter(|parameter| parameter.role == Role::Contacts)
            .map(|parameter| parameter.name.as_str())
            .collect();
        let mut gradients = self.pull.gradients_with(&names, monitor)?.into_iter();
        let count = measured.len();
        let mut derivatives = Mat::zeros(count, free.len());
        for (k, (parameter, &value)) in free.iter().zip(values).enumerate() {
            let column = match parameter.role {
                Role::Contacts => {
                    gradients.next().map_or_else(Vec::new, |gradient| self.driven.by_parameter(&gradient))
                }
                Role::Compliance => self.driven.by_compliance(),
                Role::Offset => vec![1.0; count],
                Role::Trend => measured.to_vec(),
                Role::Origin => self.driven.by_drive().into_iter().map(|slope| -slope).collect(),
                Role::Reading | Role::DriftAmplitude | Role::DriftLength => continue,
            };
            let slope = if parameter.logarithmic { value } else { 1.0 };
            column.iter().enumerate().for_each(|(i, entry)| derivatives[(i, k)] = slope * entry);
        }
        Ok(derivatives)
    }

    /// The covariance of the forces that follows from the finite number of contacts.
    ///
    /// # Errors
    /// Those of [`Pull::covariance`].
    pub fn noise(&self, monitor: &mut dyn Monitor) -> Result<Mat<f64>> {
        let inside: Vec<f64> = self.driven.positions.iter().map(|x| x.max(0.0)).collect();
        let size = self.equation.contacts().count;
        let covariance: Covariance = self.pull.covariance_with(&inside, size, monitor)?;
        let n = inside.len();
        let followed = &self.driven.followed;
        Ok(Mat::from_fn(n, n, |i, j| covariance.at(i, j) * followed[i] * followed[j]))
    }
}

/// Error of F/(N_c⟨k⟩) aimed at, relative to the mean threshold; as in a pull.
const TOLERANCE: Option<f64> = None;

/// The machine at `values` of `free`.
fn machine(mut machine: Machine, free: &[FreeParameter], values: &[f64]) -> Machine {
    for (parameter, &value) in free.iter().zip(values) {
        match parameter.role {
            Role::Compliance => machine.compliance = value,
            Role::Offset => machine.offset = value,
            Role::Trend => machine.trend = value,
            Role::Origin => machine.origin = value,
            Role::Contacts | Role::Reading | Role::DriftAmplitude | Role::DriftLength => {}
        }
    }
    machine
}
