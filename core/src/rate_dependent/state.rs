//! What time-dependent contacts have come to, to be kept and taken up again.

use ciborium::Value;
use serde::de::{DeserializeOwned, Deserializer, Error as _};
use serde::{Deserialize, Serialize, Serializer};

use crate::{Error, Result};

/// What contacts have come to, for contacts of the same description alone to read: as CBOR (RFC 8949), which keeps every
/// number bit for bit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ContactsState(Vec<u8>);

impl ContactsState {
    /// A state that is plain data.
    ///
    /// # Panics
    /// If it cannot be told as plain data, such as a map whose length is not known.
    pub fn of<T: Serialize>(kept: &T) -> Self {
        let mut bytes = Vec::new();
        ciborium::into_writer(kept, &mut bytes)
            .expect("a state is plain data, and memory does not refuse it");
        Self(bytes)
    }

    /// The plain data.
    ///
    /// # Errors
    /// It is that of something else.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T> {
        ciborium::from_reader(self.0.as_slice()).map_err(|error| Self::another(&error.to_string()))
    }

    /// The error of a state that is not that of these contacts, but another one.
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
