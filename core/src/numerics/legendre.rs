//! Gauss–Legendre quadrature, interpolation and Legendre series on [−1, 1], all with 16 nodes.

use std::sync::LazyLock;

/// Number of Gauss points everywhere in the crate: quadrature is exact to degree 31, interpolation to degree
/// 15.
pub const NODES: usize = 16;

/// 16 numbers of a cell: values at the Gauss points, or Legendre coefficients.
pub type Nodal = [f64; NODES];

/// The Gauss–Legendre rule with [`NODES`] nodes.
#[derive(Debug)]
pub struct GaussLegendre {
    /// Gauss points t_i in [−1, 1], ascending.
    pub nodes: Nodal,
    /// Weights w_i.
    pub weights: Nodal,
    /// Barycentric weights of interpolation at the points.
    barycentric: Nodal,
    /// `transform[n][i]` = (n + ½) w_i P_n(t_i): from values at the points to Legendre coefficients.
    transform: [Nodal; NODES],
    /// The same column by column: `columns[i][n]`.
    columns: [Nodal; NODES],
}

/// The rule, computed once.
pub static RULE: LazyLock<GaussLegendre> = LazyLock::new(GaussLegendre::new);

/// P_n(t) and P_n'(t).
fn legendre(n: usize, t: f64) -> (f64, f64) {
    let (mut previous, mut current) = (1.0, t);
    for k in 2..=n {
        let k = k as f64;
        (previous, current) = (current, ((2.0 * k - 1.0) * t * current - (k - 1.0) * previous) / k);
    }
    (current, n as f64 * (t * current - previous) / (t * t - 1.0))
}

impl GaussLegendre {
    fn new() -> Self {
        let mut rule = Self {
            nodes: [0.0; NODES],
            weights: [0.0; NODES],
            barycentric: [0.0; NODES],
            transform: [[0.0; NODES]; NODES],
            columns: [[0.0; NODES]; NODES],
        };
        for i in 0..NODES {
            // Newton iteration from the Chebyshev-like estimate of the zero.
            let mut t = -(std::f64::consts::PI * (i as f64 + 0.75) / (NODES as f64 + 0.5)).cos();
            for _ in 0..8 {
                let (p, slope) = legendre(NODES, t);
                t -= p / slope;
            }
            let slope = legendre(NODES, t).1;
            rule.nodes[i] = t;
            rule.weights[i] = 2.0 / ((1.0 - t * t) * slope * slope);
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            // Barycentric weights of Gauss–Legendre points in closed form, up to a common factor
            // (H. Wang and S. Xiang, Math. Comput. 81, 861 (2012)).
            rule.barycentric[i] = sign * ((1.0 - t * t) * rule.weights[i]).sqrt();
        }
        for i in 0..NODES {
            let (t, w) = (rule.nodes[i], rule.weights[i]);
            // The coefficients are integrals of degree ≤ 30, which the rule computes exactly:
            // interpolation and projection are the same.
            rule.transform[0][i] = 0.5 * w;
            for n in 1..NODES {
                rule.transform[n][i] = (n as f64 + 0.5) * w * legendre(n, t).0;
            }
            rule.columns[i] = rule.transform.map(|row| row[i]);
        }
        rule
    }

    /// Legendre coefficients of the polynomial through `values` at the Gauss points.
    #[inline(always)]
    pub fn coefficients(&self, values: &Nodal) -> Nodal {
        let (values, mut out) = (*values, [0.0; NODES]);
        // The loop over n vectorises, since a column is contiguous.
        for i in 0..NODES {
            for n in 0..NODES {
                out[n] += self.columns[i][n] * values[i];
            }
        }
        out
    }

    /// The same for each column of `rows`, the rows of values at the points: row n of the result has the coefficients number n.
    #[inline(always)]
    pub fn coefficients_of_rows(&self, rows: &[Nodal; NODES]) -> [Nodal; NODES] {
        let mut out = [[0.0; NODES]; NODES];
        for n in 0..NODES {
            for i in 0..NODES {
                for m in 0..NODES {
                    out[n][m] += self.transform[n][i] * rows[i][m];
                }
            }
        }
        out
    }

