//! The master equation: pulls, covariances, the noise of steady sliding, and the mean field.

#[path = "../common/mod.rs"]
mod common;

mod books;
mod broad_stretches;
mod closed_forms;
mod covariance;
mod delay;
mod inversion;
mod jumps;
mod long_sliding;
mod mean_field;
mod mean_field_motion;
mod narrow;
mod noise;
mod onsets;
mod poles;
mod population;
mod population_one_by_one;
mod references;
mod relaxation;
mod romberg;
mod series;
mod slow;
mod solvers_agree;
mod stepping;
