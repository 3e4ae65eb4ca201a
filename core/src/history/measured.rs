//! The pieces of constant velocity in a measured motion.

use std::ops::Range;

use crate::{Error, Result};

/// A division must lower the squares of residuals by this many times the variance of the noise, times the logarithm of the
/// number of readings: the criterion of Schwarz for three more numbers, and twice that for noise that is not white.
const PENALTY: f64 = 6.0;

/// Pieces whose velocities differ by fewer standard errors are one.
const CERTAIN: f64 = 4.0;

/// A piece of constant velocity in a measured motion.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPiece {
    /// Its readings, by index.
    pub readings: Range<usize>,
    /// The time at which it begins: where its line meets that of the piece before; the first time for the first piece.
    pub begin: f64,
    /// The slope of the position against time, by least squares.
    pub velocity: f64,
    /// Its standard error from the scatter of the residuals, which are taken as independent.
    pub error: f64,
}

/// The pieces of constant velocity in a motion with noise, in order; together they have all readings.
///
/// Readings are divided where two straight lines describe them better than one, again and again (binary segmentation: A. J.
/// Scott and M. Knott, Biometrics 30, 507, 1974). Neighbours whose velocities differ by less than `apart` times the larger
/// one, or by less than four standard errors, are joined, the most similar ones first; then each boundary moves to where
/// the lines on both sides describe the readings best. Each piece has `least` readings or more. The noise is estimated from
/// differences of neighbouring readings.
///
/// # Errors
/// Lists of different lengths, or of fewer than two pieces; numbers that are not finite; times that do not rise; `apart`
/// outside [0, 1], `least` below 3.
pub fn measured_pieces(
    time: &[f64],
    position: &[f64],
    (apart, least): (f64, usize),
) -> Result<Vec<MeasuredPiece>> {
    check(time, position, (apart, least))?;
    let sums = RunningSums::new(time, position);
    let threshold = PENALTY * (time.len() as f64).ln() * noise(time, position).powi(2);
    let mut ends = vec![0, time.len()];
    let mut pending = vec![(0, time.len())];
    while let Some((start, end)) = pending.pop() {
        if let Some((place, gain)) = sums.best_division(&(start..end), least)
            && gain > threshold
        {
            ends.push(place);
            pending.extend([(start, place), (place, end)]);
        }
    }
    ends.sort_unstable();
    sums.join(&mut ends, apart);
    loop {
        sums.move_boundaries(&mut ends, least);
        // Where a boundary has moved, two neighbours may have become one.
        if !sums.join(&mut ends, apart) {
            break;
        }
    }
    Ok(sums.pieces(&ends, time))
}

fn check(time: &[f64], position: &[f64], (apart, least): (f64, usize)) -> Result<()> {
    if least < 3 {
        return Err(Error::invalid("least", "3 readings or more", least));
    }
    if !(0.0..=1.0).contains(&apart) {
        return Err(Error::invalid("apart", "a number from 0 to 1", apart));
    }
    if time.len() != position.len() {
        let expected = format!("{} positions, one for each time", time.len());
        return Err(Error::invalid("position", expected, position.len()));
    }
    let fewest = least.saturating_mul(2);
    if time.len() < fewest {
        return Err(Error::invalid("time", format!("{fewest} readings or more"), time.len()));
    }
    for (key, values) in [("time", time), ("position", position)] {
        if let Some((i, value)) = values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(Error::invalid(format!("{key}.{i}"), "a finite number", value));
        }
    }
    match time.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(i) => Err(Error::invalid(
            format!("time.{}", i + 1),
            format!("times that rise, after {}", time[i]),
            time[i + 1],
        )),
        None => Ok(()),
    }
}

/// The standard deviation of the noise: the median distance of a reading from the line between its neighbours. It is at
/// least the rounding of the positions.
fn noise(time: &[f64], position: &[f64]) -> f64 {
    /// Standard deviations of a normal variable in the median of its modulus.
    const MEDIAN: f64 = 0.674_489_750_196_081_7;
    let scaled = |i: usize| {
        let before = (time[i + 2] - time[i + 1]) / (time[i + 2] - time[i]);
        let after = 1.0 - before;
        let apart = position[i + 1] - before * position[i] - after * position[i + 2];
        apart.abs() / (1.0 + before * before + after * after).sqrt()
    };
    let mut apart: Vec<f64> = (0..time.len() - 2).map(scaled).collect();
    let middle = apart.len() / 2;
    let (_, median, _) = apart.select_nth_unstable_by(middle, f64::total_cmp);
    let largest = position.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    (*median / MEDIAN).max(4.0 * f64::EPSILON * largest)
}

