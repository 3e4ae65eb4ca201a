//! When the cells of the largest event of a chain began to slip, with its fronts and the waves that start with it.

use asperity::elastic::front;
use asperity::record::Quantity;
use asperity::shape::Edges;
use asperity_runner::input::edges;
use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, ScatterPlot};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use super::advance::Advance;
use super::curve::{Point, line};
use super::field::chain_axes;
use super::style::{self, BLUE, ORANGE, Plots, RED};

/// Points of the line of a front speed.
const FINE: u32 = 200;

/// The panel of the largest event, and what its lines are.
pub struct Largest {
    pub plots: Plots,
    pub layout: Layout,
    pub entries: Vec<LegendEntry>,
}

/// The times at which the cells of the largest event began to slip, and the speeds of its fronts.
pub fn largest_event(outcome: &Outcome, along: &Advance<'_>, cells: usize) -> Option<Largest> {
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
    let mut entries = Vec::new();
    for (name, sign) in [("left", -1.0), ("right", 1.0)] {
        let speed = record.values(&format!("event_front_speed_{name}"))?[largest.event - 1];
        let passed = row.front(&points, epicentre, sign > 0.0);
        if let Some(&middle) = passed.get(passed.len() / 2).filter(|_| speed.is_finite()) {
            // As far as the front has come.
            let (begin, end) = (passed[0].0, passed[passed.len() - 1].0);
            let places = (0..=FINE).map(|i| begin + (end - begin) * f64::from(i) / f64::from(FINE));
            let reached = places.map(|distance| (distance, middle.1 + (distance - middle.0) / speed));
            let reached = reached.filter(|point| point.1 >= first);
            plots.extend(
                row.lines(epicentre, sign, reached).map(|part| line(part, RED, 1.6, Some(style::DASHES))),
            );
            let words = format!("front to the {name}: {}", in_words(outcome, speed));
            entries.push(style::line(words, RED, Some(style::DASHES)));
        }
    }
    if let Some(speed) = outcome.summary.numbers.catalogue()?.wave_speed {
        for sign in [-1.0, 1.0] {
            // Around a periodic chain waves from both sides meet.
            let longest = if row.is_periodic() { 0.5 * row.cells } else { row.cells };
            let places = (0..=FINE).map(|i| longest * f64::from(i) / f64::from(FINE));
            let wave = places.map(|distance| (distance, first + distance / speed));
            plots.extend(row.lines(epicentre, sign, wave).map(|part| line(part, BLUE, 1.6, None)));
        }
        entries.push(waves(outcome, speed, BLUE));
    }
    plots.push(Plot::Scatter(ScatterPlot::new().with_data(points).with_color(ORANGE).with_size(1.6)));
    let at = along.events.get(largest.event - 1).copied().unwrap_or(largest.drive);
    let layout = chain_axes(cells, window)
        .with_title(format!("Largest event, at {}", along.at(outcome, at)))
        .with_title_size(12)
        .with_y_label(style::axis(outcome, "Beginning of slip", record.get("slipped_start")?));
    Some(Largest { plots, layout, entries })
}

/// What a line of waves with this speed is.
pub fn waves(outcome: &Outcome, speed: f64, colour: &str) -> LegendEntry {
    style::line(format!("waves: {}", in_words(outcome, speed)), colour, None)
}

/// A speed along the cells.
fn in_words(outcome: &Outcome, speed: f64) -> String {
    let rounded = style::digits((1e3 * speed).round() / 1e3);
    match outcome.summary.units.label(Quantity::Time).as_str() {
        "1" => format!("{rounded} cells per time"),
        unit => format!("{rounded} cells/{unit}"),
    }
}

/// The cells of a chain.
struct Row {
    cells: f64,
    edges: Edges,
}

impl Row {
    fn of(outcome: &Outcome, cells: usize) -> Self {
        Self { cells: cells as f64, edges: edges(&outcome.scenario) }
    }

    fn is_periodic(&self) -> bool {
        self.edges == Edges::Periodic
    }

    /// Distances from the epicentre to one side, and when slip had come so far.
    fn front(&self, points: &[Point], epicentre: f64, up: bool) -> Vec<Point> {
        // Points are at the middles of cells.
        let starts: Vec<(usize, f64)> = points.iter().map(|point| (point.0 as usize, point.1)).collect();
        let (first, times) = front(&starts, epicentre as usize, up, (self.cells as usize, self.edges));
        times.iter().enumerate().map(|(i, time)| ((first + i) as f64, *time)).collect()
    }

    /// Points at distances from the epicentre to one side as the lines that are seen: to the end of an open chain, and from the
    /// other end on in a periodic one.
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
            if now != 0.0 && !self.is_periodic() {
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
