//! What every law promises, checked alike for all of them against quadrature of its density.

use std::sync::Arc;

use asperity::law::{
    Exponential, Gamma, Gaussian, Law, Lognormal, Mixture, Point, Rectangular, Renormalised, Root, Series,
    SharedLaw, Tabulated, Weibull,
};
use asperity::numerics::legendre::RULE;
use asperity::random::{Purpose, Stream};
use asperity::scenario;
use num_complex::Complex64;

fn family() -> Vec<SharedLaw> {
    let tent =
        Tabulated::from_density(&[(0.2, 1.0), (0.5, 3.0), (0.9, 0.0), (1.3, 0.0), (1.5, 2.0), (2.0, 0.5)]);
    let samples = Tabulated::from_samples(&[0.9, 0.4, 1.1, 0.9, 1.7, 0.9, 0.8, 2.5]);
    let mixture = Mixture::new(vec![
        (0.25, Arc::new(Point::new(0.7).unwrap()) as SharedLaw),
        (0.45, Arc::new(Gaussian::new(1.0, 0.2).unwrap())),
        (0.1, Arc::new(Point::new(0.0).unwrap())),
        (0.2, Arc::new(Rectangular::new(0.5, 1.5).unwrap())),
    ]);
    let two_kinds = Mixture::new(vec![
        (0.1, Arc::new(Tabulated::from_samples(&[0.0]).unwrap()) as SharedLaw),
        (0.2, Arc::new(Gaussian::new(0.6, 0.05).unwrap())),
        (0.7, Arc::new(Gaussian::new(1.2, 0.2).unwrap())),
    ]);
    let tent = Arc::new(tent.unwrap());
    let steps = Series::new(&[0.2, 0.7, 1.5], &[vec![1.0, 0.5], vec![2.0, -1.0, 0.3]], 0.0);
    let rise = |x: &[f64]| Ok(x.iter().map(|x| (1.0 + x * x) * (-x * x).exp() / x.sqrt()).collect());
    let singular = Series::resolve(rise, &[0.0, 1.0, f64::INFINITY], 1e-14).unwrap().0;
    let singular = Arc::new(singular);
    let mut family: Vec<SharedLaw> = vec![
        Arc::new(Gaussian::new(1.0, 0.05).unwrap()),
        Arc::new(Gaussian::new(1.0, 0.3).unwrap()),
        Arc::new(Gaussian::new(0.2, 0.5).unwrap()),
        Arc::new(Rectangular::new(0.8, 1.2).unwrap()),
        Arc::new(Rectangular::new(0.0, 2.0).unwrap()),
        Arc::new(Point::new(1.0).unwrap()),
        Arc::new(Exponential::new(0.7).unwrap()),
        Arc::new(Gamma::new(1.0, 0.1).unwrap()),
        Arc::new(Gamma::new(1.0, 0.4).unwrap()),
        Arc::new(Gamma::new(1.0, 2.0).unwrap()),
        Arc::new(Weibull::new(12.153, 1.0431).unwrap()),
        Arc::new(Weibull::new(1.5, 1.0).unwrap()),
        Arc::new(Weibull::new(0.6, 1.0).unwrap()),
        Arc::new(Lognormal::new(1.0, 0.1).unwrap()),
        Arc::new(Lognormal::new(1.0, 0.6).unwrap()),
        tent.clone(),
        Arc::new(samples.unwrap()),
        Arc::new(steps.unwrap()),
        singular.clone(),
        Arc::new(mixture.unwrap()),
        Arc::new(Root::new(1.3, Arc::new(Gaussian::new(0.6, 0.2).unwrap())).unwrap()),
        Arc::new(Root::new(1.3, tent.clone()).unwrap()),
        Arc::new(Root::new(1.3, singular.clone()).unwrap()),
        renormalised(Arc::new(Gaussian::new(1.0, 0.1).unwrap()), 0.1),
        renormalised(Arc::new(Gaussian::new(0.2, 0.5).unwrap()), 0.5),
        renormalised(Arc::new(Rectangular::new(0.8, 1.2).unwrap()), 0.3),
        renormalised(Arc::new(Exponential::new(0.7).unwrap()), 2.0),
        renormalised(Arc::new(Weibull::new(0.6, 1.0).unwrap()), 1.0),
        renormalised(Arc::new(Lognormal::new(1.0, 0.3).unwrap()), 0.4),
        renormalised(tent, 0.3),
        renormalised(singular, 0.5),
        renormalised(Arc::new(two_kinds.unwrap()), 0.2),
    ];
    // A narrow and a wide member of every parametric family.
    for width in [0.2, 0.8] {
        family.extend(scenario::Law::FAMILIES.iter().map(|one| (one.member)(1.1, width).build().unwrap()));
    }
    family
}

