//! A cell on its friction curve.

use super::curve::Curve;
use super::{CellEnergies, Fall, Slopes};

/// A cell of scale s on a curve of contacts: its force is s F(X/s).
pub(super) struct Cell<'a> {
    pub curve: &'a Curve,
    /// X, from where the curve begins.
    pub advance: f64,
    pub scale: f64,
    /// Whether it moves without its contacts.
    pub free: bool,
}

impl Cell<'_> {
    /// Where it is on the curve after an advance.
    pub fn place(&self, by: f64) -> f64 {
        self.beyond(if self.free { 0.0 } else { by })
    }

    /// The same of its contacts, whether it moves with them or not.
    pub fn beyond(&self, by: f64) -> f64 {
        (self.advance + by) / self.scale
    }

    /// What is left of a force that pulls at it after an advance, and its tangent there.
    pub fn residual(&self, by: f64, pull: f64) -> (f64, f64) {
        let (force, slope) = self.curve.response(self.place(by));
        (pull - self.scale * force, if self.free { 0.0 } else { slope })
    }

    /// Its force where it stands.
    pub fn force(&self) -> f64 {
        self.scale * self.curve.response(self.place(0.0)).0
    }

    pub fn slopes(&self, by: f64) -> Slopes {
        if self.free {
            return Slopes::default();
        }
        self.curve.slopes(self.place(0.0), self.place(by.max(0.0)))
    }

    /// The first advance, up to `by`, from which on the slope is below `slope`, or where contacts break together.
    pub fn fall(&self, by: f64, slope: f64) -> Option<Fall> {
        if self.free {
            return None;
        }
        let by = by.max(0.0);
        let Fall { on, together } = self.curve.fall(self.place(0.0), self.place(by), slope)?;
        Some(Fall { on: (on * self.scale - self.advance).clamp(0.0, by), together })
    }

    /// What its contacts have done from the beginning of the curve to an advance from here.
    pub fn done(&self, by: f64) -> CellEnergies {
        self.curve.account(self.beyond(by)).scaled(self.scale)
    }
}
