//! Integrals to machine precision of functions that are analytic inside an interval: the trapezoidal and the
//! double-exponential rule.

use num_complex::Complex64;

/// ∫ f over [from, to] by the trapezoidal rule, with the step halved until it converges. Convergence is
/// geometric if f and its derivatives vanish at both ends (Trefethen & Weideman, SIAM Rev. 56, 385, 2014).
///
/// The error is a few 1e-15 of ∫|f|, for some hundred oscillations at most.
pub(super) fn trapezoid(from: f64, to: f64, f: impl Fn(f64) -> Complex64) -> Complex64 {
    const FIRST: usize = 48;
    const MOST: usize = FIRST << 10;
    let sum = |count: usize, offset: f64, step: f64| {
        (0..count)
            .map(|i| f(from + (i as f64 + offset) * step))
            .fold((Complex64::ZERO, 0.0), |(sum, size), value| (sum + value, size + value.norm()))
    };
    let (mut points, mut last) = (FIRST, Complex64::from(f64::NAN));
    let (mut total, mut size) = sum(FIRST + 1, 0.0, (to - from) / FIRST as f64);
    loop {
        let step = (to - from) / points as f64;
        let estimate = total * step;
        // The error of the finer of two estimates is about the square of their difference.
        if (estimate - last).norm() <= 1e-10 * size * step || points >= MOST {
            return estimate;
        }
        last = estimate;
        let (more, more_size) = sum(points, 0.5, step);
        (total, size, points) = (total + more, size + more_size, 2 * points);
    }
}

/// ∫ f over [from, to] by the double-exponential (tanh-sinh) rule of Takahasi and Mori (Publ. RIMS 9, 721,
/// 1974). f may have a power singularity at an end, preferably at `from` = 0.
pub(super) fn double_exponential(from: f64, to: f64, f: impl Fn(f64) -> Complex64) -> Complex64 {
    // x = from + (to − from)/(1 + exp(−π sinh t)); what remains beyond ±4.6 is below 1e-60 of the interval.
    trapezoid(-4.6, 4.6, |t| {
        let tilt = std::f64::consts::PI * t.sinh();
        let (left, right) = (1.0 / (1.0 + (-tilt).exp()), 1.0 / (1.0 + tilt.exp()));
        let slope = std::f64::consts::PI * t.cosh() * left * right;
        f(from + (to - from) * left) * ((to - from) * slope)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_integrals() {
        let gauss = trapezoid(-9.0, 9.0, |x| (Complex64::new(-0.5 * x * x, 3.0 * x)).exp());
        // √(2π) e^{−9/2}, of an integrand whose modulus integrates to √(2π).
        assert!((gauss.re - (std::f64::consts::TAU).sqrt() * (-4.5_f64).exp()).abs() < 1e-15);
        let root = double_exponential(0.0, 2.0, |x| Complex64::from(x.powf(-0.75)));
        // 4·2^¼, 64 roundings.
        assert!((root.re - 4.0 * 2.0_f64.powf(0.25)).abs() < 1e-14);
    }
}
