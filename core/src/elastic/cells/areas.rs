//! Areas of the cells, relative to each other.

use std::sync::Arc;

use crate::{Error, Result};

/// Largest ratio of two areas: forces are in balance to about 1e-11 of the strongest one, and hence to 1e-7 of those of the
/// smallest cell.
const LARGEST_RATIO: f64 = 1e4;

/// Areas a_j of the cells, as multiples of that of a cell whose contacts, spring, viscosity and mass are described. Clones share
/// the numbers.
///
/// A cell of area a_j has a_j times the contacts, hence a_j times the force of a cell of area 1 at the same displacement, and
/// whatever acts on it per area is multiplied by a_j, too: the stiffness K_0 of its spring to the drive, its viscosity η and its
/// mass M. Springs between neighbours do not depend on it.
#[derive(Debug, Clone)]
pub struct CellAreas {
    /// None where each is 1.
    areas: Option<Arc<[f64]>>,
    largest: f64,
}

impl Default for CellAreas {
    /// Areas of 1.
    fn default() -> Self {
        Self { areas: None, largest: 1.0 }
    }
}

impl CellAreas {
    /// Areas of this number of cells, one for each.
    ///
    /// # Errors
    /// Another number of areas than of cells; an area that is not a finite number above 0, naming its cell; areas of which one
    /// is more than 10⁴ times as large as another one.
    pub fn new(areas: Vec<f64>, cells: usize) -> Result<Self> {
        if areas.len() != cells {
            let expected = format!("{cells} areas, one for each cell");
            return Err(Error::invalid("areas", expected, areas.len()));
        }
        if let Some(cell) = areas.iter().position(|&area| !(area.is_finite() && area > 0.0)) {
            return Err(Error::invalid(format!("areas.{cell}"), "a number above 0", areas[cell]));
        }
        let [least, largest] = [f64::min, f64::max].map(|of| areas.iter().copied().reduce(of).unwrap_or(1.0));
        if largest > LARGEST_RATIO * least {
            let expected = format!(
                "areas of which none is more than {LARGEST_RATIO} times as large as another one, whose forces would be inaccurate"
            );
            return Err(Error::invalid("areas", expected, format!("{least} and {largest}")));
        }
        Ok(Self { areas: Some(areas.into()), largest })
    }

    /// All areas; `None` where each is 1.
    pub fn all(&self) -> Option<&[f64]> {
        self.areas.as_deref()
    }

    /// a_j.
    #[inline]
    pub fn of(&self, cell: usize) -> f64 {
        self.areas.as_ref().map_or(1.0, |areas| areas[cell])
    }

    /// The largest area.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// Area of the first `cells` together.
    pub fn total(&self, cells: usize) -> f64 {
        self.areas.as_ref().map_or(cells as f64, |areas| areas[..cells].iter().sum())
    }

    /// Mean of a value of each cell, weighted by area.
    pub fn mean(&self, values: &[f64]) -> f64 {
        let sum: f64 = match self.all() {
            None => values.iter().sum(),
            Some(areas) => values.iter().zip(areas).map(|(value, area)| area * value).sum(),
        };
        sum / self.total(values.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_above_0_one_for_each_cell_and_not_too_different() {
        let refused = |areas: &[f64]| CellAreas::new(areas.to_vec(), 2).unwrap_err().to_string();
        assert!(refused(&[1.0]).starts_with("areas: expected 2 areas, one for each cell, got 1"));
        for area in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = refused(&[1.0, area]);
            assert!(error.starts_with("areas.1: expected a number above 0, got "), "{error}");
        }
        assert!(refused(&[1.0, 1.1e4]).starts_with("areas: "));
        assert!(CellAreas::new(vec![1.0, 1e4], 2).is_ok());
    }

    #[test]
    fn means_are_weighted_by_area() {
        let areas = CellAreas::new(vec![3.0, 1.0], 2).unwrap();
        assert_eq!((areas.total(1), areas.total(2), areas.largest()), (3.0, 4.0, 3.0));
        assert_eq!((areas.mean(&[1.0, 5.0]), CellAreas::default().mean(&[1.0, 5.0])), (2.0, 3.0));
    }
}
