//! A cell of a slider and its contacts.

use crate::Result;
use crate::monitor::Watch;
use crate::rate_dependent::RateDependentContacts;

/// The state of a cell and of its contacts.
#[derive(Debug)]
pub struct SlidingCell {
    pub contacts: Box<dyn RateDependentContacts>,
    /// Position X_j.
    pub position: f64,
    /// Friction force F_j of the contacts.
    pub force: f64,
    /// Velocity Ẋ_j.
    pub velocity: f64,
    /// Displacement X − X_2 ≤ 0 at rest of a cell that has moved back on the unloading line of its contacts.
    pub back: f64,
    /// Secant slope dF/dX of the last advance, the first guess for the next one.
    pub slope: f64,
}

impl SlidingCell {
    /// A cell at a position: at rest, or at the velocity at which its contacts slide steadily.
    pub fn new(contacts: Box<dyn RateDependentContacts>, position: f64) -> Self {
        let (force, slope) = (contacts.force(), contacts.tangent());
        let velocity = contacts.steady_velocity().unwrap_or(0.0);
        Self { contacts, position, force, velocity, back: 0.0, slope }
    }

    /// A copy of its contacts after an advance at constant velocity in the time `duration`.
    ///
    /// # Errors
    /// Those of [`RateDependentContacts::step`].
    pub fn contacts_ahead(
        &self,
        advance: f64,
        duration: f64,
        mut watch: &Watch<'_>,
    ) -> Result<Box<dyn RateDependentContacts>> {
        let mut contacts = self.contacts.copy();
        contacts.step(advance, duration, &mut watch)?;
        Ok(contacts)
    }

    /// Simplifies the state of its contacts after an accepted step.
    pub(super) fn settle(&mut self) {
        self.contacts.settle();
        // The same force but for rounding; a cell that is restored takes it from its contacts, too.
        self.force = self.contacts.force();
    }

    /// The cell after an advance that led to `force`. The slope stays if the advance is within `accuracy`.
    pub fn advanced(
        &self,
        contacts: Box<dyn RateDependentContacts>,
        advance: f64,
        force: f64,
        velocity: f64,
        accuracy: f64,
    ) -> Self {
        // A quotient of differences below the accuracy would be noise.
        let slope = if advance > accuracy { (force - self.force) / advance } else { self.slope };
        Self { contacts, position: self.position + advance, force, velocity, back: 0.0, slope }
    }
}
