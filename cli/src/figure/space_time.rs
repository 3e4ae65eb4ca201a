//! `space_time`: the forces along a chain during the drive, or over the time of a protocol, the cells that slip, and the fronts
//! of the largest event, with the waves that start with it.

use asperity::elastic::front;
use asperity::record::Record;
use asperity::shape::Edges;
use asperity_runner::input::edges;
use asperity_runner::output::Outcome;
use kuva::plot::{ColorMap, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::advance::Advance;
use super::curve::{Point, line};
use super::field::{self, Field, bar, scale};
use super::style::{self, BLACK, BLUE, ORANGE, Page, Plots, RED};
use super::ticks;

/// Smallest fraction of the cells in an event that is drawn.
const LARGE: f64 = 0.05;
/// Largest number of events that are drawn.
const MOST: usize = 300;
/// Points of the line of a front speed.
const FINE: u32 = 200;
/// Width of the panel of the colour scale.
const BAR: f64 = 95.0;
const HEIGHT: f64 = 420.0;
const DASHES: &str = "8 5";

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let cells = record.length("cell")?;
    let ends = scale(record.values("cell_force")?);
    let (plots, layout) = forces(outcome, cells, ends)?;
    let (colours, axes) =
        bar(ends, &ColorMap::Viridis, &style::axis(outcome, "Force of a cell", record.get("cell_force")?));
    let (mut plots, mut layouts) = (vec![plots, colours], vec![layout, axes]);
    let mut structure = vec![vec![0], vec![1]];
    if let Some((front, axes)) = largest_event(outcome, cells) {
        plots.push(front);
        layouts.push(axes);
        structure.push(vec![2]);
    }
    let rows = if structure.len() > 2 { 2 } else { 1 };
    let (title, size) = page.heading(&outcome.summary.title);
    let figure = Figure::new(rows, 2)
        .with_structure(structure)
        .with_title(title)
        .with_title_size(size)
        .with_cell_size(page.width - BAR, page.height(260.0))
        .with_row_height(0, page.height(HEIGHT))
        .with_col_width(1, BAR)
        .with_spacing(6.0);
    Some(ticks::panels(figure, plots, layouts))
}

/// The rows that are drawn: as many as there are points of the trace with maps, evenly spaced from one end of the trace to the
/// other, each the last one before its place.
fn rows(along: &Advance<'_>, (first, last): (f64, f64)) -> Vec<usize> {
    let points = &along.points.values;
    let among: Vec<usize> = (0..along.maps.len())
        .filter(|&row| points.binary_search_by(|point| point.total_cmp(&along.maps[row])).is_ok())
        .collect();
    let steps = among.len().max(2) - 1;
    let near = |i: usize| {
        // Half a step allows for the rounding of points that are evenly spaced.
        let value = first + (last - first) * (i as f64 + 0.5) / steps as f64;
        among[among.partition_point(|&row| along.maps[row] <= value).max(1) - 1]
    };
    (0..among.len()).map(near).collect()
}

/// The forces of the cells at the points of the trace, with the large events.
fn forces(outcome: &Outcome, cells: usize, ends: (f64, f64)) -> Option<(Plots, Layout)> {
    let record = &outcome.record;
    let along = Advance::of(record)?;
    let (first, last) = style::range([along.points.values.as_slice()]);
    let rows = rows(&along, (first, last));
    // A row shows the cells at one drive and is centred there: of the first and the last one half is seen.
    let halves: Vec<usize> = rows.iter().flat_map(|&row| [row; 2]).collect();
    let seen = if rows.len() > 1 { &halves[1..halves.len() - 1] } else { &halves };
    let values: Vec<f64> =
        seen.iter().filter_map(|&row| record.row("cell_force", row)).flatten().copied().collect();
    let field =
        Field { values: &values, sides: [seen.len(), cells], x: (0.0, cells as f64), y: (first, last) };
    let mut plots = vec![field.plot(ends, &ColorMap::Viridis, 1)];
    plots.extend(spans(record, along.events, cells).into_iter().map(|span| line(span, BLACK, 1.2, None)));
    let layout = panel((0.0, cells as f64), (first, last)).with_x_label("Cell").with_y_label(style::axis(
        outcome,
        along.words,
        along.points,
    ));
    Some((plots, layout))
}

/// For each large event a line at its drive or time, from the first to the last cell that took part in it.
fn spans(record: &Record, drives: &[f64], cells: usize) -> Vec<Vec<Point>> {
    let Some(slipped) = record.values("slipped_event") else { return Vec::new() };
    let who = record.values("slipped_cell").unwrap_or_default();
    let mut start = 0;
    let mut events: Vec<(usize, Vec<Point>)> = Vec::new();
    for run in slipped.chunk_by(|a, b| a == b) {
        let part = &who[start..start + run.len()];
        start += run.len();
        if (run.len() as f64) < LARGE * cells as f64 {
            continue;
        }
        let (low, high) = style::range([part]);
        let drive = drives[run[0] as usize - 1];
        events.push((run.len(), vec![(low, drive), (high + 1.0, drive)]));
    }
    events.sort_by_key(|event| std::cmp::Reverse(event.0));
    events.into_iter().take(MOST).map(|event| event.1).collect()
}

