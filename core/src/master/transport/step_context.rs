//! What cohorts need to follow the motion in a time step.

use super::shared_thresholds::StepThresholds;
use crate::monitor::Watch;
use crate::numerics::diffusion::Workspace;

/// Work space of steps of cohorts, and the monitor that may stop them, after which they are invalid.
pub(super) struct StepContext<'a, 'm> {
    pub(super) room: Workspace,
    pub(super) watch: &'a Watch<'m>,
    /// P_c, where contacts share it.
    pub(super) thresholds: Option<&'a StepThresholds>,
}

impl<'a, 'm> StepContext<'a, 'm> {
    pub(super) fn new(watch: &'a Watch<'m>, thresholds: Option<&'a StepThresholds>) -> Self {
        Self { room: Workspace::default(), watch, thresholds }
    }
}
