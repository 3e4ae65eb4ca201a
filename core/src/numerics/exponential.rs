//! e^x by arithmetic that the compiler turns into vector instructions in loops.

/// Exponents beyond this count as this.
const MOST: f64 = 700.0;

/// Adding this number and subtracting it again rounds to the nearest integer, whose bits then are the lowest of the
/// sum.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// ln 2 as a number of few digits, whose multiples are exact, and the rest.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// 1/n!, n from 12 down to 0: on |x| ≤ ½ ln 2 the sum misses 2e-16.
const TAYLOR: [f64; 13] = {
    let mut terms = [1.0; 13];
    let mut n = 1;
    while n < 13 {
        let mut k = 0;
        while k < 13 - n {
            terms[k] /= n as f64;
            k += 1;
        }
        n += 1;
    }
    // terms[k] has been divided by 1, 2, … 12 − k.
    terms
};

/// e^x to some roundings, for x limited to ±700.
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    let x = x.clamp(-MOST, MOST);
    let rounded = x * std::f64::consts::LOG2_E + ROUND;
    let whole = rounded - ROUND;
    let rest = (x - whole * LN_2[0]) - whole * LN_2[1];
    // Even and odd powers apart: two short chains of operations instead of one long one.
    let square = rest * rest;
    let (mut even, mut odd) = (TAYLOR[0], TAYLOR[1]);
    for k in 1..6 {
        even = even * square + TAYLOR[2 * k];
        odd = odd * square + TAYLOR[2 * k + 1];
    }
    let sum = (even * square + TAYLOR[12]) + odd * rest;
    // 2ⁿ has the exponent bits n + 1023.
    sum * f64::from_bits(rounded.to_bits().wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_that_of_the_mathematical_library() {
        for k in -70_000..=70_000 {
            let x = f64::from(k) * 0.009_999_7;
            // Rounding of twelve terms that fall by a factor of three and more.
            assert!((exp(x) / x.exp() - 1.0).abs() < 4.0 * f64::EPSILON, "{x}");
        }
        assert_eq!([0.0, -0.0, 1e-300].map(exp), [1.0; 3]);
        // Limited, not infinite and not 0.
        let far = [1e4, -1e4, f64::INFINITY, f64::NEG_INFINITY].map(exp);
        assert_eq!(far, [700.0, -700.0, 700.0, -700.0].map(exp));
        assert!(exp(700.0) < 1.1e304 && exp(-700.0) > 0.9e-304);
    }
}
