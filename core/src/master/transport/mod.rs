//! The master equation for variable velocity: cohorts of contacts followed through time.
//!
//! The state of a time-dependent contact is its stretch x together with its threshold h or its age. Contacts
//! that form together at a stretch r share their stretch x = r + X(t) − X(t_b) for ever. For such a *cohort*
//! the stretch is exact, and only its thresholds have to be followed. With s(t, t_b) the surviving fraction
//! of contacts formed at t_b, and N(t) the fraction broken until t,
//!
//! N(t) = 1 − s(t, 0) + ∫₀^t [1 − s(t, t_b)] dN(t_b − τ), F(t) = N_c⟨k⟩ [x s(t, 0) + ∫₀^t x s(t, t_b) dN(t_b
//! − τ)].
//!
//! Broken contacts are counted as what cohorts lose, re-formed ones as what has broken, so that attached and
//! free contacts always add up to one.

mod broken;
mod cohort;
mod contact_ages;
mod dense_output;
mod diffusing;
mod fitted;
mod formed;
mod free_contacts;
mod grid;
mod mean_field;
mod merged_ranks;
mod merging;
mod merging_limits;
mod model;
mod moment_table;
mod panels;
mod path;
mod ranked;
mod rate_dependent;
mod required;
mod seeds;
mod settled;
mod shared_thresholds;
mod state;
mod steady;
mod step_context;
mod step_control;
mod step_response;
mod survival_table;
mod thermal;
mod threshold_rule;
mod trace;
mod trial;
mod under_load;

use std::sync::Arc;

use super::{Stretches, Tolerance};
use crate::contacts::{Ageing, Contacts, FreeFriction, Initial, Rules, Start};
use crate::energy::ContactEnergies;
use crate::error::positive;
use crate::history::History;
use crate::monitor::{Aside, Cost, Monitor, Part, Watch, report};
use crate::numerics::order::largest;
use crate::rate_dependent::{ROUGH, RateDependentContacts, StretchInterval};
use crate::{Error, Result};
use broken::Broken;
use cohort::{Cohort, EnergyChange};
use contact_ages::{ContactAges, SharedStep};
use dense_output::{DenseOutput, Reading, RequestedReadings, StepReadings};
use merging::MergingRule;
use merging_limits::MergingLimits;
use model::CohortModel;
use path::Path;
pub use required::as_required;
use seeds::{Seed, seeds};
use settled::ConstantRate;
use step_control::StepControl;
pub(in crate::master) use step_control::scale as length_of_lives;
use threshold_rule::ThresholdRule;
pub use trace::Trace;
use trial::StepAttempt;

/// Contacts under a slider whose velocity varies.
///
/// Formation of contacts is accurate to fourth order in the time step for smooth distributions; to second
/// order where densities jump or where contacts spread in stretch reach a point mass of the thresholds.
/// Diffusing thresholds are of fourth order in the width of their cells after extrapolation.
///
/// ```
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// use asperity::history::{History, Piece};
/// use asperity::master::{MasterEquation, Transport};
///
/// // Moved by 2 at the velocity 0.5, and then held.
/// let motion = History::new(vec![
///     Piece { velocity: 0.5, duration: 4.0 },
///     Piece { velocity: 0.0, duration: 10.0 },
/// ])?;
/// let trace = Transport::new(contacts.clone(), &Initial::default())?.follow(&motion, &[4.0, 14.0])?;
/// // These contacts do not depend on time.
/// let pull = MasterEquation::new(contacts, &Initial::default())?.pull(2.0)?;
/// assert!((trace.force[0] - pull.force(2.0)).abs() < 1e-5);
/// assert_eq!(trace.force[0], trace.force[1]);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Transport {
    model: Arc<CohortModel>,
    /// Stretches at which contacts re-form.
    seeds: Arc<[Seed]>,
    /// The cells of the distribution that each seed represents, relative to its stretch, as fractions of it;
    /// empty for a point mass.
    cells: Arc<[Vec<StretchInterval>]>,
    /// Force of all contacts per stretch.
    stiffness: f64,
    /// N_c⟨k⟩ times the mean threshold.
    unit: f64,
    mean_threshold: f64,
    tolerance: f64,
    merging: MergingLimits,
    /// Total friction force of all contacts if they were free.
    friction: FreeFriction,
    time: f64,
    position: f64,
    /// Shared with copies until either takes a step.
    cohorts: Arc<Vec<Cohort>>,
    broken: Broken,
    dropped: f64,
    /// ∫(the fraction of free contacts) |dX|, a length.
    slid: f64,
    /// Energies since the start, in units of the total stiffness.
    spent: EnergyChange,
    pace: StepControl,
    /// Present breaking rate, a fraction of contacts per time.
    rate: f64,
    /// Readings of the last step, which the next one may continue.
    before: Option<StepReadings>,
    /// The velocity of steady sliding, as long as the slider has moved at this velocity only.
    steady: Option<f64>,
    /// The fraction of time-independent contacts that breaks per length, as long as they slide steadily.
    steady_breaks: Option<f64>,
    /// The time since which the breaking rate has been constant, at one velocity.
    constant: ConstantRate,
    /// Times at which the rate of formation has a kink, because the breaking rate had one.
    kinks: Vec<f64>,
    /// The ages of contacts, where they share one distribution of thresholds.
    ages: Option<ContactAges>,
    /// A second solution with a larger tolerance, for the error estimate.
    rough: Option<Box<Self>>,
}

