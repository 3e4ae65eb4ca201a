//! Contacts on a lattice coupled one by one, which break in avalanches: the Olami–Feder–Christensen
//! automaton.

mod avalanche;
mod births;
mod clocks;
mod coupling;
mod first;
mod generation;
mod grid;
mod minima;
mod motion;
mod state;
mod thermal;

pub use avalanche::{Avalanche, record, record_in_time};
use avalanche::{OngoingAvalanche, OngoingGeneration};
pub use coupling::LatticeCoupling;
pub use state::LatticeState;

pub use crate::shape::{Edges, Shape};

use self::births::{BirthRecord, LatticeBirths};
use self::clocks::{Athermal, Clocks, Timekeeping};
use self::grid::ContactGrid;
use self::minima::Minima;
use super::{Disorder, Ensemble};
use crate::contacts::{Contacts, Initial, Stiffness};
use crate::monitor::{Aside, Monitor, Watch, fits, report};
use crate::numerics::compensated::Compensated;
use crate::{Error, Result};

/// Bytes per site: the state of its contact, drawing it, and an avalanche of all contacts.
const BYTES: u64 = 72;

/// Contacts drawn together by one thread.
const CHUNK: usize = 1 << 12;

/// Distance in mean thresholds within which contacts break simultaneously: some tens of roundings, by which
/// equal contacts with equal histories differ, and so little that it joins others once in 10⁷ avalanches of
/// 10⁶ contacts.
const TOGETHER: f64 = 1e-13;

/// Avalanches between two reports to the monitor.
const REPORT: u64 = 1 << 10;

/// Breaks between two questions to the monitor whether to stop, some milliseconds.
const ASK: usize = 1 << 16;

/// When to stop driving a lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Until {
    /// To this drive X, counted from the start of all.
    Drive(f64),
    /// For so many more avalanches.
    Events(u64),
    /// To this time, counted from the start of all; of a lattice at a velocity only.
    Time(f64),
}

/// Contacts of equal stiffness k, each connected by springs to the drive and to its neighbours, that re-form
/// only after the slide: the automaton of Z. Olami, H. J. S. Feder and K. Christensen (Phys. Rev. Lett. 68,
/// 1244 (1992), doi:10.1103/PhysRevLett.68.1244) for any distributions of thresholds and re-forming. The
/// original has identical thresholds and R = δ.
///
/// The drive stretches all contacts equally, f = k x → k(x + dX), also for K_0 = 0, until one reaches its
/// threshold k x_s. All contacts at their thresholds break simultaneously, f → k r, and each neighbour gains
/// α(f − k r), α = [`LatticeCoupling::alpha`]. This is one generation; the next one follows until no contact
/// is at its threshold. Stretches r and thresholds are drawn as in the [`Ensemble`]: for α = 0 contacts have
/// the lives of [`Ensemble::pull`].
///
/// *Simultaneous* means within 1e-13 mean thresholds: contacts that are equal up to rounding stay so. In an
/// identical lattice they often are, and its avalanches depend on it (B. Drossel, Phys. Rev. Lett. 89, 238701
/// (2002)).
///
/// The time of an avalanche is proportional to its breaks, for any number of contacts. A contact takes 10
/// bytes, 34 if distributions are not points, and up to 20 more in an avalanche of all contacts. Stretches
/// are right to 1e-15 for any drive.
///
/// ```
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// use asperity::ensemble::Disorder;
/// use asperity::ensemble::lattice::{Lattice, LatticeCoupling, Until};
/// use asperity::shape::{Edges, Shape};
///
/// let coupling = LatticeCoupling {
///     shape: Shape::Square([32, 32]),
///     edges: Edges::Open,
///     neighbours: 1.0,
///     connection: 1.0,
/// };
/// let mut lattice = Lattice::new(contacts, Initial::default(), &coupling, 1, Disorder::Annealed)?;
/// let mut breaks = 0;
/// lattice.run(Until::Events(100), &mut |avalanche| breaks += avalanche.size)?;
/// assert!(breaks >= 100 && lattice.drive() > 0.0);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Lattice {
    grid: ContactGrid,
    alpha: f64,
    dissipated: f64,
    births: LatticeBirths,
    /// Present thresholds and positions in the random streams, along rows; empty if all contacts are the
    /// same.
    born: Vec<BirthRecord>,
    /// The drive since `base` at which the contact at a site breaks; infinite on the rim.
    ends: Vec<f64>,
    /// Where contacts break in time, if they move at a velocity.
    clocks: Option<Box<Clocks>>,
    /// Minima of `ends`, or of the next breaks of `clocks`.
    minima: Minima,
    /// Origin of `drive`, so close that stretches keep their digits.
    base: f64,
    drive: f64,
    /// The sum of all stretches, had the drive stayed at `base`.
    stretch: Compensated,
    /// Difference within which breaks are simultaneous.
    together: f64,
    /// The drive after which `base` is updated.
    span: f64,
    /// Force of the real contacts that one contact represents, per stretch.
    scale: f64,
    /// Places of contacts that break now, and of those that follow.
    front: Vec<u32>,
    following: Vec<u32>,
    /// The stretch that each of those that break now has released, as far as they have broken.
    released: Vec<f64>,
    /// Whether the contact at a site broke in the last avalanche; the list of these sites.
    broken: Vec<bool>,
    scar: Vec<u32>,
    /// An avalanche within which a monitor has stopped the lattice.
    ongoing: Option<OngoingAvalanche>,
    /// Breaks since the monitor was asked.
    unasked: usize,
}

