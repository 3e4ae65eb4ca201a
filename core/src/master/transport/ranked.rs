//! Thresholds that follow from the age of a contact: the surviving contacts are described by their fresh
//! thresholds.
//!
//! A contact with fresh threshold h_0 ~ P_ci, above its stretch at formation, survives with probability
//! e^{−A}, A = ∫w dt, as long as h_0 > c, the largest fresh threshold that the stretch has reached. The
//! surviving fraction is ∫_c^∞ P_ci e^{−A} dh_0 over that at formation. A falls with h_0, at least by a
//! factor of e where E_0 grows by T. It is stored only on a *band* of thresholds, at Gauss points of the
//! panels of a [`LabelGrid`]: below the band no contacts are left, above it all are. The lower the
//! temperature the narrower the band; without temperature it reduces to c. On the panel that contains c, ln A
//! is the polynomial through its values, for which the rate is continued beyond y = 1.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::grid::{GridPanel, LabelGrid, SurvivorsAbove};
use super::moment_table::MomentTable;
use super::path::{Path, Place};
use super::seeds::Seed;
use super::survival_table::SurvivalTable;
use super::thermal::{StepPassage, StepRule, ThermalBreaking};
use crate::contacts::{
    Barrier, Contacts, Label, Rank, Stiffness, Temperature, ThresholdEvolution, ThresholdsAtAge,
};
use crate::law::{Atom, SharedLaw};
use crate::monitor::Watch;
use crate::numerics::exponential::exp;
use crate::numerics::legendre::{NODES, Nodal, RULE, dot_in_lanes, series_at, sum_in_lanes};
use crate::numerics::roots::{brent_minimum, brent_root};
use crate::numerics::wide::vectorised;

/// Thresholds that follow from age.
#[derive(Debug)]
pub(super) struct RankedThresholds {
    law: SharedLaw,
    /// S, tabulated where the law is smooth.
    table: Option<SurvivalTable>,
    /// ∫ h_0 dP_ci above a threshold, if a table is worth it; computed when first needed, for the tolerance below.
    moments: OnceLock<Option<MomentTable>>,
    tolerance: f64,
    /// Stretch up to which no contact breaks; below 0 if it is not known.
    certain: f64,
    evolution: ThresholdEvolution,
    /// Mean fresh threshold.
    mean: f64,
    stiffness: Stiffness,
    /// Thermal breaking, if it matters.
    thermal: Option<(ThermalBreaking, LabelGrid)>,
    atoms: Vec<Atom>,
    /// The ranks of the point masses, if contacts keep theirs.
    ranks: Vec<Option<Rank>>,
    /// Ages between which thresholds have at most one extremum, if a step may span some of them.
    octaves: Vec<f64>,
}

/// The surviving contacts of a cohort.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct SurvivingRanks {
    /// c.
    pub(super) met: f64,
    /// For each point mass the fraction of the cell that its threshold has not passed, and A.
    pub(super) atoms: Vec<(f64, f64)>,
    /// `None` without thermal breaking.
    pub(super) band: Option<Band>,
    /// The fraction of P_ci above the stretch at formation.
    pub(super) fresh: f64,
}

/// Thresholds at which some contacts survive and some do not; empty until any have broken thermally.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Band {
    /// Index of its lowest panel.
    pub(super) first: u64,
    /// A at the Gauss points of its panels.
    pub(super) exponents: Vec<Nodal>,
}

impl SurvivingRanks {
    /// Bytes of its point masses and of its band.
    pub(super) fn bytes(&self) -> u64 {
        let band = self.band.as_ref().map_or(0, |band| size_of_val(band.exponents.as_slice()));
        (size_of_val(self.atoms.as_slice()) + band) as u64
    }
}

/// Contacts with a larger A have broken.
const GONE: f64 = 60.0;

/// Relative distance at which point masses reach a threshold.
const MET: f64 = 1e-12;

/// How far below their thresholds, in mean thresholds, contacts break in a time of e^`folds`/ω: where the
/// barrier is `folds` × T.
fn moved(contacts: &Contacts, temperature: &Temperature, folds: f64) -> f64 {
    let mean = contacts.thresholds.mean();
    let part = folds * temperature.energy / (0.5 * contacts.stiffness.of(mean) * mean * mean);
    match temperature.barrier {
        Barrier::Elastic => 0.5 * part,
        Barrier::Bell => part,
        Barrier::Catastrophe => part.powf(2.0 / 3.0),
    }
}

