//! Thresholds of free form, of a fit: their density and distribution function with errors.

use super::fit_numbers::uncertain;
use super::summary::FitFreeForm;
use crate::Result;
use crate::fit::FreeForm;
use crate::record::{Column, CsvTable, Quantity, Record};

const THRESHOLD: Column =
    Column::new("free_form_threshold", "threshold", Quantity::Length, &["free_form_threshold"]);
const DENSITY: Column = Column::new(
    "free_form_density",
    "density P_c of the thresholds",
    Quantity::PerLength,
    &["free_form_threshold"],
);
const LOW: Column = Column::new(
    "free_form_density_low",
    "lower end of the interval of 95 % of the density",
    Quantity::PerLength,
    &["free_form_threshold"],
);
const HIGH: Column = Column::new(
    "free_form_density_high",
    "upper end of the interval of 95 % of the density",
    Quantity::PerLength,
    &["free_form_threshold"],
);
const CUMULATIVE: Column = Column::new(
    "free_form_cumulative",
    "distribution function of the thresholds",
    Quantity::Number,
    &["free_form_threshold"],
);
const CUMULATIVE_ERROR: Column = Column::new(
    "free_form_cumulative_error",
    "standard error of the distribution function",
    Quantity::Number,
    &["free_form_threshold"],
);

/// The variables.
pub(super) const COLUMNS: [Column; 6] = [THRESHOLD, DENSITY, LOW, HIGH, CUMULATIVE, CUMULATIVE_ERROR];

/// Their table.
pub(super) const TABLE: CsvTable = CsvTable { file: "thresholds.csv", columns: &COLUMNS, needed: DENSITY };

/// Adds the density to a record; returns what is said of it.
///
/// # Errors
/// Those of [`FreeForm::table`].
pub(super) fn report(form: &FreeForm, record: &mut Record) -> Result<FitFreeForm> {
    let band = form.table()?;
    record.add(LOW, band.low);
    record.add(HIGH, band.high);
    record.add(THRESHOLD, band.thresholds);
    record.add(DENSITY, band.density);
    record.add(CUMULATIVE, band.cumulative);
    record.add(CUMULATIVE_ERROR, band.cumulative_error);
    Ok(FitFreeForm {
        converged: form.estimates.converged,
        mean: uncertain(form.mean),
        std: uncertain(form.std),
        strength: form.strength,
        effective: form.effective,
        chi_squared: form.estimates.misfit.map(|misfit| misfit.chi_squared),
    })
}
