//! The derivative of the force by parameters, against reference values, closed forms and differences of F.

use std::sync::Arc;

use crate::common::{
    equation, exponential, gamma, gaussian, lognormal, mixture, point, rectangular, weibull,
};
use asperity::contacts::{Contacts, Initial, Start};
use asperity::law::{Renormalised, Root, SharedLaw};
use asperity::master::{MasterEquation, Pull};

/// Values of a solution on a fine grid, made for them. 1e-10: F'' is of order 10² here, so that the derivatives have
/// two digits fewer than F.
#[test]
fn derivatives_of_gaussian_thresholds_have_their_reference_values() {
    let zero = point(0.0);
    let equation = equation(&gaussian(1.0, 0.1), &zero, &zero, Start::Conditional);
    let pull = equation.pull_with(6.0, 1e-11, &mut ()).unwrap();
    let [mean, std] = ["thresholds.mean", "thresholds.std"].map(|name| pull.gradient(name).unwrap());
    for (x, force, by_mean, by_std) in [
        (0.9, 0.765_541_818_520_456, 2.019_081_266_741_01, -1.935_765_796_154_14),
        (1.0, 0.539_894_228_039_766, 3.489_422_804_052_74, 0.398_942_280_209_465),
        (2.18, 0.294_094_321_796_253, 0.837_341_728_593_106, 2.587_464_703_472_09),
        (5.45, 0.463_377_602_580_736, -2.993_260_341_279_3, 0.537_615_737_649_29),
    ] {
        assert!((pull.force(x) - force).abs() < 1e-12);
        assert!((mean.at(x) - by_mean).abs() < 1e-10 && (std.at(x) - by_std).abs() < 1e-10, "{x}");
    }
}

/// ∂S/∂θ of the gamma distribution against differences in 60-digit arithmetic (`tables/make_gamma_derivatives.py`), for
/// shapes from 0.04 to 10 000.
#[test]
fn derivatives_of_the_gamma_distribution_have_their_reference_values() {
    let table = include_str!("../tables/gamma_derivatives.csv");
    for line in table.lines().skip(1) {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [mean, std, x, by_mean, by_std] = numbers.try_into().unwrap();
        for (name, exact) in [("mean", by_mean), ("std", by_std)] {
            let found = std * gamma(mean, std).survival_derivative(name).unwrap()(x);
            assert!((found - exact).abs() < 1e-13, "{mean} {std} {name} {x}: {:e}", found - exact);
        }
    }
}

/// F = m(1 − e^{−X/m}).
#[test]
fn the_derivative_by_an_exponential_mean_has_a_closed_form() {
    let zero = point(0.0);
    let equation = equation(&exponential(0.7), &zero, &zero, Start::Conditional);
    let pull = equation.pull_with(5.0, 1e-12, &mut ()).unwrap();
    let gradient = pull.gradient("thresholds.mean").unwrap();
    for k in 0..50 {
        let x = 0.1 * f64::from(k);
        let exact = 1.0 - (-x / 0.7).exp() * (1.0 + x / 0.7);
        assert!((gradient.at(x) - exact).abs() < 1e-11, "{x}: {:e}", gradient.at(x) - exact);
    }
}

/// F = X − Σ_n [x̄Φ(z_n) − (σ/√n) φ(z_n)] with z_n = (X − nx̄)/(√n σ) gives
/// ∂F/∂x̄ = −Σ_n [Φ(z_n) − X φ(z_n)/(√n σ)] and ∂F/∂σ = Σ_n φ(z_n) [x̄z_n/σ + (1 + z_n²)/√n]. The
/// distribution is cut at 0, where z is −10.
#[test]
fn the_derivatives_by_gaussian_parameters_have_closed_forms() {
    use std::f64::consts::{PI, SQRT_2};
    let (zero, std) = (point(0.0), 0.1);
    let pull = equation(&gaussian(1.0, std), &zero, &zero, Start::Conditional).pull_with(5.0, 1e-12, &mut ());
    let gradients = pull.unwrap().gradients(&["thresholds.mean", "thresholds.std"]).unwrap();
    for k in 1..=100 {
        let x = 0.0499 * f64::from(k);
        let (mut by_mean, mut by_std) = (0.0, 0.0);
        for n in 1..=20 {
            let (n, root) = (f64::from(n), f64::from(n).sqrt());
            let z = (x - n) / (root * std);
            let density = (-0.5 * z * z).exp() / (2.0 * PI).sqrt();
            by_mean -= 0.5 * libm::erfc(-z / SQRT_2) - x * density / (root * std);
            by_std += density * (z / std + (1.0 + z * z) / root);
        }
        for (gradient, exact) in gradients.iter().zip([by_mean, by_std]) {
            // The tolerance of F by default, which its derivatives keep.
            assert!((gradient.at(x) - exact).abs() < 1e-10, "{x}: {:e}", gradient.at(x) - exact);
        }
    }
}

