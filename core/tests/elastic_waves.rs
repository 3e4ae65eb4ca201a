//! Interfaces with a mass: waves against the modes of a chain, one cell against the block, fronts against overdamped ones.

mod common;

use std::f64::consts::PI;

use asperity::block::{self, Block, Drive, Loading};
use asperity::contacts::{Ageing, Contacts, Rules};
use asperity::elastic::coupling::neighbours;
use asperity::elastic::rate_dependent::Scaled;
use asperity::elastic::{
    CellLoading, CellSlip, Coupling, Curves, Event, Interface, InterfaceParameters, RateDependentInterface,
    RateDependentInterfaceParameters,
};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::master::{MasterPopulation, Transport};
use asperity::rate_dependent::{PopulationInTime, RateDependentContacts};
use asperity::shape::{Edges, Shape};
use common::pulled::near;
use common::{contacts, gaussian, initial, master, point};

fn chain(cells: usize, stiffness: f64) -> Box<dyn Coupling> {
    neighbours(Shape::Chain(cells), Edges::Open, stiffness).unwrap()
}

fn setting(connection: f64, mass: f64, viscosity: f64, tolerance: f64) -> RateDependentInterfaceParameters {
    let massless = RateDependentInterfaceParameters::new(connection, viscosity, tolerance);
    RateDependentInterfaceParameters { mass, ..massless }
}

fn solved(mean: f64, tolerance: f64) -> MasterPopulation {
    let equation = master(&gaussian(mean, 0.1 * mean), &point(0.0), &point(0.0));
    equation.population_with(tolerance, &mut ()).unwrap()
}

/// Athermal contacts of stiffness 1 that follow the master equation, all lengths of which are `scale` times as large.
fn athermal(scale: f64) -> Box<dyn RateDependentContacts> {
    let contacts = Box::new(PopulationInTime::new(Box::new(solved(1.0, 1e-8)), 1.0));
    Box::new(Scaled::new(contacts, scale).unwrap())
}

/// Athermal contacts one by one, the first one of this number.
fn followed(size: usize, first: u64) -> Box<dyn RateDependentContacts> {
    let start = initial(&point(0.0));
    let own = Ensemble::new(contacts(&gaussian(1.0, 0.1), &point(0.0)), start, size, 1, Disorder::Annealed);
    Box::new(PopulationInTime::new(Box::new(own.unwrap().numbered_from(first).population().unwrap()), 1.0))
}

fn ageing(growth: f64, tolerance: f64) -> Box<dyn RateDependentContacts> {
    let rules = Rules { ageing: Some(Ageing::Logarithmic { growth, time: 1.0 }), ..Rules::default() };
    let contacts = Contacts { rules, ..contacts(&gaussian(1.0, 0.1), &point(0.0)) };
    Box::new(Transport::new_with(contacts, &initial(&point(0.0)), tolerance, &mut ()).unwrap())
}

fn repeated(cell: &dyn RateDependentContacts, number: usize) -> Vec<Box<dyn RateDependentContacts>> {
    (0..number).map(|_| cell.copy()).collect()
}

fn driven(interface: &mut RateDependentInterface, drive: f64, velocity: f64) -> Vec<Event> {
    let mut events = Vec::new();
    interface.run(drive, velocity, &mut |event, _| events.push(*event)).unwrap();
    events
}

/// Positions in a chain of `n` cells on contacts of stiffness 1 that do not break, whose first cell is pulled by a spring as
/// stiff as those between cells, K, from rest, by a load point of velocity V. The modes sin(q(j + 1)), q = (2m − 1)π/(2n + 1),
/// have the frequencies ω² = [1 + 4K sin²(q/2)]/M: the dispersion relation. The force KVt on the first cell moves each by
/// KV s_0/(Mω² Σs²) [t − sin(ωt)/ω].
fn modes(n: usize, stiffness: f64, mass: f64, velocity: f64, time: f64) -> Vec<f64> {
    let mut positions = vec![0.0; n];
    for m in 1..=n {
        let q = (2 * m - 1) as f64 * PI / (2 * n + 1) as f64;
        let shape = |j: usize| (q * (j + 1) as f64).sin();
        let norm: f64 = (0..n).map(|j| shape(j) * shape(j)).sum();
        let square = (1.0 + 4.0 * stiffness * (0.5 * q).sin().powi(2)) / mass;
        let omega = square.sqrt();
        let moved = stiffness * velocity * shape(0) / (norm * mass * square);
        let part = moved * (time - (omega * time).sin() / omega);
        positions.iter_mut().enumerate().for_each(|(j, x)| *x += part * shape(j));
    }
    positions
}

