//! Analytic continuation of the Laplace transform of the breaking density far into Re s < 0, where it depends
//! on the tails of the distributions.

use num_complex::Complex64;

use super::breaking::Breaking;
use super::cells::{BULK, Detail, edges, resolved, with_atoms};
use super::layer::Layer;
use crate::contacts::Contacts;
use crate::law::{Breakpoint, Law, SharedLaw, Zone};
use crate::monitor::Watch;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;

/// φ̂(s) of re-formed contacts, from the transform of the distribution of thresholds.
///
/// Let φ(u) = ∫ν(r) P_c(r+u) dr also for u < 0 (starts above their thresholds), ν = R/S. The transform over
/// all u is a product, so that φ̂(s) = P̂_c(s) ν̂(−s) − ∫_0^∞ e^{sv} φ(−v) dv, analytic wherever P̂_c is. For
/// Re s ≥ 0 the difference loses accuracy by a factor of 1/S; left of where e^{−sx} P_c(x) has its bulk above
/// the starts it is exact to rounding.
///
/// Both terms contain the same ν, so that an error δν contributes ∫δν(r) e^{sr} ∫_r^∞ e^{−sx} P_c(x) dx dr,
/// for each start at most |δν(r)| e^{r Re s} times the whole transform of P_c. Starts below r contribute at
/// least as much, amplified by more: it is enough that δν is a small fraction of ∫^r ν, for any s. Where S
/// falls to 0 at a finite stretch and R does not, ν has a pole at which rounding of r leaves few digits, but
/// its integral is only logarithmic.
#[derive(Debug)]
pub(crate) struct Continuation {
    thresholds: Thresholds,
    /// ν.
    births: Kernel,
    /// e^{edge·v} φ(−v).
    before: Kernel,
    edge: f64,
    /// The rate up to which the tail of P_c is known.
    known_rate: f64,
}

/// P_c, in the form in which its transform is computed.
#[derive(Debug)]
enum Thresholds {
    Law(SharedLaw),
    /// Density and point masses, if the distribution's own transform is a quadrature.
    Resolved(Kernel),
    /// Components with their weights, of which one has an exponential tail.
    Mixture(Vec<(f64, Self)>),
}

/// Starting mass down to which starts are resolved, since e^{sr} amplifies it: 13 standard deviations of a
/// Gaussian.
const LOWEST: f64 = 1e-40;

/// Survival down to which thresholds are resolved, since e^{−sx} amplifies it by far more.
const DEEPEST: f64 = 1e-250;

impl Continuation {
    /// φ̂ for Re s ≤ `edge` < 0. Contacts are assumed to have passed [`Contacts::check`].
    pub(crate) fn new(contacts: &Contacts, edge: f64, watch: &Watch<'_>) -> Self {
        let (thresholds, detail) = (contacts.thresholds.as_ref(), Detail::low_tails(LOWEST));
        let placed = Layer::placed(contacts, contacts.reforming.as_ref(), true, detail);
        // Thresholds below the stretches count as well.
        let unbounded = Layer { ahead: f64::NEG_INFINITY, behind: f64::NEG_INFINITY, ..placed };
        let breaking = Breaking::new(thresholds, &unbounded, detail);
        let highest = unbounded.range().map_or(0.0, |range| range.1);
        let faded = |b: Breakpoint| Breakpoint { amplitude: b.amplitude * (edge * b.position).exp(), ..b };
        let breakpoints: Vec<_> = met_before(thresholds, &unbounded).into_iter().map(faded).collect();
        let before = |z: Zone| Zone { low: -z.high, high: -z.low, ..z };
        let zones: Vec<_> = breaking.zones().into_iter().map(before).collect();
        let stops: Vec<_> = breakpoints.iter().map(|b| b.position).collect();
        let fading = |v: f64| watch.value(|| (edge * v).exp() * breaking.moments(-v)[0]);
        let curve = Piecewise::resolve(fading, &edges(&zones, &stops, highest), highest, BULK.resolution);
        let before = Kernel::new(curve, breakpoints);
        let atoms = unbounded.all_breaks().into_iter().filter(Breakpoint::is_atom).collect();
        let births = Kernel::new(unbounded.density, atoms);
        let (thresholds, known_rate) = (Thresholds::new(&contacts.thresholds), thresholds.known_rate());
        Self { thresholds, births, before, edge, known_rate }
    }

    /// φ̂(s).
    pub(crate) fn transform(&self, s: Complex64) -> Complex64 {
        self.thresholds.transform(s) * self.births.transform(-s).0 - self.before.transform(self.edge - s).0
    }

    /// A bound of |s φ̂(s)| on Re s = `left`, by the variation of its parts; `None` where point masses leave none or it is not
    /// computed.
    pub(crate) fn variation(&self, left: f64) -> Option<f64> {
        let Thresholds::Resolved(thresholds) = &self.thresholds else {
            return None;
        };
        if thresholds.atoms().chain(self.before.atoms()).next().is_some() {
            return None;
        }
        // ν is a measure: its transform is largest where nothing oscillates.
        let births = self.births.transform((-left).into()).0.re;
        Some(births * thresholds.curve().variation(left) + self.before.curve().variation(self.edge - left))
    }

    /// The smallest Re s for which it is valid.
    pub(crate) fn leftmost(&self) -> f64 {
        self.thresholds.leftmost().max(-self.known_rate)
    }
}

/// Where breakpoints and point masses of P_c meet those of ν at advances u ≤ 0, as positions −u, rising.
fn met_before(thresholds: &dyn Law, births: &Layer) -> Vec<Breakpoint> {
    let starts = births.all_breaks();
    let hazards = with_atoms(thresholds);
    let meetings =
        hazards.iter().flat_map(|hazard| starts.iter().map(|start| start.convolve(hazard.mirrored())));
    let mut before: Vec<_> = meetings.filter(|met| met.position >= 0.0).collect();
    Breakpoint::sort(&mut before);
    before
}

impl Thresholds {
    fn new(law: &SharedLaw) -> Self {
        if law.laplace_is_closed() {
            return Self::Law(law.clone());
        }
        // Resolved down to survival of 1e-250, an exponential tail would not be known up to its singularity at −λ.
        if law.decay_rate().is_finite() {
            return law.components().map_or_else(
                || Self::Law(law.clone()),
                |parts| Self::Mixture(parts.iter().map(|(weight, law)| (*weight, Self::new(law))).collect()),
            );
        }
        let mut breakpoints = with_atoms(law.as_ref());
        Breakpoint::sort(&mut breakpoints);
        Self::Resolved(Kernel::new(resolved(law.as_ref(), Detail::tails(DEEPEST)), breakpoints))
    }

    /// P̂_c(s).
    fn transform(&self, s: Complex64) -> Complex64 {
        match self {
            Self::Law(law) => law.laplace(s),
            Self::Resolved(kernel) => kernel.transform(s).0,
            Self::Mixture(parts) => parts.iter().map(|(weight, part)| *weight * part.transform(s)).sum(),
        }
    }

    /// The smallest Re s for which it is valid.
    fn leftmost(&self) -> f64 {
        match self {
            Self::Law(law) if law.decay_rate() > 0.0 => -law.decay_rate(),
            Self::Law(_) => f64::NEG_INFINITY,
            // What is left out is 1e-16 of what e^{−sx} lifts.
            Self::Resolved(kernel) => (DEEPEST.ln() + 37.0) / kernel.curve().end(),
            Self::Mixture(parts) => {
                parts.iter().map(|(_, part)| part.leftmost()).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }
}
