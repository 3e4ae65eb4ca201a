//! Adaptive Legendre series of a density that is evaluated at many points per call: cells are bisected until
//! they resolve it, then merged.

use crate::numerics::legendre::{Nodal, RULE, derivative, series};
use crate::numerics::order::sort_by_number;
use crate::numerics::piecewise::{Piecewise, tail};
use crate::{Error, Float, Result};

/// Number of cells at which a function is rejected as noise.
const MOST_CELLS: usize = 20_000;

/// Fractions of the mass and of the second moment at which an infinite tail is cut.
const ENDS: (f64, f64) = (1e-40, 1e-16);

/// Fraction of the mass below which cells at the lower end are not refined; and, relative to the mean, the
/// density below which they are dropped.
const STARTS: (f64, f64) = (1e-30, 1e-20);

/// Largest x at which a tail is cut: its third power is still finite.
const FARTHEST: f64 = 1e100;

/// Bisections that reach 1e-75 of the width, where 1e-18 of x^(−3/4) is left.
const MOST_HALVINGS: u32 = 250;

/// A density that is evaluated at many points per call.
pub(super) trait Density: FnMut(&[f64]) -> Result<Vec<f64>> {}

impl<F: FnMut(&[f64]) -> Result<Vec<f64>>> Density for F {}

/// A density as a series.
pub(super) struct Refined {
    pub(super) series: Piecewise,
    /// Fraction of the mass that the cells miss.
    pub(super) truncation: f64,
    /// Fraction of the mass beyond the last cell.
    pub(super) cut: f64,
}

/// The series of a density between `boundaries`, and beyond the last one if it is `endless`. The truncation
/// error of each cell is at most `tolerance` × the mass from its lower end on, and × the mass up to its upper
/// end.
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
    // Bisect until resolved, drop negligible ends, merge what bisection has cut too finely, then put kinks
    // exactly on boundaries; the second alignment uses the series of the first.
    let (cells, masses) = bisected(&mut density, cells, tolerance)?;
    let cells = merged(&mut density, trimmed(cells, &masses), &masses, tolerance)?;
    let cells = aligned(&mut density, cells)?;
    let cells = aligned(&mut density, cells)?;
    let truncation = cells.iter().map(RefinedCell::truncation).sum::<f64>() / masses.total();
    let cut = if endless { ENDS.0 } else { 0.0 };
    let boundaries = cells.iter().map(|cell| cell.low).chain(cells.last().map(|cell| cell.high)).collect();
    let coefficients = cells.iter().map(|cell| cell.coefficients).collect();
    Ok(Refined { series: Piecewise { boundaries, coefficients }, truncation, cut })
}

/// A cell with the density on it.
#[derive(Debug, Clone)]
struct RefinedCell {
    low: f64,
    high: f64,
    /// Number of bisections that led to it.
    depth: u32,
    /// Truncation errors of its parent and grandparent.
    before: [f64; 2],
    /// Whether the density is not smooth at the upper end of the cell, as far as bisection could locate the
    /// point.
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

    /// The mass that the series misses, if its errors do not cancel.
    fn truncation(&self) -> f64 {
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
        let (truncation, size) = (self.truncation(), self.size());
        // Rounding of the function or of its argument halves with the width; the error of a kink falls by a
        // factor of four, that of a smooth function by far more.
        let rounding = size * f64::max(1e-9, 16.0 * f64::EPSILON * self.high / self.half());
        let noise = self.depth > 3 && truncation > 0.16 * self.before[1] && truncation < rounding;
        let non_smooth = truncation > 1e-3 * self.before[0] && truncation > 16.0 * f64::EPSILON * size;
        noise || truncation <= tolerance * masses.least(self.low) && !non_smooth
    }

    /// Whether the last two bisections reduced the error no more than they do at a kink or jump.
    fn is_slow(&self) -> bool {
        self.truncation() > 1e-3 * self.before[0] && self.before[0] > 1e-3 * self.before[1]
    }

    fn halves(&self) -> [Self; 2] {
        let middle = 0.5 * (self.low + self.high);
        let (depth, before) = (self.depth + 1, [self.truncation(), self.before[0]]);
        [(self.low, middle), (middle, self.high)].map(|(low, high)| Self {
            depth,
            before,
            ..Self::new(low, high)
        })
    }

