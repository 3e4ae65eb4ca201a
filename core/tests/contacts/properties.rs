//! Properties that hold for any contacts, on cases drawn by proptest: distributions, lives, solutions of the renewal equation, and
//! the queue of an ensemble. Cases are the same every time; one that failed is kept in `properties.regressions` and tried first.

use std::sync::Arc;

use crate::common::{contacts, equation, initial, point};
use asperity::contacts::Start;
use asperity::ensemble::{Disorder, Ensemble};
use asperity::law::{Mixture, Point, SharedLaw};
use asperity::numerics::legendre::RULE;
use asperity::population::{Direction, Population};
use asperity::scenario::Law as Described;
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, RngSeed};

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(22),
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..ProptestConfig::default()
    }
}

/// A member of a parametric family with a scale and a coefficient of variation.
fn law(widths: std::ops::Range<f64>) -> impl Strategy<Value = SharedLaw> {
    let member = |(family, scale, width): (usize, f64, f64)| {
        let family = Described::FAMILIES[family];
        let width = width.clamp(family.widths[0], family.widths[1]);
        (family.member)(scale, width).build().unwrap()
    };
    let smooth = 0..Described::FAMILIES.len();
    (smooth, 0.2..5.0, widths).prop_map(member)
}

/// The same with a density.
fn spread(widths: std::ops::Range<f64>) -> impl Strategy<Value = SharedLaw> {
    law(widths).prop_filter("it has a density", |law| law.atoms().is_empty())
}

/// ∫ f from one end to the other, on panels that are narrow beside both ends, where densities have their singularities.
fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const PANELS: i32 = 160;
    // Panels grow as the fourth power of their number from either end.
    let half = |s: f64| 0.5 * (2.0 * s).powi(4);
    let edge = |k: i32| {
        let s = f64::from(k) / f64::from(PANELS);
        from + (to - from) * if s < 0.5 { half(s) } else { 1.0 - half(1.0 - s) }
    };
    (0..PANELS).map(|k| RULE.integrate(edge(k), edge(k + 1), &f)).sum()
}

proptest! {
    #![proptest_config(config(200))]

    #[test]
    fn the_density_is_the_slope_of_the_survival(law in spread(0.02..1.5), p in 0.02..0.98_f64) {
        // Differences of fourth order over a thousandth of the distance over which the density varies: truncation is some
        // 1e-12 of the slope, rounding 1e-16 of S over the step.
        let x = law.quantile(p);
        let step = 1e-3 * law.std().min(x);
        let apart = law.breakpoints().iter().map(|b| (b.position - x).abs()).fold(f64::INFINITY, f64::min);
        prop_assume!(apart > 2.0 * step);
        let s = |k: f64| law.survival(x + k * step);
        let slope = (8.0 * (s(1.0) - s(-1.0)) - (s(2.0) - s(-2.0))) / (12.0 * step);
        let density = law.density(x);
        prop_assert!((slope + density).abs() < 1e-8 * density + 1e-12 / step, "{law:?} at {x}: {slope}, {density}");
        prop_assert!((law.hazard(x) - density / law.survival(x)).abs() < 1e-11 * law.hazard(x));
    }

    #[test]
    fn a_quantile_is_the_inverse_of_the_distribution_function(law in spread(0.02..1.5), p in 1e-6..0.999_999_f64) {
        let x = law.quantile(p);
        // A relative rounding of x by 1e-15 or so changes P by x p times that; quantiles are found to a few digits more.
        let rounding = 1e-13 * (1.0 + x * law.density(x) / p);
        prop_assert!((law.cumulative(x) / p - 1.0).abs() < rounding, "{law:?}: {p}");
        let upper = law.upper_quantile(p);
        let rounding = 1e-13 * (1.0 + upper * law.density(upper) / p);
        prop_assert!((law.survival(upper) / p - 1.0).abs() < rounding, "{law:?}: {p} above");
    }

    #[test]
    fn moments_are_integrals_of_the_survival(law in spread(0.05..1.2)) {
        // What is beyond the upper quantile of 1e-18 is below 1e-15 of both moments for these widths.
        let end = law.upper_quantile(1e-18);
        let first = integral(|x| law.survival(x), 0.0, end);
        let second = integral(|x| 2.0 * x * law.survival(x), 0.0, end);
        // Panels beside an end that is not 0 or `end` (a rectangular density) are 1/160 of the range wide, and S has a kink there:
        // 16 nodes integrate it to the square of a hundredth of that.
        let rounding = if law.name() == "rectangular" { 1e-6 } else { 1e-11 };
        prop_assert!((first / law.mean() - 1.0).abs() < rounding, "{law:?}: {first}");
        let variance = second - first * first;
        prop_assert!((variance / law.std().powi(2) - 1.0).abs() < rounding * second / variance, "{law:?}: {variance}");
        prop_assert!((law.upper_moment(2, -1.0) / second - 1.0).abs() < rounding, "{law:?}: {second}");
    }

    #[test]
    fn draws_lie_where_the_distribution_is(law in law(0.02..1.5), seed in any::<u64>()) {
        use asperity::random::{Purpose, Stream};
        let mut draws = [0.0; 64];
        law.fill(&mut Stream::new(seed, Purpose::Posterior, 0), &mut draws);
        let (low, high) = (law.quantile(0.0), law.quantile(1.0));
        prop_assert!(draws.iter().all(|x| (low..=high).contains(x)), "{law:?}");
    }
}

