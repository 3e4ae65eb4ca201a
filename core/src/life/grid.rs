//! Sums over fresh thresholds, resolved as finely as their distribution and temperature require.

use std::cell::Cell;
use std::ops::ControlFlow;

use super::cells::{NEGLIGIBLE, edges, with_atoms};
use super::thermal_hazard::{Hazards, ThermalHazard, ThermalHazardAt};
use crate::law::{Atom, Law, SharedLaw, Zone};
use crate::monitor::Watch;
use crate::numerics::legendre::{NODES, Nodal, RULE};

/// P_c, divided into parts on which it is smooth.
///
/// Towards a power x^α of its density that is not whole, parts are graded: each is a third of the one before,
/// so that Gauss points integrate every power equally well (J. R. Rice, in: Numerical Solution of Partial
/// Differential Equations II (1971)), down to where the remainder is below rounding.
#[derive(Debug)]
pub(super) struct ThresholdGrid {
    law: SharedLaw,
    parts: Vec<GridPart>,
    /// Ends and Gauss points of all parts and of their halves.
    fixed: Vec<f64>,
    /// The point masses of P_c.
    atoms: Vec<Atom>,
    /// Whether integrands contain half powers of the distance to the lowest threshold.
    rooted: bool,
}

/// A part of P_c with its Gauss points, and its halves down to where one rule is always enough.
#[derive(Debug)]
struct GridPart {
    ends: [f64; 2],
    points: Nodal,
    weights: Nodal,
    /// Index of its lower end among all fixed thresholds; its points and upper end follow.
    place: usize,
    halves: Option<Box<[GridPart; 2]>>,
}

/// The contacts at one fresh threshold: their fraction, their cumulative hazard, and their hazard w/v.
#[derive(Debug, Clone, Copy)]
pub(super) struct ThresholdGroup {
    pub(super) newborn: f64,
    pub(super) weight: f64,
    pub(super) broken: f64,
    pub(super) rate: f64,
}

/// A fresh threshold with its hazards.
type ThresholdHazards = (f64, Hazards);

/// The threshold above which all contacts survive, once found.
type Search = ControlFlow<f64>;

/// One Gauss rule is enough if exponents differ by less: its error for exp(−e^{−t}) over a Gaussian is 1e-15.
const ONE_RULE: f64 = 2.0;

/// Where A is below `FEW` at the lower end, exponents may differ by `WIDER` more for every factor e less:
/// exp(−a e^{−t}) is smoother the smaller a is.
const FEW: f64 = 20.0;
const WIDER: f64 = 1.1;

/// Above this cumulative hazard nothing survives; below `KEPT` everything does.
const GONE: f64 = 700.0;
const KEPT: f64 = 1e-17;

/// Largest number of parts made in advance; temperatures that need more leave most of them unused.
const MOST_PARTS: usize = 512;

impl ThresholdGrid {
    /// The parts of a distribution up to the threshold `highest`, as fine as `thermal` requires up to the age
    /// `oldest`.
    pub(super) fn new(
        law: &SharedLaw,
        highest: f64,
        thermal: Option<&ThermalHazard>,
        oldest: f64,
        rooted: bool,
    ) -> Self {
        let zones = zones(law.as_ref(), highest);
        let breakpoints = with_atoms(law.as_ref());
        let stops: Vec<f64> = breakpoints.iter().map(|b| b.position).collect();
        let edges = edges(&zones, &stops, highest.min(law.upper_quantile(0.0)));
        let steep: Vec<f64> = breakpoints.iter().filter(|b| b.is_steep()).map(|b| b.position).collect();
        let edges = graded(edges, &steep, law.quantile(NEGLIGIBLE));
        let inhabited = |part: &[f64; 2]| law.cumulative(part[1]) > NEGLIGIBLE && !zones.is_empty();
        let parts: Vec<_> = edges.windows(2).map(|pair| [pair[0], pair[1]]).filter(inhabited).collect();
        let apart = |ends: [f64; 2]| thermal.map_or(0.0, |thermal| thermal.apart(ends, oldest));
        let halvings = (MOST_PARTS / parts.len().max(1)).max(1).ilog2();
        let mut cutter = Cutter { law: law.as_ref(), apart: &apart, fixed: Vec::new() };
        let parts = parts.into_iter().map(|part| cutter.part(part, halvings)).collect();
        Self { law: law.clone(), parts, fixed: cutter.fixed, atoms: law.atoms(), rooted }
    }

    /// The thresholds at which hazards are evaluated repeatedly.
    pub(super) fn fixed(&self) -> &[f64] {
        &self.fixed
    }

