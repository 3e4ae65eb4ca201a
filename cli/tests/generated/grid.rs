//! Distributions × tasks × temperatures × rules of ageing: each combination ends with results or a reason, or is at work within
//! its memory, reports when it will be done, and stops when it is asked to.

use std::path::Path;

use asperity::scenario::{Law, Task};
use toml::{Table, Value};

use super::child::{self, Limits};
use super::distributions::{VARIATIONS, parameters};
use super::random::SplitMix;
use super::verdict;

/// Seconds of the processor, which no run reaches that stops in time, and addresses: 500 MB, and what the allocator sets aside for
/// each of four threads, 64 MiB.
const LIMITS: Limits = Limits { seconds: 180, bytes: 500_000_000 + (4 << 26), patience: None };

/// Seconds of wall time after which a run gives up that gets too little of the processor to be interrupted before.
const STOPPED: &str = "--max-time=15min";

const DISTRIBUTIONS: &[&str] = Law::NAMES;

/// Energies T, of contacts that a barrier of about ½ holds; 0 for no temperature.
const ENERGIES: [f64; 5] = [0.0, 1e-6, 1e-3, 0.05, 1.0];

const AGEINGS: [(&str, &str); 5] = [
    ("no ageing", ""),
    ("logarithmic", "ageing.logarithmic = { growth = 0.1, time = 1.0 }"),
    ("frozen_rank", "ageing.frozen_rank = { time = 1.0, mature.gaussian = { mean = 1.5, std = 0.2 } }"),
    (
        "smoluchowski",
        "ageing.smoluchowski = { diffusion = 0.01, mature.gaussian = { mean = 1.5, std = 0.2 } }",
    ),
    ("mean_field", "ageing.mean_field = { diffusion = 0.01, mature.gaussian = { mean = 1.5, std = 0.2 } }"),
];

/// Tasks of contacts without time dependence, and the tasks in their place for time-dependent contacts.
const TASKS: [(&str, &str, &str); 12] = [
    (
        "pull",
        "pull = { distance = 3.0, points = 21, snapshots = [1.0] }",
        "pull = { distance = 3.0, points = 21, snapshots = [1.0], velocity = 0.1 }",
    ),
    (
        "pull beside an ensemble",
        "pull = { distance = 3.0, points = 21 }\nensemble.size = 500",
        "pull = { distance = 3.0, points = 21, velocity = 0.1 }\nensemble.size = 500",
    ),
    (
        "drive of a block",
        "block = { stiffness = 0.3, slip = 'overdamped' }\ndrive = { distance = 3.0, points = 21 }",
        "block = { stiffness = 0.3, slip.inertial = { mass = 1.0, damping = 0.5 } }\n\
         drive = { distance = 3.0, points = 21, velocity = 0.1 }",
    ),
    (
        "drive of an interface",
        "interface = { cells = [4, 4], connection = 0.3, coupling.neighbours.stiffness = 1.0, slip = 'overdamped' }\n\
         drive = { distance = 3.0, points = 21 }",
        "interface = { cells = [4, 4], connection = 0.3, coupling.neighbours.stiffness = 1.0, slip = 'overdamped', \
         viscosity = 1.0 }\ndrive = { distance = 3.0, points = 21, velocity = 0.1 }",
    ),
    ("protocol", PROTOCOL, PROTOCOL),
    ("protocol of a block", PROTOCOL_OF_A_BLOCK, PROTOCOL_OF_A_BLOCK),
    ("velocity curve", VELOCITY_CURVE, VELOCITY_CURVE),
    ("stability", STABILITY, STABILITY),
    ("hold curve", HOLD_CURVE, HOLD_CURVE),
    ("spectrum", "spectrum = { points = 21 }", "spectrum = { points = 21, velocity = 0.1 }"),
    (
        "stick-slip",
        "block = { stiffness = 0.3, slip = 'arrest' }\nstability.resolution = 0.5",
        "block = { stiffness = 0.3, slip.inertial = { mass = 1.0, damping = 0.5 } }\n\
         stability = { velocities = [0.1], resolution = 0.5 }",
    ),
    ("renormalisation", RENORMALISATION, RENORMALISATION),
];

const PROTOCOL: &str = "protocol = [{ velocity = 0.1, distance = 1.5, points = 11 }, { hold = 2.0, points = 3 }, \
                        { velocity = 1.0, distance = 1.5, points = 11 }]";
const PROTOCOL_OF_A_BLOCK: &str = "block = { stiffness = 0.3, slip.inertial = { mass = 1.0, damping = 0.5 } }\n\
                                   protocol = [{ velocity = 0.1, distance = 3.0, points = 21 }]";
const VELOCITY_CURVE: &str = "velocity_curve = { from = 1e-2, to = 1.0, points = 3 }";
const STABILITY: &str = "velocity_curve = { from = 1e-2, to = 1.0, points = 2, stability = true }";
const HOLD_CURVE: &str = "hold_curve = { from = 0.1, to = 10.0, points = 2, velocity = 0.1 }";
const RENORMALISATION: &str = "interface = { cells = [4, 4], contacts = 'one', connection = 0.5, \
                               coupling.neighbours.stiffness = 0.2 }\nrenormalisation.runs = 2";

/// How many combinations there are.
pub const COUNT: u64 = (DISTRIBUTIONS.len() * TASKS.len() * ENERGIES.len() * AGEINGS.len()) as u64;