/// Running sums of 1, t, x, t², tx, x² about the mean time and position, from which the line through any range follows.
struct RunningSums {
    mean_time: f64,
    sums: Vec<[f64; 6]>,
}

/// Sums over a range, about its means.
struct RegressionLine {
    count: f64,
    /// Mean time and position, about those of all readings.
    mean: [f64; 2],
    tt: f64,
    tx: f64,
    xx: f64,
}

impl RegressionLine {
    fn velocity(&self) -> f64 {
        self.tx / self.tt
    }

    /// The squares of residuals.
    fn squares(&self) -> f64 {
        (self.xx - self.tx * self.tx / self.tt).max(0.0)
    }

    /// Where it meets another line, a time about the mean of all.
    fn meets(&self, other: &Self) -> f64 {
        let along = |line: &Self| line.mean[1] - line.velocity() * line.mean[0];
        (along(other) - along(self)) / (self.velocity() - other.velocity())
    }

    fn error(&self) -> f64 {
        (self.squares() / ((self.count - 2.0) * self.tt)).sqrt()
    }
}

impl RunningSums {
    fn new(time: &[f64], position: &[f64]) -> Self {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let (t, x) = (mean(time), mean(position));
        let mut sums = vec![[0.0; 6]];
        for (time, position) in time.iter().zip(position) {
            let (t, x) = (time - t, position - x);
            let last = sums[sums.len() - 1];
            let next = [1.0, t, x, t * t, t * x, x * x];
            sums.push(std::array::from_fn(|k| last[k] + next[k]));
        }
        Self { mean_time: t, sums }
    }

    fn line(&self, range: &Range<usize>) -> RegressionLine {
        let [count, t, x, tt, tx, xx] =
            std::array::from_fn(|k| self.sums[range.end][k] - self.sums[range.start][k]);
        RegressionLine {
            count,
            mean: [t / count, x / count],
            tt: tt - t * t / count,
            tx: tx - t * x / count,
            xx: xx - x * x / count,
        }
    }

