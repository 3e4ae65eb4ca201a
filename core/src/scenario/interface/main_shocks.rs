//! `[interface.main_shocks]`: large events, around which the rate of other events is measured.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::positive;
use crate::{Error, Result};

/// The large events of a catalogue of contacts coupled one by one, around which the rate of other events is averaged (foreshocks and aftershocks). A main
/// shock is the largest event within the window before and after it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MainShocks {
    /// Lowest size of a main shock, 1 or more breaks.
    #[schemars(extend("minimum" = 1))]
    pub size: u64,
    /// Length of the window on each side of a main shock, in mean intervals between events, above 0.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "1"))]
    pub window: f64,
    /// Largest distance of the epicentres of other events from that of the main shock, along rows and along columns, in cells:
    /// beyond it an event is not compared with the main shock and not counted around it; without it all events are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<usize>,
}

impl MainShocks {
    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub(super) fn check(&self) -> Result<()> {
        if self.size == 0 {
            return Err(Error::invalid("size", "1 break or more", 0));
        }
        positive("window", self.window).map(drop)
    }
}
