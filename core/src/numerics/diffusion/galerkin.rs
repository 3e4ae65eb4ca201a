//! The Galerkin form of a Fokker–Planck operator on spectral elements, and one implicit Euler step of it.
//!
//! Let c be the velocity of a point of an element and ψ a basis function that moves with the elements. Then
//! ∫ψp dh changes at the rate −∫[ψ'(Dp' + (DU' + c)p) + ψwp] dh where no flux passes the ends, or p = 0
//! there: the Galerkin form on a moving mesh (J. Donea et al., *Encyclopedia of Computational Mechanics*, ch.
//! 14, 2004). An implicit Euler step eliminates the inner basis functions element by element (static
//! condensation) and leaves a tridiagonal system for the values at the edges.

use super::elements::{BASIS, Matrix};
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

/// Number of basis functions of an element that vanish at its ends.
const INNER: usize = NODES - 2;

/// An element with the matrix of an implicit Euler step.
#[derive(Debug)]
pub(super) struct GalerkinElement {
    pub(super) half: f64,
    /// ∫[ψ'(Dφ' + (DU' + c)φ) + ψwφ].
    pub(super) operator: Matrix,
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

impl GalerkinElement {
    /// The element between two edges that move at these velocities, at the fraction `done` of the step; `a`
    /// is the length of an implicit Euler step. `still` is the operator, if already known.
    pub(super) fn new(
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
pub(super) fn operator((edges, speeds): ([f64; 2], [f64; 2]), field: &Field<'_>, done: f64) -> Matrix {
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

/// The amplitudes with these moments after an implicit Euler step: the solution of (∫ψφ + a × the operator) amplitudes =
/// moments; an absorbing lower end has the density 0.
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
    tridiagonal(&mut rows, &mut ends, usize::from(absorbing));
    // Back substitution of the inner functions.
    for (i, (cell, out)) in cells.iter().zip(&mut moments).enumerate() {
        (out[0], out[1]) = (ends[i], ends[i + 1]);
        for (j, down) in cell.inner.down.iter().enumerate() {
            out[j + 2] -= down[0] * ends[i] + down[1] * ends[i + 1];
        }
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
