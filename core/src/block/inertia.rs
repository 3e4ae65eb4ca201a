//! The inertial slip: a swing in time, from the loss of balance to the first arrest.
//!
//! MẌ = K(X_T − X) − F(X) − γẊ with X_T held. At a smooth instability X_1 the net force and its derivative vanish,
//! so that a slider at rest there would stay for ever; the drive, however slow, pushes it past, and the motion is
//! the one that leaves X_1 with no energy but what it gains. It is followed from where the work done on it since
//! X_1 is 1e-14 of the elastic energy: no speed that it may have there changes its energy by more.

use super::quasistatic::QuasistaticRun;
use super::trace::Point;
use crate::numerics::motion::{Body, MotionStep, uniform};
use crate::numerics::roots::brent_root;
use crate::population::Direction;
use crate::{Error, Float, Result};

/// Work, of the elastic energy of the contacts, at which the motion is first followed.
const UNSEEN: f64 = 1e-14;

/// Error of the speed in a step, of the one that the elastic energy of the contacts would give the slider, or that
/// its damping would let the pull have: at lower speeds it matters less, and rounding of the forces shows.
const ACCURACY: f64 = 1e-12;

/// A distance from the balance, of the way gone, at which a damped motion is at its end: the energy left is 1e-18.
const SETTLED: f64 = 1e-9;

/// Halvings of a step before it is given up.
const MOST_HALVINGS: u32 = 60;

/// How a swing ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Swung {
    /// At rest.
    Arrested,
    /// Where it began: the slider is not pushed by more than rounding.
    Still,
    /// Nowhere.
    Away,
}

/// How a step ends.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Ending {
    /// On the way.
    Under,
    /// At the end of the way.
    Through,
    /// At rest.
    Arrested,
}

/// The state of a swing on the way ahead.
struct Swing {
    body: Body,
    drive: f64,
    /// Since it was first followed.
    time: f64,
    /// The advance on the way ahead.
    place: f64,
    speed: f64,
    /// Of the last step.
    step: f64,
    /// Elastic energy of the contacts when balance was lost.
    energy: f64,
    /// The error of a speed.
    accuracy: f64,
    start: f64,
}

