//! The present threshold of a contact from its fresh threshold and its age.

use std::sync::Arc;

pub(crate) use super::ranks::Rank;
use super::ranks::{ContactAtThreshold, RankTable, RanksAtAge};
use super::{Ageing, Contacts, SharedRanks, ThresholdFokkerPlanck, ranks};
use crate::law::{Law, SharedLaw};
use crate::monitor::Monitor;
use crate::numerics::exponential::exp;
use crate::numerics::legendre::{NODES, Nodal};
use crate::numerics::logarithm::ln;
use crate::{Error, Result};

/// The present threshold h of a contact as a function of its fresh threshold h_0 and its age t; h rises with
/// h_0.
///
/// | ageing | h |
/// |---|---|
/// | none | h_0 |
/// | `logarithmic` | h_0 [1 + β ln(1 + t/τ_0)] |
/// | `frozen_rank`, Gaussian to Gaussian | m(t) + s(t) (h_0 − x̄_i)/σ_i, m = x̄_f + (x̄_i − x̄_f) e^{−t/τ}, s² = σ_f² + (σ_i² − σ_f²) e^{−2t/τ} |
/// | `frozen_rank`, other distributions | G(h; t) = G_i(h_0), G the distribution function at age t, solved numerically |
///
/// x̄ and σ are the parameters `mean` and `std`. A threshold below 0 counts as 0.
#[derive(Debug, Clone)]
pub struct ThresholdEvolution {
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    Constant,
    Logarithmic { growth: f64, time: f64 },
    Gaussian { fresh: Normal, mature: Normal, time: f64 },
    Ranked(Arc<RankTable>),
}

/// Parameters of a Gaussian.
#[derive(Debug, Clone, Copy)]
struct Normal {
    mean: f64,
    std: f64,
}

/// The thresholds of contacts of one age.
#[derive(Debug, Clone, Copy)]
pub struct ThresholdsAtAge<'a>(At<'a>);

#[derive(Debug, Clone, Copy)]
enum At<'a> {
    Affine(Affine),
    Ranked(RanksAtAge<'a>),
}

/// What identifies a contact of unknown age: its fresh threshold, and its rank if it keeps that.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Label<'a> {
    /// h_0.
    pub(crate) fresh: f64,
    /// From [`ThresholdEvolution::rank`].
    pub(crate) rank: Option<&'a Rank>,
}

/// The labels of sixteen groups of contacts whose thresholds are asked for at many ages.
#[derive(Debug)]
pub(crate) struct NodalLabels {
    fresh: Nodal,
    ranks: NodalRanks,
}

/// What is known of the ranks of sixteen groups of contacts.
#[derive(Debug)]
enum NodalRanks {
    /// Contacts have no rank, or it is not needed.
    None,
    Each(Box<[Rank; NODES]>),
    /// Their thresholds at each tabulated age.
    Rows(Vec<Nodal>),
}

