//! A quasistatic drive through its turning points, and its results.

use super::events::{self, Event, Sizes};
use super::quasistatic::QuasistaticRun;
use super::regime::Jump;
use super::trace::{self, End, Point, SlipCourse};
use super::{Block, EnergyBalance, Loading, Regime, regime};
use crate::monitor::{Monitor, fits};
use crate::population::{Direction, Population};
use crate::record::{Quantity, Record};
use crate::{Error, Result};

/// The path of the drive, from its equilibrium value at the start through turning points, back and forth.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Values of the drive (X_T; X of a rigid slider; an imposed force) at which it turns; the last one is its end.
    pub turning_points: Vec<f64>,
    /// Number of points of the trace, evenly spaced along the path of the drive, both ends included. Turning points and
    /// the points before and after every slip are added to them.
    pub points: usize,
}

impl Drive {
    /// Forward to `position`, with a trace of 2001 points.
    pub fn to(position: f64) -> Self {
        Self { turning_points: vec![position], points: 2001 }
    }
}

/// Results of a quasistatic drive.
#[derive(Debug, Clone, PartialEq)]
pub struct StickSlip {
    /// The trace, a sequence of equilibria.
    pub trace: Vec<Point>,
    /// The slips.
    pub events: Vec<Event>,
    /// Size statistics of all events, including those too small for a slip.
    pub sizes: Sizes,
    /// Time course of the first inertial slip.
    pub course: Option<SlipCourse>,
    /// Energy balance of the whole drive, or up to the start of a runaway.
    pub energy: EnergyBalance,
    /// The kind of sliding since the last turn of the drive.
    pub regime: Regime,
    /// The end of the drive.
    pub end: End,
    loading: Loading,
}

impl StickSlip {
    /// The trace: `drive`, `position`, `force`, `spring_force`.
    pub fn trace_record(&self) -> Record {
        trace::record(&self.trace, self.loading.drive_quantity())
    }

    /// The slips: `drive`, `position_before`, `position_after`, `position_turn`, `force_before`, `force_after`,
    /// `drop`, `slip`, `broken_fraction`, `dissipated_breaks`, `dissipated_slip`.
    pub fn events_record(&self) -> Record {
        events::record(&self.events, self.loading.drive_quantity())
    }

    /// The columns of a trace and of slips, without values, for a slider whose top is moved.
    pub fn columns() -> [Record; 2] {
        [trace::record(&[], Quantity::Length), events::record(&[], Quantity::Length)]
    }
}

/// A part of the drive between two turns.
struct DriveSegment {
    direction: Direction,
    /// Values of the drive at which a point of the trace is requested; the last one is its end.
    requested: Vec<f64>,
}

/// See [`Block::start`].
pub(super) fn start(block: &Block, population: &mut dyn Population) -> Result<f64> {
    Ok(QuasistaticRun::new(block, population, &mut ())?.drive())
}

/// See [`Block::pull`].
pub(super) fn pull(
    block: &Block,
    population: &mut dyn Population,
    drive: &Drive,
    monitor: &mut dyn Monitor,
) -> Result<StickSlip> {
    let mut run = QuasistaticRun::new(block, population, monitor)?;
    let (start, unloading) = (run.drive(), run.first_unloading()?);
    let segments = segments(start, drive)?;
    run.path_length.0 = length(start, &drive.turning_points);
    run.trace.push(run.point());
    let (mut end, mut first) = (End::Reached, 0);
    for segment in &segments {
        first = run.events.len();
        if let Some(point) = run.follow_segment(segment.direction, &segment.requested)? {
            run.trace.push(point);
            end = End::Runaway(point);
            break;
        }
    }
    if end == End::Reached {
        run.close();
        run.path.report_progress(1.0)?;
    }
    // The largest mean stretch of the contacts: the largest force over their stiffness N⟨k⟩.
    let stretch = run.trace.iter().fold(0.0, |most: f64, point| most.max(point.force.abs()));
    let stretch = (stretch - block.background) / unloading;
    let jumps: Vec<Jump> =
        run.events[first..].iter().map(|e| Jump { before: e.before, after: e.after }).collect();
    let regime = regime::classify(&jumps, run.memory.segment_start, run.point(), stretch, end);
    let QuasistaticRun { trace, events, sizes, course, memory, .. } = run;
    Ok(StickSlip { trace, events, sizes, course, energy: memory.energy, regime, end, loading: block.loading })
}

/// Bytes of a point of the trace, with where it was asked for.
const POINT: u64 = (size_of::<Point>() + size_of::<f64>()) as u64;
/// Bytes that a trace may take.
const ALLOWED: u64 = 16 << 30;

/// The segments of a drive that starts at `start`.
fn segments(start: f64, drive: &Drive) -> Result<Vec<DriveSegment>> {
    let Drive { turning_points, points } = drive;
    if *points < 2 {
        return Err(Error::invalid("points", "at least the 2 ends", points));
    }
    fits("points", format!("a trace of {points} points"), (*points as u64).saturating_mul(POINT), ALLOWED)?;
    turns(start, turning_points)?;
    let total = length(start, turning_points);
    let (mut segments, mut done, mut from) = (Vec::new(), 0.0, start);
    for &to in turning_points {
        let (width, sign) = ((to - from).abs(), (to - from).signum());
        let spacing = total / (points - 1) as f64;
        // Points are evenly spaced along the whole path, not on each segment.
        let first = (done / spacing).floor() as usize + 1;
        let inside = (first..*points).map(|i| i as f64 * spacing - done);
        let inside = inside.take_while(|a| *a < width * (1.0 - 1e-12)).map(|a| from + sign * a);
        let requested = inside.chain([to]).collect();
        let direction = if sign > 0.0 { Direction::Forward } else { Direction::Backward };
        segments.push(DriveSegment { direction, requested });
        (done, from) = (done + width, to);
    }
    Ok(segments)
}

/// Path length from `start` through all turning points.
fn length(start: f64, turning_points: &[f64]) -> f64 {
    let from = std::iter::once(&start).chain(turning_points);
    from.zip(turning_points).map(|(from, to)| (to - from).abs()).sum()
}

/// Refuses a drive without turning points, or one that does not turn at each of them.
fn turns(start: f64, turning_points: &[f64]) -> Result<()> {
    let wrong = |found: String| {
        let expected =
            format!("finite values, each on the other side of the one before (the first is {start})");
        Err(Error::invalid("turning_points", expected, found))
    };
    let [first, ..] = turning_points else { return wrong("none".to_owned()) };
    if let Some(bad) = turning_points.iter().find(|x| !x.is_finite()) {
        return wrong(bad.to_string());
    }
    if *first == start {
        return wrong(first.to_string());
    }
    let all: Vec<f64> = std::iter::once(start).chain(turning_points.iter().copied()).collect();
    match all.windows(3).find(|x| (x[1] - x[0]) * (x[2] - x[1]) >= 0.0) {
        Some(x) => wrong(format!("{} after {} and {}", x[2], x[0], x[1])),
        None => Ok(()),
    }
}
