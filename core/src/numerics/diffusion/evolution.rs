//! Time integration of a Fokker–Planck equation above a rising floor, on adaptive spectral elements in
//! adaptive time steps.

use super::elements::{Elements, NARROWEST, refined};
use super::galerkin::{Field, Loss};
use super::radau::{RADAU, STAGES};
use super::slab::{EdgeMotion, slab, truncation_in_time};
use crate::numerics::legendre::{Nodal, series};

/// ∂_t p = D∂_h[U' + ∂_h]p − wp on [x, H], with a reflecting end at H.
///
/// Elements are halved where their truncation error is too large, and joined where possible. The length of a
/// step follows from the truncation error of its polynomials in time. Above an absorbing floor the lowest
/// elements move with it, up to the first that is wide enough to be squeezed, so that the boundary layer of
/// width D/v is at rest in them; all other elements are at rest.
pub struct Evolution<'a> {
    /// p.
    pub density: Elements,
    /// Drift, diffusion and loss; the first argument of the loss is the time.
    pub field: Field<'a>,
    /// Velocity v of the floor.
    pub velocity: f64,
    /// Whether the floor absorbs; if not, it reflects and is at rest.
    pub absorbing: bool,
    /// Positions at which U' is not smooth.
    pub kinks: &'a [f64],
    /// Tolerance on the truncation error of an element, and of a step.
    pub tolerance: f64,
    /// The present time.
    pub time: f64,
    /// Largest duration of the next step.
    pub next: f64,
    /// Whether the next step is the first, in which edges of the density become smooth on a scale that does
    /// not matter later: the truncation error of its polynomials in time is not controlled.
    pub first: bool,
    /// Whether to stop, asked in every sweep of a step: what is then returned is not the solution.
    pub stops: &'a dyn Fn() -> bool,
}

impl std::fmt::Debug for Evolution<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Evolution").field("time", &self.time).finish_non_exhaustive()
    }
}

/// A finished step: the density at its start and at the Radau points.
#[derive(Debug)]
pub struct TimeStep {
    /// Time at its start.
    pub from: f64,
    /// Time at its end.
    pub to: f64,
    points: Vec<Elements>,
    /// Its truncation error.
    pub error: f64,
}

/// Largest number of elements; if it is not enough, the estimated error of the step is larger.
const MOST_ELEMENTS: usize = 400;
/// Largest number of attempts at a step.
const MOST_TRIES: usize = 60;

/// Largest factor by which the step grows.
const GROWTH: f64 = 3.0;

