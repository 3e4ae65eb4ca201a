//! Interfaces with a mass: waves against the modes of a chain, one cell against the block, fronts against overdamped ones.

use std::f64::consts::PI;
use std::sync::LazyLock;

use crate::common::pulled::near;
use crate::common::{contacts, gaussian, initial, master, point};
use asperity::block::{self, Block, Drive, Loading};
use asperity::contacts::{Ageing, Contacts, Rules};
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::rate_dependent::Scaled;
use asperity::elastic::{
    CellLoading, CellSlip, Coupling, Curves, Event, Interface, InterfaceParameters, RateDependentInterface,
    RateDependentInterfaceParameters, Slipped,
};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::master::{MasterPopulation, Transport};
use asperity::rate_dependent::{PopulationInTime, RateDependentContacts};
use asperity::shape::{Edges, Shape};

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

/// Athermal contacts of stiffness 1 that follow the master equation, solved once for all cells.
static SOLVED: LazyLock<MasterPopulation> = LazyLock::new(|| solved(1.0, 1e-8));

/// The same, all lengths of which are `scale` times as large.
fn athermal(scale: f64) -> Box<dyn RateDependentContacts> {
    let contacts = Box::new(PopulationInTime::new(Box::new(SOLVED.clone()), 1.0));
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
    let run = block.follow_with(contacts.as_ref(), &drive, &[], tolerance, &mut ()).unwrap();
    let setting = setting(stiffness, mass, viscosity, tolerance);
    let mut cell = RateDependentInterface::new(vec![contacts], chain(1, 1.0), setting).unwrap();
    let slip = &run.slips[0];
    let events = driven(&mut cell, slip.after.drive, velocity);
    assert_eq!(events.len(), 1);
    // Both stop at the same place, from where the block is moved back on its unloading line while the cell stands.
    near(events[0].drive, slip.before.drive, tolerance);
    near(cell.positions()[0], slip.position_turn, 3.0 * tolerance);
    assert_eq!(cell.velocities()[0], 0.0);
    // Where it stands friction is what balances the spring, which has lost K times the slip but for what the load point moved.
    let (event, bears) = (events[0], |x: f64, drive: f64| stiffness * (drive - x));
    near(cell.force(), bears(cell.positions()[0], cell.drive()), 1e-12);
    near(event.force_after, bears(event.position_after, event.drive + velocity * event.duration), tolerance);
    near(event.force_before, slip.before.force, tolerance);
    // The block is behind by the way back on its unloading line, over which springs and contacts share what is too much.
    assert!(event.drop() > slip.drop(), "{} {}", event.drop(), slip.drop());
    let energy = cell.energy();
    // The error of the steps, whose tolerance is 1e-4 of a mean threshold, over the whole drive.
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

#[test]
fn a_cell_of_single_contacts_moves_as_one_that_follows_the_master_equation() {
    let size = 10_000;
    let rests = |contacts| {
        let setting = setting(1.0, 1.0, 0.3, 1e-4);
        let mut cell = RateDependentInterface::new(vec![contacts], chain(1, 1.0), setting).unwrap();
        driven(&mut cell, 1.75, 1e-3);
        cell.positions()[0]
    };
    // The drive at the slip scatters as N^{−2/3}, the force as N^{−1/2} at most: four of these.
    near(rests(followed(size, 0)), rests(athermal(1.0)), 4.0 / (size as f64).sqrt());
}

/// K_int of chains with fronts.
const STIFFNESS: f64 = 25.0;
const CONNECTION: f64 = 0.2;
const VISCOSITY: f64 = 1.0;
/// Of the drive.
const VELOCITY: f64 = 2e-4;

/// Scale factors of a chain with so many weak cells at one end.
fn weak_end(cells: usize, weak: usize) -> Vec<f64> {
    (0..cells).map(|j| if j < weak { 0.7 } else { 1.0 }).collect()
}

fn cells(scales: &[f64]) -> Vec<Box<dyn RateDependentContacts>> {
    scales.iter().map(|&scale| athermal(scale)).collect()
}

/// The drive and the speed, in cells per time, of the overdamped front that starts at the weak end of a chain; the fewer cells
/// are weak, the higher the force on the others when slip begins.
fn overdamped(scales: &[f64]) -> (f64, f64) {
    let curves = Curves::new(&*SOLVED, scales.len()).unwrap().scaled(scales.to_vec()).unwrap();
    let setting = InterfaceParameters {
        slip: CellSlip::Overdamped,
        viscosity: Some(VISCOSITY),
        ..InterfaceParameters::new(CONNECTION, 1e-3)
    };
    let mut interface = Interface::new(Box::new(curves), chain(scales.len(), STIFFNESS), setting).unwrap();
    let mut catalogue: Vec<Event> = Vec::new();
    loop {
        interface.run(interface.drive() + 0.1, &mut |event, _| catalogue.push(*event)).unwrap();
        if let Some(event) = catalogue.iter().find(|event| event.cells == scales.len()) {
            return (event.drive, event.front_speed_right);
        }
    }
}

/// The speed of the same front with a mass, and its drive.
fn inertial(scales: &[f64], mass: f64, until: f64) -> (f64, f64) {
    let setting = setting(CONNECTION, mass, VISCOSITY, 1e-4);
    let coupling = chain(scales.len(), STIFFNESS);
    let mut interface = RateDependentInterface::new(cells(scales), coupling, setting).unwrap();
    let events = driven(&mut interface, until, VELOCITY);
    let energy = interface.energy();
    // Steps are right to 1e-4, times forces of the order of 1 in a hundred cells.
    assert!(energy.imbalance().abs() < 1e-3 * energy.work, "{energy:?}");
    let front = events.iter().find(|event| event.cells == scales.len()).unwrap();
    (front.drive, front.front_speed_right)
}

#[test]
fn fronts_with_a_mass_are_overdamped_ones_contracted_by_the_speed_of_waves() {
    // A front X(ξ = j − vt) on a chain, as a continuum, obeys (K − Mv²)X'' + ηvX' + f − F = 0. With lengths contracted by
    // √(1 − v²/c²), c² = K/M, this is the equation without mass of a front of the speed u = v/√(1 − v²/c²). Here u comes from the
    // solver of quasistatic interfaces, which shares the curve F(X) alone.
    let mut before = 0.0;
    // Of a mass of 1 both fronts are contracted, the faster one more.
    for (weak, masses) in [(12, [1.0, 16.0].as_slice()), (3, &[1.0])] {
        let scales = weak_end(100, weak);
        let (drive, slow) = overdamped(&scales);
        assert!(slow > before, "fronts are the faster the higher the force before them");
        before = slow;
        for &mass in masses {
            let (at, front) = inertial(&scales, mass, drive + 0.1);
            let waves = (STIFFNESS / mass).sqrt();
            let contracted = slow / (1.0 + (slow / waves).powi(2)).sqrt();
            assert!(front < waves);
            if mass < 10.0 {
                // The drive goes on as slip begins, which makes all fronts faster by some per cent.
                near(front / contracted, 1.0, 0.03);
                // Cells linger where balance is lost, while the drive goes on by some (ηv)^{2/3}.
                near(at, drive, 2.0 * (VISCOSITY * VELOCITY).powf(2.0 / 3.0));
            } else {
                // It is contracted to a width of two cells, at which a chain is no continuum, and what swings since the weak
                // cells slipped sets it off 1 % earlier.
                near(front / contracted, 1.0, 0.15);
            }
        }
    }
}

/// Ruptures of a chain whose cells differ in strength. A mass that drag outweighs changes nothing, and where cells swing to rest
/// each rupture is one event all the same: it ends when they are at rest.
#[test]
fn a_rupture_is_one_event_with_a_mass_and_without() {
    let scales: Vec<f64> = (0..12).map(|j| 1.0 + 0.1 * (2.4 * f64::from(j)).sin()).collect();
    let ruptures = |mass: f64, viscosity: f64| {
        let setting = setting(0.3, mass, viscosity, 1e-4);
        let mut interface = RateDependentInterface::new(cells(&scales), chain(12, 10.0), setting).unwrap();
        driven(&mut interface, 7.0, 1e-4)
    };
    let massless = ruptures(0.0, 2.0);
    assert!(massless.len() > 2);
    let light = ruptures(1e-3, 2.0);
    assert_eq!(light.len(), massless.len());
    for (found, expected) in light.iter().zip(&massless) {
        // √(M/K) = 0.02 beside η/K = 1, and cells that only follow others are not counted.
        near(found.drive, expected.drive, 1e-3);
        near(found.drop(), expected.drop(), 1e-2);
        let share = found.moment / expected.moment;
        assert!(found.cells <= expected.cells && share <= 1.01, "{found:?} {expected:?}");
        // The velocity at which a cell begins to slip leaves a hundredth of the moment open.
        assert!(share > if found.cells == expected.cells { 0.99 } else { 0.6 }, "{found:?} {expected:?}");
    }
    // Damped by η/2√(MK) < 0.1. An overshoot is in the moment, and what is stored less is made up for later.
    let swinging = ruptures(0.25, 0.15);
    assert!((2..=massless.len()).contains(&swinging.len()), "{}", swinging.len());
    for event in &swinging {
        assert!(event.drop() > 0.0, "{event:?}");
    }
    // Until the first rupture nothing moves fast.
    near(swinging[0].drive, massless[0].drive, 1e-2);
    assert!(swinging[0].drop() > massless[0].drop());
}

#[test]
fn an_edge_drives_precursors_that_stop() {
    let (number, mass) = (30, 0.04);
    let scales: Vec<f64> = (0..number).map(|j| 1.0 + 0.08 * f64::from(7 * j * j).sin()).collect();
    let edge =
        RateDependentInterfaceParameters { loading: CellLoading::Edge, ..setting(0.5, mass, 0.05, 1e-3) };
    let mut interface = RateDependentInterface::new(cells(&scales), chain(30, 4.0), edge).unwrap();
    let (mut ends, mut events) = (Vec::new(), Vec::new());
    let mut each = |event: &Event, slipped: &[Slipped]| {
        events.push(*event);
        ends.extend(slipped.iter().map(|own| own.cell).max());
    };
    interface.run(40.0, 1e-3, &mut each).unwrap();
    // Each stops inside the chain, and later ones reach farther.
    let third = events.len() / 3;
    let farthest = |range: std::ops::Range<usize>| ends[range].iter().copied().max();
    assert!(events.len() > 10 && ends.iter().all(|end| *end < 29));
    assert!(farthest(0..third) < farthest(2 * third..ends.len()));
    // Waves of √(K/M) = 10 cells per time.
    let speeds = events.iter().flat_map(|event| [event.front_speed_left, event.front_speed_right]);
    assert!(speeds.filter(|speed| speed.is_finite()).all(|speed| speed < 10.0));
    let energy = interface.energy();
    assert!(energy.imbalance().abs() < 1e-4 * energy.work, "{energy:?}");
}

#[test]
fn a_sheet_of_equal_rows_is_a_chain_and_all_continue_from_their_states() {
    let scales = weak_end(24, 6);
    let rows: Vec<f64> = scales.iter().chain(&scales).chain(&scales).copied().collect();
    let ring = || neighbours(Shape::Chain(24), Edges::Periodic, STIFFNESS).unwrap();
    let sheet = neighbours(Shape::Square([3, 24]), Edges::Periodic, STIFFNESS).unwrap();
    let setting = setting(CONNECTION, 0.25, 0.2, 1e-4);
    let make =
        |scales: &[f64], coupling| RateDependentInterface::new(cells(scales), coupling, setting).unwrap();
    let mut one = make(&scales, ring());
    let mut three = make(&rows, sheet);
    driven(&mut one, 4.3, 1e-2);
    driven(&mut three, 4.3, 1e-2);
    let (chain, sheet) = (one.positions(), three.positions());
    assert!(chain.iter().any(|x| *x > 1.0));
    // Other iterations solve the stages, within a hundredth of the tolerance in each of some hundred.
    for (j, x) in sheet.iter().enumerate() {
        near(*x, chain[j % 24], 1e-4);
    }
    let mut resumed = make(&scales, ring());
    resumed.restore(one.state()).unwrap();
    assert_eq!(resumed.velocities(), one.velocities());
    assert!(one.velocities().iter().any(|v| *v < 0.0), "none swings back");
    for interface in [&mut one, &mut resumed] {
        driven(interface, 4.5, 1e-2);
    }
    assert_eq!(resumed.positions(), one.positions());
    assert_eq!(resumed.energy(), one.energy());
}

#[test]
fn the_energy_closes_on_a_half_space_whose_waves_are_damped() {
    let scales = weak_end(32, 8);
    let coupling = half_space(Shape::Chain(32), Edges::Open, 5.0, 1.0).unwrap();
    let mut interface =
        RateDependentInterface::new(cells(&scales), coupling, setting(CONNECTION, 0.5, 0.3, 1e-4)).unwrap();
    let events = driven(&mut interface, 4.5, 1e-3);
    let energy = interface.energy();
    assert!(!events.is_empty() && energy.slip > 0.0 && energy.breaks > 1.0, "{energy:?}");
    // The error of the steps, whose tolerance is 1e-4 of a mean threshold, over the whole drive.
    assert!(energy.imbalance().abs() < 1e-3 * energy.work, "{energy:?}");
}
