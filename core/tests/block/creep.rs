//! Creep under a constant force, and static fatigue.

use std::sync::Arc;

use asperity::block::{CreepAccuracy, CreepLoad, CreepPath};
use asperity::contacts::{Ageing, Contacts, FreeTime, Initial, Rules, Temperature};
use asperity::law::{Gaussian, Law, Point};
use asperity::master::{MasterEquation, Transport};

/// Contacts of unit number and stiffness that re-form relaxed.
fn contacts(thresholds: Arc<dyn Law>, energy: f64) -> Contacts {
    let temperature = Some(Temperature::new(energy, 1.0));
    let rules = Rules { temperature, ..Rules::default() };
    Contacts { rules, ..Contacts::new(thresholds, Arc::new(Point::new(0.0).unwrap())) }
}

fn gaussian(energy: f64) -> Contacts {
    contacts(Arc::new(Gaussian::new(1.0, 0.1).unwrap()), energy)
}

/// Creep under a force that is raised within 1e-9.
fn creep(contacts: Contacts, force: f64, duration: f64, tolerance: f64) -> CreepPath {
    let transport = Transport::new_with(contacts, &Initial::default(), tolerance, &mut ()).unwrap();
    let load = CreepLoad { force, rate: force / 1e-9, duration };
    load.follow(&transport, CreepAccuracy { unit: 1.0, tolerance }, &mut ()).unwrap()
}

/// At a temperature far above all barriers contacts break at the rate ω = 1, whatever their stretch, and
/// re-form relaxed: dF/dt = Ẋ − ωF = 0, so that X = f(1 + ωt), and the contacts that were there at first, e^{−ωt} of
/// all, reach their threshold 1 at ωt = 1/f − 1. There they break together, and the slider fails.
#[test]
fn point_thresholds_fail_where_the_first_contacts_reach_them() {
    // The barrier lowers the rate by a fraction of at most 1/(2T) = 5e-7.
    for force in [0.3, 0.5, 0.8] {
        let found = creep(contacts(Arc::new(Point::new(1.0).unwrap()), 1e6), force, 100.0, 1e-5);
        let failure = found.failure_time().unwrap();
        // The tolerance of positions, 1e-5, is one of 1e-5/f in time; the path adds up several steps.
        assert!((failure - (1.0 / force - 1.0)).abs() < 1e-4 / force, "{force}: {failure}");
        for state in &found.states[found.loaded..] {
            let expected = force * (1.0 + state.time);
            assert!((state.position - expected).abs() < 1e-4, "{force}: {state:?}, {expected}");
        }
    }
}

/// The rate at which a contact of stretch x breaks below its threshold h: ω e^{−(h² − x²)/(2T)}, for ω = 1.
fn rate(stretch: f64, threshold: f64, energy: f64) -> f64 {
    if stretch >= threshold {
        f64::INFINITY
    } else {
        (-(threshold.powi(2) - stretch.powi(2)) / (2.0 * energy)).exp()
    }
}

const ENERGY: f64 = 0.03;

/// Contacts that formed at one position: their number for each threshold.
struct Formed {
    at: f64,
    number: Vec<f64>,
}

/// The position at a time, by steps of equal length in which the slider rests, contacts break at their rates, and the slider then
/// advances to where the others carry the force.
fn explicit(force: f64, time: f64, steps: usize) -> f64 {
    let thresholds: Vec<f64> = (0..=120).map(|i| 0.4 + 0.01 * f64::from(i)).collect();
    let weight = |h: &f64| (-0.5 * ((h - 1.0) / 0.1).powi(2)).exp();
    let whole: f64 = thresholds.iter().map(weight).sum();
    let share: Vec<f64> = thresholds.iter().map(|h| weight(h) / whole).collect();
    let mut formed = vec![Formed { at: 0.0, number: share.clone() }];
    let carried = |formed: &[Formed], position: f64| -> f64 {
        let of = |group: &Formed| {
            let stretch = position - group.at;
            let held = thresholds.iter().zip(&group.number).filter(|(h, _)| **h > stretch);
            stretch * held.map(|(_, number)| number).sum::<f64>()
        };
        formed.iter().map(of).sum()
    };
    let mut position = 0.0;
    for step in 0..=steps {
        // The first crossing: far below the highest force at first, and a short way on in a step.
        let (mut low, mut high) = (position, position + if step == 0 { 0.7 } else { 0.05 });
        while high - low > 1e-9 {
            let middle = 0.5 * (low + high);
            if carried(&formed, middle) < force { low = middle } else { high = middle }
        }
        position = high;
        if step == steps {
            break;
        }
        let mut broken = 0.0;
        for group in &mut formed {
            let stretch = position - group.at;
            for (h, number) in thresholds.iter().zip(&mut group.number) {
                let left = *number * (-rate(stretch, *h, ENERGY) * time / steps as f64).exp();
                broken += *number - left;
                *number = left;
            }
        }
        formed.push(Formed { at: position, number: share.iter().map(|part| part * broken).collect() });
    }
    position
}

