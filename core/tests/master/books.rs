//! The books of a pull: Q(x; X) must add up to what the pull says of it, whatever the laws.
//!
//! By quadrature over the stretch densities, with their point masses: ∫Q = 1, ∫xQ = F, ∫x²Q − F² = the variance,
//! F' = 1 − ∫(x − r̄) P Q, Q ≥ 0. Only the densities come from the pull; where they are not smooth is worked out here.

use std::sync::Arc;

use crate::common::{
    contacts, exponential, gamma, gaussian, initial, lognormal, master, mixture, point, rectangular, weibull,
};
use asperity::contacts::{Initial, Start, Stiffness};
use asperity::exact;
use asperity::law::{SharedLaw, Tabulated};
use asperity::master::{MasterEquation, Pull, Stretches};

fn rest() -> SharedLaw {
    point(0.0)
}

/// Eight Gauss–Legendre points on [−1, 1] (Abramowitz & Stegun, table 25.4): abscissas and weights.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Positions of breaks and point masses.
fn knots(law: &SharedLaw) -> Vec<f64> {
    law.breakpoints().iter().map(|b| b.position).chain(law.atoms().iter().map(|a| a.position)).collect()
}

/// Intervals of x on which Q(x; X) is smooth, but for weak breaks: it is not at thresholds' breaks, R's breaks, Q_ini's
/// breaks moved by X, and where the rate of the births, X − Y = x − r, had breaks Y: sums of earlier ones.
fn edges(case: &Case, position: f64, top: f64) -> Vec<f64> {
    let (thresholds, reforming, start) =
        (knots(&case.thresholds), knots(&case.reforming), knots(&case.start));
    let reforming = if reforming.is_empty() { vec![0.0] } else { reforming };
    let mut broken: Vec<f64> =
        thresholds.iter().flat_map(|t| start.iter().map(move |q| t - q)).filter(|&y| y >= 0.0).collect();
    broken.push(0.0);
    let mut latest = broken.clone();
    while !latest.is_empty() && broken.len() < 2000 {
        let next = latest.iter().flat_map(|y| thresholds.iter().map(move |t| y + t));
        let next = next.flat_map(|y| reforming.iter().map(move |r| y - r));
        let mut next: Vec<f64> = next.filter(|&y| y > 0.0 && y < position).collect();
        next.sort_by(f64::total_cmp);
        next.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        next.retain(|y| !broken.iter().any(|b| (b - y).abs() < 1e-12));
        broken.extend(&next);
        latest = next;
    }
    let born = broken.iter().flat_map(|y| reforming.iter().map(move |r| position - y + r));
    let moved = start.iter().map(|q| q + position);
    let even = (0..=case.parts).map(|k| top * k as f64 / case.parts as f64);
    let all = thresholds.iter().chain(&reforming).copied().chain(born).chain(moved).chain(even);
    let mut edges: Vec<f64> = all.filter(|&x| (0.0..=top).contains(&x)).collect();
    edges.sort_by(f64::total_cmp);
    edges.dedup_by(|a, b| (*a - *b).abs() < 1e-13);
    edges
}

struct Case {
    thresholds: SharedLaw,
    reforming: SharedLaw,
    start: SharedLaw,
    relaxed: bool,
    /// Even intervals that resolve the smooth parts.
    parts: usize,
}

fn case(thresholds: SharedLaw, reforming: SharedLaw, start: SharedLaw, parts: usize) -> Case {
    Case { thresholds, reforming, start, relaxed: false, parts }
}

