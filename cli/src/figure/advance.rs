//! The variable along which an interface advances: the drive, or the time of a protocol, in which the load point may be at
//! rest.

use asperity::record::{Record, Variable};
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

    /// A value in words.
    pub fn at(&self, outcome: &Outcome, value: f64) -> String {
        format!("{} = {}", self.symbol, style::value_of(outcome, value, self.points))
    }
}

/// Whether the load point of an interface follows a protocol.
pub fn is_in_time(record: &Record) -> bool {
    record.get("map_time").is_some()
}