/// Whether temperature shifts breaking by more than the tolerance of the first of two solutions, of which the
/// second has this tolerance: both then include temperature, or the difference is below the finer tolerance.
fn is_felt(contacts: &Contacts, temperature: &Temperature, tolerance: f64) -> bool {
    /// E-folds of time over 1/ω, of which there are no more.
    const MOST: f64 = 50.0;
    moved(contacts, temperature, MOST) > tolerance / super::ROUGH
}

impl Band {
    pub(super) fn is_empty(&self) -> bool {
        self.exponents.is_empty()
    }

    /// Index of the first panel above it.
    pub(super) fn end(&self) -> u64 {
        self.first + self.exponents.len() as u64
    }

    /// Removes panels below this one.
    fn rise(&mut self, first: u64) {
        let below = (first.saturating_sub(self.first) as usize).min(self.exponents.len());
        self.exponents.drain(..below);
        self.first = self.first.max(first);
    }
}

impl RankedThresholds {
    /// Contacts of a [`ThresholdEvolution`].
    pub(super) fn new(contacts: &Contacts, evolution: ThresholdEvolution, tolerance: f64) -> Self {
        let law = contacts.thresholds.clone();
        let felt = contacts.rules.temperature.filter(|t| is_felt(contacts, t, tolerance));
        let thermal = felt.map(|t| {
            let thermal = ThermalBreaking::new(contacts, t, moved(contacts, &t, 1.0), tolerance);
            (thermal, LabelGrid::new(contacts, &t, evolution.clone(), tolerance))
        });
        let atoms = law.atoms();
        // Only contacts that break at their thresholds alone ask for S of each cohort in each step.
        let table = (felt.is_none() && atoms.is_empty())
            .then(|| SurvivalTable::of(law.as_ref(), tolerance))
            .flatten();
        // Thresholds that only rise are above fresh ones.
        let certain =
            table.as_ref().filter(|_| evolution.only_strengthens()).map_or(-1.0, SurvivalTable::low);
        Self {
            law,
            certain,
            table,
            moments: OnceLock::new(),
            tolerance,
            ranks: atoms.iter().map(|atom| evolution.rank(atom.position)).collect(),
            octaves: evolution.octaves(),
            evolution,
            mean: contacts.thresholds.mean(),
            stiffness: contacts.stiffness.clone(),
            thermal,
            atoms,
        }
    }

    /// Whether c alone describes the surviving contacts: without temperature, point masses, extrema of thresholds within a
    /// step, and stiffnesses that depend on the threshold.
    pub(super) fn is_plain(&self) -> bool {
        self.thermal.is_none()
            && self.atoms.is_empty()
            && self.octaves.is_empty()
            && self.stiffness.is_equal()
    }

    /// Whether no threshold falls with age.
    pub(super) fn only_strengthen(&self) -> bool {
        self.evolution.only_strengthens()
    }

    /// Whether there are point masses of the thresholds.
    pub(super) fn has_atoms(&self) -> bool {
        !self.atoms.is_empty()
    }

    /// Advances contacts that c alone describes. Returns the surviving fraction, `None` where it is what it was before; the
    /// outer `None` means that other contacts need [`RankedThresholds::advance`].
    pub(super) fn advance_plain(
        &self,
        place: Place,
        left: &mut SurvivingRanks,
        path: &Path,
        ends: (f64, f64),
    ) -> Option<Option<f64>> {
        if !self.is_plain() {
            return None;
        }
        let passage =
            StepPassage { evolution: &self.evolution, stretch: place.stretch, age: place.age, path, ends };
        if (place.stretch + path.advance(ends.0, ends.1)).abs() <= self.certain {
            return Some(None);
        }
        let (stretch, aged) = passage.at(ends.1);
        let met = aged.fresh(stretch);
        if met <= left.met {
            return Some(None);
        }
        left.met = met;
        Some(Some(self.survival(met).max(0.0) / left.fresh))
    }

    /// Whether contacts break thermally.
    pub(super) fn is_thermal(&self) -> bool {
        self.thermal.is_some()
    }

    /// Whether S is tabulated: no density with jumps is.
    pub(super) fn is_tabulated(&self) -> bool {
        self.table.is_some()
    }

    /// Whether thresholds do not depend on age.
    pub(super) fn are_constant(&self) -> bool {
        self.evolution.is_constant()
    }