/// Smooth, jumping, pointed, overlapping, relaxed: every kind of law in every place.
fn cases() -> Vec<Case> {
    let half = mixture(&[(0.5, point(1.0)), (0.5, gaussian(0.8, 0.06))]);
    let start = mixture(&[(0.4, point(0.1)), (0.6, rectangular(0.0, 0.3))]);
    let table: SharedLaw = Arc::new(Tabulated::from_density(&[(0.5, 1.0), (0.9, 3.0), (1.3, 2.0)]).unwrap());
    let relaxed = |case: Case| Case { relaxed: true, ..case };
    vec![
        case(gaussian(1.0, 0.05), rest(), gaussian(0.1, 0.025), 120),
        case(gaussian(1.0, 0.1), gaussian(0.2, 0.03), rest(), 120),
        case(gaussian(1.0, 0.15), gaussian(0.7, 0.07), gaussian(0.5, 0.05), 120),
        case(gamma(1.0, 0.3), rest(), rectangular(0.1, 0.5), 200),
        case(weibull(4.0, 1.0), gaussian(0.3, 0.05), rest(), 120),
        case(lognormal(1.0, 0.2), rectangular(0.1, 0.7), point(0.3), 200),
        case(rectangular(0.8, 1.2), rest(), rest(), 60),
        case(rectangular(0.4, 1.6), rectangular(0.0, 0.6), rectangular(0.2, 1.1), 60),
        case(exponential(1.0), gaussian(0.5, 0.08), rest(), 800),
        case(point(1.0), rectangular(0.0, 0.5), gaussian(0.4, 0.05), 120),
        case(half.clone(), rest(), rest(), 120),
        case(half, start.clone(), start.clone(), 120),
        case(table, rest(), start.clone(), 60),
        case(mixture(&[(0.3, point(0.7)), (0.7, point(1.1))]), rest(), start, 60),
        relaxed(case(gaussian(1.0, 0.1), gaussian(0.1, 0.02), gaussian(1.0, 0.2), 120)),
        relaxed(case(rectangular(0.5, 1.5), rest(), rectangular(0.0, 2.0), 60)),
        relaxed(case(
            mixture(&[(0.5, point(0.8)), (0.5, rectangular(0.6, 1.2))]),
            rest(),
            rectangular(0.0, 1.0),
            60,
        )),
    ]
}

/// Sums over Q of several weights at once.
fn sums<const K: usize>(
    density: impl Fn(&[f64]) -> Stretches,
    edges: &[f64],
    weights: impl Fn(f64) -> [f64; K],
) -> ([f64; K], f64) {
    let mut points = Vec::new();
    for pair in edges.windows(2) {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        for (t, w) in GAUSS {
            points.extend([(middle - half * t, half * w), (middle + half * t, half * w)]);
        }
    }
    let state = density(&points.iter().map(|p| p.0).collect::<Vec<_>>());
    let mut totals = [0.0; K];
    let mut add = |x: f64, mass: f64| {
        let at = weights(x);
        (0..K).for_each(|k| totals[k] += mass * at[k]);
    };
    points.iter().zip(&state.density).for_each(|(p, q)| add(p.0, p.1 * q));
    state.atoms.iter().for_each(|a| add(a.position, a.weight));
    let least = state
        .density
        .iter()
        .copied()
        .chain(state.atoms.iter().map(|a| a.weight))
        .fold(f64::INFINITY, f64::min);
    (totals, least)
}

fn solve(case: &Case) -> (MasterEquation, Pull) {
    let start = if case.relaxed { Start::Relaxed } else { Start::Conditional };
    let initial = Initial { law: case.start.clone(), start };
    let master = MasterEquation::new(contacts(&case.thresholds, &case.reforming), &initial).unwrap();
    let pull = master.pull_with(6.0, 1e-12, &mut ()).unwrap_or_else(|e| panic!("{}: {e}", describe(case)));
    (master, pull)
}

fn describe(case: &Case) -> String {
    format!("{:?}, R = {:?}, Q_ini = {:?}", case.thresholds, case.reforming, case.start)
}

#[test]
fn every_distribution_adds_up() {
    for case in cases() {
        let (_, pull) = solve(&case);
        let name = describe(&case);
        let top = case.thresholds.upper_quantile(1e-16);
        // From the start, amid the first breaks, later, and at the very places of point masses.
        for position in [0.0, 0.05, 0.4, 0.77, 1.0, 1.1, 2.345, 5.9] {
            let edges = edges(&case, position, top);
            let law = |x: &[f64]| pull.stretch_density(position, x).unwrap();
            let ([total, first, second], least) = sums(law, &edges, |x| [1.0, x, x * x]);
            assert!(least >= 0.0, "{name}: Q = {least:e} at X = {position}");
            // Eight points to an interval leave out less than this.
            let close = 2e-11;
            assert!((total - 1.0).abs() < close, "{name}: ∫Q − 1 = {:e} at X = {position}", total - 1.0);
            assert!((pull.total_probability(position) - 1.0).abs() < 1e-12, "{name}: {position}");
            let error = (first - pull.force(position)).abs();
            assert!(error < 3.0 * close, "{name}: ∫xQ off F by {error:e} at X = {position}");
            let variance = (second - first * first).max(0.0);
            let error = (variance - pull.force_std(1.0).unwrap()(position).powi(2)).abs();
            assert!(error < 10.0 * close, "{name}: variance off by {error:e} at X = {position}");
        }
    }
}

