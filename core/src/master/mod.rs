//! The master equation: the distribution of stretches, and the friction that follows from it.
//!
//! ∂Q/∂x + ∂Q/∂X + P(x) Q = R(x) ∫P(ξ) Q(ξ; X) dξ, with the hazard P = P_c/S
//! (O. M. Braun and M. Peyrard, Phys. Rev. Lett. 100, 125501 (2008), Eq. 5), solved in renewal form: see [`Pull`].

mod distribution;
mod limits;
mod loading;
mod master_population;
mod pull;
mod relaxation;
mod renewal;
mod solved_branches;
mod steady;
mod stepping;
mod tolerance;
mod transport;
mod unloading;

pub use limits::{Limits, creep};
pub use master_population::MasterPopulation;
pub use pull::Pull;
pub use relaxation::Relaxation;
pub use steady::SteadyState;
pub use stepping::{Stepping, Variant};
pub use tolerance::Tolerance;
pub use transport::{Slider, StepResponse, Trace, Transport};

use std::sync::Arc;

use crate::contacts::{Ageing, Contacts, Initial, Start, Stiffness};
use crate::law::{Atom, SharedLaw};
use crate::life::{Life, athermal, cells_of, moving};
use crate::monitor::{Monitor, Part, Watch, fits};
use crate::rate_dependent::StretchInterval;
use crate::{Error, Result};
use renewal::RenewalSolution;

/// The master equation of an interface and its start.
#[derive(Debug, Clone)]
pub struct MasterEquation {
    contacts: Contacts,
    start: Start,
    /// The life of the contacts that are there at X = 0 …
    first: Arc<Life>,
    /// … and of those that re-form.
    reborn: Arc<Life>,
}

/// An extremum: its value and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremum {
    /// Position X.
    pub position: f64,
    /// Value there; at a jump, the left limit.
    pub value: f64,
}

/// A distribution of stretches: a density on given stretches, and point masses.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretches {
    /// Density at each stretch asked for, per length.
    pub density: Vec<f64>,
    /// Point masses, by rising stretch.
    pub atoms: Vec<Atom>,
}

impl Stretches {
    /// Those of a density that may take long at each stretch.
    fn evaluated(
        stretches: &[f64],
        density: impl Fn(f64, &Watch<'_>) -> f64,
        atoms: Vec<Atom>,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let watch = Watch::new(monitor);
        let density = stretches.iter().map(|&x| watch.value(|| density(x, &watch))).collect();
        watch.check()?;
        Ok(Self { density, atoms })
    }

    /// Those of contacts that are known portion by portion: on stretches asked for, and where portions are at one.
    pub fn of(portions: &[StretchInterval], stretches: &[f64]) -> Self {
        let (points, cells): (Vec<_>, Vec<_>) = portions.iter().partition(|portion| portion.is_point());
        let at = |cell: &&StretchInterval, x: f64| {
            if x >= cell.low && x < cell.high { cell.share / (cell.high - cell.low) } else { 0.0 }
        };
        let density = stretches.iter().map(|&x| cells.iter().map(|cell| at(cell, x)).sum()).collect();
        let atom = |point: &StretchInterval| Atom { position: point.low, weight: point.share };
        let mut atoms: Vec<Atom> = points.into_iter().map(atom).collect();
        atoms.sort_by(|a, b| a.position.total_cmp(&b.position));
        Self { density, atoms }
    }
}

impl MasterEquation {
    /// The master equation of contacts that start from `initial`.
    ///
    /// # Errors
    /// Those of [`Contacts::check`]; time-dependent contacts; stopped by the monitor.
    pub fn new(contacts: Contacts, initial: &Initial, monitor: &mut dyn Monitor) -> Result<Self> {
        contacts.check(initial)?;
        if let Some(rule) = contacts.rules.first() {
            let expected = format!("a velocity above 0, since contacts.{rule} makes contacts time-dependent");
            return Err(Error::invalid("velocity", expected, "none"));
        }
        affordable(&contacts, "contacts.reforming", &contacts.reforming)?;
        affordable(&contacts, "initial", &initial.law)?;
        let reborn = athermal(&contacts, &contacts.reforming, true, monitor)?;
        let first = athermal(&contacts, &initial.law, initial.start == Start::Conditional, monitor)?;
        Ok(Self { contacts, start: initial.start, first: Arc::new(first), reborn: Arc::new(reborn) })
    }

