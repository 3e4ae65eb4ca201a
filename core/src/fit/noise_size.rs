//! The errors of the sizes of noise that is not normal.
//!
//! The common size of all errors follows from χ² = Σz² of the whitened residuals z. If these are independent, of variance 1 and with
//! the excess kurtosis κ, the variance of χ² is (2 + κ)n in place of 2n of normal ones, and the variance of the logarithm of the
//! size of Σ is (2 + κ)/n. This is the covariance of estimates whose likelihood is not that of the data (P. J. Huber, Proc. 5th
//! Berkeley Symp. 1, 221 (1967); H. White, Econometrica 50, 1 (1982)), along this one direction; the curve itself is as well known
//! as with normal noise.

use faer::Mat;

use super::ended::Ended;
use super::free::Role;
use super::likelihood::Likelihood;
use super::matrix;
use super::restricted::Restricted;

impl Ended<Likelihood> {
    /// Adds to the covariance of the coordinates what follows from the kurtosis of the whitened residuals.
    pub(super) fn add_kurtosis(&self, covariance: &mut Mat<f64>) {
        let along = self.common_size();
        let information = matrix::inner(&along, &(&self.optimum.score.information * &along));
        if information > 0.0 {
            let fitted = self.likelihood.restricted.as_ref().map_or(0, Restricted::count);
            let residuals = self.optimum.trial.curves.iter().map(|curve| &curve.whitened);
            let excess = excess_kurtosis(residuals, fitted as f64);
            *covariance += &along * along.transpose() * faer::Scale(0.5 * excess / information);
        }
    }

    /// How the coordinates change, without a change of the curve, where Σ becomes larger as a whole, as far as its parts are free:
    /// the noise of contacts is N⟨k⟩² at a given N⟨k⟩, an error of readings or a drift has a standard deviation.
    fn common_size(&self) -> Mat<f64> {
        let (free, divided) = (&self.likelihood.free, self.likelihood.divides_all_noise());
        let changes = |k: usize| match (free[k].role, free[k].quantity.as_str()) {
            (Role::Reading | Role::DriftAmplitude, _) => 0.5,
            (Role::Contacts, "count") if divided => -1.0,
            (Role::Contacts, "stiffness") if divided => 1.0,
            _ => 0.0,
        };
        let at_bound = &self.optimum.at_bound;
        Mat::from_fn(free.len(), 1, |k, _| if at_bound[k] { 0.0 } else { changes(k) })
    }
}

impl Likelihood {
    /// Whether N and ⟨k⟩ are free for each curve, so that a curve of given N⟨k⟩ may have more or less noise.
    pub(super) fn divides_all_noise(&self) -> bool {
        self.errors.have_contacts()
            && self.counts_and_stiffnesses().iter().all(|sizes| sizes[0].is_some() && sizes[1].is_some())
    }

    /// How many products N⟨k⟩ have factors that only the noise tells apart: those of curves of which both are free. Curves that
    /// share one of the two count once, and not at all if one of them has only one of the two.
    pub(super) fn divided_noises(&self) -> usize {
        if !self.errors.have_contacts() {
            return 0;
        }
        let mut groups: Vec<Vec<[Option<usize>; 2]>> = Vec::new();
        for sizes in self.counts_and_stiffnesses() {
            let shares =
                |other: &[Option<usize>; 2]| (0..2).any(|i| sizes[i].is_some() && sizes[i] == other[i]);
            let (joined, mut apart): (Vec<_>, Vec<_>) =
                groups.into_iter().partition(|group| group.iter().any(shares));
            apart.push(joined.into_iter().flatten().chain([sizes]).collect());
            groups = apart;
        }
        let divided =
            |group: &&Vec<[Option<usize>; 2]>| group.iter().all(|sizes| sizes.iter().all(Option::is_some));
        groups.iter().filter(divided).count()
    }

    /// For each curve which of the free numbers are its N and its ⟨k⟩.
    fn counts_and_stiffnesses(&self) -> Vec<[Option<usize>; 2]> {
        let number = |curve: usize, name: &str| {
            self.free.iter().position(|number| number.quantity == name && number.applies_to(curve))
        };
        let of = |curve: usize| ["count", "stiffness"].map(|name| number(curve, name));
        (0..self.fit.curves.len()).map(of).collect()
    }
}

/// κ = nΣz⁴/(Σz²)² − 3 of whitened residuals, but not below 0. Σz² = n − p where p numbers follow the errors, so that n is Σz² + p:
/// residuals of readings without any noise do not count. A sample of normal ones has as many below as above 0, up to √(24/n).
fn excess_kurtosis<'a>(curves: impl Iterator<Item = &'a Mat<f64>>, fitted: f64) -> f64 {
    let squares = |whitened: &Mat<f64>| {
        let squares = (0..whitened.nrows()).map(|i| whitened[(i, 0)] * whitened[(i, 0)]);
        squares.fold([0.0, 0.0], |[two, four], square| [two + square, four + square * square])
    };
    let [two, four] = curves.map(squares).fold([0.0, 0.0], |all, one| [all[0] + one[0], all[1] + one[1]]);
    if two > 0.0 { ((two + fitted) * four / (two * two) - 3.0).max(0.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_of_readings_without_noise_change_no_kurtosis() {
        let column = |values: &[f64]| Mat::from_fn(values.len(), 1, |i, _| values[i]);
        // Five residuals of variance 1 with one large one: (16 + 4 · 1/16)/5 − 3 would be 0.25, rounding aside.
        let noisy = column(&[2.0, 0.5, -0.5, 0.5, -0.5]);
        let with = |exact: usize| excess_kurtosis([&noisy, &Mat::zeros(exact, 1)].into_iter(), 0.0);
        assert!((with(0) - 0.25).abs() < 1e-14, "{}", with(0));
        assert_eq!(with(20), with(0));
        assert_eq!(excess_kurtosis([&column(&[1.0, -1.0, 1.0])].into_iter(), 0.0), 0.0);
        assert_eq!(excess_kurtosis([&Mat::zeros(3, 1)].into_iter(), 0.0), 0.0);
    }

    /// Of residuals that a fit has made smaller as a whole, n = 20 and p = 5, the kurtosis is that of their errors.
    #[test]
    fn the_kurtosis_is_that_of_residuals_of_any_size() {
        let errors = [4.0, 0.5, -1.0, 0.5].map(|z| z * (4.0_f64 / 17.5).sqrt());
        let times = |size: f64| Mat::from_fn(20, 1, |i, _| size * errors[i % 4]);
        let [whole, smaller] = [(times(1.0), 0.0), (times(0.75_f64.sqrt()), 5.0)]
            .map(|(z, p)| excess_kurtosis([&z].into_iter(), p));
        // n Σz⁴/(Σz²)² of 4, ½, 1, ½: 4 · 257.125/17.5².
        assert!((whole - smaller).abs() < 1e-14 && (whole + 3.0 - 4.0 * 257.125 / 306.25).abs() < 1e-14);
    }
}
