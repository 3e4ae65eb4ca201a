//! The interval between checkpoints.

use std::num::NonZeroU64;
use std::str::FromStr;
use std::time::Duration;

use crate::duration;

/// The interval between two checkpoints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Every {
    /// A number of events.
    Events(NonZeroU64),
    /// A time. The current event is completed first.
    Time(Duration),
}

impl Every {
    /// The expected form, for error messages.
    pub fn expected() -> String {
        format!("a number of events above 0, or {}", duration::EXPECTED)
    }
}

impl FromStr for Every {
    type Err = String;

    /// Parses a number of events, or a time with a unit.
    fn from_str(text: &str) -> Result<Self, String> {
        let number = text.trim().parse().map(Self::Events);
        let every = number.or_else(|_| duration::parse(text).map(Self::Time));
        every.map_err(|_| format!("expected {}", Self::expected()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bare_numbers_are_events_and_times_have_units() {
        assert_eq!("2000".parse(), Ok(Every::Events(NonZeroU64::new(2000).unwrap())));
        assert_eq!("10min".parse(), Ok(Every::Time(Duration::from_secs(600))));
        for wrong in ["0", "-3", "2.5", "ten", "0min", ""] {
            assert!(wrong.parse::<Every>().is_err(), "{wrong}");
        }
    }
}
