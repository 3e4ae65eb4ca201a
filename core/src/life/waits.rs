//! Lives of contacts that are free before they form, for an advance w that is drawn anew for each of them.
//!
//! With d the density of w and D̄ its survival, survival becomes D̄ + d ∗ S, the breaking density d ∗ φ, the carried force
//! f D̄ + d ∗ m with f the force of a free contact, and the energy of breaks to come e(0) D̄ + d ∗ e.

use std::sync::Arc;

use super::cells::{BULK, RESOLUTION, ROUNDING, resolved, with_atoms};
use super::panels::{Domain, Panels};
use super::{Life, ORDERS, jumps};
use crate::law::{Atom, Breakpoint, SharedLaw};
use crate::monitor::Watch;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;

/// The distribution of the advance for which contacts are free: that of the time, stretched by the velocity.
#[derive(Debug, Clone)]
pub(super) struct Waits {
    law: SharedLaw,
    velocity: f64,
    /// The density and its breakpoints, by advance.
    density: Piecewise,
    breakpoints: Vec<Breakpoint>,
    pub(super) atoms: Vec<Atom>,
}

/// Contacts that form after a wait.
#[derive(Debug, Clone)]
pub(super) struct DelayedLife {
    /// Their life from forming on.
    pub(super) formed: Arc<Life>,
    pub(super) waits: Waits,
}

impl Waits {
    pub(super) fn new(law: &SharedLaw, velocity: f64) -> Self {
        let mut density = resolved(law.as_ref(), BULK);
        density.boundaries.iter_mut().for_each(|edge| *edge *= velocity);
        density.coefficients.iter_mut().flatten().for_each(|c| *c /= velocity);
        let stretched = |b: Breakpoint| Breakpoint {
            position: velocity * b.position,
            amplitude: b.amplitude / velocity.powf(b.exponent + 1.0),
            ..b
        };
        let mut breakpoints: Vec<_> = with_atoms(law.as_ref()).into_iter().map(stretched).collect();
        Breakpoint::sort(&mut breakpoints);
        let atoms = breakpoints.iter().filter(|b| b.is_atom());
        let atoms = atoms.map(|b| Atom { position: b.position, weight: b.amplitude }).collect();
        Self { law: law.clone(), velocity, density, breakpoints, atoms }
    }

    /// D̄, the fraction that is still free after an advance.
    fn survival(&self, advance: f64) -> f64 {
        self.law.survival(advance / self.velocity)
    }

    /// The density of the advance without its point masses.
    pub(super) fn density(&self, advance: f64) -> f64 {
        self.density.value(advance)
    }

    /// The advances at which that is not smooth.
    pub(super) fn edges(&self) -> impl Iterator<Item = f64> + '_ {
        self.breakpoints.iter().map(|b| b.position)
    }

    /// The density as a kernel without point masses.
    pub(super) fn kernel(&self) -> Kernel {
        let breakpoints = self.breakpoints.iter().copied().filter(|b| !b.is_atom()).collect();
        Kernel::new(self.density.clone(), breakpoints)
    }

    fn end(&self) -> f64 {
        self.atoms.iter().map(|atom| atom.position).fold(self.density.end(), f64::max)
    }

    /// Breakpoints of the convolution with a kernel that begins at 0.
    fn breakpoints(&self, kernel: &Kernel) -> Vec<Breakpoint> {
        // A power that is not whole has no jumps; other breakpoints at 0 are among these.
        let there = |b: &Breakpoint| b.position == 0.0 && !b.is_atom();
        let steep = kernel.breakpoints().iter().any(|b| there(b) && b.is_steep());
        let start = if steep { Vec::new() } else { jumps(kernel.curve(), 0.0, ORDERS) };
        let others = kernel.breakpoints().iter().copied().filter(|b| steep || !there(b));
        let all: Vec<_> = others.chain(start).collect();
        let pairs = self.breakpoints.iter().flat_map(|own| all.iter().map(|b| own.convolve(*b)));
        sorted(pairs.filter(|b| b.amplitude != 0.0).collect())
    }

    /// The breakpoints of D̄ times a factor.
    fn ends(&self, factor: f64) -> impl Iterator<Item = Breakpoint> + '_ {
        let integrated = move |b: &Breakpoint| Breakpoint {
            exponent: b.exponent + 1.0,
            amplitude: -factor * b.amplitude,
            ..*b
        };
        self.breakpoints.iter().map(integrated).filter(|b| b.amplitude != 0.0)
    }
}

fn sorted(mut breakpoints: Vec<Breakpoint>) -> Vec<Breakpoint> {
    Breakpoint::sort(&mut breakpoints);
    breakpoints
}

/// The curves of a life.
const CURVES: usize = 6;

fn curves(life: &Life) -> [&Kernel; CURVES] {
    [&life.breaking, &life.survival, &life.force, &life.square, &life.energy, &life.breaking_energy]
}

/// d ∗ (the curves of a life), at any advance.
struct Convolution<'a> {
    life: &'a Life,
    waits: &'a Waits,
    panels: Panels<'a>,
    cuts: Vec<f64>,
    steep: Vec<f64>,
    end: f64,
}

