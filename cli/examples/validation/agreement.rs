//! The ensemble against the master equation: independent answers, compared in units of the exact scatter.

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Start, Stiffness};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::law::{Exponential, Gamma, Lognormal, SharedLaw, Weibull};
use asperity::master::{MasterEquation, Pull};
use kuva::plot::{MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::{Scene, render_multiple};

use crate::curve::line;
use crate::legend::placed;
use crate::page::{Page, small};
use crate::style::{self, BLACK, BLUE, GREY};
use crate::{equal, gaussian, point, rectangular, start};

const SEEDS: u64 = 400;
const SIZE: usize = 2000;
/// Where forces are compared: one position for each ensemble, so that all are independent.
const POSITIONS: [f64; 4] = [0.9, 2.3, 5.0, 12.7];

struct Case {
    name: &'static str,
    contacts: Contacts,
    initial: Initial,
}

fn cases() -> Vec<Case> {
    let (relaxed, narrow) = (point(0.0), gaussian(1.0, 0.05));
    let per_threshold =
        Contacts { stiffness: Stiffness::PerThreshold(1.0), ..equal(&gaussian(1.0, 0.2), &relaxed) };
    let at_once = Initial { start: Start::Relaxed, ..start(&gaussian(0.9, 0.1)) };
    let of = |law: SharedLaw| equal(&law, &point(0.0));
    let rest = || start(&point(0.0));
    vec![
        Case { name: "Fig. 2", contacts: of(narrow.clone()), initial: start(&gaussian(0.1, 0.025)) },
        Case { name: "Gaussian, c.v. 0.2", contacts: of(gaussian(1.0, 0.2)), initial: rest() },
        Case { name: "rectangular 0.75 to 1.25", contacts: of(rectangular(0.75, 1.25)), initial: rest() },
        Case {
            name: "gamma, c.v. 0.5",
            contacts: of(Arc::new(Gamma::new(1.0, 0.5).unwrap())),
            initial: rest(),
        },
        Case {
            name: "Weibull, shape 3",
            contacts: of(Arc::new(Weibull::new(3.0, 1.1).unwrap())),
            initial: rest(),
        },
        Case {
            name: "lognormal, c.v. 0.5",
            contacts: of(Arc::new(Lognormal::new(1.0, 0.5).unwrap())),
            initial: rest(),
        },
        Case { name: "exponential", contacts: of(Arc::new(Exponential::new(1.0).unwrap())), initial: rest() },
        Case {
            name: "R = U(0, 0.2), below thresholds",
            contacts: equal(&rectangular(0.8, 1.2), &rectangular(0.0, 0.2)),
            initial: rest(),
        },
        Case {
            name: "R = U(0, 0.6), among thresholds U(0.4, 1.6)",
            contacts: equal(&rectangular(0.4, 1.6), &rectangular(0.0, 0.6)),
            initial: rest(),
        },
        Case { name: "relaxed start among thresholds", contacts: of(gaussian(1.0, 0.1)), initial: at_once },
        Case { name: "k = κ x_s, c.v. 0.2", contacts: per_threshold, initial: rest() },
    ]
}

impl Case {
    fn solved(&self) -> Pull {
        let master =
            MasterEquation::new(self.contacts.clone(), &self.initial).expect("contacts that survive");
        master.pull_with(15.0, 1e-10, &mut ()).expect("the tolerance is reached")
    }

    /// F of an ensemble at X.
    fn drawn(&self, size: usize, seed: u64, position: f64) -> f64 {
        let ensemble =
            Ensemble::new(self.contacts.clone(), self.initial.clone(), size, seed, Disorder::Annealed);
        let pull = ensemble.and_then(|ensemble| ensemble.pull(&[position]));
        pull.expect("contacts that survive").force[0]
    }

    /// (F of the ensemble − F of the master equation) over its exact standard deviation, one for each seed.
    fn deviations(&self) -> Vec<f64> {
        let exact = self.solved();
        let deviation = |seed: u64| {
            let position = POSITIONS[seed as usize % POSITIONS.len()];
            (self.drawn(SIZE, seed, position) - exact.force(position))
                / exact.force_std(SIZE as f64).unwrap()(position)
        };
        (0..SEEDS).map(deviation).collect()
    }
}

pub fn section(mut page: Page) -> Page {
    page.text(&format!(
        "
## Ensemble against master equation

The two solvers share only the description of the contacts. The table shows {SEEDS} ensembles of {SIZE} contacts for
each interface, each with its own seed and one position X (0.9, 2.3, 5 or 12.7). z is the difference of F from the
master equation, divided by the exact standard deviation that the master equation gives for this number of contacts. If
both are correct, z is standard normal: mean 0 ± {:.2}, variance 1 ± {:.2} (one standard error). √n D is the Kolmogorov–Smirnov
distance from the normal distribution: it exceeds 1.63 in one of 100 correct cases, 1.95 in one of 1000.
",
        1.0 / (SEEDS as f64).sqrt(),
        (2.0 / SEEDS as f64).sqrt(),
    ));
    page.head(&["interface", "mean z", "variance of z", "largest ∣z∣", "√n D"]);
    let mut all = Vec::new();
    for case in cases() {
        let z = case.deviations();
        summary(&mut page, case.name, &z);
        all.extend(z);
    }
    summary(&mut page, "all", &all);
    page.end();
    all.sort_by(f64::total_cmp);
    let caption = "All z of the table, in order, against the quantiles of the standard normal distribution; the line is equality.";
    page.picture("agreement", caption, quantiles(&all));
    noise(&mut page);
    page
}

fn summary(page: &mut Page, name: &str, z: &[f64]) {
    let n = z.len() as f64;
    let mean = z.iter().sum::<f64>() / n;
    let variance = z.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let largest = z.iter().fold(0.0, |most: f64, z| most.max(z.abs()));
    let two = |value: f64| format!("{value:.2}");
    page.row(&[name.into(), two(mean), two(variance), two(largest), two(n.sqrt() * distance(z))]);
}

/// P(normal ≤ z), from a law of the program: of a mean so large that nothing of it is below 0.
fn normal(z: f64) -> f64 {
    1.0 - gaussian(100.0, 1.0).survival(100.0 + z)
}

/// Kolmogorov's distance to the standard normal distribution.
fn distance(z: &[f64]) -> f64 {
    let mut z = z.to_vec();
    z.sort_by(f64::total_cmp);
    let n = z.len() as f64;
    let off =
        |(i, &z): (usize, &f64)| (normal(z) - i as f64 / n).abs().max((normal(z) - (i + 1) as f64 / n).abs());
    z.iter().enumerate().map(off).fold(0.0, f64::max)
}

fn quantiles(z: &[f64]) -> Scene {
    const END: f64 = 4.0;
    let law = gaussian(100.0, 1.0);
    let expected = |i: usize| law.quantile((i as f64 + 0.5) / z.len() as f64) - 100.0;
    // In the middle points lie so close that every 20th is enough.
    let shown = (0..z.len()).filter(|i| i % 20 == 0 || expected(*i).abs() > 2.0);
    let points =
        ScatterPlot::new().with_data(shown.map(|i| (expected(i), z[i]))).with_color(BLUE).with_size(2.6);
    let plots = vec![line(vec![(-END, -END), (END, END)], GREY, 1.4, None), Plot::Scatter(points)];
    let layout = style::layout((-END, END), (-END, END))
        .with_x_label("Quantile of the standard normal distribution")
        .with_y_label("z = (ensemble − master equation)/std");
    let legend = vec![
        style::marker(format!("{} ensembles of {SIZE} contacts", z.len()), BLUE, MarkerShape::Circle),
        style::line("expected", GREY, None),
    ];
    placed(render_multiple(plots, layout), &legend, &[0])
}

/// How the noise falls with the number of contacts.
fn noise(page: &mut Page) {
    const MEMBERS: u64 = 200;
    const POSITION: f64 = 5.0;
    page.text(&format!(
        "
The standard deviation of F(5) of Fig. 2 between {MEMBERS} ensembles, and the exact one of the master equation. The
former has a standard error of {:.0} %.
",
        100.0 / (2.0 * (MEMBERS - 1) as f64).sqrt()
    ));
    page.head(&["N", "standard deviation", "exact", "ratio"]);
    let case = &cases()[0];
    let exact = case.solved();
    let (mut points, mut band) = (Vec::new(), Vec::new());
    for size in [10, 100, 1000, 10_000, 100_000] {
        let forces: Vec<f64> = (0..MEMBERS).map(|seed| case.drawn(size, 1000 + seed, POSITION)).collect();
        let mean = forces.iter().sum::<f64>() / forces.len() as f64;
        let variance = forces.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / (forces.len() - 1) as f64;
        let (scatter, expected) = (variance.sqrt(), exact.force_std(size as f64).unwrap()(POSITION));
        page.row(&[size.to_string(), small(scatter), small(expected), format!("{:.2}", scatter / expected)]);
        points.push((size as f64, scatter));
        band.push((size as f64, expected));
    }
    page.end();
    let markers = ScatterPlot::new().with_data(points).with_color(BLUE).with_size(4.5);
    let plots = vec![line(band, BLACK, 1.6, None), Plot::Scatter(markers)];
    let legend = vec![
        style::marker(format!("scatter of {MEMBERS} ensembles"), BLUE, MarkerShape::Circle),
        style::line("master equation, √([∫x²Q − (∫xQ)²]/N)", BLACK, None),
    ];
    let layout = style::layout((5.0, 2e5), (1e-4, 1.0))
        .with_log_scale()
        .with_tick_format(style::powers((5.0, 2e5)))
        .with_x_label("Number of contacts N")
        .with_y_label("Standard deviation of F(5)");
    let caption = "Standard deviation of the force against the number of contacts: ensembles, and the master equation, whose cost does not depend on N.";
    page.picture("noise", caption, placed(render_multiple(plots, layout), &legend, &[0]));
}
