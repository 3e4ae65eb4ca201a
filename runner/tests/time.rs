//! Motion in time computed: curves against velocity and hold time, protocols, and what is said of them.

use std::path::Path;

use asperity::task::summary::Numbers;
use asperity_runner::input;
use asperity_runner::output::{self, Outcome};

fn parsed(text: &str) -> input::Input {
    input::parse(text, "test", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"))
}

fn run(text: &str) -> Outcome {
    asperity_runner::run(&parsed(text).scenario, &mut ()).unwrap()
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} for {expected}");
}

const GROWING: &str = "
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.ageing.logarithmic = { growth = 0.02, time = 1.0 }
";
const THERMAL: &str = "
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.temperature = { energy = 1.0, attempt_rate = 1.0 }
";

#[test]
fn kinetic_friction_along_velocities_is_that_of_the_theory() {
    let outcome = run(&format!("{GROWING} velocity_curve = {{ from = 1e-6, to = 1.0, points = 4 }}"));
    let friction = outcome.record.values("kinetic_friction").unwrap();
    // digits of the reference values
    for (found, expected) in friction.iter().zip([0.6472942007, 0.6000169155, 0.5527655886, 0.5122109494]) {
        near(*found, expected, 1e-9);
    }
    near(outcome.summary.numbers.limits()[0].fast, 0.505, 1e-9);
    assert_eq!(
        (outcome.summary.numbers.limits()[0].slow, outcome.summary.numbers.limits()[0].viscosity),
        (None, None)
    );
    assert_eq!(outcome.summary.numbers.friction(), None);
}

