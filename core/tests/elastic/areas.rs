//! Cells of unequal area: against a block, against equal cells of which some are tied together, and against single contacts.

use crate::common::curve::gaussian;
use crate::common::pulled::{near, pull};
use crate::common::sliders::{events, scales, setting};
use crate::common::{contacts, initial, master, point};
use asperity::Result;
use asperity::block::{self, StickSlip};
use asperity::contacts::{Ageing, Contacts, Rules};
use asperity::elastic::coupling::neighbours;
use asperity::elastic::rate_dependent::Scaled;
use asperity::elastic::{
    CellLoading, CellSlip, Cells, Coupling, Curves, Event, Interface, InterfaceParameters, Populations,
    RateDependentInterface, RateDependentInterfaceParameters,
};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::master::Transport;
use asperity::monitor::Monitor;
use asperity::population::Population;
use asperity::rate_dependent::{PopulationInTime, RateDependentContacts};
use asperity::record::Record;
use asperity::scenario::{self, Elasticity, PerCell, Scenario};
use asperity::shape::{Edges, Shape};

const RULES: [(CellSlip, block::Slip); 2] =
    [(CellSlip::Overdamped, block::Slip::Overdamped), (CellSlip::Reset, block::Slip::Reset)];

/// Springs of any stiffness, each between two cells of a chain.
#[derive(Debug)]
struct Springs {
    cells: usize,
    springs: Vec<(usize, usize, f64)>,
}

impl Springs {
    /// Springs between the cells of a chain, from the first two on.
    fn along(stiffness: &[f64]) -> Box<dyn Coupling> {
        let springs = stiffness.iter().enumerate().map(|(j, &stiffness)| (j, j + 1, stiffness)).collect();
        Box::new(Self { cells: stiffness.len() + 1, springs })
    }
}

impl Coupling for Springs {
    fn shape(&self) -> Shape {
        Shape::Chain(self.cells)
    }

    fn edges(&self) -> Edges {
        Edges::Open
    }

    fn forces(&mut self, x: &[f64], forces: &mut [f64], _monitor: &mut dyn Monitor) -> Result<()> {
        forces.fill(0.0);
        for &(i, j, stiffness) in &self.springs {
            forces[i] += stiffness * (x[j] - x[i]);
            forces[j] += stiffness * (x[i] - x[j]);
        }
        Ok(())
    }

    fn precondition(&mut self, diagonal: f64, right: &mut [f64], _monitor: &mut dyn Monitor) -> Result<bool> {
        for (j, right) in right.iter_mut().enumerate() {
            *right /= diagonal + self.self_stiffness(j);
        }
        Ok(false)
    }

    fn self_stiffness(&self, cell: usize) -> f64 {
        let beside = self.springs.iter().filter(|(i, j, _)| *i == cell || *j == cell);
        beside.map(|(_, _, stiffness)| stiffness).sum()
    }
}

fn chain(cells: usize, stiffness: f64) -> Box<dyn Coupling> {
    neighbours(Shape::Chain(cells), Edges::Open, stiffness).unwrap()
}

/// Cells of these scales and areas.
fn interface(
    population: &dyn Population,
    (scales, areas): (&[f64], &[f64]),
    coupling: Box<dyn Coupling>,
    setting: InterfaceParameters,
) -> Interface {
    let cells = Curves::new(population, areas.len()).unwrap();
    let cells = cells.scaled(scales.to_vec()).unwrap().with_areas(areas.to_vec()).unwrap();
    Interface::new(Box::new(cells), coupling, setting).unwrap()
}

