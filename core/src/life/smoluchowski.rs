//! Contacts whose thresholds diffuse: the stretch that grows, or a threshold that falls, catches them.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::breaking_model::{BreakingModel, Cohort, SurvivalMoments};
use super::cells::{ROUNDING, scale};
use crate::contacts::{Contacts, Stiffness, Temperature, ThresholdFokkerPlanck};
use crate::law::Breakpoint;
use crate::monitor::Watch;
use crate::numerics::diffusion::{Elements, Evolution, Field, Loss, Slope, TimeStep};
use crate::numerics::legendre::{NODES, Nodal, RULE, derivative, series};
use crate::numerics::piecewise::Piecewise;
use crate::{Error, Result};

/// Contacts with v ∂_x p = D∂_h[U' + ∂_h]p − w p on h > x, p = 0 at h = x, from P_ci above where they formed.
///
/// That is solved by [`Evolution`] twice, the second time to a hundredth of the first: what both differ by is the error told.
#[derive(Debug, Clone)]
pub(super) struct FokkerPlanckLife {
    maturing: ThresholdFokkerPlanck,
    slope: Arc<Slope>,
    velocity: f64,
    temperature: Option<Temperature>,
    stiffness: Stiffness,
    resolution: f64,
    /// The largest error of survival that was met, as bits.
    missed: Arc<AtomicU64>,
}

/// Those formed at one stretch.
#[derive(Debug)]
struct DiffusingCohort {
    start: f64,
    /// Those whose newborn thresholds have a density, and those whose many share, each on each side of the lowest threshold.
    legs: Vec<LifeSegment>,
    /// Where breaking begins like an inverse square root.
    onsets: Vec<Breakpoint>,
}

/// A way on which what is left is followed; each curve in polynomials of the advance since `from`.
#[derive(Debug)]
struct LifeSegment {
    from: f64,
    to: f64,
    curves: [Piecewise; SUMS],
    /// −∂S/∂u.
    breaking: Piecewise,
}

/// Sums over what is left: of 1, h and h², of w/v and of h w/v.
const SUMS: usize = 5;

/// How closely the equation is solved.
#[derive(Debug, Clone, Copy)]
struct Discretisation {
    /// What a step may leave out, of the contacts of a cohort.
    tolerance: f64,
    /// How far shared thresholds are spread to begin with, as part of how far they will be when the stretch meets them; the same
    /// of the narrowest element at an edge.
    spread: f64,
    /// The least layers D/v, in units of those of the finer solution.
    layers: f64,
}

const FINE: Discretisation = Discretisation { tolerance: 3e-12, spread: 1e-3, layers: 1.0 };
/// Twice as thick layers tell what the thickest of the finer solution does to the result, which is of the first order.
const ROUGH: Discretisation = Discretisation { tolerance: 3e-10, spread: 2e-3, layers: 2.0 };

/// The part of their way after which contacts with shared thresholds are followed at the latest.
const EARLY: f64 = 1e-3;

/// Contacts left that no result shows.
const NOTHING: f64 = 1e-16;

/// D/v is at least this part of all thresholds: by less, edges do not spread as far as an element is wide.
const LEAST: f64 = 1e-14;

/// The same of a layer D/v above the stretch that elements have to resolve.
const RESOLVED: f64 = 1e-10;

/// The same where newborn thresholds have edges besides, and temperature breaks contacts.
const RESOLVED_WITH_EDGES: f64 = 1e-5;

