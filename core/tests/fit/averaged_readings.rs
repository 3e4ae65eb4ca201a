//! Fits to means of neighbouring readings, which have less of the noise of contacts than single ones.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::fit::{ErrorModel, Estimates, Fit, Measurement};
use asperity::law::{Gaussian, Point};
use asperity::master::MasterEquation;
use asperity::random::{Purpose, Stream};
use rayon::prelude::*;

/// Number of contacts.
const COUNT: f64 = 2000.0;
/// The names and true values of the fitted numbers.
const TRUE: [(&str, f64); 4] =
    [("thresholds.mean", 1.0), ("thresholds.std", 0.2), ("count", COUNT), ("stiffness", 1.0)];

fn contacts(count: f64, [mean, std]: [f64; 2]) -> Contacts {
    let thresholds = Arc::new(Gaussian::new(mean, std).unwrap());
    Contacts { count, ..Contacts::new(thresholds, Arc::new(Point::new(0.0).unwrap())) }
}

/// Readings of a pull over 5 of contacts one by one, and the fit to the means of every `average` of them.
fn fitted(readings: usize, average: usize, seed: u64) -> Estimates {
    fit(readings, average, seed).free(TRUE.map(|number| number.0)).run().unwrap()
}

/// The same before it is made.
fn fit(readings: usize, average: usize, seed: u64) -> Fit {
    let positions: Vec<f64> = (1..=readings).map(|i| 5.0 * i as f64 / readings as f64).collect();
    let (true_contacts, initial) = (contacts(COUNT, [1.0, 0.2]), Initial::default());
    let ensemble = Ensemble::new(true_contacts, initial, COUNT as usize, seed, Disorder::Annealed).unwrap();
    let forces = ensemble.pull(&positions).unwrap().force;
    let guess = MasterEquation::new(contacts(1500.0, [0.9, 0.25]), &Initial::default()).unwrap();
    Fit::new(guess, Measurement::new(positions, forces).average(average).unwrap())
}

/// Without reading errors, all of the noise is that of contacts, and their number is known best. Taken for single readings, means of
/// ten show 2700 contacts in place of 2000: their differences have two thirds of the variance.
#[test]
fn the_number_of_contacts_is_found_from_means() {
    const CURVES: u64 = 40;
    for (readings, average) in [(1500, 10), (600, 4)] {
        let found: Vec<Estimates> =
            (0..CURVES).into_par_iter().map(|seed| fitted(readings, average, seed)).collect();
        let logarithm = |found: &Estimates| (found.estimate("count").unwrap().value / COUNT).ln();
        let bias = found.iter().map(logarithm).sum::<f64>() / CURVES as f64;
        // The error of ln N is 0.12 for one curve of 150 means, 0.018 for the mean of 40; the bias of maximum likelihood is of
        // the order of 1/n for each number that is fitted, 0.027 here.
        assert!(bias.abs() < 0.1, "{bias}");
        let covered = TRUE.map(|(name, value)| {
            let holds = |found: &&Estimates| {
                found.estimate(name).is_some_and(|n| n.interval[0] <= value && value <= n.interval[1])
            };
            found.iter().filter(holds).count()
        });
        // 38 of 40; fewer than 32 have a probability of 1e-4.
        assert!(covered.iter().all(|covered| *covered >= 32), "{average} of {readings}: {covered:?}");
    }
}

/// The variance of a mean is that of all pairs of its readings.
#[test]
fn the_variance_of_a_mean_is_that_of_its_readings() {
    const AVERAGE: usize = 10;
    let found = fitted(1000, AVERAGE, 1);
    let fine: Vec<f64> = (1..=1000).map(|i| 5.0 * f64::from(i) / 1000.0).collect();
    let count = found.equation().contacts().count;
    let covariance = found.equation().pull(5.0).unwrap().covariance(&fine, count).unwrap();
    let mut worst: [f64; 2] = [0.0; 2];
    for (group, std) in found.readings[0].std.iter().enumerate() {
        let readings = || group * AVERAGE..(group + 1) * AVERAGE;
        let pairs = readings().flat_map(|i| readings().map(move |j| (i, j)));
        let exact = pairs.map(|(i, j)| covariance.at(i, j)).sum::<f64>() / (AVERAGE * AVERAGE) as f64;
        let middle = readings().map(|i| covariance.at(i, i)).sum::<f64>() / AVERAGE as f64;
        let variance = std * std - found.reading * found.reading;
        worst[0] = worst[0].max((variance - exact).abs());
        worst[1] = worst[1].max((middle - exact).abs());
    }
    // What means lack of the variance of single readings is known to some percent: means over w = 0.05 of thresholds that are 0.2
    // wide, (w/0.2)² = 6 %.
    assert!(worst[0] < 0.1 * worst[1], "{worst:?}");
}

/// Means over a twelfth of the mean threshold show less of a peak than single readings, and as much as the means of the curve.
#[test]
fn means_do_not_bias_the_width_of_the_thresholds() {
    const CURVES: u64 = 40;
    let names = ["thresholds.mean", "thresholds.std", "stiffness"];
    let positions: Vec<f64> = (1..=600).map(|i| 5.0 * f64::from(i) / 600.0).collect();
    let curve =
        MasterEquation::new(contacts(1.0, [1.0, 0.15]), &Initial::default()).unwrap().pull(6.0).unwrap();
    let white = ErrorModel { contacts: false, ..ErrorModel::default() };
    for average in [10, 20] {
        let fit = |seed: u64| {
            let mut stream = Stream::new(seed, Purpose::Sample, 0);
            // Sum of twelve uniform numbers: variance 1.
            let mut normal = || (0..12).map(|_| stream.uniform()).sum::<f64>() - 6.0;
            let forces = positions.iter().map(|&x| curve.force(x) + 0.005 * normal()).collect();
            let guess = MasterEquation::new(contacts(1.5, [1.2, 0.25]), &Initial::default()).unwrap();
            let measured = Measurement::new(positions.clone(), forces).average(average).unwrap();
            Fit::new(guess, measured).free(names).errors(white).run().unwrap()
        };
        let found: Vec<Estimates> = (0..CURVES).into_par_iter().map(fit).collect();
        let holds = |found: &&Estimates| {
            let [low, high] = found.estimate("thresholds.std").unwrap().interval;
            low <= 0.15 && 0.15 <= high
        };
        // 38 of 40; fewer than 32 have a probability of 1e-4.
        let covered = found.iter().filter(holds).count();
        assert!(covered >= 32, "{average}: {covered}");
    }
}

/// Before the first breaks the noise grows by factors from one mean to the next.
#[test]
fn long_means_have_a_covariance() {
    for average in [10, 20, 30] {
        // Twenty means tell count and stiffness apart for some contacts only.
        let fitted =
            |seed: u64| fit(600, average, seed).free(["thresholds.mean", "thresholds.std", "count"]).run();
        (0..8).into_par_iter().map(fitted).for_each(|found| {
            let found = found.unwrap();
            let mean = found.estimate("thresholds.mean").unwrap();
            // Five errors.
            assert!((mean.value - 1.0).abs() < 5.0 * mean.error, "{average}: {mean:?}");
        });
    }
}