/// Events of cells of this total area as slips of a block of area 1.
#[track_caller]
fn same_as_block(events: &[Event], slips: &StickSlip, area: f64, [fold, accuracy]: [f64; 2]) {
    assert_eq!(events.len(), slips.events.len());
    assert!(events.len() > 1);
    for (event, slip) in events.iter().zip(&slips.events) {
        near(event.drive, slip.before.drive, accuracy);
        near(event.position_before, slip.before.position, fold);
        near(event.force_before / area, slip.before.force, fold);
        near(event.position_after, slip.after.position, accuracy);
        near(event.force_after / area, slip.after.force, accuracy);
        near(event.broken_fraction, slip.broken_fraction, fold / 0.05);
        near(event.dissipated_breaks / area, slip.energy.breaks, fold);
        near(event.dissipated_slip / area, slip.energy.slip, fold);
        near(event.area, area, 1e-12);
        near(event.moment, area * event.slip(), 1e-12);
    }
}

/// Rigidly coupled, or one alone: with the load proportional to the area all move as a block does.
#[test]
fn cells_on_a_rigid_slider_are_a_block_whatever_their_areas() {
    // √(2Kε/F''), where F'' is some 1/σ², for the tolerance ε of the drive.
    let (tolerance, fold) = (1e-9, 1e-4);
    for (slip, of_block) in RULES {
        let slips = pull(&mut gaussian(0.1), 1.0, of_block, &[8.0]);
        for areas in
            [vec![3.0], vec![0.25], vec![0.5, 4.0, 1.0, 2.5], vec![1.0, 0.1, 0.3, 3.0, 0.2, 1.0, 2.0]]
        {
            let ones = vec![1.0; areas.len()];
            let coupling = chain(areas.len(), 1e4);
            let mut cells =
                interface(&gaussian(0.1), (&ones, &areas), coupling, setting(1.0, slip, tolerance));
            let area = areas.iter().sum::<f64>();
            same_as_block(&events(&mut cells, 8.0), &slips, area, [fold, 1e-8]);
            near(cells.mean_position(), cells.positions()[0], 1e-3);
        }
    }
}

/// With viscosity slides last as long, as the viscosity is proportional to the area too.
#[test]
fn one_cell_of_an_area_is_one_of_area_1_with_forces_times_the_area() {
    let area = 3.0;
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let viscous = InterfaceParameters { viscosity: Some(0.7), ..setting(0.5, slip, 1e-7) };
        let of = |area: f64| interface(&gaussian(0.1), (&[1.0], &[area]), chain(1, 1.0), viscous);
        let (mut one, mut large) = (of(1.0), of(area));
        let (expected, found) = (events(&mut one, 10.0), events(&mut large, 10.0));
        assert!(expected.len() > 2);
        assert_eq!(expected.len(), found.len());
        // The drives to their tolerance, 1e-7, which moves the ends of slides by some ten times that at most.
        for (one, large) in expected.iter().zip(&found) {
            near(large.drive, one.drive, 1e-7);
            near(large.position_after, one.position_after, 1e-6);
            near(large.force_after, area * one.force_after, 3e-6);
            near(large.moment, area * one.moment, 1e-3);
            near(large.dissipated_slip, area * one.dissipated_slip, 1e-3);
            near(large.broken_fraction, one.broken_fraction, 1e-3);
        }
        near(large.energy().work, area * one.energy().work, 1e-5);
        near(large.broken(), one.broken(), 1e-5);
        // A slide from far beyond the fold, whose duration does not depend on how closely that is found.
        let [expected, found] = [1.0, area].map(|area| {
            let mut cell = of(area);
            cell.put(2.5, &[0.9]).unwrap();
            cell.next(2.5).unwrap()[0].0
        });
        assert!(expected.duration > 0.0);
        // The same steps, up to rounding.
        near(found.duration, expected.duration, 1e-6 * expected.duration);
        near(found.moment, area * expected.moment, 1e-9);
    }
}

