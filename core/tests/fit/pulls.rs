//! Fits to curves made by the ensemble, contact by contact: values, errors, intervals, and what a curve cannot tell.

use std::ops::Range;
use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Stiffness};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::fit::{ErrorModel, Estimate, Estimates, Fit, Machine, Measurement, Prior};
use asperity::law::{Gamma, Gaussian, Law, Lognormal, Point, SharedLaw, Weibull};
use asperity::master::MasterEquation;
use asperity::random::{Purpose, Stream};
use rayon::prelude::*;

/// Contacts of Gaussian thresholds, re-formed at stretches of `reforming`.
pub fn contacts(count: f64, [mean, std]: [f64; 2], reforming: SharedLaw) -> Contacts {
    Contacts { count, ..Contacts::new(Arc::new(Gaussian::new(mean, std).unwrap()), reforming) }
}

pub fn spread() -> SharedLaw {
    Arc::new(Gaussian::new(0.1, 0.03).unwrap())
}

pub fn positions(count: usize, last: f64) -> Vec<f64> {
    (1..=count).map(|i| last * (i as f64 / count as f64)).collect()
}

/// The force of 2000 contacts, G(1, .12), R = G(.1, .03), one by one.
pub fn simulated(positions: &[f64], seed: u64) -> Vec<f64> {
    let contacts = contacts(2000.0, [1.0, 0.12], spread());
    let ensemble = Ensemble::new(contacts, Initial::default(), 2000, seed, Disorder::Annealed).unwrap();
    ensemble.pull(positions).unwrap().force
}

/// The names, and true values, of the numbers that are fitted to such curves.
pub const TRUE: [(&str, f64); 4] =
    [("thresholds.mean", 1.0), ("thresholds.std", 0.12), ("count", 2000.0), ("stiffness", 1.0)];

pub fn fit(positions: &[f64], forces: Vec<f64>) -> Fit {
    let guess = MasterEquation::new(contacts(1500.0, [0.9, 0.2], spread()), &Initial::default()).unwrap();
    Fit::new(guess, Measurement::new(positions.to_vec(), forces))
}

/// Fits to curves with these seeds.
fn coverage(errors: ErrorModel, free: &[&str], seeds: Range<u64>) -> ([usize; 4], Vec<Estimates>) {
    let positions = positions(300, 6.0);
    let one = |seed: u64| -> Estimates {
        let fit = fit(&positions, simulated(&positions, seed)).free(free.iter().copied()).errors(errors);
        fit.run().unwrap()
    };
    let found: Vec<Estimates> = seeds.into_par_iter().map(one).collect();
    assert!(found.iter().all(|found| found.converged));
    let covered = TRUE.map(|(name, value)| {
        let holds = |found: &&Estimates| {
            found.estimate(name).is_some_and(|n| n.interval[0] <= value && value <= n.interval[1])
        };
        found.iter().filter(holds).count()
    });
    (covered, found)
}

/// The mean square of what the estimates of a number are off, in errors; of their logarithms, in which intervals are symmetric.
pub fn off(found: &[Estimates], (name, value): (&str, f64)) -> f64 {
    let off = |found: &Estimates| {
        let number = found.estimate(name).unwrap();
        ((number.value / value).ln() * number.value / number.error).powi(2)
    };
    found.iter().map(off).sum::<f64>() / found.len() as f64
}

/// The square of what all estimates together are off, χ² of as many degrees of freedom as there are numbers; of their logarithms.
pub fn together((estimates, covariance): (&[Estimate], &[f64]), truth: &[(&str, f64)]) -> f64 {
    let all = estimates.len();
    let places: Vec<usize> = truth
        .iter()
        .map(|(name, _)| estimates.iter().position(|found| found.name == *name).unwrap())
        .collect();
    let scaled = |&i: &usize, &j: &usize| covariance[i * all + j] / (estimates[i].value * estimates[j].value);
    let mut rows: Vec<Vec<f64>> =
        places.iter().map(|i| places.iter().map(|j| scaled(i, j)).collect()).collect();
    let mut right: Vec<f64> =
        places.iter().zip(truth).map(|(&i, (_, value))| (estimates[i].value / value).ln()).collect();
    let mut sum = 0.0;
    // vᵀV⁻¹v by elimination: what is left of a number, squared, over what is left of its variance.
    for k in 0..right.len() {
        sum += right[k] * right[k] / rows[k][k];
        for i in k + 1..right.len() {
            let factor = rows[i][k] / rows[k][k];
            right[i] -= factor * right[k];
            for j in k..right.len() {
                rows[i][j] -= factor * rows[k][j];
            }
        }
    }
    sum
}

#[test]
fn intervals_with_the_noise_of_contacts_hold_the_truth_and_white_ones_do_not() {
    let (covered, found) = coverage(ErrorModel::default(), &TRUE.map(|number| number.0), 0..100);
    let mean = |of: &dyn Fn(&Estimates) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
    let count = mean(&|found| found.estimate("count").unwrap().value);
    let chi_squared = mean(&|found| found.misfit.unwrap().chi_squared);
    let together = mean(&|found| together((&found.parameters, &found.covariance), &TRUE)) / 3.0;
    let off = TRUE.map(|number| off(&found, number));
    println!("covered {covered:?}, off {off:?}, {together}, mean count {count}, mean χ² {chi_squared}");
    // 95 of 100, with a standard deviation of 2.2.
    assert!(covered.iter().all(|covered| (90..=99).contains(covered)), "{covered:?}");
    // χ²/100 of 100 degrees of freedom is below 0.55 or above 1.6 with 1e-4 each, χ²/300 of 300 below 0.72 or above 1.33. Errors
    // off by 1.5 make 0.44 or 2.25 of 1. One of the four is known without error, N⟨k⟩, of readings before the first contact breaks.
    assert!((0.72..1.33).contains(&together), "{together}");
    assert!(off.iter().all(|off| (0.55..1.6).contains(off)), "{off:?}");
    // The relative error of N is sqrt(2/300) = 8 %, that of the mean of 100 curves 0.8 %, and its bias of the order of 1/300 per
    // free number.
    assert!((count / 2000.0 - 1.0).abs() < 0.03, "{count}");
    // N makes χ² the number of readings with noise, less three of the curve. Up to X = 0.44, 22 readings, fewer than one in a hundred
    // curves has a broken contact: residuals are 0, and the smallest error of a reading that is tried, 0.02 of the roughness of the
    // residuals, is above the noise. In the next readings the error takes a part of the noise, in each curve of one reading or two.
    let noisy = 300.0 - 22.0 - 3.0;
    assert!((chi_squared - noisy).abs() < 4.0, "{chi_squared}");
    let white = ErrorModel { contacts: false, ..ErrorModel::default() };
    let (covered, _) = coverage(white, &["thresholds.mean", "thresholds.std", "count"], 0..20);
    println!("of white noise {covered:?}");
    assert!(covered[..3].iter().all(|covered| *covered < 16), "{covered:?}");
}

