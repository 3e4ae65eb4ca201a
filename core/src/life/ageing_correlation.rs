//! What a small step of the slider changes of the survival of contacts whose thresholds follow from age, without temperature.
//!
//! A contact that formed at the stretch r with the fresh threshold h₀ breaks at the advance u at which r + u = h(h₀; u/v). A step
//! δX before, at whatever advance, makes it break earlier by δX/(1 − h'/v) with h' = ∂h/∂t. So D = φ/(1 − h'/v)
//! ([`super::StepCorrelation`]), and with the fresh threshold y(u) of the contacts that break at u, φ = ν(r) P_c(y) dy/du and
//! dy/du = (1 − h'/v)/(∂h/∂h₀),
//!
//! C(u) = −∫_u^∞ Σ_r ν(r) P_c(y) h'/(v ∂h/∂h₀) du',
//!
//! C_x the same with the stretch r + u' under the integral.

use super::cells::{BULK, NEGLIGIBLE, edges, top};
use super::layer::{Layer, PointMass};
use super::running_maximum::RunningMaximum;
use crate::Result;
use crate::contacts::{Ageing, Contacts, Stiffness, ThresholdEvolution};
use crate::law::Zone;
use crate::monitor::{Counted, Watch};
use crate::numerics::piecewise::Piecewise;

/// The density of thresholds, per mean threshold, that is left out.
const FAINT: f64 = 1e-11;
/// Fresh thresholds that are above the stretch of formation by less, in mean thresholds, are met at once.
const AT_ONCE: f64 = 1e-6;
/// Largest error of C.
const ERROR: f64 = 1e-9;

/// C and C_x of contacts that slide at `velocity`; none where they re-form over a range of stretches, where thresholds have point
/// masses or diffuse, where stiffnesses differ, and where nothing breaks for a while between breaks: there a step moves contacts
/// from the end of the pause to its beginning.
///
/// # Errors
/// Those of [`ThresholdEvolution::of`]; stopped by the monitor.
pub(super) fn of(
    contacts: &Contacts,
    ageing: &Ageing,
    velocity: f64,
    watch: &Watch<'_>,
) -> Result<Option<[Piecewise; 2]>> {
    let law = contacts.thresholds.as_ref();
    let follows_age = matches!(ageing, Ageing::Logarithmic { .. } | Ageing::FrozenRank { .. });
    let starts = Layer::placed(contacts, contacts.reforming.as_ref(), true, BULK);
    let at_points = starts.density.coefficients.is_empty();
    let alike = matches!(contacts.stiffness, Stiffness::Equal(_));
    if !(follows_age && at_points && alike && law.atoms().is_empty()) {
        return Ok(None);
    }
    let evolution = ThresholdEvolution::of_with(contacts, &mut Counted(watch))?;
    let highest = top(law, NEGLIGIBLE);
    let lives = |mass: &PointMass| {
        let maximum = RunningMaximum::new(&evolution, velocity, mass.position, highest);
        (*mass, maximum)
    };
    let lives: Vec<(PointMass, RunningMaximum)> = starts.point_masses.iter().map(lives).collect();
    let is_met = |fresh: f64| law.density(fresh) * law.mean() > FAINT;
    if lives.iter().any(|(_, maximum)| maximum.interruptions().any(is_met)) {
        return Ok(None);
    }
    let Some(edges) = advances(contacts, &lives, highest) else { return Ok(None) };
    let lost = |u: f64| {
        let mut sums = [0.0; 2];
        for (mass, maximum) in &lives {
            let (fresh, loss) = maximum.value_and_loss(u);
            let density = law.density(fresh);
            // Ranks do not move thresholds that no contact has.
            let term = if density > 0.0 { mass.weight * density * loss } else { 0.0 };
            sums[0] -= term;
            sums[1] -= term * (mass.position + u);
        }
        sums
    };
    let (both, missed) = Piecewise::resolve_all(
        |u| if watch.stops() { [0.0; 2] } else { lost(u) },
        &edges,
        edges[edges.len() - 1],
        BULK.resolution,
    );
    watch.check()?;
    let curves = both.map(|curve| curve.integrated_from_end(0.0, &[]));
    let known = missed < ERROR && curves.iter().all(|curve| curve.integral().is_finite());
    Ok(known.then_some(curves))
}

/// Advances between which contacts break smoothly; none where some never break.
fn advances(contacts: &Contacts, lives: &[(PointMass, RunningMaximum)], highest: f64) -> Option<Vec<f64>> {
    let law = contacts.thresholds.as_ref();
    let (mut zones, mut stops, mut end) = (Vec::new(), Vec::new(), 0.0_f64);
    for (mass, maximum) in lives.iter().filter(|(mass, _)| mass.position < highest) {
        let first = mass.position + AT_ONCE * law.mean();
        let reached = |fresh: f64| if fresh > first { maximum.advance_to(fresh) } else { Some(0.0) };
        end = end.max(reached(highest)?);
        stops.extend(maximum.turns());
        for breakpoint in law.breakpoints() {
            stops.push(reached(breakpoint.position.min(highest))?);
        }
        for Zone { low, high, resolution } in law.zones() {
            let [low, high] = [low.min(highest), high.min(highest)];
            let [begin, finish] = [reached(low)?, reached(high)?];
            if high > low.max(mass.position) {
                let stretched = (finish - begin) / (high - low.max(mass.position));
                zones.push(Zone { low: begin, high: finish, resolution: resolution * stretched });
            }
        }
    }
    (end > 0.0).then(|| edges(&zones, &stops, end))
}
