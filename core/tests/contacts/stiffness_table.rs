//! Contacts whose stiffness is a table against the threshold, k(x_s).

#![allow(missing_docs)]

use std::sync::Arc;

use asperity::Error;
use asperity::block::{Block, Drive, Loading, Slip};
use asperity::contacts::{Barrier, Contacts, Initial, Stiffness, StiffnessTable, Temperature};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::law::{Gaussian, Law, Point, Rectangular, SharedLaw};
use asperity::master::{DynamicStiffness, MasterEquation, Transport};
use asperity::population::Population;

/// A table with a kink inside the thresholds, softer for strong contacts.
fn kinked() -> Stiffness {
    Stiffness::Tabulated(StiffnessTable::new(vec![(0.8, 1.0), (1.1, 2.5), (1.6, 0.5)]).unwrap())
}

fn contacts(thresholds: impl Law + 'static, reforming: impl Law + 'static, stiffness: Stiffness) -> Contacts {
    Contacts { stiffness, ..Contacts::new(Arc::new(thresholds), Arc::new(reforming)) }
}

fn at_zero() -> Point {
    Point::new(0.0).unwrap()
}

#[test]
fn a_straight_table_is_a_stiffness_per_threshold_and_a_flat_one_an_equal_stiffness() {
    let starts: [SharedLaw; 2] = [Arc::new(at_zero()), Arc::new(Gaussian::new(0.1, 0.025).unwrap())];
    for (rows, known) in [
        (vec![(0.0, 0.0), (50.0, 100.0)], Stiffness::PerThreshold(2.0)),
        (vec![(0.5, 3.0), (1.5, 3.0)], Stiffness::Equal(3.0)),
    ] {
        for start in &starts {
            let initial = Initial::new(start.clone());
            let solve = |stiffness| {
                let contacts = Contacts {
                    stiffness,
                    ..Contacts::new(Arc::new(Gaussian::new(1.0, 0.2).unwrap()), start.clone())
                };
                MasterEquation::new(contacts, &initial).unwrap()
            };
            let table = solve(Stiffness::Tabulated(StiffnessTable::new(rows.clone()).unwrap()));
            let known = solve(known.clone());
            let [a, b] = [&table, &known].map(|equation| equation.pull(6.0).unwrap());
            for i in 0..=600 {
                let position = f64::from(i) / 100.0;
                // Both are accurate to the default tolerance.
                assert!((a.force(position) - b.force(position)).abs() < 1e-9, "{position}");
            }
            assert!((a.static_friction().unwrap().value - b.static_friction().unwrap().value).abs() < 1e-9);
            let [a, b] = [table, known].map(|equation| equation.steady_state());
            assert!((a.kinetic_friction() - b.kinetic_friction()).abs() < 1e-12);
        }
    }
}

/// U(1, 2), R = Q_ini = δ₀: before re-formed contacts break, X < 2, F = X ∫_X^2 k dh + ⟨k⟩ ∫_1^X (X − h) dh. Steady sliding
/// loses ½⟨k x_s²⟩ per break and has 1/⟨x_s⟩ breaks per length.
#[test]
fn the_first_loading_and_kinetic_friction_have_closed_forms() {
    // k = 1 + 2(h − 1) up to 1.5, then 2 + 4(h − 1.5).
    let table = StiffnessTable::new(vec![(1.0, 1.0), (1.5, 2.0), (2.0, 4.0)]).unwrap();
    let stiff = Stiffness::Tabulated(table);
    let contacts = contacts(Rectangular::new(1.0, 2.0).unwrap(), at_zero(), stiff.clone());
    let equation = MasterEquation::new(contacts, &Initial::default()).unwrap();
    let pull = equation.pull(1.999).unwrap();
    // ∫_x^2 k dh.
    let above = |x: f64| match x {
        _ if x <= 1.0 => 2.25,
        _ if x <= 1.5 => 1.5 + 0.5 * (1.5 - x) * (1.0 + 2.0 * (x - 1.0) + 2.0),
        _ => 0.5 * (2.0 - x) * (2.0 + 4.0 * (x - 1.5) + 4.0),
    };
    assert!((stiff.mean(&Rectangular::new(1.0, 2.0).unwrap()) - 2.25).abs() < 1e-15);
    for i in 0..=199 {
        let x = 0.01 * f64::from(i);
        let reformed = 2.25 * 0.5 * f64::max(x - 1.0, 0.0).powi(2);
        // The default tolerance.
        assert!((pull.force(x) - x * above(x) - reformed).abs() < 1e-10, "{x}");
    }
    // ∫ ½ k h² dh over both parts, k = 2h − 1 and 4h − 4: ∫(2h − 1)h² = [h⁴/2 − h³/3], ∫(4h − 4)h² = [h⁴ − 4h³/3].
    let first = |h: f64| h.powi(4) / 2.0 - h.powi(3) / 3.0;
    let second = |h: f64| h.powi(4) - 4.0 * h.powi(3) / 3.0;
    let lost = 0.5 * (first(1.5) - first(1.0) + second(2.0) - second(1.5));
    assert!((equation.steady_state().kinetic_friction() - lost / 1.5).abs() < 1e-12);
}

