//! The ages of contacts that share one distribution of thresholds (`ageing.mean_field`), and that distribution.
//!
//! P_c obeys ∂_t P_c = L P_c + (b/A)(P_ci − P_c), with b the rate at which contacts form, A the attached fraction and L the
//! operator of [`ThresholdFokkerPlanck`](crate::contacts::ThresholdFokkerPlanck): every contact breaks with the same
//! probability, whatever its threshold. P_c is thus the mean of p(h; a), the solution without breaks from P_ci, over the ages a
//! of contacts. Their distribution follows from the breaks and the formation alone: contacts formed in [t, t + dt] are b dt e^{−∫Γ/A
//! dt}, Γ the breaking rate. It is kept as points of Gauss rules for each step, of which later ones become fewer.

use serde::{Deserialize, Serialize};

use super::broken::BrokenFraction;
use super::path::{GAUSS, Path};
use crate::contacts::{AgeWeights, MaturingTable, ThresholdDensity};
use crate::numerics::legendre::{NODES, RULE};

/// Contacts of one age.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct AgeGroup {
    age: f64,
    /// Their fraction of all contacts.
    fraction: f64,
}

/// The ages of the attached contacts, the oldest first.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct ContactAges(Vec<AgeGroup>);

/// What breaks and forms in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepChanges {
    pub(super) duration: f64,
    pub(super) broken: BrokenFraction,
    /// Contacts that form, at the two Gauss nodes.
    pub(super) formed: [f64; 2],
    /// The attached fraction at the start.
    pub(super) attached: f64,
}

/// The longest time, in units of that in which thresholds begin to change, in which two points of age serve: the rule misses
/// 1/4320 of the fourth power of that and a fifth of it.
const SHORT: f64 = 0.5;

/// What the shared distribution of thresholds needs of the contacts before a step.
pub(super) struct SharedStep<'a> {
    pub(super) table: &'a MaturingTable,
    pub(super) ages: &'a ContactAges,
    /// The last step, if this one continues it.
    pub(super) last: Option<(f64, BrokenFraction)>,
    pub(super) tolerance: f64,
}

/// Fraction of contacts whose age no result shows.
const NEGLIGIBLE: f64 = 1e-17;

/// The difference of ages, as a fraction of them, up to which groups become fewer. Four points that become two miss 24/4320 of
/// its fourth power, of each.
pub(super) fn closeness(tolerance: f64) -> f64 {
    (0.5 * tolerance.powf(0.25)).clamp(5e-3, 0.1)
}

impl StepChanges {
    /// Contacts that form per step at the fraction s of it: a linear function with these masses at the nodes.
    fn formation(&self, s: f64) -> f64 {
        self.formed[0] + self.formed[1] + self.tilt() * (s - 0.5)
    }

    fn tilt(&self) -> f64 {
        2.0 * (self.formed[1] - self.formed[0]) / (GAUSS[1] - GAUSS[0])
    }

    /// The attached fraction at s.
    fn attached(&self, s: f64) -> f64 {
        let formed = (self.formed[0] + self.formed[1]) * s - 0.5 * self.tilt() * s * (1.0 - s);
        (self.attached - self.broken.at(s) + formed).max(NEGLIGIBLE)
    }

    /// The fraction of contacts that holds between two fractions of the step.
    fn kept(&self, from: f64, to: f64) -> f64 {
        let lost = RULE.integrate(from, to, |s| self.broken.rate(s) / self.attached(s));
        (-lost.max(0.0)).exp()
    }

    /// The contacts that have formed up to s and still hold, the oldest first: at two Gauss nodes where thresholds hardly change
    /// meanwhile, as in the time `soon`, else at sixteen of panels that are as wide as the ages before them.
    fn young(&self, s: f64, soon: f64) -> Vec<AgeGroup> {
        let oldest = s * self.duration;
        let group = |age: f64, width: f64| {
            let at = s - age / self.duration;
            let fraction = width / self.duration * self.formation(at).max(0.0) * self.kept(at, s);
            AgeGroup { age, fraction }
        };
        if oldest <= SHORT * soon {
            return GAUSS.map(|node| group((1.0 - node) * oldest, 0.5 * oldest)).into();
        }
        let (mut groups, mut low, mut high) = (Vec::new(), 0.0, soon);
        while low < oldest {
            let half = 0.5 * (high.min(oldest) - low);
            let nodes = RULE.nodes.iter().zip(&RULE.weights);
            groups.extend(nodes.map(|(node, weight)| group(low + (1.0 + node) * half, weight * half)));
            (low, high) = (high, 2.0 * high);
        }
        groups.reverse();
        groups
    }
}

impl SharedStep<'_> {
    /// The breaks at the rate of the last step and its change.
    pub(super) fn guess(&self, path: &Path) -> BrokenFraction {
        let Some((before, last)) = self.last.filter(|_| path.by != 0.0) else {
            return BrokenFraction::default();
        };
        let ratio = path.duration / before;
        let after = |s: f64| last.at(1.0 + s * ratio) - last.end;
        BrokenFraction { middle: after(0.5), end: after(1.0) }.rising()
    }
}

impl ContactAges {
    /// Contacts of age 0.
    pub(super) fn fresh(fraction: f64) -> Self {
        Self(vec![AgeGroup { age: 0.0, fraction }])
    }

