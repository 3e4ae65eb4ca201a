//! First values far from the data: factors of all lengths of the thresholds, and compliances where one is free, with which the
//! first curve is like the measured ones.
//!
//! Thresholds about as large as the distance of the readings may give the same forces at few readings as larger ones (aliasing).
//! So the search begins at each of several first values, the given ones among them, and the most probable result is kept. Where
//! thresholds are narrower than the readings are apart, most of them break between two readings, and the curve hardly depends on
//! them: there the search begins at wider ones, too.

use super::free::{FreeParameter, Role};
use super::likelihood::Likelihood;
use super::{Fit, Measurement};
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
/// One of these is preferred to the given compliance unless it leaves this many times as much: from a compliance that is too small
/// the search goes a long way in small steps, as contacts of larger thresholds behind a stiffer machine make nearly the same curve.
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

/// A factor of lengths, and a free compliance if it is not the given one, with the factor of the force of each curve, which changes
/// with them, and what is left of the curves.
struct ScaledLengths {
    length: f64,
    compliance: Option<f64>,
    forces: Vec<f64>,
    /// Whether the number of contacts is free to change the force, or only their stiffness.
    counts: bool,
    squares: f64,
}

impl Fit {
    /// The coordinates from which to search, and the number of solutions that they took: those given, and those that make the
    /// curves more probable with all lengths of the thresholds multiplied by one factor, and another compliance if it is free; each
    /// also with wider thresholds, if these are narrower than the readings are apart.
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
        let given: Vec<f64> = free.iter().map(|parameter| parameter.coordinate(parameter.start)).collect();
        if !free.iter().any(is_length) {
            return Ok((vec![given], 0));
        }
        let compliances = self.compliances(free);
        let least = compliances.iter().flatten().copied().fold(f64::INFINITY, f64::min);
        let positions =
            self.curves.iter().flat_map(|curve| slider(curve, curve.machine.compliance.min(least)));
        let farthest = positions.fold(0.0, f64::max);
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
        let alike = fewer.most_alike(free, &pull, &compliances);
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

    /// The free compliances that are tried, the given one, `None`, first; nothing else where none is free or without a rising
    /// curve.
    fn compliances(&self, free: &[FreeParameter]) -> Vec<Option<f64>> {
        let is_free = free.iter().any(|parameter| parameter.role == Role::Compliance);
        let largest = self.curves.iter().map(Measurement::steepest).fold(0.0, f64::max).recip();
        let others = COMPLIANCES.iter().map(|part| Some(part * largest));
        std::iter::once(None).chain(others.filter(|_| is_free && largest.is_finite())).collect()
    }

    /// The factors that leave less of the curves than their neighbours, with each of these compliances, in the order in which they
    /// are to be tried; none that are near what is given, or leave hardly less.
    fn most_alike(
        &self,
        free: &[FreeParameter],
        pull: &Pull,
        compliances: &[Option<f64>],
    ) -> Vec<ScaledLengths> {
        let length = |i: i32| LARGEST.powf(f64::from(i) / f64::from(FACTORS));
        let given = self.scaled(free, pull, (1.0, None)).map_or(f64::INFINITY, |given| given.squares);
        let is_far = |scaled: &ScaledLengths| {
            scaled.length.max(1.0 / scaled.length) > NEAR || scaled.compliance.is_some()
        };
        let weighted = |scaled: &ScaledLengths| {
            scaled.squares * if scaled.compliance.is_none() { PREFERRED } else { 1.0 }
        };
        let mut all = Vec::new();
        for compliance in compliances {
            let tried: Vec<Option<ScaledLengths>> =
                (-FACTORS..=FACTORS).map(|i| self.scaled(free, pull, (length(i), *compliance))).collect();
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

    /// What the first curve with lengths times `length`, behind a free `compliance` in place of the given one, leaves of the measured
    /// ones, F(X) = f s F₁(X/s) with the factor f of each curve that leaves least, if count or stiffness is free; the same for
    /// offset and trend.
    fn scaled(
        &self,
        free: &[FreeParameter],
        pull: &Pull,
        (length, compliance): (f64, Option<f64>),
    ) -> Option<ScaledLengths> {
        let counts = free.iter().any(|parameter| parameter.quantity == "count");
        let mut all = ScaledLengths { length, compliance, forces: Vec::new(), counts, squares: 0.0 };
        for (c, curve) in self.curves.iter().enumerate() {
            let is_free =
                |names: &[&str]| free.iter().any(|p| p.applies_to(c) && names.contains(&p.quantity.as_str()));
            let other = compliance.filter(|_| is_free(&["compliance"]));
            let slider: Vec<f64> = slider(curve, other.unwrap_or(curve.machine.compliance)).collect();
            let force = |x| length * pull.force(x / length);
            let (factor, squares) = scaled_curve((curve, &slider), is_free, force)?;
            all.squares += squares;
            all.forces.push(factor);
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
    let scales = is_free(&["count", "stiffness"]);
    let factor = if scales { product(&expected, &measured) / product(&expected, &expected) } else { 1.0 };
    let squares = measured.iter().zip(&expected).map(|(left, own)| (left - factor * own).powi(2)).sum();
    (factor.is_finite() && factor > 0.0).then_some((factor, squares))
}

impl ScaledLengths {
    /// The first value of a number with these factors.
    fn of(&self, parameter: &FreeParameter) -> f64 {
        let of_force = || {
            let curves = (0..self.forces.len()).filter(|&c| parameter.applies_to(c));
            let logarithms: Vec<f64> = curves.map(|c| self.forces[c].ln()).collect();
            (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp()
        };
        match parameter.quantity.as_str() {
            "count" => parameter.start * of_force(),
            "stiffness" if !self.counts => parameter.start * of_force(),
            "compliance" => self.compliance.unwrap_or(parameter.start),
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

/// Positions X of the slider at the readings of a curve behind a machine of this compliance, from the measured forces.
fn slider(curve: &Measurement, compliance: f64) -> impl Iterator<Item = f64> {
    let machine = curve.machine;
    let readings = curve.positions.iter().zip(&curve.forces);
    readings
        .map(move |(y, force)| y - machine.origin - compliance * (force - machine.offset - machine.trend * y))
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
