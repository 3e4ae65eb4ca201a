//! What background force and normal load add to results: forces that contain the background force, and friction coefficients.

use crate::record::{Column, Quantity, Record};
use crate::scenario::Model;

/// Force over normal load.
const COEFFICIENT: Column =
    Column::new("friction_coefficient", "friction force divided by the normal load", Quantity::Number, &[]);

/// The friction coefficient along `dimensions`.
pub(super) const fn coefficient(dimensions: &'static [&'static str]) -> Column {
    COEFFICIENT.along(dimensions)
}

impl Model {
    /// Adds the background force to the `columns` of a record, forces of contacts that slide forward. Values that are not
    /// there stay so.
    pub(super) fn add_background(&self, columns: &[Column], record: &mut Record) {
        let of_contacts = |name: &str| columns.iter().any(|column| column.name == name);
        for variable in record.variables.iter_mut().filter(|variable| of_contacts(&variable.name)) {
            variable.values.iter_mut().for_each(|force| *force += self.background);
        }
    }

    /// Adds the background force of each of the `cells` of an interface, proportional to their `areas` of mean 1, to the forces in
    /// its record, and the friction coefficient of all cells together. Cells move forward only, so that the background force changes
    /// nothing else.
    pub(super) fn add_background_of_cells(&self, cells: usize, areas: Option<&[f64]>, record: &mut Record) {
        let of_cell = |cell: usize| areas.map_or(1.0, |areas| areas[cell % areas.len()]) * self.background;
        let cells = cells as f64;
        for variable in &mut record.variables {
            let values = variable.values.iter_mut();
            match variable.name.as_str() {
                "cell_force" => values.enumerate().for_each(|(i, value)| *value += of_cell(i)),
                "force" | "event_force_before" | "event_force_after" => {
                    values.for_each(|value| *value += cells * self.background);
                }
                _ => {}
            }
        }
        add_coefficient("force", self.normal_load.map(|load| cells * load), record);
    }

    /// The same as [`Self::add_background`] where values are at these normal loads, relative to that at the start.
    pub(super) fn add_background_under(&self, columns: &[Column], loads: &[f64], record: &mut Record) {
        let of_contacts = |name: &str| columns.iter().any(|column| column.name == name);
        for variable in record.variables.iter_mut().filter(|variable| of_contacts(&variable.name)) {
            let values = variable.values.iter_mut().zip(loads);
            values.for_each(|(force, load)| *force += self.background_at(*load));
        }
    }

    /// Adds the friction coefficient of a force to a record, if there is a normal load.
    pub(super) fn add_coefficient(&self, force: &str, record: &mut Record) {
        add_coefficient(force, self.normal_load, record);
    }

    /// The same where values are at these normal loads, relative to that at the start.
    pub(super) fn add_coefficient_under(&self, force: &str, loads: &[f64], record: &mut Record) {
        self.add_coefficient(force, record);
        if let Some(variable) = record.variables.iter_mut().find(|variable| variable.name == COEFFICIENT.name)
        {
            variable.values.iter_mut().zip(loads).for_each(|(coefficient, load)| *coefficient /= load);
        }
    }
}

/// Adds the friction coefficient of a force under a normal load.
fn add_coefficient(force: &str, normal_load: Option<f64>, record: &mut Record) {
    let (Some(load), Some(force)) = (normal_load, record.get(force)) else { return };
    let values = force.values.iter().map(|force| force / load).collect();
    let dimensions = force.dimensions.clone();
    let along: Vec<&str> = dimensions.iter().map(String::as_str).collect();
    record.push(COEFFICIENT.name, COEFFICIENT.long_name, COEFFICIENT.quantity, &along, values);
}
