//! A slider block in time, over time-dependent contacts: they age while it sticks.
//!
//! M Ẍ = K(X_T(t) − X) − F − γẊ, with the drive X_T(t) a [`History`] that begins in balance, X_T = X + F/K. Contacts do
//! not turn back. A slider that would, after it has overshot, comes to rest at X_2 as without inertia on the straight line
//! on which the contacts unload, X = X_2 + [K(X_T − X_2) − F(X_2)]/(K + F'), and moves on when the spring has brought it
//! back to X_2; until then time passes for the contacts at X_2.

mod log;
mod stage;

use super::{Block, EnergyBalance, Loading, Slip};
use crate::history::History;
use crate::monitor::{Aside, Monitor, report};
use crate::numerics::tr_bdf2::{CHANGE, GAMMA, WEIGHTS, change};
use crate::rate_dependent::{ErrorEstimator, RateDependentContacts};
use crate::{Error, Float, Result};
use log::Log;
pub use log::{Moment, Slide, TimedSlip};
use stage::{Dynamics, Pulled, State};

/// The first step, as a share of what it may be.
const FIRST: f64 = 1e-3;

/// Steps below this share of the time are no steps.
const SHORTEST: f64 = 1e-15;

/// Share of the tolerance by which the pull may be short of the friction without a move back.
const SLACK: f64 = 1e-3;

