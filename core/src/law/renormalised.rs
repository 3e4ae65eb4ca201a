//! The mean-field renormalised distribution of thresholds: contacts coupled so that each break stretches all
//! others.

use num_complex::Complex64;

use super::critical_coupling::critical_coupling;
use super::drive_map::DriveMap;
use super::{Atom, Breakpoint, Law, Parameter, SharedLaw, Zone, not_negative, shared, unknown};
use crate::numerics::legendre::{NODES, RULE};
use crate::random::Stream;
use crate::{Error, Result};

/// Where the slope of X(x) is above this, thresholds vary over X on much the same scale as over x.
const EVEN: f64 = 0.75;

/// Number of 16-term cells over a neighbourhood at whose ends the slope of X(x) has doubled.
const CELLS: f64 = 12.0;

/// Change of the exponent of e^{−sX} over which 16 Gauss points integrate it to rounding.
const PHASE: f64 = 8.0;

/// The distribution of the drive at which contacts break, where each break stretches all contacts: by κξ/N if
/// one of N contacts breaks at the stretch ξ. Thresholds have the distribution P_c, and all contacts are
/// relaxed at first.
///
/// When all unbroken contacts have the stretch x, the drive has stretched them by X(x) = x − κ ∫_0^x ξ P_c(ξ)
/// dξ. They break as uncoupled contacts would with the distribution P_eff(X) = P_c(x)/[1 − κ x P_c(x)],
/// S_eff(X) = S(x), which has a lower mean and is narrower. At κ_c = 1/max(x P_c) ([`critical_coupling`]) a
/// finite fraction of all contacts breaks at once.
///
/// This holds until contacts break a second time. For a block of stiffness K pulled at its top, κ = N⟨k⟩/(K +
/// N⟨k⟩) and the drive is (1 − κ) X_T; then κ < κ_c is equivalent to K > K_c.
///
/// `coupling` is κ; the distribution of thresholds keeps its parameters, as `law.mean`, …. S, ln S and the
/// hazard rate have the accuracy of those of P_c over 1 − κ/κ_c, moments that of rounding.
#[derive(Clone)]
pub struct Renormalised {
    map: DriveMap,
    /// The Gauss points of each cell.
    points: Vec<[MassPoint; NODES]>,
    /// Moments of order 1 to 3 of the mass above each node.
    above: Vec<[f64; 3]>,
    std: f64,
}

/// A Gauss point: stretch, drive, and the mass it represents.
#[derive(Debug, Clone, Copy)]
struct MassPoint {
    stretch: f64,
    drive: f64,
    weight: f64,
}

impl Renormalised {
    /// The renormalised distribution of `thresholds` for a `coupling` κ.
    ///
    /// # Errors
    /// A coupling below 0 or not finite, or one of κ_c or above; identical thresholds, i.e. point masses
    /// above 0.
    pub fn new(thresholds: SharedLaw, coupling: f64) -> Result<Self> {
        not_negative("coupling", coupling)?;
        if let Some(atom) = thresholds.atoms().into_iter().find(|atom| atom.position > 0.0) {
            let expected = "a distribution without point masses above 0: identical thresholds break together, whatever the coupling";
            return Err(Error::invalid("law", expected, format!("one at {}", atom.position)));
        }
        if thresholds.mean() == 0.0 {
            return Err(Error::invalid("law", "thresholds above 0", "all at 0"));
        }
        let critical = critical_coupling(thresholds.as_ref());
        if coupling >= critical {
            let expected =
                format!("a number from 0 to below {critical}, where contacts break in one avalanche");
            return Err(Error::invalid("coupling", expected, coupling));
        }
        let map = DriveMap::new(coupling, thresholds);
        let mut law = Self { map, points: Vec::new(), above: Vec::new(), std: 0.0 };
        law.sum_above();
        law.std = law.variance().sqrt();
        Ok(law)
    }

    /// X(x): the drive at which unbroken contacts have the stretch x.
    pub fn drive(&self, stretch: f64) -> f64 {
        self.map.drive(stretch)
    }

    /// x(X): the stretch of the unbroken contacts at the drive X.
    pub fn stretch(&self, drive: f64) -> f64 {
        self.map.stretch(drive)
    }

