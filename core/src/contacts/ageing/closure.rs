//! The mean-field closure: the distribution of thresholds in steady sliding.

use std::cell::RefCell;
use std::sync::Arc;

use super::ThresholdFokkerPlanck;
use super::fokker_planck::points;
use crate::Result;
use crate::law::{Breakpoint, Series, SharedLaw};
use crate::monitor::{Monitor, Watch};
use crate::numerics::diffusion::{Elements, Field, Resolvent};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::roots::brent_root;

/// Truncation error × half width of an element, and that × h² over the second moment, which friction is in proportion to.
const TOLERANCE: f64 = 1e-14;
const OF_MOMENT: f64 = 1e-12;

/// If the mean square displacement of thresholds before they break is below this fraction of the squared
/// width of the distributions, P_c = P_ci.
const NOTHING: f64 = 1e-13;

/// P_c = ∫₀^∞ e^{−τ} P_c^{Smol}(t = τC/v) dτ with C/v the mean life of contacts: exponentially distributed ages.
///
/// Contacts re-form at stretches r ~ R and break at thresholds of P_c above them: with S the survival function of P_c, C =
/// ∫R(r) ∫_r^∞ S(x)/S(r) dx dr, the mean advance of a contact from formation to break. That is ⟨h⟩ − ⟨r⟩ where R is below all thresholds.
///
/// Equivalently (1 − (C/v)L)P_c = P_ci with L the operator of [`ThresholdFokkerPlanck`]: one backward Euler
/// step, on adaptive spectral elements ([`Resolvent`]). The first two moments of broad thresholds fulfil their
/// equations to 3e-11; the error is not estimated.
#[derive(Debug, Clone, Copy)]
pub struct Closure<'a> {
    /// Diffusion of thresholds.
    pub maturing: &'a ThresholdFokkerPlanck,
    /// R, the distribution of stretches at which contacts re-form.
    pub reforming: &'a SharedLaw,
    /// Velocity v.
    pub velocity: f64,
}

impl Closure<'_> {
    /// P_c.
    ///
    /// # Errors
    /// A density that could not be represented; stopped by the monitor.
    pub fn law(&self, monitor: &mut dyn Monitor) -> Result<SharedLaw> {
        let fresh = self.maturing.fresh_law();
        let spread = fresh.mean() * self.maturing.diffusion / self.velocity;
        if spread < NOTHING * self.maturing.resolution().powi(2) {
            return Ok(fresh.clone());
        }
        let wide = Closure { maturing: &self.maturing.with_second_moments(), ..*self };
        wide.law_within(spread, monitor)
    }

    /// P_c within the support; `spread` is about the mean square displacement of thresholds before they break.
    fn law_within(&self, spread: f64, monitor: &mut dyn Monitor) -> Result<SharedLaw> {
        /// The narrowest element of P_ci, in units of the widths of the distributions and of the root mean square
        /// displacement. Narrower ones need not be resolved, and conserve less of the mass, by rounding.
        const FINEST: f64 = 1e-2;
        let fresh = self.maturing.fresh_law();
        let (watch, slope) = (Watch::new(monitor), self.maturing.slope());
        let finest = FINEST * self.maturing.resolution().min(spread.sqrt());
        let atoms = fresh.atoms();
        let square = fresh.upper_moment(2, -1.0);
        let tolerance = |h: f64| TOLERANCE.min(OF_MOMENT * square / (h * h));
        let resolvent = Resolvent {
            density: &self.maturing.fresh_density(self.maturing.support.0, |h| 0.1 * tolerance(h), finest),
            point_masses: &atoms.iter().map(|atom| (atom.position, atom.weight)).collect::<Vec<_>>(),
            field: Field { slope: &|h| slope.at(h), diffusion: self.maturing.diffusion, loss: None },
            tolerance: &tolerance,
        };
        let (density, advance) = self.solved(&resolvent, &watch);
        watch.check()?;
        Ok(Arc::new(self.series(density, advance)?))
    }

    /// The density, and the mean advance C of its contacts, which the time constant of the equation contains: a root.
    fn solved(&self, resolvent: &Resolvent<'_>, watch: &Watch<'_>) -> (Elements, f64) {
        let edges = RefCell::new(resolvent.edges());
        let solve = |advance: f64| {
            // A solution begins with the elements of the one before.
            let solved = resolvent.after(advance / self.velocity, edges.take());
            edges.replace(solved.edges.clone());
            solved
        };
        let starts = starts(self.maturing, self.reforming);
        let excess = |advance: f64| {
            if watch.stops() {
                return 0.0;
            }
            mean_advance(&solve(advance), &starts) - advance
        };
        let advance = self_consistent_advance(self.maturing, excess);
        (solve(advance), advance)
    }

    /// The distribution with this density, whose contacts have the mean advance C.
    fn series(&self, density: Elements, advance: f64) -> Result<Series> {
        /// Elements with less of the mass, and of the second moment, do not show in any result; the support ends at the
        /// outermost ones with more.
        const SHOWN: f64 = 1e-15;
        let [square] = density.sums(|h| [h * h]);
        let shown = |i: &usize| {
            let mass = density.width(*i) * density.series[*i][0];
            mass * (density.edges[*i + 1].powi(2) / square).max(1.0) > SHOWN
        };
        let first = (0..density.count()).find(shown).unwrap_or(0);
        let last = (0..density.count()).rfind(shown).unwrap_or(density.count() - 1);
        let density = Piecewise {
            boundaries: density.edges[first..=last + 1].to_vec(),
            coefficients: density.series[first..=last].to_vec(),
        };
        let spread = advance * self.maturing.diffusion / self.velocity;
        let (start, end) = (density.boundaries[0], density.end());
        let ends = [(start, density.value(start)), (end, -density.value_in(last - first, end))];
        let jumps = ends.map(|(position, amplitude)| Breakpoint { position, exponent: 0.0, amplitude });
        let breakpoints = self.maturing.breakpoints(spread).into_iter().chain(jumps).collect();
        Series::solved(density, breakpoints)
    }
}

