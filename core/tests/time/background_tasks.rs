//! A background force in the results of each task: a shift of the friction forces, and of nothing else.

use asperity::record::Record;
use asperity::scenario::Scenario;
use asperity::task;
use asperity::task::summary::{StaticFriction, Summary};
use serde_json::{Value, json};

/// Normal load and friction coefficient of the background.
const LOAD: f64 = 8.0;
const COEFFICIENT: f64 = 0.5;

/// The scenario with these contacts and tables, with or without a background force of 4.
fn ran(contacts: &Value, tables: &Value, background: bool) -> (Summary, Record) {
    let mut scenario = tables.clone();
    scenario["contacts"] = contacts.clone();
    scenario["contacts"]["normal_load"] = json!(LOAD);
    if background {
        scenario["contacts"]["background_coefficient"] = json!(COEFFICIENT);
    }
    let scenario: Scenario = serde_json::from_value(scenario).unwrap();
    task::run(&scenario, &mut ()).unwrap()
}

/// Checks that the variables `shifted` are larger by `by` with a background force, and that no others change.
fn shifts(contacts: &Value, tables: &Value, (shifted, by): (&[&str], f64)) -> [(Summary, Record); 2] {
    let [bare, loaded] = [false, true].map(|background| ran(contacts, tables, background));
    assert_eq!(bare.1.variables.len(), loaded.1.variables.len());
    let mut found: Vec<&str> = Vec::new();
    for (a, b) in bare.1.variables.iter().zip(&loaded.1.variables) {
        assert_eq!((&a.name, a.values.len()), (&b.name, b.values.len()));
        let by = match a.name.as_str() {
            "friction_coefficient" => COEFFICIENT,
            "cell_force" => COEFFICIENT * LOAD,
            // The measured force is the same.
            "compared_residual" => -by,
            name if shifted.contains(&name) => by,
            _ => 0.0,
        };
        found.extend(shifted.iter().filter(|name| **name == a.name).copied());
        for (a_value, b_value) in a.values.iter().zip(&b.values) {
            // Sums of numbers up to 20: rounding.
            let error = (b_value - a_value - by).abs();
            assert!(error < 1e-12 || a_value == b_value && by == 0.0, "{}: {error:e}", a.name);
        }
    }
    assert_eq!(found.len(), shifted.len(), "{found:?}");
    assert_eq!((bare.0.background_force, loaded.0.background_force), (None, Some(COEFFICIENT * LOAD)));
    [bare, loaded]
}

fn contacts() -> Value {
    json!({ "count": 10.0, "thresholds": { "gaussian": { "mean": 1.0, "std": 0.1 } } })
}

fn ageing() -> Value {
    let mut contacts = contacts();
    contacts["ageing"] = json!({ "logarithmic": { "growth": 0.05, "time": 1.0 } });
    contacts
}

const FORCE: f64 = COEFFICIENT * LOAD;

#[test]
fn of_a_pull() {
    let tables = json!({
        "pull": { "distance": 3.0, "points": 31 }, "ensemble": { "size": 100 },
        "compare": { "position": [0.5, 1.5], "force": [9.0, 9.0] }
    });
    let [bare, loaded] = shifts(&contacts(), &tables, (&["force", "ensemble_force"], FORCE));
    let [a, b] = [&bare.0, &loaded.0].map(|summary| summary.numbers.friction().unwrap());
    let peak = |friction: StaticFriction| match friction {
        StaticFriction::Reached { force, position } => (force, position),
        StaticFriction::NotReached => panic!("not reached"),
    };
    assert_eq!(peak(b.static_friction), (peak(a.static_friction).0 + FORCE, peak(a.static_friction).1));
    assert_eq!(b.kinetic_friction, a.kinetic_friction + FORCE);
    assert_eq!(b.critical_stiffness, a.critical_stiffness);
    let coefficients = b.friction_coefficients.unwrap();
    assert_eq!(coefficients.kinetic, b.kinetic_friction / LOAD);
    // The measured curve is compared with the whole force, F(0.5) = 5 and F(1.5) of the record, with 4 added: by hand.
    let force = loaded.1.values("force").unwrap();
    let rms = (((9.0 - force[5]).powi(2) + (9.0 - force[15]).powi(2)) / 2.0).sqrt();
    let found = loaded.0.numbers.compare().unwrap().residual_rms.unwrap();
    assert!((found - rms).abs() < 1e-9, "{found} {rms}");
}