/// F(X) of contacts that start and re-form at 0, by the trapezoidal rule for the renewal equation ρ = P_c + P_c∗ρ and for
/// F = XK(X) + ∫ρ(Y) (X − Y) K(X − Y) dY with K(x) = ∫_x^∞ kP_c, extrapolated to steps of 0 (Richardson).
fn by_trapezoids(law: &Gaussian, stiffness: &Stiffness, position: f64) -> f64 {
    let carried = |x: f64| {
        // Simpson's rule from kink to kink, up to 7 standard deviations.
        let ends: Vec<f64> =
            [x].into_iter().chain([0.8, 1.1, 1.6, 2.4].into_iter().filter(|&h| h > x)).collect();
        let value = |h: f64| stiffness.of(h) * law.density(h);
        let between = |ends: &[f64]| {
            let width = (ends[1] - ends[0]) / 100.0;
            let of_step = |i: i32| {
                let low = ends[0] + width * f64::from(i);
                width / 6.0 * (value(low) + 4.0 * value(low + 0.5 * width) + value(low + width))
            };
            (0..100).map(of_step).sum::<f64>()
        };
        ends.windows(2).map(between).sum::<f64>()
    };
    let on_steps = |steps: usize| {
        let width = position / steps as f64;
        let at = |i: usize| width * i as f64;
        let density: Vec<f64> = (0..=steps).map(|i| law.density(at(i))).collect();
        let mut rate = vec![density[0]];
        for i in 1..=steps {
            let history: f64 = (1..i).map(|j| density[j] * rate[i - j]).sum();
            let known = density[i] + width * (history + 0.5 * density[i] * rate[0]);
            rate.push(known / (1.0 - 0.5 * width * density[0]));
        }
        let force: Vec<f64> = (0..=steps).map(|i| at(i) * carried(at(i))).collect();
        let inner: f64 = (1..steps).map(|i| rate[i] * force[steps - i]).sum();
        force[steps] + width * (inner + 0.5 * rate[0] * force[steps])
    };
    let [a, b, c] = [200, 400, 800].map(on_steps);
    let [p, q] = [(4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0];
    (16.0 * q - p) / 15.0
}

#[test]
fn the_renewal_equation_by_trapezoids_agrees_beyond_the_kinks() {
    let law = Gaussian::new(1.0, 0.2).unwrap();
    let contacts = contacts(law, at_zero(), kinked());
    let pull = MasterEquation::new(contacts, &Initial::default()).unwrap().pull(3.0).unwrap();
    for position in [0.5, 0.9, 1.3, 2.0] {
        let expected = by_trapezoids(&law, &kinked(), position);
        // Kinks are at multiples of the steps, and the error is of the sixth power of a step, 1e-2 at most.
        assert!(
            (pull.force(position) - expected).abs() < 2e-9,
            "{position}: {}",
            pull.force(position) - expected
        );
    }
}

#[test]
fn the_ensemble_agrees() {
    for start in [Arc::new(at_zero()) as SharedLaw, Arc::new(Gaussian::new(0.1, 0.025).unwrap())] {
        let contacts = Contacts {
            count: 7.0,
            ..contacts(Gaussian::new(1.0, 0.2).unwrap(), Rectangular::new(0.0, 0.1).unwrap(), kinked())
        };
        let initial = Initial::new(start);
        let positions: Vec<f64> = (1..=40).map(|i| 0.2 * f64::from(i)).collect();
        let pull = MasterEquation::new(contacts.clone(), &initial).unwrap().pull(8.0).unwrap();
        let ensemble = Ensemble::new(contacts, initial, 200_000, 1, Disorder::Annealed).unwrap();
        let sample = ensemble.pull(&positions).unwrap();
        for (i, &position) in positions.iter().enumerate() {
            // 80 comparisons: 4.5 standard errors are exceeded by chance in one of 1800 tests.
            let apart = (sample.force[i] - pull.force(position)).abs() / sample.error[i];
            assert!(apart < 4.5, "{position}: {apart}");
        }
        // The standard error of the ensemble is that of the master equation's variance.
        let expected = pull.force_std(200_000.0).unwrap()(8.0);
        // The standard error of a standard deviation of 2e5 contacts is 1.6e-3 of it.
        assert!((sample.error[39] / expected - 1.0).abs() < 8e-3, "{} {expected}", sample.error[39]);
    }
}

/// Loading and unloading, by both solvers, through a block.
#[test]
fn a_block_turns_over_both_solvers_alike() {
    let contacts = contacts(Gaussian::new(1.0, 0.2).unwrap(), at_zero(), kinked());
    let initial = Initial::default();
    let equation = MasterEquation::new(contacts.clone(), &initial).unwrap();
    const SIZE: usize = 50_000;
    let ensemble = Ensemble::new(contacts, initial, SIZE, 1, Disorder::Annealed).unwrap();
    let turning_points = [0.9, -0.2, 1.6, 0.5, 2.5];
    // A spring stiffer than any slope of the force: nothing slips but single contacts of the ensemble.
    let block = Block::new(Loading::Spring(100.0), Slip::Overdamped, None).unwrap();
    let end = |population: &mut dyn Population, turns: usize| {
        let drive = Drive { turning_points: turning_points[..turns].to_vec(), points: 11 };
        let slider = block.pull(population, &drive).unwrap();
        slider.trace.last().unwrap().force
    };
    for turns in [2, 5] {
        let continuous = end(&mut equation.population().unwrap(), turns);
        let random = end(&mut ensemble.population().unwrap(), turns);
        // A contact carries at most 2.5 × 1.1, with a standard deviation below 1.4: five standard errors.
        let allowed = 5.0 * 1.4 / (SIZE as f64).sqrt();
        assert!((continuous - random).abs() < allowed, "{turns}: {continuous} {random}");
    }
}

/// All contacts re-form in a slip by the rule `reset`: the force then rises by N⟨k⟩, the mean of the table and not its value at
/// the mean threshold, and the slip dissipates all elastic energy.
#[test]
fn contacts_re_form_with_the_mean_stiffness_after_a_reset() {
    let law = Gaussian::new(1.0, 0.1).unwrap();
    let equation = MasterEquation::new(contacts(law, at_zero(), kinked()), &Initial::default()).unwrap();
    let drive = Drive { turning_points: vec![7.0], points: 4001 };
    let block = Block::new(Loading::Spring(0.5), Slip::Reset, None).unwrap();
    let slider = block.pull(&mut equation.population().unwrap(), &drive).unwrap();
    let slip = slider.events[0];
    let after = slider.trace.iter().find(|point| point.drive > slip.after.drive + 0.05).unwrap();
    let mean = kinked().mean(&law);
    // Nothing breaks this early: 7 standard deviations below the mean threshold.
    let slope = (after.force - slip.after.force) / (after.position - slip.after.position);
    assert!((slope / mean - 1.0).abs() < 1e-9, "{slope} {mean}");
    assert!((mean - kinked().of(1.0)).abs() > 0.05, "the kink does not show: {mean}");
    assert!(slider.energy.imbalance().abs() < 1e-8, "{:?}", slider.energy);
}

/// Derivatives of the lives are differences of eighth order; here those of whole pulls, over a step of 1e-3, to its fourth power.
#[test]
fn a_gradient_is_a_difference_of_pulls() {
    let pull = |mean: f64| {
        let contacts = contacts(Gaussian::new(mean, 0.2).unwrap(), at_zero(), kinked());
        MasterEquation::new(contacts, &Initial::default()).unwrap().pull(3.0).unwrap()
    };
    let gradient = pull(1.0).gradient("thresholds.mean").unwrap();
    let steps = [-2e-3, -1e-3, 1e-3, 2e-3].map(|step| pull(1.0 + step));
    for position in [0.5, 0.9, 1.3, 2.0, 2.9] {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| steps[k].force(position));
        let difference = (a - 8.0 * b + 8.0 * c - d) / 12e-3;
        // Errors of 1e-10 over 1e-3, and 1e-12 × the fifth derivative, some (1/0.2)⁵.
        let computed = gradient.at(position);
        assert!((computed - difference).abs() < 1e-6, "{position}: {computed} {difference}");
    }
}

