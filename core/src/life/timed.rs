//! Contacts that break thermally, whose thresholds age with a fixed rank, or both.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use super::breaking_model::{BlurredEdge, BreakingModel, Cohort, Passing, SurvivalMoments};
use super::cells::{NEGLIGIBLE, ROUNDING, scale, with_atoms};
use super::grid::{GridPart, KnownHazards, ThresholdGrid, ThresholdGroups};
use super::hazard_table::{HazardSeries, HazardTable};
use super::running_maximum::RunningMaximum;
use super::thermal_hazard::{Hazards, ThermalHazard, ThermalHazardAt, blur};
use crate::Result;
use crate::contacts::{Barrier, Contacts, Stiffness, ThresholdEvolution};
use crate::law::{Breakpoint, SharedLaw};
use crate::monitor::{Counted, Watch};
use crate::numerics::exponential::exp;
use crate::numerics::legendre::{NODES, dot_in_lanes, sum_in_lanes};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::roots::brent_root;
use crate::numerics::wide::vectorised;

/// Contacts whose threshold at any age follows from their fresh threshold, and which break when their stretch
/// reaches it, or before at the rate w.
///
/// Of those formed at r the fraction ∫_y^∞ P_c(h_0) e^{−A} dh_0 survives at x = r + u. Here y is the largest
/// fresh threshold reached, h the present threshold, and A = (1/v) ∫_r^x w(ξ; h(h_0; (ξ − r)/v)) dξ the
/// cumulative hazard.
#[derive(Debug, Clone)]
pub(super) struct Timed {
    law: SharedLaw,
    /// Breakpoints and point masses of P_c.
    hazards: Arc<[Breakpoint]>,
    highest: f64,
    evolution: ThresholdEvolution,
    velocity: f64,
    thermal_hazard: Option<ThermalHazard>,
    /// The length over which temperature blurs the breaking of contacts.
    blur: Option<f64>,
    grid: Arc<ThresholdGrid>,
    /// Amount of numbers in cached histories and tables.
    cached: Arc<AtomicUsize>,
    per_threshold: bool,
    resolution: f64,
}

/// The contacts formed at one stretch.
#[derive(Debug)]
struct AgeingCohort {
    of: Timed,
    start: f64,
    running_maximum: RunningMaximum,
    /// A of ageing contacts at the fixed thresholds of the grid, computed when first needed.
    histories: OnceLock<Vec<OnceLock<Piecewise>>>,
    /// A as series in the fresh threshold on the parts of the grid, computed when first needed.
    tables: OnceLock<Vec<OnceLock<Option<HazardTable>>>>,
    /// Whether survival moments have been asked for before: tables are not worth it for one evaluation.
    evaluated: AtomicBool,
}

/// A cohort at an advance.
struct ExposedCohort<'a> {
    cohort: &'a AgeingCohort,
    exposed: &'a ThermalHazardAt<'a>,
    evaluated: bool,
}

impl Timed {
    /// Contacts that move at `velocity`, with thermal breaking if `thermal`.
    ///
    /// # Errors
    /// Those of [`ThresholdEvolution::of`].
    pub(super) fn new(contacts: &Contacts, velocity: f64, thermal: bool, watch: &Watch<'_>) -> Result<Self> {
        let law = &contacts.thresholds;
        let evolution = ThresholdEvolution::of_with(contacts, &mut Counted(watch))?;
        let thermal_hazard = contacts
            .rules
            .temperature
            .filter(|_| thermal)
            .map(|temperature| ThermalHazard::new(contacts, temperature, evolution.clone(), velocity));
        let rooted = contacts.rules.temperature.is_some_and(|t| t.barrier == Barrier::Catastrophe);
        let highest = thermal_hazard.as_ref().map_or_else(
            || law.upper_quantile(NEGLIGIBLE),
            |thermal_hazard| thermal_hazard.highest(law.as_ref(), NEGLIGIBLE),
        );
        let hazards: Arc<[Breakpoint]> = with_atoms(law.as_ref()).into();
        Ok(Self {
            resolution: resolution(contacts, &hazards),
            law: law.clone(),
            hazards,
            highest,
            velocity,
            grid: Arc::new(ThresholdGrid::new(
                law,
                highest,
                thermal_hazard.as_ref(),
                highest / velocity,
                rooted,
                &evolution,
            )),
            evolution,
            cached: Arc::default(),
            blur: contacts.rules.temperature.filter(|_| thermal).map(|t| blur(contacts, &t)),
            thermal_hazard,
            per_threshold: matches!(contacts.stiffness, Stiffness::PerThreshold(_)),
        })
    }
}

