//! `slip_rate`: the velocity of the cells of a chain over time, and step by step, which shows how events grow, with a
//! logarithmic colour scale, and the waves that start with the largest event.

use std::ops::Range;
use std::sync::Arc;

use asperity::record::Variable;
use asperity_runner::output::Outcome;
use kuva::plot::ColorMap;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::render::Scene;

use super::curve::{Point, line};
use super::field::{self, Field, Shown, bar};
use super::grid::Grid;
use super::style::{self, Page, Plots};
use super::{front_lines, legend, ticks};

/// Decades below the highest velocity of the drive that are shown: slower cells hold.
const BELOW: f64 = 3.0;
/// Decades that are shown where the drive is at rest.
const DECADES: f64 = 6.0;
/// Width of the panel of the colour scale.
const BAR: f64 = 95.0;
const HEIGHT: f64 = 420.0;
/// Colour of the line of waves, which is seen on the dark and the bright cells.
const WAVES: &str = "#56B4E9";
/// Panels with rates.
const PANELS: usize = 2;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let cells = record.length("cell")?;
    let rates = record.get("slip_rate")?;
    let (time, step) = (record.get("slip_rate_time")?, record.get("slip_rate_step")?);
    let ends = exponents(&rates.values, fastest(time, record.get("slip_rate_drive")?));
    let colours: Vec<f64> =
        rates.values.iter().map(|rate| rate.max(10_f64.powf(ends.0)).log10().min(ends.1)).collect();
    let panel = |along: &Variable, words: &str| {
        let (mut plots, layout) = panel((&colours, cells), ends, along, &style::axis(outcome, words, along));
        plots.extend(waves(outcome, cells, (time, along)).map(|waves| line(waves, WAVES, 1.4, None)));
        (plots, layout)
    };
    let (over_time, time_axes) = panel(time, "Time t");
    let (by_step, step_axes) = panel(step, "Step of the computation");
    let (scale, scale_axes) =
        bar(ends, &ColorMap::Inferno, &style::axis(outcome, "Slip rate of a cell", rates));
    let scale_axes =
        scale_axes.with_y_tick_step(1.0).with_y_tick_format(TickFormat::Custom(Arc::new(|exponent: f64| {
            style::power(exponent.round() + 0.0)
        })));
    let grid = Grid::new(1, 3, (0.5 * (page.width - BAR), page.height(HEIGHT)))
        .with_title(page.heading(&outcome.summary.title))
        .with_column_width(2, BAR);
    let scene = ticks::panels(grid, vec![over_time, by_step, scale], vec![time_axes, step_axes, scale_axes]);
    let speed = outcome.summary.numbers.catalogue().filter(|catalogue| catalogue.largest.is_some());
    let entry = speed.and_then(|of| of.wave_speed).map(|speed| front_lines::waves(outcome, speed, WAVES));
    Some(legend::placed(scene, entry.as_slice(), &[]))
}

/// Where long waves are that start with the largest event, for cells with a wave speed: cells, and values of `along` at the
/// times of their arrival.
fn waves(outcome: &Outcome, cells: usize, (time, along): (&Variable, &Variable)) -> Option<Vec<Point>> {
    let catalogue = outcome.summary.numbers.catalogue()?;
    let (speed, event) = (catalogue.wave_speed?, catalogue.largest?.event - 1);
    let start = *outcome.record.values("event_time")?.get(event)?;
    let epicentre = outcome.record.values("event_epicentre")?.get(event)? + 0.5;
    let arrival = |cell: f64| {
        let at = start + (cell - epicentre).abs() / speed;
        let next = time.values.partition_point(|&time| time <= at);
        let (before, after) = (next.checked_sub(1)?, Some(next).filter(|&next| next < time.values.len())?);
        let share = (at - time.values[before]) / (time.values[after] - time.values[before]);
        Some((cell, along.values[before] + share * (along.values[after] - along.values[before])))
    };
    Some((0..=2 * cells).filter_map(|half| arrival(0.5 * half as f64)).collect())
}

/// The highest velocity of the drive from one step to the next.
fn fastest(time: &Variable, drive: &Variable) -> f64 {
    let (times, drives) = (time.values.windows(2), drive.values.windows(2));
    times.zip(drives).map(|(time, drive)| (drive[1] - drive[0]) / (time[1] - time[0])).fold(0.0, f64::max)
}

/// The powers of ten at the ends of the colour scale: up to the highest velocity, from some decades below that of the drive.
fn exponents(rates: &[f64], velocity: f64) -> (f64, f64) {
    let highest = style::range([rates]).1;
    let top = if highest > 0.0 { highest.log10().ceil() } else { 0.0 };
    let low = if velocity > 0.0 { velocity.log10().floor() - BELOW } else { top - DECADES };
    (low.min(top - 1.0), top)
}

/// The logarithms of the velocities in rows that are evenly spaced along a variable.
fn panel(
    (colours, cells): (&[f64], usize),
    ends: (f64, f64),
    along: &Variable,
    label: &str,
) -> (Plots, Layout) {
    let values = &along.values;
    let (first, last) = style::range([values.as_slice()]);
    let count = values.len().min(field::most(PANELS));
    let steps = steps(values, (first, last), count);
    let rows: Vec<f64> = steps.into_iter().flat_map(|steps| fastest_of((colours, cells), steps)).collect();
    let last = if last > first { last } else { first + 1.0 };
    let field = Field { values: &rows, sides: [count, cells], x: (0.0, cells as f64), y: (first, last) };
    let layout = field::chain_axes(cells, field.y).with_y_label(label);
    (vec![field.plot_of(Shown::Largest, ends, &ColorMap::Inferno, PANELS)], layout)
}

/// The steps in each of so many rows between the ends of a variable: none is left out. In a row without a step the last one
/// before it holds.
fn steps(values: &[f64], (first, last): (f64, f64), rows: usize) -> Vec<Range<usize>> {
    let before = |row: usize| {
        let end = first + (last - first) * row as f64 / rows as f64;
        if row < rows { values.partition_point(|&at| at < end) } else { values.len() }
    };
    let row = |row: usize| {
        let (start, end) = (before(row), before(row + 1));
        if start < end { start..end } else { start.max(1) - 1..start.max(1) }
    };
    (0..rows).map(row).collect()
}

/// The highest velocity of each cell in these steps.
fn fastest_of((colours, cells): (&[f64], usize), steps: Range<usize>) -> Vec<f64> {
    let cell = |cell: usize| {
        steps.clone().map(|step| colours[step * cells + cell]).fold(f64::NEG_INFINITY, f64::max)
    };
    (0..cells).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_is_in_a_row_however_short_it_is() {
        // Three steps of an event at 5.1, and one at the end.
        let values = [0.0, 5.1, 5.11, 5.12, 9.0, 10.0];
        assert_eq!(steps(&values, (0.0, 10.0), 5), [0..1, 0..1, 1..4, 3..4, 4..6]);
        let colours = [-3.0, -3.0, -1.0, -3.0, -3.0, 0.0, -2.0, -3.0];
        assert_eq!(fastest_of((&colours, 2), 1..4), [-1.0, 0.0]);
    }
}
