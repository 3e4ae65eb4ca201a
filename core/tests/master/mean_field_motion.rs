//! Contacts that share one distribution of thresholds at a velocity that varies, beside finite differences of the coupled
//! equations for P_c and Q, the steady closure, and contacts that do not age.

use std::sync::Arc;

use crate::common::gaussian;
use asperity::block::{Block, Loading, Slip};
use asperity::contacts::{Ageing, Contacts, FreeTime, Initial};
use asperity::elastic::{CellLoading, CellSlip};
use asperity::history::{History, Piece};
use asperity::law::{Lognormal, Point, Rectangular, SharedLaw};
use asperity::life::moving;
use asperity::master::{MasterEquation, Transport};
use asperity::rate_dependent::RateDependentContacts;
use asperity::scenario;

/// Thresholds between Gaussians, which mature at the rate 1.
const NEWBORN: (f64, f64) = (0.6, 0.08);
const MATURE: (f64, f64) = (1.0, 0.06);

fn point(place: f64) -> SharedLaw {
    Arc::new(Point::new(place).unwrap())
}

fn contacts(reforming: SharedLaw, delay: f64) -> Contacts {
    let mut contacts = Contacts::new(gaussian(NEWBORN.0, NEWBORN.1), reforming);
    let mature = gaussian(MATURE.0, MATURE.1);
    contacts.rules.ageing = Some(Ageing::MeanField { mature, diffusion: MATURE.1 * MATURE.1 });
    contacts.rules.delay = FreeTime::Fixed(delay);
    contacts
}

/// Finite differences of second order: P_c on cells, moved by Crank and Nicolson's rule; contacts in groups that formed in one
/// step and lose ½(P + P')dx of themselves in each.
#[derive(Clone)]
struct Differences {
    width: f64,
    density: Vec<f64>,
    fresh: Vec<f64>,
    /// Stretch and fraction of contacts.
    groups: Vec<(f64, f64)>,
    /// Contacts that broke, for each step of the delay.
    free: std::collections::VecDeque<f64>,
    reforming: f64,
}

impl Differences {
    fn new(reforming: f64, delayed: usize) -> Self {
        let width = 1.0 / 200.0;
        let bell = |j: usize| {
            let z = ((j as f64 + 0.5) * width - NEWBORN.0) / NEWBORN.1;
            (-0.5 * z * z).exp()
        };
        let fresh: Vec<f64> = (0..320).map(bell).collect();
        let mass: f64 = fresh.iter().sum::<f64>() * width;
        let fresh: Vec<f64> = fresh.iter().map(|p| p / mass).collect();
        Self {
            width,
            density: fresh.clone(),
            fresh,
            groups: vec![(0.0, 1.0)],
            free: vec![0.0; delayed].into(),
            reforming,
        }
    }

    /// On cells `finer` times as narrow.
    fn refined(mut self, finer: usize) -> Self {
        self.width /= finer as f64;
        let bell = |j: usize| {
            let z = ((j as f64 + 0.5) * self.width - NEWBORN.0) / NEWBORN.1;
            (-0.5 * z * z).exp()
        };
        let fresh: Vec<f64> = (0..320 * finer).map(bell).collect();
        let mass: f64 = fresh.iter().sum::<f64>() * self.width;
        self.fresh = fresh.iter().map(|p| p / mass).collect();
        self.density = self.fresh.clone();
        self
    }

    fn attached(&self) -> f64 {
        self.groups.iter().map(|group| group.1).sum()
    }

    fn force(&self) -> f64 {
        self.groups.iter().map(|(x, fraction)| x * fraction).sum()
    }

