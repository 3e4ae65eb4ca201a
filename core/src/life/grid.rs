//! Sums over fresh thresholds, resolved as finely as their distribution and temperature require.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::OnceLock;

use super::cells::{NEGLIGIBLE, edges, with_atoms};
use super::constant_threshold::ConstantThresholds;
use super::hazard_table::HazardSeries;
use super::thermal_hazard::{Hazards, ThermalHazard, ThermalHazardAt};
use crate::contacts::{Label, NodalLabels, Rank, ThresholdEvolution};
use crate::law::{Atom, Law, SharedLaw, Zone};
use crate::monitor::Watch;
use crate::numerics::legendre::{NODES, Nodal, RULE, series_at};
use crate::numerics::wide::vectorised;

/// P_c, divided into parts on which it is smooth.
///
/// Towards a power x^α of its density that is not whole, parts are graded: each is a third of the one before,
/// so that Gauss points integrate every power equally well (J. R. Rice, in: Numerical Solution of Partial
/// Differential Equations II (1971)), down to where the remainder is below rounding.
#[derive(Debug)]
pub(super) struct ThresholdGrid {
    law: SharedLaw,
    evolution: ThresholdEvolution,
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
pub(super) struct GridPart {
    ends: [f64; 2],
    points: Nodal,
    weights: Nodal,
    /// Index of its lower end among all fixed thresholds; its points and upper end follow.
    place: usize,
    /// The labels of its points and the ranks of its ends, found when first needed.
    labels: OnceLock<NodalLabels>,
    ranks: [OnceLock<Option<Rank>>; 2],
    /// Its points where thresholds are constant, found when first needed.
    constants: OnceLock<ConstantThresholds>,
    halves: Option<Box<[GridPart; 2]>>,
}

/// Sixteen groups of contacts, each of one fresh threshold: their fractions, present thresholds where these have been needed,
/// cumulative hazards, and hazards w/v.
#[derive(Debug, Clone, Copy)]
pub(super) struct ThresholdGroups {
    pub(super) fresh: Nodal,
    pub(super) weights: Nodal,
    pub(super) present: Option<Nodal>,
    pub(super) broken: Nodal,
    pub(super) rates: Nodal,
}

/// What is known of the hazards of contacts formed at one stretch, at an advance.
pub(super) trait KnownHazards {
    /// The hazards at one of the [`ThresholdGrid::fixed`] thresholds, by its index.
    fn at(&self, place: usize) -> Hazards;

    /// Whether series are in use.
    fn has_series(&self) -> bool;

    /// The cumulative hazard on a part as a series, if that is known to represent it.
    fn series(&self, part: &GridPart) -> Option<HazardSeries>;
}

/// What a visit of all contacts has found.
#[derive(Debug, Clone, Copy)]
pub(super) struct VisitedThresholds {
    /// A threshold above which all survive.
    pub(super) kept: f64,
    /// A of the contacts with the lowest threshold, if there are any near it.
    pub(super) least: Option<f64>,
}

/// The end of an interval of fresh thresholds: the threshold, A, and ΔE/T now and at formation.
#[derive(Debug, Clone, Copy)]
struct IntervalEnd {
    fresh: f64,
    broken: f64,
    now: f64,
    begun: f64,
}

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
        evolution: &ThresholdEvolution,
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
        Self {
            law: law.clone(),
            evolution: evolution.clone(),
            parts,
            fixed: cutter.fixed,
            atoms: law.atoms(),
            rooted,
        }
    }

    /// The thresholds at which hazards are evaluated repeatedly.
    pub(super) fn fixed(&self) -> &[f64] {
        &self.fixed
    }

    /// How many parts there are.
    pub(super) fn count(&self) -> usize {
        self.fixed.len() / (NODES + 2)
    }

    /// Visits the contacts with fresh thresholds above `least` up to a threshold above which all survive. Where the monitor asks
    /// to stop, not all are visited.
    pub(super) fn each(
        &self,
        least: f64,
        exposed: &ThermalHazardAt<'_>,
        known: &impl KnownHazards,
        watch: &Watch<'_>,
        visit: impl FnMut(&ThresholdGroups),
    ) -> VisitedThresholds {
        let mut sums = GridSums { grid: self, exposed, known, least, parts: Cell::new(0), watch, visit };
        // Survival rises with the threshold: the sum ends at the first threshold that all contacts survive.
        let first = self.parts.partition_point(|part| part.ends[1] <= least);
        let mut lowest = None;
        let sought = self.parts[first..].iter().try_for_each(|part| {
            let series = known.series(part);
            let low = if part.ends[0] < least {
                let low = sums.end_at(part, least, series.as_ref());
                lowest = Some(low.broken);
                low
            } else {
                sums.end(part, 0, series.as_ref())
            };
            let high = sums.end(part, 1, series.as_ref());
            sums.add(part, [low, high], series)
        });
        // Above the last part are too few to count, as long as they may live.
        let kept = sought.break_value().unwrap_or(f64::INFINITY);
        for &Atom { position: fresh, weight } in &self.atoms {
            if fresh > least && fresh <= kept {
                sums.add_one(fresh, weight);
            }
        }
        VisitedThresholds { kept, least: lowest }
    }
}

