//! A step in time of a density on elements, of which the lowest follow a floor.
//!
//! With c the velocity at which a place of an element moves, ∫ψp dh of each function ψ that moves with the elements changes at
//! the rate −∫[ψ'(Dp' + (DU' + c)p) + ψwp] dh, where nothing passes the ends or p = 0 there: the Galerkin form, on a moving mesh
//! (J. Donea et al., *Encyclopedia of Computational Mechanics*, ch. 14, 2004). It is collocated at Radau's points; each solution for
//! one of them is an elimination, element by element, of all but the values at the edges.

use super::elements::{BASIS, Basis, Elements, Matrix};
use super::radau::{RADAU, Radau, STAGES};
use crate::numerics::legendre::{NODES, Nodal, RULE};

/// A rate per time at which mass is taken away at a part of the step and a place.
pub type Loss<'a> = &'a dyn Fn(f64, f64) -> f64;

/// What a density moves in.
#[derive(Clone, Copy)]
pub struct Field<'a> {
    /// U'.
    pub slope: &'a dyn Fn(f64) -> f64,
    /// D, above 0.
    pub diffusion: f64,
    /// What takes mass away besides the floor.
    pub loss: Option<Loss<'a>>,
}

/// How elements move in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeMotion {
    /// How far the floor rises, …
    pub(super) by: f64,
    /// … in this time.
    pub(super) duration: f64,
    /// Whether the floor absorbs; else it reflects.
    pub(super) absorbing: bool,
    /// The last edge that goes with the floor; those above rest.
    pub(super) last: usize,
}

/// A step, solved.
#[derive(Debug)]
pub(super) struct Slab {
    /// The density at Radau's points.
    pub(super) stages: Vec<Elements>,
    /// By how much the last sweep changed it, in the mean.
    pub(super) unsettled: f64,
}

/// Sweeps, at most.
const MOST_SWEEPS: usize = 60;

/// Functions of an element that vanish at its ends.
const INNER: usize = NODES - 2;

/// An element at one of Radau's points.
#[derive(Debug)]
struct SlabElement {
    half: f64,
    /// ∫[ψ'(Dφ' + (DU' + c)φ) + ψwφ].
    operator: Matrix,
    inner: Elimination,
}

/// ∫ψφ + a × the operator, without the inner functions.
#[derive(Debug)]
struct Elimination {
    factors: [[f64; INNER]; INNER],
    pivots: [usize; INNER],
    /// What the inner functions take from the two at the ends, …
    down: [[f64; 2]; INNER],
    /// … and those at the ends from the inner ones.
    up: [[f64; INNER]; 2],
    ends: [[f64; 2]; 2],
}

