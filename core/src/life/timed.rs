//! Contacts that temperature breaks, that age rank by rank, or both.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use super::breaking_model::{BlurredEdge, BreakingModel, Cohort, Passing, SurvivalMoments};
use super::cells::{NEGLIGIBLE, ROUNDING, scale, with_atoms};
use super::exposure::{Exposed, Exposure, Risk, blur};
use super::grid::{ThresholdGrid, ThresholdShare};
use super::running_maximum::RunningMaximum;
use crate::Result;
use crate::contacts::{Barrier, Contacts, Stiffness, ThresholdEvolution};
use crate::law::{Breakpoint, SharedLaw};
use crate::monitor::Watch;
use crate::numerics::legendre::NODES;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::roots::brent_root;

/// Contacts each of which has, at any age, a threshold that follows from its newborn one, and breaks where its stretch
/// meets it or before, at the rate w.
///
/// Of those formed at r there are left at x = r + u, with y the largest newborn threshold met and h the present one,
/// ∫_y^∞ P_c(h_0) e^{−A} dh_0, A = (1/v) ∫_r^x w(ξ; h(h_0; (ξ − r)/v)) dξ.
#[derive(Debug, Clone)]
pub(super) struct Timed {
    law: SharedLaw,
    /// Breaks and atoms of P_c.
    hazards: Arc<[Breakpoint]>,
    highest: f64,
    strength: ThresholdEvolution,
    velocity: f64,
    exposure: Option<Exposure>,
    /// The length on which temperature blurs where contacts break.
    blur: Option<f64>,
    grid: Arc<ThresholdGrid>,
    /// How many numbers the histories hold that are kept.
    kept: Arc<AtomicUsize>,
    per_threshold: bool,
    resolution: f64,
}

/// Those formed at one stretch.
#[derive(Debug)]
struct AgeingCohort {
    of: Timed,
    start: f64,
    record: RunningMaximum,
    /// A of contacts that age, at the fixed thresholds of the grid, once asked for, …
    histories: OnceLock<Vec<OnceLock<Piecewise>>>,
    /// … but not of contacts that are asked but once for their survival moments.
    asked: AtomicBool,
}

impl Timed {
    /// Contacts that move at `velocity`, broken by temperature if that is `thermal`.
    ///
    /// # Errors
    /// Those of [`ThresholdEvolution::of`].
    pub(super) fn new(
        contacts: &Contacts,
        velocity: f64,
        thermal: bool,
        mut watch: &Watch<'_>,
    ) -> Result<Self> {
        let law = &contacts.thresholds;
        let strength = ThresholdEvolution::of(contacts, &mut watch)?;
        let exposure = contacts
            .rules
            .temperature
            .filter(|_| thermal)
            .map(|temperature| Exposure::new(contacts, temperature, strength.clone(), velocity));
        let rooted = contacts.rules.temperature.is_some_and(|t| t.barrier == Barrier::Catastrophe);
        let highest = exposure.as_ref().map_or_else(
            || law.upper_quantile(NEGLIGIBLE),
            |exposure| exposure.highest(law.as_ref(), NEGLIGIBLE),
        );
        let hazards: Arc<[Breakpoint]> = with_atoms(law.as_ref()).into();
        Ok(Self {
            resolution: resolution(contacts, &hazards),
            law: law.clone(),
            hazards,
            highest,
            strength,
            velocity,
            grid: Arc::new(ThresholdGrid::new(law, highest, exposure.as_ref(), highest / velocity, rooted)),
            kept: Arc::default(),
            blur: contacts.rules.temperature.filter(|_| thermal).map(|t| blur(contacts, &t)),
            exposure,
            per_threshold: matches!(contacts.stiffness, Stiffness::PerThreshold(_)),
        })
    }
}

impl Timed {
    /// Whether one more history may be kept.
    fn may_keep(&self) -> bool {
        /// 64 MB.
        const MOST: usize = 1 << 23;
        self.kept.load(Ordering::Relaxed) < MOST
    }

    /// Breaks and atoms of P_c that results may show.
    fn seen(&self) -> impl Iterator<Item = &Breakpoint> {
        let mean = self.law.mean();
        self.hazards.iter().filter(move |b| b.is_atom() || b.weight(mean) * mean > FAINT)
    }

    fn keep(&self, history: Piecewise) -> Piecewise {
        self.kept.fetch_add(NODES * history.coefficients.len(), Ordering::Relaxed);
        history
    }

