//! The state of contacts as opaque bytes, for checkpoints and simulations.

use ciborium::Value;
use serde::de::{DeserializeOwned, Deserializer, Error as _};
use serde::{Deserialize, Serialize, Serializer};

use crate::{Error, Result, cbor};

/// The state of contacts, readable only by contacts of the same description. It is CBOR (RFC 8949), which keeps every number
/// bit for bit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ContactsState(Vec<u8>);

impl ContactsState {
    /// The state from plain data.
    ///
    /// # Panics
    /// If it cannot be serialised as plain data, such as a map of unknown length; without the feature `checkpoints`.
    pub fn of<T: Serialize>(kept: &T) -> Self {
        let mut bytes = Vec::new();
        cbor::write(kept, &mut bytes).expect("a state is plain data, and writing to memory does not fail");
        Self(bytes)
    }

    /// The plain data.
    ///
    /// # Errors
    /// The data have another type; a build without the feature `checkpoints`.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T> {
        cbor::read(&self.0).map_err(|error| Self::another(&error))
    }

    /// The error for a state of other contacts.
    pub fn another(found: &str) -> Error {
        Error::invalid("state", "that of contacts of the same description", found)
    }
}

impl Serialize for ContactsState {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.serialize_bytes(&self.0)
    }
}

impl<'de> Deserialize<'de> for ContactsState {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let bytes = Value::deserialize(deserializer)?.into_bytes();
        bytes.map(Self).map_err(|_| D::Error::custom("expected the bytes of a state of contacts"))
    }
}
