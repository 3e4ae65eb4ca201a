//! Contacts coupled one by one.

use asperity::scenario::{self, CellLoading, Disorder, Elasticity, PerCell};
use pyo3::prelude::*;

use crate::argument::{Argument, Optional as _, Real};
use crate::contacts::Contacts;
use crate::convert::{self, Seed};
use crate::deformable::Deformable;
use crate::law::AnyLaw;
use crate::model::interface;
use crate::plain::Surface;
use crate::typed;

/// Contacts coupled one by one, which re-form after the slip event: the cellular automaton of Olami, Feder and
/// Christensen, for any distribution of thresholds. Time-dependent contacts, with a temperature, with ageing frozen_rank or
/// logarithmic, or with both, are driven at a velocity, by kinetic Monte Carlo.
///
/// Parameters
/// ----------
/// contacts
///     The distributions of the contacts; their count is the total number that all cells represent.
/// cells
///     The length of a chain, or rows and columns.
/// initial, start
///     As for Ensemble.
/// neighbours
///     The stiffness of the spring between two neighbours.
/// connection
///     The stiffness of the spring to the drive. A neighbour gains the fraction neighbours/(z neighbours +
///     connection) of the force that a breaking contact releases, with z = 4, or 2 on a chain.
/// edges
///     "open" or "periodic".
/// seed, disorder
///     As for Ensemble.
///
/// Raises
/// ------
/// ValueError
///     For cells that are not one or two numbers of 1 or more, neighbours or a connection below 0, a connection of 0
///     where neighbours is 0, another word as edges, disorder or start, a seed that is not below 2^63, a delay, and
///     thresholds that diffuse.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> lattice = asp.Lattice(asp.Contacts(asp.Gaussian(1.0, 0.1)), [16, 16], neighbours=0.2, connection=0.2)
/// >>> len(lattice.drive(distance=3.0).events) > 0
/// True
/// >>> warm = asp.Contacts(asp.Gaussian(1.0, 0.1), temperature=asp.Temperature(0.02, 1.0))
/// >>> lattice = asp.Lattice(warm, [16, 16], neighbours=0.2, connection=0.2)
/// >>> events = lattice.drive(distance=3.0, velocity=0.01).events
/// >>> bool((events["time"] > 0).all())
/// True
#[pyclass(frozen, extends = Deformable, module = "asperity")]
pub struct Lattice;

#[pymethods]
impl Lattice {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    #[pyo3(
        signature = (
            contacts, cells, initial = None, *, neighbours, connection, edges: "Literal['open', 'periodic']" = Argument::text("open"), seed = Seed(1),
            disorder: "Literal['annealed', 'quenched']" = Argument::text("annealed"), start: "Literal['conditional', 'relaxed']" = Argument::text("conditional")),
        text_signature = "(contacts, cells, initial=None, *, neighbours, connection, edges='open', seed=1, disorder='annealed', start='conditional')"
    )]
    fn new(
        contacts: Argument<Bound<'_, Contacts>>,
        cells: Argument<Vec<usize>>,
        initial: Option<Argument<AnyLaw>>,
        neighbours: Real,
        connection: Real,
        edges: Argument<String>,
        seed: Seed,
        disorder: Argument<String>,
        start: Argument<String>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let initial = initial.get("initial")?;
        let contacts = &contacts.get("contacts")?;
        let cells = cells.get("cells")?;
        let neighbours = neighbours.get("neighbours")?;
        let edges = edges.get("edges")?;
        let disorder = disorder.get("disorder")?;
        let start = start.get("start")?;
        let connection = connection.get("connection")?;
        let own = scenario::Interface {
            cells,
            contacts: PerCell::One,
            connection,
            coupling: Elasticity::Neighbours { stiffness: neighbours },
            edges: convert::word("edges", &edges)?,
            loading: CellLoading::Uniform,
            slip: None,
            viscosity: None,
            mass: None,
            disorder: None,
            areas: None,
            drive_tolerance: scenario::Interface::DRIVE_TOLERANCE,
            catalogue_from: 0.0,
            slip_rates: None,
            main_shocks: None,
        };
        let disorder = convert::word("disorder", &disorder)?;
        let ensemble = Some(scenario::Ensemble { size: None, seed: seed.0, disorder });
        let surface = Surface { contacts: interface(contacts, initial, &start)?, own, ensemble };
        Ok(Deformable::made(surface)?.add_subclass(Self))
    }

    /// The kind of disorder, "annealed" or "quenched".
    #[getter]
    fn disorder(slf: &Bound<'_, Self>) -> typed::DisorderWord {
        let ensemble = Deformable::plain(slf.as_super()).ensemble.as_ref();
        typed::DisorderWord(convert::disorder(ensemble.map_or(Disorder::Annealed, |own| own.disorder)))
    }
}
