//! Cost of the master equation in CPU time: Fig. 2 of the paper, laws that are harder, contacts moved back and forth.

#![allow(missing_docs)]

use std::hint::black_box;
use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Start};
use asperity::law::{Gaussian, Lognormal, Mixture, Point, Rectangular, SharedLaw};
use asperity::master::{MasterEquation, MasterPopulation};
use asperity::population::{Direction, Population};
use cpu_time::ThreadTime;
use criterion::{Bencher, Criterion, criterion_group, criterion_main};

struct Case {
    thresholds: SharedLaw,
    reforming: SharedLaw,
    initial: SharedLaw,
}

impl Case {
    fn equation(&self) -> MasterEquation {
        let (thresholds, reforming) = (self.thresholds.clone(), self.reforming.clone());
        let contacts = Contacts::new(thresholds, reforming);
        let initial = Initial { law: self.initial.clone(), start: Start::Conditional };
        MasterEquation::new(contacts, &initial).unwrap()
    }
}

fn gaussian(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gaussian::new(mean, std).unwrap())
}

fn rectangular(min: f64, max: f64) -> SharedLaw {
    Arc::new(Rectangular::new(min, max).unwrap())
}

/// Times `work` by the clock of this thread, which stands still while others have the core.
fn cpu<T>(bencher: &mut Bencher<'_>, work: impl Fn() -> T) {
    bencher.iter_custom(|iterations| {
        let begun = ThreadTime::now();
        (0..iterations).for_each(|_| drop(black_box(work())));
        begun.elapsed()
    });
}

/// Lives, solution to X = 50 at 1e-10, force and breaking rate at 5001 positions.
fn pulls(criterion: &mut Criterion) {
    let positions: Vec<f64> = (0..=5000).map(|i| f64::from(i) * 0.01).collect();
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let fig2 = || gaussian(1.0, 0.05);
    let start = || gaussian(0.1, 0.025);
    let lognormal: SharedLaw = Arc::new(Lognormal::new(1.0, 0.5).unwrap());
    let cases = [
        ("Fig. 2", fig2(), relaxed.clone(), start()),
        ("lognormal, c.v. 0.5", lognormal, relaxed.clone(), relaxed.clone()),
        ("rectangular 0.75 to 1.25", rectangular(0.75, 1.25), relaxed.clone(), relaxed.clone()),
        ("broad reforming, below thresholds", fig2(), rectangular(0.0, 0.2), start()),
        ("broad reforming, among thresholds", rectangular(0.4, 1.6), rectangular(0.0, 0.6), relaxed),
    ];
    let mut group = criterion.benchmark_group("pull to X = 50");
    group.sample_size(20);
    for (name, thresholds, reforming, initial) in cases {
        let case = Case { thresholds, reforming, initial };
        group.bench_function(format!("{name}, all"), |bencher| {
            cpu(bencher, || {
                let pull = case.equation().pull_with(50.0, 1e-10, &mut ()).unwrap();
                positions.iter().map(|&x| pull.force(x) + pull.breaking_rate(x)).sum::<f64>()
            });
        });
        let equation = case.equation();
        group.bench_function(format!("{name}, lives"), |bencher| cpu(bencher, || case.equation()));
        group.bench_function(format!("{name}, solution"), |bencher| {
            cpu(bencher, || equation.pull_with(50.0, 1e-10, &mut ()).unwrap());
        });
    }
    group.finish();
}

/// The contacts under a block: turned back so far that they break again, and a thousand cycles that end with a reset.
fn ways(criterion: &mut Criterion) {
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let cases = [
        ("Gaussian", gaussian(1.0, 0.1), relaxed.clone()),
        ("broad reforming, below thresholds", gaussian(1.0, 0.1), rectangular(0.0, 0.2)),
        ("rectangular 0.75 to 1.25", rectangular(0.75, 1.25), relaxed.clone()),
    ];
    let mut group = criterion.benchmark_group("contacts moved");
    group.sample_size(20);
    for (name, thresholds, reforming) in cases {
        let case = Case { thresholds, reforming, initial: relaxed.clone() };
        let mut turned = case.equation().population_with(1e-10, &mut ()).unwrap();
        advance(&mut turned, 1.4);
        group.bench_function(format!("{name}, back by 1.5"), |bencher| {
            cpu(bencher, || {
                let mut population = turned.clone();
                advance(&mut population, -1.5);
                population
            });
        });
        let fresh = case.equation().population_with(1e-10, &mut ()).unwrap();
        group.bench_function(format!("{name}, 1000 resets"), |bencher| {
            cpu(bencher, || {
                let mut population = fresh.clone();
                for _ in 0..1000 {
                    advance(&mut population, 0.89);
                    black_box(population.energies());
                    population.reset(Direction::Forward, &mut ()).unwrap();
                }
                population
            });
        });
    }
    group.finish();
}

