//! Distributions of stretches and thresholds, from the master equation.

use super::grid::Grid;
use super::{add_atoms, placed};
use crate::Result;
use crate::contacts::Contacts;
use crate::master::{Pull, SteadyState, Stretches};
use crate::monitor::Monitor;
use crate::record::{Column, Quantity, Record};
use crate::scenario;

/// Densities of attached contacts below this, per breaking rate, are rounding errors. The hazard there is infinite.
const NONE: f64 = 1e-12;

const STRETCH: Column = Column::new("stretch", "stretch x", Quantity::Length, &["stretch"]);
const SNAPSHOT: Column =
    Column::new("snapshot", "position X of the snapshot", Quantity::Length, &["snapshot"]);
const STRETCH_DENSITY: Column = Column::new(
    "stretch_density",
    "density Q(x; X) of stretches",
    Quantity::PerLength,
    &["snapshot", "stretch"],
);
const STRETCH_ATOM_POSITION: Column =
    Column::new("stretch_atom_position", "position X of the snapshot", Quantity::Length, &["stretch_atom"]);
const STRETCH_ATOM: Column = Column::new(
    "stretch_atom_stretch",
    "stretch that many contacts share",
    Quantity::Length,
    &["stretch_atom"],
);
const STRETCH_ATOM_WEIGHT: Column =
    Column::new("stretch_atom_weight", "fraction of contacts", Quantity::Number, &["stretch_atom"]);
const STEADY_STRETCH_DENSITY: Column = Column::new(
    "steady_stretch_density",
    "density of stretches in steady sliding",
    Quantity::PerLength,
    &["stretch"],
);
const THRESHOLD_DENSITY: Column =
    Column::new("threshold_density", "density of thresholds", Quantity::PerLength, &["stretch"]);
/// `THRESHOLD_DENSITY` for time-dependent contacts.
const BREAKING_STRETCH_DENSITY: Column = Column {
    long_name: "density of the stretches at which contacts break in steady sliding",
    ..THRESHOLD_DENSITY
};
const HAZARD: Column = Column::new(
    "hazard",
    "hazard P(x), the fraction of contacts of stretch x that break per length",
    Quantity::PerLength,
    &["stretch"],
);
const STEADY_ATOM: Column = Column::new(
    "steady_atom_stretch",
    "stretch that many contacts share",
    Quantity::Length,
    &["steady_atom"],
);
const STEADY_ATOM_WEIGHT: Column =
    Column::new("steady_atom_weight", "fraction of contacts", Quantity::Number, &["steady_atom"]);
const THRESHOLD_ATOM: Column = Column::new(
    "threshold_atom_stretch",
    "threshold that many contacts share",
    Quantity::Length,
    &["threshold_atom"],
);
const THRESHOLD_ATOM_WEIGHT: Column =
    Column::new("threshold_atom_weight", "fraction of contacts", Quantity::Number, &["threshold_atom"]);

/// The variables of distributions.
pub(super) const COLUMNS: [Column; 13] = [
    STRETCH,
    SNAPSHOT,
    STRETCH_DENSITY,
    STRETCH_ATOM_POSITION,
    STRETCH_ATOM,
    STRETCH_ATOM_WEIGHT,
    STEADY_STRETCH_DENSITY,
    THRESHOLD_DENSITY,
    HAZARD,
    STEADY_ATOM,
    STEADY_ATOM_WEIGHT,
    THRESHOLD_ATOM,
    THRESHOLD_ATOM_WEIGHT,
];

/// Q(x; X) at the snapshots.
///
/// # Errors
/// A stop by the monitor.
pub(super) fn evolving(
    task: &scenario::Pull,
    pull: &Pull,
    grid: &Grid,
    record: &mut Record,
    monitor: &mut dyn Monitor,
) -> Result<()> {
    record.add(STRETCH, grid.stretches.clone());
    let snapshots = &task.snapshots;
    if snapshots.is_empty() {
        return Ok(());
    }
    let (mut density, mut masses) = (Vec::new(), Vec::new());
    for &position in snapshots {
        let stretches = pull.stretch_density_with(position, &grid.stretches, monitor)?;
        density.extend(stretches.density);
        masses.extend(stretches.atoms.iter().map(|atom| ([position, atom.position], atom.weight)));
    }
    record.add(SNAPSHOT, snapshots.clone());
    record.add(STRETCH_DENSITY, density);
    add_atoms(record, ([STRETCH_ATOM_POSITION, STRETCH_ATOM], STRETCH_ATOM_WEIGHT), masses.into_iter());
    Ok(())
}

/// Q_s with P_c and P. For time-dependent contacts P_c is replaced by the distribution of the thresholds at which they
/// break, and P is computed from that.
///
/// # Errors
/// A stop by the monitor.
pub(super) fn steady(
    contacts: &Contacts,
    steady: &SteadyState,
    grid: &Grid,
    record: &mut Record,
    monitor: &mut dyn Monitor,
) -> Result<()> {
    let stretches = steady.stretch_density_with(&grid.stretches, monitor)?;
    let law = contacts.thresholds.as_ref();
    let (column, thresholds, hazard) = if contacts.rules.are_time_dependent() {
        let met = steady.breaking_stretches_with(&grid.stretches, monitor)?;
        // Where hardly any contact is attached, numerator and denominator are rounding errors.
        let rate = |(met, &held): (&f64, &f64)| {
            if held > NONE * steady.breaking_rate() {
                met * steady.breaking_rate() / held
            } else {
                f64::INFINITY
            }
        };
        let hazard = met.density.iter().zip(&stretches.density).map(rate).collect();
        (BREAKING_STRETCH_DENSITY, met, hazard)
    } else {
        let density = grid.stretches.iter().map(|&x| law.density(x)).collect();
        let hazard = grid.stretches.iter().map(|&x| law.hazard(x)).collect();
        (THRESHOLD_DENSITY, Stretches { density, atoms: law.atoms() }, hazard)
    };
    record.add(STEADY_STRETCH_DENSITY, stretches.density);
    record.add(column, thresholds.density);
    record.add(HAZARD, hazard);
    add_atoms(record, ([STEADY_ATOM], STEADY_ATOM_WEIGHT), stretches.atoms.iter().map(placed));
    add_atoms(record, ([THRESHOLD_ATOM], THRESHOLD_ATOM_WEIGHT), thresholds.atoms.iter().map(placed));
    Ok(())
}
