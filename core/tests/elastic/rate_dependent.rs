//! An interface whose contacts are time-dependent: against the block in time, the athermal interface and the ensemble.

use crate::common::pulled::near;
use crate::common::{contacts, gaussian, initial, master, point};
use asperity::block::{self, Block, Slide};
use asperity::contacts::{Ageing, Barrier, Contacts, Rules, Stiffness, Temperature};
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::rate_dependent::Scaled;
use asperity::elastic::{
    CellLoading, CellSlip, Coupling, Curves, Event, Interface, InterfaceParameters, RateDependentInterface,
    RateDependentInterfaceParameters,
};
use asperity::energy::ContactEnergies;
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::master::Transport;
use asperity::monitor::Monitor;
use asperity::rate_dependent::{ContactsState, RateDependentContacts, StretchInterval};
use asperity::shape::{Edges, Shape};
use asperity::{Error, Result};

/// Of a step of a cell, as a length.
const TOLERANCE: f64 = 1e-4;

fn of(rules: Rules, std: f64) -> Contacts {
    Contacts { rules, ..contacts(&gaussian(1.0, std), &point(0.0)) }
}

fn athermal() -> Contacts {
    of(Rules::default(), 0.1)
}

fn logarithmic() -> Contacts {
    let ageing = Ageing::Logarithmic { growth: 0.02, time: 1.0 };
    of(Rules { ageing: Some(ageing), ..Rules::default() }, 0.2)
}

fn transport(contacts: &Contacts, tolerance: f64) -> Box<dyn RateDependentContacts> {
    Box::new(Transport::new_with(contacts.clone(), &initial(&point(0.0)), tolerance, &mut ()).unwrap())
}

/// Cells whose contacts are these, of such scales.
fn cells(contacts: &Contacts, scales: &[f64], tolerance: f64) -> Vec<Box<dyn RateDependentContacts>> {
    let cell = |&scale: &f64| -> Box<dyn RateDependentContacts> {
        Box::new(Scaled::new(transport(contacts, tolerance), scale).unwrap())
    };
    scales.iter().map(cell).collect()
}

fn chain(cells: usize, stiffness: f64) -> Box<dyn Coupling> {
    neighbours(Shape::Chain(cells), Edges::Open, stiffness).unwrap()
}

fn setting(connection: f64, viscosity: f64, tolerance: f64) -> RateDependentInterfaceParameters {
    let loading = CellLoading::Uniform;
    RateDependentInterfaceParameters {
        connection,
        loading,
        mass: 0.0,
        viscosity,
        tolerance,
        slip_fraction: 0.0,
        area: None,
    }
}

fn events(interface: &mut RateDependentInterface, drive: f64, velocity: f64) -> Vec<Event> {
    let mut events = Vec::new();
    interface.run(drive, velocity, &mut |event, _| events.push(*event)).unwrap();
    events
}

/// A slider block over these contacts, driven so far.
fn block(contacts: &dyn RateDependentContacts, stiffness: f64, damping: f64, way: (f64, f64)) -> Slide {
    let slip = block::Slip::Damped { damping };
    let drive = History::new(vec![Piece { velocity: way.1, duration: way.0 / way.1 }]).unwrap();
    let block = Block::new(block::Loading::Spring(stiffness), slip, None).unwrap();
    block.follow_with(contacts, &drive, &[], TOLERANCE, &mut ()).unwrap()
}

/// The events are the slips of a slider block, lengths to an accuracy.
fn are_the_slips(events: &[Event], run: &Slide, accuracy: f64) {
    assert!(run.slips.len() > 1 && events.len() == run.slips.len(), "{} {}", events.len(), run.slips.len());
    for (event, slip) in events.iter().zip(&run.slips) {
        // Forces change by less than the number of cells per length, energies by no more than forces.
        let energy = accuracy * slip.before.force.max(1.0);
        near(event.drive, slip.before.drive, accuracy);
        near(event.position_before, slip.before.position, accuracy);
        near(event.position_after, slip.after.position, accuracy);
        near(event.force_before, slip.before.force, energy);
        near(event.force_after, slip.after.force, energy);
        near(event.broken_fraction, slip.broken_fraction, accuracy);
        near(event.dissipated_breaks, slip.energy.breaks, energy);
        near(event.dissipated_slip, slip.energy.viscous, energy);
    }
}

#[test]
fn one_cell_is_the_block_in_time() {
    let contacts = transport(&logarithmic(), 0.1 * TOLERANCE);
    let run = block(contacts.as_ref(), 0.2, 0.1, (12.0, 1e-2));
    let mut interface =
        RateDependentInterface::new(vec![contacts], chain(1, 1.0), setting(0.2, 0.1, TOLERANCE)).unwrap();
    let events = events(&mut interface, 12.0, 1e-2);
    // Both make the same steps, and solve their equations to a hundredth of the tolerance.
    are_the_slips(&events, &run, TOLERANCE);
}

