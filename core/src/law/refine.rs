//! Legendre series of a density that is called with many points at once: cells halved until they follow it, then joined.

use crate::numerics::legendre::{Nodal, RULE, derivative, series};
use crate::numerics::piecewise::{Piecewise, tail};
use crate::{Error, Float, Result};

/// Cells after which a function is given up: it is noise.
const MOST_CELLS: usize = 20_000;

/// The share of the mass, and of the second moment, at which a tail without end is cut.
const ENDS: (f64, f64) = (1e-40, 1e-16);

/// The share of the mass below which cells at the lower end are left as they are, and, where the density is less than this
/// of its mean, left out.
const STARTS: (f64, f64) = (1e-30, 1e-20);

/// Where a tail ends at the latest: the third moment there is still a number.
const FARTHEST: f64 = 1e100;

/// Halvings that reach 1e-75 of the width: of x^(−3/4), 1e-18 is left there.
const MOST_HALVINGS: u32 = 250;

/// A density called with many points at once.
pub(super) trait Density: FnMut(&[f64]) -> Result<Vec<f64>> {}

impl<F: FnMut(&[f64]) -> Result<Vec<f64>>> Density for F {}

/// A density as a series.
pub(super) struct Refined {
    pub(super) series: Piecewise,
    /// The share of the mass that the cells leave out.
    pub(super) left_out: f64,
    /// The share beyond the last cell.
    pub(super) cut: f64,
}

/// The series of a density between `boundaries`, and beyond the last one if it is `endless`: each cell leaves out, in the
/// mean, at most `tolerance` of the mass from there on, and up to there.
///
/// # Errors
/// Those of [`super::Series::resolve`].
pub(super) fn refine(
    mut density: impl Density,
    boundaries: &[f64],
    endless: bool,
    tolerance: f64,
) -> Result<Refined> {
    let mut cells: Vec<RefinedCell> =
        boundaries.windows(2).map(|pair| RefinedCell::new(pair[0], pair[1])).collect();
    evaluate(&mut density, &mut cells)?;
    if endless {
        follow_tail(&mut density, &mut cells)?;
    }
    let (cells, masses) = halved(&mut density, cells, tolerance)?;
    let cells = joined(&mut density, trimmed(cells, &masses), &masses, tolerance)?;
    let cells = settled(&mut density, cells)?;
    let cells = settled(&mut density, cells)?;
    let left_out = cells.iter().map(RefinedCell::left_out).sum::<f64>() / masses.total();
    let cut = if endless { ENDS.0 } else { 0.0 };
    let boundaries = cells.iter().map(|cell| cell.low).chain(cells.last().map(|cell| cell.high)).collect();
    let coefficients = cells.iter().map(|cell| cell.coefficients).collect();
    Ok(Refined { series: Piecewise { boundaries, coefficients }, left_out, cut })
}

/// A cell and what the density is there.
#[derive(Debug, Clone)]
struct RefinedCell {
    low: f64,
    high: f64,
    /// Halvings that led to it, and what the cell that was halved left out, and the one before that.
    depth: u32,
    before: [f64; 2],
    /// Whether the density breaks here, as far as it could be closed in on: at the upper end of the cell, say.
    non_smooth: bool,
    values: Nodal,
    coefficients: Nodal,
}

impl RefinedCell {
    fn new(low: f64, high: f64) -> Self {
        let (before, values) = ([f64::INFINITY; 2], Nodal::default());
        Self { low, high, depth: 0, before, non_smooth: false, values, coefficients: values }
    }

