//! The Fokker–Planck equation of thresholds: from the distribution P_ci of fresh contacts towards P_cf.

use super::{Ageing, Contacts};
use crate::Result;
use crate::law::{Atom, Breakpoint, Law, SharedLaw};
use crate::monitor::{Monitor, Watch};
use crate::numerics::diffusion::{Elements, Evolution, Field, Potential, Slope, cloud_in_cell};
use crate::numerics::legendre::{NODES, RULE};

/// Tolerance of tables of the distribution at all ages, unless thresholds are narrow.
const LEFT_OUT: f64 = 1e-13;
/// Fraction of thresholds neglected above the upper end.
const NEGLIGIBLE: f64 = 1e-15;

/// ∂_t p = D∂_h[U' + ∂_h]p with U = −ln P_cf, from p = P_ci, with reflecting ends of the support of P_cf.
#[derive(Debug, Clone)]
pub struct ThresholdFokkerPlanck {
    fresh: SharedLaw,
    mature: SharedLaw,
    /// D, stretch² per time.
    pub diffusion: f64,
    /// Lower and upper end of the thresholds.
    pub support: (f64, f64),
}

impl ThresholdFokkerPlanck {
    /// The diffusion of thresholds of these contacts; `None` for ageing without a mature distribution. For
    /// [`Ageing::FrozenRank`] D = σ_f²/`time`.
    pub fn of(contacts: &Contacts) -> Option<Self> {
        let (mature, diffusion) = match contacts.rules.ageing.as_ref()? {
            Ageing::Smoluchowski { mature, diffusion } | Ageing::MeanField { mature, diffusion } => {
                (mature, *diffusion)
            }
            Ageing::FrozenRank { mature, time } => (mature, mature.std().powi(2) / time),
            Ageing::Logarithmic { .. } => return None,
        };
        Some(Self::new(contacts.thresholds.clone(), mature.clone(), diffusion))
    }

    /// Thresholds with diffusion coefficient D. The distributions are assumed to have passed
    /// [`super::Contacts::check`].
    pub fn new(fresh: SharedLaw, mature: SharedLaw, diffusion: f64) -> Self {
        let (low, end) = (mature.quantile(0.0), mature.upper_quantile(0.0));
        let far = |law: &SharedLaw| law.upper_quantile(NEGLIGIBLE);
        let high = if end.is_finite() { end } else { far(&mature).max(far(&fresh)) };
        Self { fresh, mature, diffusion, support: (low, high) }
    }

    /// The same up to where also a negligible part of the second moments lies above, which friction is in proportion to:
    /// far beyond for broad distributions.
    #[must_use]
    pub fn with_second_moments(&self) -> Self {
        /// Fraction of a second moment.
        const NEGLIGIBLE: f64 = 1e-12;
        let far = |law: &SharedLaw| {
            let least = NEGLIGIBLE * law.upper_moment(2, -1.0);
            let ends = std::iter::successors(Some(self.support.1), |end| Some(1.25 * end));
            ends.take(100).find(|&end| law.upper_moment(2, end) <= least).unwrap_or(f64::MAX)
        };
        let high = far(&self.mature).max(far(&self.fresh));
        Self { support: (self.support.0, high), ..self.clone() }
    }

    /// P_ci.
    pub fn fresh_law(&self) -> &SharedLaw {
        &self.fresh
    }

    /// P_cf.
    pub fn mature_law(&self) -> &SharedLaw {
        &self.mature
    }

    /// The tolerance of the distribution at each age that tables of it are made with.
    pub(super) fn tolerance(&self) -> f64 {
        /// The same for narrow thresholds, in units of ε⟨x_s⟩/s: positions are rounded to ε⟨x_s⟩, and about this mass of a
        /// distribution of standard deviation s lies within such a distance. Steps in age cannot meet a tolerance below it.
        const ROUNDED: f64 = 16.0;
        let narrower = self.fresh.std().min(self.mature.std());
        LEFT_OUT.max(ROUNDED * f64::EPSILON * self.fresh.mean() / narrower)
    }

