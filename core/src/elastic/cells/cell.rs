//! A cell on its friction curve.

use super::curve::Curve;
use super::{CellEnergies, Instability, Slopes};

/// A cell of scale s and area a on the friction curve F(X) of cells of scale 1 and area 1: its force is a s F(X/s).
pub(super) struct Cell<'a> {
    pub curve: &'a Curve,
    /// X from the beginning of the curve.
    pub advance: f64,
    pub scale: f64,
    pub area: f64,
    /// Whether it is detached from its contacts.
    pub free: bool,
}

impl Cell<'_> {
    /// X/s after an advance.
    pub fn place(&self, by: f64) -> f64 {
        self.beyond(if self.free { 0.0 } else { by })
    }

    /// X/s after an advance, whether the cell is detached or not.
    pub fn beyond(&self, by: f64) -> f64 {
        (self.advance + by) / self.scale
    }

    /// `pull` less its force after an advance, and its tangent there.
    pub fn residual(&self, by: f64, pull: f64) -> (f64, f64) {
        let (force, slope) = self.curve.response(self.place(by));
        (pull - self.area * self.scale * force, if self.free { 0.0 } else { self.area * slope })
    }

    /// Its force where it is.
    pub fn force(&self) -> f64 {
        self.area * self.scale * self.curve.response(self.place(0.0)).0
    }

    /// Least and largest tangent over an advance.
    pub fn slopes(&self, by: f64) -> Slopes {
        if self.free {
            return Slopes::default();
        }
        let Slopes { least, largest } = self.curve.slopes(self.place(0.0), self.place(by.max(0.0)));
        Slopes { least: self.area * least, largest: self.area * largest }
    }

    /// See [`super::Cells::instability`].
    pub fn instability(&self, by: f64, slope: f64) -> Option<Instability> {
        if self.free {
            return None;
        }
        let by = by.max(0.0);
        let found = self.curve.instability(self.place(0.0), self.place(by), slope / self.area)?;
        let Instability { at, together } = found;
        Some(Instability { at: (at * self.scale - self.advance).clamp(0.0, by), together })
    }

    /// Energies and breaks of its contacts from the beginning of the curve to an advance from here.
    pub fn done(&self, by: f64) -> CellEnergies {
        self.curve.energies(self.beyond(by)).scaled(self.scale).of_area(self.area)
    }
}