    fn half(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    fn points(&self) -> impl Iterator<Item = f64> {
        let (middle, half) = (0.5 * (self.low + self.high), self.half());
        RULE.nodes.iter().map(move |t| middle + half * t)
    }

    /// ∫xⁿ p over the cell.
    fn moment(&self, order: i32) -> f64 {
        let terms = self.points().zip(self.values).zip(RULE.weights);
        self.half() * terms.map(|((x, p), w)| w * p * x.powi(order)).sum::<f64>()
    }

    /// Mass that the series leaves out, if its errors do not cancel.
    fn left_out(&self) -> f64 {
        2.0 * tail(&self.coefficients) * self.half()
    }

    /// Largest density × half width.
    fn size(&self) -> f64 {
        self.values.iter().fold(0.0, |largest: f64, p| largest.max(*p)) * self.half()
    }

    fn is_resolved(&self, masses: &RefinedMasses, tolerance: f64) -> bool {
        let narrowest = self.half() <= 16.0 * f64::EPSILON * self.high;
        if masses.is_negligible(self.low) || narrowest || self.depth > MOST_HALVINGS {
            return true;
        }
        let (left_out, size) = (self.left_out(), self.size());
        // Rounding, of the function or of where it is taken, halves with the width; a kink quarters what is left out, a smooth
        // function does far more.
        let rounding = size * f64::max(1e-9, 16.0 * f64::EPSILON * self.high / self.half());
        let noise = self.depth > 3 && left_out > 0.16 * self.before[1] && left_out < rounding;
        let non_smooth = left_out > 1e-3 * self.before[0] && left_out > 16.0 * f64::EPSILON * size;
        noise || left_out <= tolerance * masses.least(self.low) && !non_smooth
    }

    /// Whether halving twice gained no more than it does where a function breaks.
    fn is_slow(&self) -> bool {
        self.left_out() > 1e-3 * self.before[0] && self.before[0] > 1e-3 * self.before[1]
    }

    fn halves(&self) -> [Self; 2] {
        let middle = 0.5 * (self.low + self.high);
        let (depth, before) = (self.depth + 1, [self.left_out(), self.before[0]]);
        [(self.low, middle), (middle, self.high)].map(|(low, high)| Self {
            depth,
            before,
            ..Self::new(low, high)
        })
    }

    /// Whether one series serves two cells as well as theirs do; a part that rounding of its place may move in or out is
    /// not felt.
    fn replaces(&self, pair: &[Self], masses: &RefinedMasses, tolerance: f64) -> bool {
        if pair[0].non_smooth {
            return false;
        }
        let parts = |value: fn(&Self) -> f64| pair.iter().map(value).sum::<f64>();
        let allowed = (tolerance * masses.least(self.low)).max(parts(Self::left_out));
        let largest = pair.iter().map(|cell| cell.size() / cell.half()).fold(0.0, f64::max);
        let moved = (self.moment(0) - parts(|cell| cell.moment(0))).abs();
        self.left_out() <= allowed && moved <= allowed.max(32.0 * f64::EPSILON * self.high * largest)
    }
}

/// Fills in the density at the Gauss points of all cells, by one call.
fn evaluate(density: &mut impl Density, cells: &mut [RefinedCell]) -> Result<()> {
    let points: Vec<f64> = cells.iter().flat_map(RefinedCell::points).collect();
    let values = density(&points)?;
    if values.len() != points.len() {
        let expected = format!("{} values, one for each point", points.len());
        return Err(Error::invalid("density", expected, values.len()));
    }
    if let Some((x, p)) = points.iter().zip(&values).find(|(_, p)| !(p.is_finite() && **p >= 0.0)) {
        return Err(Error::invalid("density", "a finite density of 0 or above", format!("{p} at {x}")));
    }
    for (cell, values) in cells.iter_mut().zip(values.chunks_exact(RULE.nodes.len())) {
        cell.values.copy_from_slice(values);
        cell.coefficients = RULE.coefficients(&cell.values);
    }
    Ok(())
}

/// Adds cells beyond the last one, each twice as wide, until one holds next to nothing.
fn follow_tail(density: &mut impl Density, cells: &mut Vec<RefinedCell>) -> Result<()> {
    let last = &cells[cells.len() - 1];
    let (mut end, mut width) = (last.high, last.high - last.low);
    let [mut mass, mut second] = [0, 2].map(|order| cells.iter().map(|cell| cell.moment(order)).sum::<f64>());
    while end < FARTHEST {
        let mut next = [RefinedCell::new(end, end + width)];
        evaluate(density, &mut next)?;
        let here = (next[0].moment(0), next[0].moment(2));
        (mass, second, end, width) = (mass + here.0, second + here.1, end + width, 2.0 * width);
        cells.extend(next);
        if here.0 <= ENDS.0 * mass && here.1 <= ENDS.1 * second {
            return Ok(());
        }
    }
    Err(Error::invalid("density", "a tail that leaves the second moment finite", "a heavier one"))
}

/// Cells halved until each is resolved, in order; a place where the density breaks is closed in on.
fn halved(
    density: &mut impl Density,
    mut pending: Vec<RefinedCell>,
    tolerance: f64,
) -> Result<(Vec<RefinedCell>, RefinedMasses)> {
    let mut done: Vec<RefinedCell> = Vec::new();
    loop {
        let masses = RefinedMasses::new(done.iter().chain(&pending));
        let (resolved, rest): (Vec<_>, Vec<_>) =
            pending.into_iter().partition(|cell| cell.is_resolved(&masses, tolerance));
        done.extend(resolved.into_iter().map(|cell| RefinedCell { non_smooth: cell.is_slow(), ..cell }));
        if rest.is_empty() {
            done.sort_by(|a, b| a.low.total_cmp(&b.low));
            // Of neighbours that hold the same break, the last.
            for i in 1..done.len() {
                done[i - 1].non_smooth &= !done[i].non_smooth;
            }
            return Ok((done, masses));
        }
        if done.len() + 2 * rest.len() > MOST_CELLS {
            let reached = rest.iter().map(RefinedCell::left_out).sum::<f64>() / masses.total();
            let what = "the density as a series".into();
            return Err(Error::Accuracy {
                key: String::new(),
                what,
                reached: Float(reached),
                wanted: Float(tolerance),
            });
        }
        pending = rest.iter().flat_map(RefinedCell::halves).collect();
        evaluate(density, &mut pending)?;
    }
}

/// The cells without those at the ends that hold next to nothing.
fn trimmed(mut cells: Vec<RefinedCell>, masses: &RefinedMasses) -> Vec<RefinedCell> {
    let last = cells.partition_point(|cell| masses.from(cell.low) > ENDS.0 * masses.total());
    cells.truncate(last.max(1));
    let mean = masses.total() / (cells[cells.len() - 1].high - cells[0].low);
    let faint = |cell: &RefinedCell| {
        masses.up_to(cell.low) <= STARTS.0 * masses.total() && cell.size() <= STARTS.1 * mean * cell.half()
    };
    let first = cells.iter().take_while(|cell| faint(cell)).count();
    cells.drain(..first);
    cells
}

/// Neighbours joined as long as one series serves both: what is left are the cells that the density needs.
fn joined(
    density: &mut impl Density,
    mut cells: Vec<RefinedCell>,
    masses: &RefinedMasses,
    tolerance: f64,
) -> Result<Vec<RefinedCell>> {
    let (mut offset, mut idle) = (0, 0);
    while idle < 2 {
        let offered = cells.split_off(offset.min(cells.len()));
        let mut unions: Vec<_> =
            offered.chunks_exact(2).map(|c| RefinedCell::new(c[0].low, c[1].high)).collect();
        evaluate(density, &mut unions)?;
        let before = cells.len() + offered.len();
        for (pair, union) in offered.chunks_exact(2).zip(unions) {
            if union.replaces(pair, masses, tolerance) {
                cells.push(RefinedCell { non_smooth: pair[1].non_smooth, ..union })
            } else {
                cells.extend_from_slice(pair)
            }
        }
        cells.extend_from_slice(offered.chunks_exact(2).remainder());
        idle = if cells.len() < before { 0 } else { idle + 1 };
        offset = 1 - offset;
    }
    Ok(cells)
}

/// The cells with ends at kinks moved to where their neighbours' series meet.
fn settled(density: &mut impl Density, mut cells: Vec<RefinedCell>) -> Result<Vec<RefinedCell>> {
    for i in 1..cells.len() {
        let (left, right) = (&cells[i - 1], &cells[i]);
        let jump = series(&right.coefficients, -1.0) - series(&left.coefficients, 1.0);
        let slope = |cell: &RefinedCell, t: f64| series(&derivative(&cell.coefficients), t) / cell.half();
        let shift = jump / (slope(left, 1.0) - slope(right, -1.0));
        if left.non_smooth && shift.abs() < 1e-6 * left.half().min(right.half()) {
            cells[i - 1].high += shift;
            cells[i].low = cells[i - 1].high;
        }
    }
    evaluate(density, &mut cells)?;
    Ok(cells)
}

/// For each lower end of a cell, the masses up to the upper end of the cell and from its lower end on.
struct RefinedMasses(Vec<(f64, f64, f64)>);

impl RefinedMasses {
    fn new<'a>(cells: impl Iterator<Item = &'a RefinedCell>) -> Self {
        let mut masses: Vec<_> = cells.map(|cell| (cell.low, cell.moment(0), cell.moment(0))).collect();
        masses.sort_by(|a, b| a.0.total_cmp(&b.0));
        for i in 1..masses.len() {
            masses[i].1 += masses[i - 1].1;
        }
        for i in (1..masses.len()).rev() {
            masses[i - 1].2 += masses[i].2;
        }
        Self(masses)
    }

    fn at(&self, low: f64) -> &(f64, f64, f64) {
        &self.0[self.0.partition_point(|m| m.0 < low)]
    }

    fn up_to(&self, low: f64) -> f64 {
        self.at(low).1
    }

    fn from(&self, low: f64) -> f64 {
        self.at(low).2
    }

    fn least(&self, low: f64) -> f64 {
        self.up_to(low).min(self.from(low))
    }

    fn is_negligible(&self, low: f64) -> bool {
        self.from(low) <= ENDS.0 * self.total() || self.up_to(low) <= STARTS.0 * self.total()
    }

    fn total(&self) -> f64 {
        self.0[0].2
    }
}