/// R as points (stretch, weight), for integrals with thresholds that mature.
pub(crate) fn starts(maturing: &ThresholdFokkerPlanck, reforming: &SharedLaw) -> Vec<(f64, f64)> {
    let law = reforming.as_ref();
    let atoms = law.atoms().into_iter().map(|atom| (atom.position, atom.weight));
    if law.zones().is_empty() {
        return atoms.collect();
    }
    let cuts = maturing.breakpoints(1.0).into_iter().map(|b| b.position);
    let cuts: Vec<f64> = cuts.chain([maturing.support.0]).collect();
    let ends = (law.quantile(0.0), law.upper_quantile(0.0).min(maturing.support.1));
    atoms.chain(points(law, &cuts, ends)).collect()
}

/// C where the mean advance of contacts that have lived for it is C again: the root of the excess of that over C.
pub(crate) fn self_consistent_advance(maturing: &ThresholdFokkerPlanck, excess: impl Fn(f64) -> f64) -> f64 {
    // Means of thresholds of all ages lie between, or near, those of the two distributions.
    let ends = [maturing.fresh_law().mean(), maturing.mature_law().mean()];
    let (mut low, mut high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    while excess(low) < 0.0 && low > 0.0 {
        low *= 0.5;
    }
    while excess(high) > 0.0 && high < maturing.support.1 {
        high *= 2.0;
    }
    brent_root(excess, low, high, 0.0).unwrap_or(low)
}

/// C, from points (r, weight) of R.
pub(crate) fn mean_advance(density: &Elements, starts: &[(f64, f64)]) -> f64 {
    /// Fraction of contacts above a stretch below which rounding hides where they break.
    const FEWEST: f64 = 1e-13;
    let whole: f64 = starts.iter().map(|start| start.1).sum();
    let of = |&(start, weight): &(f64, f64)| {
        let [above, advance] = density.sums_above(start, |h| [1.0, h - start]);
        if above > FEWEST { weight * advance / above } else { 0.0 }
    };
    starts.iter().map(of).sum::<f64>() / whole
}
