//! Fits to several curves, and numbers that one of them has of its own.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::fit::{ErrorModel, Estimates, Fit, Measurement};
use asperity::law::{Mixture, Point, Rectangular, SharedLaw};
use asperity::master::MasterEquation;

use super::pulls::{contacts, exact, positions, simulated, spread};

#[test]
fn two_halves_of_a_measurement_know_as_much_as_both_alone() {
    let positions = positions(150, 5.0);
    let known = ErrorModel { contacts: true, reading: Some(1.0), ..ErrorModel::default() };
    let free = ["thresholds.mean", "thresholds.std"];
    let measured = |seed| Measurement::new(positions.clone(), simulated(&positions, seed));
    let guess = || MasterEquation::new(contacts(2000.0, [1.0, 0.13], spread()), &Initial::default()).unwrap();
    let one = |seed| Fit::new(guess(), measured(seed)).free(free).errors(known).run().unwrap();
    let both = Fit::new(guess(), measured(1)).curve(measured(2)).free(free).errors(known).run().unwrap();
    let (first, second) = (one(1), one(2));
    for name in free {
        let of = |found: &Estimates| {
            let estimate = found.estimate(name).unwrap().clone();
            (estimate.value, estimate.error.powi(-2))
        };
        let ((a, wa), (b, wb), (c, wc)) = (of(&first), of(&second), of(&both));
        // Informations add, and values are weighted by them, but for the shape of the covariance, which is computed at the
        // estimates: these differ by an error, 0.2 % of the mean and 2 % of the width.
        assert!((wc / (wa + wb) - 1.0).abs() < 0.05, "{name}: {wc} {}", wa + wb);
        assert!((c - (wa * a + wb * b) / (wa + wb)).abs() < 0.2 / wc.sqrt(), "{name}: {a} {b} {c}");
    }
    assert_eq!(both.readings.len(), 2);
    assert_eq!(both.misfit.unwrap().degrees_of_freedom, 298);
}

#[test]
fn a_number_on_which_the_curve_does_not_depend_is_refused() {
    // No contact breaks before X = 0.9, so that none re-forms.
    let law = |low, high| -> SharedLaw { Arc::new(Rectangular::new(low, high).unwrap()) };
    let equation =
        MasterEquation::new(Contacts::new(law(0.9, 1.1), law(0.0, 0.2)), &Initial::default()).unwrap();
    let positions: Vec<f64> = (0..=70).map(|i| 0.01 * f64::from(i)).collect();
    let pull = equation.pull(0.7).unwrap();
    let forces = positions.iter().map(|&x| pull.force(x)).collect();
    let known = ErrorModel { contacts: false, reading: Some(0.01), ..ErrorModel::default() };
    let fit = Fit::new(equation, Measurement::new(positions, forces)).errors(known);
    let refused = fit.free(["stiffness", "reforming.max"]).run().unwrap_err().to_string();
    assert!(refused.contains("reforming.max, on which it does not depend"), "{refused}");
}

#[test]
fn what_differs_between_curves_is_found_for_each() {
    let positions = positions(120, 5.0);
    let force = |count: f64| exact(contacts(count, [1.0, 0.12], spread()), &positions);
    let white = ErrorModel { contacts: false, ..ErrorModel::default() };
    let with_offset = |offset: f64, count| force(count).into_iter().map(|f| f + offset).collect();
    let first = Measurement::new(positions.clone(), with_offset(30.0, 2000.0));
    let second = Measurement::new(positions.clone(), with_offset(-12.0, 1500.0));
    let guess = MasterEquation::new(contacts(1800.0, [0.95, 0.15], spread()), &Initial::default()).unwrap();
    let free = [
        "thresholds.mean",
        "thresholds.std",
        "curve.0.count",
        "curve.1.count",
        "curve.0.offset",
        "curve.1.offset",
    ];
    let found = Fit::new(guess, first).curve(second).free(free).errors(white).run().unwrap();
    assert!(found.converged);
    for (name, value) in free.into_iter().zip([1.0, 0.12, 2000.0, 1500.0, 30.0, -12.0]) {
        // As in the fit of one curve without noise.
        assert!((found.estimate(name).unwrap().value / value - 1.0).abs() < 1e-7, "{name}");
    }
    // The friction is that of the first curve.
    let friction = found.friction(&mut ()).unwrap().kinetic_friction;
    assert!(
        (friction.value / found.equation().steady_state().kinetic_friction() - 1.0).abs() < 1e-9
            && friction.error.is_finite()
    );
    let ratio = found.pull(0).force(2.0) / found.pull(1).force(2.0);
    assert!((ratio / (2000.0 / 1500.0) - 1.0).abs() < 1e-7, "{ratio}");
    let [first, second] = [0, 1].map(|curve| found.predict(curve, &[2.0], &mut ()).unwrap().forces[0]);
    assert!((first - 30.0 - ratio * (second + 12.0)).abs() < 1e-4, "{first} {second}");
}

