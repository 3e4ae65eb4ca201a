//! Indexing of sites of a lattice with a rim of empty sites around it, so that every site has all neighbours.

use super::coupling::LatticeCoupling;
use crate::shape::Edges;

/// Places in rows, the rim included.
#[derive(Debug, Clone)]
pub(super) struct ContactGrid {
    rows: usize,
    columns: usize,
    edges: Edges,
    /// From a place to its neighbours, as far as there are any.
    offsets: [isize; 4],
    neighbours: usize,
}

impl ContactGrid {
    pub(super) fn new(coupling: &LatticeCoupling) -> Self {
        let [rows, columns] = coupling.shape.sides();
        let pitch = columns as isize + 2;
        let offsets = [-1, 1, -pitch, pitch];
        Self { rows, columns, edges: coupling.edges, offsets, neighbours: coupling.shape.neighbours() }
    }

    fn pitch(&self) -> usize {
        self.columns + 2
    }

    /// Number of places, the rim included.
    pub(super) fn places(&self) -> usize {
        (self.rows + 2) * self.pitch()
    }

    /// Number of contacts.
    pub(super) fn size(&self) -> usize {
        self.rows * self.columns
    }

    /// Where contact `number` is; contacts are counted along rows.
    pub(super) fn place(&self, number: usize) -> usize {
        let (row, column) = (number / self.columns, number % self.columns);
        (row + 1) * self.pitch() + column + 1
    }

    /// The number of the contact at `place`.
    #[inline]
    pub(super) fn number(&self, place: usize) -> usize {
        // Half the time of a division of 64 bits, in an innermost loop; there are fewer than 2³² places.
        let row = (place as u32 / self.pitch() as u32) as usize;
        place - 2 * row - self.columns - 1
    }

    /// The places around `place`, those on the rim among them.
    #[inline]
    pub(super) fn around(&self, place: usize) -> impl Iterator<Item = usize> + use<> {
        let offsets = self.offsets;
        (0..self.neighbours).map(move |i| place.wrapping_add_signed(offsets[i]))
    }

    /// The contact that takes the place `rim` on the rim, if there is one.
    #[cold]
    pub(super) fn across(&self, rim: usize) -> Option<usize> {
        if self.edges == Edges::Open {
            return None;
        }
        let (row, column) = (rim / self.pitch(), rim % self.pitch());
        // From 0 and n + 1 to n and 1.
        let inside = |at: usize, side: usize| (at + side - 1) % side + 1;
        Some(inside(row, self.rows) * self.pitch() + inside(column, self.columns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;

    fn grid(shape: Shape, edges: Edges) -> ContactGrid {
        ContactGrid::new(&LatticeCoupling::with_alpha(shape, edges, 0.2))
    }

    fn neighbours(grid: &ContactGrid, number: usize) -> Vec<Option<usize>> {
        let rim = |place: usize| {
            let (row, column) = (place / grid.pitch(), place % grid.pitch());
            row == 0 || row > grid.rows || column == 0 || column > grid.columns
        };
        let inside = |place| if rim(place) { grid.across(place) } else { Some(place) };
        grid.around(grid.place(number)).map(|place| inside(place).map(|place| grid.number(place))).collect()
    }

    #[test]
    fn contacts_are_counted_along_rows() {
        let grid = grid(Shape::Square([3, 4]), Edges::Open);
        assert!((0..12).all(|number| grid.number(grid.place(number)) == number));
        assert_eq!(neighbours(&grid, 5), [Some(4), Some(6), Some(1), Some(9)]);
        assert_eq!(neighbours(&grid, 11), [Some(10), None, Some(7), None]);
    }

    #[test]
    fn periodic_edges_meet() {
        let grid = grid(Shape::Square([3, 4]), Edges::Periodic);
        assert_eq!(neighbours(&grid, 0), [Some(3), Some(1), Some(8), Some(4)]);
        assert_eq!(neighbours(&grid, 11), [Some(10), Some(8), Some(7), Some(3)]);
    }

    #[test]
    fn a_chain_has_two_neighbours() {
        assert_eq!(neighbours(&grid(Shape::Chain(5), Edges::Open), 0), [None, Some(1)]);
        assert_eq!(neighbours(&grid(Shape::Chain(5), Edges::Periodic), 0), [Some(4), Some(1)]);
    }
}
