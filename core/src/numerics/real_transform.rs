//! Discrete Fourier transforms of n real numbers to half of their spectrum, and back, without normalisation.
//!
//! On processors, `realfft` plans them. In WebAssembly, where each kilobyte is downloaded, [`power_of_two`] does with the
//! few algorithms that all lengths need.

use num_complex::Complex64;

#[cfg(not(target_family = "wasm"))]
pub use planned::RealTransform;
#[cfg(target_family = "wasm")]
pub use power_of_two::RealTransform;

impl RealTransform {
    /// Σ_j x_j e^{−2πijk/n} for k = 0 … n/2.
    pub fn spectrum(&self, mut values: Vec<f64>) -> Vec<Complex64> {
        let mut spectrum = vec![Complex64::ZERO; values.len() / 2 + 1];
        self.forward(&mut values, &mut spectrum, &mut self.scratch());
        spectrum
    }

    /// The work space of [`RealTransform::forward`] and [`RealTransform::inverse`].
    pub fn scratch(&self) -> Vec<Complex64> {
        vec![Complex64::ZERO; self.scratch_length()]
    }
}

#[cfg(not(target_family = "wasm"))]
mod planned {
    use std::sync::Arc;

    use num_complex::Complex64;
    use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

    /// Transforms of a given length, with a plan for it.
    pub struct RealTransform {
        forward: Arc<dyn RealToComplex<f64>>,
        inverse: Arc<dyn ComplexToReal<f64>>,
    }

    impl RealTransform {
        /// Transforms of `length` numbers.
        pub fn new(length: usize) -> Self {
            let mut planner = RealFftPlanner::new();
            Self { forward: planner.plan_fft_forward(length), inverse: planner.plan_fft_inverse(length) }
        }

        pub(super) fn scratch_length(&self) -> usize {
            self.forward.get_scratch_len().max(self.inverse.get_scratch_len())
        }

        /// The spectrum Σ_j x_j e^{−2πijk/n}, k = 0 … n/2, of `values`, which are lost.
        pub fn forward(&self, values: &mut [f64], spectrum: &mut [Complex64], scratch: &mut [Complex64]) {
            let done = self.forward.process_with_scratch(values, spectrum, scratch);
            done.expect("lengths are those of the plan");
        }

        /// The n real values whose spectrum is n times `spectrum`, which is lost. Its first number and, of an even n, its last are
        /// real.
        pub fn inverse(&self, spectrum: &mut [Complex64], values: &mut [f64], scratch: &mut [Complex64]) {
            let done = self.inverse.process_with_scratch(spectrum, values, scratch);
            done.expect("lengths are those of the plan, and the ends of the spectrum are real");
        }
    }
}

/// The radix-4 algorithm for powers of two, and Bluestein's (IEEE Trans. Audio Electroacoust. 18, 451 (1970)), by two of
/// these, for other lengths.
#[cfg(any(test, target_family = "wasm"))]
mod power_of_two {
    use std::sync::Arc;

    use num_complex::Complex64;
    use rustfft::algorithm::butterflies::{Butterfly1, Butterfly2};
    use rustfft::algorithm::{BluesteinsAlgorithm, Radix4};
    use rustfft::{Fft, FftDirection};

    /// Transforms of a given length, as transforms of complex numbers.
    pub struct RealTransform {
        length: usize,
        forward: Arc<dyn Fft<f64>>,
        inverse: Arc<dyn Fft<f64>>,
    }

    impl RealTransform {
        /// Transforms of `length` numbers.
        pub fn new(length: usize) -> Self {
            let of = |direction| complex_transform(length, direction);
            Self { length, forward: of(FftDirection::Forward), inverse: of(FftDirection::Inverse) }
        }

        pub(super) fn scratch_length(&self) -> usize {
            self.length + self.forward.get_inplace_scratch_len().max(self.inverse.get_inplace_scratch_len())
        }

        /// The spectrum Σ_j x_j e^{−2πijk/n}, k = 0 … n/2, of `values`.
        pub fn forward(&self, values: &mut [f64], spectrum: &mut [Complex64], scratch: &mut [Complex64]) {
            let (line, scratch) = scratch.split_at_mut(self.length);
            line.iter_mut().zip(values).for_each(|(to, value)| *to = Complex64::from(*value));
            self.forward.process_with_scratch(line, scratch);
            spectrum.copy_from_slice(&line[..=self.length / 2]);
        }

        /// The n real values whose spectrum is n times `spectrum`.
        pub fn inverse(&self, spectrum: &mut [Complex64], values: &mut [f64], scratch: &mut [Complex64]) {
            let (line, scratch) = scratch.split_at_mut(self.length);
            line[..spectrum.len()].copy_from_slice(spectrum);
            for k in spectrum.len()..self.length {
                line[k] = spectrum[self.length - k].conj();
            }
            self.inverse.process_with_scratch(line, scratch);
            values.iter_mut().zip(line).for_each(|(value, from)| *value = from.re);
        }
    }

    fn complex_transform(length: usize, direction: FftDirection) -> Arc<dyn Fft<f64>> {
        if length.is_power_of_two() {
            radix_4(length, direction)
        } else {
            Arc::new(BluesteinsAlgorithm::new(
                length,
                radix_4((2 * length - 1).next_power_of_two(), direction),
            ))
        }
    }

    fn radix_4(length: usize, direction: FftDirection) -> Arc<dyn Fft<f64>> {
        let exponent = length.ilog2();
        let base: Arc<dyn Fft<f64>> = if exponent.is_multiple_of(2) {
            Arc::new(Butterfly1::new(direction))
        } else {
            Arc::new(Butterfly2::new(direction))
        };
        Arc::new(Radix4::new_with_base(exponent / 2, base))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both ways to transform, for lengths that are a power of two, prime and neither.
    #[test]
    fn transforms_of_webassembly_are_those_of_processors() {
        for n in [1, 2, 3, 4, 7, 8, 12, 31, 128, 512, 1000] {
            let values: Vec<f64> = (0..n).map(|j| (1.0 + 7.3 * j as f64 * j as f64).sin()).collect();
            let (one, other) = (RealTransform::new(n), power_of_two::RealTransform::new(n));
            let expected = one.spectrum(values.clone());
            let mut found = vec![Complex64::ZERO; n / 2 + 1];
            let mut scratch = vec![Complex64::ZERO; other.scratch_length()];
            other.forward(&mut values.clone(), &mut found, &mut scratch);
            // Some roundings of numbers that add up to √n.
            let close = |a: &Complex64, b: &Complex64| {
                (a - b).norm() < 1e-14 * (n as f64).sqrt() * (n as f64).ln_1p()
            };
            assert!(found.iter().zip(&expected).all(|(a, b)| close(a, b)), "{n}");
            let mut back = vec![0.0; n];
            other.inverse(&mut found, &mut back, &mut scratch);
            assert!(back.iter().zip(&values).all(|(a, b)| (a / n as f64 - b).abs() < 1e-14), "{n}");
        }
    }
}
