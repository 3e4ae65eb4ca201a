//! Checkpoints of a long run, from which it can be resumed after any interruption.
//!
//! There are up to two files next to the folder of results `DIR`, `DIR.checkpoint.0` and `DIR.checkpoint.1`, written in turn:
//! each under a temporary name, flushed to the disk, and then renamed. So one of them is complete at any time. The recorded
//! columns are in `DIR.checkpoint.found`, to which new rows are appended before each checkpoint is written. The file
//! `DIR.checkpoint.lock` excludes a second run.

mod bits;
mod difference;
mod error;
mod every;
mod file;
mod found;
mod lock;
mod pieces;

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use asperity::scenario::{Figure, Scenario};
use asperity::task::{self, WriteState};

use crate::folder;
use crate::input;
pub use bits::Bits;
pub use error::{Error, Result};
pub use every::Every;
use file::{Content, Header};
use found::FoundFile;
pub use lock::Lock;
use pieces::Pieces;

/// Number of checkpoint files, written in turn.
const SLOTS: usize = 2;

/// The checkpoints of a run.
#[derive(Debug)]
pub struct Checkpoints {
    /// The folder of results.
    directory: PathBuf,
    every: Option<Every>,
    /// The resolved scenario.
    scenario: String,
    /// Number of the last checkpoint.
    number: u64,
    /// Index of the file for the next checkpoint.
    slot: usize,
    /// Time of the last checkpoint.
    written: Instant,
    found: FoundFile,
    resumed: Option<Resumed>,
    damaged: Vec<Error>,
    failure: Option<Error>,
    /// Set from outside when the run is to end.
    interrupted: Arc<AtomicBool>,
    /// Whether a checkpoint was given up, so that the run ends with the one before.
    gave_up: bool,
    lock: Lock,
}

/// The checkpoint from which a run is resumed.
#[derive(Debug)]
struct Resumed {
    path: PathBuf,
    content: Content,
}

impl Checkpoints {
    /// Checkpoints of a new run, written at the interval `every`; without it only when the run is stopped.
    ///
    /// # Errors
    /// Checkpoints exist already, of a run that was not finished or is still running.
    pub fn begin(directory: &Path, scenario: &Scenario, every: Option<Every>) -> Result<Self> {
        let checkpoints = Self::new(directory, scenario, every)?;
        match checkpoints.paths().into_iter().find(|path| path.exists()) {
            Some(path) => Err(Error::Unfinished { path }),
            None => Ok(checkpoints),
        }
    }

    /// Checkpoints of a run that is resumed from the last valid one, or begins at its start if there is none.
    ///
    /// # Errors
    /// Checkpoints that are all damaged, cannot be read, or belong to another scenario or version of asperity; a run that is
    /// still active.
    pub fn resume(directory: &Path, scenario: &Scenario, every: Option<Every>) -> Result<Self> {
        let mut checkpoints = Self::new(directory, scenario, every)?;
        let mut kept = checkpoints.kept()?;
        // The last one first.
        kept.sort_by_key(|(_, _, content)| std::cmp::Reverse(content.header.number));
        for (slot, path, content) in kept {
            difference::refuse(&path, &content.header, &checkpoints.scenario)?;
            match checkpoints.found.take_up(content.header.found) {
                Ok(()) => {
                    checkpoints.number = content.header.number;
                    checkpoints.slot = (slot + 1) % SLOTS;
                    checkpoints.resumed = Some(Resumed { path, content });
                    return Ok(checkpoints);
                }
                Err(error) => checkpoints.damaged.push(error),
            }
        }
        checkpoints.damaged.pop().map_or(Ok(checkpoints), Err)
    }

    /// The valid files, with their indices.
    fn kept(&mut self) -> Result<Vec<(usize, PathBuf, Content)>> {
        let mut kept = Vec::new();
        for (slot, path) in self.paths().into_iter().enumerate() {
            match file::read(&path) {
                Ok(Some(content)) => kept.push((slot, path, content)),
                Ok(None) => {}
                Err(error @ Error::Damaged { .. }) => self.damaged.push(error),
                Err(error) => return Err(error),
            }
        }
        Ok(kept)
    }

    fn new(directory: &Path, scenario: &Scenario, every: Option<Every>) -> Result<Self> {
        Ok(Self {
            directory: directory.to_owned(),
            every,
            // Pictures change no result.
            scenario: input::to_text(&Scenario { figure: Figure::default(), ..scenario.clone() }),
            number: 0,
            slot: 0,
            written: Instant::now(),
            found: FoundFile::new(beside(directory, "found")),
            resumed: None,
            damaged: Vec::new(),
            failure: None,
            interrupted: Arc::default(),
            gave_up: false,
            lock: Lock::take(&beside(directory, "lock"), directory)?,
        })
    }

