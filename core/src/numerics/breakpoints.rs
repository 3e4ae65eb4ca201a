//! Points at which functions are not smooth, and the points at which their convolutions are not.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use serde::{Deserialize, Serialize};

use crate::monitor::{Monitor, report};
use crate::numerics::order::sort_by_number;
use crate::{Error, Result};

/// A point mass (Dirac delta): `weight` at `position`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atom {
    /// Position of the mass.
    pub position: f64,
    /// The mass.
    pub weight: f64,
}

/// A point at which a function is not smooth. Near it the function is a smooth one plus `amplitude` (x −
/// `position`)₊^`exponent` / Γ(`exponent` + 1).
///
/// A jump has exponent 0 and its height as amplitude, a kink has exponent 1 and its change of slope, √x has
/// exponent ½, a point mass has exponent −1 and its weight. In this normalisation the convolution of two such
/// terms is again one: positions add, exponents add plus one, amplitudes multiply.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Breakpoint {
    /// Position.
    pub position: f64,
    /// Exponent, −1 or more.
    pub exponent: f64,
    /// Amplitude.
    pub amplitude: f64,
}

impl Atom {
    /// Puts point masses in the order of their positions; those at one place keep theirs.
    pub(crate) fn sort(atoms: &mut [Self]) {
        sort_by_number(atoms, |item| item.position);
    }
}

impl Breakpoint {
    /// Puts breakpoints in the order of their positions; those at one place keep theirs.
    pub(crate) fn sort(breakpoints: &mut [Self]) {
        sort_by_number(breakpoints, |item| item.position);
    }

    /// The breakpoint that the convolution of two functions has because of one breakpoint of each.
    #[must_use]
    pub fn convolve(self, other: Self) -> Self {
        Self {
            position: self.position + other.position,
            exponent: self.exponent + other.exponent + 1.0,
            amplitude: self.amplitude * other.amplitude,
        }
    }

    /// The breakpoint of f(−x), where f has this one. For a whole exponent n, t₊ⁿ = tⁿ − (−1)ⁿ(−t)₊ⁿ; for
    /// other exponents only the sign of the amplitude is a convention.
    #[must_use]
    pub fn mirrored(self) -> Self {
        let odd = self.exponent.rem_euclid(2.0) == 1.0;
        Self {
            position: -self.position,
            amplitude: if odd { self.amplitude } else { -self.amplitude },
            ..self
        }
    }

    /// Estimate of the error that a polynomial makes on a cell with this breakpoint inside, for interpolation
    /// points a distance `spacing` apart: about |amplitude| spacing^exponent / Γ(exponent + 1).
    pub fn weight(&self, spacing: f64) -> f64 {
        self.amplitude.abs() * spacing.powf(self.exponent) / libm::tgamma(self.exponent + 1.0)
    }

    /// Whether Gauss quadrature on cells that end at the breakpoint does not converge fast: a low power that
    /// is not whole.
    pub fn is_steep(&self) -> bool {
        self.exponent < 5.0 && self.exponent.fract() != 0.0
    }

    /// Whether cells must narrow towards it (a graded mesh): a power below 1 that is not whole.
    pub fn is_singular(&self) -> bool {
        self.is_steep() && self.exponent < 1.0
    }

    /// Whether it is a point mass.
    pub fn is_atom(&self) -> bool {
        self.exponent == -1.0
    }
}

impl From<Atom> for Breakpoint {
    fn from(atom: Atom) -> Self {
        Self { position: atom.position, exponent: -1.0, amplitude: atom.weight }
    }
}

/// Relative distance below which two positions are the same: sums of the same numbers in another order.
const SAME: f64 = 1e-13;

