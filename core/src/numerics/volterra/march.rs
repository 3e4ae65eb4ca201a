//! Marching: the solution cell by cell, from breakpoint to breakpoint, with adaptive cell widths.

use super::block::{Blocks, ConvolutionBlock, apply, block, inverted};
use super::kernel::Kernel;
use super::leading::Leading;
use super::mesh::{Mesh, Run};
use super::response::own_inverse;
use super::{Accuracy, Solution, convolve_atoms};
use crate::monitor::{Cost, Monitor, report};
use crate::numerics::breakpoints::{Atom, Breakpoint, renewed, same_position};
use crate::numerics::legendre::{NODES, Nodal, RULE};
use crate::numerics::piecewise::{Piecewise, rounding, tail};
use crate::{Error, Float, Result};

/// The state of the march.
struct March<'a> {
    source: &'a Kernel,
    kernel: &'a Kernel,
    conservation: (&'a Piecewise, &'a Kernel),
    accuracy: Accuracy,
    conservation_blocks: Blocks<'a>,
    /// The width up to which cells need no check of conservation.
    base: f64,
    kernel_atoms: Vec<Atom>,
    atoms: Vec<Atom>,
    /// Breakpoints of g above which the mesh is graded.
    singular: Vec<Breakpoint>,
    mesh: Mesh,
    values: Vec<Nodal>,
    density: Piecewise,
    blocks: Blocks<'a>,
    /// Inverse of identity − kernel on the cell itself, with the run it belongs to.
    inverse: Option<(u32, Box<ConvolutionBlock>)>,
    /// The same for the kernel of the conservation law.
    conservation_inverse: Option<(u32, Box<ConvolutionBlock>)>,
    tail: f64,
    /// The breakpoint at which the present section starts.
    section_start: f64,
    /// End of the graded cells above it.
    graded_to: f64,
}