    /// Room for histories at all places of the grid.
    fn room(&self) -> Vec<OnceLock<Piecewise>> {
        let places = self.grid.fixed().len();
        self.kept.fetch_add(places * size_of::<OnceLock<Piecewise>>() / size_of::<f64>(), Ordering::Relaxed);
        vec![OnceLock::new(); places]
    }

    /// What temperature leaves, at an advance, of contacts formed at `start` with the newborn threshold.
    fn left(&self, start: f64, advance: f64, newborn: f64) -> f64 {
        let risk = |exposure: &Exposure| exposure.at(start, advance).risk(newborn).0;
        self.exposure.as_ref().map_or(1.0, |exposure| (-risk(exposure)).exp())
    }
}

/// Breaks of a density, per mean threshold, that no result shows …
const FAINT: f64 = 1e-11;

/// … or whose blur by temperature none shows.
const BLURRED: f64 = 1e-6;

/// A length on which what is left of contacts varies with where they formed: that of P_c; where P_c has edges, that on
/// which temperature blurs them.
fn resolution(contacts: &Contacts, hazards: &[Breakpoint]) -> f64 {
    /// The finest blur that is followed, per mean threshold.
    const FINEST: f64 = 1e-3;
    let law = contacts.thresholds.as_ref();
    let (mean, widest) = (law.mean(), scale(law));
    let Some(temperature) = contacts.rules.temperature else { return widest };
    let edged = |b: &Breakpoint| b.is_atom() || b.weight(mean) * mean > BLURRED;
    let blur = blur(contacts, &temperature);
    if hazards.iter().any(|b| b.position > 0.0 && edged(b)) {
        widest.min(blur.max(FINEST * mean))
    } else if hazards.iter().any(edged) {
        // None meets a threshold of 0; near it contacts do not hold against temperature, where ½k h² is about T.
        widest.min((blur * mean).sqrt().max(FINEST * mean))
    } else {
        widest
    }
}

impl BreakingModel for Timed {
    fn cohort(&self, start: f64, _watch: &Watch<'_>) -> Arc<dyn Cohort> {
        let record = RunningMaximum::new(&self.strength, self.velocity, start, self.highest);
        let (histories, asked) = (OnceLock::new(), AtomicBool::new(false));
        Arc::new(AgeingCohort { of: self.clone(), start, record, histories, asked })
    }

    fn making(&self) -> f64 {
        0.0
    }

    fn error(&self) -> f64 {
        /// Some ten cells leave out what survival moments are rough by, each.
        const CELLS: f64 = 10.0;
        (CELLS * self.roughness()).max(ROUNDING)
    }

    fn roughness(&self) -> f64 {
        self.strength.error()
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }

    fn tells_of_edges(&self) -> bool {
        true
    }

    fn passing(&self, advance: f64) -> Vec<Passing> {
        let aged = self.strength.at(advance / self.velocity);
        let pass = |hazard: &Breakpoint| {
            let start = aged.threshold(hazard.position) - advance;
            if start < 0.0 || start >= hazard.position {
                return None;
            }
            let record = RunningMaximum::new(&self.strength, self.velocity, start, self.highest);
            // Met before.
            if record.met(advance) > hazard.position * (1.0 + 1e-12) {
                return None;
            }
            let pace = (1.0 - aged.drift(hazard.position) / self.velocity).abs();
            let left = self.left(start, advance, hazard.position);
            let weight = if hazard.is_atom() { hazard.amplitude * left } else { 0.0 };
            Some(Passing { start, weight, pace })
        };
        let back = |start: f64| aged.threshold(start) - start - advance;
        let newest =
            if self.strength.is_constant() { None } else { brent_root(back, 0.0, self.highest, 0.0) };
        let newest = newest.filter(|&start| self.law.density(start) * self.law.mean() > FAINT);
        let lull = newest.map(|start| Passing { start, weight: 0.0, pace: 0.0 });
        self.seen().filter_map(pass).chain(lull).collect()
    }
}