impl FokkerPlanckLife {
    /// Contacts that move at a velocity.
    ///
    /// # Errors
    /// Newborn thresholds with edges that diffuse so little that both the edges and what temperature does at the stretch would
    /// have to be resolved in a layer of next to nothing.
    pub(super) fn new(
        contacts: &Contacts,
        maturing: ThresholdFokkerPlanck,
        temperature: Option<Temperature>,
        velocity: f64,
    ) -> Result<Self> {
        let (low, high) = maturing.support;
        let least = RESOLVED_WITH_EDGES * (high - low) * velocity;
        if temperature.is_some() && maturing.has_edges() && maturing.diffusion < least {
            let expected = format!(
                "{least:.1e} or more at this velocity, where newborn thresholds have edges and temperature breaks contacts"
            );
            return Err(Error::invalid(
                "contacts.ageing.smoluchowski.diffusion",
                expected,
                maturing.diffusion,
            ));
        }
        Ok(Self {
            slope: Arc::new(maturing.slope()),
            maturing,
            velocity,
            temperature,
            stiffness: contacts.stiffness,
            resolution: scale(contacts.thresholds.as_ref()),
            missed: Arc::default(),
        })
    }

    /// D, but for a layer D/v of this part of all thresholds at least.
    fn at_least(&self, part: f64) -> f64 {
        let (low, high) = self.maturing.support;
        self.maturing.diffusion.max(part * (high - low) * self.velocity)
    }

    /// w/v of a contact at a stretch.
    fn exposure(&self, temperature: Temperature, stretch: f64, threshold: f64) -> f64 {
        temperature.rate(stretch, threshold, self.stiffness.of(threshold)) / self.velocity
    }

    /// How far newborn thresholds will have spread when the stretch meets them, or where P_cf is as narrow.
    fn reach(&self, diffusion: f64) -> f64 {
        let (low, high) = self.maturing.support;
        let met = (2.0 * diffusion / self.velocity * 0.5 * (low + high)).sqrt();
        met.min(self.maturing.width())
    }

    /// Both kinds of contacts formed at a stretch.
    fn legs(&self, start: f64, solved: Discretisation, watch: &Watch<'_>) -> Vec<LifeSegment> {
        let diffusion = self.at_least(solved.layers * LEAST);
        let spread = solved.spread * self.reach(diffusion);
        let whole = self.maturing.survival(start);
        let (wider, solved) =
            (solved.spread / FINE.spread, Discretisation { tolerance: solved.tolerance * whole, ..solved });
        // What spreads that far does so in this time.
        let time = 0.5 * spread * spread / diffusion;
        let smooth = self.maturing.fresh_density(start, 0.1 * solved.tolerance, 0.1 * spread);
        let mut legs = if smooth.mass() > NOTHING * whole {
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
            legs.extend(self.follow(together, (start, time), time, solved, watch));
        }
        legs
    }

    /// Contacts formed at a stretch, of a density that they have after a `time`, until none is left.
    ///
    /// Elements that a thin layer goes through may amplify what they leave out until there are too many of them. Then more may
    /// be left out from the beginning: what two solutions differ by tells how much that was.
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

