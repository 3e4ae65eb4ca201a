//! Steps of the normal load in a scenario: records, coefficients, the background force, and what is refused.

use asperity::record::Record;
use asperity::scenario::Scenario;
use asperity::task;
use asperity::task::summary::Summary;
use serde_json::{Value, json};

/// Normal load at the start.
const LOAD: f64 = 8.0;

fn scenario(contacts: &Value, tables: &Value) -> Scenario {
    let mut scenario = tables.clone();
    scenario["contacts"] = json!({ "thresholds": { "gaussian": { "mean": 1.0, "std": 0.25 } } });
    for (key, value) in contacts.as_object().unwrap() {
        scenario["contacts"][key] = value.clone();
    }
    serde_json::from_value(scenario).unwrap()
}

fn run(contacts: &Value, tables: &Value) -> (Summary, Record) {
    task::run(&scenario(contacts, tables), &mut ()).unwrap()
}

fn refused(contacts: &Value, tables: &Value) -> String {
    scenario(contacts, tables).build().unwrap_err().to_string()
}

/// Steady sliding, a rise of the load by a half, and a velocity step under that load.
fn protocol() -> Value {
    json!([
        { "velocity": 0.1, "distance": 3.0, "start": "steady", "points": 7 },
        { "velocity": 0.1, "distance": 20.0, "relative_normal_load": 1.5, "points": 11 },
        { "velocity": 1.0, "distance": 20.0, "relative_normal_load": 1.5, "points": 11 },
        { "velocity": 0.1, "distance": 20.0, "points": 11 },
    ])
}

fn ageing() -> Value {
    json!({ "ageing": { "logarithmic": { "growth": 0.04, "time": 1.0 } } })
}

#[test]
fn a_protocol_has_its_load_and_friction_in_proportion() {
    let (summary, record) = run(&ageing(), &json!({ "protocol": protocol() }));
    let loads = record.values("relative_normal_load").unwrap();
    let (time, force) = (record.values("time").unwrap(), record.values("force").unwrap());
    // Two points where the load steps.
    assert_eq!(time.len(), 7 + 10 + 10 + 10 + 2);
    assert_eq!((loads[6], loads[7], loads[27], loads[28]), (1.0, 1.5, 1.5, 1.0));
    let steps = summary.numbers.steps();
    let given: Vec<_> = steps.iter().map(|step| step.relative_normal_load).collect();
    assert_eq!(given, [None, Some(1.5), Some(1.5), None]);
    assert_eq!((steps[0].force, steps[2].force), (force[6], force[27]));
    for step in steps {
        // Four steps of accuracy 1e-6 of a force of order 1, after 20 relaxation lengths of about 1.
        let kinetic = step.kinetic_friction.unwrap();
        assert!((step.force - kinetic).abs() < 1e-5, "{step:?}");
    }
    assert!((steps[1].kinetic_friction.unwrap() / steps[0].kinetic_friction.unwrap() - 1.5).abs() < 1e-12);
    // Rate and state where the velocity alone steps.
    let read: Vec<bool> = steps.iter().map(|step| step.rate_state.is_some()).collect();
    assert_eq!(read, [false, false, true, false]);
}

#[test]
fn a_constant_load_changes_nothing() {
    let ones = json!([
        { "velocity": 0.1, "distance": 1.0, "relative_normal_load": 1.0 },
        { "velocity": 1.0, "distance": 1.0, "relative_normal_load": 1 },
    ]);
    let none = json!([{ "velocity": 0.1, "distance": 1.0 }, { "velocity": 1.0, "distance": 1.0 }]);
    let [(one, with), (other, without)] =
        [ones, none].map(|protocol| run(&ageing(), &json!({ "protocol": protocol })));
    assert_eq!(with, without);
    assert_eq!(one.numbers, other.numbers);
}

/// A background of the coefficient 0.25 is proportional to the load, one of the same force at the start is not. Both are added to the
/// force of contacts.
#[test]
fn a_background_of_a_coefficient_is_proportional_to_the_load() {
    let with = |key: &str, value: f64| {
        let mut contacts = ageing();
        contacts["count"] = json!(5.0);
        contacts["normal_load"] = json!(LOAD);
        if value > 0.0 {
            contacts[key] = json!(value);
        }
        run(&contacts, &json!({ "protocol": protocol() }))
    };
    let (bare, alone) = with("background_force", 0.0);
    let (proportional, of_load) = with("background_coefficient", 0.25);
    let (constant, of_force) = with("background_force", 0.25 * LOAD);
    let loads = alone.values("relative_normal_load").unwrap();
    let values = |record: &Record, name| record.values(name).unwrap().to_vec();
    for name in ["force", "spring_force"] {
        let [alone, of_load, of_force] = [&alone, &of_load, &of_force].map(|record| values(record, name));
        for i in 0..loads.len() {
            // Sums of numbers below 10: rounding.
            assert!((of_load[i] - alone[i] - 2.0 * loads[i]).abs() < 1e-12);
            assert!((of_force[i] - alone[i] - 2.0).abs() < 1e-12);
        }
    }
    let coefficient = values(&of_load, "friction_coefficient");
    for (i, force) in values(&of_load, "force").iter().enumerate() {
        assert!((coefficient[i] - force / (LOAD * loads[i])).abs() < 1e-12);
    }
    for (i, step) in bare.numbers.steps().iter().enumerate() {
        let kinetic = |summary: &Summary| summary.numbers.steps()[i].kinetic_friction.unwrap();
        let of_contacts = step.kinetic_friction.unwrap();
        assert!((kinetic(&proportional) - of_contacts - 2.0 * step.load()).abs() < 1e-12);
        assert!((kinetic(&constant) - of_contacts - 2.0).abs() < 1e-12);
    }
}

