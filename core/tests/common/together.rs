//! Contacts that every break stretches alike, one by one: mean field itself.
#![allow(dead_code)]

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Start};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::first_breaks::FirstBreaks;
use asperity::law::{Point, SharedLaw};
use asperity::population::{Direction, Population};

/// First breaks of relaxed contacts, of each of which a share `coupling` goes to all: the share that has broken, against
/// the least drive (1 − κ) X_T = X − κ(X − F/N⟨k⟩) that moves the slider on to where the next one breaks.
///
/// Every break counts: so narrow must the law be that none breaks again before all have broken.
pub fn first_breaks(thresholds: &SharedLaw, coupling: f64, size: usize, seed: u64) -> FirstBreaks {
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).expect("0"));
    let contacts = Contacts::new(thresholds.clone(), relaxed.clone());
    let start = Initial { law: relaxed, start: Start::Conditional };
    let ensemble = Ensemble::new(contacts, start, size, seed, Disorder::Annealed).expect("contacts");
    let mut population = ensemble.population().expect("nothing stops it");
    let (mut drive, mut points) = (0.0_f64, Vec::new());
    while population.energies().broken < 1.0 - 0.5 / size as f64 {
        let interval = population.smooth_interval(Direction::Forward, &mut ()).expect("contacts that break");
        let (position, force) =
            (population.position() + interval.length, population.ahead(interval.length).force);
        drive = drive.max(position - coupling * (position - force));
        points.push((drive, population.energies().broken));
        population.advance(interval.length).expect("a way ahead");
        population.cross(&mut ()).expect("contacts that break");
        points.push((drive, population.energies().broken));
    }
    FirstBreaks::of_fractions(points)
}

/// Force per contact at each of the rising drives, of relaxed contacts of stiffness 1 that re-form unstretched. Each break adds
/// the fraction `coupling` of the stretch that it releases, divided by the number of contacts, to the stretches of all.
///
/// All contacts have the position Y, which is the drive and what breaks have added to it. This uses neither a population nor
/// the block.
pub fn forces(thresholds: &SharedLaw, coupling: f64, size: usize, drives: &[f64]) -> Vec<f64> {
    // A linear congruential generator (D. E. Knuth, The Art of Computer Programming 2, 3.3.4).
    let mut state = 1_u64;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        thresholds.quantile(((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64)
    };
    // Where contacts break and where they formed. Positive numbers are in the order of their bits.
    let mut contacts: BinaryHeap<_> = (0..size).map(|_| Reverse((draw().to_bits(), 0))).collect();
    let mut released = 0.0;
    let at = |drive: f64| {
        let position = |released: f64| drive + coupling * released / size as f64;
        while let Some(&Reverse((end, formed))) = contacts.peek() {
            let [end, formed] = [end, formed].map(f64::from_bits);
            if end > position(released) {
                break;
            }
            released += end - formed;
            contacts.pop();
            contacts.push(Reverse(((end + draw()).to_bits(), end.to_bits())));
        }
        position(released) - released / size as f64
    };
    drives.iter().copied().map(at).collect()
}
