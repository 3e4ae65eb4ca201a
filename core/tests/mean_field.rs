//! The steady closure: closed moments between Gaussians, and the equation itself for other laws.

mod common;

use std::sync::Arc;

use asperity::contacts::{Ageing, Closure, Contacts, ThresholdFokkerPlanck};
use asperity::law::{Gamma, Lognormal, Mixture, Point, Rectangular, SharedLaw};
use asperity::life::moving;
use common::gaussian;

/// ⟨h²⟩/(2⟨h⟩) of the law between Gaussians, whose moments are closed; masses below 0 are kept.
fn closed(newborn: (f64, f64), mature: (f64, f64), velocity_over_rate: f64) -> f64 {
    let ((newborn, newborn_std), (mature, mature_std)) = (newborn, mature);
    let gap = mature - velocity_over_rate;
    let mean = 0.5 * (gap + (gap * gap + 4.0 * newborn * velocity_over_rate).sqrt());
    let ratio = mean / velocity_over_rate;
    let first = (newborn - mature) / (1.0 + ratio);
    let second = (newborn_std.powi(2) + (newborn - mature).powi(2) + 2.0 * ratio * mature_std.powi(2))
        / (1.0 + 2.0 * ratio);
    (second + 2.0 * mature * first + mature * mature) / (2.0 * mean)
}

fn kinetic_friction(newborn: SharedLaw, mature: SharedLaw, diffusion: f64, velocity: f64) -> f64 {
    let mut contacts = Contacts::new(newborn, Arc::new(Point::new(0.0).unwrap()));
    contacts.rules.ageing = Some(Ageing::MeanField { mature, diffusion });
    let life = moving(&contacts, &contacts.reforming, true, velocity, false, &mut ()).unwrap();
    life.force().curve().integral() / life.survival().curve().integral()
}

#[test]
fn between_gaussians_friction_is_that_of_the_closed_moments() {
    // Printed to ten digits; the solver cuts off what the newborn law has below 0.
    let known = [(10.0, 0.2718511722), (1.0, 0.3700809896), (0.1, 0.4831162958), (0.01, 0.4994032648)];
    for (velocity, expected) in known {
        assert!((closed((0.5, 0.1), (1.0, 0.05), velocity) - expected).abs() < 1e-10);
        let found = kinetic_friction(gaussian(0.5, 0.1), gaussian(1.0, 0.05), 0.0025, velocity);
        assert!((found - expected).abs() < 2.9e-7, "{velocity} {found}");
        // Nothing is cut off: what is left is the solver's.
        let far = closed((0.9, 0.1), (1.0, 0.08), velocity);
        let found = kinetic_friction(gaussian(0.9, 0.1), gaussian(1.0, 0.08), 0.0064, velocity);
        assert!((found - far).abs() < 1e-12, "{velocity} {found} {far}");
    }
}

#[test]
fn moments_of_broad_thresholds_fulfil_the_equations_of_the_moments() {
    // dC/dt = −D⟨U'⟩ + Dp(0) and d⟨h²⟩/dt = −2D⟨hU'⟩ + 2D with U' = (h − 1.5)/σ², for ages of mean C/v.
    let (mean, variance, diffusion) = (1.5, 0.2_f64.powi(2), 0.01);
    for variation in [0.3, 0.5, 1.0, 3.0] {
        let newborn: SharedLaw = Arc::new(Lognormal::new(1.0, variation).unwrap());
        let maturing = ThresholdFokkerPlanck::new(newborn.clone(), gaussian(mean, 0.2), diffusion);
        for velocity in [0.01, 0.1, 1.0] {
            let law = Closure { maturing: &maturing, velocity }.law(&mut ()).unwrap();
            let (first, second) = (law.mean(), law.upper_moment(2, -1.0));
            let (age, rate) = (first / velocity, diffusion / variance);
            let first_expected = 1.0 + age * (diffusion * law.density(0.0) - rate * (first - mean));
            let second_expected =
                1.0 + variation.powi(2) + 2.0 * age * (diffusion - rate * (second - mean * first));
            // What elements leave out, times the age in units of the relaxation time, 25 at most.
            assert!(
                (first / first_expected - 1.0).abs() < 3e-11,
                "{variation} {velocity} {first} {first_expected}"
            );
            assert!(
                (second / second_expected - 1.0).abs() < 3e-11 * (1.0 + 2.0 * age * rate),
                "{variation} {velocity} {second} {second_expected}"
            );
        }
    }
}

#[test]
fn other_laws_fulfil_the_equation_integrated_over_thresholds() {
    let laws: [(SharedLaw, SharedLaw); 3] = [
        (gaussian(0.5, 0.1), Arc::new(Gamma::new(1.0, 0.2).unwrap())),
        (gaussian(1.0, 0.1), Arc::new(Rectangular::new(0.4, 1.6).unwrap())),
        (Arc::new(Rectangular::new(0.4, 0.6).unwrap()), gaussian(1.0, 0.1)),
    ];
    for (newborn, mature) in laws {
        let diffusion = 0.5 * mature.std().powi(2);
        for velocity in [0.03, 1.0] {
            let maturing = ThresholdFokkerPlanck::new(newborn.clone(), mature.clone(), diffusion);
            let law = Closure { maturing: &maturing, velocity }.law(&mut ()).unwrap();
            assert!((law.survival(-1.0) - 1.0).abs() < 1e-14);
            let spread = law.mean() / velocity * diffusion;
            for k in 1..30 {
                let h = 0.405 + 0.04 * f64::from(k);
                // Within some cells of a jump of the newborn law the slope is less well known.
                let near = newborn.breakpoints().iter().any(|b| (b.position - h).abs() < 0.02);
                if mature.density(h) < 1e-8 || mature.density(h + 2e-3) == 0.0 || near {
                    continue;
                }
                // S − S_i = −aJ at h, J = −D(U'p + p') = −D P_cf (p/P_cf)', by differences of fourth order.
                let ratio = |h: f64| law.density(h) / mature.density(h);
                let step = 1e-3;
                let slope = (8.0 * (ratio(h + step) - ratio(h - step)) - ratio(h + 2.0 * step)
                    + ratio(h - 2.0 * step))
                    / (12.0 * step);
                let flux = -spread * mature.density(h) * slope;
                let residual = law.survival(h) - newborn.survival(h) - flux;
                // The density is told to 1e-9 of itself; differences and aD make 2000 times that of it at most.
                assert!(residual.abs() < 2e-6, "{} {velocity} {h} {residual:e}", newborn.name());
            }
        }
    }
}

#[test]
fn a_point_mass_without_weight_beyond_all_others_changes_nothing() {
    let mature = gaussian(1.5, 0.2);
    let alone = kinetic_friction(Arc::new(Point::new(1.0).unwrap()), mature.clone(), 0.01, 0.1);
    let point = |place: f64| Arc::new(Point::new(place).unwrap()) as SharedLaw;
    let both: SharedLaw = Arc::new(Mixture::new(vec![(1.0, point(1.0)), (1e-20, point(50.0))]).unwrap());
    // Rounding of some sums.
    assert!((kinetic_friction(both, mature, 0.01, 0.1) / alone - 1.0).abs() < 1e-11);
}
