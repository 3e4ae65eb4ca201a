//! States of runs in CBOR (RFC 8949), which keeps every number bit for bit.
//!
//! Without the feature `checkpoints` nothing is written or read: the code for it is a tenth of a program that stores no runs, such
//! as a page.

use std::io::{self, Write};

use serde::Serialize;
use serde::de::DeserializeOwned;

const MISSING: &str = "asperity was compiled without the feature checkpoints";

/// Writes a value.
pub fn write<T: Serialize + ?Sized>(value: &T, out: &mut dyn Write) -> io::Result<()> {
    if cfg!(not(feature = "checkpoints")) {
        return Err(io::Error::other(MISSING));
    }
    ciborium::into_writer(value, out).map_err(|error| match error {
        ciborium::ser::Error::Io(error) => error,
        ciborium::ser::Error::Value(what) => io::Error::other(what),
    })
}

/// Reads a value; the error is in words.
pub fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    if cfg!(not(feature = "checkpoints")) {
        return Err(MISSING.to_owned());
    }
    ciborium::from_reader(bytes).map_err(|error| error.to_string())
}
