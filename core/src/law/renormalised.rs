//! Thresholds as a drive sees them that is helped by every break: the mean-field law of coupled contacts.

use num_complex::Complex64;

use super::places::places;
use super::{Atom, Break, Law, Parameter, SharedLaw, Zone, not_negative, shared};
use crate::numerics::legendre::{NODES, Nodal, RULE};
use crate::numerics::roots::brent_minimum;
use crate::random::Stream;
use crate::{Error, Result};

/// Where the slope of X(x) is above, thresholds are spread over X much as over x.
const EVEN: f64 = 0.75;

/// Cells of 16 terms in a stretch over which the slope of X(x) doubles, with its neighbourhood.
const CELLS: f64 = 12.0;

/// Change of the phase of e^{−sX}, or of its logarithm, in a cell that 16 Gauss points follow to rounding.
const PHASE: f64 = 8.0;

/// Bisection alone needs 60 steps.
const MOST_STEPS: usize = 100;

/// The drive at which contacts break that are all stretched by every break, by κξ/N where one of N contacts breaks at
/// the stretch ξ, for thresholds of law P_c and all contacts relaxed at first.
///
/// By the time that all unbroken contacts have the stretch x, the drive has stretched them by
/// X(x) = x − κ ∫_0^x ξ P_c(ξ) dξ, so that they break as free contacts would whose law of thresholds is
/// P_eff(X) = P_c(x)/[1 − κ x P_c(x)], S_eff(X) = S(x): of lower mean and narrower. At κ_c = 1/max(x P_c)
/// ([`critical_coupling`]) a share of all contacts breaks at once.
///
/// This is so until contacts break that have broken before. For a block of stiffness K pulled at its top, κ =
/// N⟨k⟩/(K + N⟨k⟩) and the drive is (1 − κ) X_T: κ < κ_c is K > K_c then.
///
/// `coupling` is κ; the law of thresholds keeps its parameters, as `law.mean`, …. S, ln S and the hazard have the
/// accuracy of that law's, times 1/(1 − κ/κ_c); moments 1e-14.
#[derive(Clone)]
pub struct Renormalised {
    coupling: f64,
    thresholds: SharedLaw,
    /// Boundaries of cells that Gauss points follow; below the first X is x.
    nodes: Vec<Node>,
    /// The Gauss points of each cell.
    points: Vec<[Mass; NODES]>,
    mean: f64,
    std: f64,
}

/// A boundary.
#[derive(Debug, Clone, Copy)]
struct Node {
    stretch: f64,
    drive: f64,
    /// ∫_0^x ξ dP, of what has broken.
    broken: f64,
    /// Moments of order 1 to 3 of X, of the mass above.
    above: [f64; 3],
}

/// A share of the contacts, and where they break.
#[derive(Debug, Clone, Copy, Default)]
struct Mass {
    stretch: f64,
    drive: f64,
    weight: f64,
}

/// κ_c = 1/max(x p(x)), the coupling at which contacts with thresholds of this law break in one avalanche: 0 where some
/// are identical.
pub fn critical_coupling(law: &dyn Law) -> f64 {
    if law.atoms().iter().any(|atom| atom.position > 0.0) {
        return 0.0;
    }
    let ends = places(law);
    ends.windows(2).map(|cell| peak(law, cell[0], cell[1])).fold(0.0, f64::max).recip()
}

/// x p(x), 0 where either is.
fn weighted(law: &dyn Law, x: f64) -> f64 {
    let density = law.density(x);
    if x == 0.0 || density == 0.0 { 0.0 } else { x * density }
}

/// The highest x p(x) from `low` up to, not at, `high`, where p is smooth.
fn peak(law: &dyn Law, low: f64, high: f64) -> f64 {
    const PARTS: usize = 8;
    let at = |k: usize| (low + (high - low) * k as f64 / PARTS as f64).min(high.next_down()).max(low);
    let value = |x: f64| weighted(law, x);
    let best = (0..=PARTS).max_by(|&i, &j| value(at(i)).total_cmp(&value(at(j)))).unwrap_or(0);
    let (low, high) = (at(best.saturating_sub(1)), at((best + 1).min(PARTS)));
    (-brent_minimum(|x| -value(x), low, high, 0.0).1).max(value(at(best)))
}

