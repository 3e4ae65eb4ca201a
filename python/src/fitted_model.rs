//! The description of the contacts that a fit has found.

use asperity::contacts::Stiffness;
use asperity::law::Parameter;
use asperity::{master, scenario};
use pyo3::prelude::*;

use crate::distributions::set_parameter;
use crate::equation::MasterEquation;
use crate::plain::{Interface, Solved};
use crate::solver::{EquationSolver, built};
use crate::watch::watched;

/// The equation of the estimated numbers, with the description of its contacts.
pub fn fitted_model<'py>(
    py: Python<'py>,
    equation: &master::MasterEquation,
    first: (Interface, Option<f64>),
    free: &[String],
) -> PyResult<Bound<'py, MasterEquation>> {
    let (interface, velocity) = fitted(first, equation, &equation.parameters(), free);
    let (_, initial) = watched(None, py, |monitor| built(&interface, monitor))?;
    let solved = Solved { own: scenario::MasterEquation::default(), velocity };
    let (equation, tolerance) = (equation.clone(), solved.own.tolerance());
    let solver = EquationSolver { equation, initial, tolerance };
    Bound::new(py, MasterEquation::described(solver, interface, solved))
}

/// The description of the fitted contacts: the first one with the estimates in the place of free numbers.
fn fitted(
    (mut interface, mut velocity): (Interface, Option<f64>),
    equation: &master::MasterEquation,
    parameters: &[Parameter],
    free: &[String],
) -> (Interface, Option<f64>) {
    // The description is that of the first curve.
    let free: Vec<&str> = free.iter().map(|name| name.strip_prefix("curve.0.").unwrap_or(name)).collect();
    let owner = |name: &str| LAWS.into_iter().find(|owner| is_of(name, owner));
    for Parameter { name, value } in parameters {
        let owner = owner(name);
        // The weights of a mixture change together.
        let changed = free.iter().any(|free| *free == name || owner.is_some_and(|owner| is_of(free, owner)));
        match owner {
            _ if !changed => {}
            Some(owner) => set_of_law(&mut interface, owner, &name[owner.len() + 1..], *value),
            None => set_number(&mut interface.contacts, &mut velocity, name, *value),
        }
    }
    if let Some(areas) = &mut interface.contacts.areas
        && free.iter().any(|free| ["thresholds.factor", "stiffness_per_threshold"].contains(free))
    {
        set_areas(areas, equation);
    }
    (interface, velocity)
}

/// The distributions by name.
const LAWS: [&str; 5] = ["thresholds", "reforming", "initial", "delay", "ageing.mature"];

/// Whether a number is a parameter of the distribution `owner`.
fn is_of(name: &str, owner: &str) -> bool {
    name.strip_prefix(owner).is_some_and(|rest| rest.starts_with('.'))
}

fn set_of_law(interface: &mut Interface, owner: &str, name: &str, to: f64) {
    let Interface { contacts, initial, .. } = interface;
    if let ("delay", Some(scenario::Delay::Law(law))) = (owner, &mut contacts.delay) {
        return set_parameter(law, name, to);
    }
    let law = match (owner, &mut contacts.areas, &mut contacts.ageing) {
        ("thresholds", Some(_), _) if name == "factor" => return,
        ("thresholds", Some(areas), _) => Some(&mut areas.law),
        ("thresholds", None, _) => contacts.thresholds.as_mut(),
        ("reforming", ..) => Some(&mut contacts.reforming),
        ("initial", ..) => Some(initial),
        (
            _,
            _,
            Some(
                scenario::Ageing::Smoluchowski { mature, .. }
                | scenario::Ageing::FrozenRank { mature, .. }
                | scenario::Ageing::MeanField { mature, .. },
            ),
        ) => Some(mature),
        _ => None,
    };
    set_parameter(law.expect("a distribution that was fitted"), name, to);
}

fn set_number(contacts: &mut scenario::Contacts, velocity: &mut Option<f64>, name: &str, to: f64) {
    let (temperature, ageing) = (&mut contacts.temperature, &mut contacts.ageing);
    match (name, temperature, ageing) {
        ("count", ..) => contacts.count = to,
        ("stiffness", ..) => contacts.stiffness = Some(to),
        ("stiffness_per_threshold", ..) if contacts.areas.is_some() => {}
        ("stiffness_per_threshold", ..) => contacts.stiffness_per_threshold = Some(to),
        ("temperature.energy", Some(heat), _) => heat.energy = to,
        ("temperature.attempt_rate", Some(heat), _) => heat.attempt_rate = to,
        ("ageing.growth", _, Some(scenario::Ageing::Logarithmic { growth, .. })) => *growth = to,
        (
            "ageing.time",
            _,
            Some(scenario::Ageing::Logarithmic { time, .. } | scenario::Ageing::FrozenRank { time, .. }),
        ) => *time = to,
        (
            "ageing.diffusion",
            _,
            Some(
                scenario::Ageing::Smoluchowski { diffusion, .. }
                | scenario::Ageing::MeanField { diffusion, .. },
            ),
        ) => *diffusion = to,
        ("delay", ..) => contacts.delay = Some(scenario::Delay::Time(to)),
        ("velocity", ..) => *velocity = Some(to),
        _ => unreachable!("a number without a place"),
    }
}

/// The modulus m and the strength s of areas, from κ = m²/s and the factor s/m of the thresholds.
fn set_areas(areas: &mut scenario::Areas, equation: &master::MasterEquation) {
    let contacts = equation.contacts();
    let known = contacts.thresholds.parameters().into_iter().find(|parameter| parameter.name == "factor");
    if let (Stiffness::PerThreshold(kappa), Some(Parameter { value: factor, .. })) =
        (&contacts.stiffness, known)
    {
        (areas.modulus, areas.strength) = (kappa * factor, kappa * factor * factor);
    }
}