#[test]
fn each_temperature_has_its_curve_and_its_ensemble() {
    let text = format!(
        "{THERMAL} velocity_curve = {{ from = 1e-2, to = 1.0, points = 3, temperatures = [0.05, 0.2] }}
         ensemble = {{ size = 20000 }}"
    );
    let outcome = run(&text);
    let column = |name| outcome.record.values(name).unwrap();
    assert_eq!(outcome.record.get("kinetic_friction").unwrap().dimensions, ["temperature", "velocity"]);
    // The default tolerance of lives with temperature, below which the digits printed are.
    near(column("kinetic_friction")[0], 0.44526255210, 1e-9);
    for (i, force) in column("ensemble_force").iter().enumerate() {
        // within 5 standard errors, six times: by chance once in 300000
        near(*force, column("kinetic_friction")[i], 5.0 * column("ensemble_error")[i]);
    }
    let (_base, dir) = folder();
    output::write(&dir, &outcome, &[]).unwrap();
    let table = std::fs::read_to_string(dir.join("velocity_curve.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("temperature,velocity,kinetic_friction,ensemble_force,ensemble_error"));
    assert_eq!(lines.filter(|line| line.starts_with("0.2,")).count(), 3);
    assert_eq!(output::read(&dir).unwrap().summary, outcome.summary);
}

fn folder() -> (tempfile::TempDir, std::path::PathBuf) {
    let base = tempfile::tempdir().unwrap();
    let dir = base.path().join("run");
    (base, dir)
}

#[test]
fn slow_thermal_contacts_flow_as_their_closed_forms_say() {
    let text = |range: &str| {
        format!(
            "contacts.thresholds.point = {{ at = 1.0 }}
             contacts.temperature = {{ energy = 0.025, attempt_rate = 1.0 }}
             velocity_curve = {{ {range}, points = 2 }}"
        )
    };
    let column = |outcome: &Outcome, name: &str| outcome.record.values(name).unwrap().to_vec();
    let creep = run(&text("from = 1e-6, to = 1e-4"));
    // one threshold, E_0/T = 20; the closed form leaves out (T/kx_b²) of the barrier, 5 % of it at these velocities
    near(column(&creep, "kinetic_friction")[0], 0.3330145881, 1e-9);
    for (found, expected) in column(&creep, "creep_friction").iter().zip(column(&creep, "kinetic_friction")) {
        near(*found, expected, 0.05 * expected);
    }
    let flow = run(&text("from = 1e-14, to = 1e-13"));
    // corrections are of the order of (v/ω_0)²kT^-1, 1e-8 here
    for (found, expected) in column(&flow, "viscous_friction").iter().zip(column(&flow, "kinetic_friction")) {
        near(*found / expected, 1.0, 1e-6);
    }
    near(flow.summary.numbers.limits()[0].viscosity.unwrap(), 20f64.exp(), 1e-6 * 20f64.exp());
}

#[test]
fn a_delay_frees_contacts_and_friction_ends() {
    let contacts = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\ncontacts.delay.time = 0.5\n";
    let outcome = run(&format!("{contacts} velocity_curve = {{ from = 0.02, to = 2.0, points = 3 }}"));
    for (force, velocity) in outcome.record.values("kinetic_friction").unwrap().iter().zip([0.02, 0.2, 2.0]) {
        // The default tolerance is 1e-10.
        near(*force, 0.505 / (1.0 + 0.5 * velocity), 1e-9);
    }
    let limits = outcome.summary.numbers.limits()[0];
    assert_eq!(limits.fast, 0.0);
    near(limits.slow.unwrap(), 0.505, 1e-9);
    let held = run(&format!(
        "{contacts}
         [[protocol]]
         velocity = 1.0
         distance = 5.0
         [[protocol]]
         hold = 1.0
         points = 11"
    ));
    let free = held.record.values("free").unwrap();
    assert!(free.iter().any(|free| *free > 0.5), "contacts that broke in step are free together");
    // Of contacts that are free none is left but what the tolerance allows.
    near(free[210], 0.0, 1e-9);
}

#[test]
fn a_protocol_is_reported_step_by_step_and_both_solvers_agree() {
    let outcome = run(&format!(
        "{GROWING}
         [[protocol]]
         velocity = 1.0
         distance = 3.0
         points = 31
         [[protocol]]
         hold = 10.0
         points = 3
         [[protocol]]
         velocity = 1.0
         velocity_to = 2.0
         duration = 1.0
         points = 11
         pieces = 8
         [ensemble]
         size = 20000"
    ));
    let column = |name| outcome.record.values(name).unwrap();
    assert_eq!(column("time").len(), 31 + 2 + 10);
    near(column("position")[42], 4.5, 1e-12);
    for i in 0..43 {
        // within 6 standard errors at some 40 places: by chance less than once in a million; and two contacts of 20000,
        // for there is no scatter before the first has broken
        near(column("ensemble_force")[i], column("force")[i], 6.0 * column("ensemble_error")[i] + 1e-4);
    }
    let steps = &outcome.summary.numbers.steps();
    assert_eq!(steps.iter().map(|s| s.velocity).collect::<Vec<_>>(), [1.0, 0.0, 2.0]);
    assert_eq!(steps.iter().map(|s| s.pieces).collect::<Vec<_>>(), [None, None, Some(8)]);
    near(steps[0].kinetic_friction.unwrap(), 0.5122109494, 1e-9);
    assert_eq!((steps[1].kinetic_friction, steps[2].kinetic_friction), (None, None));
    let (_base, dir) = folder();
    output::write(&dir, &outcome, &[]).unwrap();
    let table = std::fs::read_to_string(dir.join("trace.csv")).unwrap();
    let header = "drive,position,force,spring_force,time,velocity,ensemble_force,ensemble_error";
    assert_eq!(table.lines().next(), Some(header));
    assert!(!dir.join("events.csv").exists() && !dir.join("force.csv").exists());
    assert_eq!(output::read(&dir).unwrap(), outcome);
}

/// Numbers of the steps from 0.01 to 0.1 and back, at 12, 201 and 5001 points per step: maxima, a, b, D_c and residuals.
fn numbers_of_steps(contacts: &str) -> [Vec<[f64; 5]>; 3] {
    [12, 201, 5001].map(|points| {
        let step = |velocity: f64| {
            format!("[[protocol]]\nvelocity = {velocity}\ndistance = 10.0\npoints = {points}\n")
        };
        let outcome = run(&format!("{contacts}\n{}{}{}", step(0.01), step(0.1), step(0.01)));
        assert_eq!(outcome.record.values("force").unwrap().len(), 1 + 3 * (points - 1));
        let number = |step: &asperity::task::summary::ProtocolStep| {
            let read = step.rate_state.as_ref().unwrap();
            [step.peak.force, read.a, read.b, read.distance, read.residual_relative]
        };
        outcome.summary.numbers.steps()[1..].iter().map(number).collect()
    })
}

#[test]
fn maxima_and_rate_and_state_numbers_do_not_depend_on_the_points_of_the_trace() {
    let broad = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.25 }
                 contacts.ageing.logarithmic = { growth = 0.04, time = 1.0 }";
    let thermal = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.25 }
                   contacts.temperature = { energy = 0.05, attempt_rate = 1.0 }";
    for contacts in [broad, thermal] {
        let [few, usual, many] = numbers_of_steps(contacts);
        for (step, reference) in many.iter().enumerate() {
            for found in [few[step], usual[step]] {
                // The force has a curvature of some units near its maximum, found by a parabola through points 1/200 apart: the
                // third derivative leaves some 1e-7.
                near(found[0], reference[0], 1e-6);
                // Trapezoids between other points change what is fitted by some 1e-4 of the forces a + b.
                let size = 1e-3 * (reference[1].abs() + reference[2].abs());
                near(found[1], reference[1], size);
                near(found[2], reference[2], size);
                near(found[3], reference[3], 1e-2 * reference[3]);
                near(found[4], reference[4], 1e-2 * reference[4]);
            }
        }
    }
}

