//! The life of time-independent contacts, which break when the stretch reaches the threshold.

use super::breaking::Breaking;
use super::cells::{BULK, CELL, NEGLIGIBLE, ORDERS, ROUNDING, edges, scale, top};
use super::layer::Layer;
use super::{Life, Starts};
use crate::Result;
use crate::contacts::{Contacts, Stiffness};
use crate::law::{Atom, Breakpoint, SharedLaw, Zone};
use crate::monitor::{Cost, Monitor, Watch};
use crate::numerics::order::sort_by_number;
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
/// those x that exceed what they have reached before; with a table of stiffnesses k(h), those of kʲhⁿ. The
/// carried force follows by integration: see [`Carried::curves`].
pub(super) fn of_layers(
    contacts: &Contacts,
    layers: Vec<Layer>,
    broken: Option<Atom>,
    watch: &Watch<'_>,
) -> Life {
    match &contacts.stiffness {
        Stiffness::Equal(_) | Stiffness::PerThreshold(_) => {
            of_moments(contacts, layers, broken, watch, |b, u| b.moments(u))
        }
        Stiffness::Tabulated(table) => {
            of_moments(contacts, layers, broken, watch, |b, u| b.moments_with(u, table))
        }
    }
}

/// The same, by these moments of one layer at an advance.
fn of_moments<const N: usize>(
    contacts: &Contacts,
    layers: Vec<Layer>,
    broken: Option<Atom>,
    watch: &Watch<'_>,
    moments: impl Fn(&Breaking<'_>, f64) -> [f64; N],
) -> Life {
    let (law, stiffness) = (contacts.thresholds.as_ref(), &contacts.stiffness);
    let breaking: Vec<_> =
        layers.iter().map(|layer| Breaking::new(law, layer, BULK).carrying(stiffness)).collect();
    let mut breakpoints: Vec<Breakpoint> = breaking.iter().flat_map(Breaking::breakpoints).collect();
    let onsets: Vec<f64> = breaking.iter().map(Breaking::onset).collect();
    let end = breaking.iter().map(Breaking::end).fold(0.0, f64::max);
    let stops = breakpoints.iter().map(|b| b.position).chain(onsets.iter().copied());
    let kinks: Vec<Breakpoint> = breaking.iter().flat_map(Breaking::kinks).collect();
    let stops = stops.chain(kinks.iter().map(|kink| kink.position));
    let stops: Vec<f64> = stops.chain(breaking.iter().flat_map(Breaking::seams)).collect();
    let edges = edges(&zones(&breaking), &stops, end);
    let sum = |u: f64| {
        let add = |a: [f64; N], b: [f64; N]| std::array::from_fn(|i| a[i] + b[i]);
        breaking.iter().map(|b| moments(b, u)).fold([0.0; N], add)
    };
    let (mut moments, missed) = Piecewise::resolve_all(
        |u| if watch.stops() { [0.0; N] } else { sum(u) },
        &edges,
        end,
        BULK.resolution,
    );
    watch.cost(Cost::LifeCells, moments[0].coefficients.len());
    weigh_pole(&mut moments[0], &breakpoints, &breaking);
    breakpoints.extend(broken.map(Breakpoint::from));
    let wide = 0.25 * scale(law);
    onsets.into_iter().for_each(|onset| begin(&mut breakpoints, &moments[0], onset, wide));
    Breakpoint::sort(&mut breakpoints);
    // Integration from the end of life makes tails accurate relative to themselves.
    let carried = Carried::new(stiffness, &breaking, &moments, end);
    // Survival, force and energies are integrals of the breaking density: their breakpoints are one
    // order smoother.
    let integrated = |breakpoints: &[Breakpoint]| -> Vec<Breakpoint> {
        breakpoints.iter().map(|&b| Breakpoint { exponent: b.exponent + 1.0, ..b }).collect()
    };
    let smoother = integrated(&breakpoints);
    let kinked = if kinks.is_empty() {
        smoother.clone()
    } else {
        let mut all: Vec<_> = smoother.iter().copied().chain(integrated(&kinks)).collect();
        Breakpoint::sort(&mut all);
        all
    };
    let kernel = |curve: Piecewise| Kernel::new(curve, kinked.clone());
    let survival = carried.survival();
    let LifeCurves { force, square, energy, breaking_energy } = carried.curves(&survival);
    let falls = moments.into_iter().next().expect("the zeroth moment");
    Life {
        survival: Kernel::new(survival, smoother),
        force: kernel(force),
        square: kernel(square),
        energy: kernel(energy),
        breaking_energy: kernel(breaking_energy),
        breaking: Kernel::new(falls, breakpoints),
        starts: Starts::Layers { layers, thresholds: contacts.thresholds.clone() },
        wait: 0.0,
        waiting: None,
        stiffness: contacts.stiffness.mean_weight(law),
        error: ROUNDING.max(missed),
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
    stiffness: &'a Stiffness,
    breaking: &'a [Breaking<'a>],
    /// b of hⁿ; with a table, in the order of [`Breaking::moments_with`].
    moments: &'a [Piecewise],
    end: f64,
    simultaneous: Vec<(f64, Atom)>,
}

impl<'a> Carried<'a> {
    fn new(
        stiffness: &'a Stiffness,
        breaking: &'a [Breaking<'a>],
        moments: &'a [Piecewise],
        end: f64,
    ) -> Self {
        let mut simultaneous: Vec<_> = breaking.iter().flat_map(|b| b.simultaneous.iter().copied()).collect();
        sort_by_number(&mut simultaneous, |item| item.0);
        Self { stiffness, breaking, moments, end, simultaneous }
    }

    /// The breaking moment b of kʲhⁿ.
    fn moment(&self, [j, n]: [u32; 2]) -> &Piecewise {
        let place = match (self.stiffness, j) {
            (Stiffness::Equal(_), _) => n,
            (Stiffness::PerThreshold(_), _) => j + n,
            (Stiffness::Tabulated(_), 0) => 0,
            (Stiffness::Tabulated(_), j) => 3 * j - 2 + n,
        };
        &self.moments[place as usize]
    }

    /// kʲhⁿ of a contact with the threshold h.
    fn weight(&self, [j, n]: [u32; 2], threshold: f64) -> f64 {
        let [j, n] = [j as i32, n as i32];
        match self.stiffness {
            Stiffness::Equal(_) => threshold.powi(n),
            Stiffness::PerThreshold(_) => threshold.powi(j + n),
            Stiffness::Tabulated(table) => table.at(threshold).powi(j) * threshold.powi(n),
        }
    }

    /// ∫_u^∞ of `falls`, with jumps of kʲhⁿ, `jump` = [j, n], at point masses, and at the end
    /// ∫ν x^power ∫ kʲhⁿ P_c for `last` = (power, [j, n]).
    fn back(&self, falls: &Piecewise, jump: [u32; 2], (power, last): (i32, [u32; 2])) -> Piecewise {
        let of = |(u, b): &(f64, Atom)| (*u, b.weight * self.weight(jump, b.position));
        let jumps: Vec<_> = self.simultaneous.iter().map(of).collect();
        let last = |b: &Breaking<'_>| b.carried(self.end, power, self.stiffness, last);
        falls.integrated_from_end(self.breaking.iter().map(last).sum(), &jumps)
    }

    fn survival(&self) -> Piecewise {
        self.back(self.moment([0, 0]), [0, 0], (0, [0, 0]))
    }

    /// With K_jn = ∫_y^∞ kʲhⁿ P_c, the sums t_j = ∫ν K_j0, m = ∫ν x K₁₀, e = ∫ν x² K₁₀, w = ∫ν x K₂₀, q = ∫ν x² K₂₀ and
    /// l = ∫ν K₁₂, and b_jn the breaking moment of kʲhⁿ: t_j' = −b_j0, m' = t₁ − b₁₁, e' = 2m − b₁₂, w' = t₂ − b₂₁,
    /// q' = 2w − b₂₂, l' = −b₁₂. For equal stiffnesses in the unit of k, t_j is the survival, w = m and q = e.
    fn curves(&self, survival: &Piecewise) -> LifeCurves {
        let equal = self.stiffness.is_equal();
        let stiffness = |j| {
            if equal { survival.clone() } else { self.back(self.moment([j, 0]), [j, 0], (0, [j, 0])) }
        };
        let first = |j| self.back(&self.moment([j, 1]).plus(-1.0, &stiffness(j)), [j, 1], (1, [j, 0]));
        let second =
            |j, first: &Piecewise| self.back(&self.moment([j, 2]).plus(-2.0, first), [j, 2], (2, [j, 0]));
        let force = first(1);
        let energy = second(1, &force);
        let square = if equal { energy.clone() } else { second(2, &first(2)) };
        let broken = self.back(self.moment([1, 2]), [1, 2], (0, [1, 2]));
        LifeCurves { force, square, energy: energy.scaled(0.5), breaking_energy: broken.scaled(0.5) }
    }
}
