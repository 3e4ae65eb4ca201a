//! The master equation: the distribution of stretches, and the friction that follows from it.

use num_complex::Complex64;

use crate::Result;
use crate::contacts::{Contacts, Initial};
use crate::law::Atom;
use crate::monitor::Monitor;

/// The master equation of an interface and its start.
#[derive(Debug, Clone)]
pub struct MasterEquation {}

/// An extremum: its value and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremum {
    /// Position X.
    pub position: f64,
    /// Value there; at a jump, the left limit.
    pub value: f64,
}

/// A distribution of stretches: a density on given stretches, and point masses.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretches {
    /// Density at each stretch asked for, per length.
    pub density: Vec<f64>,
    /// Point masses, by rising stretch.
    pub atoms: Vec<Atom>,
}

/// Steady sliding.
#[derive(Debug, Clone)]
pub struct SteadyState {}

/// The relaxation spectrum: exponents s_j with F − F_k = Σ c_j exp(s_j X).
#[derive(Debug, Clone)]
pub struct Relaxation {}

/// The solution of a pull from X = 0: functions of X in `[0, distance]`. Forces are totals, N_c⟨k⟩ included.
#[derive(Debug, Clone)]
pub struct Pull {}

impl MasterEquation {
    /// # Errors
    /// A start or re-forming law with mass where no contact survives.
    pub fn new(_contacts: Contacts, _initial: Initial) -> Result<Self> {
        todo!()
    }
    /// Steady state.
    pub fn steady_state(&self) -> SteadyState {
        todo!()
    }
    /// Relaxation spectrum; `None` of its roots where there are none.
    pub fn relaxation(&self) -> Relaxation {
        todo!()
    }
    /// # Errors
    /// Stopped, or accuracy not reached.
    pub fn pull(&self, _distance: f64, _tolerance: f64, _monitor: &mut dyn Monitor) -> Result<Pull> {
        todo!()
    }
}
impl SteadyState {
    /// F_k.
    pub fn kinetic_friction(&self) -> f64 {
        todo!()
    }
    /// Γ_s.
    pub fn breaking_rate(&self) -> f64 {
        todo!()
    }
    /// Q_s on given stretches.
    pub fn stretch_density(&self, _stretches: &[f64]) -> Stretches {
        todo!()
    }
}
impl Relaxation {
    /// X*: infinite where the force never settles.
    pub fn length(&self) -> f64 {
        todo!()
    }
    /// The paper's estimate x̄²/σ; infinite for identical thresholds.
    pub fn paper_estimate(&self) -> f64 {
        todo!()
    }
    /// Roots s_j with Im ≥ 0, slowest first.
    pub fn roots(&self) -> &[Complex64] {
        todo!()
    }
}
impl Pull {
    /// F(X), after the break where contacts break together at X.
    pub fn force(&self, _position: f64) -> f64 {
        todo!()
    }
    /// F'(X), from the right.
    pub fn slope(&self, _position: f64) -> f64 {
        todo!()
    }
    /// Γ(X), its density part.
    pub fn breaking_rate(&self, _position: f64) -> f64 {
        todo!()
    }
    /// Atoms of Γ: positions at which a finite fraction breaks together.
    pub fn breaking_atoms(&self) -> &[Atom] {
        todo!()
    }
    /// Standard deviation of the force of N_c contacts drawn at random (the finite-N band).
    pub fn force_std(&self, _position: f64, _count: f64) -> f64 {
        todo!()
    }
    /// Q(x; X).
    pub fn stretch_density(&self, _position: f64, _stretches: &[f64]) -> Stretches {
        todo!()
    }
    /// F_s, X_s; `None` where the force still rises at the end.
    pub fn static_friction(&self) -> Option<Extremum> {
        todo!()
    }
    /// K_c; infinite where the force jumps down.
    pub fn critical_stiffness(&self) -> f64 {
        todo!()
    }
    /// Estimated error of F/(N_c⟨k⟩).
    pub fn error_estimate(&self) -> f64 {
        todo!()
    }
}
