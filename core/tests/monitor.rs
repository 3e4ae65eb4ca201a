//! How often what may take long asks its monitor, and how it stops.

mod common;

use std::ops::ControlFlow;

use asperity::Error;
use asperity::block::{Block, Loading, Slip};
use asperity::contacts::{Ageing, Barrier, Contacts, Rules, Temperature};
use asperity::elastic::coupling::HalfSpace;
use asperity::elastic::{CellSlip, Curves, Interface};
use asperity::ensemble::lattice::{Lattice, LatticeCoupling, Until};
use asperity::ensemble::{Disorder, Ensemble, Snapshots};
use asperity::history::{History, Piece};
use asperity::law::{Series, SharedLaw, Tabulated, kernel_density_with, maximum_likelihood_with};
use asperity::master::{DynamicStiffness, Limits, MasterEquation, Slider, Transport};
use asperity::monitor::Monitor;
use asperity::rate_state::MeasuredHealing;
use asperity::shape::{Edges, Shape};
use common::patience::{alone, patient};
use common::sliders::{Impatient, scales, setting};
use common::{contacts, exponential, gamma, gaussian, initial, point, rectangular, weibull};

fn with(rules: Rules, contacts: Contacts) -> Contacts {
    Contacts { rules, ..contacts }
}

fn warm(energy: f64) -> Option<Temperature> {
    Some(Temperature { barrier: Barrier::Elastic, ..Temperature::new(energy, 1.0) })
}

fn diffusing(diffusion: f64) -> Option<Ageing> {
    Some(Ageing::Smoluchowski { mature: gaussian(1.0, 0.05), diffusion })
}

fn ageing(rule: Option<Ageing>, temperature: Option<Temperature>) -> Rules {
    Rules { ageing: rule, temperature, ..Rules::default() }
}

/// Contacts whose lives take long, each for another reason.
fn slow() -> Vec<(&'static str, Contacts)> {
    let (fresh, unstretched, spread) = (gaussian(0.5, 0.1), point(0.0), gaussian(0.2, 0.05));
    let frozen = Some(Ageing::FrozenRank { mature: gaussian(1.0, 0.05), time: 1.0 });
    let mature = Some(Ageing::FrozenRank { mature: gaussian(1.5, 0.2), time: 1.0 });
    let logarithmic = Some(Ageing::Logarithmic { growth: 0.1, time: 1.0 });
    let of = |thresholds: &SharedLaw, reforming: &SharedLaw| contacts(thresholds, reforming);
    vec![
        ("thresholds that diffuse", with(ageing(diffusing(0.0025), None), of(&fresh, &unstretched))),
        ("hardly", with(ageing(diffusing(1e-9), None), of(&fresh, &unstretched))),
        ("warm", with(ageing(diffusing(0.0025), warm(0.02)), of(&fresh, &unstretched))),
        ("edges", with(ageing(diffusing(0.0025), None), of(&rectangular(0.3, 0.7), &unstretched))),
        ("spread starts", with(ageing(diffusing(0.0025), None), of(&fresh, &spread))),
        ("frozen ranks", with(ageing(frozen.clone(), None), of(&fresh, &spread))),
        ("frozen, warm", with(ageing(frozen, warm(0.02)), of(&fresh, &unstretched))),
        ("logarithmic, warm", with(ageing(logarithmic, warm(0.02)), of(&exponential(1.0), &spread))),
        ("warm, spread", with(ageing(None, warm(0.02)), of(&gamma(1.0, 1.5), &spread))),
        ("ranks of a pole", with(ageing(ranks(), None), of(&gamma(1.0, 2.0), &unstretched))),
        ("a pole, frozen, warm", with(ageing(mature, warm(0.05)), of(&weibull(0.41, 1.0), &unstretched))),
        ("a pole", of(&weibull(0.3, 1.0), &exponential(0.2))),
    ]
}

/// Thresholds that keep their rank between laws of which none is Gaussian: ranks have to be found at many ages.
fn ranks() -> Option<Ageing> {
    Some(Ageing::FrozenRank { mature: gamma(1.5, 0.3), time: 1.0 })
}

/// Contacts that take long to be followed in time, each for another reason.
fn slow_in_time() -> Vec<(&'static str, Contacts, f64)> {
    let (fresh, unstretched, spread) = (gaussian(0.5, 0.1), point(0.0), gaussian(0.2, 0.05));
    let with = |ageing_rule, temperature, thresholds, reforming| {
        with(ageing(ageing_rule, temperature), contacts(thresholds, reforming))
    };
    vec![
        ("many seeds", with(diffusing(0.0025), None, &fresh, &spread), 1e-6),
        ("many warm seeds", with(diffusing(0.0025), warm(1.0), &fresh, &spread), 1e-6),
        ("many cells", with(diffusing(0.0025), None, &gamma(1.0, 2.0), &unstretched), 1e-4),
        ("ranks of a pole", with(ranks(), warm(0.05), &gamma(1.0, 2.0), &unstretched), 1e-4),
    ]
}

