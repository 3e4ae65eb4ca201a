//! Fits to curves whose positions have errors: what they make of the forces follows from the slope of the curve.

use asperity::contacts::Initial;
use asperity::fit::{ErrorModel, Estimates, Fit, Measurement};
use asperity::master::MasterEquation;
use asperity::random::{Purpose, Stream};
use rayon::prelude::*;

use crate::pulls::{assert_gradient_is_slope, contacts, off, positions, spread};

/// The standard deviation of a position, and that of a force.
const STD: f64 = 0.006;
const READING: f64 = 3.0;

/// The free numbers, and their true values.
const FREE: [(&str, f64); 3] = [("thresholds.mean", 1.0), ("thresholds.std", 0.12), ("count", 2000.0)];

fn truth() -> MasterEquation {
    MasterEquation::new(contacts(2000.0, [1.0, 0.12], spread()), &Initial::default()).unwrap()
}

/// The errors of a weighted least-squares fit of one number: with independent errors of known sizes, its variance is 1/Σ(∂F/∂θ)²/s²
/// with s² = reading² + (σF')².
#[test]
fn independent_errors_are_those_of_weighted_least_squares() {
    let positions = positions(300, 6.0);
    let reading = READING;
    let errors = ErrorModel { contacts: false, reading: Some(reading), position: Some(STD), drift: None };
    let planned = Fit::new(truth(), Measurement::new(positions.clone(), Vec::new()));
    let planned = planned.free(["thresholds.mean"]).errors(errors).run().unwrap();
    let force = |mean: f64| {
        let moved =
            MasterEquation::new(contacts(2000.0, [mean, 0.12], spread()), &Initial::default()).unwrap();
        let pull = moved.pull(6.1).unwrap();
        move |x: f64| pull.force(x)
    };
    // Central differences: steps of 1e-4 leave 1e-8 of the third derivative, and 1e-6 of rounding at the default tolerance.
    let step = 1e-4;
    let (before, at, after) = (force(1.0 - step), force(1.0), force(1.0 + step));
    let information: f64 = positions
        .iter()
        .map(|&x| {
            let by_mean = (after(x) - before(x)) / (2.0 * step);
            let slope = (at(x + step) - at(x - step)) / (2.0 * step);
            by_mean.powi(2) / (reading.powi(2) + (STD * slope).powi(2))
        })
        .sum();
    let found = planned.estimate("thresholds.mean").unwrap().error;
    assert!((found * information.sqrt() - 1.0).abs() < 1e-4, "{found} {}", 1.0 / information.sqrt());
    // The standard deviations of the readings are the same.
    let slope = (at(1.0 + step) - at(1.0 - step)) / (2.0 * step);
    let std = planned.predict(0, &[1.0], &mut ()).unwrap().std[0];
    assert!((std / reading.hypot(STD * slope) - 1.0).abs() < 1e-5, "{std}");
    let i = positions.iter().position(|x| (x - 1.0).abs() < 1e-9).unwrap();
    // Slopes of two solutions, each to its tolerance.
    assert!((planned.readings[0].std[i] / std - 1.0).abs() < 1e-6);
}

/// A mean of m readings has 1/m of the variance.
#[test]
fn means_of_readings_have_less_of_the_errors_of_positions() {
    let errors = ErrorModel { contacts: false, reading: Some(1e-3), position: Some(STD), drift: None };
    let planned = |average: usize| {
        let measured = Measurement::new(positions(300, 0.3), Vec::new()).average(average).unwrap();
        Fit::new(truth(), measured).free(["thresholds.mean"]).errors(errors).run().unwrap()
    };
    // No contact breaks up to X = 0.3, so that the slope is the stiffness of 2000.
    let [one, ten] = [1, 10].map(|average| planned(average).readings[0].std[0]);
    assert!((one - 2000.0 * STD).abs() < 1e-5 && (ten - one / 10_f64.sqrt()).abs() < 1e-5, "{one} {ten}");
}

/// The expected force with independent errors, at `count` positions that are read with errors and put in order.
fn measured(count: usize, seed: u64) -> Measurement {
    let positions = positions(count, 0.02 * count as f64);
    let curve = truth().pull(6.0).unwrap();
    let mut stream = Stream::new(seed, Purpose::Sample, 0);
    // Sum of twelve uniform numbers: variance 1.
    let mut normal = || (0..12).map(|_| stream.uniform()).sum::<f64>() - 6.0;
    let forces = positions.iter().map(|&x| curve.force(x) + READING * normal()).collect();
    let mut read: Vec<f64> = positions.iter().map(|x| x + STD * normal()).collect();
    read.sort_by(f64::total_cmp);
    Measurement::new(read, forces)
}

/// Number of readings: up to X = 4.
const COUNT: usize = 200;

/// Three numbers and the error of a reading, with positions that have errors or are taken as exact.
fn fitted(seed: u64, position: Option<f64>) -> Estimates {
    let guess = MasterEquation::new(contacts(1500.0, [0.9, 0.2], spread()), &Initial::default()).unwrap();
    let errors = ErrorModel { contacts: false, position, ..ErrorModel::default() };
    Fit::new(guess, measured(COUNT, seed)).free(FREE.map(|number| number.0)).errors(errors).run().unwrap()
}

/// Of 40 curves, 38 intervals hold the truth.
#[test]
fn intervals_in_errors_of_positions_hold_the_truth() {
    let found: Vec<Estimates> = (0..40_u64).into_par_iter().map(|seed| fitted(seed, Some(STD))).collect();
    assert!(found.iter().all(|found| found.converged));
    for (name, value) in FREE.into_iter().chain([("reading", READING)]) {
        let holds = |found: &&Estimates| {
            let interval = found.estimate(name).unwrap().interval;
            interval[0] <= value && value <= interval[1]
        };
        let covered = found.iter().filter(holds).count();
        let off = off(&found, (name, value));
        println!("{name}: {covered} {off}");
        // Fewer than 32 of 40 have a probability of 1e-4.
        assert!(covered >= 32, "{name}: {covered}");
        // χ²/40 of 40 degrees of freedom is below 0.37 or above 2.05 with 1e-4 each. Errors off by 1.5 make 0.44 or 2.25 of 1.
        assert!((0.37..2.05).contains(&off), "{name}: {off}");
    }
    // A probability below 1e-3 in one of 1000 curves: three of 40 have one of 1e-4 and less.
    assert!(found.iter().filter(|found| found.misfit.unwrap().is_unlikely()).count() < 3);
    // Taken as exact, positions leave larger errors: weights are wrong, and what is steep counts for as much as what is not.
    let scatter = |found: &[Estimates]| {
        let squares =
            found.iter().map(|found| (found.estimate("thresholds.std").unwrap().value - 0.12).powi(2));
        (squares.sum::<f64>() / found.len() as f64).sqrt()
    };
    let exact: Vec<Estimates> = (0..40_u64).into_par_iter().map(|seed| fitted(seed, None)).collect();
    let [weighted, unweighted] = [scatter(&found), scatter(&exact)];
    println!("scatter of the width: {weighted:e}, {unweighted:e}");
    assert!(weighted < 0.8 * unweighted, "{weighted} {unweighted}");
}

#[test]
fn the_slope_of_the_likelihood_counts_errors_of_positions() {
    for drift in [None, Some(0.45)] {
        let errors = ErrorModel { contacts: false, position: Some(STD), drift, ..ErrorModel::default() };
        // Readings up to X = 2, where second contacts break.
        let found = Fit::new(truth(), measured(100, 3)).free(FREE.map(|number| number.0)).errors(errors);
        assert_gradient_is_slope(&found.run().unwrap());
    }
}
