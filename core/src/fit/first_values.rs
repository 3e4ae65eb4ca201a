//! First values far from the data: factors of all lengths of the thresholds, and compliances and origins where these are free, with
//! which the first curve is like the measured ones.
//!
//! Thresholds about as large as the distance of the readings may give the same forces at few readings as larger ones (aliasing).
//! So the search begins at each of several first values, the given ones among them, and the most probable result is kept. Where
//! thresholds are narrower than the readings are apart, most of them break between two readings, and the curve hardly depends on
//! them: there the search begins at wider ones, too.

use super::free::{FreeParameter, Role, first_coordinates};
use super::likelihood::Likelihood;
use super::{Fit, Machine, Measurement};
use crate::contacts::Stiffness;
use crate::master::Pull;
use crate::monitor::{Monitor, Part};
use crate::numerics::order::sort_by_number;
use crate::{Error, Result};

/// Largest factor that is tried, and its inverse the smallest; number of factors between it and 1.
const LARGEST: f64 = 8.0;
const FACTORS: i32 = 40;
/// Free compliances that are tried, in multiples of the largest one: that behind which contacts that do not give at all would show
/// the steepest slope of the curves.
const COMPLIANCES: [f64; 3] = [0.5, 0.25, 0.125];
/// Another machine is preferred to the given one unless it leaves this many times as much: from a compliance that is too small the
/// search goes a long way in small steps, as contacts of larger thresholds behind a stiffer machine make nearly the same curve.
const PREFERRED: f64 = 4.0;
/// Factors nearer to 1 are left to the search.
const NEAR: f64 = 1.5;
/// Part of the squared residuals at the first values that a factor has to leave at most.
const BETTER: f64 = 0.5;
/// Most first values with other lengths.
const MOST: usize = 3;
/// Readings of a curve that are enough to compare it.
const ENOUGH: usize = 200;
/// Error of F/(N_c⟨k⟩) aimed at, relative to the mean threshold: the search begins anew.
const TOLERANCE: f64 = 1e-4;
/// Numbers of distributions that are lengths.
const LENGTHS: [&str; 5] = ["mean", "std", "min", "max", "scale"];

/// What is tried of machines.
#[derive(Clone, Copy, PartialEq)]
struct TriedMachine {
    /// A free compliance, if it is not the given one.
    compliance: Option<f64>,
    /// Whether a curve with a free origin begins where its steepest tangent meets the zero of the force, not at the given origin.
    by_tangent: bool,
}

/// The machine that is given.
const GIVEN: TriedMachine = TriedMachine { compliance: None, by_tangent: false };

/// A factor of lengths, and what is tried of machines, with the factor of the force of each curve, which changes with them, and what
/// is left of the curves.
struct ScaledLengths {
    length: f64,
    tried: TriedMachine,
    /// The origin of each curve.
    origins: Vec<f64>,
    forces: Vec<f64>,
    /// Whether the number of contacts is free to change the force, or only their stiffness.
    counts: bool,
    squares: f64,
}

