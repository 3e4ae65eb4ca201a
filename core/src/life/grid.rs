//! Sums over newborn thresholds, as closely as their law and what temperature does to them ask for.

use super::cells::{NEGLIGIBLE, edges, top, with_atoms};
use super::exposure::{Exposed, Exposure, Risk};
use crate::law::{Atom, Law, SharedLaw, Zone};
use crate::numerics::legendre::{NODES, Nodal, RULE};

/// P_c, cut into parts on which it is smooth.
#[derive(Debug)]
pub(super) struct Grid {
    law: SharedLaw,
    parts: Vec<Part>,
    /// Ends and points of all parts, and of their halves.
    fixed: Vec<f64>,
    /// Places towards which it is steep.
    steep: Vec<f64>,
    /// Thresholds that many share.
    walls: Vec<Atom>,
    /// Whether what is summed has half powers of the distance to the least threshold.
    rooted: bool,
}

/// A part of P_c, with its Gauss points, and its halves down to where one rule is always enough.
#[derive(Debug)]
struct Part {
    ends: [f64; 2],
    points: Nodal,
    weights: Nodal,
    /// The rates at the points over that at the lower end, where they are the same at any stretch.
    ratios: Option<Nodal>,
    /// The number of its lower end among all fixed thresholds; its points and its upper end follow.
    place: usize,
    halves: Option<Box<[Part; 2]>>,
}

/// The contacts of one newborn threshold: how many, −ln of what temperature left of them, and their rate w/v.
#[derive(Debug, Clone, Copy)]
pub(super) struct Share {
    pub(super) newborn: f64,
    pub(super) weight: f64,
    pub(super) broken: f64,
    pub(super) rate: f64,
}

/// A newborn threshold, with −ln of what temperature left, and w/v.
type At = (f64, Risk);

/// Exponents that differ by less are left to one Gauss rule: of exp(−e^{−t}) over a Gaussian it misses 1e-15 then.
const ONE_RULE: f64 = 2.0;

/// Where A is below `FEW` at the lower end, exponents may differ by `WIDER` more for every e-fold less: exp(−a e^{−t}) is
/// the smoother the smaller a, and the rule misses as little.
const FEW: f64 = 20.0;
const WIDER: f64 = 1.1;

/// Where −ln of what is left is above, nothing is; where it is below, all are.
const GONE: f64 = 45.0;
const KEPT: f64 = 1e-17;

/// How often parts are halved beforehand, not as it is needed: beyond, temperatures are so low that few are.
const MOST_HALVINGS: u32 = 9;

impl Grid {
    /// The parts of a law, cut as finely as `exposure` asks for up to the age `oldest`.
    pub(super) fn new(law: &SharedLaw, exposure: Option<&Exposure>, oldest: f64, rooted: bool) -> Self {
        let breaks = with_atoms(law.as_ref());
        let stops: Vec<f64> = breaks.iter().map(|b| b.position).collect();
        // Gauss points integrate twice as far as they interpolate.
        let wider = |zone: Zone| Zone { resolution: 2.0 * zone.resolution, ..zone };
        let zones: Vec<_> = law.zones().into_iter().map(wider).collect();
        let edges = edges(&zones, &stops, top(law.as_ref(), NEGLIGIBLE));
        let inhabited = |part: &[f64; 2]| law.cumulative(part[1]) > NEGLIGIBLE && !zones.is_empty();
        let parts = edges.windows(2).map(|pair| [pair[0], pair[1]]).filter(inhabited);
        let rest = exposure.map(|exposure| exposure.at(0.0, 0.0));
        let apart = |ends: [f64; 2]| exposure.map_or(0.0, |exposure| exposure.apart(ends, oldest));
        let mut cutter = Cutter { law: law.as_ref(), rest, apart: &apart, fixed: Vec::new() };
        let parts = parts.map(|part| cutter.part(part, 0)).collect();
        let steep = breaks.iter().filter(|b| b.is_steep()).map(|b| b.position).collect();
        Self { law: law.clone(), parts, fixed: cutter.fixed, steep, walls: law.atoms(), rooted }
    }

    /// The thresholds at which the risk is asked for time and again.
    pub(super) fn fixed(&self) -> &[f64] {
        &self.fixed
    }

    /// Visits the contacts with newborn thresholds above `least`, of which the risk is told; without temperature, nothing is
    /// broken. `known` tells the risk at one of the [`Grid::fixed`] thresholds by its place.
    pub(super) fn each(
        &self,
        least: At,
        exposed: Option<&Exposed<'_>>,
        known: &impl Fn(&Exposed<'_>, usize) -> Risk,
        mut visit: impl FnMut(Share),
    ) {
        for &Atom { position: newborn, weight } in self.walls.iter().filter(|wall| wall.position > least.0) {
            let (broken, rate) = exposed.map_or((0.0, 0.0), |exposed| exposed.risk(newborn));
            visit(Share { newborn, weight, broken, rate });
        }
        let first = self.parts.partition_point(|part| part.ends[1] <= least.0);
        for part in &self.parts[first..] {
            let at = |place: usize| {
                (self.fixed[place], exposed.map_or((0.0, 0.0), |exposed| known(exposed, place)))
            };
            let low = if part.ends[0] < least.0 { least } else { at(part.place) };
            self.sum(part, [low, at(part.place + NODES + 1)], least.0, (exposed, known), &mut visit);
        }
    }

    /// The same of a part, between two thresholds: its upper end, and its lower one or what is least above that.
    fn sum(
        &self,
        part: &Part,
        [low, high]: [At; 2],
        least: f64,
        (exposed, known): (Option<&Exposed<'_>>, &impl Fn(&Exposed<'_>, usize) -> Risk),
        visit: &mut impl FnMut(Share),
    ) {
        if high.1.0 > GONE {
            return;
        }
        let exposed = exposed.filter(|_| low.1.0 > KEPT);
        let whole = low.0 <= part.ends[0] && !self.is_rooted([low, high], least);
        if whole && !self.is_uneven([low, high], exposed) {
            return part.each(low.1, exposed, known, visit);
        }
        let Some(halves) = &part.halves else { return self.cut([low, high], least, exposed, visit) };
        let place = halves[1].place;
        let middle = self.fixed[place];
        if low.0 >= middle {
            return self.sum(&halves[1], [low, high], least, (exposed, known), visit);
        }
        let middle = (middle, exposed.map_or((0.0, 0.0), |exposed| known(exposed, place)));
        self.sum(&halves[0], [low, middle], least, (exposed, known), visit);
        self.sum(&halves[1], [middle, high], least, (exposed, known), visit);
    }

