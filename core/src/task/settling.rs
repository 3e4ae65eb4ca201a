//! The sliding distance after which steady sliding does not depend on the initial state.

use crate::Result;
use crate::contacts::Contacts;
use crate::master::{MasterEquation, SteadyState};
use crate::monitor::Monitor;

/// Distance in dephasing lengths: deviations from steady sliding decay to e^{−12} = 6e-6.
const FORGOTTEN: f64 = 12.0;
/// Distance in mean lives of the contacts present at one time, after which the longest lives of broad laws have their
/// steady weight.
const FOUND: f64 = 15.0;
/// Largest distance in mean lives: contacts with the same threshold stay in phase for ever.
const MOST: f64 = 1000.0;

/// Steady sliding at a velocity.
pub(super) struct Steady {
    /// Kinetic friction F_k, a force.
    pub friction: f64,
    /// Sliding distance after which sliding is steady from any initial state.
    pub distance: f64,
    /// Mean sliding distance of a contact from its formation to its break.
    pub life: f64,
    /// Estimated error of F_k/(N_c⟨k⟩).
    pub error: f64,
}

impl Steady {
    /// Steady sliding of `contacts` at `velocity`.
    ///
    /// # Errors
    /// Those of [`MasterEquation::reformed`].
    pub fn at(contacts: &Contacts, velocity: f64, monitor: &mut dyn Monitor) -> Result<Self> {
        let equation = MasterEquation::reformed(contacts.clone(), Some(velocity), monitor)?;
        Ok(Self::of(&equation.steady_state()))
    }

    /// That of a solution.
    pub fn of(steady: &SteadyState) -> Self {
        let life = steady.mean_life();
        let forgotten = FORGOTTEN * steady.dephasing_length();
        let distance = forgotten.max(FOUND * steady.life_found()).min(MOST * life);
        Self { friction: steady.kinetic_friction(), distance, life, error: steady.error_estimate() }
    }
}
