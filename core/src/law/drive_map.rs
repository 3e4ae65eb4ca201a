//! The map between stretch and drive for contacts with mean-field coupling.

use super::SharedLaw;
use super::critical_coupling::weighted;
use super::panels::panel_boundaries;
use crate::numerics::legendre::RULE;

/// Largest number of steps; bisection alone needs 60.
const MOST_STEPS: usize = 100;

/// X(x) = x − κ ∫_0^x ξ dP(ξ) for κ below the critical coupling of the distribution P, and its inverse.
#[derive(Debug, Clone)]
pub(super) struct DriveMap {
    pub(super) coupling: f64,
    pub(super) thresholds: SharedLaw,
    /// Panel boundaries for Gauss quadrature; below the first X = x.
    nodes: Vec<DriveNode>,
}

/// A panel boundary: x, X(x) and ∫_0^x ξ dP, the stretch of broken contacts.
#[derive(Debug, Clone, Copy)]
pub(super) struct DriveNode {
    pub(super) stretch: f64,
    pub(super) drive: f64,
    broken: f64,
}

impl DriveMap {
    pub(super) fn new(coupling: f64, thresholds: SharedLaw) -> Self {
        let mut map = Self { coupling, thresholds, nodes: Vec::new() };
        let mut broken = 0.0;
        let mut before = DriveNode { stretch: 0.0, drive: 0.0, broken };
        for stretch in map.graded() {
            if !map.nodes.is_empty() {
                broken += map.breaking(before.stretch, stretch);
            }
            // Positions one rounding error apart must not decrease.
            let drive = (stretch - coupling * broken).max(before.drive);
            before = DriveNode { stretch, drive, broken };
            map.nodes.push(before);
        }
        map
    }

    pub(super) fn nodes(&self) -> &[DriveNode] {
        &self.nodes
    }

    /// X(x).
    pub(super) fn drive(&self, stretch: f64) -> f64 {
        let after = self.nodes.partition_point(|node| node.stretch <= stretch);
        match after.checked_sub(1) {
            Some(cell) if stretch < f64::INFINITY => self.drive_in(cell, stretch),
            _ => stretch,
        }
    }

    /// x(X).
    pub(super) fn stretch(&self, drive: f64) -> f64 {
        let after = self.nodes.partition_point(|node| node.drive <= drive);
        match after.checked_sub(1) {
            Some(cell) if drive < f64::INFINITY => self.stretch_in(cell, drive),
            _ => drive,
        }
    }

    /// dX/dx.
    pub(super) fn slope(&self, stretch: f64) -> f64 {
        1.0 - self.coupling * weighted(self.thresholds.as_ref(), stretch)
    }

    /// X(x) in the cell above a node; above the last node from the upper moment.
    pub(super) fn drive_in(&self, cell: usize, stretch: f64) -> f64 {
        let node = self.nodes[cell];
        let left = |x: f64| self.thresholds.upper_moment(1, x);
        let breaking = if cell + 1 < self.nodes.len() {
            self.breaking(node.stretch, stretch)
        } else {
            left(node.stretch) - left(stretch)
        };
        stretch - self.coupling * (node.broken + breaking)
    }

    /// ∫ξ dP between two stretches within a cell.
    fn breaking(&self, from: f64, to: f64) -> f64 {
        RULE.integrate(from, to, |x| weighted(self.thresholds.as_ref(), x))
    }

    /// x(X) in the cell above a node, by Newton's method safeguarded by bisection.
    fn stretch_in(&self, cell: usize, drive: f64) -> f64 {
        let beyond = drive + self.coupling * self.thresholds.mean();
        let mut low = self.nodes[cell].stretch;
        let mut high = self.nodes.get(cell + 1).map_or(beyond, |next| next.stretch.next_down()).max(low);
        let mut x = (low + (drive - self.nodes[cell].drive) / self.slope(low)).clamp(low, high);
        for _ in 0..MOST_STEPS {
            let excess = self.drive_in(cell, x) - drive;
            let step = excess / self.slope(x);
            if excess.abs() <= f64::EPSILON * drive || step.abs() <= f64::EPSILON * x {
                break;
            }
            if excess > 0.0 {
                high = x
            } else {
                low = x
            }
            x = if x - step > low && x - step < high { x - step } else { 0.5 * (low + high) };
        }
        x
    }

    /// Panel boundaries such that the slope dX/dx changes by less than a factor of 2 between them.
    fn graded(&self) -> Vec<f64> {
        let mut rest = panel_boundaries(self.thresholds.as_ref());
        rest.retain(|&x| x > 0.0);
        rest.reverse();
        let mut graded: Vec<f64> = rest.pop().into_iter().collect();
        while let Some(&next) = rest.last() {
            let last = graded[graded.len() - 1];
            let middle = 0.5 * (last + next);
            let mut slopes = [last, middle, next.next_down()].map(|x| self.slope(x));
            slopes.sort_by(f64::total_cmp);
            if slopes[2] > 2.0 * slopes[0] && next - last > 1e-9 * next {
                rest.push(middle);
            } else {
                graded.extend(rest.pop());
            }
        }
        graded
    }
}
