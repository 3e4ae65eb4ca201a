//! Numbers in a file without a name, which the system removes when the process ends, however it ends.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Numbers in a file. What was never written is NaN.
#[derive(Debug)]
pub struct NumbersInFile {
    /// Several threads may read it, each from a place of its own.
    file: Mutex<File>,
    length: usize,
}

impl NumbersInFile {
    /// Values that are converted at once.
    const PIECE: usize = 1 << 13;

    /// A file in this folder, with no numbers.
    pub fn within(folder: &Path) -> io::Result<Self> {
        Ok(Self { file: Mutex::new(tempfile::tempfile_in(folder)?), length: 0 })
    }

    fn file(&self) -> MutexGuard<'_, File> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of values.
    pub fn count(&self) -> usize {
        self.length
    }

    /// Adds values at the end.
    pub fn append(&mut self, values: &[f64]) -> io::Result<()> {
        self.put(self.length, values)
    }

    /// Writes values from an index on.
    pub fn put(&mut self, from: usize, values: &[f64]) -> io::Result<()> {
        let mut file = self.file();
        file.seek(place(from))?;
        let mut bytes = Vec::with_capacity(Self::PIECE.min(values.len()) * size_of::<f64>());
        for piece in values.chunks(Self::PIECE) {
            bytes.clear();
            bytes.extend(piece.iter().flat_map(|&value| stored(value)));
            file.write_all(&bytes)?;
        }
        drop(file);
        self.length = self.length.max(from + values.len());
        Ok(())
    }

    /// Makes the file longer, with NaN.
    pub fn extend_to(&mut self, length: usize) -> io::Result<()> {
        self.file().set_len((length * size_of::<f64>()) as u64)?;
        self.length = length;
        Ok(())
    }

    /// Values from an index on, at most `count`.
    ///
    /// # Errors
    /// The system refuses.
    pub fn read(&self, from: usize, count: usize) -> io::Result<Vec<f64>> {
        let count = count.min(self.length - from.min(self.length));
        let mut file = self.file();
        file.seek(place(from))?;
        let mut values = Vec::with_capacity(count);
        let mut bytes = [0; Self::PIECE * size_of::<f64>()];
        let mut left = count * size_of::<f64>();
        while left > 0 {
            let most = left.min(bytes.len());
            let piece = &mut bytes[..most];
            file.read_exact(piece)?;
            let (numbers, _) = piece.as_chunks();
            values.extend(numbers.iter().map(|&number| restored(number)));
            left -= piece.len();
        }
        Ok(values)
    }
}

/// Those of the same file.
impl PartialEq for NumbersInFile {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

/// The place of a value.
fn place(index: usize) -> SeekFrom {
    SeekFrom::Start((index * size_of::<f64>()) as u64)
}

/// The bytes of a value: those of NaN are zeros, as is what was never written into a file.
fn stored(value: f64) -> [u8; 8] {
    (value.to_bits() ^ f64::NAN.to_bits()).to_ne_bytes()
}

fn restored(bytes: [u8; 8]) -> f64 {
    f64::from_bits(u64::from_ne_bytes(bytes) ^ f64::NAN.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_they_were_written_and_others_are_nan() {
        let folder = tempfile::tempdir().unwrap();
        let mut numbers = NumbersInFile::within(folder.path()).unwrap();
        let many: Vec<f64> = (0..20_000).map(|i| f64::from(i) - 0.5).collect();
        numbers.append(&many).unwrap();
        numbers.append(&[-0.0, f64::INFINITY]).unwrap();
        assert_eq!(numbers.read(0, usize::MAX).unwrap()[..20_000], many);
        assert_eq!(
            numbers.read(20_000, 5).unwrap().iter().map(|v| v.to_bits()).collect::<Vec<_>>(),
            [(-0.0_f64).to_bits(), f64::INFINITY.to_bits()]
        );
        numbers.extend_to(30_000).unwrap();
        numbers.put(25_000, &[7.0]).unwrap();
        assert_eq!((numbers.count(), numbers.read(25_000, 1).unwrap()), (30_000, vec![7.0]));
        assert!(numbers.read(24_999, 1).unwrap()[0].is_nan() && numbers.read(29_999, 1).unwrap()[0].is_nan());
        assert!(numbers.read(30_000, 1).unwrap().is_empty());
    }
}
