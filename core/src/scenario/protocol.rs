//! `[[protocol]]`: the motion of the slider in time, in steps of constant velocity, ramps and holds.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{TaskStart, not_negative, positive, size};
use crate::history::{History, LoadedHistory, Piece};
use crate::{Error, Result};

/// Successive steps, from X = 0 (with a block or an interface, from its equilibrium there) at t = 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Protocol(#[schemars(length(min = 1))] pub Vec<Step>);

/// A step: a hold, or motion at a velocity over a distance or a duration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(extend("oneOf" = [
    { "required": ["hold"], "not": { "anyOf": [
        { "required": ["velocity"] }, { "required": ["distance"] }, { "required": ["duration"] }
    ] } },
    { "required": ["velocity", "distance"], "properties": { "velocity": { "exclusiveMinimum": 0 } }, "not": { "anyOf": [{ "required": ["duration"] }, { "required": ["velocity_to"] }] } },
    { "required": ["velocity", "duration"], "not": { "required": ["distance"] } }
]))]
pub struct Step {
    /// Velocity; above 0 over a distance, 0 or above for a duration.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "x-dimension" = "length/time"))]
    pub velocity: Option<f64>,
    /// Velocity at the end of a ramp that begins at `velocity` and takes `duration`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "x-dimension" = "length/time"))]
    pub velocity_to: Option<f64>,
    /// Displacement in the step.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length"))]
    pub distance: Option<f64>,
    /// Duration of the step.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "time"))]
    pub duration: Option<f64>,
    /// Duration of a hold at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "time"))]
    pub hold: Option<f64>,
    /// Points of the trace in the step, evenly spaced in time, on a ramp where it is at such times, including both ends.
    #[schemars(extend("minimum" = 2))]
    pub points: usize,
    /// In the first step only: `"conditional"` or `"relaxed"`, as `pull.start`, or `"steady"`: steady sliding at the `velocity`
    /// of this step, which must be above 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "conditional"))]
    pub start: Option<TaskStart>,
    /// Number of intervals of constant velocity that approximate a ramp, equally long, each at the velocity of its middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1, "default" = 64))]
    pub pieces: Option<usize>,
    /// Normal load in the step relative to that at the start of the protocol; it changes at the beginning of the step. The number
    /// of contacts is proportional to it. In the first step only 1, and only 1 with `[block]`, `[interface]` and
    /// `contacts.ageing.mean_field`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "default" = 1.0, "x-dimension" = "1"))]
    pub relative_normal_load: Option<f64>,
}

/// The key of the relative normal load.
const LOAD: &str = "relative_normal_load";
/// Default number of pieces of a ramp.
const PIECES: usize = 64;
/// Largest number of pieces of a ramp.
const MOST_PIECES: usize = 65_536;

impl Default for Step {
    fn default() -> Self {
        Self {
            velocity: None,
            velocity_to: None,
            distance: None,
            duration: None,
            hold: None,
            points: 201,
            start: None,
            pieces: None,
            relative_normal_load: None,
        }
    }
}

impl Step {
    /// Motion at `velocity` for a `duration`.
    pub fn moving(velocity: f64, duration: f64) -> Self {
        Self { velocity: Some(velocity), duration: Some(duration), ..Self::default() }
    }

    /// Its duration.
    pub fn duration(&self) -> f64 {
        match *self {
            Self { hold: Some(hold), .. } => hold,
            Self { distance: Some(distance), velocity: Some(velocity), .. } => distance / velocity,
            _ => self.duration.unwrap_or(0.0),
        }
    }

    /// Velocities at its start and at its end.
    pub fn velocities(&self) -> (f64, f64) {
        let first = self.velocity.unwrap_or(0.0);
        (first, self.velocity_to.unwrap_or(first))
    }

    /// The normal load in it, relative to that at the start of the protocol.
    pub fn load(&self) -> f64 {
        self.relative_normal_load.unwrap_or(1.0)
    }

    /// Its pieces of constant velocity; at the end of each piece of a ramp the position is that of the ramp.
    pub fn pieces(&self) -> Vec<Piece> {
        (0..self.number_of_pieces()).map(|i| self.piece(i)).collect()
    }

    fn number_of_pieces(&self) -> usize {
        self.velocity_to.map_or(1, |_| self.pieces.unwrap_or(PIECES))
    }

    fn piece(&self, i: usize) -> Piece {
        let ((first, last), count) = (self.velocities(), self.number_of_pieces() as f64);
        let velocity = first + (last - first) * ((i as f64 + 0.5) / count);
        Piece { velocity, duration: self.duration() / count }
    }

