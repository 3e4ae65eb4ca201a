//! Contacts that are free for a time τ after each break, against sums over generations.
//!
//! With R and Q_ini at 0 a contact re-forms for the nth time at the advance S_n + n vτ, S_n the sum of n thresholds, and
//! then carries u S(u) after a further advance u. So F(X)/(N_c⟨k⟩) = Σ_n G_n(X − n vτ) with G_n = p_n ∗ (u S), and, as by
//! symmetry the last of n + 1 thresholds has the mean s/(n+1) where their sum is s,
//!
//! G_n(u) = I_n(u) − I_{n+1}(u) − [u C_{n+1}(u) − I_{n+1}(u)]/(n + 1),
//!
//! where C_n(u) = P(S_n ≤ u) and I_n(u) = E[(u − S_n)₊].

use crate::common::{contacts, exponential, gamma, initial, mixture, point, rectangular};
use asperity::contacts::{Contacts, Rules};
use asperity::law::{Gamma, Law, SharedLaw};
use asperity::master::{MasterEquation, Pull};
use asperity::population::{Direction, Population};

/// The tolerance asked for, an error of F/(N_c⟨k⟩) per mean life.
const PROMISED: f64 = 1e-10;

/// Where F is smooth between its breaks, cells of 16 points leave out less than rounding: what remains is the rounding of a few
/// hundred cells, and of the closed forms.
const ROUNDING: f64 = 2e-12;

/// Thresholds of mean 1 and a delay of vτ = 0.35.
const MEAN_LIFE: f64 = 1.35;

/// P(S ≤ u) and E[(u − S)₊] of a sum S.
type Sum = (f64, f64);

fn equation(thresholds: &SharedLaw, reforming: &SharedLaw, delay: f64, velocity: f64) -> MasterEquation {
    let rules = Rules { delay: delay.into(), ..Rules::default() };
    let delayed = Contacts { rules, ..contacts(thresholds, reforming) };
    MasterEquation::at(delayed, &initial(reforming), velocity).unwrap()
}

fn pulled(thresholds: &SharedLaw, delay: f64, velocity: f64, tolerance: f64) -> Pull {
    equation(thresholds, &point(0.0), delay, velocity).pull_with(8.0, tolerance, &mut ()).unwrap()
}

fn force(sum: &impl Fn(u32, f64) -> Sum, wait: f64, position: f64) -> f64 {
    let generation = |n: u32| {
        let u = position - f64::from(n) * wait;
        if u <= 0.0 {
            return 0.0;
        }
        let ((_, before), (below, after)) = (sum(n, u), sum(n + 1, u));
        before - after - (u * below - after) / f64::from(n + 1)
    };
    (0..60).map(generation).sum()
}

fn agree(name: &str, pull: &Pull, expected: impl Fn(f64) -> f64, tolerance: f64) {
    for k in 1..=400_u32 {
        let position = pull.distance() * (0.618_033_988_749_895 * f64::from(k)).fract();
        let (got, expected) = (pull.force(position), expected(position));
        let error = (got - expected).abs();
        assert!(error <= tolerance, "{name}: {got:.15}, not {expected:.15}, at X = {position}: {error:e}");
    }
}

fn certain(sum: f64, u: f64) -> Sum {
    (f64::from(u8::from(u >= sum)), (u - sum).max(0.0))
}

/// n numbers that are uniform on [low, high]: a shifted Irwin–Hall sum. Up to X = 8 the terms of its alternating sum are below
/// 50, which costs two digits.
fn uniform(low: f64, high: f64) -> impl Fn(u32, f64) -> Sum {
    move |n, u| {
        let (start, width, count) = (f64::from(n) * low, high - low, f64::from(n));
        if n == 0 {
            return certain(0.0, u);
        }
        if u >= start + count * width {
            return (1.0, u - start - 0.5 * count * width);
        }
        let (t, mut choose, mut sums) = ((u - start) / width, 1.0, (0.0, 0.0));
        let factorial: f64 = (1..=n).map(f64::from).product();
        for j in 0..=n {
            let left = (t - f64::from(j)).max(0.0);
            let sign = if j % 2 == 0 { choose } else { -choose };
            sums.0 += sign * left.powi(n as i32) / factorial;
            sums.1 += sign * left.powi(n as i32 + 1) / (factorial * (count + 1.0));
            choose *= (count - f64::from(j)) / f64::from(j + 1);
        }
        (sums.0, width * sums.1)
    }
}

/// A sum of numbers each of which is a point with probability p, else of a gamma distribution; with p = 0 of that alone.
fn points_and_gamma(p: f64, at: f64, mean: f64, std: f64) -> impl Fn(u32, f64) -> Sum {
    move |n, u| {
        let (mut out, mut binomial) = ((0.0, 0.0), (1.0 - p).powi(n as i32));
        for points in 0..=n {
            let (place, spread) = (u - at * f64::from(points), f64::from(n - points));
            let (below, path) = if n == points {
                certain(0.0, place)
            } else if place > 0.0 {
                let sum = Gamma::new(spread * mean, spread.sqrt() * std).unwrap();
                let below = sum.cumulative(place);
                (below, place * below - (sum.mean() - sum.upper_moment(1, place)))
            } else {
                (0.0, 0.0)
            };
            out = (out.0 + binomial * below, out.1 + binomial * path);
            binomial *= if p > 0.0 { p / (1.0 - p) * spread / f64::from(points + 1) } else { 0.0 };
        }
        out
    }
}

