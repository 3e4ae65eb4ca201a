//! Contacts formed during a motion in one direction, and the layer that they make up.

use super::cells::{BULK, CELL, NEGLIGIBLE, RESOLUTION};
use super::layer::{Layer, PointMass};
use super::panels::{Domain, Panels};
use crate::law::{Atom, Breakpoint};
use crate::numerics::piecewise::Piecewise;

/// Formation of contacts as a function of the advance of the slider since then.
#[derive(Debug, Clone)]
pub(crate) struct Births {
    /// The fraction formed per unit length.
    pub(crate) rate: Piecewise,
    /// Fractions formed simultaneously.
    pub(crate) atoms: Vec<Atom>,
    /// Breakpoints of the rate.
    pub(crate) breakpoints: Vec<Breakpoint>,
}

impl Births {
    /// The present layer of these contacts if each started as in `starts`: ν(x) = ∫ν_R(r) rate(x − r) dr,
    /// point masses included.
    pub(super) fn layer(&self, starts: &Layer) -> Layer {
        let mut density = Piecewise::default();
        for start in &starts.point_masses {
            let moved = self.rate.shifted(start.position).scaled(start.weight);
            density = density.added(&moved, RESOLUTION);
        }
        let breakpoints = self.breakpoints(starts);
        if !starts.is_pointed() {
            density = density.added(&self.spread(starts, &breakpoints), RESOLUTION);
        }
        let point_masses = self.atoms.iter().flat_map(|birth| {
            let born = |start: &PointMass| {
                PointMass::new(birth.position + start.position, birth.weight * start.weight)
            };
            starts.point_masses.iter().map(born)
        });
        let smooth = starts.point_masses.is_empty() && self.atoms.is_empty();
        let resolution = if smooth { starts.resolution } else { 0.0 };
        Layer { density, point_masses: point_masses.collect(), breakpoints, resolution, ..Layer::default() }
    }

    /// Breakpoints of the convolution: sums of those of the rate and of the starts.
    fn breakpoints(&self, starts: &Layer) -> Vec<Breakpoint> {
        let atoms = self.atoms.iter().map(|&a| Breakpoint::from(a));
        let births: Vec<_> = self.breakpoints.iter().copied().chain(atoms).collect();
        let starts = starts.all_breaks();
        let pairs = births.iter().flat_map(|birth| starts.iter().map(|start| birth.convolve(*start)));
        pairs.filter(|b| !b.is_atom()).collect()
    }

    /// The part of the layer from starts with a density.
    fn spread(&self, starts: &Layer, breakpoints: &[Breakpoint]) -> Piecewise {
        let latest = self.atoms.iter().map(|a| a.position).fold(self.rate.end(), f64::max);
        let (low, high) = (starts.density.start(), starts.density.end());
        let width = CELL * starts.resolution;
        let even = (1..((high + latest) / width) as usize).map(|k| k as f64 * width);
        let edges: Vec<f64> = breakpoints.iter().map(|b| b.position).chain(even).collect();
        // The convolution of two piecewise densities is smooth between sums of their breakpoints;
        // between these a Gauss rule per panel is exact to rounding.
        let rate = Panels::new(&self.rate, 2.0 * width, NEGLIGIBLE);
        let born = |x: f64| {
            let place = |b: &Breakpoint| x - b.position;
            let domain = Domain {
                low: x - high,
                high: x - low,
                cuts: starts.breakpoints.iter().map(place).collect(),
                steep: starts.breakpoints.iter().filter(|b| b.is_steep()).map(place).collect(),
            };
            let mut sum = self.atoms.iter().map(|a| a.weight * starts.density_at(x - a.position)).sum();
            rate.each(domain, |age, weight| sum += weight * starts.density_at(x - age));
            sum
        };
        Piecewise::resolve(born, &edges, high + latest, BULK.resolution)
    }
}
