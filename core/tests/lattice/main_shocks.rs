//! Lattices in time as a task: what is recorded, and foreshocks and aftershocks counted pair by pair.

use std::ops::ControlFlow;

use asperity::Error;
use asperity::monitor::Monitor;
use asperity::record::Record;
use asperity::scenario::Scenario;
use asperity::task::Output;
use asperity::task::summary::{InterfaceNumbers, MainShockNumbers};
use serde_json::{Value, json};

/// A lattice of these cells, in time with a temperature or without.
fn scenario(cells: [usize; 2], edges: &str, warm: bool) -> Value {
    let mut scenario = json!({
        "contacts": { "count": cells[0] * cells[1], "thresholds": { "gaussian": { "mean": 1.0, "std": 0.1 } } },
        "initial": { "rectangular": { "min": 0.0, "max": 0.5 } },
        "interface": {
            "cells": cells,
            "contacts": "one",
            "edges": edges,
            "coupling": { "neighbours": { "stiffness": 0.235 } },
            "connection": 0.06,
            "catalogue_from": 2.0,
            "main_shocks": { "size": 15, "window": 60.0, "distance": 3 },
        },
    });
    if warm {
        scenario["contacts"]["temperature"] =
            json!({ "energy": 0.01, "attempt_rate": 1.0, "barrier": "bell" });
    }
    scenario
}

fn drive(scenario: &Value) -> Output<InterfaceNumbers> {
    let scenario: Scenario = serde_json::from_value(scenario.clone()).unwrap();
    scenario.drive.as_ref().unwrap().run_interface(&scenario.build().unwrap(), &mut ()).unwrap()
}

fn values<'a>(record: &'a Record, name: &str) -> &'a [f64] {
    record.values(name).unwrap_or_else(|| panic!("no {name}"))
}

/// Main shocks, and the times of the events after and before them, from all pairs of events.
fn by_pairs(record: &Record, clock: &str, cells: [usize; 2], periodic: bool) -> (usize, [Vec<f64>; 2], f64) {
    let [at, size, epicentre] = [clock, "event_size", "event_epicentre"].map(|name| values(record, name));
    let n = at.len();
    let window = 60.0 * (at[n - 1] - at[0]) / (n - 1) as f64;
    let near = |a: usize, b: usize| {
        let place = |event: usize| {
            let number = epicentre[event] as usize;
            [number / cells[1], number % cells[1]]
        };
        (0..2).all(|axis| {
            let apart = (place(a)[axis] as i64 - place(b)[axis] as i64).unsigned_abs() as usize;
            apart <= 3 || periodic && cells[axis] - apart <= 3
        })
    };
    let (mut mains, mut around) = (0, [Vec::new(), Vec::new()]);
    for main in 0..n {
        let inside = at[main] - window >= at[0] && at[main] + window <= at[n - 1];
        let others: Vec<usize> = (0..n)
            .filter(|&other| other != main && (at[other] - at[main]).abs() <= window && near(main, other))
            .collect();
        let largest =
            others.iter().all(|&other| size[other] < size[main] || size[other] == size[main] && other > main);
        if size[main] >= 15.0 && inside && largest {
            mains += 1;
            for other in others {
                around[usize::from(other < main)].push((at[other] - at[main]).abs());
            }
        }
    }
    (mains, around, window)
}

