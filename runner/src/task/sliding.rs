//! What came of the drive of a slider, as variables: its trace and slips, the course of one, sizes of events.

use asperity::block::{Size, Sizes, Slide, StickSlip};
use asperity::record::{Quantity, Record, Variable};

/// The trace, and the slips as variables `event_…`.
pub fn motion(run: &StickSlip) -> Record {
    joined(run.trace_record(), run.events_record())
}

/// The same of a motion in time.
pub fn motion_in_time(run: &Slide) -> Record {
    joined(run.trace_record(), run.events_record())
}

/// Takes over the variables of a `part` that have values, `prefix` before their names and those of their dimensions.
pub fn adopt(part: Record, prefix: &str, record: &mut Record) {
    for variable in part.variables.into_iter().filter(|v| !v.values.is_empty()) {
        let name = format!("{prefix}{}", variable.name);
        let dimensions = variable.dimensions.iter().map(|d| format!("{prefix}{d}")).collect();
        record.variables.push(Variable { name, dimensions, ..variable });
    }
}

fn joined(mut trace: Record, events: Record) -> Record {
    for slips in events.variables {
        let name = format!("event_{}", slips.name);
        trace.variables.push(Variable { name, ..slips });
    }
    trace
}

/// The time course of the first inertial slip, if there was one.
pub fn course(run: &StickSlip) -> Record {
    let mut record = Record::default();
    let Some(course) = &run.course else { return record };
    let mut add = |name, words, quantity, values: &[f64]| {
        record.push(name, words, quantity, &["slip_time"], values.to_vec());
    };
    add("slip_time", "time since the first slip began", Quantity::Time, &course.time);
    add(
        "slip_position",
        "position of the slider's base in the first slip",
        Quantity::Length,
        &course.position,
    );
    add("slip_velocity", "velocity of the slider in the first slip", Quantity::Velocity, &course.velocity);
    add("slip_force", "friction force in the first slip", Quantity::Force, &course.force);
    add("slip_spring_force", "force of the spring in the first slip", Quantity::Force, &course.spring_force);
    record
}

/// How many events of each size there were over an ensemble of `size` contacts, small ones that are no slips among them.
pub fn sizes(run: &StickSlip, size: usize) -> Record {
    let mut record = Record::default();
    let bins = run.sizes.bins.iter().enumerate().filter(|(_, bin)| bin.events > 0);
    let (middles, bins): (Vec<f64>, Vec<Size>) = bins.map(|(i, bin)| (Sizes::middle(i), *bin)).unzip();
    let along = &["size"];
    let mut add = |name, words, quantity, value: &dyn Fn(&Size) -> f64| {
        record.push(name, words, quantity, along, bins.iter().map(value).collect());
    };
    add("size_events", "number of events", Quantity::Number, &|bin| bin.events as f64);
    add("size_slip", "mean slip of an event", Quantity::Length, &|bin| bin.slip / bin.events as f64);
    add("size_drop", "mean force drop of an event", Quantity::Force, &|bin| bin.drop / bin.events as f64);
    let contacts = middles.iter().map(|share| share * size as f64).collect();
    record.push("size", "number of contacts broken in an event", Quantity::Number, along, contacts);
    record
}
