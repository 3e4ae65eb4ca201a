//! The stiffness of contacts: equal, proportional to the threshold, or a table against the threshold.

use serde::{Deserialize, Serialize};

use crate::error::positive;
use crate::law::Law;
use crate::{Error, Result};

/// Stiffness of a contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Stiffness {
    /// Mean stiffness ⟨k⟩, force per length, independent of the threshold.
    Equal(f64),
    /// k = κ x_s: the factor κ, force per length squared.
    PerThreshold(f64),
    /// k(x_s), interpolated in a table; for contacts without temperature, ageing and delay.
    Tabulated(StiffnessTable),
}

impl Stiffness {
    /// Stiffness k of a contact with this threshold.
    pub fn of(&self, threshold: f64) -> f64 {
        self.unit() * self.weight(threshold)
    }

    /// The unit of results: ⟨k⟩, κ, or 1.
    pub fn unit(&self) -> f64 {
        match self {
            Self::Equal(unit) | Self::PerThreshold(unit) => *unit,
            Self::Tabulated(_) => 1.0,
        }
    }

    /// k in this unit.
    pub fn weight(&self, threshold: f64) -> f64 {
        match self {
            Self::Equal(_) => 1.0,
            Self::PerThreshold(_) => threshold,
            Self::Tabulated(table) => table.at(threshold),
        }
    }

    /// Whether all contacts have the same stiffness.
    pub fn is_equal(&self) -> bool {
        matches!(self, Self::Equal(_))
    }

    /// The table, if this is one.
    pub(crate) fn table(&self) -> Option<&StiffnessTable> {
        match self {
            Self::Tabulated(table) => Some(table),
            Self::Equal(_) | Self::PerThreshold(_) => None,
        }
    }

    /// # Errors
    /// A stiffness that is not a finite number above 0. A table is checked where it is made.
    pub(super) fn check(&self) -> Result<()> {
        match *self {
            Self::Equal(stiffness) => positive("stiffness", stiffness).map(drop),
            Self::PerThreshold(slope) => positive("stiffness.per_threshold", slope).map(drop),
            Self::Tabulated(_) => Ok(()),
        }
    }

    /// The mean stiffness ⟨k⟩ over these thresholds.
    pub fn mean(&self, thresholds: &dyn Law) -> f64 {
        self.unit() * self.mean_weight(thresholds)
    }

    /// ⟨k⟩ in this unit.
    pub(crate) fn mean_weight(&self, thresholds: &dyn Law) -> f64 {
        match self {
            Self::Equal(_) => 1.0,
            Self::PerThreshold(_) => thresholds.mean(),
            Self::Tabulated(table) => table.moment_above(thresholds, -1.0, 1, 0),
        }
    }
}

/// Stiffness against threshold: linear between the rows of a table, constant beyond its ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UncheckedRows")]
pub struct StiffnessTable {
    rows: Vec<(f64, f64)>,
}

/// The rows of a stored table.
#[derive(Deserialize)]
struct UncheckedRows {
    rows: Vec<(f64, f64)>,
}

impl TryFrom<UncheckedRows> for StiffnessTable {
    type Error = Error;

    fn try_from(stored: UncheckedRows) -> Result<Self> {
        Self::new(stored.rows)
    }
}

/// A part of a table where k = offset + slope x_s.
#[derive(Debug, Clone, Copy)]
struct LinearPart {
    low: f64,
    high: f64,
    offset: f64,
    slope: f64,
}

