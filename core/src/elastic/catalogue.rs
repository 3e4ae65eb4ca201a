//! Event clustering: each connected set of cells that slipped in one slide is an event.

use super::batch::largest;
use super::configuration::Configuration;
use super::residual::InterfaceModel;
use super::slide::SlideRecord;
use super::{CellSlip, Event, Slipped};
use crate::shape::{Edges, Shape};

/// Largest displacement of a cell by creep, in √(drive tolerance × length on which slopes change): to where balance is lost,
/// and again as far past it.
const CREEP: f64 = 4.0;

/// Cells that moved by less than this fraction of the largest displacement were pulled along.
const ALONG: f64 = 0.1;

/// Least number of cells in a front: fewer cannot be distinguished from the patch where slip began. A front that is this far ahead
/// of the last one is another front.
const FRONT: usize = 5;

/// A slide that is over.
pub(super) struct FinishedSlide<'a> {
    pub slide: &'a SlideRecord,
    pub model: &'a InterfaceModel,
    /// Where drive and cells are now.
    pub after: &'a Configuration,
    /// Mean forces of drive and slider on the cells during the slide, see [`InterfaceModel::mean_pulls`].
    pub pulls: &'a [f64],
    /// Forces on all cells before and after it: what pulls them at this drive, and their friction.
    pub forces: [f64; 2],
}

impl FinishedSlide<'_> {
    /// The events of the slide, in the order in which they began, each with the cells that slipped in it.
    pub fn events(&self) -> Vec<(Event, Vec<Slipped>)> {
        let clusters = self.clusters().into_iter();
        clusters.map(|slipped| (self.event(&slipped), slipped)).collect()
    }

    /// Displacement of a cell in the slide.
    fn slip(&self, cell: usize) -> f64 {
        self.after.positions[cell] - self.slide.before.positions[cell]
    }

    /// Displacement above which a cell has slipped; none where every cell that became unstable has.
    fn least_slip(&self) -> Option<f64> {
        let parameters = &self.slide.parameters;
        if self.slide.together || parameters.slip == CellSlip::Reset {
            return None;
        }
        let most = largest(self.model.len(), |cell| self.slip(cell));
        Some((ALONG * most).max(CREEP * (parameters.drive_tolerance * self.model.length()).sqrt()))
    }

    /// Clusters of the cells that slipped, found by flood fill: cells are connected if they are neighbours, or are linked by
    /// neighbours that moved as far without having become unstable. Cells of a cluster are in the order in which they began
    /// to slip.
    fn clusters(&self) -> Vec<Vec<Slipped>> {
        const NONE: u32 = u32::MAX;
        let (slide, coupling) = (self.slide, &self.model.coupling);
        let least = self.least_slip();
        let moves =
            |cell: usize| least.map_or_else(|| slide.is_unstable(cell), |least| self.slip(cell) > least);
        let slipped = || slide.unstable.iter().map(|&cell| cell as usize).filter(|&cell| moves(cell));
        // Flood fill with an explicit stack: linear in the number of cells, and no recursion over
        // clusters of millions.
        let mut cluster_of = vec![NONE; self.model.len()];
        let mut clusters: Vec<(f64, Vec<Slipped>)> = Vec::new();
        // In the order in which cells began to slip, which is then the order of the clusters.
        for first in slipped() {
            if cluster_of[first] != NONE {
                continue;
            }
            let cluster = clusters.len() as u32;
            cluster_of[first] = cluster;
            let (mut reached, mut size) = (vec![first], 1);
            while let Some(cell) = reached.pop() {
                for next in beside(cell, coupling.shape(), coupling.edges()) {
                    if moves(next) && cluster_of[next] == NONE {
                        cluster_of[next] = cluster;
                        reached.push(next);
                        size += 1;
                    }
                }
            }
            clusters.push((slide.starts[first], Vec::with_capacity(size)));
        }
        for cell in slipped() {
            let (begin, cluster) = &mut clusters[cluster_of[cell] as usize];
            cluster.push(Slipped { cell, start: slide.starts[cell] - *begin, slip: self.slip(cell) });
        }
        clusters.into_iter().map(|(_, cluster)| cluster).collect()
    }

    fn event(&self, slipped: &[Slipped]) -> Event {
        let Self { slide, model, after, pulls, forces: [force_before, force_after] } = *self;
        let all = |of: &dyn Fn(usize) -> f64| slipped.iter().map(|s| of(s.cell)).sum::<f64>();
        let areas = model.springs.areas();
        let slipped_area = all(&|cell| areas.of(cell));
        let mean = |of: &dyn Fn(usize) -> f64| all(&|cell| areas.of(cell) * of(cell)) / slipped_area;
        // Without viscosity there is no time.
        let timed = slide.parameters.viscosity.map_or(f64::NAN, |_| 1.0);
        let [front_speed_left, front_speed_right] =
            fronts(slipped, model.coupling.shape(), model.coupling.edges()).map(|v| timed * v);
        let begin = slide.starts[slipped[0].cell];
        let area = slide.parameters.area.unwrap_or(1.0);
        Event {
            drive: after.drive,
            time: timed * (after.time + begin),
            epicentre: slipped[0].cell,
            cells: slipped.len(),
            area: area * slipped_area,
            moment: area * slipped.iter().map(|s| areas.of(s.cell) * s.slip).sum::<f64>(),
            duration: timed * (slide.over - begin),
            front_speed_left,
            front_speed_right,
            position_before: mean(&|cell| slide.before.positions[cell]),
            position_after: mean(&|cell| after.positions[cell]),
            force_before,
            force_after,
            broken_fraction: all(&|cell| model.cells.since_mark(cell).broken) / areas.total(model.len()),
            dissipated_breaks: all(&|cell| model.cells.since_mark(cell).lost),
            dissipated_slip: all(&|cell| pulls[cell] * self.slip(cell) - model.cells.since_mark(cell).work),
        }
    }
}

