//! The course of a drive: events one after the other, maps at the drives asked for, checkpoints on the way.

use asperity::monitor::Monitor;
use asperity::record::Record;
use asperity::scenario;
use asperity::{Error, Result};
use serde::{Deserialize, Serialize};

use super::model::{Map, Model};
use crate::checkpoint::{Bits, Checkpoints};
use crate::output::{LARGEST, bytes_needed};
use crate::task::part::{Part, report};

/// Events between two looks at the monitor, at most.
const SLICE: u64 = 256;

/// An interface on its way.
pub struct Course<'a, M> {
    model: M,
    kept: Kept,
    /// Events recorded, as columns.
    events: Record,
    /// Drive from which on they are.
    from: f64,
    checkpoints: Option<&'a mut Checkpoints>,
    /// Events at the last checkpoint.
    last: u64,
}

/// What is recorded on the way, but for events.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Kept {
    /// Events so far, those among them that are not recorded.
    events: u64,
    /// Maps taken so far.
    taken: usize,
    maps: Vec<Bits>,
}

/// Columns of events by name.
type Columns = Vec<(String, Bits)>;

impl<'a, M: Model> Course<'a, M> {
    /// The course of a new `model`, taken up at the checkpoint to resume if there is one.
    pub fn new(model: M, from: f64, checkpoints: Option<&'a mut Checkpoints>) -> Result<Self> {
        let kept = Kept { maps: vec![Bits::default(); M::MAPS.len()], ..Kept::default() };
        let mut course = Self { events: model.columns(&[]), model, kept, from, checkpoints, last: 0 };
        let resumed = course.checkpoints.as_mut().map(|checkpoints| checkpoints.take()).transpose()?.flatten();
        if let Some(resumed) = resumed {
            course.resume(resumed)?;
        }
        Ok(course)
    }

    fn resume(&mut self, (state, kept, columns): (M::State, Kept, Columns)) -> Result<()> {
        self.model.restore(state)?;
        self.last = kept.events;
        self.kept = kept;
        for (name, Bits(values)) in columns {
            let found = self.events.variables.iter_mut().find(|variable| variable.name == name);
            found.ok_or_else(|| Error::invalid("checkpoint", "the columns of events", name))?.values = values;
        }
        Ok(())
    }

    /// Goes to the end of the drive; its events, and what was known of the cells on the way.
    pub fn follow(
        mut self,
        task: &scenario::Drive,
        monitor: &mut dyn Monitor,
    ) -> Result<(Record, Vec<(Map, Vec<f64>)>)> {
        let end = task.distance();
        for stop in task.maps[self.kept.taken..].iter().copied().map(Some).chain([None]) {
            if let Err(error) = self.reach(stop.unwrap_or(end), end, monitor) {
                if error == Error::Stopped {
                    self.keep()?;
                }
                return Err(error);
            }
            if stop.is_some() {
                self.kept.taken += 1;
                let maps = self.kept.maps.iter_mut().zip(self.model.maps());
                maps.for_each(|(all, now)| all.0.extend(now));
            }
        }
        let maps = M::MAPS.iter().copied().zip(self.kept.maps.into_iter().map(|bits| bits.0)).collect();
        Ok((self.events, maps))
    }

    /// Goes on to the drive `stop` on the way to `end`.
    fn reach(&mut self, stop: f64, end: f64, monitor: &mut dyn Monitor) -> Result<()> {
        loop {
            let every = self.checkpoints.as_ref().and_then(|checkpoints| checkpoints.every());
            let most = every.map_or(SLICE, |every| SLICE.min(every - (self.kept.events - self.last)));
            let drive = self.model.drive();
            monitor.events(self.kept.events, drive);
            report(monitor, drive / end)?;
            let mut part = Part::new(monitor, drive / end, (stop - drive).max(0.0) / end);
            let mut slice = Vec::new();
            let reached = self.model.advance(stop, most, &mut part, &mut |event| slice.push(event));
            self.record(&slice)?;
            if reached? {
                return Ok(());
            }
            if every.is_some_and(|every| self.kept.events - self.last >= every) {
                self.keep()?;
            }
        }
    }

    /// Adds events to those recorded.
    fn record(&mut self, events: &[M::Event]) -> Result<()> {
        self.kept.events += events.len() as u64;
        let added = self.model.columns(events);
        let drives = added.values("drive").unwrap_or_default();
        let first = drives.partition_point(|&drive| drive < self.from);
        for (column, added) in self.events.variables.iter_mut().zip(&added.variables) {
            column.values.extend_from_slice(&added.values[first..]);
        }
        if bytes_needed(&self.events) <= LARGEST {
            return Ok(());
        }
        let expected =
            format!("a drive from which on events fit in a result file of {} MB", LARGEST / 1_000_000);
        let found = format!("{}: {} events by the drive {}", self.from, self.kept.events, self.model.drive());
        Err(Error::invalid("interface.catalogue_from", expected, found))
    }

    /// Writes a checkpoint, where there are to be any.
    fn keep(&mut self) -> Result<()> {
        let Some(checkpoints) = &mut self.checkpoints else { return Ok(()) };
        let columns: Columns =
            self.events.variables.iter().map(|v| (v.name.clone(), Bits(v.values.clone()))).collect();
        self.last = self.kept.events;
        checkpoints.keep(self.kept.events, &(self.model.state(), &self.kept, columns))
    }
}
