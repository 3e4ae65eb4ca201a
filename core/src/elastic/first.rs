//! When the contacts of cells break for the first time.

use super::{Interface, Standing};
use crate::first_breaks::{FirstBreaks, broken};
use crate::law::Law;
use crate::monitor::{Monitor, report};
use crate::{Error, Result};

/// The share of contacts whose first break is not waited for.
const UNBROKEN: f64 = 1e-6;

/// Between slides the drive is looked at no farther apart than a mean threshold, and a standard deviation, over these.
const LOOKS: [f64; 2] = [400.0, 40.0];

impl Interface {
    /// Drives cells of relaxed contacts, of which each has thresholds of a law times s_j, until all but 1e-6 of them have
    /// broken, and gives the share that has against the drive (1 − κ) X_T, by which contacts are stretched as long as none
    /// breaks: upright in slides, in a chord between looks.
    ///
    /// `coupling` is κ = F'/(F' + K_0), F' the slope of a cell none of whose contacts has broken: the share of the force that
    /// a contact loses which the others gain together, whatever couples cells. A contact of a cell that has been as far
    /// as X_j has broken if its threshold is s_j x_s ≤ X_j, or if all of that cell have re-formed together.
    ///
    /// All contacts break: no cell is behind (1 − κ) X_T, since the one that is farthest behind is pulled on by the others,
    /// and held by F_j ≤ F' X_j.
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
        if self.connected < self.len() {
            return Err(Error::invalid("loading", "a drive that pulls all cells", "one that pulls some"));
        }
        let end = scale * thresholds.upper_quantile(UNBROKEN);
        let apart = (thresholds.mean() / LOOKS[0]).min(thresholds.std() / LOOKS[1]);
        let looks = (end / apart).ceil() as usize;
        self.path = (self.drive, end / (1.0 - coupling));
        let mut points = vec![(0.0, 0.0)];
        let mut look = |interface: &Self| {
            points.push(((1.0 - coupling) * interface.drive, interface.broken_once(thresholds)));
        };
        for i in 1..=looks {
            if self.broken_once(thresholds) >= 1.0 - UNBROKEN {
                break;
            }
            let drive = self.path.1 * (i as f64 / looks as f64);
            while !self.go(drive, monitor, &mut look)?.is_empty() {}
        }
        report(monitor, 1.0)?;
        Ok(FirstBreaks::of_shares(points))
    }

    /// The largest s_j.
    fn largest_scale(&self) -> Result<f64> {
        let scale = |cell| self.cells.standing(cell).map(|standing| standing.scale);
        (0..self.len()).map(scale).try_fold(0.0, |most: f64, scale| Some(most.max(scale?))).ok_or_else(|| {
            Error::invalid("cells", "cells that share a curve", "cells with populations of their own")
        })
    }

    /// The share of contacts that have broken, once or more often.
    fn broken_once(&self, thresholds: &dyn Law) -> f64 {
        let advance = |cell| match self.cells.standing(cell) {
            Some(Standing { advance, renewed: false, .. }) => advance,
            _ => f64::INFINITY,
        };
        broken(thresholds, (0..self.len()).map(advance))
    }
}
