//! One cell, and cells rigidly coupled, do what a block does.

use crate::common::curve::{gaussian, identical};
use crate::common::pulled::{near, pull};
use crate::common::sliders::{chain, events, interface, scales, setting};
use asperity::block::{self, StickSlip};
use asperity::elastic::coupling::neighbours;
use asperity::elastic::{CellLoading, CellSlip, InterfaceParameters};
use asperity::shape::{Edges, Shape};

const RULES: [(CellSlip, block::Slip); 2] =
    [(CellSlip::Overdamped, block::Slip::Overdamped), (CellSlip::Reset, block::Slip::Reset)];

/// Events of so many cells as slips of a block, each cell for itself; `fold`: by how much the position at the loss of
/// balance may be off, where K(X_c − X_T) = ½F''(X − X_1)² for a tolerance of the drive.
#[track_caller]
fn same(events: &[asperity::elastic::Event], slips: &StickSlip, cells: f64, fold: f64, accuracy: f64) {
    assert_eq!(events.len(), slips.events.len());
    for (event, slip) in events.iter().zip(&slips.events) {
        near(event.drive, slip.before.drive, accuracy);
        near(event.position_before, slip.before.position, fold);
        near(event.force_before / cells, slip.before.force, fold);
        near(event.position_after, slip.after.position, accuracy);
        near(event.force_after / cells, slip.after.force, accuracy);
        near(event.broken_fraction, slip.broken_fraction, fold / 0.05);
        near(event.dissipated_breaks / cells, slip.energy.breaks, fold);
        near(event.dissipated_slip / cells, slip.energy.slip, fold);
    }
}

#[test]
fn one_cell_is_a_block() {
    // √(2Kε/F''), where F'' is some 1/σ² at the first slips and below 1 at the last ones.
    let (tolerance, fold) = (1e-11, 2e-5);
    for std in [0.05, 0.1] {
        for (slip, of_block) in RULES {
            let slips = pull(&mut gaussian(std), 1.0, of_block, &[12.0]);
            let mut cell = chain(&gaussian(std), 1, 1.0, 1.0, slip, tolerance);
            same(&events(&mut cell, 12.0), &slips, 1.0, fold, 1e-9);
            near(cell.energy().imbalance(), 0.0, 1e-10);
            near(cell.energy().work, slips.energy.work, 1e-9);
        }
    }
}

/// What breaks together is lost at once: there is no fold.
#[test]
fn contacts_that_break_together_slip_as_under_a_block() {
    for (slip, of_block) in RULES {
        let slips = pull(&mut identical(), 0.5, of_block, &[11.5]);
        let mut cell = chain(&identical(), 1, 1.0, 0.5, slip, 1e-12);
        assert!(slips.events.len() > 2);
        same(&events(&mut cell, 11.5), &slips, 1.0, 1e-10, 1e-10);
        near(cell.energy().imbalance(), 0.0, 1e-10);
    }
}

#[test]
fn cells_on_a_rigid_slider_are_a_block() {
    // √(2Kε/F'') for the tolerance of the drive.
    let (tolerance, fold) = (1e-9, 1e-4);
    for (slip, of_block) in RULES {
        let slips = pull(&mut gaussian(0.1), 1.0, of_block, &[8.0]);
        let mut cells = chain(&gaussian(0.1), 7, 1e4, 1.0, slip, tolerance);
        same(&events(&mut cells, 8.0), &slips, 7.0, fold, 1e-8);
    }
}

/// Pulled at one end, the last of n cells lags by F n²/(2K_int) behind the first one.
#[test]
fn a_rigid_slider_may_be_pulled_at_its_edge() {
    let (cells, stiffness) = (4, 1e5);
    let lag = 16.0 / (2.0 * stiffness);
    for (slip, of_block) in RULES {
        let slips = pull(&mut gaussian(0.1), 0.5, of_block, &[8.0]);
        let coupling = neighbours(Shape::Chain(cells), Edges::Open, stiffness).unwrap();
        let edge = InterfaceParameters { loading: CellLoading::Edge, ..setting(2.0, slip, 1e-9) };
        let mut pulled = interface(&gaussian(0.1), None, coupling, edge);
        let found = events(&mut pulled, 8.0);
        assert_eq!(found.len(), slips.events.len());
        for (event, slip) in found.iter().zip(&slips.events) {
            assert_eq!(event.cells, cells);
            near(event.drive, slip.before.drive, 10.0 * lag);
            near(event.position_after, slip.after.position, 10.0 * lag);
            // The way to where balance is lost goes as the root of how well it is met.
            near(event.force_before / 4.0, slip.before.force, lag.sqrt());
        }
    }
}

/// At a fixed drive springs lose K_0 times the motion of all cells: of those that slipped, and of those that they pull along. The
/// drop is that one however coarse the drive at which balance is lost.
#[test]
fn springs_lose_what_cells_move_at_any_tolerance_of_the_drive() {
    let (cells, connection) = (100, 0.1);
    for tolerance in [1e-2, 1e-3, 1e-5] {
        let coupling = neighbours(Shape::Chain(cells), Edges::Open, 2.5).unwrap();
        let setting = setting(connection, CellSlip::Overdamped, tolerance);
        let mut chain = interface(&gaussian(0.1), Some(scales(cells, 0.15)), coupling, setting);
        let all = events(&mut chain, 12.0);
        assert!(all.len() > 3, "{tolerance}");
        // Events at one drive are of one slide, and share its drop.
        for slide in all.chunk_by(|a, b| a.drive == b.drive) {
            let least = connection * slide.iter().map(|event| event.moment).sum::<f64>();
            let drop = slide[0].drop();
            // Cells beside one that slips follow it, each by λ = 0.52 of the one before: λ + 1/λ = 2 + (K_0 + ⟨k⟩)/K_int. With
            // both sides that is 1 + 2λ/(1 − λ) = 3.2 times its own motion, and more where they are near their maximum.
            assert!(drop > 0.999 * least && drop < 4.5 * least, "{tolerance}: {drop} {least} {slide:?}");
        }
    }
}
