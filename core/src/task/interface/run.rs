//! A drive from event to event, with output points and checkpoints.

use std::time::Duration;

use crate::monitor::Monitor;
use crate::record::Record;
use crate::{Error, Result, cbor};
use serde::{Deserialize, Serialize};

use super::found::{CellColumns, Found};
use super::model::DrivenInterface;
use super::output_points::OutputPoint;
use crate::monitor::{Part, report};
use crate::task::{Checkpoints, Storage, write_cbor};

/// Largest number of events between two calls of the monitor.
const SLICE: u64 = 256;
/// Approximate time between two calls of the monitor, which limits the time until a run stops.
const CALL: Duration = Duration::from_millis(50);

/// An interface that is driven, with the columns recorded so far.
pub struct InterfaceRun<'a, M> {
    model: M,
    /// Events so far, including those that are not recorded.
    count: u64,
    /// Events that are recorded.
    recorded: usize,
    /// Output points passed so far.
    passed: usize,
    found: Found<'a>,
    /// Drive from which events are recorded.
    from: f64,
    /// Whether cells that took part in events are recorded.
    chain: bool,
    checkpoints: Option<&'a mut dyn Checkpoints>,
    /// Events at the last checkpoint.
    last: u64,
    /// Rows of each column at the last checkpoint.
    kept: Vec<usize>,
    /// Events until the next call of the monitor.
    slice: u64,
}

/// The content of a checkpoint in addition to the columns.
#[derive(Serialize, Deserialize)]
struct RunState<S> {
    state: S,
    count: u64,
    passed: usize,
}

impl<'a, M: DrivenInterface> InterfaceRun<'a, M> {
    /// A run of a new `model`, resumed from the checkpoint if there is one. Events are recorded from the drive `from`, with
    /// the cells that took part in them if it is a `chain`.
    pub fn new(
        model: M,
        (from, chain): (f64, bool),
        described: CellColumns<'a>,
        storage: Storage<'a>,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let Storage { checkpoints, columns } = storage;
        let mut found = Found::empty(&model, described, columns);
        let kept = vec![0; found.columns().count()];
        let (count, recorded, passed, last) = (0, 0, 0, 0);
        let mut run =
            Self { model, count, recorded, passed, found, from, chain, checkpoints, last, kept, slice: 1 };
        // The columns of a checkpoint hold what was recorded up to it, so that a resumed run has
        // the same file as one that was never stopped.
        if let Some(state) = run.take()? {
            run.resume(&state, monitor)?;
        }
        Ok(run)
    }

    /// The rows of the checkpoint, and its state, if there is one.
    fn take(&mut self) -> Result<Option<Vec<u8>>> {
        let Self { checkpoints: Some(checkpoints), found, recorded, .. } = self else { return Ok(None) };
        checkpoints.take(&mut |rows| {
            // The first column is one of events.
            *recorded += rows.first().map_or(0, Vec::len);
            found.add(rows)
        })
    }

    fn resume(&mut self, state: &[u8], monitor: &mut dyn Monitor) -> Result<()> {
        let RunState { state, count, passed } = match cbor::read(state) {
            Ok(kept) => kept,
            Err(error) => {
                return Err(self.checkpoints.as_mut().map_or(Error::Stopped, |kept| kept.damaged(error)));
            }
        };
        self.model.restore(state, monitor)?;
        (self.count, self.last, self.passed) = (count, count, passed);
        self.kept = self.found.columns().map(|column| column.len()).collect();
        Ok(())
    }

    /// Drives to one output point after the other.
    pub fn follow(&mut self, output_points: &[OutputPoint], monitor: &mut dyn Monitor) -> Result<()> {
        let end = output_points.last().map_or(0.0, OutputPoint::progress);
        let begin = output_points.first().map_or(0.0, OutputPoint::progress);
        for output in &output_points[self.passed..] {
            match self.reach(output.progress(), (begin, end), monitor) {
                // A stopped run stores its state; if that fails, its error replaces the stop.
                Err(Error::Stopped) => return self.keep().and(Err(Error::Stopped)),
                reached => reached?,
            }
            self.observe(output)?;
        }
        Ok(())
    }

