//! A population along a friction curve in closed form: the block is tested without any solver.
#![allow(dead_code)]

use std::sync::Arc;

use asperity::Result;
use asperity::energy::ContactEnergies;
use asperity::exact::{ClosedForm, Gaussian, Identical, Rectangular};
use asperity::monitor::Monitor;
use asperity::numerics::legendre::RULE;
use asperity::population::{Direction, Population, Response, SmoothInterval};
use asperity::rate_dependent::ContactsState;

/// Second moment ∫x²Q of the stretches and breaks per contact after an advance u, from relaxed contacts.
type Moments = Arc<dyn Fn(f64) -> (f64, f64) + Send + Sync>;

/// Contacts of unit total stiffness, relaxed at first and when they re-form.
///
/// Sliding on goes along the curve F(u), turning back along the line of slope 1 down from its tip, to which it comes
/// back. From relaxed contacts either direction is the mirror image of the other.
#[derive(Clone)]
pub struct ClosedCurve {
    form: Arc<dyn ClosedForm + Send + Sync>,
    moments: Moments,
    /// Where ways end, besides every `cell`.
    edges: Vec<f64>,
    cell: f64,
    /// Edges at which contacts break together.
    breaks: bool,
    position: f64,
    direction: Direction,
    looked: Direction,
    /// The tip, and how far back from it.
    tip: f64,
    back: f64,
    /// Whether what breaks stays free, and whether all contacts are.
    held: bool,
    free: bool,
    /// ∫F dX, and lost and broken before the last reset.
    work: f64,
    before: f64,
    broken: f64,
    marked: Option<Box<Self>>,
}

/// E[S_n² …] is not needed: for Gaussian thresholds ∫x²Q is the variance plus the square of the force.
pub fn gaussian(std: f64) -> ClosedCurve {
    let form = Gaussian::new(1.0, std);
    let broken = move |u: f64| {
        let z = |n: i32| (u - f64::from(n)) / (f64::from(n).sqrt() * std);
        (1..).map(z).take_while(|z| *z > -40.0).map(|z| 0.5 * libm::erfc(-z / std::f64::consts::SQRT_2)).sum()
    };
    let moments = move |u: f64| (form.variance(u) + form.force(u).powi(2), broken(u));
    ClosedCurve::new(Arc::new(form), Arc::new(moments), Vec::new(), 0.5 * std)
}

/// Of the energies of its contacts only the sum of stored and lost is right: it stores as if all were alike.
pub fn rectangular(min: f64, max: f64) -> ClosedCurve {
    let edges = (1..40).flat_map(|n| (0..=n).map(move |k| f64::from(n - k) * min + f64::from(k) * max));
    let mut edges: Vec<f64> = edges.collect();
    edges.sort_by(f64::total_cmp);
    edges.dedup_by(|b, a| *b - *a < 1e-12);
    let form = Rectangular { min, max };
    let moments = move |u: f64| (form.force(u).powi(2), 0.0);
    ClosedCurve::new(Arc::new(form), Arc::new(moments), edges, 0.05)
}

pub fn identical() -> ClosedCurve {
    let edges = (1..100).map(f64::from).collect();
    let moments = |u: f64| ((u - u.floor()).powi(2), u.floor());
    let curve = ClosedCurve::new(Arc::new(Identical { threshold: 1.0 }), Arc::new(moments), edges, 1.0);
    ClosedCurve { breaks: true, ..curve }
}

impl std::fmt::Debug for ClosedCurve {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ClosedCurve").field("position", &self.position).finish_non_exhaustive()
    }
}

impl ClosedCurve {
    fn new(form: Arc<dyn ClosedForm + Send + Sync>, moments: Moments, edges: Vec<f64>, cell: f64) -> Self {
        Self {
            form,
            moments,
            edges,
            cell,
            breaks: false,
            position: 0.0,
            direction: Direction::Forward,
            looked: Direction::Forward,
            tip: 0.0,
            back: 0.0,
            held: false,
            free: false,
            work: 0.0,
            before: 0.0,
            broken: 0.0,
            marked: None,
        }
    }

