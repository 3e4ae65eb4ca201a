//! Contacts whose thresholds diffuse: they break at the first passage of the threshold through the growing
//! stretch.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::breaking_model::{BreakingModel, Cohort, SurvivalMoments};
use super::cells::{ROUNDING, scale};
use super::thermal_hazard::blur;
use crate::contacts::{Contacts, Stiffness, Temperature, ThresholdFokkerPlanck};
use crate::law::Breakpoint;
use crate::monitor::Watch;
use crate::numerics::diffusion::{Elements, Evolution, Field, Loss, Slope, TimeStep};
use crate::numerics::legendre::{NODES, Nodal, RULE, derivative, series};
use crate::numerics::piecewise::Piecewise;

/// Contacts with v ∂_x p = D∂_h[U' + ∂_h]p − w p on h > x, p = 0 at h = x, from P_ci above the stretch of
/// formation.
///
/// The equation is solved by [`Evolution`] twice, the second time with a hundred times the tolerance; the
/// difference is the error estimate.
#[derive(Debug, Clone)]
pub(super) struct FokkerPlanckLife {
    maturing: ThresholdFokkerPlanck,
    slope: Arc<Slope>,
    velocity: f64,
    temperature: Option<Temperature>,
    stiffness: Stiffness,
    resolution: f64,
    /// The length over which temperature blurs the breaking of contacts.
    blur: f64,
    /// The largest error of survival so far, as bits.
    largest_error: Arc<AtomicU64>,
}

/// The contacts formed at one stretch.
#[derive(Debug)]
struct DiffusingCohort {
    start: f64,
    /// Solutions for the density and for the point masses of fresh thresholds, each below and above the
    /// lowest threshold.
    segments: Vec<LifeSegment>,
    /// Where breaking begins like an inverse square root.
    onsets: Vec<Breakpoint>,
}

/// An interval of the solution; each curve is piecewise polynomial in the advance since `from`.
#[derive(Debug)]
struct LifeSegment {
    from: f64,
    to: f64,
    curves: [Piecewise; SUMS],
    /// −∂S/∂u.
    breaking: Piecewise,
}

/// Integrals over the surviving contacts: of 1, h and h², of w/v and of h w/v.
const SUMS: usize = 5;

/// Parameters of a solution.
#[derive(Debug, Clone, Copy)]
struct Discretisation {
    /// Truncation error of a step, as a fraction of the contacts of a cohort.
    tolerance: f64,
    /// Initial width of point masses, in units of their width when the stretch reaches them; also of the
    /// narrowest element at an edge.
    spread: f64,
    /// The smallest layers D/v, in units of those of the finer solution.
    layers: f64,
}

const FINE: Discretisation = Discretisation { tolerance: 3e-12, spread: 1e-3, layers: 1.0 };
/// Twice as thick layers reveal the first-order effect of the smallest layer of the finer solution.
const ROUGH: Discretisation = Discretisation { tolerance: 3e-10, spread: 2e-3, layers: 2.0 };

/// Fraction of the advance after which contacts with point-mass thresholds are followed at the latest.
const EARLY: f64 = 1e-3;

/// Surviving fraction that no result shows.
const NOTHING: f64 = 1e-16;

/// D/v is at least this fraction of the range of thresholds: for less, edges do not spread over the width of
/// an element.
const LEAST: f64 = 1e-14;

/// The same for a layer D/v above the stretch that elements have to resolve.
const RESOLVED: f64 = 1e-10;

impl FokkerPlanckLife {
    /// Contacts that move at a velocity.
    pub(super) fn new(
        contacts: &Contacts,
        maturing: ThresholdFokkerPlanck,
        temperature: Option<Temperature>,
        velocity: f64,
    ) -> Self {
        Self {
            slope: Arc::new(maturing.slope()),
            maturing,
            velocity,
            temperature,
            stiffness: contacts.stiffness.clone(),
            resolution: scale(contacts.thresholds.as_ref()),
            blur: temperature.map_or(f64::INFINITY, |temperature| blur(contacts, &temperature)),
            largest_error: Arc::default(),
        }
    }

