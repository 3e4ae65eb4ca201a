//! The values from which a search in the likelihood of forces at several velocities begins.
//!
//! Friction is a flat function of velocity far from the rates of the contacts, where a search finds no direction. Contacts whose
//! times are all a times as long have at the velocity v the friction of the first ones at av: one curve over a wide range of
//! velocities gives the curve of every factor.

use super::super::free::{Role, first_coordinates};
use super::likelihood::VelocityLikelihood;
use crate::contacts::{FreeFriction, FreeTime};
use crate::monitor::{Monitor, Part};
use crate::{Error, Result};

/// Factors of all times that are tried, from 1/this to this one.
const WIDEST: f64 = 1e4;
/// Velocities per factor of 10 at which the curve is computed: between them it is taken for straight.
const PER_DECADE: f64 = 2.0;
/// Factors per factor of 10.
const FACTORS: i32 = 8;

/// Numbers of contacts that are times, or their inverse, with the power of time.
const TIMES: [(&str, f64); 4] =
    [("temperature.attempt_rate", -1.0), ("ageing.time", 1.0), ("ageing.diffusion", -1.0), ("delay", 1.0)];

impl VelocityLikelihood {
    /// The coordinates from which to search, the given ones first.
    ///
    /// # Errors
    /// First values without steady sliding; errors of the solver; stopped by the monitor.
    pub fn first_values(&self, monitor: &mut dyn Monitor) -> Result<Vec<Vec<f64>>> {
        let given = first_coordinates(&self.free);
        let jobs: Vec<(&[f64], f64)> = self.velocities.iter().map(|&v| (given.as_slice(), v)).collect();
        let found = self.frictions(&jobs, &mut Part::new(monitor, 0.0, 0.2))?;
        let Some(friction) = found.into_iter().map(|found| Some(found?.0)).collect::<Option<Vec<f64>>>()
        else {
            let expected = "first values with steady sliding at the measured velocities";
            return Err(Error::invalid("free", expected, "none at the first values"));
        };
        let mut starts = vec![self.with_size(&given, &friction).0];
        starts.extend(self.with_times(&given, &mut Part::new(monitor, 0.2, 0.8))?);
        Ok(starts)
    }

