//! One time step of a density on spectral elements, of which the lowest move with the floor (a space–time
//! slab).
//!
//! The Galerkin form (`galerkin`) is collocated at the Radau points and solved by spectral deferred corrections, of which
//! each is an implicit Euler step.

use super::elements::{Basis, Elements};
use super::galerkin::{Field, GalerkinElement, Operator, implicit_step};
use super::radau::{RADAU, Radau, STAGES};
use crate::numerics::legendre::{NODES, Nodal};
use crate::numerics::piecewise::extrapolated;
use crate::numerics::wide::vectorised;

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
        let before = std::mem::take(&mut iteration_error);
        iteration_error = vectorised(
            #[inline(always)]
            || mesh.sweep(&start, sweep == 0, &mut rates, &mut amplitudes),
        );
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
#[inline(always)]
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
    cells: Vec<Vec<GalerkinElement>>,
}

impl<'a> SlabMesh<'a> {
    fn new(density: &'a Elements, motion: &'a EdgeMotion, field: &Field<'_>) -> Self {
        let mut mesh = Self { start: &density.edges, motion, cells: Vec::new() };
        for m in 0..STAGES {
            let edges = mesh.edges(RADAU.nodes[m]);
            let a = motion.duration * RADAU.sweep[m][m];
            let cell = |i: usize| {
                let speeds = [i, i + 1].map(|i| mesh.relative_velocity(i) * motion.by / motion.duration);
                // An element at rest without loss has the same operator at all stages; only the
                // implicit step length differs.
                let rests = speeds == [0.0; 2] && field.loss.is_none();
                let still = mesh.cells.first().filter(|_| rests).map(|cells| cells[i].operator().clone());
                let ends = [edges[i], edges[i + 1]];
                let operator = still.unwrap_or_else(|| Operator::new((ends, speeds), field, RADAU.nodes[m]));
                GalerkinElement::new(0.5 * (ends[1] - ends[0]), operator, a)
            };
            let cells = (0..density.count()).map(cell).collect();
            mesh.cells.push(cells);
        }
        mesh
    }

    /// One sweep of spectral deferred correction; returns how far it moves the densities.
    #[inline(always)]
    fn sweep(
        &self,
        start: &[Nodal],
        first: bool,
        rates: &mut [Vec<Nodal>],
        amplitudes: &mut [Vec<Nodal>],
    ) -> f64 {
        // The part of the Radau quadrature that the implicit sweep does not
        // contain is taken from the rates of the previous sweep. At convergence both parts add up to the
        // collocation equations.
        let EdgeMotion { duration, absorbing, .. } = *self.motion;
        let fixed: Vec<Vec<Nodal>> = (0..STAGES)
            .map(|m| {
                let implicit = |l: usize| if l <= m { RADAU.sweep[m][l] } else { 0.0 };
                let weights = std::array::from_fn(|l| duration * (RADAU.weights[m][l] - implicit(l)));
                if first { start.to_vec() } else { added(start, rates, weights) }
            })
            .collect();
        let mut change = 0.0_f64;
        for (m, fixed) in fixed.iter().enumerate() {
            let weights = std::array::from_fn(|l| if l < m { duration * RADAU.sweep[m][l] } else { 0.0 });
            let next = implicit_step(&self.cells[m], added(fixed, rates, weights), absorbing);
            change = change.max(self.distance(m, &next, &amplitudes[m]));
            rates[m] = self.rates(m, &next);
            amplitudes[m] = next;
        }
        change
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
        let of = |((cell, a), b): ((&GalerkinElement, &Nodal), &Nodal)| {
            let [a, b] = [Basis::series(a), Basis::series(b)];
            cell.half * ((a[0] - b[0]).abs() + (a[1] - b[1]).abs())
        };
        self.cells[m].iter().zip(one).zip(other).map(of).sum()
    }

    /// Rates of change of the moments.
    #[inline(always)]
    fn rates(&self, m: usize, amplitudes: &[Nodal]) -> Vec<Nodal> {
        self.cells[m].iter().zip(amplitudes).map(|(cell, amplitudes)| cell.rates(amplitudes)).collect()
    }
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
        2.0 * extrapolated(pair(STAGES), pair(STAGES - 2))
    };
    (0..start.count()).map(|i| of(i, 0) + of(i, 1)).sum()
}
