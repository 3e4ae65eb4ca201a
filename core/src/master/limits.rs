//! Limits of kinetic friction for very fast and very slow sliding, and slow creep, in closed form.

use super::{MasterEquation, SteadyState};
use crate::Result;
use crate::contacts::{Ageing, Barrier, Contacts, Rules, Temperature};
use crate::law::{Law, SharedLaw};
use crate::monitor::Monitor;
use crate::numerics::breakpoints::Breakpoint;
use crate::numerics::legendre::RULE;
use crate::numerics::roots::brent_root;

/// The limits of F_k(v), where they exist.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Limits {
    /// F_k as v → ∞: that of fresh contacts without time dependence; with a delay of re-forming that of free contacts, N_c f, 0 by
    /// default, and infinite if their friction has a viscosity.
    pub fast: f64,
    /// F_k as v → 0: that of mature contacts. `None` where there is no plateau: thermal contacts flow
    /// viscously, fluctuating thresholds are eventually caught in their lower tail, logarithmic strengthening
    /// is unlimited.
    pub slow: Option<f64>,
    /// F_k/v as v → 0 for thermal contacts that do not age and re-form unstretched. `None` for others, and
    /// where the strongest contacts of a broad distribution last so long that there is no viscous flow, or free contacts have a
    /// constant friction force.
    pub viscosity: Option<f64>,
}

impl Limits {
    /// The limits of steady sliding of `contacts`.
    ///
    /// With ω₀ = w(0; x_s) the breaking rate of an unstretched contact, F_k/v → N_c⟨k ω₀⁻²⟩/(⟨ω₀⁻¹⟩ + τ). For
    /// Gaussian thresholds and the elastic barrier this is finite for T > 2⟨k⟩σ²; otherwise the average is
    /// dominated by ever fewer, stronger contacts. With the additive hazard ω₀ is its average ⟨ω₀⟩, and the limit is finite.
    ///
    /// # Errors
    /// Those of [`MasterEquation::new`] for the same contacts without rules; stopped by the monitor.
    pub fn of(contacts: &Contacts, monitor: &mut dyn Monitor) -> Result<Self> {
        let rules = &contacts.rules;
        let free = if rules.free_friction.viscosity > 0.0 {
            f64::INFINITY
        } else {
            contacts.count * rules.free_friction.force
        };
        let mut athermal =
            |thresholds: &SharedLaw| athermal(contacts, thresholds, monitor).map(|s| s.kinetic_friction());
        let without_rules = athermal(&contacts.thresholds)?;
        let slow = match (&contacts.rules.temperature, &contacts.rules.ageing) {
            (Some(_), _) | (None, Some(Ageing::Smoluchowski { .. } | Ageing::Logarithmic { .. })) => None,
            (None, Some(Ageing::FrozenRank { mature, .. } | Ageing::MeanField { mature, .. })) => {
                Some(athermal(mature)?)
            }
            (None, None) => Some(without_rules),
        };
        Ok(Self {
            fast: if rules.delay.is_none() { without_rules } else { free },
            slow,
            viscosity: viscosity(contacts),
        })
    }
}

/// Steady sliding of the same contacts with these thresholds, without time-dependent rules.
fn athermal(contacts: &Contacts, thresholds: &SharedLaw, monitor: &mut dyn Monitor) -> Result<SteadyState> {
    let bare = Contacts { thresholds: thresholds.clone(), rules: Rules::default(), ..contacts.clone() };
    Ok(MasterEquation::reformed(bare, None, monitor)?.steady_state())
}

/// The temperature, if there is a closed form for slow flow: contacts do not age and re-form unstretched.
fn temperature_of_simple_contacts(contacts: &Contacts) -> Option<&Temperature> {
    let unstretched = contacts.reforming.survival(0.0) == 0.0;
    let ageless = contacts.rules.ageing.is_none();
    contacts.rules.temperature.as_ref().filter(|_| unstretched && ageless)
}