/// The position at a time of a creep curve, by linear interpolation between its close states.
fn position_at(path: &CreepPath, time: f64) -> f64 {
    let after = path.states.partition_point(|state| state.time < time);
    let (a, b) = (path.states[after - 1], path.states[after]);
    a.position + (b.position - a.position) * (time - a.time) / (b.time - a.time)
}

#[test]
fn creep_follows_an_explicit_integration_of_the_master_equation() {
    let found = position_at(&creep(gaussian(ENERGY), 0.65, 1e3, 1e-5), 60.0);
    let [rough, fine] = [200, 400].map(|steps| explicit(0.65, 60.0, steps));
    // The explicit integration is of first order in its step: Richardson's value is left with an error of second order, and with
    // thresholds that break one by one on a grid of 0.01, with 0.04 of the contacts each at most.
    let extrapolated = 2.0 * fine - rough;
    assert!((found - extrapolated).abs() < 1e-3, "{found} {extrapolated} {fine} {rough}");
    assert!(found > 0.7, "{found}");
}

/// A fixed sequence of pseudorandom numbers in (0, 1) (`SplitMix64`).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + 1e-17
    }

    /// From the distribution of thresholds (Box and Muller).
    fn threshold(&mut self) -> f64 {
        1.0 + 0.1 * (-2.0 * self.next().ln()).sqrt() * (std::f64::consts::TAU * self.next()).cos()
    }
}

/// The position at a time of a slider on contacts that break one by one (Gillespie's method): at a constant force nothing changes
/// between two breaks, and the others advance by the mean of what one has lost.
fn simulated(force: f64, time: f64, size: usize, seed: u64) -> f64 {
    let mut numbers = Numbers(seed);
    let mut contacts: Vec<(f64, f64)> = (0..size).map(|_| (0.0, numbers.threshold())).collect();
    let (mut position, mut now) = (0.0, 0.0);
    let mut missing = force * size as f64;
    loop {
        while missing > 1e-9 * size as f64 {
            // All advance to where the next one breaks, or to balance.
            let room = contacts.iter().map(|(x, h)| h - x).fold(f64::INFINITY, f64::min);
            let by = (missing / size as f64).min(room);
            position += by;
            missing -= by * size as f64;
            for (x, h) in &mut contacts {
                *x += by;
                if *x >= *h - 1e-15 {
                    missing += *x;
                    (*x, *h) = (0.0, numbers.threshold());
                }
            }
        }
        let rates: Vec<f64> = contacts.iter().map(|(x, h)| rate(*x, *h, ENERGY)).collect();
        let all: f64 = rates.iter().sum();
        now -= numbers.next().ln() / all;
        if now > time {
            return position;
        }
        let mut left = numbers.next() * all;
        let breaks = rates.iter().position(|rate| {
            left -= rate;
            left <= 0.0
        });
        let broken = &mut contacts[breaks.unwrap_or(size - 1)];
        missing = broken.0;
        *broken = (0.0, numbers.threshold());
    }
}

#[test]
fn creep_is_that_of_contacts_that_break_one_by_one() {
    const RUNS: usize = 16;
    let found = position_at(&creep(gaussian(ENERGY), 0.65, 1e3, 1e-5), 45.0);
    let positions: Vec<f64> = (0..RUNS as u64).map(|seed| simulated(0.65, 45.0, 4000, seed)).collect();
    let mean = positions.iter().sum::<f64>() / RUNS as f64;
    let variance = positions.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (RUNS - 1) as f64;
    let error = (variance / RUNS as f64).sqrt();
    // A fiftieth of the slip of 0.07, so that the comparison shows something.
    assert!(error < 2e-3, "{error}");
    // Four standard errors.
    assert!((found - mean).abs() < 4.0 * error, "{found} {mean} ± {error}");
}

