//! The error budget: what is reported of the accuracy of each task holds, and what was asked for and is not reached is refused.

use std::path::Path;
use std::sync::Arc;

use asperity::Error;
use asperity::contacts::{Contacts, Initial, Start};
use asperity::elastic::{CellLoading, RateDependentInterface, RateDependentInterfaceParameters, coupling};
use asperity::exact::{self, ClosedForm};
use asperity::law::{Point, Rectangular};
use asperity::master::Transport;
use asperity::rate_dependent::RateDependentContacts;
use asperity::shape::{Edges, Shape};
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

/// Contacts whose force does not depend on time, followed in time, have that of the closed form wherever they are.
#[test]
fn blocks_in_time() {
    let text = |law: &str| {
        format!(
            "master_equation.tolerance = 1e-4\ncontacts.thresholds.{law}\n[block]\nstiffness = 1.0\nslip.damped = {{ damping = 0.5 }}\n[[protocol]]\nvelocity = 0.1\n\
             distance = 4.0\npoints = 401\n"
        )
    };
    let gaussian = exact::Gaussian::new(1.0, 0.1);
    let rectangular = exact::Rectangular { min: 0.5, max: 1.5 };
    let forms: [(&str, &dyn Fn(f64) -> f64); 3] = [
        ("gaussian = { mean = 1.0, std = 0.1 }", &|x| gaussian.force(x)),
        ("rectangular = { min = 0.5, max = 1.5 }", &|x| rectangular.force(x)),
        ("exponential.mean = 1.0", &|x: f64| -(-x).exp_m1()),
    ];
    for (law, form) in forms {
        let outcome = run(&text(law));
        let off = column(&outcome, "position").iter().zip(column(&outcome, "force"));
        let off = off.map(|(x, force)| (force - form(*x)).abs()).fold(0.0, f64::max);
        assert!(off <= accuracy(&outcome), "{law}: {off:e} {:e}", accuracy(&outcome));
    }
}

/// The same of cells.
#[test]
fn interfaces_in_time() {
    let at_rest = Arc::new(Point::new(0.0).unwrap());
    let contacts = Contacts::new(Arc::new(Rectangular::new(0.5, 1.5).unwrap()), at_rest.clone());
    let initial = Initial { law: at_rest, start: Start::Conditional };
    let transport = Transport::new_with(contacts, &initial, 1e-4, &mut ()).unwrap();
    let cells = (0..2).map(|_| Box::new(transport.clone()) as Box<dyn RateDependentContacts>).collect();
    let setting = RateDependentInterfaceParameters {
        connection: 0.5,
        loading: CellLoading::Edge,
        mass: 0.0,
        viscosity: 0.5,
        tolerance: 1e-4,
        slip_fraction: 0.0,
        area: None,
    };
    let springs = coupling::neighbours(Shape::Chain(2), Edges::Open, 1.0).unwrap();
    let mut interface = RateDependentInterface::new(cells, springs, setting).unwrap().with_error();
    let form = exact::Rectangular { min: 0.5, max: 1.5 };
    let mut off = 0.0_f64;
    for step in 1..=100 {
        interface.run(0.05 * f64::from(step), 0.1, &mut |_, _| {}).unwrap();
        for (x, force) in interface.positions().into_iter().zip(interface.forces()) {
            off = off.max((force - form.force(x)).abs());
        }
    }
    let error = interface.error().unwrap();
    assert!(off <= error, "{off:e} {error:e}");
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
