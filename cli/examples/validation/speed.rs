//! What time-dependent contacts cost: kinetic friction, velocity steps, threads, and diffusion cell by cell.

use std::hint::black_box;
use std::time::Instant;

use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Start};
use asperity::history::{History, Piece};
use asperity::master::{MasterEquation, Transport};
use asperity::numerics::diffusion::{Coefficients, MovingBoundary, MovingGrid, Potential, Workspace};
use cpu_time::ThreadTime;

use crate::page::{Page, small};
use crate::ways::{ageing, contacts, thermal};
use crate::{gaussian, point};

const REPEATS: usize = 5;

/// The section, which holds nothing but times.
pub fn section(mut page: Page) -> Page {
    page.text(
        "
## Cost of time dependence

Medians of 5. *Curve*: $F_k$ at 61 velocities over 6 decades to 1e-8, thresholds G(1, 0.1), k x̄²/2T = 10. *Steady*: $F_k$ of
diffusing thresholds at v = 0.1 to 1e-5. *Step*: these from steady sliding at v = 1 to a tenth of it, over 1.7 mean thresholds,
to 1e-4. *Threads* are wall-clock times; all others are CPU seconds.
",
    );
    page.head(&["what", "required", "measured"]);
    let row = |page: &mut Page, what: &str, asked: &str, found: String| {
        page.timed_row(&[what.into(), asked.into(), found]);
    };
    for (name, barrier) in
        [("elastic", Barrier::Elastic), ("bell", Barrier::Bell), ("catastrophe", Barrier::Catastrophe)]
    {
        let warm = contacts(gaussian(1.0, 0.1), thermal(barrier, 0.05));
        let time = median(|| cpu(|| curve(&warm)));
        row(&mut page, &format!("curve, {name} barrier"), "0.2 s", format!("{time:.3} s"));
    }
    row(&mut page, "steady", "1 s", format!("{:.2} s", median(|| cpu(steady))));
    let [one, two] = [1, 2].map(|threads| median(|| step(threads)));
    row(&mut page, "step, one thread", "3 s", format!("{one:.2} s"));
    row(&mut page, "step, threads: 2 against 1", "1.7 ×", format!("{:.2} ×", one / two));
    row(&mut page, "cells per second, diffusion step", "–", small(median(cells)));
    row(&mut page, "cells per second at memory bandwidth", "–", small(median(memory)));
    page.end();
    page
}

fn median(measure: impl Fn() -> f64) -> f64 {
    let mut values: Vec<f64> = (0..REPEATS).map(|_| measure()).collect();
    values.sort_by(f64::total_cmp);
    values[REPEATS / 2]
}

fn cpu(work: impl FnOnce()) -> f64 {
    let begun = ThreadTime::now();
    work();
    begun.elapsed().as_secs_f64()
}

fn kinetic_friction(contacts: &Contacts, velocity: f64) {
    let initial = Initial { law: point(0.0), start: Start::Conditional };
    let equation = MasterEquation::at(contacts.clone(), &initial, velocity).expect("a velocity above 0");
    black_box(equation.steady_state().kinetic_friction());
}

fn curve(contacts: &Contacts) {
    (0..=60).for_each(|k| kinetic_friction(contacts, 10.0_f64.powf(0.1 * f64::from(k) - 6.0)));
}

fn diffusing() -> Contacts {
    let mature = gaussian(1.0, 0.05);
    contacts(gaussian(0.5, 0.1), ageing(Ageing::Smoluchowski { mature, diffusion: 0.0025 }))
}

fn steady() {
    kinetic_friction(&diffusing(), 0.1);
}

/// Clock seconds of a velocity step on a number of threads.
fn step(threads: usize) -> f64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let piece = |velocity: f64, distance: f64| Piece { velocity, duration: distance / velocity };
    let history = History::new(vec![piece(1.0, 0.2), piece(0.1, 1.5)]).expect("velocities above 0");
    let times: Vec<f64> = (0..=100).map(|k| f64::from(k) / 100.0 * history.duration()).collect();
    let begun = Instant::now();
    let followed = pool.install(|| {
        let transport = Transport::steady_with(&diffusing(), 1.0, 1e-4, &mut ());
        transport.and_then(|mut transport| transport.follow(&history, &times))
    });
    black_box(followed.expect("a way at this tolerance"));
    begun.elapsed().as_secs_f64()
}

/// Cells a second of a step of diffusion, in cache.
fn cells() -> f64 {
    const CELLS: usize = 700;
    const ROUNDS: usize = 20_000;
    let potential = Potential::of(|h| (-0.5 * ((h - 1.0) / 0.05_f64).powi(2)).exp(), (0.0, 1.4), 8192);
    let medium = Coefficients { potential: &potential, diffusion: 0.0025, sink: None };
    let (cells, mut room) = (MovingGrid::new(CELLS, 0.05), Workspace::default());
    let rise = MovingBoundary { floor: (0.2, 0.203), ceiling: 1.4, duration: 0.01, absorbing: true };
    let mut masses = vec![1.0 / CELLS as f64; CELLS];
    let seconds = cpu(|| {
        for _ in 0..ROUNDS {
            cells.advance(&rise, &medium, &mut masses, &mut room);
        }
    });
    black_box(masses);
    (ROUNDS * CELLS) as f64 / seconds
}

/// Cells of 16 bytes, read and written, that memory can feed a second.
fn memory() -> f64 {
    let (from, mut to) = (vec![1.0_f64; 1 << 25], vec![0.5_f64; 1 << 25]);
    let seconds = cpu(|| to.copy_from_slice(black_box(&from)));
    black_box(&to).len() as f64 / seconds
}
