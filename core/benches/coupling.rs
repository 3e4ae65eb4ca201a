//! Cost of elastic coupling per cell, on one thread: forces of all cells and solutions: a table.

#![allow(missing_docs)]

use std::time::Instant;

use asperity::elastic::coupling::{Coupling, half_space, neighbours};
use asperity::shape::{Edges, Shape};
use cpu_time::ThreadTime;

/// Cells that each operation goes over, at least.
const CELLS: usize = 1 << 22;

fn main() {
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    single.install(table);
}

fn table() {
    println!(
        "{:<26} {:>9} {:>14} {:>14} {:>14} {:>9} {:>9}",
        "coupling", "cells", "forces, ns/cell", "10⁸ cells/s", "solve, ns/cell", "made, s", "B/cell"
    );
    for edges in [Edges::Open, Edges::Periodic] {
        let chain = Shape::Chain(1 << 20);
        row("neighbours, chain", edges, chain, &|| neighbours(chain, edges, 1.0).unwrap());
        row("half-space, chain", edges, chain, &|| half_space(chain, edges, 1.0, 1.0).unwrap());
        for side in [256, 1000, 1024, 4096] {
            let shape = Shape::Square([side; 2]);
            row("neighbours", edges, shape, &|| neighbours(shape, edges, 1.0).unwrap());
            if edges == Edges::Periodic || side < 4096 {
                row("half-space", edges, shape, &|| half_space(shape, edges, 1.0, 1.0).unwrap());
            }
        }
    }
}

fn row(name: &str, edges: Edges, shape: Shape, make: &dyn Fn() -> Box<dyn Coupling>) {
    let before = memory();
    let begun = Instant::now();
    let mut coupling = make();
    let made = begun.elapsed().as_secs_f64();
    let size = shape.size();
    let displacements: Vec<f64> = (0..size).map(|j| (0.37 * j as f64).sin()).collect();
    let mut forces = vec![0.0; size];
    let turns = (CELLS / size).max(1);
    coupling.forces(&displacements, &mut forces, &mut ()).unwrap();
    let bytes = bytes_per_cell(memory() - before, size);
    let whole = time(turns, || coupling.forces(&displacements, &mut forces, &mut ()).unwrap());
    let solve = time(turns.div_ceil(4), || {
        forces.copy_from_slice(&displacements);
        coupling.solve_uniform(0.3, &mut forces, &mut ()).unwrap();
    });
    let name = format!("{name}, {}", if edges == Edges::Open { "open" } else { "periodic" });
    let [whole, solve] = [whole, solve].map(|time| 1e9 * time / size as f64);
    println!(
        "{name:<26} {size:>9} {whole:>15.2} {:>14.2} {solve:>14.2} {made:>9.3} {bytes:>9}",
        10.0 / whole
    );
}

/// Seconds per turn, of the fastest of five.
fn time(turns: usize, mut turn: impl FnMut()) -> f64 {
    let best = (0..5).map(|_| {
        let begun = ThreadTime::now();
        (0..turns).for_each(|_| turn());
        begun.elapsed().as_secs_f64() / turns as f64
    });
    best.fold(f64::INFINITY, f64::min)
}

/// What a coupling takes of what is held more than before, two numbers per cell being the bench's own; reported for large ones
/// alone, whose memory is no longer held when they are gone.
fn bytes_per_cell(more: f64, size: usize) -> String {
    if size < 1 << 24 { "–".into() } else { format!("{:.1}", more / size as f64 - 16.0) }
}

/// Bytes that this process holds; 0 where the system does not report it.
fn memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmRSS")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|kb| kb.parse().ok()).map_or(0.0, |kb: f64| 1024.0 * kb)
}
