//! Error against cost: the paper's stepping in four readings, and the renewal solver.

use asperity::exact::{ClosedForm as _, Gaussian};
use asperity::master::{Stepping, Variant};
use asperity::numerics::legendre::RULE;
use cpu_time::ThreadTime;
use kuva::plot::{LegendEntry, MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::{Scene, render_multiple};

use crate::curve::line;
use crate::legend::placed;
use crate::page::{Page, below, decades, small};
use crate::style::{self, BLACK, BLUE, GREEN, ORANGE, RED};
use crate::{gaussian, grid, master};

const LAST: f64 = 20.0;
/// Distance between the positions at which forces are compared.
const EVERY: f64 = 0.02;
const STEPS: [f64; 7] = [2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4];
/// Finest step that a quick run takes.
const QUICK: f64 = 1e-3;
const TOLERANCES: [f64; 5] = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12];
const REPEATS: usize = 5;

const VARIANTS: [(&str, Variant, &str, MarkerShape); 3] = [
    ("Eq. (2), shifted", Variant::Shifted, ORANGE, MarkerShape::Square),
    ("upwind", Variant::Upwind, RED, MarkerShape::TriangleDown),
    ("survival ratio", Variant::SurvivalRatio, GREEN, MarkerShape::Triangle),
];

/// Errors of F, and CPU seconds.
struct Measured {
    at_five: f64,
    largest: f64,
    seconds: f64,
}

pub fn section(mut page: Page, quick: bool) -> Page {
    page.text(
        "
## Error and cost

The paper's Fig. 2: $P_c$ = G(1, 0.05), $Q_\\mathrm{ini}$ = G(0.1, 0.025), R = δ. Errors are against a closed form: contacts that
all start at stretch y have F in closed form, and F of the figure is its mean over y ≥ 0. The stepping of Eq. (2),
Q(x; X + ΔX) = Q(x − ΔX; X) − ΔQ₋ + ΔQ₊, has four variants:

* *shifted*: ΔQ₋ = min(P ΔX, 1) of the shifted Q, nodes at iΔX;
* *literal*: ΔQ₋ = P ΔX of the Q before the shift, as printed;
* *survival ratio*: the shifted Q survives by S(x + ΔX)/S(x), cells centred;
* *upwind*: the differential equation with first-order upwind differences, two steps of X per ΔX.

*Renewal* is the solver of this program with the given tolerance; its time includes the lives of the contacts, the
solution to X = 20 and F at 1001 positions.
",
    );
    let exact = exact();
    page.head(&["method", "ΔX or tolerance", "error of F(5)", "in %", "largest error, X ≤ 20"]);
    let mut results = Vec::new();
    for (name, variant, ..) in VARIANTS {
        let steps = STEPS.into_iter().filter(|&step| !quick || step >= QUICK);
        let measured: Vec<(f64, Measured)> =
            steps.map(|step| (step, stepped(variant, step, &exact))).collect();
        for (step, m) in &measured {
            errors(&mut page, name, *step, m, exact[index(5.0)]);
        }
        results.push(measured);
    }
    let renewal: Vec<(f64, Measured)> =
        TOLERANCES.map(|tolerance| (tolerance, renewed(tolerance, &exact))).into();
    for (tolerance, m) in &renewal {
        let cells = ["renewal".into(), small(*tolerance), below(m.at_five), String::new(), below(m.largest)];
        page.row(&cells);
    }
    results.push(renewal);
    page.end();
    if !quick {
        costs(&mut page, &results);
    }
    let caption = "Largest error of F for X ≤ 20 of Fig. 2 against CPU time.";
    page.picture("cost", caption, picture(&results));
    unstable(&mut page, &exact);
    truncation(&mut page, &exact);
    page
}

fn errors(page: &mut Page, name: &str, step: f64, m: &Measured, force: f64) {
    let percent = format!("{:.3}", 100.0 * m.at_five / force);
    page.row(&[name.into(), small(step), small(m.at_five), percent, small(m.largest)]);
}