/// Contacts with ageing and delays, whose force depends on how the velocity changes.
const RAMPED: &str = "
[contacts]
thresholds.gaussian = { mean = 1.2, std = 0.25 }
stiffness_per_threshold = 1.4
count = 5.0
ageing.frozen_rank = { mature.gaussian = { mean = 0.8, std = 0.1 }, time = 4.0 }
delay.rectangular = { min = 0.5, max = 2.0 }
";

/// Forces along a ramp of contacts with ageing, delays and friction of free contacts, by sums over what forms in each step along
/// X = 0.05 t + 0.0475 t² (`core/tests/tables/make_ramp.py`, right to 4e-6).
#[test]
fn the_error_of_a_force_along_a_ramp_is_that_of_its_pieces_too() {
    let scenario = |more: &str| {
        format!(
            "{more}
             {RAMPED}
             free_friction = {{ force = 0.2 }}
             [initial]
             point.at = 0.1
             [[protocol]]
             velocity = 0.05
             velocity_to = 1.0
             duration = 10.0
             points = 21"
        )
    };
    for (more, pieces, largest) in [("", 64, 2e-3), ("master_equation.tolerance = 1e-5", 256, 2e-4)] {
        let outcome = run(&scenario(more));
        let Numbers::Protocol(numbers) = &outcome.summary.numbers else { panic!("a protocol") };
        assert!(numbers.force_error < largest, "{}", numbers.force_error);
        assert_eq!((numbers.steps[0].pieces, numbers.steps[0].velocity_from), (Some(pieces), Some(0.05)));
        let [position, force] = ["position", "force"].map(|name| outcome.record.values(name).unwrap());
        for (t, expected) in
            [(1.5, 2.120955), (3.0, 4.656160), (4.0, 2.426305), (6.0, 4.042700), (8.0, 2.069206)]
        {
            let point = (2.0 * t) as usize;
            near(position[point], 0.05 * t + 0.0475 * t * t, 1e-12);
            near(force[point], expected, numbers.force_error + 4e-6);
        }
    }
}

/// The accuracy that is stated for a block behind a spring, where one is required, covers what more pieces change; a number of pieces
/// that is given and does not suffice is refused.
#[test]
fn the_accuracy_of_a_block_along_a_ramp_is_that_of_its_pieces_too() {
    let scenario = |pieces: &str| {
        format!(
            "master_equation.tolerance = 1e-3
             {RAMPED}
             [initial]
             point.at = 0.1
             [block]
             stiffness = 40.0
             [[protocol]]
             velocity = 0.05
             velocity_to = 1.0
             duration = 6.0
             points = 21
             {pieces}"
        )
    };
    // A block has the forces at the times of the trace alone, since none of its slips has steps of its own.
    let [(usual, error), (finer, _)] = ["", "pieces = 128"].map(|pieces| {
        let outcome = run(&scenario(pieces));
        // Per N_c⟨k⟩ = 5 × 1.4.
        let error = 7.0 * outcome.summary.accuracy.unwrap();
        (outcome.record.values("force").unwrap().to_vec(), error)
    });
    assert_eq!((usual.len(), finer.len()), (21, 21));
    let apart = usual.iter().zip(&finer).map(|(usual, finer)| (usual - finer).abs()).fold(0.0, f64::max);
    // The error is estimated as three times that of the pieces, whose number changes the force by more than 2e-4.
    assert!((2e-4..error).contains(&apart), "{apart} {error}");
    let refused = asperity_runner::run(&parsed(&scenario("pieces = 8")).scenario, &mut ()).unwrap_err();
    assert!(refused.to_string().contains("the force along ramps in pieces"), "{refused}");
}

/// The accuracy that is stated for the cells of an interface, where one is required, covers what more pieces change; too few pieces are
/// refused.
#[test]
fn the_accuracy_of_cells_along_a_ramp_is_that_of_its_pieces_too() {
    let scenario = |pieces: usize| {
        format!(
            "master_equation.tolerance = 3e-3
             [contacts]
             thresholds.gaussian = {{ mean = 1.0, std = 0.1 }}
             ageing.logarithmic = {{ growth = 0.05, time = 0.2 }}
             [interface]
             cells = [3]
             connection = 3.0
             viscosity = 0.3
             slip = 'overdamped'
             coupling.neighbours = {{ stiffness = 1.0 }}
             disorder.scale = [0.9, 1.0, 1.1]
             [[protocol]]
             velocity = 0.2
             velocity_to = 1.0
             duration = 4.0
             points = 9
             pieces = {pieces}"
        )
    };
    let [(usual, error), (finer, better)] = [64, 512].map(|pieces| {
        let outcome = run(&scenario(pieces));
        (outcome.record.values("force").unwrap().to_vec(), outcome.summary.accuracy.unwrap())
    });
    // Of three cells of stiffness 1: the error of their sum is at most three times that of one.
    let apart = usual.iter().zip(&finer).map(|(usual, finer)| (usual - finer).abs()).fold(0.0, f64::max);
    assert!(apart > 2e-4 && apart < 3.0 * error && better < error, "{apart} {error} {better}");
    let refused = asperity_runner::run(&parsed(&scenario(4)).scenario, &mut ()).unwrap_err();
    assert!(refused.to_string().contains("along ramps in pieces of constant velocity"), "{refused}");
}