    /// P_c/S at stretches, S summed from the strongest contacts.
    fn hazards(&self, density: &[f64]) -> impl Fn(f64) -> f64 + use<> {
        let width = self.width;
        let mut above = vec![0.0; density.len() + 1];
        for j in (0..density.len()).rev() {
            above[j] = above[j + 1] + width * density[j];
        }
        let density = density.to_vec();
        move |x: f64| {
            // The density linear between the middles of cells, and S its integral from the middle of a cell.
            let place = (x / width - 0.5).max(0.0);
            let j = (place as usize).min(density.len() - 2);
            let t = place - j as f64;
            let (low, high) = (density[j], density[j + 1]);
            let middle = above[j] - width * (0.5 * low + (high - low) / 16.0);
            let p = low + t * (high - low);
            p / (middle - width * t * 0.5 * (low + p)).max(1e-300)
        }
    }

    /// P_c after a time in which the fraction `formed` of the attached contacts is new.
    fn matured(&self, during: f64, formed: f64) -> Vec<f64> {
        let (count, diffusion) = (self.density.len(), MATURE.1 * MATURE.1);
        let slope = |face: usize| (face as f64 * self.width - MATURE.0) / (MATURE.1 * MATURE.1);
        // dp_j/dt = a_j p_{j−1} + b_j p_j + c_j p_{j+1} from J = −D(U'p + p') at the faces, none at the ends.
        let part = |face: usize, sign: f64| diffusion / self.width * (0.5 * slope(face) + sign / self.width);
        let below = |j: usize| if j == 0 { 0.0 } else { -part(j, -1.0) };
        let over = |j: usize| if j + 1 == count { 0.0 } else { part(j + 1, 1.0) };
        let own = |j: usize| {
            let down = if j == 0 { 0.0 } else { -part(j, 1.0) };
            let up = if j + 1 == count { 0.0 } else { part(j + 1, -1.0) };
            down + up - formed / during
        };
        let p = |j: usize| self.density[j];
        let half = 0.5 * during;
        let mut right: Vec<f64> = (0..count)
            .map(|j| {
                let mut change = own(j) * p(j);
                if j > 0 {
                    change += below(j) * p(j - 1);
                }
                if j + 1 < count {
                    change += over(j) * p(j + 1);
                }
                p(j) + half * change + formed * self.fresh[j]
            })
            .collect();
        // Thomas's elimination.
        let mut upper = vec![0.0; count];
        for j in 0..count {
            let before = if j == 0 { (0.0, 0.0) } else { (upper[j - 1], right[j - 1]) };
            let pivot = 1.0 - half * own(j) + half * below(j) * before.0;
            upper[j] = -half * over(j) / pivot;
            right[j] = (right[j] + half * below(j) * before.1) / pivot;
        }
        for j in (0..count - 1).rev() {
            right[j] -= upper[j] * right[j + 1];
        }
        right
    }

    fn step(&mut self, by: f64, during: f64) {
        let before = self.hazards(&self.density);
        let (mut density, mut broken, mut left) = (self.density.clone(), 0.0, self.groups.clone());
        let attached = self.attached();
        // Breaks and P_c at the end of the step depend on each other.
        for _ in 0..if by == 0.0 { 1 } else { 6 } {
            let after = self.hazards(&density);
            let moved = |&(x, fraction): &(f64, f64)| {
                (x + by, fraction * (-0.5 * by * (before(x) + after(x + by))).exp())
            };
            left = self.groups.iter().map(moved).collect();
            let holding: f64 = left.iter().map(|group| group.1).sum();
            broken = attached - holding;
            let formed = self.free.front().copied().unwrap_or(broken);
            density = self.matured(during, formed / (attached + 0.5 * (formed - broken)));
        }
        self.free.push_back(broken);
        let formed = self.free.pop_front().unwrap();
        left.push((self.reforming + 0.5 * by, formed));
        left.retain(|group| group.1 > 1e-17);
        (self.groups, self.density) = (left, density);
    }

    /// The forces at the ends of pieces (velocity, distance or, at rest, duration) in steps of `by`, or in as many at rest.
    fn forces(mut self, pieces: &[(f64, f64)], finer: usize) -> Vec<f64> {
        let mut forces = Vec::new();
        for &(velocity, length) in pieces {
            let steps = ((if velocity > 0.0 { 100.0 } else { 20.0 }) * length).round() as usize * finer;
            for _ in 0..steps {
                let part = length / steps as f64;
                if velocity > 0.0 { self.step(part, part / velocity) } else { self.step(0.0, part) }
            }
            forces.push(self.force());
        }
        forces
    }
}

