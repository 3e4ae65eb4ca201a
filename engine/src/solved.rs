//! The solution of the master equation for a scenario, and what follows from it without solving again.

use asperity::Result;
use asperity::contacts::{AgeingRule, Contacts, Initial};
use asperity::law::Law;
use asperity::master::{MasterEquation, Pull, Stretches, Tolerance};
use asperity::monitor::Monitor;
use asperity::scenario::{self, Model, Scenario};
use asperity::task::Grid;
use asperity::task::summary::Extended;

use crate::answer::{Density, ForceCurve, StretchDistributions};

/// Largest error of a preview, per N_c⟨k⟩ and mean life: a hundredth of the width of a line.
const PREVIEW: f64 = 1e-4;
/// Points of a curve, more than a screen has columns for it.
const POINTS: usize = 1001;

/// A pull at one tolerance.
#[derive(Debug)]
pub struct Solved {
    description: String,
    sample: Option<f64>,
    background: f64,
    /// That at which time-dependent contacts are pulled.
    velocity: Option<f64>,
    equation: MasterEquation,
    initial: Initial,
    pull: Pull,
}

/// Whether there is a pull that belongs to `scenario`: none under constant forces, none by a closure of mean field, and none of
/// time-dependent contacts that rest for the whole protocol.
pub fn has_pull(scenario: &Scenario) -> bool {
    let contacts = &scenario.contacts;
    let closure = matches!(contacts.ageing, Some(AgeingRule::MeanField { .. }));
    let timed = contacts.temperature.is_some() || contacts.ageing.is_some() || contacts.delay.is_some();
    let rests = timed && scenario.protocol.is_some() && velocity(scenario).is_none();
    scenario.creep.is_none() && !closure && !rests
}

/// The scenario of a pull over as much of the contacts as `scenario` needs.
pub fn pulled(scenario: &Scenario) -> Scenario {
    let (given, drive) = (scenario.pull.clone(), scenario.drive.as_ref());
    // The load point of an interface goes much farther than its cells.
    let slider = drive.filter(|_| scenario.interface.is_none());
    let pull = given.unwrap_or_else(|| scenario::Pull {
        distance: slider.and_then(|drive| drive.distance).unwrap_or_else(|| reach(scenario)),
        velocity: velocity(scenario),
        start: drive.map_or_else(Default::default, |drive| drive.start),
        ..scenario::Pull::default()
    });
    let pull =
        scenario::Pull { points: POINTS, snapshots: vec![], covariance: vec![], derivatives: false, ..pull };
    Scenario {
        title: String::new(),
        initial: scenario.initial.clone(),
        pull: Some(pull),
        master_equation: scenario.master_equation.clone(),
        ..Scenario::new(scenario.contacts.clone())
    }
}

/// A velocity of the task of `scenario`, at which time-dependent contacts are pulled: that of its slider, of the first step of a
/// protocol that moves, or the one in the middle of a curve.
fn velocity(scenario: &Scenario) -> Option<f64> {
    let of_drive = scenario.drive.as_ref().and_then(|drive| drive.velocity);
    let of_protocol =
        || scenario.protocol.as_ref()?.0.iter().find_map(|step| step.velocity.filter(|&v| v > 0.0));
    let of_curve = || {
        let velocities = scenario.velocity_curve.as_ref()?.velocities();
        Some((velocities.first()? * velocities.last()?).sqrt())
    };
    let of_holds = || scenario.hold_curve.as_ref().map(|curve| curve.velocity);
    let of_stability = || scenario.stability.as_ref().and_then(|task| task.velocities.first().copied());
    of_drive.or_else(of_protocol).or_else(of_curve).or_else(of_holds).or_else(of_stability)
}

/// Twenty mean thresholds.
fn reach(scenario: &Scenario) -> f64 {
    scenario.contacts.build().map_or(20.0, |contacts| 20.0 * contacts.thresholds.mean())
}

impl Solved {
    /// Solves the pull that belongs to `scenario`, unless it is that of `before`.
    ///
    /// # Errors
    /// Those of the solver; stopped by the monitor.
    pub fn of(
        scenario: &Scenario,
        preview: bool,
        before: Option<Self>,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let mut pulled = pulled(scenario);
        if preview {
            let given = pulled.master_equation.tolerance.unwrap_or(PREVIEW);
            pulled.master_equation.tolerance = Some(given.max(PREVIEW));
        }
        let description = serde_json::to_string(&pulled).unwrap_or_default();
        match before.filter(|before| before.description == description) {
            Some(before) => Ok(before),
            None => Self::solve(&pulled, description, monitor),
        }
    }

