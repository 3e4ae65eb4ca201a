//! Lagrange interpolation between equally spaced points, of degree 9.

use super::legendre::{NODES, Nodal};

/// Number of points of a stencil.
pub const POINTS: usize = 10;

/// Weights of the values at ten equally spaced points in the interpolated value and slope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stencil {
    /// Index of the first point.
    pub first: usize,
    /// Position in units of the spacing, from the first point.
    place: f64,
    /// Weights of the value.
    weights: [f64; POINTS],
}

/// 1/Π_{j ≠ k} (k − j) = (−1)^{9−k}/[k! (9 − k)!].
const SCALES: [f64; POINTS] = {
    let mut scales = [1.0; POINTS];
    let mut k = 0;
    while k < POINTS {
        let mut j = 0;
        while j < POINTS {
            if j != k {
                scales[k] /= k as f64 - j as f64;
            }
            j += 1;
        }
        k += 1;
    }
    scales
};

impl Stencil {
    /// The stencil for a position `place` in units of the spacing, among `count` ≥ 10 points; not centred
    /// near the ends.
    pub fn at(place: f64, count: usize) -> Self {
        Self::from(first(place, count) as usize, place)
    }

    /// The stencil of the ten points from `first` on.
    pub fn from(first: usize, place: f64) -> Self {
        let t = place - first as f64;
        let mut weights = SCALES;
        let (mut below, mut above) = (1.0, 1.0);
        for k in 0..POINTS {
            let last = POINTS - 1 - k;
            weights[k] *= below;
            weights[last] *= above;
            below *= t - k as f64;
            above *= t - last as f64;
        }
        Self { first, place: t, weights }
    }

    /// Index of the point at the position or next below it.
    pub fn below(&self) -> usize {
        self.first + (self.place.max(0.0) as usize).min(POINTS - 1)
    }

    /// The interpolated value of `known`(point).
    pub fn value(&self, known: impl Fn(usize) -> f64) -> f64 {
        self.weights.iter().zip(self.first..).map(|(weight, point)| weight * known(point)).sum()
    }

    /// The ten points of `known` with their weights in the interpolated value.
    #[inline(always)]
    pub fn weighted<'a, T>(&self, known: &'a [T]) -> impl Iterator<Item = (f64, &'a T)> + use<'a, T> {
        self.weights.into_iter().zip(&known[self.first..])
    }

    /// The interpolated derivative of `known`(point), per spacing.
    pub fn slope(&self, known: impl Fn(usize) -> f64) -> f64 {
        self.slopes().iter().zip(self.first..).map(|(weight, point)| weight * known(point)).sum()
    }

    /// Weights of the slope: Π_{j ≠ k} (t − j) is the product of the factors below and above k, each with its
    /// derivative.
    fn slopes(&self) -> [f64; POINTS] {
        let (mut below, mut above) = ([(1.0, 0.0); POINTS], [(1.0, 0.0); POINTS]);
        let longer = |(value, slope): (f64, f64), j: usize| {
            let factor = self.place - j as f64;
            (value * factor, slope * factor + value)
        };
        for k in 1..POINTS {
            below[k] = longer(below[k - 1], k - 1);
            above[POINTS - 1 - k] = longer(above[POINTS - k], POINTS - k);
        }
        std::array::from_fn(|k| SCALES[k] * (below[k].1 * above[k].0 + below[k].0 * above[k].1))
    }
}

/// Index of the first point of a stencil.
#[inline(always)]
fn first(place: f64, count: usize) -> f64 {
    (place - 0.5 * (POINTS - 2) as f64).floor().clamp(0.0, (count - POINTS) as f64)
}

/// The interpolated values of `known`(point) at sixteen positions, as those of [`Stencil::at`]; the weights are computed in
/// loops that vectorise.
#[inline(always)]
pub fn interpolated(places: &Nodal, count: usize, known: impl Fn(usize) -> f64) -> Nodal {
    let (mut firsts, mut from) = ([0.0; NODES], *places);
    for i in 0..NODES {
        firsts[i] = first(places[i], count);
        from[i] -= firsts[i];
    }
    let mut weights = SCALES.map(|scale| [scale; NODES]);
    let (mut below, mut above) = ([1.0; NODES], [1.0; NODES]);
    for k in 0..POINTS {
        let last = POINTS - 1 - k;
        for i in 0..NODES {
            weights[k][i] *= below[i];
            below[i] *= from[i] - k as f64;
        }
        for i in 0..NODES {
            weights[last][i] *= above[i];
            above[i] *= from[i] - last as f64;
        }
    }
    std::array::from_fn(|i| {
        let first = firsts[i] as usize;
        (0..POINTS).map(|k| weights[k][i] * known(first + k)).sum()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_nine_are_exact_everywhere() {
        let f = |x: f64| (x - 3.0) * (x - 5.0).powi(8) / 1e5;
        let slope = |x: f64| ((x - 5.0).powi(8) + 8.0 * (x - 3.0) * (x - 5.0).powi(7)) / 1e5;
        for place in [0.0, 0.3, 4.5, 7.0, 11.9, 12.0] {
            let stencil = Stencil::at(place, 13);
            // Rounding of values up to 500, with weights that sum to 1 and slopes of about 3.
            assert!((stencil.value(|i| f(i as f64)) - f(place)).abs() < 1e-11, "{place}");
            assert!((stencil.slope(|i| f(i as f64)) - slope(place)).abs() < 1e-10, "{place}");
        }
    }

    #[test]
    fn sixteen_values_are_those_of_one_after_the_other() {
        let f = |point: usize| (point as f64).sin();
        let places: Nodal = std::array::from_fn(|i| 1.3 * i as f64);
        let values = interpolated(&places, 21, f);
        // The same operations.
        assert_eq!(values, places.map(|place| Stencil::at(place, 21).value(f)));
    }
}
