//! What can go wrong with result files.

use std::path::{Path, PathBuf};

/// The result of reading or writing result files.
pub type Result<T> = std::result::Result<T, Error>;

/// Why result files could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Something else is where the results should go.
    #[error("{path}: {what}; give another folder, or move this one away")]
    Foreign {
        /// Where.
        path: PathBuf,
        /// What is there.
        what: &'static str,
    },
    /// The system refused: permissions, a full disk, …
    #[error("{path}: cannot {action}: {source}")]
    System {
        /// The file or folder.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// What the system said.
        source: std::io::Error,
    },
    /// The results do not fit in one result file.
    #[error(
        "result.nc would need {needed} bytes, more than the {allowed} allowed; ask for fewer points or snapshots"
    )]
    TooLarge {
        /// Bytes it would need.
        needed: u64,
        /// Bytes that are allowed.
        allowed: u64,
    },
    /// A file is not what asperity writes.
    #[error("{path}: {what}")]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The results cannot be put into a NetCDF file.
    #[error("result.nc: {0}")]
    Encoding(#[from] netcdf_writer::Error),
}

impl Error {
    /// For `map_err`: names the file and what was tried with it.
    pub(super) fn system(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::System { path: path.to_owned(), action, source }
    }

    /// For `map_err`: names the file that could not be understood.
    pub(super) fn malformed<E: ToString>(path: &Path) -> impl FnOnce(E) -> Self {
        move |error| Self::Malformed { path: path.to_owned(), what: error.to_string() }
    }
}
