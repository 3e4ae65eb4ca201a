//! The contacts of an interface: number, stiffness, thresholds, re-forming, initial state, and time-dependent
//! rules.

mod ageing;
mod averaged_rate;
mod free_time;
mod stiffness;
mod temperature;

pub use crate::rate_dependent::FreeFriction;
pub(crate) use ageing::{
    AgeWeights, Label, MaturingTable, NodalLabels, Rank, ThresholdDensity, ThresholdTrajectory, mean_advance,
    self_consistent_advance, starts,
};
pub use ageing::{
    Ageing, AgeingRule, Closure, SharedRanks, ThresholdEvolution, ThresholdFokkerPlanck, ThresholdsAtAge,
};
pub(crate) use averaged_rate::AveragedRate;
pub use free_time::FreeTime;
pub use stiffness::{Stiffness, StiffnessTable};
pub use temperature::{Barrier, Hazard, Temperature};

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::positive;
use crate::law::{Law, Point, SharedLaw, Truncated, Zone};
use crate::{Error, Result};

/// The contacts of an interface.
#[derive(Debug, Clone)]
pub struct Contacts {
    /// Number of contacts N_c.
    pub count: f64,
    /// Stiffness of a contact.
    pub stiffness: Stiffness,
    /// Distribution P_c of thresholds.
    pub thresholds: SharedLaw,
    /// Distribution R of the stretches at which contacts re-form.
    pub reforming: SharedLaw,
    /// Time-dependent rules; none by default.
    pub rules: Rules,
}

/// The microscopic rules that make contacts time-dependent. All can be combined, except [`Ageing::MeanField`]
/// with temperature, and [`Hazard::Additive`] with ageing.
#[derive(Debug, Clone, Default)]
pub struct Rules {
    /// Thermally activated breaking below the threshold.
    pub temperature: Option<Temperature>,
    /// Thresholds that change with the age of the contact; P_c is then the distribution of fresh contacts.
    pub ageing: Option<Ageing>,
    /// τ: the time for which a broken contact is free before it re-forms.
    pub delay: FreeTime,
    /// The friction force of a free contact.
    pub free_friction: FreeFriction,
    /// Thresholds of [`Ageing::FrozenRank`], once a solver has computed them.
    pub ranks: SharedRanks,
}

impl Rules {
    /// Whether the velocity of the slider matters.
    pub fn are_time_dependent(&self) -> bool {
        self.temperature.is_some() || self.ageing.is_some() || !self.delay.is_none()
    }

    /// The name of the first rule present.
    pub fn first(&self) -> Option<&'static str> {
        let rules = [
            ("temperature", self.temperature.is_some()),
            ("ageing", self.ageing.is_some()),
            ("delay", !self.delay.is_none()),
        ];
        rules.into_iter().find(|rule| rule.1).map(|rule| rule.0)
    }

    fn check(&self, thresholds: &SharedLaw) -> Result<()> {
        if let Some(temperature) = &self.temperature {
            temperature.check().map_err(|e| e.under("temperature"))?;
            if matches!(self.ageing, Some(Ageing::MeanField { .. })) {
                let expected = "no temperature beside ageing.mean_field, which has no rule for one contact";
                return Err(Error::invalid(
                    "temperature",
                    expected,
                    format!("an energy of {}", temperature.energy),
                ));
            }
        }
        if let (Some(temperature), Some(ageing)) = (&self.temperature, &self.ageing)
            && temperature.is_additive()
        {
            let expected = format!(
                "hazard = \"joint\" beside ageing.{}: the average over thresholds is that of P_c, which ageing changes",
                ageing.name()
            );
            return Err(Error::invalid("temperature.hazard", expected, "additive"));
        }
        if let Some(ageing) = &self.ageing {
            ageing.check(thresholds).map_err(|e| e.under(ageing.name()).under("ageing"))?;
        }
        self.delay.check()?;
        free_time::check_friction(self.free_friction, &self.delay)
    }
}

