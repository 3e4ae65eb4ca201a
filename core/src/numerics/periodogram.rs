//! The spectrum of a record of evenly spaced values, by Welch's method: periodograms of overlapping segments with a
//! Hann window, averaged (P. D. Welch, IEEE Trans. Audio Electroacoust. 15, 70 (1967)).

use std::f64::consts::PI;

use super::real_transform::RealTransform;

/// An estimated spectrum S(q) = ∫c(u) e^{iqu} du.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Periodogram {
    /// Wave numbers, radians per unit of the spacing, evenly spaced from the first above 0.
    pub wave_numbers: Vec<f64>,
    /// The estimate of S at each.
    pub spectrum: Vec<f64>,
    /// Its standard error, relative to S.
    pub relative_error: f64,
}

/// The spectrum of `values`, a distance `spacing` apart, in segments of `length` values that overlap by a half. The
/// mean of each segment is subtracted. At least one segment must fit.
pub fn welch(values: &[f64], spacing: f64, length: usize) -> Periodogram {
    let transform = RealTransform::new(length);
    let window: Vec<f64> =
        (0..length).map(|i| 0.5 - 0.5 * (2.0 * PI * (i as f64 + 0.5) / length as f64).cos()).collect();
    let power: f64 = window.iter().map(|weight| weight * weight).sum();
    let (mut sums, mut segments) = (vec![0.0; length / 2], 0.0_f64);
    for segment in values.windows(length).step_by((length / 2).max(1)) {
        let mean = segment.iter().sum::<f64>() / length as f64;
        let line: Vec<f64> =
            segment.iter().zip(&window).map(|(value, weight)| (value - mean) * weight).collect();
        let modes = transform.spectrum(line);
        sums.iter_mut().zip(&modes[1..]).for_each(|(sum, mode)| *sum += mode.norm_sqr());
        segments += 1.0;
    }
    let wave_number = |k: usize| 2.0 * PI * (k + 1) as f64 / (length as f64 * spacing);
    Periodogram {
        wave_numbers: (0..sums.len()).map(wave_number).collect(),
        spectrum: sums.into_iter().map(|sum| sum * spacing / (power * segments)).collect(),
        // Neighbouring segments with a Hann window have a correlation of 1/36 of their periodograms.
        relative_error: ((1.0 + 2.0 / 36.0 * (1.0 - 1.0 / segments)) / segments).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    /// White noise of variance 1/12 and spacing h has the spectrum h/12; the mean over all wave numbers of a record of
    /// n values scatters by about √(2/n).
    #[test]
    fn white_noise_has_a_flat_spectrum() {
        let mut stream = Stream::new(3, Purpose::Sample, 0);
        let values: Vec<f64> = (0..1 << 16).map(|_| stream.uniform() + 5.0).collect();
        let found = welch(&values, 0.1, 1 << 10);
        // The mean of a segment is subtracted: the first wave numbers lose some of their power.
        let mean = found.spectrum[4..].iter().sum::<f64>() / (found.spectrum.len() - 4) as f64;
        assert!((mean / (0.1 / 12.0) - 1.0).abs() < 0.02, "{mean}");
        assert!((found.relative_error - (1.05_f64 / 127.0).sqrt()).abs() < 1e-3);
        assert!((found.wave_numbers[0] - 2.0 * PI / 102.4).abs() < 1e-12);
    }
}
