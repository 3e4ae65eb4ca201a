//! Parameters of distributions of a mean and a coefficient of variation.

use toml::{Table, Value};

use super::random::SplitMix;

/// Coefficients of variation.
pub const VARIATIONS: [f64; 9] = [1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.3, 1.0, 1.5, 3.0];

/// The distribution that the schema calls `family`. Nested ones are drawn among those that are not.
///
/// # Panics
/// A family that is not listed: a new one needs a line.
pub fn parameters(family: &str, mean: f64, variation: f64, random: &mut SplitMix) -> Value {
    let numbers = |given: &[(&str, f64)]| {
        Value::Table(given.iter().map(|&(key, value)| (key.to_owned(), Value::Float(value))).collect())
    };
    let half_width = (3f64.sqrt() * variation).min(1.0) * mean;
    match family {
        "gaussian" | "gamma" | "lognormal" => numbers(&[("mean", mean), ("std", mean * variation)]),
        "rectangular" => numbers(&[("min", mean - half_width), ("max", mean + half_width)]),
        "point" => numbers(&[("at", mean)]),
        "exponential" => numbers(&[("mean", mean)]),
        "weibull" => numbers(&[("shape", shape(variation)), ("scale", mean)]),
        "tabulated" => tabulated(mean, half_width, random),
        "series" => series(mean, half_width),
        "mixture" => mixture(mean, variation, random),
        "renormalised" => {
            let coupling = Value::Float(random.between(0.0, 0.4 * variation.min(1.0)));
            Value::Table(Table::from_iter([
                ("law".into(), simple(mean, variation, random)),
                ("coupling".into(), coupling),
            ]))
        }
        _ => panic!("no parameters are known for the distribution {family}"),
    }
}

/// The shape of a Weibull distribution of roughly this coefficient of variation: Γ(1 + 2/k)/Γ(1 + 1/k)² − 1 ≈ k^{-2.17}
/// (C. G. Justus et al., J. Appl. Meteorol. 17, 350 (1978)).
fn shape(variation: f64) -> f64 {
    variation.powf(-1.0 / 1.086)
}

fn list(values: &[f64]) -> Value {
    Value::Array(values.iter().map(|&value| Value::Float(value)).collect())
}

fn tabulated(mean: f64, half_width: f64, random: &mut SplitMix) -> Value {
    let places = [-1.0, -0.5, 0.0, 0.25, 1.0].map(|at| mean + at * half_width);
    let table = if random.chance(0.5) {
        Table::from_iter([("samples".into(), list(&places))])
    } else {
        let density = [0.0, 1.0, 3.0, 0.0, 1.0];
        Table::from_iter([("stretch".into(), list(&places)), ("density".into(), list(&density))])
    };
    Value::Table(table)
}

fn series(mean: f64, half_width: f64) -> Value {
    let boundaries = [-1.0, 0.0, 1.0].map(|at| mean + at * half_width);
    let coefficients = Value::Array(vec![list(&[1.0, 0.5]), list(&[0.8, -0.4, 0.1])]);
    Value::Table(Table::from_iter([
        ("boundaries".into(), list(&boundaries)),
        ("coefficients".into(), coefficients),
    ]))
}

fn mixture(mean: f64, variation: f64, random: &mut SplitMix) -> Value {
    let weight = random.between(0.05, 0.95);
    let part = |weight: f64, law: Value| {
        Value::Table(Table::from_iter([("weight".into(), Value::Float(weight)), ("law".into(), law)]))
    };
    let first = simple(0.7 * mean, variation, random);
    Value::Array(vec![part(weight, first), part(1.0 - weight, simple(1.3 * mean, variation, random))])
}

fn simple(mean: f64, variation: f64, random: &mut SplitMix) -> Value {
    let families = ["gaussian", "gamma", "lognormal", "rectangular", "exponential", "weibull", "point"];
    let family = *random.pick(&families);
    Value::Table(Table::from_iter([(family.to_owned(), parameters(family, mean, variation, random))]))
}