/// The limit of solutions on cells so many times as narrow: errors of second and fourth order drop out.
fn extrapolated(finer: [usize; 3], found: [f64; 3]) -> f64 {
    let squares = finer.map(|finer| (finer * finer) as f64);
    let factor = |i: usize, j: usize| if i == j { 1.0 } else { squares[i] / (squares[i] - squares[j]) };
    (0..3).map(|i| (0..3).map(|j| factor(i, j)).product::<f64>() * found[i]).sum()
}

fn history(pieces: &[(f64, f64)]) -> (History, Vec<f64>) {
    let piece = |&(velocity, length): &(f64, f64)| {
        let duration = if velocity > 0.0 { length / velocity } else { length };
        Piece { velocity, duration }
    };
    let pieces: Vec<Piece> = pieces.iter().map(piece).collect();
    let ends = pieces.iter().scan(0.0, |time, piece| {
        *time += piece.duration;
        Some(*time)
    });
    let ends = ends.collect();
    (History::new(pieces).unwrap(), ends)
}

/// The forces of a transport with shared thresholds, and its own estimate of their error.
fn followed(contacts: Contacts, pieces: &[(f64, f64)], tolerance: f64) -> (Vec<f64>, f64) {
    let (motion, ends) = history(pieces);
    let mut transport = Transport::new_with(contacts, &Initial::default(), tolerance, &mut ()).unwrap();
    let trace = transport.follow(&motion, &ends).unwrap();
    (trace.force, trace.error)
}

#[test]
fn motion_is_that_of_the_coupled_equations_in_finite_differences() {
    // Velocity steps up and down, and a hold.
    let pieces = [(1.0, 0.7), (0.1, 0.4), (2.0, 0.6), (0.0, 1.0), (0.5, 0.7)];
    let forces = |finer: usize| Differences::new(0.0, 0).refined(finer).forces(&pieces, finer);
    let finer = [2, 3, 4];
    let [coarse, middle, fine] = finer.map(forces);
    let (found, error) = followed(contacts(point(0.0), 0.0), &pieces, 1e-7);
    assert!(error < 1e-7, "{error:e}");
    for (k, found) in found.iter().enumerate() {
        // Differences are of second order: the changes are as 1/4 − 1/9 to 1/9 − 1/16.
        let ratio = (coarse[k] - middle[k]) / (middle[k] - fine[k]);
        assert!((ratio - 20.0 / 7.0).abs() < 0.1, "{k}: {ratio}");
        let expected = extrapolated(finer, [coarse[k], middle[k], fine[k]]);
        // The extrapolated error of sixth order is below 1e-9; what the transport is off by is a tenth of its tolerance or less.
        assert!((found - expected).abs() < 4e-9, "{k}: {found} {expected}");
    }
}

#[test]
fn contacts_that_reform_stretched_and_late_follow_the_same_equations() {
    // Two velocities where contacts re-form at once; a delay of whole steps at one velocity.
    let at_once: &[(f64, f64)] = &[(1.0, 0.8), (0.2, 0.9)];
    let late: &[(f64, f64)] = &[(0.8, 0.8), (0.8, 0.7), (0.8, 1.4)];
    for (reforming, delay, pieces) in [(0.2, 0.0, at_once), (0.1, 0.25_f64, late)] {
        let delayed = (100.0 * delay * pieces[0].0).round() as usize;
        let forces =
            |finer: usize| Differences::new(reforming, delayed * finer).refined(finer).forces(pieces, finer);
        let finer = [1, 2, 3];
        let [coarse, middle, fine] = finer.map(forces);
        let (found, _) = followed(contacts(point(reforming), delay), pieces, 1e-7);
        for (k, found) in found.iter().enumerate() {
            let expected = extrapolated(finer, [coarse[k], middle[k], fine[k]]);
            // What the tolerance of the transport allows; the extrapolated error of sixth order is some 3e-9.
            assert!((found - expected).abs() < 5e-8, "{reforming} {k}: {found} {expected}");
        }
    }
}

