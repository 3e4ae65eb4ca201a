//! The covariance of the force at two positions of a pull, and sample paths of the force with it.

use std::sync::Arc;

use rand_core::Rng;
use rand_distr::{Distribution, StandardNormal};

use super::MasterEquation;
use super::pull::{Pull, at};
use super::renewal::{RenewalSolution, unit_force};
use super::tolerance::Tolerance;
use crate::contacts::{Initial, Start};
use crate::law::SizeBiased;
use crate::life::Life;
use crate::monitor::{Monitor, Part, Watch, fits, report};
use crate::numerics::breakpoints::Breakpoint;
use crate::numerics::legendre::{NODES, Nodal, RULE, dot};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;
use crate::random::{Purpose, Stream};
use crate::{Error, Result};

/// The largest covariance, and the most sample paths, in bytes.
const ALLOWED: u64 = 2 << 30;

/// The covariance of the force of `size` contacts at pairs of positions of a pull, scaled to N_c contacts.
#[derive(Debug, Clone)]
pub struct Covariance {
    positions: Vec<f64>,
    mean: Vec<f64>,
    /// Row by row.
    values: Vec<f64>,
    error: f64,
}

impl Covariance {
    /// The positions X.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// F(X), the mean force at each position.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Cov(F(X₁), F(X₂)), a force squared: a symmetric matrix, row by row.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The covariance of positions number `first` and `second`.
    ///
    /// # Panics
    /// Numbers beyond those of the positions.
    pub fn at(&self, first: usize, second: usize) -> f64 {
        self.values[first * self.positions.len() + second]
    }

    /// The standard deviation of the force at each position.
    pub fn std(&self) -> Vec<f64> {
        (0..self.positions.len()).map(|i| self.at(i, i).max(0.0).sqrt()).collect()
    }

    /// Estimated error of the covariances, a force squared: the largest difference between the diagonal and the
    /// variance from ∫x²Q, and the errors of the solutions that the covariance is made of.
    pub fn error_estimate(&self) -> f64 {
        self.error
    }

