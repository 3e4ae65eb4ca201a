//! The covariance of the force on a pull, against closed forms, the ensemble and the variance.

use crate::common::{equation, exponential, gaussian, mixture, point, rectangular};
use asperity::contacts::{Contacts, Initial, Start, Stiffness};
use asperity::law::SharedLaw;
use asperity::master::{Covariance, MasterEquation, Pull};

fn relaxed(thresholds: &SharedLaw) -> MasterEquation {
    let zero = point(0.0);
    equation(thresholds, &zero, &zero, Start::Conditional)
}

fn covariances(pull: &Pull, positions: &[f64]) -> Vec<f64> {
    pull.covariance(positions, 1.0).unwrap().values().to_vec()
}

/// Values of a solution on a fine grid, made for them. 1e-11: the sum of some ten terms of order 1, each
/// accurate to 1e-12.
#[test]
fn covariances_of_gaussian_thresholds_have_their_reference_values() {
    let pull = relaxed(&gaussian(1.0, 0.1)).pull_with(6.0, 1e-11, &mut ()).unwrap();
    let found = covariances(&pull, &[0.9, 1.0, 2.18, 5.45]);
    for (i, j, expected) in [
        (0, 0, 0.096_188_366_245_350_4),
        (0, 1, 0.052_402_383_426_301_9),
        (1, 2, 0.011_373_566_364_583_7),
        (2, 3, -0.000_603_177_128_623_699),
    ] {
        assert!((found[4 * i + j] - expected).abs() < 1e-11, "{i} {j}: {}", found[4 * i + j]);
    }
}

/// Exponential thresholds: the covariance at X₁ and X₂.
fn of_exponential(a: f64, b: f64) -> f64 {
    let (low, high) = (a.min(b), a.max(b));
    (low - high).exp() - 2.0 * low * (-high).exp() - (-low - high).exp()
}

/// F = 1 − e^{−X} and C = e^{−(X₂ − X₁)} − 2X₁e^{−X₂} − e^{−(X₁ + X₂)}.
#[test]
fn exponential_thresholds_have_a_closed_form() {
    let pull = relaxed(&exponential(1.0)).pull_with(8.0, 1e-12, &mut ()).unwrap();
    let positions: Vec<f64> = (0..=40).map(|k| 0.2 * f64::from(k)).collect();
    let found = covariances(&pull, &positions);
    for (i, a) in positions.iter().enumerate() {
        for (j, b) in positions.iter().enumerate() {
            let exact = of_exponential(*a, *b);
            assert!((found[41 * i + j] - exact).abs() < 1e-11, "{a} {b}: {:e}", found[41 * i + j] - exact);
        }
    }
}

/// Starts and re-formed contacts spread out, point masses, edges: the diagonal is the variance from ∫x²Q.
#[test]
fn the_diagonal_is_the_variance() {
    let zero = point(0.0);
    let smooth = gaussian(1.0, 0.2);
    let edges = rectangular(0.7, 1.3);
    let points = mixture(&[(0.3, point(0.8)), (0.7, smooth.clone())]);
    let several = mixture(&[(0.2, point(0.57)), (0.3, point(0.9)), (0.5, gaussian(1.0, 0.1))]);
    let spread = gaussian(0.1, 0.03);
    let wide = rectangular(0.0, 0.9);
    for (thresholds, reforming, initial, start) in [
        (&smooth, &spread, &wide, Start::Conditional),
        (&smooth, &spread, &wide, Start::Relaxed),
        (&edges, &zero, &wide, Start::Relaxed),
        (&edges, &spread, &spread, Start::Conditional),
        (&points, &spread, &zero, Start::Conditional),
        (&points, &zero, &wide, Start::Relaxed),
        (&points, &zero, &zero, Start::Conditional),
        (&several, &point(0.05), &zero, Start::Conditional),
    ] {
        let equation = equation(thresholds, reforming, initial, start);
        let pull = equation.pull_with(4.0, 1e-11, &mut ()).unwrap();
        // No multiples of a lattice that point masses share.
        let positions: Vec<f64> = (0..50).map(|k| 0.0797 * f64::from(k)).collect();
        let found = pull.covariance(&positions, 100.0).unwrap();
        let std = pull.force_std(100.0).unwrap();
        for (i, x) in positions.iter().enumerate() {
            let apart = found.at(i, i) - std(*x).powi(2);
            // per contact; 1e-11 of the solution times the terms, of order X
            assert!(100.0 * apart.abs() < 1e-10, "{thresholds:?} {start:?} {x}: {apart:e}");
        }
        assert!(found.error_estimate() < 1e-11);
    }
}

