//! Matrices of low rank, as products of two with few columns.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

use crate::numerics::wide::vectorised;

/// Part of the rows that a rank may be: above it, a product costs more than the matrix.
const MOST: usize = 4;
/// Columns of which the differences are looked at together, so that they stay in the cache.
const TOGETHER: usize = 64;

/// A = left · rightᵀ.
#[derive(Debug, Clone)]
pub(super) struct LowRank {
    pub left: Mat<f64>,
    pub right: Mat<f64>,
}

impl LowRank {
    /// The product that differs from no element of `matrix` by more than `tolerance`, by crosses of its rows and columns
    /// (adaptive cross approximation: M. Bebendorf, Numer. Math. 86, 565 (2000)); `None` where the rank is not low.
    pub fn new(matrix: MatRef<'_, f64>, tolerance: f64) -> Option<Self> {
        let mut crosses = Crosses { matrix, left: Vec::new(), right: Vec::new() };
        let most = matrix.nrows().min(matrix.ncols()) / MOST;
        while let Some(farthest) = crosses.row_beyond(tolerance) {
            let (before, mut row) = (crosses.left.len(), Some(farthest));
            while let Some(at) = row {
                if crosses.left.len() == most {
                    return None;
                }
                row = crosses.add(at, tolerance);
            }
            if crosses.left.len() == before {
                // Sums in another order differ by more than this tolerance.
                break;
            }
        }
        let (left, right) = (crosses.left, crosses.right);
        Some(Self { left: from_columns(matrix.nrows(), &left), right: from_columns(matrix.ncols(), &right) })
    }

    /// `factor` times this.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { left: &self.left * faer::Scale(factor), right: self.right.clone() }
    }

    /// Subtracts left · rightᵀ, to `tolerance`.
    pub fn subtract(&mut self, left: &Mat<f64>, right: MatRef<'_, f64>, tolerance: f64) {
        let negative = left * faer::Scale(-1.0);
        let mut lefts = columns(self.left.as_ref());
        lefts.extend(columns(negative.as_ref()));
        let mut rights = columns(self.right.as_ref());
        rights.extend(columns(right));
        let (rows, width) = (self.left.nrows(), self.right.nrows());
        *self = vectorised(
            #[inline(always)]
            || compressed((&lefts, rows), (rights, width), tolerance),
        );
    }
}

/// left · rightᵀ with as few columns as a `tolerance` of the Frobenius norm needs.
///
/// right = QT with orthonormal Q, then left Tᵀ = PS with orthonormal columns P, the longest first.
#[inline(always)]
fn compressed(
    (left, rows): (&[Vec<f64>], usize),
    (mut right, width): (Vec<Vec<f64>>, usize),
    tolerance: f64,
) -> LowRank {
    let count = right.len();
    let mut turned = vec![vec![0.0; rows]; count];
    for k in 0..count {
        let (done, rest) = right.split_at_mut(k);
        let column = &mut rest[0];
        let before = norm(column);
        // Twice is enough (L. Giraud, J. Langou, M. Rozložník and J. van den Eshof, Numer. Math. 101, 87 (2005)).
        for _ in 0..2 {
            for (j, basis) in done.iter().enumerate() {
                let part = dot(basis, column);
                add(column, -part, basis);
                add(&mut turned[j], part, &left[k]);
            }
        }
        let length = norm(column);
        // What is left is rounding: it is taken for nothing.
        let kept = if length > 1e-15 * before { length } else { 0.0 };
        column.iter_mut().for_each(|entry| *entry = if kept > 0.0 { *entry / kept } else { 0.0 });
        add(&mut turned[k], kept, &left[k]);
    }
    let (mut lefts, mut rights): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let lengths: Vec<f64> = turned.iter().map(|column| dot(column, column)).collect();
        let longest = (0..count).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]));
        let beyond = lengths.iter().sum::<f64>() > tolerance * tolerance;
        let Some(longest) = longest.filter(|_| beyond) else { break };
        let mut basis = turned[longest].clone();
        for done in &lefts {
            let part = dot(done, &basis);
            add(&mut basis, -part, done);
        }
        let length = norm(&basis);
        basis.iter_mut().for_each(|entry| *entry /= length);
        let mut other = vec![0.0; width];
        for (column, right) in turned.iter_mut().zip(&right) {
            let part = dot(&basis, column);
            add(column, -part, &basis);
            add(&mut other, part, right);
        }
        lefts.push(basis);
        rights.push(other);
    }
    LowRank { left: from_columns(rows, &lefts), right: from_columns(width, &rights) }
}

/// Crosses of rows and columns whose sum approximates a matrix.
struct Crosses<'a> {
    matrix: MatRef<'a, f64>,
    left: Vec<Vec<f64>>,
    right: Vec<Vec<f64>>,
}

