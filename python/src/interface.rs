//! A deformable slider: elastically coupled cells of contacts.

use asperity::scenario::{
    self, CellLoading, CellSlip, Disorder, Elasticity, PerCell, Scales, SlidingDirection,
};
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;

use crate::argument::{Argument, Optional as _, Real, Whole};
use crate::contacts::Contacts;
use crate::convert::{self, Seed};
use crate::deformable::Deformable;
use crate::law::AnyLaw;
use crate::model::steady_interface;
use crate::plain::Surface;
use crate::stretches::StretchGrid;
use crate::watch::watched;
use crate::{error, simulated, typed, values};

/// A deformable slider (Burridge–Knopoff, or on a half-space): elastically coupled cells of contacts, each
/// connected to the drive by a spring. The contacts of a cell move together.
///
/// Parameters
/// ----------
/// contacts
///     The contacts of a cell.
/// cells
///     The length of a chain, such as [1000], or rows and columns, such as [512, 512].
/// initial, start
///     As for MasterEquation; start="steady" holds for time-dependent contacts too, at the velocity of the drive,
///     unless they have a size.
/// connection
///     K_0, the stiffness of the spring between a cell and the drive.
/// neighbours
///     K_int, the stiffness of the spring between two neighbours.
/// half_space
///     The shear modulus of a half-space and the side of a cell, instead of neighbours.
/// poisson_ratio
///     Poisson's ratio ν of the half-space, from -0.9 to 0.48; 0 where its modulus is an effective one.
/// sliding
///     The direction of sliding on a half-space, along which one with ν > 0 is stiffer: along the "columns", from row to
///     row and along a chain, or along the "rows".
/// edges
///     "open" or "periodic".
/// loading
///     "uniform", or "edge" if the drive pulls only the first cell or row.
/// slip
///     The slip rule: "reset" (the default), by which all contacts of an unstable cell break and re-form, or
///     "overdamped"; None for cells with a mass.
/// viscosity
///     The drag on a moving cell, force per velocity; with it events have durations. Time-dependent contacts require
///     it, with slip="overdamped", or a mass: η dX_j/dt = K_0 (X_T - X_j) - (AX)_j - F_j; a cell then slips while it
///     is more than ten times as fast as the drive.
/// mass
///     The mass M of a cell. Cells then follow M d²X_j/dt² + η dX_j/dt = K_0 (X_T - X_j) - (AX)_j - F_j at the
///     velocity of the drive, and disturbances travel as waves. Athermal contacts are loaded and unloaded; a cell over
///     time-dependent contacts that would go back stands.
/// disorder
///     The standard deviation of the scale factors of cells, which multiply all lengths of their contacts and are
///     drawn from a Gaussian distribution of mean 1 with the seed; or a list of the scale factors.
/// seed
///     The seed of these scale factors and of single contacts.
/// areas
///     The area of each cell, row by row, in any unit: only ratios to the mean area count. The numbers of contacts,
///     connection, viscosity and mass are those of a cell of mean area, and proportional to the area; neighbours is
///     not. None for cells of the same area, and on a half-space.
/// drive_tolerance
///     The accuracy of the drive at which equilibrium is lost, in mean thresholds; not used for time-dependent
///     contacts.
/// size
///     None for cells of many contacts, which follow the master equation; or the number of contacts in each cell of
///     mean area, which are drawn with the seed and followed one by one, with slip="overdamped".
/// quenched
///     Whether these keep their thresholds.
///
/// Raises
/// ------
/// ValueError
///     For both or neither of neighbours and half_space, poisson_ratio or sliding beside neighbours; a connection,
///     neighbours, half_space, viscosity, mass or drive_tolerance that is not above 0, and a poisson_ratio that is not
///     from -0.9 to 0.48; a disorder below 0, or another number of scale factors than of cells; another number of
///     areas than of cells, an area that is not above 0 or that is less than 1e-4 of another one, and areas beside
///     half_space; a slip beside a mass,
///     and none of viscosity, with slip="overdamped", and mass for time-dependent contacts; slip="reset" with a size,
///     a size of 0, and quenched without a size; another word as edges, loading, slip, sliding or start; and cells
///     that are not one or two numbers of 1 or more.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
/// >>> chain = asp.Interface(contacts, [16], connection=0.5, neighbours=1.0)
/// >>> len(chain.drive(distance=3.0).events) > 0
/// True
#[pyclass(frozen, extends = Deformable, module = "asperity")]
pub struct Interface;

