//! Interfaces: elastic coupling, slips, waves, and contacts in time.

#[path = "../common/mod.rs"]
mod common;

mod areas;
mod block;
mod books;
mod coupling;
mod fronts;
mod populations;
mod protocol;
mod rate_dependent;
mod state_in_time;
mod stiff;
mod stretches;
mod waves;