    /// The end of the way from the tip.
    fn next(&self) -> f64 {
        let cell = ((self.tip / self.cell + 1e-9).floor() + 1.0) * self.cell;
        let edge = self.edges.iter().find(|edge| **edge > self.tip + 1e-12);
        edge.map_or(cell, |edge| edge.min(cell))
    }

    /// Force and slope of the curve, from the left at the end of the way.
    fn on_curve(&self, u: f64) -> Response {
        let u = if u >= self.next() { self.next().next_down() } else { u };
        Response { force: self.form.force(u), tangent: self.form.slope(u) }
    }

    fn elastic(&self) -> f64 {
        let second = (self.moments)(self.tip).0;
        let force = self.form.force(self.tip);
        0.5 * (second - 2.0 * self.back * force + self.back * self.back)
    }
}

impl Population for ClosedCurve {
    fn position(&self) -> f64 {
        self.position
    }

    fn smooth_interval(
        &mut self,
        direction: Direction,
        _monitor: &mut dyn Monitor,
    ) -> Result<SmoothInterval> {
        self.looked = direction;
        if self.free {
            return Ok(SmoothInterval { length: f64::INFINITY, straight: true, breaks: false });
        }
        if self.tip == 0.0 && self.back == 0.0 {
            self.direction = direction;
        }
        let (length, straight) = match (direction == self.direction, self.back > 0.0) {
            (true, true) => (self.back, true),
            (true, false) => (self.next() - self.tip, self.breaks),
            (false, _) => (f64::INFINITY, true),
        };
        let ends = direction == self.direction && self.back == 0.0;
        Ok(SmoothInterval { length, straight, breaks: ends && self.breaks })
    }

    fn ahead(&self, by: f64) -> Response {
        if self.free {
            return Response { force: 0.0, tangent: 0.0 };
        }
        let sign = self.direction.sign();
        let on = sign * by;
        let Response { force, tangent } = if self.back == 0.0 && self.looked == self.direction {
            self.on_curve(self.tip + on)
        } else {
            Response { force: self.form.force(self.tip) - self.back + on, tangent: 1.0 }
        };
        Response { force: sign * force, tangent }
    }

    fn advance(&mut self, by: f64) -> Result<()> {
        let on = self.direction.sign() * by;
        self.work += RULE.integrate(0.0, by, |a| self.ahead(a).force);
        self.position += by;
        if self.free {
            return Ok(());
        }
        assert!(self.breaks || !self.held, "the curve does not show which contacts have not broken since");
        if self.back > 0.0 || on < 0.0 {
            self.back = (self.back - on).max(0.0);
        } else {
            let end = self.next();
            let left = if self.breaks { end.next_down() } else { end };
            self.tip = if on >= end - self.tip { left } else { self.tip + on };
        }
        Ok(())
    }

    fn cross(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        self.tip = self.tip.next_up();
        self.free = self.held;
        Ok(())
    }

    fn reset(&mut self, direction: Direction, _monitor: &mut dyn Monitor) -> Result<()> {
        self.before = self.energies().lost + self.elastic();
        self.broken = self.energies().broken + if self.free { 0.0 } else { 1.0 };
        (self.held, self.free) = (false, false);
        (self.tip, self.back, self.work, self.direction) = (0.0, 0.0, 0.0, direction);
        Ok(())
    }

    fn hold(&mut self) -> Result<()> {
        self.held = true;
        Ok(())
    }

    fn release(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        (self.held, self.free) = (false, false);
        Ok(())
    }

    fn mark(&mut self) {
        self.marked = None;
        self.marked = Some(Box::new(self.clone()));
    }

    fn recall(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        if let Some(marked) = self.marked.take() {
            *self = *marked;
        }
        Ok(())
    }

    fn energies(&self) -> ContactEnergies {
        let elastic = self.elastic();
        let broken = self.broken + (self.moments)(self.tip).1;
        ContactEnergies {
            elastic,
            lost: self.before + self.work - elastic,
            broken,
            ..ContactEnergies::default()
        }
    }

    fn copy(&self) -> Box<dyn Population> {
        Box::new(self.clone())
    }

    fn state(&self) -> ContactsState {
        unimplemented!("nobody keeps it")
    }

    fn restore(&mut self, _state: &ContactsState, _monitor: &mut dyn Monitor) -> Result<()> {
        unimplemented!("nobody keeps it")
    }
}
