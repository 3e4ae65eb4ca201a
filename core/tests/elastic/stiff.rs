//! Stiff sliders: cells that hardly move apart have forces with all their digits.

use crate::common::curve::gaussian;
use crate::common::pulled::{near, pull};
use crate::common::sliders::{events, interface, setting};
use asperity::block;
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::{CellSlip, Coupling, Interface};
use asperity::exact::{self, ClosedForm as _};
use asperity::shape::{Edges, Shape};

const CELLS: usize = 16;
const CONNECTION: f64 = 0.4;
const DRIVE: f64 = 6.0;
const STD: f64 = 0.1;

/// Sliders of all kinds.
fn sliders(stiffness: f64) -> [Box<dyn Coupling>; 4] {
    let square = Shape::Square([4, 4]);
    [
        neighbours(Shape::Chain(CELLS), Edges::Open, stiffness).unwrap(),
        neighbours(square, Edges::Periodic, stiffness).unwrap(),
        half_space(square, Edges::Open, stiffness, 1.0).unwrap(),
        half_space(square, Edges::Periodic, stiffness, 1.0).unwrap(),
    ]
}

fn cells(slider: Box<dyn Coupling>, scales: Option<Vec<f64>>, slip: CellSlip) -> Interface {
    interface(&gaussian(STD), scales, slider, setting(CONNECTION, slip, 1e-9))
}

/// Equal cells are one block, whatever couples them. Events come where K_0(X_c − X_T) = ½F''(X − X_1)² is within the
/// tolerance of the drive, ends are known as well as forces, 1e-11 of the strongest.
#[test]
fn equal_cells_are_one_block_on_any_slider() {
    let rules = [(CellSlip::Overdamped, block::Slip::Overdamped), (CellSlip::Reset, block::Slip::Reset)];
    for (slip, of_block) in rules {
        let slips = pull(&mut gaussian(STD), CONNECTION, of_block, &[DRIVE]);
        let last = slips.trace.last().unwrap();
        for stiffness in [1e8, 1e18] {
            for slider in sliders(stiffness) {
                let mut cells = cells(slider, None, slip);
                let found = events(&mut cells, DRIVE);
                assert_eq!(found.len(), slips.events.len(), "{slip:?} {stiffness:e}");
                for (event, slip) in found.iter().zip(&slips.events) {
                    assert_eq!(event.cells, CELLS);
                    near(event.drive, slip.before.drive, 1e-8);
                    near(event.force_after / CELLS as f64, slip.after.force, 1e-8);
                }
                // Cells that have been reset remember at which drive they were.
                let accuracy = if slip == CellSlip::Reset { 1e-8 } else { 1e-10 };
                for force in cells.forces() {
                    near(force, last.force, accuracy);
                }
                near(cells.energy().imbalance() / CELLS as f64, 0.0, 1e-9);
            }
        }
    }
}

/// Cells that differ, on a slider so stiff that all are at X: Σ s_j F(X/s_j) = n K_0 (X_T − X), from the closed form.
#[test]
fn different_cells_on_a_rigid_slider_balance_together() {
    let scales: Vec<f64> = (0..CELLS).map(|j| 0.8 + 0.4 * j as f64 / (CELLS - 1) as f64).collect();
    let curve = exact::Gaussian::new(1.0, STD);
    let drive = 1.2;
    let excess = |x: f64| {
        let held: f64 = scales.iter().map(|s| s * curve.force(x / s)).sum();
        CELLS as f64 * CONNECTION * (drive - x) - held
    };
    let (mut low, mut high) = (0.0, drive);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 { low = middle } else { high = middle }
    }
    // Springs of 1e12 leave cells 1e-12 apart, times the slopes of a few.
    for (stiffness, accuracy) in [(1e8, 1e-6), (1e12, 1e-10), (1e18, 1e-10)] {
        for slider in sliders(stiffness) {
            let mut cells = cells(slider, Some(scales.clone()), CellSlip::Overdamped);
            assert!(events(&mut cells, drive).is_empty());
            for (force, s) in cells.forces().iter().zip(&scales) {
                near(*force, s * curve.force(low / s), accuracy);
            }
        }
    }
}
