//! The lag of contacts behind their cell.
//!
//! Far from an event cells move by less than the accuracy of a step. Their contacts are moved only when this has added up to
//! the accuracy; until then their force is that of the attached contacts, F + F' × lag. This is possible for contacts whose
//! force does not change at rest.

use serde::{Deserialize, Serialize};

/// The motion of a cell that its contacts have not followed yet.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactLag {
    /// The displacement, 0 or above.
    pub by: f64,
    /// The time that it took.
    pub during: f64,
}

impl ContactLag {
    /// The path of contacts that follow a further advance of their cell: displacements ≥ 0 and times.
    pub fn path(self, advance: f64, duration: f64) -> impl Iterator<Item = (f64, f64)> {
        // A lag that took a time is followed first: contacts formed in a slip must not have the ages of the rest before it.
        let waited = (self.during > 0.0).then_some((self.by, self.during));
        waited.into_iter().chain([(advance, duration)])
    }
}
