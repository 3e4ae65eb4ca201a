//! Cost of a break of contacts that move together, against their number: a table, against log N.

#![allow(missing_docs)]

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Start, Stiffness};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::law::{Exponential, Gaussian, Point, Rectangular, SharedLaw};
use asperity::population::{Direction, Population};
use cpu_time::{ProcessTime, ThreadTime};

/// Breaks timed, if each contact breaks so often too.
const BREAKS: usize = 4_000_000;

/// Breaks of a contact before.
const SETTLED: f64 = 3.0;

fn main() {
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let narrow: SharedLaw = Arc::new(Gaussian::new(1.0, 0.05).unwrap());
    let exponential: SharedLaw = Arc::new(Exponential::new(1.0).unwrap());
    let broad: SharedLaw = Arc::new(Rectangular::new(0.0, 0.2).unwrap());
    let contacts = |thresholds: &SharedLaw, reforming: &SharedLaw, stiffness| {
        let (thresholds, reforming) = (thresholds.clone(), reforming.clone());
        Contacts { stiffness, ..Contacts::new(thresholds, reforming) }
    };
    const EQUAL: Stiffness = Stiffness::Equal(1.0);
    println!(
        "CPU time of a break after {SETTLED} breaks of each contact, and of what passes over all contacts"
    );
    table("Gaussian, c.v. 0.05", &contacts(&narrow, &relaxed, EQUAL), Disorder::Annealed);
    table("Gaussian, c.v. 0.05, quenched", &contacts(&narrow, &relaxed, EQUAL), Disorder::Quenched);
    table(
        "exponential, k = κ x_s",
        &contacts(&exponential, &relaxed, Stiffness::PerThreshold(1.0)),
        Disorder::Annealed,
    );
    table("Gaussian, c.v. 0.05, broad re-forming", &contacts(&narrow, &broad, EQUAL), Disorder::Annealed);
}

fn table(name: &str, contacts: &Contacts, disorder: Disorder) {
    println!(
        "\n{name}\n{:>10} {:>12} {:>14} {:>12} {:>11} {:>11}",
        "N", "break, ns", "growth/log N", "made, ms", "turn, ms", "reset, ms"
    );
    let mut before: Option<(f64, f64)> = None;
    for size in [1_000, 10_000, 100_000, 1_000_000, 10_000_000] {
        let initial = Initial { law: Arc::new(Point::new(0.0).unwrap()), start: Start::Conditional };
        let ensemble = Ensemble::new(contacts.clone(), initial, size, 1, disorder).unwrap();
        let (mut population, made) = timed(|| ensemble.population().unwrap());
        let time = per_break(&mut population, BREAKS.max(size));
        let back = population.smooth_interval(Direction::Backward, &mut ()).unwrap().length;
        let ((), turned) = timed(|| population.advance(-0.5 * back).unwrap());
        let ((), reset) = timed(|| population.reset(Direction::Backward, &mut ()).unwrap());
        let logarithm = (size as f64).ln();
        let growth = before.map_or("".into(), |(t, l)| format!("{:.2}", time / t / (logarithm / l)));
        println!("{size:>10} {time:>12.1} {growth:>14} {made:>12.1} {turned:>11.1} {reset:>11.1}");
        before = Some((time, logarithm));
    }
}

/// CPU time of a break, in ns.
fn per_break(population: &mut dyn Population, breaks: usize) -> f64 {
    while population.energies().broken < SETTLED {
        step(population);
    }
    let begun = ThreadTime::now();
    let mut force = 0.0;
    for _ in 0..breaks {
        force += step(population);
    }
    std::hint::black_box(force);
    1e9 * begun.elapsed().as_secs_f64() / breaks as f64
}

/// What a block does from break to break.
fn step(population: &mut dyn Population) -> f64 {
    let interval = population.smooth_interval(Direction::Forward, &mut ()).unwrap();
    let force = population.ahead(interval.length).force;
    population.advance(interval.length).unwrap();
    population.cross(&mut ()).unwrap();
    force
}

/// CPU time of all threads, in ms.
fn timed<T>(task: impl FnOnce() -> T) -> (T, f64) {
    let begun = ProcessTime::now();
    let outcome = task();
    (outcome, 1e3 * begun.elapsed().as_secs_f64())
}
