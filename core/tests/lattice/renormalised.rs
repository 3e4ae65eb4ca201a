//! Thresholds renormalised by the coupling of contacts, against the master equation and contacts one by one.

use std::ops::ControlFlow;

use crate::common::pulled::{near, pull};
use crate::common::{contacts, gaussian, initial, master, mixture, point, together};
use asperity::Error;
use asperity::block::{Block, Drive, Loading, Slip};
use asperity::elastic::coupling::neighbours;
use asperity::elastic::{self, CellLoading, Cells, Curves, Interface, InterfaceParameters, Populations};
use asperity::ensemble::Disorder;
use asperity::ensemble::lattice::{Edges, Lattice, LatticeCoupling, Shape, Until};
use asperity::first_breaks::FirstBreaks;
use asperity::law::{Law, Renormalised, SharedLaw, critical_coupling};
use asperity::monitor::Monitor;
use asperity::numerics::legendre::RULE;
use asperity::population::Population;

const SEED: u64 = 11;

fn renormalised(thresholds: &SharedLaw, coupling: f64) -> Renormalised {
    Renormalised::new(thresholds.clone(), coupling).unwrap()
}

/// κ = N⟨k⟩/(K + N⟨k⟩) of a slider of stiffness K under which N⟨k⟩ = 1.
fn coupling(stiffness: f64) -> f64 {
    1.0 / (stiffness + 1.0)
}

/// A slider is unstable where the coupling that it makes is critical, as long as F is that of the first cycle: for
/// σ ≤ 0.1 to what second breaks make of it, 1e-9; not for σ = 0.2.
#[test]
fn critical_couplings_are_critical_stiffnesses() {
    for std in [0.02, 0.05, 0.1] {
        let thresholds = gaussian(1.0, std);
        let pull = master(&thresholds, &point(0.0), &point(0.0)).pull_with(3.0, 1e-12, &mut ()).unwrap();
        let critical = critical_coupling(thresholds.as_ref());
        let off = critical / coupling(pull.critical_stiffness()) - 1.0;
        assert!(off.abs() < 1e-9, "{std} {critical} {off:e}");
    }
    let wide = gaussian(1.0, 0.2);
    let pull = master(&wide, &point(0.0), &point(0.0)).pull_with(3.0, 1e-12, &mut ()).unwrap();
    // Printed to four digits.
    assert!((critical_coupling(wide.as_ref()).recip() - 1.0 - 1.0335).abs() < 5e-5);
    assert!((pull.critical_stiffness() - 1.0358).abs() < 5e-5);
}

/// Up to where second breaks are felt the slider's position, its top at X/(1 − κ), is the true stretch x(X), and its force
/// what is left of that when every break has taken its stretch from it, x − (x − X)/κ.
#[test]
fn the_force_at_the_true_stretch_is_that_under_a_spring() {
    // Second breaks: at x = 1.3, (x − 2x̄)/√2σ = −4.9 and −9.9 of a standard Gaussian.
    for (std, stiffness, within) in [(0.1, 5.0, 1e-6), (0.1, 9.0, 1e-6), (0.05, 9.0, 1e-10)] {
        let (thresholds, relaxed) = (gaussian(1.0, std), point(0.0));
        let mut population = master(&thresholds, &relaxed, &relaxed).population_with(1e-12, &mut ()).unwrap();
        let share = coupling(stiffness);
        let law = renormalised(&thresholds, share);
        let run = pull(&mut population, stiffness, Slip::Overdamped, &[1.3]);
        assert!(run.events.is_empty() && run.trace.len() > 100);
        for point in run.trace {
            let drive = (1.0 - share) * point.drive;
            let stretch = law.stretch(drive);
            near(stretch, point.position, within);
            near(stretch - (stretch - drive) / share, point.force, within / share);
        }
    }
}