/// Static fatigue: the time to failure falls with the force about exponentially. Below the forces at which sliding turns unstable the
/// slider does not fail, and slides steadily in the end, at the velocity whose friction is the force.
#[test]
fn failure_comes_exponentially_later_under_smaller_forces_and_not_under_the_smallest() {
    let times =
        [0.5, 0.55, 0.6, 0.65].map(|force| creep(gaussian(ENERGY), force, 1e6, 1e-4).failure_time().unwrap());
    let ratios: Vec<f64> = times.windows(2).map(|pair| (pair[0] / pair[1]).ln()).collect();
    // Activation over (h² − f²)/(2T) is near to exponential, with d ln t/dF from −f/T = −17 to −22 of a contact that carries f and
    // more of those that carry more: over 0.05, ratios from e^{0.8} up, which differ by less than a third.
    assert!(
        ratios.iter().all(|ratio| *ratio > 0.8 && (ratio / ratios[0] - 1.0).abs() < 1.0 / 3.0),
        "{ratios:?}"
    );
    let slow = creep(gaussian(ENERGY), 0.4, 1e5, 1e-4);
    assert_eq!(slow.failure_time(), None);
    let velocity = slow.last().velocity();
    let steady = MasterEquation::at(gaussian(ENERGY), &Initial::default(), velocity).unwrap().steady_state();
    // The tolerance of forces.
    let friction = steady.kinetic_friction();
    assert!((friction - 0.4).abs() < 3e-4, "{velocity} {friction}");
}

/// At a temperature far above all barriers, contacts without thresholds in reach slide at once: F = Ẋ/ω in the end. The steps
/// of 1e9 unit lengths would take years.
#[test]
fn a_slider_that_slides_steadily_does_so_to_the_end_at_no_cost() {
    let hot = contacts(Arc::new(Gaussian::new(1.0, 0.1).unwrap()), 1e6);
    let found = creep(hot, 0.1, 1e10, 1e-3);
    assert_eq!(found.failure_time(), None);
    let last = found.last();
    // Of the contacts of all ages, e^{−h/(Ẋ/ω)} reach a threshold h: Ẋ/ω − F is of the order of e^{−1/F} = 5e-5 of F.
    assert!((last.position / 1e9 - 1.0).abs() < 1e-3, "{last:?}");
    let steady = MasterEquation::at(
        contacts(Arc::new(Gaussian::new(1.0, 0.1).unwrap()), 1e6),
        &Initial::default(),
        last.velocity(),
    );
    let friction = steady.unwrap().steady_state().kinetic_friction();
    // The tolerance, 1e-3, is one of what changes: steady sliding is known far better.
    assert!((friction - 0.1).abs() < 3e-5, "{last:?} {friction}");
}

#[test]
fn the_failure_time_converges_with_the_tolerance_and_does_not_depend_on_fast_loading() {
    let [rough, fine, best] = [1e-4, 1e-5, 3e-6]
        .map(|tolerance| creep(gaussian(ENERGY), 0.65, 1e3, tolerance).failure_time().unwrap());
    // Errors are proportional to the tolerance; a factor of 3 instead of 14 allows for rounding to steps.
    assert!((fine - best).abs() < (rough - best).abs() / 3.0, "{rough} {fine} {best}");
    // 1e-4 of the time to failure at the default tolerance of the task.
    assert!((fine / best - 1.0).abs() < 1e-4, "{fine} {best}");
    let transport = Transport::new_with(gaussian(ENERGY), &Initial::default(), 1e-5, &mut ()).unwrap();
    let load = CreepLoad { force: 0.65, rate: 650.0, duration: 1e3 };
    let slower = load.follow(&transport, CreepAccuracy { unit: 1.0, tolerance: 1e-5 }, &mut ()).unwrap();
    // Loading takes 1e-3, some of which the time to failure is longer.
    let later = slower.failure_time().unwrap() - fine;
    assert!(later.abs() < 0.01, "{later}");
}

/// At failure t(X) is a parabola, so that t_f − t ∝ (X_f − X)², and 1/Ẋ² is proportional to t_f − t.
#[test]
fn the_velocity_diverges_with_the_square_root_of_the_time_to_failure() {
    let found = creep(gaussian(ENERGY), 0.65, 1e3, 1e-5);
    let (failure, end) = (found.failure_time().unwrap(), found.last().position);
    let near = found.states.iter().filter(|state| (0.005..0.03).contains(&(end - state.position)));
    let ratios: Vec<f64> = near.map(|state| state.slowness.powi(2) / (failure - state.time)).collect();
    let (low, high) = ratios.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), r| (a.min(*r), b.max(*r)));
    // The next term of t(X) changes the ratio by a part of the order of (X_f − X)/σ = 0.3; the ratio for 1/Ẋ would change sixfold.
    assert!(ratios.len() > 5 && high / low < 1.5, "{low} {high} {}", ratios.len());
}

#[test]
fn a_force_above_static_friction_fails_in_loading() {
    let found = creep(gaussian(ENERGY), 0.9, 10.0, 1e-5);
    assert!(found.fails_in_loading());
    let pull =
        MasterEquation::new(Contacts { rules: Rules::default(), ..gaussian(ENERGY) }, &Initial::default())
            .unwrap()
            .pull(2.0)
            .unwrap();
    let peak = pull.static_friction().unwrap();
    // The last step is as long as the tolerance; the force is flat at its maximum.
    assert!((found.last().force - peak.value).abs() < 1e-4, "{:?} {peak:?}", found.last());
}

