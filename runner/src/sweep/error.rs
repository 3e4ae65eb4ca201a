//! Errors of sweeps.

use std::path::{Path, PathBuf};

use crate::{checkpoint, output};

/// The result of a step of a sweep.
pub type Result<T> = std::result::Result<T, Error>;

/// The reason why a sweep cannot be started, continued or gathered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A new sweep would compute again what is stored.
    #[error("{path}: {stored} of {all} cases are stored; continue with --resume, or remove this folder")]
    Unfinished {
        /// The folder of stored cases.
        path: PathBuf,
        /// Number of stored cases.
        stored: usize,
        /// Number of all.
        all: usize,
    },
    /// Another process computes the same sweep.
    #[error(
        "{path}: another sweep{process} writes to this folder; wait for its end, or choose another folder"
    )]
    Busy {
        /// The folder of results.
        path: PathBuf,
        /// Its process number in brackets after a space, if known.
        process: String,
    },
    /// Cases are missing where all are needed.
    #[error("{path}: {missing} of {all} cases are missing: {which}")]
    Missing {
        /// The folder of stored cases.
        path: PathBuf,
        /// Number of missing cases.
        missing: usize,
        /// Number of all.
        all: usize,
        /// Parts, or numbers of cases, in words.
        which: String,
    },
    /// The monitor stopped the work, or a case cannot be computed.
    #[error("{0}")]
    Stopped(asperity::Error),
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
    /// The results cannot be written.
    #[error(transparent)]
    Output(#[from] output::Error),
}

impl Error {
    /// For `map_err`: adds the file and the attempted action.
    pub(super) fn system(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::System { path: path.to_owned(), action, source }
    }
}

impl From<asperity::Error> for Error {
    fn from(error: asperity::Error) -> Self {
        Self::Stopped(error)
    }
}

impl From<netcdf_writer::Error> for Error {
    fn from(error: netcdf_writer::Error) -> Self {
        Self::Output(error.into())
    }
}

/// Of the lock that checkpoints and sweeps have.
impl From<checkpoint::Error> for Error {
    fn from(error: checkpoint::Error) -> Self {
        match error {
            checkpoint::Error::Busy { path, process } => Self::Busy { path, process },
            checkpoint::Error::System { path, action, source } => Self::System { path, action, source },
            other => {
                Self::System { path: PathBuf::new(), action: "lock", source: std::io::Error::other(other) }
            }
        }
    }
}