/// Whether two positions are equal up to the rounding of sums.
pub fn same_position(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

/// Largest number of breakpoints of one solution.
const MOST: usize = 1_000_000;

/// A breakpoint ordered by position, for the heap.
struct Queued(Breakpoint);

impl PartialEq for Queued {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}
impl Eq for Queued {}
impl PartialOrd for Queued {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Queued {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.position.total_cmp(&other.0.position).then(self.0.exponent.total_cmp(&other.0.exponent))
    }
}

/// The breakpoints on [0, end] of the solution g of the renewal equation g = source + kernel ∗ g, ordered by
/// position: those of the source and all that repeated convolution with the kernel makes of them, atoms
/// included. A heap yields them in order.
///
/// Breakpoints for which `matters` is false are left out, with all that follow from them; atoms never are.
///
/// # Errors
/// [`Error::TooLarge`] (with an empty key) for more than a million breakpoints; [`Error::Stopped`] by the monitor, which
/// receives no progress.
pub fn renewed(
    source: &[Breakpoint],
    kernel: &[Breakpoint],
    end: f64,
    matters: impl Fn(&Breakpoint) -> bool,
    monitor: &mut dyn Monitor,
) -> Result<Vec<Breakpoint>> {
    let wanted = |b: &Breakpoint| b.position <= end && (b.is_atom() || matters(b));
    // Each breakpoint of g, convolved with those of the kernel, gives further ones at larger positions: the
    // heap visits them in order, each once.
    let mut queue: BinaryHeap<_> =
        source.iter().copied().filter(wanted).map(|b| Reverse(Queued(b))).collect();
    let mut found: Vec<Breakpoint> = Vec::new();
    while let Some(Reverse(Queued(mut next))) = queue.pop() {
        // Equal exponents at one position may be queued with others between them: collect all of the position.
        let mut others = Vec::new();
        while queue.peek().is_some_and(|Reverse(Queued(b))| same_position(b.position, next.position)) {
            if let Some(Reverse(Queued(b))) = queue.pop() {
                if (b.exponent - next.exponent).abs() < 1e-9 {
                    next.amplitude += b.amplitude
                } else {
                    others.push(b)
                }
            }
        }
        queue
            .extend(others.into_iter().map(|b| Reverse(Queued(Breakpoint { position: next.position, ..b }))));
        queue.extend(kernel.iter().map(|&k| k.convolve(next)).filter(wanted).map(|b| Reverse(Queued(b))));
        found.push(next);
        if found.len().is_multiple_of(1024) {
            report(monitor, 0.0)?;
        }
        if found.len() + queue.len() > MOST {
            return Err(Error::TooLarge {
                key: String::new(),
                what: format!("jumps and kinks at more than {MOST} positions"),
                needed: (found.len() + queue.len()) as u64 * size_of::<Breakpoint>() as u64,
                allowed: (MOST * size_of::<Breakpoint>()) as u64,
            });
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn atom(position: f64, weight: f64) -> Breakpoint {
        Atom { position, weight }.into()
    }

    #[test]
    fn commensurate_atoms_merge_whatever_the_rounding() {
        let kernel = [atom(0.1, 0.5), atom(0.2, 0.5)];
        let found = renewed(&kernel, &kernel, 10.0, |_| true, &mut ()).unwrap();
        assert_eq!(found.len(), 100);
        // The renewal theorem: the weight per step of 0.1 tends to 0.1 / mean = 2/3.
        assert!((found[99].amplitude - 2.0 / 3.0).abs() < 1e-14);
    }

    #[test]
    fn jumps_become_kinks_and_fade_by_order() {
        let jump = Breakpoint { position: 1.0, exponent: 0.0, amplitude: 2.0 };
        let found = renewed(&[jump], &[jump], 10.0, |b| b.exponent < 3.0, &mut ()).unwrap();
        let expected = [(1.0, 0.0, 2.0), (2.0, 1.0, 4.0), (3.0, 2.0, 8.0)];
        let got: Vec<_> = found.iter().map(|b| (b.position, b.exponent, b.amplitude)).collect();
        assert_eq!(got, expected);
    }
}
