//! Contacts of an ensemble that move together in time: against those followed one by one, transport, and the block
//! without time.

use crate::common::pulled::near;
use crate::common::ways::kinds;
use crate::common::{contacts, gaussian, initial, point, rectangular};
use asperity::block::{Block, Drive, Loading, Slide, Slip};
use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Rules, Start, Stiffness, Temperature};
use asperity::energy::ContactEnergies;
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::master::{MasterEquation, Transport};
use asperity::rate_dependent::RateDependentContacts;

fn ensemble(contacts: &Contacts, size: usize, seed: u64) -> Ensemble {
    Ensemble::new(contacts.clone(), initial(&point(0.0)), size, seed, Disorder::Annealed).unwrap()
}

fn steady(velocity: f64, distance: f64) -> History {
    History::new(vec![Piece { velocity, duration: distance / velocity }]).unwrap()
}

/// Goes a way in so many steps to a piece, with what is seen after each.
fn go<T>(
    contacts: &mut dyn RateDependentContacts,
    way: &History,
    steps: u32,
    mut see: impl FnMut(&dyn RateDependentContacts) -> T,
) -> Vec<T> {
    let mut seen = Vec::new();
    for piece in way.pieces() {
        let during = piece.duration / f64::from(steps);
        for _ in 0..steps {
            contacts.step(piece.velocity * during, during, &mut ()).unwrap();
            seen.push(see(contacts));
        }
    }
    seen
}

/// Contacts above their thresholds break at once, and the others live on, with and without a temperature.
#[test]
fn a_relaxed_start_is_that_of_contacts_followed_one_by_one() {
    let heated = Rules { temperature: Some(Temperature::new(0.05, 3.0)), ..Rules::default() };
    for rules in [Rules::default(), heated] {
        let contacts = Contacts { rules, ..contacts(&gaussian(1.0, 0.2), &point(0.0)) };
        let initial = Initial { law: rectangular(0.0, 1.5), start: Start::Relaxed };
        let ensemble = Ensemble::new(contacts, initial, 500, 3, Disorder::Annealed).unwrap();
        let way = steady(0.1, 2.0);
        let seen = go(&mut ensemble.in_time().unwrap(), &way, 5, |c| (c.time(), c.force()));
        let mut times: Vec<f64> = seen.iter().map(|seen| seen.0.min(way.duration())).collect();
        *times.last_mut().unwrap() = way.duration();
        let followed = ensemble.follow(&way, &times).unwrap();
        // As above.
        seen.iter().zip(&followed.force).for_each(|(seen, force)| near(seen.1, *force, 1e-8));
    }
}

/// Behind a spring five times stiffer than K_c, 0.6, a break of one of many contacts is no slip of the slider.
#[test]
fn single_breaks_are_no_slips_behind_a_stiff_spring() {
    let rules = Rules { ageing: Some(Ageing::Logarithmic { growth: 0.03, time: 0.5 }), ..Rules::default() };
    let contacts = Contacts { rules, ..contacts(&gaussian(1.0, 0.25), &point(0.0)) };
    let (velocity, size) = (0.1, 3000_usize);
    let drive = steady(velocity, 12.0);
    let times: Vec<f64> = (60..=120).map(f64::from).collect();
    let block = Block::new(Loading::Spring(3.0), Slip::Reset, None).unwrap();
    // A tenth of the scatter of the drive at slips of so many contacts, as tasks have it.
    let tolerance = 0.1 * (size as f64).powf(-2.0 / 3.0);
    let run = block
        .follow_with(&ensemble(&contacts, size, 5).in_time().unwrap(), &drive, &times, tolerance, &mut ())
        .unwrap();
    let mean = run.trace.iter().map(|moment| moment.force).sum::<f64>() / run.trace.len() as f64;
    let equation = MasterEquation::at(contacts, &initial(&point(0.0)), velocity).unwrap();
    // Stretches scatter by 0.3, and the mean is over some eight lives: 0.3/√(3000 · 8) = 0.002, four times.
    assert!((mean - equation.steady_state().kinetic_friction()).abs() < 0.008, "{mean}");
}

