//! How accurate a solution of the master equation is to be, and whether that was asked for or is only aimed at.

use crate::{Error, Float, Result};

/// The error allowed in F/(N_c⟨k⟩), per mean life of a contact.
///
/// A number is a promise: where the estimated error exceeds it, the solution is refused. [`Tolerance::default`] is an aim: the
/// solution is as accurate as that or as its distributions allow, and tells its estimated error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    value: f64,
    required: bool,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { value: Self::AIM, required: false }
    }
}

impl From<f64> for Tolerance {
    fn from(value: f64) -> Self {
        Self { value, required: true }
    }
}

impl From<Option<f64>> for Tolerance {
    fn from(value: Option<f64>) -> Self {
        value.map_or_else(Self::default, Self::from)
    }
}

impl Tolerance {
    /// The error aimed at where nothing is asked for.
    pub const AIM: f64 = 1e-10;

    /// The largest error aimed at where smaller ones cannot be reached.
    const COARSEST: f64 = 1e-4;

    /// The error allowed.
    pub fn value(self) -> f64 {
        self.value
    }

    /// Whether a larger error is refused.
    pub fn is_required(self) -> bool {
        self.required
    }

    /// Refuses a tolerance that cannot be kept, or means nothing.
    pub(super) fn check(self) -> Result<()> {
        if (1e-12..=1e-2).contains(&self.value) {
            return Ok(());
        }
        Err(Error::invalid("tolerance", "a number from 1e-12 to 1e-2", self.value))
    }

    /// The aim to try next where this one cannot be resolved.
    pub(super) fn coarser(self) -> Option<Self> {
        let value = 100.0 * self.value;
        (!self.required && value <= Self::COARSEST).then_some(Self { value, ..self })
    }

    /// Refuses an `error` larger than what is required; `what` has it.
    ///
    /// # Errors
    /// [`Error::Accuracy`].
    pub fn allows(self, error: f64, what: impl FnOnce() -> String) -> Result<()> {
        if !self.required || error <= self.value {
            return Ok(());
        }
        Err(Error::accuracy(what(), error, self.value))
    }

    /// The same for an error that adds up: so many times as large.
    pub(super) fn times(self, factor: f64) -> Self {
        Self { value: factor * self.value, ..self }
    }
}

impl Error {
    /// An [`Error::Accuracy`] of what the master equation was asked for.
    pub(super) fn accuracy(what: String, reached: f64, wanted: f64) -> Self {
        Self::Accuracy {
            key: "master_equation.tolerance".to_owned(),
            what,
            reached: Float(reached),
            wanted: Float(wanted),
        }
    }
}
