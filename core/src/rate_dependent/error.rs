//! The error of contacts that are moved step by step, estimated from copies that are moved the same way.

use super::{ContactsState, RateDependentContacts};
use crate::Result;
use crate::monitor::Monitor;

/// How much larger an error is than what half the step changes: of first order by 2, of fourth by 16/15.
const HALVED: f64 = 2.0;

/// Two copies of contacts. One is followed with a larger tolerance: its difference is the error of the steps of contacts
/// where these are shorter than those of the slider. The other one is followed in steps half as long: its difference is the
/// error of the steps of the slider.
#[derive(Debug)]
pub struct ErrorEstimator {
    rough: Box<dyn RateDependentContacts>,
    halved: Box<dyn RateDependentContacts>,
}

impl ErrorEstimator {
    /// That of `contacts` from here on, where they have an error at all.
    pub fn of(contacts: &dyn RateDependentContacts) -> Option<Self> {
        contacts.rough().map(|rough| Self { rough, halved: contacts.copy() })
    }

    /// Moves as the contacts have moved, which now carry a `force`. Returns an estimate of its error, on the safe side.
    ///
    /// # Errors
    /// Those of [`RateDependentContacts::step`].
    pub fn step(&mut self, by: f64, during: f64, force: f64, monitor: &mut dyn Monitor) -> Result<f64> {
        self.rough.step(by, during, monitor)?;
        for _ in 0..2 {
            self.halved.step(0.5 * by, 0.5 * during, monitor)?;
        }
        Ok((self.rough.force() - force).abs() + HALVED * (self.halved.force() - force).abs())
    }

    /// A copy in the present state.
    pub fn copy(&self) -> Self {
        Self { rough: self.rough.copy(), halved: self.halved.copy() }
    }

    /// What both have come to.
    pub fn state(&self) -> [ContactsState; 2] {
        [self.rough.state(), self.halved.state()]
    }

    /// Goes to what others of the same description have come to.
    ///
    /// # Errors
    /// Those of [`RateDependentContacts::restore`].
    pub fn restore(&mut self, [rough, halved]: &[ContactsState; 2]) -> Result<()> {
        self.rough.restore(rough)?;
        self.halved.restore(halved)
    }
}
