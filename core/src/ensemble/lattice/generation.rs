//! One generation of breaks: all that have reached their thresholds let go, then their neighbours gain.

use super::Lattice;

impl Lattice {
    /// Contacts whose ends are up to here break.
    fn limit(&self) -> f64 {
        self.drive + self.together
    }

    /// Finds what breaks first, and gives its epicentre.
    pub(super) fn ignite(&mut self) -> usize {
        self.scar.drain(..).for_each(|place| self.broken[place as usize] = false);
        self.front.clear();
        self.minima.up_to(self.limit(), &self.ends, &mut self.front);
        let end = |&place: &u32| self.ends[place as usize];
        let first = self.front.iter().copied().min_by(|a, b| end(a).total_cmp(&end(b)));
        self.grid.number(first.expect("the least end is below the limit") as usize)
    }

    /// Contacts of the front break and re-form; what they let go in all.
    pub(super) fn part(&mut self) -> f64 {
        let limit = self.limit();
        self.released.clear();
        let mut all = 0.0;
        for &place in &self.front {
            let place = place as usize;
            let (threshold, life) = self.births.next(&mut self.born, || self.grid.number(place));
            let released = threshold + (self.drive - self.ends[place]) - life.stretch;
            let end = self.drive + (life.threshold - life.stretch);
            self.ends[place] = end;
            self.minima.touch(place);
            self.released.push(released);
            all += released;
            if end <= limit {
                self.following.push(place as u32);
            }
            if !self.broken[place] {
                self.broken[place] = true;
                self.scar.push(place as u32);
            }
        }
        all
    }

    /// Neighbours of the front gain their shares, which may make them follow; what open edges take.
    pub(super) fn share(&mut self) -> f64 {
        let limit = self.limit();
        let mut outward = 0.0;
        for (&place, released) in self.front.iter().zip(&self.released) {
            let gain = self.share * released;
            for mut near in self.grid.around(place as usize) {
                if self.ends[near] == f64::INFINITY {
                    let Some(across) = self.grid.across(near) else {
                        outward += gain;
                        continue;
                    };
                    near = across;
                }
                let before = self.ends[near];
                let after = before - gain;
                self.ends[near] = after;
                self.minima.touch(near);
                if after <= limit && before > limit {
                    self.following.push(near as u32);
                }
            }
        }
        outward
    }
}