impl Timed {
    /// Whether another history or table may be cached.
    fn may_cache(&self) -> bool {
        /// 512 MB.
        const MOST: usize = 1 << 26;
        self.cached.load(Ordering::Relaxed) < MOST
    }

    /// Breakpoints and point masses of P_c that results may show.
    fn visible(&self) -> impl Iterator<Item = &Breakpoint> {
        self.hazards.iter().filter(|b| self.visibility(b) > FAINT)
    }

    /// The size of a breakpoint per mean threshold; 1 for point masses.
    fn visibility(&self, breakpoint: &Breakpoint) -> f64 {
        let mean = self.law.mean();
        if breakpoint.is_atom() { 1.0 } else { breakpoint.weight(mean) * mean }
    }

    fn cache(&self, history: Piecewise) -> Piecewise {
        self.cached.fetch_add(NODES * history.coefficients.len(), Ordering::Relaxed);
        history
    }

    /// Empty histories at all positions of the grid.
    fn room(&self) -> Vec<OnceLock<Piecewise>> {
        let places = self.grid.fixed().len();
        self.cached.fetch_add(places * EMPTY, Ordering::Relaxed);
        vec![OnceLock::new(); places]
    }

    /// The fraction that survives thermal breaking, at an advance, of contacts formed at `start` with this
    /// fresh threshold.
    fn left(&self, start: f64, advance: f64, fresh: f64) -> f64 {
        let hazards = |thermal_hazard: &ThermalHazard| thermal_hazard.at(start, advance).hazards(fresh).0;
        self.thermal_hazard.as_ref().map_or(1.0, |thermal_hazard| (-hazards(thermal_hazard)).exp())
    }
}

/// What an empty history takes, in numbers.
const EMPTY: usize = size_of::<OnceLock<Piecewise>>() / size_of::<f64>();

/// Breakpoints of a density, per mean threshold, that no result shows.
const FAINT: f64 = 1e-11;

/// The same for breakpoints blurred by temperature.
const BLURRED: f64 = 1e-6;

/// A length on which survival varies with the stretch of formation: that of P_c; if P_c has edges, that over
/// which temperature blurs them.
pub(super) fn resolution(contacts: &Contacts, hazards: &[Breakpoint]) -> f64 {
    /// The finest blur that is resolved, per mean threshold.
    const FINEST: f64 = 1e-3;
    let law = contacts.thresholds.as_ref();
    let (mean, widest) = (law.mean(), scale(law));
    let Some(temperature) = contacts.rules.temperature else { return widest };
    let edged = |b: &Breakpoint| b.is_atom() || b.weight(mean) * mean > BLURRED;
    let blur = blur(contacts, &temperature);
    if hazards.iter().any(|b| b.position > 0.0 && edged(b)) {
        widest.min(blur.max(FINEST * mean))
    } else if hazards.iter().any(edged) {
        // Contacts do not reach a threshold of 0: temperature breaks them where ½k h² is about T.
        widest.min((blur * mean).sqrt().max(FINEST * mean))
    } else {
        widest
    }
}

impl BreakingModel for Timed {
    fn cohort(&self, start: f64, _watch: &Watch<'_>) -> Arc<dyn Cohort> {
        let running_maximum = RunningMaximum::new(&self.evolution, self.velocity, start, self.highest);
        Arc::new(AgeingCohort {
            of: self.clone(),
            start,
            running_maximum,
            histories: OnceLock::new(),
            tables: OnceLock::new(),
            evaluated: AtomicBool::new(false),
        })
    }

    fn making_fraction(&self) -> f64 {
        0.0
    }

    fn error(&self) -> f64 {
        /// Error of some ten cells, each as large as the noise of survival moments.
        const CELLS: f64 = 10.0;
        (CELLS * self.roughness()).max(ROUNDING)
    }

    fn roughness(&self) -> f64 {
        self.evolution.error()
    }

    fn is_large(&self) -> bool {
        /// 64 MB.
        const LARGE: usize = 1 << 23;
        self.cached.load(Ordering::Relaxed) > LARGE
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }

    fn tells_of_edges(&self) -> bool {
        true
    }