#[test]
fn identical_contacts_are_free_together() {
    for (delay, velocity) in [(2.0, 3.0), (0.7, 0.5), (0.3, 1.0)] {
        let pull = pulled(&point(1.0), delay, velocity, PROMISED);
        let period = 1.0 + delay * velocity;
        let stretch = |x: f64| x % period;
        agree("point", &pull, |x| if stretch(x) < 1.0 { stretch(x) } else { 0.0 }, ROUNDING);
        let peak = pull.static_friction().unwrap();
        assert!((peak.position - 1.0).abs() < ROUNDING && (peak.value - 1.0).abs() < ROUNDING, "{peak:?}");
    }
}

#[test]
fn thresholds_with_edges() {
    for (low, high, delay, velocity) in [(0.5, 1.5, 0.7, 0.5), (0.9, 1.1, 2.0, 3.0), (0.5, 1.5, 0.1, 1.0)] {
        let pull = pulled(&rectangular(low, high), delay, velocity, PROMISED);
        agree("rectangular", &pull, |x| force(&uniform(low, high), delay * velocity, x), ROUNDING);
    }
}

#[test]
fn thresholds_with_points_and_a_density() {
    let thresholds = mixture(&[(0.4, point(0.7)), (0.6, gamma(1.1, 0.22))]);
    let sum = points_and_gamma(0.4, 0.7, 1.1, 0.22);
    for (delay, velocity) in [(0.7, 0.5), (2.0, 3.0)] {
        let pull = pulled(&thresholds, delay, velocity, PROMISED);
        agree("mixture", &pull, |x| force(&sum, delay * velocity, x), ROUNDING);
    }
}

#[test]
fn thresholds_that_begin_at_zero() {
    let sum = points_and_gamma(0.0, 0.0, 1.0, 1.0);
    let pull = pulled(&exponential(1.0), 0.7, 0.5, PROMISED);
    agree("exponential", &pull, |x| force(&sum, 0.35, x), ROUNDING);
    let sum = points_and_gamma(0.0, 0.0, 1.0, 0.6);
    let pull = pulled(&gamma(1.0, 0.6), 0.7, 0.5, PROMISED);
    agree("gamma", &pull, |x| force(&sum, 0.35, x), PROMISED * MEAN_LIFE);
}

/// Re-formed contacts carry a force at once: F jumps up a delay after contacts broke together.
#[test]
fn contacts_that_re_form_stretched() {
    let pull = equation(&point(1.0), &point(0.25), 0.7, 0.5).pull_with(8.0, PROMISED, &mut ()).unwrap();
    let stretch = |x: f64| 0.25 + x % (0.75 + 0.35);
    agree("point", &pull, |x| if stretch(x) < 1.0 { stretch(x) } else { 0.0 }, ROUNDING);
}

/// The population that a block moves has the same curve.
#[test]
fn a_population_moves_along_the_same_curve() {
    let equation = equation(&rectangular(0.5, 1.5), &point(0.0), 0.7, 0.5);
    let mut population = equation.population_with(PROMISED, &mut ()).unwrap();
    let sum = uniform(0.5, 1.5);
    for k in 1..80 {
        let to = 0.1 * f64::from(k);
        while population.position() < to - 1e-12 {
            let interval = population.smooth_interval(Direction::Forward, &mut ()).unwrap();
            population.advance(interval.length.min(to - population.position())).unwrap();
        }
        let (got, expected) = (population.ahead(0.0).force, force(&sum, 0.35, population.position()));
        assert!((got - expected).abs() < PROMISED * MEAN_LIFE, "{got}, not {expected}, at X = {to}");
    }
}

/// Contacts that are free for 1e6 or 1e8 of their lives: bursts far apart, between which nothing happens.
#[test]
fn bursts_far_apart_are_found_in_few_cells() {
    let (low, high) = (0.5, 1.5);
    let sum = uniform(low, high);
    for wait in [1e6, 1e8] {
        let equation = equation(&rectangular(low, high), &point(0.0), wait, 1.0);
        let pull = equation.pull(2.5 * wait).unwrap();
        // Some doublings of the width of cells from one burst to the next, and the bursts.
        assert!(pull.cells() < 200, "{}", pull.cells());
        // The promise per life from forming on, and the rounding of positions where the slope is at most 1 in magnitude.
        let aim = PROMISED + 2.0 * wait * f64::EPSILON;
        for generation in 0..3_u32 {
            let start = f64::from(generation) * wait;
            for k in 1..=40 {
                let position = start + 0.11 * f64::from(k);
                let u = position - start;
                let ((_, before), (below, after)) = (sum(generation, u), sum(generation + 1, u));
                let expected = before - after - (u * below - after) / f64::from(generation + 1);
                let error = (pull.force(position) - expected).abs();
                assert!(error < aim, "generation {generation}, {u}: {error:e}");
            }
        }
        assert!(pull.force(0.5 * wait).abs() < aim);
    }
}

/// So many bursts that cells between them do not fit in memory are refused before any work.
#[test]
fn more_bursts_than_cells_are_refused_at_once() {
    let equation = equation(&rectangular(0.5, 1.5), &point(0.0), 1e9, 1.0);
    let refused = equation.pull(1e15).unwrap_err();
    assert!(matches!(refused, asperity::Error::TooLarge { .. }), "{refused}");
}
