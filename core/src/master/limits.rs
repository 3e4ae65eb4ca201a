//! What kinetic friction tends to as the slider moves very fast or very slowly, in closed form.

use super::{MasterEquation, SteadyState};
use crate::Result;
use crate::contacts::{Ageing, Barrier, Contacts, Initial, Rules, Start, Stiffness, Temperature};
use crate::law::{Law, Point, SharedLaw};
use crate::numerics::legendre::RULE;
use crate::numerics::roots::brent_root;

/// The limits of F_k(v), where there are such.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// F_k as v → ∞: the athermal one of newborn contacts; 0 where broken contacts are free for a while.
    pub fast: f64,
    /// F_k as v → 0: that of mature contacts. `None` where there is no such plateau: thermal contacts flow, thresholds that
    /// fluctuate are caught low for ever, logarithmic strengthening has no end.
    pub slow: Option<f64>,
    /// F_k/v as v → 0 of thermal contacts that do not age and re-form unstretched; `None` for others, and where the
    /// strongest contacts of a broad law hold so long that there is no viscous flow.
    pub viscosity: Option<f64>,
}

impl Limits {
    /// The limits of steady sliding of `contacts`.
    ///
    /// With ω₀ = w(0; x_s), the rate at which an unstretched contact breaks, F_k/v → N_c⟨k ω₀⁻²⟩/(⟨ω₀⁻¹⟩ + τ).
    ///
    /// # Errors
    /// Those of [`MasterEquation::new`] for the same contacts without rules.
    pub fn of(contacts: &Contacts) -> Result<Self> {
        let free = contacts.rules.delay > 0.0;
        let athermal = |thresholds: &SharedLaw| athermal(contacts, thresholds).map(|s| s.kinetic_friction());
        let newborn = athermal(&contacts.thresholds)?;
        let slow = match (&contacts.rules.temperature, &contacts.rules.ageing) {
            (Some(_), _) | (None, Some(Ageing::Smoluchowski { .. } | Ageing::Logarithmic { .. })) => None,
            (None, Some(Ageing::FrozenRank { mature, .. } | Ageing::MeanField { mature, .. })) => {
                Some(athermal(mature)?)
            }
            (None, None) => Some(newborn),
        };
        Ok(Self { fast: if free { 0.0 } else { newborn }, slow, viscosity: viscosity(contacts) })
    }
}

/// Steady sliding of the same contacts with these thresholds, without rules.
fn athermal(contacts: &Contacts, thresholds: &SharedLaw) -> Result<SteadyState> {
    let bare = Contacts { thresholds: thresholds.clone(), rules: Rules::default(), ..contacts.clone() };
    let rest = Initial { law: std::sync::Arc::new(Point::new(0.0)?), start: Start::Conditional };
    Ok(MasterEquation::new(bare, &rest)?.steady_state())
}

/// The temperature of contacts for whose slow flow there is a closed form: they do not age and re-form unstretched.
fn simple(contacts: &Contacts) -> Option<&Temperature> {
    let unstretched = contacts.reforming.survival(0.0) == 0.0;
    let ageless = contacts.rules.ageing.is_none();
    contacts.rules.temperature.as_ref().filter(|_| unstretched && ageless)
}

/// The stiffness of one contact.
fn own(stiffness: Stiffness, threshold: f64) -> f64 {
    match stiffness {
        Stiffness::Equal(k) => k,
        Stiffness::PerThreshold(kappa) => kappa * threshold,
    }
}

fn viscosity(contacts: &Contacts) -> Option<f64> {
    let temperature = simple(contacts)?;
    let stiffness = |h: f64| own(contacts.stiffness, h);
    let life = |h: f64| 1.0 / temperature.rate(0.0, h, stiffness(h));
    let law = contacts.thresholds.as_ref();
    let carried = average(law, |h| stiffness(h) * life(h) * life(h))?;
    let mean = average(law, life)?;
    Some(contacts.count * carried / (mean + contacts.rules.delay))
}