/// What a sum over thresholds is of.
struct GridSums<'a, 'e, 'w, K, V> {
    grid: &'a ThresholdGrid,
    exposed: &'a ThermalHazardAt<'e>,
    known: &'a K,
    /// The lowest threshold.
    least: f64,
    /// Parts begun so far.
    parts: Cell<usize>,
    watch: &'a Watch<'w>,
    visit: V,
}

impl<K: KnownHazards, V: FnMut(&ThresholdGroups)> GridSums<'_, '_, '_, K, V> {
    /// Visits a part between two thresholds: its upper end, and its lower end or the lowest threshold. `series` is that of a part
    /// that contains it.
    fn add(
        &mut self,
        part: &GridPart,
        [low, high]: [IntervalEnd; 2],
        series: Option<HazardSeries>,
    ) -> Search {
        self.ask(low)?;
        if high.broken > GONE {
            return Search::Continue(());
        }
        if low.broken <= KEPT {
            return Search::Break(low.fresh);
        }
        let series = series.or_else(|| self.known.series(part));
        let whole = low.fresh <= part.ends[0];
        // Series of the halves are cheaper than the hazards of single thresholds.
        let is_known = series.is_some() || part.halves.is_none() || !self.known.has_series();
        if is_known && !self.is_rooted([low, high]) && !is_uneven([low, high]) {
            if whole {
                self.add_points(part, series.as_ref());
                return Search::Continue(());
            }
            if let Some(series) = &series
                && self.grid.evolution.error() == 0.0
            {
                self.add_between(part, [low, high], Some(series));
                return Search::Continue(());
            }
        }
        // Fixed thresholds allow cached hazards; below the finest of them points are chosen freely.
        let Some(halves) = &part.halves else { return self.cut(part, [low, high], series.as_ref()) };
        if low.fresh >= halves[1].ends[0] {
            return self.add(&halves[1], [low, high], series);
        }
        let middle = self.end(&halves[1], 0, series.as_ref());
        self.add(&halves[0], [low, middle], series)?;
        self.add(&halves[1], [middle, high], series)
    }

    /// Visits Gauss points between two thresholds of a part, bisecting as needed.
    fn cut(
        &mut self,
        part: &GridPart,
        [low, high]: [IntervalEnd; 2],
        series: Option<&HazardSeries>,
    ) -> Search {
        self.ask(low)?;
        if high.broken > GONE {
            return Search::Continue(());
        }
        if low.broken <= KEPT {
            return Search::Break(low.fresh);
        }
        if high.fresh - low.fresh > 4.0 * f64::EPSILON * high.fresh && is_uneven([low, high]) {
            let middle = self.end_at(part, 0.5 * (low.fresh + high.fresh), series);
            self.cut(part, [low, middle], series)?;
            return self.cut(part, [middle, high], series);
        }
        self.add_between(part, [low, high], series);
        Search::Continue(())
    }

    /// Visits the points of a part.
    fn add_points(&mut self, part: &GridPart, series: Option<&HazardSeries>) {
        let weights = part.weights;
        let groups = match series {
            Some(series) => vectorised(
                #[inline(always)]
                || {
                    let present = self.exposed.thresholds_of(self.labels(part));
                    let rates = self.exposed.rates_of(&present);
                    let (fresh, broken) = (part.points, series.broken_of(&part.points, &rates));
                    ThresholdGroups { fresh, weights, present: Some(present), broken, rates }
                },
            ),
            None if self.grid.evolution.is_constant() => {
                let constants = part.constants.get_or_init(|| self.exposed.constants(part.points));
                self.with_constants(part.points, weights, constants)
            }
            None => Self::with(part.points, weights, |i| self.known.at(part.place + 1 + i)),
        };
        (self.visit)(&groups);
    }

    /// Visits Gauss points between two thresholds of a part.
    fn add_between(&mut self, part: &GridPart, [low, high]: [IntervalEnd; 2], series: Option<&HazardSeries>) {
        let rooted = self.is_rooted([low, high]);
        // In s = √(h − h_0) half powers of the distance to the threshold h_0 are whole ones, and
        // the Gauss rule converges exponentially again.
        let [from, to] =
            [low, high].map(|end| if rooted { (end.fresh - self.least).sqrt() } else { end.fresh });
        let places = RULE.nodes.map(|t| from + 0.5 * (to - from) * (1.0 + t));
        let fresh = if rooted { places.map(|place| self.least + place * place) } else { places };
        let weights = std::array::from_fn(|i| {
            let stretched = if rooted { 2.0 * places[i] } else { 1.0 };
            0.5 * (to - from) * RULE.weights[i] * stretched * self.grid.law.density(fresh[i])
        });
        let groups = match series {
            Some(series) => vectorised(
                #[inline(always)]
                || {
                    // Between its Gauss points present thresholds are interpolated: ranks would be found one by one.
                    let at_points = self.exposed.thresholds_of(self.labels(part));
                    let present = series_at(&RULE.coefficients(&at_points), &part.places(&fresh));
                    let rates = self.exposed.rates_of(&present);
                    let broken = series.broken_of(&fresh, &rates);
                    ThresholdGroups { fresh, weights, present: Some(present), broken, rates }
                },
            ),
            None if self.grid.evolution.is_constant() => {
                self.with_constants(fresh, weights, &self.exposed.constants(fresh))
            }
            None => Self::with(fresh, weights, |i| self.exposed.hazards(fresh[i])),
        };
        (self.visit)(&groups);
    }

    /// Visits the contacts of a point mass.
    fn add_one(&mut self, fresh: f64, weight: f64) {
        let mut weights = [0.0; NODES];
        weights[0] = weight;
        let hazards = self.exposed.hazards(fresh);
        let groups = Self::with([fresh; NODES], weights, |_| hazards);
        (self.visit)(&groups);
    }

    /// Groups with constant thresholds.
    fn with_constants(
        &self,
        fresh: Nodal,
        weights: Nodal,
        constants: &ConstantThresholds,
    ) -> ThresholdGroups {
        let [broken, rates] = vectorised(
            #[inline(always)]
            || self.exposed.hazards_of(constants),
        );
        ThresholdGroups { fresh, weights, present: Some(fresh), broken, rates }
    }

    /// Groups whose hazards are known one by one.
    fn with(fresh: Nodal, weights: Nodal, hazards: impl Fn(usize) -> Hazards) -> ThresholdGroups {
        let hazards: [Hazards; NODES] = std::array::from_fn(hazards);
        let [broken, rates] = [hazards.map(|hazards| hazards.0), hazards.map(|hazards| hazards.1)];
        ThresholdGroups { fresh, weights, present: None, broken, rates }
    }

    /// The lower or the upper end of a part.
    fn end(&self, part: &GridPart, end: usize, series: Option<&HazardSeries>) -> IntervalEnd {
        let fresh = part.ends[end];
        let Some(series) = series else {
            if let Some(halves) = &part.halves {
                let half = &halves[end];
                return self.end(half, end, self.known.series(half).as_ref());
            }
            let hazards = self.known.at(part.place + end * (NODES + 1));
            return self.with_hazards(fresh, hazards.0);
        };
        let rank = part.ranks[end].get_or_init(|| self.grid.evolution.rank(fresh));
        let now = self.exposed.exponent_of(Label { fresh, rank: rank.as_ref() });
        let broken = series.broken(fresh, self.exposed.rate_of(now));
        IntervalEnd { fresh, broken, now, begun: self.exposed.exponent_at_start(fresh) }
    }

    /// A threshold inside a part.
    fn end_at(&self, part: &GridPart, fresh: f64, series: Option<&HazardSeries>) -> IntervalEnd {
        if let Some(series) = series {
            let now = self.exposed.exponent(fresh);
            let broken = series.broken(fresh, self.exposed.rate_of(now));
            return IntervalEnd { fresh, broken, now, begun: self.exposed.exponent_at_start(fresh) };
        }
        match &part.halves {
            Some(halves) => {
                let half = &halves[usize::from(fresh >= halves[1].ends[0])];
                self.end_at(half, fresh, self.known.series(half).as_ref())
            }
            None => self.with_hazards(fresh, self.exposed.hazards(fresh).0),
        }
    }

    fn with_hazards(&self, fresh: f64, broken: f64) -> IntervalEnd {
        let now = self.exposed.exponent(fresh);
        IntervalEnd { fresh, broken, now, begun: self.exposed.exponent_at_start(fresh) }
    }

    fn labels<'p>(&self, part: &'p GridPart) -> &'p NodalLabels {
        part.labels(&self.grid.evolution)
    }

    /// Whether half powers of the distance to the lowest threshold are too strong for one rule.
    fn is_rooted(&self, [low, high]: [IntervalEnd; 2]) -> bool {
        /// At a third of the width, 16 points miss 1e-15 of them.
        const NEAR: f64 = 0.3;
        self.grid.rooted && low.fresh - self.least < NEAR * (high.fresh - low.fresh)
    }

    /// Ends the sum at the threshold `low` if the monitor asks to stop. Low thresholds of broad distributions need thousands of
    /// parts, whose hazards are integrals over the past.
    fn ask(&self, low: IntervalEnd) -> Search {
        /// Parts of sixteen hazards each between two questions.
        const MANY: usize = 8;
        self.parts.set(self.parts.get() + 1);
        let stops = self.parts.get().is_multiple_of(MANY) && self.watch.stops();
        if stops { Search::Break(low.fresh) } else { Search::Continue(()) }
    }
}