/// 56 pairs of positions against 4·10⁵ contacts followed one by one. The estimate of a covariance from n contacts
/// scatters by √[(⟨f₁²f₂²⟩ − C²)/n]. The root mean square of the differences in these units, which are correlated,
/// is 1 ± 0.3; over 100 groups of 4000 contacts, which are independent, it is 1 ± 0.1: three standard errors, if the
/// pairs of a group count as six independent ones.
#[test]
fn covariances_are_those_of_contacts_followed_one_by_one() {
    use asperity::random::{Purpose, Stream};
    let (thresholds, reforming) = (gaussian(1.0, 0.2), gaussian(0.1, 0.03));
    let initial = rectangular(0.0, 0.6);
    let equation = equation(&thresholds, &reforming, &initial, Start::Conditional);
    let pull = equation.pull_with(4.0, 1e-10, &mut ()).unwrap();
    let positions: Vec<f64> = (1..=11).map(|k| 0.35 * f64::from(k)).collect();
    let exact = pull.covariance(&positions, 1.0).unwrap();
    const CONTACTS: u64 = 400_000;
    const GROUP: u64 = 4000;
    let draw = |law: &SharedLaw, stream: &mut Stream, above: f64| {
        // conditional on x_s > the stretch at which the contact starts
        let mut value = [0.0];
        loop {
            law.fill(stream, &mut value);
            if value[0] > above {
                return value[0];
            }
        }
    };
    let mut sums = vec![[0.0; 2]; 11 * 11];
    let mut group = sums.clone();
    let mut scores = Scores::default();
    for contact in 0..CONTACTS {
        let mut stream = Stream::new(7, Purpose::Sample, contact);
        let mut start = draw(&initial, &mut stream, -1.0);
        let (mut threshold, mut moved) = (draw(&thresholds, &mut stream, start), 0.0);
        let forces: Vec<f64> = positions
            .iter()
            .map(|x| {
                while moved + threshold - start <= *x {
                    moved += threshold - start;
                    start = draw(&reforming, &mut stream, -1.0);
                    threshold = draw(&thresholds, &mut stream, start);
                }
                start + x - moved
            })
            .collect();
        for i in 0..11 {
            for j in 0..=i {
                let product = (forces[i] - exact.mean()[i]) * (forces[j] - exact.mean()[j]);
                group[11 * i + j][0] += product;
                group[11 * i + j][1] += product * product;
            }
        }
        if contact % GROUP == GROUP - 1 {
            scores.add(&exact, &group, GROUP);
            sums.iter_mut().flatten().zip(group.iter().flatten()).for_each(|(sum, part)| *sum += part);
            group.fill([0.0; 2]);
        }
    }
    let mut all = Scores::default();
    all.add(&exact, &sums, CONTACTS);
    assert!(all.pairs == 56 && (0.7..1.3).contains(&all.rms()), "{}", all.rms());
    assert!(scores.pairs == 5600 && (0.9..1.1).contains(&scores.rms()), "{}", scores.rms());
}

/// Differences between exact and estimated covariances, in standard errors.
#[derive(Default)]
struct Scores {
    squares: f64,
    pairs: u32,
}

impl Scores {
    /// Adds those of `size` contacts with these sums of products and of their squares.
    fn add(&mut self, exact: &Covariance, sums: &[[f64; 2]], size: u64) {
        for i in 0..11 {
            for j in (0..=i).filter(|j| (i + j) % 6 != 5) {
                let [mean, square] = sums[11 * i + j].map(|sum| sum / size as f64);
                let z = (mean - exact.at(i, j)) / ((square - mean * mean) / size as f64).sqrt();
                self.squares += z * z;
                self.pairs += 1;
            }
        }
    }

    fn rms(&self) -> f64 {
        f64::sqrt(self.squares / f64::from(self.pairs))
    }
}

