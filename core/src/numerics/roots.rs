//! Roots and minima of functions of one variable: Brent's methods.
//!
//! R. P. Brent, *Algorithms for Minimization without Derivatives* (1973), chapters 4 and 5.

/// Largest number of steps; bisection alone needs 60.
const MOST_STEPS: usize = 200;

/// A zero of `f` between `a` and `b`, to within `tolerance` (or rounding), by bisection, secants and inverse
/// quadratic interpolation.
///
/// Returns `None` if `f(a)` and `f(b)` have the same sign or one of them is not a number. If `f` jumps across
/// 0, returns the position of the jump.
pub fn brent_root(mut f: impl FnMut(f64) -> f64, a: f64, b: f64, tolerance: f64) -> Option<f64> {
    let ends = [(a, f(a)), (b, f(b))];
    brent_root_between(f, ends, tolerance)
}

/// The same where the values at both ends are known.
pub fn brent_root_between(
    mut f: impl FnMut(f64) -> f64,
    [(a, fa), (b, fb)]: [(f64, f64); 2],
    tolerance: f64,
) -> Option<f64> {
    // b is the best estimate, a the one before, [b, c] brackets the root.
    let (mut a, mut b, mut c) = (a, b, a);
    let (mut fa, mut fb) = (fa, fb);
    if fa.is_nan() || fb.is_nan() || (fa > 0.0) == (fb > 0.0) && fa != 0.0 && fb != 0.0 {
        return None;
    }
    let mut fc = fa;
    let (mut step, mut before) = (b - a, b - a);
    for _ in 0..MOST_STEPS {
        if fc.abs() < fb.abs() {
            (a, b, c) = (b, c, b);
            (fa, fb, fc) = (fb, fc, fb);
        }
        let least = 2.0 * f64::EPSILON * b.abs() + 0.5 * tolerance;
        let half = 0.5 * (c - b);
        if half.abs() <= least || fb == 0.0 {
            return Some(b);
        }
        // An interpolated step is accepted if it stays well inside the bracket and is less than
        // half of the step before the last; otherwise the bracket is bisected. This bounds the
        // number of evaluations for any function, and keeps superlinear convergence for smooth
        // ones.
        (step, before) = match interpolate((a, fa), (b, fb), (c, fc)) {
            Some(next)
                if before.abs() >= least
                    && next.abs() < 0.5 * before.abs()
                    && next * half > 0.0
                    && next.abs() < 1.5 * half.abs() - 0.5 * least =>
            {
                (next, step)
            }
            _ => (half, half),
        };
        (a, fa) = (b, fb);
        // A step below the tolerance is replaced by the tolerance, so that the next point lies
        // beyond the root and closes the bracket from the other side.
        b += if step.abs() > least { step } else { least.copysign(half) };
        fb = f(b);
        if (fb > 0.0) == (fc > 0.0) {
            (c, fc) = (a, fa);
            (step, before) = (b - a, b - a);
        }
    }
    Some(b)
}

/// The step from b by inverse quadratic interpolation, or by the secant method where two points coincide.
fn interpolate((a, fa): (f64, f64), (b, fb): (f64, f64), (c, fc): (f64, f64)) -> Option<f64> {
    if fa.abs() <= fb.abs() {
        return None;
    }
    let s = fb / fa;
    let (p, q) = if a == c {
        ((c - b) * s, 1.0 - s)
    } else {
        let (q, r) = (fa / fc, fb / fc);
        (s * ((c - b) * q * (q - r) - (b - a) * (r - 1.0)), (q - 1.0) * (r - 1.0) * (s - 1.0))
    };
    Some(-p / q)
}

