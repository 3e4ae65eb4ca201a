//! The inertial slip: motion in time from the loss of stability to the first arrest.
//!
//! MẌ = K(X_T − X) − F(X) − γẊ at fixed X_T. At a smooth instability X_1 the net force and its derivative vanish, so that a
//! slider at rest there would stay for ever. An arbitrarily slow drive pushes it beyond X_1, and the slip is the motion that
//! leaves X_1 with zero energy. The integration starts where the work done since X_1 is 1e-14 of the elastic energy, which
//! bounds the error of the energy by the initial speed.

use super::quasistatic::QuasistaticRun;
use super::trace::Point;
use crate::numerics::motion::{Body, MotionStep, uniform};
use crate::numerics::roots::brent_root;
use crate::population::Direction;
use crate::{Error, Float, Result};

/// Work at which the integration starts, relative to the elastic energy of the contacts.
const UNSEEN: f64 = 1e-14;

/// Error of the speed in a step, relative to the speed from all elastic energy of the contacts, or to the speed at which
/// damping balances the force of the spring, if that is smaller.
const ACCURACY: f64 = 1e-12;

/// Distance from equilibrium at which a damped motion ends, relative to its displacement. The remaining energy is 1e-18.
const SETTLED: f64 = 1e-9;

/// Largest number of halvings of a step.
const MOST_HALVINGS: u32 = 60;

/// The end of a swing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SwingEnd {
    /// The slider is at rest.
    Arrested,
    /// The net force is zero within rounding; nothing has moved.
    Still,
    /// The slider has run away.
    Away,
}

/// The end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
enum StepEnd {
    /// Inside the interval, in motion.
    Under,
    /// At the end of the interval.
    Through,
    /// At rest.
    Arrested,
}

/// The state of a swing on the interval ahead.
struct Swing {
    body: Body,
    drive: f64,
    /// Time since the start of the integration.
    time: f64,
    /// Advance on the interval ahead.
    place: f64,
    speed: f64,
    /// Duration of the last step.
    step: f64,
    /// Elastic energy of the contacts at the loss of stability.
    energy: f64,
    /// Largest error of a speed.
    accuracy: f64,
    start: f64,
}