impl QuasistaticRun<'_> {
    /// Swings to the first arrest.
    pub(super) fn swing(
        &mut self,
        drive: f64,
        direction: Direction,
        mass: f64,
        damping: f64,
    ) -> Result<Swung> {
        self.offered.clear();
        let (energy, pull) = (self.stored_in_contacts(), self.state(drive, 0.0).spring_force.abs());
        let fast = (2.0 * energy / mass).sqrt().min(pull / damping);
        let mut swing = Swing {
            body: Body { mass, damping },
            drive,
            time: 0.0,
            place: 0.0,
            speed: 0.0,
            step: f64::INFINITY,
            energy,
            accuracy: ACCURACY * fast,
            start: self.look.position,
        };
        self.towards(direction)?;
        if !self.leave(&mut swing) {
            return Ok(Swung::Still);
        }
        let arrested = self.follow(&mut swing)?;
        if self.course.is_none() {
            self.offered.push(swing.time, 0.0, self.state(drive, 0.0));
        }
        Ok(if arrested { Swung::Arrested } else { Swung::Away })
    }

    /// Goes through way after way; whether there was an arrest.
    fn follow(&mut self, swing: &mut Swing) -> Result<bool> {
        loop {
            let ending = self.step(swing)?;
            let (sign, settled) = (self.look.sign(), self.is_settled(swing));
            if ending == Ending::Under && !settled {
                continue;
            }
            let breaks = self.look.way.breaks;
            let (loading, drive) = (self.look.loading, swing.drive);
            self.memory.open.work += loading.work_at_rest(drive, sign * swing.place);
            self.look.advance(swing.place)?;
            if ending == Ending::Arrested || settled {
                return Ok(true);
            }
            if self.is_gone(swing.drive) {
                return Ok(false);
            }
            if breaks {
                self.look.cross()?;
            }
            swing.place = 0.0;
            self.towards(self.look.direction)?;
        }
    }

    /// The first place and speed of a motion; `false` where no net force can be told from rounding.
    ///
    /// From a balance, at which the slider is not pushed, they solve (3/2) M v²/u + γ v = g: exact where the net force
    /// g grows as u² and there is either no damping or little else.
    fn leave(&self, swing: &mut Swing) -> bool {
        let excess = |a: f64| self.look.excess(swing.drive, a);
        if excess(0.0) > 0.0 && !self.is_balanced(swing.drive) {
            return true;
        }
        let unseen = UNSEEN * swing.energy;
        let visible = |place: f64| place > f64::EPSILON * self.look.position.abs();
        // Contacts are stretched by twice that, or more.
        let stretch = swing.energy / self.state(swing.drive, 0.0).spring_force.abs();
        let mut place = self.look.way.length.min(self.look.position.abs().max(stretch));
        while visible(place) && !(excess(place) > 0.0 && place * excess(place) < unseen) {
            place *= 0.5;
        }
        let Body { mass, damping } = swing.body;
        let (push, inertia) = (excess(place), 1.5 * mass / place);
        swing.place = place;
        swing.speed = 2.0 * push / (damping + (damping * damping + 4.0 * inertia * push).sqrt());
        visible(place)
    }

    /// Whether what is left of a damped motion cannot be seen.
    fn is_settled(&self, swing: &Swing) -> bool {
        let look = &self.look;
        let resistance = look.loading.resistance(look.response(swing.place).tangent);
        let gone = (look.position + look.sign() * swing.place - swing.start).abs();
        let near = SETTLED * gone;
        resistance > 0.0
            && look.excess(swing.drive, swing.place).abs() <= near * resistance
            && swing.body.mass * swing.speed * swing.speed <= near * near * resistance
    }

    fn step(&mut self, swing: &mut Swing) -> Result<Ending> {
        if self.look.way.straight { Ok(self.straight(swing)) } else { self.curved(swing) }
    }

    /// A step where the force is a straight line.
    fn straight(&mut self, swing: &mut Swing) -> Ending {
        let resistance = self.look.loading.resistance(self.look.here.tangent);
        let excess = self.look.excess(swing.drive, swing.place);
        let left = self.look.way.length - swing.place;
        let passage = swing.body.passage(swing.speed, excess, resistance, left);
        self.memory.open.viscous += swing.body.damping * passage.squared;
        swing.time += passage.time;
        swing.speed = passage.speed;
        let through = passage.way == left;
        swing.place = if through { self.look.way.length } else { swing.place + passage.way };
        self.offer(swing, swing.time, swing.place, swing.speed);
        match (through, swing.speed == 0.0) {
            (true, _) => Ending::Through,
            (_, true) => Ending::Arrested,
            _ => Ending::Under,
        }
    }

    /// A step on a smooth way, cut where the way or the motion ends.
    fn curved(&mut self, swing: &mut Swing) -> Result<Ending> {
        let end = self.look.way.length;
        let begin =
            (self.look.excess(swing.drive, swing.place) - swing.body.damping * swing.speed) / swing.body.mass;
        let mut time = (1.2 * uniform(swing.speed, begin, end - swing.place)).min(4.0 * swing.step);
        for _ in 0..MOST_HALVINGS {
            let Some(step) = self.collocated(swing, time) else {
                time *= 0.5;
                continue;
            };
            let (share, ending) = first_ending(&step, end, swing.accuracy);
            // Landed on what ends it, or nothing does.
            if share < 1.0 {
                time *= share;
                continue;
            }
            swing.step = time;
            self.accept(swing, &step, ending);
            return Ok(ending);
        }
        let what = format!("a slip with inertia at X = {}", self.look.position);
        Err(Error::Accuracy { key: String::new(), what, reached: Float(time), wanted: Float(ACCURACY) })
    }

    /// The step of that duration, if it is accurate. Beyond the way the force goes on as its tangent, for a first
    /// guess of when the end is reached.
    fn collocated(&self, swing: &Swing, time: f64) -> Option<MotionStep> {
        let (look, end) = (&self.look, self.look.way.length);
        let force = |u: f64| {
            let within = u.clamp(0.0, end);
            let resistance = look.loading.resistance(look.response(within).tangent);
            (look.excess(swing.drive, within) - resistance * (u - within), -resistance)
        };
        swing.body.step((swing.place, swing.speed), time, swing.accuracy, force)
    }

    fn accept(&mut self, swing: &mut Swing, step: &MotionStep, ending: Ending) {
        self.memory.open.viscous += swing.body.damping * step.squared();
        for ((time, place), speed) in step.times().into_iter().zip(step.places()).zip(step.speeds()) {
            self.offer(swing, swing.time + time, place, speed);
        }
        let (place, speed) = step.at(1.0);
        swing.time += step.time;
        swing.place = if ending == Ending::Through { self.look.way.length } else { place };
        swing.speed = if ending == Ending::Arrested { 0.0 } else { speed };
    }

    /// Keeps a point of the time course, until there is one of a slip.
    fn offer(&mut self, swing: &Swing, time: f64, place: f64, speed: f64) {
        if self.course.is_none() {
            let state = self.state(swing.drive, place);
            self.offered.offer(time, self.look.sign() * speed, state);
        }
    }

    /// The state at an advance `a` on the way, at a given drive.
    fn state(&self, drive: f64, a: f64) -> Point {
        let position = self.look.position + self.look.sign() * a;
        let force = self.look.response(a.clamp(0.0, self.look.way.length)).force;
        Point { drive, position, force, spring_force: self.look.loading.pull(drive, position, force) }
    }
}

/// How far the end of a way may be missed, of its length.
const MISSED: f64 = 1e-13;

/// Speeds below which a slider is at rest, of the highest in a step.
const STILL: f64 = 1e-10;

/// The share of a step at which it first ends, and how; 1 where that is at its end, to rounding and to the `accuracy`
/// of the speed.
fn first_ending(step: &MotionStep, length: f64, accuracy: f64) -> (f64, Ending) {
    let (share, ending) = first_rest(step, accuracy);
    let farthest = step.at(share).0;
    if (farthest - length).abs() <= MISSED * length {
        return (share, Ending::Through);
    }
    if farthest < length {
        return (share, ending);
    }
    (brent_root(|s| step.at(s).0 - length, 0.0, share, 0.0).unwrap_or(share), Ending::Through)
}

/// The share of a step at which the motion first comes to rest, if it does.
fn first_rest(step: &MotionStep, accuracy: f64) -> (f64, Ending) {
    let (speeds, shares) = (step.speeds(), step.times().map(|time| time / step.time));
    let last = step.at(1.0).1;
    let highest = speeds.iter().fold(step.speed, |most: f64, v| most.max(*v));
    let still = STILL * highest + 2.0 * accuracy;
    let node = speeds.iter().position(|v| *v < -still).map(|i| shares[i]);
    let Some(after) = node.or((last < -still).then_some(1.0)) else {
        return (1.0, if last <= still { Ending::Arrested } else { Ending::Under });
    };
    // A motion that begins at rest is not at its end there.
    let begun = speeds.iter().position(|v| *v > 0.0).map_or(0.0, |i| shares[i]);
    let before = if step.speed > 0.0 { 0.0 } else { begun };
    (brent_root(|s| step.at(s).1, before, after, 0.0).unwrap_or(after), Ending::Arrested)
}
