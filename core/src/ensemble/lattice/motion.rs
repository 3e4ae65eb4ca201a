//! A lattice that moves at a velocity: contacts break thermally, and their thresholds age.

use super::births::{BirthRecord, LatticeBirths};
use super::clocks::{Clocks, Site};
use super::grid::ContactGrid;
use super::{Lattice, LatticeCoupling, Minima, Until, stiffness};
use crate::contacts::{Contacts, Initial, Rules};
use crate::ensemble::{Disorder, Ensemble};
use crate::error::{finite, not_negative};
use crate::monitor::{Monitor, fits, report};
use crate::shape::Shape;
use crate::{Error, Result};

/// Bytes per site beside those of a lattice without time: the clock of a contact and its next break, both twice while the velocity
/// changes, and the list of those that have changed.
const BYTES: u64 = 136;

/// Contacts of which next breaks are computed between two questions to the monitor.
const ASK: usize = 1 << 12;

impl Lattice {
    /// The contacts at X = 0 and t = 0, under a drive at the velocity v, 0 or above: X = vt. They have temperature, or thresholds that
    /// age, or neither.
    ///
    /// A contact breaks at its present threshold, or thermally at the rate w before. It has a random hazard of exponential
    /// distribution at birth, and breaks when ∫w dt has reached that (D. T. Gillespie, J. Comput. Phys. 22, 403 (1976)); a jump of its stretch by a
    /// neighbour's break leaves it the rest. For α = 0 contacts have the lives of [`Ensemble::follow`]; without temperature and
    /// ageing, and for T → 0, avalanches are those of [`Lattice::new`], bit for bit.
    ///
    /// Times are resolved to 1e-16 of x̄/v, with x̄ the mean threshold.
    ///
    /// # Errors
    /// Those of [`Lattice::new`], time-dependent rules excepted; a velocity that is not a finite number, 0 or above; diffusing thresholds,
    /// the closure by a mean field, and contacts that are free for a time.
    pub fn at(
        contacts: Contacts,
        initial: Initial,
        coupling: &LatticeCoupling,
        velocity: f64,
        seed: u64,
        disorder: Disorder,
    ) -> Result<Self> {
        Self::at_with(contacts, initial, coupling, velocity, (seed, disorder), &mut ())
    }

    /// The same with a monitor, which says how much memory there is, and seed and disorder as a pair.
    ///
    /// # Errors
    /// As [`Lattice::at`]; stopped by the monitor.
    pub fn at_with(
        contacts: Contacts,
        initial: Initial,
        coupling: &LatticeCoupling,
        velocity: f64,
        (seed, disorder): (u64, Disorder),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        not_negative("velocity", velocity)?;
        Self::check_at(&contacts, coupling)?;
        let what = format!("a lattice of {} contacts in time", coupling.shape.size());
        fits("cells", what, Self::bytes_at(coupling.shape), monitor.memory())?;
        let ensemble =
            Ensemble::new(contacts.clone(), initial.clone(), coupling.shape.size(), seed, disorder)?;
        let unit = stiffness(&contacts)?;
        let mut timeless = contacts;
        timeless.rules = Rules::default();
        let mut lattice = Self::new_with(timeless, initial, coupling, seed, disorder, monitor)?;
        let sizes = (lattice.size(), lattice.grid.places());
        let mut clocks = Clocks::new(&ensemble, velocity, unit, sizes, monitor)?;
        for number in 0..lattice.size() {
            if number % ASK == 0 {
                report(monitor, 0.0)?;
            }
            // In a relaxed start contacts above their thresholds break at once, and draw nothing.
            if lattice.ends[lattice.grid.place(number)] > 0.0 {
                clocks.draw(number);
            }
        }
        lattice.schedule_all(&mut clocks, 0.0, monitor)?;
        lattice.minima = Minima::new(&clocks.due);
        lattice.clocks = Some(Box::new(clocks));
        Ok(lattice)
    }

    /// The checks of [`Lattice::at`], except those of the distributions.
    ///
    /// # Errors
    /// The first thing refused.
    pub fn check_at(contacts: &Contacts, coupling: &LatticeCoupling) -> Result<()> {
        coupling.check()?;
        Clocks::check(contacts)?;
        stiffness(contacts).map(drop)
    }

    /// Largest memory of so many contacts at a velocity.
    pub fn bytes_at(shape: Shape) -> u64 {
        let [rows, columns] = shape.sides().map(|side| side.saturating_add(2) as u64);
        Self::bytes(shape).saturating_add(rows.saturating_mul(columns).saturating_mul(BYTES))
    }

    /// The present velocity of the drive; `None` for contacts without time.
    pub fn velocity(&self) -> Option<f64> {
        self.clocks.as_ref().map(|clocks| clocks.velocity())
    }

    /// Whether it was stopped within an avalanche, which is then the next event.
    pub(crate) fn is_within_avalanche(&self) -> bool {
        self.ongoing.is_some()
    }

    /// The present time; 0 without a velocity.
    pub fn time(&self) -> f64 {
        self.clocks.as_ref().map_or(0.0, |clocks| clocks.time())
    }

