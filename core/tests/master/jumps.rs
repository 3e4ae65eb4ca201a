//! Thresholds with jumps and point masses against closed forms: sums of uniform numbers, of points, of exponentials.
//!
//! The n-th break (n = 0, 1, …) of a contact is at T_n = ξ₀ − q + Σ_{i=1}^n (ξ_i − r_i) and costs it ξ_n − r_{n+1}, so that
//! where R and Q_ini lie below all thresholds F/(N_c⟨k⟩) = q̄ + X − Σ_n {E[ξ_n; T_n ≤ X] − r̄ P(T_n ≤ X)}. Everything that
//! is uniform here has one width, so that T_n is a shifted sum of m uniform numbers (Irwin–Hall).

use std::sync::Arc;

use crate::common::{
    contacts, exponential, gamma, gaussian, initial, master, mixture, point, rectangular, weibull,
};
use asperity::contacts::{Initial, Start, Stiffness};
use asperity::exact::{self, ClosedForm, Erlang};
use asperity::law::{SharedLaw, Tabulated};
use asperity::master::{MasterEquation, Pull};

/// Asked for, and reached.
const PROMISED: f64 = 1e-10;

/// Hundreds of positions up to 50, each right to 1e-14.
const ROUNDING: f64 = 5e-13;

fn rest() -> SharedLaw {
    point(0.0)
}

fn pulled(thresholds: &SharedLaw, reforming: &SharedLaw, start: &SharedLaw, distance: f64) -> Pull {
    master(thresholds, reforming, start).pull_with(distance, PROMISED, &mut ()).unwrap()
}

/// Compares over (0, distance) at points that fall on no lattice.
fn agree(name: &str, pull: &Pull, expected: impl Fn(f64) -> f64, tolerance: f64) {
    for k in 1..=300_u32 {
        let position = pull.distance() * (0.618_033_988_749_895 * f64::from(k)).fract();
        let (got, expected) = (pull.force(position), expected(position));
        let error = (got - expected).abs();
        assert!(error <= tolerance, "{name}: {got:.15}, not {expected:.15}, at X = {position}: {error:e}");
    }
}

/// P(S ≤ t) and E[S; S ≤ t] of the sum S of m uniform numbers, from the textbook alternating sum: at most m/2 terms are
/// used, and up to m = 20 they lose four digits.
fn uniform_sum(m: i32, t: f64) -> (f64, f64) {
    let whole = 0.5 * f64::from(m);
    if m == 0 {
        return (if t >= 0.0 { 1.0 } else { 0.0 }, 0.0);
    }
    if t <= 0.0 {
        return (0.0, 0.0);
    }
    if t >= f64::from(m) {
        return (1.0, whole);
    }
    if t > whole {
        let (below, part) = uniform_sum(m, f64::from(m) - t);
        // m − S is such a sum too.
        return (1.0 - below, whole - (f64::from(m) * below - part));
    }
    let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
    let (mut below, mut path) = (0.0, 0.0);
    let mut choose = 1.0;
    for j in 0..=(t as i32) {
        let gap = t - f64::from(j);
        below += choose * gap.powi(m) / factorial(m);
        path += choose * gap.powi(m + 1) / factorial(m + 1);
        choose *= -f64::from(m - j) / f64::from(j + 1);
    }
    (below, t * below - path)
}

/// Part of a law: a uniform stretch of the common width from `low` on, or a point.
#[derive(Clone, Copy)]
enum Part {
    Uniform(f64),
    At(f64),
}

/// F for thresholds made of such parts, R = δ(r), Q_ini = δ(q): every way to draw n + 1 of them.
fn sums(parts: &[(f64, Part)], width: f64, (reforming, start): (f64, f64), position: f64) -> f64 {
    let mut force = start + position;
    for n in 0.. {
        let reach = position + start + f64::from(n) * reforming;
        let (below, part) = drawn(parts, width, n + 1, reach);
        force -= part / f64::from(n + 1) - reforming * below;
        if below < 1e-18 {
            return force;
        }
    }
    force
}

