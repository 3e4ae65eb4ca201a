//! The march of the solution through its cells, from break to break.

use super::block::{Blocks, ConvolutionBlock, apply, block, inverted};
use super::kernel::Kernel;
use super::mesh::{Mesh, Run};
use super::{Accuracy, Solution, struck};
use crate::monitor::{Monitor, report};
use crate::numerics::breakpoints::{Atom, Breakpoint, renewed, same_position};
use crate::numerics::legendre::{NODES, Nodal, RULE};
use crate::numerics::piecewise::{Piecewise, tail};
use crate::{Error, Float, Result};

/// The march through the cells.
struct March<'a> {
    source: &'a Kernel,
    kernel: &'a Kernel,
    kept: (&'a Piecewise, &'a Kernel),
    accuracy: Accuracy,
    kept_blocks: Blocks<'a>,
    /// The width that needs no proof.
    base: f64,
    kernel_atoms: Vec<Atom>,
    atoms: Vec<Atom>,
    /// Breaks of g from which cells widen step by step.
    singular: Vec<Breakpoint>,
    mesh: Mesh,
    values: Vec<Nodal>,
    density: Piecewise,
    blocks: Blocks<'a>,
    /// Inverse of identity − kernel on the cell itself, for the run it was made for.
    inverse: Option<(u32, Box<ConvolutionBlock>)>,
    /// That of the kernel of what is kept, on the cell itself.
    kept_inverse: Option<(u32, Box<ConvolutionBlock>)>,
    tail: f64,
    /// The break from which the march is on its way to the next.
    opened: f64,
    /// The end of the cells that double in width from that break.
    graded_to: f64,
}

/// Solves g = source + kernel ∗ g on [0, end].
///
/// `kept` are a source and a kernel with source + kernel ∗ g = 1 (what has not gone into g yet): cells that outgrow the
/// narrow ones are only taken where this holds, so that nothing is stepped over. `onsets` are the
/// breaks of another source and another kernel, which will be convolved with g, at places where `source` and `kernel` are
/// smooth. Cells also end where these make that convolution break.
///
/// # Errors
/// [`Error::Stopped`] by the monitor; [`Error::TooLarge`] for too many atoms; [`Error::Accuracy`] where cells would
/// shrink beyond reason.
pub fn solve(
    source: &Kernel,
    kernel: &Kernel,
    kept: (&Piecewise, &Kernel),
    onsets: [&[Breakpoint]; 2],
    end: f64,
    accuracy: Accuracy,
    monitor: &mut dyn Monitor,
) -> Result<Solution> {
    // Convolution only smooths: what follows a source with a density is no narrower than that.
    let own = source.narrow(accuracy.light);
    let narrow = if source.size() > 1e-3 { own } else { own.min(kernel.narrow(accuracy.light)) };
    let width = (accuracy.widening * narrow).min(end);
    let spacing = width / (2 * NODES) as f64;
    // As of cells: what a break inside one misses is allowed in the density, or in the mass. So many that show in the density
    // that they are refused would cost hours even so.
    let shows_in_density = |b: &Breakpoint| b.weight(spacing) > 10.0 * accuracy.density;
    let matters = |b: &Breakpoint| shows_in_density(b) && b.weight(spacing) * spacing > 10.0 * accuracy.mass;
    renewed(source.breakpoints(), kernel.breakpoints(), end, shows_in_density, monitor)?;
    let breakpoints = renewed(source.breakpoints(), kernel.breakpoints(), end, matters, monitor)?;
    let atoms = breakpoints
        .iter()
        .filter(|b| b.is_atom())
        .map(|b| Atom { position: b.position, weight: b.amplitude });
    let mut march = March {
        source,
        kernel,
        kept,
        kept_blocks: Blocks::new(kept.1, accuracy.density),
        accuracy,
        base: width,
        kernel_atoms: kernel.atoms().collect(),
        atoms: atoms.collect(),
        singular: breakpoints.iter().copied().filter(Breakpoint::is_singular).collect(),
        mesh: Mesh { boundaries: vec![0.0], ..Mesh::default() },
        values: Vec::new(),
        density: Piecewise { boundaries: vec![0.0], coefficients: Vec::new() },
        blocks: Blocks::new(kernel, accuracy.density),
        inverse: None,
        kept_inverse: None,
        tail: 0.0,
        opened: 0.0,
        graded_to: 0.0,
    };
    let shows = |b: &Breakpoint| b.weight(spacing) > 10.0 * accuracy.carried;
    let carried = breakpoints.iter().flat_map(|b| onsets[1].iter().map(|onset| b.convolve(*onset)));
    let further = onsets[0].iter().copied().chain(carried).filter(shows);
    let all = breakpoints.iter().copied().chain(further).map(|b| b.position);
    let mut stops: Vec<f64> = all.filter(|&x| x > 0.0 && x < end).chain([end]).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup_by(|b, a| same_position(*a, *b));
    let mut pace = CellPace { width, patience: 0 };
    for stop in stops {
        march.section(stop, end, &mut pace, monitor)?;
    }
    let March { mesh, values, density, atoms, tail, .. } = march;
    let breakpoints = breakpoints.into_iter().filter(|b| !b.is_atom()).collect();
    Ok(Solution { resolved: accuracy.density, mesh, values, density, atoms, breakpoints, tail })
}

