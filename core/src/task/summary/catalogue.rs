//! What is quoted of the events of an interface.

use serde::{Deserialize, Serialize};

use super::{Extended, Fitted};

/// A catalogue of events.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Catalogue {
    /// Number of cells, or of contacts coupled one by one.
    pub cells: usize,
    /// Number of events recorded.
    pub events: usize,
    /// Drive from which on they are.
    pub from: f64,
    /// The column of `events.csv` that tells how large an event is.
    pub magnitude: String,
    /// Its unit, `1` where it has none.
    pub magnitude_unit: String,
    /// The law of magnitudes; absent where there are too few events.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<PowerLaw>,
    /// Mean advance of the drive from event to event; absent for fewer than two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_waiting: Option<f64>,
    /// Standard deviation of these advances over their mean: 1 for a Poisson process.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub waiting_variation: Option<f64>,
    /// The largest event; absent where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest: Option<Largest>,
    /// Energy lost in breaks, in all events.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dissipated_breaks: Option<f64>,
    /// Energy lost in slips besides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dissipated_slip: Option<f64>,
}

/// p(x) ∝ x^{−τ} e^{−x/ξ} of magnitudes x from a lowest one on, fitted by maximum likelihood.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PowerLaw {
    /// τ, its error being that of independent events.
    pub exponent: Fitted,
    /// ξ.
    pub cut_off: Extended,
    /// Its error.
    pub cut_off_error: Extended,
    /// The lowest magnitude that is fitted.
    pub from: f64,
    /// Events from there on.
    pub events: usize,
    /// Kolmogorov's distance of law and events.
    pub distance: f64,
}

impl PowerLaw {
    /// Whether the events tell that there is a cut-off: where its error is as large as itself, they do not.
    pub fn is_cut_off(&self) -> bool {
        self.cut_off_error.0 < self.cut_off.0
    }
}

/// The largest event.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Largest {
    /// Its number, counted from 1 as in `events.csv`.
    pub event: usize,
    /// Its magnitude.
    pub magnitude: f64,
    /// The cells that took part.
    pub cells: f64,
    /// The drive there.
    pub drive: f64,
}