    /// The same; with `gives_up`, nothing where elements are too many.
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
            move |time: f64, h: f64| {
                self.velocity * self.exposure(temperature, start + self.velocity * time, h)
            }
        });
        let field = Field {
            slope: &|h| self.slope.at(h),
            diffusion: self.at_least(layers * LEAST),
            loss: lost.as_ref().map(|lost| lost as Loss<'_>),
        };
        let velocity = self.velocity;
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
        };
        let mut legs = Vec::new();
        if time > 0.0 {
            legs.push(self.waiting(start, &evolution.density, velocity * time));
        }
        let layer = field.diffusion / velocity;
        let met = evolution.density.value(start + velocity * time).abs();
        if self.is_thin(layer) && met * layer < tolerance {
            legs.push(self.free(start, layer, evolution, lasting, watch));
            return Some(legs);
        }
        evolution.field.diffusion = self.at_least(layers * RESOLVED);
        let begun = evolution.density.mass();
        for (end, absorbing) in [((low - start) / velocity, false), (lasting, true)] {
            if end <= evolution.time {
                continue;
            }
            evolution.absorbing = absorbing;
            evolution.begin();
            let mut steps = Vec::new();
            while evolution.time < end * (1.0 - 1e-14)
                && evolution.density.mass() > NOTHING * begun
                && !watch.stops()
            {
                steps.push(evolution.advance(end));
                if gives_up && evolution.is_at_capacity() {
                    return None;
                }
            }
            if !steps.is_empty() {
                legs.push(self.leg(start, &steps, watch));
            }
        }
        Some(legs)
    }

    /// Whether the layer above the stretch is so thin that its mass is known by two terms; where temperature breaks contacts
    /// their density has a kink at the stretch, unless they are caught there.
    fn is_thin(&self, layer: f64) -> bool {
        /// Of the length on which the laws vary: what is left out is of the third order, and at edges, which have spread by
        /// √(2xD/v), of the second.
        const OF_DENSITY: f64 = 2e-5;
        /// Of the least of the thresholds that many share, around which they have spread likewise.
        const OF_SHARED: f64 = 3e-7;
        let shared = self.maturing.lowest_atom().map_or(f64::INFINITY, |place| OF_SHARED * place);
        self.temperature.is_none() && layer < shared.min(OF_DENSITY * self.maturing.resolution())
    }

    /// The curves of contacts whose density q would go on as it is if none were caught, but in a thin layer above the stretch.
    ///
    /// With λ = D/v, y = h − x and Q(u) = q(x, u), p = q − e^{−y/λ}[Q − y(Q' + U'Q) + …]: a boundary layer at an outflow, by
    /// matched asymptotic expansions. It has the mass −λQ + λ²(Q' + U'Q), around y = λ, up to λ³Q''.
    fn free(
        &self,
        start: f64,
        layer: f64,
        mut evolution: Evolution<'_>,
        end: f64,
        watch: &Watch<'_>,
    ) -> LifeSegment {
        let (from, begun) = (evolution.time, evolution.density.mass());
        let stretch = |time: f64| start + self.velocity * time;
        let mut steps: Vec<TimeStep> = Vec::new();
        while evolution.time < end * (1.0 - 1e-14)
            && evolution.density.sums_above(stretch(evolution.time), |_| [1.0])[0] > NOTHING * begun
            && !watch.stops()
        {
            steps.push(evolution.advance(end));
        }
        let mut boundaries = vec![0.0];
        let mut curves: [Vec<Nodal>; SUMS] = std::array::from_fn(|_| Vec::new());
        for step in &steps {
            let met = step.at(step.from).edges.into_iter().map(|edge| (edge - start) / self.velocity);
            let mut cuts: Vec<f64> = met.filter(|&time| time > step.from && time < step.to).collect();
            cuts.push(step.to);
            let mut low = step.from;
            for high in cuts {
                let series = watch.value(|| self.layered(start, layer, step, (low, high)));
                curves.iter_mut().zip(series).for_each(|(curve, series)| curve.push(series));
                boundaries.push(self.velocity * (high - from));
                low = high;
            }
        }
        let to = from + boundaries[boundaries.len() - 1] / self.velocity;
        let curves = curves.map(|coefficients| Piecewise { boundaries: boundaries.clone(), coefficients });
        let breaking = curves[0].derivative().scaled(-1.0);
        let [from, to] = [from, to].map(|time| self.velocity * time);
        LifeSegment { from, to, curves, breaking }
    }

    /// The sums in polynomials of the time from `low` to `high`, in which the stretch passes no edge of an element.
    fn layered(&self, start: f64, layer: f64, step: &TimeStep, (low, high): (f64, f64)) -> [Nodal; SUMS] {
        let times = RULE.nodes.map(|t| 0.5 * (low + high) + 0.5 * (high - low) * t);
        let densities = times.map(|time| step.at(time));
        let stretches = times.map(|time| start + self.velocity * time);
        let met: Nodal = std::array::from_fn(|i| densities[i].value(stretches[i]));
        let slope = derivative(&RULE.coefficients(&met)).map(|c| c / (0.5 * self.velocity * (high - low)));
        let sums: [[f64; SUMS]; NODES] = std::array::from_fn(|i| {
            let (x, density) = (stretches[i], &densities[i]);
            let bent = series(&slope, RULE.nodes[i]) + self.slope.at(x) * met[i];
            let mass = -layer * met[i] + layer * layer * bent;
            let of_layer = self.weights(x, x + layer).map(|weight| mass * weight);
            self.note(layer * bent, met[i], layer);
            let whole = density.sums_above(x, |h| self.weights(x, h));
            std::array::from_fn(|k| whole[k] + of_layer[k])
        });
        std::array::from_fn(|k| RULE.coefficients(&sums.map(|sums| sums[k])))
    }

    /// Takes the error of what two terms leave out, as the second one is to the first.
    fn note(&self, second: f64, first: f64, layer: f64) {
        let third = if first == 0.0 { 0.0 } else { (layer * second * second / first).abs() };
        self.missed.fetch_max(third.min(1.0).to_bits(), Ordering::Relaxed);
    }

    /// What sums count of a contact: 1, h, h², w/v and h w/v.
    fn weights(&self, stretch: f64, h: f64) -> [f64; SUMS] {
        let exposed = self.temperature.map_or(0.0, |temperature| self.exposure(temperature, stretch, h));
        [1.0, h, h * h, exposed, h * exposed]
    }

    /// Those that wait to be followed.
    fn waiting(&self, start: f64, density: &Elements, to: f64) -> LifeSegment {
        let constant = |value: f64| {
            let mut series = [0.0; NODES];
            series[0] = value;
            Piecewise { boundaries: vec![0.0, to], coefficients: vec![series] }
        };
        let curves = self.sums(start, density).map(constant);
        LifeSegment { from: 0.0, to, curves, breaking: constant(0.0) }
    }

    /// The curves of so many steps.
    fn leg(&self, start: f64, steps: &[TimeStep], watch: &Watch<'_>) -> LifeSegment {
        let begun = steps[0].from;
        let advance = |time: f64| self.velocity * (time - begun);
        let boundaries: Vec<f64> =
            std::iter::once(0.0).chain(steps.iter().map(|step| advance(step.to))).collect();
        let sums =
            |time: f64, density: &Elements| watch.value(|| self.sums(start + self.velocity * time, density));
        let all: Vec<[Nodal; SUMS]> = steps.iter().map(|step| step.all(sums)).collect();
        let curve = |k: usize| Piecewise {
            boundaries: boundaries.clone(),
            coefficients: all.iter().map(|series| series[k]).collect(),
        };
        let curves: [Piecewise; SUMS] = std::array::from_fn(curve);
        let breaking = curves[0].derivative().scaled(-1.0);
        let [from, to] = [begun, steps[steps.len() - 1].to].map(|time| self.velocity * time);
        LifeSegment { from, to, curves, breaking }
    }

    fn sums(&self, stretch: f64, density: &Elements) -> [f64; SUMS] {
        if self.temperature.is_none() && matches!(self.stiffness, Stiffness::Equal(_)) {
            let mut sums = [0.0; SUMS];
            sums[0] = density.mass();
            return sums;
        }
        let mut sums = density.sums(|h| self.weights(stretch, h));
        sums[0] = density.mass();
        sums
    }

    /// Where breaking begins like p √(D/πvu), as p contacts per threshold are where the stretch is when it begins to meet them.
    fn onsets(&self, start: f64, legs: &[LifeSegment]) -> Vec<Breakpoint> {
        /// Of which there is nothing to be seen.
        const FAINT: f64 = 1e-13;
        let amplitude = |leg: &LifeSegment| {
            // From the first step, in which S falls by 2p √(Du/πv).
            let first = leg.curves[0].boundaries[1];
            let fallen = leg.curves[0].value_in(0, 0.0) - leg.curves[0].value_in(0, first);
            0.5 * fallen * (std::f64::consts::PI / first).sqrt()
        };
        let low = self.maturing.support.0;
        let begins =
            |leg: &&LifeSegment| leg.from + start >= low && leg.breaking.coefficients[0] != [0.0; NODES];
        let break_of =
            |leg: &LifeSegment| Breakpoint { position: leg.from, exponent: -0.5, amplitude: amplitude(leg) };
        let length = (self.maturing.support.1 - start).sqrt();
        legs.iter().filter(begins).map(break_of).filter(|b| b.amplitude * length > FAINT).collect()
    }
}