/// The width of cells in use, and how many cells to leave it alone.
struct CellPace {
    width: f64,
    patience: usize,
}

impl CellPace {
    fn halve(&mut self, width: f64) {
        (self.width, self.patience) = (0.5 * width, 6);
    }
}

/// The most cells of a solution: 2 GB.
const MOST_CELLS: usize = 1 << 22;

/// Half the width of a cell, in units of its place, below which it is halved no more: beside a steep break
/// A (x − x_b)^−½ it is given its mass, not its shape. The shape is worth A² times this, while places rounded to ε cost
/// A ε over its root.
const NARROWEST: f64 = 1e-11;

/// How far before its end a cell is looked at, in half widths: farther than an atom there may be put by rounding.
const BEFORE: f64 = 1e-9;

/// Cells longer than this many means of the kernel are solved by conservation.
const LONG: f64 = 4.0;

/// The width of the first cell beside a pole at 0, in units of that of cells to begin with. What it and those next to it hold is
/// told by conservation, where in the first is of no consequence.
const SMALLEST: f64 = 1e-30;

/// By how much the place of a break, a sum of some others, may be rounded, in units of itself.
const ROUNDED: f64 = 1e-14;

/// What rounding of values and of places makes of a tail, `distance` half widths from 0.
fn rounding(values: &Nodal, distance: f64) -> f64 {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), &v| (low.min(v), high.max(v)));
    16.0 * f64::EPSILON * (low.abs().max(high.abs()) + (high - low) * distance)
}

