//! One generation of an avalanche: contacts at their thresholds break, then their neighbours gain force.

use std::ops::Range;

use super::avalanche::{OngoingAvalanche, OngoingGeneration};
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
        self.minima.up_to(self.limit(), &self.ends, &mut self.front);
        let end = |&place: &u32| self.ends[place as usize];
        let first = self.front.iter().copied().min_by(|a, b| end(a).total_cmp(&end(b)));
        self.grid.number(first.expect("the least end is below the limit") as usize)
    }

    /// Continues the generation by so many contacts that the monitor is asked in time, and completes the generation after its
    /// last contact.
    pub(super) fn continue_generation(&mut self, event: &mut OngoingAvalanche) {
        let part = self.released.len()..self.front.len().min(self.released.len() + ASK);
        self.unasked += part.len();
        event.generation.released = self.break_contacts(part, event.generation.released);
        // All force is released before any neighbour gains: parallel update, independent of the order of the sites.
        if self.released.len() < self.front.len() {
            return;
        }
        let from = event.generation.distributed;
        let part = from..self.front.len().min(from + ASK);
        event.generation.distributed = part.end;
        event.generation.outward = self.distribute(part, event.generation.outward);
        if event.generation.distributed < self.front.len() {
            self.unasked += ASK;
            return;
        }
        self.end_generation(event);
    }

    /// Adds the sums of a generation to those of its avalanche. The contacts that follow are the next generation.
    fn end_generation(&mut self, event: &mut OngoingAvalanche) {
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

    /// Contacts of a part of the front break and re-form; returns the sum `all` plus the force that they release.
    fn break_contacts(&mut self, part: Range<usize>, mut all: f64) -> f64 {
        let limit = self.limit();
        let Self { grid, births, born, ends, front, following, released, broken, scar, drive, .. } = self;
        for &at in &front[part] {
            let place = at as usize;
            let (threshold, life) = births.next(born, || grid.number(place));
            // A contact that neighbours have pushed beyond its threshold breaks with that larger stretch.
            let let_go = threshold + (*drive - ends[place]) - life.stretch;
            // A contact breaks once per generation.
            ends[place] = *drive + (life.threshold - life.stretch);
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
    fn distribute(&mut self, part: Range<usize>, mut outward: f64) -> f64 {
        let limit = self.limit();
        let Self { grid, ends, front, following, released, alpha, .. } = self;
        for (&place, released) in front[part.clone()].iter().zip(&released[part]) {
            let gain = *alpha * *released;
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
