//! Errors of checkpoints.

use std::path::{Path, PathBuf};

/// The result of reading or writing a checkpoint.
pub type Result<T> = std::result::Result<T, Error>;

/// The reason why a run cannot be started or resumed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A new run would overwrite the checkpoints of another one.
    #[error("{path}: the checkpoint of an unfinished run; continue it with --resume, or remove it")]
    Unfinished {
        /// The file.
        path: PathBuf,
    },
    /// Another run uses the same checkpoints.
    #[error(
        "{path}: another run{process} writes checkpoints for this folder; wait for its end, or choose another folder"
    )]
    Busy {
        /// The folder of results.
        path: PathBuf,
        /// Its process number in brackets after a space, if known.
        process: String,
    },
    /// The checkpoint belongs to another scenario or version.
    #[error("{path}: expected a checkpoint of {expected}, got one of {found}")]
    Another {
        /// The file.
        path: PathBuf,
        /// The expected value.
        expected: String,
        /// The value in the checkpoint.
        found: String,
    },
    /// The file is damaged.
    #[error("{path}: a damaged checkpoint: {what}")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The reason.
        what: String,
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
}

impl Error {
    /// For `map_err`: adds the file and the attempted action.
    pub(super) fn system(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::System { path: path.to_owned(), action, source }
    }
}
