//! Fits to forces of steady sliding at several velocities: against closed forms, values, errors, intervals, and what such forces
//! cannot determine.

use std::sync::Arc;

use asperity::Error;
use asperity::contacts::{Ageing, Contacts, FreeTime, Initial, Temperature};
use asperity::fit::{MeasuredVelocityCurve, Prior, VelocityCurveEstimates, VelocityCurveFit};
use asperity::law::{Gaussian, Point, SharedLaw};
use asperity::master::MasterEquation;
use asperity::random::{Purpose, Stream};
use rayon::prelude::*;

/// Contacts that break at 1 and are free for a time: F_k = N k/[2(1 + vτ)].
fn free_for(time: f64, count: f64) -> Contacts {
    let at = |x: f64| -> SharedLaw { Arc::new(Point::new(x).unwrap()) };
    let mut contacts = Contacts { count, ..Contacts::new(at(1.0), at(0.0)) };
    contacts.rules.delay = FreeTime::Fixed(time);
    contacts
}

fn gaussian() -> Contacts {
    Contacts::new(Arc::new(Gaussian::new(1.0, 0.2).unwrap()), Arc::new(Point::new(0.0).unwrap()))
}

/// Thresholds that grow with the logarithm of age.
fn ageing(growth: f64, time: f64) -> Contacts {
    let mut contacts = gaussian();
    contacts.rules.ageing = Some(Ageing::Logarithmic { growth, time });
    contacts
}

fn heated(energy: f64, attempt_rate: f64) -> Contacts {
    let mut contacts = gaussian();
    contacts.rules.temperature = Some(Temperature::new(energy, attempt_rate));
    contacts
}

/// F_k at velocities, by the solver.
fn friction(contacts: &Contacts, velocities: &[f64]) -> Vec<f64> {
    let one = |&v: &f64| {
        let equation = MasterEquation::at(contacts.clone(), &Initial::default(), v).unwrap();
        equation.steady_state().kinetic_friction()
    };
    velocities.par_iter().map(one).collect()
}

/// Independent normal numbers.
fn normal(seed: u64, n: usize) -> Vec<f64> {
    let mut stream = Stream::new(seed, Purpose::Sample, 0);
    let mut uniform = || stream.uniform();
    (0..n).map(|_| (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()).collect()
}

/// Velocities at equal ratios.
fn decades(from: f64, to: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| from * (to / from).powf(i as f64 / (n - 1) as f64)).collect()
}

fn estimate(found: &VelocityCurveEstimates, name: &str) -> (f64, f64) {
    let estimate = found.estimate(name).unwrap();
    (estimate.value, estimate.error)
}

/// The least squares of N/[2(1 + vτ)] + b: Gauss–Newton steps with derivatives in closed form, from the true values; the numbers N, τ
/// and b with their covariance for errors of standard deviation 1.
fn closed_form(velocities: &[f64], forces: &[f64], errors: &[f64]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut numbers = [100.0, 0.5, 3.0];
    let mut covariance = [[0.0; 3]; 3];
    for _ in 0..40 {
        let [count, time, constant] = numbers;
        let (mut matrix, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
        for ((v, force), error) in velocities.iter().zip(forces).zip(errors) {
            let share = 0.5 / (1.0 + v * time);
            let slopes = [share, -2.0 * count * v * share * share, 1.0].map(|slope| slope / error);
            let residual = (force - count * share - constant) / error;
            for i in 0..3 {
                right[i] += slopes[i] * residual;
                for j in 0..3 {
                    matrix[i][j] += slopes[i] * slopes[j];
                }
            }
        }
        covariance = inverse(matrix);
        for i in 0..3 {
            numbers[i] += (0..3).map(|j| covariance[i][j] * right[j]).sum::<f64>();
        }
    }
    (numbers, covariance)
}

/// By cofactors.
fn inverse(a: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let cofactor = |i: usize, j: usize| {
        let [r, s] = [(i + 1) % 3, (i + 2) % 3];
        let [c, d] = [(j + 1) % 3, (j + 2) % 3];
        a[r][c] * a[s][d] - a[r][d] * a[s][c]
    };
    let determinant: f64 = (0..3).map(|j| a[0][j] * cofactor(0, j)).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant))
}

