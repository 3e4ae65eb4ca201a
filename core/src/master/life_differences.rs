//! Derivatives of the lives of contacts by a parameter, by central differences over steps on which the lives change little.

use super::MasterEquation;
use super::parameters::Named;
use crate::law::EIGHTH_ORDER;
use crate::life::{AdvanceMap, FAINT, Life, LifeDerivative, LifePair, points};
use crate::monitor::{Monitor, Part};
use crate::numerics::legendre::RULE;
use crate::numerics::volterra::Kernel;
use crate::{Error, Result};

impl MasterEquation {
    /// Central differences of eighth order of both lives in coordinates that move with their edges, over steps on which they
    /// change by [`CHANGE`]: that of the contacts at X = 0, and that of contacts that re-form.
    ///
    /// # Errors
    /// A value of 0; edges that cancel each other at this value only; errors of the solver; stopped by the monitor.
    pub(super) fn life_differences(
        &self,
        named: Named<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<[LifeDerivative; 2]> {
        let all = self.description();
        let value = all.value(named);
        if value == 0.0 {
            let expected = "a value inside of the range of the parameter";
            return Err(Error::invalid(named.to_string(), expected, value));
        }
        let mut done = 0.0;
        let mut pair = |distance: f64| -> Result<Varied> {
            let exact = (value + distance) - value;
            let mut at = |value: f64| {
                let share = 0.1 * (1.0 - done);
                done += share;
                all.clone().vary(named, value)?.equation(&mut Part::new(monitor, done - share, share))
            };
            Ok(Varied::new(self, exact, [at(value + exact)?, at(value - exact)?]))
        };
        let pairs = self.pairs(value.abs(), &mut pair, named)?;
        let of = |base: &Life, life: fn(&Self) -> &Life, maps: fn(&Varied) -> &[AdvanceMap; 2]| {
            let weighted = (1..).zip(EIGHTH_ORDER).zip(&pairs).map(|((k, weight), pair)| LifePair {
                weight: weight * f64::from(k) / pair.distance,
                lives: pair.equations.each_ref().map(life),
                maps: maps(pair),
            });
            LifeDerivative::by_differences(base, &weighted.collect::<Vec<_>>())
        };
        Ok([
            of(&self.first, Self::first_life, |pair| &pair.first),
            of(&self.reformed, Self::life, |pair| &pair.reformed),
        ])
    }

    /// The equations at one to four steps to either side of the value.
    fn pairs(
        &self,
        size: f64,
        pair: &mut impl FnMut(f64) -> Result<Varied>,
        named: Named<'_>,
    ) -> Result<Vec<Varied>> {
        let (mut step, mut follows) = self.step(size, pair, named)?;
        loop {
            let pairs: Vec<_> =
                (1..=EIGHTH_ORDER.len()).map(|k| pair(k as f64 * step)).collect::<Result<_>>()?;
            if !follows || pairs.iter().all(|pair| pair.follows) {
                return Ok(if follows { pairs } else { pairs.into_iter().map(Varied::at_rest).collect() });
            }
            // Edges pass each other over the larger steps only.
            step *= 0.1;
            if step < LEAST * size {
                (step, follows) = (self.clear(&pairs[0], size), false);
            }
        }
    }

    /// The step, and whether the edges of the lives can be followed over it. Where several edges that move differently lie on
    /// each other, they cannot: then the step is so short that none passes a point at which lives are evaluated.
    ///
    /// # Errors
    /// Edges that cancel each other at this value only.
    fn step(
        &self,
        size: f64,
        pair: &mut impl FnMut(f64) -> Result<Varied>,
        named: Named<'_>,
    ) -> Result<(f64, bool)> {
        /// Changes above this tell little of those over shorter steps.
        const LARGE: f64 = 0.2;
        let mut tiny = TINY * size;
        loop {
            let varied = pair(tiny)?;
            let (change, last) = (varied.change(self), 0.1 * tiny < LEAST * size);
            if varied.follows && (change <= LARGE || last) {
                return Ok(((CHANGE * tiny / change).min(20.0 * tiny), true));
            }
            if last {
                if let Some(place) = self.appeared(&varied) {
                    let expected = "a value at which no edges of distributions cancel each other";
                    let found = format!("edges that do, at the advance {place}");
                    return Err(Error::invalid(named.to_string(), expected, found));
                }
                return Ok((self.clear(&varied, size), false));
            }
            tiny *= 0.1;
        }
    }

    /// An advance at which lives are not smooth for other values of a parameter, but are for this one. There the derivative is
    /// not smooth, and no cell ends.
    fn appeared(&self, varied: &Varied) -> Option<f64> {
        /// How far it is from all edges, as a fraction of the mean life: farther than edges move.
        const FAR: f64 = 1e-3;
        /// Large enough that it is not one of those that are just left out, or not left out any more.
        const SEEN: f64 = 100.0 * FAINT;
        let of = |life: fn(&Self) -> &Life| {
            let (base, far) = (points(life(self), FAINT), FAR * life(self).mean());
            let moved = varied.equations.iter().flat_map(|equation| points(life(equation), SEEN));
            moved.into_iter().find(|x| base.iter().all(|p| (p - x).abs() > far))
        };
        of(Self::first_life).or_else(|| of(Self::life))
    }

    /// A step over four of which no edge of the lives reaches a point at which they are evaluated.
    fn clear(&self, varied: &Varied, size: f64) -> f64 {
        let of = |life: fn(&Self) -> &Life| {
            let (curve, base) = (life(self).survival().curve(), points(life(self), FAINT));
            let nearest = |x: f64| base.iter().map(|p| (p - x).abs()).fold(f64::INFINITY, f64::min);
            let moved = varied.equations.iter().flat_map(|equation| points(life(equation), FAINT));
            let speed = moved.map(nearest).filter(|d| d.is_finite()).fold(0.0, f64::max) / varied.distance;
            let cells = (0..curve.coefficients.len()).map(|cell| curve.cell(cell));
            let edge = |(middle, half): (f64, f64)| nearest(middle - half).min(nearest(middle + half));
            let beside = cells.filter(|&cell| edge(cell) <= 1e-9 * curve.end()).map(|cell| cell.1);
            let outermost = 1.0 + RULE.nodes[0];
            0.125 * outermost * beside.fold(f64::INFINITY, f64::min) / speed
        };
        of(Self::first_life).min(of(Self::life)).clamp(SHORTEST * size, TINY * size)
    }
}

/// Equations with a larger and a smaller value of a parameter, with the maps of advances from the lives of the one between.
struct Varied {
    /// By which the value differs.
    distance: f64,
    equations: [MasterEquation; 2],
    first: [AdvanceMap; 2],
    reformed: [AdvanceMap; 2],
    /// Whether the maps follow the edges of the lives.
    follows: bool,
}

impl Varied {
    fn new(base: &MasterEquation, distance: f64, equations: [MasterEquation; 2]) -> Self {
        let of = |life: fn(&MasterEquation) -> &Life| {
            AdvanceMap::between(life(base), equations.each_ref().map(life))
        };
        let maps = of(MasterEquation::first_life).zip(of(MasterEquation::life));
        let follows = maps.is_some();
        let (first, reformed) = maps.unwrap_or_default();
        Self { distance, equations, first, reformed, follows }
    }

