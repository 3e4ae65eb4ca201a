//! An interface in time goes on from what it has come to as if it had never stopped, whatever its contacts.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::ways::{Kind, kinds};
use crate::common::{gaussian, point};
use asperity::contacts::{Contacts, Initial, Rules, Start};
use asperity::elastic::coupling::half_space;
use asperity::elastic::rate_dependent::Scaled;
use asperity::elastic::{
    CellLoading, Event, RateDependentInterface, RateDependentInterfaceParameters,
    RateDependentInterfaceState, Slipped,
};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::law::Mixture;
use asperity::master::Transport;
use asperity::monitor::Monitor;
use asperity::rate_dependent::{ContactsState, RateDependentContacts};
use asperity::shape::{Edges, Shape};
use asperity::{Error, Result};

const SCALES: [f64; 3] = [0.9, 1.0, 1.1];

/// Contacts, and a drive: its distance and velocity.
#[derive(Clone)]
struct Sample {
    name: &'static str,
    contacts: Contacts,
    drive: (f64, f64),
}

/// Contacts of every rule; among those that strengthen, many that share a threshold, break together and stay free for a
/// while.
fn samples() -> Vec<Sample> {
    let slow = |name: &str| ["logarithmic", "frozen_rank"].contains(&name);
    // Thresholds that diffuse take most of the time: they are driven no farther than to a first slip.
    let way = |name: &str| match name {
        "smoluchowski" => (3.5, 0.3),
        name if slow(name) => (8.0, 1e-2),
        _ => (5.0, 0.3),
    };
    let of = |kind: Kind| Sample { drive: way(kind.name), name: kind.name, contacts: kind.contacts };
    let other = |name: &str| !["elastic barrier", "bell barrier", "catastrophe barrier"].contains(&name);
    let mut samples: Vec<Sample> = kinds().into_iter().filter(|kind| other(kind.name)).map(of).collect();
    let strengthening = samples.iter().find(|sample| sample.name == "logarithmic").unwrap().clone();
    let lumps = Arc::new(Mixture::new(vec![(0.2, point(1.0)), (0.8, gaussian(1.0, 0.1))]).unwrap());
    let rules = Rules { delay: 2.0.into(), ..strengthening.contacts.rules.clone() };
    let contacts = Contacts { rules, ..Contacts::new(lumps, point(0.0)) };
    samples.push(Sample { name: "lumps", contacts, ..strengthening });
    samples
}

fn named(name: &str) -> Sample {
    samples().into_iter().find(|sample| sample.name == name).unwrap()
}

fn start() -> Initial {
    Initial { law: point(0.0), start: Start::Conditional }
}

fn transport(contacts: &Contacts) -> Box<dyn RateDependentContacts> {
    Box::new(Transport::new_with(contacts.clone(), &start(), 1e-2, &mut ()).unwrap())
}

fn few(contacts: &Contacts, disorder: Disorder) -> Box<dyn RateDependentContacts> {
    Box::new(Ensemble::new(contacts.clone(), start(), 300, 7, disorder).unwrap().in_time().unwrap())
}

/// A chain of such cells at rest.
fn chain(cell: &dyn Fn() -> Box<dyn RateDependentContacts>) -> RateDependentInterface {
    let setting = RateDependentInterfaceParameters {
        connection: 0.2,
        loading: CellLoading::Uniform,
        mass: 0.0,
        viscosity: 0.1,
        tolerance: 1e-2,
        slip_fraction: 0.01,
        area: None,
    };
    let cells = SCALES
        .iter()
        .map(|&scale| -> Box<dyn RateDependentContacts> { Box::new(Scaled::new(cell(), scale).unwrap()) });
    let coupling = half_space(Shape::Chain(SCALES.len()), Edges::Open, 0.5, 1.0).unwrap();
    RateDependentInterface::new(cells.collect(), coupling, setting).unwrap().with_slip_rates(16)
}

/// Says stop after so many steps.
struct Patience(u32);

impl Monitor for Patience {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        if self.0 == 0 {
            return ControlFlow::Break(());
        }
        self.0 -= 1;
        ControlFlow::Continue(())
    }
}