/// Rectangular thresholds on [a, b] of the width w, with a > b/2: F = X up to a, X + (a² − X²)/2w up to b,
/// X − (a + b)/2 up to 2a, and (X − 2a)²(X + a)/6w² less than that up to a + b.
#[test]
fn the_derivatives_by_rectangular_parameters_have_closed_forms() {
    let (zero, a, b) = (point(0.0), 0.8, 1.2);
    let pull = equation(&rectangular(a, b), &zero, &zero, Start::Conditional).pull_with(2.0, 1e-12, &mut ());
    let gradients = pull.unwrap().gradients(&["thresholds.min", "thresholds.max"]).unwrap();
    let width: f64 = b - a;
    for k in 1..=79 {
        let x = 0.025 * f64::from(k) + 0.0031;
        let (square, third) = ((a * a - x * x) / (2.0 * width.powi(2)), (x - 2.0 * a).powi(2) * (x + a));
        let steeper = third / (3.0 * width.powi(3));
        let lower = (2.0 * (x - 2.0 * a) * 2.0 * (x + a) - (x - 2.0 * a).powi(2)) / (6.0 * width.powi(2));
        let exact = match x {
            ..0.8 => [0.0, 0.0],
            0.8..1.2 => [a / width + square, -square],
            1.2..1.6 => [-0.5, -0.5],
            _ => [-0.5 + lower - steeper, -0.5 + steeper],
        };
        for (gradient, exact) in gradients.iter().zip(exact) {
            // The tolerance of F by default, which its derivatives keep.
            assert!((gradient.at(x) - exact).abs() < 1e-10, "{x}: {:e}", gradient.at(x) - exact);
        }
    }
}

/// Every parameter of every distribution as thresholds, re-forming and initial stretches, against central
/// differences of F of fourth order. F is accurate to 3e-12 and the steps are 3e-4 of a parameter: 1e-7 of the
/// largest derivative.
#[test]
fn derivatives_are_those_of_the_force() {
    let narrow = gaussian(0.1, 0.03);
    let zero = point(0.0);
    let smooth = gaussian(1.0, 0.15);
    let mixed = |a: SharedLaw, b: SharedLaw| mixture(&[(0.4, a), (0.6, b)]);
    let laws = [
        smooth.clone(),
        rectangular(0.6, 1.4),
        lognormal(1.0, 0.2),
        gamma(1.0, 0.25),
        weibull(5.0, 1.0),
        exponential(1.0),
        mixed(gaussian(0.8, 0.1), rectangular(0.9, 1.3)),
        mixed(point(0.9), smooth.clone()),
        Arc::new(Root::new(1.0, gaussian(1.0, 0.3)).unwrap()),
        Arc::new(Renormalised::new(gaussian(1.0, 0.2), 0.1).unwrap()),
    ];
    let starts = [
        narrow.clone(),
        rectangular(0.05, 0.3),
        mixed(zero.clone(), narrow.clone()),
        gamma(0.15, 0.05),
        lognormal(0.15, 0.03),
        weibull(3.0, 0.15),
        exponential(0.02),
    ];
    for law in &laws {
        agree(law, &zero, &zero, Start::Conditional, "thresholds");
        agree(law, &narrow, &starts[1], Start::Relaxed, "thresholds");
    }
    for start in &starts {
        for thresholds in [&laws[0], &laws[1]] {
            agree(thresholds, start, &zero, Start::Conditional, "reforming");
            agree(thresholds, &zero, start, Start::Conditional, "initial");
            agree(thresholds, &narrow, start, Start::Relaxed, "initial");
        }
    }
}

