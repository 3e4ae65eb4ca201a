//! Thresholds that diffuse: a cohort carries the distribution of its thresholds above its stretch, on cells that follow it.
//!
//! It does so twice, with twice as many cells and steps the second time: both errors are of second order, and
//! (4 fine − coarse)/3 is free of them.

use serde::{Deserialize, Serialize};

use super::cohort::Place;
use super::model::Tools;
use super::path::{Path, StepPart};
use super::seeds::Seed;
use crate::Result;
use crate::contacts::{Contacts, Stiffness, Temperature, ThresholdFokkerPlanck};
use crate::monitor::{Monitor, Watch};
use crate::numerics::diffusion::{Coefficients, MovingBoundary, MovingGrid, Potential, Sink, Workspace};

/// Thresholds that diffuse.
#[derive(Debug)]
pub(super) struct Diffusing {
    maturing: ThresholdFokkerPlanck,
    potential: Potential,
    levels: [MovingGrid; LEVELS],
    temperature: Option<Temperature>,
    stiffness: Stiffness,
    /// Newborn contacts where they re-form, in the order of their stretches.
    newborn: Vec<ThresholdMasses>,
    /// The shortest time in which newborn thresholds change much.
    time: f64,
    /// The share of its age (and of that time) that a coarse step of a cohort may take, …
    share: f64,
    /// … and how far it may stretch in it.
    reach: f64,
}

/// Coarse and fine.
const LEVELS: usize = 2;

/// The masses of a cohort in the cells of each level, as shares of its contacts, above a stretch.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ThresholdMasses {
    stretch: f64,
    levels: [Vec<f64>; LEVELS],
}

/// Contacts that hold, and those that heat breaks per time: how many, and their stiffness.
#[derive(Debug, Clone, Copy, Default)]
struct StandingContacts {
    count: f64,
    heated: f64,
    stiffness: f64,
}

impl StandingContacts {
    /// The stiffness of what broke from here to `after`; what heat did not break met its threshold at a stretch.
    fn broken(&self, after: &Self, time: f64, stretch: f64) -> f64 {
        let by_heat = 0.5 * time * (self.heated + after.heated);
        0.5 * time * (self.stiffness + after.stiffness) + (self.count - after.count - by_heat) * stretch
    }
}

/// A way that a cohort goes at one velocity, on one side of the lowest threshold.
#[derive(Debug, Clone, Copy)]
struct PathSegment {
    /// Stretches at both ends.
    from: f64,
    to: f64,
    duration: f64,
}

impl PathSegment {
    /// The k-th of so many equal parts.
    fn part(&self, k: u32, parts: u32) -> Self {
        let at = |k: u32| self.from + (self.to - self.from) * f64::from(k) / f64::from(parts);
        Self { from: at(k), to: at(k + 1), duration: self.duration / f64::from(parts) }
    }

    /// The first of so many equal parts, and the others.
    fn split(&self, parts: f64) -> (Self, Option<Self>) {
        if parts <= 1.0 {
            return (*self, None);
        }
        let duration = self.duration / parts.ceil();
        let middle = self.from + (self.to - self.from) / parts.ceil();
        let rest = Self { from: middle, duration: self.duration - duration, ..*self };
        (Self { to: middle, duration, ..*self }, Some(rest))
    }
}

/// Coarse cells in the width of the narrower law, if they were even, at the tolerance 1.
const CELLS: f64 = 0.6;

/// Width of the lowest cell, relative to even ones: it holds what is near the stretch of fast contacts.
const FINEST: f64 = 0.05;

/// The share of its age that a coarse step may take, and how far contacts may stretch in it, in units of the width of the
/// narrower law; both times the fourth root of the tolerance.
const SHARE: f64 = 2.0;
const REACH: f64 = 4.0;

/// Cells that a step goes through without asking whether to go on, at most.
const MANY: usize = 1 << 16;

/// Cells below which no law is resolved at all.
const FEWEST: f64 = 16.0;