fn advance(population: &mut MasterPopulation, mut by: f64) {
    let direction = if by > 0.0 { Direction::Forward } else { Direction::Backward };
    while by != 0.0 {
        let step =
            direction.sign() * population.smooth_interval(direction, &mut ()).unwrap().length.min(by.abs());
        population.advance(step).unwrap();
        by -= step;
    }
}

/// What follows from a pull to X = 6: gradients (F and five of them are to cost at most four times F), the covariance of
/// 1000 positions, the spectrum at 1000 wave numbers.
fn noise_and_gradients(criterion: &mut Criterion) {
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let half = |law: SharedLaw| (0.5, law);
    let lognormal = Arc::new(Lognormal::new(1.0, 0.2).unwrap());
    let mixed = Arc::new(Mixture::new(vec![half(gaussian(1.0, 0.1)), half(lognormal)]).unwrap());
    let mixed = Case { thresholds: mixed, reforming: relaxed.clone(), initial: relaxed.clone() };
    let equal = Case { thresholds: gaussian(1.0, 0.1), reforming: relaxed.clone(), initial: relaxed };
    let spread = Case {
        thresholds: gaussian(1.0, 0.12),
        reforming: gaussian(0.1, 0.03),
        initial: gaussian(0.2, 0.05),
    };
    let edges = Case {
        thresholds: rectangular(0.6, 1.4),
        reforming: rectangular(0.05, 0.2),
        initial: rectangular(0.1, 0.3),
    };
    let pointed = vec![(0.4, Arc::new(Point::new(0.9).unwrap()) as SharedLaw), (0.6, gaussian(1.0, 0.1))];
    let pointed = Case {
        thresholds: Arc::new(Mixture::new(pointed).unwrap()),
        reforming: gaussian(0.1, 0.03),
        initial: gaussian(0.2, 0.05),
    };
    let mut group = criterion.benchmark_group("noise and gradients");
    let cases = [
        ("all relaxed", equal),
        ("mixture", mixed),
        ("spread starts", spread),
        ("spread starts, edges", edges),
        ("spread starts, point mass", pointed),
    ];
    for (name, case) in cases {
        let equation = case.equation();
        let solve = || case.equation().pull_with(6.0, 1e-10, &mut ()).unwrap();
        group.bench_function(format!("{name}: lives and force"), |bencher| cpu(bencher, solve));
        let pull = solve();
        let parameters = pull.parameters();
        let of_laws =
            parameters.iter().map(|parameter| parameter.name.as_ref()).filter(|by| by.contains('.'));
        let five: Vec<&str> = of_laws.take(5).collect();
        group.bench_function(format!("{name}: lives, force and {} gradients", five.len()), |bencher| {
            cpu(bencher, || solve().gradients(&five).unwrap());
        });
        for (owner, law) in
            [("thresholds", &case.thresholds), ("reforming", &case.reforming), ("initial", &case.initial)]
        {
            for parameter in law.parameters().into_iter().filter(|parameter| parameter.name != "at") {
                let by = format!("{owner}.{}", parameter.name);
                group.bench_function(format!("{name}: gradient by {by}"), |bencher| {
                    cpu(bencher, || pull.gradient(&by).unwrap());
                });
            }
        }
        let positions: Vec<f64> = (1..=1000).map(|i| f64::from(i) * 0.006).collect();
        group.bench_function(format!("{name}: covariance of 1000 positions"), |bencher| {
            // On all threads: by the clock on the wall.
            bencher.iter(|| pull.covariance(&positions, 1.0).unwrap());
        });
        let thresholds: Vec<f64> = (0..100).map(|i| 0.505 + 0.01 * f64::from(i)).collect();
        group.bench_function(format!("{name}: response to 100 thresholds at 10 positions"), |bencher| {
            cpu(bencher, || {
                let response = pull.threshold_response(&thresholds).unwrap();
                response.rows_with(&[0.5, 0.9, 1.0, 1.1, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0], &mut ()).unwrap()
            });
        });
        let steady = equation.steady_state();
        group.bench_function(format!("{name}: spectrum at 1000 wave numbers"), |bencher| {
            cpu(bencher, || steady.spectrum(&positions.iter().map(|x| 10.0 * x).collect::<Vec<_>>(), 1.0));
        });
    }
    group.finish();
}

criterion_group!(benches, pulls, ways, noise_and_gradients);
criterion_main!(benches);
