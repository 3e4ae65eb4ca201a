//! One time step of a density on spectral elements, of which the lowest move with the floor (a space–time
//! slab).
//!
//! Let c be the velocity of a point of an element and ψ a basis function that moves with the elements. Then
//! ∫ψp dh changes at the rate −∫[ψ'(Dp' + (DU' + c)p) + ψwp] dh where no flux passes the ends, or p = 0
//! there: the Galerkin form on a moving mesh (J. Donea et al., *Encyclopedia of Computational Mechanics*, ch.
//! 14, 2004). It is collocated at the Radau points and solved by spectral deferred corrections. Each implicit
//! Euler step eliminates the inner basis functions element by element (static condensation) and leaves a
//! tridiagonal system for the values at the edges.

use super::elements::{BASIS, Basis, Elements, Matrix};
use super::radau::{RADAU, Radau, STAGES};
use crate::numerics::legendre::{NODES, Nodal, RULE};

/// A loss rate as a function of the fraction of the step done and the position.
pub type Loss<'a> = &'a dyn Fn(f64, f64) -> f64;

/// Drift, diffusion and loss.
#[derive(Clone, Copy)]
pub struct Field<'a> {
    /// U'.
    pub slope: &'a dyn Fn(f64) -> f64,
    /// D, above 0.
    pub diffusion: f64,
    /// Loss rate in addition to absorption at the floor.
    pub loss: Option<Loss<'a>>,
}

impl std::fmt::Debug for Field<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Field").field("diffusion", &self.diffusion).finish_non_exhaustive()
    }
}

/// The motion of the elements in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeMotion {
    /// Distance by which the floor rises.
    pub(super) by: f64,
    /// Duration of the step.
    pub(super) duration: f64,
    /// Whether the floor absorbs; else it reflects.
    pub(super) absorbing: bool,
    /// The last edge that moves with the floor; those above are at rest.
    pub(super) last: usize,
}

/// The solution of a step.
#[derive(Debug)]
pub(super) struct Slab {
    /// The density at the Radau points.
    pub(super) stages: Vec<Elements>,
    /// Change in the last sweep, in the mean: the error of the iteration.
    pub(super) iteration_error: f64,
}

/// Largest number of sweeps.
const MOST_SWEEPS: usize = 60;

/// Number of basis functions of an element that vanish at its ends.
const INNER: usize = NODES - 2;

/// An element at one of the Radau points.
#[derive(Debug)]
struct SlabElement {
    half: f64,
    /// ∫[ψ'(Dφ' + (DU' + c)φ) + ψwφ].
    operator: Matrix,
    inner: Elimination,
}

/// Static condensation of ∫ψφ + a × the operator: its inner part factorised, and the Schur complement for the
/// two ends.
#[derive(Debug)]
struct Elimination {
    factors: [[f64; INNER]; INNER],
    pivots: [usize; INNER],
    /// Inner part⁻¹ × (columns of the ends).
    down: [[f64; 2]; INNER],
    /// Rows of the ends × inner functions.
    up: [[f64; INNER]; 2],
    /// The Schur complement.
    ends: [[f64; 2]; 2],
}

impl Elimination {
    fn new(system: &Matrix) -> Self {
        let factors = std::array::from_fn(|i| std::array::from_fn(|j| system[i + 2][j + 2]));
        let up = std::array::from_fn(|i| std::array::from_fn(|j| system[i][j + 2]));
        let mut out = Self { factors, pivots: [0; INNER], down: [[0.0; 2]; INNER], up, ends: [[0.0; 2]; 2] };
        out.factorise();
        for end in 0..2 {
            // The Schur complement: the system of the two end values once the inner functions are
            // eliminated.
            let mut column: [f64; INNER] = std::array::from_fn(|i| system[i + 2][end]);
            out.solve(&mut column);
            (0..INNER).for_each(|i| out.down[i][end] = column[i]);
            for row in 0..2 {
                let inner: f64 = out.up[row].iter().zip(&column).map(|(a, b)| a * b).sum();
                out.ends[row][end] = system[row][end] - inner;
            }
        }
        out
    }

