//! Lives at a velocity against the values of the theory.

use crate::common::{gaussian, point};
use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Rules, Start, Temperature};
use asperity::law::SharedLaw;
use asperity::master::MasterEquation;

fn at(thresholds: SharedLaw, rules: Rules, velocity: f64) -> MasterEquation {
    let contacts = Contacts { rules, ..Contacts::new(thresholds, point(0.0)) };
    let initial = Initial { law: point(0.0), start: Start::Conditional };
    MasterEquation::at(contacts, &initial, velocity).unwrap()
}

/// Thermal breaking at the height E_0/T of the barrier at x̄ = 1, ω = 1.
fn thermal(height: f64, barrier: Barrier) -> Rules {
    let temperature = Temperature { barrier, ..Temperature::new(0.5 / height, 1.0) };
    Rules { temperature: Some(temperature), ..Rules::default() }
}

fn friction(thresholds: SharedLaw, rules: Rules, velocity: f64) -> f64 {
    at(thresholds, rules, velocity).steady_state().kinetic_friction()
}

#[test]
fn one_threshold_and_temperature() {
    let table = [
        (1e-10, [0.04114415072, 0.02192174029, 0.01829963892]),
        (1e-6, [0.3330145881, 0.2198520329, 0.1653798456]),
        (1e-2, [0.4800442117, 0.4476061367, 0.3848110420]),
    ];
    for (velocity, row) in table {
        let barriers = [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe];
        for (barrier, expected) in barriers.into_iter().zip(row) {
            let found = friction(point(1.0), thermal(20.0, barrier), velocity);
            // Half a unit of the last digit given.
            assert!((found - expected).abs() < 0.5e-10 * if expected < 0.1 { 0.1 } else { 1.0 });
        }
    }
}

#[test]
fn distributed_thresholds_and_temperature() {
    for (velocity, expected) in [(1e-4, 0.29806681116), (1e-2, 0.44526255210)] {
        let found = friction(gaussian(1.0, 0.1), thermal(10.0, Barrier::Elastic), velocity);
        // Half a unit of the last digit given.
        assert!((found - expected).abs() < 0.5e-11);
    }
}

#[test]
fn logarithmic_ageing() {
    let table = [(1.0, 0.5122109494), (1e-2, 0.5527655886), (1e-4, 0.6000169155), (1e-6, 0.6472942007)];
    for (velocity, expected) in table {
        let ageing = Some(Ageing::Logarithmic { growth: 0.02, time: 1.0 });
        let found = friction(gaussian(1.0, 0.1), Rules { ageing, ..Rules::default() }, velocity);
        // Half a unit of the last digit given.
        assert!((found - expected).abs() < 0.5e-10);
    }
}

#[test]
fn thresholds_of_frozen_rank() {
    let table = [(10.0, 0.2721367872), (1.0, 0.3867782523), (0.1, 0.5012378105), (0.01, 0.50125)];
    for (velocity, expected) in table {
        let ageing = Some(Ageing::FrozenRank { mature: gaussian(1.0, 0.05), time: 1.0 });
        let found = friction(gaussian(0.5, 0.1), Rules { ageing, ..Rules::default() }, velocity);
        // The values given ignore the 2.9e-7 of P_ci below 0.
        assert!((found - expected).abs() < 1e-7);
    }
}
