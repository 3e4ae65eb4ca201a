//! The response of the force to the probability of single thresholds, and its adjoint, against closed forms, reference
//! values and differences of F.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::{equation, exponential, gaussian, mixture, point, rectangular};
use asperity::contacts::{Contacts, Initial, Rules, Start, Stiffness};
use asperity::law::SharedLaw;
use asperity::master::{MasterEquation, Pull};

fn pull(thresholds: &SharedLaw, reforming: &SharedLaw, initial: &SharedLaw, start: Start) -> Pull {
    pull_to(6.0, [thresholds, reforming, initial], start)
}

fn pull_to(distance: f64, [thresholds, reforming, initial]: [&SharedLaw; 3], start: Start) -> Pull {
    equation(thresholds, reforming, initial, start).pull_with(distance, None, &mut ()).unwrap()
}

/// Points and weights of ∫ over [low, high], which is cut into `parts`, by the three-point Gauss rule.
fn quadrature(low: f64, high: f64, parts: u32) -> impl Iterator<Item = (f64, f64)> {
    let half = 0.5 * (high - low) / f64::from(parts);
    let place = half * 0.6_f64.sqrt();
    (0..parts).flat_map(move |k| {
        let middle = low + f64::from(2 * k + 1) * half;
        [(-place, 5.0), (0.0, 8.0), (place, 5.0)].map(|(by, weight)| (middle + by, half * weight / 9.0))
    })
}

/// For exponential thresholds of mean 1 that start at 0 Γ = 1 and F = 1 − e^{−X}, so that (δ + Γ)∗(h_ξ − F) is X²/2 before ξ
/// and ξ²/2 − ξ after it. 1e-12: F is accurate to 1e-13 at forces of order 1, and X²/2 is up to 18.
#[test]
fn the_response_of_exponential_thresholds_has_a_closed_form() {
    let zero = point(0.0);
    let pull = pull(&exponential(1.0), &zero, &zero, Start::Conditional);
    let thresholds = [0.0, 0.3, 1.0, 2.5, 5.0, 9.0];
    let response = pull.threshold_response(&thresholds).unwrap();
    assert!(response.thresholds().eq(thresholds));
    for (k, xi) in thresholds.into_iter().enumerate() {
        for x in (0..=60).map(|k| 0.1 * f64::from(k)) {
            let exact = if x < xi - 1e-9 { 0.5 * x * x } else { 0.5 * xi * xi - xi };
            let apart = response.at(k, x) - exact;
            assert!(apart.abs() < 1e-12, "{xi} {x}: {apart:e}");
        }
    }
}

/// ∂F/∂θ = ∫ δF/δP_c ∂P_c/∂θ dξ, against the reference values of the derivatives by mean and standard deviation, which do
/// not come from this program.
#[test]
fn the_chain_rule_gives_the_reference_derivatives() {
    let (zero, std) = (point(0.0), 0.1);
    let pull = pull(&gaussian(1.0, std), &zero, &zero, Start::Conditional);
    let reference: [(f64, f64, f64); 4] = [
        (0.9, 2.019_081_266_741_01, -1.935_765_796_154_14),
        (1.0, 3.489_422_804_052_74, 0.398_942_280_209_465),
        (2.18, 0.837_341_728_593_106, 2.587_464_703_472_09),
        (5.45, -2.993_260_341_279_3, 0.537_615_737_649_29),
    ];
    for (x, by_mean, by_std) in reference {
        // Contacts break at X = ξ. Beyond nine standard deviations 1e-18 of the thresholds are left out.
        let middle = x.min(1.9);
        let points = quadrature(0.1, middle, 200).chain(quadrature(middle, 1.9, 200)).collect::<Vec<_>>();
        let thresholds: Vec<f64> = points.iter().map(|point| point.0).collect();
        let response = pull.threshold_response(&thresholds).unwrap();
        let mut sums = [0.0; 2];
        for (k, (xi, weight)) in points.into_iter().enumerate() {
            let z = (xi - 1.0) / std;
            let term = weight * (-0.5 * z * z).exp() / ((2.0 * PI).sqrt() * std) * response.at(k, x);
            sums[0] += term * z / std;
            sums[1] += term * (z * z - 1.0) / std;
        }
        let apart = [sums[0] - by_mean, sums[1] - by_std];
        assert!(apart.iter().all(|apart| apart.abs() < 1e-10), "{x}: {sums:?}");
    }
}