#[test]
fn errors_of_known_size_have_the_chi_squared_of_independent_normal_numbers() {
    let (positions, reading) = (positions(300, 6.0), 3.0);
    let errors = ErrorModel { reading: Some(reading), ..ErrorModel::default() };
    let normal = Gaussian::new(40.0, 1.0).unwrap();
    let one = |seed: u64| {
        let mut stream = Stream::new(seed, Purpose::Sample, 0);
        let mut read = |force: f64| force + reading * (normal.quantile(stream.uniform()) - 40.0);
        let forces = simulated(&positions, seed).into_iter().map(&mut read).collect();
        let contacts = contacts(2000.0, [0.95, 0.15], spread());
        let guess = MasterEquation::new(contacts, &Initial::default()).unwrap();
        let free = ["thresholds.mean", "thresholds.std"];
        let fit = Fit::new(guess, Measurement::new(positions.clone(), forces)).free(free).errors(errors);
        let misfit = fit.run().unwrap().misfit.unwrap();
        assert_eq!(misfit.degrees_of_freedom, 298);
        [misfit.chi_squared, f64::from(u8::from(misfit.is_unlikely()))]
    };
    let found: Vec<[f64; 2]> = (0..36_u64).into_par_iter().map(one).collect();
    let mean = found.iter().map(|[chi_squared, _]| chi_squared).sum::<f64>() / 36.0;
    // Four standard errors of the mean of 36.
    assert!((mean - 298.0).abs() < 4.0 * (2.0 * 298.0_f64).sqrt() / 6.0, "{mean}");
    // Two tests at p = 0.001 each: three of 36 have a probability of 1e-4.
    assert!(found.iter().map(|[_, unlikely]| unlikely).sum::<f64>() < 3.0);
}

/// No curve shows how much wider thresholds are than ten of their means, or than twice what is given.
#[test]
fn widths_beyond_ten_means_are_not_tried() {
    let possible = |given: f64, widths: [f64; 2]| {
        let thresholds = Arc::new(Lognormal::new(1.0, given).unwrap());
        let guess = Contacts::new(thresholds, Arc::new(Point::new(0.0).unwrap()));
        let guess = MasterEquation::new(guess, &Initial::default()).unwrap();
        let positions = positions(20, 2.0);
        let pull = guess.pull(2.0).unwrap();
        let forces = positions.iter().map(|&x| pull.force(x)).collect();
        let white = ErrorModel { contacts: false, reading: Some(0.01), ..ErrorModel::default() };
        let fit = Fit::new(guess, Measurement::new(positions, forces));
        let found = fit.free(["thresholds.mean", "thresholds.std"]).errors(white).run().unwrap();
        widths.map(|width| found.log_likelihood(&[1.0, width], &mut ()).unwrap().0.is_finite())
    };
    assert_eq!(possible(0.5, [9.9, 10.1]), [true, false]);
    assert_eq!(possible(12.0, [23.8, 24.2]), [true, false]);
}

/// The force of contacts at given positions by the master equation.
pub fn exact(contacts: Contacts, positions: &[f64]) -> Vec<f64> {
    let pull = MasterEquation::new(contacts, &Initial::default()).unwrap().pull(6.0).unwrap();
    positions.iter().map(|&x| pull.force(x)).collect()
}

#[test]
fn a_curve_without_noise_gives_its_numbers_and_those_of_the_machine() {
    let positions = positions(200, 5.0);
    let truth = contacts(2000.0, [1.0, 0.12], spread());
    let readings = exact(truth, &positions).into_iter().zip(&positions);
    let readings = readings.map(|(force, x)| force + 30.0 + 2.0 * x).collect();
    let white = ErrorModel { contacts: false, ..ErrorModel::default() };
    let found = fit(&positions, readings)
        .free(["thresholds.mean", "thresholds.std", "count", "offset", "trend"])
        .errors(white)
        .run()
        .unwrap();
    assert!(found.converged);
    let truth = [
        ("thresholds.mean", 1.0),
        ("thresholds.std", 0.12),
        ("count", 2000.0),
        ("offset", 30.0),
        ("trend", 2.0),
    ];
    for (name, value) in truth {
        // Errors of the solution, 1e-10 of the force, and of its derivatives; the forces vary by as much as these numbers.
        let found = found.estimate(name).unwrap().value;
        assert!((found / value - 1.0).abs() < 1e-7, "{name}: {found}");
    }
}

#[test]
fn a_fit_of_four_numbers_takes_few_solutions() {
    let positions = positions(2000, 6.0);
    let white = ErrorModel { contacts: false, ..ErrorModel::default() };
    let fit = fit(&positions, simulated(&positions, 3)).errors(white);
    let found = fit.free(["thresholds.mean", "thresholds.std", "count", "offset"]).run().unwrap();
    // What the page of costs says.
    assert!(found.converged && found.solutions <= 12, "{}", found.solutions);
}

