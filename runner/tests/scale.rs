//! Units do not matter: lengths, forces and times that are 10^±30 times as large, or more, give the same numbers.

#[path = "scale/units.rs"]
mod units;

use std::path::{Path, PathBuf};

use asperity::record::{Quantity, Record};
use asperity::scenario::{Scenario, Task};
use asperity_runner::input;
use asperity_runner::sweep::Summaries;
use serde_json::Value;

/// Roundings of a closed form, a root or a convolution of order 1, some hundred times 2^−53: of the largest value of a column.
/// Most columns are the same to the last bit, as powers of two multiply without rounding.
const ROUNDING: f64 = 1e-13;

/// The same where thresholds mature or diffuse: logarithms of densities, down to −645, are computed by series, and hazards by
/// their slopes.
const ROUNDING_OF_POTENTIALS: f64 = 2e-12;

/// Factors of lengths, forces and times.
#[derive(Debug, Clone, Copy)]
struct Scale {
    length: f64,
    force: f64,
    time: f64,
}

const ONE: Scale = Scale { length: 1.0, force: 1.0, time: 1.0 };

/// 2^100 = 10^30.
const FACTOR: f64 = (1_u128 << 100) as f64;
/// 2^50, by which the three factors differ so that no product of quantities is left as it was.
const MORE: f64 = (1_u64 << 50) as f64;
/// 2^70.
const STILL_MORE: f64 = (1_u128 << 70) as f64;

const ALL: [Scale; 2] = [
    Scale { length: FACTOR, force: 1.0 / FACTOR / MORE, time: FACTOR * STILL_MORE },
    Scale { length: 1.0 / FACTOR, force: FACTOR * MORE, time: 1.0 / FACTOR / STILL_MORE },
];

/// Numbers of a summary, and what they measure.
const QUOTED: [(&str, Quantity); 37] = [
    ("/kinetic_friction", Quantity::Force),
    ("/static_friction/force", Quantity::Force),
    ("/static_friction/position", Quantity::Length),
    ("/relaxation_length", Quantity::Length),
    ("/relaxation_length_paper", Quantity::Length),
    ("/critical_stiffness", Quantity::Stiffness),
    ("/slips", Quantity::Number),
    ("/period", Quantity::Length),
    ("/mean_drop", Quantity::Force),
    ("/mean_slip", Quantity::Length),
    ("/first_instability/position", Quantity::Length),
    ("/first_instability/force", Quantity::Force),
    ("/steps/0/peak/force", Quantity::Force),
    ("/steps/1/force", Quantity::Force),
    ("/limits/0/fast", Quantity::Force),
    ("/limits/0/slow", Quantity::Force),
    ("/stability/critical_stiffness_sliding", Quantity::Stiffness),
    ("/stick_slip/0/persistent_stiffness", Quantity::Stiffness),
    ("/stick_slip/0/critical_stiffness", Quantity::Stiffness),
    ("/stick_slip/0/mean_drop", Quantity::Force),
    ("/stick_slip/0/ensemble/mean_drop", Quantity::Force),
    ("/stick_slip/0/ensemble/persistent_stiffness", Quantity::Stiffness),
    ("/stick_slip/0/critical_stiffness_sliding", Quantity::Stiffness),
    ("/hold_curve/healing_per_decade", Quantity::Force),
    ("/hold_curve/healing_cutoff", Quantity::Time),
    ("/creep/0/failure_time", Quantity::Time),
    ("/creep/0/final_position", Quantity::Length),
    ("/creep/1/final_velocity", Quantity::Velocity),
    ("/catalogue/mean_waiting", Quantity::Length),
    ("/catalogue/events", Quantity::Number),
    ("/noise/force_std", Quantity::Force),
    ("/noise/mean_life", Quantity::Length),
    ("/noise/at_zero", Quantity::ForceSquaredLength),
    ("/noise/tail", Quantity::Stiffness),
    ("/renormalisation/mean/value", Quantity::Length),
    ("/renormalisation/std/value", Quantity::Length),
    ("/renormalisation/coupling", Quantity::Number),
];