/// P(S ≤ x) and E[S; S ≤ x] of the sum S of `count` draws.
fn drawn(parts: &[(f64, Part)], width: f64, count: i32, x: f64) -> (f64, f64) {
    let mut total = (0.0, 0.0);
    let mut visit = |weight: f64, shift: f64, uniforms: i32| {
        let (below, part) = uniform_sum(uniforms, (x - shift) / width + 1e-13);
        total = (total.0 + weight * below, total.1 + weight * (shift * below + width * part));
    };
    choose(parts, count, (1.0, 0.0, 0), &mut visit);
    total
}

/// Visits every multiset of `count` parts: its probability, the sum of its places and the number of uniform ones.
fn choose(
    parts: &[(f64, Part)],
    count: i32,
    (weight, shift, uniforms): (f64, f64, i32),
    visit: &mut impl FnMut(f64, f64, i32),
) {
    let Some(((share, part), others)) = parts.split_first() else {
        if count == 0 {
            visit(weight, shift, uniforms);
        }
        return;
    };
    let mut ways = weight;
    for k in 0..=count {
        let (place, uniform) = match part {
            Part::Uniform(low) => (low, 1),
            Part::At(at) => (at, 0),
        };
        choose(others, count - k, (ways, shift + f64::from(k) * place, uniforms + k * uniform), visit);
        ways *= share * f64::from(count - k) / f64::from(k + 1);
    }
}

#[test]
fn rectangular_thresholds_of_every_width() {
    for half in [1e-3, 0.01, 0.1, 0.25, 0.5, 0.9, 1.0] {
        let pull = pulled(&rectangular(1.0 - half, 1.0 + half), &rest(), &rest(), 50.0);
        let closed = exact::Rectangular { min: 1.0 - half, max: 1.0 + half };
        agree(&format!("±{half}"), &pull, |x| closed.force(x), PROMISED);
        let (place, peak) = closed.static_friction().unwrap();
        let got = pull.static_friction().unwrap();
        assert!(
            (got.value - peak).abs() < PROMISED && (got.position - place).abs() < PROMISED,
            "±{half}: {got:?}"
        );
        // F' of a polynomial of degree 15 over a cell of width ≥ 1e-3.
        let error = (pull.critical_stiffness() / closed.critical_stiffness() - 1.0).abs();
        assert!(error < 1e-8, "±{half}: K_c off by {error:e}");
    }
}

#[test]
fn a_force_that_falls_from_the_start_is_largest_there() {
    // All contacts are stretched by 1.2, which only the strongest hold: F(0) = 1.2, and what re-forms at 0 carries far less later.
    let pull = pulled(&gaussian(1.0, 0.1), &rest(), &point(1.2), 3.0);
    let peak = pull.static_friction().unwrap();
    assert!(peak.position == 0.0 && (peak.value - 1.2).abs() < PROMISED, "{peak:?}");
    // Contacts that begin at 0 and those that begin weakly stretched carry more later.
    let weakly = pulled(&gaussian(1.0, 0.1), &rest(), &point(0.1), 3.0).static_friction().unwrap();
    assert!(weakly.position > 0.5 && weakly.value > 0.5, "{weakly:?}");
}

