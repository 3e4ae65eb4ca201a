//! Errors of reading and writing result files.

use std::path::{Path, PathBuf};

/// The result of reading or writing result files.
pub type Result<T> = std::result::Result<T, Error>;

/// An error of reading or writing result files.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The destination exists and was not made by asperity.
    #[error("{path}: {what}; give another folder, or move this one away")]
    Foreign {
        /// The path.
        path: PathBuf,
        /// What was found there.
        what: &'static str,
    },
    /// The system refused: permissions, a full disk, …
    #[error("{path}: cannot {action}: {source}")]
    System {
        /// The file or folder.
        path: PathBuf,
        /// The attempted action.
        action: &'static str,
        /// The message of the system.
        source: std::io::Error,
    },
    /// A file was not written by asperity, or is damaged.
    #[error("{path}: {what}")]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The reason.
        what: String,
    },
    /// A file of a later form than this version knows.
    #[error(
        "{path}: its format_version is {found}, written by asperity {version}; this version, {}, reads {} and below: install a later one",
        env!("CARGO_PKG_VERSION"),
        super::FORMAT
    )]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its form.
        found: f64,
        /// The version that wrote it.
        version: String,
    },
    /// The results cannot be put into a NetCDF file.
    #[error("{0}")]
    Encoding(#[from] netcdf_writer::Error),
    /// The file that `netcdf-writer` assembled has no places for values.
    #[error("the assembled file is not of the form in which values can be placed")]
    Unplaced,
}

impl Error {
    /// For `map_err`: adds the file and the attempted action.
    pub(super) fn system(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::System { path: path.to_owned(), action, source }
    }

    /// For `map_err`: adds the file that could not be read.
    pub(super) fn malformed<E: ToString>(path: &Path) -> impl FnOnce(E) -> Self {
        move |error| Self::Malformed { path: path.to_owned(), what: error.to_string() }
    }
}
