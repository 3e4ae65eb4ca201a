//! Elastic coupling between cells against dense matrices, closed forms of kernels and Green's functions.

use std::f64::consts::PI;

use asperity::Error;
use asperity::elastic::coupling::{Coupling, SlidingDirection, Solid, half_space, neighbours};
use asperity::shape::{Edges, Shape};

const EDGES: [Edges; 2] = [Edges::Open, Edges::Periodic];

fn shapes() -> [Shape; 5] {
    [Shape::Chain(3), Shape::Chain(24), Shape::Square([3, 5]), Shape::Square([8, 6]), Shape::Square([4, 11])]
}

/// Every kind of coupling, small.
fn couplings() -> impl Iterator<Item = Box<dyn Coupling>> {
    let of = |shape, edges| {
        let springs = neighbours(shape, edges, 2.5).unwrap();
        let space = |solid| half_space(shape, edges, solid, 0.5).unwrap();
        let [least, most] = [Solid::POISSON_RATIOS.start(), Solid::POISSON_RATIOS.end()];
        let solids = [(0.0, SlidingDirection::Columns), (*least, SlidingDirection::Columns)]
            .into_iter()
            .chain([SlidingDirection::Columns, SlidingDirection::Rows].map(|sliding| (*most, sliding)));
        let spaces = solids.map(|(ratio, sliding)| space(Solid::new(5.0, ratio, sliding)));
        std::iter::once(springs).chain(spaces).collect::<Vec<_>>()
    };
    let alone = [Shape::Chain(1), Shape::Square([1, 1]), Shape::Square([1, 7]), Shape::Chain(2)];
    let all = shapes().into_iter().flat_map(|shape| EDGES.map(|edges| (shape, edges)));
    all.chain(alone.map(|shape| (shape, Edges::Open))).flat_map(move |(shape, edges)| of(shape, edges))
}

fn noise(size: usize) -> Vec<f64> {
    (0..size).map(|j| (1.0 + 7.3 * j as f64 * j as f64).sin()).collect()
}

/// A, column by column, from the forces that one displaced cell makes.
fn matrix(coupling: &mut dyn Coupling) -> Vec<Vec<f64>> {
    let size = coupling.shape().size();
    let column = |i: usize| {
        let mut displacements = vec![0.0; size];
        displacements[i] = 1.0;
        let mut forces = vec![f64::NAN; size];
        coupling.forces(&displacements, &mut forces, &mut ()).unwrap();
        forces.iter().map(|force| -force).collect()
    };
    (0..size).map(column).collect()
}

fn times(matrix: &[Vec<f64>], x: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, f64::max)
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    largest(a.iter().zip(b).map(|(a, b)| a - b))
}

/// Entries are of order 1, and some hundred roundings at most go into each.
const ROUNDING: f64 = 1e-13;

#[test]
fn stiffness_is_a_symmetric_m_matrix_without_sum() {
    for mut coupling in couplings() {
        let a = matrix(&mut *coupling);
        for i in 0..a.len() {
            assert!((a[i][i] - coupling.self_stiffness(i)).abs() < ROUNDING, "{:?} {i}", coupling.shape());
            assert!(a[i].iter().sum::<f64>().abs() < ROUNDING);
            for j in 0..a.len() {
                assert!((a[i][j] - a[j][i]).abs() < ROUNDING);
                assert!(i == j || a[i][j] < ROUNDING, "{:?} {i} {j}: {}", coupling.shape(), a[i][j]);
            }
        }
    }
}

#[test]
fn forces_are_linear_in_displacements() {
    for mut coupling in couplings() {
        let a = matrix(&mut *coupling);
        let x = noise(a.len());
        let mut forces = vec![0.0; a.len()];
        coupling.forces(&x, &mut forces, &mut ()).unwrap();
        let expected = times(&a, &x);
        assert!(largest(forces.iter().zip(&expected).map(|(f, e)| f + e)) < ROUNDING);
        let energy: f64 = 0.5 * x.iter().zip(&expected).map(|(x, e)| x * e).sum::<f64>();
        assert!((coupling.energy(&x, &forces) - energy).abs() < ROUNDING * a.len() as f64);
    }
}

