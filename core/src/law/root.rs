//! The distribution of c√A: thresholds of contacts that are given by their areas.

use num_complex::Complex64;

use super::panels::panel_boundaries;
use super::quadrature::double_exponential;
use super::range::length;
use super::{ALL, Atom, Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, Zone, shared};
use crate::numerics::legendre::RULE;
use crate::numerics::order::sort_by_number;
use crate::random::Stream;
use crate::{Error, Result};

/// The distribution of c√A for a given distribution of A.
///
/// A contact of area A, stiffness ρc²√A and strength σ_s A breaks at the stretch σ_s √A/(ρc²), so that c =
/// σ_s/(ρc²). p(x) = (2x/c²) p_A(x²/c²), S(x) = S_A(x²/c²). Its parameters are `factor` = c and those of the
/// distribution of A.
#[derive(Debug, Clone)]
pub struct Root {
    factor: f64,
    areas: SharedLaw,
    /// Breakpoints and point masses of A, as x = c√A and as A.
    breakpoints: Vec<(f64, f64)>,
    /// Panel boundaries for Gauss quadrature, from x = 0 up.
    nodes: Vec<RootNode>,
    /// The lower end of the support.
    lowest: f64,
    std: f64,
}

/// The moments of order 1 and 3 of the mass at x and above, which the distribution of A does not give.
#[derive(Debug, Clone, Copy)]
struct RootNode {
    x: f64,
    first: f64,
    third: f64,
}

impl Root {
    /// The distribution of `factor`·√A.
    ///
    /// # Errors
    /// A factor that is not finite and above 0.
    pub fn new(factor: f64, areas: SharedLaw) -> Result<Self> {
        length("factor", factor)?;
        let positions = areas.breakpoints().into_iter().map(|b| b.position);
        let positions = positions.chain(areas.atoms().into_iter().map(|atom| atom.position));
        let mut breakpoints: Vec<_> = positions.map(|area| (factor * area.sqrt(), area)).collect();
        sort_by_number(&mut breakpoints, |item| item.0);
        breakpoints.dedup();
        let lowest = factor * areas.quantile(0.0).sqrt();
        let mut law = Self { factor, areas, breakpoints, nodes: Vec::new(), lowest, std: 0.0 };
        law.nodes = law.sum_nodes();
        let mean = law.mean();
        law.std = law.integrate(-1.0, |x| Complex64::from((x - mean).powi(2))).re.sqrt();
        Ok(law)
    }

    /// Moments at the panel boundaries, summed from above.
    fn sum_nodes(&self) -> Vec<RootNode> {
        let mut panels = panel_boundaries(self);
        panels.insert(0, 0.0);
        panels.dedup();
        let atoms = self.atoms();
        let atom = |x: f64| match atoms.binary_search_by(|atom| atom.position.total_cmp(&x)) {
            Ok(i) => atoms[i].weight,
            Err(_) => 0.0,
        };
        let last = panels[panels.len() - 1];
        let beyond = |order: i32| self.integrate(last, |x| Complex64::from(x.powi(order))).re;
        let (mut first, mut third, mut next) = (beyond(1), beyond(3), last);
        let mut nodes = Vec::with_capacity(panels.len());
        for &x in panels.iter().rev() {
            first += self.panel(x, next, 1) + atom(x) * x;
            third += self.panel(x, next, 3) + atom(x) * x.powi(3);
            nodes.push(RootNode { x, first, third });
            next = x;
        }
        nodes.reverse();
        nodes
    }

    /// ∫_x^to ξⁿ p dξ between neighbouring nodes.
    fn panel(&self, x: f64, to: f64, order: i32) -> f64 {
        // Far from 0 the density is smooth on the panel, and the Gauss rule is enough. A panel that
        // begins near 0 may begin with a power of x, which double-exponential quadrature integrates
        // (H. Takahasi and M. Mori, Publ. RIMS 9, 721 (1974)).
        if to <= 2.0 * x {
            return RULE.integrate(x, to, |x| x.powi(order) * self.density(x));
        }
        double_exponential(x, to, |x| Complex64::from(x.powi(order) * self.density(x))).re
    }

