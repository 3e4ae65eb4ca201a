//! Contacts followed through time: velocity steps with temperature beside ageing alone, behind a spring, and at few and at many
//! times, the velocity step of thresholds that diffuse, how many cells a second, one thread and two; and lives at a velocity.

#![allow(missing_docs)]

use std::sync::Arc;
use std::time::Instant;

use asperity::block::{Block, Loading, Slip};
use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Rules, Temperature};
use asperity::history::{History, Piece};
use asperity::law::{Gaussian, Point, SharedLaw};
use asperity::master::{MasterEquation, Transport};
use asperity::numerics::diffusion::{Coefficients, MovingBoundary, MovingGrid, Potential, Workspace};
use criterion::{Criterion, criterion_group, criterion_main};

fn gaussian(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gaussian::new(mean, std).unwrap())
}

fn contacts(thresholds: SharedLaw, rules: Rules) -> Contacts {
    Contacts { rules, ..Contacts::new(thresholds, Arc::new(Point::new(0.0).unwrap())) }
}

fn diffusing() -> Contacts {
    let ageing = Some(Ageing::Smoluchowski { mature: gaussian(1.0, 0.05), diffusion: 0.0025 });
    contacts(gaussian(0.5, 0.1), Rules { ageing, ..Rules::default() })
}

fn thermal() -> Contacts {
    let temperature = Some(Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.05, 1.0) });
    contacts(gaussian(1.0, 0.1), Rules { temperature, ..Rules::default() })
}

/// Motion at a velocity, then at a tenth of it for one and a half mean thresholds, and times along it.
fn slower(velocity: f64) -> (History, Vec<f64>) {
    let piece = |velocity: f64, distance: f64| Piece { velocity, duration: distance / velocity };
    let history = History::new(vec![piece(velocity, 0.2), piece(0.1 * velocity, 1.5)]).unwrap();
    let times = (0..=100).map(|k| f64::from(k) / 100.0 * history.duration()).collect();
    (history, times)
}

/// From steady sliding at a velocity to a tenth of it.
fn velocity_step(contacts: &Contacts, velocity: f64, tolerance: f64) -> f64 {
    let (history, times) = slower(velocity);
    let mut transport = Transport::steady_with(contacts, velocity, tolerance, &mut ()).unwrap();
    transport.follow(&history, &times).unwrap().force.iter().sum()
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("velocity step");
    group.sample_size(10);
    for (name, contacts, velocity) in [("smoluchowski", diffusing(), 1.0), ("thermal", thermal(), 1e-2)] {
        for threads in [1, 2] {
            let pool = pool(threads);
            group.bench_function(format!("{name} to 1e-4, {threads} threads"), |bencher| {
                bencher.iter(|| pool.install(|| velocity_step(&contacts, velocity, 1e-4)));
            });
        }
    }
    group.finish();
}

/// Temperature, and temperature with ageing, over the time of ageing alone: velocity steps from rest at the same tolerance, on
/// one thread.
fn pairs(criterion: &mut Criterion) {
    let ageing = || Some(Ageing::Logarithmic { growth: 0.04, time: 1.0 });
    let temperature = |barrier| Some(Temperature { barrier, ..Temperature::new(0.02, 1.0) });
    let elastic = temperature(Barrier::Elastic);
    let rows = [
        ("ageing", ageing(), None),
        ("temperature", None, elastic),
        ("temperature and ageing", ageing(), elastic),
        ("Bell's temperature and ageing", ageing(), temperature(Barrier::Bell)),
        ("catastrophe and ageing", ageing(), temperature(Barrier::Catastrophe)),
    ];
    let mut group = criterion.benchmark_group("velocity steps from rest");
    group.sample_size(10);
    let pool = pool(1);
    for (tolerance, digits) in [(1e-4, "1e-4"), (1e-6, "1e-6")] {
        for (name, ageing, temperature) in &rows {
            let rules = Rules { ageing: ageing.clone(), temperature: *temperature, ..Rules::default() };
            let contacts = contacts(gaussian(1.0, 0.25), rules);
            group.bench_function(format!("{name} to {digits}"), |bencher| {
                bencher.iter(|| pool.install(|| steps_from_rest(&contacts, tolerance)));
            });
        }
    }
    group.finish();
}

/// A velocity step behind the spring of a machine over that of a rigid one, at the same tolerance, on one thread.
fn springs(criterion: &mut Criterion) {
    let ageing = || Some(Ageing::Logarithmic { growth: 0.04, time: 1.0 });
    let temperature = Some(Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.02, 1.0) });
    let mut group = criterion.benchmark_group("velocity step behind a spring");
    group.sample_size(10);
    let pool = pool(1);
    for (name, temperature) in [("ageing", None), ("temperature and ageing", temperature)] {
        let rules = Rules { ageing: ageing(), temperature, ..Rules::default() };
        let contacts = contacts(gaussian(1.0, 0.25), rules);
        group.bench_function(format!("{name} to 1e-4, rigid"), |bencher| {
            bencher.iter(|| pool.install(|| velocity_step(&contacts, 0.1, 1e-4)));
        });
        group.bench_function(format!("{name} to 1e-4, K = 1"), |bencher| {
            bencher.iter(|| pool.install(|| step_behind_spring(&contacts, 0.1, 1e-4)));
        });
    }
    group.finish();
}

