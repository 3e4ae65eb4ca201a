//! The noise of steady sliding: autocovariance and spectrum against closed forms and each other.

use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

use crate::common::{equation, exponential, gaussian, mixture, point, rectangular};
use asperity::contacts::Start;
use asperity::law::{Law, SharedLaw};
use asperity::master::SteadyState;

fn steady(thresholds: &SharedLaw, reforming: &SharedLaw) -> SteadyState {
    equation(thresholds, reforming, reforming, Start::Conditional).steady_state()
}

/// Reference values of P_c = G(1, 0.1), R = δ₀, to the digits given.
#[test]
fn gaussian_thresholds_have_their_reference_values() {
    let steady = steady(&gaussian(1.0, 0.1), &point(0.0));
    let found = steady.autocovariance_with(&[0.3, 1.0, 2.0], 1.0, 1e-11, &mut ()).unwrap();
    for (found, expected) in
        found.iter().zip([-0.018_191_666_666_67, 0.048_414_105_293_18, 0.036_889_374_907_04])
    {
        assert!((found - expected).abs() < 1e-11);
    }
    let (at, expected) = (
        [0.0, 0.1, 6.0, TAU, 12.0],
        [
            0.002_500_25,
            0.002_500_944_675_694_55,
            0.098_233_785_703_047_9,
            0.257_735_651_999_481,
            0.013_872_925_865_801_1,
        ],
    );
    let found = steady.spectrum(&at, 1.0).unwrap();
    for (found, expected) in found.iter().zip(expected) {
        // The default tolerance of the spectrum.
        assert!((found / expected - 1.0).abs() < 1e-10);
    }
}

/// The errors stated in the documentation, times three.
#[test]
fn spectra_have_their_reference_values_at_small_and_large_wave_numbers() {
    let mut seen = 0;
    for line in include_str!("../tables/spectrum.csv").lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        let &[mean, std, start, spread, q, expected] = &row[..] else { panic!("a row of six numbers") };
        let reforming = if spread > 0.0 { gaussian(start, spread) } else { point(start) };
        let found = steady(&gaussian(mean, std), &reforming).spectrum(&[q], 1.0).unwrap()[0];
        let (advance, scatter) = (mean - start, std.hypot(spread) / (mean - start));
        let stated = f64::max(1e-13, 1e-16 / scatter.powi(2)) * f64::max(1.0, q * advance / 100.0);
        let error = found / expected - 1.0;
        assert!(
            error.abs() < 3.0 * stated,
            "{line}: off by {error:e}, {:.1} of {stated:e}",
            error.abs() / stated
        );
        seen += 1;
    }
    assert!(seen > 40, "{seen} rows");
}

/// c(u) = m² e^{−u/m} and S(q) = 2m³/(1 + q²m²): the force is the time since the last event of a Poisson process.
#[test]
fn exponential_thresholds_have_a_closed_form() {
    let mean = 0.6;
    let steady = steady(&exponential(mean), &point(0.0));
    let advances: Vec<f64> = (0..30).map(|k| 0.2 * f64::from(k)).collect();
    let found = steady.autocovariance_with(&advances, 1.0, 1e-12, &mut ()).unwrap();
    for (u, found) in advances.iter().zip(found) {
        assert!((found - mean * mean * (-u / mean).exp()).abs() < 1e-12, "{u}");
    }
    let at: Vec<f64> = (0..60).map(|k| 1e-3 * 1.3_f64.powi(k)).collect();
    for (q, found) in at.iter().zip(steady.spectrum(&at, 1.0).unwrap()) {
        let exact = 2.0 * mean.powi(3) / (1.0 + (q * mean).powi(2));
        assert!((found / exact - 1.0).abs() < 1e-9, "{q}: {:e}", found / exact - 1.0);
    }
}

/// Re-forming at spread stretches below all thresholds, where start and threshold are independent: all expectations
/// over one life follow from the closed transforms of R and P_c. At q = 0.3 the terms of this sum are 10³ times
/// their sum: 1e-9.
#[test]
fn spectra_of_spread_starts_follow_from_one_life() {
    let smooth = gaussian(1.0, 0.08);
    let mixed = mixture(&[(0.4, point(0.9)), (0.6, smooth.clone())]);
    for (thresholds, reforming) in [
        (smooth, gaussian(0.15, 0.02)),
        (rectangular(0.7, 1.2), rectangular(0.0, 0.4)),
        (mixed, rectangular(0.05, 0.25)),
    ] {
        let steady = steady(&thresholds, &reforming);
        for q in [0.3, 1.0, 4.0, TAU, 20.0] {
            let found = steady.spectrum(&[q], 1.0).unwrap()[0];
            let exact = of_one_life(thresholds.as_ref(), reforming.as_ref(), q);
            assert!((found / exact - 1.0).abs() < 1e-9, "{q}: {found} {exact}");
        }
    }
}

