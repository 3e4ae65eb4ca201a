//! The accuracy required of, or aimed at by, solutions of the master equation.

use crate::{Error, Float, Result};

/// The error allowed in F/(N_c⟨k⟩), per mean life of a contact.
///
/// A number is a requirement: a solution with a larger estimated error is refused. [`Tolerance::default`] is
/// an aim: the solution is as accurate as that or as its distributions allow, and reports its estimated
/// error.
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
    /// The error aimed at by default.
    pub const AIM: f64 = 1e-10;

    /// The largest error aimed at if smaller ones cannot be reached.
    const COARSEST: f64 = 1e-4;

    /// The error allowed.
    pub fn value(self) -> f64 {
        self.value
    }

    /// Refuses a tolerance outside the range that can be met.
    pub(super) fn check(self) -> Result<()> {
        if (1e-12..=1e-2).contains(&self.value) {
            return Ok(());
        }
        Err(Error::invalid("tolerance", "a number from 1e-12 to 1e-2", self.value))
    }

    /// The next aim if this one cannot be reached.
    pub(super) fn coarser(self) -> Option<Self> {
        let value = 100.0 * self.value;
        (!self.required && value <= Self::COARSEST).then_some(Self { value, ..self })
    }

    /// Refuses an `error` larger than required, of the quantity `what`.
    ///
    /// # Errors
    /// [`Error::Accuracy`].
    pub fn allows(self, error: f64, what: impl FnOnce() -> String) -> Result<()> {
        if !self.required || error <= self.value {
            return Ok(());
        }
        Err(Error::accuracy(what(), error, self.value))
    }

    /// The tolerance times a factor, for errors that accumulate.
    pub(super) fn times(self, factor: f64) -> Self {
        Self { value: factor * self.value, ..self }
    }
}

impl Error {
    /// An [`Error::Accuracy`] of a solution of the master equation.
    pub(super) fn accuracy(what: String, reached: f64, wanted: f64) -> Self {
        Self::Accuracy { key: "tolerance".to_owned(), what, reached: Float(reached), wanted: Float(wanted) }
    }
}
