//! What a small step of the slider changes of the survival of contacts with temperature and constant thresholds.
//!
//! A contact that formed at the stretch r has, after the advance u₀, the hazard ℓ(u₀) per length and the surviving fraction S(u₀).
//! A step changes its cumulative hazard up to u by ℓ(u) − ℓ(u₀) per length, so that φ − D = ℓ(u₀) S(u) ([`super::StepCorrelation`]):
//! C(u) = ⟨∫ ℓ(u₀) S(u₀ + u) du₀⟩ and C_x(u) = ⟨∫ ℓ(u₀) k (r + u₀ + u) S(u₀ + u) du₀⟩ say how thermal breaking at one advance and
//! survival up to a later one are correlated.

use super::cells::{BULK, with_atoms};
use super::cohorts::Reach;
use super::constant_threshold::ConstantThreshold;
use super::grid::{graded, zones};
use super::layer::Layer;
use super::panels::{Domain, Panels, legendre};
use super::thermal_hazard::{ThermalHazard, blur};
use super::timed::resolution;
use crate::Result;
use crate::contacts::{Contacts, Stiffness, Temperature, ThresholdEvolution};
use crate::law::{Breakpoint, Law, Zone};
use crate::monitor::Watch;
use crate::numerics::exponential::exp;
use crate::numerics::legendre::{NODES, RULE, gauss_points};
use crate::numerics::piecewise::{Piecewise, Resolution};
use crate::numerics::wide::vectorised;

/// Contacts with constant thresholds.
struct Correlated<'a> {
    contacts: &'a Contacts,
    temperature: Temperature,
    /// Attempts per length.
    attempts: f64,
    /// ν.
    starts: &'a Layer,
    /// Its density.
    panels: Panels<'a>,
    sections: Vec<Section>,
    /// The Gauss points of all panels.
    formed: Vec<(f64, f64)>,
    /// Where P_c is not smooth.
    breakpoints: Vec<f64>,
    /// Panels of thresholds.
    edges: Vec<f64>,
    /// The highest threshold that counts.
    highest: f64,
}

/// Contacts that form at stretches of one panel. Until they have left it, each start is followed on its own; on the panels
/// beyond, contacts of one threshold have the same hazards whatever their start.
struct Section {
    range: [f64; 2],
    /// The end of the next panel.
    next: f64,
    /// Gauss points up to the end of this one, and their weight.
    count: usize,
    weight: f64,
    /// The highest thresholds of contacts that may break on this panel, and on the next one.
    highest: [f64; 2],
}

/// A part of the path of contacts that form at its beginning, or that have arrived there from a section and those before it.
struct PathPart<'a> {
    range: [f64; 2],
    /// The highest threshold of contacts that may break here.
    highest: f64,
    arrived: Option<&'a Section>,
}

/// Error of the integral of C over a cell, in mean thresholds.
const TOLERANCE: f64 = 1e-9;
/// Largest error of them that is accepted.
const MISSED: f64 = 1e-7;
/// Error of the rule for a panel of starts.
const LEFT_OUT: f64 = 1e-11;
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

/// C and C_x of contacts with `temperature` that slide at `velocity`; none if the hazard is additive, or with a table of stiffnesses.
///
/// # Errors
/// Stopped by the monitor.
pub(super) fn of(
    contacts: &Contacts,
    temperature: Temperature,
    velocity: f64,
    watch: &Watch<'_>,
) -> Result<Option<[Piecewise; 2]>> {
    if temperature.is_additive() || matches!(contacts.stiffness, Stiffness::Tabulated(_)) {
        return Ok(None);
    }
    let starts = Layer::placed(contacts, contacts.reforming.as_ref(), true, BULK);
    let correlated = Correlated::new(contacts, temperature, velocity, &starts)?;
    let edges = correlated.advances();
    let end = edges[edges.len() - 1];
    let both = |u: f64| {
        watch.done(edges.partition_point(|edge| *edge <= u) as f64 / edges.len() as f64);
        correlated.at(u, watch)
    };
    let tolerance = Resolution::Mean(TOLERANCE * contacts.thresholds.mean());
    let (both, missed) = Piecewise::resolve_all(both, &edges, end, tolerance);
    watch.check()?;
    // Where noise hides the values, another form is more accurate.
    Ok((missed <= MISSED * contacts.thresholds.mean()).then_some(both))
}

