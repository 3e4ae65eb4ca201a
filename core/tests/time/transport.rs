//! Contacts followed through time: against the renewal equation at one velocity, against closed forms, in balance.

use std::sync::Arc;

use crate::common::{gaussian, mixture, point, rectangular};
use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Rules, Start, Stiffness, Temperature};
use asperity::history::{History, Piece};
use asperity::law::{Exponential, Gamma, SharedLaw};
use asperity::master::{DynamicStiffness, MasterEquation, Slider, Trace, Transport};
use asperity::monitor::Monitor;

fn conditional(law: SharedLaw) -> Initial {
    Initial { law, start: Start::Conditional }
}

fn thermal(barrier: Barrier, energy: f64) -> Rules {
    let temperature = Some(Temperature { barrier, ..Temperature::new(energy, 1.0) });
    Rules { temperature, ..Rules::default() }
}

fn ageing(ageing: Ageing) -> Rules {
    Rules { ageing: Some(ageing), ..Rules::default() }
}

fn logarithmic() -> Ageing {
    Ageing::Logarithmic { growth: 0.02, time: 1.0 }
}

fn frozen_rank() -> Ageing {
    Ageing::FrozenRank { mature: gaussian(1.0, 0.05), time: 1.0 }
}

fn smoluchowski() -> Ageing {
    Ageing::Smoluchowski { mature: gaussian(1.0, 0.05), diffusion: 0.0025 }
}

fn contacts(thresholds: SharedLaw, rules: Rules) -> Contacts {
    Contacts { rules, ..Contacts::new(thresholds, point(0.0)) }
}

fn moving(pieces: &[(f64, f64)]) -> History {
    let piece = |&(velocity, duration): &(f64, f64)| Piece { velocity, duration };
    History::new(pieces.iter().map(piece).collect()).unwrap()
}

/// Times that share no step with anything.
fn times(history: &History, count: u32) -> Vec<f64> {
    (0..=count).map(|k| f64::from(k) / f64::from(count) * history.duration()).collect()
}

/// The largest difference of forces from the renewal equation in a pull over a distance at one velocity.
fn deviation(
    contacts: &Contacts,
    initial: &SharedLaw,
    (distance, velocity): (f64, f64),
    tolerance: f64,
    count: u32,
) -> (f64, Trace) {
    // Little beside the tolerance.
    let known = (1e-3 * tolerance).max(1e-9);
    let initial = conditional(initial.clone());
    let history = moving(&[(velocity, distance / velocity)]);
    let mut transport = Transport::new_with(contacts.clone(), &initial, tolerance, &mut ()).unwrap();
    let trace = transport.follow(&history, &times(&history, count)).unwrap();
    let equation = MasterEquation::at(contacts.clone(), &initial, velocity).unwrap();
    let pull = equation.pull_with(distance, known, &mut ()).unwrap();
    let off = |(&x, &force): (&f64, &f64)| (force - pull.force(x)).abs();
    (trace.position.iter().zip(&trace.force).map(off).fold(0.0, f64::max), trace)
}

#[test]
fn at_one_velocity_the_renewal_equation_is_reproduced() {
    let (mature, fresh) = (|| gaussian(1.0, 0.1), || gaussian(0.5, 0.1));
    let warm = thermal(Barrier::Elastic, 0.05);
    let with = |ageing: Ageing| Rules { ageing: Some(ageing), ..warm.clone() };
    let cases = [
        ("athermal", contacts(mature(), Rules::default()), (3.0, 1.0)),
        ("elastic", contacts(mature(), warm.clone()), (2.0, 1e-3)),
        ("bell", contacts(mature(), thermal(Barrier::Bell, 0.05)), (2.0, 1e-3)),
        ("catastrophe", contacts(mature(), thermal(Barrier::Catastrophe, 0.05)), (2.0, 1e-3)),
        ("identical", contacts(point(1.0), thermal(Barrier::Elastic, 0.05)), (3.0, 1e-4)),
        ("frozen_rank", contacts(fresh(), ageing(frozen_rank())), (3.0, 0.3)),
        ("frozen_rank, thermal", contacts(fresh(), with(frozen_rank())), (1.5, 1e-2)),
        ("logarithmic", contacts(mature(), ageing(logarithmic())), (3.0, 1e-2)),
        ("delay", contacts(mature(), Rules { delay: 0.3.into(), ..Rules::default() }), (3.0, 1.0)),
        ("smoluchowski", contacts(fresh(), ageing(smoluchowski())), (1.0, 0.3)),
        ("jumping density", contacts(rectangular(0.75, 1.25), Rules::default()), (3.0, 1.0)),
    ];
    // Ways on which all contacts break twice at least, but for those whose thresholds diffuse: work goes as the square of the
    // way.
    for (name, contacts, way) in cases {
        let (off, trace) = deviation(&contacts, &point(0.0), way, 3e-6, 37);
        // The tolerance asked for, in units of the mean threshold.
        assert!(off < 3e-6, "{name}: {off:e}");
        assert!(trace.error > 0.1 * off && trace.error < 1e-3, "{name}: {off:e} {:e}", trace.error);
    }
}

