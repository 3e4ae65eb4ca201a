//! Thresholds that diffuse from the law of newborn contacts towards that of mature ones.

use super::{Ageing, Contacts};
use crate::law::{Break, Law, SharedLaw};
use crate::numerics::diffusion::{Diffusion, Potential, continued, shared};
use crate::numerics::legendre::RULE;

/// Thresholds above the ends of the cells are as few as that.
const NEGLIGIBLE: f64 = 1e-15;

/// ∂_t p = D∂_h[U' + ∂_h]p, U = −ln P_cf, from P_ci, reflecting at the ends of the support of P_cf.
#[derive(Debug, Clone)]
pub struct Maturing {
    newborn: SharedLaw,
    mature: SharedLaw,
    /// D, stretch² per time.
    pub diffusion: f64,
    /// Where thresholds are.
    pub support: (f64, f64),
}

impl Maturing {
    /// How the thresholds of these contacts mature; `None` where ageing knows no mature law. For [`Ageing::FrozenRank`] it is
    /// the law that does, with D = σ_f²/`time`.
    pub fn of(contacts: &Contacts) -> Option<Self> {
        let (mature, diffusion) = match contacts.rules.ageing.as_ref()? {
            Ageing::Smoluchowski { mature, diffusion } | Ageing::MeanField { mature, diffusion } => {
                (mature, *diffusion)
            }
            Ageing::FrozenRank { mature, time } => (mature, mature.std().powi(2) / time),
            Ageing::Logarithmic { .. } => return None,
        };
        Some(Self::new(contacts.thresholds.clone(), mature.clone(), diffusion))
    }

    /// Thresholds that mature with the diffusion D. The laws are taken to have passed [`super::Contacts::check`].
    pub fn new(newborn: SharedLaw, mature: SharedLaw, diffusion: f64) -> Self {
        let (low, end) = (mature.quantile(0.0), mature.upper_quantile(0.0));
        let far = |law: &SharedLaw| law.upper_quantile(NEGLIGIBLE);
        let high = if end.is_finite() { end } else { far(&mature).max(far(&newborn)) };
        Self { newborn, mature, diffusion, support: (low, high) }
    }

    /// P_ci.
    pub fn newborn_law(&self) -> &SharedLaw {
        &self.newborn
    }

    /// The operator on so many cells of one width. Masses of P_cf do not move.
    pub fn operator(&self, cells: usize) -> Diffusion {
        let (low, high) = self.support;
        let width = (high - low) / cells as f64;
        let edges: Vec<f64> = (0..=cells).map(|i| low + i as f64 * width).collect();
        let mass = |pair: &[f64]| -> f64 {
            points(self.mature.as_ref(), &[], (pair[0], pair[1])).map(|point| point.1).sum()
        };
        let masses = edges.windows(2).map(mass).collect();
        Diffusion::new(low, width, &continued(masses), self.diffusion)
    }

    /// U.
    pub fn potential(&self) -> Potential {
        const POINTS: usize = 8192;
        Potential::of(|h| self.mature.density(h), self.support, POINTS)
    }

    /// The density of newborn thresholds; if they are `ageing`, that of mature ones where it is higher.
    pub fn density(&self, threshold: f64, ageing: bool) -> f64 {
        let mature = if ageing { self.mature.density(threshold) } else { 0.0 };
        self.newborn.density(threshold).max(mature)
    }

    /// A length on which both laws vary little.
    pub fn resolution(&self) -> f64 {
        let zones = self.newborn.zones().into_iter().chain(self.mature.zones());
        zones.map(|zone| zone.resolution.min(zone.high - zone.low)).fold(f64::INFINITY, f64::min)
    }

    /// Where (1 − aL)⁻¹ P_ci is not smooth where P_ci is not: two derivatives higher, by −1/(aD); `spread` is aD.
    pub fn breaks(&self, spread: f64) -> Vec<Break> {
        let atoms = self.newborn.atoms().into_iter().map(Break::from);
        let smoother = |b: Break| Break { exponent: b.exponent + 2.0, amplitude: -b.amplitude / spread, ..b };
        self.newborn.breaks().into_iter().chain(atoms).map(smoother).collect()
    }

    /// Masses of the newborn thresholds above a stretch, in cells with these middles between a floor and the upper end;
    /// S(stretch) in all.
    pub fn newborn(&self, middles: &[f64], stretch: f64) -> Vec<f64> {
        let (low, high) = self.support;
        let law = self.newborn.as_ref();
        let atoms = law.atoms().into_iter().filter(|atom| atom.position > stretch);
        let spread = points(law, middles, (low.max(stretch), high));
        shared(middles, atoms.map(|atom| (atom.position, atom.weight)).chain(spread))
    }
}

/// Points with their masses that stand for the density of a law between two places, even where multiplied by what is
/// not smooth at `cuts`.
fn points<'a>(
    law: &'a dyn Law,
    cuts: &[f64],
    (low, high): (f64, f64),
) -> impl Iterator<Item = (f64, f64)> + 'a {
    let zones = law.zones();
    let mut edges: Vec<f64> = law.breaks().iter().map(|b| b.position).collect();
    edges.extend(zones.iter().flat_map(|zone| [zone.low, zone.high]).chain(cuts.iter().copied()));
    edges.retain(|&edge| edge > low && edge < high);
    edges.extend([low, high]);
    edges.sort_by(f64::total_cmp);
    let finest = move |low: f64, high: f64| {
        let over = zones.iter().filter(|zone| zone.low < high && zone.high > low);
        over.map(|zone| zone.resolution).fold(f64::INFINITY, f64::min)
    };
    let pairs: Vec<_> = edges.windows(2).map(|pair| (pair[0], pair[1])).collect();
    pairs.into_iter().flat_map(move |(low, high)| {
        let parts = ((high - low) / finest(low, high)).ceil().max(1.0);
        let half = 0.5 * (high - low) / parts;
        (0..parts as usize).flat_map(move |part| {
            let middle = low + (2 * part + 1) as f64 * half;
            let point = move |(t, w): (&f64, &f64)| {
                let place = middle + half * t;
                (place, half * w * law.density(place))
            };
            RULE.nodes.iter().zip(&RULE.weights).map(point)
        })
    })
}
