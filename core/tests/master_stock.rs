//! The contacts of a master equation moved forth and back: agreement with a pull, with closed forms, with contacts one by
//! one, and the balance of energy.

mod common;

use asperity::population::{Direction, Population};
use common::{gaussian, master, point, rectangular};

/// Moves to `position`, cell by cell.
fn drive(population: &mut dyn Population, position: f64) {
    loop {
        let left = position - population.position();
        let direction = if left > 0.0 { Direction::Forward } else { Direction::Backward };
        let length = population.way(direction).unwrap().length;
        if left.abs() <= length {
            return population.advance(left).unwrap();
        }
        population.advance(direction.sign() * length).unwrap();
    }
}

fn force(population: &mut dyn Population) -> f64 {
    population.way(Direction::Forward).unwrap();
    population.ahead(0.0).force
}

#[test]
fn a_way_forth_is_a_pull() {
    let cases = [
        (gaussian(1.0, 0.1), point(0.0), point(0.0)),
        (gaussian(1.0, 0.05), gaussian(0.2, 0.04), gaussian(0.1, 0.025)),
        (rectangular(0.75, 1.25), point(0.0), rectangular(0.1, 0.2)),
    ];
    for (thresholds, reforming, start) in cases {
        let master = master(&thresholds, &reforming, &start);
        let pull = master.pull(20.0, 1e-12, &mut ()).unwrap();
        let mut stock = master.population(1e-12).unwrap();
        for k in 1..80 {
            let position = 0.25 * f64::from(k);
            drive(&mut stock, position);
            let error = force(&mut stock) - pull.force(position);
            assert!(error.abs() < 1e-12, "{thresholds:?} at {position}: {error:e}");
        }
    }
}
