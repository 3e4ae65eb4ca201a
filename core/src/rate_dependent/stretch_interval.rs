//! The distribution of stretches as a list of intervals.

use crate::{Error, Result};

/// Attached contacts with stretches distributed uniformly on an interval, or all with the same stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StretchInterval {
    /// Smallest stretch.
    pub low: f64,
    /// Largest stretch; equal to `low` for a point mass.
    pub high: f64,
    /// Fraction of all contacts.
    pub fraction: f64,
}

impl StretchInterval {
    /// Whether all contacts have the same stretch.
    pub fn is_point(&self) -> bool {
        self.low == self.high
    }

    /// The fraction of its contacts with stretches in (`low`, `high`].
    fn between(&self, low: f64, high: f64) -> f64 {
        if self.is_point() {
            return f64::from(u8::from(low < self.low && self.low <= high));
        }
        ((self.high.min(high) - self.low.max(low)) / (self.high - self.low)).max(0.0)
    }

    /// The same contacts with all stretches multiplied by `scale`.
    #[must_use]
    pub fn scaled(self, scale: f64) -> Self {
        Self { low: scale * self.low, high: scale * self.high, ..self }
    }
}

/// Mean of the density Q(x) over each bin between two edges, per length. A point mass at an edge belongs to the bin below it,
/// at the first edge to the first bin.
///
/// # Errors
/// Fewer than two edges; edges that are not finite or not ascending.
pub fn binned(intervals: &[StretchInterval], edges: &[f64]) -> Result<Vec<f64>> {
    rising(edges)?;
    let density = |(bin, ends): (usize, &[f64])| {
        let low = if bin == 0 { ends[0].next_down() } else { ends[0] };
        let fraction: f64 =
            intervals.iter().map(|interval| interval.fraction * interval.between(low, ends[1])).sum();
        fraction / (ends[1] - ends[0])
    };
    Ok(edges.windows(2).enumerate().map(density).collect())
}

fn rising(edges: &[f64]) -> Result<()> {
    let expected = "two finite edges of bins or more, each above the one before";
    if edges.len() < 2 {
        return Err(Error::invalid("edges", expected, format!("{} of them", edges.len())));
    }
    if let Some(edge) = edges.iter().find(|edge| !edge.is_finite()) {
        return Err(Error::invalid("edges", expected, edge));
    }
    match edges.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => Err(Error::invalid("edges", expected, format!("{} before {}", pair[0], pair[1]))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_contact_is_in_one_bin() {
        let portion = |low, high, fraction| StretchInterval { low, high, fraction };
        let portions = [
            portion(0.0, 0.0, 0.125),
            portion(0.5, 0.5, 0.25),
            portion(0.25, 0.75, 0.5),
            portion(2.0, 2.0, 0.125),
        ];
        // Half of what is spread lies on either side of ½, where what stands counts below.
        assert_eq!(binned(&portions, &[0.0, 0.5, 1.0]).unwrap(), [2.0 * 0.625, 2.0 * 0.25]);
        assert_eq!(binned(&portions, &[0.5, 1.0, 3.0]).unwrap(), [2.0 * 0.5, 0.5 * 0.125]);
    }

    #[test]
    fn edges_that_do_not_rise_are_refused() {
        for edges in [&[][..], &[1.0], &[0.0, f64::NAN], &[0.0, 1.0, 1.0]] {
            let error = binned(&[], edges).unwrap_err().to_string();
            assert!(error.starts_with("edges: expected two finite edges"), "{error}");
        }
    }
}
