//! The covariance of the errors of readings, its factor, and what the likelihood needs of its derivatives.

use std::sync::OnceLock;

use faer::Mat;

use super::Measurement;
use super::hierarchical::{Factor, Hierarchical};
use super::matrix::product;

/// Errors of the elements of a covariance that count as none, in multiples of the variance of the independent error of a reading:
/// of 2000 readings, −2 ln L changes by some 1e-9.
pub(super) const NEGLIGIBLE: f64 = 1e-7;

/// The sizes of errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ErrorSizes {
    /// Factor of the covariance of the noise of contacts.
    pub noise: f64,
    /// Standard deviation of the independent error of a reading.
    pub reading: f64,
    /// Standard deviation and correlation length of the drift; without one, 0 and any length.
    pub drift: [f64; 2],
}

/// The parts of a covariance whose sizes may be free: the noise of contacts by its factor, the others by the logarithms of
/// their numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ErrorPart {
    Noise,
    Reading,
    DriftAmplitude,
    DriftLength,
}

/// The part of a covariance that is known where some readings are expected.
#[derive(Debug, Clone)]
pub(super) enum KnownCovariance {
    None,
    /// C: the covariance of the noise of contacts.
    Contacts(Hierarchical),
    /// D: the variances of the forces that errors of the positions make.
    Positions(Vec<f64>),
}

/// The covariance of the errors of a curve, Σ = (a C or D) + σ² + A² exp(−|y − y'|/ℓ), with its Cholesky factor. For the variance of a
/// mean of readings, |y − y'| is their mean distance, short beside ℓ.
#[derive(Debug)]
pub(super) enum ErrorCovariance {
    /// Independent errors of this standard deviation.
    White(f64),
    /// A matrix and its factor.
    Dense(Box<DenseCovariance>),
}

#[derive(Debug)]
pub(super) struct DenseCovariance {
    sizes: ErrorSizes,
    /// A² exp(−|y − y'|/ℓ), if there is a drift.
    drift: Option<Mat<f64>>,
    factor: Factor,
    /// What the likelihood needs of the inverse, once it has been needed, and the parts for which: those of one likelihood.
    traces: OnceLock<(Vec<ErrorPart>, Traces)>,
}

impl ErrorCovariance {
    /// The covariance of errors of these sizes beside what is known; `None` if it is not positive definite.
    pub fn new(measured: &Measurement, known: &KnownCovariance, sizes: ErrorSizes) -> Option<Self> {
        let [amplitude, length] = sizes.drift;
        let variance = sizes.reading * sizes.reading;
        let tolerance = NEGLIGIBLE * variance;
        let n = measured.positions.len();
        let drift = (amplitude > 0.0).then(|| {
            let correlation = |i: usize, j: usize| (-measured.distance(i, j) / length).exp();
            Mat::from_fn(n, n, |i, j| amplitude * amplitude * correlation(i, j))
        });
        let mut covariance = match (&drift, known) {
            (None, KnownCovariance::None) => return Some(Self::White(sizes.reading)),
            (None, KnownCovariance::Contacts(noise)) => noise.scaled(sizes.noise, variance),
            (None, KnownCovariance::Positions(_)) => Hierarchical::diagonal_of(&vec![variance; n]),
            (Some(drift), known) => {
                let mut both = drift.clone();
                if let KnownCovariance::Contacts(noise) = known {
                    noise.add_to(both.as_mut(), sizes.noise);
                }
                Hierarchical::new(both.as_ref(), tolerance).scaled(1.0, variance)
            }
        };
        if let KnownCovariance::Positions(variances) = known {
            covariance.add_diagonal(variances);
        }
        let factor = covariance.factor(tolerance)?;
        Some(Self::Dense(Box::new(DenseCovariance { sizes, drift, factor, traces: OnceLock::new() })))
    }

    /// ln |Σ| of `n` readings.
    pub fn log_determinant(&self, n: usize) -> f64 {
        match self {
            Self::White(reading) => 2.0 * n as f64 * reading.ln(),
            Self::Dense(dense) => dense.factor.log_determinant(),
        }
    }

    /// Replaces M by L⁻¹M, Σ = LLᵀ.
    pub fn whiten(&self, matrix: &mut Mat<f64>) {
        match self {
            Self::White(reading) => *matrix *= faer::Scale(1.0 / reading),
            Self::Dense(dense) => dense.factor.whiten(matrix.as_mut()),
        }
    }

