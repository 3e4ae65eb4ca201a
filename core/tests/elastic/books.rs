//! Disordered interfaces: forces, energies, catalogues that stay the same.

use crate::common::curve::gaussian;
use crate::common::pulled::near;
use crate::common::sliders::{Impatient, events, interface, scales, setting};
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::{CellLoading, CellSlip, Coupling, Event, Interface, InterfaceParameters};
use asperity::shape::{Edges, Shape};

fn couplings() -> Vec<Box<dyn Coupling>> {
    let square = Shape::Square([5, 4]);
    vec![
        neighbours(Shape::Chain(20), Edges::Open, 4.0).unwrap(),
        neighbours(Shape::Chain(16), Edges::Periodic, 1.0).unwrap(),
        neighbours(square, Edges::Open, 1.0).unwrap(),
        half_space(square, Edges::Periodic, 1.0, 1.0).unwrap(),
        half_space(square, Edges::Open, 1.0, 1.0).unwrap(),
    ]
}

fn disordered(coupling: Box<dyn Coupling>, setting: InterfaceParameters) -> Interface {
    let scales = scales(coupling.shape().size(), 0.15);
    interface(&gaussian(0.1), Some(scales), coupling, setting)
}

/// The largest force out of balance, each term from what the interface shows.
fn excess(interface: &mut Interface, coupling: &mut dyn Coupling, connected: usize, connection: f64) -> f64 {
    let mut pulls = vec![0.0; interface.len()];
    coupling.forces(interface.positions(), &mut pulls, &mut ()).unwrap();
    let forces = interface.forces();
    let (drive, positions) = (interface.drive(), interface.positions());
    let spring = |j: usize| if j < connected { connection * (drive - positions[j]) } else { 0.0 };
    (0..forces.len()).map(|j| (spring(j) + pulls[j] - forces[j]).abs()).fold(0.0, f64::max)
}

/// Where cells come to rest that move slowly by what is out of balance, each no farther at a time than all springs together
/// and the stiffest slope would hold it.
fn crept(interface: &mut Interface, coupling: &mut dyn Coupling, drive: f64, connection: f64) -> Vec<f64> {
    let number = interface.len();
    let own = (0..number).map(|j| coupling.self_stiffness(j)).fold(0.0, f64::max);
    let (mut positions, mut pulls) = (vec![0.0; number], vec![0.0; number]);
    loop {
        interface.put(drive, &positions).unwrap();
        coupling.forces(&positions, &mut pulls, &mut ()).unwrap();
        let forces = interface.forces();
        let excess: Vec<f64> =
            (0..number).map(|j| connection * (drive - positions[j]) + pulls[j] - forces[j]).collect();
        if excess.iter().all(|excess| excess.abs() < 1e-10) {
            return positions;
        }
        for (x, excess) in positions.iter_mut().zip(&excess) {
            *x += excess.max(0.0) / (connection + 2.0 * own + 1.0);
        }
    }
}

/// However steps are chosen, in a slide or as slowly as can be, cells come to the nearest balance ahead.
#[test]
fn slides_end_in_the_nearest_balance() {
    let connection = 0.3;
    for drive in [2.5, 5.0] {
        for ((mut coupling, same), again) in couplings().into_iter().zip(couplings()).zip(couplings()) {
            let setting = setting(connection, CellSlip::Overdamped, 1e-6);
            let slow = crept(&mut disordered(same, setting), coupling.as_mut(), drive, connection);
            let mut fast = disordered(again, setting);
            fast.put(drive, &vec![0.0; slow.len()]).unwrap();
            fast.next(drive).unwrap();
            // Forces out of balance by 1e-10 hold cells back by that over a stiffness no less than 1e-3.
            fast.positions().iter().zip(&slow).for_each(|(fast, slow)| near(*fast, *slow, 1e-7));
        }
    }
}

