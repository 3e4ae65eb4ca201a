//! The rate of thermal breaking that is averaged over the thresholds above the stretch.

use super::{Contacts, Stiffness, Temperature};
use crate::law::{Atom, Breakpoint, SharedLaw, Zone};
use crate::monitor::Watch;
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::{Piecewise, Resolution};

/// r_T(x) = ⟨w(x; ξ) | ξ > x⟩ = ω ∫_x^∞ P_c(ξ) e^{−ΔE(x, ξ)/T} dξ / ∫_x^∞ P_c(ξ) dξ, the rate at which a contact of stretch x
/// breaks thermally if it has forgotten its threshold ([`super::Hazard::Additive`]), and its integral over x.
#[derive(Debug)]
pub(crate) struct AveragedRate {
    rate: Piecewise,
    /// ∫_0^x r_T.
    integral: Piecewise,
}

/// The sum over thresholds.
struct ThresholdAverage<'a> {
    law: &'a SharedLaw,
    stiffness: &'a Stiffness,
    temperature: Temperature,
    /// Thresholds between which P_c is smooth and varies little.
    stops: Vec<f64>,
    /// By rising threshold.
    atoms: Vec<Atom>,
}

/// Fraction of contacts, and of a rate, that is neglected.
const NEGLIGIBLE: f64 = 1e-18;

/// Fraction of contacts next to an edge of P_c, integrated to a thousandth.
const REMAINDER: f64 = 1e-13;

/// Exponents this far above the smallest are neglected.
const NOTHING: f64 = 45.0;

impl AveragedRate {
    /// The rate for stretches up to a threshold that only a negligible fraction exceeds. Invalid if the monitor asks to stop.
    pub(crate) fn new(contacts: &Contacts, temperature: Temperature, watch: &Watch<'_>) -> Self {
        let average = ThresholdAverage::new(contacts, temperature);
        // Contacts that move slowly enough for this rate to matter are at rest.
        let negligible = 1e-120 * temperature.attempt_rate;
        let resolution = Resolution::Relative { fraction: 1e-13, negligible };
        let at = |x: f64| if watch.stops() { 0.0 } else { average.at(x) };
        let edges = average.stretches();
        let rate = Piecewise::resolve(at, &edges, edges[edges.len() - 1], resolution);
        // The integral from 0 to x, as that from x to the end of the mirrored function.
        let integral = rate.mirrored().integrated_from_end(0.0, &[]).mirrored();
        Self { rate, integral }
    }

    /// r_T at a stretch; beyond the thresholds, where no contact holds, the last one.
    pub(crate) fn at(&self, stretch: f64) -> f64 {
        let stretch = stretch.min(self.rate.end());
        self.rate.value_in(self.rate.nearest(stretch), stretch)
    }

    /// ∫ r_T over the stretches that a contact passes in an advance.
    pub(crate) fn integral(&self, stretch: f64, advance: f64) -> f64 {
        /// A difference of numbers that are nearer would lose more than three digits.
        const APART: f64 = 1.001;
        let whole = |x: f64| {
            let x = x.min(self.integral.end());
            self.integral.value_in(self.integral.nearest(x), x)
        };
        let (before, now) = (whole(stretch), whole(stretch + advance));
        if now > APART * before { now - before } else { self.quadrature(stretch, advance) }
    }

    /// The same cell by cell.
    fn quadrature(&self, stretch: f64, advance: f64) -> f64 {
        let boundaries = &self.rate.boundaries;
        let inside = boundaries.partition_point(|&b| b <= stretch)
            ..boundaries.partition_point(|&b| b < stretch + advance);
        let stops = boundaries.get(inside).unwrap_or_default().iter().map(|b| b - stretch);
        let sum =
            |(from, sum): (f64, f64), to: f64| (to, sum + RULE.integrate(from, to, |u| self.at(stretch + u)));
        stops.chain([advance]).fold((0.0, 0.0), sum).1
    }
}

impl<'a> ThresholdAverage<'a> {
    fn new(contacts: &'a Contacts, temperature: Temperature) -> Self {
        let law = &contacts.thresholds;
        let mut atoms = law.atoms();
        Atom::sort(&mut atoms);
        let Contacts { stiffness, .. } = contacts;
        Self { law, stiffness, temperature, stops: stops(law), atoms }
    }

    /// ΔE/T.
    fn exponent(&self, stretch: f64, threshold: f64) -> f64 {
        let whole = 0.5 * self.stiffness.of(threshold) * threshold * threshold / self.temperature.energy;
        whole * self.temperature.barrier.height_at(stretch, threshold)
    }

    /// r_T.
    fn at(&self, stretch: f64) -> f64 {
        let above = self.law.survival(stretch);
        if above == 0.0 {
            return self.temperature.attempt_rate;
        }
        self.temperature.attempt_rate * (self.of_atoms(stretch) + self.of_density(stretch)) / above
    }

    fn of_atoms(&self, stretch: f64) -> f64 {
        let first = self.atoms.partition_point(|atom| atom.position <= stretch);
        let mut sum = 0.0;
        for &Atom { position, weight } in &self.atoms[first..] {
            let now = (-self.exponent(stretch, position)).exp();
            sum += weight * now;
            // Barriers rise with the threshold.
            if now <= NEGLIGIBLE * sum {
                break;
            }
        }
        sum
    }

