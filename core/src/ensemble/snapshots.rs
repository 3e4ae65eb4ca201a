//! Where the distribution of stretches is recorded during a pull.

use crate::{Error, Result};

/// Positions and bins at which the distribution of stretches is recorded.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Snapshots {
    /// Positions X, rising, none above the last position of the pull.
    pub positions: Vec<f64>,
    /// Edges of the bins of stretch, rising; a stretch at an edge counts below it, at the first above it.
    pub edges: Vec<f64>,
}

impl Snapshots {
    /// One histogram for each position.
    pub(super) fn histograms(&self) -> Vec<Vec<u64>> {
        vec![vec![0; self.edges.len().saturating_sub(1)]; self.positions.len()]
    }

    /// Counts a contact of this stretch.
    pub(super) fn count(&self, stretch: f64, histogram: &mut [u64]) {
        // Just re-formed contacts may lie below 0 by rounding.
        let stretch = stretch.max(0.0);
        let above = self.edges.partition_point(|&edge| edge < stretch);
        if let Some(bin) = histogram.get_mut(above.max(1) - 1)
            && stretch >= self.edges[0]
        {
            *bin += 1;
        }
    }

    /// Checks them for a pull through `positions`, and gives the last of these.
    pub(super) fn check(&self, positions: &[f64]) -> Result<f64> {
        rising("positions", positions)?;
        let last = *positions.last().ok_or_else(|| Error::invalid("positions", "at least one", "none"))?;
        rising("snapshots", &self.positions)?;
        rising("edges", &self.edges)?;
        if let Some(pair) = self.edges.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(Error::invalid(
                "edges",
                "edges of bins, each above the one before",
                format!("{} twice", pair[0]),
            ));
        }
        match self.positions.last().filter(|&&x| x > last) {
            Some(beyond) => Err(Error::invalid("snapshots", format!("positions up to {last}"), beyond)),
            None => Ok(last),
        }
    }
}

/// Refuses values that are not finite, are negative or fall; equal ones may follow each other.
pub(super) fn rising(key: &str, values: &[f64]) -> Result<()> {
    let expected = "finite values that rise from 0 or above";
    if let Some(bad) = values.iter().find(|x| !x.is_finite() || **x < 0.0) {
        return Err(Error::invalid(key, expected, bad));
    }
    match values.windows(2).find(|pair| pair[0] > pair[1]) {
        Some(pair) => Err(Error::invalid(key, expected, format!("{} before {}", pair[0], pair[1]))),
        None => Ok(()),
    }
}
