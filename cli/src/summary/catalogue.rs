//! Text of the summary for the events of an interface.

use asperity::record::Quantity;
use asperity::task::summary::{Catalogue, Fitted, OmoriLaw, PowerLaw, Summary};

use super::{digits, with_error, with_unit};

/// Adds lines in the form of the rest of the summary.
pub fn lines(summary: &Summary, catalogue: &Catalogue) -> Vec<(&'static str, String)> {
    let value = |number: f64, quantity| with_unit(digits(number), number, &summary.units.label(quantity));
    let drive = |number| value(number, Quantity::Length);
    let cells = |speed: f64| format!("{} cells per time", digits(speed));
    let from = if catalogue.from > 0.0 {
        format!(" from X_T = {} on", drive(catalogue.from))
    } else {
        String::new()
    };
    let unfinished = match catalogue.unfinished {
        0 => String::new(),
        number => format!("; {number} more had not ended with the run"),
    };
    let events = format!("{}{from}, over {} cells{unfinished}", catalogue.events, catalogue.cells);
    let mut lines = vec![("events", events)];
    if let Some(mean) = catalogue.mean_waiting {
        let variation = catalogue.waiting_variation.map_or(String::new(), |variation| {
            format!(", coefficient of variation {} (1 for a Poisson process)", digits(variation))
        });
        lines.push(("mean interval", format!("{} in X_T{variation}", drive(mean))));
    }
    if let Some(largest) = catalogue.largest {
        let what = format!("{} {}", catalogue.magnitude, magnitude(catalogue, largest.magnitude));
        lines.push((
            "largest event",
            format!("{what}, {} cells, at X_T = {}", largest.cells, drive(largest.drive)),
        ));
    }
    if let Some(law) = &catalogue.law {
        lines.push(("magnitudes", magnitudes_text(catalogue, law)));
    }
    if let Some(shocks) = &catalogue.main_shocks {
        let law = |law: Option<&OmoriLaw>| {
            law.map_or_else(
                || "no Omori law".into(),
                |law| format!("Omori exponent p = {}", with_error(law.exponent)),
            )
        };
        let counted = format!("{} of size {} or more", shocks.count, shocks.size);
        lines.push(("main shocks", counted));
        let after = law(shocks.aftershock_law.as_ref());
        lines.push(("aftershocks", format!("{after} ({} events)", shocks.aftershocks)));
        let before = law(shocks.foreshock_law.as_ref());
        lines.push(("foreshocks", format!("{before} ({} events)", shocks.foreshocks)));
    }
    if let Some(waves) = catalogue.wave_speed {
        let front = catalogue.front_speed.map_or(String::new(), |front| {
            format!("; front of the largest event {}, {} of it", cells(front), digits(front / waves))
        });
        lines.push(("wave speed", format!("{}{front}", cells(waves))));
    }
    if let (Some(breaks), Some(slip)) = (catalogue.dissipated_breaks, catalogue.dissipated_slip) {
        let energy = |number| value(number, Quantity::Energy);
        lines.push((
            "dissipated",
            format!(
                "{} in breaks, {} in the slider, at the cells that slipped",
                energy(breaks),
                energy(slip)
            ),
        ));
    }
    lines
}

fn magnitudes_text(catalogue: &Catalogue, law: &PowerLaw) -> String {
    let exponent = with_error(law.exponent);
    let cut_off = if !law.is_cut_off() {
        "no cut-off found".into()
    } else {
        let fitted = with_error(Fitted { value: law.cut_off.0, error: law.cut_off_error.0 });
        format!("cut-off {}", with_unit(fitted, law.cut_off.0, &catalogue.magnitude_unit))
    };
    format!(
        "τ = {exponent}, {cut_off}, fitted to {} ≥ {} ({} events)",
        catalogue.magnitude,
        magnitude(catalogue, law.from),
        law.events
    )
}

/// A magnitude with its unit.
fn magnitude(catalogue: &Catalogue, number: f64) -> String {
    with_unit(digits(number), number, &catalogue.magnitude_unit)
}
