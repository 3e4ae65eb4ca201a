//! How the contacts of a layer break as the slider goes on: integrals over ν.

use super::cells::{CELL, Detail, scale, top, walls, with_atoms};
use super::layer::{Layer, PointMass};
use super::panels::{Domain, Panels};
use crate::law::{Atom, Breakpoint, Law, Zone};

/// Moments of the breaking stretches are kept up to the fourth.
pub(super) const MOMENTS: usize = 5;

/// A layer and the law of the thresholds that its contacts have still to reach.
pub(super) struct Breaking<'a> {
    thresholds: &'a dyn Law,
    layer: &'a Layer,
    /// Breaks and atoms of P_c.
    hazards: Vec<Breakpoint>,
    /// Thresholds that many share.
    walls: Vec<f64>,
    /// Stretches between which contacts break, but for a negligible part.
    window: (f64, f64),
    /// ν in parts that resolve P_c, too.
    panels: Panels<'a>,
    /// Advances at which atoms of ν meet atoms of P_c: the threshold met, and the fraction that breaks there.
    pub(super) struck: Vec<(f64, Atom)>,
}

impl<'a> Breaking<'a> {
    pub(super) fn new(thresholds: &'a dyn Law, layer: &'a Layer, detail: Detail) -> Self {
        let Detail { negligible, .. } = detail;
        let mut breaking = Self {
            thresholds,
            layer,
            hazards: with_atoms(thresholds),
            walls: walls(thresholds),
            window: (thresholds.quantile(negligible), last_threshold(thresholds, layer, negligible)),
            panels: Panels::new(&layer.density, 2.0 * CELL * scale(thresholds), negligible),
            struck: Vec::new(),
        };
        breaking.struck = breaking.struck();
        breaking
    }

    fn struck(&self) -> Vec<(f64, Atom)> {
        let meets = |lump: &PointMass, wall: &Atom| {
            let met = Atom { position: wall.position, weight: lump.weight * wall.weight };
            let unbroken = self.layer.exceeded(lump, 0.0, &self.walls) < wall.position;
            unbroken.then_some(((wall.position - lump.position).max(0.0), met))
        };
        let shared = self.thresholds.atoms();
        let pairs = shared.iter().flat_map(|wall| self.layer.lumps.iter().map(move |lump| (lump, wall)));
        let mut struck: Vec<_> = pairs.filter_map(|(lump, wall)| meets(lump, wall)).collect();
        struck.sort_by(|a, b| a.0.total_cmp(&b.0));
        struck
    }

    /// The advance at which the first contacts break.
    pub(super) fn onset(&self) -> f64 {
        self.layer.ahead
    }

    /// Breaks and atoms of the breaking density past its onset, as functions of the advance: where one of P_c meets one of
    /// ν, and where one of either is passed by those who have been further on the other side.
    pub(super) fn breakpoints(&self) -> Vec<Breakpoint> {
        let Layer { ahead, behind, .. } = *self.layer;
        let starts = self.layer.all_breaks();
        let mut out: Vec<Breakpoint> =
            self.struck.iter().map(|(u, met)| Atom { position: *u, weight: met.weight }.into()).collect();
        for hazard in &self.hazards {
            for start in &starts {
                let met = hazard.convolve(start.mirrored());
                let beyond = met.position >= ahead && hazard.position + start.position >= behind;
                if beyond && !(hazard.is_atom() && start.is_atom()) {
                    out.push(met);
                }
            }
        }
        // The bound of the integral passes them at half the pace of the slider.
        let passed = |b: &Breakpoint, position: f64, factor: f64| {
            let amplitude = b.amplitude * factor * 0.5_f64.powf(b.exponent + 1.0);
            Breakpoint { position, exponent: b.exponent + 1.0, amplitude }
        };
        out.extend(starts.iter().map(|b| {
            let u = behind - 2.0 * b.position;
            passed(&b.mirrored(), u, self.thresholds.density(b.position + u))
        }));
        out.extend(self.hazards.iter().map(|b| {
            let u = 2.0 * b.position - behind;
            passed(b, u, -self.layer.density.value(b.position - u))
        }));
        out.retain(|b| b.position >= ahead && b.amplitude != 0.0);
        out
    }

