//! The block where friction has kinks or jumps, where the drive turns, and in the limits K = ∞ and K → 0.

use crate::common::curve;
use crate::common::pulled::{UNDAMPED, drive, near, pull};
use asperity::block::{Curve, End, Loading, Regime, Slip, StickSlip, critical_stiffness};
use asperity::exact::{ClosedForm, Gaussian};

/// Rounding of positions near 1 in a root.
const ROUNDING: f64 = 1e-14;

#[test]
fn at_a_kink_stability_is_lost_at_once() {
    // On [0.9, 1.1] F' = 1 − X/0.2: from −3.5 just after the kink to −4.5.
    let first = |stiffness: f64| pull(&mut curve::rectangular(0.9, 1.1), stiffness, Slip::Overdamped, &[2.5]);
    let soft = first(1.0).events[0];
    near(soft.before.position, 0.9, ROUNDING);
    near(soft.before.force, 0.9, ROUNDING);
    // F = X − 1 on [1.1, 1.8], and X + F = 1.8.
    near(soft.after.position, 1.4, ROUNDING);
    // Between the kinks where 1 − X/0.2 = −K.
    near(first(4.0).events[0].before.position, 1.0, 1e-13);
    assert!(first(4.5).events.is_empty());
    near(critical_stiffness(&curve::rectangular(0.9, 1.1), 3.0, &mut ()).unwrap(), 4.5, ROUNDING);
}

#[test]
fn a_swing_crosses_kinks_exactly() {
    let swung = pull(&mut curve::rectangular(0.9, 1.1), 1.0, UNDAMPED, &[1.9]).events[0];
    // ∫(1.8 − X − F): over [0.9, 1.1] of 1.8 − 2X − (0.81 − X²)/0.4, then of 2.8 − 2X up to X = 1.8.
    let area = |x: f64| 1.8 * x - x * x - (0.81 * x - x.powi(3) / 3.0) / 0.4;
    let gained = area(1.1) - area(0.9);
    // (X − 1.4)² = gained + (1.1 − 1.4)².
    near(swung.position_turn, 1.4 + (gained + 0.09_f64).sqrt(), 1e-12);
}

#[test]
fn identical_contacts_break_together() {
    // They break at X = F = 1, X_T = 1 + 1/K.
    let slips = |stiffness: f64, slip: Slip| pull(&mut curve::identical(), stiffness, slip, &[3.4]).events;
    let overdamped = slips(1.0, Slip::Overdamped);
    // X_T − X = X − 1 at X_T = 2, and so again at each whole X.
    for (n, event) in overdamped.iter().enumerate() {
        let n = n as f64;
        near(event.before.position, 1.0 + n, ROUNDING);
        near(event.before.force, 1.0, ROUNDING);
        near(event.after.position, 1.5 + n, ROUNDING);
        near(event.broken_fraction, 1.0, 0.0);
        near(event.energy.breaks, 0.5, ROUNDING);
        near(event.energy.slip, 0.25, ROUNDING);
    }
    assert_eq!(overdamped.len(), 2);
    // Free contacts carry nothing: on to X_T. There they re-form, as after a reset.
    for slip in [Slip::Arrest, Slip::Reset] {
        let first = slips(1.0, slip)[0];
        near(first.after.position, 2.0, ROUNDING);
        near(first.after.force, 0.0, ROUNDING);
        near(first.broken_fraction, 1.0, 0.0);
        near(first.energy.slip, 0.5, ROUNDING);
    }
    // K = 2: MẌ = 4 − 3X from X = 1 at rest, about 4/3.
    let swung = slips(2.0, UNDAMPED)[0];
    near(swung.position_turn, 5.0 / 3.0, ROUNDING);
    near(swung.after.position, 4.0 / 3.0, ROUNDING);
    assert_eq!(critical_stiffness(&curve::identical(), 2.0, &mut ()).unwrap(), f64::INFINITY);
}

#[test]
fn backward_motion_is_the_mirror_image() {
    let mirrored = |run: &StickSlip| {
        let points = run.trace.iter().map(|p| [-p.drive, -p.position, -p.force, -p.spring_force]);
        points.collect::<Vec<_>>()
    };
    for slip in [Slip::Reset, Slip::Overdamped, UNDAMPED] {
        let forth = pull(&mut curve::gaussian(0.1), 1.0, slip, &[8.0]);
        let back = pull(&mut curve::gaussian(0.1), 1.0, slip, &[-8.0]);
        let points = forth.trace.iter().map(|p| [p.drive, p.position, p.force, p.spring_force]);
        // The curve itself begins 1e-23 away from 0.
        assert!(points.zip(mirrored(&back)).all(|(a, b)| (0..4).all(|i| (a[i] - b[i]).abs() < 1e-12)));
        assert_eq!(forth.events.len(), back.events.len());
    }
}