    /// `count` sample paths of the force at the positions, one after another: a Gaussian process with this mean
    /// and covariance. The force of many contacts is one by the central limit theorem, so that a path costs the
    /// same for any number of contacts. The same seed gives the same paths.
    ///
    /// # Errors
    /// More than 2 GB; a covariance that is not positive definite to within ten times its estimated error.
    pub fn sample_paths(&self, count: usize, seed: u64) -> Result<Vec<Vec<f64>>> {
        self.sample_paths_with(count, seed, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::sample_paths`]; stopped by the monitor.
    pub fn sample_paths_with(
        &self,
        count: usize,
        seed: u64,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Vec<f64>>> {
        let needed = (count as u64).saturating_mul(8 * (self.positions.len() as u64 + 4));
        fits("count", "sample paths", needed, ALLOWED)?;
        let factor = &mut Part::new(monitor, 0.0, 0.5);
        let factor = cholesky(&self.values, self.positions.len(), self.error, factor)?.ok_or_else(|| {
            let found = format!("an estimated error of {:e}", self.error);
            Error::invalid("positions", "positions at which the covariance is positive definite", found)
        })?;
        let path = |index: u64| {
            let mut stream = Stream::new(seed, Purpose::SamplePaths, index);
            let normal: Vec<f64> = (0..self.mean.len()).map(|_| standard_normal(&mut stream)).collect();
            let row = |(i, mean): (usize, &f64)| {
                let entries = &factor[i * self.mean.len()..][..=i];
                mean + entries.iter().zip(&normal).map(|(a, b)| a * b).sum::<f64>()
            };
            self.mean.iter().enumerate().map(row).collect()
        };
        let mut paths = Vec::with_capacity(count);
        for index in 0..count {
            paths.push(path(index as u64));
            if index % 64 == 63 {
                report(monitor, 0.5 + 0.5 * index as f64 / count as f64)?;
            }
        }
        Ok(paths)
    }
}

fn standard_normal(stream: &mut impl Rng) -> f64 {
    StandardNormal.sample(stream)
}

/// The lower triangular factor L of a symmetric matrix A = LLᵀ, row by row. Pivots that are 0 up to rounding,
/// or up to the `error` of the matrix, give a column of zeros: the force at this position follows from those
/// at earlier ones. `None` if a pivot is further below 0.
fn cholesky(matrix: &[f64], size: usize, error: f64, monitor: &mut dyn Monitor) -> Result<Option<Vec<f64>>> {
    let largest = (0..size).map(|i| matrix[i * (size + 1)]).fold(0.0, f64::max);
    let least = (1e-12 * largest).max(10.0 * error);
    let mut factor = vec![0.0; matrix.len()];
    for i in 0..size {
        if i % 64 == 63 {
            report(monitor, (i as f64 / size as f64).powi(3))?;
        }
        for j in 0..=i {
            let [above, left] = [i, j].map(|row| &factor[row * size..][..j]);
            let rest = matrix[i * size + j] - above.iter().zip(left).map(|(a, b)| a * b).sum::<f64>();
            let pivot = factor[j * (size + 1)];
            factor[i * size + j] = match i == j {
                true if rest > least => rest.sqrt(),
                true if rest < -least => return Ok(None),
                false if pivot > 0.0 => rest / pivot,
                _ => 0.0,
            };
        }
    }
    Ok(Some(factor))
}

impl MasterEquation {
    /// The life of contacts that start at stretches drawn from `initial`.
    fn life_of(&self, initial: &Initial, monitor: &mut dyn Monitor) -> Result<Life> {
        let conditional = initial.start == Start::Conditional;
        match self.velocity {
            Some(velocity) => {
                crate::life::moving(&self.contacts, &initial.law, conditional, velocity, false, monitor)
            }
            None => crate::life::athermal(&self.contacts, &initial.law, conditional, monitor),
        }
    }

    /// The life of contacts that start as in `initial`, each counted in proportion to its initial stretch, with
    /// the mean initial stretch. `None` if all start at 0.
    pub(super) fn weighted_by_stretch(
        &self,
        initial: &Initial,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Weighted>> {
        let Some(biased) = SizeBiased::of(&initial.law) else { return Ok(None) };
        let mean = biased.weight();
        let initial = Initial { law: Arc::new(biased), start: initial.start };
        let life = self.life_of(&initial, monitor)?;
        Ok(Some(Weighted { mean, life: life.into() }))
    }

    /// Whether the contacts at X = 0 are like those that re-form.
    pub(super) fn starts_reformed(&self) -> bool {
        let conditional =
            self.initial.start == Start::Conditional || self.initial.law.upper_quantile(0.0) == 0.0;
        conditional && super::same(&self.initial.law, &self.contacts.reforming)
    }

    /// How contacts re-form.
    pub(super) fn reforming(&self) -> Initial {
        Initial { law: self.contacts.reforming.clone(), start: Start::Conditional }
    }
}

/// Contacts that count in proportion to their initial stretch.
pub(super) struct Weighted {
    /// The mean initial stretch: sums over contacts are it times those of `life`.
    pub(super) mean: f64,
    pub(super) life: Arc<Life>,
}

/// The force after a break, as kernels of convolutions with the breaking rate.
pub(super) struct AfterBreak {
    /// F_R(u), the force of contacts that have all just re-formed, after an advance u.
    reformed: Kernel,
    /// F_rR(u), the same with each contact counted in proportion to its initial stretch.
    weighted: Option<Kernel>,
    /// r̄.
    mean_start: f64,
    /// Estimated error of both.
    error: f64,
}

impl AfterBreak {
    /// Up to the advance `end`. `known` is the solution of a pull that starts with re-formed contacts.
    pub(super) fn new(
        equation: &MasterEquation,
        known: Option<&RenewalSolution>,
        (end, tolerance): (f64, Tolerance),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let reformed = &equation.reformed;
        let solve = |first: &Arc<Life>, monitor: &mut dyn Monitor| {
            RenewalSolution::solve(first, reformed, end, tolerance, monitor)
        };
        let own = match known {
            Some(known) => known.clone(),
            None => solve(reformed, &mut Part::new(monitor, 0.0, 0.4))?,
        };
        let weighted =
            equation.weighted_by_stretch(&equation.reforming(), &mut Part::new(monitor, 0.4, 0.3))?;
        let solved = match &weighted {
            Some(weighted) => Some(solve(&weighted.life, &mut Part::new(monitor, 0.7, 0.3))?),
            None => None,
        };
        let mean_start = weighted.map_or(0.0, |weighted| weighted.mean);
        let error = solved.as_ref().map_or(0.0, |solved| solved.error).max(own.error);
        let scaled = |solved: RenewalSolution| {
            let kernel = force_kernel(&solved);
            Kernel::new(kernel.curve().clone().scaled(mean_start), kernel.breakpoints().to_vec())
        };
        Ok(Self { reformed: force_kernel(&own), weighted: solved.map(scaled), mean_start, error })
    }

    /// F_R(u).
    pub(super) fn force(&self, u: f64) -> f64 {
        at(self.reformed.curve(), u)
    }

    /// F_rR(u).
    pub(super) fn weighted_force(&self, u: f64) -> f64 {
        self.weighted.as_ref().map_or(0.0, |weighted| at(weighted.curve(), u))
    }

    /// F_R.
    pub(super) fn curve(&self) -> &Piecewise {
        self.reformed.curve()
    }

    /// F_rR.
    pub(super) fn weighted_curve(&self) -> Option<&Piecewise> {
        self.weighted.as_ref().map(Kernel::curve)
    }

    pub(super) fn error(&self) -> f64 {
        self.error
    }
}

/// F of a solution, with the points at which it is not smooth. F' = 1 − E_Γ + r̄Γ: where the breaking rate has a
/// breakpoint, the force has one of an exponent that is higher by 1.
fn force_kernel(renewal: &RenewalSolution) -> Kernel {
    let smoother = |b: &Breakpoint| Breakpoint { exponent: b.exponent + 1.0, ..*b };
    let breakpoints = renewal.solution.breakpoints.iter().map(smoother).collect();
    Kernel::new(renewal.force.clone(), breakpoints)
}

impl Pull {
    /// The covariance of the force of `size` contacts at these positions, scaled to N_c.
    ///
    /// Contacts are independent under a rigid drive. The force of one at X₁ is its initial stretch plus X₁ minus
    /// what it lost at its breaks, and after a break it starts anew, so that per contact and unit stiffness, for
    /// X₁ ≤ X₂,
    ///
    /// C = M₀(X₂) + X₁F(X₂) − ∫₀^{X₁} \[E_Γ(Y) F_R(X₂ − Y) − Γ(Y) F_rR(X₂ − Y)\] dY − F(X₁)F(X₂).
    ///
    /// M₀(X) = ∫Q_ini(y) y F_y(X) dy, F_y the force of contacts that start at y; F_R is that of contacts that
    /// have all just re-formed, F_rR(u) = ∫R(r) r F_r(u) dr; E_Γ = 1 + r̄Γ − F' is the rate of breaks times
    /// stretch. Positions may come in any order; at a position where many contacts break together, they have
    /// broken.
    ///
    /// # Errors
    /// Contacts with a delay or with k = κ x_s; a size that is not above 0; positions outside of the pull; more
    /// than 2 GB; a required tolerance that is not reached.
    pub fn covariance(&self, positions: &[f64], size: f64) -> Result<Covariance> {
        self.covariance_with(positions, size, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::covariance`]; stopped by the monitor.
    pub fn covariance_with(
        &self,
        positions: &[f64],
        size: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Covariance> {
        let count = positions.len();
        if !(size > 0.0 && size.is_finite()) {
            return Err(Error::invalid("size", "a finite number above 0", size));
        }
        let outside = |x: &&f64| !(0.0..=self.distance() * (1.0 + 1e-12)).contains(*x);
        if let Some(x) = positions.iter().find(outside) {
            return Err(Error::invalid("positions", format!("positions from 0 to {}", self.distance()), x));
        }
        fits("positions", "covariances of all pairs of positions", (count * count * 24) as u64, ALLOWED)?;
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&i, &j| positions[i].total_cmp(&positions[j]));
        let sorted: Vec<f64> = order.iter().map(|&i| positions[i].min(self.distance())).collect();
        let (triangle, error) = self.lower_triangle(&sorted, monitor)?;
        let scale = self.stiffness.powi(2) / size;
        let mut values = vec![0.0; count * count];
        for (row, entries) in triangle.iter().enumerate() {
            for (column, value) in entries.iter().enumerate() {
                let (i, j) = (order[row], order[column]);
                values[i * count + j] = scale * value;
                values[j * count + i] = scale * value;
            }
        }
        let mean = positions.iter().map(|&x| self.force(x)).collect();
        Ok(Covariance { positions: positions.to_vec(), mean, values, error: scale * error })
    }

    /// C of each rising position with those up to it, per contact and unit stiffness, and its estimated error.
    fn lower_triangle(&self, positions: &[f64], monitor: &mut dyn Monitor) -> Result<(Vec<Vec<f64>>, f64)> {
        let equation = &self.equation;
        equation.contacts.renew_completely()?;
        let last = positions.last().copied().unwrap_or(0.0);
        let end = last.max(self.renewal.reformed.mean());
        let steps = (end, self.tolerance);
        let known = equation.starts_reformed().then_some(&self.renewal);
        let after = AfterBreak::new(equation, known, steps, &mut Part::new(monitor, 0.0, 0.3))?;
        let initial = equation.weighted_by_stretch(&equation.initial, &mut Part::new(monitor, 0.3, 0.1))?;
        let initial = match initial {
            None => None,
            Some(Weighted { mean, life }) => {
                let part = &mut Part::new(monitor, 0.4, 0.1);
                let solved = RenewalSolution::solve(&life, &equation.reformed, end, self.tolerance, part)?;
                Some((mean, solved))
            }
        };
        let square = self.square(&mut Part::new(monitor, 0.5, 0.1))?;
        let breaks =
            Breaks::new(&self.renewal, &after, initial.as_ref().map_or(0.0, |(mean, _)| *mean), positions);
        let starting = |x: f64| initial.as_ref().map_or(0.0, |(mean, solved)| mean * at(&solved.force, x));
        let mean: Vec<f64> = positions.iter().map(|&x| at(&self.renewal.force, x)).collect();
        let row = |cuts: &mut Vec<f64>, j: usize| {
            let (x, mut row) = (positions[j], breaks.lost(j, cuts));
            for (i, entry) in row.iter_mut().enumerate() {
                *entry = starting(x) + positions[i] * mean[j] - *entry - mean[i] * mean[j];
            }
            // Where all contacts share one stretch, rounding may be negative.
            row[j] = row[j].max(0.0);
            row
        };
        let triangle = Watch::new(&mut Part::new(monitor, 0.6, 0.4)).share(positions.len(), Vec::new, row)?;
        let apart = |(j, row): (usize, &Vec<f64>)| {
            let variance = at(square, positions[j]) - mean[j] * mean[j];
            row.last().map_or(0.0, |diagonal| (diagonal - variance).abs())
        };
        let apart = triangle.iter().enumerate().map(apart).fold(0.0, f64::max);
        let solved =
            initial.map_or(0.0, |(_, solved)| solved.error).max(after.error()).max(self.renewal.error);
        let unit = unit_force(&self.renewal.reformed);
        Ok((triangle, apart + solved * unit * unit))
    }
}

/// What contacts lose at breaks on [0, X₁], times their force at X₂: the integral of the covariance.
struct Breaks<'a> {
    after: &'a AfterBreak,
    positions: &'a [f64],
    /// The cells of the breaking rate.
    cells: Vec<BreakCell>,
    /// Breaks of many contacts at once.
    simultaneous: Vec<SimultaneousBreak>,
    renewal: &'a RenewalSolution,
}

