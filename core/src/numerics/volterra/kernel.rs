//! The kernel of a convolution: a density with its breakpoints and point masses.

use num_complex::Complex64;

use super::leading::Leading;
use crate::numerics::breakpoints::{Atom, Breakpoint, same_position};
use crate::numerics::legendre::Nodal;
use crate::numerics::order::sort_by_number;
use crate::numerics::piecewise::Piecewise;

/// A density on u ≥ 0 with its breakpoints, point masses among them.
#[derive(Debug, Clone, Default)]
pub struct Kernel {
    curve: Piecewise,
    breakpoints: Vec<Breakpoint>,
    /// For each boundary of the curve: whether it is a breakpoint.
    at_breakpoint: Vec<bool>,
    /// For each cell of the curve: an upper bound of its magnitude.
    bounds: Vec<f64>,
    /// The leading cells of the curve, merged.
    leading: Leading,
    /// ∫ of the curve: the scale of what is negligible.
    size: f64,
}

impl Kernel {
    /// A kernel from its density and all its breakpoints, by rising position.
    pub fn new(curve: Piecewise, breakpoints: Vec<Breakpoint>) -> Self {
        let next = |x: f64| breakpoints.partition_point(|b| b.position < x * (1.0 - 1e-12));
        let is_break = |x: f64| breakpoints.get(next(x)).is_some_and(|b| same_position(b.position, x));
        let at_breakpoint = curve.boundaries.iter().map(|&x| is_break(x)).collect();
        // |P_n| ≤ 1 on the cell, so that the sum of the magnitudes of the coefficients is a bound.
        let bounds = curve.coefficients.iter().map(|c| c.iter().map(|c| c.abs()).sum()).collect();
        let size = curve.integral().abs();
        let leading = Leading::of(&curve);
        Self { curve, breakpoints, at_breakpoint, bounds, leading, size }
    }

    /// The density.
    pub fn curve(&self) -> &Piecewise {
        &self.curve
    }

    /// The breakpoints.
    pub fn breakpoints(&self) -> &[Breakpoint] {
        &self.breakpoints
    }

