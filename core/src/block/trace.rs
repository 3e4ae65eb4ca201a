//! What is kept of a motion: points of equilibrium, how it ended, and the time course of a slip.

use serde::{Deserialize, Serialize};

use crate::record::{Quantity, Record};

/// A state of the slider.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// The drive: X_T, or X, or the imposed force.
    pub drive: f64,
    /// X, position of the slider's base.
    pub position: f64,
    /// F, friction force.
    pub force: f64,
    /// K(X_T − X), what pulls; F in balance.
    pub spring_force: f64,
}

/// How a drive ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// At its last displacement, or force.
    Reached,
    /// Under an imposed force the slider ran away: from here it found no balance within a hundred times the mean
    /// stretch of contacts that carry that force.
    Runaway(Point),
}

/// Most points of a course.
const MOST: usize = 4096;

/// A share of the way below which a motion has not begun for the eye: it leaves an instability infinitely slowly.
const BEGUN: f64 = 1e-2;

/// The time course of an inertial slip.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SlipCourse {
    /// Time since the slider had moved by a hundredth of the way to its arrest.
    pub time: Vec<f64>,
    /// X.
    pub position: Vec<f64>,
    /// Ẋ.
    pub velocity: Vec<f64>,
    /// F.
    pub force: Vec<f64>,
    /// K(X_T − X).
    pub spring_force: Vec<f64>,
    /// Points offered between two kept ones.
    stride: usize,
    offered: usize,
}

impl SlipCourse {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.columns().into_iter().for_each(Vec::clear);
        (self.stride, self.offered) = (1, 0);
    }

    /// Keeps a point, as far as there are not too many: then every other one is dropped.
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

    /// Keeps a point whatever there is.
    pub(super) fn push(&mut self, time: f64, velocity: f64, point: Point) {
        let values = [time, point.position, velocity, point.force, point.spring_force];
        for (column, value) in self.columns().into_iter().zip(values) {
            column.push(value);
        }
    }

    /// Drops what comes before the motion can be seen, and starts the clock there.
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
