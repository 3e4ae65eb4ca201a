//! The lives of contacts on a lattice: those of the ensemble, or identical ones.

use serde::{Deserialize, Serialize};

use crate::ensemble::Ensemble;
use crate::ensemble::lives::{ContactLife, Drawn, Lives};

/// The threshold of a contact, and its position in its random streams.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct BirthRecord {
    pub(super) threshold: f64,
    drawn: Drawn,
}

/// Draws the lives of contacts: those of [`Ensemble::pull`].
#[derive(Debug, Clone)]
pub(super) struct LatticeBirths {
    lives: Lives,
    /// The life after every break, if both distributions are points: then nothing is drawn or stored.
    identical: Option<ContactLife>,
}

impl LatticeBirths {
    pub(super) fn new(ensemble: &Ensemble) -> Self {
        let contacts = &ensemble.contacts;
        let point = |law: &crate::law::SharedLaw| {
            law.atoms().first().filter(|atom| atom.weight == 1.0).map(|atom| atom.position)
        };
        // The original automaton has identical contacts: a lattice without stored lives takes a
        // third of the memory.
        let both = point(&contacts.thresholds).zip(point(&contacts.reforming));
        let identical = both.map(|(threshold, stretch)| ContactLife { stretch, threshold });
        Self { lives: Lives::in_any_order(ensemble), identical }
    }

    /// Whether nothing need be kept of contacts.
    pub(super) fn identical(&self) -> bool {
        self.identical.is_some()
    }

    /// Contact `number` at the start: its stretch and its record.
    pub(super) fn first(&mut self, number: usize) -> (f64, BirthRecord) {
        let life = self.lives.first(number as u64);
        (life.stretch, BirthRecord { threshold: life.threshold, drawn: self.lives.drawn() })
    }

    /// The threshold of contact `number`.
    pub(super) fn threshold(&self, born: &[BirthRecord], number: usize) -> f64 {
        self.identical.map_or_else(|| born[number].threshold, |life| life.threshold)
    }

    /// Draws the next life of the contact `number`(); returns its previous threshold, and the new life.
    #[inline]
    pub(super) fn next(
        &mut self,
        born: &mut [BirthRecord],
        number: impl FnOnce() -> usize,
    ) -> (f64, ContactLife) {
        if let Some(life) = self.identical {
            return (life.threshold, life);
        }
        let number = number();
        let contact = &mut born[number];
        let before = contact.threshold;
        self.lives.resume(number as u64, contact.drawn, before);
        let life = self.lives.next();
        // Only the position in the streams is stored, from which any later life of the contact
        // follows.
        *contact = BirthRecord { threshold: life.threshold, drawn: self.lives.drawn() };
        (before, life)
    }
}
