//! The derivative of the force on a pull by a parameter of the contacts.

use super::pull::{Pull, at};
use super::relaxation::Relaxation;
use super::{Extremum, MasterEquation};
use crate::contacts::{Start, Stiffness};
use crate::law::{EIGHTH_ORDER, SharedLaw};
use crate::life::{Life, LifeDerivative};
use crate::monitor::{Monitor, Part};
use crate::numerics::breakpoints::{Atom, Breakpoint};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;
use crate::{Error, Result};

/// The derivative ∂F/∂θ of the force on a pull by a parameter θ, as a function of X.
#[derive(Debug, Clone)]
pub struct Gradient {
    curve: Piecewise,
    stiffness: f64,
}

impl Gradient {
    /// ∂F/∂θ at the position X: a force per unit of the parameter. Where F jumps at a position that depends on
    /// the parameter, the point mass of the derivative there is left out.
    pub fn at(&self, position: f64) -> f64 {
        self.stiffness * at(&self.curve, position)
    }
}

/// The derivatives of friction by a parameter θ; NaN where a quantity is not finite or not known.
#[derive(Debug, Clone, Copy, PartialEq)]
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

/// The distribution that a parameter belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Owner {
    Thresholds,
    Reforming,
    Initial,
}

/// The derivatives of the lives of the contacts at X = 0 and of those that re-form; `None` for 0.
struct Change {
    first: Option<LifeDerivative>,
    reformed: Option<LifeDerivative>,
}