/// Two velocity steps of a synthetic record: the force before the second one is that after the transient of the first.
#[test]
fn each_velocity_step_of_a_compared_curve_begins_at_the_steady_force_before_it() {
    let (direct, evolution, distance, ratio) = (0.02, 0.03, 0.7, 10f64.ln());
    let response = |x: f64| {
        let evolved = evolution * -(-x / distance).exp_m1();
        if x > 0.0 { ratio * (direct - evolved) } else { 0.0 }
    };
    let positions: Vec<f64> = (0..=300).map(|i| 0.05 * f64::from(i)).collect();
    let noise = |i: usize| 1e-3 * (7.3 * (i * i) as f64).sin();
    let forces: Vec<f64> =
        (0..).zip(&positions).map(|(i, x)| 0.6 + noise(i) + response(x - 5.0) - response(x - 10.0)).collect();
    let outcome = run(&format!(
        "{GROWING}
         protocol = [{{ velocity = 0.1, distance = 5.0 }}, {{ velocity = 1.0, distance = 5.0 }}, {{ velocity = 0.1, distance = 5.0 }}]
         compare = {{ position = {positions:?}, force = {forces:?} }}"
    ));
    let steps = outcome.summary.numbers.steps();
    let before = |step: usize| steps[step].measured.as_ref().unwrap().force_before;
    for (step, expected) in [(1, 0.6), (2, 0.6 + response(5.0))] {
        // Where the half step begins, ln 10 · b e^{−2.5/D_c} = 2e-3 of the first transient is left. The whole step yields 0.5928.
        near(before(step).value, expected, 2e-3);
    }
}

/// F − F₀ and displacements of the load point from −5 to 10 around a step of its velocity from 0.1 to 1, of a slider with
/// rate-and-state friction (a, b, D, ageing law) behind the spring K: V and θ by the classical method of Runge and Kutta.
fn behind_a_spring([a, b, distance, stiffness]: [f64; 4]) -> (Vec<f64>, Vec<f64>) {
    let slope = |[v, theta]: [f64; 2]| {
        let growth = 1.0 - v * theta / distance;
        [(stiffness * (1.0 - v) - b * growth / theta) * v / a, growth]
    };
    let moved = |y: [f64; 2], k: [f64; 2], by: f64| [y[0] + by * k[0], y[1] + by * k[1]];
    let mut y = [0.1, distance / 0.1];
    let (mut positions, mut forces) = (Vec::new(), Vec::new());
    for i in -50..=100 {
        positions.push(0.1 * f64::from(i));
        forces.push(a * (y[0] / 0.1).ln() + b * (0.1 * y[1] / distance).ln());
        // A step of 0.1 takes 0.1 at the velocity 1.
        for _ in 0..if i < 0 { 0 } else { 200 } {
            let by = 0.1 / 200.0;
            let k = slope(y);
            let l = slope(moved(y, k, 0.5 * by));
            let m = slope(moved(y, l, 0.5 * by));
            let n = slope(moved(y, m, by));
            y = std::array::from_fn(|j| y[j] + by * (k[j] + 2.0 * (l[j] + m[j]) + n[j]) / 6.0);
        }
    }
    (positions, forces)
}

const STEP_UP: &str =
    "protocol = [{ velocity = 0.1, distance = 5.0, start = 'steady' }, { velocity = 1.0, distance = 10.0 }]";

