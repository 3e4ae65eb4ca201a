//! A file written in pieces, with their checksum, until the writing is given up.

use std::io::{self, BufWriter, Write};

use crc32fast::Hasher;

/// Bytes of a piece: it is written and counted in a millisecond or so.
const PIECE: usize = 1 << 20;

/// Passes pieces on, and stops as soon as it is asked to.
pub struct Pieces<'a> {
    out: &'a mut dyn Write,
    checksum: Hasher,
    stops: &'a dyn Fn() -> bool,
}

impl<'a> Pieces<'a> {
    /// Pieces for `out`, whose checksum so far is given; `stops` says whether to give up.
    pub fn new(out: &'a mut dyn Write, checksum: Hasher, stops: &'a dyn Fn() -> bool) -> Self {
        Self { out, checksum, stops }
    }

    /// Collects what is written into pieces: numbers are written one by one.
    pub fn buffered(self) -> BufWriter<Self> {
        BufWriter::with_capacity(PIECE, self)
    }

    /// Writes the last piece, and returns the checksum.
    ///
    /// # Errors
    /// The system refuses, or the writing is given up.
    pub fn end(buffer: BufWriter<Self>) -> io::Result<(Hasher, &'a mut dyn Write)> {
        let Self { out, checksum, .. } = buffer.into_inner().map_err(io::IntoInnerError::into_error)?;
        Ok((checksum, out))
    }
}

impl Write for Pieces<'_> {
    fn write(&mut self, piece: &[u8]) -> io::Result<usize> {
        if (self.stops)() {
            // `Interrupted` would be tried again.
            return Err(io::Error::other("the run is to end"));
        }
        let written = self.out.write(&piece[..piece.len().min(PIECE)])?;
        self.checksum.update(&piece[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