/// F_k of the steady closure.
fn kinetic_friction(contacts: &Contacts, velocity: f64) -> f64 {
    let life = moving(contacts, &contacts.reforming, true, velocity, true, &mut ()).unwrap();
    life.force().curve().integral() / life.survival().curve().integral()
}

#[test]
fn long_sliding_has_the_force_of_the_steady_closure() {
    let wide = |low: f64, high: f64| Arc::new(Rectangular::new(low, high).unwrap()) as SharedLaw;
    // So broad that deviations from steady sliding decay within less than a life.
    let aged = |thresholds: SharedLaw, mature: SharedLaw, reforming: SharedLaw, delay: f64| {
        let mut contacts = Contacts { thresholds, ..contacts(reforming, delay) };
        contacts.rules.ageing = Some(Ageing::MeanField { mature, diffusion: 0.04 });
        contacts
    };
    let between = |reforming, delay| aged(gaussian(0.6, 0.15), gaussian(1.0, 0.2), reforming, delay);
    let lognormal = |mean, std| Arc::new(Lognormal::new(mean, std).unwrap()) as SharedLaw;
    let heavy = aged(lognormal(0.7, 0.3), lognormal(1.2, 0.4), wide(0.0, 0.3), 0.0);
    let edged = aged(wide(0.4, 0.9), gaussian(1.0, 0.2), point(0.0), 0.0);
    // Contacts whose thresholds jump are followed to second order in time: the tolerance is larger, the way shorter.
    for (contacts, velocity, tolerance, way) in [
        (between(point(0.0), 0.0), 0.1, 1e-6, 15.0),
        (between(point(0.0), 0.0), 1.0, 1e-6, 15.0),
        (between(wide(0.1, 0.5), 0.0), 1.0, 1e-6, 15.0),
        (between(point(0.1), 0.3), 1.0, 1e-6, 15.0),
        (edged, 1.0, 3e-4, 8.0),
        (heavy, 0.1, 1e-6, 15.0),
    ] {
        // So many lives that deviations decay to less than the tolerance.
        let (found, _) = followed(contacts.clone(), &[(5.0 * velocity, 1.0), (velocity, way)], tolerance);
        let expected = kinetic_friction(&contacts, velocity);
        // The finer of two solutions, of which the coarser is held to the tolerance, is off by less than a tenth of it.
        assert!((found[1] - expected).abs() < 0.2 * tolerance, "{velocity}: {:e}", found[1] - expected);
    }
}

#[test]
fn a_steady_start_stays() {
    let wide: SharedLaw = Arc::new(Rectangular::new(0.1, 0.5).unwrap());
    // One or two lives at least; what is not steady shows within one.
    for (contacts, velocity, distance) in [
        (contacts(point(0.0), 0.0), 0.1, 2.0),
        (contacts(wide, 0.0), 1.0, 1.0),
        (contacts(point(0.0), 0.5), 1.0, 2.0),
    ] {
        let tolerance = 1e-7;
        let mut transport = Transport::steady_with(&contacts, velocity, tolerance, &mut ()).unwrap();
        let expected = kinetic_friction(&contacts, velocity);
        assert!((transport.force() - expected).abs() < tolerance, "{:e}", transport.force() - expected);
        let (motion, _) = history(&[(velocity, distance)]);
        let times: Vec<f64> = (1..=20).map(|k| f64::from(k) * 0.05 * distance / velocity).collect();
        for force in transport.follow(&motion, &times).unwrap().force {
            // What the tolerance allows.
            assert!((force - expected).abs() < tolerance, "{:e}", force - expected);
        }
    }
}

