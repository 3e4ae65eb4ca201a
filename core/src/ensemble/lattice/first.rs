//! First breaks: the drive at which each contact of a lattice breaks for the first time.

use super::{Lattice, REPORT};
use crate::Result;
use crate::monitor::{Aside, Monitor, report};

impl Lattice {
    /// Drives the contacts until each has broken; returns the drives of their first breaks, along rows.
    ///
    /// # Errors
    /// Stopped by the monitor, which receives the fraction that has broken, as [`Lattice::next_event`].
    pub fn first_breaks(&mut self, monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
        let mut first = vec![f64::INFINITY; self.size()];
        let (mut broken, mut events, mut fraction) = (0, 0, 0.0);
        while broken < first.len() {
            if events % REPORT == 0 {
                fraction = broken as f64 / first.len() as f64;
                report(monitor, fraction)?;
            }
            let drive = self.next_event(&mut Aside { fraction, monitor })?.drive;
            for contact in self.broken_contacts() {
                broken += usize::from(first[contact] == f64::INFINITY);
                first[contact] = first[contact].min(drive);
            }
            events += 1;
        }
        report(monitor, 1.0)?;
        Ok(first)
    }
}
