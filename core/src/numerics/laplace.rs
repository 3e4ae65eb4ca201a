//! Laplace transforms of Legendre series on cells.
//!
//! The integrals J_n = ∫e^{−zt} P_n(t) dt over \[−1, 1\] are 2(−1)ⁿ i_n(z), with the modified spherical Bessel functions i_n, and
//! satisfy J_{n+1} = J_{n−1} + (2n+1) J_n/z. Upwards the recurrence is stable for n < |z|, downwards for all n (J. C. P. Miller;
//! W. Gautschi, SIAM Rev. 9, 24 (1967)).

use num_complex::Complex64;

use super::legendre::{NODES, Nodal};

/// |z| from which on the recurrence is used upwards: it is stable for all degrees of the series, at a cost that does not depend
/// on z.
const FAR: f64 = 20.0;
/// The degree at which the recurrence begins downwards is that of |z| → 0, and rises with √|z| and |z| ≤ 20: there (2n+1) i_n is
/// below rounding of their sum, which is 1 or more.
const BEGIN: [f64; 3] = [12.0, 4.4, 1.2];

/// 1/(2n+1).
const SHARES: [f64; NODES] = {
    let (mut shares, mut n) = ([0.0; NODES], 0);
    while n < NODES {
        shares[n] = 1.0 / (2 * n + 1) as f64;
        n += 1;
    }
    shares
};

/// ∫e^{−su} f(u) du and ∫u e^{−su} f(u) du over a cell, given by its middle and half its width, of a Legendre series f.
pub(super) fn transform(coefficients: &Nodal, (middle, half): (f64, f64), s: Complex64) -> [Complex64; 2] {
    let z = s * half;
    let pairs = with_moments(coefficients);
    let far = z.norm_sqr() > FAR * FAR;
    let ([value, moment], exponent) = if far { upwards(&pairs, z) } else { downwards(&pairs, z) };
    let front = half * (exponent - s * middle).exp();
    [front * value, front * (middle * value + half * moment)]
}

/// The coefficients of f(t) and of t f(t), by t P_n = [(n+1) P_{n+1} + n P_{n−1}]/(2n+1).
fn with_moments(coefficients: &Nodal) -> [[f64; 2]; NODES + 1] {
    let mut pairs = [[0.0; 2]; NODES + 1];
    for (n, &c) in coefficients.iter().enumerate() {
        let (k, share) = (n as f64, c * SHARES[n]);
        pairs[n][0] = c;
        pairs[n + 1][1] += (k + 1.0) * share;
        if n > 0 {
            pairs[n - 1][1] += k * share;
        }
    }
    pairs
}

/// Σ c_n J_n of both for large |z|, divided by e^ρ; and ρ.
fn upwards(pairs: &[[f64; 2]; NODES + 1], z: Complex64) -> ([Complex64; 2], Complex64) {
    // Both ends of the integration by parts, scaled by the larger exponential.
    let (up, down) = ((-z - z.re.abs()).exp(), (z - z.re.abs()).exp());
    let mut here = (down - up) / z;
    let mut above = here / z - (up + down) / z;
    let mut sums = [Complex64::ZERO; 2];
    for (n, pair) in pairs.iter().enumerate() {
        sums.iter_mut().zip(pair).for_each(|(sum, c)| *sum += c * here);
        (here, above) = (above, here + (2 * n + 3) as f64 * above / z);
    }
    (sums, z.re.abs().into())
}

/// The same for small |z|, from g_n = i_n/zⁿ with g_{n−1} = z² g_{n+1} + (2n+1) g_n, and Σ(2n+1)(±1)ⁿ i_n = e^{±z}, of which the
/// larger exponential has no cancellation.
fn downwards(pairs: &[[f64; 2]; NODES + 1], z: Complex64) -> ([Complex64; 2], Complex64) {
    let square = z * z;
    let signed = if z.re < 0.0 { -z } else { z };
    let size = z.norm_sqr().sqrt();
    let begin = BEGIN[0] + BEGIN[1] * size.sqrt() + BEGIN[2] * size;
    // All sums over powers of z by Horner's rule, from above.
    let (mut above, mut here) = (Complex64::ZERO, Complex64::ONE);
    let (mut all, mut sums) = (Complex64::ZERO, [Complex64::ZERO; 2]);
    for n in (0..=begin as usize).rev() {
        let odd = (2 * n + 1) as f64;
        all = all * signed + odd * here;
        if let Some(pair) = pairs.get(n) {
            sums.iter_mut().zip(pair).for_each(|(sum, c)| *sum = -*sum * z + c * here);
        }
        (above, here) = (here, square * above + odd * here);
    }
    let factor = 2.0 * all.inv();
    (sums.map(|sum| factor * sum), signed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::legendre::{RULE, series};

    /// The same by Gauss's rule on parts so short that it is exact to rounding.
    fn by_quadrature(coefficients: &Nodal, z: Complex64) -> [Complex64; 2] {
        let parts = (z.norm() / 2.0).ceil().max(1.0);
        let mut sums = [Complex64::ZERO; 2];
        for k in 0..parts as usize {
            let centre = -1.0 + (2 * k + 1) as f64 / parts;
            for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
                let t = centre + t / parts;
                let term = w / parts * series(coefficients, t) * (-z * t).exp();
                sums[0] += term;
                sums[1] += t * term;
            }
        }
        sums
    }

    #[test]
    fn transforms_agree_with_quadrature_on_both_sides_of_the_change() {
        // Coefficients of the same size in all degrees.
        let coefficients: Nodal = std::array::from_fn(|n| [1.0, -0.7, 0.9][n % 3]);
        for size in [0.0, 1e-12, 1e-3, 0.5, 3.0, std::f64::consts::PI, 9.0, 19.99, 20.01, 60.0] {
            for angle in [0.0, 0.3, 0.5, 0.8, 1.0].map(|half_turns| half_turns * std::f64::consts::PI) {
                let z = Complex64::from_polar(size, angle);
                let found = transform(&coefficients, (0.0, 1.0), z);
                let expected = by_quadrature(&coefficients, z);
                // Rounding in sums of 16 terms below 2e^{|Re z|}: largest on the imaginary axis, where terms of alternating sign
                // of the normalisation are up to 20 times their sum.
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!((found - expected).norm() < 1e-14 * z.re.abs().exp(), "{z}: {found} {expected}");
                }
            }
        }
    }
}