/// How the stretches at X = 0 and the thresholds go together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Start {
    /// The stretches are those of contacts that hold: thresholds are conditional on x_s > x, and nothing breaks at X = 0.
    #[default]
    Conditional,
    /// Stretches and thresholds are independent: contacts above their threshold break at once and re-form.
    Relaxed,
}

/// The contacts at X = 0.
#[derive(Debug, Clone)]
pub struct Initial {
    /// Distribution Q_ini of stretches.
    pub law: SharedLaw,
    /// Joint distribution with the thresholds.
    pub start: Start,
}

impl Initial {
    /// Contacts that hold, with stretches of this distribution.
    pub fn new(law: SharedLaw) -> Self {
        Self { law, start: Start::Conditional }
    }
}

/// Relaxed contacts, none of them stretched.
impl Default for Initial {
    fn default() -> Self {
        Self::new(Arc::new(Point::new(0.0).expect("0 is a place for a point mass")))
    }
}

/// Fraction of contacts that no result shows.
const NEGLIGIBLE: f64 = 1e-12;

/// The smallest survival at which contacts may be placed.
const HELD: f64 = 1e-9;

/// The narrowest distribution, relative to its position: narrower ones are blurred by rounding of stretches.
const NARROWEST: f64 = 5e-5;

impl Contacts {
    /// Refuses contacts that are not renewed completely at a break, for which the covariance of the force does not follow
    /// from the force after a break: those whose stiffness depends on the threshold, and those that are free for a while.
    pub(crate) fn renew_completely(&self) -> Result<()> {
        if !self.rules.delay.is_none() {
            let found = format!("a delay of {}", self.rules.delay.mean());
            return Err(Error::invalid("delay", "no delay: free contacts have no stretch", found));
        }
        self.have_equal_stiffness()
    }

    /// Refuses a table of stiffnesses, which cohorts in time and lives at a velocity do not have.
    pub(crate) fn have_no_stiffness_table(&self) -> Result<()> {
        if self.stiffness.table().is_none() {
            return Ok(());
        }
        let expected = "no table where contacts are followed in time: stiffness or stiffness_per_threshold, equal or proportional to the threshold";
        Err(Error::invalid("stiffness.of_threshold", expected, "a table"))
    }

    /// Refuses thermal breaking at the rate of the average contact, where a solver follows how many contacts of each threshold
    /// break.
    pub(crate) fn break_by_own_threshold(&self) -> Result<()> {
        if !self.rules.temperature.is_some_and(|temperature| temperature.is_additive()) {
            return Ok(());
        }
        let expected = "hazard = \"joint\" where each contact breaks by its own threshold: where the velocity varies, and where contacts are coupled one by one";
        Err(Error::invalid("temperature.hazard", expected, "additive"))
    }

    /// Refuses stiffnesses that depend on the threshold.
    pub(crate) fn have_equal_stiffness(&self) -> Result<()> {
        let (key, found) = match self.stiffness {
            Stiffness::Equal(_) => return Ok(()),
            Stiffness::PerThreshold(_) => ("stiffness.per_threshold", "k = κ x_s"),
            Stiffness::Tabulated(_) => ("stiffness.of_threshold", "a table"),
        };
        Err(Error::invalid(key, "contacts of equal stiffness", found))
    }

    /// One time-independent contact of stiffness 1: results are per contact and unit stiffness.
    pub fn new(thresholds: SharedLaw, reforming: SharedLaw) -> Self {
        Self { count: 1.0, stiffness: Stiffness::Equal(1.0), thresholds, reforming, rules: Rules::default() }
    }

