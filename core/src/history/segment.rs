//! A part of the motion of a load point, at one velocity.

use serde::{Deserialize, Serialize};

use super::History;

/// A part of the motion of the load point, at one velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LoadPointSegment {
    /// Time at which it begins.
    pub time: f64,
    /// Load-point displacement X_T at its beginning.
    pub drive: f64,
    /// Velocity of the load point, 0 or above.
    pub velocity: f64,
    /// Velocity of the load point of which a slip is ten times: the last one above 0, since the load point may be at rest.
    pub pulled: f64,
}

impl LoadPointSegment {
    /// X_T at a time.
    pub fn at(&self, time: f64) -> f64 {
        self.drive + self.velocity * (time - self.time)
    }
}

impl History {
    /// A piece as the motion of a load point that is at `origin` at t = 0. At rest, slips are those of the last motion, or of
    /// the first one if there was none.
    ///
    /// # Panics
    /// If there is no such piece.
    pub fn segment(&self, piece: usize, origin: f64) -> LoadPointSegment {
        let ((time, position), pieces) = (self.knots[piece], &self.pieces);
        let mut moving = pieces[..=piece].iter().rev().chain(&pieces[piece..]).map(|piece| piece.velocity);
        let pulled = moving.find(|velocity| *velocity > 0.0).unwrap_or(f64::INFINITY);
        LoadPointSegment { time, drive: origin + position, velocity: pieces[piece].velocity, pulled }
    }
}