    /// The threshold at an age of contacts whose fresh threshold is the mean.
    pub(super) fn mean_threshold(&self, age: f64) -> f64 {
        self.evolution.threshold(self.mean, age)
    }

    /// The panel at which the band of contacts begins, or would begin.
    pub(super) fn first_panel(&self, left: &SurvivingRanks) -> u64 {
        match &left.band {
            Some(band) if !band.is_empty() => band.first,
            _ => self.panel_above(left.met),
        }
    }

    /// The first panel that reaches above a fresh threshold.
    pub(super) fn panel_above(&self, fresh: f64) -> u64 {
        self.thermal.as_ref().map_or(0, |(_, grid)| grid.above(fresh))
    }

    /// S(h_0).
    fn survival(&self, fresh: f64) -> f64 {
        self.table.as_ref().map_or_else(|| self.law.survival(fresh), |table| table.value(fresh))
    }

    /// Approximate amount of work of a step of a cohort.
    pub(super) fn cells(&self) -> usize {
        /// Panels of a band.
        const BAND: u64 = 16;
        let band = self.thermal.as_ref().map_or(0, |(_, grid)| grid.count().min(BAND) as usize * NODES);
        1 + self.atoms.len() + band
    }

    pub(super) fn fresh(&self, seed: &Seed) -> SurvivingRanks {
        let above = |atom: &Atom| (uncovered(atom.position, seed.stretch, seed.below, seed.above), 0.0);
        let atoms = self.atoms.iter().map(above).collect();
        let band = self.thermal.as_ref().map(|_| Band::default());
        let mut left = SurvivingRanks { met: seed.stretch.abs(), atoms, band, fresh: 1.0 };
        left.fresh = self.count(&left);
        left
    }

    /// Whether there is an entry for each point mass, and a band on existing panels if there is thermal
    /// breaking.
    pub(super) fn fits(&self, left: &SurvivingRanks) -> bool {
        let fits = |band: &Band, grid: &LabelGrid| band.is_empty() || band.end() <= grid.count();
        left.atoms.len() == self.atoms.len()
            && match (&left.band, &self.thermal) {
                (Some(band), Some((_, grid))) => fits(band, grid),
                (band, thermal) => band.is_none() && thermal.is_none(),
            }
    }

    /// Advances in time: thermal breaking, and thresholds that are reached. Returns the stiffness that the
    /// others gain by ageing. After a stop of `watch` the state is invalid.
    pub(super) fn advance(
        &self,
        place: Place,
        left: &mut SurvivingRanks,
        path: &Path,
        ends: (f64, f64),
        watch: &Watch<'_>,
    ) -> f64 {
        let older = place.age + path.duration * (ends.1 - ends.0);
        let before = self.stiffening(left, place.age, older, watch);
        self.apply(place, left, path, ends, watch);
        // The mean of those present before and after the step: second order in the step, as the
        // division between ageing and breaks is said to be.
        0.5 * (before + self.stiffening(left, place.age, older, watch))
    }

    /// Stiffness that these contacts gain from one age to another.
    fn stiffening(&self, left: &SurvivingRanks, age: f64, older: f64, watch: &Watch<'_>) -> f64 {
        if self.evolution.is_constant() || self.stiffness.is_equal() {
            return 0.0;
        }
        self.measure(left, older, watch).1 - self.measure(left, age, watch).1
    }

    fn apply(
        &self,
        place: Place,
        left: &mut SurvivingRanks,
        path: &Path,
        ends: (f64, f64),
        watch: &Watch<'_>,
    ) {
        let passage =
            StepPassage { evolution: &self.evolution, stretch: place.stretch, age: place.age, path, ends };
        let (stretch, aged) = passage.at(ends.1);
        left.met = left.met.max(aged.fresh(stretch)).max(self.met_between(&passage));
        let (below, above) = (place.below, place.above);
        for ((fraction, _), atom) in left.atoms.iter_mut().zip(&self.atoms) {
            *fraction = fraction.min(uncovered(aged.threshold(atom.position), stretch, below, above));
        }
        if let Some((thermal, grid)) = &self.thermal {
            self.accumulate(thermal, grid, &passage, left, watch);
        }
    }

