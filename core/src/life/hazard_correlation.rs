//! How thermal breaking at one advance and survival up to a later one are correlated, which the linear response of steady sliding
//! follows from.

use super::constant_threshold::ConstantThreshold;
use super::grid::{graded, zones};
use super::panels::legendre;
use super::thermal_hazard::{ThermalHazard, blur};
use crate::Result;
use crate::contacts::{Contacts, Stiffness, Temperature, ThresholdEvolution};
use crate::law::{Atom, Breakpoint, Law, Zone};
use crate::monitor::Watch;
use crate::numerics::piecewise::{Piecewise, Resolution};

/// Two curves against an advance u. A contact that formed at the stretch r has, after the advance u₀, the hazard ℓ(u₀) per length
/// and the surviving fraction S(u₀); k is its stiffness.
#[derive(Debug, Clone)]
pub(crate) struct HazardCorrelation {
    /// C(u) = ⟨∫ ℓ(u₀) S(u₀ + u) du₀⟩, the mean over all contacts.
    pub(crate) survival: Piecewise,
    /// C_x(u) = ⟨∫ ℓ(u₀) k (r + u₀ + u) S(u₀ + u) du₀⟩, in the unit of [`super::Life::force`].
    pub(crate) force: Piecewise,
}

/// Contacts with constant thresholds that re-form at a few stretches.
struct Correlated<'a> {
    contacts: &'a Contacts,
    temperature: Temperature,
    /// Attempts per length.
    attempts: f64,
    starts: Vec<Atom>,
    /// Panels of thresholds.
    edges: Vec<f64>,
    /// The highest threshold that counts.
    highest: f64,
}

/// Error of the integral of C over a cell, in mean thresholds.
const TOLERANCE: f64 = 1e-9;
/// Fraction of contacts, or of what they contribute, that is left out.
const NEGLIGIBLE: f64 = 1e-14;
/// −ln of the surviving fraction, or of the hazard of a contact that has just formed, that is left out.
const NOTHING: f64 = 35.0;
/// By how much the exponents of e^x or of e^{−e^x} may differ in a panel of 16 Gauss points, which miss 1e-11 of the latter.
const APART: f64 = 5.0;
/// Widest panel of thresholds, in lengths on which their density varies: 16 Gauss points miss 1e-13 of a Gaussian.
const WIDE: f64 = 3.0;
/// Ratio of the edges of panels in a tail.
const LONGER: f64 = 1.4;

impl HazardCorrelation {
    /// Of contacts that slide at `velocity`; none if thresholds change, if the hazard is additive, or if contacts re-form over a
    /// range of stretches.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(crate) fn of(contacts: &Contacts, velocity: f64, watch: &Watch<'_>) -> Result<Option<Self>> {
        let Some(correlated) = Correlated::new(contacts, velocity) else { return Ok(None) };
        let edges = correlated.advances();
        let end = edges[edges.len() - 1];
        let both = |u: f64| watch.value(|| correlated.at(u));
        let tolerance = Resolution::Mean(TOLERANCE * contacts.thresholds.mean());
        let ([survival, force], _) = Piecewise::resolve_all(both, &edges, end, tolerance);
        watch.check().map(|()| Some(Self { survival, force }))
    }
}

impl<'a> Correlated<'a> {
    fn new(contacts: &'a Contacts, velocity: f64) -> Option<Self> {
        let temperature = contacts.rules.temperature.filter(|temperature| !temperature.is_additive())?;
        let starts = contacts.reforming.atoms();
        let all: f64 = starts.iter().map(|start| start.weight).sum();
        let is_simple = contacts.rules.ageing.is_none() && (1.0 - all).abs() <= NEGLIGIBLE;
        if !is_simple || matches!(contacts.stiffness, Stiffness::Tabulated(_)) {
            return None;
        }
        let law = contacts.thresholds.as_ref();
        let evolution = ThresholdEvolution::of(contacts).ok()?;
        let thermal = ThermalHazard::new(contacts, temperature, evolution, velocity);
        let highest = thermal.highest(law, NEGLIGIBLE);
        let (attempts, edges) = (temperature.attempt_rate / velocity, panels(law, highest));
        Some(Self { contacts, temperature, attempts, starts, edges, highest })
    }

    /// Advances between which the curves are resolved: doubled from the length over which temperature blurs breaking, and where
    /// P_c has edges.
    fn advances(&self) -> Vec<f64> {
        let law = self.contacts.thresholds.as_ref();
        let lowest = self.starts.iter().map(|start| start.position).fold(f64::INFINITY, f64::min);
        let end = self.highest - lowest;
        let doubled = |u: &f64| Some(2.0 * u).filter(|u| *u < end);
        let first = blur(self.contacts, &self.temperature).clamp(1e-12 * law.mean(), 0.25 * law.mean());
        let mut out: Vec<f64> = std::iter::successors(Some(first), doubled).collect();
        let (breakpoints, atoms) = (law.breakpoints(), law.atoms());
        let edges = breakpoints.iter().map(|b| b.position).chain(atoms.iter().map(|atom| atom.position));
        let after = |edge: f64| self.starts.iter().map(move |start| edge - start.position);
        out.extend(edges.flat_map(after).filter(|u| *u > 0.0 && *u < end));
        out.push(end);
        out.sort_by(f64::total_cmp);
        out
    }

