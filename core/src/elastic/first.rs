//! The distribution of the drives at which the contacts of cells break for the first time.

use super::{Interface, Standing};
use crate::first_breaks::FirstBreaks;
use crate::law::Law;
use crate::monitor::{Monitor, report};
use crate::{Error, Result};

/// Fraction of contacts whose first break is not waited for.
const UNBROKEN: f64 = 1e-6;

/// Least number of points of the curve per mean threshold, and per standard deviation of thresholds.
const POINTS: [f64; 2] = [400.0, 40.0];

impl Interface {
    /// Drives cells of relaxed contacts until all but 1e-6 of the contacts have broken, and returns the fraction that has
    /// broken against (1 − κ) X_T, the stretch of contacts as long as none breaks. Cell j has thresholds of a law times s_j, and
    /// contacts in proportion to its area.
    /// The curve is vertical in slides, and a chord between two points.
    ///
    /// `coupling` is κ = F'/(F' + K_0), with the slope F' of a cell none of whose contacts has broken: the fraction of the
    /// force lost by a contact that all others gain together, whatever couples the cells. A contact of a cell that has been
    /// as far as X_j has broken if its threshold is s_j x_s ≤ X_j, or if all contacts of that cell have re-formed together.
    ///
    /// All contacts break, because no cell is behind (1 − κ) X_T: the others pull the rearmost cell forward, and its contacts
    /// hold it by F_j ≤ F' X_j.
    ///
    /// # Errors
    /// Cells with populations of their own, whose thresholds are not those of the law; a drive that pulls some cells only.
    /// Those of [`Interface::run`].
    pub fn first_breaks(
        &mut self,
        thresholds: &dyn Law,
        coupling: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<FirstBreaks> {
        let scale = self.largest_scale()?;
        if !self.model.springs.hold_all() {
            return Err(Error::invalid("loading", "a drive that pulls all cells", "one that pulls some"));
        }
        let end = scale * thresholds.upper_quantile(UNBROKEN);
        let apart = (thresholds.mean() / POINTS[0]).min(thresholds.std() / POINTS[1]);
        let number = (end / apart).ceil() as usize;
        self.path = (self.drive(), end / (1.0 - coupling));
        let mut points = vec![(0.0, 0.0)];
        let mut observe = |interface: &Self| {
            points.push(((1.0 - coupling) * interface.drive(), interface.broken_once(thresholds)));
        };
        for i in 1..=number {
            if self.broken_once(thresholds) >= 1.0 - UNBROKEN {
                break;
            }
            let drive = self.path.1 * (i as f64 / number as f64);
            while !self.next_on_path(drive, monitor, &mut observe)?.is_empty() {}
        }
        report(monitor, 1.0)?;
        Ok(FirstBreaks::of_fractions(points))
    }

    /// The largest s_j.
    fn largest_scale(&self) -> Result<f64> {
        let scale = |cell| self.model.cells.standing(cell).map(|standing| standing.scale);
        (0..self.len()).map(scale).try_fold(0.0, |most: f64, scale| Some(most.max(scale?))).ok_or_else(|| {
            Error::invalid("cells", "cells that share a curve", "cells with populations of their own")
        })
    }

    /// Fraction of contacts that have broken, once or more often.
    fn broken_once(&self, thresholds: &dyn Law) -> f64 {
        let advance = |cell| match self.model.cells.standing(cell) {
            Some(Standing { advance, renewed: false, .. }) => advance,
            _ => f64::INFINITY,
        };
        let broken: Vec<f64> = (0..self.len()).map(|cell| thresholds.cumulative(advance(cell))).collect();
        self.areas().mean(&broken)
    }
}