impl Renormalised {
    /// The law of `thresholds` under a `coupling` κ.
    ///
    /// # Errors
    /// A coupling below 0 or not finite, or one of κ_c or above; identical thresholds, point masses above 0.
    pub fn new(thresholds: SharedLaw, coupling: f64) -> Result<Self> {
        not_negative("coupling", coupling)?;
        if let Some(atom) = thresholds.atoms().into_iter().find(|atom| atom.position > 0.0) {
            let expected = "a law without point masses above 0: identical thresholds break together, whatever the coupling";
            return Err(Error::invalid("law", expected, format!("one at {}", atom.position)));
        }
        let critical = critical_coupling(thresholds.as_ref());
        if coupling >= critical {
            let expected =
                format!("a number from 0 to below {critical}, where contacts break in one avalanche");
            return Err(Error::invalid("coupling", expected, coupling));
        }
        let (nodes, points) = (Vec::new(), Vec::new());
        let mut law = Self { coupling, thresholds, nodes, points, mean: 0.0, std: 0.0 };
        law.sum_broken();
        law.sum_above();
        Ok(law)
    }

    /// X(x), by which the drive has stretched contacts that have the stretch x.
    pub fn drive(&self, stretch: f64) -> f64 {
        let after = self.nodes.partition_point(|node| node.stretch <= stretch);
        match after.checked_sub(1) {
            Some(cell) if stretch < f64::INFINITY => self.drive_in(cell, stretch),
            _ => stretch,
        }
    }

    /// x(X), the stretch of the unbroken contacts that the drive has stretched by X.
    pub fn stretch(&self, drive: f64) -> f64 {
        let after = self.nodes.partition_point(|node| node.drive <= drive);
        match after.checked_sub(1) {
            Some(cell) if drive < f64::INFINITY => self.stretch_in(cell, drive),
            _ => drive,
        }
    }

    fn drive_in(&self, cell: usize, stretch: f64) -> f64 {
        stretch - self.coupling * self.broken_in(cell, stretch)
    }

    /// ∫_0^x ξ dP in the cell above a node; above the last node from what is left.
    fn broken_in(&self, cell: usize, stretch: f64) -> f64 {
        let node = self.nodes[cell];
        if cell + 1 == self.nodes.len() {
            let left = |x: f64| self.thresholds.upper_moment(1, x);
            return node.broken + (left(node.stretch) - left(stretch));
        }
        let law = self.thresholds.as_ref();
        node.broken + RULE.integrate(node.stretch, stretch, |x| weighted(law, x))
    }

    /// The stretch in the cell above a node: Newton's method, kept within its bracket.
    fn stretch_in(&self, cell: usize, drive: f64) -> f64 {
        let beyond = drive + self.coupling * self.thresholds.mean();
        let low = self.nodes[cell].stretch;
        let high = self.nodes.get(cell + 1).map_or(beyond, |next| next.stretch.next_down()).max(low);
        let (mut a, mut b) = (low, high);
        let mut x = (low + (drive - self.nodes[cell].drive) / self.slope(low)).clamp(low, high);
        for _ in 0..MOST_STEPS {
            let excess = self.drive_in(cell, x) - drive;
            let step = excess / self.slope(x);
            if excess.abs() <= f64::EPSILON * drive || step.abs() <= f64::EPSILON * x {
                break;
            }
            if excess > 0.0 {
                b = x
            } else {
                a = x
            }
            x = if x - step > a && x - step < b { x - step } else { 0.5 * (a + b) };
        }
        x
    }

    /// dX/dx.
    fn slope(&self, stretch: f64) -> f64 {
        1.0 - self.coupling * weighted(self.thresholds.as_ref(), stretch)
    }

