//! Contacts that move together, seen from outside: what a block or an elastic interface needs to know of them.
//!
//! A population has no time of its own: it is moved, and its force follows. Between two breaks (or kinks of the
//! force) it goes a smooth way; whoever drives it looks ahead on that way, decides how far to go, and moves it there.

use serde::{Deserialize, Serialize};

use crate::Result;
use crate::monitor::Monitor;
use crate::numerics::breaks::Atom;
use crate::rate_dependent::State;

/// Which way the slider's bottom moves.
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

    /// The other one.
    #[must_use]
    pub fn reversed(self) -> Self {
        match self {
            Self::Forward => Self::Backward,
            Self::Backward => Self::Forward,
        }
    }
}

/// The way to the next place where contacts break together, or where the force has a kink; it may end before, where
/// nothing is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// Its length, above 0; infinite where nothing can break any more.
    pub length: f64,
    /// Whether the force is a straight line on it; else it is as smooth as a polynomial of degree 15.
    pub straight: bool,
    /// Whether contacts break together at its end, where the force jumps.
    pub breaks: bool,
}

/// How a population answers to being moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Force F.
    pub force: f64,
    /// Tangent dF/dX, on the way ahead.
    pub tangent: f64,
}

/// What the contacts store and have lost, each summed on its own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Books {
    /// Elastic energy Σ ½k x² of the contacts, now.
    pub elastic: f64,
    /// Energy lost in breaks since the beginning: Σ over breaks of ½k x_b², less the ½k r² of what re-formed.
    pub lost: f64,
    /// Breaks since the beginning, per contact.
    pub broken: f64,
}

/// Contacts that move together.
///
/// Forces are totals, in the unit of stiffness × length; positions X are lengths. What may take long asks a monitor,
/// and tells it nothing of how much is done; where that stops it, the population is of no use any more.
pub trait Population: Send + Sync {
    /// Position X of the slider's bottom.
    fn position(&self) -> f64;

    /// The way ahead in `direction`.
    ///
    /// # Errors
    /// What looking further ahead may run into: accuracy not reached, too many point masses; a way that contacts at a
    /// constant velocity cannot be followed on; stopped by the monitor.
    fn way(&mut self, direction: Direction, monitor: &mut dyn Monitor) -> Result<Way>;

    /// The response after a move of `by` (negative: backward) on the way last asked for in that direction;
    /// nothing moves. At the end of the way the left limit, before anything breaks there.
    fn ahead(&self, by: f64) -> Response;

    /// Moves by `by`, on the way last asked for in that direction. At an end that breaks, what stands there
    /// still holds.
    ///
    /// # Errors
    /// Those of [`Population::way`].
    fn advance(&mut self, by: f64) -> Result<()>;

    /// At the end of a way that breaks, before anything else: what stands there breaks and re-forms (or is free,
    /// after [`Population::hold`]). The position stays.
    ///
    /// # Errors
    /// Those of [`Population::way`].
    fn cross(&mut self, monitor: &mut dyn Monitor) -> Result<()>;

    /// Breaks every contact that holds; all re-form as after a break in `direction`, those held free too, and
    /// nothing is held any more. The position stays.
    ///
    /// # Errors
    /// Those of [`Population::way`].
    fn reset(&mut self, direction: Direction, monitor: &mut dyn Monitor) -> Result<()>;

    /// From now on what breaks stays free and carries nothing, until [`Population::release`].
    ///
    /// # Errors
    /// Those of [`Population::way`].
    fn hold(&mut self) -> Result<()>;

    /// What is free re-forms, as after a break in the direction of the last move.
    ///
    /// # Errors
    /// Those of [`Population::way`].
    fn release(&mut self, monitor: &mut dyn Monitor) -> Result<()>;

    /// Marks the present state, in place of the one marked before.
    fn mark(&mut self);

    /// Comes back to the state that is marked, if one is, and takes the mark away.
    ///
    /// # Errors
    /// Stopped by the monitor.
    fn recall(&mut self, monitor: &mut dyn Monitor) -> Result<()>;

    /// Energies and breaks.
    fn books(&self) -> Books;

    /// Estimated error of the force, the largest so far; 0 of contacts that are followed one by one, which carry what they
    /// carry.
    fn error(&self) -> f64 {
        0.0
    }

    /// The stretches of the contacts that hold, in no order, where they are followed one by one.
    fn stretches(&self) -> Option<Vec<f64>> {
        None
    }

    /// The density at given stretches of the contacts that hold, per length, with the stretches that many share; where they
    /// are a distribution. It and the weights add up to the fraction that holds.
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

    /// A copy in its present state, to come back to.
    fn copy(&self) -> Box<dyn Population>;

    /// What the contacts have come to; without the state that is marked.
    fn state(&self) -> State;

    /// Goes to what contacts of the same description have come to: they go on from there bit for bit.
    ///
    /// # Errors
    /// A state of other contacts; those of [`Population::way`].
    fn restore(&mut self, state: &State, monitor: &mut dyn Monitor) -> Result<()>;
}