#[test]
fn a_pulse_travels_as_the_modes_of_the_chain_say() {
    let (n, stiffness, mass, velocity) = (40, 25.0, 0.25, 1.0);
    let off = |tolerance: f64| {
        let edge = RateDependentInterfaceParameters {
            loading: CellLoading::Edge,
            ..setting(stiffness, mass, 0.0, tolerance)
        };
        // Thresholds of 1000 are never reached.
        let contacts = PopulationInTime::new(Box::new(solved(1e3, 1e-6)), 1.0);
        let mut found =
            RateDependentInterface::new(repeated(&contacts, n), chain(n, stiffness), edge).unwrap();
        let mut worst = 0.0_f64;
        for time in [1.0, 2.0, 3.0] {
            driven(&mut found, velocity * time, velocity);
            let expected = modes(n, stiffness, mass, velocity, time);
            let positions = found.positions();
            let apart = positions.iter().zip(&expected).map(|(a, b)| (a - b).abs());
            worst = apart.fold(worst, f64::max);
            // Ahead of c t, c = √(K/M) = 10 cells per time, dispersion lets waves reach some (ct)^{1/3} ≈ 3 cells.
            let ahead = (10.0 * time) as usize + 6;
            assert!(found.velocities()[ahead.min(n)..].iter().all(|v| v.abs() < 1e-2 * velocity));
        }
        let energy = found.energy();
        // Breaks are found to the accuracy of the contacts.
        assert!(energy.kinetic > 0.0 && energy.breaks < 1e-6 && energy.slip == 0.0, "{energy:?}");
        (worst, (energy.imbalance() / energy.work).abs())
    };
    let [(rough, drift), (fine, small)] = [1e-4, 1e-6].map(off);
    println!("positions {rough:e} {fine:e}, energy {drift:e} {small:e}");
    // A step is wrong by the tolerance, and errors of a method of second order add up to the power 2/3 of it.
    assert!(rough < 2e-2 && fine < rough / 10.0, "{rough:e} {fine:e}");
    // The method damps waves of periods near the step; no energy enters.
    assert!(drift < 1e-2 && small < drift / 10.0, "{drift:e} {small:e}");
}

#[test]
fn one_cell_over_ageing_contacts_is_the_block_in_time() {
    let (stiffness, mass, viscosity, velocity, way, tolerance) = (0.2, 0.5, 0.1, 1e-2, 8.0, 1e-4);
    let contacts = ageing(0.02, 0.1 * tolerance);
    let drive = History::new(vec![Piece { velocity, duration: way / velocity }]).unwrap();
    let slip = block::Slip::Inertial { mass, damping: viscosity };
    let block = Block::new(Loading::Spring(stiffness), slip, None).unwrap();
    let run = block.follow(contacts.as_ref(), &drive, &[], tolerance).unwrap();
    let setting = setting(stiffness, mass, viscosity, tolerance);
    let mut cell = RateDependentInterface::new(vec![contacts], chain(1, 1.0), setting).unwrap();
    let slip = &run.slips[0];
    let events = driven(&mut cell, slip.after.drive, velocity);
    assert_eq!(events.len(), 1);
    let energy = [events[0].dissipated_breaks, slip.energy.breaks];
    println!(
        "{} {} {} {energy:?}",
        events[0].drive - slip.before.drive,
        cell.positions()[0],
        slip.position_turn
    );
    // Both stop at the same place, from where the block is moved back on its unloading line while the cell stands.
    near(events[0].drive, slip.before.drive, tolerance);
    near(cell.positions()[0], slip.position_turn, 3.0 * tolerance);
    assert_eq!(cell.velocities()[0], 0.0);
    let energy = cell.energy();
    assert!(energy.imbalance().abs() < 1e-3 * energy.work, "{energy:?}");
}

#[test]
fn one_cell_over_athermal_contacts_is_the_block_along_its_drive() {
    let (stiffness, mass, viscosity, tolerance) = (1.0, 1.0, 0.3, 1e-5);
    let slip = block::Slip::Inertial { mass, damping: viscosity };
    let block = Block::new(Loading::Spring(stiffness), slip, None).unwrap();
    let mut population = solved(1.0, 1e-10);
    let run = block.pull(&mut population, &Drive::to(2.0)).unwrap();
    let slip = &run.events[0];
    let parameters = setting(stiffness, mass, viscosity, tolerance);
    let mut cell = RateDependentInterface::new(vec![athermal(1.0)], chain(1, 1.0), parameters).unwrap();
    // Slowly to the slip, which begins later by some v^{2/3}, and until its swings have died out.
    let events = driven(&mut cell, slip.before.drive + 0.1, 1e-4);
    println!("{events:?} {slip:?}");
    assert_eq!(events.len(), 1);
    near(events[0].drive, slip.before.drive, 5e-3);
    near(events[0].dissipated_breaks, slip.energy.breaks, 5e-3);
    // It rests where the block rests, moved on by the drive since: K/(K + N⟨k⟩) of its way, as contacts reload on a straight line.
    let since = cell.drive() - slip.before.drive;
    near(cell.positions()[0], slip.after.position + 0.5 * since, 5e-3);
    let energy = cell.energy();
    assert!(energy.imbalance().abs() < 1e-3 * energy.work, "{energy:?}");
    assert!(energy.kinetic.abs() < 1e-5, "{energy:?}");
}

