//! Thresholds whose density rises without bound at 0, with breaks further up, where cells of all sizes meet.
//!
//! With 1/s² + P̂_c'/{s [1 − P̂_c]} the transform of F from rest, μ_n the moments of P_c, its expansion at s = 0 gives
//! F_k = μ₂/2μ₁ and ∫₀^∞ (F − F_k) dX = F_k² − μ₃/3μ₁: what F comes to, and all of its way there.

use std::sync::Arc;

use crate::common::{gamma, master, mixture, point, rectangular};
use asperity::law::{Series, SharedLaw};
use asperity::numerics::legendre::RULE;

/// What the solver promises.
const PROMISED: f64 = 1e-10;

/// A pull that is steady, to less than the promise, before its end.
fn agree(name: &str, thresholds: &SharedLaw, moments: [f64; 3], distance: f64) {
    let pull = master(thresholds, &point(0.0), &point(0.0)).pull_with(distance, PROMISED, &mut ()).unwrap();
    let kinetic = moments[1] / (2.0 * moments[0]);
    let error = (pull.force(distance) - kinetic).abs();
    assert!(error <= PROMISED, "{name}: F_k is off by {error:e}");
    // Panels that end on the breaks; what F has of powers 3/2 there is integrated to 1e-10 of panels this narrow.
    let panels = (100.0 * distance).round() as u32;
    let panel = |k: u32| {
        let low = 0.01 * f64::from(k);
        RULE.integrate(low, low + 0.01, |x| pull.force(x) - kinetic)
    };
    let error = (0..panels).map(panel).sum::<f64>() - (kinetic * kinetic - moments[2] / (3.0 * moments[0]));
    assert!(error.abs() <= PROMISED * distance, "{name}: ∫(F − F_k) is off by {error:e}");
    for k in 1..=20_u32 {
        let position = distance * (0.618_033_988_749_895 * f64::from(k)).fract();
        let lost = (pull.total_probability(position) - 1.0).abs();
        assert!(lost <= PROMISED, "{name}: {lost:e} of the contacts are lost at X = {position}");
    }
}

#[test]
fn a_beta_law_made_of_its_density() {
    let density = |x: &[f64]| Ok(x.iter().map(|x| 0.75 * (1.0 - x) / x.sqrt()).collect());
    let law = Series::resolve(density, &[0.0, 1.0], 1e-14).unwrap().0;
    // μ_n of Beta(½, 2).
    agree("beta", &(Arc::new(law) as SharedLaw), [0.2, 3.0 / 35.0, 1.0 / 21.0], 10.0);
}

#[test]
fn a_gamma_law_with_a_rectangle() {
    let law = mixture(&[(0.5, gamma(1.0, 2.0_f64.sqrt())), (0.5, rectangular(0.5, 1.5))]);
    // Those of shape ½ and scale 2, 1, 3 and 15, with those of the rectangle.
    agree("gamma and rectangle", &law, [1.0, 0.5 * (3.0 + 13.0 / 12.0), 0.5 * (15.0 + 1.25)], 80.0);
}

/// P(G ≤ x), G of the gamma law of this shape, half a whole number, and scale 1: up from erf or e^{−x} by
/// P(a + 1, x) = P(a, x) − x^a e^{−x}/Γ(a + 1).
fn gamma_below(halves: u32, x: f64) -> f64 {
    let (first, below) = if halves % 2 == 1 { (1, libm::erf(x.sqrt())) } else { (2, -(-x).exp_m1()) };
    let term = |halves: u32| {
        let shape = 0.5 * f64::from(halves);
        x.powf(shape) * (-x).exp() / libm::tgamma(shape + 1.0)
    };
    below - (first..halves).step_by(2).map(term).sum::<f64>()
}

/// F of thresholds that are `at` with probability 1 − p, else from the gamma law of shape ½ and scale 2, when the n-th
/// break is at T_n, a sum of n thresholds: F = X − Σ_n E[ξ_n; T_n ≤ X], of each kind a share n-th of its part of T_n.
fn onset_and_point(p: f64, at: f64, position: f64) -> f64 {
    let most = (position / at).floor() as u32 + 60;
    let mut lost = 0.0;
    for n in 1..=most {
        let mut chance = (1.0 - p).powi(n as i32);
        for drawn in 0..=n {
            let fixed = f64::from(n - drawn) * at;
            let left = 0.5 * (position - fixed);
            if left >= 0.0 {
                let below = |more: u32| if drawn == 0 { 1.0 } else { gamma_below(drawn + more, left) };
                let share = fixed * below(0) + f64::from(drawn) * if drawn == 0 { 0.0 } else { below(2) };
                lost += chance * share / f64::from(n);
            }
            chance *= p / (1.0 - p) * f64::from(n - drawn) / f64::from(drawn + 1);
        }
    }
    position - lost
}

#[test]
fn a_gamma_law_with_a_point() {
    let (p, at, distance) = (0.5, 0.3, 2.0);
    let law = mixture(&[(p, gamma(1.0, 2.0_f64.sqrt())), (1.0 - p, point(at))]);
    let pull = master(&law, &point(0.0), &point(0.0)).pull_with(distance, PROMISED, &mut ()).unwrap();
    for k in 1..=200_u32 {
        let position = distance * (0.618_033_988_749_895 * f64::from(k)).fract();
        let error = (pull.force(position) - onset_and_point(p, at, position)).abs();
        assert!(error <= PROMISED, "off by {error:e} at X = {position}");
    }
}
