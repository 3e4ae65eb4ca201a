//! A distribution whose density is a Legendre series on each of some cells: represents any density nearly to
//! rounding.

use num_complex::Complex64;

use super::refine::{Refined, refine};
use super::{ALL, Breakpoint, Law, Parameter, SharedLaw, Zone, unknown};
use crate::monitor::{Monitor, Watch};
use crate::numerics::legendre::{NODES, Nodal, RULE, end_derivative, series};
use crate::numerics::piecewise::{Piecewise, tail};
use crate::random::Stream;
use crate::{Error, Float, Result};

/// A density that is a polynomial of degree at most 15 on each cell between given boundaries and 0 outside,
/// normalised: p(x) = Σ_n c_n P_n(t), t from −1 to 1 across the cell, P_n the Legendre polynomials.
///
/// It is given by its coefficients, or computed from a function ([`Series::resolve`]). Survival, moments and
/// transform are the integrals of the series: the relative accuracy of S, ln S and the hazard rate is that of
/// the series, down to the end of the last cell. A density below 0 by rounding is taken as 0. An infinite
/// tail that was `cut` off is missing, and quantities that depend on it are declared unreliable
/// ([`Law::known_rate`]).
#[derive(Clone, PartialEq)]
pub struct Series {
    density: Piecewise,
    /// The mean of the density from the lower end of the cell to x, and from x to the upper end.
    mean_below: Piecewise,
    mean_above: Piecewise,
    /// Moments of order 0 to 3 of the mass above each boundary.
    above: Vec<[f64; 4]>,
    /// P(ξ ≤ boundary).
    below: Vec<f64>,
    std: f64,
    cut: f64,
    breakpoints: Vec<Breakpoint>,
    zones: Vec<Zone>,
}

/// A density below 0 by less than this fraction of its maximum counts as 0.
const NEGATIVE: f64 = 1e-9;

/// Largest fraction that may be cut off.
const MOST_CUT: f64 = 1e-9;

/// Largest number of steps; bisection alone needs 60.
const MOST_STEPS: usize = 100;

/// A breakpoint counts if it changes the distribution, over a standard deviation, by more than this.
const FELT: f64 = 1e-14;