/// Contacts of several cells under one slider.
#[derive(Debug)]
struct Together(Vec<Box<dyn RateDependentContacts>>);

impl Together {
    fn sum(&self, of: impl Fn(&dyn RateDependentContacts) -> f64) -> f64 {
        self.0.iter().map(|contacts| of(contacts.as_ref())).sum()
    }
}

impl RateDependentContacts for Together {
    fn position(&self) -> f64 {
        self.0[0].position()
    }

    fn time(&self) -> f64 {
        self.0[0].time()
    }

    fn force(&self) -> f64 {
        self.sum(|contacts| contacts.force())
    }

    fn tangent(&self) -> f64 {
        self.sum(|contacts| contacts.tangent())
    }

    fn energies(&self) -> ContactEnergies {
        ContactEnergies {
            elastic: self.sum(|contacts| contacts.energies().elastic),
            lost: self.sum(|contacts| contacts.energies().lost),
            strengthening: self.sum(|contacts| contacts.energies().strengthening),
            sliding: self.sum(|contacts| contacts.energies().sliding),
            broken: self.sum(|contacts| contacts.energies().broken) / self.0.len() as f64,
        }
    }

    fn free(&self) -> f64 {
        self.sum(|contacts| contacts.free()) / self.0.len() as f64
    }

    fn stretches(&self) -> Vec<StretchInterval> {
        let part = |portion: StretchInterval| StretchInterval {
            fraction: portion.fraction / self.0.len() as f64,
            ..portion
        };
        self.0.iter().flat_map(|contacts| contacts.stretches()).map(part).collect()
    }

    fn step(&mut self, by: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.0.iter_mut().try_for_each(|contacts| contacts.step(by, during, monitor))
    }

    fn settle(&mut self) {
        self.0.iter_mut().for_each(|contacts| contacts.settle());
    }

    fn copy(&self) -> Box<dyn RateDependentContacts> {
        Box::new(Self(self.0.iter().map(|contacts| contacts.copy()).collect()))
    }

    fn state(&self) -> ContactsState {
        ContactsState::of(&self.0.iter().map(|contacts| contacts.state()).collect::<Vec<_>>())
    }

    fn restore(&mut self, state: &ContactsState) -> Result<()> {
        let kept: Vec<ContactsState> = state.read()?;
        self.0.iter_mut().zip(&kept).try_for_each(|(contacts, kept)| contacts.restore(kept))
    }
}

#[test]
fn rigidly_coupled_cells_are_one_block() {
    let scales = [0.9, 1.0, 1.1];
    let sides = || cells(&logarithmic(), &scales, 0.1 * TOLERANCE);
    let run = block(&Together(sides()), 3.0 * 0.2, 3.0 * 0.1, (12.0, 1e-2));
    // Cells differ in place by some 1e-6, as forces differ by less than 1.
    for coupling in [chain(3, 1e6), half_space(Shape::Chain(3), Edges::Open, 1e6, 1.0).unwrap()] {
        let mut interface =
            RateDependentInterface::new(sides(), coupling, setting(0.2, 0.1, TOLERANCE)).unwrap();
        let events = events(&mut interface, 12.0, 1e-2);
        assert!(events.iter().all(|event| event.cells == 3));
        are_the_slips(&events, &run, 3.0 * TOLERANCE);
        let positions = interface.positions();
        near(positions[0], positions[2], 1e-5);
    }
}

/// Scales of a chain that is weak at its first cells.
const WEAK: [f64; 6] = [0.8, 0.85, 0.95, 1.0, 1.05, 1.1];

/// Slides of an athermal interface as force before and after at a drive, the small ones left out.
fn slides(events: &[Event], least: f64) -> Vec<(f64, usize, [f64; 2])> {
    let mut slides: Vec<_> = events
        .iter()
        .map(|event| (event.drive, event.epicentre, [event.force_before, event.force_after]))
        .collect();
    slides.dedup_by_key(|slide| slide.0);
    slides.retain(|slide| slide.2[0] - slide.2[1] > least);
    slides
}

