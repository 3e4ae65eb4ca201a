//! The model on which a task is computed, and the combinations of tasks and models that are valid.

use super::{
    Block, CellLoading, Compare, Disorder, Drive, Ensemble, FitNoise, Interface, MasterEquation, PerCell,
    Pull, Stability, Task, VelocityCurve,
};
use crate::contacts::{Ageing, Contacts, Initial};
use crate::monitor::{Aside, Monitor};
use crate::{Error, Result};

/// Contacts and their initial state, the slider over them, and how both are solved.
#[derive(Debug, Clone)]
pub struct Model {
    /// The contacts.
    pub contacts: Contacts,
    /// Their stretches at X = 0.
    pub initial: Initial,
    /// The velocity of the steady sliding in which contacts followed in time begin; `None` if they begin as `initial`.
    pub steady: Option<f64>,
    /// Normal load carried by the interface, a force; with it, friction coefficients are reported in addition to forces.
    pub normal_load: Option<f64>,
    /// Background force B, in addition to that of the contacts and against the motion; 0 if there is none.
    pub background: f64,
    /// Whether the background force is proportional to the normal load, as that of `contacts.background_coefficient`.
    pub background_of_load: bool,
    /// The slider between its top and its base; `None` if it is rigid.
    pub block: Option<Block>,
    /// Cells of a slider that deforms; `None` if all contacts move together.
    pub interface: Option<Interface>,
    /// How the master equation is solved.
    pub master_equation: MasterEquation,
    /// The simulation of single contacts in addition to it, if any.
    pub ensemble: Option<Ensemble>,
    /// A measured curve to compare with F(X).
    pub compare: Option<Compare>,
    /// The keys of the scenario whose numbers may be parameters of the force, with the names of these parameters; none where
    /// there is no scenario.
    pub keys: Vec<(String, String)>,
    /// Warnings about valid values with unexpected consequences.
    pub warnings: Vec<String>,
}

