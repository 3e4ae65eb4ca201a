//! The pull where R and Q_ini overlap the thresholds, against a plain trapezoidal solution of the renewal equation made
//! accurate by Romberg's extrapolation: of the solver's code it shares nothing, of the laws P_c and S alone.
//!
//! With ν = R/S: φ(u) = ∫ν(r) P_c(r+u) dr, a(u) = ∫ν(r) (r+u) P_c(r+u) dr, and φ₀, a₀ likewise from Q_ini,
//! Γ = φ₀ + φ ∗ Γ, F'/(N_c⟨k⟩) = 1 − a₀ − a ∗ Γ + r̄ Γ.

use crate::common::{gamma, gaussian, lognormal, master, weibull};
use asperity::law::SharedLaw;

/// ∫ law(r)/S(r) (r+u)^n P_c(r+u) dr for n = 0, 1 at u = k × step, by the trapezoidal rule, which converges
/// exponentially for integrands that vanish smoothly at both ends.
fn moments(law: &SharedLaw, thresholds: &SharedLaw, step: f64, count: usize) -> Vec<[f64; 2]> {
    const POINTS: usize = 400;
    let (low, high) = (law.quantile(1e-18), law.upper_quantile(1e-18));
    let spacing = (high - low) / POINTS as f64;
    let starts: Vec<(f64, f64)> = (0..=POINTS)
        .map(|i| low + i as f64 * spacing)
        .map(|r| (r, spacing * law.density(r) / thresholds.survival(r)))
        .collect();
    let at = |k: usize| {
        let mut sums = [0.0; 2];
        for &(r, weight) in &starts {
            let x = r + k as f64 * step;
            let rate = weight * thresholds.density(x);
            sums = [sums[0] + rate, sums[1] + x * rate];
        }
        sums
    };
    (0..=count).map(at).collect()
}

/// F at the multiples of `distance/count`, by the trapezoidal rule: an error of even powers of the step.
fn trapezoid(laws: [&SharedLaw; 3], distance: f64, count: usize, parts: usize) -> Vec<f64> {
    let [thresholds, reforming, start] = laws;
    let step = distance / count as f64;
    let reborn = moments(reforming, thresholds, step, count);
    let first = moments(start, thresholds, step, count);
    let mut rate: Vec<f64> = Vec::with_capacity(count + 1);
    let mut slope = Vec::with_capacity(count + 1);
    for k in 0..=count {
        let end = if k == 0 { 0.0 } else { 0.5 * step };
        let history: f64 = (1..k).map(|j| rate[j] * reborn[k - j][0]).sum::<f64>() * step;
        let oldest = if k == 0 { 0.0 } else { end * rate[0] * reborn[k][0] };
        let now = (first[k][0] + history + oldest) / (1.0 - end * reborn[0][0]);
        rate.push(now);
        let lost: f64 = (1..k).map(|j| rate[j] * reborn[k - j][1]).sum::<f64>() * step
            + end * (rate[0] * reborn[k][1] + now * reborn[0][1]);
        slope.push(1.0 - first[k][1] - lost + reforming.mean() * now);
    }
    let mut force = vec![start.mean()];
    let stride = count / parts;
    for part in 0..parts {
        let inner: f64 = slope[part * stride + 1..(part + 1) * stride].iter().sum();
        let ends = 0.5 * (slope[part * stride] + slope[(part + 1) * stride]);
        force.push(force[part] + step * (inner + ends));
    }
    force
}

/// Extrapolates halved steps to none; the last correction estimates the error.
fn romberg(laws: [&SharedLaw; 3], distance: f64, parts: usize) -> (Vec<f64>, f64) {
    let counts = [128, 256, 512, 1024, 2048];
    let mut table: Vec<Vec<f64>> = counts.iter().map(|&n| trapezoid(laws, distance, n, parts)).collect();
    let mut change = f64::INFINITY;
    for order in 1..counts.len() {
        let factor = 4.0_f64.powi(order as i32);
        let better = |pair: &[Vec<f64>]| -> Vec<f64> {
            pair[1]
                .iter()
                .zip(&pair[0])
                .map(|(fine, coarse)| fine + (fine - coarse) / (factor - 1.0))
                .collect()
        };
        let last = table[table.len() - 1].clone();
        table = table.windows(2).map(better).collect();
        change = table[table.len() - 1].iter().zip(&last).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    }
    (table.remove(0), change)
}

#[test]
fn starts_that_overlap_the_thresholds() {
    let cases = [
        (gaussian(1.0, 0.15), gaussian(0.7, 0.07), gaussian(0.5, 0.05)),
        (gaussian(1.0, 0.15), gaussian(0.4, 0.04), gaussian(0.95, 0.1)),
        (lognormal(1.0, 0.2), gaussian(0.8, 0.08), gamma(0.7, 0.1)),
        (gamma(1.0, 0.3), lognormal(0.6, 0.1), gaussian(0.8, 0.08)),
        // Weibull of even shape is smooth at 0.
        (weibull(4.0, 1.0), gaussian(0.6, 0.06), gaussian(0.9, 0.1)),
    ];
    for (thresholds, reforming, start) in cases {
        let (distance, parts) = (4.0, 32);
        let (expected, uncertain) = romberg([&thresholds, &reforming, &start], distance, parts);
        assert!(uncertain < 5e-11, "{thresholds:?}: extrapolation known to {uncertain:e} only");
        let pull = master(&thresholds, &reforming, &start).pull_with(distance, 1e-10, &mut ()).unwrap();
        for (k, force) in expected.iter().enumerate() {
            let position = distance * k as f64 / parts as f64;
            let error = (pull.force(position) - force).abs();
            // The tolerance asked for, and what the extrapolation leaves.
            assert!(error < 2e-10, "{thresholds:?}, {reforming:?}, {start:?}: {error:e} at X = {position}");
        }
    }
}
