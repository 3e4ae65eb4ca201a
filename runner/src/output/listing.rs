//! The list of files that asperity wrote into a folder, with sizes and checksums. A file that is not listed, or has
//! changed since, belongs to someone else.

use std::collections::BTreeMap;
use std::fs;
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
    /// Adds a file.
    pub fn add(&mut self, name: &str, bytes: &[u8]) {
        self.0.insert(name.to_owned(), (bytes.len() as u64, crc32fast::hash(bytes)));
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

    /// Whether the file at `path` is listed and unchanged.
    pub fn is_of_ours(&self, path: &Path) -> bool {
        let name = path.file_name().and_then(|name| name.to_str());
        let Some(&(size, sum)) = name.and_then(|name| self.0.get(name)) else { return false };
        let same_size = fs::symlink_metadata(path).is_ok_and(|found| found.is_file() && found.len() == size);
        same_size && fs::read(path).is_ok_and(|bytes| crc32fast::hash(&bytes) == sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_listing_is_read_as_it_was_written_and_nothing_else_is_one() {
        let mut listing = Listing::default();
        listing.add("force.csv", b"position,force\n");
        listing.add("with blanks.svg", b"");
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
            listing.add(name, b"abc");
            fs::write(path(name), now).unwrap();
        }
        fs::write(path("foreign"), "abc").unwrap();
        let found = ["same", "longer", "changed", "foreign"].map(|name| listing.is_of_ours(&path(name)));
        assert_eq!(found, [true, false, false, false]);
    }
}