    fn thresholds(&self) -> &dyn Law {
        self.map.thresholds.as_ref()
    }

    /// κx̄, the stretch that all breaks together add.
    fn shift(&self) -> f64 {
        self.map.coupling * self.thresholds().mean()
    }

    /// Computes the Gauss points, and sums the moments above each node.
    fn sum_above(&mut self) {
        let nodes = self.map.nodes();
        let cell = |cell: usize| self.masses(cell, nodes[cell].stretch, nodes[cell + 1].stretch);
        self.points = (0..nodes.len() - 1).map(cell).collect();
        let mut sum = std::array::from_fn(|n| self.last_moment(n as u32 + 1));
        self.above = vec![sum];
        for points in self.points.iter().rev() {
            sum = std::array::from_fn(|n| sum[n] + moment(points, n as i32 + 1));
            self.above.push(sum);
        }
        self.above.reverse();
    }

    fn variance(&self) -> f64 {
        let mean = self.mean();
        let square = |mass: &MassPoint| mass.weight * (mass.drive - mean).powi(2);
        self.relaxed() * mean * mean + self.points.iter().flatten().map(square).sum::<f64>()
    }

    /// The fraction of contacts whose threshold is 0.
    fn relaxed(&self) -> f64 {
        self.atoms().iter().map(|atom| atom.weight).sum()
    }

    /// Gauss points between two stretches within a cell.
    fn masses(&self, cell: usize, low: f64, high: f64) -> [MassPoint; NODES] {
        let half = 0.5 * (high - low);
        std::array::from_fn(|i| {
            let stretch = low + half * (1.0 + RULE.nodes[i]);
            let weight = half * RULE.weights[i] * self.thresholds().density(stretch);
            MassPoint { stretch, drive: self.map.drive_in(cell, stretch), weight }
        })
    }

    /// ∫_{(x, ∞)} Xⁿ dP for x above the last node, where X = x − κx̄ to rounding.
    fn tail_moment(&self, order: u32, stretch: f64) -> f64 {
        let (mut binomial, mut sum) = (1.0, 0.0);
        for k in (0..=order).rev() {
            let shifted = (-self.shift()).powi((order - k) as i32);
            // (x − κx̄)ⁿ by the binomial theorem, from moments of the thresholds.
            sum += binomial * shifted * self.thresholds().upper_moment(k, stretch);
            binomial *= f64::from(k) / f64::from(order - k + 1);
        }
        sum.max(0.0)
    }

    fn last_moment(&self, order: u32) -> f64 {
        self.map.nodes().last().map_or(0.0, |last| self.tail_moment(order, last.stretch))
    }

    /// ∫ Xⁿ dP above a node.
    fn moment_above(&self, node: usize, order: u32) -> f64 {
        if let Some(&known) = self.above[node].get(order as usize - 1) {
            return known;
        }
        let cells = self.points[node..].iter().map(|points| moment(points, order as i32));
        cells.sum::<f64>() + self.last_moment(order)
    }

    /// Σ g over Gauss points, in panels so small that they resolve e^{−sX}.
    fn sum(&self, s: Complex64, g: impl Fn(&MassPoint) -> Complex64) -> Complex64 {
        let cell = |cell: usize| {
            let nodes = self.map.nodes();
            let (low, width) = (nodes[cell].stretch, nodes[cell + 1].stretch - nodes[cell].stretch);
            let parts = (s.norm() * width / PHASE).ceil();
            if parts <= 1.0 {
                return self.points[cell].iter().map(&g).sum::<Complex64>();
            }
            let at = |k: usize| low + width * (k as f64 / parts);
            // The integral over drives is taken over stretches, dP = P_c dx: the map X(x) is smooth
            // where its inverse is steep.
            let finer = (0..parts as usize).flat_map(|k| self.masses(cell, at(k), at(k + 1)));
            finer.map(|mass| g(&mass)).sum()
        };
        (0..self.points.len()).map(cell).sum()
    }