    /// The coordinates with all times of the contacts multiplied by the factor that makes the curve most like the measured one;
    /// `None` where this is 1, or a time of the contacts is not free.
    fn with_times(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<Option<Vec<f64>>> {
        let Some(powers) = self.powers_of_time() else { return Ok(None) };
        let [Some(&low), Some(&high)] = [self.velocities.first(), self.velocities.last()] else {
            return Ok(None);
        };
        let (low, high) = ((low / WIDEST).ln(), (high * WIDEST).ln());
        let count = ((high - low) / std::f64::consts::LN_10 * PER_DECADE).ceil() as usize + 1;
        let at = |i: usize| low + (high - low) * i as f64 / (count - 1) as f64;
        let jobs: Vec<(&[f64], f64)> = (0..count).map(|i| (coordinates, at(i).exp())).collect();
        let curve: Vec<Option<f64>> =
            self.frictions(&jobs, monitor)?.into_iter().map(|found| Some(found?.0)).collect();
        let interpolated = |logarithm: f64| {
            let place = (logarithm - low) / (high - low) * (count - 1) as f64;
            let i = (place.floor() as usize).min(count - 2);
            let [below, above] = [curve[i]?, curve[i + 1]?];
            Some(below + (above - below) * (place - i as f64))
        };
        let tried = (-4 * FACTORS..=4 * FACTORS).filter_map(|power| {
            let factor = f64::from(power) * std::f64::consts::LN_10 / f64::from(FACTORS);
            let friction = self.velocities.iter().map(|v| interpolated(v.ln() + factor));
            let friction = friction.collect::<Option<Vec<f64>>>()?;
            let (sized, squares) = self.with_size(coordinates, &friction);
            Some((squares, factor, sized))
        });
        let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(best.filter(|best| best.1 != 0.0).map(|(_, factor, mut sized)| {
            powers.iter().zip(&mut sized).for_each(|(power, u)| *u += power * factor);
            sized
        }))
    }

    /// The power of time in each free number; `None` where contacts have no time, or one that is not free.
    fn powers_of_time(&self) -> Option<Vec<f64>> {
        let rules = &self.fit.contacts.rules;
        if matches!(rules.delay, FreeTime::Distributed(_)) || rules.free_friction != FreeFriction::default() {
            return None;
        }
        let power = |name: &str| TIMES.iter().find(|time| time.0 == name).map(|time| time.1);
        let known = self.parameters();
        let mut times = known.iter().filter(|name| power(name).is_some()).peekable();
        times.peek()?;
        let is_free = |name: &&String| self.free.iter().any(|parameter| parameter.name == **name);
        let powers = self.free.iter().map(|parameter| power(&parameter.name).unwrap_or(0.0));
        times.all(|name| is_free(&name)).then(|| powers.collect())
    }

    /// The coordinates with the size of the force, and its constant part, that are most like the readings where the contacts have
    /// this friction, as far as they are free; and the sum of squares that is left.
    fn with_size(&self, coordinates: &[f64], friction: &[f64]) -> (Vec<f64>, f64) {
        let place = |roles: &[Role], names: &[&str]| {
            self.free.iter().position(|parameter| {
                roles.contains(&parameter.role)
                    && (names.is_empty() || names.contains(&parameter.name.as_str()))
                    && parameter.prior.is_none()
            })
        };
        // With a temperature barriers are proportional to the stiffness, too.
        let sizes: &[&str] = match self.fit.contacts.rules.temperature {
            None => &["count", "stiffness", "stiffness_per_threshold"],
            Some(_) => &["count"],
        };
        let size = place(&[Role::Contacts], sizes);
        let constant = place(&[Role::Background, Role::Offset], &[]);
        let fixed = self.constant(coordinates);
        let mut line = (1.0, fixed);
        if let Some(found) = self.line(friction, (size.is_some(), constant.is_some()), fixed) {
            line = found;
        }
        let mut sized = coordinates.to_vec();
        if let Some(k) = size {
            sized[k] += line.0.ln();
        }
        if let Some(k) = constant {
            let parameter = &self.free[k];
            sized[k] = parameter.coordinate(parameter.value(sized[k]) + line.1 - fixed);
        }
        (sized, self.squares(friction, line))
    }

    /// The factor of the friction, and the constant, of the least squares, as far as they are free; `None` where a factor would not
    /// be above 0, or a background force.
    fn line(&self, friction: &[f64], (size, constant): (bool, bool), fixed: f64) -> Option<(f64, f64)> {
        let weight = |i: usize| self.fit.curve.errors.as_ref().map_or(1.0, |errors| errors[i].powi(-2));
        let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
            let readings = self.fit.curve.forces.iter().zip(&self.places).enumerate();
            readings.map(|(i, (&force, &place))| weight(i) * of(friction[place], force)).sum()
        };
        let (w, f, y) = (sum(&|_, _| 1.0), sum(&|f, _| f), sum(&|_, y| y));
        let (ff, fy) = (sum(&|f, _| f * f), sum(&|f, y| f * y));
        let (factor, added) = match (size, constant) {
            (false, false) => (1.0, fixed),
            (false, true) => (1.0, (y - f) / w),
            (true, false) => ((fy - fixed * f) / ff, fixed),
            (true, true) => {
                let factor = (w * fy - f * y) / (w * ff - f * f);
                (factor, (y - factor * f) / w)
            }
        };
        let background = self.free.iter().any(|parameter| parameter.role == Role::Background);
        let positive = factor > 0.0 && (!background || added > self.fit.offset);
        (positive && factor.is_finite() && added.is_finite()).then_some((factor, added))
    }

    /// Σ[(y − a F_k − b)/s]² for a factor a and a constant b.
    fn squares(&self, friction: &[f64], (factor, constant): (f64, f64)) -> f64 {
        let readings = self.fit.curve.forces.iter().zip(&self.places).enumerate();
        let square = |(i, (force, &place)): (usize, (&f64, &usize))| {
            let std = self.fit.curve.errors.as_ref().map_or(1.0, |errors| errors[i]);
            ((force - factor * friction[place] - constant) / std).powi(2)
        };
        readings.map(square).sum()
    }
}