impl BreakingModel for FokkerPlanckLife {
    fn cohort(&self, start: f64, watch: &Watch<'_>) -> Arc<dyn Cohort> {
        if watch.stops() {
            return Arc::new(DiffusingCohort { start, legs: Vec::new(), onsets: Vec::new() });
        }
        let legs = self.legs(start, FINE, watch);
        let onsets = self.onsets(start, &legs);
        let formed = DiffusingCohort { start, legs, onsets };
        let rough = DiffusingCohort { start, legs: self.legs(start, ROUGH, watch), onsets: Vec::new() };
        let apart = formed.apart(&rough) / self.maturing.survival(start);
        // Positive numbers are in the order of their bits.
        self.missed.fetch_max(apart.to_bits(), Ordering::Relaxed);
        Arc::new(formed)
    }

    /// They are solved for; survival moments are curves.
    fn making(&self) -> f64 {
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
        f64::from_bits(self.missed.load(Ordering::Relaxed)).max(ROUNDING)
    }
}

impl DiffusingCohort {
    /// The most by which what is left differs.
    fn apart(&self, other: &Self) -> f64 {
        let ends = |formed: &Self| -> Vec<f64> {
            let of =
                |leg: &LifeSegment| leg.curves[0].boundaries.iter().map(|u| leg.from + u).collect::<Vec<_>>();
            formed.legs.iter().flat_map(of).collect()
        };
        let places: Vec<f64> = ends(self).into_iter().chain(ends(other)).collect();
        let left = |formed: &Self, u: f64| formed.toll(u).unbroken[0];
        places.iter().map(|&u| (left(self, u) - left(other, u)).abs()).fold(0.0, f64::max)
    }
}