impl Lattice {
    /// Contacts at X = 0, one on each site of the lattice, which represent the `contacts.count` real ones.
    ///
    /// Contacts at their threshold in a relaxed start break in the first avalanche, at X = 0.
    ///
    /// # Errors
    /// Those of [`LatticeCoupling::check`] and [`Ensemble::new`]; stiffness per threshold; time-dependent
    /// rules; more contacts than fit in 16 GiB.
    pub fn new(
        contacts: Contacts,
        initial: Initial,
        coupling: &LatticeCoupling,
        seed: u64,
        disorder: Disorder,
    ) -> Result<Self> {
        Self::new_with(contacts, initial, coupling, seed, disorder, &mut ())
    }

    /// The same with a monitor, which says how much memory there is.
    ///
    /// # Errors
    /// As [`Lattice::new`]; stopped by the monitor.
    pub fn new_with(
        contacts: Contacts,
        initial: Initial,
        coupling: &LatticeCoupling,
        seed: u64,
        disorder: Disorder,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        Self::check(&contacts, coupling)?;
        let what = format!("a lattice of {} contacts", coupling.shape.size());
        fits("cells", what, Self::bytes(coupling.shape), monitor.memory())?;
        // Places, those around the edges included, are numbers of 32 bits.
        let [rows, columns] = coupling.shape.sides().map(|side| side as u64 + 2);
        if rows.saturating_mul(columns) > u64::from(u32::MAX) {
            let expected = format!("up to {} contacts, with the places around the edges", u32::MAX);
            return Err(Error::invalid("cells", expected, coupling.shape.size()));
        }
        let unit = stiffness(&contacts)?;
        let size = coupling.shape.size();
        let ensemble = Ensemble::new(contacts, initial, size, seed, disorder)?;
        let mean = ensemble.contacts.thresholds.mean();
        let grid = ContactGrid::new(coupling);
        let births = LatticeBirths::new(&ensemble);
        let (ends, born) = fresh(&births, &grid, &Watch::new(monitor))?;
        let mut lattice = Self {
            alpha: coupling.alpha(),
            dissipated: coupling.dissipated(),
            minima: Minima::new(&ends),
            clocks: None,
            base: 0.0,
            drive: 0.0,
            stretch: Compensated::default(),
            together: TOGETHER * mean,
            span: mean,
            scale: unit * ensemble.contacts.count / size as f64,
            front: Vec::new(),
            following: Vec::new(),
            released: Vec::new(),
            broken: vec![false; ends.len()],
            scar: Vec::new(),
            ongoing: None,
            unasked: 0,
            grid,
            births,
            born,
            ends,
        };
        lattice.stretch = lattice.sum();
        Ok(lattice)
    }

