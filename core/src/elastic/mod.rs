//! A deformable interface: cells with contacts of their own, coupled by the elasticity of the slider.
//!
//! Cell j is at X_j. Its contacts hold it by the force F_j, a spring K_0j pulls it to the drive X_T, and the slider couples it
//! to the others by a stiffness matrix A. In balance
//!
//! K_0j(X_T − X_j) − (AX)_j = F_j.
//!
//! Cells may have areas a_j ([`CellAreas`]), in units of the cell that is described; contacts, K_0 and viscosity of a cell are
//! proportional to its area.
//!
//! As X_T rises slowly the cells creep in balance, as long as the matrix F_j' δ_ij + K_0j δ_ij + A_ij is positive definite.
//! Where that is lost, or contacts break together, cells slide at fixed X_T by the rule [`CellSlip`], until there is balance
//! again. Cells move forward only, and a cell that advances pushes every other one forward. Hence no cell passes the nearest
//! balance ahead, and every sequence of such moves ends there ("no passing": A. A. Middleton, Phys. Rev. Lett. 68, 670
//! (1992), doi:10.1103/PhysRevLett.68.670).
//!
//! The parts: a `configuration` and the `state` with it are plain data; the `residual` is what is out of balance there;
//! `newton`, `uniform_stiffness` and `fold_prediction` are the solvers; `creep` and `slide` apply them; the `catalogue` makes
//! events of a slide. [`Interface`] joins them.

mod batch;
mod catalogue;
pub mod cells;
mod configuration;
pub mod coupling;
mod creep;
mod energy;
mod event;
mod first;
mod fold_prediction;
mod newton;
mod parameters;
pub mod rate_dependent;
mod residual;
mod slide;
mod state;
mod stepper;
mod uniform_stiffness;

pub use catalogue::front;
pub use cells::{CellAreas, Cells, Curves, Populations, Standing};
pub use coupling::Coupling;
pub use event::{Event, Slipped};
pub use parameters::{CellLoading, CellSlip, InterfaceParameters};
pub use rate_dependent::{
    RateDependentInterface, RateDependentInterfaceParameters, RateDependentInterfaceState, SlipRates,
};
pub use state::State;

pub use crate::energy::EnergyBalance;

use self::batch::sum;
use self::catalogue::FinishedSlide;
use self::configuration::{Advances, Configuration};
use self::creep::{CreepPace, Stride};
use self::energy::EnergyBudget;
use self::parameters::DriveSprings;
use self::residual::InterfaceModel;
use self::slide::SlideRecord;
use crate::error::finite;
use crate::monitor::{Aside, Cost, Monitor, report};
use crate::rate_dependent::StretchInterval;
use crate::record::Record;
use crate::{Error, Result};

/// A deformable interface over time-independent contacts, driven quasistatically: cells on an elastic slider.
///
/// Forces and energies are totals over the cells, in the units of the populations of which the cells are made. Cells that
/// share a curve take up to 120 bytes each during a slide, 24 more on a stiff slider, with the coupling: 2 GB for 4096² under
/// a periodic half-space.
///
/// ```
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// use asperity::elastic::coupling::neighbours;
/// use asperity::elastic::{Curves, Interface, InterfaceParameters};
/// use asperity::master::MasterEquation;
/// use asperity::shape::{Edges, Shape};
///
/// let population = MasterEquation::new(contacts, &Initial::default())?.population()?;
/// let cells = Curves::new(&population, 8)?.scaled((0..8).map(|j| 1.0 + 0.02 * f64::from(j)).collect())?;
/// let coupling = neighbours(Shape::Chain(8), Edges::Open, 1.0)?;
/// let mut chain = Interface::new(Box::new(cells), coupling, InterfaceParameters::new(0.5, 1e-6))?;
/// let mut slipped_cells = 0;
/// chain.run(3.0, &mut |_, slipped| slipped_cells += slipped.len())?;
/// assert!(slipped_cells >= 8 && chain.drive() == 3.0);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug)]
pub struct Interface {
    model: InterfaceModel,
    parameters: InterfaceParameters,
    configuration: Configuration,
    pace: CreepPace,
    energy: EnergyBudget,
    /// Drive at the beginning of the present run, and at its end.
    path: (f64, f64),
}

