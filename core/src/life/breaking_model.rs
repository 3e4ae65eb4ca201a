//! What becomes of contacts formed together at one stretch, whatever breaks them: the seam of lives that hang on time.

use std::fmt::Debug;
use std::sync::Arc;

use super::cells::ROUNDING;
use crate::law::Breakpoint;
use crate::monitor::Watch;

/// A kind of contacts, moved at a constant velocity.
pub(crate) trait BreakingModel: Debug + Send + Sync {
    /// The contacts formed at stretch r ≥ 0 whose newborn thresholds, drawn from P_c, are above r: the fraction S(r) of
    /// all, so that what a [`SurvivalMoments`] tells is not divided by S(r). Where the monitor asks to stop, they are of no use.
    fn cohort(&self, start: f64, watch: &Watch<'_>) -> Arc<dyn Cohort>;

    /// About which part of a life's work it is to make cohorts; the rest is to ask them for their survival moments.
    fn making(&self) -> f64;

    /// Estimated error of the fractions that survival moments tell, of those asked for so far.
    fn error(&self) -> f64 {
        ROUNDING
    }

    /// Jumps of the breaking density, times the width of the narrower cell beside them, that are rounding of what is left.
    fn rounding(&self) -> f64 {
        0.0
    }

    /// What survival moments are rough by, as fractions of all: curves that follow them more closely follow that.
    fn roughness(&self) -> f64 {
        0.0
    }

    /// A length over which the survival moments at one advance vary little with the start, between the starts that
    /// [`BreakingModel::passing`] tells.
    fn resolution(&self) -> f64;

    /// Whether [`BreakingModel::passing`] tells of all edges of P_c that are met.
    fn tells_of_edges(&self) -> bool {
        false
    }

    /// The starts from which, at the advance u, a threshold is met at which P_c is not smooth, or nothing breaks any more.
    fn passing(&self, _advance: f64) -> Vec<Passing> {
        Vec::new()
    }
}

/// Contacts formed together at a stretch r.
pub(crate) trait Cohort: Debug + Send + Sync {
    /// What is left, and what breaks, when they are at r + u; from the right at an atom.
    fn toll(&self, advance: f64) -> SurvivalMoments;

    /// Where the breaking density is not smooth past u = 0, atoms among it, as advances.
    fn breakpoints(&self) -> Vec<Breakpoint> {
        Vec::new()
    }

    /// Where the breaking density may change just before, over lengths far shorter than the advance.
    fn blurred_edges(&self) -> Vec<BlurredEdge> {
        Vec::new()
    }
}

/// An edge of P_c, or a threshold that many share, as temperature blurs it: contacts break before they reach it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BlurredEdge {
    /// The advance at which it would be reached.
    pub(crate) advance: f64,
    /// The shortest length on which the breaking density may change before.
    pub(crate) width: f64,
}

impl BlurredEdge {
    /// Places before it, each four times as near as the one before: a change at any distance, over a length that is not far
    /// shorter, is met by the points of the cell that it lies in.
    pub(crate) fn approach(self) -> impl Iterator<Item = f64> {
        const RATIO: f64 = 0.25;
        let nearer = move |distance: &f64| Some(RATIO * distance).filter(|&nearer| nearer > self.width);
        std::iter::successors(Some(self.advance), nearer).skip(1).map(move |distance| self.advance - distance)
    }
}

/// What is left of a cohort and what breaks, with powers of the present threshold h where that matters (k = κ h).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct SurvivalMoments {
    /// The fraction unbroken, and its sums of h and h².
    pub(crate) unbroken: [f64; 3],
    /// The fraction that breaks per unit advance, and its sum of h; atoms not counted.
    pub(crate) breaking: [f64; 2],
}

/// A start from which contacts meet a threshold just now.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passing {
    /// The stretch at which they formed.
    pub(crate) start: f64,
    /// For a threshold that many share: how many of the contacts break there, per unit of start passed …
    pub(crate) weight: f64,
    /// … and how fast the start moves with the advance, |dr/du|.
    pub(crate) pace: f64,
}