#[test]
fn forces_and_energies_balance_after_every_event() {
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        for loading in [CellLoading::Uniform, CellLoading::Edge] {
            for (mut coupling, same) in couplings().into_iter().zip(couplings()) {
                let (connection, end) = if loading == CellLoading::Edge { (2.0, 9.0) } else { (0.3, 5.0) };
                let connected = match loading {
                    CellLoading::Edge => coupling.shape().first_row(),
                    _ => coupling.shape().size(),
                };
                let setting = InterfaceParameters { loading, ..setting(connection, slip, 1e-4) };
                let mut interface = disordered(same, setting);
                let mut number = 0;
                loop {
                    let found = interface.next(end).unwrap();
                    if found.is_empty() {
                        break;
                    }
                    number += found.len();
                    let excess = excess(&mut interface, coupling.as_mut(), connected, connection);
                    // Balances are found to rounding of forces of order 10 and their sums over the cells.
                    assert!(excess < 1e-10, "{excess:e} after event {number}");
                    near(interface.energy().imbalance(), 0.0, 1e-10 * interface.len() as f64);
                }
                let least = if slip == CellSlip::Reset { 1 } else { 4 };
                assert!(number >= least, "{number} events, {slip:?}, {loading:?}, {:?}", coupling.shape());
                let energy = interface.energy();
                assert!(energy.slip > 0.0 && energy.breaks > 0.0);
            }
        }
    }
}

/// What slips in a slide does not depend on how closely its drive is found, and is one piece: cells that are pushed along
/// are none of it, and creep next to where balance is lost is no slide.
#[test]
fn the_same_cells_slip_however_closely_drives_are_found() {
    let catalogue = |drive_tolerance: f64| {
        let slider = neighbours(Shape::Chain(30), Edges::Open, 4.0).unwrap();
        let setting = InterfaceParameters {
            loading: CellLoading::Edge,
            ..setting(0.5, CellSlip::Overdamped, drive_tolerance)
        };
        let mut chain = interface(&gaussian(0.1), Some(scales(30, 0.05)), slider, setting);
        events(&mut chain, 30.0)
    };
    let (crude, fine) = (catalogue(1e-6), catalogue(1e-8));
    assert!(fine.len() > 8, "{}", fine.len());
    assert_eq!(crude.len(), fine.len());
    for (crude, fine) in crude.iter().zip(&fine) {
        near(crude.drive, fine.drive, 1e-5);
        assert_eq!(crude.cells, fine.cells, "at {}", fine.drive);
        // Next to a fold positions change as the root of what is left of the drive.
        near(crude.moment, fine.moment, 0.05 * fine.moment);
    }
    let drives: Vec<f64> = fine.iter().map(|event| event.drive).collect();
    assert!(drives.windows(2).all(|pair| pair[1] > pair[0]), "{drives:?}");
}

/// Slips begin with the first cell of their event, also where several events have the same drive.
#[test]
fn slips_count_from_the_beginning_of_their_event() {
    let slider = neighbours(Shape::Chain(60), Edges::Open, 0.3).unwrap();
    let setting = InterfaceParameters { viscosity: Some(1.0), ..setting(0.3, CellSlip::Overdamped, 1e-2) };
    let mut chain = interface(&gaussian(0.05), Some(scales(60, 0.1)), slider, setting);
    let (mut drives, mut starts) = (Vec::new(), Vec::new());
    chain
        .run(6.0, &mut |event, slipped| {
            drives.push(event.drive);
            starts.push(slipped.iter().map(|cell| cell.start).fold(f64::INFINITY, f64::min));
        })
        .unwrap();
    assert!(drives.windows(2).any(|pair| pair[0] == pair[1]), "{drives:?}");
    assert!(starts.iter().all(|start| *start == 0.0), "{starts:?}");
}

