//! Fits to records of the force in steady sliding that the ensemble makes contact by contact: values, errors, intervals, and what
//! a record cannot determine.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::fit::{Prior, SteadyEstimates, SteadyFit, SteadyRecord};
use asperity::law::{Exponential, Gaussian, Point, SharedLaw};
use asperity::master::MasterEquation;
use asperity::random::{Purpose, Stream};
use rayon::prelude::*;

use crate::pulls::together;

/// Contacts of Gaussian thresholds, re-formed at stretches G(.1, .03).
fn contacts(count: f64, [mean, std]: [f64; 2]) -> Contacts {
    let spread: SharedLaw = Arc::new(Gaussian::new(0.1, 0.03).unwrap());
    Contacts { count, ..Contacts::new(Arc::new(Gaussian::new(mean, std).unwrap()), spread) }
}

/// The same, re-formed at 0, which the solver takes less time for.
fn relaxed(count: f64, parameters: [f64; 2]) -> Contacts {
    Contacts { reforming: Arc::new(Point::new(0.0).unwrap()), ..contacts(count, parameters) }
}

/// The force of 2000 contacts, G(1, .12), one by one, after 60 mean thresholds: the transient falls by e⁻¹ over 2.4 of them.
fn simulated(n: usize, spacing: f64, seed: u64) -> SteadyRecord {
    simulated_of(contacts(2000.0, [1.0, 0.12]), (n, spacing), seed)
}

/// The same of other contacts.
fn simulated_of(contacts: Contacts, (n, spacing): (usize, f64), seed: u64) -> SteadyRecord {
    let positions: Vec<f64> = (0..n).map(|i| 60.0 + spacing * i as f64).collect();
    let count = contacts.count as usize;
    let ensemble = Ensemble::new(contacts, Initial::default(), count, seed, Disorder::Annealed).unwrap();
    SteadyRecord::at_positions(&positions, ensemble.pull(&positions).unwrap().force).unwrap()
}

fn guess() -> MasterEquation {
    MasterEquation::new(contacts(1500.0, [0.9, 0.2]), &Initial::default()).unwrap()
}

/// The names, and true values, of the numbers that are fitted to such records.
const TRUE: [(&str, f64); 4] =
    [("thresholds.mean", 1.0), ("thresholds.std", 0.12), ("count", 2000.0), ("stiffness", 1.0)];

fn names() -> impl Iterator<Item = &'static str> {
    TRUE.into_iter().map(|number| number.0)
}

