//! Gauss quadrature for a discrete measure, with as few points as an error bound allows.
//!
//! The monic polynomials orthogonal with respect to a measure μ satisfy π_{k+1} = (x − α_k) π_k − β_k
//! π_{k−1}. The n zeros of π_n are the nodes of the quadrature rule that is exact to degree 2n − 1. α and β
//! follow from Stieltjes' procedure (W. Gautschi, Orthogonal Polynomials: Computation and Approximation
//! (Oxford, 2004), section 2.2.3.1). For another function g the error is g^{(2n)}(ξ)/(2n)! ∫π_n² dμ with some
//! ξ in the support of μ (A. A. Markov).

use super::roots::brent_root;

/// Largest number of nodes: beyond it rounding no longer separates the zeros of successive polynomials.
const MOST: usize = 32;

/// The orthogonal polynomials π_0 … π_n of a measure.
struct OrthogonalPolynomials {
    /// Recurrence coefficients (α_k, β_k).
    recurrence: Vec<(f64, f64)>,
    /// ∫π_k² dμ.
    norms: Vec<f64>,
}

impl OrthogonalPolynomials {
    /// π_0(x) … π_n(x).
    fn at(&self, x: f64) -> impl Iterator<Item = f64> + '_ {
        let mut last = (0.0, 1.0);
        let next = move |&(alpha, beta): &(f64, f64)| {
            last = (last.1, (x - alpha) * last.1 - beta * last.0);
            last.1
        };
        std::iter::once(1.0).chain(self.recurrence.iter().map(next))
    }

    /// π_n(x).
    fn last(&self, x: f64) -> f64 {
        self.at(x).last().unwrap_or(1.0)
    }

    /// Adds π_{n+1}, by Stieltjes' procedure.
    fn extend(&mut self, points: &[(f64, f64)]) {
        let [mut first, mut norm] = [0.0; 2];
        for &(x, weight) in points {
            // For a discrete measure the integrals of Stieltjes' procedure are sums, exact but for
            // rounding. It loses orthogonality slowly, which limits the number of nodes.
            let square = weight * self.last(x).powi(2);
            first += x * square;
            norm += square;
        }
        let before = self.norms.last().copied();
        self.norms.push(norm);
        self.recurrence.push((first / norm, before.map_or(0.0, |before| norm / before)));
    }
}

/// The Gauss rule with the fewest nodes for the discrete measure of `points`, (x, weight > 0) by rising x,
/// that integrates g(x) = e^{−((x − x_0)/length)²} with error at most `most` for every x_0. Returns (node,
/// weight) by rising node; the points themselves if no smaller rule is found.
///
/// The bound uses |g^{(2n)}| ≤ (2n)!/(n! length^{2n}).
pub fn fewest(points: &[(f64, f64)], length: f64, most: f64) -> Vec<(f64, f64)> {
    let (Some(&(first, _)), Some(&(last, _))) = (points.first(), points.last()) else { return Vec::new() };
    // Scaled to [−1, 1], where no polynomial overflows or underflows.
    let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
    let scaled: Vec<_> = points.iter().map(|&(x, weight)| ((x - middle) / half, weight)).collect();
    let mut orthogonal = OrthogonalPolynomials { recurrence: Vec::new(), norms: Vec::new() };
    let (mut zeros, mut allowed) = (Vec::new(), most);
    for count in 1..points.len().min(MOST) {
        orthogonal.extend(&scaled);
        zeros = interlaced_zeros(&zeros, |x| orthogonal.last(x));
        if zeros.len() < count {
            break;
        }
        // The tolerance over the bound on g^{(2n)}/(2n)!, built up step by step without large factorials.
        allowed *= count as f64 * (length / half).powi(2);
        let missed: f64 = scaled.iter().map(|&(x, weight)| weight * orthogonal.last(x).powi(2)).sum();
        if missed <= allowed {
            // Christoffel's formula for the weights.
            let weighted = |&x: &f64| {
                let sum: f64 = orthogonal.at(x).zip(&orthogonal.norms).map(|(p, norm)| p * p / norm).sum();
                (middle + half * x, 1.0 / sum)
            };
            return zeros.iter().map(weighted).collect();
        }
    }
    points.to_vec()
}

