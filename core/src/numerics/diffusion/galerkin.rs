//! The Galerkin form of a Fokker–Planck operator on spectral elements, and one implicit Euler step of it.
//!
//! Let c be the velocity of a point of an element and ψ a basis function that moves with the elements. Then
//! ∫ψp dh changes at the rate −∫[ψ'(Dp' + (DU' + c)p) + ψwp] dh where no flux passes the ends, or p = 0
//! there: the Galerkin form on a moving mesh (J. Donea et al., *Encyclopedia of Computational Mechanics*, ch.
//! 14, 2004). An implicit Euler step eliminates the inner basis functions element by element (static
//! condensation) and leaves a tridiagonal system for the values at the edges.

use super::elements::{BASIS, Matrix};
use crate::numerics::legendre::{NODES, Nodal, RULE};
use crate::numerics::wide::vectorised;

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

/// Number of basis functions of an element that do not vanish at one of its ends: the first ones.
const ENDS: usize = 2;

/// An element with the matrix of an implicit Euler step.
#[derive(Debug)]
pub(super) struct GalerkinElement {
    pub(super) half: f64,
    operator: Operator,
    inner: Elimination,
}

/// ∫[ψ'(Dφ' + (DU' + c)φ) + ψwφ], by columns φ: products with vectors are then sums of columns, which vectorise.
#[derive(Debug, Clone)]
pub(super) struct Operator(Matrix);

/// Static condensation of ∫ψφ + a × the operator: its inner part inverted, and the Schur complement for the
/// two ends.
#[derive(Debug)]
struct Elimination {
    /// By columns: of the ends, inner part⁻¹ × that column; of an inner function, the column of the inverse, and above it −(rows of
    /// the ends) × that.
    columns: Matrix,
    /// The Schur complement.
    ends: [[f64; ENDS]; ENDS],
}

impl Elimination {
    /// Of a system that is given by rows.
    #[inline(always)]
    fn new(system: &Matrix) -> Self {
        let rows = solved_for_inner(system);
        let mut columns: Matrix = std::array::from_fn(|j| std::array::from_fn(|i| rows[i][j]));
        let mut ends = [[0.0; ENDS]; ENDS];
        for end in 0..ENDS {
            // The row of an end times what the rows of inner functions have become.
            let mut inner = [0.0; NODES];
            for i in ENDS..NODES {
                add_multiple(&mut inner, system[end][i], &rows[i]);
            }
            for j in 0..ENDS {
                ends[end][j] = system[end][j] - inner[j];
            }
            for j in ENDS..NODES {
                columns[j][end] = -inner[j];
            }
        }
        Self { columns, ends }
    }

    /// The inner amplitudes, and the moments of the ends, of these moments if the values at the ends are 0.
    #[inline(always)]
    fn condensed(&self, moments: &Nodal) -> Nodal {
        let mut out = [0.0; NODES];
        (out[0], out[1]) = (moments[0], moments[1]);
        for (column, moment) in self.columns[ENDS..].iter().zip(&moments[ENDS..]) {
            add_multiple(&mut out, *moment, column);
        }
        out
    }

    /// The amplitudes with these values at the ends.
    #[inline(always)]
    fn completed(&self, mut condensed: Nodal, ends: [f64; ENDS]) -> Nodal {
        for (column, end) in self.columns.iter().zip(ends) {
            add_multiple(&mut condensed, -end, column);
        }
        condensed[..ENDS].copy_from_slice(&ends);
        condensed
    }
}

/// The inner rows of a system multiplied by the inverse of its inner part, which is in the place of that part; the rows of the ends
/// are 0. Gauss–Jordan elimination in place, with partial pivoting.
#[inline(always)]
fn solved_for_inner(system: &Matrix) -> Matrix {
    let mut rows = *system;
    rows[..ENDS].fill([0.0; NODES]);
    let mut pivots = [0; NODES];
    for k in ENDS..NODES {
        let mut largest = k;
        for i in k + 1..NODES {
            if rows[i][k].abs() > rows[largest][k].abs() {
                largest = i;
            }
        }
        rows.swap(k, largest);
        pivots[k] = largest;
        // The column k becomes one of the inverse. It is replaced by a factor, not entry by entry: registers could not be loaded
        // at once from memory that has just been stored in parts.
        let kept: Nodal = std::array::from_fn(|j| if j == k { 0.0 } else { 1.0 });
        let (pivot, old) = (1.0 / rows[k][k], rows[k]);
        let row: Nodal = std::array::from_fn(|j| pivot * (kept[j] * old[j] + (1.0 - kept[j])));
        for other in &mut rows[ENDS..] {
            let factor = other[k];
            for j in 0..NODES {
                other[j] = kept[j] * other[j] - factor * row[j];
            }
        }
        rows[k] = row;
    }
    // Rows were exchanged, which exchanges columns of the inverse.
    for k in (ENDS..NODES).rev() {
        rows.iter_mut().for_each(|row| row.swap(k, pivots[k]));
    }
    rows
}