impl Elimination {
    fn new(system: &Matrix) -> Self {
        let factors = std::array::from_fn(|i| std::array::from_fn(|j| system[i + 2][j + 2]));
        let up = std::array::from_fn(|i| std::array::from_fn(|j| system[i][j + 2]));
        let mut out = Self { factors, pivots: [0; INNER], down: [[0.0; 2]; INNER], up, ends: [[0.0; 2]; 2] };
        out.factorise();
        for end in 0..2 {
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

    /// Gaussian elimination with rows exchanged.
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
    /// The element between two edges that move at these speeds, `done` of the step being done; `a` is the length of an implicit
    /// Euler step. `still` is the operator, where it is known.
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

/// Moves a density on, until sweeps change it by no more than `settled`.
pub(super) fn slab(density: &Elements, motion: &EdgeMotion, field: &Field<'_>, settled: f64) -> Slab {
    let mesh = SlabMesh::new(density, motion, field);
    let start: Vec<Nodal> =
        (0..density.count()).map(|i| Basis::moments(&density.series[i], density.element(i).1)).collect();
    let nothing = vec![[0.0; NODES]; density.count()];
    let (mut rates, mut amplitudes) = (vec![nothing.clone(); STAGES], vec![nothing; STAGES]);
    let rounding = 2.0 * f64::EPSILON * density.mass().abs();
    let mut unsettled = f64::INFINITY;
    for sweep in 0..MOST_SWEEPS {
        let fixed: Vec<Vec<Nodal>> = (0..STAGES)
            .map(|m| {
                let implicit = |l: usize| if l <= m { RADAU.sweep[m][l] } else { 0.0 };
                let weights = std::array::from_fn(|l| motion.duration * (RADAU.weights[m][l] - implicit(l)));
                if sweep == 0 { start.clone() } else { added(&start, &rates, weights) }
            })
            .collect();
        let before = std::mem::take(&mut unsettled);
        for (m, fixed) in fixed.iter().enumerate() {
            let weights =
                std::array::from_fn(|l| if l < m { motion.duration * RADAU.sweep[m][l] } else { 0.0 });
            let next = mesh.solve(m, added(fixed, &rates, weights));
            unsettled = unsettled.max(mesh.apart(m, &next, &amplitudes[m]));
            rates[m] = mesh.rates(m, &next);
            amplitudes[m] = next;
        }
        // What rounding leaves does not get less.
        if unsettled < settled.max(rounding)
            || (sweep > 12 && unsettled > 0.5 * before && unsettled < 10.0 * settled)
        {
            break;
        }
    }
    let stage = |m: usize| Elements {
        edges: mesh.edges(RADAU.nodes[m]),
        series: amplitudes[m].iter().map(Basis::series).collect(),
    };
    Slab { stages: (0..STAGES).map(stage).collect(), unsettled }
}

/// Moments, and rates of all stages times weights.
fn added(moments: &[Nodal], rates: &[Vec<Nodal>], weights: [f64; STAGES]) -> Vec<Nodal> {
    let mut out = moments.to_vec();
    for (rates, weight) in rates.iter().zip(weights).filter(|(_, weight)| *weight != 0.0) {
        for (out, rate) in out.iter_mut().zip(rates) {
            out.iter_mut().zip(rate).for_each(|(out, rate)| *out += weight * rate);
        }
    }
    out
}

/// The elements in a step.
struct SlabMesh<'a> {
    start: &'a [f64],
    motion: &'a EdgeMotion,
    /// At each of Radau's points.
    cells: Vec<Vec<SlabElement>>,
}

impl<'a> SlabMesh<'a> {
    fn new(density: &'a Elements, motion: &'a EdgeMotion, field: &Field<'_>) -> Self {
        let mut mesh = Self { start: &density.edges, motion, cells: Vec::new() };
        for m in 0..STAGES {
            let edges = mesh.edges(RADAU.nodes[m]);
            let times = (RADAU.nodes[m], motion.duration * RADAU.sweep[m][m]);
            let cell = |i: usize| {
                let speeds = [i, i + 1].map(|i| mesh.share(i) * motion.by / motion.duration);
                let rests = speeds == [0.0; 2] && field.loss.is_none();
                let still = mesh.cells.first().filter(|_| rests).map(|cells| &cells[i].operator);
                SlabElement::new(([edges[i], edges[i + 1]], speeds), field, times, still)
            };
            let cells = (0..density.count()).map(cell).collect();
            mesh.cells.push(cells);
        }
        mesh
    }

    /// The speed of an edge over that of the floor.
    fn share(&self, edge: usize) -> f64 {
        if edge <= self.motion.last { 1.0 } else { 0.0 }
    }

    fn edges(&self, done: f64) -> Vec<f64> {
        let at = |(i, edge): (usize, &f64)| edge + self.share(i) * done * self.motion.by;
        self.start.iter().enumerate().map(at).collect()
    }

    /// How far two densities are apart, in the mean, as seen by the two lowest moments of each element.
    fn apart(&self, m: usize, one: &[Nodal], other: &[Nodal]) -> f64 {
        let of = |((cell, a), b): ((&SlabElement, &Nodal), &Nodal)| {
            let [a, b] = [Basis::series(a), Basis::series(b)];
            cell.half * ((a[0] - b[0]).abs() + (a[1] - b[1]).abs())
        };
        self.cells[m].iter().zip(one).zip(other).map(of).sum()
    }

    /// How fast the moments change.
    fn rates(&self, m: usize, amplitudes: &[Nodal]) -> Vec<Nodal> {
        let rate = |(cell, density): (&SlabElement, &Nodal)| {
            cell.operator.map(|row| -row.iter().zip(density).map(|(a, b)| a * b).sum::<f64>())
        };
        self.cells[m].iter().zip(amplitudes).map(rate).collect()
    }

    /// The amplitudes of which these are the moments after an implicit Euler step.
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
        tridiagonal(&mut rows, &mut ends, usize::from(self.motion.absorbing));
        for (i, (cell, out)) in self.cells[m].iter().zip(&mut moments).enumerate() {
            (out[0], out[1]) = (ends[i], ends[i + 1]);
            for (j, down) in cell.inner.down.iter().enumerate() {
                out[j + 2] -= down[0] * ends[i] + down[1] * ends[i + 1];
            }
        }
        moments
    }
}

/// Solves the equation with these rows (below, diagonal, above) from the row `first` on; what comes before is 0.
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

/// What the polynomials of mass and first moment of each element in time leave out, together.
pub(super) fn left_out(start: &Elements, stages: &[Elements], radau: &Radau) -> f64 {
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
