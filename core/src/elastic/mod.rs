//! A deformable interface: cells with contacts of their own, coupled by the elasticity of the slider.
//!
//! Cell j is at X_j, its contacts hold it by F_j, springs K_0j pull it to the drive X_T, and the slider pulls it to the
//! others by a stiffness matrix A. In balance
//!
//! K_0j(X_T − X_j) − (AX)_j = F_j.
//!
//! As X_T rises slowly the cells creep in balance, as long as the matrix F_j' δ_ij + K_0j δ_ij + A_ij is positive
//! definite. Where that is lost, or contacts break together, cells slide on at fixed X_T by the rule [`Slip`], until
//! there is balance again. Cells move forward only, and a cell that advances pushes every other one forward: so the
//! state they come to is the nearest one in balance ahead of them, however they go there (A. A. Middleton, Phys. Rev.
//! Lett. 68, 670 (1992), doi:10.1103/PhysRevLett.68.670).

mod balance;
mod batch;
mod catalogue;
pub mod cells;
pub mod coupling;
mod creep;
mod differences;
mod energy;
mod event;
mod first;
mod fold_prediction;
pub mod rate_dependent;
mod slide;
mod solve;
mod state;
mod uniform_stiffness;

pub use cells::{Cells, Curves, Populations, Standing};
pub use coupling::Coupling;
pub use energy::Energy;
pub use event::{Event, Slipped};
pub use rate_dependent::{
    RateDependentInterface, RateDependentInterfaceParameters, RateDependentInterfaceState,
};
pub use state::State;

use self::batch::change;
use self::creep::CreepPace;
use self::differences::Differences;
use self::energy::StoredEnergy;
use crate::monitor::{Monitor, report};
use crate::rate_dependent::StretchInterval;
use crate::record::Record;
use crate::{Error, Result};

/// Which cells are connected to the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Loading {
    /// All.
    #[default]
    Uniform,
    /// The first row of a lattice, the first cell of a chain.
    Edge,
}

/// What a cell does that loses its balance, at fixed X_T.
///
/// A cell loses its balance where it moves down a slope F_j' < −ΣK_0i/n, which the connection of all n cells together would
/// not hold, having moved farther than [`InterfaceParameters::drive_tolerance`]; or where contacts break together. By `Reset`, and
/// where contacts broke together, it has slipped then. Else it has if it goes farther than creep may within the tolerance
/// δ of the drive, near a fold some √(δℓ) with the length ℓ on which slopes change, and no less than a tenth as far as the
/// cell that goes farthest: others have been pulled along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slip {
    /// All contacts of a cell that slips break where it begins to, and re-form where the slide ends; until then it is
    /// held by the force alone that they will have there.
    Reset,
    /// Cells go on to the next state in balance, contacts breaking and re-forming on the way.
    Overdamped,
}

/// How an interface is driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterfaceParameters {
    /// K_0, stiffness of the spring from a cell to the drive, force per length.
    pub connection: f64,
    /// Which cells have one.
    pub loading: Loading,
    /// What a cell does that loses its balance.
    pub slip: Slip,
    /// η, force on a cell per velocity, in slides: they then take their time, the drive waiting. Without it slides have
    /// the same ends, and no duration.
    pub viscosity: Option<f64>,
    /// A length: where balance is lost is found to this accuracy of the drive.
    pub drive_tolerance: f64,
    /// Area of a cell; `None` where areas are counted in cells.
    pub area: Option<f64>,
}

impl InterfaceParameters {
    /// Checks the numbers; keys are those of the table `[interface]`.
    fn check(&self) -> Result<()> {
        let viscosity = self.viscosity.unwrap_or(1.0);
        let tolerance = self.drive_tolerance;
        for (key, value) in [
            ("connection", self.connection),
            ("viscosity", viscosity),
            ("drive_tolerance", tolerance),
            ("area", self.area.unwrap_or(1.0)),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::invalid(key, "a finite number above 0", value));
            }
        }
        Ok(())
    }
}