impl QuasistaticRun<'_> {
    /// Integrates the motion to the first arrest.
    pub(super) fn swing(
        &mut self,
        drive: f64,
        direction: Direction,
        mass: f64,
        damping: f64,
    ) -> Result<SwingEnd> {
        self.offered.clear();
        let (energy, pull) =
            (self.stored_in_contacts(), self.path.spring_force(drive, 0.0) - self.path.shift());
        // The speed from all elastic energy, or the terminal speed under the force of the spring.
        let fast = (2.0 * energy / mass).sqrt().min(pull.abs() / damping);
        let mut swing = Swing {
            body: Body { mass, damping },
            drive,
            time: 0.0,
            place: 0.0,
            speed: 0.0,
            step: f64::INFINITY,
            energy,
            accuracy: ACCURACY * fast,
            start: self.path.position,
        };
        self.find_interval(direction)?;
        if !self.leave(&mut swing) {
            return Ok(SwingEnd::Still);
        }
        let arrested = self.follow(&mut swing)?;
        if self.course.is_none() {
            self.offered.push(swing.time, 0.0, self.state(drive, 0.0));
        }
        Ok(if arrested { SwingEnd::Arrested } else { SwingEnd::Away })
    }

    /// Moves through one interval after the other. Returns whether the slider came to rest.
    fn follow(&mut self, swing: &mut Swing) -> Result<bool> {
        /// Steps after which the monitor is asked.
        const ASK: u32 = 1024;
        let mut steps: u32 = 0;
        loop {
            steps = steps.wrapping_add(1);
            if steps.is_multiple_of(ASK) {
                self.path.report_progress(0.0)?;
            }
            let ending = self.step(swing)?;
            let (sign, settled) = (self.path.sign(), self.is_settled(swing));
            if ending == StepEnd::Under && !settled {
                continue;
            }
            let breaks = self.path.interval.breaks;
            let (loading, drive) = (self.path.loading, swing.drive);
            self.memory.open.work += loading.work_at_rest(drive, sign * swing.place);
            self.move_by(swing.place)?;
            if ending == StepEnd::Arrested || settled {
                return Ok(true);
            }
            if self.has_run_away(swing.drive) {
                return Ok(false);
            }
            if breaks {
                self.path.cross()?;
            }
            swing.place = 0.0;
            self.find_interval(self.path.direction)?;
        }
    }

    /// Sets the initial advance u and speed v of the motion; `false` if the net force is zero within rounding.
    ///
    /// From an equilibrium they solve (3/2) M v²/u + γ v = g. This is exact for a net force g ∝ u², without damping or
    /// without inertia.
    fn leave(&self, swing: &mut Swing) -> bool {
        let excess = |a: f64| self.path.excess(swing.drive, a);
        if excess(0.0) > 0.0 && !self.is_balanced(swing.drive) {
            return true;
        }
        let unseen = UNSEEN * swing.energy;
        let visible = |place: f64| place > f64::EPSILON * self.path.position.abs();
        // Contacts are stretched by at least twice this length, energy over force.
        let pull = self.path.spring_force(swing.drive, 0.0) - self.path.shift();
        let stretch = swing.energy / pull.abs();
        let mut place = self.path.interval.length.min(self.path.position.abs().max(stretch));
        // Halved until the net force is forward and its work below the limit.
        while visible(place) && !(excess(place) > 0.0 && place * excess(place) < unseen) {
            place *= 0.5;
        }
        let Body { mass, damping } = swing.body;
        // Energy balance of the motion from X_1 for a net force g ∝ u²: ½Mv² = ∫g du = gu/3, and
        // with damping alone γv = g.
        let (push, inertia) = (excess(place), 1.5 * mass / place);
        swing.place = place;
        // The positive root of the quadratic equation, in the form without cancellation.
        swing.speed = 2.0 * push / (damping + (damping * damping + 4.0 * inertia * push).sqrt());
        visible(place)
    }

    /// Whether a damped motion is within [`SETTLED`] of its equilibrium, in position and in speed.
    fn is_settled(&self, swing: &Swing) -> bool {
        let path = &self.path;
        let resistance = path.loading.resistance(path.response(swing.place).tangent);
        let gone = (path.position + path.sign() * swing.place - swing.start).abs();
        let near = SETTLED * gone;
        resistance > 0.0
            && path.excess(swing.drive, swing.place).abs() <= near * resistance
            && swing.body.mass * swing.speed * swing.speed <= near * near * resistance
    }

    fn step(&mut self, swing: &mut Swing) -> Result<StepEnd> {
        if self.path.interval.straight { Ok(self.straight(swing)) } else { self.curved(swing) }
    }

    /// A step on an interval where the force is linear, with the closed-form solution.
    fn straight(&mut self, swing: &mut Swing) -> StepEnd {
        let resistance = self.path.loading.resistance(self.path.here.tangent);
        let excess = self.path.excess(swing.drive, swing.place);
        let left = self.path.interval.length - swing.place;
        // The closed form of a damped oscillator, to the end of the interval or to rest.
        let passage = swing.body.passage(swing.speed, excess, resistance, left);
        self.memory.open.viscous += swing.body.damping * passage.squared;
        swing.time += passage.time;
        swing.speed = passage.speed;
        let through = passage.distance == left;
        swing.place = if through { self.path.interval.length } else { swing.place + passage.distance };
        self.offer(swing, swing.time, swing.place, swing.speed);
        match (through, swing.speed == 0.0) {
            (true, _) => StepEnd::Through,
            (_, true) => StepEnd::Arrested,
            _ => StepEnd::Under,
        }
    }

    /// A step on a smooth interval, shortened to end with the interval or with the motion.
    fn curved(&mut self, swing: &mut Swing) -> Result<StepEnd> {
        let end = self.path.interval.length;
        let begin =
            (self.path.excess(swing.drive, swing.place) - swing.body.damping * swing.speed) / swing.body.mass;
        // Somewhat longer than uniformly accelerated motion takes to the end of the interval, which then lies
        // inside the step.
        let mut time = (1.2 * uniform(swing.speed, begin, end - swing.place)).min(4.0 * swing.step);
        for _ in 0..MOST_HALVINGS {
            let Some(step) = self.collocated(swing, time) else {
                time *= 0.5;
                continue;
            };
            let (fraction, ending) = first_ending(&step, end, swing.accuracy);
            // The step is repeated with the shorter time until the event that ends it is at its end.
            if fraction < 1.0 {
                time *= fraction;
                continue;
            }
            swing.step = time;
            self.accept(swing, &step, ending);
            return Ok(ending);
        }
        let what = format!("a slip with inertia at X = {}", self.path.position);
        Err(Error::StepTooShort { what, time: Float(swing.time), tolerance: Float(ACCURACY) })
    }

    /// The step of duration `time`; `None` if it is not accurate. Beyond the interval the force is continued along its
    /// tangent, which gives a first guess of the time at its end.
    fn collocated(&self, swing: &Swing, time: f64) -> Option<MotionStep> {
        let (path, end) = (&self.path, self.path.interval.length);
        let force = |u: f64| {
            let within = u.clamp(0.0, end);
            let resistance = path.loading.resistance(path.response(within).tangent);
            (path.excess(swing.drive, within) - resistance * (u - within), -resistance)
        };
        swing.body.step((swing.place, swing.speed), time, swing.accuracy, force)
    }

    fn accept(&mut self, swing: &mut Swing, step: &MotionStep, ending: StepEnd) {
        self.memory.open.viscous += swing.body.damping * step.squared();
        for ((time, place), speed) in step.times().into_iter().zip(step.places()).zip(step.speeds()) {
            self.offer(swing, swing.time + time, place, speed);
        }
        // An event at the end of a step has its exact value there; otherwise rounding could put the
        // slider just before the end of the interval, with a next step of no length.
        let (place, speed) = step.at(1.0);
        swing.time += step.time;
        swing.place = if ending == StepEnd::Through { self.path.interval.length } else { place };
        swing.speed = if ending == StepEnd::Arrested { 0.0 } else { speed };
    }

    /// Adds a point to the time course, as long as no slip has been recorded.
    fn offer(&mut self, swing: &Swing, time: f64, place: f64, speed: f64) {
        if self.course.is_none() {
            let state = self.state(swing.drive, place);
            self.offered.offer(time, self.path.sign() * speed, state);
        }
    }

    /// The state after an advance `a`, at a fixed drive.
    fn state(&self, drive: f64, a: f64) -> Point {
        let position = self.path.position + self.path.sign() * a;
        let force = self.path.friction(a.clamp(0.0, self.path.interval.length));
        let spring_force =
            self.path.loading.pull(drive, position, force - self.path.shift()) + self.path.shift();
        Point { drive, position, force, spring_force }
    }
}