    fn passing(&self, advance: f64) -> Vec<Passing> {
        let aged = self.evolution.at(advance / self.velocity);
        // Of the contacts that formed u ago, those that started at `start` stand at the threshold
        // of this breakpoint now.
        let pass = |hazard: &Breakpoint| {
            let start = aged.threshold(hazard.position) - advance;
            if start < 0.0 || start >= hazard.position {
                return None;
            }
            let running_maximum = RunningMaximum::new(&self.evolution, self.velocity, start, self.highest);
            // Met before.
            if running_maximum.value(advance) > hazard.position * (1.0 + 1e-12) {
                return None;
            }
            let left = self.left(start, advance, hazard.position);
            // All contacts that share a threshold count. Of a density only the kink that it leaves counts.
            let least = if hazard.is_atom() { NEGLIGIBLE } else { FAINT };
            if left * self.visibility(hazard) <= least {
                return None;
            }
            // The stretch grows at the velocity v, the threshold at its drift: they meet at the
            // difference.
            let speed = (1.0 - aged.drift(hazard.position) / self.velocity).abs();
            let weight = if hazard.is_atom() { hazard.amplitude * left } else { 0.0 };
            Some(Passing { start, weight, speed })
        };
        let back = |start: f64| aged.threshold(start) - start - advance;
        let newest =
            if self.evolution.is_constant() { None } else { brent_root(back, 0.0, self.highest, 0.0) };
        // Temperature has usually broken the contacts with the lowest thresholds long before.
        let newest = newest.filter(|&start| {
            let density = self.law.density(start) * self.law.mean();
            density > FAINT && density * self.left(start, advance, start) > FAINT
        });
        // The lowest threshold of contacts that start at r is r. The start for which the stretch
        // has just caught up with that threshold, which has grown by ageing, separates starts with
        // and without athermal breaks: integrals over starts have a kink there.
        let lull = newest.map(|start| Passing { start, weight: 0.0, speed: 0.0 });
        self.visible().filter_map(pass).chain(lull).collect()
    }
}

impl KnownHazards for ExposedCohort<'_> {
    fn at(&self, place: usize) -> Hazards {
        let Self { cohort, exposed, evaluated } = *self;
        let fresh = cohort.of.grid.fixed()[place];
        // Under constant thresholds A has a closed form, and a history would cost more than it
        // saves.
        if !evaluated || fresh <= cohort.start || cohort.of.evolution.is_constant() {
            return exposed.hazards(fresh);
        }
        let known = cohort.histories.get().is_some_and(|histories| histories[place].get().is_some());
        if !known && !cohort.of.may_cache() {
            return exposed.hazards(fresh);
        }
        let histories = cohort.histories.get_or_init(|| cohort.of.room());
        let end = || cohort.running_maximum.advance_to(fresh).unwrap_or(cohort.of.highest);
        let history = histories[place].get_or_init(|| cohort.of.cache(exposed.history(fresh, end())));
        exposed.interpolated_hazards(fresh, history)
    }

    fn has_series(&self) -> bool {
        let Timed { evolution, thermal_hazard, .. } = &self.cohort.of;
        let is_smooth = thermal_hazard.as_ref().is_some_and(ThermalHazard::is_smooth);
        self.evaluated && is_smooth && !evolution.is_constant() && self.cohort.of.may_cache()
    }

    fn series(&self, part: &GridPart) -> Option<HazardSeries> {
        let Timed { evolution, grid, thermal_hazard, .. } = &self.cohort.of;
        let thermal = thermal_hazard.as_ref().filter(|_| self.has_series())?;
        let room = || (0..grid.count()).map(|_| OnceLock::new()).collect();
        let tables = self.cohort.tables.get_or_init(room);
        let make = || {
            let table = HazardTable::new(thermal, self.cohort.start, part.ends(), part.labels(evolution));
            self.cohort.of.cached.fetch_add(table.as_ref().map_or(0, HazardTable::size), Ordering::Relaxed);
            table
        };
        tables[part.index()].get_or_init(make).as_ref().map(|table| table.at(self.exposed.advance()))
    }
}

impl Drop for AgeingCohort {
    /// Other cohorts of the model may cache as much as this one has.
    fn drop(&mut self) {
        let of_histories = |histories: &Vec<OnceLock<Piecewise>>| {
            let known = histories.iter().filter_map(OnceLock::get);
            EMPTY * histories.len() + NODES * known.map(|history| history.coefficients.len()).sum::<usize>()
        };
        let of_tables = |tables: &Vec<OnceLock<Option<HazardTable>>>| {
            tables.iter().filter_map(|table| table.get()?.as_ref()).map(HazardTable::size).sum()
        };
        let size = self.histories.get().map_or(0, of_histories) + self.tables.get().map_or(0, of_tables);
        self.of.cached.fetch_sub(size, Ordering::Relaxed);
    }
}