    /// Zones around minima of the slope dX/dx: the density varies there on the length on which the slope
    /// doubles.
    fn zones_of_low_slope(&self) -> Vec<Zone> {
        let nodes = self.map.nodes();
        let slopes: Vec<f64> = nodes.iter().map(|node| self.map.slope(node.stretch)).collect();
        let around = |i: usize| {
            let doubled = |slope: &f64| *slope > 2.0 * slopes[i];
            let low = slopes[..i].iter().rposition(doubled).unwrap_or(0);
            let high = slopes[i..].iter().position(doubled).map_or(nodes.len() - 1, |k| i + k);
            let (low, high) = (nodes[low].drive, nodes[high].drive);
            Zone { low, high, resolution: (high - low) / (CELLS * Zone::CELL) }
        };
        let mut zones: Vec<_> = (0..slopes.len()).filter(|&i| slopes[i] < EVEN).map(around).collect();
        zones.dedup();
        zones
    }
}

/// Σ Xⁿ over Gauss points.
fn moment(points: &[MassPoint; NODES], order: i32) -> f64 {
    points.iter().map(|mass| mass.weight * mass.drive.powi(order)).sum()
}

impl std::fmt::Debug for Renormalised {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Renormalised by {} of {:?}", self.map.coupling, self.thresholds())
    }
}

