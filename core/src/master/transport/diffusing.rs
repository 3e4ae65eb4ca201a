//! Diffusing thresholds: a cohort carries the distribution of its thresholds above its stretch, on cells that
//! move with it.
//!
//! It does so on two levels, with twice as many cells and steps on the second. Both errors are of second
//! order and are removed by Richardson extrapolation, (4 fine − coarse)/3.

use serde::{Deserialize, Serialize};

use super::path::{Path, Place, StepPart};
use super::seeds::Seed;
use super::step_context::StepContext;
use crate::contacts::{Contacts, Stiffness, Temperature, ThresholdFokkerPlanck};
use crate::monitor::{Monitor, Watch, fits};
use crate::numerics::diffusion::{Coefficients, MovingBoundary, MovingGrid, Potential, Sink, Workspace};
use crate::numerics::legendre::{NODES, Nodal};
use crate::numerics::order::sort_by_number;
use crate::numerics::wide::vectorised;
use crate::{Error, Result};

/// Diffusing thresholds.
#[derive(Debug)]
pub(super) struct Diffusing {
    maturing: ThresholdFokkerPlanck,
    potential: Potential,
    levels: [MovingGrid; LEVELS],
    temperature: Option<Temperature>,
    stiffness: Stiffness,
    /// Fresh contacts where they re-form, in the order of their stretches.
    fresh: Vec<ThresholdMasses>,
    /// The shortest time in which fresh thresholds change much.
    time: f64,
    /// Longest coarse step of a cohort, as a fraction of its age (plus that time).
    age_fraction: f64,
    /// Largest stretching in a coarse step.
    reach: f64,
}

/// Number of levels: coarse and fine.
const LEVELS: usize = 2;

/// The masses of a cohort in the cells of each level, as fractions of its contacts, above a stretch.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ThresholdMasses {
    stretch: f64,
    levels: [Vec<f64>; LEVELS],
}

/// Surviving contacts: their number, the number that breaks thermally per time, and the stiffness of the
/// latter.
#[derive(Debug, Clone, Copy, Default)]
struct StandingContacts {
    count: f64,
    heated: f64,
    stiffness: f64,
}

impl StandingContacts {
    /// The stiffness of contacts that broke between this state and `after`; those that did not break
    /// thermally reached their threshold at `stretch`.
    fn broken(&self, after: &Self, time: f64, stretch: f64) -> f64 {
        let by_heat = 0.5 * time * (self.heated + after.heated);
        0.5 * time * (self.stiffness + after.stiffness) + (self.count - after.count - by_heat) * stretch
    }
}

/// A motion of a cohort at one velocity, on one side of the lowest threshold.
#[derive(Debug, Clone, Copy)]
struct PathSegment {
    /// Stretches at both ends.
    from: f64,
    to: f64,
    duration: f64,
}

impl PathSegment {
    /// The k-th of `parts` equal parts.
    fn part(&self, k: u32, parts: u32) -> Self {
        let at = |k: u32| self.from + (self.to - self.from) * f64::from(k) / f64::from(parts);
        Self { from: at(k), to: at(k + 1), duration: self.duration / f64::from(parts) }
    }