/// Distance from the end of an interval that counts as the end, relative to its length.
const MISSED: f64 = 1e-13;

/// Speed below which a slider is at rest, relative to the highest speed in a step.
const STILL: f64 = 1e-10;

/// The fraction of a step at which it first ends, and how; 1 if that is the end of the step, within rounding and the
/// `accuracy` of the speed.
fn first_ending(step: &MotionStep, length: f64, accuracy: f64) -> (f64, StepEnd) {
    let (fraction, ending) = first_rest(step, accuracy);
    let farthest = step.at(fraction).0;
    if (farthest - length).abs() <= MISSED * length {
        return (fraction, StepEnd::Through);
    }
    if farthest < length {
        return (fraction, ending);
    }
    (brent_root(|s| step.at(s).0 - length, 0.0, fraction, 0.0).unwrap_or(fraction), StepEnd::Through)
}

/// The fraction of a step at which the motion first comes to rest; 1 if it does not.
fn first_rest(step: &MotionStep, accuracy: f64) -> (f64, StepEnd) {
    let (speeds, fractions) = (step.speeds(), step.times().map(|time| time / step.time));
    let last = step.at(1.0).1;
    let highest = speeds.iter().fold(step.speed, |most: f64, v| most.max(*v));
    // A speed is known to its accuracy only: smaller negative ones are no turn.
    let still = STILL * highest + 2.0 * accuracy;
    let node = speeds.iter().position(|v| *v < -still).map(|i| fractions[i]);
    let Some(after) = node.or((last < -still).then_some(1.0)) else {
        return (1.0, if last <= still { StepEnd::Arrested } else { StepEnd::Under });
    };
    // The rest at the beginning of a motion is not its end.
    let begun = speeds.iter().position(|v| *v > 0.0).map_or(0.0, |i| fractions[i]);
    let before = if step.speed > 0.0 { 0.0 } else { begun };
    (brent_root(|s| step.at(s).1, before, after, 0.0).unwrap_or(after), StepEnd::Arrested)
}