impl<'a> Correlated<'a> {
    fn new(
        contacts: &'a Contacts,
        temperature: Temperature,
        velocity: f64,
        starts: &'a Layer,
    ) -> Result<Self> {
        let law = contacts.thresholds.as_ref();
        let hazards = with_atoms(law);
        let panels = Reach::new(contacts, resolution(contacts, &hazards), true).panels(starts, LEFT_OUT);
        let breakpoints = hazards.iter().map(|b| b.position).filter(|at| *at > 0.0).collect();
        let evolution = ThresholdEvolution::of(contacts)?;
        let thermal = ThermalHazard::new(contacts, temperature, evolution, velocity);
        let highest = thermal.highest(law, NEGLIGIBLE);
        let (attempts, edges) = (temperature.attempt_rate / velocity, panels_of_thresholds(law, highest));
        let (sections, formed) = (Vec::new(), Vec::new());
        let mut correlated = Self {
            contacts,
            temperature,
            attempts,
            starts,
            panels,
            sections,
            formed,
            breakpoints,
            edges,
            highest,
        };
        correlated.divide();
        Ok(correlated)
    }

    /// Sets the sections and their points.
    fn divide(&mut self) {
        let ranges: Vec<[f64; 2]> = self.panels.ranges().collect();
        let (mut weight, mut formed) = (0.0, Vec::new());
        for (number, &range) in ranges.iter().enumerate() {
            self.panels.each(within(range), |start, points| {
                weight += points;
                formed.push((start, points));
            });
            let next = ranges.get(number + 1).map_or(f64::INFINITY, |next| next[1]);
            let highest = [range[1], next].map(|end| self.strongest(end));
            self.sections.push(Section { range, next, count: formed.len(), weight, highest });
        }
        self.formed = formed;
    }

    /// The highest threshold of contacts that may break up to a stretch.
    fn strongest(&self, stretch: f64) -> f64 {
        let breaks = |threshold: f64| {
            let constant = self.constant(threshold, stretch);
            stretch * self.attempts * (-constant.begun).exp() > self.nothing(&constant)
        };
        if stretch >= self.highest || breaks(self.highest) {
            return self.highest;
        }
        let (mut low, mut high) = (stretch, self.highest);
        // A twentieth more costs little.
        while high - low > 0.05 * high {
            let middle = 0.5 * (low + high);
            *(if breaks(middle) { &mut low } else { &mut high }) = middle;
        }
        high
    }

    /// What contacts of one threshold contribute that may be left out, beside one that breaks where the hazard is largest.
    fn nothing(&self, constant: &ConstantThreshold) -> f64 {
        NEGLIGIBLE * (self.attempts * constant.length).min(1.0)
    }

    /// Advances between which the curves are resolved: doubled from the length over which temperature blurs breaking, and where
    /// P_c has edges.
    fn advances(&self) -> Vec<f64> {
        let law = self.contacts.thresholds.as_ref();
        let end = self.highest - self.starts.range().map_or(0.0, |(lowest, _)| lowest);
        let doubled = |u: &f64| Some(2.0 * u).filter(|u| *u < end);
        let first = blur(self.contacts, &self.temperature).clamp(1e-12 * law.mean(), 0.25 * law.mean());
        let mut out: Vec<f64> = std::iter::successors(Some(first), doubled).collect();
        let starts: Vec<f64> = self.starts.all_breaks().iter().map(|b| b.position).collect();
        let after = |edge: &f64| starts.iter().map(|start| edge - start).collect::<Vec<_>>();
        out.extend(self.breakpoints.iter().flat_map(after).filter(|u| *u > 0.0 && *u < end));
        out.push(end);
        out.sort_by(f64::total_cmp);
        out
    }

