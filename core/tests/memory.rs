//! What ensembles, blocks, lattices and interfaces take of memory: no more than 1.2 times what they are refused for.

mod common;

use std::ops::ControlFlow;
use std::sync::Arc;

use asperity::Error;
use asperity::block::{Block, Drive, Loading, Slip};
use asperity::contacts::{Ageing, Contacts, Rules, Temperature};
use asperity::elastic::coupling::{SlidingDirection, half_space, neighbours};
use asperity::elastic::{self, InterfaceParameters};
use asperity::ensemble::lattice::{Lattice, LatticeCoupling, Until};
use asperity::ensemble::{Disorder, Ensemble, Snapshots};
use asperity::history::{History, Piece};
use asperity::law::{Mixture, SharedLaw};
use asperity::master::Transport;
use asperity::monitor::Monitor;
use asperity::scenario;
use asperity::shape::{Edges, Shape};
use common::sliders::{interface, scales, setting};
use common::{contacts, curve, gaussian, initial, point, weibull};
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// What takes more is refused wrongly.
const MOST: f64 = 1.2;

/// A machine with so many bytes of memory.
struct Small(u64);

impl Monitor for Small {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn memory(&self) -> u64 {
        self.0
    }
}

/// Bytes that are said to be needed.
#[track_caller]
fn needed<T>(refused: asperity::Result<T>) -> f64 {
    match refused.err() {
        Some(Error::TooLarge { needed, allowed: 0, .. }) => needed as f64,
        other => panic!("{other:?}"),
    }
}

/// Most bytes taken at once.
fn most(work: impl FnOnce()) -> f64 {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    work();
    (MEMORY.peak_usage() - before) as f64
}

#[track_caller]
fn holds(what: &str, taken: f64, needed: f64) {
    assert!(taken <= MOST * needed, "{what}: {taken} instead of {needed} bytes");
}

fn ensemble(law: &SharedLaw, size: usize) -> Ensemble {
    Ensemble::new(contacts(law, &point(0.0)), initial(&point(0.0)), size, 1, Disorder::Annealed).unwrap()
}

fn pulls() {
    let model = ensemble(&gaussian(1.0, 0.1), 200);
    let positions: Vec<f64> = (0..2_000_000).map(|i| 1e-6 * f64::from(i)).collect();
    let pull = |monitor: &mut dyn Monitor| model.pull_with(&positions, &Snapshots::default(), monitor);
    holds("a pull", most(|| drop(pull(&mut ()).unwrap())), needed(pull(&mut Small(0))));
}

fn blocks() {
    let size = 1 << 16;
    let slips = [Slip::Overdamped, Slip::Reset, Slip::Arrest, Slip::Inertial { mass: 1.0, damping: 0.0 }];
    for law in [gaussian(1.0, 0.05), weibull(0.5, 1.0)] {
        let model = ensemble(&law, size);
        let said = needed(model.population_with(&mut Small(0)));
        for slip in slips {
            let taken = most(|| {
                let mut population = model.population().unwrap();
                let block = Block::new(Loading::Spring(0.2), slip, Some(0.01)).unwrap();
                let drive = Drive { turning_points: vec![6.0, 2.0, 4.0], points: 11 };
                block.pull(&mut population, &drive).unwrap();
            });
            holds(&format!("{slip:?}"), taken, said);
        }
    }
}

/// Contacts that are tried on copies in each step.
fn blocks_in_time() {
    let rules = Rules { ageing: Some(Ageing::Logarithmic { growth: 0.1, time: 1.0 }), ..Rules::default() };
    let contacts = Contacts { rules, ..contacts(&gaussian(1.0, 0.1), &point(0.0)) };
    let model = Ensemble::new(contacts, initial(&point(0.0)), 1 << 16, 1, Disorder::Annealed).unwrap();
    let said = needed(model.in_time_with(&mut Small(0)));
    let slide = History::new(vec![Piece { velocity: 0.1, duration: 20.0 }]).unwrap();
    let taken = most(|| {
        let contacts = model.in_time().unwrap();
        let block = Block::new(Loading::Spring(0.3), Slip::Damped { damping: 0.1 }, None).unwrap();
        block.follow_with(&contacts, &slide, &[], 1e-3, &mut ()).unwrap();
    });
    holds("a block in time", taken, said);
}

