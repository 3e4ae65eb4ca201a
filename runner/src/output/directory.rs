//! A folder that is replaced whole or not at all.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::error::{Error, Result};

/// The file that says: asperity made this folder and may replace it.
const MARKER: &str = ".asperity";

/// Refuses a destination that [`super::write`] would refuse, before any work is done for it.
///
/// # Errors
/// Something that asperity did not make is there, or nothing can be written beside it.
pub fn check(dir: &Path) -> Result<()> {
    let (dir, _) = destination(dir)?;
    Staging::beside(&dir).map(drop)
}

/// Makes `files` (names and contents) the whole content of the folder `dir`.
pub(super) fn replace<'a>(dir: &Path, files: impl Iterator<Item = (&'a str, &'a [u8])>) -> Result<()> {
    let (dir, occupied) = destination(dir)?;
    let staging = Staging::beside(&dir)?;
    staging.store(MARKER, concat!("made by asperity ", env!("CARGO_PKG_VERSION"), "\n").as_bytes())?;
    for (name, bytes) in files {
        staging.store(name, bytes)?;
    }
    if occupied { staging.swap_with(&dir) } else { staging.become_(&dir) }
}

/// The folder itself, links followed, and whether one of ours is already there.
fn destination(dir: &Path) -> Result<(PathBuf, bool)> {
    let foreign = |what| Err(Error::Foreign { path: dir.to_owned(), what });
    match fs::metadata(dir) {
        Ok(found) if !found.is_dir() => foreign("not a folder"),
        Ok(_) if !dir.join(MARKER).is_file() => foreign("a folder that asperity did not make"),
        Ok(_) => Ok((dir.canonicalize().map_err(Error::system(dir, "resolve"))?, true)),
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::system(dir, "look at")(error)),
        Err(_) if dir.is_symlink() => foreign("a link to nothing"),
        Err(_) if dir.file_name().is_none() => foreign("not a name for a folder"),
        Err(_) => Ok((std::path::absolute(dir).map_err(Error::system(dir, "resolve"))?, false)),
    }
}

/// A hidden folder beside the destination, and the parents made for it; gone when dropped.
struct Staging {
    path: PathBuf,
    parents: Vec<PathBuf>,
}

impl Staging {
    fn beside(dir: &Path) -> Result<Self> {
        let parent = dir.parent().unwrap_or(Path::new("/"));
        let name = dir.file_name().unwrap_or_default().to_string_lossy();
        let path = parent.join(format!(".{name}.{}.partial", std::process::id()));
        let missing = parent.ancestors().take_while(|p| !p.exists()).map(Path::to_owned);
        let staging = Self { path, parents: missing.collect() };
        fs::create_dir_all(parent).map_err(Error::system(parent, "make the folder"))?;
        fs::create_dir(&staging.path).map_err(Error::system(&staging.path, "make the folder"))?;
        Ok(staging)
    }

    fn store(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.path.join(name);
        let mut file = File::create_new(&path).map_err(Error::system(&path, "create"))?;
        // a full disk may speak up only when the data are really there
        file.write_all(bytes).and_then(|()| file.sync_all()).map_err(Error::system(&path, "write"))
    }

    fn become_(mut self, dir: &Path) -> Result<()> {
        fs::rename(&self.path, dir).map_err(Error::system(dir, "put the results in place as"))?;
        self.parents.clear();
        Ok(())
    }

    fn swap_with(mut self, dir: &Path) -> Result<()> {
        if exchange(&self.path, dir).is_err() {
            let aside = self.path.with_extension("old");
            fs::rename(dir, &aside).map_err(Error::system(dir, "move aside"))?;
            if let Err(error) = fs::rename(&self.path, dir) {
                let _ = fs::rename(&aside, dir);
                return Err(Error::system(dir, "put the results in place as")(error));
            }
            self.path = aside;
        }
        self.parents.clear();
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
        for parent in &self.parents {
            let _ = fs::remove_dir(parent);
        }
    }
}

/// Lets two folders trade places in one step, where the system can.
#[cfg(target_os = "linux")]
fn exchange(a: &Path, b: &Path) -> std::io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    Ok(renameat_with(CWD, a, CWD, b, RenameFlags::EXCHANGE)?)
}

#[cfg(not(target_os = "linux"))]
fn exchange(_: &Path, _: &Path) -> std::io::Result<()> {
    Err(ErrorKind::Unsupported.into())
}
