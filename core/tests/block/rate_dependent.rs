//! A slider block over time-dependent contacts: against the athermal block, linear stability and the ensemble.

use crate::common::pulled::{UNDAMPED, near};
use crate::common::{contacts, gamma, gaussian, initial, master, point};
use asperity::block::{Block, Drive, Loading, Regime, Slide, Slip};
use asperity::contacts::{Ageing, Contacts, FreeFriction, Rules};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::law::SharedLaw;
use asperity::master::{DynamicStiffness, MasterEquation, Slider, Transport};
use asperity::rate_dependent::PopulationInTime;
use asperity::{Error, Result};

/// σ = 0.1 and K = 1: X_T at the first slip, X_2 overdamped and inertial.
const FIRST: [f64; 3] = [0.8925878043021 + 0.7736105511280, 1.332802416243, 1.599378752724];

fn steady(velocity: f64, distance: f64) -> History {
    History::new(vec![Piece { velocity, duration: distance / velocity }]).unwrap()
}

/// Times evenly spaced along a history.
fn times(history: &History, count: u32) -> Vec<f64> {
    (0..=count).map(|i| f64::from(i) / f64::from(count) * history.duration()).collect()
}

fn block(stiffness: f64, slip: Slip) -> Block {
    Block::new(Loading::Spring(stiffness), slip, None).unwrap()
}

fn athermal() -> Contacts {
    contacts(&gaussian(1.0, 0.1), &point(0.0))
}

fn ageing(thresholds: (f64, f64), ageing: Ageing) -> Contacts {
    let rules = Rules { ageing: Some(ageing), ..Rules::default() };
    Contacts { rules, ..contacts(&gaussian(thresholds.0, thresholds.1), &point(0.0)) }
}

fn logarithmic() -> Contacts {
    ageing((1.0, 0.2), Ageing::Logarithmic { growth: 0.02, time: 1.0 })
}

/// A slider with K = 1 over relaxed contacts without rules, driven to X_T = 2.
fn first_slip(slip: Slip, velocity: f64, tolerance: f64) -> Slide {
    let transport = Transport::new_with(athermal(), &initial(&point(0.0)), 0.1 * tolerance, &mut ()).unwrap();
    let drive = steady(velocity, 2.0);
    block(1.0, slip).follow_with(&transport, &drive, &times(&drive, 50), tolerance, &mut ()).unwrap()
}

#[test]
fn slow_and_little_damped_it_is_the_overdamped_block() {
    let damped = Slip::Damped { damping: 1e-3 };
    let [quick, slow] = [1e-2, 1e-4].map(|velocity| first_slip(damped, velocity, 1e-5));
    let off = |run: &Slide| run.slips[0].position_turn - FIRST[1];
    // A slider lingers where balance is lost, while the drive goes on by some (γv)^{2/3}.
    let exponent = (off(&quick) / off(&slow)).ln() / 100.0_f64.ln();
    near(exponent, 2.0 / 3.0, 0.05);
    near(off(&slow), 0.0, 2e-5);
    let slip = &slow.slips[0];
    // Ten times as fast as the drive it is where F' = −0.9 K, somewhat before X_1, the drive by the square of that.
    near(slip.before.drive, FIRST[0], 3e-4);
    let pull = MasterEquation::new(athermal(), &initial(&point(0.0)))
        .unwrap()
        .pull_with(2.0, 1e-9, &mut ())
        .unwrap();
    // The accuracy of steps.
    near(slip.before.force, pull.force(slip.before.position), 1e-5);
    near(slip.after.force, pull.force(slip.after.position), 1e-5);
    // The lingering, times forces below 1.
    near(slow.energy.viscous, 0.07085, 2e-5);
}