impl StiffnessTable {
    /// A table of thresholds x_s ≥ 0 and stiffnesses k ≥ 0.
    ///
    /// # Errors
    /// Fewer than two rows, thresholds that do not rise from 0 or above, a stiffness below 0, or none above 0.
    pub fn new(rows: Vec<(f64, f64)>) -> Result<Self> {
        if rows.len() < 2 {
            return Err(Error::invalid("threshold", "at least two thresholds", rows.len()));
        }
        for &(threshold, stiffness) in &rows {
            for (key, value) in [("threshold", threshold), ("stiffness", stiffness)] {
                if !(value.is_finite() && value >= 0.0) {
                    return Err(Error::invalid(key, "finite numbers of 0 or more", value));
                }
            }
        }
        if let Some(pair) = rows.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
            let expected = format!("thresholds that rise, after {}", pair[0].0);
            return Err(Error::invalid("threshold", expected, pair[1].0));
        }
        if rows.iter().all(|row| row.1 == 0.0) {
            return Err(Error::invalid("stiffness", "a stiffness above 0", "none"));
        }
        Ok(Self { rows })
    }

    /// Thresholds and stiffnesses.
    pub fn rows(&self) -> &[(f64, f64)] {
        &self.rows
    }

    /// Stiffness k of a contact with this threshold.
    pub fn at(&self, threshold: f64) -> f64 {
        let next = self.rows.partition_point(|row| row.0 <= threshold);
        match (next.checked_sub(1).map(|before| self.rows[before]), self.rows.get(next)) {
            (Some((low, soft)), Some((high, stiff))) => {
                soft + (stiff - soft) * ((threshold - low) / (high - low))
            }
            (Some((_, last)), None) => last,
            (None, _) => self.rows[0].1,
        }
    }

    /// Where the slope of k changes, with the change.
    pub(crate) fn kinks(&self) -> Vec<(f64, f64)> {
        let parts: Vec<_> = self.parts().collect();
        parts.windows(2).map(|pair| (pair[0].high, pair[1].slope - pair[0].slope)).collect()
    }

    fn parts(&self) -> impl Iterator<Item = LinearPart> + '_ {
        let constant = |low, high, offset| LinearPart { low, high, offset, slope: 0.0 };
        let linear = |pair: &[(f64, f64)]| {
            let [(low, soft), (high, stiff)] = [pair[0], pair[1]];
            let slope = (stiff - soft) / (high - low);
            LinearPart { low, high, offset: soft - slope * low, slope }
        };
        let (first, last) = (self.rows[0], self.rows[self.rows.len() - 1]);
        let before = constant(f64::NEG_INFINITY, first.0, first.1);
        let beyond = constant(last.0, f64::INFINITY, last.1);
        std::iter::once(before).chain(self.rows.windows(2).map(linear)).chain([beyond])
    }

    /// ∫ kʲ hⁿ P_c(h) dh over thresholds h above y, j ≤ 2, n ≤ 2; closed, by the moments of the distribution.
    pub(crate) fn moment_above(&self, thresholds: &dyn Law, y: f64, j: u32, n: u32) -> f64 {
        let above = |order: u32, x: f64| match order {
            _ if x == f64::INFINITY => 0.0,
            0 => thresholds.survival(x),
            _ => thresholds.upper_moment(order, x),
        };
        let of_part = |part: LinearPart| {
            let [a, b] = [part.offset, part.slope];
            let powers = match j {
                0 => [1.0, 0.0, 0.0],
                1 => [a, b, 0.0],
                _ => [a * a, 2.0 * a * b, b * b],
            };
            let between = |order| above(order, part.low.max(y)) - above(order, part.high);
            let terms = (n..).zip(powers).filter(|(_, factor)| *factor != 0.0);
            terms.map(|(order, factor)| factor * between(order)).sum::<f64>()
        };
        self.parts().filter(|part| part.high > y).map(of_part).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Gaussian;

    fn table() -> StiffnessTable {
        StiffnessTable::new(vec![(0.5, 2.0), (1.0, 1.0), (1.2, 4.0)]).unwrap()
    }

    #[test]
    fn it_is_linear_between_rows_and_constant_beyond() {
        let stiffness = [0.1, 0.5, 0.75, 1.0, 1.1, 1.2, 9.0].map(|x| table().at(x));
        let expected = [2.0, 2.0, 1.5, 1.0, 2.5, 4.0, 4.0];
        // 1.1 and 1.2 are rounded, and their difference loses a digit.
        assert!(stiffness.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{stiffness:?}");
    }

    #[test]
    fn moments_are_sums_over_the_parts() {
        let law = Gaussian::new(1.0, 0.2).unwrap();
        for (y, j, n) in [(-1.0, 1, 0), (0.4, 1, 2), (0.9, 2, 0), (1.05, 2, 1), (1.4, 1, 1)] {
            // The midpoint rule with 4e5 points: 1e-10 with kinks on its grid.
            let (high, count) = (3.0, 400_000);
            let low = f64::max(y, 0.0);
            let step = (high - low) / f64::from(count);
            let value = |i| {
                let h = low + (f64::from(i) + 0.5) * step;
                table().at(h).powi(j as i32) * h.powi(n as i32) * law.density(h) * step
            };
            let sum: f64 = (0..count).map(value).sum();
            assert!((table().moment_above(&law, y, j, n) - sum).abs() < 1e-9, "{y} {j} {n}");
        }
    }

    #[test]
    fn wrong_tables_are_refused() {
        for (rows, key) in [
            (vec![(1.0, 1.0)], "threshold"),
            (vec![(1.0, 1.0), (1.0, 2.0)], "threshold"),
            (vec![(f64::NAN, 1.0), (1.0, 2.0)], "threshold"),
            (vec![(0.5, -1.0), (1.0, 2.0)], "stiffness"),
            (vec![(0.5, 0.0), (1.0, 0.0)], "stiffness"),
        ] {
            let error = StiffnessTable::new(rows).unwrap_err();
            assert!(matches!(&error, Error::Invalid { key: found, .. } if found == key), "{error}");
        }
    }
}