    /// D, but at least that of a layer D/v of this fraction of the range of thresholds.
    fn at_least(&self, part: f64) -> f64 {
        let (low, high) = self.maturing.support;
        self.maturing.diffusion.max(part * (high - low) * self.velocity)
    }

    /// w/v of a contact at a stretch.
    fn hazard(&self, temperature: Temperature, stretch: f64, threshold: f64) -> f64 {
        temperature.rate(stretch, threshold, self.stiffness.of(threshold)) / self.velocity
    }

    /// w of a contact at a stretch, continued beyond the threshold: as smooth there as the barrier allows, for densities
    /// that go on below the stretch.
    ///
    /// It rises steeply there, and is cut off where no contact is left: w divided by the largest growth of ln w per time is
    /// at most ∫w dt.
    fn continued_rate(&self, temperature: &Temperature, stretch: f64, threshold: f64) -> f64 {
        /// ∫w dt of contacts of which none is left, and w/ω so far below the stretch that diffusion does not bring them back.
        const GONE: f64 = 100.0;
        let barrier = |h: f64| 0.5 * self.stiffness.of(h) * h * h / temperature.energy;
        let high = self.maturing.support.1;
        let growth = 2.0 * barrier(high) / high * self.velocity;
        let most = GONE * (growth / temperature.attempt_rate).max(1.0);
        let exponent = barrier(threshold) * temperature.barrier.continued(stretch / threshold);
        temperature.attempt_rate * (-exponent).exp().min(most)
    }

    /// How far fresh thresholds have spread when the stretch reaches them, or the width of P_cf if that is
    /// smaller.
    fn reach(&self, diffusion: f64) -> f64 {
        let (low, high) = self.maturing.support;
        let met = (2.0 * diffusion / self.velocity * 0.5 * (low + high)).sqrt();
        met.min(self.maturing.width())
    }

    /// The solutions for density and point masses of contacts formed at a stretch.
    fn segments(&self, start: f64, solved: Discretisation, watch: &Watch<'_>) -> Vec<LifeSegment> {
        // A layer thinner than the floor of D/v would need elements below rounding. The second
        // solution has a layer twice as thick, so that their difference contains the first-order
        // effect of the floor.
        let diffusion = self.at_least(solved.layers * LEAST);
        let spread = solved.spread * self.reach(diffusion);
        let whole = self.maturing.survival(start);
        let (wider, solved) =
            (solved.spread / FINE.spread, Discretisation { tolerance: solved.tolerance * whole, ..solved });
        // The diffusion time of that width.
        let time = 0.5 * spread * spread / diffusion;
        // The equation is linear: densities and point masses evolve separately, each on elements that suit
        // it.
        let smooth = self.maturing.fresh_density(start, |_| 0.1 * solved.tolerance, 0.1 * spread);
        let mut segments = if smooth.mass() > NOTHING * whole {
            self.follow(smooth, (start, 0.0), time, solved, watch)
        } else {
            Vec::new()
        };
        let spread = self.maturing.point_mass_width(spread, wider);
        let latest = EARLY * self.maturing.support.1 / self.velocity;
        let time = (0.5 * spread * spread / diffusion).min(latest);
        let passed = start + self.velocity * time;
        if let Some(together) =
            self.maturing.point_mass_density(passed, spread, &self.slope, 0.1 * solved.tolerance)
        {
            segments.extend(self.follow(together, (start, time), time, solved, watch));
        }
        segments
    }

