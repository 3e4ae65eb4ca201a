//! The posterior as the sampler asks for it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use asperity::Error;
use asperity::fit::Standardised;
use nuts_rs::{CpuLogpFunc, CpuMathError, HasDims, LogpError, rand};

use super::Shared;

/// The density in standardised coordinates.
#[derive(Debug)]
pub(super) struct Density<'a> {
    pub target: &'a Standardised<'a>,
    pub shared: &'a Shared,
    pub evaluations: Rc<Evaluations>,
}

/// What the density has reported.
#[derive(Debug, Default)]
pub(super) struct Evaluations {
    /// Points since the last draw, with the logarithm of the density.
    recent: RefCell<Vec<(Vec<f64>, f64)>>,
    /// The error that ended the chain.
    pub failure: RefCell<Option<Error>>,
}

impl Evaluations {
    /// The logarithm of the density at a draw, which is one of the points since the last draw or the last draw itself.
    pub fn at(&self, draw: &[f64]) -> f64 {
        let mut recent = self.recent.borrow_mut();
        let found = recent.iter().rposition(|(z, _)| z == draw);
        let Some(found) = found else { return f64::NAN };
        let kept = recent.swap_remove(found);
        let log_density = kept.1;
        *recent = vec![kept];
        log_density
    }
}

/// Why there is no density at a point.
#[derive(Debug)]
pub(super) enum NoDensity {
    /// It is 0.
    Zero,
    /// An error, kept by the [`Evaluations`].
    Failed,
}

impl std::fmt::Display for NoDensity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Zero => "the density is 0",
            Self::Failed => "the density could not be computed",
        })
    }
}

impl std::error::Error for NoDensity {}

impl LogpError for NoDensity {
    fn is_recoverable(&self) -> bool {
        matches!(self, Self::Zero)
    }
}

impl HasDims for Density<'_> {
    fn dim_sizes(&self) -> HashMap<String, u64> {
        HashMap::from([("unconstrained_parameter".to_owned(), self.dim() as u64)])
    }
}

impl CpuLogpFunc for Density<'_> {
    type LogpError = NoDensity;
    type FlowParameters = ();
    type ExpandedVector = Vec<f64>;

    fn dim(&self) -> usize {
        self.target.names().len()
    }

    fn logp(&mut self, position: &[f64], gradient: &mut [f64]) -> Result<f64, NoDensity> {
        let (value, slope) = self.target.log_density(position, &mut &*self.shared).map_err(|error| {
            self.evaluations.failure.replace(Some(error));
            NoDensity::Failed
        })?;
        if !value.is_finite() {
            return Err(NoDensity::Zero);
        }
        gradient.copy_from_slice(&slope);
        self.evaluations.recent.borrow_mut().push((position.to_vec(), value));
        Ok(value)
    }

    fn expand_vector<R: rand::Rng + ?Sized>(
        &mut self,
        _rng: &mut R,
        position: &[f64],
    ) -> Result<Vec<f64>, CpuMathError> {
        Ok(position.to_vec())
    }
}
