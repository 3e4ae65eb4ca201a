//! Statistics of a catalogue of events: distribution of magnitudes, waiting times, largest event.

use crate::Result;
use crate::numerics::cutoff::{CutOff, fit_real, fit_whole};
use crate::record::Quantity;
use crate::scenario::{Interface, Units};

use super::found::Found;
use super::model::DrivenInterface;
use crate::task::summary::{Catalogue, Extended, Fitted, Largest, PowerLaw};

/// The statistics of the events found. Columns are read one after the other, since they may not all fit in memory.
pub fn read<M: DrivenInterface>(
    interface: &Interface,
    units: &Units,
    found: &mut Found<'_>,
) -> Result<Catalogue> {
    let quantity = found.events.get(M::MAGNITUDE).map_or(Quantity::Number, |column| column.quantity);
    let drives = found.of_events("drive")?.unwrap_or_default();
    // Clusters of one slide are events at the same drive, with no waiting time between them. In a hold the drive does not change.
    let waiting: Vec<f64> =
        drives.windows(2).map(|pair| pair[1] - pair[0]).filter(|&wait| !M::CLUSTERED || wait > 0.0).collect();
    let events = drives.len();
    drop(drives);
    let mean = (!waiting.is_empty()).then(|| waiting.iter().sum::<f64>() / waiting.len() as f64);
    // A single advance does not vary.
    let variation = mean.filter(|_| waiting.len() > 1).map(|mean| spread(&waiting, mean) / mean);
    drop(waiting);
    let magnitudes = found.of_events(M::MAGNITUDE)?.unwrap_or_default();
    let fit = if M::WHOLE { fit_whole(&magnitudes) } else { fit_real(&magnitudes) };
    let at = (0..magnitudes.len()).max_by(|&a, &b| magnitudes[a].total_cmp(&magnitudes[b]));
    let largest = at.map(|at| (at, magnitudes[at]));
    drop(magnitudes);
    Ok(Catalogue {
        cells: interface.size(),
        events,
        unfinished: found.unfinished,
        from: interface.catalogue_from,
        magnitude: M::MAGNITUDE.to_owned(),
        magnitude_unit: units.label(quantity),
        law: fit.map(law),
        mean_waiting: mean,
        waiting_variation: variation,
        largest: largest.map(|(at, magnitude)| read_largest(found, at, magnitude)).transpose()?,
        wave_speed: interface.wave_speed(),
        front_speed: largest
            .filter(|_| interface.wave_speed().is_some())
            .map_or(Ok(None), |(at, _)| front_speed(found, at))?,
        dissipated_breaks: sum(found, "dissipated_breaks")?,
        dissipated_slip: sum(found, "dissipated_slip")?,
        main_shocks: None,
    })
}

/// The sum of a column of events, if there are any.
fn sum(found: &mut Found<'_>, name: &str) -> Result<Option<f64>> {
    let values = found.of_events(name)?.unwrap_or_default();
    Ok((!values.is_empty()).then(|| values.iter().sum()))
}

/// The speed of the faster front of the event with the index `at`, if it has one.
fn front_speed(found: &mut Found<'_>, at: usize) -> Result<Option<f64>> {
    let mut faster = None;
    for name in ["front_speed_left", "front_speed_right"] {
        let speed = found.of_events(name)?.map(|speeds| speeds[at]);
        faster = speed.filter(|speed| speed.is_finite()).into_iter().chain(faster).reduce(f64::max);
    }
    Ok(faster)
}

/// The event with the index `at`.
fn read_largest(found: &mut Found<'_>, at: usize, magnitude: f64) -> Result<Largest> {
    let mut value = |name: &str| -> Result<f64> { Ok(found.of_events(name)?.unwrap_or_default()[at]) };
    Ok(Largest { magnitude, cells: value("cells")?, drive: value("drive")?, event: at + 1 })
}

fn law(fit: CutOff) -> PowerLaw {
    PowerLaw {
        exponent: Fitted { value: fit.exponent, error: fit.error },
        cut_off: Extended(fit.scale),
        cut_off_error: Extended(fit.scale_error),
        from: fit.low,
        events: fit.count,
        distance: fit.distance,
    }
}

fn spread(values: &[f64], mean: f64) -> f64 {
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}