/// Stiffer than K_c nothing slips, and the work of the drive is an integral that Simpson's rule knows to its fourth
/// order, here 1e-7.
#[test]
fn work_is_that_of_the_springs() {
    let coupling = neighbours(Shape::Chain(30), Edges::Open, 4.0).unwrap();
    let mut interface = disordered(coupling, setting(5.0, CellSlip::Overdamped, 1e-6));
    let (steps, mut work) = (400, 0.0);
    let step = 3.0 / f64::from(steps);
    for i in 0..=steps {
        assert!(events(&mut interface, f64::from(i) * step).is_empty());
        let weight = if i == 0 || i == steps { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        work += weight * step / 3.0 * interface.force();
    }
    near(interface.energy().work, work, 1e-6);
    near(interface.energy().slip, 0.0, 0.0);
    near(interface.energy().imbalance(), 0.0, 1e-9);
}

#[test]
fn an_interface_goes_on_from_its_state_bit_for_bit() {
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let new = || {
            let coupling = half_space(Shape::Square([6, 6]), Edges::Periodic, 1.0, 1.0).unwrap();
            disordered(coupling, setting(0.3, slip, 1e-4))
        };
        let mut whole = new();
        let all = events(&mut whole, 6.0);
        let (mut first, mut part) = (new(), Vec::new());
        while part.len() < all.len() / 2 {
            part.extend(first.next(6.0).unwrap().iter().map(|(event, _)| *event));
        }
        let state = first.state();
        drop(first);
        let mut second = new();
        second.restore(state, &mut ()).unwrap();
        part.extend(events(&mut second, 6.0));
        assert_eq!(written(&part), written(&all));
        assert_eq!(second.state(), whole.state());
    }
}

/// How far curves are known decides on steps, and later they are known further.
#[test]
fn an_interface_goes_back_to_a_state_of_its_own_bit_for_bit() {
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let coupling = neighbours(Shape::Chain(12), Edges::Open, 4.0).unwrap();
        let mut chain = disordered(coupling, setting(0.3, slip, 1e-4));
        events(&mut chain, 1.3);
        let state = chain.state();
        let found = events(&mut chain, 4.0);
        let end = chain.state();
        chain.restore(state.clone(), &mut ()).unwrap();
        assert_eq!(chain.state(), state);
        assert_eq!(written(&events(&mut chain, 4.0)), written(&found));
        assert_eq!(chain.state(), end);
    }
}

/// Stopped in slides, too.
#[test]
fn a_stop_leaves_no_trace() {
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let new = || {
            let coupling = neighbours(Shape::Chain(12), Edges::Open, 4.0).unwrap();
            disordered(coupling, setting(0.3, slip, 1e-4))
        };
        let mut whole = new();
        let all = events(&mut whole, 4.0);
        let (mut stopped, mut found, mut stops) = (new(), Vec::new(), 0);
        loop {
            match stopped.run_with(4.0, &mut Impatient(2 + stops), &mut |event, _| found.push(*event)) {
                Ok(()) => break,
                Err(asperity::Error::Stopped) => stops += 1,
                Err(error) => panic!("{error}"),
            }
            let state = stopped.state();
            stopped = new();
            stopped.restore(state, &mut ()).unwrap();
        }
        assert!(stops > 5, "{stops} stops");
        assert_eq!(written(&found), written(&all));
        assert_eq!(stopped.state(), whole.state());
    }
}

/// What a file would hold: events hold NaN where there is no time.
fn written(events: &[Event]) -> Vec<String> {
    events.iter().map(|event| format!("{event:?}")).collect()
}

#[test]
fn catalogues_are_the_same_on_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let coupling = neighbours(Shape::Square([66, 66]), Edges::Periodic, 1.0).unwrap();
            let mut interface = disordered(coupling, setting(1.0, CellSlip::Reset, 1e-3));
            let events = events(&mut interface, 1.75);
            assert!(!events.is_empty());
            (written(&events), interface.state())
        })
    };
    let (one, two) = (run(1), run(2));
    assert!(one == two, "{} events and {}", one.0.len(), two.0.len());
}