#[test]
fn values_of_the_theory() {
    let quarter = pulled(&rectangular(0.75, 1.25), &rest(), &rest(), 5.0);
    for (position, force) in [(0.95, 0.61), (1.05, 0.51), (2.5, 0.483_072_916_667)] {
        assert!((quarter.force(position) - force).abs() < 4e-13, "{position}");
    }
    let erlang = pulled(&gamma(1.0, 0.5), &rest(), &rest(), 5.0);
    for (position, force) in [(0.5, 0.447_109_327_925_00), (2.0, 0.624_569_375_803_77)] {
        assert!((erlang.force(position) - force).abs() < 1e-12, "{position}");
    }
    let peak = pulled(&gamma(1.0, 0.25), &rest(), &rest(), 5.0).static_friction().unwrap();
    // A maximum of a force that is accurate to 1e-12, found as the root of its slope.
    assert!((peak.position - 0.778_501_258_994_85).abs() < 1e-11);
    assert!((peak.value - 0.650_574_116_984_49).abs() < 1e-12);
    // Δ = x_s: X_s = w ln 2, F_s = w (2 ln 2 − 1), K_c = e − 2; narrow ones peak in a cusp at a with K_c = a/2Δ.
    let all = pulled(&rectangular(0.0, 2.0), &rest(), &rest(), 5.0);
    let (peak, log) = (all.static_friction().unwrap(), 2.0_f64.ln());
    assert!(
        (peak.position - 2.0 * log).abs() < 1e-11 && (peak.value - 2.0 * (2.0 * log - 1.0)).abs() < 1e-12
    );
    assert!((all.critical_stiffness() - (std::f64::consts::E - 2.0)).abs() < 1e-10);
    for half in [0.05, 0.2, 1.0 / 3.0] {
        let narrow = pulled(&rectangular(1.0 - half, 1.0 + half), &rest(), &rest(), 5.0);
        let peak = narrow.static_friction().unwrap();
        assert!((peak.position - (1.0 - half)).abs() < 1e-12 && (peak.value - (1.0 - half)).abs() < 1e-12);
        assert!((narrow.critical_stiffness() - 0.5 * (1.0 - half) / half).abs() < 1e-10 / half);
    }
}

#[test]
fn sums_of_exponentials() {
    for shape in [1_u32, 2, 3, 4, 7, 16] {
        let law = gamma(1.0, 1.0 / f64::from(shape).sqrt());
        let closed = Erlang::with_mean(shape, 1.0);
        agree(
            &format!("Erlang {shape}"),
            &pulled(&law, &rest(), &rest(), 50.0),
            |x| closed.force(x),
            PROMISED,
        );
    }
    for std in [0.15, 0.3, 0.7, 1.2] {
        let closed = exact::Gamma { mean: 1.0, std };
        let pull = pulled(&gamma(1.0, std), &rest(), &rest(), 20.0);
        agree(&format!("gamma of std {std}"), &pull, |x| closed.force(x), PROMISED);
    }
    let closed = |x: f64| 1.0 - (-x).exp();
    agree("exponential", &pulled(&exponential(1.0), &rest(), &rest(), 50.0), closed, PROMISED);
    agree("Weibull of shape 1", &pulled(&weibull(1.0, 1.0), &rest(), &rest(), 50.0), closed, PROMISED);
}

#[test]
fn contacts_without_memory_place_themselves_anywhere() {
    // Exponential thresholds break at the rate 1/x̄ whatever the stretch: F' = 1 − (F − r̄)/x̄, wherever R and Q_ini are.
    let laws = [gamma(0.3, 0.1), rectangular(0.5, 2.5), weibull(1.2, 0.4), gaussian(1.5, 0.2), point(3.0)];
    for (reforming, start) in laws.iter().zip(laws.iter().rev()) {
        let pull = pulled(&exponential(1.0), reforming, start, 20.0);
        let (settled, first) = (1.0 + reforming.mean(), start.mean());
        let closed = |x: f64| settled + (first - settled) * (-x).exp();
        agree(&format!("{reforming:?}, {start:?}"), &pull, closed, 3.0 * PROMISED);
        // ⟨x²⟩' = 2F − (⟨x²⟩ − ⟨r²⟩)/x̄.
        let second = |law: &SharedLaw| law.std().powi(2) + law.mean().powi(2);
        let most = 2.0 * settled + second(reforming);
        for x in [0.3, 2.7, 11.0] {
            let square = most + (second(start) - most + 2.0 * (first - settled) * x) * (-x).exp();
            let (got, expected) = (pull.force_std(1.0).unwrap()(x).powi(2), square - closed(x).powi(2));
            let error = (got - expected).abs();
            assert!(error < 10.0 * PROMISED, "{reforming:?}, {start:?}: {got}, not {expected}: {error:e}");
        }
    }
}

