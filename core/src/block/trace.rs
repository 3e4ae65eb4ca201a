//! Records of a motion: equilibria, its end, and the time course of a slip.

use serde::{Deserialize, Serialize};

use crate::record::{Quantity, Record};

/// A state of the slider.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// The drive: X_T, X, or the imposed force.
    pub drive: f64,
    /// Position X of the slider's base.
    pub position: f64,
    /// Friction force F.
    pub force: f64,
    /// Force of the spring, K(X_T − X); equal to F in equilibrium.
    pub spring_force: f64,
}

/// The end of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum End {
    /// The drive reached its last value.
    Reached,
    /// The slider ran away under an imposed force: from this state there was no equilibrium within a hundred times the mean
    /// stretch of contacts that carry the force.
    Runaway(Point),
}

/// Largest number of points of a time course.
const MOST: usize = 4096;

/// Fraction of the displacement before which a time course is cut: a motion leaves an instability infinitely slowly.
const BEGUN: f64 = 1e-2;

/// The time course of an inertial slip.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SlipCourse {
    /// Time since the slider had moved by a hundredth of its displacement.
    pub time: Vec<f64>,
    /// Position X.
    pub position: Vec<f64>,
    /// Velocity Ẋ.
    pub velocity: Vec<f64>,
    /// Friction force F.
    pub force: Vec<f64>,
    /// Force of the spring, K(X_T − X).
    pub spring_force: Vec<f64>,
    /// One of `stride` offered points is kept.
    stride: usize,
    offered: usize,
}

impl SlipCourse {
    /// Removes all points.
    pub(super) fn clear(&mut self) {
        self.columns().into_iter().for_each(Vec::clear);
        (self.stride, self.offered) = (1, 0);
    }

    /// Keeps one of `stride` points. At [`MOST`] points every other one is dropped, and the stride doubles.
    pub(super) fn offer(&mut self, time: f64, velocity: f64, point: Point) {
        self.offered += 1;
        if !self.offered.is_multiple_of(self.stride) {
            return;
        }
        if self.time.len() == MOST {
            self.columns().into_iter().for_each(every_other);
            self.stride *= 2;
        }
        self.push(time, velocity, point);
    }

    /// Keeps a point in any case.
    pub(super) fn push(&mut self, time: f64, velocity: f64, point: Point) {
        let values = [time, point.position, velocity, point.force, point.spring_force];
        for (column, value) in self.columns().into_iter().zip(values) {
            column.push(value);
        }
    }

    /// Removes the slow start of the motion, and sets the time to 0 at the new first point.
    pub(super) fn begun(mut self) -> Self {
        let (Some(&first), Some(&last)) = (self.position.first(), self.position.last()) else { return self };
        let hidden = |x: &f64| (x - first).abs() < BEGUN * (last - first).abs();
        let skipped = self.position.iter().take_while(|x| hidden(x)).count();
        for column in self.columns() {
            column.drain(..skipped);
        }
        let start = self.time.first().copied().unwrap_or(0.0);
        self.time.iter_mut().for_each(|time| *time -= start);
        self
    }

    fn columns(&mut self) -> [&mut Vec<f64>; 5] {
        let Self { time, position, velocity, force, spring_force, .. } = self;
        [time, position, velocity, force, spring_force]
    }
}

fn every_other(column: &mut Vec<f64>) {
    let mut index = 0;
    column.retain(|_| {
        index += 1;
        index % 2 == 0
    });
}

/// The columns of `trace.csv`.
pub(super) fn record(trace: &[Point], drive: Quantity) -> Record {
    let mut record = Record::default();
    let mut column = |name: &str, long_name: &str, quantity, value: fn(&Point) -> f64| {
        record.push(name, long_name, quantity, &["point"], trace.iter().map(value).collect());
    };
    column("drive", "drive", drive, |p| p.drive);
    column("position", "position of the slider's base", Quantity::Length, |p| p.position);
    column("force", "friction force", Quantity::Force, |p| p.force);
    column("spring_force", "force of the spring", Quantity::Force, |p| p.spring_force);
    record
}