fn agree(thresholds: &SharedLaw, reforming: &SharedLaw, initial: &SharedLaw, start: Start, owner: &str) {
    let laws = [thresholds, reforming, initial];
    let own = ["thresholds", "reforming", "initial"].iter().position(|name| *name == owner).unwrap();
    let pull = |law: &SharedLaw| {
        let mut laws = laws.map(Clone::clone);
        laws[own] = law.clone();
        equation(&laws[0], &laws[1], &laws[2], start).pull_with(4.0, 3e-12, &mut ()).unwrap()
    };
    let base = pull(laws[own]);
    for parameter in laws[own].parameters() {
        if parameter.name.ends_with("at") {
            assert!(base.gradient(&format!("{owner}.{}", parameter.name)).is_err());
            continue;
        }
        let step = 3e-4 * parameter.value;
        let at =
            |k: f64| pull(&laws[own].with_parameter(&parameter.name, parameter.value + k * step).unwrap());
        let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(at);
        let gradient = base.gradient(&format!("{owner}.{}", parameter.name)).unwrap();
        let positions: Vec<f64> = (1..=60).map(|k| 0.0637 * f64::from(k)).collect();
        let difference =
            |x: f64| (8.0 * (a.force(x) - b.force(x)) - (c.force(x) - d.force(x))) / (12.0 * step);
        let largest = positions.iter().map(|&x| difference(x).abs()).fold(0.0, f64::max);
        // Where a kink of F passes between the steps, differences of second order show it.
        let bent = |x: f64| {
            let [inner, outer] = [(a.force(x) - b.force(x)) / 2.0, (c.force(x) - d.force(x)) / 4.0];
            (inner - outer).abs() > 1e-3 * step * largest
        };
        let smooth: Vec<f64> = positions.iter().copied().filter(|&x| !bent(x)).collect();
        assert!(smooth.len() >= 54, "{} of {} positions", smooth.len(), positions.len());
        let apart = smooth.iter().map(|&x| (gradient.at(x) - difference(x)).abs());
        let worst = apart.fold(0.0, f64::max);
        assert!(worst < 1e-7 * largest, "{owner}.{} of {:?}", parameter.name, laws[own]);
    }
}

/// F_s, F_k, X* and K_c of a pull.
fn friction(equation: &MasterEquation, pull: &Pull) -> [f64; 4] {
    [
        pull.static_friction().unwrap().value,
        equation.steady_state().kinetic_friction(),
        equation.relaxation().unwrap().length(),
        pull.critical_stiffness(),
    ]
}

/// Holds the derivatives of friction by a parameter of this value against central differences of fourth order of F_s,
/// F_k, X* and K_c themselves; `with` makes the contacts with another value. With steps of 1e-3 of the value, errors of
/// 1e-12 become 1e-9 to 1e-8. K_c is a slope of F, with an error of 1e-9.
fn friction_agrees(name: &str, value: f64, with: impl Fn(f64) -> MasterEquation) {
    let pull = |equation: &MasterEquation| equation.pull_with(4.0, 1e-12, &mut ()).unwrap();
    let step = 1e-3 * value;
    let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(|k| {
        let equation = with(value + k * step);
        friction(&equation, &pull(&equation))
    });
    let found = pull(&with(value)).friction_gradient(name).unwrap();
    let found = [
        found.static_friction.unwrap(),
        found.kinetic_friction,
        found.relaxation_length,
        found.critical_stiffness,
    ];
    for (i, found) in found.into_iter().enumerate() {
        let difference = (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * step);
        let tolerance = if i == 3 { 1e-6 } else { 1e-8 };
        let apart = (found - difference).abs();
        assert!(apart < tolerance * difference.abs().max(1.0), "{name} {i}: {found} {difference}");
    }
}

/// F_s, F_k, X* and K_c by the parameters of the thresholds. F_k = (1 + σ²/x̄²)x̄/2 has a closed form, too.
#[test]
fn derivatives_of_friction_are_those_of_its_values() {
    let zero = point(0.0);
    let narrow = gaussian(0.1, 0.02);
    let law = gaussian(1.0, 0.12);
    for reforming in [&zero, &narrow] {
        for parameter in law.parameters() {
            friction_agrees(&format!("thresholds.{}", parameter.name), parameter.value, |value| {
                let law = law.with_parameter(&parameter.name, value).unwrap();
                equation(&law, reforming, &zero, Start::Conditional)
            });
        }
    }
    let pull = equation(&law, &zero, &zero, Start::Conditional).pull_with(4.0, 1e-12, &mut ()).unwrap();
    let [mean, std] = ["mean", "std"]
        .map(|name| pull.friction_gradient(&format!("thresholds.{name}")).unwrap().kinetic_friction);
    assert!((mean - 0.5 * (1.0 - 0.12 * 0.12)).abs() < 1e-12 && (std - 0.12).abs() < 1e-12);
}