fn costs(page: &mut Page, results: &[Vec<(f64, Measured)>]) {
    page.text(
        "The cost: the shortest time for a given largest error, and its ratio to that of the renewal solver.",
    );
    page.head(&["largest error at most", "shifted", "upwind", "survival ratio", "renewal"]);
    for limit in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-10] {
        let least = |results: &[(f64, Measured)]| {
            let reached = results.iter().filter(|r| r.1.largest.abs() <= limit).map(|r| r.1.seconds);
            reached.fold(f64::INFINITY, f64::min)
        };
        let ours = least(&results[3]);
        let cell = |seconds: f64| match seconds {
            s if s.is_infinite() => "not reached".into(),
            s => format!("{} ms ({} ×)", two_digits(1e3 * s), two_digits(s / ours)),
        };
        let mut cells = vec![small(limit)];
        cells.extend(results.iter().map(|r| cell(least(r))));
        page.timed_row(&cells);
    }
    page.end();
}

fn two_digits(value: f64) -> String {
    style::digits(format!("{value:.1e}").parse().unwrap_or(value))
}

fn index(position: f64) -> usize {
    (position / EVERY).round() as usize
}

/// F of Fig. 2: ∫₀^∞ Q_ini(y) F(X | y) dy with F(X | y) in closed form.
fn exact() -> Vec<f64> {
    let initial = gaussian(0.1, 0.025);
    let edges: Vec<f64> = (0..=10).map(|i| f64::from(i) * 0.04).collect();
    let force = |x: f64| {
        let weighted = |y: f64| initial.density(y) * Gaussian::new(1.0, 0.05).starting_from(y, 0.0).force(x);
        edges.windows(2).map(|edge| RULE.integrate(edge[0], edge[1], weighted)).sum()
    };
    grid(LAST, EVERY).into_iter().map(force).collect()
}

fn stepped(variant: Variant, step: f64, exact: &[f64]) -> Measured {
    // What is quick is repeated, so that its time means something.
    let repeats = if step > QUICK { REPEATS } else { 1 };
    let mut seconds = Vec::new();
    let mut force = Vec::new();
    for _ in 0..repeats {
        let begun = ThreadTime::now();
        force = steps(variant, step, LAST);
        seconds.push(begun.elapsed().as_secs_f64());
    }
    measured(&force, exact, seconds)
}

/// F at the positions of comparison.
fn steps(variant: Variant, step: f64, last: f64) -> Vec<f64> {
    let mut stepping = Stepping::new(&*gaussian(1.0, 0.05), &*gaussian(0.1, 0.025), step, variant);
    let each = (EVERY / step).round() as usize;
    let mut force = vec![stepping.force()];
    for _ in 0..index(last) {
        (0..each).for_each(|_| stepping.advance());
        force.push(stepping.force());
    }
    force
}

fn renewed(tolerance: f64, exact: &[f64]) -> Measured {
    let (mut seconds, mut force) = (Vec::new(), Vec::new());
    for _ in 0..REPEATS {
        let begun = ThreadTime::now();
        let pull = master(&gaussian(1.0, 0.05), &gaussian(0.1, 0.025)).pull_with(LAST, tolerance, &mut ());
        let pull = pull.expect("the tolerance is reached");
        force = grid(LAST, EVERY).into_iter().map(|x| pull.force(x)).collect();
        seconds.push(begun.elapsed().as_secs_f64());
    }
    measured(&force, exact, seconds)
}

fn measured(force: &[f64], exact: &[f64], mut seconds: Vec<f64>) -> Measured {
    seconds.sort_by(f64::total_cmp);
    let errors = || force.iter().zip(exact).map(|(f, e)| f - e);
    let largest = errors().fold(0.0, |most: f64, e| most.max(e.abs()));
    Measured { at_five: force[index(5.0)] - exact[index(5.0)], largest, seconds: seconds[seconds.len() / 2] }
}