impl AgeingCohort {
    /// The risk of contacts at a place of the grid.
    fn risk(&self, exposed: &Exposed<'_>, place: usize, asked: bool) -> Risk {
        let newborn = self.of.grid.fixed()[place];
        if !asked || newborn <= self.start || self.of.strength.is_constant() {
            return exposed.risk(newborn);
        }
        let known = self.histories.get().is_some_and(|histories| histories[place].get().is_some());
        if !known && !self.of.may_keep() {
            return exposed.risk(newborn);
        }
        let histories = self.histories.get_or_init(|| self.of.room());
        let end = || self.record.meeting(newborn).unwrap_or(self.of.highest);
        let history = histories[place].get_or_init(|| self.of.keep(exposed.history(newborn, end())));
        exposed.known_risk(newborn, history)
    }

    /// Adds contacts of one newborn threshold.
    fn add(&self, toll: &mut SurvivalMoments, share: ThresholdShare, present: f64) {
        let left = share.weight * (-share.broken).exp();
        let breakpoints = left * share.rate;
        toll.unbroken[0] += left;
        toll.breaking[0] += breakpoints;
        if self.of.per_threshold {
            toll.unbroken[1] += left * present;
            toll.unbroken[2] += left * present * present;
            toll.breaking[1] += breakpoints * present;
        }
    }

    /// Adds all contacts of an age with newborn thresholds above one.
    fn add_kept(&self, toll: &mut SurvivalMoments, above: f64, age: f64) {
        let Timed { law, strength, per_threshold, .. } = &self.of;
        if above.is_infinite() {
            return;
        }
        if *per_threshold {
            let kept = strength.moments_above(law.as_ref(), above, age);
            toll.unbroken.iter_mut().zip(kept).for_each(|(sum, moment)| *sum += moment);
        } else {
            toll.unbroken[0] += law.survival(above);
        }
    }
}

impl Cohort for AgeingCohort {
    fn toll(&self, advance: f64) -> SurvivalMoments {
        let Timed { law, strength, velocity, .. } = &self.of;
        let (met, pace) = self.record.reach(advance);
        let (age, stretch) = (advance / velocity, self.start + advance);
        let mut toll = SurvivalMoments::default();
        let (mut reached, mut kept) = (law.density(met) * pace, met);
        if let Some(exposure) = &self.of.exposure {
            let exposed = exposure.at(self.start, advance);
            let least = (met, exposed.risk(met));
            let asked = self.asked.swap(true, Ordering::Relaxed);
            let aged = strength.at(age);
            let add = |share: ThresholdShare| self.add(&mut toll, share, aged.threshold(share.newborn));
            let known = |exposed: &Exposed<'_>, place: usize| self.risk(exposed, place, asked);
            kept = self.of.grid.each(least, &exposed, &known, add);
            reached *= (-least.1.0).exp();
        }
        self.add_kept(&mut toll, kept, age);
        toll.breaking[0] += reached;
        toll.breaking[1] += reached * stretch;
        toll
    }

    fn breakpoints(&self) -> Vec<Breakpoint> {
        let meet = |hazard: &Breakpoint| {
            let here = hazard.position == self.start;
            let advance = if here { 0.0 } else { self.record.meeting(hazard.position)? };
            let left = self.of.left(self.start, advance, hazard.position);
            let pace = if hazard.is_atom() { 1.0 } else { self.record.reach(advance).1 };
            let amplitude = hazard.amplitude * left * pace.powf(hazard.exponent + 1.0);
            Some(Breakpoint { position: advance, amplitude, ..*hazard })
        };
        // Where contacts start, only what no derivative tells.
        let shows = |b: &&Breakpoint| b.position > self.start || b.position == self.start && b.is_steep();
        let above = self.of.hazards.iter().filter(shows);
        let turns = self.record.turns().map(|advance| {
            let step = 1e-9 * advance.max(f64::MIN_POSITIVE);
            let amplitude = self.toll(advance + step).breaking[0] - self.toll(advance - step).breaking[0];
            Breakpoint { position: advance, exponent: 0.0, amplitude }
        });
        let rare = |b: &Breakpoint| b.is_atom() && b.amplitude <= NEGLIGIBLE;
        above.filter_map(meet).chain(turns).filter(|b| b.amplitude != 0.0 && !rare(b)).collect()
    }

    fn blurred_edges(&self) -> Vec<BlurredEdge> {
        let Some(width) = self.of.blur else { return Vec::new() };
        let met = self.of.seen().filter(|hazard| hazard.position > self.start);
        let edge =
            |hazard: &Breakpoint| Some(BlurredEdge { advance: self.record.meeting(hazard.position)?, width });
        met.filter_map(edge).collect()
    }
}