#[test]
fn mixtures_of_rectangles_and_points() {
    let width = 0.25;
    let parts = [(0.5, Part::Uniform(0.75)), (0.25, Part::At(0.9)), (0.25, Part::Uniform(1.1))];
    let law = mixture(&[(0.5, rectangular(0.75, 1.0)), (0.25, point(0.9)), (0.25, rectangular(1.1, 1.35))]);
    for place in [(0.0, 0.0), (0.2, 0.0), (0.3, 0.45)] {
        let pull = pulled(&law, &point(place.0), &point(place.1), 8.0);
        agree(&format!("{place:?}"), &pull, |x| sums(&parts, width, place, x), PROMISED);
        assert_eq!(pull.critical_stiffness(), f64::INFINITY);
    }
}

#[test]
fn tables_and_samples() {
    // The triangle on [0.6, 1.4] is the sum of two uniform numbers on [0.3, 0.7].
    let triangle: SharedLaw =
        Arc::new(Tabulated::from_density(&[(0.6, 0.0), (1.0, 3.0), (1.4, 0.0)]).unwrap());
    let closed = |x: f64| {
        let lost = |n: i32| {
            let (below, part) = uniform_sum(2 * n, (x - 0.6 * f64::from(n)) / 0.4);
            (0.6 * f64::from(n) * below + 0.4 * part) / f64::from(n)
        };
        x - (1..20).map(lost).sum::<f64>()
    };
    agree("triangle", &pulled(&triangle, &rest(), &rest(), 7.0), closed, PROMISED);
    let samples: SharedLaw = Arc::new(Tabulated::from_samples(&[0.8, 1.0, 0.6, 0.8]).unwrap());
    let third = 1.0 / 3.0;
    let parts = [(third, Part::Uniform(0.6)), (third, Part::At(0.8)), (third, Part::Uniform(0.8))];
    agree(
        "samples",
        &pulled(&samples, &rest(), &rest(), 7.0),
        |x| sums(&parts, 0.2, (0.0, 0.0), x),
        PROMISED,
    );
    // A table of a rectangle is that rectangle.
    let table: SharedLaw = Arc::new(Tabulated::from_density(&[(0.7, 1.0), (0.9, 1.0), (1.3, 1.0)]).unwrap());
    let closed = exact::Rectangular { min: 0.7, max: 1.3 };
    agree("rectangle", &pulled(&table, &rest(), &rest(), 30.0), |x| closed.force(x), PROMISED);
}

#[test]
fn rectangles_everywhere() {
    // Thresholds, R and Q_ini uniform on stretches of one width: T_n has 2n + 2 uniform terms.
    let (width, lowest, reforming, start) = (0.2, 0.9, 0.05, 0.1);
    let law = |low: f64| rectangular(low, low + width);
    let pull = pulled(&law(lowest), &law(reforming), &law(start), 8.0);
    let closed = |x: f64| {
        let mut force = start + 0.5 * width + x;
        for n in 0..12_i32 {
            let shift = f64::from(n + 1) * lowest - (start + width) - f64::from(n) * (reforming + width);
            let terms = 2 * n + 2;
            let (below, part) = uniform_sum(terms, (x - shift) / width);
            force -= (lowest - reforming - 0.5 * width) * below + width * part / f64::from(terms);
        }
        force
    };
    agree("rectangles", &pull, closed, PROMISED);
}

