//! The life of time-independent contacts, which break when the stretch reaches the threshold.

use super::breaking::{Breaking, MOMENTS};
use super::cells::{BULK, CELL, NEGLIGIBLE, ORDERS, ROUNDING, edges, scale, top};
use super::layer::Layer;
use super::{Life, Starts};
use crate::Result;
use crate::contacts::{Contacts, Stiffness};
use crate::law::{Atom, Breakpoint, SharedLaw, Zone};
use crate::monitor::{Cost, Monitor, Watch};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;

/// The life of contacts that start at stretches drawn from `starts`.
///
/// With `conditional`, the threshold of a contact that starts at r is drawn from P_c given x_s > r (ν = R/S).
/// Otherwise stretch and threshold are independent, and the fraction ∫R(1 − S) breaks at u = 0.
///
/// Contacts and starts are assumed to have passed [`Contacts::check`].
///
/// # Errors
/// Stopped by the monitor.
pub fn athermal(
    contacts: &Contacts,
    starts: &SharedLaw,
    conditional: bool,
    monitor: &mut dyn Monitor,
) -> Result<Life> {
    let watch = Watch::new(monitor);
    let life = athermal_within(contacts, starts, conditional, &watch);
    watch.check().map(|()| life)
}

/// The same; invalid if the monitor asks to stop.
pub(super) fn athermal_within(
    contacts: &Contacts,
    starts: &SharedLaw,
    conditional: bool,
    watch: &Watch<'_>,
) -> Life {
    let layer = Layer::placed(contacts, starts.as_ref(), conditional, BULK);
    let law = contacts.thresholds.as_ref();
    let unbroken = if conditional { 1.0 } else { Breaking::new(law, &layer, BULK).weighted(0.0, 0, 0) };
    let broken = (1.0 - unbroken > NEGLIGIBLE).then_some(Atom { position: 0.0, weight: 1.0 - unbroken });
    of_layers(contacts, vec![layer], broken, watch)
}

/// Estimate of the number of cells in the life of contacts that start at stretches drawn from `starts`.
pub(crate) fn cells_of(contacts: &Contacts, starts: &SharedLaw) -> f64 {
    let (law, starts) = (contacts.thresholds.as_ref(), starts.as_ref());
    let range = top(starts, NEGLIGIBLE).min(top(law, NEGLIGIBLE)) - starts.quantile(0.0);
    let range = if starts.zones().is_empty() { 0.0 } else { range.max(0.0) };
    let blur = if starts.atoms().is_empty() { scale(starts) } else { 0.0 };
    let breaking = |zone: Zone| (zone.high - zone.low + range) / (CELL * zone.resolution.max(blur));
    law.zones().into_iter().map(breaking).sum::<f64>() + range / (2.0 * CELL * scale(law))
}

