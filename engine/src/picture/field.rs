//! Values of cells in colours, with their scale.

use super::png;
use super::svg::{At, Svg};

/// Colours from low to high, those of viridis.
const COLORS: [[f64; 3]; 5] =
    [[68.0, 1.0, 84.0], [59.0, 82.0, 139.0], [33.0, 145.0, 140.0], [94.0, 201.0, 98.0], [253.0, 231.0, 37.0]];
/// Columns of the picture.
const COLUMNS: usize = 600;
/// Rows of the picture, at most.
const ROWS: usize = 600;
/// Steps of the scale of colours.
const STEPS: usize = 64;

/// Values of cells, row by row; each row holds from its place to that of the next.
#[derive(Debug)]
pub struct Field<'a> {
    /// Where the rows begin.
    pub at: &'a [f64],
    /// How many values a row has.
    pub cells: usize,
    /// The values.
    pub values: &'a [f64],
    /// The ends of both axes.
    pub ends: [[f64; 2]; 2],
    /// What the values are.
    pub words: String,
}

impl Field<'_> {
    /// Draws the field over a plot, and the scale of its colours beside it.
    pub fn draw(&self, svg: &mut Svg, [left, top, width, height]: [f64; 4]) {
        let range = self
            .values
            .iter()
            .fold([f64::MAX, f64::MIN], |[low, high], &value| [low.min(value), high.max(value)]);
        let [low, high] = range;
        let size = if high > low { high - low } else { 1.0 };
        let rows: Vec<usize> = (0..COLUMNS).map(|column| self.row(column)).collect();
        let count = self.cells.min(ROWS);
        let share = |x: usize, y: usize| (self.mean(rows[x], count - 1 - y, count) - low) / size;
        picture(svg, &pixels(COLUMNS, count, &share), [left, top, width, height]);
        let [right, bottom] = [left + width, top + height];
        let step = |_: usize, y: usize| 1.0 - y as f64 / (STEPS - 1) as f64;
        picture(svg, &pixels(1, STEPS, &step), [right + 10.0, top, 10.0, height]);
        svg.text(At::start(right + 24.0, bottom), &crate::digits::precise(low, 3));
        svg.text(At::start(right + 24.0, top + 8.0), &crate::digits::precise(high, 3));
        let middle = top + 0.5 * height;
        svg.text(At { anchor: "middle", upward: true, ..At::start(right + 34.0, middle) }, &self.words);
    }

    /// The mean over a block of cells, one of so many of the same size.
    fn mean(&self, row: usize, block: usize, blocks: usize) -> f64 {
        let [first, end] = [block, block + 1].map(|edge| row * self.cells + edge * self.cells / blocks);
        self.values[first..end].iter().sum::<f64>() / (end - first) as f64
    }

    /// The last row that begins before the middle of a column of pixels.
    fn row(&self, column: usize) -> usize {
        let [first, last] = self.ends[0];
        let place = first + (last - first) * (column as f64 + 0.5) / COLUMNS as f64;
        self.at.partition_point(|&at| at <= place).max(1) - 1
    }
}

/// A picture as PNG, each pixel of the colour of its share.
fn pixels(width: usize, height: usize, share: &dyn Fn(usize, usize) -> f64) -> String {
    let levels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let levels: Vec<u8> = levels.map(|(x, y)| (255.0 * share(x, y)).round() as u8).collect();
    png::address(width, &palette(), &levels)
}

fn palette() -> Vec<[u8; 3]> {
    (0..=255).map(|level| color(f64::from(level) / 255.0)).collect()
}

fn color(share: f64) -> [u8; 3] {
    let place = share * (COLORS.len() - 1) as f64;
    let below = (place as usize).min(COLORS.len() - 2);
    let part =
        |i: usize| COLORS[below][i] + (COLORS[below + 1][i] - COLORS[below][i]) * (place - below as f64);
    [part(0), part(1), part(2)].map(|part| part.round() as u8)
}

fn picture(svg: &mut Svg, address: &str, [left, top, width, height]: [f64; 4]) {
    svg.raw("<image preserveAspectRatio=\"none\" image-rendering=\"pixelated\"");
    for (name, value) in [("x", left), ("y", top), ("width", width), ("height", height)] {
        svg.attribute(name, value);
    }
    svg.raw(" href=\"");
    svg.raw(address);
    svg.raw("\"/>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_cells_have_few_rows() {
        let cells = 1500;
        let values: Vec<f64> = (0..2 * cells).map(|i| i as f64).collect();
        let field = Field {
            at: &[0.0, 1.0],
            cells,
            values: &values,
            ends: [[0.0, 2.0], [0.0, 1500.0]],
            words: String::new(),
        };
        // Blocks of two and three cells.
        assert_eq!((field.mean(0, 0, ROWS), field.mean(1, 1, ROWS)), (0.5, 1503.0));
        let means: f64 = (0..ROWS / 2)
            .map(|pair| field.mean(0, 2 * pair, ROWS) * 2.0 + field.mean(0, 2 * pair + 1, ROWS) * 3.0)
            .sum();
        assert_eq!(means, values[..cells].iter().sum::<f64>());
        let mut svg = Svg::default();
        field.draw(&mut svg, [0.0, 0.0, 100.0, 100.0]);
        assert!(svg.0.len() < 2 * COLUMNS * ROWS, "{}", svg.0.len());
    }
}
