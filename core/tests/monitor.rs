//! How often what may take long asks its monitor, and how it stops.

mod common;

use std::ops::ControlFlow;
use std::time::Duration;

use asperity::Error;
use asperity::contacts::{Ageing, Barrier, Contacts, Rules, Temperature};
use asperity::law::SharedLaw;
use asperity::master::{Limits, MasterEquation, Transport};
use asperity::monitor::Monitor;
use common::sliders::Impatient;
use common::{contacts, exponential, gamma, gaussian, initial, point, rectangular, weibull};
use cpu_time::ThreadTime;

/// CPU time between two questions, at most.
const MOST: Duration = Duration::from_millis(200);

/// CPU time after which a computation is asked to stop.
const LIMIT: Duration = Duration::from_millis(500);

/// Notes the longest time between two questions.
struct Patience {
    begun: Duration,
    last: Duration,
    longest: Duration,
    questions: usize,
    asked_to_stop: bool,
}

/// CPU time of this thread.
fn now() -> Duration {
    ThreadTime::now().as_duration()
}

impl Patience {
    fn new() -> Self {
        Self { begun: now(), last: now(), longest: Duration::ZERO, questions: 0, asked_to_stop: false }
    }

    fn note(&mut self) {
        self.longest = self.longest.max(now() - self.last);
        self.last = now();
    }
}

impl Monitor for Patience {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        self.note();
        self.questions += 1;
        self.asked_to_stop = now() - self.begun > LIMIT;
        if self.asked_to_stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// All work on one thread, of which the CPU time is known whatever else the machine does.
fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(work)
}

fn with(rules: Rules, contacts: Contacts) -> Contacts {
    Contacts { rules, ..contacts }
}

fn warm(energy: f64) -> Option<Temperature> {
    Some(Temperature { energy, attempt_rate: 1.0, barrier: Barrier::Elastic })
}

fn diffusing(diffusion: f64) -> Option<Ageing> {
    Some(Ageing::Smoluchowski { mature: gaussian(1.0, 0.05), diffusion })
}

fn ageing(rule: Option<Ageing>, temperature: Option<Temperature>) -> Rules {
    Rules { ageing: rule, temperature, ..Rules::default() }
}

/// Contacts whose lives take long, each for another reason.
fn slow() -> Vec<(&'static str, Contacts)> {
    let (newborn, unstretched, spread) = (gaussian(0.5, 0.1), point(0.0), gaussian(0.2, 0.05));
    let frozen = Some(Ageing::FrozenRank { mature: gaussian(1.0, 0.05), time: 1.0 });
    let logarithmic = Some(Ageing::Logarithmic { growth: 0.1, time: 1.0 });
    let of = |thresholds: &SharedLaw, reforming: &SharedLaw| contacts(thresholds, reforming);
    vec![
        ("thresholds that diffuse", with(ageing(diffusing(0.0025), None), of(&newborn, &unstretched))),
        ("hardly", with(ageing(diffusing(1e-9), None), of(&newborn, &unstretched))),
        ("warm", with(ageing(diffusing(0.0025), warm(0.02)), of(&newborn, &unstretched))),
        ("edges", with(ageing(diffusing(0.0025), None), of(&rectangular(0.3, 0.7), &unstretched))),
        ("spread starts", with(ageing(diffusing(0.0025), None), of(&newborn, &spread))),
        ("frozen ranks", with(ageing(frozen.clone(), None), of(&newborn, &spread))),
        ("frozen, warm", with(ageing(frozen, warm(0.02)), of(&newborn, &unstretched))),
        ("logarithmic, warm", with(ageing(logarithmic, warm(0.02)), of(&exponential(1.0), &spread))),
        ("warm, spread", with(ageing(None, warm(0.02)), of(&gamma(1.0, 1.5), &spread))),
        ("a pole", of(&weibull(0.3, 1.0), &exponential(0.2))),
    ]
}

/// Lets one computation go on for as long as it may; whether it was done then.
fn patient(name: &str, work: impl FnOnce(&mut dyn Monitor) -> asperity::Result<()>) -> bool {
    let mut patience = Patience::new();
    let outcome = work(&mut patience);
    // What it takes to stop counts, too.
    patience.note();
    let (longest, questions) = (patience.longest, patience.questions);
    assert!(longest < MOST, "{name}: nobody was asked for {longest:?}, of {:?}", now() - patience.begun);
    match outcome {
        Err(Error::Stopped) => assert!(patience.asked_to_stop, "{name}: it stopped unasked"),
        Err(error) => panic!("{name}: {error}"),
        Ok(()) => assert!(questions > 0, "{name}: it never asks"),
    }
    !patience.asked_to_stop
}

#[test]
fn what_takes_long_asks_often_and_stops_at_once() {
    alone(|| {
        for (name, contacts) in slow() {
            let start = initial(&point(0.0));
            let mut solved = None;
            let life = |monitor: &mut dyn Monitor| {
                solved = Some(MasterEquation::at(contacts.clone(), &start, 0.1, monitor)?);
                Ok(())
            };
            let whole = patient(&format!("{name}: life"), life);
            assert_eq!(solved.is_some(), whole, "{name}");
            patient(&format!("{name}: limits"), |monitor| Limits::of(&contacts, monitor).map(drop));
            if let Some(equation) = solved {
                let steady = equation.steady_state();
                let places: Vec<f64> = (0..400).map(|i| 0.004 * f64::from(i)).collect();
                patient(&format!("{name}: relaxation"), |monitor| equation.relaxation(monitor).map(drop));
                patient(&format!("{name}: stretches"), |monitor| {
                    steady.stretch_density(&places, monitor).map(drop)
                });
                patient(&format!("{name}: thresholds met"), |monitor| {
                    steady.thresholds_met(&places, monitor).map(drop)
                });
                patient(&format!("{name}: population"), |monitor| {
                    equation.population(1e-10, monitor).map(drop)
                });
            }
            patient(&format!("{name}: contacts that slide"), |monitor| {
                Transport::steady(&contacts, 0.1, 1e-4, monitor).map(drop)
            });
        }
    });
}

/// The first question is answered by the wish to stop.
#[test]
fn what_is_asked_to_stop_at_once_does() {
    let (contacts, start) = (contacts(&gaussian(1.0, 0.1), &gaussian(0.3, 0.05)), initial(&point(0.0)));
    let stopped = |outcome: asperity::Result<()>| assert!(matches!(outcome, Err(Error::Stopped)));
    let equation = MasterEquation::new(contacts.clone(), &start, &mut ()).unwrap();
    stopped(MasterEquation::new(contacts.clone(), &start, &mut Impatient(1)).map(drop));
    stopped(equation.relaxation(&mut Impatient(1)).map(drop));
    stopped(equation.population(1e-10, &mut Impatient(1)).map(drop));
    stopped(equation.steady_state().stretch_density(&[0.5], &mut Impatient(1)).map(drop));
    stopped(Limits::of(&contacts, &mut Impatient(1)).map(drop));
    stopped(Transport::new(contacts.clone(), &start, 1e-4, &mut Impatient(1)).map(drop));
    stopped(Transport::steady(&contacts, 1.0, 1e-4, &mut Impatient(1)).map(drop));
}
