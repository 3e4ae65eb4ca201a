//! Foreshocks and aftershocks: the rate of events around main shocks, averaged over these, and Omori's law for it.

use crate::Result;
use crate::monitor::{Monitor, report};
use crate::numerics::omori::{OmoriFit, fit_omori};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{Interface, MainShocks};
use crate::shape::Edges;
use crate::task::summary::{Fitted, MainShockNumbers, OmoriLaw};

use super::found::Found;

/// Bins of the rate per decade of the time from a main shock.
const PER_DECADE: usize = 5;

/// Decades below the window over which the rate is given.
const DECADES: usize = 6;

/// Pairs of events that are compared between two calls of the monitor: some milliseconds.
const ASKED: usize = 1 << 20;

/// Columns of the rate around main shocks; the first is a time, or for contacts without time a drive.
pub(super) const COLUMNS: [Column; 3] = [
    Column::new("shock_time", "time from the main shock", Quantity::Time, &["shock_time"]),
    Column::new(
        "aftershock_rate",
        "events after a main shock, over their mean rate",
        Quantity::Number,
        &["shock_time"],
    ),
    Column::new(
        "foreshock_rate",
        "events before a main shock, over their mean rate",
        Quantity::Number,
        &["shock_time"],
    ),
];

/// For contacts without time the first column is this one.
pub(super) const SHOCK_DRIVE: Column =
    Column::new("shock_drive", "drive from the main shock", Quantity::Length, &["shock_drive"]);

/// The rates around main shocks, along either of the two.
pub(in crate::task) const TABLES: [CsvTable; 2] = [
    CsvTable { file: "main_shocks.csv", columns: &COLUMNS, needed: COLUMNS[0] },
    CsvTable {
        file: "main_shocks.csv",
        columns: &[SHOCK_DRIVE, COLUMNS[1], COLUMNS[2]],
        needed: SHOCK_DRIVE,
    },
];

/// Events, by the variable along which they follow each other.
struct Events<'a> {
    interface: &'a Interface,
    at: Vec<f64>,
    size: Vec<f64>,
    epicentre: Vec<f64>,
}

/// Distances of other events from main shocks, after and before them.
struct Stacked {
    mains: usize,
    after: Vec<f64>,
    before: Vec<f64>,
}

/// The numbers of the main shocks of a catalogue, and the rate around them; `clock` is the column of events along which they follow
/// each other.
///
/// # Errors
/// Columns that cannot be read; stopped by the monitor.
pub fn read(
    interface: &Interface,
    clock: &str,
    found: &mut Found<'_>,
    record: &mut Record,
    monitor: &mut dyn Monitor,
) -> Result<Option<MainShockNumbers>> {
    let Some(chosen) = &interface.main_shocks else { return Ok(None) };
    let mut column = |name: &str| -> Result<Vec<f64>> {
        Ok(found.of_events(name)?.map(std::borrow::Cow::into_owned).unwrap_or_default())
    };
    let events =
        Events { interface, at: column(clock)?, size: column("size")?, epicentre: column("epicentre")? };
    let (Some(first), Some(last)) = (events.at.first(), events.at.last()) else { return Ok(None) };
    let span = last - first;
    let window = chosen.window * span / (events.at.len() as f64 - 1.0);
    if !(window.is_finite() && window > 0.0) {
        return Ok(None);
    }
    let stacked = events.around_mains(chosen, window, monitor)?;
    let share = events.share(chosen);
    // Mean number of events within the distance, per unit of the variable, around all main shocks.
    let mean = stacked.mains as f64 * share * events.at.len() as f64 / span;
    // Without main shocks there is no rate around them.
    if stacked.mains > 0 {
        add_rates(&stacked, (window, mean), clock, record);
    }
    let law = |times: &[f64]| fit_omori(times, window).map(omori);
    Ok(Some(MainShockNumbers {
        size: chosen.size,
        window,
        count: stacked.mains,
        aftershocks: stacked.after.len(),
        foreshocks: stacked.before.len(),
        aftershock_law: law(&stacked.after),
        foreshock_law: law(&stacked.before),
    }))
}

fn omori(fit: OmoriFit) -> OmoriLaw {
    OmoriLaw {
        exponent: Fitted { value: fit.exponent, error: fit.error },
        delay: fit.delay,
        background: fit.background,
    }
}