#[test]
fn slow_and_undamped_it_stops_at_equal_areas() {
    let [quick, slow] = [1e-3, 1e-5].map(|velocity| first_slip(UNDAMPED, velocity, 1e-5));
    let off = |run: &Slide| run.slips[0].position_turn - FIRST[2];
    // With inertia it lingers for some (v√M)^{4/5}.
    let exponent = (off(&quick) / off(&slow)).ln() / 100.0_f64.ln();
    near(exponent, 0.8, 0.08);
    near(off(&slow), 0.0, 3e-4);
    let after = &slow.slips[0].after;
    // On the straight line on which contacts of stiffness 1 unload; rounding, and the share of them that is lost count.
    near(after.force, after.spring_force, 1e-12);
    assert!(slow.slips[0].position_turn > after.position + 0.2);
}

#[test]
fn breaks_lose_what_they_do_in_the_athermal_block() {
    let relaxed = point(0.0);
    let population = master(&gaussian(1.0, 0.1), &relaxed, &relaxed).population_with(1e-10, &mut ()).unwrap();
    let drive = Drive { turning_points: vec![2.0], points: 2 };
    // Lingering, as above, times forces below 1.
    for (slip, velocity, accuracy) in [(Slip::Damped { damping: 1e-3 }, 1e-4, 2e-5), (UNDAMPED, 1e-5, 3e-4)] {
        let athermal = block(1.0, slip).pull(&mut population.clone(), &drive).unwrap();
        let run = first_slip(slip, velocity, 1e-5);
        near(run.energy.breaks, athermal.energy.breaks, accuracy);
    }
}

#[test]
fn steps_are_of_second_order() {
    // The error of a step goes with its third power, that of a slip with the second: with the tolerance to the power 2/3,
    // within a tenth, as steps change by factors.
    let turn = |tolerance| first_slip(UNDAMPED, 1e-4, tolerance).slips[0].position_turn;
    let [rough, fine, finest] = [1e-3, 1e-4, 1e-6].map(turn);
    let gain = (rough - finest).abs() / (fine - finest).abs();
    near(gain.log10(), 2.0 / 3.0, 0.1);
}

#[test]
fn steady_sliding_is_unstable_below_the_critical_stiffness_of_its_response() {
    let fresh = ageing((0.5, 0.1), Ageing::FrozenRank { mature: gaussian(1.0, 0.2), time: 1.0 });
    for (contacts, velocity) in [(logarithmic(), 1e-3), (fresh, 0.7)] {
        let response = DynamicStiffness::new(&contacts, velocity).unwrap();
        let critical = response.critical_stiffness(Slider::default(), &mut ()).unwrap().unwrap().0;
        let regime = |stiffness: f64| {
            let mut sliding = Transport::steady_with(&contacts, velocity, 1e-4, &mut ()).unwrap();
            // A stop of no length: the block starts at rest, which is the deviation that grows or decays.
            sliding.step(0.0, 1e-9 / velocity, &mut ()).unwrap();
            // A viscous force of a thousandth shifts K_c by next to nothing.
            let slip = Slip::Damped { damping: 1e-3 / velocity };
            let drive = steady(velocity, 200.0);
            block(stiffness, slip).follow_with(&sliding, &drive, &[], 1e-3, &mut ()).unwrap().regime
        };
        let (below, above) = (regime(0.8 * critical), regime(1.2 * critical));
        assert!(matches!(below, Regime::Persistent { .. }), "{below}");
        assert!(matches!(above, Regime::Smooth { .. }), "{above}");
    }
}

/// In steady sliding behind a spring stiffer than K_c nothing changes, whatever the tolerance.
#[test]
fn a_steady_start_is_kept_to_any_tolerance() {
    let (contacts, velocity) = (logarithmic(), 0.01);
    for stiffness in [1.0, 3.0] {
        for tolerance in [1e-5, 1e-6, 1e-8] {
            let sliding = Transport::steady_with(&contacts, velocity, tolerance, &mut ()).unwrap();
            let drive = steady(velocity, 0.5);
            let run = block(stiffness, Slip::Reset)
                .follow_with(&sliding, &drive, &times(&drive, 5), Block::step_for(tolerance), &mut ())
                .unwrap();
            let first = &run.trace[0];
            for moment in &run.trace {
                let slid = moment.position - first.position - velocity * moment.time;
                assert!(slid.abs() < tolerance, "{stiffness} {tolerance:e}: {slid:e}");
                assert!(
                    (moment.force - first.force).abs() < tolerance,
                    "{stiffness} {tolerance:e} {moment:?}"
                );
            }
        }
    }
}

