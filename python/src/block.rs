//! A slider block over a model of its contacts.

use asperity::block::{self, Curve, Loading};
use asperity::scenario::{self, Slip};
use asperity::task::summary::StickSlipNumbers;
use asperity::task::{first_loading_distance, stability, stick_slip_scatter, stick_slip_stability};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::argument::{Argument, Optional as _, Real, Whole};
use crate::arguments::slip_rule;
use crate::convert::{self, Domain, Seed};
use crate::description::Description;
use crate::model::Model;
use crate::plain::{Plain, Slider};
use crate::simulation::Simulation;
use crate::solver::Solver;
use crate::stick_slip::StickSlip;
use crate::transport::{self, Step};
use crate::typed::argument_type;
use crate::watch::watched;
use crate::{error, typed, values};

/// The slip of a slider with mass, MẌ = K(X_T - X) - F - γẊ, from the loss of stability to the first arrest.
///
/// X_T is fixed during the slip. The remaining oscillation is then damped out, and the slider comes to rest in
/// equilibrium.
///
/// Parameters
/// ----------
/// mass
///     The mass M, above 0.
/// damping
///     The viscous damping γ, force per velocity, 0 or above.
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For a mass that is not above 0, and a damping below 0.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
/// >>> asp.Block(theory, 1.0, asp.Inertial(1.0)).slip
/// Inertial(mass=1.0)
#[pyclass(frozen, extends = Description, module = "asperity")]
pub struct Inertial;

#[pymethods]
impl Inertial {
    #[new]
    #[pyo3(signature = (mass, damping = Real::new(0.0)), text_signature = "(mass, damping=0.0)")]
    fn new(mass: Real, damping: Real) -> PyResult<PyClassInitializer<Self>> {
        let damping = damping.get("damping")?;
        let mass = mass.get("mass")?;
        let slip = Slip::Inertial { mass, damping };
        block::Block::new(Loading::Rigid, slip, None).map_err(error::core)?;
        Ok(Description::new(Plain::Slip(slip)).add_subclass(Self))
    }

    /// The mass M.
    #[getter]
    fn mass(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).0
    }

    /// The viscous damping γ, force per velocity.
    #[getter]
    fn damping(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).1
    }
}

impl Inertial {
    /// Mass and damping.
    fn plain(slip: &Bound<'_, Self>) -> (f64, f64) {
        match *slip.as_super().get().plain() {
            Plain::Slip(Slip::Inertial { mass, damping }) => (mass, damping),
            _ => unreachable!("an inertial slip is described as one"),
        }
    }
}

/// The slip of a slider without mass against a viscous damping, γẊ = K(X_T - X) - F.
///
/// Over time-independent contacts, at fixed X_T, it ends where "overdamped" does.
///
/// Parameters
/// ----------
/// damping
///     The viscous damping γ, force per velocity, above 0.
///
/// Raises
/// ------
/// TypeError
///     For an argument of another type, which the message names.
/// ValueError
///     For a damping that is not above 0.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
/// >>> asp.Block(theory, 1.0, asp.Damped(0.1)).slip
/// Damped(damping=0.1)
#[pyclass(frozen, extends = Description, module = "asperity")]
pub struct Damped;

#[pymethods]
impl Damped {
    #[new]
    fn new(damping: Real) -> PyResult<PyClassInitializer<Self>> {
        let damping = damping.get("damping")?;
        let slip = Slip::Damped { damping };
        block::Block::new(Loading::Rigid, slip, None).map_err(error::core)?;
        Ok(Description::new(Plain::Slip(slip)).add_subclass(Self))
    }

    /// The viscous damping γ, force per velocity.
    #[getter]
    fn damping(slf: &Bound<'_, Self>) -> f64 {
        match *slf.as_super().get().plain() {
            Plain::Slip(Slip::Damped { damping }) => damping,
            _ => unreachable!("a damped slip is described as one"),
        }
    }
}

/// A slip rule: one of the words, a damped or an inertial slip.
struct Rule(Slip);

