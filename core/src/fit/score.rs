//! The slope of a likelihood and its expected information.

use faer::Mat;

use super::free::FreeParameter;

/// Derivatives of half the deviance.
#[derive(Debug, Clone)]
pub(super) struct Score {
    pub slope: Mat<f64>,
    /// The expected information.
    pub information: Mat<f64>,
}

impl Score {
    /// Adds what the priors of the free numbers contribute to half the deviance.
    pub fn add_priors(&mut self, free: &[FreeParameter], coordinates: &[f64]) {
        for (k, (parameter, u)) in free.iter().zip(coordinates).enumerate() {
            if let Some([mean, std]) = parameter.prior {
                self.slope[(k, 0)] += (u - mean) / (std * std);
                self.information[(k, k)] += 1.0 / (std * std);
            }
        }
    }

    /// The slope after a step so short that the information is the same.
    pub fn follow(&mut self, step: &[f64]) {
        let step = Mat::from_fn(step.len(), 1, |k, _| step[k]);
        self.slope += &self.information * step;
    }
}
