//! The master equation: the distribution of stretches, and the friction force that follows from it.
//!
//! ∂Q/∂x + ∂Q/∂X + P(x) Q = R(x) ∫P(ξ) Q(ξ; X) dξ, with the hazard rate P = P_c/S (O. M. Braun and M.
//! Peyrard, Phys. Rev. Lett. 100, 125501 (2008), Eq. 5), solved as a renewal equation: see [`Pull`].

mod against_drive;
mod covariance;
mod distribution;
mod dynamic_stiffness;
mod force_after_break;
mod friction_gradient;
mod gradient;
mod life_change;
mod life_differences;
mod limits;
mod loading;
mod master_population;
mod noise;
mod parameters;
mod pull;
mod relaxation;
mod renewal;
mod solved_branches;
mod spectrum;
mod steady;
mod stepping;
mod threshold_response;
mod tolerance;
mod transport;
mod unloading;

pub use against_drive::AgainstDrive;
pub use covariance::Covariance;
pub use dynamic_stiffness::{DynamicStiffness, Slider, SpringResponse};
pub use friction_gradient::FrictionGradient;
pub use gradient::Gradient;
pub use limits::{Limits, creep};
pub use master_population::MasterPopulation;
pub use pull::Pull;
pub use relaxation::Relaxation;
pub use steady::SteadyState;
pub use stepping::{Stepping, Variant};
pub use threshold_response::ThresholdResponse;
pub use tolerance::Tolerance;
pub use transport::{Trace, Transport, as_required};

use std::sync::Arc;

use crate::contacts::{Ageing, Contacts, Initial, Start};
use crate::error::positive;
use crate::law::{Atom, SharedLaw};
use crate::life::{Life, athermal, cells_of, moving};
use crate::monitor::{Monitor, Part, Watch, fits};
use crate::rate_dependent::StretchInterval;
use crate::{Error, Result};
use renewal::RenewalSolution;

/// The master equation of an interface and its start.
///
/// ```
/// use std::sync::Arc;
/// use asperity::contacts::{Contacts, Initial};
/// use asperity::law::{Gaussian, Point};
/// use asperity::master::MasterEquation;
///
/// let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// let equation = MasterEquation::new(contacts, &Initial::default())?;
/// // ⟨x_s²⟩/2⟨x_s⟩
/// assert!((equation.steady_state().kinetic_friction() - 0.505).abs() < 1e-9);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MasterEquation {
    contacts: Contacts,
    /// Where the contacts are at X = 0.
    initial: Initial,
    /// The velocity of time-dependent contacts.
    velocity: Option<f64>,
    /// The life of the contacts at X = 0.
    first: Arc<Life>,
    /// The life of contacts that re-form.
    reformed: Arc<Life>,
}

/// An extremum: its value and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremum {
    /// Position X.
    pub position: f64,
    /// Value there; at a jump, the left limit.
    pub value: f64,
}

/// A distribution of stretches: a density at given stretches, and point masses.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretches {
    /// Density at each stretch, per length.
    pub density: Vec<f64>,
    /// Point masses, by rising stretch.
    pub atoms: Vec<Atom>,
}

impl Stretches {
    /// From a density whose evaluation may take long.
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

    /// From contacts given as intervals of stretch: the density at the given stretches, and a point mass for
    /// each interval of zero width.
    pub fn of(portions: &[StretchInterval], stretches: &[f64]) -> Self {
        let (points, cells): (Vec<_>, Vec<_>) = portions.iter().partition(|portion| portion.is_point());
        let at = |cell: &&StretchInterval, x: f64| {
            if x >= cell.low && x < cell.high { cell.fraction / (cell.high - cell.low) } else { 0.0 }
        };
        let density = stretches.iter().map(|&x| cells.iter().map(|cell| at(cell, x)).sum()).collect();
        let atom = |point: &StretchInterval| Atom { position: point.low, weight: point.fraction };
        let mut atoms: Vec<Atom> = points.into_iter().map(atom).collect();
        Atom::sort(&mut atoms);
        Self { density, atoms }
    }
}

