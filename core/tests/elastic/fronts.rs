//! Where slips nucleate on a chain and on a half-space, and how fast and under which force they spread.

use std::f64::consts::PI;

use crate::common::curve::gaussian;
use crate::common::polyline::Polyline;
use crate::common::sliders::{interface, setting};
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::{CellSlip, Coupling, Event, Interface, InterfaceParameters};
use asperity::exact::{ClosedForm, Gaussian};
use asperity::monitor::Monitor;
use asperity::shape::{Edges, Shape};

/// Springs between neighbours and from the outermost cells to walls.
#[derive(Debug)]
struct BetweenWalls {
    cells: usize,
    stiffness: f64,
}

impl Coupling for BetweenWalls {
    fn shape(&self) -> Shape {
        Shape::Chain(self.cells)
    }

    fn edges(&self) -> Edges {
        Edges::Open
    }

    fn forces(&mut self, x: &[f64], forces: &mut [f64], _monitor: &mut dyn Monitor) -> asperity::Result<()> {
        let at = |j: Option<usize>| j.and_then(|j| x.get(j)).copied().unwrap_or(0.0);
        for j in 0..self.cells {
            forces[j] = self.stiffness * (at(j.checked_sub(1)) + at(Some(j + 1)) - 2.0 * x[j]);
        }
        Ok(())
    }

    fn precondition(
        &mut self,
        diagonal: f64,
        right: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> asperity::Result<bool> {
        Ok(self.solve_variable(&vec![diagonal; self.cells], right, 0.0, monitor)?.is_some())
    }

    fn solve_variable(
        &mut self,
        springs: &[f64],
        right: &mut [f64],
        _goal: f64,
        _monitor: &mut dyn Monitor,
    ) -> asperity::Result<Option<usize>> {
        let mut pivots: Vec<f64> = Vec::new();
        for j in 0..self.cells {
            let ratio = pivots.last().map_or(0.0, |last| self.stiffness / last);
            right[j] += if j > 0 { ratio * right[j - 1] } else { 0.0 };
            pivots.push(springs[j] + self.self_stiffness(j) - ratio * self.stiffness);
        }
        for j in (0..self.cells).rev() {
            let next = right.get(j + 1).copied().unwrap_or(0.0);
            right[j] = (right[j] + self.stiffness * next) / pivots[j];
        }
        Ok(pivots.iter().all(|pivot| *pivot > 0.0).then_some(1))
    }

    fn self_stiffness(&self, _cell: usize) -> f64 {
        2.0 * self.stiffness
    }
}

/// A half-space over a row of cells beyond whose ends nothing moves, or everything does so oppositely, mirrored: half a wave
/// fits between such mirrors.
#[derive(Debug)]
struct Beside {
    cells: usize,
    mirrored: bool,
    /// The cells and, behind one at rest, what is beside them.
    ring: Box<dyn Coupling>,
}

impl Beside {
    fn mirrors(cells: usize, modulus: f64) -> Self {
        Self { cells, mirrored: true, ring: ring(2 * (cells + 1), modulus) }
    }

    /// The ring, seen from far away, takes (π²/6 · 4/πR)/2.3 of the stiffness of cells on its Rth part: 0.2 %.
    fn held(cells: usize, modulus: f64) -> Self {
        Self { cells, mirrored: false, ring: ring(16 * cells, modulus) }
    }

    fn whole(&self, values: &[f64]) -> Vec<f64> {
        let mut whole = vec![0.0; self.ring.shape().size()];
        whole[1..=self.cells].copy_from_slice(values);
        if self.mirrored {
            let images = whole[self.cells + 2..].iter_mut().rev();
            images.zip(values).for_each(|(image, value)| *image = -value);
        }
        whole
    }
}

fn ring(cells: usize, modulus: f64) -> Box<dyn Coupling> {
    half_space(Shape::Chain(cells), Edges::Periodic, modulus, 1.0).unwrap()
}

impl Coupling for Beside {
    fn shape(&self) -> Shape {
        Shape::Chain(self.cells)
    }