    fn of_density(&self, stretch: f64) -> f64 {
        let first = self.stops.partition_point(|&stop| stop <= stretch);
        let mut sum = 0.0;
        let mut low = stretch;
        for &high in &self.stops[first..] {
            let most = (-self.exponent(stretch, low)).exp();
            if most * self.law.survival(low) <= NEGLIGIBLE * sum {
                break;
            }
            sum += self.panel(stretch, [low, high], 0);
            low = high;
        }
        sum
    }

    /// ∫P_c e^{−ΔE/T} dξ between two thresholds, bisected until its logarithm changes little on each part.
    ///
    /// In s = √(ξ − low) half powers of the distance to the stretch, which barriers may have, are whole ones.
    fn panel(&self, stretch: f64, [low, high]: [f64; 2], depth: u32) -> f64 {
        /// One Gauss rule of 16 points misses 1e-16 of e^{−t} on such a length.
        const LITTLE: f64 = 6.0;
        /// Parts that are a power of the distance to an end are graded down to this fraction, 2⁻¹⁰⁰.
        const MOST_HALVINGS: u32 = 100;
        let [begun, ended] = [low, high].map(|h| self.exponent(stretch, h));
        let uneven = (ended - begun).min(NOTHING) > LITTLE;
        if depth < MOST_HALVINGS && (uneven || self.is_steep([low, high])) && high - low > f64::EPSILON * high
        {
            let middle = 0.5 * (low + high);
            let lower = self.panel(stretch, [low, middle], depth + 1);
            let rise = self.exponent(stretch, middle) - begun;
            return lower + if rise > NOTHING { 0.0 } else { self.panel(stretch, [middle, high], depth + 1) };
        }
        let length = (high - low).sqrt();
        let term = |s: f64| {
            let threshold = low + s * s;
            2.0 * s * self.law.density(threshold) * (-self.exponent(stretch, threshold)).exp()
        };
        RULE.integrate(0.0, length, term)
    }

    /// Whether the density changes much between two thresholds.
    fn is_steep(&self, [low, high]: [f64; 2]) -> bool {
        const MUCH: f64 = 20.0;
        // At an end the density may be 0 or infinite.
        let inside = [0.01, 0.99].map(|part| self.law.density(low + part * (high - low)));
        let (least, most) = (inside[0].min(inside[1]), inside[0].max(inside[1]));
        most > MUCH * least && most * (high - low) > NEGLIGIBLE
    }

    /// Boundaries of the first cells of r_T. Towards 0 they are graded: slow contacts break there, and ∫r_T is to be as accurate as
    /// its own size.
    fn stretches(&self) -> Vec<f64> {
        const LEAST: f64 = 1e-15;
        let end = self.stops.iter().copied().chain(self.atoms.iter().map(|atom| atom.position));
        let end = end.fold(0.0, f64::max).min(self.law.upper_quantile(NEGLIGIBLE));
        let graded =
            std::iter::successors(Some(0.125 * end), |x| Some(0.125 * x)).take_while(|x| *x > LEAST * end);
        let known = self.stops.iter().copied().chain(self.atoms.iter().map(|atom| atom.position));
        let mut stretches: Vec<f64> = known.chain(graded).filter(|x| *x > 0.0 && *x < end).collect();
        stretches.extend([0.0, end]);
        stretches.sort_by(f64::total_cmp);
        stretches.dedup();
        stretches
    }
}

/// Boundaries between which the density of thresholds is smooth and varies little.
fn stops(law: &SharedLaw) -> Vec<f64> {
    let cells = |zone: Zone| {
        let count = ((zone.high - zone.low) / (Zone::CELL * zone.resolution)).ceil().max(1.0);
        (0..=count as usize).map(move |i| zone.low + (zone.high - zone.low) * i as f64 / count)
    };
    let zones = law.zones();
    if zones.is_empty() {
        return Vec::new();
    }
    let end = law.upper_quantile(NEGLIGIBLE);
    let far = zones.iter().fold(0.0, |far, zone| f64::max(far, zone.high));
    // A long tail varies on the scale of its distance.
    let tail = std::iter::successors(Some(far), |h| Some(1.5 * h)).take_while(|h| *h < end);
    let breakpoints = law.breakpoints().into_iter().map(|b: Breakpoint| b.position);
    let inner = zones.into_iter().flat_map(cells).chain(breakpoints).chain(law.seams()).chain(tail);
    let powers = law.breakpoints().into_iter().filter(Breakpoint::is_steep);
    let graded = powers.flat_map(|b| beside(b.position, law.quantile(REMAINDER), end));
    let mut stops: Vec<f64> = inner.chain(graded).filter(|h| *h < end).chain([end]).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup();
    stops
}

/// Boundaries on both sides of a power that is not whole, each at a third of the distance of the one before, between which Gauss
/// points integrate every power equally well (J. R. Rice, in: Numerical Solution of Partial Differential Equations II (1971)).
fn beside(at: f64, least: f64, end: f64) -> impl Iterator<Item = f64> {
    const RATIO: f64 = 1.0 / 3.0;
    let floor = least.max(8.0 * f64::EPSILON * at).max(f64::MIN_POSITIVE);
    let distances = std::iter::successors(Some(end), |d| Some(RATIO * d)).take_while(move |d| *d > floor);
    distances.flat_map(move |d| [at - d, at + d]).filter(|h| *h > 0.0)
}