/// Cells of areas 2 and 1, and three of area 1 of which the first two are tied by a spring T: these differ by up to K/T of a mean
/// threshold, which moves the others by no more.
#[test]
fn a_cell_of_area_2_is_two_cells_of_area_1_tied_together() {
    let (stiffness, tie, connection) = (0.4, 1e6, 0.3);
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        for loading in [CellLoading::Uniform, CellLoading::Edge] {
            let setting = |connection| InterfaceParameters { loading, ..setting(connection, slip, 1e-7) };
            let mut two = interface(
                &gaussian(0.1),
                (&[1.0, 0.8], &[2.0, 1.0]),
                Springs::along(&[stiffness]),
                setting(connection),
            );
            // The drive pulls the first one of the tied cells alone.
            let alone = if loading == CellLoading::Edge { 2.0 } else { 1.0 };
            let mut three = interface(
                &gaussian(0.1),
                (&[1.0, 1.0, 0.8], &[1.0; 3]),
                Springs::along(&[tie, stiffness]),
                setting(alone * connection),
            );
            let (found, expected) = (events(&mut two, 16.0), events(&mut three, 16.0));
            assert!(found.len() > 3, "{} events", found.len());
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                // Of the drive, and of what happens after the slide, which does not depend on how closely a fold is found.
                near(found.drive, expected.drive, 1e-5);
                near(found.position_after, expected.position_after, 1e-4);
                near(found.force_after, expected.force_after, 1e-4);
                // Displacements before a fold, to the root of that.
                near(found.moment, expected.moment, 5e-3);
                near(found.area, expected.area, 1e-12);
                near(found.broken_fraction, expected.broken_fraction, 5e-3);
            }
            for (j, of) in [(0, 0), (0, 1), (1, 2)] {
                near(two.positions()[j], three.positions()[of], 1e-4);
            }
            let [own, others] = [two.energy(), three.energy()];
            near(own.work, others.work, 1e-3);
            near(own.breaks, others.breaks, 1e-2);
        }
    }
}

/// Each force from what the interface shows, and each energy on its own.
#[test]
fn forces_and_energies_of_cells_of_unequal_area_balance_after_every_event() {
    let areas = [0.2, 1.0, 3.0, 0.5, 0.5, 2.0, 0.1, 4.0, 1.0, 0.7, 1.5, 0.3];
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        for shape in [Shape::Chain(12), Shape::Square([3, 4])] {
            let coupling = || neighbours(shape, Edges::Periodic, 1.0).unwrap();
            let connection = 0.3;
            let scales = scales(12, 0.15);
            let parameters = setting(connection, slip, 1e-4);
            let mut cells = interface(&gaussian(0.1), (&scales, &areas), coupling(), parameters);
            let (mut slider, mut number, mut moment) = (coupling(), 0, 0.0);
            loop {
                let found = cells.next(16.0).unwrap();
                if found.is_empty() {
                    break;
                }
                number += found.len();
                moment += found.iter().map(|(event, _)| event.moment).sum::<f64>();
                for (event, slipped) in &found {
                    let weighted: f64 = slipped.iter().map(|s| areas[s.cell] * s.slip).sum();
                    near(event.moment, weighted, 1e-12);
                    let area: f64 = slipped.iter().map(|s| areas[s.cell]).sum();
                    near(event.area, area, 1e-12);
                    near(event.area * event.slip(), event.moment, 1e-12);
                }
                let mut pulls = [0.0; 12];
                slider.forces(cells.positions(), &mut pulls, &mut ()).unwrap();
                let forces = cells.forces();
                let spring = |j: usize| areas[j] * connection * (cells.drive() - cells.positions()[j]);
                let excess = (0..12).map(|j| (spring(j) + pulls[j] - forces[j]).abs()).fold(0.0, f64::max);
                // Balances are found to rounding of forces of order 10 and their sums over the cells.
                assert!(excess < 1e-10, "{excess:e} after event {number}");
                near(cells.energy().imbalance(), 0.0, 2e-9);
            }
            assert!(number >= 4, "{number} events, {slip:?}, {shape:?}");
            // What slips in events is a part of the displacement of all cells.
            let moved = areas.iter().sum::<f64>() * cells.mean_position();
            assert!(moment > 0.0 && moment < moved, "{moment} of {moved}");
        }
    }
}

