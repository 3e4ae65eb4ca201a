//! Contacts that are free for a time of a distribution: renewal equation, cohorts and ensemble, and closed forms.

use crate::common::{contacts, exponential, gamma, gaussian, initial, mixture, point, rectangular, weibull};
use asperity::contacts::{Contacts, FreeFriction, Rules};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::law::SharedLaw;
use asperity::master::{MasterEquation, Transport};

/// Contacts that re-form unstretched after a free time.
fn free(thresholds: &SharedLaw, times: &SharedLaw, friction: FreeFriction) -> Contacts {
    let rules = Rules { delay: times.clone().into(), free_friction: friction, ..Rules::default() };
    Contacts { rules, ..contacts(thresholds, &point(0.0)) }
}

fn without(thresholds: &SharedLaw, times: &SharedLaw) -> Contacts {
    free(thresholds, times, FreeFriction::default())
}

fn at(contacts: &Contacts, velocity: f64) -> MasterEquation {
    MasterEquation::at(contacts.clone(), &initial(&point(0.0)), velocity).unwrap()
}

/// Distributions of free times of mean ½, with names.
fn times() -> Vec<(&'static str, SharedLaw)> {
    vec![
        ("exponential", exponential(0.5)),
        ("gamma", gamma(0.5, 0.2)),
        ("weibull", weibull(2.0, 0.56)),
        ("rectangular", rectangular(0.3, 0.7)),
        ("mixture", mixture(&[(0.4, point(0.2)), (0.6, gamma(0.7, 0.3))])),
    ]
}

/// With one threshold 1, v = 1 and free times of the exponential distribution of mean τ, a contact has broken for the nth time at
/// X = n + the sum of n − 1 free times, whose distribution is a gamma distribution: F = Σ_n over lives begun at Y = n + (sum of n
/// free times) of (X − Y) for Y ≤ X < Y + 1.
#[test]
fn one_threshold_and_exponential_times_have_a_closed_form() {
    let tau = 0.5;
    let pull = at(&without(&point(1.0), &exponential(tau)), 1.0).pull_with(8.0, 1e-10, &mut ()).unwrap();
    let expected = |x: f64| -> f64 {
        let generation = |n: u32| {
            let u = x - f64::from(n);
            if u < 0.0 {
                return 0.0;
            }
            if n == 0 {
                return if x < 1.0 { x } else { 0.0 };
            }
            // ∫(u − s) over sums s of n times in (u − 1, u].
            let mean = f64::from(n) * tau;
            let sum = gamma(mean, f64::from(n).sqrt() * tau);
            let inside = |a: f64| (1.0 - sum.survival(a), mean - sum.upper_moment(1, a));
            let (low, high) = (inside((u - 1.0).max(0.0)), inside(u));
            u * (high.0 - low.0) - (high.1 - low.1)
        };
        (0..9).map(generation).sum()
    };
    for k in 1..=200_u32 {
        let x = 8.0 * (0.618_033_988_749_895 * f64::from(k)).fract();
        let (got, expected) = (pull.force(x), expected(x));
        // The tolerance asked for, per mean life of 3/2.
        assert!((got - expected).abs() < 1.5e-10, "{got:.13}, not {expected:.13}, at X = {x}");
    }
}

/// F_k = ½⟨x²⟩/(⟨x⟩ + v⟨τ⟩) whatever the distribution, and (½⟨x²⟩ + (f + ηv) v⟨τ⟩)/(⟨x⟩ + v⟨τ⟩) with friction of free contacts.
#[test]
fn steady_sliding_depends_on_the_mean_free_time() {
    let friction = FreeFriction { force: 0.2, viscosity: 0.3 };
    for (name, times) in times() {
        for velocity in [0.1, 1.0, 30.0] {
            let thresholds = gaussian(1.0, 0.1);
            let (carried, wait) = (0.5 * 1.01, velocity * times.mean());
            for (contacts, of_free) in [
                (without(&thresholds, &times), 0.0),
                (free(&thresholds, &times, friction), wait * (0.2 + 0.3 * velocity)),
            ] {
                let steady = at(&contacts, velocity).steady_state().kinetic_friction();
                let expected = (carried + of_free) / (1.0 + wait);
                // Rounding of lives.
                assert!((steady / expected - 1.0).abs() < 1e-12, "{name}: {steady}, not {expected}");
            }
        }
    }
}

