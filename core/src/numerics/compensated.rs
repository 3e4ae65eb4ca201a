//! Compensated summation.

use serde::{Deserialize, Serialize};

/// A sum with its accumulated rounding error: Neumaier's variant of Kahan's summation, with Knuth's
/// error-free sum of two numbers (TwoSum).
///
/// After n terms of size t the error is below (2⁻⁵³ + n² 2⁻¹⁰⁶) times Σ|t| (Sum2 of T. Ogita, S. M. Rump and
/// S. Oishi, *Accurate sum and dot product*, SIAM J. Sci. Comput. 26, 1955 (2005)). A term that is added and
/// later subtracted leaves no error of first order behind.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Compensated {
    sum: f64,
    error: f64,
}

impl Compensated {
    /// Adds a term.
    #[inline]
    pub fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        let added = sum - self.sum;
        self.error += (self.sum - (sum - added)) + (term - added);
        self.sum = sum;
    }

    /// The sum.
    #[inline]
    pub fn value(&self) -> f64 {
        self.sum + self.error
    }
}

#[cfg(test)]
mod tests {
    use super::Compensated;

    /// Thirds of many sizes come and go; a plain sum is off by 1e-10 in the end.
    #[test]
    fn what_comes_and_goes_leaves_nothing() {
        let mut sum = Compensated::default();
        sum.add(0.1);
        let term = |i: i32| f64::from(i % 1009) * 1e3 / 3.0;
        (0..1_000_000).for_each(|i| sum.add(term(i)));
        (0..1_000_000).for_each(|i| sum.add(-term(i)));
        assert_eq!(sum.value(), 0.1);
    }
}