/// Cells with a population each are those that share the curve of the population.
#[test]
fn areas_are_those_of_cells_with_a_population_each_too() {
    let (scales, areas) = ([1.0, 0.9, 1.1], [0.5, 3.0, 1.5]);
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let parameters = setting(0.3, slip, 1e-7);
        let mut shared = interface(&gaussian(0.1), (&scales, &areas), chain(3, 0.5), parameters);
        let each = (0..3).map(|_| gaussian(0.1).copy()).collect();
        let each = Populations::new(each, &mut ()).unwrap().scaled(&scales).unwrap();
        let each = Box::new(each.with_areas(areas.to_vec()).unwrap());
        let mut each = Interface::new(each, chain(3, 0.5), parameters).unwrap();
        let (expected, found) = (events(&mut shared, 16.0), events(&mut each, 16.0));
        assert!(expected.len() > 3, "{} events", expected.len());
        assert_eq!(expected.len(), found.len());
        for (expected, found) in expected.iter().zip(&found) {
            // The same pieces of the same curve, tabulated to 1e-12 of the force.
            near(found.drive, expected.drive, 1e-7);
            near(found.moment, expected.moment, 1e-3);
            near(found.force_after, expected.force_after, 1e-6);
            near(found.broken_fraction, expected.broken_fraction, 1e-3);
        }
        near(each.energy().imbalance(), 0.0, 1e-9);
        near(each.broken(), shared.broken(), 1e-6);
        assert_eq!(each.areas().all(), Some(&areas[..]));
    }
}

#[test]
fn cells_of_unequal_area_go_on_from_a_state_bit_for_bit() {
    let (scales, areas) = (scales(8, 0.1), [1.0, 2.0, 0.5, 3.0, 1.0, 0.2, 1.3, 0.9]);
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let new = || interface(&gaussian(0.1), (&scales, &areas), chain(8, 1.0), setting(0.3, slip, 1e-5));
        let mut whole = new();
        whole.run(4.0, &mut |_, _| ()).unwrap();
        let mut resumed = new();
        resumed.restore(whole.state(), &mut ()).unwrap();
        let further = |interface: &mut Interface| {
            let mut events = Vec::new();
            interface.run(16.0, &mut |event, _| events.push(format!("{event:?}"))).unwrap();
            events
        };
        let expected = further(&mut whole);
        assert!(expected.len() > 1);
        assert_eq!(further(&mut resumed), expected);
        assert_eq!(resumed.state(), whole.state());
    }
}

/// Of uncoupled cells on stiff springs to the drive, those of area 3 have broken between the thresholds of both.
#[test]
fn first_breaks_count_contacts_by_the_area_of_their_cells() {
    let thresholds = crate::common::gaussian(1.0, 0.05);
    let population = master(&thresholds, &point(0.0), &point(0.0)).population().unwrap();
    let connection = 100.0;
    let cells = (&[0.7, 1.3][..], &[3.0, 1.0][..]);
    let parameters = setting(connection, CellSlip::Overdamped, 1e-6);
    let mut cells = interface(&population, cells, chain(2, 1e-6), parameters);
    let breaks = cells.first_breaks(thresholds.as_ref(), 1.0 / (1.0 + connection), &mut ()).unwrap();
    // The distribution functions at 1.0/0.7 and 1.0/1.3 are 1 and 0 to 4σ and more; the lines between points of the curve and the
    // slope of the friction leave 1e-3.
    near(breaks.fraction(1.0), 0.75, 1e-3);
    let mean = 0.75 * 0.7 * thresholds.mean() + 0.25 * 1.3 * thresholds.mean();
    near(breaks.mean(), mean, 1e-2);
}

fn ageing() -> Box<dyn RateDependentContacts> {
    let rules = Rules { ageing: Some(Ageing::Logarithmic { growth: 0.04, time: 1.0 }), ..Rules::default() };
    let ageing = Contacts { rules, ..contacts(&crate::common::gaussian(1.0, 0.1), &point(0.0)) };
    Box::new(Transport::new_with(ageing, &initial(&point(0.0)), 1e-4, &mut ()).unwrap())
}

