//! A folder of results that is replaced whole or not at all, with what others put there left in it.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::error::{Error, Result};
use super::listing::Listing;
use crate::folder::Made;

/// The file that says: asperity made this folder, and these files in it.
const MARKER: &str = ".asperity";

/// A file that was in the way of results, and how it is called now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Renamed {
    /// Where it was.
    pub from: PathBuf,
    /// Where it is.
    pub to: PathBuf,
}

/// Refuses a destination that [`super::write`] would refuse, before any work is done for it.
///
/// # Errors
/// Something that asperity did not make is there, or nothing can be written beside it.
pub fn check(dir: &Path) -> Result<()> {
    let (dir, _) = destination(dir)?;
    Staging::beside(&dir).map(drop)
}

/// Makes `files` (names and contents) the results in the folder `dir`; files of others that had to make way.
pub(super) fn replace<'a>(
    dir: &Path,
    files: impl Iterator<Item = (&'a str, &'a [u8])>,
) -> Result<Vec<Renamed>> {
    let (dir, _) = destination(dir)?;
    let staging = Staging::beside(&dir)?;
    let mut listing = Listing::default();
    for (name, bytes) in files {
        listing.add(name, bytes);
        staging.store(name, bytes)?;
    }
    staging.store(MARKER, listing.to_text().as_bytes())?;
    // Another run may have come first.
    let (dir, occupied) = destination(&dir)?;
    if occupied { clear(&staging.swap_with(&dir)?, &dir) } else { staging.become_(&dir).map(|()| Vec::new()) }
}

/// The folder itself, links followed, and whether one of ours is already there.
fn destination(dir: &Path) -> Result<(PathBuf, bool)> {
    let foreign = |what| Err(Error::Foreign { path: dir.to_owned(), what });
    match fs::metadata(dir) {
        Ok(found) if !found.is_dir() => foreign("not a folder"),
        Ok(_) if !dir.join(MARKER).is_file() => foreign("a folder that asperity did not make"),
        Ok(_) if listing(dir).is_none() => {
            foreign("a folder whose .asperity does not list what asperity wrote")
        }
        Ok(_) => Ok((dir.canonicalize().map_err(Error::system(dir, "resolve"))?, true)),
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::system(dir, "look at")(error)),
        Err(_) if dir.is_symlink() => foreign("a link to nothing"),
        Err(_) if dir.file_name().is_none() => foreign("not a name for a folder"),
        Err(_) => Ok((std::path::absolute(dir).map_err(Error::system(dir, "resolve"))?, false)),
    }
}

/// What asperity wrote into a folder of ours.
fn listing(dir: &Path) -> Option<Listing> {
    Listing::read(&fs::read_to_string(dir.join(MARKER)).ok()?)
}

/// Removes the folder `old`, in whose place `dir` is now: what asperity wrote is deleted, all else moves to `dir`.
fn clear(old: &Path, dir: &Path) -> Result<Vec<Renamed>> {
    let former = listing(old).unwrap_or_default();
    let mut renamed = Vec::new();
    let entries = fs::read_dir(old).and_then(|entries| {
        entries.map(|entry| entry.map(|entry| entry.path())).collect::<std::io::Result<Vec<_>>>()
    });
    let mut paths = entries.map_err(Error::system(old, "read the folder"))?;
    // Files that keep their names go first: a new name is not to be one of theirs.
    let is_taken = |path: &PathBuf| dir.join(path.file_name().unwrap_or_default()).symlink_metadata().is_ok();
    paths.sort_by_cached_key(is_taken);
    for path in paths {
        let name = path.file_name().unwrap_or_default();
        if name == MARKER || former.is_of_ours(&path) {
            fs::remove_file(&path).map_err(Error::system(&path, "remove"))?;
            continue;
        }
        let to = free_name(dir, &name.to_string_lossy(), dir.join(name));
        fs::rename(&path, &to).map_err(Error::system(&path, "move back into the folder of results"))?;
        if to.file_name() != Some(name) {
            renamed.push(Renamed { from: dir.join(name), to });
        }
    }
    fs::remove_dir(old).map_err(Error::system(old, "remove"))?;
    Ok(renamed)
}

/// `wanted` if nothing is there, or else the first of `NAME.kept`, `NAME.kept2`, … that is free.
fn free_name(dir: &Path, name: &str, wanted: PathBuf) -> PathBuf {
    let others = (1_u64..)
        .map(|i| dir.join(format!("{name}.kept{}", if i == 1 { String::new() } else { i.to_string() })));
    let is_free = |path: &PathBuf| fs::symlink_metadata(path).is_err();
    std::iter::once(wanted).chain(others).find(is_free).expect("numbers do not end")
}

/// A hidden folder beside the destination; gone when dropped.
struct Staging {
    path: PathBuf,
    /// Dropped last, when the folder is gone.
    _folders: Made,
}

impl Staging {
    /// Another number where a run that was killed, of the same process number, has left a folder.
    fn beside(dir: &Path) -> Result<Self> {
        let parent = dir.parent().unwrap_or(Path::new("/"));
        let folders = Made::above(dir).map_err(Error::system(parent, "make the folder"))?;
        let name = dir.file_name().unwrap_or_default().to_string_lossy();
        for number in 0_u64.. {
            let path = parent.join(format!(".{name}.{}-{number}.partial", std::process::id()));
            match fs::create_dir(&path) {
                Ok(()) => return Ok(Self { path, _folders: folders }),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(Error::system(&path, "make the folder")(error)),
            }
        }
        unreachable!("numbers do not end")
    }

    fn store(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.path.join(name);
        let mut file = File::create_new(&path).map_err(Error::system(&path, "create"))?;
        // a full disk may speak up only when the data are really there
        file.write_all(bytes).and_then(|()| file.sync_all()).map_err(Error::system(&path, "write"))
    }

    fn become_(self, dir: &Path) -> Result<()> {
        fs::rename(&self.path, dir).map_err(Error::system(dir, "put the results in place as"))
    }

    /// Puts the folder in the place of `dir`; where that one is now.
    fn swap_with(mut self, dir: &Path) -> Result<PathBuf> {
        let mut old = std::mem::take(&mut self.path);
        if exchange(&old, dir).is_err() {
            let aside = old.with_extension("old");
            let moved = fs::rename(dir, &aside).map_err(Error::system(dir, "move aside")).and_then(|()| {
                fs::rename(&old, dir).map_err(|error| {
                    let _ = fs::rename(&aside, dir);
                    Error::system(dir, "put the results in place as")(error)
                })
            });
            if let Err(error) = moved {
                self.path = old;
                return Err(error);
            }
            old = aside;
        }
        Ok(old)
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        if !self.path.as_os_str().is_empty() {
            let _ = fs::remove_dir_all(&self.path);
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