/// S(q) from the expectations over one life.
fn of_one_life(thresholds: &dyn Law, reforming: &dyn Law, q: f64) -> f64 {
    // E e^{sx} and E x e^{sx}, the latter by a central difference of eighth order.
    let transforms = |law: &dyn Law, s: Complex64| {
        let at = |k: f64| law.laplace(-s - k * 0.01) - law.laplace(-s + k * 0.01);
        let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
        let slope: Complex64 = (1..).zip(weights).map(|(k, weight)| weight * at(f64::from(k)) / 0.01).sum();
        (law.laplace(-s), slope)
    };
    let s = Complex64::new(0.0, q);
    let ((threshold, by_threshold), (start, by_start)) =
        (transforms(thresholds, s), transforms(reforming, -s));
    let (x, r) = (thresholds.mean(), reforming.mean());
    let [g, gr, gx, grx] =
        [threshold * start, threshold * by_start, by_threshold * start, by_threshold * by_start];
    let (alpha, beta) = (gr - x * g, r * g - gx);
    let gamma = r * gr - grx - x * r * g + x * gx;
    let second = thresholds.upper_moment(2, -1.0) + reforming.upper_moment(2, -1.0) - 2.0 * r * x;
    (second + 2.0 * (gamma + alpha * beta / (1.0 - g)).re) / (q * q * (x - r))
}