fn lattices() {
    for law in [point(1.0), gaussian(1.0, 0.05)] {
        for edges in [Edges::Open, Edges::Periodic] {
            let coupling = LatticeCoupling::with_alpha(Shape::Square([256; 2]), edges, 0.24);
            let size = coupling.shape.size() as f64;
            let contacts = Contacts { count: size, ..contacts(&law, &point(0.0)) };
            let make = |monitor: &mut dyn Monitor| {
                let start = initial(&point(0.0));
                Lattice::new_with(contacts.clone(), start, &coupling, 1, Disorder::Annealed, monitor)
            };
            let taken = most(|| {
                let mut lattice = make(&mut ()).unwrap();
                lattice.run(Until::Drive(2.5), &mut |_| ()).unwrap();
            });
            holds("a lattice", taken, needed(make(&mut Small(0))));
        }
    }
}

/// The table of an interface of such cells, to be asked what it needs.
fn table(shape: Shape, coupling: scenario::Elasticity) -> scenario::Interface {
    let cells = match shape {
        Shape::Chain(length) => vec![length],
        Shape::Square(sides) => sides.to_vec(),
    };
    scenario::Interface {
        cells,
        contacts: scenario::PerCell::Many,
        connection: 0.5,
        coupling,
        edges: Edges::Open,
        loading: scenario::CellLoading::Uniform,
        slip: None,
        viscosity: None,
        disorder: None,
        areas: None,
        drive_tolerance: 1e-3,
        catalogue_from: 0.0,
        mass: None,
        slip_rates: None,
        main_shocks: None,
    }
}

fn interfaces() {
    let shapes =
        [(Shape::Square([128; 2]), 3.0), (Shape::Square([128; 2]), 1e6), (Shape::Chain(1 << 12), 3.0)];
    for (shape, stiffness) in shapes {
        for edges in [Edges::Open, Edges::Periodic] {
            let springs = scenario::Elasticity::Neighbours { stiffness };
            on_a_slider(|| neighbours(shape, edges, stiffness), shape, springs);
            let bulk = scenario::Elasticity::HalfSpace {
                modulus: stiffness,
                cell: 1.0,
                poisson_ratio: 0.0,
                sliding: SlidingDirection::default(),
            };
            on_a_slider(|| half_space(shape, edges, stiffness, 1.0), shape, bulk);
        }
    }
}

fn on_a_slider(
    make: impl FnOnce() -> asperity::Result<Box<dyn elastic::Coupling>>,
    shape: Shape,
    described: scenario::Elasticity,
) {
    let said = needed(table(shape, described).fits(&contacts(&point(1.0), &point(0.0)), None, false, 0));
    let curve = curve::gaussian(0.1);
    let taken = most(|| slide(&curve, make().unwrap(), shape.size()));
    holds(&format!("{shape:?} {described:?}"), taken, said);
}

/// A slide of all cells, and creep after it.
fn slide(curve: &curve::ClosedCurve, slider: Box<dyn elastic::Coupling>, size: usize) {
    let stiff = InterfaceParameters { viscosity: None, ..setting(0.5, elastic::CellSlip::Overdamped, 1e-3) };
    let mut interface = interface(curve, Some(scales(size, 0.03)), slider, stiff);
    interface.put(3.2, &vec![0.0; size]).unwrap();
    let _ = interface.next(3.2).unwrap();
    interface.run(3.21, &mut |_, _| ()).unwrap();
}

