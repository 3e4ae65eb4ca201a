//! Interfaces with a mass: waves against the modes of a chain, one cell against the block, fronts, energy.

mod common;

use std::f64::consts::PI;

use asperity::block::{self, Block, Drive, Loading};
use asperity::contacts::{Ageing, Contacts, Rules};
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::{CellLoading, Coupling, Event, RateDependentInterface, RateDependentInterfaceParameters};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::master::Transport;
use asperity::rate_dependent::{PopulationInTime, RateDependentContacts};
use asperity::shape::{Edges, Shape};
use common::pulled::near;
use common::{contacts, gaussian, initial, master, point};

fn setting(mass: f64, tolerance: f64) -> RateDependentInterfaceParameters {
    RateDependentInterfaceParameters { mass, ..RateDependentInterfaceParameters::new(1.0, 0.0, tolerance) }
}

fn chain(cells: usize, stiffness: f64) -> Box<dyn Coupling> {
    neighbours(Shape::Chain(cells), Edges::Open, stiffness).unwrap()
}

/// Athermal contacts that follow the master equation, with thresholds of this mean.
fn athermal(mean: f64, tolerance: f64) -> Box<dyn RateDependentContacts> {
    let population = master(&gaussian(mean, 0.1 * mean), &point(0.0), &point(0.0));
    Box::new(PopulationInTime::new(Box::new(population.population_with(tolerance, &mut ()).unwrap()), 1.0))
}

/// Athermal contacts of an ensemble, the first one of this number.
fn ensemble(size: usize, first: u64) -> Box<dyn RateDependentContacts> {
    let start = initial(&point(0.0));
    let own = Ensemble::new(contacts(&gaussian(1.0, 0.1), &point(0.0)), start, size, 1, Disorder::Annealed);
    Box::new(PopulationInTime::new(Box::new(own.unwrap().numbered_from(first).population().unwrap()), 1.0))
}

fn logarithmic(tolerance: f64) -> Box<dyn RateDependentContacts> {
    let ageing = Some(Ageing::Logarithmic { growth: 0.02, time: 1.0 });
    let rules = Rules { ageing, ..Rules::default() };
    let contacts = Contacts { rules, ..contacts(&gaussian(1.0, 0.2), &point(0.0)) };
    Box::new(Transport::new_with(contacts, &initial(&point(0.0)), tolerance, &mut ()).unwrap())
}

fn repeated(cell: &dyn RateDependentContacts, number: usize) -> Vec<Box<dyn RateDependentContacts>> {
    (0..number).map(|_| cell.copy()).collect()
}

/// Contacts that hold on for ever: a chain of such cells is linear. Their stiffness is far below that of the springs.
fn springs(number: usize, stiffness: f64) -> Vec<Box<dyn RateDependentContacts>> {
    let population = master(&gaussian(1e3, 1.0), &point(0.0), &point(0.0)).population().unwrap();
    let cell = PopulationInTime::new(Box::new(population), 1.0);
    let _ = stiffness;
    repeated(&cell, number)
}

/// A chain of `n` cells, contacts of stiffness 1 that do not break, pulled at its first cell by a spring as stiff as those
/// between cells, K. The load point moves at V from t = 0. In its frame the chain starts at −V and ends there at rest at a
/// wall: the modes sin(q(j + 1)), q = (2m − 1)π/(2n + 1), have the frequencies ω² = [1 + 4K sin²(q/2)]/M, the dispersion
/// relation, and contacts pull with the force −Vt in this frame.
fn modes(n: usize, stiffness: f64, mass: f64, velocity: f64, time: f64) -> Vec<f64> {
    let mode = |m: usize| (2 * m - 1) as f64 * PI / (2 * n + 1) as f64;
    let position = |j: usize| {
        let part = |m: usize| {
            let q = mode(m);
            let shape = |j: usize| (q * (j + 1) as f64).sin();
            let norm: f64 = (0..n).map(|j| shape(j) * shape(j)).sum();
            // Coefficient of a displacement that is the same in all cells.
            let all: f64 = (0..n).map(shape).sum::<f64>() / norm;
            let omega = ((1.0 + 4.0 * stiffness * (0.5 * q).sin().powi(2)) / mass).sqrt();
            // M Ẍ = −Mω² X + K V t s_0, from rest: X = (K V s_0/(norm Mω²)) (t − sin(ωt)/ω).
            let push = stiffness * velocity * shape(0) / norm;
            let _ = all;
            shape(j) * push / (mass * omega * omega) * (time - (omega * time).sin() / omega)
        };
        (1..=n).map(part).sum::<f64>()
    };
    (0..n).map(position).collect()
}