#[test]
fn a_compared_velocity_step_is_read_with_the_spring_of_its_machine() {
    let known @ [a, b, distance, stiffness] = [0.01, 0.015, 0.8, 0.05];
    let (position, force) = behind_a_spring(known);
    let position: Vec<f64> = position.iter().map(|x| x + 5.0).collect();
    let force: Vec<f64> = force.iter().map(|f| 0.6 + f).collect();
    let compared = |keys: &str| format!("compare = {{ position = {position:?}, force = {force:?}{keys} }}");
    for (slider, keys) in
        [("", format!(", stiffness = {stiffness}")), ("block.stiffness = 0.05", String::new())]
    {
        let outcome = run(&format!("{GROWING} {slider}\n{STEP_UP}\n{}", compared(&keys)));
        let step = &outcome.summary.numbers.steps()[1];
        assert!(step.measured.is_none() && step.not_read.is_none());
        let read = step.measured_spring.as_ref().unwrap();
        // Both are solved to 1e-8 of a factor e of velocity, of which there are two, times what a fit amplifies.
        assert!(read.residual_relative < 1e-6, "{read:?}");
        for (found, expected) in [(read.a, a), (read.b[0], b), (read.distance[0], distance)] {
            near(found, expected, 1e-4 * expected);
        }
        near(read.force_before, 0.6, 1e-6);
        assert_eq!((read.ratio, read.stiffness), (10.0, stiffness));
        let again = read.forces(&position.iter().map(|x| x - 5.0).collect::<Vec<_>>());
        assert!(force.iter().zip(again).all(|(known, fitted)| (known - fitted).abs() < 1e-7));
        assert_eq!(step.rate_state_spring.is_some(), !slider.is_empty());
        assert_eq!(step.rate_state.is_some(), slider.is_empty());
        let numbers = &outcome.summary.numbers;
        assert_eq!(numbers.compare().unwrap().points, position.len());
        assert_eq!(outcome.record.values("compared_force").unwrap(), force);
    }
    // The other law leaves more.
    let law = |law: &str| {
        let keys = format!(", stiffness = {stiffness}, law = '{law}'");
        let outcome = run(&format!("{GROWING} {STEP_UP}\n{}", compared(&keys)));
        outcome.summary.numbers.steps()[1].measured_spring.as_ref().unwrap().residual
    };
    assert!(law("slip") > 100.0 * law("ageing"));
}

/// The force of the spring of a block, compared with itself.
#[test]
fn a_block_compares_the_force_of_its_spring_against_the_load_point() {
    let scenario = format!("{GROWING} block.stiffness = 2.0\n{STEP_UP}");
    let alone = run(&scenario);
    assert!(alone.summary.numbers.steps().is_empty() && alone.summary.numbers.compare().is_none());
    let [drive, force] = ["drive", "spring_force"].map(|name| alone.record.values(name).unwrap());
    // In steady sliding the spring is stretched at the start.
    let moved: Vec<f64> = drive.iter().map(|x| x - drive[0]).collect();
    assert!(drive[0] > 0.2);
    let curve = format!("compare = {{ position = {moved:?}, force = {force:?}, states = 2, law = 'slip' }}");
    let outcome = run(&format!("{scenario}\n{curve}"));
    let compared = outcome.summary.numbers.compare().unwrap();
    // rounding of positions of the size of 10
    assert!(compared.points + 1 >= drive.len() && compared.residual_rms.unwrap() < 1e-12, "{compared:?}");
    let [first, step] = outcome.summary.numbers.steps() else { panic!("two steps") };
    assert!(first.rate_state_spring.is_none() && first.measured_spring.is_none());
    near(step.position, drive[0] + 5.0, 1e-12);
    assert_eq!(step.force, *force.last().unwrap());
    let (computed, read) = (step.rate_state_spring.as_ref().unwrap(), step.measured_spring.as_ref().unwrap());
    // The fits end once the sum of squares changes by less than 1e-8 of itself.
    near(computed.residual_relative, read.residual_relative, 1e-6);
    assert_eq!((read.b.len(), read.distance.len()), (2, 2));
    // The force of contacts in step oscillates before it settles, which no state variable does: some percent are left.
    assert!(read.residual_relative > 1e-3 && read.residual_relative < 0.2, "{read:?}");
    let (_base, dir) = folder();
    output::write(&dir, &outcome, &[]).unwrap();
    assert_eq!(output::read(&dir).unwrap(), outcome);
}

#[test]
fn a_protocol_at_one_velocity_is_a_pull() {
    let pull = run(&format!("{THERMAL} pull = {{ distance = 2.0, points = 21, velocity = 0.1 }}"));
    let steps = run(&format!(
        "{THERMAL}
         master_equation.tolerance = 1e-8
         [[protocol]]
         velocity = 0.1
         distance = 2.0
         points = 21"
    ));
    let (one, other) = (pull.record.values("force").unwrap(), steps.record.values("force").unwrap());
    for (one, other) in one.iter().zip(other) {
        // the tolerance is that of a step in time, of which there are some hundreds
        near(*other, *one, 1e-6);
    }
}

#[test]
fn what_was_held_longer_heals_more() {
    let outcome =
        run(&format!("{GROWING} hold_curve = {{ from = 1.0, to = 1e4, points = 5, velocity = 0.1 }}"));
    let force = outcome.record.values("static_friction").unwrap();
    assert!(force.is_sorted_by(|a, b| a < b), "{force:?}");
    let curve = outcome.summary.numbers.hold_curve().unwrap();
    // The last decade, at whose beginning contacts are a hundred times older than when they slid.
    let last = force[4] - force[3];
    near(curve.healing_per_decade.unwrap(), last, 0.05 * last);
    // They were about a mean threshold over the velocity old, and age in that time.
    let cutoff = curve.healing_cutoff.unwrap();
    assert!(cutoff > 3.0 && cutoff < 30.0, "{cutoff}");
    assert!(force[0] > curve.kinetic_friction);
    assert!(outcome.summary.warnings.is_empty());
}