impl<'a> Convolution<'a> {
    fn new(life: &'a Life, waits: &'a Waits) -> Self {
        let width = life.breaking.narrow_width(0.1).min(life.survival.narrow_width(0.1));
        let breaks = || curves(life).into_iter().flat_map(Kernel::breakpoints);
        let mut cuts: Vec<f64> = breaks().map(|b| b.position).collect();
        let mut steep: Vec<f64> = breaks().filter(|b| b.is_steep()).map(|b| b.position).collect();
        for places in [&mut cuts, &mut steep] {
            places.sort_by(f64::total_cmp);
            places.dedup();
        }
        let end = life.survival.curve().end();
        Self { life, waits, panels: Panels::new(&waits.density, width, 0.0), cuts, steep, end }
    }

    /// The curves at an advance, point masses of the breaking density left out.
    fn at(&self, u: f64) -> [f64; CURVES] {
        let kernels = curves(self.life);
        let mut sums = [0.0; CURVES];
        let mut add = |w: f64, weight: f64| {
            for (sum, kernel) in sums.iter_mut().zip(kernels) {
                *sum += weight * kernel.curve().value(u - w);
            }
        };
        let domain = Domain {
            low: (u - self.end).max(0.0),
            high: u,
            cuts: self.cuts.iter().map(|place| u - place).collect(),
            steep: self.steep.iter().map(|place| u - place).collect(),
        };
        self.panels.each(domain, &mut add);
        for atom in self.waits.atoms.iter().filter(|atom| atom.position <= u) {
            add(atom.position, atom.weight);
        }
        let together =
            self.life.breaking.atoms().map(|atom| atom.weight * self.waits.density(u - atom.position));
        sums[0] += together.sum::<f64>();
        sums
    }

    /// Cells: every breakpoint, and cells as narrow as those of the life and of the waits beside them.
    fn edges(&self, breakpoints: &[Breakpoint], end: f64) -> Vec<f64> {
        /// Breakpoints beside which cells are placed; beside more they are found by bisection.
        const FEW: usize = 8;
        let mut edges: Vec<f64> = breakpoints.iter().map(|b| b.position).collect();
        let own: Vec<f64> = self.waits.edges().collect();
        let beside = |places: &[f64], boundaries: &[f64]| -> Vec<f64> {
            let few = places.iter().take(FEW);
            few.flat_map(|place| boundaries.iter().map(move |edge| place + edge)).collect()
        };
        edges.extend(beside(&own, &self.life.survival.curve().boundaries));
        edges.extend(beside(&self.cuts, &self.waits.density.boundaries));
        edges.extend([0.0, end]);
        edges.retain(|&edge| (0.0..=end).contains(&edge));
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|b, a| *b - *a <= 1e-13 * b.abs());
        edges
    }
}

impl Life {
    /// The same contacts, each free for an advance drawn from `waits` before it forms, with a force `friction` meanwhile.
    pub(super) fn after(self, waits: Waits, friction: f64, watch: &Watch<'_>) -> Self {
        let convolution = Convolution::new(&self, &waits);
        let [whole, doomed] = [&self.survival, &self.breaking_energy].map(|kernel| kernel.curve().value(0.0));
        // What a free contact adds to each curve.
        let free = [0.0, whole, friction, friction * friction, 0.0, doomed];
        let breakpoints: [Vec<Breakpoint>; CURVES] = {
            let kernels = curves(&self);
            std::array::from_fn(|k| {
                sorted(waits.breakpoints(kernels[k]).into_iter().chain(waits.ends(free[k])).collect())
            })
        };
        let end = waits.end() + self.survival.curve().end();
        let all: Vec<Breakpoint> = breakpoints.iter().flatten().copied().collect();
        let edges = convolution.edges(&all, end);
        let value = |u: f64| {
            let mut sums = watch.value(|| convolution.at(u));
            let left = waits.survival(u);
            sums.iter_mut().zip(free).for_each(|(sum, free)| *sum += free * left);
            sums.to_vec()
        };
        // In units of the life: lengths of survival, force, and energies.
        let scale = self.force.curve().integral().abs() / self.mean();
        let sizes = [1.0 / self.mean(), 1.0, scale.max(friction), scale * scale, scale * scale, doomed];
        let limits = sizes.map(|size| (RESOLUTION * size.max(f64::MIN_POSITIVE) * self.mean(), size));
        let found = Piecewise::resolve_each(value, &edges, &limits);
        let mut kernels =
            found.into_iter().zip(breakpoints).map(|(curve, breaks)| Kernel::new(curve, breaks));
        let mut next = || kernels.next().expect("as many as there are curves");
        Self {
            breaking: next(),
            survival: next(),
            force: next(),
            square: next(),
            energy: next(),
            breaking_energy: next(),
            starts: self.starts.clone(),
            wait: 0.0,
            stiffness: self.stiffness,
            error: self.error + ROUNDING,
            waiting: Some(DelayedLife { formed: Arc::new(self), waits }),
        }
    }
}
