//! What was measured: a curve of force, the machine that measured it, and the errors of its readings.

use crate::error::{all_finite, as_many, finite, not_negative, positive};
use crate::numerics::order::sort_by_number;
use crate::{Error, Result};

/// A measured curve of force.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measurement {
    /// Positions y of the readings, rising; displacements of the slider, or of the drive if the machine has a compliance.
    pub positions: Vec<f64>,
    /// The force at each position; empty for a measurement that is only planned.
    pub forces: Vec<f64>,
    /// The machine.
    pub machine: Machine,
    /// Of readings that are means of neighbouring ones, the positions of these in rising order; empty for single readings. The
    /// expected mean is that of the curve at these positions, and it has less of the noise of contacts, which changes with every
    /// break.
    pub members: Vec<Vec<f64>>,
}

/// The machine that measures: how a reading follows from the force F on the contacts and the position X of the slider,
///
/// y = origin + X + compliance (F(X) + B), force = F(X) + B + offset + trend y.
///
/// The background force B also stretches the machine, a wrong zero of the force does not: without a compliance they are the same.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Machine {
    /// Displacement of the drive against the slider per force; 0 where positions are those of the slider.
    pub compliance: f64,
    /// Background force B, friction in addition to that of the contacts.
    pub background: f64,
    /// The reading of the force where there is none.
    pub offset: f64,
    /// Change of that reading per length.
    pub trend: f64,
    /// The reading of the position at X = 0.
    pub origin: f64,
}

/// Errors of readings: independent ones of force and position, those of a slow drift, and the noise of a finite number of contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorModel {
    /// Whether the noise of the contacts is part of it; without it errors are white, but for the drift.
    pub contacts: bool,
    /// Standard deviation of the independent error of a force; without it, it is estimated.
    pub reading: Option<f64>,
    /// The longest correlation length of a drift; without it there is no drift.
    pub drift: Option<f64>,
    /// Standard deviation of the independent error of a position, where `contacts` is false; `None` for exact positions.
    pub position: Option<f64>,
}

impl Default for ErrorModel {
    fn default() -> Self {
        Self { contacts: true, reading: None, drift: None, position: None }
    }
}

impl Measurement {
    /// A curve of force against the position of the slider.
    pub fn new(positions: Vec<f64>, forces: Vec<f64>) -> Self {
        Self { positions, forces, ..Self::default() }
    }

    /// The readings at positions from `from` to `to`.
    #[must_use]
    pub fn within(&self, [from, to]: [f64; 2]) -> Self {
        let inside = |&i: &usize| (from..=to).contains(&self.positions[i]);
        let kept: Vec<usize> = (0..self.positions.len()).filter(inside).collect();
        self.of_readings(&kept)
    }

    /// The measurement of these readings alone.
    fn of_readings(&self, kept: &[usize]) -> Self {
        fn of<T: Clone>(values: &[T], kept: &[usize]) -> Vec<T> {
            kept.iter().filter_map(|&i| values.get(i).cloned()).collect()
        }
        Self {
            positions: of(&self.positions, kept),
            forces: of(&self.forces, kept),
            machine: self.machine,
            members: of(&self.members, kept),
        }
    }

    /// The same with every `count` neighbouring readings replaced by their mean, of positions and of forces; the last readings,
    /// where they are fewer, too. Positions need not rise, as those of a noisy sensor do not, if their means do.
    ///
    /// Independent errors become smaller by √count. Means over more than a feature of the curve hide it.
    ///
    /// # Errors
    /// A count of 0; means of positions that do not rise; fewer than two positions, other numbers of forces, numbers that are not finite.
    pub fn average(&self, count: usize) -> Result<Self> {
        if count == 0 {
            return Err(Error::invalid("average", "a number of readings above 0", count));
        }
        self.check_readings()?;
        if count == 1 {
            self.check_order()?;
            return Ok(self.clone());
        }
        let n = self.positions.len();
        let group = |first: usize| {
            let mut members: Vec<f64> =
                (first..n.min(first + count)).flat_map(|i| self.members_of(i).to_vec()).collect();
            sort_by_number(&mut members, |position| *position);
            members
        };
        let groups: Vec<Vec<f64>> = (0..n).step_by(count).map(group).collect();
        // Readings that are means themselves count as often as they have members.
        let weights: Vec<f64> = (0..n).map(|i| self.members_of(i).len() as f64).collect();
        let weighted: Vec<f64> =
            self.forces.iter().zip(&weights).map(|(force, weight)| force * weight).collect();
        let forces = weighted
            .chunks(count)
            .zip(&groups)
            .map(|(some, group)| some.iter().sum::<f64>() / group.len() as f64);
        let mean = |group: &Vec<f64>| group.iter().sum::<f64>() / group.len() as f64;
        let averaged = Self {
            positions: groups.iter().map(mean).collect(),
            forces: forces.collect(),
            machine: self.machine,
            members: groups,
        };
        averaged.check_order()?;
        Ok(averaged)
    }

