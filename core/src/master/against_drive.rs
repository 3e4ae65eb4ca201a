//! The force on a pull against the position of a drive, which is connected to the slider by a machine of finite
//! stiffness.

use super::gradient::Gradient;
use super::pull::Pull;
use crate::numerics::roots::brent_root;

/// Rounding of a position, relative to the distance of the pull.
const SLACK: f64 = 1e-12;

/// The force at positions X_T = X + cF(X) of the drive, with c the compliance of the machine (a length per force) and X the
/// position of the slider.
#[derive(Debug, Clone, PartialEq)]
pub struct AgainstDrive {
    /// Positions X of the slider.
    pub positions: Vec<f64>,
    /// The forces F(X).
    pub forces: Vec<f64>,
    /// dX/dX_T = 1/(1 + cF').
    pub followed: Vec<f64>,
    /// F'(X).
    slopes: Vec<f64>,
}

impl Pull {
    /// The force at rising positions of the drive, in the stable sliding from X = 0. Before the drive at which the slider starts,
    /// X_T = cF(0), the slider rests: the machine has not taken up its play, X = 0 and F = F(0). `None` where the slider slips on
    /// the way, at X_T' = 1 + cF' = 0, or where it would be beyond the distance of the pull.
    pub fn against_drive(&self, compliance: f64, drive: &[f64]) -> Option<AgainstDrive> {
        let positions = self.slider(compliance, drive)?;
        let start = compliance * self.force(0.0);
        let slope = |(&x, &top): (&f64, &f64)| if top < start { 0.0 } else { self.slope(x) };
        let slopes: Vec<f64> = positions.iter().zip(drive).map(slope).collect();
        Some(AgainstDrive {
            forces: positions.iter().map(|&x| self.force(x)).collect(),
            followed: slopes.iter().map(|slope| 1.0 / (1.0 + compliance * slope)).collect(),
            positions,
            slopes,
        })
    }

    /// The positions X of the slider for rising positions X + cF(X) of the drive; 0 before it moves.
    fn slider(&self, compliance: f64, drive: &[f64]) -> Option<Vec<f64>> {
        let last = self.distance();
        if compliance == 0.0 {
            let reached = drive.iter().all(|&x| x <= last * (1.0 + 1e-12));
            return reached.then(|| drive.iter().map(|x| x.max(0.0)).collect());
        }
        let start = compliance * self.force(0.0);
        let mut parts = self.parts_of_cells();
        let mut part = parts.next()?;
        let mut found = Vec::with_capacity(drive.len());
        for &top in drive {
            if top <= start {
                found.push(0.0);
                continue;
            }
            let lead = |cell: usize, x: f64| x + compliance * self.force_in(cell, x);
            let (cell, low, end) = loop {
                let (cell, low, high) = part;
                let end = self.rises_up_to(compliance, part);
                if lead(cell, end) >= top {
                    break (cell, low, end);
                }
                if end < high {
                    return None;
                }
                part = parts.next()?;
                // The force falls where contacts break together.
                if lead(part.0, part.1) < lead(cell, high) - SLACK * last {
                    return None;
                }
            };
            found.push(brent_root(|x| lead(cell, x) - top, low, end, 1e-14 * last).unwrap_or(low));
        }
        Some(found)
    }

    /// Where X + cF(X) begins to fall on a part of a cell, its upper end if it does not.
    fn rises_up_to(&self, compliance: f64, (cell, low, high): (usize, f64, f64)) -> f64 {
        let slope = |x: f64| 1.0 + compliance * self.slope_in(cell, x);
        if slope(low) <= 0.0 {
            return low;
        }
        let middle = 0.5 * (low + high);
        let falls = [(low, middle), (middle, high)].into_iter().find(|&(_, end)| slope(end) <= 0.0);
        falls.map_or(high, |(from, to)| brent_root(slope, from, to, 0.0).unwrap_or(from))
    }
}

impl AgainstDrive {
    /// ∂F/∂θ at fixed positions of the drive, F_θ/(1 + cF') with F_θ that at fixed X.
    pub fn by_parameter(&self, gradient: &Gradient) -> Vec<f64> {
        let places = self.positions.iter().zip(&self.followed);
        places.map(|(&x, followed)| gradient.at(x) * followed).collect()
    }

    /// ∂F/∂c at fixed positions of the drive, −F F'/(1 + cF').
    pub fn by_compliance(&self) -> Vec<f64> {
        self.by_drive().into_iter().zip(&self.forces).map(|(slope, force)| -force * slope).collect()
    }

    /// The same with entry i moved to the place `order[i]`.
    pub fn at_places(&self, order: &[usize]) -> Self {
        let moved = |sorted: &[f64]| {
            let mut values = vec![0.0; sorted.len()];
            order.iter().zip(sorted).for_each(|(&place, &value)| values[place] = value);
            values
        };
        Self {
            positions: moved(&self.positions),
            forces: moved(&self.forces),
            followed: moved(&self.followed),
            slopes: moved(&self.slopes),
        }
    }

    /// dF/dX_T = F'/(1 + cF').
    pub fn by_drive(&self) -> Vec<f64> {
        self.slopes.iter().zip(&self.followed).map(|(slope, followed)| slope * followed).collect()
    }
}
