//! Draws from the posterior of a fit: against the errors of the fit, against the law by which curves are made, and their files.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use asperity::contacts::{Contacts, Initial};
use asperity::fit::{ErrorModel, Estimates, Fit, Measurement, Prior};
use asperity::law::{Gaussian, Law, Point};
use asperity::master::MasterEquation;
use asperity::random::{Purpose, Stream};
use asperity::scenario::FitPosterior;
use asperity_runner::posterior::{Posterior, sample};
use rayon::prelude::*;

/// The master equation of `count` contacts with Gaussian thresholds.
fn equation([mean, std, count]: [f64; 3]) -> MasterEquation {
    let thresholds = Arc::new(Gaussian::new(mean, std).unwrap());
    let contacts = Contacts { count, ..Contacts::new(thresholds, Arc::new(Point::new(0.0).unwrap())) };
    MasterEquation::new(contacts, &Initial::default()).unwrap()
}

/// A normal number. Laws are truncated at 0: so far above it, nothing of this one is.
fn normal(stream: &mut Stream) -> f64 {
    Gaussian::new(40.0, 1.0).unwrap().quantile(stream.uniform()) - 40.0
}

/// `count` readings up to X = `last` with independent normal errors of standard deviation `error`.
fn readings(truth: [f64; 3], (count, last, error): (usize, f64, f64), seed: u64) -> Measurement {
    let positions: Vec<f64> = (1..=count).map(|i| last * i as f64 / count as f64).collect();
    let pull = equation(truth).pull(last).unwrap();
    let mut stream = Stream::new(seed, Purpose::Sample, 0);
    let forces = positions.iter().map(|&x| pull.force(x) + error * normal(&mut stream)).collect();
    Measurement::new(positions, forces)
}

const NAMES: [&str; 3] = ["thresholds.mean", "thresholds.std", "count"];

/// A fit of 60 readings with a known error, up to the second breaks, which determines all three numbers.
fn found(free: &[&str]) -> Estimates {
    let measured = readings([1.0, 0.2, 1000.0], (60, 2.0, 5.0), 3);
    let white = ErrorModel { contacts: false, reading: Some(5.0), ..ErrorModel::default() };
    Fit::new(equation([0.95, 0.25, 1050.0]), measured).free(free.iter().copied()).errors(white).run().unwrap()
}

#[test]
fn a_curve_that_determines_its_numbers_has_the_posterior_of_the_estimates() {
    let found = found(&NAMES);
    let drawn =
        sample(&found.standardised().unwrap(), FitPosterior { draws: 600, chains: 2, seed: 1 }, &mut ())
            .unwrap();
    assert_eq!(drawn.names, NAMES);
    assert_eq!(drawn.divergences(), 0);
    let summary = drawn.summary(str::to_owned);
    assert!(summary.warnings().is_empty(), "{summary:?}");
    for (name, number) in NAMES.iter().zip(&summary.numbers) {
        let (estimate, effective) = (found.estimate(name).unwrap(), number.effective_size.0);
        let (shift, ratio) = ((number.mean - estimate.value) / estimate.error, number.std / estimate.error);
        // Four standard errors of the mean, 1/√ess, and of the standard deviation, 1/√(2 ess); relative errors of 1 % in the
        // estimates, by which the logarithm of a number differs from a straight line.
        assert!(shift.abs() < 4.0 / effective.sqrt() + 0.05, "{name}: {shift}");
        assert!((ratio - 1.0).abs() < 4.0 / (2.0 * effective).sqrt() + 0.02, "{name}: {ratio}");
    }
}

#[test]
fn the_number_of_contacts_has_the_posterior_of_its_estimate_where_their_noise_is_normal() {
    let positions: Vec<f64> = (1..=300).map(|i| 4.0 * f64::from(i) / 300.0).collect();
    let covariance = equation([1.0, 0.2, 1000.0]).pull(4.0).unwrap().covariance(&positions, 1000.0).unwrap();
    let mut stream = Stream::new(4, Purpose::Sample, 0);
    let path = covariance.sample_paths(1, 4).unwrap().swap_remove(0);
    let forces = path.into_iter().map(|force| force + normal(&mut stream)).collect();
    let errors = ErrorModel { reading: Some(1.0), ..ErrorModel::default() };
    let names = ["thresholds.mean", "thresholds.std", "count", "stiffness"];
    let fit = Fit::new(equation([0.95, 0.25, 1050.0]), Measurement::new(positions, forces));
    let found = fit.free(names).errors(errors).run().unwrap();
    let sampling = FitPosterior { draws: 200, chains: 2, seed: 1 };
    let drawn = sample(&found.standardised().unwrap(), sampling, &mut ()).unwrap();
    let summary = drawn.summary(str::to_owned);
    for (name, number) in names.iter().zip(&summary.numbers) {
        let (estimate, effective) = (found.estimate(name).unwrap(), number.effective_size.0);
        let (shift, ratio) = ((number.mean - estimate.value) / estimate.error, number.std / estimate.error);
        // As above; N and ⟨k⟩ have errors of 8 %, by which the mean is half of that further from the most probable value, and the
        // kurtosis of 300 normal residuals, √(24/300), may add 7 % to them.
        assert!(shift.abs() < 4.0 / effective.sqrt() + 0.1, "{name}: {shift}");
        assert!((ratio - 1.0).abs() < 4.0 / (2.0 * effective).sqrt() + 0.08, "{name}: {ratio}");
    }
}