fn viscosity(contacts: &Contacts) -> Option<f64> {
    let temperature = temperature_of_simple_contacts(contacts)?;
    let stiffness = |h: f64| contacts.stiffness.of(h);
    let life = |h: f64| temperature.exponent(0.0, h, stiffness(h)) - temperature.attempt_rate.ln();
    let law = contacts.thresholds.as_ref();
    let [carried, mean] = if temperature.is_additive() {
        // All break at one rate, whatever their threshold.
        let mean = -ln_average(law, |h| -life(h))?;
        [ln_average(law, |h| stiffness(h).ln())? + 2.0 * mean, mean]
    } else {
        [ln_average(law, |h| stiffness(h).ln() + 2.0 * life(h))?, ln_average(law, life)?]
    };
    // ln(1 + τ/⟨ω₀⁻¹⟩).
    let Rules { ref delay, free_friction, .. } = contacts.rules;
    let free = (delay.mean().ln() - mean).exp().ln_1p();
    // The fraction of free contacts does not depend on the velocity.
    let of_free = free_friction.viscosity * -(-free).exp_m1();
    let viscosity = contacts.count * (carried - mean - free).exp() + contacts.count * of_free;
    (viscosity.is_finite() && free_friction.force == 0.0).then_some(viscosity)
}

/// Kinetic friction of slow creep, well below athermal friction but far from viscous flow: a force.
///
/// With g = −ΔE/T, the cumulative hazard of a contact of one threshold up to the stretch x is A(x) = (w/v
/// g')(1 + g''/g'² + …). It breaks when A reaches an exponentially distributed number, whose logarithm has
/// the mean −γ, γ = 0.577… (Euler's constant), and the variance π²/6. An expansion around the x_b at which
/// w/(v g') = e^{−γ} gives
///
/// ⟨x⟩ = x_b − (1 + π²/12) g''/g'³, ⟨x²⟩ = ⟨x⟩² + π²/(6 g'²), F_k ≈ ½N_c⟨k⟨x²⟩⟩/(⟨⟨x⟩⟩ + v⟨τ⟩),
///
/// where the outer means are over thresholds. The next terms are smaller by 1/(x_b g') and by T/ΔE(x_b): for
/// identical thresholds F_k is right to 1 % wherever `creep` returns it, x_b g' ≥ 6 and ΔE(x_b) ≥ 3T, and
/// mostly to 0.3 %.
///
/// `None` for contacts that age or re-form stretched, for the additive hazard, and at velocities outside this regime for more than
/// the weakest and the strongest fifth of the contacts: with so many F_k is still right to 1 %.
pub fn creep(contacts: &Contacts, velocity: f64) -> Option<f64> {
    /// Largest fraction of the contacts below, and of those above, the thresholds of this regime.
    const OUTSIDE: f64 = 0.2;
    let temperature =
        temperature_of_simple_contacts(contacts).filter(|temperature| !temperature.is_additive())?;
    let law = contacts.thresholds.as_ref();
    let thermal = |h: f64| Thermal::new(temperature, h, contacts.stiffness.of(h), velocity);
    if ![law.quantile(OUTSIDE), law.upper_quantile(OUTSIDE)].into_iter().all(|h| thermal(h).creeps()) {
        return None;
    }
    let moment = |power: i32| {
        let of = |h: f64| {
            let (first, second) = thermal(h).breaking_stretch();
            if power == 1 { first.ln() } else { contacts.stiffness.of(h).ln() + second.ln() }
        };
        ln_average(law, of).map(f64::exp)
    };
    let (square, mean) = (moment(2)?, moment(1)?);
    let free = velocity * contacts.rules.delay.mean();
    let friction = contacts.rules.free_friction.at(velocity) * free;
    Some(contacts.count * (0.5 * square + friction) / (mean + free))
}

/// Contacts of one threshold that break thermally at a velocity.
struct Thermal {
    barrier: Barrier,
    threshold: f64,
    /// E₀/T.
    height: f64,
    /// ln(ωx_s/v).
    attempts: f64,
}

impl Thermal {
    fn new(temperature: &Temperature, threshold: f64, stiffness: f64, velocity: f64) -> Self {
        let height = 0.5 * stiffness * threshold * threshold / temperature.energy;
        let attempts = (temperature.attempt_rate * threshold / velocity).ln();
        Self { barrier: temperature.barrier, threshold, height, attempts }
    }

    /// ΔE/T at y = x/x_s, and the first and second derivatives of −ΔE/T with respect to y.
    fn barrier(&self, y: f64) -> [f64; 3] {
        let left = (1.0 - y).sqrt();
        let of_height = match self.barrier {
            Barrier::Elastic => [1.0 - y * y, 2.0 * y, 2.0],
            Barrier::Bell => [1.0 - y, 1.0, 0.0],
            Barrier::Catastrophe => [left.powi(3), 1.5 * left, -0.75 / left],
        };
        of_height.map(|part| self.height * part)
    }