    /// Whether the density of fresh thresholds has jumps, which diffusion smooths at once.
    pub(super) fn begins_with_jumps(&self) -> bool {
        let mean = self.fresh.mean();
        let jumps = |b: &Breakpoint| b.exponent <= 0.0 && b.weight(mean) * mean > LEFT_OUT;
        self.fresh.breakpoints().iter().any(jumps)
    }

    /// U.
    pub fn potential(&self) -> Potential {
        const POINTS: usize = 8192;
        Potential::of(|h| self.mature.density(h), self.support, POINTS)
    }

    /// Survival function of fresh thresholds.
    pub fn survival(&self, stretch: f64) -> f64 {
        self.fresh.survival(stretch)
    }

    /// The length scale on which P_cf varies.
    pub fn width(&self) -> f64 {
        let zones = self.mature.zones();
        zones.iter().map(|zone| zone.resolution.min(zone.high - zone.low)).fold(f64::INFINITY, f64::min)
    }

    /// U'.
    pub fn slope(&self) -> Slope {
        let bulk = self.mature.quantile(0.5);
        Slope::of(|h| self.mature.density(h), self.support, &self.kinks(), bulk)
    }

    /// Positions inside the support at which U' is not smooth.
    pub fn kinks(&self) -> Vec<f64> {
        let (low, high) = self.support;
        let breakpoints = self.mature.breakpoints().into_iter().map(|b| b.position);
        breakpoints.filter(|&place| place > low && place < high).collect()
    }

    /// The density of fresh thresholds above `stretch`, without point masses, on elements up to the end of
    /// the support. The truncation error × half width of an element is at most `left_out` at its upper end;
    /// elements narrow down to `finest` towards jumps of the density, and to far less towards poles, beside which many
    /// contacts have their thresholds.
    pub fn fresh_density(&self, stretch: f64, left_out: impl Fn(f64) -> f64, finest: f64) -> Elements {
        /// Initial width of elements in standard deviations of a Gaussian.
        const WIDTH: f64 = 4.0;
        /// The narrowest element beside a pole, in units of that beside a jump.
        const STEEP: f64 = 1e-4;
        let (low, high) = (self.support.0.max(stretch), self.support.1);
        let law = self.fresh.as_ref();
        let mut edges = self.kinks();
        for zone in law.zones() {
            let (from, to) = (zone.low.max(low), zone.high.min(high));
            let parts = ((to - from) / (WIDTH * zone.resolution)).ceil().clamp(1.0, 1e3) as u32;
            edges.extend((0..=parts).map(|k| from + (to - from) * f64::from(k) / f64::from(parts)));
        }
        let inside = |b: &Breakpoint| b.position >= low && b.position <= high;
        for edge in law.breakpoints().iter().filter(|b| inside(b)) {
            let narrowest = if edge.is_steep() { STEEP * finest } else { finest };
            let widths = std::iter::successors(Some(narrowest), |width| Some(4.0 * width));
            // Elements grow by a factor of four away from a jump, which diffusion spreads over ever
            // wider layers.
            let widths = widths.take_while(|&width| edge.exponent <= 0.0 && width < 0.1 * (high - low));
            edges.push(edge.position);
            edges.extend(widths.flat_map(|width| [edge.position - width, edge.position + width]));
        }
        let edges = between(edges, (low, high));
        let mut density = Elements::of(|h| law.density(h), &edges, left_out, finest);
        for edge in law.breakpoints().iter().filter(|b| inside(b) && b.is_steep()) {
            self.set_exact_mass(&mut density, edge.position);
        }
        density
    }

