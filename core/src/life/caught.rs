//! Contacts whose thresholds diffuse: the stretch that grows, or a threshold that falls, catches them.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::cells::scale;
use super::fate::{Cohort, Fate, Toll};
use crate::contacts::{Contacts, Maturing, Stiffness, Temperature};
use crate::law::Break;
use crate::numerics::diffusion::{Followed, Medium, Potential, Rise, Room, Sink};
use crate::numerics::piecewise::{Piecewise, Resolution};
use crate::numerics::stencil::Stencil;
use crate::{Error, Float, Result};

/// Contacts with v ∂_x p = D∂_h[U' + ∂_h]p − w p on h > x, p = 0 at h = x, from P_ci above where they formed.
#[derive(Debug, Clone)]
pub(super) struct Diffusing {
    maturing: Maturing,
    potential: Arc<Potential>,
    velocity: f64,
    temperature: Option<Temperature>,
    stiffness: Stiffness,
    resolution: f64,
    /// The largest error of survival that was met, as bits.
    missed: Arc<AtomicU64>,
}

/// Those formed at one stretch.
#[derive(Debug)]
struct Formed {
    start: f64,
    legs: Vec<Leg>,
}

/// A way on which what is left is smooth; each curve in polynomials of the advance.
#[derive(Debug)]
struct Leg {
    from: f64,
    to: f64,
    curves: [Piecewise; SUMS],
    /// −∂S/∂u.
    breaking: Piecewise,
}

/// Sums over what is left: of 1, h and h², of w/v and of h w/v.
const SUMS: usize = 5;
type Sum = [f64; SUMS];

/// Cells and steps to begin with; twice as many at each level.
const COARSEST: usize = 64;

/// Levels at least, to be extrapolated twice and compared, and at most: 2048 cells and steps.
const LEVELS: (usize, usize) = (4, 6);

/// What two successive extrapolations may differ by. Of smooth laws the later one is nearer by a factor of about 50.
const TOLERANCE: f64 = 2e-6;

/// What they may differ by in the end, where laws have edges.
const ALLOWED: f64 = 1e-3;

/// How finely the layer D/v above the stretch is resolved, and how thin at least, as part of all: a thinner one holds fewer
/// contacts than any result shows.
const LAYER: f64 = 40.0;
const THINNEST: f64 = 1e-10;

impl Diffusing {
    /// Contacts that move at a velocity.
    pub(super) fn new(contacts: &Contacts, maturing: Maturing, velocity: f64) -> Self {
        Self {
            potential: Arc::new(maturing.potential()),
            maturing,
            velocity,
            temperature: contacts.rules.temperature,
            stiffness: contacts.stiffness,
            resolution: scale(contacts.thresholds.as_ref()),
            missed: Arc::default(),
        }
    }

    /// Refuses lives that are not right: newborn thresholds with edges that hardly diffuse stay rough, and cells that follow
    /// the stretch smear them.
    ///
    /// # Errors
    /// Survival of a cohort that was off by more than [`ALLOWED`].
    pub(super) fn check(&self) -> Result<()> {
        let missed = f64::from_bits(self.missed.load(Ordering::Relaxed));
        if missed <= ALLOWED {
            return Ok(());
        }
        let what = "survival of contacts whose newborn thresholds have edges and hardly diffuse".to_owned();
        Err(Error::Accuracy { key: String::new(), what, reached: Float(missed), wanted: Float(ALLOWED) })
    }

    /// D, at least as large as is needed for a layer that can be resolved.
    fn diffusion(&self) -> f64 {
        let (low, high) = self.maturing.support;
        self.maturing.diffusion.max(THINNEST * (high - low) * self.velocity)
    }

    /// w/v of a contact at a stretch.
    fn exposure(&self, temperature: Temperature, stretch: f64, threshold: f64) -> f64 {
        let stiffness = match self.stiffness {
            Stiffness::Equal(stiffness) => stiffness,
            Stiffness::PerThreshold(factor) => factor * threshold,
        };
        temperature.rate(stretch, threshold, stiffness) / self.velocity
    }

    /// The ways of the stretch from `start`: up to the lowest threshold, and on.
    fn ways(&self, start: f64) -> Vec<(f64, f64)> {
        let (low, high) = self.maturing.support;
        if start < low { vec![(start, low), (low, high)] } else { vec![(start, high)] }
    }