/// A minimum of `f` on `[a, b]` as (position, value), the position to within `tolerance`, by golden sections
/// and parabolas.
///
/// The position of a smooth minimum cannot be known better than √ε of its size; its value can. If `f` has
/// several minima, one of them; if it is monotonic, a point near the lower end.
pub fn brent_minimum(mut f: impl FnMut(f64) -> f64, a: f64, b: f64, tolerance: f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.381_966_011_250_105_2;
    let (mut a, mut b) = (a.min(b), a.max(b));
    // x is the best point, w the second best, v the one before w.
    let mut x = a + GOLDEN * (b - a);
    let (mut w, mut v) = (x, x);
    let mut fx = f(x);
    let (mut fw, mut fv) = (fx, fx);
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    for _ in 0..MOST_STEPS {
        let middle = 0.5 * (a + b);
        // Near a minimum f changes with the square of the distance: closer points than √ε x give
        // equal values.
        let least = f64::EPSILON.sqrt() * x.abs() * 1e-1 + tolerance / 3.0;
        if (x - middle).abs() <= 2.0 * least - 0.5 * (b - a) {
            break;
        }
        let next = parabola((x, fx), (w, fw), (v, fv));
        // A parabola is trusted if it moves less than half of the step before the last; otherwise
        // the golden section of the larger part reduces the interval by a constant factor per
        // evaluation.
        (step, before) = if next.abs() < 0.5 * before.abs() && x + next > a && x + next < b {
            let close = x + next - a < 2.0 * least || b - x - next < 2.0 * least;
            (if close { least.copysign(middle - x) } else { next }, step)
        } else {
            let whole = if x < middle { b - x } else { a - x };
            (GOLDEN * whole, whole)
        };
        let u = x + if step.abs() >= least { step } else { least.copysign(step) };
        let fu = f(u);
        if fu <= fx {
            if u < x {
                b = x
            } else {
                a = x
            }
            (v, w, x) = (w, x, u);
            (fv, fw, fx) = (fw, fx, fu);
        } else {
            if u < x {
                a = u
            } else {
                b = u
            }
            if fu <= fw || w == x {
                (v, w) = (w, u);
                (fv, fw) = (fw, fu);
            } else if fu <= fv || v == x || v == w {
                (v, fv) = (u, fu);
            }
        }
    }
    (x, fx)
}

/// The step from x to the vertex of the parabola through three points; NaN where there is none.
fn parabola((x, fx): (f64, f64), (w, fw): (f64, f64), (v, fv): (f64, f64)) -> f64 {
    let r = (x - w) * (fx - fv);
    let q = (x - v) * (fx - fw);
    ((x - w) * r - (x - v) * q) / (2.0 * (q - r))
}

#[cfg(test)]
mod tests {
    use super::{brent_minimum, brent_root};

    #[test]
    fn roots_of_smooth_flat_and_jumping_functions() {
        let mut calls = 0;
        let root = brent_root(
            |x| {
                calls += 1;
                x.cos() - x
            },
            0.0,
            1.0,
            0.0,
        )
        .unwrap();
        // The Dottie number; two ulp is the limit set for the search.
        assert!((root - 0.739_085_133_215_160_6).abs() < 4e-16);
        assert!(calls < 12, "{calls} calls where bisection needs 53");
        let flat = brent_root(|x| (x - 1.0).powi(9), 0.0, 3.0, 1e-12).unwrap();
        assert!((flat - 1.0).abs() < 1e-12);
        let jump = brent_root(|x| if x < 0.3 { -1.0 } else { 2.0 }, 0.0, 1.0, 1e-12).unwrap();
        assert!((jump - 0.3).abs() < 1e-12);
    }

    #[test]
    fn roots_at_the_ends_and_none() {
        assert_eq!(brent_root(|x| x, 0.0, 1.0, 0.0), Some(0.0));
        assert_eq!(brent_root(|x| x - 1.0, 0.0, 1.0, 0.0), Some(1.0));
        assert_eq!(brent_root(|x| x + 1.0, 0.0, 1.0, 0.0), None);
        assert_eq!(brent_root(|_| f64::NAN, 0.0, 1.0, 0.0), None);
    }

    #[test]
    fn minima_inside_and_at_an_end() {
        let mut calls = 0;
        let (x, value) = brent_minimum(
            |x| {
                calls += 1;
                x * x.ln()
            },
            0.01,
            2.0,
            1e-10,
        );
        // x ln x has its minimum −1/e at 1/e; the place is limited by √ε.
        assert!((x - (-1.0_f64).exp()).abs() < 3e-8);
        assert!((value + (-1.0_f64).exp()).abs() < 1e-15);
        assert!(calls < 25, "{calls} calls");
        let (end, _) = brent_minimum(|x| x, 1.0, 2.0, 1e-9);
        assert!((end - 1.0).abs() < 1e-8);
    }
}
