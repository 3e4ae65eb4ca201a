//! Cells of many contacts as an interface: an event is a connected set of cells that slipped in one slide.

use crate::Result;
use crate::elastic::{self, Event, Slipped, State};
use crate::energy::EnergyBalance;
use crate::monitor::Monitor;
use crate::record::{Column, Quantity, Record};

use super::model::DrivenInterface;

/// Columns of slides with viscosity.
const IN_TIME: [&str; 4] = ["time", "duration", "front_speed_left", "front_speed_right"];

/// Cells of many contacts, coupled by the elasticity of the slider.
#[derive(Debug)]
pub struct DrivenCells {
    /// The cells.
    pub interface: elastic::Interface,
    /// The drive of the balance at the start.
    origin: f64,
    /// Whether slides have a duration, set by a viscosity.
    timed: bool,
    /// Whether contacts follow the master equation; the ensemble otherwise.
    solved: bool,
}

impl DrivenCells {
    /// An interface that has not been driven.
    pub fn new(interface: elastic::Interface, timed: bool, solved: bool) -> Self {
        Self { origin: interface.drive(), interface, timed, solved }
    }
}

impl DrivenInterface for DrivenCells {
    type Event = (Event, Vec<Slipped>);
    type State = State;

    const MAGNITUDE: &'static str = "moment";
    const WHOLE: bool = false;
    const CLUSTERED: bool = true;
    const TRACE: &'static [Column] = &[
        Column::new("position", "mean position of the cells", Quantity::Length, &["point"]),
        Column::new("force", "friction force of all cells", Quantity::Force, &["point"]),
    ];
    const MAPS: &'static [Column] = &[
        Column::new("cell_position", "position of a cell", Quantity::Length, &["map_drive", "cell"]),
        Column::new("cell_force", "friction force of a cell", Quantity::Force, &["map_drive", "cell"]),
    ];

    fn drive(&self) -> f64 {
        self.interface.drive()
    }

    fn origin(&self) -> f64 {
        self.origin
    }

    fn advance(
        &mut self,
        to: f64,
        most: u64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(Self::Event),
    ) -> Result<bool> {
        from_slide_to_slide(most, || self.interface.next_with(to, monitor), each)
    }

    fn columns(&self, events: &[Self::Event]) -> Record {
        let events: Vec<_> = events.iter().map(|event| event.0).collect();
        let mut record = self.interface.record(&events);
        record.variables.retain(|variable| self.timed || !IN_TIME.contains(&variable.name.as_str()));
        record
    }

    fn slipped(&self, events: &[Self::Event], first: usize) -> Record {
        slipped(events, first, self.timed)
    }

    fn error(&self) -> Option<f64> {
        self.solved.then(|| self.interface.error())
    }

    fn time(&self) -> f64 {
        self.interface.time()
    }

    fn force(&self) -> f64 {
        self.interface.force()
    }

    fn forces(&self) -> Vec<f64> {
        self.interface.forces()
    }

    fn positions(&self) -> Option<Vec<f64>> {
        Some(self.interface.positions().to_vec())
    }

    fn energy(&self) -> Option<EnergyBalance> {
        Some(self.interface.energy())
    }

    fn trace(&self) -> Vec<f64> {
        vec![self.interface.mean_position(), self.force()]
    }

    fn maps(&self) -> Vec<Vec<f64>> {
        vec![self.interface.positions().to_vec(), self.forces()]
    }

    fn state(&self) -> State {
        self.interface.state()
    }

    fn restore(&mut self, state: State, monitor: &mut dyn Monitor) -> Result<()> {
        self.interface.restore(state, monitor)
    }
}

/// Cells that slipped in events, as columns. The first event has the number `first`. The times at which cells began to slip
/// are included if slides are `timed`.
pub fn slipped(events: &[(Event, Vec<Slipped>)], first: usize, timed: bool) -> Record {
    let mut record = Record::default();
    let mut add = |name: &str, words: &str, quantity, value: &dyn Fn(usize, &Slipped) -> f64| {
        let cells = |(event, number): (&(Event, Vec<Slipped>), usize)| {
            event.1.iter().map(|slipped| value(number, slipped)).collect::<Vec<_>>()
        };
        let values = events.iter().zip(first..).flat_map(cells).collect();
        record.push(name, words, quantity, &["slipped"], values);
    };
    let count = Quantity::Count;
    add("slipped_event", "event in which cells slipped", count, &|event, _| event as f64);
    add("slipped_cell", "cells that slipped in it", count, &|_, slipped| slipped.cell as f64);
    add("slipped_by", "slip of these cells", Quantity::Length, &|_, slipped| slipped.slip);
    if timed {
        let words = "time at which they began to slip, since the event began";
        add("slipped_start", words, Quantity::Time, &|_, slipped| slipped.start);
    }
    record
}

/// Calls `next` for one slide after the other until there have been `most` events. Returns whether there are no more slides.
pub fn from_slide_to_slide<E>(
    most: u64,
    mut next: impl FnMut() -> Result<Vec<E>>,
    each: &mut dyn FnMut(E),
) -> Result<bool> {
    let mut count = 0;
    while count < most {
        let events = next()?;
        if events.is_empty() {
            return Ok(true);
        }
        count += events.len() as u64;
        events.into_iter().for_each(&mut *each);
    }
    Ok(false)
}
