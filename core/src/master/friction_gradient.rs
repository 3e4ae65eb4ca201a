//! The derivatives of static and kinetic friction, relaxation length and critical stiffness by parameters.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::life_change::LifeChange;
use super::pull::Pull;
use super::relaxation::Relaxation;
use super::{Extremum, Gradient};
use crate::Result;
use crate::law::EIGHTH_ORDER;
use crate::life::{Life, LifeDerivative};
use crate::monitor::{Aside, Monitor, Part};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;

/// The derivatives of friction by a parameter θ; NaN where a quantity is not finite or not known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct FrictionGradient {
    /// ∂F_s/∂θ; `None` if the static friction is not reached.
    pub static_friction: Option<f64>,
    /// ∂F_k/∂θ.
    pub kinetic_friction: f64,
    /// ∂X*/∂θ.
    pub relaxation_length: f64,
    /// ∂K_c/∂θ; 0 where K_c is 0.
    pub critical_stiffness: f64,
}

impl Pull {
    /// The derivatives of F_s, F_k, X* and K_c by one parameter, for the propagation of errors.
    ///
    /// # Errors
    /// Those of [`Self::friction_gradients`].
    pub fn friction_gradient(&self, parameter: &str) -> Result<FrictionGradient> {
        self.friction_gradient_with(parameter, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::friction_gradient`]; stopped by the monitor.
    pub fn friction_gradient_with(
        &self,
        parameter: &str,
        monitor: &mut dyn Monitor,
    ) -> Result<FrictionGradient> {
        self.friction_gradients_with(&[parameter], monitor).map(|mut one| one.swap_remove(0))
    }

    /// The derivatives of F_s, F_k, X* and K_c by several of [`Self::parameters`].
    ///
    /// ∂F_s is ∂F/∂θ at a smooth maximum, whose motion has no effect at first order; ∂K_c is minus the slope of ∂F/∂θ
    /// where F falls most steeply. At a kink of F the motion of the kink adds to them. With C the mean life, F_k =
    /// N_c⟨k⟩ ∫m/C gives ∂F_k = N_c⟨k⟩ (∫m_θ − (F_k/N_c⟨k⟩) ∫S_θ)/C; the root φ̂(s₁) = 1 that sets X* = −1/Re s₁ moves by
    /// s₁ Ŝ_θ(s₁)/φ̂'(s₁), since φ̂_θ = −s Ŝ_θ.
    ///
    /// # Errors
    /// Those of [`Pull::gradients`] and of [`super::MasterEquation::relaxation`].
    pub fn friction_gradients(&self, parameters: &[&str]) -> Result<Vec<FrictionGradient>> {
        self.friction_gradients_with(parameters, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::friction_gradients`]; stopped by the monitor.
    pub fn friction_gradients_with(
        &self,
        parameters: &[&str],
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<FrictionGradient>> {
        let changes = self.equation.life_changes(parameters, &mut Part::new(monitor, 0.0, 0.4))?;
        let gradients = self.gradients_of(&changes, &mut Part::new(monitor, 0.4, 0.4))?;
        let relaxation = self.equation.relaxation_with(&mut Part::new(monitor, 0.8, 0.2))?;
        let friction = |(change, gradient)| self.friction_gradient_of(change, gradient, &relaxation);
        let mut found: Vec<FrictionGradient> = changes.iter().zip(&gradients).map(friction).collect();
        for (gradient, name) in found.iter_mut().zip(parameters) {
            if relaxation.length().is_finite() && gradient.relaxation_length.is_nan() {
                let aside = &mut Aside { fraction: 1.0, monitor: &mut *monitor };
                gradient.relaxation_length = self.relaxation_difference(name, aside)?;
            }
        }
        Ok(found)
    }

    /// ∂X*/∂θ by central differences of eighth order, for tails that decay more slowly than any root shows: those of exponential
    /// thresholds, where X* is the length of the tail.
    fn relaxation_difference(&self, name: &str, monitor: &mut dyn Monitor) -> Result<f64> {
        /// Step relative to the value.
        const STEP: f64 = 1e-2;
        /// Shortest step, in which rounding of X* is still small.
        const SHORTEST: f64 = 1e-4;
        let known = self.parameters().into_iter().find(|parameter| parameter.name == name);
        let value = known.map_or(f64::NAN, |parameter| parameter.value);
        let mut step = STEP * value.abs();
        // Shorter where the steps leave the range of the parameter.
        let far = EIGHTH_ORDER.len() as f64;
        let mut refused =
            |away: f64| self.equation.with_parameters(&[(name, value + away)], monitor).is_err();
        while step > SHORTEST * value.abs() && (refused(far * step) || refused(-far * step)) {
            step *= 0.5;
        }
        let mut length = |away: f64| -> Result<f64> {
            let equation = self.equation.with_parameters(&[(name, value + away)], monitor)?;
            Ok(equation.relaxation_with(monitor)?.length())
        };
        let mut sum = 0.0;
        for (k, weight) in (1..).zip(EIGHTH_ORDER) {
            let away = f64::from(k) * step;
            sum += weight * (length(away)? - length(-away)?);
        }
        Ok(sum / step)
    }

    fn friction_gradient_of(
        &self,
        change: &LifeChange,
        gradient: &Gradient,
        relaxation: &Relaxation,
    ) -> FrictionGradient {
        let life = &self.renewal.reformed;
        let (mean, friction) = (life.mean(), life.force().curve().integral() / life.mean());
        let total = |of: fn(&LifeDerivative) -> &Kernel| {
            change.reformed.as_ref().map_or(0.0, |change| of(change).curve().integral())
        };
        let longer = total(LifeDerivative::survival) + change.wait;
        let free = if change.wait == 0.0 { 0.0 } else { life.force().curve().value(0.0) * change.wait };
        let kinetic =
            (total(LifeDerivative::force) + free - friction * longer) / mean + change.scale * friction;
        let steepest = match self.critical_stiffness() {
            0.0 => 0.0,
            stiffness if stiffness.is_finite() => -self.stiffness * self.slope_change(&gradient.curve),
            _ => f64::NAN,
        };
        FrictionGradient {
            static_friction: self.peak_change(&gradient.curve).map(|change| self.stiffness * change),
            kinetic_friction: self.stiffness * kinetic,
            relaxation_length: relaxation_change(relaxation, life, change),
            critical_stiffness: steepest,
        }
    }

    /// The derivative of the maximum of F, per unit stiffness: F_θ there and, where F has a kink, F' before it times
    /// the derivative of the position of the kink.
    fn peak_change(&self, gradient: &Piecewise) -> Option<f64> {
        let (Extremum { position, .. }, cell) = self.peak()?;
        let force = &self.renewal.force;
        let moved =
            if position == force.boundaries[cell + 1] { self.kink_change(gradient, cell + 1) } else { 0.0 };
        let [_, slope] = force.jet_in::<2>(cell, position);
        Some(gradient.value_in(cell, position) + slope * moved)
    }

    /// The derivative of the steepest slope of F, per unit stiffness: F'_θ there and, where it is at a kink of F or of F', F'' on
    /// this side times the derivative of the position of the kink.
    fn slope_change(&self, gradient: &Piecewise) -> f64 {
        let (cell, position, _) = self.steepest_fall();
        let force = &self.renewal.force;
        let ends = [cell, cell + 1];
        let moved = ends.into_iter().find(|&end| force.boundaries[end] == position).map_or(0.0, |end| {
            match self.kink_change(gradient, end) {
                0.0 => self.corner_change(gradient, end),
                moved => moved,
            }
        });
        let ([_, _, curvature], [_, by_slope]) =
            (force.jet_in::<3>(cell, position), gradient.jet_in::<2>(cell, position));
        by_slope + curvature * moved
    }

    /// The derivative of the position of a kink at the lower end of a cell. F stays continuous there, so that F_θ + F'
    /// dX/dθ is the same on both sides. 0 where F is smooth, and where it jumps: point masses do not move.
    fn kink_change(&self, gradient: &Piecewise, cell: usize) -> f64 {
        /// A change of F', per unit stiffness, that is a kink and not an error of polynomials.
        const KINK: f64 = 1e-6;
        let least = KINK * self.renewal.reformed.stiffness();
        let Some(([jump, bend, _], [change, _])) = self.jumps(gradient, cell) else { return 0.0 };
        if bend.abs() < least || jump.abs() > least * self.renewal.reformed.mean() {
            return 0.0;
        }
        -change / bend
    }

    /// The same of a kink of F' where F' stays continuous: F'_θ + F'' dX/dθ is the same on both sides.
    fn corner_change(&self, gradient: &Piecewise, cell: usize) -> f64 {
        /// A change of F'' per mean life, and of F', that is more than errors of polynomials.
        const CORNER: f64 = 1e-3;
        const KINK: f64 = 1e-6;
        let (stiffness, mean) = (self.renewal.reformed.stiffness(), self.renewal.reformed.mean());
        let Some(([_, bend, turn], [_, change])) = self.jumps(gradient, cell) else { return 0.0 };
        if bend.abs() > KINK * stiffness || turn.abs() * mean < CORNER * stiffness {
            return 0.0;
        }
        -change / turn
    }

    /// The jumps of F, F' and F'', and of F_θ and F'_θ, at the lower end of a cell.
    fn jumps(&self, gradient: &Piecewise, cell: usize) -> Option<([f64; 3], [f64; 2])> {
        let force = &self.renewal.force;
        if cell == 0 || cell == force.coefficients.len() {
            return None;
        }
        let place = force.boundaries[cell];
        let [before, after] = [cell - 1, cell].map(|side| force.jet_in::<3>(side, place));
        let [lower, upper] = [cell - 1, cell].map(|side| gradient.jet_in::<2>(side, place));
        let apart = std::array::from_fn(|order| after[order] - before[order]);
        Some((apart, std::array::from_fn(|order| upper[order] - lower[order])))
    }
}

/// ∂X*/∂θ.
fn relaxation_change(relaxation: &Relaxation, life: &Life, change: &LifeChange) -> f64 {
    if !relaxation.length().is_finite() {
        return f64::NAN;
    }
    if change.reformed.is_none() && change.wait == 0.0 {
        return 0.0;
    }
    let slowest = relaxation.roots().first().filter(|s| relaxation.length() == -1.0 / s.re);
    slowest.map_or(f64::NAN, |&s| {
        // A shift multiplies the transform of φ, which is 1 at the root.
        let mut survival = Complex64::from(change.wait);
        if let Some(change) = &change.reformed {
            survival += change.survival().curve().transform(s).0;
        }
        let moved = s * survival / life.breaking().transform(s).1;
        moved.re / (s.re * s.re)
    })
}