#[test]
fn turning_back_retraces_the_unloading_line() {
    let loop_of = |turns: &[f64]| pull(&mut curve::gaussian(0.1), 1.0, Slip::Overdamped, turns);
    let run = loop_of(&[1.2, 0.4, 1.2, 0.4]);
    assert!(run.events.is_empty());
    // X_T = X + F with F = X: half the drive each.
    assert!(run.trace.iter().all(|p| (p.force - 0.5 * p.drive).abs() < 1e-4));
    let ends: Vec<_> = run.trace.iter().filter(|p| p.drive == 0.4).map(|p| p.position).collect();
    near(ends[1], *ends.last().unwrap(), 1e-14);
    near(run.energy.imbalance(), 0.0, 1e-14);
}

#[test]
fn the_softer_the_block_the_nearer_the_first_slip_is_to_static_friction() {
    let (_, highest) = Gaussian::new(1.0, 0.1).static_friction().unwrap();
    let missing = |stiffness: f64| {
        highest
            - pull(&mut curve::gaussian(0.1), stiffness, Slip::Reset, &[1.2 / stiffness]).events[0]
                .before
                .force
    };
    // F_1 = F_s − K²/(2|F''|), to first order in K.
    let (soft, softer) = (missing(1e-2), missing(1e-3));
    near(soft / softer, 100.0, 1.0);
}

#[test]
fn an_imposed_force_creeps_up_to_static_friction_and_runs_away() {
    let form = Gaussian::new(1.0, 0.1);
    let (place, highest) = form.static_friction().unwrap();
    // How much more than the contacts can carry is imposed in the end does not matter.
    let slips = [Slip::Overdamped, UNDAMPED, Slip::Reset].into_iter().flat_map(|s| [(s, 1.0), (s, 1e9)]);
    for (slip, end) in slips {
        let run = drive(&mut curve::gaussian(0.1), Loading::Force, slip, &[end]);
        let End::Runaway(from) = run.end else { panic!("{:?}", run.end) };
        near(from.force, highest, 1e-13);
        near(from.position, place, 1e-11);
        assert_eq!(run.regime, Regime::Runaway);
    }
    let below = drive(&mut curve::gaussian(0.1), Loading::Force, Slip::Overdamped, &[0.7]);
    let last = below.trace.last().unwrap();
    assert_eq!(below.end, End::Reached);
    near(form.force(last.position), 0.7, ROUNDING);
    near(last.spring_force, 0.7, 0.0);
}

#[test]
fn a_rigid_slider_draws_the_friction_curve() {
    let run = drive(&mut curve::gaussian(0.1), Loading::Rigid, Slip::Overdamped, &[5.0]);
    let form = Gaussian::new(1.0, 0.1);
    assert!(
        run.trace.iter().all(|p| p.position == p.drive && (p.force - form.force(p.position)).abs() < 1e-13)
    );
    assert_eq!(run.trace.len(), 101);
    assert!(matches!(run.regime, Regime::Smooth { .. }), "{}", run.regime);
    let jumps = drive(&mut curve::identical(), Loading::Rigid, Slip::Overdamped, &[2.5]);
    let at_one: Vec<_> = jumps.trace.iter().filter(|p| p.position == 1.0).map(|p| p.force.round()).collect();
    assert!(at_one.contains(&1.0) && at_one.contains(&0.0), "{at_one:?}");
    assert!(jumps.events.is_empty());
}

#[test]
fn curves_show_equilibria_and_the_potential() {
    let (stiffness, form) = (1.0, Gaussian::new(1.0, 0.1));
    let curve = Curve::new(&curve::gaussian(0.1), 2.0, 401, &mut ()).unwrap();
    assert_eq!(curve.position.len(), 401);
    let drives = curve.drive(stiffness);
    for (i, (&x, stable)) in curve.position.iter().zip(curve.stable(stiffness)).enumerate() {
        near(drives[i], x + form.force(x), 1e-13);
        assert_eq!(stable, form.slope(x) > -stiffness);
    }
    // dV/dX = F − K(X_T − X): differences over 0.01, at the point between.
    let potential = curve.potential(stiffness, 1.6);
    for i in 1..400 {
        let x = curve.position[i];
        let slope = (potential[i + 1] - potential[i - 1]) / (curve.position[i + 1] - curve.position[i - 1]);
        // Third derivatives of some 1/σ² over 6, times 0.005².
        near(slope, form.force(x) - stiffness * (1.6 - x), 2e-3);
    }
    // Both ends are there, whatever the rounding of positions between them.
    for (length, points) in [(1.7, 201), (0.7, 101), (3.3, 1001)] {
        let curve = Curve::new(&curve::gaussian(0.1), length, points, &mut ()).unwrap();
        assert_eq!((curve.position.len(), curve.position.last().copied()), (points, Some(length)));
    }
    let jumps = Curve::new(&curve::identical(), 2.5, 6, &mut ()).unwrap();
    let at_one: Vec<_> = (0..jumps.position.len()).filter(|&i| jumps.position[i] == 1.0).collect();
    near(jumps.force[at_one[0]], 1.0, 0.0_f64.max(f64::EPSILON));
    near(jumps.force[*at_one.last().unwrap()], 0.0, 0.0);
}
