//! Cells on an elastic slider: how they answer to a force, how fast fronts are, whether books balance.

use std::f64::consts::PI;

use asperity::elastic::cells::scales;
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::{CellLoading, CellSlip, Coupling, Curves, Interface, InterfaceParameters, Slipped};
use asperity::exact::{ClosedForm, Gaussian};
use asperity::law::critical_coupling;
use asperity::numerics::legendre::RULE;
use asperity::numerics::roots::brent_root;
use asperity::shape::{Edges, Shape};

use crate::page::Page;
use crate::{gaussian, master, point};

/// Stiffness of a chain, force above that of equal areas, and the speed in cells per time that an independent
/// integration gives: 0 where the front stays.
const FRONTS: [(f64, f64, f64); 7] = [
    (25.0, -0.01, 0.0),
    (25.0, 0.01, 0.2085),
    (25.0, 0.03, 0.629),
    (25.0, 0.08, 1.702),
    (1.0, 0.03, 0.0),
    (1.0, 0.08, 0.219),
    (0.25, 0.08, 0.0),
];

const OVERDAMPED: InterfaceParameters = InterfaceParameters {
    connection: 0.5,
    loading: CellLoading::Uniform,
    slip: CellSlip::Overdamped,
    viscosity: None,
    drive_tolerance: 1e-6,
    area: None,
};

/// Gaussian thresholds of σ = 0.1.
fn cells(number: usize) -> Curves {
    let population = master(&gaussian(1.0, 0.1), &point(0.0))
        .population_with(1e-10, &mut ())
        .expect("a tolerance that is kept");
    Curves::new(&population, number).expect("nothing stops it")
}

pub fn section(page: Page) -> Page {
    books(speeds(responses(criticals(page))))
}

