//! How the contacts of a layer break as the slider advances: integrals over ν.

use super::cells::{CELL, Detail, scale, threshold_atoms, top, with_atoms};
use super::layer::{Layer, PointMass};
use super::panels::{Domain, Panels};
use crate::contacts::{Stiffness, StiffnessTable};
use crate::law::{Atom, Breakpoint, Law, Zone};
use crate::numerics::order::sort_by_number;

/// Moments of the breaking stretches are computed up to the fourth.
pub(super) const MOMENTS: usize = 5;

/// Moments with a table of stiffnesses.
pub(super) const TABLE_MOMENTS: usize = 7;

/// A layer, and the distribution of the thresholds of its contacts.
pub(super) struct Breaking<'a> {
    thresholds: &'a dyn Law,
    layer: &'a Layer,
    /// Breakpoints and point masses of P_c.
    hazards: Vec<Breakpoint>,
    /// Kinks of the stiffness against the threshold.
    kinks: Vec<Breakpoint>,
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
            kinks: Vec::new(),
            threshold_atoms: threshold_atoms(thresholds),
            window: (thresholds.quantile(negligible), last_threshold(thresholds, layer, negligible)),
            panels: Panels::new(&layer.density, 2.0 * CELL * scale(thresholds), negligible),
            simultaneous: Vec::new(),
        };
        breaking.simultaneous = breaking.simultaneous();
        breaking
    }

    /// The same contacts with this stiffness: sums over them are not smooth at the kinks of a table.
    pub(super) fn carrying(mut self, stiffness: &Stiffness) -> Self {
        let kink = |(position, change): (f64, f64)| Breakpoint {
            position,
            exponent: 1.0,
            amplitude: change * self.thresholds.density(position),
        };
        let kinks = stiffness.table().into_iter().flat_map(StiffnessTable::kinks).map(kink);
        self.kinks = kinks.filter(|kink| kink.amplitude != 0.0).collect();
        self
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
        sort_by_number(&mut simultaneous, |item| item.0);
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
        let mut out: Vec<Breakpoint> = self
            .simultaneous
            .iter()
            .map(|(u, met)| Atom { position: *u, weight: met.weight }.into())
            .collect();
        out.extend(self.met(&self.hazards));
        out.extend(self.layer.all_breaks().iter().map(|b| {
            let u = behind - 2.0 * b.position;
            passed(&b.mirrored(), u, self.thresholds.density(b.position + u))
        }));
        out.extend(self.hazards.iter().map(|b| self.passed_by_bound(b)));
        // Where a pole of P_c is itself passed, its density has no value: what follows from it is among those that are met.
        out.retain(|b| b.position >= ahead && b.amplitude != 0.0 && b.amplitude.is_finite());
        out
    }

    /// Where the force of unbroken contacts has kinks that the breaking density has not: at those of the stiffness. Spread
    /// starts blur them; what is left is smooth on the cells of ν, moved along.
    pub(super) fn kinks(&self) -> Vec<Breakpoint> {
        let mut out = self.met(&self.kinks);
        let (cells, mass) = (&self.layer.density.boundaries, self.layer.density.integral());
        let blurred = |kink: &Breakpoint| {
            let Breakpoint { position, exponent, amplitude } = *kink;
            cells.iter().map(move |r| Breakpoint {
                position: position - r,
                exponent,
                amplitude: amplitude * mass,
            })
        };
        out.extend(self.kinks.iter().flat_map(blurred));
        out.extend(self.kinks.iter().map(|b| self.passed_by_bound(b)));
        out.retain(|b| b.position >= self.layer.ahead && b.amplitude != 0.0);
        out
    }

    /// Where breakpoints of thresholds meet those of ν.
    fn met(&self, hazards: &[Breakpoint]) -> Vec<Breakpoint> {
        let Layer { ahead, behind, .. } = *self.layer;
        let starts = self.layer.all_breaks();
        let mut out = Vec::new();
        for hazard in hazards {
            for start in &starts {
                let met = hazard.convolve(start.mirrored());
                let beyond = met.position >= ahead && hazard.position + start.position >= behind;
                if beyond && !(hazard.is_atom() && start.is_atom()) {
                    out.push(met);
                }
            }
        }
        out
    }

    /// Where the lower bound of the integral passes a breakpoint of thresholds.
    fn passed_by_bound(&self, b: &Breakpoint) -> Breakpoint {
        let u = 2.0 * b.position - self.layer.behind;
        passed(b, u, -self.layer.density.value(b.position - u))
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
            cuts: self
                .hazards
                .iter()
                .chain(&self.kinks)
                .flat_map(places)
                .chain([self.layer.lowest(u)])
                .collect(),
            steep: self.hazards.iter().filter(|b| b.is_steep()).flat_map(places).collect(),
        };
        let mut spread = 0.0;
        self.panels.each(everywhere, |x, w| spread += w * weight(x + u, self.layer.largest(x, u)));
        together + spread
    }

    /// ∫ν(x) (x + u)^power ∫_y^∞ kʲ hⁿ P_c(h) dh dx, k in its unit.
    pub(super) fn carried(&self, u: f64, power: i32, stiffness: &Stiffness, [j, n]: [u32; 2]) -> f64 {
        match stiffness {
            Stiffness::Equal(_) => self.weighted(u, power, n),
            Stiffness::PerThreshold(_) => self.weighted(u, power, j + n),
            Stiffness::Tabulated(table) => {
                self.mean(u, |x, y| x.powi(power) * table.moment_above(self.thresholds, y, j, n))
            }
        }
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
        self.sums(u, |x, weight| {
            let mut power = weight;
            std::array::from_fn(|_| {
                let moment = power;
                power *= x;
                moment
            })
        })
    }

    /// The same sums of 1, k, kh, kh², k², k²h and k²h² for a table of stiffness against the threshold h.
    pub(super) fn moments_with(&self, u: f64, table: &StiffnessTable) -> [f64; TABLE_MOMENTS] {
        self.sums(u, |h, weight| {
            let k = table.at(h);
            [1.0, k, k * h, k * h * h, k * k, k * k * h, k * k * h * h].map(|term| weight * term)
        })
    }

    /// Sums over contacts that break at the advance u, of `terms(stretch, weight)`.
    fn sums<const N: usize>(&self, u: f64, terms: impl Fn(f64, f64) -> [f64; N]) -> [f64; N] {
        let mut sums = [0.0; N];
        if u < self.layer.ahead {
            return sums;
        }
        let mut add = |x: f64, weight: f64| {
            sums.iter_mut().zip(terms(x, weight)).for_each(|(sum, term)| *sum += term);
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
            cuts: self.hazards.iter().chain(&self.kinks).filter(|b| !b.is_atom()).map(place).collect(),
            steep: self.hazards.iter().filter(|b| b.is_steep()).map(place).collect(),
        };
        self.panels.each(domain, |x, w| add(x + u, w * law.density(x + u)));
        sums
    }
}

/// A breakpoint as the lower bound passes it, which moves at half the velocity of the slider.
fn passed(b: &Breakpoint, position: f64, factor: f64) -> Breakpoint {
    let amplitude = b.amplitude * factor * 0.5_f64.powf(b.exponent + 1.0);
    Breakpoint { position, exponent: b.exponent + 1.0, amplitude }
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