    /// Ages of steady sliding: exponentially distributed, with this mean.
    pub(super) fn steady(mean: f64, attached: f64) -> Self {
        /// First panel and largest age, in mean ages: e^{−40} of the contacts are older.
        const FIRST: f64 = 1.0 / 1024.0;
        const OLDEST: f64 = 40.0;
        /// Widest panel: sixteen points integrate two e-folds to rounding.
        const WIDEST: f64 = 1.0;
        let mut groups = Vec::new();
        let (mut low, mut high) = (0.0, FIRST);
        while low < OLDEST {
            for k in 0..NODES {
                let age = low + 0.5 * (1.0 + RULE.nodes[k]) * (high - low);
                let fraction = attached * 0.5 * (high - low) * RULE.weights[k] * (-age).exp();
                groups.push(AgeGroup { age: mean * age, fraction });
            }
            (low, high) = (high, high + high.min(WIDEST));
        }
        groups.reverse();
        Self(groups)
    }

    /// The attached fraction.
    pub(super) fn attached(&self) -> f64 {
        self.0.iter().map(|group| group.fraction).sum()
    }

    /// Adds contacts that form now.
    pub(super) fn add(&mut self, fraction: f64) {
        self.0.push(AgeGroup { age: 0.0, fraction });
    }

    /// P_c.
    pub(super) fn thresholds(&self, table: &MaturingTable) -> ThresholdDensity {
        let mut weights = table.no_ages();
        self.add_to(table, (0.0, 1.0), &mut weights);
        table.mean(&weights)
    }

    /// P_c at the fraction s of a step.
    pub(super) fn thresholds_at(
        &self,
        table: &MaturingTable,
        changes: &StepChanges,
        s: f64,
    ) -> ThresholdDensity {
        let mut weights = table.no_ages();
        self.add_to(table, (s * changes.duration, changes.kept(0.0, s)), &mut weights);
        for group in changes.young(s, table.soon()) {
            table.add(group.age, group.fraction, &mut weights);
        }
        table.mean(&weights)
    }

    /// Adds the part of these contacts that is left after a time to a mean.
    fn add_to(&self, table: &MaturingTable, (later, kept): (f64, f64), weights: &mut AgeWeights) {
        for group in &self.0 {
            table.add(group.age + later, group.fraction * kept, weights);
        }
    }

    /// Advances by a step. Groups whose ages differ by less than the fraction `close` of them, or of the time `soon`, become fewer.
    pub(super) fn advance(&mut self, changes: &StepChanges, (close, soon): (f64, f64)) {
        let kept = changes.kept(0.0, 1.0);
        let older = |group: &AgeGroup| AgeGroup {
            age: group.age + changes.duration,
            fraction: group.fraction * kept,
        };
        let all = self.0.iter().map(older).chain(changes.young(1.0, soon));
        let mut groups: Vec<AgeGroup> = Vec::with_capacity(self.0.len() + 2);
        for group in all.filter(|group| group.fraction > NEGLIGIBLE) {
            groups.push(group);
            if let [.., a, b, c, d] = groups[..]
                && a.age - d.age <= close * (d.age + soon)
            {
                groups.truncate(groups.len() - 4);
                groups.extend(two_of(&[a, b, c, d]));
            }
        }
        self.0 = groups;
    }
}

/// Two groups with the same moments up to the third of their ages: a Gauss rule.
fn two_of(groups: &[AgeGroup; 4]) -> [AgeGroup; 2] {
    let whole: f64 = groups.iter().map(|group| group.fraction).sum();
    let mean = groups.iter().map(|group| group.fraction * group.age).sum::<f64>() / whole;
    let moment =
        |n: i32| groups.iter().map(|group| group.fraction * (group.age - mean).powi(n)).sum::<f64>() / whole;
    let (square, cube) = (moment(2), moment(3));
    if square <= 0.0 {
        return [0.5, 0.5].map(|part| AgeGroup { age: mean, fraction: part * whole });
    }
    // The nodes are the roots of z² − (m_3/m_2) z − m_2.
    let half = 0.5 * cube / square;
    let root = half.hypot(square.sqrt());
    let (high, low) = (half + root, half - root);
    [(high, -low), (low, high)].map(|(from_mean, weight)| AgeGroup {
        age: mean + from_mean,
        fraction: whole * weight / (high - low),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_groups_have_the_moments_of_four() {
        let group = |age: f64, fraction: f64| AgeGroup { age, fraction };
        let four = [group(1.0, 0.1), group(0.9, 0.3), group(0.85, 0.2), group(0.8, 0.05)];
        let two = two_of(&four);
        for n in 0..4 {
            let moment =
                |groups: &[AgeGroup]| -> f64 { groups.iter().map(|g| g.fraction * g.age.powi(n)).sum() };
            // Rounding.
            assert!((moment(&four) - moment(&two)).abs() < 1e-15, "{n}");
        }
    }

    #[test]
    fn steady_formation_keeps_exponential_ages() {
        let (mean, duration) = (2.0, 0.05);
        let mut ages = ContactAges::steady(mean, 1.0);
        assert!((ages.attached() - 1.0).abs() < 1e-14, "{:e}", ages.attached() - 1.0);
        let end = duration / mean;
        for _ in 0..2000 {
            let changes = StepChanges {
                duration,
                broken: BrokenFraction { middle: 0.5 * end, end },
                formed: [0.5 * end; 2],
                attached: ages.attached(),
            };
            ages.advance(&changes, (0.02, 0.01));
        }
        for n in 0..4 {
            let moment: f64 = ages.0.iter().map(|group| group.fraction * (group.age / mean).powi(n)).sum();
            let exact: f64 = (1..=n).map(f64::from).product();
            // The two-point rule misses 1/4320 of the fourth power of the step in mean ages, 4e-7.
            assert!((moment / exact - 1.0).abs() < 1e-9, "{n}: {moment}");
        }
        assert!(ages.0.len() < 900, "{}", ages.0.len());
        assert!(ages.0.windows(2).all(|pair| pair[0].age >= pair[1].age));
    }
}
