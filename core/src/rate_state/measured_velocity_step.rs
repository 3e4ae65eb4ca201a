//! Rate-and-state parameters of a measured velocity step, with errors from its drift and white noise.

use serde::{Deserialize, Serialize};

use super::drift::MeasuredNoise;
use super::generalised::{GeneralisedFit, ScaledCurve};
use super::velocity_step::{FEWEST, scales};
use super::{MeasuredValue, OrnsteinUhlenbeck};
use crate::error::{all_finite, as_many, finite};
use crate::monitor::Monitor;
use crate::numerics::ljung_box::ljung_box;
use crate::{Error, Result};

/// Smallest number of points before the step.
const FEWEST_BEFORE: usize = 4;
/// Points over which the force is averaged to find its extremum.
const SMOOTHED: usize = 5;
/// Largest number of lags in the test of whiteness.
const LAGS: usize = 20;
/// Below this probability the residuals are not of the kind of noise that is described.
const UNLIKELY: f64 = 1e-3;

/// How a measured velocity step is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepReading {
    /// The force F₀ before the step, if it is known. Otherwise it is fitted to the points before the step.
    pub before: Option<f64>,
    /// X_p, from which on the force relaxes, relative to the step. Otherwise it is the extremum of the force, averaged over five
    /// points, if it stands out from its scatter in the last quarter, or where the force first reaches its level there; 0 if that
    /// is not in the first half.
    pub peak: Option<f64>,
    /// Whether the force also has a constant slope, before the step and after it.
    pub trend: bool,
    /// Whether the noise has drift besides its white part.
    pub drift: bool,
    /// Successive points that are averaged before the fit.
    pub average: usize,
}

impl Default for StepReading {
    fn default() -> Self {
        Self { before: None, peak: None, trend: false, drift: true, average: 1 }
    }
}

/// Rate-and-state parameters of a measured velocity step; forces in the unit of the curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MeasuredVelocityStep {
    /// v/v₀.
    pub ratio: f64,
    /// Direct effect a, for the position X_p of the peak.
    pub direct: MeasuredValue,
    /// Evolution effect b, for the position X_p of the peak.
    pub evolution: MeasuredValue,
    /// a − b, the change of the steady force per ln(v/v₀).
    pub steady: MeasuredValue,
    /// Critical slip distance D_c, a length.
    pub distance: MeasuredValue,
    /// F₀, the force before the step.
    pub before: MeasuredValue,
    /// The slope of the force, if it is fitted, a force per length.
    pub trend: Option<MeasuredValue>,
    /// X_p, relative to the step.
    pub peak: f64,
    /// Root-mean-square residual of the fit, a force.
    pub residual: f64,
    /// The noise.
    pub noise: MeasuredNoise,
    /// Probability that white noise has correlations as large as those of the whitened residuals (G. M. Ljung
    /// and G. E. P. Box, Biometrika 65, 297 (1978)). Far below 0.01 the noise is not of the kind described;
    /// `None` for too few points, and if all residuals are 0.
    pub whiteness: Option<f64>,
    /// The positions that were fitted, averaged.
    pub position: Vec<f64>,
    /// The forces there.
    pub force: Vec<f64>,
    /// The positions that were not fitted, averaged: those between the step and X_p, and those before it where F₀ is given.
    pub unused_position: Vec<f64>,
    /// The forces there.
    pub unused_force: Vec<f64>,
}

impl MeasuredVelocityStep {
    /// Reads the step by the factor `ratio` of the velocity from `force` at `position`, relative to the step.
    ///
    /// Generalised least squares of
    ///
    /// F(X) = F₀ + c X + H(X − X_p) ln(v/v₀) \[a − b (1 − e^{−(X − X_p)/D_c})\],
    ///
    /// with H = 1 from X_p on and 0 before. The points between the step and X_p are left out. The covariance
    /// of the noise is estimated from the residuals ([`MeasuredNoise`]). c = 0 without `reading.trend`.
    ///
    /// The stiffness of the machine is not described: a and b hold for X_p and change by b (1 − e^{−ΔX/D_c})
    /// if it is moved by ΔX, which no error contains. D_c and a − b do not depend on it.
    ///
    /// # Errors
    /// Positions that do not rise, too few points, other invalid numbers; a curve that does not determine the
    /// parameters; a stop by the monitor.
    pub fn read(
        position: &[f64],
        force: &[f64],
        ratio: f64,
        reading: &StepReading,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        check(position, force, ratio, reading)?;
        let selected = Selected::new(position, force, ratio, reading)?;
        selected.fit(ratio, reading, monitor)
    }