    /// Sets out nodes and sums what has broken.
    fn sum_broken(&mut self) {
        let mut broken = 0.0;
        for place in self.graded() {
            if let Some(last) = self.nodes.len().checked_sub(1) {
                let law = self.thresholds.as_ref();
                broken += RULE.integrate(self.nodes[last].stretch, place, |x| weighted(law, x));
            }
            // Places an ulp apart.
            let before = self.nodes.last().map_or(0.0, |node| node.drive);
            let drive = (place - self.coupling * broken).max(before);
            self.nodes.push(Node { stretch: place, drive, broken, above: [0.0; 3] });
        }
    }

    /// Places of the law, so many that the slope does not change by more than a factor of 2 between them.
    fn graded(&self) -> Vec<f64> {
        let mut rest: Vec<f64> = places(self.thresholds.as_ref()).into_iter().filter(|&x| x > 0.0).collect();
        rest.reverse();
        let mut graded: Vec<f64> = rest.pop().into_iter().collect();
        while let Some(&next) = rest.last() {
            let last = graded[graded.len() - 1];
            let middle = 0.5 * (last + next);
            let slopes = [last, middle, next.next_down()].map(|x| self.slope(x));
            let (least, most) =
                (slopes[0].min(slopes[1]).min(slopes[2]), slopes.into_iter().fold(0.0, f64::max));
            if most > 2.0 * least && next - last > 1e-9 * next {
                rest.push(middle);
            } else {
                graded.extend(rest.pop());
            }
        }
        graded
    }

    /// Sets out Gauss points and sums what is above nodes.
    fn sum_above(&mut self) {
        let cells = self.nodes.len() - 1;
        self.points = (0..cells).map(|cell| self.masses(cell, self.nodes[cell].stretch)).collect();
        let last = self.nodes[cells].stretch;
        let mut above = std::array::from_fn(|n| self.tail_moment(n as u32 + 1, last));
        self.nodes[cells].above = above;
        for cell in (0..cells).rev() {
            above = std::array::from_fn(|n| above[n] + moment(&self.points[cell], n as i32 + 1));
            self.nodes[cell].above = above;
        }
        self.mean = above[0];
        let square = |mass: &Mass| mass.weight * (mass.drive - self.mean).powi(2);
        let relaxed: f64 = self.atoms().iter().map(|atom| atom.weight * self.mean * self.mean).sum();
        self.std = (relaxed + self.points.iter().flatten().map(square).sum::<f64>()).sqrt();
    }

    /// The Gauss points of a cell from `stretch` to its end.
    fn masses(&self, cell: usize, stretch: f64) -> [Mass; NODES] {
        self.masses_between(cell, stretch, self.nodes[cell + 1].stretch)
    }

    fn masses_between(&self, cell: usize, low: f64, high: f64) -> [Mass; NODES] {
        let half = 0.5 * (high - low);
        std::array::from_fn(|i| {
            let stretch = low + half * (1.0 + RULE.nodes[i]);
            let weight = half * RULE.weights[i] * self.thresholds.density(stretch);
            Mass { stretch, drive: self.drive_in(cell, stretch), weight }
        })
    }

    /// ∫_{(x, ∞)} Xⁿ dP above the last node, where X = x − κx̄ to rounding.
    fn tail_moment(&self, order: u32, stretch: f64) -> f64 {
        let shift = -self.coupling * self.thresholds.mean();
        let mut binomial = 1.0;
        let mut sum = 0.0;
        for k in (0..=order).rev() {
            sum += binomial * shift.powi((order - k) as i32) * self.thresholds.upper_moment(k, stretch);
            binomial *= f64::from(k) / f64::from(order - k + 1);
        }
        sum.max(0.0)
    }

    /// ∫ Xⁿ dP above a node.
    fn above(&self, node: usize, order: u32) -> f64 {
        if let Some(&known) = self.nodes[node].above.get(order as usize - 1) {
            return known;
        }
        let cells = self.points[node..].iter().map(|points| moment(points, order as i32));
        cells.sum::<f64>() + self.tail_moment(order, self.nodes[self.nodes.len() - 1].stretch)
    }