fn renormalised(thresholds: SharedLaw, coupling: f64) -> SharedLaw {
    Arc::new(Renormalised::new(thresholds, coupling).unwrap())
}

/// ∫ f p over (from, to] plus point masses there, by Gauss panels between breaks; over wide ranges in t = x^{1/20}, in
/// which every onset of the family is a polynomial.
fn integral(law: &dyn Law, count: u32, from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let mut ends: Vec<f64> =
        law.breakpoints().iter().map(|b| b.position).filter(|x| (from..to).contains(x)).collect();
    ends.extend([from, to]);
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let piece = |a: f64, b: f64| {
        let inside = |x: f64| f(x) * law.density(x.clamp(a, b.next_down()));
        if b < 10.0 * a {
            return panels(count, a, b, inside);
        }
        panels(count, a.powf(0.05), b.powf(0.05), |t| 20.0 * t.powi(19) * inside(t.powi(20)))
    };
    let atoms = law.atoms().into_iter().filter(|atom| atom.position > from && atom.position <= to);
    let density: f64 = ends.windows(2).map(|w| piece(w[0], w[1])).sum();
    density + atoms.map(|atom| atom.weight * f(atom.position)).sum::<f64>()
}

fn panels(count: u32, a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let at = |i: u32| a + (b - a) * f64::from(i) / f64::from(count);
    (0..count).map(|i| RULE.integrate(at(i), at(i + 1), &f)).sum()
}

/// Places from the lower to the upper tail.
fn places(law: &dyn Law) -> Vec<f64> {
    let mut places = vec![0.0];
    places.extend([1e-3, 0.05, 0.25, 0.5, 0.75].map(|p| law.quantile(p)));
    places.extend([0.05, 1e-3, 1e-6, 1e-12].map(|q| law.upper_quantile(q)));
    places.dedup();
    places
}

/// `value` is `expected` to `tolerance` of `size`.
fn assert_close(what: &str, law: &dyn Law, value: f64, expected: f64, tolerance: f64) {
    let error = (value - expected).abs();
    assert!(error <= tolerance, "{what} of {law:?}: {value:e}, expected {expected:e}, off by {error:e}");
}

#[test]
fn survival_is_the_mass_above() {
    for law in family() {
        let law = law.as_ref();
        for pair in places(law).windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let mass = integral(law, 200, a, b, |_| 1.0);
            // Rounding of the Gauss points, times x p'/p (some ten); an ulp of a and b is worth x p.
            let ulps = 4e-16 * (a * law.density(a) + b * law.density(b));
            assert_close(
                "mass",
                law,
                law.survival(a) - law.survival(b),
                mass,
                2e-14 * law.survival(a) + if a > 0.0 { ulps } else { 0.0 },
            );
        }
        assert_eq!(law.survival(-1e-9), 1.0);
    }
}

