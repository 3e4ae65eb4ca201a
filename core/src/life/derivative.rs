//! How the life of contacts changes with a parameter.

use super::Life;
use super::advance_map::AdvanceMap;
use super::cells::{BULK, CELL, edges, scale, threshold_atoms, with_atoms};
use super::layer::{Layer, PointMass};
use super::start_quadrature::StartQuadrature;
use crate::Result;
use crate::contacts::Contacts;
use crate::law::{Breakpoint, Law, SharedLaw, SurvivalDerivative};
use crate::monitor::{Monitor, Watch};
use crate::numerics::legendre::{NODES, Nodal, RULE};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;
use crate::numerics::wide::vectorised;

/// The derivatives of survival and of the carried force by a parameter θ, as functions of the advance u, per
/// contact and unit stiffness.
#[derive(Debug, Clone)]
pub(crate) struct LifeDerivative {
    survival: Kernel,
    force: Kernel,
}

/// Time-independent contacts of equal stiffness that start at stretches drawn from a distribution, and their life.
#[derive(Clone, Copy)]
pub(crate) struct StartingContacts<'a> {
    pub(crate) contacts: &'a Contacts,
    pub(crate) starts: &'a SharedLaw,
    /// Whether thresholds are drawn given that they exceed the starting stretch.
    pub(crate) conditional: bool,
    pub(crate) life: &'a Life,
}

/// Truncation error of a derivative, relative to its largest value and the mean life.
const RESOLUTION: f64 = 1e-13;

/// The same of tables of what is integrated, relative to the largest value and the smallest scale of the thresholds.
const TABLE: f64 = 1e-14;

impl LifeDerivative {
    /// ∂S/∂θ.
    pub(crate) fn survival(&self) -> &Kernel {
        &self.survival
    }

    /// ∂m/∂θ.
    pub(crate) fn force(&self) -> &Kernel {
        &self.force
    }

    /// From the curves of survival and force on cells that end where the life is not smooth.
    fn of_curves(life: &Life, curves: [Piecewise; 2]) -> Self {
        // The derivative at a point that moves with θ is one order less smooth than the life; jumps are left out.
        let rougher = |b: &Breakpoint| Breakpoint {
            exponent: if b.exponent == 0.0 { 0.0 } else { b.exponent - 1.0 },
            ..*b
        };
        let of = |kernel: &Kernel| kernel.breakpoints().iter().map(rougher).collect();
        let [survival, force] = curves;
        Self {
            survival: Kernel::new(survival, of(life.survival())),
            force: Kernel::new(force, of(life.force())),
        }
    }

    /// By differences of lives on the cells of `life`.
    ///
    /// With ψ the map of advances that follows the points at which lives are not smooth, S_θ = ∂/∂θ \[S(ψ(u))\] − S' ∂ψ/∂θ. Both
    /// derivatives by θ are differences of smooth functions, also where an edge passes the advance u.
    pub(crate) fn by_differences(life: &Life, pairs: &[LifePair<'_>]) -> Self {
        let curve = life.survival().curve();
        let differences = |of: fn(&Life) -> &Kernel, slope: &dyn Fn(f64) -> f64| {
            let value = |u: f64| {
                let (mut change, mut shift) = (0.0, 0.0);
                for LifePair { weight, lives, maps } in pairs {
                    let [above, below] = [0, 1].map(|side| {
                        let moved = maps[side].at(u);
                        (of(lives[side]).curve().value(moved), moved)
                    });
                    change += weight * (above.0 - below.0);
                    shift += weight * (above.1 - below.1);
                }
                change - slope(u) * shift
            };
            let cell = |cell: usize| {
                let (middle, half) = curve.cell(cell);
                RULE.coefficients(&RULE.nodes.map(|t| value(middle + half * t)))
            };
            let coefficients = (0..curve.coefficients.len()).map(cell).collect();
            Piecewise { boundaries: curve.boundaries.clone(), coefficients }
        };
        let (breaking, slope) = (life.breaking().curve(), life.force().curve().derivative());
        let survival = differences(Life::survival, &|u| -breaking.value(u));
        Self::of_curves(life, [survival, differences(Life::force, &|u| slope.value(u))])
    }
}

/// Lives with a larger and a smaller value of a parameter, with the weight of their difference and the maps of advances to them.
pub(crate) struct LifePair<'a> {
    pub(crate) weight: f64,
    pub(crate) lives: [&'a Life; 2],
    pub(crate) maps: &'a [AdvanceMap; 2],
}

/// The derivatives ∂S/∂θ of two distributions by some of their parameters.
#[derive(Clone, Copy)]
pub(crate) struct LawDerivatives<'a> {
    pub(crate) thresholds: &'a [SurvivalDerivative],
    pub(crate) starts: &'a [SurvivalDerivative],
}