impl Diffusing {
    /// Thresholds of these contacts, which re-form at the `seeds`; `scale` is the width of the narrowest law of theirs.
    /// `None` where they do not diffuse.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(super) fn new(
        contacts: &Contacts,
        seeds: &[Seed],
        scale: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Self>> {
        let Some(maturing) = ThresholdFokkerPlanck::of(contacts) else { return Ok(None) };
        let (low, high) = maturing.support;
        let coarser = tolerance.powf(0.25);
        let cells = (CELLS * (high - low) / (scale * coarser)).ceil().max(FEWEST) as usize;
        let mut diffusing = Self {
            potential: maturing.potential(),
            levels: [1, 2].map(|fine| MovingGrid::new(cells * fine, FINEST)),
            temperature: contacts.rules.temperature,
            stiffness: contacts.stiffness,
            time: scale * scale / maturing.diffusion,
            share: (SHARE * coarser).min(0.5),
            reach: REACH * coarser * scale,
            newborn: Vec::new(),
            maturing,
        };
        let watch = Watch::new(monitor);
        diffusing.newborn = seeds.iter().map(|seed| diffusing.above(seed.stretch, &watch)).collect();
        watch.check()?;
        diffusing.newborn.sort_by(|a, b| a.stretch.total_cmp(&b.stretch));
        Ok(Some(diffusing))
    }

    /// How many numbers a step of a cohort goes through at least, in its two halves.
    pub(super) fn cells(&self) -> usize {
        let numbers = |(level, cells): (usize, &MovingGrid)| (cells.cells() << level) * 2;
        self.levels.iter().enumerate().map(numbers).sum()
    }

    /// Whether there is a mass in each cell of each level.
    pub(super) fn fits(&self, masses: &ThresholdMasses) -> bool {
        self.levels.iter().zip(&masses.levels).all(|(level, masses)| level.cells() == masses.len())
    }

    /// P_ci above the stretch of a seed.
    pub(super) fn newborn(&self, seed: &Seed, watch: &Watch<'_>) -> ThresholdMasses {
        let found = self.newborn.binary_search_by(|masses| masses.stretch.total_cmp(&seed.stretch));
        found.map_or_else(|_| self.above(seed.stretch, watch), |place| self.newborn[place].clone())
    }

    /// P_ci above a stretch.
    fn above(&self, stretch: f64, watch: &Watch<'_>) -> ThresholdMasses {
        let (floor, ceiling) = (self.floor(stretch), self.maturing.support.1);
        let share = |level: &MovingGrid| {
            let middles: Vec<f64> = level.middles(floor, ceiling).collect();
            let mut masses = self
                .maturing
                .newborn(&middles, stretch.abs(), &mut &*watch)
                .unwrap_or_else(|_| vec![0.0; middles.len()]);
            let whole: f64 = masses.iter().sum();
            masses.iter_mut().for_each(|mass| *mass /= whole);
            masses
        };
        ThresholdMasses { stretch, levels: self.levels.each_ref().map(share) }
    }

    fn floor(&self, stretch: f64) -> f64 {
        stretch.abs().max(self.maturing.support.0)
    }

    /// Time passes, in steps that grow with the age. By how much diffusion makes those stiffer that do not break.
    pub(super) fn advance(
        &self,
        place: Place,
        masses: &mut ThresholdMasses,
        path: &Path,
        part: StepPart,
        tools: &mut Tools<'_, '_>,
    ) -> f64 {
        let stiffness = self.measure(masses).1;
        let mut broken = [0.0; LEVELS];
        let mut age = place.age;
        for leg in self.legs(place, path, part) {
            let mut left = Some(leg);
            while let Some(leg) = left {
                let (step, rest) = leg.split(self.steps(&leg, age));
                for (level, broken) in broken.iter_mut().enumerate() {
                    let parts = 1 << level;
                    let part = |k| {
                        let stops = self.levels[level].cells() > MANY && tools.watch.stops();
                        if stops {
                            0.0
                        } else {
                            self.step(&step.part(k, parts), level, masses, &mut tools.room)
                        }
                    };
                    *broken += (0..parts).map(part).sum::<f64>();
                }
                if tools.watch.stops() {
                    return 0.0;
                }
                age += step.duration;
                left = rest;
            }
        }
        let (from, to) = part.ends();
        masses.stretch = place.stretch + path.advance(from, to);
        if self.is_equal() { 0.0 } else { self.measure(masses).1 - stiffness + extrapolated(broken) }
    }

