//! The interface of contacts at a velocity: survival and breaking of contacts formed together at one stretch.

use std::fmt::Debug;
use std::sync::Arc;

use super::cells::ROUNDING;
use crate::law::Breakpoint;
use crate::monitor::Watch;

/// A kind of contacts, moved at a constant velocity.
pub(crate) trait BreakingModel: Debug + Send + Sync {
    /// The contacts formed at stretch r ≥ 0 whose thresholds, drawn from P_c, are above r. Their fraction of
    /// all is S(r), by which [`SurvivalMoments`] are not divided. Invalid if the monitor asks to stop.
    fn cohort(&self, start: f64, watch: &Watch<'_>) -> Arc<dyn Cohort>;

    /// Estimated fraction of the work that is spent on making cohorts; the rest evaluates their survival
    /// moments.
    fn making_fraction(&self) -> f64;

    /// Estimated error of the fractions in survival moments, for cohorts made so far.
    fn error(&self) -> f64 {
        ROUNDING
    }

    /// Jumps of the breaking density × the width of the narrower cell beside them, below which they are
    /// rounding.
    fn rounding(&self) -> f64 {
        0.0
    }

    /// Numerical noise of survival moments, as fractions of all: curves need not be resolved more closely.
    fn roughness(&self) -> f64 {
        0.0
    }

    /// Whether cohorts have cached so much that it should not be kept.
    fn is_large(&self) -> bool {
        false
    }

    /// A length over which survival moments at one advance vary little with the start, between the starts
    /// that [`BreakingModel::passing`] returns.
    fn resolution(&self) -> f64;

    /// Whether [`BreakingModel::passing`] returns all edges of P_c that are reached.
    fn tells_of_edges(&self) -> bool {
        false
    }

    /// The starts from which, at the advance u, contacts reach a threshold at which P_c is not smooth, or
    /// stop breaking.
    fn passing(&self, _advance: f64) -> Vec<Passing> {
        Vec::new()
    }
}

/// Contacts formed together at a stretch r.
pub(crate) trait Cohort: Debug + Send + Sync {
    /// Surviving and breaking contacts at the stretch r + u; from the right at a point mass. Invalid if the monitor asks to stop.
    fn survival_moments(&self, advance: f64, watch: &Watch<'_>) -> SurvivalMoments;

    /// Breakpoints and point masses of the breaking density for u > 0, as advances. Invalid if the monitor asks to stop.
    fn breakpoints(&self, _watch: &Watch<'_>) -> Vec<Breakpoint> {
        Vec::new()
    }

    /// Edges before which the breaking density may change over lengths far shorter than the advance.
    fn blurred_edges(&self) -> Vec<BlurredEdge> {
        Vec::new()
    }
}

/// An edge or point mass of P_c, blurred by temperature: contacts break before they reach it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BlurredEdge {
    /// The advance at which it would be reached.
    pub(crate) advance: f64,
    /// The shortest length on which the breaking density may change before it.
    pub(crate) width: f64,
}

impl BlurredEdge {
    /// Cell boundaries before it, each four times as close as the one before: a change at any distance, over
    /// a length that is not far shorter, is then resolved by the points of its cell.
    pub(crate) fn approach(self) -> impl Iterator<Item = f64> {
        const RATIO: f64 = 0.25;
        let nearer = move |distance: &f64| Some(RATIO * distance).filter(|&nearer| nearer > self.width);
        std::iter::successors(Some(self.advance), nearer).skip(1).map(move |distance| self.advance - distance)
    }
}

/// Surviving and breaking contacts of a cohort, with powers of the present threshold h (needed for k = κ h).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct SurvivalMoments {
    /// The surviving fraction, and its sums of h and h².
    pub(crate) unbroken: [f64; 3],
    /// The fraction that breaks per unit advance, and its sum of h; without point masses.
    pub(crate) breaking: [f64; 2],
}

/// A start from which contacts reach a threshold just now.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passing {
    /// The stretch at which they formed.
    pub(crate) start: f64,
    /// For a point mass of P_c: the fraction of contacts that breaks there, per unit of start passed.
    pub(crate) weight: f64,
    /// How fast the start moves with the advance, |dr/du|.
    pub(crate) speed: f64,
}
