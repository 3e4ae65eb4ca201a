//! Sums over newborn thresholds, as closely as their law and what temperature does to them ask for.

use std::ops::ControlFlow;

use super::cells::{NEGLIGIBLE, edges, with_atoms};
use super::exposure::{Exposed, Exposure, Risk};
use crate::law::{Atom, Law, SharedLaw, Zone};
use crate::numerics::legendre::{NODES, Nodal, RULE};

/// P_c, cut into parts on which it is smooth.
///
/// Towards a power x^α of its density that is not whole, parts are graded: each is a third of the one before, so that
/// Gauss points follow every power equally well (graded meshes, after J. R. Rice, in: Numerical Solution of Partial
/// Differential Equations II (1971)), down to where what is left is less than rounding.
#[derive(Debug)]
pub(super) struct ThresholdGrid {
    law: SharedLaw,
    parts: Vec<GridPart>,
    /// Ends and points of all parts, and of their halves.
    fixed: Vec<f64>,
    /// Thresholds that many share.
    walls: Vec<Atom>,
    /// Whether what is summed has half powers of the distance to the least threshold.
    rooted: bool,
}

/// A part of P_c, with its Gauss points, and its halves down to where one rule is always enough.
#[derive(Debug)]
struct GridPart {
    ends: [f64; 2],
    points: Nodal,
    weights: Nodal,
    /// The number of its lower end among all fixed thresholds; its points and its upper end follow.
    place: usize,
    halves: Option<Box<[GridPart; 2]>>,
}

/// The contacts of one newborn threshold: how many, −ln of what temperature left of them, and their rate w/v.
#[derive(Debug, Clone, Copy)]
pub(super) struct ThresholdShare {
    pub(super) newborn: f64,
    pub(super) weight: f64,
    pub(super) broken: f64,
    pub(super) rate: f64,
}

/// A newborn threshold, with −ln of what temperature left, and w/v.
type ThresholdRisk = (f64, Risk);

/// The threshold from which on every contact is left, if that has been reached.
type Sought = ControlFlow<f64>;

/// Exponents that differ by less are left to one Gauss rule: of exp(−e^{−t}) over a Gaussian it misses 1e-15 then.
const ONE_RULE: f64 = 2.0;

/// Where A is below `FEW` at the lower end, exponents may differ by `WIDER` more for every e-fold less: exp(−a e^{−t}) is
/// the smoother the smaller a, and the rule misses as little.
const FEW: f64 = 20.0;
const WIDER: f64 = 1.1;

/// Where −ln of what is left is above, nothing is, however few others there are; where it is below, all are.
const GONE: f64 = 700.0;
const KEPT: f64 = 1e-17;

/// How many parts are made beforehand, not as it is needed: temperatures that ask for more leave most of them alone.
const MOST_PARTS: usize = 512;

impl ThresholdGrid {
    /// The parts of a law up to the threshold `highest`, cut as finely as `exposure` asks for up to the age `oldest`.
    pub(super) fn new(
        law: &SharedLaw,
        highest: f64,
        exposure: Option<&Exposure>,
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
        let apart = |ends: [f64; 2]| exposure.map_or(0.0, |exposure| exposure.apart(ends, oldest));
        let halvings = (MOST_PARTS / parts.len().max(1)).max(1).ilog2();
        let mut cutter = Cutter { law: law.as_ref(), apart: &apart, fixed: Vec::new() };
        let parts = parts.into_iter().map(|part| cutter.part(part, halvings)).collect();
        Self { law: law.clone(), parts, fixed: cutter.fixed, walls: law.atoms(), rooted }
    }

    /// The thresholds at which the risk is asked for time and again.
    pub(super) fn fixed(&self) -> &[f64] {
        &self.fixed
    }