/// Nearest neighbours of a cell.
pub(super) fn beside(cell: usize, shape: Shape, edges: Edges) -> impl Iterator<Item = usize> {
    let [rows, columns] = shape.sides();
    let (row, column) = (cell / columns, cell % columns);
    let along = move |place: usize, length: usize, on: bool| match (on, edges) {
        (true, _) if place + 1 < length => Some(place + 1),
        (false, _) if place > 0 => Some(place - 1),
        (true, Edges::Periodic) => Some(0),
        (false, Edges::Periodic) => Some(length - 1),
        _ => None,
    };
    let sideways = [false, true].map(|on| along(column, columns, on).map(|column| row * columns + column));
    let across = [false, true].map(|on| along(row, rows, on).map(|row| row * columns + column));
    sideways.into_iter().chain(across).flatten()
}

/// Speeds at which slip spread from the first cell towards smaller and larger columns of its row, in cells per time; NaN
/// where it spread over fewer than [`FRONT`] cells.
pub(super) fn fronts(slipped: &[Slipped], shape: Shape, edges: Edges) -> [f64; 2] {
    let columns = shape.sides()[1];
    let epicentre = slipped[0].cell;
    let in_row = |s: &&Slipped| s.cell / columns == epicentre / columns;
    let starts: Vec<(usize, f64)> =
        slipped.iter().filter(in_row).map(|s| (s.cell % columns, s.start)).collect();
    [false, true].map(|up| speed(&front(&starts, epicentre % columns, up, (columns, edges)).1))
}

/// The front of slip towards smaller numbers of cells, or larger ones (`up`), along a chain of so many cells with these edges, from
/// cells, the times at which they began to slip, and the epicentre: the first distance from it, and the times at which the front had
/// come as far as this and each following distance.
///
/// It has come as far as a distance when a cell there or beyond begins to slip: strong cells may begin later than those ahead of
/// them, or not at all. The first distance is that of the edge of the nucleation patch, whose cells lose balance at the same time;
/// the front ends where it would pass over five cells.
pub fn front(
    starts: &[(usize, f64)],
    epicentre: usize,
    up: bool,
    (cells, edges): (usize, Edges),
) -> (usize, Vec<f64>) {
    let distance = |cell: usize| {
        let (from, to) = if up { (epicentre, cell) } else { (cell, epicentre) };
        match edges {
            // Around the chain up to where fronts from both sides meet.
            Edges::Periodic => Some((to + cells - from) % cells).filter(|d| 2 * d <= cells),
            Edges::Open => to.checked_sub(from),
        }
    };
    let starts: Vec<(usize, f64)> =
        starts.iter().filter_map(|&(cell, start)| Some((distance(cell)?, start))).collect();
    let Some(farthest) = starts.iter().map(|start| start.0).max() else { return (0, Vec::new()) };
    let mut times = vec![f64::INFINITY; farthest + 1];
    starts.iter().for_each(|&(distance, start)| times[distance] = start);
    for i in (0..farthest).rev() {
        times[i] = times[i].min(times[i + 1]);
    }
    let patch = times.iter().take_while(|time| **time == times[0]).count();
    let after = &times[patch.saturating_sub(1)..];
    let together = after.chunk_by(|a, b| a == b).take_while(|run| run.len() <= FRONT);
    (patch.saturating_sub(1), after[..together.map(<[f64]>::len).sum()].to_vec())
}