/// A cell of the breaking rate.
struct BreakCell {
    low: f64,
    high: f64,
    /// The Gauss points.
    places: Nodal,
    /// E_Γ and Γ there.
    lost: Nodal,
    rate: Nodal,
    /// The positions in the cell: the first of them, and for each the weights that take values at the Gauss
    /// points to the integral from `low` to the position.
    first: usize,
    weights: Vec<Nodal>,
}

/// Contacts that break at one position.
struct SimultaneousBreak {
    position: f64,
    /// The sum of their stretches.
    lost: f64,
    fraction: f64,
}

impl<'a> Breaks<'a> {
    /// For rising `positions` and contacts of the mean initial stretch `initial`.
    fn new(renewal: &'a RenewalSolution, after: &'a AfterBreak, initial: f64, positions: &'a [f64]) -> Self {
        let force = &renewal.force;
        let last = positions.last().copied().unwrap_or(0.0);
        let within = |&cell: &usize| force.boundaries[cell] < last;
        let cells = (0..force.coefficients.len()).take_while(within);
        let cells = cells.map(|cell| BreakCell::new(renewal, after.mean_start, cell, positions)).collect();
        let jump = |x: f64| {
            let after = force.nearest(x);
            let before = if after == 0 { initial } else { force.value_in(after - 1, x) };
            force.value_in(after, x) - before
        };
        let simultaneous = renewal.solution.atoms.iter().map(|atom| SimultaneousBreak {
            position: atom.position,
            lost: after.mean_start * atom.weight - jump(atom.position),
            fraction: atom.weight,
        });
        Self { after, positions, cells, simultaneous: simultaneous.collect(), renewal }
    }