impl StartingContacts<'_> {
    /// The derivatives of the life by parameters of the thresholds, then those by parameters of the starts.
    ///
    /// With h(r, u) = S(r + u)/S(r), the survival of contacts that start at r,
    ///
    /// ∂/∂θ ∫R(r) h dr = ∫ν(r) \[S_θ(r + u) − q(r) S(r + u)\] dr, ν = R/S, q = S_θ/S,
    ///
    /// for thresholds, and for starts, by partial integration that needs no derivative of a density with edges,
    ///
    /// ∂/∂θ ∫R(r) h dr = ∫s(r) ∂h/∂r dr = ∫ s(r)/S(r) \[λ(r) S(r + u) − P_c(r + u)\] dr
    ///
    /// with s = ∂S_R/∂θ and the hazard λ. Where thresholds are independent of stretches, h = S(r + u) and q = λ = 0. The
    /// force has the additional factor r + u under the derivative. S, P_c and S_θ are evaluated once for all parameters.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(crate) fn derivatives(
        &self,
        by: LawDerivatives<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<LifeDerivative>> {
        if by.thresholds.is_empty() && by.starts.is_empty() {
            return Ok(Vec::new());
        }
        let law = self.contacts.thresholds.as_ref();
        let layer = Layer::placed(self.contacts, self.starts.as_ref(), self.conditional, BULK);
        let hazards = with_atoms(law);
        let spread = !(by.starts.is_empty() && layer.is_pointed());
        let ends = if spread { self.ends(&layer, &hazards) } else { Vec::new() };
        let count = 1 + by.thresholds.len() + 2 * by.starts.len();
        let weights = |r: f64, out: &mut [f64]| self.weights(&layer, by, r, out);
        let quadrature = StartQuadrature::new(&ends, CELL * scale(law), count, weights);
        let highest = ends.last().copied().unwrap_or(0.0) + self.life.survival().curve().end();
        let integrands = Integrands::new(law, by, if spread { highest } else { 0.0 });
        let of_masses = self.of_masses(&layer, by, count);
        let masses = layer.point_masses.chunks(NODES);
        let atoms = threshold_atoms(law);
        let values = |u: f64| {
            let mut sums = vec![0.0; 2 * (by.thresholds.len() + by.starts.len())];
            let at = |b: &Breakpoint| b.position - u;
            let cuts: Vec<f64> = hazards.iter().map(at).collect();
            let steep: Vec<f64> = hazards.iter().filter(|b| b.is_steep()).map(at).collect();
            quadrature.each(&cuts, &steep, |points, near_steep| {
                let y = points.r.map(|r| r + u);
                let values = if near_steep { integrands.values(&y, NODES) } else { integrands.tabulated(&y) };
                integrands.add(&y, &values, &points.weights, &mut sums);
            });
            for (masses, weights) in masses.clone().zip(&of_masses) {
                let mut y = [0.0; NODES];
                y.iter_mut().zip(masses).for_each(|(y, mass)| *y = layer.exceeded(mass, u, &atoms));
                integrands.add(&y, &integrands.values(&y, masses.len()), weights, &mut sums);
            }
            let by_starts = sums[2 * by.thresholds.len()..].chunks_exact_mut(2);
            for (change, sum) in by.starts.iter().zip(by_starts) {
                self.add_jumps((ends.first(), ends.last()), u, change, sum);
            }
            sums
        };
        resolved(self.life, values, monitor)
    }

    /// Survival at the start, by which densities of starts are divided.
    fn over(&self, r: f64) -> f64 {
        if self.conditional { self.contacts.thresholds.survival(r) } else { 1.0 }
    }

    /// Ends of cells on which the distribution of starts, and the thresholds of contacts there, are smooth.
    pub(super) fn ends(&self, layer: &Layer, hazards: &[Breakpoint]) -> Vec<f64> {
        let mut ends = layer.density.boundaries.clone();
        ends.extend(layer.point_masses.iter().map(|mass| mass.position));
        ends.extend(self.starts.breakpoints().iter().map(|b| b.position));
        ends.sort_by(f64::total_cmp);
        if let (Some(&low), Some(&high)) = (ends.first(), ends.last()) {
            ends.extend(hazards.iter().map(|b| b.position).filter(|&r| r > low && r < high));
        }
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        ends
    }

    /// The weights at a starting stretch: ν, νq of each parameter of the thresholds, s/S and sλ/S of each of the starts.
    fn weights(&self, layer: &Layer, by: LawDerivatives<'_>, r: f64, out: &mut [f64]) {
        let law = self.contacts.thresholds.as_ref();
        let (over, density) = (self.over(r), layer.density.value(r));
        out.fill(0.0);
        if over == 0.0 {
            return;
        }
        out[0] = density;
        let (of_thresholds, of_starts) = out[1..].split_at_mut(by.thresholds.len());
        if self.conditional && density != 0.0 {
            for (weight, change) in of_thresholds.iter_mut().zip(by.thresholds) {
                *weight = density * change(r) / over;
            }
        }
        let hazard = if self.conditional && !by.starts.is_empty() { law.density(r) / over } else { 0.0 };
        for (pair, change) in of_starts.chunks_exact_mut(2).zip(by.starts) {
            pair[0] = change(r) / over;
            pair[1] = pair[0] * hazard;
        }
    }

    /// The same for the point masses of ν, in groups of up to 16; those of parameters of the starts are 0.
    fn of_masses(&self, layer: &Layer, by: LawDerivatives<'_>, count: usize) -> Vec<Vec<Nodal>> {
        let of_group = |masses: &[PointMass]| {
            let mut weights = vec![[0.0; NODES]; count];
            for (j, mass) in masses.iter().enumerate() {
                weights[0][j] = mass.weight;
                for (weight, change) in weights[1..].iter_mut().zip(by.thresholds) {
                    let at_start = change(mass.position) / self.over(mass.position);
                    weight[j] = if self.conditional { mass.weight * at_start } else { 0.0 };
                }
            }
            weights
        };
        layer.point_masses.chunks(NODES).map(of_group).collect()
    }

    /// Adds what a parameter of the starts contributes by the jumps of h at point masses of the thresholds.
    fn add_jumps(
        &self,
        ends: (Option<&f64>, Option<&f64>),
        u: f64,
        change: &SurvivalDerivative,
        sum: &mut [f64],
    ) {
        let (Some(&low), Some(&high)) = ends else { return };
        let law = self.contacts.thresholds.as_ref();
        for atom in law.atoms() {
            let mut jump = |r: f64, height: f64| {
                if (low..high).contains(&r) {
                    sum[0] += change(r) * height;
                    sum[1] += change(r) * (r + u) * height;
                }
            };
            let (reached, passed) = (atom.position - u, atom.position);
            jump(reached, -atom.weight / self.over(reached));
            if self.conditional {
                let after = self.over(passed);
                let fewer = 1.0 / after - 1.0 / (after + atom.weight);
                jump(passed, law.survival(passed + u) * if after > 0.0 { fewer } else { 0.0 });
            }
        }
    }
}