impl Fit {
    /// The coordinates from which to search, and the number of solutions that they took: those given, and those that make the
    /// curves more probable with all lengths of the thresholds multiplied by one factor, and another compliance and origin if they
    /// are free; each also with wider thresholds, if these are narrower than the readings are apart.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub(super) fn first_values(
        &self,
        white: &Likelihood,
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<Vec<f64>>, usize)> {
        let (mut starts, tried) = self.scaled_values(white, monitor)?;
        let wide: Vec<Vec<f64>> =
            starts.iter().filter_map(|start| self.widened(&white.free, start)).collect();
        starts.extend(wide);
        Ok((starts, tried))
    }

    /// The same coordinates with thresholds as wide as the readings are apart, if they are narrower.
    fn widened(&self, free: &[FreeParameter], start: &[f64]) -> Option<Vec<f64>> {
        let spacing = self.curves.iter().map(Measurement::spacing).fold(f64::INFINITY, f64::min);
        let std = free.iter().position(|parameter| parameter.name == "thresholds.std")?;
        let wide = free[std].coordinate(spacing);
        (start[std] < wide).then(|| {
            let mut start = start.to_vec();
            start[std] = wide;
            start
        })
    }

    /// The given values, and those with other lengths, and the number of solutions that they took.
    fn scaled_values(&self, white: &Likelihood, monitor: &mut dyn Monitor) -> Result<(Vec<Vec<f64>>, usize)> {
        let free = &white.free;
        let given = first_coordinates(free);
        if !free.iter().any(is_length) {
            return Ok((vec![given], 0));
        }
        let machines = self.machines(free);
        let farthest = machines.iter().flat_map(|&tried| {
            let numbered = self.curves.iter().enumerate();
            numbered.flat_map(move |(c, curve)| slider(curve, tried.of_curve((c, curve), free)))
        });
        let farthest = farthest.fold(0.0, f64::max);
        let part = &mut Part::new(monitor, 0.0, 0.5);
        let pull = match self.equation.pull_with(LARGEST * farthest.max(f64::MIN_POSITIVE), TOLERANCE, part) {
            Err(Error::Stopped) => return Err(Error::Stopped),
            Err(_) => return Ok((vec![given], 1)),
            Ok(pull) => pull,
        };
        let thinned = |curve: &Measurement| curve.thinned((curve.positions.len() / ENOUGH).max(1));
        let fewer = Self { curves: self.curves.iter().map(thinned).collect(), ..self.clone() };
        let mut deviance = |coordinates: &[f64]| -> Result<f64> {
            let trial = white.trial(coordinates, &mut Part::new(monitor, 0.5, 0.5))?;
            Ok(trial.map_or(f64::INFINITY, |trial| trial.deviance))
        };
        let alike = fewer.most_alike(free, &pull, &machines);
        if alike.is_empty() {
            return Ok((vec![given], 1));
        }
        let (of_given, tried) = (deviance(&given)?, alike.len());
        let mut starts = vec![given];
        for scaled in alike {
            let moved: Vec<f64> =
                free.iter().map(|parameter| parameter.coordinate(scaled.of(parameter))).collect();
            if deviance(&moved)? < of_given {
                starts.push(moved);
            }
        }
        Ok((starts, tried + 2))
    }

    /// The machines that are tried, the given one first; none of another compliance or origin where it is not free or without a
    /// rising curve.
    fn machines(&self, free: &[FreeParameter]) -> Vec<TriedMachine> {
        let is_free = |role: Role| free.iter().any(|parameter| parameter.role == role);
        let steepest = self.curves.iter().map(Measurement::steepest).fold(0.0, f64::max);
        if steepest == 0.0 {
            return vec![GIVEN];
        }
        let others = COMPLIANCES.iter().map(|part| Some(part / steepest));
        let compliances = std::iter::once(None).chain(others.filter(|_| is_free(Role::Compliance)));
        let origins: &[bool] = if is_free(Role::Origin) { &[false, true] } else { &[false] };
        let with_origins =
            |compliance| origins.iter().map(move |&by_tangent| TriedMachine { compliance, by_tangent });
        compliances.flat_map(with_origins).collect()
    }

    /// The factors that leave less of the curves than their neighbours, with each of these machines, in the order in which they
    /// are to be tried; none that are near what is given, or leave hardly less.
    fn most_alike(
        &self,
        free: &[FreeParameter],
        pull: &Pull,
        machines: &[TriedMachine],
    ) -> Vec<ScaledLengths> {
        let length = |i: i32| LARGEST.powf(f64::from(i) / f64::from(FACTORS));
        let given = self.scaled(free, pull, (1.0, GIVEN)).map_or(f64::INFINITY, |given| given.squares);
        let is_far =
            |scaled: &ScaledLengths| scaled.length.max(1.0 / scaled.length) > NEAR || scaled.tried != GIVEN;
        let weighted =
            |scaled: &ScaledLengths| scaled.squares * if scaled.tried == GIVEN { PREFERRED } else { 1.0 };
        let mut all = Vec::new();
        for machine in machines {
            let tried: Vec<Option<ScaledLengths>> =
                (-FACTORS..=FACTORS).map(|i| self.scaled(free, pull, (length(i), *machine))).collect();
            let squares = |i: usize| tried.get(i)?.as_ref().map(|scaled| scaled.squares);
            let is_least = |i: usize| {
                let beside = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter_map(squares);
                squares(i).is_some_and(|own| beside.fold(f64::INFINITY, f64::min) >= own)
            };
            let least: Vec<bool> = (0..tried.len()).map(is_least).collect();
            all.extend(tried.into_iter().zip(least).filter_map(|(scaled, least)| scaled.filter(|_| least)));
        }
        all.retain(|scaled| is_far(scaled) && scaled.squares < BETTER * given);
        sort_by_number(&mut all, weighted);
        all.truncate(MOST);
        all
    }

    /// What the first curve with lengths times `length`, measured by a machine that is tried in place of the given one, leaves of the
    /// measured ones, F(X) = f s F₁(X/s) with the factor f of each curve that leaves least, if count or stiffness is free; the same
    /// for offset and trend.
    fn scaled(
        &self,
        free: &[FreeParameter],
        pull: &Pull,
        (length, tried): (f64, TriedMachine),
    ) -> Option<ScaledLengths> {
        let counts = free.iter().any(|parameter| parameter.quantity == "count");
        // Contacts whose stiffness is proportional to their threshold are stiffer by the same factor.
        let power =
            if matches!(self.equation.contacts().stiffness, Stiffness::PerThreshold(_)) { 2 } else { 1 };
        let mut all =
            ScaledLengths { length, tried, origins: Vec::new(), forces: Vec::new(), counts, squares: 0.0 };
        for (c, curve) in self.curves.iter().enumerate() {
            let is_free =
                |names: &[&str]| free.iter().any(|p| p.applies_to(c) && names.contains(&p.quantity.as_str()));
            let machine = tried.of_curve((c, curve), free);
            let slider: Vec<f64> = slider(curve, machine).collect();
            let force = |x| length.powi(power) * pull.force(x / length);
            let (factor, squares) = scaled_curve((curve, &slider), is_free, force)?;
            all.squares += squares;
            all.forces.push(factor);
            all.origins.push(machine.origin);
        }
        Some(all)
    }
}

