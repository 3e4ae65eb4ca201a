//! The contacts of a master equation moved back and forth, against closed forms and quadratures of their own.

use crate::common::walk::{drive, force, integral};
use crate::common::{
    contacts, exponential, gamma, gaussian, initial, master, mixture, point, rectangular, weibull,
};
use asperity::contacts::{Initial, Start, Stiffness, StiffnessTable};
use asperity::law::SharedLaw;
use asperity::master::{MasterEquation, MasterPopulation, Pull};
use asperity::population::{Direction, Population};

/// Asked for, and reached.
const PROMISED: f64 = 1e-10;

fn rest() -> SharedLaw {
    point(0.0)
}

fn population(thresholds: &SharedLaw, reforming: &SharedLaw, start: &SharedLaw) -> MasterPopulation {
    master(thresholds, reforming, start).population_with(PROMISED, &mut ()).unwrap()
}

/// Thresholds, R, Q_ini: smooth, jumping, pointed, overlapping.
fn laws() -> Vec<(SharedLaw, SharedLaw, SharedLaw)> {
    let half = mixture(&[(0.5, point(1.0)), (0.5, gaussian(0.8, 0.06))]);
    let some = mixture(&[(0.4, point(0.1)), (0.6, rectangular(0.0, 0.3))]);
    let two = mixture(&[(0.3, point(0.7)), (0.7, point(1.1))]);
    vec![
        (gaussian(1.0, 0.05), rest(), gaussian(0.1, 0.025)),
        (gaussian(1.0, 0.1), gaussian(0.2, 0.04), rest()),
        (weibull(2.5, 1.0), gaussian(0.2, 0.04), rectangular(0.1, 0.3)),
        (gamma(1.0, 0.3), rest(), rectangular(0.1, 0.5)),
        (rectangular(0.75, 1.25), rest(), rest()),
        (rectangular(0.4, 1.6), rectangular(0.0, 0.6), rectangular(0.2, 1.1)),
        (exponential(1.0), rest(), rest()),
        (point(1.0), rest(), rest()),
        (point(1.0), rectangular(0.0, 0.5), gaussian(0.4, 0.05)),
        (two, rectangular(0.0, 0.2), rest()),
        (half, some.clone(), some),
    ]
}

#[test]
fn a_way_forth_is_a_pull() {
    for (thresholds, reforming, start) in laws() {
        let master = master(&thresholds, &reforming, &start);
        let pull = master.pull_with(20.0, 1e-12, &mut ()).unwrap();
        let mut population = master.population_with(1e-12, &mut ()).unwrap();
        for k in 1..80 {
            let position = 0.247 * f64::from(k);
            drive(&mut population, position);
            let error = force(&mut population) - pull.force(position);
            assert!(error.abs() < 1e-12, "{thresholds:?} at {position}: {error:e}");
        }
    }
}

#[test]
fn a_relaxed_start_is_that_of_a_pull() {
    let contacts = contacts(&gaussian(1.0, 0.1), &gaussian(0.1, 0.02));
    let start = Initial { law: gaussian(1.0, 0.2), start: Start::Relaxed };
    let master = MasterEquation::new(contacts, &start).unwrap();
    let pull = master.pull_with(5.0, 1e-12, &mut ()).unwrap();
    let mut population = master.population_with(1e-12, &mut ()).unwrap();
    for position in [0.0, 0.3, 0.9, 2.2, 4.9] {
        drive(&mut population, position);
        assert!((force(&mut population) - pull.force(position)).abs() < 1e-12, "{position}");
    }
}

#[test]
fn unloading_is_a_straight_line_and_loading_again_the_same() {
    for (thresholds, reforming, start) in laws() {
        let mut population = population(&thresholds, &reforming, &start);
        drive(&mut population, 1.37);
        let departure = force(&mut population);
        let interval = population.smooth_interval(Direction::Backward, &mut ()).unwrap();
        if !interval.straight {
            // Some thresholds are as low as the stretches of the fresh.
            assert!(thresholds.quantile(1e-12) < 1e-6, "{thresholds:?}");
            continue;
        }
        let back = 0.9 * interval.length;
        let energies = population.energies();
        for part in [0.0, 0.3, 1.0] {
            let response = population.ahead(-back * part);
            let line = departure - back * part;
            assert!((response.force - line).abs() < 1e-13 && (response.tangent - 1.0).abs() < 1e-12);
        }
        drive(&mut population, 1.37 - back);
        assert_eq!(
            (population.energies().lost, population.energies().broken),
            (energies.lost, energies.broken)
        );
        drive(&mut population, 1.37);
        // Nothing has broken: the way on is that of before, to the last bit.
        assert_eq!(force(&mut population), departure);
        assert_eq!(population.energies(), energies);
    }
}

