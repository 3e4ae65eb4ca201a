//! How the cost of the master equation grows with the number n of points: a table, against n log² n.

#![allow(missing_docs)]

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Start};
use asperity::law::{Gaussian, Lognormal, Point, SharedLaw};
use asperity::master::MasterEquation;
use cpu_time::ThreadTime;

const STEP: f64 = 0.01;
const REPEATS: usize = 5;

fn main() {
    let point: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let fig2: SharedLaw = Arc::new(Gaussian::new(1.0, 0.05).unwrap());
    let start: SharedLaw = Arc::new(Gaussian::new(0.1, 0.025).unwrap());
    let wide: SharedLaw = Arc::new(Lognormal::new(1.0, 0.5).unwrap());
    println!("CPU time of F and the breaking rate at n points {STEP} apart, at 1e-10: median of {REPEATS}");
    table("Fig. 2", &fig2, &point, &start);
    table("lognormal, c.v. 0.5", &wide, &point, &point);
}

fn table(name: &str, thresholds: &SharedLaw, reforming: &SharedLaw, initial: &SharedLaw) {
    println!(
        "\n{name}\n{:>9} {:>9} {:>12} {:>12} {:>24}",
        "n", "X", "all, ms", "points, ms", "growth/(n log² n)"
    );
    let mut before: Option<(f64, f64)> = None;
    for n in [1_000, 10_000, 100_000, 1_000_000] {
        let mut times: Vec<[f64; 2]> =
            (0..REPEATS).map(|_| run(thresholds.clone(), reforming.clone(), initial.clone(), n)).collect();
        times.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [all, points] = times[REPEATS / 2];
        let work = n as f64 * (n as f64).ln().powi(2);
        let growth = before.map_or("".into(), |(time, less)| format!("{:.2}", all / time / (work / less)));
        println!("{n:>9} {:>9} {:>12.3} {:>12.3} {growth:>24}", n as f64 * STEP, 1e3 * all, 1e3 * points);
        before = Some((all, work));
    }
}

/// CPU seconds of everything, and of what comes after the solution.
fn run(thresholds: SharedLaw, reforming: SharedLaw, initial: SharedLaw, n: usize) -> [f64; 2] {
    let begun = ThreadTime::now();
    let contacts = Contacts::new(thresholds, reforming);
    let initial = Initial { law: initial, start: Start::Conditional };
    let pull =
        MasterEquation::new(contacts, &initial).unwrap().pull_with(n as f64 * STEP, 1e-10, &mut ()).unwrap();
    let solved = begun.elapsed().as_secs_f64();
    let points = (0..n).map(|i| i as f64 * STEP);
    std::hint::black_box(points.map(|x| pull.force(x) + pull.breaking_rate(x)).sum::<f64>());
    let all = begun.elapsed().as_secs_f64();
    [all, all - solved]
}
