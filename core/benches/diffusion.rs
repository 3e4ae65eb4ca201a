//! Diffusion of thresholds: cost of a cell in a step, and of a life.

#![allow(missing_docs)]

use std::hint::black_box;
use std::sync::Arc;

use asperity::contacts::{Ageing, Contacts, Maturing};
use asperity::law::{Gaussian, Point, SharedLaw};
use asperity::life::moving;
use asperity::numerics::diffusion::{Step, Work};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const DIFFUSION: f64 = 0.0025;

fn gaussian(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gaussian::new(mean, std).unwrap())
}

/// A step of all cells, with a floor in the lowest one: throughput is in cells.
fn steps(criterion: &mut Criterion) {
    let maturing = Maturing::new(gaussian(0.5, 0.1), gaussian(1.0, 0.05), DIFFUSION);
    let mut group = criterion.benchmark_group("step");
    for cells in [256, 4096] {
        let operator = Arc::new(maturing.operator(cells));
        let newborn = maturing.newborn(&operator.middles(), 0.0);
        let step = Step::new(&operator, 0.01);
        let floor = (0.2 * operator.width(), 0.4 * operator.width());
        let sink = vec![1e-3; cells];
        let mut work = Work::default();
        group.throughput(Throughput::Elements(cells as u64));
        for (name, sink) in [("", None), (", with a sink", Some(sink.as_slice()))] {
            group.bench_function(format!("{cells} cells{name}"), |bencher| {
                bencher.iter_batched_ref(
                    || newborn.clone(),
                    |masses| black_box(step.advance(masses, floor, sink, &mut work)),
                    criterion::BatchSize::SmallInput,
                );
            });
        }
    }
    group.finish();
}

/// The life of contacts that are caught, at a tenth of the rate at which they mature.
fn lives(criterion: &mut Criterion) {
    let mut contacts = Contacts::new(gaussian(0.5, 0.1), Arc::new(Point::new(0.0).unwrap()));
    contacts.rules.ageing = Some(Ageing::Smoluchowski { mature: gaussian(1.0, 0.05), diffusion: DIFFUSION });
    let mut group = criterion.benchmark_group("life");
    group.sample_size(10);
    group.bench_function("smoluchowski", |bencher| {
        bencher.iter(|| black_box(moving(&contacts, &contacts.reforming, true, 0.1, false).unwrap()));
    });
    group.finish();
}

criterion_group!(benches, steps, lives);
criterion_main!(benches);
