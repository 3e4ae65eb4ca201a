//! Distributions given by numbers: a tabulated density, or samples.

use num_complex::Complex64;

use super::range::length_or_zero;
use super::{Atom, Breakpoint, Law, Parameter, SharedLaw, Zone, not_negative, unknown};
use crate::monitor::{Monitor, Part, report_at};
use crate::numerics::legendre::RULE;
use crate::numerics::sorting::sorted;
use crate::random::Stream;
use crate::{Error, Result};

/// A density that is linear between nodes, and point masses at nodes.
///
/// From rows (stretch, density): linear between rows, 0 outside, normalised. From n samples: the distribution
/// whose quantile function is linear between the sorted samples (NumPy's default), with the same mass in each
/// of the n − 1 gaps; m equal samples make a point mass of m − 1 gaps. Moments are exact to order 30.
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulated {
    nodes: Vec<TableNode>,
    std: f64,
}

/// A node and the cell up to the next one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct TableNode {
    position: f64,
    /// Point mass here.
    atom: f64,
    /// Density at the start and at the end of the cell.
    start: f64,
    end: f64,
    /// P(ξ ≤ position).
    below: f64,
    /// Moments of order 0 to 3 of the mass above `position`.
    above: [f64; 4],
}

impl Tabulated {
    /// The distribution of a density given by rows of stretch and density, linear between rows, of any total
    /// mass.
    ///
    /// # Errors
    /// Fewer than two rows, stretches not rising from 0 or above, a density below 0, or no mass at all.
    pub fn from_density(rows: &[(f64, f64)]) -> Result<Self> {
        Self::from_density_with(rows, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// Those of [`Self::from_density`]; stopped by the monitor.
    pub fn from_density_with(rows: &[(f64, f64)], monitor: &mut dyn Monitor) -> Result<Self> {
        if rows.len() < 2 {
            return Err(Error::invalid("density", "at least two rows", rows.len()));
        }
        for &(stretch, density) in rows {
            length_or_zero("stretch", stretch)?;
            not_negative("density", density)?;
        }
        if let Some(pair) = rows.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
            let expected = format!("stretches that rise, after {}", pair[0].0);
            return Err(Error::invalid("stretch", expected, pair[1].0));
        }
        let node = |i: usize| TableNode {
            position: rows[i].0,
            start: if i + 1 < rows.len() { rows[i].1 } else { 0.0 },
            end: rows.get(i + 1).map_or(0.0, |row| row.1),
            ..TableNode::default()
        };
        let mut nodes = Vec::with_capacity(rows.len());
        for i in 0..rows.len() {
            report_at(&mut Part::new(monitor, 0.0, 0.2), i, rows.len())?;
            nodes.push(node(i));
        }
        Self::new(nodes, "density", &mut Part::new(monitor, 0.2, 0.8))
    }

    /// The distribution of samples, in any order.
    ///
    /// # Errors
    /// No sample, or one that is below 0 or not finite.
    pub fn from_samples(samples: &[f64]) -> Result<Self> {
        Self::from_samples_with(samples, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// Those of [`Self::from_samples`]; stopped by the monitor.
    pub fn from_samples_with(samples: &[f64], monitor: &mut dyn Monitor) -> Result<Self> {
        if samples.is_empty() {
            return Err(Error::invalid("samples", "at least one sample", 0));
        }
        samples.iter().try_for_each(|&x| length_or_zero("samples", x).map(drop))?;
        let sorted = sorted(samples, &mut Part::new(monitor, 0.0, 0.5))?;
        // One sample is a point mass, as two equal ones are.
        let gap = 1.0 / (samples.len() - 1).max(1) as f64;
        let mut nodes: Vec<TableNode> = Vec::new();
        for (i, run) in sorted.chunk_by(|a, b| a == b).enumerate() {
            report_at(&mut Part::new(monitor, 0.5, 0.1), i, sorted.len())?;
            let position = run[0];
            if let Some(last) = nodes.last_mut() {
                last.start = gap / (position - last.position);
                last.end = last.start;
            }
            let atom = if samples.len() == 1 { gap } else { gap * (run.len() - 1) as f64 };
            nodes.push(TableNode { position, atom, ..TableNode::default() });
        }
        Self::new(nodes, "samples", &mut Part::new(monitor, 0.6, 0.4))
    }

    /// Sums the masses and normalises them.
    fn new(mut nodes: Vec<TableNode>, key: &str, monitor: &mut dyn Monitor) -> Result<Self> {
        let (count, last) = (nodes.len(), nodes.len() - 1);
        let mut ask =
            |pass: f64, node: usize| report_at(&mut Part::new(monitor, pass / 3.0, 1.0 / 3.0), node, count);
        for i in (1..=last).rev() {
            ask(0.0, last - i)?;
            let (cell, next) = (nodes[i - 1], nodes[i]);
            nodes[i - 1].above = std::array::from_fn(|n| {
                let power = next.position.powi(n as i32);
                next.above[n] + next.atom * power + cell.moment(n as u32, cell.position, next.position)
            });
        }
        let total = nodes[0].above[0] + nodes[0].atom;
        if !(total.is_finite() && total > 0.0) {
            return Err(Error::invalid(key, "a finite mass above 0", total));
        }
        let mut below = 0.0;
        for i in 0..=last {
            ask(1.0, i)?;
            below += nodes[i].atom / total;
            nodes[i].scale(1.0 / total, below);
            let next = nodes.get(i + 1).map_or(nodes[i].position, |next| next.position);
            below += nodes[i].mass(next - nodes[i].position);
        }
        let mean = nodes[0].above[1] + nodes[0].atom * nodes[0].position;
        let mut variance = 0.0;
        for i in 0..=last {
            ask(2.0, i)?;
            variance += nodes[i].atom * (nodes[i].position - mean).powi(2);
            if let Some(next) = nodes.get(i + 1) {
                variance += nodes[i].integral(nodes[i].position, next.position, |x| (x - mean).powi(2));
            }
        }
        Ok(Self { nodes, std: variance.sqrt() })
    }

    /// Cells, each with its upper end.
    fn cells(&self) -> impl Iterator<Item = (&TableNode, f64)> {
        self.nodes.windows(2).map(|pair| (&pair[0], pair[1].position))
    }

    /// The node at or below x, and the next node.
    fn locate(&self, x: f64) -> Option<(&TableNode, Option<&TableNode>)> {
        let after = self.nodes.partition_point(|node| node.position <= x);
        Some((&self.nodes[after.checked_sub(1)?], self.nodes.get(after)))
    }
}

impl TableNode {
    /// The moment of its point mass.
    fn shared(&self, order: u32) -> f64 {
        self.atom * self.position.powi(order as i32)
    }

    fn scale(&mut self, factor: f64, below: f64) {
        for value in [&mut self.atom, &mut self.start, &mut self.end] {
            *value *= factor;
        }
        self.above = self.above.map(|moment| moment * factor);
        self.below = below;
    }

    /// Density at x in the cell that ends at `to`.
    fn density(&self, x: f64, to: f64) -> f64 {
        self.start + (self.end - self.start) * ((x - self.position) / (to - self.position))
    }

    /// Mass of a cell of this width.
    fn mass(&self, width: f64) -> f64 {
        0.5 * width * (self.start + self.end)
    }

    /// ∫_x^to ξⁿ p dξ in the cell that ends at `to`.
    fn moment(&self, order: u32, x: f64, to: f64) -> f64 {
        let power = |x: f64| x.powi(order as i32);
        match order {
            0 => 0.5 * (to - x) * (self.density(x, to) + self.end),
            1..=4 => self.integral(x, to, power),
            _ => RULE.integrate(x, to, |x| power(x) * self.density(x, to)),
        }
    }

    /// ∫_x^to f p dξ in the cell that ends at `to`, by the Gauss rule of three points: exact for polynomials f of degree 4.
    fn integral(&self, x: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
        let (middle, half) = (0.5 * (x + to), 0.5 * (to - x));
        let at = |x: f64| f(x) * self.density(x, to);
        let off = half * 0.6_f64.sqrt();
        half * (5.0 * (at(middle - off) + at(middle + off)) + 8.0 * at(middle)) / 9.0
    }
}

impl Tabulated {
    /// The lower end of the support: the first position with a point mass, or from which on the density is above 0.
    fn lower_end(&self) -> f64 {
        let has_mass = |node: &&TableNode| node.atom > 0.0 || node.start > 0.0 || node.end > 0.0;
        self.nodes.iter().find(has_mass).map_or(0.0, |node| node.position)
    }
}

/// The distance over which a density, linear from `start` to `end` over `width`, accumulates `mass`.
fn invert_mass(start: f64, end: f64, width: f64, mass: f64) -> f64 {
    let root = (start * start + 2.0 * mass * (end - start) / width).max(0.0).sqrt();
    if mass <= 0.0 { 0.0 } else { (2.0 * mass / (start + root)).min(width) }
}

impl Law for Tabulated {
    fn name(&self) -> &'static str {
        "tabulated"
    }

    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn with_parameter(&self, name: &str, _value: f64) -> Result<SharedLaw> {
        Err(unknown(self, name))
    }

    fn density(&self, x: f64) -> f64 {
        match self.locate(x) {
            Some((node, Some(next))) => node.density(x, next.position),
            _ => 0.0,
        }
    }

    fn survival(&self, x: f64) -> f64 {
        self.upper_moment(0, x)
    }

    fn ln_survival(&self, x: f64) -> f64 {
        let below = match self.locate(x) {
            None => 0.0,
            Some((node, None)) => node.below,
            Some((node, Some(next))) => {
                let width = x - node.position;
                node.below + 0.5 * width * (node.start + node.density(x, next.position))
            }
        };
        if below < 0.5 { (-below).ln_1p() } else { self.survival(x).ln() }
    }

    fn hazard(&self, x: f64) -> f64 {
        let survival = self.survival(x);
        if survival > 0.0 { self.density(x) / survival } else { f64::INFINITY }
    }

    fn quantile(&self, p: f64) -> f64 {
        if p >= 1.0 {
            return self.upper_quantile(0.0);
        }
        let last = self.nodes.len() - 1;
        let i = self.nodes.partition_point(|node| node.below < p).min(last);
        let Some(node) = i.checked_sub(1).map(|i| self.nodes[i]).filter(|_| p > 0.0) else {
            return self.lower_end();
        };
        let (width, mass) = (self.nodes[i].position - node.position, p - node.below);
        if mass >= node.mass(width) {
            return self.nodes[i].position;
        }
        node.position + invert_mass(node.start, node.end, width, mass)
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        let q = q.clamp(0.0, 1.0);
        let i = self.nodes.partition_point(|node| node.above[0] > q);
        let Some(node) = i.checked_sub(1).map(|i| self.nodes[i]) else {
            return self.lower_end();
        };
        let next = self.nodes[i];
        let width = next.position - node.position;
        next.position - invert_mass(node.end, node.start, width, q - next.above[0] - next.atom)
    }

    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        let after = self.nodes.partition_point(|node| node.position <= x);
        let Some(next) = self.nodes.get(after) else { return 0.0 };
        // That above the next node is known for the lowest orders, and a sum for the others.
        let beyond = next.above.get(order as usize).copied().unwrap_or_else(|| {
            let cells = self.nodes[after..].windows(2).rev();
            cells.fold(0.0, |sum, cell| {
                cell[0].moment(order, cell[0].position, cell[1].position) + (cell[1].shared(order) + sum)
            })
        });
        let rest = next.shared(order) + beyond;
        after.checked_sub(1).map_or(rest, |at| self.nodes[at].moment(order, x, next.position) + rest)
    }

    fn std(&self) -> f64 {
        self.std
    }

    fn atoms(&self) -> Vec<Atom> {
        let atoms = self.nodes.iter().map(|node| Atom { position: node.position, weight: node.atom });
        atoms.filter(|atom| atom.weight > 0.0).collect()
    }

    /// At each node the jump of the density and the change of its slope.
    fn breakpoints(&self) -> Vec<Breakpoint> {
        let mut breakpoints = Vec::new();
        let (mut height, mut slope) = (0.0, 0.0);
        for (i, node) in self.nodes.iter().enumerate() {
            let width = self.nodes.get(i + 1).map_or(f64::INFINITY, |next| next.position - node.position);
            let next_slope = (node.end - node.start) / width;
            let (jump, kink) = (node.start - height, next_slope - slope);
            // A change of slope at the level of rounding does not count.
            let rounding = 16.0 * f64::EPSILON * (next_slope.abs() + slope.abs() + node.start / width);
            let position = node.position;
            if jump != 0.0 {
                breakpoints.push(Breakpoint { position, exponent: 0.0, amplitude: jump });
            }
            if kink.abs() > rounding {
                breakpoints.push(Breakpoint { position, exponent: 1.0, amplitude: kink });
            }
            (height, slope) = (node.end, next_slope);
        }
        breakpoints
    }

    /// A polynomial between its breakpoints.
    fn zones(&self) -> Vec<Zone> {
        vec![Zone { low: self.quantile(0.0), high: self.upper_quantile(0.0), resolution: f64::INFINITY }]
    }

    /// Σ e^{−sa} h ∫_0^1 e^{−sht} p(a + ht) dt over cells, plus the point masses. Entire.
    fn laplace(&self, s: Complex64) -> Complex64 {
        let cells = self.cells().map(|(cell, to)| {
            let width = to - cell.position;
            let (falling, rising) = ramps(-s * width);
            (-s * cell.position).exp() * width * (cell.start * falling + cell.end * rising)
        });
        let atoms = self.nodes.iter().filter(|node| node.atom > 0.0);
        cells.sum::<Complex64>() + atoms.map(|node| node.atom * (-s * node.position).exp()).sum::<Complex64>()
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        out.fill_with(|| self.quantile(stream.uniform()));
    }
}

/// ∫_0^1 e^{wt} (1 − t) dt = (eʷ − 1 − w)/w² and ∫_0^1 e^{wt} t dt = (1 + (w − 1) eʷ)/w², near 0 by their
/// series Σ wⁿ/(n+2)! and Σ (n+1) wⁿ/(n+2)!.
fn ramps(w: Complex64) -> (Complex64, Complex64) {
    if w.norm() > 1.0 {
        let (e, square) = (w.exp(), (w * w).inv());
        return ((e - 1.0 - w) * square, (1.0 + (w - 1.0) * e) * square);
    }
    let mut term = Complex64::from(0.5);
    let (mut falling, mut rising) = (term, term);
    for n in 1..20 {
        let n = f64::from(n);
        term *= w / (n + 2.0);
        falling += term;
        rising += term * (n + 1.0);
    }
    (falling, rising)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_have_numpy_quantiles() {
        // numpy.quantile([3, 1, 1, 2], [0, .2, .5, .75, .9, 1]).
        let law = Tabulated::from_samples(&[3.0, 1.0, 1.0, 2.0]).unwrap();
        for (p, x) in [(0.0, 1.0), (0.2, 1.0), (0.5, 1.5), (0.75, 2.25), (0.9, 2.7), (1.0, 3.0)] {
            // A few roundings.
            assert!((law.quantile(p) - x).abs() < 2e-15);
            assert!((law.upper_quantile(1.0 - p) - x).abs() < 2e-15);
        }
        assert_eq!(law.atoms(), [Atom { position: 1.0, weight: 1.0 / 3.0 }]);
        assert_eq!(Tabulated::from_samples(&[2.0]).unwrap().atoms(), [Atom { position: 2.0, weight: 1.0 }]);
    }

    #[test]
    fn a_triangle() {
        let law = Tabulated::from_density(&[(0.0, 0.0), (1.0, 7.0), (2.0, 0.0)]).unwrap();
        assert_eq!((law.density(1.0), law.survival(1.0), law.mean()), (1.0, 0.5, 1.0));
        // Variance 1/6; a few roundings.
        assert!((law.std() - 6.0_f64.sqrt().recip()).abs() < 1e-15);
        let kinks: Vec<_> = law.breakpoints().iter().map(|b| (b.position, b.exponent, b.amplitude)).collect();
        assert_eq!(kinks, [(0.0, 1.0, 1.0), (1.0, 1.0, -2.0), (2.0, 1.0, 1.0)]);
    }

    /// Of a density that is constant, in so many cells that a recursion over them would overflow the stack.
    #[test]
    fn high_moments_of_many_cells() {
        let count = 400_000;
        let rows: Vec<(f64, f64)> = (0..=count).map(|i| (f64::from(i) / f64::from(count), 1.0)).collect();
        let law = Tabulated::from_density(&rows).unwrap();
        for order in [3, 4, 6] {
            let exact = |x: f64| (1.0 - x.powi(order + 1)) / f64::from(order + 1);
            for x in [-1.0, 0.0, 0.3, 0.999_999, 1.0] {
                let found = law.upper_moment(order as u32, x);
                // Each of the terms is rounded.
                assert!((found - exact(x.max(0.0))).abs() < 1e-12, "{order} {x}: {found}");
            }
        }
    }

    /// Rows without density at the ends are no part of the support.
    #[test]
    fn outer_quantiles_are_the_ends_of_the_support() {
        let law =
            Tabulated::from_density(&[(0.5, 0.0), (1.0, 0.0), (2.0, 1.0), (3.0, 0.0), (4.0, 0.0)]).unwrap();
        assert_eq!([law.quantile(0.0), law.upper_quantile(1.0)], [1.0; 2]);
        assert_eq!([law.quantile(1.0), law.upper_quantile(0.0)], [3.0; 2]);
    }

    #[test]
    fn refuses_what_is_no_density() {
        let cases: [&[(f64, f64)]; 6] = [
            &[],
            &[(0.0, 1.0)],
            &[(1.0, 1.0), (1.0, 2.0)],
            &[(0.0, 1.0), (1.0, -1.0)],
            &[(0.0, 0.0), (1.0, 0.0)],
            &[(-1.0, 1.0), (1.0, 1.0)],
        ];
        assert!(cases.iter().all(|rows| Tabulated::from_density(rows).is_err()));
        assert!(Tabulated::from_samples(&[]).is_err());
        assert!(Tabulated::from_samples(&[1.0, f64::NAN]).is_err());
    }
}