#[test]
fn sizes_of_errors_are_found_without_solutions() {
    let positions = positions(600, 6.0);
    let fit = fit(&positions, simulated(&positions, 3)).free(TRUE.map(|(name, _)| name));
    let white = ErrorModel { contacts: false, ..ErrorModel::default() };
    let alone = fit.clone().free(["thresholds.mean", "thresholds.std", "count"]).errors(white).run().unwrap();
    let found = fit.run().unwrap();
    // One for each of two steps, with every third reading and with all, one to check each, and one for the limit of the reading.
    let most = alone.solutions + 5;
    assert!(found.converged && found.solutions <= most, "{} of {most}", found.solutions);
}

#[test]
fn a_compliance_is_found_from_the_drive() {
    let slider = positions(200, 5.0);
    let forces = exact(contacts(2000.0, [1.0, 0.3], spread()), &slider);
    // Below the critical stiffness of these contacts the slider does not slip.
    let compliance = 1e-4;
    let drive = slider.iter().zip(&forces).map(|(x, force)| x + compliance * force).collect();
    let machine = Machine { compliance: 2e-4, ..Machine::default() };
    let measurement = Measurement { machine, ..Measurement::new(drive, forces) };
    let guess = MasterEquation::new(contacts(1900.0, [1.05, 0.33], spread()), &Initial::default()).unwrap();
    let white = ErrorModel { contacts: false, ..ErrorModel::default() };
    let free = ["thresholds.mean", "thresholds.std", "count", "compliance"];
    let found = Fit::new(guess, measurement).free(free).errors(white).run().unwrap();
    let (found, reached) = (found.estimate("compliance").unwrap().value, &found.readings[0].positions);
    assert!((found / compliance - 1.0).abs() < 1e-6, "{found}");
    let apart = reached.iter().zip(&slider).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-6, "{apart}");
}

/// Two loadings of 2000 contacts behind a machine, up to shortly before it slips, with reading errors of 2.
fn loadings(compliance: f64) -> [Measurement; 2] {
    let slider = positions(100, 0.86);
    let normal = Gaussian::new(40.0, 1.0).unwrap();
    [21, 22].map(|seed| {
        let forces = simulated(&slider, seed);
        let drive: Vec<f64> = slider.iter().zip(&forces).map(|(x, force)| x + compliance * force).collect();
        let mut stream = Stream::new(seed, Purpose::Sample, 0);
        let mut error = || 2.0 * (normal.quantile(stream.uniform()) - 40.0);
        let readings: Vec<f64> = forces.iter().map(|force| force + error()).collect();
        // Where several contacts break, the drive of equilibrium may go back: what is measured is what comes next.
        let highest = |i: usize| drive[..i].iter().fold(0.0, |most: f64, y| most.max(*y));
        let kept: Vec<usize> = (0..drive.len()).filter(|&i| drive[i] > highest(i)).collect();
        let of = |values: &[f64]| kept.iter().map(|&i| values[i]).collect();
        Measurement::new(of(&drive), of(&readings))
    })
}

/// A fit to [`loadings`] behind a machine of this compliance; without the noise of contacts their stiffness is fixed.
fn behind(compliance: f64, loadings: &[Measurement; 2], is_free: bool, errors: ErrorModel) -> Estimates {
    let machine = Machine { compliance, ..Machine::default() };
    let [first, second] = loadings.clone().map(|loading| Measurement { machine, ..loading });
    let guess = MasterEquation::new(contacts(1800.0, [0.9, 0.2], spread()), &Initial::default()).unwrap();
    let free = TRUE.iter().take(if errors.contacts { 4 } else { 3 }).map(|number| number.0);
    let free = free.chain(is_free.then_some("compliance"));
    Fit::new(guess, first).curve(second).free(free).errors(errors).run().unwrap()
}

/// Behind a compliance far from the true one the contacts of a guess break in other places: a search from there would end where
/// contacts of small thresholds slide steadily.
#[test]
fn first_values_of_a_compliance_may_be_far_off() {
    let loadings = loadings(2e-4);
    let white = ErrorModel { contacts: false, ..ErrorModel::default() };
    let run = |[mean, std]: [f64; 2], compliance: f64| {
        let machine = Machine { compliance, ..Machine::default() };
        let [first, second] = loadings.clone().map(|loading| Measurement { machine, ..loading });
        let guess =
            MasterEquation::new(contacts(1800.0, [mean, std], spread()), &Initial::default()).unwrap();
        let free = ["thresholds.mean", "thresholds.std", "count", "compliance"];
        let found = Fit::new(guess, first).curve(second).free(free).errors(white).run().unwrap();
        assert!(found.converged, "from {mean}, {std}, {compliance}");
        found.parameters
    };
    let near = run([1.0, 0.12], 2e-4);
    // Every one of five guesses and of five compliances, and the far ones of both together.
    for (guess, compliance) in [
        ([0.9, 0.2], 4e-4),
        ([1.0, 0.12], 5e-5),
        ([1.2, 0.2], 1e-4),
        ([0.8, 0.1], 2e-5),
        ([3.0, 0.5], 2e-4),
        ([3.0, 0.5], 2e-5),
        ([3.0, 0.5], 4e-4),
    ] {
        for (found, near) in run(guess, compliance).iter().zip(&near) {
            // Searches end within a thousandth of an error of the same place, along a valley that is hardly curved.
            let apart = (found.value - near.value).abs();
            assert!(apart < 0.02 * near.error, "from {guess:?}, {compliance}: {found:?}");
        }
    }
}

