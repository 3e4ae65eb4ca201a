//! Mixtures of distributions: several kinds of contacts in one interface.

use num_complex::Complex64;

use super::{
    Atom, Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, Zone, invert_ln_survival, positive,
    shared, unknown,
};
use crate::random::Stream;
use crate::{Error, Result};

/// Weighted sum of distributions, Σ w_i P_i with Σ w_i = 1; densities and point masses may be mixed.
///
/// Parameters are addressed by index, `0.weight`, `0.mean`, `1.weight`, …. Replacing a weight scales the
/// others so that the sum stays 1.
#[derive(Debug, Clone)]
pub struct Mixture {
    components: Vec<(f64, SharedLaw)>,
}

impl Mixture {
    /// The mixture of distributions with their weights.
    ///
    /// # Errors
    /// No component, a weight that is not above 0, or weights whose sum is not 1 to 1e-9.
    pub fn new(mut components: Vec<(f64, SharedLaw)>) -> Result<Self> {
        for (weight, _) in &components {
            positive("weight", *weight)?;
        }
        let sum: f64 = components.iter().map(|(weight, _)| weight).sum();
        if (sum - 1.0).abs() > 1e-9 {
            return Err(Error::invalid("weight", "weights that sum to 1", format!("a sum of {sum}")));
        }
        // Weights whose sum is 1 to rounding stay as they were given.
        if (sum - 1.0).abs() > 1e-15 {
            components.iter_mut().for_each(|(weight, _)| *weight /= sum);
        }
        Ok(Self { components })
    }

    fn sum(&self, value: impl Fn(&dyn Law) -> f64) -> f64 {
        self.components.iter().map(|(weight, law)| weight * value(law.as_ref())).sum()
    }

    /// ln Σ w_i e^l of the logarithms l of the components, relative to the largest term, so that nothing underflows.
    fn ln_sum(&self, ln: impl Fn(&dyn Law) -> f64) -> f64 {
        let terms: Vec<_> =
            self.components.iter().map(|(weight, law)| weight.ln() + ln(law.as_ref())).collect();
        let top = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // All terms are 0, or one is infinite, as a density may be at 0.
        if top.is_infinite() {
            return top;
        }
        top + terms.iter().map(|term| (term - top).exp()).sum::<f64>().ln()
    }

    /// The weights with these in place of those of some components; the others are scaled so that the sum stays 1.
    fn weights_with(&self, given: &[(usize, f64)]) -> Result<Vec<f64>> {
        let is_given = |i: usize| given.iter().any(|one| one.0 == i);
        let all: f64 = given.iter().map(|one| one.1).sum();
        let replaced: f64 = given.iter().map(|&(i, _)| self.components[i].0).sum();
        let others = (0..self.components.len()).any(|i| !is_given(i));
        for &(index, value) in given {
            let is_weight = value > 0.0 && value <= 1.0;
            if !is_weight || others && all >= 1.0 {
                let expected = "a weight above 0 and below 1";
                return Err(Error::invalid(format!("{index}.weight"), expected, value));
            }
        }
        let mut weights: Vec<f64> =
            self.components.iter().map(|(weight, _)| weight * ((1.0 - all) / (1.0 - replaced))).collect();
        given.iter().for_each(|&(index, value)| weights[index] = value);
        Ok(weights)
    }

    /// The components with mass above x: ln of the largest weight × survival, and for each component weight ×
    /// survival relative to that. Logarithms keep far tails from underflow.
    fn survivors(&self, x: f64) -> (f64, Vec<(f64, &dyn Law)>) {
        let logs =
            self.components.iter().map(|(weight, law)| (weight.ln() + law.ln_survival(x), law.as_ref()));
        let logs: Vec<_> = logs.filter(|(log, _)| *log > f64::NEG_INFINITY).collect();
        let top = logs.iter().map(|(log, _)| *log).fold(f64::NEG_INFINITY, f64::max);
        (top, logs.into_iter().map(|(log, law)| ((log - top).exp(), law)).collect())
    }
}