/// The mass and the mean of the density itself, close to where it becomes infinite.
#[test]
fn the_density_near_the_critical_coupling() {
    let thresholds = gaussian(1.0, 0.1);
    let critical = critical_coupling(thresholds.as_ref());
    for near in [0.9, 0.99, 0.999] {
        let law = renormalised(&thresholds, near * critical);
        let mut ends: Vec<f64> = law.zones().iter().flat_map(|zone| [zone.low, zone.high]).collect();
        ends.sort_by(f64::total_cmp);
        let integral = |g: &dyn Fn(f64) -> f64| -> f64 {
            ends.windows(2).map(|w| (w[0], w[1])).map(|(a, b)| panels(a, b, |x| g(x) * law.density(x))).sum()
        };
        // Roundings of x, over the slope 1 − κ/κ_c of X(x).
        let tolerance = 1e-13 / (1.0 - near);
        assert!((integral(&|_| 1.0) - 1.0).abs() < tolerance, "{near}: {:e}", integral(&|_| 1.0) - 1.0);
        assert!((integral(&|x| x) - law.mean()).abs() < tolerance);
        let variance = integral(&|x| (x - law.mean()).powi(2));
        assert!((variance.sqrt() - law.std()).abs() < tolerance);
    }
}

fn panels(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let at = |i: u32| a + (b - a) * f64::from(i) / 12.0;
    (0..12).map(|i| RULE.integrate(at(i), at(i + 1), &f)).sum()
}

/// Contacts one by one, all to all: the renormalised law within what their number allows.
#[test]
fn contacts_under_one_slider_have_the_renormalised_law() {
    const SIZE: usize = 40_000;
    // Kolmogorov: P(√n D > 2.69) = 1e-6. Thresholds scatter as if free; the drive's own scatter, of what has broken,
    // keeps the share at a given X as uncertain as that of free contacts, over 1 − κxP_c, at most 5.
    for (std, share) in [(0.1, 0.0), (0.1, 0.1), (0.1, 0.2), (0.05, 0.1)] {
        let thresholds = gaussian(1.0, std);
        let breaks = together::first_breaks(&thresholds, share, SIZE, SEED);
        let law = renormalised(&thresholds, share);
        let limit = 2.69 / (1.0 - share / critical_coupling(thresholds.as_ref())) / (SIZE as f64).sqrt();
        let distance = breaks.distance(&law);
        assert!(distance < limit, "{std} {share} {distance} {limit}");
    }
}

const SIDE: usize = 24;

/// Contacts on a lattice, a share of what each lets go going to each of its four neighbours.
fn lattice(thresholds: &SharedLaw, side: usize, share: f64) -> Lattice {
    let coupling = LatticeCoupling::with_alpha(Shape::Square([side; 2]), Edges::Periodic, share);
    let contacts = contacts(thresholds, &point(0.0));
    Lattice::new(contacts, initial(&point(0.0)), &coupling, SEED, Disorder::Annealed).unwrap()
}

/// Contacts that break once, found by looking at all of them time and again; `thresholds` along rows.
fn looked_at(thresholds: &[f64], share: f64) -> Vec<f64> {
    let (mut gains, mut first) = (vec![0.0; SIDE * SIDE], vec![f64::INFINITY; SIDE * SIDE]);
    let mut drive = 0.0_f64;
    while first.contains(&f64::INFINITY) {
        let unbroken = |i: &usize| first[*i] == f64::INFINITY;
        let ends = (0..SIDE * SIDE).filter(unbroken).map(|i| thresholds[i] - gains[i]);
        drive = ends.fold(f64::INFINITY, f64::min).max(drive);
        let front: Vec<usize> =
            (0..SIDE * SIDE).filter(unbroken).filter(|&i| thresholds[i] - gains[i] <= drive).collect();
        let released: Vec<f64> = front.iter().map(|&i| drive + gains[i]).collect();
        for (&i, released) in front.iter().zip(released) {
            first[i] = drive;
            let (row, column) = (i / SIDE, i % SIDE);
            for (down, right) in [(1, 0), (SIDE - 1, 0), (0, 1), (0, SIDE - 1)] {
                gains[(row + down) % SIDE * SIDE + (column + right) % SIDE] += share * released;
            }
        }
    }
    first
}