/// Before a slip, a stiffer machine and contacts of larger thresholds make nearly the same curve, but not the same one.
#[test]
fn a_compliance_is_found_from_loadings_before_a_slip() {
    let truth = 2e-4;
    let loadings = loadings(truth);
    let of = |found: &Estimates| {
        assert!(found.converged);
        found.estimate("compliance").unwrap().clone()
    };
    let starts = [4e-4, 2e-5];
    let all = starts.map(|start| of(&behind(start, &loadings, true, ErrorModel::default())));
    for (found, start) in all.iter().zip(starts) {
        // Searches end within a thousandth of an error of the same place, for the noise at slightly other values.
        assert!((found.value - all[0].value).abs() < 0.02 * found.error, "from {start}: {found:?}");
        assert!((found.value - truth).abs() < 3.0 * found.error, "from {start}: {found:?}");
    }
    // With errors of one known size −2 ln L is a sum of squares. It rises by 1 over one error of a number, all others estimated.
    let known = ErrorModel { contacts: false, reading: Some(3.0), ..ErrorModel::default() };
    let free = behind(4e-4, &loadings, true, known);
    let compliance = of(&free);
    let deviance = |found: &Estimates| found.misfit.unwrap().deviance;
    let rises = [-1.0, 1.0].map(|side| {
        let fixed = behind(compliance.value + side * compliance.error, &loadings, false, known);
        deviance(&fixed) - deviance(&free)
    });
    // Third derivatives cancel in the mean of both sides; the observed information differs from the expected one by the residuals,
    // which are those of 200 readings.
    let mean = 0.5 * (rises[0] + rises[1]);
    assert!((mean - 1.0).abs() < 0.15, "{rises:?}");
}

#[test]
fn of_a_machine_that_is_stiff_only_a_limit_of_the_compliance_is_known() {
    // A drive that lags behind the slider: no compliance describes this, and 0 describes it best.
    let loadings = loadings(-2e-4);
    let known = ErrorModel { contacts: false, reading: Some(3.0), ..ErrorModel::default() };
    for errors in [known, ErrorModel::default()] {
        let found = behind(1e-4, &loadings, true, errors);
        let compliance = found.estimate("compliance").unwrap();
        let limit = compliance.limit.expect("only a limit");
        assert!(found.converged && compliance.interval == [0.0, limit]);
        // 1.645² in −2 ln L, by fits with this compliance and with none. The end is sought to 0.005 of the limit; the noise of
        // contacts, where it counts, is that of slightly other contacts.
        let deviance = |compliance| behind(compliance, &loadings, false, errors).misfit.unwrap().deviance;
        let rise = deviance(limit) - deviance(1e-10);
        let close = if errors.contacts { 0.4 } else { 0.05 };
        assert!((rise - 2.706).abs() < close, "{rise}");
    }
}

/// What is no curve of contacts near the first values is refused before any search.
#[test]
fn forces_of_the_wrong_sign_constant_ones_and_other_units_are_refused() {
    let positions = positions(60, 3.0);
    let forces = simulated(&positions, 1);
    let scaled = |values: &[f64], factor: f64| values.iter().map(|value| factor * value).collect::<Vec<_>>();
    let names = TRUE.map(|number| number.0);
    for (positions, forces, words) in [
        (positions.clone(), scaled(&forces, -1.0), "force: expected forces above 0 on average"),
        (positions.clone(), vec![7.0; 60], "force: expected forces that change, got 7 alone"),
        // Metres and micrometres in place of millimetres.
        (scaled(&positions, 1e-3), forces.clone(), "position: expected positions beyond 0.018"),
        (
            scaled(&positions, 1e3),
            forces.clone(),
            "position: expected a force that rises to half of its median by 18",
        ),
    ] {
        let error = fit(&positions, forces).free(names).run().unwrap_err().to_string();
        assert!(error.starts_with(words), "{error}");
    }
    // A sensor may have any zero.
    let shifted = forces.iter().map(|force| force - 3000.0).collect();
    let found = fit(&positions, shifted).free(names.into_iter().chain(["offset"])).run().unwrap();
    let offset = found.estimate("offset").unwrap();
    assert!((offset.value + 3000.0).abs() < 5.0 * offset.error, "{offset:?}");
}

/// Readings before the slider moves have the force of the contacts at rest: 0 here.
#[test]
fn a_machine_with_play_pulls_from_where_the_force_rises() {
    let pulled = positions(200, 4.0);
    let mut stream = Stream::new(3, Purpose::Sample, 0);
    // The reading error: 5 of forces up to 1600.
    let mut noisy = |force: f64| force + 5.0 * ((0..12).map(|_| stream.uniform()).sum::<f64>() - 6.0);
    let at_rest: Vec<f64> = (0..50).map(|_| noisy(0.0)).collect();
    let moving: Vec<f64> = simulated(&pulled, 3).into_iter().map(&mut noisy).collect();
    for play in [0.3, 1.2] {
        let before = (0..50).map(|i| play * f64::from(i) / 50.0);
        let all: Vec<f64> = before.chain(pulled.iter().map(|x| play + x)).collect();
        let forces = [at_rest.clone(), moving.clone()].concat();
        let names = TRUE.map(|number| number.0);
        for errors in [ErrorModel::default(), ErrorModel { contacts: false, ..ErrorModel::default() }] {
            let contacts = errors.contacts;
            let free: Vec<&str> = names.into_iter().filter(|name| contacts || *name != "count").collect();
            let found = fit(&all, forces.clone())
                .free(free.into_iter().chain(["origin"]))
                .errors(errors)
                .run()
                .unwrap();
            assert!(found.converged, "{play}");
            for (name, value) in TRUE.into_iter().chain([("origin", play)]) {
                let Some(number) = found.estimate(name).filter(|_| contacts || name != "stiffness") else {
                    continue;
                };
                // White noise leaves the noise of contacts out: errors are too small by up to some two.
                let allowed = if contacts { 4.0 } else { 12.0 };
                assert!(
                    (number.value - value).abs() < allowed * number.error,
                    "{play}, {contacts}: {name} {number:?}"
                );
            }
            let rest = found.predict(0, &[0.0, 0.5 * play], &mut ()).unwrap();
            assert_eq!(rest.forces, [0.0, 0.0]);
        }
    }
}

/// The noise of contacts is that of equal ones.
#[test]
fn the_noise_of_contacts_of_different_stiffness_is_refused_and_white_noise_is_not() {
    let unequal =
        Contacts { stiffness: Stiffness::PerThreshold(1.0), ..contacts(2000.0, [1.0, 0.12], spread()) };
    let equation = MasterEquation::new(unequal, &Initial::default()).unwrap();
    let positions = positions(60, 4.0);
    let pull = equation.pull(4.0).unwrap();
    let forces: Vec<f64> = positions.iter().map(|&x| pull.force(x)).collect();
    let fit = Fit::new(equation, Measurement::new(positions, forces)).free(["thresholds.mean"]);
    let error = fit.clone().check().unwrap_err().to_string();
    assert!(
        error.starts_with("noise: expected \"white\" where the stiffness of a contact depends"),
        "{error}"
    );
    assert!(fit.errors(ErrorModel { contacts: false, ..ErrorModel::default() }).check().is_ok());
}