impl Transport {
    /// The largest tolerance with which contacts are followed, although a larger one may be required. Longer steps would be as long
    /// as lives vary on, so that the second solution would not be less accurate, and the estimate of the error too small.
    pub const LARGEST_TOLERANCE: f64 = 1e-4;

    /// The default tolerance of contacts with these rules: 1e-6, and 1e-4 for diffusing thresholds, whose
    /// steps are expensive.
    pub fn default_tolerance(rules: &Rules) -> f64 {
        if matches!(rules.ageing, Some(Ageing::Smoluchowski { .. })) { 1e-4 } else { 1e-6 }
    }

    /// Contacts at t = 0 and X = 0, all of age 0, as accurate as [`Transport::default_tolerance`].
    ///
    /// # Errors
    /// Those of [`Contacts::check`]; `ageing.mean_field` of thresholds with point masses, or with stiffnesses that
    /// depend on them.
    pub fn new(contacts: Contacts, initial: &Initial) -> Result<Self> {
        let tolerance = Self::default_tolerance(&contacts.rules);
        Self::new_with(contacts, initial, tolerance, &mut ())
    }

    /// The same with forces accurate to about `tolerance` × N_c⟨k⟩ × the mean threshold, watched by a
    /// monitor.
    ///
    /// # Errors
    /// As [`Self::new`]; a tolerance outside [1e-12, 1e-2]; stopped by the monitor.
    pub fn new_with(
        contacts: Contacts,
        initial: &Initial,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        contacts.check(initial)?;
        contacts.have_no_stiffness_table()?;
        contacts.break_by_own_threshold()?;
        let rule = ThresholdRule::of(&contacts, monitor)?;
        let mut starting = |tolerance| Self::starting(&contacts, rule.clone(), initial, tolerance, monitor);
        // The two solutions share the ranks of thresholds, whose table is expensive.
        let [fine, rough] = tolerances(tolerance)?;
        Ok(starting(fine)?.beside(starting(rough)?))
    }

    fn starting(
        contacts: &Contacts,
        rule: ThresholdRule,
        initial: &Initial,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let mut transport = Self::empty(contacts, rule, tolerance, monitor)?;
        let first = starting_seeds(contacts, initial, tolerance);
        let held: f64 = first.iter().map(|seed| seed.weight).sum();
        transport.ages = transport.model.table().map(|_| ContactAges::fresh(held));
        transport.cohorts = Arc::new(transport.formed(&first, monitor)?);
        if initial.start == Start::Relaxed {
            transport.broken.add_simultaneous(0.0, 1.0 - held);
            let watch = Watch::new(monitor);
            transport.reform_due_point_masses(&watch);
            watch.check()?;
            transport.spent = EnergyChange::default();
        }
        Ok(transport)
    }

    fn beside(mut self, rough: Self) -> Self {
        self.rough = Some(Box::new(rough));
        self
    }