impl Mixture {
    /// The component and its parameter that a name denotes.
    fn address<'a>(&self, name: &'a str) -> Result<(usize, &'a str)> {
        let address = name.split_once('.').and_then(|(index, inner)| Some((index.parse().ok()?, inner)));
        address.filter(|&(index, _)| index < self.components.len()).ok_or_else(|| unknown(self, name))
    }

    /// The points at which the density of a component is not smooth, those where these cancel each other with an amplitude of 0.
    fn all_breakpoints(&self) -> Vec<Breakpoint> {
        let weighted = |(weight, law): &(f64, SharedLaw)| {
            let weight = *weight;
            law.breakpoints().into_iter().map(move |b| Breakpoint { amplitude: weight * b.amplitude, ..b })
        };
        let all = self.components.iter().flat_map(weighted);
        let mut breakpoints: Vec<_> = all.filter(|b| b.amplitude != 0.0).collect();
        breakpoints.sort_by(|a, b| a.position.total_cmp(&b.position).then(a.exponent.total_cmp(&b.exponent)));
        breakpoints.dedup_by(|next, kept| {
            let same = next.position == kept.position && next.exponent == kept.exponent;
            kept.amplitude += if same { next.amplitude } else { 0.0 };
            same
        });
        breakpoints
    }
}