#[test]
fn impossible_loads_are_refused() {
    let transport = Transport::new(gaussian(ENERGY), &Initial::default()).unwrap();
    let accuracy = CreepAccuracy { unit: 1.0, tolerance: 1e-4 };
    for (load, words) in [
        (CreepLoad { force: -0.1, rate: 1.0, duration: 1.0 }, "force: expected a finite force of at least 0"),
        (CreepLoad { force: 0.5, rate: 0.0, duration: 1.0 }, "rate: expected a finite number above 0"),
        (
            CreepLoad { force: 0.5, rate: 1.0, duration: f64::NAN },
            "duration: expected a finite number above 0",
        ),
    ] {
        let reported = load.follow(&transport, accuracy, &mut ()).unwrap_err().to_string();
        assert!(reported.starts_with(words), "{reported}");
    }
    // The drag of free contacts is not followed, and is refused.
    let mut viscous = contacts(Arc::new(Gaussian::new(1.0, 0.1).unwrap()), ENERGY);
    viscous.rules.free_friction.viscosity = 0.1;
    viscous.rules.delay = FreeTime::Fixed(1.0);
    let transport = Transport::new(viscous, &Initial::default()).unwrap();
    let load = CreepLoad { force: 0.5, rate: 1.0, duration: 1.0 };
    let reported = load.follow(&transport, accuracy, &mut ()).unwrap_err().to_string();
    assert!(reported.starts_with("contacts: expected free contacts without viscosity"), "{reported}");
}

/// Slow creep: while the slip is small, the contacts that were there at first carry the force, and each that breaks at x = f is
/// replaced by one at 0, so that X − f = f ∫ P_c(h) (1 − e^{−A}) dh and v = f ∫ P_c(h) r e^{−A} dh, where r is the rate at f and A its
/// integral over time, of a threshold that grows as h (1 + g ln(1 + t)).
#[test]
fn slow_creep_over_short_distances_is_as_accurate_as_its_slip() {
    const FORCE: f64 = 0.2;
    const ENERGY: f64 = 0.02;
    let law = Gaussian::new(0.8, 0.1).unwrap();
    for (growth, duration) in [(0.0, 30.0), (0.05, 1e3)] {
        let ageing = (growth > 0.0).then_some(Ageing::Logarithmic { growth, time: 1.0 });
        let contacts = contacts(Arc::new(law), ENERGY);
        let rules = Rules { ageing, ..contacts.rules.clone() };
        let found = creep(Contacts { rules, ..contacts }, FORCE, duration, 1e-5);
        let loaded = found.states[found.loaded].position;
        for fraction in [0.1, 0.3, 0.5, 0.7, 1.0] {
            let state = found.at_fraction(fraction).unwrap();
            let (slip, velocity) = slow_creep(&law, FORCE, ENERGY, growth, state.time);
            let found = state.position - loaded;
            // Stretches grow by the slip, and rates by f(X − f)/T of themselves, 3e-3 at the end of the first and 1e-3 of the second.
            assert!((found / slip - 1.0).abs() < 2e-3, "{growth}, {state:?}: {found}, {slip}");
            // Velocities are accurate to the square root of the tolerance, 3e-3.
            assert!(
                (state.velocity() / velocity - 1.0).abs() < 6e-3,
                "{growth}, {state:?}: {}, {velocity}",
                state.velocity()
            );
        }
    }
}

/// Slip and velocity of slow creep by quadrature: midpoints in h, which leave 1e-6 of a smooth density at 4000 points, and in ln(1 + t).
fn slow_creep(law: &Gaussian, force: f64, energy: f64, growth: f64, time: f64) -> (f64, f64) {
    const WIDTH: f64 = 2.5e-4;
    const TIMES: usize = 400;
    let (mut slip, mut velocity) = (0.0, 0.0);
    let longest = time.ln_1p();
    for threshold in (0..4800).map(|i| force + (i as f64 + 0.5) * WIDTH) {
        let at = |ln: f64| rate(force, threshold * (1.0 + growth * ln), energy);
        let step = longest / TIMES as f64;
        let integral: f64 =
            (0..TIMES).map(|i| (i as f64 + 0.5) * step).map(|ln| step * ln.exp() * at(ln)).sum();
        let number = WIDTH * force * law.density(threshold);
        slip -= number * (-integral).exp_m1();
        velocity += number * at(longest) * (-integral).exp();
    }
    (slip, velocity)
}
