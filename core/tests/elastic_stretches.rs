//! Stretches of the contacts of single cells carry the forces of these cells.

mod common;

use asperity::elastic::coupling::neighbours;
use asperity::elastic::{Curves, Interface, Slip};
use asperity::scenario;
use asperity::shape::{Edges, Shape};
use common::pulled::near;
use common::sliders::setting;
use common::{gaussian, master, point, rectangular};

/// ∫Q dx = 1 and ∫xQ dx = F by sums over even places.
#[test]
fn stretches_of_a_cell_carry_its_force() {
    let equation = master(&gaussian(1.0, 0.1), &rectangular(0.0, 0.2), &point(0.0));
    let population = equation.population(1e-10).unwrap();
    let scales = [1.0, 0.9, 1.2, 1.05];
    for slip in [Slip::Overdamped, Slip::Reset] {
        let cells = Curves::new(&population, 4, &mut ()).unwrap().scaled(scales.to_vec()).unwrap();
        let coupling = neighbours(Shape::Chain(4), Edges::Open, 0.5).unwrap();
        let mut chain = Interface::new(Box::new(cells), coupling, setting(0.5, slip, 1e-6)).unwrap();
        chain.run(2.7, &mut (), &mut |_, _| ()).unwrap();
        let forces = chain.forces().unwrap();
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
        assert_eq!(renewed > 0, slip == Slip::Reset, "{renewed} cells have re-formed");
    }
    let cells = Curves::new(&population, 4, &mut ()).unwrap();
    let coupling = neighbours(Shape::Chain(4), Edges::Open, 0.5).unwrap();
    let chain = Interface::new(Box::new(cells), coupling, setting(0.5, Slip::Reset, 1e-6)).unwrap();
    let error = chain.standing(4).unwrap_err().to_string();
    assert!(error.starts_with("cell: expected a number below 4"), "{error}");
}
