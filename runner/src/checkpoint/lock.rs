//! One run at a time keeps its checkpoints beside a folder.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read as _, Write as _};
use std::path::{Path, PathBuf};

use super::error::{Error, Result};
use crate::folder::Made;

/// A file that is locked while the run lives; the system lets go of it however the run ends.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    /// Whether the system can lock files there; if not, nothing keeps other runs away.
    held: bool,
    _file: File,
    /// Dropped last, when the file is gone.
    _folders: Made,
}

impl Lock {
    /// Locks the file at `path` for the checkpoints beside `directory`.
    ///
    /// # Errors
    /// Another run holds it; the system refuses.
    pub fn take(path: &Path, directory: &Path) -> Result<Self> {
        let folders = Made::above(path).map_err(Error::system(path, "make the folder of"))?;
        loop {
            let mut options = OpenOptions::new();
            let mut file = options
                .read(true)
                .write(true)
                .create(true)
                .truncate(false)
                .open(path)
                .map_err(Error::system(path, "create"))?;
            let held = match file.try_lock() {
                Ok(()) => true,
                Err(TryLockError::WouldBlock) => {
                    return Err(Error::Busy { path: directory.to_owned(), process: process(&mut file) });
                }
                Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => false,
                Err(TryLockError::Error(error)) => return Err(Error::system(path, "lock")(error)),
            };
            // The run that had the file may have removed it between the two calls above.
            if !held || is_there(&file, path) {
                // The number is for the message of other runs alone.
                let _ = file.set_len(0).and_then(|()| write!(file, "{}", std::process::id()));
                return Ok(Self { path: path.to_owned(), held, _file: file, _folders: folders });
            }
        }
    }

    /// Whether no other run can write the same checkpoints.
    pub fn is_held(&self) -> bool {
        self.held
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// The process that wrote its number into the file, if it can be read.
fn process(file: &mut File) -> String {
    let mut number = String::new();
    match file.read_to_string(&mut number) {
        Ok(1..) => format!(" (process {number})"),
        _ => String::new(),
    }
}

/// Whether `path` still is the name of the file.
#[cfg(unix)]
fn is_there(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(open), Ok(named)) => (open.dev(), open.ino()) == (named.dev(), named.ino()),
        _ => false,
    }
}

/// Elsewhere, files that are open cannot be removed.
#[cfg(not(unix))]
fn is_there(_file: &File, _path: &Path) -> bool {
    true
}
