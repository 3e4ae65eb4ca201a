//! Fields on a plane, with a colour scale shared by several panels.

use std::sync::Arc;

use kuva::plot::{ColorMap, Heatmap};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use super::{fitting::whole_step, style};

/// Largest number of cells of a picture.
const MOST: usize = 300_000;

/// Size of a cell over its room. Cells of size 1 would overlap.
const WHOLE: f64 = 1.0 - 1e-9;

/// A field, row by row, and the ranges that it covers.
pub struct Field<'a> {
    /// The values.
    pub values: &'a [f64],
    /// Rows and columns.
    pub sides: [usize; 2],
    /// Range of the columns.
    pub x: (f64, f64),
    /// Range of the rows.
    pub y: (f64, f64),
}

/// What a dot shows of a block of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    Mean,
    Largest,
}

/// The most rows or columns of a field in one of so many panels.
pub fn most(panels: usize) -> usize {
    ((MOST / panels.max(1)) as f64).sqrt() as usize
}

impl Field<'_> {
    /// The field in `colours` from the lower to the upper end of `scale`, averaged over blocks of cells if there are too
    /// many for `panels` panels.
    pub fn plot(&self, scale: (f64, f64), colours: &ColorMap, panels: usize) -> Plot {
        self.plot_of(Shown::Mean, scale, colours, panels)
    }

    /// The same with the mean or the largest value of each block.
    pub fn plot_of(&self, shown: Shown, scale: (f64, f64), colours: &ColorMap, panels: usize) -> Plot {
        let [rows, columns] = self.sides;
        let (across, along) = (rows.min(most(panels)), columns.min(most(panels)));
        let block = |i: usize, of: usize, parts: usize| i * of / parts..(i + 1) * of / parts;
        let value = |i: usize, j: usize| {
            let (rows, among) = (block(i, rows, across), block(j, columns, along));
            let count = (rows.len() * among.len()) as f64;
            let values = rows.map(|row| &self.values[row * columns..][among.clone()]);
            match shown {
                Shown::Mean => values.map(|row| row.iter().sum::<f64>()).sum::<f64>() / count,
                Shown::Largest => values.flatten().copied().fold(f64::NEG_INFINITY, f64::max),
            }
        };
        let data: Vec<Vec<f64>> = (0..across).map(|i| (0..along).map(|j| value(i, j)).collect()).collect();
        Plot::Heatmap(heatmap(data, scale, colours, (self.x, self.y)))
    }
}

/// Axes of a field, whose ticks are outside: it covers those inside.
pub fn axes(x: (f64, f64), y: (f64, f64)) -> Layout {
    style::layout(x, y).with_tick_align("out")
}

/// Axes of a chain of cells from left to right, with ticks at whole numbers.
pub fn chain_axes(cells: usize, y: (f64, f64)) -> Layout {
    /// About so many ticks, where they have room.
    const TICKS: usize = 10;
    axes((0.0, cells as f64), y)
        .with_x_tick_step(whole_step(cells as f64, TICKS))
        .with_x_label("Cell")
        .with_tick_size(11)
        .with_label_size(13)
        .with_force_margins(style::SIDES.0, style::SIDES.1)
}

/// The colour scale as a panel of its own, and its axes.
pub fn bar(scale: (f64, f64), colours: &ColorMap, label: &str) -> (Vec<Plot>, Layout) {
    const STEPS: usize = 128;
    const ACROSS: (f64, f64) = (0.1, 0.9);
    let value = |i: usize| scale.0 + (scale.1 - scale.0) * i as f64 / (STEPS - 1) as f64;
    let data = (0..STEPS).map(|i| vec![value(i)]).collect();
    let plot = Plot::Heatmap(heatmap(data, scale, colours, (ACROSS, scale)));
    // No tick below it.
    let layout = axes(ACROSS, scale).with_x_tick_step(1.0);
    (vec![plot], layout.with_y_label(label).with_tick_size(11).with_label_size(13))
}

/// The range of all values, a little wider if they are equal.
pub fn scale(values: &[f64]) -> (f64, f64) {
    let (low, high) = style::range([values]);
    if high > low { (low, high) } else { (low - 0.5, low + 0.5) }
}

/// Draws rows upward. The plot library scales colours to the range of the values; this is undone, so that panels agree.
fn heatmap(
    data: Vec<Vec<f64>>,
    scale: (f64, f64),
    colours: &ColorMap,
    (x, y): ((f64, f64), (f64, f64)),
) -> Heatmap {
    let (low, high) = style::range(data.iter().map(Vec::as_slice));
    let colours = colours.clone();
    let colour = move |part: f64| {
        let value = low + part * (high - low);
        colours.map((value - scale.0) / (scale.1 - scale.0))
    };
    let mut heatmap = Heatmap::new().with_data(data).with_color_map(ColorMap::Custom(Arc::new(colour)));
    (heatmap.x_range, heatmap.y_range, heatmap.cell_size) = (Some(x), Some(y), WHOLE);
    heatmap
}
