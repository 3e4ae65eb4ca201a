//! The life of contacts that know neither time nor temperature: they break when the stretch reaches the threshold.

use super::Life;
use crate::contacts::{Contacts, Stiffness};
use crate::law::{Atom, Break, Law, SharedLaw, Zone};
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;

/// What a curve leaves out, of a total of 1 (or of the mean life, force, …).
const RESOLUTION: f64 = 1e-14;

/// Survival and starting mass below this are left out.
const NEGLIGIBLE: f64 = 1e-18;

/// The life of contacts that start at stretches drawn from `starts`.
///
/// With `conditional`, the threshold of a contact that starts at r is drawn from P_c given x_s > r (equation:
/// ν = R/S); otherwise stretch and threshold are independent, and the fraction ∫R(1 − S) breaks at u = 0.
///
/// Only the moments b_n(u) = ∫ν(r) (r+u)ⁿ P_c(r+u) dr of what breaks are computed by quadrature; what is carried
/// follows from what breaks later: with s the survival, m the force and q its square,
/// s' = −b₀, m' = s − b₁, q' = 2m − b₂. For k = κ x_s, one order of ξ more: see `per_threshold`.
///
/// Contacts and starts are taken to have passed [`Contacts::check`].
pub fn athermal(contacts: &Contacts, starts: &SharedLaw, conditional: bool) -> Life {
    let Contacts { thresholds, stiffness, .. } = contacts;
    let births = Births::new(contacts, starts, conditional);
    let breaks = births.breaks();
    let end = births.end();
    let edges = births.edges(&breaks, end);
    let moments = Piecewise::resolve_all(|u| births.breaking(u), &edges, end, RESOLUTION);
    let carried = Carried { births: &births, moments: &moments, end };
    let survival = carried.survival();
    let (force, square) = match *stiffness {
        Stiffness::Equal(_) => carried.equal(&survival),
        Stiffness::PerThreshold(_) => carried.per_threshold(),
    };
    let smoother: Vec<_> = breaks.iter().map(|&b| Break { exponent: b.exponent + 1.0, ..b }).collect();
    let kernel = |curve: Piecewise| Kernel::new(curve, smoother.clone());
    let (survival, force, square) = (kernel(survival), kernel(force), kernel(square));
    let [breaking, ..] = moments;
    let breaking = Kernel::new(breaking, breaks);
    let Births { density, atoms, .. } = births;
    Life {
        survival,
        breaking,
        force,
        square,
        births: density,
        birth_atoms: atoms,
        thresholds: thresholds.clone(),
    }
}

/// Moments of the breaking stretches are kept up to the fourth.
const MOMENTS: usize = 5;

/// What is carried, from what breaks: integrals from the end of life back to u.
struct Carried<'a> {
    births: &'a Births<'a>,
    moments: &'a [Piecewise; MOMENTS],
    end: f64,
}

impl Carried<'_> {
    /// ∫_u^∞ of `falls`, with the jumps b_order at atoms and the value at the end.
    fn back(&self, falls: &Piecewise, order: i32, last: impl Fn(f64) -> f64) -> Piecewise {
        let jump = |(u, b): &(f64, Atom)| (*u, b.weight * b.position.powi(order));
        let jumps: Vec<_> = self.births.struck.iter().map(jump).collect();
        falls.integrated_from_end(self.births.mean(last, self.end), &jumps)
    }

    fn survival(&self) -> Piecewise {
        self.back(&self.moments[0], 0, |x| self.births.thresholds.survival(x))
    }

    /// Force and square: m' = s − b₁, q' = 2m − b₂.
    fn equal(&self, survival: &Piecewise) -> (Piecewise, Piecewise) {
        let law = self.births.thresholds;
        let force = self.back(&self.moments[1].plus(-1.0, survival), 1, |x| x * law.survival(x));
        let square = self.back(&self.moments[2].plus(-2.0, &force), 2, |x| x * x * law.survival(x));
        (force, square)
    }

    /// With t_n = ∫ν M_n and w = ∫ν x M₂: t_n' = −b_n, m' = t₁ − b₂, w' = t₂ − b₃, q' = 2w − b₄.
    fn per_threshold(&self) -> (Piecewise, Piecewise) {
        let law = self.births.thresholds;
        let first = self.back(&self.moments[1], 1, |x| law.upper_moment(1, x));
        let force = self.back(&self.moments[2].plus(-1.0, &first), 2, |x| x * law.upper_moment(1, x));
        let second = self.back(&self.moments[2], 2, |x| law.upper_moment(2, x));
        let half = self.back(&self.moments[3].plus(-1.0, &second), 3, |x| x * law.upper_moment(2, x));
        let square = self.back(&self.moments[4].plus(-2.0, &half), 4, |x| x * x * law.upper_moment(2, x));
        (force, square)
    }
}