    /// Gauss values on a cell of the polynomial that has the same integrals with all polynomials of its degree as parts of the cell,
    /// each with its middle, half width and Gauss values: the least-squares fit to them.
    #[inline(never)]
    pub fn projection(&self, parts: &[(f64, f64, Nodal)], (middle, half): (f64, f64)) -> Nodal {
        let mut values = [0.0; NODES];
        for (m, h, part) in parts {
            for i in 0..NODES {
                let cardinals = self.cardinals((m + h * self.nodes[i] - middle) / half);
                let weight = h / half * self.weights[i] * part[i];
                (0..NODES).for_each(|j| values[j] += weight * cardinals[j]);
            }
        }
        (0..NODES).for_each(|j| values[j] /= self.weights[j]);
        values
    }

    /// Values at `t` of the 16 cardinal (Lagrange) polynomials, by the barycentric formula.
    pub fn cardinals(&self, t: f64) -> Nodal {
        let mut row = [0.0; NODES];
        let mut sum = 0.0;
        for j in 0..NODES {
            let gap = t - self.nodes[j];
            if gap == 0.0 {
                let mut unit = [0.0; NODES];
                unit[j] = 1.0;
                return unit;
            }
            row[j] = self.barycentric[j] / gap;
            sum += row[j];
        }
        row.map(|term| term / sum)
    }

    /// Weights r_i of values at the points such that Σ_i r_i f(t_i) = Σ_n `moments[n]` c_n, with c_n the
    /// Legendre coefficients of f: the transpose of [`GaussLegendre::coefficients`].
    #[inline(always)]
    pub fn functional(&self, moments: &Nodal) -> Nodal {
        let mut row = [0.0; NODES];
        for (moment, transform) in moments.iter().zip(&self.transform) {
            for (sum, entry) in row.iter_mut().zip(transform) {
                *sum += moment * entry;
            }
        }
        row
    }

    /// ∫_a^b f by the 16-point rule.
    pub fn integrate(&self, a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let sum: f64 = (0..NODES).map(|i| self.weights[i] * f(middle + half * self.nodes[i])).sum();
        half * sum
    }
}

/// `CUMULATIVE[i][k]` = ∫₋₁^t_i ℓ_k dt with the cardinal polynomials ℓ_k of the Gauss points.
pub static CUMULATIVE: LazyLock<[Nodal; NODES]> = LazyLock::new(|| {
    let mut rows = [[0.0; NODES]; NODES];
    for k in 0..NODES {
        let unit = std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
        let coefficients = RULE.coefficients(&unit);
        // P_16, which `primitive` leaves out, is 0 at the Gauss points.
        let primitive = primitive(&coefficients);
        for i in 0..NODES {
            rows[i][k] = coefficients[0] + series(&primitive, RULE.nodes[i]);
        }
    }
    rows
});

/// P_0(t) … P_15(t).
#[inline]
pub fn polynomials(t: f64) -> Nodal {
    let mut out = [1.0; NODES];
    out[1] = t;
    for n in 2..NODES {
        let k = n as f64;
        out[n] = ((2.0 * k - 1.0) * t * out[n - 1] - (k - 1.0) * out[n - 2]) / k;
    }
    out
}