    fn edges(&self) -> Edges {
        Edges::Open
    }

    fn forces(&mut self, x: &[f64], forces: &mut [f64], monitor: &mut dyn Monitor) -> asperity::Result<()> {
        let mut whole = vec![0.0; self.ring.shape().size()];
        self.ring.forces(&self.whole(x), &mut whole, monitor)?;
        forces.copy_from_slice(&whole[1..=self.cells]);
        Ok(())
    }

    fn precondition(
        &mut self,
        diagonal: f64,
        right: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> asperity::Result<bool> {
        let mut whole = self.whole(right);
        self.ring.precondition(diagonal, &mut whole, monitor)?;
        right.copy_from_slice(&whole[1..=self.cells]);
        Ok(false)
    }

    /// But for its image.
    fn self_stiffness(&self, cell: usize) -> f64 {
        self.ring.self_stiffness(cell + 1)
    }
}

/// Contacts that weaken from the start, by −F' = 2.
fn falling() -> Polyline {
    Polyline::new(1.0, &[(0.3, -2.0), (f64::INFINITY, 1.0)])
}

/// Events of weakening cells until the drive has gone on by 0.01.
fn weakening(coupling: Box<dyn Coupling>, connection: f64) -> usize {
    let mut patch = interface(&falling(), None, coupling, setting(connection, CellSlip::Overdamped, 1e-6));
    let mut events = 0;
    let end = patch.drive() + 0.01;
    patch.run(end, &mut |_, _| events += 1).unwrap();
    events
}

/// Checks that patches longer than a length give way, and shorter ones do not, to 2 %.
#[track_caller]
fn nucleate(length: f64, connection: f64, patch: impl Fn(usize) -> Box<dyn Coupling>) {
    let [short, long] = [0.98, 1.02].map(|part| (part * length).round() as usize);
    assert_eq!(weakening(patch(short), connection), 0, "{short} cells, ℓ_c = {length}");
    assert!(weakening(patch(long), connection) > 0, "{long} cells, ℓ_c = {length}");
}

#[test]
fn slips_nucleate_in_patches_of_half_a_wavelength() {
    for (stiffness, connection) in [(2000.0, 0.1), (3000.0, 1.0)] {
        let length = PI * f64::sqrt(stiffness / (2.0 - connection));
        nucleate(length, connection, |cells| Box::new(BetweenWalls { cells, stiffness }));
    }
    for (modulus, connection) in [(100.0, 0.1), (60.0, 1.0)] {
        let length = PI * modulus / (2.0 - connection);
        nucleate(length, connection, |cells| Box::new(Beside::mirrors(cells, modulus)));
    }
}

/// √−Δ on an interval of length 2, with nothing outside, has the least eigenvalue 1.1577738837 (M. Kwaśnicki, J. Funct.
/// Anal. 262, 2379 (2012), doi:10.1016/j.jfa.2011.12.004), where half a wave has π/2.
#[test]
fn slips_nucleate_on_a_half_space_in_shorter_patches_if_nothing_moves_beside_them() {
    const LEAST: f64 = 1.157_773_883_7;
    for (modulus, connection) in [(100.0, 0.1), (60.0, 1.0)] {
        let length = 2.0 * LEAST * modulus / (2.0 - connection);
        nucleate(length, connection, |cells| Box::new(Beside::held(cells, modulus)));
    }
}

/// The position in a bracket where the curve of σ = 0.1 has this force.
fn place(force: f64, mut low: f64, mut high: f64) -> f64 {
    let curve = Gaussian::new(1.0, 0.1);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if curve.force(middle) < force { low = middle } else { high = middle }
    }
    low
}

/// A chain under a constant force on each cell, 40 of its cells one generation of contacts ahead.
fn split(stiffness: f64, force: f64) -> (Interface, usize) {
    const SOFT: f64 = 1e-7;
    let (ahead, cells) = (40, 160);
    let coupling = neighbours(Shape::Chain(cells), Edges::Open, stiffness).unwrap();
    let timed = InterfaceParameters { viscosity: Some(1.0), ..setting(SOFT, CellSlip::Overdamped, 1e-6) };
    let mut chain = interface(&gaussian(0.1), None, coupling, timed);
    let (front, rest) = (place(force, 1.25, 1.7), place(force, 0.0, 0.84));
    let positions: Vec<f64> = (0..cells).map(|j| if j < ahead { front } else { rest }).collect();
    chain.put(force / SOFT, &positions).unwrap();
    (chain, ahead)
}

/// Cells per time at which slip spreads, between the 20th and the 60th cell that it reaches; 0 where it reaches fewer
/// than 20.
fn speed(stiffness: f64, above: f64) -> f64 {
    let maxwell = 0.5 + 0.1 * 0.1;
    let (mut chain, ahead) = split(stiffness, maxwell + above);
    let drive = chain.drive();
    let mut starts = vec![f64::NAN; chain.len()];
    let mut largest: Option<Event> = None;
    chain
        .run(drive, &mut |event, slipped| {
            slipped.iter().for_each(|s| starts[s.cell] = s.start);
            largest = largest.filter(|before| before.cells > event.cells).or(Some(*event));
        })
        .unwrap();
    if starts[ahead + 20].is_nan() {
        return 0.0;
    }
    let found = 40.0 / (starts[ahead + 60] - starts[ahead + 20]);
    // The catalogue fits the middle half of all cells: the speed is uniform there to 1 %.
    let reported = largest.map_or(f64::NAN, |event| event.front_speed_right);
    assert!((reported / found - 1.0).abs() < 0.01, "the catalogue has {reported}, cells slipped at {found}");
    found
}

/// A slide is over where the residual has fallen to a hundredth of its largest. It falls like e^{−λt}, λ = (F' + K_0)/η, on a
/// straight piece of the curve, so that slopes F' behind the same fall change the duration by ln 100 · Δ(1/λ).
#[test]
fn slides_are_over_where_a_hundredth_of_the_force_is_left() {
    let connection = 0.5;
    let duration = |slope: f64| {
        let curve = Polyline::new(1.0, &[(0.3, -2.0), (f64::INFINITY, slope)]);
        let coupling = neighbours(Shape::Chain(2), Edges::Open, 1.0).unwrap();
        let timed =
            InterfaceParameters { viscosity: Some(1.0), ..setting(connection, CellSlip::Overdamped, 1e-6) };
        let mut pair = interface(&curve, None, coupling, timed);
        let end = pair.drive() + 0.01;
        let mut durations = Vec::new();
        pair.run(end, &mut |event, _| durations.push(event.duration)).unwrap();
        durations[0]
    };
    let expected = 100.0_f64.ln() * (1.0 / (1.0 + connection) - 1.0 / (3.0 + connection));
    let found = duration(1.0) - duration(3.0);
    // The end is that of a time step; steps are some percent of 1/λ.
    assert!((found / expected - 1.0).abs() < 0.05, "{found} instead of {expected}");
}

#[test]
fn fronts_advance_above_the_force_of_equal_areas() {
    assert_eq!(speed(25.0, -0.01), 0.0);
    for (above, expected) in [(0.01, 0.2085), (0.03, 0.629), (0.08, 1.702)] {
        let found = speed(25.0, above);
        // The reference is accurate to 1 %, and so is a speed from the drive at which cells begin to slip.
        assert!((found / expected - 1.0).abs() < 0.02, "{found} instead of {expected}");
    }
}

#[test]
fn coarse_chains_pin_fronts() {
    assert_eq!(speed(1.0, 0.03), 0.0);
    let found = speed(1.0, 0.08);
    // The reference is accurate to 1 %, and so is a speed from the drive at which cells begin to slip.
    assert!((found / 0.219 - 1.0).abs() < 0.02, "{found} instead of 0.219");
    assert_eq!(speed(0.25, 0.08), 0.0);
}
