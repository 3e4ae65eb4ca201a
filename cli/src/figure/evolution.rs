//! `evolution`: the distribution of stretches at the snapshots, one panel each.

use asperity::record::Record;
use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, MarkerShape};
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::curve::{density_line, histogram};
use super::distribution::stem;
use super::grid::Grid;
use super::style::{self, BLUE, ORANGE, Page, Plots};
use super::{legend, ticks};

/// Largest number of panels; if there are more snapshots, some are left out.
const PANELS: usize = 24;
/// Smallest fraction of contacts with a density that sets the scale of a panel.
const SMOOTH: f64 = 0.02;
const MARGINS: (f64, f64) = (30.0, 24.0);
/// Left and right margins, so that the axes of a column begin and end together.
const SIDES: (f64, f64) = (62.0, 18.0);

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let snapshots = record.values("snapshot")?;
    let shown = style::chosen(snapshots.len(), PANELS);
    let end = end(record)?;
    let (columns, rows) = grid(shown.len());
    let panels: Option<Vec<_>> = shown.iter().map(|&s| panel(outcome, s, end)).collect();
    let (plots, layouts): (Vec<_>, Vec<_>) = panels?.into_iter().unzip();
    let layouts = labelled(outcome, layouts, columns)?;
    let height = page.height(if columns < 3 { 190.0 } else { 150.0 });
    let some = [shown.len(), snapshots.len()];
    let title = page.heading_of_some(&outcome.summary.title, some, "snapshots");
    let grid = Grid::new(rows, columns, (page.width / columns as f64, height))
        .with_title(title)
        .with_row_height(rows - 1, height + style::LABEL_HEIGHT);
    let panels: Vec<usize> = (0..plots.len()).collect();
    Some(legend::placed(ticks::panels(grid, plots, layouts), &entries(outcome), &panels))
}

fn grid(panels: usize) -> (usize, usize) {
    let columns = match panels {
        0..4 => 1,
        4..13 => 2,
        _ => 3,
    };
    (columns, panels.div_ceil(columns).max(1))
}

fn panel(outcome: &Outcome, snapshot: usize, end: f64) -> Option<(Plots, Layout)> {
    let record = &outcome.record;
    let stretch = record.values("stretch")?;
    let density = record.row("stretch_density", snapshot)?;
    let heights = record.row("ensemble_stretch_density", snapshot);
    let positions = record.get("snapshot")?;
    let position = positions.values[snapshot];
    let atoms = atoms(record, position);
    let smooth = atoms.is_empty() || atoms.iter().map(|a| a.1).sum::<f64>() > 1.0 - SMOOTH;
    let tallest =
        if smooth { style::range([density, heights.unwrap_or(&[])]).1 } else { style::range([density]).1 };
    let top = style::headroom(tallest);
    let mut plots = Plots::new();
    if let (Some(bin), Some(heights)) = (record.values("bin"), heights) {
        // Bins that hold a point mass are very high; they are cut at the frame.
        let heights: Vec<f64> = heights.iter().map(|h| h.min(top)).collect();
        plots.push(histogram(bin, &heights, ORANGE));
    }
    plots.extend(density_line(stretch, density, BLUE, 1.6));
    plots.extend(atoms.into_iter().flat_map(|(x, weight)| stem((x, weight * top), BLUE)));
    let layout = style::layout((0.0, end), (0.0, top))
        .with_title(format!("X = {}", style::value_of(outcome, position, positions)))
        .with_ticks(4)
        .with_force_margins_y(MARGINS.0, MARGINS.1)
        .with_force_margins(SIDES.0, SIDES.1)
        .with_title_size(12)
        .with_tick_size(11)
        .with_label_size(13);
    Some((plots, layout))
}

/// Range of the axes, which includes all distributions.
fn end(record: &Record) -> Option<f64> {
    let stretch = record.values("stretch")?;
    let densities: Vec<_> =
        (0..record.length("snapshot")?).filter_map(|s| record.row("stretch_density", s)).collect();
    let snapshots = record.values("snapshot")?;
    let farthest = snapshots.iter().flat_map(|&x| atoms(record, x)).fold(0.0, |end: f64, (x, _)| end.max(x));
    Some(style::reach(stretch, &densities).max(1.05 * farthest))
}

/// Stretches and weights of the visible point masses at `position`.
fn atoms(record: &Record, position: f64) -> Vec<(f64, f64)> {
    let column = |name| record.values(name).unwrap_or(&[]);
    let stretches = column("stretch_atom_stretch").iter().zip(column("stretch_atom_weight"));
    let placed = column("stretch_atom_position").iter().zip(stretches);
    placed
        .filter(|(at, (_, weight))| **at == position && **weight > style::INVISIBLE)
        .map(|(_, (&x, &weight))| (x, weight))
        .collect()
}

/// Axis labels on the left and lower sides of the figure only.
fn labelled(outcome: &Outcome, layouts: Vec<Layout>, columns: usize) -> Option<Vec<Layout>> {
    let record = &outcome.record;
    let x = style::axis(outcome, "Stretch x", record.get("stretch")?);
    let y = style::axis(outcome, "Q(x; X)", record.get("stretch_density")?);
    let lowest = (layouts.len() - 1) / columns * columns;
    let label = |(i, layout): (usize, Layout)| {
        let layout = if i >= lowest {
            layout.with_x_label(&x).with_force_margins_y(MARGINS.0, MARGINS.1 + style::LABEL_HEIGHT)
        } else {
            layout
        };
        if i % columns == 0 { layout.with_y_label(&y) } else { layout }
    };
    Some(layouts.into_iter().enumerate().map(label).collect())
}

fn entries(outcome: &Outcome) -> Vec<LegendEntry> {
    let record = &outcome.record;
    let mut entries = vec![style::line("master equation", BLUE, None)];
    let has_atoms = record.get("stretch_atom_weight").is_some();
    if record.get("ensemble_stretch_density").is_some() {
        let cut = if has_atoms { ", point masses up to the frame" } else { "" };
        entries.push(style::area(style::sized_ensemble(outcome) + cut, "#F5D58C"));
    }
    if has_atoms {
        entries.push(style::marker("point mass, 1 = full height", BLUE, MarkerShape::Circle));
    }
    entries
}
