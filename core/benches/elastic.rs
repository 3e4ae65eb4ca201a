//! Cost of a step of a deformable interface and of its events, by coupling and size: tables.

#![allow(missing_docs)]

use std::sync::Arc;

use asperity::contacts::{Ageing, Contacts, Initial, Rules, Start};
use asperity::elastic::cells::Cells;
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::rate_dependent::Scaled;
use asperity::elastic::{
    CellLoading, CellSlip, Coupling, Curves, Interface, InterfaceParameters, RateDependentInterface,
    RateDependentInterfaceParameters,
};
use asperity::history::LoadPointSegment;
use asperity::law::{Gaussian, Point};
use asperity::master::{MasterEquation, MasterPopulation, Transport};
use asperity::random::{Purpose, Stream};
use asperity::rate_dependent::RateDependentContacts;
use asperity::shape::{Edges, Shape};
use cpu_time::{ProcessTime, ThreadTime};

fn main() {
    sweeps();
    println!(
        "\n{:<22} {:>8} {:>8} {:>14} {:>16}",
        "coupling", "cells", "events", "cells/event", "event, CPU ms"
    );
    for side in [128, 512] {
        let shape = Shape::Square([side, side]);
        let springs = || neighbours(shape, Edges::Periodic, 1.0).unwrap();
        row("neighbours", springs(), disordered(side * side));
        row("with unequal areas", springs(), unequal(side * side));
        row("half-space", half_space(shape, Edges::Periodic, 1.0, 1.0).unwrap(), disordered(side * side));
    }
    let half_space = half_space(Shape::Square([1024; 2]), Edges::Periodic, 1.0, 1.0).unwrap();
    row("half-space", half_space, disordered(1024 * 1024));
    println!(
        "\n{:<30} {:>8} {:>8} {:>12} {:>12} {:>20}",
        "chain of ageing contacts", "cells", "events", "cell slips", "CPU, s", "slips per CPU second"
    );
    // That of the scenario front-ageing, and chains pulled everywhere whose cells differ.
    in_time("pulled at one end", 20, 7, CellLoading::Edge, (2.0, 25.0), 0.0);
    in_time("pulled everywhere", 100, 10, CellLoading::Uniform, (0.5, 5.0), 0.1);
    in_time("small events", 1000, 100, CellLoading::Uniform, (0.5, 1.0), 0.2);
    println!(
        "\n{:<30} {:>8} {:>12} {:>12} {:>12}",
        "slide, hold, slide", "cells", "start, s", "hold, s", "rupture, s"
    );
    for number in [40, 400] {
        held(number);
    }
}

/// CPU time of a start in steady sliding of cells that differ, of a hold, and of the loading after it with the first rupture.
fn held(number: usize) {
    let (tolerance, velocity, hold) = (1e-3, 1e-3, 1e4);
    let contacts = ageing();
    let mut stream = Stream::new(1, Purpose::Cells, 0);
    let begun = ProcessTime::now();
    let cell = |_| -> Box<dyn RateDependentContacts> {
        let scale = 1.0 + 0.1 * 12.0_f64.sqrt() * (stream.uniform() - 0.5);
        let steady = Transport::steady_with(&contacts, velocity / scale, tolerance, &mut ()).unwrap();
        Box::new(Scaled::new(Box::new(steady), scale).unwrap())
    };
    let cells = (0..number).map(cell).collect();
    let setting = RateDependentInterfaceParameters::new(0.05, 1.0, tolerance);
    let coupling = neighbours(Shape::Chain(number), Edges::Open, 2.0).unwrap();
    let mut interface = RateDependentInterface::new(cells, coupling, setting).unwrap();
    let start = begun.elapsed().as_secs_f64();
    let at_rest = LoadPointSegment { time: 0.0, drive: interface.drive(), velocity: 0.0, pulled: velocity };
    assert!(interface.follow_with(&at_rest, hold, &mut ()).unwrap().is_empty());
    let rested = begun.elapsed().as_secs_f64();
    let mut cells = 0;
    while cells < number / 2 {
        cells = interface.next(1e3, velocity).unwrap().iter().map(|(event, _)| event.cells).max().unwrap();
    }
    let [hold, rupture] = [rested - start, begun.elapsed().as_secs_f64() - rested];
    println!("{:<30} {number:>8} {start:>12.2} {hold:>12.2} {rupture:>12.2}", "");
}

/// Contacts that age, with Gaussian thresholds.
fn ageing() -> Contacts {
    let ageing = Some(Ageing::Logarithmic { growth: 0.05, time: 1.0 });
    let rules = Rules { ageing, ..Rules::default() };
    let law = Arc::new(Gaussian::new(1.0, 0.1).unwrap());
    Contacts { rules, ..Contacts::new(law, Arc::new(Point::new(0.0).unwrap())) }
}

