//! The error budget: what is reported of the accuracy of each task holds, and what was asked for and is not reached is refused.

use std::path::Path;

use asperity::Error;
use asperity::exact::{self, ClosedForm};
use asperity_runner::input;
use asperity_runner::output::Outcome;

fn computed(text: &str) -> Result<Outcome, Error> {
    let parsed = input::parse(text, "test", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"));
    asperity_runner::run(&parsed.scenario, &mut ())
}

fn run(text: &str) -> Outcome {
    computed(text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn accuracy(outcome: &Outcome) -> f64 {
    outcome.summary.accuracy.expect("a task that solves the master equation reports its accuracy")
}

fn column<'a>(outcome: &'a Outcome, name: &str) -> &'a [f64] {
    outcome.record.values(name).unwrap_or_else(|| panic!("no {name}"))
}

/// Runs without a tolerance, and is refused with one.
#[track_caller]
fn refused(text: &str, tolerance: f64) -> Outcome {
    let required = format!("master_equation.tolerance = {tolerance:e}\n{text}");
    match computed(&required) {
        Err(Error::Accuracy { key, reached, wanted, .. }) => {
            assert_eq!(key, "master_equation.tolerance");
            assert!(wanted.0 == tolerance && reached.0 > tolerance, "{reached:?}");
        }
        other => panic!("{:?}", other.map(|outcome| outcome.summary.accuracy)),
    }
    run(text)
}

/// A pull of identical laws is within its tolerance; the sums over long lives are not.
#[test]
fn velocity_curves_of_broad_thresholds() {
    // F_k = ⟨x_s²⟩/2⟨x_s⟩: (1 + 3²)/2, and Γ(1 + 2/k)/2Γ(1 + 1/k) in 40 digits.
    for (law, exact) in [
        ("gamma = { mean = 1.0, std = 3.0 }", 5.0),
        ("weibull = { shape = 0.3, scale = 1.0 }", 140.033_381_459_538_84),
    ] {
        let text =
            format!("velocity_curve = {{ from = 0.1, to = 1.0, points = 2 }}\ncontacts.thresholds.{law}\n");
        let outcome = refused(&text, 1e-12);
        let off = (column(&outcome, "kinetic_friction")[0] - exact).abs();
        assert!(off <= accuracy(&outcome), "{law}: {off:e} {:e}", accuracy(&outcome));
        // Reported it is to be of use: parts of 1e9 of the force.
        assert!(accuracy(&outcome) < 1e-9 * exact, "{law}: {:e}", accuracy(&outcome));
    }
}

const GAUSSIAN: &str = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\n";

/// Each slip by arrest begins with the stretches that the one before left.
#[test]
fn blocks_that_slip_often() {
    let arrest = format!(
        "{GAUSSIAN}block = {{ stiffness = 0.2, slip = 'arrest' }}\ndrive = {{ distance = 60.0, points = 2 }}\n"
    );
    let outcome = refused(&arrest, 1e-12);
    assert!(accuracy(&outcome) < 1e-9);
    let reset = run(&format!(
        "{GAUSSIAN}block = {{ stiffness = 1.0, slip = 'reset' }}\ndrive = {{ distance = 6.0, points = 2 }}\n"
    ));
    // X_1 + F_1/K, from 40 digits of the closed form; an extremum, so that it is off by the error of F_1 alone.
    let (drive, first) = (0.892_587_804_302_1 + 0.773_610_551_128_0, column(&reset, "event_drive")[0]);
    let digits = 1e-13;
    assert!((first - drive).abs() <= accuracy(&reset) + digits, "{first} {:e}", accuracy(&reset));
}

#[test]
fn interfaces() {
    let cells = |cells: usize, law: &str| {
        format!(
            "contacts.thresholds.{law}\n[interface]\ncells = [{cells}]\ncoupling.neighbours.stiffness = 1.0\nconnection = 5.0\n\
             slip = 'overdamped'\n[drive]\ndistance = 4.0\npoints = 101\n"
        )
    };
    let one = run(&cells(1, "gaussian = { mean = 1.0, std = 0.1 }"));
    let form = exact::Gaussian::new(1.0, 0.1);
    let off = column(&one, "position").iter().zip(column(&one, "force"));
    let off = off.map(|(x, force)| (force - form.force(*x)).abs()).fold(0.0, f64::max);
    // The closed form is of thresholds that are not cut at 0, 10 standard deviations away.
    assert!(off <= accuracy(&one), "{off:e} {:e}", accuracy(&one));
    assert!(accuracy(&one) < 1e-11);
}

/// F at 401 times of M Ẍ + γ Ẋ = K(vt − X) − F(X) from rest, by the classical method of Runge and Kutta. Its own error is that of
/// 40 000 steps, of fourth order away from kinks of F.
fn forces(form: &dyn Fn(f64) -> f64) -> Vec<f64> {
    const STEPS: u32 = 40_000;
    let (mass, damping, stiffness, velocity, time) = (0.02, 0.5, 1.0, 0.1, 40.0);
    let step = time / f64::from(STEPS);
    let rate =
        |t: f64, [x, v]: [f64; 2]| [v, (stiffness * (velocity * t - x) - form(x) - damping * v) / mass];
    let after =
        |[x, v]: [f64; 2], part: f64, [dx, dv]: [f64; 2]| [x + part * step * dx, v + part * step * dv];
    let (mut now, mut forces) = ([0.0, 0.0], Vec::new());
    for n in 0..=STEPS {
        if n % (STEPS / 400) == 0 {
            forces.push(form(now[0]));
        }
        let t = f64::from(n) * step;
        let first = rate(t, now);
        let second = rate(t + 0.5 * step, after(now, 0.5, first));
        let third = rate(t + 0.5 * step, after(now, 0.5, second));
        let last = rate(t + step, after(now, 1.0, third));
        for (part, rate) in [(1.0, first), (2.0, second), (2.0, third), (1.0, last)] {
            now = after(now, part / 6.0, rate);
        }
    }
    forces
}

/// A block and an interface of two equal cells, over contacts whose force does not depend on time.
#[test]
fn motion_in_time() {
    let block = "[block]\nstiffness = 1.0\nslip.inertial = { mass = 0.02, damping = 0.5 }\n";
    let cells = "[interface]\ncells = [2]\ncoupling.neighbours.stiffness = 1.0\nconnection = 1.0\nmass = 0.02\nviscosity = 0.5\n";
    let gaussian = exact::Gaussian::new(1.0, 0.1);
    let rectangular = exact::Rectangular { min: 0.5, max: 1.5 };
    let forms: [(&str, &dyn Fn(f64) -> f64); 3] = [
        ("gaussian = { mean = 1.0, std = 0.1 }", &|x| gaussian.force(x)),
        ("rectangular = { min = 0.5, max = 1.5 }", &|x| rectangular.force(x)),
        ("exponential.mean = 1.0", &|x: f64| -(-x).exp_m1()),
    ];
    for (law, form) in forms {
        let right = forces(form);
        for (slider, share) in [(block, 1.0), (cells, 0.5)] {
            let outcome = run(&format!(
                "master_equation.tolerance = 1e-3\ncontacts.thresholds.{law}\n{slider}[[protocol]]\nvelocity = 0.1\n\
                 distance = 4.0\npoints = 401\n"
            ));
            let off = column(&outcome, "force").iter().zip(&right);
            let off = off.map(|(force, right)| (share * force - right).abs()).fold(0.0, f64::max);
            assert!(off <= accuracy(&outcome), "{law}: {off:e} {:e}\n{slider}", accuracy(&outcome));
        }
    }
}

#[test]
fn hold_curves() {
    let text = |law: &str| {
        format!(
            "contacts.ageing.logarithmic = {{ growth = 0.05, time = 1.0 }}\ncontacts.thresholds.{law}\n\
             hold_curve = {{ velocity = 0.1, from = 1.0, to = 100.0, points = 2 }}\n"
        )
    };
    let gaussian = text("gaussian = { mean = 1.0, std = 0.1 }");
    let (usual, fine) = (run(&gaussian), run(&format!("master_equation.tolerance = 1e-7\n{gaussian}")));
    // Contacts are followed as closely as it takes.
    assert!(accuracy(&fine) <= 1e-7);
    for name in ["static_friction", "held_force"] {
        for (a, b) in column(&usual, name).iter().zip(column(&fine, name)) {
            assert!((a - b).abs() <= accuracy(&usual) + 1e-7, "{name}: {:e} {:e}", a - b, accuracy(&usual));
        }
    }
}
