//! One step of a slider in time, of two stages ([`tr_bdf2`]), so that it may be as long as a stick. Between their ends
//! contacts move at constant velocities.

use crate::Result;
use crate::monitor::Monitor;
use crate::numerics::tr_bdf2::{self, GAMMA, HISTORY};
use crate::rate_dependent::RateDependentContacts;

/// Equations of stages are solved to this share of the tolerance.
const NEAR: f64 = 0.01;

/// Rounds of the secant rule before a step is too long for it.
const ROUNDS: u32 = 12;

/// What moves a slider: M Ẍ = K(X_T − X) − F − γẊ.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dynamics {
    /// K.
    pub stiffness: f64,
    /// M, or 0.
    pub mass: f64,
    /// γ; above 0 where M is 0.
    pub damping: f64,
    /// The length to which a step is right.
    pub tolerance: f64,
}

/// Motion of the drive at one velocity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pulled {
    /// X_T now.
    pub drive: f64,
    /// Its velocity.
    pub velocity: f64,
}

impl Pulled {
    /// X_T after a time.
    pub fn after(&self, time: f64) -> f64 {
        self.drive + self.velocity * time
    }
}

/// A slider and its contacts at one moment.
pub(super) struct State {
    pub contacts: Box<dyn RateDependentContacts>,
    /// F.
    pub force: f64,
    /// Ẋ.
    pub velocity: f64,
    /// dF/dX on the last way, by which the next one is guessed.
    pub slope: f64,
}

/// A step, tried.
pub(super) struct Tried {
    pub middle: State,
    pub end: State,
    /// The estimate of its error, as a length.
    pub error: f64,
}

/// Velocity and acceleration at the end of a stage as functions of its advance δ: Ẋ = αδ + `velocity`,
/// Ẍ = αẊ + `acceleration`.
struct Rule {
    alpha: f64,
    velocity: f64,
    acceleration: f64,
}

impl State {
    pub fn of(contacts: Box<dyn RateDependentContacts>) -> Self {
        let (force, slope) = (contacts.force(), contacts.tangent());
        Self { contacts, force, velocity: 0.0, slope }
    }

    pub fn position(&self) -> f64 {
        self.contacts.position()
    }
}

impl Rule {
    fn velocity(&self, advance: f64) -> f64 {
        self.alpha * advance + self.velocity
    }

    fn acceleration(&self, velocity: f64) -> f64 {
        self.alpha * velocity + self.acceleration
    }
}

impl Dynamics {
    /// K(X_T − X) − F.
    pub fn excess(&self, state: &State, drive: f64) -> f64 {
        self.stiffness * (drive - state.position()) - state.force
    }

    /// How far behind X_2 a slider rests that was arrested there, as a length below 0; 0 where it is not.
    pub fn back(&self, state: &State, drive: f64) -> f64 {
        let excess = self.excess(state, drive);
        if state.velocity == 0.0 && excess < 0.0 { excess / self.resistance(state) } else { 0.0 }
    }

    /// K + F'.
    pub fn resistance(&self, state: &State) -> f64 {
        self.stiffness + state.contacts.tangent()
    }

    /// How far a slider goes on at a velocity until spring and contacts stop it.
    pub fn way(&self, state: &State, velocity: f64) -> f64 {
        let resistance = self.resistance(state);
        velocity * (self.damping + (self.mass * resistance).sqrt()) / resistance
    }

    /// A step of a duration; `None` where its equations find no solution, or one that goes back.
    pub fn attempt(
        &self,
        from: &State,
        pulled: Pulled,
        duration: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Tried>> {
        let alpha = tr_bdf2::alpha(duration);
        let (v0, a0) = (from.velocity, self.acceleration(from, pulled.drive));
        let rule = Rule { alpha, velocity: -v0, acceleration: -alpha * v0 - a0 };
        let time = GAMMA * duration;
        let Some(middle) = self.stage(from, pulled.after(time), time, &rule, monitor)? else {
            return Ok(None);
        };
        let (advance, v1) = (middle.position() - from.position(), middle.velocity);
        let a1 = rule.acceleration(v1);
        let rule = Rule {
            alpha,
            velocity: -alpha * HISTORY * advance,
            acceleration: -alpha * (v1 + HISTORY * (v1 - v0)),
        };
        let time = duration - time;
        let Some(end) = self.stage(&middle, pulled.after(duration), time, &rule, monitor)? else {
            return Ok(None);
        };
        let a2 = rule.acceleration(end.velocity);
        let error = |rates| tr_bdf2::error(duration, rates);
        let of_velocity = if self.mass > 0.0 { error([a0, a1, a2]) } else { 0.0 };
        let swing = (self.mass / self.resistance(from)).sqrt();
        let error = error([v0, v1, end.velocity]).abs().max(swing * of_velocity.abs());
        Ok(Some(Tried { middle, end, error }))
    }

    /// Ẍ, 0 without mass.
    fn acceleration(&self, state: &State, drive: f64) -> f64 {
        if self.mass == 0.0 {
            return 0.0;
        }
        (self.excess(state, drive) - self.damping * state.velocity) / self.mass
    }

    /// The advance at whose end M Ẍ + γẊ + F = K(X_T − X) by the secant rule. An advance that would be below 0 is none,
    /// and comes to rest.
    fn stage(
        &self,
        from: &State,
        drive: f64,
        during: f64,
        rule: &Rule,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<State>> {
        let pull = self.stiffness * (drive - from.position());
        let residual = |advance: f64, force: f64| {
            let velocity = rule.velocity(advance);
            let slider = self.mass * rule.acceleration(velocity) + self.damping * velocity;
            slider + force + self.stiffness * advance - pull
        };
        let own = (self.mass * rule.alpha + self.damping) * rule.alpha + self.stiffness;
        let held = own + from.contacts.tangent();
        let mut slope = if own + from.slope > 0.0 { own + from.slope } else { held };
        let mut advance = (-residual(0.0, from.force) / slope).max(0.0);
        let mut last: Option<(f64, f64)> = None;
        for _ in 0..ROUNDS {
            let mut contacts = from.contacts.copy();
            contacts.step(advance, during, monitor)?;
            let force = contacts.force();
            let off = residual(advance, force);
            if let Some((before, then)) = last {
                let secant = (off - then) / (advance - before);
                slope = if secant > 0.0 { secant } else { held };
            }
            let rests = advance == 0.0 && off >= 0.0;
            if rests || (off / slope).abs() <= NEAR * self.tolerance {
                let velocity = if rests { rule.velocity(0.0).min(0.0) } else { rule.velocity(advance) };
                let moved = advance > self.tolerance * NEAR;
                let slope = if moved { (force - from.force) / advance } else { from.slope };
                return Ok(Some(State { contacts, force, velocity, slope }));
            }
            last = Some((advance, off));
            advance = (advance - off / slope).max(0.0);
        }
        Ok(None)
    }
}
