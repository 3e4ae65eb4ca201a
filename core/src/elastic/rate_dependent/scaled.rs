//! Contacts whose lengths are larger than those of others, and cells of a larger area.

use crate::contacts::FreeFriction;
use crate::energy::ContactEnergies;
use crate::monitor::Monitor;
use crate::rate_dependent::{ContactsState, RateDependentContacts, StretchInterval};
use crate::{Error, Result};

/// Contacts all of whose lengths, and with them forces, are s times those of others, and of which there are a times as many, on an
/// area a times as large: F(X, t) = a s F̂(X/s, t).
#[derive(Debug)]
pub struct Scaled {
    contacts: Box<dyn RateDependentContacts>,
    scale: f64,
    area: f64,
}

impl Scaled {
    /// Contacts s times as large as these.
    ///
    /// # Errors
    /// A scale that is not above 0.
    pub fn new(contacts: Box<dyn RateDependentContacts>, scale: f64) -> Result<Self> {
        if scale > 0.0 && scale.is_finite() {
            return Ok(Self { contacts, scale, area: 1.0 });
        }
        Err(Error::invalid("scale", "a scale above 0, so that thresholds are", scale))
    }

    /// The same on an area `area` times as large.
    ///
    /// # Errors
    /// An area that is not above 0.
    pub fn on_area(self, area: f64) -> Result<Self> {
        if area > 0.0 && area.is_finite() {
            return Ok(Self { area: area * self.area, ..self });
        }
        Err(Error::invalid("area", "a number above 0", area))
    }
}

impl RateDependentContacts for Scaled {
    fn position(&self) -> f64 {
        self.scale * self.contacts.position()
    }

    fn time(&self) -> f64 {
        self.contacts.time()
    }

    fn force(&self) -> f64 {
        self.area * self.scale * self.contacts.force()
    }

    fn tangent(&self) -> f64 {
        self.area * self.contacts.tangent()
    }

    fn area(&self) -> f64 {
        self.area
    }

    fn free_friction(&self) -> FreeFriction {
        let FreeFriction { force, viscosity } = self.contacts.free_friction();
        FreeFriction { force: self.area * self.scale * force, viscosity: self.area * viscosity }
    }

    fn energies(&self) -> ContactEnergies {
        let energies = self.contacts.energies();
        let ContactEnergies { elastic, lost, strengthening, sliding, .. } = energies;
        let [elastic, lost, strengthening, sliding] = [elastic, lost, strengthening, sliding]
            .map(|energy| self.area * (self.scale * self.scale * energy));
        ContactEnergies { elastic, lost, strengthening, sliding, ..energies }
    }

    fn free(&self) -> f64 {
        self.contacts.free()
    }

    fn mean_threshold(&self) -> Option<f64> {
        self.contacts.mean_threshold().map(|mean| self.scale * mean)
    }

    fn is_constant_at_rest(&self) -> bool {
        self.contacts.is_constant_at_rest()
    }

    fn may_turn(&self) -> bool {
        self.contacts.may_turn()
    }

    fn steady_velocity(&self) -> Option<f64> {
        self.contacts.steady_velocity().map(|velocity| self.scale * velocity)
    }

    fn stretches(&self) -> Vec<StretchInterval> {
        self.contacts.stretches().into_iter().map(|portion| portion.scaled(self.scale)).collect()
    }

    fn step(&mut self, by: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()> {
        // Only lengths are scaled: rates of ageing and delays are the same in all cells.
        self.contacts.step(by / self.scale, during, monitor)
    }

    fn settle(&mut self) {
        self.contacts.settle();
    }

    fn rough(&self) -> Option<Box<dyn RateDependentContacts>> {
        let scaled = |contacts| Box::new(Self { contacts, ..*self }) as Box<dyn RateDependentContacts>;
        self.contacts.rough().map(scaled)
    }

    fn copy(&self) -> Box<dyn RateDependentContacts> {
        Box::new(Self { contacts: self.contacts.copy(), ..*self })
    }

    fn state(&self) -> ContactsState {
        self.contacts.state()
    }

    fn restore(&mut self, state: &ContactsState) -> Result<()> {
        self.contacts.restore(state)
    }
}