    /// Sentences about numbers that are not to be trusted, or do not mean what they seem to.
    pub fn warnings(&self) -> Vec<String> {
        let mut found = Vec::new();
        if self.whiteness.is_some_and(|whiteness| whiteness < UNLIKELY) {
            found.push("errors are not reliable: the noise is not of this kind".into());
        }
        let reach = self.position.last().zip(self.position.first()).map_or(0.0, |(last, first)| last - first);
        let lasts = |drift: &OrnsteinUhlenbeck| drift.length > reach && drift.std > self.noise.white;
        if self.trend.is_none() && self.noise.drift.iter().any(lasts) {
            found.push("the drift is longer than the record: a fit with a trend may describe it".into());
        }
        if self.peak > self.distance.value {
            found.push(format!(
                "X_p is {:.1} D_c after the step: a and b hold there; a fit behind the spring of the machine gives those at the step",
                self.peak / self.distance.value
            ));
        } else if self.direct.high.is_some_and(|high| high < 0.0) {
            found.push("the direct effect a is negative: the ratio must be the velocity after the step over that before".into());
        }
        found
    }

    /// The fitted force at a position relative to the step; between the step and X_p that of X_p.
    pub fn force_at(&self, position: f64) -> f64 {
        let trend = self.trend.map_or(0.0, |trend| trend.value);
        let level = self.before.value + trend * position;
        if position < 0.0 {
            return level;
        }
        let fallen = -(-(position - self.peak).max(0.0) / self.distance.value).exp_m1();
        level + self.ratio.ln() * (self.direct.value - self.evolution.value * fallen)
    }
}

/// The points of a fit.
struct Selected {
    position: Vec<f64>,
    /// The positions of which each is the mean: the mean force is that of the curve at these.
    members: Vec<Vec<f64>>,
    force: Vec<f64>,
    peak: f64,
    /// Positions and forces that are not fitted.
    unused: [Vec<f64>; 2],
}

impl Selected {
    fn new(position: &[f64], force: &[f64], ratio: f64, reading: &StepReading) -> Result<Self> {
        let step = position.iter().position(|x| *x >= 0.0).unwrap_or(position.len());
        let before = position[..step].len() % reading.average;
        let means = |values: &[f64], from: usize, to: usize| averaged(&values[from..to], reading.average);
        let end = position.len();
        let after = (means(position, step, end), means(force, step, end));
        let groups =
            |from: usize, to: usize| position[from..to].chunks_exact(reading.average).map(<[f64]>::to_vec);
        let (groups_before, groups_after) = (groups(before, step), groups(step, end));
        let before = (means(position, before, step), means(force, before, step));
        rising("position", &[before.0.as_slice(), after.0.as_slice()].concat())?;
        let peak = match reading.peak {
            Some(peak) => peak,
            None => start_of_relaxation(&after.0, &after.1, ratio.ln().signum())?,
        };
        let first = after.0.partition_point(|x| *x < peak);
        let rest = after.0.len() - first;
        if rest < FEWEST {
            let expected = format!("at least {FEWEST} points from the peak of the force on");
            return Err(Error::invalid("position", expected, rest));
        }
        // With a known F₀ only what follows the step is fitted.
        let unused = if reading.before.is_some() { before.0.len() } else { 0 };
        if reading.before.is_none() && before.0.len() < FEWEST_BEFORE {
            let expected = format!(
                "at least {FEWEST_BEFORE} points before the step, at negative positions, or `before`"
            );
            return Err(Error::invalid("position", expected, before.0.len()));
        }
        Ok(Self {
            position: [&before.0[unused..], &after.0[first..]].concat(),
            members: groups_before.skip(unused).chain(groups_after.skip(first)).collect(),
            force: [&before.1[unused..], &after.1[first..]].concat(),
            peak,
            unused: [
                [&before.0[..unused], &after.0[..first]].concat(),
                [&before.1[..unused], &after.1[..first]].concat(),
            ],
        })
    }

