//! The resolvent (1 − aL)⁻¹ of a Fokker–Planck operator L on adaptive spectral elements: the density after an
//! exponentially distributed time of mean a.

use super::elements::{BASIS, Basis, Elements, NARROWEST, ROUNDING, refined};
use super::galerkin::{Field, GalerkinElement, Operator, implicit_step};
use crate::numerics::legendre::{NODES, Nodal};

/// Largest number of elements beyond those of the start.
const MOST_ADDED: usize = 400;

/// Largest number of times that elements are divided: bisection down to the narrowest.
const MOST_PASSES: usize = 60;

/// What is distributed at first, how it moves, and how accurately it is followed. Both ends reflect.
pub struct Resolvent<'a> {
    /// The density at first.
    pub density: &'a Elements,
    /// Point masses (position, mass) beside it.
    pub point_masses: &'a [(f64, f64)],
    /// Drift and diffusion.
    pub field: Field<'a>,
    /// Elements are divided until the truncation error × half width of each is below this at its upper end.
    pub tolerance: &'a dyn Fn(f64) -> f64,
}

impl std::fmt::Debug for Resolvent<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Resolvent").field("field", &self.field).finish_non_exhaustive()
    }
}

impl Resolvent<'_> {
    /// The elements with which to begin: those of the density, divided at the point masses, where the solution has a kink.
    pub fn edges(&self) -> Vec<f64> {
        let ends = self.density.edges[0]..self.density.edges[self.density.count()];
        let places = self.point_masses.iter().map(|mass| mass.0).filter(|place| ends.contains(place));
        let mut edges: Vec<f64> = self.density.edges.iter().copied().chain(places).collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        edges
    }

    /// The density after an exponentially distributed time of mean `a`. `edges` are those of [`Resolvent::edges`] or of an
    /// earlier solution.
    pub fn after(&self, a: f64, mut edges: Vec<f64>) -> Elements {
        let most = self.density.count() + self.point_masses.len() + MOST_ADDED;
        for _ in 0..MOST_PASSES {
            let solved = self.solved(a, edges);
            let roughness: Vec<f64> = (0..solved.count()).map(|i| self.roughness(&solved, i)).collect();
            if roughness.iter().all(|roughness| *roughness <= 1.0) || solved.count() > most {
                return solved;
            }
            edges = refined(&solved.edges, &roughness, false);
        }
        self.solved(a, edges)
    }

    /// The density on these elements.
    fn solved(&self, a: f64, edges: Vec<f64>) -> Elements {
        let start = self.density.on(&edges);
        let cell = |pair: &[f64]| {
            let mut operator = Operator::new(([pair[0], pair[1]], [0.0; 2]), &self.field, 0.0);
            self.add_viscosity(&mut operator, pair);
            GalerkinElement::new(0.5 * (pair[1] - pair[0]), operator, a)
        };
        let cells: Vec<GalerkinElement> = edges.windows(2).map(cell).collect();
        let mut moments: Vec<Nodal> =
            (0..start.count()).map(|i| Basis::moments(&start.series[i], start.element(i).1)).collect();
        // A hat function is 1 at its edge: the first one of the element above, or the second one of the last element, also
        // for the negligible masses beyond it.
        for &(place, mass) in self.point_masses {
            let above = edges.partition_point(|&edge| edge < place);
            match moments.get_mut(above) {
                Some(moments) => moments[0] += mass,
                None => moments.last_mut().expect("an element")[1] += mass,
            }
        }
        let series = implicit_step(&cells, moments, false).iter().map(Basis::series).collect();
        Elements { edges, series }
    }

    /// Spectral vanishing viscosity (E. Tadmor, SIAM J. Numer. Anal. 26, 30 (1989)): diffusion of the highest functions only,
    /// in proportion to the drift. Without it, where drift outweighs diffusion across an element, rounding makes a mode of
    /// alternating signs, which is carried against the drift undamped. The density has these functions to its truncation error only.
    fn add_viscosity(&self, operator: &mut Operator, ends: &[f64]) {
        const HIGHEST: usize = 4;
        let drift = self.field.diffusion * (self.field.slope)(0.5 * (ends[0] + ends[1])).abs();
        for k in NODES - HIGHEST..NODES {
            operator.add_to_diagonal(k, drift / NODES as f64 * BASIS.stiffness[k][k]);
        }
    }

    /// The truncation error of an element over the tolerance; 0 where it is rounding, or the element too narrow to be
    /// divided.
    fn roughness(&self, density: &Elements, i: usize) -> f64 {
        let largest = density.series[i].iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
        let narrow = density.width(i) < NARROWEST * density.edges[density.count()];
        if narrow || density.truncation(i) < ROUNDING * largest {
            return 0.0;
        }
        density.truncation(i) * density.element(i).1 / (self.tolerance)(density.edges[i + 1])
    }
}