/// F of thresholds at `places` (in steps of a lattice), R = δ(r), Q_ini = δ(q), by adding up who breaks where.
fn lattice(places: &[(usize, f64)], (reforming, start): (usize, usize), steps: usize) -> Vec<f64> {
    let mut broken = vec![0.0; steps + 1];
    let mut lost = vec![0.0; steps + 1];
    for at in 0..=steps {
        for &(place, weight) in places {
            let first = if at + start == place { weight } else { 0.0 };
            let before = (at + reforming).checked_sub(place).filter(|&b| b < at);
            let share = first + before.map_or(0.0, |b| weight * broken[b]);
            broken[at] += share;
            lost[at] += share * (place - reforming) as f64;
        }
    }
    let mut gone = 0.0;
    (0..=steps)
        .map(|at| {
            gone += lost[at];
            (start + at) as f64 - gone
        })
        .collect()
}

#[test]
fn points_are_exact() {
    type Places = &'static [(usize, f64)];
    let cases: [(Places, (usize, usize)); 5] = [
        (&[(10, 1.0)], (0, 0)),
        (&[(10, 1.0)], (3, 8)),
        (&[(10, 0.5), (20, 0.5)], (0, 0)),
        (&[(7, 0.2), (9, 0.5), (12, 0.3)], (0, 0)),
        (&[(7, 0.2), (9, 0.5), (12, 0.3)], (2, 5)),
    ];
    let step = 0.1;
    for (places, (reforming, start)) in cases {
        let law = mixture(&places.iter().map(|&(p, w)| (w, point(p as f64 * step))).collect::<Vec<_>>());
        let pull = pulled(&law, &point(reforming as f64 * step), &point(start as f64 * step), 50.0);
        let forces = lattice(places, (reforming, start), 500);
        for (at, force) in forces.iter().enumerate().take(500) {
            // Between the points of the lattice F rises with the slider.
            for part in [0.03, 0.5, 0.97] {
                let got = pull.force((at as f64 + part) * step);
                let expected = (force + part) * step;
                assert!((got - expected).abs() < ROUNDING, "{places:?} {at} {part}: {got}, not {expected}");
            }
        }
        // The rule at a break: after it.
        assert!((pull.force(49.0) - forces[490] * step).abs() < ROUNDING);
    }
}

#[test]
fn points_that_share_no_lattice() {
    let parts =
        [(0.4, Part::At(0.7)), (0.35, Part::At(1.0 / 1.1)), (0.25, Part::At(std::f64::consts::SQRT_2))];
    let law =
        mixture(&[(0.4, point(0.7)), (0.35, point(1.0 / 1.1)), (0.25, point(std::f64::consts::SQRT_2))]);
    let pull = pulled(&law, &rest(), &rest(), 12.0);
    agree("three points", &pull, |x| sums(&parts, 1.0, (0.0, 0.0), x), ROUNDING);
}

#[test]
fn identical_thresholds_with_a_broad_start() {
    // Q(x; X) = Q_ini((x − X) mod x_s): each stretch goes round for ever.
    let pull = pulled(&point(1.0), &rest(), &rectangular(0.1, 0.5), 30.0);
    let closed = |x: f64| {
        let primitive = |y: f64| 0.5 * y.floor() + 0.5 * y.fract().powi(2);
        (primitive(0.5 + x) - primitive(0.1 + x)) / 0.4
    };
    agree("rectangular start", &pull, closed, PROMISED);
    let state = pull.stretch_density(17.8, &[0.05, 0.25, 0.35, 0.8, 0.95]).unwrap();
    for (got, expected) in state.density.iter().zip([2.5, 2.5, 0.0, 0.0, 2.5]) {
        assert!((got - expected).abs() < 1e-8, "{state:?}");
    }
}

#[test]
fn identical_thresholds_with_broad_reforming_converge() {
    // u = 1 − r is uniform on [0.6, 1]: F = X − Σ over breaks of 1 − r, sums of uniform numbers again.
    let pull = pulled(&point(1.0), &rectangular(0.0, 0.4), &rectangular(0.0, 0.4), 9.0);
    let closed = |x: f64| {
        let lost = |n: i32| uniform_sum(n, (x - 0.6 * f64::from(n)) / 0.4).0 * 0.8;
        0.2 + x - (1..16).map(lost).sum::<f64>()
    };
    agree("points, broad R", &pull, closed, PROMISED);
}

