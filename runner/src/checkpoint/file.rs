//! One checkpoint as a file: a line that identifies the format, a header, the state, and a checksum.
//!
//! The header is a line of JSON, the state is CBOR (RFC 8949), and the checksum is the CRC-32 of everything before it.

use std::io::{self, Write as _};
use std::path::Path;

use asperity::task::WriteState;
use serde::{Deserialize, Serialize};

use super::error::{Error, Result};
use super::found::Extent;
use super::pieces::Pieces;

/// The first line, with the version of the format.
const FIRST: &[u8] = b"asperity checkpoint 2\n";
const CHECKSUM: usize = size_of::<u32>();

/// The header of a checkpoint.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Version of asperity that wrote it.
    pub version: String,
    /// Number of the checkpoint, counted from 1 over all runs.
    pub number: u64,
    /// Number of events so far.
    pub events: u64,
    /// The part of the file of columns that belongs to it.
    pub found: Extent,
    /// The resolved scenario.
    pub scenario: String,
}

/// A checkpoint.
#[derive(Debug)]
pub struct Content {
    pub header: Header,
    pub state: Vec<u8>,
}

/// Writes a checkpoint.
///
/// # Errors
/// The system refuses; [`Pieces`] are stopped.
pub fn write(header: &Header, state: &WriteState<'_>, pieces: Pieces<'_>) -> io::Result<()> {
    let mut buffer = pieces.buffered();
    buffer.write_all(FIRST)?;
    serde_json::to_writer(&mut buffer, header)?;
    buffer.write_all(b"\n")?;
    state(&mut buffer)?;
    let (checksum, out) = Pieces::end(buffer)?;
    out.write_all(&checksum.finalize().to_le_bytes())
}

/// Reads the checkpoint at `path`, if there is one.
pub fn read(path: &Path) -> Result<Option<Content>> {
    match std::fs::read(path) {
        Ok(bytes) => decode(&bytes).map(Some).map_err(|what| Error::Damaged { path: path.to_owned(), what }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Error::system(path, "read")(error)),
    }
}

fn decode(bytes: &[u8]) -> std::result::Result<Content, String> {
    let Some((body, checksum)) = bytes.split_last_chunk::<CHECKSUM>() else {
        return Err(format!("it has only {} bytes", bytes.len()));
    };
    let rest = body.strip_prefix(FIRST).ok_or("its first line is wrong")?;
    if crc32fast::hash(body) != u32::from_le_bytes(*checksum) {
        return Err("its checksum is wrong".into());
    }
    let end = rest.iter().position(|&byte| byte == b'\n').ok_or("it has no header")?;
    let header = serde_json::from_slice(&rest[..end]).map_err(|error| error.to_string())?;
    Ok(Content { header, state: rest[end + 1..].to_vec() })
}

#[cfg(test)]
mod tests {
    use super::super::bits::Bits;
    use super::*;

    fn header() -> Header {
        let (version, scenario) = ("1.2.3".into(), "title = 'α'\n".into());
        Header { version, number: 3, events: 7, found: Extent::default(), scenario }
    }

    fn encode(header: &Header, state: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let pieces = Pieces::new(&mut bytes, crc32fast::Hasher::new(), &|| false);
        write(header, &|out| out.write_all(state), pieces).unwrap();
        bytes
    }

    #[test]
    fn what_is_written_is_read_back_bit_for_bit() {
        let numbers = Bits(vec![0.1, -0.0, f64::NAN, f64::INFINITY, 5e-324]);
        let mut state = Vec::new();
        ciborium::into_writer(&(numbers.clone(), "words"), &mut state).unwrap();
        let bytes = encode(&header(), &state);
        let Content { header: found, state } = decode(&bytes).unwrap();
        assert_eq!(found, header());
        let (back, words): (Bits, String) = ciborium::from_reader(state.as_slice()).unwrap();
        assert_eq!(words, "words");
        let bits = |numbers: &Bits| numbers.0.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(&numbers));
    }

    #[test]
    fn any_byte_that_changes_and_any_end_that_is_cut_off_is_found() {
        let bytes = encode(&header(), b"a state");
        for place in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[place] ^= 0x10;
            assert!(decode(&changed).is_err(), "byte {place}");
            assert!(decode(&bytes[..place]).is_err(), "{place} bytes");
        }
    }
}
