//! Statistics of a catalogue of events: distribution of magnitudes, waiting times, largest event.

use crate::numerics::cutoff::{CutOff, fit_real, fit_whole};
use crate::record::{Quantity, Record};
use crate::scenario::{Interface, Units};

use super::model::DrivenInterface;
use crate::task::summary::{Catalogue, Extended, Fitted, Largest, PowerLaw};

/// The statistics of `events`.
pub fn read<M: DrivenInterface>(interface: &Interface, units: &Units, events: &Record) -> Catalogue {
    let column = |name: &str| events.values(name).unwrap_or_default();
    let (drives, magnitudes) = (column("drive"), column(M::MAGNITUDE));
    let fit = if M::WHOLE { fit_whole(magnitudes) } else { fit_real(magnitudes) };
    // Clusters of one slide are events at the same drive, with no waiting time between them.
    let waiting: Vec<f64> =
        drives.windows(2).map(|pair| pair[1] - pair[0]).filter(|&wait| wait > 0.0).collect();
    let mean = (!waiting.is_empty()).then(|| waiting.iter().sum::<f64>() / waiting.len() as f64);
    let sum = |name: &str| {
        events.values(name).filter(|values| !values.is_empty()).map(|values| values.iter().sum())
    };
    Catalogue {
        cells: interface.size(),
        events: drives.len(),
        from: interface.catalogue_from,
        magnitude: M::MAGNITUDE.to_owned(),
        magnitude_unit: units
            .label(events.get(M::MAGNITUDE).map_or(Quantity::Number, |column| column.quantity)),
        law: fit.map(law),
        mean_waiting: mean,
        waiting_variation: mean.map(|mean| spread(&waiting, mean) / mean),
        largest: largest(drives, magnitudes, column("cells")),
        dissipated_breaks: sum("dissipated_breaks"),
        dissipated_slip: sum("dissipated_slip"),
    }
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

fn largest(drives: &[f64], magnitudes: &[f64], cells: &[f64]) -> Option<Largest> {
    let at = (0..magnitudes.len()).max_by(|&a, &b| magnitudes[a].total_cmp(&magnitudes[b]))?;
    Some(Largest { magnitude: magnitudes[at], cells: cells[at], drive: drives[at], event: at + 1 })
}
