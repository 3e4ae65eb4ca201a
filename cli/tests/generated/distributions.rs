//! Parameters of distributions of a mean and a coefficient of variation.

use asperity::scenario::Law;
use toml::{Table, Value};

use super::random::SplitMix;

/// Coefficients of variation.
pub const VARIATIONS: [f64; 9] = [1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.3, 1.0, 1.5, 3.0];

/// The distribution that the schema calls `family`. Nested ones are parametric.
///
/// # Panics
/// A family that is neither parametric nor listed.
pub fn parameters(family: &str, mean: f64, variation: f64, random: &mut SplitMix) -> Value {
    if let Some(parametric) = Law::FAMILIES.iter().find(|one| one.name == family) {
        let law = Value::try_from((parametric.member)(mean, variation)).expect("a table of plain values");
        return law[family].clone();
    }
    let half_width = (3f64.sqrt() * variation).min(1.0) * mean;
    match family {
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

fn list(values: &[f64]) -> Value {
    Value::Array(values.iter().map(|&value| Value::Float(value)).collect())
}

fn tabulated(mean: f64, half_width: f64, random: &mut SplitMix) -> Value {
    let places = [-1.0, -0.5, 0.0, 0.25, 1.0].map(|at| mean + at * half_width);
    let table = if random.chance(0.5) {
        Table::from_iter([
            ("samples".into(), list(&places)),
            ("exact".into(), Value::Boolean(random.chance(0.5))),
        ])
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
    let family = random.pick(Law::FAMILIES).name;
    Value::Table(Table::from_iter([(family.to_owned(), parameters(family, mean, variation, random))]))
}