#[test]
fn they_live_the_lives_of_those_followed_one_by_one() {
    for kind in kinds().iter().filter(|kind| kind.name != "smoluchowski") {
        for (name, way) in kind.ways() {
            let ensemble = ensemble(&kind.contacts, 500, 3);
            let seen = go(&mut ensemble.in_time().unwrap(), &way, 7, |c| (c.time(), c.force(), c.free()));
            let mut times: Vec<f64> = seen.iter().map(|seen| seen.0.min(way.duration())).collect();
            *times.last_mut().unwrap() = way.duration();
            let followed = ensemble.follow(&way, &times).unwrap();
            for (i, &(time, force, free)) in seen.iter().enumerate() {
                // Rounding of times, which heat makes the more of the longer a way takes.
                near(force, followed.force[i], 1e-8);
                near(free, followed.free[i], 1e-12);
                assert!((time - times[i]).abs() < 1e-9 * time, "{} {name}", kind.name);
            }
        }
    }
}

#[test]
fn contacts_of_other_numbers_are_the_others_of_a_larger_ensemble() {
    let contacts = Contacts { rules: warm(), ..contacts(&gaussian(1.0, 0.1), &point(0.0)) };
    let way = steady(1e-2, 2.5);
    let force = |ensemble: Ensemble| {
        let together = go(&mut ensemble.in_time().unwrap(), &way, 1, |c| c.force())[0];
        near(ensemble.follow(&way, &[way.duration()]).unwrap().force[0], together, 1e-12);
        together
    };
    let all = force(ensemble(&contacts, 300, 5));
    let first = force(ensemble(&contacts, 100, 5));
    let rest = force(ensemble(&contacts, 200, 5).numbered_from(100));
    near(all, (first + 2.0 * rest) / 3.0, 1e-12);
}

fn warm() -> Rules {
    let temperature = Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.05, 1.0) };
    Rules { temperature: Some(temperature), ..Rules::default() }
}

/// Contacts of which everything hangs on everything: k = κ x_s, heat, and thresholds that change with age.
fn involved(ageing: Ageing) -> Contacts {
    let rules = Rules { ageing: Some(ageing), delay: 0.5.into(), ..warm() };
    let stiffness = Stiffness::PerThreshold(1.0);
    Contacts { rules, stiffness, ..contacts(&gaussian(1.0, 0.2), &point(0.0)) }
}

fn strengthening() -> Ageing {
    Ageing::Logarithmic { growth: 0.05, time: 1.0 }
}

fn diffusing() -> Ageing {
    Ageing::Smoluchowski { mature: gaussian(1.3, 0.2), diffusion: 0.04 }
}

#[test]
fn the_work_is_found_again() {
    for ageing in [strengthening(), diffusing()] {
        let (velocity, distance, steps) = (0.1, 3.0, 20_000);
        let mut contacts = ensemble(&involved(ageing), 50, 2).in_time().unwrap();
        let forces = go(&mut contacts, &steady(velocity, distance), steps, |c| c.force());
        let by = distance / f64::from(steps);
        let work = by * (forces.iter().sum::<f64>() - 0.5 * forces[forces.len() - 1]);
        let ContactEnergies { elastic, lost, strengthening, .. } = contacts.energies();
        // A break within a step changes the work by half the step times the force of a contact at most, the contacts breaking
        // three or four times.
        near(work, elastic + lost - strengthening, 2.0 * by);
        assert!(strengthening.abs() > 0.01 && lost > 1.0, "{strengthening} {lost}");
    }
}

/// Mean and standard error.
fn mean(values: &[f64]) -> (f64, f64) {
    let size = values.len() as f64;
    let mean = values.iter().sum::<f64>() / size;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (size - 1.0);
    (mean, (variance / size).sqrt())
}

#[test]
fn energies_are_those_of_transport() {
    let way = History::new(vec![
        Piece { velocity: 0.1, duration: 15.0 },
        Piece { velocity: 0.0, duration: 20.0 },
        Piece { velocity: 1.0, duration: 1.0 },
    ]);
    let way = way.unwrap();
    for ageing in [strengthening(), diffusing()] {
        let contacts = involved(ageing);
        let transport = Transport::new_with(contacts.clone(), &initial(&point(0.0)), 1e-4, &mut ()).unwrap();
        let mut transport = transport.copy();
        go(transport.as_mut(), &way, 1, |_| ());
        let exact = transport.energies();
        let drawn: Vec<ContactEnergies> = (0..25)
            .map(|batch| {
                let ensemble = ensemble(&contacts, 400, 1).numbered_from(400 * batch);
                let mut ensemble = ensemble.in_time().unwrap();
                go(&mut ensemble, &way, 1, |_| ());
                ensemble.energies()
            })
            .collect();
        for (name, part) in [
            ("elastic", (|b| b.elastic) as fn(&ContactEnergies) -> f64),
            ("lost", |b| b.lost),
            ("strengthening", |b| b.strengthening),
            ("broken", |b| b.broken),
        ] {
            let (drawn, error) = mean(&drawn.iter().map(part).collect::<Vec<_>>());
            let off = drawn - part(&exact);
            // Four standard errors, beside which the tolerance of transport does not show.
            assert!(off.abs() < 4.0 * error, "{name}: {drawn}, not {}: {error}", part(&exact));
        }
    }
}

