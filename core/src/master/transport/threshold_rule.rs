//! The rule by which thresholds change, and the model of cohorts that follows from it.

use std::sync::Arc;

use super::diffusing::Diffusing;
use super::model::CohortModel;
use super::ranked::RankedThresholds;
use super::seeds::Seed;
use super::{mean_field, step_control};
use crate::Result;
use crate::contacts::{Ageing, Contacts, MaturingTable, ThresholdEvolution};
use crate::monitor::{Monitor, report};

/// How thresholds change, known before the tolerance is: computed once for both solutions.
#[derive(Debug, Clone)]
pub(super) enum ThresholdRule {
    /// As a function of age.
    OfAge(ThresholdEvolution),
    /// They diffuse.
    Diffusing,
    /// All contacts share one distribution.
    Shared(Arc<MaturingTable>),
}

impl ThresholdRule {
    /// How the thresholds of these contacts change.
    ///
    /// # Errors
    /// Those of the table of `mean_field`; stopped by the monitor.
    pub(super) fn of(contacts: &Contacts, monitor: &mut dyn Monitor) -> Result<Self> {
        match &contacts.rules.ageing {
            Some(Ageing::MeanField { .. }) => mean_field::table(contacts, monitor).map(Self::Shared),
            Some(Ageing::Smoluchowski { .. }) => Ok(Self::Diffusing),
            _ => ThresholdEvolution::of_with(contacts, monitor).map(Self::OfAge),
        }
    }

    /// The model of cohorts of these contacts, which re-form at the seeds.
    ///
    /// # Errors
    /// Those of [`Diffusing::new`]; stopped by the monitor.
    pub(super) fn model(
        self,
        contacts: &Contacts,
        seeds: &[Seed],
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<CohortModel> {
        report(monitor, 0.0)?;
        match self {
            Self::OfAge(strength) => {
                Ok(CohortModel::Ranked(Box::new(RankedThresholds::new(contacts, strength, tolerance))))
            }
            Self::Shared(table) => Ok(CohortModel::Shared(table)),
            Self::Diffusing => {
                let scale = step_control::scale(contacts);
                let diffusing = Diffusing::new(contacts, seeds, scale, tolerance, monitor)?;
                Ok(CohortModel::Diffusing(Box::new(
                    diffusing.expect("thresholds that diffuse have a mature law"),
                )))
            }
        }
    }
}
