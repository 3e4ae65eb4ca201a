//! Derivatives by parameters that move the edges of distributions, where lives are differenced: against central differences of
//! whole solutions, which share nothing with the derivatives of lives.

use crate::common::{gaussian, mixture, point, rectangular};
use asperity::contacts::{
    Ageing, AgeingRule, Barrier, Contacts, FreeTime, Hazard, Initial, Rules, Start, Stiffness, Temperature,
};
use asperity::law::{SharedLaw, Truncated};
use asperity::master::{MasterEquation, Pull};

/// Weights of central differences of sixth order, which are Richardson extrapolations of those of second order.
const SIXTH_ORDER: [f64; 3] = [3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0];

/// Up to the second breaks of the contacts: edges of first lives at 0.5 to 1.5, of second ones from 1 on.
const LENGTH: f64 = 2.0;

/// F_s, F_k, X* and K_c, and the pull.
type Solved = ([f64; 4], Pull);

/// F_s, F_k, X* and K_c of a pull.
fn friction(pull: &Pull, equation: &MasterEquation) -> [f64; 4] {
    [
        pull.static_friction().map_or(f64::NAN, |peak| peak.value),
        equation.steady_state().kinetic_friction(),
        equation.relaxation().unwrap().length(),
        pull.critical_stiffness(),
    ]
}

/// The largest difference between the derivative of the force and central differences of the force, relative to the largest
/// derivative, and, with friction, those of the derivatives of F_s, F_k, X* and K_c, relative to them or to 1.
///
/// Where an edge of the force passes a position between the steps, differences of second and of fourth order disagree; those
/// positions are left out, and no more than a fifth of all.
fn apart(equation: &MasterEquation, name: &str, step: f64, with_friction: bool) -> [f64; 5] {
    let base = equation.pull(LENGTH).unwrap();
    let value = base.parameters().into_iter().find(|known| known.name == name).unwrap().value;
    let step = step * value.max(0.1);
    let at = |k: f64| {
        let varied = equation.with_parameters(&[(name, value + k * step)], &mut ()).unwrap();
        let pull = varied.pull(LENGTH).unwrap();
        let scalars = if with_friction { friction(&pull, &varied) } else { [0.0; 4] };
        (scalars, pull)
    };
    let pairs = [1.0, 2.0, 3.0].map(|k| [at(k), at(-k)]);
    let difference = |of: &dyn Fn(&Solved) -> f64| -> f64 {
        let term = |(weight, [a, b]): (f64, &[_; 2])| weight * (of(a) - of(b)) / step;
        SIXTH_ORDER.into_iter().zip(&pairs).map(term).sum()
    };
    let gradient = base.gradient(name).unwrap();
    let positions: Vec<f64> = (1..=40).map(|k| 0.0487 * f64::from(k)).collect();
    let largest = positions.iter().map(|&x| difference(&|at| at.1.force(x)).abs()).fold(0.0, f64::max);
    let bent = |x: f64| {
        let [inner, outer] =
            [0, 1].map(|k| (pairs[k][0].1.force(x) - pairs[k][1].1.force(x)) / (k + 1) as f64);
        (inner - outer).abs() > 2e-4 * step * largest
    };
    let smooth: Vec<f64> = positions.iter().copied().filter(|&x| !bent(x)).collect();
    assert!(5 * smooth.len() >= 4 * positions.len(), "{name}: {} of {}", smooth.len(), positions.len());
    let off = |&x: &f64| (gradient.at(x) - difference(&|at| at.1.force(x))).abs();
    let force = smooth.iter().map(off).fold(0.0, f64::max) / largest;
    if !with_friction {
        return [force, 0.0, 0.0, 0.0, 0.0];
    }
    let found = base.friction_gradient(name).unwrap();
    let found = [
        found.static_friction.unwrap_or(f64::NAN),
        found.kinetic_friction,
        found.relaxation_length,
        found.critical_stiffness,
    ];
    let scalars: [f64; 4] = std::array::from_fn(|i| {
        let exact = difference(&|at| at.0[i]);
        (found[i] - exact).abs() / exact.abs().max(1.0)
    });
    [force, scalars[0], scalars[1], scalars[2], scalars[3]]
}

fn warm(barrier: Barrier, hazard: Hazard) -> Rules {
    let temperature = Some(Temperature { barrier, hazard, ..Temperature::new(0.02, 1.0) });
    Rules { temperature, ..Rules::default() }
}

fn at(contacts: Contacts, velocity: f64) -> MasterEquation {
    let initial = Initial { law: contacts.reforming.clone(), start: Start::Conditional };
    MasterEquation::at(contacts, &initial, velocity).unwrap()
}

