//! A folder of results that is replaced as a whole or not at all. Files of others in it are kept.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::thread::{self, ScopedJoinHandle};

use super::error::{Error, Result};
use super::listing::{Listing, Summed};
use crate::folder::Made;

/// The file that marks a folder made by asperity, with the list of its files.
const MARKER: &str = ".asperity";

/// A file in the place of results, which has been renamed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Renamed {
    /// Its old path.
    pub from: PathBuf,
    /// Its new path.
    pub to: PathBuf,
}

/// Writes the content of a file.
type Writer<'a> = Box<dyn Fn(&mut dyn Write) -> io::Result<()> + Sync + 'a>;

/// A file that is to be written.
pub(crate) struct NewFile<'a> {
    /// Its name.
    pub name: String,
    /// Writes its content.
    pub write: Writer<'a>,
    /// Whether it is so large that it is worth a thread of its own.
    pub large: bool,
}

impl<'a> NewFile<'a> {
    /// A file with this content.
    pub(crate) fn of(name: impl Into<String>, content: impl AsRef<[u8]> + Sync + 'a) -> Self {
        Self { name: name.into(), write: Box::new(move |to| to.write_all(content.as_ref())), large: false }
    }
}

/// Refuses, before any work, a destination that [`super::write`] would refuse.
///
/// # Errors
/// A folder or file that asperity did not make; a destination that cannot be written.
pub fn check(dir: &Path) -> Result<()> {
    let (dir, _) = destination(dir)?;
    Staging::beside(&dir).map(drop)
}

