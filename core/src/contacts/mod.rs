//! What an interface is: how many contacts, how stiff, when they break, how they re-form.

use crate::law::{Law, SharedLaw, Zone};
use crate::{Error, Result};

/// How stiff a contact is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stiffness {
    /// The same mean stiffness ⟨k⟩ whatever the threshold, force per length.
    Equal(f64),
    /// k = κ x_s: the factor κ, force per length squared.
    PerThreshold(f64),
}

/// The contacts of an interface.
#[derive(Debug, Clone)]
pub struct Contacts {
    /// Number of contacts N_c.
    pub count: f64,
    /// Stiffness of a contact.
    pub stiffness: Stiffness,
    /// Law of thresholds P_c.
    pub thresholds: SharedLaw,
    /// Law R of the stretches at which contacts re-form.
    pub reforming: SharedLaw,
}

/// How the law of initial stretches is read (physics: the threshold of a contact found at stretch x).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Start {
    /// Thresholds conditional on x_s > x: nothing breaks at X = 0.
    #[default]
    Conditional,
    /// Stretches and thresholds independent: what is above its threshold breaks at once and re-forms.
    Relaxed,
}

/// The contacts at X = 0.
#[derive(Debug, Clone)]
pub struct Initial {
    /// Law Q_ini of stretches.
    pub law: SharedLaw,
    /// How it is read.
    pub start: Start,
}

/// A share of contacts that no result shows.
const NEGLIGIBLE: f64 = 1e-12;

/// The smallest survival at which contacts may be placed: their thresholds are those of so few in all.
const HELD: f64 = 1e-9;

/// The narrowest law, relative to where it stands: below that, stretches differ by rounding.
const NARROWEST: f64 = 5e-5;

impl Contacts {
    /// Checks that contacts survive where they start and where they re-form: that S > 0 there (S ≥ 1e-9, to be
    /// computable), and that no law is too narrow to be told from a point mass.
    ///
    /// # Errors
    /// Thresholds at 0; stretches at or above every threshold; narrow laws. Keys are those of a scenario.
    pub fn check(&self, initial: &Initial) -> Result<()> {
        let at_once = 1.0 - self.thresholds.survival(0.0);
        if at_once > NEGLIGIBLE {
            let found = format!("a share {at_once} of the contacts with threshold 0");
            return Err(Error::invalid("contacts.thresholds", "thresholds above 0", found));
        }
        resolved("contacts.thresholds", self.thresholds.as_ref())?;
        resolved("contacts.reforming", self.reforming.as_ref())?;
        resolved("initial", initial.law.as_ref())?;
        self.survives("contacts.reforming", self.reforming.as_ref())?;
        match initial.start {
            Start::Conditional => self.survives("initial", initial.law.as_ref()),
            Start::Relaxed => Ok(()),
        }
    }

    /// The stretch above which no contact is placed: S ≥ 1e-9 below it.
    pub(crate) fn highest_start(&self) -> f64 {
        self.thresholds.upper_quantile(HELD)
    }

    fn survives(&self, key: &str, stretches: &dyn Law) -> Result<()> {
        let top = self.highest_start();
        let share = stretches.survival(top.next_down());
        if share <= NEGLIGIBLE {
            return Ok(());
        }
        let highest = self.thresholds.quantile(1.0);
        let expected = if highest.is_finite() {
            format!("stretches below the highest threshold {highest}, where contacts still hold")
        } else {
            format!("stretches below {top:.6}, where one contact in {:e} still holds", 1.0 / HELD)
        };
        Err(Error::invalid(key, expected, format!("a share {share} of the contacts at or above it")))
    }
}

fn resolved(key: &str, law: &dyn Law) -> Result<()> {
    let width = |zone: &Zone| zone.resolution.min(zone.high - zone.low);
    let narrow = law.zones().into_iter().find(|zone| width(zone) < NARROWEST * zone.high);
    narrow.map_or(Ok(()), |zone| {
        let expected = format!("a law wider than {NARROWEST:e} of its stretches (or a point)");
        Err(Error::invalid(key, expected, format!("a width of {:e} near {}", width(&zone), zone.high)))
    })
}