    /// The same without maps, for steps over which no edge passes a point at which lives are evaluated.
    fn at_rest(self) -> Self {
        Self { first: Default::default(), reformed: Default::default(), ..self }
    }

    /// How much the lives change over the distance: half the largest difference of the survivals, or of the breaking densities
    /// relative to the largest one, which tells of details that are far narrower than a life; or the stretching between edges.
    fn change(&self, base: &MasterEquation) -> f64 {
        /// Weight of the stretching, over which lives are smoother than over their details.
        const STRETCHING: f64 = 0.4;
        let of = |life: fn(&MasterEquation) -> &Life, maps: &[AdvanceMap; 2]| {
            let curve = life(base).survival().curve();
            let cells = (0..curve.coefficients.len()).map(|cell| curve.cell(cell));
            let at: Vec<f64> =
                cells.flat_map(|(middle, half)| RULE.nodes.map(|t| middle + half * t)).collect();
            let largest = |of: fn(&Life) -> &Kernel| {
                let value =
                    |side: usize, u: f64| of(life(&self.equations[side])).curve().value(maps[side].at(u));
                let change = at.iter().map(|&u| 0.5 * (value(0, u) - value(1, u)).abs());
                let size = at.iter().map(|&u| of(life(base)).curve().value(u).abs()).fold(0.0, f64::max);
                change.fold(0.0, f64::max) / size.max(f64::MIN_POSITIVE)
            };
            let stretching = maps.iter().map(AdvanceMap::stretching).fold(0.0, f64::max);
            largest(Life::survival).max(largest(Life::breaking)).max(STRETCHING * stretching)
        };
        of(MasterEquation::first_life, &self.first).max(of(MasterEquation::life, &self.reformed))
    }
}

/// Change of the lives over a step: the truncation of the differences is of the order of its eighth power, and errors of the
/// lives are divided by it.
const CHANGE: f64 = 0.02;

/// Relative step at which that change is first estimated.
const TINY: f64 = 1e-3;

/// Smallest relative step over which edges are followed.
const LEAST: f64 = 1e-6;

/// Smallest relative step, which turns errors of lives of 1e-13 into 1e-6 of a derivative.
const SHORTEST: f64 = 1e-7;