/// Contacts of narrow thresholds break a second time only when all have broken once. Uncoupled ones show their thresholds.
#[test]
fn first_breaks_are_those_found_by_looking_at_all_contacts() {
    let narrow = gaussian(1.0, 0.05);
    let first = |share: f64| lattice(&narrow, SIDE, share).first_breaks(&mut ()).unwrap();
    let thresholds = first(0.0);
    for share in [0.01, 0.05, 0.2] {
        let expected = looked_at(&thresholds, share);
        assert!(first(share).iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-13), "{share}");
    }
}

/// Of contacts coupled to few others the law is close to the mean field's where the share is small; each of the four has
/// broken or has not, which scatters.
#[test]
fn neighbours_make_nearly_the_renormalised_law() {
    let thresholds = gaussian(1.0, 0.1);
    let breaks =
        |share| FirstBreaks::of_contacts(&lattice(&thresholds, 300, share).first_breaks(&mut ()).unwrap());
    // Kolmogorov, as above.
    assert!(breaks(0.0).distance(thresholds.as_ref()) < 2.69 / 300.0);
    for (share, expected) in [(0.0125, 0.1), (0.025, 0.2)] {
        let (breaks, law) = (breaks(share), renormalised(&thresholds, 4.0 * share));
        // Of the way from uncoupled contacts to the mean field; what is missing is in proportion to the share.
        assert!(breaks.distance(&law) < expected * breaks.distance(thresholds.as_ref()));
        assert!(breaks.std() > law.std() && breaks.mean() > law.mean());
    }
}

/// Force per contact at each of the drives X = (1 − κ) X_T, by a block of the stiffness K = (1 − κ)/κ per contact.
fn mean_field(thresholds: &SharedLaw, coupling: f64, drives: &[f64]) -> Vec<f64> {
    let mut population =
        master(thresholds, &point(0.0), &point(0.0)).population_with(1e-10, &mut ()).unwrap();
    let last = drives[drives.len() - 1] / (1.0 - coupling);
    let block = Block::new(Loading::Spring((1.0 - coupling) / coupling), Slip::Overdamped, None).unwrap();
    let run =
        block.pull(&mut population, &Drive { turning_points: vec![last], points: drives.len() + 1 }).unwrap();
    // The drives are points of the trace, so that nothing is interpolated; of two at a slip the one after it.
    let at = |drive: &f64| {
        let mut here = run.trace.iter().filter(|point| ((1.0 - coupling) * point.drive - drive).abs() < 1e-9);
        here.next_back().expect("a point of the trace").force
    };
    drives.iter().map(at).collect()
}