impl Pull {
    /// ∂F/∂θ for one parameter, named by its distribution and its name: `thresholds.mean`, `reforming.std`,
    /// `initial.max`.
    ///
    /// The renewal equation is linear in what follows from a change of the lives. With S_θ and m_θ the derivatives
    /// of survival and carried force (index i for the initial contacts), the derivative b of the number of breaks
    /// up to X and that of the force are, per contact and unit stiffness,
    ///
    /// b = −S_iθ − Γ∗S_θ + φ∗b, F_θ = m_iθ + Γ∗m_θ + b(X) m(0) + ∫₀^X b(Y) m'(X − Y) dY.
    ///
    /// This form needs no derivative of a density. S_θ has a closed form for time-independent contacts of equal
    /// stiffness whose thresholds have one ([`crate::law::Law::survival_derivative`]); the lives of others are
    /// differenced, F never is. Thresholds with edges are less accurate there: the lives have kinks that move.
    ///
    /// # Errors
    /// An unknown parameter; a parameter without a derivative, such as the position of a point mass.
    pub fn gradient(&self, parameter: &str) -> Result<Gradient> {
        self.gradient_with(parameter, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::gradient`]; stopped by the monitor.
    pub fn gradient_with(&self, parameter: &str, monitor: &mut dyn Monitor) -> Result<Gradient> {
        let change = self.equation.change(parameter, &mut Part::new(monitor, 0.0, 0.5))?;
        self.gradient_of(&change, monitor)
    }

    /// The derivatives of F_s, F_k, X* and K_c by one parameter, for the propagation of errors.
    ///
    /// ∂F_s is ∂F/∂θ at a smooth maximum, whose motion has no effect at first order; ∂K_c is minus the slope of ∂F/∂θ
    /// where F falls most steeply. At a kink of F the motion of the kink adds to them. With C the mean life, F_k =
    /// N_c⟨k⟩ ∫m/C gives ∂F_k = N_c⟨k⟩ (∫m_θ − F_k ∫S_θ)/C; the root φ̂(s₁) = 1 that sets X* = −1/Re s₁ moves by
    /// s₁ Ŝ_θ(s₁)/φ̂'(s₁), since φ̂_θ = −s Ŝ_θ.
    ///
    /// # Errors
    /// Those of [`Pull::gradient`] and of [`MasterEquation::relaxation`].
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
        let change = self.equation.change(parameter, &mut Part::new(monitor, 0.0, 0.4))?;
        let gradient = self.gradient_of(&change, &mut Part::new(monitor, 0.4, 0.4))?;
        let relaxation = self.equation.relaxation_with(&mut Part::new(monitor, 0.8, 0.2))?;
        let life = &self.renewal.reformed;
        let (mean, friction) = (life.mean(), life.force().curve().integral() / life.mean());
        let total = |of: fn(&LifeDerivative) -> &Kernel| {
            change.reformed.as_ref().map_or(0.0, |change| of(change).curve().integral())
        };
        let kinetic = (total(LifeDerivative::force) - friction * total(LifeDerivative::survival)) / mean;
        let steepest = match self.critical_stiffness() {
            0.0 => 0.0,
            stiffness if stiffness.is_finite() => -self.stiffness * self.slope_change(&gradient.curve),
            _ => f64::NAN,
        };
        Ok(FrictionGradient {
            static_friction: self.peak_change(&gradient.curve).map(|change| self.stiffness * change),
            kinetic_friction: self.stiffness * kinetic,
            relaxation_length: relaxation_change(&relaxation, life, change.reformed.as_ref()),
            critical_stiffness: steepest,
        })
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

    /// The derivative of the steepest slope of F, per unit stiffness: F'_θ there and, where it is at a kink, F'' on this
    /// side times the derivative of the position of the kink.
    fn slope_change(&self, gradient: &Piecewise) -> f64 {
        let (cell, position, _) = self.steepest_fall();
        let force = &self.renewal.force;
        let moved = if position == force.boundaries[cell] {
            self.kink_change(gradient, cell)
        } else if position == force.boundaries[cell + 1] {
            self.kink_change(gradient, cell + 1)
        } else {
            0.0
        };
        let ([_, _, curvature], [_, by_slope]) =
            (force.jet_in::<3>(cell, position), gradient.jet_in::<2>(cell, position));
        by_slope + curvature * moved
    }

    /// The derivative of the position of a kink at the lower end of a cell. F stays continuous there, so that F_θ + F'
    /// dX/dθ is the same on both sides. 0 where F is smooth, and where it jumps: point masses do not move.
    fn kink_change(&self, gradient: &Piecewise, cell: usize) -> f64 {
        /// A change of F', per unit stiffness, that is a kink and not an error of polynomials.
        const KINK: f64 = 1e-6;
        let force = &self.renewal.force;
        if cell == 0 || cell == force.coefficients.len() {
            return 0.0;
        }
        let place = force.boundaries[cell];
        let [before, after] = [cell - 1, cell].map(|side| force.jet_in::<2>(side, place));
        let [jump, bend] = [after[0] - before[0], after[1] - before[1]];
        let least = KINK * self.renewal.reformed.stiffness();
        if bend.abs() < least || jump.abs() > least * self.renewal.reformed.mean() {
            return 0.0;
        }
        (gradient.value_in(cell - 1, place) - gradient.value_in(cell, place)) / bend
    }

    fn gradient_of(&self, change: &Change, monitor: &mut dyn Monitor) -> Result<Gradient> {
        let (solution, life) = (&self.renewal.solution, &self.renewal.reformed);
        let empty = Piecewise::default();
        let first = |of: fn(&LifeDerivative) -> &Kernel| {
            change.first.as_ref().map_or(&empty, |change| of(change).curve())
        };
        let none = Kernel::default();
        let later = |of: fn(&LifeDerivative) -> &Kernel| change.reformed.as_ref().map_or(&none, of);
        let [survival, force] = [LifeDerivative::survival, LifeDerivative::force];
        let fewer = solution.convolve(first(survival), later(survival), &mut Part::new(monitor, 0.5, 0.1))?;
        let breaks =
            solution.respond(&fewer.scaled(-1.0), life.breaking(), &mut Part::new(monitor, 0.6, 0.1))?;
        let direct = solution.convolve(first(force), later(force), &mut Part::new(monitor, 0.7, 0.1))?;
        let slope = force_slope(life);
        let carried = solution.convolve_function(&breaks, &slope, &mut Part::new(monitor, 0.8, 0.1))?;
        let start = life.force().curve().value(0.0);
        let curve = direct.plus(1.0, &carried).plus(start, &breaks);
        Ok(Gradient { curve, stiffness: self.stiffness })
    }
}

/// ∂X*/∂θ.
fn relaxation_change(relaxation: &Relaxation, life: &Life, change: Option<&LifeDerivative>) -> f64 {
    if !relaxation.length().is_finite() {
        return f64::NAN;
    }
    let Some(change) = change else { return 0.0 };
    let slowest = relaxation.roots().first().filter(|s| relaxation.length() == -1.0 / s.re);
    slowest.map_or(f64::NAN, |&s| {
        let moved = s * change.survival().curve().transform(s).0 / life.breaking().transform(s).1;
        moved.re / (s.re * s.re)
    })
}

/// m' of a life, with a point mass where m jumps.
fn force_slope(life: &Life) -> Kernel {
    let force = life.force().curve();
    let jump = |position: f64| {
        let cell = force.find(position).filter(|&cell| cell > 0)?;
        let edge = force.boundaries[cell];
        let height = force.value_in(cell, edge) - force.value_in(cell - 1, edge);
        Some(Breakpoint::from(Atom { position: edge, weight: height }))
    };
    let mut breakpoints = Vec::new();
    for b in life.force().breakpoints() {
        match b.exponent {
            0.0 => breakpoints.extend(jump(b.position)),
            exponent => breakpoints.push(Breakpoint { exponent: exponent - 1.0, ..*b }),
        }
    }
    breakpoints.sort_by(|a, b| a.position.total_cmp(&b.position));
    Kernel::new(force.derivative(), breakpoints)
}

impl MasterEquation {
    /// The derivatives of both lives by a parameter.
    fn change(&self, parameter: &str, monitor: &mut dyn Monitor) -> Result<Change> {
        let (owner, name) = owner(parameter)?;
        let law = self.law_of(owner);
        let under = |error: Error| error.under(parameter.split('.').next().unwrap_or_default());
        let known = law.survival_derivative(name).map_err(under)?;
        let timed = self.contacts.rules.are_time_dependent();
        if timed || matches!(self.contacts.stiffness, Stiffness::PerThreshold(_)) {
            return self.change_by_differences(owner, name, monitor).map_err(under);
        }
        let conditional = self.initial.start == Start::Conditional;
        let initial = (&self.initial.law, conditional);
        let reforming = (&self.contacts.reforming, true);
        let by = known.as_ref();
        let mut of = |owned: bool, starts, life: &Life, part: f64| -> Result<Option<LifeDerivative>> {
            let monitor = &mut Part::new(monitor, part, 0.5);
            match owner {
                Owner::Thresholds => {
                    LifeDerivative::of_thresholds(&self.contacts, starts, life, by, monitor).map(Some)
                }
                _ if owned => LifeDerivative::of_starts(&self.contacts, starts, life, by, monitor).map(Some),
                _ => Ok(None),
            }
        };
        let first = of(owner == Owner::Initial, initial, &self.first, 0.0)?;
        let alike = owner == Owner::Thresholds && self.starts_reformed();
        let reformed = if alike {
            first.clone()
        } else {
            of(owner == Owner::Reforming, reforming, &self.reformed, 0.5)?
        };
        Ok(Change { first, reformed })
    }

    /// The same by central differences of eighth order of the lives.
    fn change_by_differences(&self, owner: Owner, name: &str, monitor: &mut dyn Monitor) -> Result<Change> {
        let (value, step) = self.law_of(owner).difference_step(name)?;
        let mut pairs = Vec::new();
        for (k, weight) in (1..).zip(EIGHTH_ORDER) {
            let exact = (value + f64::from(k) * step) - value;
            let done = 0.25 * f64::from(k - 1);
            let mut at = |value: f64, done: f64| {
                self.with_law(owner, name, value, &mut Part::new(monitor, done, 0.125))
            };
            pairs.push((
                weight * f64::from(k) / exact,
                at(value + exact, done)?,
                at(value - exact, done + 0.125)?,
            ));
        }
        let differenced = |base: &Life, of: fn(&Self) -> &Life| {
            let pairs: Vec<_> = pairs.iter().map(|(w, a, b)| (*w, of(a).clone(), of(b).clone())).collect();
            LifeDerivative::by_differences(base, &pairs)
        };
        let first = (owner != Owner::Reforming).then(|| differenced(&self.first, Self::first_life));
        let reformed = (owner != Owner::Initial).then(|| differenced(&self.reformed, Self::life));
        Ok(Change { first, reformed })
    }

    fn law_of(&self, owner: Owner) -> &SharedLaw {
        match owner {
            Owner::Thresholds => &self.contacts.thresholds,
            Owner::Reforming => &self.contacts.reforming,
            Owner::Initial => &self.initial.law,
        }
    }

    /// The same with one parameter of a distribution replaced.
    fn with_law(&self, owner: Owner, name: &str, value: f64, monitor: &mut dyn Monitor) -> Result<Self> {
        let (mut contacts, mut initial) = (self.contacts.clone(), self.initial.clone());
        let law = self.law_of(owner).with_parameter(name, value)?;
        match owner {
            Owner::Thresholds => contacts.thresholds = law,
            Owner::Reforming => contacts.reforming = law,
            Owner::Initial => initial.law = law,
        }
        match self.velocity {
            Some(velocity) => Self::at_with(contacts, &initial, velocity, monitor),
            None => Self::new_with(contacts, &initial, monitor),
        }
    }
}

/// The distribution and its parameter that a name such as `thresholds.mean` stands for.
fn owner(parameter: &str) -> Result<(Owner, &str)> {
    let (name, rest) = parameter.split_once('.').unwrap_or((parameter, ""));
    match name {
        "thresholds" => Ok((Owner::Thresholds, rest)),
        "reforming" => Ok((Owner::Reforming, rest)),
        "initial" => Ok((Owner::Initial, rest)),
        _ => {
            let expected =
                "a parameter of a distribution, such as thresholds.mean, reforming.std or initial.max";
            Err(Error::invalid("parameter", expected, parameter))
        }
    }
}
