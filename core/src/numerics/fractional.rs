//! The square root of the lattice Laplacian, and its parts that belong to the two directions, as coupling constants between two
//! sites of an infinite square lattice.

use std::f64::consts::PI;

use crate::Result;
use crate::monitor::{Monitor, Watch};
use crate::parallel;

/// Step of the trapezoidal rule in s.
const STEP: f64 = 0.16;

/// Scale of Miller's recurrence: far enough from underflow, and its inverse from overflow.
const SMALL: f64 = 1e-200;

/// Rows computed by one thread.
const GROUP: usize = 4;

/// Coupling constants w(m, n) > 0 with (√Δ x)_i = Σ_j w(i − j)(x_i − x_j), where Δ is the Laplacian of the
/// square lattice with eigenvalues λ = 4 sin²(q_1/2) + 4 sin²(q_2/2). Returned for 0 ≤ m < rows, 0 ≤ n <
/// columns, row by row, with w(0, 0) = 0.
///
/// From √λ = ∫₀^∞ (1 − e^{−λt}) t^{−3/2} dt/(2√π), and because e^{−Δt} is diffusion, which factorises into
/// the two directions,
///
/// w(m, n) = (1/2√π) ∫₀^∞ t^{−3/2} g_m(t) g_n(t) dt, g_m(t) = e^{−2t} I_m(2t).
///
/// The substitution t = exp(s − e^{−s}) (double-exponential quadrature) makes the integrand decay at both
/// ends at least like e^{−|s|/2}; the trapezoidal rule then converges like e^{−c/step}. w is right to a
/// relative 1e-13; at distances r ≫ 1 it tends to 1/2πr³.
///
/// # Errors
/// Stopped by the monitor.
pub fn sqrt_laplacian(sides: [usize; 2], monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
    products(sides, |_, g| g.to_vec(), monitor)
}

/// The same of Δ_row/√Δ, Δ_row the part of Δ along rows, with eigenvalues 4 sin²(q_2/2): the part of √Δ that differences along rows
/// make. Constants may be negative. From 1/√λ = ∫₀^∞ e^{−λt} t^{−1/2} dt/√π and Δ_row e^{−Δ_row t} = −d/dt e^{−Δ_row t},
///
/// w(m, n) = (1/√π) ∫₀^∞ t^{−1/2} g_m(t) g_n′(t) dt,
///
/// right to some r² roundings of √Δ, tends to (1/2π)(3n²/r⁵ − 1/r³); with that of Δ_column/√Δ it adds up to that of √Δ.
///
/// # Errors
/// Stopped by the monitor.
pub fn row_share_of_sqrt_laplacian(sides: [usize; 2], monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
    products(sides, |z, g| slope_of_scaled_bessel(z, g.len()), monitor)
}

/// (1/2√π) ∫₀^∞ t^{−3/2} g_m(t) h_n(t) dt, with h(t) = `along`(2t, g(t)).
fn products(
    [rows, columns]: [usize; 2],
    along: impl Fn(f64, &[f64]) -> Vec<f64> + Sync,
    monitor: &mut dyn Monitor,
) -> Result<Vec<f64>> {
    let (longest, watch) = (rows.max(columns), Watch::new(monitor));
    let node = |_, (t, weight): (f64, f64)| {
        let down = scaled_bessel(2.0 * t, longest);
        let along = along(2.0 * t, &down);
        (weight, down, along)
    };
    let nodes = parallel::map(nodes_in_time(longest), &node);
    let mut weights = vec![0.0; rows * columns];
    parallel::map(weights.chunks_mut(GROUP * columns).collect(), &|group, weights: &mut [f64]| {
        for (weight, down, along) in &nodes {
            if watch.stops() {
                return;
            }
            for (m, row) in (GROUP * group..).zip(weights.chunks_mut(columns)) {
                // The integrand is a product of functions of m and of n: each node adds an outer product.
                let factor = weight * down[m];
                row.iter_mut().zip(along).for_each(|(w, g)| *w += factor * g);
            }
        }
    });
    watch.check()?;
    weights[0] = 0.0;
    Ok(weights)
}

