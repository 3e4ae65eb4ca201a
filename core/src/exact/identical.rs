//! Identical thresholds: the singular periodic solution.

use super::{ClosedForm, positive};
use crate::Result;

/// P_c = δ(x − x_s), R = δ: every stretch is (y + X) mod x_s for ever, and nothing relaxes.
///
/// Limit: the force jumps down by x_s at multiples of x_s, where it is the value after the break.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identical {
    /// x_s > 0, the threshold.
    pub threshold: f64,
}

impl Identical {
    /// The stretch at X of a contact that was at `initial` < x_s at X = 0; hence
    /// Q(x; X) = Q_ini((x − X) mod x_s).
    #[must_use]
    pub fn stretch(&self, initial: f64, position: f64) -> f64 {
        (initial + position).rem_euclid(self.threshold)
    }
}

impl ClosedForm for Identical {
    fn check(&self) -> Result<()> {
        positive("threshold", self.threshold).map(drop)
    }

    fn force(&self, position: f64) -> f64 {
        self.stretch(0.0, position)
    }

    fn slope(&self, _position: f64) -> f64 {
        1.0
    }

    /// The average over a period; the force itself never becomes steady.
    fn kinetic_friction(&self) -> f64 {
        0.5 * self.threshold
    }

    /// At the first break, the left limit.
    fn static_friction(&self) -> Option<(f64, f64)> {
        Some((self.threshold, self.threshold))
    }

    fn critical_stiffness(&self) -> f64 {
        f64::INFINITY
    }
}