impl Interface {
    /// The interface in balance: contacts keep the stretches of their populations, and the mean position of the cells that the drive
    /// pulls, weighted by their areas, is 0.
    ///
    /// # Errors
    /// Parameters that are not finite and above 0; another number of cells than that of the coupling; those of the cells.
    pub fn new(
        cells: Box<dyn Cells>,
        coupling: Box<dyn Coupling>,
        parameters: InterfaceParameters,
    ) -> Result<Self> {
        Self::new_with(cells, coupling, parameters, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Interface::new`]; stopped by the monitor.
    pub fn new_with(
        cells: Box<dyn Cells>,
        coupling: Box<dyn Coupling>,
        parameters: InterfaceParameters,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        parameters.check()?;
        let (number, shape) = (cells.len(), coupling.shape());
        if number != shape.size() {
            return Err(Error::invalid("cells", format!("{} of them, as coupled", shape.size()), number));
        }
        let springs = DriveSprings::new(&parameters, shape, cells.areas());
        let mut model = InterfaceModel { cells, coupling, springs, residuals: 0 };
        let configuration = model.initial_balance(monitor)?;
        Ok(Self {
            energy: EnergyBudget::new(&mut model, &configuration, monitor)?,
            model,
            parameters,
            configuration,
            pace: CreepPace::new(parameters.drive_tolerance),
            path: (0.0, 0.0),
        })
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.configuration.positions.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.configuration.positions.is_empty()
    }

    /// Load-point displacement X_T, a length.
    pub fn drive(&self) -> f64 {
        self.configuration.drive
    }

    /// Time t that slides have taken so far; 0 without viscosity.
    pub fn time(&self) -> f64 {
        self.configuration.time
    }

    /// Position X_j of each cell, a length, row by row.
    pub fn positions(&self) -> &[f64] {
        &self.configuration.positions
    }

    /// Mean position of the cells, weighted by their areas, a length.
    pub fn mean_position(&self) -> f64 {
        self.model.springs.areas().mean(self.positions())
    }

    /// Areas a_j of the cells.
    pub fn areas(&self) -> &CellAreas {
        self.model.springs.areas()
    }

    /// Friction force F_j of each cell, row by row; their sum is [`Interface::force`].
    pub fn forces(&self) -> Vec<f64> {
        self.model.contact_forces()
    }

    /// Friction force ΣF_j of all cells.
    pub fn force(&self) -> f64 {
        self.model.force()
    }

    /// Place of a cell on the friction curve that all cells share; `None` if each cell has a curve of its own.
    ///
    /// # Errors
    /// A number of no cell.
    pub fn standing(&self, cell: usize) -> Result<Option<Standing>> {
        self.has(cell)?;
        Ok(self.model.cells.standing(cell))
    }

    /// Stretches of the attached contacts of a cell, if contacts are simulated one by one. `None` if they are a distribution,
    /// which follows from [`Interface::standing`].
    ///
    /// # Errors
    /// A number of no cell; those of the cells.
    pub fn stretches(&self, cell: usize) -> Result<Option<Vec<StretchInterval>>> {
        self.has(cell)?;
        let intervals = |stretches: Vec<f64>| {
            let fraction = 1.0 / stretches.len() as f64;
            // Stretches of contacts that have just re-formed may be below 0 by rounding.
            let at =
                |stretch: f64| StretchInterval { low: stretch.max(0.0), high: stretch.max(0.0), fraction };
            stretches.into_iter().map(at).collect()
        };
        Ok(self.model.cells.stretches(cell)?.map(intervals))
    }

    /// Refuses a number of no cell.
    fn has(&self, cell: usize) -> Result<()> {
        if cell < self.len() {
            return Ok(());
        }
        Err(Error::invalid("cell", format!("a number below {}", self.len()), cell))
    }

    /// The energy balance since the beginning, summed over the cells.
    pub fn energy(&self) -> EnergyBalance {
        self.energy.total
    }

    /// Breaks since the beginning, per contact.
    pub fn broken(&self) -> f64 {
        self.model.cells.energies().broken / self.areas().total(self.len())
    }

    /// Estimated error of the force of a cell, the largest so far; 0 if contacts are simulated one by one.
    pub fn error(&self) -> f64 {
        self.model.cells.error()
    }

    /// A catalogue of events as columns of shape (events,), those of `events.csv`.
    pub fn record(&self, events: &[Event]) -> Record {
        event::record(events, self.parameters.area)
    }

    /// Sets the load-point displacement X_T to `drive`, and moves each cell forward along its curve to its position X_j, row by
    /// row. The energy balance starts again from 0. Cells that are out of balance slide at the beginning of the next run.
    ///
    /// # Errors
    /// A drive that is not finite; another number of positions than of cells; a position behind the present one of its cell;
    /// those of the cells.
    pub fn put(&mut self, drive: f64, positions: &[f64]) -> Result<()> {
        self.put_with(drive, positions, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Interface::put`]; stopped by the monitor: nothing has moved then.
    pub fn put_with(&mut self, drive: f64, positions: &[f64], monitor: &mut dyn Monitor) -> Result<()> {
        finite("drive", drive)?;
        if positions.len() != self.len() {
            let expected = format!("a position for each of the {} cells", self.len());
            return Err(Error::invalid("positions", expected, positions.len()));
        }
        let here = &self.configuration.positions;
        let forward = |j: usize| positions[j].is_finite() && positions[j] >= here[j];
        if let Some(cell) = (0..self.len()).find(|&j| !forward(j)) {
            let expected = format!("no less than {} for cell {cell}: cells move forward", here[cell]);
            return Err(Error::invalid("positions", expected, positions[cell]));
        }
        let by: Vec<f64> = positions.iter().zip(here).map(|(to, from)| to - from).collect();
        let mut there = self.configuration.clone();
        let advances = Advances::new(by);
        there.advance(&advances);
        there.drive = drive;
        let coupling = self.model.coupling_energy(&there, monitor)?;
        self.model.cells.advance(&advances.by, monitor)?;
        self.configuration = there;
        self.energy = EnergyBudget::begun(&self.model, &self.configuration, coupling);
        self.pace = CreepPace::new(self.parameters.drive_tolerance);
        Ok(())
    }

    /// Raises the load-point displacement to `drive`, and passes each event, with the cells that slipped in it, to `each`.
    ///
    /// # Errors
    /// A drive that is not finite; those of the cells.
    pub fn run(&mut self, drive: f64, each: &mut dyn FnMut(&Event, &[Slipped])) -> Result<()> {
        self.run_with(drive, &mut (), each)
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::run`]; stopped by the monitor: the interface is then between two slides, and can continue.
    pub fn run_with(
        &mut self,
        drive: f64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(&Event, &[Slipped]),
    ) -> Result<()> {
        loop {
            let events = self.next_with(drive, monitor)?;
            if events.is_empty() {
                return report(monitor, 1.0);
            }
            events.iter().for_each(|(event, slipped)| each(event, slipped));
        }
    }

    /// Raises the load-point displacement to `drive`, or through the next slide in which cells slip. Returns the events of the
    /// slide, each with the cells that slipped in it; none if `drive` was reached.
    ///
    /// # Errors
    /// As [`Interface::run`].
    pub fn next(&mut self, drive: f64) -> Result<Vec<(Event, Vec<Slipped>)>> {
        self.next_with(drive, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::next`]; stopped by the monitor.
    pub fn next_with(&mut self, drive: f64, monitor: &mut dyn Monitor) -> Result<Vec<(Event, Vec<Slipped>)>> {
        finite("drive", drive)?;
        if self.path.1 != drive {
            self.path = (self.configuration.drive, drive);
        }
        self.next_on_path(drive, monitor, &mut |_| ())
    }

    /// The same on the present path. `observe` sees the interface before and after every slide, and where the drive is
    /// reached.
    fn next_on_path(
        &mut self,
        drive: f64,
        monitor: &mut dyn Monitor,
        observe: &mut dyn FnMut(&Self),
    ) -> Result<Vec<(Event, Vec<Slipped>)>> {
        let residual = self.model.residual(&self.configuration, &mut self.aside(monitor))?.largest;
        // Cells put somewhere by hand, or in a restored state, may be out of balance: then the run
        // begins with a slide.
        let mut lost = residual > self.model.creep_tolerance(&self.configuration, self.configuration.drive);
        loop {
            monitor.cost(Cost::Residuals, std::mem::take(&mut self.model.residuals));
            if lost {
                let events = self.slide(monitor)?;
                observe(self);
                if !events.is_empty() {
                    return Ok(events);
                }
            }
            if self.configuration.drive >= drive {
                let monitor = &mut self.aside(monitor);
                let coupling = self.model.coupling_energy(&self.configuration, monitor)?;
                self.energy.add_creep(&self.model, &self.configuration, coupling);
                return Ok(Vec::new());
            }
            report(monitor, self.fraction())?;
            lost = self.creep(drive, &mut self.aside(monitor))?;
            if lost || self.configuration.drive >= drive {
                observe(self);
            }
        }
    }

    /// A monitor of what is done while the drive stands.
    fn aside<'a>(&self, monitor: &'a mut dyn Monitor) -> Aside<'a> {
        Aside { fraction: self.fraction(), monitor }
    }

    /// How much of the present run is done.
    fn fraction(&self) -> f64 {
        let (from, to) = self.path;
        if to > from { ((self.configuration.drive - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Makes a stride in balance towards a drive; whether balance is lost at its end, where the drive alone has gone. Where the
    /// monitor stops it all is as before.
    fn creep(&mut self, drive: f64, monitor: &mut dyn Monitor) -> Result<bool> {
        let Self { model, configuration, pace, energy, .. } = self;
        // Curves that a stopped stride has extended are not known afterwards, so that the next one begins as this one did.
        let before = *pace;
        model.cells.mark_curves();
        let stride = model.creep(configuration, pace, drive, monitor);
        // Where balance is lost nothing has moved: a stop while the energy is computed undoes this stride, too.
        let lost = stride.and_then(|stride| match stride {
            Stride::Balanced => Ok(None),
            Stride::Lost(drive) => Ok(Some((drive, model.coupling_energy(configuration, monitor)?))),
        });
        let lost = lost.inspect_err(|_| {
            model.cells.recall_curves();
            *pace = before;
        })?;
        let Some((drive, coupling)) = lost else { return Ok(false) };
        energy.add_creep(model, configuration, coupling);
        let from = std::mem::replace(&mut configuration.drive, drive);
        energy.add_drive(model, configuration, from);
        Ok(true)
    }

    /// Slides to the next balance at this drive. Where the monitor stops it all is as before.
    fn slide(&mut self, monitor: &mut dyn Monitor) -> Result<Vec<(Event, Vec<Slipped>)>> {
        let monitor = &mut self.aside(monitor);
        let Self { model, configuration, energy, .. } = self;
        let mut slide = SlideRecord::new(model, self.parameters, configuration);
        // A slide is made in place; the mark allows undoing it without a copy of the contacts.
        model.cells.mark();
        let (pulls, coupling) = match slide.whole(model, configuration, monitor) {
            Ok(found) => found,
            Err(error) => {
                model.cells.recall(monitor)?;
                *configuration = slide.before;
                return Err(error);
            }
        };
        model.cells.reattach();
        let (force, dissipated) = (model.force(), slide.dissipated(model, &configuration.positions, &pulls));
        // Pulls are linear in positions. The drive has gone beyond the last balance by the tolerance at most, and with the pull at
        // its place before and after the slide the drop is that at a fixed drive.
        let forces = [2.0 * sum(pulls.len(), |cell| pulls[cell]) - force, force];
        let finished = FinishedSlide { slide: &slide, model, after: configuration, pulls: &pulls, forces };
        let events = finished.events();
        model.cells.unmark();
        energy.add_slide(model, configuration, coupling, dissipated);
        if self.parameters.viscosity.is_some() {
            configuration.time += slide.over;
        }
        Ok(events)
    }
}