#[test]
fn thresholds_that_hardly_diffuse_give_the_pull_of_contacts_that_do_not_age() {
    let mut slow = contacts(point(0.0), 0.0);
    slow.rules.ageing = Some(Ageing::MeanField { mature: gaussian(1.0, 0.1), diffusion: 1e-14 });
    let (motion, _) = history(&[(1.0, 1.5)]);
    let times: Vec<f64> = (1..=30).map(|k| 0.05 * f64::from(k)).collect();
    let mut transport = Transport::new_with(slow, &Initial::default(), 1e-8, &mut ()).unwrap();
    let found = transport.follow(&motion, &times).unwrap().force;
    let bare = Contacts::new(gaussian(NEWBORN.0, NEWBORN.1), point(0.0));
    let pull = MasterEquation::new(bare, &Initial::default()).unwrap().pull(1.5).unwrap();
    for (x, found) in times.iter().zip(found) {
        // The tolerance; readings lie inside steps.
        assert!((found - pull.force(*x)).abs() < 1e-8, "{x}: {:e}", found - pull.force(*x));
    }
}

#[test]
fn errors_fall_with_the_tolerance_and_are_estimated() {
    let pieces = [(1.0, 0.9), (0.01, 0.6), (0.0, 100.0), (1.0, 0.7)];
    // A tenth of the smallest tolerance below, or less.
    let (exact, _) = followed(contacts(point(0.0), 0.0), &pieces, 1e-7);
    for tolerance in [1e-4, 1e-5, 1e-6] {
        let (found, error) = followed(contacts(point(0.0), 0.0), &pieces, tolerance);
        let off = found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // The mean threshold, the unit of the tolerance, is 0.6.
        assert!(off < 0.6 * tolerance && off < error, "{tolerance}: {off:e} {error:e}");
    }
}

#[test]
fn a_block_moves_as_in_finite_differences() {
    let (stiffness, damping, velocity) = (8.0, 2.0, 0.5_f64);
    let (driven, held) = (1.4_f64, 0.8_f64);
    // X by the implicit midpoint rule: γ by/dt = K(X_T − X) − F at the middle of the step.
    let follow = |finer: usize| {
        let mut slider = Differences::new(0.0, 0).refined(finer);
        let (mut position, mut drive, mut found) = (0.0, 0.0, Vec::new());
        for (moving, duration) in [(velocity, driven / velocity), (0.0_f64, held)] {
            let steps = (80.0 * duration).round() as usize * finer;
            let during = duration / steps as f64;
            for _ in 0..steps {
                let (mut by, force) = (0.5 * during * velocity, slider.force());
                let mut next = slider.clone();
                for _ in 0..12 {
                    next = slider.clone();
                    next.step(by, during);
                    let spring = stiffness * (drive + 0.5 * during * moving - position - 0.5 * by);
                    by = during / damping * (spring - 0.5 * (force + next.force()));
                }
                (slider, position, drive) = (next, position + by, drive + during * moving);
            }
            found.push((position, slider.force()));
        }
        found
    };
    let [coarse, fine] = [1, 2].map(follow);
    let start = Initial::default();
    let transport = Transport::new_with(contacts(point(0.0), 0.0), &start, 1e-7, &mut ()).unwrap();
    let block = Block::new(Loading::Spring(stiffness), Slip::Damped { damping }, None).unwrap();
    let pieces =
        [(velocity, driven / velocity), (0.0, held)].map(|(velocity, duration)| Piece { velocity, duration });
    let motion = History::new(pieces.into()).unwrap();
    let times = [driven / velocity, driven / velocity + held];
    let run = block.follow_with(&transport, &motion, &times, 1e-7, &mut ()).unwrap();
    for (k, time) in times.iter().enumerate() {
        let moment = run.trace.iter().find(|moment| moment.time == *time).unwrap();
        let extrapolated = |of: fn(&(f64, f64)) -> f64| (4.0 * of(&fine[k]) - of(&coarse[k])) / 3.0;
        let (position, force) = (extrapolated(|one| one.0), extrapolated(|one| one.1));
        // Some tens of tolerances of the motion, of whose steps there are hundreds.
        assert!((moment.position - position).abs() < 5e-6, "{k}: {} {position}", moment.position);
        assert!((moment.force - force).abs() < 5e-6, "{k}: {} {force}", moment.force);
    }
}