#[test]
fn the_least_squares_of_a_closed_form() {
    let velocities = decades(0.05, 50.0, 12);
    let errors: Vec<f64> = (0..12).map(|i| if i % 2 == 0 { 0.3 } else { 0.6 }).collect();
    let noise = normal(4, 12);
    let forces: Vec<f64> =
        (0..12).map(|i| 100.0 * 0.5 / (1.0 + 0.5 * velocities[i]) + 3.0 + errors[i] * noise[i]).collect();
    let names = ["count", "delay", "offset"];
    let curve = |errors: Option<Vec<f64>>| MeasuredVelocityCurve {
        velocities: velocities.clone(),
        forces: forces.clone(),
        errors,
    };
    let (numbers, covariance) = closed_form(&velocities, &forces, &errors);
    let found = VelocityCurveFit::new(free_for(0.5, 80.0), curve(Some(errors))).free(names).run().unwrap();
    assert!(found.converged && !found.misfit.is_unlikely() && found.misfit.degrees_of_freedom == 9);
    for (i, name) in names.into_iter().enumerate() {
        let (value, error) = estimate(&found, name);
        let exact = covariance[i][i].sqrt();
        // The search ends within a thousandth of an error; derivatives by differences are right to 1e-6, and change by 1e-3 over
        // such a step at most.
        assert!((value - numbers[i]).abs() < 2e-3 * exact, "{name}: {value} {}", numbers[i]);
        assert!((error / exact - 1.0).abs() < 2e-3, "{name}: {error} {exact}");
        for j in 0..3 {
            let ratio = found.covariance[3 * i + j] / covariance[i][j];
            assert!((ratio - 1.0).abs() < 5e-3, "{name} {j}: {ratio}");
        }
    }
    // The force is linear in the offset, and nearly in the others within an error: the profile is a parabola.
    let (offset, error) = estimate(&found, "offset");
    let rise = found.profile("offset", offset + error, &mut ()).unwrap();
    assert!((rise - 1.0).abs() < 0.02, "{rise}");
    // The gradient of the likelihood is −Σ r ∂r/∂u, with the derivatives of the closed form.
    let moved: Vec<f64> =
        numbers.iter().zip([1.01, 1.02, 1.03]).map(|(value, factor)| value * factor).collect();
    let gradient = found.log_likelihood(&moved, &mut ()).unwrap().1;
    let mut exact = [0.0; 3];
    for ((v, force), error) in velocities.iter().zip(&forces).zip(found.std.iter()) {
        let share = 0.5 / (1.0 + v * moved[1]);
        let slopes = [share, -2.0 * moved[0] * v * share * share, 1.0];
        let residual = (force - moved[0] * share - moved[2]) / (error * error);
        exact.iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += residual * slope);
    }
    for (k, (found, exact)) in gradient.iter().zip(exact).enumerate() {
        // Differences of forces that are right to 1e-10, over steps of 1e-5 or more.
        assert!((found / exact - 1.0).abs() < 1e-4, "{k}: {found} {exact}");
    }
    // The band of the curve at its ends is that of the expected force there: gᵀVg.
    let last = found.fitted.velocities.len() - 1;
    for (v, error) in [(velocities[0], found.fitted.errors[0]), (velocities[11], found.fitted.errors[last])] {
        let share = 0.5 / (1.0 + v * numbers[1]);
        let slopes = [share, -2.0 * numbers[0] * v * share * share, 1.0];
        let variance: f64 = (0..9).map(|k| slopes[k / 3] * covariance[k / 3][k % 3] * slopes[k % 3]).sum();
        assert!((error / variance.sqrt() - 1.0).abs() < 5e-3, "{v}: {error}");
    }
    // Errors of one size that is not known: s² = Σr²/(n − p), and the covariance in proportion.
    let ones = vec![1.0; 12];
    let (numbers, covariance) = closed_form(&velocities, &forces, &ones);
    let found = VelocityCurveFit::new(free_for(0.5, 80.0), curve(None)).free(names).run().unwrap();
    let residual = |i: usize| forces[i] - numbers[0] * 0.5 / (1.0 + velocities[i] * numbers[1]) - numbers[2];
    let size = ((0..12).map(|i| residual(i).powi(2)).sum::<f64>() / 9.0).sqrt();
    assert!((found.reading / size - 1.0).abs() < 1e-6, "{} {size}", found.reading);
    assert!(found.misfit.probability.is_none());
    for (i, name) in names.into_iter().enumerate() {
        let (value, error) = estimate(&found, name);
        let exact = size * covariance[i][i].sqrt();
        assert!((value - numbers[i]).abs() < 2e-3 * exact, "{name}: {value} {}", numbers[i]);
        assert!((error / exact - 1.0).abs() < 2e-3, "{name}: {error} {exact}");
    }
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_tell() {
    let velocities = decades(0.05, 50.0, 10);
    let truth = [("count", 100.0), ("delay", 0.5)];
    let one = |seed: u64| {
        let noise = normal(1000 + seed, 10);
        let force = |i: usize| 50.0 / (1.0 + 0.5 * velocities[i]) + 0.5 * noise[i];
        let curve = MeasuredVelocityCurve {
            velocities: velocities.clone(),
            forces: (0..10).map(force).collect(),
            errors: None,
        };
        VelocityCurveFit::new(free_for(0.4, 120.0), curve).free(["count", "delay"]).run().unwrap()
    };
    let found: Vec<VelocityCurveEstimates> = (0..400_u64).into_par_iter().map(one).collect();
    assert!(found.iter().all(|found| found.converged));
    for (name, value) in truth {
        let holds = |found: &&VelocityCurveEstimates| {
            let [low, high] = found.estimate(name).unwrap().interval;
            low <= value && value <= high
        };
        let held = found.iter().filter(holds).count();
        // 380 of 400 with a standard deviation of 4.4; with the normal quantile in place of Student's of 8 degrees of freedom 91 %
        // would hold, 366.
        assert!((367..=393).contains(&held), "{name}: {held}");
    }
}

