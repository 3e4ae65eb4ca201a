//! The recorded columns of a run as a file to which every checkpoint appends its new rows, so that each number is written
//! once.
//!
//! The first line identifies the format. Each checkpoint appends a list of columns in CBOR (RFC 8949), and stores how many
//! bytes of the file belong to it, with their CRC-32. Bytes after these belong to a checkpoint that was lost.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead as _, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use asperity::task::write_cbor;
use serde::{Deserialize, Serialize};

use super::bits::Bits;
use super::error::{Error, Result};
use super::pieces::Pieces;

/// The first line, with the version of the format.
const FIRST: &[u8] = b"asperity results so far 1\n";

/// The part of the file that belongs to a checkpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Extent {
    /// Number of bytes.
    bytes: u64,
    /// CRC-32 of these bytes.
    checksum: u32,
}

/// The file, and the extent written so far.
#[derive(Debug)]
pub struct FoundFile {
    path: PathBuf,
    /// The open file; opened when rows are first appended.
    file: Option<File>,
    extent: Extent,
}

impl FoundFile {
    /// The file at `path`, of which nothing belongs to this run yet.
    pub fn new(path: PathBuf) -> Self {
        Self { path, file: None, extent: Extent::default() }
    }

    /// Takes up the rows that belong to a checkpoint. More can be appended to them.
    ///
    /// # Errors
    /// The file is damaged, or cannot be read.
    pub fn take_up(&mut self, extent: Extent) -> Result<()> {
        check(&self.path, extent)?;
        self.extent = extent;
        Ok(())
    }

    /// Passes on the rows that were taken up, as they were appended, until one is refused.
    ///
    /// # Errors
    /// The file has changed, or cannot be read.
    pub fn rows(
        &self,
        each: &mut dyn FnMut(Vec<Bits>) -> asperity::Result<()>,
    ) -> Result<asperity::Result<()>> {
        let read = || Error::system(&self.path, "read");
        let mut file = opened(&self.path, self.extent).map_err(read())?;
        // It has been checked.
        file.read_exact(&mut [0; FIRST.len()]).map_err(read())?;
        while !file.fill_buf().map_err(read())?.is_empty() {
            let rows: Vec<Bits> = ciborium::from_reader(&mut file)
                .map_err(|error| Error::Damaged { path: self.path.clone(), what: error.to_string() })?;
            if let Err(refused) = each(rows) {
                return Ok(Err(refused));
            }
        }
        Ok(Ok(()))
    }

    /// The part of the file that belongs to this run.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Drops everything after `extent`.
    pub fn go_back(&mut self, extent: Extent) {
        *self = Self { extent, ..Self::new(std::mem::take(&mut self.path)) };
    }

    /// Appends rows to the columns and flushes them to the disk, unless it `stops`. After an error, [`FoundFile::go_back`] must
    /// be called.
    ///
    /// # Errors
    /// The system refuses, or the writing is given up.
    pub fn add(&mut self, rows: &[Bits], stops: &dyn Fn() -> bool) -> Result<()> {
        let Extent { bytes, checksum } = self.extent;
        let first = if bytes == 0 { FIRST } else { &[] };
        let file = self.open()?;
        let mut append = || {
            let checksum = crc32fast::Hasher::new_with_initial(checksum);
            let mut buffer = Pieces::new(file, checksum, stops).buffered();
            buffer.write_all(first)?;
            write_cbor(rows, &mut buffer)?;
            let (checksum, _) = Pieces::end(buffer)?;
            file.sync_data()?;
            Ok(Extent { bytes: file.stream_position()?, checksum: checksum.finalize() })
        };
        self.extent = append().map_err(Error::system(&self.path, "write"))?;
        Ok(())
    }

    /// The file, opened at the end of the part that belongs to this run.
    fn open(&mut self) -> Result<&mut File> {
        if self.file.is_none() {
            let mut file = OpenOptions::new()
                .write(true)
                .create(true)
                .truncate(false)
                .open(&self.path)
                .map_err(Error::system(&self.path, "create"))?;
            let end = self.extent.bytes;
            let placed = file.set_len(end).and_then(|()| file.seek(SeekFrom::Start(end)));
            placed.map_err(Error::system(&self.path, "write"))?;
            self.file = Some(file);
        }
        Ok(self.file.as_mut().expect("it was just opened"))
    }
}

