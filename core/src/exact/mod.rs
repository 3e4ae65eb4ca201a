//! Closed forms: friction curves, steady states and noise that are known without solving anything.
//!
//! Forces are per total stiffness, F/(N_c⟨k⟩): the mean stretch of the contacts, in the unit of the
//! thresholds. Unless a form says otherwise all contacts start and re-form relaxed, Q_ini = R = δ(x).
//! Then, with p_n the n-fold convolution of P_c, for every P_c
//!
//! F'(X) = 1 − X Σ_{n≥1} p_n(X)/n.
//!
//! The forms of one family of P_c sum this series; [`Quenched`] describes thresholds that contacts keep, and the values in steady
//! sliding follow from moments. They share distributions and root finding with the solvers, but no equation.

mod erlang;
mod extrema;
mod gamma;
mod gaussian;
mod identical;
mod quenched;
mod rectangular;
mod steady;

pub use erlang::Erlang;
pub use gamma::Gamma;
pub use gaussian::Gaussian;
pub use identical::Identical;
pub use quenched::Quenched;
pub use rectangular::Rectangular;
pub use steady::{
    kinetic_friction, kinetic_friction_per_threshold, steady_variance, steady_variance_per_threshold,
};

use crate::Result;
use crate::error::{not_negative, positive};

/// A friction curve F(X) in closed form.
pub trait ClosedForm {
    /// Whether the parameters are those of a law.
    ///
    /// # Errors
    /// The first that is not.
    fn check(&self) -> Result<()>;

    /// The position up to which the sums stay short, a length. Beyond it they are not computed.
    fn reach(&self) -> f64 {
        f64::MAX
    }

    /// Whether a position is beyond the reach, or no number.
    fn is_beyond(&self, position: f64) -> bool {
        position.is_nan() || position > self.reach()
    }

    /// F(X)/(N_c⟨k⟩) for X ≥ 0; NaN beyond the reach; after the break where contacts break together.
    fn force(&self, position: f64) -> f64;

    /// F'(X)/(N_c⟨k⟩), from the right.
    fn slope(&self, position: f64) -> f64;

    /// F_k/(N_c⟨k⟩), the force of steady sliding.
    fn kinetic_friction(&self) -> f64;

    /// The maximum of F over X > 0 as (X_s, F_s); `None` where F only rises.
    fn static_friction(&self) -> Option<(f64, f64)>;

    /// K_c/(N_c⟨k⟩) = max(0, −min F'): a softer slider block is unstable; infinite where F jumps down.
    fn critical_stiffness(&self) -> f64;
}