    /// ∫₀^{X₁} \[E_Γ(Y) F_R(X₂ − Y) − Γ(Y) F_rR(X₂ − Y)\] dY for X₂ the position number `row` and each X₁ up to
    /// it.
    fn lost(&self, row: usize, cuts: &mut Vec<f64>) -> Vec<f64> {
        let x = self.positions[row];
        let (mut before, mut out) = (0.0, vec![0.0; row + 1]);
        for cell in self.cells.iter().take_while(|cell| cell.low < x) {
            let last = (cell.first + cell.weights.len()).min(row + 1);
            let here = cell.first..last.max(cell.first);
            cuts.clear();
            let (near, far) = ((x - cell.high).max(0.0), x - cell.low);
            for kernel in [Some(&self.after.reformed), self.after.weighted.as_ref()].into_iter().flatten() {
                kernel.splits(near, far, cell.high - cell.low, cuts);
            }
            if cuts.is_empty() && cell.high <= x {
                let values = self.integrand(x, cell);
                for (entry, weights) in out[here].iter_mut().zip(&cell.weights) {
                    *entry = before + dot(weights, &values);
                }
                before += 0.5 * (cell.high - cell.low) * dot(&RULE.weights, &values);
            } else {
                cuts.iter_mut().for_each(|u| *u = x - *u);
                before = self.lost_in_sections(x, cell, cuts, before, &mut out, here);
            }
        }
        self.add_simultaneous(x, &mut out);
        out
    }