/// What is integrated over the starts as functions of the stretch y = r + u: S, P_c and the S_θ.
pub(super) struct Integrands<'a> {
    law: &'a dyn Law,
    by: LawDerivatives<'a>,
    table: Vec<Piecewise>,
}

impl<'a> Integrands<'a> {
    /// With a table up to `highest`.
    pub(super) fn new(law: &'a dyn Law, by: LawDerivatives<'a>, highest: f64) -> Self {
        let mut integrands = Self { law, by, table: Vec::new() };
        if highest > 0.0 {
            let stops: Vec<f64> = with_atoms(law).iter().map(|b| b.position).collect();
            let boundaries = edges(&law.zones(), &stops, highest);
            let values = |y: f64| integrands.at(y);
            let middles = boundaries.windows(2).map(|ends| 0.5 * (ends[0] + ends[1]));
            let sizes = largest(middles.map(values));
            let limits: Vec<_> = sizes.iter().map(|&size| limit(TABLE * scale(law), size)).collect();
            integrands.table = Piecewise::resolve_each(values, &boundaries, &limits);
        }
        integrands
    }

    fn at(&self, y: f64) -> Vec<f64> {
        let density = if self.by.starts.is_empty() { 0.0 } else { self.law.density(y) };
        let changes = self.by.thresholds.iter().map(|change| change(y));
        [self.law.survival(y), density].into_iter().chain(changes).collect()
    }