/// Adds a multiple of a row or a column.
#[inline(always)]
fn add_multiple(sum: &mut Nodal, factor: f64, column: &Nodal) {
    for i in 0..NODES {
        sum[i] += factor * column[i];
    }
}

impl Operator {
    /// That of an element between two edges that move at these velocities, at the fraction `done` of the step.
    pub(super) fn new((edges, speeds): ([f64; 2], [f64; 2]), field: &Field<'_>, done: f64) -> Self {
        let (middle, half) = (0.5 * (edges[0] + edges[1]), 0.5 * (edges[1] - edges[0]));
        let at = |t: f64, of: [f64; 2]| 0.5 * ((1.0 - t) * of[0] + (1.0 + t) * of[1]);
        let mut columns = BASIS.stiffness.map(|row| row.map(|entry| field.diffusion / half * entry));
        for (q, (t, weight)) in RULE.nodes.iter().zip(&RULE.weights).enumerate() {
            let place = middle + half * t;
            let carried = weight * (field.diffusion * (field.slope)(place) + at(*t, speeds));
            let lost = field.loss.map_or(0.0, |loss| weight * half * loss(done, place));
            let (slopes, values) = (&BASIS.slopes[q], &BASIS.values[q]);
            let at_point: Nodal = std::array::from_fn(|k| slopes[k] * carried + values[k] * lost);
            for (column, value) in columns.iter_mut().zip(values) {
                add_multiple(column, *value, &at_point);
            }
        }
        Self(columns)
    }

    /// Adds to the diagonal entry of a basis function.
    pub(super) fn add_to_diagonal(&mut self, k: usize, entry: f64) {
        self.0[k][k] += entry;
    }
}

impl GalerkinElement {
    /// The element of this half width and operator, with an implicit Euler step of the length `a`.
    pub(super) fn new(half: f64, operator: Operator, a: f64) -> Self {
        let entry = |k: usize, l: usize| half * BASIS.mass[k][l] + a * operator.0[l][k];
        let system = std::array::from_fn(|k| std::array::from_fn(|l| entry(k, l)));
        let inner = vectorised(
            #[inline(always)]
            || Elimination::new(&system),
        );
        Self { half, operator, inner }
    }

    /// The operator.
    pub(super) fn operator(&self) -> &Operator {
        &self.operator
    }

    /// Rates of change of the moments of a density with these amplitudes.
    #[inline(always)]
    pub(super) fn rates(&self, amplitudes: &Nodal) -> Nodal {
        let mut out = [0.0; NODES];
        for (column, amplitude) in self.operator.0.iter().zip(amplitudes) {
            add_multiple(&mut out, -amplitude, column);
        }
        out
    }
}

/// The amplitudes with these moments after an implicit Euler step: the solution of (∫ψφ + a × the operator) amplitudes =
/// moments; an absorbing lower end has the density 0.
#[inline(always)]
pub(super) fn implicit_step(
    cells: &[GalerkinElement],
    mut moments: Vec<Nodal>,
    absorbing: bool,
) -> Vec<Nodal> {
    let count = moments.len();
    let mut rows = vec![[0.0; 3]; count + 1];
    let mut ends = vec![0.0; count + 1];
    for (i, (cell, moments)) in cells.iter().zip(&mut moments).enumerate() {
        let inner = &cell.inner;
        *moments = inner.condensed(moments);
        for end in 0..ENDS {
            ends[i + end] += moments[end];
            rows[i + end][1] += inner.ends[end][end];
        }
        rows[i][2] = inner.ends[0][1];
        rows[i + 1][0] = inner.ends[1][0];
    }
    // Only the values at the edges couple neighbouring elements.
    tridiagonal(&mut rows, &mut ends, usize::from(absorbing));
    for (i, (cell, out)) in cells.iter().zip(&mut moments).enumerate() {
        *out = cell.inner.completed(*out, [ends[i], ends[i + 1]]);
    }
    moments
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
