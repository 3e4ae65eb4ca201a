//! The block over ensembles: the master equation in the mean, and how a finite number of contacts scatters about it.

use crate::common::pulled::{UNDAMPED, near, pull};
use crate::common::{contacts, gaussian, initial, master, point, rectangular};
use asperity::block::{Block, Drive, Event, Loading, Regime, Sizes, Slip, StickSlip};
use asperity::ensemble::{Disorder, Ensemble, EnsemblePopulation};
use asperity::exact::Gaussian;
use asperity::law::SharedLaw;
use asperity::population::Population;

const STD: f64 = 0.1;
const STIFFNESS: f64 = 1.0;

/// A share that no avalanche before a slip reaches, and every slip passes.
const FRACTION: f64 = 0.3;

const DAMPED: Slip = Slip::Inertial { mass: 1.0, damping: 0.5 };
const RULES: [Slip; 5] = [Slip::Reset, Slip::Overdamped, UNDAMPED, DAMPED, Slip::Arrest];

/// Relaxed contacts that re-form by a law.
fn reforming_by(reforming: &SharedLaw, size: usize, seed: u64) -> Ensemble {
    let contacts = contacts(&gaussian(1.0, STD), reforming);
    Ensemble::new(contacts, initial(&point(0.0)), size, seed, Disorder::Annealed).unwrap()
}

fn model(size: usize, seed: u64) -> Ensemble {
    reforming_by(&point(0.0), size, seed)
}

fn ensemble(size: usize, seed: u64) -> EnsemblePopulation {
    model(size, seed).population().unwrap()
}

fn drive(population: &mut dyn Population, slip: Slip, distance: f64) -> StickSlip {
    let block = Block::new(Loading::Spring(STIFFNESS), slip, Some(FRACTION)).unwrap();
    let drive = Drive { turning_points: vec![distance], points: 11 };
    block.pull(population, &drive).unwrap()
}

/// The first slips of ensembles with different seeds.
fn first_slips(reforming: &SharedLaw, size: usize, runs: u64, slip: Slip) -> Vec<Event> {
    let first = |seed| {
        let mut population = reforming_by(reforming, size, seed).population().unwrap();
        drive(&mut population, slip, 2.0).events[0]
    };
    (0..runs).map(first).collect()
}

/// The first slip of the master equation.
fn first_slip(reforming: &SharedLaw, slip: Slip) -> Event {
    let mut population =
        master(&gaussian(1.0, STD), reforming, &point(0.0)).population_with(1e-10, &mut ()).unwrap();
    pull(&mut population, STIFFNESS, slip, &[2.0]).events[0]
}

fn moments(events: &[Event], value: impl Fn(&Event) -> f64) -> (f64, f64) {
    statistics(events.iter().map(value).collect())
}

/// Mean and standard deviation.
fn statistics(values: Vec<f64>) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64;
    (mean, variance.sqrt())
}

