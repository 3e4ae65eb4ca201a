//! The interface of a population of contacts: what a block or an elastic interface needs to know of contacts
//! that move together.
//!
//! A population has no time of its own: it is moved, and its force follows. Between two breaks (or kinks of
//! the force) F(X) is smooth; the caller evaluates the force ahead on that interval, decides how far to go,
//! and moves the contacts there.

use serde::{Deserialize, Serialize};

use crate::Result;
use crate::energy::ContactEnergies;
use crate::monitor::Monitor;
use crate::numerics::breakpoints::Atom;
use crate::rate_dependent::ContactsState;

/// Direction of motion of the base of the slider.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Direction {
    /// Towards larger X.
    Forward,
    /// Towards smaller X.
    Backward,
}

impl Direction {
    /// +1 or −1.
    pub fn sign(self) -> f64 {
        match self {
            Self::Forward => 1.0,
            Self::Backward => -1.0,
        }
    }

    /// The opposite direction.
    #[must_use]
    pub fn reversed(self) -> Self {
        match self {
            Self::Forward => Self::Backward,
            Self::Backward => Self::Forward,
        }
    }
}

/// An interval on which F(X) is smooth. It ends at or before the next simultaneous break or kink.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothInterval {
    /// Its length, above 0; infinite if nothing can break any more.
    pub length: f64,
    /// Whether the force is linear on it; otherwise it is a polynomial of degree 15.
    pub straight: bool,
    /// Whether contacts break simultaneously at its end, where the force jumps.
    pub breaks: bool,
}

/// Force and tangent stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Force F.
    pub force: f64,
    /// Tangent dF/dX ahead.
    pub tangent: f64,
}

/// Contacts that move together.
///
/// Forces are totals, in the unit of stiffness × length; positions X are lengths. Long operations call a
/// monitor, without progress; once it has stopped one, the population is invalid.
pub trait Population: std::fmt::Debug + Send + Sync {
    /// Position X of the slider's base.
    fn position(&self) -> f64;

    /// The smooth interval ahead in `direction`.
    ///
    /// # Errors
    /// Accuracy not reached, too many point masses; a motion that contacts at a constant velocity cannot
    /// follow; stopped by the monitor.
    fn smooth_interval(&mut self, direction: Direction, monitor: &mut dyn Monitor) -> Result<SmoothInterval>;

    /// Force and tangent after a move of `by` (negative: backward) within the interval last returned for that
    /// direction; nothing moves. At its end the left limit, before simultaneous breaks there.
    fn ahead(&self, by: f64) -> Response;

    /// Moves by `by`, within the interval last returned for that direction. Contacts that break
    /// simultaneously at its end are still attached.
    ///
    /// # Errors
    /// Those of [`Population::smooth_interval`].
    fn advance(&mut self, by: f64) -> Result<()>;

    /// At the end of an interval with simultaneous breaks: these contacts break and re-form (or stay free
    /// after [`Population::hold`]). The position stays.
    ///
    /// # Errors
    /// Those of [`Population::smooth_interval`].
    fn cross(&mut self, monitor: &mut dyn Monitor) -> Result<()>;

    /// Breaks every attached contact; all contacts re-form as after a break in `direction`, those held free
    /// included, and holding ends. The position stays.
    ///
    /// # Errors
    /// Those of [`Population::smooth_interval`].
    fn reset(&mut self, direction: Direction, monitor: &mut dyn Monitor) -> Result<()>;

    /// From now on broken contacts stay free and carry no force, until [`Population::release`].
    ///
    /// # Errors
    /// Those of [`Population::smooth_interval`].
    fn hold(&mut self) -> Result<()>;

    /// Free contacts re-form, as after a break in the direction of the last move.
    ///
    /// # Errors
    /// Those of [`Population::smooth_interval`].
    fn release(&mut self, monitor: &mut dyn Monitor) -> Result<()>;

    /// Marks the present state, replacing the previous mark.
    fn mark(&mut self);

    /// Returns to the marked state, if there is one, and removes the mark.
    ///
    /// # Errors
    /// Stopped by the monitor.
    fn recall(&mut self, monitor: &mut dyn Monitor) -> Result<()>;

    /// Energies and breaks.
    fn energies(&self) -> ContactEnergies;

    /// Estimated error of the force, the largest so far; 0 for contacts simulated one by one.
    fn error(&self) -> f64 {
        0.0
    }

    /// The stretches of the attached contacts, in no order, if contacts are simulated one by one.
    fn stretches(&self) -> Option<Vec<f64>> {
        None
    }

    /// The density of attached contacts at given stretches, per length, and its point masses; `None` unless contacts are a
    /// distribution. Density and point masses add up to the attached fraction.
    ///
    /// # Errors
    /// Stopped by the monitor.
    fn stretch_density(
        &self,
        _stretches: &[f64],
        _monitor: &mut dyn Monitor,
    ) -> Result<Option<(Vec<f64>, Vec<Atom>)>> {
        Ok(None)
    }

    /// A copy in its present state.
    fn copy(&self) -> Box<dyn Population>;

    /// The present state, without the marked one.
    fn state(&self) -> ContactsState;

    /// Restores the state of contacts of the same description, from which they continue bit for bit.
    ///
    /// # Errors
    /// A state of other contacts; those of [`Population::smooth_interval`].
    fn restore(&mut self, state: &ContactsState, monitor: &mut dyn Monitor) -> Result<()>;
}
