//! Units do not matter: lengths, forces and times that are 2^±100 = 10^±30 times as large give the same numbers.

use std::path::Path;

use asperity::record::{Quantity, Record};
use asperity_runner::{input, task};

/// A power of two multiplies without rounding; what is left are roundings of logarithms and roots.
const FACTOR: f64 = (1_u128 << 100) as f64;

/// Of the largest value of a column.
const ROUNDING: f64 = 1e-9;

/// Factors of lengths, forces and times.
#[derive(Debug, Clone, Copy)]
struct Scale {
    length: f64,
    force: f64,
    time: f64,
}

const ONE: Scale = Scale { length: 1.0, force: 1.0, time: 1.0 };
const ALL: [Scale; 6] = [
    Scale { length: FACTOR, ..ONE },
    Scale { length: 1.0 / FACTOR, ..ONE },
    Scale { force: FACTOR, ..ONE },
    Scale { force: 1.0 / FACTOR, ..ONE },
    Scale { time: FACTOR, ..ONE },
    Scale { time: 1.0 / FACTOR, ..ONE },
];

impl Scale {
    /// What a quantity is multiplied by.
    fn of(self, quantity: Quantity) -> f64 {
        let Self { length, force, time } = self;
        match quantity {
            Quantity::Length => length,
            Quantity::Force => force,
            Quantity::PerLength => 1.0 / length,
            Quantity::Stiffness => force / length,
            Quantity::Energy => force * length,
            Quantity::Time => time,
            Quantity::Velocity => length / time,
            Quantity::PerTime => 1.0 / time,
            Quantity::Number => 1.0,
            other => panic!("no factor is known of a {}", other.name()),
        }
    }

    /// A scenario in which `3 m` is the length 3: numbers are followed by their units.
    ///
    /// m: length, N: force, s: time, J: energy, k: stiffness, v: velocity, Hz: per time, D: length² per time, P: force per
    /// length², e: force per velocity, M: force per acceleration.
    fn scenario(self, text: &str) -> String {
        let Self { length, force, time } = self;
        let units = [
            ("m", length),
            ("N", force),
            ("s", time),
            ("J", force * length),
            ("k", force / length),
            ("v", length / time),
            ("Hz", 1.0 / time),
            ("D", length * length / time),
            ("P", force / length / length),
            ("e", force * time / length),
            ("M", force * time * time / length),
        ];
        let mut scaled = String::new();
        for word in text.split_inclusive([' ', '\n']) {
            let bare = word.trim_end_matches([' ', '\n', ',', '}', ']']);
            let unit = bare.rsplit_once('_').and_then(|(number, name)| {
                let factor = units.iter().find(|unit| unit.0 == name)?.1;
                Some(number.parse::<f64>().ok()? * factor)
            });
            match unit {
                Some(value) => scaled += &format!("{value:e}{}", &word[bare.len()..]),
                None => scaled += word,
            }
        }
        scaled
    }
}

fn run(text: &str, scale: Scale) -> Result<Record, String> {
    let text = scale.scenario(text);
    let parsed = input::parse(&text, "test", Path::new(""), &[]).map_err(|e| format!("{e}\n{text}"))?;
    let outcome = task::run(&parsed.scenario, &mut ()).map_err(|e| format!("{e}\n{text}"))?;
    Ok(outcome.record)
}

/// What differs by more than rounding.
fn differences(record: &Record, scaled: &Record, scale: Scale, half_space: bool) -> Vec<String> {
    let mut found = Vec::new();
    for variable in &record.variables {
        let Some(other) = scaled.get(&variable.name).filter(|o| o.values.len() == variable.values.len())
        else {
            let length = scaled.get(&variable.name).map(|other| other.values.len());
            let (name, expected) = (&variable.name, variable.values.len());
            found.push(format!("{name}: {length:?} values instead of {expected}"));
            continue;
        };
        // The area of a cell is 1 where cells are coupled to neighbours and a length squared on a half-space: no quantity is told
        // of it.
        let by_area = variable.name.ends_with("area") || variable.name.ends_with("moment");
        let areas = if by_area && half_space { scale.length * scale.length } else { 1.0 };
        let factor = areas * scale.of(variable.quantity);
        let most =
            variable.values.iter().filter(|x| x.is_finite()).fold(0.0_f64, |most, x| most.max(x.abs()));
        let differs = |(x, y): (&f64, &f64)| {
            let y = y / factor;
            let same = x.to_bits() == y.to_bits() || (x.is_nan() && y.is_nan());
            if same || (x - y).abs() <= ROUNDING * most { None } else { Some((*x, y)) }
        };
        if let Some((x, y)) = variable.values.iter().zip(&other.values).find_map(differs) {
            found.push(format!("{}: {y} instead of {x}", variable.name));
        }
    }
    found
}