#[test]
fn between_the_ends_of_steps_forces_are_as_accurate_as_there() {
    let warm = thermal(Barrier::Elastic, 0.05);
    let with = |ageing| Rules { ageing: Some(ageing), ..warm.clone() };
    let per_threshold = |contacts| Contacts { stiffness: Stiffness::PerThreshold(1.0), ..contacts };
    let spread = |contacts| Contacts { reforming: rectangular(0.0, 0.2), ..contacts };
    let cases = [
        ("athermal", contacts(gaussian(1.0, 0.1), Rules::default()), (2.0, 1.0)),
        ("delay", contacts(gaussian(1.0, 0.1), Rules { delay: 0.3.into(), ..Rules::default() }), (2.0, 1.0)),
        ("temperature and a spread", spread(contacts(gaussian(1.0, 0.1), warm.clone())), (2.0, 1e-3)),
        ("both", per_threshold(contacts(gaussian(1.0, 0.1), with(logarithmic()))), (2.0, 1e-2)),
        ("diffusion", contacts(gaussian(0.5, 0.1), ageing(smoluchowski())), (0.6, 0.3)),
    ];
    // Tens of times in each step, none of which ends one, and a single one in some.
    for (tolerance, count) in [(1e-4, 1511), (1e-4, 29)] {
        for (name, contacts, way) in &cases {
            let (off, trace) = deviation(contacts, &point(0.0), *way, tolerance, count);
            // The tolerance asked for.
            assert!(off < tolerance, "{name} {tolerance:e} {count}: {off:e}");
            // What breaks is the integral of the rate, by the trapezoidal rule over times that are dense.
            let points: Vec<_> = trace.time.iter().zip(&trace.breaking_rate).collect();
            let sum = |pair: &[(&f64, &f64)]| 0.5 * (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1);
            let broken: f64 = points.windows(2).map(sum).sum();
            let history = moving(&[(way.1, way.0 / way.1)]);
            let mut whole =
                Transport::new_with(contacts.clone(), &conditional(point(0.0)), tolerance, &mut ()).unwrap();
            whole.follow(&history, &[]).unwrap();
            let missed = (broken - whole.energies().broken).abs();
            // Second order in spacings of a fiftieth of the width.
            assert!(count < 100 || missed < 5e-3, "{name} {tolerance:e}: {missed:e}");
        }
    }
}

#[test]
fn times_inside_a_hold_change_nothing() {
    let both = contacts(
        gaussian(1.0, 0.1),
        Rules { ageing: Some(logarithmic()), ..thermal(Barrier::Elastic, 0.05) },
    );
    for contacts in [both.clone(), Contacts { stiffness: Stiffness::PerThreshold(1.0), ..both }] {
        // Whatever is asked for, steps grow by factors in a hold.
        let history = moving(&[(0.1, 9.0), (0.0, 1e6), (0.1, 0.1)]);
        let times: Vec<f64> = (0..=60).map(|k| 9.0 + 10f64.powf(0.1 * f64::from(k))).collect();
        let start = Transport::new_with(contacts, &conditional(point(0.0)), 1e-5, &mut ()).unwrap();
        let together = start.clone().follow(&history, &times).unwrap();
        for k in (0..=60).step_by(20) {
            // A motion that ends there.
            let ended = moving(&[(0.1, 9.0), (0.0, times[k] - 9.0)]);
            let mut until = start.clone();
            until.follow(&ended, &[]).unwrap();
            // Both are right to the tolerance.
            assert!((until.force() - together.force[k]).abs() < 2e-5, "{k}");
        }
    }
}

