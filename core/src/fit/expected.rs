//! The readings that contacts and machines lead to, and their derivatives.

use std::sync::{Arc, OnceLock};

use faer::Mat;

use super::free::{FreeParameter, Role, of_contacts};
use super::measurement::{Machine, Measurement};
use crate::master::{AgainstDrive, Covariance, Gradient, MasterEquation, Pull};
use crate::monitor::{Monitor, Part};
use crate::numerics::order::sort_by_number;
use crate::{Error, Result};

/// The contacts at some values of the free numbers, and their pull up to the last reading of the curves that they describe.
#[derive(Debug)]
pub(super) struct FittedContacts {
    pub equation: MasterEquation,
    pub pull: Pull,
    /// The derivatives of the force by the free numbers of the contacts, once they have been needed, and the names of these.
    gradients: OnceLock<(Vec<String>, Arc<Vec<Gradient>>)>,
}

/// The readings of one curve expected at some values of the free numbers.
#[derive(Debug, Clone)]
pub(super) struct ExpectedReadings {
    /// The contacts; curves without free numbers of the contacts of their own share them.
    pub contacts: Arc<FittedContacts>,
    pub machine: Machine,
    /// The forces of the contacts, and where the slider is.
    pub driven: AgainstDrive,
    /// The same at the members of readings that are means, and the numbers of these.
    members: Option<(AgainstDrive, Vec<usize>)>,
    /// The expected readings: forces with offset and trend.
    pub forces: Vec<f64>,
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
        let values = of_contacts(free, values, curve);
        let widest = WIDEST.max(NEAR * relative_width(equation));
        let equation = equation.with_parameters(&values, &mut Part::new(monitor, 0.0, 0.5))?;
        if relative_width(&equation) > widest {
            let expected = "thresholds whose standard deviation is some means at most";
            return Err(Error::invalid("thresholds", expected, relative_width(&equation)));
        }
        let pull = equation.pull_with(distance, TOLERANCE, &mut Part::new(monitor, 0.5, 0.5))?;
        Ok(Self { equation, pull, gradients: OnceLock::new() })
    }
}

/// The standard deviation of the thresholds over their mean.
fn relative_width(equation: &MasterEquation) -> f64 {
    let thresholds = &equation.contacts().thresholds;
    thresholds.std() / thresholds.mean()
}

