//! Areas of the cells of an interface.

use super::{Elasticity, Interface};
use crate::elastic::CellAreas;
use crate::{Error, Result};

impl Interface {
    /// Checks the areas of cells of many contacts; keys are relative to this table.
    ///
    /// # Errors
    /// Areas beside a half-space; those of [`CellAreas::new`].
    pub(super) fn check_areas(&self) -> Result<()> {
        let Some(areas) = &self.areas else { return Ok(()) };
        if matches!(self.coupling, Elasticity::HalfSpace { .. }) {
            let expected = "none beside coupling.half_space, whose cells are equal squares";
            return Err(Error::invalid("areas", expected, "areas"));
        }
        CellAreas::new(areas.clone(), self.size()).map(drop)
    }

    /// Areas of the cells divided by their mean; `None` where all are alike.
    pub fn relative_areas(&self) -> Option<Vec<f64>> {
        let areas = self.areas.as_ref()?;
        // Equal areas give the same numbers as none, bit for bit.
        if areas.iter().all(|area| *area == areas[0]) {
            return None;
        }
        let mean = areas.iter().sum::<f64>() / areas.len() as f64;
        Some(areas.iter().map(|area| area / mean).collect())
    }

    /// Number of contacts that are followed in each cell where an ensemble has `size` of them in a cell of mean area: in
    /// proportion to the area, 1 or more.
    pub(super) fn contacts_of_cells(&self, size: usize) -> Vec<usize> {
        match self.relative_areas() {
            None => vec![size; self.size()],
            Some(areas) => areas.iter().map(|area| ((area * size as f64).round() as usize).max(1)).collect(),
        }
    }
}