/// A hold and a slide.
fn slide_after_hold() -> History {
    let piece = |velocity, duration| Piece { velocity, duration };
    History::new(vec![piece(0.1, 2.0), piece(0.0, 1e3), piece(0.1, 20.0)]).unwrap()
}

#[test]
fn what_takes_long_asks_often_and_stops_at_once() {
    alone(|| {
        for (name, contacts) in slow() {
            let start = initial(&point(0.0));
            let mut solved = None;
            let life = |monitor: &mut dyn Monitor| {
                solved = Some(MasterEquation::at_with(contacts.clone(), &start, 0.1, monitor)?);
                Ok(())
            };
            let whole = patient(&format!("{name}: life"), life);
            assert_eq!(solved.is_some(), whole, "{name}");
            patient(&format!("{name}: limits"), |monitor| Limits::of(&contacts, monitor).map(drop));
            if let Some(equation) = solved {
                let steady = equation.steady_state();
                let places: Vec<f64> = (0..400).map(|i| 0.004 * f64::from(i)).collect();
                patient(&format!("{name}: relaxation"), |monitor| {
                    equation.relaxation_with(monitor).map(drop)
                });
                patient(&format!("{name}: stretches"), |monitor| {
                    steady.stretch_density_with(&places, monitor).map(drop)
                });
                patient(&format!("{name}: thresholds met"), |monitor| {
                    steady.breaking_stretches_with(&places, monitor).map(drop)
                });
                patient(&format!("{name}: population"), |monitor| {
                    equation.population_with(1e-10, monitor).map(drop)
                });
            }
            patient(&format!("{name}: contacts that slide"), |monitor| {
                Transport::steady_with(&contacts, 0.1, 1e-4, monitor).map(drop)
            });
        }
    });
}

#[test]
fn what_is_followed_in_time_asks_often_and_stops_at_once() {
    alone(|| {
        let history = slide_after_hold();
        for (name, contacts, tolerance) in slow_in_time() {
            let start = initial(&point(0.0));
            let mut begun = None;
            patient(&format!("{name}: new"), |monitor| {
                begun = Some(Transport::new_with(contacts.clone(), &start, tolerance, monitor)?);
                Ok(())
            });
            let begun = begun.unwrap_or_else(|| {
                Transport::new_with(contacts.clone(), &start, tolerance, &mut ()).expect("accepted contacts")
            });
            patient(&format!("{name}: follow"), |monitor| {
                begun.clone().follow_with(&history, &[], monitor).map(drop)
            });
            let slip = Slip::Inertial { mass: 1.0, damping: 0.1 };
            let block = Block::new(Loading::Spring(0.3), slip, None).unwrap();
            patient(&format!("{name}: block"), |monitor| {
                block.follow_with(&begun, &history, &[], 1e-6, monitor).map(drop)
            });
        }
    });
}

#[test]
fn single_contacts_in_time_ask_often_and_stop_at_once() {
    alone(|| {
        let history = slide_after_hold();
        let rules = ageing(diffusing(0.0025), None);
        let contacts = with(rules, contacts(&gaussian(0.5, 0.1), &point(0.0)));
        let ensemble =
            Ensemble::new(contacts, initial(&point(0.0)), 1_000_000, 1, Disorder::Annealed).unwrap();
        patient("follow", |monitor| ensemble.follow_with(&history, &[20.0], monitor).map(drop));
        patient("pull", |monitor| {
            ensemble.pull_at_with(0.1, &[2.0], &Snapshots::default(), monitor).map(drop)
        });
        patient("in time", |monitor| ensemble.in_time_with(monitor).map(drop));
    });
}

#[test]
fn many_coupled_contacts_ask_while_they_are_made() {
    alone(|| {
        let coupling = LatticeCoupling::with_alpha(Shape::Square([2048; 2]), Edges::Periodic, 0.2);
        let contacts = contacts(&gaussian(1.0, 0.1), &point(0.0));
        patient("lattice", |monitor| {
            let start = initial(&point(0.0));
            Lattice::new_with(contacts, start, &coupling, 1, Disorder::Annealed, monitor).map(drop)
        });
    });
}