/// The ensemble beside the master equation, of time-dependent contacts that slide steadily first, with a ramp under load. The 32 points
/// are within 4 standard errors, which fails once in 500 choices of the seed.
#[test]
fn the_ensemble_has_the_same_force() {
    let steps = json!([
        { "velocity": 0.13, "distance": 0.7, "start": "steady", "points": 3 },
        { "velocity": 0.13, "distance": 1.1, "relative_normal_load": 2.3, "points": 9 },
        { "velocity": 0.13, "velocity_to": 0.7, "duration": 3.1, "relative_normal_load": 0.4, "points": 9 },
        { "hold": 7.7, "relative_normal_load": 0.9, "points": 5 },
        { "velocity": 0.13, "distance": 1.9, "relative_normal_load": 0.9, "points": 9 },
    ]);
    for delay in [0.0, 1.5] {
        let mut contacts = ageing();
        contacts["temperature"] = json!({ "energy": 0.05, "attempt_rate": 1.0 });
        contacts["delay"] = json!({ "time": delay });
        let tables = json!({ "protocol": steps, "ensemble": { "size": 5000, "seed": 3 } });
        let (_, record) = run(&contacts, &tables);
        let [force, drawn, error] =
            ["force", "ensemble_force", "ensemble_error"].map(|name| record.values(name).unwrap());
        assert_eq!((force.len(), drawn.len()), (34, 34));
        for i in 0..force.len() {
            let deviation = (force[i] - drawn[i]).abs() / error[i];
            assert!(deviation < 4.0, "{delay}, point {i}: {deviation}");
        }
    }
}

#[test]
fn an_accuracy_that_is_required_is_reached() {
    let tables = json!({ "protocol": protocol(), "master_equation": { "tolerance": 1e-7 } });
    let (summary, record) = run(&ageing(), &tables);
    let (_, usual) = run(&ageing(), &json!({ "protocol": protocol() }));
    // What was required.
    assert!(summary.accuracy.is_none_or(|accuracy| accuracy <= 1e-7));
    let pairs = record.values("force").unwrap().iter().zip(usual.values("force").unwrap());
    // The default tolerance is 1e-6.
    let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off > 0.0 && off < 1e-5, "{off:e}");
}

#[test]
fn loads_that_cannot_be_followed_are_refused_by_key() {
    let rise = |load: Value| json!([{ "velocity": 0.1, "distance": 1.0 }, { "hold": 1.0, "relative_normal_load": load }]);
    for load in [0.0, -1.0] {
        let error = refused(&ageing(), &json!({ "protocol": rise(json!(load)) }));
        assert!(error.starts_with("protocol.1.relative_normal_load"), "{error}");
    }
    let first = json!([{ "velocity": 0.1, "distance": 1.0, "relative_normal_load": 2.0 }]);
    let error = refused(&ageing(), &json!({ "protocol": first }));
    assert!(
        error.starts_with("protocol.0.relative_normal_load: expected 1, or none, in the first step"),
        "{error}"
    );
    let block = json!({ "stiffness": 1.0, "slip": { "damped": { "damping": 1.0 } } });
    let interface = json!({
        "cells": [8], "coupling": { "neighbours": { "stiffness": 1.0 } }, "connection": 1.0, "viscosity": 1.0,
        "slip": "overdamped",
    });
    let shared = json!({ "ageing": { "mean_field": { "mature": { "gaussian": { "mean": 1.5, "std": 0.1 } }, "diffusion": 0.01 } } });
    for (contacts, tables, named) in [
        (&ageing(), json!({ "block": block }), "[block]"),
        (&ageing(), json!({ "interface": interface }), "[interface]"),
        (&shared, json!({}), "contacts.ageing.mean_field"),
    ] {
        let mut tables = tables;
        tables["protocol"] = rise(json!(1.5));
        let error = refused(contacts, &tables);
        let expected = format!("protocol.1.relative_normal_load: expected 1, or none, with {named}");
        assert!(error.starts_with(&expected), "{error}");
        // A load of 1 is none.
        tables["protocol"] = rise(json!(1.0));
        scenario(contacts, &tables).build().unwrap();
    }
}
