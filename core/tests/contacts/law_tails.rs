//! The laws against reference values in 40-digit arithmetic (`tables/make_laws.py`), from S ≈ 1 to S = 1e-299.

use std::sync::Arc;

use asperity::law::{
    Exponential, Gamma, Gaussian, Law, Lognormal, Mixture, Rectangular, Renormalised, Root, Series,
    SharedLaw, Tabulated, Truncated, Weibull, within_support,
};
use num_complex::Complex64;

/// A row of a table: the law, and the numbers after its parameters; an empty cell is not a number.
struct Row {
    law: SharedLaw,
    numbers: Vec<f64>,
}

fn rows(table: &str) -> Vec<Row> {
    let rows: Vec<_> = table.lines().skip(1).map(row).collect();
    assert!(rows.len() > 100, "a table cut short: {} rows", rows.len());
    rows
}

fn row(line: &str) -> Row {
    let (name, rest) = line.split_once(',').unwrap();
    let numbers: Vec<f64> = rest.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
    let (a, b) = (numbers[0], numbers[1]);
    let law: SharedLaw = match name {
        "gaussian" => Arc::new(Gaussian::new(a, b).unwrap()),
        "gamma" => Arc::new(Gamma::new(a, b).unwrap()),
        "weibull" => Arc::new(Weibull::new(a, b).unwrap()),
        "lognormal" => Arc::new(Lognormal::new(a, b).unwrap()),
        _ => panic!("no such law: {name}"),
    };
    Row { law, numbers: numbers[2..].to_vec() }
}

/// `value` is `expected` to a relative `tolerance`.
fn assert_close(what: &str, row: &Row, value: f64, expected: f64, tolerance: f64) {
    let error = (value / expected - 1.0).abs();
    let (law, at) = (&row.law, row.numbers[0]);
    assert!(
        error <= tolerance,
        "{what} of {law:?} at {at:e}: {value:e}, expected {expected:e}, off by {error:e}"
    );
}

#[test]
fn tails_are_right_to_rounding() {
    for row in rows(include_str!("../tables/law_points.csv")) {
        let &[x, density, survival, minus_ln, hazard, first, third] = &row.numbers[..] else {
            panic!("a row of seven numbers");
        };
        let law = &row.law;
        // exp(−L) magnifies the rounding of L = −ln S, and of the exponent of p below the mean, at most 14.
        let exponential = 1e-15 * (1.0 + minus_ln);
        assert_close("density", &row, law.density(x), density, 1e-14 + exponential);
        assert_close("S", &row, law.survival(x), survival, exponential);
        // A continued fraction of some sixty terms below the exponential.
        assert_close("moment 1", &row, law.upper_moment(1, x), first, 1e-14 + exponential);
        assert_close("moment 3", &row, law.upper_moment(3, x), third, 1e-14 + exponential);
        // Free of exponentials above the mean; below it −ln S ≈ 1 − S and the hazard ≈ p.
        assert_close("ln S", &row, -law.ln_survival(x), minus_ln, 1e-14);
        assert_close("hazard", &row, law.hazard(x), hazard, 1e-14);
    }
}

#[test]
fn quantiles_are_right_to_rounding() {
    for row in rows(include_str!("../tables/law_quantiles.csv")) {
        let &[q, upper, lower] = &row.numbers[..] else { panic!("a row of three numbers") };
        // Some ulps of ln S; a lognormal quantile exp(s z) magnifies those of z, up to s z = 31.
        assert_close("upper quantile", &row, row.law.upper_quantile(q), upper, 6e-15);
        if !lower.is_nan() {
            assert_close("quantile", &row, row.law.quantile(q), lower, 2e-15);
        }
    }
}

#[test]
fn transforms_are_right_to_rounding() {
    for row in rows(include_str!("../tables/law_transforms.csv")) {
        let &[re, im, expected_re, expected_im] = &row.numbers[..] else { panic!("a row of four numbers") };
        let expected = Complex64::new(expected_re, expected_im);
        let error = (row.law.laplace(Complex64::new(re, im)) - expected).norm();
        // Rounding of |s x̄| ≤ 60 phases, and of quadrature against ∫|e^{−sx}| dP, which the contour keeps near 1.
        let tolerance = 1e-14 * expected.norm().max(1.0);
        assert!(error <= tolerance, "{:?} at {re} + {im}i: off by {error:e} from {expected}", row.law);
    }
}

