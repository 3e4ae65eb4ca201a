//! One generation of an avalanche: contacts at their thresholds break, then their neighbours gain force.

use super::Lattice;

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

    /// Contacts of the front break and re-form; returns the force they release.
    pub(super) fn break_front(&mut self) -> f64 {
        let limit = self.limit();
        let Self { grid, births, born, ends, front, following, released, broken, scar, drive, .. } = self;
        released.clear();
        let mut all = 0.0;
        for &at in front.iter() {
            let place = at as usize;
            let (threshold, life) = births.next(born, || grid.number(place));
            // A contact that neighbours have pushed beyond its threshold breaks with that larger stretch.
            let let_go = threshold + (*drive - ends[place]) - life.stretch;
            // A contact breaks once per generation, and all of its force is released before any
            // neighbour gains: parallel update, independent of the order of the sites.
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

    /// Distributes the released force to the neighbours, which may reach their thresholds; returns what open
    /// edges absorb.
    pub(super) fn distribute(&mut self) -> f64 {
        let limit = self.limit();
        let Self { grid, ends, front, following, released, alpha, .. } = self;
        let mut outward = 0.0;
        for (&place, released) in front.iter().zip(released) {
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