    /// The first of `parts` equal parts, and the rest.
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

/// Coarse cells per width of the narrower distribution, if they were equal, for a tolerance of 1.
const CELLS: f64 = 0.6;

/// Width of the lowest cell relative to equal ones: it resolves the neighbourhood of the stretch for fast
/// contacts.
const FINEST: f64 = 0.05;

/// Longest coarse step as a fraction of the age, and largest stretching in it in units of the width of the
/// narrower distribution; both times the fourth root of the tolerance.
const SHARE: f64 = 2.0;
const REACH: f64 = 4.0;

/// Largest number of cells of a step between two checks whether the monitor has stopped.
const MANY: usize = 1 << 16;

/// Numbers for each cell in the work space of a step.
const WORKSPACE: usize = 8;

/// Smallest number of cells.
const FEWEST: f64 = 16.0;

/// Largest number of coarse cells, enough for thresholds of c.v. 1e-3 at the default tolerance. Of those of c.v. 1e-4, which need
/// more, a minute moves a slider by less than a thousandth of its way.
const MOST: f64 = 1e5;

impl ThresholdMasses {
    /// Bytes of the masses.
    pub(super) fn bytes(&self) -> u64 {
        self.levels.iter().map(|masses| size_of_val(masses.as_slice()) as u64).sum()
    }
}

impl Diffusing {
    /// Thresholds of these contacts, which re-form at the `seeds`; `scale` is the width of the narrowest law of theirs.
    /// `None` where they do not diffuse.
    ///
    /// # Errors
    /// More memory than the monitor allows; stopped by it.
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
        let cells = (CELLS * (high - low) / (scale * coarser)).ceil().max(FEWEST);
        if cells > MOST {
            let least = CELLS * (high - low) / (MOST * coarser);
            let expected = format!(
                "a width of at least {least:.2e} where thresholds diffuse from {low:.3} to {high:.3} and are followed in time: \
                 wider ones, or a larger tolerance"
            );
            return Err(Error::invalid("thresholds", expected, format!("{scale:.2e}")));
        }
        // Both levels, each with its faces, the masses of new contacts, and work space for steps.
        let needed = 3.0 * cells * ((2 + seeds.len() + WORKSPACE) * size_of::<f64>()) as f64;
        let what = format!("{cells} cells for thresholds that diffuse from {low} to {high}");
        fits("tolerance", what, needed as u64, monitor.memory())?;
        let cells = cells as usize;
        let mut diffusing = Self {
            potential: maturing.potential(),
            levels: [1, 2].map(|fine| MovingGrid::new(cells * fine, FINEST)),
            temperature: contacts.rules.temperature,
            stiffness: contacts.stiffness.clone(),
            time: scale * scale / maturing.diffusion,
            age_fraction: (SHARE * coarser).min(0.5),
            reach: REACH * coarser * scale,
            fresh: Vec::new(),
            maturing,
        };
        let watch = Watch::new(monitor);
        diffusing.fresh = seeds.iter().map(|seed| diffusing.above(seed.stretch, &watch)).collect();
        watch.check()?;
        sort_by_number(&mut diffusing.fresh, |item| item.stretch);
        Ok(Some(diffusing))
    }

    /// Amount of work of a step of a cohort: cells in both its halves.
    pub(super) fn cells(&self) -> usize {
        let numbers = |(level, cells): (usize, &MovingGrid)| (cells.cells() << level) * 2;
        self.levels.iter().enumerate().map(numbers).sum()
    }

    /// Whether there is one mass for each cell of each level.
    pub(super) fn fits(&self, masses: &ThresholdMasses) -> bool {
        self.levels.iter().zip(&masses.levels).all(|(level, masses)| level.cells() == masses.len())
    }

    /// P_ci above the stretch of a seed.
    pub(super) fn fresh(&self, seed: &Seed, watch: &Watch<'_>) -> ThresholdMasses {
        let found = self.fresh.binary_search_by(|masses| masses.stretch.total_cmp(&seed.stretch));
        found.map_or_else(|_| self.above(seed.stretch, watch), |place| self.fresh[place].clone())
    }

    /// P_ci above a stretch.
    fn above(&self, stretch: f64, watch: &Watch<'_>) -> ThresholdMasses {
        let (floor, ceiling) = (self.floor(stretch), self.maturing.support.1);
        let age_fraction = |level: &MovingGrid| {
            let middles: Vec<f64> = level.middles(floor, ceiling).collect();
            let mut masses = self
                .maturing
                .fresh(&middles, stretch.abs(), &mut &*watch)
                .unwrap_or_else(|_| vec![0.0; middles.len()]);
            let whole: f64 = masses.iter().sum();
            // Both levels start with the mass 1, so that extrapolation does not change it.
            masses.iter_mut().for_each(|mass| *mass /= whole);
            masses
        };
        ThresholdMasses { stretch, levels: self.levels.each_ref().map(age_fraction) }
    }

    fn floor(&self, stretch: f64) -> f64 {
        stretch.abs().max(self.maturing.support.0)
    }

    /// How far apart the stretches are at which the contacts of two cohorts break: as far as the stretches now, and as the
    /// distributions of their thresholds above them.
    pub(super) fn distance(
        &self,
        (first, at): (&ThresholdMasses, Place),
        (second, then): (&ThresholdMasses, Place),
    ) -> f64 {
        let fine = LEVELS - 1;
        let apart = self.levels[fine].wasserstein_distance(&first.levels[fine], &second.levels[fine]);
        let length = self.maturing.support.1 - self.floor(at.stretch);
        (at.stretch - then.stretch).abs() + length * apart
    }

    /// The thresholds of two cohorts of these masses as one, `part` of whose attached contacts are of the second. Both move
    /// with their cells to the mean stretch, in opposite directions.
    pub(super) fn merged(
        first: (&ThresholdMasses, f64),
        second: (&ThresholdMasses, f64),
        part: f64,
    ) -> ThresholdMasses {
        let (one, two) = (first.0, second.0);
        let more = second.1 / (first.1 + second.1);
        let mean = |level: usize| {
            let cells = one.levels[level].iter().zip(&two.levels[level]);
            cells.map(|(one, two)| one + more * (two - one)).collect()
        };
        ThresholdMasses {
            stretch: one.stretch + part * (two.stretch - one.stretch),
            levels: std::array::from_fn(mean),
        }
    }