/// Solves g = source + kernel ∗ g on [0, end].
///
/// `conservation` holds another source and kernel with source + kernel ∗ g = 1 (for a renewal equation the
/// survivals: each contact is somewhere). Cells wider than the narrow ones are only accepted if this holds,
/// so that no narrow feature is stepped over. `onsets` are breakpoints of a further source and kernel that
/// will be convolved with g, at positions where `source` and `kernel` are smooth; cells also end where these
/// make that convolution non-smooth.
///
/// # Errors
/// [`Error::Stopped`] by the monitor; [`Error::TooLarge`] for too many point masses; [`Error::Accuracy`] if
/// cells shrink without limit.
pub fn solve(
    source: &Kernel,
    kernel: &Kernel,
    conservation: (&Piecewise, &Kernel),
    onsets: [&[Breakpoint]; 2],
    end: f64,
    accuracy: Accuracy,
    monitor: &mut dyn Monitor,
) -> Result<Solution> {
    // Convolution only smooths: what follows from a source with a density is no narrower than the source.
    let own = source.narrow_width(accuracy.narrow_fraction);
    let narrow_width =
        if source.size() > 1e-3 { own } else { own.min(kernel.narrow_width(accuracy.narrow_fraction)) };
    let width = (accuracy.initial_width * narrow_width).min(end);
    let needed = cells_between(kernel, width, end);
    if needed > MOST_CELLS as f64 {
        let free = kernel.start();
        let within = kernel.curve().end() - free;
        return Err(too_many(
            needed,
            format!(
                "a pull by {end:.1e} of contacts that are free for {free:.1e} and break within {within:.1e}"
            ),
        ));
    }
    let spacing = width / (2 * NODES) as f64;
    // A breakpoint inside a cell is allowed the error of a cell, in the density or in the mass. So many that
    // show in the density that `renewed` refuses them would take hours in any case.
    let shows_in_density = |b: &Breakpoint| b.weight(spacing) > 10.0 * accuracy.density;
    let matters = |b: &Breakpoint| shows_in_density(b) && b.weight(spacing) * spacing > 10.0 * accuracy.mass;
    // This call only refuses cases with too many breakpoints, before any work is done.
    renewed(source.breakpoints(), kernel.breakpoints(), end, shows_in_density, monitor)?;
    // The solution of g = s + k ∗ g is s + k ∗ s + k ∗ k ∗ s + …: its breakpoints are sums of one
    // breakpoint of the source and any number of those of the kernel. Each convolution with a
    // density makes them smoother, so that only the first ones are strong enough to need an edge of
    // a cell.
    let breakpoints = renewed(source.breakpoints(), kernel.breakpoints(), end, matters, monitor)?;
    let atoms = breakpoints
        .iter()
        .filter(|b| b.is_atom())
        .map(|b| Atom { position: b.position, weight: b.amplitude });
    let mut march = March {
        source,
        kernel,
        conservation,
        conservation_blocks: Blocks::new(conservation.1, accuracy.density),
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
        conservation_inverse: None,
        tail: 0.0,
        section_start: 0.0,
        graded_to: 0.0,
    };
    let shows = |b: &Breakpoint| b.weight(spacing) > 10.0 * accuracy.convolved;
    let convolved = breakpoints.iter().flat_map(|b| onsets[1].iter().map(|onset| b.convolve(*onset)));
    let further = onsets[0].iter().copied().chain(convolved).filter(shows);
    let all = breakpoints.iter().copied().chain(further).map(|b| b.position);
    // Cells end on each of these, so that the solution is smooth on every cell.
    let mut stops: Vec<f64> = all.filter(|&x| x > 0.0 && x < end).chain([end]).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup_by(|b, a| same_position(*a, *b));
    let mut control = WidthControl { width, patience: 0 };
    // Sections are solved in order. Within a section the solution is smooth, so that a Gauss rule
    // per cell converges exponentially; across a breakpoint it would not.
    for stop in stops {
        march.section(stop, end, &mut control, monitor)?;
    }
    let March { mesh, values, density, atoms, .. } = march;
    monitor.cost(Cost::VolterraCells, values.len());
    let breakpoints = breakpoints.into_iter().filter(|b| !b.is_atom()).collect();
    let leading = Leading::of(&density);
    Ok(Solution { resolved: accuracy.density, mesh, values, density, leading, atoms, breakpoints })
}

/// A lower bound of the number of cells that a solution needs between its bursts, where the kernel is 0 up to a position much
/// beyond the `width` of cells: each burst is followed by cells that double in width up to that position. Bursts last longer
/// from one to the next, by what the kernel reaches beyond it, until they meet.
fn cells_between(kernel: &Kernel, width: f64, end: f64) -> f64 {
    let start = kernel.start();
    let apart = start / (kernel.curve().end() - start);
    (end / start).min(apart) * (start / width).log2().max(0.0)
}

/// A solution of more cells than there may be.
fn too_many(cells: f64, what: String) -> Error {
    let per_cell = 3 * size_of::<Nodal>() as u64;
    let (needed, allowed) = (cells as u64 * per_cell, MOST_CELLS as u64 * per_cell);
    Error::TooLarge { key: String::new(), what, needed, allowed }
}

/// Control of the cell width: the present width, and the number of cells before it may grow.
struct WidthControl {
    width: f64,
    patience: usize,
}

impl WidthControl {
    fn halve(&mut self, width: f64) {
        (self.width, self.patience) = (0.5 * width, 6);
    }
}

/// Largest number of cells of a solution: 2 GB.
const MOST_CELLS: usize = 1 << 22;

/// Smallest half width of a cell relative to its position. Beside a steep breakpoint A (x − x_b)^−½ a
/// narrower cell is given its mass, not its shape: the shape contributes A² times this, while positions
/// rounded to ε contribute A ε over its root.
const NARROWEST: f64 = 1e-11;

/// Conservation is checked this far before the end of a cell, in half widths: rounding moves a point mass at
/// the end by less.
const BEFORE: f64 = 1e-9;

