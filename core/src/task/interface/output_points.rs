//! The drives at which the state of an interface is recorded.

use crate::scenario::{Drive, Interface};

/// A drive at which the state is recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputPoint {
    /// The drive.
    pub drive: f64,
    /// Whether it is a point of the trace.
    pub point: bool,
    /// Whether every cell is recorded.
    pub map: bool,
}

/// The points of the trace, evenly spaced, and the maps of `task`. A chain has a map at every point.
pub fn output_points(task: &Drive, interface: &Interface) -> Vec<OutputPoint> {
    let chain = interface.cells.len() == 1;
    let steps = task.points - 1;
    let point = |i: usize| task.distance() * (i as f64 / steps as f64);
    let points = (0..=steps).map(|i| OutputPoint { drive: point(i), point: true, map: chain });
    let maps = task.maps.iter().map(|&drive| OutputPoint { drive, point: false, map: true });
    let mut output_points: Vec<_> = points.chain(maps).collect();
    output_points.sort_by(|a, b| a.drive.total_cmp(&b.drive));
    output_points.dedup_by(|next, kept| {
        let same = next.drive == kept.drive;
        if same {
            (kept.point, kept.map) = (kept.point || next.point, kept.map || next.map);
        }
        same
    });
    output_points
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
            disorder: None,
            drive_tolerance: 1e-6,
            catalogue_from: 0.0,
        }
    }

    #[test]
    fn points_and_maps_go_together_in_order() {
        let task = Drive { distance: Some(2.0), points: 3, maps: vec![0.5, 1.0], ..Drive::default() };
        let lattice = Interface { cells: vec![3, 4], ..chain() };
        let at = |drive, point, map| OutputPoint { drive, point, map };
        let expected =
            [at(0.0, true, false), at(0.5, false, true), at(1.0, true, true), at(2.0, true, false)];
        assert_eq!(output_points(&task, &lattice), expected);
        assert!(output_points(&task, &chain()).iter().all(|output| output.map));
    }
}