/// Throughput of a chain in time at a tolerance of 1e-3, with the springs of the connection and between cells, and scales of
/// cells with this standard deviation.
fn in_time(name: &str, number: usize, most: usize, loading: CellLoading, springs: (f64, f64), std: f64) {
    let (tolerance, velocity, far) = (1e-3, 1e-3, 1e3);
    let start = Initial { law: Arc::new(Point::new(0.0).unwrap()), start: Start::Conditional };
    let alike = Transport::new_with(ageing(), &start, tolerance, &mut ()).unwrap();
    let mut stream = Stream::new(1, Purpose::Cells, 0);
    let cell = |_| -> Box<dyn RateDependentContacts> {
        // A uniform distribution of this standard deviation.
        let scale = 1.0 + std * 12.0_f64.sqrt() * (stream.uniform() - 0.5);
        Box::new(Scaled::new(Box::new(alike.clone()), scale).unwrap())
    };
    let cells = (0..number).map(cell).collect();
    let setting = RateDependentInterfaceParameters {
        loading,
        ..RateDependentInterfaceParameters::new(springs.0, 1.0, tolerance)
    };
    let coupling = neighbours(Shape::Chain(number), Edges::Open, springs.1).unwrap();
    let mut interface = RateDependentInterface::new(cells, coupling, setting).unwrap();
    let (begun, mut events, mut slips) = (ProcessTime::now(), 0, 0);
    while events < most {
        let ended = interface.next(far, velocity).unwrap();
        events += ended.len();
        slips += ended.iter().map(|(event, _)| event.cells).sum::<usize>();
    }
    let seconds = begun.elapsed().as_secs_f64();
    let rate = slips as f64 / seconds;
    println!("{name:<30} {number:>8} {events:>8} {slips:>12} {seconds:>12.2} {rate:>20.0}");
}

fn population() -> MasterPopulation {
    let relaxed = Arc::new(Point::new(0.0).unwrap());
    let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1).unwrap()), relaxed.clone());
    let start = Initial { law: relaxed, start: Start::Conditional };
    MasterEquation::new(contacts, &start).unwrap().population_with(1e-10, &mut ()).unwrap()
}

/// Scales uniform in 1 ± 0.3.
fn disordered(number: usize) -> Curves {
    let mut stream = Stream::new(1, Purpose::Cells, 0);
    let scales = (0..number).map(|_| 0.7 + 0.6 * stream.uniform()).collect();
    Curves::new(&population(), number).unwrap().scaled(scales).unwrap()
}

/// The same with areas from a half to two, evenly in their logarithm.
fn unequal(number: usize) -> Curves {
    let mut stream = Stream::new(2, Purpose::Cells, 0);
    let areas = (0..number).map(|_| 0.5 * 4.0_f64.powf(stream.uniform())).collect();
    disordered(number).with_areas(areas).unwrap()
}

/// Cell updates per second of one thread: forces of springs and forces and slopes of contacts.
fn sweeps() {
    let (side, sweeps) = (512, 40);
    let number = side * side;
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    single.install(|| {
        let mut cells = disordered(number);
        let mut springs = neighbours(Shape::Square([side; 2]), Edges::Periodic, 1.0).unwrap();
        let positions: Vec<f64> = (0..number).map(|j| 0.5 + 0.4 * (j as f64 * 0.001).sin()).collect();
        let mut pulls = vec![0.0; number];
        let mut slopes = vec![0.0; number];
        let rate = |run: &mut dyn FnMut()| {
            run();
            let begun = ThreadTime::now();
            (0..sweeps).for_each(|_| run());
            (sweeps * number) as f64 / begun.elapsed().as_secs_f64()
        };
        let springs = rate(&mut || springs.forces(&positions, &mut pulls, &mut ()).unwrap());
        let contacts = rate(&mut || {
            cells.residual(&positions, &mut pulls, &mut slopes, &mut ()).unwrap();
        });
        println!("cell updates per second and core: springs {springs:.2e}, contacts {contacts:.2e}");
    });
}

/// Events from a start on, until there have been some, or slides have taken long.
fn row(name: &str, coupling: Box<dyn Coupling>, curves: Curves) {
    let number = coupling.shape().size();
    let setting = InterfaceParameters {
        connection: 0.5,
        loading: CellLoading::Uniform,
        slip: CellSlip::Overdamped,
        viscosity: None,
        drive_tolerance: 1e-6,
        area: None,
    };
    let mut interface = Interface::new(Box::new(curves), coupling, setting).unwrap();
    // The first event follows a long way without any.
    interface.next(10.0).unwrap();
    let (begun, mut events, mut cells) = (ProcessTime::now(), 0, 0);
    while events < 20 && begun.elapsed().as_secs_f64() < 60.0 {
        for (event, _) in interface.next(10.0).unwrap() {
            (events, cells) = (events + 1, cells + event.cells);
        }
    }
    let time = 1e3 * begun.elapsed().as_secs_f64() / f64::from(events);
    let mean = cells as f64 / f64::from(events);
    println!("{name:<22} {number:>8} {events:>8} {mean:>14.1} {time:>16.2}");
}
