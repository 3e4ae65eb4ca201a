//! Small dense systems of linear equations.

/// Solves `matrix` x = `right` by Gaussian elimination with partial pivoting; `None` if x is not finite.
pub fn solve<const N: usize>(mut matrix: [[f64; N]; N], mut right: [f64; N]) -> Option<[f64; N]> {
    for k in 0..N {
        let pivot = (k..N).max_by(|&i, &j| matrix[i][k].abs().total_cmp(&matrix[j][k].abs()))?;
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        for i in k + 1..N {
            let factor = matrix[i][k] / matrix[k][k];
            for j in k..N {
                matrix[i][j] -= factor * matrix[k][j];
            }
            right[i] -= factor * right[k];
        }
    }
    for k in (0..N).rev() {
        for j in k + 1..N {
            right[k] -= matrix[k][j] * right[j];
        }
        right[k] /= matrix[k][k];
    }
    right.iter().all(|x| x.is_finite()).then_some(right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::legendre::{NODES, Nodal};

    #[test]
    fn the_hilbert_matrix_shifted_by_one_gives_back_what_it_was_multiplied_with() {
        let shift = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        let matrix: [Nodal; NODES] = std::array::from_fn(|i| {
            std::array::from_fn(|j| 1.0 / (i + j + 1) as f64 + shift(i, (j + 3) % NODES))
        });
        let known: Nodal = std::array::from_fn(|i| (i as f64).cos());
        let right = matrix.map(|row| row.iter().zip(&known).map(|(a, x)| a * x).sum());
        let found = solve(matrix, right).unwrap();
        // A well-conditioned matrix: some rounding of 16 terms.
        assert!(found.iter().zip(&known).all(|(a, b)| (a - b).abs() < 1e-13), "{found:?}");
        assert_eq!(solve([[0.0; NODES]; NODES], known), None);
    }
}
