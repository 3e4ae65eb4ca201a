//! Cost of fits to measured curves, beside that of one solution, and of fits to records of steady sliding.

#![allow(missing_docs)]

use std::hint::black_box;
use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::fit::{ErrorModel, Fit, Measurement, SteadyFit, SteadyRecord};
use asperity::law::{Gaussian, SharedLaw};
use asperity::master::MasterEquation;
use criterion::{Criterion, criterion_group, criterion_main};

/// Contacts of Gaussian thresholds, re-formed at stretches G(.1, .03).
fn contacts(count: f64, [mean, std]: [f64; 2]) -> Contacts {
    let reforming: SharedLaw = Arc::new(Gaussian::new(0.1, 0.03).unwrap());
    Contacts { count, ..Contacts::new(Arc::new(Gaussian::new(mean, std).unwrap()), reforming) }
}

fn guess() -> MasterEquation {
    MasterEquation::new(contacts(1500.0, [0.9, 0.2]), &Initial::default()).unwrap()
}

/// The force of 2000 contacts, G(1, .12), one by one.
fn simulated(positions: &[f64]) -> Vec<f64> {
    let contacts = contacts(2000.0, [1.0, 0.12]);
    let ensemble = Ensemble::new(contacts, Initial::default(), 2000, 3, Disorder::Annealed).unwrap();
    ensemble.pull(positions).unwrap().force
}

fn fit(points: u32) -> Fit {
    let positions: Vec<f64> = (1..=points).map(|i| 6.0 * f64::from(i) / f64::from(points)).collect();
    let forces = simulated(&positions);
    Fit::new(guess(), Measurement::new(positions, forces))
}

const NUMBERS: [&str; 4] = ["thresholds.mean", "thresholds.std", "count", "stiffness"];

/// A fit of four numbers with independent errors is to cost no more than twelve solutions; with the noise of contacts 60 ms
/// for 600 positions and 0.7 s for 2000, and a record of 10 000 readings of steady sliding 0.5 s, on two cores.
fn fits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fits");
    group.sample_size(10);
    let one = MasterEquation::new(contacts(2000.0, [1.0, 0.12]), &Initial::default()).unwrap();
    let positions: Vec<f64> = (1..=2000).map(|i| 0.003 * f64::from(i)).collect();
    group.bench_function("one solution, 2000 positions", |bencher| {
        bencher.iter(|| {
            let equation = MasterEquation::new(contacts(2000.0, [1.0, 0.12]), &Initial::default()).unwrap();
            let pull = equation.pull_with(6.0, 1e-10, &mut ()).unwrap();
            positions.iter().map(|&x| pull.force(x)).sum::<f64>()
        });
    });
    let white = ErrorModel { contacts: false, ..ErrorModel::default() };
    let independent = fit(2000).free(["thresholds.mean", "thresholds.std", "count", "offset"]).errors(white);
    group.bench_function("independent errors, four numbers, 2000 positions", |bencher| {
        bencher.iter(|| black_box(independent.run().unwrap()));
    });
    for points in [600, 2000] {
        let with_noise = fit(points).free(NUMBERS);
        group.bench_function(format!("noise of contacts, four numbers, {points} positions"), |bencher| {
            bencher.iter(|| black_box(with_noise.run().unwrap()));
        });
    }
    let found = fit(300).free(NUMBERS).run().unwrap();
    group.bench_function("free form of thresholds, 36 kernels, 300 positions", |bencher| {
        bencher.iter(|| black_box(found.free_form(36, &mut ()).unwrap()));
    });
    let sliding: Vec<f64> = (0..10_000).map(|i| 60.0 + 0.04 * f64::from(i)).collect();
    let record = SteadyRecord::at_positions(&sliding, simulated(&sliding)).unwrap();
    let steady = SteadyFit::new(one, record).free(NUMBERS).reading(0.0);
    group.bench_function("steady sliding, four numbers, 10 000 readings", |bencher| {
        bencher.iter(|| black_box(steady.run().unwrap()));
    });
    group.finish();
}

criterion_group!(benches, fits);
criterion_main!(benches);