/// The same numbers at any scale.
#[track_caller]
fn invariant(scenarios: &[&str]) {
    let mut found = Vec::new();
    for text in scenarios {
        let record = run(text, ONE).unwrap();
        for scale in ALL {
            match run(text, scale) {
                Ok(scaled) => found.extend(
                    differences(&record, &scaled, scale, text.contains("half_space"))
                        .into_iter()
                        .map(|what| format!("{scale:?} {what}\n{text}")),
                ),
                Err(error) => found.push(format!("{scale:?} {error}")),
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Contacts of Gaussian thresholds, with what follows.
macro_rules! contacts {
    ($($rest:expr),*) => {
        concat!(
            "[contacts]\nstiffness = 1_k\nthresholds.gaussian = { mean = 1_m, std = 0.1_m }\n",
            $($rest, "\n"),*
        )
    };
}

const LOGARITHMIC: &str = "ageing.logarithmic = { growth = 0.02, time = 1_s }";

#[test]
fn pulls_have_no_scale() {
    let laws = [
        "gaussian = { mean = 1_m, std = 0.1_m }",
        "rectangular = { min = 0.7_m, max = 1.3_m }",
        "gamma = { mean = 1_m, std = 0.4_m }",
        "weibull = { shape = 2.5, scale = 1_m }",
        "lognormal = { mean = 1_m, std = 0.3_m }",
        "exponential = { mean = 1_m }",
        "point = { at = 1_m }",
    ];
    for law in laws {
        for reforming in ["", "reforming.rectangular = { min = 0.0, max = 0.3_m }\n"] {
            invariant(&[&format!(
                "[contacts]\nstiffness = 1_k\nthresholds.{law}\n{reforming}[pull]\ndistance = 4_m\npoints = 41\n\
                 snapshots = [ 1_m, 2.5_m ]\n[ensemble]\nsize = 100\n"
            )]);
        }
    }
}

#[test]
fn other_pulls_have_no_scale() {
    invariant(&[
        contacts!(
            "[pull]",
            "distance = 4_m",
            "points = 41",
            "[ensemble]",
            "size = 100",
            "disorder = 'quenched'"
        ),
        contacts!(
            "[initial]",
            "rectangular = { min = 0.0, max = 1.2_m }",
            "[pull]",
            "distance = 4_m",
            "start = 'relaxed'"
        ),
        "[contacts]\nstiffness_per_threshold = 1_P\nthresholds.gaussian = { mean = 1_m, std = 0.1_m }\n[pull]\ndistance = 4_m\n",
    ]);
}

#[test]
fn blocks_have_no_scale() {
    let slips = [
        "'reset'",
        "'overdamped'",
        "'arrest'",
        "{ inertial = { mass = 1_M } }",
        "{ inertial = { mass = 1_M, damping = 0.3_e } }",
    ];
    for slip in slips {
        for ensemble in ["", "[ensemble]\nsize = 500\n"] {
            invariant(&[&format!(
                "{}[block]\nstiffness = 0.5_k\nslip = {slip}\n[drive]\ndistance = 6_m\npoints = 51\n{ensemble}",
                contacts!()
            )]);
        }
    }
    invariant(&[contacts!(
        "[block]",
        "stiffness = 5_k",
        "[drive]",
        "turning_points = [ 3_m, -2_m, 2_m ]",
        "[ensemble]",
        "size = 500"
    )]);
}

#[test]
fn interfaces_have_no_scale() {
    for cells in ["12", "5, 6"] {
        for edges in ["open", "periodic"] {
            for coupling in ["neighbours = { stiffness = 1_k }", "half_space = { modulus = 1_P, cell = 1_m }"]
            {
                for rest in ["slip = 'reset'\n", "slip = 'overdamped'\nviscosity = 1_e\n"] {
                    invariant(&[&format!(
                        "{}[interface]\ncells = [{cells}]\nedges = '{edges}'\nconnection = 0.4_k\ncoupling.{coupling}\n\
                         {rest}disorder.std = 0.05\n[drive]\ndistance = 3_m\npoints = 11\n",
                        contacts!()
                    )]);
                }
            }
        }
    }
    invariant(&[
        contacts!(
            "[interface]",
            "cells = [4]",
            "connection = 0.4_k",
            "coupling.neighbours = { stiffness = 1_k }",
            "slip = 'overdamped'",
            "[drive]",
            "distance = 3_m",
            "[ensemble]",
            "size = 20"
        ),
        contacts!(
            "[interface]",
            "cells = [8, 8]",
            "contacts = 'one'",
            "connection = 0.2_k",
            "coupling.neighbours = { stiffness = 0.2_k }",
            "[drive]",
            "distance = 3_m"
        ),
        contacts!(
            "[interface]",
            "cells = [16, 16]",
            "contacts = 'one'",
            "connection = 0.9_k",
            "edges = 'periodic'",
            "coupling.neighbours = { stiffness = 0.025_k }",
            "[renormalisation]",
            "runs = 2"
        ),
        contacts!(
            "[interface]",
            "cells = [8]",
            "connection = 9_k",
            "coupling.neighbours = { stiffness = 0.1_k }",
            "disorder.std = 0.05",
            "[renormalisation]",
            "runs = 2"
        ),
    ]);
}

#[test]
fn motion_in_time_has_no_scale() {
    let rules = [
        "temperature = { energy = 0.05_J, attempt_rate = 1_Hz, barrier = 'elastic' }",
        "temperature = { energy = 0.05_J, attempt_rate = 1_Hz, barrier = 'catastrophe' }",
        "delay = { time = 0.3_s }",
        LOGARITHMIC,
        "ageing.frozen_rank = { mature.gaussian = { mean = 1.2_m, std = 0.05_m }, time = 1_s }",
    ];
    for rule in rules {
        let contacts = format!("{}{rule}\n", contacts!());
        invariant(&[
            &format!("{contacts}[velocity_curve]\nfrom = 1e-2_v\nto = 1_v\npoints = 2\n"),
            &format!(
                "{contacts}[pull]\ndistance = 2_m\npoints = 21\nvelocity = 0.1_v\n[ensemble]\nsize = 50\n"
            ),
            &format!(
                "{contacts}[[protocol]]\nvelocity = 0.1_v\ndistance = 1_m\npoints = 11\n[[protocol]]\nvelocity = 0_v\n\
                 duration = 2_s\npoints = 3\n[master_equation]\ntolerance = 1e-4\n[ensemble]\nsize = 50\n"
            ),
        ]);
    }
}

#[test]
fn sliders_in_time_have_no_scale() {
    let ageing = format!("{}{LOGARITHMIC}\n", contacts!());
    invariant(&[
        &format!(
            "{ageing}[hold_curve]\nvelocity = 0.1_v\nfrom = 1_s\nto = 100_s\npoints = 2\n[master_equation]\ntolerance = 1e-2\n[ensemble]\nsize = 50\n"
        ),
        &format!(
            "{ageing}[block]\nstiffness = 0.5_k\nslip.damped = {{ damping = 0.5_e }}\n[[protocol]]\nvelocity = 1e-2_v\ndistance = 3_m\npoints = 11\n[master_equation]\ntolerance = 1e-2\n"
        ),
        &format!(
            "{ageing}[interface]\ncells = [3]\nconnection = 0.4_k\ncoupling.neighbours = {{ stiffness = 1_k }}\nslip = 'overdamped'\nviscosity = 1_e\n[drive]\ndistance = 2_m\nvelocity = 0.01_v\npoints = 5\n[ensemble]\nsize = 20\n"
        ),
    ]);
}