/// Kinetic friction of slow creep, well below its threshold but far from viscous flow, a force:
/// F_k ≈ ½N_c⟨k x_b²⟩/(⟨x_b⟩ + vτ), where a contact breaks typically at the x_b at which its rate of breaking per advance
/// ahead has grown to T w(x_b)/(v |∂ΔE/∂x|) = e^{−γ}, γ = 0.577… (Euler's constant).
///
/// `None` for contacts that age or re-form stretched, and at velocities for which no such x_b lies below the mean threshold.
pub fn creep(contacts: &Contacts, velocity: f64) -> Option<f64> {
    let temperature = simple(contacts)?;
    let law = contacts.thresholds.as_ref();
    let place = |h: f64| breaking_stretch(temperature, h, own(contacts.stiffness, h), velocity);
    let typical = place(law.mean());
    if typical <= 0.0 || typical >= law.mean() {
        return None;
    }
    let square = average(law, |h| own(contacts.stiffness, h) * place(h).powi(2))?;
    let mean = average(law, place)?;
    Some(0.5 * contacts.count * square / (mean + velocity * contacts.rules.delay))
}

/// The stretch x_b at which a contact typically breaks in slow creep: 0 where it flows, its threshold where heat comes late.
fn breaking_stretch(temperature: &Temperature, threshold: f64, stiffness: f64, velocity: f64) -> f64 {
    /// e^{−γ}.
    const TYPICAL: f64 = 0.561_459_483_566_885_2;
    let whole = 0.5 * stiffness * threshold * threshold;
    // −∂(ΔE/E₀)/∂y at y = x/x_s
    let steepness = |y: f64| match temperature.barrier {
        Barrier::Elastic => 2.0 * y,
        Barrier::Bell => 1.0,
        Barrier::Catastrophe => 1.5 * (1.0 - y).sqrt(),
    };
    let ahead = |y: f64| {
        let rate = temperature.rate(y * threshold, threshold, stiffness);
        rate * temperature.energy * threshold / (velocity * whole * steepness(y))
    };
    let excess = |y: f64| (ahead(y) / TYPICAL).ln();
    // Up to here the barrier has fallen by less than T: the rate is still that at rest.
    let least = temperature.energy / whole;
    let first = if temperature.barrier == Barrier::Elastic { (0.5 * least).sqrt() } else { least };
    let last = 1.0 - 1e-6;
    if first >= last || excess(first) >= 0.0 {
        return 0.0;
    }
    brent_root(excess, first, last, 1e-12).map_or(threshold, |y| y * threshold)
}

/// ⟨g⟩ over a law; `None` where it is not finite or its tail rules.
fn average(law: &dyn Law, g: impl Fn(f64) -> f64) -> Option<f64> {
    let atoms: f64 = law.atoms().iter().map(|atom| atom.weight * g(atom.position)).sum();
    let mut walls: Vec<f64> = law.breaks().iter().map(|b| b.position).collect();
    for zone in law.zones() {
        let panels = ((zone.high - zone.low) / zone.resolution).ceil().clamp(1.0, 1024.0);
        walls.extend((0..=panels as usize).map(|i| zone.low + (zone.high - zone.low) * i as f64 / panels));
    }
    walls.sort_by(f64::total_cmp);
    walls.dedup();
    let weigh = |h: f64| {
        let density = law.density(h);
        if density > 0.0 { density * g(h) } else { 0.0 }
    };
    let panels: Vec<f64> = walls.windows(2).map(|pair| RULE.integrate(pair[0], pair[1], weigh)).collect();
    let sum = atoms + panels.iter().sum::<f64>();
    let tail = panels.last().copied().unwrap_or(0.0);
    (sum.is_finite() && (law.quantile(1.0).is_finite() || tail.abs() < 1e-6 * sum.abs())).then_some(sum)
}
