//! Creep of a slider under a constant force over time-dependent contacts, up to its failure (static fatigue).
//!
//! The slider has no mass and no drag: at every time the force of the contacts is the imposed one, F_c[X(·), t] = F(t), which is
//! raised at a rate and then held. Contacts that break let the slider advance, so that the others carry more. The slider fails
//! where an advance at once no longer raises F_c, ∂F_c/∂X = 0 at fixed t: its velocity −(∂F_c/∂t)/(∂F_c/∂X) diverges. What
//! follows depends on inertia and is not computed.
//!
//! Steps are steps in X, and the balance yields their time: t(X) has a smooth maximum at failure, which steps in X reach. Within
//! a step the velocity is constant. The error of its time is of third order in its length; two steps of half the length show it.
//! Errors are relative to the slip since the force began to rise or was held, so that slow creep over short distances is as
//! accurate as fast creep.
//! A slider that has come to slide steadily keeps its velocity to the end.

mod balance;
mod path;

use crate::error::positive;
use crate::monitor::{Aside, Monitor, report};
use crate::rate_dependent::RateDependentContacts;
use crate::{Error, Result};
use balance::{Balance, CreepBalance, ForceRamp};
pub use path::{CreepPath, CreepState};

/// Allowed error of steps that add up to the slip, in tolerances, so that their sum is proportional to the tolerance.
const STEPS: f64 = 10.0;
/// Allowed error of any step, in tolerances.
const STEP: f64 = 0.1;
/// Allowed error of any step in tolerances and units of length: ten times what changes of forces in short times are uncertain by.
const UNCERTAIN: f64 = 1e-3;
/// Largest difference between the times of the halves of a step, relative to t at its end and in square roots of the tolerance, to
/// which slow velocities are accurate then.
const UNEVEN: f64 = 3.0;
/// First and shortest step, in tolerances and units of length.
const FIRST: f64 = 0.1;
const SHORTEST: f64 = 1e-2;
/// Shortest step that errors ask for, relative to the slip. Shorter ones do not follow contacts that break together better.
const FINEST: f64 = 1e-3;
/// Longest step, in units of length.
const LONGEST: f64 = 0.02;
/// Smallest and largest ratio of a step to the one before.
const RATIO: (f64, f64) = (0.2, 2.0);
/// Ratio of a step to the longest one that its error allows.
const MARGIN: f64 = 0.8;
/// Shortest slip after which a slider may slide steadily, in units of length: contacts have been renewed several times.
const RENEWED: f64 = 10.0;

/// A force on a slider in time: raised from that of the contacts, then constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CreepLoad {
    /// The force F, at least that of the contacts at the start.
    pub force: f64,
    /// Rate at which it is raised, force per time, above 0.
    pub rate: f64,
    /// Time after which the motion ends, from the start, above 0.
    pub duration: f64,
}

/// Accuracy of a creep motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CreepAccuracy {
    /// The unit of lengths, as the mean threshold.
    pub unit: f64,
    /// Error of a step: of X relative to the slip since the force began to rise or was held, at most the unit; or of t relative
    /// to t.
    pub tolerance: f64,
}

impl CreepAccuracy {
    /// The largest error of a step with which errors are estimated from longer steps. Times to failure are then off by about 1e-4
    /// of themselves.
    pub const LARGEST_TOLERANCE: f64 = 1e-5;

    /// The error of a slip, however short: what changes of forces in short times are uncertain by.
    pub fn of_short_slips(&self) -> f64 {
        UNCERTAIN * self.tolerance * self.unit
    }
}

impl CreepLoad {
    /// Moves a slider over a copy of `contacts`, from balance at rest.
    ///
    /// # Errors
    /// A force below that of the contacts; a rate, duration, unit or tolerance that is not above 0; contacts of which free
    /// ones are viscous, as soon as there are any; those of the contacts; stopped by the monitor.
    pub fn follow(
        self,
        contacts: &dyn RateDependentContacts,
        accuracy: CreepAccuracy,
        monitor: &mut dyn Monitor,
    ) -> Result<CreepPath> {
        self.check(contacts, accuracy)?;
        let end = ((self.force - contacts.force()) / self.rate).min(self.duration);
        let mut slider = CreepingSlider::new(contacts, accuracy, self.rate);
        let rise = ForceRamp { time: 0.0, force: contacts.force(), rate: self.rate, end };
        if end > 0.0 && slider.moves_through(rise, self.duration, monitor)? {
            return Ok(slider.path.failed());
        }
        slider.path.loaded = slider.path.states.len() - 1;
        let held = ForceRamp { time: end, force: self.force, rate: 0.0, end: self.duration };
        let fails = end < self.duration && slider.moves_through(held, self.duration, monitor)?;
        report(monitor, 1.0)?;
        Ok(if fails { slider.path.failed() } else { slider.path })
    }

