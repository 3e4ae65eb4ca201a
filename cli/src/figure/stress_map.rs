//! `stress_map`: the forces of the cells of a lattice at the requested drives, or times of a protocol, one panel each.

use asperity_runner::output::Outcome;
use kuva::plot::ColorMap;
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::advance::Advance;
use super::field::{self, Field, bar, bar_width, scale};
use super::fitting::whole_step;
use super::grid::Grid;
use super::style::{self, Page, Plots};
use super::ticks;

/// Largest number of panels; if there are more maps, some are left out.
const PANELS: usize = 6;
/// Least width and height of the panel of the colour scale.
const BAR: (f64, f64) = (95.0, 60.0);
/// Margins of a panel: left and right, above and below.
const SIDES: (f64, f64) = (56.0, 10.0);
const MARGINS: (f64, f64) = (30.0, 48.0);
/// Smallest width and height of a map, if fewer columns can make it larger.
const LEAST: (f64, f64) = (75.0, 40.0);
/// Largest height of a map.
const TALLEST: f64 = 600.0;
/// About so many ticks on an axis.
const TICKS: usize = 4;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let force = record.get("cell_force")?;
    let sides = [record.length("row")?, record.length("column")?];
    let along = Advance::of(record)?;
    let shown = style::chosen(along.maps.len(), PANELS);
    let size = sides[0] * sides[1];
    let values = |map: usize| &force.values[map * size..][..size];
    let ends = scale(&shown.iter().flat_map(|&map| values(map)).copied().collect::<Vec<_>>());
    let bar_width = bar_width(BAR.0, ends);
    let Arranged { columns, rows, map, air } = arranged(page.width - bar_width, sides, shown.len());
    let panel = |&map: &usize| -> (Plots, Layout) {
        let field =
            Field { values: values(map), sides, x: (0.0, sides[1] as f64), y: (0.0, sides[0] as f64) };
        let layout = axes(&field, air).with_title(along.at(outcome, along.maps[map]));
        (vec![field.plot(ends, &ColorMap::Viridis, shown.len())], layout)
    };
    let (mut plots, mut layouts): (Vec<_>, Vec<_>) = shown.iter().map(panel).unzip();
    // Empty cells of the grid of panels.
    for _ in shown.len()..rows * columns {
        plots.push(Plots::new());
        layouts.push(style::layout((0.0, 1.0), (0.0, 1.0)));
    }
    let (colours, colour_axes) =
        bar(ends, &ColorMap::Viridis, &style::axis(outcome, "Force of a cell", force));
    let order = shown.len().min(columns);
    plots.insert(order, colours);
    layouts.insert(order, colour_axes.with_force_margins_y(MARGINS.0, MARGINS.1));
    let grid = Grid::new(rows, columns + 1, (map.0 + SIDES.0 + SIDES.1, map.1 + air + MARGINS.0 + MARGINS.1))
        .with_structure(structure(rows, columns))
        .with_title(page.heading_of_some(&outcome.summary.title, [shown.len(), along.maps.len()], "maps"))
        .with_column_width(columns, bar_width);
    Some(ticks::panels(grid, plots, layouts))
}

/// The axes of a map with this much left free below it. Ticks are at whole numbers, as rows and columns are.
fn axes(field: &Field, air: f64) -> Layout {
    let [rows, columns] = field.sides.map(|side| side as f64);
    field::axes(field.x, field.y)
        .with_title_size(12)
        .with_x_tick_step(whole_step(columns, TICKS))
        .with_y_tick_step(whole_step(rows, TICKS))
        .with_tick_size(11)
        .with_label_size(13)
        .with_force_margins(SIDES.0, SIDES.1)
        .with_force_margins_y(MARGINS.0, MARGINS.1 + air)
        .with_x_label("Column")
        .with_x_label_offset(0.0, -air)
        .with_y_label("Row")
}

/// How maps are arranged.
struct Arranged {
    columns: usize,
    rows: usize,
    /// Width and height of a map.
    map: (f64, f64),
    /// What is left free below low maps, so that the colour scale is tall enough.
    air: f64,
}

/// Maps of square cells in up to three columns of this width together, fewer where they would be small.
fn arranged(width: f64, [rows, columns]: [usize; 2], maps: usize) -> Arranged {
    let square = rows as f64 / columns as f64;
    let across = |columns: usize| width / columns as f64 - SIDES.0 - SIDES.1;
    let is_large = |&columns: &usize| {
        let across = across(columns);
        across >= LEAST.0 && across * square >= LEAST.1
    };
    let most = maps.min(if maps == 4 { 2 } else { 3 });
    let columns = (1..=most).rev().find(is_large).unwrap_or(1);
    let rows = maps.div_ceil(columns);
    let height = (across(columns) * square).min(TALLEST);
    let air = if rows == 1 { (BAR.1 - height).max(0.0) } else { 0.0 };
    Arranged { columns, rows, map: (height / square, height), air }
}

/// Arranges panels row by row, with the colour scale next to the first row.
fn structure(rows: usize, columns: usize) -> Vec<Vec<usize>> {
    let width = columns + 1;
    let mut cells = Vec::new();
    for row in 0..rows {
        cells.extend((0..columns).map(|column| vec![row * width + column]));
        if row == 0 {
            cells.push((0..rows).map(|row| row * width + columns).collect());
        }
    }
    cells
}
