//! The way back from the furthest point of a course.

use std::sync::Arc;

use super::loading::LoadingBranch;
use super::solved_branches::SolvedBranches;
use crate::Result;
use crate::life::{Layer, LayerSums, reaches_threshold_atom};

/// Thresholds below which there are fewer are not waited for.
const FEW: f64 = 1e-18;

/// The way back: straight until a contact breaks, from there a course of its own.
#[derive(Debug, Clone)]
pub(super) struct UnloadingBranch {
    /// How far it is straight, how steep, and whether contacts break together at its end.
    pub(super) length: f64,
    pub(super) stiffness: f64,
    pub(super) breaks: bool,
    /// The contacts at its beginning, seen along it.
    layers: Arc<[Layer]>,
    /// The course, from where the way back begins, once it is needed.
    pub(super) course: Option<Arc<LoadingBranch>>,
}

impl UnloadingBranch {
    /// The way back from the furthest advance on a course, in front of a cell of it.
    pub(super) fn new(
        course: &LoadingBranch,
        (furthest, cell): (f64, usize),
        interface: &SolvedBranches,
    ) -> Self {
        let contacts = &interface.contacts;
        let thresholds = contacts.thresholds.as_ref();
        let layers = course.layers(furthest, cell, false, contacts);
        let layers: Arc<[_]> = layers.iter().map(Layer::mirrored).collect();
        let lowest = thresholds.quantile(FEW);
        let length = layers.iter().map(|layer| layer.distance_to_break(lowest)).fold(f64::INFINITY, f64::min);
        let length = if length > interface.near() { length } else { 0.0 };
        let LayerSums { stiffness, .. } = LayerSums::of(&layers, contacts);
        Self {
            length,
            stiffness,
            breaks: reaches_threshold_atom(&layers, thresholds, length),
            layers,
            course: None,
        }
    }

    /// Solves the course, on which what breaks is `held` free or re-forms.
    pub(super) fn solve(&mut self, held: bool, interface: &SolvedBranches) -> Result<()> {
        if self.course.is_none() {
            let layers = self.layers.to_vec();
            let course = if held { interface.held(layers) } else { interface.renewed(layers, &mut ())? };
            // What breaks at the end of the straight part must lie within what is solved.
            let further = if 2.0 * self.length > course.end() {
                course.extended(4.0 * self.length, interface.tolerance, &mut ())?
            } else {
                None
            };
            self.course = Some(Arc::new(further.unwrap_or(course)));
        }
        Ok(())
    }
}