    fn solve(scenario: &Scenario, description: String, monitor: &mut dyn Monitor) -> Result<Self> {
        let model = scenario.build()?;
        let sample = model.sample();
        let Model { contacts, initial, background, .. } = model;
        let pull = scenario.pull.clone().unwrap_or_default();
        let equation = equation(contacts, &initial, pull.velocity, monitor)?;
        let velocity = pull.velocity.filter(|_| equation.contacts().rules.are_time_dependent());
        let tolerance = Tolerance::from(scenario.master_equation.tolerance);
        let pull = equation.pull_with(pull.distance, tolerance, monitor)?;
        Ok(Self { description, sample, background, velocity, equation, initial, pull })
    }

    /// F(X) and its numbers. A preview has no X* of thresholds without a closed Laplace transform, whose poles take longer than all
    /// else.
    ///
    /// # Errors
    /// Those of the solver; stopped by the monitor.
    pub fn force(&self, preview: bool, monitor: &mut dyn Monitor) -> Result<ForceCurve> {
        let last = (POINTS - 1) as f64;
        let position: Vec<f64> = (0..POINTS).map(|i| self.pull.distance() * (i as f64 / last)).collect();
        let std = self.sample.map(|size| self.pull.force_std_with(size, monitor)).transpose()?;
        let steady = self.equation.steady_state();
        let is_slow = preview && !self.equation.contacts().thresholds.laplace_is_closed();
        let relaxation_length = if is_slow { f64::NAN } else { self.equation.relaxation()?.length() };
        Ok(ForceCurve {
            velocity: self.velocity,
            force: position.iter().map(|&x| self.pull.force(x) + self.background).collect(),
            force_std: std.map(|std| position.iter().map(|&x| std(x)).collect()),
            static_friction: self.pull.static_friction().map(|mut peak| {
                peak.value += self.background;
                peak.into()
            }),
            kinetic_friction: steady.kinetic_friction() + self.background,
            relaxation_length: Extended(relaxation_length),
            critical_stiffness: Extended(self.pull.critical_stiffness()),
            accuracy: self.pull.error_estimate(),
            position,
        })
    }

    /// The distributions at `position`.
    ///
    /// # Errors
    /// Those of the solver.
    pub fn stretches(&self, position: f64) -> Result<StretchDistributions> {
        let position = position.clamp(0.0, self.pull.distance());
        let stretch = Grid::new(&self.equation, &self.initial, &[position]).stretches;
        let contacts = self.equation.contacts();
        let laws = [&contacts.thresholds, &contacts.reforming, &self.initial.law].map(|law| law.as_ref());
        // Contacts that break at a rate may never reach the thresholds.
        let timed = contacts.rules.are_time_dependent();
        let law_stretch = if timed { even(laws) } else { stretch.clone() };
        let [thresholds, reforming, initial] = laws.map(|law| density(law, &law_stretch));
        Ok(StretchDistributions {
            position,
            density: self.pull.stretch_density(position, &stretch)?.into(),
            steady: self.equation.steady_state().stretch_density(&stretch)?.into(),
            thresholds,
            reforming,
            initial,
            law_stretch,
            stretch,
        })
    }
}

/// The master equation of contacts, at a velocity if one is given.
///
/// # Errors
/// Those of the solver; stopped by the monitor.
pub fn equation(
    contacts: Contacts,
    initial: &Initial,
    velocity: Option<f64>,
    monitor: &mut dyn Monitor,
) -> Result<MasterEquation> {
    match velocity {
        Some(velocity) => MasterEquation::at_with(contacts, initial, velocity, monitor),
        None => MasterEquation::new_with(contacts, initial, monitor),
    }
}

/// Stretches at equal distances up to where one contact in 10⁶ is beyond.
fn even(laws: [&dyn Law; 3]) -> Vec<f64> {
    let top = 1.05 * laws.map(|law| law.upper_quantile(1e-6)).into_iter().fold(0.0, f64::max);
    (0..POINTS).map(|i| top * i as f64 / (POINTS - 1) as f64).collect()
}

fn density(law: &dyn Law, stretches: &[f64]) -> Density {
    let (at, weights) = law.atoms().iter().map(|atom| (atom.position, atom.weight)).unzip();
    Density { values: stretches.iter().map(|&x| law.density(x)).collect(), at, weights }
}

impl From<Stretches> for Density {
    fn from(found: Stretches) -> Self {
        let (at, weights) = found.atoms.iter().map(|atom| (atom.position, atom.weight)).unzip();
        Self { values: found.density, at, weights }
    }
}
