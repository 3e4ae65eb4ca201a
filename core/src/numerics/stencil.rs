//! Interpolation between even points, by the polynomial through the ten around.

/// Points of a stencil.
pub const POINTS: usize = 10;

/// Weights of values at even points in the value, and in the slope per spacing, at a place in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stencil {
    /// The first point that counts.
    pub first: usize,
    /// Weights in the value.
    pub weights: [f64; POINTS],
    /// Weights in the slope.
    pub slopes: [f64; POINTS],
}

impl Stencil {
    /// The stencil for a `place` in units of the spacing, of `count` points, ten or more; towards an end it is not centred.
    pub fn at(place: f64, count: usize) -> Self {
        let first = (place - 0.5 * (POINTS - 2) as f64).floor().clamp(0.0, (count - POINTS) as f64);
        let t = place - first;
        let mut stencil = Self { first: first as usize, weights: [0.0; POINTS], slopes: [0.0; POINTS] };
        for k in 0..POINTS {
            let (mut weight, mut slope) = (1.0, 0.0);
            for j in (0..POINTS).filter(|&j| j != k) {
                let scale = 1.0 / (k as f64 - j as f64);
                slope = (slope * (t - j as f64) + weight) * scale;
                weight *= (t - j as f64) * scale;
            }
            (stencil.weights[k], stencil.slopes[k]) = (weight, slope);
        }
        stencil
    }

    /// The value there of what `known` tells at the points.
    pub fn value(&self, known: impl Fn(usize) -> f64) -> f64 {
        self.weights.iter().zip(self.first..).map(|(weight, point)| weight * known(point)).sum()
    }

    /// The slope there, per spacing.
    pub fn slope(&self, known: impl Fn(usize) -> f64) -> f64 {
        self.slopes.iter().zip(self.first..).map(|(weight, point)| weight * known(point)).sum()
    }
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
}