#[test]
fn a_number_is_common_to_the_curves_or_one_of_each() {
    let positions = positions(50, 4.0);
    let measured =
        || Measurement::new(positions.clone(), exact(contacts(10.0, [1.0, 0.1], spread()), &positions));
    let refused = |names: &[&str]| {
        let guess = MasterEquation::new(contacts(10.0, [1.0, 0.1], spread()), &Initial::default()).unwrap();
        let fit = Fit::new(guess, measured()).curve(measured()).free(names.iter().copied());
        fit.check().unwrap_err().to_string()
    };
    assert!(refused(&["offset", "curve.1.offset"]).contains("curve.1.offset beside offset"));
    assert!(refused(&["curve.2.offset"]).starts_with("free.0: expected one of"));
}

/// With one curve, its own numbers are those of all curves.
#[test]
fn count_and_stiffness_of_a_curve_divide_its_noise_as_those_of_all() {
    let positions = positions(80, 4.0);
    let forces = simulated(&positions, 2);
    let found = |names: [&str; 2]| {
        let guess =
            MasterEquation::new(contacts(1800.0, [1.0, 0.12], spread()), &Initial::default()).unwrap();
        let measured = Measurement::new(positions.clone(), forces.clone());
        Fit::new(guess, measured).free(names).run().unwrap()
    };
    let [all, one] = [["count", "stiffness"], ["curve.0.count", "curve.0.stiffness"]].map(found);
    let [of_all, of_one] = [&all, &one].map(|found| found.misfit.unwrap());
    // The noise is as large as the residuals: χ² does not tell whether the curve is described.
    assert!(of_all.probability.is_none() && of_one.probability.is_none());
    assert_eq!(of_all.degrees_of_freedom, of_one.degrees_of_freedom);
    let [a, b] = [all.parameters[0].value, one.parameters[0].value];
    assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
}

/// N and ⟨k⟩ change a curve alike: they are one number of its force. If another curve has only one of them, its force tells them apart.
#[test]
fn numbers_that_only_the_noise_tells_apart_are_counted_once() {
    let positions = positions(60, 4.0);
    let found = |names: &[&str]| {
        let guess =
            MasterEquation::new(contacts(2000.0, [1.0, 0.12], spread()), &Initial::default()).unwrap();
        let measured = |seed: u64| Measurement::new(positions.clone(), simulated(&positions, seed));
        let fit = Fit::new(guess, measured(3)).curve(measured(4)).free(names.iter().copied());
        // With errors of readings of a known size.
        fit.errors(ErrorModel { reading: Some(0.1), ..ErrorModel::default() }).run().unwrap().misfit.unwrap()
    };
    for (names, of_force, tested) in [
        (&["curve.0.count", "curve.0.stiffness"][..], 1, false),
        (&["stiffness", "curve.0.count", "curve.1.count"], 2, false),
        (&["count", "curve.0.stiffness"], 2, true),
    ] {
        let misfit = found(names);
        assert_eq!(misfit.degrees_of_freedom, 120 - of_force, "{names:?}");
        assert_eq!(misfit.probability.is_some(), tested, "{names:?}");
    }
}

#[test]
fn two_weights_of_a_mixture_are_refused() {
    let point = |at: f64| -> SharedLaw { Arc::new(Point::new(at).unwrap()) };
    let law = Mixture::new(vec![(0.5, point(1.0)), (0.25, point(1.5)), (0.25, point(2.0))]).unwrap();
    let positions = positions(50, 4.0);
    let mixed = || Contacts { count: 10.0, ..Contacts::new(Arc::new(law.clone()), spread()) };
    let check = |names: &[&str]| {
        let equation = MasterEquation::new(mixed(), &Initial::default()).unwrap();
        let forces = exact(mixed(), &positions);
        Fit::new(equation, Measurement::new(positions.clone(), forces)).free(names.iter().copied()).check()
    };
    check(&["thresholds.0.weight", "count"]).unwrap();
    let message = check(&["thresholds.0.weight", "count", "thresholds.2.weight"]).unwrap_err().to_string();
    assert!(message.starts_with("free.2: expected one weight of a mixture"), "{message}");
    assert!(message.contains("thresholds.2.weight beside thresholds.0.weight"), "{message}");
}
