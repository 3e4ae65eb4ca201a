//! The slider block: slips, energies, stability, stick-slip and creep.

#[path = "../common/mod.rs"]
mod common;

mod against_drive;
mod books;
mod creep;
mod input;
mod limits;
mod motion;
mod over_ensemble;
mod over_master;
mod rate_dependent;
mod rate_dependent_books;
mod simulation;
mod slips;
mod slow_slip;
mod stability;
mod stick_slip;
