//! Linear least squares with a few columns, by the modified Gram–Schmidt process (Å. Björck, *Numerical
//! Methods for Least Squares Problems* (1996), section 2.4).

/// Smallest length of a column after projection, relative to its own, at which it counts as independent of the others.
const INDEPENDENT: f64 = 1e-11;

/// The c that minimises |y − A c|², with A = QR.
#[derive(Debug, Clone)]
pub struct LeastSquares {
    /// R, row by row; entries below its diagonal are 0.
    triangle: Vec<Vec<f64>>,
    /// c.
    pub coefficients: Vec<f64>,
    /// |y − A c|².
    pub squares: f64,
}

impl LeastSquares {
    /// Solves for the columns of A and the right side y. `None` if the columns are not independent or not finite.
    pub fn new(mut columns: Vec<Vec<f64>>, mut right: Vec<f64>) -> Option<Self> {
        let count = columns.len();
        let mut triangle = vec![vec![0.0; count]; count];
        let mut projected = vec![0.0; count];
        let lengths: Vec<f64> = columns.iter().map(|column| product(column, column).sqrt()).collect();
        for k in 0..count {
            let (done, rest) = columns.split_at_mut(k + 1);
            let column = &mut done[k];
            let length = product(column, column).sqrt();
            // Written so that a length that is not a number is refused.
            if !(length > INDEPENDENT * lengths[k] && length.is_finite()) {
                return None;
            }
            triangle[k][k] = length;
            column.iter_mut().for_each(|value| *value /= length);
            for (j, other) in rest.iter_mut().enumerate() {
                triangle[k][k + 1 + j] = removed(other, column);
            }
            projected[k] = removed(&mut right, column);
        }
        let coefficients = back_substituted(&triangle, projected);
        let squares = product(&right, &right);
        (squares.is_finite()).then_some(Self { triangle, coefficients, squares })
    }

    /// w (AᵀA)⁻¹ wᵀ, the variance of w·c where the errors of y are independent with variance 1.
    pub fn variance(&self, weights: &[f64]) -> f64 {
        let mut solution = vec![0.0; weights.len()];
        for i in 0..weights.len() {
            let known: f64 = (0..i).map(|j| self.triangle[j][i] * solution[j]).sum();
            solution[i] = (weights[i] - known) / self.triangle[i][i];
        }
        product(&solution, &solution)
    }

    /// ln det AᵀA.
    pub fn log_determinant(&self) -> f64 {
        2.0 * (0..self.triangle.len()).map(|k| self.triangle[k][k].ln()).sum::<f64>()
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Subtracts from `vector` its component along the unit vector `direction`, and returns that component.
fn removed(vector: &mut [f64], direction: &[f64]) -> f64 {
    let component = product(vector, direction);
    vector.iter_mut().zip(direction).for_each(|(value, unit)| *value -= component * unit);
    component
}

fn back_substituted(triangle: &[Vec<f64>], mut right: Vec<f64>) -> Vec<f64> {
    for k in (0..right.len()).rev() {
        let known: f64 = (k + 1..right.len()).map(|j| triangle[k][j] * right[j]).sum();
        right[k] = (right[k] - known) / triangle[k][k];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::linear::solve;

    /// Coefficients, residual, variance and determinant by the normal equations and Gaussian elimination.
    #[test]
    fn agrees_with_the_normal_equations() {
        let columns: [fn(f64) -> f64; 3] = [|_| 1.0, |x| x, |x| (-x).exp()];
        let points: Vec<f64> = (0..40).map(|i| 0.1 * f64::from(i)).collect();
        let right: Vec<f64> = points.iter().map(|x| (3.0 * x).sin()).collect();
        let matrix: Vec<Vec<f64>> =
            columns.iter().map(|column| points.iter().map(|x| column(*x)).collect()).collect();
        let normal: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| product(&matrix[i], &matrix[j])));
        let expected = solve(normal, std::array::from_fn(|i| product(&matrix[i], &right))).unwrap();
        let weights = [0.5, -1.0, 2.0];
        let variance = product(&weights, &solve(normal, weights).unwrap());
        let [[a, b, c], [d, e, f], [g, h, i]] = normal;
        let determinant: f64 = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
        let found = LeastSquares::new(matrix.clone(), right.clone()).unwrap();
        // The normal equations lose the square of the condition number, about 1e4.
        for (found, expected) in found.coefficients.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-11, "{found} {expected}");
        }
        assert!((found.variance(&weights) / variance - 1.0).abs() < 1e-10);
        assert!((found.log_determinant() - determinant.ln()).abs() < 1e-9);
        let rest = points.iter().zip(&right).map(|(x, y)| {
            (y - columns.iter().zip(expected).map(|(column, c)| c * column(*x)).sum::<f64>()).powi(2)
        });
        assert!((found.squares / rest.sum::<f64>() - 1.0).abs() < 1e-11);
    }

    #[test]
    fn dependent_columns_are_refused() {
        let column = vec![1.0, 2.0, 3.0];
        let twice = column.iter().map(|x| 2.0 * x).collect();
        assert!(LeastSquares::new(vec![column.clone(), twice], vec![1.0, 0.0, 0.0]).is_none());
        assert!(LeastSquares::new(vec![column.clone(), vec![0.0; 3]], vec![1.0, 0.0, 0.0]).is_none());
        assert!(LeastSquares::new(vec![column], vec![f64::NAN, 0.0, 0.0]).is_none());
    }
}