#[test]
fn a_hold_where_nothing_knows_time_is_an_outcome_that_is_said() {
    let outcome = run("
        contacts.thresholds.gaussian = { mean = 1.0, std = 0.2 }
        hold_curve = { from = 1.0, to = 100.0, points = 3, velocity = 1.0 }
    ");
    let force = outcome.record.values("static_friction").unwrap();
    let first = force[0];
    for force in force {
        // ten times the tolerance of motion in time
        near(*force, first, 1e-6);
    }
    assert!(outcome.summary.warnings[0].contains("a hold changes nothing"));
}

#[test]
fn a_slip_too_short_to_be_known_is_warned_about() {
    let creep = |duration: f64, tolerance: &str| {
        run(&format!(
            "
            contacts.thresholds.gaussian = {{ mean = 1.0, std = 0.1 }}
            contacts.temperature = {{ energy = 0.03, attempt_rate = 1.0 }}
            creep = {{ forces = [0.4], duration = {duration}, points = 3 }}
            {tolerance}
        "
        ))
    };
    // A slip of 2e-8, which is uncertain by 1e-8 at the default tolerance.
    let warnings = creep(1e-3, "").summary.warnings;
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].starts_with("the slip under F = 0.4 is 1"), "{warnings:?}");
    assert!(warnings[0].contains("a smaller master_equation.tolerance"), "{warnings:?}");
    assert!(creep(1e-3, "master_equation.tolerance = 1e-7").summary.warnings.is_empty());
    assert!(creep(1.0, "").summary.warnings.is_empty());
}

#[test]
fn a_mature_law_weaker_than_the_fresh_is_warned_about() {
    let outcome = run("
        contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
        contacts.ageing.frozen_rank = { mature.gaussian = { mean = 0.5, std = 0.1 }, time = 1.0 }
        velocity_curve = { from = 0.1, to = 1.0, points = 2 }
    ");
    assert!(outcome.summary.warnings[0].contains("weaker"), "{:?}", outcome.summary.warnings);
    let friction = outcome.record.values("kinetic_friction").unwrap();
    assert!(friction[0] < friction[1], "slow contacts are the older and weaker ones");
}

#[test]
fn steps_can_stand_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("steps.csv"), "duration,velocity,points\n3.0,1.0,31\n10,0,3\n")
        .unwrap();
    let text = format!("protocol_file = 'steps.csv'\n{GROWING}");
    let input = input::parse(&text, "test", folder.path(), &[]).unwrap_or_else(|e| panic!("{e}"));
    let outcome = asperity_runner::run(&input.scenario, &mut ()).unwrap();
    assert_eq!(outcome.record.values("time").unwrap().len(), 33);
    assert_eq!(run(&outcome.scenario), outcome, "the resolved scenario holds the steps themselves");
}

#[test]
fn a_block_over_ageing_contacts_sticks_and_slips_for_ever() {
    let text = format!(
        "{GROWING} block = {{ stiffness = 0.05, slip.damped = {{ damping = 0.1 }} }}
         protocol = [{{ velocity = 1e-3, distance = 60.0 }}]"
    );
    let outcome = run(&text);
    let sliding = outcome.summary.numbers.sliding().unwrap();
    assert!(sliding.period.unwrap() > 1.0 && sliding.mean_drop.unwrap() > 0.05, "{}", sliding.reason);
    let column = |name: &str| outcome.record.values(&format!("event_{name}")).unwrap();
    for (i, drop) in column("drop").iter().enumerate() {
        // Equally fast at both ends, the slider loses what the spring loses, whose top goes on in the slip.
        let shorter = column("slip")[i] - 1e-3 * column("duration")[i];
        // The tolerance of steps.
        near(*drop, 0.05 * shorter, 1e-4);
    }
    let (_base, dir) = folder();
    output::write(&dir, &outcome, &[]).unwrap();
    let table = std::fs::read_to_string(dir.join("events.csv")).unwrap();
    assert_eq!(
        table.lines().next(),
        Some(
            "event,drive,position_before,position_after,position_turn,force_before,force_after,drop,slip,broken_fraction,dissipated_breaks,dissipated_slip,time,duration,velocity"
        )
    );
    assert_eq!(table.lines().count(), sliding.slips + 1);
}

