//! The course of a drive: events one after the other, looks at the interface on the way, checkpoints.

use std::time::{Duration, Instant};

use asperity::monitor::Monitor;
use asperity::record::Record;
use asperity::{Error, Result};
use serde::{Deserialize, Serialize};

use super::model::Model;
use super::stops::Stop;
use crate::checkpoint::{Bits, Checkpoints};
use crate::output::{LARGEST, bytes_needed};
use crate::task::part::{Part, report};

/// Events between two looks at the monitor and at the clock, at most.
const SLICE: u64 = 256;
/// Time between two looks, about: what is waited for before a run stops.
const LOOK: Duration = Duration::from_millis(50);

/// An interface on its way.
pub struct Course<'a, M> {
    model: M,
    /// Events so far, those among them that are not recorded.
    count: u64,
    /// Looks taken so far.
    looks: usize,
    found: Found,
    /// Drive from which on events are recorded.
    from: f64,
    /// Whether cells that took part in events are recorded.
    chain: bool,
    checkpoints: Option<&'a mut Checkpoints>,
    /// Events at the last checkpoint.
    last: u64,
    /// Rows of each column at the last checkpoint.
    kept: Vec<usize>,
    /// Events until the next look at the monitor.
    slice: u64,
}

/// What is recorded.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// Events as columns.
    pub events: Record,
    /// Cells that took part in the events of a chain, as columns.
    pub slipped: Record,
    /// What was known of the whole, look by look.
    pub trace: Vec<Vec<f64>>,
    /// What was known of every cell, look by look.
    pub maps: Vec<Vec<f64>>,
    /// Estimated error of the force of a cell, where there is one.
    pub error: Option<f64>,
}

/// What a checkpoint holds beside the columns.
#[derive(Serialize, Deserialize)]
struct Kept<S> {
    state: S,
    count: u64,
    looks: usize,
}

impl Found {
    fn empty<M: Model>(model: &M) -> Self {
        Self {
            events: model.columns(&[]),
            slipped: model.slipped(&[], 0),
            trace: vec![Vec::new(); M::TRACE.len()],
            maps: vec![Vec::new(); M::MAPS.len()],
            error: None,
        }
    }

    /// All columns, in the order in which checkpoints have them.
    fn columns(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let records = self.events.variables.iter_mut().chain(&mut self.slipped.variables);
        records.map(|variable| &mut variable.values).chain(&mut self.trace).chain(&mut self.maps)
    }
}

impl<'a, M: Model> Course<'a, M> {
    /// The course of a new `model`, taken up at the checkpoint to resume if there is one. Events are recorded `from` a
    /// drive on, with the cells that took part in them if it is a `chain`.
    pub fn new(
        model: M,
        from: f64,
        chain: bool,
        checkpoints: Option<&'a mut Checkpoints>,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let mut found = Found::empty(&model);
        let kept = vec![0; found.columns().count()];
        let (count, looks, last) = (0, 0, 0);
        let mut course = Self { model, count, looks, found, from, chain, checkpoints, last, kept, slice: 1 };
        let kept = course.checkpoints.as_mut().map(|checkpoints| checkpoints.take()).transpose()?.flatten();
        if let Some((kept, columns)) = kept {
            course.resume(kept, columns, monitor)?;
        }
        Ok(course)
    }

    fn resume(&mut self, kept: Kept<M::State>, columns: Vec<Bits>, monitor: &mut dyn Monitor) -> Result<()> {
        let Kept { state, count, looks } = kept;
        self.model.restore(state, monitor)?;
        (self.count, self.last, self.looks) = (count, count, looks);
        self.found.columns().zip(columns).for_each(|(column, Bits(values))| *column = values);
        self.kept = self.found.columns().map(|column| column.len()).collect();
        Ok(())
    }