impl Block {
    /// Moves the slider's top along `drive`, from where it is in balance over `contacts`, and sees what its bottom does, at
    /// rising `times` since the start. A step in time is right to `tolerance`, a length.
    ///
    /// # Errors
    /// A loading other than a spring; a rule of slip that does not say how fast a slip is; times that do not rise within
    /// the drive; a tolerance that is not above 0; those of the contacts; stopped by the monitor.
    pub fn follow(
        &self,
        contacts: &dyn RateDependentContacts,
        drive: &History,
        times: &[f64],
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Slide> {
        self.followed(contacts, None, drive, times, tolerance, monitor)
    }

    /// The same with [`Slide::error`], which takes some three times as long: contacts are followed twice more.
    ///
    /// # Errors
    /// Those of [`Block::follow`].
    pub fn follow_with_error(
        &self,
        contacts: &dyn RateDependentContacts,
        drive: &History,
        times: &[f64],
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Slide> {
        self.followed(contacts, ErrorEstimator::of(contacts), drive, times, tolerance, monitor)
    }

    fn followed(
        &self,
        contacts: &dyn RateDependentContacts,
        estimator: Option<ErrorEstimator>,
        drive: &History,
        times: &[f64],
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Slide> {
        let dynamics = self.dynamics(tolerance)?;
        check(times, drive.duration())?;
        let moving = drive.pieces().iter().map(|piece| piece.velocity).find(|velocity| *velocity > 0.0);
        let fraction = self.slip_fraction.unwrap_or(0.0);
        let mut rider = Rider::new(dynamics, contacts, estimator, moving.unwrap_or(f64::INFINITY), fraction);
        if times.first() == Some(&0.0) {
            rider.log.see(rider.moment());
        }
        let mut asked = times.iter().copied().skip_while(|time| *time == 0.0).peekable();
        for (piece, knots) in drive.pieces().iter().zip(drive.knots().windows(2)) {
            rider.pull(piece.velocity);
            while let Some(time) = asked.next_if(|time| *time < knots[1].0) {
                rider.until(time, drive.duration(), monitor)?;
                rider.log.see(rider.moment());
            }
            rider.until(knots[1].0, drive.duration(), monitor)?;
            if asked.next_if_eq(&knots[1].0).is_some() {
                rider.log.see(rider.moment());
            }
        }
        report(monitor, 1.0)?;
        let error = rider.estimator.map(|_| rider.error);
        Ok(rider.log.close(error))
    }

    /// What moves the slider in time.
    fn dynamics(&self, tolerance: f64) -> Result<Dynamics> {
        let Loading::Spring(stiffness) = self.loading else {
            return Err(Error::invalid("stiffness", "a block with a stiffness, to be moved in time", "none"));
        };
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(Error::invalid("tolerance", "a finite length above 0", tolerance));
        }
        let (mass, damping) = self.slip.limits()?;
        Ok(Dynamics { stiffness, mass, damping, tolerance })
    }
}

impl Slip {
    /// Mass and damping, which limit how fast a slip is.
    ///
    /// # Errors
    /// None of them.
    pub fn limits(self) -> Result<(f64, f64)> {
        let refused = |name: &str| {
            let expected = "damped or inertial where contacts are time-dependent: during a slip the velocity must be limited by a damping or a mass";
            Err(Error::invalid("slip", expected, name))
        };
        match self {
            Self::Inertial { mass, damping } => Ok((mass, damping)),
            Self::Damped { damping } => Ok((0.0, damping)),
            Self::Reset => refused("reset"),
            Self::Overdamped => refused("overdamped"),
            Self::Arrest => refused("arrest"),
        }
    }
}

/// Refuses times that do not rise within a drive.
fn check(times: &[f64], end: f64) -> Result<()> {
    let outside = times.iter().find(|&&time| !(time >= 0.0 && time <= end));
    let falling = times.windows(2).find(|pair| pair[1] <= pair[0]).map(|pair| &pair[1]);
    match outside.or(falling) {
        Some(time) => Err(Error::invalid("times", format!("rising times from 0 to {end}"), time)),
        None => Ok(()),
    }
}

/// A slider on its way.
struct Rider {
    dynamics: Dynamics,
    state: State,
    pulled: Pulled,
    time: f64,
    /// How long the next step may be.
    pace: f64,
    /// What came and went that the contacts do not count.
    spent: EnergyBalance,
    log: Log,
    /// What tells the error of the force, and the largest so far.
    estimator: Option<ErrorEstimator>,
    error: f64,
}

impl Rider {
    /// `pulled` is the first velocity of the drive, `fraction` the share of contacts that breaks in the smallest slip.
    fn new(
        dynamics: Dynamics,
        contacts: &dyn RateDependentContacts,
        estimator: Option<ErrorEstimator>,
        pulled: f64,
        fraction: f64,
    ) -> Self {
        let state = State::of(contacts.copy());
        let drive = state.position() + state.force / dynamics.stiffness;
        let at = Pulled { drive, velocity: 0.0 };
        let spent = EnergyBalance::default();
        let start = Moment::of(&dynamics, &state, at, 0.0, spent);
        let log = Log::new(start, pulled, state.contacts.as_ref(), fraction, dynamics.tolerance);
        Self {
            dynamics,
            state,
            pulled: at,
            time: 0.0,
            pace: f64::INFINITY,
            spent,
            log,
            estimator,
            error: 0.0,
        }
    }

    /// From now on the drive has another velocity.
    fn pull(&mut self, velocity: f64) {
        self.pulled.velocity = velocity;
        self.log.pull(velocity);
    }

    fn moment(&self) -> Moment {
        Moment::of(&self.dynamics, &self.state, self.pulled, self.time, self.spent)
    }

    /// Goes on until a time of a whole that lasts `whole`.
    fn until(&mut self, end: f64, whole: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let begin = (self.time, self.pulled.drive);
        while self.time < end {
            let left = end - self.time;
            let aside = &mut Aside { fraction: self.time / whole, monitor };
            let duration = if self.is_held() { self.rest(left, aside)? } else { self.go(left, aside)? };
            self.time = if duration < left { self.time + duration } else { end };
            self.pulled.drive = begin.1 + self.pulled.velocity * (self.time - begin.0);
            self.log.pass(self.moment(), self.is_stopping(), self.state.contacts.as_ref());
        }
        Ok(())
    }

    /// Whether the contacts would pull the slider back.
    fn is_pulled_back(&self) -> bool {
        let slack = SLACK * self.dynamics.tolerance * self.dynamics.resistance(&self.state);
        self.dynamics.excess(&self.state, self.pulled.drive) < -slack
    }

    fn is_held(&self) -> bool {
        self.state.velocity == 0.0 && self.is_pulled_back()
    }

    /// Whether the slider is on its way to an arrest.
    fn is_stopping(&self) -> bool {
        self.state.velocity > 0.0 && self.is_pulled_back()
    }

    /// Rests until the spring pulls, at most for a time; how long.
    fn rest(&mut self, left: f64, monitor: &mut dyn Monitor) -> Result<f64> {
        let Self { dynamics, state, pulled, .. } = self;
        let short = -dynamics.excess(state, pulled.drive);
        let behind = short / dynamics.resistance(state);
        // So that energies by the trapezoidal rule are right.
        let most = (dynamics.tolerance * behind).sqrt();
        let mut duration =
            (short.min(most * dynamics.resistance(state)) / (dynamics.stiffness * pulled.velocity)).min(left);
        loop {
            let mut contacts = state.contacts.copy();
            contacts.step(0.0, duration, monitor)?;
            let rested = State { force: contacts.force(), contacts, ..*state };
            let excess = dynamics.excess(&rested, pulled.after(duration));
            if excess > dynamics.tolerance * dynamics.resistance(&rested) && duration > SHORTEST * left {
                duration *= (short / (short + excess)).max(CHANGE.1);
                continue;
            }
            let moved = (behind + dynamics.back(&rested, pulled.after(duration))).abs();
            if moved > 2.0 * most && duration > SHORTEST * left {
                duration *= (most / moved).max(CHANGE.1);
                continue;
            }
            self.spent += dynamics.at_rest([state, &rested], *pulled, duration);
            if let Some(estimator) = &mut self.estimator {
                self.error = self.error.max(estimator.step(0.0, duration, rested.force, monitor)?);
            }
            self.state = rested;
            return Ok(duration);
        }
    }

    /// Moves on in one step, at most for a time; for how long.
    fn go(&mut self, left: f64, monitor: &mut dyn Monitor) -> Result<f64> {
        let mut duration = self.pace;
        if duration.is_infinite() {
            duration = FIRST * left;
        }
        duration = if duration >= left { left } else { duration.min(0.5 * left) };
        loop {
            if duration < SHORTEST * (self.time + left) {
                let what = format!("a slider in time at t = {}", self.time);
                let wanted = Float(self.dynamics.tolerance);
                return Err(Error::Accuracy { key: String::new(), what, reached: Float(f64::NAN), wanted });
            }
            let Some(tried) = self.dynamics.attempt(&self.state, self.pulled, duration, monitor)? else {
                duration *= CHANGE.1;
                continue;
            };
            let (error, velocity) = (tried.error / self.dynamics.tolerance, tried.end.velocity);
            let factor = change(error);
            let back = self.dynamics.way(&tried.end, -velocity);
            if error > 1.0 {
                duration *= factor.min(0.9);
            } else if back > self.dynamics.tolerance {
                let before = self.state.velocity;
                duration *= (before / (before - velocity)).clamp(CHANGE.1, 0.9);
            } else {
                self.pace =
                    if duration < left { factor * duration } else { self.pace.max(factor * duration) };
                self.accept(tried, duration, monitor)?;
                return Ok(duration);
            }
        }
    }

    fn accept(&mut self, tried: stage::Tried, duration: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let states = [&self.state, &tried.middle, &tried.end];
        if let Some(estimator) = &mut self.estimator {
            for (pair, share) in states.windows(2).zip([GAMMA, 1.0 - GAMMA]) {
                let by = pair[1].position() - pair[0].position();
                self.error = self.error.max(estimator.step(by, share * duration, pair[1].force, monitor)?);
            }
        }
        self.spent += self.dynamics.on_the_way(states, self.pulled, duration);
        self.state = tried.end;
        if self.state.velocity > 0.0 {
            return Ok(());
        }
        self.state.velocity = 0.0;
        let excess = self.dynamics.excess(&self.state, self.pulled.after(duration)).min(0.0);
        self.spent.slip += 0.5 * excess * excess / self.dynamics.resistance(&self.state);
        Ok(())
    }
}

impl Dynamics {
    /// What comes and goes in a step that is right to second order.
    fn on_the_way(&self, states: [&State; 3], pulled: Pulled, duration: f64) -> EnergyBalance {
        let mut energy = EnergyBalance::default();
        let times = [0.0, GAMMA * duration, duration];
        for ((state, time), weight) in states.into_iter().zip(times).zip(WEIGHTS) {
            let pull = self.stiffness * (pulled.after(time) - state.position());
            energy.work += weight * duration * pulled.velocity * pull;
            energy.viscous += weight * duration * self.damping * state.velocity * state.velocity;
        }
        energy
    }

    /// The same of a slider at rest, by the trapezoidal rule. The contacts count their breaks at the stretches of X_2;
    /// what the slider rests behind it changes those energies by b ΔF + ½b² ΔF'.
    fn at_rest(&self, states: [&State; 2], pulled: Pulled, duration: f64) -> EnergyBalance {
        let [before, after] = states;
        let drives = [pulled.drive, pulled.after(duration)];
        let [from, to] = [0, 1].map(|i| self.back(states[i], drives[i]));
        let pull = |i: usize, back: f64| self.stiffness * (drives[i] - states[i].position() - back);
        let force = after.force - before.force;
        let tangent = after.contacts.tangent() - before.contacts.tangent();
        EnergyBalance {
            work: pulled.velocity * duration * 0.5 * (pull(0, from) + pull(1, to)),
            breaks: -0.5 * ((from + to) * force + 0.5 * (from * from + to * to) * tangent),
            ..EnergyBalance::default()
        }
    }
}
