//! Temperature: thermally activated breaking below the threshold.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{Error, Result};

/// The energy barrier ΔE of a contact of stretch x below its threshold x_s. Its height at x = 0 is E_0 = ½k x_s².
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Barrier {
    /// ΔE = ½k(x_s² − x²): the missing elastic energy.
    #[default]
    Elastic,
    /// ΔE = E_0(1 − x/x_s) (G. I. Bell, Science 200, 618 (1978)).
    Bell,
    /// ΔE = E_0(1 − x/x_s)^{3/2}: a minimum and a maximum that merge, as in every fold catastrophe.
    Catastrophe,
}

/// Which contacts break thermally: those with low barriers, or any.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Hazard {
    /// Each contact breaks at the rate w(x; x_s) of its own threshold, for as long as it holds: weak contacts break first, and
    /// strong ones remain.
    #[default]
    Joint,
    /// All contacts of one stretch break thermally at one rate, that of the average contact, r_T(x) = ⟨w(x; x_s) | x_s > x⟩, which
    /// is added to the athermal hazard: P(x) + r_T(x)/v (O. M. Braun and M. Peyrard, Phys. Rev. E 82, 036117 (2010)).
    Additive,
}

/// Thermal breaking at the rate w = ω e^{−ΔE/T} below the threshold, and at once at the threshold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Temperature {
    /// T, the temperature as an energy (force times length), above 0; contacts then also break below their thresholds, at
    /// the rate ω e^{−ΔE/T}.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force*length"))]
    pub energy: f64,
    /// Attempt rate ω, per time, above 0.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "1/time"))]
    pub attempt_rate: f64,
    /// The barrier ΔE: `"elastic"`, `"bell"` or `"catastrophe"`.
    #[serde(default)]
    pub barrier: Barrier,
    /// Which contacts break thermally: `"joint"`, each at the rate of its own threshold, or `"additive"`, all of one stretch at the
    /// rate of the average contact, as O. M. Braun and M. Peyrard (2010) have it.
    #[serde(default)]
    pub hazard: Hazard,
}

impl Barrier {
    /// ΔE/E_0 at the fraction y = |x|/x_s of the threshold; 0 from y = 1 on.
    pub fn height(self, y: f64) -> f64 {
        self.continued(y.min(1.0))
    }

    /// The same for a contact of stretch x ≥ 0 and threshold h, from h − x: near the threshold 1 − x/h would
    /// lose digits, which E_0/T amplifies at low temperatures.
    pub(crate) fn height_at(self, stretch: f64, threshold: f64) -> f64 {
        self.of(((threshold - stretch) / threshold).max(0.0), stretch / threshold)
    }

    /// The same for y < 1, continued to negative values beyond: as smooth there as the barrier allows, for
    /// methods that need a neighbourhood.
    pub(crate) fn continued(self, y: f64) -> f64 {
        self.of(1.0 - y, y)
    }

    /// The derivative of ΔE/E_0 by y, for 0 ≤ y ≤ 1.
    fn slope(self, y: f64) -> f64 {
        match self {
            Self::Elastic => -2.0 * y,
            Self::Bell => -1.0,
            Self::Catastrophe => -1.5 * (1.0 - y).max(0.0).sqrt(),
        }
    }

    fn of(self, missing: f64, y: f64) -> f64 {
        match self {
            Self::Elastic => missing * (1.0 + y),
            Self::Bell => missing,
            Self::Catastrophe => missing * missing.abs().sqrt(),
        }
    }
}

impl Temperature {
    /// Breaking over the elastic barrier.
    pub fn new(energy: f64, attempt_rate: f64) -> Self {
        Self { energy, attempt_rate, barrier: Barrier::Elastic, hazard: Hazard::Joint }
    }

    /// Breaking rate w of a contact of stretch x below its threshold x_s, per time; `stiffness` is its own k.
    pub fn rate(&self, stretch: f64, threshold: f64, stiffness: f64) -> f64 {
        self.attempt_rate * (-self.exponent(stretch, threshold, stiffness)).exp()
    }

    /// ΔE/T of such a contact.
    pub(crate) fn exponent(&self, stretch: f64, threshold: f64, stiffness: f64) -> f64 {
        let whole = 0.5 * stiffness * threshold * threshold;
        whole / self.energy * self.barrier.height(stretch.abs() / threshold)
    }

    /// The breaking rate w of a contact of stretch 0 ≤ x ≤ x_s, and ∂w/∂x.
    pub(crate) fn rate_and_slope(&self, stretch: f64, threshold: f64, stiffness: f64) -> (f64, f64) {
        let whole = 0.5 * stiffness * threshold * threshold / self.energy;
        let rate = self.attempt_rate * (-whole * self.barrier.height_at(stretch, threshold)).exp();
        (rate, -rate * whole * self.barrier.slope(stretch / threshold) / threshold)
    }

    /// Whether the rate is that of the average contact.
    pub(crate) fn is_additive(&self) -> bool {
        self.hazard == Hazard::Additive
    }

    /// Checks the parameters.
    ///
    /// # Errors
    /// An energy or a rate that is not a finite number above 0.
    pub(super) fn check(&self) -> Result<()> {
        for (key, value) in [("energy", self.energy), ("attempt_rate", self.attempt_rate)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::invalid(key, "a finite number above 0", value));
            }
        }
        Ok(())
    }
}