    /// Σ g over Gauss points, in parts so small that e^{−sX} goes round no further than they follow.
    fn sum(&self, s: Complex64, g: impl Fn(&Mass) -> Complex64) -> Complex64 {
        let cells = self.nodes.windows(2).zip(&self.points).enumerate();
        let cell = |(cell, (ends, points)): (usize, (&[Node], &[Mass; NODES]))| {
            let (low, width) = (ends[0].stretch, ends[1].stretch - ends[0].stretch);
            let parts = (s.norm() * width / PHASE).ceil();
            if parts <= 1.0 {
                return points.iter().map(&g).sum::<Complex64>();
            }
            let at = |k: usize| low + width * (k as f64 / parts);
            (0..parts as usize)
                .flat_map(|k| self.masses_between(cell, at(k), at(k + 1)))
                .map(|mass| g(&mass))
                .sum()
        };
        cells.map(cell).sum()
    }

    /// Where the slope is low the density varies on the length on which the slope doubles.
    fn narrow(&self) -> Vec<Zone> {
        let slopes: Vec<f64> = self.nodes.iter().map(|node| self.slope(node.stretch)).collect();
        let around = |i: usize| {
            let low = slopes[..i].iter().rposition(|&slope| slope > 2.0 * slopes[i]).unwrap_or(0);
            let rest = slopes[i..].iter().position(|&slope| slope > 2.0 * slopes[i]);
            let (low, high) =
                (self.nodes[low].drive, rest.map_or_else(|| self.nodes.last(), |k| self.nodes.get(i + k)));
            let high = high.map_or(low, |node| node.drive);
            Zone { low, high, resolution: (high - low) / (CELLS * Zone::CELL) }
        };
        let mut zones: Vec<_> = (0..slopes.len()).filter(|&i| slopes[i] < EVEN).map(around).collect();
        zones.dedup();
        zones
    }
}

/// Σ Xⁿ over Gauss points.
fn moment(points: &[Mass; NODES], order: i32) -> f64 {
    let terms: Nodal = points.map(|mass| mass.weight * mass.drive.powi(order));
    terms.into_iter().sum()
}

impl std::fmt::Debug for Renormalised {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Renormalised by {} of {:?}", self.coupling, self.thresholds)
    }
}

