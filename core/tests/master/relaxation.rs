//! Relaxation to steady sliding: lengths and roots of the theory, roots counted by the argument principle, the expansion
//! against the pull.

use std::sync::Arc;

use crate::common::{exponential, gamma, gaussian, lognormal, master, mixture, point, rectangular, weibull};
use asperity::exact::{self, Erlang};
use asperity::law::{SharedLaw, Tabulated};
use num_complex::Complex64;

fn rest() -> SharedLaw {
    point(0.0)
}

/// A density that falls linearly to 0 at its end.
fn tabulated() -> SharedLaw {
    Arc::new(Tabulated::from_density(&[(0.5, 0.0), (1.0, 2.0), (1.6, 0.0)]).unwrap())
}

fn length(thresholds: &SharedLaw) -> f64 {
    master(thresholds, &rest(), &rest()).relaxation().unwrap().length()
}

/// Mean 1 and a coefficient of variation of exactly 0.1: a shape of 12.153, unrounded.
fn tenth_weibull() -> SharedLaw {
    let moment = |shape: f64, n: f64| libm::tgamma(1.0 + n / shape);
    let (mut low, mut high) = (12.0, 12.5);
    for _ in 0..60 {
        let shape = 0.5 * (low + high);
        let square = moment(shape, 2.0) / moment(shape, 1.0).powi(2);
        if square > 1.01 { low = shape } else { high = shape }
    }
    weibull(low, 1.0 / moment(low, 1.0))
}

#[test]
fn lengths_of_the_theory() {
    let known: [(SharedLaw, f64, f64); 10] = [
        (gaussian(1.0, 0.05), 20.270_485_418_3, 1e-10),
        (gaussian(1.0, 0.1), 5.090_975_936_8, 1e-10),
        (gaussian(1.0, 0.2), 1.361_724_702_6, 1e-10),
        (gamma(1.0, 0.1), 5.067_726_177_8, 1e-10),
        (tenth_weibull(), 5.337_740_935_3, 1e-10),
        (rectangular(0.9, 1.1), 15.004_490, 1e-6),
        (rectangular(0.7, 1.3), 1.583_433, 1e-6),
        (rectangular(0.5, 1.5), 0.823_987, 1e-6),
        (rectangular(0.0, 2.0), 0.957_468, 1e-6),
        (lognormal(1.0, 0.1), 5.067_801_966_6, 1e-10),
    ];
    for (law, expected, digits) in known {
        let got = length(&law);
        // The digits given.
        assert!((got - expected).abs() < digits, "{law:?}: {got}, not {expected}");
    }
}

#[test]
fn the_papers_estimate_crosses_the_length_at_its_own_figure() {
    let both = |std: f64| {
        let relaxation = master(&gaussian(1.0, std), &rest(), &rest()).relaxation().unwrap();
        (relaxation.length(), relaxation.paper_estimate())
    };
    assert!((both(0.05).1 - 20.0).abs() < 1e-12);
    assert!(both(0.0506).0 > both(0.0506).1 && both(0.0508).0 < both(0.0508).1);
    // X* → x̄³/(2π²σ²), corrections of order σ².
    let limit = 1e6 / (2.0 * std::f64::consts::PI.powi(2));
    assert!((both(1e-3).0 / limit - 1.0).abs() < 1e-4);
}

#[test]
fn roots_in_closed_form() {
    for std in [0.02, 0.05, 0.1] {
        let closed = exact::Gaussian::new(1.0, std);
        let relaxation = master(&gaussian(1.0, std), &rest(), &rest()).relaxation().unwrap();
        assert!(!relaxation.roots().is_empty());
        for (j, root) in (1..).zip(relaxation.roots()) {
            let error = (root - closed.relaxation_root(j)).norm();
            // Newton's method on a transform that is known to 1e-13, at roots of order 100.
            assert!(error < 1e-11 * root.norm(), "σ = {std}, j = {j}: {root}, off by {error:e}");
        }
    }
    for shape in [5_u32, 7, 16, 64] {
        let closed = Erlang::with_mean(shape, 1.0);
        let law = gamma(1.0, f64::from(shape).sqrt().recip());
        let relaxation = master(&law, &rest(), &rest()).relaxation().unwrap();
        let error = (relaxation.length() / closed.relaxation_length() - 1.0).abs();
        // Roots of a transform with a pole of high order near them, which loses some digits.
        assert!(error < 1e-10, "shape {shape}: X* off by {error:e}");
        for root in relaxation.roots() {
            let nearest =
                (1..shape).map(|j| (closed.relaxation_root(j) - root).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-10 * root.norm(), "shape {shape}: {root} is no root");
        }
    }
}