impl Model {
    /// Contacts under a rigid slider, by the master equation with its default tolerance.
    pub fn new(contacts: Contacts, initial: Initial) -> Self {
        Self {
            contacts,
            initial,
            steady: None,
            normal_load: None,
            background: 0.0,
            background_of_load: false,
            block: None,
            interface: None,
            master_equation: MasterEquation::default(),
            ensemble: None,
            compare: None,
            keys: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// The background force at a normal load relative to that at the start.
    pub(crate) fn background_at(&self, load: f64) -> f64 {
        if self.background_of_load { load * self.background } else { self.background }
    }

    /// Upper limit of the bytes that its interface takes; `None` without one.
    pub fn memory_of_interface(&self) -> Option<u64> {
        let interface = self.interface.as_ref()?;
        Some(interface.bytes(&self.contacts, self.ensemble.as_ref(), self.estimates_error_of_cells()))
    }

    /// Whether the error of cells in time is estimated: only if an accuracy is required, since it takes a second motion.
    pub(crate) fn estimates_error_of_cells(&self) -> bool {
        self.master_equation.tolerance.is_some() && self.ensemble.is_none()
    }

    /// N_c⟨k⟩, the stiffness of all contacts together, force per length.
    pub fn stiffness(&self) -> f64 {
        let Contacts { count, stiffness, thresholds, .. } = &self.contacts;
        count * stiffness.mean(thresholds.as_ref())
    }

    /// Number of contacts for which the scatter of the force is shown: that of the ensemble, or `contacts.count`.
    pub fn sample(&self) -> Option<f64> {
        let counted = Some(self.contacts.count).filter(|&count| count > 1.0);
        self.ensemble.as_ref().map(|ensemble| ensemble.size() as f64).or(counted)
    }
}

impl Task<'_> {
    /// Checks its values, those of the `model`, and their combination.
    ///
    /// # Errors
    /// The first invalid value, with its full path.
    pub fn check(self, model: &Model) -> Result<()> {
        self.check_with(model, &mut ())
    }

    /// The same with a monitor: a fit is checked with the life of its contacts.
    ///
    /// # Errors
    /// As [`Self::check`]; stopped by the monitor.
    pub fn check_with(self, model: &Model, monitor: &mut dyn Monitor) -> Result<()> {
        let monitor = &mut Aside { fraction: 0.0, monitor };
        self.check_values()?;
        self.check_time(model)?;
        self.check_start(model)?;
        self.check_block(model)?;
        self.check_interface(model)?;
        self.check_background(model)?;
        self.check_load(model).map_err(|e| e.under("protocol"))?;
        let noise = match self {
            Task::Pull(Pull { covariance, .. }) => !covariance.is_empty(),
            Task::Fit(fit) => fit.velocity_curve.is_none() && fit.noise == FitNoise::Contacts,
            task => matches!(task, Task::Spectrum(_)),
        };
        if noise {
            model.contacts.renew_completely().map_err(Error::of_scenario)?;
            refuse_quenched(self, model)?;
        }
        if let Task::Fit(fit) = self {
            fit.check_first_values(model, monitor).map_err(Error::of_scenario)?;
        }
        model.master_equation.check().map_err(|e| e.under("master_equation"))?;
        if let Some(compare) = &model.compare {
            compare.check(self, model.block.is_some()).map_err(|e| e.under("compare"))?;
        }
        if let (Task::Stability(Stability { simulations: Some(simulations), .. }), None) =
            (self, &model.ensemble)
        {
            let expected = "none without [ensemble], which describes the single contacts";
            return Err(Error::invalid("stability.simulations", expected, *simulations));
        }
        if let Task::Creep(_) = self {
            check_creep(model)?;
        }
        if let Some(ensemble) = &model.ensemble {
            ensemble.build(model.contacts.clone(), model.initial.clone())?;
        }
        Ok(())
    }

    /// Refuses a background force where it is not a shift of all forces.
    fn check_background(self, model: &Model) -> Result<()> {
        if model.background == 0.0 {
            return Ok(());
        }
        let refused = |expected: &str| {
            let found = format!("one of {}", model.background);
            Err(Error::invalid("contacts.background_force", expected, found))
        };
        match (self, &model.interface) {
            (Task::Drive(_) | Task::Protocol(_), Some(interface)) => {
                match (interface.contacts, interface.loading) {
                    (PerCell::One, _) => refused("none of contacts coupled one by one, which no cell holds"),
                    (_, CellLoading::Edge) => refused(
                        "none with interface.loading = \"edge\": no spring carries it in cells away from the edge",
                    ),
                    (PerCell::Many, _)
                        if interface.mass.is_some() && model.contacts.rules.first().is_none() =>
                    {
                        refused("none of athermal contacts with interface.mass, whose cells swing back")
                    }
                    (PerCell::Many, CellLoading::Uniform) => Ok(()),
                }
            }
            (Task::Renormalisation(_), _) => refused("none with [renormalisation], which has no forces"),
            (Task::Fit(fit), None) if fit.steady.is_some() => {
                refused("none with [fit.steady]: fit.offset is the constant part of a measured force")
            }
            _ => Ok(()),
        }
    }

    /// Refuses steps of the normal load where they are not followed.
    fn check_load(self, model: &Model) -> Result<()> {
        let Task::Protocol(protocol) = self else { return Ok(()) };
        let shared = matches!(model.contacts.rules.ageing, Some(Ageing::MeanField { .. }));
        let refused = match (&model.block, &model.interface) {
            (Some(_), _) => "with [block]: steps of the normal load are followed under a rigid slider only",
            (_, Some(_)) => {
                "with [interface]: steps of the normal load are followed under a rigid slider only"
            }
            _ if shared => {
                "with contacts.ageing.mean_field: contacts that form later would share its thresholds"
            }
            _ => return Ok(()),
        };
        protocol.loads_constantly(refused)
    }

    fn check_block(self, model: &Model) -> Result<()> {
        match (self, &model.block) {
            (Task::Drive(drive), Some(block)) if model.contacts.rules.are_time_dependent() => {
                drive.slider(Some(block), true).and_then(|_| block.in_time(true)).map(drop)
            }
            (Task::Drive(drive), block) => drive.slider(block.as_ref(), true).map(drop),
            (Task::Protocol(_), Some(block)) => block.in_time(true).map(drop),
            (Task::VelocityCurve(VelocityCurve { stability: true, .. }), Some(block)) => {
                block.inertia_and_drag().map(drop)
            }
            (Task::Stability(_), Some(block)) if model.contacts.rules.are_time_dependent() => {
                block.inertia_and_drag().map(drop)
            }
            (Task::Stability(_), Some(block)) => Drive::default().slider(Some(block), true).map(drop),
            (Task::Stability(_), None) => Err(Error::invalid(
                "block",
                "a table [block] with [stability]: a slider behind a spring",
                "none",
            )),
            (_, None) => Ok(()),
            (task, Some(_)) => {
                let found = format!("one with [{}]", task.name());
                Err(Error::invalid(
                    "block",
                    "a block only with the tasks [drive], [[protocol]] and [stability], and with velocity_curve.stability = true",
                    found,
                ))
            }
        }
    }

    fn check_interface(self, model: &Model) -> Result<()> {
        let Some(interface) = &model.interface else {
            return match self {
                Task::Drive(Drive { maps, .. }) if !maps.is_empty() => {
                    let expected = "no maps without [interface], whose cells they show";
                    Err(Error::invalid("drive.maps", expected, format!("{} of them", maps.len())))
                }
                Task::Renormalisation(_) => Err(Error::invalid(
                    "interface",
                    "one with [renormalisation]: contacts that are coupled",
                    "none",
                )),
                _ => Ok(()),
            };
        };
        if model.block.is_some() {
            let expected = "no block beside [interface], whose cells have connections of their own";
            return Err(Error::invalid("block", expected, "one"));
        }
        match self {
            Task::Drive(drive) => interface.check(&model.contacts, drive, model.ensemble.as_ref()),
            Task::Protocol(_) => {
                check_alone(model)?;
                interface.check_in_time(&model.contacts, model.ensemble.as_ref())
            }
            Task::Renormalisation(task) => task.check_interface(interface, model),
            task => {
                let expected = "an interface only with the tasks [drive], [[protocol]] and [renormalisation]";
                Err(Error::invalid("interface", expected, format!("one with [{}]", task.name())))
            }
        }
    }
}

/// Refuses, beside the exact noise of contacts that get a new threshold at each break, an ensemble of contacts that keep
/// theirs.
fn refuse_quenched(task: Task<'_>, model: &Model) -> Result<()> {
    match &model.ensemble {
        Some(Ensemble { disorder: Disorder::Quenched, .. }) => {
            let what =
                if task.name() == "pull" { "pull.covariance".into() } else { format!("[{}]", task.name()) };
            let expected = format!(
                "annealed beside {what}: the noise is known exactly for contacts that get a new threshold at each break"
            );
            Err(Error::invalid("ensemble.disorder", expected, "quenched"))
        }
        _ => Ok(()),
    }
}

/// Refuses what creep under a constant force does not have.
fn check_creep(model: &Model) -> Result<()> {
    if model.ensemble.is_some() {
        let expected = "no ensemble with [creep], whose motion is that of the master equation";
        return Err(Error::invalid("ensemble", expected, "one"));
    }
    let viscosity = model.contacts.rules.free_friction.viscosity;
    if viscosity > 0.0 {
        let expected = "0 with [creep], whose slider has no drag";
        return Err(Error::invalid("contacts.free_friction.viscosity", expected, viscosity));
    }
    Ok(())
}

/// Refuses a compared curve beside an interface that is moved in time.
fn check_alone(model: &Model) -> Result<()> {
    let expected = "no compared curve beside [interface] with [[protocol]]: each of its cells has a force";
    model.compare.as_ref().map_or(Ok(()), |_| Err(Error::invalid("compare", expected, "one")))
}
