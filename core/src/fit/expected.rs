//! The readings that contacts and a machine lead to, and their derivatives.

use faer::Mat;

use super::free::{FreeParameter, Role};
use super::measurement::{Machine, Measurement};
use crate::Result;
use crate::master::{Covariance, MasterEquation, Pull};
use crate::monitor::{Monitor, Part};
use crate::numerics::roots::brent_root;

/// Cells in which the position of the slider is sought for a position of the drive.
const CELLS: usize = 2048;

/// The readings expected at some values of the free numbers.
#[derive(Debug)]
pub(super) struct ExpectedReadings {
    pub equation: MasterEquation,
    pub machine: Machine,
    pub pull: Pull,
    /// Positions of the slider.
    pub positions: Vec<f64>,
    /// The expected forces.
    pub forces: Vec<f64>,
    /// 1/(1 + cF'): the change of X with the position of the drive.
    pub followed: Vec<f64>,
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
        let Some(positions) = slider(&pull, machine.compliance, drive) else { return Ok(None) };
        let forces = positions.iter().zip(&measurement.positions);
        let forces = forces.map(|(&x, &y)| force(&pull, x) + machine.offset + machine.trend * y).collect();
        let followed = positions.iter().map(|&x| 1.0 / (1.0 + machine.compliance * pull.slope(x.max(0.0))));
        let followed = followed.collect();
        Ok(Some(Self { equation, machine, pull, positions, forces, followed }))
    }

    /// The derivative of each reading by the coordinate of each free number; columns of errors are 0.
    ///
    /// At a fixed position of the drive ∂F/∂θ = F_θ/(1 + cF') and ∂F/∂c = −F F'/(1 + cF').
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
        let mut derivatives = Mat::zeros(self.positions.len(), free.len());
        for (k, (parameter, &value)) in free.iter().zip(values).enumerate() {
            let gradient = (parameter.role == Role::Contacts).then(|| gradients.next()).flatten();
            let slope = if parameter.logarithmic { value } else { 1.0 };
            for (i, &x) in self.positions.iter().enumerate() {
                let steepness = self.pull.slope(x.max(0.0)) * self.followed[i];
                derivatives[(i, k)] = slope
                    * match parameter.role {
                        Role::Contacts => {
                            gradient.as_ref().map_or(0.0, |gradient| gradient.at(x.max(0.0)))
                                * self.followed[i]
                        }
                        Role::Compliance => -force(&self.pull, x) * steepness,
                        Role::Offset => 1.0,
                        Role::Trend => measured[i],
                        Role::Origin => -steepness,
                        Role::Reading | Role::DriftAmplitude | Role::DriftLength => 0.0,
                    };
            }
        }
        Ok(derivatives)
    }

    /// The covariance of the forces that follows from the finite number of contacts.
    ///
    /// # Errors
    /// Those of [`Pull::covariance`].
    pub fn noise(&self, monitor: &mut dyn Monitor) -> Result<Mat<f64>> {
        let inside: Vec<f64> = self.positions.iter().map(|x| x.max(0.0)).collect();
        let size = self.equation.contacts().count;
        let covariance: Covariance = self.pull.covariance_with(&inside, size, monitor)?;
        let n = inside.len();
        Ok(Mat::from_fn(n, n, |i, j| covariance.at(i, j) * self.followed[i] * self.followed[j]))
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

/// F(X); before X = 0 contacts are moved back without breaking, as the first slope continues.
fn force(pull: &Pull, position: f64) -> f64 {
    if position >= 0.0 { pull.force(position) } else { pull.force(0.0) + position * pull.slope(0.0) }
}

/// The positions X of the slider for rising positions X + cF(X) of the drive; `None` where it slips on the way.
fn slider(pull: &Pull, compliance: f64, drive: Vec<f64>) -> Option<Vec<f64>> {
    if compliance == 0.0 {
        return Some(drive);
    }
    let last = pull.distance();
    let at = |cell: usize| last * (cell as f64 / CELLS as f64);
    let lead = |x: f64| x + compliance * force(pull, x);
    let (mut low, mut high) = (0, 1);
    let mut found = Vec::with_capacity(drive.len());
    for &top in &drive {
        while high < CELLS && lead(at(high)) < top {
            if lead(at(high)) <= lead(at(low)) {
                return None;
            }
            (low, high) = (high, high + 1);
        }
        // Before the start, the drive unloads contacts that do not break.
        let before = -(last + compliance * force(pull, 0.0).abs());
        let start = if low == 0 { before } else { at(low) };
        found.push(brent_root(|x| lead(x) - top, start, at(high), 1e-14 * last)?);
    }
    Some(found)
}