    /// 1 − e^{−(X − X_p)/D_c} from X_p on; `None` before the step.
    fn fallen(&self, distance: f64) -> impl Iterator<Item = Option<f64>> + '_ {
        self.after_step(move |past| -(-past / distance).exp_m1())
    }

    /// The means over members of a function of X − X_p, which is at least 0; `None` before the step.
    fn after_step(&self, of: impl Fn(f64) -> f64) -> impl Iterator<Item = Option<f64>> {
        let mean = move |(x, members): (&f64, &Vec<f64>)| {
            let sum = || members.iter().map(|x| of((x - self.peak).max(0.0))).sum::<f64>();
            (*x >= 0.0).then(|| sum() / members.len() as f64)
        };
        self.position.iter().zip(&self.members).map(mean)
    }

    fn columns(&self, distance: f64, size: f64, reading: &StepReading) -> Vec<Vec<f64>> {
        let mut columns = Vec::new();
        if reading.before.is_none() {
            columns.push(vec![1.0; self.position.len()]);
        }
        columns.push(self.fallen(distance).map(|fallen| fallen.map_or(0.0, |_| size)).collect());
        columns
            .push(self.fallen(distance).map(|fallen| fallen.map_or(0.0, |fallen| -size * fallen)).collect());
        if reading.trend {
            columns.push(self.position.clone());
        }
        columns
    }

    fn fit(
        self,
        ratio: f64,
        reading: &StepReading,
        monitor: &mut dyn Monitor,
    ) -> Result<MeasuredVelocityStep> {
        let size = ratio.ln();
        // Place of a among the coefficients; b is the next.
        let direct = usize::from(reading.before.is_none());
        let level = reading.before.unwrap_or(0.0);
        let values: Vec<f64> = self.force.iter().map(|force| force - level).collect();
        let columns = |distance: f64| self.columns(distance, size, reading);
        let by_distance = |distance: f64, coefficients: &[f64]| -> Vec<f64> {
            let front = coefficients[direct + 1] * size / distance;
            let slope = move |past: f64| front * past / distance * (-past / distance).exp();
            self.after_step(slope).map(Option::unwrap_or_default).collect()
        };
        let curve = ScaledCurve {
            position: &self.position,
            values: &values,
            columns: &columns,
            by_scale: &by_distance,
            scales: scales(self.position[self.position.len() - 1] - self.peak),
        };
        let fit = GeneralisedFit::new(&curve, reading.drift, monitor)?.ok_or_else(undetermined)?;
        let known = |value: f64| MeasuredValue { value, error: 0.0, low: Some(value), high: Some(value) };
        let count = fit.coefficients.len();
        let difference: Vec<f64> =
            (0..count).map(|i| f64::from(i == direct) - f64::from(i == direct + 1)).collect();
        let noise = fit.measured_noise();
        let [unused_position, unused_force] = self.unused.clone();
        Ok(MeasuredVelocityStep {
            ratio,
            direct: fit.coefficient(direct),
            evolution: fit.coefficient(direct + 1),
            steady: fit.value(&|_| (difference.clone(), vec![0.0; count])),
            distance: fit.scale_value(),
            before: reading.before.map_or_else(|| fit.coefficient(0), known),
            trend: reading.trend.then(|| fit.coefficient(direct + 2)),
            peak: self.peak,
            residual: fit.residual,
            whiteness: whiteness(&fit.whitened, &noise.drift),
            noise,
            position: self.position.clone(),
            force: self.force.clone(),
            unused_position,
            unused_force,
        })
    }
}