/// The drive takes a five-hundredth of what a contact lets go, so that an avalanche has millions of breaks.
#[test]
fn avalanches_ask_within_them() {
    alone(|| {
        let coupling = LatticeCoupling::with_alpha(Shape::Square([512; 2]), Edges::Periodic, 0.2495);
        let (contacts, start) = (contacts(&gaussian(1.0, 0.1), &point(0.0)), initial(&point(0.0)));
        let new = || Lattice::new(contacts.clone(), start.clone(), &coupling, 1, Disorder::Annealed).unwrap();
        let mut lattice = new();
        patient("avalanches", |monitor| lattice.run_with(Until::Drive(2.0), monitor, &mut |_| ()));
        let mut lattice = new();
        patient("first breaks", |monitor| lattice.first_breaks(monitor).map(drop));
    });
}

/// Identical contacts break all at once, in one generation of an avalanche.
#[test]
fn generations_ask_within_them() {
    alone(|| {
        let coupling = LatticeCoupling::with_alpha(Shape::Square([2048; 2]), Edges::Open, 0.2);
        let (contacts, start) = (contacts(&point(1.0), &gaussian(0.1, 0.01)), initial(&point(0.0)));
        let mut lattice = Lattice::new(contacts, start, &coupling, 1, Disorder::Annealed).unwrap();
        patient("generation", |monitor| lattice.run_with(Until::Events(1), monitor, &mut |_| ()));
    });
}

#[test]
fn readings_of_many_holds_and_tables_of_ranks_ask_often() {
    alone(|| {
        let hold: Vec<f64> = (0..50_000).map(|k| 1.0 + 0.1 * f64::from(k)).collect();
        let force: Vec<f64> = hold.iter().map(|t| t.ln_1p() + 1e-3 * t.sin()).collect();
        patient("healing", |monitor| MeasuredHealing::read_with(&hold, &force, monitor).map(drop));
        let contacts = with(ageing(ranks(), None), contacts(&gamma(1.0, 0.5), &point(0.0)));
        let new = |monitor: &mut dyn Monitor| DynamicStiffness::new_with(&contacts, 0.1, monitor).map(drop);
        patient("dynamic stiffness", new);
    });
}

/// Open edges: linear systems are solved by some fifteen iterations of two transforms each, more than a second in all.
#[test]
fn many_cells_on_a_half_space_ask_often_and_stop_at_once() {
    alone(|| {
        let shape = Shape::Square([512; 2]);
        let equation =
            MasterEquation::new(contacts(&gaussian(1.0, 0.1), &point(0.0)), &initial(&gaussian(0.3, 0.05)));
        let population = equation.unwrap().population().unwrap();
        let make = |monitor: &mut dyn Monitor| {
            let cells = Curves::new(&population, shape.size())?.scaled(scales(shape.size(), 0.03))?;
            let slider = HalfSpace::new_with(shape, Edges::Open, 3.0, 1.0, monitor)?;
            let parameters = setting(0.5, CellSlip::Overdamped, 1e-3);
            Interface::new_with(Box::new(cells), Box::new(slider), parameters, monitor)
        };
        patient("half-space", |monitor| HalfSpace::new_with(shape, Edges::Open, 3.0, 1.0, monitor).map(drop));
        patient("interface", |monitor| make(monitor).map(drop));
        let mut interface = make(&mut ()).unwrap();
        patient("creep", |monitor| interface.run_with(0.9, monitor, &mut |_, _| ()));
        let ahead: Vec<f64> = interface.positions().iter().map(|position| position + 0.1).collect();
        interface.put(3.2, &ahead).unwrap();
        patient("slide", |monitor| interface.run_with(3.2, monitor, &mut |_, _| ()));
    });
}

/// The equations of steady sliding at many frequencies, each a sum over a thousand times.
#[test]
fn stability_asks_often_and_stops_at_once() {
    alone(|| {
        let time: Vec<f64> = (0..20_000).map(|k| 1e-3 * f64::from(k)).collect();
        // Strengthening at once, weakening later: unstable behind soft springs.
        let response = time.iter().map(|t| 2.0 * (-t / 0.1).exp() - (-t).exp()).collect();
        let response = DynamicStiffness::of_step_response(1.0, time, response);
        let slider = Slider { mass: 0.01, damping: 0.01 };
        patient("critical stiffness", |monitor| response.critical_stiffness(slider, monitor).map(drop));
        patient("roots", |monitor| response.unstable_roots(slider, 1e-3, monitor).map(drop));
        patient("growth", |monitor| response.growth(slider, 1e-3, monitor).map(drop));
    });
}

/// All fractions done that it was reported.
#[derive(Default)]
struct Reported(Vec<f64>);

