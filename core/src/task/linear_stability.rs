//! Linear stability of steady sliding, with the mass and the damping of the slider.

use crate::contacts::Contacts;
use crate::master::{Slider, Transport};
use crate::monitor::{Monitor, Part};
use crate::{Result, scenario};

/// Sliding distance over which the response of steady sliding is followed where it has no closed form, in mean lives of a contact.
const LIVES: f64 = 30.0;
/// Tolerance of that response; the error of K_c is then some 1e-3 of the stiffness of the contacts, or of K_c if that is larger.
const RESPONSE: f64 = 1e-5;

/// Linear stability of steady sliding at one velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearStability {
    /// Critical stiffness K_c(v; M, γ), above which steady sliding is stable; 0 if it always is, infinite if it never is.
    pub critical_stiffness: f64,
    /// Angular frequency at K_c (Hopf bifurcation), per time; 0 if there is no instability, infinite if the slider jumps.
    pub frequency: f64,
    /// Growth rate of the fastest growing deviation with the spring of the block, per time; 0 if steady sliding is stable.
    pub growth_rate: f64,
    /// Angular frequency of that deviation, per time.
    pub growth_frequency: f64,
}

/// Linear stability of steady sliding of `contacts` at `velocity`, with a slider without mass and damping or with a block.
///
/// # Errors
/// A slip rule without a velocity limit; those of [`Transport::step_response`]; a stop by the monitor.
pub fn stability(
    contacts: &Contacts,
    velocity: f64,
    block: Option<&scenario::Block>,
    monitor: &mut dyn Monitor,
) -> Result<LinearStability> {
    let slider = block.map(slider).transpose()?;
    let response = Transport::step_response(contacts, velocity, LIVES, RESPONSE, monitor)?;
    let (mass, damping) = slider.map_or((0.0, 0.0), |slider| (slider.mass, slider.damping));
    let aside = &mut Part::new(monitor, 1.0, 0.0);
    let critical = response.critical_stiffness(mass, damping, aside)?;
    let (critical_stiffness, frequency) = critical.unwrap_or((0.0, 0.0));
    let growth = slider.map_or(Ok(None), |slider| response.growth(&slider, aside))?;
    let (growth_rate, growth_frequency) = growth.map_or((0.0, 0.0), |s| (s.re, s.im));
    Ok(LinearStability { critical_stiffness, frequency, growth_rate, growth_frequency })
}

/// Stiffness, mass and damping of a block.
fn slider(block: &scenario::Block) -> Result<Slider> {
    let (mass, damping) = block.inertia_and_drag()?;
    Ok(Slider { stiffness: block.stiffness, mass, damping })
}