#[pymethods]
impl Interface {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    #[pyo3(
        signature = (
            contacts, cells, initial = None, *, connection, neighbours = None, half_space = None, poisson_ratio = Real::new(0.0), sliding: "Literal['columns', 'rows']" = Argument::text("columns"), edges: "Literal['open', 'periodic']" = Argument::text("open"),
            loading: "Literal['uniform', 'edge']" = Argument::text("uniform"), slip: "Literal['reset', 'overdamped'] | None" = None, viscosity = None, mass = None, disorder: "_Number | ArrayLike | None" = None, areas: "ArrayLike | None" = None, seed = Seed(1),
            drive_tolerance = Real::new(1e-6), size = None, quenched = Argument::new(false), start: "Literal['conditional', 'relaxed', 'steady']" = Argument::text("conditional")),
        text_signature = "(contacts, cells, initial=None, *, connection, neighbours=None, half_space=None, poisson_ratio=0.0, sliding='columns', edges='open', loading='uniform', slip=None, viscosity=None, mass=None, disorder=None, areas=None, seed=1, drive_tolerance=1e-6, size=None, quenched=False, start='conditional')"
    )]
    fn new(
        contacts: Argument<Bound<'_, Contacts>>,
        cells: Argument<Vec<usize>>,
        initial: Option<Argument<AnyLaw>>,
        connection: Real,
        neighbours: Option<Real>,
        half_space: Option<Argument<(f64, f64)>>,
        poisson_ratio: Real,
        sliding: Argument<String>,
        edges: Argument<String>,
        loading: Argument<String>,
        slip: Option<Argument<String>>,
        viscosity: Option<Real>,
        mass: Option<Real>,
        disorder: Option<&Bound<'_, PyAny>>,
        areas: Option<&Bound<'_, PyAny>>,
        seed: Seed,
        drive_tolerance: Real,
        size: Option<Whole>,
        quenched: Argument<bool>,
        start: Argument<String>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let initial = initial.get("initial")?;
        let contacts = &contacts.get("contacts")?;
        let cells = cells.get("cells")?;
        let neighbours = neighbours.get("neighbours")?;
        let half_space = half_space.get("half_space")?;
        let poisson_ratio = poisson_ratio.get("poisson_ratio")?;
        let sliding = sliding.get("sliding")?;
        let edges = edges.get("edges")?;
        let loading = loading.get("loading")?;
        let slip = slip.get("slip")?;
        let slip = slip.as_deref();
        let viscosity = viscosity.get("viscosity")?;
        let mass = mass.get("mass")?;
        let drive_tolerance = drive_tolerance.get("drive_tolerance")?;
        let quenched = quenched.get("quenched")?;
        let start = start.get("start")?;
        let connection = connection.get("connection")?;
        let sliding = convert::word("sliding", &sliding)?;
        let coupling = match (neighbours, half_space) {
            (Some(stiffness), None) if poisson_ratio == 0.0 && sliding == SlidingDirection::default() => {
                Elasticity::Neighbours { stiffness }
            }
            (Some(_), None) => {
                let expected = "half_space beside poisson_ratio and sliding, which are those of a half-space";
                return Err(error::invalid("neighbours", expected, "neighbours"));
            }
            (None, Some((modulus, cell))) => Elasticity::HalfSpace { modulus, cell, poisson_ratio, sliding },
            (both, _) => {
                let found = if both.is_some() { "both" } else { "neither" };
                return Err(error::invalid("neighbours", "either neighbours or half_space", found));
            }
        };
        let own = scenario::Interface {
            cells,
            contacts: PerCell::Many,
            connection,
            coupling,
            edges: convert::word("edges", &edges)?,
            loading: convert::word("loading", &loading)?,
            slip: slip
                .or(mass.is_none().then_some("reset"))
                .map(|slip| convert::word("slip", slip))
                .transpose()?,
            mass,
            viscosity,
            disorder: disorder.map(|disorder| scales(disorder, seed.0)).transpose()?,
            areas: areas.map(|areas| convert::list("areas", areas)).transpose()?,
            drive_tolerance,
            catalogue_from: 0.0,
            slip_rates: None,
            main_shocks: None,
        };
        let size = size.map(|size| size.get("size")).transpose()?;
        let ensemble = few(size, seed.0, quenched)?;
        let surface = Surface { contacts: steady_interface(contacts, initial, &start)?, own, ensemble };
        Ok(Deformable::made(surface)?.add_subclass(Self))
    }

    /// The shear modulus of a half-space and the side of a cell, or None.
    #[getter]
    fn half_space(slf: &Bound<'_, Self>) -> Option<(f64, f64)> {
        match Deformable::plain(slf.as_super()).own.coupling {
            Elasticity::HalfSpace { modulus, cell, .. } => Some((modulus, cell)),
            _ => None,
        }
    }

    /// Poisson's ratio ν of a half-space; 0 if it has none.
    #[getter]
    fn poisson_ratio(slf: &Bound<'_, Self>) -> f64 {
        match Deformable::plain(slf.as_super()).own.coupling {
            Elasticity::HalfSpace { poisson_ratio, .. } => poisson_ratio,
            _ => 0.0,
        }
    }

    /// The direction of sliding, "columns" or "rows", which counts on a half-space.
    #[getter]
    fn sliding(slf: &Bound<'_, Self>) -> typed::SlidingDirectionWord {
        let own = &Deformable::plain(slf.as_super()).own;
        let rows = matches!(own.coupling, Elasticity::HalfSpace { sliding: SlidingDirection::Rows, .. });
        typed::SlidingDirectionWord(if rows { "rows" } else { "columns" })
    }

    /// The loading, "uniform" or "edge".
    #[getter]
    fn loading(slf: &Bound<'_, Self>) -> typed::LoadingWord {
        let edge = Deformable::plain(slf.as_super()).own.loading == CellLoading::Edge;
        typed::LoadingWord(if edge { "edge" } else { "uniform" })
    }

    /// The slip rule, "reset" or "overdamped"; None for cells with a mass.
    #[getter]
    fn slip(slf: &Bound<'_, Self>) -> Option<typed::CellSlipWord> {
        let own = &Deformable::plain(slf.as_super()).own;
        let word = |slip| if slip == CellSlip::Overdamped { "overdamped" } else { "reset" };
        own.slip.map(|slip| typed::CellSlipWord(word(slip)))
    }

    /// The mass of a cell, or None.
    #[getter]
    fn mass(slf: &Bound<'_, Self>) -> Option<f64> {
        Deformable::plain(slf.as_super()).own.mass
    }

    /// The speed of long waves between neighbours, sqrt(K_int/M), in cells per time; None without a mass and on a
    /// half-space.
    #[getter]
    fn wave_speed(slf: &Bound<'_, Self>) -> Option<f64> {
        Deformable::plain(slf.as_super()).own.wave_speed()
    }

    /// The drag on a moving cell, force per velocity, or None.
    #[getter]
    fn viscosity(slf: &Bound<'_, Self>) -> Option<f64> {
        Deformable::plain(slf.as_super()).own.viscosity
    }

    /// The standard deviation of the scale factors of cells, or these, shape (n,); None if there are none.
    #[getter]
    fn disorder<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<typed::NumberOrArray<'py>>> {
        let Some(scales) = &Deformable::plain(slf.as_super()).own.disorder else { return Ok(None) };
        let found = match (&scales.scale, scales.std) {
            (Some(scale), _) => convert::row(slf.py(), scale.clone())?,
            (None, std) => std.into_bound_py_any(slf.py())?,
        };
        Ok(Some(typed::NumberOrArray(found)))
    }

    /// The areas of the cells as they were given, shape (n,), or None.
    #[getter]
    fn areas<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<typed::Array<'py>>> {
        let areas = Deformable::plain(slf.as_super()).own.areas.clone();
        areas.map(|areas| convert::row(slf.py(), areas).map(typed::Array)).transpose()
    }

    /// The accuracy of the drive at which equilibrium is lost, in mean thresholds.
    #[getter]
    fn drive_tolerance(slf: &Bound<'_, Self>) -> f64 {
        Deformable::plain(slf.as_super()).own.drive_tolerance
    }

    /// The number of contacts in each cell where they are followed one by one, or None.
    #[getter]
    fn size(slf: &Bound<'_, Self>) -> Option<usize> {
        Deformable::plain(slf.as_super()).ensemble.as_ref().and_then(|ensemble| ensemble.size)
    }

    /// Whether these keep their thresholds.
    #[getter]
    fn quenched(slf: &Bound<'_, Self>) -> bool {
        let ensemble = Deformable::plain(slf.as_super()).ensemble.as_ref();
        ensemble.is_some_and(|ensemble| ensemble.disorder == Disorder::Quenched)
    }

    /// The distribution of the stretches of the contacts of a cell, per length, after the interface has been driven
    /// from X_T = 0.
    ///
    /// The result has `stretch` and `density` of shape (n,), and `atoms`, the point masses. Detached contacts are
    /// not counted. Without bins each of the few contacts of a cell with a size is an atom.
    ///
    /// Parameters
    /// ----------
    /// cell
    ///     Its number, counted row by row.
    /// stretches
    ///     A list of n stretches.
    /// at
    ///     The drive, 0 or above.
    /// velocity
    ///     The velocity of the drive, for time-dependent contacts.
    /// edges
    ///     Instead of stretches, edges of n bins, n + 1 increasing numbers; only for time-dependent contacts and for
    ///     cells with a size. The density is then the mean in each bin, and `stretch` its middle.
    /// progress
    ///     As for MasterEquation.pull.
    ///
    /// Returns
    /// -------
    /// StretchDensity
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a cell that does not exist, neither or both of stretches and edges, fewer than two edges or edges that
    ///     do not rise, edges for contacts that follow the master equation without time dependence, a drive at below
    ///     0, and a velocity that is not above 0, or none where time passes.
    #[pyo3(
        signature = (cell, stretches: "ArrayLike | None" = None, *, at, velocity = None, edges: "ArrayLike | None" = None, progress: "_Progress" = None),
        text_signature = "($self, cell, stretches=None, *, at, velocity=None, edges=None, progress=None)"
    )]
    fn stretch_density<'py>(
        slf: &Bound<'py, Self>,
        cell: Whole,
        stretches: Option<&Bound<'py, PyAny>>,
        at: Real,
        velocity: Option<Real>,
        edges: Option<&Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<typed::StretchDensity<'py>> {
        let at = at.get("at")?;
        let velocity = velocity.get("velocity")?;
        let py = slf.py();
        let (cell, grid) = (cell.get("cell")?, StretchGrid::new(stretches, edges)?);
        if matches!(grid, StretchGrid::Default) {
            return Err(error::invalid("stretches", "either stretches or edges", "neither"));
        }
        if !(at.is_finite() && at >= 0.0) {
            return Err(error::invalid("at", "a finite drive, 0 or above", at));
        }
        let surface = Deformable::plain(slf.as_super());
        let (stretches, found) = watched(progress, py, |monitor| {
            let mut simulated = simulated::unrelaxed_interface(surface, velocity, None, monitor)?;
            simulated.advance(at, monitor)?;
            simulated.stretch_density(cell, grid, monitor)
        })?;
        values::stretches(py, stretches, found)
    }
}

/// The ensemble of contacts, if their number is given.
fn few(size: Option<usize>, seed: u64, quenched: bool) -> PyResult<Option<scenario::Ensemble>> {
    if size.is_none() && quenched {
        let expected = "False without a size: contacts that follow the master equation are annealed";
        return Err(error::invalid("quenched", expected, "True"));
    }
    let disorder = if quenched { Disorder::Quenched } else { Disorder::Annealed };
    Ok(size.map(|size| scenario::Ensemble { size: Some(size), seed, disorder }))
}

/// A standard deviation, or the scale factors themselves.
fn scales(disorder: &Bound<'_, PyAny>, seed: u64) -> PyResult<Scales> {
    if let Ok(std) = disorder.extract::<f64>() {
        return Ok(Scales { std: Some(std), seed: Some(seed), ..Scales::default() });
    }
    Ok(Scales { scale: Some(convert::list("disorder", disorder)?), ..Scales::default() })
}
