//! A deformable interface whose contacts are time-dependent: the drive moves at a velocity, and cells by
//!
//! η Ẋ_j = K_0j(X_T − X_j) − (AX)_j − F_j[X_j(·), t].
//!
//! Cells move forward only; one that its contacts would pull back stands. Time passes for all of them, so that contacts age
//! while cells stick. There is no balance to be lost and found: where friction falls faster than springs do, cells become
//! fast, and η limits how fast they are.

mod scaled;
mod slips;
mod stage;
mod state;

pub use scaled::Scaled;
pub use state::StateInTime;

use super::{Coupling, EnergyBalance, Event, Loading, Slipped, event};
use crate::monitor::{Aside, Monitor, Watch, report};
use crate::numerics::tr_bdf2::{CHANGE, GAMMA, change};
use crate::rate_dependent::{Books, ErrorEstimator, RateDependentContacts, StretchInterval};
use crate::record::Record;
use crate::{Error, Float, Result};
use slips::{MotionSnapshot, Seen, Slips};
use stage::{Dynamics, Pulled, State, Tried};

/// The first step, as a share of what it may be.
const FIRST: f64 = 1e-3;

/// Steps below this share of the time are no steps.
const SHORTEST: f64 = 1e-15;

/// How an interface is driven in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterfaceInTimeParameters {
    /// K_0, stiffness of the spring from a cell to the drive, force per length.
    pub connection: f64,
    /// Which cells have one.
    pub loading: Loading,
    /// η, force on a cell per velocity, which limits how fast cells slip.
    pub viscosity: f64,
    /// The length to which a step in time is right, for each cell.
    pub tolerance: f64,
    /// The share of the contacts of a cell that breaks in the smallest event: above 0 where contacts are so few that each
    /// of them makes its cell slip a little.
    pub slip_fraction: f64,
    /// Area of a cell; `None` where areas are counted in cells.
    pub area: Option<f64>,
}

impl InterfaceInTimeParameters {
    /// Checks the numbers; keys are those of the table `[interface]`.
    fn check(&self) -> Result<()> {
        for (key, value) in [
            ("connection", self.connection),
            ("viscosity", self.viscosity),
            ("tolerance", self.tolerance),
            ("area", self.area.unwrap_or(1.0)),
        ] {
            positive(key, value)?;
        }
        if (0.0..=1.0).contains(&self.slip_fraction) {
            return Ok(());
        }
        Err(Error::invalid("slip_fraction", "a number from 0 to 1", self.slip_fraction))
    }
}

/// Cells on an elastic slider, moved in time.
///
/// A cell *slips* while it is ten times as fast as the drive, as the block in time does. Forces and energies are totals over
/// the cells, in the units of the contacts of which the cells are made.
pub struct InterfaceInTime {
    dynamics: Dynamics,
    cells: Vec<State>,
    time: f64,
    drive: f64,
    /// How long the next step may be.
    pace: f64,
    work: f64,
    /// Lost by viscous drag, cell by cell.
    viscous: Vec<f64>,
    begun: Stored,
    look: MotionSnapshot,
    slips: Slips,
    /// What tells the errors of the forces of cells, if that is asked for, and the largest so far.
    estimators: Option<Vec<ErrorEstimator>>,
    error: f64,
    /// Where the present run began, and its end.
    path: (f64, f64),
}

/// What is stored, and what came and went by the contacts.
#[derive(Debug, Clone, Copy)]
struct Stored {
    connection: f64,
    coupling: f64,
    contacts: Books,
}