impl Cohort for DiffusingCohort {
    fn toll(&self, advance: f64) -> SurvivalMoments {
        let mut toll = SurvivalMoments::default();
        for leg in self.legs.iter().filter(|leg| advance >= leg.from && advance < leg.to) {
            let u = advance - leg.from;
            let [unbroken, first, second, exposed, exposed_first] =
                std::array::from_fn(|k| leg.curves[k].value(u));
            // What breaks by itself has its own threshold; the rest meets its stretch.
            let breaking = leg.breaking.value(u);
            let breaking_first = (self.start + advance) * (breaking - exposed) + exposed_first;
            toll.unbroken.iter_mut().zip([unbroken, first, second]).for_each(|(sum, term)| *sum += term);
            toll.breaking.iter_mut().zip([breaking, breaking_first]).for_each(|(sum, term)| *sum += term);
        }
        toll
    }

    /// Where polynomials meet, though they do to their accuracy, and where breaking begins steeply.
    fn breakpoints(&self) -> Vec<Breakpoint> {
        let meet = |leg: &LifeSegment, edge: f64| {
            let curve = &leg.breaking;
            let cell = curve.nearest(edge);
            let before = if cell > 0 { curve.value_in(cell - 1, edge) } else { 0.0 };
            let jump = if edge < curve.end() {
                curve.value_in(cell, edge) - before
            } else {
                -curve.value_in(cell, edge)
            };
            Breakpoint { position: leg.from + edge, exponent: 0.0, amplitude: jump }
        };
        let of = |leg: &LifeSegment| {
            leg.breaking.boundaries.iter().map(|&edge| meet(leg, edge)).collect::<Vec<_>>()
        };
        let meets = self.legs.iter().flat_map(of).filter(|b| b.position > 0.0);
        meets.chain(self.onsets.iter().copied()).collect()
    }
}