    /// The time at which the next contact breaks, infinite if none does; 0 without a velocity.
    pub fn next_time(&mut self) -> f64 {
        if self.ongoing.is_some() {
            return self.time();
        }
        let next = self.next_key();
        self.clocks.as_ref().map_or(0.0, |clocks| clocks.base + clocks.time_at(next))
    }

    /// The drive goes on at another velocity, 0 or above; at 0 it rests.
    ///
    /// # Errors
    /// A velocity that is not a finite number, 0 or above; a lattice without time; one that was stopped within an avalanche; stopped by the
    /// monitor, which leaves the velocity as it was.
    pub fn set_velocity_with(&mut self, velocity: f64, monitor: &mut dyn Monitor) -> Result<()> {
        not_negative("velocity", velocity)?;
        if self.ongoing.is_some() {
            return Err(Error::invalid("velocity", "none within an avalanche", velocity));
        }
        let Some(mut clocks) = self.clocks.clone() else { return Err(no_time("velocity", velocity)) };
        for number in 0..self.grid.size() {
            if number % ASK == 0 {
                report(monitor, 0.0)?;
            }
            clocks.count(self.site(number), self.drive);
        }
        clocks.rebase(self.drive);
        clocks.set_velocity(velocity, 0.0);
        self.schedule_all(&mut clocks, self.drive, monitor)?;
        self.clocks = Some(clocks);
        self.rebase_drive();
        Ok(())
    }

    /// The same without a monitor.
    ///
    /// # Errors
    /// As [`Lattice::set_velocity_with`].
    pub fn set_velocity(&mut self, velocity: f64) -> Result<()> {
        self.set_velocity_with(velocity, &mut ())
    }

    /// Computes the next breaks of all contacts, with drives relative to `base`.
    fn schedule_all(&self, clocks: &mut Clocks, base: f64, monitor: &mut dyn Monitor) -> Result<()> {
        for number in 0..self.grid.size() {
            if number % ASK == 0 {
                report(monitor, 0.0)?;
            }
            let site = self.site(number);
            clocks.schedule(Site { end: site.end - base, ..site }, self.drive - base);
        }
        Ok(())
    }

    /// The site of a contact.
    fn site(&self, number: usize) -> Site {
        site(&self.grid, &self.births, &self.born, &self.ends, self.grid.place(number) as u32)
    }

    /// The numbers of which the least is the next break.
    pub(super) fn keys(&self) -> &[f64] {
        self.clocks.as_ref().map_or(&self.ends, |clocks| &clocks.due)
    }

    /// Where the next contact breaks: the drive since its base, or at rest the time since its base. Lower bounds that come first
    /// are replaced.
    pub(super) fn next_key(&mut self) -> f64 {
        let Some(clocks) = &mut self.clocks else { return self.minima.least().max(self.drive) };
        let mut first = Vec::new();
        loop {
            let least = self.minima.least();
            if least == f64::INFINITY || !clocks.has_bounds() {
                return least.max(clocks.progress(self.drive));
            }
            first.clear();
            self.minima.up_to(least, &clocks.due, &mut first);
            let mut bounds = false;
            for &place in &first {
                let site = site(&self.grid, &self.births, &self.born, &self.ends, place);
                if clocks.refine(site, self.drive) {
                    self.minima.touch(place as usize);
                    bounds = true;
                }
            }
            if !bounds {
                return least.max(clocks.progress(self.drive));
            }
            self.minima.update(&clocks.due);
        }
    }

    /// Advances the drive, at rest the time, to where nothing has broken yet.
    pub(super) fn advance_to(&mut self, key: f64) {
        let Some(clocks) = &mut self.clocks else {
            self.drive = key;
            return;
        };
        clocks.advance(key);
        if clocks.velocity() > 0.0 {
            self.drive = key;
        }
    }

    /// Advances to a time before which nothing breaks.
    pub(super) fn advance_to_time(&mut self, time: f64) {
        let Some(clocks) = &self.clocks else { return };
        let key = clocks.progress_at(time - clocks.base);
        self.advance_to(key.max(clocks.progress(self.drive)));
    }

    /// Refuses an end that is not finite, a time of a lattice without one, and a drive that is not reached at rest.
    pub(super) fn reaches(&self, until: Until) -> Result<()> {
        match (until, self.velocity()) {
            (Until::Time(time), None) => Err(no_time("until", time)),
            (Until::Drive(drive), Some(0.0)) => {
                Err(Error::invalid("until", "a time, as the drive is at rest", drive))
            }
            (Until::Drive(end) | Until::Time(end), _) => finite("until", end).map(drop),
            (Until::Events(_), _) => Ok(()),
        }
    }
}

/// A site, for the next break of its contact.
#[inline]
pub(super) fn site(
    grid: &ContactGrid,
    births: &LatticeBirths,
    born: &[BirthRecord],
    ends: &[f64],
    place: u32,
) -> Site {
    let (place, number) = (place as usize, grid.number(place as usize));
    Site { place, number, fresh: births.threshold(born, number), end: ends[place] }
}

fn no_time(key: &str, found: f64) -> Error {
    Error::invalid(key, "none for contacts without time, which have no velocity", found)
}
