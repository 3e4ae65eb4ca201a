//! The slip rate of every cell at steps of the motion, a limited number of them.

use serde::{Deserialize, Serialize};

/// The velocities of all cells at steps in time whose numbers are multiples of a power of two. Steps are short in events and
/// long between them, so that events are resolved however short they are.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SlipRates {
    /// Largest number of recorded steps.
    #[serde(skip)]
    most: usize,
    /// The number of the step after the last one; the start has the number 0.
    next: u64,
    /// Every so many steps one is recorded.
    every: u64,
    time: Vec<f64>,
    drive: Vec<f64>,
    /// Step by step.
    velocity: Vec<f64>,
}

impl SlipRates {
    /// At most this number of steps, 2 or more.
    pub(super) fn new(most: usize) -> Self {
        Self { most: most.max(2), every: 1, ..Self::default() }
    }

    /// Largest number of recorded steps.
    pub(super) fn most(&self) -> usize {
        self.most
    }

    /// The same record, continued with at most so many steps.
    pub(super) fn with_most(self, most: usize) -> Self {
        Self { most: most.max(2), ..self }
    }

    /// Adds the next step, at this time and drive. If there are too many, every second one is left out, and from then on half
    /// as many are recorded.
    pub(super) fn add(&mut self, time: f64, drive: f64, velocities: impl ExactSizeIterator<Item = f64>) {
        let number = self.next;
        self.next += 1;
        if !number.is_multiple_of(self.every) {
            return;
        }
        while self.time.len() >= self.most {
            self.every *= 2;
            thin(&mut self.time, 1);
            thin(&mut self.drive, 1);
            thin(&mut self.velocity, velocities.len());
        }
        if !number.is_multiple_of(self.every) {
            return;
        }
        self.time.push(time);
        self.drive.push(drive);
        self.velocity.extend(velocities);
    }

    /// Numbers of the recorded steps.
    pub fn steps(&self) -> impl ExactSizeIterator<Item = u64> {
        let every = self.every;
        (0..self.time.len()).map(move |i| i as u64 * every)
    }

    /// Times t of the recorded steps.
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// Load-point displacements X_T at the recorded steps.
    pub fn drive(&self) -> &[f64] {
        &self.drive
    }

    /// Velocities Ẋ_j of all cells at the recorded steps, of shape (steps, cells).
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }
}

/// Keeps every second row of this width, from the first one on.
fn thin(values: &mut Vec<f64>, width: usize) {
    let rows = values.len() / width;
    for row in 1..rows.div_ceil(2) {
        values.copy_within(2 * row * width..(2 * row + 1) * width, row * width);
    }
    values.truncate(rows.div_ceil(2) * width);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_longer_record_is_continued_with_fewer_steps() {
        let mut rates = SlipRates::new(100);
        let add = |rates: &mut SlipRates, step: u32| {
            rates.add(f64::from(step), 0.0, [f64::from(step)].into_iter());
        };
        (0..100).for_each(|step| add(&mut rates, step));
        let mut rates = rates.with_most(5);
        (100..200).for_each(|step| add(&mut rates, step));
        let numbers: Vec<f64> = rates.steps().map(|number| number as f64).collect();
        assert_eq!((rates.time(), rates.velocity()), (&*numbers, &*numbers));
        assert!(numbers.len() <= 5, "{numbers:?}");
    }

    #[test]
    fn steps_are_evenly_numbered_and_no_more_than_allowed() {
        for most in [2, 5, 8] {
            let mut rates = SlipRates::new(most);
            for step in 0..100_u32 {
                let step = f64::from(step);
                rates.add(step, 2.0 * step, [step, -step].into_iter());
                let numbers: Vec<f64> = rates.steps().map(|number| number as f64).collect();
                assert!(numbers.len() <= most && 2 * numbers.len() >= most.min(rates.next as usize));
                assert_eq!(rates.time(), numbers);
                assert_eq!(rates.drive(), numbers.iter().map(|n| 2.0 * n).collect::<Vec<_>>());
                assert_eq!(rates.velocity(), numbers.iter().flat_map(|n| [*n, -n]).collect::<Vec<_>>());
            }
        }
    }
}