/// ∫S dq = 2π c(0), and S(0) is 2∫c du.
#[test]
fn the_spectrum_integrates_to_the_variance() {
    let steady = steady(&gaussian(1.0, 0.2), &gaussian(0.15, 0.05));
    let width = 0.02;
    let at: Vec<f64> = (0..=20_000).map(|k| width * f64::from(k)).collect();
    let spectrum = steady.spectrum(&at, 1.0).unwrap();
    let simpson = |i: usize| {
        if i == 0 || i + 1 == at.len() {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    let sum: f64 = spectrum.iter().enumerate().map(|(i, s)| simpson(i) * s * width / 3.0).sum();
    // What lies beyond falls as 1/q².
    let last = at[at.len() - 1];
    let total = 2.0 * (sum + spectrum[at.len() - 1] * last);
    let variance = steady.force_std(1.0).powi(2);
    assert!((total / (2.0 * PI * variance) - 1.0).abs() < 1e-7);
    let advances: Vec<f64> = (0..=6000).map(|k| 0.005 * f64::from(k)).collect();
    let c = steady.autocovariance_with(&advances, 1.0, 1e-12, &mut ()).unwrap();
    let weight = |i: usize| {
        if i == 0 || i == 6000 {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    let sum: f64 = c.iter().enumerate().map(|(i, c)| weight(i) * c * 0.005 / 3.0).sum();
    // Simpson's rule at a spacing of 0.005: its error is of fourth order, 1e-9 times derivatives of order 10.
    assert!((2.0 * sum / spectrum[0] - 1.0).abs() < 1e-8);
    assert!((c[0] / variance - 1.0).abs() < 1e-14);
}

/// The spectrum of identical contacts consists of lines, and is refused with that reason; their autocovariance is not.
#[test]
fn identical_contacts_have_lines() {
    let steady = steady(&point(1.0), &point(0.0));
    let error = steady.spectrum(&[1.0], 1.0).unwrap_err().to_string();
    assert!(error.contains("lines"), "{error}");
    // A sawtooth of random phase: c(u) = 1/12 − u(1 − u)/2.
    let c = steady.autocovariance_with(&[0.0, 0.25, 0.5, 1.25, 7.5], 1.0, 1e-12, &mut ()).unwrap();
    for (c, u) in c.iter().zip([0.0, 0.25, 0.5, 0.25, 0.5_f64]) {
        assert!((c - (1.0 / 12.0 - 0.5 * u * (1.0 - u))).abs() < 1e-12, "{u} {c}");
    }
}

/// c(u) = −Σ_j e^{s_j u}/s_j² over the relaxation spectrum, since c' = F₀ − F_k = −Σ_j e^{s_j u}/s_j. Roots come in
/// conjugate pairs; at u ≥ 2 those beyond the first ten pairs are below 1e-11. The truncation of the thresholds at 0 is
/// negligible: the jump of a density there has roots of its own.
#[test]
fn the_autocovariance_is_a_sum_over_the_relaxation_spectrum() {
    let zero = point(0.0);
    let law = gaussian(1.0, 0.2);
    let steady = steady(&law, &zero);
    let equation = equation(&law, &zero, &zero, Start::Conditional);
    let relaxation = equation.relaxation().unwrap();
    let advances = [2.0, 2.5, 3.1, 4.0];
    let found = steady.autocovariance(&advances, 1.0).unwrap();
    for (u, found) in advances.into_iter().zip(found) {
        let upper = relaxation.roots().iter().filter(|s| s.im > 0.0).take(10);
        let sum: f64 = upper.map(|s| -2.0 * ((s * u).exp() / (s * s)).re).sum();
        assert!((found - sum).abs() < 1e-9, "{u}: {found} is not {sum}");
    }
}

/// c(0) = ⟨ξ³⟩/3⟨ξ⟩ − F_k² with F_k = ⟨ξ²⟩/2⟨ξ⟩, and c' = F₀ − F_k with the first loading curve F₀ in closed form,
/// where contacts re-form at 0. Differences of fourth order over 0.002 of an autocovariance accurate to 1e-12 have an
/// error of 1e-9; edges of rectangular thresholds are kinks of F₀, between which no difference is taken.
#[test]
fn the_slope_of_the_autocovariance_is_the_first_loading_curve() {
    use asperity::exact::{ClosedForm, Gaussian, Rectangular};
    let zero = point(0.0);
    let smooth: (SharedLaw, Box<dyn ClosedForm>) = (gaussian(1.0, 0.1), Box::new(Gaussian::new(1.0, 0.1)));
    let edges: (SharedLaw, Box<dyn ClosedForm>) =
        (rectangular(0.7, 1.2), Box::new(Rectangular { min: 0.7, max: 1.2 }));
    for (law, curve) in [smooth, edges] {
        let steady = steady(&law, &zero);
        let [mean, second, third] = [1, 2, 3].map(|order| law.upper_moment(order, -1.0));
        let friction = 0.5 * second / mean;
        let variance = steady.autocovariance_with(&[0.0], 1.0, 1e-12, &mut ()).unwrap()[0];
        assert!((variance - (third / (3.0 * mean) - friction * friction)).abs() < 1e-12);
        let step = 0.002;
        for k in 0..100 {
            let u = 0.01 + 0.0347 * f64::from(k);
            let kinks = (1..=5).flat_map(|n| [0.7 * f64::from(n), 1.2 * f64::from(n)]);
            if kinks.into_iter().any(|kink| (u - kink).abs() < 3.0 * step) {
                continue;
            }
            let at = [-2.0, -1.0, 1.0, 2.0].map(|k| u + k * step);
            let c = steady.autocovariance_with(&at, 1.0, 1e-12, &mut ()).unwrap();
            let slope = (8.0 * (c[2] - c[1]) - (c[3] - c[0])) / (12.0 * step);
            // The truncation is step⁴/30 times the fourth derivative of F₀, of the order of 10⁴.
            assert!((slope - (curve.force(u) - friction)).abs() < 1e-8, "{u}: {slope}");
        }
    }
}

/// Free contacts have no stretch, and the stiffness of contacts with k = κ x_s changes at a break: no noise is known.
#[test]
fn the_noise_of_contacts_that_do_not_renew_completely_is_refused() {
    use asperity::contacts::{Contacts, Initial, Stiffness};
    use asperity::master::MasterEquation;
    let plain = Contacts::new(gaussian(1.0, 0.1), point(0.0));
    let (mut free, mut strong) = (plain.clone(), plain);
    free.rules.delay = 0.5.into();
    strong.stiffness = Stiffness::PerThreshold(1.2);
    let free = MasterEquation::at(free, &Initial::default(), 1.0).unwrap();
    let strong = MasterEquation::new(strong, &Initial::default()).unwrap();
    for (equation, reason) in [(free, "delay"), (strong, "equal stiffness")] {
        let steady = equation.steady_state();
        let errors = [
            steady.autocovariance(&[1.0], 1.0).unwrap_err(),
            steady.spectrum(&[1.0], 1.0).unwrap_err(),
            steady.noise_at_zero(1.0).unwrap_err(),
            steady.spectrum_tail(1.0).unwrap_err(),
        ];
        assert!(errors.iter().all(|error| error.to_string().contains(reason)), "{errors:?}");
    }
}