#[test]
fn what_a_curve_does_not_determine_is_refused_with_the_direction() {
    let positions = positions(100, 4.0);
    // A shift of all stretches is a shift of the zero of the force: P, R and Q_ini by d, F by −N⟨k⟩d.
    let shifted = |by: f64| Contacts {
        count: 1000.0,
        ..Contacts::new(
            Arc::new(Gaussian::new(1.0 + by, 0.1).unwrap()),
            Arc::new(Gaussian::new(0.3 + by, 0.03).unwrap()),
        )
    };
    let initial = Initial { law: Arc::new(Gaussian::new(0.3, 0.02).unwrap()), ..Initial::default() };
    let equation = MasterEquation::new(shifted(0.0), &initial).unwrap();
    let pull = equation.pull(4.0).unwrap();
    let forces = positions.iter().map(|&x| pull.force(x)).collect();
    let free = ["thresholds.mean", "reforming.mean", "initial.mean", "offset"];
    let error =
        Fit::new(equation, Measurement::new(positions, forces)).free(free).run().unwrap_err().to_string();
    assert!(free.iter().all(|name| error.contains(name)), "{error}");
}

#[test]
fn the_profile_of_a_linear_number_is_its_standard_error() {
    let positions = positions(150, 4.0);
    let readings = exact(contacts(2000.0, [1.0, 0.12], spread()), &positions).into_iter().enumerate();
    // Any residuals will do; these have no regularity.
    let readings = readings.map(|(i, force)| force + 20.0 * (i as f64 * 12.9898).sin()).collect();
    let known = ErrorModel { contacts: false, reading: Some(15.0), ..ErrorModel::default() };
    let found = fit(&positions, readings).free(["offset"]).errors(known).run().unwrap();
    let offset = found.estimate("offset").unwrap();
    assert!((offset.error - 15.0 / 150.0_f64.sqrt()).abs() < 1e-9 * offset.error, "{offset:?}");
    let profile = found.interval_by_profile("offset", &mut ()).unwrap();
    for (end, reported) in profile.into_iter().zip(offset.interval) {
        // The end is sought to 0.01 of 1.96 errors.
        assert!((end - reported).abs() < 0.03 * offset.error, "{profile:?} {offset:?}");
    }
    let value = offset.value + 2.0 * offset.error;
    let rise = found.profile("offset", value, &mut ()).unwrap();
    // The search ends within a thousandth of an error of the minimum, 1e-6 in −2 ln L.
    assert!((rise - 4.0).abs() < 1e-6, "{rise}");
    // Of eight readings with errors of unknown size both are Student's t of seven degrees of freedom: 2.3646 errors, not 1.96.
    let few = crate::pulls::positions(8, 4.0);
    let readings = exact(contacts(2000.0, [1.0, 0.12], spread()), &few).into_iter().enumerate();
    let readings = readings.map(|(i, force)| force + 20.0 * (i as f64 * 12.9898).sin()).collect();
    let unknown = ErrorModel { contacts: false, ..ErrorModel::default() };
    let found = fit(&few, readings).free(["offset"]).errors(unknown).run().unwrap();
    let offset = found.estimate("offset").unwrap();
    let profile = found.interval_by_profile("offset", &mut ()).unwrap();
    for (k, side) in [-1.0, 1.0].into_iter().enumerate() {
        let exact = offset.value + side * 2.364_624 * offset.error;
        assert!((offset.interval[k] - exact).abs() < 1e-5 * offset.error, "{offset:?}");
        // As above, 0.01 of 2.36 errors.
        assert!((profile[k] - exact).abs() < 0.03 * offset.error, "{profile:?} {offset:?}");
    }
}

#[test]
fn a_fit_is_the_same_on_any_number_of_threads() {
    // As many readings as are split among threads, with a drift or without one.
    for (count, drift) in [(700, None), (450, Some(0.5))] {
        let positions = positions(count, 4.0);
        let forces = simulated(&positions, 5);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let errors = ErrorModel { drift, ..ErrorModel::default() };
            let fit = fit(&positions, forces.clone()).free(TRUE.map(|n| n.0)).errors(errors);
            let found = pool.install(|| fit.run().unwrap());
            (found.parameters, found.covariance, found.readings)
        };
        // Numbers without an error have none that is equal to itself; text has all digits.
        let text = |threads: usize| format!("{:?}", run(threads));
        assert!(text(1) == text(2), "{drift:?}");
    }
}

#[test]
fn first_values_may_be_far_off() {
    let positions = positions(120, 4.0);
    let forces = simulated(&positions, 6);
    let run = |mean: f64, std: f64| {
        let guess =
            MasterEquation::new(contacts(1500.0, [mean, std], spread()), &Initial::default()).unwrap();
        let fit = Fit::new(guess, Measurement::new(positions.clone(), forces.clone()));
        fit.free(TRUE.map(|number| number.0)).run().unwrap()
    };
    let near = run(1.0, 0.12);
    for [mean, std] in
        [[0.2, 0.02], [0.3, 0.05], [0.5, 0.2], [0.7, 0.2], [1.4, 0.1], [2.0, 0.5], [4.0, 0.8], [6.0, 0.3]]
    {
        let found = run(mean, std);
        assert!(found.converged, "from {mean}, {std}");
        for (found, near) in found.parameters.iter().zip(&near.parameters).take(TRUE.len()) {
            // Searches end within a thousandth of an error of the same place, for the noise at slightly other values.
            assert!((found.value - near.value).abs() < 0.01 * near.error, "from {mean}, {std}: {found:?}");
        }
    }
}

