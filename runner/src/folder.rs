//! The folders above a file that will be written: created if missing, and removed again if they stay empty.

use std::fs;
use std::io::{self, ErrorKind};
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

    /// Creates the parent folder of `path`, and what `create` makes in it. Other processes that have made the folder, too, may
    /// remove it in between.
    pub fn before<T>(path: &Path, create: impl Fn() -> io::Result<T>) -> io::Result<(T, Self)> {
        const TIMES: usize = 100;
        let mut last = io::Error::from(ErrorKind::NotFound);
        for _ in 0..TIMES {
            let made = match Self::above(path) {
                Ok(made) => made,
                // What was there when it was made is gone when it is looked at.
                Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::AlreadyExists) => {
                    last = error;
                    continue;
                }
                Err(error) => return Err(error),
            };
            match create() {
                Err(error) if error.kind() == ErrorKind::NotFound => last = error,
                created => return created.map(|created| (created, made)),
            }
        }
        Err(last)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_others_remove_in_between_is_made_again() {
        let folder = tempfile::tempdir().unwrap();
        let parent = folder.path().join("parent");
        std::thread::scope(|scope| {
            for number in 0..4 {
                let path = parent.join(number.to_string());
                scope.spawn(move || {
                    for _ in 0..2000 {
                        let (file, _made) = Made::before(&path, || fs::File::create(&path)).unwrap();
                        drop(file);
                        fs::remove_file(&path).unwrap();
                    }
                });
            }
        });
    }
}