    /// Whether half powers of the distance to the least threshold are too much for one rule.
    fn is_rooted(&self, [low, high]: [At; 2], least: f64) -> bool {
        /// At a third of the width, 16 points miss 1e-15 of them.
        const NEAR: f64 = 0.3;
        self.rooted && low.0 - least < NEAR * (high.0 - low.0)
    }

    /// Whether one Gauss rule is not enough between two thresholds.
    fn is_uneven(&self, [low, high]: [At; 2], exposed: Option<&Exposed<'_>>) -> bool {
        let width = high.0 - low.0;
        let allowed = ONE_RULE + WIDER * (FEW / low.1.0).ln().max(0.0);
        self.steep.iter().any(|x| (low.0 - x).max(x - high.0) < 0.99 * width)
            || exposed.is_some_and(|exposed| exposed.apart([low.0, high.0]) > allowed)
    }

    /// Visits Gauss points between two thresholds of which the risk is known, where the `least` is met.
    fn cut(
        &self,
        [low, high]: [At; 2],
        least: f64,
        exposed: Option<&Exposed<'_>>,
        visit: &mut impl FnMut(Share),
    ) {
        if high.1.0 > GONE {
            return;
        }
        let exposed = exposed.filter(|_| low.1.0 > KEPT);
        let width = high.0 - low.0;
        if width > 4.0 * f64::EPSILON * high.0 && self.is_uneven([low, high], exposed) {
            let middle = 0.5 * (low.0 + high.0);
            let middle = (middle, exposed.map_or((0.0, 0.0), |exposed| exposed.risk(middle)));
            self.cut([low, middle], least, exposed, visit);
            return self.cut([middle, high], least, exposed, visit);
        }
        let rooted = self.is_rooted([low, high], least);
        let [from, to] = [low.0, high.0].map(|h| if rooted { (h - least).sqrt() } else { h });
        for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
            let (place, weight) = (from + 0.5 * (to - from) * (1.0 + t), 0.5 * (to - from) * w);
            let (newborn, weight) =
                if rooted { (least + place * place, 2.0 * place * weight) } else { (place, weight) };
            let weight = weight * self.law.density(newborn);
            let (broken, rate) = exposed.map_or((0.0, 0.0), |exposed| exposed.risk(newborn));
            visit(Share { newborn, weight, broken, rate });
        }
    }
}

/// What cuts P_c.
struct Cutter<'a> {
    law: &'a dyn Law,
    rest: Option<Exposed<'a>>,
    /// By how much exponents differ at most.
    apart: &'a dyn Fn([f64; 2]) -> f64,
    fixed: Vec<f64>,
}

impl Cutter<'_> {
    /// A part, halved until one rule is always enough.
    fn part(&mut self, ends: [f64; 2], depth: u32) -> Part {
        let place = self.fixed.len();
        let mut part = Part::new(self.law, ends, self.rest.as_ref(), place);
        self.fixed.push(ends[0]);
        self.fixed.extend(part.points);
        self.fixed.push(ends[1]);
        if (self.apart)(ends) > ONE_RULE && depth < MOST_HALVINGS {
            let middle = 0.5 * (ends[0] + ends[1]);
            let low = self.part([ends[0], middle], depth + 1);
            part.halves = Some(Box::new([low, self.part([middle, ends[1]], depth + 1)]));
        }
        part
    }
}

impl Part {
    fn new(law: &dyn Law, ends: [f64; 2], rest: Option<&Exposed<'_>>, place: usize) -> Self {
        let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
        let points = RULE.nodes.map(|t| middle + half * t);
        let weights = std::array::from_fn(|i| half * RULE.weights[i] * law.density(points[i]));
        let separable = rest.filter(|rest| rest.is_separable());
        let ratios = separable
            .map(|rest| points.map(|newborn| (rest.exponent(ends[0]) - rest.exponent(newborn)).exp()));
        Self { ends, points, weights, ratios, place, halves: None }
    }

    /// Visits all its points, with the risk at its lower end.
    fn each(
        &self,
        (broken, rate): Risk,
        exposed: Option<&Exposed<'_>>,
        known: &impl Fn(&Exposed<'_>, usize) -> Risk,
        visit: &mut impl FnMut(Share),
    ) {
        for i in 0..NODES {
            let (newborn, weight) = (self.points[i], self.weights[i]);
            let (broken, rate) = match (exposed, &self.ratios) {
                (None, _) => (0.0, 0.0),
                (_, Some(ratios)) => (broken * ratios[i], rate * ratios[i]),
                (Some(exposed), _) => known(exposed, self.place + 1 + i),
            };
            visit(Share { newborn, weight, broken, rate });
        }
    }
}
