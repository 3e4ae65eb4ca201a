//! Functions of the lattice Laplacian, applied by transforms of the rows and columns of a field.

use super::line::{Line, Scratch};
use crate::Result;
use crate::monitor::{Monitor, report};
use crate::parallel;

/// Number of lines transposed together: whole cache lines are read and written.
const GROUP: usize = 32;

/// Side of a transposed tile, which stays in registers and the first-level cache.
const BLOCK: usize = 8;

/// Work below this many numbers is not split among threads.
const SHARE: usize = 1 << 12;

/// Numbers that are transformed along one direction between two questions to the monitor: some hundredths of a second.
const ASKED: usize = 1 << 20;

/// Transforms of the rows and columns of a field on a lattice to the modes of a [`Line`] each way.
///
/// Products of these modes are eigenvectors of the lattice Laplacian with eigenvalues λ = λ_row + λ_column,
/// so multiplying the amplitudes by f(λ) applies f of the Laplacian. Lines may be longer than the lattice;
/// the field is then padded with zeros, for convolutions without wrap-around.
///
/// Each line is transformed by one thread, so results have the same bits on any number of threads.
#[derive(Debug)]
pub struct Modes {
    sides: [usize; 2],
    /// Down columns and along rows.
    lines: [Line; 2],
    eigenvalues: [Vec<f64>; 2],
    /// Rows × modes along a row; empty if lines are no longer than the lattice.
    rows: Vec<f64>,
    /// The same, transposed.
    columns: Vec<f64>,
}

impl Modes {
    /// Prepares a lattice of `sides` (rows, columns): `lines[0]`, as long as the first side or longer,
    /// transforms columns, `lines[1]` rows. Allocates 8 bytes × rows × modes of a row, and twice that if rows
    /// are padded.
    pub fn new(sides: [usize; 2], lines: [Line; 2]) -> Self {
        let eigenvalues = [0, 1].map(|i| {
            let line: &Line = &lines[i];
            (0..line.length()).map(|mode| line.eigenvalue(mode)).collect()
        });
        let room = sides[0] * lines[1].length();
        let rows = if lines[1].length() > sides[1] { vec![0.0; room] } else { Vec::new() };
        Self { sides, lines, eigenvalues, rows, columns: vec![0.0; room] }
    }

    /// Multiplies the amplitude of each mode of `field` by f(λ_column, λ_row), of the eigenvalues ≥ 0 down columns and along rows.
    /// Those of the lattice Laplacian are their sums.
    ///
    /// # Errors
    /// Stopped by the monitor; the field is then of no use.
    pub fn apply(
        &mut self,
        field: &mut [f64],
        f: impl Fn(f64, f64) -> f64 + Sync,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let [down, along] = std::mem::take(&mut self.eigenvalues);
        let factor = |mode: usize, column: &mut [f64]| {
            column.iter_mut().zip(&down).for_each(|(amplitude, other)| *amplitude *= f(*other, along[mode]));
        };
        let multiplied = self.multiply(field, factor, monitor);
        self.eigenvalues = [down, along];
        multiplied
    }

    /// Multiplies each mode of `field` by a factor. `factor(mode, column)` receives a mode along the rows and
    /// the amplitudes of all modes down that column.
    ///
    /// # Errors
    /// Stopped by the monitor; the field is then of no use.
    pub fn multiply(
        &mut self,
        field: &mut [f64],
        factor: impl Fn(usize, &mut [f64]) + Sync,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        // Transforms along rows leave a transposed array, so that columns are contiguous for the second
        // transform.
        self.along_rows(field, monitor)?;
        self.down_columns(field, factor, monitor)?;
        self.back_along_rows(field, monitor)
    }

    /// Transforms all rows, in place if they are not padded.
    fn along_rows(&mut self, field: &mut [f64], monitor: &mut dyn Monitor) -> Result<()> {
        let (line, width) = (&self.lines[1], self.sides[1]);
        let (share, batch) = (SHARE.div_ceil(line.length()), ASKED.div_ceil(line.length()));
        if self.rows.is_empty() {
            let step = |scratch: &mut Scratch, _, row: &mut [f64]| line.to_modes(row, scratch);
            for (number, field) in field.chunks_mut(batch * width).enumerate() {
                ask_before(number, monitor)?;
                parallel::map_with(field.chunks_mut(width).collect(), share, &|| line.scratch(), &step);
            }
            return Ok(());
        }
        let step = |scratch: &mut Scratch, _, (row, from): (&mut [f64], &[f64])| {
            row[..width].copy_from_slice(from);
            row[width..].fill(0.0);
            line.to_modes(row, scratch);
        };
        let batches = self.rows.chunks_mut(batch * line.length()).zip(field.chunks(batch * width));
        for (number, (rows, field)) in batches.enumerate() {
            ask_before(number, monitor)?;
            let rows = rows.chunks_mut(line.length()).zip(field.chunks(width));
            parallel::map_with(rows.collect(), share, &|| line.scratch(), &step);
        }
        Ok(())
    }