    /// Advances in time, in steps that grow with the age. Returns the stiffness that surviving contacts gain
    /// by diffusion of their thresholds.
    pub(super) fn advance(
        &self,
        place: Place,
        masses: &mut ThresholdMasses,
        path: &Path,
        part: StepPart,
        context: &mut StepContext<'_, '_>,
    ) -> f64 {
        let stiffness = self.measure(masses).1;
        let mut broken = [0.0; LEVELS];
        let mut age = place.age;
        for segment in self.segments(place, path, part) {
            let mut left = Some(segment);
            while let Some(segment) = left {
                // The distribution of thresholds changes fast just after formation and ever more
                // slowly later, like √t in diffusion: steps in proportion to the age resolve all of
                // it in a logarithmic number.
                let (step, rest) = segment.split(self.steps(&segment, age));
                // Both levels make the same coarse step; the fine one halves it, for the extrapolation.
                for (level, broken) in broken.iter_mut().enumerate() {
                    let parts = 1 << level;
                    let part = |k| {
                        let stops = self.levels[level].cells() > MANY && context.watch.stops();
                        if stops {
                            0.0
                        } else {
                            self.step(&step.part(k, parts), level, masses, &mut context.room)
                        }
                    };
                    *broken += (0..parts).map(part).sum::<f64>();
                }
                if context.watch.stops() {
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

    /// The motion, divided where the stretch reaches the lowest threshold.
    fn segments(&self, place: Place, path: &Path, part: StepPart) -> Vec<PathSegment> {
        let low = self.maturing.support.0;
        let (from, to) = part.ends();
        let (start, by, time) = (place.stretch, path.advance(from, to), path.time(part));
        // At the lowest threshold the boundary condition changes from reflecting to absorbing.
        let meets = |threshold: f64| (threshold - start) / by;
        let mut ends: Vec<f64> = [-low, low].map(meets).into_iter().filter(|&s| s > 0.0 && s < 1.0).collect();
        ends.extend([0.0, 1.0]);
        ends.sort_by(f64::total_cmp);
        let segment = |ends: &[f64]| PathSegment {
            from: start + by * ends[0],
            to: start + by * ends[1],
            duration: time * (ends[1] - ends[0]),
        };
        ends.windows(2).map(segment).collect()
    }

    /// Number of coarse steps for a segment at an age.
    fn steps(&self, segment: &PathSegment, age: f64) -> f64 {
        let longest = self.age_fraction * (self.time + age);
        (segment.duration / longest).max((segment.to - segment.from).abs() / self.reach)
    }

    /// A step of one level; returns the stiffness of the contacts that break.
    fn step(
        &self,
        segment: &PathSegment,
        level: usize,
        masses: &mut ThresholdMasses,
        room: &mut Workspace,
    ) -> f64 {
        let (low, ceiling) = self.maturing.support;
        let (cells, masses) = (&self.levels[level], &mut masses.levels[level]);
        let [start, end] = [segment.from, segment.to].map(f64::abs);
        let middle = 0.5 * (start + end);
        let before = self.standing(start, cells, masses);
        if end < ceiling {
            let floor = (self.floor(start), self.floor(end));
            let rise =
                MovingBoundary { floor, ceiling, duration: segment.duration, absorbing: middle >= low };
            let heat = self.temperature.map(|temperature| {
                move |h: &Nodal| {
                    vectorised(
                        #[inline(always)]
                        || temperature.rates(&[middle; NODES], h, &self.stiffness),
                    )
                }
            });
            let sink = heat.as_ref().map(|heat| heat as Sink<'_>);
            let medium =
                Coefficients { potential: &self.potential, diffusion: self.maturing.diffusion, sink };
            cells.advance(&rise, &medium, masses, room);
        } else {
            masses.fill(0.0);
        }
        before.broken(&self.standing(end, cells, masses), segment.duration, middle)
    }

    fn is_equal(&self) -> bool {
        self.stiffness.is_equal()
    }

    /// Surviving contacts and their thermal breaking; not computed for equal stiffness, where nothing depends
    /// on it.
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

    /// The surviving fraction, and its stiffness.
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

/// Richardson extrapolation of coarse and fine results: removes the error of second order.
fn extrapolated([coarse, fine]: [f64; LEVELS]) -> f64 {
    fine + (fine - coarse) / 3.0
}
