//! The force of contacts after they break, counted equally or in proportion to the stretch at which they re-form.

use std::sync::Arc;

use super::MasterEquation;
use super::pull::at;
use super::renewal::RenewalSolution;
use super::tolerance::Tolerance;
use crate::Result;
use crate::contacts::{Initial, Start};
use crate::law::SizeBiased;
use crate::life::Life;
use crate::monitor::{Monitor, Part};
use crate::numerics::breakpoints::{Atom, Breakpoint};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;

/// The life of contacts that count in proportion to their initial stretch.
pub(super) struct WeightedLife {
    /// The mean initial stretch r̄: E\[r f\] is r̄ times the expectation of f in `life`.
    pub(super) mean_start: f64,
    /// The life of contacts whose initial stretch has the size-biased distribution r R(r)/r̄.
    pub(super) life: Arc<Life>,
}

/// The force after a break, F_R and F_rR, as kernels of convolutions with the breaking rate.
pub(super) struct ForceAfterBreak {
    /// F_R(u), the force of contacts that have all just re-formed, after an advance u.
    pub(super) reformed: Kernel,
    /// F_rR(u), the same with each contact counted in proportion to its initial stretch: ∫R(r) r F_r(u) dr.
    pub(super) weighted: Option<Kernel>,
    /// r̄.
    pub(super) mean_start: f64,
    /// Estimated error of both.
    error: f64,
}

impl ForceAfterBreak {
    /// Up to the advance `end`. `known` is the solution of a pull that starts with re-formed contacts.
    pub(super) fn new(
        equation: &MasterEquation,
        known: Option<&RenewalSolution>,
        (end, tolerance): (f64, Tolerance),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let reformed = &equation.reformed;
        let solve = |first: &Arc<Life>, monitor: &mut dyn Monitor| {
            RenewalSolution::solve(first, reformed, end, tolerance, monitor)
        };
        let own = match known {
            Some(known) => known.clone(),
            None => solve(reformed, &mut Part::new(monitor, 0.0, 0.4))?,
        };
        let weighted =
            equation.weighted_by_stretch(&equation.reforming(), &mut Part::new(monitor, 0.4, 0.3))?;
        let solved = match &weighted {
            Some(weighted) => Some(solve(&weighted.life, &mut Part::new(monitor, 0.7, 0.3))?),
            None => None,
        };
        let mean_start = weighted.map_or(0.0, |weighted| weighted.mean_start);
        let error = solved.as_ref().map_or(0.0, |solved| solved.error).max(own.error);
        let scaled = |solved: RenewalSolution| {
            let kernel = force_kernel(&solved);
            Kernel::new(kernel.curve().clone().scaled(mean_start), kernel.breakpoints().to_vec())
        };
        Ok(Self { reformed: force_kernel(&own), weighted: solved.map(scaled), mean_start, error })
    }

    /// F_R(u).
    pub(super) fn force(&self, u: f64) -> f64 {
        at(self.reformed.curve(), u)
    }

    /// F_rR(u).
    pub(super) fn weighted_force(&self, u: f64) -> f64 {
        self.weighted.as_ref().map_or(0.0, |weighted| at(weighted.curve(), u))
    }

    /// F_R.
    pub(super) fn curve(&self) -> &Piecewise {
        self.reformed.curve()
    }

    /// F_rR.
    pub(super) fn weighted_curve(&self) -> Option<&Piecewise> {
        self.weighted.as_ref().map(Kernel::curve)
    }

    /// Estimated error of both.
    pub(super) fn error(&self) -> f64 {
        self.error
    }
}

/// F of a solution, with the points at which it is not smooth. F' = 1 − E_Γ + r̄Γ: where the breaking rate has a
/// breakpoint, the force has one of an exponent that is higher by 1, and a jump where contacts break simultaneously.
pub(super) fn force_kernel(renewal: &RenewalSolution) -> Kernel {
    let force = &renewal.force;
    let jump = |atom: &Atom| {
        let after = force.nearest(atom.position);
        let before = after.checked_sub(1).map_or(0.0, |before| force.value_in(before, atom.position));
        let height = force.value_in(after, atom.position) - before;
        Breakpoint { position: atom.position, exponent: 0.0, amplitude: height }
    };
    let smoother = |b: &Breakpoint| Breakpoint { exponent: b.exponent + 1.0, ..*b };
    let kinks = renewal.solution.breakpoints.iter().map(smoother);
    let mut breakpoints: Vec<_> = renewal.solution.atoms.iter().map(jump).chain(kinks).collect();
    Breakpoint::sort(&mut breakpoints);
    Kernel::new(force.clone(), breakpoints)
}

impl MasterEquation {
    /// The life of contacts that start at stretches drawn from `initial`.
    fn life_of(&self, initial: &Initial, monitor: &mut dyn Monitor) -> Result<Life> {
        let conditional = initial.start == Start::Conditional;
        match self.velocity {
            Some(velocity) => {
                crate::life::moving(&self.contacts, &initial.law, conditional, velocity, false, monitor)
            }
            None => crate::life::athermal(&self.contacts, &initial.law, conditional, monitor),
        }
    }

    /// The life of contacts that start as in `initial`, each counted in proportion to its initial stretch, with
    /// the mean initial stretch. `None` if all start at 0.
    pub(super) fn weighted_by_stretch(
        &self,
        initial: &Initial,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<WeightedLife>> {
        let Some(biased) = SizeBiased::of(&initial.law) else { return Ok(None) };
        let mean_start = biased.unweighted_mean();
        let initial = Initial { law: Arc::new(biased), start: initial.start };
        let life = self.life_of(&initial, monitor)?;
        Ok(Some(WeightedLife { mean_start, life: life.into() }))
    }

    /// Whether the contacts at X = 0 are like those that re-form.
    pub(super) fn starts_reformed(&self) -> bool {
        let conditional =
            self.initial.start == Start::Conditional || self.initial.law.upper_quantile(0.0) == 0.0;
        conditional && super::same(&self.initial.law, &self.contacts.reforming)
    }

    /// How contacts re-form.
    pub(super) fn reforming(&self) -> Initial {
        Initial { law: self.contacts.reforming.clone(), start: Start::Conditional }
    }
}