/// Whether one Gauss rule is not enough between two thresholds: exponents differ too much now, or at formation as far as contacts
/// break then that count beside those that break now.
fn is_uneven([low, high]: [IntervalEnd; 2]) -> bool {
    /// Barriers that are higher than those now by so much leave 1e-26 of the breaking now: 1e-17 of its integral where it lasts
    /// for a billionth of the advance.
    const FORGOTTEN: f64 = 60.0;
    let allowed = ONE_RULE + WIDER * (FEW / low.broken).ln().max(0.0);
    let most = low.now.max(high.now) + FORGOTTEN;
    let [begun_low, begun_high] = [low.begun.min(most), high.begun.min(most)];
    (high.now - low.now).abs().max((begun_high - begun_low).abs()) > allowed
}

/// The zones of a distribution, the last of them extended to the threshold `highest`.
pub(super) fn zones(law: &dyn Law, highest: f64) -> Vec<Zone> {
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
pub(super) fn graded(mut edges: Vec<f64>, steep: &[f64], least: f64) -> Vec<f64> {
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
        let ranks = std::array::from_fn(|_| OnceLock::new());
        let (labels, constants) = (OnceLock::new(), OnceLock::new());
        Self { ends, points, weights, place, labels, ranks, constants, halves: None }
    }

    /// Its index among all parts.
    pub(super) fn index(&self) -> usize {
        self.place / (NODES + 2)
    }

    /// Its lower and upper end.
    pub(super) fn ends(&self) -> [f64; 2] {
        self.ends
    }

    /// The labels of its points.
    pub(super) fn labels(&self, evolution: &ThresholdEvolution) -> &NodalLabels {
        self.labels.get_or_init(|| evolution.labels(self.points, true))
    }

    /// The places of thresholds in it, from −1 to 1.
    #[inline(always)]
    fn places(&self, fresh: &Nodal) -> Nodal {
        let (middle, half) = (0.5 * (self.ends[0] + self.ends[1]), 0.5 * (self.ends[1] - self.ends[0]));
        let mut places = *fresh;
        places.iter_mut().for_each(|h| *h = (*h - middle) / half);
        places
    }
}