    /// C and C_x at an advance.
    fn at(&self, advance: f64, watch: &Watch<'_>) -> [f64; 2] {
        let mut sums = [0.0; 2];
        let mut add = |weight: f64, path: &PathPart<'_>| {
            let of = watch.value(|| self.along(path, advance));
            (0..2).for_each(|i| sums[i] += weight * of[i]);
        };
        for mass in &self.starts.point_masses {
            let range = [mass.position, f64::INFINITY];
            add(mass.weight, &PathPart { range, highest: self.highest, arrived: None });
        }
        // Between these starts contacts have a smooth density of thresholds ahead.
        let cuts: Vec<f64> = self.breakpoints.iter().map(|at| at - advance).collect();
        for section in &self.sections {
            let [low, high] = section.range;
            let [highest, beyond] = section.highest;
            if low + advance < highest {
                let domain = Domain { cuts: cuts.clone(), ..within(section.range) };
                self.panels.each(domain, |start, points| {
                    add(points, &PathPart { range: [start, high], highest, arrived: None });
                });
            }
            add(1.0, &PathPart { range: [high, section.next], highest: beyond, arrived: Some(section) });
        }
        sums
    }

    /// The fraction of contacts of one threshold that formed up to the end of a section and have arrived there.
    fn arrived(&self, section: &Section, threshold: f64) -> f64 {
        let (end, formed) = (section.range[1], &self.formed[..section.count]);
        let constant = self.constant(threshold, end);
        // Hazards are integrated back to where contacts formed.
        let lowest = formed.first().map_or(end, |formed| formed.0);
        if -self.attempts * constant.at(lowest - end).0 < NEGLIGIBLE {
            return section.weight;
        }
        let of_sixteen = |sixteen: &[(f64, f64)]| {
            let mut back = [0.0; NODES];
            back.iter_mut().zip(sixteen).for_each(|(back, formed)| *back = formed.0 - end);
            let hazards = vectorised(
                #[inline(always)]
                || constant.integrals(&back),
            );
            let arrived = |(formed, hazard): (&(f64, f64), &f64)| formed.1 * (self.attempts * hazard).exp();
            sixteen.iter().zip(&hazards).map(arrived).sum::<f64>()
        };
        formed.chunks(NODES).map(of_sixteen).sum()
    }

    /// C and C_x of contacts on a part of their path.
    fn along(&self, path: &PathPart<'_>, advance: f64) -> [f64; 2] {
        let (law, range) = (self.contacts.thresholds.as_ref(), path.range);
        let mut sums = [0.0; 2];
        let mut add = |threshold: f64, weight: f64| {
            let of = if weight > 0.0 { self.of_threshold(threshold, range, advance) } else { [0.0; 2] };
            if of[0] > 0.0 {
                let weight = weight * path.arrived.map_or(1.0, |section| self.arrived(section, threshold));
                (0..2).for_each(|i| sums[i] += weight * of[i]);
            }
        };
        let [low, kink] = range.map(|stretch| stretch + advance);
        let inside = |edge: &f64| *edge > low && *edge < path.highest;
        let mut edges: Vec<f64> = self.edges.iter().copied().filter(inside).collect();
        if low < path.highest {
            edges.extend([low, path.highest].into_iter().chain(Some(kink).filter(inside)));
        }
        edges.sort_by(f64::total_cmp);
        for pair in edges.windows(2) {
            self.panel([pair[0], pair[1]], range[0], &mut |h, points| add(h, points * law.density(h)));
        }
        let atoms =
            law.atoms().into_iter().filter(|atom| atom.position > low && atom.position <= path.highest);
        atoms.for_each(|atom| add(atom.position, atom.weight));
        sums
    }

    /// Visits the Gauss points of a panel of thresholds, halved where weak contacts break at very different advances.
    fn panel(&self, [low, high]: [f64; 2], start: f64, visit: &mut dyn FnMut(f64, f64)) {
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

    /// ∫ ℓ(u₀) S(u₀ + u) du₀ of contacts of one threshold on a part of their path, and the same with the force: over panels from
    /// the highest u₀ down that double in width, since contacts break in less and less time.
    fn of_threshold(&self, threshold: f64, [start, end]: [f64; 2], advance: f64) -> [f64; 2] {
        let constant = self.constant(threshold, start);
        let hazard = |u: f64| self.attempts * constant.rate(u);
        let cumulative = |u: f64| self.attempts * constant.at(u).0;
        let mut top = (threshold - advance).min(end) - start;
        // Whether some survive.
        let survive = |before: f64| cumulative(before + advance) < NOTHING;
        let nothing = self.nothing(&constant);
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
            let [terms, moments] = vectorised(
                #[inline(always)]
                || self.rule(&constant, [low, top], advance),
            );
            sums[0] += terms;
            sums[1] += weight * (moments + start * terms);
            top = low;
            if top * hazard(top) <= nothing.max(NEGLIGIBLE * sums[0]) {
                break;
            }
            width = (2.0 * width).min(2.0 * APART / steepness(start + top));
        }
        sums
    }

    /// The Gauss rule of this integral on a panel, and the same times the advance.
    #[inline(always)]
    fn rule(&self, constant: &ConstantThreshold, [low, top]: [f64; 2], advance: f64) -> [f64; 2] {
        let half = 0.5 * (top - low);
        let before = gauss_points(low + half, half);
        let after = before.map(|u| u + advance);
        let (rates, hazards) = (constant.rates(&before), constant.integrals(&after));
        let mut sums = [0.0; 2];
        for i in 0..NODES {
            let term = RULE.weights[i] * rates[i] * exp(-self.attempts * hazards[i]);
            sums[0] += term;
            sums[1] += term * after[i];
        }
        sums.map(|sum| half * self.attempts * sum)
    }
}

/// The starts of a section.
fn within([low, high]: [f64; 2]) -> Domain {
    Domain { low, high, cuts: Vec::new(), steep: Vec::new() }
}

/// Boundaries of panels of thresholds, up to the highest one that counts.
fn panels_of_thresholds(law: &dyn Law, highest: f64) -> Vec<f64> {
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