/// Quadrature nodes t and their weights.
fn nodes_in_time(longest: usize) -> Vec<(f64, f64)> {
    // The integral beyond is below the rounding of the smallest coefficient.
    let last = 2.0 * (longest as f64).ln() + 26.0;
    let first = -4.5_f64;
    let count = ((last - first) / STEP).ceil() as usize;
    let node = |i: usize| {
        let s = first + STEP * i as f64;
        let t = (s - (-s).exp()).exp();
        (t, STEP * (1.0 + (-s).exp()) / (2.0 * (PI * t).sqrt()))
    };
    (0..count).map(node).collect()
}

/// e^{−z} I_m(z) for 0 ≤ m < `count`, I_m the modified Bessel functions.
fn scaled_bessel(z: f64, count: usize) -> Vec<f64> {
    if is_large(z, count) { asymptotic(z, count, |_| 1.0) } else { by_recurrence(z, count) }
}

/// 2z d/dz e^{−z} I_m(z) for 0 ≤ m < `count`, from 2 I_m′ = I_{m−1} + I_{m+1}.
fn slope_of_scaled_bessel(z: f64, count: usize) -> Vec<f64> {
    if is_large(z, count) {
        return asymptotic(z, count, |power| -1.0 - 2.0 * power);
    }
    let values = by_recurrence(z, count + 1);
    (0..count).map(|m| z * (values[m.abs_diff(1)] - 2.0 * values[m] + values[m + 1])).collect()
}

/// Hankel's series needs z ≫ m² for all m; Miller's recurrence takes O(√z) steps.
fn is_large(z: f64, count: usize) -> bool {
    let order = count as f64;
    z > 100.0 + 25.0 * order * order
}

/// Miller's backward recurrence I_{m−1} = I_{m+1} + (2m/z) I_m, normalised by I_0 + 2 Σ I_m = e^z.
fn by_recurrence(z: f64, count: usize) -> Vec<f64> {
    // At higher orders I_m is below 1e-36 I_0.
    let start = 40 + (13.0 * z.sqrt()).ceil() as usize;
    let mut values = vec![0.0; count];
    // Upward the recurrence is unstable, since it amplifies the part of K_m; downward from an
    // arbitrary start it converges to the solution that decays with the order (J. C. P. Miller,
    // 1952; NIST DLMF § 3.6).
    let (mut above, mut here, mut sum) = (0.0, SMALL, 0.0);
    for m in (1..=start).rev() {
        if let Some(value) = values.get_mut(m) {
            *value = here;
        }
        sum += 2.0 * here;
        (above, here) = (here, above + (2.0 * m as f64 / z) * here);
        // The recurrence grows beyond the range of numbers: everything so far is scaled down together.
        if here > 1.0 / SMALL {
            (above, here, sum) = (above * SMALL, here * SMALL, sum * SMALL);
            values.iter_mut().take(start + 1).skip(m).for_each(|value| *value *= SMALL);
        }
    }
    values[0] = here;
    values.iter().map(|value| value / (sum + here)).collect()
}