impl Monitor for Reported {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.0.push(fraction);
        ControlFlow::Continue(())
    }
}

impl Reported {
    /// Whether they never fell, were reported up to the end, and in most of ten parts of the way.
    fn is_steady(&self) -> bool {
        let Self(reported) = self;
        let rises = reported.windows(2).all(|pair| pair[0] <= pair[1])
            && reported.iter().all(|f| (0.0..=1.0).contains(f));
        // Not in all of them: where contacts start together, little is known before they have been followed.
        let tenths = (0..10).filter(|tenth| reported.iter().any(|f| (10.0 * f) as usize == *tenth));
        rises && tenths.count() >= 6 && reported.last().is_some_and(|last| *last > 0.9)
    }
}

/// Of contacts that wear out, and of some that live for many mean lives.
#[test]
fn steady_starts_report_how_far_they_are() {
    let logarithmic = Some(Ageing::Logarithmic { growth: 0.1, time: 1.0 });
    for thresholds in [gaussian(1.0, 0.1), weibull(0.7, 1.0)] {
        let contacts = with(ageing(logarithmic.clone(), None), contacts(&thresholds, &point(0.0)));
        let mut reported = Reported::default();
        Transport::steady_with(&contacts, 0.1, 1e-6, &mut reported).unwrap();
        assert!(reported.is_steady(), "{:?}", reported.0);
    }
}

/// Lives at a velocity report how far they are, and never less than before.
#[test]
fn lives_at_a_velocity_report_how_far_they_are() {
    let start = initial(&point(0.0));
    let warm = with(ageing(None, warm(0.05)), contacts(&gaussian(1.0, 0.1), &gaussian(0.2, 0.05)));
    let diffusing =
        with(ageing(diffusing(0.0025), None), contacts(&gaussian(0.5, 0.1), &gaussian(0.2, 0.05)));
    for contacts in [warm, diffusing] {
        let mut reported = Reported::default();
        MasterEquation::at_with(contacts, &start, 0.1, &mut reported).unwrap();
        assert!(reported.is_steady(), "{:?}", reported.0);
    }
}

/// The first question is answered by the wish to stop.
#[test]
fn what_is_asked_to_stop_at_once_does() {
    let (contacts, start) = (contacts(&gaussian(1.0, 0.1), &gaussian(0.3, 0.05)), initial(&point(0.0)));
    let stopped = |outcome: asperity::Result<()>| assert!(matches!(outcome, Err(Error::Stopped)));
    let equation = MasterEquation::new(contacts.clone(), &start).unwrap();
    stopped(MasterEquation::new_with(contacts.clone(), &start, &mut Impatient(1)).map(drop));
    stopped(equation.relaxation_with(&mut Impatient(1)).map(drop));
    stopped(equation.population_with(1e-10, &mut Impatient(1)).map(drop));
    stopped(equation.steady_state().stretch_density_with(&[0.5], &mut Impatient(1)).map(drop));
    stopped(Limits::of(&contacts, &mut Impatient(1)).map(drop));
    stopped(Transport::new_with(contacts.clone(), &start, 1e-4, &mut Impatient(1)).map(drop));
    stopped(Transport::steady_with(&contacts, 1.0, 1e-4, &mut Impatient(1)).map(drop));
}

#[test]
fn distributions_of_many_numbers_ask_often_and_stop_at_once() {
    let spread = 5_000_011;
    // In no order, with equal ones.
    let samples: Vec<f64> = (0..4_000_000_u64).map(|i| 1.0 + (i * 7_368_787 % spread) as f64 / 1e7).collect();
    let rows: Vec<_> = (0..4_000_000).map(|i| (1e-6 * f64::from(i), 1.0)).collect();
    let boundaries: Vec<f64> = (0..=100_000).map(|i| 1e-5 * f64::from(i)).collect();
    // A step at each boundary.
    let steps: Vec<_> = (0..100_000).map(|i| vec![1.0 + f64::from(i % 7)]).collect();
    alone(|| {
        patient("samples", |monitor| Tabulated::from_samples_with(&samples, monitor).map(drop));
        patient("rows", |monitor| Tabulated::from_density_with(&rows, monitor).map(drop));
        patient("kernels", |monitor| kernel_density_with(&samples, None, monitor).map(drop));
        patient("series", |monitor| Series::new_with(&boundaries, &steps, 0.0, monitor).map(drop));
        for family in ["gaussian", "lognormal", "gamma", "weibull"] {
            patient(family, |monitor| maximum_likelihood_with(family, &samples, monitor).map(drop));
        }
    });
}
