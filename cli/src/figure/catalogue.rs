//! `catalogue`: the force along the drive, the distribution of magnitudes, and that of waiting times; of few events the
//! magnitudes along the drive.

use asperity::task::summary::{Catalogue, PowerLaw};
use asperity_runner::output::Outcome;
use kuva::plot::MarkerShape;
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::advance::Advance;
use super::curve::{Counted, Point, counted, line, thinned};
use super::distribution::stem;
use super::grid::Grid;
use super::style::{self, BLUE, GREY, ORANGE, Page, Plots};
use super::{legend, ticks};

/// Bins per decade.
const PER_DECADE: f64 = 8.0;
/// Largest number of slides for which the force before and after is shown.
const FEW: usize = 500;
/// Points of the fitted distribution.
const FINE: usize = 200;
/// Smallest number of magnitudes and of waiting times for a density.
const FEWEST: usize = 10;
/// Left and right margins of a panel.
const SIDES: (f64, f64) = (66.0, 14.0);
/// Range of the waiting times that are shown, over their mean.
const WAITING: (f64, f64) = (1e-3, 1e2);

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let catalogue = outcome.summary.numbers.catalogue()?;
    let below = match catalogue.events {
        0 => [None, None],
        1..FEWEST => [along_drive(outcome, catalogue), None],
        _ => [magnitudes(outcome, catalogue), waiting(outcome, catalogue)],
    };
    let panels = std::iter::once(force(outcome)?).chain(below.into_iter().flatten());
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.unzip();
    // With too few waiting times, magnitudes take the whole picture.
    let (rows, lower) = match plots.len() {
        1 => (1, vec![]),
        2 => (2, vec![vec![2, 3]]),
        _ => (2, vec![vec![2], vec![3]]),
    };
    let events = format!("{} event{}", catalogue.events, if catalogue.events == 1 { "" } else { "s" });
    let mut legend = vec![];
    if plots.len() > 1 {
        legend.push(style::marker(events, ORANGE, MarkerShape::Circle));
    }
    legend.extend(catalogue.law.map(|law| style::line(fitted_text(&law), BLUE, None)));
    if plots.len() > 2 {
        legend.push(style::line("Poisson process", GREY, Some(style::DASHES)));
    }
    let grid = Grid::new(rows, 2, (page.width / 2.0, page.height(300.0)))
        .with_structure([vec![vec![0, 1]], lower].concat())
        .with_title(page.heading(&outcome.summary.title))
        .with_row_height(0, page.height(200.0))
        .with_spacing(10.0);
    Some(legend::placed(ticks::panels(grid, plots, layouts), &legend, &[1, 2]))
}

/// The fitted distribution in words.
fn fitted_text(law: &PowerLaw) -> String {
    let decimals = (1.0 - law.exponent.error.log10().floor()).clamp(0.0, 6.0) as usize;
    let exponent = format!("{:.decimals$} ± {:.decimals$}", law.exponent.value, law.exponent.error);
    if !law.is_cut_off() {
        return format!("τ = {exponent}");
    }
    format!("τ = {exponent}, cut-off {}", rounded(law.cut_off.0))
}

/// `value` with two digits.
fn rounded(value: f64) -> String {
    let two: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    style::digits(two)
}

/// The force along the drive, or over the time of a protocol: at the points of the trace and, if there are few slides, before and after every slide.
fn force(outcome: &Outcome) -> Option<(Plots, Layout)> {
    let record = &outcome.record;
    let along = Advance::of(record)?;
    let mut points: Vec<Point> = pairs(&along.points.values, record.values("force")?).collect();
    let (before, after) = (record.values("event_force_before")?, record.values("event_force_after")?);
    // Events at the same drive are parts of one slide and share its forces.
    let begins = along.events.iter().zip(before);
    let ends = along.ends(record);
    let mut slides: Vec<_> = begins.zip(ends.iter().zip(after)).collect();
    slides.dedup_by_key(|((drive, _), _)| *drive);
    if slides.len() <= FEW {
        let both = |&((&begin, &before), (&end, &after))| [(begin, before), (end, after)];
        points.extend(slides.iter().flat_map(both));
    }
    // A stable sort, so that the force drops in an event.
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let heights: Vec<f64> = points.iter().map(|point| point.1).collect();
    let (low, high) = style::range([heights.as_slice()]);
    let last = points.last()?.0;
    let layout = panel((points[0].0, last), style::heights(low, high))
        .with_x_label(style::axis(outcome, along.words, along.points))
        .with_y_label(style::axis(outcome, "Force F", record.get("force")?));
    Some((vec![line(thinned(points), BLUE, 1.2, None)], layout))
}

/// The magnitude of each event along the drive, or over the time of a protocol.
fn along_drive(outcome: &Outcome, catalogue: &Catalogue) -> Option<(Plots, Layout)> {
    let record = &outcome.record;
    let along = Advance::of(record)?;
    let variable = record.get(&format!("event_{}", catalogue.magnitude))?;
    let plots = pairs(along.events, &variable.values).flat_map(|tip| stem(tip, ORANGE)).collect();
    let ends = style::range([along.points.values.as_slice()]);
    let layout = panel(ends, (0.0, style::headroom(style::range([variable.values.as_slice()]).1)))
        .with_x_label(style::axis(outcome, along.words, along.points))
        .with_y_label(style::axis(outcome, words(catalogue), variable));
    Some((plots, layout))
}

/// The magnitude of events in words.
fn words(catalogue: &Catalogue) -> &'static str {
    if catalogue.magnitude == "size" { "Breaks in an event" } else { "Moment of an event" }
}

