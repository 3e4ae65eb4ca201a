//! Event detection in time: cells that slip, and the connected sets of them.

use serde::{Deserialize, Serialize};

use crate::dynamics::{SLIP_VELOCITY, crossing};
use crate::elastic::catalogue::{beside, fronts};
use crate::elastic::{Coupling, Event, Slipped};
use crate::numerics::order::sort_by_number;

/// A cell at one time.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Seen {
    pub position: f64,
    pub velocity: f64,
    /// With a mass, the highest velocity of its swing about where forces balance; without, its velocity.
    pub speed: f64,
    pub force: f64,
    /// Energy lost in breaks so far.
    pub lost: f64,
    /// Breaks so far, per contact.
    pub broken: f64,
    /// Energy lost by viscous drag so far.
    pub viscous: f64,
}

/// All cells at one time.
#[derive(Debug, Clone)]
pub(super) struct MotionSnapshot {
    pub time: f64,
    pub drive: f64,
    pub cells: Vec<Seen>,
}

/// Cells that slip, and events that have not ended or have not been returned.
///
/// An event begins with a cell that moves fast where no other event is beside it. Cells that begin to move beside a cell of an
/// event that is not over belong to it, and make one event of all that are beside them. It is over when none of its cells
/// moves any more.
///
/// Cells with a mass move with every wave that passes, and swing to rest. They are part of the motion that makes one event, but
/// are counted, and begin to slip, only where their friction falls as they move forward, since breaks lower it faster than
/// contacts are stretched.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Slips {
    /// Fraction of the contacts of a cell that breaks in the smallest event.
    #[serde(skip)]
    fraction: f64,
    /// Area of a cell of relative area 1, if it has one.
    #[serde(skip)]
    pub area: Option<f64>,
    /// Relative areas a_j of the cells.
    #[serde(skip)]
    areas: Vec<f64>,
    /// Whether cells have a mass.
    #[serde(skip)]
    inertial: bool,
    /// Whether a cell moves fast.
    moving: Vec<bool>,
    /// The number of the event that a cell belongs to.
    member: Vec<Option<u64>>,
    /// Events in the order in which they began.
    events: Vec<OpenEvent>,
    next: u64,
}

/// An event that has not been returned.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct OpenEvent {
    number: u64,
    /// Where the drive was when it began, and the friction force of all cells.
    begun: (f64, f64),
    started: Vec<Started>,
    outcome: Outcome,
}

/// What came of an event.
#[derive(Debug, Clone, Serialize, Deserialize)]
enum Outcome {
    /// Cells slip.
    OpenEvent,
    /// It was too small to count.
    Small,
    /// It is over.
    Over(Event, Vec<Slipped>),
}

/// A cell that began to move.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Started {
    cell: usize,
    /// What it was when it began to move.
    at: Seen,
    /// When it began to slip, if it has.
    slips: Option<f64>,
}

impl Seen {
    fn between(&self, next: &Self, share: f64) -> Self {
        let between = |value: fn(&Self) -> f64| value(self) + share * (value(next) - value(self));
        // Friction jumps where a cell comes to rest: what holds it there is less than its contacts bear as they slide.
        let stops = self.velocity > 0.0 && next.velocity == 0.0;
        let force = if stops { next.force } else { between(|s| s.force) };
        Self {
            position: between(|s| s.position),
            velocity: between(|s| s.velocity),
            speed: between(|s| s.speed),
            force,
            lost: between(|s| s.lost),
            broken: between(|s| s.broken),
            viscous: between(|s| s.viscous),
        }
    }
}

impl MotionSnapshot {
    /// The look at a part of the way to the next one, all values straight in time.
    fn between(&self, next: &Self, share: f64) -> Self {
        let cells = self.cells.iter().zip(&next.cells).map(|(seen, next)| seen.between(next, share));
        Self {
            time: self.time + share * (next.time - self.time),
            drive: self.drive + share * (next.drive - self.drive),
            cells: cells.collect(),
        }
    }

    /// Friction force of all cells.
    pub fn force(&self) -> f64 {
        self.cells.iter().map(|seen| seen.force).sum()
    }
}

impl OpenEvent {
    fn is_over(&self) -> bool {
        !matches!(self.outcome, Outcome::OpenEvent)
    }
}

