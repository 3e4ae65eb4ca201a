//! The solver against closed forms.

use std::sync::Arc;

use asperity::exact::{self, ClosedForm, Erlang, Gaussian, Identical, Rectangular};
use asperity::law::{Exponential, Gamma, Mixture, SharedLaw};

use crate::page::{Page, below, small};
use crate::{gaussian, grid, master, point, rectangular};

const LAST: f64 = 20.0;
const TOLERANCE: f64 = 1e-12;

pub fn section(mut page: Page) -> Page {
    page.text(&format!(
        "
## Closed forms

R = $Q_\\mathrm{{ini}}$ = δ, tolerance {}: the largest deviation of F for X ≤ {LAST}, and of the total probability ∫Q dx from 1,
which is computed by a separate quadrature. The closed forms share no code with the solver. The form for Gaussian
thresholds keeps their mass below 0, the solver truncates it: for σ/x̄ ≥ 0.15 the deviation is the effect of that mass.
",
        small(TOLERANCE)
    ));
    page.head(&["thresholds", "mass below 0", "∣F − closed form∣", "∣∫Q − 1∣"]);
    for (cv, beyond) in
        [(0.02, "0"), (0.05, "3e-89"), (0.1, "8e-24"), (0.15, "1.3e-11"), (0.2, "2.9e-7"), (0.3, "4.3e-4")]
    {
        let form = Gaussian::new(1.0, cv);
        row(&mut page, &format!("Gaussian, σ = {cv}"), beyond, &gaussian(1.0, cv), |x| form.force(x));
    }
    for half in [0.1, 0.25, 0.5, 1.0] {
        let form = Rectangular { min: 1.0 - half, max: 1.0 + half };
        row(
            &mut page,
            &format!("rectangular, 1 ± {half}"),
            "–",
            &rectangular(1.0 - half, 1.0 + half),
            |x| form.force(x),
        );
    }
    let exponential: SharedLaw = Arc::new(Exponential::new(1.0).expect("a mean above 0"));
    row(&mut page, "exponential", "–", &exponential, |x| Erlang::with_mean(1, 1.0).force(x));
    for shape in [2, 4, 16, 100] {
        let form = Erlang::with_mean(shape, 1.0);
        let gamma = Gamma::new(1.0, 1.0 / f64::from(shape).sqrt()).expect("a mean and a std above 0");
        row(&mut page, &format!("Erlang, shape {shape}"), "–", &(Arc::new(gamma) as SharedLaw), |x| {
            form.force(x)
        });
    }
    for std in [0.3, 0.7, 1.2] {
        let gamma = Gamma::new(1.0, std).expect("a mean and a std above 0");
        let form = exact::Gamma { mean: 1.0, std };
        let name = format!("gamma, σ = {std}");
        row(&mut page, &name, "–", &(Arc::new(gamma) as SharedLaw), |x| form.force(x));
    }
    row(&mut page, "identical, 1", "–", &point(1.0), |x| Identical { threshold: 1.0 }.force(x));
    let two = Mixture::new(vec![(0.5, point(1.0)), (0.5, point(2.0))]).expect("weights whose sum is 1");
    row(
        &mut page,
        "1 and 2, one half each: oscillates for ever",
        "–",
        &(Arc::new(two) as SharedLaw),
        commensurate,
    );
    page.end();
    page
}

fn row(page: &mut Page, name: &str, beyond: &str, law: &SharedLaw, exact: impl Fn(f64) -> f64) {
    let pull =
        master(law, &point(0.0)).pull_with(LAST, TOLERANCE, &mut ()).expect("the tolerance is reached");
    // Jumps are at whole numbers: none is a position.
    let positions = || grid(LAST - 0.01, 0.01).into_iter().map(|x| x + 0.005);
    let force = positions().map(|x| (pull.force(x) - exact(x)).abs()).fold(0.0, f64::max);
    let lost = positions().map(|x| (pull.total_probability(x) - 1.0).abs()).fold(0.0, f64::max);
    page.row(&[name.into(), beyond.into(), below(force), below(lost)]);
}

/// F for thresholds 1 and 2 of weight one half: a contact breaks at n with u_n = (u_{n−1} + u_{n−2})/2.
fn commensurate(position: f64) -> f64 {
    let (mut before, mut breaks) = (0.0, 1.0);
    let mut force = 0.0;
    for n in 0..=position.floor() as usize {
        let stretch = position - n as f64;
        let survival = if stretch < 1.0 {
            1.0
        } else if stretch < 2.0 {
            0.5
        } else {
            0.0
        };
        force += breaks * stretch * survival;
        (before, breaks) = (breaks, 0.5 * (breaks + before));
    }
    force
}
