//! One generation of an avalanche: contacts at their thresholds break, then their neighbours gain force.

use std::ops::Range;

use super::avalanche::{OngoingAvalanche, OngoingGeneration};
use super::clocks::Timekeeping;
use super::motion::site;
use super::{ASK, Lattice};

impl Lattice {
    /// Contacts that break up to this drive break now.
    fn limit(&self) -> f64 {
        self.drive + self.together
    }

    /// Finds the first contacts that break, and returns the epicentre.
    pub(super) fn start_avalanche(&mut self) -> usize {
        self.scar.drain(..).for_each(|place| self.broken[place as usize] = false);
        self.front.clear();
        let limit = self.limit();
        match &self.clocks {
            None => self.minima.up_to(limit, &self.ends, &mut self.front),
            Some(clocks) => {
                let now = clocks.progress(self.drive);
                self.minima.up_to(now.max(clocks.progress(limit)), &clocks.due, &mut self.front);
                // Thermal breaks are simultaneous only if their times are equal.
                let Self { grid, births, born, ends, front, .. } = self;
                front.retain(|&place| {
                    let (place, number) = (place as usize, grid.number(place as usize));
                    let risen = clocks.strengthening(number, births.threshold(born, number));
                    clocks.due[place] <= now || ends[place] <= limit - risen
                });
            }
        }
        let keys = self.keys();
        let key = |&place: &u32| keys[place as usize];
        let first = self.front.iter().copied().min_by(|a, b| key(a).total_cmp(&key(b)));
        self.grid.number(first.expect("the least key is below the limit") as usize)
    }

    /// Continues the generation by so many contacts that the monitor is asked in time, and completes the generation after its
    /// last contact.
    pub(super) fn continue_generation(
        &mut self,
        event: &mut OngoingAvalanche,
        clocks: &mut impl Timekeeping,
    ) {
        let part = self.released.len()..self.front.len().min(self.released.len() + ASK);
        self.unasked += part.len();
        event.generation.released = self.break_contacts(part, event.generation.released, clocks);
        // All force is released before any neighbour gains: parallel update, independent of the order of the sites.
        if self.released.len() < self.front.len() {
            return;
        }
        let from = event.generation.distributed;
        let part = from..self.front.len().min(from + ASK);
        event.generation.distributed = part.end;
        event.generation.outward = self.distribute(part, event.generation.outward, clocks);
        if event.generation.distributed < self.front.len() {
            self.unasked += ASK;
            return;
        }
        self.end_generation(event, clocks);
    }

    /// Adds the sums of a generation to those of its avalanche. The contacts that follow are the next generation.
    fn end_generation(&mut self, event: &mut OngoingAvalanche, clocks: &mut impl Timekeeping) {
        self.drop_unloaded(clocks);
        let OngoingGeneration { released, outward, .. } = std::mem::take(&mut event.generation);
        event.size += self.front.len() as u64;
        event.duration += 1;
        event.released += released;
        // Springs to the drive take the dissipated fraction, open edges what would go beyond them. Losses are summed, not
        // taken as a difference of total forces, which would lose the digits of small avalanches.
        event.lost += self.dissipated * released + outward;
        std::mem::swap(&mut self.front, &mut self.following);
        self.following.clear();
        self.released.clear();
    }

    /// Keeps of the contacts that follow those that are still at their thresholds, each once. A contact that re-forms with a larger
    /// stretch than it broke with pulls its neighbours back, maybe after another neighbour has pushed them beyond their thresholds.
    fn drop_unloaded(&mut self, clocks: &mut impl Timekeeping) {
        if self.released.iter().all(|released| *released >= 0.0) {
            return;
        }
        let limit = self.limit();
        let Self { grid, births, born, ends, following, drive, .. } = self;
        following.sort_unstable();
        following.dedup();
        following.retain(|&place| {
            let place = place as usize;
            let contact = || {
                let number = grid.number(place);
                (number, births.threshold(born, number))
            };
            ends[place] <= limit - clocks.jump(place, ends[place], *drive, contact)
        });
    }