#[test]
fn a_wide_law_at_a_temperature_is_followed_as_closely_as_one_asks() {
    let wide = contacts(Arc::new(Gamma::new(1.0, 0.2).unwrap()), thermal(Barrier::Elastic, 0.05));
    for (tolerance, allowed) in [(1e-6, 1e-6), (1e-9, 1e-9)] {
        let (off, trace) = deviation(&wide, &point(0.0), (1.0, 0.01), tolerance, 5);
        // The tolerance; the renewal equation itself is asked for 1e-9.
        assert!(off < allowed + 1e-9, "{tolerance:e}: {off:e}");
        assert!(trace.error > off && trace.check(1.0, Some(0.5 * off)).is_err(), "{off:e} {:e}", trace.error);
        let error = trace.check(1.0, Some(0.5 * off)).unwrap_err().to_string();
        assert!(error.starts_with("tolerance: ") && error.contains("leave the tolerance out"), "{error}");
    }
}

#[test]
fn so_it_is_at_velocities_at_which_the_layer_of_diffusion_is_thick_and_thin() {
    let diffusing = contacts(gaussian(0.5, 0.1), ageing(smoluchowski()));
    // D/v is 0.08, and a hundredth of the widest cell: 2.5e-5.
    for (velocity, distance) in [(0.03, 1.1), (1.0, 1.0), (100.0, 0.9)] {
        let (off, _) = deviation(&diffusing, &point(0.0), (distance, velocity), 1e-4, 37);
        assert!(off < 1e-4, "{velocity}: {off:e}");
    }
}

#[test]
fn so_it_is_for_spread_starts_and_stiffness_that_goes_with_the_threshold() {
    let spread =
        |thresholds, rules| Contacts { reforming: rectangular(0.0, 0.2), ..contacts(thresholds, rules) };
    let per_threshold = |contacts| Contacts { stiffness: Stiffness::PerThreshold(1.0), ..contacts };
    let warm = thermal(Barrier::Elastic, 0.05);
    // Ways on which all contacts break twice: more takes the square of the time.
    let cases = [
        (spread(gaussian(1.0, 0.1), Rules::default()), gaussian(0.1, 0.025), (2.0, 1.0)),
        (spread(gaussian(0.5, 0.1), ageing(frozen_rank())), gaussian(0.1, 0.025), (1.5, 0.3)),
        (per_threshold(contacts(gaussian(1.0, 0.1), ageing(logarithmic()))), point(0.0), (2.0, 1e-2)),
        (per_threshold(contacts(gaussian(1.0, 0.1), warm.clone())), point(0.0), (2.0, 1e-3)),
        (
            contacts(gaussian(1.0, 0.1), Rules { ageing: Some(logarithmic()), ..warm }),
            point(0.0),
            (2.0, 1e-2),
        ),
        (
            per_threshold(contacts(
                gaussian(0.5, 0.1),
                Rules { ageing: Some(smoluchowski()), ..thermal(Barrier::Elastic, 0.05) },
            )),
            point(0.0),
            (0.8, 1e-2),
        ),
    ];
    for (i, (contacts, initial, way)) in cases.into_iter().enumerate() {
        let (off, _) = deviation(&contacts, &initial, way, 1e-5, 37);
        // The tolerance asked for.
        assert!(off < 1e-5, "{i}: {off:e}");
    }
}

