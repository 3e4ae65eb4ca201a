//! Steady sliding for any law: forces and the noise of a finite number of contacts, from moments.

use crate::law::Law;

fn moment(law: &dyn Law, order: u32) -> f64 {
    law.upper_moment(order, -1.0)
}

/// F_k/(N_c⟨k⟩) = (⟨x_s²⟩ − ⟨r²⟩)/[2(⟨x_s⟩ − ⟨r⟩)], R below all thresholds.
#[must_use]
pub fn kinetic_friction(thresholds: &dyn Law, reforming: &dyn Law) -> f64 {
    let rise = |order| moment(thresholds, order) - moment(reforming, order);
    rise(2) / (2.0 * rise(1))
}

/// F_k/(N_c κ) = ⟨x_s³⟩/(2⟨x_s⟩) for stiffnesses k = κx_s, R = δ.
#[must_use]
pub fn kinetic_friction_per_threshold(thresholds: &dyn Law) -> f64 {
    moment(thresholds, 3) / (2.0 * thresholds.mean())
}

/// N Var(F/(N_c⟨k⟩)) = ⟨x_s³⟩/(3⟨x_s⟩) − F_k² in steady sliding, R = δ: the variance of one contact's
/// stretch. Contacts under a rigid drive are independent, so the force of N_c of them scatters by
/// ⟨k⟩√(N_c variance).
#[must_use]
pub fn steady_variance(thresholds: &dyn Law) -> f64 {
    let force = moment(thresholds, 2) / (2.0 * thresholds.mean());
    moment(thresholds, 3) / (3.0 * thresholds.mean()) - force * force
}

/// The same for stiffnesses k = κx_s: N Var(F/(N_c κ)) = ⟨x_s⁵⟩/(3⟨x_s⟩) − F_k², R = δ.
///
/// A contact of threshold ξ is present in proportion to ξ and carries κξx, x uniform on `[0, ξ]`.
#[must_use]
pub fn steady_variance_per_threshold(thresholds: &dyn Law) -> f64 {
    let force = kinetic_friction_per_threshold(thresholds);
    moment(thresholds, 5) / (3.0 * thresholds.mean()) - force * force
}