#[test]
fn a_tail_slower_than_every_root_rules() {
    for shape in [0.5, 1.0, 1.5, 2.0, 3.0, 4.0] {
        let std = 1.0 / f64::sqrt(shape);
        // Rate λ = shape/mean.
        let got = length(&gamma(1.0, std));
        assert!((got * shape - 1.0).abs() < 1e-9, "shape {shape}: {got}");
    }
    assert!((length(&exponential(2.5)) - 2.5).abs() < 1e-12);
    // A few long-lived contacts of another kind.
    let law = mixture(&[(0.95, gaussian(1.0, 0.3)), (0.05, exponential(4.0))]);
    assert!((length(&law) - 4.0).abs() < 1e-9);
    // Heavier than any exponential: no length at all, and no expansion.
    for heavy in [weibull(0.5, 1.0), weibull(0.9, 1.0), lognormal(1.0, 3.0)] {
        let relaxation = master(&heavy, &rest(), &rest()).relaxation().unwrap();
        assert_eq!(relaxation.length(), f64::INFINITY, "{heavy:?}");
        assert_eq!(relaxation.valid_from(), f64::INFINITY, "{heavy:?}");
    }
}

#[test]
fn lattices_never_settle() {
    let two = |a: f64, b: f64| mixture(&[(0.5, point(a)), (0.5, point(b))]);
    let three = mixture(&[(0.2, point(0.6)), (0.5, point(0.9)), (0.3, point(1.2))]);
    let cases = [
        (point(1.0), rest()),
        (point(1.0), point(0.3)),
        (two(1.0, 2.0), rest()),
        (two(0.9, 1.1), rest()),
        (three, rest()),
        // Lengths 0.5 and 1: the thresholds alone share no lattice with 0.3.
        (two(0.8, 1.3), point(0.3)),
    ];
    for (thresholds, reforming) in cases {
        let relaxation = master(&thresholds, &reforming, &rest()).relaxation().unwrap();
        assert_eq!(relaxation.length(), f64::INFINITY, "{thresholds:?}, {reforming:?}");
        assert_eq!(relaxation.valid_from(), f64::INFINITY);
    }
    // Identical thresholds with a broad R do converge: the advance 1 − r is uniform on [0.6, 1].
    let broad = master(&point(1.0), &rectangular(0.0, 0.4), &rest()).relaxation().unwrap().length();
    assert!((broad / length(&rectangular(0.6, 1.0)) - 1.0).abs() < 1e-9, "{broad}");
}

/// Zeros with Re s > `left`, 0 < Im s < `top`, of the transform of survival (1 − φ̂)/s, by the argument principle.
fn zeros(breaking: &dyn Fn(Complex64) -> Complex64, left: f64, top: f64) -> i64 {
    let corners = [(2.0, 1e-6), (2.0, top), (left, top), (left, 1e-6)].map(|(re, im)| Complex64::new(re, im));
    let survival = |s: Complex64| (1.0 - breaking(s)) / s;
    let mut turned = 0.0;
    for pair in corners.windows(2) {
        let count = ((pair[1] - pair[0]).norm() / 0.01).ceil() as usize;
        let at = |k: usize| survival(pair[0] + (pair[1] - pair[0]) * (k as f64 / count as f64));
        turned += (0..count).map(|k| (at(k + 1) / at(k)).arg()).sum::<f64>();
    }
    // The real axis closes the path: on it the transform is real and positive.
    (turned / std::f64::consts::TAU).round() as i64
}