#[test]
fn far_first_times_are_found() {
    let velocities = decades(1e-3, 1.0, 10);
    let noise = normal(11, 10);
    let curve = |truth: &Contacts| {
        let forces = friction(truth, &velocities);
        let forces = forces.iter().zip(&noise).map(|(force, noise)| 50.0 * force + 0.05 * noise).collect();
        MeasuredVelocityCurve { velocities: velocities.clone(), forces, errors: Some(vec![0.05; 10]) }
    };
    // At a thousandfold time the first values are flat over the measured velocities.
    for factor in [1e-3, 1e3] {
        let truth = ageing(0.1, 3.0);
        let guess = Contacts { count: 30.0, ..ageing(0.07, 3.0 * factor) };
        let names = ["count", "ageing.growth", "ageing.time"];
        let found = VelocityCurveFit::new(guess, curve(&truth)).free(names).run().unwrap();
        assert!(found.converged && !found.misfit.is_unlikely(), "{factor}: {:?}", found.misfit);
        for (name, value) in names.into_iter().zip([50.0, 0.1, 3.0]) {
            let (found, error) = estimate(&found, name);
            assert!(
                (found - value).abs() < 4.0 * error && error < 0.5 * value,
                "{factor} {name}: {found} ± {error}"
            );
        }
    }
    // At a thousandth of the attempt rate there are no thermal breaks.
    let truth = heated(0.02, 1.0);
    let guess = Contacts { count: 40.0, ..heated(0.03, 1e-3) };
    let names = ["count", "temperature.energy", "temperature.attempt_rate"];
    let found = VelocityCurveFit::new(guess, curve(&truth)).free(names).run().unwrap();
    assert!(found.converged && !found.misfit.is_unlikely(), "{:?}", found.misfit);
    for (name, value) in names.into_iter().zip([50.0, 0.02, 1.0]) {
        let (found, error) = estimate(&found, name);
        assert!((found - value).abs() < 4.0 * error, "{name}: {found} ± {error}");
    }
}

#[test]
fn a_background_and_a_prior() {
    let velocities = decades(0.1, 10.0, 8);
    let noise = normal(21, 8);
    let force = |i: usize| 50.0 / (1.0 + 0.5 * velocities[i]) + 7.0 + 0.2 * noise[i];
    let curve = MeasuredVelocityCurve {
        velocities: velocities.clone(),
        forces: (0..8).map(force).collect(),
        errors: Some(vec![0.2; 8]),
    };
    let fit = VelocityCurveFit::new(free_for(0.4, 120.0), curve).background(2.0);
    let found = fit.clone().free(["count", "delay", "background"]).run().unwrap();
    let (background, error) = estimate(&found, "background");
    assert!((background - 7.0).abs() < 4.0 * error && found.background == background);
    // A prior as narrow as the estimate halves its variance, and moves the value by half of what lies between.
    let prior = Prior { value: background * 1.02, error: error * 1.02 };
    let known = fit.free(["count", "delay", "background"]).prior("background", prior).run().unwrap();
    let (moved, narrower) = estimate(&known, "background");
    // The logarithm of the number, in which the prior is normal, bends over an error of 3 %.
    assert!((narrower / error / 0.5_f64.sqrt() - 1.0).abs() < 0.03, "{narrower} {error}");
    assert!((moved / background - 1.01).abs() < 1e-3, "{moved} {background}");
}