    /// The same, which give up a checkpoint that is being written when `interrupted` is set, if there is one before it: to
    /// write some gigabytes takes seconds. One that is begun after it was set is completed.
    pub fn interrupted_by(self, interrupted: Arc<AtomicBool>) -> Self {
        Self { interrupted, ..self }
    }

    /// The file from which the run is resumed, and the number of events there.
    pub fn resumed(&self) -> Option<(&Path, u64)> {
        self.resumed.as_ref().map(|resumed| (resumed.path.as_path(), resumed.content.header.events))
    }

    /// Damaged files, which are ignored.
    pub fn damaged(&self) -> &[Error] {
        &self.damaged
    }

    /// The error that stopped the run, if a checkpoint could not be written or read.
    pub fn failure(&mut self) -> Option<Error> {
        self.failure.take()
    }

    /// Path of the last checkpoint, if there is one.
    pub fn last(&self) -> Option<PathBuf> {
        let path = self.path((self.slot + SLOTS - 1) % SLOTS);
        path.exists().then_some(path)
    }

    /// Removes the files of a finished run.
    ///
    /// # Errors
    /// The system refuses.
    pub fn remove(self) -> Result<()> {
        self.remove_partial();
        for path in self.paths().into_iter().chain([beside(&self.directory, "found")]) {
            match fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => {
                    return Err(Error::system(&path, "remove")(error));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn stop(&mut self, error: Error) -> asperity::Error {
        self.failure = Some(error);
        asperity::Error::Stopped
    }

    fn write(
        &mut self,
        events: u64,
        (state, rows): (&WriteState<'_>, &[Bits]),
        stops: &dyn Fn() -> bool,
    ) -> Result<()> {
        let before = self.found.extent();
        let written = self.found.add(rows, stops).and_then(|()| {
            let (version, scenario) = (env!("CARGO_PKG_VERSION").to_owned(), self.scenario.clone());
            let (number, found) = (self.number + 1, self.found.extent());
            self.put(&Header { version, number, events, found, scenario }, state, stops)
        });
        // Otherwise rows without a checkpoint would be there twice after the next one.
        written.inspect_err(|_| self.found.go_back(before))
    }

    /// Moves a checkpoint into its place.
    fn put(&self, header: &Header, state: &WriteState<'_>, stops: &dyn Fn() -> bool) -> Result<()> {
        let path = self.path(self.slot);
        // Without locks, other runs may write there, too.
        let partial = beside(&self.directory, &format!("{}.partial", std::process::id()));
        let folder = folder::above(&path);
        let mut file = File::create(&partial).map_err(Error::system(&partial, "create"))?;
        let pieces = Pieces::new(&mut file, crc32fast::Hasher::new(), stops);
        // If it were renamed before it is flushed, the file might be empty after a power failure.
        let written = file::write(header, state, pieces).and_then(|()| file.sync_all());
        if let Err(error) = written {
            let _ = fs::remove_file(&partial);
            return Err(Error::system(&partial, "write")(error));
        }
        fs::rename(&partial, &path).map_err(Error::system(&path, "put in place"))?;
        // Some systems cannot flush a folder.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
        Ok(())
    }

    /// Removes temporary files of killed runs, if no other run can be writing one.
    fn remove_partial(&self) {
        let first = beside(&self.directory, "");
        let first = first.file_name().unwrap_or_default().to_string_lossy();
        let Ok(entries) = fs::read_dir(folder::above(&self.directory)) else { return };
        for entry in entries.flatten().filter(|_| self.lock.is_held()) {
            let name = entry.file_name();
            let middle = name.to_str().and_then(|name| name.strip_prefix(&*first)?.strip_suffix(".partial"));
            if middle.is_some_and(|process| process.bytes().all(|byte| byte.is_ascii_digit())) {
                let _ = fs::remove_file(entry.path());
            }
        }
    }

    fn path(&self, slot: usize) -> PathBuf {
        beside(&self.directory, &slot.to_string())
    }

    fn paths(&self) -> [PathBuf; SLOTS] {
        std::array::from_fn(|slot| self.path(slot))
    }
}

/// [`Checkpoints::failure`] has the reason of a stop.
impl task::Checkpoints for Checkpoints {
    fn events_left(&self, since: u64) -> u64 {
        match self.every {
            Some(Every::Events(every)) => every.get().saturating_sub(since),
            Some(Every::Time(every)) if self.written.elapsed() >= every => 0,
            Some(Every::Time(_)) | None => u64::MAX,
        }
    }

    fn take(
        &mut self,
        rows: &mut dyn FnMut(Vec<Vec<f64>>) -> asperity::Result<()>,
    ) -> asperity::Result<Option<Vec<u8>>> {
        let Some(Resumed { content, .. }) = &mut self.resumed else { return Ok(None) };
        let state = std::mem::take(&mut content.state);
        let mut pass = |columns: Vec<Bits>| rows(columns.into_iter().map(|Bits(values)| values).collect());
        self.found.rows(&mut pass).map_err(|error| self.stop(error))??;
        Ok(Some(state))
    }

    fn keep(&mut self, events: u64, state: &WriteState<'_>, rows: Vec<Vec<f64>>) -> asperity::Result<()> {
        if self.gave_up {
            return Ok(());
        }
        let rows: Vec<Bits> = rows.into_iter().map(Bits).collect();
        let interrupted = self.interrupted.clone();
        let may_stop = self.last().is_some() && !interrupted.load(Ordering::Relaxed);
        let stops = || may_stop && interrupted.load(Ordering::Relaxed);
        if let Err(error) = self.write(events, (state, &rows), &stops) {
            self.gave_up = stops();
            return Err(if self.gave_up { asperity::Error::Stopped } else { self.stop(error) });
        }
        self.number += 1;
        self.slot = (self.slot + 1) % SLOTS;
        self.written = Instant::now();
        Ok(())
    }

    fn damaged(&mut self, what: String) -> asperity::Error {
        let path =
            self.resumed.as_ref().map_or_else(|| self.directory.clone(), |resumed| resumed.path.clone());
        self.stop(Error::Damaged { path, what })
    }
}

/// The checkpoint file `what` of a folder of results.
fn beside(directory: &Path, what: &str) -> PathBuf {
    let mut name = directory.file_name().unwrap_or_default().to_owned();
    name.push(format!(".checkpoint.{what}"));
    directory.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use std::io;

    use asperity::task::Checkpoints as _;

    use super::*;

    const SCENARIO: &str = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\npull = {}\n";

    /// A state of some pieces, in the middle of which the run is interrupted.
    fn interrupting(interrupted: &AtomicBool) -> impl Fn(&mut dyn io::Write) -> io::Result<()> {
        |out| {
            out.write_all(&[1; 3 << 20])?;
            interrupted.store(true, Ordering::Relaxed);
            out.write_all(&[2; 3 << 20])
        }
    }

    #[test]
    fn an_interrupted_checkpoint_leaves_the_one_before_and_the_first_is_completed() {
        let folder = tempfile::tempdir().unwrap();
        let directory = folder.path().join("run");
        let scenario = input::parse(SCENARIO, "scenario", folder.path(), &[]).unwrap().scenario;
        let interrupted = Arc::new(AtomicBool::new(false));
        let kept = || {
            let paths = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
            let mut kept: Vec<_> = paths.map(|path| (path.clone(), fs::read(path).unwrap())).collect();
            kept.sort();
            kept
        };
        let mut checkpoints =
            Checkpoints::begin(&directory, &scenario, None).unwrap().interrupted_by(interrupted.clone());
        checkpoints.keep(7, &interrupting(&interrupted), vec![vec![0.5]]).unwrap();
        let first = kept();
        interrupted.store(false, Ordering::Relaxed);
        let second = checkpoints.keep(8, &interrupting(&interrupted), vec![vec![0.25]]);
        assert!(matches!(second, Err(asperity::Error::Stopped)), "{second:?}");
        // What the run writes when it ends.
        checkpoints.keep(8, &|out| out.write_all(&[3]), vec![vec![0.25]]).unwrap();
        assert!(checkpoints.failure().is_none());
        let names = |kept: &[(PathBuf, Vec<u8>)]| kept.iter().map(|file| file.0.clone()).collect::<Vec<_>>();
        assert_eq!(names(&kept()), names(&first));
        assert_eq!(checkpoints.last(), Some(checkpoints.path(0)));
        drop(checkpoints);
        let mut resumed = Checkpoints::resume(&directory, &scenario, None).unwrap();
        assert_eq!(resumed.resumed().unwrap().1, 7);
        let mut rows = Vec::new();
        let mut add = |columns: Vec<_>| {
            rows.extend(columns);
            Ok(())
        };
        let state = resumed.take(&mut add).unwrap().unwrap();
        assert_eq!(state.len(), 6 << 20);
        assert_eq!(rows, [[0.5]]);
    }
}
