//! A half-space of which only a patch is covered by cells.

use std::f64::consts::PI;

use super::{WaveStiffness, from_first, sides};
use crate::Result;
use crate::monitor::{Monitor, report};
use crate::numerics::fractional::{row_share_of_sqrt_laplacian, sqrt_laplacian};
use crate::numerics::line::{Line, Scratch};
use crate::numerics::modes::Modes;
use crate::parallel;
use crate::shape::Shape;

/// A_ji = −w_ji with weights w, A_jj = Σ_i w_ji: cells act on each other as in an infinite plane.
#[derive(Debug)]
pub(super) struct OpenEdges {
    stiffness: WaveStiffness,
    pairs: Pairs,
    /// Modes of the lattice with free edges, in which the same function of its Laplacian is close to A.
    free: Modes,
}

/// The convolution with the weights, and its value at equal displacements, A_jj.
#[derive(Debug)]
struct Pairs {
    modes: Modes,
    /// Factors of cosines along rows × down columns.
    spectrum: Vec<f64>,
    height: usize,
    self_stiffness: Vec<f64>,
}

impl OpenEdges {
    pub(super) fn new(shape: Shape, stiffness: WaveStiffness, monitor: &mut dyn Monitor) -> Result<Self> {
        let sides = sides(shape);
        let mut weights = match shape {
            Shape::Chain(length) => (0..length).map(along_a_chain).collect(),
            Shape::Square(sides) => sqrt_laplacian(sides, monitor)?,
        };
        weights.iter_mut().for_each(|weight| *weight *= stiffness.columns);
        let excess = stiffness.excess();
        if matches!(shape, Shape::Square(_)) && excess != 0.0 {
            let rows = row_share_of_sqrt_laplacian(sides, monitor)?;
            weights.iter_mut().zip(&rows).for_each(|(weight, row)| *weight += excess * row);
        }
        let pairs = Pairs::new(sides, &weights, monitor)?;
        Ok(Self { stiffness, pairs, free: Modes::new(sides, sides.map(Line::free)) })
    }

    pub(super) fn forces(
        &mut self,
        displacements: &[f64],
        forces: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        self.pairs.stiffness(displacements, forces, monitor)?;
        forces.iter_mut().for_each(|force| *force = -*force);
        Ok(())
    }

    /// Approximates (diagonal + A)⁻¹ r in the modes of free edges.
    pub(super) fn precondition(
        &mut self,
        diagonal: f64,
        right: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let Self { stiffness, free, .. } = self;
        // The function of the Laplacian with free edges is not A, whose cells act through the half-space
        // outside of the patch, but close to it, which is enough for a preconditioner.
        let inverse = |down: f64, along: f64| (diagonal + stiffness.against(down, along)).recip();
        free.apply(right, inverse, monitor)
    }

    pub(super) fn self_stiffness(&self, cell: usize) -> f64 {
        self.pairs.self_stiffness[cell]
    }
}

/// −∫ 2|sin(q/2)| cos(qm) dq/2π over a Brillouin zone.
fn along_a_chain(distance: usize) -> f64 {
    let m = distance as f64;
    if distance == 0 { 0.0 } else { 1.0 / (PI * (m - 0.5) * (m + 0.5)) }
}

impl Pairs {
    fn new(sides: [usize; 2], weights: &[f64], monitor: &mut dyn Monitor) -> Result<Self> {
        // Zero padding to twice the length makes the cyclic convolution a linear one.
        let lines = sides.map(|side| Line::periodic(padded(side)));
        let height = lines[0].length() / 2 + 1;
        report(monitor, 0.0)?;
        let spectrum = spectrum(weights, sides, &lines);
        report(monitor, 0.0)?;
        let mut pairs =
            Self { modes: Modes::new(sides, lines), spectrum, height, self_stiffness: Vec::new() };
        let mut self_stiffness = vec![1.0; weights.len()];
        pairs.convolve(&mut self_stiffness, monitor)?;
        pairs.self_stiffness = self_stiffness;
        Ok(pairs)
    }

    fn convolve(&mut self, field: &mut [f64], monitor: &mut dyn Monitor) -> Result<()> {
        let (spectrum, height) = (&self.spectrum, self.height);
        let factor = |mode: usize, column: &mut [f64]| {
            let factors = &spectrum[mode.div_ceil(2) * height..][..height];
            column[0] *= factors[0];
            for (pair, factor) in column[1..].chunks_mut(2).zip(&factors[1..]) {
                pair.iter_mut().for_each(|amplitude| *amplitude *= factor);
            }
        };
        self.modes.multiply(field, factor, monitor)
    }

    /// A x.
    fn stiffness(&mut self, x: &[f64], image: &mut [f64], monitor: &mut dyn Monitor) -> Result<()> {
        // A is applied to differences from the first cell: a common displacement makes no force,
        // and would only add rounding errors in the convolution.
        from_first(x, image);
        self.convolve(image, monitor)?;
        image
            .iter_mut()
            .zip(x)
            .zip(&self.self_stiffness)
            .for_each(|((y, near), self_stiffness)| *y = self_stiffness * (*near - x[0]) - *y);
        Ok(())
    }
}

