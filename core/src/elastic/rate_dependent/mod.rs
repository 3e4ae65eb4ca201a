//! A deformable interface over time-dependent contacts. The drive moves at a velocity, and the cells follow
//!
//! M Ẍ_j + η Ẋ_j = K_0j(X_T − X_j) − (AX)_j − F_j[X_j(·), t],
//!
//! integrated by the module `dynamics`. Cells over time-dependent contacts move forward only; one that would go back stays at
//! rest. Athermal contacts ([`crate::rate_dependent::PopulationInTime`]) are loaded and unloaded.
//! Contacts age while cells stick. In contrast to quasistatic motion there is no search for a balance: where friction falls
//! faster than the force of the springs, cells accelerate, and η or M limits their velocity.
//!
//! With a mass, disturbances travel as waves. On a chain of springs K_int, ω² = (4K_int/M) sin²(q/2), of speed √(K_int/M) cells
//! per time at long wavelengths, which no signal exceeds.

mod coupled;
mod scaled;
mod slip_rates;
mod slips;
mod state;

pub use scaled::Scaled;
pub use slip_rates::SlipRates;
pub use state::RateDependentInterfaceState;

use super::{CellLoading, Coupling, EnergyBalance, Event, Slipped, event};
use crate::dynamics::{Arrest, EquationOfMotion, SliderMotion, SlidingCell};
use crate::energy::ContactEnergies;
use crate::error::{finite, not_negative, positive};
use crate::history::LoadPointSegment;
use crate::monitor::{Aside, Monitor, report};
use crate::rate_dependent::{ROUGH, RateDependentContacts, StretchInterval};
use crate::record::Record;
use crate::{Error, Result};
use coupled::CoupledCells;
use slips::{MotionSnapshot, Seen, Slips};

/// How an interface is driven in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateDependentInterfaceParameters {
    /// K_0, stiffness of the spring from a cell of area 1 to the drive, force per length.
    pub connection: f64,
    /// Which cells have such a spring.
    pub loading: CellLoading,
    /// M, mass of a cell of area 1, 0 or above.
    pub mass: f64,
    /// η, viscous force on a cell of area 1 per velocity, 0 or above; mass or viscosity limit the velocity of slip.
    pub viscosity: f64,
    /// Tolerance of a step in time: the largest error of the position of a cell, a length.
    pub tolerance: f64,
    /// Fraction of the contacts of a cell that breaks in the smallest event: above 0 for contacts so few that each break makes
    /// its cell slip a little.
    pub slip_fraction: f64,
    /// Area of a cell of relative area 1; `None` where areas are counted in cells.
    pub area: Option<f64>,
}

impl RateDependentInterfaceParameters {
    /// Cells of many contacts that are all connected to the drive; areas are counted in cells.
    pub fn new(connection: f64, viscosity: f64, tolerance: f64) -> Self {
        Self {
            connection,
            loading: CellLoading::default(),
            mass: 0.0,
            viscosity,
            tolerance,
            slip_fraction: 0.0,
            area: None,
        }
    }

    /// Checks the numbers.
    fn check(&self) -> Result<()> {
        for (key, value) in [
            ("connection", self.connection),
            ("tolerance", self.tolerance),
            ("area", self.area.unwrap_or(1.0)),
        ] {
            positive(key, value)?;
        }
        not_negative("mass", self.mass)?;
        if self.mass > 0.0 {
            not_negative("viscosity", self.viscosity)
        } else {
            positive("viscosity", self.viscosity)
        }?;
        if (0.0..=1.0).contains(&self.slip_fraction) {
            return Ok(());
        }
        Err(Error::invalid("slip_fraction", "a number from 0 to 1", self.slip_fraction))
    }
}

