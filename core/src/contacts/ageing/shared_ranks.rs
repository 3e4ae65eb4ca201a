//! The table of thresholds by rank and age, computed once for all copies of the same contacts.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::ranks::RankTable;
use crate::Result;
use crate::law::SharedLaw;

/// The table of thresholds of contacts that age by `frozen_rank`, kept for all solvers, and for copies of the contacts: it takes
/// seconds to compute, and depends neither on the velocity nor on a tolerance. It is empty until it is needed, and replaced
/// where the distributions or the time of the rule are others.
#[derive(Debug, Clone, Default)]
pub struct SharedRanks(Arc<Mutex<Option<KnownRanks>>>);

/// A table, and what it is of.
#[derive(Debug)]
struct KnownRanks {
    fresh: SharedLaw,
    mature: SharedLaw,
    time: f64,
    table: Arc<RankTable>,
}

impl KnownRanks {
    /// Whether it is of the same objects, which it keeps, so that no other has their address.
    fn is_of(&self, fresh: &SharedLaw, mature: &SharedLaw, time: f64) -> bool {
        let same =
            |one: &SharedLaw, other: &SharedLaw| std::ptr::addr_eq(Arc::as_ptr(one), Arc::as_ptr(other));
        same(&self.fresh, fresh) && same(&self.mature, mature) && self.time == time
    }
}

impl SharedRanks {
    /// The table for fresh and mature thresholds and a time, which `compute` makes if it is not known.
    pub(super) fn table(
        &self,
        [fresh, mature]: [&SharedLaw; 2],
        time: f64,
        compute: impl FnOnce() -> Result<RankTable>,
    ) -> Result<Arc<RankTable>> {
        if let Some(known) = self.known().as_ref().filter(|known| known.is_of(fresh, mature, time)) {
            return Ok(known.table.clone());
        }
        // Nothing waits meanwhile: a thread that did could hold what the computation needs.
        let table = Arc::new(compute()?);
        let (fresh, mature) = (fresh.clone(), mature.clone());
        *self.known() = Some(KnownRanks { fresh, mature, time, table: table.clone() });
        Ok(table)
    }

    /// A table is put in place whole, so that a panic elsewhere leaves it intact.
    fn known(&self) -> MutexGuard<'_, Option<KnownRanks>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