/// Cells longer than this many means of the kernel are solved by the conservation law.
const LONG: f64 = 4.0;

/// Width of the first cell beside a pole at 0, in units of the initial width. The mass in it and its
/// neighbours follows from conservation; where in the first cell it lies does not matter.
const SMALLEST: f64 = 1e-30;

/// Relative rounding error of the position of a breakpoint, which is a sum of others.
const ROUNDED: f64 = 1e-14;

impl March<'_> {
    /// Solves the cells from the present position to `stop`, halving and doubling as needed.
    fn section(
        &mut self,
        stop: f64,
        end: f64,
        control: &mut WidthControl,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        self.section_start = self.density.end();
        let graded = self.graded(stop);
        self.graded_to = graded.last().copied().unwrap_or(self.section_start);
        for to in graded.into_iter().chain([stop]) {
            while self.density.end() < to {
                if to < stop {
                    // A graded cell ends at its own boundary, and halvings before it do not matter.
                    *control =
                        WidthControl { width: control.width.min(to - self.density.end()), patience: 0 };
                }
                self.run(to, end, control, monitor)?;
            }
            control.width = control.width.max(to - self.section_start).min(self.base);
        }
        Ok(())
    }

    /// Ends of cells that double in width from a singularity A (x − x_0)^e/Γ(e + 1) of g at the present
    /// position: a graded mesh, on which a polynomial per cell is accurate to the same digits everywhere (H.
    /// Brunner, 2004, section 6.2). The mass of the first cell is negligible.
    fn graded(&self, stop: f64) -> Vec<f64> {
        let here = |b: &&Breakpoint| same_position(b.position, self.section_start);
        let Some(Breakpoint { exponent, amplitude, .. }) =
            self.singular.iter().filter(here).min_by(|a, b| a.exponent.total_cmp(&b.exponent)).copied()
        else {
            return Vec::new();
        };
        let room = self.base.min(stop - self.section_start);
        let floor = (SMALLEST * room).max(4.0 * NARROWEST * self.section_start);
        let mass = |width: f64| amplitude.abs() * width.powf(exponent + 1.0) / libm::tgamma(exponent + 2.0);
        let narrower = |width: &f64| Some(0.5 * width).filter(|half| *half > floor);
        let widths = std::iter::successors(Some(0.5 * room), narrower);
        let mut heavy: Vec<f64> = widths.take_while(|&width| mass(width) > self.accuracy.mass).collect();
        heavy.reverse();
        heavy.into_iter().map(|width| self.section_start + width).collect()
    }

    /// Solves a run of equal cells towards `stop`, until it is reached or another width is better.
    fn run(
        &mut self,
        stop: f64,
        end: f64,
        control: &mut WidthControl,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let here = self.density.end();
        // Cells of a run are equal, so that the block between two cells depends on their distance
        // only (a Toeplitz matrix).
        let count = ((stop - here) / control.width - 1e-9).ceil().max(1.0);
        let width = (stop - here) / count;
        self.start_run(here, width);
        for done in 1..=count as usize {
            let last = done == count as usize;
            let Some(truncation) = self.cell(if last { stop } else { here + done as f64 * width }) else {
                monitor.cost(Cost::RejectedVolterraCells, 1);
                control.halve(width);
                return if width < 1e-40 * end { Err(self.unresolved()) } else { Ok(()) };
            };
            control.patience = control.patience.saturating_sub(1);
            if !last && self.grows(truncation, done, end - here, width, control) {
                control.width = 2.0 * width;
                return Ok(());
            }
            // A constant density: one cell reaches to the next breakpoint. Cells of all runs count: each may be short.
            if !last && self.values.len().is_multiple_of(256) && self.is_flat() {
                control.width = stop - here;
                return Ok(());
            }
            report(monitor, self.density.end() / end)?;
            self.fits(end)?;
        }
        Ok(())
    }

    /// Whether the next cell should be twice as wide: at once where g is negligible, soon where a kink made
    /// cells narrow, late otherwise, since each change of width costs new blocks.
    fn grows(&self, truncation: f64, done: usize, left: f64, width: f64, control: &WidthControl) -> bool {
        let limit = self.accuracy.density;
        let largest = self
            .values
            .last()
            .map_or(0.0, |values| values.iter().fold(0.0, |most: f64, v| most.max(v.abs())));
        // Where almost nothing breaks, wide cells lose nothing.
        let many = left.min(self.kernel.curve().end()) > 512.0 * self.base;
        let quiet = many && largest * width < 1e-3 * self.accuracy.mass;
        let recovering = width < 0.3 * self.base && truncation < 0.05 * limit.max(self.accuracy.mass / width);
        let settled = done >= 128 && truncation < 1e-2 * limit && left > 3072.0 * width;
        (quiet || recovering) && control.patience == 0 || settled
    }

    /// Whether the density has been constant for as long as the kernel reaches: then it stays so.
    fn is_flat(&self) -> bool {
        let (here, reach) = (self.density.end(), self.kernel.curve().end());
        let back = self.density.boundaries.partition_point(|&b| b < here - reach).saturating_sub(1);
        let cells = &self.density.coefficients[back..];
        let level = cells[0][0];
        let close = 0.1 * self.accuracy.density;
        // A constant over the whole reach of the kernel solves the equation for ever: it is the
        // steady state of renewal theory, 1/mean life.
        let flat = |c: &Nodal| (c[0] - level).abs() < close && c[1..].iter().all(|c| c.abs() < close);
        here > self.source.curve().end() + reach && cells.iter().all(flat)
    }

    /// Checks the number of cells, and estimates the memory that the whole solution would need.
    fn fits(&self, end: f64) -> Result<()> {
        let cells = self.values.len();
        if cells < MOST_CELLS {
            return Ok(());
        }
        let come = self.density.end();
        let what = format!("a pull resolved that finely (it has come to {come:.3} of {end:.3})");
        Err(too_many(cells as f64 * end / come, what))
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
            // Cells that continue the run keep its blocks, which are the larger part of the cost.
            if (run.width - width).abs() <= 1e-11 * width && (there - start).abs() <= 1e-11 * width {
                return;
            }
        }
        if self.mesh.runs.last().is_some_and(|run| run.first == self.values.len()) {
            self.mesh.runs.pop();
        }
        self.mesh.runs.push(Run { first: self.values.len(), start, width });
        (self.inverse, self.conservation_inverse) = (None, None);
        self.blocks.reset(u32::MAX);
        self.conservation_blocks.reset(u32::MAX);
    }

    /// Solves the next cell of the run, up to `stop`. Returns the truncation error, or `None` if the cell
    /// must be narrower.
    fn cell(&mut self, stop: f64) -> Option<f64> {
        let cell = self.values.len();
        if self.source.hides_mass(self.density.end(), stop, self.accuracy.mass) {
            return None;
        }
        self.mesh.run_of.push(self.mesh.runs.len() as u32 - 1);
        self.mesh.boundaries.push(stop);
        let width = 2.0 * self.mesh.cell(cell).1;
        let found = if width > LONG * self.conservation.1.size() {
            self.conserved(cell)
        } else {
            self.resolved(cell)
        };
        if let Some((values, truncation)) = found {
            self.values.push(values);
            self.density.boundaries.push(stop);
            self.density.coefficients.push(RULE.coefficients(&values));
            // Wider cells than the initial ones might step over a narrow feature, which the conservation law
            // reveals.
            if width <= 1.01 * self.base || self.conserves(cell) {
                return Some(truncation);
            }
            self.values.pop();
            self.density.boundaries.pop();
            self.density.coefficients.pop();
        }
        self.mesh.run_of.pop();
        self.mesh.boundaries.pop();
        None
    }

    /// The density at the Gauss points of the next cell and its truncation error (0 if that is rounding);
    /// `None` if it is not resolved and a narrower cell may do better.
    fn resolved(&mut self, cell: usize) -> Option<(Nodal, f64)> {
        let (middle, half) = self.mesh.cell(cell);
        let known = self.known(cell);
        let mut values = self.solved(cell, known);
        // Beside a pole no polynomial has the shape of the density; its mass is what the solution
        // farther on depends on.
        if self.is_beside_pole(cell) {
            values = self.conserving(cell, &values);
            // Mass inside a cell is misplaced by at most its position, and forces are off by that.
            let misplaced = tail(&RULE.coefficients(&values)) * half * (middle + half);
            if cell == 0 || misplaced <= self.accuracy.mass * self.conservation.1.size() {
                return Some((values, 0.0));
            }
        }
        if let Some(truncation) = self.truncation(cell, &values) {
            return Some((values, truncation));
        }
        // Halving has reached the rounding of positions: the cell gets its mass, spread evenly.
        (half < NARROWEST * middle).then(|| {
            let mean = self.known_mass(cell) / (2.0 * half);
            (self.solved(cell, [mean; NODES]), 0.0)
        })
    }

    /// Whether a cell belongs to the graded mesh above a pole at 0.
    fn is_beside_pole(&self, cell: usize) -> bool {
        self.section_start == 0.0
            && self.mesh.boundaries[cell + 1] <= self.graded_to
            && self.singular.iter().any(|b| b.position == 0.0 && b.exponent < 0.0)
    }

    /// The values on a cell, scaled so that the conservation law holds at its end: an error in the shape of a
    /// pole in the first cell then moves no mass to later cells.
    fn conserving(&self, cell: usize, values: &Nodal) -> Nodal {
        let (source, kernel) = self.conservation;
        let end = self.mesh.boundaries[cell + 1];
        let before = source.value(end)
            + convolve_atoms(kernel.curve(), &self.atoms, (end, 0.0))
            + self.mesh.convolve_at((&self.density, self.blocks.leading()), kernel, end);
        let held = self.mesh.convolve_cell(cell, &RULE.coefficients(values), kernel, end);
        values.map(|value| value * (1.0 - before) / held)
    }

    /// The truncation error of values on a cell, 0 if that is rounding; `None` if they are not resolved.
    fn truncation(&mut self, cell: usize, values: &Nodal) -> Option<f64> {
        let (middle, half) = self.mesh.cell(cell);
        let truncation = tail(&RULE.coefficients(values));
        let rounding = rounding(values, middle / half);
        let resolved =
            truncation <= self.accuracy.density.max(rounding) || truncation * half <= self.accuracy.mass;
        if !resolved {
            return None;
        }
        // An error of the density on a narrow cell matters by its mass only.
        let felt = truncation * half / self.accuracy.mass * self.accuracy.density;
        self.tail = self.tail.max(truncation.min(felt));
        Some(if truncation < rounding { 0.0 } else { truncation })
    }

    /// The density on the next cell from the conservation law, a Volterra equation of the first kind. It is
    /// well conditioned on cells much longer than the kernel, where 1 − kernel ∗ is close to a derivative and
    /// would amplify rounding in proportion to the length. `None` if it is not resolved or does not solve the
    /// equation of the second kind because a feature was stepped over.
    fn conserved(&mut self, cell: usize) -> Option<(Nodal, f64)> {
        let absent = self.balance_at_points(cell).map(|conservation| 1.0 - conservation);
        let (half, run) = (self.mesh.cell(cell).1, self.mesh.runs.len() as u32);
        if self.conservation_inverse.as_ref().is_none_or(|(made_for, _)| *made_for != run) {
            let own = block(self.conservation.1, (0.0, half), (0.0, half)).block?;
            self.conservation_inverse = Some((run, Box::new(inverted(*own))));
        }
        let mut values = [0.0; NODES];
        apply(&self.conservation_inverse.as_ref()?.1, &absent, &mut values);
        let truncation = self.truncation(cell, &values)?;
        let mut again = self.known(cell);
        self.blocks.add_history(&self.mesh, cell, &self.values, &self.density, &mut again);
        self.blocks.add_own(&self.mesh, cell, &values, &mut again);
        let off = |i: usize| (again[i] - values[i]).abs() * self.conservation.1.size();
        (0..NODES).all(|i| off(i) <= self.accuracy.conservation).then_some((values, truncation))
    }

    /// Whether the conservation law holds at the points of the last cell and at its end; a feature that
    /// begins after the last point shows at the end only. What rounding of positions has lost before the
    /// cell, no narrower cell brings back: the cell then is to add no more.
    fn conserves(&mut self, cell: usize) -> bool {
        let (allowed, end) = (self.accuracy.conservation, self.balance_at_end(cell));
        let points = self.balance_at_points(cell);
        let off = |from: f64| points.iter().chain([&end]).any(|found| (found - from).abs() > allowed);
        if !off(1.0) {
            return true;
        }
        let before = if cell > 0 { self.balance_at_end(cell - 1) } else { 1.0 };
        (before - 1.0).abs() > allowed && !off(before)
    }

    /// Left-hand side of the conservation law at the end of a cell, before a point mass that lies there.
    fn balance_at_end(&self, cell: usize) -> f64 {
        let ((source, kernel), (middle, half)) = (self.conservation, self.mesh.cell(cell));
        let end = middle + half * (1.0 - BEFORE);
        source.value(end)
            + convolve_atoms(kernel.curve(), &self.atoms, (end, 0.0))
            + self.mesh.convolve_at((&self.density, self.blocks.leading()), kernel, end)
    }

    /// Left-hand side of the conservation law at the Gauss points of a cell, from the cells that have values.
    fn balance_at_points(&mut self, cell: usize) -> Nodal {
        let (source, kernel) = self.conservation;
        let mut conservation = self.mesh.points(cell).map(|(start, offset)| {
            source.value(start + offset) + convolve_atoms(kernel.curve(), &self.atoms, (start, offset))
        });
        self.conservation_blocks.add_history(
            &self.mesh,
            cell,
            &self.values,
            &self.density,
            &mut conservation,
        );
        conservation
    }

    /// Contribution of the source and of point masses at the Gauss points of a cell.
    fn known(&self, cell: usize) -> Nodal {
        self.mesh.points(cell).map(|(start, offset)| {
            let shifted = |a: &Atom| a.weight * self.density.value((start - a.position) + offset);
            self.source.curve().value(start + offset)
                + convolve_atoms(self.kernel.curve(), &self.atoms, (start, offset))
                + self.kernel_atoms.iter().map(shifted).sum::<f64>()
        })
    }

    /// Its integral over the cell, including what rounding of the position of a breakpoint may have put
    /// before the cell.
    fn known_mass(&self, cell: usize) -> f64 {
        let (low, high) = (self.mesh.boundaries[cell], self.mesh.boundaries[cell + 1]);
        let low = if low == self.section_start { low * (1.0 - ROUNDED) } else { low };
        let mass = |curve: &Piecewise, a: &Atom| {
            a.weight * curve.part(low - a.position, high - a.position).integral()
        };
        let convolve_atoms: f64 = self.atoms.iter().map(|a| mass(self.kernel.curve(), a)).sum();
        let shifted: f64 = self.kernel_atoms.iter().map(|a| mass(&self.density, a)).sum();
        self.source.curve().part(low, high).integral() + convolve_atoms + shifted
    }

    /// The density at the Gauss points of a cell without values, from the contribution of source and point
    /// masses.
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
            let inverse = own_inverse(self.kernel, &self.kernel_atoms, half);
            self.inverse = Some((run, inverse));
        }
        match &self.inverse {
            Some((_, inverse)) => inverse,
            None => unreachable!("made above"),
        }
    }
}