#[test]
fn kinetic_friction_of_the_models_is_that_of_the_references() {
    // Forces at velocities, each with the digits that are known.
    let fresh = gaussian(0.5, 0.1);
    for (velocity, force, known) in
        [(10.0, 0.2720, 1e-4), (1.0, 0.38468, 1e-5), (0.1, 0.49031, 1e-5), (0.01, 0.46235, 1e-5)]
    {
        let diffusing = contacts(fresh.clone(), ageing(smoluchowski()));
        let steady = Transport::steady_with(&diffusing, velocity, 1e-4, &mut ()).unwrap();
        // Known digits, and the tolerance.
        assert!((steady.force() - force).abs() < known + 1e-4, "{velocity}: {}", steady.force());
    }
    for (velocity, force) in [(10.0, 0.2721367872), (1.0, 0.3867782523), (0.1, 0.5012378105), (0.01, 0.50125)]
    {
        let steady =
            Transport::steady_with(&contacts(fresh.clone(), ageing(frozen_rank())), velocity, 1e-6, &mut ());
        // The references ignore thresholds below 0.
        assert!((steady.unwrap().force() - force).abs() < 1e-7, "{velocity}");
    }
    for (barrier, forces) in [
        (Barrier::Elastic, [0.04114415072, 0.3330145881]),
        (Barrier::Bell, [0.02192174029, 0.2198520329]),
        (Barrier::Catastrophe, [0.01829963892, 0.1653798456]),
    ] {
        for (velocity, force) in [1e-10, 1e-6].into_iter().zip(forces) {
            let steady = Transport::steady_with(
                &contacts(point(1.0), thermal(barrier, 0.025)),
                velocity,
                1e-6,
                &mut (),
            );
            // Far below the tolerance, since lives in steady sliding are smooth.
            assert!((steady.unwrap().force() - force).abs() < 1e-8, "{barrier:?} {velocity:e}");
        }
    }
}

#[test]
fn steady_sliding_stays_steady_and_free_contacts_wait() {
    let (delay, velocity) = (0.5, 2.0);
    let waiting = contacts(gaussian(1.0, 0.1), Rules { delay: delay.into(), ..Rules::default() });
    let mut transport = Transport::steady_with(&waiting, velocity, 1e-6, &mut ()).unwrap();
    let history = moving(&[(velocity, 3.0)]);
    let trace = transport.follow(&history, &times(&history, 13)).unwrap();
    for (force, free) in trace.force.iter().zip(&trace.free) {
        // Alternating renewal: F_k = N⟨k⟩∫xS/(C + vτ) = .505/2, of which half is free.
        assert!((force - 0.2525).abs() < 1e-6 && (free - 0.5).abs() < 1e-6, "{force} {free}");
    }
}

#[test]
fn a_delay_shorter_than_any_step_is_none() {
    let initial = conditional(point(0.0));
    let history = moving(&[(1.0, 4.0)]);
    let force = |delay: f64| {
        let waiting = contacts(gaussian(1.0, 0.1), Rules { delay: delay.into(), ..Rules::default() });
        let mut transport = Transport::new_with(waiting, &initial, 1e-6, &mut ()).unwrap();
        transport.follow(&history, &times(&history, 9)).unwrap().force
    };
    let (without, with) = (force(0.0), force(1e-7));
    // Each of four breaks comes late by 1e-7, times slopes of up to 4.
    assert!(without.iter().zip(&with).all(|(a, b)| (a - b).abs() < 3e-6), "{without:?} {with:?}");
}

/// A slide, a jump of the velocity by five decades, a hold, and a slide again.
fn wild() -> History {
    moving(&[(1.0, 0.9), (1e-5, 1e4), (0.0, 1e3), (2.0, 0.3)])
}

#[test]
fn what_is_attached_and_what_is_free_are_all_contacts() {
    let warm = thermal(Barrier::Elastic, 0.05);
    let with = |ageing: Ageing| Rules { ageing: Some(ageing), delay: 0.3.into(), ..warm.clone() };
    let cases = [
        contacts(gaussian(1.0, 0.1), Rules { delay: 0.3.into(), ..warm.clone() }),
        contacts(gaussian(1.0, 0.1), with(logarithmic())),
        contacts(gaussian(0.5, 0.1), with(frozen_rank())),
        contacts(gaussian(0.5, 0.1), with(smoluchowski())),
        contacts(point(1.0), warm.clone()),
        Contacts { reforming: rectangular(0.0, 0.2), ..contacts(rectangular(0.8, 1.2), warm.clone()) },
    ];
    let history = wild();
    for (i, contacts) in cases.into_iter().enumerate() {
        let initial = Initial { law: gaussian(0.2, 0.1), start: Start::Relaxed };
        // Nothing is lost at any tolerance; this is the largest.
        let mut transport = Transport::new_with(contacts, &initial, 1e-2, &mut ()).unwrap();
        let trace = transport.follow(&history, &times(&history, 5)).unwrap();
        let whole = transport.attached() + transport.free();
        // Rounding.
        assert!((whole - 1.0).abs() < 1e-12, "{i}: {:e}", whole - 1.0);
        assert!(trace.free.iter().chain(&trace.force).all(|&value| value >= 0.0), "{i}: {trace:?}");
        let stretches: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.005).collect();
        let found = transport.stretch_density(&stretches);
        assert!(found.density.iter().all(|&density| density >= 0.0), "{i}");
    }
}

