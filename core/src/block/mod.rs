//! A slider block pulled over its contacts through a spring: stick-slip and smooth sliding.
//!
//! The base of the slider is at X, its top at X_T, and K is the shear stiffness of the block between them:
//!
//! K(X_T − X) = F(X), X_T(X) = X + F(X)/K.
//!
//! The contacts are a [`Population`]. While X_T increases slowly, the slider creeps along the equilibria X_T(X), which are
//! stable if F' + K > 0. At an instability, or where contacts break simultaneously, it slips at fixed X_T by the rule
//! [`Slip`] to another equilibrium. An imposed position of the base (K = ∞) and an imposed force (K → 0) are other cases of
//! [`Loading`]. Backward motion is the mirror image of forward motion.
//!
//! A background force B ([`Block::with_background`]) adds to F against the motion; at rest it holds the slider.

mod creep;
mod curves;
mod equilibrium_path;
mod events;
mod inertia;
mod loading;
mod persistence;
mod quasistatic;
mod rate_dependent;
mod regime;
mod run;
mod simulation;
mod slip;
mod trace;

pub use creep::{CreepAccuracy, CreepLoad, CreepPath, CreepState};
pub use curves::{Curve, critical_stiffness};
pub use events::{Event, Size, Sizes};
pub use loading::Loading;
pub use persistence::PersistenceLimit;
pub use rate_dependent::{BlockMotion, BlockMotionState, Moment, RateDependentSlip, Slide};
pub use regime::{Missing, Regime};
pub use run::{Drive, StickSlip};
pub use simulation::{BlockSimulation, SimulationState};
pub use trace::{End, Point, SlipCourse};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use crate::energy::EnergyBalance;
use crate::monitor::Monitor;
use crate::population::Population;
use crate::{Error, Result};

/// What happens at fixed X_T from the moment at which the slider has lost its balance until it has found it again.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Slip {
    /// All contacts break, and re-form where the spring meets the force F_R that they then have, at
    /// X = X_T − F_R/K: at X = X_T, the spring relaxed, where contacts re-form relaxed.
    #[default]
    Reset,
    /// On to the next X with F(X) = K(X_T − X), contacts breaking and re-forming on the way.
    Overdamped,
    /// On to the next X with F(X) = K(X_T − X), F being that of the contacts that have not broken since the slip
    /// began; there, what has broken re-forms.
    Arrest,
    /// By γẊ = K(X_T − X) − F, without mass. At fixed X_T over contacts without time dependence it ends where `Overdamped` does.
    Damped {
        /// Viscous damping γ, force per velocity, above 0.
        #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force*time/length"))]
        damping: f64,
    },
    /// By MẌ = K(X_T − X) − F − γẊ to the first arrest Ẋ = 0; from there to the balance, without inertia.
    Inertial {
        /// Mass M of the slider, above 0.
        #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force*time^2/length"))]
        mass: f64,
        /// Viscous damping γ, force per velocity, 0 or above.
        #[serde(default)]
        #[schemars(extend("minimum" = 0, "x-dimension" = "force*time/length"))]
        damping: f64,
    },
}

/// A slider block.
///
/// ```
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// use asperity::block::{Block, Drive, Loading, Slip};
/// use asperity::master::MasterEquation;
///
/// let mut population = MasterEquation::new(contacts, &Initial::default())?.population()?;
/// let block = Block::new(Loading::Spring(0.5), Slip::Reset, None)?;
/// let run = block.pull(&mut population, &Drive::to(10.0))?;
/// // In a slip by reset the spring relaxes: the force drops to 0.
/// assert!(!run.events.is_empty());
/// assert!(run.events.iter().all(|slip| slip.after.force.abs() < 1e-9));
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    loading: Loading,
    slip: Slip,
    slip_fraction: Option<f64>,
    background: f64,
}

/// Largest γ/√(MK). A slip lasts about γ/K, and the speed relaxes within M/γ, so that the integration takes about γ²/(MK)
/// steps.
const MOST_DAMPING: f64 = 1e3;