#[test]
fn moments_are_integrals() {
    for law in family() {
        let law = law.as_ref();
        let top = law.upper_quantile(1e-40);
        for x in places(law) {
            for order in [0, 1, 2, 3, 5] {
                let moment = integral(law, 200, x, top, |x| x.powi(order));
                let all = law.upper_moment(order as u32, x);
                // Rounding; beyond `top` there is nothing even of the widest fifth moment.
                assert_close(
                    "moment",
                    law,
                    all,
                    moment,
                    1e-12 * all + 1e-14 * law.upper_moment(order as u32, -1.0),
                );
            }
        }
        let mean = law.mean();
        let variance = integral(law, 200, 0.0, top, |x| (x - mean).powi(2))
            + law
                .atoms()
                .first()
                .map_or(0.0, |a| if a.position == 0.0 { a.weight * mean * mean } else { 0.0 });
        assert_close("variance", law, law.std().powi(2), variance, 1e-12 * variance);
    }
}

#[test]
fn the_cumulative_probability_is_the_integral_from_below() {
    for law in family() {
        let law = law.as_ref();
        let low = law.quantile(0.0);
        let lowest: f64 = law.atoms().iter().filter(|a| a.position == low).map(|a| a.weight).sum();
        for x in places(law).into_iter().filter(|&x| x > low) {
            let mass = lowest + integral(law, 200, low, x, |_| 1.0);
            // As above, relative to what is below.
            let ulps = 4e-16 * x * law.density(x);
            assert_close("cumulative", law, law.cumulative(x), mass, 2e-13 * mass + ulps);
        }
        assert_eq!(law.cumulative(-1e-9), 0.0);
    }
}

#[test]
fn hazard_and_logarithm_belong_to_density_and_survival() {
    for law in family() {
        for x in places(law.as_ref()) {
            let (survival, hazard) = (law.survival(x), law.hazard(x));
            if survival == 0.0 {
                assert_eq!((law.ln_survival(x), hazard), (f64::NEG_INFINITY, f64::INFINITY));
                continue;
            }
            // Rounding, times the exponent of the tail (ln 1e-12 = −27).
            let expected = law.density(x) / survival;
            if expected.is_finite() {
                assert_close("hazard", law.as_ref(), hazard, expected, 1e-13 * expected);
            } else {
                assert_eq!(hazard, expected);
            }
            assert_close("ln S", law.as_ref(), law.ln_survival(x), survival.ln(), 2e-14);
        }
    }
}

#[test]
fn quantiles_invert_the_survival() {
    for law in family() {
        let law = law.as_ref();
        // q and the x at which S falls through it: an interval of two ulps on either side must straddle q.
        let straddles = |q: f64, x: f64| {
            let (below, above) = (law.survival(x * (1.0 - 1e-15) - 1e-300), law.survival(x * (1.0 + 1e-15)));
            let slack = 1e-14 + 2e-15 * law.ln_survival(x * (1.0 - 1e-15)).abs();
            let message = format!("{law:?} at {q:e}: S = {below:e} below {x:e}, {above:e} above");
            assert!(below >= q * (1.0 - slack) && above <= q * (1.0 + slack), "{message}");
        };
        for q in [1e-200, 1e-30, 1e-9, 0.01, 0.3, 0.5, 0.8, 0.99] {
            straddles(q, law.upper_quantile(q));
        }
        for p in [1e-12, 0.01, 0.3, 0.5, 0.8, 0.99] {
            straddles(1.0 - p, law.quantile(p));
        }
        assert_eq!(law.survival(law.upper_quantile(0.0)), 0.0);
        assert_eq!(law.quantile(1.0), law.upper_quantile(0.0));
    }
}

#[test]
fn transforms_are_integrals() {
    for law in family() {
        let law = law.as_ref();
        let at_zero = law.atoms().first().map_or(0.0, |a| if a.position == 0.0 { a.weight } else { 0.0 });
        for s in [
            Complex64::new(0.7, 0.0),
            Complex64::new(4.0, 0.0),
            Complex64::new(0.3, 5.0),
            Complex64::new(0.0, -4.0),
        ] {
            let top = law.upper_quantile(1e-18);
            let re = integral(law, 800, 0.0, top, |x| (-s.re * x).exp() * (s.im * x).cos()) + at_zero;
            let im = integral(law, 800, 0.0, top, |x| -(-s.re * x).exp() * (s.im * x).sin());
            // As for the mass, against |transform| ≤ 1.
            assert_close("Re transform", law, law.laplace(s).re, re, 5e-14);
            assert_close("Im transform", law, law.laplace(s).im, im, 5e-14);
        }
    }
}