/// F of contacts that start relaxed with R = δ(0), on the way back from X_m by u, by whom they are: those of the start,
/// at X_m, and those that re-formed along the way, now at r at the rate Γ(X_m − r). Past −max(r, …) they break again,
/// and what re-forms then goes the mirror image of a way forth from rest: `fresh`.
fn reversed(thresholds: &SharedLaw, forth: &Pull, turn: f64, u: f64, knots: &[f64]) -> f64 {
    let law = thresholds.as_ref();
    let one = |r: f64| {
        let most = r.max(u - r);
        let cuts: Vec<f64> = knots.iter().flat_map(|k| [*k, u - r - k]).collect();
        let again = integral(r, most, &cuts, 6, |xi| law.density(xi) * forth.force((u - r - xi).max(0.0)));
        (r - u) * law.survival(most) - again
    };
    let met = knots.iter().flat_map(|k| [*k, turn - k, u - k]);
    let places: Vec<f64> = met.chain([0.5 * u]).collect();
    one(turn) + integral(0.0, turn, &places, 6, |r| forth.breaking_rate(turn - r) * one(r))
}

#[test]
fn the_way_back_by_whom_the_contacts_are() {
    let sums = |a: f64, b: f64| {
        (1..4).flat_map(move |n| (0..=n).map(move |k| f64::from(n - k) * a + f64::from(k) * b))
    };
    let cases: [(SharedLaw, Vec<f64>); 3] = [
        (rectangular(0.75, 1.25), sums(0.75, 1.25).collect()),
        (gaussian(1.0, 0.1), Vec::new()),
        (gamma(1.0, 0.3), Vec::new()),
    ];
    for (thresholds, knots) in cases {
        let equation = master(&thresholds, &rest(), &rest());
        let forth = equation.pull_with(5.0, 1e-12, &mut ()).unwrap();
        for turn in [0.6, 0.95, 1.4] {
            let mut population = equation.population_with(PROMISED, &mut ()).unwrap();
            drive(&mut population, turn);
            for u in [0.3, 0.8, 1.1, 1.5, 2.3, 2.9] {
                drive(&mut population, turn - u);
                let expected = reversed(&thresholds, &forth, turn, u, &knots);
                let error = (force(&mut population) - expected).abs();
                assert!(error < PROMISED, "{thresholds:?}, {u} back from {turn}: {error:e}");
            }
        }
    }
}

#[test]
fn contacts_without_memory_turn() {
    // Exponential thresholds, steady sliding: of the contacts, at e^{−x}, those below u/2 have begun to break again, at the
    // rate 1; their force f obeys f' = −(1 − e^{−u/2}) − f − ¼u e^{−u/2}, the others just move.
    let mut population = population(&exponential(1.0), &rest(), &rest());
    drive(&mut population, 40.0);
    for u in [0.1, 0.5, 1.0, 2.0, 3.5, 7.0] {
        drive(&mut population, 40.0 - u);
        let half = (-0.5 * u).exp();
        let expected = -1.0 + (4.0 - u) * half - 2.0 * half * half;
        let got = force(&mut population);
        assert!((got - expected).abs() < PROMISED, "{u}: {got}, not {expected}");
    }
}

#[test]
fn one_contact_goes_round_its_loop() {
    // Identical thresholds: all contacts are as one.
    let mut population = population(&point(1.0), &rest(), &rest());
    let mut stretch = 0.0_f64;
    let mut broken = 0;
    let mut place = 0.0;
    for to in [0.7, 1.3, -0.2, -0.9, 0.35, -1.4, -1.1, 3.45, -3.3, -3.1, -3.55, 0.0] {
        drive(&mut population, to);
        stretch += to - place;
        place = to;
        broken += stretch.abs() as u32;
        stretch = stretch.fract();
        assert!((force(&mut population) - stretch).abs() < 1e-14, "{to}: {stretch}");
        let energies = population.energies();
        assert_eq!(energies.broken.round(), f64::from(broken));
        assert!((energies.lost - 0.5 * f64::from(broken)).abs() < 1e-13, "{to}");
        assert!((energies.elastic - 0.5 * stretch * stretch).abs() < 1e-14, "{to}");
    }
}