    /// The checks of [`Lattice::new`], except those of the distributions.
    ///
    /// # Errors
    /// The first thing refused.
    pub fn check(contacts: &Contacts, coupling: &LatticeCoupling) -> Result<()> {
        coupling.check()?;
        if let Some(rule) = contacts.rules.first() {
            let expected = format!("no {rule} where contacts coupled one by one have no velocity");
            return Err(Error::invalid(rule, expected, "one"));
        }
        stiffness(contacts).map(drop)
    }

    /// Largest memory of so many contacts.
    pub fn bytes(shape: Shape) -> u64 {
        let [rows, columns] = shape.sides().map(|side| side.saturating_add(2) as u64);
        rows.saturating_mul(columns).saturating_mul(BYTES)
    }

    /// Number of contacts.
    pub fn size(&self) -> usize {
        self.grid.size()
    }

    /// X, by which the drive has stretched every contact so far.
    pub fn drive(&self) -> f64 {
        self.base + self.drive
    }

    /// X at which the next contact breaks.
    pub fn next_drive(&mut self) -> f64 {
        if self.ongoing.is_some() {
            return self.drive();
        }
        let next = self.next_key();
        match &self.clocks {
            Some(clocks) if clocks.velocity() == 0.0 => self.drive(),
            _ => self.base + next,
        }
    }

    /// Force of all contacts.
    pub fn force(&self) -> f64 {
        self.scale * (self.stretch.value() + self.size() as f64 * self.drive)
    }

    /// The force of each contact, along rows; their sum is [`Lattice::force`].
    pub fn forces(&self) -> Vec<f64> {
        self.stretches().map(|stretch| self.scale * stretch).collect()
    }

    /// The contacts that broke in the last avalanche, in the order of their first breaks.
    pub fn broken_contacts(&self) -> impl Iterator<Item = usize> {
        self.scar.iter().map(|&place| self.grid.number(place as usize))
    }