    fn empty(
        contacts: &Contacts,
        rule: ThresholdRule,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let numbered = |(number, (seed, cells))| (Seed { number: Some(number), ..seed }, cells);
        let (seeds, cells): (Vec<_>, Vec<_>) =
            (0..).zip(reforming(contacts, tolerance)).map(numbered).unzip();
        let stiffness = contacts.stiffness.unit();
        let mean = contacts.thresholds.mean();
        Ok(Self {
            model: Arc::new(rule.model(contacts, &seeds, tolerance, monitor)?),
            seeds: seeds.into(),
            cells: cells.into(),
            stiffness: contacts.count * stiffness,
            unit: contacts.count * contacts.stiffness.of(mean) * mean,
            mean_threshold: mean,
            tolerance,
            merging: MergingLimits::new(contacts, tolerance),
            friction: FreeFriction {
                force: contacts.count * contacts.rules.free_friction.force,
                viscosity: contacts.count * contacts.rules.free_friction.viscosity,
            },
            time: 0.0,
            position: 0.0,
            cohorts: Arc::default(),
            broken: Broken::new(&contacts.rules.delay),
            dropped: 0.0,
            slid: 0.0,
            spent: EnergyChange::default(),
            pace: StepControl::new(contacts, tolerance),
            rate: 0.0,
            before: None,
            steady: None,
            steady_breaks: None,
            constant: ConstantRate::default(),
            kinks: Vec::new(),
            ages: None,
            rough: None,
        })
    }

    /// The cohorts of contacts that form at these seeds.
    fn formed(&self, seeds: &[Seed], monitor: &mut dyn Monitor) -> Result<Vec<Cohort>> {
        let watch = Watch::new(monitor);
        let born = |seed: &Seed| {
            let cohort = Cohort::born(&self.model, seed, seed.weight, &watch);
            watch.check().map(|()| cohort)
        };
        seeds.iter().map(born).collect()
    }

    /// N_c⟨k⟩ × the mean threshold: the unit of force of tolerances.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// Force per stretch if all contacts were attached.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Force F, with that of free contacts, but without what their viscosity adds in motion.
    pub fn force(&self) -> f64 {
        let carried = self.stiffness * self.cohorts.iter().map(Cohort::force).sum::<f64>();
        carried + self.free_friction().force
    }

    /// Friction force and viscosity of the contacts that are free.
    pub fn free_friction(&self) -> FreeFriction {
        self.friction.scaled(self.free())
    }

    /// dF/dX for an instantaneous motion: the stiffness of the attached contacts.
    pub fn tangent(&self) -> f64 {
        self.stiffness * self.cohorts.iter().map(Cohort::tangent).sum::<f64>()
    }

    /// Energies and breaks. Losses are accurate to fourth order in the time step, like the formation of
    /// contacts; the division of a change of stiffness between ageing and breaks to second order, which the
    /// energy balance does not depend on.
    pub fn energies(&self) -> ContactEnergies {
        let stored = self.cohorts.iter().map(Cohort::energy).sum::<f64>();
        let [elastic, lost, strengthening] =
            [stored, self.spent.lost, self.spent.strengthening].map(|energy| self.stiffness * energy);
        let sliding = self.friction.force * self.slid;
        ContactEnergies { elastic, lost, strengthening, sliding, broken: self.broken.all() }
    }

    /// The fraction of attached contacts.
    pub fn attached(&self) -> f64 {
        self.cohorts.iter().map(Cohort::attached).sum()
    }

    /// The fraction of free contacts, counted as those that have broken and not re-formed.
    pub fn free(&self) -> f64 {
        self.broken.free() + self.dropped
    }

    /// Position X.
    pub fn position(&self) -> f64 {
        self.position
    }

    /// Time t.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Breaking rate, a fraction of contacts per time, without simultaneous breaks.
    pub fn breaking_rate(&self) -> f64 {
        self.rate
    }

    /// Q(x) as the mean over the cells of the cohorts, and point masses; both without free contacts.
    pub fn stretch_density(&self, stretches: &[f64]) -> Stretches {
        Stretches::of(&self.stretches(), stretches)
    }