#[test]
fn what_breaks_is_what_the_force_loses() {
    for case in cases() {
        // Where thresholds have points, what reaches them breaks too: that part of Γ is not P Q.
        if !case.thresholds.atoms().is_empty() {
            continue;
        }
        let (_, pull) = solve(&case);
        let name = describe(&case);
        let top = case.thresholds.upper_quantile(1e-14);
        let back = case.reforming.mean();
        for position in [0.05, 0.77, 1.13, 2.345, 5.9] {
            let edges = edges(&case, position, top);
            let law = |x: &[f64]| pull.stretch_density(position, x).unwrap();
            let hazard = |x: f64| case.thresholds.hazard(x);
            let ([rate, lost], _) = sums(law, &edges, |x| [hazard(x), (x - back) * hazard(x)]);
            // The hazard multiplies what is left out of the far tail of Q.
            let error = (rate - pull.breaking_rate(position)).abs();
            assert!(error < 1e-9, "{name}: ∫PQ off Γ by {error:e} at X = {position}");
            let error = (1.0 - lost - pull.slope(position)).abs();
            assert!(error < 1e-9, "{name}: balance of F' off by {error:e} at X = {position}");
        }
    }
}

#[test]
fn the_start_is_what_was_asked_for() {
    let places = [0.02, 0.1, 0.25, 0.6, 0.9];
    for case in cases() {
        let (_, pull) = solve(&case);
        let state = pull.stretch_density(0.0, &places).unwrap();
        for (x, got) in places.iter().zip(&state.density) {
            // Relaxed: what is above its threshold has gone, some of it to R at once.
            let mut expected = case.start.density(*x);
            if case.relaxed {
                let broken = pull.breaking_atoms().first().map_or(0.0, |a| a.weight);
                expected = expected * case.thresholds.survival(*x) + broken * case.reforming.density(*x);
            }
            assert!((got - expected).abs() < 1e-9 * (1.0 + expected), "{}: {got} at {x}", describe(&case));
        }
        if !case.relaxed {
            let expected = case.start.atoms();
            assert_eq!(state.atoms.len(), expected.len());
            for (got, expected) in state.atoms.iter().zip(expected) {
                assert!((got.weight - expected.weight).abs() < 1e-14 && got.position == expected.position);
            }
        }
    }
}

#[test]
fn late_distributions_are_steady() {
    for case in cases() {
        let (master, _) = solve(&case);
        let relaxation = master.relaxation().unwrap().length();
        assert!(relaxation > 0.0, "{}: X* = {relaxation}", describe(&case));
        if relaxation > 3.0 {
            continue;
        }
        let pull = master.pull_with(30.0 * relaxation, 1e-12, &mut ()).unwrap();
        let steady = master.steady_state();
        // Away from breaks, whose side rounding would decide.
        let places: Vec<f64> = (0..40).map(|k| 0.0137 + 0.0271 * f64::from(k)).collect();
        let (late, settled) = (
            pull.stretch_density(30.0 * relaxation, &places).unwrap(),
            steady.stretch_density(&places).unwrap(),
        );
        for ((x, a), b) in places.iter().zip(&late.density).zip(&settled.density) {
            assert!((a - b).abs() < 1e-9, "{}: {a} and {b} at {x}", describe(&case));
        }
        assert!((pull.force(30.0 * relaxation) - steady.kinetic_friction()).abs() < 1e-10);
        // The steady state adds up as well: its moments are the kinetic friction and the noise.
        let edges = edges(&case, 0.0, case.thresholds.upper_quantile(1e-16));
        let law = |x: &[f64]| steady.stretch_density(x).unwrap();
        let ([total, first, second], least) = sums(law, &edges, |x| [1.0, x, x * x]);
        assert!(least >= 0.0 && (total - 1.0).abs() < 2e-11, "{}: {total} {least}", describe(&case));
        assert!((first - steady.kinetic_friction()).abs() < 6e-11, "{}", describe(&case));
        assert!((second - first * first - steady.force_std(1.0).powi(2)).abs() < 2e-10);
    }
}