#[test]
fn transforms_start_at_one_with_slope_minus_the_mean() {
    for law in family() {
        let h = 3e-4;
        let slope = |h: f64| law.laplace(Complex64::new(0.0, h)).im / h;
        // Error 2h⁴ E[x⁵]/15, 1e-11 for the widest, and rounding 1e-15/h.
        let estimate = (4.0 * slope(h) - slope(2.0 * h)) / 3.0;
        assert_close("slope at 0", law.as_ref(), estimate, -law.mean(), 3e-11);
        assert_close("value at 0", law.as_ref(), law.laplace(Complex64::ZERO).re, 1.0, 1e-14);
    }
}

#[test]
fn breaks_are_where_and_what_they_say() {
    for law in family() {
        let p = |x: f64| law.density(x);
        for b in law.breakpoints() {
            let h = if b.exponent == 0.0 || b.exponent == 1.0 { 1e-6 } else { 1e-12 };
            let (right, left) = (|n: f64| p(b.position + n * h), |n: f64| p(b.position - n * h));
            let height = match b.exponent {
                0.0 => (2.0 * right(1.0) - right(2.0)) - (2.0 * left(1.0) - left(2.0)),
                1.0 => (right(2.0) - right(1.0)) / h - (left(1.0) - left(2.0)) / h,
                s => right(1.0) * libm::tgamma(s + 1.0) / h.powf(s),
            };
            // The next term of the density, h of the leading one; rounding 1e-16/h of a slope.
            let tolerance = 1e-4 * b.amplitude.abs().max(1e-3);
            // A jump in a law is a kink as well in that of a function of it: only leading terms are listed.
            if !(["root", "renormalised"].contains(&law.name()) && b.exponent == 1.0 && b.position > 0.0) {
                assert_close("break", law.as_ref(), height, b.amplitude, tolerance);
            }
        }
    }
}

#[test]
fn between_breaks_a_density_is_smooth() {
    for law in family() {
        let law = law.as_ref();
        let mut ends: Vec<f64> = law.breakpoints().iter().map(|b| b.position).collect();
        ends.extend([1e-3, law.upper_quantile(1e-9)]);
        ends.sort_by(f64::total_cmp);
        for cell in ends.windows(2).filter(|cell| cell[0] >= 1e-3) {
            let mut x = cell[0];
            while x < cell[1] {
                let to = (x + law.zones().iter().map(|zone| 0.2 * zone.resolution).fold(0.5 * x, f64::min))
                    .min(cell[1]);
                let middle = 0.5 * (x + to);
                let (whole, half) = (
                    RULE.integrate(x, to, |x| law.density(x)),
                    RULE.integrate(x, middle, |x| law.density(x)),
                );
                let parts = half + RULE.integrate(middle, to, |x| law.density(x));
                // Rounding, where a jump or a kink inside would show at 1e-2 or 1e-4.
                assert_close("panel", law, whole, parts, 1e-14);
                x = to;
            }
        }
    }
}

#[test]
fn nothing_is_ever_not_a_number() {
    let mut extremes =
        vec![-f64::MAX, -1.0, -0.0, 0.0, f64::MIN_POSITIVE, 1e-200, 1e-20, 1e20, 1e200, f64::MAX];
    for law in family() {
        extremes.truncate(10);
        let ends = law
            .breakpoints()
            .into_iter()
            .map(|b| b.position)
            .chain(law.atoms().into_iter().map(|a| a.position));
        extremes.extend(ends.flat_map(|x| [x.next_down(), x, x.next_up()]));
        for &x in &extremes {
            let (p, s, h) = (law.density(x), law.survival(x), law.hazard(x));
            assert!(
                p >= 0.0 && (0.0..=1.0).contains(&s) && h >= 0.0,
                "{law:?} at {x:e}: p {p}, S {s}, hazard {h}"
            );
            assert!(law.ln_survival(x) <= 0.0, "{law:?} at {x:e}: ln S {}", law.ln_survival(x));
            assert!(law.upper_moment(1, x) >= 0.0, "{law:?} at {x:e}: moment {}", law.upper_moment(1, x));
            if x < 0.0 {
                assert_eq!((p, s, h, law.ln_survival(x)), (0.0, 1.0, 0.0, 0.0));
            }
        }
    }
}

