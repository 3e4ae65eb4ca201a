//! How strong a contact is now: its threshold from the one it was born with and from its age.

use super::{Ageing, Contacts};
use crate::law::Law;
use crate::{Error, Result};

/// The present threshold h of a contact as a function of its newborn threshold h_0 and its age t, rising with h_0.
///
/// | ageing | h |
/// |---|---|
/// | none | h_0 |
/// | `logarithmic` | h_0 [1 + β ln(1 + t/τ_0)] |
/// | `frozen_rank`, Gaussian to Gaussian | m(t) + s(t) (h_0 − x̄_i)/σ_i, m = x̄_f + (x̄_i − x̄_f) e^{−t/τ}, s² = σ_f² + (σ_i² − σ_f²) e^{−2t/τ} |
///
/// x̄ and σ are the `mean` and `std` of the laws. A threshold below 0 is 0.
#[derive(Debug, Clone)]
pub struct Strength {
    kind: Kind,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Constant,
    Logarithmic { growth: f64, time: f64 },
    Gaussian { newborn: Normal, mature: Normal, time: f64 },
}

/// A Gaussian's parameters.
#[derive(Debug, Clone, Copy)]
struct Normal {
    mean: f64,
    std: f64,
}

/// The strengths of contacts of one age: h = `shift` + `factor` h_0, and how that grows per time.
#[derive(Debug, Clone, Copy)]
pub struct Aged {
    shift: f64,
    factor: f64,
    shift_rate: f64,
    factor_rate: f64,
}

impl Strength {
    /// The strength of these contacts, which are taken to have passed [`Contacts::check`].
    ///
    /// # Errors
    /// Ageing in which the threshold is no function of age (`smoluchowski`, `mean_field`); `frozen_rank` between laws that
    /// are not both Gaussian.
    pub fn of(contacts: &Contacts) -> Result<Self> {
        let Some(ageing) = &contacts.rules.ageing else { return Ok(Self { kind: Kind::Constant }) };
        let kind = match ageing {
            &Ageing::Logarithmic { growth, time } => Kind::Logarithmic { growth, time },
            Ageing::FrozenRank { mature, time } => {
                let newborn = Normal::of("contacts.thresholds", contacts.thresholds.as_ref())?;
                let mature = Normal::of("contacts.ageing.frozen_rank.mature", mature.as_ref())?;
                Kind::Gaussian { newborn, mature, time: *time }
            }
            Ageing::Smoluchowski { .. } | Ageing::MeanField { .. } => {
                let key = format!("contacts.ageing.{}", ageing.name());
                let expected = "thresholds that follow from the age of the contact";
                return Err(Error::invalid(key, expected, "thresholds that diffuse"));
            }
        };
        Ok(Self { kind })
    }

    /// Whether it is h_0 at any age.
    pub fn is_constant(&self) -> bool {
        matches!(self.kind, Kind::Constant)
    }

    /// The strengths at an age t ≥ 0.
    pub fn at(&self, age: f64) -> Aged {
        match self.kind {
            Kind::Constant => Aged { shift: 0.0, factor: 1.0, shift_rate: 0.0, factor_rate: 0.0 },
            Kind::Logarithmic { growth, time } => Aged {
                shift: 0.0,
                factor: 1.0 + growth * (age / time).ln_1p(),
                shift_rate: 0.0,
                factor_rate: growth / (time + age),
            },
            Kind::Gaussian { newborn, mature, time } => {
                let left = (-age / time).exp();
                let mean = mature.mean + (newborn.mean - mature.mean) * left;
                let excess = (newborn.std - mature.std) * (newborn.std + mature.std) * left * left;
                let std = (mature.std * mature.std + excess).sqrt();
                let factor = std / newborn.std;
                let factor_rate = -excess / (time * std * newborn.std);
                let mean_rate = (mature.mean - newborn.mean) * left / time;
                Aged {
                    shift: mean - factor * newborn.mean,
                    factor,
                    shift_rate: mean_rate - factor_rate * newborn.mean,
                    factor_rate,
                }
            }
        }
    }

    /// h of a contact born with h_0, at an age.
    pub fn threshold(&self, newborn: f64, age: f64) -> f64 {
        self.at(age).threshold(newborn)
    }

