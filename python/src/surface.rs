//! The description of a deformable interface, and the arguments that create it.

use asperity::scenario::{
    self, CellLoading, CellSlip, Disorder, Drive, Edges, Elasticity, Renormalisation, Scenario,
    SlidingDirection,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::law::given;
use crate::model::interface_arguments;
use crate::{convert, description};

/// A deformable interface, and the initial state of its contacts.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Surface {
    pub contacts: description::Interface,
    pub own: scenario::Interface,
    pub ensemble: Option<scenario::Ensemble>,
}

impl Surface {
    /// The scenario of a drive.
    pub fn scenario(&self, drive: Drive) -> Scenario {
        let description::Interface { contacts, initial, start } = self.contacts.clone();
        Scenario {
            initial,
            drive: Some(Drive { start, ..drive }),
            interface: Some(self.own.clone()),
            ensemble: self.ensemble.clone(),
            ..Scenario::new(contacts)
        }
    }

    /// The scenario of first breaks.
    pub fn first_breaks(&self, asked: Renormalisation) -> Scenario {
        let description::Interface { contacts, initial, .. } = self.contacts.clone();
        Scenario {
            initial,
            renormalisation: Some(asked),
            interface: Some(self.own.clone()),
            ensemble: self.ensemble.clone(),
            ..Scenario::new(contacts)
        }
    }
}

/// The arguments that create an interface.
pub fn arguments(surface: &Surface, into: &Bound<'_, PyDict>) -> PyResult<()> {
    let Surface { contacts, own, ensemble } = surface;
    interface_arguments(contacts, into)?;
    into.set_item("cells", own.cells.clone())?;
    into.set_item("connection", own.connection)?;
    match own.coupling {
        Elasticity::Neighbours { stiffness } => into.set_item("neighbours", stiffness)?,
        Elasticity::HalfSpace { modulus, cell, poisson_ratio, sliding } => {
            into.set_item("half_space", (modulus, cell))?;
            given(into, "poisson_ratio", (poisson_ratio != 0.0).then_some(poisson_ratio))?;
            given(into, "sliding", (sliding == SlidingDirection::Rows).then_some("rows"))?;
        }
        _ => unreachable!("a coupling that no argument makes"),
    }
    given(into, "edges", (own.edges == Edges::Periodic).then_some("periodic"))?;
    given(into, "loading", (own.loading == CellLoading::Edge).then_some("edge"))?;
    given(into, "slip", (own.slip == Some(CellSlip::Overdamped)).then_some("overdamped"))?;
    given(into, "viscosity", own.viscosity)?;
    given(into, "mass", own.mass)?;
    let tolerance = own.drive_tolerance;
    given(into, "drive_tolerance", (tolerance != scenario::Interface::DRIVE_TOLERANCE).then_some(tolerance))?;
    if let Some(scales) = &own.disorder {
        given(into, "disorder", scales.std)?;
        given(into, "disorder", scales.scale.clone())?;
        given(into, "seed", scales.seed.filter(|&seed| seed != 1))?;
    }
    let Some(ensemble) = ensemble else { return Ok(()) };
    given(into, "seed", Some(ensemble.seed).filter(|&seed| seed != 1))?;
    let quenched = ensemble.disorder == Disorder::Quenched;
    if ensemble.size.is_some() {
        given(into, "size", ensemble.size)?;
        return given(into, "quenched", quenched.then_some(true));
    }
    given(into, "disorder", quenched.then(|| convert::disorder(ensemble.disorder)))
}