#[test]
fn solutions_give_back_what_was_asked() {
    for mut coupling in couplings() {
        for diagonal in [1e-3, 1.0, 300.0] {
            let right = noise(coupling.shape().size());
            let mut x = right.clone();
            coupling.solve_uniform(diagonal, &mut x, &mut ()).unwrap();
            let mut forces = vec![0.0; x.len()];
            coupling.forces(&x, &mut forces, &mut ()).unwrap();
            let found: Vec<f64> = x.iter().zip(&forces).map(|(x, f)| diagonal * x - f).collect();
            // Up to stiffness/diagonal = 1e4 roundings of x.
            assert!(
                apart(&found, &right) < 1e-12,
                "{:?} {diagonal}: {}",
                coupling.shape(),
                apart(&found, &right)
            );
        }
    }
}

/// Springs in series on a chain keep all digits however weakly it is held.
#[test]
fn a_chain_held_by_little_keeps_its_digits() {
    for edges in EDGES {
        let mut chain = neighbours(Shape::Chain(1000), edges, 25.0).unwrap();
        for diagonal in [1e-15, 1e-9, 1e-3] {
            let mut x = vec![2.0; 1000];
            chain.solve_uniform(diagonal, &mut x, &mut ()).unwrap();
            // A thousand steps with a rounding or two each.
            assert!(x.iter().all(|x| (x * diagonal / 2.0 - 1.0).abs() < 1e-12));
        }
    }
}

#[test]
fn a_rigid_translation_costs_nothing() {
    for mut coupling in couplings() {
        let size = coupling.shape().size();
        let mut forces = vec![f64::NAN; size];
        coupling.forces(&vec![1e9 / 3.0; size], &mut forces, &mut ()).unwrap();
        assert!(forces.iter().all(|&force| force == 0.0), "{:?}", coupling.shape());
    }
}

/// Σ sin² for a wave q along each side of a torus: 2K(1 − cos q_x) + 2K(1 − cos q_y), and its root for a half-space, in which the
/// part along the direction of sliding counts 1/(1 − ν) times.
#[test]
fn waves_on_a_torus_have_their_stiffness() {
    let sides = [12, 20];
    let shape = Shape::Square(sides);
    let mut springs = neighbours(shape, Edges::Periodic, 3.0).unwrap();
    let solid = |ratio, sliding| Solid::new(8.0, ratio, sliding);
    let space = |solid: Solid| half_space(shape, Edges::Periodic, solid, 0.25).unwrap();
    let mut isotropic = space(8.0.into());
    let mut down = space(solid(0.3, SlidingDirection::Columns));
    let mut along = space(solid(0.3, SlidingDirection::Rows));
    for waves in [[0, 1], [1, 0], [3, 4], [6, 10]] {
        let q = [0, 1].map(|i| 2.0 * PI * waves[i] as f64 / sides[i] as f64);
        let wave: Vec<f64> =
            (0..240).map(|j| (q[0] * (j / 20) as f64 + q[1] * (j % 20) as f64 + 0.4).cos()).collect();
        let parts = q.map(|q| 2.0 * (1.0 - q.cos()));
        let laplacian: f64 = parts.iter().sum();
        let with =
            |factors: [f64; 2]| 2.0 * (factors[0] * parts[0] + factors[1] * parts[1]) / laplacian.sqrt();
        let expected = [
            (&mut springs, 3.0 * laplacian),
            (&mut isotropic, 2.0 * laplacian.sqrt()),
            (&mut down, with([1.0 / 0.7, 1.0])),
            (&mut along, with([1.0, 1.0 / 0.7])),
        ];
        for (coupling, stiffness) in expected {
            let mut forces = vec![0.0; 240];
            coupling.forces(&wave, &mut forces, &mut ()).unwrap();
            assert!(largest(forces.iter().zip(&wave).map(|(f, x)| f + stiffness * x)) < ROUNDING);
        }
    }
}