    /// The recorded columns of a run that is over.
    pub fn finish(mut self) -> Result<Found<'a>> {
        let last = self.model.last_events();
        self.record(&last)?;
        self.found.unfinished = self.model.unfinished_events();
        if self.found.stored {
            self.found.put_into_store()?;
        }
        self.found.error = self.model.error();
        self.found.slip_rates = self.model.slip_rates().cloned();
        Ok(self.found)
    }

    fn observe(&mut self, output: &OutputPoint) -> Result<()> {
        if output.point {
            let trace = self.found.trace.iter_mut().zip(self.model.trace());
            trace.for_each(|(column, now)| column.push(now));
        }
        if output.map {
            let maps = self.found.maps.iter_mut().zip(self.model.maps());
            maps.for_each(|(column, now)| column.extend(now));
        }
        self.passed += 1;
        self.store()
    }

    /// Drives to `next`, the drive or the time of the next output point. The whole drive goes from `begin` to `end`.
    fn reach(&mut self, next: f64, (begin, end): (f64, f64), monitor: &mut dyn Monitor) -> Result<()> {
        loop {
            let most = self.slice.min(self.events_left()).max(1);
            let now = self.model.progress();
            monitor.events(self.count, self.model.drive());
            let done = |place: f64| {
                if end > begin { ((place - begin) / (end - begin)).clamp(0.0, 1.0) } else { 0.0 }
            };
            report(monitor, done(now))?;
            let began = monitor.clock();
            let mut part = Part::new(monitor, done(now), (done(next) - done(now)).max(0.0));
            let mut slice = Vec::new();
            let reached = self.model.advance(next, most, &mut part, &mut |event| slice.push(event));
            self.slice = next_slice(self.slice, monitor.clock().saturating_sub(began));
            // Events before a stop by the monitor count, too: the result of `advance` is checked after they
            // have been recorded.
            self.record(&slice)?;
            if self.events_left() == 0 {
                self.keep()?;
            }
            if reached? {
                return Ok(());
            }
        }
    }

    /// Events left until the next checkpoint.
    fn events_left(&self) -> u64 {
        self.checkpoints
            .as_ref()
            .map_or(u64::MAX, |checkpoints| checkpoints.events_left(self.count - self.last))
    }

    /// Adds events to those recorded.
    fn record(&mut self, events: &[M::Event]) -> Result<()> {
        self.count += events.len() as u64;
        let added = self.model.columns(events);
        let drives = added.values("drive").unwrap_or_default();
        let first = drives.partition_point(|&drive| drive < self.from);
        if self.chain {
            let slipped = self.model.slipped(&events[first..], self.recorded + 1);
            append(&mut self.found.slipped, &slipped, 0);
        }
        append(&mut self.found.events, &added, first);
        self.recorded += drives.len() - first;
        self.store()
    }

    /// Puts columns that outgrow the memory into the store.
    fn store(&mut self) -> Result<()> {
        if !self.found.outgrow_memory() {
            return Ok(());
        }
        // A checkpoint has all rows up to it.
        self.keep()?;
        self.found.put_into_store()?;
        self.kept = self.found.columns().map(|column| column.len()).collect();
        Ok(())
    }

    /// Writes a checkpoint, if checkpoints are kept.
    fn keep(&mut self) -> Result<()> {
        let Some(checkpoints) = &mut self.checkpoints else { return Ok(()) };
        // Only the rows since the last checkpoint are written, so that every number is written once.
        let added = self.found.columns().zip(&self.kept);
        let rows = added.map(|(column, &kept)| column[kept..].to_vec()).collect();
        let kept = RunState { state: self.model.state(), count: self.count, passed: self.passed };
        checkpoints.keep(self.count, &|out| write_cbor(&kept, out), rows)?;
        self.last = self.count;
        self.kept = self.found.columns().map(|column| column.len()).collect();
        Ok(())
    }
}

/// Number of events of the next slice, after a slice of `slice` events that took this time. Results do not depend on it.
fn next_slice(slice: u64, took: Duration) -> u64 {
    if took < CALL { (2 * slice).min(SLICE) } else { (slice / 2).max(1) }
}

/// Appends the values of `added` from the index `first`, column by column.
fn append(record: &mut Record, added: &Record, first: usize) {
    for (column, added) in record.variables.iter_mut().zip(&added.variables) {
        column.values.extend_from_slice(&added.values[first..]);
    }
}