/// The part of contacts left at an advance that start at stretches from a layer, by quadrature over the layer: with thresholds
/// that are above their starts, or drawn without regard to them.
fn left(thresholds: &SharedLaw, starts: &SharedLaw, start: Start, u: f64) -> f64 {
    let of = |r: f64| match start {
        Start::Relaxed => thresholds.survival(r + u),
        _ => thresholds.survival(r + u) / thresholds.survival(r),
    };
    integral(|r| starts.density(r) * of(r), starts.quantile(0.0), starts.upper_quantile(1e-18))
}

proptest! {
    #![proptest_config(config(24))]

    #[test]
    fn lives_of_layers_are_mixtures_of_those_of_single_starts(
        width in 0.05..0.4_f64, from in 0.0..0.5_f64, by in 0.01..0.4_f64, relaxed in any::<bool>(), part in 0.05..0.95_f64,
    ) {
        let (thresholds, starts) = (crate::common::gaussian(1.0, width), crate::common::rectangular(from, from + by));
        let start = if relaxed { Start::Relaxed } else { Start::Conditional };
        let equation = equation(&thresholds, &point(0.0), &starts, start);
        let life = equation.first_life();
        // Legendre cells resolve to 1e-13, and the quadrature here to rounding.
        for u in [part, 0.3 * part, 1.2 * part] {
            let expected = left(&thresholds, &starts, start, u);
            let survival = life.survival().curve().value(u);
            prop_assert!((survival - expected).abs() < 1e-12, "{u}: {survival}, {expected}");
        }
        // What has not broken yet breaks later.
        let rest = life.survival().curve().integral();
        prop_assert!((life.mean() - rest).abs() < 1e-12 * rest);
    }

    #[test]
    fn forces_of_mixed_starts_add_up(
        width in 0.05..0.5_f64, a in 0.0..0.5_f64, b in 0.5..0.9_f64, weight in 0.05..0.95_f64, at in 0.2..6.0_f64,
    ) {
        // The renewal equation is linear in the initial state: with stretches a and b, each with its weight, the force is the sum of
        // both. The solutions have different cells.
        let thresholds = crate::common::gaussian(1.0, width);
        let parts = vec![(weight, point(a)), (1.0 - weight, point(b))];
        let mixed: SharedLaw = Arc::new(Mixture::new(parts).unwrap());
        let force = |law: &SharedLaw| {
            equation(&thresholds, &point(0.0), law, Start::Conditional).pull(6.5).unwrap().force(at)
        };
        let sum = weight * force(&point(a)) + (1.0 - weight) * force(&point(b));
        // Each to the default tolerance, 1e-10 of the mean threshold.
        prop_assert!((force(&mixed) - sum).abs() < 3e-10, "{} at {at}: {sum}", force(&mixed));
    }

    #[test]
    fn forces_scale_with_lengths(width in 0.05..0.6_f64, scale in 1e-9..1e9_f64, at in 0.1..6.0_f64) {
        let force = |unit: f64| {
            let thresholds = crate::common::gamma(unit, width * unit);
            equation(&thresholds, &point(0.0), &point(0.1 * unit), Start::Conditional)
                .pull(6.5 * unit).unwrap().force(at * unit)
        };
        // Each to the default tolerance, 1e-10 of the mean threshold.
        prop_assert!((force(scale) / scale - force(1.0)).abs() < 3e-10, "{scale}");
    }
}

