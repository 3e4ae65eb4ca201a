//! Random scales of the cells.

use rand_distr::{Distribution as _, StandardNormal};

use crate::random::{Purpose, Stream};
use crate::{Error, Result};

/// Scales s_j = 1 + `std` z_j of `number` cells, with a standard normal z_j from the random stream of cell j.
///
/// # Errors
/// A scale that is not above 0, naming its cell: its thresholds would be negative.
pub fn scales(number: usize, std: f64, seed: u64) -> Result<Vec<f64>> {
    let scale = |cell: usize| {
        let z: f64 = StandardNormal.sample(&mut Stream::new(seed, Purpose::Cells, cell as u64));
        let scale = 1.0 + std * z;
        if scale > 0.0 {
            return Ok(scale);
        }
        let expected = "scales that leave all thresholds above 0";
        let found = format!("{std}, by which that of cell {cell} is {scale}");
        Err(Error::invalid("std", expected, found))
    };
    (0..number).map(scale).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and standard deviation of 10⁵ scales within 4 standard errors.
    #[test]
    fn scales_have_their_mean_and_scatter() {
        let (number, std) = (100_000, 0.1);
        let scales = scales(number, std, 3).unwrap();
        let mean = scales.iter().sum::<f64>() / number as f64;
        let variance = scales.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / number as f64;
        let error = std / (number as f64).sqrt();
        assert!((mean - 1.0).abs() < 4.0 * error, "{mean}");
        assert!((variance.sqrt() - std).abs() < 4.0 * error / std::f64::consts::SQRT_2, "{variance}");
    }

    #[test]
    fn a_negative_scale_names_its_cell() {
        let error = scales(1000, 0.5, 1).unwrap_err().to_string();
        assert!(error.starts_with("std: ") && error.contains("0.5, by which that of cell "), "{error}");
    }
}
