//! Cost of a step of a deformable interface and of its events, by coupling and size: tables.

#![allow(missing_docs)]

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Start};
use asperity::elastic::cells::Cells;
use asperity::elastic::coupling::{half_space, neighbours};
use asperity::elastic::{CellLoading, CellSlip, Coupling, Curves, Interface, InterfaceParameters};
use asperity::law::{Gaussian, Point};
use asperity::master::{MasterEquation, MasterPopulation};
use asperity::random::{Purpose, Stream};
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
        row("neighbours", neighbours(shape, Edges::Periodic, 1.0).unwrap());
        row("half-space", half_space(shape, Edges::Periodic, 1.0, 1.0).unwrap());
    }
    row("half-space", half_space(Shape::Square([1024; 2]), Edges::Periodic, 1.0, 1.0).unwrap());
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
        let springs = rate(&mut || springs.forces(&positions, &mut pulls));
        let contacts = rate(&mut || {
            cells.residual(&positions, &mut pulls, &mut slopes).unwrap();
        });
        println!("cell updates per second and core: springs {springs:.2e}, contacts {contacts:.2e}");
    });
}

/// Events from a start on, until there have been some, or slides have taken long.
fn row(name: &str, coupling: Box<dyn Coupling>) {
    let number = coupling.shape().size();
    let setting = InterfaceParameters {
        connection: 0.5,
        loading: CellLoading::Uniform,
        slip: CellSlip::Overdamped,
        viscosity: None,
        drive_tolerance: 1e-6,
        area: None,
    };
    let mut interface = Interface::new(Box::new(disordered(number)), coupling, setting).unwrap();
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
