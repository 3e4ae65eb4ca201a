//! A cell of a slider and its contacts.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::lag::ContactLag;
use crate::Result;
use crate::contacts::FreeFriction;
use crate::energy::ContactEnergies;
use crate::monitor::Watch;
use crate::rate_dependent::RateDependentContacts;

/// The state of a cell and of its contacts.
#[derive(Debug, Clone)]
pub struct SlidingCell {
    /// Shared between states between which they have not moved.
    pub contacts: Arc<dyn RateDependentContacts>,
    /// a_j, the area of the contacts, by which K_0, η and M of the cell are multiplied.
    pub area: f64,
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
    pub trend: SlopeTrend,
    /// The motion of the cell that its contacts have not followed yet.
    pub lag: ContactLag,
    /// Of the contacts where they are.
    pub known: KnownContacts,
}

/// How the secant slope has changed from one advance to the next.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct SlopeTrend {
    /// The change.
    change: f64,
    /// Distance between the middles of the two advances.
    between: f64,
    /// The last advance.
    last: f64,
}

impl SlopeTrend {
    /// After another advance, at which the slope changed by this much.
    fn next(self, change: f64, advance: f64) -> Self {
        Self { change, between: 0.5 * (self.last + advance), last: advance }
    }

    /// The change of the slope in the next advance, extrapolated.
    fn ahead(self, advance: f64) -> f64 {
        /// Largest factor by which a change is extrapolated.
        const MOST: f64 = 2.0;
        if self.between == 0.0 {
            return 0.0;
        }
        self.change * (0.5 * (self.last + advance) / self.between).min(MOST)
    }
}

/// What is asked of contacts in each step, computed once.
#[derive(Debug, Clone, Copy)]
pub struct KnownContacts {
    pub force: f64,
    pub tangent: f64,
    /// Friction of the contacts that are free.
    pub free: FreeFriction,
    /// Energies and breaks; `None` until the step is accepted.
    pub energies: Option<ContactEnergies>,
    /// Whether the contacts may lag behind their cell.
    pub may_lag: bool,
    /// Whether they may be moved backward.
    pub may_turn: bool,
}

impl KnownContacts {
    fn of(contacts: &dyn RateDependentContacts, force: f64) -> Self {
        let (may_lag, may_turn) = (contacts.is_constant_at_rest(), contacts.may_turn());
        let free = contacts.free_friction();
        Self { force, tangent: contacts.tangent(), free, energies: None, may_lag, may_turn }
    }
}

impl SlidingCell {
    /// A cell at a position: at rest, or at the velocity at which its contacts slide steadily.
    pub fn new(contacts: Box<dyn RateDependentContacts>, position: f64) -> Self {
        let (force, slope) = (contacts.force(), contacts.tangent());
        let velocity = contacts.steady_velocity().unwrap_or(0.0);
        let energies = Some(contacts.energies());
        let known = KnownContacts { energies, ..KnownContacts::of(contacts.as_ref(), force) };
        let area = contacts.area();
        let (contacts, lag, trend) = (Arc::from(contacts), ContactLag::default(), SlopeTrend::default());
        Self { contacts, area, position, force, velocity, back: 0.0, slope, trend, lag, known }
    }

    /// A copy of its contacts after an advance of the cell at constant velocity in the time `duration`.
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
        for (by, during) in self.lag.path(advance, duration) {
            contacts.step(by, during, &mut watch)?;
        }
        Ok(contacts)
    }

    /// Energies and breaks of the contacts.
    pub fn energies(&self) -> ContactEnergies {
        self.known.energies.unwrap_or_else(|| self.contacts.energies())
    }

    /// Simplifies the state of its contacts after an accepted step in which they have moved.
    pub(super) fn settle(&mut self) {
        if self.known.energies.is_some() {
            return;
        }
        if let Some(contacts) = Arc::get_mut(&mut self.contacts) {
            contacts.settle();
        }
        self.update_known();
        if self.lag == ContactLag::default() {
            self.force = self.known.force;
        }
    }

    /// Asks the contacts anew.
    fn update_known(&mut self) {
        let (contacts, force) = (self.contacts.as_ref(), self.contacts.force());
        let energies = Some(contacts.energies());
        self.known = KnownContacts { energies, ..KnownContacts::of(contacts, force) };
    }

    /// The cell after an advance that led to `force`, with contacts that have followed it. The slope stays if the advance is
    /// within `accuracy`.
    pub fn advanced(
        &self,
        contacts: Box<dyn RateDependentContacts>,
        advance: f64,
        force: f64,
        velocity: f64,
        accuracy: f64,
    ) -> Self {
        let (known, lag) = (KnownContacts::of(contacts.as_ref(), force), ContactLag::default());
        // A quotient of differences below the accuracy would be noise.
        let (slope, trend) = if advance.abs() > accuracy {
            let slope = (force - self.force) / advance;
            (slope, self.trend.next(slope - self.slope, advance))
        } else {
            (self.slope, self.trend)
        };
        let (contacts, area, position) = (Arc::from(contacts), self.area, self.position + advance);
        Self { contacts, area, position, force, velocity, back: 0.0, slope, trend, lag, known }
    }

    /// The cell after an advance so small that its contacts stay where they are.
    pub fn leaving_contacts(&self, advance: f64, duration: f64, velocity: f64) -> Self {
        let lag = ContactLag { by: self.lag.by + advance, during: self.lag.during + duration };
        let force = self.force_at(advance);
        Self { position: self.position + advance, force, velocity, back: 0.0, lag, ..self.clone() }
    }

    /// Extrapolated secant slope of the advance in a time; breaks only lower it.
    pub fn slope_ahead(&self, duration: f64) -> f64 {
        (self.slope + self.trend.ahead(self.velocity.max(0.0) * duration)).min(self.known.tangent)
    }

    /// F after a small advance without breaks.
    pub fn force_at(&self, advance: f64) -> f64 {
        self.known.force + self.known.tangent * (self.lag.by + advance)
    }
}
