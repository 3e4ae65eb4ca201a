//! A contact between two breaks.

/// Relative distance within which a break is at a position: contacts that break simultaneously do so where they should,
/// for any rounding of sums of thresholds. Continuous distributions are not affected.
pub(super) const TOGETHER: f64 = 1e-12;

/// A contact between two breaks: its stretch is X − `origin`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    pub(super) origin: f64,
    pub(super) threshold: f64,
}

impl Contact {
    /// Position at which it breaks, less the rounding of sums.
    #[inline(always)]
    pub(super) fn end(&self) -> f64 {
        (self.origin + self.threshold) * (1.0 - TOGETHER)
    }

    /// Its stretch and threshold at a position of the slider.
    #[inline(always)]
    pub(super) fn at(&self, position: f64) -> (f64, f64) {
        (position - self.origin, self.threshold)
    }
}