#[test]
fn steady_moments_in_closed_form() {
    for law in
        [gaussian(1.0, 0.2), gamma(1.0, 0.4), rectangular(0.5, 1.5), weibull(2.0, 1.0), exponential(1.0)]
    {
        let steady = master(&law, &rest(), &rest()).steady_state();
        let variance = exact::steady_variance(law.as_ref());
        assert!((steady.force_std(7.0).powi(2) * 7.0 - variance).abs() < 1e-12, "{law:?}");
        assert!((steady.breaking_rate() * law.mean() - 1.0).abs() < 1e-13, "{law:?}");
    }
    // Narrow thresholds spread stretches evenly over [0, 1].
    let narrow = master(&gaussian(1.0, 1e-3), &rest(), &rest()).steady_state().force_std(1.0).powi(2);
    assert!((narrow - 1.0 / 12.0).abs() < 1e-6);
    // (⟨x_s²⟩ − ⟨r²⟩)/[2(⟨x_s⟩ − ⟨r⟩)] below all thresholds.
    for reforming in [rectangular(0.0, 0.3), gaussian(0.2, 0.02), point(0.25)] {
        let law = gaussian(1.0, 0.05);
        let expected = exact::kinetic_friction(law.as_ref(), reforming.as_ref());
        let got = master(&law, &reforming, &rest()).steady_state().kinetic_friction();
        assert!((got - expected).abs() < 1e-13, "{reforming:?}: {got}");
    }
}

#[test]
fn noise_in_closed_form() {
    let cases = [(0.05, 0.0, 0.0), (0.1, 0.0, 0.0), (0.1, 0.25, 0.03), (0.05, 0.3, 0.036)];
    for (std, mean, spread) in cases {
        let start = if spread > 0.0 { gaussian(mean, spread) } else { rest() };
        let pull = master(&gaussian(1.0, std), &rest(), &start).pull_with(20.0, 1e-12, &mut ()).unwrap();
        let closed = exact::Gaussian::new(1.0, std).starting_from(mean, spread);
        for k in 0..200 {
            let x = 0.1 * f64::from(k);
            let error = (pull.force_std(1.0).unwrap()(x).powi(2) - closed.variance(x)).abs();
            // Of Q_ini 1e-16 is below 0, and 3e-13 of the pairs of stretch and threshold are ruled out.
            assert!(error < 1e-11, "σ = {std}: {error:e} at {x}");
        }
    }
}

#[test]
fn lengths_and_forces_have_no_unit_of_their_own() {
    // Stretches in any unit, forces for any number and stiffness of contacts: the same curve.
    let solve = |unit: f64, count: f64, stiffness: f64| {
        let law = |mean: f64, std: f64| gaussian(mean * unit, std * unit);
        let mut contacts = contacts(&law(1.0, 0.1), &law(0.2, 0.02));
        (contacts.count, contacts.stiffness) = (count, Stiffness::Equal(stiffness));
        let master = MasterEquation::new(contacts, &initial(&law(0.1, 0.02))).unwrap();
        let length = master.relaxation().unwrap().length();
        (master.pull_with(20.0 * unit, 1e-10, &mut ()).unwrap(), length)
    };
    let (plain, length) = solve(1.0, 1.0, 1.0);
    for (unit, count, stiffness) in
        [(1e-9, 1e6, 3.0), (1e-6, 1.0, 1e-4), (1e-3, 10.0, 1e9), (1e6, 100.0, 1.0)]
    {
        let (scaled, scaled_length) = solve(unit, count, stiffness);
        let whole = count * stiffness * unit;
        assert!((scaled_length / (length * unit) - 1.0).abs() < 1e-10, "X* in units of {unit:e}");
        for k in 1..=100 {
            let x = 0.2 * f64::from(k) - 0.07;
            let error = (scaled.force(x * unit) / whole - plain.force(x)).abs();
            // Both solve to 1e-10 or better, on meshes that differ by rounding of the unit only.
            assert!(error < 1e-11, "F off by {error:e} at {x} in units of {unit:e}");
            let (noise, expected) =
                (scaled.force_std(1.0).unwrap()(x * unit) / whole, plain.force_std(1.0).unwrap()(x));
            assert!((noise - expected).abs() < 1e-10, "noise {noise}, not {expected} in units of {unit:e}");
        }
        let error = (scaled.critical_stiffness() / (count * stiffness) - plain.critical_stiffness()).abs();
        // A slope: the force over the cells beside its steepest place.
        assert!(error < 1e-8, "K_c off by {error:e} in units of {unit:e}");
        let (a, b) = (scaled.static_friction().unwrap(), plain.static_friction().unwrap());
        assert!((a.value / whole - b.value).abs() < 1e-11 && (a.position / unit - b.position).abs() < 1e-9);
    }
}
