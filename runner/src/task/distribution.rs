//! Distributions of stretches and thresholds, from the master equation.

use asperity::Result;
use asperity::contacts::Contacts;
use asperity::master::{Pull, SteadyState, Stretches};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::scenario;

use super::grid::Grid;
use super::{atoms, placed};

/// A density that no contact is seen of, in breaking rates: about what it is where all hold.
const NONE: f64 = 1e-12;

const STRETCH: (&str, &str) = ("stretch", "stretch that many contacts share");

/// Q(x; X) at the snapshots.
///
/// # Errors
/// The monitor's wish to stop.
pub fn evolving(
    task: &scenario::Pull,
    pull: &Pull,
    grid: &Grid,
    record: &mut Record,
    monitor: &mut dyn Monitor,
) -> Result<()> {
    record.push("stretch", "stretch x", Quantity::Length, &["stretch"], grid.stretches.clone());
    let snapshots = &task.snapshots;
    if snapshots.is_empty() {
        return Ok(());
    }
    let (mut density, mut masses) = (Vec::new(), Vec::new());
    for &position in snapshots {
        let stretches = pull.stretch_density(position, &grid.stretches, monitor)?;
        density.extend(stretches.density);
        masses.extend(stretches.atoms.iter().map(|atom| ([position, atom.position], atom.weight)));
    }
    record.push("snapshot", "position X of the snapshot", Quantity::Length, &["snapshot"], snapshots.clone());
    let words = "density Q(x; X) of stretches";
    record.push("stretch_density", words, Quantity::PerLength, &["snapshot", "stretch"], density);
    atoms(record, "stretch_atom", [("position", "position X of the snapshot"), STRETCH], masses.into_iter());
    Ok(())
}

/// Q_s with P_c and P; of time-dependent contacts, with the thresholds that they meet, and P from these.
///
/// # Errors
/// The monitor's wish to stop.
pub fn steady(
    contacts: &Contacts,
    steady: &SteadyState,
    grid: &Grid,
    record: &mut Record,
    monitor: &mut dyn Monitor,
) -> Result<()> {
    let stretches = steady.stretch_density(&grid.stretches, monitor)?;
    let law = contacts.thresholds.as_ref();
    let (words, thresholds, hazard) = if contacts.rules.are_time_dependent() {
        let met = steady.thresholds_met(&grid.stretches, monitor)?;
        // Where no contact is seen to hold, both are rounding.
        let rate = |(met, &held): (&f64, &f64)| {
            if held > NONE * steady.breaking_rate() {
                met * steady.breaking_rate() / held
            } else {
                f64::INFINITY
            }
        };
        let hazard = met.density.iter().zip(&stretches.density).map(rate).collect();
        ("density of the stretches at which contacts break in steady sliding", met, hazard)
    } else {
        let density = grid.stretches.iter().map(|&x| law.density(x)).collect();
        let hazard = grid.stretches.iter().map(|&x| law.hazard(x)).collect();
        ("density of thresholds", Stretches { density, atoms: law.atoms() }, hazard)
    };
    let mut add = |name, words, values| record.push(name, words, Quantity::PerLength, &["stretch"], values);
    add("steady_stretch_density", "density of stretches in steady sliding", stretches.density);
    add("threshold_density", words, thresholds.density);
    add("hazard", "hazard P(x), the fraction of contacts of stretch x that break per length", hazard);
    atoms(record, "steady_atom", [STRETCH], stretches.atoms.iter().map(placed));
    let threshold = ("stretch", "threshold that many contacts share");
    atoms(record, "threshold_atom", [threshold], thresholds.atoms.iter().map(placed));
    Ok(())
}