impl Slips {
    pub fn new(areas: Vec<f64>, fraction: f64, area: Option<f64>, inertial: bool) -> Self {
        let (moving, member) = (vec![false; areas.len()], vec![None; areas.len()]);
        Self { fraction, area, areas, inertial, moving, member, events: Vec::new(), next: 0 }
    }

    /// Updates the events after a step between two snapshots, at a velocity of the drive.
    pub fn pass(
        &mut self,
        before: &MotionSnapshot,
        now: &MotionSnapshot,
        velocity: f64,
        coupling: &dyn Coupling,
    ) {
        let fast = SLIP_VELOCITY * velocity;
        // A cell begins to move where its velocity passes the limit, and ends where it will not pass it again as it swings.
        let passing = |j: usize| {
            let of = if self.moving[j] { |seen: &Seen| seen.speed } else { |seen: &Seen| seen.velocity };
            [&before.cells[j], &now.cells[j]].map(of)
        };
        let share = |j: usize| crossing(passing(j)[0], passing(j)[1], fast);
        let change = |j: &usize| (passing(*j)[1] > fast) != self.moving[*j];
        let mut changed: Vec<(usize, f64)> =
            (0..self.moving.len()).filter(change).map(|j| (j, share(j))).collect();
        // In the order of time: the event of a cell depends on which of its neighbours move at that moment.
        sort_by_number(&mut changed, |item| item.1);
        let mut last = vec![None; self.moving.len()];
        for (cell, share) in changed {
            self.moving[cell] = !self.moving[cell];
            if self.moving[cell] {
                self.start(cell, share, before, now, coupling);
            } else {
                last[cell] = Some(share);
            }
        }
        if self.inertial {
            self.find_falling(before, now, fast);
        }
        for index in 0..self.events.len() {
            let event = &self.events[index];
            if event.is_over() || event.started.iter().any(|s| self.moving[s.cell]) {
                continue;
            }
            let share = event.started.iter().filter_map(|s| last[s.cell]).fold(0.0, f64::max);
            let outcome = self.outcome(event, &before.between(now, share), coupling);
            for started in &event.started {
                self.member[started.cell] = None;
            }
            self.events[index].outcome = outcome;
        }
    }

    /// Cells with a mass begin to slip where they move forward, fast, while their friction falls: from where they were fast, or from
    /// the beginning of the step if they were before.
    fn find_falling(&mut self, before: &MotionSnapshot, now: &MotionSnapshot, fast: f64) {
        let begins = |cell: usize| {
            let [was, is] = [&before.cells[cell], &now.cells[cell]];
            let falls = is.force < was.force && is.position > was.position;
            let share = if was.velocity > fast { 0.0 } else { crossing(was.velocity, is.velocity, fast) };
            (falls && is.velocity > fast).then_some(before.time + share * (now.time - before.time))
        };
        let open = self.events.iter_mut().filter(|event| !event.is_over());
        for started in open.flat_map(|event| &mut event.started).filter(|started| started.slips.is_none()) {
            started.slips = begins(started.cell);
        }
    }

    /// A cell begins to move at the fraction `share` of the time between two snapshots.
    fn start(
        &mut self,
        cell: usize,
        share: f64,
        before: &MotionSnapshot,
        now: &MotionSnapshot,
        coupling: &dyn Coupling,
    ) {
        if self.member[cell].is_some() {
            return;
        }
        let time = before.time + share * (now.time - before.time);
        let at = before.cells[cell].between(&now.cells[cell], share);
        let started = Started { cell, at, slips: (!self.inertial).then_some(time) };
        let mut numbers: Vec<u64> =
            beside(cell, coupling.shape(), coupling.edges()).filter_map(|j| self.member[j]).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let Some(&first) = numbers.first() else {
            let look = before.between(now, share);
            let (number, begun) = (self.next, (look.drive, look.force()));
            self.events.push(OpenEvent {
                number,
                begun,
                started: vec![started],
                outcome: Outcome::OpenEvent,
            });
            self.member[cell] = Some(number);
            self.next += 1;
            return;
        };
        // The cell connects the events around it. They merge into the earliest one, with the smallest number.
        let mut joined = vec![started];
        self.events.retain_mut(|event| {
            let merges = numbers[1..].contains(&event.number);
            if merges {
                joined.append(&mut event.started);
            }
            !merges
        });
        joined.iter().for_each(|started| self.member[started.cell] = Some(first));
        if let Some(event) = self.events.iter_mut().find(|event| event.number == first) {
            event.started.append(&mut joined);
        }
    }

