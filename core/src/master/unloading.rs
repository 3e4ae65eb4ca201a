//! The unloading branch: motion back from the furthest point of a loading branch.

use std::sync::Arc;

use super::loading::LoadingBranch;
use super::solved_branches::SolvedBranches;
use crate::Result;
use crate::life::{Layer, LayerSums, reaches_threshold_atom};
use crate::monitor::Monitor;

/// Fraction of contacts ignored when finding the first break on unloading.
const FEW: f64 = 1e-18;

/// Unloading: linear until a contact breaks, from there a branch of its own.
#[derive(Debug, Clone)]
pub(super) struct UnloadingBranch {
    /// Length and slope of the linear part, and whether contacts break simultaneously at its end.
    pub(super) length: f64,
    pub(super) stiffness: f64,
    pub(super) breaks: bool,
    /// The contacts at its start, seen in its direction.
    layers: Arc<[Layer]>,
    /// The branch, from the start of unloading, once it is needed.
    pub(super) branch: Option<Arc<LoadingBranch>>,
}

impl UnloadingBranch {
    /// Unloading from the furthest advance on a branch, in front of one of its cells.
    pub(super) fn new(
        branch: &LoadingBranch,
        (furthest, cell): (f64, usize),
        interface: &SolvedBranches,
    ) -> Self {
        let contacts = &interface.contacts;
        let thresholds = contacts.thresholds.as_ref();
        let layers = branch.layers(furthest, cell, false, contacts);
        let layers: Arc<[_]> = layers.iter().map(Layer::mirrored).collect();
        let lowest = thresholds.quantile(FEW);
        let length = layers.iter().map(|layer| layer.distance_to_break(lowest)).fold(f64::INFINITY, f64::min);
        let length = if length > interface.rounding() { length } else { 0.0 };
        let LayerSums { stiffness, .. } = LayerSums::of(&layers, contacts);
        Self {
            length,
            stiffness,
            breaks: reaches_threshold_atom(&layers, thresholds, length),
            layers,
            branch: None,
        }
    }

    /// Solves the branch, on which broken contacts are `held` free or re-form.
    pub(super) fn solve(
        &mut self,
        held: bool,
        interface: &SolvedBranches,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        if self.branch.is_none() {
            let layers = self.layers.to_vec();
            let branch = if held { interface.held(layers) } else { interface.renewed(layers, monitor)? };
            // Breaks at the end of the linear part must lie within the solution.
            let further = if 2.0 * self.length > branch.end() {
                branch.extended(4.0 * self.length, interface.tolerance, monitor)?
            } else {
                None
            };
            self.branch = Some(Arc::new(further.unwrap_or(branch)));
        }
        Ok(())
    }
}