    /// The solution for contacts formed at a stretch, from their density after a `time`, until none is left.
    ///
    /// Elements that a thin layer passes through may amplify their truncation error until there are too many
    /// of them. The tolerance is then relaxed; the difference of two solutions measures the effect.
    fn follow(
        &self,
        density: Elements,
        begun: (f64, f64),
        next: f64,
        solved: Discretisation,
        watch: &Watch<'_>,
    ) -> Vec<LifeSegment> {
        const FACTORS: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];
        let with = |factor: f64| {
            let solved = Discretisation { tolerance: factor * solved.tolerance, ..solved };
            self.followed(density.clone(), begun, next, solved, (factor < FACTORS[FACTORS.len() - 1], watch))
        };
        FACTORS.into_iter().find_map(with).unwrap_or_default()
    }

    /// The same; with `gives_up`, `None` if there are too many elements.
    fn followed(
        &self,
        density: Elements,
        (start, time): (f64, f64),
        next: f64,
        Discretisation { tolerance, layers, .. }: Discretisation,
        (gives_up, watch): (bool, &Watch<'_>),
    ) -> Option<Vec<LifeSegment>> {
        let (low, high) = self.maturing.support;
        let (kinks, lasting) = (self.maturing.kinks(), (high - start) / self.velocity);
        let lost = self.temperature.map(|temperature| {
            move |time: f64, h: f64| self.continued_rate(&temperature, start + self.velocity * time, h)
        });
        let field = Field {
            slope: &|h| self.slope.at(h),
            diffusion: self.at_least(layers * LEAST),
            loss: lost.as_ref().map(|lost| lost as Loss<'_>),
        };
        let (velocity, stops) = (self.velocity, || watch.stops());
        let mut evolution = Evolution {
            density,
            field,
            velocity,
            absorbing: false,
            kinks: &kinks,
            tolerance,
            time,
            next,
            first: true,
            stops: &stops,
        };
        let mut segments = Vec::new();
        if time > 0.0 {
            segments.push(self.waiting(start, &evolution.density, velocity * time));
        }
        let layer = field.diffusion / velocity;
        // The asymptotic expansion holds from the beginning only if no contact stands at the
        // stretch yet.
        let met = evolution.density.value(start + velocity * time).abs();
        if self.is_thin(layer) && met * layer < tolerance {
            segments.push(self.free(start, layer, evolution, lasting, watch));
            return Some(segments);
        }
        evolution.field.diffusion = self.at_least(layers * RESOLVED);
        let begun = evolution.density.mass();
        // No contact breaks before the stretch reaches the support of the thresholds. From there on the lower
        // boundary moves with the stretch and absorbs.
        for (end, absorbing) in [((low - start) / velocity, false), (lasting, true)] {
            if end <= evolution.time {
                continue;
            }
            evolution.absorbing = absorbing;
            evolution.begin();
            // A step holds its elements at nine times: of each, only the integrals are kept.
            let (mut times, mut series) = (vec![evolution.time], Vec::new());
            while evolution.time < end * (1.0 - 1e-14)
                && evolution.density.mass() > NOTHING * begun
                && !watch.stops()
            {
                let step = evolution.advance(end);
                if gives_up && evolution.is_at_capacity() {
                    return None;
                }
                times.push(step.to);
                series.push(
                    step.all(|time, density| watch.value(|| self.sums(start + velocity * time, density))),
                );
            }
            if !series.is_empty() {
                segments.push(self.segment(&times, &series));
            }
        }
        Some(segments)
    }

    /// Whether the layer above the stretch is so thin that two terms of its expansion give its mass.
    fn is_thin(&self, layer: f64) -> bool {
        /// In units of the length on which the distributions vary: the error is of third order, and of second
        /// order at edges, which have spread by √(2xD/v).
        const OF_DENSITY: f64 = 2e-5;
        /// In units of the lowest point mass, which has spread likewise.
        const OF_SHARED: f64 = 3e-7;
        /// In units of the length over which temperature blurs breaking. The rate of breaking changes by this part within
        /// the layer: the error is of second order, in units of the mass of the layer.
        const OF_BLUR: f64 = 1e-3;
        let shared = self.maturing.lowest_atom().map_or(f64::INFINITY, |place| OF_SHARED * place);
        layer < shared.min(OF_DENSITY * self.maturing.resolution()).min(OF_BLUR * self.blur)
    }

    /// The curves of contacts whose density q evolves as if none were absorbed, with a boundary-layer
    /// correction above the stretch.
    ///
    /// With λ = D/v, y = h − x and Q(x) = q(x; x), p = q − e^{−y/λ}[Q − y(Q' + U'Q + wQ/v) + …], w = ω that at the
    /// stretch: a boundary layer at an outflow, by matched asymptotic expansions. Its mass is −λQ + λ²(Q' + U'Q + wQ/v),
    /// around y = λ, with an error of λ³Q''. Below the stretch q goes on with w continued.
    fn free(
        &self,
        start: f64,
        layer: f64,
        mut evolution: Evolution<'_>,
        end: f64,
        watch: &Watch<'_>,
    ) -> LifeSegment {
        let begun = evolution.density.mass();
        let stretch = |time: f64| start + self.velocity * time;
        let (mut times, mut series) = (vec![evolution.time], Vec::new());
        while evolution.time < end * (1.0 - 1e-14)
            && evolution.density.sums_above(stretch(evolution.time), |_| [1.0])[0] > NOTHING * begun
            && !watch.stops()
        {
            let step = evolution.advance(end);
            // Densities may jump from element to element. Where the stretch passes an edge the
            // polynomial in time ends.
            let met = step.at(step.from).edges.into_iter().map(|edge| (edge - start) / self.velocity);
            let cuts = met.filter(|&time| time > step.from && time < step.to).chain([step.to]);
            for high in cuts.collect::<Vec<_>>() {
                let low = times[series.len()];
                series.push(watch.value(|| self.layered(start, layer, &step, (low, high))));
                times.push(high);
            }
        }
        self.segment(&times, &series)
    }

    /// The integrals as polynomials of the time from `low` to `high`, in which the stretch passes no element
    /// boundary.
    fn layered(&self, start: f64, layer: f64, step: &TimeStep, (low, high): (f64, f64)) -> [Nodal; SUMS] {
        let times = RULE.nodes.map(|t| 0.5 * (low + high) + 0.5 * (high - low) * t);
        let densities = times.map(|time| step.at(time));
        let stretches = times.map(|time| start + self.velocity * time);
        let met: Nodal = std::array::from_fn(|i| densities[i].value(stretches[i]));
        let exposed = self.temperature.map_or(0.0, |temperature| temperature.attempt_rate / self.velocity);
        let slope = derivative(&RULE.coefficients(&met)).map(|c| c / (0.5 * self.velocity * (high - low)));
        let sums: [[f64; SUMS]; NODES] = std::array::from_fn(|i| {
            let (x, density) = (stretches[i], &densities[i]);
            let bent = series(&slope, RULE.nodes[i]) + (self.slope.at(x) + exposed) * met[i];
            let mass = -layer * met[i] + layer * layer * bent;
            let of_layer = self.weights(x, x + layer).map(|weight| mass * weight);
            self.record_error(layer * bent, met[i], layer);
            let whole = density.sums_above(x, |h| self.weights(x, h));
            std::array::from_fn(|k| whole[k] + of_layer[k])
        });
        std::array::from_fn(|k| RULE.coefficients(&sums.map(|sums| sums[k])))
    }

    /// Records the error of two terms, estimated as (second/first)² × first.
    fn record_error(&self, second: f64, first: f64, layer: f64) {
        let third = if first == 0.0 { 0.0 } else { (layer * second * second / first).abs() };
        self.largest_error.fetch_max(third.min(1.0).to_bits(), Ordering::Relaxed);
    }

    /// The integrands: 1, h, h², w/v and h w/v.
    fn weights(&self, stretch: f64, h: f64) -> [f64; SUMS] {
        let exposed = self.temperature.map_or(0.0, |temperature| self.hazard(temperature, stretch, h));
        [1.0, h, h * h, exposed, h * exposed]
    }

    /// The interval before contacts are followed.
    fn waiting(&self, start: f64, density: &Elements, to: f64) -> LifeSegment {
        let constant = |value: f64| {
            let mut series = [0.0; NODES];
            series[0] = value;
            Piecewise { boundaries: vec![0.0, to], coefficients: vec![series] }
        };
        let curves = self.sums(start, density).map(constant);
        LifeSegment { from: 0.0, to, curves, breaking: constant(0.0) }
    }

    /// The curves of time steps between these times, from the integrals in each.
    fn segment(&self, times: &[f64], series: &[[Nodal; SUMS]]) -> LifeSegment {
        let boundaries: Vec<f64> = times.iter().map(|time| self.velocity * (time - times[0])).collect();
        let curve = |k: usize| Piecewise {
            boundaries: boundaries.clone(),
            coefficients: series.iter().map(|series| series[k]).collect(),
        };
        let curves: [Piecewise; SUMS] = std::array::from_fn(curve);
        let breaking = curves[0].derivative().scaled(-1.0);
        let [from, to] = [times[0], times[series.len()]].map(|time| self.velocity * time);
        LifeSegment { from, to, curves, breaking }
    }

    fn sums(&self, stretch: f64, density: &Elements) -> [f64; SUMS] {
        if self.temperature.is_none() && self.stiffness.is_equal() {
            let mut sums = [0.0; SUMS];
            sums[0] = density.mass();
            return sums;
        }
        let mut sums = density.sums(|h| self.weights(stretch, h));
        sums[0] = density.mass();
        sums
    }

    /// Where breaking begins like p √(D/πvu), p the density of thresholds at the stretch when the first are
    /// reached.
    fn onsets(&self, start: f64, segments: &[LifeSegment]) -> Vec<Breakpoint> {
        /// Of which there is nothing to be seen.
        const FAINT: f64 = 1e-13;
        let amplitude = |segment: &LifeSegment| {
            // From the first step, in which S falls by 2p √(Du/πv).
            let first = segment.curves[0].boundaries[1];
            let fallen = segment.curves[0].value_in(0, 0.0) - segment.curves[0].value_in(0, first);
            0.5 * fallen * (std::f64::consts::PI / first).sqrt()
        };
        let low = self.maturing.support.0;
        let begins = |segment: &&LifeSegment| {
            segment.from + start >= low && segment.breaking.coefficients[0] != [0.0; NODES]
        };
        let break_of = |segment: &LifeSegment| Breakpoint {
            position: segment.from,
            exponent: -0.5,
            amplitude: amplitude(segment),
        };
        let length = (self.maturing.support.1 - start).sqrt();
        segments.iter().filter(begins).map(break_of).filter(|b| b.amplitude * length > FAINT).collect()
    }
}

impl BreakingModel for FokkerPlanckLife {
    fn cohort(&self, start: f64, watch: &Watch<'_>) -> Arc<dyn Cohort> {
        if watch.stops() {
            return Arc::new(DiffusingCohort { start, segments: Vec::new(), onsets: Vec::new() });
        }
        let segments = self.segments(start, FINE, watch);
        // The flux into an absorbing boundary that meets a density p > 0 begins as p √(D/πt), the
        // error-function solution of diffusion next to a plane. As a breakpoint of the kernel it
        // grades the cells there.
        let onsets = self.onsets(start, &segments);
        let formed = DiffusingCohort { start, segments, onsets };
        let rough =
            DiffusingCohort { start, segments: self.segments(start, ROUGH, watch), onsets: Vec::new() };
        let (mean, whole) = (self.maturing.fresh_law().mean(), self.maturing.survival(start));
        // Beyond all thresholds there is no contact that could be off.
        if whole > 0.0 {
            let difference = formed.difference(&rough, mean, watch) / whole;
            // Positive numbers are in the order of their bits.
            self.largest_error.fetch_max(difference.to_bits(), Ordering::Relaxed);
        }
        Arc::new(formed)
    }

    /// Cohorts are solved for; survival moments only evaluate curves.
    fn making_fraction(&self) -> f64 {
        0.9
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }

    fn rounding(&self) -> f64 {
        /// Rounding of the masses of some tens of elements, over a step.
        const OF_A_STEP: f64 = 2e-12;
        // Far less than what all steps together are off by.
        OF_A_STEP.max(1e-3 * self.error())
    }

    fn error(&self) -> f64 {
        f64::from_bits(self.largest_error.load(Ordering::Relaxed)).max(ROUNDING)
    }
}

impl DiffusingCohort {
    /// How far this cohort and another solution for it are apart, as forces feel it: the largest difference of the surviving
    /// fractions, or of the forces they carry per mean threshold where the stretch is shorter than that, or their mean
    /// difference over the mean threshold.
    ///
    /// Contacts that break at a stretch of nearly 0 carry no force. Where the density of thresholds has a pole at 0, the
    /// fraction that has broken by then is not small, and depends on how finely the pole is resolved.
    fn difference(&self, other: &Self, mean: f64, watch: &Watch<'_>) -> f64 {
        let ends = |formed: &Self| -> Vec<f64> {
            let of = |segment: &LifeSegment| {
                segment.curves[0].boundaries.iter().map(|u| segment.from + u).collect::<Vec<_>>()
            };
            formed.segments.iter().flat_map(of).collect()
        };
        let mut places: Vec<f64> = ends(self).into_iter().chain(ends(other)).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let left = |formed: &Self, u: f64| formed.survival_moments(u, watch).unbroken[0];
        let apart: Vec<f64> = places.iter().map(|&u| (left(self, u) - left(other, u)).abs()).collect();
        let felt = |(u, apart): (&f64, &f64)| ((self.start + u) / mean).min(1.0) * apart;
        let most = places.iter().zip(&apart).map(felt).fold(0.0, f64::max);
        let trapezoid = |(u, apart): (&[f64], &[f64])| 0.5 * (u[1] - u[0]) * (apart[0] + apart[1]);
        let whole: f64 = places.windows(2).zip(apart.windows(2)).map(trapezoid).sum();
        most.max(whole / mean)
    }
}

impl Cohort for DiffusingCohort {
    fn survival_moments(&self, advance: f64, _watch: &Watch<'_>) -> SurvivalMoments {
        let mut survival_moments = SurvivalMoments::default();
        for segment in self.segments.iter().filter(|segment| advance >= segment.from && advance < segment.to)
        {
            let u = advance - segment.from;
            let [unbroken, first, second, exposed, exposed_first] =
                std::array::from_fn(|k| segment.curves[k].value(u));
            // A contact broken by temperature has its own threshold; for the others it equals the stretch.
            let breaking = segment.breaking.value(u);
            let breaking_first = (self.start + advance) * (breaking - exposed) + exposed_first;
            survival_moments
                .unbroken
                .iter_mut()
                .zip([unbroken, first, second])
                .for_each(|(sum, term)| *sum += term);
            survival_moments
                .breaking
                .iter_mut()
                .zip([breaking, breaking_first])
                .for_each(|(sum, term)| *sum += term);
        }
        survival_moments
    }

    /// Where polynomials meet, although they agree to their accuracy, and where breaking begins steeply.
    fn breakpoints(&self, _watch: &Watch<'_>) -> Vec<Breakpoint> {
        let meet = |segment: &LifeSegment, edge: f64| {
            let curve = &segment.breaking;
            let cell = curve.nearest(edge);
            let before = if cell > 0 { curve.value_in(cell - 1, edge) } else { 0.0 };
            let jump = if edge < curve.end() {
                curve.value_in(cell, edge) - before
            } else {
                -curve.value_in(cell, edge)
            };
            Breakpoint { position: segment.from + edge, exponent: 0.0, amplitude: jump }
        };
        let of = |segment: &LifeSegment| {
            segment.breaking.boundaries.iter().map(|&edge| meet(segment, edge)).collect::<Vec<_>>()
        };
        let meets = self.segments.iter().flat_map(of).filter(|b| b.position > 0.0);
        meets.chain(self.onsets.iter().copied()).collect()
    }
}
