//! Minima of functions of a few variables without derivatives: the simplex method of J. A. Nelder and R.
//! Mead, Comput. J. 7, 308 (1965).

use crate::numerics::order::sort_by_number;

/// Largest number of evaluations per variable.
const EVALUATIONS: usize = 150;

/// A vertex of the simplex: a point and the function there.
type Vertex = (Vec<f64>, f64);

/// A minimum of `f` near `start`: its position and value.
///
/// The first simplex extends by `step` along each axis. The search ends when the values at all vertices differ by less
/// than `tolerance`, or after 150 evaluations per variable.
pub fn nelder_mead(
    mut f: impl FnMut(&[f64]) -> f64,
    start: &[f64],
    step: f64,
    tolerance: f64,
) -> (Vec<f64>, f64) {
    let mut simplex = around(&mut f, start, step);
    let mut evaluations = simplex.len();
    while evaluations < EVALUATIONS * start.len() {
        sort_by_number(&mut simplex, |item| item.1);
        let (best, worst) = (simplex[0].1, simplex[start.len()].1);
        if worst - best < tolerance {
            break;
        }
        evaluations += improved(&mut f, &mut simplex);
    }
    simplex.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).expect("a vertex")
}

fn around(f: &mut impl FnMut(&[f64]) -> f64, start: &[f64], step: f64) -> Vec<Vertex> {
    let shifted = |axis: Option<usize>| {
        let mut point = start.to_vec();
        if let Some(axis) = axis {
            point[axis] += step;
        }
        let value = f(&point);
        (point, value)
    };
    std::iter::once(None).chain((0..start.len()).map(Some)).map(shifted).collect()
}

/// Replaces the last vertex of a sorted simplex by reflection, expansion or contraction, or shrinks it;
/// returns the number of evaluations.
fn improved(f: &mut impl FnMut(&[f64]) -> f64, simplex: &mut [Vertex]) -> usize {
    let last = simplex.len() - 1;
    let (best, second, worst) = (simplex[0].1, simplex[last - 1].1, simplex[last].1);
    let middle = centroid(&simplex[..last]);
    let far = simplex[last].0.clone();
    let mut at = |factor: f64| -> Vertex {
        let point: Vec<f64> = middle.iter().zip(&far).map(|(m, w)| m + factor * (m - w)).collect();
        let value = f(&point);
        (point, value)
    };
    let reflected = at(1.0);
    if reflected.1 < best {
        let expanded = at(2.0);
        simplex[last] = if expanded.1 < reflected.1 { expanded } else { reflected };
        return 2;
    }
    if reflected.1 < second {
        simplex[last] = reflected;
        return 1;
    }
    let contracted = at(if reflected.1 < worst { 0.5 } else { -0.5 });
    if contracted.1 < worst.min(reflected.1) {
        simplex[last] = contracted;
        return 2;
    }
    let lowest = simplex[0].0.clone();
    for vertex in &mut simplex[1..] {
        vertex.0.iter_mut().zip(&lowest).for_each(|(x, low)| *x = 0.5 * (*x + low));
        vertex.1 = f(&vertex.0);
    }
    2 + last
}

fn centroid(vertices: &[Vertex]) -> Vec<f64> {
    let count = vertices.len() as f64;
    (0..vertices[0].0.len()).map(|i| vertices.iter().map(|vertex| vertex.0[i]).sum::<f64>() / count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// H. H. Rosenbrock's curved valley, with its minimum 0 at (1, 1), and a sphere in four dimensions.
    #[test]
    fn curved_and_round_valleys() {
        let valley = |p: &[f64]| (1.0 - p[0]).powi(2) + 100.0 * (p[1] - p[0] * p[0]).powi(2);
        let (place, value) = nelder_mead(valley, &[-1.2, 1.0], 0.5, 1e-14);
        // The value of a minimum found to 1e-14 gives its place to the square root of it, times the length of
        // the valley.
        assert!(value < 1e-13 && place.iter().all(|x| (x - 1.0).abs() < 1e-5), "{place:?} {value:e}");
        let sphere = |p: &[f64]| p.iter().enumerate().map(|(i, x)| (x - i as f64).powi(2)).sum::<f64>();
        let (place, _) = nelder_mead(sphere, &[5.0; 4], 1.0, 1e-12);
        assert!(place.iter().enumerate().all(|(i, x)| (x - i as f64).abs() < 1e-5), "{place:?}");
    }

    #[test]
    fn the_number_of_evaluations_is_limited() {
        let mut count = 0;
        let falling = |p: &[f64]| {
            count += 1;
            p[0]
        };
        nelder_mead(falling, &[0.0], 1.0, 1e-9);
        assert!(count <= EVALUATIONS + 2, "{count}");
    }
}
