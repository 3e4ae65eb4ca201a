//! Attached contacts, and the history of the slider in segments of constant velocity.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::history::History;

/// An attached contact: its stretch is X − `origin`.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct AttachedContact {
    /// Time of its formation.
    pub(super) birth: f64,
    pub(super) origin: f64,
    /// Its threshold then.
    pub(super) fresh: f64,
}

/// A part of a history at constant velocity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    pub(super) start: f64,
    pub(super) end: f64,
    /// X at the start.
    pub(super) position: f64,
    pub(super) velocity: f64,
}

impl Segment {
    #[inline]
    pub(super) fn position(&self, time: f64) -> f64 {
        self.position + self.velocity * (time - self.start)
    }

    /// The part from a time on.
    #[inline]
    pub(super) fn from(self, time: f64) -> Self {
        Self { start: time, position: self.position(time), ..self }
    }
}

/// The segments of a history that overlap with a range of times; the first one begins with the range.
pub(super) fn segments(history: &History, range: Range<f64>) -> impl Iterator<Item = Segment> {
    let (pieces, knots) = (history.pieces(), history.knots());
    let segment = move |i: usize| {
        let ((begin, position), velocity) = (knots[i], pieces[i].velocity);
        let start = begin.max(range.start);
        Segment { start, end: knots[i + 1].0, position: position + velocity * (start - begin), velocity }
    };
    let last = history.piece_at(range.end);
    (history.piece_at(range.start)..=last).map(segment)
}