    /// x_b/x_s: 0 for viscous flow, 1 where contacts break at their threshold.
    fn typical(&self) -> f64 {
        /// γ.
        const EULER: f64 = 0.577_215_664_901_532_9;
        let excess = |y: f64| {
            let [left, steepness, _] = self.barrier(y);
            self.attempts - left - steepness.ln() + EULER
        };
        // Up to here the barrier has fallen by less than T, or by half of it: the rate is still that at rest.
        let least = 1.0 / self.height;
        let first = if self.barrier == Barrier::Elastic { (0.5 * least).sqrt() } else { least };
        let last = 1.0 - 1e-6;
        if first >= last || excess(first) >= 0.0 {
            return 0.0;
        }
        brent_root(excess, first, last, 1e-12).unwrap_or(1.0)
    }

    /// Whether contacts break thermally, and after a considerable stretch.
    fn creeps(&self) -> bool {
        /// Smallest x_b g'.
        const STRETCHED: f64 = 6.0;
        /// Smallest ΔE(x_b)/T.
        const LEFT: f64 = 3.0;
        let y = self.typical();
        let [left, steepness, _] = self.barrier(y);
        y * steepness >= STRETCHED && left >= LEFT
    }

    /// ⟨x⟩ and ⟨x²⟩ of the stretches at which contacts break.
    fn breaking_stretch(&self) -> (f64, f64) {
        /// π²/6, the variance of the logarithm of an exponentially distributed number.
        const SCATTER: f64 = std::f64::consts::PI * std::f64::consts::PI / 6.0;
        let y = self.typical();
        if y == 0.0 || y == 1.0 {
            return (y * self.threshold, (y * self.threshold).powi(2));
        }
        let [_, steepness, bend] = self.barrier(y);
        // Where the barrier has nearly vanished the threshold limits the stretch, not the expansion.
        let mean = (y - bend / steepness.powi(3) * (1.0 + 0.5 * SCATTER)).clamp(0.0, 1.0);
        let square = (mean * mean + SCATTER / (steepness * steepness)).min(1.0);
        (mean * self.threshold, square * self.threshold * self.threshold)
    }
}

/// Contributions below e^−45 of the largest are neglected.
const FAINT: f64 = 45.0;

/// ln⟨e^g⟩ over a distribution; `None` if it is not finite.
///
/// e^g may grow by hundreds of orders of magnitude while the density falls by as many. As in Laplace's method
/// the maximum of their product is located first; Gauss rules then integrate around it, on panels on which
/// its logarithm changes little.
fn ln_average(law: &dyn Law, g: impl Fn(f64) -> f64) -> Option<f64> {
    let ln_density = |h: f64| match law.density(h) {
        // Where the density underflows, ln P_c = ln P + ln S still has all digits: neither the
        // hazard rate P nor ln S underflows.
        density if density > f64::MIN_POSITIVE => density.ln(),
        _ => law.hazard(h).ln() + law.ln_survival(h),
    };
    // ∞ − ∞ occurs beyond a compact support.
    let f = |h: f64| Some(ln_density(h) + g(h)).filter(|f| !f.is_nan()).unwrap_or(f64::NEG_INFINITY);
    let panel_boundaries = panel_boundaries(law, &f)?;
    let atoms = law.atoms().into_iter().map(|atom| atom.weight.ln() + g(atom.position));
    let panel_boundaries = graded_towards_poles(law, panel_boundaries);
    // Inside the boundaries, at which a density may jump.
    let inside = |pair: &[f64]| {
        let width = pair[1] - pair[0];
        [1e-9, 0.5, 1.0 - 1e-9].map(|part| f(pair[0] + part * width) + width.ln())
    };
    let most =
        atoms.clone().chain(panel_boundaries.windows(2).flat_map(inside)).fold(f64::NEG_INFINITY, f64::max);
    // Sums are relative to the largest panel, whose integral may over- or underflow by itself.
    let atoms: f64 = atoms.map(|atom| (atom - most).exp()).sum();
    let panels = panel_boundaries.windows(2).map(|pair| panel(&|h| f(h) - most, [pair[0], pair[1]], 0));
    let sum = atoms + panels.sum::<f64>();
    (sum.is_finite() && sum > 0.0).then(|| most + sum.ln())
}