    fn check(self, contacts: &dyn RateDependentContacts, accuracy: CreepAccuracy) -> Result<()> {
        for (name, value) in [
            ("rate", self.rate),
            ("duration", self.duration),
            ("unit", accuracy.unit),
            ("tolerance", accuracy.tolerance),
        ] {
            positive(name, value)?;
        }
        let begun = contacts.force();
        if !(self.force >= begun && self.force.is_finite()) {
            let expected = format!("a finite force of at least {begun}, that of the contacts at the start");
            return Err(Error::invalid("force", expected, self.force));
        }
        Ok(())
    }
}

/// A slider that creeps under a force, step by step.
struct CreepingSlider {
    contacts: Box<dyn RateDependentContacts>,
    accuracy: CreepAccuracy,
    time: f64,
    /// Position at the beginning of the ramp.
    begun: f64,
    /// Length of the next step.
    advance: f64,
    /// Time per displacement in the last step.
    slowness: f64,
    /// Whether the next step is the first one of a ramp, at whose start the velocity jumps.
    begins: bool,
    path: CreepPath,
}

/// Two steps in balance, as (displacement, time), with the contacts after them and the estimated error.
struct CreepStep {
    first: (f64, f64),
    second: (f64, f64),
    contacts: Box<dyn RateDependentContacts>,
    error: f64,
    /// Difference between the two times, relative to t at the end.
    uneven: f64,
}

impl CreepingSlider {
    fn new(contacts: &dyn RateDependentContacts, accuracy: CreepAccuracy, rate: f64) -> Self {
        let slowness = contacts.tangent() / rate;
        let start = CreepState::of(contacts, 0.0, contacts.position(), slowness);
        let path = CreepPath::from(start);
        let (time, begun, advance) = (0.0, contacts.position(), 0.0);
        Self { contacts: contacts.copy(), accuracy, time, begun, advance, slowness, begins: true, path }
    }

    /// Moves to the end of a ramp. Returns whether the slider fails before.
    fn moves_through(&mut self, ramp: ForceRamp, duration: f64, monitor: &mut dyn Monitor) -> Result<bool> {
        self.begins = true;
        self.begun = self.contacts.position();
        self.advance = FIRST * self.accuracy.tolerance * self.accuracy.unit;
        while self.time < ramp.end {
            let fraction = self.time / duration;
            report(monitor, fraction)?;
            if !self.steps(ramp, &mut Aside { fraction, monitor })? {
                return Ok(true);
            }
            // Their drag is in no balance of forces.
            let viscosity = self.contacts.free_friction().viscosity;
            if viscosity > 0.0 {
                return Err(Error::invalid("contacts", "free contacts without viscosity", viscosity));
            }
            if ramp.rate == 0.0 && self.path.is_steady(RENEWED * self.accuracy.unit, self.accuracy.tolerance)
            {
                self.path.slide_steadily(ramp.end);
                return Ok(false);
            }
        }
        Ok(false)
    }

    /// Makes one step. Returns whether there is a balance to step to.
    fn steps(&mut self, ramp: ForceRamp, monitor: &mut dyn Monitor) -> Result<bool> {
        let CreepAccuracy { unit, tolerance } = self.accuracy;
        let slip = self.contacts.position() - self.begun;
        let [shortest, finest] =
            [tolerance, FINEST].map(|share| (share * slip).max(SHORTEST * tolerance * unit));
        let mut grow = RATIO.1;
        loop {
            let Some(step) = self.attempt(ramp, monitor)? else {
                if self.advance <= shortest {
                    return Ok(false);
                }
                (self.advance, grow) = (0.5 * self.advance, 1.0);
                continue;
            };
            let excess = self.excess(&step);
            let ratio = (MARGIN / excess.sqrt()).clamp(RATIO.0, grow);
            let accepted = excess <= 1.0 || self.advance <= finest;
            // A step that meets the failure may be shorter than the finest.
            let least = finest.min(self.advance);
            self.advance = (ratio * self.advance).clamp(least, LONGEST * unit);
            if accepted {
                self.accept(step, ramp);
                return Ok(true);
            }
        }
    }

