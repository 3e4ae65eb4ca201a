//! Ageing: thresholds that change with the time for which a contact has held.
//!
//! The rule, as a scenario gives it, is [`Ageing`] (`rule`). Its evolution in time, the threshold of a contact from its first one
//! and its age, is [`ThresholdEvolution`] (`threshold_evolution`), which contacts that keep their rank in the distribution take
//! from a table (`ranks`). The operator that moves the distribution of thresholds is [`ThresholdFokkerPlanck`] (`fokker_planck`);
//! [`Closure`] (`closure`) is its solution in steady sliding where ages are distributed exponentially; where sliding is not
//! steady, the thresholds of contacts of every age are in a table (`maturing_table`).

mod closure;
mod fokker_planck;
mod maturing_table;
mod ranks;
mod rule;
mod shared_ranks;
mod threshold_evolution;

pub use closure::Closure;
pub(crate) use closure::{mean_advance, self_consistent_advance, starts};
pub use fokker_planck::ThresholdFokkerPlanck;
pub(crate) use maturing_table::{AgeWeights, MaturingTable, ThresholdDensity};
pub use rule::{Ageing, AgeingRule};
pub use shared_ranks::SharedRanks;
pub(crate) use threshold_evolution::{Label, NodalLabels, Rank, ThresholdTrajectory};
pub use threshold_evolution::{ThresholdEvolution, ThresholdsAtAge};

use super::Contacts;