impl MasterEquation {
    /// The master equation of contacts that start from `initial`.
    ///
    /// # Errors
    /// Those of [`Contacts::check`]; time-dependent contacts.
    pub fn new(contacts: Contacts, initial: &Initial) -> Result<Self> {
        Self::new_with(contacts, initial, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::new`]; stopped by the monitor.
    pub fn new_with(contacts: Contacts, initial: &Initial, monitor: &mut dyn Monitor) -> Result<Self> {
        contacts.check(initial)?;
        check_time_independent(&contacts)?;
        affordable(&contacts, "reforming", &contacts.reforming)?;
        affordable(&contacts, "initial", &initial.law)?;
        let reformed = athermal(&contacts, &contacts.reforming, true, monitor)?;
        let first = athermal(&contacts, &initial.law, initial.start == Start::Conditional, monitor)?;
        Ok(Self {
            contacts,
            initial: initial.clone(),
            velocity: None,
            first: Arc::new(first),
            reformed: Arc::new(reformed),
        })
    }

    /// The master equation of contacts that start from `initial` at t = 0, all of age 0, while the slider
    /// moves at the constant velocity v (length per time). For time-independent contacts the same as
    /// [`MasterEquation::new`].
    ///
    /// If ageing makes contacts stiffer (k = κ x_s), the energy balance of its population does not close: the
    /// work done by ageing on stretched contacts is only computed by [`Transport::energies`].
    ///
    /// # Errors
    /// A velocity that is not a finite number above 0; those of [`Contacts::check`]; ageing without a life at
    /// a velocity.
    pub fn at(contacts: Contacts, initial: &Initial, velocity: f64) -> Result<Self> {
        Self::at_with(contacts, initial, velocity, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::at`]; stopped by the monitor.
    pub fn at_with(
        contacts: Contacts,
        initial: &Initial,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        positive("velocity", velocity)?;
        if !contacts.rules.are_time_dependent() {
            return Self::new_with(contacts, initial, monitor);
        }
        contacts.check(initial)?;
        let conditional = initial.start == Start::Conditional;
        let alike = conditional && contacts.rules.delay.is_none() && same(&initial.law, &contacts.reforming);
        let part = &mut Part::new(monitor, 0.0, if alike { 1.0 } else { 0.5 });
        let reformed = Arc::new(moving(&contacts, &contacts.reforming, true, velocity, true, part)?);
        let first = if alike {
            reformed.clone()
        } else {
            let part = &mut Part::new(monitor, 0.5, 0.5);
            Arc::new(moving(&contacts, &initial.law, conditional, velocity, false, part)?)
        };
        Ok(Self { contacts, initial: initial.clone(), velocity: Some(velocity), first, reformed })
    }

    /// The master equation of contacts that have all just re-formed at X = 0, at a velocity where they are time-dependent: what
    /// steady sliding needs, which does not depend on an initial state.
    ///
    /// # Errors
    /// As [`Self::at`] and [`Self::new`]; stopped by the monitor.
    pub(crate) fn reformed(
        contacts: Contacts,
        velocity: Option<f64>,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let initial = Initial { law: contacts.reforming.clone(), start: Start::Conditional };
        let (velocity, reformed) = match velocity {
            Some(velocity) if contacts.rules.are_time_dependent() => {
                positive("velocity", velocity)?;
                contacts.check(&initial)?;
                (Some(velocity), moving(&contacts, &contacts.reforming, true, velocity, true, monitor)?)
            }
            _ => {
                contacts.check(&initial)?;
                check_time_independent(&contacts)?;
                affordable(&contacts, "reforming", &contacts.reforming)?;
                (None, athermal(&contacts, &contacts.reforming, true, monitor)?)
            }
        };
        let reformed = Arc::new(reformed);
        Ok(Self { contacts, initial, velocity, first: reformed.clone(), reformed })
    }

    /// The contacts.
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    /// The same contacts, all of them just re-formed at X = 0.
    #[must_use]
    pub fn renewed(&self) -> Self {
        let initial = Initial { law: self.contacts.reforming.clone(), start: Start::Conditional };
        Self { initial, first: self.reformed.clone(), ..self.clone() }
    }

    /// The life of contacts that re-form.
    pub fn life(&self) -> &Life {
        &self.reformed
    }

    /// The life of the contacts that are there at X = 0.
    pub fn first_life(&self) -> &Life {
        &self.first
    }

    /// Refuses the mean-field closure, which only describes steady sliding.
    fn has_transients(&self) -> Result<()> {
        if !matches!(self.contacts.rules.ageing, Some(Ageing::MeanField { .. })) {
            return Ok(());
        }
        let expected =
            "a rule for one contact where sliding is not steady: mean_field is the closure of steady sliding";
        Err(Error::invalid("ageing.mean_field", expected, "a pull from a start"))
    }

    /// Total force per unit of the carried force of a life: N_c⟨k⟩, or N_c κ.
    fn stiffness(&self) -> f64 {
        self.contacts.count * self.contacts.stiffness.unit()
    }

    /// Steady sliding.
    pub fn steady_state(&self) -> SteadyState {
        SteadyState::new(self.clone())
    }

    /// The relaxation spectrum; unknown for `ageing.mean_field`, which only describes steady sliding.
    ///
    /// # Errors
    /// None: only a monitor can stop it.
    pub fn relaxation(&self) -> Result<Relaxation> {
        self.relaxation_with(&mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::relaxation`]; stopped by the monitor.
    pub fn relaxation_with(&self, monitor: &mut dyn Monitor) -> Result<Relaxation> {
        Relaxation::new(&self.contacts, &self.first, &self.reformed, self.stiffness(), monitor)
    }

    /// Pulls the bottom of the slider from X = 0 to `distance`, as accurately as [`Tolerance::default`]. The solution
    /// extends over at least three mean lives, so that K_c is found for any distance.
    ///
    /// # Errors
    /// A distance that is not above 0; `ageing.mean_field`, which only describes steady sliding; too many point
    /// masses.
    pub fn pull(&self, distance: f64) -> Result<Pull> {
        self.pull_with(distance, Tolerance::default(), &mut ())
    }

    /// The same with F/(N_c⟨k⟩) accurate to about `tolerance` × the mean threshold, watched by a monitor.
    ///
    /// # Errors
    /// As [`Self::pull`]; a tolerance outside [1e-12, 1e-2]; accuracy not reached; stopped by the monitor.
    pub fn pull_with(
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
        // Where contacts break together at the end of the pull, the force there is that after the breaks.
        let breaks_together =
            [&self.first, &self.reformed].iter().any(|life| life.breaking().atoms().next().is_some());
        let beyond = if breaks_together { AFTER_BREAKS * distance } else { distance };
        // F falls most steeply in its first oscillations, which three mean lives contain.
        let end = beyond.max(3.0 * self.reformed.mean());
        let renewal = RenewalSolution::solve(&self.first, &self.reformed, end, tolerance, monitor)?;
        Ok(Pull::new(self.clone(), renewal, distance, tolerance))
    }
}

/// Length over that of a pull up to which it is solved, so that breaks at its end are inside.
const AFTER_BREAKS: f64 = 1.0 + 1e-6;

/// Refuses time-dependent contacts, which need a velocity.
fn check_time_independent(contacts: &Contacts) -> Result<()> {
    let Some(rule) = contacts.rules.first() else { return Ok(()) };
    let expected = format!("a velocity above 0, since {rule} makes contacts time-dependent");
    Err(Error::invalid("velocity", expected, "none"))
}

/// Whether two distributions are known to be equal.
fn same(a: &SharedLaw, b: &SharedLaw) -> bool {
    let parameters = a.parameters();
    Arc::ptr_eq(a, b) || (!parameters.is_empty() && a.name() == b.name() && parameters == b.parameters())
}

/// Refuses contacts whose thresholds vary on lengths so much shorter than the spread of starting stretches
/// that their life would not fit in memory.
fn affordable(contacts: &Contacts, key: &str, starts: &SharedLaw) -> Result<()> {
    /// Memory of the curves of a life and of the solution with it, per cell of 16 terms.
    const BYTES_PER_CELL: f64 = 16.0 * 8.0 * 20.0;
    const ALLOWED: u64 = 256 << 20;
    let needed = BYTES_PER_CELL * cells_of(contacts, starts);
    let what = "stretches spread over far more than the length on which thresholds vary";
    fits(key, what, needed as u64, ALLOWED)
}
