//! What the page is of: distributions by their width, and rules in time.

use asperity::scenario::Law;
use toml::Value;

/// Coefficients of variation.
pub const VARIATIONS: [f64; 9] = [1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.3, 1.0, 1.5, 3.0];

/// Velocities, in mean thresholds per time 1.
pub const VELOCITIES: [f64; 4] = [1e-6, 1e-2, 1.0, 100.0];

/// What costs are counted in.
pub const UNIT: &str =
    "contacts.thresholds.gaussian = { mean = 1.0, std = 0.05 }\npull = { distance = 5.0, points = 101 }\n";

/// A family of distributions of mean 1, or nearly.
pub struct Family {
    /// Its name in scenarios.
    pub name: &'static str,
    /// The thresholds of a coefficient of variation, if there are any.
    thresholds: Box<dyn Fn(f64) -> Option<String>>,
}

impl Family {
    /// A pull over five mean thresholds.
    pub fn pull(&self, variation: f64) -> Option<String> {
        let thresholds = (self.thresholds)(variation)?;
        Some(format!("contacts.{thresholds}\npull = {{ distance = 5.0, points = 101 }}\n"))
    }
}

/// Evenly spaced quantiles of a triangle.
fn samples(variation: f64) -> Option<String> {
    let half = 6f64.sqrt() * variation;
    let at = |i: u32| {
        let p = (f64::from(i) + 0.5) / 20.0;
        1.0 + half * if p < 0.5 { (2.0 * p).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - p)).sqrt() }
    };
    let samples: Vec<_> = (0..20).map(at).collect();
    (half < 1.0).then(|| format!("thresholds.tabulated.samples = {samples:?}"))
}

/// All families.
pub fn families() -> Vec<Family> {
    let family =
        |name, thresholds: fn(f64) -> Option<String>| Family { name, thresholds: Box::new(thresholds) };
    // A point mass has no width.
    let parametric = Law::FAMILIES.iter().filter(|family| family.widths[1] > 0.0).map(|family| Family {
        name: family.name,
        thresholds: Box::new(|width| {
            let [low, high] = family.widths;
            let law = Value::try_from((family.member)(1.0, width)).expect("a table of plain values");
            (low..=high).contains(&width).then(|| format!("thresholds = {law}"))
        }),
    });
    let others = [
        family("tabulated", samples),
        family("mixture", |cv| {
            let part = |weight: f64, mean: f64| {
                format!("{{ weight = {weight:?}, law.gamma = {{ mean = {mean:?}, std = {:?} }} }}", mean * cv)
            };
            Some(format!("thresholds.mixture = [{}, {}]", part(0.5, 0.8), part(0.5, 1.2)))
        }),
        family("areas", |cv| {
            // Areas vary twice as much as their roots.
            Some(format!(
                "areas = {{ modulus = 1.0, strength = 1.0, law.gamma = {{ mean = 1.0, std = {:?} }} }}",
                2.0 * cv
            ))
        }),
        family("renormalised", |cv| {
            let coupling = 0.5 * cv.min(0.5);
            let law = format!("{{ gaussian = {{ mean = 1.0, std = {cv:?} }} }}");
            Some(format!("thresholds.renormalised = {{ coupling = {coupling:?}, law = {law} }}"))
        }),
    ];
    parametric.chain(others).collect()
}

/// A rule in time.
pub struct Rule {
    /// Its name in scenarios.
    pub name: &'static str,
    /// Its contacts, in words.
    pub words: &'static str,
    contacts: &'static str,
    /// Whether the test recomputes it.
    #[cfg_attr(not(test), allow(dead_code))]
    pub quick: bool,
}

impl Rule {
    /// A pull over five mean thresholds.
    pub fn pull(&self, velocity: f64) -> String {
        let Self { contacts, .. } = self;
        format!("[contacts]\n{contacts}\n[pull]\ndistance = 5.0\npoints = 101\nvelocity = {velocity:?}\n")
    }
}

macro_rules! rule {
    ($name:literal, $words:literal, $quick:literal, $($line:literal),+) => {
        Rule { name: $name, words: $words, contacts: concat!($($line, "\n"),+), quick: $quick }
    };
}

/// All rules.
pub const RULES: &[Rule] = &[
    rule!(
        "elastic barrier",
        "G(1, 0.1), T = 0.05, ω = 1",
        false,
        "thresholds.gaussian = { mean = 1.0, std = 0.1 }",
        "temperature = { energy = 0.05, attempt_rate = 1.0, barrier = \"elastic\" }"
    ),
    rule!(
        "bell barrier",
        "the same",
        false,
        "thresholds.gaussian = { mean = 1.0, std = 0.1 }",
        "temperature = { energy = 0.05, attempt_rate = 1.0, barrier = \"bell\" }"
    ),
    rule!(
        "catastrophe barrier",
        "the same",
        false,
        "thresholds.gaussian = { mean = 1.0, std = 0.1 }",
        "temperature = { energy = 0.05, attempt_rate = 1.0, barrier = \"catastrophe\" }"
    ),
    rule!(
        "elastic barrier, wide",
        "exponential(1), T = 0.05, ω = 1",
        false,
        "thresholds.exponential.mean = 1.0",
        "temperature = { energy = 0.05, attempt_rate = 1.0 }"
    ),
    rule!(
        "logarithmic",
        "G(1, 0.1), β = 0.02, τ₀ = 1",
        true,
        "thresholds.gaussian = { mean = 1.0, std = 0.1 }",
        "ageing.logarithmic = { growth = 0.02, time = 1.0 }"
    ),
    rule!(
        "frozen_rank",
        "G(0.5, 0.1) → G(1, 0.05) in a time of 1",
        true,
        "thresholds.gaussian = { mean = 0.5, std = 0.1 }",
        "ageing.frozen_rank = { time = 1.0, mature.gaussian = { mean = 1.0, std = 0.05 } }"
    ),
    rule!(
        "frozen_rank, gamma",
        "gamma(0.7, 0.14) → gamma(1.2, 0.15)",
        false,
        "thresholds.gamma = { mean = 0.7, std = 0.14 }",
        "ageing.frozen_rank = { time = 1.0, mature.gamma = { mean = 1.2, std = 0.15 } }"
    ),
    rule!(
        "smoluchowski",
        "G(0.5, 0.1) → G(1, 0.05), D = 0.0025",
        false,
        "thresholds.gaussian = { mean = 0.5, std = 0.1 }",
        "ageing.smoluchowski = { diffusion = 0.0025, mature.gaussian = { mean = 1.0, std = 0.05 } }"
    ),
    rule!(
        "smoluchowski, rectangular",
        "U(0.4, 0.6) → G(1, 0.05), D = 0.0025",
        false,
        "thresholds.rectangular = { min = 0.4, max = 0.6 }",
        "ageing.smoluchowski = { diffusion = 0.0025, mature.gaussian = { mean = 1.0, std = 0.05 } }"
    ),
    rule!(
        "delay",
        "G(1, 0.1), τ = 0.5",
        true,
        "thresholds.gaussian = { mean = 1.0, std = 0.1 }",
        "delay.time = 0.5"
    ),
    rule!("delay, one threshold", "all 1, τ = 0.5", true, "thresholds.point.at = 1.0", "delay.time = 0.5"),
];
