//! Diffusion of thresholds: cost of a cell in a step, and of a life.

#![allow(missing_docs)]

use std::hint::black_box;
use std::sync::Arc;

use asperity::contacts::{Ageing, Contacts, ThresholdFokkerPlanck};
use asperity::law::{Gaussian, Point, SharedLaw};
use asperity::life::moving;
use asperity::numerics::diffusion::{Coefficients, MovingBoundary, MovingGrid, Sink, Workspace};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const DIFFUSION: f64 = 0.0025;

fn gaussian(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gaussian::new(mean, std).unwrap())
}

/// A step of all cells above a floor that rises: throughput is in cells.
fn steps(criterion: &mut Criterion) {
    let maturing = ThresholdFokkerPlanck::new(gaussian(0.5, 0.1), gaussian(1.0, 0.05), DIFFUSION);
    let potential = maturing.potential();
    let ceiling = maturing.support.1;
    let sink: Sink<'_> = &|positions| positions.map(|h| 1e-3 * h);
    let mut group = criterion.benchmark_group("step");
    for count in [256, 4096] {
        let cells = MovingGrid::new(count, 0.05);
        let middles: Vec<f64> = cells.middles(0.2, ceiling).collect();
        let fresh = maturing.fresh(&middles, 0.2, &mut ()).unwrap();
        let rise = MovingBoundary { floor: (0.2, 0.203), ceiling, duration: 0.01, absorbing: true };
        let mut room = Workspace::default();
        group.throughput(Throughput::Elements(count as u64));
        for (name, sink) in [("", None), (", with a sink", Some(sink))] {
            let medium = Coefficients { potential: &potential, diffusion: DIFFUSION, sink };
            group.bench_function(format!("{count} cells{name}"), |bencher| {
                bencher.iter_batched_ref(
                    || fresh.clone(),
                    |masses| cells.advance(&rise, &medium, black_box(masses), &mut room),
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
        bencher
            .iter(|| black_box(moving(&contacts, &contacts.reforming, true, 0.1, false, &mut ()).unwrap()));
    });
    group.finish();
}

criterion_group!(benches, steps, lives);
criterion_main!(benches);