/// A deformable interface over time-dependent contacts, moved in time: cells on an elastic slider.
///
/// A cell *slips* while it is more than ten times as fast as the drive, as for a block in time. Forces and energies are
/// totals over the cells, in the units of the contacts of the cells.
///
/// ```
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// use asperity::elastic::coupling::neighbours;
/// use asperity::elastic::{RateDependentInterface, RateDependentInterfaceParameters};
/// use asperity::master::Transport;
/// use asperity::rate_dependent::RateDependentContacts;
/// use asperity::shape::{Edges, Shape};
///
/// let cell = Transport::new(contacts, &Initial::default())?;
/// let cells = (0..4).map(|_| Box::new(cell.clone()) as Box<dyn RateDependentContacts>).collect();
/// let coupling = neighbours(Shape::Chain(4), Edges::Open, 1.0)?;
/// let parameters = RateDependentInterfaceParameters::new(2.0, 0.1, 1e-4);
/// let mut chain = RateDependentInterface::new(cells, coupling, parameters)?;
/// // Equal cells move together.
/// chain.run(0.5, 0.1, &mut |_, _| ())?;
/// let positions = chain.positions();
/// assert!(positions.iter().all(|x| (x - positions[0]).abs() < 1e-9) && positions[0] > 0.0);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug)]
pub struct RateDependentInterface {
    setting: RateDependentInterfaceParameters,
    motion: SliderMotion,
    coupling: Box<dyn Coupling>,
    begun: Stored,
    look: MotionSnapshot,
    /// Forces of the slider on the cells and its elastic energy where they are now, kept because the coupling computes forces in a
    /// workspace.
    coupling_forces: Vec<f64>,
    coupling_energy: f64,
    slips: Slips,
    /// The slip rates of cells, if they are recorded.
    rates: Option<SlipRates>,
    /// Where the present run began, and its end.
    path: (f64, f64),
}

/// Stored energies, and the energies of the contacts.
#[derive(Debug, Clone, Copy)]
struct Stored {
    connection: f64,
    coupling: f64,
    kinetic: f64,
    contacts: ContactEnergies,
}

