//! The potential U = −ln p of a stationary density p, and its slope.

use crate::numerics::piecewise::{Piecewise, Resolution};

/// Below this density, in units of the inverse length of the interval, U is extrapolated as a parabola, as
/// for a Gaussian.
const FAINTEST: f64 = 1e-280;

/// A potential U on an interval, by cubic interpolation between equally spaced points.
#[derive(Debug, Clone)]
pub struct Potential {
    /// The first point.
    first: f64,
    /// Points per length.
    per_length: f64,
    /// The cubic from each point to the next, in the fraction of the distance.
    cubics: Vec<[f64; 4]>,
}

impl Potential {
    /// U = −ln of a `density` on [low, high], at `points` ≥ 4 points.
    pub fn of(density: impl Fn(f64) -> f64, (low, high): (f64, f64), points: usize) -> Self {
        let spacing = (high - low) / points as f64;
        let first = low + 0.5 * spacing;
        let scaled = |h: f64| (high - low) * density(h);
        let densities = (0..points).map(|i| scaled(first + i as f64 * spacing)).collect();
        Self {
            first,
            per_length: spacing.recip(),
            cubics: potential_values(densities).windows(4).map(cubic).collect(),
        }
    }

    /// U(h); beyond the last points the last cubic continues.
    #[inline]
    pub fn at(&self, h: f64) -> f64 {
        let place = (h - self.first) * self.per_length;
        // The first and last cubics also cover the end intervals.
        let cell = (place as usize).clamp(1, self.cubics.len());
        let t = place - cell as f64;
        let [value, slope, square, cube] = self.cubics[cell - 1];
        value + t * (slope + t * (square + t * cube))
    }
}

/// U', to the accuracy of the density.
#[derive(Debug, Clone)]
pub struct Slope {
    /// Start of the range in which the density is not negligible.
    low: f64,
    high: f64,
    /// U' on that range.
    curve: Piecewise,
    /// U' and U'' at both ends, beyond which U is extrapolated as a parabola.
    ends: [[f64; 2]; 2],
}

impl Slope {
    /// U' of U = −ln of a `density` on [low, high] that is smooth between the `edges` and largest around
    /// `bulk`.
    pub fn of(density: impl Fn(f64) -> f64, (low, high): (f64, f64), edges: &[f64], bulk: f64) -> Self {
        let density = |h: f64| (high - low) * density(h);
        let faint = |end: f64| {
            let (mut inside, mut outside) = (bulk, end);
            while density(outside) <= FAINTEST && (outside - inside).abs() > 1e-9 * (high - low) {
                let middle = 0.5 * (inside + outside);
                if density(middle) > FAINTEST { inside = middle } else { outside = middle }
            }
            if density(outside) > FAINTEST { outside } else { inside }
        };
        // U is singular at an end at which the density vanishes.
        let [low, high] = [low, high].map(faint);
        let edges: Vec<f64> = edges.iter().map(|edge| edge - low).collect();
        let potential = |u: f64| -density(low + u).max(FAINTEST).ln();
        let resolution = Resolution::Relative { fraction: 1e-13, negligible: 1.0 };
        let curve = Piecewise::resolve(potential, &edges, high - low, resolution).derivative();
        let last = curve.coefficients.len() - 1;
        let ends = [curve.jet_in(0, 0.0), curve.jet_in(last, high - low)];
        Self { low, high, curve, ends }
    }

    /// U'(h).
    #[inline]
    pub fn at(&self, h: f64) -> f64 {
        let u = h - self.low;
        if u <= 0.0 {
            self.ends[0][0] + u * self.ends[0][1]
        } else if h >= self.high {
            self.ends[1][0] + (h - self.high) * self.ends[1][1]
        } else {
            self.curve.value(u)
        }
    }
}

/// The cubic through values at −1, 0, 1 and 2.
fn cubic(values: &[f64]) -> [f64; 4] {
    let [a, b, c, d] = std::array::from_fn(|i| values[i]);
    let square = 0.5 * (a + c) - b;
    let cube = (d - a) / 6.0 + 0.5 * (b - c);
    [b, c - b - square - cube, square, cube]
}

/// −ln of densities (or masses) on equally spaced points, extrapolated as a parabola where they are too
/// small.
fn potential_values(densities: Vec<f64>) -> Vec<f64> {
    let inside = |&density: &f64| density > FAINTEST;
    let (first, last) = (densities.iter().position(inside), densities.iter().rposition(inside));
    let (first, last) = (first.unwrap_or(0), last.unwrap_or(0));
    let mut out: Vec<f64> = densities.iter().map(|density| -density.max(FAINTEST).ln()).collect();
    if last - first < 3 {
        return out;
    }
    for i in last + 1..out.len() {
        out[i] = 3.0 * (out[i - 1] - out[i - 2]) + out[i - 3];
    }
    for i in (0..first).rev() {
        out[i] = 3.0 * (out[i + 1] - out[i + 2]) + out[i + 3];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_gaussian_is_linear_even_where_its_density_is_no_number() {
        let density = |h: f64| (-0.5 * ((h - 1.0) / 0.01_f64).powi(2)).exp();
        let slope = Slope::of(density, (0.0, 2.0), &[], 1.0);
        for h in [0.0, 0.0103, 0.5, 0.99, 1.2345, 2.0] {
            let exact = (h - 1.0) / 1e-4;
            // Rounding of U, 640 at most, over the length of a cell.
            assert!(
                (slope.at(h) - exact).abs() < 1e-8 * (1.0 + exact.abs()),
                "{h} {:e}",
                slope.at(h) - exact
            );
        }
    }

    #[test]
    fn the_potential_of_a_gaussian_is_quadratic_even_where_its_density_is_no_number() {
        let density = |h: f64| (-0.5 * ((h - 1.0) / 0.01_f64).powi(2)).exp();
        let potential = Potential::of(density, (0.0, 2.0), 2000);
        for h in [0.0, 0.0103, 0.5, 1.0, 1.2345, 2.0] {
            let exact = 0.5 * ((h - 1.0) / 0.01_f64).powi(2);
            // Rounding of U, about 640 where it is last known, carried on quadratically over 640 points.
            let found = potential.at(h) - potential.at(1.0);
            assert!((found - exact).abs() < 1e-6, "{h} {:e}", found - exact);
        }
    }
}
