//! Tridiagonal systems of a chain of equal springs whose sites are also held by springs to the ground.

use crate::shape::Edges;

/// Solves g_j x_j + k Σ (x_j − x_neighbour) = r_j on a chain with free ends or a ring.
///
/// This is the Thomas algorithm in a form without cancellation: elimination from one end adds springs in
/// series and in parallel, s_{j+1} = g_{j+1} + k s_j/(k + s_j), instead of subtracting large numbers. For g_j
/// ≥ 0 every x_j is accurate to rounding, however small g/k, and r ≥ 0 gives x ≥ 0.
#[derive(Debug, Clone)]
pub struct Chain {
    stiffness: f64,
    edges: Edges,
    /// k/(k + s_j).
    ratios: Vec<f64>,
    /// Displacements for a unit displacement of the last site of a ring.
    follow: Vec<f64>,
}

impl Chain {
    /// A chain with springs of stiffness k > 0 between neighbours.
    pub fn new(edges: Edges, stiffness: f64) -> Self {
        Self { stiffness, edges, ratios: Vec::new(), follow: Vec::new() }
    }

    /// Replaces `right` by the solution for the ground stiffness `ground`(j) = g_j, not all 0. Returns whether
    /// the matrix is positive definite, which it may not be if some g_j are negative; if not, `right` is of
    /// no use.
    pub fn solve(&mut self, ground: impl Fn(usize) -> f64, right: &mut [f64]) -> bool {
        match self.edges {
            Edges::Open => self.eliminate(ground, right),
            Edges::Periodic => self.close(ground, right),
        }
    }

    /// Free ends.
    fn eliminate(&mut self, ground: impl Fn(usize) -> f64, right: &mut [f64]) -> bool {
        let Some(last) = right.len().checked_sub(1) else { return true };
        let k = self.stiffness;
        self.ratios.resize(right.len(), 0.0);
        let (mut behind, mut carried) = (ground(0), right[0]);
        let mut definite = true;
        for j in 0..last {
            // The pivots are k + s_j, and s at the end.
            definite &= k + behind > 0.0;
            let ratio = k / (k + behind);
            self.ratios[j] = ratio;
            carried = right[j + 1] + ratio * carried;
            right[j + 1] = carried;
            behind = ground(j + 1) + ratio * behind;
        }
        definite &= behind > 0.0;
        right[last] /= behind;
        // Back substitution, with sums of positive terms only if all g_j and r_j are ≥ 0.
        let mut ahead = right[last];
        for j in (0..last).rev() {
            ahead = self.ratios[j] * (right[j] / k + ahead);
            right[j] = ahead;
        }
        definite
    }

    /// A ring: the chain without its last site is solved twice, for the right-hand side and for a unit
    /// displacement of that site; x = x_fixed + follow · x_last.
    fn close(&mut self, ground: impl Fn(usize) -> f64, right: &mut [f64]) -> bool {
        let k = self.stiffness;
        let [rest @ .., last] = right else { return true };
        let end = rest.len() - 1;
        let both = |j: usize| ground(j) + if j == 0 || j == end { k } else { 0.0 };
        // Sherman–Morrison-like reduction of a cyclic tridiagonal system: the chain without its last site is
        // solved for two right-hand sides.
        let mut follow = std::mem::take(&mut self.follow);
        follow.clear();
        follow.resize(rest.len(), 0.0);
        follow[0] += k;
        follow[end] += k;
        self.eliminate(both, &mut follow);
        let definite = self.eliminate(both, rest);
        // If all sites move together, only the springs to the ground resist.
        let resistance: f64 = follow.iter().enumerate().map(|(j, x)| ground(j) * x).sum();
        let pivot = ground(end + 1) + resistance;
        *last = (*last + k * (rest[0] + rest[end])) / pivot;
        rest.iter_mut().zip(&follow).for_each(|(x, follow)| *x += follow * *last);
        self.follow = follow;
        definite && pivot > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Put back into the equations, with some places pushed away by what holds them.
    #[test]
    fn places_held_differently_are_in_balance() {
        let ground = |j: usize| 0.4 + (1.0 + 3.7 * j as f64).sin();
        let lines = [(Edges::Open, 1), (Edges::Open, 60), (Edges::Periodic, 3), (Edges::Periodic, 60_usize)];
        for (edges, length) in lines {
            let right: Vec<f64> = (0..length).map(|j| (0.3 * (j * j) as f64).cos()).collect();
            let mut x = right.clone();
            Chain::new(edges, 2.5).solve(ground, &mut x);
            for j in 0..length {
                let (before, after) = match edges {
                    Edges::Open => (j.saturating_sub(1), (j + 1).min(length - 1)),
                    Edges::Periodic => ((j + length - 1) % length, (j + 1) % length),
                };
                let found = ground(j) * x[j] + 2.5 * ((x[j] - x[before]) + (x[j] - x[after]));
                // Some roundings of x, which is of order 1.
                assert!((found - right[j]).abs() < 1e-12, "{edges:?} {j}: {found} {}", right[j]);
            }
        }
    }
}
