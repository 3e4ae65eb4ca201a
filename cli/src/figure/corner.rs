//! `corner`: draws from a posterior, as histograms of numbers and of pairs of them.

use std::sync::Arc;

use asperity_runner::output::Outcome;
use kuva::plot::{ColorMap, Histogram};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::field::Field;
use super::grid::Grid;
use super::style::{self, BLUE, Page, Plots};
use super::ticks;

/// Largest number of numbers that are drawn; those after them are left out.
const MOST: usize = 6;
/// Bins of a histogram, and of each side of one of pairs.
const BINS: usize = 30;
/// Share of the draws that is left out at each end of an axis.
const BEYOND: f64 = 0.001;
/// Longest label, in letters.
const LONGEST: usize = 18;
/// Room for the labels of the axes.
const LABELS: (f64, f64) = (62.0, 44.0);
const MARGIN: f64 = 6.0;

/// A number with its draws.
struct Drawn<'a> {
    label: String,
    values: &'a [f64],
    range: (f64, f64),
}

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let reported = outcome.summary.numbers.fit()?.posterior.as_ref()?;
    let values = outcome.record.values("posterior_value")?;
    let draws = values.chunks_exact(reported.chains * reported.draws);
    let numbers = reported.numbers.iter().zip(draws).take(MOST);
    let numbers: Vec<Drawn<'_>> = numbers
        .map(|(number, values)| Drawn { label: label(&number.key), values, range: range(values) })
        .collect();
    let count = numbers.len();
    let pairs: Vec<(usize, usize)> =
        (0..count).flat_map(|row| (0..=row).map(move |column| (row, column))).collect();
    let panel = |&(row, column): &(usize, usize)| -> (Plots, Layout) {
        let (below, left) = (&numbers[column], &numbers[row]);
        let (plots, heights) =
            if row == column { histogram(below) } else { (vec![pair(below, left)], left.range) };
        let quiet = || TickFormat::Custom(Arc::new(|_| String::new()));
        let mut layout = style::layout(below.range, heights)
            .with_ticks(2)
            .with_tick_size(9)
            .with_label_size(11)
            .with_force_margins(if column == 0 { LABELS.0 } else { MARGIN }, MARGIN)
            .with_force_margins_y(MARGIN, if row == count - 1 { LABELS.1 } else { MARGIN });
        layout = if row == count - 1 {
            layout.with_x_label(below.label.clone())
        } else {
            layout.with_x_tick_format(quiet())
        };
        layout = if column == 0 && row > 0 {
            layout.with_y_label(left.label.clone())
        } else {
            layout.with_y_tick_format(quiet())
        };
        (plots, layout)
    };
    let (plots, layouts): (Vec<_>, Vec<_>) = pairs.iter().map(panel).unzip();
    let side = (page.width - LABELS.0) / count.max(2) as f64;
    let grid = Grid::new(count, count, (side, side))
        .with_structure(pairs.iter().map(|(row, column)| vec![row * count + column]).collect())
        .with_title(page.heading(&outcome.summary.title))
        .with_column_width(0, side + LABELS.0 - MARGIN)
        .with_row_height(count - 1, side + LABELS.1 - MARGIN)
        .with_spacing(0.0);
    (count > 0).then(|| ticks::panels(grid, plots, layouts))
}

/// A key without its table; of a long one the last two parts.
fn label(key: &str) -> String {
    let short = ["contacts.", "fit."].iter().find_map(|table| key.strip_prefix(table)).unwrap_or(key);
    if short.chars().count() <= LONGEST {
        return short.to_owned();
    }
    let parts: Vec<&str> = short.split('.').collect();
    parts[parts.len().saturating_sub(2)..].join(".")
}

/// The range of draws, without those few that are far from all others.
fn range(values: &[f64]) -> (f64, f64) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let left_out = (BEYOND * sorted.len() as f64) as usize;
    let (low, high) = (sorted[left_out], sorted[sorted.len() - 1 - left_out]);
    if high > low { (low, high) } else { (low - 0.5, low + 0.5) }
}

/// The bin of a value.
fn bin(value: f64, (low, high): (f64, f64)) -> Option<usize> {
    let place = (value - low) / (high - low);
    (0.0..=1.0).contains(&place).then(|| ((place * BINS as f64) as usize).min(BINS - 1))
}

fn histogram(drawn: &Drawn<'_>) -> (Plots, (f64, f64)) {
    let mut counts = vec![0.0; BINS];
    drawn.values.iter().filter_map(|&value| bin(value, drawn.range)).for_each(|i| counts[i] += 1.0);
    let (low, high) = drawn.range;
    let edges = (0..=BINS).map(|i| low + (high - low) * i as f64 / BINS as f64).collect();
    let top = style::headroom(counts.iter().copied().fold(0.0, f64::max));
    (vec![Plot::Histogram(Histogram::from_bins(edges, counts).with_color(BLUE))], (0.0, top))
}

/// How many draws there are of each pair of values.
fn pair(below: &Drawn<'_>, left: &Drawn<'_>) -> Plot {
    let mut counts = vec![0.0; BINS * BINS];
    for (&x, &y) in below.values.iter().zip(left.values) {
        if let (Some(column), Some(row)) = (bin(x, below.range), bin(y, left.range)) {
            counts[row * BINS + column] += 1.0;
        }
    }
    let top = counts.iter().copied().fold(1.0, f64::max);
    let field = Field { values: &counts, sides: [BINS; 2], x: below.range, y: left.range };
    field.plot((0.0, top), &blues(), 1)
}

/// From white to blue.
fn blues() -> ColorMap {
    /// [`BLUE`].
    const END: [f64; 3] = [0.0, 114.0, 178.0];
    ColorMap::Custom(Arc::new(|part: f64| {
        let [red, green, blue] = END.map(|end| (255.0 + (end - 255.0) * part.clamp(0.0, 1.0)).round() as u8);
        format!("#{red:02X}{green:02X}{blue:02X}")
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_short() {
        assert_eq!(label("contacts.thresholds.gaussian.mean"), "gaussian.mean");
        assert_eq!(label("contacts.count"), "count");
        assert_eq!(label("fit.curve.1.offset"), "curve.1.offset");
    }

    #[test]
    fn bins_cover_the_range_with_both_ends() {
        assert_eq!([0.0, 0.999, 1.0].map(|value| bin(value, (0.0, 1.0))), [Some(0), Some(29), Some(29)]);
        assert_eq!(bin(1.1, (0.0, 1.0)), None);
        assert_eq!(range(&[2.0; 4]), (1.5, 2.5));
    }
}
