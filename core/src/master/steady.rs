//! Steady sliding: the solution of the master equation that does not depend on X.

use std::f64::consts::PI;
use std::sync::Arc;

use super::{MasterEquation, Stretches};
use crate::contacts::Contacts;
use crate::law::{Law, Series, SharedLaw};
use crate::life::Life;
use crate::monitor::{Monitor, Watch};
use crate::{Error, Result};

/// Steady sliding: Q_s(x) = Γ_s S(x) ∫₀ˣ R/S, 1/Γ_s = ∫dr (R/S) ∫_r^∞ S, F_k = N_c⟨k⟩ ∫x Q_s dx.
///
/// For R = δ(x) this is the paper's Q_s = S/x̄ and F_k = N_c⟨k⟩⟨x_s²⟩/(2⟨x_s⟩) (Eqs. 11a, 11d).
///
/// ```
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// # use asperity::master::MasterEquation;
/// let steady = MasterEquation::new(contacts, &Initial::default())?.steady_state();
/// // A contact that re-forms relaxed lives for its threshold on average.
/// assert!((steady.mean_life() - 1.0).abs() < 1e-9);
/// assert!((steady.breaking_rate() - 1.0).abs() < 1e-9);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SteadyState {
    pub(super) equation: MasterEquation,
    pub(super) life: Arc<Life>,
    pub(super) stiffness: f64,
    pub(super) mean: f64,
}

impl SteadyState {
    pub(super) fn new(equation: MasterEquation) -> Self {
        let (life, stiffness) = (equation.reformed.clone(), equation.stiffness());
        let mean = life.mean();
        Self { equation, life, stiffness, mean }
    }

    /// Kinetic friction F_k, a force.
    pub fn kinetic_friction(&self) -> f64 {
        self.stiffness * self.life.force().curve().integral() / self.mean
    }

    /// Estimated error of F_k/(N_c⟨k⟩), a length. F_k is ∫m du/∫S du, with m the force of a contact and S its
    /// survival after the advance u, each with the error of the life (for m per mean life) over the advances
    /// at which contacts are found.
    pub fn error_estimate(&self) -> f64 {
        let friction = self.life.force().curve().integral() / (self.mean * self.life.stiffness());
        self.life.error() * (self.mean + friction) * self.life_found() / self.mean
    }

    /// Breaking rate Γ_s, the fraction of contacts per unit length.
    pub fn breaking_rate(&self) -> f64 {
        1.0 / self.mean
    }

    /// Mean advance C from one formation of a contact to the next, a length.
    pub fn mean_life(&self) -> f64 {
        self.mean
    }

    /// The length C³/(2π²σ²) over which contacts dephase, σ the standard deviation of the advance between
    /// formations and C its mean: the relaxation length for σ ≪ C.
    pub fn dephasing_length(&self) -> f64 {
        let variance = (self.life.mean_square() - self.mean * self.mean).max(0.0);
        self.mean.powi(3) / (2.0 * PI * PI * variance)
    }

    /// Mean advance between formations of the contacts found at a moment, ⟨u²⟩/C: long lives are found more
    /// often (length-biased sampling).
    pub fn life_found(&self) -> f64 {
        self.life.mean_square() / self.mean
    }

    /// Q_s as a distribution: the stretches of contacts that start in steady sliding, with thresholds above them
    /// ([`crate::contacts::Start::Conditional`]). It ends with the thresholds, or where one contact in
    /// 10⁹ still holds.
    ///
    /// # Errors
    /// Time-dependent contacts, whose state their stretches do not determine; those of [`Series::resolve`].
    pub fn stretch_law(&self) -> Result<SharedLaw> {
        /// Truncation error of a cell of the density, relative to the mass above and below it.
        const TOLERANCE: f64 = 1e-14;
        let contacts = self.equation.contacts();
        if let Some(rule) = contacts.rules.first() {
            let expected = "time-independent contacts (Transport::steady is steady sliding of others)";
            return Err(Error::invalid(rule, expected, "a rule of time"));
        }
        let density = |stretches: &[f64]| self.stretch_density(stretches).map(|found| found.density);
        let (law, _) = Series::resolve(density, &edges(contacts), TOLERANCE)?;
        Ok(Arc::new(law))
    }

    /// Standard deviation of the force carried by `size` contacts drawn at random and scaled to N_c.
    pub fn force_std(&self, size: f64) -> f64 {
        self.stiffness * (self.variance() / size).sqrt()
    }

    /// Variance of the force of a contact per unit stiffness.
    pub(super) fn variance(&self) -> f64 {
        let first = self.life.force().curve().integral() / self.mean;
        let second = self.life.square().curve().integral() / self.mean;
        (second - first * first).max(0.0)
    }

    /// The distribution of the stretches at which contacts break, per length, at given stretches: P_c for
    /// time-independent contacts that re-form below all thresholds. Point masses are those of contacts
    /// that re-form at one stretch.
    ///
    /// # Errors
    /// None: only a monitor can stop it.
    pub fn breaking_stretches(&self, stretches: &[f64]) -> Result<Stretches> {
        self.breaking_stretches_with(stretches, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::breaking_stretches`]; stopped by the monitor.
    pub fn breaking_stretches_with(&self, stretches: &[f64], monitor: &mut dyn Monitor) -> Result<Stretches> {
        let atoms = self.life.breaking_stretch_atoms(&Watch::new(monitor));
        Stretches::evaluated(
            stretches,
            |x, watch| self.life.breaking_stretch_density(x, watch),
            atoms,
            monitor,
        )
    }

    /// Q_s at the given stretches, per length; it has no point masses.
    ///
    /// # Errors
    /// None: only a monitor can stop it.
    pub fn stretch_density(&self, stretches: &[f64]) -> Result<Stretches> {
        self.stretch_density_with(stretches, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::stretch_density`]; stopped by the monitor.
    pub fn stretch_density_with(&self, stretches: &[f64], monitor: &mut dyn Monitor) -> Result<Stretches> {
        let rate = |_| 1.0 / self.mean;
        let at = |x: f64, watch: &Watch<'_>| {
            self.life.formed().standing_density(x, rate, std::iter::empty(), watch)
        };
        Stretches::evaluated(stretches, at, Vec::new(), monitor)
    }
}

/// Stretches between which Q_s is smooth, on the scale of the distributions of thresholds and of re-forming.
fn edges(contacts: &Contacts) -> Vec<f64> {
    /// Parts of a zone whose density is a piecewise polynomial.
    const PARTS: f64 = 8.0;
    // An end close to that of the thresholds would be a second breakpoint beside it.
    let end = contacts.thresholds.quantile(1.0);
    let top = if end.is_finite() { end } else { contacts.highest_start() };
    let of = |law: &dyn Law| {
        let mut places: Vec<f64> = law.breakpoints().into_iter().map(|b| b.position).collect();
        places.extend(law.atoms().into_iter().map(|atom| atom.position));
        places.extend(law.seams());
        for zone in law.zones() {
            let count = ((zone.high - zone.low) / zone.resolution).ceil().max(PARTS);
            let edge = |k: u32| zone.low + (zone.high - zone.low) * f64::from(k) / count;
            places.extend((0..=count as u32).map(edge));
        }
        places
    };
    let inner = of(contacts.thresholds.as_ref()).into_iter().chain(of(contacts.reforming.as_ref()));
    let mut edges: Vec<f64> = inner.filter(|&x| x > 0.0 && x < top).chain([0.0, top]).collect();
    edges.sort_by(f64::total_cmp);
    edges.dedup_by(|b, a| *b - *a <= 1e-12 * top);
    edges
}