    /// The outcome of an event that has ended at the snapshot `end`.
    fn outcome(&self, event: &OpenEvent, end: &MotionSnapshot, coupling: &dyn Coupling) -> Outcome {
        let mut started: Vec<(f64, Started)> =
            event.started.iter().filter_map(|started| Some((started.slips?, *started))).collect();
        started.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cell.cmp(&b.1.cell)));
        let Some(&(time, Started { cell: epicentre, .. })) = started.first() else { return Outcome::Small };
        let part = |of: fn(&Seen) -> f64, s: &Started| of(&end.cells[s.cell]) - of(&s.at);
        if !started.iter().any(|(_, s)| part(|seen| seen.broken, s) >= self.fraction) {
            return Outcome::Small;
        }
        let all = |of: fn(&Seen) -> f64| started.iter().map(|(_, s)| part(of, s)).sum::<f64>();
        let (drive, force_before) = event.begun;
        let area_of = |s: &Started| self.areas[s.cell];
        let slipped_area: f64 = started.iter().map(|(_, s)| area_of(s)).sum();
        let on_area =
            |of: &dyn Fn(&Started) -> f64| started.iter().map(|(_, s)| area_of(s) * of(s)).sum::<f64>();
        let slip = |s: &Started| part(|seen| seen.position, s);
        let slipped: Vec<Slipped> =
            started.iter().map(|(at, s)| Slipped { cell: s.cell, start: at - time, slip: slip(s) }).collect();
        let mean = |of: &dyn Fn(&Started) -> f64| on_area(of) / slipped_area;
        let [front_speed_left, front_speed_right] = fronts(&slipped, coupling.shape(), coupling.edges());
        let area = self.area.unwrap_or(1.0);
        let event = Event {
            drive,
            time,
            epicentre,
            cells: started.len(),
            area: area * slipped_area,
            moment: area * on_area(&slip),
            duration: end.time - time,
            front_speed_left,
            front_speed_right,
            position_before: mean(&|s| s.at.position),
            position_after: mean(&|s| end.cells[s.cell].position),
            force_before,
            force_after: end.force(),
            broken_fraction: on_area(&|s| part(|seen| seen.broken, s)) / self.areas.iter().sum::<f64>(),
            dissipated_breaks: all(|seen| seen.lost),
            dissipated_slip: all(|seen| seen.viscous),
        };
        Outcome::Over(event, slipped)
    }

    /// Events that have ended, up to the first one that has not, in the order in which they began.
    pub fn take_ended(&mut self) -> Vec<(Event, Vec<Slipped>)> {
        let over = self.events.iter().take_while(|event| event.is_over()).count();
        Self::outcomes(self.events.drain(..over))
    }

    /// All events that have ended, at the end of a motion: also those that began after one that has not ended.
    pub fn take_all_ended(&mut self) -> Vec<(Event, Vec<Slipped>)> {
        let (over, open) = std::mem::take(&mut self.events).into_iter().partition(OpenEvent::is_over);
        self.events = open;
        Self::outcomes(over)
    }

    /// Events in which cells have begun to slip, and that have not ended.
    pub fn unfinished(&self) -> usize {
        let slips =
            |event: &&OpenEvent| !event.is_over() && event.started.iter().any(|cell| cell.slips.is_some());
        self.events.iter().filter(slips).count()
    }

    fn outcomes(over: impl IntoIterator<Item = OpenEvent>) -> Vec<(Event, Vec<Slipped>)> {
        let ended = |event: OpenEvent| match event.outcome {
            Outcome::Over(event, slipped) => Some((event, slipped)),
            Outcome::OpenEvent | Outcome::Small => None,
        };
        over.into_iter().filter_map(ended).collect()
    }

    /// Restores the state of an interface of the same parameters.
    pub fn resume(&mut self, kept: Self) {
        let Self { fraction, area, inertial, .. } = *self;
        let areas = std::mem::take(&mut self.areas);
        *self = Self { fraction, area, areas, inertial, ..kept };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elastic::coupling::neighbours;
    use crate::shape::{Edges, Shape};

    /// Looks at a chain of nine cells at whole times, velocities alone given; of contacts, each cell breaks all in a time.
    fn looks(velocities: &[[f64; 9]]) -> Vec<MotionSnapshot> {
        let seen = |time: f64, velocity: f64| Seen {
            position: time,
            velocity,
            speed: velocity,
            force: -time,
            lost: 0.0,
            broken: time,
            viscous: 0.0,
        };
        let look = |(i, velocities): (usize, &[f64; 9])| {
            let time = i as f64;
            MotionSnapshot {
                time,
                drive: 0.1 * time,
                cells: velocities.iter().map(|v| seen(time, *v)).collect(),
            }
        };
        velocities.iter().enumerate().map(look).collect()
    }

    fn ended(velocities: &[[f64; 9]], fraction: f64) -> Vec<(Event, Vec<Slipped>)> {
        let coupling = neighbours(Shape::Chain(9), Edges::Open, 1.0).unwrap();
        let mut slips = Slips::new(vec![1.0; 9], fraction, None, false);
        let mut all = Vec::new();
        for pair in looks(velocities).windows(2) {
            slips.pass(&pair[0], &pair[1], 1.0, coupling.as_ref());
            all.append(&mut slips.take_ended());
        }
        all
    }

    #[test]
    fn cells_beside_each_other_slip_together_and_apart_they_do_not() {
        let velocities = [
            [0.0; 9],
            [20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 40.0],
            [20.0, 20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 20.0, 20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0; 9],
        ];
        let events = ended(&velocities, 0.0);
        let cells = |i: usize| events[i].1.iter().map(|slipped| slipped.cell).collect::<Vec<_>>();
        // Ten times as fast as the drive at a quarter of the first step, and no longer at three quarters of the second.
        assert_eq!((cells(0), events[0].0.time, events[0].0.duration), (vec![8], 0.25, 1.5));
        assert_eq!((cells(1), events[1].0.time, events[1].0.duration), (vec![0, 1, 2], 0.5, 3.0));
        let starts: Vec<f64> = events[1].1.iter().map(|slipped| slipped.start).collect();
        assert_eq!(starts, [0.0, 1.0, 2.0]);
        let Event { moment, force_before, force_after, broken_fraction, .. } = events[1].0;
        // Two cells come to rest in the last step, and have the friction of its end.
        assert_eq!((moment, force_before, force_after), (3.0 + 2.0 + 1.0, -4.5, 7.0 * -3.5 + 2.0 * -4.0));
        assert_eq!(broken_fraction, 6.0 / 9.0);
        assert_eq!(events.len(), 2);
    }

    #[test]
    fn what_grows_together_is_one_event_that_began_first() {
        let velocities = [
            [0.0; 9],
            [0.0, 20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0],
            [0.0, 0.0, 20.0, 0.0, 20.0, 0.0, 0.0, 0.0, 20.0],
            [0.0, 0.0, 20.0, 20.0, 0.0, 0.0, 0.0, 0.0, 20.0],
            [0.0; 9],
        ];
        let events = ended(&velocities, 0.0);
        let cells = |i: usize| events[i].1.iter().map(|slipped| slipped.cell).collect::<Vec<_>>();
        // That of cell 1 is over when cell 2 begins, as they are fast and slow at the same time.
        assert_eq!(events.iter().map(|event| event.0.time).collect::<Vec<_>>(), [0.5, 0.5]);
        assert_eq!((cells(0), cells(1)), (vec![1, 2, 4, 3], vec![8]));
        assert_eq!(events[0].0.epicentre, 1);
    }

    #[test]
    fn what_ended_beside_a_slip_that_goes_on_is_taken_at_the_end() {
        let mut velocities = [[0.0; 9]; 4];
        (1..4).for_each(|look| velocities[look][0] = 20.0);
        velocities[1][8] = 15.0;
        let coupling = neighbours(Shape::Chain(9), Edges::Open, 1.0).unwrap();
        let mut slips = Slips::new(vec![1.0; 9], 0.0, None, false);
        for pair in looks(&velocities).windows(2) {
            slips.pass(&pair[0], &pair[1], 1.0, coupling.as_ref());
        }
        assert!(slips.take_ended().is_empty());
        let epicentres: Vec<usize> =
            slips.take_all_ended().iter().map(|(event, _)| event.epicentre).collect();
        assert_eq!(epicentres, [8]);
        assert!(slips.take_all_ended().is_empty());
        assert_eq!(slips.unfinished(), 1);
    }

    #[test]
    fn too_few_breaks_are_no_event() {
        let velocities = [[0.0; 9], [0.0, 0.0, 0.0, 20.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0; 9]];
        assert_eq!((ended(&velocities, 0.9).len(), ended(&velocities, 1.1).len()), (1, 0));
    }
}