    /// The sums at the end of each of so many steps of each way, on as many cells.
    fn march(&self, start: f64, count: usize) -> Vec<Vec<Sum>> {
        let (low, high) = self.maturing.support;
        let floor = start.max(low);
        let cells = Followed::new(count, self.finest(start));
        let middles: Vec<f64> = cells.middles(floor, high).collect();
        let mut masses = self.maturing.newborn(&middles, start);
        let mut march = |way: (f64, f64)| self.walk(way, &cells, &mut masses);
        self.ways(start).into_iter().map(&mut march).collect()
    }

    /// The width of the lowest cell, relative to even ones: so that it resolves the layer D/v, and, where thresholds are at
    /// the stretch when it begins to meet them, how far they diffuse in the first step.
    fn finest(&self, start: f64) -> f64 {
        /// Contacts at their thresholds, per length of all, that no result shows.
        const NOTHING: f64 = 1e-7;
        let (low, high) = self.maturing.support;
        let (floor, layer) = (start.max(low), self.diffusion() / self.velocity);
        let length = high - floor;
        let layer = layer / length;
        let rough = self.maturing.density(floor, start < low) * length > NOTHING;
        (LAYER * layer).min(if rough { 0.5 * layer.sqrt() } else { 1.0 })
    }

    /// The same for one way.
    fn walk(&self, (from, to): (f64, f64), cells: &Followed, masses: &mut [f64]) -> Vec<Sum> {
        let mut room = Room::default();
        let ((low, ceiling), count) = (self.maturing.support, masses.len());
        let mut out = vec![self.sums(from, low, cells, masses)];
        for k in 0..count {
            let stretch = [k, k + 1].map(|k| from + (to - from) * graded(k, count));
            if stretch[1] >= ceiling {
                out.push([0.0; SUMS]);
                break;
            }
            let duration = (stretch[1] - stretch[0]) / self.velocity;
            let floor = (stretch[0].max(low), stretch[1].max(low));
            let rise = Rise { floor, ceiling, duration, absorbing: from >= low };
            let sink = self.temperature.map(|temperature| {
                move |h: f64| self.velocity * self.exposure(temperature, 0.5 * (stretch[0] + stretch[1]), h)
            });
            let sink = sink.as_ref().map(|sink| sink as Sink<'_>);
            let medium = Medium { potential: &self.potential, diffusion: self.diffusion(), sink };
            cells.advance(&rise, &medium, masses, &mut room);
            out.push(self.sums(stretch[1], low, cells, masses));
        }
        out
    }

    fn sums(&self, stretch: f64, low: f64, cells: &Followed, masses: &[f64]) -> Sum {
        let mut sums = [0.0; SUMS];
        for (h, mass) in cells.middles(stretch.max(low), self.maturing.support.1).zip(masses) {
            let exposed = self.temperature.map_or(0.0, |t| mass * self.exposure(t, stretch, h));
            for (sum, term) in sums.iter_mut().zip([*mass, mass * h, mass * h * h, exposed, exposed * h]) {
                *sum += term;
            }
        }
        sums
    }

    /// The sums on each way, at levels that double until two extrapolations agree.
    fn extrapolated(&self, start: f64) -> Vec<Vec<Sum>> {
        let mut levels: Vec<[Vec<Vec<Sum>>; 3]> = Vec::new();
        loop {
            let plain = self.march(start, COARSEST << levels.len());
            let Some([coarse, better, best]) = levels.last() else {
                levels.push([plain.clone(), plain.clone(), plain]);
                continue;
            };
            let second = extrapolate(coarse, &plain, 3.0);
            let fourth = extrapolate(better, &second, 15.0);
            let apart = apart(best, &fourth);
            levels.push([plain, second, fourth.clone()]);
            if (levels.len() >= LEVELS.0 && apart < TOLERANCE) || levels.len() == LEVELS.1 {
                // Positive numbers are in the order of their bits.
                self.missed.fetch_max(apart.to_bits(), Ordering::Relaxed);
                return fourth;
            }
        }
    }
}

/// The part of a way that has been gone after k of n steps: the first ones are short, since much happens at once where
/// contacts are born at their thresholds, or mature before they stretch.
fn graded(k: usize, n: usize) -> f64 {
    (k as f64 / n as f64).powi(2)
}

/// The finer values, carried on by 1/`gain` of what they differ by from the coarser ones; that is interpolated in between.
fn extrapolate(coarse: &[Vec<Sum>], fine: &[Vec<Sum>], gain: f64) -> Vec<Vec<Sum>> {
    let way = |(coarse, fine): (&Vec<Sum>, &Vec<Sum>)| {
        let apart = |(coarse, fine): (&Sum, &Sum)| std::array::from_fn(|i| (fine[i] - coarse[i]) / gain);
        let apart: Vec<Sum> = coarse.iter().zip(fine.iter().step_by(2)).map(apart).collect();
        let place = |k: usize| k as f64 / (fine.len() - 1) as f64;
        let on = |k: usize| std::array::from_fn(|i| fine[k][i] + interpolated(&apart, place(k), i));
        (0..fine.len()).map(on).collect()
    };
    coarse.iter().zip(fine).map(way).collect()
}

/// How far survival is from what coarser points tell, in between as well.
fn apart(coarse: &[Vec<Sum>], fine: &[Vec<Sum>]) -> f64 {
    let way = |(coarse, fine): (&Vec<Sum>, &Vec<Sum>)| {
        let place = |k: usize| k as f64 / (fine.len() - 1) as f64;
        let at = |k: usize| (fine[k][0] - interpolated(coarse, place(k), 0)).abs();
        (0..fine.len()).map(at).fold(0.0, f64::max)
    };
    coarse.iter().zip(fine).map(way).fold(0.0, f64::max)
}

/// A sum between points that divide [0, 1] evenly.
fn interpolated(points: &[Sum], place: f64, sum: usize) -> f64 {
    Stencil::at(place * (points.len() - 1) as f64, points.len()).value(|point| points[point][sum])
}

impl Fate for Diffusing {
    fn cohort(&self, start: f64) -> Arc<dyn Cohort> {
        let sums = self.extrapolated(start);
        let legs = self.ways(start).into_iter().zip(&sums).filter(|((from, to), _)| to > from);
        let legs = legs.map(|(way, sums)| Leg::new((way.0 - start, way.1 - start), sums)).collect();
        Arc::new(Formed { start, legs })
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }
}

impl Leg {
    fn new((from, to): (f64, f64), sums: &[Sum]) -> Self {
        /// Polynomials follow the points this much closer than those are right.
        const FITTED: f64 = 1e-5 * TOLERANCE;
        let length = to - from;
        let at = |u: f64| {
            let place = (u / length).sqrt();
            std::array::from_fn(|sum| interpolated(sums, place, sum))
        };
        let curves: [Piecewise; SUMS] = Piecewise::resolve_all(at, &[], length, Resolution::Mean(FITTED));
        let mut breaking = curves[0].derivative();
        breaking.coefficients.iter_mut().flatten().for_each(|c| *c = -*c);
        Self { from, to, curves, breaking }
    }
}

impl Cohort for Formed {
    fn toll(&self, advance: f64) -> Toll {
        let Some(leg) = self.legs.iter().find(|leg| advance >= leg.from && advance < leg.to) else {
            return Toll::default();
        };
        let u = advance - leg.from;
        let [unbroken, first, second, exposed, exposed_first] =
            std::array::from_fn(|k| leg.curves[k].value(u));
        // What breaks by itself has its own threshold; the rest meets its stretch.
        let breaking = leg.breaking.value(u);
        let breaking_first = (self.start + advance) * (breaking - exposed) + exposed_first;
        Toll { unbroken: [unbroken, first, second], breaking: [breaking, breaking_first] }
    }

    /// Where polynomials meet, though they do to their accuracy.
    fn breaks(&self) -> Vec<Break> {
        let meet = |leg: &Leg, edge: f64| {
            let jump = |curve: &Piecewise| {
                let cell = curve.nearest(edge);
                let before = if cell > 0 { curve.value_in(cell - 1, edge) } else { 0.0 };
                if edge < curve.end() {
                    curve.value_in(cell, edge) - before
                } else {
                    -curve.value_in(cell, edge)
                }
            };
            Break { position: leg.from + edge, exponent: 0.0, amplitude: jump(&leg.breaking) }
        };
        let of = |leg: &Leg| leg.breaking.boundaries.iter().map(|&edge| meet(leg, edge)).collect::<Vec<_>>();
        self.legs.iter().flat_map(of).filter(|b| b.position > 0.0).collect()
    }
}
