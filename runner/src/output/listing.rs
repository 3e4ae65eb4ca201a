//! The list of files that asperity wrote into a folder, with sizes and checksums. A file that is not listed, or has
//! changed since, belongs to someone else.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

/// Beginning of a listing, followed by the version that wrote it.
const FIRST: &str = "made by asperity ";
/// The second line, an explanation for readers.
const SECOND: &str =
    "Other files in this folder, and files that were changed, are kept: a run replaces these alone.";

/// Files by name, with their sizes and CRC-32.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Listing(BTreeMap<String, (u64, u32)>);

impl Listing {
    /// Adds a file of this size and CRC-32.
    pub fn add(&mut self, name: &str, size: u64, checksum: u32) {
        self.0.insert(name.to_owned(), (size, checksum));
    }

    /// The text of the listing, for [`Listing::read`]: a line with checksum, size and name for each file.
    pub fn to_text(&self) -> String {
        let lines = self.0.iter().map(|(name, (size, sum))| format!("{sum:08x} {size} {name}\n"));
        format!("{FIRST}{}\n{SECOND}\n{}", env!("CARGO_PKG_VERSION"), lines.collect::<String>())
    }

    /// Parses a listing; `None` if the text is not one, or names no files.
    pub fn read(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        (lines.next()?.starts_with(FIRST) && lines.next()? == SECOND).then_some(())?;
        let file = |line: &str| {
            let mut parts = line.splitn(3, ' ');
            let sum = u32::from_str_radix(parts.next()?, 16).ok()?;
            let size = parts.next()?.parse().ok()?;
            Some((parts.next()?.to_owned(), (size, sum)))
        };
        lines.map(file).collect::<Option<_>>().map(Self)
    }

    /// Whether a file of this name is listed.
    pub fn has(&self, name: &OsStr) -> bool {
        name.to_str().is_some_and(|name| self.0.contains_key(name))
    }

    /// Whether the file at `path` is listed and unchanged.
    pub fn is_of_ours(&self, path: &Path) -> bool {
        let name = path.file_name().and_then(|name| name.to_str());
        let Some(&(size, sum)) = name.and_then(|name| self.0.get(name)) else { return false };
        let same_size = fs::symlink_metadata(path).is_ok_and(|found| found.is_file() && found.len() == size);
        let checksum = || -> io::Result<u32> {
            let mut summed = Summed::new(io::sink());
            io::copy(&mut fs::File::open(path)?, &mut summed)?;
            Ok(summed.finish().2)
        };
        same_size && checksum().is_ok_and(|found| found == sum)
    }
}

/// A writer that keeps count of the bytes written and of their CRC-32.
pub struct Summed<W> {
    writer: W,
    size: u64,
    checksum: crc32fast::Hasher,
}

impl<W: Write> Summed<W> {
    /// Writes to `writer`.
    pub fn new(writer: W) -> Self {
        Self { writer, size: 0, checksum: crc32fast::Hasher::new() }
    }

    /// The writer, the number of bytes, and their CRC-32.
    pub fn finish(self) -> (W, u64, u32) {
        (self.writer, self.size, self.checksum.finalize())
    }
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.writer.write(bytes)?;
        self.size += written as u64;
        self.checksum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_listing_is_read_as_it_was_written_and_nothing_else_is_one() {
        let mut listing = Listing::default();
        listing.add("force.csv", 15, 0x89ab_cdef);
        listing.add("with blanks.svg", 0, 0);
        assert_eq!(Listing::read(&listing.to_text()), Some(listing));
        for text in ["", "made by asperity 0.1.0\n", "made by somebody\nforce.csv\n"] {
            assert_eq!(Listing::read(text), None, "{text}");
        }
    }

    #[test]
    fn only_what_is_as_it_was_written_is_of_ours() {
        let folder = tempfile::tempdir().unwrap();
        let mut listing = Listing::default();
        let path = |name| folder.path().join(name);
        for (name, now) in [("same", "abc"), ("longer", "abcd"), ("changed", "abd")] {
            listing.add(name, 3, crc32fast::hash(b"abc"));
            fs::write(path(name), now).unwrap();
        }
        fs::write(path("foreign"), "abc").unwrap();
        let found = ["same", "longer", "changed", "foreign"].map(|name| listing.is_of_ours(&path(name)));
        assert_eq!(found, [true, false, false, false]);
    }
}
