//! The paper's stepping: how wrong its readings of Eq. (2) are, and how fast they converge.

use crate::common::{gaussian, point};
use asperity::exact::{ClosedForm, Gaussian};
use asperity::master::{Stepping, Variant};

/// The largest mean stretch that steps of this size reach, and the one at the end.
fn stepped(start: (f64, f64), step: f64, distance: f64, variant: Variant) -> (f64, f64) {
    let initial = if start.1 > 0.0 { gaussian(start.0, start.1) } else { point(start.0) };
    let mut stepping = Stepping::new(gaussian(1.0, 0.05).as_ref(), initial.as_ref(), step, variant);
    let mut most = 0.0_f64;
    for _ in 0..(distance / step).round() as usize {
        stepping.advance();
        most = most.max(stepping.force().abs());
    }
    assert!((stepping.position() - distance).abs() < 1e-9);
    (most, stepping.force())
}

/// F(5) of Fig. 2, truncated laws.
const FIGURE_2: f64 = 0.297_307_166;

#[test]
fn the_working_variant_is_off_as_the_theory_says() {
    for (step, percent) in [(1e-2, -14.8), (1e-3, -1.55)] {
        let (_, force) = stepped((0.1, 0.025), step, 5.0, Variant::Shifted);
        let error = 100.0 * (force / FIGURE_2 - 1.0);
        // Half a unit of the last digit given.
        assert!((error - percent).abs() < if percent < -10.0 { 0.05 } else { 0.005 }, "{step}: {error} %");
    }
}

#[test]
fn the_printed_equation_is_unstable() {
    // A stretch cannot exceed the highest threshold, about 1.4; P ΔX > 1 in the tail makes fractions negative and grow.
    let (most, _) = stepped((0.1, 0.025), 1e-2, 5.0, Variant::Literal);
    assert!(most > 10.0, "{most}");
    // The same steps of the shifted Q stay where stretches can be.
    assert!(stepped((0.1, 0.025), 1e-2, 5.0, Variant::Shifted).0 < 1.0);
}

#[test]
fn no_contact_is_lost_or_negative() {
    for variant in [Variant::Shifted, Variant::SurvivalRatio, Variant::Upwind] {
        let initial = gaussian(0.1, 0.025);
        let mut stepping = Stepping::new(gaussian(1.0, 0.05).as_ref(), initial.as_ref(), 0.01, variant);
        for _ in 0..1000 {
            stepping.advance();
            let total: f64 = stepping.fractions().iter().sum();
            // A thousand steps of rounding.
            assert!((total - 1.0).abs() < 1e-12, "{variant:?}: {total}");
            assert!(stepping.fractions().iter().all(|&q| q >= 0.0), "{variant:?}");
        }
    }
}

#[test]
fn orders_of_convergence() {
    let exact = Gaussian::new(1.0, 0.05).starting_from(0.4, 0.05);
    let error = |variant, step| stepped((0.4, 0.05), step, 2.0, variant).1 - exact.force(2.0);
    for (variant, order) in [(Variant::Shifted, 1.0), (Variant::Upwind, 1.0), (Variant::SurvivalRatio, 2.0)] {
        let [coarse, fine] = [1.0 / 1024.0, 1.0 / 2048.0].map(|step| error(variant, step));
        let measured = (coarse / fine).log2();
        // The next order still shows at steps of a fiftieth of σ.
        assert!((measured - order).abs() < 0.1, "{variant:?}: order {measured} ({coarse:e}, {fine:e})");
    }
}