/// With starting stretches that are spread, the response is a smooth function of the threshold. Its mean is 0, and the chain
/// rule gives the gradients, which are computed from the derivatives of the lives instead. 1e-10: errors of F of 1e-13 and
/// derivatives of P_c of up to 10².
#[test]
fn the_chain_rule_holds_for_spread_starts() {
    let (law, narrow, wide) = (gaussian(1.0, 0.15), gaussian(0.1, 0.03), gaussian(0.2, 0.04));
    for start in [Start::Conditional, Start::Relaxed] {
        let pull = pull(&law, &narrow, &wide, start);
        let points: Vec<_> = quadrature(0.0, 2.35, 300).collect();
        let thresholds: Vec<f64> = points.iter().map(|point| point.0).collect();
        let response = pull.threshold_response(&thresholds).unwrap();
        let gradients = pull.gradients(&["thresholds.mean", "thresholds.std"]).unwrap();
        for x in [0.3, 0.9, 1.57, 2.9, 5.1] {
            let (mut mean, mut sums) = (0.0, [0.0; 2]);
            for (k, (xi, weight)) in points.iter().enumerate() {
                let z = (xi - 1.0) / 0.15;
                let term = weight * (-0.5 * z * z).exp() / ((2.0 * PI).sqrt() * 0.15) * response.at(k, x);
                mean += term;
                sums[0] += term * z / 0.15;
                sums[1] += term * (z * z - 1.0) / 0.15;
            }
            let apart = [0, 1].map(|k| (sums[k] - gradients[k].at(x)).abs());
            // The tolerance of gradients and responses.
            assert!(mean.abs() < 1e-10 && apart.iter().all(|&a| a < 1e-10), "{x}: {mean:e} {apart:?}");
        }
    }
}

/// The response is the derivative of F with thresholds (1 − ε)P_c + ε δ(x_s − ξ) by ε. One-sided differences of fourth order
/// over ε = 2e-3 have a truncation of ε⁴/5 times the fifth derivative, up to 10³ after five breaks: 3e-9. The errors of F are
/// those that it estimates, 1e-13 but for point masses among overlapping starts.
#[test]
fn the_response_is_a_derivative_of_the_force() {
    let (zero, wide) = (point(0.0), rectangular(0.05, 0.35));
    let (narrow, apart) = (gaussian(0.1, 0.03), mixture(&[(0.3, point(0.1)), (0.7, gaussian(0.3, 0.05))]));
    let smooth = gaussian(1.0, 0.15);
    let broad = gaussian(0.6, 0.2);
    let edged = rectangular(0.6, 1.4);
    let pointed = mixture(&[(0.4, point(0.9)), (0.6, gaussian(1.0, 0.1))]);
    let (held, relaxed) = (Start::Conditional, Start::Relaxed);
    for (thresholds, reforming, initial, start) in [
        (&smooth, &zero, &zero, held),
        (&smooth, &narrow, &narrow, held),
        (&smooth, &point(0.2), &zero, held),
        (&smooth, &zero, &wide, held),
        (&smooth, &wide, &narrow, held),
        (&broad, &wide, &apart, held),
        (&broad, &narrow, &wide, relaxed),
        (&broad, &zero, &gaussian(0.5, 0.2), relaxed),
        (&edged, &narrow, &zero, held),
        (&edged, &zero, &wide, relaxed),
        (&pointed, &zero, &zero, held),
        (&pointed, &wide, &apart, held),
    ] {
        let thresholds_added = [0.21, 0.73, 1.02, 1.7];
        let found = apart_from_differences(thresholds_added, [thresholds, reforming, initial], start);
        for (xi, apart) in thresholds_added.into_iter().zip(found) {
            // A threshold among starting stretches, with a point mass of thresholds: the limit that is documented.
            let limited = xi < 0.3 && Arc::ptr_eq(thresholds, &pointed) && !Arc::ptr_eq(reforming, &zero);
            let tolerance = if limited { 5e-6 } else { 1e-8 };
            assert!(apart < tolerance, "{xi} {thresholds:?} {reforming:?} {initial:?} {start:?}: {apart:e}");
        }
    }
}