    /// The ways of a part, between where the stretch meets the lowest threshold.
    fn legs(&self, place: Place, path: &Path, part: StepPart) -> Vec<PathSegment> {
        let low = self.maturing.support.0;
        let (from, to) = part.ends();
        let (start, by, time) = (place.stretch, path.advance(from, to), path.time(part));
        let meets = |threshold: f64| (threshold - start) / by;
        let mut ends: Vec<f64> = [-low, low].map(meets).into_iter().filter(|&s| s > 0.0 && s < 1.0).collect();
        ends.extend([0.0, 1.0]);
        ends.sort_by(f64::total_cmp);
        let leg = |ends: &[f64]| PathSegment {
            from: start + by * ends[0],
            to: start + by * ends[1],
            duration: time * (ends[1] - ends[0]),
        };
        ends.windows(2).map(leg).collect()
    }

    /// In how many coarse steps a way may be gone at an age.
    fn steps(&self, leg: &PathSegment, age: f64) -> f64 {
        let longest = self.share * (self.time + age);
        (leg.duration / longest).max((leg.to - leg.from).abs() / self.reach)
    }

    /// A step of one level: the stiffness of what breaks.
    fn step(
        &self,
        leg: &PathSegment,
        level: usize,
        masses: &mut ThresholdMasses,
        room: &mut Workspace,
    ) -> f64 {
        let (low, ceiling) = self.maturing.support;
        let (cells, masses) = (&self.levels[level], &mut masses.levels[level]);
        let [start, end] = [leg.from, leg.to].map(f64::abs);
        let middle = 0.5 * (start + end);
        let before = self.standing(start, cells, masses);
        if end < ceiling {
            let floor = (self.floor(start), self.floor(end));
            let rise = MovingBoundary { floor, ceiling, duration: leg.duration, absorbing: middle >= low };
            let heat =
                |temperature: Temperature| move |h: f64| temperature.rate(middle, h, self.stiffness.of(h));
            let heat = self.temperature.map(heat);
            let sink = heat.as_ref().map(|heat| heat as Sink<'_>);
            let medium =
                Coefficients { potential: &self.potential, diffusion: self.maturing.diffusion, sink };
            cells.advance(&rise, &medium, masses, room);
        } else {
            masses.fill(0.0);
        }
        before.broken(&self.standing(end, cells, masses), leg.duration, middle)
    }

    fn is_equal(&self) -> bool {
        matches!(self.stiffness, Stiffness::Equal(_))
    }

    /// What stands, and what heat breaks of it; not counted where all are equally stiff, as nothing hangs on it.
    fn standing(&self, stretch: f64, cells: &MovingGrid, masses: &[f64]) -> StandingContacts {
        if self.is_equal() {
            return StandingContacts::default();
        }
        let rate = |h: f64| self.temperature.map_or(0.0, |t| t.rate(stretch, h, self.stiffness.of(h)));
        let middles = cells.middles(self.floor(stretch), self.maturing.support.1);
        middles.zip(masses).fold(StandingContacts::default(), |sum, (h, mass)| {
            let heated = rate(h) * mass;
            StandingContacts {
                count: sum.count + mass,
                heated: sum.heated + heated,
                stiffness: sum.stiffness + heated * h,
            }
        })
    }

    /// The share that is left, and its stiffness.
    pub(super) fn measure(&self, masses: &ThresholdMasses) -> (f64, f64) {
        let count = extrapolated(masses.levels.each_ref().map(|masses| masses.iter().sum()));
        if self.is_equal() {
            return (count, count.max(0.0));
        }
        let (floor, high) = (self.floor(masses.stretch), self.maturing.support.1);
        let sum = |level: usize| -> f64 {
            let middles = self.levels[level].middles(floor, high);
            middles.zip(&masses.levels[level]).map(|(h, mass)| mass * h).sum()
        };
        (count, extrapolated([sum(0), sum(1)]).max(0.0))
    }
}

/// What coarse and fine cells tell, without their error of second order.
fn extrapolated([coarse, fine]: [f64; LEVELS]) -> f64 {
    fine + (fine - coarse) / 3.0
}