/// Length of a ring on which a line of `side` cells does not overlap itself, and whose transform is fast: even, and
/// without prime factors above 5.
fn padded(side: usize) -> usize {
    let smooth = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    if side == 1 { 1 } else { (side..).map(|half| 2 * half).find(|&n| smooth(n)).unwrap_or(2 * side) }
}

/// Σ weights(d) cos of even weights on a torus of `lines`, modes along rows × modes down columns, cosines only.
fn spectrum(weights: &[f64], [rows, columns]: [usize; 2], lines: &[Line; 2]) -> Vec<f64> {
    let along = cosines(weights, rows, columns, &lines[1]);
    let width = along.len() / rows;
    let mut turned = vec![0.0; along.len()];
    parallel::map(turned.chunks_mut(rows).collect(), &|mode, column: &mut [f64]| {
        column.iter_mut().zip(along[mode..].iter().step_by(width)).for_each(|(to, from)| *to = *from);
    });
    cosines(&turned, width, rows, &lines[0])
}

/// Amplitudes of cosines of `count` lines of so many weights at distances 0, 1, … either way.
fn cosines(weights: &[f64], count: usize, reach: usize, line: &Line) -> Vec<f64> {
    let modes = line.length() / 2 + 1;
    let mut out = vec![0.0; count * modes];
    let room = || (line.scratch(), vec![0.0; line.length()]);
    let transform = |(scratch, ring): &mut (Scratch, Vec<f64>), _, (out, weights): (&mut [f64], &[f64])| {
        ring.fill(0.0);
        ring[..reach].copy_from_slice(weights);
        let length = ring.len();
        (1..reach).for_each(|m| ring[length - m] = weights[m]);
        line.to_modes(ring, scratch);
        out[0] = ring[0];
        out[1..].iter_mut().zip(ring[1..].iter().step_by(2)).for_each(|(out, amplitude)| *out = *amplitude);
    };
    parallel::map_with(out.chunks_mut(modes).zip(weights.chunks(reach)).collect(), 1, &room, &transform);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_long_enough_and_quickly_transformed() {
        assert_eq!([1, 2, 3, 7, 13, 512, 1000, 1021].map(padded), [1, 4, 6, 16, 30, 1024, 2000, 2048]);
    }

    /// Weights √Δ + (c − 1) Δ_row/√Δ are positive for 0.517 < c < 1.9336, c = 1/(1 − ν). The third cell ahead and the third one beside
    /// are the first that are pulled back.
    #[test]
    fn poisson_ratios_end_where_the_third_cell_is_pulled_back() {
        const SIDE: usize = 100;
        let sides = [SIDE; 2];
        let weights = [sqrt_laplacian(sides, &mut ()), row_share_of_sqrt_laplacian(sides, &mut ())];
        let [all, rows] = weights.map(Result::unwrap);
        let ends = |sign: f64| {
            let far = |place: &usize| sign * rows[*place] < 0.0;
            let bound = |place: usize| (all[place] / rows[place].abs(), place);
            (1..SIDE * SIDE)
                .filter(far)
                .map(bound)
                .fold((f64::INFINITY, 0), |a, b| if b.0 < a.0 { b } else { a })
        };
        let ((above, beside), (below, ahead)) = (ends(1.0), ends(-1.0));
        assert_eq!((beside, ahead), (3 * SIDE, 3));
        let ratio = |excess: f64| 1.0 - 1.0 / (1.0 + excess);
        // The digits that are reported.
        assert!(
            (ratio(above) - 0.4828).abs() < 1e-4 && (ratio(-below) + 0.934).abs() < 1e-3,
            "{above} {below}"
        );
        let accepted = super::super::Solid::POISSON_RATIOS;
        assert!(*accepted.end() < ratio(above) && *accepted.start() > ratio(-below));
    }

    /// The iteration takes some 15 steps to roundings where these ratios span a factor of two.
    #[test]
    fn modes_of_free_edges_come_near_at_any_size() {
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let solids = [(20, 1.0), (200, 1.0), (200, 1.9)];
        for (side, columns) in solids {
            let stiffness = WaveStiffness { columns, rows: 1.0 };
            let mut open = OpenEdges::new(Shape::Square([side, side]), stiffness, &mut ()).unwrap();
            for (diagonal, wave) in [(1e-4, 0.0), (1e-4, 0.02), (1e-4, 3.0), (0.1, 0.0), (0.1, 0.3)] {
                let right: Vec<f64> = (0..side * side).map(|j| (wave * (j * j) as f64).cos()).collect();
                let mut near = right.clone();
                open.precondition(diagonal, &mut near, &mut ()).unwrap();
                let mut forces = vec![0.0; near.len()];
                open.forces(&near, &mut forces, &mut ()).unwrap();
                let held = diagonal * product(&near, &near) - product(&near, &forces);
                let ratio = held / product(&near, &right);
                assert!((0.7..1.4).contains(&ratio), "{side} {columns} {diagonal} {wave}: {ratio}");
            }
        }
    }
}
