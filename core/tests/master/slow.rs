//! Pulls over very many lives: contacts that heat breaks long before their thresholds, and a few strong ones that hold on.

use crate::common::{contacts, gaussian, initial, point};
use asperity::contacts::{Barrier, Contacts, Rules, Temperature};
use asperity::master::MasterEquation;

/// Lives last 1e-11 on average and up to 0.1. The force comes to that of steady sliding, nothing is lost on the way, and the
/// cells of the solution are as many as there are doublings of X, not as there are lives.
#[test]
fn a_pull_over_many_lives_is_solved_in_cells_that_grow() {
    let temperature = Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.21, 1.0) };
    let rules = Rules { temperature: Some(temperature), ..Rules::default() };
    let warm = Contacts { rules, ..contacts(&gaussian(1.0, 0.1), &point(0.0)) };
    let equation = MasterEquation::at(warm, &initial(&point(0.0)), 1e-12).unwrap();
    let life = equation.life().mean();
    let pull = equation.pull(5.0).unwrap();
    assert!(pull.cells() < 10_000, "{}", pull.cells());
    // Asked for, of the mean life.
    let allowed = 1e-10 * life;
    assert!(pull.error_estimate() < allowed, "{:e}", pull.error_estimate());
    let kinetic = equation.steady_state().kinetic_friction();
    assert!((pull.force(4.0) - kinetic).abs() < allowed, "{:e}", pull.force(4.0) - kinetic);
    for k in 0..36 {
        let position = life * 2.0_f64.powi(k);
        let lost = pull.total_probability(position) - 1.0;
        assert!(lost.abs() < 1e-10, "{lost:e} at X = {position:e}");
    }
}
