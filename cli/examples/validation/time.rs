//! Time-dependent contacts: kinetic friction against velocity beside the ensemble, and velocities that vary.

use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Start};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::master::MasterEquation;
use kuva::plot::{LegendEntry, MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::{Scene, render_multiple};

use crate::curve::line;
use crate::legend::placed;
use crate::page::{Page, small};
use crate::style::{self, BLACK, BLUE, GREEN, GREY, ORANGE, RED};
use crate::ways::{self, Followed, Kind, ageing, contacts, thermal};
use crate::{gaussian, point};

/// Contacts of an ensemble in steady sliding, and under a velocity that varies.
const SIZE: usize = 10_000;
const MANY: usize = 1_000_000;

/// Of transport: far below the standard errors of so many contacts.
const TOLERANCE: f64 = 1e-5;

/// Lengths of dephasing after which 3e-4 is left of what a start makes differ.
const FORGOTTEN: f64 = 8.0;

/// Contacts of one kind, and what is known of them: velocities with F_k in the digits that theory gives.
struct Case {
    name: &'static str,
    color: &'static str,
    contacts: Contacts,
    /// Whether the rule is one for single contacts.
    drawn: bool,
    /// What is cheap is computed again by the test.
    quick: bool,
    known: Vec<(f64, &'static str)>,
}

fn cases() -> Vec<Case> {
    let (fresh, mature) = (|| gaussian(0.5, 0.1), || gaussian(1.0, 0.05));
    let of = |name, color, contacts, known: &[(f64, &'static str)]| Case {
        name,
        color,
        contacts,
        drawn: true,
        quick: false,
        known: known.to_vec(),
    };
    let single = |barrier| contacts(point(1.0), thermal(barrier, 0.025));
    let matured = |rule| contacts(fresh(), ageing(rule));
    let strengthening = Ageing::Logarithmic { growth: 0.02, time: 1.0 };
    let logarithmic = of(
        "logarithmic",
        GREEN,
        contacts(gaussian(1.0, 0.1), ageing(strengthening)),
        &[(1e-6, "0.6472942007"), (1e-4, "0.6000169155"), (1e-2, "0.5527655886"), (1.0, "0.5122109494")],
    );
    let frozen_rank = of(
        "frozen_rank",
        ORANGE,
        matured(Ageing::FrozenRank { mature: mature(), time: 1.0 }),
        &[(0.01, "0.50125"), (0.1, "0.5012378105"), (1.0, "0.3867782523"), (10.0, "0.2721367872")],
    );
    let smoluchowski = of(
        "smoluchowski",
        RED,
        matured(Ageing::Smoluchowski { mature: mature(), diffusion: 0.0025 }),
        &[(0.01, "0.46235"), (0.1, "0.49031"), (1.0, "0.38468"), (10.0, "0.2720")],
    );
    let mean_field = of(
        "mean_field",
        BLUE,
        matured(Ageing::MeanField { mature: mature(), diffusion: 0.0025 }),
        &[(0.01, "0.4994032648"), (0.1, "0.4831162958"), (1.0, "0.3700809896"), (10.0, "0.2718511722")],
    );
    vec![
        of(
            "elastic",
            BLACK,
            single(Barrier::Elastic),
            &[(1e-10, "0.04114415072"), (1e-6, "0.3330145881"), (1e-2, "0.4800442117")],
        ),
        of(
            "bell",
            GREY,
            single(Barrier::Bell),
            &[(1e-10, "0.02192174029"), (1e-6, "0.2198520329"), (1e-2, "0.4476061367")],
        ),
        of(
            "catastrophe",
            BLUE,
            single(Barrier::Catastrophe),
            &[(1e-10, "0.01829963892"), (1e-6, "0.1653798456"), (1e-2, "0.3848110420")],
        ),
        of(
            "elastic, distributed",
            ORANGE,
            contacts(gaussian(1.0, 0.1), thermal(Barrier::Elastic, 0.05)),
            &[(1e-6, "0.155066"), (1e-4, "0.29806681116"), (1e-2, "0.44526255210"), (1.0, "")],
        ),
        Case { quick: true, ..logarithmic },
        Case { quick: true, ..frozen_rank },
        smoluchowski,
        Case { drawn: false, quick: true, ..mean_field },
    ]
}

fn relaxed() -> Initial {
    Initial { law: point(0.0), start: Start::Conditional }
}

/// F_k of the ensemble and its standard error, after a way on which the start is forgotten.
struct Drawn {
    force: f64,
    error: f64,
}

impl Case {
    fn equation(&self, velocity: f64) -> MasterEquation {
        MasterEquation::at(self.contacts.clone(), &relaxed(), velocity).expect("a velocity above 0")
    }

    fn kinetic_friction(&self, velocity: f64) -> f64 {
        self.equation(velocity).steady_state().kinetic_friction()
    }

    fn draw(&self, velocity: f64) -> Drawn {
        let equation = self.equation(velocity);
        let steady = equation.steady_state();
        let way = (FORGOTTEN * steady.dephasing_length()).max(FORGOTTEN * steady.life_found());
        let duration = way / velocity;
        let history =
            History::new(vec![Piece { velocity, duration }]).expect("a velocity and a time above 0");
        let ensemble = Ensemble::new(self.contacts.clone(), relaxed(), SIZE, 1, Disorder::Annealed);
        let trace = ensemble.and_then(|ensemble| ensemble.follow(&history, &[duration]));
        let trace = trace.expect("a rule for single contacts");
        Drawn { force: trace.force[0], error: trace.error[0] }
    }
}

pub fn section(mut page: Page, quick: bool) -> Page {
    friction(&mut page, quick);
    varying(&mut page, quick);
    page
}

fn friction(page: &mut Page, quick: bool) {
    page.text(&format!(
        "
## Friction against velocity

$F_k$ for each rule of temperature and of ageing, compared with {SIZE} contacts followed one by one until steady sliding,
and with theory where there is a reference value: quadrature with 30 digits for the barriers, closed forms or a fine grid for ageing. Barriers
are those of one threshold 1 with k x̄²/2T = 20, *distributed* that of $P_c$ = G(1, 0.1) with 10; *logarithmic* has $P_c$ = G(1, 0.1),
β = 0.02, τ₀ = 1; the others mature from G(0.5, 0.1) to G(1, 0.05) in a time of 1. Velocities are in units of x̄ω or x̄ per
time 1. References of *mean_field* and *frozen_rank* ignore the 2.9e-7 of the fresh distribution below 0; *mean_field* is not a
rule for one contact and has no ensemble. ± is one standard error.
"
    ));
    page.head(&["rule", "v", "theory", "master equation", "ensemble", "deviation in errors"]);
    let mut drawn = Vec::new();
    for case in cases().iter().filter(|case| !quick || case.quick) {
        for &(velocity, theory) in &case.known {
            let exact = case.kinetic_friction(velocity);
            let cells = [case.name.into(), small(velocity), theory.into(), format!("{exact:.8}")];
            let compared = if case.drawn {
                let found = case.draw(velocity);
                drawn.push((velocity, found.force));
                let deviation = format!("{:.2}", (found.force - exact) / found.error);
                [format!("{:.5} ± {:.5}", found.force, found.error), deviation]
            } else {
                ["–".into(), "–".into()]
            };
            page.row(&cells.into_iter().chain(compared).collect::<Vec<_>>());
        }
    }
    page.end();
    let caption = "Kinetic friction against velocity: master equation (lines) and ensembles (dots). For thresholds as narrow as these, temperature makes friction increase with velocity, and ageing makes it decrease; with thresholds that diffuse it decreases again at low velocity.";
    page.picture("velocity", caption, picture(drawn, quick));
}

fn picture(drawn: Vec<(f64, f64)>, quick: bool) -> Scene {
    let points = if quick { 2 } else { 33 };
    let mut legend: Vec<LegendEntry> = Vec::new();
    let mut plots: style::Plots = Vec::new();
    for (i, case) in cases().iter().enumerate().filter(|(_, case)| !quick || case.quick) {
        let (low, high) = (case.known[0].0, case.known[case.known.len() - 1].0);
        let at = |k: i32| low * (high / low).powf(f64::from(k) / f64::from(points - 1));
        let curve = (0..points).map(|k| (at(k), case.kinetic_friction(at(k)))).collect();
        let dashes = if i < 4 { None } else { Some("8 4") };
        plots.push(line(curve, case.color, 1.6, dashes));
        legend.push(style::line(case.name.replace('_', " "), case.color, dashes));
    }
    plots.push(Plot::Scatter(ScatterPlot::new().with_data(drawn).with_color(BLACK).with_size(3.5)));
    legend.push(style::marker(format!("{SIZE} contacts"), BLACK, MarkerShape::Circle));
    let layout = style::layout((1e-10, 10.0), (0.0, 0.7))
        .with_log_x()
        .with_x_tick_format(style::powers((1e-10, 10.0)))
        .with_x_label("Velocity v")
        .with_y_label("Kinetic friction");
    placed(render_multiple(plots, layout), &legend, &[0])
}

fn varying(page: &mut Page, quick: bool) {
    page.text(&format!(
        "
## Velocities that vary

Cohorts of contacts that formed together, followed by `Transport` to {}, against {MANY} contacts one by one: a motion with velocity
steps to a tenth and to ten times, one with a hold, and one with alternate creep and slip at velocities a thousand times
apart. Deviations are in standard errors, at four times in each part of a motion. Those of one motion share contacts, and are
not independent.
",
        small(TOLERANCE)
    ));
    page.head(&[
        "rule",
        "motion",
        "times",
        "smallest error",
        "largest error",
        "mean square deviation",
        "largest",
    ]);
    for kind in ways::kinds().iter().filter(|kind| !quick || kind.name == "logarithmic") {
        compared(page, kind);
    }
    page.end();
}

fn compared(page: &mut Page, kind: &Kind) {
    for (way, history) in kind.ways() {
        let followed = kind.follow(&history, TOLERANCE, MANY);
        let Followed { times, error, .. } = &followed;
        let squares: Vec<f64> = followed.deviations().iter().map(|z| z * z).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let least = error.iter().copied().fold(f64::INFINITY, f64::min);
        page.row(&[
            kind.name.into(),
            way.into(),
            times.len().to_string(),
            small(least),
            small(largest(error)),
            format!("{mean:.2}"),
            format!("{:.2}", largest(&squares).sqrt()),
        ]);
    }
}