impl<'py> FromPyObject<'_, 'py> for Rule {
    type Error = PyErr;

    argument_type!("Literal['reset', 'overdamped', 'arrest'] | Damped | Inertial");

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(inertial) = value.cast::<Inertial>() {
            let (mass, damping) = Inertial::plain(&inertial);
            return Ok(Self(Slip::Inertial { mass, damping }));
        }
        if let Ok(damped) = value.cast::<Damped>() {
            return Ok(Self(Slip::Damped { damping: Damped::damping(&damped) }));
        }
        if value.is_instance_of::<PyString>() {
            return convert::word("slip", value.extract()?).map(Self);
        }
        Err(error::wrong_type("slip", "a word, asperity.Damped or asperity.Inertial", &value))
    }
}

/// A slider block: its top (the load point, at X_T) is driven, its base (at X) is held by contacts, and its
/// shear stiffness K connects them.
///
/// K(X_T - X) = F(X). Where F decreases more steeply than the spring force, F' < -K, the slider becomes
/// unstable and slips at fixed X_T (Braun and Peyrard 2008).
///
/// Contacts with a background force B add it to F, against the motion; forces contain it. X_T is counted from
/// where the spring carries B, K(X_T - X) + B = F + B as long as the base slides forward. A slider that would move
/// back stays at rest until its spring has lost 2B.
///
/// Parameters
/// ----------
/// model
///     The contacts: a MasterEquation or an Ensemble, or, for motion in time, a Transport or an Ensemble.
/// stiffness
///     The stiffness K, force per length, above 0; None or inf for a rigid slider, which is always stable.
/// slip
///     The slip rule: "reset" if all contacts break and re-form, and the spring is relaxed; "overdamped" if the
///     slider moves to the next equilibrium while contacts break and re-form; "arrest" if contacts that break stay
///     detached until it has stopped; Damped for motion against a viscous damping; Inertial for motion with mass.
/// slip_fraction
///     An event is a slip if more than this fraction of the contacts of an ensemble break at one drive, above 0, up
///     to 1.
///
/// Raises
/// ------
/// ValueError
///     For a stiffness that is not above 0, a slip that is none of these words, a slip_fraction that is not above 0
///     and up to 1, and, with Inertial, a damping above 1000 √(MK), with which a slip would take too long to follow.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
/// >>> run = asp.Block(theory, stiffness=1.0).drive(distance=3.0)
/// >>> run.regime
/// 'undecided'
/// >>> round(run.first_instability.force, 6)
/// 0.773611
#[pyclass(frozen, extends = Description, module = "asperity")]
pub struct Block {
    model: Py<Model>,
}

