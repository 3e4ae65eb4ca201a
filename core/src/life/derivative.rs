//! How the life of contacts changes with a parameter.

use super::Life;
use super::breaking::Breaking;
use super::cells::{BULK, CELL, scale, with_atoms};
use super::layer::Layer;
use crate::Result;
use crate::contacts::Contacts;
use crate::law::{Breakpoint, Law, SharedLaw};
use crate::monitor::{Monitor, Watch};
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::{Piecewise, Resolution};
use crate::numerics::volterra::Kernel;

/// The derivatives of survival and of the carried force by a parameter θ, as functions of the advance u, per
/// contact and unit stiffness.
#[derive(Debug, Clone)]
pub(crate) struct LifeDerivative {
    survival: Kernel,
    force: Kernel,
}

/// Truncation error of a derivative, relative to its largest value and the mean life.
const RESOLUTION: f64 = 1e-13;

impl LifeDerivative {
    /// ∂S/∂θ.
    pub(crate) fn survival(&self) -> &Kernel {
        &self.survival
    }

    /// ∂m/∂θ.
    pub(crate) fn force(&self) -> &Kernel {
        &self.force
    }

    /// By a parameter of the thresholds, for time-independent contacts of equal stiffness that start at stretches
    /// drawn from `starts`; `derivative` is ∂S/∂θ of the thresholds, `life` their life.
    ///
    /// ∂/∂θ ∫ν(r) S(r + u) dr = ∫ν(r) \[S_θ(r + u) − S(r + u) S_θ(r)/S(r)\] dr, without the second term where
    /// thresholds are independent of stretches.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(crate) fn of_thresholds(
        contacts: &Contacts,
        (starts, conditional): (&SharedLaw, bool),
        life: &Life,
        derivative: &dyn Fn(f64) -> f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let law = contacts.thresholds.as_ref();
        let layer = Layer::placed(contacts, starts.as_ref(), conditional, BULK);
        let breaking = Breaking::new(law, &layer, BULK);
        let held = |r: f64| if conditional { derivative(r) / law.survival(r) } else { 0.0 };
        let change = |x: f64, y: f64, u: f64| derivative(y) - held(x - u) * law.survival(y);
        let values = |u: f64| {
            breaking.means(u, |x, y| {
                let change = change(x, y, u);
                [change, x * change]
            })
        };
        Self::resolved(life, values, monitor)
    }

    /// By a parameter of the starting stretches; `derivative` is its ∂S/∂θ.
    ///
    /// With h(r, u) = S(r + u)/S(r), or S(r + u) where thresholds are independent of stretches, partial integration
    /// gives ∂/∂θ ∫R(r) h dr = ∫S_θ(r) ∂h/∂r dr, which needs no derivative of a density with edges.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(crate) fn of_starts(
        contacts: &Contacts,
        (starts, conditional): (&SharedLaw, bool),
        life: &Life,
        derivative: &dyn Fn(f64) -> f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let held = Held { thresholds: contacts.thresholds.as_ref(), conditional };
        let panels = panels(contacts, starts, conditional);
        let values = |u: f64| held.integrals(&panels, u, derivative);
        Self::resolved(life, values, monitor)
    }

    /// Both curves on the cells of a life, refined where they need it.
    fn resolved(life: &Life, values: impl Fn(f64) -> [f64; 2], monitor: &mut dyn Monitor) -> Result<Self> {
        let watch = Watch::new(monitor);
        let curve = life.survival().curve();
        let middles = (0..curve.coefficients.len()).map(|cell| curve.cell(cell).0);
        let size = |[survival, force]: [f64; 2]| survival.abs().max(force.abs() / life.mean());
        let largest = middles.map(|u| size(watch.value(|| values(u)))).fold(0.0, f64::max);
        let resolution = Resolution::Mean(RESOLUTION * largest * life.mean());
        let curves =
            Piecewise::resolve_all(|u| watch.value(|| values(u)), &curve.boundaries, curve.end(), resolution);
        watch.check()?;
        Ok(Self::of_curves(life, curves))
    }

    /// From the curves of survival and force on cells that end where the breaking density is not smooth.
    fn of_curves(life: &Life, curves: [Piecewise; 2]) -> Self {
        let breakpoints = life.breaking().breakpoints().iter();
        // A breakpoint that moves with θ keeps the order that it has in the breaking density.
        let kept = |b: &Breakpoint| if b.is_atom() { Breakpoint { exponent: 0.0, ..*b } } else { *b };
        let breakpoints: Vec<_> = breakpoints.map(kept).collect();
        let [survival, force] = curves.map(|curve| Kernel::new(curve, breakpoints.clone()));
        Self { survival, force }
    }

    /// By differences of lives: Σ weight × (above − below) on the cells of `life`.
    pub(crate) fn by_differences(life: &Life, pairs: &[(f64, Life, Life)]) -> Self {
        let curve = life.survival().curve();
        let differences = |of: fn(&Life) -> &Kernel| {
            let value = |u: f64| {
                let at = |life: &Life| of(life).curve().value(u);
                pairs.iter().map(|(weight, above, below)| weight * (at(above) - at(below))).sum::<f64>()
            };
            let cell = |cell: usize| {
                let (middle, half) = curve.cell(cell);
                RULE.coefficients(&RULE.nodes.map(|t| value(middle + half * t)))
            };
            let coefficients = (0..curve.coefficients.len()).map(cell).collect();
            Piecewise { boundaries: curve.boundaries.clone(), coefficients }
        };
        Self::of_curves(life, [differences(Life::survival), differences(Life::force)])
    }
}

