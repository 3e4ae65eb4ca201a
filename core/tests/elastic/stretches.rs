//! Stretches of the contacts of single cells carry the forces of these cells.

use crate::common::pulled::near;
use crate::common::sliders::setting;
use crate::common::{contacts, gaussian, initial, master, point, rectangular};
use asperity::contacts::{Ageing, Contacts, Rules};
use asperity::elastic::coupling::neighbours;
use asperity::elastic::rate_dependent::Scaled;
use asperity::elastic::{
    CellLoading, CellSlip, Curves, Interface, RateDependentInterface, RateDependentInterfaceParameters,
};
use asperity::ensemble::{Disorder, Ensemble, Snapshots};
use asperity::master::{MasterEquation, Transport};
use asperity::rate_dependent::{RateDependentContacts, StretchInterval, binned};
use asperity::scenario;
use asperity::shape::{Edges, Shape};

/// ∫Q dx = 1 and ∫xQ dx = F by sums over even places.
#[test]
fn stretches_of_a_cell_carry_its_force() {
    let equation = master(&gaussian(1.0, 0.1), &rectangular(0.0, 0.2), &point(0.0));
    let population = equation.population_with(1e-10, &mut ()).unwrap();
    let scales = [1.0, 0.9, 1.2, 1.05];
    for slip in [CellSlip::Overdamped, CellSlip::Reset] {
        let cells = Curves::new(&population, 4).unwrap().scaled(scales.to_vec()).unwrap();
        let coupling = neighbours(Shape::Chain(4), Edges::Open, 0.5).unwrap();
        let mut chain = Interface::new(Box::new(cells), coupling, setting(0.5, slip, 1e-6)).unwrap();
        chain.run(2.7, &mut |_, _| ()).unwrap();
        let forces = chain.forces();
        let step = 1e-4;
        let stretches: Vec<f64> = (0..20_000).map(|i| step * f64::from(i)).collect();
        let mut renewed = 0;
        for (cell, force) in forces.iter().enumerate() {
            let standing = chain.standing(cell).unwrap().unwrap();
            near(standing.scale, scales[cell], 0.0);
            renewed += usize::from(standing.renewed);
            let found = scenario::Interface::stretch_density(&equation, standing, &stretches, 1e-10, &mut ())
                .unwrap();
            let density = found.density.iter().zip(&stretches);
            let sums =
                density.fold((0.0, 0.0), |(all, first), (q, x)| (all + step * q, first + step * q * x));
            let atoms = found.atoms.iter();
            let sums = atoms.fold(sums, |(all, first), a| (all + a.weight, first + a.weight * a.position));
            // A jump of Q of some 5 that falls between two places.
            near(sums.0, 1.0, 5.0 * step);
            near(sums.1, *force, 5.0 * step);
        }
        assert_eq!(renewed > 0, slip == CellSlip::Reset, "{renewed} cells have re-formed");
    }
    let cells = Curves::new(&population, 4).unwrap();
    let coupling = neighbours(Shape::Chain(4), Edges::Open, 0.5).unwrap();
    let chain = Interface::new(Box::new(cells), coupling, setting(0.5, CellSlip::Reset, 1e-6)).unwrap();
    let error = chain.standing(4).unwrap_err().to_string();
    assert!(error.starts_with("cell: expected a number below 4"), "{error}");
}

const VELOCITY: f64 = 1e-2;
const WAY: f64 = 2.7;

/// Contacts that age, and are free for a while.
fn ageing() -> Contacts {
    let ageing = Some(Ageing::Logarithmic { growth: 0.05, time: 1.0 });
    let rules = Rules { ageing, delay: 2.0.into(), ..Rules::default() };
    Contacts { rules, ..contacts(&gaussian(1.0, 0.1), &gaussian(0.2, 0.05)) }
}

