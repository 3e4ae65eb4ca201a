//! The folders above a file that will be written: created if missing, and removed again if they stay empty.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Created folders. Those that are empty when this is dropped are removed.
#[derive(Debug)]
pub struct Made(Vec<PathBuf>);

/// The parent folder of `path`.
pub fn above(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

impl Made {
    /// Creates the parent folder of `path`, and those above it.
    pub fn above(path: &Path) -> io::Result<Self> {
        let parent = above(path);
        let missing = parent.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists());
        let made = Self(missing.map(Path::to_owned).collect());
        fs::create_dir_all(parent).map(|()| made)
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        for folder in &self.0 {
            // A folder that is not empty is kept.
            let _ = fs::remove_dir(folder);
        }
    }
}