/// ∫e^f over an interval, bisected until f changes little on each part.
fn panel(f: &impl Fn(f64) -> f64, [low, high]: [f64; 2], depth: u32) -> f64 {
    const LITTLE: f64 = 3.0;
    const MOST_HALVINGS: u32 = 40;
    let nodes = RULE.nodes.map(|t| f(low + 0.5 * (high - low) * (1.0 + t)));
    let (least, most) =
        nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &f| (a.min(f), b.max(f)));
    if most + (high - low).ln() < -FAINT {
        return 0.0;
    }
    if most - least > LITTLE && depth < MOST_HALVINGS {
        let middle = 0.5 * (low + high);
        return panel(f, [low, middle], depth + 1) + panel(f, [middle, high], depth + 1);
    }
    0.5 * (high - low) * nodes.iter().zip(&RULE.weights).map(|(f, w)| w * f.exp()).sum::<f64>()
}

/// Boundaries of panels that resolve a distribution up to where e^f is negligible; `None` if it never is.
fn panel_boundaries(law: &dyn Law, f: &impl Fn(f64) -> f64) -> Option<Vec<f64>> {
    /// Thresholds are scanned up to this many means.
    const FARTHEST: f64 = 1e8;
    const MOST_PANELS: f64 = 1e5;
    let zones = law.zones();
    let mut panel_boundaries: Vec<f64> = law.breakpoints().iter().map(|b| b.position).collect();
    for zone in &zones {
        let panels = ((zone.high - zone.low) / zone.resolution).ceil().clamp(1.0, 1024.0);
        panel_boundaries
            .extend((0..=panels as usize).map(|i| zone.low + (zone.high - zone.low) * i as f64 / panels));
    }
    let end = panel_boundaries.iter().fold(0.0, |end, &boundary| f64::max(end, boundary));
    if law.quantile(1.0).is_infinite() {
        let mean = law.mean();
        let ahead =
            std::iter::successors(Some(1e-2 * mean), |h| Some(1.02 * h).filter(|&h| h < FARTHEST * mean));
        let seen: Vec<(f64, f64)> = ahead.map(|h| (h, f(h))).collect();
        let most = seen.iter().fold(f64::NEG_INFINITY, |most, seen| most.max(seen.1));
        let last = seen.iter().rposition(|seen| seen.1 > most - FAINT)?;
        let far = seen.get(last + 1)?.0;
        let resolution = zones.iter().map(|zone| zone.resolution).fold(f64::INFINITY, f64::min);
        // A long tail varies on the scale of its distance.
        let step =
            |h: &f64| Some(h + resolution.max(0.02 * h)).filter(|&h| h < far + resolution.max(0.02 * h));
        if far > end {
            if (far - end) / resolution > MOST_PANELS {
                return None;
            }
            panel_boundaries.extend(std::iter::successors(Some(end), step));
        }
    }
    panel_boundaries.sort_by(f64::total_cmp);
    panel_boundaries.dedup();
    Some(panel_boundaries)
}

/// Adds boundaries towards poles of the density.
fn graded_towards_poles(law: &dyn Law, mut panel_boundaries: Vec<f64>) -> Vec<f64> {
    let resolution = law.zones().iter().map(|zone| zone.resolution).fold(f64::INFINITY, f64::min);
    let poles = law.breakpoints().into_iter().filter(|b| b.exponent < 0.0 && !b.is_atom());
    panel_boundaries.extend(poles.flat_map(|pole| graded(pole, resolution)));
    panel_boundaries.sort_by(f64::total_cmp);
    panel_boundaries.dedup();
    panel_boundaries
}

/// Boundaries within a width above a pole, each half as far from it as the one before: Gauss rules on panels in proportion to their
/// distance see no pole. Contacts between the pole and the last of them are negligible.
fn graded(pole: Breakpoint, width: f64) -> impl Iterator<Item = f64> {
    const NEGLIGIBLE: f64 = 1e-18;
    /// The distance of the last one is a number, whatever the exponent.
    const MOST: f64 = 900.0;
    let halvings = (-NEGLIGIBLE.log2() / (1.0 + pole.exponent)).min(MOST) as i32;
    (0..=halvings).map(move |k| pole.position + width * 0.5_f64.powi(k))
}