#[test]
fn a_pulse_travels_as_the_modes_of_the_chain_say() {
    let (n, stiffness, mass, velocity) = (40, 25.0, 0.25, 1.0);
    let edge = |tolerance| RateDependentInterfaceParameters {
        connection: stiffness,
        loading: CellLoading::Edge,
        ..setting(mass, tolerance)
    };
    let off = |tolerance: f64| {
        let (cells, springs) = (springs(n, 1.0), chain(n, stiffness));
        let mut chain = RateDependentInterface::new(cells, springs, edge(tolerance)).unwrap();
        let mut worst = 0.0_f64;
        for time in [1.0, 2.0, 3.0] {
            chain.run(velocity * time, velocity, &mut |_, _| ()).unwrap();
            let expected = modes(n, stiffness, mass, velocity, time);
            let apart = chain.positions().iter().zip(&expected).map(|(a, b)| (a - b).abs());
            worst = apart.fold(worst, f64::max);
            // The front is at c t, with c = √(K/M) = 10 cells per time; beyond it the chain rests but for the
            // Airy tail of the dispersion, which has decayed after three of its widths (n/24)^{1/3} < 2 cells.
            let front = (10.0 * time) as usize + 6;
            assert!(chain.velocities()[front.min(n)..].iter().all(|v| v.abs() < 1e-2 * velocity));
        }
        let energy = chain.energy();
        // TR-BDF2 damps waves by errors of the order of the tolerance per step.
        assert!(energy.imbalance().abs() < 1e-2 * energy.work, "{energy:?}");
        assert!(energy.kinetic > 0.1 * energy.work && energy.slip == 0.0 && energy.breaks == 0.0);
        worst
    };
    let [rough, fine] = [1e-4, 1e-5].map(off);
    println!("{rough:e} {fine:e}");
    assert!(rough < 0.02 && fine < 0.3 * rough, "{rough} {fine}");
}

#[test]
fn one_cell_in_time_is_the_block() {
    let (stiffness, mass, viscosity, velocity, way, tolerance) = (0.2, 0.5, 0.05, 1e-2, 12.0, 1e-4);
    let contacts = logarithmic(0.1 * tolerance);
    let drive = History::new(vec![Piece { velocity, duration: way / velocity }]).unwrap();
    let slip = block::Slip::Inertial { mass, damping: viscosity };
    let block = Block::new(Loading::Spring(stiffness), slip, None).unwrap();
    let run = block.follow(contacts.as_ref(), &drive, &[], tolerance).unwrap();
    let parameters = RateDependentInterfaceParameters { connection: stiffness, viscosity, ..setting(mass, tolerance) };
    let mut interface = RateDependentInterface::new(vec![contacts], chain(1, 1.0), parameters).unwrap();
    let mut events: Vec<Event> = Vec::new();
    interface.run(way, velocity, &mut |event, _| events.push(*event)).unwrap();
    println!("{} {}", events.len(), run.slips.len());
    let (event, slip) = (&events[0], &run.slips[0]);
    println!("{event:?}\n{slip:?}");
    // Until it stops for the first time. Then the block is moved back on its unloading line, while the cell stands.
    near(event.position_after, slip.after.position, 30.0 * tolerance);
}

#[test]
fn one_athermal_cell_is_the_block_along_its_drive() {
    let (stiffness, mass, viscosity, velocity, tolerance) = (1.0, 1.0, 0.3, 1e-4, 1e-5);
    let slip = block::Slip::Inertial { mass, damping: viscosity };
    let block = Block::new(Loading::Spring(stiffness), slip, None).unwrap();
    let equation = master(&gaussian(1.0, 0.1), &point(0.0), &point(0.0));
    let mut population = equation.population().unwrap();
    let run = block.pull(&mut population, &Drive::to(2.5)).unwrap();
    let parameters = RateDependentInterfaceParameters { connection: stiffness, viscosity, ..setting(mass, tolerance) };
    let cell = athermal(1.0, 1e-8);
    let mut interface = RateDependentInterface::new(vec![cell], chain(1, 1.0), parameters).unwrap();
    let mut events: Vec<Event> = Vec::new();
    interface.run(2.5, velocity, &mut |event, _| events.push(*event)).unwrap();
    println!("{events:?}");
    println!("{:?}", run.events.iter().map(|e| (e.before.drive, e.after.position)).collect::<Vec<_>>());
    println!("{:?} {:?}", interface.energy(), interface.energy().imbalance());
}

#[test]
fn fronts_are_slower_than_waves() {
    let (n, stiffness, mass) = (60, 25.0, 0.25);
    for (name, viscosity, size) in [("few", 0.25, Some(200)), ("many", 0.25, None)] {
        let begun = std::time::Instant::now();
        let cells: Vec<_> = match size {
            Some(size) => (0..n).map(|j| ensemble(size, (j * size) as u64)).collect(),
            None => repeated(athermal(1.0, 1e-6).as_ref(), n),
        };
        let parameters = RateDependentInterfaceParameters {
            connection: 5.0,
            loading: CellLoading::Edge,
            viscosity,
            slip_fraction: 0.05,
            ..setting(mass, 1e-3)
        };
        let mut interface = RateDependentInterface::new(cells, chain(n, stiffness), parameters).unwrap();
        let mut events: Vec<Event> = Vec::new();
        interface.run(8.0, 0.02, &mut |event, _| events.push(*event)).unwrap();
        for event in &events {
            println!("{name} X_T {:.3} t {:.3} cells {} speed {:.3} of 10", event.drive, event.duration, event.cells, event.front_speed_right);
        }
        println!("{name} {:?} {:?} {:?}", interface.energy(), interface.energy().imbalance(), begun.elapsed());
    }
}

#[test]
fn a_half_space_damps_by_radiation() {
    let coupling = half_space(Shape::Chain(8), Edges::Open, 1.0, 1.0).unwrap();
    drop(coupling);
}