    /// Follows a history that begins at the present time, at rising times since now.
    ///
    /// # Errors
    /// Times that do not rise or lie outside the history; steps that would have to be too short.
    pub fn follow(&mut self, history: &History, times: &[f64]) -> Result<Trace> {
        self.follow_with(history, times, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::follow`]; stopped by the monitor.
    pub fn follow_with(
        &mut self,
        history: &History,
        times: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Trace> {
        /// Fraction of the work for the second solution.
        const ASIDE: f64 = 0.2;
        history.check_times(times)?;
        let mut rough = self.rough.take();
        let coarse =
            rough.as_mut().map(|rough| rough.run(history, times, false, &mut Part::new(monitor, 0.0, ASIDE)));
        self.rough = rough;
        let coarse = coarse.transpose()?;
        let mut trace = self.run(history, times, false, &mut Part::new(monitor, ASIDE, 1.0 - ASIDE))?;
        if let Some(coarse) = coarse {
            // The error is estimated by the difference from the solution with the larger tolerance.
            let off = trace.force.iter().zip(&coarse.force).map(|(fine, rough)| (fine - rough).abs());
            trace.error = largest(off);
        }
        Ok(trace)
    }

    /// Follows a history and reports progress. If `stopping`, steps end at the times, as those of another solution with the
    /// same times do; they always do where densities jump.
    fn run(
        &mut self,
        history: &History,
        times: &[f64],
        stopping: bool,
        monitor: &mut dyn Monitor,
    ) -> Result<Trace> {
        let (begun, origin) = (self.time, self.position);
        let mut trace = Trace::default();
        let stopping = stopping || !self.pace.is_smooth();
        let knots = history.knots().iter().map(|k| k.0);
        let mut stops: Vec<f64> = knots.chain(times.iter().copied().filter(|_| stopping)).collect();
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        let velocity_at = |time: f64| history.pieces()[history.piece_at(time)].velocity;
        let (mut now, mut rest) = (0.0, times);
        for stop in stops {
            if history.knots().iter().any(|knot| knot.0 == now) {
                self.mark_kink();
            }
            if stop > now {
                // Sums of time steps are off by rounding.
                let part = |time: f64| (time - begun).clamp(now, stop) / history.duration();
                // The distance is more accurate than a short time late in a long history.
                let velocity = (history.position(stop) - history.position(now)) / (stop - now);
                let (inside, later) = rest.split_at(rest.partition_point(|&time| time < stop));
                let mut asked = RequestedReadings::new(inside.iter().map(|time| time - now));
                let readings = (&mut asked, MergingRule::Never);
                self.advance_steadily(velocity, stop - now, readings, &part, monitor)?;
                for (&time, reading) in inside.iter().zip(asked.found()) {
                    let at = (begun + time, origin + history.position(time));
                    trace.push(at, velocity_at(time), reading, (self.stiffness, self.friction));
                }
                (now, rest) = (stop, later);
                (self.time, self.position) = (begun + now, origin + history.position(now));
            }
            if let Some((_, later)) = rest.split_first().filter(|(time, _)| **time == stop) {
                trace.push(
                    (self.time, self.position),
                    velocity_at(stop),
                    self.reading(),
                    (self.stiffness, self.friction),
                );
                rest = later;
            }
        }
        Ok(trace)
    }

    /// The present state as a trace shows it.
    fn reading(&self) -> Reading {
        let force = self.cohorts.iter().map(Cohort::force).sum();
        Reading { force, rate: self.rate, free: self.free() }
    }

    /// Moves the slider by `by` in the time `during`, at constant velocity.
    ///
    /// # Errors
    /// A time that is not above 0; steps that would have to be too short; stopped by the monitor.
    pub fn step(&mut self, by: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.step_with(by, during, MergingRule::Never, monitor)
    }

    fn step_with(
        &mut self,
        by: f64,
        during: f64,
        merging: MergingRule,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        positive("during", during)?;
        if !by.is_finite() {
            return Err(Error::invalid("by", "a finite length", by));
        }
        if let Some(rough) = &mut self.rough {
            rough.step(by, during, &mut Aside { fraction: 0.0, monitor })?;
        }
        self.mark_kink();
        let asked = &mut RequestedReadings::default();
        self.advance_steadily(by / during, during, (asked, merging), &|_| 0.0, monitor)
    }

    /// Marks a possible kink of the breaking rate, here and where the contacts that break now re-form.
    fn mark_kink(&mut self) {
        self.pace.restart();
        self.constant.restart();
        self.kinks.extend(self.broken.kinks().iter().map(|after| self.time + after));
    }

    /// Moves at constant velocity for a time, and reads what is asked for on the way; `part` returns the fraction
    /// of the whole work that is done at a time.
    fn advance_steadily(
        &mut self,
        velocity: f64,
        during: f64,
        (asked, merging): (&mut RequestedReadings, MergingRule),
        part: &dyn Fn(f64) -> f64,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        // Velocities are quotients of positions and times, with their rounding.
        self.steady = self.steady.filter(|steady| (steady - velocity).abs() <= ROUNDING * steady);
        if self.remains_steady(velocity, during) {
            asked.read_rest(self.reading());
            return Ok(());
        }
        // Kept separately: after a long hold the time no longer resolves short durations.
        let (mut left, mut few) = (during, self.cohorts.len());
        loop {
            let coarse = &mut Aside { fraction: part(self.time), monitor };
            self.process_events(coarse)?;
            if left <= SAME * during {
                asked.read_rest(self.reading());
                return Ok(());
            }
            let until_event = self.until_event(velocity, left);
            let duration = self.pace.propose(velocity, until_event);
            let free = self.free_for().map(|free| free.min(until_event)).filter(|free| *free > duration);
            if let Some(free) = free {
                self.slide_free(velocity, free);
                left -= free;
                asked.read_same(during - left, self.reading());
            } else if self.advance(&Path::steady(velocity, duration), (during - left, asked), coarse)? {
                left -= duration;
            }
            few = self.merge_many(merging, few);
            if velocity != 0.0 && self.is_settled() {
                self.slide_steadily(velocity, left);
                left = 0.0;
            }
            report(monitor, part(self.time))?;
        }
    }

    /// Tries a step and accepts it if it is accurate enough; returns whether it was.
    /// Accepted steps read what is asked for inside them; `elapsed` is the time of motion before.
    fn advance(
        &mut self,
        path: &Path,
        (elapsed, asked): (f64, &mut RequestedReadings),
        monitor: &mut dyn Monitor,
    ) -> Result<bool> {
        let Self { model, seeds, broken, time, dropped, .. } = self;
        let shared = model.table().zip(self.ages.as_ref()).map(|(table, ages)| SharedStep {
            table,
            ages,
            last: self.pace.last(),
            tolerance: self.tolerance,
        });
        let stage = StepAttempt { model, seeds, broken, time: *time, dropped: *dropped, shared };
        // A rejected attempt leaves the cohorts as they were: it works on copies.
        let trial = stage.attempt(&self.cohorts, path, monitor)?;
        monitor.cost(Cost::TransportedCohorts, trial.cohorts.len());
        let (before, formed) = (self.pace.last(), stage.broken.is_spread().then(|| trial.formed.fraction()));
        if !self.pace.judge(path.duration, (trial.fraction, formed), trial.formed.deaths, trial.missed) {
            monitor.cost(Cost::RejectedTransportSteps, 1);
            self.pace.check(path.duration, self.time, self.tolerance)?;
            return Ok(false);
        }
        let continued = self.before.take().filter(|_| before.is_some());
        monitor.cost(Cost::TransportSteps, 1);
        if !asked.is_empty() {
            let errors = [self.tolerance * self.unit / self.stiffness, self.tolerance];
            let mut dense = DenseOutput::new(&stage, (&self.cohorts, &trial), path, continued, errors);
            self.before = Some(dense.readings());
            asked.read(elapsed, path.duration, &mut dense, monitor)?;
        }
        self.rate = trial.fraction.slope(path.duration, before);
        if let (Some(ages), Some(table), Some(changes)) = (&mut self.ages, self.model.table(), &trial.changes)
        {
            ages.advance(changes, (contact_ages::closeness(self.tolerance), table.soon()));
        }
        let free = self.free();
        self.broken.keep(self.time, path.duration, trial.fraction, trial.formed.mass());
        self.spent = self.spent.plus(1.0, trial.spent);
        self.cohorts = Arc::new(trial.cohorts);
        self.time += path.duration;
        self.position += path.advance(0.0, 1.0);
        self.drop_negligible();
        // Free contacts become more, or fewer, as the breaks and the formation in the step.
        self.slid += path.advance(0.0, 1.0).abs() * (free + trial.formed.mean_free(trial.fraction));
        self.watch_rate(trial.fraction.end / path.duration);
        Ok(true)
    }

    /// Removes cohorts of which almost nothing is left; what they still held counts as broken in the next
    /// step.
    fn drop_negligible(&mut self) {
        let least = LEAST * self.tolerance;
        let Self { cohorts, dropped, spent, .. } = self;
        *dropped = 0.0;
        // What is removed counts as broken, so that probability and energy are conserved however
        // many cohorts are removed.
        Arc::make_mut(cohorts).retain(|cohort| {
            let kept = cohort.left > least && cohort.attached() > least;
            if !kept {
                *dropped += cohort.attached();
                spent.lost += cohort.energy();
            }
            kept
        });
    }

    /// Time until the next simultaneous event, up to `limit`.
    fn until_event(&self, velocity: f64, limit: f64) -> f64 {
        let cohorts: &[Cohort] = if self.model.has_atoms() { &self.cohorts } else { &[] };
        let time_to_atom =
            cohorts.iter().filter_map(|cohort| cohort.time_to_atom(&self.model, velocity, limit));
        let births = self.broken.next_point_mass().into_iter().chain(self.kinks.iter().copied());
        time_to_atom.chain(births.map(|time| time - self.time)).fold(limit, f64::min)
    }

    /// Simultaneous events at the present time: contacts at a point mass of the thresholds break, and point
    /// masses re-form.
    fn process_events(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        let mut simultaneous = 0.0;
        if self.model.has_atoms() {
            for cohort in Arc::make_mut(&mut self.cohorts) {
                let (broken, lost) = cohort.break_at_atom(&self.model);
                simultaneous += broken;
                self.spent.lost += lost;
            }
        }
        if simultaneous > 0.0 {
            self.broken.add_simultaneous(self.time, simultaneous);
            self.mark_kink();
        }
        let watch = Watch::new(monitor);
        self.reform_due_point_masses(&watch);
        watch.check()?;
        let now = self.time * (1.0 + SAME);
        if self.kinks.iter().any(|&kink| kink <= now) {
            self.kinks.retain(|&kink| kink > now);
            self.pace.restart();
        }
        Ok(())
    }

    /// Point masses whose delay is over re-form.
    fn reform_due_point_masses(&mut self, watch: &Watch<'_>) {
        while let Some(point_mass) = self.broken.due(self.time * (1.0 + SAME)) {
            for seed in self.seeds.iter() {
                let born = Cohort::born(&self.model, seed, point_mass.mass * seed.weight, watch);
                self.spent.lost -= born.energy();
                Arc::make_mut(&mut self.cohorts).push(born);
            }
            if let Some(ages) = &mut self.ages {
                ages.add(point_mass.mass);
            }
        }
    }
}

/// Surviving fraction, of a cohort and of all contacts, at which a cohort is removed, in units of the tolerance. A step
/// removes a few cohorts at most, a few steps before they would have broken.
const LEAST: f64 = 1e-4;

/// Relative difference below which velocities are equal.
const ROUNDING: f64 = 1e-9;

/// Relative difference below which times are equal.
const SAME: f64 = 4.0 * f64::EPSILON;

/// The tolerances of a solution and of the second one, for a required tolerance.
fn tolerances(required: f64) -> Result<[f64; 2]> {
    Tolerance::from(required).check()?;
    let fine = required.min(Transport::LARGEST_TOLERANCE);
    Ok([fine, ROUGH * fine])
}

/// Error of a quadrature over stretches, in units of the tolerance.
const PART: f64 = 0.01;

/// The seeds of re-formed contacts. Results depend on the stretch of formation as on the time of formation
/// within a step: smoothly, and where densities jump by as much as over half a step.
fn reforming(contacts: &Contacts, tolerance: f64) -> Vec<(Seed, Vec<StretchInterval>)> {
    let widest = widest(contacts).min(0.5 * step_control::coarsest(contacts, tolerance));
    let law = contacts.reforming.as_ref();
    seeds::fewest(law, contacts.highest_start(), widest, step_control::scale(contacts), PART * tolerance)
}

/// The seeds of the start, each weighted by the fraction of contacts that is left there. A conditional start has no contacts beyond
/// the thresholds; in a relaxed one they break at once.
fn starting_seeds(contacts: &Contacts, initial: &Initial, tolerance: f64) -> Vec<Seed> {
    let (law, thresholds) = (initial.law.as_ref(), contacts.thresholds.as_ref());
    let finest = 0.5 * step_control::coarsest(contacts, tolerance);
    match initial.start {
        Start::Conditional if finest < widest(contacts) => {
            let (scale, error) = (step_control::scale(contacts), PART * tolerance);
            let seeds = seeds::fewest(law, contacts.highest_start(), finest, scale, error);
            seeds.into_iter().map(|(seed, _)| seed).collect()
        }
        Start::Conditional => seeds(law, contacts.highest_start(), (widest(contacts), &[]), |_| 1.0),
        Start::Relaxed => {
            // Where thresholds begin or end, or jump, the fraction that is left is not smooth.
            let mut cuts: Vec<f64> = thresholds.breakpoints().iter().map(|b| b.position).collect();
            cuts.extend(thresholds.atoms().iter().map(|atom| atom.position));
            cuts.sort_by(f64::total_cmp);
            let widest = (widest(contacts).min(finest), cuts.as_slice());
            let highest = contacts.highest_start();
            let left = |x: f64| if x < highest { thresholds.survival(x) } else { 0.0 };
            seeds(law, f64::INFINITY, widest, left)
        }
    }
}

/// The widest cell of a distribution of stretches, limited by the scale of the thresholds.
fn widest(contacts: &Contacts) -> f64 {
    4.0 * step_control::scale(contacts)
}