/// Speed of a front that arrives at distances 0, 1, 2, … at these times, by linear regression of the times. Only the middle
/// half of them counts, since slip is slow where it begins and fast where it ends.
fn speed(times: &[f64]) -> f64 {
    if times.len() < FRONT {
        return f64::NAN;
    }
    let quarter = times.len() / 4;
    let times = &times[quarter..times.len() - quarter];
    let number = times.len() as f64;
    let (middle, mean) = (0.5 * (number - 1.0), times.iter().sum::<f64>() / number);
    // Distances are exact, times scatter: time is regressed on distance, and the speed is the
    // inverse of the slope.
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (i, time) in times.iter().enumerate() {
        let distance = i as f64 - middle;
        covariance += distance * (time - mean);
        variance += distance * distance;
    }
    variance / covariance
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells of a chain that begin to slip at these times.
    fn chain(starts: &[(usize, f64)]) -> Vec<Slipped> {
        let mut slipped: Vec<_> =
            starts.iter().map(|&(cell, start)| Slipped { cell, start, slip: 1.0 }).collect();
        slipped.sort_by(|one, other| one.start.total_cmp(&other.start));
        slipped
    }

    /// A front over `cells` cells from the cell 20, towards larger numbers or smaller ones, `speed` cells per time.
    fn regular(cells: usize, up: bool, speed: f64) -> Vec<(usize, f64)> {
        let place = |i: usize| if up { 20 + i } else { 20 - i };
        (0..cells).map(|i| (place(i), i as f64 / speed)).collect()
    }

    #[test]
    fn front_speeds_are_cells_per_time_to_either_side() {
        let mut starts = regular(12, true, 2.0);
        starts.extend(&regular(9, false, 0.5)[1..]);
        let [left, right] = fronts(&chain(&starts), Shape::Chain(64), Edges::Open);
        // Rounding of the regression.
        assert!((left - 0.5).abs() < 1e-12 && (right - 2.0).abs() < 1e-12, "{left}, {right}");
    }

    #[test]
    fn fronts_have_five_cells_or_more() {
        for (cells, found) in [(4, false), (5, true)] {
            let [left, right] = fronts(&chain(&regular(cells, true, 3.0)), Shape::Chain(64), Edges::Open);
            assert!(left.is_nan());
            assert_eq!(!right.is_nan(), found, "{cells} cells: {right}");
        }
    }

    #[test]
    fn a_front_begins_at_the_edge_of_the_nucleation_patch() {
        let starts: Vec<_> = (0..14_u32).map(|i| (20 + i as usize, f64::from(i.saturating_sub(3)))).collect();
        let [left, right] = fronts(&chain(&starts), Shape::Chain(64), Edges::Open);
        assert!(left.is_nan() && (right - 1.0).abs() < 1e-12, "{left}, {right}");
    }

    #[test]
    fn fronts_go_round_a_periodic_chain() {
        let to_the_left: Vec<_> = (0..12).map(|i| ((64 + 4 - i) % 64, i as f64)).collect();
        let [left, right] = fronts(&chain(&to_the_left), Shape::Chain(64), Edges::Periodic);
        assert!(right.is_nan() && (left - 1.0).abs() < 1e-12, "{left}, {right}");
    }

    #[test]
    fn only_the_middle_half_of_a_front_counts() {
        // Ten times as slow over the first and the last quarter of sixteen cells.
        let mut time = 0.0;
        let starts: Vec<_> = (0..16)
            .map(|i| {
                let start = (20 + i, time);
                time += if (4..11).contains(&i) { 0.5 } else { 5.0 };
                start
            })
            .collect();
        let [_, right] = fronts(&chain(&starts), Shape::Chain(64), Edges::Open);
        assert!((right - 2.0).abs() < 1e-12, "{right}");
    }

    #[test]
    fn a_front_passes_over_strong_cells() {
        let mut late = regular(24, true, 1.0);
        for cell in [9, 14] {
            late[cell].1 = 30.0;
        }
        let mut held = regular(24, true, 1.0);
        held.remove(11);
        for starts in [late, held] {
            let [_, right] = fronts(&chain(&starts), Shape::Chain(64), Edges::Open);
            // It is as early by one at the cells that it passes over.
            assert!((right - 1.0).abs() < 0.03, "{right}");
        }
    }

    #[test]
    fn a_front_ends_where_slip_begins_far_ahead() {
        let mut starts = regular(24, true, 1.0);
        for (_, start) in &mut starts[12..] {
            *start = 5.0;
        }
        // Up to the cell 4, of which the middle half counts.
        let [_, right] = fronts(&chain(&starts), Shape::Chain(64), Edges::Open);
        assert!((right - 1.0).abs() < 1e-12, "{right}");
        starts[4].1 = 5.0;
        let [_, right] = fronts(&chain(&starts), Shape::Chain(64), Edges::Open);
        assert!(right.is_nan(), "{right}");
    }

    #[test]
    fn fronts_of_a_lattice_go_along_the_row_of_the_first_cell() {
        // Rows of 16 cells; the cells of the row below begin at other times.
        let mut starts: Vec<_> = (0..8).map(|i| (16 + 4 + i, i as f64)).collect();
        starts.extend((0..8).map(|i| (32 + 4 + i, 0.1 + 0.1 * i as f64)));
        let [left, right] = fronts(&chain(&starts), Shape::Square([4, 16]), Edges::Open);
        assert!(left.is_nan() && (right - 1.0).abs() < 1e-12, "{left}, {right}");
    }
}
