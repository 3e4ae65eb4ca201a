//! Sums over newborn thresholds, as closely as their law and what temperature does to them ask for.

use super::cells::{NEGLIGIBLE, edges, top, with_atoms};
use super::exposure::{Exposed, Exposure};
use crate::law::{Atom, Law, SharedLaw, Zone};
use crate::numerics::legendre::{NODES, Nodal, RULE};

/// P_c, cut into parts on which it is smooth.
#[derive(Debug)]
pub(super) struct Grid {
    law: SharedLaw,
    parts: Vec<Part>,
    /// Places towards which it is steep.
    steep: Vec<f64>,
    /// Thresholds that many share.
    walls: Vec<Atom>,
    /// Whether what is summed has half powers of the distance to the least threshold.
    rooted: bool,
}

/// A part of P_c, with its Gauss points.
#[derive(Debug)]
struct Part {
    ends: [f64; 2],
    points: Nodal,
    weights: Nodal,
    /// The rates at the points over that at the lower end, where they are the same at any stretch.
    ratios: Option<Nodal>,
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
type Risk = (f64, (f64, f64));

/// Exponents that differ by less are left to one Gauss rule: of exp(−e^{−t}) it misses 1e-14 then.
const ONE_RULE: f64 = 2.5;

/// Where −ln of what is left is above, nothing is; where it is below, all are.
const GONE: f64 = 45.0;
const KEPT: f64 = 1e-17;

/// Parts that are cut beforehand, not as they are needed: beyond, temperatures are so low that few are.
const MOST_PARTS: usize = 2048;

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
        let exposed = exposure.map(|exposure| exposure.at(0.0, 0.0));
        let mut cut = Vec::new();
        for part in parts {
            let apart = exposure.map_or(0.0, |exposure| exposure.apart(part, oldest));
            let count = (apart / ONE_RULE).ceil().max(1.0);
            let count = if count < MOST_PARTS as f64 { count as usize } else { 1 };
            let at = |k: usize| part[0] + (part[1] - part[0]) * k as f64 / count as f64;
            cut.extend((0..count).map(|k| Part::new(law.as_ref(), [at(k), at(k + 1)], exposed.as_ref())));
        }
        let steep = breaks.iter().filter(|b| b.is_steep()).map(|b| b.position).collect();
        Self { law: law.clone(), parts: cut, steep, walls: law.atoms(), rooted }
    }

    /// The thresholds at which the risk is asked for time and again.
    pub(super) fn fixed(&self) -> impl Iterator<Item = f64> + '_ {
        self.parts.iter().flat_map(|part| part.ends.iter().chain(&part.points).copied())
    }

    /// Visits the contacts with newborn thresholds above `least`; without temperature, nothing is broken. `known` tells
    /// the risk at one of the [`Grid::fixed`] thresholds by its place.
    pub(super) fn each(
        &self,
        least: f64,
        exposed: Option<&Exposed<'_>>,
        known: &impl Fn(&Exposed<'_>, usize, f64) -> (f64, f64),
        mut visit: impl FnMut(Share),
    ) {
        let risk = |newborn: f64| (newborn, exposed.map_or((0.0, 0.0), |exposed| exposed.risk(newborn)));
        for &Atom { position: newborn, weight } in self.walls.iter().filter(|wall| wall.position > least) {
            let (_, (broken, rate)) = risk(newborn);
            visit(Share { newborn, weight, broken, rate });
        }
        let first = self.parts.partition_point(|part| part.ends[1] <= least);
        for (number, part) in self.parts.iter().enumerate().skip(first) {
            let place = number * (NODES + 2);
            let at =
                |k: usize, h: f64| (h, exposed.map_or((0.0, 0.0), |exposed| known(exposed, place + k, h)));
            let whole = part.ends[0] >= least;
            let low = if whole { at(0, part.ends[0]) } else { risk(least) };
            let ends = [low, at(1, part.ends[1])];
            let exposed = exposed.filter(|_| ends[0].1.0 > KEPT);
            if !whole || self.is_uneven(part.ends, exposed) {
                self.cut(ends, least, exposed, &mut visit);
            } else if ends[1].1.0 <= GONE {
                part.each(ends[0].1, exposed, |exposed, i, h| known(exposed, place + 2 + i, h), &mut visit);
            }
        }
    }

    /// Whether one Gauss rule is not enough between two thresholds.
    fn is_uneven(&self, [low, high]: [f64; 2], exposed: Option<&Exposed<'_>>) -> bool {
        let width = high - low;
        self.steep.iter().any(|x| (low - x).max(x - high) < 0.99 * width)
            || exposed.is_some_and(|exposed| exposed.apart([low, high]) > ONE_RULE)
    }

    /// Visits Gauss points between two thresholds of which the risk is known.
    fn cut(
        &self,
        [low, high]: [Risk; 2],
        least: f64,
        exposed: Option<&Exposed<'_>>,
        visit: &mut impl FnMut(Share),
    ) {
        if high.1.0 > GONE {
            return;
        }
        let exposed = exposed.filter(|_| low.1.0 > KEPT);
        let width = high.0 - low.0;
        if width > 4.0 * f64::EPSILON * high.0 && self.is_uneven([low.0, high.0], exposed) {
            let middle = 0.5 * (low.0 + high.0);
            let middle = (middle, exposed.map_or((0.0, 0.0), |exposed| exposed.risk(middle)));
            self.cut([low, middle], least, exposed, visit);
            return self.cut([middle, high], least, exposed, visit);
        }
        let rooted = self.rooted && low.0 == least;
        for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
            let part = 0.5 * (1.0 + t);
            let (newborn, weight) = if rooted {
                (low.0 + width * part * part, width * part * w)
            } else {
                (low.0 + width * part, 0.5 * width * w)
            };
            let weight = weight * self.law.density(newborn);
            let (broken, rate) = exposed.map_or((0.0, 0.0), |exposed| exposed.risk(newborn));
            visit(Share { newborn, weight, broken, rate });
        }
    }
}

impl Part {
    fn new(law: &dyn Law, ends: [f64; 2], exposed: Option<&Exposed<'_>>) -> Self {
        let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
        let points = RULE.nodes.map(|t| middle + half * t);
        let weights = std::array::from_fn(|i| half * RULE.weights[i] * law.density(points[i]));
        let separable = exposed.filter(|exposed| exposed.is_separable());
        let ratios = separable.map(|exposed| {
            points.map(|newborn| (exposed.exponent(ends[0]) - exposed.exponent(newborn)).exp())
        });
        Self { ends, points, weights, ratios }
    }

    /// Visits all its points, with the risk at its lower end.
    fn each(
        &self,
        (broken, rate): (f64, f64),
        exposed: Option<&Exposed<'_>>,
        known: impl Fn(&Exposed<'_>, usize, f64) -> (f64, f64),
        visit: &mut impl FnMut(Share),
    ) {
        for i in 0..NODES {
            let (newborn, weight) = (self.points[i], self.weights[i]);
            let (broken, rate) = match (exposed, &self.ratios) {
                (None, _) => (0.0, 0.0),
                (_, Some(ratios)) => (broken * ratios[i], rate * ratios[i]),
                (Some(exposed), _) => known(exposed, i, newborn),
            };
            visit(Share { newborn, weight, broken, rate });
        }
    }
}
