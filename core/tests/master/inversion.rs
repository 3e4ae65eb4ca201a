//! The pull against the inverse Laplace transform of F: nothing is shared with the solver but the law's own transform.
//!
//! A contact breaks first at X = ξ₀ − q and loses ξ₀ − r; each further break comes ξ − r later. Where R and Q_ini lie
//! below all thresholds the losses are independent, their transforms form a geometric series, and
//!
//! ∫₀^∞ e^{−sX} [F/(N_c⟨k⟩) − x̄_i − X] dX = Q̂_ini(−s) [P̂_c'(s) + r̄ P̂_c(s)] / {s [1 − R̂(−s) P̂_c(s)]}.

use crate::common::{gamma, gaussian, lognormal, master, mixture, point, rectangular, weibull};
use asperity::law::SharedLaw;
use num_complex::Complex64;

/// The trapezoidal rule on the line Re s = c: F of all X below a sixth of its period T.
struct Inverse {
    line: f64,
    step: f64,
    start: f64,
    values: Vec<Complex64>,
}

impl Inverse {
    /// The rule adds e^{−cT} F(X + T) to F(X): 1.7e-15 of at most T. Rounding is amplified by e^{cX} ≤ 290 only.
    fn new(thresholds: &SharedLaw, reforming: &SharedLaw, initial: &SharedLaw, farthest: f64) -> Self {
        let period = 6.0 * farthest;
        let (line, step) = (34.0 / period, std::f64::consts::TAU / period);
        let (start, rest) = (initial.mean(), reforming.mean());
        let at = |k: usize| {
            let s = Complex64::new(line, k as f64 * step);
            let (value, slope) = with_slope(thresholds, s);
            initial.laplace(-s) * (slope + rest * value) / (s * (1.0 - reforming.laplace(-s) * value))
        };
        let mut values = Vec::new();
        // Far out the transform falls as s^−3 at the slowest (a density that jumps at 0): what is left out is below
        // 1e-13 |s|, some 1e-11, or with the oscillation 1e-13/X; 100 in a row leave no doubt.
        let mut quiet = 0;
        while quiet < 100 {
            let value = at(values.len());
            quiet = if value.norm() < 1e-13 { quiet + 1 } else { 0 };
            values.push(value);
            assert!(values.len() < 1_000_000, "a transform that does not fall");
        }
        Self { line, step, start, values }
    }

    fn force(&self, position: f64) -> f64 {
        let term = |(k, value): (usize, &Complex64)| {
            let half = if k == 0 { 0.5 } else { 1.0 };
            half * (value * Complex64::cis(k as f64 * self.step * position)).re
        };
        let sum: f64 = self.values.iter().enumerate().map(term).sum();
        self.start + position + (self.line * position).exp() * self.step / std::f64::consts::PI * sum
    }
}

/// P̂ and P̂', the slope by Cauchy's formula on a circle: eight points and a radius of 0.05 leave out 1e-16 at mean 1.
fn with_slope(law: &SharedLaw, s: Complex64) -> (Complex64, Complex64) {
    const RADIUS: f64 = 0.05;
    let around = (0..8).map(|k| RADIUS * Complex64::cis(std::f64::consts::FRAC_PI_4 * f64::from(k)));
    (law.laplace(s), around.map(|h| law.laplace(s + h) / h).sum::<Complex64>() / 8.0)
}

/// What the solver promises, at tolerance 1e-10.
const PROMISED: f64 = 1e-10;

fn agree(name: &str, thresholds: &SharedLaw, reforming: &SharedLaw, start: &SharedLaw, farthest: f64) {
    let inverse = Inverse::new(thresholds, reforming, start, farthest);
    let pull = master(thresholds, reforming, start).pull_with(farthest, PROMISED, &mut ()).unwrap();
    let mut worst = (0.0, 0.0);
    // Golden steps fall on no lattice; many of them cover the first oscillations.
    for k in 1..=150_u32 {
        let position = farthest * (0.618_033_988_749_895 * f64::from(k)).fract().powi(2);
        let error = (pull.force(position) - inverse.force(position)).abs();
        if error > worst.0 {
            worst = (error, position);
        }
    }
    assert!(worst.0 <= PROMISED, "{name}: off by {:e} at X = {}", worst.0, worst.1);
}