/// One contact, for its thresholds at many ages.
#[derive(Debug)]
pub(crate) enum ThresholdTrajectory<'a> {
    Affine(&'a ThresholdEvolution, f64),
    Ranked(ranks::RankTrajectory<'a>),
}

/// h = `shift` + `factor` h_0, and the time derivatives of both.
#[derive(Debug, Clone, Copy)]
struct Affine {
    shift: f64,
    factor: f64,
    shift_rate: f64,
    factor_rate: f64,
}

impl ThresholdEvolution {
    /// The evolution of the thresholds of these contacts, which are assumed to have passed
    /// [`Contacts::check`].
    ///
    /// # Errors
    /// Ageing in which the threshold is not a function of age (`smoluchowski`, `mean_field`); `frozen_rank`
    /// with point masses of fresh thresholds, which have no ranks.
    pub fn of(contacts: &Contacts) -> Result<Self> {
        Self::of_with(contacts, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::of`]; stopped by the monitor.
    pub fn of_with(contacts: &Contacts, monitor: &mut dyn Monitor) -> Result<Self> {
        let Some(ageing) = &contacts.rules.ageing else { return Ok(Self { kind: Kind::Constant }) };
        let kind = match ageing {
            &Ageing::Logarithmic { growth, time } => Kind::Logarithmic { growth, time },
            Ageing::FrozenRank { mature, time } => {
                Kind::ranked([&contacts.thresholds, mature], *time, &contacts.rules.ranks, monitor)?
            }
            Ageing::Smoluchowski { .. } | Ageing::MeanField { .. } => {
                let key = format!("ageing.{}", ageing.name());
                let expected = "thresholds that follow from the age of the contact";
                return Err(Error::invalid(key, expected, "thresholds that diffuse"));
            }
        };
        Ok(Self { kind })
    }

    /// Whether h = h_0 at any age.
    pub fn is_constant(&self) -> bool {
        matches!(self.kind, Kind::Constant)
    }

    /// Whether it is known that no threshold falls with age.
    pub(crate) fn only_strengthens(&self) -> bool {
        match self.kind {
            Kind::Constant => true,
            Kind::Logarithmic { growth, .. } => growth >= 0.0,
            // Narrowing distributions weaken their strongest contacts.
            Kind::Gaussian { .. } | Kind::Ranked(_) => false,
        }
    }

    /// Ages, each twice the one before, between which a threshold has at most one extremum, from where the
    /// fresh distribution has hardly changed up to τ. Empty for closed forms.
    pub(crate) fn octaves(&self) -> Vec<f64> {
        if let Kind::Ranked(ranks) = &self.kind { ranks.octaves() } else { Vec::new() }
    }

    /// Estimated error of the distribution function of present thresholds at any age.
    pub fn error(&self) -> f64 {
        match &self.kind {
            Kind::Ranked(ranks) => ranks.error(),
            _ => 0.0,
        }
    }

    /// The thresholds at an age t ≥ 0.
    pub fn at(&self, age: f64) -> ThresholdsAtAge<'_> {
        let affine = match self.kind {
            Kind::Constant => Affine { shift: 0.0, factor: 1.0, shift_rate: 0.0, factor_rate: 0.0 },
            Kind::Logarithmic { growth, time } => Affine {
                shift: 0.0,
                factor: 1.0 + growth * (age / time).ln_1p(),
                shift_rate: 0.0,
                factor_rate: growth / (time + age),
            },
            Kind::Gaussian { fresh, mature, time } => {
                let left = (-age / time).exp();
                // The Ornstein–Uhlenbeck process of a Gaussian P_cf takes Gaussians to Gaussians:
                // mean and variance relax exponentially, and a contact of constant rank keeps its
                // z.
                let mean = mature.mean + (fresh.mean - mature.mean) * left;
                // σ_i² − σ_f² as a product, without cancellation for similar widths.
                let excess = (fresh.std - mature.std) * (fresh.std + mature.std) * left * left;
                let std = (mature.std * mature.std + excess).sqrt();
                let factor = std / fresh.std;
                let factor_rate = -excess / (time * std * fresh.std);
                let mean_rate = (mature.mean - fresh.mean) * left / time;
                Affine {
                    shift: mean - factor * fresh.mean,
                    factor,
                    shift_rate: mean_rate - factor_rate * fresh.mean,
                    factor_rate,
                }
            }
            Kind::Ranked(ref ranks) => return ThresholdsAtAge(At::Ranked(ranks.at(age))),
        };
        ThresholdsAtAge(At::Affine(affine))
    }

    /// A time over which thresholds change smoothly from formation on.
    pub(crate) fn soon(&self) -> f64 {
        /// In units of the time constant of the rule.
        const PART: f64 = 1e-3;
        match &self.kind {
            Kind::Constant => 0.0,
            Kind::Logarithmic { time, .. } | Kind::Gaussian { time, .. } => PART * time,
            Kind::Ranked(ranks) => ranks.soon(),
        }
    }

    /// The time on the scale of which, added to the age, thresholds change: as functions of the age they are singular that long
    /// before formation, or farther away.
    pub(crate) fn time_scale(&self) -> f64 {
        match &self.kind {
            Kind::Constant => f64::INFINITY,
            Kind::Logarithmic { time, .. } => *time,
            Kind::Gaussian { fresh, mature, time } => {
                // Where the variance of a distribution that broadens, followed back in time, is 0.
                let ratio = (fresh.std / mature.std).powi(2);
                if ratio < 1.0 { time * (-0.5 * (-ratio).ln_1p()).min(1.0) } else { *time }
            }
            Kind::Ranked(ranks) => ranks.time_scale(),
        }
    }

    /// The age from which on no threshold falls any more.
    pub(crate) fn settled(&self) -> f64 {
        /// Relaxation times after which nothing is left of the fresh distribution.
        const SETTLED: f64 = 64.0;
        match &self.kind {
            Kind::Constant | Kind::Logarithmic { .. } => 0.0,
            Kind::Gaussian { time, .. } => SETTLED * time,
            Kind::Ranked(ranks) => ranks.oldest(),
        }
    }

    /// The rank of contacts with fresh threshold h_0, if contacts keep it. Thresholds at many ages are found
    /// faster from it.
    pub(crate) fn rank(&self, fresh: f64) -> Option<Rank> {
        if let Kind::Ranked(ranks) = &self.kind { Some(ranks.rank(fresh)) } else { None }
    }

    /// The labels of contacts with these fresh thresholds; if `tabulated`, some of their thresholds at all ages are computed
    /// now, so that the others are interpolated faster.
    pub(crate) fn labels(&self, fresh: Nodal, tabulated: bool) -> NodalLabels {
        let ranks = match &self.kind {
            Kind::Ranked(table) => {
                let each = fresh.map(|h| table.rank(h));
                if tabulated {
                    NodalRanks::Rows(table.rows_of(&each))
                } else {
                    NodalRanks::Each(Box::new(each))
                }
            }
            _ => NodalRanks::None,
        };
        NodalLabels { fresh, ranks }
    }

    /// The contact with fresh threshold h_0.
    pub(crate) fn followed(&self, fresh: f64) -> ThresholdTrajectory<'_> {
        match &self.kind {
            Kind::Ranked(ranks) => ThresholdTrajectory::Ranked(ranks.followed(fresh)),
            _ => ThresholdTrajectory::Affine(self, fresh),
        }
    }

    /// h of a contact with fresh threshold h_0, at an age.
    pub fn threshold(&self, fresh: f64, age: f64) -> f64 {
        self.at(age).threshold(fresh)
    }

    /// A threshold that a contact with fresh threshold h_0 is never below from an age on.
    pub(crate) fn lowest_from(&self, fresh: f64, age: f64) -> f64 {
        match &self.kind {
            Kind::Constant => fresh,
            Kind::Logarithmic { .. } => self.threshold(fresh, age),
            Kind::Gaussian { fresh: begun, mature, time } => {
                let (left, z) = ((-age / time).exp(), (fresh - begun.mean) / begun.std);
                let mean = mature.mean + ((begun.mean - mature.mean) * left).min(0.0);
                // From s(t) now to σ_f, monotonically.
                let excess = (begun.std - mature.std) * (begun.std + mature.std) * left * left;
                let std = (mature.std * mature.std + excess).sqrt();
                (mean + (z * std).min(z * mature.std)).max(0.0)
            }
            Kind::Ranked(_) => self.followed(fresh).lowest(),
        }
    }

    /// ∫ hⁿ dP(h_0) for n = 0, 1 and 2 over the contacts with fresh thresholds above h_0, h their thresholds
    /// at an age and P the distribution of fresh thresholds.
    pub(crate) fn moments_above(&self, law: &dyn Law, fresh: f64, age: f64) -> [f64; 3] {
        let whole = law.survival(fresh);
        let [first, second] = match (&self.kind, &self.at(age).0) {
            (Kind::Gaussian { fresh: born, .. }, At::Affine(aged)) => aged.moments_of(*born, law, fresh),
            (_, At::Affine(aged)) => {
                [1, 2].map(|order| aged.factor.powi(order as i32) * law.upper_moment(order, fresh))
            }
            (_, At::Ranked(aged)) => aged.moments_above(fresh),
        };
        [whole, first, second]
    }

    /// h_0 of a contact whose threshold is h at an age; below 0 if every contact has a higher threshold.
    pub fn fresh(&self, threshold: f64, age: f64) -> f64 {
        self.at(age).fresh(threshold)
    }
}

impl Affine {
    /// ∫ h dP(h_0) and ∫ h² dP(h_0) above h_0 for a Gaussian P truncated at 0. h is Gaussian too; with its mean m and
    /// std s they are S(m + sλ) and S[m² + s² + sλ(2m + sz)], λ the hazard rate at h_0 = x̄ + zσ, per σ.
    fn moments_of(&self, born: Normal, law: &dyn Law, fresh: f64) -> [f64; 2] {
        // Contacts with lower h_0 have the threshold 0.
        let from = fresh.max(-self.shift / self.factor).max(0.0);
        let left = law.survival(from);
        if left == 0.0 {
            return [0.0; 2];
        }
        let [mean, std] = [self.shift + self.factor * born.mean, self.factor * born.std];
        let (z, hazard) = ((from - born.mean) / born.std, born.std * law.hazard(from));
        [
            left * (mean + std * hazard),
            left * (mean * mean + std * std + std * hazard * (2.0 * mean + std * z)),
        ]
    }
}

impl Kind {
    /// Closed form between Gaussians, else a table.
    fn ranked(
        [fresh, mature]: [&SharedLaw; 2],
        time: f64,
        ranks: &SharedRanks,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        if let (Some(fresh), Some(mature)) = (Normal::of(fresh.as_ref()), Normal::of(mature.as_ref())) {
            return Ok(Self::Gaussian { fresh, mature, time });
        }
        if !fresh.atoms().is_empty() {
            let expected = "a distribution with a density, to age by frozen_rank";
            return Err(Error::invalid("thresholds", expected, "thresholds that many contacts share"));
        }
        let compute = || {
            let diffusion = mature.std().powi(2) / time;
            let maturing = ThresholdFokkerPlanck::new(fresh.clone(), mature.clone(), diffusion);
            RankTable::new(fresh, &maturing, time, monitor)
        };
        ranks.table([fresh, mature], time, compute).map(Self::Ranked)
    }
}

impl ThresholdTrajectory<'_> {
    /// h at an age.
    #[inline]
    pub(crate) fn threshold(&self, age: f64) -> f64 {
        match self {
            Self::Affine(strength, fresh) => strength.threshold(*fresh, age),
            Self::Ranked(followed) => followed.threshold(age).max(0.0),
        }
    }

    /// ∂h/∂t at an age.
    pub(crate) fn drift(&self, age: f64) -> f64 {
        match self {
            Self::Affine(strength, fresh) => strength.at(age).drift(*fresh),
            Self::Ranked(followed) => followed.drift(age),
        }
    }

    /// A threshold that h is never below, 0 where none is known.
    pub(crate) fn lowest(&self) -> f64 {
        if let Self::Ranked(followed) = self { followed.lowest() } else { 0.0 }
    }

    /// h at sixteen ages; the loops vectorise.
    #[inline(always)]
    pub(crate) fn thresholds(&self, ages: &Nodal) -> Nodal {
        let (strength, h) = match self {
            Self::Affine(strength, h) => (strength, h),
            Self::Ranked(followed) => return followed.thresholds(ages),
        };
        let (ages, mut out) = (*ages, [0.0; NODES]);
        match strength.kind {
            Kind::Logarithmic { growth, time } => {
                for i in 0..NODES {
                    out[i] = (h * (1.0 + growth * ln(1.0 + ages[i] / time))).max(0.0);
                }
            }
            Kind::Constant => out = [*h; NODES],
            Kind::Gaussian { fresh, mature, time } => {
                let excess = (fresh.std - mature.std) * (fresh.std + mature.std);
                let z = (h - fresh.mean) / fresh.std;
                for i in 0..NODES {
                    let left = exp(-ages[i] / time);
                    let std = (mature.std * mature.std + excess * left * left).sqrt();
                    out[i] = (mature.mean + (fresh.mean - mature.mean) * left + z * std).max(0.0);
                }
            }
            _ => out = ages.map(|age| self.threshold(age)),
        }
        out
    }
}

impl ThresholdsAtAge<'_> {
    /// h of a contact with fresh threshold h_0.
    #[inline]
    pub fn threshold(&self, fresh: f64) -> f64 {
        match &self.0 {
            At::Affine(aged) => (aged.shift + aged.factor * fresh).max(0.0),
            At::Ranked(aged) => aged.threshold(fresh).max(0.0),
        }
    }

    /// h of a contact with a label.
    #[inline]
    pub(crate) fn threshold_of(&self, label: Label<'_>) -> f64 {
        match (&self.0, label.rank) {
            (At::Ranked(aged), Some(rank)) => aged.threshold_of(rank).max(0.0),
            _ => self.threshold(label.fresh),
        }
    }

    /// h of contacts with sixteen labels.
    #[inline(always)]
    pub(crate) fn thresholds_of(&self, labels: &NodalLabels) -> Nodal {
        let thresholds = match (&self.0, &labels.ranks) {
            (At::Affine(aged), _) => {
                let (fresh, mut out) = (labels.fresh, [0.0; NODES]);
                for i in 0..NODES {
                    out[i] = aged.shift + aged.factor * fresh[i];
                }
                out
            }
            (At::Ranked(aged), NodalRanks::Rows(rows)) => aged.interpolated(rows),
            (At::Ranked(aged), NodalRanks::Each(ranks)) => {
                ranks.each_ref().map(|rank| aged.threshold_of(rank))
            }
            (At::Ranked(aged), NodalRanks::None) => labels.fresh.map(|h| aged.threshold(h)),
        };
        thresholds.map(|h| h.max(0.0))
    }

    /// h_0 of a contact whose threshold is h; below 0 if every contact has a higher threshold.
    #[inline]
    pub fn fresh(&self, threshold: f64) -> f64 {
        match &self.0 {
            At::Affine(aged) => (threshold - aged.shift) / aged.factor,
            At::Ranked(aged) => aged.fresh(threshold),
        }
    }

    /// The contact whose threshold is h.
    pub(crate) fn contact_at(&self, threshold: f64) -> ContactAtThreshold {
        match &self.0 {
            At::Affine(aged) => {
                let fresh = (threshold - aged.shift) / aged.factor;
                ContactAtThreshold {
                    fresh,
                    drift: aged.shift_rate + aged.factor_rate * fresh,
                    spread: aged.factor,
                }
            }
            At::Ranked(aged) => aged.contact_at(threshold),
        }
    }

    /// ∂h/∂h_0 at constant age, for a contact with fresh threshold h_0.
    #[inline]
    pub fn spread(&self, fresh: f64) -> f64 {
        match &self.0 {
            At::Affine(aged) => aged.factor,
            At::Ranked(aged) => aged.spread(fresh),
        }
    }

    /// ∂h/∂t of a contact with fresh threshold h_0: its rate of strengthening.
    #[inline]
    pub fn drift(&self, fresh: f64) -> f64 {
        match &self.0 {
            At::Affine(aged) => aged.shift_rate + aged.factor_rate * fresh,
            At::Ranked(aged) => aged.drift(fresh),
        }
    }
}

impl Normal {
    /// The parameters of a Gaussian.
    fn of(law: &dyn Law) -> Option<Self> {
        let parameter = |name: &str| law.parameters().iter().find(|p| p.name == name).map(|p| p.value);
        let [mean, std] = ["mean", "std"].map(parameter);
        (law.name() == "gaussian").then_some(Self { mean: mean?, std: std? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contacts::Rules;
    use crate::law::{Gaussian, Lognormal, Point, Rectangular};
    use crate::numerics::legendre::RULE;

    fn contacts(ageing: Option<Ageing>) -> Contacts {
        let law = Arc::new(Gaussian::new(0.5, 0.1).unwrap());
        let rules = Rules { ageing, ..Rules::default() };
        Contacts { rules, ..Contacts::new(law, Arc::new(Point::new(0.0).unwrap())) }
    }

    fn frozen_rank() -> Ageing {
        Ageing::FrozenRank { mature: Arc::new(Gaussian::new(1.0, 0.05).unwrap()), time: 2.0 }
    }

    #[test]
    fn thresholds_and_fresh_ones_are_inverse_and_their_rates_are_derivatives() {
        for ageing in [None, Some(Ageing::Logarithmic { growth: 0.02, time: 3.0 }), Some(frozen_rank())] {
            let strength = ThresholdEvolution::of(&contacts(ageing)).unwrap();
            for (fresh, age) in [(0.3, 0.0), (0.5, 1e-3), (0.7, 1.7), (0.45, 40.0)] {
                let aged = strength.at(age);
                let threshold = strength.threshold(fresh, age);
                // A few roundings.
                assert!((strength.fresh(threshold, age) - fresh).abs() < 1e-15);
                // Central differences of step h: error of order h² and ε/h.
                let step = 1e-5;
                let drift = strength.threshold(fresh, age + step) - threshold;
                assert!((drift / step - aged.drift(fresh)).abs() < 1e-5);
                let spread = aged.threshold(fresh + step) - threshold;
                assert!((spread / step - aged.spread(fresh)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_fresh_law_becomes_the_mature_one_rank_by_rank() {
        let strength = ThresholdEvolution::of(&contacts(Some(frozen_rank()))).unwrap();
        for z in [-3.0, 0.0, 1.5] {
            let fresh = 0.5 + 0.1 * z;
            assert!((strength.threshold(fresh, 0.0) - fresh).abs() < 1e-15);
            assert!((strength.threshold(fresh, 1e3) - (1.0 + 0.05 * z)).abs() < 1e-15);
        }
    }

    #[test]
    fn moments_of_those_above_are_sums_over_their_thresholds() {
        let mature = Arc::new(Lognormal::new(1.0, 0.1).unwrap());
        let general = Ageing::FrozenRank { mature, time: 2.0 };
        for ageing in [frozen_rank(), Ageing::Logarithmic { growth: 0.02, time: 3.0 }, general] {
            let contacts = contacts(Some(ageing));
            let (law, strength) = (contacts.thresholds.as_ref(), ThresholdEvolution::of(&contacts).unwrap());
            for age in [0.0, 1e-3, 0.7, 40.0] {
                let aged = strength.at(age);
                for fresh in [-1.0, 0.2, 0.45, 0.8, 1.2] {
                    let found = strength.moments_above(law, fresh, age);
                    // A tenth of a standard deviation each, up to 10 of them.
                    let edge = |k: u32| fresh.max(0.0) + 0.01 * f64::from(k);
                    for (n, found) in (0..).zip(found) {
                        let density = |h: f64| aged.threshold(h).powi(n) * law.density(h);
                        let sum: f64 = (0..150).map(|k| RULE.integrate(edge(k), edge(k + 1), density)).sum();
                        // What interpolation between ranks and ages leaves out, of those above.
                        let allowed = 1e-9 * law.survival(fresh);
                        assert!((found - sum).abs() < allowed, "{age} {fresh} {n} {:e}", found - sum);
                    }
                }
            }
        }
    }

    #[test]
    fn the_contact_met_has_the_threshold_and_its_rates() {
        let mature = Arc::new(Lognormal::new(1.0, 0.1).unwrap());
        let general = Ageing::FrozenRank { mature, time: 2.0 };
        for ageing in [frozen_rank(), Ageing::Logarithmic { growth: 0.02, time: 3.0 }, general] {
            let strength = ThresholdEvolution::of(&contacts(Some(ageing))).unwrap();
            for (fresh, age) in [(0.3, 0.01), (0.5, 0.7), (0.75, 5.0)] {
                let aged = strength.at(age);
                let contact_at = aged.contact_at(aged.threshold(fresh));
                // Rounding of the rank of the fresh threshold.
                assert!((contact_at.fresh - fresh).abs() < 1e-13);
                assert!((contact_at.drift - aged.drift(fresh)).abs() < 1e-11);
                assert!((contact_at.spread - aged.spread(fresh)).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn what_is_no_function_of_age_is_refused() {
        let mature = Arc::new(Gaussian::new(1.0, 0.05).unwrap());
        let diffusing = Ageing::Smoluchowski { mature, diffusion: 1.0 };
        assert!(ThresholdEvolution::of(&contacts(Some(diffusing))).is_err());
        let mature = Arc::new(Rectangular::new(0.1, 2.0).unwrap());
        let mut shared = contacts(Some(Ageing::FrozenRank { mature, time: 1.0 }));
        shared.thresholds = Arc::new(Point::new(0.5).unwrap());
        let error = ThresholdEvolution::of(&shared).unwrap_err();
        assert!(error.to_string().starts_with("thresholds: expected a distribution with a density"));
    }
}