#[test]
fn numbers_without_effect_have_a_limit() {
    // Friction that grows with the velocity, where delay and ageing make it fall: the best value is 0.
    let velocities = decades(0.1, 10.0, 8);
    let growing = MeasuredVelocityCurve {
        forces: velocities.iter().map(|v| 50.0 + 0.1 * v).collect(),
        velocities,
        errors: Some(vec![0.2; 8]),
    };
    let aged = Contacts { count: 80.0, ..ageing(0.1, 1.0) };
    for (contacts, name) in [(free_for(0.4, 120.0), "delay"), (aged, "ageing.growth")] {
        let found = VelocityCurveFit::new(contacts, growing.clone()).free(["count", name]).run().unwrap();
        let estimate = found.estimate(name).unwrap();
        // A relative change of the force by an error, 4e-3, is a delay of 8e-4 at v = 10, and less of the growth.
        let limited = estimate.limit.is_some_and(|limit| limit > estimate.value && limit < 4e-3);
        assert!(found.converged && limited && estimate.error == 0.0, "{estimate:?}");
    }
    // The same with lengths, and times that leave velocities as they are, a thousand times as large.
    let long = Arc::new(Gaussian::new(1e3, 200.0).unwrap());
    let mut long = Contacts { count: 0.08, ..Contacts::new(long, Arc::new(Point::new(0.0).unwrap())) };
    long.rules.ageing = Some(Ageing::Logarithmic { growth: 0.1, time: 1e3 });
    let found = VelocityCurveFit::new(long, growing.clone()).free(["count", "ageing.growth"]).run().unwrap();
    let growth = found.estimate("ageing.growth").unwrap();
    assert!(found.converged && growth.limit.is_some_and(|limit| limit < 4e-3), "{growth:?}");
    // A force that falls with the velocity more than a background below the contacts allows.
    let falling = MeasuredVelocityCurve {
        forces: growing.velocities.iter().map(|v| 50.0 / (1.0 + 0.5 * v) - 1.0).collect(),
        ..growing
    };
    let fit = VelocityCurveFit::new(free_for(0.5, 100.0), falling).background(2.0);
    let found = fit.free(["count", "background"]).run().unwrap();
    let background = found.estimate("background").unwrap();
    assert!(found.converged && background.limit.is_some_and(|limit| limit < 0.5), "{background:?}");
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let curve = |velocities: &[f64], forces: &[f64]| MeasuredVelocityCurve {
        velocities: velocities.to_vec(),
        forces: forces.to_vec(),
        errors: Some(vec![0.1; velocities.len()]),
    };
    let good = || curve(&[0.1, 1.0, 10.0], &[40.0, 30.0, 10.0]);
    let refused = |contacts: Contacts, curve: MeasuredVelocityCurve, names: &[&str]| {
        let found = VelocityCurveFit::new(contacts, curve).free(names.iter().copied()).run();
        match found.map(|found| found.parameters) {
            Err(Error::Invalid { key, expected, .. }) => format!("{key}: {expected}"),
            other => panic!("{other:?}"),
        }
    };
    let contacts = || free_for(0.5, 100.0);
    for (text, key) in [
        (refused(contacts(), curve(&[], &[]), &["count"]), "velocity: at least one velocity"),
        (refused(contacts(), curve(&[1.0, -1.0], &[1.0, 1.0]), &["count"]), "velocity.1"),
        (refused(contacts(), curve(&[1.0, 2.0], &[1.0]), &["count"]), "force: 2 values"),
        (refused(contacts(), curve(&[1.0, 2.0], &[1.0, f64::NAN]), &["count"]), "force.1"),
        (refused(contacts(), good(), &["count", "count"]), "free.1: each key once"),
        (refused(contacts(), good(), &["velocity"]), "free.0: one of count"),
        (refused(contacts(), good(), &[]), "free: at least one"),
        (refused(contacts(), good(), &["background"]), "background: a first value above 0"),
        (
            refused(contacts(), good(), &["count", "delay", "stiffness", "offset"]),
            "force: 4 readings or more",
        ),
        // Only the product of count and stiffness is in the force.
        (refused(contacts(), good(), &["count", "stiffness"]), "free"),
        // Contacts that know no time have one friction at all velocities.
        (refused(gaussian(), good(), &["thresholds.mean", "offset"]), "free"),
    ] {
        assert!(text.starts_with(key), "{text}, not {key}");
    }
    let unequal = MeasuredVelocityCurve { errors: Some(vec![0.1, 0.0, 0.1]), ..good() };
    assert!(refused(contacts(), unequal, &["count"]).starts_with("error.1"));
    let both = VelocityCurveFit::new(contacts(), good()).free(["count"]).reading(0.1).run();
    assert!(both.unwrap_err().to_string().starts_with("reading"));
    let unknown = MeasuredVelocityCurve { errors: None, ..good() };
    assert!(
        refused(contacts(), unknown, &["count", "delay", "offset"])
            .starts_with("force: 4 readings or more for 3 free numbers and the size of their errors")
    );
}