    /// The positions that a reading is the mean of; its own if it is a single one.
    pub(super) fn members_of(&self, i: usize) -> &[f64] {
        self.members.get(i).map_or(&self.positions[i..=i], Vec::as_slice)
    }

    /// The farthest position.
    pub(super) fn last(&self) -> f64 {
        self.positions.iter().chain(self.members.iter().flatten()).copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// The distance of two readings, or the mean distance of two of those that a reading is the mean of, each from itself among
    /// them.
    pub(super) fn distance(&self, i: usize, j: usize) -> f64 {
        if i != j {
            return (self.positions[i] - self.positions[j]).abs();
        }
        let members = self.members_of(i);
        let n = members.len() as f64;
        // Σ |x_k − x_l| of rising numbers.
        let sum = |(k, x): (usize, &f64)| 2.0 * (2.0 * k as f64 + 1.0 - n) * (x - self.positions[i]);
        members.iter().enumerate().map(sum).sum::<f64>() / (n * n)
    }

    /// Every `every`-th reading.
    pub(super) fn thinned(&self, every: usize) -> Self {
        let kept: Vec<usize> = (every - 1..self.positions.len()).step_by(every).collect();
        self.of_readings(&kept)
    }

    /// A first value of a compliance that is not known, for contacts of the stiffness N⟨k⟩ = K together: the steepest mean
    /// slope s over a tenth of the readings is about K/(1 + cK), so that c = 1/s − 1/K; a hundredth of 1/K where this is
    /// not above it.
    pub fn first_compliance(&self, stiffness: f64) -> f64 {
        let least = 0.01 / stiffness;
        let found = 1.0 / self.steepest() - 1.0 / stiffness;
        if found.is_finite() { found.max(least) } else { least }
    }

    /// The steepest mean slope over a tenth of the readings; 0 where no force rises.
    pub(super) fn steepest(&self) -> f64 {
        self.steepest_chord().map_or(0.0, |(_, slope)| slope)
    }

    /// The first reading and the slope of the steepest chord over a tenth of the readings, if a force rises.
    fn steepest_chord(&self) -> Option<(usize, f64)> {
        let apart = (self.positions.len() / 10).max(1);
        let slope = |i: usize| {
            (self.forces[i + apart] - self.forces[i]) / (self.positions[i + apart] - self.positions[i])
        };
        let readings = self.forces.len().min(self.positions.len());
        let chords = (0..readings.saturating_sub(apart)).map(|i| (i, slope(i)));
        chords.filter(|(_, slope)| *slope > 0.0).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// How far the slider has moved where the force of the contacts first reaches half of its median, which single wrong readings do
    /// not move; `None` where that is not above 0.
    pub(super) fn rise(&self) -> Option<f64> {
        let Machine { compliance, background, offset, trend, origin } = self.machine;
        let level = |y: f64| background + offset + trend * y;
        let readings = self.positions.iter().zip(&self.forces);
        let forces: Vec<f64> = readings.map(|(&y, &reading)| reading - level(y)).collect();
        let mut sorted = forces.clone();
        sort_by_number(&mut sorted, |force| *force);
        let half = 0.5 * sorted.get(sorted.len() / 2).filter(|median| **median > 0.0)?;
        let i = forces.iter().position(|force| *force >= half)?;
        Some(self.positions[i] - origin - compliance * (forces[i] + background))
    }

    /// The origin of a machine of this compliance for which the steepest chord over a tenth of the readings meets the zero of the force
    /// of the contacts at X = 0, if that force rises.
    pub(super) fn tangent_origin(&self, compliance: f64) -> Option<f64> {
        let Machine { offset, background, trend, .. } = self.machine;
        let (i, slope) = self.steepest_chord()?;
        let (position, force) = (self.positions[i], self.forces[i]);
        // The force of the contacts alone does not change with the trend.
        let rise = Some(slope - trend).filter(|rise| *rise > 0.0)?;
        let zero = position - (force - offset - background - trend * position) / rise;
        Some(zero - compliance * background)
    }

    /// The mean distance of two readings.
    pub(super) fn spacing(&self) -> f64 {
        self.range() / (self.positions.len() - 1).max(1) as f64
    }

    /// From the first position to the last.
    pub(super) fn range(&self) -> f64 {
        self.positions[self.positions.len() - 1] - self.positions[0]
    }

    /// The largest force, or 1 where none was measured: the scale of forces.
    pub(super) fn scale(&self) -> f64 {
        let largest = self.forces.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        if largest > 0.0 { largest } else { 1.0 }
    }

    /// # Errors
    /// Positions that do not rise; those of [`Self::check_readings`].
    pub(crate) fn check(&self) -> Result<()> {
        self.check_readings()?;
        self.check_order()
    }

    /// # Errors
    /// Positions that do not rise.
    fn check_order(&self) -> Result<()> {
        let Some(i) = self.positions.windows(2).position(|pair| pair[0] >= pair[1]) else { return Ok(()) };
        let expected = format!(
            "positions that rise, or the means of more readings where their sensor is noisy: one above {}",
            self.positions[i]
        );
        Err(Error::invalid(format!("position.{}", i + 1), expected, self.positions[i + 1]))
    }

    /// The checks of all but the order of the readings.
    ///
    /// # Errors
    /// Fewer than two positions; numbers that are not finite; forces, but not one for each position; members that are not as many,
    /// do not rise or are not around their reading; a machine with a compliance or a background force below 0.
    pub(crate) fn check_readings(&self) -> Result<()> {
        if self.positions.len() < 2 {
            return Err(Error::invalid("position", "two positions or more", self.positions.len()));
        }
        for (key, values) in [("position", &self.positions), ("force", &self.forces)] {
            all_finite(key, values)?;
        }
        if !self.forces.is_empty() {
            as_many("force", self.forces.len(), (self.positions.len(), "forces, one for each position"))?;
        }
        if !self.members.is_empty() && self.members.len() != self.positions.len() {
            let expected = format!("members of {} readings, or of none", self.positions.len());
            return Err(Error::invalid("members", expected, self.members.len()));
        }
        for (i, members) in self.members.iter().enumerate() {
            let rising = members.is_sorted();
            let around = |&at: &f64| {
                members.first().is_some_and(|low| *low <= at)
                    && members.last().is_some_and(|high| at <= *high)
            };
            if !rising || !around(&self.positions[i]) {
                let expected = "rising positions around that of the reading";
                return Err(Error::invalid("members", expected, format!("others for reading {i}")));
            }
        }
        self.machine.check()
    }
}

impl Machine {
    fn check(self) -> Result<()> {
        not_negative("compliance", self.compliance)?;
        not_negative("background", self.background)?;
        for (key, value) in [("offset", self.offset), ("trend", self.trend), ("origin", self.origin)] {
            finite(key, value)?;
        }
        Ok(())
    }
}

impl ErrorModel {
    /// # Errors
    /// Numbers that are not above 0; a drift that varies over a quarter of `range` or more, which is no noise: it could
    /// follow the curve itself.
    pub(super) fn check(self, range: f64) -> Result<()> {
        if let Some(reading) = self.reading {
            positive("reading", reading)?;
        }
        if let Some(position) = self.position {
            positive("position_error", position)?;
        }
        let Some(longest) = self.drift else { return Ok(()) };
        positive("drift.longest", longest)?;
        if longest >= 0.25 * range {
            let expected = format!("a length below {}, a quarter of the range of positions", 0.25 * range);
            return Err(Error::invalid("drift.longest", expected, longest));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_readings_are_averaged_and_so_are_the_last_ones() {
        let measured = Measurement::new(vec![1.0, 2.0, 4.0, 5.0, 7.0], vec![2.0, 4.0, 1.0, 0.0, 3.0]);
        let averaged = measured.average(2).unwrap();
        // By hand; these sums are exact.
        let Measurement { positions, forces, members, .. } = averaged.clone();
        assert_eq!((positions, forces), (vec![1.5, 4.5, 7.0], vec![3.0, 0.5, 3.0]));
        assert_eq!(members, [vec![1.0, 2.0], vec![4.0, 5.0], vec![7.0]]);
        // Of four pairs, two are a reading with itself.
        assert_eq!([0, 1, 2].map(|i| averaged.distance(i, i)), [0.5, 0.5, 0.0]);
        let once = measured.average(4).unwrap();
        // 2 (1 + 3 + 4 + 2 + 3 + 1)/16 of all pairs.
        assert_eq!(once.distance(0, 0), 1.75);
        assert_eq!(averaged.average(2).unwrap(), once);
        assert_eq!(measured.average(1).unwrap(), measured);
        let planned = Measurement::new(measured.positions.clone(), Vec::new());
        assert_eq!(planned.average(5).unwrap().positions, [3.8]);
        assert!(planned.average(5).unwrap().forces.is_empty());
    }

    /// Positions of a noisy sensor do not rise; their means do.
    #[test]
    fn readings_at_positions_that_do_not_rise_are_averaged_where_the_means_do() {
        let averaged =
            Measurement::new(vec![1.0, 3.0, 2.0, 5.0], vec![4.0, 2.0, 1.0, 3.0]).average(2).unwrap();
        assert_eq!((&averaged.positions, &averaged.forces), (&vec![2.0, 3.5], &vec![3.0, 2.0]));
        assert_eq!(averaged.members, [vec![1.0, 3.0], vec![2.0, 5.0]]);
        assert_eq!(averaged.last(), 5.0);
        let backwards = Measurement::new(vec![2.0, 1.0, 4.0, 3.0], vec![0.0; 4]).average(2).unwrap();
        assert_eq!(backwards.members, [vec![1.0, 2.0], vec![3.0, 4.0]]);
    }

    /// The force 2X from X = 0 on, read with a background, an offset and a trend behind a spring.
    #[test]
    fn the_tangent_of_a_straight_line_meets_the_origin() {
        let machine = Machine { compliance: 0.25, background: 3.0, offset: -1.0, trend: 0.5, origin: 7.0 };
        let readings = (0..20).map(|i| {
            let x = 0.1 * f64::from(i);
            let y = machine.origin + x + machine.compliance * (2.0 * x + machine.background);
            (y, 2.0 * x + machine.background + machine.offset + machine.trend * y)
        });
        let (positions, forces) = readings.unzip();
        let measured = Measurement { machine, ..Measurement::new(positions, forces) };
        // Rounding of numbers of the size of 10.
        assert!((measured.tangent_origin(0.25).unwrap() - 7.0).abs() < 1e-13);
    }

    #[test]
    fn what_cannot_be_averaged_is_refused() {
        let measured = Measurement::new(vec![1.0, 2.0, 1.5, 5.0], vec![0.0; 4]);
        assert!(measured.average(0).unwrap_err().to_string().starts_with("average: expected"));
        assert!(measured.average(1).unwrap_err().to_string().starts_with("position.2: expected"));
        // The means 2 and 1.5 do not rise.
        let falling = Measurement::new(vec![1.0, 3.0, 1.5], vec![0.0; 3]);
        assert!(falling.average(2).unwrap_err().to_string().starts_with("position.1: expected"));
        let fewer = Measurement::new(vec![1.0, 2.0, 3.0], vec![0.0; 2]);
        assert!(fewer.average(2).unwrap_err().to_string().starts_with("force: expected 3 forces"));
    }
}