#[test]
fn slow_and_without_rules_it_is_the_athermal_interface() {
    let (stiffness, connection, viscosity, velocity, drive) = (0.5, 0.2, 1e-3, 1e-4, 5.8);
    let (scales, tolerance) = (&WEAK[..4], 3e-4);
    let relaxed = point(0.0);
    let population = master(&gaussian(1.0, 0.1), &relaxed, &relaxed).population_with(1e-10, &mut ()).unwrap();
    let curves = Curves::new(&population, scales.len()).unwrap();
    let athermal_setting = InterfaceParameters {
        connection,
        loading: CellLoading::Uniform,
        slip: CellSlip::Overdamped,
        viscosity: Some(viscosity),
        drive_tolerance: 1e-9,
        area: None,
    };
    let curves = Box::new(curves.scaled(scales.to_vec()).unwrap());
    let mut expected = Interface::new(curves, chain(scales.len(), stiffness), athermal_setting).unwrap();
    let mut catalogue = Vec::new();
    expected.run(drive, &mut |event, _| catalogue.push(*event)).unwrap();
    let (contacts, setting) =
        (cells(&athermal(), scales, tolerance), setting(connection, viscosity, tolerance));
    let mut found = RateDependentInterface::new(contacts, chain(scales.len(), stiffness), setting).unwrap();
    let [before, now] = [catalogue, events(&mut found, drive, velocity)].map(|events| slides(&events, 0.05));
    assert!(before.len() > 2 && now.len() == before.len(), "{before:?} {now:?}");
    for (now, before) in now.iter().zip(&before) {
        // Cells linger where balance is lost, while the drive goes on by some (ηv)^{2/3} = 2e-5; they are fast somewhat
        // earlier, where F' + K is a tenth of K: K/(10 F'') in place, times K in force, and F'' is some 2 here.
        near(now.0, before.0, 5e-4);
        assert_eq!(now.1, before.1, "{now:?} {before:?}");
        near(now.2[0], before.2[0], 2e-3);
        near(now.2[1], before.2[1], tolerance);
    }
    for (now, before) in found.positions().iter().zip(expected.positions()) {
        near(*now, *before, tolerance);
    }
    // Lingering costs a little, times the number of slides.
    let (now, before) = (found.energy(), expected.energy());
    near(now.work, before.work, tolerance);
    near(now.breaks, before.breaks, tolerance);
    near(now.slip, before.slip, tolerance);
}

#[test]
fn steps_are_of_second_order() {
    // In the middle of a slide; the error of a step goes with its third power, that of a way with the second: with the
    // tolerance to the power 2/3, within a tenth, as steps change by factors.
    let positions = |tolerance: f64| {
        let contacts = cells(&athermal(), &WEAK[..3], 1e-2 * tolerance);
        let mut interface =
            RateDependentInterface::new(contacts, chain(3, 0.5), setting(0.2, 0.3, tolerance)).unwrap();
        interface.run(4.0, 0.03, &mut |_, _| ()).unwrap();
        interface.positions()
    };
    let [rough, fine, finest] = [1e-2, 1e-3, 1e-5].map(positions);
    let off = |one: &[f64]| one.iter().zip(&finest).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    near((off(&rough) / off(&fine)).log10(), 2.0 / 3.0, 0.1);
}

#[test]
fn the_work_is_found_again() {
    let temperature = Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.05, 1.0) };
    let ageing = Some(Ageing::Logarithmic { growth: 0.05, time: 1.0 });
    let warm = Rules { temperature: Some(temperature), ..Rules::default() };
    let stiffening =
        Contacts { stiffness: Stiffness::PerThreshold(1.0), ..of(Rules { ageing, ..warm.clone() }, 0.2) };
    let cases = [
        ("logarithmic", 0.6, Contacts { reforming: gaussian(0.2, 0.05), ..logarithmic() }),
        ("delay", 0.4, of(Rules { delay: 2.0.into(), ..warm }, 0.2)),
        ("per threshold", 0.6, stiffening),
    ];
    let (scales, way, tolerance) = (&WEAK[2..4], 4.5, 1e-3);
    for (name, connection, contacts) in cases {
        let cells = cells(&contacts, scales, tolerance);
        let mut interface =
            RateDependentInterface::new(cells, chain(2, 0.5), setting(connection, 0.1, tolerance)).unwrap();
        let events = events(&mut interface, way, 1e-2);
        let energy = interface.energy();
        assert!(energy.breaks > 1.0 && !events.is_empty(), "{name}: {energy:?}");
        // Each step of a cell is right to the tolerance, times forces below 1; there are no more than its way has of it.
        assert!(energy.imbalance().abs() < 2.0 * tolerance * way, "{name}: {:e}", energy.imbalance());
        let slips: f64 = events.iter().map(|event| event.dissipated_slip).sum();
        assert!(slips > 0.0 && slips < energy.slip, "{name}: {slips} {energy:?}");
    }
}