fn athermal() -> Box<dyn RateDependentContacts> {
    let equation = master(&crate::common::gaussian(1.0, 0.1), &point(0.0), &point(0.0));
    Box::new(PopulationInTime::new(Box::new(equation.population_with(1e-8, &mut ()).unwrap()), 1.0))
}

/// Contacts of these scales and areas, coupled, in time.
fn in_time(
    contacts: &dyn RateDependentContacts,
    (scales, areas): (&[f64], &[f64]),
    coupling: Box<dyn Coupling>,
    mass: f64,
) -> RateDependentInterface {
    let viscous = RateDependentInterfaceParameters::new(0.3, 0.3, 1e-5);
    let cell = |(&scale, &area): (&f64, &f64)| -> Box<dyn RateDependentContacts> {
        Box::new(Scaled::new(contacts.copy(), scale).unwrap().on_area(area).unwrap())
    };
    let cells = scales.iter().zip(areas).map(cell).collect();
    RateDependentInterface::new(cells, coupling, RateDependentInterfaceParameters { mass, ..viscous })
        .unwrap()
}

fn events_in_time(interface: &mut RateDependentInterface, drive: f64, velocity: f64) -> Vec<Event> {
    let mut events = Vec::new();
    interface.run(drive, velocity, &mut |event, _| events.push(*event)).unwrap();
    events
}

/// Spring, mass, viscosity and contacts are all proportional to the area: cells that are alike but for it move alike.
#[test]
fn cells_in_time_that_differ_by_area_alone_are_one_cell() {
    for (contacts, mass, velocity) in [(ageing(), 0.0, 0.01), (ageing(), 0.5, 0.01), (athermal(), 0.5, 0.02)]
    {
        let areas = [0.3, 2.0, 0.7];
        let mut cells = in_time(contacts.as_ref(), (&[1.0; 3], &areas), chain(3, 0.5), mass);
        let mut one = in_time(contacts.as_ref(), (&[1.0], &[3.0]), chain(1, 0.5), mass);
        let [found, expected] = [&mut cells, &mut one].map(|own| events_in_time(own, 8.0, velocity));
        assert!(!expected.is_empty());
        assert_eq!(found.len(), expected.len());
        // The same steps of the same equation, up to the tolerance of the stages, 1e-7.
        for (found, expected) in found.iter().zip(&expected) {
            near(found.drive, expected.drive, 1e-3);
            near(found.force_after, expected.force_after, 1e-3);
            near(found.moment, expected.moment, 1e-3);
            near(found.area, 3.0, 1e-12);
            near(found.broken_fraction, expected.broken_fraction, 1e-3);
        }
        for position in cells.positions() {
            near(position, one.positions()[0], 1e-4);
        }
        near(cells.mean_position(), one.mean_position(), 1e-4);
        near(cells.mean_velocity(), one.mean_velocity(), 1e-4);
        near(cells.force(), one.force(), 3e-4);
        near(cells.broken(), one.broken(), 1e-3);
        // The trapezoidal and backward differences of the work and the drag, of second order in steps to 1e-5.
        for own in [&cells, &one] {
            let energy = own.energy();
            near(energy.imbalance(), 0.0, 2e-2 * energy.work);
        }
        near(cells.energy().work, one.energy().work, 1e-3);
        near(cells.energy().slip, one.energy().slip, 1e-3);
    }
}

/// In the middle of an event, too: the areas are no part of the state.
#[test]
fn cells_of_unequal_area_in_time_go_on_from_a_state_bit_for_bit() {
    let new = || in_time(&*ageing(), (&[1.0, 0.9, 1.1], &[0.4, 2.0, 1.0]), chain(3, 0.5), 0.0);
    let mut whole = new();
    whole.run(2.0, 0.01, &mut |_, _| ()).unwrap();
    let mut resumed = new();
    resumed.restore(whole.state()).unwrap();
    let further = |interface: &mut RateDependentInterface| {
        events_in_time(interface, 5.0, 0.01).iter().map(|event| format!("{event:?}")).collect::<Vec<_>>()
    };
    let expected = further(&mut whole);
    assert!(!expected.is_empty());
    assert_eq!(further(&mut resumed), expected);
    assert_eq!(format!("{:?}", resumed.state()), format!("{:?}", whole.state()));
}

