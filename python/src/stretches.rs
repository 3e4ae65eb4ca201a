//! The stretches at which a distribution of stretches is evaluated, or the bins in which contacts are counted.

use asperity::master::Stretches;
use asperity::rate_dependent::{StretchInterval, binned};
use asperity::{Error, Result};
use pyo3::prelude::*;

use crate::{convert, error};

/// Fewest and most bins where none are given.
const BINS: (f64, f64) = (20.0, 200.0);

/// Rounding error of a stretch, relative to the largest: smaller stretches are those of re-formed contacts, 0.
const ROUNDING: f64 = 1e-12;

/// Where a distribution of stretches is evaluated.
pub enum StretchGrid {
    /// At stretches.
    Stretches(Vec<f64>),
    /// In bins between edges.
    Bins(Vec<f64>),
    /// On a grid that resolves the distribution.
    Default,
}

impl StretchGrid {
    /// The grid of the arguments `stretches` and `edges`, at most one of which is given.
    pub fn new(stretches: Option<&Bound<'_, PyAny>>, edges: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        match (stretches, edges) {
            (Some(stretches), None) => Ok(Self::Stretches(convert::list("stretches", stretches)?)),
            (None, Some(edges)) => Ok(Self::Bins(convert::list("edges", edges)?)),
            (None, None) => Ok(Self::Default),
            (Some(_), Some(_)) => Err(error::invalid("stretches", "either stretches or edges", "both")),
        }
    }

    /// The stretches at which the solution of the master equation is evaluated; `default` where none are given.
    pub fn stretches(self, default: impl FnOnce() -> Vec<f64>) -> Result<Vec<f64>> {
        match self {
            Self::Stretches(stretches) => Ok(stretches),
            Self::Default => Ok(default()),
            Self::Bins(_) => {
                let expected = "None where contacts follow the master equation without time dependence";
                Err(Error::invalid("edges", expected, "edges of bins"))
            }
        }
    }

    /// The stretches, or the middles of the bins, and the distribution of contacts there.
    pub fn count(self, contacts: &[StretchInterval]) -> Result<(Vec<f64>, Stretches)> {
        let edges = match self {
            Self::Stretches(stretches) => {
                let found = Stretches::of(contacts, &stretches);
                return Ok((stretches, found));
            }
            Self::Bins(edges) => edges,
            Self::Default => even_bins(contacts),
        };
        let density = binned(contacts, &edges)?;
        let middles = edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        Ok((middles, Stretches { density, atoms: Vec::new() }))
    }
}

/// Edges of bins of equal width that hold all contacts; 0 is an edge, or the lowest edge is below it.
fn even_bins(contacts: &[StretchInterval]) -> Vec<f64> {
    let low = contacts.iter().fold(0.0, |low: f64, interval| low.min(interval.low));
    let high = contacts.iter().fold(low, |high: f64, interval| high.max(interval.high));
    let number = (contacts.len() as f64).sqrt().clamp(BINS.0, BINS.1).ceil();
    let (low, width) = (1.05 * low, 1.05 * (high - low).max(f64::MIN_POSITIVE) / number);
    (0..=number as usize).map(|i| low + width * i as f64).collect()
}

/// Single contacts, `size` of them with those that are detached, at their stretches.
pub fn points(stretches: Vec<f64>, size: usize) -> Vec<StretchInterval> {
    let fraction = 1.0 / size as f64;
    let near = ROUNDING * stretches.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let at = |stretch: f64| {
        let stretch = if stretch.abs() < near { 0.0 } else { stretch };
        StretchInterval { low: stretch, high: stretch, fraction }
    };
    stretches.into_iter().map(at).collect()
}