/// Hankel's asymptotic series Σ_k `factor`(k) Π_{i ≤ k} ((2i − 1)² − 4m²)/(8 i z)/√(2πz).
fn asymptotic(z: f64, count: usize, factor: impl Fn(f64) -> f64) -> Vec<f64> {
    let value = |m: usize| {
        let square = 4.0 * (m * m) as f64;
        let (mut term, mut sum) = (1.0, factor(0.0));
        for i in 1..12 {
            let odd = f64::from(2 * i - 1);
            term *= (odd * odd - square) / (8.0 * f64::from(i) * z);
            sum += factor(f64::from(i)) * term;
        }
        sum / (2.0 * PI * z).sqrt()
    };
    (0..count).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The inverse transform of `of`(λ_column, λ_row) on tori of M² and 4M² places: what lies behind their edges counts as M⁻³, which
    /// the two together are free of.
    fn on_tori(m: usize, n: usize, of: impl Fn(f64, f64) -> f64) -> f64 {
        let on_torus = |places: usize| {
            let angle = |k: usize| PI * k as f64 / places as f64;
            let symbol: Vec<f64> = (0..places).map(|k| 4.0 * angle(k).sin().powi(2)).collect();
            let wave =
                |d: usize| -> Vec<f64> { (0..places).map(|k| (2.0 * angle(k * d % places)).cos()).collect() };
            let (down, along) = (wave(m), wave(n));
            let row = |i: usize| -> f64 { (0..places).map(|j| of(symbol[i], symbol[j]) * along[j]).sum() };
            -(0..places).map(|i| down[i] * row(i)).sum::<f64>() / (places * places) as f64
        };
        (8.0 * on_torus(2048) - on_torus(1024)) / 7.0
    }

    /// Weights of √Δ and of its part along rows.
    fn shares(sides: [usize; 2]) -> [Vec<f64>; 2] {
        [sqrt_laplacian(sides, &mut ()), row_share_of_sqrt_laplacian(sides, &mut ())].map(Result::unwrap)
    }

    #[test]
    fn the_monitor_stops_the_sum_over_times() {
        struct Stops;
        impl Monitor for Stops {
            fn progress(&mut self, _: f64) -> std::ops::ControlFlow<()> {
                std::ops::ControlFlow::Break(())
            }
        }
        assert_eq!(sqrt_laplacian([5, 5], &mut Stops), Err(crate::Error::Stopped));
        assert_eq!(row_share_of_sqrt_laplacian([5, 5], &mut Stops), Err(crate::Error::Stopped));
    }

    #[test]
    fn weights_are_those_of_the_inverse_transform() {
        let root = |down: f64, along: f64| (down + along).sqrt();
        let share = |down: f64, along: f64| if along > 0.0 { along / root(down, along) } else { 0.0 };
        let [all, rows] = shares([5, 10]);
        for (m, n) in [(0, 1), (1, 0), (1, 1), (0, 2), (2, 4), (4, 3)] {
            for (found, expected) in
                [(all[10 * m + n], on_tori(m, n, root)), (rows[10 * m + n], on_tori(m, n, share))]
            {
                // What lies behind the edges leaves r²M⁻⁵, and sums of 4M² terms their roundings.
                assert!((found - expected).abs() < 1e-14, "{m} {n}: {found} {expected}");
            }
        }
        assert_eq!([all[0], rows[0]], [0.0; 2]);
    }

    /// Rows and columns share √Δ, at any distance.
    #[test]
    fn shares_of_both_directions_add_up() {
        let side = 1000;
        let [all, rows] = shares([side; 2]);
        for (m, n) in [(0, 1), (3, 2), (0, 400), (999, 0), (999, 999), (700, 20)] {
            let [found, turned] = [(m, n), (n, m)].map(|(m, n)| rows[side * m + n]);
            let expected = all[side * m + n];
            // Roundings of Bessel functions are multiplied by z ≈ r² where the recurrence is used.
            let square = (m * m + n * n) as f64;
            assert!((found + turned - expected).abs() < 1e-15 * (1.0 + square) * expected, "{m} {n}");
            let far = (3.0 * (n * n) as f64 / square - 1.0) / (2.0 * PI * square.powf(1.5));
            // The next terms are some 10/r².
            assert!(square < 1e4 || (found - far).abs() < 10.0 / square * expected, "{m} {n}: {found} {far}");
        }
    }

    /// √λ = q − q³(3 + cos 4φ)/96 + …, whose inverse transform is 1/2πr³ + (9 + 35 cos 4θ)/64πr⁵ + O(r⁻⁷).
    #[test]
    fn far_away_weights_fall_with_the_cube() {
        let [weights, _] = shares([2000, 1500]);
        for (m, n) in [(0, 1499), (1999, 0), (700, 900), (1200, 1200), (1999, 1499)] {
            let square = (m * m + n * n) as f64;
            let angle = (m as f64).atan2(n as f64);
            let expected = 1.0 + (9.0 + 35.0 * (4.0 * angle).cos()) / (32.0 * square);
            let found = 2.0 * PI * square.powf(1.5) * weights[1500 * m + n];
            // The next term is some 10/r⁴.
            assert!((found - expected).abs() < 2e-11, "{m} {n}: {found} {expected}");
        }
    }

    #[test]
    fn both_ways_to_bessel_functions_meet() {
        for count in [2, 50, 300] {
            let z = 100.0 + 25.0 * (count * count) as f64;
            let (by_recurrence, series) = (by_recurrence(z, count), asymptotic(z, count, |_| 1.0));
            assert!(by_recurrence.iter().zip(&series).all(|(a, b)| (a / b - 1.0).abs() < 1e-13), "{count}");
            let [below, above] = [z, z.next_up()].map(|z| slope_of_scaled_bessel(z, count));
            assert!(is_large(z.next_up(), count) && !is_large(z, count));
            // The difference of three values with some ten roundings each loses as many digits as z has.
            assert!(below.iter().zip(&above).all(|(a, b)| (a / b - 1.0).abs() < 1e-14 * z), "{count}");
        }
    }
}
