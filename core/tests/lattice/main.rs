//! Contacts coupled one by one, and their renormalised thresholds.

#[path = "../common/mod.rs"]
mod common;

mod in_time;
mod main_shocks;
mod pull;
mod renormalised;
mod scan;