/// A contact of the threshold 1 at a stretch, moved by hand: it re-forms at stretch 0.
#[derive(Debug, Clone, Copy)]
struct Single {
    stretch: f64,
    breaks: u64,
}

impl Single {
    fn go(&mut self, by: f64) {
        let mut left = by;
        loop {
            let room = if left > 0.0 { 1.0 - self.stretch } else { -1.0 - self.stretch };
            if left.abs() < room.abs() {
                self.stretch += left;
                return;
            }
            (self.stretch, self.breaks, left) = (0.0, self.breaks + 1, left - room);
        }
    }
}

/// Moves a population by a way, through all breaks.
fn go(population: &mut dyn Population, by: f64) {
    let direction = if by > 0.0 { Direction::Forward } else { Direction::Backward };
    let to = population.position() + by;
    loop {
        let interval = population.smooth_interval(direction, &mut ()).unwrap();
        let left = (to - population.position()).abs();
        if left < interval.length {
            return population.advance(direction.sign() * left).unwrap();
        }
        population.advance(direction.sign() * interval.length).unwrap();
        if interval.breaks {
            population.cross(&mut ()).unwrap();
        }
    }
}

proptest! {
    #![proptest_config(config(60))]

    #[test]
    fn the_queue_breaks_contacts_as_one_would_by_hand(
        // Several contacts at the same stretch, and such that differ by less than a rung of the queue.
        stretches in prop::collection::vec(prop_oneof![0.0..0.99_f64, Just(0.25), Just(0.5), Just(0.25 + 1e-12)], 1..40),
        // Ways that end at no break of contacts at the fixed stretches.
        ways in prop::collection::vec(-3.0..3.0_f64, 1..12),
        seed in any::<u64>(),
    ) {
        let weight = 1.0 / stretches.len() as f64;
        let parts = stretches.iter().map(|&at| (weight, Arc::new(Point::new(at).unwrap()) as SharedLaw)).collect();
        let starts: SharedLaw = Arc::new(Mixture::new(parts).unwrap());
        let contacts = contacts(&point(1.0), &point(0.0));
        let ensemble = Ensemble::new(contacts, initial(&starts), 300, seed, Disorder::Annealed).unwrap();
        let mut population = ensemble.population().unwrap();
        let found = population.stretches().unwrap();
        let mut singles: Vec<_> = found.into_iter().map(|stretch| Single { stretch, breaks: 0 }).collect();
        for way in ways {
            go(&mut population, way);
            singles.iter_mut().for_each(|single| single.go(way));
            let force: f64 = singles.iter().map(|single| single.stretch).sum::<f64>() / singles.len() as f64;
            let breaks: u64 = singles.iter().map(|single| single.breaks).sum();
            // Some hundred roundings of positions of order 10.
            prop_assert!((population.ahead(0.0).force - force).abs() < 1e-11, "{} {force}", population.ahead(0.0).force);
            prop_assert_eq!(population.energies().broken, breaks as f64 / singles.len() as f64);
        }
    }

    #[test]
    fn what_is_marked_comes_back_wherever_it_went(ways in prop::collection::vec(-2.0..2.0_f64, 2..10), seed in any::<u64>()) {
        let contacts = contacts(&crate::common::gaussian(1.0, 0.2), &crate::common::rectangular(0.0, 0.3));
        let ensemble = Ensemble::new(contacts, initial(&crate::common::rectangular(0.0, 0.5)), 100, seed, Disorder::Annealed).unwrap();
        let mut population = ensemble.population().unwrap();
        let (before, after) = ways.split_at(ways.len() / 2);
        before.iter().for_each(|&way| go(&mut population, way));
        let state = (population.position(), population.ahead(0.0), population.energies());
        population.mark();
        after.iter().for_each(|&way| go(&mut population, way));
        let end = (population.ahead(0.0), population.energies());
        population.recall(&mut ()).unwrap();
        prop_assert_eq!((population.position(), population.ahead(0.0), population.energies()), state);
        after.iter().for_each(|&way| go(&mut population, way));
        prop_assert_eq!((population.ahead(0.0), population.energies()), end);
    }
}
