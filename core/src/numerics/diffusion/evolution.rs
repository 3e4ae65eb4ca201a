//! A density followed in time above a floor that rises steadily, on elements and in steps that fit it.

use super::elements::Elements;
use super::radau::{RADAU, STAGES};
use super::slab::{EdgeMotion, Field, Loss, left_out, slab};
use crate::numerics::legendre::{Nodal, series};

/// ∂_t p = D∂_h[U' + ∂_h]p − wp on [x, H], H reflecting.
///
/// Elements are halved where they leave out too much and joined where they need not; steps are as long as what their
/// polynomials in time leave out allows. Where the floor absorbs, the elements next to it go with it, up to the first that is
/// wide enough to be squeezed, so that the layer D/v above it rests in them; all others rest.
pub struct Evolution<'a> {
    /// p.
    pub density: Elements,
    /// What it moves in; the first argument of its loss is the time.
    pub field: Field<'a>,
    /// v of the floor.
    pub velocity: f64,
    /// Whether the floor absorbs; else it reflects, and rests.
    pub absorbing: bool,
    /// Places at which U' is not smooth.
    pub kinks: &'a [f64],
    /// What an element, or a step, may leave out.
    pub left_out: f64,
    /// The time.
    pub time: f64,
    /// How long the next step may be.
    pub next: f64,
    /// Whether it is the first, in which edges of the density become smooth over less than anything to come tells apart: what its
    /// polynomials in time leave out does not matter.
    pub first: bool,
}

/// A step done: the density at its beginning and at Radau's points.
#[derive(Debug)]
pub struct TimeStep {
    /// When it began, …
    pub from: f64,
    /// … and ended.
    pub to: f64,
    points: Vec<Elements>,
    /// What its polynomials left out.
    pub left_out: f64,
}

/// The narrowest element, per length of all.
const NARROWEST: f64 = 1e-13;

/// Elements, and tries of a step, at most: where these are not enough, what is left out says so.
const MOST_ELEMENTS: usize = 400;
const MOST_TRIES: usize = 60;

/// A step may grow by this factor.
const GROWTH: f64 = 3.0;

