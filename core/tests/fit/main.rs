//! Fits to measured curves, and the derivatives of the force that they use.

#[path = "../common/mod.rs"]
mod common;

mod averaged_readings;
mod edges;
mod first_values;
mod free_form;
mod gradient;
mod position_errors;
mod pulls;
mod several_curves;
mod steady;
mod threshold_response;
mod velocity_curve;
