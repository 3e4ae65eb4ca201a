//! Sums of many terms that come and go, without drift.

use serde::{Deserialize, Serialize};

/// A sum and what its roundings have left out: Knuth's exact sum of two numbers, cascaded once.
///
/// After n terms of size t the error is below (2⁻⁵³ + n² 2⁻¹⁰⁶) times Σ|t| (T. Ogita, S. M. Rump and S. Oishi,
/// *Accurate sum and dot product*, SIAM J. Sci. Comput. 26, 1955 (2005)); a term added and later subtracted leaves
/// nothing of the first kind behind.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Compensated {
    sum: f64,
    rest: f64,
}

impl Compensated {
    /// Adds a term.
    #[inline]
    pub fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        let added = sum - self.sum;
        self.rest += (self.sum - (sum - added)) + (term - added);
        self.sum = sum;
    }

    /// The sum.
    #[inline]
    pub fn value(&self) -> f64 {
        self.sum + self.rest
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
