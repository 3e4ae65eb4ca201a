//! The relaxation length against the width of the law of thresholds, with two estimates.

use std::f64::consts::PI;
use std::sync::Arc;

use asperity::law::{Gamma, Law as _, Lognormal, SharedLaw, Weibull};
use asperity::numerics::roots::brent_root;
use kuva::plot::ScatterPlot;
use kuva::render::layout::TickFormat;
use kuva::render::plots::Plot;
use kuva::render::render::{Scene, render_multiple};

use crate::curve::line;
use crate::legend::placed;
use crate::page::{Page, below};
use crate::style::{self, BLACK, BLUE, GREEN, GREY, ORANGE, RED};
use crate::{gaussian, master, point, rectangular};

/// The c.v. of the table.
const TABLE: [f64; 6] = [0.02, 0.05, 0.1, 0.2, 0.3, 0.4];
/// c.v. at which x̄²/σ = x̄³/(2π²σ²).
const CROSSING: f64 = 1.0 / (2.0 * PI * PI);

type Family = fn(f64) -> Option<SharedLaw>;
const FAMILIES: [(&str, Family, &str, Option<&str>); 5] = [
    ("Gaussian", |cv| (cv <= 0.4).then(|| gaussian(1.0, cv)), BLACK, None),
    ("gamma", gamma, BLUE, Some("8 4")),
    ("Weibull", weibull, GREEN, Some("3 3")),
    ("rectangular", rectangle, RED, Some("12 3 3 3")),
    ("lognormal", |cv| Some(Arc::new(Lognormal::new(1.0, cv).ok()?)), ORANGE, Some("5 3")),
];

fn gamma(cv: f64) -> Option<SharedLaw> {
    if cv > 0.42 {
        return None;
    }
    Some(Arc::new(Gamma::new(1.0, cv).ok()?))
}

/// X* of the gamma law of mean 1 in closed form, 1/[λ(1 − cos 2π/m)] with m = λ = 1/cv², m > 4.
fn gamma_length(cv: f64) -> f64 {
    cv * cv / (1.0 - (2.0 * PI * cv * cv).cos())
}

fn weibull(cv: f64) -> Option<SharedLaw> {
    let law = |shape: f64| Weibull::new(shape, 1.0).ok();
    let excess = |shape: f64| law(shape).map_or(f64::NAN, |law| law.std() / law.mean() - cv);
    let shape = brent_root(excess, 1.0, 100.0, 1e-13)?;
    Some(Arc::new(Weibull::new(shape, 1.0 / law(shape)?.mean()).ok()?))
}

fn rectangle(cv: f64) -> Option<SharedLaw> {
    let half = cv * 3f64.sqrt();
    (half <= 1.0).then(|| rectangular(1.0 - half, 1.0 + half))
}

/// X*/x̄; of a truncated law with its own mean.
fn length(law: &SharedLaw) -> f64 {
    master(law, &point(0.0)).relaxation().unwrap().length() / law.mean()
}

fn paper(cv: f64) -> f64 {
    1.0 / cv
}

fn narrow(cv: f64) -> f64 {
    1.0 / (2.0 * PI * PI * cv * cv)
}

