//! The folder in which cases are stored until all are there: `DIR.sweep-HASH` beside the folder of results `DIR`.
//!
//! The hash is that of all that determines the results, so that cases of another sweep or version are never mixed in. Each file
//! holds several cases and is put in place by a rename: after a kill at any moment, a file is whole or not there. A damaged one
//! counts as not there. Many small files are merged into a larger one, so that their number grows with the logarithm of the
//! number of cases.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::batch::Batch;
use super::case::Case;
use super::error::{Error, Result};
use super::gathered::Gathered;
use crate::checkpoint::Lock;
use crate::folder;

/// The description of a store.
const MANIFEST: &str = "sweep.json";
/// The ending of files of cases.
const CASES: &str = "cases";
/// The ending of files that are being written.
const PARTIAL: &str = "partial";
/// Number of files of one level that are merged into one of the next.
const MERGED: usize = 64;
/// Bytes of files that are merged, at most: they are merged in memory.
const LARGE: u64 = 16 << 20;
/// Age at which a file that is being written belongs to a process that was killed.
const ABANDONED: Duration = Duration::from_secs(600);

/// What identifies a sweep.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity {
    /// The hash of all that determines its results.
    pub hash: String,
    /// The scenario, or what stands in its place.
    pub text: String,
    /// Number of cases.
    pub cases: usize,
}

/// The description of a store, for people and for messages.
#[derive(Debug, Serialize, Deserialize)]
struct Manifest {
    version: String,
    cases: usize,
    scenario: String,
}

/// The stored cases of a sweep.
#[derive(Debug)]
pub struct Store {
    /// The folder of results.
    directory: PathBuf,
    folder: PathBuf,
    identity: Identity,
    /// The files written by this process: those of each level that are not merged yet.
    levels: Vec<Vec<PathBuf>>,
    /// Files that are damaged, and why.
    damaged: Vec<(PathBuf, String)>,
}

impl Store {
    /// The store of a sweep with the folder of results `directory`. Nothing is written yet.
    pub fn new(directory: &Path, identity: Identity) -> Self {
        let folder = beside(directory, &identity.hash);
        Self { directory: directory.to_owned(), folder, identity, levels: Vec::new(), damaged: Vec::new() }
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The damaged files found when cases were last read, which count as not there.
    pub fn damaged(&self) -> &[(PathBuf, String)] {
        &self.damaged
    }

    /// Keeps other processes from computing the same: the whole sweep, or a part of it (`1-of-4`).
    ///
    /// # Errors
    /// Another process does; the system refuses.
    pub fn lock(&self, part: Option<&str>) -> Result<Lock> {
        let name = part.map_or("sweep.lock".to_owned(), |part| format!("sweep-{part}.lock"));
        let mut path = self.directory.file_name().unwrap_or_default().to_owned();
        path.push(format!(".{name}"));
        Ok(Lock::take(&self.directory.with_file_name(path), &self.directory)?)
    }

    /// Stores of other sweeps, or of other versions, for the same folder of results, and what they are, in words.
    pub fn others(&self) -> Vec<(PathBuf, String)> {
        let first = beside(&self.directory, "");
        let first = first.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let entries = fs::read_dir(folder::above(&self.directory)).into_iter().flatten().flatten();
        let paths =
            entries.map(|entry| entry.path()).filter(|path| path.file_name() != self.folder.file_name());
        let named =
            |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(&first));
        paths.filter(named).filter_map(|path| Some((path.clone(), self.other(&path)?))).collect()
    }

    fn other(&self, path: &Path) -> Option<String> {
        let manifest: Manifest = serde_json::from_slice(&fs::read(path.join(MANIFEST)).ok()?).ok()?;
        let own = env!("CARGO_PKG_VERSION");
        Some(match (manifest.version == own, manifest.scenario == self.identity.text) {
            (false, _) => format!("cases of version {}, and this is {own}", manifest.version),
            (true, true) => "cases of the same scenario with other tables".to_owned(),
            (true, false) => "cases of another scenario or of other axes".to_owned(),
        })
    }

    /// Which cases are stored, with or without those that failed.
    ///
    /// # Errors
    /// The system refuses.
    pub fn there(&mut self, with_failures: bool) -> Result<Vec<bool>> {
        let mut there = vec![false; self.identity.cases];
        self.each(|batch| {
            let mut counts = vec![true; batch.cases.len()];
            if !with_failures {
                batch.failures.iter().for_each(|(place, _)| counts[*place as usize] = false);
            }
            for (case, _) in batch.cases.iter().zip(counts).filter(|(_, counts)| *counts) {
                if let Some(there) = usize::try_from(*case).ok().and_then(|case| there.get_mut(case)) {
                    *there = true;
                }
            }
            Ok(())
        })?;
        Ok(there)
    }

