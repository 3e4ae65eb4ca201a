//! The laws against reference values in 40-digit arithmetic (`tables/make_laws.py`), from S ≈ 1 to S = 1e-299.

use std::sync::Arc;

use asperity::law::{Gamma, Gaussian, Law, Lognormal, Series, SharedLaw, Weibull};
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