#[test]
fn of_a_block() {
    let tables = json!({
        "drive": { "distance": 6.0, "points": 61 }, "block": { "stiffness": 4.0, "slip": "overdamped" },
        "ensemble": { "size": 100 }
    });
    let shifted = [
        "force",
        "spring_force",
        "event_force_before",
        "event_force_after",
        "branch_force",
        "ensemble_force",
        "ensemble_spring_force",
        "ensemble_event_force_before",
        "ensemble_event_force_after",
    ];
    let [bare, loaded] = [false, true].map(|background| ran(&contacts(), &tables, background));
    for name in shifted {
        let [a, b] = [&bare, &loaded].map(|found| found.1.values(name).unwrap());
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(b).all(|(a, b)| (b - a - FORCE).abs() < 1e-12), "{name}");
    }
    for name in [
        "drive",
        "position",
        "event_drop",
        "event_drive",
        "branch_drive",
        "branch_stable",
        "ensemble_position",
    ] {
        let [a, b] = [&bare, &loaded].map(|found| found.1.values(name).unwrap());
        assert!(a.iter().zip(b).all(|(a, b)| (b - a).abs() < 1e-12), "{name}");
    }
    // The potential is that of a slider at rest anywhere, up to a constant: its differences do not change where the slider goes
    // forward. Sums of numbers up to 100, with the 2001 points of ∫F dX.
    let [a, b] = [&bare, &loaded].map(|found| found.1.values("potential").unwrap());
    for row in 0..3 {
        let [a, b] = [a, b].map(|values| &values[row * values.len() / 3..(row + 1) * values.len() / 3]);
        assert!(a.iter().zip(b).all(|(x, y)| ((y - b[0]) - (x - a[0])).abs() < 1e-9));
    }
}

#[test]
fn of_a_protocol() {
    let steps = json!([
        { "velocity": 0.1, "distance": 3.0, "points": 11 },
        { "hold": 10.0, "points": 5 },
        { "velocity": 0.1, "distance": 2.0, "points": 11 },
        { "velocity": 1.0, "distance": 2.0, "points": 41 }
    ]);
    let tables = json!({ "protocol": steps, "ensemble": { "size": 100 } });
    let forces = ["force", "spring_force", "ensemble_force"];
    let [bare, loaded] = shifts(&ageing(), &tables, (&forces, FORCE));
    for (a, b) in bare.0.numbers.steps().iter().zip(loaded.0.numbers.steps()) {
        assert!(
            (b.force - a.force - FORCE).abs() < 1e-12 && (b.peak.force - a.peak.force - FORCE).abs() < 1e-12
        );
        assert_eq!(b.kinetic_friction, a.kinetic_friction.map(|force| force + FORCE));
    }
    let [a, b] = [&bare, &loaded].map(|found| found.0.numbers.steps()[3].rate_state.unwrap());
    // A fit by least squares: it ends within 1e-6 of its minimum.
    assert!((b.a - a.a).abs() < 1e-5 && (b.b - a.b).abs() < 1e-5, "{a:?} {b:?}");
    assert!((b.force_before - a.force_before - FORCE).abs() < 1e-12);
}

#[test]
fn of_a_block_in_time() {
    let tables = json!({
        "protocol": [{ "velocity": 0.1, "distance": 4.0, "points": 21 }],
        "block": { "stiffness": 4.0, "slip": { "damped": { "damping": 1.0 } } }
    });
    let forces = ["force", "spring_force", "event_force_before", "event_force_after"];
    shifts(&ageing(), &tables, (&forces, FORCE));
}