/// The factor of the expected `force` at X that leaves least of a curve, with its slider at these X, beside offset and trend if
/// these are free, and the sum of squares that it leaves; `None` for a factor that is not above 0.
fn scaled_curve(
    (curve, slider): (&Measurement, &[f64]),
    is_free: impl Fn(&[&str]) -> bool,
    force: impl Fn(f64) -> f64,
) -> Option<(f64, f64)> {
    let machine = curve.machine;
    let mut expected: Vec<f64> = slider.iter().map(|x| force(x.max(0.0))).collect();
    let level = |y: f64| machine.background + machine.offset + machine.trend * y;
    let readings = curve.forces.iter().zip(&curve.positions);
    let mut measured: Vec<f64> = readings.map(|(force, &y)| force - level(y)).collect();
    let offset = is_free(&["offset"]).then(|| vec![1.0; measured.len()]);
    let trend = is_free(&["trend"]).then(|| curve.positions.clone());
    for column in orthogonal(offset.into_iter().chain(trend).collect()) {
        remove(&column, &mut expected);
        remove(&column, &mut measured);
    }
    let scales = is_free(&["count", "stiffness", "stiffness_per_threshold"]);
    let factor = if scales { product(&expected, &measured) / product(&expected, &expected) } else { 1.0 };
    let squares = measured.iter().zip(&expected).map(|(left, own)| (left - factor * own).powi(2)).sum();
    (factor.is_finite() && factor > 0.0).then_some((factor, squares))
}

impl TriedMachine {
    /// The machine of a curve.
    fn of_curve(self, (c, curve): (usize, &Measurement), free: &[FreeParameter]) -> Machine {
        let is_free =
            |role: Role| free.iter().any(|parameter| parameter.role == role && parameter.applies_to(c));
        let given = curve.machine;
        let compliance = self.compliance.filter(|_| is_free(Role::Compliance)).unwrap_or(given.compliance);
        let tangent =
            (self.by_tangent && is_free(Role::Origin)).then(|| curve.tangent_origin(compliance)).flatten();
        Machine { compliance, origin: tangent.unwrap_or(given.origin), ..given }
    }
}

impl ScaledLengths {
    /// The first value of a number with these factors.
    fn of(&self, parameter: &FreeParameter) -> f64 {
        let mean = |of: &dyn Fn(usize) -> f64| {
            let values: Vec<f64> =
                (0..self.forces.len()).filter(|&c| parameter.applies_to(c)).map(of).collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        let of_force = || mean(&|c| self.forces[c].ln()).exp();
        match parameter.quantity.as_str() {
            "count" => parameter.start * of_force(),
            "stiffness" | "stiffness_per_threshold" if !self.counts => parameter.start * of_force(),
            "compliance" => self.tried.compliance.unwrap_or(parameter.start),
            "origin" if self.tried.by_tangent => mean(&|c| self.origins[c]),
            _ if is_length(parameter) => parameter.start * self.length,
            _ => parameter.start,
        }
    }
}

/// Whether a number is a length of the thresholds.
fn is_length(parameter: &FreeParameter) -> bool {
    let name = parameter.quantity.strip_prefix("thresholds.").and_then(|name| name.rsplit('.').next());
    parameter.role == Role::Contacts && name.is_some_and(|name| LENGTHS.contains(&name))
}

/// Positions X of the slider at the readings of a curve from this machine, from the measured forces.
fn slider(curve: &Measurement, machine: Machine) -> impl Iterator<Item = f64> {
    let readings = curve.positions.iter().zip(&curve.forces);
    readings.map(move |(y, force)| {
        y - machine.origin - machine.compliance * (force - machine.offset - machine.trend * y)
    })
}

/// Columns that span the same and are orthogonal to each other.
fn orthogonal(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut all: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        all.iter().for_each(|other| remove(other, &mut column));
        all.push(column);
    }
    all
}

/// Makes a column orthogonal to another one.
fn remove(other: &[f64], column: &mut [f64]) {
    let share = product(other, column) / product(other, other);
    column.iter_mut().zip(other).for_each(|(value, other)| *value -= share * other);
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