    /// Drives the contacts up to a drive or for a number of avalanches, and passes each avalanche to `each`.
    ///
    /// # Errors
    /// An end that is not finite; a time without a velocity, and a drive at rest.
    pub fn run(&mut self, until: Until, each: &mut dyn FnMut(&Avalanche)) -> Result<()> {
        self.run_with(until, &mut (), each)
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Lattice::run`]; stopped by the monitor, as [`Lattice::next_event`]: the lattice can continue.
    pub fn run_with(
        &mut self,
        until: Until,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(&Avalanche),
    ) -> Result<()> {
        self.reaches(until)?;
        let (start, begun, mut events, mut fraction) = (self.drive(), self.time(), 0, 0.0);
        while self.goes_on(until, events) {
            if events % REPORT == 0 {
                let done = match until {
                    Until::Events(all) => events as f64 / all as f64,
                    Until::Drive(end) => (self.drive() - start) / (end - start),
                    Until::Time(end) => (self.time() - begun) / (end - begun),
                };
                // Not a number for an empty interval.
                fraction = done.max(0.0);
                report(monitor, fraction)?;
            }
            each(&self.next_event(&mut Aside { fraction, monitor })?);
            events += 1;
        }
        match until {
            Until::Drive(end) => self.advance_to(self.drive.max(end - self.base)),
            Until::Time(end) => self.advance_to_time(end),
            Until::Events(_) => {}
        }
        report(monitor, 1.0)
    }

    /// Whether there is another avalanche after so many `events`.
    fn goes_on(&mut self, until: Until, events: u64) -> bool {
        match until {
            Until::Drive(end) => self.next_drive() <= end,
            Until::Events(all) => events < all,
            Until::Time(end) => self.next_time() <= end,
        }
    }

    /// Drives the contacts to the next break, and runs its avalanche. The monitor is asked, and told of no progress.
    ///
    /// # Errors
    /// Contacts at rest of which none will break; stopped by the monitor, maybe within the avalanche: it is then the next one, and
    /// goes on as if it had not been stopped. Until then [`Lattice::forces`] are those of the moment, and [`Lattice::force`] is
    /// that before it.
    pub fn next_event(&mut self, monitor: &mut dyn Monitor) -> Result<Avalanche> {
        let event = match self.ongoing.take() {
            Some(event) => event,
            None => self.begin_event()?,
        };
        // The loops of contacts without a velocity are compiled without clocks.
        let event = match self.clocks.take() {
            None => self.avalanche(event, &mut Athermal, monitor),
            Some(mut clocks) => {
                let event = self.avalanche(event, clocks.as_mut(), monitor);
                self.clocks = Some(clocks);
                event
            }
        }?;
        self.update_minima();
        self.stretch.add(-event.lost);
        let OngoingAvalanche { epicentre, age, size, duration, released, force_before, .. } = event;
        Ok(Avalanche {
            drive: self.drive(),
            time: self.time(),
            age,
            epicentre,
            size,
            area: self.scar.len() as u64,
            duration,
            released: self.scale * released,
            force_before,
            force_after: self.force(),
        })
    }

    /// Continues an avalanche to its end.
    fn avalanche(
        &mut self,
        mut event: OngoingAvalanche,
        clocks: &mut impl Timekeeping,
        monitor: &mut dyn Monitor,
    ) -> Result<OngoingAvalanche> {
        while !self.front.is_empty() {
            if self.unasked >= ASK {
                self.unasked = 0;
                report(monitor, 0.0).inspect_err(|_| self.ongoing = Some(event))?;
            }
            self.continue_generation(&mut event, clocks);
        }
        Ok(event)
    }

    /// Drives the contacts to the next break.
    fn begin_event(&mut self) -> Result<OngoingAvalanche> {
        // Breaking positions are relative to `base`. They keep their digits because it follows the drive.
        if self.drive > self.span {
            self.rebase();
        }
        let next = self.next_key();
        if next == f64::INFINITY {
            let expected = "a velocity above 0: at rest no contact breaks any more";
            return Err(Error::invalid("velocity", expected, 0.0));
        }
        self.advance_to(next);
        let force_before = self.force();
        let epicentre = self.start_avalanche();
        Ok(OngoingAvalanche {
            epicentre,
            age: self.clocks.as_ref().map_or(0.0, |clocks| clocks.age(epicentre)),
            size: 0,
            duration: 0,
            released: 0.0,
            lost: 0.0,
            force_before,
            generation: OngoingGeneration::default(),
        })
    }
}

/// The stiffness of all contacts.
fn stiffness(contacts: &Contacts) -> Result<f64> {
    let expected = "contacts of equal stiffness where they are coupled one by one";
    match &contacts.stiffness {
        Stiffness::Equal(unit) => Ok(*unit),
        Stiffness::PerThreshold(_) => Err(Error::invalid("stiffness.per_threshold", expected, "k = κ x_s")),
        Stiffness::Tabulated(_) => Err(Error::invalid("stiffness.of_threshold", expected, "a table")),
    }
}

/// Contacts as they are at X = 0: where they break, and what they were born with.
fn fresh(
    births: &LatticeBirths,
    grid: &ContactGrid,
    watch: &Watch<'_>,
) -> Result<(Vec<f64>, Vec<BirthRecord>)> {
    let size = grid.size();
    let chunk = |births: &mut LatticeBirths, chunk: usize| -> Vec<_> {
        let numbers = chunk * CHUNK..size.min((chunk + 1) * CHUNK);
        numbers.map(|number| births.first(number)).collect()
    };
    let contacts = watch.share(size.div_ceil(CHUNK), || births.clone(), chunk)?;
    let mut ends = vec![f64::INFINITY; grid.places()];
    for (number, (stretch, born)) in contacts.iter().flatten().enumerate() {
        // A contact is stored by the drive at which it breaks, not by its force: uniform loading
        // then changes no contact, and the next avalanche is at the minimum (P. Grassberger, Phys.
        // Rev. E 49, 2436 (1994)).
        ends[grid.place(number)] = born.threshold - stretch;
    }
    let mut born = Vec::new();
    if !births.identical() {
        born.reserve_exact(size);
        born.extend(contacts.into_iter().flatten().map(|contact| contact.1));
    }
    Ok((ends, born))
}