    fn down_columns(
        &mut self,
        field: &[f64],
        factor: impl Fn(usize, &mut [f64]) + Sync,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let (line, height, width) = (&self.lines[0], self.sides[0], self.lines[1].length());
        let rows = if self.rows.is_empty() { field } else { &self.rows };
        // Transpose, transform, filter and inverse transform of a group of columns follow one
        // another while it is in the cache: the field passes through memory three times, not seven.
        let step = |(scratch, padded): &mut (Scratch, Vec<f64>), group: usize, columns: &mut [f64]| {
            let first = GROUP * group;
            transpose(rows, width, first, columns, height);
            for (mode, column) in (first..).zip(columns.chunks_mut(height)) {
                let mut filter = |column: &mut [f64]| {
                    line.to_modes(column, scratch);
                    factor(mode, column);
                    line.to_cells(column, scratch);
                };
                if height == padded.len() {
                    filter(column);
                } else {
                    padded[..height].copy_from_slice(column);
                    padded[height..].fill(0.0);
                    filter(padded);
                    column.copy_from_slice(&padded[..height]);
                }
            }
        };
        let room = || (line.scratch(), vec![0.0; line.length()]);
        let (share, batch) = (SHARE.div_ceil(GROUP * line.length()), ASKED.div_ceil(GROUP * line.length()));
        for (number, columns) in self.columns.chunks_mut(batch * GROUP * height).enumerate() {
            ask_before(number, monitor)?;
            let groups = columns.chunks_mut(GROUP * height).collect();
            parallel::map_with(groups, share, &room, &|room, group, columns| {
                step(room, number * batch + group, columns)
            });
        }
        Ok(())
    }

    fn back_along_rows(&mut self, field: &mut [f64], monitor: &mut dyn Monitor) -> Result<()> {
        let (line, [height, width]) = (&self.lines[1], self.sides);
        let (modes, columns) = (line.length(), &self.columns);
        // The transforms are unnormalised: one factor at the end replaces one for each direction.
        let scale = 1.0 / (modes as f64 * self.lines[0].length() as f64);
        let step = |(scratch, lines): &mut (Scratch, Vec<f64>), group: usize, field: &mut [f64]| {
            transpose(columns, height, GROUP * group, &mut lines[..field.len() / width * modes], modes);
            for (row, line_of) in field.chunks_mut(width).zip(lines.chunks_mut(modes)) {
                line.to_cells(line_of, scratch);
                row.iter_mut().zip(line_of).for_each(|(to, from)| *to = scale * *from);
            }
        };
        let room = || (line.scratch(), vec![0.0; GROUP * modes]);
        let (share, batch) = (SHARE.div_ceil(GROUP * modes), ASKED.div_ceil(GROUP * modes));
        for (number, field) in field.chunks_mut(batch * GROUP * width).enumerate() {
            ask_before(number, monitor)?;
            let groups = field.chunks_mut(GROUP * width).collect();
            parallel::map_with(groups, share, &room, &|room, group, field| {
                step(room, number * batch + group, field)
            });
        }
        Ok(())
    }
}

/// Asks the monitor before each batch but the first: a small field has one only, and is transformed in no time.
fn ask_before(batch: usize, monitor: &mut dyn Monitor) -> Result<()> {
    if batch == 0 { Ok(()) } else { report(monitor, 0.0) }
}

/// Writes columns `first`, `first` + 1, … of the matrix `from` (with `columns` columns) as rows of `to`,
/// `length` apart.
fn transpose(from: &[f64], columns: usize, first: usize, to: &mut [f64], length: usize) {
    let count = to.len() / length;
    for (from, at) in from.chunks(BLOCK * columns).zip((0..).step_by(BLOCK)) {
        for tile in (0..count).step_by(BLOCK) {
            let (from, to) = (&from[first + tile..], &mut to[tile * length + at..]);
            if at + BLOCK <= length && tile + BLOCK <= count {
                transpose_tile(from, columns, to, length);
            } else {
                let (rows, columns_left) = ((length - at).min(BLOCK), (count - tile).min(BLOCK));
                (0..rows)
                    .for_each(|r| (0..columns_left).for_each(|c| to[c * length + r] = from[r * columns + c]));
            }
        }
    }
}

/// Transposes a full tile through registers.
fn transpose_tile(from: &[f64], columns: usize, to: &mut [f64], length: usize) {
    let mut tile = [[0.0; BLOCK]; BLOCK];
    for (row, from) in tile.iter_mut().zip(from.chunks(columns)) {
        row.copy_from_slice(&from[..BLOCK]);
    }
    for (c, to) in to.chunks_mut(length).take(BLOCK).enumerate() {
        let column: [f64; BLOCK] = std::array::from_fn(|r| tile[r][c]);
        to[..BLOCK].copy_from_slice(&column);
    }
}