/// Boundaries of panels on which a distribution of starts, and the thresholds of contacts there, are smooth.
fn panels(contacts: &Contacts, starts: &SharedLaw, conditional: bool) -> Vec<f64> {
    let layer = Layer::placed(contacts, starts.as_ref(), conditional, BULK);
    let mut ends = layer.density.boundaries;
    ends.extend(layer.point_masses.iter().map(|mass| mass.position));
    ends.extend(starts.breakpoints().iter().map(|b| b.position));
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let widest = 2.0 * CELL * scale(contacts.thresholds.as_ref());
    let cut = |pair: &[f64]| {
        let (low, width) = (pair[0], pair[1] - pair[0]);
        let parts = (width / widest).ceil().max(1.0);
        (0..parts as usize).map(move |part| low + width * part as f64 / parts)
    };
    let mut panels: Vec<f64> = ends.windows(2).flat_map(cut).collect();
    panels.extend(ends.last());
    panels
}

/// The survival h(r, u) of contacts that start at r.
struct Held<'a> {
    thresholds: &'a dyn Law,
    conditional: bool,
}

impl Held<'_> {
    fn over(&self, r: f64) -> f64 {
        if self.conditional { self.thresholds.survival(r) } else { 1.0 }
    }

    /// h and ∂h/∂r, without the jumps.
    fn at(&self, r: f64, u: f64) -> (f64, f64) {
        let over = self.over(r);
        let held = self.thresholds.survival(r + u) / over;
        let lost = if self.conditional { self.thresholds.density(r) * held } else { 0.0 };
        (held, (lost - self.thresholds.density(r + u)) / over)
    }

    /// ∫S_θ(r) ∂h/∂r dr and ∫S_θ(r) ∂\[(r + u) h\]/∂r dr.
    fn integrals(&self, panels: &[f64], u: f64, derivative: &dyn Fn(f64) -> f64) -> [f64; 2] {
        let (Some(&low), Some(&high)) = (panels.first(), panels.last()) else { return [0.0; 2] };
        let hazards = with_atoms(self.thresholds);
        let cuts =
            hazards.iter().flat_map(|b| [b.position - u, b.position]).filter(|r| (low..high).contains(r));
        let mut ends: Vec<f64> = panels.iter().copied().chain(cuts).collect();
        ends.sort_by(f64::total_cmp);
        let mut sums = [0.0; 2];
        for pair in ends.windows(2) {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            for (t, weight) in RULE.nodes.iter().zip(&RULE.weights) {
                let r = middle + half * t;
                let ((held, slope), weight) = (self.at(r, u), half * weight * derivative(r));
                sums[0] += weight * slope;
                sums[1] += weight * (held + (r + u) * slope);
            }
        }
        for atom in self.thresholds.atoms() {
            let mut jump = |r: f64, height: f64| {
                if (low..high).contains(&r) {
                    sums[0] += derivative(r) * height;
                    sums[1] += derivative(r) * (r + u) * height;
                }
            };
            let (reached, passed) = (atom.position - u, atom.position);
            jump(reached, -atom.weight / self.over(reached));
            if self.conditional {
                let after = self.over(passed);
                let fewer = 1.0 / after - 1.0 / (after + atom.weight);
                jump(passed, self.thresholds.survival(passed + u) * if after > 0.0 { fewer } else { 0.0 });
            }
        }
        sums
    }
}