impl Law for Renormalised {
    fn name(&self) -> &'static str {
        "renormalised"
    }

    fn parameters(&self) -> Vec<Parameter> {
        let inner = |p: Parameter| Parameter { name: format!("law.{}", p.name).into(), value: p.value };
        let coupling = Parameter::new("coupling", self.map.coupling);
        std::iter::once(coupling).chain(self.thresholds().parameters().into_iter().map(inner)).collect()
    }

    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        let DriveMap { coupling, thresholds, .. } = &self.map;
        if name == "coupling" {
            return shared(Self::new(thresholds.clone(), value));
        }
        let inner = name.strip_prefix("law.").ok_or_else(|| unknown(self, name))?;
        let thresholds = thresholds.with_parameter(inner, value).map_err(|error| error.under("law"))?;
        shared(Self::new(thresholds, *coupling))
    }

    fn density(&self, x: f64) -> f64 {
        let stretch = self.stretch(x);
        self.thresholds().density(stretch) / self.map.slope(stretch)
    }

    fn ln_density(&self, x: f64) -> f64 {
        let stretch = self.stretch(x);
        self.thresholds().ln_density(stretch) - self.map.slope(stretch).ln()
    }

    fn survival(&self, x: f64) -> f64 {
        self.thresholds().survival(self.stretch(x))
    }

    fn ln_survival(&self, x: f64) -> f64 {
        self.thresholds().ln_survival(self.stretch(x))
    }

    fn cumulative(&self, x: f64) -> f64 {
        self.thresholds().cumulative(self.stretch(x))
    }

    fn ln_cumulative(&self, x: f64) -> f64 {
        self.thresholds().ln_cumulative(self.stretch(x))
    }

    fn hazard(&self, x: f64) -> f64 {
        let stretch = self.stretch(x);
        self.thresholds().hazard(stretch) / self.map.slope(stretch)
    }

    fn quantile(&self, p: f64) -> f64 {
        self.drive(self.thresholds().quantile(p))
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        self.drive(self.thresholds().upper_quantile(q))
    }

    /// By quadrature over P_c, up to the next node for orders from 1 to 3.
    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        let (stretch, nodes) = (self.stretch(x), self.map.nodes());
        let after = nodes.partition_point(|node| node.stretch <= stretch);
        match after.checked_sub(1) {
            _ if order == 0 => self.thresholds().survival(stretch),
            None => self.moment_above(0, order),
            Some(cell) if after < nodes.len() => {
                let begun = self.masses(cell, stretch, nodes[after].stretch);
                moment(&begun, order as i32) + self.moment_above(after, order)
            }
            Some(_) => self.tail_moment(order, stretch),
        }
    }

    fn mean(&self) -> f64 {
        self.above[0][0]
    }

    fn std(&self) -> f64 {
        self.std
    }

    fn atoms(&self) -> Vec<Atom> {
        self.thresholds().atoms()
    }

    /// Leading terms: X − X_0 = (1 − κ x_0 p_0)(x − x_0) + …, and p/(1 − κxp) changes by the change of p
    /// times that factor to the power −2; a jump from p to p' is transformed exactly.
    fn breakpoints(&self) -> Vec<Breakpoint> {
        let moved = |b: Breakpoint| {
            let (position, after) = (self.drive(b.position), self.thresholds().density(b.position));
            if b.position == 0.0 {
                return b;
            }
            if b.exponent == 0.0 {
                let renormalised = |p: f64| p / (1.0 - self.map.coupling * b.position * p);
                let amplitude = renormalised(after) - renormalised(after - b.amplitude);
                return Breakpoint { position, amplitude, ..b };
            }
            let amplitude = b.amplitude * self.map.slope(b.position).powf(-2.0 - b.exponent);
            Breakpoint { position, amplitude, ..b }
        };
        self.thresholds().breakpoints().into_iter().map(moved).collect()
    }

    /// Those of P_c as X, and the neighbourhoods of low slope dX/dx.
    fn zones(&self) -> Vec<Zone> {
        let moved = |zone: Zone| {
            let (low, high) = (self.drive(zone.low), self.drive(zone.high));
            Zone { low, high, resolution: EVEN * zone.resolution.min(high - low) }
        };
        let zones = self.thresholds().zones().into_iter().filter(|zone| zone.high > zone.low).map(moved);
        zones.chain(self.zones_of_low_slope()).collect()
    }

    fn seams(&self) -> Vec<f64> {
        self.thresholds().seams().into_iter().map(|x| self.drive(x)).collect()
    }

    fn laplace_is_closed(&self) -> bool {
        false
    }

    /// Far out X differs from x by a constant.
    fn decay_rate(&self) -> f64 {
        self.thresholds().decay_rate()
    }

    fn known_rate(&self) -> f64 {
        self.thresholds().known_rate()
    }

    /// ∫ e^{−sX(x)} dP by quadrature. For Re s < 0 only the difference from the known integral of e^{−s(x −
    /// κx̄)} is integrated, since the tails are the same.
    fn laplace(&self, s: Complex64) -> Complex64 {
        // For Re s < 0 the integrand grows into the tail, where it is only known analytically.
        if s.re >= 0.0 {
            return self.relaxed() + self.sum(s, |mass| mass.weight * (-s * mass.drive).exp());
        }
        let shift = self.shift();
        let gain = |mass: &MassPoint| (-s * mass.drive).exp() - (-s * (mass.stretch - shift)).exp();
        let relaxed = self.relaxed() * (1.0 - (s * shift).exp());
        let shifted = (s * shift).exp() * self.thresholds().laplace(s);
        relaxed + shifted + self.sum(s, |mass| mass.weight * gain(mass))
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        self.thresholds().fill(stream, out);
        out.iter_mut().for_each(|x| *x = self.drive(*x));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::{Gamma, Gaussian, Mixture, Point, Rectangular, Series};
    use super::*;

    fn gaussian(std: f64) -> SharedLaw {
        Arc::new(Gaussian::new(1.0, std).unwrap())
    }

    #[test]
    fn printed_values() {
        // Half a unit of the four digits printed.
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

    /// To the left of 0, too, where quadrature of the density by another route converges.
    #[test]
    fn transforms_are_those_of_the_density() {
        let laws = [(gaussian(0.1), 0.2), (Arc::new(Gamma::new(1.0, 0.2).unwrap()), 0.3)];
        for (thresholds, coupling) in laws {
            let law = Renormalised::new(thresholds, coupling).unwrap();
            let boundaries = [0.0, law.quantile(0.5), law.upper_quantile(1e-3), f64::INFINITY];
            let density = |x: &[f64]| Ok(x.iter().map(|&x| law.density(x)).collect());
            let series = Series::resolve(density, &boundaries, 1e-14).unwrap().0;
            for (re, im) in [(5.0, 40.0), (0.0, 6.0), (-0.3, 6.0), (-2.0, 14.0), (-4.0, 60.0)] {
                let s = Complex64::new(re, im);
                // What the series leaves out, lifted by e^{4x}.
                assert!((law.laplace(s) - series.laplace(s)).norm() < 1e-12, "{law:?} {s}");
            }
        }
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