/// The way of the slider's bottom.
fn way(run: &Slide) -> History {
    let pieces = run.trace.windows(2).map(|pair| {
        let duration = pair[1].time - pair[0].time;
        Piece { velocity: ((pair[1].position - pair[0].position) / duration).max(0.0), duration }
    });
    History::new(pieces.collect()).unwrap()
}

#[test]
fn the_ensemble_moved_alike_feels_the_same_force() {
    let times: SharedLaw = gamma(4.0, 2.0);
    let rules = Rules {
        delay: times.into(),
        free_friction: FreeFriction { force: 0.1, viscosity: 0.05 },
        ..Rules::default()
    };
    let free = Contacts { rules, ..contacts(&gaussian(1.0, 0.2), &point(0.0)) };
    // So much damped that it does not swing back, γ² > 4M(K + N⟨k⟩): histories go forward only.
    let inertial = Slip::Inertial { mass: 0.01, damping: 0.5 };
    feels_the_same_force(&logarithmic(), Slip::Damped { damping: 0.1 }, 400, 30_000);
    // Contacts form again after a time, not after a way: more moments follow the slider as it becomes faster before a slip.
    feels_the_same_force(&free, inertial, 1600, 20_000);
}

/// The motion of a block over cohorts, known at so many moments and at every step of a slip, imposed on contacts one by one.
fn feels_the_same_force(contacts: &Contacts, slip: Slip, moments: u32, size: usize) {
    let relaxed = initial(&point(0.0));
    let transport = Transport::new_with(contacts.clone(), &relaxed, 1e-5, &mut ()).unwrap();
    let drive = steady(1e-2, 12.0);
    let run =
        block(0.2, slip).follow_with(&transport, &drive, &times(&drive, moments), 1e-4, &mut ()).unwrap();
    assert!(!run.slips.is_empty());
    assert!(run.trace.is_sorted_by_key(|moment| moment.position));
    let history = way(&run);
    let ensemble = Ensemble::new(contacts.clone(), relaxed, size, 7, Disorder::Annealed).unwrap();
    let times: Vec<f64> = (1..=40).map(|i| f64::from(i) / 40.0 * history.duration()).collect();
    let followed = ensemble.follow(&history, &times).unwrap();
    for (i, &time) in times.iter().enumerate() {
        let next = run.trace.partition_point(|moment| moment.time < time * (1.0 - 1e-12));
        let (force, error) = (run.trace[next].force, followed.error[i]);
        // The tolerance of transport is larger where no contact has broken yet.
        let off = (followed.force[i] - force).abs();
        assert!(off < 4.0 * error + 1e-5, "{slip:?}, {time}: {off} {error}");
    }
}

#[test]
fn over_contacts_without_time_damped_is_overdamped() {
    let relaxed = point(0.0);
    let population = master(&gaussian(1.0, 0.1), &relaxed, &relaxed).population_with(1e-10, &mut ()).unwrap();
    let drive = Drive { turning_points: vec![10.0], points: 11 };
    let run = |slip| block(1.0, slip).pull(&mut population.clone(), &drive).unwrap();
    assert_eq!(run(Slip::Damped { damping: 0.3 }), run(Slip::Overdamped));
}