    /// A at x ≥ 0, on the same side of every breakpoint as x, whatever the rounding.
    fn area(&self, x: f64) -> f64 {
        let i = self.breakpoints.partition_point(|breakpoint| breakpoint.0 <= x);
        let low = if i > 0 { self.breakpoints[i - 1].1 } else { 0.0 };
        let high = self.breakpoints.get(i).map_or(f64::MAX, |breakpoint| breakpoint.1.next_down().max(low));
        (x / self.factor).powi(2).clamp(low, high)
    }

    /// dA/dx.
    fn slope(&self, x: f64) -> f64 {
        2.0 * x / (self.factor * self.factor)
    }

    /// Converts a quantity per unit A at x to one per unit x; at 0 its limit, since the density of A may be
    /// infinite there.
    fn per_stretch(&self, x: f64, value: impl Fn(f64) -> f64) -> f64 {
        if x < 0.0 {
            return 0.0;
        }
        let x = x.max(1e-150 * self.factor);
        let value = value(self.area(x));
        // Far out, 0 would be multiplied by a slope that overflows.
        if value == 0.0 { 0.0 } else { self.slope(x) * value }
    }

    /// A function of A at x; at −1 for x < 0.
    fn at_area(&self, x: f64, value: impl Fn(f64) -> f64) -> f64 {
        value(if x < 0.0 { -1.0 } else { self.area(x) })
    }

    /// ∫_{(x, ∞)} g dP: point masses, and the density between breakpoints and quantiles.
    fn integrate(&self, x: f64, g: impl Fn(f64) -> Complex64) -> Complex64 {
        // S cannot be evaluated where it underflows.
        let negligible = (1e-20 * self.survival(x)).max(f64::MIN_POSITIVE);
        self.integrate_to(x, self.upper_quantile(negligible), g)
    }

    /// ∫_{(x, `top`]} g dP.
    fn integrate_to(&self, x: f64, top: f64, g: impl Fn(f64) -> Complex64) -> Complex64 {
        let atoms = self.atoms().into_iter().filter(|atom| atom.position > x);
        let atoms: Complex64 = atoms.map(|atom| atom.weight * g(atom.position)).sum();
        let from = x.max(0.0);
        // Quantiles divide the range where most of the mass is, and where the tail falls by orders
        // of magnitude.
        let shares = [0.999, 0.9, 0.5, 0.1, 1e-3, 1e-8, 1e-20];
        let mut ends: Vec<f64> = shares.iter().map(|q| self.upper_quantile(q * self.survival(x))).collect();
        ends.extend(self.breakpoints.iter().map(|breakpoint| breakpoint.0));
        ends.extend([from, top]);
        ends.retain(|end| (from..=top).contains(end));
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let density = ends.windows(2).map(|w| double_exponential(w[0], w[1], |x| self.density(x) * g(x)));
        atoms + density.sum::<Complex64>()
    }

    /// The x beyond which e^{rate·x} p(x) is negligible; `None` if there is none up to far out.
    fn top(&self, rate: f64) -> Option<f64> {
        let mut x = self.upper_quantile(1e-20);
        for _ in 0..200 {
            if self.ln_survival(x) + rate * x < -46.0 {
                return Some(x);
            }
            x *= 1.1;
        }
        None
    }
}

