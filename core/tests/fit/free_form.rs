//! Fits of thresholds of free form: a distribution that the curve itself gives, with its errors.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::fit::{ErrorModel, Fit, FreeForm, Measurement};
use asperity::law::{Gaussian, Law, Mixture, Point, SharedLaw};
use asperity::master::MasterEquation;
use rayon::prelude::*;

use crate::pulls::{TRUE, contacts, drifting, exact, fit, positions, spread};

/// The largest difference between the distribution function of `law` and a free form, and its largest number of errors.
fn apart(law: &dyn Law, form: &FreeForm) -> [f64; 2] {
    let thresholds: Vec<f64> = (0..=100).map(|i| 0.4 + 0.015 * f64::from(i)).collect();
    let band = form.band(&thresholds).unwrap();
    let mut most = [0.0_f64; 2];
    for (i, &x) in thresholds.iter().enumerate() {
        let difference = (band.cumulative[i] - law.cumulative(x)).abs();
        // Far out the distribution functions differ by less than they are computed to.
        let errors = if difference < 1e-4 { 0.0 } else { difference / band.cumulative_error[i] };
        most = [most[0].max(difference), most[1].max(errors)];
    }
    most
}

#[test]
fn thresholds_of_free_form_are_found_to_their_errors() {
    let positions = positions(300, 5.0);
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let two: SharedLaw = Arc::new(
        Mixture::new(vec![
            (0.6, Arc::new(Gaussian::new(0.85, 0.07).unwrap())),
            (0.4, Arc::new(Gaussian::new(1.25, 0.08).unwrap())),
        ])
        .unwrap(),
    );
    let one: SharedLaw = Arc::new(Gaussian::new(1.0, 0.12).unwrap());
    for (law, shape) in [(two, "two peaks"), (one, "a Gaussian")] {
        let truth = Contacts { count: 2000.0, ..Contacts::new(law.clone(), relaxed.clone()) };
        let ensemble = Ensemble::new(truth, Initial::default(), 2000, 11, Disorder::Annealed).unwrap();
        let forces = ensemble.pull(&positions).unwrap().force;
        let guess = contacts(2000.0, [1.0, 0.2], relaxed.clone());
        let guess = MasterEquation::new(guess, &Initial::default()).unwrap();
        let fit = Fit::new(guess, Measurement::new(positions.clone(), forces)).free([
            "thresholds.mean",
            "thresholds.std",
            "count",
        ]);
        let found = fit.run().unwrap();
        let form = fit.free_form(&found, 36, &mut ()).unwrap();
        let [difference, errors] = apart(law.as_ref(), &form);
        assert!(form.estimates.converged);
        // 2000 contacts know a distribution function to about ½/√2000 = 0.011.
        assert!(difference < 0.02, "{shape}: {difference}");
        assert!(errors < 4.0, "{shape}: {errors}");
    }
}

/// Thresholds of free form have more coefficients than a short record has readings.
#[test]
fn a_free_form_of_a_short_record_has_errors() {
    let positions = positions(30, 3.0);
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let forces = exact(contacts(2000.0, [1.0, 0.12], relaxed.clone()), &positions);
    let one = |seed: u64| {
        let measured = drifting((&positions, &forces), (5.0, [0.0, 1.0]), seed);
        let white = ErrorModel { contacts: false, ..ErrorModel::default() };
        let guess = contacts(1500.0, [0.9, 0.2], relaxed.clone());
        let guess = MasterEquation::new(guess, &Initial::default()).unwrap();
        let fit = Fit::new(guess, Measurement::new(positions.clone(), measured));
        let fit = fit.free(["thresholds.mean", "thresholds.std", "count"]).errors(white);
        let form = fit.run().unwrap().free_form(36, &mut ()).unwrap();
        let misfit = form.estimates.misfit.unwrap();
        // Mean and width, what the shape has beyond them, and the count.
        let numbers = 3.0 + form.effective;
        assert!(
            (misfit.degrees_of_freedom as f64 - (30.0 - numbers)).abs() <= 0.5,
            "{misfit:?} {}",
            form.effective
        );
        assert!(form.std.error > 0.0 && form.estimates.reading > 0.0, "{:?}", form.std);
        (form.mean.value, form.mean.error)
    };
    let found: Vec<(f64, f64)> = (0..12_u64).into_par_iter().map(one).collect();
    let within = found.iter().filter(|(mean, error)| (mean - 1.0).abs() < 2.06 * error).count();
    // 11.4 of 12; fewer than 8 have a probability of 2e-4. t of 26 degrees of freedom.
    assert!(within >= 8, "{within}: {found:?}");
}

