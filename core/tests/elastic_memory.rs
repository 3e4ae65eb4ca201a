//! What an interface takes of memory.

mod common;

use asperity::elastic::coupling::half_space;
use asperity::elastic::{CellSlip, InterfaceParameters};
use asperity::shape::{Edges, Shape};
use common::curve::gaussian;
use common::sliders::{interface, scales, setting};
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Most bytes that a lattice takes at once as it is made, in a slide of all cells, and in creep after it.
fn most(side: usize) -> f64 {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let shape = Shape::Square([side; 2]);
    let slider = half_space(shape, Edges::Periodic, 3.0, 1.0).unwrap();
    let stiff = InterfaceParameters { viscosity: None, ..setting(0.5, CellSlip::Overdamped, 1e-3) };
    let scales = scales(shape.size(), 0.03);
    let mut interface = interface(&gaussian(0.1), Some(scales), slider, stiff);
    interface.put(3.2, &vec![0.0; shape.size()]).unwrap();
    let slipped = interface.next(3.2).unwrap().iter().map(|(event, _)| event.cells).sum::<usize>();
    assert_eq!(slipped, shape.size());
    interface.run(3.21, &mut |_, _| ()).unwrap();
    (MEMORY.peak_usage() - before) as f64
}

#[test]
fn cells_under_a_periodic_half_space_take_little() {
    let [small, large] = [64, 256];
    // Each thread has room for some rows besides.
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let more = one.install(|| most(large) - most(small));
    let bytes = more / (large * large - small * small) as f64;
    // 4096² of them in 2 GB.
    assert!(bytes < 2e9 / f64::from(4096 * 4096), "{bytes} for each");
}