impl InterfaceInTime {
    /// Cells in balance with what their contacts are stretched by, at rest and at a mean position of 0.
    ///
    /// # Errors
    /// Numbers of the setting that are not finite and above 0, a share outside [0, 1]; another number of cells than the
    /// coupling is for.
    pub fn new(
        contacts: Vec<Box<dyn RateDependentContacts>>,
        coupling: Box<dyn Coupling>,
        setting: InterfaceInTimeParameters,
    ) -> Result<Self> {
        setting.check()?;
        let (number, shape) = (contacts.len(), coupling.shape());
        if number != shape.size() {
            return Err(Error::invalid("cells", format!("{} of them, as coupled", shape.size()), number));
        }
        let connected = match setting.loading {
            Loading::Uniform => number,
            Loading::Edge => shape.first_row(),
        };
        let connection = |j: usize| if j < connected { setting.connection } else { 0.0 };
        let drive = contacts.iter().map(|contacts| contacts.force()).sum::<f64>()
            / (connected as f64 * setting.connection);
        let springs: Vec<f64> = (0..number).map(connection).collect();
        let mut positions: Vec<f64> = contacts
            .iter()
            .zip(&springs)
            .map(|(contacts, spring)| spring * drive - contacts.force())
            .collect();
        let InterfaceInTimeParameters { connection, viscosity, tolerance, slip_fraction, area, .. } = setting;
        let mut dynamics = Dynamics { coupling, connection, connected, viscosity, tolerance };
        dynamics.respond(&springs, &mut positions);
        let mut interface = Self {
            dynamics,
            cells: contacts.into_iter().zip(positions).map(|(contacts, x)| State::of(contacts, x)).collect(),
            time: 0.0,
            drive,
            pace: f64::INFINITY,
            work: 0.0,
            viscous: vec![0.0; number],
            begun: Stored { connection: 0.0, coupling: 0.0, contacts: Books::default() },
            look: MotionSnapshot { time: 0.0, drive, cells: Vec::new() },
            slips: Slips::new(number, slip_fraction, area),
            estimators: None,
            error: 0.0,
            path: (drive, drive),
        };
        interface.begun = interface.stored();
        interface.look = interface.seen();
        Ok(interface)
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// X_T.
    pub fn drive(&self) -> f64 {
        self.drive
    }

    /// Time t since the beginning.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// X_j, along rows.
    pub fn positions(&self) -> Vec<f64> {
        self.cells.iter().map(|cell| cell.position).collect()
    }

    /// Ẋ_j, along rows.
    pub fn velocities(&self) -> Vec<f64> {
        self.cells.iter().map(|cell| cell.velocity).collect()
    }

    /// F_j, along rows; their sum is [`InterfaceInTime::force`].
    pub fn forces(&self) -> Vec<f64> {
        self.cells.iter().map(|cell| cell.force).collect()
    }

    /// The contacts of a cell that hold, by their stretches: [`crate::rate_dependent::binned`] makes a distribution of them.
    ///
    /// # Errors
    /// A number of no cell.
    pub fn stretches(&self, cell: usize) -> Result<Vec<StretchInterval>> {
        match self.cells.get(cell) {
            Some(cell) => Ok(cell.contacts.stretches()),
            None => Err(Error::invalid("cell", format!("a number below {}", self.len()), cell)),
        }
    }

    /// Friction force of all cells.
    pub fn force(&self) -> f64 {
        self.cells.iter().map(|cell| cell.force).sum()
    }

    /// The fraction of contacts that is free.
    pub fn free(&self) -> f64 {
        self.cells.iter().map(|cell| cell.contacts.free()).sum::<f64>() / self.len() as f64
    }

    /// Breaks since the beginning, per contact.
    pub fn broken(&self) -> f64 {
        self.cells.iter().map(|cell| cell.contacts.books().broken).sum::<f64>() / self.len() as f64
    }

    /// From now on with [`InterfaceInTime::error`], which takes some three times as long: contacts are followed twice more.
    #[must_use]
    pub fn with_error(mut self) -> Self {
        self.estimators = self.cells.iter().map(|cell| ErrorEstimator::of(cell.contacts.as_ref())).collect();
        self
    }

    /// An estimate of the largest error of the force of a cell on the way gone, on the safe side, if that was asked for: how far
    /// it is from that at a larger tolerance of the contacts, and twice what steps half as long change. None of contacts that
    /// are followed one by one.
    pub fn error(&self) -> Option<f64> {
        self.estimators.as_ref().map(|_| self.error)
    }

    /// A catalogue as columns, those of `events.csv`.
    pub fn record(&self, events: &[Event]) -> Record {
        event::record(events, self.slips.area)
    }

    /// Energies since the beginning; `slip` is what viscous drag has taken, ∫Σ ηẊ_j² dt, in slips or not.
    pub fn energy(&mut self) -> EnergyBalance {
        let (begun, now) = (self.begun, self.stored());
        EnergyBalance {
            work: self.work,
            spring: now.connection - begun.connection,
            coupling: now.coupling - begun.coupling,
            elastic: now.contacts.elastic - begun.contacts.elastic,
            strengthening: now.contacts.gained - begun.contacts.gained,
            breaks: now.contacts.lost - begun.contacts.lost,
            slip: self.viscous.iter().sum(),
            ..EnergyBalance::default()
        }
    }

    /// Drives the cells up to `drive` at a velocity, and tells `each` event that is over and the cells that slipped in it.
    ///
    /// # Errors
    /// A velocity that is not above 0; an accuracy that steps do not reach; stopped by the monitor: the interface is then
    /// between two steps, and can go on.
    pub fn run(
        &mut self,
        drive: f64,
        velocity: f64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(&Event, &[Slipped]),
    ) -> Result<()> {
        loop {
            let events = self.next(drive, velocity, monitor)?;
            if events.is_empty() {
                return Ok(());
            }
            events.iter().for_each(|(event, slipped)| each(event, slipped));
        }
    }

    /// Drives the cells up to `drive` at a velocity, or until events are over: these, each with the cells that slipped in
    /// it; none if the drive was reached. What slips then goes on in the next run.
    ///
    /// # Errors
    /// See [`InterfaceInTime::run`].
    pub fn next(
        &mut self,
        drive: f64,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<(Event, Vec<Slipped>)>> {
        positive("velocity", velocity)?;
        if self.path.1 != drive {
            self.path = (self.drive, drive);
        }
        while self.drive < drive {
            let fraction = self.fraction();
            self.go(drive, velocity, &mut Aside { fraction, monitor })?;
            let events = self.slips.told();
            if !events.is_empty() {
                return Ok(events);
            }
        }
        report(monitor, 1.0)?;
        Ok(Vec::new())
    }

    /// How far the drive is on its way.
    fn fraction(&self) -> f64 {
        let (from, to) = self.path;
        ((self.drive - from) / (to - from)).clamp(0.0, 1.0)
    }

    /// Moves on in one step, at most up to a drive.
    fn go(&mut self, drive: f64, velocity: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let left = (drive - self.drive) / velocity;
        let mut duration = if self.pace.is_finite() { self.pace } else { FIRST * left };
        duration = if duration >= left { left } else { duration.min(0.5 * left) };
        let pulled = Pulled { drive: self.drive, velocity };
        loop {
            if duration < SHORTEST * (self.time + left) {
                let what = format!("an interface in time at t = {}", self.time);
                let wanted = Float(self.dynamics.tolerance);
                return Err(Error::Accuracy { key: String::new(), what, reached: Float(f64::NAN), wanted });
            }
            let Some(tried) = self.dynamics.attempt(&self.cells, pulled, duration, monitor)? else {
                duration *= CHANGE.1;
                continue;
            };
            let error = tried.error / self.dynamics.tolerance;
            let factor = change(error);
            if error > 1.0 {
                duration *= factor.min(0.9);
                continue;
            }
            self.estimate_error(&tried, duration, monitor)?;
            self.pace = if duration < left { factor * duration } else { self.pace.max(factor * duration) };
            self.drive = if duration < left { pulled.after(duration) } else { drive };
            self.time += duration;
            self.accept(tried, velocity);
            return Ok(());
        }
    }

    /// Moves the error estimators in the same step; if the monitor stops that, nothing has moved.
    fn estimate_error(&mut self, tried: &Tried, duration: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let (cells, time) = (&self.cells, GAMMA * duration);
        let Some(estimators) = &mut self.estimators else { return Ok(()) };
        let watch = &Watch::new(monitor);
        let follow = |(): &mut (), j: usize| {
            let (mut estimator, mut watch) = (estimators[j].copy(), watch);
            let ((middle, force), end) = (tried.middle[j], &tried.end[j]);
            let first = estimator.step(middle - cells[j].position, time, force, &mut watch)?;
            let second = estimator.step(end.position - middle, duration - time, end.force, &mut watch)?;
            Ok((estimator, first.max(second)))
        };
        let followed = watch.share(cells.len(), || (), follow)?;
        let (followed, apart): (Vec<_>, Vec<f64>) =
            followed.into_iter().collect::<Result<Vec<_>>>()?.into_iter().unzip();
        *estimators = followed;
        self.error = apart.into_iter().fold(self.error, f64::max);
        Ok(())
    }

    fn accept(&mut self, tried: Tried, velocity: f64) {
        self.cells = tried.end;
        self.work += tried.work;
        self.viscous.iter_mut().zip(tried.viscous).for_each(|(lost, more)| *lost += more);
        let now = self.seen();
        let before = std::mem::replace(&mut self.look, now);
        self.slips.pass(&before, &self.look, velocity, self.dynamics.coupling.as_ref());
    }

    /// What is seen of the cells now.
    fn seen(&self) -> MotionSnapshot {
        let seen = |(cell, &viscous): (&State, &f64)| {
            let Books { lost, broken, .. } = cell.contacts.books();
            let &State { position, velocity, force, .. } = cell;
            Seen { position, velocity, force, lost, broken, viscous }
        };
        let cells = self.cells.iter().zip(&self.viscous).map(seen).collect();
        MotionSnapshot { time: self.time, drive: self.drive, cells }
    }

    /// What is stored now.
    fn stored(&mut self) -> Stored {
        let positions = self.positions();
        let stretch = |j: usize| self.drive - positions[j];
        let connection =
            (0..self.len()).map(|j| 0.5 * self.dynamics.connection(j) * stretch(j).powi(2)).sum();
        let add = |sum: Books, cell: &State| {
            let books = cell.contacts.books();
            Books {
                elastic: sum.elastic + books.elastic,
                lost: sum.lost + books.lost,
                gained: sum.gained + books.gained,
                broken: sum.broken + books.broken,
            }
        };
        Stored {
            connection,
            coupling: self.dynamics.stored(&positions),
            contacts: self.cells.iter().fold(Books::default(), add),
        }
    }
}

fn positive(key: &str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::invalid(key, "a finite number above 0", value))
}
