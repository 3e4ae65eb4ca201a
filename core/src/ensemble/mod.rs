//! The earthquake-like model: contacts simulated one by one, each breaking at its own threshold.
//!
//! It shares the description of the contacts with the master equation and nothing else. It is event-driven:
//! contacts go from break to break, so that no step of X limits the accuracy. Contacts are independent and
//! simulated one after another in [`Ensemble::pull`] or, in time, in [`Ensemble::follow`]; together in
//! [`Ensemble::population`] or, in time, in [`Ensemble::in_time`].

mod attached;
mod break_batch;
mod contact;
mod diffusion;
pub mod lattice;
mod lives;
mod passage;
mod population;
mod pull;
mod queue;
mod rate_dependent;
mod snapshots;
mod sums;
mod sweep;
mod tally;
mod timed;

pub use population::EnsemblePopulation;
pub use pull::EnsemblePull;
pub use rate_dependent::EnsembleInTime;
pub use snapshots::Snapshots;
pub use timed::EnsembleTrace;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contacts::{Ageing, Contacts, Initial};
use crate::law::Law;
use crate::{Error, Result};

/// Steps or lives of one contact after which the monitor is asked: a long hold may have millions.
const ASK: u32 = 1 << 14;

/// Mass that no double-precision uniform random number ever hits.
const NEGLIGIBLE: f64 = 1e-15;

/// What happens to a contact's threshold when it re-forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Disorder {
    /// It is drawn anew from P_c: the model of the master equation.
    #[default]
    Annealed,
    /// It is kept for ever.
    Quenched,
}

/// Independent contacts under a rigid slider.
///
/// A contact of stretch x breaks at x ≥ x_s and re-forms at r ~ R with x_s conditional on x_s > r
/// (annealed), or at r ~ R conditional on r < x_s (quenched). Contacts are simulated one after another,
/// each on random streams of its own: results depend on the description and the seed, not on threads.
///
/// ```
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// use asperity::ensemble::{Disorder, Ensemble};
/// use asperity::master::MasterEquation;
///
/// let ensemble = Ensemble::new(contacts.clone(), Initial::default(), 1000, 1, Disorder::Annealed)?;
/// let sample = ensemble.pull(&[2.0])?;
/// let expected = MasterEquation::new(contacts, &Initial::default())?.pull(2.0)?.force(2.0);
/// assert!((sample.force[0] - expected).abs() < 4.0 * sample.error[0]);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Ensemble {
    contacts: Contacts,
    initial: Initial,
    size: usize,
    seed: u64,
    disorder: Disorder,
    /// The number of its first contact, which selects the random streams.
    first: u64,
}

impl Ensemble {
    /// An ensemble of `size` contacts drawn at random, which represent the `contacts.count` real ones.
    ///
    /// # Errors
    /// No contacts; R (or Q_ini for a conditional start) with mass where no contact survives; quenched
    /// thresholds for which a contact cannot re-form; ageing by mean field.
    pub fn new(
        contacts: Contacts,
        initial: Initial,
        size: usize,
        seed: u64,
        disorder: Disorder,
    ) -> Result<Self> {
        has_contacts(size)?;
        contacts.check(&initial)?;
        if let Some(Ageing::MeanField { .. }) = contacts.rules.ageing {
            let expected =
                "ageing by a rule for single contacts; the closure is one for all of them, in steady sliding";
            return Err(Error::invalid("ageing.mean_field", expected, "a closure"));
        }
        if disorder == Disorder::Quenched {
            reforms(contacts.reforming.as_ref(), contacts.thresholds.as_ref())?;
        }
        Ok(Self { contacts, initial, size, seed, disorder, first: 0 })
    }

    /// The same with contacts numbered from `first` on, instead of 0: independent of those with lower
    /// numbers.
    #[must_use]
    pub fn numbered_from(self, first: u64) -> Self {
        Self { first, ..self }
    }

    /// The same with another number of contacts, which represent the same real ones.
    ///
    /// # Errors
    /// No contacts.
    pub fn of_size(self, size: usize) -> Result<Self> {
        has_contacts(size)?;
        Ok(Self { size, ..self })
    }

    /// Number of contacts drawn.
    pub fn size(&self) -> usize {
        self.size
    }

    /// The contacts, as described.
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    /// How they start.
    pub fn initial(&self) -> &Initial {
        &self.initial
    }
}

/// Refuses an ensemble without contacts.
fn has_contacts(size: usize) -> Result<()> {
    if size > 0 { Ok(()) } else { Err(Error::invalid("size", "at least one contact", size)) }
}

/// Whether a contact of any threshold can re-form below it.
fn reforms(stretches: &dyn Law, thresholds: &dyn Law) -> Result<()> {
    let lowest = stretches.quantile(0.0);
    let below = 1.0 - thresholds.survival(lowest);
    if below > NEGLIGIBLE {
        let expected = format!("quenched thresholds above the lowest re-formed stretch {lowest}");
        return Err(Error::invalid("thresholds", expected, format!("{below:e} of them not above it")));
    }
    Ok(())
}
