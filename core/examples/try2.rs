//! scratch
use std::sync::Arc;
use asperity::contacts::*;
use asperity::law::*;
use asperity::life::athermal;
fn main() {
    let g = |m: f64, s: f64| -> SharedLaw { Arc::new(Gaussian::new(m, s).unwrap()) };
    let l = athermal(&g(1., 0.05), Stiffness::Equal(1.0), &g(0.1, 0.025), true).unwrap();
    for k in [l.breaking(), l.survival(), l.force(), l.square()] {
        let w: Vec<f64> = k.curve().boundaries.windows(2).map(|w| w[1] - w[0]).collect();
        println!("{} {:?} {:?}", w.len(), w.iter().cloned().fold(9.0, f64::min), k.breaks());
    }
    println!("{:?}", l.breaking().curve().boundaries);
}
