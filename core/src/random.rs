//! Counter-based random streams.

/// A stream.
#[derive(Debug, Clone)]
pub struct Stream;