    /// Visits the contacts with fresh thresholds above `least` up to a threshold above which all survive, and
    /// returns that. `known` returns the hazards at one of the [`ThresholdGrid::fixed`] thresholds by its
    /// index. Where the monitor asks to stop, not all are visited.
    pub(super) fn each(
        &self,
        least: ThresholdHazards,
        exposed: &ThermalHazardAt<'_>,
        known: &impl Fn(&ThermalHazardAt<'_>, usize) -> Hazards,
        watch: &Watch<'_>,
        mut visit: impl FnMut(ThresholdGroup),
    ) -> f64 {
        let sums = GridSums { exposed, known, least: least.0, parts: Cell::new(0), watch };
        let at = |place: usize| (self.fixed[place], known(exposed, place));
        // Survival rises with the threshold: the sum ends at the first threshold that all contacts survive.
        let first = self.parts.partition_point(|part| part.ends[1] <= least.0);
        let sought = self.parts[first..].iter().try_for_each(|part| {
            let low = if part.ends[0] < least.0 { least } else { at(part.place) };
            self.sum(part, [low, at(part.place + NODES + 1)], &sums, &mut visit)
        });
        // Above the last part are too few to count, as long as they may live.
        let kept = sought.break_value().unwrap_or(f64::INFINITY);
        for &Atom { position: newborn, weight } in &self.atoms {
            if newborn > least.0 && newborn <= kept {
                let (broken, rate) = exposed.hazards(newborn);
                visit(ThresholdGroup { newborn, weight, broken, rate });
            }
        }
        kept
    }

    /// The same for a part, between two thresholds: its upper end, and its lower end or `least`.
    fn sum(
        &self,
        part: &GridPart,
        [low, high]: [ThresholdHazards; 2],
        sums: &GridSums<'_, '_, '_, impl Fn(&ThermalHazardAt<'_>, usize) -> Hazards>,
        visit: &mut impl FnMut(ThresholdGroup),
    ) -> Search {
        sums.ask(low)?;
        let &GridSums { exposed, known, least, .. } = sums;
        if high.1.0 > GONE {
            return Search::Continue(());
        }
        if low.1.0 <= KEPT {
            return Search::Break(low.0);
        }
        let whole = low.0 <= part.ends[0] && !self.is_rooted([low, high], least);
        if whole && !is_uneven([low, high], exposed) {
            part.each(exposed, known, visit);
            return Search::Continue(());
        }
        // Fixed thresholds allow cached hazards; below the finest of them points are chosen freely.
        let Some(halves) = &part.halves else { return self.cut([low, high], sums, visit) };
        let place = halves[1].place;
        let middle = self.fixed[place];
        if low.0 >= middle {
            return self.sum(&halves[1], [low, high], sums, visit);
        }
        let middle = (middle, known(exposed, place));
        self.sum(&halves[0], [low, middle], sums, visit)?;
        self.sum(&halves[1], [middle, high], sums, visit)
    }

    /// Whether half powers of the distance to the lowest threshold are too strong for one rule.
    fn is_rooted(&self, [low, high]: [ThresholdHazards; 2], least: f64) -> bool {
        /// At a third of the width, 16 points miss 1e-15 of them.
        const NEAR: f64 = 0.3;
        self.rooted && low.0 - least < NEAR * (high.0 - low.0)
    }

    /// Visits Gauss points between two thresholds with known hazards, bisecting as needed.
    fn cut(
        &self,
        [low, high]: [ThresholdHazards; 2],
        sums: &GridSums<'_, '_, '_, impl Fn(&ThermalHazardAt<'_>, usize) -> Hazards>,
        visit: &mut impl FnMut(ThresholdGroup),
    ) -> Search {
        sums.ask(low)?;
        let &GridSums { exposed, least, .. } = sums;
        if high.1.0 > GONE {
            return Search::Continue(());
        }
        if low.1.0 <= KEPT {
            return Search::Break(low.0);
        }
        if high.0 - low.0 > 4.0 * f64::EPSILON * high.0 && is_uneven([low, high], exposed) {
            let middle = 0.5 * (low.0 + high.0);
            let middle = (middle, exposed.hazards(middle));
            self.cut([low, middle], sums, visit)?;
            return self.cut([middle, high], sums, visit);
        }
        let rooted = self.is_rooted([low, high], least);
        // In s = √(h − h_0) half powers of the distance to the threshold h_0 are whole ones, and
        // the Gauss rule converges exponentially again.
        let [from, to] = [low.0, high.0].map(|h| if rooted { (h - least).sqrt() } else { h });
        for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
            let (place, weight) = (from + 0.5 * (to - from) * (1.0 + t), 0.5 * (to - from) * w);
            let (newborn, weight) =
                if rooted { (least + place * place, 2.0 * place * weight) } else { (place, weight) };
            let weight = weight * self.law.density(newborn);
            let (broken, rate) = exposed.hazards(newborn);
            visit(ThresholdGroup { newborn, weight, broken, rate });
        }
        Search::Continue(())
    }
}