    /// One step and two of half the length; `None` where there is no balance at the end of each.
    fn attempt(&self, ramp: ForceRamp, monitor: &mut dyn Monitor) -> Result<Option<CreepStep>> {
        let by = self.advance;
        let mut balance = CreepBalance { ramp, accuracy: self.accuracy, scale: self.scale(), monitor };
        let whole = match balance.after(self.contacts.as_ref(), self.time, by, self.slowness)? {
            Balance::Found { duration, .. } => duration,
            Balance::Later => return self.last(&mut balance),
            Balance::Lost => return Ok(None),
        };
        let half = 0.5 * by;
        let (first, contacts) = match balance.after(self.contacts.as_ref(), self.time, half, whole / by)? {
            Balance::Found { duration, contacts } => (duration, contacts),
            Balance::Later => return self.last(&mut balance),
            Balance::Lost => return Ok(None),
        };
        match balance.after(contacts.as_ref(), self.time + first, half, whole / by)? {
            Balance::Found { duration, contacts } => {
                let error =
                    self.relative((first + duration - whole).abs(), first + duration, duration / half);
                let (first, second) = ((half, first), (half, duration));
                Ok(Some(CreepStep { first, second, contacts, error, uneven: self.uneven(first, second) }))
            }
            Balance::Later => self.last(&mut balance),
            Balance::Lost => Ok(None),
        }
    }

    /// Ratio of the error of a step, or of what the velocity changes by in it, to what is allowed.
    fn excess(&self, step: &CreepStep) -> f64 {
        let (tolerance, uncertain) = (self.accuracy.tolerance, self.accuracy.of_short_slips());
        let error = tolerance * (STEP + STEPS * self.advance / self.scale()) + uncertain / self.scale();
        let uneven = UNEVEN * tolerance.sqrt() + uncertain / (0.5 * self.advance);
        (step.error / error).max(step.uneven / uneven)
    }

    /// The length to which errors are relative: the slip since the beginning of the ramp, after the next step.
    fn scale(&self) -> f64 {
        (self.contacts.position() - self.begun + self.advance).min(self.accuracy.unit)
    }

    /// An error of a time as a relative one: of X where the slider is slow, of t where it is fast.
    fn relative(&self, error: f64, duration: f64, slowness: f64) -> f64 {
        error / (slowness * self.scale() + self.time + duration)
    }

    /// What the time of a step changes by from one of its parts to the other, relative to t at the end.
    fn uneven(&self, first: (f64, f64), second: (f64, f64)) -> f64 {
        if first.0 == 0.0 || second.0 == 0.0 {
            return 0.0;
        }
        let change = 0.5 * (first.0 + second.0) * (second.1 / second.0 - first.1 / first.0);
        change.abs() / (self.time + first.1 + second.1)
    }

    /// The step to the end of the ramp, at most as long as the next step.
    fn last(&self, balance: &mut CreepBalance<'_>) -> Result<Option<CreepStep>> {
        let left = balance.ramp.end - self.time;
        let (whole, at_end) = balance.at_end(self.contacts.as_ref(), self.advance, left)?;
        let half = 0.5 * whole;
        let found = match whole {
            0.0 => Balance::Later,
            _ => balance.after(self.contacts.as_ref(), self.time, half, left / whole)?,
        };
        let Balance::Found { duration, contacts } = found else {
            // At rest within the tolerance.
            return Ok((whole <= self.accuracy.tolerance * self.accuracy.unit).then_some(CreepStep {
                first: (0.0, 0.0),
                second: (whole, left),
                contacts: at_end,
                error: 0.0,
                uneven: 0.0,
            }));
        };
        let (rest, contacts) = balance.at_end(contacts.as_ref(), self.advance, left - duration)?;
        let error = (half + rest - whole).abs() / self.scale();
        let (first, second) = ((half, duration), (rest, left - duration));
        Ok(Some(CreepStep { first, second, contacts, error, uneven: self.uneven(first, second) }))
    }

    fn accept(&mut self, step: CreepStep, ramp: ForceRamp) {
        let CreepStep { first, second, mut contacts, .. } = step;
        contacts.settle();
        let [before, after] = [first, second].map(|(by, duration)| duration / by);
        let share = second.0 / (first.0 + second.0);
        let end = if self.time + first.1 + second.1 >= ramp.end {
            ramp.end
        } else {
            self.time + first.1 + second.1
        };
        let position = self.contacts.position() + first.0;
        if first.0 > 0.0 && second.0 > 0.0 {
            // Derivatives of the parabola t(X) through the three states.
            if std::mem::take(&mut self.begins)
                && let Some(start) = self.path.states.last_mut()
            {
                start.slowness = before - (1.0 - share) * (after - before);
            }
            let middle = before + (1.0 - share) * (after - before);
            let state = CreepState::of(self.contacts.as_ref(), self.time + first.1, position, middle);
            self.path.states.push(state);
            let last = after + share * (after - before);
            self.path.states.push(CreepState::of(contacts.as_ref(), end, contacts.position(), last));
        } else {
            self.path.states.push(CreepState::of(contacts.as_ref(), end, contacts.position(), after));
        }
        // Contacts at rest leave the last known velocity.
        self.slowness = if after.is_finite() { after } else { self.slowness };
        (self.time, self.contacts) = (end, contacts);
    }
}
