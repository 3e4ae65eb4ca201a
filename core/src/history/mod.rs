//! The motion of a slider in time: pieces of constant velocity.

mod loaded;
mod measured;
mod segment;

pub use loaded::{LoadStep, LoadedHistory};
pub use measured::{MeasuredPiece, measured_pieces};
pub use segment::LoadPointSegment;

use crate::{Error, Result};

/// Motion at one velocity, or rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Velocity v, 0 or above; a length per time.
    pub velocity: f64,
    /// Duration.
    pub duration: f64,
}

/// Motion from X = 0 at t = 0: X is continuous, its velocity constant on each piece.
///
/// ```
/// use asperity::history::{History, Piece};
///
/// let motion = History::new(vec![
///     Piece { velocity: 2.0, duration: 3.0 },
///     Piece { velocity: 0.0, duration: 5.0 },
/// ])?;
/// assert_eq!((motion.duration(), motion.position(1.0), motion.position(8.0)), (8.0, 2.0, 6.0));
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    pieces: Vec<Piece>,
    /// Time and position at the start of each piece, and at the end.
    knots: Vec<(f64, f64)>,
}

impl History {
    /// Motion in these pieces.
    ///
    /// # Errors
    /// No pieces; a velocity below 0; a duration that is not a finite number above 0, or that does not change the time;
    /// a position that is not finite.
    pub fn new(pieces: Vec<Piece>) -> Result<Self> {
        if pieces.is_empty() {
            return Err(Error::invalid("protocol", "at least one step", "none"));
        }
        let (mut at, mut knots) = ((0.0, 0.0), vec![(0.0, 0.0)]);
        for (i, &Piece { velocity, duration }) in pieces.iter().enumerate() {
            if !(velocity.is_finite() && velocity >= 0.0) {
                return Err(Error::invalid(format!("{i}.velocity"), "a finite number, 0 or above", velocity));
            }
            if !(duration.is_finite() && duration > 0.0) {
                return Err(Error::invalid(format!("{i}.duration"), "a finite number above 0", duration));
            }
            let next = (at.0 + duration, at.1 + velocity * duration);
            if !(next.0 > at.0 && next.0.is_finite() && next.1.is_finite()) {
                let expected =
                    format!("a duration that numbers resolve at t = {}, to a finite position", at.0);
                return Err(Error::invalid(format!("{i}.duration"), expected, duration));
            }
            at = next;
            knots.push(at);
        }
        Ok(Self { pieces, knots })
    }

    /// The pieces.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Time and position at the start of each piece, and at the end.
    pub fn knots(&self) -> &[(f64, f64)] {
        &self.knots
    }

    /// Time at which the motion ends.
    pub fn duration(&self) -> f64 {
        self.knots[self.pieces.len()].0
    }

    /// The index of the piece at a time; the later one where two meet.
    pub fn piece_at(&self, time: f64) -> usize {
        (self.knots.partition_point(|knot| knot.0 <= time).max(1) - 1).min(self.pieces.len() - 1)
    }

    /// The time at which the motion is at this position, within the piece that it has at `time`; `time` itself at rest.
    pub(crate) fn arrival(&self, position: f64, time: f64) -> f64 {
        let piece = self.piece_at(time);
        let Piece { velocity, duration } = self.pieces[piece];
        let (begin, from) = self.knots[piece];
        if velocity > 0.0 { begin + ((position - from) / velocity).clamp(0.0, duration) } else { time }
    }

    /// Refuses times that are not ascending or are outside the motion.
    pub(crate) fn check_times(&self, times: &[f64]) -> Result<()> {
        let end = self.duration();
        let outside = times.iter().find(|&&time| !(time >= 0.0 && time <= end));
        let falling = times.windows(2).find(|pair| pair[1] <= pair[0]).map(|pair| &pair[1]);
        match outside.or(falling) {
            Some(time) => Err(Error::invalid("times", format!("rising times from 0 to {end}"), time)),
            None => Ok(()),
        }
    }

    /// X at a time from 0 to the end.
    pub fn position(&self, time: f64) -> f64 {
        let piece = self.piece_at(time);
        self.knots[piece].1 + self.pieces[piece].velocity * (time - self.knots[piece].0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_follow_the_pieces() {
        let piece = |velocity, duration| Piece { velocity, duration };
        let history = History::new(vec![piece(2.0, 1.0), piece(0.0, 3.0), piece(0.5, 2.0)]).unwrap();
        assert_eq!(history.duration(), 6.0);
        assert_eq!(
            [0.0, 0.5, 1.0, 3.0, 4.0, 5.0, 6.0].map(|t| history.position(t)),
            [0.0, 1.0, 2.0, 2.0, 2.0, 2.5, 3.0]
        );
        assert_eq!(history.piece_at(1.0), 1);
        // Within the piece, at its ends for positions beyond it, and at rest.
        assert_eq!([0.5, 1.5, 5.0].map(|x| history.arrival(x, 0.9)), [0.25, 0.75, 1.0]);
        assert_eq!((history.arrival(2.0, 3.5), history.arrival(2.25, 5.0)), (3.5, 4.5));
        assert!(History::new(Vec::new()).is_err());
        assert!(History::new(vec![piece(-1.0, 1.0)]).is_err());
        assert!(History::new(vec![piece(1.0, 0.0)]).is_err());
    }
}
