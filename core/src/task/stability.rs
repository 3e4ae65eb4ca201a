//! Whether steady sliding is stable, with the mass and the damping of a slider.

use crate::contacts::Contacts;
use crate::master::{Slider, Transport};
use crate::monitor::Monitor;
use crate::{Result, scenario};

use crate::monitor::Part;

/// Mean lives of a contact for which the response of steady sliding is followed.
const LIVES: f64 = 30.0;
/// Tolerance of that response, with which K_c is right to some 1e-3 of the stiffness of the contacts.
const RESPONSE: f64 = 1e-5;

/// What linear stability says of steady sliding at one velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearStability {
    /// K_c(v; M, γ), above which steady sliding is stable: 0 where it is behind any spring, infinite where behind none.
    pub critical_stiffness: f64,
    /// Angular frequency of the oscillation that sets in there; 0 where none does, infinite where the slider jumps.
    pub frequency: f64,
    /// The rate at which the fastest growing deviation grows behind the spring of the block; 0 where steady sliding is stable.
    pub growth_rate: f64,
    /// Its angular frequency.
    pub growth_frequency: f64,
}

/// The stability of steady sliding of `contacts` at a velocity, of a slider without mass and damping, or of a block.
///
/// # Errors
/// A block that limits no velocity; those of [`Transport::step_response`]; stopped by the monitor.
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

/// What moves a block in time.
fn slider(block: &scenario::Block) -> Result<Slider> {
    block.in_time(false)?;
    let (mass, damping) = block.slip.limits()?;
    Ok(Slider { stiffness: block.stiffness, mass, damping })
}