/// The readings of all curves at `values` of `free`; `None` where a machine of this compliance slips, or none has it.
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
    if machines.iter().any(|machine| machine.compliance < 0.0) {
        return Ok(None);
    }
    let distance = |c: usize| {
        let last = curves[c].last() - machines[c].origin;
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
/// Those of the contacts and of the compliance are at a fixed position of the drive: see [`AgainstDrive`].
///
/// # Errors
/// Those of [`Pull::gradients`].
pub(super) fn derivatives(
    (readings, curves): (&[&ExpectedReadings], &[Measurement]),
    values: Values<'_>,
    monitor: &mut dyn Monitor,
) -> Result<Vec<Mat<f64>>> {
    let share = 1.0 / curves.len() as f64;
    let of_curve = |(c, (readings, measured)): (usize, (&&ExpectedReadings, &Measurement))| {
        let gradients =
            readings.gradients((c, values.0), &mut Part::new(monitor, c as f64 * share, share))?;
        Ok(readings.derivatives((c, &measured.positions), &gradients, values))
    };
    readings.iter().zip(curves).enumerate().map(of_curve).collect()
}

impl ExpectedReadings {
    /// The readings of a curve; `None` where the machine slips.
    fn new(contacts: Arc<FittedContacts>, machine: Machine, measured: &Measurement) -> Option<Self> {
        let start = machine.origin + machine.compliance * machine.background;
        let drive: Vec<f64> = measured.positions.iter().map(|y| y - start).collect();
        let driven = contacts.pull.against_drive(machine.compliance, &drive)?;
        let members = if measured.members.is_empty() {
            None
        } else {
            let mut members: Vec<(f64, usize)> =
                measured.members.iter().flatten().enumerate().map(|(i, y)| (y - start, i)).collect();
            // Those of neighbouring means may overlap.
            sort_by_number(&mut members, |member| member.0);
            let (drive, order): (Vec<f64>, Vec<usize>) = members.into_iter().unzip();
            let sizes = measured.members.iter().map(Vec::len).collect();
            Some((contacts.pull.against_drive(machine.compliance, &drive)?.at_places(&order), sizes))
        };
        let mut readings = Self { contacts, machine, driven, members, forces: Vec::new() };
        let level = machine.background + machine.offset;
        let forces = readings.of_members(|driven| driven.forces.clone()).into_iter().zip(&measured.positions);
        readings.forces = forces.map(|(force, &y)| force + level + machine.trend * y).collect();
        Some(readings)
    }

    /// A quantity at the positions of the readings, or its means over their members.
    fn of_members(&self, quantity: impl Fn(&AgainstDrive) -> Vec<f64>) -> Vec<f64> {
        let Some((members, sizes)) = &self.members else { return quantity(&self.driven) };
        let values = quantity(members);
        let mut rest = values.as_slice();
        let mean = |&size: &usize| {
            let (group, later) = rest.split_at(size);
            rest = later;
            group.iter().sum::<f64>() / size as f64
        };
        sizes.iter().map(mean).collect()
    }

    /// Those of the same contacts and machines at the positions of other `curves`; `None` where a pull ends before.
    pub fn again(known: &[Self], curves: &[Measurement]) -> Option<Vec<Self>> {
        let of_curve = |(known, measured): (&Self, &Measurement)| {
            let last = measured.last() - known.machine.origin;
            let reached = last <= known.contacts.pull.distance();
            reached.then(|| Self::new(known.contacts.clone(), known.machine, measured)).flatten()
        };
        known.iter().zip(curves).map(of_curve).collect()
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
        let last = measured.last() - machine.origin;
        let distance = last.max(f64::MIN_POSITIVE);
        let contacts = FittedContacts::new(equation, (curve, distance), numbers, monitor)?;
        Ok(Self::new(Arc::new(contacts), machine, measured))
    }

    /// The derivatives of the force by the free numbers of the contacts of curve `curve`, which are computed once.
    ///
    /// # Errors
    /// Those of [`Pull::gradients`].
    pub fn gradients(
        &self,
        (curve, free): (usize, &[FreeParameter]),
        monitor: &mut dyn Monitor,
    ) -> Result<Arc<Vec<Gradient>>> {
        let of_contacts =
            free.iter().filter(|parameter| parameter.role == Role::Contacts && parameter.applies_to(curve));
        let names: Vec<&str> = of_contacts.map(|parameter| parameter.quantity.as_str()).collect();
        match self.contacts.gradients.get() {
            Some((known, gradients)) if *known == names => Ok(gradients.clone()),
            _ => {
                let gradients = Arc::new(self.contacts.pull.gradients_with(&names, monitor)?);
                let names = names.into_iter().map(str::to_owned).collect();
                // Where they are known for other names, those stay.
                let _ = self.contacts.gradients.set((names, gradients.clone()));
                Ok(gradients)
            }
        }
    }

    /// The derivatives of the readings of curve `curve` at the positions `measured`, with the `gradients` of its contacts.
    pub fn derivatives(
        &self,
        (curve, measured): (usize, &[f64]),
        gradients: &[Gradient],
        (free, values): Values<'_>,
    ) -> Mat<f64> {
        let mut gradients = gradients.iter();
        let count = measured.len();
        let mut derivatives = Mat::zeros(count, free.len());
        for (k, (parameter, &value)) in free.iter().zip(values).enumerate() {
            if !parameter.applies_to(curve) {
                continue;
            }
            let column = match parameter.role {
                Role::Contacts => {
                    let of = |gradient| self.of_members(|driven| driven.by_parameter(gradient));
                    gradients.next().map_or_else(Vec::new, of)
                }
                Role::Compliance => self.by_compliance(),
                Role::Background => {
                    let slopes = self.by_drive().into_iter();
                    slopes.map(|slope| 1.0 - self.machine.compliance * slope).collect()
                }
                Role::Offset => vec![1.0; count],
                Role::Trend => measured.to_vec(),
                Role::Origin => self.by_drive().into_iter().map(|slope| -slope).collect(),
                Role::Reading | Role::DriftAmplitude | Role::DriftLength => continue,
            };
            let slope = if parameter.logarithmic { value } else { 1.0 };
            column.iter().enumerate().for_each(|(i, entry)| derivatives[(i, k)] = slope * entry);
        }
        derivatives
    }

    /// The derivatives of the readings by the position of the drive.
    fn by_drive(&self) -> Vec<f64> {
        self.of_members(AgainstDrive::by_drive)
    }

    /// The derivatives of the readings by the compliance, at which the whole force F + B stretches the machine.
    fn by_compliance(&self) -> Vec<f64> {
        let slopes = self.by_drive().into_iter().zip(self.of_members(AgainstDrive::by_compliance));
        slopes.map(|(slope, contacts)| contacts - self.machine.background * slope).collect()
    }

    /// The variances of the readings that independent errors of the positions make, of the standard deviation `std` each: a reading
    /// changes with its position by the slope of the curve and the trend.
    pub fn variances_by_positions(&self, std: f64) -> Vec<f64> {
        let square = |slope: f64| ((slope + self.machine.trend) * std).powi(2);
        let means = self.of_members(|driven| driven.by_drive().into_iter().map(square).collect());
        let count = |i: usize| self.members.as_ref().map_or(1.0, |(_, sizes)| sizes[i] as f64);
        means.into_iter().enumerate().map(|(i, mean)| mean / count(i)).collect()
    }

    /// The covariance of the forces that follows from the finite number of contacts. That of means of neighbouring readings is the one
    /// of single readings but for the variances, as it has a kink where two positions meet: E\[(F(X + d) − F(X))²\] is κd for short d,
    /// with the rate κ of squared losses at breaks, so that C(X, X') is C(X, X) − κ|X − X'|/2 there.
    ///
    /// # Errors
    /// Those of [`Pull::covariance`].
    pub fn noise(&self, measured: &Measurement, monitor: &mut dyn Monitor) -> Result<Mat<f64>> {
        let inside = &self.driven.positions;
        let FittedContacts { equation, pull, .. } = &*self.contacts;
        let covariance: Covariance = pull.covariance_with(inside, equation.contacts().count, monitor)?;
        let n = inside.len();
        let followed = &self.driven.followed;
        // Columns of the matrix are rows of the covariance, which is symmetric and kept row by row.
        let mut noise = Mat::from_fn(n, n, |i, j| covariance.at(j, i) * followed[i] * followed[j]);
        for i in (0..n).filter(|&i| measured.distance(i, i) > 0.0) {
            let spread = followed[i] * measured.distance(i, i);
            let lost = 0.5 * rate_of_squares(&covariance, inside, i) * spread;
            noise[(i, i)] -= lost.min(MOST_LOST * covariance.at(i, i)) * followed[i].powi(2);
        }
        Ok(noise)
    }
}

/// Largest part of the variance that a mean of neighbouring readings has less than one of them: that of a group which begins where
/// the first contacts break, at a constant rate, with variances from 0 to κw and the mean distance w/3.
const MOST_LOST: f64 = 1.0 / 3.0;

/// κ at one of at least three rising positions, by the squared changes between it and its neighbours: those over two intervals show
/// what is not linear in their length. Where breaks set in κ rises by factors from one position to the next; it is at most twice
/// that of either interval, of which a mean then loses a third, so that the covariance remains positive definite.
fn rate_of_squares(covariance: &Covariance, positions: &[f64], i: usize) -> f64 {
    let Some(last) = positions.len().checked_sub(2).filter(|&last| last > 0) else { return 0.0 };
    let i = i.clamp(1, last);
    let square = |a: usize, b: usize| covariance.at(a, a) + covariance.at(b, b) - 2.0 * covariance.at(a, b);
    let [before, after] = [square(i - 1, i), square(i, i + 1)];
    let [down, up] = [positions[i] - positions[i - 1], positions[i + 1] - positions[i]];
    if down <= 0.0 || up <= 0.0 {
        return 0.0;
    }
    let both = (2.0 * (before + after) - square(i - 1, i + 1)).max(0.0) / (down + up);
    both.min(2.0 * before / down).min(2.0 * after / up)
}

/// Largest relative width of thresholds that a search tries, and the factor above that of the first values: no curve shows how much
/// wider they are, and one solution would take as long as a whole fit.
const WIDEST: f64 = 10.0;
const NEAR: f64 = 2.0;
/// Error of F/(N_c⟨k⟩) aimed at, relative to the mean threshold; as in a pull.
const TOLERANCE: Option<f64> = None;

/// The machine of a curve at `values` of `free`.
fn machine((curve, mut machine): (usize, Machine), (free, values): Values<'_>) -> Machine {
    for (parameter, &value) in free.iter().zip(values).filter(|(free, _)| free.applies_to(curve)) {
        match parameter.role {
            Role::Compliance => machine.compliance = value,
            Role::Background => machine.background = value,
            Role::Offset => machine.offset = value,
            Role::Trend => machine.trend = value,
            Role::Origin => machine.origin = value,
            Role::Contacts | Role::Reading | Role::DriftAmplitude | Role::DriftLength => {}
        }
    }
    machine
}