/// [`velocity_step`] of the load point of a machine of stiffness 1.
fn step_behind_spring(contacts: &Contacts, velocity: f64, tolerance: f64) -> f64 {
    let (history, times) = slower(velocity);
    let transport = Transport::steady_with(contacts, velocity, tolerance, &mut ()).unwrap();
    let block = Block::new(Loading::Spring(1.0), Slip::Reset, None).unwrap();
    let run = block.follow_with(&transport, &history, &times, tolerance, &mut ()).unwrap();
    run.trace.iter().map(|moment| moment.force).sum()
}

/// Three velocities, a factor of ten apart, for five mean thresholds each.
fn steps_from_rest(contacts: &Contacts, tolerance: f64) -> f64 {
    let piece = |velocity: f64| Piece { velocity, duration: 5.0 / velocity };
    let history = History::new(vec![piece(0.01), piece(0.1), piece(0.01)]).unwrap();
    let times: Vec<f64> = (0..=300).map(|k| f64::from(k) / 300.0 * history.duration()).collect();
    let mut transport =
        Transport::new_with(contacts.clone(), &Initial::default(), tolerance, &mut ()).unwrap();
    transport.follow(&history, &times).unwrap().force.iter().sum()
}

/// One velocity step of contacts that age, with temperature and without, shown at few times and at many.
fn points(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("points of a trace");
    group.sample_size(10);
    let temperature = Some(Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.02, 1.0) });
    let ageing = Some(Ageing::Logarithmic { growth: 0.04, time: 1.0 });
    let pool = pool(1);
    for (name, temperature) in [("ageing", None), ("temperature and ageing", temperature)] {
        let rules = Rules { ageing: ageing.clone(), temperature, ..Rules::default() };
        let contacts = contacts(gaussian(1.0, 0.25), rules);
        for (tolerance, digits) in [(1e-4, "1e-4"), (1e-6, "1e-6")] {
            for count in [10, 1000] {
                group.bench_function(format!("{name} to {digits}, {count} points"), |bencher| {
                    bencher.iter(|| pool.install(|| one_step(&contacts, tolerance, count)));
                });
            }
        }
    }
    group.finish();
}

/// From steady sliding to a tenth of the velocity, for three mean thresholds.
fn one_step(contacts: &Contacts, tolerance: f64, count: u32) -> f64 {
    let history = History::new(vec![Piece { velocity: 0.01, duration: 300.0 }]).unwrap();
    let times: Vec<f64> = (1..=count).map(|k| f64::from(k) / f64::from(count) * history.duration()).collect();
    let mut transport = Transport::steady_with(contacts, 0.1, tolerance, &mut ()).unwrap();
    transport.follow(&history, &times).unwrap().force.iter().sum()
}

/// Lives of contacts with temperature, with ageing and with both, that re-form at one stretch or at many.
fn lives(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("lives");
    group.sample_size(10);
    let pool = pool(1);
    let temperature = Some(Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.02, 1.0) });
    let ageing = || Some(Ageing::Logarithmic { growth: 0.04, time: 1.0 });
    let rows =
        [("temperature", None, temperature), ("ageing", ageing(), None), ("both", ageing(), temperature)];
    for (name, ageing, temperature) in rows {
        for (starts, reforming) in [
            ("one stretch", Arc::new(Point::new(0.0).unwrap()) as SharedLaw),
            ("a spread", gaussian(0.1, 0.025)),
        ] {
            let rules = Rules { ageing: ageing.clone(), temperature, ..Rules::default() };
            let contacts = Contacts { reforming, ..contacts(gaussian(1.0, 0.1), rules) };
            let life = || MasterEquation::at(contacts.clone(), &Initial::default(), 0.01).unwrap();
            group.bench_function(format!("{name}, {starts}"), |bencher| {
                bencher.iter(|| pool.install(life));
            });
        }
    }
    group.finish();
}

/// Cells a second of a step of diffusion in cache, beside those that memory could feed: 16 bytes read and written for each.
fn cells(_: &mut Criterion) {
    const CELLS: usize = 700;
    const ROUNDS: usize = 20_000;
    let potential = Potential::of(|h| (-0.5 * ((h - 1.0) / 0.05_f64).powi(2)).exp(), (0.0, 1.4), 8192);
    let medium = Coefficients { potential: &potential, diffusion: 0.0025, sink: None };
    let (cells, mut room) = (MovingGrid::new(CELLS, 0.05), Workspace::default());
    let rise = MovingBoundary { floor: (0.2, 0.203), ceiling: 1.4, duration: 0.01, absorbing: true };
    let mut masses = vec![1.0 / CELLS as f64; CELLS];
    let begun = Instant::now();
    for _ in 0..ROUNDS {
        cells.advance(&rise, &medium, &mut masses, &mut room);
    }
    std::hint::black_box(&masses);
    let hot = (ROUNDS * CELLS) as f64 / begun.elapsed().as_secs_f64();
    let (from, mut to) = (vec![1.0_f64; 1 << 25], vec![0.5_f64; 1 << 25]);
    let begun = Instant::now();
    to.copy_from_slice(std::hint::black_box(&from));
    let memory = std::hint::black_box(&to).len() as f64 / begun.elapsed().as_secs_f64();
    println!("cells: {hot:.3e} a second in a step of diffusion; memory would allow {memory:.3e}");
}

criterion_group!(benches, steps, pairs, springs, points, lives, cells);
criterion_main!(benches);
