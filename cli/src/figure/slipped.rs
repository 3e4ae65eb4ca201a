//! The cells that slipped in the events of a chain, as lines over runs of cells and dots on single ones.

use asperity::record::Record;
use kuva::plot::{LegendEntry, ScatterPlot};
use kuva::render::plots::Plot;

use super::curve::{Point, line};
use super::style::{self, BLACK, Plots, WHITE};

/// Largest number of events that are drawn.
const MOST: usize = 300;
/// Width of a line, and radius of a dot.
const WIDTH: f64 = 1.2;
const RADIUS: f64 = 1.4;
/// Width of the white edge of both, which are seen on dark cells, too.
const EDGE: f64 = 0.7;

/// Lines and dots at the drives or times of events, and what they are.
pub fn marks(record: &Record, along: &[f64]) -> (Plots, Option<LegendEntry>) {
    let events = events(record);
    if events.is_empty() {
        return (Plots::new(), None);
    }
    let at = |event: &Slipped| along[event.number - 1];
    let runs = events
        .iter()
        .take(MOST)
        .flat_map(|event| runs(&event.cells).into_iter().map(move |run| (run, at(event))));
    let (dots, lines): (Vec<_>, Vec<_>) = runs.partition(|((first, last), _)| first == last);
    let lines = lines.into_iter().map(|((first, last), at)| vec![(first, at), (last + 1.0, at)]);
    let lines: Vec<Vec<Point>> = lines.collect();
    let dots: Vec<Point> = dots.into_iter().map(|((cell, _), at)| (cell + 0.5, at)).collect();
    let mut plots = Plots::new();
    for (colour, edge) in [(WHITE, EDGE), (BLACK, 0.0)] {
        plots.extend(lines.iter().map(|points| line(points.clone(), colour, WIDTH + 2.0 * edge, None)));
        if !dots.is_empty() {
            let dots = ScatterPlot::new().with_data(dots.clone()).with_color(colour);
            plots.push(Plot::Scatter(dots.with_size(RADIUS + edge)));
        }
    }
    let words = match events.len() {
        ..=MOST => "cells that slipped in an event".to_owned(),
        all => format!("cells that slipped, {MOST} largest of {all} events"),
    };
    (plots, Some(style::line(words, BLACK, None)))
}

/// An event, counted from 1, with the cells that slipped in it in their order.
struct Slipped {
    number: usize,
    cells: Vec<f64>,
}

/// The events in which cells slipped, the largest first.
fn events(record: &Record) -> Vec<Slipped> {
    let column = |name: &str| record.values(name).unwrap_or_default();
    let (numbers, mut who) = (column("slipped_event"), column("slipped_cell"));
    let event = |run: &[f64]| {
        let (cells, rest) = who.split_at(run.len());
        who = rest;
        let mut cells = cells.to_vec();
        cells.sort_by(f64::total_cmp);
        cells.dedup();
        Slipped { number: run[0] as usize, cells }
    };
    let mut events: Vec<Slipped> = numbers.chunk_by(|a, b| a == b).map(event).collect();
    events.sort_by_key(|event| std::cmp::Reverse(event.cells.len()));
    events
}

/// The first and the last cell of each run of neighbours among cells in their order.
fn runs(cells: &[f64]) -> Vec<(f64, f64)> {
    cells.chunk_by(|a, b| b - a == 1.0).map(|run| (run[0], run[run.len() - 1])).collect()
}
