//! Contacts followed through time at low temperatures: against the renewal equation, and against closed forms of holds.

use std::sync::Arc;

use crate::common::point;
use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Rules, Start, Temperature};
use asperity::history::{History, Piece};
use asperity::law::{Exponential, Gaussian, Lognormal, Rectangular, SharedLaw, Weibull};
use asperity::master::{MasterEquation, Trace, Transport};

/// ω.
const RATE: f64 = 1.0;

fn gaussian() -> SharedLaw {
    Arc::new(Gaussian::new(1.0, 0.05).unwrap())
}

fn exponential() -> SharedLaw {
    Arc::new(Exponential::new(1.0).unwrap())
}

fn lognormal() -> SharedLaw {
    Arc::new(Lognormal::new(1.0, 1.0).unwrap())
}

fn rectangular() -> SharedLaw {
    Arc::new(Rectangular::new(0.5, 1.5).unwrap())
}

fn contacts(thresholds: SharedLaw, barrier: Barrier, energy: f64) -> Contacts {
    let temperature = Some(Temperature { barrier, ..Temperature::new(energy, RATE) });
    let rules = Rules { temperature, ..Rules::default() };
    Contacts { rules, ..Contacts::new(thresholds, point(0.0)) }
}

fn relaxed() -> Initial {
    Initial { law: point(0.0), start: Start::Conditional }
}

/// The slider pulled over a distance at one velocity.
fn pull(contacts: &Contacts, velocity: f64, distance: f64, tolerance: f64) -> Trace {
    let duration = distance / velocity;
    let history = History::new(vec![Piece { velocity, duration }]).unwrap();
    let times: Vec<f64> = (1..=37).map(|k| f64::from(k) / 37.0 * duration).collect();
    let mut transport = Transport::new_with(contacts.clone(), &relaxed(), tolerance, &mut ()).unwrap();
    transport.follow(&history, &times).unwrap()
}

#[test]
fn at_one_velocity_the_renewal_equation_is_reproduced_however_cold_it_is() {
    use Barrier::{Bell, Catastrophe, Elastic};
    let tolerance = 1e-5;
    // Times that the renewal equation needs grow as 1/T.
    for (name, law, barrier, energy) in [
        ("gaussian", gaussian(), Elastic, 1e-2),
        ("gaussian", gaussian(), Elastic, 1e-4),
        ("gaussian", gaussian(), Bell, 1e-3),
        ("gaussian", gaussian(), Catastrophe, 1e-4),
        ("exponential", exponential(), Elastic, 1e-5),
        ("lognormal", lognormal(), Bell, 1e-4),
        ("rectangular", rectangular(), Elastic, 1e-3),
        ("point", point(1.0), Elastic, 1e-3),
        ("point", point(1.0), Catastrophe, 1e-4),
    ] {
        let contacts = contacts(law, barrier, energy);
        // In which ½x² grows by T, there are 10⁴ times 1/ω.
        let velocity = 1e-4 * energy;
        let trace = pull(&contacts, velocity, 1.4, tolerance);
        let equation = MasterEquation::at(contacts, &relaxed(), velocity).unwrap();
        let exact = equation.pull_with(1.4, 1e-8, &mut ()).unwrap();
        let off = trace.position.iter().zip(&trace.force).map(|(&x, force)| (force - exact.force(x)).abs());
        let off = off.fold(0.0, f64::max);
        // The tolerance, in units of the mean threshold; the renewal equation has its own.
        assert!(off < tolerance + 1e-8, "{name} {barrier:?} {energy:e}: {off:e}");
    }
}

/// ∫_x^∞ P e^{−A} dh, A = ω t e^{−(h² − x₀²)/2T}: contacts held at x₀ for the time t, then stretched on to x at once.
fn left(law: &SharedLaw, energy: f64, (held, time): (f64, f64), stretch: f64) -> f64 {
    /// Higher barriers, in T, hold all contacts; Simpson's rule is right to 1e-12 in so many parts.
    const FOLDS: f64 = 60.0;
    const PARTS: u32 = 6000;
    let threshold = |folds: f64| (held * held + 2.0 * energy * folds).sqrt();
    let first = ((stretch * stretch - held * held) / (2.0 * energy)).max(0.0);
    if first >= FOLDS {
        return law.survival(stretch);
    }
    let value = |folds: f64| {
        let h = threshold(folds);
        law.density(h) * (-time * RATE * (-folds).exp()).exp() * energy / h
    };
    let width = (FOLDS - first) / f64::from(PARTS);
    let sum: f64 = (0..PARTS)
        .map(|k| {
            let low = first + f64::from(k) * width;
            value(low) + 4.0 * value(low + 0.5 * width) + value(low + width)
        })
        .sum();
    sum * width / 6.0 + law.survival(threshold(FOLDS))
}