fn undetermined() -> Error {
    let expected = "a curve that determines the parameters of the step";
    Error::invalid("force", expected, "one from which they do not follow")
}

fn check(position: &[f64], force: &[f64], ratio: f64, reading: &StepReading) -> Result<()> {
    as_many("force", force.len(), (position.len(), "forces, one for each position"))?;
    all_finite("position", position)?;
    all_finite("force", force)?;
    if let Some(first) = force.first().filter(|first| force.iter().all(|force| force == *first)) {
        return Err(Error::invalid("force", "forces that change", format!("{first} alone")));
    }
    if !(ratio > 0.0 && ratio.is_finite() && ratio != 1.0) {
        return Err(Error::invalid("ratio", "a finite number above 0 other than 1", ratio));
    }
    if reading.average == 0 {
        return Err(Error::invalid("average", "a number of points, 1 or more", 0));
    }
    reading.before.map(|before| finite("before", before)).transpose()?;
    match reading.peak.filter(|peak| !(*peak >= 0.0 && peak.is_finite())) {
        Some(peak) => Err(Error::invalid("peak", "a position relative to the step, 0 or above", peak)),
        None => Ok(()),
    }
}

fn rising(key: &str, values: &[f64]) -> Result<()> {
    match values.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(i) => {
            let expected =
                format!("positions that rise, one above {}, or `average` for noisy ones", values[i]);
            Err(Error::invalid(format!("{key}.{}", i + 1), expected, values[i + 1]))
        }
        None => Ok(()),
    }
}

/// Means of `many` values at a time.
fn averaged(values: &[f64], many: usize) -> Vec<f64> {
    values.chunks_exact(many).map(|part| part.iter().sum::<f64>() / many as f64).collect()
}

/// The position from which on the force relaxes: that of the extremum of its averages over some points in the direction of the
/// change of velocity. An extremum that does not stand out from the scatter of the last quarter is one of the noise: the force then
/// relaxes from where it first reaches its level in the last quarter, but for twice the scatter. 0 if that is not in the first half:
/// a force that only rises shows no direct effect.
fn start_of_relaxation(position: &[f64], force: &[f64], side: f64) -> Result<f64> {
    /// In standard deviations, which are estimated from some ten independent averages and may be too small by a half.
    const STANDS_OUT: f64 = 6.0;
    const REACHED: f64 = 2.0;
    let near = |i: usize| {
        let half = (SMOOTHED / 2).min(i).min(force.len() - 1 - i);
        force[i - half..=i + half].iter().sum::<f64>() / (2 * half + 1) as f64
    };
    let smooth: Vec<f64> = (0..force.len()).map(near).collect();
    let last = &smooth[smooth.len() - smooth.len().div_ceil(4)..];
    let level = last.iter().sum::<f64>() / last.len() as f64;
    let scatter = (last.iter().map(|force| (force - level).powi(2)).sum::<f64>() / last.len() as f64).sqrt();
    let above: Vec<f64> = smooth.iter().map(|force| side * (force - level)).collect();
    let none = || Error::invalid("position", "points after the step, at positions of 0 and above", "none");
    let extremum = (0..above.len()).max_by(|&i, &j| above[i].total_cmp(&above[j])).ok_or_else(none)?;
    let reached = above.iter().position(|above| *above >= -REACHED * scatter);
    let start = if above[extremum] > STANDS_OUT * scatter { extremum } else { reached.unwrap_or(extremum) };
    let is_early = start > 0 && 2 * start < force.len() && force.len() - start >= FEWEST;
    Ok(if is_early { position[start] } else { 0.0 })
}

/// The test of Ljung and Box on whitened residuals.
fn whiteness(whitened: &[f64], drift: &[OrnsteinUhlenbeck]) -> Option<f64> {
    let lags = LAGS.min(whitened.len() / 5);
    // Each process has two parameters that were fitted to the correlations.
    let freedom = lags.checked_sub(2 * drift.len()).filter(|&freedom| freedom > 0)?;
    ljung_box(&[whitened], lags, freedom)
}
