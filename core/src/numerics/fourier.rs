//! Fourier transforms of functions that are given cell by cell as Legendre series.
//!
//! ∫₋₁¹ e^{izt} P_n(t) dt = 2iⁿ j_n(z), with the spherical Bessel functions j_n (NIST Digital Library of Mathematical
//! Functions, 18.17.19): a cell of half width h around m gives h e^{iqm} Σ_n 2iⁿ c_n j_n(qh) for any q, without quadrature.

use num_complex::Complex64;

use super::legendre::{NODES, Nodal};
use super::piecewise::Piecewise;
use crate::numerics::order::sort_by_number;

/// The Fourier transforms of K functions on the same cells, which share phases and Bessel functions.
#[derive(Debug, Clone)]
pub struct FourierTransforms<const K: usize> {
    /// Cells, those of equal width one after another.
    cells: Vec<SeriesCell<K>>,
    /// Half widths h, and the number of the first cell that is wider.
    widths: Vec<(f64, usize)>,
}

#[derive(Debug, Clone)]
struct SeriesCell<const K: usize> {
    middle: f64,
    /// Of each degree n and each function: 2h c_n times the sign of iⁿ, or of iⁿ/i if n is odd.
    terms: [[f64; K]; NODES],
}

impl<const K: usize> FourierTransforms<K> {
    /// Of functions on the same cells.
    pub fn new(functions: [&Piecewise; K]) -> Self {
        let first = functions[0];
        let half = |cell: usize| first.cell(cell).1;
        let mut order: Vec<usize> = (0..first.coefficients.len()).collect();
        sort_by_number(&mut order, |&a| half(a));
        let sign = |n: usize| if n % 4 < 2 { 2.0 } else { -2.0 };
        let mut widths: Vec<(f64, usize)> = Vec::new();
        let mut cells = Vec::with_capacity(order.len());
        for cell in order {
            let (middle, half) = first.cell(cell);
            let terms = |n| functions.map(|function| sign(n) * half * function.coefficients[cell][n]);
            cells.push(SeriesCell { middle, terms: std::array::from_fn(terms) });
            match widths.last_mut() {
                // Halves of halves, up to the rounding of their boundaries.
                Some((width, end)) if half - *width <= 1e-13 * (half + middle) => *end = cells.len(),
                _ => widths.push((half, cells.len())),
            }
        }
        Self { cells, widths }
    }

    /// ∫e^{iqu} f(u) du of each function.
    pub fn at(&self, q: f64) -> [Complex64; K] {
        let (mut re, mut im) = ([0.0; K], [0.0; K]);
        let mut start = 0;
        for &(half, end) in &self.widths {
            let bessel = spherical_bessel(q * half);
            for cell in &self.cells[start..end] {
                let (mut even, mut odd) = ([0.0; K], [0.0; K]);
                for n in 0..NODES / 2 {
                    for k in 0..K {
                        even[k] += bessel[2 * n] * cell.terms[2 * n][k];
                        odd[k] += bessel[2 * n + 1] * cell.terms[2 * n + 1][k];
                    }
                }
                let (sin, cos) = (q * cell.middle).sin_cos();
                for k in 0..K {
                    re[k] += cos * even[k] - sin * odd[k];
                    im[k] += sin * even[k] + cos * odd[k];
                }
            }
            start = end;
        }
        std::array::from_fn(|k| Complex64::new(re[k], im[k]))
    }
}

/// The spherical Bessel functions j_0 to j_15 of z ≥ 0, by the recurrence j_{n−1} + j_{n+1} = (2n + 1) j_n/z: upward
/// where it is stable, z ≥ n; else downward from a high degree, scaled to j_0 or j_1 (J. C. P. Miller's algorithm).
fn spherical_bessel(z: f64) -> Nodal {
    if z < 5e-3 {
        return near_zero(z);
    }
    let mut out = [0.0; NODES];
    let ((sin, cos), inverse) = (z.sin_cos(), 1.0 / z);
    let first = [sin * inverse, (sin * inverse - cos) * inverse];
    if z >= NODES as f64 {
        [out[0], out[1]] = first;
        for n in 1..NODES - 1 {
            out[n + 1] = (2 * n + 1) as f64 * inverse * out[n] - out[n - 1];
        }
        return out;
    }
    // (ez/2N)^{2N}, by which what was left out above N falls to degree 15, is below rounding.
    let highest = 20 + (1.3 * z) as usize;
    let (mut above, mut here) = (0.0, 1e-200);
    for n in (1..=highest).rev() {
        if n < NODES {
            out[n] = here;
        }
        (above, here) = (here, (2 * n + 1) as f64 * inverse * here - above);
    }
    out[0] = here;
    let scale = if out[0].abs() > out[1].abs() { first[0] / out[0] } else { first[1] / out[1] };
    out.map(|value| scale * value)
}

/// j_n(z) = zⁿ/(2n + 1)!! \[1 − z²/(2(2n + 3)) + z⁴/(8(2n + 3)(2n + 5)) − …\].
fn near_zero(z: f64) -> Nodal {
    let (mut front, square) = (1.0, 0.5 * z * z);
    std::array::from_fn(|n| {
        let odd = (2 * n + 3) as f64;
        let value = front * (1.0 - square / odd * (1.0 - 0.5 * square / (odd + 2.0)));
        front *= z / odd;
        value
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::legendre::RULE;
    use crate::numerics::piecewise::Resolution;

    /// 2iⁿ j_n = ∫e^{izt} P_n dt by Gauss quadrature on 64 parts, with P_n from its own recurrence.
    #[test]
    fn spherical_bessel_functions_are_transforms_of_legendre_polynomials() {
        let legendre = |n: usize, t: f64| {
            let (mut before, mut value) = (1.0, t);
            for k in 1..n {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k + 1.0) * t * value - k * before) / (k + 1.0));
            }
            if n == 0 { 1.0 } else { value }
        };
        for z in [
            0.0,
            1e-9,
            4.9e-3,
            5.1e-3,
            0.3,
            1.0,
            std::f64::consts::PI,
            4.493_409_457_909_064,
            9.7,
            15.99,
            16.0,
            90.0,
        ] {
            let found = spherical_bessel(z);
            for (n, found) in found.iter().enumerate() {
                let integrand =
                    |t: f64| legendre(n, t) * if n % 2 == 0 { (z * t).cos() } else { (z * t).sin() };
                let part = |k: i32| RULE.integrate(f64::from(k) / 32.0, f64::from(k + 1) / 32.0, integrand);
                let sign = if n % 4 < 2 { 0.5 } else { -0.5 };
                let expected = sign * (-32..32).map(part).sum::<f64>();
                assert!((found - expected).abs() < 2e-15, "j_{n}({z}): {found:e} {expected:e}");
            }
        }
    }

    /// e^{−u} and its product with u on cells of several widths, for slow and fast oscillations.
    #[test]
    fn transforms_agree_with_closed_forms() {
        let ([f, g], _) = Piecewise::resolve_all(
            |x| [(-x).exp(), x * (-x).exp()],
            &[0.4, 1.1],
            40.0,
            Resolution::Mean(1e-17),
        );
        let both = FourierTransforms::new([&f, &g]);
        for q in [0.0, 1e-7, 0.3, 2.0, 31.0, 4e3] {
            let [first, second] = both.at(q);
            let exact = Complex64::new(1.0, -q).inv();
            assert!((first - exact).norm() < 1e-15, "{q}: {:e}", (first - exact).norm());
            assert!((second - exact * exact).norm() < 1e-15, "{q}: {:e}", (second - exact * exact).norm());
        }
    }
}