impl Series {
    /// The distribution with these coefficients, c_0 first, of any total mass; missing ones are 0. `cut` is
    /// the fraction of an infinite tail beyond the last boundary, 0 if the support ends there.
    ///
    /// # Errors
    /// Fewer than two boundaries, boundaries not rising from 0 or above, lists of coefficients not one for
    /// each cell, an empty list or one longer than 16, a density below 0, no mass at all, or a cut outside
    /// [0, 1e-9].
    pub fn new(boundaries: &[f64], coefficients: &[Vec<f64>], cut: f64) -> Result<Self> {
        Self::new_with(boundaries, coefficients, cut, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// Those of [`Self::new`]; stopped by the monitor.
    pub fn new_with(
        boundaries: &[f64],
        coefficients: &[Vec<f64>],
        cut: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        check_boundaries(boundaries)?;
        let cells = boundaries.len() - 1;
        if coefficients.len() != cells {
            let expected = format!("{cells} lists, one for each cell");
            return Err(Error::invalid("coefficients", expected, coefficients.len()));
        }
        if !(0.0..=MOST_CUT).contains(&cut) {
            return Err(Error::invalid("cut", format!("a fraction from 0 to {MOST_CUT:e}"), cut));
        }
        let padded: Result<Vec<Nodal>> = coefficients.iter().enumerate().map(pad).collect();
        Self::scaled(Piecewise { boundaries: boundaries.to_vec(), coefficients: padded? }, cut, monitor)
    }

    /// The distribution of a density given by a function, of any total mass, and the fraction of the mass
    /// that the series misses.
    ///
    /// `density` is called with many points at once and returns the density at each. It may have jumps and
    /// kinks anywhere, and rise like (x − x₀)^−¾ above the first of the `boundaries`; these must be so close
    /// that no peak is missed between the 16 Gauss points of each cell. The last may be infinite: cells
    /// beyond the one before then double in width until 1e-40 of the mass is left. The truncation error of a
    /// cell is at most `tolerance` × the mass above its lower end and × the mass below its upper end, so that
    /// S and the hazard rate keep their digits into the tails: for a tolerance of 1e-14 and a density right
    /// to rounding, 12 digits down to S = 1e-26.
    ///
    /// # Errors
    /// Those of `density`; a density that is below 0 or not finite, or a wrong number of values; boundaries
    /// that do not rise from 0 or above; a tolerance outside [1e-15, 1e-3]; a tail so heavy that the second
    /// moment diverges; [`Error::Accuracy`] if the tolerance is not reached with twenty thousand cells, as
    /// for noise, or if a density becomes infinite other than at 0.
    pub fn resolve(
        density: impl FnMut(&[f64]) -> Result<Vec<f64>>,
        boundaries: &[f64],
        tolerance: f64,
    ) -> Result<(Self, f64)> {
        let (finite, last) = boundaries.split_at(boundaries.len().saturating_sub(1));
        let endless = last == [f64::INFINITY];
        let finite = if endless { finite } else { boundaries };
        check_boundaries(finite)?;
        if !(1e-15..=1e-3).contains(&tolerance) {
            return Err(Error::invalid("tolerance", "a number from 1e-15 to 1e-3", tolerance));
        }
        let Refined { series, truncation, cut } = refine(density, finite, endless, tolerance)?;
        let law = Self::scaled(series, cut, &mut ())?;
        // Rounding of the function may add up, cell by cell, to more than the tolerance.
        let wanted = tolerance.max(1e-11);
        if truncation > wanted {
            let what = "the density as a series".into();
            return Err(Error::Accuracy {
                key: String::new(),
                what,
                reached: Float(truncation),
                wanted: Float(wanted),
            });
        }
        Ok((law, truncation))
    }

    /// The distribution of a density that is the solution of an equation, of any total mass, with known
    /// `breakpoints`. Its accuracy is limited, so breakpoints are given rather than detected.
    ///
    /// # Errors
    /// A density below 0, or no mass at all.
    pub(crate) fn solved(density: Piecewise, breakpoints: Vec<Breakpoint>) -> Result<Self> {
        let mut law = Self { breakpoints, ..Self::scaled(density, 0.0, &mut ())? };
        law.zones = law.find_zones(&Watch::new(&mut ()))?;
        Ok(law)
    }

    /// The boundaries of the cells.
    pub fn boundaries(&self) -> &[f64] {
        &self.density.boundaries
    }

    /// The normalised coefficients of each cell.
    pub fn coefficients(&self) -> &[[f64; NODES]] {
        &self.density.coefficients
    }

    /// The fraction of an infinite tail beyond the last boundary.
    pub fn cut(&self) -> f64 {
        self.cut
    }

    /// The distribution of a density of any total mass, after a check of its sign.
    ///
    /// # Errors
    /// A density below 0, or no mass at all; stopped by the monitor.
    pub(super) fn scaled(mut density: Piecewise, cut: f64, monitor: &mut dyn Monitor) -> Result<Self> {
        let watch = &Watch::new(monitor);
        check_sign(&density, watch)?;
        let total = density.integral();
        if !(total.is_finite() && total > 0.0) {
            return Err(Error::invalid("coefficients", "a finite mass above 0", total));
        }
        // A mass that is 1 to rounding stays as it was given.
        if (total - 1.0).abs() > 1e-14 {
            density.coefficients.iter_mut().flatten().for_each(|c| *c /= total);
        }
        let (mean_below, mean_above) = (means(&density, -1.0, watch)?, means(&density, 1.0, watch)?);
        let cells = density.coefficients.len();
        let (above, below) = (vec![[0.0; 4]; cells + 1], vec![0.0; cells + 1]);
        let (breakpoints, zones) = (Vec::new(), Vec::new());
        let mut law =
            Self { density, mean_below, mean_above, above, below, std: 0.0, cut, breakpoints, zones };
        law.sum(watch)?;
        law.breakpoints = law.find_breaks(watch)?;
        law.zones = law.find_zones(watch)?;
        Ok(law)
    }

    /// Sums masses and moments above and below each boundary.
    fn sum(&mut self, watch: &Watch<'_>) -> Result<()> {
        let cells = self.density.coefficients.len();
        // Position and density at the Gauss points of each cell.
        let mut points = vec![[(0.0, 0.0); NODES]; cells];
        let integral = |(low, high): (f64, f64), points: &[(f64, f64); NODES], g: &dyn Fn(f64) -> f64| {
            let sum: f64 = (0..NODES).map(|i| RULE.weights[i] * (g(points[i].0) * points[i].1)).sum();
            0.5 * (high - low) * sum
        };
        for cell in (0..cells).rev() {
            watch.check_at(cell)?;
            let ends @ (low, high) = (self.density.boundaries[cell], self.density.boundaries[cell + 1]);
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            points[cell] = RULE.nodes.map(|t| (middle + half * t, self.value(cell, middle + half * t)));
            // Sums from both ends: a tail is the sum of its own cells only, and keeps its relative
            // accuracy.
            let part = |n: i32| match n {
                0 => self.upper(cell, low),
                n => integral(ends, &points[cell], &|x| x.powi(n)),
            };
            self.above[cell] = std::array::from_fn(|n| self.above[cell + 1][n] + part(n as i32));
        }
        for cell in 0..cells {
            self.below[cell + 1] = self.below[cell] + self.lower(cell, self.density.boundaries[cell + 1]);
        }
        let mean = self.mean();
        let ends = self.density.boundaries.windows(2).map(|ends| (ends[0], ends[1]));
        let squares = ends.zip(&points).map(|(ends, points)| integral(ends, points, &|x| (x - mean).powi(2)));
        self.std = squares.sum::<f64>().sqrt();
        Ok(())
    }

    fn value(&self, cell: usize, x: f64) -> f64 {
        self.density.value_in(cell, x).max(0.0)
    }

    /// ∫ g p over a cell.
    fn integrate(&self, cell: usize, g: impl Fn(f64) -> f64) -> f64 {
        let (a, b) = (self.density.boundaries[cell], self.density.boundaries[cell + 1]);
        RULE.integrate(a, b, |x| g(x) * self.value(cell, x))
    }

    /// ∫ξⁿ p dξ from x to the end of the cell.
    fn upper_part(&self, cell: usize, x: f64, order: u32) -> f64 {
        let end = self.density.boundaries[cell + 1];
        if order == 0 {
            return self.upper(cell, x);
        }
        RULE.integrate(x, end, |x| x.powi(order as i32) * self.value(cell, x))
    }

    /// ∫p dξ from x to the end of the cell.
    fn upper(&self, cell: usize, x: f64) -> f64 {
        (self.density.boundaries[cell + 1] - x) * self.mean_above.value_in(cell, x).max(0.0)
    }

    /// ∫p dξ from the start of the cell to x.
    fn lower(&self, cell: usize, x: f64) -> f64 {
        (x - self.density.boundaries[cell]) * self.mean_below.value_in(cell, x).max(0.0)
    }

    fn start(&self) -> f64 {
        self.density.boundaries[0]
    }

    /// The zero within a cell of a function whose slope is the density, by Newton's method safeguarded by
    /// bisection.
    fn invert(&self, cell: usize, excess: impl Fn(f64) -> f64) -> f64 {
        let (mut a, mut b) = (self.density.boundaries[cell], self.density.boundaries[cell + 1]);
        let mut x = 0.5 * (a + b);
        for _ in 0..MOST_STEPS {
            let excess = excess(x);
            let step = excess / self.value(cell, x);
            if step.abs() <= 2.0 * f64::EPSILON * x {
                break;
            }
            if excess > 0.0 {
                b = x
            } else {
                a = x
            }
            // A Newton step outside the bracket is replaced by bisection: convergence is certain,
            // and quadratic near the root.
            x = if x - step > a && x - step < b { x - step } else { 0.5 * (a + b) };
        }
        x
    }

    /// A derivative of the density at the lower end of a cell (`side` = −1) or at the upper one (1), and the
    /// error it may have from rounding and truncation.
    fn derivative(&self, cell: usize, side: f64, order: u32) -> (f64, f64) {
        let terms = &self.density.coefficients[cell];
        let (middle, half) = self.density.cell(cell);
        let scale = half.powi(-(order as i32));
        // Of values, and of the points at which they are taken.
        let rounding = 4.0 * f64::EPSILON * (1.0 + middle / half);
        // Derivatives at the ends of a cell amplify errors of coefficients by n²ᵈ; a jump smaller
        // than that is no property of the density.
        let doubt = tail(terms).max(rounding * terms.iter().map(|c| c.abs()).sum::<f64>());
        let terms = (0..NODES).map(|n| (terms[n], end_derivative(n, order, side)));
        let (value, amplified) =
            terms.fold((0.0, 0.0), |(value, sum), (c, d)| (value + c * d, sum + d.abs()));
        (scale * value, 30.0 * scale * doubt * amplified)
    }

    /// The jump of a derivative at a boundary, if it exceeds its error.
    fn jump(&self, boundary: usize, order: u32) -> Option<Breakpoint> {
        let cells = self.density.coefficients.len();
        let right = if boundary < cells { self.derivative(boundary, -1.0, order) } else { (0.0, 0.0) };
        let left = if boundary > 0 { self.derivative(boundary - 1, 1.0, order) } else { (0.0, 0.0) };
        let amplitude = right.0 - left.0;
        let position = self.density.boundaries[boundary];
        let found = Breakpoint { position, exponent: f64::from(order), amplitude };
        let felt = found.weight(self.std) * self.std > FELT;
        (felt && amplitude.abs() > right.1 + left.1).then_some(found)
    }

    /// The power law with which the density starts at the lower end (`side` = −1) or upper end (1) of the
    /// support, where cells narrow towards it; `None` for a whole power.
    fn power_at_end(&self, side: f64) -> Option<Breakpoint> {
        let edges = self.boundaries();
        let (end, next) =
            if side < 0.0 { (edges[0], edges[1]) } else { (edges[edges.len() - 1], edges[edges.len() - 2]) };
        let first = (next - end).abs();
        let at = |octave: f64| Law::density(self, end - side * first * octave);
        let (near, far) = ((at(2.0) / at(1.0)).log2(), (at(4.0) / at(2.0)).log2());
        // Richardson extrapolation of the logarithmic slopes over two octaves to the end of the support.
        let exponent = 2.0 * near - far;
        let steep =
            first < 0.01 * self.std && (near - far).abs() < 0.1 && (exponent - exponent.round()).abs() > 0.01;
        let amplitude = at(1.0) * libm::tgamma(exponent + 1.0) / first.powf(exponent);
        let set_out = Breakpoint { position: -side * end, exponent, amplitude };
        steep.then(|| if side < 0.0 { set_out } else { set_out.mirrored() })
    }

    fn find_breaks(&self, watch: &Watch<'_>) -> Result<Vec<Breakpoint>> {
        let last = self.density.coefficients.len();
        let end = |side: f64, boundary: usize| {
            self.power_at_end(side)
                .map_or_else(|| self.breaks_at_end(boundary), |power_at_end| vec![power_at_end])
        };
        let mut found = end(-1.0, 0);
        for boundary in 1..last {
            watch.check_at(boundary)?;
            found.extend((0..2).filter_map(|order| self.jump(boundary, order)));
        }
        found.extend(end(1.0, last));
        Ok(found)
    }

    /// Zones that begin and end at cell boundaries.
    fn find_zones(&self, watch: &Watch<'_>) -> Result<Vec<Zone>> {
        let bulk = Zone::of(self.quantile(ALL), self.upper_quantile(ALL), self.mean(), self.std);
        // Zones describe the density, not how it was found: cells that one polynomial replaces are
        // joined before.
        let joined = self.density.clone().joined_with(1e-14, |cell| watch.check_at(cell))?;
        let cells = || joined.boundaries.windows(2).map(|w| (w[0], w[1], (w[1] - w[0]) / Zone::CELL));
        let inside = || cells().filter(|(low, high, _)| *low < bulk.high && *high > bulk.low);
        let low = inside().map(|cell| cell.0).fold(f64::INFINITY, f64::min);
        let high = inside().map(|cell| cell.1).fold(0.0, f64::max);
        let resolution = inside().map(|cell| cell.2).fold(self.std, f64::max);
        // Cells that narrow towards a breakpoint are bisected further because of rounding, near a pole to a
        // twentieth of their distance. The nearest breakpoints are those beside the cell.
        let mut places: Vec<f64> = self.breakpoints.iter().map(|b| b.position).collect();
        places.sort_by(f64::total_cmp);
        let apart = |(low, high, _): &(f64, f64, f64)| {
            let middle = 0.5 * (low + high);
            let above = places.partition_point(|place| *place < middle);
            let mut beside = places[above.saturating_sub(1)..].iter().take(2);
            beside.all(|place| high - low < 0.02 * (middle - place).abs())
        };
        let fine = cells().filter(apart).map(|(low, high, resolution)| Zone { low, high, resolution });
        Ok(std::iter::once(Zone { low, high, resolution }).chain(fine).collect())
    }

    /// The breakpoints at an end of the support: jump and kink, or else the lowest derivative that is not 0.
    fn breaks_at_end(&self, boundary: usize) -> Vec<Breakpoint> {
        const HIGHEST: u32 = 4;
        let low: Vec<_> = (0..2).filter_map(|order| self.jump(boundary, order)).collect();
        if low.is_empty() {
            return (2..=HIGHEST).find_map(|order| self.jump(boundary, order)).into_iter().collect();
        }
        low
    }
}

/// Means of the density between x and the end of its cell at t = `side`: the integral divided by x − end.
/// This is a series of the same degree and keeps its relative accuracy where the integral vanishes.
fn means(density: &Piecewise, side: f64, watch: &Watch<'_>) -> Result<Piecewise> {
    let mean = |c: &Nodal, t: f64| RULE.integrate(t, side, |t| series(c, t)) / (side - t);
    let cell = |(cell, c): (usize, &Nodal)| {
        watch.check_at(cell)?;
        Ok(RULE.coefficients(&RULE.nodes.map(|t| mean(c, t))))
    };
    let coefficients = density.coefficients.iter().enumerate().map(cell).collect::<Result<_>>()?;
    Ok(Piecewise { boundaries: density.boundaries.clone(), coefficients })
}

fn check_boundaries(boundaries: &[f64]) -> Result<()> {
    if boundaries.len() < 2 {
        return Err(Error::invalid("boundaries", "at least two finite ones", boundaries.len()));
    }
    super::not_negative("boundaries", boundaries[0])?;
    match boundaries.windows(2).find(|pair| !(pair[1] > pair[0] && pair[1].is_finite())) {
        Some(pair) => {
            Err(Error::invalid("boundaries", format!("finite numbers that rise, after {}", pair[0]), pair[1]))
        }
        None => Ok(()),
    }
}

fn pad((cell, given): (usize, &Vec<f64>)) -> Result<Nodal> {
    let key = format!("coefficients.{cell}");
    if given.is_empty() || given.len() > NODES {
        return Err(Error::invalid(key, format!("1 to {NODES} numbers"), given.len()));
    }
    if let Some(wrong) = given.iter().find(|c| !c.is_finite()) {
        return Err(Error::invalid(key, "finite numbers", wrong));
    }
    let mut padded = [0.0; NODES];
    padded[..given.len()].copy_from_slice(given);
    Ok(padded)
}

fn check_sign(density: &Piecewise, watch: &Watch<'_>) -> Result<()> {
    let mut values = Vec::with_capacity(NODES * density.coefficients.len());
    for cell in 0..density.coefficients.len() {
        watch.check_at(cell)?;
        let (middle, half) = density.cell(cell);
        values.extend(RULE.nodes.map(|t| (middle + half * t, density.value_in(cell, middle + half * t))));
    }
    let largest = values.iter().fold(0.0_f64, |largest, (_, p)| largest.max(*p));
    match values.iter().find(|(_, p)| *p < -NEGATIVE * largest) {
        Some((x, p)) => Err(Error::invalid("coefficients", "a density of 0 or above", format!("{p} at {x}"))),
        None => Ok(()),
    }
}

impl std::fmt::Debug for Series {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let cells = self.density.coefficients.len();
        write!(f, "Series of {cells} cells on [{}, {}]", self.start(), self.density.end())
    }
}

impl Law for Series {
    fn name(&self) -> &'static str {
        "series"
    }

    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn with_parameter(&self, name: &str, _value: f64) -> Result<SharedLaw> {
        Err(unknown(self, name))
    }

