//! Fields on a plane, with a colour scale shared by several panels.

use std::sync::Arc;

use kuva::plot::{ColorMap, Heatmap};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use super::{fitting::whole_step, magnitude, style};

/// Largest number of cells of a picture.
const MOST: usize = 300_000;

/// Font size of the numbers of a colour scale.
const BAR_TICKS: u32 = 11;

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
    (vec![plot], layout.with_y_label(label).with_tick_size(BAR_TICKS).with_label_size(13))
}

/// The range of all values, a wider one if they are equal but for rounding.
pub fn scale(values: &[f64]) -> (f64, f64) {
    /// Largest difference of equal values over the largest of them.
    const ROUNDING: f64 = 1e-9;
    let (low, high) = style::range([values]);
    let largest = low.abs().max(high.abs());
    if high - low > ROUNDING * largest {
        return (low, high);
    }
    // Of small values a part, which is seen in the numbers of the scale.
    let half = if largest > 0.0 { 0.5 * largest.min(1.0) } else { 0.5 };
    (low - half, low + half)
}

/// Room for the numbers along a vertical axis and for its label, in numbers of this size.
pub fn room((low, high): (f64, f64), ticks: &TickFormat, size: f64) -> f64 {
    /// Width of a digit, and of what stands beside the numbers.
    const DIGIT: f64 = 0.64;
    const BESIDE: f64 = 2.6;
    // The largest power of ten below the distance of two ticks.
    let step = 10f64.powf((0.2 * (high - low)).log10().floor());
    let first = (low / step).round();
    let places = (0..100).map(|i| (first + f64::from(i)) * step).take_while(|place| *place < high);
    let TickFormat::Custom(text) = ticks else { return 0.0 };
    let longest = places.map(|place| text(place).chars().count()).max().unwrap_or(0);
    size * (BESIDE + DIGIT * longest as f64)
}

/// Width of the panel of a colour scale of these ends: at least this, and more where its numbers are long.
pub fn bar_width(least: f64, ends: (f64, f64)) -> f64 {
    /// Least width of the colours and of what is on their right.
    const COLOURS: f64 = 26.0;
    least.max(room(ends, &style::numbers(ends), f64::from(BAR_TICKS)) + COLOURS)
}

/// Draws rows upward. The plot library scales colours to the range of the values; this is undone, so that panels agree.
fn heatmap(
    mut data: Vec<Vec<f64>>,
    scale: (f64, f64),
    colours: &ColorMap,
    (x, y): ((f64, f64), (f64, f64)),
) -> Heatmap {
    let (low, high) = style::range(data.iter().map(Vec::as_slice));
    let factor = magnitude::linear((low, high));
    data.iter_mut().flatten().for_each(|value| *value *= factor);
    let colours = colours.clone();
    let colour = move |part: f64| {
        let value = low + part * (high - low);
        colours.map((value - scale.0) / (scale.1 - scale.0))
    };
    let mut heatmap = Heatmap::new().with_data(data).with_color_map(ColorMap::Custom(Arc::new(colour)));
    (heatmap.x_range, heatmap.y_range, heatmap.cell_size) = (Some(x), Some(y), WHOLE);
    heatmap
}