impl Scale {
    /// What a quantity is multiplied by.
    fn of(self, quantity: Quantity) -> f64 {
        let Self { length, force, time } = self;
        match quantity {
            Quantity::Length => length,
            Quantity::Force => force,
            Quantity::ForceSquared => force * force,
            Quantity::ForceSquaredLength => force * force * length,
            Quantity::PerLength => 1.0 / length,
            Quantity::Stiffness => force / length,
            Quantity::Energy => force * length,
            Quantity::Area => length * length,
            Quantity::Volume => length * length * length,
            Quantity::Time => time,
            Quantity::Velocity => length / time,
            Quantity::PerTime => 1.0 / time,
            Quantity::Number | Quantity::Count | Quantity::Flag => 1.0,
            other => panic!("no factor is known of a {}", other.name()),
        }
    }

    /// A scenario in which `3 m` is the length 3: numbers are followed by their units.
    ///
    /// m: length, N: force, s: time, J: energy, k: stiffness, v: velocity, Hz: per time, D: length² per time, P: force per
    /// length², e: force per velocity, M: force per acceleration, i: per length, A: length².
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
            ("i", 1.0 / length),
            ("A", length * length),
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

/// The columns of a run, and its summary.
fn run(text: &str, scale: Scale) -> Result<(Record, Value), String> {
    let text = scale.scenario(text);
    let parsed = input::parse(&text, "test", Path::new(""), &[]).map_err(|e| format!("{e}\n{text}"))?;
    computed(&parsed.scenario).map_err(|e| format!("{e}\n{text}"))
}

fn computed(scenario: &Scenario) -> Result<(Record, Value), String> {
    let outcome = asperity_runner::run(scenario, &mut ()).map_err(|e| e.to_string())?;
    let summary = serde_json::to_value(&outcome.summary).expect("a summary is JSON");
    Ok((outcome.record, summary))
}

/// By how much two rows of numbers differ, of the largest of them: the worst pair.
fn worst(values: &[f64], others: &[f64], factor: f64) -> (f64, f64, f64) {
    let most = values.iter().filter(|x| x.is_finite()).fold(0.0_f64, |most, x| most.max(x.abs()));
    let off = |(x, y): (&f64, &f64)| {
        let y = y / factor;
        let same = x.to_bits() == y.to_bits() || (x.is_nan() && y.is_nan());
        let off = if same { 0.0 } else { (x - y).abs() / most };
        (if off.is_nan() { f64::INFINITY } else { off }, *x, y)
    };
    let pairs = values.iter().zip(others).map(off);
    pairs.fold((0.0, 0.0, 0.0), |worst, off| if off.0 > worst.0 { off } else { worst })
}

/// The rounding of a column.
fn rounding_of(name: &str, rounding: f64) -> f64 {
    // A root of a difference: where all contacts are alike it is that of rounding.
    if name == "force_std" { rounding.sqrt() } else { rounding }
}

/// What differs by more than a `rounding`.
fn differences(record: &Record, scaled: &Record, scale: Scale, rounding: f64) -> Vec<String> {
    let mut found = Vec::new();
    for variable in &record.variables {
        let Some(other) = scaled.get(&variable.name).filter(|o| o.values.len() == variable.values.len())
        else {
            let length = scaled.get(&variable.name).map(|other| other.values.len());
            let (name, expected) = (&variable.name, variable.values.len());
            found.push(format!("{name}: {length:?} values instead of {expected}"));
            continue;
        };
        let (off, x, y) = worst(&variable.values, &other.values, scale.of(variable.quantity));
        if off > rounding_of(&variable.name, rounding) {
            found.push(format!("{}: {y} instead of {x}, off by {off:.1e}", variable.name));
        }
    }
    found
}

/// The same of a summary.
fn quoted_differences(
    quoted: &[(impl AsRef<str>, Quantity)],
    (summary, scaled): (&Value, &Value),
    scale: Scale,
    rounding: f64,
) -> Vec<String> {
    let mut found = Vec::new();
    for (path, quantity) in quoted {
        let path = path.as_ref();
        let (value, other) = (summary.pointer(path), scaled.pointer(path));
        let off = match (value.and_then(Value::as_f64), other.and_then(Value::as_f64)) {
            (Some(x), Some(y)) => worst(&[x], &[y], scale.of(*quantity)).0,
            _ if value == other => 0.0,
            _ => f64::INFINITY,
        };
        if off > rounding {
            found.push(format!("{path}: {other:?} instead of {value:?}, off by {off:.1e}"));
        }
    }
    found
}

/// The same numbers at any scale, to a `rounding`.
#[track_caller]
fn invariant_to(rounding: f64, scenarios: &[&str]) {
    let mut found = Vec::new();
    for text in scenarios {
        let (record, summary) = run(text, ONE).unwrap();
        for scale in ALL {
            match run(text, scale) {
                Ok((scaled, quoted)) => found.extend(
                    differences(&record, &scaled, scale, rounding)
                        .into_iter()
                        .chain(quoted_differences(&QUOTED, (&summary, &quoted), scale, rounding))
                        .map(|what| format!("{scale:?} {what}\n{text}")),
                ),
                Err(error) => found.push(format!("{scale:?} {error}")),
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The same numbers at any scale, to roundings.
#[track_caller]
fn invariant(scenarios: &[&str]) {
    invariant_to(ROUNDING, scenarios);
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
        "tabulated = { stretch = [ 0.5_m, 1_m, 1.5_m ], density = [ 0_i, 2_i, 0_i ] }",
        "tabulated = { samples = [ 0.8_m, 1_m, 1.3_m, 1.4_m ] }",
        "tabulated = { samples = [ 0.8_m, 1_m, 1.3_m, 1.4_m ], bandwidth = 0.1_m }",
        "tabulated = { samples = [ 0.8_m, 1_m, 1.3_m, 1.4_m ], exact = true }",
        "mixture = [ { weight = 0.5, law.gaussian = { mean = 1_m, std = 0.1_m } }, { weight = 0.5, law.point.at = 2_m } ]",
        "renormalised = { law.gaussian = { mean = 1_m, std = 0.3_m }, coupling = 0.2 }",
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
fn noise_has_no_scale() {
    for reforming in ["", "reforming.rectangular = { min = 0.0, max = 0.3_m }\n"] {
        let contacts = format!(
            "[contacts]\nstiffness = 1_k\ncount = 100.0\nthresholds.gaussian = {{ mean = 1_m, std = 0.1_m }}\n{reforming}"
        );
        invariant(&[
            &format!("{contacts}[spectrum]\npoints = 21\n[ensemble]\nsize = 20\n"),
            &format!("{contacts}[spectrum]\npoints = 21\nhighest = 20_i\ndisplacement = 3_m\n"),
        ]);
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
        "[contacts]\nareas = { law.gamma = { mean = 1_A, std = 0.4_A }, modulus = 2_P, strength = 3_P }\n[pull]\ndistance = 4_m\n",
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

/// The rules that make contacts time-dependent.
const RULES: [&str; 8] = [
    "temperature = { energy = 0.05_J, attempt_rate = 1_Hz, barrier = 'elastic' }",
    "temperature = { energy = 0.05_J, attempt_rate = 1_Hz, barrier = 'bell' }",
    "temperature = { energy = 0.05_J, attempt_rate = 1_Hz, barrier = 'catastrophe' }",
    "delay = { time = 0.3_s }",
    LOGARITHMIC,
    "ageing.frozen_rank = { mature.gaussian = { mean = 1.2_m, std = 0.05_m }, time = 1_s }",
    "ageing.frozen_rank = { mature.gamma = { mean = 1.2_m, std = 0.2_m }, time = 1_s }",
    "ageing.smoluchowski = { mature.gaussian = { mean = 1.2_m, std = 0.1_m }, diffusion = 0.01_D }",
];

/// That of contacts under a rule.
fn rounding(rule: &str) -> f64 {
    if rule.contains("mature") { ROUNDING_OF_POTENTIALS } else { ROUNDING }
}

#[test]
fn motion_in_time_has_no_scale() {
    for rule in RULES {
        let contacts = format!("{}{rule}\n", contacts!());
        invariant_to(
            rounding(rule),
            &[
                &format!(
                    "{contacts}[pull]\ndistance = 2_m\npoints = 21\nvelocity = 0.1_v\n[ensemble]\nsize = 50\n"
                ),
                &format!(
                    "{contacts}[[protocol]]\nvelocity = 0.1_v\ndistance = 1_m\npoints = 11\n[[protocol]]\nvelocity = 0_v\n\
                 duration = 2_s\npoints = 3\n[master_equation]\ntolerance = 1e-4\n[ensemble]\nsize = 50\n"
                ),
            ],
        );
    }
}

#[test]
fn velocity_curves_have_no_scale() {
    let curve = "[velocity_curve]\nfrom = 1e-2_v\nto = 1_v\npoints = 2\n";
    for rule in RULES {
        let contacts = format!("{}{rule}\n", contacts!());
        invariant_to(rounding(rule), &[&format!("{contacts}{curve}")]);
    }
    let mean_field =
        "ageing.mean_field = { mature.gaussian = { mean = 1.2_m, std = 0.1_m }, diffusion = 0.01_D }";
    invariant(&[&format!("{}{}\n{curve}temperatures = [ 0.02_J, 0.05_J ]\n", contacts!(), RULES[0])]);
    invariant_to(rounding(mean_field), &[&format!("{}{mean_field}\n{curve}", contacts!())]);
}

#[test]
fn stability_has_no_scale() {
    let curve = "[velocity_curve]\nfrom = 0.5_v\nto = 1_v\npoints = 2\nstability = true\n";
    let block = "[block]\nstiffness = 0.5_k\nslip.inertial = { mass = 1_M, damping = 0.3_e }\n";
    invariant(&[&format!("{}{LOGARITHMIC}\n{block}{curve}", contacts!())]);
    let task = "[stability]\nresolution = 1.0\nstiffnesses = [ 0.3_k, 0.6_k ]\n";
    let arrest = "[block]\nstiffness = 0.5_k\nslip = 'arrest'\n";
    invariant(&[
        &format!("{}{LOGARITHMIC}\n{block}{task}velocities = [ 0.5_v ]\n", contacts!()),
        &format!("{}\n{arrest}{task}", contacts!()),
        &format!("{}\n{arrest}{task}simulations = 2\n[ensemble]\nsize = 500\n", contacts!()),
    ]);
}

#[test]
fn sliders_in_time_have_no_scale() {
    let ageing = format!("{}{LOGARITHMIC}\n", contacts!());
    let block = "[block]\nstiffness = 0.5_k\n";
    let steps =
        "[[protocol]]\nvelocity = 1e-2_v\ndistance = 3_m\npoints = 11\n[master_equation]\ntolerance = 1e-2\n";
    let cells = "[interface]\ncells = [3]\nconnection = 0.4_k\nslip = 'overdamped'\nviscosity = 1_e\n";
    let drive = "[drive]\ndistance = 2_m\nvelocity = 0.01_v\npoints = 5\n";
    invariant(&[
        &format!(
            "{ageing}[hold_curve]\nvelocity = 0.1_v\nfrom = 1_s\nto = 100_s\npoints = 2\n[master_equation]\ntolerance = 1e-2\n[ensemble]\nsize = 50\n"
        ),
        // Panels of steady sliding are halved where many contacts break together.
        &format!(
            "[contacts]\nthresholds.point.at = 1_m\nstiffness = 1_k\n{LOGARITHMIC}\n[hold_curve]\nvelocity = 0.1_v\nfrom = 1_s\nto = 10_s\npoints = 2\n[master_equation]\ntolerance = 1e-3\n"
        ),
        &format!(
            "{}temperature = {{ energy = 0.03_J, attempt_rate = 1_Hz }}\n[creep]\nforces = [ 0.6_N, 0.3_N ]\nduration = 1e3_s\npoints = 5\n[master_equation]\ntolerance = 1e-2\n",
            contacts!()
        ),
        &format!("{ageing}{block}slip.damped = {{ damping = 0.5_e }}\n{steps}"),
        &format!("{ageing}{block}slip.inertial = {{ mass = 1_M, damping = 0.5_e }}\n{steps}"),
        &format!("{ageing}{block}slip.damped = {{ damping = 0.5_e }}\n{drive}[ensemble]\nsize = 50\n"),
        &format!("{ageing}{drive}"),
        &format!(
            "{ageing}{cells}coupling.neighbours = {{ stiffness = 1_k }}\n{drive}[ensemble]\nsize = 20\n"
        ),
        &format!(
            "{ageing}{cells}coupling.half_space = {{ modulus = 1_P, cell = 1_m }}\n{drive}[master_equation]\ntolerance = 1e-2\n"
        ),
    ]);
}

#[test]
fn imposed_forces_have_no_scale() {
    let force = "[drive]\nforce_to = 0.9_N\npoints = 51\n";
    for ensemble in ["", "[ensemble]\nsize = 500\n"] {
        invariant(&[&format!("{}{force}{ensemble}", contacts!())]);
    }
}

/// What makes shipped scenarios short.
const SHORTER: [(&str, &[&str]); 5] = [
    ("creep", &["creep.forces=[0.65, 0.7]", "creep.points=5"]),
    ("healing", &["hold_curve.points=2", "ensemble.size=50"]),
    ("renormalised", &["interface.cells=[8, 8]", "renormalisation.runs=2"]),
    (
        "stability",
        &["stability.velocities=[1e-2]", "stability.stiffnesses=[0.1]", "stability.resolution=1.0"],
    ),
    ("velocity-curve-delay", &["velocity_curve.points=2"]),
];

/// The shortest file of a shipped scenario with a task.
fn shortest(task: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let text = |path: &PathBuf| std::fs::read_to_string(path).unwrap_or_default();
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| {
        text(path).lines().any(|line| line.trim_matches(['[', ']']) == task && line.starts_with('['))
    });
    paths
        .into_iter()
        .min_by_key(|path| text(path).len())
        .unwrap_or_else(|| panic!("no scenario has [{task}]"))
}

/// The numbers of a summary whose dimension is declared: their paths, and what they measure.
fn declared(scenario: &Scenario, summary: &Value) -> Vec<(String, Quantity)> {
    let known = Summaries::new(scenario).unwrap();
    let mut found = Vec::new();
    numbers("", summary, &mut found);
    let measured = |path: String| {
        Some((path.clone(), known.find(&path.replacen('/', "", 1).replace('/', "."))?.quantity?))
    };
    found.into_iter().filter_map(measured).collect()
}

/// The pointers to all numbers below a value.
fn numbers(path: &str, value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(keys) => {
            keys.iter().for_each(|(key, value)| numbers(&format!("{path}/{key}"), value, found))
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| numbers(&format!("{path}/{i}"), item, found));
        }
        Value::Number(_) => found.push(path.to_owned()),
        _ => {}
    }
}

#[test]
fn no_task_has_a_scale() {
    // A fit reads numbers from files.
    for task in Task::NAMES.iter().filter(|task| **task != "fit") {
        let path = shortest(task);
        let shorter = SHORTER.iter().find(|(name, _)| path.file_stem().unwrap() == *name);
        let overrides: Vec<String> =
            shorter.into_iter().flat_map(|(_, set)| *set).map(ToString::to_string).collect();
        let scenario = input::read(&path, &overrides).unwrap().scenario;
        let (record, summary) = computed(&scenario).unwrap();
        let quoted = declared(&scenario, &summary);
        assert!(!quoted.is_empty(), "{task}: no number of the summary has a dimension");
        for scale in ALL {
            let (scaled, other) = computed(&scale.of_scenario(&scenario)).unwrap();
            let mut found = differences(&record, &scaled, scale, ROUNDING_OF_POTENTIALS);
            found.extend(quoted_differences(&quoted, (&summary, &other), scale, ROUNDING_OF_POTENTIALS));
            assert!(found.is_empty(), "{}: {scale:?}\n{}", path.display(), found.join("\n"));
        }
    }
}