/// |q| up to the edge of the zone pulls back at even distances along a row of a lattice, and does nothing there on a chain;
/// the root of the lattice Laplacian pushes everywhere.
#[test]
fn the_half_space_of_a_lattice_pushes_where_that_of_the_continuum_pulls() {
    let n = 32;
    let angle = |k: usize| 2.0 * PI * k as f64 / n as f64;
    let q = |k: usize| angle(k.min(n - k));
    let on_lattice = |k: usize| 2.0 * (0.5 * q(k)).sin();
    let kernel = |of: &dyn Fn(usize) -> f64, rows: usize, m: usize| -> f64 {
        let row = |i: usize| -> f64 { (0..n).map(|k| of(k).hypot(of(i)) * angle(k * m % n).cos()).sum() };
        (0..rows).map(row).sum::<f64>() / (rows * n) as f64
    };
    let shapes = [(1, Shape::Chain(n)), (n, Shape::Square([n, n]))];
    for (rows, shape) in shapes {
        let mut space = half_space(shape, Edges::Periodic, 1.0, 1.0).unwrap();
        let mut displacements = vec![0.0; shape.size()];
        displacements[0] = 1.0;
        let mut pushes = vec![0.0; shape.size()];
        space.forces(&displacements, &mut pushes, &mut ()).unwrap();
        for m in 1..n / 2 {
            let continuum = -kernel(&q, rows, m);
            match (m % 2, shape) {
                (0, Shape::Chain(_)) => assert!(continuum.abs() < ROUNDING),
                (0, Shape::Square(_)) => assert!(continuum < -1e-5, "{m}: {continuum}"),
                _ => assert!(continuum > 1e-5),
            }
            assert!((pushes[m] + kernel(&on_lattice, rows, m)).abs() < ROUNDING && pushes[m] > 1e-5);
        }
    }
}

/// −G*a/(π(m² − ¼)) along a chain; −G*a⁴/2πr³ on a lattice, with G*a⁴(9 + 35 cos 4θ)a²/64πr⁵ to come.
#[test]
fn kernels_between_open_edges_are_those_of_a_plane() {
    let moved = |shape: Shape| {
        let (mut displacements, mut forces) = (vec![0.0; shape.size()], vec![0.0; shape.size()]);
        displacements[0] = 1.0;
        half_space(shape, Edges::Open, 4.0, 0.5)
            .unwrap()
            .forces(&displacements, &mut forces, &mut ())
            .unwrap();
        forces
    };
    let forces = moved(Shape::Chain(400));
    for m in 1..400 {
        let expected = 2.0 / (PI * ((m * m) as f64 - 0.25));
        assert!((forces[m] - expected).abs() < ROUNDING, "{m}");
    }
    let forces = moved(Shape::Square([300, 300]));
    for (row, column) in [(0, 200), (299, 0), (210, 210), (120, 250)] {
        let (x, y) = (0.5 * column as f64, 0.5 * row as f64);
        let r = x.hypot(y);
        let anisotropy = (9.0 + 35.0 * (4.0 * y.atan2(x)).cos()) * 0.25 / (32.0 * r * r);
        let expected = 4.0 * 0.5_f64.powi(4) / (2.0 * PI * r.powi(3)) * (1.0 + anisotropy);
        let found = forces[300 * row + column];
        // What follows is some 10(a/r)⁴, and roundings of what is between neighbours.
        assert!((found - expected).abs() < 1e-8 * expected + 1e-15, "{row} {column}: {found} {expected}");
    }
}

/// G a⁴ [1 − ν/(1 − ν) (1 − 3x²/r²)]/2πr³ between points, x along the direction of sliding.
#[test]
fn kernels_of_a_solid_depend_on_the_direction() {
    const SIDE: usize = 300;
    for (ratio, sliding) in
        [(0.3, SlidingDirection::Columns), (0.45, SlidingDirection::Rows), (-0.5, SlidingDirection::Rows)]
    {
        let shape = Shape::Square([SIDE; 2]);
        let (mut displacements, mut forces) = (vec![0.0; shape.size()], vec![0.0; shape.size()]);
        displacements[0] = 1.0;
        let solid = Solid::new(4.0, ratio, sliding);
        half_space(shape, Edges::Open, solid, 0.5)
            .unwrap()
            .forces(&displacements, &mut forces, &mut ())
            .unwrap();
        for (row, column) in [(0, 200), (299, 0), (210, 210), (120, 250)] {
            let r = 0.5 * (row as f64).hypot(column as f64);
            let x = 0.5 * if sliding == SlidingDirection::Rows { column } else { row } as f64;
            let factor = 1.0 - ratio / (1.0 - ratio) * (1.0 - 3.0 * (x / r).powi(2));
            let expected = 4.0 * 0.5_f64.powi(4) / (2.0 * PI * r.powi(3));
            let found = forces[SIDE * row + column];
            // What follows is some 10(a/r)².
            let follows = 10.0 * (0.5 / r).powi(2) * expected;
            assert!((found - factor * expected).abs() < follows, "{ratio} {row} {column}: {found}");
        }
    }
}

