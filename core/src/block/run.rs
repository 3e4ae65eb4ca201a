//! A drive through its turning points, and what came of it.

use super::events::{self, Event, Sizes};
use super::quasistatic::QuasistaticRun;
use super::regime::Jump;
use super::trace::{self, End, Point, SlipCourse};
use super::{Block, EnergyBalance, Loading, Regime, Slip, bearable, regime};
use crate::monitor::Monitor;
use crate::population::{Direction, Population};
use crate::record::{Quantity, Record};
use crate::{Error, Result};

/// How the drive goes: from where it is in balance at the start, forth, back, forth.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Values of the drive (X_T; X of a rigid slider; an imposed force) at which it turns, the end the last.
    pub turning_points: Vec<f64>,
    /// Points of the trace, evenly along the way of the drive, both ends included; turning points and points before
    /// and after every slip come on top.
    pub points: usize,
}

impl Drive {
    /// Forward to `position`, with a trace of 2001 points.
    pub fn to(position: f64) -> Self {
        Self { turning_points: vec![position], points: 2001 }
    }
}

/// What came of a drive.
#[derive(Debug, Clone, PartialEq)]
pub struct StickSlip {
    /// States of balance.
    pub trace: Vec<Point>,
    /// The slips.
    pub events: Vec<Event>,
    /// Statistics of all events, those too small for a slip too.
    pub sizes: Sizes,
    /// Time course of the first inertial slip.
    pub course: Option<SlipCourse>,
    /// Energies of the whole drive; of a runaway, up to where it began.
    pub energy: EnergyBalance,
    /// Whether the last part of the drive, since it last turned, was stick-slip.
    pub regime: Regime,
    /// How it ended.
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

    /// The columns of a trace and of slips, without values, of a slider whose top is moved.
    pub fn columns() -> [Record; 2] {
        [trace::record(&[], Quantity::Length), events::record(&[], Quantity::Length)]
    }
}

/// One way of the drive, without a turn.
struct DriveSegment {
    direction: Direction,
    /// Values of the drive at which a point is asked for, its end the last.
    asked: Vec<f64>,
}

/// See [`Block::pull`].
pub(super) fn pull(
    block: &Block,
    population: &mut dyn Population,
    drive: &Drive,
    monitor: &mut dyn Monitor,
) -> Result<StickSlip> {
    let mut walk = QuasistaticRun::new(block, population, monitor)?;
    let (start, unloading) = (walk.drive(), walk.unloading()?);
    if let (Loading::Force, Slip::Inertial { mass, damping }) = (block.loading, block.slip) {
        bearable(unloading, mass, damping).map_err(|e| e.under("slip.inertial"))?;
    }
    let legs = legs(start, drive)?;
    walk.path.0 = length(start, &drive.turning_points);
    walk.trace.push(walk.point());
    let (mut end, mut first) = (End::Reached, 0);
    for leg in &legs {
        first = walk.events.len();
        if let Some(point) = walk.leg(leg.direction, &leg.asked)? {
            walk.trace.push(point);
            end = End::Runaway(point);
            break;
        }
    }
    if end == End::Reached {
        walk.close();
        walk.look.tell(1.0)?;
    }
    let stretch = walk.trace.iter().fold(0.0, |most: f64, point| most.max(point.force.abs())) / unloading;
    let jumps: Vec<Jump> =
        walk.events[first..].iter().map(|e| Jump { before: e.before, after: e.after }).collect();
    let regime = regime::tell(&jumps, walk.memory.leg_start, walk.point(), stretch, end);
    let QuasistaticRun { trace, events, sizes, course, memory, .. } = walk;
    Ok(StickSlip { trace, events, sizes, course, energy: memory.energy, regime, end, loading: block.loading })
}

/// The legs of a drive that starts at `start`.
fn legs(start: f64, drive: &Drive) -> Result<Vec<DriveSegment>> {
    let Drive { turning_points, points } = drive;
    if *points < 2 {
        return Err(Error::invalid("points", "at least the 2 ends", points));
    }
    turns(start, turning_points)?;
    let path = length(start, turning_points);
    let (mut legs, mut done, mut from) = (Vec::new(), 0.0, start);
    for &to in turning_points {
        let (width, sign) = ((to - from).abs(), (to - from).signum());
        let spacing = path / (points - 1) as f64;
        let first = (done / spacing).floor() as usize + 1;
        let inside = (first..*points).map(|i| i as f64 * spacing - done);
        let inside = inside.take_while(|a| *a < width * (1.0 - 1e-12)).map(|a| from + sign * a);
        let asked = inside.chain([to]).collect();
        let direction = if sign > 0.0 { Direction::Forward } else { Direction::Backward };
        legs.push(DriveSegment { direction, asked });
        (done, from) = (done + width, to);
    }
    Ok(legs)
}

/// Length of the way from `start` through all turning points.
fn length(start: f64, turning_points: &[f64]) -> f64 {
    let from = std::iter::once(&start).chain(turning_points);
    from.zip(turning_points).map(|(from, to)| (to - from).abs()).sum()
}

/// Whether there are turning points, and the drive turns at each.
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