    /// The evolution of the density of fresh thresholds, of which no contact breaks, with this tolerance; `slope` is U', and
    /// `kinks` are [`Self::kinks`].
    pub(super) fn evolution<'a>(
        &self,
        (slope, kinks): (&'a dyn Fn(f64) -> f64, &'a [f64]),
        tolerance: f64,
        stops: &'a dyn Fn() -> bool,
    ) -> Evolution<'a> {
        /// The narrowest element at a jump of the density, in units of the width of the narrower distribution.
        const FINEST: f64 = 1e-5;
        let finest = FINEST * self.width().min(self.fresh.std());
        Evolution {
            density: self.fresh_density(self.support.0, |_| 0.1 * tolerance, finest),
            field: Field { slope, diffusion: self.diffusion, loss: None },
            velocity: 0.0,
            absorbing: false,
            kinks,
            tolerance,
            time: 0.0,
            next: finest * finest / self.diffusion,
            first: true,
            stops,
        }
    }

    /// Sets the mass of the elements beside a breakpoint to the exact one, where the density is too steep for
    /// a polynomial.
    fn set_exact_mass(&self, density: &mut Elements, place: f64) {
        let beside = |i: &usize| density.edges[*i] == place || density.edges[i + 1] == place;
        for i in (0..density.count()).filter(beside).collect::<Vec<_>>() {
            let (from, to) = (density.edges[i], density.edges[i + 1]);
            let mass = self.fresh.cumulative(to) - self.fresh.cumulative(from);
            density.series[i] = [0.0; NODES];
            density.series[i][0] = mass / (to - from);
        }
    }

    /// The width to which point masses are spread at least, given that each is spread by `spread`. Of many
    /// point masses neighbours may overlap; by `coarser` times as much in the coarser of two solutions.
    pub fn point_mass_width(&self, spread: f64, coarser: f64) -> f64 {
        /// Largest number of point masses that are resolved one by one, and a number that always is.
        const MOST: usize = 150;
        const MANY: usize = 20;
        let atoms = self.fresh.atoms();
        if atoms.len() <= MANY {
            return spread;
        }
        let range = atoms[atoms.len() - 1].position - atoms[0].position;
        spread.max(0.5 * coarser * range / atoms.len().min(MOST) as f64)
    }

    /// The density of the point masses above `stretch` after the short time t in which they have spread by
    /// `spread` = √(2Dt), over which U' is constant: Gaussians around h − DU't.
    pub fn point_mass_density(
        &self,
        stretch: f64,
        spread: f64,
        slope: &Slope,
        left_out: f64,
    ) -> Option<Elements> {
        /// Half width of a Gaussian in standard deviations.
        const REACH: i32 = 9;
        let (low, high) = (self.support.0.max(stretch), self.support.1);
        let atoms: Vec<_> = self.fresh.atoms().into_iter().filter(|a| a.position > stretch).collect();
        if atoms.is_empty() {
            return None;
        }
        // A point mass cannot be resolved on elements. After a short time it is a Gaussian, moved
        // by the drift −DU't, with Dt = spread²/2.
        let drifted = |h: f64| h - 0.5 * spread * spread * slope.at(h);
        let mut edges = self.kinks();
        for atom in &atoms {
            let place = drifted(atom.position);
            edges.extend((-REACH..=REACH).step_by(3).map(|k| place + f64::from(k) * spread));
            let widths =
                std::iter::successors(Some(4.0 * f64::from(REACH) * spread), |width| Some(4.0 * width));
            let widths = widths.take_while(|&width| width < 0.1 * (high - low));
            edges.extend(widths.flat_map(|width| [place - width, place + width]));
        }
        let mut edges = between(edges, (low, high));
        // For many point masses the elements are shared.
        edges.pop();
        edges.dedup_by(|b, a| *b - *a < spread);
        edges.push(high);
        let spread_mass = |h: f64, atom: &Atom| {
            let z = (h - drifted(atom.position)) / spread;
            atom.weight * (-0.5 * z * z).exp() / (spread * (2.0 * std::f64::consts::PI).sqrt())
        };
        let density = |h: f64| atoms.iter().map(|atom| spread_mass(h, atom)).sum();
        let mut density = Elements::of(density, &edges, |_| left_out, 0.1 * spread);
        // Restores the mass cut off at an end of the support or at the stretch.
        let whole: f64 = atoms.iter().map(|atom| atom.weight).sum();
        let factor = whole / density.mass();
        density.series.iter_mut().flatten().for_each(|c| *c *= factor);
        Some(density)
    }

    /// An upper bound of the density of thresholds: that of fresh ones or, if `ageing`, of mature ones where
    /// that is higher.
    pub fn density(&self, threshold: f64, ageing: bool) -> f64 {
        let mature = if ageing { self.mature.density(threshold) } else { 0.0 };
        self.fresh.density(threshold).max(mature)
    }

    /// The lowest point mass of fresh thresholds.
    pub fn lowest_atom(&self) -> Option<f64> {
        self.fresh.atoms().first().map(|atom| atom.position)
    }

    /// A length on which both distributions vary little.
    pub fn resolution(&self) -> f64 {
        let zones = self.fresh.zones().into_iter().chain(self.mature.zones());
        zones.map(|zone| zone.resolution.min(zone.high - zone.low)).fold(f64::INFINITY, f64::min)
    }

    /// Breakpoints of (1 − aL)⁻¹ P_ci: at those of P_ci, two derivatives higher, with amplitudes times
    /// −1/(aD); `spread` is aD.
    pub fn breakpoints(&self, spread: f64) -> Vec<Breakpoint> {
        let atoms = self.fresh.atoms().into_iter().map(Breakpoint::from);
        let smoother =
            |b: Breakpoint| Breakpoint { exponent: b.exponent + 2.0, amplitude: -b.amplitude / spread, ..b };
        self.fresh.breakpoints().into_iter().chain(atoms).map(smoother).collect()
    }

    /// Masses of fresh thresholds above `stretch` on cells with these middles, of total S(`stretch`).
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub fn fresh(&self, middles: &[f64], stretch: f64, monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
        /// Points between two checks whether the monitor has stopped.
        const MANY: usize = 1 << 12;
        /// Fraction of thresholds at either end that rounding of all masses exceeds.
        const NOTHING: f64 = 1e-18;
        let watch = Watch::new(monitor);
        let (low, high) = self.support;
        let law = self.fresh.as_ref();
        let atoms = law.atoms().into_iter().filter(|atom| atom.position > stretch);
        // Of a narrow density most cells hold nothing.
        let (first, last) = (law.quantile(NOTHING), law.upper_quantile(NOTHING));
        let from = low.max(stretch).max(first);
        let spread = points(law, middles, (from, high.min(last).max(from)));
        let points = atoms.map(|atom| (atom.position, atom.weight)).chain(spread).enumerate();
        let points = points.take_while(|(number, _)| !(number.is_multiple_of(MANY) && watch.stops()));
        let masses = cloud_in_cell(middles, points.map(|(_, point)| point));
        watch.check().map(|()| masses)
    }
}

