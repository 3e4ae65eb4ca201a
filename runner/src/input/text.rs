//! Files read as text: limited in size, and refused with a position if they are not UTF-8.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

/// The largest file that is read, in bytes. A device may be endless.
const LARGEST: u64 = 256 << 20;

/// Reads the text of the file at `path`.
///
/// # Errors
/// The reason, in words.
pub fn read(path: &Path) -> Result<String, String> {
    let bytes = bounded(path, LARGEST)?;
    if let Some(what) = other_encoding(&bytes) {
        return Err(format!("{what}; save it as UTF-8"));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        format!("{}; save it as UTF-8", misplaced(error.as_bytes(), at, "is not UTF-8"))
    })
}

fn bounded(path: &Path, largest: u64) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| error.to_string())?;
    file.take(largest + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if bytes.len() as u64 > largest {
        return Err(format!("more than {} MiB, the largest file that is read", largest >> 20));
    }
    Ok(bytes)
}

/// The kind of a file that is neither UTF-8 nor another encoding with single-byte ASCII.
fn other_encoding(bytes: &[u8]) -> Option<String> {
    match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => {
            Some("a text in UTF-16, by the mark in its first two bytes".into())
        }
        _ => {
            let at = bytes.iter().position(|&byte| byte == 0)?;
            Some(misplaced(bytes, at, "is not text: the file is binary, or text in UTF-16"))
        }
    }
}

/// The byte at a position, and the position as line and column and as a byte range.
fn misplaced(bytes: &[u8], at: usize, what: &str) -> String {
    let before = &bytes[..at];
    let line = before.iter().filter(|&&byte| byte == b'\n').count() + 1;
    let column = at - before.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1) + 1;
    format!("byte 0x{:02X} at offset {at} (line {line}, byte {column}) {what}", bytes[at])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(bytes: &[u8]) -> String {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        read(file.path()).unwrap_err()
    }

    #[test]
    fn what_is_not_utf8_is_named_with_its_place() {
        // µ as Latin-1 has it.
        assert_eq!(
            refused(b"title = 'a'\nunits.length = '\xb5m'\n"),
            "byte 0xB5 at offset 28 (line 2, byte 17) is not UTF-8; save it as UTF-8"
        );
        let wide = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        assert!(refused(&[&[0xff, 0xfe][..], &wide("title")].concat()).starts_with("a text in UTF-16"));
        assert!(refused(&wide("title")).starts_with("byte 0x00 at offset 1 (line 1, byte 2) is not text"));
    }

    #[test]
    fn what_has_no_end_is_refused() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), [b' '; 11]).unwrap();
        assert!(bounded(file.path(), 10).unwrap_err().starts_with("more than"));
        assert_eq!(bounded(file.path(), 11).unwrap().len(), 11);
    }
}