/// Contacts with the parameters by which they have derivatives.
type Case<'a> = (&'a str, Contacts, f64, &'a [&'a str]);

fn of(law: &SharedLaw, starts: &SharedLaw, rules: Rules) -> Contacts {
    Contacts { rules, ..Contacts::new(law.clone(), starts.clone()) }
}

/// Tolerances of the force, of F_s, F_k and X*, and of K_c.
///
/// Forces have errors of 1e-13, and lives of contacts in time of 1e-13, too. Steps of 1e-3 of the value in the reference, and
/// about as short ones of the lives, make them 1e-10; where an edge of the force moves past a position, truncation of the
/// reference is 1e-9. K_c is a slope of the force, the reference of which has lost three further digits.
const CLOSE: [f64; 3] = [1e-8, 1e-9, 1e-6];

/// The derivatives of F_s, F_k, X* and K_c follow from the same derivatives of lives as that of the force, and take as long
/// again. They are compared for the first name of each case only.
fn agree(cases: &[Case<'_>], step: f64, [force, friction, stiffness]: [f64; 3]) {
    for (case, contacts, velocity, names) in cases {
        let equation = at(contacts.clone(), *velocity);
        for (i, name) in names.iter().enumerate() {
            let found = apart(&equation, name, step, i == 0);
            let allowed = [force, friction, friction, friction, stiffness];
            let close = found.iter().zip(allowed).all(|(found, allowed)| *found < allowed);
            assert!(close, "{case}, {name}: {found:?}");
        }
    }
}

/// Every barrier, both hazards, few and many thermal breaks before the edge, and a mixture.
#[test]
fn edges_of_thresholds_with_temperature_move() {
    let (edged, zero) = (rectangular(0.5, 1.5), point(0.0));
    let [highest, lowest]: [&[&str]; 2] = [&["thresholds.max"], &["thresholds.min"]];
    let mixed = mixture(&[(0.4, gaussian(0.9, 0.05)), (0.6, edged.clone())]);
    let elastic = || warm(Barrier::Elastic, Hazard::Joint);
    let all: &[&str] = &["thresholds.max", "thresholds.min", "temperature.energy", "velocity", "stiffness"];
    let of_mixture: &[&str] = &["thresholds.1.min", "thresholds.0.mean", "thresholds.0.weight"];
    let cases = [
        ("elastic", of(&edged, &zero, elastic()), 0.01, all),
        ("bell", of(&edged, &zero, warm(Barrier::Bell, Hazard::Joint)), 0.01, highest),
        ("catastrophe", of(&edged, &zero, warm(Barrier::Catastrophe, Hazard::Joint)), 0.01, lowest),
        ("additive", of(&edged, &zero, warm(Barrier::Elastic, Hazard::Additive)), 0.01, lowest),
        ("additive, bell", of(&edged, &zero, warm(Barrier::Bell, Hazard::Additive)), 0.01, highest),
        ("mixture", of(&mixed, &zero, elastic()), 0.01, of_mixture),
        ("slow", of(&edged, &zero, elastic()), 1e-4, highest),
    ];
    agree(&cases, 1e-3, CLOSE);
    let mut cold = elastic();
    cold.temperature = Some(Temperature::new(0.002, 1.0));
    // The force bends over the length T/k x̄ = 0.002 before the edge: shorter steps, which cost K_c one digit more.
    agree(&[("cold", of(&edged, &zero, cold), 0.01, highest)], 1e-4, [1e-8, 1e-9, 1e-5]);
}

/// Edges of the starting stretches, and those of thresholds where starts blur them.
#[test]
fn edges_of_starting_stretches_move() {
    let (edged, starts) = (rectangular(0.5, 1.5), rectangular(0.0, 0.2));
    let names: &[&str] = &["thresholds.max", "reforming.max"];
    let mut strong = of(&edged, &starts, Rules::default());
    strong.stiffness = Stiffness::PerThreshold(1.2);
    let cases = [
        // Where thresholds are spread, too, lives are sums over both.
        ("joint", of(&edged, &starts, warm(Barrier::Elastic, Hazard::Joint)), 0.1, &names[1..]),
        ("additive", of(&edged, &starts, warm(Barrier::Elastic, Hazard::Additive)), 0.01, names),
        (
            "blurred",
            of(&edged, &gaussian(0.1, 0.02), warm(Barrier::Elastic, Hazard::Additive)),
            0.01,
            &names[..1],
        ),
    ];
    agree(&cases, 1e-3, CLOSE);
    // The slope of the force of contacts that feel no temperature has a corner: forces of the reference are less smooth.
    agree(&[("per threshold", strong, 0.1, names)], 1e-3, [1e-6, 1e-9, 1e-6]);
}

/// Thresholds that age carry their edges along, contacts that are free for a while shift them.
#[test]
fn edges_that_age_or_wait_move() {
    let (edged, zero) = (rectangular(0.5, 1.5), point(0.0));
    let warm = |ageing: Option<Ageing>, delay: FreeTime| Rules {
        ageing,
        delay,
        ..warm(Barrier::Elastic, Hazard::Joint)
    };
    let strengthening: Ageing = AgeingRule::Logarithmic { growth: 0.05, time: 1.0 };
    let athermal = Rules { ageing: Some(strengthening.clone()), ..Rules::default() };
    let none = FreeTime::default;
    let by_age: &[&str] = &["thresholds.max", "ageing.growth", "ageing.time", "velocity"];
    let cases = [
        ("logarithmic", of(&edged, &zero, athermal), 0.1, by_age),
        (
            "logarithmic, warm",
            of(&edged, &zero, warm(Some(strengthening), none())),
            0.1,
            &["thresholds.max", "velocity"],
        ),
        ("delay", of(&edged, &zero, warm(None, 5.0.into())), 0.03, &["thresholds.max", "delay", "velocity"]),
        (
            "delays",
            of(&edged, &zero, warm(None, rectangular(2.0, 6.0).into())),
            0.03,
            &["delay.max", "velocity"],
        ),
    ];
    agree(&cases, 1e-3, CLOSE);
    let ranked = AgeingRule::FrozenRank { mature: rectangular(0.4, 2.0), time: 1.0 };
    let ranked = of(&edged, &zero, Rules { ageing: Some(ranked), ..Rules::default() });
    // Every solution tabulates the ranks first, so that what follows from the same derivatives of lives is left out. Ranks are
    // interpolated, which has errors of 1e-10 and more near edges: a thousandth is the step of the reference.
    let found = apart(&at(ranked, 0.1), "thresholds.max", 1e-3, false)[0];
    assert!(found < 1e-5, "frozen_rank: {found}");
}

/// Two edges at one place that move differently: no coordinate moves with both, and steps are so short that none passes a point
/// at which lives are evaluated. Errors of 1e-13 over steps of 1e-6 to 1e-5; the reference has steps of 1e-4 so that edges stay
/// on their sides. The maximum of the force is at a kink of the one for larger, of the other for smaller values.
#[test]
fn edges_on_each_other_are_told_apart() {
    let zero = point(0.0);
    let parts =
        |weight: f64| mixture(&[(weight, rectangular(0.5, 1.0)), (1.0 - weight, rectangular(1.0, 1.5))]);
    let contacts = |weight: f64| of(&parts(weight), &zero, warm(Barrier::Elastic, Hazard::Joint));
    let names: &[&str] = &["thresholds.0.max", "thresholds.1.min", "thresholds.1.max"];
    agree(&[("touching", contacts(0.3), 0.01, names)], 1e-4, [1e-7, 1e-7, 1e-6]);
    // Where the densities are equal on both sides, nothing shows that there is an edge.
    let timeless = of(&parts(0.5), &zero, Rules::default());
    for equation in [at(contacts(0.5), 0.01), MasterEquation::new(timeless, &Initial::default()).unwrap()] {
        let pull = equation.pull(LENGTH).unwrap();
        for name in names {
            let error = pull.gradient(name).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(name) && error.contains("edges that do, at"), "{error}");
        }
        assert!(pull.parameters().iter().all(|known| !known.name.starts_with("thresholds")));
    }
}

/// ∂S/∂θ of a truncated distribution with edges, against differences of S of fourth order: S has an error of 1e-16, and steps of
/// 1e-3 have a truncation of the order of 1e-12.
#[test]
fn truncated_distributions_with_edges_have_derivatives() {
    let parts = mixture(&[(0.4, gaussian(0.8, 0.1)), (0.6, rectangular(0.5, 1.5))]);
    let law: SharedLaw = std::sync::Arc::new(Truncated::new(parts, 1.2).unwrap());
    for parameter in law.parameters() {
        let found = law.survival_derivative(&parameter.name).unwrap();
        let step = 1e-3;
        let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0]
            .map(|k| law.with_parameter(&parameter.name, parameter.value + k * step).unwrap());
        for k in 0..130 {
            let x = 0.01 * f64::from(k) + 0.005;
            let [a, b, c, d] = [&a, &b, &c, &d].map(|law| law.survival(x));
            let exact = (8.0 * (a - b) - (c - d)) / (12.0 * step);
            // The third derivative of a Gaussian of std 0.1 is of the order of 1e3, its fifth 1e6.
            assert!((found(x) - exact).abs() < 1e-6, "{} {x}: {} {exact}", parameter.name, found(x));
        }
    }
}