    /// The largest fresh threshold that the stretch reaches inside a step: thresholds beside an edge of the
    /// distribution may fall and rise again long before the step is over. Below 0 if it reaches none.
    fn met_between(&self, passage: &StepPassage<'_>) -> f64 {
        /// Relative accuracy of the time: the threshold is a maximum there.
        const PRECISE: f64 = 1e-6;
        if self.octaves.is_empty() {
            return f64::NEG_INFINITY;
        }
        let &StepPassage { age, path, ends: (from, to), .. } = passage;
        let older = age + path.duration * (to - from);
        let between = self.octaves.iter().copied().filter(|&octave| octave > age && octave < older);
        let ages: Vec<f64> = std::iter::once(age).chain(between).chain([older]).collect();
        let below = |age_then: f64| {
            let (stretch, aged) = passage.at(from + (age_then - age) / path.duration);
            -aged.fresh(stretch)
        };
        if ages.len() < 3 {
            return f64::NEG_INFINITY;
        }
        let found: Vec<f64> = ages.iter().map(|&age| below(age)).collect();
        let turns = (1..ages.len() - 1).filter(|&i| found[i] < found[i - 1] && found[i] <= found[i + 1]);
        let lowest = |i: usize| brent_minimum(below, ages[i - 1], ages[i + 1], PRECISE * ages[i]).1;
        -turns.map(lowest).fold(f64::INFINITY, f64::min)
    }

