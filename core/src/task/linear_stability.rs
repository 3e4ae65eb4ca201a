//! Linear stability of steady sliding, with the mass and the damping of the slider.

use crate::contacts::Contacts;
use crate::master::{DynamicStiffness, Slider};
use crate::monitor::{Monitor, Part};
use crate::{Result, scenario};

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
/// A slip rule without a velocity limit; those of [`DynamicStiffness::new`]; a stop by the monitor.
pub fn stability(
    contacts: &Contacts,
    velocity: f64,
    block: Option<&scenario::Block>,
    monitor: &mut dyn Monitor,
) -> Result<LinearStability> {
    let limits = block.map(scenario::Block::inertia_and_drag).transpose()?;
    let slider = limits.map_or_else(Slider::default, |(mass, damping)| Slider { mass, damping });
    let response = DynamicStiffness::new_with(contacts, velocity, monitor)?;
    let aside = &mut Part::new(monitor, 1.0, 0.0);
    let critical = response.critical_stiffness(slider, aside)?;
    let (critical_stiffness, frequency) = critical.unwrap_or((0.0, 0.0));
    let growth = block.map_or(Ok(None), |block| response.growth(slider, block.stiffness, aside))?;
    let (growth_rate, growth_frequency) = growth.map_or((0.0, 0.0), |s| (s.re, s.im));
    Ok(LinearStability { critical_stiffness, frequency, growth_rate, growth_frequency })
}
