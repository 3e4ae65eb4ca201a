//! The derivative of the force on a pull by parameters of the contacts.

use super::life_change::LifeChange;
use super::pull::{Pull, at};
use crate::law::Parameter;
use crate::life::{Life, LifeDerivative};
use crate::monitor::{Monitor, Part};
use crate::numerics::breakpoints::{Atom, Breakpoint};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;
use crate::{Error, Result};

/// The derivative ∂F/∂θ of the force on a pull by a parameter θ, as a function of X.
#[derive(Debug, Clone)]
pub struct Gradient {
    pub(super) curve: Piecewise,
    stiffness: f64,
}

impl Gradient {
    /// ∂F/∂θ at the position X: a force per unit of the parameter. Where F jumps at a position that depends on
    /// the parameter, the point mass of the derivative there is left out.
    pub fn at(&self, position: f64) -> f64 {
        self.stiffness * at(&self.curve, position)
    }
}

impl Pull {
    /// The parameters by which the force has a derivative, with their values:
    /// [`MasterEquation::parameters`](super::MasterEquation::parameters).
    pub fn parameters(&self) -> Vec<Parameter> {
        self.equation.parameters()
    }

    /// ∂F/∂θ for one parameter, by its name: `thresholds.mean`, `reforming.std`, `stiffness`, `temperature.energy`, …;
    /// see [`Self::gradients`].
    ///
    /// # Errors
    /// Those of [`Self::gradients`].
    pub fn gradient(&self, parameter: &str) -> Result<Gradient> {
        self.gradient_with(parameter, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::gradient`]; stopped by the monitor.
    pub fn gradient_with(&self, parameter: &str, monitor: &mut dyn Monitor) -> Result<Gradient> {
        self.gradients_with(&[parameter], monitor).map(|mut one| one.swap_remove(0))
    }

    /// ∂F/∂θ for several of [`Self::parameters`], for little more than half the cost of one after the other.
    ///
    /// The renewal equation is linear in what follows from a change of the lives. With S_θ and m_θ the derivatives
    /// of survival and carried force (index i for the initial contacts), the derivative b of the number of breaks
    /// up to X and that of the force are, per contact and unit stiffness,
    ///
    /// b = −S_iθ − Γ∗S_θ + φ∗b, F_θ = m_iθ + Γ∗m_θ + b(X) m(0) + ∫₀^X b(Y) m'(X − Y) dY.
    ///
    /// This form needs no derivative of a density. S_θ has a closed form for parameters of the distributions of
    /// time-independent contacts of equal stiffness ([`crate::law::Law::survival_derivative`]); the lives of others are
    /// differenced, F never is, with an error of some 1e-10 of the largest derivative. Where the lives have kinks that move
    /// with θ, as those of thresholds with edges, they are differenced in coordinates that move with the kinks. A change of
    /// the advance w for which contacts are free shifts the life, so that Γ∗S_θ = Γ∗φ = Γ − φ_i and Γ∗m_θ = −(F − m_i)',
    /// without differences. F is proportional to count and
    /// stiffness; with temperature, the stiffness also changes the lives.
    ///
    /// # Errors
    /// An unknown parameter; a parameter without a derivative, such as the position of a point mass; the delay of contacts
    /// that break simultaneously; edges of distributions that cancel each other.
    pub fn gradients(&self, parameters: &[&str]) -> Result<Vec<Gradient>> {
        self.gradients_with(parameters, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::gradients`]; stopped by the monitor.
    pub fn gradients_with(&self, parameters: &[&str], monitor: &mut dyn Monitor) -> Result<Vec<Gradient>> {
        let changes = self.equation.life_changes(parameters, &mut Part::new(monitor, 0.0, 0.5))?;
        self.gradients_of(&changes, &mut Part::new(monitor, 0.5, 0.5))
    }

    pub(super) fn gradients_of(
        &self,
        changes: &[LifeChange],
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Gradient>> {
        let (mut sources, mut direct) = (Vec::new(), Vec::new());
        let mut sums = self.summed(changes, &mut Part::new(monitor, 0.0, 0.5))?.into_iter();
        while let (Some(survival), Some(force)) = (sums.next(), sums.next()) {
            sources.push(survival.scaled(-1.0));
            direct.push(force);
        }
        for (change, (source, direct)) in changes.iter().zip(sources.iter_mut().zip(&mut direct)) {
            if change.wait != 0.0 {
                let [fewer, slope] = self.by_wait()?;
                *source = source.plus(-change.wait, &fewer);
                *direct = direct.plus(-change.wait, &slope);
            }
        }
        let carried = self.carried(&sources, direct, &mut Part::new(monitor, 0.5, 0.5))?;
        let scaled = |(change, curve): (&LifeChange, Piecewise)| Gradient {
            curve: curve.plus(change.scale, &self.renewal.force),
            stiffness: self.stiffness,
        };
        Ok(changes.iter().zip(carried).map(scaled).collect())
    }

    /// The changes of the force that follow from the changes b = source + φ∗b of the number of breaks, per unit stiffness:
    /// those in `direct` plus b m(0) + ∫b m'. All are on the mesh of the solution.
    pub(super) fn carried(
        &self,
        sources: &[Piecewise],
        direct: Vec<Piecewise>,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Piecewise>> {
        let (solution, life) = (&self.renewal.solution, &self.renewal.reformed);
        let breaks = solution.respond(sources, life.breaking(), &mut Part::new(monitor, 0.0, 0.5))?;
        let later =
            solution.convolve_functions(&breaks, &force_slope(life), &mut Part::new(monitor, 0.5, 0.5))?;
        let start = life.force().curve().value(0.0);
        let terms = direct.into_iter().zip(breaks.iter().zip(&later));
        Ok(terms.map(|(direct, (breaks, later))| direct.plus(1.0, later).plus(start, breaks)).collect())
    }

    /// The sums over all contacts of the derivatives of their lives: survival of the first change, force of the first
    /// change, and so on.
    fn summed(&self, changes: &[LifeChange], monitor: &mut dyn Monitor) -> Result<Vec<Piecewise>> {
        let curves = [LifeDerivative::survival, LifeDerivative::force];
        let empty = Piecewise::default();
        let (mut firsts, mut kernels) = (Vec::new(), Vec::new());
        for (change, of) in changes.iter().flat_map(|change| curves.map(|of| (change, of))) {
            firsts.push(change.first.as_ref().map_or(&empty, |first| of(first).curve()));
            kernels.push(change.reformed.as_ref().map(of));
        }
        self.renewal.solution.convolve_each(&firsts, &kernels, monitor)
    }

    /// Γ − φ_i and (F − m_i)', on the mesh of the solution.
    ///
    /// # Errors
    /// Point masses of Γ.
    fn by_wait(&self) -> Result<[Piecewise; 2]> {
        let (solution, first) = (&self.renewal.solution, &self.renewal.first);
        if let Some(atom) = solution.atoms.first() {
            let expected =
                "contacts that do not break simultaneously, since the position of a jump has no derivative";
            return Err(Error::invalid("delay", expected, format!("a jump at {}", atom.position)));
        }
        let meshed = |curve: &Piecewise| solution.convolve(curve, &Kernel::default(), &mut ());
        let rate = solution.density.plus(-1.0, &meshed(first.breaking().curve())?);
        let slope = self.renewal.slope.plus(-1.0, &meshed(&first.force().curve().derivative())?);
        // The force of contacts that have just become free is not shifted.
        let friction = self.renewal.reformed.force().curve().value(0.0);
        let slope = slope.plus(-friction, &solution.density);
        Ok([rate, slope])
    }
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
    Breakpoint::sort(&mut breakpoints);
    Kernel::new(force.derivative(), breakpoints)
}