    /// The advance after which nothing is left, nor of the second moment.
    pub(super) fn end(&self) -> f64 {
        self.layer.range().map_or(0.0, |(low, _)| self.window.1 - low)
    }

    /// Where contacts break, as advances: P_c as they see it, blurred by where they are.
    pub(super) fn zones(&self) -> Vec<Zone> {
        let blur = if self.layer.lumps.is_empty() { self.layer.resolution } else { 0.0 };
        let seen = |z: Zone, (low, high): (f64, f64)| Zone {
            low: z.low - high,
            high: z.high - low,
            resolution: z.resolution.max(blur),
        };
        let zones = self.thresholds.zones().into_iter();
        zones.filter_map(|zone| Some(seen(zone, self.layer.range()?))).collect()
    }

    /// Advances at which the cells of ν end for those who reach a threshold that many share.
    pub(super) fn seams(&self) -> impl Iterator<Item = f64> {
        self.walls.iter().flat_map(|wall| self.layer.density.boundaries.iter().map(move |r| wall - r))
    }

    /// ∫ν(x) weight(x + u, y) dx with y the largest stretch, atoms included.
    fn mean(&self, u: f64, weight: impl Fn(f64, f64) -> f64) -> f64 {
        let exceeded = |lump: &PointMass| self.layer.exceeded(lump, u, &self.walls);
        let lumps = self.layer.lumps.iter();
        let together: f64 = lumps.map(|l| l.weight * weight(l.position + u, exceeded(l))).sum();
        let (forth, back) = (self.layer.ahead.max(u), self.layer.behind);
        let places = |b: &Breakpoint| [b.position - forth, back - b.position];
        let everywhere = Domain {
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
            cuts: self.hazards.iter().flat_map(places).chain([self.layer.lowest(u)]).collect(),
            steep: self.hazards.iter().filter(|b| b.is_steep()).flat_map(places).collect(),
        };
        let mut spread = 0.0;
        self.panels.each(everywhere, |x, w| spread += w * weight(x + u, self.layer.largest(x, u)));
        together + spread
    }

    /// ∫ν(x) (x + u)^power M_moment(y) dx.
    pub(super) fn weighted(&self, u: f64, power: i32, moment: u32) -> f64 {
        let above = |y: f64| match moment {
            0 => self.thresholds.survival(y),
            _ => self.thresholds.upper_moment(moment, y),
        };
        self.mean(u, |x, y| x.powi(power) * above(y))
    }

    /// Moments of the stretches at which contacts break at the advance u, their density part.
    pub(super) fn moments(&self, u: f64) -> [f64; MOMENTS] {
        let mut sums = [0.0; MOMENTS];
        if u < self.layer.ahead {
            return sums;
        }
        let mut add = |x: f64, weight: f64| {
            let mut power = weight;
            for sum in &mut sums {
                *sum += power;
                power *= x;
            }
        };
        let (law, lowest) = (self.thresholds, self.layer.lowest(u));
        let lumps = self.layer.lumps.iter().filter(|l| l.position >= lowest);
        lumps.for_each(|l| add(l.position + u, l.weight * law.density(l.position + u)));
        let walls = self.hazards.iter().filter(|b| b.is_atom() && b.position - u >= lowest);
        walls.for_each(|b| add(b.position, b.amplitude * self.layer.density.value(b.position - u)));
        if self.layer.is_pointed() {
            return sums;
        }
        let place = |b: &Breakpoint| b.position - u;
        let domain = Domain {
            low: lowest.max(self.window.0 - u),
            high: self.window.1 - u,
            cuts: self.hazards.iter().filter(|b| !b.is_atom()).map(place).collect(),
            steep: self.hazards.iter().filter(|b| b.is_steep()).map(place).collect(),
        };
        self.panels.each(domain, |x, w| add(x + u, w * law.density(x + u)));
        sums
    }
}

/// Where S and its second moment are negligible, also for what ν weighs.
fn last_threshold(law: &dyn Law, layer: &Layer, negligible: f64) -> f64 {
    let whole = layer.density.integral() + layer.lumps.iter().map(|l| l.weight).sum::<f64>();
    let left = 1.0 / whole.max(1.0);
    let mut last = top(law, negligible * left);
    let second = law.upper_moment(2, -1.0);
    while law.upper_moment(2, last) > 1e-16 * left * second {
        last *= 1.25;
    }
    last
}
