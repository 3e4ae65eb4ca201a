//! A block driven event by event: the run is that of a pull, whatever is looked at, kept or stopped on the way.

use crate::common::pulled::{UNDAMPED, near};
use crate::common::sliders::Impatient;
use crate::common::{contacts, gaussian, initial, master, point, rectangular};
use asperity::Error;
use asperity::block::{Block, BlockSimulation, Drive, Event, Loading, SimulationState, Slip};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::law::SharedLaw;
use asperity::population::Population;

const RULES: [Slip; 4] = [Slip::Reset, Slip::Overdamped, UNDAMPED, Slip::Arrest];

fn laws() -> [SharedLaw; 2] {
    [gaussian(1.0, 0.1), rectangular(0.0, 0.2)]
}

fn ensemble(size: usize) -> Ensemble {
    let [thresholds, reforming] = laws();
    Ensemble::new(contacts(&thresholds, &reforming), initial(&point(0.0)), size, 5, Disorder::Annealed)
        .unwrap()
}

/// Contacts that follow the master equation, and some that are followed one by one.
fn populations() -> [Box<dyn Population>; 2] {
    let [thresholds, reforming] = laws();
    let solved = master(&thresholds, &reforming, &point(0.0)).population_with(1e-10, &mut ()).unwrap();
    [Box::new(solved), Box::new(ensemble(2000).population().unwrap())]
}

fn block(loading: Loading, slip: Slip) -> Block {
    Block::new(loading, slip, Some(0.05)).unwrap()
}

fn soft(slip: Slip) -> Block {
    block(Loading::Spring(0.5), slip)
}

fn events(slider: &mut BlockSimulation, until: f64) -> Vec<Event> {
    let mut found = Vec::new();
    slider.run(until, &mut |event| found.push(*event)).unwrap();
    found
}

/// As bytes and back.
fn kept(slider: &BlockSimulation) -> SimulationState {
    let mut bytes = Vec::new();
    ciborium::into_writer(&slider.state(), &mut bytes).unwrap();
    ciborium::from_reader(bytes.as_slice()).unwrap()
}

#[test]
fn events_are_those_of_a_pull() {
    for slip in RULES {
        for (population, mut pulled) in populations().into_iter().zip(populations()) {
            let drive = Drive { turning_points: vec![4.0, 1.0, 5.0], points: 11 };
            let whole = soft(slip).pull(pulled.as_mut(), &drive).unwrap();
            let mut slider = soft(slip).simulation(population).unwrap();
            let found: Vec<_> =
                drive.turning_points.iter().flat_map(|&turn| events(&mut slider, turn)).collect();
            assert!(found.len() > 1, "{slip:?}");
            assert_eq!(found, whole.events, "{slip:?}");
            assert_eq!(slider.energy().unwrap(), whole.energy, "{slip:?}");
            assert_eq!(slider.point(), *whole.trace.last().unwrap());
        }
    }
}

#[test]
fn stops_leave_no_trace() {
    for slip in RULES {
        for (population, stopped) in populations().into_iter().zip(populations()) {
            let mut whole = soft(slip).simulation(population).unwrap();
            let all = events(&mut whole, 4.0);
            let mut slider = soft(slip).simulation(stopped).unwrap();
            let mut found = Vec::new();
            for stop in 1..=100 {
                let stop = 0.04 * f64::from(stop);
                found.extend(events(&mut slider, stop));
                assert_eq!(slider.drive(), stop);
                let (energy, here) = (slider.energy().unwrap(), slider.point());
                // Some thousand breaks, summed; positions are found to rounding.
                near(energy.imbalance(), 0.0, 1e-9);
                near(here.spring_force, here.force, 1e-9);
            }
            assert_eq!(found, all);
            assert_eq!((slider.point(), slider.energy().unwrap()), (whole.point(), whole.energy().unwrap()));
            assert_eq!(slider.state(), whole.state());
        }
    }
}

#[test]
fn a_slider_goes_on_from_its_state_bit_for_bit() {
    for slip in RULES {
        for (population, copy) in populations().into_iter().zip(populations()) {
            let mut whole = soft(slip).simulation(population).unwrap();
            let mut other = soft(slip).simulation(copy).unwrap();
            for (on, then) in [(1.3, 3.0), (3.4, 2.0), (1.0, 3.9)] {
                events(&mut whole, on);
                let state = kept(&whole);
                assert_eq!(state, whole.state());
                other.restore(state, &mut ()).unwrap();
                assert_eq!(events(&mut other, then), events(&mut whole, then), "{slip:?} to {then}");
                assert_eq!(other.point(), whole.point());
                assert_eq!(other.energy().unwrap(), whole.energy().unwrap());
            }
        }
    }
}