/// Cells on an elastic slider.
///
/// Forces and energies are totals over the cells, in the units of the populations of which the cells are made. Cells that
/// share a curve take up to 110 bytes each where they slide, 24 more on a stiff slider, and what couples them: 2 GB for
/// 4096² under a periodic half-space.
pub struct Interface {
    cells: Box<dyn Cells>,
    coupling: Box<dyn Coupling>,
    setting: InterfaceParameters,
    /// Cells that are connected to the drive: those of a number below this.
    connected: usize,
    drive: f64,
    time: f64,
    positions: Vec<f64>,
    /// What positions do not tell of a stiff slider.
    differences: Option<Differences>,
    /// Advances that are tried from there.
    by: Vec<f64>,
    /// Forces out of balance after the advances that were last asked for; a step leaves something else.
    excess: Vec<f64>,
    /// F_j' there, and what is made of it to find a response.
    springs: Vec<f64>,
    pace: CreepPace,
    energy: Energy,
    closed: StoredEnergy,
    /// Where the present run began, and its end.
    path: (f64, f64),
}

impl Interface {
    /// Cells in balance where their populations stand, at a mean position of 0.
    ///
    /// # Errors
    /// Numbers of the setting that are not finite and above 0; another number of cells than the coupling is for; those
    /// of the cells.
    pub fn new(
        cells: Box<dyn Cells>,
        coupling: Box<dyn Coupling>,
        setting: InterfaceParameters,
    ) -> Result<Self> {
        setting.check()?;
        let (number, shape) = (cells.len(), coupling.shape());
        if number != shape.size() {
            return Err(Error::invalid("cells", format!("{} of them, as coupled", shape.size()), number));
        }
        let connected = match setting.loading {
            Loading::Uniform => number,
            Loading::Edge => shape.first_row(),
        };
        let mut interface = Self {
            cells,
            coupling,
            setting,
            connected,
            drive: 0.0,
            time: 0.0,
            positions: vec![0.0; number],
            differences: None,
            by: vec![0.0; number],
            excess: vec![0.0; number],
            springs: vec![0.0; number],
            pace: CreepPace::new(setting.drive_tolerance),
            energy: Energy::default(),
            closed: StoredEnergy::default(),
            path: (0.0, 0.0),
        };
        interface.refine();
        interface.begin()?;
        Ok(interface)
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// X_T.
    pub fn drive(&self) -> f64 {
        self.drive
    }

    /// Time that slides have taken so far; 0 without viscosity.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// X_j, along rows.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// F_j of each cell, along rows; their sum is [`Interface::force`].
    ///
    /// # Errors
    /// Those of the cells.
    pub fn forces(&mut self) -> Result<Vec<f64>> {
        let mut forces = vec![0.0; self.len()];
        self.cells.resist(&self.by, &mut forces, &mut self.springs)?;
        change(&mut forces, |_, force| 0.0 - force);
        Ok(forces)
    }

    /// Where a cell is on the curve that it shares with others; none where it has contacts of its own.
    ///
    /// # Errors
    /// A number of no cell.
    pub fn standing(&self, cell: usize) -> Result<Option<Standing>> {
        self.has(cell)?;
        Ok(self.cells.standing(cell))
    }

    /// The contacts of a cell by their stretches, where they are followed one by one; none where they are a distribution,
    /// that of where the cell is standing.
    ///
    /// # Errors
    /// A number of no cell. Those of the cells.
    pub fn stretches(&self, cell: usize) -> Result<Option<Vec<StretchInterval>>> {
        self.has(cell)?;
        let portions = |stretches: Vec<f64>| {
            let share = 1.0 / stretches.len() as f64;
            // Those just re-formed may lie below 0 by rounding.
            let at = |stretch: f64| StretchInterval { low: stretch.max(0.0), high: stretch.max(0.0), share };
            stretches.into_iter().map(at).collect()
        };
        Ok(self.cells.stretches(cell)?.map(portions))
    }

    /// Refuses a number of no cell.
    fn has(&self, cell: usize) -> Result<()> {
        if cell < self.len() {
            return Ok(());
        }
        Err(Error::invalid("cell", format!("a number below {}", self.len()), cell))
    }

    /// Friction force of all cells.
    ///
    /// # Errors
    /// Those of the cells.
    pub fn force(&mut self) -> Result<f64> {
        self.excess.fill(0.0);
        self.cells.resist(&self.by, &mut self.excess, &mut self.springs)?;
        Ok(0.0 - batch::sum(self.len(), |j| self.excess[j]))
    }

    /// Energies since the beginning.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    /// Breaks since the beginning, per contact.
    pub fn broken(&self) -> f64 {
        self.cells.account().broken / self.len() as f64
    }

    /// Estimated error of the force of a cell, the largest so far; 0 where contacts are followed one by one.
    pub fn error(&self) -> f64 {
        self.cells.error()
    }

    /// A catalogue as columns, those of `events.csv`.
    pub fn record(&self, events: &[Event]) -> Record {
        event::record(events, self.setting.area)
    }

    /// Puts the drive somewhere and moves each cell forward to a position of its own, along its curve. Energies begin at 0.
    /// Cells that are out of balance slide first thing in the next run.
    ///
    /// # Errors
    /// Another number of positions than of cells, or one behind that of its cell; those of the cells.
    pub fn put(&mut self, drive: f64, positions: &[f64]) -> Result<()> {
        if positions.len() != self.len() {
            let expected = format!("a position for each of the {} cells", self.len());
            return Err(Error::invalid("positions", expected, positions.len()));
        }
        let forward = |j: usize| positions[j].is_finite() && positions[j] >= self.positions[j];
        if let Some(cell) = (0..self.len()).find(|&j| !forward(j)) {
            let expected =
                format!("no less than {} for cell {cell}: cells move forward", self.positions[cell]);
            return Err(Error::invalid("positions", expected, positions[cell]));
        }
        for (by, (to, from)) in self.by.iter_mut().zip(positions.iter().zip(&self.positions)) {
            *by = to - from;
        }
        self.commit(&mut ())?;
        self.drive = drive;
        (self.energy, self.closed) = (Energy::default(), self.stored());
        self.pace = CreepPace::new(self.setting.drive_tolerance);
        Ok(())
    }

    /// Drives the cells up to `drive`, and tells `each` event and the cells that slipped in it.
    ///
    /// # Errors
    /// Stopped by the monitor: the interface is then between two slides, and can go on. Those of the cells.
    pub fn run(
        &mut self,
        drive: f64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(&Event, &[Slipped]),
    ) -> Result<()> {
        loop {
            let events = self.next(drive, monitor)?;
            if events.is_empty() {
                return report(monitor, 1.0);
            }
            events.iter().for_each(|(event, slipped)| each(event, slipped));
        }
    }

    /// Drives the cells up to `drive`, or through the next slide in which cells slip: its events, each with the cells
    /// that slipped in it; none if the drive was reached.
    ///
    /// # Errors
    /// See [`Interface::run`].
    pub fn next(&mut self, drive: f64, monitor: &mut dyn Monitor) -> Result<Vec<(Event, Vec<Slipped>)>> {
        if self.path.1 != drive {
            self.path = (self.drive, drive);
        }
        self.go(drive, monitor, &mut |_| ())
    }

    /// The same on a path that is known, shown to `look` before and after every slide and where the drive is reached.
    fn go(
        &mut self,
        drive: f64,
        monitor: &mut dyn Monitor,
        look: &mut dyn FnMut(&Self),
    ) -> Result<Vec<(Event, Vec<Slipped>)>> {
        let mut lost = self.excess_here()? > self.calm();
        loop {
            if lost {
                let events = self.slide(monitor)?;
                look(self);
                if !events.is_empty() {
                    return Ok(events);
                }
            }
            if self.drive >= drive {
                self.enter_creep();
                return Ok(Vec::new());
            }
            self.tell(monitor)?;
            lost = self.creep(drive)?;
            if lost || self.drive >= drive {
                look(self);
            }
        }
    }

    /// Tells the monitor how far the drive is on its way.
    fn tell(&self, monitor: &mut dyn Monitor) -> Result<()> {
        let (from, to) = self.path;
        report(monitor, if to > from { ((self.drive - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 })
    }

    /// K_0j of each cell.
    fn connections(&self) -> impl Fn(usize) -> f64 + Copy + use<> {
        let (connected, connection) = (self.connected, self.setting.connection);
        move |cell| if cell < connected { connection } else { 0.0 }
    }

    /// K_0j.
    fn connection(&self, cell: usize) -> f64 {
        self.connections()(cell)
    }

    /// ΣK_0j per cell.
    fn mean_connection(&self) -> f64 {
        self.setting.connection * self.connected as f64 / self.len() as f64
    }
}
