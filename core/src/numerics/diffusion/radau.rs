//! Radau IIA collocation with 8 stages (E. Hairer and G. Wanner, *Solving Ordinary Differential Equations
//! II*, IV.5), and the coefficients of the sweeps that solve it: spectral deferred correction (A. Dutt, L.
//! Greengard and V. Rokhlin, BIT 40, 241 (2000)) with the triangular matrix of M. Weiser, BIT 55, 1219
//! (2015).

use std::sync::LazyLock;

use crate::numerics::legendre::{NODES, Nodal, RULE, series};

/// Number of collocation points.
pub const STAGES: usize = 8;

/// The coefficients of the method.
#[derive(Debug)]
pub(super) struct Radau {
    /// Radau points τ_j on (0, 1], rising to 1.
    pub(super) nodes: [f64; STAGES],
    /// Butcher matrix: ∫₀^{τ_j} of the cardinal polynomials.
    pub(super) weights: [[f64; STAGES]; STAGES],
    /// Uᵀ of the factorisation weightsᵀ = LU: the implicit part of a sweep.
    pub(super) sweep: [[f64; STAGES]; STAGES],
    /// From values at 0 and the points to Legendre coefficients on [0, 1].
    transform: [[f64; STAGES + 1]; STAGES + 1],
}

/// The coefficients, computed once.
pub(super) static RADAU: LazyLock<Radau> = LazyLock::new(Radau::new);

/// The cardinal polynomial of the k-th of some points.
fn cardinal(points: &[f64], k: usize, t: f64) -> f64 {
    let others = points.iter().enumerate().filter(|other| other.0 != k);
    others.map(|(_, other)| (t - other) / (points[k] - other)).product()
}

impl Radau {
    fn new() -> Self {
        let nodes = nodes();
        let weight = |j: usize, k: usize| RULE.integrate(0.0, nodes[j], |t| cardinal(&nodes, k, t));
        let weights = std::array::from_fn(|j| std::array::from_fn(|k| weight(j, k)));
        let mut points = [0.0; STAGES + 1];
        points[1..].copy_from_slice(&nodes);
        let coefficient = |n: usize, k: usize| {
            let along = |t: f64| series(&unit(n), 2.0 * t - 1.0) * cardinal(&points, k, t);
            (2.0 * n as f64 + 1.0) * RULE.integrate(0.0, 1.0, along)
        };
        let transform = std::array::from_fn(|n| std::array::from_fn(|k| coefficient(n, k)));
        Self { nodes, sweep: sweep(&weights), weights, transform }
    }

    /// Legendre coefficients of the polynomial through values at 0 and the points.
    pub(super) fn coefficients(&self, values: &[f64; STAGES + 1]) -> Nodal {
        let mut out = [0.0; NODES];
        for (out, row) in out.iter_mut().zip(&self.transform) {
            *out = row.iter().zip(values).map(|(weight, value)| weight * value).sum();
        }
        out
    }
}

fn unit(n: usize) -> Nodal {
    std::array::from_fn(|k| if k == n { 1.0 } else { 0.0 })
}

/// The zeros of P_n − P_{n−1} on [−1, 1], mapped to [0, 1].
fn nodes() -> [f64; STAGES] {
    let excess = |t: f64| series(&unit(STAGES), t) - series(&unit(STAGES - 1), t);
    let mut nodes = [1.0; STAGES];
    let mut found = 0;
    let place = |k: u32| -(std::f64::consts::PI * f64::from(k) / 1000.0).cos();
    for k in 0..999 {
        let (a, b) = (place(k), place(k + 1));
        if found < STAGES - 1 && (excess(a) > 0.0) != (excess(b) > 0.0) {
            let root = crate::numerics::roots::brent_root(excess, a, b, 0.0);
            nodes[found] = 0.5 * (1.0 + root.unwrap_or(a));
            found += 1;
        }
    }
    nodes
}

/// LU factorisation of the transpose, without pivoting.
fn sweep(weights: &[[f64; STAGES]; STAGES]) -> [[f64; STAGES]; STAGES] {
    let mut upper: [[f64; STAGES]; STAGES] = std::array::from_fn(|i| std::array::from_fn(|j| weights[j][i]));
    for k in 0..STAGES {
        for i in k + 1..STAGES {
            let factor = upper[i][k] / upper[k][k];
            let row = upper[k];
            upper[i].iter_mut().zip(row).skip(k).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    std::array::from_fn(|i| std::array::from_fn(|j| if j <= i { upper[j][i] } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_integrates_polynomials_of_degree_14() {
        let last = RADAU.weights[STAGES - 1];
        for degree in 0..=14 {
            let sum: f64 = last.iter().zip(&RADAU.nodes).map(|(w, t)| w * t.powi(degree)).sum();
            // Rounding.
            assert!((sum - 1.0 / f64::from(degree + 1)).abs() < 1e-15, "{degree}");
        }
    }

    #[test]
    fn values_make_their_polynomial() {
        let at = |t: f64| (3.0 * t - 1.0).powi(7);
        let mut values = [at(0.0); STAGES + 1];
        values[1..].copy_from_slice(&RADAU.nodes.map(at));
        let found = RADAU.coefficients(&values);
        for t in [0.1, 0.5, 0.93] {
            assert!((series(&found, 2.0 * t - 1.0) - at(t)).abs() < 1e-12);
        }
    }
}