/// Plane strain along the direction of sliding, and antiplane shear across it.
#[test]
fn a_chain_has_the_modulus_of_its_direction() {
    for edges in EDGES {
        let forces = |solid: Solid| {
            let mut forces = vec![0.0; 24];
            half_space(Shape::Chain(24), edges, solid, 0.5)
                .unwrap()
                .forces(&noise(24), &mut forces, &mut ())
                .unwrap();
            forces
        };
        let along = forces(Solid::new(2.0, 0.3, SlidingDirection::Columns));
        let across = forces(Solid::new(2.0, 0.3, SlidingDirection::Rows));
        assert!(apart(&along, &forces((2.0 / 0.7).into())) < ROUNDING);
        assert!(apart(&across, &forces(2.0.into())) < ROUNDING);
    }
}

/// A point force f along x moves a surface that moves only along x by f/(2πGr [1 + ν/(1 − ν) y²/r²]), the inverse transform of
/// |q|/G[q_x²/(1 − ν) + q_y²]; along x and y this is V. Cerruti's solution. Here on a torus whose mean is held.
#[test]
fn a_point_force_moves_the_surface_less_across_its_direction() {
    const SIDE: usize = 1024;
    let (ratio, modulus) = (0.4, 3.0);
    let shape = Shape::Square([SIDE; 2]);
    let solid = Solid::new(modulus, ratio, SlidingDirection::Rows);
    let mut space = half_space(shape, Edges::Periodic, solid, 1.0).unwrap();
    let mut moved = vec![0.0; shape.size()];
    moved[0] = 1.0;
    space.solve_uniform(1e-9, &mut moved, &mut ()).unwrap();
    // Differences are free of the mean displacement.
    let (near, far) = (10, 20);
    let expected = (1.0 / near as f64 - 1.0 / far as f64) / (2.0 * PI * modulus);
    let along = moved[near] - moved[far];
    let across = moved[SIDE * near] - moved[SIDE * far];
    let oblique = moved[(SIDE + 1) * near] - moved[(SIDE + 1) * far];
    // The lattice leaves (a/r)², some 1 %, and the images less.
    assert!((along / expected - 1.0).abs() < 0.01, "{along} {expected}");
    assert!((across / expected - (1.0 - ratio)).abs() < 0.01, "{across} {expected}");
    let between = 1.0 / (1.0 + 0.5 * ratio / (1.0 - ratio)) / 2.0_f64.sqrt();
    assert!((oblique / expected - between).abs() < 0.01, "{oblique} {expected}");
}

#[test]
fn ratios_for_which_cells_would_pull_others_back_are_refused() {
    let build = |ratio| {
        half_space(Shape::Square([4, 4]), Edges::Open, Solid::new(1.0, ratio, SlidingDirection::Rows), 1.0)
    };
    for ratio in [0.5, 0.49, -0.95, f64::NAN, f64::INFINITY] {
        let error = build(ratio).unwrap_err();
        assert!(matches!(&error, Error::Invalid { key, .. } if key == "poisson_ratio"), "{ratio}: {error}");
    }
    // Beyond the first of these numbers the third cell across the direction of sliding would be pulled back.
    for ratio in [0.48, 0.0, -0.9] {
        assert!(build(ratio).is_ok());
    }
}

/// Free ends of a lattice are a mirror, so its response is half that of the torus it is folded from.
#[test]
fn free_edges_are_mirrors_for_neighbours() {
    let (rows, columns) = (7, 10);
    let mut open = neighbours(Shape::Square([rows, columns]), Edges::Open, 1.5).unwrap();
    let mut torus = neighbours(Shape::Square([2 * rows, 2 * columns]), Edges::Periodic, 1.5).unwrap();
    let mut small = noise(rows * columns);
    let mirror = |j: usize, side: usize| if j < side { j } else { 2 * side - 1 - j };
    let unfold = |small: &[f64]| -> Vec<f64> {
        let at = |i: usize| mirror(i / (2 * columns), rows) * columns + mirror(i % (2 * columns), columns);
        (0..4 * rows * columns).map(|i| small[at(i)]).collect()
    };
    let mut large = unfold(&small);
    open.solve_uniform(0.3, &mut small, &mut ()).unwrap();
    torus.solve_uniform(0.3, &mut large, &mut ()).unwrap();
    assert!(apart(&unfold(&small), &large) < ROUNDING);
}