#[test]
fn alike_cells_of_an_interface_are_a_block_after_a_steady_start_and_a_hold() {
    let (velocity, connection, viscosity, tolerance) = (0.2, 1.0, 1.0, 1e-4);
    let scales = vec![1.0; 3];
    let own = scenario::Interface {
        cells: vec![3],
        contacts: scenario::PerCell::Many,
        connection,
        coupling: scenario::Elasticity::Neighbours { stiffness: 1.0 },
        edges: scenario::Edges::Open,
        loading: CellLoading::Uniform,
        slip: Some(CellSlip::Overdamped),
        viscosity: Some(viscosity),
        disorder: Some(scenario::Scales { scale: Some(scales), ..scenario::Scales::default() }),
        areas: None,
        drive_tolerance: 1e-6,
        catalogue_from: 0.0,
        mass: None,
        slip_rates: None,
        main_shocks: None,
    };
    let described = scenario::Contacts {
        thresholds: Some(scenario::Law::Gaussian { mean: 0.6, std: 0.15 }),
        ageing: Some(scenario::Ageing::MeanField {
            mature: scenario::Law::Gaussian { mean: 1.0, std: 0.2 },
            diffusion: 0.04,
        }),
        ..scenario::Contacts::default()
    };
    let moving = |velocity: f64, distance: f64, points: usize| scenario::Step {
        points,
        ..scenario::Step::moving(velocity, distance / velocity)
    };
    let steps = vec![
        scenario::Step { start: Some(scenario::TaskStart::Steady), ..moving(velocity, 0.2, 3) },
        scenario::Step { hold: Some(5.0), points: 6, ..scenario::Step::default() },
        moving(2.0 * velocity, 1.5, 31),
    ];
    let protocol = scenario::Protocol(steps);
    let mut chain = scenario::Scenario {
        interface: Some(own),
        protocol: Some(protocol.clone()),
        ..scenario::Scenario::new(described)
    };
    chain.master_equation.tolerance = Some(tolerance);
    let model = chain.build().unwrap();
    let transport = Transport::steady_with(&model.contacts, velocity, tolerance, &mut ()).unwrap();
    let unchecked =
        scenario::Model { master_equation: scenario::MasterEquation { tolerance: None }, ..model };
    let record = protocol.run_interface(&unchecked, &mut ()).unwrap().record;
    let block = Block::new(Loading::Spring(connection), Slip::Damped { damping: viscosity }, None).unwrap();
    let times = protocol.times();
    let run = block.follow_with(&transport, &protocol.build().unwrap(), &times, tolerance, &mut ()).unwrap();
    let forces = record.values("force").unwrap();
    assert_eq!(forces.len(), times.len());
    for (time, force) in times.iter().zip(forces) {
        let expected = run.trace.iter().find(|moment| moment.time == *time).unwrap().force;
        // Two solvers of the same equation, each within some tolerances, for three cells.
        assert!((force - 3.0 * expected).abs() < 10.0 * tolerance, "{time}: {force} {}", 3.0 * expected);
    }
}

#[test]
fn a_state_that_is_restored_goes_on_as_before() {
    let aged = contacts(point(0.0), 0.1);
    let start = || Transport::new_with(aged.clone(), &Initial::default(), 1e-5, &mut ()).unwrap();
    let mut one = start();
    one.step(0.9, 1.0, &mut ()).unwrap();
    let state = one.state();
    let mut other = start();
    other.restore(&state).unwrap();
    one.step(0.5, 2.0, &mut ()).unwrap();
    other.step(0.5, 2.0, &mut ()).unwrap();
    assert_eq!(one.force().to_bits(), other.force().to_bits());
    // A state without ages belongs to other contacts.
    let bare = Contacts::new(gaussian(NEWBORN.0, NEWBORN.1), point(0.0));
    let mut bare = Transport::new_with(bare, &Initial::default(), 1e-5, &mut ()).unwrap();
    assert!(bare.restore(&state).is_err());
}