/// ν: the law of starting stretches, over their survival where conditional.
struct Births<'a> {
    thresholds: &'a dyn Law,
    starts: &'a dyn Law,
    conditional: bool,
    /// The highest start.
    top: f64,
    density: Piecewise,
    atoms: Vec<Atom>,
    /// Breaks and atoms of P_c.
    hazards: Vec<Break>,
    /// Advances at which atoms of ν meet atoms of P_c: the threshold met, and the fraction that breaks there.
    struck: Vec<(f64, Atom)>,
    /// Gauss points of the density: stretch and weight.
    points: Vec<(f64, f64)>,
}

impl<'a> Births<'a> {
    fn new(contacts: &'a Contacts, starts: &'a SharedLaw, conditional: bool) -> Self {
        let (thresholds, starts) = (contacts.thresholds.as_ref(), starts.as_ref());
        let all = starts.upper_quantile(NEGLIGIBLE);
        let top = if conditional { all.min(contacts.highest_start()) } else { all };
        let over = |r: f64| if conditional { thresholds.survival(r) } else { 1.0 };
        let atoms =
            starts.atoms().into_iter().map(|a| Atom { weight: a.weight / over(a.position), ..a }).collect();
        let hazards = with_atoms(thresholds);
        let (density, struck, points) = (Piecewise::default(), Vec::new(), Vec::new());
        let mut births =
            Self { thresholds, starts, conditional, top, density, atoms, hazards, struck, points };
        births.struck = births.struck();
        if !starts.zones().is_empty() {
            let breaks: Vec<f64> = births.start_breaks().iter().map(|b| b.position).collect();
            let edges = edges(&starts.zones(), &breaks, top);
            births.density = Piecewise::resolve(|r| starts.density(r) / over(r), &edges, top, RESOLUTION);
            births.points = births.density.points(births.widest());
            births.points.retain(|p| p.1 > 1e-3 * NEGLIGIBLE);
        }
        births
    }

    /// Widest interval of r on which P_c(r + u) is resolved between its breaks.
    fn widest(&self) -> f64 {
        CELL * self.thresholds.zones().iter().map(|zone| zone.resolution).fold(f64::INFINITY, f64::min)
    }

    fn over(&self, r: f64) -> f64 {
        if self.conditional { self.thresholds.survival(r) } else { 1.0 }
    }

    fn struck(&self) -> Vec<(f64, Atom)> {
        let meets = |r: &Atom, b: &Break| {
            let met = Atom { position: b.position, weight: r.weight * b.amplitude };
            (b.position > r.position).then_some((b.position - r.position, met))
        };
        let walls: Vec<_> = self.hazards.iter().filter(|b| b.is_atom()).collect();
        let mut struck: Vec<_> =
            self.atoms.iter().flat_map(|r| walls.iter().filter_map(move |b| meets(r, b))).collect();
        struck.sort_by(|a, b| a.0.total_cmp(&b.0));
        struck
    }

    /// Breaks and atoms of ν: those of the starts, and those that dividing by S adds where thresholds overlap.
    fn start_breaks(&self) -> Vec<Break> {
        let scaled = |b: Break| Break { amplitude: b.amplitude / self.over(b.position), ..b };
        let mut breaks: Vec<_> = with_atoms(self.starts).into_iter().map(scaled).collect();
        if self.conditional {
            breaks.extend(self.hazards.iter().filter_map(|b| {
                let survival = self.thresholds.survival(b.position);
                let amplitude = b.amplitude * self.starts.density(b.position) / (survival * survival);
                let met = Break { exponent: b.exponent + 1.0, amplitude, ..*b };
                (survival > 0.0 && amplitude != 0.0).then_some(met)
            }));
        }
        breaks
    }

    /// Breaks and atoms of the breaking density: where one of P_c meets one of ν, and at u = 0.
    fn breaks(&self) -> Vec<Break> {
        let starts = self.start_breaks();
        let meets = |b: &Break, r: &Break| Break { position: b.position - r.position, ..b.convolve(*r) };
        let pairs = self.hazards.iter().flat_map(|b| starts.iter().map(move |r| meets(b, r)));
        let mut out: Vec<_> =
            pairs.filter(|met| met.position > 0.0 || met.position == 0.0 && !met.is_atom()).collect();
        let [first, ..] = self.breaking(0.0);
        if first > 0.0 && first.is_finite() && !out.iter().any(|b| b.position == 0.0) {
            out.push(Break { position: 0.0, exponent: 0.0, amplitude: first });
        }
        let unbroken = if self.conditional { 1.0 } else { self.mean(|x| self.thresholds.survival(x), 0.0) };
        if 1.0 - unbroken > NEGLIGIBLE {
            out.push(Atom { position: 0.0, weight: 1.0 - unbroken }.into());
        }
        out.sort_by(|a, b| a.position.total_cmp(&b.position));
        out
    }

