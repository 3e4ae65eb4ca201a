//! Sums of force and energy over contacts that move together.

use serde::{Deserialize, Serialize};

use super::queue::QueuedContact;
use crate::contacts::Stiffness;
use crate::numerics::compensated::Compensated;

/// Sums of k, k(o − b) and k(o − b)² over contacts of stretch x = X − o, from which for any X
///
/// Σ kx = d Σk − Σk(o − b) and Σ kx² = d² Σk − 2d Σk(o − b) + Σk(o − b)², d = X − b.
///
/// The `base` b is kept near X, so that little cancels. Stiffnesses are in [`Stiffness::unit`].
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Sums {
    pub(super) base: f64,
    stiffness: Stiffness,
    moments: [Compensated; 3],
}

impl Sums {
    pub(super) fn new(stiffness: Stiffness) -> Self {
        Self { base: 0.0, stiffness, moments: Default::default() }
    }

    /// Recomputes the sums, with X as the base.
    pub(super) fn renew<'a>(&mut self, position: f64, contacts: impl Iterator<Item = &'a QueuedContact>) {
        (self.base, self.moments) = (position, Default::default());
        contacts.for_each(|contact| self.add(contact));
    }

    #[inline]
    pub(super) fn add(&mut self, contact: &QueuedContact) {
        self.weigh(contact, 1.0);
    }

    #[inline]
    pub(super) fn remove(&mut self, contact: &QueuedContact) {
        self.weigh(contact, -1.0);
    }

    #[inline]
    fn weigh(&mut self, contact: &QueuedContact, sign: f64) {
        let (k, o) = (sign * self.stiffness(contact), contact.origin - self.base);
        // Removing what was added would leave rounding errors that grow with the number of breaks;
        // compensated sums keep them at that of one addition (A. Neumaier, Z. Angew. Math. Mech.
        // 54, 39 (1974)).
        let terms = [k, k * o, k * o * o];
        self.moments.iter_mut().zip(terms).for_each(|(moment, term)| moment.add(term));
    }

    #[inline]
    fn stiffness(&self, contact: &QueuedContact) -> f64 {
        self.stiffness.weight(contact.threshold)
    }

    /// ½k x² of a contact.
    #[inline]
    pub(super) fn energy(&self, contact: &QueuedContact, position: f64) -> f64 {
        0.5 * self.stiffness(contact) * (position - contact.origin).powi(2)
    }

    /// Σ k: the slope of the force.
    #[inline]
    pub(super) fn slope(&self) -> f64 {
        self.moments[0].value()
    }

    /// Σ kx.
    #[inline]
    pub(super) fn force(&self, position: f64) -> f64 {
        (position - self.base) * self.slope() - self.moments[1].value()
    }

    /// Σ ½k x².
    pub(super) fn elastic(&self, position: f64) -> f64 {
        let ([stiffness, first, second], d) =
            (self.moments.map(|moment| moment.value()), position - self.base);
        0.5 * (d * (d * stiffness - 2.0 * first) + second)
    }
}