impl Law for Mixture {
    fn name(&self) -> &'static str {
        "mixture"
    }

    fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = Vec::new();
        for (index, (weight, law)) in self.components.iter().enumerate() {
            let named =
                |p: Parameter| Parameter { name: format!("{index}.{}", p.name).into(), value: p.value };
            parameters.push(named(Parameter::new("weight", *weight)));
            parameters.extend(law.parameters().into_iter().map(named));
        }
        parameters
    }

    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        self.with_parameters(&[(name, value)])
    }

    /// Weights are replaced together: the others are scaled.
    fn with_parameters(&self, values: &[(&str, f64)]) -> Result<SharedLaw> {
        let (mut weights, mut inner) = (Vec::new(), vec![Vec::new(); self.components.len()]);
        for &(name, value) in values {
            match self.address(name)? {
                (index, "weight") => weights.push((index, value)),
                (index, name) => inner[index].push((name, value)),
            }
        }
        let mut components = self.components.clone();
        if !weights.is_empty() {
            let weights = self.weights_with(&weights)?;
            components.iter_mut().zip(weights).for_each(|(component, weight)| component.0 = weight);
        }
        for (index, values) in inner.iter().enumerate().filter(|(_, values)| !values.is_empty()) {
            let law = &mut components[index].1;
            *law = law.with_parameters(values).map_err(|error| error.under(&index.to_string()))?;
        }
        shared(Self::new(components))
    }

    /// w_i ∂S_i/∂θ for a parameter of component i; (S_i − S)/(1 − w_i) for its weight, since the others are scaled
    /// so that the sum stays 1.
    ///
    /// # Errors
    /// As stated by the trait; edges of components that cancel each other, at which derivatives have kinks or jumps and the
    /// density has none: solvers do not end cells there.
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        let (index, inner) = self.address(name)?;
        if let Some(hidden) = self.all_breakpoints().iter().find(|b| b.amplitude == 0.0) {
            let expected = "a value at which no edges of distributions cancel each other";
            return Err(Error::invalid(name, expected, format!("edges that do, at {}", hidden.position)));
        }
        let (weight, law) = self.components[index].clone();
        if inner != "weight" {
            let derivative =
                law.survival_derivative(inner).map_err(|error| error.under(&index.to_string()))?;
            return Ok(Box::new(move |x| weight * derivative(x)));
        }
        if weight == 1.0 {
            return Err(Error::invalid(name, "a weight below 1", weight));
        }
        let all = self.clone();
        Ok(Box::new(move |x| (law.survival(x) - all.survival(x)) / (1.0 - weight)))
    }

    fn density(&self, x: f64) -> f64 {
        self.sum(|law| law.density(x))
    }

    fn ln_density(&self, x: f64) -> f64 {
        self.ln_sum(|law| law.ln_density(x))
    }

    fn survival(&self, x: f64) -> f64 {
        self.sum(|law| law.survival(x))
    }

    fn ln_survival(&self, x: f64) -> f64 {
        let below = self.sum(|law| law.cumulative(x));
        if below <= 0.5 {
            return (-below).ln_1p();
        }
        let (top, survivors) = self.survivors(x);
        top + survivors.iter().map(|(weight, _)| weight).sum::<f64>().ln()
    }

    fn ln_cumulative(&self, x: f64) -> f64 {
        if self.sum(|law| law.cumulative(x)) < 0.5 {
            return self.ln_sum(|law| law.ln_cumulative(x));
        }
        (-self.survival(x)).ln_1p()
    }

    /// The mean of the hazard rates, weighted by survival.
    fn hazard(&self, x: f64) -> f64 {
        let (_, survivors) = self.survivors(x);
        if survivors.is_empty() {
            return f64::INFINITY;
        }
        let sum = survivors.iter().map(|(weight, _)| weight).sum::<f64>();
        survivors.iter().map(|(weight, law)| weight * law.hazard(x)).sum::<f64>() / sum
    }

    fn quantile(&self, p: f64) -> f64 {
        if p <= 0.0 || p >= 1.0 {
            let ends = self.components.iter().map(|(_, law)| law.quantile(p));
            return ends.reduce(if p <= 0.0 { f64::min } else { f64::max }).unwrap_or(0.0);
        }
        invert_ln_survival(|x| self.ln_survival(x), (-p).ln_1p())
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        if q <= 0.0 || q >= 1.0 {
            self.quantile(1.0 - q)
        } else {
            invert_ln_survival(|x| self.ln_survival(x), q.ln())
        }
    }

    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        self.sum(|law| law.upper_moment(order, x))
    }

    fn std(&self) -> f64 {
        let mean = self.mean();
        self.sum(|law| law.std().powi(2) + (law.mean() - mean).powi(2)).sqrt()
    }

    fn atoms(&self) -> Vec<Atom> {
        let weighted = |(weight, law): &(f64, SharedLaw)| {
            let weight = *weight;
            law.atoms().into_iter().map(move |atom| Atom { weight: weight * atom.weight, ..atom })
        };
        let mut atoms: Vec<_> = self.components.iter().flat_map(weighted).collect();
        Atom::sort(&mut atoms);
        atoms.dedup_by(|next, kept| {
            let same = next.position == kept.position;
            kept.weight += if same { next.weight } else { 0.0 };
            same
        });
        atoms
    }

    fn breakpoints(&self) -> Vec<Breakpoint> {
        self.all_breakpoints().into_iter().filter(|b| b.amplitude != 0.0).collect()
    }

    /// Those of all components.
    fn zones(&self) -> Vec<Zone> {
        self.components.iter().flat_map(|(_, law)| law.zones()).collect()
    }

    fn seams(&self) -> Vec<f64> {
        self.components.iter().flat_map(|(_, law)| law.seams()).collect()
    }

    fn components(&self) -> Option<&[(f64, SharedLaw)]> {
        Some(&self.components)
    }

    fn laplace_is_closed(&self) -> bool {
        self.components.iter().all(|(_, law)| law.laplace_is_closed())
    }

    fn decay_rate(&self) -> f64 {
        self.components.iter().map(|(_, law)| law.decay_rate()).fold(f64::INFINITY, f64::min)
    }

    fn known_rate(&self) -> f64 {
        self.components.iter().map(|(_, law)| law.known_rate()).fold(f64::INFINITY, f64::min)
    }

    fn laplace(&self, s: Complex64) -> Complex64 {
        self.components.iter().map(|(weight, law)| *weight * law.laplace(s)).sum()
    }

    fn laplace_with_derivative(&self, s: Complex64) -> [Complex64; 2] {
        let terms = self
            .components
            .iter()
            .map(|(weight, law)| law.laplace_with_derivative(s).map(|term| *weight * term));
        terms.fold([Complex64::ZERO; 2], |sum, term| [sum[0] + term[0], sum[1] + term[1]])
    }

    /// Each draw chooses its component, so that a stream read in pieces gives the same numbers.
    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        let last = self.components.len() - 1;
        for i in 0..out.len() {
            let mut rest = stream.uniform();
            let chosen = self.components[..last].iter().position(|(weight, _)| {
                rest -= weight;
                rest < 0.0
            });
            self.components[chosen.unwrap_or(last)].1.fill(stream, &mut out[i..=i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::{Exponential, Point};
    use super::*;

    fn half_stuck() -> Mixture {
        let exponential = Arc::new(Exponential::new(1.0).unwrap());
        Mixture::new(vec![(0.5, Arc::new(Point::new(1.0).unwrap())), (0.5, exponential)]).unwrap()
    }

    #[test]
    fn points_and_densities_mix() {
        let law = half_stuck();
        assert_eq!(law.atoms(), [Atom { position: 1.0, weight: 0.5 }]);
        // P(ξ < 1) = ½(1 − 1/e) = .316 and the atom fills the next half.
        assert_eq!((law.quantile(0.4), law.quantile(0.8)), (1.0, 1.0));
        // Beyond the atom only the exponential is left.
        assert_eq!(law.hazard(1.5), 1.0);
        assert_eq!(law.zones().len(), 1);
    }

    #[test]
    fn two_points_split_where_their_weights_say() {
        let point = |at| Arc::new(Point::new(at).unwrap());
        let law = Mixture::new(vec![(0.3, point(1.0)), (0.7, point(2.0))]).unwrap();
        let just_above = 0.3_f64.next_up();
        assert_eq!((law.quantile(0.0), law.quantile(0.3), law.quantile(just_above)), (1.0, 1.0, 2.0));
    }

    #[test]
    fn parameters_go_by_place() {
        let law = half_stuck();
        let names: Vec<_> = law.parameters().into_iter().map(|p| p.name).collect();
        assert_eq!(names, ["0.weight", "0.at", "1.weight", "1.mean"]);
        let changed = law.with_parameter("0.weight", 0.25).unwrap().with_parameter("1.mean", 3.0).unwrap();
        assert_eq!(changed.mean(), 0.25 + 0.75 * 3.0);
        for (name, value) in
            [("0.weight", 1.0), ("2.weight", 0.5), ("0.mean", 1.0), ("mean", 1.0), ("1.mean", 0.0)]
        {
            assert!(law.with_parameter(name, value).is_err());
        }
    }

    #[test]
    fn weights_are_replaced_together() {
        let point = |at: f64| -> SharedLaw { Arc::new(Point::new(at).unwrap()) };
        let law = Mixture::new(vec![(0.5, point(1.0)), (0.375, point(2.0)), (0.125, point(3.0))]).unwrap();
        let changed = law.with_parameters(&[("0.weight", 0.25), ("1.weight", 0.5), ("1.at", 2.5)]).unwrap();
        let weights: Vec<_> = changed.atoms().iter().map(|atom| (atom.position, atom.weight)).collect();
        assert_eq!(weights, [(1.0, 0.25), (2.5, 0.5), (3.0, 0.25)]);
        let all =
            |last: f64| law.with_parameters(&[("0.weight", 0.25), ("1.weight", 0.5), ("2.weight", last)]);
        assert!(all(0.25).is_ok() && all(0.5).is_err());
        assert!(law.with_parameters(&[("0.weight", 0.5), ("1.weight", 0.5)]).is_err());
    }

    #[test]
    fn weights_are_checked() {
        let point = || Arc::new(Point::new(1.0).unwrap());
        assert!(Mixture::new(vec![]).is_err());
        assert!(Mixture::new(vec![(0.5, point()), (0.4, point())]).is_err());
        assert!(Mixture::new(vec![(1.5, point()), (-0.5, point())]).is_err());
    }
}