    /// LU factorisation with partial pivoting.
    fn factorise(&mut self) {
        for k in 0..INNER {
            let size = |&i: &usize| self.factors[i][k].abs();
            let largest = (k..INNER).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap_or(k);
            self.factors.swap(k, largest);
            self.pivots[k] = largest;
            let row = self.factors[k];
            for below in &mut self.factors[k + 1..] {
                below[k] /= row[k];
                let factor = below[k];
                below[k + 1..]
                    .iter_mut()
                    .zip(&row[k + 1..])
                    .for_each(|(entry, above)| *entry -= factor * above);
            }
        }
    }

    fn solve(&self, right: &mut [f64; INNER]) {
        for k in 0..INNER {
            right.swap(k, self.pivots[k]);
        }
        for i in 1..INNER {
            let below: f64 = self.factors[i][..i].iter().zip(&right[..i]).map(|(a, b)| a * b).sum();
            right[i] -= below;
        }
        for i in (0..INNER).rev() {
            let above: f64 = self.factors[i][i + 1..].iter().zip(&right[i + 1..]).map(|(a, b)| a * b).sum();
            right[i] = (right[i] - above) / self.factors[i][i];
        }
    }
}

impl SlabElement {
    /// The element between two edges that move at these velocities, at the fraction `done` of the step; `a`
    /// is the length of an implicit Euler step. `still` is the operator, if already known.
    fn new(
        (edges, speeds): ([f64; 2], [f64; 2]),
        field: &Field<'_>,
        (done, a): (f64, f64),
        still: Option<&Matrix>,
    ) -> Self {
        let half = 0.5 * (edges[1] - edges[0]);
        let operator = still.copied().unwrap_or_else(|| operator((edges, speeds), field, done));
        let entry = |k: usize, l: usize| half * BASIS.mass[k][l] + a * operator[k][l];
        let system = std::array::from_fn(|k| std::array::from_fn(|l| entry(k, l)));
        Self { half, operator, inner: Elimination::new(&system) }
    }
}

/// The operator of an element.
fn operator((edges, speeds): ([f64; 2], [f64; 2]), field: &Field<'_>, done: f64) -> Matrix {
    let (middle, half) = (0.5 * (edges[0] + edges[1]), 0.5 * (edges[1] - edges[0]));
    let at = |t: f64, of: [f64; 2]| 0.5 * ((1.0 - t) * of[0] + (1.0 + t) * of[1]);
    let (mut carried, mut lost) = ([0.0; NODES], [0.0; NODES]);
    for (q, (t, weight)) in RULE.nodes.iter().zip(&RULE.weights).enumerate() {
        let place = middle + half * t;
        carried[q] = weight * (field.diffusion * (field.slope)(place) + at(*t, speeds));
        lost[q] = field.loss.map_or(0.0, |loss| weight * half * loss(done, place));
    }
    std::array::from_fn(|k| {
        let (slopes, values) = (&BASIS.slopes[k], &BASIS.values[k]);
        let row: Nodal = std::array::from_fn(|q| slopes[q] * carried[q] + values[q] * lost[q]);
        let entry = |l: usize| -> f64 {
            let sum: f64 = row.iter().zip(&BASIS.values[l]).map(|(a, b)| a * b).sum();
            field.diffusion / half * BASIS.stiffness[k][l] + sum
        };
        std::array::from_fn(entry)
    })
}