#[test]
fn units_do_not_matter() {
    let positions = positions(120, 4.0);
    let forces = simulated(&positions, 6);
    let run = |length: f64, force: f64| {
        let gaussian = |mean: f64, std: f64| Arc::new(Gaussian::new(mean * length, std * length).unwrap());
        let contacts = Contacts {
            count: 1500.0,
            stiffness: Stiffness::Equal(force / length),
            ..Contacts::new(gaussian(0.9, 0.15), gaussian(0.1, 0.03))
        };
        let equation = MasterEquation::new(contacts, &Initial::default()).unwrap();
        let scaled = |values: &[f64], by: f64| values.iter().map(|value| value * by).collect();
        let measured = Measurement::new(scaled(&positions, length), scaled(&forces, force));
        let names = TRUE.map(|number| number.0).into_iter().chain(["offset"]);
        Fit::new(equation, measured).free(names).run().unwrap()
    };
    let one = run(1.0, 1.0);
    for (length, force) in [(2.0_f64.powi(-100), 2.0_f64.powi(60)), (2.0_f64.powi(100), 2.0_f64.powi(-150))] {
        let other = run(length, force);
        let units = [length, length, 1.0, force / length, force, force];
        assert_eq!(other.parameters.len(), units.len());
        for ((found, expected), unit) in other.parameters.iter().zip(&one.parameters).zip(units) {
            // Searches end within a thousandth of an error of the same place, and limits within 0.01 of their logarithm.
            let agree = match (found.limit, expected.limit) {
                (Some(limit), Some(expected)) => (limit / unit / expected - 1.0).abs() < 0.02,
                (None, None) => {
                    (found.value / unit - expected.value).abs() < 2e-3 * expected.error
                        && (found.error / unit / expected.error - 1.0).abs() < 1e-3
                }
                _ => false,
            };
            assert!(agree, "{found:?} {expected:?}");
        }
        let misfits = [other.misfit.unwrap().chi_squared, one.misfit.unwrap().chi_squared];
        assert!((misfits[0] / misfits[1] - 1.0).abs() < 1e-3, "{misfits:?}");
    }
}

/// The derivatives of ln L by its parameters, 2 % off the estimates, are those of its values.
pub fn assert_gradient_is_slope(found: &Estimates) {
    let values: Vec<f64> = found.parameters.iter().map(|estimate| 1.02 * estimate.value).collect();
    let (_, gradient) = found.log_likelihood(&values, &mut ()).unwrap();
    for k in 0..values.len() {
        let at = |factor: f64| {
            let mut moved = values.clone();
            moved[k] *= factor;
            found.log_likelihood(&moved, &mut ()).unwrap().0
        };
        // Rounding of ln L is 1e-7: over a step of 1e-5 it would be as large as what is allowed.
        let step = 1e-4;
        let slope = (at(1.0 + step) - at(1.0 - step)) / (2.0 * step * values[k]);
        // Rounding of ln L over the step, and its third derivative times the square of the step.
        let size = gradient[k].abs().max(1.0 / values[k]);
        let name = &found.parameters[k].name;
        assert!((gradient[k] - slope).abs() < 1e-4 * size, "{name}: {} {slope}", gradient[k]);
    }
}

#[test]
fn the_gradient_of_the_likelihood_is_its_slope() {
    let positions = positions(100, 4.0);
    let found = fit(&positions, simulated(&positions, 9)).free(TRUE.map(|n| n.0)).run().unwrap();
    assert_gradient_is_slope(&found);
}

#[test]
fn the_standardised_density_is_that_of_the_values_and_near_a_standard_normal_one() {
    let positions = positions(100, 4.0);
    let prior = Prior { value: 1.0, error: 0.1 };
    let found = fit(&positions, simulated(&positions, 9)).free(TRUE.map(|n| n.0)).prior("stiffness", prior);
    let found = found.run().unwrap();
    let target = found.standardised().unwrap();
    // The readings are exact, so that their error is known by a limit only.
    assert_eq!(target.names(), TRUE.map(|number| number.0));
    let reading = found.estimate("reading").unwrap().value;
    let z = [0.4, -0.7, 0.3, 0.5];
    let (density, gradient) = target.log_density(&z, &mut ()).unwrap();
    let values = [target.values(&z), vec![reading]].concat();
    // The same point by another way; its coordinates are logarithms of values, rounded.
    let likelihood = found.log_likelihood(&values, &mut ()).unwrap().0;
    assert!((density - likelihood).abs() < 1e-9 * likelihood.abs(), "{density} {likelihood}");
    for k in 0..4 {
        let at = |step: f64| {
            let mut moved = z;
            moved[k] += step;
            target.log_density(&moved, &mut ()).unwrap().0
        };
        let slope = (at(1e-4) - at(-1e-4)) / 2e-4;
        // Rounding of ln L, some hundreds, over the step, and errors of the derivatives of the curve.
        assert!((gradient[k] - slope).abs() < 1e-4, "{k}: {} {slope}", gradient[k]);
    }
    let (highest, at_estimates) = target.log_density(&[0.0; 4], &mut ()).unwrap();
    // The search ends at a thousandth of an error. N, which the size of the noise determines, has the highest restricted likelihood:
    // with the term of three numbers of the curve the slope is at most 3/√(2n).
    assert!(at_estimates.iter().all(|slope| slope.abs() < 3.0 / 200_f64.sqrt()), "{at_estimates:?}");
    for k in 0..4 {
        let both: f64 = [-0.5, 0.5]
            .map(|step| {
                let mut moved = [0.0; 4];
                moved[k] = step;
                target.log_density(&moved, &mut ()).unwrap().0 - highest
            })
            .iter()
            .sum();
        // −z²/2 twice. The information is the expected one; that of one curve of 100 readings differs by a few 1/√100.
        assert!((both / -0.25 - 1.0).abs() < 0.35, "{k}: {both}");
    }
}

