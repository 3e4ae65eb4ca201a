//! The columns that the drive of an interface records: in memory, or, once they outgrow it, in a store.

use std::borrow::Cow;

use crate::Result;
use crate::elastic::SlipRates;
use crate::record::{Column, Record};
use crate::scenario::{Interface, Model};
use crate::task::ColumnStore;

use super::model::DrivenInterface;
use super::{contacts_of_all, sides_of};

/// Bytes of columns that are put into a store at once, at most.
const PIECE: u64 = 64 << 20;

/// What the columns of cells are, beside their values.
#[derive(Debug)]
pub struct CellColumns<'a> {
    model: &'a Model,
    /// Number of populations of contacts.
    populations: usize,
    /// Areas of the cells relative to their mean, unless all are alike.
    areas: Option<Vec<f64>>,
    /// The columns that number the cells.
    sides: Vec<Column>,
}

impl<'a> CellColumns<'a> {
    /// Those of the cells that `interface` describes.
    pub fn of(model: &'a Model, interface: &Interface) -> Self {
        let (populations, areas) = (contacts_of_all(interface), interface.relative_areas());
        Self { model, populations, areas, sides: sides_of(interface) }
    }
}

/// The recorded columns.
pub struct Found<'a> {
    /// Events as columns.
    pub events: Record,
    /// Cells that took part in the events of a chain, as columns.
    pub slipped: Record,
    /// Columns of the whole interface, one value at each output point.
    pub trace: Vec<Vec<f64>>,
    /// Columns of the cells, one row at each output point with a map.
    pub maps: Vec<Vec<f64>>,
    /// Estimated error of the force of a cell; `None` if contacts are followed one by one.
    pub error: Option<f64>,
    /// The velocities of all cells at steps in time, if they are recorded.
    pub slip_rates: Option<SlipRates>,
    /// Number of events that had not ended when the run did, which are not recorded.
    pub unfinished: usize,
    /// Whether events, cells that took part in them, and maps are in the store.
    pub stored: bool,
    described: CellColumns<'a>,
    maps_of: &'static [Column],
    store: Option<&'a mut dyn ColumnStore>,
}

impl<'a> Found<'a> {
    /// No values yet. They will be put into `store` once they outgrow the memory.
    pub fn empty<M: DrivenInterface>(
        model: &M,
        described: CellColumns<'a>,
        store: Option<&'a mut dyn ColumnStore>,
    ) -> Self {
        Self {
            events: model.columns(&[]),
            slipped: model.slipped(&[], 0),
            trace: vec![Vec::new(); M::TRACE.len()],
            maps: vec![Vec::new(); M::MAPS.len()],
            error: None,
            slip_rates: None,
            unfinished: 0,
            stored: false,
            described,
            maps_of: M::MAPS,
            store,
        }
    }

    /// All columns in memory, in the order of checkpoints.
    pub fn columns(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let records = self.events.variables.iter_mut().chain(&mut self.slipped.variables);
        records.map(|variable| &mut variable.values).chain(&mut self.trace).chain(&mut self.maps)
    }

    /// Adds rows to the columns, in the order of checkpoints.
    ///
    /// # Errors
    /// They outgrow the memory, and cannot be stored.
    pub fn add(&mut self, rows: Vec<Vec<f64>>) -> Result<()> {
        self.columns().zip(rows).for_each(|(column, rows)| column.extend(rows));
        if self.outgrow_memory() { self.put_into_store() } else { Ok(()) }
    }

    /// Whether there is a store, and it is time to put values into it.
    pub fn outgrow_memory(&self) -> bool {
        let maps = self.maps.iter().map(|map| size_of_val(map.as_slice()) as u64).sum::<u64>();
        let bytes = self.events.bytes() + self.slipped.bytes() + maps;
        self.store.as_ref().is_some_and(|store| {
            bytes > if self.stored { store.in_memory().min(PIECE) } else { store.in_memory() }
        })
    }

    /// Puts the values of events, of cells that took part in them, and of maps into the store, as variables of a result.
    ///
    /// # Errors
    /// They cannot be stored.
    pub fn put_into_store(&mut self) -> Result<()> {
        let Some(store) = &mut self.store else { return Ok(()) };
        let CellColumns { model, populations, areas, sides } = &self.described;
        let (no_events, none_slipped) = (without_values(&self.events), without_values(&self.slipped));
        let mut record = events(
            std::mem::replace(&mut self.events, no_events),
            std::mem::replace(&mut self.slipped, none_slipped),
        );
        add_maps(self.maps_of, self.maps.iter_mut().map(std::mem::take), sides, &mut record);
        model.add_background_of_cells(*populations, areas.as_deref(), &mut record);
        self.stored = true;
        record.variables.iter().try_for_each(|variable| store.append(variable))
    }

    /// All values of a column of events; `None` if there is no such column.
    ///
    /// # Errors
    /// They cannot be read.
    pub fn of_events(&mut self, name: &str) -> Result<Option<Cow<'_, [f64]>>> {
        if self.events.get(name).is_none() {
            return Ok(None);
        }
        match &mut self.store {
            Some(store) if self.stored => store.values(&event(name)).map(Cow::Owned).map(Some),
            _ => Ok(self.events.values(name).map(Cow::Borrowed)),
        }
    }
}

/// The same variables, with no values.
fn without_values(record: &Record) -> Record {
    let mut empty = Record::default();
    for of in &record.variables {
        let dimensions: Vec<&str> = of.dimensions.iter().map(String::as_str).collect();
        empty.push(&of.name, &of.long_name, of.quantity, &dimensions, Vec::new());
    }
    empty
}

/// The name of a column of events in a result.
fn event(name: &str) -> String {
    format!("event_{name}")
}

/// Events as variables `event_…`, and the cells that took part in them, if there are any.
pub fn events(events: Record, slipped: Record) -> Record {
    let mut record = events;
    record.variables.iter_mut().for_each(|variable| variable.name = event(&variable.name));
    record.variables.extend(slipped.variables.into_iter().filter(|listed| !listed.values.is_empty()));
    record
}

/// Adds the maps of the cells, along these sides.
pub fn add_maps(
    columns: &[Column],
    maps: impl IntoIterator<Item = Vec<f64>>,
    sides: &[Column],
    record: &mut Record,
) {
    let along: Vec<&str> = ["map_drive"].into_iter().chain(sides.iter().map(|side| side.name)).collect();
    for (column, values) in columns.iter().zip(maps) {
        record.push(column.name, column.long_name, column.quantity, &along, values);
    }
}