/// φ̂(s) = ∫ R(r)/S(r) e^{sr} ∫_r^∞ e^{−sx} P_c(x) dx dr for R = U[0, 0.6], P_c = U[0.4, 1.6] by Simpson's rule.
fn overlapping(s: Complex64) -> Complex64 {
    let (low, high, top) = (0.4, 1.6, 0.6);
    let tail = |x: f64| ((-s * x).exp() - (-s * high).exp()) / (s * (high - low));
    let below = tail(low) * ((s * low).exp() - 1.0) / s;
    let count = 400;
    let step = (top - low) / f64::from(count);
    let mut sum = Complex64::ZERO;
    for k in 0..=count {
        let r = low + f64::from(k) * step;
        let weight = if k == 0 || k == count { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
        sum += weight * step / 3.0 * (s * r).exp() * tail(r) * (high - low) / (high - r);
    }
    (below + sum) / top
}

#[test]
fn broad_reforming_and_mixtures_find_the_slowest_root() {
    type Case = (&'static str, SharedLaw, SharedLaw, f64);
    let near = |gap: f64, std: f64| mixture(&[(0.5, gaussian(1.0, std)), (0.5, gaussian(1.0 + gap, std))]);
    let cases: [Case; 8] = [
        ("gaussian R", gaussian(1.0, 0.05), gaussian(0.2, 0.03), 60.0),
        ("rectangular R", gaussian(1.0, 0.08), rectangular(0.0, 0.3), 60.0),
        ("point R", gaussian(1.0, 0.08), point(0.4), 60.0),
        ("gamma R", gaussian(1.0, 0.05), gamma(0.05, 0.02), 60.0),
        ("two kinds", mixture(&[(0.3, gaussian(0.5, 0.03)), (0.7, gaussian(1.2, 0.1))]), rest(), 60.0),
        ("a jump", mixture(&[(0.5, rectangular(0.4, 0.6)), (0.5, gaussian(1.2, 0.1))]), rest(), 60.0),
        // Points that are twenty or fifty times farther apart than they are wide.
        ("points 1 and 1.1, blurred", near(0.1, 0.005), rest(), 80.0),
        ("points 1 and 1.05, blurred", near(0.05, 0.001), rest(), 150.0),
    ];
    for (name, thresholds, reforming, top) in cases {
        let relaxation = master(&thresholds, &reforming, &rest()).relaxation().unwrap();
        let slowest = -1.0 / relaxation.length();
        let breaking = |s: Complex64| thresholds.laplace(s) * reforming.laplace(-s);
        // The root itself, to the rounding of a transform that turns by up to 150 radians.
        let root = relaxation.roots()[0];
        assert!((root.re - slowest).abs() <= 2.0 * f64::EPSILON * slowest.abs(), "{name}: {root}");
        assert!((breaking(root) - 1.0).norm() < 1e-11, "{name}: {}", breaking(root));
        // It is the slowest; the contour must keep a step away from it.
        assert_eq!(zeros(&breaking, 0.98 * slowest, top), 0, "{name}: a root right of {slowest}");
        assert_eq!(zeros(&breaking, 1.02 * slowest, top), 1, "{name}: no root at {slowest}");
    }
    let slowest =
        -1.0 / master(&rectangular(0.4, 1.6), &rectangular(0.0, 0.6), &rest()).relaxation().unwrap().length();
    assert_eq!(zeros(&overlapping, 0.999 * slowest, 60.0), 0, "overlap: a root right of {slowest}");
    assert_eq!(zeros(&overlapping, 1.001 * slowest, 60.0), 1, "overlap: no root at {slowest}");
}

/// Law by name, of the columns of the table.
fn named(name: &str, first: f64, second: f64) -> SharedLaw {
    match name {
        "gaussian" => gaussian(first, second),
        "exponential" => exponential(first),
        "gamma" => gamma(first, second),
        "weibull" => weibull(first, second),
        "lognormal" => lognormal(first, second),
        "rectangular" => rectangular(first, second),
        _ => panic!("no law {name}"),
    }
}

#[test]
fn slowest_roots_of_weibull_thresholds_alone_and_in_mixtures() {
    let rows: Vec<_> = include_str!("../tables/weibull_roots.csv").lines().skip(1).collect();
    assert_eq!(rows.len(), 12);
    for row in rows {
        let cells: Vec<_> = row.split(',').collect();
        let number = |i: usize| cells[i].parse::<f64>().unwrap();
        let (alone, weight, end) = (weibull(number(0), 1.0), number(2), number(1));
        let law = if weight < 1.0 {
            mixture(&[(weight, alone), (1.0 - weight, named(cells[3], number(4), number(5)))])
        } else {
            alone
        };
        let reforming = if end > 0.0 { rectangular(0.0, end) } else { rest() };
        let root = master(&law, &reforming, &rest()).relaxation().unwrap().roots()[0];
        let error = (root - Complex64::new(number(6), number(7))).norm() / root.norm();
        // The tail is resolved to 1e-13 of its largest value in each cell, of which e^{−sx} lifts the far end by up to 1e3.
        assert!(error < 1e-11, "{row}: {root}, off by {error:e}");
    }
    // Roots left of where survival of 1e-250 determines the transform, and of an exponential tail.
    for law in [weibull(1.05, 1.0), mixture(&[(0.9, weibull(1.05, 1.0)), (0.1, exponential(0.3))])] {
        let far = master(&law, &rest(), &rest()).relaxation().unwrap();
        assert!(far.length().is_nan() && far.roots().is_empty(), "{law:?}: {}", far.length());
    }
}

#[test]
fn slowest_roots_where_contacts_re_form_among_the_thresholds() {
    let rows: Vec<_> = include_str!("../tables/relaxation_roots.csv").lines().skip(1).collect();
    assert_eq!(rows.len(), 11);
    for row in rows {
        let cells: Vec<_> = row.split(',').collect();
        let number = |i: usize| cells[i].parse::<f64>().unwrap();
        let (thresholds, reforming) =
            (named(cells[0], number(1), number(2)), named(cells[3], number(4), number(5)));
        let expected = Complex64::new(number(6), number(7));
        let relaxation = master(&thresholds, &reforming, &rest()).relaxation().unwrap();
        let root = relaxation.roots()[0];
        // A share of up to 1e-12 of the starts is beyond where contacts hold, and left out here as there.
        let error = (root - expected).norm() / expected.norm();
        assert!(error < 1e-11, "{row}: {root}, off by {error:e}");
        assert!((relaxation.length() * root.re + 1.0).abs() < 1e-15);
    }
}

/// φ̂(s) for P_c = U[low, high] and a smooth density R on x ≥ 0, cut where S = 1e-9: with r = high − (high − low) e^{−t} among the
/// thresholds dr/S(r) is (high − low) dt, so that Simpson's rule meets no pole.
fn over_the_end(reforming: &SharedLaw, (low, high): (f64, f64), s: Complex64) -> Complex64 {
    let width = high - low;
    // e^{sr} ∫_r^high e^{−sx} dx/width.
    let broken = |r: f64, from: f64| ((s * (r - from)).exp() - (s * (r - high)).exp()) / (s * width);
    // r = q², in which half powers at 0 are smooth.
    let below = |q: f64| 2.0 * q * reforming.density(q * q) * broken(q * q, low);
    let among = |t: f64| {
        let r = high - width * (-t).exp();
        width * reforming.density(r) * broken(r, r)
    };
    simpson(below, low.sqrt(), 20_000) + simpson(among, 1e9_f64.ln(), 200_000)
}

/// ∫_0^end f by Simpson's rule.
fn simpson(f: impl Fn(f64) -> Complex64, end: f64, steps: u32) -> Complex64 {
    let weight = |k: u32| if k == 0 || k == steps { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
    let step = end / f64::from(steps);
    (0..=steps).map(|k| weight(k) * f(f64::from(k) * step)).sum::<Complex64>() * (step / 3.0)
}

#[test]
fn contacts_that_re_form_up_to_the_last_threshold_have_their_roots() {
    // The first from the same integral in 30-digit arithmetic.
    let length = master(&rectangular(0.5, 1.5), &exponential(0.05), &rest()).relaxation().unwrap().length();
    assert!((length * 1.312_920_173_927_477_6 - 1.0).abs() < 1e-11, "{length}");
    let laws =
        [exponential(0.05), gamma(0.15, 0.06), gaussian(0.6, 0.12), lognormal(0.2, 0.05), weibull(1.5, 0.15)];
    for reforming in laws {
        let bounds = (0.5, 1.5);
        let relaxation = master(&rectangular(bounds.0, bounds.1), &reforming, &rest()).relaxation().unwrap();
        let roots = relaxation.roots();
        assert!(roots.len() > 2, "{reforming:?}: {} roots", roots.len());
        // Simpson's steps of 1e-4 follow e^{sr} to 1e-11.
        for &root in roots.iter().filter(|root| root.norm() < 60.0) {
            // What rounding, and the 1e-12 of starts that may be above, leave of a transform lifted by the slope of φ̂.
            let breaking = over_the_end(&reforming, bounds, root);
            assert!((breaking - 1.0).norm() < 1e-10, "{reforming:?}: {breaking} at {root}");
        }
    }
}

#[test]
fn a_force_that_starts_among_the_thresholds_decays_by_its_roots() {
    let (thresholds, reforming) = (gaussian(1.0, 0.15), gaussian(1.3, 0.05));
    let master = master(&thresholds, &reforming, &reforming);
    let (relaxation, kinetic) = (master.relaxation().unwrap(), master.steady_state().kinetic_friction());
    let pull = master.pull_with(1.0, 1e-12, &mut ()).unwrap();
    let step = 0.03;
    let swing = |x: f64| pull.force(x) - kinetic;
    // (1 − e^{s h} T)(1 − e^{s* h} T), T the shift by h, makes nothing of a root's swing.
    let without = |roots: &[Complex64], x: f64| {
        let factors = roots.iter().map(|s| [1.0, -2.0 * (s * step).exp().re, (2.0 * s.re * step).exp()]);
        let weights = factors.fold(vec![1.0], |weights, factor| {
            let mut product = vec![0.0; weights.len() + 2];
            for (i, w) in weights.iter().enumerate() {
                factor.iter().enumerate().for_each(|(k, f)| product[i + k] += w * f);
            }
            product
        });
        weights.iter().enumerate().map(|(k, w)| w * swing(x - k as f64 * step)).sum::<f64>()
    };
    let size = |roots: usize| {
        let at = |k: u32| without(&relaxation.roots()[..roots], 0.5 + 0.01 * f64::from(k)).abs();
        (0..15).map(at).fold(0.0, f64::max)
    };
    // What is left is of the fourth root; 6e-8 to begin with, far above the rounding of the pull.
    assert!(size(0) > 1e-8 && size(1) < 0.1 * size(0) && size(3) < 1e-4 * size(0));
}

#[test]
fn the_expansion_continues_the_pull() {
    let broad = gaussian(0.15, 0.02);
    let cases = [
        (gaussian(1.0, 0.05), rest(), rest()),
        (gaussian(1.0, 0.05), rest(), gaussian(0.1, 0.025)),
        (gaussian(1.0, 0.1), broad.clone(), rectangular(0.0, 0.3)),
        (gaussian(1.0, 0.3), rest(), rest()),
        (rectangular(0.9, 1.1), rest(), rest()),
        (rectangular(0.9, 1.1), rectangular(0.0, 0.1), rectangular(0.05, 0.2)),
        (rectangular(0.4, 1.6), rectangular(0.0, 0.6), rest()),
        (gamma(1.0, 0.1), rest(), broad.clone()),
        (gamma(1.0, 0.25), rest(), rest()),
        (gamma(1.0, 1.0), rest(), point(0.5)),
        (weibull(12.153, 1.0), rest(), rest()),
        (weibull(1.5, 1.0), rest(), rest()),
        (mixture(&[(0.3, gaussian(0.5, 0.03)), (0.7, gaussian(1.2, 0.1))]), rest(), rest()),
        (mixture(&[(0.5, point(1.0)), (0.5, gaussian(0.7, 0.05))]), broad.clone(), rest()),
        (gaussian(1.0, 0.15), gaussian(0.7, 0.07), gaussian(0.5, 0.05)),
        // Starts up to the end of the thresholds.
        (rectangular(0.5, 1.5), exponential(0.05), rest()),
        (rectangular(0.5, 1.5), rectangular(0.0, 1.499), rest()),
        (tabulated(), gamma(0.2, 0.05), rest()),
    ];
    for (thresholds, reforming, start) in cases {
        let master = master(&thresholds, &reforming, &start);
        let relaxation = master.relaxation().unwrap();
        let from = relaxation.valid_from();
        assert!(from < 60.0, "{thresholds:?}, {reforming:?}: valid from {from} only");
        let pull = master.pull_with(from + 20.0, 1e-11, &mut ()).unwrap();
        for k in 0..100_u32 {
            let x = from + 0.2 * f64::from(k);
            let error = (relaxation.force(x) - pull.force(x)).abs();
            // Far more than the 1e-12 that a term left out may be, of which there are many.
            assert!(
                error < 1e-10,
                "{thresholds:?}, {reforming:?}, {start:?}: {error:e} at {x}, valid from {from}"
            );
        }
    }
}

#[test]
fn far_away_costs_microseconds() {
    // σ = 1e-3 oscillates until X* = 50661, with roots of unit residue.
    let relaxation = master(&gaussian(1.0, 1e-3), &rest(), &rest()).relaxation().unwrap();
    let closed = exact::Gaussian::new(1.0, 1e-3);
    for x in [1e5 + 0.37, 3e5 + 0.81, 1e6] {
        assert!(x > relaxation.valid_from());
        let expected = 0.5 * (1.0 + 1e-6)
            - (1..20).map(|j| closed.relaxation_root(j)).map(|s| 2.0 * ((s * x).exp() / s).re).sum::<f64>();
        // s₁ X turns 1e6 times: 1e-16 of it is left of the phase, and Newton's last step.
        let error = (relaxation.force(x) - expected).abs();
        assert!(error < 1e-9, "{error:e} at {x}");
    }
    let clock = std::time::Instant::now();
    let sum: f64 = (0..1000).map(|k| relaxation.force(1e6 + f64::from(k))).sum();
    assert!((sum / 1000.0 - relaxation.force(1e6)).abs() < 1e-6);
    // Far above what it takes, far below what stepping there would.
    assert!(clock.elapsed().as_secs_f64() < 0.1);
}