#[test]
fn a_cell_of_area_2_is_two_cells_of_area_1_tied_together_in_time() {
    for (contacts, mass, velocity) in [(ageing(), 0.0, 0.01), (athermal(), 0.5, 0.02)] {
        // Stiff enough for displacements below the tolerance of positions, soft enough for steps in time with a mass.
        let (stiffness, tie) = (0.4, 1e4);
        let of = |scales: &[f64], areas: &[f64], springs: &[f64]| {
            in_time(contacts.as_ref(), (scales, areas), Springs::along(springs), mass)
        };
        let mut two = of(&[1.0, 0.8], &[2.0, 1.0], &[stiffness]);
        let mut three = of(&[1.0, 1.0, 0.8], &[1.0; 3], &[tie, stiffness]);
        let [found, expected] = [&mut two, &mut three].map(|own| events_in_time(own, 8.0, velocity));
        assert!(found.len() > 1);
        assert_eq!(found.len(), expected.len());
        // Tied cells differ by K/T of a mean threshold, some 1e-4; positions at slip velocity change fast.
        for (found, expected) in found.iter().zip(&expected) {
            near(found.drive, expected.drive, 2e-3);
            near(found.force_after, expected.force_after, 1e-2);
            near(found.moment, expected.moment, 2e-2);
            near(found.area, expected.area, 1e-12);
        }
        for (j, of) in [(0, 0), (0, 1), (1, 2)] {
            near(two.positions()[j], three.positions()[of], 2e-3);
        }
    }
}

/// The scenario of a chain of two cells of such areas.
fn described(areas: [f64; 2], size: usize) -> (scenario::Interface, scenario::Ensemble) {
    let own = scenario::Interface {
        cells: vec![2],
        contacts: PerCell::Many,
        connection: 0.5,
        coupling: Elasticity::Neighbours { stiffness: 1.0 },
        edges: Edges::Open,
        loading: CellLoading::Uniform,
        mass: None,
        slip: Some(CellSlip::Overdamped),
        viscosity: Some(0.1),
        disorder: None,
        areas: Some(areas.to_vec()),
        drive_tolerance: 1e-6,
        catalogue_from: 0.0,
        main_shocks: None,
        slip_rates: None,
    };
    (own, scenario::Ensemble { size: Some(size), ..scenario::Ensemble::default() })
}

/// Contacts are followed one by one in proportion to the area: at one position of both cells those of areas 3 and 1, 20 for a
/// cell of mean area, are 40 contacts that are all alike.
#[test]
fn few_contacts_are_as_many_as_the_area_of_their_cell_has() {
    let thresholds = crate::common::gaussian(1.0, 0.1);
    let (own, ensemble) = described([30.0, 10.0], 20);
    let of = contacts(&thresholds, &point(0.0));
    let start = initial(&point(0.0));
    let mut cells = own.deformable(of.clone(), &start, 1e-6, Some(&ensemble), &mut ()).unwrap();
    assert_eq!(cells.areas().all(), Some(&[1.5, 0.5][..]));
    let together = Ensemble::new(of, start, 40, ensemble.seed, Disorder::Annealed).unwrap();
    let positions = [0.5, 0.9, 1.1, 1.7, 2.6];
    let expected = together.pull(&positions).unwrap();
    for (&position, force) in positions.iter().zip(&expected.force) {
        cells.put(position, &[position; 2]).unwrap();
        // Rounding of sums of 40 stretches.
        near(cells.force() / 2.0, *force, 1e-12);
        near(cells.stretches(0).unwrap().unwrap().len() as f64, 30.0, 0.0);
        near(cells.stretches(1).unwrap().unwrap().len() as f64, 10.0, 0.0);
    }
}

