//! Distributions of thresholds, random streams, and the lives of contacts.

#[path = "../common/mod.rs"]
mod common;

mod additive_hazard;
mod breaking_stretches;
mod diffusion;
mod free_junctions;
mod frozen_rank;
mod law_family;
mod law_tails;
mod life_diffusing;
mod life_limits;
mod life_one_by_one;
mod life_references;
mod life_thermal;
mod properties;
mod random;
mod stiffness_table;
mod unusual_numbers;
