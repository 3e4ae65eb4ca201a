//! The motion of a slider under a normal load that steps.

use super::{History, Piece};
use crate::{Error, Result};

/// A motion with the normal load of each of its pieces, relative to that at the start. The load steps where pieces meet.
///
/// ```
/// use asperity::history::{History, LoadedHistory, Piece};
///
/// let piece = Piece { velocity: 1.0, duration: 2.0 };
/// let motion = LoadedHistory::new(History::new(vec![piece, piece])?, vec![1.0, 1.5])?;
/// assert_eq!((motion.load_at(1.0), motion.load_at(2.0)), (1.0, 1.5));
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedHistory {
    history: History,
    loads: Vec<f64>,
}

/// A step of the normal load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadStep {
    /// Index of the piece with which it begins.
    pub piece: usize,
    /// Its time.
    pub time: f64,
    /// The relative load before it.
    pub before: f64,
    /// The relative load after it.
    pub after: f64,
}

impl LoadedHistory {
    /// A motion with the relative load of each piece, 1 for the first one.
    ///
    /// # Errors
    /// Not one load for each piece; a load that is not a finite number above 0, or of the first piece not 1.
    pub fn new(history: History, loads: Vec<f64>) -> Result<Self> {
        if loads.len() != history.pieces().len() {
            let expected = format!("{} loads, one for each piece of the motion", history.pieces().len());
            return Err(Error::invalid("loads", expected, loads.len()));
        }
        if let Some((i, load)) =
            loads.iter().enumerate().find(|(_, load)| !(load.is_finite() && **load > 0.0))
        {
            return Err(Error::invalid(format!("loads.{i}"), "a finite number above 0", load));
        }
        if loads[0] != 1.0 {
            return Err(Error::invalid("loads.0", "1: loads are relative to that at the start", loads[0]));
        }
        Ok(Self { history, loads })
    }

    /// The motion.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// The relative load at a time; that after a step where it steps.
    pub fn load_at(&self, time: f64) -> f64 {
        self.loads[self.history.piece_at(time)]
    }

    /// The steps of the load, in order of time.
    pub fn steps(&self) -> impl Iterator<Item = LoadStep> {
        let knots = self.history.knots();
        let step = move |(i, pair): (usize, &[f64])| LoadStep {
            piece: i + 1,
            time: knots[i + 1].0,
            before: pair[0],
            after: pair[1],
        };
        self.loads.windows(2).enumerate().filter(|(_, pair)| pair[0] != pair[1]).map(step)
    }

    /// The same motion after `first` under the load at the start.
    ///
    /// # Errors
    /// Those of [`History::new`].
    pub(crate) fn after(&self, first: Piece) -> Result<Self> {
        let pieces = std::iter::once(first).chain(self.history.pieces().iter().copied());
        let loads = std::iter::once(1.0).chain(self.loads.iter().copied());
        Ok(Self { history: History::new(pieces.collect())?, loads: loads.collect() })
    }

    /// The times, and at each of them at which the load steps one more, with the load: that before the step comes first.
    pub(crate) fn readings(&self, times: &[f64]) -> Vec<(f64, f64)> {
        let steps: Vec<LoadStep> = self.steps().collect();
        let of = |&time: &f64| {
            let step = steps.iter().find(|step| step.time == time);
            step.map(|step| (time, step.before)).into_iter().chain([(time, self.load_at(time))])
        };
        times.iter().flat_map(of).collect()
    }
}

impl History {
    /// The motion from a piece on.
    ///
    /// # Errors
    /// Those of [`History::new`].
    pub(crate) fn pieces_from(&self, piece: usize) -> Result<Self> {
        Self::new(self.pieces[piece..].to_vec())
    }

    /// A time of this motion as one of `other`, in which piece i of this one is piece `place(i)`. Times at which pieces meet remain
    /// such times, to the last bit.
    pub(crate) fn time_in(&self, other: &Self, place: impl Fn(usize) -> usize, time: f64) -> f64 {
        if time >= self.duration() {
            return other.knots[place(self.pieces.len() - 1) + 1].0;
        }
        let piece = self.piece_at(time);
        let (begin, end) = (other.knots[place(piece)].0, other.knots[place(piece) + 1].0);
        (begin + (time - self.knots[piece].0)).min(end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(durations: &[f64], loads: &[f64]) -> Result<LoadedHistory> {
        let pieces = durations.iter().map(|&duration| Piece { velocity: 0.5, duration }).collect();
        LoadedHistory::new(History::new(pieces)?, loads.to_vec())
    }

    #[test]
    fn loads_step_where_pieces_meet() {
        let motion = motion(&[1.0, 2.0, 3.0, 4.0], &[1.0, 1.0, 2.0, 0.5]).unwrap();
        let steps: Vec<LoadStep> = motion.steps().collect();
        let step = |piece, time, before, after| LoadStep { piece, time, before, after };
        assert_eq!(steps, [step(2, 3.0, 1.0, 2.0), step(3, 6.0, 2.0, 0.5)]);
        assert_eq!(
            [0.0, 1.0, 2.9, 3.0, 6.0, 10.0].map(|time| motion.load_at(time)),
            [1.0, 1.0, 1.0, 2.0, 0.5, 0.5]
        );
        let readings = [(1.0, 1.0), (3.0, 1.0), (3.0, 2.0), (4.0, 2.0), (6.0, 2.0), (6.0, 0.5), (10.0, 0.5)];
        assert_eq!(motion.readings(&[1.0, 3.0, 4.0, 6.0, 10.0]), readings);
        let later = motion.after(Piece { velocity: 1.0, duration: 7.0 }).unwrap();
        assert_eq!(later.steps().map(|step| step.time).collect::<Vec<_>>(), [10.0, 13.0]);
    }

    #[test]
    fn times_at_which_pieces_meet_remain_such_times() {
        // None of these is a binary fraction.
        let whole = motion(&[0.1, 0.7, 1.3, 0.3], &[1.0; 4]).unwrap().history().clone();
        let later = whole.pieces_from(1).unwrap();
        for (i, knot) in later.knots().iter().enumerate() {
            assert_eq!(whole.time_in(&later, |piece| piece - 1, whole.knots()[i + 1].0), knot.0);
        }
        assert!((whole.time_in(&later, |piece| piece - 1, 1.0) - 0.9).abs() < 1e-12);
    }

    #[test]
    fn loads_that_no_motion_has_are_refused() {
        for (loads, key) in [
            (vec![1.0], "loads:"),
            (vec![1.0, 0.0], "loads.1"),
            (vec![1.0, f64::NAN], "loads.1"),
            (vec![2.0, 1.0], "loads.0"),
        ] {
            let error = motion(&[1.0, 1.0], &loads).unwrap_err().to_string();
            assert!(error.starts_with(key), "{error}");
        }
    }
}
