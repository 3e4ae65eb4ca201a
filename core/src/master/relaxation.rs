//! Relaxation to steady sliding: the spectrum of exponents, and the force far from the start.

mod transform;

use num_complex::Complex64;

use self::transform::{Transform, is_undamped};
use super::renewal::unit_force;
use crate::Result;
use crate::contacts::{Ageing, Contacts};
use crate::life::Life;
use crate::monitor::{Monitor, Watch};

/// The relaxation spectrum: F(X) = F_k + N_c⟨k⟩ Σ_j c_j exp(s_j X), with s_j the roots ≠ 0 of φ̂(s) = 1 and c_j =
/// φ̂₀(s_j) m̂(s_j)/(−φ̂'(s_j)).
///
/// φ is the breaking density of re-formed contacts, m their carried force, φ₀ the breaking density of the
/// initial ones; hats denote Laplace transforms. For R = δ(x), φ = P_c. The relaxation length is X* = −1/Re
/// s₁, s₁ the slowest root. A distribution whose tail falls like exp(−λx), λ < −Re s₁, dominates instead: X*
/// = 1/λ. Thresholds on a lattice (identical, or 1 and 2) never relax: X* = ∞. The transform of the lognormal
/// distribution is not analytic for Re s < 0: its continued pole describes relaxation until, far out, the
/// tail takes over. For contacts at a velocity, roots are known as far left as their life determines φ̂, −Re
/// s = 8/(the end of the life).
///
/// ```
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// # use asperity::master::MasterEquation;
/// let relaxation = MasterEquation::new(contacts, &Initial::default())?.relaxation()?;
/// let closed = asperity::exact::Gaussian::new(1.0, 0.1).relaxation_length();
/// assert!((relaxation.length() / closed - 1.0).abs() < 1e-6);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Relaxation {
    roots: Vec<Complex64>,
    /// Terms of the slowest roots that the lives resolve.
    terms: Vec<Term>,
    length: f64,
    paper_estimate: f64,
    kinetic_friction: f64,
    valid_from: f64,
}

/// One pair of conjugate terms.
#[derive(Debug, Clone, Copy)]
struct Term {
    exponent: Complex64,
    amplitude: Complex64,
}

/// Truncation error of the expansion of F/(N_c⟨k⟩ × mean life) where it is called valid.
const LEFT_OUT: f64 = 1e-12;

/// x̄²/σ.
fn paper_estimate(contacts: &Contacts, reformed: &Life) -> f64 {
    /// σ²/x̄² of a law that is no wider than rounding.
    const IDENTICAL: f64 = 1e-12;
    let law = &contacts.thresholds;
    if !contacts.rules.are_time_dependent() {
        return law.mean() * law.mean() / law.std();
    }
    let square = reformed.mean() * reformed.mean();
    let variance = reformed.mean_square() - square;
    if variance > IDENTICAL * square { square / variance.sqrt() } else { f64::INFINITY }
}

impl Relaxation {
    pub(super) fn new(
        contacts: &Contacts,
        first: &Life,
        reformed: &Life,
        stiffness: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let kinetic_friction = stiffness * reformed.force().curve().integral() / reformed.mean();
        if matches!(contacts.rules.ageing, Some(Ageing::MeanField { .. })) {
            return Ok(Self::unknown(kinetic_friction));
        }
        let watch = Watch::new(monitor);
        let transform = Transform::new(contacts, reformed, &watch);
        let law = &contacts.thresholds;
        let rate = if contacts.rules.are_time_dependent() { f64::INFINITY } else { law.decay_rate() };
        let Some(roots) = transform.roots() else {
            watch.check()?;
            return Ok(Self {
                paper_estimate: paper_estimate(contacts, reformed),
                ..Self::unknown(kinetic_friction)
            });
        };
        let slowest = roots.first().map(|s| if is_undamped(s) { 0.0 } else { -s.re });
        // An exponential tail of the thresholds is a singularity of φ̂ on the real axis at −λ:
        // whichever lies farther to the right, it or the first root, decays more slowly.
        let slowest = match slowest {
            Some(root) if rate > 0.0 => root.min(rate),
            Some(root) => root,
            None if rate.is_finite() && rate <= -transform.leftmost => rate,
            None => f64::NAN,
        };
        let terms = terms(&transform, &roots, (first, reformed));
        // Roots that are not known lie left of where the transform is.
        let known = rate.min(law.known_rate());
        let next = roots.get(terms.len()).or(roots.last()).map_or(known.min(-transform.leftmost), |s| -s.re);
        let valid_from = valid_from(&terms, (&roots, next), known, first, reformed);
        watch.check()?;
        Ok(Self {
            roots,
            terms: terms.into_iter().map(|t| Term { amplitude: stiffness * t.amplitude, ..t }).collect(),
            length: 1.0 / slowest,
            paper_estimate: paper_estimate(contacts, reformed),
            kinetic_friction,
            valid_from,
        })
    }