impl Block {
    /// A slider pulled by `loading`.
    ///
    /// `slip_fraction`: an event in which a larger fraction of the contacts breaks is a slip. Smaller events enter only the
    /// size statistics, and their contacts re-form as they break. `None`: every event with a finite displacement is a slip.
    /// This is the choice for the master equation, in which contacts break continuously, without events.
    ///
    /// # Errors
    /// Stiffness or mass not above 0, damping below 0 or above 10³√(MK); a fraction outside (0, 1].
    pub fn new(loading: Loading, slip: Slip, slip_fraction: Option<f64>) -> Result<Self> {
        loading.check()?;
        match slip {
            Slip::Inertial { mass, damping } => {
                check_inertia(loading, mass, damping).map_err(|e| e.under("slip.inertial"))?;
            }
            Slip::Damped { damping } => check_damping(damping).map_err(|e| e.under("slip.damped"))?,
            Slip::Reset | Slip::Overdamped | Slip::Arrest => {}
        }
        if let Some(fraction) = slip_fraction.filter(|f| !(*f > 0.0 && *f <= 1.0)) {
            return Err(Error::invalid("slip_fraction", "a number above 0, up to 1", fraction));
        }
        Ok(Self { loading, slip, slip_fraction, background: 0.0 })
    }

    /// The same with a background force B on the base, in addition to the force F of the contacts: a dry friction that does
    /// not depend on displacement, time or velocity. It is B against the motion of the base; at rest it is what the balance of
    /// forces asks for, from −B to B. Forces of results are the sum of both.
    ///
    /// X_T is counted from where the spring carries B: K(X_T − X) + B = F + b with b the present background. A motion begins
    /// where the base is about to slide forward, at X_T = X + F/K. As long as the base slides forward all forces are larger by B
    /// than without B, and nothing else changes. A slider that would move back, after an inertial slip or when the drive turns,
    /// stays at rest until its spring has lost 2B; then B resists the motion back.
    ///
    /// # Errors
    /// A force that is not a finite number of 0 or above.
    pub fn with_background(self, force: f64) -> Result<Self> {
        crate::error::not_negative("background", force)?;
        Ok(Self { background: force, ..self })
    }

    /// The loading.
    pub fn loading(&self) -> Loading {
        self.loading
    }

    /// The background force B.
    pub fn background(&self) -> f64 {
        self.background
    }

    /// The slip rule.
    pub fn slip(&self) -> Slip {
        self.slip
    }

    /// The drive at which the slider is in equilibrium with a population: 0 for relaxed contacts.
    ///
    /// # Errors
    /// Those of the population.
    pub fn start(&self, population: &mut dyn Population) -> Result<f64> {
        run::start(self, population)
    }

    /// Pulls the slider over `population` through the turning points of `drive`.
    ///
    /// # Errors
    /// Turning points at which the drive does not turn; those of the population.
    pub fn pull(&self, population: &mut dyn Population, drive: &Drive) -> Result<StickSlip> {
        self.pull_with(population, drive, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::pull`]; stopped by the monitor.
    pub fn pull_with(
        &self,
        population: &mut dyn Population,
        drive: &Drive,
        monitor: &mut dyn Monitor,
    ) -> Result<StickSlip> {
        run::pull(self, population, drive, monitor)
    }
}

/// Refuses a mass and a damping with which the motion cannot be integrated.
fn check_inertia(loading: Loading, mass: f64, damping: f64) -> Result<()> {
    if !(mass > 0.0 && mass.is_finite()) {
        return Err(Error::invalid("mass", "a finite mass above 0", mass));
    }
    if !(damping >= 0.0 && damping.is_finite()) {
        return Err(Error::invalid("damping", "a finite damping, 0 or above", damping));
    }
    match loading {
        Loading::Spring(stiffness) => check_damping_ratio(stiffness, mass, damping),
        Loading::Rigid | Loading::Force => Ok(()),
    }
}

/// Refuses a damping that is not a finite number above 0.
fn check_damping(damping: f64) -> Result<()> {
    if damping > 0.0 && damping.is_finite() {
        return Ok(());
    }
    Err(Error::invalid("damping", "a finite damping above 0", damping))
}

/// Refuses γ > 10³ √(MK).
fn check_damping_ratio(stiffness: f64, mass: f64, damping: f64) -> Result<()> {
    let most = MOST_DAMPING * (mass * stiffness).sqrt();
    if damping > most {
        let expected = format!(
            "a damping up to {MOST_DAMPING} √(mass × stiffness) = {most:.6}, as the time to integrate grows with \
             its square (beyond, the slip is that of \"overdamped\" to 1e-6)"
        );
        return Err(Error::invalid("damping", expected, damping));
    }
    Ok(())
}