/// Scalar product.
pub fn dot(a: &Nodal, b: &Nodal) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Scalar product by four sums, which vectorises.
#[inline(always)]
pub fn dot_in_lanes(a: &Nodal, b: &Nodal) -> f64 {
    let mut sums = [0.0; NODES / 4];
    for j in 0..NODES / 4 {
        for k in 0..4 {
            sums[j] += a[4 * k + j] * b[4 * k + j];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// Sum by four sums, which vectorises.
#[inline(always)]
pub fn sum_in_lanes(terms: &Nodal) -> f64 {
    dot_in_lanes(terms, &[1.0; NODES])
}

/// Value at t of a Legendre series, by Clenshaw's recurrence.
#[inline]
pub fn series<const TERMS: usize>(coefficients: &[f64; TERMS], t: f64) -> f64 {
    let (mut next, mut last) = (0.0, 0.0);
    for n in (1..TERMS).rev() {
        let term = CLENSHAW[n].0 * t * next + (coefficients[n] - CLENSHAW[n].1 * last);
        (next, last) = (term, next);
    }
    coefficients[0] + t * next - 0.5 * last
}

/// Values of a Legendre series at 16 points at once; the loop vectorises.
#[inline(always)]
pub fn series_at<const TERMS: usize>(coefficients: &[f64; TERMS], t: &Nodal) -> Nodal {
    clenshaw::<TERMS, _>(t, |n| coefficients[n], |c, _| c)
}

/// The same where each point has one of two series: the second one from x = `edge` on.
#[inline(always)]
pub fn series_of_two([first, second]: [&Nodal; 2], t: &Nodal, x: &Nodal, edge: f64) -> Nodal {
    let x = *x;
    let of = |(first, second), i: usize| if x[i] >= edge { second } else { first };
    clenshaw::<NODES, _>(t, |n| (first[n], second[n]), of)
}

/// Clenshaw's recurrence at 16 points at once. `of` takes the coefficients number n to that of a point.
///
/// Everything that the inner loop reads is a copy: only then does the compiler know that nothing it writes changes it,
/// and vectorises the loop.
#[inline(always)]
fn clenshaw<const TERMS: usize, C: Copy>(
    t: &Nodal,
    coefficients: impl Fn(usize) -> C,
    of: impl Fn(C, usize) -> f64,
) -> Nodal {
    let (t, mut next, mut last) = (*t, [0.0; NODES], [0.0; NODES]);
    for n in (1..TERMS).rev() {
        let ((up, down), here) = (CLENSHAW[n], coefficients(n));
        for i in 0..NODES {
            let term = up * t[i] * next[i] + (of(here, i) - down * last[i]);
            last[i] = next[i];
            next[i] = term;
        }
    }
    let (constant, mut out) = (coefficients(0), [0.0; NODES]);
    for i in 0..NODES {
        out[i] = of(constant, i) + t[i] * next[i] - 0.5 * last[i];
    }
    out
}

/// `start` + `length` × the Gauss points.
#[inline(always)]
pub fn gauss_points(start: f64, length: f64) -> Nodal {
    let mut points = RULE.nodes;
    points.iter_mut().for_each(|t| *t = start + length * *t);
    points
}

/// Adds weight × P_n(t) to `moments[n]`.
#[inline]
pub fn add_moments(t: f64, weight: f64, moments: &mut Nodal) {
    let (mut previous, mut current) = (0.0, weight);
    moments[0] += current;
    for n in 1..NODES {
        (previous, current) = (current, RECURRENCE[n].0 * t * current - RECURRENCE[n].1 * previous);
        moments[n] += current;
    }
}

/// Adds weight × P_n(t) of 16 points to `moments[n]`, point after point; the recurrence vectorises.
#[inline(always)]
pub fn add_moments_at(t: &Nodal, weights: &Nodal, moments: &mut Nodal) {
    let (t, mut previous, mut current) = (*t, [0.0; NODES], *weights);
    let mut terms = [current; NODES];
    for n in 1..NODES {
        let (up, down) = RECURRENCE[n];
        for i in 0..NODES {
            let term = up * t[i] * current[i] - down * previous[i];
            previous[i] = current[i];
            current[i] = term;
            terms[n][i] = term;
        }
    }
    for i in 0..NODES {
        for n in 0..NODES {
            moments[n] += terms[n][i];
        }
    }
}

/// Factors (2n−1)/n and (n−1)/n of P_n = (2n−1)/n t P_{n−1} − (n−1)/n P_{n−2}.
const RECURRENCE: [(f64, f64); NODES] = {
    let mut factors = [(0.0, 0.0); NODES];
    let mut n = 1;
    while n < NODES {
        let k = n as f64;
        factors[n] = ((2.0 * k - 1.0) / k, (k - 1.0) / k);
        n += 1;
    }
    factors
};

/// Factors (2n+1)/(n+1) and (n+1)/(n+2) of Clenshaw's recurrence, for the integral of a series, too.
const CLENSHAW: [(f64, f64); NODES + 1] = {
    let mut factors = [(0.0, 0.0); NODES + 1];
    let mut n = 0;
    while n <= NODES {
        let k = n as f64;
        factors[n] = ((2.0 * k + 1.0) / (k + 1.0), (k + 1.0) / (k + 2.0));
        n += 1;
    }
    factors
};

/// The derivative of P_n of the given order at t = 1 (`side` = 1) or t = −1 (`side` = −1): (±1)^{n+d}
/// (n+d)!/(2^d d! (n−d)!).
pub fn end_derivative(n: usize, order: u32, side: f64) -> f64 {
    let (n, d) = (n as i32, order as i32);
    let magnitude: f64 = (1..=d).map(|k| f64::from((n + k) * (n - k + 1)) / f64::from(2 * k)).product();
    side.powi(n + d) * magnitude
}

/// Legendre coefficients of the derivative with respect to t.
pub fn derivative(coefficients: &Nodal) -> Nodal {
    let mut out = [0.0; NODES];
    for n in (0..NODES - 1).rev() {
        let above = if n + 2 < NODES { out[n + 2] / (2.0 * n as f64 + 5.0) } else { 0.0 };
        out[n] = (2.0 * n as f64 + 1.0) * (coefficients[n + 1] + above);
    }
    out
}

/// Legendre coefficients of a primitive with respect to t: ∫₋₁^t is c_0 plus its value at t. The term of
/// degree 16 is dropped; it is below the truncation error of the series.
pub fn primitive(coefficients: &Nodal) -> Nodal {
    let c = coefficients;
    // ∫P_n = (P_{n+1} − P_{n−1})/(2n + 1).
    let below = |n: usize| if n == 0 { 0.0 } else { c[n - 1] / (2 * n - 1) as f64 };
    let over = |n: usize| c.get(n + 1).map_or(0.0, |c| c / (2 * n + 3) as f64);
    std::array::from_fn(|n| below(n) - over(n))
}

/// Legendre coefficients of ∫₋₁^t of a series: ∫P_n = (P_{n+1} − P_{n−1})/(2n + 1), and 1 + t for n = 0.
#[inline(always)]
pub fn integral(coefficients: &Nodal) -> [f64; NODES + 1] {
    let mut out = [0.0; NODES + 1];
    for n in 0..NODES {
        out[n + 1] = coefficients[n] * INTEGRAL[n];
    }
    for n in 1..NODES {
        out[n - 1] -= coefficients[n] * INTEGRAL[n];
    }
    out[0] += coefficients[0];
    out
}

/// The factors 1/(2n + 1) of the integral of P_n.
const INTEGRAL: Nodal = {
    let mut factors = [0.0; NODES];
    let mut n = 0;
    while n < NODES {
        factors[n] = 1.0 / (2 * n + 1) as f64;
        n += 1;
    }
    factors
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrature_is_exact_to_degree_31_and_no_further() {
        let power = |n: i32| RULE.integrate(0.0, 1.0, |x| x.powi(n)) * f64::from(n + 1);
        // Sixteen terms of rounding.
        assert!((0..=31).all(|n| (power(n) - 1.0).abs() < 1e-14));
        assert!((power(60) - 1.0).abs() > 1e-14);
    }

    #[test]
    fn series_cardinals_and_derivative_agree_with_a_known_function() {
        let values = RULE.nodes.map(f64::exp);
        let coefficients = RULE.coefficients(&values);
        for t in [-1.0, -0.3, 0.0, 0.77, 1.0, RULE.nodes[5]] {
            // exp is resolved to 1e-17 by degree 15; the rest is rounding of sums over 16 points, amplified n² by the derivative.
            assert!((series(&coefficients, t) - t.exp()).abs() < 1e-14);
            assert!((dot(&RULE.cardinals(t), &values) - t.exp()).abs() < 1e-14);
            let together = series_at(&integral(&coefficients), &[t; NODES]);
            assert!(together.iter().all(|value| (value - (t.exp() - (-1.0_f64).exp())).abs() < 1e-14));
            assert!((series(&derivative(&coefficients), t) - t.exp()).abs() < 1e-12);
            let integral = coefficients[0] + series(&primitive(&coefficients), t);
            assert!((integral - (t.exp() - (-1.0_f64).exp())).abs() < 1e-14);
        }
        for (side, order) in [(1.0, 0), (1.0, 1), (-1.0, 1), (-1.0, 2), (1.0, 3)] {
            let ends: Vec<f64> = (0..NODES).map(|n| end_derivative(n, order, side)).collect();
            let sum: f64 = coefficients.iter().zip(&ends).map(|(c, end)| c * end).sum();
            // Coefficients have (n + ½) times the rounding of the values.
            let amplified = ends.iter().enumerate().map(|(n, end)| (n as f64 + 0.5) * end.abs());
            let rounding = 1e-15 * amplified.sum::<f64>();
            assert!((sum - side.exp()).abs() < rounding, "order {order} at {side}: {sum}");
        }
    }
}
