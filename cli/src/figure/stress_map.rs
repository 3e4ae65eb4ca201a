//! `stress_map`: the forces of the cells of a lattice at the requested drives, one panel each.

use asperity_runner::output::Outcome;
use kuva::plot::ColorMap;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::field::{self, Field, bar, scale};
use super::style::{self, Page, Plots};
use super::ticks;

/// Largest number of panels; if there are more maps, some are left out.
const PANELS: usize = 6;
/// Width of the panel of the colour scale.
const BAR: f64 = 95.0;
/// Margins of a panel: left and right, above and below.
const SIDES: (f64, f64) = (56.0, 10.0);
const MARGINS: (f64, f64) = (30.0, 48.0);
/// Smallest and largest height of a map.
const HEIGHTS: (f64, f64) = (60.0, 600.0);

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let (drives, force) = (record.values("map_drive")?, record.get("cell_force")?);
    let sides = [record.length("row")?, record.length("column")?];
    let shown = chosen(drives.len());
    let size = sides[0] * sides[1];
    let columns = shown.len().min(if shown.len() == 4 { 2 } else { 3 });
    let rows = shown.len().div_ceil(columns);
    let ends =
        scale(&shown.iter().flat_map(|&map| force.values[map * size..][..size].to_vec()).collect::<Vec<_>>());
    let panel = |&map: &usize| -> (Plots, Layout) {
        let field = Field {
            values: &force.values[map * size..][..size],
            sides,
            x: (0.0, sides[1] as f64),
            y: (0.0, sides[0] as f64),
        };
        let layout = field::axes(field.x, field.y)
            .with_title(format!("X_T = {}", style::digits(drives[map])))
            .with_title_size(12)
            .with_ticks(4)
            .with_tick_size(11)
            .with_label_size(13)
            .with_force_margins(SIDES.0, SIDES.1)
            .with_force_margins_y(MARGINS.0, MARGINS.1)
            .with_x_label("Column")
            .with_y_label("Row");
        (vec![field.plot(ends, &ColorMap::Viridis, shown.len())], layout)
    };
    let (mut plots, mut layouts): (Vec<_>, Vec<_>) = shown.iter().map(panel).unzip();
    // Empty cells of the grid of panels.
    for _ in shown.len()..rows * columns {
        plots.push(Plots::new());
        layouts.push(style::layout((0.0, 1.0), (0.0, 1.0)));
    }
    let (colours, axes) = bar(ends, &ColorMap::Viridis, &style::axis(outcome, "Force of a cell", force));
    let axes = axes.with_force_margins_y(MARGINS.0, MARGINS.1);
    let structure = structure(rows, columns);
    // Cells are square, and the colour scale is as tall as the maps.
    let across = (page.width - BAR) / columns as f64 - SIDES.0 - SIDES.1;
    let square = sides[0] as f64 / sides[1] as f64;
    let height = (across * square).clamp(HEIGHTS.0, HEIGHTS.1);
    let across = across.min(height / square);
    let order = shown.len().min(columns);
    plots.insert(order, colours);
    layouts.insert(order, axes);
    let (title, size) = page.heading(&outcome.summary.title);
    let figure = Figure::new(rows, columns + 1)
        .with_structure(structure)
        .with_title(title)
        .with_title_size(size)
        .with_cell_size(across + SIDES.0 + SIDES.1, height + MARGINS.0 + MARGINS.1)
        .with_col_width(columns, BAR)
        .with_spacing(6.0);
    Some(ticks::panels(figure, plots, layouts))
}

/// The maps that are drawn: all, or an even selection with the first and the last.
fn chosen(count: usize) -> Vec<usize> {
    if count <= PANELS {
        return (0..count).collect();
    }
    (0..PANELS).map(|i| i * (count - 1) / (PANELS - 1)).collect()
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
