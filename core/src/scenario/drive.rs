//! `[drive]`: the load point (the top of the slider) is moved, or a force is imposed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Block, Protocol, Step, TaskStart, positive, size};
use crate::block::{self, Loading};
use crate::{Error, Result};

/// Moves the top of the slider from its equilibrium, X_T = 0 for relaxed contacts, and records the position of its base.
///
/// Without `[block]` the slider is rigid, and its base moves with its top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(extend("oneOf" = [
    { "not": { "anyOf": [{ "required": ["turning_points"] }, { "required": ["force_to"] }] } },
    { "required": ["turning_points"], "not": { "required": ["distance"] } },
    { "required": ["force_to"], "not": { "required": ["distance"] } }
]))]
pub struct Drive {
    /// Load-point displacement (displacement of the slider's top), from its equilibrium at X = 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "default" = 20.0, "x-dimension" = "length"))]
    pub distance: Option<f64>,
    /// Successive load-point positions X_T for driving back and forth; instead of `drive.distance`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1), extend("x-dimension" = "length"))]
    pub turning_points: Option<Vec<f64>>,
    /// Imposed force, increased up to this value; instead of `drive.distance`, without `[block]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force"))]
    pub force_to: Option<f64>,
    /// Points of the trace, evenly spaced along the drive; turning points and the points before and after every slip are
    /// added; slips of an interface are in its catalogue.
    #[schemars(extend("minimum" = 2))]
    pub points: usize,
    /// Drives, in increasing order, at which the state of every cell of an interface is stored; for a chain it is also
    /// stored at every point of the trace.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("default" = [], "x-dimension" = "length"))]
    pub maps: Vec<f64>,
    /// `"conditional"` or `"relaxed"`, as `pull.start`, or `"steady"`: steady sliding, at `drive.velocity` for time-dependent
    /// contacts, in balance with the spring of a block or those of an interface.
    pub start: TaskStart,
    /// Velocity of the load point, above 0, as `pull.velocity`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length/time"))]
    pub velocity: Option<f64>,
}

/// Default of `distance`.
const DISTANCE: f64 = 20.0;

impl Default for Drive {
    fn default() -> Self {
        Self {
            distance: None,
            turning_points: None,
            force_to: None,
            points: 2001,
            maps: Vec::new(),
            start: TaskStart::Conditional,
            velocity: None,
        }
    }
}

impl Drive {
    /// Positions X_T at which the top turns, and its last one, in order; none for an imposed force.
    pub fn turns(&self) -> Vec<f64> {
        match (&self.turning_points, self.force_to) {
            (Some(turns), _) => turns.clone(),
            (None, Some(_)) => Vec::new(),
            (None, None) => vec![self.distance()],
        }
    }

    /// Displacement of the top without turning points.
    pub fn distance(&self) -> f64 {
        self.distance.unwrap_or(DISTANCE)
    }

    /// The course of the drive, or of the force, of a slider that is in equilibrium at the drive `start`
    /// ([`block::Block::start`]), from which a displacement counts.
    pub fn build(&self, start: f64) -> block::Drive {
        let turning_points = match (&self.turning_points, self.force_to) {
            (Some(turns), _) => turns.clone(),
            (None, Some(force)) => vec![force],
            (None, None) => vec![start + self.distance()],
        };
        block::Drive { turning_points, points: self.points }
    }

    /// The drive as a protocol at its velocity, which must be given.
    ///
    /// # Errors
    /// An imposed force, or a drive backwards.
    pub fn forward(&self) -> Result<Protocol> {
        if let Some(force) = self.force_to {
            let expected = "no imposed force where contacts are time-dependent: they would creep without end";
            return Err(Error::invalid("force_to", expected, force));
        }
        let mut end = 0.0;
        for (i, turn) in self.turns().into_iter().enumerate() {
            if turn <= end {
                let expected = format!(
                    "a position above {end}: where contacts are time-dependent the drive goes forward only, as what they do on a way back is not followed in time"
                );
                return Err(Error::invalid(format!("turning_points.{i}"), expected, turn));
            }
            end = turn;
        }
        let points = self.points;
        let step = Step { distance: Some(end), velocity: self.velocity, points, ..Step::default() };
        Ok(Protocol(vec![step]))
    }

    /// The driven slider, rigid without a `block`. Over an `ensemble`, an event that breaks few contacts is not a slip.
    ///
    /// # Errors
    /// A block under an imposed force, or one with invalid values.
    pub fn slider(&self, block: Option<&Block>, ensemble: bool) -> Result<block::Block> {
        let (loading, slip, fraction) = match (block, self.force_to) {
            (Some(block), Some(_)) => {
                let expected = "no block (an infinite stiffness) where drive.force_to imposes a force";
                return Err(Error::invalid(
                    "block",
                    expected,
                    format!("one of stiffness {}", block.stiffness),
                ));
            }
            (Some(block), None) => (Loading::Spring(block.stiffness), block.slip, block.slip_fraction),
            (None, Some(_)) => (Loading::Force, block::Slip::Overdamped, 1.0),
            (None, None) => (Loading::Rigid, block::Slip::Overdamped, 1.0),
        };
        block::Block::new(loading, slip, ensemble.then_some(fraction)).map_err(|e| e.under("block"))
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        let given = [
            ("distance", self.distance.is_some()),
            ("turning_points", self.turning_points.is_some()),
            ("force_to", self.force_to.is_some()),
        ];
        let mut given = given.into_iter().filter(|g| g.1).map(|g| g.0);
        if let (Some(first), Some(second)) = (given.next(), given.next()) {
            let expected = "only one of distance, turning_points and force_to";
            return Err(Error::invalid(second, expected, format!("{second} beside {first}")));
        }
        self.distance.map(|distance| positive("distance", distance)).transpose()?;
        self.velocity.map(|velocity| positive("velocity", velocity)).transpose()?;
        self.force_to.map(|force| positive("force_to", force)).transpose()?;
        self.turning_points.as_deref().map(turning).transpose()?;
        self.check_maps()?;
        if self.points < 2 {
            return Err(Error::invalid("points", "2 points or more (both ends count)", self.points));
        }
        size::check_anywhere("points", self.points, size::BYTES_PER_POINT)
    }

    fn check_maps(&self) -> Result<()> {
        let end = self.distance();
        let mut before = 0.0;
        for (i, &map) in self.maps.iter().enumerate() {
            if !(map >= before && map <= end) || (i > 0 && map == before) {
                let expected = format!("rising drives from 0 to the distance {end}");
                return Err(Error::invalid(format!("maps.{i}"), expected, map));
            }
            before = map;
        }
        Ok(())
    }
}

/// Checks that every point but the last is a turn.
fn turning(points: &[f64]) -> Result<()> {
    if points.is_empty() {
        return Err(Error::invalid("turning_points", "at least one position", "an empty list"));
    }
    let (mut before, mut sign) = (0.0, 0.0);
    for (i, &point) in points.iter().enumerate() {
        let move_to = point - before;
        if !point.is_finite() || move_to == 0.0 || move_to * sign > 0.0 {
            let side = if sign == 0.0 {
                "apart from"
            } else if sign > 0.0 {
                "below"
            } else {
                "above"
            };
            let expected = format!("a position {side} {before}, where the drive turns");
            return Err(Error::invalid(format!("turning_points.{i}"), expected, point));
        }
        (before, sign) = (point, move_to.signum());
    }
    Ok(())
}