#[test]
fn errors_fall_with_the_fourth_power_of_the_step() {
    // Steps and cells go as the fourth root of the tolerance: what is left of errors when that is 256 times smaller, so that
    // they are a quarter as long, is 1/256 of them, within a factor of four for where times fall in steps.
    let athermal = contacts(gaussian(1.0, 0.1), Rules::default());
    let diffusing = contacts(gaussian(0.5, 0.1), ageing(smoluchowski()));
    for (contacts, way, last, count) in [(athermal, (3.0, 1.0), 1e-7, 3), (diffusing, (1.0, 0.3), 3e-7, 37)] {
        let off = |tolerance| deviation(&contacts, &point(0.0), way, tolerance, count).0;
        let (coarse, fine) = (off(256.0 * last), off(last));
        assert!(coarse / fine > 64.0, "{coarse:e} {fine:e}");
    }
}

#[test]
fn a_hold_changes_nothing_where_nothing_knows_time() {
    let initial = conditional(point(0.0));
    let athermal = contacts(gaussian(1.0, 0.1), Rules::default());
    let force = |pieces: &[(f64, f64)]| {
        let mut transport = Transport::new_with(athermal.clone(), &initial, 1e-6, &mut ()).unwrap();
        transport.follow(&moving(pieces), &[]).unwrap();
        transport.force()
    };
    let [held, through] = [force(&[(1.0, 1.2), (0.0, 1e5), (1e3, 1.5e-3)]), force(&[(1.0, 2.7)])];
    // Both are right to the tolerance.
    assert!((held - through).abs() < 1e-6, "{held} {through}");
}

#[test]
fn rules_that_fade_leave_athermal_contacts() {
    let initial = conditional(point(0.0));
    let history = moving(&[(1.0, 3.3)]);
    let force = |rules: Rules| {
        let mut transport =
            Transport::new_with(contacts(gaussian(1.0, 0.1), rules), &initial, 1e-5, &mut ()).unwrap();
        transport.follow(&history, &times(&history, 7)).unwrap().force
    };
    let athermal = force(Rules::default());
    let slow = |diffusion| ageing(Ageing::Smoluchowski { mature: gaussian(1.2, 0.1), diffusion });
    let faint = Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.05, 1e-7) };
    for (rules, left) in [
        // Contacts broken at the rate 1e-7 at most; strengthened by 1e-7 ln 4.3; spread by √(2·3.3e-9), times slopes of 1.
        (Rules { temperature: Some(faint), ..Rules::default() }, 1e-6),
        (ageing(Ageing::Logarithmic { growth: 1e-7, time: 1.0 }), 2e-6),
        (slow(1e-9), 1e-4),
    ] {
        let off = force(rules.clone()).iter().zip(&athermal).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-5 + left, "{rules:?}: {off:e}");
    }
}

/// Exponential free times have no memory: how many contacts are free says all. A gamma distribution of shape 1 is the same one,
/// for which the history of breaks is kept.
#[test]
fn free_times_without_memory_are_those_of_a_history_of_breaks() {
    let followed = |delay: SharedLaw| {
        let rules = Rules { delay: delay.into(), ..ageing(logarithmic()) };
        let mixed = mixture(&[(0.3, point(1.0)), (0.7, gaussian(1.0, 0.2))]);
        let initial = Initial { law: point(0.0), start: Start::Relaxed };
        let mut transport = Transport::new_with(contacts(mixed, rules), &initial, 1e-5, &mut ()).unwrap();
        transport.follow(&wild(), &times(&wild(), 40)).unwrap()
    };
    let by_rate = followed(Arc::new(Exponential::new(0.3).unwrap()));
    let by_history = followed(Arc::new(Gamma::new(0.3, 0.3).unwrap()));
    let apart = |of: fn(&Trace) -> &[f64]| {
        of(&by_rate).iter().zip(of(&by_history)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    // The table of the survival of free times has an error of 1e-15, and three nodes in each past step less than the tolerance.
    assert!(
        apart(|trace| &trace.force) < 1e-7 && apart(|trace| &trace.free) < 1e-7,
        "{}",
        apart(|t| &t.force)
    );
    assert!(by_rate.free.iter().any(|&free| free > 0.1));
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let force = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let diffusing = contacts(gaussian(0.5, 0.1), ageing(smoluchowski()));
            let mut transport = Transport::steady_with(&diffusing, 1.0, 1e-3, &mut ()).unwrap();
            transport.follow(&moving(&[(0.1, 3.0)]), &[1.0, 2.0, 3.0]).unwrap().force
        })
    };
    assert_eq!(force(1), force(3));
}

