//! Checks the values of an interface, alone and with those of other tables.

use super::super::{Drive, Ensemble, not_negative, positive, size};
use super::{CellLoading, CellSlip, Elasticity, Interface, PerCell};
use crate::contacts::Contacts;
use crate::elastic::coupling::Solid;
use crate::ensemble::lattice::Lattice;
use crate::monitor::fits;
use crate::shape::Edges;
use crate::{Error, Result};

/// Bytes that a contact coupled one by one takes at most.
const BYTES_PER_CONTACT: f64 = 72.0;
/// The same in time, with its clock.
const BYTES_PER_CONTACT_IN_TIME: f64 = 144.0;
/// Bytes that a cell takes at most, with what it takes to couple it: on a half-space with open edges, some cells sliding.
const BYTES_PER_CELL: f64 = 192.0;
/// The same on a half-space with periodic edges, whose transforms are not padded.
const BYTES_PER_PERIODIC_CELL: f64 = 144.0;
/// The same of a chain on a half-space, for its one long transform.
const BYTES_PER_CELL_OF_A_CHAIN: f64 = 336.0;
/// Bytes that a cell takes that follows the master equation in time, with what of it is tried in a step.
const BYTES_PER_CELL_IN_TIME: f64 = 2e6;
/// Bytes that an athermal cell takes that moves in time, with the branches on which it turns.
const BYTES_PER_INERTIAL_CELL: f64 = 5e5;
/// Factor for an estimate of the error: a second solution with larger tolerances.
const WITH_ERROR: f64 = 2.0;
/// Bytes that a cell of few contacts takes, and each of them.
const BYTES_PER_ENSEMBLE: [f64; 2] = [16e3, 256.0];
/// The same in time, with what of it is tried in a step.
const BYTES_PER_ENSEMBLE_IN_TIME: [f64; 2] = [16e3, 640.0];

impl Interface {
    /// Checks every value, alone and with the contacts, the drive and the ensemble.
    ///
    /// # Errors
    /// The first invalid value, with its full path.
    pub fn check(&self, contacts: &Contacts, drive: &Drive, ensemble: Option<&Ensemble>) -> Result<()> {
        onwards(drive).map_err(|e| e.under("drive"))?;
        if self.mass.is_some() && drive.velocity.is_none() {
            let expected = "a velocity above 0, since interface.mass makes cells move in time";
            return Err(Error::invalid("drive.velocity", expected, "none"));
        }
        self.check_cells(contacts, ensemble)
    }

    /// The same, for a load point that a protocol moves in time.
    ///
    /// # Errors
    /// As [`Self::check`]; contacts that are not time-dependent.
    pub fn check_in_time(&self, contacts: &Contacts, ensemble: Option<&Ensemble>) -> Result<()> {
        if !self.moves_in_time(contacts) {
            let expected = "[drive] where contacts are not time-dependent and cells have no mass: between events their cells are in balance at every velocity";
            return Err(Error::invalid("protocol", expected, "[[protocol]] with [interface]"));
        }
        self.check_cells(contacts, ensemble)
    }

    /// The same, whatever drives the cells.
    ///
    /// # Errors
    /// The first value that does not, with its full path.
    pub fn check_cells(&self, contacts: &Contacts, ensemble: Option<&Ensemble>) -> Result<()> {
        self.values().map_err(|e| e.under("interface"))?;
        self.check_slip_rates(contacts).map_err(|e| e.under("interface"))?;
        let viscosity = contacts.rules.free_friction.viscosity;
        if viscosity > 0.0 {
            let expected = "0 beside [interface], whose cells have interface.viscosity: free contacts have a constant force there";
            return Err(Error::invalid("contacts.free_friction.viscosity", expected, viscosity));
        }
        match (self.contacts, contacts.rules.first()) {
            (PerCell::Many, None) if self.mass.is_none() => self.many(ensemble, BYTES_PER_ENSEMBLE),
            (PerCell::Many, rule) => {
                self.moving(rule, ensemble.is_some()).map_err(|e| e.under("interface"))?;
                self.many(ensemble, BYTES_PER_ENSEMBLE_IN_TIME)
            }
            (PerCell::One, _) => self.one(contacts, ensemble),
        }
    }

    /// Refuses an interface that takes more than `memory` bytes, with an estimate of its error or without.
    ///
    /// # Errors
    /// [`Error::TooLarge`], naming the cells.
    pub fn fits(
        &self,
        contacts: &Contacts,
        ensemble: Option<&Ensemble>,
        with_error: bool,
        memory: u64,
    ) -> Result<()> {
        let what = format!("an interface of {} cells", self.size());
        fits("interface.cells", what, self.bytes(contacts, ensemble, with_error), memory)
    }