    /// C and C_x at an advance.
    fn at(&self, advance: f64) -> [f64; 2] {
        let law = self.contacts.thresholds.as_ref();
        let mut sums = [0.0; 2];
        for start in &self.starts {
            // Contacts form below their thresholds.
            let weight = start.weight / law.survival(start.position);
            let mut add = |threshold: f64, weight: f64| {
                let of = self.of_threshold(threshold, start.position, advance);
                (0..2).for_each(|i| sums[i] += weight * of[i]);
            };
            let low = start.position + advance;
            let inside = self.edges.iter().copied().filter(|edge| *edge > low);
            let edges: Vec<f64> = std::iter::once(low).chain(inside).collect();
            for pair in edges.windows(2) {
                self.panel([pair[0], pair[1]], start.position, &mut |h, points| {
                    add(h, weight * points * law.density(h));
                });
            }
            for atom in law.atoms().iter().filter(|atom| atom.position > low) {
                add(atom.position, weight * atom.weight);
            }
        }
        sums
    }

    /// Visits the Gauss points of a panel of thresholds, halved where weak contacts break at very different advances.
    fn panel(&self, [low, high]: [f64; 2], start: f64, visit: &mut impl FnMut(f64, f64)) {
        let [before, after] = [low, high].map(|threshold| {
            let constant = self.constant(threshold, start);
            (self.attempts * constant.length).ln() - constant.begun
        });
        // How far below its threshold a contact breaks depends little on the threshold, unless it may break at once.
        if before.max(after) > -NOTHING && (before - after).abs() > APART && high - low > 1e-6 * high {
            let middle = 0.5 * (low + high);
            self.panel([low, middle], start, visit);
            return self.panel([middle, high], start, visit);
        }
        legendre(low, high).for_each(|(threshold, weight)| visit(threshold, weight));
    }

    fn constant(&self, threshold: f64, start: f64) -> ConstantThreshold {
        let Temperature { barrier, energy, .. } = self.temperature;
        let whole = 0.5 * self.contacts.stiffness.of(threshold) * threshold * threshold / energy;
        ConstantThreshold::new(barrier, threshold, whole, start)
    }

    /// ∫ ℓ(u₀) S(u₀ + u) du₀ of contacts of one threshold, and the same with the force: over panels from the highest u₀ down that
    /// double in width, since contacts break in less and less time.
    fn of_threshold(&self, threshold: f64, start: f64, advance: f64) -> [f64; 2] {
        let constant = self.constant(threshold, start);
        let hazard = |u: f64| self.attempts * constant.rate(u);
        let cumulative = |u: f64| self.attempts * constant.at(u).0;
        let mut top = threshold - start - advance;
        // Whether some survive.
        let survive = |before: f64| cumulative(before + advance) < NOTHING;
        // What contacts contribute that break where the hazard is largest.
        let nothing = NEGLIGIBLE * (self.attempts * constant.length).min(1.0);
        if top <= 0.0 || top * hazard(top) <= nothing || !survive(0.0) {
            return [0.0; 2];
        }
        if !survive(top) {
            let mut low = 0.0;
            // Nothing survives beyond the highest u₀; a twentieth more costs a few panels.
            while top - low > 0.05 * top {
                let middle = 0.5 * (low + top);
                *(if survive(middle) { &mut low } else { &mut top }) = middle;
            }
        }
        let steepness = |stretch: f64| constant.steepest(stretch);
        let weight = self.contacts.stiffness.weight(threshold);
        let mut sums = [0.0; 2];
        let mut width = APART / hazard(top + advance).max(steepness(start + top));
        while top > 0.0 {
            let low = (top - width).max(0.0);
            for (u, points) in legendre(low, top) {
                let term = points * hazard(u) * (-cumulative(u + advance)).exp();
                sums[0] += term;
                sums[1] += term * weight * (start + u + advance);
            }
            top = low;
            if top * hazard(top) <= nothing.max(NEGLIGIBLE * sums[0]) {
                break;
            }
            width = (2.0 * width).min(2.0 * APART / steepness(start + top));
        }
        sums
    }
}

/// Boundaries of panels of thresholds, up to the highest one that counts.
fn panels(law: &dyn Law, highest: f64) -> Vec<f64> {
    let breakpoints = law.breakpoints();
    let mut edges: Vec<f64> = breakpoints.iter().map(|b| b.position).chain(law.seams()).collect();
    for Zone { low, high, resolution } in zones(law, highest) {
        let parts = ((high - low) / (WIDE * resolution)).ceil().max(1.0);
        edges.extend((0..=parts as u32).map(|k| low + (high - low) * f64::from(k) / parts));
    }
    // A long tail, of which the zones end before.
    let last = edges.iter().copied().fold(0.0, f64::max);
    let longer = |edge: &f64| Some(edge * LONGER).filter(|_| (f64::MIN_POSITIVE..highest).contains(edge));
    edges.extend(std::iter::successors(Some(last), longer).map(|edge| edge.min(highest)));
    edges.retain(|edge| (0.0..=highest).contains(edge));
    edges.sort_by(f64::total_cmp);
    edges.dedup();
    let is_steep = |b: &&Breakpoint| b.exponent.fract() != 0.0 || b.exponent < 0.0;
    let steep: Vec<f64> = breakpoints.iter().filter(is_steep).map(|b| b.position).collect();
    // Contacts so close to the end of the distribution are few, and break at once.
    graded(edges, &steep, 1e-5 * law.mean())
}