/// Speeds, in cells per time, of the front that starts at the weak end of a chain: overdamped, and with these masses. The more
/// cells are weak, the lower the force on the others when slip begins, which is returned, too.
fn speeds(weak: usize, viscosity: f64, masses: &[f64]) -> (f64, f64, Vec<f64>) {
    const CELLS: usize = 100;
    const CONNECTION: f64 = 0.2;
    let scales: Vec<f64> = (0..CELLS).map(|j| if j < weak { 0.7 } else { 1.0 }).collect();
    let curves = Curves::new(&solved(1.0, 1e-8), CELLS).unwrap().scaled(scales.clone()).unwrap();
    let athermal_setting = InterfaceParameters {
        slip: CellSlip::Overdamped,
        viscosity: Some(viscosity),
        ..InterfaceParameters::new(CONNECTION, 1e-3)
    };
    let mut overdamped = Interface::new(Box::new(curves), chain(CELLS, STIFFNESS), athermal_setting).unwrap();
    let large = |events: &[Event]| events.iter().copied().find(|event| event.cells == CELLS);
    let mut catalogue: Vec<Event> = Vec::new();
    while large(&catalogue).is_none() {
        let next = overdamped.drive() + 0.1;
        overdamped.run(next, &mut |event, _| catalogue.push(*event)).unwrap();
    }
    let first = large(&catalogue).unwrap();
    let with_mass = |mass: &f64| {
        let cells = scales.iter().map(|&scale| athermal(scale)).collect();
        let setting = setting(CONNECTION, *mass, viscosity, 1e-4);
        let mut interface = RateDependentInterface::new(cells, chain(CELLS, STIFFNESS), setting).unwrap();
        let events = driven(&mut interface, first.drive + 0.1, 2e-4);
        let energy = interface.energy();
        assert!(energy.imbalance().abs() < 1e-3 * energy.work, "{energy:?}");
        println!(
            "{weak} {mass} {:?}",
            events.iter().map(|e| (e.drive, e.cells, e.front_speed_right)).collect::<Vec<_>>()
        );
        large(&events).map_or(f64::NAN, |event| event.front_speed_right)
    };
    (first.force_before / CELLS as f64, first.front_speed_right, masses.iter().map(with_mass).collect())
}

const STIFFNESS: f64 = 25.0;

#[test]
fn fronts_with_a_mass_are_overdamped_ones_contracted_by_the_speed_of_waves() {
    let mut before = 0.0;
    for weak in [20, 12, 6, 3] {
        let masses = [0.05, 0.25, 1.0];
        let begun = std::time::Instant::now();
        let (stress, slow, fronts) = speeds(weak, 1.0, &masses);
        for (mass, front) in masses.iter().zip(&fronts) {
            let waves = (STIFFNESS / mass).sqrt();
            let contracted = slow / (1.0 + (slow / waves).powi(2)).sqrt();
            println!(
                "{weak} stress {stress:.3} overdamped {slow:.3} waves {waves:.3}: {front:.3}, expected {contracted:.3} {:?}",
                begun.elapsed()
            );
        }
        let _ = before;
        before = slow;
    }
}

#[test]
fn an_edge_drives_precursors_that_stop_and_fronts_slower_than_waves() {
    let (cells, stiffness, mass) = (30, 4.0, 0.04);
    for name in ["followed", "master", "ageing"] {
        let scale = |j: usize| 1.0 + 0.08 * ((7 * j * j) as f64).sin();
        let scaled = |cell: Box<dyn RateDependentContacts>, j: usize| -> Box<dyn RateDependentContacts> {
            Box::new(Scaled::new(cell, scale(j)).unwrap())
        };
        let contacts: Vec<_> = (0..cells)
            .map(|j| match name {
                "followed" => followed(200, (200 * j) as u64),
                "master" => athermal(scale(j)),
                _ => scaled(ageing(0.05, 1e-4), j),
            })
            .collect();
        let begun = std::time::Instant::now();
        let edge =
            RateDependentInterfaceParameters { loading: CellLoading::Edge, ..setting(0.5, mass, 0.05, 1e-3) };
        let mut interface = RateDependentInterface::new(contacts, chain(cells, stiffness), edge).unwrap();
        let events = driven(&mut interface, 60.0, 1e-3);
        let energy = interface.energy();
        for event in events.iter().filter(|e| e.cells > 4).take(12) {
            println!(
                "{name} X_T {:.3} cells {} at {} speed {:.3} {:.3}",
                event.drive, event.cells, event.epicentre, event.front_speed_left, event.front_speed_right
            );
        }
        println!(
            "{name} {} events {:e} of {:?} {:?}",
            events.len(),
            energy.imbalance(),
            energy,
            begun.elapsed()
        );
    }
}