#[test]
fn what_needs_equal_stiffnesses_is_refused() {
    let table = contacts(Gaussian::new(1.0, 0.2).unwrap(), at_zero(), kinked());
    let key = |error: Error| match error {
        Error::Invalid { key, .. } => key,
        other => panic!("{other}"),
    };
    let mut warm = table.clone();
    warm.rules.temperature = Some(Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.01, 1.0) });
    assert_eq!(key(warm.check(&Initial::default()).unwrap_err()), "stiffness.of_threshold");
    let mut delayed = table.clone();
    delayed.rules.delay = 0.5.into();
    assert_eq!(key(delayed.check(&Initial::default()).unwrap_err()), "stiffness.of_threshold");
    // In time contacts without rules are followed as all others are.
    assert_eq!(
        key(Transport::new(table.clone(), &Initial::default()).unwrap_err()),
        "stiffness.of_threshold"
    );
    assert_eq!(key(Transport::steady(&table, 1.0).unwrap_err()), "stiffness.of_threshold");
    // The force of steady sliding does not depend on how the slider moves on.
    assert_eq!(DynamicStiffness::new(&table, 1.0).unwrap().integral(), 0.0);
    let equation = MasterEquation::new(table, &Initial::default()).unwrap();
    assert_eq!(
        key(equation.pull(3.0).unwrap().covariance(&[1.0, 2.0], 100.0).unwrap_err()),
        "stiffness.of_threshold"
    );
}