impl RateDependentInterface {
    /// The interface in balance with the present stretches of its contacts, with a mean position of 0 (weighted by area) of the
    /// cells that the drive pulls: at rest, or, where contacts slide steadily, at their velocity, which must then be the same in
    /// all cells.
    ///
    /// # Errors
    /// Parameters that are not finite and above 0; a slip fraction outside [0, 1]; another number of cells than that of the
    /// coupling; cells that slide steadily at different velocities.
    pub fn new(
        contacts: Vec<Box<dyn RateDependentContacts>>,
        coupling: Box<dyn Coupling>,
        setting: RateDependentInterfaceParameters,
    ) -> Result<Self> {
        Self::new_with(contacts, coupling, setting, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`RateDependentInterface::new`]; stopped by the monitor.
    pub fn new_with(
        contacts: Vec<Box<dyn RateDependentContacts>>,
        mut coupling: Box<dyn Coupling>,
        setting: RateDependentInterfaceParameters,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        setting.check()?;
        let (number, shape) = (contacts.len(), coupling.shape());
        if number != shape.size() {
            return Err(Error::invalid("cells", format!("{} of them, as coupled", shape.size()), number));
        }
        moves_together(&contacts)?;
        let connected = match setting.loading {
            CellLoading::Uniform => number,
            CellLoading::Edge => shape.first_row(),
        };
        let RateDependentInterfaceParameters {
            connection,
            mass,
            viscosity,
            tolerance,
            slip_fraction,
            area,
            ..
        } = setting;
        let equation = EquationOfMotion {
            connection,
            connected,
            mass,
            viscosity,
            background: 0.0,
            arrest: Arrest::Stand,
        };
        let areas: Vec<f64> = contacts.iter().map(|contacts| contacts.area()).collect();
        let pull = areas[..connected].iter().sum::<f64>() * connection;
        // At this drive the springs carry the total friction force, and the drag of steady sliding. The equilibrium
        // positions solve a linear system, because contacts do not move with them.
        let resistance = |contacts: &dyn RateDependentContacts| {
            contacts.force() + contacts.area() * viscosity * contacts.steady_velocity().unwrap_or(0.0)
        };
        let drive = contacts.iter().map(|contacts| resistance(contacts.as_ref())).sum::<f64>() / pull;
        let spring = |j: usize| if j < connected { areas[j] * connection } else { 0.0 };
        let springs: Vec<f64> = (0..number).map(spring).collect();
        let balance = springs
            .iter()
            .zip(&contacts)
            .map(|(spring, contacts)| spring * drive - resistance(contacts.as_ref()));
        let mut positions: Vec<f64> = balance.collect();
        CoupledCells(coupling.as_mut()).respond(&springs, &mut positions, monitor)?;
        let cells = contacts.into_iter().zip(positions).map(|(contacts, x)| SlidingCell::new(contacts, x));
        let mut interface = Self {
            setting,
            motion: SliderMotion::new(equation, cells.collect(), drive, tolerance),
            coupling,
            begun: Stored {
                connection: 0.0,
                coupling: 0.0,
                kinetic: 0.0,
                contacts: ContactEnergies::default(),
            },
            look: MotionSnapshot { time: 0.0, drive, cells: Vec::new() },
            coupling_forces: vec![0.0; number],
            coupling_energy: 0.0,
            slips: Slips::new(areas, slip_fraction, area, mass > 0.0),
            rates: None,
            path: (drive, drive),
        };
        interface.update_coupling(monitor)?;
        interface.look = interface.seen();
        interface.begun = interface.stored();
        Ok(interface)
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.motion.cells.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.motion.cells.is_empty()
    }

    /// Load-point displacement X_T, a length.
    pub fn drive(&self) -> f64 {
        self.motion.drive
    }

    /// Time t since the beginning.
    pub fn time(&self) -> f64 {
        self.motion.time
    }

    /// Position X_j of each cell, a length, row by row.
    pub fn positions(&self) -> Vec<f64> {
        self.motion.cells.iter().map(|cell| cell.position).collect()
    }

    /// Velocity Ẋ_j of each cell, row by row.
    pub fn velocities(&self) -> Vec<f64> {
        self.motion.cells.iter().map(|cell| cell.velocity).collect()
    }

    /// Friction force F_j of each cell, row by row: the force of its contacts, or, of a cell that stands although they would pull it
    /// back, what balances its spring and the coupling. The sum is [`RateDependentInterface::force`].
    pub fn forces(&self) -> Vec<f64> {
        self.frictions().collect()
    }

    fn frictions(&self) -> impl Iterator<Item = f64> {
        let SliderMotion { equation, cells, drive, .. } = &self.motion;
        let cells = cells.iter().zip(&self.coupling_forces).enumerate();
        cells.map(|(j, (cell, &coupling))| equation.friction(j, cell, *drive, coupling))
    }

    /// The attached contacts of a cell as intervals of stretch; [`crate::rate_dependent::binned`] converts them to a density.
    ///
    /// # Errors
    /// A number of no cell.
    pub fn stretches(&self, cell: usize) -> Result<Vec<StretchInterval>> {
        match self.motion.cells.get(cell) {
            Some(cell) => Ok(cell.contacts.stretches()),
            None => Err(Error::invalid("cell", format!("a number below {}", self.len()), cell)),
        }
    }

    /// Friction force ΣF_j of all cells.
    pub fn force(&self) -> f64 {
        self.frictions().sum()
    }

    /// Fraction of detached contacts.
    pub fn free(&self) -> f64 {
        self.mean(|cell| cell.contacts.free())
    }

    /// Breaks since the beginning, per contact.
    pub fn broken(&self) -> f64 {
        self.mean(|cell| cell.energies().broken)
    }

    /// Mean position of the cells, weighted by their areas, a length.
    pub fn mean_position(&self) -> f64 {
        self.mean(|cell| cell.position)
    }

    /// Mean velocity of the cells, weighted by their areas.
    pub fn mean_velocity(&self) -> f64 {
        self.mean(|cell| cell.velocity)
    }

    /// Mean of a value of each cell, weighted by area.
    fn mean(&self, of: impl Fn(&SlidingCell) -> f64) -> f64 {
        let cells = &self.motion.cells;
        let area: f64 = cells.iter().map(|cell| cell.area).sum();
        cells.iter().map(|cell| cell.area * of(cell)).sum::<f64>() / area
    }

    /// The interface at its start with larger tolerances of contacts and steps. The difference of forces at the same drive or time
    /// is an upper estimate of their error. It needs a `coupling` of its own; `None` for contacts that are followed one by one.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub fn rough(&self, coupling: Box<dyn Coupling>, monitor: &mut dyn Monitor) -> Result<Option<Self>> {
        let contacts: Option<Vec<_>> = self.motion.cells.iter().map(|cell| cell.contacts.rough()).collect();
        let tolerance = ROUGH * self.setting.tolerance;
        let setting = RateDependentInterfaceParameters { tolerance, ..self.setting };
        contacts.map(|contacts| Self::new_with(contacts, coupling, setting, monitor)).transpose()
    }

    /// Records the velocities of all cells from now on, at most at this number of steps, 2 or more.
    #[must_use]
    pub fn with_slip_rates(mut self, most: usize) -> Self {
        self.rates = Some(SlipRates::new(most));
        self.record_slip_rates();
        self
    }

    /// The recorded velocities of all cells; `None` unless requested by [`RateDependentInterface::with_slip_rates`].
    pub fn slip_rates(&self) -> Option<&SlipRates> {
        self.rates.as_ref()
    }