/// For each threshold, the largest distance of the response from differences, less what the estimated errors of F explain.
fn apart_from_differences(added: [f64; 4], laws: [&SharedLaw; 3], start: Start) -> [f64; 4] {
    /// Just beyond the last position.
    const DISTANCE: f64 = 2.6;
    let step = 2e-3;
    let [thresholds, reforming, initial] = laws;
    let base = pull_to(DISTANCE, laws, start);
    let response = base.threshold_response(&added).unwrap();
    let weights: [f64; 4] = [4.0, -3.0, 4.0 / 3.0, -0.25];
    std::array::from_fn(|i| {
        let others = [1.0, 2.0, 3.0, 4.0].map(|k| {
            let law = mixture(&[(1.0 - k * step, thresholds.clone()), (k * step, point(added[i]))]);
            pull_to(DISTANCE, [&law, reforming, initial], start)
        });
        let errors: f64 = weights.iter().zip(&others).map(|(w, pull)| w.abs() * pull.error_estimate()).sum();
        let apart = |k: u32| {
            let x = 0.0637 * f64::from(k);
            let difference: f64 =
                weights.iter().zip(&others).map(|(w, pull)| w * (pull.force(x) - base.force(x))).sum();
            (response.at(i, x) - difference / step).abs()
        };
        (1..=40).map(apart).fold(0.0, f64::max) - (errors + 25.0 / 12.0 * base.error_estimate()) / step
    })
}

/// The adjoint against λ(u) = Σ w_i [δ(u − X_i) + Γ(X_i − u)], the renewal equation read backwards, integrated with h_ξ − F
/// here. 1e-10: F and Γ are accurate to 1e-12, and w and λ are of order 1.
#[test]
fn the_adjoint_is_the_renewal_equation_read_backwards() {
    let zero = point(0.0);
    let pull = pull(&gaussian(1.0, 0.2), &zero, &zero, Start::Conditional);
    let (positions, weights) = ([4.7, 0.6, 1.3, 3.1], [0.7, -1.2, 0.4, 1.0]);
    let thresholds = [0.4, 0.9, 1.1, 2.0];
    let found = pull.threshold_sensitivity(&positions, &weights, &thresholds).unwrap();
    for (xi, found) in thresholds.into_iter().zip(found) {
        let change = |u: f64| if u < xi { u } else { pull.force(u - xi) } - pull.force(u);
        let mut sum = 0.0;
        for (x, weight) in positions.into_iter().zip(weights) {
            sum += weight * change(x);
            let middle = xi.min(x);
            let points = quadrature(0.0, middle, 800).chain(quadrature(middle, x, 800));
            sum += weight * points.map(|(u, w)| w * pull.breaking_rate(x - u) * change(u)).sum::<f64>();
        }
        // The tolerance of responses; 800 Gauss points have less.
        assert!((found - sum).abs() < 1e-10, "{xi}: {found} {sum}");
    }
}