/// Against Cauchy's formula from 16 transforms on a circle, which is exact but for rounding divided by its radius.
#[test]
fn derivatives_of_transforms_are_those_of_the_transforms() {
    for row in rows(include_str!("../tables/law_transforms.csv")) {
        let &[re, im, ..] = &row.numbers[..] else { panic!("a row of four numbers") };
        if re < 0.0 || !row.law.laplace_is_closed() {
            continue;
        }
        let (mean, std) = (row.law.mean(), row.law.std());
        let (s, radius) = (Complex64::new(re, im), 0.1 * (1.0 / mean).min(mean / (std * std)));
        let around =
            (0..16).map(|k| Complex64::from_polar(radius, f64::from(k) * std::f64::consts::PI / 8.0));
        let expected = around.map(|h| row.law.laplace(s + h) / h).sum::<Complex64>() / 16.0;
        let [value, derivative] = row.law.laplace_with_derivative(s);
        assert_eq!(value, row.law.laplace(s));
        let error = (derivative - expected).norm();
        assert!(error <= 1e-13 / radius, "{:?} at {s}: off by {error:e} from {expected}", row.law);
    }
}

/// The law as a series of its density.
fn series(law: &SharedLaw) -> Series {
    let density = |x: &[f64]| Ok(x.iter().map(|&x| law.density(x)).collect());
    let boundaries = [0.0, law.quantile(0.5), law.upper_quantile(1e-3), f64::INFINITY];
    Series::resolve(density, &boundaries, 1e-14).unwrap().0
}

#[test]
fn series_of_densities_keep_their_digits_into_the_tail() {
    let mut seen = 0;
    for row in rows(include_str!("../tables/law_points.csv")) {
        let &[x, density, survival, minus_ln, hazard, first, third] = &row.numbers[..] else {
            panic!("a row of seven numbers");
        };
        // Doubles near a law narrower than 1e-3 differ by more of its width than digits are asked for.
        if survival < 1e-26 || row.law.std() < 1e-3 {
            continue;
        }
        let law = series(&row.law);
        // As documented; densities are right to 1e-14 of the mass above, in the mean over a cell.
        assert_close("S", &row, law.survival(x), survival, 1e-12);
        assert_close("moment 1", &row, law.upper_moment(1, x), first, 1e-12);
        assert_close("moment 3", &row, law.upper_moment(3, x), third, 1e-12);
        if survival < 0.9 {
            assert_close("density", &row, law.density(x), density, 1e-12);
            assert_close("ln S", &row, -law.ln_survival(x), minus_ln, 1e-13);
            assert_close("hazard", &row, law.hazard(x), hazard, 1e-12);
        }
        seen += 1;
    }
    assert!(seen > 60, "{seen} rows");
}

#[test]
fn series_of_densities_have_their_transforms() {
    let mut seen = 0;
    for row in rows(include_str!("../tables/law_transforms.csv")) {
        let &[re, im, value_re, value_im] = &row.numbers[..] else {
            panic!("a row of four numbers");
        };
        if re < 0.0 {
            continue;
        }
        let error = series(&row.law).laplace(Complex64::new(re, im)) - Complex64::new(value_re, value_im);
        // What is left out, 1e-14 in each of some tens of cells, and rounding.
        assert!(error.norm() < 1e-13, "{:?} at {re} + {im}i: off by {:e}", row.law, error.norm());
        seen += 1;
    }
    assert!(seen > 80, "{seen} rows");
}

fn gaussian(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gaussian::new(mean, std).unwrap())
}

fn lognormal(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Lognormal::new(mean, std).unwrap())
}

fn gamma(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gamma::new(mean, std).unwrap())
}

