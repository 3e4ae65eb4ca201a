//! The stretches at which time-dependent contacts break in steady sliding, and what is reported of their distribution.

use crate::common::pulled::near;
use crate::common::{contacts, gaussian, initial, point, rectangular};
use asperity::contacts::{Ageing, Barrier, Contacts, Rules, Temperature};
use asperity::master::MasterEquation;

fn at(contacts: Contacts, velocity: f64) -> MasterEquation {
    MasterEquation::at(contacts, &initial(&point(0.0)), velocity).unwrap()
}

fn warm(energy: f64) -> Rules {
    let temperature = Temperature { barrier: Barrier::Elastic, ..Temperature::new(energy, 1.0) };
    Rules { temperature: Some(temperature), ..Rules::default() }
}

fn ranked() -> Contacts {
    let rules = Rules {
        ageing: Some(Ageing::FrozenRank { mature: gaussian(1.0, 0.05), time: 1.0 }),
        ..Rules::default()
    };
    Contacts { rules, ..contacts(&gaussian(0.5, 0.1), &point(0.0)) }
}

#[test]
fn slow_contacts_meet_the_mature_law_and_fast_ones_that_of_the_fresh() {
    for (velocity, law) in [(1e-3, gaussian(1.0, 0.05)), (1e8, gaussian(0.5, 0.1))] {
        let steady = at(ranked(), velocity).steady_state();
        let stretches: Vec<f64> = (1..=60).map(|i| 0.02 * f64::from(i)).collect();
        let met = steady.breaking_stretches(&stretches).unwrap();
        assert!(met.atoms.is_empty());
        for (x, density) in stretches.iter().zip(met.density) {
            // Fresh thresholds are cut at 0, five standard deviations down, where the mature law has this density.
            near(density, law.density(*x), 3e-5);
        }
    }
}

#[test]
fn the_law_is_whole_and_its_mean_is_where_contacts_form_and_how_far_they_go() {
    let thresholds = gaussian(1.0, 0.1);
    for reforming in [point(0.1), rectangular(0.0, 0.2)] {
        let steady =
            at(Contacts { rules: warm(0.05), ..contacts(&thresholds, &reforming) }, 1e-3).steady_state();
        let step = 1e-3;
        let stretches: Vec<f64> = (0..1600).map(|i| step * (f64::from(i) + 0.5)).collect();
        let met = steady.breaking_stretches(&stretches).unwrap().density;
        let whole: f64 = met.iter().map(|density| step * density).sum();
        let mean: f64 = stretches.iter().zip(&met).map(|(x, density)| step * x * density).sum();
        // The rule of the middle, whose error is step² times slopes of the density.
        near(whole, 1.0, 1e-5);
        near(mean, 0.1 + steady.mean_life(), 1e-5);
    }
}

#[test]
fn identical_thresholds_are_met_together_where_nothing_is_hot() {
    let growing = Rules { ageing: Some(Ageing::Logarithmic { growth: 0.02, time: 1.0 }), ..Rules::default() };
    let equation = at(Contacts { rules: growing, ..contacts(&point(1.0), &point(0.0)) }, 0.1);
    let atoms = equation.steady_state().breaking_stretches(&[]).unwrap().atoms;
    assert_eq!(atoms.len(), 1);
    // h = 1 + β ln(1 + h/(v τ)), solved by going round.
    let met = (0..60).fold(1.0_f64, |h, _| 1.0 + 0.02 * (10.0 * h).ln_1p());
    near(atoms[0].position, met, 1e-12);
    near(atoms[0].weight, 1.0, 1e-12);
    assert_eq!(equation.relaxation().unwrap().paper_estimate(), f64::INFINITY);
}

#[test]
fn the_estimate_of_the_paper_is_of_the_law_that_is_met() {
    // x̄²/σ of the mature law, of the fresh one, and of thresholds that are hardly warm; the cut of the fresh law at five
    // standard deviations takes 4e-6 of σ.
    near(at(ranked(), 1e-3).relaxation().unwrap().paper_estimate(), 20.0, 1e-4);
    near(at(ranked(), 1e8).relaxation().unwrap().paper_estimate(), 2.5, 1e-4);
    let cool = Contacts { rules: warm(1e-6), ..contacts(&gaussian(1.0, 0.1), &point(0.0)) };
    near(at(cool, 1.0).relaxation().unwrap().paper_estimate(), 10.0, 1e-4);
}