    /// Goes from stop to stop; what was found.
    pub fn follow(mut self, stops: &[Stop], monitor: &mut dyn Monitor) -> Result<Found> {
        let end = stops.last().map_or(0.0, |stop| stop.drive);
        for stop in &stops[self.looks..] {
            match self.reach(stop.drive, end, monitor) {
                Err(Error::Stopped) => return self.keep().and(Err(Error::Stopped)),
                reached => reached?,
            }
            self.look(stop)?;
        }
        Ok(Found { error: self.model.error(), ..self.found })
    }

    fn look(&mut self, stop: &Stop) -> Result<()> {
        if stop.point {
            let trace = self.found.trace.iter_mut().zip(self.model.trace()?);
            trace.for_each(|(column, now)| column.push(now));
        }
        if stop.map {
            let maps = self.found.maps.iter_mut().zip(self.model.maps()?);
            maps.for_each(|(column, now)| column.extend(now));
        }
        self.looks += 1;
        Ok(())
    }

    /// Goes on to the drive `stop` on the way to `end`.
    fn reach(&mut self, stop: f64, end: f64, monitor: &mut dyn Monitor) -> Result<()> {
        loop {
            let most = self.slice.min(self.events_left()).max(1);
            let drive = self.model.drive();
            monitor.events(self.count, drive);
            report(monitor, drive / end)?;
            let mut part = Part::new(monitor, drive / end, (stop - drive).max(0.0) / end);
            let mut slice = Vec::new();
            let began = Instant::now();
            let reached = self.model.advance(stop, most, &mut part, &mut |event| slice.push(event));
            self.slice = next_slice(self.slice, began.elapsed());
            self.record(&slice)?;
            if self.events_left() == 0 {
                self.keep()?;
            }
            if reached? {
                return Ok(());
            }
        }
    }

    /// Events that may pass before the next checkpoint.
    fn events_left(&self) -> u64 {
        let left = |checkpoints: &&mut Checkpoints| checkpoints.events_left(self.count - self.last);
        self.checkpoints.as_ref().map_or(u64::MAX, left)
    }

    /// Adds events to those recorded.
    fn record(&mut self, events: &[M::Event]) -> Result<()> {
        self.count += events.len() as u64;
        let added = self.model.columns(events);
        let drives = added.values("drive").unwrap_or_default();
        let first = drives.partition_point(|&drive| drive < self.from);
        if self.chain {
            let number = self.found.events.length("event").unwrap_or(0) + 1;
            append(&mut self.found.slipped, &self.model.slipped(&events[first..], number), 0);
        }
        append(&mut self.found.events, &added, first);
        if bytes_needed(&self.found.events) + bytes_needed(&self.found.slipped) <= LARGEST {
            return Ok(());
        }
        let expected =
            format!("a drive after which the events fit in a result file of {} MB", LARGEST / 1_000_000);
        let found = format!("{}: {} events by the drive {}", self.from, self.count, self.model.drive());
        Err(Error::invalid("interface.catalogue_from", expected, found))
    }

    /// Writes a checkpoint, where there are to be any.
    fn keep(&mut self) -> Result<()> {
        let Some(checkpoints) = &mut self.checkpoints else { return Ok(()) };
        let added = self.found.columns().zip(&self.kept);
        let rows: Vec<_> = added.map(|(column, &kept)| Bits(column[kept..].to_vec())).collect();
        let state = Kept { state: self.model.state(), count: self.count, looks: self.looks };
        checkpoints.keep(self.count, &state, &rows)?;
        self.last = self.count;
        self.kept = self.found.columns().map(|column| column.len()).collect();
        Ok(())
    }
}

/// Events until the look after the next, where `slice` events took this time. Results do not depend on it.
fn next_slice(slice: u64, took: Duration) -> u64 {
    if took < LOOK { (2 * slice).min(SLICE) } else { (slice / 2).max(1) }
}

/// Adds the values of `added` from the place `first` on, column by column.
fn append(record: &mut Record, added: &Record, first: usize) {
    for (column, added) in record.variables.iter_mut().zip(&added.variables) {
        column.values.extend_from_slice(&added.values[first..]);
    }
}