#[test]
fn ageing_makes_steady_sliding_unstable_behind_soft_springs() {
    let outcome = run(&format!(
        "{GROWING} velocity_curve = {{ from = 1e-2, to = 1e-1, points = 2, stability = true }}"
    ));
    let column = |name: &str| outcome.record.values(name).unwrap();
    let (pulled, sliding) = (column("critical_stiffness"), column("critical_stiffness_sliding"));
    // The first pull falls steeply, as all contacts are in step; to athermal contacts K_c is 3.009, 0 in steady sliding.
    assert!(pulled.iter().all(|stiffness| (stiffness / 3.009 - 1.0).abs() < 0.2), "{pulled:?}");
    assert!(sliding.iter().all(|stiffness| (1e-3..0.2).contains(stiffness)), "{sliding:?}");
    let (_base, dir) = folder();
    output::write(&dir, &outcome, &[]).unwrap();
    let table = std::fs::read_to_string(dir.join("velocity_curve.csv")).unwrap();
    let header = "velocity,kinetic_friction,critical_stiffness,critical_stiffness_sliding";
    assert_eq!(table.lines().next(), Some(header));
}

#[test]
fn points_of_a_curve_are_sampled_by_contacts_of_their_own() {
    let text = format!(
        "{THERMAL} velocity_curve = {{ from = 1e-2, to = 1.0, points = 2, temperatures = [0.05, 0.05] }}
         ensemble = {{ size = 1000 }}"
    );
    let outcome = run(&text);
    let column = |name| outcome.record.values(name).unwrap();
    let (force, error) = (column("ensemble_force"), column("ensemble_error"));
    for i in 0..2 {
        // the same point twice: within 5 standard errors of a difference, by chance twice in a million
        assert!(force[i] != force[i + 2]);
        near(force[i], force[i + 2], 5.0 * error[i].hypot(error[i + 2]));
    }
}

const BLOCK: &str = "block = { stiffness = 0.3, slip.damped = { damping = 0.1 } }\n";
const STRONG: &str = "
contacts.thresholds.gaussian = { mean = 1.0, std = 0.2 }
contacts.ageing.logarithmic = { growth = 0.05, time = 1.0 }
";

#[test]
fn a_drive_at_a_velocity_is_a_protocol_of_one_step() {
    let drive = run(&format!("{STRONG}{BLOCK}drive = {{ distance = 5.0, velocity = 1e-2, points = 51 }}"));
    let protocol =
        run(&format!("{STRONG}{BLOCK}protocol = [{{ distance = 5.0, velocity = 1e-2, points = 51 }}]"));
    for name in ["time", "drive", "position", "velocity", "force", "event_drive", "event_dissipated_breaks"] {
        assert_eq!(drive.record.values(name).unwrap(), protocol.record.values(name).unwrap(), "{name}");
    }
    assert_eq!(drive.summary.numbers.sliding(), protocol.summary.numbers.sliding());
    // and of a pull at that velocity, from rest, the peak, which a block of finite stiffness slips beyond
    let friction = drive.summary.numbers.friction().unwrap();
    near(friction.kinetic_friction, 0.6481395, 1e-6);
    assert!(drive.summary.numbers.sliding().unwrap().slips == 2 && drive.record.get("free").is_none());
}

#[test]
fn a_rigid_drive_at_a_velocity_is_a_pull() {
    let rigid = run(&format!("{STRONG}drive = {{ distance = 2.0, velocity = 1e-2, points = 21 }}"));
    let pull = run(&format!("{STRONG}pull = {{ distance = 2.0, velocity = 1e-2, points = 21 }}"));
    let column = |outcome: &Outcome| outcome.record.values("force").unwrap().to_vec();
    for (rigid, pull) in column(&rigid).into_iter().zip(column(&pull)) {
        // the tolerance where velocities might vary
        near(rigid, pull, 1e-6);
    }
    let friction = |outcome: &Outcome| outcome.summary.numbers.friction().cloned().unwrap();
    assert_eq!(friction(&rigid).kinetic_friction, friction(&pull).kinetic_friction);
    assert_eq!(rigid.summary.numbers.sliding(), None);
}

#[test]
fn an_ensemble_slips_beside_its_block() {
    let stiffening = "contacts.stiffness_per_threshold = 1.0\n";
    let rest = "drive = { distance = 6.0, velocity = 1e-2, points = 51 }\nensemble = { size = 300 }\n";
    let outcome = run(&format!("{STRONG}{stiffening}{BLOCK}{rest}"));
    let (_base, dir) = folder();
    output::write(&dir, &outcome, &[]).unwrap();
    for name in ["events.csv", "ensemble_events.csv"] {
        let table = std::fs::read_to_string(dir.join(name)).unwrap();
        let header = table.lines().next().unwrap();
        assert!(header.ends_with("dissipated_breaks,dissipated_slip,time,duration,velocity,strengthening"));
        assert!(table.lines().count() > 1, "{name}");
    }
    assert!(dir.join("ensemble_trace.csv").exists());
    let sliding = outcome.summary.numbers.sliding().unwrap();
    let first = |sliding: &asperity::task::summary::Sliding| sliding.first_instability.unwrap().drive;
    // drives at slips scatter by some N^(-2/3)
    near(first(sliding.ensemble.as_ref().unwrap()), first(sliding), 4.0 * 300.0_f64.powf(-2.0 / 3.0));
}