/// The life of the contacts of some layers, and of those that have just `broken`.
///
/// Only the moments b_n(u) = ∫ν(x) (x+u)ⁿ P_c(x+u) dx of breaking contacts are computed by quadrature, over
/// those x that exceed what they have reached before. The carried force follows by integration: with s the
/// survival, m the force and q its square, s' = −b₀, m' = s − b₁, q' = 2m − b₂. For k = κ x_s the moments are
/// of one order higher: see `per_threshold`.
pub(super) fn of_layers(
    contacts: &Contacts,
    layers: Vec<Layer>,
    broken: Option<Atom>,
    watch: &Watch<'_>,
) -> Life {
    let law = contacts.thresholds.as_ref();
    let breaking: Vec<_> = layers.iter().map(|layer| Breaking::new(law, layer, BULK)).collect();
    let mut breakpoints: Vec<Breakpoint> = breaking.iter().flat_map(Breaking::breakpoints).collect();
    let onsets: Vec<f64> = breaking.iter().map(Breaking::onset).collect();
    let end = breaking.iter().map(Breaking::end).fold(0.0, f64::max);
    let stops = breakpoints.iter().map(|b| b.position).chain(onsets.iter().copied());
    let stops: Vec<f64> = stops.chain(breaking.iter().flat_map(Breaking::seams)).collect();
    let edges = edges(&zones(&breaking), &stops, end);
    let mut moments =
        Piecewise::resolve_all(|u| watch.value(|| sum(&breaking, u)), &edges, end, BULK.resolution);
    watch.cost(Cost::LifeCells, moments[0].coefficients.len());
    weigh_pole(&mut moments[0], &breakpoints, &breaking);
    breakpoints.extend(broken.map(Breakpoint::from));
    let wide = 0.25 * scale(law);
    onsets.into_iter().for_each(|onset| begin(&mut breakpoints, &moments[0], onset, wide));
    breakpoints.sort_by(|a, b| a.position.total_cmp(&b.position));
    // Integration from the end of life makes tails accurate relative to themselves.
    let carried = Carried::new(&breaking, &moments, end);
    // Survival, force and energies are integrals of the breaking density: their breakpoints are one
    // order smoother.
    let smoother: Vec<_> =
        breakpoints.iter().map(|&b| Breakpoint { exponent: b.exponent + 1.0, ..b }).collect();
    let kernel = |curve: Piecewise| Kernel::new(curve, smoother.clone());
    let survival = carried.survival();
    let LifeCurves { force, square, energy, breaking_energy } = match contacts.stiffness {
        Stiffness::Equal(_) => carried.equal(&survival),
        Stiffness::PerThreshold(_) => carried.per_threshold(),
    };
    let [falls, ..] = moments;
    Life {
        survival: kernel(survival),
        force: kernel(force),
        square: kernel(square),
        energy: kernel(energy),
        breaking_energy: kernel(breaking_energy),
        breaking: Kernel::new(falls, breakpoints),
        starts: Starts::Layers { layers, thresholds: contacts.thresholds.clone() },
        wait: 0.0,
        stiffness: contacts.stiffness.weight(law.mean()),
        error: ROUNDING,
    }
}