/// Drives it on for so many steps at most; whether it came to the end. Events are added, as text: some speeds are no numbers.
fn drive(
    interface: &mut RateDependentInterface,
    way: (f64, f64),
    steps: u32,
    events: &mut Vec<String>,
) -> bool {
    let mut each = |event: &Event, slipped: &[Slipped]| events.push(format!("{event:?} {slipped:?}"));
    match interface.run_with(way.0, way.1, &mut Patience(steps), &mut each) {
        Err(Error::Stopped) => false,
        done => done.is_ok(),
    }
}

/// A state as it is written and read.
fn kept(state: &RateDependentInterfaceState) -> RateDependentInterfaceState {
    ContactsState::of(state).read().unwrap()
}

/// What an interface has come to, in all.
fn reported(interface: &mut RateDependentInterface) -> (ContactsState, String) {
    (ContactsState::of(&interface.state()), format!("{:?} {:?}", interface.energy(), interface.stretches(1)))
}

/// Interrupted after two steps, after four more, and so on, it comes to the same; in how many events.
fn goes_on(sample: &Sample, cell: &dyn Fn(&Contacts) -> Box<dyn RateDependentContacts>) -> usize {
    let &Sample { name, ref contacts, drive: way } = sample;
    let new = || chain(&|| cell(contacts));
    let (mut whole, mut expected) = (new(), Vec::new());
    assert!(drive(&mut whole, way, u32::MAX, &mut expected), "{name}");
    let (mut parts, mut found) = (new(), Vec::new());
    let mut steps = 2;
    while !drive(&mut parts, way, steps, &mut found) {
        let state = kept(&parts.state());
        parts = new();
        parts.restore(state).unwrap();
        steps *= 2;
    }
    assert!(steps >= 16, "{name} was never interrupted after eight steps");
    assert_eq!(found, expected, "{name}");
    assert!(reported(&mut parts) == reported(&mut whole), "{name}");
    found.len()
}

#[test]
fn cells_of_transport_go_on() {
    let events: Vec<usize> = samples().iter().map(|sample| goes_on(sample, &transport)).collect();
    assert!(events.iter().filter(|events| **events > 1).count() > 2, "{events:?}");
}

#[test]
fn cells_of_few_contacts_go_on() {
    let annealed = |sample: &Sample| goes_on(sample, &|contacts| few(contacts, Disorder::Annealed));
    let events: Vec<usize> = samples().iter().map(annealed).collect();
    assert!(events.iter().filter(|events| **events > 1).count() > 2, "{events:?}");
    goes_on(&named("logarithmic"), &|contacts| few(contacts, Disorder::Quenched));
}

#[test]
fn a_state_of_something_else_is_refused() {
    let of = |name: &str| named(name).contacts;
    let refused = |result: Result<()>| {
        let error = result.unwrap_err().to_string();
        assert!(error.starts_with("state: expected that of"), "{error}");
    };
    let names = ["logarithmic", "elastic barrier, delay", "smoluchowski"];
    for to in names {
        let mut contacts = transport(&of(to));
        for from in names.iter().filter(|from| **from != to) {
            refused(contacts.restore(&transport(&of(from)).state()));
        }
        refused(contacts.restore(&few(&of(to), Disorder::Annealed).state()));
        refused(few(&of(to), Disorder::Annealed).restore(&transport(&of(to)).state()));
    }
    let more = Ensemble::new(of("logarithmic"), start(), 301, 7, Disorder::Annealed).unwrap();
    refused(few(&of("logarithmic"), Disorder::Annealed).restore(&more.in_time().unwrap().state()));
    let cell = || transport(&of("logarithmic"));
    let setting = RateDependentInterfaceParameters {
        connection: 0.2,
        loading: CellLoading::Uniform,
        mass: 0.0,
        viscosity: 0.1,
        tolerance: 1e-2,
        slip_fraction: 0.0,
        area: None,
    };
    let coupling = half_space(Shape::Chain(1), Edges::Open, 0.5, 1.0).unwrap();
    let mut one = RateDependentInterface::new(vec![cell()], coupling, setting).unwrap();
    refused(one.restore(chain(&cell).state()));
}