impl Law for Renormalised {
    fn name(&self) -> &'static str {
        "renormalised"
    }

    fn parameters(&self) -> Vec<Parameter> {
        let inner = |p: Parameter| Parameter { name: format!("law.{}", p.name).into(), value: p.value };
        let coupling = Parameter::new("coupling", self.coupling);
        std::iter::once(coupling).chain(self.thresholds.parameters().into_iter().map(inner)).collect()
    }

    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        let Some(inner) = name.strip_prefix("law.") else {
            let coupling = if name == "coupling" { value } else { return Err(super::unknown(self, name)) };
            return shared(Self::new(self.thresholds.clone(), coupling));
        };
        let thresholds = self.thresholds.with_parameter(inner, value).map_err(|error| error.under("law"))?;
        shared(Self::new(thresholds, self.coupling))
    }

    fn density(&self, x: f64) -> f64 {
        let stretch = self.stretch(x);
        self.thresholds.density(stretch) / self.slope(stretch)
    }

    fn survival(&self, x: f64) -> f64 {
        self.thresholds.survival(self.stretch(x))
    }

    fn ln_survival(&self, x: f64) -> f64 {
        self.thresholds.ln_survival(self.stretch(x))
    }

    fn cumulative(&self, x: f64) -> f64 {
        self.thresholds.cumulative(self.stretch(x))
    }

    fn hazard(&self, x: f64) -> f64 {
        let stretch = self.stretch(x);
        self.thresholds.hazard(stretch) / self.slope(stretch)
    }

    fn quantile(&self, p: f64) -> f64 {
        self.drive(self.thresholds.quantile(p))
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        self.drive(self.thresholds.upper_quantile(q))
    }

    /// By quadrature over P_c, up to the next node for orders from 1 to 3.
    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        let stretch = self.stretch(x);
        let after = self.nodes.partition_point(|node| node.stretch <= stretch);
        match after.checked_sub(1) {
            _ if order == 0 => self.thresholds.survival(stretch),
            None => self.above(0, order),
            Some(cell) if after < self.nodes.len() => {
                moment(&self.masses(cell, stretch), order as i32) + self.above(after, order)
            }
            Some(_) => self.tail_moment(order, stretch),
        }
    }

    fn mean(&self) -> f64 {
        self.mean
    }

    fn std(&self) -> f64 {
        self.std
    }

    fn atoms(&self) -> Vec<Atom> {
        self.thresholds.atoms()
    }

    /// Leading terms: X − X_0 = (1 − κ x_0 p_0)(x − x_0) + …, and p/(1 − κxp) changes by that to the power −2 of a change
    /// of p; a jump from p to p', by itself.
    fn breaks(&self) -> Vec<Break> {
        let moved = |b: Break| {
            let (position, after) = (self.drive(b.position), self.thresholds.density(b.position));
            if b.position == 0.0 {
                return b;
            }
            if b.exponent == 0.0 {
                let renormalised = |p: f64| p / (1.0 - self.coupling * b.position * p);
                let amplitude = renormalised(after) - renormalised(after - b.amplitude);
                return Break { position, amplitude, ..b };
            }
            let amplitude = b.amplitude * self.slope(b.position).powf(-2.0 - b.exponent);
            Break { position, amplitude, ..b }
        };
        self.thresholds.breaks().into_iter().map(moved).collect()
    }

    /// Those of P_c as X, and where the slope of X(x) is low.
    fn zones(&self) -> Vec<Zone> {
        let moved = |zone: Zone| {
            let (low, high) = (self.drive(zone.low), self.drive(zone.high));
            Zone { low, high, resolution: EVEN * zone.resolution.min(high - low) }
        };
        let zones = self.thresholds.zones().into_iter().filter(|zone| zone.high > zone.low).map(moved);
        zones.chain(self.narrow()).collect()
    }

    fn seams(&self) -> Vec<f64> {
        self.thresholds.seams().into_iter().map(|x| self.drive(x)).collect()
    }

    fn laplace_is_closed(&self) -> bool {
        false
    }

    /// Far out X is x but for a constant.
    fn decay_rate(&self) -> f64 {
        self.thresholds.decay_rate()
    }

    fn known_rate(&self) -> f64 {
        self.thresholds.known_rate()
    }

    /// ∫ e^{−sX(x)} dP by quadrature; for Re s < 0 what it differs by from that of x − κx̄, which is known: the tails are
    /// the same.
    fn laplace(&self, s: Complex64) -> Complex64 {
        if s.re >= 0.0 {
            let relaxed: f64 = self.atoms().iter().map(|atom| atom.weight).sum();
            return relaxed + self.sum(s, |mass| mass.weight * (-s * mass.drive).exp());
        }
        let shift = self.coupling * self.thresholds.mean();
        let relaxed: Complex64 =
            self.atoms().iter().map(|atom| atom.weight * (1.0 - (s * shift).exp())).sum();
        let gain = |mass: &Mass| (-s * mass.drive).exp() - (-s * (mass.stretch - shift)).exp();
        relaxed
            + (s * shift).exp() * self.thresholds.laplace(s)
            + self.sum(s, |mass| mass.weight * gain(mass))
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        self.thresholds.fill(stream, out);
        out.iter_mut().for_each(|x| *x = self.drive(*x));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::{Exponential, Gaussian, Mixture, Point, Rectangular};
    use super::*;

    fn gaussian(std: f64) -> SharedLaw {
        Arc::new(Gaussian::new(1.0, std).unwrap())
    }

    #[test]
    fn critical_couplings_that_have_closed_forms() {
        let close = |law: SharedLaw, expected: f64| {
            let found = critical_coupling(law.as_ref());
            assert!((found / expected - 1.0).abs() < 1e-14, "{law:?} {found} {expected}");
        };
        // max x p: at the upper end 1.2/0.4; at x̄, 1/e; of a Gaussian with all its mass at σ(α + √(α² + 4))/2, α = μ/σ.
        close(Arc::new(Rectangular::new(0.8, 1.2).unwrap()), 1.0 / 3.0);
        close(Arc::new(Exponential::new(0.7).unwrap()), std::f64::consts::E);
        let z = 0.5 * ((100.0_f64 + 4.0).sqrt() - 10.0);
        close(gaussian(0.1), std::f64::consts::TAU.sqrt() * 0.1 * (0.5 * z * z).exp() / (1.0 + 0.1 * z));
    }

    #[test]
    fn printed_values() {
        assert!((critical_coupling(gaussian(0.1).as_ref()) - 0.2494).abs() < 5e-5);
        for (coupling, std) in [(0.1, 0.0721), (0.2, 0.0453)] {
            let law = Renormalised::new(gaussian(0.1), coupling).unwrap();
            assert!((law.std() - std).abs() < 5e-5);
        }
    }

    #[test]
    fn of_a_uniform_law_everything_is_closed() {
        // On [a, b], w = b − a: X = x − κ(x² − a²)/2w, x = [w − √(w² − 2κw(X − κa²/2w))]/κ.
        let (a, b, coupling) = (0.5, 1.5, 0.6);
        let law = Renormalised::new(Arc::new(Rectangular::new(a, b).unwrap()), coupling).unwrap();
        let stretch =
            |drive: f64| (1.0 - (1.0 - 2.0 * coupling * (drive - 0.5 * coupling * a * a)).sqrt()) / coupling;
        let drive = |x: f64| x - 0.5 * coupling * (x * x - a * a);
        for x in [0.5, 0.7, 1.1, 1.499] {
            let at = drive(x);
            // Roundings of X, over the slope of X(x); of the slope.
            let slope = 1.0 - coupling * x;
            assert!(
                (law.stretch(at) - stretch(at)).abs() * slope < 1e-15 && (law.drive(x) - at).abs() < 1e-15
            );
            assert!((law.density(at) * slope - 1.0).abs() * slope * slope < 2e-15, "{x}");
        }
        // x̄ − κ[(b³ − a³)/6 − a²w/2]/w.
        let mean = 1.0 - coupling * ((b.powi(3) - a.powi(3)) / 6.0 - 0.5 * a * a);
        assert!((law.mean() - mean).abs() < 1e-15);
        assert_eq!((law.quantile(0.0), law.survival(drive(b).next_up())), (0.5, 0.0));
    }

    #[test]
    fn without_coupling_nothing_changes() {
        let law = Renormalised::new(gaussian(0.2), 0.0).unwrap();
        let same = gaussian(0.2);
        assert!((law.mean() - same.mean()).abs() < 1e-15 && (law.std() - same.std()).abs() < 1e-15);
        assert_eq!(law.density(0.9), same.density(0.9));
    }

    #[test]
    fn contacts_that_break_together_are_refused_by_name() {
        let refused =
            |law: SharedLaw, coupling: f64| Renormalised::new(law, coupling).unwrap_err().to_string();
        let point = || Arc::new(Point::new(1.0).unwrap()) as SharedLaw;
        assert!(refused(point(), 0.0).contains("one at 1"));
        let mixed = Mixture::new(vec![(0.5, point()), (0.5, gaussian(0.1))]).unwrap();
        assert!(refused(Arc::new(mixed), 0.1).starts_with("law"));
        assert!(refused(gaussian(0.1), 0.25).contains("0.2494"));
        for coupling in [-0.1, f64::NAN, f64::INFINITY] {
            assert!(refused(gaussian(0.1), coupling).starts_with("coupling"));
        }
    }
}