/// Sets the mass of the first cell of the breaking density if that has a pole at 0, which no polynomial
/// follows.
fn weigh_pole(falls: &mut Piecewise, breakpoints: &[Breakpoint], breaking: &[Breaking<'_>]) {
    if !breakpoints.iter().any(|b| b.position == 0.0 && b.is_steep() && b.exponent < 0.0) {
        return;
    }
    let unbroken = |u: f64| breaking.iter().map(|b| b.weighted(u, 0, 0)).sum::<f64>();
    let width = falls.boundaries[1];
    falls.coefficients[0][0] += (unbroken(0.0) - unbroken(width)) / width - falls.coefficients[0][0];
}

/// Replaces the breakpoints at an onset by the jumps of the curve and its derivatives there, unless it is a
/// power that is not whole. Only the jump of the value is used if a cell is narrower than `wide`, since
/// derivatives are inaccurate there.
pub(super) fn begin(breakpoints: &mut Vec<Breakpoint>, curve: &Piecewise, onset: f64, wide: f64) {
    let there = |b: &Breakpoint| b.position == onset && !b.is_atom();
    let Some(cell) = curve.find(onset).filter(|_| !breakpoints.iter().any(|b| there(b) && b.is_steep()))
    else {
        return;
    };
    breakpoints.retain(|b| !there(b));
    let narrow =
        [Some(cell), cell.checked_sub(1)].into_iter().flatten().any(|k| 2.0 * curve.cell(k).1 < wide);
    breakpoints.extend(jumps(curve, onset, if narrow { 1 } else { ORDERS }));
}

/// The jumps of a curve (order 0) and of its derivatives at one of its boundaries, for the first `orders` ≤
/// [`ORDERS`] orders; zeros are omitted.
pub(super) fn jumps(curve: &Piecewise, at: f64, orders: usize) -> Vec<Breakpoint> {
    let Some(cell) = curve.find(at) else { return Vec::new() };
    let after: [f64; ORDERS] = curve.jet_in(cell, at);
    let before = cell.checked_sub(1).map_or([0.0; ORDERS], |left| curve.jet_in(left, at));
    let jump = |order: usize| Breakpoint {
        position: at,
        exponent: order as f64,
        amplitude: after[order] - before[order],
    };
    (0..orders).map(jump).filter(|b| b.amplitude != 0.0).collect()
}

/// Where contacts of all layers break: one zone for each of P_c.
fn zones(breaking: &[Breaking<'_>]) -> Vec<Zone> {
    let wider = |a: Zone, b: Zone| Zone {
        low: a.low.min(b.low),
        high: a.high.max(b.high),
        resolution: a.resolution.min(b.resolution),
    };
    let all: Vec<Vec<Zone>> =
        breaking.iter().map(Breaking::zones).filter(|zones| !zones.is_empty()).collect();
    let count = all.first().map_or(0, Vec::len);
    (0..count).filter_map(|k| all.iter().map(|zones| zones[k]).reduce(wider)).collect()
}

fn sum(breaking: &[Breaking<'_>], u: f64) -> [f64; MOMENTS] {
    let mut sums = [0.0; MOMENTS];
    for moments in breaking.iter().map(|b| b.moments(u)) {
        sums.iter_mut().zip(moments).for_each(|(sum, moment)| *sum += moment);
    }
    sums
}

/// The curves of the unbroken contacts.
struct LifeCurves {
    force: Piecewise,
    square: Piecewise,
    energy: Piecewise,
    breaking_energy: Piecewise,
}

/// Force and energies of the unbroken contacts, by integration of the breaking moments from the end of life
/// back to u.
struct Carried<'a> {
    breaking: &'a [Breaking<'a>],
    moments: &'a [Piecewise; MOMENTS],
    end: f64,
    simultaneous: Vec<(f64, Atom)>,
}

impl<'a> Carried<'a> {
    fn new(breaking: &'a [Breaking<'a>], moments: &'a [Piecewise; MOMENTS], end: f64) -> Self {
        let mut simultaneous: Vec<_> = breaking.iter().flat_map(|b| b.simultaneous.iter().copied()).collect();
        simultaneous.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { breaking, moments, end, simultaneous }
    }

    /// ∫_u^∞ of `falls`, with the jumps b_order at point masses and at the end ∫ν x^power M_moment.
    fn back(&self, falls: &Piecewise, order: i32, (power, moment): (i32, u32)) -> Piecewise {
        let jump = |(u, b): &(f64, Atom)| (*u, b.weight * b.position.powi(order));
        let jumps: Vec<_> = self.simultaneous.iter().map(jump).collect();
        let last = |b: &Breaking<'_>| b.weighted(self.end, power, moment);
        falls.integrated_from_end(self.breaking.iter().map(last).sum(), &jumps)
    }

    fn survival(&self) -> Piecewise {
        self.back(&self.moments[0], 0, (0, 0))
    }

    /// m' = s − b₁, q' = 2m − b₂, and t₂' = −b₂ for t_n = ∫ν M_n.
    fn equal(&self, survival: &Piecewise) -> LifeCurves {
        let force = self.back(&self.moments[1].plus(-1.0, survival), 1, (1, 0));
        let square = self.back(&self.moments[2].plus(-2.0, &force), 2, (2, 0));
        let broken = self.back(&self.moments[2], 2, (0, 2));
        LifeCurves { force, energy: square.clone().scaled(0.5), square, breaking_energy: broken.scaled(0.5) }
    }

    /// With t_n = ∫ν M_n, e = ∫ν x² M₁ and w = ∫ν x M₂: t_n' = −b_n, m' = t₁ − b₂, e' = 2m − b₃, w' = t₂ − b₃,
    /// q' = 2w − b₄.
    fn per_threshold(&self) -> LifeCurves {
        let first = self.back(&self.moments[1], 1, (0, 1));
        let force = self.back(&self.moments[2].plus(-1.0, &first), 2, (1, 1));
        let energy = self.back(&self.moments[3].plus(-2.0, &force), 3, (2, 1));
        let second = self.back(&self.moments[2], 2, (0, 2));
        let half = self.back(&self.moments[3].plus(-1.0, &second), 3, (1, 2));
        let square = self.back(&self.moments[4].plus(-2.0, &half), 4, (2, 2));
        let broken = self.back(&self.moments[3], 3, (0, 3));
        LifeCurves { force, square, energy: energy.scaled(0.5), breaking_energy: broken.scaled(0.5) }
    }
}