impl Evolution<'_> {
    /// Divides the lowest elements so that they resolve the layer above an absorbing floor at which the
    /// density is not 0, and shortens the next step to the time in which a negligible mass is lost there.
    pub fn begin(&mut self) {
        self.first = true;
        let (floor, diffusion) = (self.density.edges[0], self.field.diffusion);
        let there = self.density.value(floor).abs();
        let length = self.density.edges[self.density.count()] - floor;
        if !self.absorbing || there * length < self.tolerance {
            return;
        }
        // The boundary layer grows like √(Dt); until it has this mass it need not be resolved.
        let unseen = self.tolerance / there;
        self.next = self.next.min((unseen * unseen / diffusion).max(1e-26 * length * length / diffusion));
        let layer = (diffusion * self.next).sqrt();
        let layer = if self.velocity > 0.0 { layer.min(diffusion / self.velocity) } else { layer };
        let finest = layer.max(0.1 * unseen).max(NARROWEST * length);
        let first = self.density.width(0);
        let marks =
            std::iter::successors(Some(finest), |width| Some(4.0 * width)).take_while(|w| 2.0 * w < first);
        let mut edges = self.density.edges.clone();
        edges.splice(1..1, marks.map(|width| floor + width));
        self.density = self.density.on(&edges);
    }

    /// Whether there are so many elements that none is divided any more.
    pub fn is_at_capacity(&self) -> bool {
        self.density.count() >= MOST_ELEMENTS
    }

    /// Makes one step, at most up to the time `limit`.
    pub fn advance(&mut self, limit: f64) -> TimeStep {
        let density = std::mem::take(&mut self.density);
        let (floor, near) = (density.edges[0], self.unsmoothed(&density));
        let allowed =
            |low: f64, half: f64| 0.1 * self.tolerance / counted_half_width(low - floor, half, near);
        let mut start = density.coarsened(allowed, self.kinks, self.velocity > 0.0);
        for tries in 0.. {
            let motion = self.motion(&start, limit - self.time);
            let lost = |done: f64, place: f64| {
                self.field.loss.map_or(0.0, |loss| loss(self.time + done * motion.duration, place))
            };
            let field = Field { loss: self.field.loss.map(|_| &lost as Loss<'_>), ..self.field };
            let slab = slab(&start, &motion, &field, 0.02 * self.tolerance, self.stops);
            // A step is repeated with finer elements, or a shorter duration, until both errors are below the
            // tolerance.
            let missed = truncation_in_time(&start, &slab.stages, &RADAU);
            let last = tries >= MOST_TRIES || (self.stops)();
            let roughness: Vec<f64> =
                (0..start.count()).map(|i| self.roughness(i, &slab.stages, near)).collect();
            if !last && start.count() < MOST_ELEMENTS && roughness.iter().any(|roughness| *roughness > 1.0) {
                start = start.on(&refined(&start.edges, &roughness, self.absorbing));
                continue;
            }
            let factor = 0.9 * (self.tolerance / missed.max(f64::MIN_POSITIVE)).powf(1.0 / STAGES as f64);
            let unsettled = slab.iteration_error > self.tolerance;
            if !last && (missed > GROWTH * self.tolerance && !self.first || unsettled) {
                self.next = motion.duration * factor.clamp(0.1, 0.6);
                continue;
            }
            let whole = motion.duration >= limit - self.time;
            let to = if whole { limit } else { self.time + motion.duration };
            self.next = motion.duration * factor.clamp(0.6, GROWTH);
            // The errors in time, of the iteration and in space are independent; their sum is the
            // estimate.
            let missing: f64 = roughness.iter().map(|roughness| roughness * self.tolerance).sum();
            let step = TimeStep {
                from: std::mem::replace(&mut self.time, to),
                to,
                points: std::iter::once(start).chain(slab.stages).collect(),
                error: missed + slab.iteration_error + missing,
            };
            self.density = step.points[STAGES].clone();
            self.first = false;
            return step;
        }
        unreachable!("the last try is accepted")
    }

    /// The motion of the edges in the next step, no longer than `limit`.
    fn motion(&self, density: &Elements, limit: f64) -> EdgeMotion {
        let duration = self.next.min(limit);
        let rests = EdgeMotion { by: 0.0, duration, absorbing: self.absorbing, last: 0 };
        if !self.absorbing || self.velocity == 0.0 {
            return rests;
        }
        let widths = || (0..density.count()).map(|i| density.width(i));
        // The element that is squeezed keeps at least half its width.
        let widest = widths().fold(0.0, f64::max);
        let by = (duration * self.velocity).min(0.5 * widest);
        // The lowest elements are as narrow as the boundary layer; they move with it unchanged. The
        // first one that is wide enough takes up the motion.
        let last = widths().position(|width| width >= 2.0 * by).unwrap_or(0);
        let duration = if by < duration * self.velocity { by / self.velocity } else { duration };
        EdgeMotion { by, duration, last, ..rests }
    }

    /// The truncation error of an element over the tolerance; 0 for one that is too narrow to be divided.
    fn roughness(&self, i: usize, stages: &[Elements], near: f64) -> f64 {
        let of = |stage: &Elements| {
            let (floor, ceiling) = (stage.edges[0], stage.edges[stage.count()]);
            if stage.width(i) < NARROWEST * ceiling {
                return 0.0;
            }
            let half = counted_half_width(stage.edges[i] - floor, stage.element(i).1, near);
            stage.truncation(i) * half / self.tolerance
        };
        of(&stages[STAGES / 2]).max(of(&stages[STAGES - 1]))
    }

    /// Height of the region above a floor that rises fast, where diffusion smooths nothing before the floor has
    /// passed; 0 if there is none.
    ///
    /// A fraction of the length on which the density varies. Of a density with a long tail this is a few mean
    /// distances from the floor, not the length of the tail.
    fn unsmoothed(&self, density: &Elements) -> f64 {
        const FRACTION: f64 = 0.02;
        const MEAN_DISTANCES: f64 = 10.0;
        if !self.absorbing {
            return 0.0;
        }
        let (floor, ceiling) = (density.edges[0], density.edges[density.count()]);
        let [mass, moment] = density.sums(|h| [1.0, h - floor]);
        let near = FRACTION * (ceiling - floor).min(MEAN_DISTANCES * moment / mass);
        if self.field.diffusion < near * self.velocity { near } else { 0.0 }
    }
}

/// The half width with which the truncation error of an element counts: its own, except for narrow elements in
/// the region `near` the floor. What is not resolved there is not smoothed either, but is carried into wide
/// elements.
fn counted_half_width(height: f64, half: f64, near: f64) -> f64 {
    if height < near { half.max(near) } else { half }
}

impl TimeStep {
    /// The density at a time of the step, if elements were at rest.
    pub fn at(&self, time: f64) -> Elements {
        let done = (time - self.from) / (self.to - self.from);
        let weight = |m: usize| {
            let alone: [f64; STAGES + 1] = std::array::from_fn(|k| f64::from(u8::from(k == m)));
            series(&RADAU.coefficients(&alone), 2.0 * done - 1.0)
        };
        let weights: [f64; STAGES + 1] = std::array::from_fn(weight);
        let sum = |i: usize| -> Nodal {
            std::array::from_fn(|n| weights.iter().zip(&self.points).map(|(w, p)| w * p.series[i][n]).sum())
        };
        let edges = self.points[0].edges.clone();
        Elements { series: (0..edges.len() - 1).map(sum).collect(), edges }
    }

    /// A functional of the density at each time, as a Legendre series in time on the step.
    pub fn series(&self, of: impl Fn(f64, &Elements) -> f64) -> Nodal {
        let [series] = self.all(|time, density| [of(time, density)]);
        series
    }

    /// Several functionals.
    pub fn all<const K: usize>(&self, of: impl Fn(f64, &Elements) -> [f64; K]) -> [Nodal; K] {
        let time = |m: usize| {
            let done = if m == 0 { 0.0 } else { RADAU.nodes[m - 1] };
            self.from + (self.to - self.from) * done
        };
        let known: [[f64; K]; STAGES + 1] = std::array::from_fn(|m| of(time(m), &self.points[m]));
        std::array::from_fn(|k| RADAU.coefficients(&known.map(|known| known[k])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIFFUSION: f64 = 0.01;
    const VELOCITY: f64 = 1.0;
    const TOLERANCE: f64 = 1e-9;

    /// The fraction left, and the largest number of elements, of the density e^{−h} on [0, `ceiling`] above a floor
    /// that rises up to 1.
    fn followed(ceiling: f64) -> (f64, usize) {
        let finest = 1e-3;
        let density = Elements::of(|h| (-h).exp(), &[0.0, ceiling], |_| 0.1 * TOLERANCE, finest);
        let mut evolution = Evolution {
            density,
            field: Field { slope: &|_| 0.0, diffusion: DIFFUSION, loss: None },
            velocity: VELOCITY,
            absorbing: true,
            kinks: &[],
            tolerance: TOLERANCE,
            time: 0.0,
            next: 1.0,
            first: true,
            stops: &|| false,
        };
        evolution.begin();
        let mut most = 0;
        while evolution.time < 1.0 {
            evolution.advance(1.0);
            most = most.max(evolution.density.count());
        }
        (evolution.density.mass(), most)
    }

    /// The same fraction from that of Brownian motion with drift −v from h which has not reached 0, Φ((h − vt)/√(2Dt)) −
    /// e^{vh/D} Φ(−(h + vt)/√(2Dt)), by the trapezoidal rule.
    fn exact() -> f64 {
        let width = (2.0 * DIFFUSION).sqrt();
        let normal = |z: f64| 0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2);
        // e^{vh/D} overflows where nothing is absorbed any more.
        let reflected = |h: f64| {
            if h < 4.0 { (VELOCITY * h / DIFFUSION).exp() * normal(-(h + VELOCITY) / width) } else { 0.0 }
        };
        let at = |h: f64| (-h).exp() * (normal((h - VELOCITY) / width) - reflected(h));
        let step = 1e-4;
        (1..400_000).map(|i| step * at(step * f64::from(i))).sum()
    }

    #[test]
    fn a_long_tail_takes_no_more_elements_above_the_floor() {
        let exact = exact();
        let [(short, few), (long, more)] = [40.0, 1000.0].map(followed);
        // Some hundred steps with errors of the tolerance, of which few have the same sign.
        for left in [short, long] {
            assert!((left - exact).abs() < 1e-8, "{left} instead of {exact}");
        }
        // Five halvings lead from 1000 to 40.
        assert!(more <= few + 5, "{more} elements instead of {few}");
    }
}
