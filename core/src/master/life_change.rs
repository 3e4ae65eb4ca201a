//! How what a pull is computed from, the lives of the contacts, changes with a parameter.

use super::MasterEquation;
use super::parameters::Named;
use crate::contacts::{FreeTime, Start};
use crate::law::{EIGHTH_ORDER, SurvivalDerivative};
use crate::life::{
    AdvanceMap, FAINT, LawDerivatives, Life, LifeDerivative, LifePair, StartingContacts, points,
};
use crate::monitor::{Monitor, Part};
use crate::numerics::legendre::RULE;
use crate::numerics::volterra::Kernel;
use crate::{Error, Result};

/// The derivatives of the lives and of N_c⟨k⟩ by a parameter θ.
#[derive(Debug, Clone, Default)]
pub(super) struct LifeChange {
    /// Of the life of the contacts at X = 0; `None` for 0.
    pub(super) first: Option<LifeDerivative>,
    /// Of the life of contacts that re-form, without what `wait` does.
    pub(super) reformed: Option<LifeDerivative>,
    /// ∂w/∂θ of the advance w for which contacts are free before they re-form, by which their life is shifted.
    pub(super) wait: f64,
    /// ∂ ln(N_c⟨k⟩)/∂θ.
    pub(super) scale: f64,
}

impl MasterEquation {
    /// The changes by several parameters: in closed form by those of the distributions of time-independent contacts of
    /// equal stiffness, all in one pass; else by differences of the lives.
    pub(super) fn life_changes(&self, names: &[&str], monitor: &mut dyn Monitor) -> Result<Vec<LifeChange>> {
        let named = names.iter().map(|name| self.named(name)).collect::<Result<Vec<_>>>()?;
        let by_laws = named.iter().map(|named| self.law_derivative(*named)).collect::<Result<Vec<_>>>()?;
        let closed = !self.contacts.rules.are_time_dependent() && self.contacts.stiffness.is_equal();
        if closed {
            let by_laws = by_laws.into_iter().flatten().collect();
            return self.closed_changes(&named, by_laws, monitor);
        }
        let share = 1.0 / names.len().max(1) as f64;
        let parts = named.iter().enumerate();
        parts
            .map(|(k, &named)| self.change(named, &mut Part::new(monitor, k as f64 * share, share)))
            .collect()
    }

    /// ∂S/∂θ of the distribution that a parameter belongs to, if it does.
    fn law_derivative(&self, named: Named<'_>) -> Result<Option<(&'static str, SurvivalDerivative)>> {
        let Named::OfLaw(owner, name) = named else { return Ok(None) };
        let mut all = self.description();
        let Some(law) = all.law(owner) else { return Ok(None) };
        law.survival_derivative(name)
            .map(|derivative| Some((owner, derivative)))
            .map_err(|error| error.under(owner))
    }

    /// The changes where lives have derivatives in closed form; `by_laws` are those of the distributions, in order.
    fn closed_changes(
        &self,
        named: &[Named<'_>],
        by_laws: Vec<(&str, SurvivalDerivative)>,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<LifeChange>> {
        let [mut thresholds, mut reforming, mut initial] = [const { Vec::new() }; 3];
        for (owner, derivative) in by_laws {
            match owner {
                "thresholds" => thresholds.push(derivative),
                "reforming" => reforming.push(derivative),
                _ => initial.push(derivative),
            }
        }
        let starting = |starts, conditional, life| StartingContacts {
            contacts: &self.contacts,
            starts,
            conditional,
            life,
        };
        let conditional = self.initial.start == Start::Conditional;
        let mut first = starting(&self.initial.law, conditional, &self.first).derivatives(
            LawDerivatives { thresholds: &thresholds, starts: &initial },
            &mut Part::new(monitor, 0.0, 0.5),
        )?;
        let by_initial = first.split_off(thresholds.len());
        let alike = self.starts_reformed();
        let mut reformed = starting(&self.contacts.reforming, true, &self.reformed).derivatives(
            LawDerivatives { thresholds: if alike { &[] } else { &thresholds }, starts: &reforming },
            &mut Part::new(monitor, 0.5, 0.5),
        )?;
        let by_reforming = reformed.split_off(if alike { 0 } else { thresholds.len() });
        let reformed = if alike { first.clone() } else { reformed };
        let mut by_thresholds = first.into_iter().zip(reformed);
        let (mut by_initial, mut by_reforming) = (by_initial.into_iter(), by_reforming.into_iter());
        let change = |named: &Named<'_>| match named {
            Named::OfLaw("thresholds", _) => {
                let (first, reformed) = by_thresholds.next().unzip();
                LifeChange { first, reformed, ..LifeChange::default() }
            }
            Named::OfLaw("reforming", _) => {
                LifeChange { reformed: by_reforming.next(), ..LifeChange::default() }
            }
            Named::OfLaw(..) => LifeChange { first: by_initial.next(), ..LifeChange::default() },
            Named::Number(_) => {
                LifeChange { scale: 1.0 / self.description().value(*named), ..LifeChange::default() }
            }
        };
        Ok(named.iter().map(change).collect())
    }

    /// The change by one parameter, with differences of the lives if it changes them by more than a shift.
    fn change(&self, named: Named<'_>, monitor: &mut dyn Monitor) -> Result<LifeChange> {
        let (all, rules) = (self.description(), &self.contacts.rules);
        let reshapes = match named {
            Named::Number("count" | "delay") => false,
            // Barriers are proportional to the stiffness.
            // So are lengths of the force of free contacts.
            Named::Number("stiffness" | "stiffness_per_threshold") => {
                rules.temperature.is_some() || !rules.free_friction.is_none()
            }
            Named::Number("velocity") => {
                let friction = rules.free_friction.viscosity > 0.0;
                rules.temperature.is_some()
                    || rules.ageing.is_some()
                    || rules.delay.law().is_some()
                    || friction
            }
            _ => true,
        };
        let mut change = LifeChange::default();
        if reshapes {
            change = self.differences(named, monitor)?;
        }
        match named {
            Named::OfLaw("reforming" | "delay", _) => change.first = None,
            Named::OfLaw("initial", _) => change.reformed = None,
            Named::Number("count" | "stiffness" | "stiffness_per_threshold") => {
                change.scale = 1.0 / all.value(named);
            }
            // The advance for which contacts are free is v times the delay.
            Named::Number("delay") => change.wait = self.velocity.unwrap_or_default(),
            Named::Number("velocity") => {
                if let FreeTime::Fixed(time) = rules.delay {
                    change.wait = time;
                }
            }
            _ => {}
        }
        Ok(change)
    }

    /// Central differences of eighth order of both lives in coordinates that move with their edges, over steps on which they
    /// change by [`CHANGE`].
    fn differences(&self, named: Named<'_>, monitor: &mut dyn Monitor) -> Result<LifeChange> {
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
        Ok(LifeChange {
            first: Some(of(&self.first, Self::first_life, |pair| &pair.first)),
            reformed: Some(of(&self.reformed, Self::life, |pair| &pair.reformed)),
            ..LifeChange::default()
        })
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
