//! The force against the position of a drive behind a compliance, and its derivatives.

use crate::common::{gaussian, point};
use asperity::contacts::{Contacts, Initial, Stiffness};
use asperity::law::SharedLaw;
use asperity::master::{MasterEquation, Pull};

const PARAMETERS: [&str; 4] = ["thresholds.mean", "thresholds.std", "reforming.std", "stiffness"];

/// Positions of the drive; at the first two, the slider rests.
const DRIVE: [f64; 10] = [-0.3, -0.1, 0.05, 0.2, 0.9, 1.0, 1.13, 1.7, 2.6, 3.9];

fn equation(initial: &SharedLaw) -> MasterEquation {
    let mut contacts = Contacts::new(gaussian(1.0, 0.25), gaussian(0.1, 0.03));
    contacts.stiffness = Stiffness::Equal(1.4);
    MasterEquation::new(contacts, &Initial { law: initial.clone(), ..Initial::default() }).unwrap()
}

fn pull(equation: &MasterEquation) -> Pull {
    equation.pull_with(5.0, None, &mut ()).unwrap()
}

/// The force at a position of the drive, by bisection for the position of the slider, which shares no code with the
/// library.
fn force(pull: &Pull, compliance: f64, drive: f64) -> f64 {
    let (mut low, mut high) = (0.0, 5.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if middle + compliance * pull.force(middle) < drive { low = middle } else { high = middle }
    }
    // The slider rests until the drive has taken up the play.
    if low == 0.0 { pull.force(0.0) } else { pull.force(0.5 * (low + high)) }
}

/// Values against bisection; ∂F/∂θ, ∂F/∂c and dF/dX_T against central differences of fourth order of the whole inversion, over
/// 1e-3 of the parameter. F is accurate to 1e-13: 1e-9 with the truncation.
#[test]
fn derivatives_are_those_of_the_inversion() {
    for initial in [point(0.0), gaussian(0.15, 0.04)] {
        let equation = equation(&initial);
        let base = pull(&equation);
        for compliance in [0.0, 0.2, 0.45] {
            let found = base.against_drive(compliance, &DRIVE).unwrap();
            let gradients = base.gradients(&PARAMETERS).unwrap();
            let apart = |name: &str, value: f64, columns: Vec<f64>, at: &dyn Fn(f64, f64) -> f64| {
                let step = 1e-3 * value;
                for (&drive, found) in DRIVE.iter().zip(columns) {
                    let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(|k| at(value + k * step, drive));
                    let difference = (8.0 * (a - b) - (c - d)) / (12.0 * step);
                    let apart = (found - difference).abs();
                    assert!(
                        apart < 1e-9 * difference.abs().max(1.0),
                        "{name} {drive} {compliance}: {apart:e}"
                    );
                }
            };
            for (&drive, value) in DRIVE.iter().zip(&found.forces) {
                assert!((value - force(&base, compliance, drive)).abs() < 1e-13, "{drive} {compliance}");
            }
            for (name, gradient) in PARAMETERS.into_iter().zip(&gradients) {
                let parameters = base.parameters();
                let value = parameters.iter().find(|parameter| parameter.name == name).unwrap().value;
                let pulls: Vec<_> = [1.0, -1.0, 2.0, -2.0]
                    .map(|k| {
                        let value = value + k * 1e-3 * value;
                        (value, pull(&equation.with_parameters(&[(name, value)], &mut ()).unwrap()))
                    })
                    .into();
                let at = |value: f64, drive: f64| {
                    // Values are a thousandth apart: this one, not a neighbour.
                    let near = |(known, _): &&(f64, Pull)| (known - value).abs() < 1e-9 * value;
                    force(&pulls.iter().find(near).unwrap().1, compliance, drive)
                };
                apart(name, value, found.by_parameter(gradient), &at);
            }
            if compliance > 0.0 {
                apart("compliance", compliance, found.by_compliance(), &|c, drive| force(&base, c, drive));
            }
            let step = 1e-4;
            for ((&drive, slope), followed) in DRIVE.iter().zip(found.by_drive()).zip(&found.followed) {
                if drive == 0.0 {
                    continue;
                }
                let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(|k| force(&base, compliance, drive + k * step));
                let difference = (8.0 * (a - b) - (c - d)) / (12.0 * step);
                // Forces are solved to 1e-10, which the step divides; the truncation of fourth order is less.
                assert!((slope - difference).abs() < 1e-8, "{drive} {compliance}: {slope} {difference}");
                // X = X_T − cF.
                assert!((followed - (1.0 - compliance * slope)).abs() < 1e-14);
            }
        }
    }
}

/// A machine softer than K_c slips; a drive beyond the pull is refused.
#[test]
fn a_soft_machine_slips() {
    let pull = pull(&equation(&point(0.0)));
    let critical = pull.critical_stiffness();
    assert!(critical > 0.5 && critical.is_finite(), "{critical}");
    assert!(pull.against_drive(0.98 / critical, &DRIVE).is_some());
    assert!(pull.against_drive(1.02 / critical, &DRIVE).is_none());
    // Up to the maximum of F nothing slips.
    assert!(pull.against_drive(1.02 / critical, &DRIVE[..4]).is_some());
    // However long the pull: the slider slips between two positions that are close to each other.
    let narrow = Contacts::new(gaussian(1.0, 0.05), point(0.0));
    let narrow = MasterEquation::new(narrow, &Initial::default()).unwrap();
    let (long, drive) = (narrow.pull(120.0).unwrap(), [0.5, 1.0, 1.5, 2.5]);
    assert!(long.critical_stiffness() > 6.6);
    assert!(long.against_drive(1.0 / 6.5, &drive).is_none());
    assert!(long.against_drive(1.0 / 7.5, &drive).is_some());
    assert!(pull.against_drive(0.0, &[5.1]).is_none());
    assert!(pull.against_drive(0.1, &[1.0, 7.0]).is_none());
}