    /// The integrand at the Gauss points of a cell.
    fn integrand(&self, x: f64, cell: &BreakCell) -> Nodal {
        let distances = cell.places.map(|y| x - y);
        let force = self.after.reformed.curve().values(&distances);
        let mut values: Nodal = std::array::from_fn(|i| cell.lost[i] * force[i]);
        if let Some(weighted) = &self.after.weighted {
            let weighted = weighted.curve().values(&distances);
            (0..NODES).for_each(|i| values[i] -= cell.rate[i] * weighted[i]);
        }
        values
    }

    /// The integral over a cell that is cut where the force after a break is not smooth, or that ends beyond x.
    fn lost_in_sections(
        &self,
        x: f64,
        cell: &BreakCell,
        cuts: &mut Vec<f64>,
        mut before: f64,
        out: &mut [f64],
        here: std::ops::Range<usize>,
    ) -> f64 {
        let high = cell.high.min(x);
        cuts.extend([cell.low, high]);
        cuts.retain(|&y| y >= cell.low && y <= high);
        cuts.sort_by(f64::total_cmp);
        let mut next = here.start;
        for section in cuts.windows(2).filter(|section| section[1] > section[0]) {
            let (low, high) = (section[0], section[1]);
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            let values = RULE.nodes.map(|t| self.integrand_at(x, cell, middle + half * t));
            while next < here.end && self.positions[next] <= high {
                let weights = weights_to((self.positions[next] - middle) / half);
                out[next] = before + half * dot(&weights, &values);
                next += 1;
            }
            before += half * dot(&RULE.weights, &values);
        }
        out[next..here.end].fill(before);
        before
    }