    /// The master equation of contacts that start from `initial` at t = 0, all of age 0, while the slider moves at the
    /// constant velocity v (a length per time); for contacts that know no time the same as [`MasterEquation::new`].
    ///
    /// Where ageing makes contacts stiffer (k = κ x_s), the energy balance of its population does not close: what ageing brings while
    /// contacts are stretched is told by [`Transport::books`] alone.
    ///
    /// # Errors
    /// A velocity that is not a finite number above 0; those of [`Contacts::check`]; ageing for which no life is known;
    /// stopped by the monitor.
    pub fn at(
        contacts: Contacts,
        initial: &Initial,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        if !(velocity.is_finite() && velocity > 0.0) {
            return Err(Error::invalid("velocity", "a finite number above 0", velocity));
        }
        if !contacts.rules.are_time_dependent() {
            return Self::new(contacts, initial, monitor);
        }
        contacts.check(initial)?;
        let conditional = initial.start == Start::Conditional;
        let alike = conditional && contacts.rules.delay == 0.0 && same(&initial.law, &contacts.reforming);
        let part = &mut Part::new(monitor, 0.0, if alike { 1.0 } else { 0.5 });
        let reborn = Arc::new(moving(&contacts, &contacts.reforming, true, velocity, true, part)?);
        let first = if alike {
            reborn.clone()
        } else {
            let part = &mut Part::new(monitor, 0.5, 0.5);
            Arc::new(moving(&contacts, &initial.law, conditional, velocity, false, part)?)
        };
        Ok(Self { contacts, start: initial.start, first, reborn })
    }

    /// The contacts.
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    /// The same contacts where all have just re-formed.
    #[must_use]
    pub fn renewed(&self) -> Self {
        Self { start: Start::Conditional, first: self.reborn.clone(), ..self.clone() }
    }

    /// The life of contacts that re-form.
    pub fn life(&self) -> &Life {
        &self.reborn
    }

    /// The life of the contacts that are there at X = 0.
    pub fn first_life(&self) -> &Life {
        &self.first
    }

    /// Refuses the closure of steady sliding where sliding is not steady.
    fn has_transients(&self) -> Result<()> {
        if !matches!(self.contacts.rules.ageing, Some(Ageing::MeanField { .. })) {
            return Ok(());
        }
        let expected =
            "a rule for one contact where sliding is not steady: mean_field is the closure of steady sliding";
        Err(Error::invalid("contacts.ageing.mean_field", expected, "a pull from a start"))
    }

    /// Total force per unit of the carried force of a life: N_c⟨k⟩, or N_c κ.
    fn stiffness(&self) -> f64 {
        let (Stiffness::Equal(per_contact) | Stiffness::PerThreshold(per_contact)) = self.contacts.stiffness;
        self.contacts.count * per_contact
    }

    /// Steady sliding.
    pub fn steady_state(&self) -> SteadyState {
        SteadyState::new(self.reborn.clone(), self.stiffness())
    }

    /// The relaxation spectrum; of `ageing.mean_field`, which closes steady sliding alone, it is not known.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub fn relaxation(&self, monitor: &mut dyn Monitor) -> Result<Relaxation> {
        Relaxation::new(&self.contacts, &self.first, &self.reborn, self.stiffness(), monitor)
    }

    /// Pulls the slider's bottom from X = 0 to `distance` (a length), F/(N_c⟨k⟩) to about `tolerance` × the mean
    /// threshold. The solution reaches at least three mean lives, so that K_c is found however short the pull.
    ///
    /// # Errors
    /// A distance that is not above 0 or a tolerance outside [1e-12, 1e-2]; `ageing.mean_field`, which says nothing of sliding
    /// that is not steady; stopped by the monitor; too many point masses; accuracy not reached.
    pub fn pull(
        &self,
        distance: f64,
        tolerance: impl Into<Tolerance>,
        monitor: &mut dyn Monitor,
    ) -> Result<Pull> {
        if !(distance > 0.0 && distance.is_finite()) {
            return Err(Error::invalid("distance", "a finite length above 0", distance));
        }
        let tolerance = tolerance.into();
        tolerance.check()?;
        self.has_transients()?;
        let end = distance.max(3.0 * self.reborn.mean());
        let leg = RenewalSolution::solve(&self.first, &self.reborn, end, tolerance, monitor)?;
        Ok(Pull::new(leg, self.stiffness(), distance, tolerance.value()))
    }
}

/// Whether two laws are known to be one.
fn same(a: &SharedLaw, b: &SharedLaw) -> bool {
    let parameters = a.parameters();
    Arc::ptr_eq(a, b) || (!parameters.is_empty() && a.name() == b.name() && parameters == b.parameters())
}

/// Refuses contacts whose thresholds vary on lengths so much shorter than those over which they start that their life would
/// not fit in memory.
fn affordable(contacts: &Contacts, key: &str, starts: &SharedLaw) -> Result<()> {
    /// Curves of 16 terms that a life and the solution on it take.
    const BYTES_PER_CELL: f64 = 16.0 * 8.0 * 20.0;
    const ALLOWED: u64 = 256 << 20;
    let needed = BYTES_PER_CELL * cells_of(contacts, starts);
    let what = "stretches spread over far more than the length on which thresholds vary";
    fits(key, what, needed as u64, ALLOWED)
}