#[test]
fn a_planned_measurement_has_the_errors_of_one_that_is_made() {
    let positions = positions(300, 6.0);
    let truth = || MasterEquation::new(contacts(2000.0, [1.0, 0.12], spread()), &Initial::default()).unwrap();
    let errors = ErrorModel { reading: Some(0.1), ..ErrorModel::default() };
    let free = TRUE.map(|number| number.0);
    let planned =
        Fit::new(truth(), Measurement::new(positions.clone(), Vec::new())).free(free).errors(errors);
    let planned = planned.run().unwrap();
    assert!(planned.misfit.is_none());
    let made = fit(&positions, simulated(&positions, 4)).free(free).errors(errors).run().unwrap();
    for (planned, made) in planned.parameters.iter().zip(&made.parameters) {
        // Errors go with the square root of the number of contacts, which is estimated to 10 %.
        assert!((planned.error / made.error - 1.0).abs() < 0.3, "{planned:?} {made:?}");
    }
}

#[test]
fn a_planned_measurement_has_no_likelihood() {
    let guess = MasterEquation::new(contacts(1.0, [1.0, 0.12], spread()), &Initial::default()).unwrap();
    let white = ErrorModel { contacts: false, reading: Some(0.001), ..ErrorModel::default() };
    let free = ["thresholds.mean", "thresholds.std"];
    let planned = Fit::new(guess, Measurement::new(positions(40, 3.0), Vec::new())).free(free).errors(white);
    let found = planned.run().unwrap();
    let refused = [
        found.profile("thresholds.mean", 1.0, &mut ()).unwrap_err(),
        found.interval_by_profile("thresholds.mean", &mut ()).unwrap_err(),
        found.log_likelihood(&[1.0, 0.12], &mut ()).unwrap_err(),
        planned.free_form(&found, 36, &mut ()).unwrap_err(),
        found.standardised().unwrap_err(),
    ];
    let expected =
        "force: expected measured forces: a measurement that is only planned has no posterior, got none";
    assert_eq!(refused.map(|error| error.to_string()), [expected; 5]);
}

#[test]
fn a_prior_holds_what_the_curve_does_not_tell() {
    let positions = positions(100, 0.2);
    // No contact has broken: only the stiffness of all is known.
    let forces: Vec<f64> = positions.iter().map(|x| 2000.0 * x).collect();
    let white = ErrorModel { contacts: false, reading: Some(1.0), ..ErrorModel::default() };
    let free = ["count", "thresholds.mean"];
    let fit = fit(&positions, forces).free(free).errors(white);
    let prior = Prior { value: 1.1, error: 0.05 };
    let found = fit.prior("thresholds.mean", prior).run().unwrap();
    let mean = found.estimate("thresholds.mean").unwrap();
    assert!((mean.value - 1.1).abs() < 0.02 && (mean.error - 0.05).abs() < 0.01, "{mean:?}");
}

/// A curve of a gamma distribution is not described by an exponential one.
#[test]
fn the_law_that_made_a_curve_has_the_lowest_criterion() {
    let positions = positions(200, 5.0);
    let law: SharedLaw = Arc::new(Gamma::new(1.0, 0.3).unwrap());
    let truth = Contacts { count: 5000.0, ..Contacts::new(law, spread()) };
    let ensemble = Ensemble::new(truth, Initial::default(), 5000, 3, Disorder::Annealed).unwrap();
    let forces = ensemble.pull(&positions).unwrap().force;
    let guess = MasterEquation::new(contacts(5000.0, [1.0, 0.3], spread()), &Initial::default()).unwrap();
    let fit = Fit::new(guess, Measurement::new(positions, forces)).free([
        "thresholds.mean",
        "thresholds.std",
        "count",
    ]);
    let akaike = |fit: Fit| fit.run().unwrap().misfit.unwrap().akaike;
    let gamma = fit.with_thresholds(Arc::new(Gamma::new(0.9, 0.2).unwrap()), &mut ()).unwrap();
    let weibull = fit.with_thresholds(Arc::new(Weibull::new(3.0, 1.0).unwrap()), &mut ()).unwrap();
    let (gaussian, gamma, weibull) = (akaike(fit), akaike(gamma), akaike(weibull));
    // Differences of the criterion of 10 count as decisive (Burnham and Anderson, 2002).
    assert!(gamma + 10.0 < gaussian && gamma + 10.0 < weibull, "{gamma} {gaussian} {weibull}");
}

/// Readings at `positions` with independent normal errors of the size `reading`, and a drift, an Ornstein–Uhlenbeck process of the given
/// amplitude and correlation length.
pub fn drifting(
    (positions, exact): (&[f64], &[f64]),
    (reading, [amplitude, length]): (f64, [f64; 2]),
    seed: u64,
) -> Vec<f64> {
    let normal = Gaussian::new(40.0, 1.0).unwrap();
    let mut stream = Stream::new(seed, Purpose::Sample, 0);
    let mut unit = || normal.quantile(stream.uniform()) - 40.0;
    let (mut drift, mut before) = (amplitude * unit(), f64::NEG_INFINITY);
    let mut read = |(x, force): (&f64, &f64)| {
        let kept = (-(x - before) / length).exp();
        drift = kept * drift + amplitude * (1.0 - kept * kept).sqrt() * unit();
        before = *x;
        force + drift + reading * unit()
    };
    positions.iter().zip(exact).map(&mut read).collect()
}

/// The share of fits whose interval holds each of the true values.
fn shares(found: &[Estimates], truth: &[(&str, f64)]) -> Vec<f64> {
    let holds = |found: &&Estimates, (name, value): (&str, f64)| {
        let interval = found.estimate(name).unwrap().interval;
        interval[0] <= value && value <= interval[1]
    };
    let share = |of| found.iter().filter(|found| holds(found, of)).count() as f64 / found.len() as f64;
    truth.iter().copied().map(share).collect()
}

