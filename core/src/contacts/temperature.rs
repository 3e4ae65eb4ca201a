//! Temperature: thermally activated breaking below the threshold.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Stiffness;
use crate::numerics::exponential::exp;
use crate::numerics::incomplete::{cubic, dawson_by_table};
use crate::numerics::legendre::{NODES, Nodal};
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

/// The rate of thermal breaking: that of the threshold of each contact, or the mean over the contacts of one stretch.
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
    /// The rate of thermal breaking: `"joint"`, each contact breaks at the rate of its own threshold, or `"additive"`, all of one stretch at the
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

    /// The largest −∂(ΔE/E_0)/∂y up to y, for 0 ≤ y ≤ 1.
    pub(crate) fn steepest(self, y: f64) -> f64 {
        match self {
            Self::Elastic => 2.0 * y,
            Self::Bell => 1.0,
            Self::Catastrophe => 1.5,
        }
    }

    /// The length s of the closed form ∫^x e^{−ΔE(ξ)/T} dξ = s G(x) e^{−ΔE(x)/T} for a threshold h, from E_0/T.
    ///
    /// | barrier | s | G(x) |
    /// |---|---|---|
    /// | elastic | h √(T/E_0) | D(x/s), D Dawson's integral |
    /// | bell | h T/E_0 | 1 |
    /// | catastrophe | h (T/E_0)^{2/3} | g(√((h − x)/s)), g(t) = e^{t³} ∫_t^∞ 2τ e^{−τ³} dτ, an incomplete gamma function |
    #[inline]
    pub(crate) fn integral_length(self, threshold: f64, whole: f64) -> f64 {
        match self {
            Self::Elastic => threshold / whole.sqrt(),
            Self::Bell => threshold / whole,
            Self::Catastrophe => threshold / whole.cbrt().powi(2),
        }
    }

    /// G(x) of the closed form, from its length s ([`Self::integral_length`]).
    #[inline]
    pub(crate) fn integral_factor(self, stretch: f64, threshold: f64, length: f64) -> f64 {
        match self {
            Self::Elastic => dawson_by_table(stretch / length),
            Self::Bell => 1.0,
            Self::Catastrophe => cubic(((threshold - stretch).max(0.0) / length).sqrt()),
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

    /// The breaking rates of sixteen contacts; the loops vectorise.
    #[inline(always)]
    pub(crate) fn rates(&self, stretches: &Nodal, thresholds: &Nodal, stiffness: &Stiffness) -> Nodal {
        let mut whole = [0.0; NODES];
        for i in 0..NODES {
            whole[i] = 0.5 / self.energy * thresholds[i] * thresholds[i];
        }
        match stiffness {
            Stiffness::Equal(stiffness) => whole.iter_mut().for_each(|whole| *whole *= stiffness),
            _ => whole.iter_mut().zip(thresholds).for_each(|(whole, h)| *whole *= stiffness.of(*h)),
        }
        let fractions = (stretches, thresholds);
        let boltzmann = match self.barrier {
            Barrier::Elastic => boltzmann(&whole, fractions, |missing, y| missing * (1.0 + y)),
            Barrier::Bell => boltzmann(&whole, fractions, |missing, _| missing),
            Barrier::Catastrophe => boltzmann(&whole, fractions, |missing, _| missing * missing.sqrt()),
        };
        boltzmann.map(|factor| self.attempt_rate * factor)
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

/// e^{−ΔE/T} of sixteen contacts from E_0/T, their stretches and thresholds, and ΔE/E_0 as a function of 1 − y and y.
#[inline(always)]
fn boltzmann(
    whole: &Nodal,
    (stretches, thresholds): (&Nodal, &Nodal),
    height: impl Fn(f64, f64) -> f64,
) -> Nodal {
    let mut out = [0.0; NODES];
    for i in 0..NODES {
        let y = (stretches[i].abs() / thresholds[i]).min(1.0);
        out[i] = exp(-whole[i] * height(1.0 - y, y));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rates of sixteen contacts are those of each.
    #[test]
    fn rates_are_those_of_single_contacts() {
        let stretches: Nodal = std::array::from_fn(|i| 0.2 * i as f64 - 1.5);
        let thresholds: Nodal = std::array::from_fn(|i| if i == 3 { 0.0 } else { 0.7 + 0.05 * i as f64 });
        for barrier in [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe] {
            for stiffness in [Stiffness::Equal(2.0), Stiffness::PerThreshold(1.5)] {
                let temperature = Temperature { barrier, ..Temperature::new(0.05, 3.0) };
                let rates = temperature.rates(&stretches, &thresholds, &stiffness);
                for ((rate, x), h) in rates.iter().zip(stretches).zip(thresholds) {
                    let expected = temperature.rate(x, h, stiffness.of(h));
                    // Some roundings of exponents of up to 60.
                    assert!((rate / expected - 1.0).abs() < 1e-13, "{barrier:?} {x} {h}: {rate} {expected}");
                }
            }
        }
    }
}