/// Advances a density by a step, with sweeps until they change it by no more than `tolerance`, or until it `stops`.
pub(super) fn slab(
    density: &Elements,
    motion: &EdgeMotion,
    field: &Field<'_>,
    tolerance: f64,
    stops: &dyn Fn() -> bool,
) -> Slab {
    let mesh = SlabMesh::new(density, motion, field);
    let start: Vec<Nodal> =
        (0..density.count()).map(|i| Basis::moments(&density.series[i], density.element(i).1)).collect();
    let nothing = vec![[0.0; NODES]; density.count()];
    let (mut rates, mut amplitudes) = (vec![nothing.clone(); STAGES], vec![nothing; STAGES]);
    let rounding = 2.0 * f64::EPSILON * density.mass().abs();
    let mut iteration_error = f64::INFINITY;
    for sweep in 0..MOST_SWEEPS {
        // Spectral deferred correction: the part of the Radau quadrature that the implicit sweep does not
        // contain is taken from the rates of the previous sweep. At convergence both parts add up to the
        // collocation equations.
        let fixed: Vec<Vec<Nodal>> = (0..STAGES)
            .map(|m| {
                let implicit = |l: usize| if l <= m { RADAU.sweep[m][l] } else { 0.0 };
                let weights = std::array::from_fn(|l| motion.duration * (RADAU.weights[m][l] - implicit(l)));
                if sweep == 0 { start.clone() } else { added(&start, &rates, weights) }
            })
            .collect();
        let before = std::mem::take(&mut iteration_error);
        for (m, fixed) in fixed.iter().enumerate() {
            let weights =
                std::array::from_fn(|l| if l < m { motion.duration * RADAU.sweep[m][l] } else { 0.0 });
            let next = mesh.solve(m, added(fixed, &rates, weights));
            iteration_error = iteration_error.max(mesh.distance(m, &next, &amplitudes[m]));
            rates[m] = mesh.rates(m, &next);
            amplitudes[m] = next;
        }
        // Changes at the level of rounding do not decrease further.
        if iteration_error < tolerance.max(rounding)
            || (sweep > 12 && iteration_error > 0.5 * before && iteration_error < 10.0 * tolerance)
            || stops()
        {
            break;
        }
    }
    let stage = |m: usize| Elements {
        edges: mesh.edges(RADAU.nodes[m]),
        series: amplitudes[m].iter().map(Basis::series).collect(),
    };
    Slab { stages: (0..STAGES).map(stage).collect(), iteration_error }
}

/// `moments` plus the rates of all stages times weights.
fn added(moments: &[Nodal], rates: &[Vec<Nodal>], weights: [f64; STAGES]) -> Vec<Nodal> {
    let mut out = moments.to_vec();
    for (rates, weight) in rates.iter().zip(weights).filter(|(_, weight)| *weight != 0.0) {
        for (out, rate) in out.iter_mut().zip(rates) {
            out.iter_mut().zip(rate).for_each(|(out, rate)| *out += weight * rate);
        }
    }
    out
}

/// The elements during a step.
struct SlabMesh<'a> {
    start: &'a [f64],
    motion: &'a EdgeMotion,
    /// At each of the Radau points.
    cells: Vec<Vec<SlabElement>>,
}

impl<'a> SlabMesh<'a> {
    fn new(density: &'a Elements, motion: &'a EdgeMotion, field: &Field<'_>) -> Self {
        let mut mesh = Self { start: &density.edges, motion, cells: Vec::new() };
        for m in 0..STAGES {
            let edges = mesh.edges(RADAU.nodes[m]);
            let times = (RADAU.nodes[m], motion.duration * RADAU.sweep[m][m]);
            let cell = |i: usize| {
                let speeds = [i, i + 1].map(|i| mesh.relative_velocity(i) * motion.by / motion.duration);
                // An element at rest without loss has the same operator at all stages; only the
                // implicit step length differs.
                let rests = speeds == [0.0; 2] && field.loss.is_none();
                let still = mesh.cells.first().filter(|_| rests).map(|cells| &cells[i].operator);
                SlabElement::new(([edges[i], edges[i + 1]], speeds), field, times, still)
            };
            let cells = (0..density.count()).map(cell).collect();
            mesh.cells.push(cells);
        }
        mesh
    }

    /// The velocity of an edge over that of the floor.
    fn relative_velocity(&self, edge: usize) -> f64 {
        if edge <= self.motion.last { 1.0 } else { 0.0 }
    }

    fn edges(&self, done: f64) -> Vec<f64> {
        let at = |(i, edge): (usize, &f64)| edge + self.relative_velocity(i) * done * self.motion.by;
        self.start.iter().enumerate().map(at).collect()
    }