/// Areas in any unit are relative to their mean, and equal ones are none.
#[test]
fn areas_of_a_scenario_are_relative_to_their_mean() {
    let relative = |areas: [f64; 2]| described(areas, 20).0.relative_areas();
    assert_eq!(relative([30.0, 10.0]), Some(vec![1.5, 0.5]));
    assert_eq!(relative([7.0, 7.0]), None);
    let of = contacts(&crate::common::gaussian(1.0, 0.1), &point(0.0));
    let start = initial(&point(0.0));
    let run = |areas: Option<Vec<f64>>| {
        let own = scenario::Interface { areas, ..described([1.0, 1.0], 1).0 };
        let mut cells = own.deformable(of.clone(), &start, 1e-6, None, &mut ()).unwrap();
        cells.run(4.0, &mut |_, _| ()).unwrap();
        format!("{:?}", cells.state())
    };
    assert_eq!(run(Some(vec![7.0, 7.0])), run(None));
    assert_eq!(run(Some(vec![6.0, 3.0])), run(Some(vec![2.0, 1.0])));
}

/// Background force and normal load are those of a cell of mean area, and proportional to the area.
#[test]
fn cells_of_unequal_area_have_their_part_of_background_force_and_normal_load() {
    let (background, load) = (0.2, 2.0);
    let run = |background: Option<f64>| {
        let contacts = scenario::Contacts {
            thresholds: Some(scenario::Law::Gaussian { mean: 1.0, std: 0.1 }),
            background_force: background,
            normal_load: Some(load),
            ..scenario::Contacts::default()
        };
        let own = scenario::Interface { viscosity: None, ..described([30.0, 10.0], 1).0 };
        let drive = scenario::Drive { distance: Some(4.0), points: 5, ..scenario::Drive::default() };
        let interface = Some(own);
        let scenario = Scenario { interface, drive: Some(drive.clone()), ..Scenario::new(contacts) };
        drive.run_interface(&scenario.build().unwrap(), &mut ()).unwrap().record
    };
    let (without, with) = (run(None), run(Some(background)));
    let values = |record: &Record, name: &str| record.values(name).unwrap().to_vec();
    let parts = [1.5 * background, 0.5 * background];
    for (name, more) in [("cell_force", parts), ("force", [2.0 * background; 2])] {
        let [before, after] = [&without, &with].map(|record| values(record, name));
        assert!(!before.is_empty());
        for (i, (before, after)) in before.iter().zip(&after).enumerate() {
            near(*after, before + more[i % 2], 1e-12);
        }
    }
    let forces = values(&with, "force");
    for (coefficient, force) in values(&with, "friction_coefficient").iter().zip(&forces) {
        near(*coefficient, force / (2.0 * load), 1e-12);
    }
    for (cells, force) in values(&with, "cell_force").chunks(2).zip(&forces) {
        near(cells.iter().sum(), *force, 1e-12);
    }
    // The position is the mean by area.
    for (cells, mean) in values(&with, "cell_position").chunks(2).zip(&values(&with, "position")) {
        near(0.75 * cells[0] + 0.25 * cells[1], *mean, 1e-12);
    }
}

/// Cells of a batch refuse what is no area, and an interface over them has the areas of the cells.
#[test]
fn what_is_no_area_is_refused() {
    let cells = || Curves::new(&gaussian(0.1), 2).unwrap();
    for (areas, key) in
        [(vec![1.0], "areas: "), (vec![1.0, 0.0], "areas.1: "), (vec![f64::NAN, 1.0], "areas.0: ")]
    {
        let error = cells().with_areas(areas).unwrap_err().to_string();
        assert!(error.starts_with(key), "{error}");
    }
    assert!(Scaled::new(athermal(), 1.0).unwrap().on_area(-1.0).is_err());
    assert_eq!(cells().with_areas(vec![2.0, 1.0]).unwrap().areas().total(2), 3.0);
}
