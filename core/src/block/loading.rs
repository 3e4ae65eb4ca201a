//! Loading of the slider's base, and the drive at which it is in equilibrium with the contacts.

use crate::population::Response;
use crate::record::Quantity;
use crate::{Error, Result};

/// Loading of the slider's base.
///
/// Its *drive* is the quantity that is imposed: the position X_T of the slider's top behind a spring, the position X of the
/// base of a rigid slider (K = ∞), or a force (K → 0).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Loading {
    /// A block of shear stiffness K, force per length: K(X_T − X) = F.
    Spring(f64),
    /// A rigid slider: X is imposed, and every state is stable.
    Rigid,
    /// An imposed force.
    Force,
}

impl Loading {
    /// Refuses a stiffness that is not a finite number above 0.
    pub(super) fn check(self) -> Result<()> {
        match self {
            Self::Spring(stiffness) if !(stiffness > 0.0 && stiffness.is_finite()) => {
                Err(Error::invalid("stiffness", "a finite stiffness above 0", stiffness))
            }
            _ => Ok(()),
        }
    }

    /// Equilibrium drive at position X and force F: X + F/K, X or F.
    pub fn drive(self, position: f64, force: f64) -> f64 {
        match self {
            Self::Spring(stiffness) => position + force / stiffness,
            Self::Rigid => position,
            Self::Force => force,
        }
    }

    /// Derivative of the equilibrium drive with respect to X: 1 + F'/K, 1 or F'. An equilibrium is stable if it is above 0.
    pub fn rise(self, tangent: f64) -> f64 {
        match self {
            Self::Spring(stiffness) => 1.0 + tangent / stiffness,
            Self::Rigid => 1.0,
            Self::Force => tangent,
        }
    }

    /// Net force on the slider at a fixed drive: K(X_T − X) − F, 0 for a rigid slider.
    pub fn excess(self, drive: f64, position: f64, force: f64) -> f64 {
        match self {
            Self::Spring(stiffness) => stiffness * (drive - position) - force,
            Self::Rigid => 0.0,
            Self::Force => drive - force,
        }
    }

    /// Minus the derivative of the net force with respect to X at a fixed drive: K + F', ∞ or F'.
    pub(super) fn resistance(self, tangent: f64) -> f64 {
        match self {
            Self::Spring(stiffness) => stiffness + tangent,
            Self::Rigid => f64::INFINITY,
            Self::Force => tangent,
        }
    }

    /// The quantity of the drive: a length or a force.
    pub(super) fn drive_quantity(self) -> Quantity {
        match self {
            Self::Spring(_) | Self::Rigid => Quantity::Length,
            Self::Force => Quantity::Force,
        }
    }

    /// Force of the spring at a fixed drive; `force` for a rigid slider.
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

    /// Work of the drive per advance of X in equilibrium: F dX_T/dX behind a spring, otherwise F.
    pub(super) fn work(self, response: Response) -> f64 {
        match self {
            Self::Spring(_) => response.force * self.rise(response.tangent),
            Self::Rigid | Self::Force => response.force,
        }
    }

    /// Work of the drive for an advance of X at a fixed drive, which only an imposed force does.
    pub(super) fn work_at_rest(self, drive: f64, advance: f64) -> f64 {
        match self {
            Self::Spring(_) | Self::Rigid => 0.0,
            Self::Force => drive * advance,
        }
    }
}