    /// Distance of two densities in the mean, from the two lowest moments of each element.
    fn distance(&self, m: usize, one: &[Nodal], other: &[Nodal]) -> f64 {
        let of = |((cell, a), b): ((&SlabElement, &Nodal), &Nodal)| {
            let [a, b] = [Basis::series(a), Basis::series(b)];
            cell.half * ((a[0] - b[0]).abs() + (a[1] - b[1]).abs())
        };
        self.cells[m].iter().zip(one).zip(other).map(of).sum()
    }

    /// Rates of change of the moments.
    fn rates(&self, m: usize, amplitudes: &[Nodal]) -> Vec<Nodal> {
        let rate = |(cell, density): (&SlabElement, &Nodal)| {
            cell.operator.map(|row| -row.iter().zip(density).map(|(a, b)| a * b).sum::<f64>())
        };
        self.cells[m].iter().zip(amplitudes).map(rate).collect()
    }

    /// The amplitudes with these moments after an implicit Euler step.
    fn solve(&self, m: usize, mut moments: Vec<Nodal>) -> Vec<Nodal> {
        let count = moments.len();
        let mut rows = vec![[0.0; 3]; count + 1];
        let mut ends = vec![0.0; count + 1];
        for (i, (cell, moments)) in self.cells[m].iter().zip(&mut moments).enumerate() {
            let inner = &cell.inner;
            let mut values: [f64; INNER] = std::array::from_fn(|j| moments[j + 2]);
            inner.solve(&mut values);
            moments[2..].copy_from_slice(&values);
            for end in 0..2 {
                let taken: f64 = inner.up[end].iter().zip(&values).map(|(a, b)| a * b).sum();
                ends[i + end] += moments[end] - taken;
                rows[i + end][1] += inner.ends[end][end];
            }
            rows[i][2] = inner.ends[0][1];
            rows[i + 1][0] = inner.ends[1][0];
        }
        // Only the values at the edges couple neighbouring elements.
        tridiagonal(&mut rows, &mut ends, usize::from(self.motion.absorbing));
        // Back substitution of the inner functions.
        for (i, (cell, out)) in self.cells[m].iter().zip(&mut moments).enumerate() {
            (out[0], out[1]) = (ends[i], ends[i + 1]);
            for (j, down) in cell.inner.down.iter().enumerate() {
                out[j + 2] -= down[0] * ends[i] + down[1] * ends[i + 1];
            }
        }
        moments
    }
}

/// Thomas algorithm for rows (below, diagonal, above) from the row `first` on; earlier unknowns are 0.
fn tridiagonal(rows: &mut [[f64; 3]], right: &mut [f64], first: usize) {
    let last = right.len() - 1;
    for i in first + 1..=last {
        let factor = rows[i][0] / rows[i - 1][1];
        rows[i][1] -= factor * rows[i - 1][2];
        right[i] -= factor * right[i - 1];
    }
    right[last] /= rows[last][1];
    for i in (first..last).rev() {
        right[i] = (right[i] - rows[i][2] * right[i + 1]) / rows[i][1];
    }
    right[..first].fill(0.0);
}

/// The truncation error of the polynomials in time of the mass and first moment of each element, summed.
pub(super) fn truncation_in_time(start: &Elements, stages: &[Elements], radau: &Radau) -> f64 {
    let of = |i: usize, n: usize| {
        let mut values = [start.series[i][n] * start.element(i).1; STAGES + 1];
        for (value, stage) in values[1..].iter_mut().zip(stages) {
            *value = stage.series[i][n] * stage.element(i).1;
        }
        let c = radau.coefficients(&values);
        let pair = |k: usize| c[k].abs().max(c[k - 1].abs());
        let (last, before) = (pair(STAGES), pair(STAGES - 2));
        2.0 * if last < before { last * last / before } else { last }
    };
    (0..start.count()).map(|i| of(i, 0) + of(i, 1)).sum()
}
