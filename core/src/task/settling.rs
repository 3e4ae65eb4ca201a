//! How far to slide until nothing tells where one started.

use crate::Result;
use crate::contacts::{Contacts, Initial};
use crate::master::MasterEquation;
use crate::monitor::Monitor;

/// Lengths of dephasing after which a start is forgotten: e^{−12} is 6e-6 of what it was.
const FORGOTTEN: f64 = 12.0;
/// Lives of contacts as they are found in sliding, after which the longest of broad laws have come to their share.
const FOUND: f64 = 15.0;
/// Most mean lives: contacts of the same threshold never lose step.
const MOST: f64 = 1000.0;

/// Steady sliding at a velocity.
pub(super) struct Steady {
    /// F_k.
    pub friction: f64,
    /// A way after which sliding is steady, wherever it started.
    pub way: f64,
    /// Mean way of a contact from birth to break.
    pub life: f64,
    /// Estimated error of F_k/(N_c⟨k⟩).
    pub error: f64,
}

impl Steady {
    /// Steady sliding of `contacts` at `velocity`.
    ///
    /// # Errors
    /// Those of [`MasterEquation::at`].
    pub fn at(
        contacts: &Contacts,
        initial: &Initial,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let equation = MasterEquation::at_with(contacts.clone(), initial, velocity, monitor)?;
        let steady = equation.steady_state();
        let life = steady.mean_life();
        let way = (FORGOTTEN * steady.dephasing_length()).max(FOUND * steady.life_found()).min(MOST * life);
        Ok(Self { friction: steady.kinetic_friction(), way, life, error: steady.error_estimate() })
    }
}