pub fn section(mut page: Page) -> Page {
    page.text(
        "
## Relaxation length

The displacement over which the influence of the initial state decays by e: X* = −1/Re s₁, s₁ the slowest root of
$\\hat P_c(s)$ = 1, against the width of the distribution of thresholds. The paper estimates x̄²/σ; for narrow ones it is x̄³/(2π²σ²).
",
    );
    let names: Vec<String> = FAMILIES.iter().map(|family| format!("{}, X*/x̄", family.0)).collect();
    let mut columns = vec!["σ/x̄"];
    columns.extend(names.iter().map(String::as_str));
    columns.extend(["paper, x̄/σ", "x̄²/(2π²σ²)"]);
    page.head(&columns);
    for cv in TABLE {
        let mut cells = vec![cv.to_string()];
        cells.extend(FAMILIES.iter().map(|f| (f.1)(cv).map_or("–".into(), |law| digits(length(&law)))));
        cells.extend([digits(paper(cv)), digits(narrow(cv))]);
        page.row(&cells);
    }
    page.end();
    let figure = length(&gaussian(1.0, 0.05));
    page.text(&format!(
        "
The two estimates cross at σ/x̄ = 1/(2π²) = {CROSSING:.4}, and the paper's only figure has σ/x̄ = 0.05: there the estimate
x̄²/σ says {:.2}, the exact X* is {figure:.2}. The agreement is only that of two curves where they cross.
If the width of the thresholds is halved, the initial state matters not twice but four times as
long; at σ/x̄ = 0.1 it matters for {:.1} mean thresholds, where the paper expects {:.1}, at 0.02 it lasts {:.0} where the paper
expects {:.0}. Each break adds an independent random displacement σ to the phase of a contact, so phases spread like a
random walk: (x̄/σ)² breaks, not x̄/σ, randomise them. The estimate of the paper has the right scaling for quenched
thresholds, for which the deviation of a contact is the same in every cycle.
",
        paper(0.05),
        length(&gaussian(1.0, 0.1)),
        paper(0.1),
        length(&gaussian(1.0, 0.02)),
        paper(0.02),
    ));
    let caption = "Relaxation length against the coefficient of variation of the thresholds; the dot is the paper's Fig. 2, where its estimate crosses the result for narrow distributions.";
    page.picture("relaxation", caption, picture());
    let off = TABLE.map(|cv| gamma(cv).map_or(0.0, |law| (length(&law) / gamma_length(cv) - 1.0).abs()));
    page.text(&format!(
        "
The gamma column is 1/[λ(1 − cos 2π/m)], m and λ the shape and the rate, to a relative {} throughout the table. The
analytic continuation of the transform of the lognormal distribution to Re s < 0 is not unique; its continued pole
determines the relaxation until the tail dominates at large X.
",
        below(off.into_iter().fold(0.0, f64::max))
    ));
    page
}

fn digits(value: f64) -> String {
    format!("{value:.4}")
}

fn picture() -> Scene {
    let cvs: Vec<f64> = (0..=120).map(|i| 0.02 * 30f64.powf(f64::from(i) / 120.0)).collect();
    let curve = |value: &dyn Fn(f64) -> Option<f64>| -> Vec<(f64, f64)> {
        cvs.iter().filter_map(|&cv| Some((cv, value(cv)?))).filter(|p| p.1.is_finite()).collect()
    };
    let mut plots = vec![
        line(curve(&|cv| Some(paper(cv))), GREY, 1.4, Some("2 4")),
        line(curve(&|cv| (narrow(cv) > 0.2).then(|| narrow(cv))), GREY, 1.4, None),
    ];
    let mut legend = Vec::new();
    for (name, family, color, dashes) in FAMILIES {
        plots.push(line(curve(&|cv| Some(length(&family(cv)?))), color, 2.0, dashes));
        legend.push(style::line(name, color, dashes));
    }
    legend.push(style::line("the paper's x̄²/σ", GREY, Some("2 4")));
    legend.push(style::line("x̄³/(2π²σ²)", GREY, None));
    let dot =
        ScatterPlot::new().with_data([(0.05, length(&gaussian(1.0, 0.05)))]).with_color(BLACK).with_size(5.0);
    plots.push(Plot::Scatter(dot));
    let layout = style::layout((0.02, 0.6), (0.2, 200.0))
        .with_log_scale()
        .with_tick_format(TickFormat::Custom(Arc::new(style::digits)))
        .with_x_label("Coefficient of variation σ/x̄ of the thresholds")
        .with_y_label("Relaxation length X*/x̄");
    placed(render_multiple(plots, layout), &legend, &[0])
}