    /// Visits the contacts with newborn thresholds above `least`, of which the risk is told, up to a threshold above which
    /// all are left, and tells that one. `known` tells the risk at one of the [`ThresholdGrid::fixed`] thresholds by its place.
    pub(super) fn each(
        &self,
        least: ThresholdRisk,
        exposed: &Exposed<'_>,
        known: &impl Fn(&Exposed<'_>, usize) -> Risk,
        mut visit: impl FnMut(ThresholdShare),
    ) -> f64 {
        let at = |place: usize| (self.fixed[place], known(exposed, place));
        let first = self.parts.partition_point(|part| part.ends[1] <= least.0);
        let sought = self.parts[first..].iter().try_for_each(|part| {
            let low = if part.ends[0] < least.0 { least } else { at(part.place) };
            self.sum(part, [low, at(part.place + NODES + 1)], least.0, (exposed, known), &mut visit)
        });
        // Above the last part are too few to count, as long as they may live.
        let kept = sought.break_value().unwrap_or(f64::INFINITY);
        for &Atom { position: newborn, weight } in &self.walls {
            if newborn > least.0 && newborn <= kept {
                let (broken, rate) = exposed.risk(newborn);
                visit(ThresholdShare { newborn, weight, broken, rate });
            }
        }
        kept
    }

    /// The same as [`ThresholdGrid::each`] of a part, between two thresholds: its upper end, and its lower one or what is least above.
    fn sum(
        &self,
        part: &GridPart,
        [low, high]: [ThresholdRisk; 2],
        least: f64,
        (exposed, known): (&Exposed<'_>, &impl Fn(&Exposed<'_>, usize) -> Risk),
        visit: &mut impl FnMut(ThresholdShare),
    ) -> Sought {
        if high.1.0 > GONE {
            return Sought::Continue(());
        }
        if low.1.0 <= KEPT {
            return Sought::Break(low.0);
        }
        let whole = low.0 <= part.ends[0] && !self.is_rooted([low, high], least);
        if whole && !is_uneven([low, high], exposed) {
            part.each(exposed, known, visit);
            return Sought::Continue(());
        }
        let Some(halves) = &part.halves else { return self.cut([low, high], least, exposed, visit) };
        let place = halves[1].place;
        let middle = self.fixed[place];
        if low.0 >= middle {
            return self.sum(&halves[1], [low, high], least, (exposed, known), visit);
        }
        let middle = (middle, known(exposed, place));
        self.sum(&halves[0], [low, middle], least, (exposed, known), visit)?;
        self.sum(&halves[1], [middle, high], least, (exposed, known), visit)
    }

    /// Whether half powers of the distance to the least threshold are too much for one rule.
    fn is_rooted(&self, [low, high]: [ThresholdRisk; 2], least: f64) -> bool {
        /// At a third of the width, 16 points miss 1e-15 of them.
        const NEAR: f64 = 0.3;
        self.rooted && low.0 - least < NEAR * (high.0 - low.0)
    }

    /// Visits Gauss points between two thresholds of which the risk is known, where the `least` is met.
    fn cut(
        &self,
        [low, high]: [ThresholdRisk; 2],
        least: f64,
        exposed: &Exposed<'_>,
        visit: &mut impl FnMut(ThresholdShare),
    ) -> Sought {
        if high.1.0 > GONE {
            return Sought::Continue(());
        }
        if low.1.0 <= KEPT {
            return Sought::Break(low.0);
        }
        if high.0 - low.0 > 4.0 * f64::EPSILON * high.0 && is_uneven([low, high], exposed) {
            let middle = 0.5 * (low.0 + high.0);
            let middle = (middle, exposed.risk(middle));
            self.cut([low, middle], least, exposed, visit)?;
            return self.cut([middle, high], least, exposed, visit);
        }
        let rooted = self.is_rooted([low, high], least);
        let [from, to] = [low.0, high.0].map(|h| if rooted { (h - least).sqrt() } else { h });
        for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
            let (place, weight) = (from + 0.5 * (to - from) * (1.0 + t), 0.5 * (to - from) * w);
            let (newborn, weight) =
                if rooted { (least + place * place, 2.0 * place * weight) } else { (place, weight) };
            let weight = weight * self.law.density(newborn);
            let (broken, rate) = exposed.risk(newborn);
            visit(ThresholdShare { newborn, weight, broken, rate });
        }
        Sought::Continue(())
    }
}

/// Whether one Gauss rule is not enough between two thresholds.
fn is_uneven([low, high]: [ThresholdRisk; 2], exposed: &Exposed<'_>) -> bool {
    let allowed = ONE_RULE + WIDER * (FEW / low.1.0).ln().max(0.0);
    exposed.apart([low.0, high.0]) > allowed
}

/// The zones of a law, the last of them up to the threshold `highest` where its density has no long tail.
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

/// The edges, and more between them towards what is `steep`: down to the place `least` from 0, and to rounding elsewhere.
fn graded(mut edges: Vec<f64>, steep: &[f64], least: f64) -> Vec<f64> {
    /// 16 points miss 5e-19 of a power over a part that is twice as wide as it is far.
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

/// What cuts P_c.
struct Cutter<'a> {
    law: &'a dyn Law,
    /// By how much exponents differ at most.
    apart: &'a dyn Fn([f64; 2]) -> f64,
    fixed: Vec<f64>,
}

impl Cutter<'_> {
    /// A part, halved until one rule is always enough, but no more often than that.
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
        exposed: &Exposed<'_>,
        known: &impl Fn(&Exposed<'_>, usize) -> Risk,
        visit: &mut impl FnMut(ThresholdShare),
    ) {
        for i in 0..NODES {
            let (broken, rate) = known(exposed, self.place + 1 + i);
            visit(ThresholdShare { newborn: self.points[i], weight: self.weights[i], broken, rate });
        }
    }
}