    /// When the pieces arrive at the position that the step has at the time `t` since its beginning. Between their ends they are
    /// ahead of a ramp that becomes faster, and behind one that becomes slower.
    fn arrival(&self, t: f64) -> f64 {
        let ((first, last), count) = (self.velocities(), self.number_of_pieces());
        if count == 1 || first == last {
            return t;
        }
        let whole = self.duration();
        let number = ((t / whole * count as f64) as usize).min(count - 1);
        let Piece { velocity, duration } = self.piece(number);
        let begin = number as f64 * duration;
        let inside = t - begin;
        // The ramp moves by v δ + a δ²/2 in the piece, in which v is that at its beginning.
        let slope = (last - first) / whole;
        begin + inside * (first + slope * (begin + 0.5 * inside)) / velocity
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        let given = [
            ("hold", self.hold.is_some()),
            ("distance", self.distance.is_some()),
            ("duration", self.duration.is_some()),
        ];
        super::exactly_one("", "one of hold, distance and duration", &given)?;
        if let Some(hold) = self.hold {
            positive("hold", hold)?;
            self.only_rests()?;
        } else {
            self.moves()?;
        }
        if self.points < 2 {
            return Err(Error::invalid("points", "2 points or more (both ends count)", self.points));
        }
        self.relative_normal_load.map(|load| positive(LOAD, load)).transpose().map(drop)
    }

    /// Checks that a hold has no velocity.
    fn only_rests(&self) -> Result<()> {
        let speeds = [("velocity", self.velocity), ("velocity_to", self.velocity_to)];
        match speeds.into_iter().find_map(|(key, value)| Some((key, value?))) {
            Some((key, value)) => Err(Error::invalid(key, "no velocity beside hold, which is rest", value)),
            None => self.unramped(),
        }
    }

    fn moves(&self) -> Result<()> {
        let Some(velocity) = self.velocity else {
            return Err(Error::invalid("velocity", "a velocity, since the step is no hold", "none"));
        };
        if let Some(distance) = self.distance {
            positive("velocity", velocity)?;
            positive("distance", distance)?;
            if let Some(end) = self.velocity_to {
                let expected = "no velocity_to beside distance; a ramp takes a duration";
                return Err(Error::invalid("velocity_to", expected, end));
            }
            return self.unramped();
        }
        not_negative("velocity", velocity)?;
        self.duration.map(|duration| positive("duration", duration)).transpose()?;
        let Some(end) = self.velocity_to else { return self.unramped() };
        not_negative("velocity_to", end)?;
        let pieces = self.pieces.unwrap_or(PIECES);
        if (1..=MOST_PIECES).contains(&pieces) {
            return Ok(());
        }
        Err(Error::invalid("pieces", format!("a number of pieces from 1 to {MOST_PIECES}"), pieces))
    }

    /// Refuses a start of a later step, and one in steady sliding at rest.
    fn check_start(&self, first: bool) -> Result<()> {
        match self.start {
            Some(_) if !first => {
                Err(Error::invalid("start", "no start but that of the first step", "one of a later step"))
            }
            Some(TaskStart::Steady) if !self.velocity.is_some_and(|velocity| velocity > 0.0) => {
                let expected =
                    "a velocity above 0 in the first step, at which contacts slide steadily at the start";
                Err(Error::invalid(
                    "velocity",
                    expected,
                    self.velocity.map_or("none".into(), |v| v.to_string()),
                ))
            }
            _ => Ok(()),
        }
    }

    /// Refuses another load in the first step than that at the start.
    fn check_load(&self, first: bool) -> Result<()> {
        match self.relative_normal_load {
            Some(load) if first && load != 1.0 => {
                let expected = "1, or none, in the first step: the load is relative to that at the start";
                Err(Error::invalid(LOAD, expected, load))
            }
            _ => Ok(()),
        }
    }

    /// Displacements from the beginning of the step at which forces are read in addition to the points of the trace: every 1/200
    /// of the `mean` threshold up to twice the mean, where contacts break for the first time after the step, then at distances
    /// that grow by 1 %. None is close to a point of the trace. Holds and ramps have none.
    fn displacements_between(&self, mean: f64) -> Vec<f64> {
        const FINE: f64 = 1.0 / 200.0;
        const DENSE: f64 = 2.0;
        const GROWTH: f64 = 0.01;
        const CLOSE: f64 = 0.25;
        let velocity = self.velocity.filter(|_| self.velocity_to.is_none()).unwrap_or(0.0);
        let reach = velocity * self.duration();
        let spacing = reach / (self.points - 1) as f64;
        let distance = |x: f64| if x < DENSE * mean { FINE * mean } else { GROWTH * x };
        let next = |x: &f64| Some(x + distance(*x)).filter(|next| next > x);
        let apart = |x: &f64| (x - spacing * (x / spacing).round()).abs() > CLOSE * distance(*x);
        std::iter::successors(Some(FINE * mean), next).take_while(|x| *x < reach).filter(apart).collect()
    }

    fn unramped(&self) -> Result<()> {
        let refused =
            |pieces| Error::invalid("pieces", "no pieces but those of a ramp (velocity_to)", pieces);
        self.pieces.map_or(Ok(()), |pieces| Err(refused(pieces)))
    }
}