/// Probability density of magnitudes, and the fitted distribution.
fn magnitudes(outcome: &Outcome, catalogue: &Catalogue) -> Option<(Plots, Layout)> {
    let variable = outcome.record.get(&format!("event_{}", catalogue.magnitude))?;
    let whole = variable.values.iter().all(|value| value.fract() == 0.0);
    let points = density(&variable.values, whole);
    let (first, last) = (points.first()?.0, points.last()?.0);
    let (low, high) = heights(&points);
    let mut plots = counted(&points, 0.4 * low, ORANGE);
    if let Some(law) = catalogue.law {
        let share = law.events as f64 / catalogue.events as f64;
        let curve =
            fitted(&law, share, last, whole).into_iter().filter(|point| point.1 > 0.5 * low).collect();
        plots.push(line(curve, BLUE, 1.8, None));
    }
    let layout = logarithmic((0.7 * first, 1.5 * last), (0.4 * low, 2.5 * high))
        .with_x_label(style::axis(outcome, words(catalogue), variable))
        .with_y_label("Probability density");
    Some((plots, layout))
}

/// Density of the waiting times over their mean; none if there are too few.
fn waiting(outcome: &Outcome, catalogue: &Catalogue) -> Option<(Plots, Layout)> {
    let drives = outcome.record.values("event_drive")?;
    let mean = catalogue.mean_waiting?;
    let times: Vec<f64> =
        drives.windows(2).map(|pair| (pair[1] - pair[0]) / mean).filter(|&time| time > 0.0).collect();
    if times.len() < FEWEST {
        return None;
    }
    let shown = |point: &Counted| (WAITING.0..WAITING.1).contains(&point.0);
    let points: Vec<Counted> = density(&times, false).into_iter().filter(shown).collect();
    let (low, high) = heights(&points);
    let last = points.last()?.0;
    let steps = (0..=FINE).map(|i| WAITING.0 * (last / WAITING.0).powf(i as f64 / FINE as f64));
    let chance = steps.map(|t| (t, (-t).exp())).filter(|point| point.1 > 0.5 * low).collect();
    let layout = logarithmic((0.7 * points[0].0, 1.5 * last), (0.4 * low, 2.5 * high.max(1.0)))
        .with_x_label("Interval to the next event / mean interval")
        .with_y_label("Probability density");
    let mut plots = vec![line(chance, GREY, 1.4, Some(style::DASHES))];
    plots.extend(counted(&points, 0.4 * low, ORANGE));
    Some((plots, layout))
}

/// The least and the largest density.
fn heights(points: &[Counted]) -> (f64, f64) {
    let ends = (f64::INFINITY, 0.0);
    points.iter().fold(ends, |(low, high): (f64, f64), point| (low.min(point.1), high.max(point.1)))
}

/// Probability density of `values`, in bins of equal width on a logarithmic axis, with their counts. Whole numbers are shown
/// at the geometric mean of those in their bin.
fn density(values: &[f64], whole: bool) -> Vec<Counted> {
    let mut bins = std::collections::BTreeMap::<i64, (u64, f64)>::new();
    for value in values.iter().filter(|&&value| value > 0.0) {
        let (count, sum) = bins.entry((PER_DECADE * value.log10()).round() as i64).or_default();
        *count += 1;
        *sum += value.log10();
    }
    let edge = |bin: f64| 10f64.powf(bin / PER_DECADE);
    let share = |(bin, (count, sum)): (i64, (u64, f64))| {
        let (from, to) = (edge(bin as f64 - 0.5), edge(bin as f64 + 0.5));
        let width = if whole { (to.ceil() - from.ceil()).max(1.0) } else { to - from };
        let at = if whole { 10f64.powf(sum / count as f64) } else { edge(bin as f64) };
        (at, count as f64 / values.len() as f64 / width, count as f64)
    };
    bins.into_iter().map(share).collect()
}

/// The distribution from its lowest magnitude to `last`; its total weight, the sum over whole numbers, is the given fraction
/// of events.
fn fitted(law: &PowerLaw, share: f64, last: f64, whole: bool) -> Vec<Point> {
    /// From here on a sum over whole numbers is an integral from half below, to 1e-5 (midpoint rule).
    const SMOOTH: f64 = 100.0;
    let rate = law.cut_off.0.recip();
    let height = |x: f64| x.powf(-law.exponent.value) * (-rate * x).exp();
    let between = |from: f64, to: f64| {
        let at = move |i: usize| from * (to / from).powf(i as f64 / FINE as f64);
        (0..=FINE).map(move |i| (at(i), height(at(i))))
    };
    let integral = |from: f64, to: f64| -> f64 {
        let points: Vec<Point> = between(from, to.max(from)).collect();
        points.windows(2).map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0)).sum()
    };
    let area = if whole {
        let first = law.from.max(SMOOTH);
        let few = (law.from as u64..first as u64).map(|k| height(k as f64)).sum::<f64>();
        few + integral(first - 0.5, last)
    } else {
        integral(law.from, last)
    };
    between(law.from, last).map(|(x, y)| (x, share * y / area)).collect()
}

fn pairs<'a>(x: &'a [f64], y: &'a [f64]) -> impl Iterator<Item = Point> + 'a {
    x.iter().copied().zip(y.iter().copied())
}

fn panel(x: (f64, f64), y: (f64, f64)) -> Layout {
    style::layout(x, y).with_tick_size(11).with_label_size(13).with_force_margins(SIDES.0, SIDES.1)
}

fn logarithmic(x: (f64, f64), y: (f64, f64)) -> Layout {
    panel(x, y).with_log_scale().with_x_tick_format(style::powers(x)).with_y_tick_format(style::powers(y))
}
