//! Numbers as they are shown.

/// A number with so many digits: with an exponent where it is below 1e-6 or has more digits before the point.
pub fn precise(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let long = format!("{:.*e}", digits.saturating_sub(1), value);
    let (mantissa, power) = long.split_once('e').unwrap_or((&long, "0"));
    match power.parse::<i32>() {
        Ok(power) if power < -6 || power >= digits as i32 => format!("{mantissa} e{power}"),
        Ok(power) => format!("{value:.*}", (digits as i32 - 1 - power).max(0) as usize),
        // Infinite.
        Err(_) => long,
    }
}

/// A number in a field: with an exponent where it is long otherwise.
pub fn brief(value: f64) -> String {
    let long = value != 0.0 && !(1e-3..1e5).contains(&value.abs());
    if long { format!("{value:e}") } else { value.to_string() }
}

/// A number that is not longer than so many digits.
pub fn rounded(value: f64, digits: usize) -> f64 {
    format!("{:.*e}", digits.saturating_sub(1), value).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_their_digits() {
        let cases = [
            (0.7342535685, "0.7342535685"),
            (12.0, "12.00000000"),
            (2.5e-8, "2.500000000 e-8"),
            (-3.0, "-3.000000000"),
        ];
        for (value, text) in cases {
            assert_eq!(precise(value, 10), text);
        }
        assert_eq!((precise(1234.0, 2), precise(0.0, 3)), ("1.2 e3".to_owned(), "0".to_owned()));
        assert_eq!(
            (brief(5e-4), brief(2000.0), brief(0.15)),
            ("5e-4".to_owned(), "2000".to_owned(), "0.15".to_owned())
        );
    }
}