fn weibull(shape: f64, scale: f64) -> SharedLaw {
    Arc::new(Weibull::new(shape, scale).unwrap())
}

/// A logarithm is right to some roundings of its terms, which may be ten times as large as it is near 0.
fn assert_ln(what: &str, law: &dyn Law, x: f64, value: f64, expected: f64) {
    let tolerance = 2e-15 * (10.0 + expected.abs());
    assert!(
        value == expected || (value - expected).abs() <= tolerance,
        "{what} of {law:?} at {x:e}: {value}, not {expected}"
    );
}

/// ln p and ln P(ξ ≤ x) from the textbook density and distribution functions with up to 1200 digits, by mpmath.
#[test]
fn logarithms_do_not_underflow_in_the_lower_tail() {
    let rows = [
        (gaussian(1.0, 0.02), 0.1, -1009.5069155277765, -1017.2260942419523),
        (gaussian(1.0, 0.02), 0.5, -309.5069155277765, -316.63940800802027),
        (gaussian(1.0, 0.02), 0.999, 2.991834472223473, -0.7338416953693601),
        (gaussian(1.0, 0.02), 1e-05, -1246.9819156527765, -1258.507314993143),
        (gaussian(1.0, 0.02), 1e-300, -1247.0069155277765, -1937.78244342599),
        (gaussian(1.0, 2.0), 1e-09, -1.3681392982259617, -22.09140513529737),
        (gaussian(1.0, 2.0), 0.3, -1.3043892984759617, -2.538192548054901),
        (gaussian(0.0, 1.0), 1e-200, -0.22579135264472744, -460.74280995145386),
        (lognormal(1.0, 0.3), 1e-300, -2767492.1203943845, -2768191.885018883),
        (lognormal(1.0, 0.3), 1e-08, -1940.8044521057056, -1964.5878638198799),
        (lognormal(1.0, 0.3), 0.05, -47.279666229092165, -53.819095001266376),
        (lognormal(1.0, 0.3), 0.9, 0.3895952898316584, -0.8770591306078148),
        (lognormal(2.0, 0.001), 0.5, -3843616.5235402863, -3843632.745126811),
        (gamma(1.0, 0.03), 1e-300, -765723.8901479752, -766421.678791668),
        (gamma(1.0, 0.03), 0.01, -4009.6630476588853, -4021.2712924778457),
        (gamma(1.0, 0.03), 0.3, -556.1782654159301, -564.0392286302988),
        (gamma(1.0, 0.03), 0.98, 2.382516718635466, -1.369401387944716),
        (gamma(1.0, 0.5), 1e-200, -1377.7976378211758, -1839.700950781105),
        (gamma(1.0, 2.0), 1e-300, 516.4470498086822, -172.94218372841158),
        (weibull(30.0, 1.0), 1e-20, -1332.0981565548843, -1381.5510557964274),
        (weibull(30.0, 1.0), 1e-300, -20029.089111666533, -20723.26583694641),
        (weibull(30.0, 1.0), 0.3, -31.51401394378999, -36.119184129778084),
        (weibull(0.5, 2.0), 1e-300, 344.34804317826695, -345.73433753938684),
        (weibull(1e3, 5.0), 1.0, -1602.530157155118, -1609.4379124341003),
    ];
    for (law, x, ln_density, ln_cumulative) in rows {
        assert_ln("ln p", law.as_ref(), x, law.ln_density(x), ln_density);
        assert_ln("ln P", law.as_ref(), x, law.ln_cumulative(x), ln_cumulative);
    }
}

