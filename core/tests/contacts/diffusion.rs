//! Diffusion in a potential: what it leaves alone, what it conserves, how fast it converges, and a closed form.

use std::sync::Arc;

use crate::common::finite_volumes::{Diffusion, DiffusionStep, NO_FLOOR, Work};
use asperity::numerics::diffusion::{Coefficients, MovingBoundary, MovingGrid, Potential, Workspace};

/// The normal distribution function.
fn phi(z: f64) -> f64 {
    0.5 * libm::erfc(-z / std::f64::consts::SQRT_2)
}

/// Thresholds in the potential of a Gaussian law around 1, on [0, 2].
fn gaussian(std: f64, cells: usize, diffusion: f64) -> Arc<Diffusion> {
    let width = 2.0 / cells as f64;
    let middle = |i: usize| (i as f64 + 0.5) * width;
    let potential: Vec<f64> = (0..cells).map(|i| ((middle(i) - 1.0) / std).powi(2) / 2.0).collect();
    Arc::new(Diffusion::new(0.0, width, &potential, diffusion))
}

/// Free diffusion on [0, `top`].
fn free(top: f64, cells: usize, diffusion: f64) -> Arc<Diffusion> {
    Arc::new(Diffusion::new(0.0, top / cells as f64, &vec![0.0; cells], diffusion))
}

/// Masses of a Gaussian law in the cells.
fn masses(operator: &Diffusion, mean: f64, std: f64) -> Vec<f64> {
    let below = |cell: usize| phi((operator.edge(cell) - mean) / std);
    (0..operator.cells()).map(|cell| below(cell + 1) - below(cell)).collect()
}

#[test]
fn the_stationary_law_stays_however_coarse_the_cells_and_long_the_steps() {
    for cells in [12, 200, 3000] {
        let operator = gaussian(0.05, cells, 0.0025);
        let stationary: Vec<f64> =
            (0..cells).map(|i| (-((operator.centre(i) - 1.0) / 0.05).powi(2) / 2.0).exp()).collect();
        let (largest, mut work) = (stationary.iter().fold(0.0_f64, |a, &b| a.max(b)), Work::default());
        for duration in [1e-6, 0.1, 1e3] {
            let (step, mut now) = (DiffusionStep::new(&operator, duration), stationary.clone());
            for _ in 0..10 {
                step.advance(&mut now, NO_FLOOR, &mut work);
            }
            // Rounding of forty eliminations.
            let error = now.iter().zip(&stationary).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-13 * largest, "{cells} {duration} {error:e}");
        }
    }
}

#[test]
fn nothing_is_lost_and_nothing_negative_in_wild_steps() {
    let operator = gaussian(0.1, 300, 0.01);
    let mut work = Work::default();
    for (duration, rise) in [(1e-4, 0.013), (0.1, 0.0007), (30.0, 0.1), (1e-9, 0.0066667), (0.5, 0.0)] {
        let step = DiffusionStep::new(&operator, duration);
        // All in one cell: nothing is less smooth.
        let mut now = vec![0.0; 300];
        now[70] = 1.0;
        let (mut floor, mut lost) = (0.3, 0.0);
        for _ in 0..60 {
            let absorbed = step.advance(&mut now, (floor, floor + rise), &mut work);
            assert!(absorbed >= 0.0, "{absorbed}");
            assert!(now.iter().all(|&m| m >= 0.0), "{duration} {rise}");
            floor += rise;
            lost += absorbed;
        }
        let whole = lost + now.iter().sum::<f64>();
        assert!((whole - 1.0).abs() < 1e-12, "{duration} {rise} {:e}", whole - 1.0);
    }
}

/// What is left of free contacts that start at `gap` above a floor which rises at the speed v, by L. Bachelier and
/// P. Lévy: Φ((y − vt)/√(2Dt)) − e^{vy/D} Φ(−(y + vt)/√(2Dt)).
fn bachelier_levy(gap: f64, speed: f64, diffusion: f64, time: f64) -> f64 {
    let spread = (2.0 * diffusion * time).sqrt();
    let back = (speed * gap / diffusion).exp() * phi(-(gap + speed * time) / spread);
    phi((gap - speed * time) / spread) - back
}

/// What is left above a floor that rises from 0.1 at speed 1 until t = 0.5, of masses spread as those that have come from
/// 0.6 by t = 0.02: the start of the closed form is no cell's.
fn left(cells: usize, steps: usize, diffusion: f64) -> f64 {
    let operator = free(3.0, cells, diffusion);
    let (start, end) = (0.02, 0.5);
    let spread = (2.0 * diffusion * start).sqrt();
    let mut now = masses(&operator, 0.6, spread);
    let duration = (end - start) / steps as f64;
    let (step, mut work) = (DiffusionStep::new(&operator, duration), Work::default());
    for k in 0..steps {
        let floor = |k: usize| 0.1 + start + duration * k as f64;
        step.advance(&mut now, (floor(k), floor(k + 1)), &mut work);
    }
    now.iter().sum()
}