/// Sample paths have the mean and the covariance that they are drawn with: 4000 paths at 40 positions. The standard
/// error of a covariance is √[(C₁₁C₂₂ + C₁₂²)/4000]: none of 1600 is off by six of them.
#[test]
fn sample_paths_have_the_covariance() {
    let pull = relaxed(&gaussian(1.0, 0.1)).pull_with(6.0, 1e-10, &mut ()).unwrap();
    let positions: Vec<f64> = (0..40).map(|k| 0.15 * f64::from(k)).collect();
    let covariance = pull.covariance(&positions, 1000.0).unwrap();
    let paths = covariance.sample_paths(4000, 3).unwrap();
    assert_eq!(paths, covariance.sample_paths(4000, 3).unwrap());
    let over = |i: usize, j: usize| {
        let apart = |path: &Vec<f64>, i: usize| path[i] - covariance.mean()[i];
        paths.iter().map(|path| apart(path, i) * apart(path, j)).sum::<f64>() / 4000.0
    };
    for i in 0..40 {
        for j in 0..=i {
            let squares = covariance.at(i, i) * covariance.at(j, j) + covariance.at(i, j).powi(2);
            // At X = 0 the force is certain; its variance is 0 up to rounding, of either sign.
            let error = (squares.max(0.0) / 4000.0).sqrt();
            assert!((over(i, j) - covariance.at(i, j)).abs() <= 6.0 * error + 1e-12, "{i} {j}");
        }
    }
}

/// What has no covariance of this form is refused with the reason.
#[test]
fn what_does_not_renew_completely_is_refused() {
    let (law, zero) = (gaussian(1.0, 0.1), point(0.0));
    let initial = Initial { law: zero.clone(), start: Start::Conditional };
    let mut contacts = Contacts::new(law, zero);
    contacts.rules.delay = 0.5.into();
    let pull = MasterEquation::at(contacts, &initial, 1.0).unwrap().pull_with(2.0, 1e-8, &mut ()).unwrap();
    let error = pull.covariance(&[1.0], 1.0).unwrap_err().to_string();
    assert!(error.contains("delay"), "{error}");
    let mut contacts = Contacts::new(gaussian(1.0, 0.1), point(0.0));
    contacts.stiffness = Stiffness::PerThreshold(1.2);
    let equation = MasterEquation::new(contacts, &initial).unwrap();
    let error = equation.pull(2.0).unwrap().covariance(&[1.0], 1.0).unwrap_err().to_string();
    assert!(error.contains("equal stiffness"), "{error}");
    let pull = relaxed(&gaussian(1.0, 0.1)).pull_with(2.0, 1e-8, &mut ()).unwrap();
    assert!(pull.covariance(&[2.5], 1.0).is_err());
    assert!(pull.covariance(&[1.0], 0.0).is_err());
}

/// Contacts that feel temperature or age at a velocity renew completely at a break, too: the diagonal is the variance,
/// and contacts that start like those in steady sliding, after a long way, have the autocovariance of steady sliding.
#[test]
fn contacts_in_time_have_a_covariance() {
    use asperity::contacts::{Ageing, AgeingRule, Barrier, Temperature};
    let plain = Contacts::new(gaussian(1.0, 0.25), gaussian(0.1, 0.03));
    let mut warm = plain.clone();
    warm.rules.temperature = Some(Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.02, 10.0) });
    let mut aged = plain;
    let rule: Ageing = AgeingRule::Logarithmic { growth: 0.05, time: 1.0 };
    aged.rules.ageing = Some(rule);
    let initial = Initial { law: point(0.0), start: Start::Conditional };
    for contacts in [warm, aged] {
        let equation = MasterEquation::at(contacts, &initial, 0.5).unwrap();
        let pull = equation.pull(40.0).unwrap();
        let positions = [0.4, 0.9, 1.7, 3.1, 36.0, 36.4, 37.5];
        let found = pull.covariance(&positions, 1.0).unwrap();
        let std = pull.force_std(1.0).unwrap();
        for (i, &x) in positions.iter().enumerate() {
            // The default aim of 1e-10, times terms of the order of X².
            assert!((found.at(i, i) - std(x).powi(2)).abs() < 1e-7, "{x}");
        }
        let steady = equation.steady_state();
        let c = steady.autocovariance(&[0.0, 0.4, 1.5], 1.0).unwrap();
        for (j, c) in c.iter().enumerate() {
            // Relaxation over 36 lengths leaves less than 1e-6.
            assert!((found.at(4, 4 + j) - c).abs() < 1e-6, "{j}: {} {c}", found.at(4, 4 + j));
        }
        let s = steady.spectrum(&[0.0, 5.0], 1.0).unwrap();
        let advances: Vec<f64> = (0..=4000).map(|k| 0.01 * f64::from(k)).collect();
        let c = steady.autocovariance(&advances, 1.0).unwrap();
        let sum = |q: f64| {
            let weight = |k: usize| {
                if k == 0 || k == 4000 {
                    1.0
                } else if k % 2 == 1 {
                    4.0
                } else {
                    2.0
                }
            };
            let term = |(k, (u, c)): (usize, (&f64, &f64))| weight(k) * c * (q * u).cos();
            2.0 * 0.01 / 3.0 * advances.iter().zip(&c).enumerate().map(term).sum::<f64>()
        };
        for (s, q) in s.iter().zip([0.0, 5.0]) {
            // Simpson's rule with steps of 0.01, and what the autocovariance has left after 40 lengths.
            assert!((s - sum(q)).abs() < 1e-6, "{q}: {s} {}", sum(q));
        }
    }
}

