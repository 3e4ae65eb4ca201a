//! Thresholds that diffuse: a cohort carries the distribution of its thresholds above its stretch, on cells.

use std::sync::Arc;

use super::cohort::Place;
use super::path::{Part, Path};
use super::seeds::Seed;
use crate::contacts::{Contacts, Maturing, Stiffness, Temperature};
use crate::law::SharedLaw;
use crate::numerics::diffusion::{Diffusion, Step, Work};

/// Thresholds that diffuse.
#[derive(Debug)]
pub(super) struct Diffusing {
    operator: Arc<Diffusion>,
    newborn: SharedLaw,
    temperature: Option<Temperature>,
    stiffness: Stiffness,
    /// The shortest time in which newborn thresholds change much.
    time: f64,
    /// The share of its age (and of that time) that a step of a cohort may take.
    share: f64,
}

/// The masses of a cohort in the cells, as shares of its contacts.
#[derive(Debug, Clone)]
pub(super) struct Masses(Vec<f64>);

/// Steps of the durations that a path asks for.
#[derive(Debug, Default)]
pub(super) struct Clock {
    /// For each part of a path its whole duration, a half, a quarter, …
    steps: [Vec<Step>; Part::COUNT],
}

/// Contacts that hold, and those that heat breaks per time: how many, and their stiffness.
#[derive(Debug, Clone, Copy, Default)]
struct Standing {
    count: f64,
    heated: f64,
    stiffness: f64,
}

impl Standing {
    /// The stiffness of what broke from here to `after`; what heat did not break met its threshold at a stretch.
    fn broken(&self, after: &Self, time: f64, stretch: f64) -> f64 {
        let by_heat = 0.5 * time * (self.heated + after.heated);
        0.5 * time * (self.stiffness + after.stiffness) + (self.count - after.count - by_heat) * stretch
    }
}

/// Room to work in.
#[derive(Debug, Default)]
pub(super) struct Room {
    work: Work,
    sink: Vec<f64>,
}

/// Width of a cell in units of the narrower law's, times the square root of the tolerance: of second order.
const WIDTH: f64 = 4.0;

/// How many cells the stretch may pass in a step.
const RISE: f64 = 1.5;

/// The share of its age that a step may take, times the cube root of the tolerance.
const SHARE: f64 = 6.0;

/// The largest number of halvings.
const MOST_HALVINGS: u32 = 40;

impl Diffusing {
    /// Thresholds of these contacts; `scale` is the width of the narrowest law of theirs. `None` where they do not diffuse.
    pub(super) fn new(contacts: &Contacts, scale: f64, tolerance: f64) -> Option<Self> {
        let maturing = Maturing::of(contacts)?;
        let width = scale * (WIDTH * tolerance.sqrt()).min(0.2);
        let (low, high) = maturing.support;
        Some(Self {
            operator: Arc::new(maturing.operator(((high - low) / width).ceil() as usize)),
            newborn: contacts.thresholds.clone(),
            temperature: contacts.rules.temperature,
            stiffness: contacts.stiffness,
            time: scale * scale / maturing.diffusion,
            share: (SHARE * tolerance.cbrt()).min(0.5),
        })
    }

    /// How many numbers a step of a cohort goes through.
    pub(super) fn cells(&self) -> usize {
        self.operator.cells()
    }

    /// P_ci above the stretch of a seed.
    pub(super) fn newborn(&self, seed: &Seed) -> Masses {
        let edge = |cell: usize| self.operator.edge(cell).max(seed.stretch.abs());
        let mass = |cell: usize| {
            let (low, high) = (edge(cell), edge(cell + 1));
            let above = self.newborn.survival(low) - self.newborn.survival(high);
            let below = self.newborn.cumulative(high) - self.newborn.cumulative(low);
            if self.newborn.survival(low) < 0.5 { above } else { below }
        };
        let mut masses: Vec<f64> = (0..self.cells()).map(|cell| mass(cell).max(0.0)).collect();
        let whole: f64 = masses.iter().sum();
        masses.iter_mut().for_each(|mass| *mass /= whole);
        Masses(masses)
    }

    /// The steps that a path asks for, of cohorts as young as those born in it.
    pub(super) fn clock(&self, path: &Path) -> Clock {
        Clock { steps: Part::ALL.map(|part| self.halvings(path, part)) }
    }

