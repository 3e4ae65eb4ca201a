//! The interface of time-dependent contacts that move together, for a block or for a cell of an interface.
//!
//! In contrast to a [`crate::population::Population`], every displacement takes a time, and contacts change at rest, too.

mod free_friction;
mod population_in_time;
mod state;
mod stretch_interval;

pub use free_friction::FreeFriction;
pub use population_in_time::PopulationInTime;
pub use state::ContactsState;
pub use stretch_interval::{StretchInterval, binned};

use crate::Result;
use crate::energy::ContactEnergies;
use crate::monitor::Monitor;

/// Ratio of the tolerances of a second solution, whose difference from the first is an upper estimate of the error, to those of
/// the first. Steps of fourth order are then twice as long, and steps of second order two and a half times.
pub const ROUGH: f64 = 16.0;

/// Contacts that move together in time.
///
/// Forces are totals, in the unit of stiffness × length; positions X are lengths.
pub trait RateDependentContacts: std::fmt::Debug + Send + Sync {
    /// Position X of the slider's base.
    fn position(&self) -> f64;

    /// Time t.
    fn time(&self) -> f64;

    /// Force F. It contains the constant friction force of free contacts in motion forward, but not what their viscosity adds.
    fn force(&self) -> f64;

    /// Instantaneous tangent dF/dX, the stiffness of the attached contacts.
    fn tangent(&self) -> f64;

    /// Area that they take, as a multiple of that for which K_0, η and M of a cell of an interface are given: these are
    /// proportional to it, as the force is.
    fn area(&self) -> f64 {
        1.0
    }

    /// Friction force and viscosity of the contacts that are free.
    fn free_friction(&self) -> FreeFriction {
        FreeFriction::default()
    }

    /// Energies and breaks.
    fn energies(&self) -> ContactEnergies;

    /// Fraction of detached contacts.
    fn free(&self) -> f64;

    /// Whether nothing but their age changes at rest, so that the force of contacts that have hardly moved is known.
    fn is_constant_at_rest(&self) -> bool {
        false
    }

    /// The velocity at which they slide steadily; `None` for contacts that do not, or of which it is not known.
    fn steady_velocity(&self) -> Option<f64> {
        None
    }

    /// The mean threshold, to which the default tolerance of a slider is relative; `None` where it is not known.
    fn mean_threshold(&self) -> Option<f64> {
        None
    }

    /// The distribution of the stretches of the attached contacts.
    fn stretches(&self) -> Vec<StretchInterval>;

    /// Whether they may be moved backward, too.
    fn may_turn(&self) -> bool {
        false
    }

    /// Moves by `by` at constant velocity in the time `during` > 0; `by` ≥ 0 unless they may turn.
    ///
    /// # Errors
    /// Accuracy not reached; a stop by the monitor, after which the contacts are invalid.
    fn step(&mut self, by: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()>;

    /// Simplifies the present state as far as the tolerance allows, between accepted steps of a slider. Position, time and
    /// breaks stay; the force stays but for rounding.
    fn settle(&mut self) {}

    /// A copy in the present state with a tolerance [`ROUGH`] times as large, for an estimate of the error of the force. `None`
    /// for contacts that are followed one by one, whose errors are those of their number.
    fn rough(&self) -> Option<Box<dyn RateDependentContacts>> {
        None
    }

    /// A copy in the present state.
    fn copy(&self) -> Box<dyn RateDependentContacts>;

    /// The present state.
    fn state(&self) -> ContactsState;

    /// Restores the state of contacts of the same description, from which they continue bit for bit.
    ///
    /// # Errors
    /// A state of other contacts.
    fn restore(&mut self, state: &ContactsState) -> Result<()>;
}