/// The part of a file that belongs to a checkpoint.
type Opened = BufReader<io::Take<File>>;

fn opened(path: &Path, extent: Extent) -> io::Result<Opened> {
    Ok(BufReader::new(File::open(path)?.take(extent.bytes)))
}

/// Checks the first bytes of the file.
fn check(path: &Path, extent: Extent) -> Result<()> {
    let damaged = |what: &str| Err(Error::Damaged { path: path.to_owned(), what: what.to_owned() });
    let mut file = opened(path, extent).map_err(Error::system(path, "read"))?;
    let (mut checksum, mut bytes) = (crc32fast::Hasher::new(), 0);
    loop {
        let piece = file.fill_buf().map_err(Error::system(path, "read"))?;
        if piece.is_empty() {
            break;
        }
        if bytes == 0 && !piece.starts_with(FIRST) {
            return damaged("its first line is wrong");
        }
        checksum.update(piece);
        let length = piece.len();
        bytes += length as u64;
        file.consume(length);
    }
    match (bytes == extent.bytes, checksum.finalize() == extent.checksum) {
        (false, _) => damaged("its end is missing"),
        (true, false) => damaged("its checksum is wrong"),
        (true, true) => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The columns that belong to a checkpoint.
    fn read(path: &Path, extent: Extent) -> Result<Vec<Bits>> {
        let mut file = FoundFile::new(path.to_owned());
        file.take_up(extent)?;
        let mut columns: Vec<Bits> = Vec::new();
        let mut add = |rows: Vec<Bits>| {
            columns.resize(rows.len().max(columns.len()), Bits::default());
            columns.iter_mut().zip(rows).for_each(|(column, rows)| column.0.extend(rows.0));
            Ok(())
        };
        file.rows(&mut add)?.unwrap();
        Ok(columns)
    }

    #[test]
    fn what_is_added_is_read_back_and_what_stands_behind_it_forgotten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("found");
        let mut file = FoundFile::new(path.clone());
        let rows = |values: &[&[f64]]| values.iter().map(|column| Bits(column.to_vec())).collect::<Vec<_>>();
        let add = |file: &mut FoundFile, values: &[&[f64]]| {
            file.add(&rows(values), &|| false).unwrap();
            file.extent()
        };
        let first = add(&mut file, &[&[1.0, -0.0], &[]]);
        let second = add(&mut file, &[&[2.0], &[0.1]]);
        assert_eq!(read(&path, first).unwrap(), rows(&[&[1.0, -0.0], &[]]));
        assert_eq!(read(&path, second).unwrap(), rows(&[&[1.0, -0.0, 2.0], &[0.1]]));

        let mut again = FoundFile::new(path.clone());
        again.take_up(first).unwrap();
        let third = add(&mut again, &[&[3.0], &[]]);
        assert_eq!(read(&path, third).unwrap(), rows(&[&[1.0, -0.0, 3.0], &[]]));
        assert!(read(&path, second).is_err(), "rows of a lost checkpoint");
        again.go_back(first);
        let fourth = add(&mut again, &[&[4.0], &[5.0]]);
        assert_eq!(read(&path, fourth).unwrap(), rows(&[&[1.0, -0.0, 4.0], &[5.0]]));
    }

    #[test]
    fn any_byte_that_changes_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("found");
        let mut file = FoundFile::new(path.clone());
        file.add(&[Bits(vec![1.0, 2.0])], &|| false).unwrap();
        let extent = file.extent();
        let bytes = std::fs::read(&path).unwrap();
        for place in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[place] ^= 0x10;
            std::fs::write(&path, &changed).unwrap();
            assert!(matches!(read(&path, extent), Err(Error::Damaged { .. })), "byte {place}");
            std::fs::write(&path, &bytes[..place]).unwrap();
            assert!(matches!(read(&path, extent), Err(Error::Damaged { .. })), "{place} bytes");
        }
    }
}
