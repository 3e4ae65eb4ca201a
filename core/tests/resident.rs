//! What large ensembles, blocks, lattices and interfaces take of memory, as the system sees it.
//!
//! Each is made by a process of its own: what a process has taken it may keep.
#![cfg(target_os = "linux")]

mod common;

use std::ops::ControlFlow;
use std::process::Command;

use asperity::Error;
use asperity::block::{Block, Drive, Loading, Slip};
use asperity::contacts::Contacts;
use asperity::elastic::coupling::{SlidingDirection, half_space};
use asperity::elastic::{self, InterfaceParameters};
use asperity::ensemble::lattice::{Lattice, LatticeCoupling, Until};
use asperity::ensemble::{Disorder, Ensemble, Snapshots};
use asperity::monitor::Monitor;
use asperity::scenario;
use asperity::shape::{Edges, Shape};
use common::sliders::{interface, scales, setting};
use common::{contacts, curve, gaussian, initial, point};

/// What takes more than it is refused for is refused wrongly.
const MOST: f64 = 1.2;
/// Bytes from which on what a process takes besides does not matter: 4 MB.
const LARGE: f64 = 1e8;

/// The name of what a process of this test is to make.
const OBJECT: &str = "ASPERITY_OBJECT";

/// Bytes of memory.
struct Limited(u64);

impl Monitor for Limited {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn memory(&self) -> u64 {
        self.0
    }
}

type Made = asperity::Result<()>;

fn ensemble(size: usize) -> Ensemble {
    let contacts = contacts(&gaussian(1.0, 0.1), &point(0.0));
    Ensemble::new(contacts, initial(&point(0.0)), size, 1, Disorder::Annealed).unwrap()
}

fn pull(monitor: &mut dyn Monitor) -> Made {
    let positions: Vec<f64> = (0..5_000_000).map(|i| 4e-7 * f64::from(i)).collect();
    ensemble(500).pull_with(&positions, &Snapshots::default(), monitor).map(drop)
}

fn block(monitor: &mut dyn Monitor) -> Made {
    let mut population = ensemble(2_000_000).population_with(monitor)?;
    let block = Block::new(Loading::Spring(0.2), Slip::Overdamped, Some(0.01))?;
    let drive = Drive { turning_points: vec![3.0], points: 11 };
    block.pull_with(&mut population, &drive, monitor).map(drop)
}

fn lattice(monitor: &mut dyn Monitor) -> Made {
    let coupling = LatticeCoupling::with_alpha(Shape::Square([1536; 2]), Edges::Periodic, 0.2);
    let size = coupling.shape.size() as f64;
    let contacts = Contacts { count: size, ..contacts(&gaussian(1.0, 0.1), &point(0.0)) };
    let start = initial(&point(0.0));
    let mut lattice = Lattice::new_with(contacts, start, &coupling, 1, Disorder::Annealed, monitor)?;
    lattice.run_with(Until::Drive(0.9), monitor, &mut |_| ())
}

fn cells(monitor: &mut dyn Monitor) -> Made {
    const SIDE: usize = 1024;
    let (shape, stiffness) = (Shape::Square([SIDE; 2]), 3.0);
    let table = scenario::Interface {
        cells: vec![SIDE; 2],
        contacts: scenario::PerCell::Many,
        connection: 0.5,
        coupling: scenario::Elasticity::HalfSpace {
            modulus: stiffness,
            cell: 1.0,
            poisson_ratio: 0.0,
            sliding: SlidingDirection::default(),
        },
        edges: Edges::Periodic,
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
    };
    table.fits(&contacts(&point(1.0), &point(0.0)), None, false, monitor.memory())?;
    let setting =
        InterfaceParameters { viscosity: None, ..setting(0.5, elastic::CellSlip::Overdamped, 1e-3) };
    let slider = half_space(shape, Edges::Periodic, stiffness, 1.0)?;
    let curve = curve::gaussian(0.1);
    let mut interface = interface(&curve, Some(scales(shape.size(), 0.03)), slider, setting);
    // All of them slide.
    interface.put(3.2, &vec![0.0; shape.size()])?;
    interface.next_with(3.2, monitor).map(drop)
}

type Make = fn(&mut dyn Monitor) -> Made;

const OBJECTS: [(&str, Make); 4] =
    [("pull", pull), ("block", block), ("lattice", lattice), ("interface", cells)];

/// Not a test by itself: makes what it is asked to, and prints the most memory that this process has had.
#[test]
#[ignore = "a process of the other test"]
fn one_object() {
    let name = std::env::var(OBJECT).expect("the name of an object");
    let (_, make) = OBJECTS.iter().find(|object| object.0 == name).expect("a known object");
    make(&mut Limited(u64::MAX)).unwrap();
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    println!("peak {}", line.split_whitespace().nth(1).unwrap());
}

#[test]
fn no_process_takes_more_than_it_is_refused_for() {
    for (name, make) in OBJECTS {
        let Err(Error::TooLarge { needed, .. }) = make(&mut Limited(0)) else { panic!("{name}") };
        let needed = needed as f64;
        assert!(needed > LARGE, "{name}: {needed} bytes are few");
        let mut alone = Command::new(std::env::current_exe().unwrap());
        alone.args(["--exact", "one_object", "--ignored", "--nocapture"]).env(OBJECT, name);
        let output = alone.output().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        let peak = said.lines().find_map(|line| line.split("peak ").nth(1));
        let peak = 1024.0 * peak.unwrap_or_else(|| panic!("{name}: {said}")).trim().parse::<f64>().unwrap();
        println!("{name}: {peak} of {needed} bytes, {:.2}", peak / needed);
        assert!(peak <= MOST * needed, "{name}: {peak} instead of {needed} bytes");
        assert!(peak > 0.2 * needed, "{name}: {peak} of {needed} bytes: the estimate is of no use");
    }
}