    /// Replaces M by Σ⁻¹M.
    fn solve(&self, matrix: &mut Mat<f64>) {
        match self {
            Self::White(reading) => *matrix *= faer::Scale(1.0 / (reading * reading)),
            Self::Dense(dense) => dense.factor.solve(matrix.as_mut()),
        }
    }

    /// What the restricted likelihood needs of the derivatives of Σ by `parts`, for the derivatives J of a curve.
    pub fn along_curve(
        &self,
        measured: &Measurement,
        parts: &[ErrorPart],
        derivatives: &Mat<f64>,
    ) -> AlongCurve {
        let mut solved = derivatives.clone();
        self.solve(&mut solved);
        let changed = |part: &ErrorPart| match self {
            Self::White(reading) if *part == ErrorPart::Reading => {
                &solved * faer::Scale(2.0 * reading * reading)
            }
            Self::White(_) => Mat::zeros(solved.nrows(), solved.ncols()),
            Self::Dense(dense) => dense.changed(*part, measured, (derivatives, &solved)),
        };
        let mut changed: Vec<Mat<f64>> = parts.iter().map(changed).collect();
        let changes = changed.iter().map(|changed| product(solved.transpose(), changed.as_ref())).collect();
        changed.iter_mut().for_each(|changed| self.whiten(changed));
        let traces =
            Mat::from_fn(parts.len(), parts.len(), |a, b| trace_of_transposed(&changed[a], &changed[b]));
        AlongCurve { changes, traces }
    }

    /// What the likelihood needs of the derivatives of Σ by `parts`, for the residuals r.
    pub fn derivatives(
        &self,
        measured: &Measurement,
        parts: &[ErrorPart],
        residuals: &Mat<f64>,
    ) -> CovarianceDerivatives {
        match self {
            Self::White(reading) => CovarianceDerivatives::white(*reading, parts, residuals),
            Self::Dense(dense) => dense.derivatives(measured, parts, residuals),
        }
    }
}

/// With P_b = Σ⁻¹ ∂Σ/∂b for the parts b, and z = Σ⁻¹r.
#[derive(Debug)]
pub(super) struct CovarianceDerivatives {
    /// ½(tr P_b − zᵀ ∂Σ/∂b z): half the derivative of −2 ln L.
    pub slope: Vec<f64>,
    /// ½ tr(P_a P_b): the expected information.
    pub information: Mat<f64>,
}

impl CovarianceDerivatives {
    fn white(reading: f64, parts: &[ErrorPart], residuals: &Mat<f64>) -> Self {
        let n = residuals.nrows() as f64;
        let misfit = residuals.squared_norm_l2() / (reading * reading);
        let (slope, information) = parts
            .iter()
            .map(|part| if *part == ErrorPart::Reading { (n - misfit, 2.0 * n) } else { (0.0, 0.0) })
            .unzip::<_, _, Vec<_>, Vec<_>>();
        let information =
            Mat::from_fn(parts.len(), parts.len(), |i, j| if i == j { information[i] } else { 0.0 });
        Self { slope, information }
    }
}

/// With Z = Σ⁻¹J and the derivatives Σ_b of Σ by the parts b.
#[derive(Debug)]
pub(super) struct AlongCurve {
    /// ZᵀΣ_bZ.
    pub changes: Vec<Mat<f64>>,
    /// tr(ZᵀΣ_aΣ⁻¹Σ_bZ).
    pub traces: Mat<f64>,
}

/// tr P_a and tr(P_a P_b).
#[derive(Debug)]
struct Traces {
    single: Vec<f64>,
    double: Mat<f64>,
}

impl DenseCovariance {
    fn derivatives(
        &self,
        measured: &Measurement,
        parts: &[ErrorPart],
        residuals: &Mat<f64>,
    ) -> CovarianceDerivatives {
        let mut z = residuals.clone();
        self.factor.solve(z.as_mut());
        let misfit =
            |part: &ErrorPart| trace_of_transposed(&z, &self.changed(*part, measured, (residuals, &z)));
        let traces = || match self.drift {
            None => self.traces_without_drift(parts, measured.positions.len()),
            Some(_) => self.traces(parts, &self.factor.inverse(), measured),
        };
        let (of, traces) = self.traces.get_or_init(|| (parts.to_vec(), traces()));
        assert_eq!(of, parts, "the covariance of another likelihood");
        let slope = parts.iter().zip(&traces.single).map(|(part, trace)| 0.5 * (trace - misfit(part)));
        CovarianceDerivatives { slope: slope.collect(), information: &traces.double * faer::Scale(0.5) }
    }