impl Crosses<'_> {
    /// Adds the cross through the largest difference in row `row`, and returns the row of the largest other one in its column;
    /// `None` where the row has none above `tolerance`.
    fn add(&mut self, row: usize, tolerance: f64) -> Option<usize> {
        let mut right: Vec<f64> = self.matrix.row(row).iter().copied().collect();
        for (l, r) in self.left.iter().zip(&self.right) {
            add(&mut right, -l[row], r);
        }
        let column = largest(&right)?;
        let pivot = right[column];
        if pivot.abs() <= tolerance {
            return None;
        }
        let mut left: Vec<f64> = self.matrix.col(column).iter().copied().collect();
        for (l, r) in self.left.iter().zip(&self.right) {
            add(&mut left, -r[column], l);
        }
        right.iter_mut().for_each(|entry| *entry /= pivot);
        self.left.push(left.clone());
        self.right.push(right);
        left[row] = 0.0;
        largest(&left)
    }

    /// The row with the largest difference, if it is above `tolerance`.
    fn row_beyond(&self, tolerance: f64) -> Option<usize> {
        let (rows, columns) = (self.matrix.nrows(), self.matrix.ncols());
        let left = from_columns(rows, &self.left);
        let right = from_columns(columns, &self.right);
        let (mut most, mut found) = (tolerance, None);
        for first in (0..columns).step_by(TOGETHER) {
            let width = TOGETHER.min(columns - first);
            let mut difference = self.matrix.subcols(first, width).to_owned();
            let part = right.as_ref().subrows(first, width);
            matmul(difference.as_mut(), Accum::Add, left.as_ref(), part.transpose(), -1.0, Par::Seq);
            for j in 0..width {
                for (i, entry) in difference.col(j).iter().enumerate() {
                    if entry.abs() > most {
                        (most, found) = (entry.abs(), Some(i));
                    }
                }
            }
        }
        found
    }
}

fn largest(values: &[f64]) -> Option<usize> {
    (0..values.len()).max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs()))
}

fn columns(matrix: MatRef<'_, f64>) -> Vec<Vec<f64>> {
    (0..matrix.ncols()).map(|j| matrix.col(j).iter().copied().collect()).collect()
}

fn from_columns(rows: usize, columns: &[Vec<f64>]) -> Mat<f64> {
    Mat::from_fn(rows, columns.len(), |i, j| columns[j][i])
}

/// aᵀb, in as many sums as processors add at a time.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const SUMS: usize = 8;
    let (a, b) = (a.chunks_exact(SUMS), b.chunks_exact(SUMS));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    let sums = a.zip(b).fold([0.0; SUMS], |mut sums: [f64; SUMS], (a, b)| {
        (0..SUMS).for_each(|k| sums[k] += a[k] * b[k]);
        sums
    });
    sums.iter().sum::<f64>() + rest
}

#[inline(always)]
fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// a + factor b, in place of a.
#[inline(always)]
fn add(a: &mut [f64], factor: f64, b: &[f64]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The product of the matrices, element by element.
    fn element(product: &LowRank, i: usize, j: usize) -> f64 {
        (0..product.left.ncols()).map(|k| product.left[(i, k)] * product.right[(j, k)]).sum()
    }

    /// A smooth function of both places in two patches far from each other, and nothing elsewhere.
    fn patches(i: usize, j: usize) -> f64 {
        let inside = |from: usize| (from..from + 20).contains(&i) && (from..from + 20).contains(&j);
        if inside(40) || inside(70) { 1.0 / (10.0 + i as f64 + 2.0 * j as f64) } else { 0.0 }
    }

    #[test]
    fn crosses_find_what_is_far_from_the_others() {
        let matrix = Mat::from_fn(100, 90, patches);
        let found = LowRank::new(matrix.as_ref(), 1e-10).unwrap();
        // Ranks of such functions grow as the logarithm of the tolerance; there is more than one cross in each patch.
        assert!((4..20).contains(&found.left.ncols()), "{}", found.left.ncols());
        for (i, j) in (0..100).flat_map(|i| (0..90).map(move |j| (i, j))) {
            assert!((element(&found, i, j) - patches(i, j)).abs() <= 1.01e-10, "{i}, {j}");
        }
        assert_eq!(LowRank::new(Mat::zeros(100, 90).as_ref(), 1e-10).unwrap().left.ncols(), 0);
    }

    #[test]
    fn ranks_that_are_not_low_are_refused() {
        let diagonal = Mat::from_fn(100, 90, |i, j| if i == j { 1.0 } else { 0.0 });
        assert!(LowRank::new(diagonal.as_ref(), 1e-10).is_none());
        // Nor can rounding be told from elements of its size.
        let rounded = Mat::from_fn(100, 90, |i, j| (i as f64 + 2.0 * j as f64).sin());
        let found = LowRank::new(rounded.as_ref(), 1e-17);
        assert!(found.is_none_or(|found| found.left.ncols() < 23));
    }

    #[test]
    fn differences_have_no_more_columns_than_they_need() {
        // sin(a + b) = sin a cos b + cos a sin b: rank 2, and what is subtracted shares one of its columns.
        let wave = |i: usize, j: usize| (0.1 * i as f64 + 0.2 * j as f64).sin();
        let mut product = LowRank::new(Mat::from_fn(60, 50, wave).as_ref(), 1e-12).unwrap();
        let left = Mat::from_fn(60, 2, |i, k| if k == 0 { (0.1 * i as f64).sin() } else { 1.0 });
        let right = Mat::from_fn(50, 2, |j, k| if k == 0 { (0.2 * j as f64).cos() } else { 1e-3 });
        product.subtract(&left, right.as_ref(), 1e-12);
        // cos a sin b and a constant are left.
        assert_eq!(product.left.ncols(), 2);
        for (i, j) in (0..60).flat_map(|i| (0..50).map(move |j| (i, j))) {
            let expected = (0.1 * i as f64).cos() * (0.2 * j as f64).sin() - 1e-3;
            // Each of the two steps has an error of 1e-12.
            assert!((element(&product, i, j) - expected).abs() < 1e-11, "{i}, {j}");
        }
        let (left, right) = (product.left.clone(), product.right.clone());
        product.subtract(&left, right.as_ref(), 1e-12);
        assert_eq!(product.left.ncols(), 0);
    }
}
