//! Errors: an invalid description, a job too big, an accuracy not reached, a computation that was stopped.

/// The result of a fallible operation of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// An error, with the numbers needed to correct it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An invalid value in a description.
    #[error("{key}: expected {expected}, got {found}")]
    Invalid {
        /// Name of the argument, or path of the field of one (`std`, `slip.inertial.mass`); of a scenario, path of the key.
        key: String,
        /// What would have been accepted.
        expected: String,
        /// What was found.
        found: String,
    },
    /// The job would not fit in memory.
    #[error("{key}: {what} would need {needed} bytes, more than the {allowed} allowed")]
    TooLarge {
        /// Name of the argument, or of the key, that asks for it.
        key: String,
        /// What was asked for.
        what: String,
        /// Bytes it would need.
        needed: u64,
        /// Bytes that are allowed.
        allowed: u64,
    },
    /// The accuracy asked for was not reached.
    #[error(
        "{}{what}: reached an accuracy of {reached:e}, short of the {wanted:e} asked for{}",
        named(key),
        remedy(key, reached)
    )]
    Accuracy {
        /// Name of the argument, or of the key, that asks for it; empty where none does.
        key: String,
        /// The computation.
        what: String,
        /// Estimated error of the best result.
        reached: Float,
        /// Tolerance asked for.
        wanted: Float,
    },
    /// Steps in time that are accurate enough would be too short to go on.
    #[error(
        "{what}: steps that meet the tolerance of {tolerance:e} became too short to go on from t = {}",
        time.0
    )]
    StepTooShort {
        /// What moves.
        what: String,
        /// Time t of the last step.
        time: Float,
        /// Tolerance of a step.
        tolerance: Float,
    },
    /// The monitor stopped the computation.
    #[error("stopped before the end")]
    Stopped,
}

/// A key, as the start of a message.
fn named(key: &str) -> String {
    if key.is_empty() { String::new() } else { format!("{key}: ") }
}

/// Advice if a key requires more than is reached.
fn remedy(key: &str, reached: &Float) -> String {
    match reached.0 {
        _ if key.is_empty() => String::new(),
        reached if reached.is_finite() => {
            format!("; allow {:.1e}, or leave the tolerance out", 2.0 * reached)
        }
        _ => "; allow more, or leave the tolerance out".to_owned(),
    }
}

/// An `f64` that can stand in a comparable error: equal if all its bits are.
#[derive(Debug, Clone, Copy)]
pub struct Float(pub f64);

impl PartialEq for Float {
    fn eq(&self, other: &Self) -> bool {
        self.0.to_bits() == other.0.to_bits()
    }
}

impl Eq for Float {}

impl std::fmt::LowerExp for Float {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::LowerExp::fmt(&self.0, f)
    }
}

impl Error {
    /// An [`Error::Invalid`] about `key`.
    pub fn invalid(key: impl Into<String>, expected: impl Into<String>, found: impl ToString) -> Self {
        Self::Invalid { key: key.into(), expected: expected.into(), found: found.to_string() }
    }

    /// The same error, its key prefixed by the name of its table.
    #[must_use]
    pub fn under(mut self, table: &str) -> Self {
        match &mut self {
            Self::Invalid { key, .. } | Self::TooLarge { key, .. } => {
                *key = if key.is_empty() { table.to_owned() } else { format!("{table}.{key}") };
            }
            Self::Accuracy { key, .. } if !key.is_empty() => *key = format!("{table}.{key}"),
            _ => {}
        }
        self
    }
}

/// Returns `value` if it is a finite number; `key` names it in the error.
pub(crate) fn finite(key: &str, value: f64) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { Err(Error::invalid(key, "a finite number", value)) }
}

/// Returns `value` if it is a finite number above 0; `key` names it in the error.
pub(crate) fn positive(key: &str, value: f64) -> Result<f64> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(Error::invalid(key, "a finite number above 0", value))
}

/// Returns `value` if it is a finite number, 0 or above; `key` names it in the error.
pub(crate) fn not_negative(key: &str, value: f64) -> Result<f64> {
    if value.is_finite() && value >= 0.0 {
        return Ok(value);
    }
    Err(Error::invalid(key, "a finite number, 0 or above", value))
}

/// Checks that all `values` are finite numbers; `key` names their list in the error.
pub(crate) fn all_finite(key: &str, values: &[f64]) -> Result<()> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(i) => Err(Error::invalid(format!("{key}.{i}"), "a finite number", values[i])),
        None => Ok(()),
    }
}

/// Checks that a list is as long as others are, such as 5 "forces, one for each hold"; `key` names it in the error.
pub(crate) fn as_many(key: &str, found: usize, (count, what): (usize, &str)) -> Result<()> {
    if found == count { Ok(()) } else { Err(Error::invalid(key, format!("{count} {what}"), found)) }
}