    /// Reads all stored cases, with curves on grids of so many `places`. Those are put into files without names beside the folder
    /// of results where they take more than `in_memory` bytes.
    ///
    /// # Errors
    /// The system refuses.
    pub fn gathered(&mut self, places: &[usize], in_memory: u64) -> Result<Gathered> {
        let count = self.identity.cases;
        let bytes: u64 = places.iter().map(|&places| (places * count * size_of::<f64>()) as u64).sum();
        let folder = folder::above(&self.directory).to_owned();
        let failed = Error::system(&folder, "write curves beside the results, in");
        let mut gathered = if bytes <= in_memory {
            Gathered::new(count, places)
        } else {
            Gathered::with_curves_in(&folder, count, places).map_err(failed)?
        };
        let failed = |error| Error::system(&folder, "write curves beside the results, in")(error);
        self.each(|batch| gathered.add(batch).map_err(failed))?;
        Ok(gathered)
    }

    /// Reads the stored cases file by file. Some may come twice, while other processes merge their files.
    fn each(&mut self, mut take: impl FnMut(&Batch) -> Result<()>) -> Result<()> {
        'all: loop {
            self.damaged.clear();
            for path in self.files(CASES)? {
                match fs::read(&path) {
                    Ok(bytes) => match Batch::decode(&bytes) {
                        Ok(batch) => take(&batch)?,
                        Err(what) => self.damaged.push((path, what)),
                    },
                    // A link to nothing.
                    Err(error) if error.kind() == ErrorKind::NotFound && path.is_symlink() => {
                        return Err(Error::system(&path, "read")(error));
                    }
                    // Another process may have merged it; what it holds was written before.
                    Err(error) if error.kind() == ErrorKind::NotFound => continue 'all,
                    Err(error) => return Err(Error::system(&path, "read")(error)),
                }
            }
            return Ok(());
        }
    }

    /// Stores cases.
    ///
    /// # Errors
    /// The system refuses: a full disk, a folder that cannot be written.
    pub fn add(&mut self, cases: &[Case]) -> Result<()> {
        if cases.is_empty() {
            return Ok(());
        }
        self.add_batch(&Batch::new(cases))
    }

    /// Stores the cases of a batch.
    ///
    /// # Errors
    /// As [`Store::add`].
    pub fn add_batch(&mut self, batch: &Batch) -> Result<()> {
        self.begin()?;
        let path = self.put(batch)?;
        self.keep(path, 0)
    }

    /// Makes one file of all, or some large ones, when every case is there.
    ///
    /// # Errors
    /// The system refuses.
    pub fn finish(&mut self) -> Result<()> {
        let files = self.files(CASES)?;
        let mut rest = &files[..];
        while !rest.is_empty() {
            let mut bytes = 0;
            let small = rest.iter().take_while(|path| {
                bytes += length(path);
                bytes <= LARGE
            });
            let (together, others) = rest.split_at(small.count().max(1));
            if together.len() > 1 {
                self.merge(together)?;
            }
            rest = others;
        }
        for path in self.files(PARTIAL)? {
            let age = fs::metadata(&path)
                .and_then(|found| found.modified())
                .ok()
                .and_then(|time| time.elapsed().ok());
            if age.is_some_and(|age| age > ABANDONED) {
                let _ = fs::remove_file(path);
            }
        }
        self.levels.clear();
        Ok(())
    }

    /// Notes that parts are computed, so that a message can name those that are missing.
    ///
    /// # Errors
    /// The system refuses.
    pub fn note_parts(&self, of: usize) -> Result<()> {
        self.begin()?;
        let path = self.folder.join(format!("parts-of-{of}"));
        fs::write(&path, []).map_err(Error::system(&path, "write"))
    }

    /// The error that names what is missing.
    ///
    /// # Errors
    /// The system refuses.
    pub fn missing(&self, there: &[bool]) -> Result<Error> {
        let missing: Vec<usize> = (0..there.len()).filter(|&case| !there[case]).collect();
        let mut of: Vec<usize> = Vec::new();
        if let Ok(entries) = fs::read_dir(&self.folder) {
            let names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
            of.extend(names.filter_map(|name| name.strip_prefix("parts-of-")?.parse::<usize>().ok()));
        }
        let parts = |of: &usize| {
            let mut parts: Vec<usize> = missing.iter().map(|case| case % of + 1).collect();
            parts.sort_unstable();
            parts.dedup();
            (parts.len(), *of, parts)
        };
        // The division of which the largest share of parts is there.
        let best = of.iter().map(parts).min_by(|a, b| (a.0 * b.1).cmp(&(b.0 * a.1)));
        let which = match best {
            Some((_, of, parts)) => format!("parts {} (--part I/{of})", listed(&parts)),
            None => format!("numbers {}", listed(&missing)),
        };
        Ok(Error::Missing {
            path: self.folder.clone(),
            missing: missing.len(),
            all: self.identity.cases,
            which,
        })
    }

    /// Makes the folder, with its description.
    fn begin(&self) -> Result<()> {
        let path = self.folder.join(MANIFEST);
        if path.exists() {
            return Ok(());
        }
        fs::create_dir_all(&self.folder).map_err(Error::system(&self.folder, "make the folder"))?;
        let Identity { text, cases, .. } = &self.identity;
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let manifest = Manifest { version, cases: *cases, scenario: text.clone() };
        let bytes = serde_json::to_vec_pretty(&manifest).expect("plain data");
        self.replace(&path, &bytes)
    }

    /// Puts a file in place; its name is that of its content.
    fn put(&self, batch: &Batch) -> Result<PathBuf> {
        let bytes = batch.encode();
        let (first, count) = (batch.cases.iter().min().unwrap_or(&0), batch.cases.len());
        let path = self.folder.join(format!("{first:07}-{count}-{:08x}.{CASES}", crc32fast::hash(&bytes)));
        self.replace(&path, &bytes).map(|()| path)
    }

    fn replace(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let partial = self.folder.join(format!(".{name}.{}.{PARTIAL}", std::process::id()));
        let written = fs::write(&partial, bytes).map_err(Error::system(&partial, "write"));
        let placed =
            written.and_then(|()| fs::rename(&partial, path).map_err(Error::system(path, "put in place")));
        placed.inspect_err(|_| {
            let _ = fs::remove_file(&partial);
        })
    }

    /// Notes a file of this process, and merges those of a level once they are many.
    fn keep(&mut self, path: PathBuf, level: usize) -> Result<()> {
        self.levels.resize(self.levels.len().max(level + 1), Vec::new());
        if !self.levels[level].contains(&path) {
            self.levels[level].push(path);
        }
        if self.levels[level].len() < MERGED {
            return Ok(());
        }
        let files = std::mem::take(&mut self.levels[level]);
        if files.iter().map(|path| length(path)).sum::<u64>() > LARGE {
            return Ok(());
        }
        let merged = self.merge(&files)?;
        self.keep(merged, level + 1)
    }

    /// One file of several, which are then removed.
    fn merge(&self, files: &[PathBuf]) -> Result<PathBuf> {
        let mut cases: Vec<Case> = Vec::new();
        for path in files {
            let bytes = match fs::read(path) {
                // Another process has merged it.
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                read => read.map_err(Error::system(path, "read"))?,
            };
            if let Ok(batch) = Batch::decode(&bytes) {
                cases.extend(batch.unpacked());
            }
        }
        // Of a case that failed and was computed again, what it kept comes first.
        cases.sort_by_key(|case| (case.number, case.kept.is_err()));
        cases.dedup_by_key(|case| case.number);
        let merged = self.put(&Batch::new(&cases))?;
        for path in files.iter().filter(|path| **path != merged) {
            match fs::remove_file(path) {
                Err(error) if error.kind() != ErrorKind::NotFound => {
                    return Err(Error::system(path, "remove")(error));
                }
                _ => {}
            }
        }
        Ok(merged)
    }

    /// The files of a kind, by name.
    fn files(&self, ending: &str) -> Result<Vec<PathBuf>> {
        let entries = match fs::read_dir(&self.folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(Error::system(&self.folder, "read the folder")(error)),
        };
        let mut paths = Vec::new();
        for entry in entries {
            let path = entry.map_err(Error::system(&self.folder, "read the folder"))?.path();
            if path.extension().is_some_and(|found| found == ending) {
                paths.push(path);
            }
        }
        paths.sort();
        Ok(paths)
    }
}

/// The folder of stored cases with a hash.
fn beside(directory: &Path, hash: &str) -> PathBuf {
    let mut name = directory.file_name().unwrap_or_default().to_owned();
    name.push(format!(".sweep-{hash}"));
    directory.with_file_name(name)
}

/// Bytes of a file; none if it is gone.
fn length(path: &Path) -> u64 {
    fs::metadata(path).map_or(0, |found| found.len())
}

/// Some of the numbers, for a message.
fn listed(numbers: &[usize]) -> String {
    const MOST: usize = 10;
    let some: Vec<_> = numbers.iter().take(MOST).map(ToString::to_string).collect();
    let rest = numbers.len().saturating_sub(MOST);
    if rest == 0 { some.join(", ") } else { format!("{}, … ({rest} more)", some.join(", ")) }
}