/// Six readings that are hardly more than numbers, with errors of known size: no degree of freedom may be left, and no probability then.
#[test]
fn a_free_form_of_very_few_readings_is_fitted() {
    let positions = positions(6, 2.4);
    let forces = exact(contacts(2000.0, [1.0, 0.12], spread()), &positions);
    for reading in [0.1, 5.0] {
        let measured = drifting((&positions, &forces), (reading, [0.0, 1.0]), 2);
        let white = ErrorModel { contacts: false, reading: Some(reading), ..ErrorModel::default() };
        let fit =
            fit(&positions, measured).free(["thresholds.mean", "thresholds.std", "count"]).errors(white);
        let misfit = fit.run().unwrap().free_form(36, &mut ()).unwrap().estimates.misfit.unwrap();
        assert!(misfit.degrees_of_freedom <= 3 && misfit.akaike.is_finite(), "{misfit:?}");
        assert_eq!(misfit.probability.is_some(), misfit.degrees_of_freedom > 0, "{misfit:?}");
    }
}

/// In independent errors of unknown size, too, thresholds of free form have the shape that the curve shows.
#[test]
fn a_free_form_in_independent_errors_has_two_modes() {
    let positions = positions(80, 4.0);
    let modes: Vec<(f64, SharedLaw)> = vec![
        (0.6, Arc::new(Gaussian::new(0.85, 0.07).unwrap())),
        (0.4, Arc::new(Gaussian::new(1.2, 0.08).unwrap())),
    ];
    let thresholds: SharedLaw = Arc::new(Mixture::new(modes).unwrap());
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let truth = Contacts { count: 2000.0, ..Contacts::new(thresholds, relaxed.clone()) };
    let measured = drifting((&positions, &exact(truth, &positions)), (4.0, [0.0, 1.0]), 1);
    let white = ErrorModel { contacts: false, ..ErrorModel::default() };
    let guess = MasterEquation::new(contacts(1500.0, [0.9, 0.2], relaxed), &Initial::default()).unwrap();
    let fit = Fit::new(guess, Measurement::new(positions, measured));
    let fit = fit.free(["thresholds.mean", "thresholds.std", "count"]).errors(white);
    // 36 kernels would be wider than the modes.
    let form = fit.run().unwrap().free_form(44, &mut ()).unwrap();
    assert!(form.estimates.converged);
    let [first, between, second] = [0.85, 1.03, 1.2].map(|x| form.thresholds.density(x));
    // The true ones are 3.42, 0.43 and 1.99.
    assert!(between < 0.4 * first && between < 0.6 * second, "{first} {between} {second}");
    assert!(form.effective > 3.0 && form.effective < 20.0, "{}", form.effective);
    // A standard deviation of 80 readings is known to 8 %; four of these.
    assert!((form.estimates.reading / 4.0 - 1.0).abs() < 0.32, "{}", form.estimates.reading);
    let error = form.mean.error;
    assert!((form.mean.value - 0.99).abs() < 4.0 * error && error < 0.02, "{:?}", form.mean);
}

/// Beyond all thresholds a curve shows hardly more than that there are none.
#[test]
fn a_free_form_does_not_rise_far_from_what_the_curve_shows() {
    let mode = |mean: f64, std: f64| -> SharedLaw { Arc::new(Gaussian::new(mean, std).unwrap()) };
    let modes = Mixture::new(vec![(0.5, mode(0.6, 0.08)), (0.5, mode(1.4, 0.12))]).unwrap();
    let reforming = Arc::new(Point::new(0.0).unwrap());
    let truth = Contacts { count: 5000.0, ..Contacts::new(Arc::new(modes), reforming.clone()) };
    let positions = positions(200, 4.0);
    let ensemble = Ensemble::new(truth, Initial::default(), 5000, 2, Disorder::Annealed).unwrap();
    let forces = drifting((&positions, &ensemble.pull(&positions).unwrap().force), (5.0, [0.0, 1.0]), 2);
    let guess = contacts(4000.0, [1.2, 0.4], reforming);
    let guess = MasterEquation::new(guess, &Initial::default()).unwrap();
    let names = TRUE.map(|number| number.0);
    let found = Fit::new(guess, Measurement::new(positions, forces)).free(names).run().unwrap();
    let band = found.free_form(36, &mut ()).unwrap().table().unwrap();
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    // The upper ends of the modes are within a fifth of the density; the tail, known within a factor of 400, is below some times it.
    assert!(most(&band.high) < 20.0 * most(&band.density), "{}", most(&band.high));
    let last = band.density.len() - 1;
    assert!(band.density[last] < 1e-2 && band.thresholds[last] < 4.0, "{:?}", band.thresholds[last]);
}
