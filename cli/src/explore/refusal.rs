//! Requests that are refused, each with its status and one sentence.

use hyper::StatusCode;

/// A status, and what the sender reads.
#[derive(Debug)]
pub struct Refusal(pub StatusCode, pub String);

impl Refusal {
    /// A refusal with this status.
    pub fn new(status: StatusCode, words: impl Into<String>) -> Self {
        Self(status, words.into())
    }
}

/// Goes on if `holds`, and refuses otherwise.
pub fn require(holds: bool, status: StatusCode, words: &str) -> Result<(), Refusal> {
    if holds { Ok(()) } else { Err(Refusal::new(status, words)) }
}
