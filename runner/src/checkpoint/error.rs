//! What can go wrong with checkpoints.

use std::path::{Path, PathBuf};

/// The result of reading or writing a checkpoint.
pub type Result<T> = std::result::Result<T, Error>;

/// Why there is no going on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A run that begins anew would overwrite what another has come to.
    #[error("{path}: the checkpoint of an unfinished run; continue it with --resume, or remove it")]
    Unfinished {
        /// The file.
        path: PathBuf,
    },
    /// Another run keeps its checkpoints in the same place.
    #[error(
        "{path}: another run{process} writes checkpoints for this folder; wait for its end, or choose another folder"
    )]
    Busy {
        /// The folder of results.
        path: PathBuf,
        /// The process that runs it, as far as it is known, in brackets after a blank.
        process: String,
    },
    /// The checkpoint belongs to something else.
    #[error("{path}: expected a checkpoint of {expected}, got one of {found}")]
    Another {
        /// The file.
        path: PathBuf,
        /// What would go on from it.
        expected: String,
        /// What it is of.
        found: String,
    },
    /// The file is not as it was written.
    #[error("{path}: a damaged checkpoint: {what}")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
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
}

impl Error {
    /// For `map_err`: names the file and what was tried with it.
    pub(super) fn system(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::System { path: path.to_owned(), action, source }
    }
}