fn picture(results: &[Vec<(f64, Measured)>]) -> Scene {
    let renewal = ("renewal", BLUE, MarkerShape::Circle);
    let named = VARIANTS.iter().map(|v| (v.0, v.2, v.3)).chain([renewal]);
    let (mut plots, mut legend): (style::Plots, Vec<LegendEntry>) = Default::default();
    for ((name, color, marker), results) in named.zip(results) {
        // Decades: an axis that is logarithmic itself ends at 1e-10.
        let place = |m: &Measured| (m.seconds.log10(), m.largest.max(1e-15).log10());
        let points: Vec<(f64, f64)> = results.iter().map(|r| place(&r.1)).collect();
        plots.push(line(points.clone(), color, 1.4, None));
        let markers =
            ScatterPlot::new().with_data(points).with_color(color).with_marker(marker).with_size(4.5);
        plots.push(Plot::Scatter(markers));
        legend.push(style::marker(name, color, marker));
    }
    let layout = style::layout((-4.5, 0.5), (-15.0, 0.0))
        .with_x_tick_step(1.0)
        .with_y_tick_step(3.0)
        .with_tick_format(decades())
        .with_x_label("CPU time (s)")
        .with_y_label("Largest error of F, X ≤ 20");
    placed(render_multiple(plots, layout), &legend, &[0])
}

/// The literal reading: where it leaves, and a picture.
fn unstable(page: &mut Page, exact: &[f64]) {
    page.text(
        "
The literal variant of Eq. (2) is unstable: in the tail of $P_c$, where P ΔX > 1, more contacts break than exist, and Q
becomes negative and grows. Every grid fails within the second cycle, the finest first: it resolves more of the tail.
Eq. (2) is a usable method only if breaking is limited to the existing contacts, as in the shifted variant.
",
    );
    page.head(&["ΔX", "literal: ∣F − exact∣ > 0.1 from X =", "> 10 from X ="]);
    for step in [2e-2, 1e-2, 5e-3, 2e-3, 1e-3] {
        let force = steps(Variant::Literal, step, LAST);
        let leaves = |limit: f64| {
            let first = force.iter().zip(exact).position(|(f, e)| (f - e).abs() > limit || f.is_nan());
            first.map_or("–".into(), |i| format!("{:.2}", i as f64 * EVERY))
        };
        page.row(&[small(step), leaves(0.1), leaves(10.0)]);
    }
    page.end();
    let caption = "F(X) of Fig. 2: closed form, and Eq. (2) with ΔX = 0.01 in three variants. The literal one leaves the range of the plot.";
    page.picture("stepping", caption, readings(exact));
}

fn readings(exact: &[f64]) -> Scene {
    const END: f64 = 6.0;
    const TOP: f64 = 1.0;
    let x = grid(END, EVERY);
    let with = |force: &[f64]| x.iter().copied().zip(force.iter().copied()).collect::<Vec<_>>();
    let mut literal = with(&steps(Variant::Literal, 1e-2, END));
    let end = literal.iter().position(|p| !(0.0..TOP).contains(&p.1)).unwrap_or(literal.len() - 1);
    literal.truncate(end + 1);
    // It goes to the edge of the picture.
    literal[end].1 = literal[end].1.clamp(0.0, TOP);
    let plots = vec![
        line(with(exact), BLACK, 2.2, None),
        line(with(&steps(Variant::Shifted, 1e-2, END)), ORANGE, 2.0, Some("8 4")),
        line(with(&steps(Variant::SurvivalRatio, 1e-2, END)), GREEN, 2.0, Some("3 3")),
        line(literal, RED, 1.6, Some("12 3 3 3")),
    ];
    let legend = vec![
        style::line("closed form", BLACK, None),
        style::line("shifted", ORANGE, Some("8 4")),
        style::line("survival ratio", GREEN, Some("3 3")),
        style::line("literal", RED, Some("12 3 3 3")),
    ];
    let layout =
        style::layout((0.0, END), (0.0, TOP)).with_x_label("Position X").with_y_label("Friction force F");
    placed(render_multiple(plots, layout), &legend, &[0])
}

fn truncation(page: &mut Page, exact: &[f64]) {
    let whole = Gaussian::new(1.0, 0.05).starting_from(0.1, 0.025);
    let differences = grid(LAST, EVERY).into_iter().zip(exact).map(|(x, e)| (whole.force(x) - e).abs());
    let largest = differences.fold(0.0, f64::max);
    page.text(&format!(
        "
A Gaussian $Q_\\mathrm{{ini}}$ has Φ(−4) = 3.2e-5 of its mass below 0, which no contact can have. The program truncates it; the
closed form of `exact::Gaussian`, which keeps it, differs from the exact result for this figure by up to {}. This is the effect
of the mass below 0, not an error of either; where $Q_\\mathrm{{ini}}$ = δ they agree to rounding (below).
",
        small(largest)
    ));
}