#[test]
fn intervals_of_few_readings_hold_the_truth() {
    let positions = positions(8, 1.4);
    let forces = exact(contacts(2000.0, [1.0, 0.12], spread()), &positions);
    let free = ["thresholds.mean", "thresholds.std", "count"];
    let one = |seed: u64| {
        let measured = drifting((&positions, &forces), (5.0, [0.0, 1.0]), seed);
        let white = ErrorModel { contacts: false, ..ErrorModel::default() };
        fit(&positions, measured).free(free).errors(white).run().unwrap()
    };
    let found: Vec<Estimates> = (0..200_u64).into_par_iter().map(one).collect();
    // Student's t of five degrees of freedom, which the program finds to some 1e-6.
    let quantile = 2.570_581_836;
    for number in found.iter().flat_map(|found| &found.parameters[..3]) {
        let [low, high] = number.interval;
        // Of the logarithm but for the mean, which may have any value.
        let half = match number.name.as_str() {
            "thresholds.mean" => 0.5 * (high - low) / number.error,
            _ => 0.5 * (high / low).ln() * number.value / number.error,
        };
        assert!((half - quantile).abs() < 1e-5, "{half} {number:?}");
    }
    let covered = shares(&found, &TRUE[..3]);
    println!("{covered:?}");
    // 0.95 with a standard deviation of 0.015; a share below 0.89 has a probability of 2e-4. With errors too small by 1.5 it
    // would be 0.85, with errors as much too large 0.99.
    assert!(covered.iter().all(|share| (0.89..0.985).contains(share)), "{covered:?}");
    let within = |estimates: &&Estimates| {
        let [low, high] = estimates.interval_by_profile("count", &mut ()).unwrap();
        (low..=high).contains(&2000.0)
    };
    let covered = found[..40].iter().filter(within).count();
    // 38 of 40; fewer than 32 have a probability of 1e-4.
    assert!(covered >= 32, "{covered}");
}

#[test]
fn intervals_in_drift_hold_the_truth() {
    let positions = positions(150, 6.0);
    let forces = exact(contacts(2000.0, [1.0, 0.12], spread()), &positions);
    let errors = ErrorModel { contacts: false, drift: Some(1.4), ..ErrorModel::default() };
    let one = |seed: u64| {
        let measured = drifting((&positions, &forces), (2.0, [10.0, 0.5]), seed);
        let free = ["thresholds.mean", "thresholds.std", "stiffness", "offset"];
        fit(&positions, measured).free(free).errors(errors).run().unwrap()
    };
    let found: Vec<Estimates> = (0..100_u64).into_par_iter().map(one).collect();
    // `fit` begins with 1500 contacts in place of 2000.
    let of_curve = [TRUE[0], TRUE[1], ("stiffness", 4.0 / 3.0), ("offset", 0.0)];
    let covered = shares(&found, &of_curve);
    println!("{covered:?}");
    // 0.95 with a standard deviation of 0.022 if the drift were known; it has twelve correlation lengths. With errors too small
    // by a factor of 1.5 it would be 0.81.
    assert!(covered.iter().all(|share| *share > 0.86), "{covered:?}");
    // χ²/100 of 100 degrees of freedom is below 0.55 or above 1.6 with 1e-4 each. Errors off by 1.5 make 0.44 or 2.25 of 1.
    let off: Vec<f64> = of_curve[..3].iter().map(|&number| off(&found, number)).collect();
    assert!(off.iter().all(|off| (0.55..1.6).contains(off)), "{off:?}");
    let covered = shares(&found, &[("drift.amplitude", 10.0), ("drift.length", 0.5)]);
    // Of 1000 curves 0.86 and 0.87; with the full likelihood in place of the restricted one 0.75 and 0.81.
    assert!(covered.iter().all(|share| *share > 0.8), "{covered:?}");
}

/// The restricted likelihood is highest at the estimates, and falls there as the information lets expect.
#[test]
fn sizes_of_errors_are_those_of_the_highest_restricted_likelihood() {
    let positions = positions(150, 6.0);
    let forces = exact(contacts(2000.0, [1.0, 0.12], spread()), &positions);
    let measured = drifting((&positions, &forces), (4.0, [10.0, 0.2]), 3);
    let errors = ErrorModel { contacts: false, drift: Some(1.4), ..ErrorModel::default() };
    let found =
        fit(&positions, measured).free(["thresholds.mean", "thresholds.std", "stiffness"]).errors(errors);
    let found = found.run().unwrap();
    for name in ["reading", "drift.amplitude", "drift.length"] {
        let estimate = found.estimate(name).unwrap();
        let rise = |step: f64| {
            let value = (estimate.value.ln() + step * estimate.error / estimate.value).exp();
            found.profile(name, value, &mut ()).unwrap()
        };
        let [below, above] = [rise(-0.1), rise(0.1)];
        // 0.1² of either; the observed information of 150 readings differs from the expected one, and the third derivative counts.
        assert!(below > 0.005 && above > 0.005 && below + above < 0.04, "{name}: {below} {above}");
    }
}

/// Independent readings: the variance of restricted likelihood is χ²/(n − p).
#[test]
fn the_error_of_independent_readings_has_their_degrees_of_freedom() {
    let positions = positions(60, 6.0);
    let forces = exact(contacts(2000.0, [1.0, 0.12], spread()), &positions);
    let errors = ErrorModel { contacts: false, drift: Some(1.4), ..ErrorModel::default() };
    let of = |seed: u64| {
        let measured = drifting((&positions, &forces), (4.0, [0.0, 1.0]), seed);
        let fit = fit(&positions, measured).free(["thresholds.mean", "thresholds.std", "stiffness"]);
        fit.errors(errors).run().unwrap()
    };
    // Where no drift is found its amplitude is the smallest, 1e-5 of the largest force, and its variance 4e-5 of that of readings.
    let found: Vec<Estimates> = (0..20_u64).into_par_iter().map(of).collect();
    let without = found.iter().filter(|found| found.estimate("drift.amplitude").unwrap().value < 0.03);
    let mut count = 0;
    for found in without {
        let squares: f64 = found.readings[0].residuals.iter().map(|residual| residual * residual).sum();
        let (reading, expected) = (found.reading, (squares / 57.0).sqrt());
        assert!((reading / expected - 1.0).abs() < 1e-4, "{reading} {expected}");
        count += 1;
    }
    assert!(count >= 5, "{count}");
}
