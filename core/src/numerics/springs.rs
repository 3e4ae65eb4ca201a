//! Chains of equal springs whose places are held by springs of their own: linear equations with three diagonals.

use crate::shape::Edges;

/// Equations g_j x_j + k Σ (x_j − x_neighbour) = r_j on a chain, with free ends or closed to a ring.
///
/// Elimination from one end adds springs in series and parallel, s_{j+1} = g_{j+1} + k s_j/(k + s_j), instead of taking
/// differences of large numbers: with g_j ≥ 0 every x_j keeps its digits, however small g/k, and r ≥ 0 gives x ≥ 0.
#[derive(Debug, Clone)]
pub struct Chain {
    stiffness: f64,
    edges: Edges,
    /// k/(k + s_j).
    ratios: Vec<f64>,
    /// How places follow the last one of a ring.
    follow: Vec<f64>,
}

impl Chain {
    /// Springs of `stiffness` k > 0 between neighbours.
    pub fn new(edges: Edges, stiffness: f64) -> Self {
        Self { stiffness, edges, ratios: Vec::new(), follow: Vec::new() }
    }

    /// Replaces `right` by the solution; `hold` tells g_j, not all 0. Where some are negative the matrix may not be positive
    /// definite: whether it is; if not, `right` is of no use.
    pub fn solve(&mut self, hold: impl Fn(usize) -> f64, right: &mut [f64]) -> bool {
        match self.edges {
            Edges::Open => self.eliminate(hold, right),
            Edges::Periodic => self.close(hold, right),
        }
    }

    /// Free ends.
    fn eliminate(&mut self, hold: impl Fn(usize) -> f64, right: &mut [f64]) -> bool {
        let Some(last) = right.len().checked_sub(1) else { return true };
        let k = self.stiffness;
        self.ratios.resize(right.len(), 0.0);
        let (mut behind, mut carried) = (hold(0), right[0]);
        let mut definite = true;
        for j in 0..last {
            // Pivots are k + s_j, and s at the end.
            definite &= k + behind > 0.0;
            let ratio = k / (k + behind);
            self.ratios[j] = ratio;
            carried = right[j + 1] + ratio * carried;
            right[j + 1] = carried;
            behind = hold(j + 1) + ratio * behind;
        }
        definite &= behind > 0.0;
        right[last] /= behind;
        let mut ahead = right[last];
        for j in (0..last).rev() {
            ahead = self.ratios[j] * (right[j] / k + ahead);
            right[j] = ahead;
        }
        definite
    }

    /// A ring, as a chain that follows its last place: x = x at rest + follow · x_last.
    fn close(&mut self, hold: impl Fn(usize) -> f64, right: &mut [f64]) -> bool {
        let k = self.stiffness;
        let [rest @ .., last] = right else { return true };
        let end = rest.len() - 1;
        let both = |j: usize| hold(j) + if j == 0 || j == end { k } else { 0.0 };
        let mut follow = std::mem::take(&mut self.follow);
        follow.clear();
        follow.resize(rest.len(), 0.0);
        follow[0] += k;
        follow[end] += k;
        self.eliminate(both, &mut follow);
        let definite = self.eliminate(both, rest);
        // Holding springs alone resist where all places follow.
        let resist: f64 = follow.iter().enumerate().map(|(j, x)| hold(j) * x).sum();
        let held = hold(end + 1) + resist;
        *last = (*last + k * (rest[0] + rest[end])) / held;
        rest.iter_mut().zip(&follow).for_each(|(x, follow)| *x += follow * *last);
        self.follow = follow;
        definite && held > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Put back into the equations, with some places pushed away by what holds them.
    #[test]
    fn places_held_differently_are_in_balance() {
        let hold = |j: usize| 0.4 + (1.0 + 3.7 * j as f64).sin();
        let lines = [(Edges::Open, 1), (Edges::Open, 60), (Edges::Periodic, 3), (Edges::Periodic, 60_usize)];
        for (edges, length) in lines {
            let right: Vec<f64> = (0..length).map(|j| (0.3 * (j * j) as f64).cos()).collect();
            let mut x = right.clone();
            Chain::new(edges, 2.5).solve(hold, &mut x);
            for j in 0..length {
                let (before, after) = match edges {
                    Edges::Open => (j.saturating_sub(1), (j + 1).min(length - 1)),
                    Edges::Periodic => ((j + length - 1) % length, (j + 1) % length),
                };
                let found = hold(j) * x[j] + 2.5 * ((x[j] - x[before]) + (x[j] - x[after]));
                // Some roundings of x, which is of order 1.
                assert!((found - right[j]).abs() < 1e-12, "{edges:?} {j}: {found} {}", right[j]);
            }
        }
    }
}