fn rest() -> SharedLaw {
    point(0.0)
}

#[test]
fn the_inversion_itself_is_right() {
    // Physics reference values at σ = 0.1, known to 1e-14.
    let inverse = Inverse::new(&gaussian(1.0, 0.1), &rest(), &rest(), 22.0);
    let known = [(0.9, 0.765_541_818_520_46), (1.0, 0.539_894_228_039_77), (5.45, 0.463_377_602_580_74)];
    for (position, force) in known {
        // Rounding of P̂' (1e-16/0.05), amplified by up to 290.
        let error = (inverse.force(position) - force).abs();
        assert!(error < 1e-12, "{error:e} at {position}");
    }
}

#[test]
fn gaussian_thresholds() {
    for std in [0.02, 0.05, 0.1, 0.2, 0.3] {
        agree(&format!("gaussian {std}"), &gaussian(1.0, std), &rest(), &rest(), 50.0);
    }
}

#[test]
fn other_smooth_thresholds() {
    agree("gamma .1", &gamma(1.0, 0.1), &rest(), &rest(), 50.0);
    agree("gamma .3", &gamma(1.0, 0.3), &rest(), &rest(), 50.0);
    // Transforms that fall slowly, or have no closed form, are slow to compute far out.
    agree("weibull 12", &weibull(12.153, 1.0), &rest(), &rest(), 12.0);
    agree("weibull 5", &weibull(5.0, 1.0), &rest(), &rest(), 4.0);
    agree("weibull 3.3", &weibull(3.3, 1.0), &rest(), &rest(), 1.0);
    agree("lognormal .1", &lognormal(1.0, 0.1), &rest(), &rest(), 50.0);
    agree("lognormal .3", &lognormal(1.0, 0.3), &rest(), &rest(), 20.0);
    agree("lognormal .5", &lognormal(1.0, 0.5), &rest(), &rest(), 3.0);
}

#[test]
fn mixtures() {
    let two = mixture(&[(0.3, gaussian(0.5, 0.03)), (0.7, gaussian(1.2, 0.1))]);
    agree("two gaussians", &two, &rest(), &rest(), 50.0);
    let many = mixture(&[(0.2, lognormal(0.6, 0.1)), (0.5, gamma(1.0, 0.15)), (0.3, weibull(12.0, 1.5))]);
    agree("three kinds", &many, &rest(), &rest(), 15.0);
    let unlike = mixture(&[(0.9, gaussian(1.0, 0.01)), (0.1, gaussian(3.0, 0.6))]);
    agree("narrow and wide", &unlike, &rest(), &rest(), 30.0);
}

#[test]
fn broad_reforming_and_initial_stretches_below_the_thresholds() {
    // Masses above the lowest thresholds are below 1e-15.
    let (narrow, wide) = (gaussian(1.0, 0.05), gaussian(1.0, 0.08));
    agree("gaussian start", &narrow, &rest(), &gaussian(0.1, 0.025), 50.0);
    agree("gaussian both", &narrow, &gaussian(0.2, 0.04), &gaussian(0.15, 0.03), 50.0);
    agree("rectangular both", &wide, &rectangular(0.0, 0.3), &rectangular(0.1, 0.25), 50.0);
    agree("gamma both", &narrow, &gamma(0.05, 0.02), &gamma(0.1, 0.02), 50.0);
    agree("point both", &wide, &point(0.25), &point(0.125), 50.0);
    let half = mixture(&[(0.5, point(0.05)), (0.5, gaussian(0.2, 0.03))]);
    agree("half a point", &narrow, &half, &half, 50.0);
    agree("lognormal thresholds", &lognormal(1.0, 0.08), &rectangular(0.0, 0.2), &gaussian(0.1, 0.015), 50.0);
}