/// Where a quantity is compared, and how fast its bias falls: as the place where balance is lost, N^{−1/3}, or as the
/// drive there, N^{−2/3}, one power of N^{−1/3} more as the drive has its maximum there.
type Compared = (&'static str, fn(&Event) -> f64, i32);

const START: [Compared; 3] = [
    ("drive", |e| e.before.drive, 2),
    // With inertia a slip begins before the last balance: a swing carries the slider over what is left of a barrier.
    ("position before", |e| e.before.position, 1),
    ("force before", |e| e.before.force, 1),
];

/// What follows from the drive alone …
const END: [Compared; 3] = [
    ("position after", |e| e.after.position, 2),
    ("position of the turn", |e| e.position_turn, 2),
    ("lost by the slider", |e| e.energy.slip + e.energy.viscous, 2),
];

/// … and, where contacts stay free from the beginning of the slip, from the place of that.
const ARRESTED: [Compared; 2] =
    [("position after", |e| e.after.position, 1), ("lost by the slider", |e| e.energy.slip, 1)];

#[test]
fn first_slips_are_those_of_the_master_equation_in_the_mean() {
    // Where contacts re-form stretched, balance is lost later than it would be if all that broke stayed free.
    let stretched = rectangular(0.0, 0.6);
    for (reforming, slip) in
        RULES.map(|slip| (point(0.0), slip)).into_iter().chain([(stretched, Slip::Arrest)])
    {
        let exact = first_slip(&reforming, slip);
        let ends: &[Compared] = match slip {
            Slip::Reset => &[],
            Slip::Arrest => &ARRESTED,
            _ => &END,
        };
        for size in [1_000, 30_000] {
            let events = first_slips(&reforming, size, 32, slip);
            for (name, value, power) in START.iter().chain(ends) {
                let (mean, std) = moments(&events, value);
                // A bias of some tenths of N^{−1/3}, or of about one N^{−2/3} (next test).
                let bias = [0.15, 1.0][*power as usize - 1] / (size as f64).cbrt().powi(*power);
                let (off, allowed) = (mean - value(&exact), 4.0 * std / 32.0_f64.sqrt() + bias);
                assert!(off.abs() < allowed, "{slip:?}, {size} contacts, {name}: {off:e}, not {allowed:e}");
            }
        }
    }
}

/// X_T(X) of the contacts of an ensemble that have gone forward alone.
fn drive_at(position: f64, size: usize, seed: u64) -> f64 {
    let pull = model(size, seed).pull(&[position]).unwrap();
    position + pull.force[0] / STIFFNESS
}

/// Balance is lost where X + F/K, which near X_1 is a parabola and the Brownian motion of the breaks, has its
/// maximum. Of W(t) − t² the place of the maximum has variance 0.26355964 (P. Groeneboom and J. A. Wellner, J. Comput.
/// Graph. Stat. 10, 388 (2001)), the maximum itself three times that as its mean: of W(t) − γt² it scales as γ^{−1/3},
/// and its derivative by γ is −t². (That of W(t) − t²/2 is 0.99619 by S. Janson, G. Louchard and A. Martin-Löf,
/// Electron. J. Probab. 15, 1893 (2010).) The force at X_1 as a whole scatters as a sum of N independent stretches.
#[test]
fn scatter_and_bias_of_the_first_slip_are_those_of_brownian_motion_on_a_parabola() {
    const VARIANCE: f64 = 0.263_559_64;
    let exact = first_slip(&point(0.0), Slip::Overdamped);
    let x = exact.before.position;
    // First breaks only: F' = S − X P_c, F'' = −2 P_c − X P_c', and N Var(F) grows by X² P_c dX.
    let z = (x - 1.0) / STD;
    let density = (-0.5 * z * z).exp() / (STD * (2.0 * std::f64::consts::PI).sqrt());
    let curvature = (2.0 * density - x * z / STD * density) / STIFFNESS;
    let noise = x * density.sqrt() / STIFFNESS;
    let scale = (2.0 * noise / curvature).powf(2.0 / 3.0);
    let whole = Gaussian::new(1.0, STD).variance(x).sqrt() / STIFFNESS;
    for (size, runs) in [(1_000, 512), (10_000, 256)] {
        let events = first_slips(&point(0.0), size, runs, Slip::Overdamped);
        let (n, root) = (size as f64, (runs as f64).sqrt());
        // The parabola is one up to a share of its width, σN^{−1/3}.
        let crude = 1.0 / n.cbrt();
        let (_, scatter) = moments(&events, |e| e.before.position);
        near(scatter * n.cbrt() / (scale * VARIANCE.sqrt()), 1.0, 4.0 / (2.0_f64.sqrt() * root) + crude);
        let (_, scatter) = moments(&events, |e| e.before.drive);
        near(scatter * n.sqrt() / whole, 1.0, 4.0 / (2.0_f64.sqrt() * root) + crude);
        // Above what the same contacts do at X_1, where the mean is that of the master equation.
        let above = |(seed, e): (u64, &Event)| e.before.drive - drive_at(x, size, seed);
        let (mean, scatter) = statistics((0..).zip(&events).map(above).collect());
        let bias = noise * scale.sqrt() * 3.0 * VARIANCE * n.powf(-2.0 / 3.0);
        near(mean, bias, 4.0 * scatter / root + crude * bias);
    }
}

#[test]
fn energies_and_sizes_count_every_break() {
    for slip in RULES {
        let mut population = ensemble(10_000, 3);
        let run = drive(&mut population, slip, 8.0);
        for event in &run.events {
            // Sums over 1e4 contacts and some 1e5 breaks, each rounded to 1e-16 of sums of order 1.
            near(event.energy.imbalance(), 0.0, 1e-9);
            near(event.approach.imbalance(), 0.0, 1e-9);
        }
        near(run.energy.imbalance(), 0.0, 1e-9);
        let counted: f64 = run.sizes.bins.iter().map(|bin| bin.broken).sum();
        near(counted, population.energies().broken, 1e-9);
        assert!(run.sizes.events() > 1_000);
        // What is kept does not grow with the breaks.
        assert!(run.trace.len() <= 11 + 2 * run.events.len());
    }
}

#[test]
fn a_reset_counts_every_contact_once() {
    let run = drive(&mut ensemble(10_000, 3), Slip::Reset, 8.0);
    assert!(run.events.len() > 2 && run.events.iter().all(|event| event.broken_fraction == 1.0));
    let largest =
        run.sizes.bins.iter().enumerate().rfind(|(i, bin)| bin.events > 0 && Sizes::middle(*i) < 0.9);
    assert!(Sizes::middle(largest.unwrap().0) < FRACTION);
}

/// More than the slip fraction break at once, before the slider has moved: a single contact, and identical ones. At the threshold 1
/// the force 1 of all falls to 0, and the slider follows the spring, of stiffness 1, to X = X_T = 2.
#[test]
fn simultaneous_breaks_are_a_reset_where_they_are_enough() {
    for (size, law) in [(1, gaussian(1.0, STD)), (1, point(1.0)), (100, point(1.0))] {
        let contacts = contacts(&law, &point(0.0));
        let of = Ensemble::new(contacts, initial(&point(0.0)), size, 3, Disorder::Annealed).unwrap();
        let found = drive(&mut of.population().unwrap(), Slip::Reset, 4.0);
        let first = found.events[0];
        // The slider moves by the threshold, with the spring as far behind.
        let threshold = first.before.position;
        near(first.after.force, 0.0, 1e-12);
        near(first.after.position, 2.0 * threshold, 1e-12);
        assert!((threshold - 1.0).abs() < 4.0 * STD && (size == 1 || threshold == 1.0), "{threshold}");
        near(first.broken_fraction, 1.0, 0.0);
    }
}

#[test]
fn resets_go_on_with_the_period_of_the_master_equation() {
    let run = drive(&mut ensemble(10_000, 5), Slip::Reset, 100.0);
    let Regime::Persistent { period, drop, scatter, .. } = run.regime else { panic!("{}", run.regime) };
    let count = run.events.len() as f64;
    // Bias of the first slips; each drop scatters as the force before, some 0.12 N^{−1/3}.
    near(period, 1.666_198_355, 4.0 * scatter * period / (0.5 * count).sqrt() + 1e4_f64.powf(-2.0 / 3.0));
    near(drop, 0.773_610_551, 0.12 / 1e4_f64.cbrt() + 1e4_f64.powf(-2.0 / 3.0));
    assert!(scatter > 0.0 && scatter < 0.01, "{scatter}");
}
