//! First values far from the data: the factor of all lengths of the thresholds with which the first curve is most like the
//! measured ones.

use super::free::{FreeParameter, Role};
use super::likelihood::Likelihood;
use super::{Fit, Measurement};
use crate::master::Pull;
use crate::monitor::{Monitor, Part};
use crate::{Error, Result};

/// Largest factor that is tried, and its inverse the smallest; number of factors between it and 1.
const LARGEST: f64 = 8.0;
const FACTORS: i32 = 40;
/// Factors nearer to 1 are left to the search.
const NEAR: f64 = 1.5;
/// Part of the squared residuals at the first values that a factor has to leave at most.
const BETTER: f64 = 0.5;
/// Readings of a curve that are enough to compare it.
const ENOUGH: usize = 200;
/// Error of F/(N_c⟨k⟩) aimed at, relative to the mean threshold: the search begins anew.
const TOLERANCE: f64 = 1e-4;
/// Numbers of distributions that are lengths.
const LENGTHS: [&str; 5] = ["mean", "std", "min", "max", "scale"];

/// A factor of lengths, with the factor of the force of each curve, which changes with it, and what is left of the curves.
struct ScaledLengths {
    length: f64,
    forces: Vec<f64>,
    /// Whether the number of contacts is free to change the force, or only their stiffness.
    counts: bool,
    squares: f64,
}

impl Fit {
    /// The first coordinates, and the number of solutions that they took: those given, or, if this makes the curves more probable,
    /// with all lengths of the thresholds multiplied by one factor.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub(super) fn first_values(
        &self,
        white: &Likelihood,
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, usize)> {
        let free = &white.free;
        let given: Vec<f64> = free.iter().map(|parameter| parameter.coordinate(parameter.start)).collect();
        if !free.iter().any(is_length) {
            return Ok((given, 0));
        }
        let farthest = self.curves.iter().flat_map(slider).fold(0.0, f64::max);
        let part = &mut Part::new(monitor, 0.0, 0.5);
        let pull = match self.equation.pull_with(LARGEST * farthest.max(f64::MIN_POSITIVE), TOLERANCE, part) {
            Err(Error::Stopped) => return Err(Error::Stopped),
            Err(_) => return Ok((given, 1)),
            Ok(pull) => pull,
        };
        let thinned = |curve: &Measurement| curve.thinned((curve.positions.len() / ENOUGH).max(1));
        let fewer = Self { curves: self.curves.iter().map(thinned).collect(), ..self.clone() };
        let Some(scaled) = fewer.most_alike(free, &pull) else { return Ok((given, 1)) };
        let moved: Vec<f64> =
            free.iter().map(|parameter| parameter.coordinate(scaled.of(parameter))).collect();
        let mut deviance = |coordinates: &[f64], start: f64| -> Result<f64> {
            let trial = white.trial(coordinates, &mut Part::new(monitor, start, 0.25))?;
            Ok(trial.map_or(f64::INFINITY, |trial| trial.deviance))
        };
        let better = deviance(&moved, 0.5)? < deviance(&given, 0.75)?;
        Ok((if better { moved } else { given }, 3))
    }

    /// The factor that leaves least of the curves; `None` where it is near 1, or leaves hardly less than 1 does.
    fn most_alike(&self, free: &[FreeParameter], pull: &Pull) -> Option<ScaledLengths> {
        let factor = |i: i32| LARGEST.powf(f64::from(i) / f64::from(FACTORS));
        let tried = (-FACTORS..=FACTORS).filter_map(|i| self.scaled(free, pull, factor(i)));
        let best = tried.min_by(|a, b| a.squares.total_cmp(&b.squares))?;
        let given = self.scaled(free, pull, 1.0)?.squares;
        let is_far = best.length.max(1.0 / best.length) > NEAR;
        (is_far && best.squares < BETTER * given).then_some(best)
    }

    /// What the first curve with lengths times `length` leaves of the measured ones, F(X) = f s F₁(X/s) with the factor f of
    /// each curve that leaves least, if count or stiffness is free; the same for offset and trend.
    fn scaled(&self, free: &[FreeParameter], pull: &Pull, length: f64) -> Option<ScaledLengths> {
        let counts = free.iter().any(|parameter| parameter.quantity == "count");
        let mut all = ScaledLengths { length, forces: Vec::new(), counts, squares: 0.0 };
        for (c, curve) in self.curves.iter().enumerate() {
            let is_free =
                |names: &[&str]| free.iter().any(|p| p.applies_to(c) && names.contains(&p.quantity.as_str()));
            let (factor, squares) = scaled_curve(curve, is_free, |x| length * pull.force(x / length))?;
            all.squares += squares;
            all.forces.push(factor);
        }
        Some(all)
    }
}

/// The factor of the expected `force` at X that leaves least of a curve, beside offset and trend if these are free, and the sum of
/// squares that it leaves; `None` for a factor that is not above 0.
fn scaled_curve(
    curve: &Measurement,
    is_free: impl Fn(&[&str]) -> bool,
    force: impl Fn(f64) -> f64,
) -> Option<(f64, f64)> {
    let machine = curve.machine;
    let mut expected: Vec<f64> = slider(curve).map(|x| force(x.max(0.0))).collect();
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

/// Positions X of the slider at the readings of a curve, from the measured forces.
fn slider(curve: &Measurement) -> impl Iterator<Item = f64> {
    let machine = curve.machine;
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
