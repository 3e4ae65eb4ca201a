//! Pulls over narrow distributions, which end anywhere: contacts break in clusters with nothing between them.

use std::sync::Arc;

use crate::common::{gaussian, master, point};
use asperity::exact::{self, ClosedForm as _};
use asperity::law::{SharedLaw, Tabulated};

#[test]
fn a_pull_that_ends_among_breaks_sees_them() {
    for variation in [1e-4, 1e-3, 1e-2] {
        let equation = master(&gaussian(1.0, variation), &point(0.0), &point(0.0));
        let closed = exact::Gaussian::new(1.0, variation);
        for cycles in [1, 2, 5_u32] {
            // Standard deviations of the place of a last break from its mean.
            for k in [-2, 0, 5_i32] {
                let spread = f64::from(cycles).sqrt() * variation;
                let distance = f64::from(cycles) + f64::from(k) * spread;
                let pull = equation.pull(distance).unwrap();
                let difference = (pull.force(distance) - closed.force(distance)).abs();
                // What is aimed at by default.
                assert!(difference < 1e-10, "{variation} at {distance}: {difference:e}");
                assert!(pull.error_estimate() < 1e-10, "{variation} at {distance}");
            }
        }
    }
}

/// Quantiles of a triangle of mean 1.
fn samples(variation: f64) -> SharedLaw {
    let half = 6f64.sqrt() * variation;
    let place = |p: f64| if p < 0.5 { (2.0 * p).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - p)).sqrt() };
    let samples: Vec<_> = (0..10).map(|i| 1.0 + half * place((f64::from(i) + 0.5) / 10.0)).collect();
    Arc::new(Tabulated::from_samples(&samples).unwrap())
}

#[test]
fn samples_of_any_width_are_as_accurate_as_laws() {
    for variation in [1e-4, 1e-3, 0.1] {
        let law = samples(variation);
        let pull = master(&law, &point(0.0), &point(0.0)).pull(5.0).unwrap();
        // A tenth of the default tolerance, as for other distributions.
        assert!(pull.error_estimate() < 1e-11, "{variation}: {:e}", pull.error_estimate());
        let (low, high) = (law.quantile(0.0), law.upper_quantile(0.0));
        for k in 1..=200_u32 {
            let x = 5.0 * f64::from(k) / 200.0;
            // All have broken as often, for the n-th time at nξ̄ in the mean.
            let times = (x / high).floor();
            if times == (x / low).floor() {
                let difference = (pull.force(x) - (x - times * law.mean())).abs();
                assert!(difference < 1e-11, "{variation} at {x}: {difference:e}");
            }
        }
    }
}
