//! The variable along which an interface advances: the drive, or the time of a protocol, in which the load point may be at
//! rest.

use asperity::record::{Quantity, Record, Variable};
use asperity_runner::output::Outcome;

use super::style;

/// The variable, at the points of the trace, of the maps and of events.
pub struct Advance<'a> {
    /// Label without a unit.
    pub words: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// At the points of the trace.
    pub points: &'a Variable,
    /// Where the state of the cells is given.
    pub maps: &'a [f64],
    /// Of events.
    pub events: &'a [f64],
}

impl<'a> Advance<'a> {
    /// That of a record of an interface.
    pub fn of(record: &'a Record) -> Option<Self> {
        let (words, symbol, points, maps, events) = if is_in_time(record) {
            ("Time t", "t", "time", "map_time", "event_time")
        } else {
            ("Load-point displacement X_T", "X_T", "drive", "map_drive", "event_drive")
        };
        let values = |name: &str| record.values(name).unwrap_or_default();
        Some(Self { words, symbol, points: record.get(points)?, maps: values(maps), events: values(events) })
    }

    /// Where events end, which have a duration in time over contacts that depend on it, and none otherwise.
    pub fn ends(&self, record: &Record) -> Vec<f64> {
        let duration = record.get("event_duration").filter(|duration| duration.quantity == Quantity::Time);
        let times = (record.values("event_time"), record.values("time"));
        let (Some(duration), (Some(begin), Some(trace))) = (duration, times) else {
            return self.events.to_vec();
        };
        let end = |i: usize| between(trace, &self.points.values, begin[i] + duration.values[i]);
        (0..self.events.len()).map(|i| end(i).max(self.events[i])).collect()
    }

    /// A value in words.
    pub fn at(&self, outcome: &Outcome, value: f64) -> String {
        format!("{} = {}", self.symbol, style::value_of(outcome, value, self.points))
    }
}

/// The value at `time`, linear between those at the increasing times of a trace, and the last one after them.
fn between(times: &[f64], values: &[f64], time: f64) -> f64 {
    let next = times.partition_point(|t| *t < time).min(times.len() - 1);
    let last = next.saturating_sub(1);
    let share = ((time - times[last]) / (times[next] - times[last])).clamp(0.0, 1.0);
    if share.is_nan() { values[next] } else { values[last] + share * (values[next] - values[last]) }
}

/// Whether the load point of an interface follows a protocol.
pub fn is_in_time(record: &Record) -> bool {
    record.get("map_time").is_some()
}