#[test]
fn the_response_to_a_small_step_integrates_to_the_slope_of_kinetic_friction() {
    let strengthening = contacts(gaussian(1.0, 0.1), ageing(logarithmic()));
    let velocity = 0.1;
    let response = DynamicStiffness::followed(&strengthening, velocity, 60.0, 1e-6, &mut ()).unwrap();
    let kinetic = |velocity| {
        let equation = MasterEquation::at(strengthening.clone(), &conditional(point(0.0)), velocity).unwrap();
        equation.steady_state().kinetic_friction()
    };
    let slope = (kinetic(1.01 * velocity) - kinetic(0.99 * velocity)) / (0.02 * velocity);
    // The step is a hundredth of the width of thresholds: its second order is that share of the response.
    assert!((response.integral() / slope - 1.0).abs() < 0.02, "{} {slope}", response.integral());
    let (stiffness, frequency) = response.critical_stiffness(Slider::default(), &mut ()).unwrap().unwrap();
    assert!(stiffness > 0.0 && frequency > 0.0);
    // Where an oscillation sets in, the response is real.
    assert!(
        frequency.is_infinite()
            || (response.at(num_complex::Complex64::new(0.0, frequency)) + stiffness).norm() < 1e-9
    );
}

#[test]
fn a_required_accuracy_is_reached_with_a_smaller_tolerance() {
    let contacts = contacts(gaussian(1.0, 0.1), thermal(Barrier::Elastic, 0.05));
    let history = moving(&[(1e-2, 150.0)]);
    let times = times(&history, 201);
    let mut tolerances = Vec::new();
    let mut build = |tolerance: f64, monitor: &mut dyn Monitor| {
        tolerances.push(tolerance);
        Transport::new_with(contacts.clone(), &conditional(point(0.0)), tolerance, monitor)
    };
    // Errors are estimated as those of sixteen times the tolerance, which is above a tenth of it.
    let (motion, accuracy) = ((&history, times.as_slice()), (1e-5, Some(1e-6)));
    let trace = Transport::follow_as_required(&mut build, motion, accuracy, &mut ()).unwrap();
    assert!(trace.error <= 1e-6, "{:e}", trace.error);
    assert!(tolerances.len() == 2 && tolerances[1] < tolerances[0], "{tolerances:?}");
}

#[test]
fn bad_input_is_refused() {
    let mean_field = Ageing::MeanField { mature: gaussian(1.0, 0.05), diffusion: 0.0025 };
    let initial = conditional(point(0.0));
    let error = Transport::new_with(contacts(point(1.0), ageing(mean_field)), &initial, 1e-4, &mut ());
    assert!(
        error
            .unwrap_err()
            .to_string()
            .starts_with("thresholds: expected a distribution without point masses")
    );
    let athermal = contacts(gaussian(1.0, 0.1), Rules::default());
    assert!(Transport::new_with(athermal.clone(), &initial, 1.0, &mut ()).is_err());
    assert!(Transport::steady_with(&athermal, 0.0, 1e-4, &mut ()).is_err());
    let mut transport = Transport::new_with(athermal, &initial, 1e-4, &mut ()).unwrap();
    assert!(transport.follow(&moving(&[(1.0, 1.0)]), &[0.5, 0.4]).is_err());
    assert!(transport.follow(&moving(&[(1.0, 1.0)]), &[1.5]).is_err());
    assert!(transport.step(1.0, 0.0, &mut ()).is_err());
}
