//! Cells of few contacts each: one is a block over its ensemble, and many on a rigid slider are one over all of them.

use crate::common::pulled::{near, pull};
use crate::common::sliders::{Impatient, events, setting};
use crate::common::{contacts, gaussian, initial, point, rectangular};
use asperity::block::{self, StickSlip};
use asperity::contacts::Contacts;
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::{CellSlip, Cells, Coupling, Event, Interface, Populations};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::population::Population;
use asperity::rate_dependent::binned;
use asperity::shape::{Edges, Shape};

/// Contacts number `first`, …, which stand for `count`.
fn ensemble(size: usize, first: usize, count: f64, disorder: Disorder) -> Box<dyn Population> {
    let one = contacts(&gaussian(1.0, 0.1), &rectangular(0.0, 0.3));
    let many = Contacts { count, ..one };
    let ensemble = Ensemble::new(many, initial(&point(0.0)), size, 3, disorder).unwrap();
    Box::new(ensemble.numbered_from(first as u64).population().unwrap())
}

/// Cells of so many annealed contacts of total stiffness 1.
fn cells(number: usize, size: usize) -> Populations {
    let cell = |j: usize| ensemble(size, j * size, 1.0, Disorder::Annealed);
    Populations::new((0..number).map(cell).collect(), &mut ()).unwrap()
}

fn chain(cells: Populations, number: usize, stiffness: f64, slip: CellSlip, tolerance: f64) -> Interface {
    let coupling = neighbours(Shape::Chain(number), Edges::Open, stiffness).unwrap();
    Interface::new(Box::new(cells), coupling, setting(0.5, slip, tolerance)).unwrap()
}

#[track_caller]
fn same(events: &[Event], slips: &StickSlip, accuracy: f64) {
    assert_eq!(events.len(), slips.events.len());
    for (event, slip) in events.iter().zip(&slips.events) {
        near(event.drive, slip.before.drive, accuracy);
        near(event.position_before, slip.before.position, accuracy);
        near(event.position_after, slip.after.position, accuracy);
        near(event.force_before, slip.before.force, accuracy);
        near(event.force_after, slip.after.force, accuracy);
        near(event.broken_fraction, slip.broken_fraction, accuracy);
        near(event.dissipated_breaks, slip.energy.breaks, accuracy);
        near(event.dissipated_slip, slip.energy.slip, accuracy);
    }
}

/// Every break is an event. Where the drive is found to 1e-12, so is what happens there.
#[test]
fn one_cell_is_a_block_over_its_ensemble() {
    let rules = [(CellSlip::Overdamped, block::Slip::Overdamped), (CellSlip::Reset, block::Slip::Reset)];
    for (slip, of_block) in rules {
        for disorder in [Disorder::Annealed, Disorder::Quenched] {
            let mut population = ensemble(20, 0, 1.0, disorder);
            let slips = pull(population.as_mut(), 0.5, of_block, &[8.0]);
            assert!(slips.events.len() > if slip == CellSlip::Reset { 2 } else { 30 });
            let cell = Populations::new(vec![ensemble(20, 0, 1.0, disorder)], &mut ()).unwrap();
            let mut cell = chain(cell, 1, 1.0, slip, 1e-12);
            same(&events(&mut cell, 8.0), &slips, 1e-10);
            near(cell.energy().imbalance(), 0.0, 1e-10);
        }
    }
}

/// Slides, each as its drive, the force after it and the contacts that have broken by then.
fn slides(interface: &mut Interface, drive: f64) -> Vec<[f64; 3]> {
    let mut slides = Vec::new();
    while !interface.next(drive).unwrap().is_empty() {
        slides.push([interface.drive(), interface.force(), interface.broken()]);
    }
    slides
}

/// Cells part by what pulls one over the others, 0.1/K_int at most and as often as there are cells between them.
#[test]
fn few_contacts_in_each_of_many_rigid_cells_are_one_ensemble() {
    let (number, size, stiffness) = (8, 5, 1e6);
    let whole = number as f64;
    let mut population = ensemble(number * size, 0, whole, Disorder::Annealed);
    let slips = pull(population.as_mut(), 0.5 * whole, block::Slip::Overdamped, &[6.0]);
    let mut rigid = chain(cells(number, size), number, stiffness, CellSlip::Overdamped, 1e-9);
    let found = slides(&mut rigid, 6.0);
    assert!(found.len() == slips.events.len() && found.len() > 50, "{}, {}", found.len(), slips.events.len());
    let accuracy = 0.1 * whole * whole / stiffness;
    let mut broken = 0.0;
    for ([drive, force, broken_by_then], slip) in found.iter().zip(&slips.events) {
        broken += slip.broken_fraction;
        near(*drive, slip.before.drive, accuracy);
        near(*force, slip.after.force, whole * accuracy);
        near(*broken_by_then, broken, 1e-12);
    }
    near(rigid.energy().imbalance(), 0.0, 1e-10 * whole);
}

/// Soft cells that differ in scale, too.
fn soft(slip: CellSlip) -> Interface {
    let coupling = half_space(Shape::Square([5, 4]), Edges::Open, 0.3, 1.0).unwrap();
    let scales: Vec<f64> = (0..20).map(|j| 1.0 + 0.1 * f64::sin(f64::from(j * j))).collect();
    let cells = cells(20, 6).scaled(&scales).unwrap();
    Interface::new(Box::new(cells), coupling as Box<dyn Coupling>, setting(0.3, slip, 1e-5)).unwrap()
}