    /// Upper limit of the bytes of an interface, with an estimate of its error or without.
    pub fn bytes(&self, contacts: &Contacts, ensemble: Option<&Ensemble>, with_error: bool) -> u64 {
        // Slip rates are recorded, copied, and named as a result.
        let rates = 3.0 * size_of::<f64>() as f64 * self.slip_rates.unwrap_or(0) as f64;
        (self.size() as f64 * (self.bytes_per_cell(contacts, ensemble, with_error) + rates)) as u64
    }

    /// Upper limit of the bytes per cell, including its coupling.
    fn bytes_per_cell(&self, contacts: &Contacts, ensemble: Option<&Ensemble>, with_error: bool) -> f64 {
        let few = |[cell, contact]: [f64; 2], ensemble: &Ensemble| cell + contact * ensemble.size() as f64;
        match (self.contacts, self.moves_in_time(contacts), ensemble) {
            (PerCell::One, false, _) => BYTES_PER_CONTACT,
            (PerCell::One, true, _) => BYTES_PER_CONTACT_IN_TIME,
            (PerCell::Many, false, None) => match (self.coupling, &self.cells[..]) {
                (Elasticity::HalfSpace { .. }, [_]) => BYTES_PER_CELL_OF_A_CHAIN,
                (Elasticity::HalfSpace { .. }, _) if self.edges == Edges::Periodic => BYTES_PER_PERIODIC_CELL,
                _ => BYTES_PER_CELL,
            },
            (PerCell::Many, true, None) => {
                let athermal = !contacts.rules.are_time_dependent();
                let one = if athermal { BYTES_PER_INERTIAL_CELL } else { BYTES_PER_CELL_IN_TIME };
                one * if with_error { WITH_ERROR } else { 1.0 }
            }
            (PerCell::Many, false, Some(ensemble)) => few(BYTES_PER_ENSEMBLE, ensemble),
            (PerCell::Many, true, Some(ensemble)) => few(BYTES_PER_ENSEMBLE_IN_TIME, ensemble),
        }
    }

    /// Refuses a record of slip rates of cells that do not move in time, or of one step.
    fn check_slip_rates(&self, contacts: &Contacts) -> Result<()> {
        let Some(steps) = self.slip_rates else { return Ok(()) };
        if !self.moves_in_time(contacts) {
            let expected = "none where contacts are not time-dependent and cells have no mass: their cells have no steps in time";
            return Err(Error::invalid("slip_rates", expected, steps));
        }
        if steps < 2 {
            return Err(Error::invalid("slip_rates", "2 steps or more, the first and another one", steps));
        }
        size::check_anywhere("slip_rates", steps.saturating_mul(self.size()), size_of::<f64>() as f64)
    }

    /// Checks the values that do not depend on other tables; keys are relative to this table.
    fn values(&self) -> Result<()> {
        let shape = self.shape()?;
        let bytes = match self.contacts {
            PerCell::Many => BYTES_PER_CELL,
            PerCell::One => BYTES_PER_CONTACT,
        };
        size::check_anywhere("cells", shape.size(), bytes)?;
        match self.contacts {
            PerCell::Many => positive("connection", self.connection)?,
            PerCell::One => not_negative("connection", self.connection)?,
        };
        self.coupling.check(self.contacts).map_err(|e| e.under("coupling"))?;
        self.viscosity.map(|viscosity| positive("viscosity", viscosity)).transpose()?;
        self.mass.map(|mass| positive("mass", mass)).transpose()?;
        positive("drive_tolerance", self.drive_tolerance)?;
        not_negative("catalogue_from", self.catalogue_from)?;
        let Some(shocks) = &self.main_shocks else { return Ok(()) };
        if self.contacts == PerCell::Many {
            let expected = "none beside interface.contacts = \"many\": foreshocks and aftershocks are those of contacts coupled one by one";
            return Err(Error::invalid("main_shocks", expected, "main shocks"));
        }
        shocks.check().map_err(|e| e.under("main_shocks"))
    }

    /// Checks the values that cells of many contacts need or exclude.
    fn many(&self, ensemble: Option<&Ensemble>, bytes: [f64; 2]) -> Result<()> {
        let check = || {
            self.shape()?.check(self.edges)?;
            self.check_areas()?;
            self.disorder.as_ref().map_or(Ok(()), |scales| scales.try_out(self.size()))
        };
        check().map_err(|e| e.under("interface"))?;
        ensemble.map_or(Ok(()), |ensemble| self.few(ensemble, bytes))
    }