    fn density(&self, x: f64) -> f64 {
        self.density.value(x).max(0.0)
    }

    fn survival(&self, x: f64) -> f64 {
        if x < self.start() {
            return 1.0;
        }
        self.density.find(x).map_or(0.0, |cell| (self.above[cell + 1][0] + self.upper(cell, x)).min(1.0))
    }

    fn ln_survival(&self, x: f64) -> f64 {
        if x < self.start() {
            return 0.0;
        }
        let below = self.density.find(x).map_or(1.0, |cell| self.below[cell] + self.lower(cell, x));
        if below < 0.5 { (-below).ln_1p() } else { self.survival(x).ln() }
    }

    fn hazard(&self, x: f64) -> f64 {
        let survival = self.survival(x);
        if survival > 0.0 { self.density(x) / survival } else { f64::INFINITY }
    }

    fn quantile(&self, p: f64) -> f64 {
        if p > 0.5 {
            return self.upper_quantile(1.0 - p);
        }
        // Inversion within one cell, whose integral is a polynomial.
        let i = self.below.partition_point(|below| *below < p);
        let Some(cell) = i.checked_sub(1) else { return self.start() };
        self.invert(cell, |x| self.below[cell] + self.lower(cell, x) - p)
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        let i = self.above.partition_point(|above| above[0] > q);
        if q <= 0.0 {
            return self.density.end();
        }
        let Some(cell) = i.checked_sub(1) else { return self.start() };
        self.invert(cell, |x| q - self.above[i][0] - self.upper(cell, x))
    }

    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        let x = x.max(self.start());
        let Some(cell) = self.density.find(x) else { return 0.0 };
        let rest = self.above[cell + 1].get(order as usize).copied().unwrap_or_else(|| {
            let cells = cell + 1..self.density.coefficients.len();
            cells.map(|cell| self.integrate(cell, |x| x.powi(order as i32))).sum()
        });
        rest + self.upper_part(cell, x, order)
    }

    fn std(&self) -> f64 {
        self.std
    }

    /// Jumps and kinks at boundaries that exceed rounding and truncation. At the ends, if there is neither, the power law
    /// that leads there or the lowest derivative up to the fourth that is not 0.
    fn breakpoints(&self) -> Vec<Breakpoint> {
        self.breakpoints.clone()
    }

    fn seams(&self) -> Vec<f64> {
        self.density.boundaries.clone()
    }

    /// The bulk, and the cells that are needed to represent the density to 1e-14, except those that are
    /// narrow because a breakpoint is near.
    fn zones(&self) -> Vec<Zone> {
        self.zones.clone()
    }

    /// The tail cut off, amplified by e^{−sx}, must stay below 1e-16.
    fn known_rate(&self) -> f64 {
        if self.cut > 0.0 { (-self.cut.ln() - 37.0).max(0.0) / self.density.end() } else { f64::INFINITY }
    }

    /// ∫e^{−sx} p over the cells. Entire.
    fn laplace(&self, s: Complex64) -> Complex64 {
        self.density.transform(s).0
    }

    fn laplace_with_derivative(&self, s: Complex64) -> [Complex64; 2] {
        self.density.transform(s).into()
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        out.fill_with(|| self.quantile(stream.uniform()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn each(p: impl Fn(f64) -> f64) -> impl FnMut(&[f64]) -> Result<Vec<f64>> {
        move |points| Ok(points.iter().map(|&x| p(x)).collect())
    }

    /// (position, exponent, amplitude).
    fn breakpoints(p: impl Fn(f64) -> f64, boundaries: &[f64]) -> Vec<(f64, f64, f64)> {
        let law = Series::resolve(each(p), boundaries, 1e-14).unwrap().0;
        law.breakpoints().iter().map(|b| (b.position, b.exponent, b.amplitude)).collect()
    }

    #[test]
    fn a_triangle_of_coefficients() {
        let law = Series::new(&[0.0, 1.0, 2.0], &[vec![1.0, 1.0], vec![1.0, -1.0]], 0.0).unwrap();
        // A few roundings; the mass given is 2.
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a}, not {b}");
        close(law.density(1.0), 1.0);
        close(law.survival(1.5), 0.125);
        close(law.mean(), 1.0);
        close(law.std(), 6.0_f64.sqrt().recip());
        let kinks: Vec<_> = law.breakpoints().iter().map(|b| (b.position, b.exponent, b.amplitude)).collect();
        assert_eq!(kinks, [(0.0, 1.0, 1.0), (1.0, 1.0, -2.0), (2.0, 1.0, 1.0)]);
    }

    #[test]
    fn made_again_from_its_coefficients_it_is_the_same() {
        let law = Series::resolve(each(|x| (-x * x).exp()), &[0.0, 1.0, f64::INFINITY], 1e-14).unwrap().0;
        let coefficients: Vec<_> = law.coefficients().iter().map(|c| c.to_vec()).collect();
        assert_eq!(Series::new(law.boundaries(), &coefficients, law.cut()).unwrap(), law);
    }

    #[test]
    fn breaks_are_those_of_the_function_and_no_others() {
        let bell = |x: f64| (-50.0 * (x - 1.0).powi(2)).exp();
        assert_eq!(breakpoints(bell, &[0.0, 1.0, 1.1, f64::INFINITY]), []);
        // A bell with half of it raised, and a tent on top.
        let broken = |x: f64| bell(x) + if x < 1.0 { 0.0 } else { 0.25 } + (0.1 - (x - 1.2).abs()).max(0.0);
        let found = breakpoints(broken, &[0.0, 1.0, 1.1, 1.2, 1.3, 2.0]);
        let places: Vec<_> = found.iter().map(|b| (b.0, b.1)).collect();
        assert_eq!(places, [(1.0, 0.0), (1.1, 1.0), (1.2, 1.0), (1.3, 1.0), (2.0, 0.0)]);
        let ratio = found[2].2 / found[0].2;
        // Slopes have the rounding of the coefficients times 15² or so.
        assert!((ratio + 8.0).abs() < 1e-9, "{ratio}");
        // Powers at the start: one that is not whole, and a whole one.
        let (_, exponent, amplitude) = breakpoints(|x| (-x).exp() / x.sqrt(), &[0.0, 1.0, f64::INFINITY])[0];
        // p(0⁺) = x^−½/√π, times Γ(½).
        assert!((exponent + 0.5).abs() < 1e-9 && (amplitude - 1.0).abs() < 1e-9, "{exponent}, {amplitude}");
        let (_, exponent, amplitude) = breakpoints(|x| x * x * (-x).exp(), &[0.0, 2.0, f64::INFINITY])[0];
        assert!(exponent == 2.0 && (amplitude - 1.0).abs() < 1e-9, "{exponent}, {amplitude}");
    }

    #[test]
    fn breaks_that_no_boundary_is_on_are_found() {
        let steps = |x: f64| if x < 0.3 { 1.0 } else { 1.5 } + (0.1 - (x - 0.7).abs()).max(0.0);
        let law = Series::resolve(each(steps), &[0.0, 1.0], 1e-14).unwrap().0;
        let expected = [0.0, 0.3, 0.6, 0.7, 0.8, 1.0];
        // Closed in on to sixteen roundings, in which nothing is known.
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 32.0 * f64::EPSILON;
        assert!(law.boundaries().iter().zip(&expected).all(near), "{:?}", law.boundaries());
        let orders: Vec<_> = law.breakpoints().iter().map(|b| b.exponent).collect();
        assert_eq!(orders, [0.0, 0.0, 1.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn a_power_that_ends_in_a_place_is_reported() {
        let law = Series::resolve(each(|x| x * (2.0 - x).sqrt()), &[0.0, 1.0, 2.0], 1e-14).unwrap().0;
        let &[_, end] = &law.breakpoints()[..] else { panic!("{:?}", law.breakpoints()) };
        // Its distance to the end is rounded to 1e-2 in the last cells.
        assert!(end.position == 2.0 && (end.exponent - 0.5).abs() < 0.01, "{end:?}");
    }

    #[test]
    fn a_function_that_is_not_resolved_says_so() {
        let noise = |x: f64| 1.0 + 1e-4 * (1e9 * x).sin();
        let error = Series::resolve(each(noise), &[0.0, 1.0], 1e-12).unwrap_err();
        assert!(matches!(error, Error::Accuracy { .. }), "{error}");
        // Good enough where no more is asked for.
        assert!(Series::resolve(each(noise), &[0.0, 1.0], 1e-3).is_ok());
    }

    #[test]
    fn refuses_what_is_no_density() {
        let given = |boundaries: &[f64], coefficients: &[Vec<f64>]| {
            Series::new(boundaries, coefficients, 0.0).is_err()
        };
        assert!(given(&[0.0], &[]));
        assert!(given(&[0.0, 1.0], &[]));
        assert!(given(&[1.0, 1.0], &[vec![1.0]]));
        assert!(given(&[-1.0, 1.0], &[vec![1.0]]));
        assert!(given(&[0.0, f64::INFINITY], &[vec![1.0]]));
        assert!(given(&[0.0, 1.0], &[vec![]]));
        assert!(given(&[0.0, 1.0], &[vec![1.0; 17]]));
        assert!(given(&[0.0, 1.0], &[vec![f64::NAN]]));
        assert!(given(&[0.0, 1.0], &[vec![0.0]]));
        assert!(given(&[0.0, 1.0], &[vec![1.0, 2.0]]));
        let made = |p: fn(f64) -> f64, last: f64| Series::resolve(each(p), &[0.0, 1.0, last], 1e-14).is_err();
        assert!(made(|x| 1.0 - x, 2.0));
        assert!(made(|_| f64::NAN, 2.0));
        assert!(made(|_| 0.0, f64::INFINITY));
        // A second moment that diverges.
        assert!(made(|x| 1.0 / (1.0 + x * x), f64::INFINITY));
        assert!(Series::resolve(|_| Ok(vec![1.0]), &[0.0, 1.0], 1e-14).is_err());
        assert!(Series::resolve(each(|_| 1.0), &[0.0, 1.0], 0.0).is_err());
    }
}