#[test]
fn contacts_stand_before_they_break_together() {
    let mut population = population(&point(1.0), &rest(), &rest());
    let stands = |population: &mut MasterPopulation, sign: f64, broken: f64| {
        assert!((population.ahead(0.0).force - sign).abs() < 1e-14);
        assert!((population.energies().broken - broken).abs() < 1e-14);
        assert!((population.energies().elastic - 0.5).abs() < 1e-14);
        assert!((population.total_probability() - 1.0).abs() < 1e-14);
    };
    let to_the_end = |population: &mut MasterPopulation, direction: Direction, length: f64| {
        let from = population.position();
        loop {
            let interval = population.smooth_interval(direction, &mut ()).unwrap();
            population.advance(direction.sign() * interval.length).unwrap();
            if interval.breaks {
                break;
            }
        }
        let gone = (population.position() - from).abs();
        assert!((gone - length).abs() < 1e-14, "{gone}, not {length}");
    };
    to_the_end(&mut population, Direction::Forward, 1.0);
    stands(&mut population, 1.0, 0.0);
    // Back without a break, and there again.
    population.smooth_interval(Direction::Backward, &mut ()).unwrap();
    population.advance(-0.5).unwrap();
    assert!((population.ahead(0.0).force - 0.5).abs() < 1e-14);
    to_the_end(&mut population, Direction::Forward, 0.5);
    stands(&mut population, 1.0, 0.0);
    population.cross(&mut ()).unwrap();
    assert!(force(&mut population).abs() < 1e-14 && (population.energies().broken - 1.0).abs() < 1e-14);
    // The other way the straight line itself ends so.
    drive(&mut population, 1.7);
    to_the_end(&mut population, Direction::Backward, 1.7);
    stands(&mut population, -1.0, 1.0);
    population.cross(&mut ()).unwrap();
    assert!(force(&mut population).abs() < 1e-14 && (population.energies().broken - 2.0).abs() < 1e-14);
    // Held before they break, they are free.
    to_the_end(&mut population, Direction::Backward, 1.0);
    population.hold().unwrap();
    stands(&mut population, -1.0, 2.0);
    population.cross(&mut ()).unwrap();
    let energies = population.energies();
    assert!(
        (energies.lost - 1.5).abs() < 1e-14
            && (energies.broken - 3.0).abs() < 1e-14
            && energies.elastic == 0.0
    );
    assert!((population.total_probability() - 1.0).abs() < 1e-14);
    drive(&mut population, -1.5);
    assert_eq!(force(&mut population), 0.0);
    population.release(&mut ()).unwrap();
    drive(&mut population, -1.2);
    assert!((force(&mut population) - 0.3).abs() < 1e-14);
}

#[test]
fn what_breaks_under_hold_stays_free() {
    // From rest, R = δ(0): up to X₁ as a pull; then those unbroken since; what is free re-forms at X₂.
    for thresholds in [gaussian(1.0, 0.1), weibull(2.5, 1.0), gamma(1.0, 0.3)] {
        let law = thresholds.as_ref();
        let equation = master(&thresholds, &rest(), &rest());
        let forth = equation.pull_with(6.0, 1e-12, &mut ()).unwrap();
        for (held, released) in [(0.9, 1.3), (1.7, 2.0), (2.4, 3.5)] {
            let mut population = equation.population_with(PROMISED, &mut ()).unwrap();
            drive(&mut population, held);
            population.hold().unwrap();
            let since = |x: f64, weight: &dyn Fn(f64) -> f64| {
                weight(x) + integral(0.0, held, &[], 40, |y| forth.breaking_rate(y) * weight(x - y))
            };
            let carried = |x: f64| since(x, &|u| u * law.survival(u));
            for x in [held, 0.5 * (held + released), released] {
                drive(&mut population, x);
                assert!((force(&mut population) - carried(x)).abs() < PROMISED, "{thresholds:?} held at {x}");
                assert!((population.total_probability() - 1.0).abs() < 1e-12);
            }
            let free = 1.0 - since(released, &|u| law.survival(u));
            population.release(&mut ()).unwrap();
            for x in [released, released + 0.4, released + 1.1] {
                drive(&mut population, x);
                let again =
                    integral(released, x, &[], 20, |y| since(y, &|u| law.density(u)) * forth.force(x - y));
                let expected = carried(x) + free * forth.force(x - released) + again;
                let error = (force(&mut population) - expected).abs();
                assert!(error < PROMISED, "{thresholds:?} released, at {x}: {error:e}");
            }
        }
    }
}

#[test]
fn a_reset_begins_anew() {
    for (thresholds, reforming, start) in laws() {
        let anew = master(&thresholds, &reforming, &reforming).pull_with(3.0, 1e-12, &mut ()).unwrap();
        let mut population = population(&thresholds, &reforming, &start);
        drive(&mut population, 1.9);
        drive(&mut population, 0.4);
        for direction in [Direction::Forward, Direction::Backward, Direction::Forward] {
            population.reset(direction, &mut ()).unwrap();
            let from = population.position();
            for by in [0.0, 0.613, 1.177, 2.441] {
                drive(&mut population, from + direction.sign() * by);
                let error = (force(&mut population) - direction.sign() * anew.force(by)).abs();
                assert!(error < PROMISED, "{thresholds:?} {by} {direction:?}: {error:e}");
            }
        }
    }
}

