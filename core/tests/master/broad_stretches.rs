//! Stretches of re-formed and initial contacts that reach beyond all thresholds: they are left out, and their share is reported.

use crate::common::{exponential, gaussian, point};
use asperity::contacts::{Contacts, Initial, Start};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::master::MasterEquation;
use asperity::scenario::{self, Law, Pull, Scenario, TaskStart};

#[test]
fn kinetic_friction_is_the_closed_form_of_the_stretches_that_are_kept() {
    let whole = Contacts::new(point(1.0), exponential(0.5));
    let (contacts, initial) = whole.truncated(&Initial::default());
    let left_out = whole.left_out(&Initial::default());
    assert_eq!(left_out.len(), 1);
    let (argument, share, highest) = left_out[0];
    assert_eq!((argument, highest), ("reforming", 1.0));
    assert!((share - (-2.0_f64).exp()).abs() < 1e-15, "{share}");
    // A contact that forms at r carries x on its way to 1: F_k = ⟨1 − r²⟩/(2⟨1 − r⟩), with the moments of the exponential
    // distribution of mean ½ below 1, ⟨r⟩ = ½ − q and ⟨r²⟩ = ½ − 2q with q = 1/(e² − 1).
    let q = 1.0 / 2.0_f64.exp_m1();
    let [first, second] = [0.5 - q, 0.5 - 2.0 * q];
    let equation = MasterEquation::new(contacts, &initial).unwrap();
    let found = equation.steady_state().kinetic_friction();
    // The accuracy of lives, 1e-13 per mean life.
    assert!((found - (1.0 - second) / (2.0 * (1.0 - first))).abs() < 1e-12, "{found}");
}

#[test]
fn contacts_one_by_one_carry_the_force_of_the_master_equation() {
    // Stretches at X = 0 beyond the thresholds, too.
    let start = Initial { law: gaussian(0.6, 0.4), start: Start::Conditional };
    let whole = Contacts::new(gaussian(1.0, 0.1), exponential(0.5));
    assert_eq!(whole.left_out(&start).len(), 2);
    let (contacts, initial) = whole.truncated(&start);
    let pull = MasterEquation::new(contacts.clone(), &initial).unwrap().pull(2.0).unwrap();
    let ensemble = Ensemble::new(contacts, initial, 200_000, 11, Disorder::Annealed).unwrap();
    let positions: Vec<f64> = (0..=20).map(|k| 0.1 * f64::from(k)).collect();
    let run = ensemble.pull(&positions).unwrap();
    for (i, &position) in positions.iter().enumerate() {
        let (expected, found) = (pull.force(position), run.force[i]);
        // 4.5 standard errors at 21 positions: one false alarm in 7000.
        assert!((found - expected).abs() < 4.5 * run.error[i], "{position}: {found} {expected}");
    }
}

#[test]
fn a_scenario_accepts_them_and_tells_their_share() {
    let pulled = |reforming: Law, start: TaskStart| {
        let contacts = scenario::Contacts {
            thresholds: Some(Law::Rectangular { min: 0.5, max: 1.0 }),
            reforming: reforming.clone(),
            ..scenario::Contacts::default()
        };
        let mut scenario = Scenario::new(contacts);
        scenario.initial = reforming;
        scenario.pull = Some(Pull { start, ..Pull::default() });
        scenario
    };
    let force = |scenario: &Scenario| {
        let model = scenario.build().unwrap();
        let equation = MasterEquation::new(model.contacts, &model.initial).unwrap();
        let pull = equation.pull(3.0).unwrap();
        [0.0, 0.4, 1.0, 2.7].map(|x| pull.force(x))
    };
    let broad = pulled(Law::Rectangular { min: 0.0, max: 1.25 }, TaskStart::Conditional);
    let short = pulled(Law::Rectangular { min: 0.0, max: 1.0 - 5e-10 }, TaskStart::Conditional);
    for (a, b) in force(&broad).into_iter().zip(force(&short)) {
        // Both are solved to 1e-10.
        assert!((a - b).abs() < 2e-10, "{a} {b}");
    }
    let reported = broad.build().unwrap().warnings;
    assert_eq!(reported.len(), 2);
    assert!(
        reported[0].starts_with("contacts.reforming: a fraction of 2.000e-1 is left out"),
        "{}",
        reported[0]
    );
    assert!(reported[1].starts_with("initial: a fraction of 2.000e-1 is left out"), "{}", reported[1]);
    // Contacts that may break at once are all kept.
    let mut relaxed = pulled(Law::Rectangular { min: 0.0, max: 1.25 }, TaskStart::Relaxed);
    assert_eq!(relaxed.build().unwrap().warnings.len(), 1);
    // The stretches of steady sliding reach as far as contacts re-form: there they are not resolved.
    let mut steady = pulled(Law::Exponential { mean: 0.4 }, TaskStart::Steady);
    steady.initial = Law::Point { at: 0.0 };
    let error = steady.build().unwrap_err().to_string();
    assert!(error.contains("contacts.reforming"), "{error}");
    relaxed.contacts.reforming = Law::Rectangular { min: 0.0, max: 2.1 };
    let error = relaxed.build().unwrap_err().to_string();
    assert!(error.contains("contacts.reforming"), "more than half: {error}");
}