    /// The advance after which nothing is left, nor of the second moment.
    fn end(&self) -> f64 {
        let left = self.over(self.top);
        let mut last = self.thresholds.upper_quantile(NEGLIGIBLE * left);
        let whole = self.thresholds.upper_moment(2, -1.0);
        while self.thresholds.upper_moment(2, last) > 1e-16 * left * whole {
            last *= 1.25;
        }
        last - self.starts.quantile(0.0)
    }

    /// Cell boundaries of the life to begin with.
    fn edges(&self, breaks: &[Break], end: f64) -> Vec<f64> {
        let bottom = self.starts.quantile(0.0);
        let ahead = |z: Zone| Zone { low: z.low - self.top, high: z.high - bottom, ..z };
        let zones: Vec<Zone> = self.thresholds.zones().into_iter().map(ahead).collect();
        let breaks: Vec<f64> = breaks.iter().map(|b| b.position).collect();
        edges(&zones, &breaks, end)
    }

    /// ∫ν(r) weight(r + u) dr, atoms included, weight smooth where the density of ν is.
    fn mean(&self, weight: impl Fn(f64) -> f64, u: f64) -> f64 {
        let [mean] = self.means(|x| [weight(x)], u);
        mean
    }

    fn means<const K: usize>(&self, weights: impl Fn(f64) -> [f64; K], u: f64) -> [f64; K] {
        let mut sums = [0.0; K];
        let mut add = |r: f64, weight: f64| {
            let at = weights(r + u);
            (0..K).for_each(|k| sums[k] += weight * at[k]);
        };
        self.atoms.iter().for_each(|a| add(a.position, a.weight));
        let end = self.density.end();
        let mut cuts: Vec<f64> =
            self.hazards.iter().map(|b| b.position - u).filter(|&r| r > 0.0 && r < end).collect();
        if cuts.is_empty() {
            self.points.iter().for_each(|&(r, weight)| add(r, weight));
            return sums;
        }
        let widest = self.widest();
        cuts.extend_from_slice(&self.density.boundaries);
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.windows(2).filter(|pair| pair[1] > pair[0]) {
            let parts = ((pair[1] - pair[0]) / widest).ceil().max(1.0);
            let half = 0.5 * (pair[1] - pair[0]) / parts;
            for k in 0..parts as usize {
                let middle = pair[0] + (2 * k + 1) as f64 * half;
                for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
                    let r = middle + half * t;
                    add(r, half * w * self.density.value(r));
                }
            }
        }
        sums
    }

    /// Moments of the stretches at which contacts break at the advance u, their density part.
    fn breaking(&self, u: f64) -> [f64; MOMENTS] {
        let powers = |x: f64, p: f64| [p, p * x, p * x * x, p * x * x * x, p * x * x * x * x];
        let mut sums = self.means(|x| powers(x, self.thresholds.density(x)), u);
        for wall in self.hazards.iter().filter(|b| b.is_atom()) {
            let met = powers(wall.position, wall.amplitude * self.density.value(wall.position - u));
            (0..MOMENTS).for_each(|k| sums[k] += met[k]);
        }
        sums
    }
}

/// Width of the cells to begin with, in units of a zone's resolution: a Gaussian is then left out to 1e-14.
const CELL: f64 = 1.4;

/// Cell boundaries on [0, end] to begin with: the breaks, and cells as narrow as the zones that they lie in ask for.
fn edges(zones: &[Zone], breaks: &[f64], end: f64) -> Vec<f64> {
    let mut stops: Vec<f64> =
        zones.iter().flat_map(|z| [z.low, z.high]).chain(breaks.iter().copied()).collect();
    stops.retain(|&u| u > 0.0 && u < end);
    stops.push(end);
    stops.sort_by(f64::total_cmp);
    let mut edges = vec![0.0];
    for stop in stops {
        let at = edges[edges.len() - 1];
        let over = zones.iter().filter(|z| z.low < stop && z.high > at);
        let Some(resolution) = over.map(|z| z.resolution).reduce(f64::min) else {
            // A long tail, if anything: it varies on the scale of its distance.
            edges.extend(
                std::iter::successors(Some(2.0 * at), |u| Some(2.0 * u))
                    .take_while(|&u| at > 0.0 && u < stop),
            );
            edges.push(stop);
            continue;
        };
        let count = ((stop - at) / (CELL * resolution) - 1e-9).ceil().max(1.0);
        let inner = (1..count as usize).map(|k| at + (stop - at) * k as f64 / count);
        edges.extend(inner.chain([stop]));
    }
    edges
}

fn with_atoms(law: &dyn Law) -> Vec<Break> {
    law.breaks().into_iter().chain(law.atoms().into_iter().map(Break::from)).collect()
}
