//! Fourier and cosine transforms of a line of numbers: the real eigenvectors of its second difference.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::real_transform::RealTransform;

/// The transform of a line of n numbers to the real eigenvectors of the second difference 2x_j − x_{j−1} −
/// x_{j+1}.
pub struct Line {
    length: usize,
    ends: Ends,
    /// Of length n.
    transform: RealTransform,
}

/// Boundary conditions.
#[derive(Debug)]
enum Ends {
    /// A ring: real Fourier modes cos(2πkj/n) and sin(2πkj/n), in the order 0, cos 1, sin 1, cos 2, …
    Periodic,
    /// Free (reflecting) ends: the modes cos(πk(j + ½)/n) of the discrete cosine transform DCT-II. Holds
    /// exp(−iπk/2n).
    Free(Vec<Complex64>),
}

/// Work space of the transform of a line.
#[derive(Debug, Default)]
pub struct Scratch {
    real: Vec<f64>,
    complex: Vec<Complex64>,
    inner: Vec<Complex64>,
}

impl std::fmt::Debug for Line {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Line").field("length", &self.length).field("ends", &self.ends).finish_non_exhaustive()
    }
}

impl Line {
    /// A ring of `length` numbers.
    pub fn periodic(length: usize) -> Self {
        Self::new(length, Ends::Periodic)
    }

    /// A line of `length` numbers with free ends.
    pub fn free(length: usize) -> Self {
        let phase = |k: usize| Complex64::cis(-PI * k as f64 / (2 * length) as f64);
        Self::new(length, Ends::Free((0..=length / 2).map(phase).collect()))
    }

    fn new(length: usize, ends: Ends) -> Self {
        Self { length, ends, transform: RealTransform::new(length) }
    }

    /// Number of modes, n.
    pub fn length(&self) -> usize {
        self.length
    }

    /// Eigenvalue of the second difference: 4 sin²(πk/n) on a ring, 4 sin²(πk/2n) with free ends.
    pub fn eigenvalue(&self, mode: usize) -> f64 {
        let half_angle = match self.ends {
            Ends::Periodic => PI * mode.div_ceil(2) as f64 / self.length as f64,
            Ends::Free(_) => PI * mode as f64 / (2 * self.length) as f64,
        };
        4.0 * half_angle.sin().powi(2)
    }

    /// The work space that [`Line::to_modes`] and [`Line::to_cells`] need.
    pub fn scratch(&self) -> Scratch {
        Scratch {
            real: vec![0.0; self.length],
            complex: vec![Complex64::ZERO; self.length / 2 + 1],
            inner: self.transform.scratch(),
        }
    }

    /// Replaces the numbers of a line by the amplitudes of its modes.
    pub fn to_modes(&self, line: &mut [f64], scratch: &mut Scratch) {
        if self.length == 1 {
            return;
        }
        match &self.ends {
            Ends::Periodic => {
                self.transform.forward(line, &mut scratch.complex, &mut scratch.inner);
                pack(&scratch.complex, line);
            }
            Ends::Free(phases) => {
                let mut real = std::mem::take(&mut scratch.real);
                fold(line, &mut real);
                self.transform.forward(&mut real, &mut scratch.complex, &mut scratch.inner);
                scratch.real = real;
                separate(&scratch.complex, phases, line);
            }
        }
    }

    /// The inverse of [`Line::to_modes`] times n: unnormalised.
    pub fn to_cells(&self, line: &mut [f64], scratch: &mut Scratch) {
        if self.length == 1 {
            return;
        }
        match &self.ends {
            Ends::Periodic => {
                unpack(line, &mut scratch.complex);
                self.transform.inverse(&mut scratch.complex, line, &mut scratch.inner);
            }
            Ends::Free(phases) => {
                combine(line, phases, &mut scratch.complex);
                let mut real = std::mem::take(&mut scratch.real);
                self.transform.inverse(&mut scratch.complex, &mut real, &mut scratch.inner);
                unfold(&real, line);
                scratch.real = real;
            }
        }
    }
}

/// Stores half the spectrum of n real numbers in n real numbers.
fn pack(spectrum: &[Complex64], line: &mut [f64]) {
    line[0] = spectrum[0].re;
    for (pair, c) in line[1..].chunks_mut(2).zip(&spectrum[1..]) {
        pair[0] = c.re;
        if let Some(imaginary) = pair.get_mut(1) {
            *imaginary = c.im;
        }
    }
}