/// Forth, back, nested, held and released, reset.
fn wander(population: &mut MasterPopulation, mut check: impl FnMut(&mut MasterPopulation, f64)) {
    let mut work = 0.0;
    for to in [1.4, 0.9, -0.83, 0.31, 0.2, 1.93, -1.87] {
        work += drive(population, to);
        check(population, work);
    }
    population.hold().unwrap();
    for to in [-2.2, -1.9, -2.3] {
        work += drive(population, to);
        check(population, work);
    }
    population.release(&mut ()).unwrap();
    check(population, work);
    work += drive(population, -1.2);
    check(population, work);
    population.reset(Direction::Forward, &mut ()).unwrap();
    check(population, work);
    work += drive(population, 0.7);
    check(population, work);
}

#[test]
fn energy_is_conserved_and_no_contact_is_lost() {
    for (k, (thresholds, reforming, start)) in laws().into_iter().enumerate() {
        let table = StiffnessTable::new(vec![(0.7, 1.0), (0.9, 2.0), (1.1, 0.5)]).unwrap();
        // Unequal stiffnesses by turns: of smooth laws and of jumping ones with either.
        let unequal = [Stiffness::PerThreshold(3.0), Stiffness::Tabulated(table)][k % 2].clone();
        for stiffness in [Stiffness::Equal(2.0), unequal] {
            let mut contacts = contacts(&thresholds, &reforming);
            (contacts.count, contacts.stiffness) = (5.0, stiffness.clone());
            let name = format!("{thresholds:?} {stiffness:?}");
            // Turns blur the kinks of a table, which leaves 1.6e-10 on one of the branches.
            let tolerance = if let Stiffness::Tabulated(_) = stiffness { 1e-9 } else { PROMISED };
            let mut population = MasterEquation::new(contacts, &initial(&start))
                .unwrap()
                .population_with(tolerance, &mut ())
                .unwrap();
            let before = population.energies();
            assert_eq!((before.lost, before.broken), (0.0, 0.0));
            wander(&mut population, |population, work| {
                let energies = population.energies();
                let balance = work - (energies.elastic - before.elastic) - energies.lost;
                // Work is integrated by Gauss points between some hundred turns, forces are solved to 1e-10.
                assert!(balance.abs() < 1e-9, "{name}: {balance:e} at {}", population.position());
                let missing = population.total_probability() - 1.0;
                assert!(missing.abs() < 1e-2 * tolerance, "{name}: {missing:e} at {}", population.position());
            });
        }
    }
}

#[test]
fn steady_loops_are_odd() {
    // All thresholds are below the amplitude: else contacts that are never stretched to theirs gather for ever.
    let cases = [(rectangular(0.75, 1.25), rest()), (rectangular(0.4, 1.6), rectangular(0.0, 0.6))];
    for (thresholds, reforming) in cases {
        let mut population = population(&thresholds, &reforming, &rest());
        for _ in 0..10 {
            drive(&mut population, 3.0);
            drive(&mut population, -3.0);
        }
        let mut forth = Vec::new();
        for x in [-3.0, -2.2, -1.0, 0.4, 1.7, 3.0] {
            drive(&mut population, x);
            forth.push(force(&mut population));
        }
        for (x, forth) in [-3.0, -2.2, -1.0, 0.4, 1.7, 3.0].into_iter().zip(forth) {
            drive(&mut population, -x);
            let error = (force(&mut population) + forth).abs();
            assert!(error < 1e-9, "{thresholds:?} at {x}: {error:e}");
        }
    }
}

#[test]
fn a_copy_goes_its_own_way() {
    let mut one = population(&gaussian(1.0, 0.1), &rest(), &rest());
    drive(&mut one, 0.8);
    let mut other = one.copy();
    drive(other.as_mut(), -1.0);
    assert!((one.position() - 0.8).abs() < 1e-14);
    drive(&mut one, -1.0);
    assert_eq!((force(&mut one), one.energies()), (force(other.as_mut()), other.energies()));
}

#[test]
fn a_tolerance_must_make_sense() {
    let equation = master(&gaussian(1.0, 0.1), &rest(), &rest());
    for tolerance in [0.0, 1e-13, 0.1, f64::NAN] {
        let error = equation.population_with(tolerance, &mut ()).unwrap_err().to_string();
        assert!(error.contains("tolerance: expected a number from 1e-12 to 1e-2"), "{error}");
    }
}
