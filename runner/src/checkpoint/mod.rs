//! What a long run has come to, kept on disk so that it can go on after having been stopped, however it was.
//!
//! Beside the folder of results `DIR` there are up to two files, `DIR.checkpoint.0` and `DIR.checkpoint.1`, written in turn:
//! each beside its place, brought to the disk, and only then renamed. So at any moment one of them is whole.

mod difference;
mod error;
mod file;

use std::fs::{self, File};
use std::io::{ErrorKind, Write as _};
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

use asperity::scenario::Scenario;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::input;
pub use error::{Error, Result};
pub use file::Bits;
use file::{Content, Header};

/// Number of files written in turn.
const SLOTS: usize = 2;

/// The checkpoints of a run.
#[derive(Debug)]
pub struct Checkpoints {
    /// The folder of results.
    directory: PathBuf,
    every: Option<NonZeroU64>,
    /// The resolved scenario.
    scenario: String,
    /// Where the next one goes.
    slot: usize,
    resumed: Option<Resumed>,
    damaged: Vec<Error>,
    failure: Option<Error>,
}

/// The checkpoint that a run goes on from.
#[derive(Debug)]
struct Resumed {
    path: PathBuf,
    content: Content,
}

impl Checkpoints {
    /// Those of a run that begins at its start, written every so many events.
    ///
    /// # Errors
    /// There are some already: of a run that was not finished.
    pub fn begin(directory: &Path, scenario: &Scenario, every: Option<NonZeroU64>) -> Result<Self> {
        let checkpoints = Self::new(directory, scenario, every);
        match checkpoints.paths().into_iter().find(|path| path.exists()) {
            Some(path) => Err(Error::Unfinished { path }),
            None => Ok(checkpoints),
        }
    }

    /// Those of a run that goes on from the last good one, or begins at its start where there is none.
    ///
    /// # Errors
    /// Checkpoints that are all damaged, cannot be read, or are of another scenario or version of asperity.
    pub fn resume(directory: &Path, scenario: &Scenario, every: Option<NonZeroU64>) -> Result<Self> {
        let mut checkpoints = Self::new(directory, scenario, every);
        let mut found: Vec<(usize, Resumed)> = Vec::new();
        for (slot, path) in checkpoints.paths().into_iter().enumerate() {
            match file::read(&path) {
                Ok(Some(content)) => found.push((slot, Resumed { path, content })),
                Ok(None) => {}
                Err(error @ Error::Damaged { .. }) => checkpoints.damaged.push(error),
                Err(error) => return Err(error),
            }
        }
        let Some((slot, resumed)) = found.into_iter().max_by_key(|(_, found)| found.content.header.events)
        else {
            return checkpoints.damaged.pop().map_or(Ok(checkpoints), Err);
        };
        difference::refuse(&resumed.path, &resumed.content.header, &checkpoints.scenario)?;
        checkpoints.slot = (slot + 1) % SLOTS;
        checkpoints.resumed = Some(resumed);
        Ok(checkpoints)
    }

    fn new(directory: &Path, scenario: &Scenario, every: Option<NonZeroU64>) -> Self {
        Self {
            directory: directory.to_owned(),
            every,
            scenario: input::to_text(scenario),
            slot: 0,
            resumed: None,
            damaged: Vec::new(),
            failure: None,
        }
    }

    /// The file that the run goes on from, and the number of events there.
    pub fn resumed(&self) -> Option<(&Path, u64)> {
        self.resumed.as_ref().map(|resumed| (resumed.path.as_path(), resumed.content.header.events))
    }

    /// Files that were found damaged, and passed over.
    pub fn damaged(&self) -> &[Error] {
        &self.damaged
    }

    /// Why the run was stopped, if it was for a checkpoint that could not be written or taken up.
    pub fn failure(&mut self) -> Option<Error> {
        self.failure.take()
    }

    /// The last one written, if any is there.
    pub fn last(&self) -> Option<PathBuf> {
        let path = self.path((self.slot + SLOTS - 1) % SLOTS);
        path.exists().then_some(path)
    }

    /// Events from one to the next.
    pub(crate) fn every(&self) -> Option<u64> {
        self.every.map(NonZeroU64::get)
    }

    /// What the run has come to; nothing where it begins at its start.
    ///
    /// # Errors
    /// A stop, [`Checkpoints::failure`] being the reason.
    pub(crate) fn take<T: DeserializeOwned>(&mut self) -> asperity::Result<Option<T>> {
        let Some(Resumed { path, content }) = &mut self.resumed else { return Ok(None) };
        let state = std::mem::take(&mut content.state);
        match ciborium::from_reader(state.as_slice()) {
            Ok(state) => Ok(Some(state)),
            Err(error) => {
                let error = Error::Damaged { path: path.clone(), what: error.to_string() };
                Err(self.stop(error))
            }
        }
    }

    /// Keeps what the run has come to after so many events.
    ///
    /// # Errors
    /// A stop, [`Checkpoints::failure`] being the reason.
    pub(crate) fn keep<T: Serialize>(&mut self, events: u64, state: &T) -> asperity::Result<()> {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let header = Header { version, events, scenario: self.scenario.clone() };
        let written = file::encode(&header, state).and_then(|bytes| self.write(&bytes));
        written.map_err(|error| self.stop(error))?;
        self.slot = (self.slot + 1) % SLOTS;
        Ok(())
    }

    /// Removes the files of a run that is finished.
    ///
    /// # Errors
    /// The system refuses.
    pub fn remove(self) -> Result<()> {
        for path in self.paths().into_iter().chain([self.partial()]) {
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

    fn write(&self, bytes: &[u8]) -> Result<()> {
        let path = self.path(self.slot);
        let partial = self.partial();
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        fs::create_dir_all(folder).map_err(Error::system(folder, "make the folder"))?;
        let mut file = File::create(&partial).map_err(Error::system(&partial, "create"))?;
        // Renamed before it is on the disk, a file may be found empty after the power has failed.
        file.write_all(bytes).and_then(|()| file.sync_all()).map_err(Error::system(&partial, "write"))?;
        fs::rename(&partial, &path).map_err(Error::system(&path, "put in place"))?;
        // Not every system lets a folder be brought to the disk by itself.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
        Ok(())
    }

    fn path(&self, slot: usize) -> PathBuf {
        self.beside(&slot.to_string())
    }

    /// Where the next one is written before it is put in its place.
    fn partial(&self) -> PathBuf {
        self.beside("partial")
    }

    fn beside(&self, what: &str) -> PathBuf {
        let mut name = self.directory.file_name().unwrap_or_default().to_owned();
        name.push(format!(".checkpoint.{what}"));
        self.directory.with_file_name(name)
    }

    fn paths(&self) -> [PathBuf; SLOTS] {
        std::array::from_fn(|slot| self.path(slot))
    }
}