#[test]
fn stiffness_proportional_to_the_threshold() {
    // Gamma thresholds of integer shape a: T_n is gamma of shape na, and of T_n a threshold is a Beta(a, (n−1)a) share.
    // F/κ = E[ξ x] = x̄ Σ_{n≥0} ∫P(T_n ≤ ·) − Σ_{n≥1} {∫E[ξ; T_n ≤ ·] + E[ξ²; T_n ≤ X]}.
    for shape in [1_u32, 2, 5, 9] {
        let rate = f64::from(shape);
        let mut contacts = contacts(&gamma(1.0, rate.sqrt().recip()), &rest());
        (contacts.count, contacts.stiffness) = (40.0, Stiffness::PerThreshold(2.5));
        let master = MasterEquation::new(contacts, &initial(&rest())).unwrap();
        let pull = master.pull_with(15.0, PROMISED, &mut ()).unwrap();
        let below = |shape: u32, x: f64| {
            let mut term = (-rate * x).exp();
            let mut above = 0.0;
            for i in 0..shape {
                above += term;
                term *= rate * x / f64::from(i + 1);
            }
            1.0 - above
        };
        let closed = |x: f64| {
            let mut force = x;
            for n in 1..80_u32 {
                let total = n * shape;
                let mean = f64::from(n);
                let square = mean * (f64::from(total) + 1.0) / rate;
                let (p, first) = (below(total, x), mean * below(total + 1, x));
                let second = square * below(total + 2, x);
                let path = x * p - first;
                let broken = (rate + 1.0) / (mean * (f64::from(total) + 1.0)) * second;
                force += path - (x * first - second) / mean - broken;
            }
            100.0 * force
        };
        agree(&format!("shape {shape}"), &pull, closed, 300.0 * PROMISED);
        let steady = exact::steady_variance_per_threshold(gamma(1.0, rate.sqrt().recip()).as_ref());
        let got = (master.steady_state().force_std(40.0) / 100.0).powi(2) * 40.0;
        // The default tolerance of the pull, 1e-10.
        assert!((got / steady - 1.0).abs() < 1e-10, "shape {shape}: {got}, not {steady}");
    }
}