/// A position that rounding has put beyond the end of the pull is the end.
#[test]
fn the_end_of_a_pull_may_be_rounded() {
    let pull = relaxed(&gaussian(1.0, 0.1)).pull(3.0).unwrap();
    let found = pull.covariance(&[3.0, 0.1 * 30.0], 1.0).unwrap();
    assert!((found.at(0, 0) - found.at(1, 1)).abs() < 1e-9 && found.at(0, 0) > 0.0);
}

/// Positions in any order, the start of the pull, positions that are repeated, one position, none: the covariance of
/// each pair is that of its positions, and sample paths have one value at one position.
#[test]
fn positions_may_be_unordered_repeated_few_or_none() {
    let pull = relaxed(&exponential(1.0)).pull_with(8.0, 1e-12, &mut ()).unwrap();
    let mut repeated = vec![2.0; 300];
    repeated.extend([0.0, 7.5, 0.3, 8.0, 0.0, 2.0]);
    for positions in [vec![3.0, 0.5, 8.0, 0.0, 2.0], repeated, vec![0.0], vec![1.7], vec![0.0; 3], Vec::new()]
    {
        let count = positions.len();
        let found = pull.covariance(&positions, 1.0).unwrap();
        assert_eq!((found.positions(), found.values().len()), (&positions[..], count * count));
        for (i, &a) in positions.iter().enumerate() {
            for (j, &b) in positions.iter().enumerate() {
                assert!((found.at(i, j) - of_exponential(a, b)).abs() < 1e-11, "{a} {b}");
                assert_eq!(found.at(i, j), found.at(j, i));
            }
        }
        let paths = found.sample_paths(5, 1).unwrap();
        assert_eq!(paths.len(), 5);
        for path in &paths {
            assert_eq!(path.len(), count);
            for (i, j) in (0..count).flat_map(|i| (0..i).map(move |j| (i, j))) {
                // A repeated position has a pivot of 0 up to the estimated error, of which the square root counts.
                let apart = (path[i] - path[j]).abs();
                assert!(positions[i] != positions[j] || apart < 1e-5, "{}: {apart:e}", positions[i]);
            }
        }
    }
}

/// Positions that are not on the pull are refused, and named.
#[test]
fn positions_beyond_the_pull_are_refused() {
    let pull = relaxed(&exponential(1.0)).pull_with(8.0, 1e-8, &mut ()).unwrap();
    for (wrong, shown) in [(-0.1, "-0.1"), (8.1, "8.1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        let error = pull.covariance(&[1.0, wrong, 2.0], 1.0).unwrap_err().to_string();
        assert!(
            error.contains("positions") && error.contains("from 0 to 8") && error.contains(shown),
            "{error}"
        );
    }
}

/// With 1e-12 on the diagonal every pivot of the Cholesky factorisation is positive.
#[test]
fn covariances_are_positive_definite() {
    let pull = relaxed(&gaussian(1.0, 0.1)).pull_with(6.0, 1e-12, &mut ()).unwrap();
    let positions: Vec<f64> = (1..=120).map(|k| 0.05 * f64::from(k)).collect();
    let covariance = pull.covariance(&positions, 1.0).unwrap();
    let mut factor = vec![vec![0.0; positions.len()]; positions.len()];
    for i in 0..positions.len() {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = covariance.at(i, j) + if i == j { 1e-12 } else { 0.0 } - known;
            assert!(i != j || rest > 0.0, "{i}: {rest:e}");
            factor[i][j] = if i == j { f64::sqrt(rest) } else { rest / factor[j][j] };
        }
    }
}
