//! Cost of kinetic friction against velocity, in CPU time: what a curve costs for each kind of time-dependent contacts.

#![allow(missing_docs)]

use std::sync::Arc;

use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Rules, Start, Stiffness, Temperature};
use asperity::law::{Gaussian, Point, SharedLaw};
use asperity::master::MasterEquation;
use cpu_time::ThreadTime;

const REPEATS: usize = 5;
const VELOCITIES: u32 = 61;

fn main() {
    let logarithmic = Ageing::Logarithmic { growth: 0.02, time: 1.0 };
    let mature: SharedLaw = Arc::new(Gaussian::new(1.2, 0.05).unwrap());
    let frozen_rank = Ageing::FrozenRank { mature, time: 1.0 };
    let thermal = |barrier| Rules { temperature: Some(temperature(barrier)), ..Rules::default() };
    let ageing = |ageing| Rules { ageing: Some(ageing), ..Rules::default() };
    const EQUAL: Stiffness = Stiffness::Equal(1.0);
    println!(
        "CPU time of F_k at {VELOCITIES} velocities over 6 decades, σ = 0.1, k x̄²/2T = 10: median of {REPEATS}\n"
    );
    println!("{:<40} {:>12} {:>16}", "contacts", "curve, ms", "one point, µs");
    for (name, stiffness, rules) in [
        // Asked for: 1e-8 in less than 200 ms.
        ("elastic barrier", EQUAL, thermal(Barrier::Elastic)),
        ("bell barrier", EQUAL, thermal(Barrier::Bell)),
        ("catastrophe barrier", EQUAL, thermal(Barrier::Catastrophe)),
        ("elastic barrier, k = κ x_s", Stiffness::PerThreshold(1.0), thermal(Barrier::Elastic)),
        ("logarithmic ageing", EQUAL, ageing(logarithmic)),
        ("frozen rank", EQUAL, ageing(frozen_rank)),
    ] {
        let mut times: Vec<f64> = (0..REPEATS).map(|_| curve(&stiffness, &rules)).collect();
        times.sort_by(f64::total_cmp);
        let time = times[REPEATS / 2];
        println!("{name:<40} {:>12.1} {:>16.0}", 1e3 * time, 1e6 * time / f64::from(VELOCITIES));
    }
}

fn temperature(barrier: Barrier) -> Temperature {
    Temperature { barrier, ..Temperature::new(0.05, 1.0) }
}

/// CPU seconds of F_k from v = 1e-6 to 1.
fn curve(stiffness: &Stiffness, rules: &Rules) -> f64 {
    let thresholds: SharedLaw = Arc::new(Gaussian::new(1.0, 0.1).unwrap());
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let own = Contacts::new(thresholds, relaxed.clone());
    let contacts = Contacts { stiffness: stiffness.clone(), rules: rules.clone(), ..own };
    let initial = Initial { law: relaxed, start: Start::Conditional };
    let begun = ThreadTime::now();
    for k in 0..VELOCITIES {
        let velocity = 10.0_f64.powf(-6.0 + 6.0 * f64::from(k) / f64::from(VELOCITIES - 1));
        let equation = MasterEquation::at(contacts.clone(), &initial, velocity).unwrap();
        std::hint::black_box(equation.steady_state().kinetic_friction());
    }
    begun.elapsed().as_secs_f64()
}