#[test]
fn of_curves() {
    let tables = json!({ "velocity_curve": { "from": 0.1, "to": 1.0, "points": 3 } });
    let [bare, loaded] = shifts(&ageing(), &tables, (&["kinetic_friction"], FORCE));
    assert_eq!(loaded.0.numbers.limits()[0].fast, bare.0.numbers.limits()[0].fast + FORCE);
    let tables = json!({ "hold_curve": { "from": 1.0, "to": 100.0, "points": 5, "velocity": 0.1 } });
    let [bare, loaded] = shifts(&ageing(), &tables, (&["static_friction", "held_force"], FORCE));
    let [a, b] = [&bare, &loaded].map(|found| found.0.numbers.hold_curve().unwrap());
    assert_eq!(b.kinetic_friction, a.kinetic_friction + FORCE);
    let [a, b] = [a, b].map(|curve| curve.healing_per_decade.unwrap());
    // A fit by least squares: it ends within 1e-6 of its minimum.
    assert!((b - a).abs() < 1e-5 * a, "{a} {b}");
}

/// Cells go forward only: all forces of n cells are larger by n times the force of one cell.
#[test]
fn of_an_interface() {
    let mut tables = json!({
        "drive": { "distance": 3.0, "points": 13 },
        "interface": { "cells": [4], "connection": 2.0, "coupling": { "neighbours": { "stiffness": 5.0 } },
            "disorder": { "std": 0.1 } }
    });
    let forces = ["force", "event_force_before", "event_force_after"];
    shifts(&contacts(), &tables, (&forces, 4.0 * FORCE));
    tables["drive"]["velocity"] = json!(0.1);
    tables["interface"]["viscosity"] = json!(1.0);
    tables["interface"]["slip"] = json!("overdamped");
    shifts(&ageing(), &tables, (&["force"], 4.0 * FORCE));
}

/// The readings of a machine of compliance `c` at even positions of the slider, from a pull of contacts with a background force.
fn measured(compliance: f64, background: f64) -> (Vec<f64>, Vec<f64>) {
    let tables = json!({ "pull": { "distance": 2.0, "points": 41 } });
    let (_, record) = ran(&contacts(), &tables, false);
    let force: Vec<f64> = record.values("force").unwrap().iter().map(|force| force + background).collect();
    let places =
        record.values("position").unwrap().iter().zip(&force).map(|(x, force)| x + compliance * force);
    (places.collect(), force)
}

/// A fit to readings that were made with a background force of 4: estimates and errors by key, and F_k with its error.
fn fitted(compliance: f64, contacts: &Value, free: &[&str]) -> (Vec<(f64, f64)>, (f64, f64)) {
    let (position, force) = measured(compliance, FORCE);
    let place = if compliance > 0.0 { "drive" } else { "position" };
    let mut tables = json!({
        "fit": { place: position, "force": force, "free": free, "noise": "white", "reading": 0.01 }
    });
    if compliance > 0.0 {
        tables["fit"]["compliance"] = json!(compliance);
    }
    let (summary, _) = ran(contacts, &tables, false);
    let fit = summary.numbers.fit().unwrap();
    let kinetic = fit.friction.unwrap().kinetic_friction;
    (
        fit.numbers.iter().map(|number| (number.value, number.error)).collect(),
        (kinetic.value.0, kinetic.error.0),
    )
}

/// Where positions are those of the slider, a background force is an offset: same values and errors. With a compliance it
/// also stretches the machine, and both are found.
#[test]
fn of_a_fit() {
    const MEAN: &str = "contacts.thresholds.gaussian.mean";
    let mut loaded = contacts();
    loaded["background_force"] = json!(3.0);
    // Readings without errors: the search ends within a thousandth of the errors of the estimates, 1e-3.
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-5, "{a} {b}");
    let (offset, bare) = fitted(0.0, &contacts(), &[MEAN, "fit.offset"]);
    let (background, whole) = fitted(0.0, &loaded, &[MEAN, "contacts.background_force"]);
    for (a, b) in offset.iter().zip(&background) {
        close(a.0, b.0);
        close(a.1, b.1);
    }
    close(background[1].0, FORCE);
    // F_k contains the background force, but not an offset.
    close(whole.0 - bare.0, FORCE);
    assert!(whole.1 > 0.0 && (whole.1 - bare.1).abs() > 1e-6, "{} {}", whole.1, bare.1);
    let (both, _) = fitted(0.02, &loaded, &[MEAN, "contacts.background_force", "fit.offset"]);
    close(both[0].0, 1.0);
    close(both[1].0, FORCE);
    close(both[2].0, 0.0);
}