/// What a sum over thresholds is of.
struct GridSums<'a, 'e, 'w, K> {
    exposed: &'a ThermalHazardAt<'e>,
    known: &'a K,
    /// The lowest threshold.
    least: f64,
    /// Parts begun so far.
    parts: Cell<usize>,
    watch: &'a Watch<'w>,
}

impl<K> GridSums<'_, '_, '_, K> {
    /// Ends the sum at the threshold `low` if the monitor asks to stop. Low thresholds of broad distributions need thousands of
    /// parts, whose hazards are integrals over the past.
    fn ask(&self, low: ThresholdHazards) -> Search {
        /// Parts of sixteen hazards each between two questions.
        const MANY: usize = 8;
        self.parts.set(self.parts.get() + 1);
        let stops = self.parts.get().is_multiple_of(MANY) && self.watch.stops();
        if stops { Search::Break(low.0) } else { Search::Continue(()) }
    }
}

/// Whether one Gauss rule is not enough between two thresholds.
fn is_uneven([low, high]: [ThresholdHazards; 2], exposed: &ThermalHazardAt<'_>) -> bool {
    let allowed = ONE_RULE + WIDER * (FEW / low.1.0).ln().max(0.0);
    exposed.apart([low.0, high.0]) > allowed
}

/// The zones of a distribution, the last of them extended to the threshold `highest`.
fn zones(law: &dyn Law, highest: f64) -> Vec<Zone> {
    let end = law.upper_quantile(NEGLIGIBLE);
    // Gauss points integrate twice as far as they interpolate.
    let wider = |zone: Zone| Zone {
        resolution: 2.0 * zone.resolution,
        high: if zone.high >= end { zone.high.max(highest) } else { zone.high },
        ..zone
    };
    law.zones().into_iter().map(wider).collect()
}

/// The edges, with graded ones towards the `steep` positions: down to `least` from 0, and to rounding
/// elsewhere.
fn graded(mut edges: Vec<f64>, steep: &[f64], least: f64) -> Vec<f64> {
    /// 16 Gauss points integrate a power to 5e-19 over a part that is twice as wide as its distance.
    const RATIO: f64 = 1.0 / 3.0;
    for &at in steep {
        let floor = least.max(8.0 * f64::EPSILON * at).max(f64::MIN_POSITIVE);
        let between = |near: f64, far: f64| {
            let next = move |far: &f64| Some(RATIO * far).filter(|far| far.abs() > near.abs().max(floor));
            std::iter::successors(next(&far), next).map(move |distance| at + distance)
        };
        let beside = |pair: &[f64]| {
            let [low, high] = [pair[0] - at, pair[1] - at];
            between(low.max(0.0), high.max(0.0)).chain(between(high.min(0.0), low.min(0.0)))
        };
        let more: Vec<f64> = edges.windows(2).flat_map(beside).collect();
        edges.extend(more);
        edges.sort_by(f64::total_cmp);
    }
    edges.dedup();
    edges
}

/// Divides P_c into parts.
struct Cutter<'a> {
    law: &'a dyn Law,
    /// Largest difference of exponents.
    apart: &'a dyn Fn([f64; 2]) -> f64,
    fixed: Vec<f64>,
}

impl Cutter<'_> {
    /// A part, bisected until one rule is always enough, at most `halvings` times.
    fn part(&mut self, ends: [f64; 2], halvings: u32) -> GridPart {
        let place = self.fixed.len();
        let mut part = GridPart::new(self.law, ends, place);
        self.fixed.push(ends[0]);
        self.fixed.extend(part.points);
        self.fixed.push(ends[1]);
        if halvings > 0 && (self.apart)(ends) > ONE_RULE {
            let middle = 0.5 * (ends[0] + ends[1]);
            let low = self.part([ends[0], middle], halvings - 1);
            part.halves = Some(Box::new([low, self.part([middle, ends[1]], halvings - 1)]));
        }
        part
    }
}

impl GridPart {
    fn new(law: &dyn Law, ends: [f64; 2], place: usize) -> Self {
        let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
        let points = RULE.nodes.map(|t| middle + half * t);
        let weights = std::array::from_fn(|i| half * RULE.weights[i] * law.density(points[i]));
        Self { ends, points, weights, place, halves: None }
    }

    /// Visits all its points.
    fn each(
        &self,
        exposed: &ThermalHazardAt<'_>,
        known: &impl Fn(&ThermalHazardAt<'_>, usize) -> Hazards,
        visit: &mut impl FnMut(ThresholdGroup),
    ) {
        for i in 0..NODES {
            let (broken, rate) = known(exposed, self.place + 1 + i);
            visit(ThresholdGroup { newborn: self.points[i], weight: self.weights[i], broken, rate });
        }
    }
}