/// The derivative of a sum of squares of deviations, and that of F_s, whose position moves without effect at first order.
/// Differences as above.
#[test]
fn the_adjoint_is_the_derivative_of_a_scalar() {
    let (law, narrow, zero, step) = (gaussian(1.0, 0.15), gaussian(0.1, 0.03), point(0.0), 2e-3);
    let positions: Vec<f64> = (1..=50).map(|k| 0.07 * f64::from(k)).collect();
    let misfit = |pull: &Pull| -> f64 {
        positions.iter().map(|&x| 0.5 * (pull.force(x) - 0.4 * x.sqrt()).powi(2)).sum()
    };
    let base = pull(&law, &narrow, &zero, Start::Conditional);
    let residuals: Vec<f64> = positions.iter().map(|&x| base.force(x) - 0.4 * x.sqrt()).collect();
    let peak = base.static_friction().unwrap();
    // Where thresholds of X_s = 0.8 are added, F jumps down at its maximum.
    for xi in [0.6, 1.05, 1.3] {
        let mixed = [1.0, 2.0, 3.0, 4.0].map(|k| {
            let law = mixture(&[(1.0 - k * step, law.clone()), (k * step, point(xi))]);
            pull(&law, &narrow, &zero, Start::Conditional)
        });
        let difference = |of: &dyn Fn(&Pull) -> f64| {
            let [a, b, c, d] = mixed.each_ref().map(|pull| of(pull) - of(&base));
            (4.0 * a - 3.0 * b + 4.0 / 3.0 * c - 0.25 * d) / step
        };
        let by_misfit = base.threshold_sensitivity(&positions, &residuals, &[xi]).unwrap()[0];
        let by_peak = base.threshold_sensitivity(&[peak.position], &[1.0], &[xi]).unwrap()[0];
        let exact = [difference(&misfit), difference(&|pull| pull.static_friction().unwrap().value)];
        // Fifth derivatives of the sum of 50 squares are larger.
        assert!((by_misfit - exact[0]).abs() < 1e-7, "{xi}: {by_misfit} {}", exact[0]);
        assert!((by_peak - exact[1]).abs() < 1e-8, "{xi}: {by_peak} {}", exact[1]);
    }
}

/// Forces are totals of N_c⟨k⟩; contacts without such a response, and arguments out of range, are refused.
#[test]
fn responses_are_scaled_and_limits_are_reported() {
    let plain = Contacts::new(gaussian(1.0, 0.15), point(0.0));
    let solve = |contacts: &Contacts, velocity: f64| {
        MasterEquation::at(contacts.clone(), &Initial::default(), velocity).unwrap().pull(2.0).unwrap()
    };
    let pull = solve(&plain, 1.0);
    let many = Contacts { count: 30.0, stiffness: Stiffness::Equal(2.0), ..plain.clone() };
    let one = pull.threshold_response(&[1.1]).unwrap().at(0, 1.5);
    let all = solve(&many, 1.0).threshold_response(&[1.1]).unwrap().at(0, 1.5);
    assert!((all - 60.0 * one).abs() < 1e-12 * all.abs());
    let refusal =
        |contacts: &Contacts| solve(contacts, 0.5).threshold_response(&[1.0]).unwrap_err().to_string();
    let delayed = Contacts { rules: Rules { delay: 0.2.into(), ..Rules::default() }, ..plain.clone() };
    let strong = Contacts { stiffness: Stiffness::PerThreshold(1.0), ..plain };
    assert!(refusal(&delayed).contains("delay") && refusal(&strong).contains("per_threshold"));
    let wrong = |positions: &[f64], weights: &[f64], thresholds: &[f64]| {
        pull.threshold_sensitivity(positions, weights, thresholds).unwrap_err().to_string()
    };
    assert!(wrong(&[1.0], &[1.0], &[-0.1]).contains("thresholds"));
    assert!(wrong(&[1.0], &[1.0], &[f64::NAN]).contains("thresholds"));
    assert!(wrong(&[1.0, 2.0], &[1.0], &[1.0]).contains("weights"));
    assert!(wrong(&[2.1], &[1.0], &[1.0]).contains("positions"));
    assert!(wrong(&[-0.1], &[1.0], &[1.0]).contains("positions"));
    assert_eq!(pull.threshold_sensitivity(&[], &[], &[1.0]).unwrap(), [0.0]);
}