#[pymethods]
impl Block {
    #[new]
    #[pyo3(
        signature = (model, stiffness, slip = Rule(Slip::Reset), *, slip_fraction = Real::new(scenario::Block::SLIP_FRACTION)),
        text_signature = "(model, stiffness, slip='reset', *, slip_fraction=0.05)"
    )]
    fn new(
        model: Argument<Bound<'_, Model>>,
        stiffness: Option<Real>,
        slip: Rule,
        slip_fraction: Real,
    ) -> PyResult<PyClassInitializer<Self>> {
        let model = model.get("model")?;
        let slip_fraction = slip_fraction.get("slip_fraction")?;
        let stiffness = stiffness.get("stiffness")?;
        let stiffness = stiffness.filter(|&stiffness| stiffness != f64::INFINITY);
        let loading = stiffness.map_or(Loading::Rigid, Loading::Spring);
        block::Block::new(loading, slip.0, Some(slip_fraction)).map_err(|e| error::core(e.under("block")))?;
        let plain = Box::new(model.as_super().get().plain().clone());
        let slider = Slider { model: plain, stiffness, slip: slip.0, slip_fraction };
        Ok(Description::new(Plain::Block(slider)).add_subclass(Self { model: model.unbind() }))
    }

    /// The model of the contacts.
    #[getter]
    fn model<'py>(&self, py: Python<'py>) -> typed::BlockModel<'py> {
        typed::BlockModel(self.model.bind(py).clone().into_any())
    }

    /// The shear stiffness K, force per length; inf for a rigid slider.
    #[getter]
    fn stiffness(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).stiffness.unwrap_or(f64::INFINITY)
    }

    /// The slip rule: "reset", "overdamped", "arrest", Damped or Inertial.
    #[getter]
    fn slip<'py>(slf: &Bound<'py, Self>) -> PyResult<typed::SlipRule<'py>> {
        slip_rule(Self::plain(slf).slip, slf.py()).map(typed::SlipRule)
    }

    /// An event is a slip if more than this fraction of the contacts of an ensemble break at one drive.
    #[getter]
    fn slip_fraction(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).slip_fraction
    }

    /// Linear stability of steady sliding at a velocity, with the stiffness, mass and damping of this slider, from
    /// the dynamic stiffness of the contacts of its Transport.
    ///
    /// Parameters
    /// ----------
    /// velocity
    ///     The velocity of the load point, above 0.
    /// progress
    ///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
    ///
    /// Returns
    /// -------
    /// Stability
    ///     A Stability of `critical_stiffness`, above which steady sliding is stable, the `frequency` of the
    ///     oscillation that sets in there, and the `growth_rate` and `growth_frequency` of the fastest growing
    ///     deviation, 0 where sliding is stable. The critical stiffness is accurate to 1e-8 of the stiffness of all
    ///     contacts with temperature or ageing by age, to 1e-4 with both, and to 1e-3, or that of itself where it is
    ///     larger, for thresholds that diffuse.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a rigid slider, for the slip rules "reset", "overdamped" and "arrest", for a model that is not a
    ///     Transport, and for a velocity that is not above 0.
    #[pyo3(signature = (velocity, *, progress: "_Progress" = None))]
    fn stability<'py>(
        slf: &Bound<'py, Self>,
        velocity: Real,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<typed::Stability<'py>> {
        let velocity = velocity.get("velocity")?;
        let py = slf.py();
        let Some(table) = Self::plain(slf).table() else {
            return Err(error::invalid("block.stiffness", "a finite stiffness", f64::INFINITY));
        };
        let model = slf.get().model.bind(py).clone();
        let Solver::Transport(transport) = model.get().solver() else {
            return Err(error::invalid(
                "block.model",
                "a Transport, whose response is linear",
                "another model",
            ));
        };
        let contacts = &transport.contacts;
        let found = watched(progress, py, |monitor| stability(contacts, velocity, Some(&table), monitor))?;
        values::stability(py, found)
    }

    /// Whether this slider sticks and slips when its load point is moved on at a constant velocity, and behind which
    /// springs it does.
    ///
    /// The slider is moved until its motion decides, first behind its own spring, then behind others: the stiffness at
    /// which persistent stick-slip ends is bisected, down to 1e-3 of the stiffness of all contacts. With a size, this is
    /// repeated over that many single contacts, in several simulations with different contacts, in which an event is a slip
    /// if it breaks more than the slip_fraction of the block.
    ///
    /// Parameters
    /// ----------
    /// velocity
    ///     The velocity of the load point, above 0; required for time-dependent contacts, unless the model is a
    ///     MasterEquation at a velocity; without effect for others.
    /// resolution
    ///     The ratio of the two stiffnesses that enclose that end is at most 1 + resolution.
    /// size
    ///     The number of single contacts of a simulation, 1 or more; None: no simulations.
    /// simulations
    ///     The number of simulations, 1 or more, by default 10; only with a size.
    /// seed
    ///     The seed of the random numbers.
    /// progress
    ///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
    ///
    /// Returns
    /// -------
    /// StickSlipStability
    ///     A StickSlipStability of `stick_slip` ("none", "transient", "persistent" or "undecided") with its `reason`,
    ///     `persistent_stiffness` and `persistent_stiffness_above`, between which persistent stick-slip ends, and the
    ///     critical stiffnesses of the first pull and of steady sliding; with a size, its `ensemble` is a
    ///     SimulatedStickSlip.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a rigid slider, an Ensemble, a Transport that starts in steady sliding, no contacts, no simulations, a
    ///     number of them without a size, and for a slip rule that has no meaning in time, or a slip without mass and
    ///     damping, where contacts are time-dependent.
    #[pyo3(
        signature = (
            velocity = None, *, resolution = Real::new(scenario::Stability::RESOLUTION), size = None,
            simulations = None, seed = Seed(1), progress: "_Progress" = None
        ),
        text_signature = "($self, velocity=None, *, resolution=0.02, size=None, simulations=None, seed=1, progress=None)"
    )]
    fn stick_slip<'py>(
        slf: &Bound<'py, Self>,
        velocity: Option<Real>,
        resolution: Real,
        size: Option<Whole>,
        simulations: Option<Whole>,
        seed: Seed,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<typed::StickSlipStability<'py>> {
        let velocity = velocity.get("velocity")?;
        let resolution = resolution.get("resolution")?;
        let py = slf.py();
        let Some(table) = Self::plain(slf).table() else {
            return Err(error::invalid("block.stiffness", "a finite stiffness", f64::INFINITY));
        };
        let (mut model, own) = Model::described(slf.get().model.bind(py), table)?;
        let velocity = velocity.or(own);
        let given: Option<usize> =
            simulations.map(|simulations| simulations.get("simulations")).transpose()?;
        let simulations = match (given, &size) {
            (Some(given), None) => {
                let expected = "none without a size, the number of single contacts of a simulation";
                return Err(error::invalid("simulations", expected, given));
            }
            (given, _) => given.unwrap_or(scenario::Stability::SIMULATIONS),
        };
        let drawn =
            |size| scenario::Ensemble { size: Some(size), seed: seed.0, ..scenario::Ensemble::default() };
        model.ensemble = size.map(|size| size.get("size")).transpose()?.map(drawn);
        let (found, scatter) = watched(progress, py, |monitor| {
            if model.ensemble.is_none() {
                return Ok((stick_slip_stability(&model, velocity, resolution, monitor)?, None));
            }
            let (found, scatter) = stick_slip_scatter(&model, velocity, resolution, simulations, monitor)?;
            Ok((found, Some(scatter)))
        })?;
        let numbers = StickSlipNumbers {
            ensemble: scatter.map(|scatter| scatter.numbers()),
            ..found.numbers(velocity)
        };
        values::stick_slip_stability(py, &numbers)
    }

    /// Parameters
    /// ----------
    /// velocity
    ///     The velocity of the load point, above 0, for motion in time; required over a Transport, and over an
    ///     Ensemble of time-dependent contacts.
    ///
    /// Returns
    /// -------
    /// Simulation
    ///     A simulation that advances step by step, at X_T = 0, or in equilibrium with the contacts of a Transport.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a Transport without a velocity, a MasterEquation with one, and for a slip rule that has no meaning in
    ///     time; for time-dependent contacts without a velocity unless the MasterEquation has one.
    #[pyo3(signature = (*, velocity = None))]
    fn simulation(slf: &Bound<'_, Self>, velocity: Option<Real>) -> PyResult<Simulation> {
        let velocity = velocity.get("velocity")?;
        let Slider { stiffness, slip, slip_fraction, .. } = *Self::plain(slf);
        let loading = stiffness.map_or(Loading::Rigid, Loading::Spring);
        let model = slf.get().model.bind(slf.py());
        let fraction = model.get().solver().size().map(|_| slip_fraction);
        let slider =
            block::Block::new(loading, slip, fraction).and_then(|b| b.with_background(Self::background(slf)));
        let slider = slider.map_err(error::core)?;
        let solver = model.get().solver();
        let simulated = watched(None, slf.py(), |monitor| match velocity {
            Some(velocity) => solver.simulated_in_time(&slider, velocity, monitor),
            None => solver.simulated(&slider, monitor),
        })?;
        Simulation::new(slf.as_super(), (velocity, None), vec![1], simulated)
    }

    /// Moves the load point of the slider from X_T = 0, or imposes a force, and computes the motion of its base.
    ///
    /// Parameters
    /// ----------
    /// distance
    ///     The load-point displacement, a length above 0; 20 by default.
    /// turning_points
    ///     Instead, successive positions X_T of the load point, for driving back and forth.
    /// force_to
    ///     Instead, an imposed force, above 0, up to which a slider of infinite stiffness is pulled, whatever its
    ///     position.
    /// points
    ///     The number of points of the trace, evenly spaced along the drive, including both ends; 2 or more; turning
    ///     points, and points before and after every slip, are added.
    /// velocity
    ///     The velocity of the load point, above 0, for motion in time as by follow; required over a Transport, and
    ///     over time-dependent contacts.
    /// progress
    ///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
    ///
    /// Returns
    /// -------
    /// StickSlip
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a distance, a velocity or an imposed force that is not above 0, more than one of distance,
    ///     turning_points and force_to, turning points that do not turn, fewer than 2 points, an imposed force with a
    ///     finite stiffness, no velocity for a Transport, and a velocity for a MasterEquation.
    /// MemoryError
    ///     For results that do not fit or too many point masses.
    /// RuntimeError
    ///     If the tolerance is not reached.
    #[pyo3(
        signature = (
            distance = None, points = Whole::new(2001), *, velocity = None, turning_points: "ArrayLike | None" = None, force_to = None,
            progress: "_Progress" = None
        ),
        text_signature = "($self, distance=None, points=2001, *, velocity=None, turning_points=None, force_to=None, progress=None)"
    )]
    fn drive(
        slf: Bound<'_, Self>,
        distance: Option<Real>,
        points: Whole,
        velocity: Option<Real>,
        turning_points: Option<&Bound<'_, PyAny>>,
        force_to: Option<Real>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Py<StickSlip>> {
        let distance = distance.get("distance")?;
        let velocity = velocity.get("velocity")?;
        let force_to = force_to.get("force_to")?;
        let turning_points =
            turning_points.map(|points| convert::list("turning_points", points)).transpose()?;
        let points = points.get("points")?;
        let asked = scenario::Drive {
            distance,
            turning_points,
            force_to,
            points,
            velocity,
            ..scenario::Drive::default()
        };
        asked.check().map_err(|e| error::core(e.under("drive")))?;
        let model = slf.get().model.bind(slf.py()).clone();
        if velocity.is_some() {
            let protocol = asked.forward().map_err(|e| error::core(e.under("drive")))?;
            return StickSlip::in_time(slf.into_super(), &model, &protocol, progress);
        }
        StickSlip::object(slf.into_super(), &model, &asked, progress)
    }

    /// Moves the load point of the slider from equilibrium at t = 0 through the steps, one after the other, and
    /// integrates the motion of its base: MẌ = K(X_T - X) - F - γẊ.
    ///
    /// The slip rule is Damped or Inertial, because something must limit the slip velocity, or the default: without mass
    /// and damping the spring is in balance at every time, K(X_T - X) = F, and a slip is an error. A slip is the
    /// interval in which the base is more than ten times as fast as the load point; over an ensemble it also breaks
    /// more than the fraction slip_fraction of the contacts.
    ///
    /// Parameters
    /// ----------
    /// steps
    ///     A list of Step.
    /// progress
    ///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
    ///
    /// Returns
    /// -------
    /// StickSlip
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For no steps, another slip rule, a slip without damping and mass, a rigid slider, or a MasterEquation,
    ///     which has one velocity.
    #[pyo3(signature = (steps, *, progress: "_Progress" = None))]
    fn follow(
        slf: Bound<'_, Self>,
        steps: Argument<Vec<Bound<'_, Step>>>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Py<StickSlip>> {
        let steps = steps.get("steps")?;
        let model = slf.get().model.bind(slf.py()).clone();
        StickSlip::in_time(slf.into_super(), &model, &transport::protocol(steps)?, progress)
    }

    /// The equilibria X_T(X) = X + F(X)/K of the first loading, without slips: drive, position, force, and whether
    /// the slider is stable there, F' + K > 0.
    ///
    /// Parameters
    /// ----------
    /// distance
    ///     The displacement of the base, a length above 0; by default 5 mean thresholds.
    /// points
    ///     The number of positions, evenly spaced, including both ends; 2 or more; where the force jumps, both sides
    ///     are added.
    ///
    /// Returns
    /// -------
    /// Equilibria
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a distance that is not above 0, fewer than 2 points, and a Transport.
    #[pyo3(
        signature = (distance = None, points = Whole::new(2001)),
        text_signature = "($self, distance=None, points=2001)"
    )]
    fn equilibrium<'py>(
        slf: &Bound<'py, Self>,
        distance: Option<Real>,
        points: Whole,
    ) -> PyResult<typed::Equilibria<'py>> {
        let distance = distance.get("distance")?;
        let curve = Self::curve(slf, "equilibrium", distance, points)?;
        values::equilibria(slf.py(), curve, Self::stiffness(slf))
    }

    /// Plots the equilibria of the first loading, as the plot() of equilibrium(); it needs matplotlib, whose styles it
    /// follows.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib.axes.Axes, optional
    ///     Axes to plot on; new ones by default.
    /// **style
    ///     Arguments of the plot() of the axes.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///     The axes.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If matplotlib is not installed.
    #[pyo3(signature = (ax: "Axes | None" = None, **style: "Any") -> "Axes")]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
        style: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("asperity._plot")?.call_method("block", (slf, ax), style)
    }

    /// The potential V(X_T, X) = ½K(X_T - X)² + ∫F dX of the first loading; at its minima the slider is in stable
    /// equilibrium.
    ///
    /// The result has `position` of shape (n,), `energy` of shape (n,) or (m, n), and the drives of a list as `drive`.
    ///
    /// Parameters
    /// ----------
    /// drive
    ///     A drive X_T, or a list of m of them.
    /// distance, points
    ///     As for equilibrium.
    ///
    /// Returns
    /// -------
    /// Potential
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a rigid slider, which has no potential.
    #[pyo3(
        signature = (drive: "ArrayLike", distance = None, points = Whole::new(2001)),
        text_signature = "($self, drive, distance=None, points=2001)"
    )]
    fn potential<'py>(
        slf: &Bound<'py, Self>,
        drive: &Bound<'py, PyAny>,
        distance: Option<Real>,
        points: Whole,
    ) -> PyResult<typed::Potential<'py>> {
        let distance = distance.get("distance")?;
        const DRIVES: Domain = Domain { what: "a drive", ..Domain::NUMBERS };
        let (drives, single) = convert::one_or_list("drive", drive, &DRIVES)?;
        let Some(stiffness) = Self::plain(slf).stiffness else {
            return Err(error::invalid(
                "block.stiffness",
                "a finite stiffness for a potential",
                f64::INFINITY,
            ));
        };
        let curve = Self::curve(slf, "potential", distance, points)?;
        let energy = drives.iter().flat_map(|&drive| curve.potential(stiffness, drive)).collect();
        let shape = [drives.len(), curve.position.len()];
        let energy = convert::array(slf.py(), if single { &shape[1..] } else { &shape }, energy)?;
        values::potential(slf.py(), curve.position, energy, (!single).then_some(drives))
    }
}

impl Block {
    pub fn plain<'a>(block: &'a Bound<'_, Self>) -> &'a Slider {
        match block.as_super().get().plain() {
            Plain::Block(slider) => slider,
            _ => unreachable!("a block is described as a block"),
        }
    }

    /// The background force of the contacts.
    fn background(block: &Bound<'_, Self>) -> f64 {
        Model::background(block.get().model.bind(block.py()))
    }

    /// The curve of the first loading, for the method `name`.
    fn curve(slf: &Bound<'_, Self>, name: &str, distance: Option<f64>, points: Whole) -> PyResult<Curve> {
        let model = slf.get().model.bind(slf.py());
        let solver = model.get().solver();
        let distance = distance.unwrap_or_else(|| first_loading_distance(solver.contacts()));
        let asked = scenario::Pull { distance, points: points.get("points")?, ..scenario::Pull::default() };
        asked.check().map_err(|e| error::core(e.under(name)))?;
        let background = Self::background(slf);
        watched(None, slf.py(), |monitor| {
            let curve =
                Curve::new(solver.population(monitor)?.as_ref(), asked.distance, asked.points, monitor)?;
            Ok(curve.with_background(background))
        })
    }
}
