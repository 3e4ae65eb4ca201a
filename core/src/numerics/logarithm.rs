//! ln x by arithmetic that the compiler turns into vector instructions in loops.

/// The bits of √½.
const LOWEST: u64 = 0x3fe6_a09e_667f_3bcd;

/// The bits of the fraction of a number.
const FRACTION: u64 = (1 << 52) - 1;

/// ln 2 as a number of few digits, whose multiples are exact, and the rest.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// 1/(2n + 1), n from 10 down to 1: on |s| ≤ (√2 − 1)/(√2 + 1) the series of artanh s misses 1e-18.
const ARTANH: [f64; 10] = [
    1.0 / 21.0,
    1.0 / 19.0,
    1.0 / 17.0,
    1.0 / 15.0,
    1.0 / 13.0,
    1.0 / 11.0,
    1.0 / 9.0,
    1.0 / 7.0,
    1.0 / 5.0,
    1.0 / 3.0,
];

/// ln x to some roundings of its value or of 1, for normal x > 0.
#[inline(always)]
pub(crate) fn ln(x: f64) -> f64 {
    // x = 2ⁿ m with m from √½ to √2, and ln m = 2 artanh[(m − 1)/(m + 1)].
    let above = x.to_bits().wrapping_sub(LOWEST);
    let power = ((above as i64) >> 52) as f64;
    let m = f64::from_bits((above & FRACTION) + LOWEST);
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let mut sum = ARTANH[0];
    for term in &ARTANH[1..] {
        sum = sum * square + term;
    }
    power * LN_2[0] + (2.0 * s + (2.0 * s * square * sum + power * LN_2[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_that_of_the_mathematical_library() {
        for k in -70_000..=70_000 {
            let x = (f64::from(k) * 0.009_999_7).exp();
            // Roundings of the quotient and of the sum.
            assert!((ln(x) - x.ln()).abs() <= 4.0 * f64::EPSILON * x.ln().abs().max(0.25), "{x}");
        }
        assert_eq!(ln(1.0), 0.0);
        for x in [f64::MIN_POSITIVE, 0.5, 0.5_f64.sqrt(), 2.0_f64.sqrt(), 2.0, f64::MAX] {
            assert!((ln(x) - x.ln()).abs() <= 4.0 * f64::EPSILON * x.ln().abs(), "{x}");
        }
    }
}
