//! The known function of the convolution: a density with its breaks and atoms.

use num_complex::Complex64;

use crate::numerics::breakpoints::{Atom, Breakpoint, same_position};
use crate::numerics::piecewise::Piecewise;

/// A density on u ≥ 0 with its breaks, atoms among them.
#[derive(Debug, Clone, Default)]
pub struct Kernel {
    curve: Piecewise,
    breakpoints: Vec<Breakpoint>,
    /// For each boundary of the curve: is it a break?
    hard: Vec<bool>,
    /// For each cell of the curve: what it is at most.
    bounds: Vec<f64>,
    /// ∫ of the curve: the scale of what is negligible.
    size: f64,
}

impl Kernel {
    /// A kernel from its density and all its breaks, by rising position.
    pub fn new(curve: Piecewise, breakpoints: Vec<Breakpoint>) -> Self {
        let next = |x: f64| breakpoints.partition_point(|b| b.position < x * (1.0 - 1e-12));
        let is_break = |x: f64| breakpoints.get(next(x)).is_some_and(|b| same_position(b.position, x));
        let hard = curve.boundaries.iter().map(|&x| is_break(x)).collect();
        let bounds = curve.coefficients.iter().map(|c| c.iter().map(|c| c.abs()).sum()).collect();
        let size = curve.integral().abs();
        Self { curve, breakpoints, hard, bounds, size }
    }

    /// The density.
    pub fn curve(&self) -> &Piecewise {
        &self.curve
    }

    /// The breaks.
    pub fn breakpoints(&self) -> &[Breakpoint] {
        &self.breakpoints
    }

    /// Point masses.
    pub fn atoms(&self) -> impl Iterator<Item = Atom> + '_ {
        let atoms = self.breakpoints.iter().filter(|b| b.is_atom());
        atoms.map(|b| Atom { position: b.position, weight: b.amplitude })
    }

    /// ∫e^{−su} of the density and the point masses, and its derivative by s.
    pub fn transform(&self, s: Complex64) -> (Complex64, Complex64) {
        self.atoms().fold(self.curve.transform(s), |sum, atom| {
            let term = atom.weight * (-s * atom.position).exp();
            (sum.0 + term, sum.1 - atom.position * term)
        })
    }

    /// Boundaries in (low, high) at which a quadrature over cells of width `width` must be split.
    pub(super) fn splits(&self, low: f64, high: f64, width: f64, out: &mut Vec<f64>) {
        let edges = &self.curve.boundaries;
        let first = edges.partition_point(|&b| b <= low);
        for k in first..edges.len() {
            if edges[k] >= high {
                break;
            }
            let left = k.checked_sub(1).map_or(f64::INFINITY, |j| edges[k] - edges[j]);
            let right = edges.get(k + 1).map_or(f64::INFINITY, |b| b - edges[k]);
            if self.hard[k] || left.min(right) < 0.49 * width {
                out.push(edges[k]);
            }
        }
    }

    /// Cells of the curve that overlap [low, high].
    fn cells_within(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let edges = &self.curve.boundaries;
        let first = edges.partition_point(|&b| b <= low).saturating_sub(1);
        first..edges.partition_point(|&b| b < high).min(self.bounds.len())
    }

    /// The most that |curve| can be on [low, high].
    pub(super) fn bound(&self, low: f64, high: f64) -> f64 {
        self.bounds[self.cells_within(low, high)].iter().fold(0.0, |most, &b| most.max(b))
    }

    /// What a polynomial on cells of this width, with points spaced by `spacing`, misses of the curve on [low, high].
    pub(super) fn rough(&self, low: f64, high: f64, width: f64, spacing: f64) -> f64 {
        let first = self.breakpoints.partition_point(|b| b.position <= low);
        let inside =
            self.breakpoints[first..].iter().take_while(|b| b.position < high).filter(|b| !b.is_atom());
        let kinks = inside.map(|b| b.weight(spacing)).fold(0.0, f64::max);
        let fine = |cell: &usize| {
            2.0 * self.curve.cell(*cell).1 < 0.49 * width && !(self.hard[*cell] && self.hard[*cell + 1])
        };
        let cells = self.cells_within(low, high).filter(fine);
        cells.map(|cell| self.bounds[cell]).fold(kinks, f64::max)
    }

    /// Whether [low, high] holds cells of the curve much narrower than itself with a mass above `mass`.
    pub(super) fn hides(&self, low: f64, high: f64, mass: f64) -> bool {
        self.cells_within(low, high).any(|cell| {
            let width = 2.0 * self.curve.cell(cell).1;
            width < 0.25 * (high - low) && self.bounds[cell] * width > mass
        })
    }

    /// |∫ of the curve|, the scale of what is negligible.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Whether it has a steep break.
    pub(super) fn is_steep(&self) -> bool {
        self.breakpoints.iter().any(Breakpoint::is_steep)
    }

    /// Whether a cell is as near to such a break below it as cells are that narrow towards it.
    fn is_graded(&self, cell: usize, such: fn(&Breakpoint) -> bool) -> bool {
        let (low, high) = (self.curve.boundaries[cell], self.curve.boundaries[cell + 1]);
        let near = |b: &Breakpoint| b.position <= low && low - b.position < 4.0 * (high - low);
        self.breakpoints.iter().any(|b| such(b) && near(b))
    }

    /// The width below which the cells hold the fraction `light` of the mass, or a tenth with those that narrow towards a
    /// steep break. Cells beside a singularity do not count, since those of a solution double in width from there; where all
    /// are such, the width that halves the mean; infinite where there are only point masses.
    pub(super) fn narrow(&self, light: f64) -> f64 {
        let mut cells: Vec<(f64, f64, usize)> = (0..self.bounds.len())
            .map(|cell| {
                let width = 2.0 * self.curve.cell(cell).1;
                (width, width * self.curve.coefficients[cell][0].abs(), cell)
            })
            .collect();
        cells.sort_by(|a, b| a.0.total_cmp(&b.0));
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