impl Events<'_> {
    /// Whether the epicentres of two events are within the distance.
    fn are_near(&self, chosen: &MainShocks, a: usize, b: usize) -> bool {
        let Some(distance) = chosen.distance else { return true };
        let columns = self.interface.cells[self.interface.cells.len() - 1];
        let [a, b] = [a, b].map(|event| self.epicentre[event] as usize);
        let sides = [self.interface.cells[0], columns];
        let places = match self.interface.cells.len() {
            1 => vec![(a, b, sides[0])],
            _ => vec![(a / columns, b / columns, sides[0]), (a % columns, b % columns, columns)],
        };
        places.into_iter().all(|(a, b, side)| {
            let apart = a.abs_diff(b);
            let around = if self.interface.edges == Edges::Periodic { side - apart } else { apart };
            apart.min(around) <= distance
        })
    }

    /// The events from one variable to another.
    fn between(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        self.at.partition_point(|&at| at < from)..self.at.partition_point(|&at| at <= to)
    }

    /// The main shocks, and the events around them.
    fn around_mains(&self, chosen: &MainShocks, window: f64, monitor: &mut dyn Monitor) -> Result<Stacked> {
        let mut stacked = Stacked { mains: 0, after: Vec::new(), before: Vec::new() };
        let (first, last) = (self.at[0], self.at[self.at.len() - 1]);
        let mut compared = 0;
        for main in 0..self.at.len() {
            let at = self.at[main];
            if self.size[main] < chosen.size as f64 || at - window < first || at + window > last {
                continue;
            }
            let all = self.between(at - window, at + window);
            compared += all.len();
            if compared > ASKED {
                compared = 0;
                report(monitor, 1.0)?;
            }
            let near = |&other: &usize| other != main && self.are_near(chosen, main, other);
            // Of two that are equally large the first is the main shock.
            let larger = |&other: &usize| {
                self.size[other] > self.size[main] || self.size[other] == self.size[main] && other < main
            };
            if all.clone().filter(near).any(|other| larger(&other)) {
                continue;
            }
            stacked.mains += 1;
            for other in all.filter(near) {
                let apart = self.at[other] - at;
                if other > main { stacked.after.push(apart) } else { stacked.before.push(-apart) }
            }
        }
        Ok(stacked)
    }

    /// The fraction of all events within the distance of a place, on average over the places of events.
    fn share(&self, chosen: &MainShocks) -> f64 {
        let Some(distance) = chosen.distance else { return 1.0 };
        let cells = &self.interface.cells;
        // Events are taken to be as frequent everywhere.
        let mean = |side: usize| {
            let within = |at: usize| match self.interface.edges {
                Edges::Periodic => side.min(2 * distance + 1),
                Edges::Open => side.min(at + distance + 1) - at.saturating_sub(distance),
            };
            (0..side).map(within).sum::<usize>() as f64 / (side * side) as f64
        };
        cells.iter().map(|&side| mean(side)).product()
    }
}

/// Adds the rates in bins of equal width on a logarithmic axis, those with events.
fn add_rates(stacked: &Stacked, (window, mean): (f64, f64), clock: &str, record: &mut Record) {
    let bins = PER_DECADE * DECADES;
    let edge = |bin: usize| window * 10f64.powf(bin as f64 / PER_DECADE as f64 - DECADES as f64);
    let rates = |times: &[f64]| {
        let mut counts = vec![0.0; bins];
        for &time in times {
            let place = PER_DECADE as f64 * ((time / window).log10() + DECADES as f64);
            if place >= 0.0 && time > 0.0 {
                counts[(place as usize).min(bins - 1)] += 1.0;
            }
        }
        (0..bins).map(|bin| counts[bin] / ((edge(bin + 1) - edge(bin)) * mean)).collect::<Vec<f64>>()
    };
    let centres = (0..bins).map(|bin| (edge(bin) * edge(bin + 1)).sqrt()).collect();
    let along = if clock == "time" { COLUMNS[0] } else { SHOCK_DRIVE };
    record.add(along, centres);
    for (column, times) in COLUMNS[1..].iter().zip([&stacked.after, &stacked.before]) {
        record.push(column.name, column.long_name, column.quantity, &[along.name], rates(times));
    }
}
