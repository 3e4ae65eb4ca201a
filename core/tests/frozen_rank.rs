//! Contacts that keep their rank: the general way against the closed one, and its limits.

use std::sync::Arc;

use asperity::contacts::{Ageing, Contacts};
use asperity::law::{Gamma, Gaussian, Mixture, Point, Rectangular, SharedLaw};
use asperity::life::moving;

fn gaussian(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gaussian::new(mean, std).unwrap())
}

fn kinetic_friction(newborn: &SharedLaw, mature: &SharedLaw, velocity: f64) -> f64 {
    let mut contacts = Contacts::new(newborn.clone(), Arc::new(Point::new(0.0).unwrap()));
    contacts.rules.ageing = Some(Ageing::FrozenRank { mature: mature.clone(), time: 1.0 });
    let life = moving(&contacts, &contacts.reforming, true, velocity, false).unwrap();
    life.force().curve().integral() / life.survival().curve().integral()
}

#[test]
fn a_mixture_of_one_gaussian_ages_like_that_gaussian() {
    let mixture: SharedLaw = Arc::new(Mixture::new(vec![(1.0, gaussian(0.5, 0.1))]).unwrap());
    for (velocity, expected) in [(10.0, 0.2721367872), (1.0, 0.3867782523), (0.1, 0.5012378105)] {
        let found = kinetic_friction(&mixture, &gaussian(1.0, 0.05), velocity);
        // What the newborn law has below 0 is cut off, of 2.9e-7, and thresholds are known to 1e-7.
        assert!((found - expected).abs() < 3.9e-7, "{velocity} {found}");
    }
}

#[test]
fn friction_weakens_from_that_of_the_mature_law_to_that_of_the_newborn_one() {
    let laws: [(SharedLaw, SharedLaw); 2] = [
        (gaussian(0.5, 0.1), Arc::new(Gamma::new(1.0, 0.2).unwrap())),
        (gaussian(0.9, 0.05), Arc::new(Rectangular::new(0.6, 1.6).unwrap())),
    ];
    for (newborn, mature) in laws {
        let still = |law: &SharedLaw| law.upper_moment(2, -1.0) / (2.0 * law.mean());
        let found = [1e-3, 0.2, 1.0, 1e6].map(|velocity| kinetic_friction(&newborn, &mature, velocity));
        // Ages of a thousand times τ, and of a millionth.
        assert!((found[0] - still(&mature)).abs() < 1e-7);
        assert!((found[3] - still(&newborn)).abs() < 3e-6);
        assert!(found.windows(2).all(|pair| pair[0] > pair[1]), "{found:?}");
    }
}