/// The zeros in [−1, 1] of a polynomial, bracketed by the zeros `before` of the previous one: zeros of
/// orthogonal polynomials interlace.
fn interlaced_zeros(before: &[f64], polynomial: impl Fn(f64) -> f64) -> Vec<f64> {
    let ends: Vec<f64> = [-1.0].into_iter().chain(before.iter().copied()).chain([1.0]).collect();
    ends.windows(2).filter_map(|gap| brent_root(&polynomial, gap[0], gap[1], 0.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::legendre::RULE;

    /// A measure of many points.
    fn measure(density: impl Fn(f64) -> f64, end: f64) -> Vec<(f64, f64)> {
        const PANELS: u32 = 40;
        let width = end / f64::from(PANELS);
        let panel = |k: u32| {
            let low = f64::from(k) * width;
            (0..RULE.nodes.len())
                .map(move |i| (low + 0.5 * width * (1.0 + RULE.nodes[i]), 0.5 * width * RULE.weights[i]))
        };
        (0..PANELS).flat_map(panel).map(|(x, weight)| (x, weight * density(x))).collect()
    }

    #[test]
    fn rules_of_an_even_measure_are_legendres() {
        // ∫π_n² is 1/3, 4/45, 4/175 of a mean over [−1, 1], over n!: 0.33, 0.044, 0.0038.
        let root = 0.6_f64.sqrt();
        let rules = [
            (0.1, vec![(-1.0 / 3.0_f64.sqrt(), 0.5), (1.0 / 3.0_f64.sqrt(), 0.5)]),
            (0.01, vec![(-root, 5.0 / 18.0), (0.0, 8.0 / 18.0), (root, 5.0 / 18.0)]),
        ];
        for (most, exact) in rules {
            let rule = fewest(&measure(|_| 0.5, 2.0), 1.0, most);
            assert_eq!(rule.len(), exact.len());
            for (point, exact) in rule.iter().zip(exact) {
                // Rounding of the sums over 640 points.
                assert!((point.0 - 1.0 - exact.0).abs() < 1e-14 && (point.1 - exact.1).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn a_rule_is_exact_to_twice_its_degree() {
        // ∫x^k e^{−x} dx = k! over [0, 80], e^{−80} left out.
        let rule = fewest(&measure(|x| (-x).exp(), 80.0), 8.0, 1e-6);
        // n! 8^{−2n} is below 1e-6 from 5 on.
        assert_eq!(rule.len(), 5);
        let mut factorial = 1.0;
        for k in 0..2 * rule.len() {
            factorial *= (k as f64).max(1.0);
            let moment: f64 = rule.iter().map(|&(x, weight)| weight * x.powi(k as i32)).sum();
            assert!((moment / factorial - 1.0).abs() < 1e-11, "{k}: {moment}");
        }
    }

    #[test]
    fn the_error_asked_for_is_kept_and_not_by_far_more_points() {
        let points = measure(|x| 2.0 * x, 1.0);
        for length in [0.4, 1.0, 10.0, 1e3] {
            for most in [1e-4, 1e-8, 1e-12] {
                let rule = fewest(&points, length, most);
                for centre in [-0.3, 0.0, 0.5, 0.7, 1.0] {
                    let sum = |points: &[(f64, f64)]| -> f64 {
                        points.iter().map(|&(x, w)| w * (-((x - centre) / length).powi(2)).exp()).sum()
                    };
                    let off = (sum(&rule) - sum(&points)).abs();
                    // Rounding of sums of 1.
                    assert!(off <= most + 2e-15, "{length} {most:e} {centre}: {off:e}");
                }
                assert!(
                    rule.len() <= if length >= 1.0 { 9 } else { 20 },
                    "{length} {most:e}: {}",
                    rule.len()
                );
            }
        }
    }

    #[test]
    fn weights_add_up_past_the_points_before_and_not_past_the_next() {
        // Chebyshev, Markov, Stieltjes: μ below the k-th point is less than the first k weights, that of the next more.
        let points = measure(|x| (-x).exp(), 40.0);
        let rule = fewest(&points, 8.0, 1e-6);
        assert_eq!(rule.len(), 5);
        let below = |x: f64| points.iter().filter(|point| point.0 < x).map(|point| point.1).sum::<f64>();
        let mut sum = 0.0;
        for pair in rule.windows(2) {
            sum += pair[0].1;
            assert!(below(pair[0].0) < sum && sum < below(pair[1].0) + 1e-12);
        }
    }

    #[test]
    fn few_points_are_their_own_rule() {
        assert!(fewest(&[], 1.0, 1e-6).is_empty());
        assert_eq!(fewest(&[(2.0, 0.5)], 1.0, 1e-6), [(2.0, 0.5)]);
        assert_eq!(fewest(&[(2.0, 0.5), (3.0, 0.5)], 1e-3, 1e-6), [(2.0, 0.5), (3.0, 0.5)]);
        let [(x, weight)] = fewest(&[(2.0, 0.5), (2.001, 0.5), (2.002, 1.0)], 10.0, 1e-4)[..] else {
            panic!()
        };
        // The mean.
        assert!((x - 2.00125).abs() < 1e-12 && (weight - 2.0).abs() < 1e-12);
    }
}
