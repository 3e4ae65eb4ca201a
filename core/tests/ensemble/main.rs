//! Contacts one by one: against theory, in time, and moved together.

#[path = "../common/mod.rs"]
mod common;

mod in_time;
mod population;
mod theory;
mod timed;