    /// Whether one series represents two cells as well as their own do. The effect of rounding of the
    /// position of a jump is tolerated.
    fn replaces(&self, pair: &[Self], masses: &RefinedMasses, tolerance: f64) -> bool {
        if pair[0].non_smooth {
            return false;
        }
        let parts = |value: fn(&Self) -> f64| pair.iter().map(value).sum::<f64>();
        let allowed = (tolerance * masses.least(self.low)).max(parts(Self::truncation));
        let largest = pair.iter().map(|cell| cell.size() / cell.half()).fold(0.0, f64::max);
        let moved = (self.moment(0) - parts(|cell| cell.moment(0))).abs();
        self.truncation() <= allowed && moved <= allowed.max(32.0 * f64::EPSILON * self.high * largest)
    }
}

/// Evaluates the density at the Gauss points of all cells in one call.
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

/// Adds cells beyond the last one, each twice as wide as the one before, until one is negligible.
fn follow_tail(density: &mut impl Density, cells: &mut Vec<RefinedCell>) -> Result<()> {
    let last = &cells[cells.len() - 1];
    let (mut end, mut width) = (last.high, last.high - last.low);
    let [mut mass, mut second] = [0, 2].map(|order| cells.iter().map(|cell| cell.moment(order)).sum::<f64>());
    while end < FARTHEST {
        let mut next = [RefinedCell::new(end, end + width)];
        // The number of cells grows only as the logarithm of the length of the tail.
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

/// Bisects cells until each is resolved; returns them in order. Bisection closes in on points where the
/// density is not smooth.
fn bisected(
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
            sort_by_number(&mut done, |item| item.low);
            // Of neighbours that contain the same point, the last.
            for i in 1..done.len() {
                done[i - 1].non_smooth &= !done[i].non_smooth;
            }
            return Ok((done, masses));
        }
        if done.len() + 2 * rest.len() > MOST_CELLS {
            let reached = rest.iter().map(RefinedCell::truncation).sum::<f64>() / masses.total();
            let what = "the density as a series".into();
            return Err(Error::Accuracy {
                key: String::new(),
                what,
                reached: Float(reached),
                wanted: Float(tolerance),
            });
        }
        // All cells of a level are evaluated in one call: a density written in Python costs per
        // call, not per point.
        pending = rest.iter().flat_map(RefinedCell::halves).collect();
        evaluate(density, &mut pending)?;
    }
}

/// The cells without negligible ones at the ends.
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

/// Merges neighbours as long as one series represents both; what is left are the cells that the density
/// needs.
fn merged(
    density: &mut impl Density,
    mut cells: Vec<RefinedCell>,
    masses: &RefinedMasses,
    tolerance: f64,
) -> Result<Vec<RefinedCell>> {
    let (mut offset, mut passes_without_merge) = (0, 0);
    // Pairs (0, 1), (2, 3), … and then (1, 2), (3, 4), …: any two neighbours have been tried before
    // the loop ends.
    while passes_without_merge < 2 {
        let candidates = cells.split_off(offset.min(cells.len()));
        let mut unions: Vec<_> =
            candidates.chunks_exact(2).map(|c| RefinedCell::new(c[0].low, c[1].high)).collect();
        evaluate(density, &mut unions)?;
        let before = cells.len() + candidates.len();
        for (pair, union) in candidates.chunks_exact(2).zip(unions) {
            if union.replaces(pair, masses, tolerance) {
                cells.push(RefinedCell { non_smooth: pair[1].non_smooth, ..union })
            } else {
                cells.extend_from_slice(pair)
            }
        }
        cells.extend_from_slice(candidates.chunks_exact(2).remainder());
        passes_without_merge = if cells.len() < before { 0 } else { passes_without_merge + 1 };
        offset = 1 - offset;
    }
    Ok(cells)
}

/// Moves cell boundaries at kinks to where the series of their neighbours intersect.
fn aligned(density: &mut impl Density, mut cells: Vec<RefinedCell>) -> Result<Vec<RefinedCell>> {
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

/// For each cell its lower end, the mass up to its upper end, and the mass from its lower end on.
struct RefinedMasses(Vec<(f64, f64, f64)>);

impl RefinedMasses {
    fn new<'a>(cells: impl Iterator<Item = &'a RefinedCell>) -> Self {
        let mut masses: Vec<_> = cells.map(|cell| (cell.low, cell.moment(0), cell.moment(0))).collect();
        sort_by_number(&mut masses, |item| item.0);
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
