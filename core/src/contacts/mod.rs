//! What an interface is: how many contacts, how stiff, when they break, how they re-form.

use crate::law::SharedLaw;

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