    /// Checks that contacts survive where they start and where they re-form (S ≥ 1e-9, to be computable), and
    /// that no distribution is too narrow to differ from a point mass.
    ///
    /// # Errors
    /// A number or a stiffness of contacts that is not above 0; thresholds at 0; stretches at or above every threshold; narrow
    /// distributions; invalid rules or combinations.
    pub fn check(&self, initial: &Initial) -> Result<()> {
        positive("count", self.count)?;
        self.stiffness.check()?;
        self.rules.check(&self.thresholds)?;
        if let (Stiffness::Tabulated(_), Some(rule)) = (&self.stiffness, self.rules.first()) {
            let expected = format!(
                "no table beside {rule}: stiffness or stiffness_per_threshold, or no temperature, ageing and delay"
            );
            return Err(Error::invalid("stiffness.of_threshold", expected, "a table"));
        }
        let at_once = 1.0 - self.thresholds.survival(0.0);
        if at_once > NEGLIGIBLE {
            let found = format!("a fraction {at_once} of the contacts with threshold 0");
            return Err(Error::invalid("thresholds", "thresholds above 0", found));
        }
        resolved("thresholds", self.thresholds.as_ref())?;
        resolved("reforming", self.reforming.as_ref())?;
        resolved("initial", initial.law.as_ref())?;
        self.survives("reforming", self.reforming.as_ref())?;
        match initial.start {
            Start::Conditional => self.survives("initial", initial.law.as_ref()),
            Start::Relaxed => Ok(()),
        }
    }

    /// The stretch above which no contact is placed: S ≥ 1e-9 below it.
    pub(crate) fn highest_start(&self) -> f64 {
        self.thresholds.upper_quantile(HELD)
    }

    /// These contacts and their start, with stretches beyond the thresholds left out: both distributions are conditioned on
    /// stretches at which one contact in 1e9 still holds ([`Truncated`]). Contacts that may break at once
    /// ([`Start::Relaxed`]) are all kept. Of a distribution that is mostly beyond the thresholds nothing is left out, and
    /// [`Self::check`] refuses it.
    pub fn truncated(&self, initial: &Initial) -> (Self, Initial) {
        let highest = self.highest_start();
        let within = |law: &SharedLaw| match beyond(law.as_ref(), highest) {
            Some(_) => Truncated::new(law.clone(), highest).map_or(law.clone(), |law| Arc::new(law)),
            None => law.clone(),
        };
        let reforming = within(&self.reforming);
        let held = initial.start == Start::Conditional;
        let law = if held { within(&initial.law) } else { initial.law.clone() };
        (Self { reforming, ..self.clone() }, Initial { law, ..*initial })
    }

    /// The shares of re-formed and of initial contacts that [`Self::truncated`] leaves out, with the argument that gives them,
    /// and the stretch from which on they are left out.
    pub fn left_out(&self, initial: &Initial) -> Vec<(&'static str, f64, f64)> {
        let highest = self.highest_start();
        let held = (initial.start == Start::Conditional).then_some(("initial", &initial.law));
        let laws = [("reforming", &self.reforming)].into_iter().chain(held);
        laws.filter_map(|(key, law)| Some((key, beyond(law.as_ref(), highest)?, highest))).collect()
    }

    fn survives(&self, key: &str, stretches: &dyn Law) -> Result<()> {
        let top = self.highest_start();
        let share = stretches.survival(top.next_down());
        if share <= NEGLIGIBLE {
            return Ok(());
        }
        let highest = self.thresholds.quantile(1.0);
        // Where hardly any contact has thresholds between the two, the message names the end.
        let expected = if highest - top < 1e-6 * top {
            format!("stretches below the highest threshold {highest}, where contacts still hold")
        } else {
            format!("stretches below {top:.6}, where one contact in 1e9 still holds")
        };
        Err(Error::invalid(key, expected, format!("a fraction {share} of the contacts at or above it")))
    }
}

/// The share of stretches at `highest` or above, if it is neither negligible nor more than half.
fn beyond(stretches: &dyn Law, highest: f64) -> Option<f64> {
    let share = stretches.survival(highest.next_down());
    (share > NEGLIGIBLE && share <= 0.5).then_some(share)
}

fn resolved(key: &str, law: &dyn Law) -> Result<()> {
    let width = |zone: &Zone| zone.resolution.min(zone.high - zone.low);
    let narrow = law.zones().into_iter().find(|zone| width(zone) < NARROWEST * zone.high);
    narrow.map_or(Ok(()), |zone| {
        let expected = format!("a distribution wider than {NARROWEST:e} of its stretches (or a point)");
        Err(Error::invalid(key, expected, format!("a width of {:e} near {}", width(&zone), zone.high)))
    })
}