    /// For the mean-field closure, which only describes steady sliding, and where the slowest root is not known for certain.
    fn unknown(kinetic_friction: f64) -> Self {
        let (roots, terms) = (Vec::new(), Vec::new());
        let [length, paper_estimate] = [f64::NAN; 2];
        Self { roots, terms, length, paper_estimate, kinetic_friction, valid_from: f64::INFINITY }
    }

    /// Relaxation length X*, infinite if the force never becomes steady. NaN where no root is known to
    /// be the slowest, if a truncated tail may dominate ([`crate::law::Law::known_rate`]), and for `ageing.mean_field`.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The paper's estimate x̄²/σ; infinite for identical thresholds. For narrow distributions X* is
    /// x̄³/(2π²σ²). For time-dependent contacts x̄ and σ are those of the advance between formations in
    /// steady sliding, which equals the threshold for contacts that re-form at 0 without delay.
    pub fn paper_estimate(&self) -> f64 {
        self.paper_estimate
    }

    /// Roots s_j with Im s_j > 0, slowest first, per length; some far from the imaginary axis may be missing.
    pub fn roots(&self) -> &[Complex64] {
        &self.roots
    }

    /// F(X) from the expansion, a force; valid for X ≥ [`Relaxation::valid_from`].
    pub fn force(&self, position: f64) -> f64 {
        let term = |t: &Term| 2.0 * (t.amplitude * (t.exponent * position).exp()).re;
        self.kinetic_friction + self.terms.iter().map(term).sum::<f64>()
    }

    /// The position from which the truncated terms are below 1e-12 of N_c⟨k⟩ × the mean life; infinite if the
    /// expansion does not hold (tails heavier than exponential).
    pub fn valid_from(&self) -> f64 {
        self.valid_from
    }
}

/// Terms of the roots that the lives resolve, per unit stiffness.
fn terms(transform: &Transform, roots: &[Complex64], (first, reformed): (&Life, &Life)) -> Vec<Term> {
    let end = first.breaking().curve().end().max(reformed.force().curve().end());
    let resolved = roots.iter().take_while(|s| -s.re * end < 25.0);
    let term = |&s: &Complex64| {
        let source = first.breaking().transform(s).0;
        let force = reformed.force().curve().transform(s).0;
        Term { exponent: s, amplitude: -source * force / transform.slope(s) }
    };
    resolved.map(term).collect()
}

/// The position at which the first omitted term, and an exponential tail of the thresholds or the unknown
/// part of it, have decayed. `next` is the decay rate of the first omitted term.
fn valid_from(
    terms: &[Term],
    (roots, next): (&[Complex64], f64),
    rate: f64,
    first: &Life,
    reformed: &Life,
) -> f64 {
    if rate == 0.0 || roots.iter().any(is_undamped) {
        return f64::INFINITY;
    }
    // Unknown roots have amplitudes and rates like the last known one; the margin accounts for their sum.
    let size = terms.iter().map(|t| t.amplitude.norm() / unit_force(reformed)).fold(1.0, f64::max);
    let fade = (1e5 * size / LEFT_OUT).ln().max(0.0) / next;
    let tail = -LEFT_OUT.ln() / rate;
    tail.max(fade).max(first.breaking().curve().end())
}