impl Protocol {
    /// The motion of the slider, under a constant normal load.
    ///
    /// # Errors
    /// Those of [`History::new`]; a normal load that steps.
    pub fn build(&self) -> Result<History> {
        self.loads_constantly("where the solver has a constant normal load")?;
        self.motion()
    }

    /// The motion of the slider with the normal load in each step.
    ///
    /// # Errors
    /// Those of [`LoadedHistory::new`].
    pub fn build_under_load(&self) -> Result<LoadedHistory> {
        let loads = self.0.iter().flat_map(|step| vec![step.load(); step.number_of_pieces()]);
        LoadedHistory::new(self.motion()?, loads.collect())
    }

    fn motion(&self) -> Result<History> {
        History::new(self.0.iter().flat_map(Step::pieces).collect())
    }

    /// Whether the normal load steps.
    pub fn has_load_steps(&self) -> bool {
        self.0.iter().any(|step| step.load() != 1.0)
    }

    /// Whether the normal load steps at the beginning of step `i`.
    pub(crate) fn steps_load_at(&self, i: usize) -> bool {
        i > 0 && self.0[i].load() != self.0[i - 1].load()
    }

    /// Refuses a normal load that steps, `where_refused`, with the key of the first such step.
    pub(crate) fn loads_constantly(&self, where_refused: &str) -> Result<()> {
        match self.0.iter().enumerate().find(|(_, step)| step.load() != 1.0) {
            Some((i, step)) => {
                let expected = format!("1, or none, {where_refused}");
                Err(Error::invalid(format!("{i}.{LOAD}"), expected, step.load()))
            }
            None => Ok(()),
        }
    }

    /// The contacts at the start.
    pub fn start(&self) -> TaskStart {
        self.0.first().and_then(|step| step.start).unwrap_or_default()
    }

    /// The times at which the steps begin, and the end of the last one.
    pub fn knots(&self) -> Vec<f64> {
        // Summed piece by piece as in a history, so that both agree to the last bit.
        let mut time = 0.0;
        let ends = self.0.iter().map(|step| {
            step.pieces().iter().for_each(|piece| time += piece.duration);
            time
        });
        std::iter::once(0.0).chain(ends.collect::<Vec<_>>()).collect()
    }

    /// The same protocol with this number of pieces in each ramp, from the one that it has; `None` without ramps.
    pub(crate) fn with_pieces(&self, number: impl Fn(usize) -> usize) -> Option<Self> {
        let changed = |step: &Step| match step.velocity_to {
            Some(_) => Step { pieces: Some(number(step.number_of_pieces())), ..step.clone() },
            None => step.clone(),
        };
        let ramps = self.0.iter().any(|step| step.velocity_to.is_some());
        ramps.then(|| Self(self.0.iter().map(changed).collect()))
    }

    /// Whether the number of pieces of all ramps is the default one, which may be raised.
    pub(crate) fn has_default_pieces(&self) -> bool {
        self.0.iter().all(|step| step.pieces.is_none())
    }

    /// The times of the trace, in increasing order; the first point of a step is the last one of the step before. Points in a ramp
    /// are where the ramp is at evenly spaced times, and the times are those at which its pieces arrive there.
    pub fn times(&self) -> Vec<f64> {
        let knots = self.knots();
        let mut times = vec![0.0];
        for (step, ends) in self.0.iter().zip(knots.windows(2)) {
            let last = step.points - 1;
            let inside = |i: usize| ends[0] + step.arrival((ends[1] - ends[0]) * (i as f64 / last as f64));
            times.extend((1..last).map(inside).chain([ends[1]]));
        }
        times
    }

    /// Times at which forces are read in addition to those of the trace, in increasing order, so that maxima and what is read from
    /// velocity steps do not depend on the number of points. `mean` is the mean threshold.
    pub(crate) fn times_between(&self, mean: f64) -> Vec<f64> {
        let of_step = |(step, begin): (&Step, f64)| {
            let velocity = step.velocity.unwrap_or(0.0);
            step.displacements_between(mean).into_iter().map(move |x| begin + x / velocity)
        };
        self.0.iter().zip(self.knots()).flat_map(of_step).collect()
    }

    /// The number of these times.
    pub(crate) fn number_between(&self, mean: f64) -> usize {
        self.0.iter().map(|step| step.displacements_between(mean).len()).sum()
    }

    /// The number of points of the trace.
    pub fn points(&self) -> usize {
        self.0.iter().fold(1, |sum: usize, step| sum.saturating_add(step.points.saturating_sub(1)))
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        if self.0.is_empty() {
            return Err(Error::invalid("", "at least one step", "none"));
        }
        for (i, step) in self.0.iter().enumerate() {
            step.check()
                .and_then(|()| step.check_start(i == 0))
                .and_then(|()| step.check_load(i == 0))
                .map_err(|e| e.under(&i.to_string()))?;
        }
        size::check_anywhere("0.points", self.points(), size::BYTES_PER_POINT)
    }
}
