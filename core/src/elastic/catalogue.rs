//! From the cells that slipped in a slide to events: each part of them that hangs together is one.

use super::batch::largest;
use super::differences::Differences;
use super::{Event, Interface, Slip, Slipped};
use crate::shape::{Edges, Shape};

/// How far creep takes a cell to where balance is lost, in √(drive tolerance × length on which slopes change), and again
/// as far past it.
const CREEP: f64 = 4.0;

/// A cell that goes less far than this part of the way of the one that goes farthest has been pulled along.
const ALONG: f64 = 0.1;

/// Cells that make a front, which fewer would not tell from the patch where slip began.
const FRONT: usize = 5;

/// A slide, as it is followed.
pub(super) struct ClusterSlide {
    /// Positions before.
    pub before: Vec<f64>,
    /// What they did not tell.
    pub differences: Option<Differences>,
    /// Friction force before.
    pub force: f64,
    /// Work done on the contacts before.
    pub work: f64,
    /// Cells that lost their balance, in the order in which they did.
    pub fallen: Vec<u32>,
    /// When they did; NaN where they did not.
    pub starts: Vec<f64>,
    /// Whether contacts broke together.
    pub together: bool,
    /// When it was over.
    pub over: f64,
}

impl ClusterSlide {
    /// Whether a cell has lost its balance.
    pub fn has_fallen(&self, cell: usize) -> bool {
        !self.starts[cell].is_nan()
    }
}

impl Interface {
    /// The events of a slide that is over and has left this force, in the order in which they began; pulls are known
    /// halfway.
    pub(super) fn events(&self, slide: &ClusterSlide, force_after: f64) -> Vec<(Event, Vec<Slipped>)> {
        let parts = self.parts(slide).into_iter();
        parts.map(|slipped| (self.event(slide, &slipped, force_after), slipped)).collect()
    }

    /// How far cells have to go in a slide to slip in it; none where those do that lost their balance, however far they go.
    fn least_slip(&self, slide: &ClusterSlide) -> Option<f64> {
        if slide.together || self.setting.slip == Slip::Reset {
            return None;
        }
        let most = largest(self.len(), |cell| self.positions[cell] - slide.before[cell]);
        Some((ALONG * most).max(CREEP * (self.setting.drive_tolerance * self.length()).sqrt()))
    }

    /// Cells that slipped and hang together, over others that went as far with them, each part in the order in which its
    /// cells began to slip.
    fn parts(&self, slide: &ClusterSlide) -> Vec<Vec<Slipped>> {
        const NONE: u32 = u32::MAX;
        let slip = |cell: usize| self.positions[cell] - slide.before[cell];
        let least = self.least_slip(slide);
        let goes = |cell: usize| least.map_or_else(|| slide.has_fallen(cell), |least| slip(cell) > least);
        let slipped = || slide.fallen.iter().map(|&cell| cell as usize).filter(|&cell| goes(cell));
        let mut part_of = vec![NONE; self.len()];
        let mut parts: Vec<Vec<Slipped>> = Vec::new();
        for first in slipped() {
            if part_of[first] != NONE {
                continue;
            }
            let part = parts.len() as u32;
            part_of[first] = part;
            let (mut reached, mut number) = (vec![first], 1);
            while let Some(cell) = reached.pop() {
                for next in beside(cell, self.coupling.shape(), self.coupling.edges()) {
                    if goes(next) && part_of[next] == NONE {
                        part_of[next] = part;
                        reached.push(next);
                        number += 1;
                    }
                }
            }
            parts.push(Vec::with_capacity(number));
        }
        let begun = slipped().next().map_or(0.0, |first| slide.starts[first]);
        for cell in slipped() {
            let start = slide.starts[cell] - begun;
            parts[part_of[cell] as usize].push(Slipped { cell, start, slip: slip(cell) });
        }
        parts
    }

    fn event(&self, slide: &ClusterSlide, slipped: &[Slipped], force_after: f64) -> Event {
        let all = |of: &dyn Fn(usize) -> f64| slipped.iter().map(|s| of(s.cell)).sum::<f64>();
        let mean = |of: &dyn Fn(usize) -> f64| all(of) / slipped.len() as f64;
        let timed = self.setting.viscosity.map_or(f64::NAN, |_| 1.0);
        let [front_speed_left, front_speed_right] = fronts(slipped, self.coupling.shape()).map(|v| timed * v);
        let begun = slide.starts[slipped[0].cell];
        let area = self.setting.area.unwrap_or(1.0);
        Event {
            drive: self.drive,
            time: timed * (self.time + begun),
            epicentre: slipped[0].cell,
            cells: slipped.len(),
            area: area * slipped.len() as f64,
            moment: area * slipped.iter().map(|s| s.slip).sum::<f64>(),
            duration: timed * (slide.over - begun),
            front_speed_left,
            front_speed_right,
            position_before: mean(&|cell| slide.before[cell]),
            position_after: mean(&|cell| self.positions[cell]),
            force_before: slide.force,
            force_after,
            broken_fraction: all(&|cell| self.cells.since(cell).broken) / self.len() as f64,
            dissipated_breaks: all(&|cell| self.cells.since(cell).lost),
            dissipated_slip: all(&|cell| self.pulled(slide, cell) - self.cells.since(cell).work),
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

/// Speeds at which slip spread from the first cell towards smaller and larger columns of its row: cells per time; NaN
/// where fewer than [`FRONT`] cells beside each other began one after the other.
pub(super) fn fronts(slipped: &[Slipped], shape: Shape) -> [f64; 2] {
    let columns = shape.sides()[1];
    let epicentre = slipped[0].cell;
    let row = epicentre / columns;
    let mut starts: Vec<(usize, f64)> =
        slipped.iter().filter(|s| s.cell / columns == row).map(|s| (s.cell, s.start)).collect();
    starts.sort_by_key(|(cell, _)| *cell);
    let first = starts.partition_point(|(cell, _)| *cell < epicentre);
    let (left, right) = (&starts[..=first], &starts[first..]);
    let left: Vec<f64> = run(left.iter().rev());
    let right: Vec<f64> = run(right.iter());
    [left, right].map(|starts| speed(&starts))
}

/// Starts of cells that lie beside each other and begin one after the other, from the first on.
fn run<'a>(starts: impl Iterator<Item = &'a (usize, f64)> + Clone) -> Vec<f64> {
    let pairs = starts.clone().zip(starts.clone().skip(1));
    let follow = |(one, next): &(&(usize, f64), &(usize, f64))| one.0.abs_diff(next.0) == 1 && next.1 > one.1;
    let length = 1 + pairs.take_while(follow).count();
    starts.take(length).map(|(_, start)| *start).collect()
}

/// Distance per time of starts at distances 0, 1, 2, …, by least squares of the starts over the distance; of the middle
/// half of them, as slip hesitates where it begins and hurries where it ends.
fn speed(starts: &[f64]) -> f64 {
    if starts.len() < FRONT {
        return f64::NAN;
    }
    let quarter = starts.len() / 4;
    let starts = &starts[quarter..starts.len() - quarter];
    let number = starts.len() as f64;
    let (middle, mean) = (0.5 * (number - 1.0), starts.iter().sum::<f64>() / number);
    let (mut both, mut square) = (0.0, 0.0);
    for (i, start) in starts.iter().enumerate() {
        let distance = i as f64 - middle;
        both += distance * (start - mean);
        square += distance * distance;
    }
    square / both
}