#[test]
fn narrow_laws_work() {
    let narrow: [SharedLaw; 5] = [
        Arc::new(Gaussian::new(1.0, 1e-9).unwrap()),
        Arc::new(Gamma::new(1.0, 1e-9).unwrap()),
        Arc::new(Lognormal::new(1.0, 1e-9).unwrap()),
        Arc::new(Weibull::new(1e9, 1.0).unwrap()),
        Arc::new(Rectangular::new(1.0, 1.0 + 1e-9).unwrap()),
    ];
    for law in narrow {
        let (low, high) = (law.quantile(0.25), law.upper_quantile(0.25));
        // An ulp of x is 1e-7 of the width.
        assert_close("S", law.as_ref(), law.survival(low), 0.75, 1e-6);
        assert_close("S", law.as_ref(), law.survival(high), 0.25, 1e-6);
        let mass = panels(20, low, high, |x| law.density(x));
        assert_close("mass", law.as_ref(), mass, 0.5, 1e-6);
        assert!(law.std() > 2e-10 && law.std() < 2e-9);
        // Far inside |s| σ ≪ 1 the transform is that of a point.
        let s = Complex64::new(0.0, 6.25);
        assert_close("transform", law.as_ref(), law.laplace(s).im, (-s * law.mean()).exp().im, 1e-12);
    }
}

#[test]
fn parameters_can_be_replaced_one_by_one() {
    for law in family() {
        for parameter in law.parameters() {
            let same = law.with_parameter(&parameter.name, parameter.value).unwrap();
            assert_eq!(same.parameters(), law.parameters());
            let value = 0.97 * parameter.value + 0.01;
            let changed = law.with_parameter(&parameter.name, value).unwrap();
            let read = changed.parameters().into_iter().find(|p| p.name == parameter.name).unwrap();
            assert_eq!(read.value, value);
            assert_ne!((changed.mean(), changed.std()), (law.mean(), law.std()));
        }
        assert!(law.with_parameter("colour", 1.0).is_err());
    }
}

#[test]
fn draws_follow_the_law() {
    const DRAWS: usize = 50_000;
    // Kolmogorov: P(√n D > 2.69) = 1e-6 a law, 2e-5 for the family; smaller still with point masses.
    const LIMIT: f64 = 2.69;
    for (index, law) in family().into_iter().enumerate() {
        let mut draws = vec![0.0; DRAWS];
        let mut stream = Stream::new(20_261, Purpose::Sample, index as u64);
        law.fill(&mut stream, &mut draws);
        draws.sort_by(f64::total_cmp);
        let (mut distance, mut before) = (0.0_f64, 0);
        for run in draws.chunk_by(|a, b| a == b) {
            let after = before + run.len();
            let gap = |count: usize, x: f64| (1.0 - law.survival(x) - count as f64 / DRAWS as f64).abs();
            distance = distance.max(gap(before, run[0].next_down())).max(gap(after, run[0]));
            before = after;
        }
        assert!(distance * (DRAWS as f64).sqrt() < LIMIT, "{law:?}: D = {distance:e}");
        assert!(draws[0] >= 0.0);
    }
}

#[test]
fn draws_do_not_depend_on_the_size_of_the_buffer() {
    for law in family() {
        let (mut whole, mut pieces) = ([0.0; 60], [0.0; 60]);
        law.fill(&mut Stream::new(1, Purpose::Sample, 0), &mut whole);
        let mut stream = Stream::new(1, Purpose::Sample, 0);
        pieces.chunks_mut(7).for_each(|piece| law.fill(&mut stream, piece));
        assert_eq!(whole, pieces);
    }
}