/// What a file would hold: events hold NaN where there is no time.
fn written(events: &[Event]) -> Vec<String> {
    events.iter().map(|event| format!("{event:?}")).collect()
}

#[test]
fn energies_balance_after_every_event() {
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let mut interface = soft(slip);
        while !interface.next(8.0).unwrap().is_empty() {
            // Sums over some thousand breaks of contacts, each rounded.
            near(interface.energy().imbalance(), 0.0, 1e-10);
        }
        assert!(interface.broken() > 2.0);
    }
}

#[test]
fn catalogues_are_the_same_on_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut interface = soft(CellSlip::Overdamped);
            (written(&events(&mut interface, 8.0)), interface.state())
        })
    };
    let (one, three) = (run(1), run(3));
    assert!(one.0.len() > 100, "{}", one.0.len());
    assert!(one == three, "{} events and {}", one.0.len(), three.0.len());
}

#[test]
fn cells_go_on_from_their_state_bit_for_bit() {
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let mut whole = soft(slip);
        let all = events(&mut whole, 6.0);
        let (mut first, mut part) = (soft(slip), Vec::new());
        while part.len() < all.len() / 2 {
            part.extend(first.next(6.0).unwrap().iter().map(|(event, _)| *event));
        }
        let mut second = soft(slip);
        second.restore(first.state(), &mut ()).unwrap();
        part.extend(events(&mut second, 6.0));
        assert_eq!(written(&part), written(&all));
        assert_eq!(second.state(), whole.state());
    }
}

#[test]
fn what_was_stopped_goes_on_as_if_it_had_not_been() {
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let mut whole = soft(slip);
        let all = events(&mut whole, 4.0);
        let (mut interface, mut found, mut patience) = (soft(slip), Vec::new(), 2);
        loop {
            match interface.run_with(4.0, &mut Impatient(patience), &mut |event, _| found.push(*event)) {
                Ok(()) => break,
                Err(asperity::Error::Stopped) => patience += 1,
                Err(error) => panic!("{error}"),
            }
        }
        assert_eq!(written(&found), written(&all));
        assert_eq!(interface.state(), whole.state());
    }
}

/// Forces are those of curves, stretches those of contacts.
#[test]
fn stretches_of_the_contacts_of_a_cell_add_up_to_its_force() {
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let scaled = cells(3, 40).scaled(&[1.0, 0.8, 1.3]).unwrap();
        let mut chain = chain(scaled, 3, 0.5, slip, 1e-6);
        for drive in [0.0, 1.5, 4.0] {
            chain.run(drive, &mut |_, _| ()).unwrap();
            let forces = chain.forces();
            for (cell, force) in forces.into_iter().enumerate() {
                let contacts = chain.stretches(cell).unwrap().unwrap();
                assert_eq!(contacts.len(), 40);
                let carried: f64 = contacts.iter().map(|contact| contact.fraction * contact.low).sum();
                near(carried, force, 1e-12);
                let counted: f64 = binned(&contacts, &[0.0, 1.0, 3.0])
                    .unwrap()
                    .iter()
                    .zip([1.0, 2.0])
                    .map(|(q, dx)| q * dx)
                    .sum();
                near(counted, 1.0, 1e-12);
            }
        }
        let error = chain.stretches(3).unwrap_err().to_string();
        assert!(error.starts_with("cell: expected a number below 3"), "{error}");
    }
}

/// How far curves are known decides on steps.
#[test]
fn what_is_recalled_knows_no_more_than_at_the_mark() {
    let curves = || asperity::elastic::Curves::new(&*ensemble(4, 0, 1.0, Disorder::Annealed), 3);
    let made: [&dyn Fn() -> Box<dyn Cells>; 2] = [&|| Box::new(cells(3, 4)), &|| Box::new(curves().unwrap())];
    for new in made {
        let mut twins = [new(), new()];
        for cells in &mut twins {
            cells.advance(&[0.3, 0.5, 0.7], &mut ()).unwrap();
            cells.mark();
        }
        let [recalled, other] = &mut twins;
        recalled.advance(&[7.0, 0.1, 5.0], &mut ()).unwrap();
        recalled.detach(1, 0.0, &mut ()).unwrap();
        recalled.recall(&mut ()).unwrap();
        let known =
            |cells: &dyn Cells| (cells.state(), cells.extremes().steepest, cells.extremes().strongest);
        assert_eq!(known(&**recalled), known(&**other));
        for cells in &mut twins {
            cells.residual(&[1.5, 0.1, 2.0], &mut [0.0; 3], &mut [0.0; 3], &mut ()).unwrap();
        }
        let [recalled, other] = &twins;
        assert_eq!(known(&**recalled), known(&**other));
    }
}

#[test]
fn cells_refuse_states_and_scales_of_others() {
    let error = cells(3, 4).scaled(&[1.0, 0.0, 1.0]).err().unwrap().to_string();
    assert!(error.contains("0 for cell 1"), "{error}");
    let state = chain(cells(2, 4), 2, 1.0, CellSlip::Reset, 1e-6).state();
    let curves = || asperity::elastic::Curves::new(&*ensemble(4, 0, 1.0, Disorder::Annealed), 2).unwrap();
    let coupling = neighbours(Shape::Chain(2), Edges::Open, 1.0).unwrap();
    let mut other =
        Interface::new(Box::new(curves()), coupling, setting(0.5, CellSlip::Reset, 1e-6)).unwrap();
    let error = other.restore(state, &mut ()).unwrap_err().to_string();
    assert!(error.starts_with("state: "), "{error}");
}