impl March<'_> {
    /// Cells from where the march stands to `stop`, halved and grown as needed.
    fn section(&mut self, stop: f64, end: f64, pace: &mut CellPace, monitor: &mut dyn Monitor) -> Result<()> {
        self.opened = self.density.end();
        let graded = self.graded(stop);
        self.graded_to = graded.last().copied().unwrap_or(self.opened);
        for to in graded.into_iter().chain([stop]) {
            while self.density.end() < to {
                if to < stop {
                    *pace = CellPace { width: pace.width.min(to - self.density.end()), patience: 0 };
                }
                self.run(to, end, pace, monitor)?;
            }
            pace.width = pace.width.max(to - self.opened).min(self.base);
        }
        Ok(())
    }

    /// Ends of cells that double in width from a singularity A (x − x_0)^e/Γ(e + 1) of g at the place reached, the first as
    /// narrow as to hold a mass that is allowed to miss: a graded mesh, on which g is a polynomial in each cell to the same
    /// digits (H. Brunner, 2004, section 6.2).
    fn graded(&self, stop: f64) -> Vec<f64> {
        let here = |b: &&Breakpoint| same_position(b.position, self.opened);
        let Some(Breakpoint { exponent, amplitude, .. }) =
            self.singular.iter().filter(here).min_by(|a, b| a.exponent.total_cmp(&b.exponent)).copied()
        else {
            return Vec::new();
        };
        let room = self.base.min(stop - self.opened);
        let floor = (SMALLEST * room).max(4.0 * NARROWEST * self.opened);
        let mass = |width: f64| amplitude.abs() * width.powf(exponent + 1.0) / libm::tgamma(exponent + 2.0);
        let narrower = |width: &f64| Some(0.5 * width).filter(|half| *half > floor);
        let widths = std::iter::successors(Some(0.5 * room), narrower);
        let mut heavy: Vec<f64> = widths.take_while(|&width| mass(width) > self.accuracy.mass).collect();
        heavy.reverse();
        heavy.into_iter().map(|width| self.opened + width).collect()
    }

    /// A run of equal cells towards `stop`, until it is there or another width serves better.
    fn run(&mut self, stop: f64, end: f64, pace: &mut CellPace, monitor: &mut dyn Monitor) -> Result<()> {
        let here = self.density.end();
        let count = ((stop - here) / pace.width - 1e-9).ceil().max(1.0);
        let width = (stop - here) / count;
        self.start_run(here, width);
        for done in 1..=count as usize {
            let last = done == count as usize;
            let Some(missing) = self.cell(if last { stop } else { here + done as f64 * width }) else {
                pace.halve(width);
                return if width < 1e-40 * end { Err(self.unresolved()) } else { Ok(()) };
            };
            pace.patience = pace.patience.saturating_sub(1);
            if !last && self.grows(missing, done, end - here, width, pace) {
                pace.width = 2.0 * width;
                return Ok(());
            }
            if !last && done.is_multiple_of(256) && self.is_flat() {
                pace.width = stop - here;
                return Ok(());
            }
            report(monitor, self.density.end() / end)?;
            self.fits(end)?;
        }
        Ok(())
    }

    /// Whether the next cell should be twice as wide: at once where nothing breaks, soon where a kink made cells small,
    /// late otherwise, since every change of width costs new blocks.
    fn grows(&self, missing: f64, done: usize, left: f64, width: f64, pace: &CellPace) -> bool {
        let limit = self.accuracy.density;
        let largest = self
            .values
            .last()
            .map_or(0.0, |values| values.iter().fold(0.0, |most: f64, v| most.max(v.abs())));
        let many = left.min(self.kernel.curve().end()) > 512.0 * self.base;
        let quiet = many && largest * width < 1e-3 * self.accuracy.mass;
        let recovering = width < 0.3 * self.base && missing < 0.05 * limit.max(self.accuracy.mass / width);
        let settled = done >= 128 && missing < 1e-2 * limit && left > 3072.0 * width;
        (quiet || recovering) && pace.patience == 0 || settled
    }

    /// Whether the density has not changed for as long as the kernel reaches: it never will again.
    fn is_flat(&self) -> bool {
        let (here, reach) = (self.density.end(), self.kernel.curve().end());
        let back = self.density.boundaries.partition_point(|&b| b < here - reach).saturating_sub(1);
        let cells = &self.density.coefficients[back..];
        let level = cells[0][0];
        let close = 0.1 * self.accuracy.density;
        let flat = |c: &Nodal| (c[0] - level).abs() < close && c[1..].iter().all(|c| c.abs() < close);
        here > self.source.curve().end() + reach && cells.iter().all(flat)
    }

    /// Whether the solution so far, and as much again as its pace asks for, can be kept.
    fn fits(&self, end: f64) -> Result<()> {
        let cells = self.values.len();
        if cells < MOST_CELLS {
            return Ok(());
        }
        let per_cell = 3 * size_of::<Nodal>() as u64;
        Err(Error::TooLarge {
            key: String::new(),
            what: format!(
                "a pull resolved that finely (it has come to {:.3} of {end:.3})",
                self.density.end()
            ),
            needed: (cells as f64 * end / self.density.end()) as u64 * per_cell,
            allowed: MOST_CELLS as u64 * per_cell,
        })
    }

    fn unresolved(&self) -> Error {
        Error::Accuracy {
            key: String::new(),
            what: format!("the breaking rate at X = {}", self.density.end()),
            reached: Float(self.tail),
            wanted: Float(self.accuracy.density),
        }
    }

    fn start_run(&mut self, start: f64, width: f64) {
        if let Some(run) = self.mesh.runs.last() {
            let there = run.start + (self.values.len() - run.first) as f64 * run.width;
            if (run.width - width).abs() <= 1e-11 * width && (there - start).abs() <= 1e-11 * width {
                return;
            }
        }
        if self.mesh.runs.last().is_some_and(|run| run.first == self.values.len()) {
            self.mesh.runs.pop();
        }
        self.mesh.runs.push(Run { first: self.values.len(), start, width });
        (self.inverse, self.kept_inverse) = (None, None);
        self.blocks.reset(u32::MAX);
        self.kept_blocks.reset(u32::MAX);
    }

    /// Solves the next cell of the run, up to `stop`; the size of its tail, or `None` where it is not resolved.
    fn cell(&mut self, stop: f64) -> Option<f64> {
        let cell = self.values.len();
        if self.source.hides(self.density.end(), stop, self.accuracy.mass) {
            return None;
        }
        self.mesh.run_of.push(self.mesh.runs.len() as u32 - 1);
        self.mesh.boundaries.push(stop);
        let width = 2.0 * self.mesh.cell(cell).1;
        let found =
            if width > LONG * self.kept.1.size() { self.conserved(cell) } else { self.resolved(cell) };
        if let Some((values, missing)) = found {
            self.values.push(values);
            self.density.boundaries.push(stop);
            self.density.coefficients.push(RULE.coefficients(&values));
            if width <= 1.01 * self.base || self.keeps(cell) {
                return Some(missing);
            }
            self.values.pop();
            self.density.boundaries.pop();
            self.density.coefficients.pop();
        }
        self.mesh.run_of.pop();
        self.mesh.boundaries.pop();
        None
    }

    /// The density at the Gauss points of the next cell and the size of its tail, 0 where that is rounding; `None` where
    /// it is not resolved and a narrower cell may do better.
    fn resolved(&mut self, cell: usize) -> Option<(Nodal, f64)> {
        let (middle, half) = self.mesh.cell(cell);
        let known = self.known(cell);
        let mut values = self.solved(cell, known);
        if self.is_beside_pole(cell) {
            values = self.conserving(cell, &values);
            // What stays inside of a cell is misplaced by its place at most, by which forces are off.
            let misplaced = tail(&RULE.coefficients(&values)) * half * (middle + half);
            if cell == 0 || misplaced <= self.accuracy.mass * self.kept.1.size() {
                return Some((values, 0.0));
            }
        }
        if let Some(missing) = self.missing(cell, &values) {
            return Some((values, missing));
        }
        (half < NARROWEST * middle).then(|| {
            let mean = self.known_mass(cell) / (2.0 * half);
            (self.solved(cell, [mean; NODES]), 0.0)
        })
    }

    /// Whether a cell is one of those that double in width from a pole at 0.
    fn is_beside_pole(&self, cell: usize) -> bool {
        self.opened == 0.0
            && self.mesh.boundaries[cell + 1] <= self.graded_to
            && self.singular.iter().any(|b| b.position == 0.0 && b.exponent < 0.0)
    }

    /// The values on a cell times the factor by which source + kernel ∗ g of what is kept is 1 at its end: what the shape of a
    /// pole in the first cell is off by moves no mass farther on.
    fn conserving(&self, cell: usize, values: &Nodal) -> Nodal {
        let (source, kernel) = self.kept;
        let end = self.mesh.boundaries[cell + 1];
        let part = |(cell, density): (usize, &Nodal)| self.mesh.convolve_cell(cell, density, kernel, end);
        let before = source.value(end)
            + struck(kernel.curve(), &self.atoms, (end, 0.0))
            + self.density.coefficients.iter().enumerate().map(part).sum::<f64>();
        let held = part((cell, &RULE.coefficients(values)));
        values.map(|value| value * (1.0 - before) / held)
    }

    /// The size of the tail of values on a cell, 0 where that is rounding; `None` where they are not resolved.
    fn missing(&mut self, cell: usize, values: &Nodal) -> Option<f64> {
        let (middle, half) = self.mesh.cell(cell);
        let missing = tail(&RULE.coefficients(values));
        let rounding = rounding(values, middle / half);
        if missing > self.accuracy.density.max(rounding) && missing * half > self.accuracy.mass {
            return None;
        }
        let felt = missing * half / self.accuracy.mass * self.accuracy.density;
        self.tail = self.tail.max(missing.min(felt));
        Some(if missing < rounding { 0.0 } else { missing })
    }

    /// The density at the Gauss points of the next cell from source + kernel ∗ g = 1 of what is `kept`, a Volterra equation of
    /// the first kind. On cells much longer than the kernel it is well conditioned, where 1 − kernel ∗ is near a derivative and
    /// makes rounding grow with the length. `None` where it is not resolved, or does not solve the equation of the second kind,
    /// since something was stepped over.
    fn conserved(&mut self, cell: usize) -> Option<(Nodal, f64)> {
        let absent = self.kept_before(cell).map(|kept| 1.0 - kept);
        let (half, run) = (self.mesh.cell(cell).1, self.mesh.runs.len() as u32);
        if self.kept_inverse.as_ref().is_none_or(|(made_for, _)| *made_for != run) {
            let own = block(self.kept.1, (0.0, half), (0.0, half)).block?;
            self.kept_inverse = Some((run, Box::new(inverted(*own))));
        }
        let mut values = [0.0; NODES];
        apply(&self.kept_inverse.as_ref()?.1, &absent, &mut values);
        let missing = self.missing(cell, &values)?;
        let mut again = self.known(cell);
        self.blocks.add_history(&self.mesh, cell, &self.values, &self.density, &mut again);
        self.blocks.add_own(&self.mesh, cell, &values, &mut again);
        let off = |i: usize| (again[i] - values[i]).abs() * self.kept.1.size();
        (0..NODES).all(|i| off(i) <= self.accuracy.kept).then_some((values, missing))
    }

    /// Whether all that should be in g is there, at the points of the last cell and at its end: what begins between the last
    /// point and the end shows at the end alone.
    fn keeps(&mut self, cell: usize) -> bool {
        let allowed = self.accuracy.kept;
        let all = |kept: f64| (kept - 1.0).abs() <= allowed;
        all(self.kept_at_end(cell)) && self.kept_before(cell).into_iter().all(all)
    }

    /// What is kept at the end of a cell, before an atom that lies there.
    fn kept_at_end(&self, cell: usize) -> f64 {
        let ((source, kernel), (middle, half)) = (self.kept, self.mesh.cell(cell));
        let end = middle + half * (1.0 - BEFORE);
        source.value(end)
            + struck(kernel.curve(), &self.atoms, (end, 0.0))
            + self.mesh.convolve_at(&self.density, kernel, end)
    }

    /// What is kept at the points of a cell, of the cells that have values.
    fn kept_before(&mut self, cell: usize) -> Nodal {
        let (source, kernel) = self.kept;
        let mut kept = self.mesh.points(cell).map(|(start, offset)| {
            source.value(start + offset) + struck(kernel.curve(), &self.atoms, (start, offset))
        });
        self.kept_blocks.add_history(&self.mesh, cell, &self.values, &self.density, &mut kept);
        kept
    }

    /// Source and atoms at the Gauss points of a cell.
    fn known(&self, cell: usize) -> Nodal {
        self.mesh.points(cell).map(|(start, offset)| {
            let shifted = |a: &Atom| a.weight * self.density.value((start - a.position) + offset);
            self.source.curve().value(start + offset)
                + struck(self.kernel.curve(), &self.atoms, (start, offset))
                + self.kernel_atoms.iter().map(shifted).sum::<f64>()
        })
    }

    /// ∫ over a cell of source and atoms, with what rounding of a break's place may have put before it.
    fn known_mass(&self, cell: usize) -> f64 {
        let (low, high) = (self.mesh.boundaries[cell], self.mesh.boundaries[cell + 1]);
        let low = if low == self.opened { low * (1.0 - ROUNDED) } else { low };
        let mass = |curve: &Piecewise, a: &Atom| {
            a.weight * curve.part(low - a.position, high - a.position).integral()
        };
        let struck: f64 = self.atoms.iter().map(|a| mass(self.kernel.curve(), a)).sum();
        let shifted: f64 = self.kernel_atoms.iter().map(|a| mass(&self.density, a)).sum();
        self.source.curve().part(low, high).integral() + struck + shifted
    }

    /// The density at the Gauss points of a cell that has yet none, of what is known of it without its history.
    fn solved(&mut self, cell: usize, mut known: Nodal) -> Nodal {
        self.blocks.add_history(&self.mesh, cell, &self.values, &self.density, &mut known);
        let mut values = [0.0; NODES];
        apply(self.inverse(self.mesh.cell(cell).1), &known, &mut values);
        values
    }

    /// (identity − kernel on the cell itself)⁻¹.
    fn inverse(&mut self, half: f64) -> &ConvolutionBlock {
        let run = self.mesh.runs.len() as u32;
        if self.inverse.as_ref().is_none_or(|(made_for, _)| *made_for != run) {
            let mut matrix =
                block(self.kernel, (0.0, half), (0.0, half)).block.map_or([[0.0; NODES]; NODES], |b| *b);
            for atom in &self.kernel_atoms {
                for i in 0..NODES {
                    let t = RULE.nodes[i] - atom.position / half;
                    if t >= -1.0 {
                        let cardinals = RULE.cardinals(t);
                        (0..NODES).for_each(|j| matrix[j][i] += atom.weight * cardinals[j]);
                    }
                }
            }
            for (j, column) in matrix.iter_mut().enumerate() {
                column.iter_mut().for_each(|entry| *entry = -*entry);
                column[j] += 1.0;
            }
            self.inverse = Some((run, Box::new(inverted(matrix))));
        }
        match &self.inverse {
            Some((_, inverse)) => inverse,
            None => unreachable!("made above"),
        }
    }
}