    /// Point masses.
    pub fn atoms(&self) -> impl Iterator<Item = Atom> + '_ {
        let atoms = self.breakpoints.iter().filter(|b| b.is_atom());
        atoms.map(|b| Atom { position: b.position, weight: b.amplitude })
    }

    /// The Laplace transform ∫e^{−su} of density and point masses, and its derivative with respect to s.
    pub fn transform(&self, s: Complex64) -> (Complex64, Complex64) {
        self.atoms().fold(self.curve.transform(s), |sum, atom| {
            let term = atom.weight * (-s * atom.position).exp();
            (sum.0 + term, sum.1 - atom.position * term)
        })
    }

    /// Appends the boundaries in (low, high) at which a quadrature over cells of width `width` must be split.
    pub fn splits(&self, low: f64, high: f64, width: f64, out: &mut Vec<f64>) {
        let edges = &self.curve.boundaries;
        let first = edges.partition_point(|&b| b <= low);
        for k in first..edges.len() {
            if edges[k] >= high {
                break;
            }
            // Smooth boundaries only matter where the cells of the kernel are narrower than those of the
            // solution.
            let left = k.checked_sub(1).map_or(f64::INFINITY, |j| edges[k] - edges[j]);
            let right = edges.get(k + 1).map_or(f64::INFINITY, |b| b - edges[k]);
            if self.at_breakpoint[k] || left.min(right) < 0.49 * width {
                out.push(edges[k]);
            }
        }
    }

    /// Whether a quadrature over cells of width `width` on [low, high] needs no splitting.
    pub(super) fn is_smooth(&self, low: f64, high: f64, width: f64) -> bool {
        let mut cuts = Vec::new();
        self.splits(low, high, width, &mut cuts);
        cuts.is_empty() && high <= self.curve.end()
    }

    /// The leading cells of the curve that end at or before `end`, merged: the end and the values. `None` for few.
    pub(super) fn leading(&self, end: f64) -> Option<(f64, &Nodal)> {
        self.leading.until(&self.curve.boundaries, end).map(|(_, end, values)| (end, values))
    }

    /// Cells of the curve that overlap [low, high].
    fn cells_within(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let edges = &self.curve.boundaries;
        let first = edges.partition_point(|&b| b <= low).saturating_sub(1);
        first..edges.partition_point(|&b| b < high).min(self.bounds.len())
    }

    /// Upper bound of |curve| on [low, high].
    pub(super) fn bound(&self, low: f64, high: f64) -> f64 {
        self.bounds[self.cells_within(low, high)].iter().fold(0.0, |most, &b| most.max(b))
    }

    /// The part of the curve on [low, high] that a polynomial on cells of this width misses, with points
    /// spaced by `spacing`.
    pub(super) fn roughness(&self, low: f64, high: f64, width: f64, spacing: f64) -> f64 {
        let first = self.breakpoints.partition_point(|b| b.position <= low);
        let inside =
            self.breakpoints[first..].iter().take_while(|b| b.position < high).filter(|b| !b.is_atom());
        let kinks = inside.map(|b| b.weight(spacing)).fold(0.0, f64::max);
        let fine = |cell: &usize| {
            2.0 * self.curve.cell(*cell).1 < 0.49 * width
                && !(self.at_breakpoint[*cell] && self.at_breakpoint[*cell + 1])
        };
        let cells = self.cells_within(low, high).filter(fine);
        cells.map(|cell| self.bounds[cell]).fold(kinks, f64::max)
    }

    /// Whether [low, high] contains cells of the curve much narrower than itself with a mass above `mass`.
    pub(super) fn hides_mass(&self, low: f64, high: f64, mass: f64) -> bool {
        self.cells_within(low, high).any(|cell| {
            let width = 2.0 * self.curve.cell(cell).1;
            width < 0.25 * (high - low) && self.bounds[cell] * width > mass
        })
    }

    /// The position up to which the curve is 0.
    pub(super) fn start(&self) -> f64 {
        let first = self.bounds.iter().position(|&bound| bound > 0.0).unwrap_or(self.bounds.len());
        self.curve.boundaries.get(first).copied().unwrap_or(0.0)
    }

    /// |∫ of the curve|, the scale of what is negligible.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Whether cells and breakpoints are those of another kernel.
    pub(super) fn has_cells_of(&self, other: &Self) -> bool {
        self.curve.boundaries == other.curve.boundaries && self.at_breakpoint == other.at_breakpoint
    }

    /// Whether it has a steep breakpoint.
    pub(super) fn is_steep(&self) -> bool {
        self.breakpoints.iter().any(Breakpoint::is_steep)
    }

    /// Whether a cell belongs to the graded mesh above a breakpoint that satisfies `such`.
    fn is_graded(&self, cell: usize, such: fn(&Breakpoint) -> bool) -> bool {
        let (low, high) = (self.curve.boundaries[cell], self.curve.boundaries[cell + 1]);
        let near = |b: &Breakpoint| b.position <= low && low - b.position < 4.0 * (high - low);
        self.breakpoints.iter().any(|b| such(b) && near(b))
    }

    /// The width below which cells hold the fraction `light` of the mass, or a tenth, counting those that
    /// narrow towards a steep breakpoint. Cells beside a singularity do not count, since the cells of a
    /// solution double in width from there. If all cells are such, the width that halves the mean; infinite
    /// if there are only point masses.
    pub(crate) fn narrow_width(&self, light: f64) -> f64 {
        let mut cells: Vec<(f64, f64, usize)> = (0..self.bounds.len())
            .map(|cell| {
                let width = 2.0 * self.curve.cell(cell).1;
                (width, width * self.curve.coefficients[cell][0].abs(), cell)
            })
            .collect();
        sort_by_number(&mut cells, |item| item.0);
        let total: f64 = cells.iter().map(|cell| cell.1).sum();
        let (mut all, mut fine) = (0.0, 0.0);
        let counted =
            cells.iter().filter(|cell| !self.is_graded(cell.2, Breakpoint::is_singular)).find(|cell| {
                all += cell.1;
                fine += if self.is_graded(cell.2, Breakpoint::is_steep) { 0.0 } else { cell.1 };
                all > 0.1 * total || fine > light * total
            });
        let moment = |cell: &(f64, f64, usize)| cell.1 * self.curve.cell(cell.2).0;
        let whole: f64 = cells.iter().map(moment).sum();
        let mut below = 0.0;
        let halving = || {
            cells.iter().find(|cell| {
                below += moment(cell);
                below > 0.5 * whole
            })
        };
        counted.or_else(halving).map_or(f64::INFINITY, |cell| cell.0)
    }
}