    fn halvings(&self, path: &Path, part: Part) -> Vec<Step> {
        let whole = path.time(part);
        let finest = (whole / (self.share * self.time)).max(1.0 / self.risen(path, part));
        let most = finest.log2().ceil().clamp(0.0, f64::from(MOST_HALVINGS));
        (0..=most as i32).map(|k| Step::new(&self.operator, whole * 0.5_f64.powi(k))).collect()
    }

    /// The share of a part in which the stretch passes as many cells as it may.
    fn risen(&self, path: &Path, part: Part) -> f64 {
        let (from, to) = part.ends();
        RISE * self.operator.width() / path.advance(from, to).abs()
    }

    /// Time passes, in steps that grow with the age. By how much diffusion makes those stiffer that do not break.
    pub(super) fn advance(
        &self,
        place: Place,
        masses: &mut Masses,
        path: &Path,
        part: Part,
        clock: &Clock,
        room: &mut Room,
    ) -> f64 {
        let steps = &clock.steps[part as usize];
        let (from, to) = part.ends();
        let finest = steps.len() - 1;
        let ticks = 1_u64 << finest;
        let fraction = |tick: u64| from + (to - from) * (tick as f64 / ticks as f64);
        let stretch = |s: f64| (place.stretch + path.advance(from, s)).abs();
        let risen = self.risen(path, part) * path.time(part);
        let stiffness = self.measure(masses).1;
        let mut broken = 0.0;
        let mut tick = 0_u64;
        while tick < ticks {
            let age = place.age + path.duration * (fraction(tick) - from);
            let allowed = risen.min(self.share * (self.time + age));
            let aligned = finest - (tick.trailing_zeros() as usize).min(finest);
            let fits = |k: &usize| steps[*k].duration() <= allowed;
            let halving = (aligned..=finest).find(fits).unwrap_or(finest);
            let next = tick + (ticks >> halving);
            let (start, end) = (fraction(tick), fraction(next));
            let sink = self.sink(stretch(0.5 * (start + end)), &mut room.sink);
            let before = self.standing(masses, sink);
            steps[halving].advance(&mut masses.0, (stretch(start), stretch(end)), sink, &mut room.work);
            let after = self.standing(masses, sink);
            broken += before.broken(&after, steps[halving].duration(), stretch(0.5 * (start + end)));
            tick = next;
        }
        let before = self.standing(masses, None);
        let met = |cell: &usize| self.operator.edge(cell + 1) <= stretch(to);
        (0..self.cells()).take_while(met).for_each(|cell| masses.0[cell] = 0.0);
        broken += before.broken(&self.standing(masses, None), 0.0, stretch(to));
        if self.is_equal() { 0.0 } else { self.measure(masses).1 - stiffness + broken }
    }

    fn is_equal(&self) -> bool {
        matches!(self.stiffness, Stiffness::Equal(_))
    }

    /// What stands, and what heat breaks of it; not counted where all are equally stiff, as nothing hangs on it.
    fn standing(&self, masses: &Masses, sink: Option<&[f64]>) -> Standing {
        if self.is_equal() {
            return Standing::default();
        }
        let rate = |cell: usize| sink.map_or(0.0, |rates| rates[cell]);
        masses.0.iter().enumerate().fold(Standing::default(), |sum, (cell, mass)| Standing {
            count: sum.count + mass,
            heated: sum.heated + rate(cell) * mass,
            stiffness: sum.stiffness + rate(cell) * mass * self.operator.centre(cell),
        })
    }

    /// The breaking rate of each cell at a stretch.
    fn sink<'a>(&self, stretch: f64, room: &'a mut Vec<f64>) -> Option<&'a [f64]> {
        let temperature = self.temperature.as_ref()?;
        room.clear();
        room.extend((0..self.cells()).map(|cell| {
            let threshold = self.operator.centre(cell);
            temperature.rate(stretch, threshold, self.stiffness.of(threshold))
        }));
        Some(room)
    }

    /// The share that is left, and its stiffness.
    pub(super) fn measure(&self, masses: &Masses) -> (f64, f64) {
        let count: f64 = masses.0.iter().sum();
        let stiffness = match self.stiffness {
            Stiffness::Equal(_) => count,
            Stiffness::PerThreshold(_) => {
                masses.0.iter().enumerate().map(|(cell, mass)| mass * self.operator.centre(cell)).sum()
            }
        };
        (count, stiffness)
    }
}
