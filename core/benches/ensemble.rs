//! Cost of a break, on one core and on all of them.

#![allow(missing_docs)]

use std::hint::black_box;
use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Start, Stiffness};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::law::{Gaussian, Point, Rectangular, SharedLaw};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn ensemble(reforming: SharedLaw, stiffness: Stiffness, disorder: Disorder) -> Ensemble {
    let thresholds: SharedLaw = Arc::new(Gaussian::new(1.0, 0.05).unwrap());
    let initial = Initial { law: Arc::new(Point::new(0.0).unwrap()), start: Start::Conditional };
    let contacts = Contacts { stiffness, ..Contacts::new(thresholds, reforming) };
    Ensemble::new(contacts, initial, 20_000, 1, disorder).unwrap()
}

/// 20 000 contacts to X = 100 at 2001 positions: throughput is in breaks.
fn pulls(criterion: &mut Criterion) {
    let positions: Vec<f64> = (0..=2000).map(|i| f64::from(i) * 0.05).collect();
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let broad: SharedLaw = Arc::new(Rectangular::new(0.0, 0.2).unwrap());
    const EQUAL: Stiffness = Stiffness::Equal(1.0);
    let cases = [
        ("annealed", 1, ensemble(relaxed.clone(), EQUAL, Disorder::Annealed)),
        ("annealed", 2, ensemble(relaxed.clone(), EQUAL, Disorder::Annealed)),
        ("quenched", 1, ensemble(relaxed.clone(), EQUAL, Disorder::Quenched)),
        ("broad reforming", 1, ensemble(broad, EQUAL, Disorder::Annealed)),
        ("per threshold", 1, ensemble(relaxed, Stiffness::PerThreshold(1.0), Disorder::Annealed)),
    ];
    let mut group = criterion.benchmark_group("pull");
    group.sample_size(20);
    for (name, threads, ensemble) in cases {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let pull = || ensemble.pull(&positions).unwrap();
        let breaks = pool.install(pull).breaks;
        group.throughput(Throughput::Elements(breaks));
        group.bench_function(format!("{name}, {threads} threads"), |bencher| {
            bencher.iter(|| pool.install(|| black_box(pull())));
        });
    }
    group.finish();
}

criterion_group!(benches, pulls);
criterion_main!(benches);