#[test]
fn an_interruption_leaves_no_trace() {
    for slip in RULES {
        for (population, stopped) in populations().into_iter().zip(populations()) {
            let mut whole = soft(slip).simulation(population).unwrap();
            let all = [4.0, 2.0].map(|until| events(&mut whole, until));
            let mut slider = soft(slip).simulation(stopped).unwrap();
            let (mut found, mut stops) = ([Vec::new(), Vec::new()], 0);
            for (until, found) in [4.0, 2.0].into_iter().zip(&mut found) {
                loop {
                    let before = slider.point();
                    match slider.next_event_with(until, &mut Impatient(1 + stops)) {
                        Ok(Some(event)) => found.push(event),
                        Ok(None) => break,
                        Err(Error::Stopped) => {
                            stops += 1;
                            assert_eq!(slider.point(), before);
                        }
                        Err(error) => panic!("{error}"),
                    }
                }
            }
            assert!(stops > 0);
            assert_eq!(found, all);
            assert_eq!(slider.state(), whole.state());
        }
    }
}

#[test]
fn events_of_a_rigid_slider_are_breaks() {
    let rigid = Block::new(Loading::Rigid, Slip::Overdamped, None).unwrap();
    let ensemble = ensemble(300);
    let at: Vec<f64> = (0..=20).map(|i| 0.15 * f64::from(i)).collect();
    let pull = ensemble.pull(&at).unwrap();
    let mut slider = rigid.simulation(Box::new(ensemble.population().unwrap())).unwrap();
    let mut broken = 0.0;
    for (&position, force) in at.iter().zip(&pull.force) {
        broken += events(&mut slider, position).iter().map(|event| event.broken_fraction).sum::<f64>();
        let point = slider.point();
        assert_eq!((point.drive, point.position), (position, position));
        near(point.force, *force, 1e-12);
        let stretches = slider.stretches().unwrap().unwrap();
        near(stretches.iter().sum::<f64>() / 300.0, *force, 1e-12);
    }
    // The number of breaks is whole, its mean per contact is rounded.
    near(broken * 300.0, pull.breaks as f64, 1e-9);
}

#[test]
fn stretches_add_up_to_the_contacts_and_carry_the_force() {
    for slip in RULES {
        let [population, _] = populations();
        let mut slider = soft(slip).simulation(population).unwrap();
        for until in [0.7, 2.1, 3.3, 2.6, 1.5] {
            slider.run(until, &mut |_| ()).unwrap();
            let (number, width) = (40_000, 1e-4);
            let stretches: Vec<f64> = (0..number).map(|i| width * (f64::from(i) - 19_999.5)).collect();
            let (density, atoms) = slider.stretch_density(&stretches).unwrap().unwrap();
            let sum = |of: &dyn Fn(f64) -> f64| {
                let spread: f64 = density.iter().zip(&stretches).map(|(q, &x)| width * q * of(x)).sum();
                spread + atoms.iter().map(|atom| atom.weight * of(atom.position)).sum::<f64>()
            };
            // Jumps of the density fall between two stretches.
            near(sum(&|_| 1.0), 1.0, 1e-3);
            near(sum(&|x| x), slider.point().force, 1e-3);
        }
    }
}

#[test]
fn breaks_are_counted_up_to_the_present_position() {
    let [population, _] = populations();
    let mut slider =
        Block::new(Loading::Rigid, Slip::Overdamped, None).unwrap().simulation(population).unwrap();
    slider.run(0.95, &mut |_| ()).unwrap();
    // The fraction Φ(−1/2) of the thresholds, of mean 1 and standard deviation 0.1; none has broken twice. The solver has 1e-10.
    near(slider.broken().unwrap(), 0.308_537_538_725_987, 1e-8);
}

#[test]
fn a_drive_that_makes_no_sense_is_refused() {
    let [population, _] = populations();
    let mut slider = soft(Slip::Reset).simulation(population).unwrap();
    assert!(slider.next_event(f64::NAN).is_err());
    let [solved, drawn] = populations();
    let state = soft(Slip::Reset).simulation(drawn).unwrap().state();
    let mut slider = soft(Slip::Reset).simulation(solved).unwrap();
    slider.run(2.0, &mut |_| ()).unwrap();
    let before = slider.state();
    assert!(slider.restore(state, &mut ()).unwrap_err().to_string().contains("state: expected"));
    assert_eq!(slider.state(), before);
}
