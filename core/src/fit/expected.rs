//! The readings that contacts and machines lead to, and their derivatives.

use std::sync::Arc;

use faer::Mat;

use super::free::{FreeParameter, Role};
use super::measurement::{Machine, Measurement};
use crate::Result;
use crate::master::{Covariance, Gradient, MasterEquation, Pull};
use crate::monitor::{Monitor, Part};
use crate::numerics::roots::brent_root;

/// Cells in which the position of the slider is sought for a position of the drive.
const CELLS: usize = 2048;

/// The contacts at some values of the free numbers, and their pull up to the last reading of the curves that they describe.
#[derive(Debug)]
pub(super) struct FittedContacts {
    pub equation: MasterEquation,
    pub pull: Pull,
}

/// The readings of one curve expected at some values of the free numbers.
#[derive(Debug, Clone)]
pub(super) struct ExpectedReadings {
    /// The contacts; curves without free numbers of the contacts of their own share them.
    pub contacts: Arc<FittedContacts>,
    pub machine: Machine,
    /// Positions of the slider.
    pub positions: Vec<f64>,
    /// The expected forces.
    pub forces: Vec<f64>,
    /// 1/(1 + cF'): the change of X with the position of the drive.
    pub followed: Vec<f64>,
}

/// The free numbers with their values.
pub(super) type Values<'a> = (&'a [FreeParameter], &'a [f64]);

impl FittedContacts {
    /// The contacts of one curve and all with the same free numbers, and their pull over `distance`.
    ///
    /// # Errors
    /// A value outside of its range; errors of the solver; stopped by the monitor.
    fn new(
        equation: &MasterEquation,
        (curve, distance): (usize, f64),
        (free, values): Values<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let values: Vec<_> = free
            .iter()
            .zip(values)
            .filter(|(parameter, _)| parameter.role == Role::Contacts && parameter.applies_to(curve))
            .map(|(parameter, &value)| (parameter.quantity.as_str(), value))
            .collect();
        let equation = equation.with_parameters(&values, &mut Part::new(monitor, 0.0, 0.5))?;
        let pull = equation.pull_with(distance, TOLERANCE, &mut Part::new(monitor, 0.5, 0.5))?;
        Ok(Self { equation, pull })
    }
}

/// The readings of all curves at `values` of `free`; `None` where a machine of this compliance slips.
///
/// # Errors
/// A value outside of its range; errors of the solver; stopped by the monitor.
pub(super) fn expected_readings(
    (equation, curves): (&MasterEquation, &[Measurement]),
    (free, values): Values<'_>,
    monitor: &mut dyn Monitor,
) -> Result<Option<Vec<ExpectedReadings>>> {
    let machines: Vec<Machine> = curves
        .iter()
        .enumerate()
        .map(|(c, measured)| machine((c, measured.machine), (free, values)))
        .collect();
    let distance = |c: usize| {
        let last = curves[c].positions[curves[c].positions.len() - 1] - machines[c].origin;
        last.max(f64::MIN_POSITIVE)
    };
    let has_own = |c: usize| {
        free.iter().any(|parameter| parameter.role == Role::Contacts && parameter.curve == Some(c))
    };
    let mut shared: Option<Arc<FittedContacts>> = None;
    let mut all = Vec::with_capacity(curves.len());
    let share = 1.0 / curves.len() as f64;
    for (c, measured) in curves.iter().enumerate() {
        let contacts = if let (Some(shared), false) = (&shared, has_own(c)) {
            shared.clone()
        } else {
            let same = (0..curves.len()).filter(|&other| other == c || !has_own(c) && !has_own(other));
            let farthest = same.map(distance).fold(0.0, f64::max);
            let part = &mut Part::new(monitor, c as f64 * share, share);
            Arc::new(FittedContacts::new(equation, (c, farthest), (free, values), part)?)
        };
        if !has_own(c) {
            shared = Some(contacts.clone());
        }
        let Some(readings) = ExpectedReadings::new(contacts, machines[c], measured) else { return Ok(None) };
        all.push(readings);
    }
    Ok(Some(all))
}

/// The derivative of each reading of all curves by the coordinate of each free number; columns of errors are 0.
///
/// At a fixed position of the drive ∂F/∂θ = F_θ/(1 + cF') and ∂F/∂c = −F F'/(1 + cF').
///
/// # Errors
/// Those of [`Pull::gradients`].
pub(super) fn derivatives(
    (readings, curves): (&[&ExpectedReadings], &[Measurement]),
    values: Values<'_>,
    monitor: &mut dyn Monitor,
) -> Result<Vec<Mat<f64>>> {
    let share = 1.0 / curves.len() as f64;
    let mut known: Option<(&Arc<FittedContacts>, Vec<Gradient>)> = None;
    let mut all = Vec::with_capacity(curves.len());
    for (c, (readings, measured)) in readings.iter().zip(curves).enumerate() {
        let gradients = match known.take() {
            Some((contacts, gradients)) if Arc::ptr_eq(contacts, &readings.contacts) => gradients,
            _ => readings.gradients((c, values.0), &mut Part::new(monitor, c as f64 * share, share))?,
        };
        all.push(readings.derivatives((c, &measured.positions), &gradients, values));
        known = Some((&readings.contacts, gradients));
    }
    Ok(all)
}