    /// The values at the first `count` of 16 stretches.
    pub(super) fn values(&self, y: &Nodal, count: usize) -> Vec<Nodal> {
        let mut values = vec![[0.0; NODES]; 2 + self.by.thresholds.len()];
        for j in 0..count {
            values.iter_mut().zip(self.at(y[j])).for_each(|(values, value)| values[j] = value);
        }
        values
    }

    /// The values at 16 stretches from the table.
    pub(super) fn tabulated(&self, y: &Nodal) -> Vec<Nodal> {
        let mut values = vec![[0.0; NODES]; self.table.len()];
        vectorised(
            #[inline(always)]
            || self.look_up(y, &mut values),
        );
        values
    }

    #[inline(always)]
    fn look_up(&self, y: &Nodal, values: &mut [Nodal]) {
        for (values, curve) in values.iter_mut().zip(&self.table) {
            *values = curve.values(y);
        }
    }

    /// Adds the integrals with the given weights.
    fn add(&self, y: &Nodal, values: &[Nodal], weights: &[Nodal], sums: &mut [f64]) {
        let ([survival, density], changes) = ([&values[0], &values[1]], &values[2..]);
        let (of_thresholds, of_starts) = weights[1..].split_at(changes.len());
        let (sums_of_thresholds, sums_of_starts) = sums.split_at_mut(2 * changes.len());
        let all = sums_of_thresholds.chunks_exact_mut(2).zip(changes).zip(of_thresholds);
        for ((sum, change), at_start) in all {
            for j in 0..NODES {
                let term = weights[0][j] * change[j] - at_start[j] * survival[j];
                sum[0] += term;
                sum[1] += y[j] * term;
            }
        }
        for (sum, pair) in sums_of_starts.chunks_exact_mut(2).zip(of_starts.chunks_exact(2)) {
            for j in 0..NODES {
                let term = pair[1][j] * survival[j] - pair[0][j] * density[j];
                sum[0] += term;
                sum[1] += pair[0][j] * survival[j] + y[j] * term;
            }
        }
    }
}

/// The tolerance of a function of this magnitude, and the magnitude; none for a function that is 0.
fn limit(fraction: f64, size: f64) -> (f64, f64) {
    (if size > 0.0 { fraction * size } else { f64::INFINITY }, size)
}

/// The largest magnitude of each of several values.
fn largest(samples: impl Iterator<Item = Vec<f64>>) -> Vec<f64> {
    let mut largest = Vec::new();
    for sample in samples {
        largest.resize(sample.len(), 0.0);
        largest.iter_mut().zip(sample).for_each(|(largest, value): (&mut f64, f64)| {
            *largest = largest.max(value.abs());
        });
    }
    largest
}

/// The curves of several parameters, survival and force of each, on the cells of a life, bisected where the survival of
/// one of them needs it.
pub(super) fn resolved(
    life: &Life,
    values: impl Fn(f64) -> Vec<f64>,
    monitor: &mut dyn Monitor,
) -> Result<Vec<LifeDerivative>> {
    let watch = Watch::new(monitor);
    let (curve, count) = (life.survival().curve(), values(0.0).len());
    let values = |u: f64| if watch.stops() { vec![0.0; count] } else { values(u) };
    let sizes = largest((0..curve.coefficients.len()).map(|cell| values(curve.cell(cell).0)));
    let pair = |sizes: &[f64]| {
        let size = sizes[0].max(sizes[1] / life.mean());
        [limit(RESOLUTION * life.mean(), size), (f64::INFINITY, size)]
    };
    let limits: Vec<_> = sizes.chunks_exact(2).flat_map(pair).collect();
    let mut curves = Piecewise::resolve_each(values, &curve.boundaries, &limits).into_iter();
    watch.check()?;
    let pairs = std::iter::from_fn(|| curves.next().zip(curves.next()));
    Ok(pairs.map(|(survival, force)| LifeDerivative::of_curves(life, [survival, force])).collect())
}