#[test]
fn main_shocks_are_those_of_all_pairs() {
    for (cells, edges, warm) in
        [([12, 18], "open", true), ([12, 18], "periodic", true), ([20, 9], "open", false)]
    {
        let mut asked = scenario(cells, edges, warm);
        asked["drive"] = json!({ "distance": 6.0, "points": 11 });
        if warm {
            asked["drive"]["velocity"] = json!(1e-4);
        }
        let output = drive(&asked);
        let (record, catalogue) = (&output.record, output.numbers.catalogue);
        let [clock, along] = if warm { ["event_time", "shock_time"] } else { ["event_drive", "shock_drive"] };
        let (mains, [after, before], window) = by_pairs(record, clock, cells, edges == "periodic");
        let found: MainShockNumbers = catalogue.main_shocks.unwrap();
        assert!(mains > 5, "{mains}");
        assert_eq!((found.count, found.aftershocks, found.foreshocks), (mains, after.len(), before.len()));
        // Sums of the same numbers in another order.
        assert!((found.window / window - 1.0).abs() < 1e-12);
        // Rates are counts in bins over their widths and over the mean number of events nearby.
        let centres = values(record, along);
        let half = (centres[1] / centres[0]).sqrt();
        for (name, times) in [("aftershock_rate", after), ("foreshock_rate", before)] {
            let rates = values(record, name);
            let widths = centres.iter().map(|centre| centre * (half - 1.0 / half));
            let sum: f64 = rates.iter().zip(widths).map(|(rate, width)| rate * width).sum();
            let shown = times.iter().filter(|time| **time > 1e-6 * window).count() as f64;
            let side = |side: usize| {
                let within = |at: usize| {
                    (0..side)
                        .filter(|&other| {
                            let apart = at.abs_diff(other);
                            apart <= 3 || edges == "periodic" && side - apart <= 3
                        })
                        .count()
                };
                (0..side).map(within).sum::<usize>() as f64 / (side * side) as f64
            };
            let share = side(cells[0]) * side(cells[1]);
            let mean = mains as f64 * share * 60.0 / window * catalogue.events as f64
                / (catalogue.events as f64 - 1.0);
            // Bins have edges that are rounded, over 30 of them.
            assert!((sum * mean / shown - 1.0).abs() < 1e-10, "{name}: {} {shown}", sum * mean);
        }
    }
}

/// Counts how often it is asked once the drive is over, and stops the work after `most` times.
struct Counted {
    asked: usize,
    most: usize,
}

impl Monitor for Counted {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.asked += usize::from(fraction >= 1.0);
        if self.asked > self.most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Small events are compared with most of the others if main shocks are small and the window is long.
#[test]
fn looking_for_main_shocks_can_be_stopped() {
    let mut asked = scenario([24, 24], "periodic", false);
    asked["drive"] = json!({ "distance": 20.0, "points": 11 });
    asked["interface"]["main_shocks"] = json!({ "size": 1, "window": 1000.0, "distance": 1 });
    let scenario: Scenario = serde_json::from_value(asked).unwrap();
    let (drive, model) = (scenario.drive.as_ref().unwrap(), scenario.build().unwrap());
    let mut patient = Counted { asked: 0, most: usize::MAX };
    drive.run_interface(&model, &mut patient).unwrap();
    // The drive itself ends with one or two calls.
    assert!(patient.asked > 5, "{}", patient.asked);
    let mut impatient = Counted { asked: 0, most: patient.asked - 1 };
    assert!(matches!(drive.run_interface(&model, &mut impatient), Err(Error::Stopped)));
}

/// A drive at a velocity, and the protocol of one step at that velocity, give the same events; a hold has events, too.
#[test]
fn a_protocol_of_one_velocity_is_a_drive() {
    let mut driven = scenario([10, 10], "open", true);
    driven["interface"].as_object_mut().unwrap().remove("main_shocks");
    let mut moved = driven.clone();
    driven["drive"] = json!({ "distance": 4.0, "points": 5, "velocity": 1e-3 });
    moved["protocol"] =
        json!([{ "velocity": 1e-3, "distance": 4.0, "points": 5 }, { "hold": 1e4, "points": 3 }]);
    let driven = drive(&driven).record;
    let scenario: Scenario = serde_json::from_value(moved).unwrap();
    let moved =
        scenario.protocol.as_ref().unwrap().run_interface(&scenario.build().unwrap(), &mut ()).unwrap();
    let names = ["event_time", "event_drive", "event_size", "event_age", "event_drop"];
    let count = values(&driven, "event_time").len();
    assert!(count > 200 && values(&moved.record, "event_time").len() > count);
    for name in names {
        assert_eq!(values(&driven, name), &values(&moved.record, name)[..count], "{name}");
    }
    let [time, force] = ["time", "force"].map(|name| values(&moved.record, name));
    assert_eq!(time.len(), 7);
    // Contacts break thermally at rest, and the force relaxes.
    assert!(force[6] < force[4] && (time[6] - 1.4e4).abs() < 1e-8, "{time:?} {force:?}");
    // Drive and time are each the sum of a base and what follows it.
    for (drive, time) in values(&driven, "event_drive").iter().zip(values(&driven, "event_time")) {
        assert!((drive - 1e-3 * time).abs() < 1e-13 * drive);
    }
}
