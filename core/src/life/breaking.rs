//! How the contacts of a layer break as the slider advances: integrals over ν.

use super::cells::{CELL, Detail, scale, threshold_atoms, top, with_atoms};
use super::layer::{Layer, PointMass};
use super::panels::{Domain, Panels};
use crate::law::{Atom, Breakpoint, Law, Zone};

/// Moments of the breaking stretches are computed up to the fourth.
pub(super) const MOMENTS: usize = 5;

/// A layer, and the distribution of the thresholds of its contacts.
pub(super) struct Breaking<'a> {
    thresholds: &'a dyn Law,
    layer: &'a Layer,
    /// Breakpoints and point masses of P_c.
    hazards: Vec<Breakpoint>,
    /// Positions of the point masses of P_c.
    threshold_atoms: Vec<f64>,
    /// Stretches between which all but a negligible fraction breaks.
    window: (f64, f64),
    /// ν in parts that resolve P_c, too.
    panels: Panels<'a>,
    /// Advances at which point masses of ν reach point masses of P_c: the threshold, and the fraction that
    /// breaks there.
    pub(super) simultaneous: Vec<(f64, Atom)>,
}

impl<'a> Breaking<'a> {
    pub(super) fn new(thresholds: &'a dyn Law, layer: &'a Layer, detail: Detail) -> Self {
        let Detail { negligible, .. } = detail;
        let mut breaking = Self {
            thresholds,
            layer,
            hazards: with_atoms(thresholds),
            threshold_atoms: threshold_atoms(thresholds),
            window: (thresholds.quantile(negligible), last_threshold(thresholds, layer, negligible)),
            panels: Panels::new(&layer.density, 2.0 * CELL * scale(thresholds), negligible),
            simultaneous: Vec::new(),
        };
        breaking.simultaneous = breaking.simultaneous();
        breaking
    }

    fn simultaneous(&self) -> Vec<(f64, Atom)> {
        let meets = |point_mass: &PointMass, atom: &Atom| {
            let met = Atom { position: atom.position, weight: point_mass.weight * atom.weight };
            let unbroken = self.layer.exceeded(point_mass, 0.0, &self.threshold_atoms) < atom.position;
            unbroken.then_some(((atom.position - point_mass.position).max(0.0), met))
        };
        let shared = self.thresholds.atoms();
        let pairs = shared
            .iter()
            .flat_map(|atom| self.layer.point_masses.iter().map(move |point_mass| (point_mass, atom)));
        let mut simultaneous: Vec<_> =
            pairs.filter_map(|(point_mass, atom)| meets(point_mass, atom)).collect();
        simultaneous.sort_by(|a, b| a.0.total_cmp(&b.0));
        simultaneous
    }

    /// The advance at which the first contacts break.
    pub(super) fn onset(&self) -> f64 {
        self.layer.ahead
    }

    /// Breakpoints and point masses of the breaking density after its onset, as functions of the advance:
    /// where one of P_c meets one of ν, and where the lower bound of the integral, set by contacts that have
    /// been stretched further in the other direction, passes one of either.
    pub(super) fn breakpoints(&self) -> Vec<Breakpoint> {
        let Layer { ahead, behind, .. } = *self.layer;
        let starts = self.layer.all_breaks();
        let mut out: Vec<Breakpoint> = self
            .simultaneous
            .iter()
            .map(|(u, met)| Atom { position: *u, weight: met.weight }.into())
            .collect();
        for hazard in &self.hazards {
            for start in &starts {
                let met = hazard.convolve(start.mirrored());
                let beyond = met.position >= ahead && hazard.position + start.position >= behind;
                if beyond && !(hazard.is_atom() && start.is_atom()) {
                    out.push(met);
                }
            }
        }
        // The lower bound moves at half the velocity of the slider.
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

    /// The advance after which survival and second moment are negligible.
    pub(super) fn end(&self) -> f64 {
        self.layer.range().map_or(0.0, |(low, _)| self.window.1 - low)
    }

    /// Where contacts break, as advances: the zones of P_c, broadened by the spread of stretches.
    pub(super) fn zones(&self) -> Vec<Zone> {
        let blur = if self.layer.point_masses.is_empty() { self.layer.resolution } else { 0.0 };
        let seen = |z: Zone, (low, high): (f64, f64)| Zone {
            low: z.low - high,
            high: z.high - low,
            resolution: z.resolution.max(blur),
        };
        let zones = self.thresholds.zones().into_iter();
        zones.filter_map(|zone| Some(seen(zone, self.layer.range()?))).collect()
    }

    /// Advances at which cell boundaries of ν reach a point mass of P_c.
    pub(super) fn seams(&self) -> impl Iterator<Item = f64> {
        self.threshold_atoms
            .iter()
            .flat_map(|atom| self.layer.density.boundaries.iter().map(move |r| atom - r))
    }

    /// ∫ν(x) weight(x + u, y) dx with y the largest stretch reached, point masses included.
    fn mean(&self, u: f64, weight: impl Fn(f64, f64) -> f64) -> f64 {
        let exceeded = |point_mass: &PointMass| self.layer.exceeded(point_mass, u, &self.threshold_atoms);
        let point_masses = self.layer.point_masses.iter();
        let together: f64 = point_masses.map(|l| l.weight * weight(l.position + u, exceeded(l))).sum();
        let (forth, back) = (self.layer.ahead.max(u), self.layer.behind);
        // The integrand has a kink wherever y(x) passes a breakpoint of P_c, on either branch of y:
        // Gauss points must not straddle these.
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

    /// Moments of the stretches at which contacts break at the advance u, without point masses.
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
        let point_masses = self.layer.point_masses.iter().filter(|l| l.position >= lowest);
        point_masses.for_each(|l| add(l.position + u, l.weight * law.density(l.position + u)));
        let threshold_atoms = self.hazards.iter().filter(|b| b.is_atom() && b.position - u >= lowest);
        threshold_atoms.for_each(|b| add(b.position, b.amplitude * self.layer.density.value(b.position - u)));
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

/// The threshold beyond which S and its second moment are negligible, given the mass of ν.
fn last_threshold(law: &dyn Law, layer: &Layer, negligible: f64) -> f64 {
    let whole = layer.density.integral() + layer.point_masses.iter().map(|l| l.weight).sum::<f64>();
    let left = 1.0 / whole.max(1.0);
    let mut last = top(law, negligible * left);
    let second = law.upper_moment(2, -1.0);
    while law.upper_moment(2, last) > 1e-16 * left * second {
        last *= 1.25;
    }
    last
}