#[test]
fn draws_depend_on_the_seed_and_not_on_the_threads() {
    // One number takes less time.
    let found = found(&NAMES[..1]);
    let sampling = FitPosterior { draws: 10, chains: 2, seed: 5 };
    let on = |threads: usize, sampling: FitPosterior| -> Posterior {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sample(&found.standardised().unwrap(), sampling, &mut ()).unwrap())
    };
    let one = on(1, sampling);
    assert_eq!(one, on(3, sampling));
    let other = on(2, FitPosterior { seed: 6, chains: 1, ..sampling });
    assert_ne!(one.values[0][..10], other.values[0][..10]);
    assert_ne!(one.values[0][..10], one.values[0][10..20], "each chain has its own random numbers");
    // The logarithm of the density is that of the draw.
    let target = found.standardised().unwrap();
    assert!(
        one.log_density
            .iter()
            .all(|density| *density <= target.log_density(&[0.0], &mut ()).unwrap().0 + 1e-3)
    );
}

/// The ranks of truths from the prior among 39 draws, for `replicas` simulated curves: χ² of their counts in `bins` bins, at most
/// `most`.
fn assert_uniform_ranks(replicas: u64, bins: usize, most: f64) {
    // Simulation-based calibration (Talts et al., arXiv:1804.06788): a truth from the prior, readings of it, draws from the
    // posterior; the rank of the truth among them is uniform.
    let names = ["thresholds.mean", "count"];
    let prior = [Prior { value: 1.0, error: 0.1 }, Prior { value: 1000.0, error: 150.0 }];
    let ranks = |replica: u64| -> [usize; 2] {
        let mut stream = Stream::new(replica, Purpose::Sample, 1);
        // Normal in the logarithm, as priors of numbers above 0 are.
        let truth = prior.map(|prior| prior.value * (prior.error / prior.value * normal(&mut stream)).exp());
        let measured = readings([truth[0], 0.2, truth[1]], (8, 1.6, 60.0), replica);
        let white = ErrorModel { contacts: false, reading: Some(60.0), ..ErrorModel::default() };
        let fit = Fit::new(equation([1.0, 0.2, 1000.0]), measured).free(names).errors(white);
        let fit = fit.prior(names[0], prior[0]).prior(names[1], prior[1]);
        // Every second of 78 draws, so that they are nearly independent.
        let sampling = FitPosterior { draws: 78, chains: 1, seed: replica };
        let drawn = sample(&fit.run().unwrap().standardised().unwrap(), sampling, &mut ()).unwrap();
        [0, 1].map(|k| drawn.values[k].iter().step_by(2).filter(|value| **value < truth[k]).count())
    };
    let done = AtomicU64::new(0);
    let counted = |replica: u64| {
        let ranks = ranks(replica);
        let done = 1 + done.fetch_add(1, Ordering::Relaxed);
        if done.is_multiple_of(25) {
            println!("{done} of {replicas} replicas");
        }
        ranks
    };
    let all: Vec<[usize; 2]> = (0..replicas).into_par_iter().map(counted).collect();
    for k in 0..2 {
        let mut counts = vec![0.0; bins];
        all.iter().for_each(|ranks| counts[ranks[k] * bins / 40] += 1.0);
        let expected = replicas as f64 / bins as f64;
        let chi_squared: f64 = counts.iter().map(|count| (count - expected).powi(2) / expected).sum();
        println!(
            "{}: χ² = {chi_squared:.1} of the ranks of {replicas} truths in {bins} bins: {counts:?}",
            names[k]
        );
        assert!(chi_squared < most, "{}: {chi_squared} {counts:?}", names[k]);
    }
}

#[test]
fn truths_drawn_from_the_prior_have_uniform_ranks_among_the_draws() {
    // p = 0.001 for 3 degrees of freedom.
    assert_uniform_ranks(20, 4, 16.27);
}

#[test]
#[ignore = "some minutes"]
fn truths_drawn_from_the_prior_have_uniform_ranks_in_ten_bins() {
    // p = 0.001 for 9 degrees of freedom.
    assert_uniform_ranks(200, 10, 27.88);
}