    /// Σ_b Σ⁻¹M with the derivative Σ_b of Σ by a part, for M and Σ⁻¹M.
    fn changed(
        &self,
        part: ErrorPart,
        measured: &Measurement,
        (matrix, solved): (&Mat<f64>, &Mat<f64>),
    ) -> Mat<f64> {
        let white = || solved * faer::Scale(self.sizes.reading * self.sizes.reading);
        let none = || Mat::zeros(solved.nrows(), solved.ncols());
        let slow = || self.drift.as_ref().map_or_else(none, |drift| product(drift.as_ref(), solved.as_ref()));
        match part {
            ErrorPart::Noise => matrix - white() - slow(),
            ErrorPart::Reading => white() * faer::Scale(2.0),
            ErrorPart::DriftAmplitude => slow() * faer::Scale(2.0),
            ErrorPart::DriftLength => product(self.lengthened(measured).as_ref(), solved.as_ref()),
        }
    }

    fn traces(&self, parts: &[ErrorPart], inverse: &Mat<f64>, measured: &Measurement) -> Traces {
        let (n, count) = (measured.positions.len(), parts.len());
        let relative: Vec<Mat<f64>> =
            parts.iter().map(|&part| self.relative(part, inverse, measured)).collect();
        let trace = |relative: &Mat<f64>| (0..n).map(|i| relative[(i, i)]).sum();
        let mut double = Mat::zeros(count, count);
        for a in 0..count {
            for b in 0..=a {
                let trace = trace_of_product(&relative[a], &relative[b]);
                (double[(a, b)], double[(b, a)]) = (trace, trace);
            }
        }
        Traces { single: relative.iter().map(trace).collect(), double }
    }

    /// The same without drift, from tr Σ⁻¹ and tr Σ⁻² alone: P is 2σ²Σ⁻¹ for the reading, 1 − σ²Σ⁻¹ for the noise.
    fn traces_without_drift(&self, parts: &[ErrorPart], n: usize) -> Traces {
        let variance = self.sizes.reading * self.sizes.reading;
        let [once, twice] = self.factor.traces_of_inverse();
        let (once, twice) = (variance * once, variance * variance * twice);
        // P = p + q σ²Σ⁻¹.
        let factors = |part: &ErrorPart| match part {
            ErrorPart::Noise => [1.0, -1.0],
            ErrorPart::Reading => [0.0, 2.0],
            ErrorPart::DriftAmplitude | ErrorPart::DriftLength => [0.0; 2],
        };
        let factors: Vec<[f64; 2]> = parts.iter().map(factors).collect();
        let n = n as f64;
        let double = |[p, q]: [f64; 2], [r, s]: [f64; 2]| p * r * n + (p * s + q * r) * once + q * s * twice;
        Traces {
            single: factors.iter().map(|[p, q]| p * n + q * once).collect(),
            double: Mat::from_fn(parts.len(), parts.len(), |a, b| double(factors[a], factors[b])),
        }
    }

    /// Σ⁻¹ ∂Σ/∂b. The parts add up to Σ, so that the largest one follows from the others.
    fn relative(&self, part: ErrorPart, inverse: &Mat<f64>, measured: &Measurement) -> Mat<f64> {
        let variance = self.sizes.reading * self.sizes.reading;
        match part {
            ErrorPart::Reading => inverse * faer::Scale(2.0 * variance),
            ErrorPart::DriftAmplitude => self
                .drift
                .as_ref()
                .map_or_else(|| Mat::zeros(0, 0), |drift| inverse * drift * faer::Scale(2.0)),
            ErrorPart::DriftLength => inverse * self.lengthened(measured),
            ErrorPart::Noise => {
                let n = measured.positions.len();
                let mut rest = inverse * faer::Scale(-variance);
                if let Some(drift) = &self.drift {
                    rest -= inverse * drift;
                }
                for i in 0..n {
                    rest[(i, i)] += 1.0;
                }
                rest
            }
        }
    }

    /// The derivative of the covariance of the drift by ln ℓ.
    fn lengthened(&self, measured: &Measurement) -> Mat<f64> {
        let n = measured.positions.len();
        let length = self.sizes.drift[1];
        let Some(drift) = &self.drift else { return Mat::zeros(n, n) };
        Mat::from_fn(n, n, |i, j| drift[(i, j)] * measured.distance(i, j) / length)
    }
}

/// tr AᵀB.
fn trace_of_transposed(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    (0..a.ncols()).map(|j| a.col(j).transpose() * b.col(j)).sum()
}

/// tr(AB).
pub(super) fn trace_of_product(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    trace_of_transposed(&a.transpose().to_owned(), b)
}