    /// What cells need that have a mass or whose contacts a rule makes time-dependent, be they few or not.
    fn moving(&self, rule: Option<&str>, few: bool) -> Result<()> {
        match (self.mass, self.slip, rule) {
            (Some(_), Some(slip), _) => {
                let expected =
                    "none beside interface.mass: cells with a mass follow their equation of motion";
                let found = if slip == CellSlip::Reset { "reset" } else { "overdamped" };
                return Err(Error::invalid("slip", expected, found));
            }
            (None, _, Some(rule)) => self.aged(rule)?,
            _ => {}
        }
        if few { Ok(()) } else { size::check_anywhere("cells", self.size(), BYTES_PER_CELL_IN_TIME) }
    }

    /// What cells without mass need whose contacts a rule makes time-dependent.
    fn aged(&self, rule: &str) -> Result<()> {
        let reason = format!(
            "since contacts.{rule} makes contacts time-dependent: that or a mass limits how fast cells slip"
        );
        if self.viscosity.is_none() {
            return Err(Error::invalid("viscosity", format!("a viscosity above 0, {reason}"), "none"));
        }
        if self.slip.unwrap_or_default() == CellSlip::Reset {
            let expected = format!("\"overdamped\" with a viscosity, {reason}");
            return Err(Error::invalid("slip", expected, "reset"));
        }
        Ok(())
    }

    /// Checks an interface of ensembles, with the bytes per cell and per contact.
    fn few(&self, ensemble: &Ensemble, [cell, contact]: [f64; 2]) -> Result<()> {
        let Some(size) = ensemble.size else {
            let expected = "the number of contacts followed in each cell of the interface";
            return Err(Error::invalid("ensemble.size", expected, "none"));
        };
        if self.mass.is_none() && self.slip.unwrap_or_default() == CellSlip::Reset {
            let expected = "\"overdamped\" beside [ensemble], where balance is lost at every break: in a reset all \
                            contacts of a cell would break with its first one";
            return Err(Error::invalid("interface.slip", expected, "reset"));
        }
        size::check_anywhere("interface.cells", self.size(), cell + contact * size as f64)
    }

    /// Refuses values that single contacts exclude.
    fn one(&self, contacts: &Contacts, ensemble: Option<&Ensemble>) -> Result<()> {
        let given = [
            ("slip", self.slip.is_some(), "re-form when the slide is over", "a rule of slip"),
            ("viscosity", self.viscosity.is_some(), "slide at once", "one"),
            ("mass", self.mass.is_some(), "slide at once", "one"),
            ("slip_rates", self.slip_rates.is_some(), "slide at once", "a number of steps"),
            ("disorder", self.disorder.is_some(), "draw their thresholds from contacts.thresholds", "one"),
            ("areas", self.areas.is_some(), "are all alike but for their thresholds", "areas"),
            ("loading", self.loading == CellLoading::Edge, "are all pulled by the drive", "edge"),
        ];
        if let Some((key, _, why, found)) = given.into_iter().find(|given| given.1) {
            let expected =
                format!("none beside interface.contacts = \"one\": contacts coupled one by one {why}");
            return Err(Error::invalid(key, expected, found).under("interface"));
        }
        if let Some(size) = ensemble.and_then(|ensemble| ensemble.size) {
            let expected = "none beside interface.contacts = \"one\", where every cell is a contact";
            return Err(Error::invalid("ensemble.size", expected, size));
        }
        let springs = self.springs().map_err(|e| e.under("interface"))?;
        if contacts.rules.are_time_dependent() {
            return Lattice::check_at(contacts, &springs).map_err(Error::of_scenario);
        }
        Lattice::check(contacts, &springs).map_err(Error::of_scenario)
    }
}

impl Elasticity {
    /// Single contacts may be uncoupled; cells may not.
    fn check(&self, contacts: PerCell) -> Result<()> {
        match (*self, contacts) {
            (Self::Neighbours { stiffness }, PerCell::One) => {
                not_negative("neighbours.stiffness", stiffness).map(drop)
            }
            (Self::Neighbours { stiffness }, PerCell::Many) => {
                positive("neighbours.stiffness", stiffness).map(drop)
            }
            (Self::HalfSpace { modulus, cell, poisson_ratio, sliding }, _) => {
                positive("half_space.modulus", modulus)?;
                let solid = Solid::new(modulus, poisson_ratio, sliding);
                solid.check().map_err(|e| e.under("half_space"))?;
                positive("half_space.cell", cell).map(drop)
            }
        }
    }
}

/// Refuses drives that an interface cannot have.
fn onwards(drive: &Drive) -> Result<()> {
    let given = [("turning_points", drive.turning_points.is_some()), ("force_to", drive.force_to.is_some())];
    match given.into_iter().find(|given| given.1) {
        Some((key, _)) => {
            let expected = "a distance: an interface is driven forward only, through its connection";
            Err(Error::invalid(key, expected, key))
        }
        None => Ok(()),
    }
}
