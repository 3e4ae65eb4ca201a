//! How often one step in time asks its monitor, however many contacts or cells there are.

mod common;

use std::time::Duration;

use asperity::Result;
use asperity::block::{Block, Loading, Slip};
use asperity::contacts::{Ageing, Contacts, Rules};
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::{CellSlip, RateDependentInterface, RateDependentInterfaceParameters};
use asperity::energy::ContactEnergies;
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::master::{MasterEquation, Transport};
use asperity::monitor::Monitor;
use asperity::rate_dependent::{ContactsState, RateDependentContacts, StretchInterval};
use asperity::shape::{Edges, Shape};
use common::patience::{alone, patient, patient_within};
use common::sliders::{interface, scales, setting};
use common::{contacts, gamma, gaussian, initial, point};
use cpu_time::ThreadTime;

fn ageing(rule: Ageing, contacts: Contacts) -> Contacts {
    Contacts { rules: Rules { ageing: Some(rule), ..Rules::default() }, ..contacts }
}

fn logarithmic() -> Contacts {
    ageing(Ageing::Logarithmic { growth: 0.1, time: 1.0 }, contacts(&gaussian(1.0, 0.1), &point(0.0)))
}

fn slide() -> History {
    History::new(vec![Piece { velocity: 0.1, duration: 20.0 }]).unwrap()
}

/// A step of a block copies all contacts. A million of them at once would take twice what is allowed here.
#[test]
fn contacts_are_copied_between_questions() {
    const MOST: f64 = 0.8;
    alone(|| {
        let (start, size) = (initial(&point(0.0)), 1_000_000);
        let ensemble = Ensemble::new(logarithmic(), start, size, 1, Disorder::Annealed).unwrap();
        let contacts = ensemble.in_time().unwrap();
        let block = Block::new(Loading::Spring(0.3), Slip::Damped { damping: 0.1 }, None).unwrap();
        patient_within(MOST, "a block over many contacts", |monitor| {
            block.follow_with(&contacts, &slide(), &[], 1e-4, monitor).map(drop)
        });
    });
}

/// Copies share their contacts until one of them takes a step, which the other does not notice.
#[test]
fn a_copy_goes_its_own_way() {
    let ensemble = Ensemble::new(logarithmic(), initial(&point(0.0)), 1000, 1, Disorder::Annealed).unwrap();
    let mut whole = ensemble.in_time().unwrap();
    whole.step(0.8, 8.0, &mut ()).unwrap();
    let (mut copy, state, force) = (whole.copy(), whole.state(), whole.force());
    copy.step(0.4, 4.0, &mut ()).unwrap();
    assert_eq!(whole.force(), force);
    assert_ne!(copy.force(), force);
    whole.step(0.4, 4.0, &mut ()).unwrap();
    assert_eq!(copy.force(), whole.force());
    whole.restore(&state).unwrap();
    assert_eq!(whole.force(), force);
}

/// Where the time of a cell goes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Slow {
    Force,
    Tangent,
    Settling,
}

/// Contacts of which this takes a millisecond, as it does for a hundred thousand cohorts.
#[derive(Debug)]
struct SlowContacts(Box<dyn RateDependentContacts>, Slow);

impl SlowContacts {
    fn waits(&self, slow: Slow) {
        let begun = ThreadTime::now();
        while self.1 == slow && begun.elapsed() < Duration::from_millis(1) {}
    }
}

impl RateDependentContacts for SlowContacts {
    fn position(&self) -> f64 {
        self.0.position()
    }

    fn time(&self) -> f64 {
        self.0.time()
    }

    fn force(&self) -> f64 {
        self.waits(Slow::Force);
        self.0.force()
    }

    fn tangent(&self) -> f64 {
        self.waits(Slow::Tangent);
        self.0.tangent()
    }

    fn energies(&self) -> ContactEnergies {
        self.0.energies()
    }

    fn free(&self) -> f64 {
        self.0.free()
    }

    fn stretches(&self) -> Vec<StretchInterval> {
        self.0.stretches()
    }

    fn step(&mut self, by: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.0.step(by, during, monitor)
    }

    fn settle(&mut self) {
        self.waits(Slow::Settling);
        self.0.settle();
    }

    fn copy(&self) -> Box<dyn RateDependentContacts> {
        Box::new(Self(self.0.copy(), self.1))
    }

    fn state(&self) -> ContactsState {
        self.0.state()
    }

    fn restore(&mut self, state: &ContactsState) -> Result<()> {
        self.0.restore(state)
    }
}

