//! Results of the drive of a slider as variables: trace, slips, the time course of one slip, and sizes of events.

use crate::block::{Size, Slide, StickSlip};
use crate::record::{Column, Quantity, Record, Variable};

const SLIP_TIME: Column = course_column("slip_time", "time since the first slip began", Quantity::Time);
const SLIP_POSITION: Column =
    course_column("slip_position", "position of the slider's base in the first slip", Quantity::Length);
const SLIP_VELOCITY: Column =
    course_column("slip_velocity", "velocity of the slider in the first slip", Quantity::Velocity);
const SLIP_FORCE: Column = course_column("slip_force", "friction force in the first slip", Quantity::Force);
const SLIP_SPRING_FORCE: Column =
    course_column("slip_spring_force", "force of the spring in the first slip", Quantity::Force);
const SIZE_EVENTS: Column = size_column("size_events", "number of events", Quantity::Count);
const SIZE_SLIP: Column = size_column("size_slip", "mean slip of an event", Quantity::Length);
const SIZE_DROP: Column = size_column("size_drop", "mean force drop of an event", Quantity::Force);
const SIZE: Column = size_column("size", "mean number of contacts broken in an event", Quantity::Number);

/// The variables of the first inertial slip, and of the sizes of events of the ensemble.
pub(super) const COLUMNS: [Column; 9] = [
    SLIP_TIME,
    SLIP_POSITION,
    SLIP_VELOCITY,
    SLIP_FORCE,
    SLIP_SPRING_FORCE,
    SIZE_EVENTS,
    SIZE_SLIP,
    SIZE_DROP,
    SIZE,
];

const fn course_column(name: &'static str, long_name: &'static str, quantity: Quantity) -> Column {
    Column::new(name, long_name, quantity, &["slip_time"])
}

const fn size_column(name: &'static str, long_name: &'static str, quantity: Quantity) -> Column {
    Column::new(name, long_name, quantity, &["size"])
}

/// The trace of a quasistatic motion, with its slips as variables `event_…`.
pub fn motion(run: &StickSlip) -> Record {
    joined(run.trace_record(), run.events_record())
}

/// The trace of a motion in time, with its slips as variables `event_…`.
pub fn motion_in_time(run: &Slide) -> Record {
    joined(run.trace_record(), run.events_record())
}

/// Moves the variables of `part` that have values to `record`, with `prefix` before their names and dimensions.
pub fn adopt(part: Record, prefix: &str, record: &mut Record) {
    for variable in part.variables.into_iter().filter(|v| !v.values.is_empty()) {
        let name = format!("{prefix}{}", variable.name);
        let dimensions = variable.dimensions.iter().map(|d| format!("{prefix}{d}")).collect();
        record.variables.push(Variable { name, dimensions, ..variable });
    }
}

/// `trace` with the variables of `events` appended under names `event_…`.
pub(super) fn joined(mut trace: Record, events: Record) -> Record {
    for slips in events.variables {
        let name = format!("event_{}", slips.name);
        trace.variables.push(Variable { name, ..slips });
    }
    trace
}

/// The time course of the first inertial slip; empty if there was none.
pub fn course(run: &StickSlip) -> Record {
    let mut record = Record::default();
    let Some(course) = &run.course else { return record };
    record.add(SLIP_TIME, course.time.clone());
    record.add(SLIP_POSITION, course.position.clone());
    record.add(SLIP_VELOCITY, course.velocity.clone());
    record.add(SLIP_FORCE, course.force.clone());
    record.add(SLIP_SPRING_FORCE, course.spring_force.clone());
    record
}

/// Numbers of events by size over an ensemble of `size` contacts, including those too small to count as slips.
pub fn sizes(run: &StickSlip, size: usize) -> Record {
    let mut record = Record::default();
    let bins: Vec<&Size> = run.sizes.bins.iter().filter(|bin| bin.events > 0).collect();
    let mut add = |column, value: &dyn Fn(&Size) -> f64| {
        record.add(column, bins.iter().map(|bin| value(bin)).collect());
    };
    add(SIZE_EVENTS, &|bin| bin.events as f64);
    add(SIZE_SLIP, &|bin| bin.slip / bin.events as f64);
    add(SIZE_DROP, &|bin| bin.drop / bin.events as f64);
    // Breaks are whole numbers, which a sum of fractions is but for rounding.
    add(SIZE, &|bin| (bin.broken * size as f64).round() / bin.events as f64);
    record
}