#[test]
fn first_passage_of_a_rising_floor_is_that_of_bachelier_and_levy() {
    // Nothing has met the floor by t = 0.02 (to 1e-13), so that this start is the point's.
    for (diffusion, best) in [(0.1, 2e-6), (0.02, 3e-5)] {
        let exact = bachelier_levy(0.5, 1.0, diffusion, 0.5);
        let errors = [1, 2, 4].map(|fine| (left(300 * fine, 96 * fine, diffusion) - exact).abs());
        // Second order: a factor of 4, and what the next orders add at the coarsest.
        assert!(errors[0] / errors[1] > 3.8 && errors[1] / errors[2] > 3.8, "{errors:?}");
        // What remains of (Δ/(D/v))²: cells of 1/40 and 1/8 of the layer D/v above the floor.
        assert!(errors[2] < best, "{errors:?}");
    }
}

#[test]
fn cells_that_follow_leave_the_stationary_law_alone_while_the_floor_rests() {
    let potential = Potential::of(|h| (-0.5 * ((h - 1.0) / 0.05_f64).powi(2)).exp(), (0.0, 2.0), 8192);
    let medium = Coefficients { potential: &potential, diffusion: 0.0025, sink: None };
    for (count, finest) in [(16, 1.0), (200, 0.05), (3000, 1.0)] {
        let cells = MovingGrid::new(count, finest);
        let mut face = 0.1;
        let mass = |middle: f64| {
            // Halfway between the faces, of which the lowest is the floor.
            let width = 2.0 * (middle - face);
            face += width;
            width * (-potential.at(middle)).exp()
        };
        let stationary: Vec<f64> = cells.middles(0.1, 2.0).map(mass).collect();
        let largest = stationary.iter().fold(0.0_f64, |a, &b| a.max(b));
        for duration in [1e-6, 0.1, 1e3] {
            let (mut now, mut room) = (stationary.clone(), Workspace::default());
            let rest = MovingBoundary { floor: (0.1, 0.1), ceiling: 2.0, duration, absorbing: false };
            (0..10).for_each(|_| cells.advance(&rest, &medium, &mut now, &mut room));
            let error = now.iter().zip(&stationary).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // Rounding of widths computed from middles, each of which counts in all above it.
            assert!(error < 1e-10 * largest, "{count} {duration} {error:e}");
        }
    }
}

/// What is left above a floor as in [`left`], and the least mass of a cell, on cells that follow it.
fn left_of_followed(count: usize, steps: usize, diffusion: f64) -> (f64, f64) {
    let potential = Potential::of(|_| 1.0, (0.0, 3.0), 8192);
    let medium = Coefficients { potential: &potential, diffusion, sink: None };
    let (start, end, ceiling) = (0.02, 0.5, 3.0);
    let spread = (2.0 * diffusion * start).sqrt();
    let cells = MovingGrid::new(count, 0.2);
    let mut face = 0.1 + start;
    let mass = |middle: f64| {
        let low = face;
        face += 2.0 * (middle - face);
        phi((face - 0.6) / spread) - phi((low - 0.6) / spread)
    };
    let mut now: Vec<f64> = cells.middles(0.1 + start, ceiling).map(mass).collect();
    let (duration, mut room) = ((end - start) / steps as f64, Workspace::default());
    for k in 0..steps {
        let floor = |k: usize| 0.1 + start + duration * k as f64;
        let rise = MovingBoundary { floor: (floor(k), floor(k + 1)), ceiling, duration, absorbing: true };
        cells.advance(&rise, &medium, &mut now, &mut room);
    }
    (now.iter().sum(), now.iter().fold(0.0, |least, &mass| least.min(mass)))
}

#[test]
fn first_passage_is_of_fourth_order_where_cells_follow_the_floor_and_are_extrapolated() {
    for (diffusion, best) in [(0.1, 1e-7), (0.02, 3e-6)] {
        let exact = bachelier_levy(0.5, 1.0, diffusion, 0.5);
        let levels = [1, 2, 4].map(|fine| left_of_followed(60 * fine, 60 * fine, diffusion));
        // Of smooth masses none turns negative by more than rounding.
        assert!(levels.iter().all(|level| level.1 > -1e-15), "{levels:?}");
        let extrapolated =
            |coarse: (f64, f64), fine: (f64, f64)| (fine.0 + (fine.0 - coarse.0) / 3.0 - exact).abs();
        let errors = [extrapolated(levels[0], levels[1]), extrapolated(levels[1], levels[2])];
        // A factor of 8 for what is left of steps, of 16 for that of cells.
        assert!(errors[0] / errors[1] > 7.0 && errors[1] < best, "{errors:?}");
    }
}

#[test]
fn cells_that_follow_a_floor_that_reflects_lose_nothing() {
    let potential = Potential::of(|h| (-0.5 * ((h - 1.0) / 0.1_f64).powi(2)).exp(), (0.0, 2.0), 8192);
    let medium = Coefficients { potential: &potential, diffusion: 0.01, sink: None };
    let (cells, mut room) = (MovingGrid::new(300, 0.05), Workspace::default());
    let mut now = vec![1.0 / 300.0; 300];
    for (from, to, duration) in [(0.0, 0.3, 1e-3), (0.3, 0.31, 30.0), (0.31, 0.1, 0.1), (0.1, 0.9, 2.0)] {
        let rise = MovingBoundary { floor: (from, to), ceiling: 2.0, duration, absorbing: false };
        cells.advance(&rise, &medium, &mut now, &mut room);
        let whole: f64 = now.iter().sum();
        // Rounding.
        assert!((whole - 1.0).abs() < 1e-12, "{from} {to} {:e}", whole - 1.0);
    }
}