    fn record_slip_rates(&mut self) {
        if let Some(rates) = &mut self.rates {
            let SliderMotion { time, drive, ref cells, .. } = self.motion;
            rates.add(time, drive, cells.iter().map(|cell| cell.velocity));
        }
    }

    /// A catalogue of events as columns of shape (events,), those of `events.csv`.
    pub fn record(&self, events: &[Event]) -> Record {
        event::record(events, self.slips.area)
    }

    /// Energies since the beginning; `slip` is the energy dissipated by viscous drag, ∫Σ ηẊ_j² dt, also between slips, and
    /// by cells that come to rest.
    pub fn energy(&self) -> EnergyBalance {
        let (begun, now) = (self.begun, self.stored());
        EnergyBalance {
            work: self.motion.energies.work,
            spring: now.connection - begun.connection,
            coupling: now.coupling - begun.coupling,
            kinetic: now.kinetic - begun.kinetic,
            elastic: now.contacts.elastic - begun.contacts.elastic,
            strengthening: now.contacts.strengthening - begun.contacts.strengthening,
            breaks: now.contacts.lost - begun.contacts.lost,
            slip: self.motion.energies.viscous.iter().sum::<f64>() + self.motion.energies.arrest,
            background: now.contacts.sliding - begun.contacts.sliding,
            ..EnergyBalance::default()
        }
    }

