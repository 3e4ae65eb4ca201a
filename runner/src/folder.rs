//! The folders above a file that is to be written: made where they are missing, and gone again if nothing came of it.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The folders that were made for something; those that are empty when it is dropped are removed.
#[derive(Debug)]
pub struct Made(Vec<PathBuf>);

/// The folder in which `path` lies.
pub fn above(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

impl Made {
    /// Makes the folder in which `path` lies, and those above it.
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
            // One that is not empty has been of use.
            let _ = fs::remove_dir(folder);
        }
    }
}