#[test]
fn cells_of_single_contacts_slip_alike() {
    let (size, samples) = (500, 8);
    // By which drives at slips scatter, N^{−2/3}, a tenth.
    let tolerance = 0.1 * (size as f64).powf(-2.0 / 3.0);
    let first = |contacts: Vec<Box<dyn RateDependentContacts>>, setting: RateDependentInterfaceParameters| {
        let mut interface = RateDependentInterface::new(contacts, chain(3, 0.5), setting).unwrap();
        let event = events(&mut interface, 4.6, 1e-2)[0];
        assert_eq!((event.epicentre, event.cells), (0, 3));
        [event.drive, event.moment, event.force_before, event.force_after, event.dissipated_breaks]
    };
    let contacts = cells(&logarithmic(), &WEAK[1..4], TOLERANCE);
    let expected = first(contacts, setting(0.2, 0.1, TOLERANCE));
    let relaxed = initial(&point(0.0));
    let sample = |seed: u64| {
        let cell = |j: usize| -> Box<dyn RateDependentContacts> {
            let model =
                Ensemble::new(logarithmic(), relaxed.clone(), size, seed, Disorder::Annealed).unwrap();
            let model = model.numbered_from((j * size) as u64).in_time().unwrap();
            Box::new(Scaled::new(Box::new(model), WEAK[1 + j]).unwrap())
        };
        let few = RateDependentInterfaceParameters { slip_fraction: 0.05, ..setting(0.2, 0.1, tolerance) };
        first((0..3).map(cell).collect(), few)
    };
    let drawn: Vec<_> = (1..=samples).map(sample).collect();
    for (i, expected) in expected.into_iter().enumerate() {
        let mean = drawn.iter().map(|sample| sample[i]).sum::<f64>() / samples as f64;
        let square = drawn.iter().map(|sample| (sample[i] - mean).powi(2)).sum::<f64>();
        let error = (square / (samples * (samples - 1)) as f64).sqrt();
        assert!((mean - expected).abs() < 4.0 * error, "{i}: {mean} instead of {expected}, {error}");
    }
}

#[test]
fn contacts_that_age_make_a_chain_slip_again_and_again() {
    let ageing = Ageing::Logarithmic { growth: 0.05, time: 1.0 };
    let aged = of(Rules { ageing: Some(ageing), ..Rules::default() }, 0.1);
    let number = 8;
    let slips = |contacts: &Contacts| {
        let setting =
            RateDependentInterfaceParameters { loading: CellLoading::Edge, ..setting(2.0, 0.3, 1e-3) };
        let contacts = cells(contacts, &vec![1.0; number], 1e-3);
        let mut interface = RateDependentInterface::new(contacts, chain(number, 10.0), setting).unwrap();
        let events = events(&mut interface, 30.0, 1e-3);
        let large = events.iter().filter(|event| event.cells == number && event.drop() > 0.5);
        large.map(|event| event.drive).collect::<Vec<_>>()
    };
    // Without age the slips of a driven slider die out, here before all cells slip at once.
    assert!(slips(&athermal()).is_empty());
    let drives = slips(&aged);
    let periods: Vec<f64> = drives.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(periods.len() > 3, "{drives:?}");
    // One period for all, once the first slips are over; creep at the edge varies a little.
    near(periods[periods.len() - 1], periods[periods.len() - 2], 0.02);
}

#[test]
fn threads_change_nothing() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let coupling = half_space(Shape::Square([2, 3]), Edges::Open, 0.5, 1.0).unwrap();
            let contacts = cells(&logarithmic(), &WEAK, 1e-3);
            let mut interface =
                RateDependentInterface::new(contacts, coupling, setting(0.2, 0.1, 1e-3)).unwrap();
            let events = events(&mut interface, 6.0, 1e-2);
            assert!(!events.is_empty());
            (interface.positions(), interface.energy(), events.len())
        })
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let make = |cells: usize, setting: RateDependentInterfaceParameters| {
        let contacts = (0..cells).map(|_| transport(&athermal(), 1e-3)).collect();
        RateDependentInterface::new(contacts, chain(2, 1.0), setting)
    };
    let key = |result: Result<RateDependentInterface>| match result {
        Err(Error::Invalid { key, .. }) => key,
        _ => panic!("taken"),
    };
    let good = setting(1.0, 1.0, 1e-3);
    assert_eq!(key(make(3, good)), "cells");
    assert_eq!(key(make(2, RateDependentInterfaceParameters { viscosity: 0.0, ..good })), "viscosity");
    assert_eq!(key(make(2, RateDependentInterfaceParameters { connection: f64::NAN, ..good })), "connection");
    assert_eq!(key(make(2, RateDependentInterfaceParameters { tolerance: -1.0, ..good })), "tolerance");
    assert_eq!(
        key(make(2, RateDependentInterfaceParameters { slip_fraction: 1.5, ..good })),
        "slip_fraction"
    );
    let mut interface = make(2, good).unwrap();
    assert!(interface.run(1.0, 0.0, &mut |_, _| ()).is_err());
    assert!(Scaled::new(transport(&athermal(), 1e-3), 0.0).is_err());
}