    /// Adds ∫w dt to the exponents.
    fn accumulate(
        &self,
        thermal: &ThermalBreaking,
        grid: &LabelGrid,
        passage: &StepPassage<'_>,
        left: &mut SurvivingRanks,
        watch: &Watch<'_>,
    ) {
        /// Panels above the first one whose rates decide on the rule where there is no band yet.
        const AHEAD: u64 = 4;
        /// Nodes in time whose rates are added up between two checks whether to stop.
        const MANY: usize = 1 << 10;
        self.accumulate_on_atoms(thermal, passage, left);
        let SurvivingRanks { met, band: Some(band), .. } = left else { return };
        // Panels, which are expensive, are not even looked at where too few attempts are made.
        if band.is_empty() && thermal.is_idle(passage, grid.folds()) {
            return;
        }
        // Panels are stored between the highest threshold met and the first panel that nothing has
        // broken on: A falls with the threshold, so that these two ends bound the band.
        let count = grid.count();
        let lowest = if band.is_empty() { grid.above(*met) } else { grid.above_from(band.first, *met) };
        let begun = lowest < band.end() && !band.is_empty();
        if begun {
            band.rise(lowest);
        } else {
            *band = Band { first: lowest, ..Band::default() };
        }
        if band.first >= count {
            return;
        }
        let last = if begun { band.end() } else { band.first + AHEAD }.min(count - 1);
        let [low, middle, high] = [band.first, u64::midpoint(band.first, last), last].map(|n| grid.kept(n));
        let between = [low.label(GridPanel::LOWEST), high.label(GridPanel::HIGHEST)];
        let rule = thermal.rule(passage, between, middle.label(GridPanel::MIDDLE));
        let mut room = Vec::new();
        let nodes = |label: Label<'_>, room: &mut Vec<_>| match &rule {
            StepRule::Nothing => {}
            StepRule::Shared(nodes) if room.is_empty() => room.extend_from_slice(nodes),
            StepRule::Shared(_) => {}
            StepRule::Fitted => thermal.fit(passage, label, room),
        };
        if matches!(rule, StepRule::Nothing) {
            return;
        }
        let is_fitted = matches!(rule, StepRule::Fitted);
        if !begun {
            // Panels at whose upper end everything has broken need not be stored.
            let mut gone = |number: u64| {
                if is_fitted && watch.stops() {
                    return true;
                }
                let panel = grid.kept(number);
                let top = panel.label(GridPanel::HIGHEST);
                nodes(top, &mut room);
                thermal.added_to(&room, top) > GONE
            };
            band.first = first_remaining(band.first, count - 1, &mut gone);
        }
        let mut added_up = 0;
        for number in band.first..count {
            let panel = grid.kept(number);
            nodes(panel.label(GridPanel::MIDDLE), &mut room);
            // A rule that is fitted to the panel takes far longer than the rates at its nodes.
            added_up += if is_fitted { MANY } else { room.len() };
            if added_up >= MANY {
                added_up = 0;
                if watch.stops() {
                    return;
                }
            }
            let added = thermal.added(&room, &panel.labels);
            // The stronger a contact the lower its rate.
            if added[0] < thermal.nothing {
                break;
            }
            let place = (number - band.first) as usize;
            if place == band.exponents.len() {
                band.exponents.push(Nodal::default());
            }
            band.exponents[place].iter_mut().zip(added).for_each(|(exponent, added)| *exponent += added);
        }
        // The last panel is kept: it shows that all contacts below its end have broken.
        let gone = band.exponents.iter().take_while(|exponents| exponents[NODES - 1] > GONE).count();
        band.rise(band.first + gone.min(band.exponents.len().saturating_sub(1)) as u64);
    }

    /// The same for point masses.
    fn accumulate_on_atoms(
        &self,
        thermal: &ThermalBreaking,
        passage: &StepPassage<'_>,
        left: &mut SurvivingRanks,
    ) {
        for (((fraction, exponent), atom), rank) in left.atoms.iter_mut().zip(&self.atoms).zip(&self.ranks) {
            if *fraction > 0.0 {
                *exponent += thermal.added_in(passage, Label { fresh: atom.position, rank: rank.as_ref() });
            }
        }
    }

    /// The surviving fraction, and its stiffness.
    pub(super) fn measure(&self, left: &SurvivingRanks, age: f64, watch: &Watch<'_>) -> (f64, f64) {
        let top = self.top(left);
        let aged = (!self.stiffness.is_equal()).then(|| self.evolution.at(age));
        let touched = self.touched(left, aged.as_ref(), watch);
        let count = (self.untouched(left, top) + touched[0]) / left.fresh;
        let stiffness = if aged.is_some() {
            (touched[1] + self.untouched_stiffness(left, top, age)) / left.fresh
        } else {
            count
        };
        (count, stiffness)
    }

    fn count(&self, left: &SurvivingRanks) -> f64 {
        self.untouched(left, self.top(left)) + self.touched(left, None, &Watch::new(&mut ()))[0]
    }

    /// The fraction of fresh contacts above the band, without point masses.
    fn untouched(&self, left: &SurvivingRanks, top: f64) -> f64 {
        let beyond = |atom: &&Atom| atom.position > top;
        let atoms: f64 = self.atoms.iter().filter(beyond).map(|atom| atom.weight).sum();
        let whole = match (&self.thermal, &left.band) {
            (Some((_, grid)), Some(band)) if !band.is_empty() => grid.kept(band.end() - 1).survival,
            _ => self.survival(top),
        };
        (whole - atoms).max(0.0)
    }

    /// The fresh threshold above which A = 0.
    fn top(&self, left: &SurvivingRanks) -> f64 {
        match (&self.thermal, &left.band) {
            (Some((_, grid)), Some(band)) if !band.is_empty() => grid.kept(band.end() - 1).whole.high,
            _ => left.met,
        }
    }

    /// ∫ P_ci h dh_0 above the fresh threshold `from`, the [`Self::top`] of these contacts, without point masses.
    fn untouched_stiffness(&self, left: &SurvivingRanks, from: f64, age: f64) -> f64 {
        let beyond = self.atoms.iter().filter(|atom| atom.position > from);
        let atoms: f64 = beyond.map(|atom| atom.weight * self.evolution.threshold(atom.position, age)).sum();
        let law = self.law.as_ref();
        let whole = match (&self.thermal, &left.band) {
            // Of thresholds that stay as they are the panel knows it.
            (Some((_, grid)), Some(band)) if !band.is_empty() && self.evolution.is_constant() => {
                grid.kept(band.end() - 1).moment(law)
            }
            _ if self.evolution.is_constant() => self.moment_above(from),
            _ => self.evolution.moments_above(law, from, age)[1],
        };
        (whole - atoms).max(0.0)
    }

    /// ∫ P_ci h_0 dh_0 above a fresh threshold.
    fn moment_above(&self, from: f64) -> f64 {
        let law = self.law.as_ref();
        match self.moments.get_or_init(|| MomentTable::of(law, self.tolerance)) {
            Some(table) => table.value(from),
            None => law.upper_moment(1, from),
        }
    }

    /// ∫ P_ci e^{−A} dh_0 over the band above c and over point masses; and the same with the present threshold as a factor, if
    /// thresholds are given.
    fn touched(
        &self,
        left: &SurvivingRanks,
        aged: Option<&ThresholdsAtAge<'_>>,
        watch: &Watch<'_>,
    ) -> [f64; 2] {
        /// Panels between two checks whether to stop: those beyond the ones that are kept are made anew.
        const MANY: usize = 1 << 8;
        let mut sums = [0.0; 2];
        for (atom, (fraction, exponent)) in self.atoms.iter().zip(&left.atoms) {
            let survivors = atom.weight * fraction * (-exponent).exp();
            sums[0] += survivors;
            sums[1] += aged.map_or(0.0, |aged| survivors * aged.threshold(atom.position));
        }
        let (Some((_, grid)), Some(band)) = (&self.thermal, &left.band) else { return sums };
        for (place, (exponents, number)) in band.exponents.iter().zip(band.first..).enumerate() {
            if place % MANY == MANY - 1 && watch.stops() {
                break;
            }
            let panel = grid.kept(number);
            let [count, stiffness] = vectorised(
                #[inline(always)]
                || survivors(&panel, left.met, exponents, aged),
            );
            sums = [sums[0] + count, sums[1] + stiffness];
        }
        sums
    }

    /// The time at which contacts at one stretch that move at `velocity` reach the next point mass of the
    /// thresholds, up to `limit`.
    pub(super) fn time_to_atom(
        &self,
        place: Place,
        left: &SurvivingRanks,
        velocity: f64,
        limit: f64,
    ) -> Option<f64> {
        let ahead = |atom: &Atom, time: f64| {
            self.evolution.threshold(atom.position, place.age + time)
                - (place.stretch + velocity * time).abs()
        };
        let standing = self.atoms.iter().zip(&left.atoms).filter(|(_, (fraction, _))| *fraction > 0.0);
        let times = standing.filter_map(|(atom, _)| {
            if self.evolution.is_constant() {
                let time = (velocity.signum() * atom.position - place.stretch) / velocity;
                return (time >= 0.0 && time <= limit).then_some(time);
            }
            if ahead(atom, limit) > 0.0 {
                return None;
            }
            brent_root(|time| ahead(atom, time), 0.0, limit, 0.0)
        });
        times.reduce(f64::min)
    }

    /// Breaks the point masses of thresholds that contacts at one stretch have reached.
    pub(super) fn break_at_atom(&self, place: Place, left: &mut SurvivingRanks) -> bool {
        let aged = self.evolution.at(place.age);
        for ((fraction, _), atom) in left.atoms.iter_mut().zip(&self.atoms) {
            if place.stretch.abs() >= aged.threshold(atom.position) * (1.0 - MET) {
                *fraction = 0.0;
            }
        }
        !self.atoms.is_empty()
    }
}

