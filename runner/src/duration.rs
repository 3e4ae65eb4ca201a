//! Durations as text: `90s`, `10min`, `1h30min`, `2d`, and `[days-]hours:minutes:seconds` as for batch schedulers.

use std::time::Duration;

/// Units and their seconds.
const UNITS: [(&str, f64); 4] = [("d", 86400.0), ("h", 3600.0), ("min", 60.0), ("s", 1.0)];
/// The expected form, for error messages.
pub const EXPECTED: &str = "a time such as 90s, 10min, 1h30min, 2d or 23:50:00";
/// A hundred years, in seconds: the largest duration, which every clock can represent.
const LONGEST: f64 = 3.2e9;

/// Parses a duration.
///
/// # Errors
/// Text that is not a duration above 0, with the reason.
pub fn parse(text: &str) -> Result<Duration, String> {
    let seconds = if text.contains(':') { clock(text) } else { sum(text) };
    seconds.and_then(within).ok_or_else(|| format!("expected {EXPECTED}"))
}

/// The duration of a number of seconds; `None` if it is out of range.
pub fn within(seconds: f64) -> Option<Duration> {
    (seconds > 0.0 && seconds <= LONGEST).then(|| Duration::from_secs_f64(seconds))
}

/// Parses numbers with units, one after the other: `1h30min`.
fn sum(text: &str) -> Option<f64> {
    let mut rest = text.trim();
    let mut seconds = 0.0;
    while !rest.is_empty() {
        let digits = rest.find(|letter: char| !letter.is_ascii_digit() && letter != '.')?;
        let (number, behind) = rest.split_at(digits);
        let unit = behind.find(|letter: char| !letter.is_ascii_alphabetic()).unwrap_or(behind.len());
        let (unit, behind) = behind.split_at(unit);
        seconds += number.parse::<f64>().ok()? * UNITS.iter().find(|known| known.0 == unit)?.1;
        rest = behind.trim_start();
    }
    Some(seconds)
}

/// Parses `[days-]hours:minutes:seconds`.
fn clock(text: &str) -> Option<f64> {
    let (days, clock) = text.trim().split_once('-').unwrap_or(("0", text.trim()));
    let parts: Option<Vec<u32>> = clock.split(':').map(|part| part.parse().ok()).collect();
    let [hours, minutes, seconds] = parts?.try_into().ok()?;
    let days: u32 = days.parse().ok()?;
    let [days, hours, minutes, seconds] = [days, hours, minutes, seconds].map(f64::from);
    Some(((days * 24.0 + hours) * 60.0 + minutes) * 60.0 + seconds)
}

/// `duration` in its two largest units, as text.
pub fn words(duration: Duration) -> String {
    let seconds = duration.as_secs();
    if seconds == 0 {
        return format!("{} s", duration.as_secs_f64());
    }
    match (seconds / 86400, seconds / 3600 % 24, seconds / 60 % 60, seconds % 60) {
        (0, 0, 0, s) => format!("{s} s"),
        (0, 0, min, 0) => format!("{min} min"),
        (0, 0, min, s) => format!("{min} min {s} s"),
        (0, h, 0, _) => format!("{h} h"),
        (0, h, min, _) => format!("{h} h {min} min"),
        (d, 0, ..) => format!("{d} d"),
        (d, h, ..) => format!("{d} d {h} h"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_people_and_schedulers_write_them() {
        for (text, seconds) in [
            ("90s", 90.0),
            ("10min", 600.0),
            ("1.5h", 5400.0),
            ("1h30min", 5400.0),
            ("1h 30min", 5400.0),
            ("2d", 172_800.0),
            ("23:50:00", 85_800.0),
            ("1-00:00:30", 86_430.0),
        ] {
            assert_eq!(parse(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
    }

    #[test]
    fn what_is_no_time_is_refused() {
        for text in
            ["", "0s", "-1h", "10", "10 m", "min", "1e400s", "10:30", "1:2:3:4", "1h30", "1..5h", "9999999d"]
        {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn times_are_reported_in_two_units() {
        for (seconds, expected) in [
            (1, "1 s"),
            (59, "59 s"),
            (60, "1 min"),
            (61, "1 min 1 s"),
            (3600, "1 h"),
            (5400, "1 h 30 min"),
            (86_400, "1 d"),
            (90_000, "1 d 1 h"),
        ] {
            assert_eq!(words(Duration::from_secs(seconds)), expected);
        }
        assert_eq!(words(Duration::from_millis(300)), "0.3 s");
    }
}
