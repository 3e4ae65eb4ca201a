//! The drives, or the times, at which the state of an interface is recorded.

use crate::history::History;
use crate::numerics::order::sort_by_number;
use crate::scenario::{Drive, Interface, Protocol};

/// A drive or a time at which the state is recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputPoint {
    /// The drive.
    pub drive: f64,
    /// The time, if it is a point of a protocol.
    pub time: Option<f64>,
    /// Whether it is a point of the trace.
    pub point: bool,
    /// Whether every cell is recorded.
    pub map: bool,
}

impl OutputPoint {
    /// The value of the variable by which the interface advances ([`super::DrivenInterface::progress`]).
    pub fn progress(&self) -> f64 {
        self.time.unwrap_or(self.drive)
    }
}

/// The points of the trace, evenly spaced, and the maps of `task`, counted from the drive `origin`. A chain has a map at every
/// point.
pub fn output_points(task: &Drive, interface: &Interface, origin: f64) -> Vec<OutputPoint> {
    let chain = interface.cells.len() == 1;
    let steps = task.points - 1;
    let point = |i: usize| task.distance() * (i as f64 / steps as f64);
    let at = |distance: f64, point, map| OutputPoint { drive: origin + distance, time: None, point, map };
    let points = (0..=steps).map(|i| at(point(i), true, chain));
    let maps = task.maps.iter().map(|&map| at(map, false, true));
    let mut output_points: Vec<_> = points.chain(maps).collect();
    sort_by_number(&mut output_points, |item| item.drive);
    output_points.dedup_by(|next, kept| {
        let same = next.drive == kept.drive;
        if same {
            (kept.point, kept.map) = (kept.point || next.point, kept.map || next.map);
        }
        same
    });
    output_points
}

/// The points of the trace of a protocol whose drive begins at `origin`. A chain has a map at every point, a lattice at the
/// beginning of each step and at the end of the last one.
pub fn points_in_time(
    task: &Protocol,
    motion: &History,
    interface: &Interface,
    origin: f64,
) -> Vec<OutputPoint> {
    let (chain, knots) = (interface.cells.len() == 1, task.knots());
    let point = |time: f64| OutputPoint {
        drive: origin + motion.position(time),
        time: Some(time),
        point: true,
        map: chain || knots.contains(&time),
    };
    task.times().into_iter().map(point).collect()
}

#[cfg(test)]
mod tests {
    use crate::scenario::{CellLoading, Edges, Elasticity, PerCell};

    use super::*;

    fn chain() -> Interface {
        Interface {
            cells: vec![10],
            contacts: PerCell::One,
            connection: 1.0,
            coupling: Elasticity::Neighbours { stiffness: 1.0 },
            edges: Edges::Open,
            loading: CellLoading::Uniform,
            slip: None,
            viscosity: None,
            mass: None,
            disorder: None,
            areas: None,
            drive_tolerance: 1e-6,
            catalogue_from: 0.0,
            slip_rates: None,
            main_shocks: None,
        }
    }

    #[test]
    fn points_and_maps_go_together_in_order() {
        let task = Drive { distance: Some(2.0), points: 3, maps: vec![0.5, 1.0], ..Drive::default() };
        let lattice = Interface { cells: vec![3, 4], ..chain() };
        let at = |drive, point, map| OutputPoint { drive, time: None, point, map };
        let expected =
            [at(0.0, true, false), at(0.5, false, true), at(1.0, true, true), at(2.0, true, false)];
        assert_eq!(output_points(&task, &lattice, 0.0), expected);
        assert!(output_points(&task, &chain(), 0.0).iter().all(|output| output.map));
        let moved = output_points(&task, &lattice, 1.0).iter().map(|output| output.drive).collect::<Vec<_>>();
        assert_eq!(moved, [1.0, 1.5, 2.0, 3.0]);
    }
}