    /// Where two lines describe a range best, and by how much they lower the squares of residuals.
    fn best_division(&self, range: &Range<usize>, least: usize) -> Option<(usize, f64)> {
        let whole = self.line(range).squares();
        let places = range.start + least..(range.end + 1).saturating_sub(least);
        let gain = |place: usize| {
            whole - self.line(&(range.start..place)).squares() - self.line(&(place..range.end)).squares()
        };
        places.map(|place| (place, gain(place))).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The boundary between the two neighbours whose velocities are most similar, if they are one.
    fn most_similar(&self, ends: &[usize], apart: f64) -> Option<usize> {
        let ratio = |place: usize| {
            let [one, other] =
                [ends[place - 1]..ends[place], ends[place]..ends[place + 1]].map(|range| self.line(&range));
            let (v, w) = (one.velocity(), other.velocity());
            let allowed = (apart * v.abs().max(w.abs())).max(CERTAIN * one.error().hypot(other.error()));
            // Two exact rests allow no difference, and have none.
            if v == w { 0.0 } else { (v - w).abs() / allowed }
        };
        let places = (1..ends.len() - 1).map(|place| (place, ratio(place)));
        places.filter(|(_, ratio)| *ratio <= 1.0).min_by(|a, b| a.1.total_cmp(&b.1)).map(|found| found.0)
    }

    /// Joins neighbours that are one, the most similar ones first. Returns whether there were any.
    fn join(&self, ends: &mut Vec<usize>, apart: f64) -> bool {
        let before = ends.len();
        while let Some(place) = self.most_similar(ends, apart) {
            ends.remove(place);
        }
        ends.len() < before
    }

    /// Moves each boundary to where the lines on both sides describe the readings best. A boundary depends on both of its
    /// neighbours; two rounds settle nearly all.
    fn move_boundaries(&self, ends: &mut [usize], least: usize) {
        for _ in 0..2 {
            for place in 1..ends.len() - 1 {
                if let Some((better, _)) = self.best_division(&(ends[place - 1]..ends[place + 1]), least) {
                    ends[place] = better;
                }
            }
        }
    }

    /// The pieces between these ends.
    fn pieces(&self, ends: &[usize], time: &[f64]) -> Vec<MeasuredPiece> {
        let lines: Vec<RegressionLine> = ends.windows(2).map(|pair| self.line(&(pair[0]..pair[1]))).collect();
        let begin = |place: usize| match place.checked_sub(1) {
            None => time[0],
            // Lines that meet far from the boundary are those of a motion that is not continuous.
            Some(before) => (lines[before].meets(&lines[place]) + self.mean_time)
                .clamp(time[ends[before]], time[ends[place + 1] - 1]),
        };
        let piece = |(place, line): (usize, &RegressionLine)| MeasuredPiece {
            readings: ends[place]..ends[place + 1],
            begin: begin(place),
            velocity: line.velocity(),
            error: line.error(),
        };
        lines.iter().enumerate().map(piece).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    /// A motion at the given velocities for the given numbers of readings, ten in each second, with normal noise.
    fn motion(pieces: &[(f64, usize)], noise: f64) -> (Vec<f64>, Vec<f64>) {
        let mut stream = Stream::new(2, Purpose::Sample, 0);
        // Sums of twelve uniform numbers have the variance 1, and are normal but for their tails.
        let mut normal = || (0..12).map(|_| stream.uniform()).sum::<f64>() - 6.0;
        let (mut time, mut position, mut at) = (Vec::new(), Vec::new(), 5000.0);
        for &(velocity, count) in pieces {
            for _ in 0..count {
                at += 0.1 * velocity;
                position.push(at + noise * normal());
                time.push(2e4 + 0.1 * time.len() as f64);
            }
        }
        (time, position)
    }

    #[test]
    fn pieces_are_found_with_their_velocities() {
        let pieces = [(1.0, 400), (0.0, 900), (1.0, 300), (10.0, 200), (-3.0, 500), (-3.3, 500)];
        for noise in [0.0, 0.02, 0.16] {
            let (time, position) = motion(&pieces, noise);
            let found = measured_pieces(&time, &position, (0.2, 8)).unwrap();
            // The last two velocities differ by a tenth.
            let expected = [(1.0, 400), (0.0, 1300), (1.0, 1600), (10.0, 1800), (-3.15, 2800)];
            assert_eq!(found.len(), expected.len(), "{noise}: {found:?}");
            for (piece, (velocity, end)) in found.iter().zip(expected) {
                // A boundary is known to a few readings: those in which the lines are within the noise.
                assert!(piece.readings.end.abs_diff(end) <= 12, "{noise}: {piece:?}");
                let joined = if velocity == -3.15 { 0.02 } else { 0.0 };
                assert!(
                    (piece.velocity - velocity).abs() < 5.0 * piece.error + joined + 1e-9,
                    "{noise}: {piece:?}"
                );
            }
        }
    }

    #[test]
    fn one_velocity_is_one_piece() {
        for noise in [0.0, 0.3] {
            let (time, position) = motion(&[(0.2, 5000)], noise);
            let found = measured_pieces(&time, &position, (0.2, 8)).unwrap();
            assert_eq!(found.len(), 1);
            // Standard errors of white noise: σ√(12/n³)/Δt.
            let error = noise * (12.0 / 5000.0_f64.powi(3)).sqrt() / 0.1;
            assert!((found[0].error - error).abs() < 0.1 * error + 1e-9);
        }
    }

    /// Rests without noise, apart by a jump of the positions, have one velocity.
    #[test]
    fn exact_rests_on_both_sides_of_a_jump_are_one_piece() {
        let time: Vec<f64> = (0..40).map(f64::from).collect();
        let position: Vec<f64> = time.iter().map(|t| if *t < 20.0 { 0.0 } else { 1.0 }).collect();
        let found = measured_pieces(&time, &position, (0.2, 8)).unwrap();
        assert_eq!((found.len(), found[0].begin, found[0].readings.clone()), (1, 0.0, 0..40));
    }

    #[test]
    fn bad_records_are_refused() {
        let message = |t: &[f64], x: &[f64]| measured_pieces(t, x, (0.2, 3)).unwrap_err().to_string();
        let rising = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        assert!(message(&rising, &rising[1..]).contains("position"));
        assert!(message(&rising[..4], &rising[..4]).contains("6 readings or more"));
        assert!(message(&[0.0, 1.0, 1.0, 3.0, 4.0, 5.0], &rising).contains("times that rise, after 1"));
        assert!(message(&rising, &[0.0, f64::NAN, 2.0, 3.0, 4.0, 5.0]).contains("position.1"));
    }
}