/// A cell of a chain that is pushed takes others along over √(K_int/k) cells: x ∝ e^{−m/ξ}, 2 sinh(1/2ξ) = √(k/K_int).
#[test]
fn a_chain_responds_over_its_correlation_length() {
    let (k, springs) = (0.01, 25.0_f64);
    for edges in EDGES {
        let mut chain = neighbours(Shape::Chain(4001), edges, springs).unwrap();
        let mut x = vec![0.0; 4001];
        x[2000] = 1.0;
        chain.solve_uniform(k, &mut x, &mut ()).unwrap();
        let inverse = 2.0 * (0.5 * (k / springs).sqrt()).asinh();
        assert!((1.0 / inverse / (springs / k).sqrt() - 1.0).abs() < 1e-4);
        let peak = 1.0 / (2.0 * springs * inverse.sinh());
        for m in 0..500 {
            let expected = peak * (-inverse * m as f64).exp();
            // What ends or images at 40 lengths reflect is below 1e-13 of it.
            assert!((x[2000 + m] / expected - 1.0).abs() < 1e-11, "{edges:?} {m}");
        }
    }
}

/// With λ_c = G*a²/k_c, a force f at a distance r moves an infinite plane by f/(2πG*r) · (1 − ξ ∫₀^∞ e^{−ξ sinh u} du),
/// ξ = r/λ_c: f/(2πG*r) for r ≪ λ_c, f λ_c²/(2πG*r³) for r ≫ λ_c.
#[test]
fn a_half_space_responds_like_the_inverse_distance_and_then_its_cube() {
    let (side, modulus, cell) = (1024, 2.0, 0.5);
    let mut space = half_space(Shape::Square([side, side]), Edges::Periodic, modulus, cell).unwrap();
    let mut responses = |cells: f64| {
        let mut x = vec![0.0; side * side];
        x[0] = 1.0;
        // λ_c = so many cells.
        space.solve_uniform(modulus * cell / cells, &mut x, &mut ()).unwrap();
        x
    };
    // The same as ∫₀^∞ e^{−v} (1 − 1/√(1 + v²/ξ²)) dv, by steps of a hundredth of what it varies over.
    let plane = |ξ: f64| {
        let step = 0.01 * ξ.min(1.0);
        let f = |v: f64| (-v).exp() * (1.0 - (1.0 + (v / ξ).powi(2)).sqrt().recip());
        step * (1..).map(|i| step * f64::from(i)).take_while(|&v| v < 40.0).map(f).sum::<f64>()
    };
    // 1/r inside, but for ξ ln(2/ξ), and λ_c²/r³ outside, but for 9/ξ².
    assert!((plane(1e-3) - 1.0).abs() < 1e-2 && (plane(100.0) * 1e4 - 1.0).abs() < 1e-3);
    for (cells, places) in [(64.0, [8, 12, 16, 32]), (2.0, [24, 32, 48, 64])] {
        let x = responses(cells);
        for m in places {
            let (r, ξ) = (m as f64, m as f64 / cells);
            // The images of the cell are so far away that they act by the cube; Σ' |n|⁻³ = 9.0336 on a square lattice.
            let expected = plane(ξ) + 9.0336 * cells * cells * r / (side as f64).powi(3);
            let found = x[m] * 2.0 * PI * modulus * cell * r;
            println!("{} {}", (found / expected - 1.0) * r * r, plane(ξ) * ξ * ξ);
            // Cells are not points: corrections of some (a/r)².
            assert!((found / expected - 1.0).abs() < 2.0 / (r * r), "{cells} {m}: {found} {expected}");
        }
    }
}

/// The least stiffness of a wave on a coupling, by inverse iteration, rigid translations left out.
fn softest(coupling: &mut dyn Coupling) -> f64 {
    let size = coupling.shape().size();
    let (mut x, mut forces) = (noise(size), vec![0.0; size]);
    // The next wave is at least 1.9 times as stiff.
    for _ in 0..80 {
        coupling.solve_uniform(1e-9, &mut x, &mut ()).unwrap();
        let mean = x.iter().sum::<f64>() / size as f64;
        let norm = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>().sqrt();
        x.iter_mut().for_each(|x| *x = (*x - mean) / norm);
    }
    coupling.forces(&x, &mut forces, &mut ()).unwrap();
    2.0 * coupling.energy(&x, &forces)
}

