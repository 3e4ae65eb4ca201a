//! Short names for tests of either solver.
#![allow(dead_code)]

pub mod curve;
pub mod finite_volumes;
pub mod patience;
pub mod polyline;
pub mod pulled;
pub mod sliders;
pub mod together;
pub mod walk;
pub mod ways;

use std::sync::Arc;

use asperity::contacts::{Contacts, Initial, Start};
use asperity::law::{
    Exponential, Gamma, Gaussian, Lognormal, Mixture, Point, Rectangular, SharedLaw, Weibull,
};
use asperity::master::MasterEquation;

pub fn gaussian(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gaussian::new(mean, std).unwrap())
}

pub fn rectangular(min: f64, max: f64) -> SharedLaw {
    Arc::new(Rectangular::new(min, max).unwrap())
}

pub fn point(at: f64) -> SharedLaw {
    Arc::new(Point::new(at).unwrap())
}

pub fn exponential(mean: f64) -> SharedLaw {
    Arc::new(Exponential::new(mean).unwrap())
}

pub fn gamma(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Gamma::new(mean, std).unwrap())
}

pub fn weibull(shape: f64, scale: f64) -> SharedLaw {
    Arc::new(Weibull::new(shape, scale).unwrap())
}

pub fn lognormal(mean: f64, std: f64) -> SharedLaw {
    Arc::new(Lognormal::new(mean, std).unwrap())
}

pub fn mixture(parts: &[(f64, SharedLaw)]) -> SharedLaw {
    Arc::new(Mixture::new(parts.to_vec()).unwrap())
}

/// One contact of unit stiffness.
pub fn contacts(thresholds: &SharedLaw, reforming: &SharedLaw) -> Contacts {
    Contacts::new(thresholds.clone(), reforming.clone())
}

pub fn initial(law: &SharedLaw) -> Initial {
    Initial { law: law.clone(), start: Start::Conditional }
}

pub fn equation(
    thresholds: &SharedLaw,
    reforming: &SharedLaw,
    initial: &SharedLaw,
    start: Start,
) -> MasterEquation {
    MasterEquation::new(contacts(thresholds, reforming), &Initial { law: initial.clone(), start }).unwrap()
}

pub fn master(thresholds: &SharedLaw, reforming: &SharedLaw, start: &SharedLaw) -> MasterEquation {
    MasterEquation::new(contacts(thresholds, reforming), &initial(start)).unwrap()
}