#[test]
fn a_relaxed_start_breaks_what_is_above_its_threshold_at_once() {
    // Every contact at q within [a, b]: those with lower thresholds restart from 0, the others break at ξ − q.
    let (low, high, start) = (0.8, 1.2, 0.95);
    let width = high - low;
    let contacts = contacts(&rectangular(low, high), &rest());
    let relaxed = Initial { law: point(start), start: Start::Relaxed };
    let pull = MasterEquation::new(contacts, &relaxed).unwrap().pull_with(6.0, PROMISED, &mut ()).unwrap();
    let fresh = exact::Rectangular { min: low, max: high };
    let gone = (start - low) / width;
    let closed = |x: f64| {
        let unbroken = (start + x) * (high - start - x).max(0.0) / width;
        // F of the others between the knots na + kw of F, by Simpson's rule in steps that leave out 1e-14.
        let top = x.min(high - start);
        let knots = (0..8).flat_map(|n| (0..=n).map(move |k| (n, k)));
        let knots = knots.map(|(n, k)| x - (f64::from(n) * low + f64::from(k) * width));
        let mut edges: Vec<f64> = knots.filter(|&u| u > 0.0 && u < top).chain([0.0, top]).collect();
        edges.sort_by(f64::total_cmp);
        let simpson = |a: f64, b: f64| {
            let h = (b - a) / 400.0;
            let weight = |i: i32| if i == 0 || i == 400 { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
            (0..=400).map(|i| weight(i) * fresh.force(x - a - f64::from(i) * h)).sum::<f64>() * h / 3.0
        };
        let again: f64 = edges.windows(2).map(|pair| simpson(pair[0], pair[1])).sum();
        gone * fresh.force(x) + unbroken + again / width
    };
    agree("relaxed", &pull, closed, PROMISED);
    assert!((pull.force(0.0) - (1.0 - gone) * start).abs() < ROUNDING);
    let first = pull.breaking_atoms()[0];
    assert!(first.position == 0.0 && (first.weight - gone).abs() < ROUNDING);
    // All above: the same as a start from R.
    let above = Initial { law: rectangular(2.0, 3.0), start: Start::Relaxed };
    let contacts = crate::common::contacts(&rectangular(low, high), &rest());
    let pull = MasterEquation::new(contacts, &above).unwrap().pull_with(6.0, PROMISED, &mut ()).unwrap();
    agree("all above", &pull, |x| fresh.force(x), PROMISED);
}

/// An initial distribution that ends δ below the highest threshold gives the solution cells of width δ. F moves with it
/// by no more than the mass that moves, 2δ/1.5, times the force of a contact at its threshold, 1.5; twice that is allowed,
/// and differences of rounding.
#[test]
fn an_initial_distribution_that_ends_just_below_the_highest_threshold() {
    let thresholds = rectangular(0.5, 1.5);
    let pull_from = |gap: f64| pulled(&thresholds, &rest(), &rectangular(0.0, 1.5 - gap), 5.0);
    let reference = pull_from(1e-5);
    for gap in [2e-9, 1e-8, 3e-8, 1e-7, 1e-6] {
        let pull = pull_from(gap);
        let allowed = 4.0 * (1e-5 - gap) + ROUNDING;
        for edge in (0..10).map(|k| 0.5 * f64::from(k)) {
            for beyond in [0.0, 0.3 * gap, 0.9 * gap, 3.0 * gap, 1e-3] {
                let (got, expected) = (pull.force(edge + beyond), reference.force(edge + beyond));
                let off = (got - expected).abs();
                assert!(off <= allowed, "{gap:e}: {got}, not {expected}, {beyond:e} after X = {edge}");
            }
        }
    }
}

/// Where contacts break together at the end of a pull they have broken there, as in a longer pull.
#[test]
fn contacts_that_break_at_the_end_of_a_pull_have_broken() {
    let [first, second, spread] = [point(0.5), point(1.25), rectangular(0.2, 0.4)];
    let several = mixture(&[(0.25, first), (0.75, second)]);
    let beside = mixture(&[(0.5, point(0.6)), (0.5, spread)]);
    for (thresholds, distances) in [
        (point(1.0), [1.0, 3.0, 5.0, 20.0]),
        (point(0.7), [0.7, 3.5, 7.0, 14.7]),
        (several, [3.25, 4.5, 5.75, 8.0]),
        (beside, [0.6, 3.0, 6.0, 6.6]),
    ] {
        let longer = pulled(&thresholds, &rest(), &rest(), 25.0);
        for distance in distances {
            let pull = pulled(&thresholds, &rest(), &rest(), distance);
            let apart = (pull.force(distance) - longer.force(distance)).abs();
            // Both are accurate to the required 1e-10 of a mean life.
            assert!(apart < 2e-10, "{}, {distance}: {apart:e}", thresholds.name());
            let [std, expected] = [&pull, &longer].map(|pull| pull.force_std(100.0).unwrap()(distance));
            let [variance, known] =
                [&pull, &longer].map(|pull| pull.covariance(&[distance], 100.0).unwrap().at(0, 0));
            // A standard deviation is the root of a difference of such numbers.
            assert!((std - expected).abs() < 2e-6, "{distance}: {std} {expected}");
            assert!((variance - known).abs() < 1e-9, "{distance}: {variance} {known}");
        }
    }
}