#[test]
fn a_block_beside_a_velocity_curve_tells_its_stability() {
    let text = |damping: &str| {
        format!(
            "{GROWING} velocity_curve = {{ from = 1e-3, to = 1e-2, points = 2, stability = true }}
             block = {{ stiffness = 0.2, slip.inertial = {{ mass = 1e3{damping} }} }}"
        )
    };
    let [free, damped] = ["", ", damping = 20.0"].map(|damping| run(&text(damping)));
    let column = |outcome: &Outcome, name: &str| outcome.record.values(name).unwrap().to_vec();
    assert_eq!(column(&free, "critical_stiffness_sliding"), [f64::INFINITY; 2]);
    assert!(column(&free, "growth_rate").iter().all(|rate| *rate > 0.0));
    let reported = free.summary.numbers.stability().unwrap();
    assert_eq!((reported.velocities, reported.unstable), (2, Some(2)));
    assert_eq!(reported.critical_stiffness_sliding.0, f64::INFINITY);
    // Damping of more than −dF_k/dv, which is about βF_k/v.
    assert_eq!(column(&damped, "growth_rate"), [0.0; 2]);
    assert_eq!(damped.summary.numbers.stability().unwrap().unstable, Some(0));
    let (_base, dir) = folder();
    output::write(&dir, &free, &[]).unwrap();
    let table = std::fs::read_to_string(dir.join("velocity_curve.csv")).unwrap();
    let header = "velocity,kinetic_friction,critical_stiffness,critical_stiffness_sliding,growth_rate,growth_frequency";
    assert_eq!(table.lines().next(), Some(header));
}

#[test]
fn thresholds_that_all_share_heal_until_they_are_mature() {
    let shared = "
contacts.thresholds.gaussian = { mean = 0.6, std = 0.15 }
contacts.ageing.mean_field = { mature.gaussian = { mean = 1.0, std = 0.2 }, diffusion = 0.04 }
master_equation.tolerance = 1e-4
";
    let outcome =
        run(&format!("{shared} hold_curve = {{ from = 0.1, to = 1e3, points = 5, velocity = 1.0 }}"));
    let peaks = outcome.record.values("static_friction").unwrap();
    assert!(peaks.windows(2).all(|pair| pair[1] > pair[0] - 1e-6), "{peaks:?}");
    assert!(peaks[2] > peaks[0] + 0.05, "{peaks:?}");
    // Thresholds mature at the rate 1: after 100 nothing changes any more, to a hundredth of the tolerance.
    near(peaks[4], peaks[3], 1e-6);
}

#[test]
fn cells_over_thresholds_that_all_share_are_driven_and_kept() {
    let text = "
contacts.thresholds.gaussian = { mean = 0.6, std = 0.15 }
contacts.ageing.mean_field = { mature.gaussian = { mean = 1.0, std = 0.2 }, diffusion = 0.04 }
master_equation.tolerance = 1e-3
interface = { cells = [3], connection = 1.0, coupling.neighbours.stiffness = 1.0, slip = \"overdamped\", viscosity = 1.0 }
drive = { distance = 8.0, velocity = 0.2, points = 81 }
";
    let outcome = run(text);
    let forces = outcome.record.values("force").unwrap();
    let friction = run("
contacts.thresholds.gaussian = { mean = 0.6, std = 0.15 }
contacts.ageing.mean_field = { mature.gaussian = { mean = 1.0, std = 0.2 }, diffusion = 0.04 }
velocity_curve = { from = 0.2, to = 0.4, points = 2 }
");
    let friction = friction.record.values("kinetic_friction").unwrap()[0];
    // Steady sliding in the end: the tolerance, of three cells.
    near(forces[forces.len() - 1], 3.0 * friction, 6e-3);
}

/// Friction at the start is known to the tolerance, 1e-5, so that a force next to it is one at rest; a smaller one is refused.
#[test]
fn a_creep_force_may_be_that_of_friction_at_the_start() {
    let text = |force: f64| {
        format!(
            "contacts.thresholds.gaussian = {{ mean = 1.0, std = 0.1 }}
             contacts.temperature = {{ energy = 0.03, attempt_rate = 1.0 }}
             initial.rectangular = {{ min = 0.2, max = 0.4 }}
             creep = {{ forces = [{force}], duration = 100.0 }}"
        )
    };
    let outcome = run(&text(0.3 - 1e-9));
    // The mean stretch is 0.3: nothing is loaded.
    near(outcome.record.values("loaded_position").unwrap()[0], 0.0, 1e-5);
    let error = asperity_runner::run(&parsed(&text(0.299)).scenario, &mut ()).unwrap_err().to_string();
    assert!(error.contains("creep.forces.0: expected a force of at least 0.3"), "{error}");
}