/// At kinks of F: rectangular thresholds on [a, b] with a > b/2 give F_s = a and K_c = b/(b − a) − 1, since F' = 1 −
/// X/(b − a) between a and b.
#[test]
fn friction_at_kinks_moves_with_them() {
    let zero = point(0.0);
    let (a, b) = (0.9, 1.1);
    let equation = equation(&rectangular(a, b), &zero, &zero, Start::Conditional);
    let pull = equation.pull_with(3.0, 1e-12, &mut ()).unwrap();
    let [by_a, by_b] = ["thresholds.min", "thresholds.max"].map(|name| pull.friction_gradient(name).unwrap());
    let width: f64 = b - a;
    for (found, peak, stiffness) in [(by_a, 1.0, b / width.powi(2)), (by_b, 0.0, -a / width.powi(2))] {
        assert!((found.static_friction.unwrap() - peak).abs() < 1e-9, "{found:?}");
        assert!((found.critical_stiffness - stiffness).abs() < 1e-7, "{found:?}");
    }
}

/// Contacts that feel temperature, age, are free for a while or are stiffer where they are stronger, by their parameters; what
/// one case has shown, another, which takes long, leaves out. Their lives are differenced, but for count and stiffness without
/// temperature and for the delay. Against central differences of F of sixth order over 1e-3 of a parameter: forces have errors of
/// 1e-13, and rounding and truncation of the differences are below 1e-10 here. Differences of fourth order were good to 1e-7 to
/// 1e-6.
#[test]
fn derivatives_of_contacts_in_time_are_those_of_the_force() {
    use asperity::contacts::{Ageing, AgeingRule, Barrier, Stiffness, Temperature};
    let zero = point(0.0);
    let law = gaussian(1.0, 0.15);
    let plain = Contacts { count: 3.0, ..Contacts::new(law.clone(), gaussian(0.1, 0.03)) };
    let mut warm = plain.clone();
    warm.stiffness = Stiffness::Equal(1.5);
    warm.rules.temperature = Some(Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.04, 10.0) });
    let mut aged = plain.clone();
    let rule: Ageing = AgeingRule::Logarithmic { growth: 0.05, time: 1.0 };
    aged.rules.ageing = Some(rule);
    let mut free = plain.clone();
    free.rules.delay = 0.3.into();
    let mut all = warm.clone();
    all.rules.delay = 0.2.into();
    let mut strong = plain.clone();
    strong.stiffness = Stiffness::PerThreshold(1.2);
    let initial = Initial { law: zero, start: Start::Conditional };
    /// Up to the second breaks.
    const LENGTH: f64 = 2.0;
    let of_laws = ["thresholds.mean", "thresholds.std", "reforming.mean", "reforming.std"];
    let none: &[&str] = &[];
    let cases = [
        (plain, None, 2, none),
        (warm, Some(0.5), 5, &[&of_laws[..], &["count", "velocity", "temperature.attempt_rate"]].concat()),
        (aged, Some(0.5), 5, none),
        (free, Some(0.5), 4, none),
        (all, Some(0.5), 6, &["thresholds.mean", "reforming.std", "count", "stiffness"]),
        (strong, None, 2, none),
    ];
    for (contacts, velocity, numbers, left_out) in cases {
        let equation = match velocity {
            Some(velocity) => MasterEquation::at(contacts.clone(), &initial, velocity),
            None => MasterEquation::new(contacts.clone(), &initial),
        };
        let equation = equation.unwrap();
        let base = equation.pull(LENGTH).unwrap();
        let parameters = base.parameters();
        assert_eq!(
            parameters.iter().filter(|p| !p.name.contains(".m") && !p.name.contains(".std")).count(),
            numbers
        );
        let is_checked = |name: &str| !left_out.contains(&name);
        let parameters: Vec<_> = parameters.into_iter().filter(|p| is_checked(&p.name)).collect();
        assert_eq!(parameters.len(), numbers + 4 - left_out.len());
        let names: Vec<&str> = parameters.iter().map(|p| p.name.as_ref()).collect();
        let gradients = base.gradients(&names).unwrap();
        for (parameter, gradient) in parameters.iter().zip(gradients) {
            let step = 1e-3 * parameter.value.max(0.1);
            let at = |k: f64| {
                let value = parameter.value + k * step;
                equation.with_parameters(&[(&parameter.name, value)], &mut ()).unwrap().pull(LENGTH).unwrap()
            };
            let weights = [3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0];
            let pairs = [1.0, 2.0, 3.0].map(|k| [at(k), at(-k)]);
            let positions = (1..=20).map(|k| 0.0957 * f64::from(k));
            let difference = |x: f64| -> f64 {
                let term = |(weight, [a, b]): (f64, &[Pull; 2])| weight * (a.force(x) - b.force(x)) / step;
                weights.into_iter().zip(&pairs).map(term).sum()
            };
            let largest = positions.clone().map(|x| difference(x).abs()).fold(1.0, f64::max);
            for x in positions {
                let apart = gradient.at(x) - difference(x);
                let name = &parameter.name;
                // Differences of sixth order over steps of a thousandth: rounding and errors of forces, 1e-13 or so, are divided by the step.
                assert!(apart.abs() < 1e-9 * largest, "{name} {:?} {x}: {apart:e}", contacts.rules.first());
            }
        }
    }
}

