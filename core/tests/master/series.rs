//! Laws made from functions against the laws themselves: the same force, at the same cost.

use std::sync::Arc;

use crate::common::{exponential, gamma, gaussian, lognormal, master, mixture, point, rectangular, weibull};
use asperity::law::{Series, SharedLaw};

/// The law as a series of its density, which is called with many points at once, from boundaries at these quantiles.
fn made(law: &SharedLaw, quantiles: &[f64]) -> SharedLaw {
    let density = |x: &[f64]| Ok(x.iter().map(|&x| law.density(x)).collect());
    let places = quantiles.iter().map(|&p| law.quantile(p));
    let boundaries: Vec<f64> = std::iter::once(0.0).chain(places).chain([f64::INFINITY]).collect();
    Arc::new(Series::resolve(density, &boundaries, 1e-14).unwrap().0)
}

fn cases() -> Vec<SharedLaw> {
    vec![
        gaussian(1.0, 0.05),
        gaussian(1.0, 0.3),
        gamma(1.0, 0.1),
        gamma(1.0, 0.6),
        weibull(12.153, 1.0431),
        weibull(1.5, 1.0),
        lognormal(1.0, 0.3),
        mixture(&[(0.3, gaussian(0.5, 0.03)), (0.7, gaussian(1.2, 0.1))]),
    ]
}

#[test]
fn thresholds_made_from_a_function_give_the_force_of_their_law() {
    for law in cases() {
        let pull =
            |law: &SharedLaw| master(law, &point(0.0), &point(0.0)).pull_with(20.0, 1e-10, &mut ()).unwrap();
        let own = pull(&law);
        for quantiles in [&[0.5, 0.999][..], &[0.25, 0.5, 0.75, 0.999]] {
            let series = pull(&made(&law, quantiles));
            for k in 0..=2000_u32 {
                let x = 0.01 * f64::from(k);
                let difference = (own.force(x) - series.force(x)).abs();
                // The tolerance of either.
                assert!(difference < 1e-10, "{law:?} at {x}: {difference:e}");
            }
            // Cells are the cost. The widths of a bell's are those of the series, within a factor 2.
            assert!(series.cells() < 2 * own.cells(), "{law:?}: {} cells, {}", series.cells(), own.cells());
        }
    }
}

#[test]
fn kinetic_friction_is_that_of_the_law() {
    for law in cases() {
        let steady =
            |law: &SharedLaw| master(law, &point(0.0), &point(0.0)).steady_state().kinetic_friction();
        let ratio = steady(&made(&law, &[0.5, 0.999])) / steady(&law);
        // What lives leave out, 1e-14 in each of some tens of cells.
        assert!((ratio - 1.0).abs() < 1e-12, "{law:?}: {ratio}");
    }
}

#[test]
fn starts_made_from_a_function_do_as_well() {
    let thresholds = gaussian(1.0, 0.1);
    for law in [gaussian(0.2, 0.04), gamma(0.1, 0.05), rectangular(0.0, 0.3)] {
        let series = if law.name() == "rectangular" {
            Arc::new(Series::new(&[0.0, 0.3], &[vec![1.0]], 0.0).unwrap())
        } else {
            made(&law, &[0.5, 0.999])
        };
        let (own, series) = (master(&thresholds, &law, &law), master(&thresholds, &series, &series));
        let (length, expected) = (series.relaxation().unwrap().length(), own.relaxation().unwrap().length());
        // The series is resolved to 1e-14, and its transform magnifies that by the length of the range.
        assert!((length / expected - 1.0).abs() < 1e-10, "{law:?}: X* = {length}, not {expected}");
        let (own, series) =
            (own.pull_with(10.0, 1e-10, &mut ()).unwrap(), series.pull_with(10.0, 1e-10, &mut ()).unwrap());
        for k in 0..=1000_u32 {
            let x = 0.01 * f64::from(k);
            let difference = (own.force(x) - series.force(x)).abs();
            // The tolerance of both pulls.
            assert!(difference < 1e-10, "{law:?} at {x}: {difference:e}");
        }
    }
}

#[test]
fn relaxation_lengths_are_those_of_the_law_where_its_tail_does_not_matter() {
    let length = |law: &SharedLaw| master(law, &point(0.0), &point(0.0)).relaxation().unwrap().length();
    for law in
        [gaussian(1.0, 0.05), gaussian(1.0, 0.3), gamma(1.0, 0.1), gamma(1.0, 0.3), weibull(12.153, 1.0431)]
    {
        let ratio = length(&made(&law, &[0.5, 0.999])) / length(&law);
        // The root is found to 1e-14 of itself; what the series leaves out is lifted there.
        assert!((ratio - 1.0).abs() < 1e-11, "{law:?}: {ratio}");
    }
}

#[test]
fn where_the_tail_rules_the_length_is_not_known() {
    for law in [exponential(1.0), gamma(1.0, 0.9), lognormal(1.0, 0.3), lognormal(1.0, 0.6)] {
        let made = made(&law, &[0.5, 0.999]);
        for law in [made.clone(), mixture(&[(0.9, gaussian(1.0, 0.5)), (0.1, made)])] {
            let relaxation = master(&law, &point(0.0), &point(0.0)).relaxation().unwrap();
            assert!(relaxation.length().is_nan(), "{law:?}: {}", relaxation.length());
            assert!(relaxation.roots().is_empty());
        }
    }
}
