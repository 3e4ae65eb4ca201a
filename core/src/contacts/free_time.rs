//! The time for which a broken contact is free.

use crate::law::{Law, SharedLaw};
use crate::random::Stream;
use crate::rate_dependent::FreeFriction;
use crate::{Error, Result};

/// The time for which a broken contact is free before it re-forms.
///
/// A contact that re-forms at the rate λ(t) a time t after its break is free for a time with this hazard: a constant rate is the
/// exponential distribution of mean 1/λ, a rate that rises or falls with the time is that of a Weibull or gamma distribution.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum FreeTime {
    /// The same time for all breaks; 0 for contacts that re-form at once.
    Fixed(f64),
    /// A time drawn anew at each break.
    Distributed(SharedLaw),
}

impl Default for FreeTime {
    fn default() -> Self {
        Self::Fixed(0.0)
    }
}

impl From<f64> for FreeTime {
    fn from(time: f64) -> Self {
        Self::Fixed(time)
    }
}

impl From<SharedLaw> for FreeTime {
    /// A distribution that is one point is a fixed time.
    fn from(law: SharedLaw) -> Self {
        match law.atoms().first() {
            Some(atom) if atom.weight == 1.0 => Self::Fixed(atom.position),
            _ => Self::Distributed(law),
        }
    }
}

impl FreeTime {
    /// Whether contacts re-form at once.
    pub fn is_none(&self) -> bool {
        matches!(self, Self::Fixed(time) if *time == 0.0)
    }

    /// The mean time ⟨τ⟩.
    pub fn mean(&self) -> f64 {
        match self {
            Self::Fixed(time) => *time,
            Self::Distributed(law) => law.mean(),
        }
    }

    /// The distribution, if there is one.
    pub fn law(&self) -> Option<&SharedLaw> {
        match self {
            Self::Fixed(_) => None,
            Self::Distributed(law) => Some(law),
        }
    }

    /// A time; nothing is drawn if it is the same for all.
    pub(crate) fn draw(&self, stream: &mut Stream) -> f64 {
        match self {
            Self::Fixed(time) => *time,
            Self::Distributed(law) => {
                let mut drawn = [0.0];
                law.fill(stream, &mut drawn);
                drawn[0]
            }
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        match self {
            Self::Fixed(time) if !(time.is_finite() && *time >= 0.0) => {
                Err(Error::invalid("delay", "a finite number, 0 or above", time))
            }
            Self::Fixed(_) => Ok(()),
            Self::Distributed(law) => check_law(law.as_ref()),
        }
    }
}

fn check_law(law: &dyn Law) -> Result<()> {
    super::resolved("delay", law)?;
    let pole = law.breakpoints().into_iter().find(|b| b.exponent < 0.0);
    match pole {
        Some(pole) => {
            let expected = "a density of times without a pole: a gamma or Weibull distribution has none if its std is at most its mean";
            Err(Error::invalid("delay", expected, format!("an infinite density at {}", pole.position)))
        }
        None => Ok(()),
    }
}

/// Refuses numbers that are no friction, and a friction where no contact is free.
pub(super) fn check_friction(friction: FreeFriction, delay: &FreeTime) -> Result<()> {
    for (name, value) in [("force", friction.force), ("viscosity", friction.viscosity)] {
        if !(value.is_finite() && value >= 0.0) {
            let error = Error::invalid(name, "a finite number, 0 or above", value);
            return Err(error.under("free_friction"));
        }
    }
    if !friction.is_none() && delay.is_none() {
        let expected = "a delay beside free_friction: without it no contact is free";
        return Err(Error::invalid("free_friction", expected, "none"));
    }
    Ok(())
}