/// ∫ P_ci e^{−A} dh_0 over a panel above c, and the same with the present threshold as a factor, if thresholds are given.
#[inline(always)]
fn survivors(panel: &GridPanel, met: f64, exponents: &Nodal, aged: Option<&ThresholdsAtAge<'_>>) -> [f64; 2] {
    let (exponents, mut terms) = (*exponents, panel.weights);
    let thresholds = aged.map(|aged| aged.thresholds_of(&panel.labels));
    if panel.whole.low < met {
        let SurvivorsAbove { points, weights, left } = panel.above(met, &exponents);
        for i in 0..NODES {
            terms[i] = weights[i] * left[i];
        }
        let above =
            |thresholds: Nodal| dot_in_lanes(&terms, &series_at(&RULE.coefficients(&thresholds), &points));
        return [sum_in_lanes(&terms), thresholds.map_or(0.0, above)];
    }
    for i in 0..NODES {
        terms[i] *= exp(-exponents[i]);
    }
    [sum_in_lanes(&terms), thresholds.map_or(0.0, |thresholds| dot_in_lanes(&terms, &thresholds))]
}

/// The first index from `low` on that is not `gone`, or `high`: exponential search, then bisection.
fn first_remaining(low: u64, high: u64, gone: &mut impl FnMut(u64) -> bool) -> u64 {
    if low >= high || !gone(low) {
        return low;
    }
    let (mut last, mut stride) = (low, 1);
    let mut first = loop {
        let next = high.min(last + stride);
        if next == high || !gone(next) {
            break next;
        }
        (last, stride) = (next, 2 * stride);
    };
    while first - last > 1 {
        let middle = last + (first - last) / 2;
        *(if gone(middle) { &mut last } else { &mut first }) = middle;
    }
    first
}