impl Evolution<'_> {
    /// Cuts the lowest elements so that they hold the layer above an absorbing floor at which there is a density, and shortens
    /// the next step to the time in which no more is lost there than may be left out.
    pub fn begin(&mut self) {
        self.first = true;
        let (floor, diffusion) = (self.density.edges[0], self.field.diffusion);
        let there = self.density.value(floor).abs();
        let length = self.density.edges[self.density.count()] - floor;
        if !self.absorbing || there * length < self.left_out {
            return;
        }
        let unseen = self.left_out / there;
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

    /// Whether elements are so many that none is cut any more.
    pub fn is_crowded(&self) -> bool {
        self.density.count() >= MOST_ELEMENTS
    }

    /// Goes on, up to a time.
    pub fn advance(&mut self, limit: f64) -> TimeStep {
        let density = std::mem::take(&mut self.density);
        let ends = (density.edges[0], density.edges[density.count()]);
        let allowed = |low: f64, half: f64| 0.1 * self.left_out / self.counted(ends, low, half);
        let mut start = density.coarsened(allowed, self.kinks);
        for tries in 0.. {
            let motion = self.motion(&start, limit - self.time);
            let lost = |done: f64, place: f64| {
                self.field.loss.map_or(0.0, |loss| loss(self.time + done * motion.duration, place))
            };
            let field = Field { loss: self.field.loss.map(|_| &lost as Loss<'_>), ..self.field };
            let slab = slab(&start, &motion, &field, 0.02 * self.left_out);
            let missed = left_out(&start, &slab.stages, &RADAU);
            let last = tries >= MOST_TRIES;
            let rough: Vec<f64> = (0..start.count()).map(|i| self.rough(i, &slab.stages)).collect();
            if !last && start.count() < MOST_ELEMENTS && rough.iter().any(|rough| *rough > 1.0) {
                start = start.on(&refined(&start.edges, &rough, self.absorbing));
                continue;
            }
            let factor = 0.9 * (self.left_out / missed.max(f64::MIN_POSITIVE)).powf(1.0 / STAGES as f64);
            let unsettled = slab.unsettled > self.left_out;
            if !last && (missed > GROWTH * self.left_out && !self.first || unsettled) {
                self.next = motion.duration * factor.clamp(0.1, 0.6);
                continue;
            }
            let whole = motion.duration >= limit - self.time;
            let to = if whole { limit } else { self.time + motion.duration };
            self.next = motion.duration * factor.clamp(0.6, GROWTH);
            let missing: f64 = rough.iter().map(|rough| rough * self.left_out).sum();
            let step = TimeStep {
                from: std::mem::replace(&mut self.time, to),
                to,
                points: std::iter::once(start).chain(slab.stages).collect(),
                left_out: missed + slab.unsettled + missing,
            };
            self.density = step.points[STAGES].clone();
            self.first = false;
            return step;
        }
        unreachable!("the last try is accepted")
    }

    /// The next step, no longer than `limit`.
    fn motion(&self, density: &Elements, limit: f64) -> EdgeMotion {
        let duration = self.next.min(limit);
        let rests = EdgeMotion { by: 0.0, duration, absorbing: self.absorbing, last: 0 };
        if !self.absorbing || self.velocity == 0.0 {
            return rests;
        }
        let widths = || (0..density.count()).map(|i| density.width(i));
        // The element that is squeezed keeps half its width.
        let widest = widths().fold(0.0, f64::max);
        let by = (duration * self.velocity).min(0.5 * widest);
        let last = widths().position(|width| width >= 2.0 * by).unwrap_or(0);
        let duration = if by < duration * self.velocity { by / self.velocity } else { duration };
        EdgeMotion { by, duration, last, ..rests }
    }

    /// What an element leaves out over what it may; 0 for one that is too narrow to be cut.
    fn rough(&self, i: usize, stages: &[Elements]) -> f64 {
        let of = |stage: &Elements| {
            let ends = (stage.edges[0], stage.edges[stage.count()]);
            if stage.width(i) < NARROWEST * ends.1 {
                return 0.0;
            }
            stage.left_out(i) * self.counted(ends, stage.edges[i], stage.element(i).1) / self.left_out
        };
        of(&stages[STAGES / 2]).max(of(&stages[STAGES - 1]))
    }

    /// The half width by which what an element leaves out counts: its own, but for the narrow ones above a floor that rises fast.
    /// What is not resolved there is not smoothed either, but carried into wide ones.
    fn counted(&self, (floor, ceiling): (f64, f64), low: f64, half: f64) -> f64 {
        /// How far that reaches, as part of all.
        const NEAR: f64 = 0.02;
        let near = NEAR * (ceiling - floor);
        let fast = self.absorbing && self.field.diffusion < near * self.velocity;
        if fast && low - floor < near { half.max(near) } else { half }
    }
}

/// The edges with the roughest elements cut. Rough ones disturb their neighbours: those that are far less so have to wait.
fn refined(edges: &[f64], rough: &[f64], absorbing: bool) -> Vec<f64> {
    /// The share of the roughest that need not wait.
    const SHARE: f64 = 0.01;
    let least = (SHARE * rough.iter().fold(0.0, |a: f64, &b| a.max(b))).max(1.0);
    let mut out = vec![edges[0]];
    for (i, pair) in edges.windows(2).enumerate() {
        let width = pair[1] - pair[0];
        if rough[i] >= least {
            if i == 0 && absorbing {
                out.extend([pair[0] + width / 16.0, pair[0] + width / 4.0]);
            } else {
                let parts = (1.3 * rough[i].powf(1.0 / 16.0)).ceil().clamp(2.0, 4.0);
                out.extend((1..parts as u32).map(|k| pair[0] + width * f64::from(k) / parts));
            }
        }
        out.push(pair[1]);
    }
    out
}

impl TimeStep {
    /// The density at a time of the step, where elements rested.
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

    /// A number that follows from the density at each time, as a Legendre series in time on the step.
    pub fn series(&self, of: impl Fn(f64, &Elements) -> f64) -> Nodal {
        let [series] = self.all(|time, density| [of(time, density)]);
        series
    }

    /// Several numbers.
    pub fn all<const K: usize>(&self, of: impl Fn(f64, &Elements) -> [f64; K]) -> [Nodal; K] {
        let time = |m: usize| {
            let done = if m == 0 { 0.0 } else { RADAU.nodes[m - 1] };
            self.from + (self.to - self.from) * done
        };
        let known: [[f64; K]; STAGES + 1] = std::array::from_fn(|m| of(time(m), &self.points[m]));
        std::array::from_fn(|k| RADAU.coefficients(&known.map(|known| known[k])))
    }
}