/// Sorted positions between two ends, with the ends; without positions so close that an element would have no
/// width.
fn between(mut places: Vec<f64>, (low, high): (f64, f64)) -> Vec<f64> {
    let least = 1e-12 * (high - low);
    places.retain(|&place| place > low + least && place < high - least);
    places.extend([low, high]);
    places.sort_by(f64::total_cmp);
    places.dedup_by(|b, a| *b - *a < least);
    places
}

/// Gauss points (position, mass) of the density of a distribution between two positions, accurate also for
/// products with functions that are not smooth at `cuts`.
pub(super) fn points<'a>(
    law: &'a dyn Law,
    cuts: &[f64],
    (low, high): (f64, f64),
) -> impl Iterator<Item = (f64, f64)> + 'a {
    let zones = law.zones();
    let mut edges: Vec<f64> = law.breakpoints().iter().map(|b| b.position).collect();
    edges.extend(zones.iter().flat_map(|zone| [zone.low, zone.high]).chain(cuts.iter().copied()));
    edges.retain(|&edge| edge > low && edge < high);
    edges.extend([low, high]);
    edges.sort_by(f64::total_cmp);
    let finest = move |low: f64, high: f64| {
        let over = zones.iter().filter(|zone| zone.low < high && zone.high > low);
        over.map(|zone| zone.resolution).fold(f64::INFINITY, f64::min)
    };
    let pairs: Vec<_> = edges.windows(2).map(|pair| (pair[0], pair[1])).collect();
    pairs.into_iter().flat_map(move |(low, high)| {
        let parts = ((high - low) / finest(low, high)).ceil().max(1.0);
        let half = 0.5 * (high - low) / parts;
        (0..parts as usize).flat_map(move |part| {
            let middle = low + (2 * part + 1) as f64 * half;
            let point = move |(t, w): (&f64, &f64)| {
                let place = middle + half * t;
                (place, half * w * law.density(place))
            };
            RULE.nodes.iter().zip(&RULE.weights).map(point)
        })
    })
}