#[test]
fn a_drive_at_rest_ages_a_block_at_rest() {
    let drive = History::new(vec![
        Piece { velocity: 0.0, duration: 10.0 },
        Piece { velocity: 0.1, duration: 3.0 },
        Piece { velocity: 0.0, duration: 1e4 },
    ]);
    let transport = Transport::new_with(logarithmic(), &initial(&point(0.0)), 1e-5, &mut ()).unwrap();
    let slip = Slip::Inertial { mass: 1e-4, damping: 0.1 };
    let run =
        block(1.0, slip).follow_with(&transport, &drive.unwrap(), &[5.0, 13.0, 1e4], 1e-4, &mut ()).unwrap();
    assert_eq!(run.slips, []);
    let forces: Vec<f64> = run.trace.iter().map(|moment| moment.force).collect();
    // Nothing that holds lets go at rest; the spring, which lagged by γ × velocity, finds its balance.
    near(forces[0], 0.0, 1e-15);
    near(forces[2], forces[1], 0.1 * 0.1);
    near(forces[2], run.trace[2].spring_force, 1e-4);
}

#[test]
fn what_limits_no_velocity_is_refused() {
    let transport = Transport::new_with(athermal(), &initial(&point(0.0)), 1e-3, &mut ()).unwrap();
    let drive = steady(1.0, 1.0);
    let key = |result: Result<Slide>| match result {
        Err(Error::Invalid { key, .. }) => key,
        other => panic!("{other:?}"),
    };
    for slip in [Slip::Overdamped, Slip::Arrest] {
        assert_eq!(key(block(1.0, slip).follow_with(&transport, &drive, &[], 1e-3, &mut ())), "slip");
    }
    // In balance until X_T = 1.67, where the slider slips.
    assert!(block(1.0, Slip::Reset).follow_with(&transport, &drive, &[], 1e-3, &mut ()).is_ok());
    assert_eq!(
        key(block(1.0, Slip::Reset).follow_with(&transport, &steady(1.0, 2.0), &[], 1e-3, &mut ())),
        "slip"
    );
    let rigid = Block::new(Loading::Rigid, UNDAMPED, None).unwrap();
    assert_eq!(key(rigid.follow_with(&transport, &drive, &[], 1e-3, &mut ())), "stiffness");
    let good = block(1.0, UNDAMPED);
    assert_eq!(key(good.follow_with(&transport, &drive, &[1.5], 1e-3, &mut ())), "times");
    assert_eq!(key(good.follow_with(&transport, &drive, &[], 0.0, &mut ())), "tolerance");
}

#[test]
fn the_default_tolerance_is_relative_to_the_mean_threshold() {
    let contacts = ageing((3.0, 0.3), Ageing::Logarithmic { growth: 0.02, time: 1.0 });
    let transport = Transport::new(contacts.clone(), &initial(&point(0.0))).unwrap();
    let ensemble = Ensemble::new(contacts, initial(&point(0.0)), 200, 1, Disorder::Annealed).unwrap();
    let drive = steady(0.1, 6.0);
    let block = block(0.5, Slip::Damped { damping: 0.1 });
    let tolerance = 3.0 * Block::TOLERANCE_IN_TIME;
    let followed = block.follow(&transport, &drive, &[60.0]).unwrap();
    assert_eq!(followed, block.follow_with(&transport, &drive, &[60.0], tolerance, &mut ()).unwrap());
    assert_ne!(followed, block.follow_with(&transport, &drive, &[60.0], 0.5 * tolerance, &mut ()).unwrap());
    let drawn = ensemble.in_time().unwrap();
    let run = block.follow(&drawn, &drive, &[60.0]).unwrap();
    assert_eq!(run, block.follow_with(&drawn, &drive, &[60.0], tolerance, &mut ()).unwrap());
    let mut motion = [block.motion(&transport), block.motion_with(&transport, tolerance)].map(Result::unwrap);
    for slider in &mut motion {
        slider.next(6.0, 0.1).unwrap();
    }
    assert_eq!(motion[0].moment(), motion[1].moment());
    // Athermal contacts in time do not know their thresholds.
    let population = MasterEquation::new(athermal(), &initial(&point(0.0))).unwrap().population().unwrap();
    let unknown = PopulationInTime::new(Box::new(population), 1.0);
    let refused = block.follow(&unknown, &drive, &[]);
    assert!(matches!(refused, Err(Error::Invalid { key, .. }) if key == "tolerance"));
}