/// The times at which the cells of the largest event began to slip, and the speeds of its fronts.
fn largest_event(outcome: &Outcome, cells: usize) -> Option<(Plots, Layout)> {
    let record = &outcome.record;
    let largest = outcome.summary.numbers.catalogue()?.largest?;
    let columns =
        [record.values("slipped_event")?, record.values("slipped_cell")?, record.values("slipped_start")?];
    let [events, who, starts] = columns;
    let own = |&i: &usize| events[i] == largest.event as f64;
    let points: Vec<Point> = (0..events.len()).filter(own).map(|i| (who[i] + 0.5, starts[i])).collect();
    let times: Vec<f64> = points.iter().map(|point| point.1).collect();
    let (first, last) = style::range([times.as_slice()]);
    if last <= first || last.is_nan() {
        return None;
    }
    let epicentre = points.iter().find(|point| point.1 == first)?.0;
    let row = Row::of(outcome, cells);
    let air = 0.08 * (last - first);
    let window = (first - air, last + air);
    let mut plots: Plots = Vec::new();
    let mut words = Vec::new();
    for (name, sign) in [("left", -1.0), ("right", 1.0)] {
        let speed = record.values(&format!("event_front_speed_{name}"))?[largest.event - 1];
        let passed = row.front(&points, epicentre, sign);
        if let Some(&middle) = passed.get(passed.len() / 2).filter(|_| speed.is_finite()) {
            // As far as the front has come.
            let (begin, end) = (passed[0].0, passed[passed.len() - 1].0);
            let places = (0..=FINE).map(|i| begin + (end - begin) * f64::from(i) / f64::from(FINE));
            let reached = places.map(|distance| (distance, middle.1 + (distance - middle.0) / speed));
            let reached = reached.filter(|point| point.1 >= first);
            plots.extend(row.lines(epicentre, sign, reached).map(|part| line(part, RED, 1.6, Some(DASHES))));
            let rounded = style::digits((1e3 * speed).round() / 1e3);
            words.push(format!("{rounded} cells per time to the {name}"));
        }
    }
    if let Some(speed) = outcome.summary.numbers.catalogue()?.wave_speed {
        for sign in [-1.0, 1.0] {
            // Around a periodic chain waves from both sides meet.
            let longest = if row.is_periodic { 0.5 * row.cells } else { row.cells };
            let places = (0..=FINE).map(|i| longest * f64::from(i) / f64::from(FINE));
            let wave = places.map(|distance| (distance, first + distance / speed));
            plots.extend(row.lines(epicentre, sign, wave).map(|part| line(part, BLUE, 1.6, None)));
        }
        words.push(format!("waves (blue) {}", style::digits((1e3 * speed).round() / 1e3)));
    }
    plots.push(Plot::Scatter(ScatterPlot::new().with_data(points).with_color(ORANGE).with_size(1.6)));
    let speeds = if words.is_empty() { String::new() } else { format!(": {}", words.join(", ")) };
    let layout = panel((0.0, cells as f64), window)
        .with_title(format!("Largest event, at X_T = {}{speeds}", style::digits(largest.drive)))
        .with_title_size(12)
        .with_x_label("Cell")
        .with_y_label(style::axis(outcome, "Beginning of slip", record.get("slipped_start")?));
    Some((plots, layout))
}

/// The cells of a chain.
struct Row {
    cells: f64,
    is_periodic: bool,
}

impl Row {
    fn of(outcome: &Outcome, cells: usize) -> Self {
        Self { cells: cells as f64, is_periodic: edges(&outcome.scenario) == Edges::Periodic }
    }

    /// Distances from the epicentre to one side, and when slip had come so far.
    fn front(&self, points: &[Point], epicentre: f64, sign: f64) -> Vec<Point> {
        let half = if self.is_periodic { 0.5 * self.cells } else { self.cells };
        let distance = |cell: f64| {
            let distance = sign * (cell - epicentre);
            if self.is_periodic { distance.rem_euclid(self.cells) } else { distance }
        };
        let side = points.iter().map(|point| (distance(point.0), point.1));
        let side = side.filter(|point| (0.0..=half).contains(&point.0));
        let side: Vec<(usize, f64)> = side.map(|point| (point.0 as usize, point.1)).collect();
        let (first, times) = front(&side);
        times.iter().enumerate().map(|(i, time)| ((first + i) as f64, *time)).collect()
    }

    /// Points at distances from the epicentre to one side as the lines that are seen: to the end of an open chain, and from the other
    /// end on in a periodic one.
    fn lines(
        &self,
        epicentre: f64,
        sign: f64,
        points: impl Iterator<Item = Point>,
    ) -> impl Iterator<Item = Vec<Point>> {
        let mut lines: Vec<Vec<Point>> = Vec::new();
        let mut round = f64::NAN;
        for (distance, time) in points {
            let place = epicentre + sign * distance;
            let now = (place / self.cells).floor();
            if now != 0.0 && !self.is_periodic {
                break;
            }
            let at = (place - now * self.cells, time);
            match lines.last_mut().filter(|_| now == round) {
                Some(line) => line.push(at),
                None => lines.push(vec![at]),
            }
            round = now;
        }
        lines.into_iter()
    }
}

fn panel(x: (f64, f64), y: (f64, f64)) -> Layout {
    field::axes(x, y)
        .with_force_margins(style::SIDES.0, style::SIDES.1)
        .with_tick_size(11)
        .with_label_size(13)
}
