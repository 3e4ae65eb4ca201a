//! Statistics of the events of an interface.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Extended, Fitted};

/// A catalogue of events.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Catalogue {
    /// Number of cells, or of contacts coupled one by one.
    pub cells: usize,
    /// Number of events recorded.
    pub events: usize,
    /// Number of events that had not ended when the run did; they are not recorded.
    #[serde(default, skip_serializing_if = "is_none")]
    pub unfinished: usize,
    /// Drive from which events are recorded.
    pub from: f64,
    /// Name of the column of `events.csv` with the magnitude of an event.
    pub magnitude: String,
    /// Unit of the magnitude, `1` if it has none.
    pub magnitude_unit: String,
    /// The distribution of magnitudes; absent if there are too few events.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<PowerLaw>,
    /// Mean advance of the drive from event to event; absent for fewer than two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_waiting: Option<f64>,
    /// Coefficient of variation of these advances: 1 for a Poisson process; absent for fewer than two advances.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub waiting_variation: Option<f64>,
    /// The largest event; absent if there are no events.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest: Option<Largest>,
    /// Speed of long waves along the cells, in cells per time; absent for cells without mass and on a half-space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wave_speed: Option<f64>,
    /// Speed of the faster front of the largest event, in cells per time; absent without wave speed and without fronts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front_speed: Option<f64>,
    /// Energy dissipated by breaks in all events.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dissipated_breaks: Option<f64>,
    /// Energy dissipated in addition by the slips of all events.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dissipated_slip: Option<f64>,
    /// Foreshocks and aftershocks; absent without `interface.main_shocks`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub main_shocks: Option<MainShockNumbers>,
}

/// Whether there are no such events.
fn is_none(events: &usize) -> bool {
    *events == 0
}

/// Foreshocks and aftershocks of the main shocks of a catalogue: the largest events of their windows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MainShockNumbers {
    /// Lowest size of a main shock.
    pub size: u64,
    /// Length of the window on each side, a time, or a length for contacts without time.
    pub window: f64,
    /// Number of main shocks.
    pub count: usize,
    /// Events in the windows after main shocks.
    pub aftershocks: usize,
    /// Events in the windows before main shocks.
    pub foreshocks: usize,
    /// Omori's law for aftershocks; absent if there are too few, or none is found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aftershock_law: Option<OmoriLaw>,
    /// The same law for foreshocks, in the time before the main shock.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub foreshock_law: Option<OmoriLaw>,
}

/// The modified Omori law n(t) = K/(t + c)^p + B, fitted by maximum likelihood.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OmoriLaw {
    /// Exponent p, with its standard error for independent events.
    pub exponent: Fitted,
    /// Delay c, a time, or a length for contacts without time.
    pub delay: f64,
    /// Fraction of the events that belong to the background B.
    pub background: f64,
}

/// p(x) ∝ x^{−τ} e^{−x/ξ} for magnitudes x from `from`, fitted by maximum likelihood.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PowerLaw {
    /// Exponent τ, with its standard error for independent events.
    pub exponent: Fitted,
    /// Cut-off ξ.
    pub cut_off: Extended,
    /// Standard error of ξ.
    pub cut_off_error: Extended,
    /// Lowest magnitude of the fit.
    pub from: f64,
    /// Number of events from that magnitude.
    pub events: usize,
    /// Kolmogorov–Smirnov distance between fit and events.
    pub distance: f64,
}

impl PowerLaw {
    /// Whether the cut-off is significant: its standard error is smaller than the cut-off itself.
    pub fn is_cut_off(&self) -> bool {
        self.cut_off_error.0 < self.cut_off.0
    }
}

/// The largest event.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Largest {
    /// Number of the event, counted from 1 as in `events.csv`.
    pub event: usize,
    /// Magnitude of the event.
    pub magnitude: f64,
    /// Number of cells that took part.
    pub cells: f64,
    /// Drive at the event.
    pub drive: f64,
}