/// Where neither p nor P underflows, their logarithms are those of the numbers.
#[test]
fn logarithms_are_those_of_the_numbers() {
    let parts = vec![(0.25, gaussian(1.0, 0.1)), (0.75, weibull(3.0, 2.0))];
    let laws: Vec<SharedLaw> = vec![
        gaussian(1.0, 0.1),
        gaussian(0.2, 1.0),
        lognormal(1.0, 0.3),
        gamma(1.0, 0.03),
        gamma(1.0, 2.0),
        weibull(0.7, 1.0),
        weibull(30.0, 1.0),
        Arc::new(Exponential::new(0.7).unwrap()),
        Arc::new(Rectangular::new(0.5, 1.5).unwrap()),
        Arc::new(Mixture::new(parts).unwrap()),
        Arc::new(Truncated::new(gaussian(1.0, 0.1), 1.1).unwrap()),
        Arc::new(Root::new(2.0, gamma(1.0, 0.5)).unwrap()),
        Arc::new(Renormalised::new(gaussian(1.0, 0.2), 0.1).unwrap()),
    ];
    for law in laws {
        for level in [1e-200, 1e-9, 0.1, 0.49, 0.51, 0.9, 1.0 - 1e-9] {
            let x = law.quantile(level);
            assert_ln("ln p", law.as_ref(), x, law.ln_density(x), law.density(x).ln());
            assert_ln("ln P", law.as_ref(), x, law.ln_cumulative(x), law.cumulative(x).ln());
        }
        for x in [-1.0, f64::NEG_INFINITY] {
            assert_eq!([law.ln_density(x), law.ln_cumulative(x)], [f64::NEG_INFINITY; 2], "{law:?}");
        }
        assert_eq!(
            [law.ln_density(f64::INFINITY), law.ln_cumulative(f64::INFINITY)],
            [f64::NEG_INFINITY, 0.0]
        );
    }
}

/// The root of a Weibull or lognormal quantity is one again; a mixture is its widest part far out; coupled contacts are those
/// without coupling before any breaks.
#[test]
fn distributions_of_others_do_not_underflow_either() {
    let steep = || gaussian(1.0, 0.02);
    let variation = 0.3_f64.powi(2).ln_1p();
    let (median, narrow) = (1.0 / 1.09_f64.sqrt(), (0.25 * variation).exp_m1().sqrt());
    let mean = 2.0 * median.sqrt() * (0.125 * variation).exp();
    let mixture = Mixture::new(vec![(0.25, steep()), (0.75, lognormal(1.0, 0.3))]).unwrap();
    let truncated = Truncated::new(steep(), 1.0).unwrap();
    let ln_half = 0.5_f64.ln();
    let pairs: [(SharedLaw, SharedLaw, f64, f64); 5] = [
        (Arc::new(Root::new(2.0, weibull(15.0, 4.0)).unwrap()), weibull(30.0, 4.0), 1e-20, 0.0),
        (Arc::new(Root::new(2.0, lognormal(1.0, 0.3)).unwrap()), lognormal(mean, mean * narrow), 1e-6, 0.0),
        (Arc::new(mixture), lognormal(1.0, 0.3), 1e-6, 0.75_f64.ln()),
        (Arc::new(truncated), steep(), 0.1, -ln_half),
        (Arc::new(Renormalised::new(steep(), 0.01).unwrap()), steep(), 0.1, 0.0),
    ];
    for (law, other, x, ln_factor) in pairs {
        assert_ln("ln p", law.as_ref(), x, law.ln_density(x), other.ln_density(x) + ln_factor);
        assert_ln("ln P", law.as_ref(), x, law.ln_cumulative(x), other.ln_cumulative(x) + ln_factor);
        assert!(law.density(x) == 0.0 && law.ln_density(x) < -700.0, "{law:?}");
    }
}

/// Both ends of a sample are possible under the distribution that is most likely.
#[test]
fn the_upper_end_belongs_to_the_support() {
    let rectangular = Rectangular::new(0.5, 1.5).unwrap();
    let table = Tabulated::from_samples(&[0.5, 1.0, 1.5]).unwrap();
    let truncated = Truncated::new(Arc::new(rectangular), 1.0).unwrap();
    for (law, end) in [(&rectangular as &dyn Law, 1.5), (&table, 1.5), (&truncated, 1.0)] {
        assert_eq!(within_support(law, end), end.next_down(), "{law:?}");
        for x in [0.5, 0.7, 2.0, -1.0, f64::INFINITY] {
            assert_eq!(within_support(law, x), x, "{law:?}");
        }
        assert!(law.ln_density(within_support(law, end)).is_finite());
    }
}
