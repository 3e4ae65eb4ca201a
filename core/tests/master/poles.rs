//! Thresholds whose density is infinite at 0, against sums over breaks.
//!
//! With R and Q_ini at 0, F(X)/(N_c⟨k⟩) = Σ_n {I_n(X) − I_{n+1}(X) − [X C_{n+1}(X) − I_{n+1}(X)]/(n + 1)}, where
//! C_n(X) = P(S_n ≤ X) and I_n(X) = E[(X − S_n)₊] for the sum S_n of n thresholds: a contact has broken n times, and the
//! last of n + 1 thresholds has the mean s/(n + 1) where their sum is s.

use crate::common::{gamma, gaussian, lognormal, master, mixture, point, weibull};
use asperity::law::{Gamma, Law};

/// Aimed at, of the mean life.
const PROMISED: f64 = 1e-10;

/// F(X)/(N_c⟨k⟩) of gamma thresholds of mean 1: sums of them are gamma again. The terms are probabilities between 0 and 1, of
/// which up to a few hundred count, each right to 1e-15.
fn force_of_gamma(std: f64, position: f64) -> f64 {
    let sum = |n: u32| {
        if n == 0 {
            return (1.0, position);
        }
        let count = f64::from(n);
        let law = Gamma::new(count, count.sqrt() * std).unwrap();
        let below = law.cumulative(position);
        (below, position * below - (count - law.upper_moment(1, position)))
    };
    let term = |n: u32| {
        let ((_, before), (below, after)) = (sum(n), sum(n + 1));
        before - after - (position * below - after) / f64::from(n + 1)
    };
    (0..800).map(term).sum()
}

#[test]
fn gamma_thresholds_of_any_width() {
    for std in [1.2, 1.5, 2.0, 3.0, 4.5, 6.0, 10.0] {
        let pull =
            master(&gamma(1.0, std), &point(0.0), &point(0.0)).pull_with(6.0, PROMISED, &mut ()).unwrap();
        for k in 1..=60_u32 {
            let position = 6.0 * (0.618_033_988_749_895 * f64::from(k)).fract();
            let (got, expected) = (pull.force(position), force_of_gamma(std, position));
            let error = (got - expected).abs();
            assert!(
                error < PROMISED,
                "std {std}: {got:.14}, not {expected:.14}, at X = {position}: {error:e}"
            );
        }
    }
}

/// The force of such thresholds never falls, so that K_c = 0, and its slope holds where cells are so narrow that the
/// derivative of a polynomial is rounding.
#[test]
fn slopes_beside_a_pole() {
    for std in [1.2, 1.5, 2.0, 3.0, 6.0] {
        let pull =
            master(&gamma(1.0, std), &point(0.0), &point(0.0)).pull_with(6.0, PROMISED, &mut ()).unwrap();
        for k in -12..=14_i32 {
            let position = 4.0 * 2.0_f64.powi(-k.max(0)) + 0.1 * f64::from((-k).max(0));
            // Differences of the fourth order over steps of X/1000, of F whose fifth derivative is of the order F'/X⁴.
            let step = 1e-3 * position;
            let at = |steps: f64| force_of_gamma(std, position + steps * step);
            let expected = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step);
            let error = (pull.slope(position) - expected).abs();
            // The force itself is right to 3e-13, the sum of a few hundred terms that are right to 1e-15.
            let allowed = 1e-7 + 3e-13 / step;
            assert!(error < allowed, "std {std}: off by {error:e} at {position}, where it is {expected}");
            assert!(expected > 0.0);
        }
        // The slope of a chord of 1e-6 of the mean life, or less.
        let (chord, slope) = (pull.force(1e-6) / 1e-6, pull.slope(1e-20));
        assert!(chord - 1e-9 < slope && slope < 1.0, "std {std}: {slope}, {chord}");
        assert_eq!(pull.critical_stiffness(), 0.0, "std {std}");
    }
}

/// ∫Q = 1 everywhere on the way, by a quadrature of its own, and the estimate says so.
#[test]
fn nothing_is_lost_beside_a_pole() {
    let narrow = mixture(&[(0.5, gamma(0.8, 3.2)), (0.5, gaussian(1.2, 0.01))]);
    let laws = [
        weibull(0.2, 1.0),
        weibull(0.4, 1.0),
        weibull(0.6, 1.0),
        gamma(1.0, 2.5),
        lognormal(1.0, 3.0),
        narrow,
    ];
    for law in laws {
        let pull = master(&law, &point(0.0), &point(0.0)).pull(5.0).unwrap();
        assert!(pull.error_estimate() < PROMISED * law.mean(), "{law:?}: {:e}", pull.error_estimate());
        for k in -60..=6_i32 {
            let lost = pull.total_probability(1.3 * 2.0_f64.powi(k).min(3.0)) - 1.0;
            assert!(lost.abs() < PROMISED, "{law:?}: {lost:e} at 1.3 × 2^{k}");
        }
    }
}
