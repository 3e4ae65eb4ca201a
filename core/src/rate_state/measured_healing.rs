//! Healing from measured slide–hold–slide tests.

use std::f64::consts::LN_10;

use serde::{Deserialize, Serialize};

use super::generalised::{GeneralisedFit, ROUNDING, ScaledCurve, straight};
use super::healing::{LONGEST, SHORTEST, check_holds};
use super::{MeasuredValue, extent};
use crate::monitor::Monitor;
use crate::{Error, Result};

/// Parameters of the growth: the force, the healing rate and the cutoff time.
const PARAMETERS: usize = 3;

/// Healing in measured slide–hold–slide tests: static friction grows with the logarithm of the hold time,
/// from a cutoff time on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MeasuredHealing {
    /// Healing rate β ln 10, per factor of ten in hold time in the logarithmic regime, a force.
    pub per_decade: MeasuredValue,
    /// Cutoff time t_c; `None` if all holds are so much longer that it cannot be determined.
    pub cutoff: Option<MeasuredValue>,
    /// The fitted force after a hold of 1, a force.
    pub at_one: MeasuredValue,
    /// Root-mean-square residual of the fit, a force.
    pub residual: f64,
}

impl MeasuredHealing {
    /// Fits F_s(t) = F_s(0) + β ln(1 + t/t_c) to static friction after holds, by least squares.
    ///
    /// The scatter of the forces is taken as independent and of the same size for all holds, and is estimated from the
    /// residuals; with few holds Student's distribution makes the intervals wider. A cutoff time a thousand
    /// times shorter than the shortest hold counts as none: then a straight line over ln t is fitted. The intervals, not
    /// the errors, then contain the values for all cutoff times that the forces do not exclude.
    ///
    /// # Errors
    /// Fewer than 4 holds or 3 different hold times, hold times that are not above 0, numbers of different length; forces
    /// that are all the same, and forces whose growth is not logarithmic: in proportion to the hold time, since the longest hold
    /// is not longer than the cutoff time, or not beyond their scatter.
    pub fn read(hold: &[f64], force: &[f64]) -> Result<Self> {
        Self::read_with(hold, force, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::read`]; stopped by the monitor.
    pub fn read_with(hold: &[f64], force: &[f64], monitor: &mut dyn Monitor) -> Result<Self> {
        check(hold, force)?;
        let (shortest, longest) = extent(hold);
        let columns =
            |cutoff: f64| vec![vec![1.0; hold.len()], hold.iter().map(|t| (t / cutoff).ln_1p()).collect()];
        let by_cutoff = |cutoff: f64, coefficients: &[f64]| -> Vec<f64> {
            hold.iter().map(|t| -coefficients[1] * t / (cutoff * (cutoff + t))).collect()
        };
        let curve = ScaledCurve {
            position: hold,
            values: force,
            columns: &columns,
            by_scale: &by_cutoff,
            scales: (SHORTEST * shortest, LONGEST * longest),
        };
        let fit = GeneralisedFit::new(&curve, false, monitor)?.ok_or_else(undetermined)?;
        if fit.scale >= longest {
            let expected = "forces that grow with the logarithm of the hold time";
            return Err(Error::invalid("force", expected, growth(hold, force)));
        }
        let after_one =
            |cutoff: f64| (vec![1.0, (1.0 / cutoff).ln_1p()], vec![0.0, -1.0 / (cutoff * (cutoff + 1.0))]);
        let found = Self {
            per_decade: fit.value(&|_| (vec![0.0, LN_10], vec![0.0; 2])),
            cutoff: Some(fit.scale_value()),
            at_one: fit.value(&after_one),
            residual: fit.residual,
        };
        if fit.scale <= SHORTEST * shortest { found.without_cutoff(hold, force) } else { Ok(found) }
    }

    /// A straight line over the logarithm of the hold time, with intervals that contain those of this fit.
    fn without_cutoff(&self, hold: &[f64], force: &[f64]) -> Result<Self> {
        let columns = vec![vec![1.0; hold.len()], hold.iter().map(|t| t.log10()).collect()];
        let ([at_one, per_decade], residual) = straight(columns, force).ok_or_else(undetermined)?;
        let (at_one, per_decade) = (at_one.widened(self.at_one), per_decade.widened(self.per_decade));
        Ok(Self { per_decade, cutoff: None, at_one, residual })
    }

    /// Sentences about numbers that do not mean what they seem to.
    pub fn warnings(&self) -> Vec<String> {
        let falls = self.per_decade.high.is_some_and(|high| high < 0.0);
        let text = "static friction falls with the hold time: this is no healing";
        if falls { vec![text.into()] } else { Vec::new() }
    }

    /// The fitted static friction after a hold.
    pub fn force_at(&self, hold: f64) -> f64 {
        let cutoff = self.cutoff.map_or(0.0, |cutoff| cutoff.value);
        self.at_one.value + self.per_decade.value * ((hold + cutoff) / (1.0 + cutoff)).log10()
    }
}

/// How forces change that do not grow with the logarithm of the hold time, by the interval of the slope of a straight line over it.
fn growth(hold: &[f64], force: &[f64]) -> &'static str {
    let columns = vec![vec![1.0; hold.len()], hold.to_vec()];
    match straight(columns, force).map(|([_, slope], _)| [slope.low, slope.high]) {
        Some([Some(low), _]) if low > 0.0 => "growth in proportion to the hold time",
        Some([_, Some(high)]) if high < 0.0 => "a fall in proportion to the hold time",
        _ => "no growth beyond their scatter",
    }
}

fn undetermined() -> Error {
    let expected = "forces that determine how they grow with the hold time";
    Error::invalid("force", expected, "ones from which this does not follow")
}

fn check(hold: &[f64], force: &[f64]) -> Result<()> {
    check_holds(hold, [("force", force)])?;
    let mut durations = hold.to_vec();
    durations.sort_by(f64::total_cmp);
    durations.dedup();
    if durations.len() < PARAMETERS {
        let expected = format!("holds of at least {PARAMETERS} different durations");
        return Err(Error::invalid("hold", expected, durations.len()));
    }
    let (low, high) = extent(force);
    if high - low <= ROUNDING * low.abs().max(high.abs()) {
        let expected = "forces that change with the hold time, so that the cutoff time follows";
        return Err(Error::invalid("force", expected, format!("{low} after every hold")));
    }
    Ok(())
}
