//! A finite number of contacts under a slider: how its first slip scatters about that of the master equation.

use asperity::block::{Block, Drive, Event, Loading, Slip};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::population::Population;
use kuva::plot::{MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::{Scene, render_multiple};

use crate::curve::line;
use crate::legend::placed;
use crate::page::{Page, small};
use crate::style::{self, BLACK, BLUE, GREEN, GREY, ORANGE, Plots, RED};
use crate::{equal, gaussian, master, point, start};

const STD: f64 = 0.1;
const STIFFNESS: f64 = 1.0;
const RUNS: u64 = 32;
const SIZES: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
/// A share of the contacts that no avalanche before a slip reaches, and every slip passes.
const FRACTION: f64 = 0.3;
/// The drive comes past the first slip, and not to the second.
const DISTANCE: f64 = 1.75;

/// Variance of the place of the maximum of W(t) − t², and mean of its height (docs/theory.md, "Few contacts").
const PLACE: f64 = 0.263_559_64;
const HEIGHT: f64 = 3.0 * PLACE;

const RULES: [(&str, Slip, &str); 5] = [
    ("reset", Slip::Reset, BLUE),
    ("overdamped", Slip::Overdamped, GREEN),
    ("inertial, undamped", Slip::Inertial { mass: 1.0, damping: 0.0 }, RED),
    ("inertial, γ = 0.5", Slip::Inertial { mass: 1.0, damping: 0.5 }, ORANGE),
    ("arrest", Slip::Arrest, GREY),
];

fn first_slip(population: &mut dyn Population, slip: Slip, fraction: Option<f64>) -> Event {
    let block = Block::new(Loading::Spring(STIFFNESS), slip, fraction).expect("a stiffness above 0");
    let drive = Drive { turning_points: vec![DISTANCE], points: 2 };
    block.pull(population, &drive).expect("a drive").events[0]
}

fn exact(slip: Slip) -> Event {
    let mut population =
        master(&gaussian(1.0, STD), &point(0.0)).population_with(1e-10, &mut ()).expect("contacts");
    first_slip(&mut population, slip, None)
}

/// A mean and its standard error.
struct Mean {
    value: f64,
    error: f64,
}

impl Mean {
    fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - value).powi(2)).sum::<f64>() / (n - 1.0);
        Self { value, error: (variance / n).sqrt() }
    }

    fn times(&self, factor: f64) -> String {
        format!("{:.3} ± {:.3}", factor * self.value, factor * self.error)
    }

    fn plain(&self) -> String {
        format!("{} ± {}", small(self.value), small(self.error))
    }
}

/// The first slips of many ensembles of one size, less that of the master equation.
struct Slips {
    size: f64,
    /// X_1.
    position: Mean,
    /// Standard deviation of X_1.
    scatter: Mean,
    /// X_T at the slip, less X_T of the same contacts at the X_1 of the master equation.
    drive: Mean,
    /// Where the slider is after the slip.
    after: Mean,
}

impl Slips {
    fn of(slip: Slip, size: usize) -> Self {
        let exact = exact(slip);
        let at = exact.before.position;
        let (contacts, initial) = (equal(&gaussian(1.0, STD), &point(0.0)), start(&point(0.0)));
        let [mut position, mut drive, mut after] = [const { Vec::new() }; 3];
        for seed in 0..RUNS {
            let ensemble = Ensemble::new(contacts.clone(), initial.clone(), size, seed, Disorder::Annealed);
            let ensemble = ensemble.expect("contacts that survive");
            let pull = ensemble.pull(&[at]).expect("a short pull");
            let mut population = ensemble.population().expect("few contacts");
            let event = first_slip(&mut population, slip, Some(FRACTION));
            position.push(event.before.position - at);
            drive.push(event.before.drive - (at + pull.force[0] / STIFFNESS));
            after.push(event.after.position - exact.after.position);
        }
        let position = Mean::of(&position);
        let runs = RUNS as f64;
        let value = position.error * runs.sqrt();
        let scatter = Mean { value, error: value / (2.0 * (runs - 1.0)).sqrt() };
        Self { size: size as f64, position, scatter, drive: Mean::of(&drive), after: Mean::of(&after) }
    }

    fn row(&self, name: &str) -> [String; 6] {
        let third = self.size.cbrt();
        [
            name.to_owned(),
            format!("{}", self.size),
            self.scatter.times(third),
            self.position.times(third),
            self.drive.times(third * third),
            self.after.plain(),
        ]
    }
}