/// Cohorts in time and the renewal equation share no solver.
#[test]
fn cohorts_agree_with_the_renewal_equation() {
    let friction = FreeFriction { force: 0.2, viscosity: 0.3 };
    for (name, times) in times() {
        let (contacts, velocity) = (free(&gaussian(1.0, 0.2), &times, friction), 0.4);
        let pull = at(&contacts, velocity).pull_with(4.0, 1e-11, &mut ()).unwrap();
        let positions: Vec<f64> = (1..=16).map(|k| 0.25 * f64::from(k)).collect();
        let moments: Vec<f64> = positions.iter().map(|x| x / velocity).collect();
        let history = History::new(vec![Piece { velocity, duration: 4.0 / velocity }]).unwrap();
        let mut transport = Transport::new_with(contacts, &initial(&point(0.0)), 1e-9, &mut ()).unwrap();
        let trace = transport.follow(&history, &moments).unwrap();
        let off = positions.iter().zip(&trace.force).map(|(&x, force)| (pull.force(x) - force).abs());
        let worst = off.fold(0.0, f64::max);
        println!("{name}: {worst:e}");
        // Five times the tolerance of the cohorts, which is that of each of their steps.
        assert!(worst < 5e-9, "{name}: {worst:e}");
    }
}

/// The ensemble draws free times one by one.
#[test]
fn the_ensemble_agrees_within_four_errors() {
    let friction = FreeFriction { force: 0.2, viscosity: 0.3 };
    for (name, times) in times() {
        let contacts = free(&gaussian(1.0, 0.2), &times, friction);
        let velocity = 0.7;
        let pull = at(&contacts, velocity).pull(6.0).unwrap();
        let positions: Vec<f64> = (1..=12).map(|k| 0.5 * f64::from(k)).collect();
        let ensemble = Ensemble::new(contacts, initial(&point(0.0)), 40_000, 7, Disorder::Annealed).unwrap();
        let found = ensemble.pull_at(velocity, &positions).unwrap();
        for (i, &x) in positions.iter().enumerate() {
            let apart = (found.force[i] - pull.force(x)).abs() / found.error[i];
            assert!(apart < 4.0, "{name}: {apart} errors at X = {x}");
        }
    }
}

/// Moved together, step by step, the contacts of the ensemble have the lives of those followed one after the other.
#[test]
fn an_ensemble_in_time_has_the_same_lives() {
    use asperity::rate_dependent::RateDependentContacts;
    let friction = FreeFriction { force: 0.2, viscosity: 0.0 };
    let contacts = free(&gaussian(1.0, 0.2), &exponential(0.5), friction);
    let ensemble = Ensemble::new(contacts, initial(&point(0.0)), 500, 3, Disorder::Annealed).unwrap();
    let velocities = [1.0, 0.2, 3.0];
    let pieces = velocities.map(|velocity| Piece { velocity, duration: 1.5 });
    let history = History::new(pieces.to_vec()).unwrap();
    let expected = ensemble.follow(&history, &[1.5, 3.0, 4.5]).unwrap();
    let mut together = ensemble.in_time().unwrap();
    let (mut work, mut last) = (0.0, together.force());
    for (k, velocity) in velocities.into_iter().enumerate() {
        for _ in 0..1500 {
            let by = velocity * 1e-3;
            together.step(by, 1e-3, &mut ()).unwrap();
            work += 0.5 * (last + together.force()) * by;
            last = together.force();
        }
        let (got, expected) = (together.force(), expected.force[k]);
        assert!((got - expected).abs() < 1e-12 * 500.0, "{got}, not {expected}");
    }
    // Work is elastic energy, breaks and the sliding of free contacts, to the error of the trapezoidal rule across breaks.
    let energies = together.energies();
    let spent = energies.elastic + energies.lost + energies.sliding;
    assert!((work / spent - 1.0).abs() < 3e-3 && energies.sliding > 0.1 * spent, "{work}, not {spent}");
}

/// A single free time keeps contacts in phase, X* = C³/(2π²σ²) with C = ⟨x⟩ + vτ and σ of the thresholds only; a
/// distribution adds v² Var τ to σ², so that X* does not grow as C³.
#[test]
fn a_distribution_of_free_times_ends_the_phase() {
    let length = |times: &SharedLaw, velocity| {
        at(&without(&gaussian(1.0, 0.1), times), velocity).relaxation().unwrap().length()
    };
    for velocity in [2.0, 20.0] {
        let cycle = 1.0 + 0.5 * velocity;
        let single = length(&point(0.5), velocity);
        let phase = cycle.powi(3) / (2.0 * std::f64::consts::PI.powi(2) * 0.01);
        // The next order of the narrow limit, relative (σ/C)² of some 1 %.
        assert!((single / phase - 1.0).abs() < 0.03, "{single}, not {phase}");
        let spread = length(&gamma(0.5, 0.1), velocity);
        let variance = 0.01 + (0.1 * velocity).powi(2);
        let narrow = cycle.powi(3) / (2.0 * std::f64::consts::PI.powi(2) * variance);
        // The same, with (σ/C)² of some 3 %.
        assert!((spread / narrow - 1.0).abs() < 0.1, "{spread}, not {narrow}");
        assert!(spread < 0.25 * single, "{spread} and {single}");
    }
}
