//! Cost of a break of contacts coupled one by one, by coupling, laws and number: a table.

#![allow(missing_docs)]

use std::sync::Arc;

use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Start, Temperature};
use asperity::ensemble::Disorder;
use asperity::ensemble::lattice::{Edges, Lattice, LatticeCoupling, Shape, Until};
use asperity::law::{Gaussian, Point, Rectangular, SharedLaw};
use cpu_time::ThreadTime;

/// Breaks timed, and those before, if each contact breaks so often too.
const BREAKS: u64 = 4_000_000;

/// Breaks of a contact before.
const SETTLED: u64 = 5;

fn main() {
    println!(
        "{:<28} {:>6} {:>6} {:>10} {:>12} {:>14} {:>16}",
        "thresholds", "L", "α", "mean size", "break, ns", "avalanche, ns", "10⁶ breaks/s"
    );
    let identical: SharedLaw = Arc::new(Point::new(1.0).unwrap());
    let gaussian: SharedLaw = Arc::new(Gaussian::new(1.0, 0.1).unwrap());
    for share in [0.2, 0.25] {
        for side in [64, 512, 2048] {
            row("identical", &identical, side, share);
        }
        row("Gaussian, c.v. 0.1", &gaussian, 512, share);
    }
    row("Gaussian, c.v. 0.1, uncoupled", &gaussian, 512, 0.0);
    for (name, barrier, ageing) in in_time() {
        for share in [0.2, 0.24] {
            let mut contacts = Contacts::new(gaussian.clone(), Arc::new(Point::new(0.0).unwrap()));
            contacts.rules.temperature =
                barrier.map(|b| Temperature { barrier: b, ..Temperature::new(0.02, 1.0) });
            contacts.rules.ageing = ageing.clone();
            let coupling = LatticeCoupling::with_alpha(Shape::Square([512, 512]), Edges::Open, share);
            let lattice = Lattice::at(contacts, initial(), &coupling, 0.01, 1, Disorder::Annealed).unwrap();
            timed(name, lattice, (512, share));
        }
    }
}

/// Rules of contacts in time.
fn in_time() -> Vec<(&'static str, Option<Barrier>, Option<Ageing>)> {
    let logarithmic = Ageing::Logarithmic { growth: 0.02, time: 1.0 };
    let mature = Arc::new(Gaussian::new(1.2, 0.1).unwrap());
    vec![
        ("elastic barrier", Some(Barrier::Elastic), None),
        ("Bell's barrier", Some(Barrier::Bell), None),
        ("barrier of a catastrophe", Some(Barrier::Catastrophe), None),
        ("logarithmic ageing", None, Some(logarithmic.clone())),
        ("the same, elastic barrier", Some(Barrier::Elastic), Some(logarithmic)),
        (
            "frozen_rank, elastic barrier",
            Some(Barrier::Elastic),
            Some(Ageing::FrozenRank { mature, time: 1.0 }),
        ),
    ]
}

fn initial() -> Initial {
    Initial { law: Arc::new(Rectangular::new(0.0, 0.6).unwrap()), start: Start::Conditional }
}

fn row(name: &str, thresholds: &SharedLaw, side: usize, share: f64) {
    let contacts = Contacts::new(thresholds.clone(), Arc::new(Point::new(0.0).unwrap()));
    let coupling = LatticeCoupling::with_alpha(Shape::Square([side, side]), Edges::Open, share);
    timed(name, Lattice::new(contacts, initial(), &coupling, 1, Disorder::Annealed).unwrap(), (side, share));
}

fn timed(name: &str, mut lattice: Lattice, (side, share): (usize, f64)) {
    breaks(&mut lattice, SETTLED * (side * side) as u64);
    let begun = ThreadTime::now();
    let (size, events) = breaks(&mut lattice, BREAKS.max((side * side) as u64));
    let time = 1e9 * begun.elapsed().as_secs_f64();
    let (of_break, of_event) = (time / size as f64, time / events as f64);
    let mean = size as f64 / events as f64;
    println!(
        "{name:<28} {side:>6} {share:>6} {mean:>10.2} {of_break:>12.1} {of_event:>14.1} {:>16.1}",
        1e3 / of_break
    );
}

/// Avalanches until there have been so many breaks: breaks, avalanches.
fn breaks(lattice: &mut Lattice, breaks: u64) -> (u64, u64) {
    let (mut size, mut events) = (0, 0);
    while size < breaks {
        let mut add = |avalanche: &asperity::ensemble::lattice::Avalanche| size += avalanche.size;
        lattice.run(Until::Events(1 << 10), &mut add).unwrap();
        events += 1 << 10;
    }
    (size, events)
}
