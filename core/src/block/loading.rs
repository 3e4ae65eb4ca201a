//! What pulls the slider's bottom, and the drive at which it balances the contacts.

use crate::population::Response;
use crate::record::Quantity;
use crate::{Error, Result};

/// What pulls the slider's bottom.
///
/// Its *drive* is what is set from outside: the position X_T of the slider's top behind a spring, the position X of
/// the bottom itself where the slider is rigid (K = ∞), the force where that is imposed (K → 0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loading {
    /// A block of shear stiffness K, force per length: K(X_T − X) = F.
    Spring(f64),
    /// A rigid slider: X is imposed and nothing is ever unstable.
    Rigid,
    /// An imposed force.
    Force,
}

impl Loading {
    /// Whether a stiffness is one.
    pub(super) fn check(self) -> Result<()> {
        match self {
            Self::Spring(stiffness) if !(stiffness > 0.0 && stiffness.is_finite()) => {
                Err(Error::invalid("stiffness", "a finite stiffness above 0", stiffness))
            }
            _ => Ok(()),
        }
    }

    /// The drive in balance with the force F at X: X + F/K, X or F.
    pub fn drive(self, position: f64, force: f64) -> f64 {
        match self {
            Self::Spring(stiffness) => position + force / stiffness,
            Self::Rigid => position,
            Self::Force => force,
        }
    }

    /// The derivative of the drive by X, 1 + F'/K, 1 or F': in balance the slider is stable where it is above 0.
    pub fn rise(self, tangent: f64) -> f64 {
        match self {
            Self::Spring(stiffness) => 1.0 + tangent / stiffness,
            Self::Rigid => 1.0,
            Self::Force => tangent,
        }
    }

    /// The force by which the pull exceeds F at a given drive: K(X_T − X) − F; 0 for a rigid slider.
    pub fn excess(self, drive: f64, position: f64, force: f64) -> f64 {
        match self {
            Self::Spring(stiffness) => stiffness * (drive - position) - force,
            Self::Rigid => 0.0,
            Self::Force => drive - force,
        }
    }

    /// The derivative of the excess by X at a given drive, with the sign of resistance: K + F', or F'.
    pub(super) fn resistance(self, tangent: f64) -> f64 {
        match self {
            Self::Spring(stiffness) => stiffness + tangent,
            Self::Rigid => f64::INFINITY,
            Self::Force => tangent,
        }
    }

    /// What the drive is.
    pub(super) fn drive_quantity(self) -> Quantity {
        match self {
            Self::Spring(_) | Self::Rigid => Quantity::Length,
            Self::Force => Quantity::Force,
        }
    }

    /// Force of the spring at a given drive, `force` where there is no spring.
    pub(super) fn pull(self, drive: f64, position: f64, force: f64) -> f64 {
        match self {
            Self::Spring(stiffness) => stiffness * (drive - position),
            Self::Rigid => force,
            Self::Force => drive,
        }
    }

    /// Energy of the spring, ½K(X_T − X)².
    pub(super) fn stored(self, drive: f64, position: f64) -> f64 {
        match self {
            Self::Spring(stiffness) => 0.5 * stiffness * (drive - position).powi(2),
            Self::Rigid | Self::Force => 0.0,
        }
    }

    /// Work of the drive per advance of X in balance: F dX_T/dX behind a spring, else F.
    pub(super) fn work(self, response: Response) -> f64 {
        match self {
            Self::Spring(_) => response.force * self.rise(response.tangent),
            Self::Rigid | Self::Force => response.force,
        }
    }

    /// Work of the drive when X advances at a given drive: that of an imposed force alone.
    pub(super) fn work_at_rest(self, drive: f64, advance: f64) -> f64 {
        match self {
            Self::Spring(_) | Self::Rigid => 0.0,
            Self::Force => drive * advance,
        }
    }
}