/// A cell of these contacts, their lengths `scale` times as large, that goes nearly the way of its drive.
fn rigid(contacts: Box<dyn RateDependentContacts>, scale: f64) -> RateDependentInterface {
    let setting = RateDependentInterfaceParameters {
        connection: 1e6,
        loading: CellLoading::Uniform,
        mass: 0.0,
        viscosity: 1.0,
        tolerance: 1e-4,
        slip_fraction: 0.0,
        area: None,
    };
    let coupling = neighbours(Shape::Chain(1), Edges::Open, 1.0).unwrap();
    let contacts = Box::new(Scaled::new(contacts, scale).unwrap());
    let mut cell = RateDependentInterface::new(vec![contacts], coupling, setting).unwrap();
    cell.run(scale * WAY, scale * VELOCITY, &mut |_, _| ()).unwrap();
    cell
}

/// Edges of even bins.
fn edges() -> Vec<f64> {
    (0..=60).map(|i| 0.05 * f64::from(i)).collect()
}

#[test]
fn stretches_of_a_cell_in_time_are_those_of_a_rigid_slider() {
    let start = initial(&gaussian(0.3, 0.1));
    let equation = MasterEquation::at(ageing(), &start, VELOCITY).unwrap();
    let pull = equation.pull_with(WAY, 1e-10, &mut ()).unwrap();
    let mean = |ends: &[f64]| {
        let places: Vec<f64> =
            (0..20).map(|i| ends[0] + (f64::from(i) + 0.5) / 20.0 * (ends[1] - ends[0])).collect();
        pull.stretch_density(WAY, &places).unwrap().density.iter().sum::<f64>() / 20.0
    };
    let expected: Vec<f64> = edges().windows(2).map(mean).collect();
    for scale in [1.0, 1.3] {
        let cell = rigid(Box::new(Transport::new_with(ageing(), &start, 1e-5, &mut ()).unwrap()), scale);
        let portions = cell.stretches(0).unwrap();
        let edges: Vec<f64> = edges().iter().map(|edge| scale * edge).collect();
        let density = binned(&portions, &edges).unwrap();
        let share: f64 = density.iter().map(|density| density * (edges[1] - edges[0])).sum();
        near(share + cell.free(), 1.0, 1e-12);
        let middle = |portion: &StretchInterval| 0.5 * (portion.low + portion.high) * portion.fraction;
        let force: f64 = portions.iter().map(middle).sum();
        // Cohorts stand at Gauss points of the law that they re-form by, and the same share is left of all that one stands for.
        near(force, cell.force(), 1e-4 * scale);
        for (found, expected) in density.iter().zip(&expected) {
            // Cells are 0.017 wide: at either end of a bin of 0.05 they miscount up to 0.017²/8 times the slope of Q, some 2.
            near(scale * found, *expected, 3e-3);
        }
    }
}

#[test]
fn contacts_of_a_cell_followed_one_by_one_stand_where_those_of_a_pull_do() {
    let size = 2000;
    let model = Ensemble::new(ageing(), initial(&point(0.0)), size, 5, Disorder::Annealed).unwrap();
    let cell = rigid(Box::new(model.in_time().unwrap()), 1.0);
    let portions = cell.stretches(0).unwrap();
    let snapshots = Snapshots { positions: vec![WAY], edges: edges() };
    let pull = model.pull_at_with(VELOCITY, &[WAY], &snapshots, &mut ()).unwrap();
    // The cell lags behind by 1e-6, on which no contact breaks or comes to another bin but one time in a hundred.
    for (found, expected) in binned(&portions, &edges()).unwrap().iter().zip(pull.stretch_density(0..1)) {
        near(*found, expected, 1e-10);
    }
    let held = portions.iter().map(|portion| portion.fraction).sum::<f64>();
    near(held + cell.free(), 1.0, 1e-12);
    let error = cell.stretches(1).unwrap_err().to_string();
    assert!(error.starts_with("cell: expected a number below 1"), "{error}");
}