fn relative_error(found: &SteadyEstimates, name: &str) -> f64 {
    let estimate = found.estimate(name).unwrap();
    estimate.error / estimate.value
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_tell() {
    let one = |seed: u64| {
        let record = simulated_of(relaxed(2000.0, [1.0, 0.12]), (2000, 0.1), seed);
        let guess = MasterEquation::new(relaxed(1500.0, [0.9, 0.2]), &Initial::default()).unwrap();
        SteadyFit::new(guess, record).free(names()).reading(0.0).run().unwrap()
    };
    let found: Vec<SteadyEstimates> = (0..40_u64).into_par_iter().map(one).collect();
    assert!(found.iter().all(|found| found.converged));
    let held = TRUE.map(|(name, value)| {
        let holds = |found: &&SteadyEstimates| {
            let [low, high] = found.estimate(name).unwrap().interval;
            low <= value && value <= high
        };
        found.iter().filter(holds).count()
    });
    // 38 of 40; fewer than 32 have a probability of 1e-4.
    assert!(held.iter().all(|held| *held >= 32), "{held:?}");
    for (name, value) in TRUE {
        let of =
            |of: &dyn Fn(&SteadyEstimates) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
        let mean = of(&|found| found.estimate(name).unwrap().value);
        let scatter = of(&|found| (found.estimate(name).unwrap().value - mean).powi(2)).sqrt();
        let reported = of(&|found| found.estimate(name).unwrap().error);
        // The mean of 40 scatters by a sixth of an error; the bias is of second order in errors of a few percent. The square of
        // the scatter is χ²/39 of 39 degrees of freedom: below 0.36 or above 2.07 with 1e-4 each. Errors off by 1.5 make 0.44 or
        // 2.25 of 1.
        assert!((mean - value).abs() < 0.65 * reported, "{name}: {mean}");
        assert!((0.36..2.07).contains(&(scatter / reported).powi(2)), "{name}: {scatter} {reported}");
    }
    // All numbers together, by their covariance: χ²/160 of 160 degrees of freedom is below 0.63 or above 1.46 with 1e-4 each.
    let off = |found: &SteadyEstimates| together((&found.parameters, &found.covariance), &TRUE);
    let off = found.iter().map(off).sum::<f64>() / 160.0;
    assert!((0.63..1.46).contains(&off), "{off}");
    // P-values of the test of whiteness are uniform: the number below 0.05 is 2 ± 1.4; 9 of 40 have a probability of 2e-4.
    let unlikely = found.iter().filter(|found| found.misfit.whiteness < 0.05).count();
    assert!(unlikely < 9, "{unlikely}");
}

#[test]
fn noise_alone_tells_number_mean_and_width() {
    let found = SteadyFit::new(guess(), simulated(4000, 0.04, 3)).free(names()).run().unwrap();
    assert!(found.converged && !found.misfit.is_unlikely());
    for ((name, value), most) in TRUE.into_iter().zip([0.012, 0.05, 0.036, 0.036]) {
        let estimate = found.estimate(name).unwrap();
        assert!((estimate.value - value).abs() < 4.0 * estimate.error, "{estimate:?}");
        assert!(relative_error(&found, name) < most, "{estimate:?}");
    }
    // The readings are exact: there is only a limit of their error, a small part of the noise.
    let reading = found.estimate("reading").unwrap();
    assert!(
        reading.limit.is_some_and(|limit| limit < 0.1 * found.equation().steady_state().force_std(2000.0))
    );
}

/// The force of contacts with exponential thresholds of mean m that re-form at 0 has the autocovariance N k² m² e^{−u/m} and the
/// mean N k m: a record of such a process is one of an autoregression of first order, made here without any contact.
#[test]
fn a_process_with_a_closed_autocovariance_gives_its_numbers() {
    let (mean, count, n, spacing) = (0.7_f64, 900.0_f64, 20_000, 0.1);
    let mut stream = Stream::new(11, Purpose::Sample, 0);
    let mut normal = move || {
        let radius = (-2.0 * (1.0 - stream.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * stream.uniform()).cos()
    };
    let kept = (-spacing / mean).exp();
    let mut state = normal();
    let reading = 5.0;
    let forces = (0..n).map(|_| {
        state = kept * state + (1.0 - kept * kept).sqrt() * normal();
        count * mean + 20.0 + count.sqrt() * mean * state + reading * normal()
    });
    let forces = forces.collect();
    let contacts = Contacts {
        count: 500.0,
        ..Contacts::new(Arc::new(Exponential::new(1.0).unwrap()), Arc::new(Point::new(0.0).unwrap()))
    };
    let guess = MasterEquation::new(contacts, &Initial::default()).unwrap();
    let fit = SteadyFit::new(guess, SteadyRecord { spacing, forces }).offset(20.0);
    let found = fit.free(["thresholds.mean", "count"]).run().unwrap();
    assert!(found.converged && !found.misfit.is_unlikely(), "{:?}", found.misfit);
    for (name, value) in [("thresholds.mean", mean), ("count", count), ("reading", reading)] {
        let estimate = found.estimate(name).unwrap();
        assert!((estimate.value - value).abs() < 3.5 * estimate.error, "{estimate:?}");
        // An error that is larger than some per cent would make the first bound empty.
        assert!(estimate.error < 0.05 * value, "{estimate:?}");
    }
}

/// The expected periodogram is the mean over many records: by the ensemble, contact by contact.
#[test]
fn the_expected_periodogram_is_the_mean_of_many() {
    // A short record: the ends leak into all ordinates, and the spacing aliases. Forces of so many contacts are nearly normal.
    const COUNT: f64 = 200.0;
    let (n, spacing) = (64, 0.25);
    let record = |seed: u64| simulated_of(contacts(COUNT, [1.0, 0.12]), (n, spacing), seed);
    // h|Σ_j F_j e^{−2πijk/n}|²/n for k = 1 … n/2.
    let periodogram = |record: SteadyRecord| -> Vec<f64> {
        let component = |k: usize| {
            let [mut re, mut im] = [0.0; 2];
            for (j, force) in record.forces.iter().enumerate() {
                let (sin, cos) = (std::f64::consts::TAU * (j * k % n) as f64 / n as f64).sin_cos();
                (re, im) = (re + force * cos, im - force * sin);
            }
            spacing * (re * re + im * im) / n as f64
        };
        (1..=n / 2).map(component).collect()
    };
    let all: Vec<Vec<f64>> = (0..1000_u64).into_par_iter().map(|seed| periodogram(record(seed))).collect();
    let truth = MasterEquation::new(contacts(COUNT, [1.0, 0.12]), &Initial::default()).unwrap();
    let fit = SteadyFit::new(truth, record(0)).free(["count"]).reading(0.0);
    // What is expected is that of the true number of contacts.
    let fit = fit.prior("count", Prior { value: COUNT, error: 1e-4 });
    let spectrum = fit.run().unwrap().spectrum;
    for k in 0..32 {
        let mean = all.iter().map(|one| one[k]).sum::<f64>() / all.len() as f64;
        // Each is exponentially distributed, the last one as a square of a normal number.
        let error = if k == 31 { 2.0_f64.sqrt() } else { 1.0 } / (all.len() as f64).sqrt();
        let ratio = mean / spectrum.expected[k];
        // Rounding: forces of 100 are known to 1e-14, their squares are summed 64 times.
        assert!(
            (spectrum.periodogram[k] - all[0][k]).abs() < 1e-9,
            "{k}: {} {}",
            spectrum.periodogram[k],
            all[0][k]
        );
        assert!((ratio - 1.0).abs() < 4.5 * error, "{k}: {ratio}");
    }
}

#[test]
fn a_search_that_starts_far_from_the_truth_finds_it() {
    let record = simulated_of(relaxed(2000.0, [1.0, 0.12]), (2000, 0.1), 5);
    let values = |start: [f64; 2]| -> Vec<f64> {
        let guess = MasterEquation::new(relaxed(100.0, start), &Initial::default()).unwrap();
        let found = SteadyFit::new(guess, record.clone()).free(names()).reading(0.0).run().unwrap();
        assert!(found.converged, "{start:?}");
        found.parameters.iter().map(|estimate| (estimate.value - 1.0) / estimate.error).collect()
    };
    let near = values([1.0, 0.12]);
    for start in [[0.7, 0.1], [1.4, 0.1], [0.8, 0.3]] {
        for (a, b) in near.iter().zip(values(start)) {
            // A search ends within a thousandth of an error.
            assert!((a - b).abs() < 5e-3 * a.abs().max(1.0), "{start:?}: {a} {b}");
        }
    }
}

#[test]
fn the_error_of_a_normal_number_is_that_of_its_profile() {
    let found = SteadyFit::new(guess(), simulated(1000, 0.1, 8)).free(names()).reading(0.0).run().unwrap();
    let mean = found.estimate("thresholds.mean").unwrap();
    let profile = found.interval_by_profile("thresholds.mean", &mut ()).unwrap();
    for (end, reported) in profile.into_iter().zip(mean.interval) {
        // The likelihood of 1000 readings is nearly a parabola: its third derivative is of the order of the relative error, 1 %.
        assert!((end - reported).abs() < 0.2 * mean.error, "{profile:?} {mean:?}");
    }
    // At the ends −2 ln L has risen by 1.96², to a hundredth of the interval.
    let rise = found.profile("thresholds.mean", profile[1], &mut ()).unwrap();
    assert!((rise - 3.8415).abs() < 0.08, "{rise}");
    let values = found.profile_values("thresholds.mean", 3).unwrap();
    let expected = [-3.0, 0.0, 3.0].map(|z| mean.value + z * mean.error);
    assert!(values.iter().zip(expected).all(|(value, expected)| (value / expected - 1.0).abs() < 1e-12));
    // The gradient of the likelihood beside the estimates is its slope.
    let estimates: Vec<f64> = found.parameters.iter().map(|estimate| estimate.value).collect();
    let at_estimates = found.log_likelihood(&estimates, &mut ()).unwrap().0;
    assert!((at_estimates + 0.5 * found.misfit.deviance).abs() < 1e-9 * at_estimates.abs());
    let errors = found.parameters.iter().map(|estimate| estimate.error);
    let beside: Vec<f64> = estimates.iter().zip(errors).map(|(value, error)| value + 2.0 * error).collect();
    let gradient = found.log_likelihood(&beside, &mut ()).unwrap().1;
    for (k, estimate) in found.parameters.iter().enumerate() {
        let likelihood = |side: f64| {
            let mut moved = beside.clone();
            moved[k] += side * 0.02 * estimate.error;
            found.log_likelihood(&moved, &mut ()).unwrap().0
        };
        let slope = (likelihood(1.0) - likelihood(-1.0)) / (0.04 * estimate.error);
        // Derivatives of the expected periodogram by differences are right to 1e-5.
        let allowed = 1e-5 * slope.abs() + 1e-2 / estimate.error;
        assert!((gradient[k] - slope).abs() < allowed, "{k}: {} {slope}", gradient[k]);
    }
}

#[test]
fn what_a_record_does_not_determine_is_refused_with_the_direction() {
    let record = simulated(2000, 0.1, 6);
    // Noise and mean determine N⟨k⟩² and N⟨k⟩; where the zero of the force is not known, only the first.
    let error = SteadyFit::new(guess(), record.clone())
        .free(["count", "stiffness", "offset"])
        .reading(0.0)
        .run()
        .unwrap_err()
        .to_string();
    assert!(
        ["record", "ln count", "ln stiffness", "offset"].iter().all(|name| error.contains(name)),
        "{error}"
    );
    // A shift of thresholds and starts changes the mean only.
    let free = ["thresholds.mean", "reforming.mean", "count", "stiffness"];
    let error =
        SteadyFit::new(guess(), record.clone()).free(free).reading(0.0).run().unwrap_err().to_string();
    assert!(free.iter().all(|name| error.contains(name)), "{error}");
    // A prior of one of them is enough.
    let known = SteadyFit::new(guess(), record)
        .free(["count", "stiffness", "offset"])
        .prior("stiffness", Prior { value: 1.0, error: 0.01 })
        .reading(0.0);
    assert!(known.run().unwrap().converged);
}

#[test]
fn wrong_input_is_refused_with_its_name() {
    let record = simulated(100, 0.1, 1);
    let refused = |fit: SteadyFit| fit.run().unwrap_err().to_string();
    let fit = |record: &SteadyRecord| SteadyFit::new(guess(), record.clone());
    let reported = |error: &str, words: &str| assert!(error.contains(words), "{error}");
    reported(&refused(fit(&record)), "free: expected at least one key");
    reported(&refused(fit(&record).free(["initial.max"])), "free.0: expected one of thresholds.mean");
    reported(&refused(fit(&record).free(["count", "count"])), "free.1: expected each key once");
    reported(
        &refused(fit(&record).free(["count"]).prior("stiffness", Prior { value: 1.0, error: 0.1 })),
        "prior.stiffness",
    );
    reported(&refused(fit(&record).free(["count"]).reading(-1.0)), "reading");
    reported(&refused(fit(&record).free(["count"]).offset(f64::NAN)), "offset");
    reported(
        &refused(fit(&record).free([
            "count",
            "stiffness",
            "thresholds.mean",
            "thresholds.std",
            "reforming.std",
            "offset",
            "reforming.mean",
        ])),
        "force: expected 112 readings",
    );
    reported(&refused(fit(&SteadyRecord { spacing: 0.0, ..record.clone() }).free(["count"])), "spacing");
    let mut broken = record.clone();
    broken.forces[7] = f64::NAN;
    reported(&refused(fit(&broken).free(["count"])), "force.7");
    reported(
        &refused(fit(&SteadyRecord { forces: vec![3.0; 50], ..record }).free(["count"])),
        "force: expected forces that scatter",
    );
    let unequal = SteadyRecord::at_positions(&[0.0, 1.0, 2.1, 3.0], vec![0.0; 4]).unwrap_err().to_string();
    reported(&unequal, "position.2: expected equal steps");
    let fewer = SteadyRecord::at_positions(&[0.0, 1.0], vec![0.0]).unwrap_err().to_string();
    reported(&fewer, "force: expected 2 forces");
}

#[test]
fn contacts_without_a_known_noise_are_refused_with_the_reason() {
    let record = simulated(100, 0.1, 1);
    let alike = Contacts::new(Arc::new(Point::new(1.0).unwrap()), Arc::new(Point::new(0.0).unwrap()));
    let mut free = contacts(1.0, [1.0, 0.1]);
    free.rules.delay = 0.5.into();
    for (contacts, reason) in [(alike, "lines"), (free, "delay")] {
        let equation = MasterEquation::at(contacts, &Initial::default(), 1.0).unwrap();
        let error = SteadyFit::new(equation, record.clone()).free(["count"]).run().unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
}

#[test]
fn friction_of_a_record_has_the_error_of_its_mean() {
    let record = simulated(4000, 0.1, 2);
    let found = SteadyFit::new(guess(), record.clone()).free(names()).reading(0.0).run().unwrap();
    let friction = found.friction(&mut ()).unwrap().kinetic_friction;
    // The mean is the only datum of F_k, and its variance is the mean of c(u) over all pairs of readings.
    let advances: Vec<f64> = (0..4000).map(|u| 0.1 * f64::from(u)).collect();
    let size = found.equation().contacts().count;
    let covariance = found.equation().steady_state().autocovariance(&advances, size).unwrap();
    let pairs = covariance
        .iter()
        .enumerate()
        .map(|(u, c)| if u == 0 { 4000.0 * c } else { 2.0 * (4000 - u) as f64 * c });
    let exact = pairs.sum::<f64>().sqrt() / 4000.0;
    // The rest is the error of derivatives by differences, which the closed derivative of F_k has not.
    assert!((friction.error / exact - 1.0).abs() < 1e-3, "{friction:?} {exact}");
    assert!((friction.value - record.mean()).abs() < 0.05 * friction.error, "{friction:?}");
}