    /// Raises the load-point displacement to `drive` at a velocity, and passes each event that has ended, with the cells that
    /// slipped in it, to `each`.
    ///
    /// # Errors
    /// A drive that is not finite; a velocity that is not above 0; an accuracy that steps do not reach.
    pub fn run(&mut self, drive: f64, velocity: f64, each: &mut dyn FnMut(&Event, &[Slipped])) -> Result<()> {
        self.run_with(drive, velocity, &mut (), each)
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::run`]; stopped by the monitor: the interface is then between two steps, and can continue.
    pub fn run_with(
        &mut self,
        drive: f64,
        velocity: f64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(&Event, &[Slipped]),
    ) -> Result<()> {
        loop {
            let events = self.next_with(drive, velocity, monitor)?;
            if events.is_empty() {
                return Ok(());
            }
            events.iter().for_each(|(event, slipped)| each(event, slipped));
        }
    }

    /// Raises the load-point displacement to `drive` at a velocity, or until events have ended. Returns these, each with the
    /// cells that slipped in it; none if `drive` was reached. Events that have not ended continue in the next run.
    ///
    /// # Errors
    /// As [`RateDependentInterface::run`].
    pub fn next(&mut self, drive: f64, velocity: f64) -> Result<Vec<(Event, Vec<Slipped>)>> {
        self.next_with(drive, velocity, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::next`]; stopped by the monitor.
    pub fn next_with(
        &mut self,
        drive: f64,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<(Event, Vec<Slipped>)>> {
        finite("drive", drive)?;
        positive("velocity", velocity)?;
        if self.path.1 != drive {
            self.path = (self.motion.drive, drive);
        }
        while self.motion.drive < drive {
            let fraction = self.fraction();
            self.go(drive, velocity, &mut Aside { fraction, monitor })?;
            let events = self.slips.take_ended();
            if !events.is_empty() {
                return Ok(events);
            }
        }
        report(monitor, 1.0)?;
        Ok(Vec::new())
    }

    /// Moves the load point along `segment` until the time `until`, or until events have ended. Returns these, each with the
    /// cells that slipped in it; none if `until` was reached. Events that have not ended continue in the next call.
    ///
    /// # Errors
    /// A velocity below 0; an accuracy that steps do not reach; stopped by the monitor.
    pub fn follow_with(
        &mut self,
        segment: &LoadPointSegment,
        until: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<(Event, Vec<Slipped>)>> {
        not_negative("velocity", segment.velocity)?;
        let from = self.motion.time;
        while self.motion.time < until {
            let fraction = (self.motion.time - from) / (until - from);
            let left = until - self.motion.time;
            let taken = self.step(segment.velocity, left, &mut Aside { fraction, monitor })?;
            if taken >= left {
                self.motion.time = until;
            }
            // From the beginning of the segment, so that rounding errors of steps do not add up.
            self.motion.drive = segment.at(self.motion.time);
            self.observe(segment.pulled)?;
            let events = self.slips.take_ended();
            if !events.is_empty() {
                return Ok(events);
            }
        }
        report(monitor, 1.0)?;
        Ok(Vec::new())
    }

    /// Events that have ended, but not been returned because an earlier one has not: the last ones of a motion.
    pub fn last_events(&mut self) -> Vec<(Event, Vec<Slipped>)> {
        self.slips.take_all_ended()
    }

    /// Number of events that have not ended.
    pub fn unfinished_events(&self) -> usize {
        self.slips.unfinished()
    }

    /// Fraction of the present run that is done.
    fn fraction(&self) -> f64 {
        let (from, to) = self.path;
        ((self.motion.drive - from) / (to - from)).clamp(0.0, 1.0)
    }

    /// Makes one step in time, at most up to `drive`.
    fn go(&mut self, drive: f64, velocity: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let left = (drive - self.motion.drive) / velocity;
        if self.step(velocity, left, monitor)? >= left {
            self.motion.drive = drive;
        }
        self.observe(velocity)
    }

    /// Makes one step of at most `left`, with the load point at a velocity. Returns its duration.
    fn step(&mut self, velocity: f64, left: f64, monitor: &mut dyn Monitor) -> Result<f64> {
        self.motion.step(&mut CoupledCells(self.coupling.as_mut()), velocity, left, monitor)
    }

    /// Finds the events after a step; slips are ten times as fast as `pulled`.
    fn observe(&mut self, pulled: f64) -> Result<()> {
        // The step is made: it is not stopped any more, and each of its stages took several such products.
        self.update_coupling(&mut ())?;
        let now = self.seen();
        // Events are found between two snapshots, so that the stages of a step, which may be
        // rejected, need not know of them.
        let before = std::mem::replace(&mut self.look, now);
        self.slips.pass(&before, &self.look, pulled, self.coupling.as_ref());
        self.record_slip_rates();
        Ok(())
    }

    /// A snapshot of the cells.
    fn seen(&self) -> MotionSnapshot {
        let SliderMotion { equation, cells, energies, time, drive, .. } = &self.motion;
        let seen = |(j, (cell, &viscous)): (usize, (&SlidingCell, &f64))| {
            let ContactEnergies { lost, broken, .. } = cell.energies();
            let &SlidingCell { position, velocity, .. } = cell;
            let coupling = self.coupling_forces[j];
            let acceleration = equation.acceleration(j, cell, *drive, coupling);
            let force = equation.friction(j, cell, *drive, coupling);
            let speed = equation.speed(j, cell, acceleration);
            Seen { position, velocity, speed, force, lost, broken, viscous }
        };
        let cells = cells.iter().zip(&energies.viscous).enumerate().map(seen).collect();
        MotionSnapshot { time: *time, drive: *drive, cells }
    }

    fn update_coupling(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        let positions = self.positions();
        self.coupling.forces(&positions, &mut self.coupling_forces, monitor)?;
        self.coupling_energy = self.coupling.energy(&positions, &self.coupling_forces);
        Ok(())
    }

    /// Stored energies at present.
    fn stored(&self) -> Stored {
        let (positions, SliderMotion { equation, drive, .. }) = (self.positions(), &self.motion);
        let cells = &self.motion.cells;
        let spring = |j: usize| 0.5 * equation.connection(j, &cells[j]) * (drive - positions[j]).powi(2);
        let add = |sum: ContactEnergies, cell: &SlidingCell| {
            let energies = cell.energies();
            ContactEnergies {
                elastic: sum.elastic + energies.elastic,
                lost: sum.lost + energies.lost,
                strengthening: sum.strengthening + energies.strengthening,
                sliding: sum.sliding + energies.sliding,
                broken: sum.broken + cell.area * energies.broken,
            }
        };
        Stored {
            connection: (0..positions.len()).map(spring).sum(),
            coupling: self.coupling_energy,
            kinetic: self.motion.cells.iter().map(|cell| equation.kinetic(cell)).sum(),
            contacts: self.motion.cells.iter().fold(ContactEnergies::default(), add),
        }
    }
}

/// Refuses cells of which not all slide at the same velocity, to rounding of scaled lengths.
fn moves_together(contacts: &[Box<dyn RateDependentContacts>]) -> Result<()> {
    const SAME: f64 = 1e-12;
    let velocity = |contacts: &dyn RateDependentContacts| contacts.steady_velocity().unwrap_or(0.0);
    let Some(first) = contacts.first().map(|first| velocity(first.as_ref())) else { return Ok(()) };
    let other = contacts
        .iter()
        .map(|contacts| velocity(contacts.as_ref()))
        .find(|other| (other - first).abs() > SAME * first.abs().max(other.abs()));
    match other {
        None => Ok(()),
        Some(other) => Err(Error::invalid("cells", format!("all cells at the velocity {first}"), other)),
    }
}