/// Cells that follow the master equation in time, contacts one by one, or that are athermal and have a mass, on a chain that
/// slips.
fn interfaces_in_time() {
    let ageing = Rules { ageing: Some(Ageing::Logarithmic { growth: 0.1, time: 1.0 }), ..Rules::default() };
    let ranked = Ageing::FrozenRank { mature: gaussian(1.5, 0.2), time: 1.0 };
    let warm =
        Rules { temperature: Some(Temperature::new(1e-3, 1.0)), ageing: Some(ranked), ..Rules::default() };
    let law = gaussian(1.0, 0.1);
    for (rules, mass) in
        [(ageing.clone(), None), (warm, None), (ageing, Some(1.0)), (Rules::default(), Some(1.0))]
    {
        for size in [None, Some(50)] {
            let contacts = Contacts { rules: rules.clone(), ..contacts(&law, &point(0.0)) };
            in_time(
                &contacts,
                mass,
                size.map(|size| scenario::Ensemble { size: Some(size), ..Default::default() }),
            );
        }
    }
}

fn in_time(contacts: &Contacts, mass: Option<f64>, ensemble: Option<scenario::Ensemble>) {
    const TOLERANCE: f64 = 1e-4;
    let springs = scenario::Elasticity::Neighbours { stiffness: 1.0 };
    let viscosity = mass.is_none().then_some(1.0);
    let described = scenario::Interface { mass, viscosity, ..table(Shape::Chain(16), springs) };
    let start = initial(&point(0.0));
    let ensemble = ensemble.as_ref();
    for with_error in [false, true] {
        let said = needed(described.fits(contacts, ensemble, with_error, 0));
        let taken = most(|| {
            let start = scenario::CellStart::Initial(&start);
            let mut cells =
                described.in_time(contacts, start, TOLERANCE, TOLERANCE, ensemble, &mut ()).unwrap();
            let coupling = described.elasticity(&mut ()).unwrap();
            let mut rough = if with_error { cells.rough(coupling, &mut ()).unwrap() } else { None };
            for interface in [&mut cells].into_iter().chain(rough.as_mut()) {
                interface.run(4.0, 0.1, &mut |_, _| ()).unwrap();
            }
        });
        holds("an interface in time", taken, said);
    }
}

/// Cohorts of steady sliding, whose number is not known before, are refused when they have taken what is allowed.
fn cohorts() {
    const ALLOWED: u64 = 100_000_000;
    let mut narrow = contacts(&gaussian(1.0, 1e-3), &point(0.0));
    narrow.rules.ageing = Some(Ageing::Smoluchowski { mature: gaussian(1.5, 0.2), diffusion: 0.01 });
    let mut refused = None;
    let taken = most(|| refused = Transport::steady_with(&narrow, 0.1, 1e-6, &mut Small(ALLOWED)).err());
    assert!(matches!(refused, Some(Error::TooLarge { allowed: ALLOWED, .. })), "{refused:?}");
    holds("cohorts of steady sliding", taken, ALLOWED as f64);
}

/// The same where each cohort has many panels of thresholds: at low temperature, between thresholds down to 0.
fn cohorts_of_many_panels() {
    const ALLOWED: u64 = 20_000_000;
    /// Panels that all cohorts share are kept up to this.
    const PANELS: f64 = 43e6;
    let thresholds: SharedLaw =
        Arc::new(Mixture::new(vec![(0.39, weibull(0.41, 0.7)), (0.61, point(1.3))]).unwrap());
    let mut broad = contacts(&thresholds, &point(0.0));
    broad.rules.temperature = Some(Temperature::new(1e-6, 1.0));
    broad.rules.ageing = Some(Ageing::Logarithmic { growth: 0.1, time: 1.0 });
    let mut refused = None;
    let taken = most(|| refused = Transport::steady_with(&broad, 0.1, 1e-6, &mut Small(ALLOWED)).err());
    assert!(matches!(refused, Some(Error::TooLarge { allowed: ALLOWED, .. })), "{refused:?}");
    holds("cohorts of many panels", taken, ALLOWED as f64 + PANELS);
}

/// One after the other: memory is that of all threads.
#[test]
fn nothing_takes_more_than_it_is_refused_for() {
    pulls();
    blocks();
    blocks_in_time();
    lattices();
    interfaces();
    interfaces_in_time();
    cohorts();
    cohorts_of_many_panels();
}