fn slide(
    contacts: &dyn RateDependentContacts,
    (stiffness, slip): (f64, Slip),
    drive: &History,
    tolerance: f64,
) -> Slide {
    let block = Block::new(Loading::Spring(stiffness), slip, Some(0.05)).unwrap();
    block.follow_with(contacts, drive, &[], tolerance, &mut ()).unwrap()
}

#[test]
fn slow_and_little_damped_it_is_the_block_without_time_over_the_same_contacts() {
    let contacts = contacts(&gaussian(1.0, 0.1), &point(0.0));
    let ensemble = ensemble(&contacts, 300, 4);
    let block = Block::new(Loading::Spring(1.0), Slip::Overdamped, Some(0.05)).unwrap();
    let drive = Drive { turning_points: vec![3.0], points: 2 };
    let athermal = block.pull(&mut ensemble.population().unwrap(), &drive).unwrap();
    let damped = Slip::Damped { damping: 1e-3 };
    let run = slide(&ensemble.in_time().unwrap(), (1.0, damped), &steady(1e-5, 3.0), 1e-4);
    assert_eq!((run.slips.len(), athermal.events.len()), (2, 2));
    // The slider lingers where balance is lost for some (γv)^{2/3}.
    let lingering = 1e-8_f64.powf(2.0 / 3.0);
    for (slip, event) in run.slips.iter().zip(&athermal.events) {
        near(slip.before.drive, event.before.drive, lingering);
        near(slip.before.force, event.before.force, lingering);
        near(slip.after.position, event.after.position, lingering);
        near(slip.energy.breaks, event.energy.breaks, lingering);
        // Where the slider is fast: a step is right to the tolerance.
        near(slip.energy.dissipated(), event.energy.dissipated(), 1e-4);
    }
    // Steps are longer than from break to break, which the trapezoidal rule feels as the tolerance.
    near(run.energy.imbalance(), 0.0, 3.0 * 1e-4);
}

#[test]
fn a_block_slips_as_over_transport() {
    let rules = Rules { ageing: Some(strengthening()), ..Rules::default() };
    let contacts = Contacts { rules, ..contacts(&gaussian(1.0, 0.2), &point(0.0)) };
    let (block, drive) = ((0.3, Slip::Damped { damping: 0.1 }), steady(1e-2, 4.8));
    let transport = Transport::new_with(contacts.clone(), &initial(&point(0.0)), 1e-5, &mut ()).unwrap();
    let exact = slide(&transport, block, &drive, 1e-4).slips[0];
    let size = 500;
    let slips: Vec<_> = (0..8)
        .map(|batch| {
            let ensemble = ensemble(&contacts, size, 4).numbered_from(batch * size as u64);
            slide(&ensemble.in_time().unwrap(), block, &drive, 1e-3).slips[0]
        })
        .collect();
    let drives = mean(&slips.iter().map(|slip| slip.before.drive).collect::<Vec<_>>());
    let drops = mean(&slips.iter().map(|slip| slip.drop()).collect::<Vec<_>>());
    // Scatter and bias of a finite ensemble: N^{-2/3} of the drive, the same bias of the force.
    let bias = (size as f64).powf(-2.0 / 3.0);
    near(drives.0, exact.before.drive, 4.0 * drives.1 + bias);
    near(drops.0, exact.drop(), 4.0 * drops.1 + bias);
}

#[test]
fn ways_that_are_none_are_refused() {
    let mut contacts = ensemble(&involved(strengthening()), 10, 1).in_time().unwrap();
    assert!(contacts.step(-0.1, 1.0, &mut ()).is_err() && contacts.step(0.1, 0.0, &mut ()).is_err());
}