impl ExpectedReadings {
    /// The readings of a curve; `None` where the machine slips.
    fn new(contacts: Arc<FittedContacts>, machine: Machine, measured: &Measurement) -> Option<Self> {
        let pull = &contacts.pull;
        let drive: Vec<f64> = measured.positions.iter().map(|y| y - machine.origin).collect();
        let positions = slider(pull, machine.compliance, drive)?;
        let forces = positions.iter().zip(&measured.positions);
        let forces = forces.map(|(&x, &y)| force(pull, x) + machine.offset + machine.trend * y).collect();
        let followed = positions.iter().map(|&x| 1.0 / (1.0 + machine.compliance * pull.slope(x.max(0.0))));
        let followed = followed.collect();
        Some(Self { contacts, machine, positions, forces, followed })
    }

    /// The readings of curve `curve` alone, at other positions; `None` where the machine slips.
    ///
    /// # Errors
    /// A value outside of its range; errors of the solver; stopped by the monitor.
    pub fn of_curve(
        (curve, measured): (usize, &Measurement),
        equation: &MasterEquation,
        numbers: Values<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Self>> {
        let machine = machine((curve, measured.machine), numbers);
        let last = measured.positions[measured.positions.len() - 1] - machine.origin;
        let distance = last.max(f64::MIN_POSITIVE);
        let contacts = FittedContacts::new(equation, (curve, distance), numbers, monitor)?;
        Ok(Self::new(Arc::new(contacts), machine, measured))
    }

    /// The derivatives of the force by the free numbers of the contacts of curve `curve`.
    ///
    /// # Errors
    /// Those of [`Pull::gradients`].
    pub fn gradients(
        &self,
        (curve, free): (usize, &[FreeParameter]),
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Gradient>> {
        let of_contacts =
            free.iter().filter(|parameter| parameter.role == Role::Contacts && parameter.applies_to(curve));
        let names: Vec<&str> = of_contacts.map(|parameter| parameter.quantity.as_str()).collect();
        self.contacts.pull.gradients_with(&names, monitor)
    }

    /// The derivatives of the readings of curve `curve` at the positions `measured`, with the `gradients` of its contacts.
    pub fn derivatives(
        &self,
        (curve, measured): (usize, &[f64]),
        gradients: &[Gradient],
        (free, values): Values<'_>,
    ) -> Mat<f64> {
        let pull = &self.contacts.pull;
        let mut gradients = gradients.iter();
        let mut derivatives = Mat::zeros(self.positions.len(), free.len());
        for (k, (parameter, &value)) in free.iter().zip(values).enumerate() {
            if !parameter.applies_to(curve) {
                continue;
            }
            let gradient = (parameter.role == Role::Contacts).then(|| gradients.next()).flatten();
            let slope = if parameter.logarithmic { value } else { 1.0 };
            for (i, &x) in self.positions.iter().enumerate() {
                let steepness = pull.slope(x.max(0.0)) * self.followed[i];
                derivatives[(i, k)] = slope
                    * match parameter.role {
                        Role::Contacts => {
                            gradient.map_or(0.0, |gradient| gradient.at(x.max(0.0))) * self.followed[i]
                        }
                        Role::Compliance => -force(pull, x) * steepness,
                        Role::Offset => 1.0,
                        Role::Trend => measured[i],
                        Role::Origin => -steepness,
                        Role::Reading | Role::DriftAmplitude | Role::DriftLength => 0.0,
                    };
            }
        }
        derivatives
    }

    /// The covariance of the forces that follows from the finite number of contacts.
    ///
    /// # Errors
    /// Those of [`Pull::covariance`].
    pub fn noise(&self, monitor: &mut dyn Monitor) -> Result<Mat<f64>> {
        let inside: Vec<f64> = self.positions.iter().map(|x| x.max(0.0)).collect();
        let FittedContacts { equation, pull } = &*self.contacts;
        let size = equation.contacts().count;
        let covariance: Covariance = pull.covariance_with(&inside, size, monitor)?;
        let n = inside.len();
        Ok(Mat::from_fn(n, n, |i, j| covariance.at(i, j) * self.followed[i] * self.followed[j]))
    }
}

/// Error of F/(N_c⟨k⟩) aimed at, relative to the mean threshold; as in a pull.
const TOLERANCE: Option<f64> = None;

/// The machine of a curve at `values` of `free`.
fn machine((curve, mut machine): (usize, Machine), (free, values): Values<'_>) -> Machine {
    for (parameter, &value) in free.iter().zip(values).filter(|(free, _)| free.applies_to(curve)) {
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
