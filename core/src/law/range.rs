//! The range of the parameters of distributions in which their numbers have digits.

use crate::error::positive;
use crate::{Error, Result};

/// Lengths whose squares neither vanish nor overflow.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-150..=1e150;
/// The least standard deviation over the mean at which neighbouring numbers near the mean are distinguished.
const NARROWEST: f64 = 1e-14;
/// The largest, at which nearly all of the mean is in a part of 1e-12 of the distribution.
const WIDEST: f64 = 1e6;

/// Returns `value` if it is a length above 0 of which squares are numbers; `key` names it in the error.
pub(super) fn length(key: &str, value: f64) -> Result<f64> {
    if LENGTHS.contains(&positive(key, value)?) {
        return Ok(value);
    }
    Err(Error::invalid(key, "a length from 1e-150 to 1e150; take another unit", value))
}

/// The same for a length that may be 0.
pub(super) fn length_or_zero(key: &str, value: f64) -> Result<f64> {
    crate::error::not_negative(key, value)?;
    if value == 0.0 { Ok(0.0) } else { length(key, value) }
}

/// Returns the standard deviation `std` if the distribution of this mean has a width that numbers resolve.
pub(super) fn width(mean: f64, std: f64) -> Result<f64> {
    let std = length("std", std)?;
    if (NARROWEST * mean..=WIDEST * mean).contains(&std) {
        return Ok(std);
    }
    let expected = format!("a number from 1e-14 to 1e6 times mean = {mean}; for a single value take point");
    Err(Error::invalid("std", expected, std))
}
