//! A lock that lets one run at a time write the checkpoints of a folder.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read as _, Write as _};
use std::path::{Path, PathBuf};

use super::error::{Error, Result};
use crate::folder::Made;

/// A file that is locked while the run lives. The system releases it however the run ends.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    /// Whether the file system supports locks; otherwise nothing excludes other runs.
    held: bool,
    _file: File,
    /// Dropped last, after the file has been removed.
    _folders: Made,
}

impl Lock {
    /// Locks the file at `path` for the checkpoints beside `directory`.
    ///
    /// # Errors
    /// Another run holds the lock; the system refuses.
    pub fn take(path: &Path, directory: &Path) -> Result<Self> {
        loop {
            let mut options = OpenOptions::new();
            options.read(true).write(true).create(true).truncate(false);
            let (mut file, folders) =
                Made::before(path, || options.open(path)).map_err(Error::system(path, "create"))?;
            let held = match file.try_lock() {
                Ok(()) => true,
                Err(TryLockError::WouldBlock) => {
                    return Err(Error::Busy { path: directory.to_owned(), process: process(&mut file) });
                }
                Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => false,
                Err(TryLockError::Error(error)) => return Err(Error::system(path, "lock")(error)),
            };
            // The previous owner may have removed the file between the two calls above.
            if !held || is_there(&file, path) {
                // The process number is used only in the message of other runs.
                let _ = file.set_len(0).and_then(|()| write!(file, "{}", std::process::id()));
                return Ok(Self { path: path.to_owned(), held, _file: file, _folders: folders });
            }
        }
    }

    /// Whether other runs are excluded.
    pub fn is_held(&self) -> bool {
        self.held
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// The process number in the file, if it can be read.
fn process(file: &mut File) -> String {
    let mut number = String::new();
    match file.read_to_string(&mut number) {
        Ok(1..) => format!(" (process {number})"),
        _ => String::new(),
    }
}

/// Whether `path` is still the name of the file.
#[cfg(unix)]
fn is_there(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(open), Ok(named)) => (open.dev(), open.ino()) == (named.dev(), named.ino()),
        _ => false,
    }
}

/// Other systems do not allow the removal of open files.
#[cfg(not(unix))]
fn is_there(_file: &File, _path: &Path) -> bool {
    true
}