    /// h_0 of a contact whose threshold is h at an age; below 0 where every contact is stronger.
    pub fn newborn(&self, threshold: f64, age: f64) -> f64 {
        self.at(age).newborn(threshold)
    }
}

impl Aged {
    /// h of a contact born with h_0.
    #[inline]
    pub fn threshold(&self, newborn: f64) -> f64 {
        (self.shift + self.factor * newborn).max(0.0)
    }

    /// h_0 of a contact whose threshold is h; below 0 where every contact is stronger.
    #[inline]
    pub fn newborn(&self, threshold: f64) -> f64 {
        (threshold - self.shift) / self.factor
    }

    /// ∂h/∂h_0 at constant age, for a contact born with h_0.
    #[inline]
    pub fn spread(&self, _newborn: f64) -> f64 {
        self.factor
    }

    /// ∂h/∂t of a contact born with h_0: how fast it strengthens.
    #[inline]
    pub fn drift(&self, newborn: f64) -> f64 {
        self.shift_rate + self.factor_rate * newborn
    }
}

impl Normal {
    fn of(key: &str, law: &dyn Law) -> Result<Self> {
        if law.name() != "gaussian" {
            let expected = "a gaussian, to age by frozen_rank";
            return Err(Error::invalid(key, expected, law.name()));
        }
        let parameter =
            |name: &str| law.parameters().iter().find(|p| p.name == name).map_or(f64::NAN, |p| p.value);
        Ok(Self { mean: parameter("mean"), std: parameter("std") })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::contacts::Rules;
    use crate::law::{Gaussian, Point, Rectangular};

    fn contacts(ageing: Option<Ageing>) -> Contacts {
        let law = Arc::new(Gaussian::new(0.5, 0.1).unwrap());
        let rules = Rules { ageing, ..Rules::default() };
        Contacts { rules, ..Contacts::new(law, Arc::new(Point::new(0.0).unwrap())) }
    }

    fn frozen_rank() -> Ageing {
        Ageing::FrozenRank { mature: Arc::new(Gaussian::new(1.0, 0.05).unwrap()), time: 2.0 }
    }

    #[test]
    fn thresholds_and_newborn_ones_are_inverse_and_their_rates_are_derivatives() {
        for ageing in [None, Some(Ageing::Logarithmic { growth: 0.02, time: 3.0 }), Some(frozen_rank())] {
            let strength = Strength::of(&contacts(ageing)).unwrap();
            for (newborn, age) in [(0.3, 0.0), (0.5, 1e-3), (0.7, 1.7), (0.45, 40.0)] {
                let aged = strength.at(age);
                let threshold = strength.threshold(newborn, age);
                // A few roundings.
                assert!((strength.newborn(threshold, age) - newborn).abs() < 1e-15);
                // Central differences of step h: error of order h² and ε/h.
                let step = 1e-5;
                let drift = strength.threshold(newborn, age + step) - threshold;
                assert!((drift / step - aged.drift(newborn)).abs() < 1e-5);
                let spread = aged.threshold(newborn + step) - threshold;
                assert!((spread / step - aged.spread(newborn)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_newborn_law_becomes_the_mature_one_rank_by_rank() {
        let strength = Strength::of(&contacts(Some(frozen_rank()))).unwrap();
        for z in [-3.0, 0.0, 1.5] {
            let newborn = 0.5 + 0.1 * z;
            assert!((strength.threshold(newborn, 0.0) - newborn).abs() < 1e-15);
            assert!((strength.threshold(newborn, 1e3) - (1.0 + 0.05 * z)).abs() < 1e-15);
        }
    }

    #[test]
    fn what_is_no_function_of_age_is_refused() {
        let mature = Arc::new(Gaussian::new(1.0, 0.05).unwrap());
        let diffusing = Ageing::Smoluchowski { mature, diffusion: 1.0 };
        assert!(Strength::of(&contacts(Some(diffusing))).is_err());
        let mature = Arc::new(Rectangular::new(0.1, 2.0).unwrap());
        let general = Ageing::FrozenRank { mature, time: 1.0 };
        let error = Strength::of(&contacts(Some(general))).unwrap_err();
        assert!(error.to_string().starts_with("contacts.ageing.frozen_rank.mature: expected a gaussian"));
    }
}