fn criticals(mut page: Page) -> Page {
    page.text(
        "
## Interfaces that deform

Cells of many contacts on a deformable slider ([theory](../theory.md#space)), with contacts that start and
re-form at stretch 0. Identical cells under uniform loading move as one slider on a spring of stiffness K each, which is
stable above K_c of the master equation. In mean field a break stretches all others by the fraction κ = 1/(1 + K), and κ_c
is the largest value without a slip, as long as contacts break for the first time (at σ = 0.2 some break again).
",
    );
    page.head(&["σ", "κ_c", "1/κ_c − 1", "K_c"]);
    for std in [0.05, 0.1, 0.2] {
        let thresholds = gaussian(1.0, std);
        let critical = critical_coupling(thresholds.as_ref());
        let pull = master(&thresholds, &point(0.0)).pull_with(3.0, 1e-10, &mut ()).expect("nothing stops it");
        page.row(&[
            std.to_string(),
            format!("{critical:.6}"),
            format!("{:.6}", critical.recip() - 1.0),
            format!("{:.6}", pull.critical_stiffness()),
        ]);
    }
    page.end();
    page
}

fn responses(mut page: Page) -> Page {
    page.text(
        "
The displacement of a cell at a distance of r cells from a cell with the force 1, all held by springs k: on a chain of 401
cells, and on a half-space of 512 × 512 with periodic edges, compared with the theory of [coupling](../theory.md#elastic-coupling) for
infinite ones. The half-space is a lattice of cells, which matters at small r, and finite, which matters at large r.
",
    );
    page.head(&["coupling", "k", "length", "r", "response", "theory"]);
    for (stiffness, spring) in [(1.0, 1.0), (25.0, 1.0)] {
        let xi = 0.5 / (0.5 * f64::sqrt(spring / stiffness)).asinh();
        let mut chain = neighbours(Shape::Chain(401), Edges::Open, stiffness).expect("a chain");
        let answer = pushed(chain.as_mut(), 200, spring);
        for r in [1, 4, 16] {
            // Each cell takes its share of the force: ΣX = 1/k.
            let top = (0.5 / xi).tanh() / spring;
            let theory = top * (-(r as f64) / xi).exp();
            let name = format!("neighbours, K_int = {stiffness}");
            page.row(&response(&name, spring, xi, r, answer[200 + r], theory));
        }
    }
    for (modulus, spring) in [(1.0, 1.0), (20.0, 1.0)] {
        let mut plane =
            half_space(Shape::Square([512; 2]), Edges::Periodic, modulus, 1.0).expect("a half-space");
        let answer = pushed(plane.as_mut(), 256 * 512 + 256, spring);
        for r in [4, 16, 64] {
            let theory = on_half_space(r as f64, modulus, spring);
            let name = format!("half-space, G* = {modulus}");
            page.row(&response(&name, spring, modulus / spring, r, answer[256 * 512 + 256 + r], theory));
        }
    }
    page.end();
    page
}

fn response(coupling: &str, spring: f64, length: f64, r: usize, found: f64, theory: f64) -> Vec<String> {
    let numbers = [format!("{length:.3}"), r.to_string(), format!("{found:.4e}"), format!("{theory:.4e}")];
    [coupling.to_owned(), spring.to_string()].into_iter().chain(numbers).collect()
}

/// Where all cells go when one is pushed by a force of 1.
fn pushed(coupling: &mut dyn Coupling, cell: usize, spring: f64) -> Vec<f64> {
    let mut answer = vec![0.0; coupling.shape().size()];
    answer[cell] = 1.0;
    coupling.solve_uniform(spring, &mut answer, &mut ()).expect("no monitor stops it");
    answer
}

/// (1/2πG*r) [1 − ρ ∫₀^∞ e^{−ρ sinh u} du], ρ = r k/G*.
fn on_half_space(r: f64, modulus: f64, spring: f64) -> f64 {
    let ratio = r * spring / modulus;
    let (end, panels) = ((40.0 / ratio).asinh(), 64);
    let edge = |i: i32| end * f64::from(i) / f64::from(panels);
    let part = |i| RULE.integrate(edge(i), edge(i + 1), |u| (-ratio * u.sinh()).exp());
    (1.0 - ratio * (0..panels).map(part).sum::<f64>()) / (2.0 * PI * modulus * r)
}

fn speeds(mut page: Page) -> Page {
    page.text(
        "
Fronts on overdamped chains (σ = 0.1, η = 1): each cell is under a constant force f, 40 of 160 cells are one generation
of contacts ahead, and slip spreads where f exceeds f_M = 0.51, the force of equal areas. Speeds in cells per time, between
the 20th and the 60th cell reached, 0 where fewer are. The reference is an independent integration, accurate to 1 %.
",
    );
    page.head(&["K_int", "f − f_M", "speed", "reference"]);
    for (stiffness, above, reference) in FRONTS {
        let found = speed(stiffness, above);
        page.row(&[
            stiffness.to_string(),
            above.to_string(),
            format!("{found:.4}"),
            format!("{reference:.4}"),
        ]);
    }
    page.end();
    page
}

/// Cells per time at which slip spreads.
fn speed(stiffness: f64, above: f64) -> f64 {
    // So soft that the pull of the drive is a constant force.
    const SOFT: f64 = 1e-7;
    let (force, ahead, number) = (0.51 + above, 40, 160);
    let setting = InterfaceParameters { connection: SOFT, viscosity: Some(1.0), ..OVERDAMPED };
    let coupling = neighbours(Shape::Chain(number), Edges::Open, stiffness).expect("a chain");
    let mut chain = Interface::new(Box::new(cells(number)), coupling, setting).expect("cells for each");
    let curve = Gaussian::new(1.0, 0.1);
    let place = |low, high| {
        brent_root(|x| curve.force(x) - force, low, high, 1e-12).expect("a branch on which the force rises")
    };
    let (front, rest) = (place(1.25, 1.7), place(0.0, 0.84));
    let positions: Vec<f64> = (0..number).map(|j| if j < ahead { front } else { rest }).collect();
    chain.put(force / SOFT, &positions).expect("places ahead");
    let mut starts = vec![f64::NAN; number];
    let mut log = |slipped: &[Slipped]| slipped.iter().for_each(|s| starts[s.cell] = s.start);
    chain.run(force / SOFT, &mut |_, slipped| log(slipped)).expect("nothing stops it");
    let time = starts[ahead + 60] - starts[ahead + 20];
    if time.is_nan() { 0.0 } else { 40.0 / time }
}

fn books(mut page: Page) -> Page {
    page.text(
        "
Disordered chains (24 cells, K_int = 4, K_0 = 0.3, scale factors with σ_s = 0.1), driven to X_T = 4. After each event every
cell is in equilibrium, and the energy is balanced. The table shows the largest residual force on a cell, and the largest
imbalance of the energies per cell.
",
    );
    page.head(&["slip", "events", "residual force", "energy imbalance"]);
    for (name, slip) in [("overdamped", CellSlip::Overdamped), ("reset", CellSlip::Reset)] {
        let (events, force, energy) = balance(slip);
        let within =
            |value: f64| if value < 1e-10 { "below 1e-10".to_owned() } else { format!("{value:.0e}") };
        page.row(&[name.to_owned(), events.to_string(), within(force), within(energy)]);
    }
    page.end();
    page.text(
        "
Tests check further results: one cell, and cells on a rigid slider, move as a block does; weakening patches become unstable
at the nucleation length, to 2 %; catalogues do not depend on the number of threads, nor on stopping and resuming a
run.
",
    );
    page
}

/// Events, the largest force out of balance after one, and the largest difference of energies, per cell.
fn balance(slip: CellSlip) -> (usize, f64, f64) {
    const NUMBER: usize = 24;
    let setting = InterfaceParameters { connection: 0.3, slip, ..OVERDAMPED };
    let coupling = || neighbours(Shape::Chain(NUMBER), Edges::Open, 4.0).expect("a chain");
    let scales = scales(NUMBER, 0.1, 1).expect("scales above 0");
    let cells = cells(NUMBER).scaled(scales).expect("a scale for each");
    let mut chain = Interface::new(Box::new(cells), coupling(), setting).expect("cells for each");
    let (mut count, mut force, mut energy) = (0, 0.0_f64, 0.0_f64);
    loop {
        let events = chain.next(4.0).expect("nothing stops it");
        if events.is_empty() {
            return (count, force, energy / NUMBER as f64);
        }
        count += events.len();
        energy = energy.max(chain.energy().imbalance().abs());
        let (friction, positions) = (chain.forces(), chain.positions());
        let mut pulls = [0.0; NUMBER];
        coupling().forces(positions, &mut pulls, &mut ()).expect("no monitor stops it");
        let spring = |j: usize| setting.connection * (chain.drive() - positions[j]);
        force = (0..NUMBER).map(|j| (spring(j) + pulls[j] - friction[j]).abs()).fold(force, f64::max);
    }
}