/// A combination.
pub struct Combination {
    /// Which one it is.
    pub number: u64,
    /// What it is of.
    pub name: String,
    /// Its scenario.
    pub text: String,
}

impl Combination {
    /// The combination of a number below [`COUNT`].
    pub fn of(number: u64) -> Self {
        let mut left = number as usize;
        let mut next = |count: usize| {
            let taken = left % count;
            left /= count;
            taken
        };
        let (energy, ageing) = (ENERGIES[next(ENERGIES.len())], AGEINGS[next(AGEINGS.len())]);
        let (task, family) = (TASKS[next(TASKS.len())], DISTRIBUTIONS[next(DISTRIBUTIONS.len())]);
        let mut random = SplitMix::new(number);
        let variation = *random.pick(&VARIATIONS);
        let law = parameters(family, 1.0, variation, &mut random);
        let thresholds = Table::from_iter([(family.to_owned(), law)]);
        let contacts = Table::from_iter([("thresholds".to_owned(), Value::Table(thresholds))]);
        let whole = Table::from_iter([("contacts".to_owned(), Value::Table(contacts))]);
        let time_dependent = energy > 0.0 || !ageing.1.is_empty();
        // Keys come before tables, and those of tables that are not closed yet go with them.
        let mut text = format!("{}\n", if time_dependent { task.2 } else { task.1 });
        if energy > 0.0 {
            text += &format!("contacts.temperature = {{ energy = {energy:e}, attempt_rate = 1.0 }}\n");
        }
        if !ageing.1.is_empty() {
            text += &format!("contacts.{}\n", ageing.1);
        }
        let mut scenario: Table = text.parse().expect("TOML");
        merge(&mut scenario, whole);
        Self {
            number,
            name: format!(
                "{family} of coefficient of variation {variation}, {}, T = {energy}, {}",
                task.0, ageing.0
            ),
            text: toml::to_string(&scenario).expect("a table of plain values"),
        }
    }

    /// Runs it; what should not have happened, and the seconds that it took.
    pub fn judged(&self, patience: f64) -> (Vec<String>, f64) {
        let [folder, aside] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
        std::fs::write(folder.path().join("scenario.toml"), &self.text).expect("the scenario is written");
        let run =
            verdict::run(folder.path(), aside.path(), Limits { patience: Some(patience), ..LIMITS }, STOPPED);
        let mut failures = run.failures;
        if matches!(run.ended.code(), Some(1 | 2)) && !names_a_key(&run.ended.errors) {
            failures.push(format!("no key is named: {}", run.ended.errors.trim()));
        }
        if run.ended.code() == Some(130) && !is_soon_done(&run.ended.errors, run.ended.seconds) {
            failures.push(format!("when it would be done: {}", run.ended.errors.trim()));
        }
        if !failures.is_empty() {
            keep(self, &failures);
        }
        (failures, run.ended.seconds)
    }
}

/// Whether less than a day is left where the last line of a log is `1.5 % after 10 s, about 12 min 3 s left`: by the part done in these
/// seconds of the processor, since on a busy machine the line counts the seconds of others.
fn is_soon_done(log: &str, seconds: f64) -> bool {
    const DAY: f64 = 86_400.0;
    let line = log.lines().rev().find_map(|line| line.split_once(" % after "));
    let done = line.and_then(|(part, _)| part.trim().parse::<f64>().ok());
    done.is_some_and(|percent| seconds * (100.0 / percent - 1.0) < DAY)
}

/// Whether a message begins with the path of a key, as `× contacts.temperature.energy: …`.
fn names_a_key(message: &str) -> bool {
    let others = ["contacts", "initial", "block", "interface", "ensemble", "master_equation"];
    Task::NAMES
        .iter()
        .chain(&others)
        .any(|table| message.contains(&format!(" {table}.")) || message.contains(&format!(" {table}:")))
}

fn merge(into: &mut Table, from: Table) {
    for (key, value) in from {
        match (into.get_mut(&key), value) {
            (Some(Value::Table(into)), Value::Table(from)) => merge(into, from),
            (_, value) => {
                into.insert(key, value);
            }
        }
    }
}

/// Writes what failed to `target/fuzz`, for whoever looks into it.
fn keep(combination: &Combination, failures: &[String]) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../fuzz");
    let reasons: String =
        failures.iter().map(|reason| format!("# {}\n", reason.replace('\n', "\n# "))).collect();
    let write = || {
        std::fs::create_dir_all(&folder)?;
        let name = format!("grid-{}.toml", combination.number);
        std::fs::write(folder.join(name), format!("# {}\n{reasons}{}", combination.name, combination.text))
    };
    write().unwrap_or_else(|error: std::io::Error| println!("{}: {error}", folder.display()));
}

/// Judges combinations on as many threads as there are, each of which is asked to stop after so many seconds of the processor; what
/// should not have happened.
pub fn judge(numbers: &[u64], patience: f64) -> Vec<String> {
    child::shared(numbers, |&number| {
        let combination = Combination::of(number);
        let (failures, seconds) = combination.judged(patience);
        let reported = format!("{number}, {}, {seconds:.1} s", combination.name);
        println!("{reported}{}{}", if failures.is_empty() { "" } else { ": " }, failures.join("; "));
        (!failures.is_empty()).then(|| format!("{reported}: {}", failures.join("; ")))
    })
}
