//! Time-dependent contacts that move together, seen from outside: what a block needs to know of them.
//!
//! Where a [`crate::population::Population`] has no time of its own, here every move takes its time, and time passes at
//! rest, too.

mod error;
mod state;
mod stretch_interval;

pub use error::ErrorEstimator;
pub use state::ContactsState;
pub use stretch_interval::{StretchInterval, binned};

use crate::Result;
use crate::monitor::Monitor;

/// What time-dependent contacts store, and what came and went otherwise than by work, each summed on its own.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Books {
    /// Elastic energy Σ ½k x² of the contacts, now.
    pub elastic: f64,
    /// Energy lost in breaks since the beginning: Σ over breaks of ½k x_b², less the ½k r² of what re-formed.
    pub lost: f64,
    /// Energy ∫Σ ½x² dk since the beginning, brought by ageing that makes stretched contacts stiffer (k = κ x_s with the
    /// present threshold); below 0 where they weaken.
    pub gained: f64,
    /// Breaks since the beginning, per contact.
    pub broken: f64,
}

/// Contacts that move together in time.
///
/// Forces are totals, in the unit of stiffness × length; positions X are lengths.
pub trait RateDependentContacts: std::fmt::Debug + Send + Sync {
    /// Position X of the slider's bottom.
    fn position(&self) -> f64;

    /// Time t.
    fn time(&self) -> f64;

    /// Force F.
    fn force(&self) -> f64;

    /// dF/dX if the slider moved at once: what holds, stretched.
    fn tangent(&self) -> f64;

    /// Energies and breaks: the work on the contacts is the change of elastic − gained + lost.
    fn books(&self) -> Books;

    /// The fraction of contacts that is free.
    fn free(&self) -> f64;

    /// The contacts that hold, by their stretches.
    fn stretches(&self) -> Vec<StretchInterval>;

    /// Moves by `by`, 0 or above, at one velocity in the time `during`, above 0.
    ///
    /// # Errors
    /// Accuracy not reached; stopped by the monitor, somewhere on the way.
    fn step(&mut self, by: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()>;

    /// The same contacts here and now, followed less accurately: moved the same way they tell the error of the force. None of
    /// contacts that are followed one by one.
    fn rough(&self) -> Option<Box<dyn RateDependentContacts>> {
        None
    }

    /// A copy in the present state, to come back to.
    fn copy(&self) -> Box<dyn RateDependentContacts>;

    /// What they have come to.
    fn state(&self) -> ContactsState;

    /// Goes to what contacts of the same description have come to: they go on from there bit for bit.
    ///
    /// # Errors
    /// A state of other contacts.
    fn restore(&mut self, state: &ContactsState) -> Result<()>;
}