fn unpack(line: &[f64], spectrum: &mut [Complex64]) {
    spectrum[0] = Complex64::from(line[0]);
    for (pair, c) in line[1..].chunks(2).zip(&mut spectrum[1..]) {
        *c = Complex64::new(pair[0], pair.get(1).copied().unwrap_or(0.0));
    }
}

/// Even elements in order, then odd elements in reverse: turns the discrete cosine transform of n numbers
/// into a Fourier transform of n numbers (J. Makhoul, IEEE Trans. Acoust. Speech Signal Process. 28, 27
/// (1980), doi:10.1109/TASSP.1980.1163351).
fn fold(line: &[f64], folded: &mut [f64]) {
    let (forth, back) = folded.split_at_mut(line.len().div_ceil(2));
    forth.iter_mut().zip(line.iter().step_by(2)).for_each(|(to, from)| *to = *from);
    back.iter_mut().rev().zip(line.iter().skip(1).step_by(2)).for_each(|(to, from)| *to = *from);
}

fn unfold(folded: &[f64], line: &mut [f64]) {
    let (forth, back) = folded.split_at(line.len().div_ceil(2));
    line.iter_mut().step_by(2).zip(forth).for_each(|(to, from)| *to = *from);
    line.iter_mut().skip(1).step_by(2).zip(back.iter().rev()).for_each(|(to, from)| *to = *from);
}

/// Cosine amplitudes C_k from the spectrum V of the folded line: V_k exp(−iπk/2n) = C_k − i C_{n−k}.
fn separate(spectrum: &[Complex64], phases: &[Complex64], line: &mut [f64]) {
    let n = line.len();
    for (k, (v, phase)) in spectrum.iter().zip(phases).enumerate().rev() {
        let turned = v * phase;
        if k > 0 {
            line[n - k] = -turned.im;
        }
        line[k] = turned.re;
    }
}

fn combine(line: &[f64], phases: &[Complex64], spectrum: &mut [Complex64]) {
    let n = line.len();
    spectrum[0] = Complex64::from(line[0]);
    for k in 1..spectrum.len() {
        spectrum[k] = Complex64::new(line[k], -line[n - k]) * phases[k].conj();
    }
    if n.is_multiple_of(2) {
        // Real up to rounding; the inverse transform requires exactly 0.
        spectrum[n / 2].im = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(length: usize) -> Vec<f64> {
        (0..length).map(|j| (1.0 + 7.3 * j as f64 * j as f64).sin()).collect()
    }

    fn lines() -> impl Iterator<Item = Line> {
        [1, 2, 3, 4, 7, 12, 31, 128].into_iter().flat_map(|n| [Line::periodic(n), Line::free(n)])
    }

    #[test]
    fn there_and_back_multiplies_by_the_length() {
        for line in lines() {
            let (n, mut scratch) = (line.length(), line.scratch());
            let known = noise(n);
            let mut found = known.clone();
            line.to_modes(&mut found, &mut scratch);
            line.to_cells(&mut found, &mut scratch);
            // Some roundings per factor of the length.
            assert!(found.iter().zip(&known).all(|(a, b)| (a / n as f64 - b).abs() < 1e-14), "{n}");
        }
    }

    /// Modes times eigenvalues, against differences taken in place.
    #[test]
    fn modes_are_eigenvectors_of_the_second_difference() {
        for line in lines() {
            let (n, mut scratch) = (line.length(), line.scratch());
            let known = noise(n);
            let mut found = known.clone();
            line.to_modes(&mut found, &mut scratch);
            (0..n).for_each(|k| found[k] *= line.eigenvalue(k) / n as f64);
            line.to_cells(&mut found, &mut scratch);
            let ring = matches!(line.ends, Ends::Periodic);
            for j in 0..n {
                let (before, after) = if ring {
                    ((j + n - 1) % n, (j + 1) % n)
                } else {
                    (j.saturating_sub(1), (j + 1).min(n - 1))
                };
                let expected = 2.0 * known[j] - known[before] - known[after];
                assert!((found[j] - expected).abs() < 1e-13, "{n} {j}: {} {expected}", found[j]);
            }
        }
    }
}
