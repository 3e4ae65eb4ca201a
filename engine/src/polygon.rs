//! A distribution that is drawn by hand: its density is linear between up to a dozen nodes.

use asperity::scenario::{Law, Tabulated};

/// Nodes of a polygon that is drawn by hand.
pub const MOST: usize = 12;
/// Nodes of a polygon that takes the place of another distribution: four on either side of the mean.
pub const FIRST: usize = 9;
/// Standard deviations from the mean to the ends of such a polygon.
pub const REACH: f64 = 2.5;
/// Density at which one that is infinite at 0 is cut, per inverse of the standard deviation.
const LARGEST: f64 = 100.0;
/// Least distance of nodes, in the width of the polygon.
const GAP: f64 = 1e-3;

/// A density that is linear between nodes, of mass 1.
pub struct Polygon {
    /// Stretches and densities.
    pub nodes: Vec<(f64, f64)>,
}

impl Polygon {
    /// The polygon that `law` is.
    ///
    /// # Errors
    /// Another distribution, or too many nodes, in words.
    pub fn of(law: &Law) -> Result<Self, String> {
        match law {
            Law::Tabulated(Tabulated { stretch: Some(stretch), density: Some(density), .. })
                if stretch.len() == density.len() && (2..=MOST).contains(&stretch.len()) =>
            {
                let nodes = stretch.iter().copied().zip(density.iter().copied()).collect();
                Ok(Self { nodes }.normalised())
            }
            _ => Err(format!(
                "expected a tabulated density of 2 to {MOST} nodes, which can be changed by hand"
            )),
        }
    }

    /// The polygon through points of a density around the mean; its ends are at 0.
    pub fn through(density: impl Fn(f64) -> f64, mean: f64, width: f64) -> Self {
        let low = mean * (1.0 - REACH * width).max(0.0);
        let step = (mean * (1.0 + REACH * width) - low) / (FIRST - 1) as f64;
        let node = |i: usize| {
            let x = low + step * i as f64;
            let end = (i == 0 && low > 0.0) || i + 1 == FIRST;
            (x, if end { 0.0 } else { density(x).min(LARGEST / (mean * width)) })
        };
        Self { nodes: (0..FIRST).map(node).collect() }.normalised()
    }

    /// The node's share of the area per density: half of the sides at it.
    fn base(&self, node: usize) -> f64 {
        let x = |i: usize| self.nodes[i.min(self.nodes.len() - 1)].0;
        0.5 * (x(node + 1) - x(node.saturating_sub(1)))
    }

    fn area(&self) -> f64 {
        (0..self.nodes.len()).map(|i| self.base(i) * self.nodes[i].1).sum()
    }

    fn normalised(mut self) -> Self {
        let area = self.area();
        if area.is_finite() && area > 0.0 {
            self.nodes.iter_mut().for_each(|node| node.1 /= area);
        }
        self
    }

    /// # Errors
    /// A node that it has not, in words.
    pub fn check(&self, node: usize) -> Result<(), String> {
        let last = self.nodes.len() - 1;
        if node <= last { Ok(()) } else { Err(format!("expected a node from 0 to {last}, got {node}")) }
    }

    /// The mass stays 1: what the node takes or leaves, the others leave or take in proportion.
    pub fn move_node(&mut self, node: usize, stretch: f64, density: f64) {
        let last = self.nodes.len() - 1;
        let gap = GAP * (self.nodes[last].0 - self.nodes[0].0);
        let low = if node == 0 { 0.0 } else { self.nodes[node - 1].0 + gap };
        let high = if node == last { f64::MAX } else { self.nodes[node + 1].0 - gap };
        self.nodes[node] = (stretch.max(low).min(high.max(low)), 0.0);
        let others = self.area();
        let most = if others > 0.0 { 1.0 - GAP } else { 1.0 };
        let own = (density.max(0.0) * self.base(node)).min(most);
        let factor = if others > 0.0 { (1.0 - own) / others } else { 1.0 };
        self.nodes.iter_mut().for_each(|node| node.1 *= factor);
        self.nodes[node].1 = if others > 0.0 { own } else { 1.0 } / self.base(node);
    }

    /// Adds a node on the curve, in the middle of the longest side unless a stretch is given.
    ///
    /// # Errors
    /// Too many nodes, or one at this stretch, in words.
    pub fn add(&mut self, stretch: Option<f64>) -> Result<(), String> {
        if self.nodes.len() == MOST {
            return Err(format!("a polygon that is drawn by hand has up to {MOST} nodes"));
        }
        let sides = self.nodes.windows(2).map(|side| (side[1].0 - side[0].0, 0.5 * (side[0].0 + side[1].0)));
        let longest = sides.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |side| side.1);
        let at = stretch.unwrap_or(longest).max(0.0);
        let place = self.nodes.partition_point(|node| node.0 < at);
        if self.nodes.get(place).is_some_and(|node| node.0 == at) {
            return Err(format!("expected a stretch between two nodes, got that of a node, {at}"));
        }
        let density = match (place.checked_sub(1).map(|before| self.nodes[before]), self.nodes.get(place)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (at - a.0) / (b.0 - a.0),
            _ => 0.0,
        };
        self.nodes.insert(place, (at, density));
        Ok(())
    }

    /// # Errors
    /// A polygon that would be none, in words.
    pub fn remove(&mut self, node: usize) -> Result<(), String> {
        let mass = |&i: &usize| i != node && self.nodes[i].1 > 0.0;
        if self.nodes.len() == 2 || !(0..self.nodes.len()).any(|i| mass(&i)) {
            return Err("a polygon keeps two nodes, one of them above 0".to_owned());
        }
        self.nodes.remove(node);
        Ok(())
    }

    /// The distribution.
    pub fn law(self) -> Law {
        let (stretch, density) = self.normalised().nodes.into_iter().unzip();
        let (stretch, density) = (Some(stretch), Some(density));
        Law::Tabulated(Tabulated { stretch, density, ..Tabulated::default() })
    }
}
