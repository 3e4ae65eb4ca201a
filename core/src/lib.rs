//! Friction at the mesoscale: many elastic contacts that stretch, break and re-form.
//!
//! The description of the [`contacts`] (thresholds, stiffness, re-forming) is converted to one object, the [`life`] of a
//! contact, from which all properties of friction are computed. Two independent solvers compute them: the [`master`]
//! equation for the distribution of stretches, and the [`ensemble`], which simulates contacts one by one.

#![deny(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro)]
#![deny(missing_debug_implementations)]

pub mod block;
mod cbor;
pub mod contacts;
mod dynamics;
pub mod elastic;
pub mod energy;
pub mod ensemble;
mod error;
pub mod exact;
pub mod first_breaks;
pub mod fit;
pub mod history;
pub mod law;
pub mod life;
pub mod master;
pub mod monitor;
pub mod numerics;
mod parallel;
pub mod population;
pub mod random;
pub mod rate_dependent;
pub mod rate_state;
pub mod record;
pub mod scenario;
pub mod shape;
pub mod task;

pub use error::{Error, Float, Result};

/// What the documents show of this crate is run with its own examples.
#[cfg(doctest)]
mod documents {
    #[doc = include_str!("../../README.md")]
    struct Readme;
    #[doc = include_str!("../../CONTRIBUTING.md")]
    struct Contributing;
    #[doc = include_str!("../../docs/theory.md")]
    struct Theory;
    #[doc = include_str!("../../docs/laws.md")]
    struct Laws;
}