/// A step of an interface asks between cells: for a hundredth of a second in sixteen of them, and not for all 400.
#[test]
fn an_interface_asks_between_cells() {
    const CELLS: usize = 400;
    alone(|| {
        let cell = Transport::new_with(logarithmic(), &initial(&point(0.0)), 1e-4, &mut ()).unwrap();
        for slow in [Slow::Force, Slow::Tangent, Slow::Settling] {
            let slowed = |_| Box::new(SlowContacts(cell.copy(), slow)) as Box<dyn RateDependentContacts>;
            let coupling = neighbours(Shape::Chain(CELLS), Edges::Open, 1.0).unwrap();
            let parameters = RateDependentInterfaceParameters::new(0.5, 0.1, 1e-4);
            let cells = (0..CELLS).map(slowed).collect();
            let mut interface = RateDependentInterface::new(cells, coupling, parameters).unwrap();
            patient(&format!("{slow:?}"), |monitor| interface.run_with(0.5, 0.1, monitor, &mut |_, _| ()));
        }
    });
}

/// An interface that was stopped in a step has not moved, and goes on as if it had not been asked to stop.
#[test]
fn a_stop_within_a_step_changes_nothing() {
    let run = |questions: usize| {
        let cell = Transport::new_with(logarithmic(), &initial(&point(0.0)), 1e-4, &mut ()).unwrap();
        let cells = (0..40).map(|_| cell.copy()).collect();
        let coupling = neighbours(Shape::Chain(40), Edges::Open, 1.0).unwrap();
        let parameters = RateDependentInterfaceParameters::new(0.5, 0.1, 1e-4);
        let mut interface = RateDependentInterface::new(cells, coupling, parameters).unwrap();
        let stopped = questions < usize::MAX;
        for number in 0..200 {
            let mut monitor = common::sliders::Impatient(questions + 7 * number);
            match interface.run_with(0.6, 0.1, &mut monitor, &mut |_, _| ()) {
                Ok(()) => break,
                Err(error) => assert!(stopped && matches!(error, asperity::Error::Stopped), "{error}"),
            }
        }
        interface.run(0.6, 0.1, &mut |_, _| ()).unwrap();
        (interface.time(), interface.forces(), interface.energy())
    };
    assert_eq!(run(11), run(usize::MAX));
}

/// The same of an interface without time, stopped while it creeps, while cells slide, and while curves are tabulated.
#[test]
fn a_stop_within_a_stride_or_a_slide_changes_nothing() {
    let equation =
        MasterEquation::new(contacts(&gaussian(1.0, 0.1), &point(0.0)), &initial(&gaussian(0.3, 0.05)));
    let population = equation.unwrap().population().unwrap();
    let run = |questions: usize| {
        let slider = half_space(Shape::Square([64; 2]), Edges::Open, 3.0, 1.0).unwrap();
        let size = slider.shape().size();
        let parameters = setting(0.5, CellSlip::Overdamped, 1e-3);
        let mut cells = interface(&population, Some(scales(size, 0.03)), slider, parameters);
        let (stopped, mut events) = (questions < usize::MAX, Vec::new());
        let mut stops = 0;
        for number in 0..400 {
            let mut monitor = common::sliders::Impatient(questions + 40 * number);
            match cells.run_with(2.2, &mut monitor, &mut |event, _| events.push(*event)) {
                Ok(()) => break,
                Err(error) => assert!(stopped && matches!(error, asperity::Error::Stopped), "{error}"),
            }
            stops += 1;
        }
        // It was stopped often, so that the comparison is of something.
        assert_eq!(stopped, stops > 5, "{stops} stops");
        cells.run(2.2, &mut |event, _| events.push(*event)).unwrap();
        // As text, since events have numbers that are none.
        (format!("{events:?}"), cells.positions().to_vec(), cells.forces(), cells.energy(), cells.error())
    };
    let whole = run(usize::MAX);
    assert!(whole.0.contains("epicentre"));
    assert_eq!(run(11), whole);
}

/// The first steps compute the thresholds of contacts whose density has a pole, a cohort after the other.
#[test]
fn first_steps_from_a_pole_ask_between_cohorts() {
    /// Half of what a step is allowed to take.
    const MOST: f64 = 4.0;
    alone(|| {
        let temperature = Some(asperity::contacts::Temperature::new(0.05, 1.0));
        let frozen = Some(Ageing::FrozenRank { mature: gamma(1.5, 0.3), time: 1.0 });
        let rules = Rules { ageing: frozen, temperature, ..Rules::default() };
        let contacts = Contacts { rules, ..contacts(&gamma(1.0, 2.0), &point(0.0)) };
        let mut transport = Transport::new_with(contacts, &initial(&point(0.0)), 1e-6, &mut ()).unwrap();
        patient_within(MOST, "steps", |monitor| transport.follow_with(&slide(), &[], monitor).map(drop));
    });
}