impl AgeingCohort {
    /// Adds sixteen groups of contacts.
    fn add(
        &self,
        survival_moments: &mut SurvivalMoments,
        groups: &ThresholdGroups,
        threshold: impl Fn(f64) -> f64,
    ) {
        let ThresholdGroups { fresh, weights, broken, rates, .. } = groups;
        vectorised(
            #[inline(always)]
            || {
                let mut left = *weights;
                for i in 0..NODES {
                    left[i] *= exp(-broken[i]);
                }
                survival_moments.unbroken[0] += sum_in_lanes(&left);
                survival_moments.breaking[0] += dot_in_lanes(&left, rates);
                if self.of.per_threshold {
                    let present = &groups.present.unwrap_or_else(|| fresh.map(threshold));
                    let mut stiffness = left;
                    stiffness.iter_mut().zip(present).for_each(|(left, h)| *left *= h);
                    survival_moments.unbroken[1] += sum_in_lanes(&stiffness);
                    survival_moments.unbroken[2] += dot_in_lanes(&stiffness, present);
                    survival_moments.breaking[1] += dot_in_lanes(&stiffness, rates);
                }
            },
        );
    }

    /// Adds all contacts of an age with fresh thresholds above one.
    fn add_surviving(&self, survival_moments: &mut SurvivalMoments, above: f64, age: f64) {
        let Timed { law, evolution, per_threshold, .. } = &self.of;
        if above.is_infinite() {
            return;
        }
        if *per_threshold {
            let cached = evolution.moments_above(law.as_ref(), above, age);
            survival_moments.unbroken.iter_mut().zip(cached).for_each(|(sum, moment)| *sum += moment);
        } else {
            survival_moments.unbroken[0] += law.survival(above);
        }
    }
}

impl Cohort for AgeingCohort {
    fn survival_moments(&self, advance: f64, watch: &Watch<'_>) -> SurvivalMoments {
        let Timed { law, velocity, .. } = &self.of;
        let (met, speed) = self.running_maximum.value_and_slope(advance);
        let (age, stretch) = (advance / velocity, self.start + advance);
        let mut survival_moments = SurvivalMoments::default();
        // While a threshold falls faster than the stretch rises, none is reached, even where the density is infinite.
        let reached = if speed == 0.0 { 0.0 } else { law.density(met) * speed };
        let (mut reached, mut cached) = (reached, met);
        if let Some(thermal_hazard) = &self.of.thermal_hazard {
            let exposed = thermal_hazard.at(self.start, advance);
            let evaluated = self.evaluated.swap(true, Ordering::Relaxed);
            let known = ExposedCohort { cohort: self, exposed: &exposed, evaluated };
            let threshold = |fresh: f64| exposed.threshold(fresh);
            let add = |groups: &ThresholdGroups| self.add(&mut survival_moments, groups, threshold);
            let visited = self.of.grid.each(met, &exposed, &known, watch, add);
            cached = visited.kept;
            if reached != 0.0 {
                reached *= (-visited.least.unwrap_or_else(|| exposed.hazards(met).0)).exp();
            }
        }
        self.add_surviving(&mut survival_moments, cached, age);
        survival_moments.breaking[0] += reached;
        survival_moments.breaking[1] += reached * stretch;
        survival_moments
    }

    fn breakpoints(&self, watch: &Watch<'_>) -> Vec<Breakpoint> {
        let meet = |hazard: &Breakpoint| {
            let here = hazard.position == self.start;
            let advance = if here { 0.0 } else { self.running_maximum.advance_to(hazard.position)? };
            let left = self.of.left(self.start, advance, hazard.position);
            let speed = if hazard.is_atom() { 1.0 } else { self.running_maximum.value_and_slope(advance).1 };
            let amplitude = hazard.amplitude * left * speed.powf(hazard.exponent + 1.0);
            Some(Breakpoint { position: advance, amplitude, ..*hazard })
        };
        // Where contacts start, only breakpoints that jumps of derivatives do not describe.
        let shows = |b: &&Breakpoint| b.position > self.start || b.position == self.start && b.is_steep();
        let above = self.of.hazards.iter().filter(shows);
        // Where the largest fresh threshold met so far stops or starts to grow, athermal breaking
        // stops or starts: a jump of the breaking density, whose size is the difference of both
        // sides.
        let turns = self.running_maximum.turns().map(|advance| {
            let step = 1e-9 * advance.max(f64::MIN_POSITIVE);
            let amplitude = self.survival_moments(advance + step, watch).breaking[0]
                - self.survival_moments(advance - step, watch).breaking[0];
            Breakpoint { position: advance, exponent: 0.0, amplitude }
        });
        let rare = |b: &Breakpoint| b.is_atom() && b.amplitude <= NEGLIGIBLE;
        above.filter_map(meet).chain(turns).filter(|b| b.amplitude != 0.0 && !rare(b)).collect()
    }

    fn blurred_edges(&self) -> Vec<BlurredEdge> {
        let Some(width) = self.of.blur else { return Vec::new() };
        let met = self.of.visible().filter(|hazard| hazard.position > self.start);
        let edge = |hazard: &Breakpoint| {
            Some(BlurredEdge { advance: self.running_maximum.advance_to(hazard.position)?, width })
        };
        met.filter_map(edge).collect()
    }
}