/// N^{1/3} times the scatter of X_1 and N^{2/3} times the bias of X_T that theory expects.
fn theory() -> (f64, f64) {
    let (law, x) = (gaussian(1.0, STD), exact(Slip::Overdamped).before.position);
    // First breaks only: F'' = −2 P_c − X P_c', and N Var(F) grows by X² P_c dX.
    let density = law.density(x);
    let curvature = (2.0 + x * (1.0 - x) / (STD * STD)) * density / STIFFNESS;
    let noise = x * density.sqrt() / STIFFNESS;
    let width = (2.0 * noise / curvature).powf(2.0 / 3.0);
    (width * PLACE.sqrt(), noise * width.sqrt() * HEIGHT)
}

pub fn section(mut page: Page, quick: bool) -> Page {
    page.text(&format!(
        "
## A finite number of contacts

The first slip of a slider of stiffness K = {STIFFNESS} over N contacts with Gaussian thresholds, σ = {STD}, at stretch 0 at X = 0:
{RUNS} ensembles for each rule and each N, minus the master equation. Near X₁ breaks add a random walk to the parabola
X + F/K. The position X₁ of the loss of stability therefore scatters as $N^{{-1/3}}$, and the drive there is higher by
some $N^{{-2/3}}$ than that of the same contacts at the X₁ of the master equation
([theory](../theory.md#a-block-of-finite-stiffness)). Multiplied by these powers the columns are the same for all N; ± is one
standard error.
"
    ));
    let (scatter, bias) = theory();
    page.head(&[
        "rule",
        "N",
        "$N^{1/3}$ scatter of X₁",
        "$N^{1/3}$ (X₁ − exact)",
        "$N^{2/3}$ ($X_T$ − at the exact X₁)",
        "X after the slip − exact",
    ]);
    let none = || "–".to_owned();
    page.row(&["theory".into(), none(), format!("{scatter:.3}"), "0".into(), format!("{bias:.3}"), none()]);
    let sizes = if quick { &SIZES[..1] } else { &SIZES };
    let mut all = Vec::new();
    for (name, slip, _) in RULES {
        let slips: Vec<Slips> = sizes.iter().map(|&size| Slips::of(slip, size)).collect();
        slips.iter().for_each(|slips| page.row(&slips.row(name)));
        all.push(slips);
    }
    page.end();
    page.text(
        "
With inertia a slip begins earlier: the oscillation carries the slider over the rest of a barrier, which near X₁ is as
high as the random walk. With the other rules the beginning is the same: contacts that break re-form at once, with `arrest`
as long as an avalanche is not a slip. The end of a slip follows from the drive, and scatters as $N^{-1/2}$. With
`arrest` it also depends on X₁, since contacts that break from there on carry no force.
",
    );
    if !quick {
        let caption = "Standard deviation of the position of the loss of stability (circles) and excess of the drive there (triangles) against the number of contacts, by rule, slightly shifted; the lines are the theory of a Brownian motion on a parabola.";
        page.picture("scatter", caption, picture(&all, scatter, bias));
    }
    page
}

fn picture(all: &[Vec<Slips>], scatter: f64, bias: f64) -> Scene {
    let ends = [600.0, 1.8e6];
    let fall = |factor: f64, power: f64| ends.map(|n: f64| (n, factor * n.powf(power))).to_vec();
    let mut plots: Plots = vec![
        line(fall(scatter, -1.0 / 3.0), BLACK, 1.6, None),
        line(fall(bias, -2.0 / 3.0), BLACK, 1.6, Some("8 5")),
    ];
    let mut legend = Vec::new();
    for (i, ((name, _, color), slips)) in RULES.iter().zip(all).enumerate() {
        // Set apart, lest one hide the other.
        let apart = 1.15_f64.powi(i as i32 - RULES.len() as i32 / 2);
        let markers = |shape, value: fn(&Slips) -> f64| {
            let points = ScatterPlot::new().with_data(slips.iter().map(|s| (apart * s.size, value(s))));
            Plot::Scatter(points.with_color(*color).with_size(4.5).with_marker(shape))
        };
        plots.push(markers(MarkerShape::Circle, |s| s.scatter.value));
        plots.push(markers(MarkerShape::Triangle, |s| s.drive.value));
        legend.push(style::marker(*name, color, MarkerShape::Circle));
    }
    legend.push(style::line("scatter of X₁, ∝ 1/∛N", BLACK, None));
    legend.push(style::line("excess of X_T, ∝ 1/∛N²", BLACK, Some("8 5")));
    let layout = style::layout((ends[0], ends[1]), (1e-5, 0.1))
        .with_log_scale()
        .with_tick_format(style::powers((1e-5, 0.1)))
        .with_x_label("Number of contacts N")
        .with_y_label("Scatter of X₁, excess of the drive");
    placed(render_multiple(plots, layout), &legend, &[0])
}
