//! Contacts that share one distribution of thresholds, P_c(x; t) (`ageing.mean_field`): a cohort has a surviving fraction only.
//!
//! In a motion by dX it loses the fraction P dX, P = P_c(x; t)/S(x; t), where its stretch exceeds all that it has had. With
//! Λ = −ln S the loss along x(t) is ∫P dx = Λ(x, t) between the ends − ∫∂_tΛ dt, of which only the last term, small within
//! a step, is a quadrature: densities that are steep, or jump, do not matter.

use serde::{Deserialize, Serialize};

use super::path::{GAUSS, Path, Place, StepPart};
use crate::contacts::ThresholdDensity;

/// What is left of a cohort.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct SurvivingFraction {
    left: f64,
    /// The largest |stretch| so far.
    met: f64,
}

/// P_c in a step: Λ is a parabola in time through its start, middle and end.
#[derive(Debug)]
pub(super) struct StepThresholds {
    duration: f64,
    at: [ThresholdDensity; 3],
    /// The stretch below which no contact breaks.
    certain: f64,
}

/// Fraction of thresholds that is neglected below a stretch, in units of the tolerance.
const NEGLIGIBLE: f64 = 1e-6;

impl SurvivingFraction {
    /// Contacts that form at a stretch, all of which hold.
    pub(super) fn fresh(stretch: f64) -> Self {
        Self { left: 1.0, met: stretch.abs() }
    }

    /// The surviving fraction.
    pub(super) fn left(self) -> f64 {
        self.left
    }

    /// Advances in time from `place`.
    pub(super) fn advance(&mut self, place: Place, path: &Path, part: StepPart, thresholds: &StepThresholds) {
        let (from, to) = part.ends();
        let by = path.advance(from, to);
        let start = by.signum() * place.stretch;
        let end = start + by.abs();
        if by == 0.0 || end <= self.met {
            return;
        }
        let first = start.max(self.met);
        let begun = from + (to - from) * (first - start) / (end - start);
        let now = |s: f64| s * path.duration / thresholds.duration;
        self.left *= (-thresholds.hazard((first, now(begun)), (end, now(to)))).exp();
        self.met = end;
    }

    /// How far apart two groups of contacts break if they have one stretch.
    pub(super) fn distance(self, other: Self) -> f64 {
        (self.met - other.met).abs()
    }

    /// Two groups of contacts as one, `part` of which are of the second.
    pub(super) fn merged(self, other: Self, part: f64) -> Self {
        let between = |a: f64, b: f64| a + part * (b - a);
        Self { left: between(self.left, other.left), met: between(self.met, other.met) }
    }
}

impl StepThresholds {
    /// From the distributions at the start, the middle and the end of a step.
    pub(super) fn new(duration: f64, at: [ThresholdDensity; 3], tolerance: f64) -> Self {
        let certain = at.iter().map(|density| density.certain(NEGLIGIBLE * tolerance));
        Self { duration, certain: certain.fold(f64::INFINITY, f64::min), at }
    }

    /// A distribution that does not change.
    pub(super) fn steady(density: &ThresholdDensity, tolerance: f64) -> Self {
        Self::new(1.0, std::array::from_fn(|_| density.clone()), tolerance)
    }

    /// ∫P dx between two stretches at two fractions of the step, along a straight line.
    fn hazard(&self, (low, from): (f64, f64), (high, to): (f64, f64)) -> f64 {
        if high <= self.certain {
            return 0.0;
        }
        let drift = |g: f64| self.sum(low + g * (high - low), slopes(from + g * (to - from)));
        let drifted = 0.5 * (to - from) * (drift(GAUSS[0]) + drift(GAUSS[1]));
        (self.sum(high, weights(to)) - self.sum(low, weights(from)) - drifted).max(0.0)
    }

    /// Λ at the three times, with weights.
    fn sum(&self, x: f64, weights: [f64; 3]) -> f64 {
        let term = |(density, weight): (&ThresholdDensity, f64)| {
            if weight == 0.0 { 0.0 } else { weight * density.cumulative_hazard(x) }
        };
        self.at.iter().zip(weights).map(term).sum()
    }

    /// By how much the distribution at a quarter of the step is not that of the parabola in time through the others.
    pub(super) fn missed(&self, quarter: &ThresholdDensity) -> f64 {
        quarter.distance(&self.at, weights(0.25))
    }
}

/// Weights of the values at the start, the middle and the end of a step in the parabola through them.
fn weights(s: f64) -> [f64; 3] {
    [(1.0 - s) * (1.0 - 2.0 * s), 4.0 * s * (1.0 - s), s * (2.0 * s - 1.0)]
}

/// Their slopes.
fn slopes(s: f64) -> [f64; 3] {
    [4.0 * s - 3.0, 4.0 - 8.0 * s, 4.0 * s - 1.0]
}
