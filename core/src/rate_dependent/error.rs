//! Error estimate for time-dependent contacts, from copies that follow the same motion.

use super::{ContactsState, RateDependentContacts};
use crate::Result;
use crate::monitor::Monitor;

/// Ratio of the error to the change by halved steps (Richardson extrapolation): 2 for first order, 16/15 for fourth.
const HALVED: f64 = 2.0;

/// Two copies of contacts that follow the same motion. The first has a larger tolerance; its deviation is the error of the
/// steps of the contacts. The second moves in steps half as long; its deviation is the error of the steps of the slider.
#[derive(Debug)]
pub struct ErrorEstimator {
    rough: Box<dyn RateDependentContacts>,
    halved: Box<dyn RateDependentContacts>,
}

impl ErrorEstimator {
    /// The estimator of `contacts` from the present state; `None` for contacts that are followed one by one.
    pub fn of(contacts: &dyn RateDependentContacts) -> Option<Self> {
        contacts.rough().map(|rough| Self { rough, halved: contacts.copy() })
    }

    /// Repeats steps of the contacts, displacements in times, which led to `force`. Returns an estimated upper limit of the
    /// error of that force.
    ///
    /// # Errors
    /// Those of [`RateDependentContacts::step`].
    pub fn step(&mut self, path: &[(f64, f64)], force: f64, monitor: &mut dyn Monitor) -> Result<f64> {
        for &(by, during) in path {
            self.rough.step(by, during, monitor)?;
            for _ in 0..2 {
                self.halved.step(0.5 * by, 0.5 * during, monitor)?;
            }
        }
        self.rough.settle();
        self.halved.settle();
        Ok((self.rough.force() - force).abs() + HALVED * (self.halved.force() - force).abs())
    }

    /// A copy in the present state.
    pub fn copy(&self) -> Self {
        Self { rough: self.rough.copy(), halved: self.halved.copy() }
    }

    /// The states of both copies.
    pub fn state(&self) -> [ContactsState; 2] {
        [self.rough.state(), self.halved.state()]
    }

    /// Restores the states of copies of the same description.
    ///
    /// # Errors
    /// Those of [`RateDependentContacts::restore`].
    pub fn restore(&mut self, [rough, halved]: &[ContactsState; 2]) -> Result<()> {
        self.rough.restore(rough)?;
        self.halved.restore(halved)
    }
}