/// The fraction of a cell around a stretch that lies below a threshold; of a point mass, all of it until it
/// has passed.
fn uncovered(threshold: f64, stretch: f64, below: f64, above: f64) -> f64 {
    if below + above > 0.0 {
        return ((threshold - (stretch - below)) / (below + above)).clamp(0.0, 1.0);
    }
    if stretch > threshold * (1.0 + MET) { 0.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::contacts::Rules;
    use crate::law::{Exponential, Gaussian, Point};

    /// The panels of the band after each of some steps at a stretch of about 1, with holds between them.
    fn bands(law: SharedLaw, barrier: Barrier, energy: f64) -> Vec<usize> {
        let temperature = Some(Temperature { barrier, ..Temperature::new(energy, 1.0) });
        let rules = Rules { temperature, ..Rules::default() };
        let contacts = Contacts { rules, ..Contacts::new(law, Arc::new(Point::new(0.0).unwrap())) };
        let ranks = RankedThresholds::new(&contacts, ThresholdEvolution::of(&contacts).unwrap(), 1e-6);
        let seed = Seed { stretch: 0.0, weight: 1.0, below: 0.0, above: 0.0, number: None };
        let mut place = Place { stretch: 0.0, below: 0.0, above: 0.0, age: 0.0 };
        let mut left = ranks.fresh(&seed);
        let mut bands = Vec::new();
        for (by, duration) in [(0.9, 1.0), (0.01, 1e3), (0.0, 1e6), (0.01, 1.0), (0.0, 1e9), (0.1, 1e3)] {
            let path = Path { duration, by };
            ranks.advance(place, &mut left, &path, (0.0, 1.0), &Watch::new(&mut ()));
            (place.stretch, place.age) = (place.stretch + by, place.age + duration);
            bands.push(left.band.as_ref().unwrap().exponents.len());
        }
        bands
    }

    #[test]
    fn contacts_that_hardly_attempt_to_break_take_no_panels() {
        let law: SharedLaw = Arc::new(Exponential::new(1.0).unwrap());
        let stretch = 2.0;
        // Half of the attempts in a step per contact that are neglected, and a hundred times as many.
        for (attempts, makes) in [(0.5, false), (100.0, true)] {
            let contacts = |rate: f64| {
                let temperature = Some(Temperature::new(1e-3, rate));
                let rules = Rules { temperature, ..Rules::default() };
                Contacts { rules, ..Contacts::new(law.clone(), Arc::new(Point::new(0.0).unwrap())) }
            };
            let ranks = |contacts: &Contacts| {
                RankedThresholds::new(contacts, ThresholdEvolution::of(contacts).unwrap(), 1e-6)
            };
            let (thermal, grid) = ranks(&contacts(1.0)).thermal.unwrap();
            let ranks = ranks(&contacts(attempts * thermal.nothing * (-grid.folds()).exp()));
            let seed = Seed { stretch: 0.0, weight: 1.0, below: 0.0, above: 0.0, number: None };
            let place = Place { stretch: 0.0, below: 0.0, above: 0.0, age: 0.0 };
            let mut left = ranks.fresh(&seed);
            let (path, monitor) = (Path { duration: 1.0, by: stretch }, &mut ());
            let watch = Watch::new(monitor);
            ranks.advance(place, &mut left, &path, (0.0, 1.0), &watch);
            assert_eq!(ranks.thermal.as_ref().unwrap().1.known() > 0, makes);
            // Those with a threshold above the stretch are left.
            let off = ranks.measure(&left, 1.0, &watch).0 - (-stretch).exp();
            // Rounding, where no attempt is counted.
            assert!(makes || off.abs() < 1e-15, "{off:e}");
        }
    }

    #[test]
    fn a_band_has_few_panels_at_any_temperature() {
        let laws: [SharedLaw; 2] =
            [Arc::new(Gaussian::new(1.0, 0.05).unwrap()), Arc::new(Exponential::new(1.0).unwrap())];
        for law in laws {
            // ln w falls by ln(60/1e-15) = 39 on it at most, and up to a panel more at either end; on a panel by three, by half
            // as much over the bell barrier, and over the catastrophe barrier by ½ to two.
            for (barrier, most) in
                [(Barrier::Elastic, 15), (Barrier::Bell, 15 * 2), (Barrier::Catastrophe, 50)]
            {
                for energy in [1e-3, 1e-4, 1e-6, 4e-9] {
                    let panels = bands(law.clone(), barrier, energy);
                    assert!(panels.iter().all(|&count| count <= most), "{barrier:?} {energy:e}: {panels:?}");
                    assert!(panels[2] > 0, "{barrier:?} {energy:e}: {panels:?}");
                }
            }
        }
    }
}