fn drives() -> Vec<f64> {
    (1..=80).map(|i| 0.1 * f64::from(i)).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// Mean field for the whole pull, below and above the critical coupling: a block is what contacts do that stretch all others.
#[test]
fn contacts_that_stretch_all_others_are_those_under_a_block() {
    const SIZE: usize = 40_000;
    for (std, coupling) in [(0.15, 1.0 / 7.0), (0.1, 0.05), (0.1, 0.4)] {
        let thresholds = gaussian(1.0, std);
        let found = together::forces(&thresholds, coupling, SIZE, &drives());
        let off = largest_difference(&found, &mean_field(&thresholds, coupling, &drives()));
        // Stretches scatter by 0.29 in steady sliding and at most by 0.5 about their mean: five standard errors of the latter.
        let limit = 2.5 / (SIZE as f64).sqrt();
        assert!(off < limit, "{std} {coupling} {off} {limit}");
    }
}

/// On a square lattice mean field holds for weak coupling, for the whole pull; the renormalised distribution does not describe
/// it as that of independent contacts.
#[test]
fn contacts_on_a_lattice_are_nearly_those_under_a_block() {
    // Of the strongest force: neighbours are few, and their number that has broken scatters.
    for (std, coupling, within) in [(0.15, 1.0 / 7.0, 0.04), (0.1, 0.05, 0.012)] {
        let thresholds = gaussian(1.0, std);
        let mut lattice = lattice(&thresholds, 400, coupling / 4.0);
        let force = |drive: &f64| {
            lattice.run(Until::Drive(*drive), &mut |_| ()).unwrap();
            lattice.force()
        };
        let found: Vec<f64> = drives().iter().map(force).collect();
        let strongest = found.iter().copied().fold(0.0, f64::max);
        let block = largest_difference(&found, &mean_field(&thresholds, coupling, &drives())) / strongest;
        let law: SharedLaw = std::sync::Arc::new(renormalised(&thresholds, coupling));
        let pull = master(&law, &point(0.0), &point(0.0)).pull(8.0).unwrap();
        let alone: Vec<f64> = drives().iter().map(|&drive| pull.force(drive)).collect();
        let alone = largest_difference(&found, &alone) / strongest;
        assert!(block < within, "{std} {coupling} {block}");
        assert!(alone > 5.0 * block, "{std} {coupling} {alone} {block}");
    }
}

/// How cells are driven that gain a `share` of what their contacts lose.
fn setting(share: f64, slip: elastic::CellSlip) -> InterfaceParameters {
    let connection = 1.0 / share - 1.0;
    let (loading, viscosity) = (CellLoading::Uniform, None);
    InterfaceParameters { connection, loading, slip, viscosity, drive_tolerance: 1e-12, area: None }
}

/// A chain of cells on springs.
fn chain(cells: Box<dyn Cells>, springs: f64, setting: InterfaceParameters) -> Interface {
    let springs = neighbours(Shape::Chain(cells.len()), Edges::Open, springs).unwrap();
    Interface::new(cells, springs, setting).unwrap()
}

/// Cells of many contacts, as many as scales.
fn curves(std: f64, scales: &[f64]) -> Curves {
    let population =
        master(&gaussian(1.0, std), &point(0.0), &point(0.0)).population_with(1e-12, &mut ()).unwrap();
    Curves::new(&population, scales.len()).unwrap().scaled(scales.to_vec()).unwrap()
}

/// Their law of first breaks.
fn breaks(std: f64, scales: &[f64], springs: f64, share: f64, slip: elastic::CellSlip) -> FirstBreaks {
    let mut chain = chain(Box::new(curves(std, scales)), springs, setting(share, slip));
    chain.first_breaks(gaussian(1.0, std).as_ref(), share, &mut ()).unwrap()
}

/// Cells of many contacts are mean field, whatever couples them, if all are alike; so are unlike ones that move as one.
#[test]
fn cells_that_move_alike_have_the_renormalised_law() {
    let thresholds = gaussian(1.0, 0.05);
    for slip in [elastic::CellSlip::Overdamped, elastic::CellSlip::Reset] {
        for number in [1, 5] {
            let law = renormalised(&thresholds, 0.1);
            let breaks = breaks(0.05, &vec![1.0; number], 0.7, 0.1, slip);
            // Roundings of balance, over the slope of X(x).
            assert!(breaks.distance(&law) < 1e-9, "{}", breaks.distance(&law));
            // Of the mean, by the trapezoidal rule, what is left at the end: 1e-6 of the contacts, 4.75 σ from it.
            assert!((breaks.mean() - law.mean()).abs() < 5e-7 && (breaks.std() - law.std()).abs() < 1e-5);
        }
    }
    let scales = [0.95, 1.0, 1.08, 1.02];
    let parts = scales.map(|scale| (0.25, gaussian(scale, 0.05 * scale)));
    let law = renormalised(&mixture(&parts), 0.1);
    // Cells differ by some 1e-7 where stiffnesses are as 1 to 10⁶.
    let breaks = breaks(0.05, &scales, 1e6, 0.1, elastic::CellSlip::Overdamped);
    assert!(breaks.distance(&law) < 1e-5, "{}", breaks.distance(&law));
    assert!((breaks.mean() - law.mean()).abs() < 1e-5 && (breaks.std() - law.std()).abs() < 1e-5);
}

/// Cells that next to nothing couples have each its own renormalised law, of scale s.
#[test]
fn cells_on_their_own_have_their_own_renormalised_laws() {
    let scales = [0.9, 1.0, 1.15];
    let law = renormalised(&gaussian(1.0, 0.05), 0.1);
    let breaks = breaks(0.05, &scales, 1e-9, 0.1, elastic::CellSlip::Overdamped);
    let mean = scales.iter().sum::<f64>() / 3.0;
    assert!((breaks.mean() - mean * law.mean()).abs() < 1e-6);
    for drive in [0.8, 0.87, 0.93, 1.0, 1.08, 1.2] {
        let expected = scales.iter().map(|scale| law.cumulative(drive / scale)).sum::<f64>() / 3.0;
        // Chords of 1/40 of σ.
        assert!((breaks.fraction(drive) - expected).abs() < 1e-3, "{drive}");
    }
}

/// Where the coupling is critical cells slide: upright, to where they are in balance again, or to where none is unbroken.
#[test]
fn slides_are_upright() {
    let (thresholds, share) = (gaussian(1.0, 0.05), 0.3);
    let mut alone = master(&thresholds, &point(0.0), &point(0.0)).population_with(1e-12, &mut ()).unwrap();
    let run = pull(&mut alone, 1.0 / share - 1.0, Slip::Overdamped, &[1.5]);
    let slip = run.events[0];
    let drive = (1.0 - share) * slip.before.drive;
    for (rule, after) in [
        (elastic::CellSlip::Overdamped, thresholds.cumulative(slip.after.position)),
        (elastic::CellSlip::Reset, 1.0),
    ] {
        let breaks = breaks(0.05, &[1.0; 3], 0.7, share, rule);
        // 1e-9 before balance is lost cells are of the order of its root, 3e-5, from where they lose it.
        near(breaks.fraction(drive - 1e-9), thresholds.cumulative(slip.before.position), 1e-3);
        near(breaks.fraction(drive + 1e-9), after, 1e-6);
    }
}

/// What is stated for cells of a law is refused of others.
#[test]
fn first_breaks_of_cells_need_a_law_and_a_drive_that_pulls_all() {
    let refused = |loading: CellLoading, cells: Box<dyn Cells>| {
        let setting = InterfaceParameters { loading, ..setting(0.1, elastic::CellSlip::Overdamped) };
        let law = gaussian(1.0, 0.05);
        chain(cells, 1.0, setting).first_breaks(law.as_ref(), 0.1, &mut ()).unwrap_err().to_string()
    };
    let edge = refused(CellLoading::Edge, Box::new(curves(0.05, &[1.0; 3])));
    assert!(edge.starts_with("loading: expected a drive that pulls all"), "{edge}");
    let population =
        || master(&gaussian(1.0, 0.05), &point(0.0), &point(0.0)).population_with(1e-10, &mut ()).unwrap();
    let own = (0..3).map(|_| Box::new(population()) as Box<dyn Population>).collect();
    let own = refused(CellLoading::Uniform, Box::new(Populations::new(own, &mut ()).unwrap()));
    assert!(own.starts_with("cells: expected cells that share a curve"), "{own}");
}

/// Who is asked whether to go on hears the share that has broken.
#[test]
fn first_breaks_can_be_stopped() {
    struct Half(f64);
    impl Monitor for Half {
        fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
            self.0 = fraction;
            if fraction < 0.5 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        }
    }
    let (mut lattice, mut half) = (lattice(&gaussian(1.0, 0.1), 100, 0.02), Half(0.0));
    assert_eq!(lattice.first_breaks(&mut half), Err(Error::Stopped));
    assert!((0.5..0.7).contains(&half.0));
}