/// Makes `files` the results in the folder `dir`. Returns the files of others that were renamed.
pub(super) fn replace(dir: &Path, files: &[NewFile<'_>]) -> Result<Vec<Renamed>> {
    let (dir, _) = destination(dir)?;
    let staging = Staging::beside(&dir)?;
    let mut listing = Listing::default();
    staging.store(files, &mut listing)?;
    // Another run may have created the folder in the meantime.
    let (dir, occupied) = destination(&dir)?;
    if occupied { clear(&staging.swap_with(&dir)?, &dir) } else { staging.become_(&dir).map(|()| Vec::new()) }
}

/// Makes `files` part of the folder of results `dir`. Returns the files of others that were renamed.
pub(super) fn add(dir: &Path, files: &[NewFile<'_>]) -> Result<Vec<Renamed>> {
    let (folder, true) = destination(dir)? else {
        return Err(Error::Foreign { path: dir.to_owned(), what: "not a folder of results" });
    };
    let mut listed = listing(&folder).unwrap_or_default();
    let staging = Staging::beside(&folder)?;
    let mut renamed = Vec::new();
    let before = listed.clone();
    staging.store(files, &mut listed)?;
    for name in files.iter().map(|file| file.name.as_str()) {
        let to = folder.join(name);
        if to.symlink_metadata().is_ok() && !before.is_of_ours(&to) {
            let kept = free_name(&folder, name);
            fs::rename(&to, &kept).map_err(Error::system(&to, "rename"))?;
            renamed.push(Renamed { from: to.clone(), to: kept });
        }
        fs::rename(staging.path.join(name), &to).map_err(Error::system(&to, "put in place"))?;
    }
    // A file that is not listed yet is one of others to the next run, which keeps it.
    let marker = folder.join(MARKER);
    fs::rename(staging.path.join(MARKER), &marker).map_err(Error::system(&marker, "put in place"))?;
    Ok(renamed)
}

/// Whether a folder has nothing in it, so that nothing is lost with it.
fn is_empty(dir: &Path) -> bool {
    fs::read_dir(dir).is_ok_and(|mut entries| entries.next().is_none())
}

/// The folder itself, with links resolved, and whether it is there, empty or one of ours.
fn destination(dir: &Path) -> Result<(PathBuf, bool)> {
    let foreign = |what| Err(Error::Foreign { path: dir.to_owned(), what });
    match fs::metadata(dir) {
        Ok(found) if !found.is_dir() => foreign("not a folder"),
        Ok(_) if is_empty(dir) || listing(dir).is_some() => {
            Ok((dir.canonicalize().map_err(Error::system(dir, "resolve"))?, true))
        }
        Ok(_) if dir.join(MARKER).is_file() => {
            foreign("a folder whose .asperity does not list what asperity wrote")
        }
        Ok(_) => foreign("a folder that asperity did not make"),
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::system(dir, "look at")(error)),
        Err(_) if dir.is_symlink() => foreign("a link to nothing"),
        Err(_) if dir.file_name().is_none() => foreign("not a name for a folder"),
        Err(_) => Ok((std::path::absolute(dir).map_err(Error::system(dir, "resolve"))?, false)),
    }
}

/// The listing of what asperity wrote into a folder of ours.
fn listing(dir: &Path) -> Option<Listing> {
    Listing::read(&fs::read_to_string(dir.join(MARKER)).ok()?)
}

/// Removes the replaced folder `old`: files of asperity are deleted, all others move to `dir`.
fn clear(old: &Path, dir: &Path) -> Result<Vec<Renamed>> {
    let former = listing(old).unwrap_or_default();
    let mut renamed = Vec::new();
    let entries = fs::read_dir(old).and_then(|entries| {
        entries.map(|entry| entry.map(|entry| entry.path())).collect::<io::Result<Vec<_>>>()
    });
    let mut paths = entries.map_err(Error::system(old, "read the folder"))?;
    // A result that was changed does not stay under its name beside other results.
    let is_renamed = |name: &OsStr| former.has(name) || dir.join(name).symlink_metadata().is_ok();
    // Files that keep their names move first, so that a new name cannot collide with one of theirs.
    paths.sort_by_cached_key(|path| is_renamed(path.file_name().unwrap_or_default()));
    for path in paths {
        let name = path.file_name().unwrap_or_default();
        if name == MARKER || former.is_of_ours(&path) {
            fs::remove_file(&path).map_err(Error::system(&path, "remove"))?;
            continue;
        }
        let to = if is_renamed(name) { free_name(dir, &name.to_string_lossy()) } else { dir.join(name) };
        fs::rename(&path, &to).map_err(Error::system(&path, "move back into the folder of results"))?;
        if to.file_name() != Some(name) {
            renamed.push(Renamed { from: dir.join(name), to });
        }
    }
    fs::remove_dir(old).map_err(Error::system(old, "remove"))?;
    Ok(renamed)
}

/// The first free path of `NAME.kept`, `NAME.kept2`, ….
fn free_name(dir: &Path, name: &str) -> PathBuf {
    let number = |i: u64| if i == 1 { String::new() } else { i.to_string() };
    let mut names = (1..).map(|i| dir.join(format!("{name}.kept{}", number(i))));
    names.find(|path| fs::symlink_metadata(path).is_err()).expect("numbers do not end")
}

/// A hidden folder next to the destination, which is removed when dropped.
struct Staging {
    path: PathBuf,
    /// Dropped last, after the folder has been removed.
    _folders: Made,
}

impl Staging {
    /// A killed run with the same process number may have left a folder; the next number is then taken.
    fn beside(dir: &Path) -> Result<Self> {
        let parent = dir.parent().unwrap_or(Path::new("/"));
        let name = dir.file_name().unwrap_or_default().to_string_lossy();
        for number in 0_u64.. {
            let path = parent.join(format!(".{name}.{}-{number}.partial", std::process::id()));
            match Made::before(&path, || fs::create_dir(&path)) {
                Ok(((), folders)) => return Ok(Self { path, _folders: folders }),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(Error::system(&path, "make the folder")(error)),
            }
        }
        unreachable!("numbers do not end")
    }

    /// Writes files, adds them to the listing, and writes the listing; then flushes all of them to the disk, which takes several
    /// together.
    fn store(&self, files: &[NewFile<'_>], listing: &mut Listing) -> Result<()> {
        let mut stored = together(files, |new| new.large, |new| self.write(new))?;
        for (new, file) in files.iter().zip(&stored) {
            listing.add(&new.name, file.size, file.checksum);
        }
        stored.push(self.write(&NewFile::of(MARKER, listing.to_text()))?);
        together(&stored, |file| file.path.file_name() != Some(OsStr::new(MARKER)), Stored::flush).map(drop)
    }

    /// Writes a file.
    fn write(&self, new: &NewFile<'_>) -> Result<Stored> {
        let path = self.path.join(&new.name);
        let file = File::create_new(&path).map_err(Error::system(&path, "create"))?;
        let mut summed = Summed::new(BufWriter::new(file));
        let written = (new.write)(&mut summed);
        let (file, size, checksum) = summed.finish();
        let file = written.and_then(|()| Ok(file.into_inner()?)).map_err(Error::system(&path, "write"))?;
        Ok(Stored { path, file, size, checksum })
    }

    fn become_(self, dir: &Path) -> Result<()> {
        fs::rename(&self.path, dir).map_err(Error::system(dir, "put the results in place as"))
    }

    /// Moves the folder to `dir`. Returns the new path of the old folder.
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

/// A file that has been written.
struct Stored {
    path: PathBuf,
    file: File,
    size: u64,
    /// CRC-32 of its content.
    checksum: u32,
}

impl Stored {
    /// Flushes it to the disk. A full one may be reported only now.
    fn flush(&self) -> Result<()> {
        self.file.sync_all().map_err(Error::system(&self.path, "write"))
    }
}

/// Does `each` with all items: with those that are `apart` on threads of their own, as far as the system has some, with all others
/// on this thread. Every one is waited for, also after an error.
fn together<T: Sync, R: Send>(
    items: &[T],
    apart: impl Fn(&T) -> bool,
    each: impl Fn(&T) -> Result<R> + Sync,
) -> Result<Vec<R>> {
    let each = &each;
    let done: Vec<Result<R>> = thread::scope(|scope| {
        let begin = |item| thread::Builder::new().spawn_scoped(scope, move || each(item)).ok();
        let begun: Vec<_> =
            items.iter().map(|item| (item, apart(item).then(|| begin(item)).flatten())).collect();
        let end = |(item, thread): (&T, Option<ScopedJoinHandle<'_, _>>)| match thread {
            Some(thread) => thread.join().expect("a file is written or refused"),
            None => each(item),
        };
        begun.into_iter().map(end).collect()
    });
    done.into_iter().collect()
}

impl Drop for Staging {
    fn drop(&mut self) {
        if !self.path.as_os_str().is_empty() {
            let _ = fs::remove_dir_all(&self.path);
        }
    }
}

/// Exchanges two folders in one step, if the system can.
#[cfg(target_os = "linux")]
fn exchange(a: &Path, b: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    Ok(renameat_with(CWD, a, CWD, b, RenameFlags::EXCHANGE)?)
}

#[cfg(not(target_os = "linux"))]
fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(ErrorKind::Unsupported.into())
}
