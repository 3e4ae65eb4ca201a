//! `space_time`: the forces along a chain during the drive, or over the time of a protocol, the cells that slip in events,
//! and the largest event.

use asperity_runner::output::Outcome;
use kuva::plot::{ColorMap, LegendEntry};
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::advance::Advance;
use super::field::{self, Field, bar, bar_width, scale};
use super::grid::Grid;
use super::style::{self, Page, Plots};
use super::{front_lines, legend, slipped, ticks};

/// Least width of the panel of the colour scale.
const BAR: f64 = 95.0;
const HEIGHT: f64 = 420.0;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let cells = record.length("cell")?;
    let ends = scale(record.values("cell_force")?);
    let along = Advance::of(record)?;
    let (plots, layout, slipped) = forces(outcome, &along, cells, ends)?;
    let mut entries: Vec<LegendEntry> = slipped.into_iter().collect();
    let (colours, axes) =
        bar(ends, &ColorMap::Viridis, &style::axis(outcome, "Force of a cell", record.get("cell_force")?));
    let (mut plots, mut layouts) = (vec![plots, colours], vec![layout, axes]);
    let mut structure = vec![vec![0], vec![1]];
    if let Some(largest) = front_lines::largest_event(outcome, &along, cells) {
        plots.push(largest.plots);
        layouts.push(largest.layout);
        entries.extend(largest.entries);
        structure.push(vec![2]);
    }
    let rows = if structure.len() > 2 { 2 } else { 1 };
    let width = bar_width(BAR, ends);
    let grid = Grid::new(rows, 2, (page.width - width, page.height(260.0)))
        .with_structure(structure)
        .with_title(page.heading(&outcome.summary.title))
        .with_row_height(0, page.height(HEIGHT))
        .with_column_width(1, width);
    Some(legend::placed(ticks::panels(grid, plots, layouts), &entries, &[2]))
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

/// The forces of the cells at the points of the trace, with the cells that slipped in events.
fn forces(
    outcome: &Outcome,
    along: &Advance<'_>,
    cells: usize,
    ends: (f64, f64),
) -> Option<(Plots, Layout, Option<LegendEntry>)> {
    let record = &outcome.record;
    let (first, last) = style::range([along.points.values.as_slice()]);
    let rows = rows(along, (first, last));
    // A row shows the cells at one drive and is centred there: of the first and the last one half is seen.
    let halves: Vec<usize> = rows.iter().flat_map(|&row| [row; 2]).collect();
    let seen = if rows.len() > 1 { &halves[1..halves.len() - 1] } else { &halves };
    let values: Vec<f64> =
        seen.iter().filter_map(|&row| record.row("cell_force", row)).flatten().copied().collect();
    let field =
        Field { values: &values, sides: [seen.len(), cells], x: (0.0, cells as f64), y: (first, last) };
    let mut plots = vec![field.plot(ends, &ColorMap::Viridis, 1)];
    let (marks, entry) = slipped::marks(record, along.events);
    plots.extend(marks);
    let layout =
        field::chain_axes(cells, (first, last)).with_y_label(style::axis(outcome, along.words, along.points));
    Some((plots, layout, entry))
}
