//! Cost of a stick-slip trace over the master equation, and of a break under the block: a table, against log N.

#![allow(missing_docs)]

use std::hint::black_box;
use std::sync::Arc;

use asperity::block::{Block, Drive, Loading, Slip, StickSlip};
use asperity::contacts::{Contacts, Initial, Start, Stiffness};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::law::{Gaussian, Point, SharedLaw};
use asperity::master::MasterEquation;
use asperity::population::Population;
use cpu_time::ThreadTime;

/// Periods of the persistent trace.
const PERIODS: f64 = 1000.0;

/// Period of resets at σ = 0.1, K = 1.
const PERIOD: f64 = 1.666_198_355_430;

/// Breaks timed, or as many as there are contacts.
const BREAKS: f64 = 4e6;

fn main() {
    trace();
    breaks();
}

fn contacts() -> (Contacts, Initial) {
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let thresholds = Arc::new(Gaussian::new(1.0, 0.1).unwrap());
    let stiffness = Stiffness::Equal(1.0);
    let contacts = Contacts { stiffness, ..Contacts::new(thresholds, relaxed.clone()) };
    (contacts, Initial { law: relaxed, start: Start::Conditional })
}

fn pull(
    population: &mut dyn Population,
    slip: Slip,
    fraction: Option<f64>,
    distance: f64,
) -> (StickSlip, f64) {
    let block = Block::new(Loading::Spring(1.0), slip, fraction).unwrap();
    let drive = Drive { turning_points: vec![distance], points: 1001 };
    let begun = ThreadTime::now();
    let run = block.pull(population, &drive).unwrap();
    (run, begun.elapsed().as_secs_f64())
}

/// Resets for ever, over the master equation.
fn trace() {
    let (contacts, initial) = contacts();
    let equation = MasterEquation::new(contacts, &initial).unwrap();
    let times = (0..5).map(|_| {
        let mut population = equation.population_with(1e-10, &mut ()).unwrap();
        let (run, time) = pull(&mut population, Slip::Reset, None, (PERIODS + 0.5) * PERIOD);
        assert_eq!(run.events.len(), PERIODS as usize);
        black_box(run);
        time
    });
    let least = times.fold(f64::INFINITY, f64::min);
    println!("{PERIODS} periods of resets over the master equation: {:.1} ms of CPU time", 1e3 * least);
}

/// Breaks of an ensemble, the block's share included, by rule.
fn breaks() {
    let damped = Slip::Inertial { mass: 1.0, damping: 0.5 };
    let undamped = Slip::Inertial { mass: 1.0, damping: 0.0 };
    let rules = [Slip::Reset, Slip::Overdamped, Slip::Arrest, undamped, damped];
    println!("\nCPU time of a break under the block, ns, and its growth over that of log N");
    let names = ["reset", "overdamped", "arrest", "inertial", "damped"];
    println!("{:>10}{}", "N", names.map(|name| format!("{name:>15}")).concat());
    let mut before: Option<(Vec<f64>, f64)> = None;
    for size in [1_000_usize, 10_000, 100_000, 1_000_000, 10_000_000] {
        let (contacts, initial) = contacts();
        let ensemble = Ensemble::new(contacts, initial, size, 1, Disorder::Annealed).unwrap();
        let times = rules.map(|slip| {
            let mut population = ensemble.population().unwrap();
            let distance = (BREAKS / size as f64).clamp(3.0, 1000.0);
            let (run, time) = pull(&mut population, slip, Some(0.3), distance);
            black_box(&run);
            1e9 * time / (population.energies().broken * size as f64)
        });
        let logarithm = (size as f64).ln();
        let column = |i: usize| {
            let growth = before.as_ref().map_or(String::new(), |(earlier, log): &(Vec<f64>, f64)| {
                format!("({:.2})", times[i] / earlier[i] / (logarithm / log))
            });
            format!("{:>8.0} {growth:>6}", times[i])
        };
        let columns: String = (0..rules.len()).map(column).collect();
        println!("{size:>10}{columns}");
        before = Some((times.to_vec(), logarithm));
    }
}