impl Law for Root {
    fn name(&self) -> &'static str {
        "root"
    }

    fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = vec![Parameter::new("factor", self.factor)];
        parameters.extend(self.areas.parameters());
        parameters
    }

    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        match name {
            "factor" => shared(Self::new(value, self.areas.clone())),
            _ => shared(Self::new(self.factor, self.areas.with_parameter(name, value)?)),
        }
    }

    /// x p(x)/c for the factor; ∂S_A/∂θ at A = x²/c² for the parameters of A.
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        let law = self.clone();
        if name != "factor" {
            let by_areas = self.areas.survival_derivative(name)?;
            return Ok(Box::new(move |x| law.at_area(x, &by_areas)));
        }
        if let Some(atom) = self.atoms().first() {
            let expected = "areas without point masses, since the position of one has no derivative";
            return Err(Error::invalid(name, expected, format!("one at {}", atom.position)));
        }
        Ok(Box::new(move |x| x * law.density(x) / law.factor))
    }

    fn density(&self, x: f64) -> f64 {
        self.per_stretch(x, |area| self.areas.density(area))
    }

    fn ln_density(&self, x: f64) -> f64 {
        if x <= 0.0 || x == f64::INFINITY {
            return self.density(x).ln();
        }
        self.areas.ln_density(self.area(x)) + self.slope(x).ln()
    }

    fn survival(&self, x: f64) -> f64 {
        self.at_area(x, |area| self.areas.survival(area))
    }

    fn ln_survival(&self, x: f64) -> f64 {
        self.at_area(x, |area| self.areas.ln_survival(area))
    }

    fn ln_cumulative(&self, x: f64) -> f64 {
        self.at_area(x, |area| self.areas.ln_cumulative(area))
    }

    fn hazard(&self, x: f64) -> f64 {
        self.per_stretch(x, |area| self.areas.hazard(area))
    }

    fn quantile(&self, p: f64) -> f64 {
        self.factor * self.areas.quantile(p).sqrt()
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        self.factor * self.areas.upper_quantile(q).sqrt()
    }

    /// cⁿ times the moment n/2 of A above x²/c². For odd n by quadrature, up to the next node for 1 and 3.
    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        if order.is_multiple_of(2) {
            return self.factor.powi(order as i32)
                * self.at_area(x, |area| self.areas.upper_moment(order / 2, area));
        }
        let x = x.max(0.0);
        // Below the support there is nothing to integrate, and its end, which need not be a breakpoint, is a jump at rounding.
        let after = if x < self.lowest { 0 } else { self.nodes.partition_point(|node| node.x <= x) };
        if let (1 | 3, 0, Some(whole)) = (order, after, self.nodes.first()) {
            return if order == 1 { whole.first } else { whole.third };
        }
        if let (1 | 3, Some(next)) = (order, self.nodes.get(after)) {
            let above = if order == 1 { next.first } else { next.third };
            let n = order as i32;
            return self.panel(x, next.x, n) + above;
        }
        if self.survival(x) == 0.0 {
            return 0.0;
        }
        self.integrate(x, |x| Complex64::from(x.powi(order as i32))).re
    }

    fn std(&self) -> f64 {
        self.std
    }

    fn atoms(&self) -> Vec<Atom> {
        let moved = |atom: Atom| Atom { position: self.factor * atom.position.sqrt(), ..atom };
        self.areas.atoms().into_iter().map(moved).collect()
    }

    /// Leading terms: near a breakpoint x₀ > 0, A − A₀ = (2x₀/c²)(x − x₀) + …; near 0, A = x²/c².
    fn breakpoints(&self) -> Vec<Breakpoint> {
        let moved = |b: Breakpoint| {
            let position = self.factor * b.position.sqrt();
            if position > 0.0 {
                let amplitude = b.amplitude * self.slope(position).powf(b.exponent + 1.0);
                return Breakpoint { position, amplitude, ..b };
            }
            let exponent = 2.0 * b.exponent + 1.0;
            let ratio = libm::tgamma(exponent + 1.0) / libm::tgamma(b.exponent + 1.0);
            Breakpoint {
                position,
                exponent,
                amplitude: 2.0 * b.amplitude * ratio / self.factor.powf(exponent + 1.0),
            }
        };
        self.areas.breakpoints().into_iter().map(moved).collect()
    }

    /// Those of A, with δx = c δA/(2√A) in their middle.
    fn zones(&self) -> Vec<Zone> {
        let root = |zone: Zone| Zone {
            low: self.factor * zone.low.sqrt(),
            high: self.factor * zone.high.sqrt(),
            resolution: 0.5 * self.factor * zone.resolution / (0.5 * (zone.low + zone.high)).sqrt(),
        };
        self.areas.zones().into_iter().map(root).collect()
    }

    fn seams(&self) -> Vec<f64> {
        self.areas.seams().into_iter().map(|area| self.factor * area.sqrt()).collect()
    }

    fn laplace_is_closed(&self) -> bool {
        false
    }

    /// From S(x) = S_A(x²/c²): an exponential tail of the area gives a Gaussian tail of its root. An area
    /// whose tail is heavier than exponential (λ = 0) is taken to give a heavy tail, too.
    fn decay_rate(&self) -> f64 {
        if self.areas.decay_rate() > 0.0 { f64::INFINITY } else { 0.0 }
    }

    /// If the tail of A is cut at A₀, e^{λx} stays below the e^{λ_A A} up to which it is known if λ = λ_A
    /// A₀/x₀.
    fn known_rate(&self) -> f64 {
        let (rate, top) = (self.areas.known_rate(), self.areas.upper_quantile(0.0));
        if rate == f64::INFINITY {
            return rate;
        }
        let cut = if top.is_finite() { top } else { self.areas.upper_quantile(ALL) };
        rate * cut.sqrt() / self.factor
    }

    /// ∫ e^{−sx} dP by quadrature where the integral converges. NaN for Re s < 0 and an infinite tail that is
    /// too heavy. A tail that dominates only far out (that of a lognormal) is cut there, which is its
    /// continuation.
    fn laplace(&self, s: Complex64) -> Complex64 {
        match self.top((-s.re).max(0.0)) {
            Some(top) => self.integrate_to(-1.0, top, |x| (-s * x).exp()),
            None => Complex64::from(f64::NAN),
        }
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        self.areas.fill(stream, out);
        out.iter_mut().for_each(|x| *x = self.factor * x.sqrt());
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::{Exponential, Gamma, Gaussian, Lognormal, Point, Weibull};
    use super::*;

    #[test]
    fn moments_are_numbers_as_far_as_there_are_any() {
        let law = Root::new(1.0, Arc::new(Gaussian::new(1.0, 0.2).unwrap())).unwrap();
        for x in (0..400).map(|k| 0.01 * f64::from(k)) {
            let (left, first) = (law.survival(x), law.upper_moment(1, x));
            assert!(first.is_finite() && first >= 0.0, "{x}: {first}");
            // The mean of those above x, of a tail that is much narrower than that, but for what 1e-300 loses of its digits.
            assert!(left < 1e-280 || first > x * left && first < (x + 1.0) * left, "{x}: {first:e} {left:e}");
        }
    }

    #[test]
    fn exponential_areas_make_a_weibull_law() {
        let law = Root::new(3.0, Arc::new(Exponential::new(1.0).unwrap())).unwrap();
        let twin = Weibull::new(2.0, 3.0).unwrap();
        // Some roundings on either side.
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-13, "{a} {b}");
        close(law.std(), twin.std());
        let by = |name: &str| law.survival_derivative(name).unwrap();
        let by_scale = twin.survival_derivative("scale").unwrap();
        for x in [0.01, 1.0, 3.0, 20.0] {
            close(by("factor")(x), by_scale(x));
            close(by("mean")(x), 1.5 * by_scale(x));
            close(law.density(x), twin.density(x));
            close(law.hazard(x), twin.hazard(x));
            (1..4).for_each(|n| close(law.upper_moment(n, x), twin.upper_moment(n, x)));
        }
        for s in [Complex64::new(1.0, 2.0), Complex64::new(-0.5, 3.0)] {
            close(law.laplace(s).re, twin.laplace(s).re);
        }
        let (ours, theirs) = (law.breakpoints()[0], twin.breakpoints()[0]);
        close(ours.amplitude, theirs.amplitude);
        assert_eq!(ours.exponent, theirs.exponent);
    }

    #[test]
    fn lognormal_areas_make_a_lognormal_law_and_its_continuation() {
        let law = Root::new(1.0, Arc::new(Lognormal::new(1.0, 0.2).unwrap())).unwrap();
        let twin = Lognormal::new(law.mean(), law.std()).unwrap();
        for s in [Complex64::new(0.5, 3.0), Complex64::new(-0.2, 6.25)] {
            // The tail that the real integral leaves out weighs 1e-20; some roundings.
            assert!((law.laplace(s) - twin.laplace(s)).norm() < 1e-13);
        }
        assert!(law.laplace(Complex64::new(-50.0, 1.0)).is_nan());
    }

    #[test]
    fn a_singular_law_of_areas_has_its_limit_at_0() {
        // Shape ½: p_A ~ A^{−½}/√(2π), so p(0) = √(2/π) for a unit factor.
        let law = Root::new(1.0, Arc::new(Gamma::new(1.0, 2.0_f64.sqrt()).unwrap())).unwrap();
        assert!((law.density(0.0) / (2.0 / std::f64::consts::PI).sqrt() - 1.0).abs() < 1e-13);
    }

    #[test]
    fn equal_areas_break_together() {
        for at in [0.1, 0.3, 0.7, 1.1, 2.3] {
            let law = Root::new(0.7, Arc::new(Point::new(at).unwrap())).unwrap();
            let position = law.atoms()[0].position;
            assert_eq!((law.survival(position.next_down()), law.survival(position)), (1.0, 0.0));
            assert_eq!(law.std(), 0.0);
        }
    }
}