    fn integrand_at(&self, x: f64, cell: &BreakCell, y: f64) -> f64 {
        let number = self.renewal.force.nearest(0.5 * (cell.low + cell.high));
        let rate = self.renewal.solution.density.value_in(number, y);
        let lost = 1.0 + self.after.mean_start * rate - self.renewal.slope.value_in(number, y);
        lost * self.after.force(x - y) - rate * self.after.weighted_force(x - y)
    }

    fn add_simultaneous(&self, x: f64, out: &mut [f64]) {
        let reached = |position: f64, x: f64| position <= x * (1.0 + 1e-12);
        for broken in self.simultaneous.iter().take_while(|broken| reached(broken.position, x)) {
            let since = (x - broken.position).max(0.0);
            let term =
                broken.lost * self.after.force(since) - broken.fraction * self.after.weighted_force(since);
            let first = self.positions.partition_point(|&p| !reached(broken.position, p));
            out.iter_mut().skip(first).for_each(|entry| *entry += term);
        }
    }
}

impl BreakCell {
    fn new(renewal: &RenewalSolution, mean_start: f64, cell: usize, positions: &[f64]) -> Self {
        let (middle, half) = renewal.force.cell(cell);
        let (low, high) = (renewal.force.boundaries[cell], renewal.force.boundaries[cell + 1]);
        let places = RULE.nodes.map(|t| middle + half * t);
        let rate = renewal.solution.density.values_in(cell, &places);
        let slope = renewal.slope.values_in(cell, &places);
        let lost = std::array::from_fn(|i| 1.0 + mean_start * rate[i] - slope[i]);
        let first = positions.partition_point(|&p| p <= low);
        let last = positions.partition_point(|&p| p <= high);
        let weights = |&p: &f64| weights_to((p - middle) / half).map(|weight| half * weight);
        let weights = positions[first..last].iter().map(weights).collect();
        Self { low, high, places, lost, rate, first, weights }
    }
}

/// The weights of values at the Gauss points in ∫₋₁^t of the polynomial through them. ∫₋₁^t P_n = (P_{n+1}(t) −
/// P_{n−1}(t))/(2n + 1), and 1 + t for n = 0.
fn weights_to(t: f64) -> Nodal {
    let mut legendre = [0.0; NODES + 1];
    (legendre[0], legendre[1]) = (1.0, t);
    for n in 1..NODES {
        let k = n as f64;
        legendre[n + 1] = ((2.0 * k + 1.0) * t * legendre[n] - k * legendre[n - 1]) / (k + 1.0);
    }
    let moment = |n: usize| (legendre[n + 1] - legendre[n - 1]) / (2 * n + 1) as f64;
    RULE.functional(&std::array::from_fn(|n| if n == 0 { 1.0 + t } else { moment(n) }))
}
