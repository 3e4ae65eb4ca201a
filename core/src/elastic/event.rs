//! Events and their catalogue.

use serde::{Deserialize, Serialize};

use crate::record::{Quantity, Record};

/// A connected set of cells that slipped in one slide; with time-dependent contacts, from when the first of them begins to
/// slip until none slips.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Event {
    /// Load-point displacement X_T, a length.
    pub drive: f64,
    /// Time at which the first cell slipped; with time-independent contacts it counts slides only, and is NaN without viscosity. A slide
    /// begins where the balance is lost to the tolerance of the drive, and starts the more slowly the smaller that is: this time
    /// depends on it, as the duration of a slide does.
    pub time: f64,
    /// Number of the cell that slipped first; cells are counted from 0, row by row.
    pub epicentre: usize,
    /// Number of cells that slipped.
    pub cells: usize,
    /// Area of these cells; where cells have no area, the sum of their relative areas, which is their number unless they differ.
    pub area: f64,
    /// Integral of the slip over that area, a volume (the seismic moment without the modulus).
    pub moment: f64,
    /// Time from when the first cell slipped until the slide was over; NaN without viscosity.
    pub duration: f64,
    /// Speed at which the slip spread from the nucleation patch along the chain or the row towards smaller numbers, in cells per
    /// time; NaN where fewer than five cells slipped one after another.
    pub front_speed_left: f64,
    /// The same towards larger numbers.
    pub front_speed_right: f64,
    /// Mean position of the cells that slipped, weighted by their areas, before the event.
    pub position_before: f64,
    /// Mean position of these cells after the event.
    pub position_after: f64,
    /// Friction force of the whole interface before the slide; without time, the pull of drive and slider at this drive, before
    /// cells move.
    pub force_before: f64,
    /// Friction force of the whole interface after the slide.
    pub force_after: f64,
    /// Breaks, per contact of the interface.
    pub broken_fraction: f64,
    /// Energy dissipated in breaks of contacts of these cells.
    pub dissipated_breaks: f64,
    /// Energy dissipated by the slider at these cells. That of cells which a slide pulls along without a slip of their own is in
    /// the energy balance only.
    pub dissipated_slip: f64,
}

/// A cell that slipped in an event.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Slipped {
    /// Number of the cell, row by row.
    pub cell: usize,
    /// When it began to slip, after the first cell of the event: a time, or a number of steps without viscosity.
    pub start: f64,
    /// Slip, a length.
    pub slip: f64,
}

impl Event {
    /// Force drop of the slide.
    pub fn drop(&self) -> f64 {
        self.force_before - self.force_after
    }

    /// The columns of a catalogue without events, for cells that have an area.
    pub fn columns() -> Record {
        record(&[], Some(1.0))
    }

    /// Mean slip of the cells that slipped, weighted by their areas, a length.
    pub fn slip(&self) -> f64 {
        self.position_after - self.position_before
    }
}

/// A catalogue as the columns of `events.csv`; areas are counted in cells where a cell has no `area`.
pub(super) fn record(events: &[Event], area: Option<f64>) -> Record {
    let mut record = Record::default();
    let mut column = |name: &str, long_name: &str, quantity, value: &dyn Fn(&Event) -> f64| {
        record.push(name, long_name, quantity, &["event"], events.iter().map(value).collect());
    };
    let (length, force) = (Quantity::Length, Quantity::Force);
    let (energy, number, count) = (Quantity::Energy, Quantity::Number, Quantity::Count);
    column("drive", "drive at the event", length, &|e| e.drive);
    column("position_before", "mean position of the cells before", length, &|e| e.position_before);
    column("position_after", "mean position of the cells after", length, &|e| e.position_after);
    column("force_before", "force before", force, &|e| e.force_before);
    column("force_after", "force after", force, &|e| e.force_after);
    column("drop", "force drop", force, &Event::drop);
    column("slip", "mean slip of the cells", length, &Event::slip);
    column("broken_fraction", "breaks per contact", number, &|e| e.broken_fraction);
    column("dissipated_breaks", "energy lost in breaks at the cells that slipped", energy, &|e| {
        e.dissipated_breaks
    });
    column("dissipated_slip", "energy lost by the slider at the cells that slipped", energy, &|e| {
        e.dissipated_slip
    });
    column("time", "time", Quantity::Time, &|e| e.time);
    column("epicentre", "cell that slipped first", count, &|e| e.epicentre as f64);
    column("cells", "cells that slipped", count, &|e| e.cells as f64);
    let (area, moment) = area.map_or((number, length), |_| (Quantity::Area, Quantity::Volume));
    column("area", "area that slipped", area, &|e| e.area);
    column("moment", "slip times area", moment, &|e| e.moment);
    column("duration", "duration", Quantity::Time, &|e| e.duration);
    column("front_speed_left", "front speed to the left", Quantity::PerTime, &|e| e.front_speed_left);
    column("front_speed_right", "front speed to the right", Quantity::PerTime, &|e| e.front_speed_right);
    record
}
