//! Contacts in time: transport, steady starts, a background force, and machine springs.

#[path = "../common/mod.rs"]
mod common;

mod background;
mod background_tasks;
mod error_in_time;
mod load_steps;
mod load_tasks;
mod machine_healing;
mod machine_spring;
mod machine_step;
mod measured_rate_state;
mod starts;
mod steady_start;
mod transport;
mod transport_cold;
mod transport_ensemble;