    /// Contacts of a part of the front break and re-form; returns the sum `all` plus the force that they release.
    fn break_contacts(&mut self, part: Range<usize>, mut all: f64, clocks: &mut impl Timekeeping) -> f64 {
        let limit = self.limit();
        let Self { grid, births, born, ends, front, following, released, broken, scar, drive, .. } = self;
        for &at in &front[part] {
            let place = at as usize;
            let (threshold, life) = births.next(born, || grid.number(place));
            // A contact that neighbours have pushed beyond its threshold breaks with that larger stretch.
            let let_go = threshold + (*drive - ends[place]) - life.stretch;
            // A contact breaks once per generation.
            ends[place] = *drive + (life.threshold - life.stretch);
            clocks.form(place, || grid.number(place));
            released.push(let_go);
            all += let_go;
            if ends[place] <= limit {
                following.push(at);
            }
            if !broken[place] {
                broken[place] = true;
                scar.push(at);
            }
        }
        all
    }

    /// Distributes the force released by a part of the front to the neighbours, which may reach their thresholds; returns
    /// the sum `outward` plus what open edges absorb.
    fn distribute(&mut self, part: Range<usize>, mut outward: f64, clocks: &mut impl Timekeeping) -> f64 {
        let limit = self.limit();
        let Self { grid, births, born, ends, front, following, released, alpha, drive, .. } = self;
        for (&place, released) in front[part.clone()].iter().zip(&released[part]) {
            let gain = *alpha * *released;
            if gain == 0.0 {
                continue;
            }
            for mut near in grid.around(place as usize) {
                if ends[near] == f64::INFINITY {
                    let Some(across) = grid.across(near) else {
                        outward += gain;
                        continue;
                    };
                    near = across;
                }
                let before = ends[near];
                let after = before - gain;
                let contact = || {
                    let number = grid.number(near);
                    (number, births.threshold(born, number))
                };
                let limit = limit - clocks.jump(near, before, *drive, contact);
                ends[near] = after;
                // Only the neighbour that pushes a contact beyond its threshold enters it in the
                // list, so that it stands there once.
                if after <= limit && before > limit {
                    following.push(near as u32);
                }
            }
        }
        outward
    }

    /// Updates the tree of minima for broken contacts and their neighbours.
    pub(super) fn update_minima(&mut self) {
        if let Some(clocks) = &mut self.clocks {
            let changed = clocks.take_changed();
            for &place in &changed {
                clocks.schedule(site(&self.grid, &self.births, &self.born, &self.ends, place), self.drive);
                self.minima.touch(place as usize);
            }
            clocks.keep(changed);
            self.minima.update(&clocks.due);
            return;
        }
        for &place in &self.scar {
            self.minima.touch(place as usize);
            for near in self.grid.around(place as usize) {
                // Nothing changes on the rim itself.
                let rim = self.ends[near] == f64::INFINITY;
                let near = if rim { self.grid.across(near).unwrap_or(near) } else { near };
                self.minima.touch(near);
            }
        }
        self.minima.update(&self.ends);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::contacts::{Contacts, Initial};
    use crate::ensemble::Disorder;
    use crate::ensemble::lattice::clocks::Athermal;
    use crate::ensemble::lattice::{Edges, LatticeCoupling, Shape};
    use crate::law::Point;

    /// One neighbour pushes a contact beyond its threshold, and another one pulls it back: in either order it does not break. A
    /// third push that brings it there again lists it once.
    #[test]
    fn a_contact_that_is_pulled_back_does_not_follow() {
        let contacts = Contacts::new(Arc::new(Point::new(1.0).unwrap()), Arc::new(Point::new(0.0).unwrap()));
        let coupling = LatticeCoupling::with_alpha(Shape::Square([3, 3]), Edges::Open, 0.2);
        for (released, follows) in [
            ([0.3, -0.2, 0.0], false),
            ([-0.2, 0.3, 0.0], false),
            ([0.3, -0.2, 0.3], true),
            ([-0.2, 0.3, 0.3], true),
        ] {
            let (contacts, initial) = (contacts.clone(), Initial::default());
            let mut lattice = Lattice::new(contacts, initial, &coupling, 1, Disorder::Annealed).unwrap();
            let middle = lattice.grid.place(4);
            // Gains are 0.2 of what is released: 0.06, −0.04 and 0.06.
            lattice.ends[middle] = lattice.drive + 0.05;
            lattice.front = [1, 3, 5].map(|number| lattice.grid.place(number) as u32).to_vec();
            lattice.released = released.to_vec();
            lattice.distribute(0..3, 0.0, &mut Athermal);
            lattice.drop_unloaded(&mut Athermal);
            let expected = if follows { vec![middle as u32] } else { Vec::new() };
            assert_eq!(lattice.following, expected, "{released:?}");
        }
    }
}