#[test]
fn a_hold_and_what_follows_it_are_those_of_the_elastic_barrier() {
    for law in [gaussian(), exponential(), rectangular()] {
        for energy in [1e-2, 1e-3, 1e-6, 4e-9] {
            // The tolerances of the solution, of which the bounds below are parts.
            let tolerance = if energy < 1e-8 { 1e-7 } else { 1e-6 };
            let (held, time) = (0.95, 1e4);
            let cold = contacts(law.clone(), Barrier::Elastic, energy);
            // What breaks stays free; on the way to the hold and from it nothing breaks by temperature.
            let rules = Rules { delay: 1e6.into(), ..cold.rules };
            let fast = 1e9;
            let further = [0.02, 0.1, 0.4];
            let piece = |velocity: f64, distance: f64| Piece { velocity, duration: distance / velocity };
            let mut pieces = vec![piece(fast, held), Piece { velocity: 0.0, duration: time }];
            let mut stretches = vec![held, held];
            for by in further {
                pieces.push(piece(fast, by));
                stretches.push(stretches[stretches.len() - 1] + by);
            }
            let mut transport =
                Transport::new_with(Contacts { rules, ..cold }, &relaxed(), tolerance, &mut ()).unwrap();
            for (i, piece) in pieces.into_iter().enumerate() {
                let history = History::new(vec![piece]).unwrap();
                transport.follow(&history, &[]).unwrap();
                let stretch = stretches[i];
                let exact =
                    if i == 0 { law.survival(stretch) } else { left(&law, energy, (held, time), stretch) };
                let off = (transport.force() - stretch * exact).abs();
                // One cohort is exact but for the sums over thresholds, of sixteen points on six e-folds, to a tenth of the
                // tolerance of those in them, a tenth of all, and here by Simpson's rule; and for what a part of a step adds
                // below 1e-4 tolerances in all.
                assert!(off < 1e-2 * tolerance, "{} {energy:e} {i}: {off:e}", law.name());
            }
        }
    }
}

#[test]
fn so_cold_that_temperature_moves_nothing_contacts_are_athermal() {
    let tolerance = 1e-7;
    for barrier in [Barrier::Elastic, Barrier::Bell] {
        let cold = contacts(gaussian(), barrier, 4e-9);
        let athermal = Contacts { rules: Rules::default(), ..cold.clone() };
        let [cold, athermal] = [cold, athermal].map(|contacts| pull(&contacts, 1e-6, 1.4, tolerance).force);
        let off =
            cold.iter().zip(&athermal).map(|(cold, athermal)| (cold - athermal).abs()).fold(0.0, f64::max);
        // While the barrier is below T, the slider moves by no more than 8e-9, in 8e-3/ω: contacts break earlier by less than
        // that. They break twice, where slopes are up to 7; both are right to the tolerance.
        assert!(off < 2.0 * 7.0 * 8e-9 + 2.0 * tolerance, "{barrier:?}: {off:e}");
    }
}

/// Weak thresholds that age rank by rank come below 0, where they are 0: under them no barrier is left.
#[test]
fn thresholds_of_nothing_are_met_at_once() {
    let mature = Arc::new(Gaussian::new(1.5, 0.2).unwrap());
    let ageing = Some(Ageing::FrozenRank { mature, time: 1.0 });
    let cold = contacts(Arc::new(Weibull::new(8.3, 1.0).unwrap()), Barrier::Elastic, 1e-6);
    let rules = Rules { ageing, ..cold.rules.clone() };
    let athermal = Rules { temperature: None, ..rules.clone() };
    let tolerance = 1e-4;
    let [warm, cold] = [rules, athermal].map(|rules| {
        let contacts = Contacts { rules, ..cold.clone() };
        let slow = Piece { velocity: 1e-12, duration: 1e-2 };
        let history = History::new(vec![slow, Piece { velocity: 0.1, duration: 5.0 }]).unwrap();
        let times: Vec<f64> = (0..=20).map(|k| 0.25 * f64::from(k)).collect();
        let mut transport = Transport::new_with(contacts, &relaxed(), tolerance, &mut ()).unwrap();
        transport.follow(&history, &times).unwrap().force
    });
    for (warm, cold) in warm.iter().zip(&cold) {
        // Temperature moves breaks by about 1e-6, where the density of thresholds is up to 3.
        assert!((warm - cold).abs() < 2.0 * tolerance + 1e-5, "{warm} {cold}");
    }
}
