//! A cell of a slider and its contacts.

use crate::Result;
use crate::monitor::Watch;
use crate::rate_dependent::RateDependentContacts;

/// A cell and its contacts at one moment.
#[derive(Debug)]
pub struct SlidingCell {
    pub contacts: Box<dyn RateDependentContacts>,
    /// X_j.
    pub position: f64,
    /// F_j.
    pub force: f64,
    /// Ẋ_j.
    pub velocity: f64,
    /// dF/dX on the last advance, the first guess for the next one.
    pub slope: f64,
}

impl SlidingCell {
    /// A cell at rest at a position.
    pub fn at_rest(contacts: Box<dyn RateDependentContacts>, position: f64) -> Self {
        let (force, slope) = (contacts.force(), contacts.tangent());
        Self { contacts, position, force, velocity: 0.0, slope }
    }

    /// Its contacts after an advance at constant velocity in a time.
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

    /// The cell after an advance that took its contacts to a force. An advance within `accuracy` tells nothing of the slope.
    pub fn advanced(
        &self,
        contacts: Box<dyn RateDependentContacts>,
        advance: f64,
        force: f64,
        velocity: f64,
        accuracy: f64,
    ) -> Self {
        let slope = if advance > accuracy { (force - self.force) / advance } else { self.slope };
        Self { contacts, position: self.position + advance, force, velocity, slope }
    }
}