/// Several at once are those one by one; F is proportional to count and stiffness; a parameter that the contacts lack is
/// refused with the list of those that they have.
#[test]
fn parameters_have_names() {
    let equation = equation(&gaussian(1.0, 0.12), &gaussian(0.1, 0.03), &point(0.0), Start::Conditional);
    let pull = equation.pull(4.0).unwrap();
    let names =
        ["thresholds.mean", "thresholds.std", "reforming.mean", "reforming.std", "count", "stiffness"];
    let parameters = pull.parameters();
    assert_eq!(parameters.iter().map(|p| p.name.as_ref()).collect::<Vec<_>>(), names);
    let together = pull.gradients(&names).unwrap();
    let friction = pull.friction_gradients(&names).unwrap();
    for ((name, gradient), friction) in names.into_iter().zip(&together).zip(&friction) {
        let alone = pull.gradient(name).unwrap();
        for k in 1..=40 {
            let x = 0.1 * f64::from(k);
            // The cells of lives may differ.
            assert!((gradient.at(x) - alone.at(x)).abs() < 1e-11, "{name} {x}");
            if name == "count" || name == "stiffness" {
                assert!((gradient.at(x) - pull.force(x)).abs() < 1e-15);
            }
        }
        let static_friction = friction.static_friction.unwrap();
        assert!(
            (static_friction - pull.friction_gradient(name).unwrap().static_friction.unwrap()).abs() < 1e-10
        );
    }
    let [count, stiffness] = [friction[4], friction[5]];
    assert_eq!(count, stiffness);
    let peak = pull.static_friction().unwrap().value;
    assert!((count.static_friction.unwrap() - peak).abs() < 1e-14);
    assert!((count.kinetic_friction - equation.steady_state().kinetic_friction()).abs() < 1e-14);
    assert!((count.critical_stiffness - pull.critical_stiffness()).abs() < 1e-12);
    assert_eq!(count.relaxation_length, 0.0);
    let error = pull.gradient("temperature.energy").unwrap_err().to_string();
    assert!(names.iter().all(|name| error.contains(name)), "{error}");
}

/// A delay moves friction, too, and so does the velocity.
#[test]
fn friction_changes_with_the_delay() {
    let mut contacts = Contacts::new(gaussian(1.0, 0.15), gaussian(0.1, 0.03));
    contacts.rules.delay = 0.3.into();
    let equation = MasterEquation::at(contacts, &Initial::default(), 0.5).unwrap();
    for (name, value) in [("delay", 0.3), ("velocity", 0.5)] {
        friction_agrees(name, value, |value| equation.with_parameters(&[(name, value)], &mut ()).unwrap());
    }
}

/// Exponential thresholds of mean θ re-formed at 0 have no root: F = θ(1 − e^{−X/θ}), and X* = θ.
#[test]
fn the_relaxation_length_of_exponential_thresholds_is_their_mean() {
    let zero = point(0.0);
    let equation = equation(&exponential(1.3), &zero, &zero, Start::Conditional);
    let found = equation.pull(4.0).unwrap().friction_gradient("thresholds.mean").unwrap();
    // The length of the tail is closed; its difference of eighth order has the rounding of 1e-16 over a step of 1e-2.
    assert!((found.relaxation_length - 1.0).abs() < 1e-12, "{}", found.relaxation_length);
    // A weight near 1, of which the usual steps would be above 1; the tail is that of the exponential part whatever its weight.
    let parts = [(0.97, exponential(1.0)), (0.03, gaussian(2.0, 0.2))];
    let equation =
        MasterEquation::new(Contacts::new(mixture(&parts), point(0.0)), &Initial::default()).unwrap();
    let found = equation.pull(5.0).unwrap().friction_gradient("thresholds.0.weight").unwrap();
    assert!(found.relaxation_length.abs() < 1e-6, "{}", found.relaxation_length);
}