/// Contacts that lose force by |F'| per displacement are stable on ℓ cells if half a wave on them is stiffer than
/// |F'| − K_0; the shortest unstable ℓ is π√(K_int/(|F'| − K_0)) for springs, πG*a²/(|F'| − K_0) for a half-space.
#[test]
fn nucleation_lengths_are_half_waves() {
    let half = 100;
    let lengths = |soft: f64| (PI * (3.0 / soft).sqrt(), PI * 8.0 * 0.25 / soft);
    // Half a wave between free ends, two of them on a ring; lattices are softer than the continuum by (π/ℓ)²/24.
    let lattice = (PI / half as f64).powi(2) / 24.0;
    for (cells, edges) in [(half, Edges::Open), (2 * half, Edges::Periodic)] {
        let mut springs = neighbours(Shape::Chain(cells), edges, 3.0).unwrap();
        let (length, _) = lengths(softest(&mut *springs));
        assert!((length / half as f64 - 1.0 - lattice).abs() < 1e-6, "{edges:?}: {length}");
    }
    let mut space = half_space(Shape::Chain(2 * half), Edges::Periodic, 8.0, 0.5).unwrap();
    let (_, length) = lengths(softest(&mut *space));
    assert!((length / (0.5 * half as f64) - 1.0 - lattice).abs() < 1e-6, "{length}");
}

#[test]
fn bad_numbers_are_refused() {
    let key = |result: Result<Box<dyn Coupling>, Error>| match result.err() {
        Some(Error::Invalid { key, .. }) => key,
        other => panic!("{other:?}"),
    };
    let shape = Shape::Square([4, 4]);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(key(neighbours(shape, Edges::Open, bad)), "stiffness");
        assert_eq!(key(half_space(shape, Edges::Open, bad, 1.0)), "modulus");
        assert_eq!(key(half_space(shape, Edges::Periodic, 1.0, bad)), "cell");
    }
    let empty = [Shape::Chain(0), Shape::Square([0, 4]), Shape::Square([4, 0])];
    for (shape, edges) in empty.into_iter().flat_map(|shape| EDGES.map(|edges| (shape, edges))) {
        assert_eq!(key(neighbours(shape, edges, 1.0)), "cells");
        assert_eq!(key(half_space(shape, edges, 1.0, 1.0)), "cells");
    }
    for shape in [Shape::Chain(2), Shape::Square([2, 8])] {
        assert_eq!(key(neighbours(shape, Edges::Periodic, 1.0)), "cells");
    }
}

#[test]
fn too_many_cells_are_refused_with_what_they_need() {
    let shape = Shape::Square([1 << 20, 1 << 20]);
    for edges in EDGES {
        for coupling in [neighbours(shape, edges, 1.0), half_space(shape, edges, 1.0, 1.0)] {
            let Some(Error::TooLarge { key, needed, allowed, .. }) = coupling.err() else {
                panic!("not refused")
            };
            assert!(key == "cells" && (8 << 40..200 << 40).contains(&needed) && allowed == 1 << 40);
        }
    }
    assert!(matches!(
        neighbours(Shape::Chain(usize::MAX), Edges::Open, 1.0).err(),
        Some(Error::TooLarge { .. })
    ));
}

#[test]
fn threads_change_no_bit() {
    let [one, two] = [1, 2].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
    let shape = Shape::Square([150, 130]);
    for edges in EDGES {
        let make = || [neighbours(shape, edges, 2.0).unwrap(), half_space(shape, edges, 3.0, 1.0).unwrap()];
        let results = |pool: &rayon::ThreadPool| {
            pool.install(|| {
                let mut bits = Vec::new();
                for mut coupling in make() {
                    let x = noise(shape.size());
                    let (mut forces, mut solved) = (vec![0.0; x.len()], x.clone());
                    coupling.forces(&x, &mut forces, &mut ()).unwrap();
                    coupling.solve_uniform(0.1, &mut solved, &mut ()).unwrap();
                    let energy = coupling.energy(&x, &forces);
                    bits.extend(forces.iter().chain(&solved).chain([&energy]).map(|x| x.to_bits()));
                }
                bits
            })
        };
        assert!(results(&one) == results(&two));
    }
}
