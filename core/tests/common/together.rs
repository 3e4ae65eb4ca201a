//! Contacts under one slider on a spring, which every break stretches alike: mean field itself, one by one.

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
