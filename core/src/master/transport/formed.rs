//! Contacts that form in a step, at any time inside it.
//!
//! They form at the rate b(s), linear in the fraction s of the step. After a further fraction a of it, of a
//! contact the stiffness τ(a) is left, and the force ρ(a) + X'a τ(a), ρ the stiffness times the stretch at
//! formation and X' the way of the step; τ and ρ are parabolas through formation and the ages that the
//! cohorts formed in the step have at its end. The fraction αa + βa² has broken.

use super::broken::{BrokenFraction, EarlyBreaks};
use super::cohort::CohortForce;
use super::path::{GAUSS, Path};

/// Contacts that form in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct FormedInStep {
    /// Masses at the two Gauss nodes.
    pub(super) masses: [f64; 2],
    /// Their breaks.
    pub(super) deaths: EarlyBreaks,
    /// Force of a contact as a polynomial in a.
    force: [f64; 4],
}

/// Coefficients of the parabola through values at 0 and at the Gauss nodes.
fn parabola([zero, first, second]: [f64; 3]) -> [f64; 3] {
    let slopes = [(first - zero) / GAUSS[0], (second - zero) / GAUSS[1]];
    let curvature = (slopes[1] - slopes[0]) / (GAUSS[1] - GAUSS[0]);
    [zero, slopes[0] - curvature * GAUSS[0], curvature]
}

impl FormedInStep {
    /// From the forces of cohorts of mass 1 at formation and at the end of the step, of the early and of the
    /// late ones.
    pub(super) fn new(
        path: &Path,
        masses: [f64; 2],
        deaths: EarlyBreaks,
        formed: [CohortForce; 2],
        ends: [CohortForce; 2],
    ) -> Self {
        let mean = |of: fn(&CohortForce) -> f64| 0.5 * (of(&formed[0]) + of(&formed[1]));
        let [early, late] = ends;
        let stiffness = [mean(|one| one.stiffness), late.stiffness, early.stiffness];
        let first = |end: CohortForce, age: f64| end.force - age * path.by * end.stiffness;
        let fixed = [mean(|one| one.force), first(late, GAUSS[0]), first(early, GAUSS[1])];
        let (stiffness, fixed) = (parabola(stiffness).map(|c| c * path.by), parabola(fixed));
        let force = [fixed[0], fixed[1] + stiffness[0], fixed[2] + stiffness[1], stiffness[2]];
        Self { masses, deaths, force }
    }

    /// The fraction of all contacts that forms in the step.
    pub(super) fn mass(&self) -> f64 {
        self.masses[0] + self.masses[1]
    }

    /// The fraction of all contacts that has formed by the middle and by the end of the step.
    pub(super) fn fraction(&self) -> BrokenFraction {
        BrokenFraction { middle: self.moment(0.5, 0), end: self.mass() }
    }

    /// The mean over the step of those that have broken in it, `broken`, less those that have formed.
    pub(super) fn mean_free(&self, broken: BrokenFraction) -> f64 {
        (4.0 * broken.middle + broken.end) / 6.0 - self.moment(1.0, 1)
    }

    /// ∫₀^s b(s') (s − s')ⁿ ds'.
    fn moment(&self, s: f64, n: u8) -> f64 {
        // b = c + d(s' − ½), with the masses as its integrals at the nodes of the rule.
        let tilt = 2.0 * (self.masses[1] - self.masses[0]) / (GAUSS[1] - GAUSS[0]);
        let (now, n) = (self.mass() + tilt * (s - 0.5), f64::from(n));
        (now / (n + 1.0) - tilt * s / (n + 2.0)) * s.powf(n + 1.0)
    }

    /// The fraction of all contacts that forms in the step and breaks up to s.
    pub(super) fn broken(&self, s: f64) -> f64 {
        let (alpha, beta) = self.deaths.curve();
        alpha * self.moment(s, 1) + beta * self.moment(s, 2)
    }

    /// Their force at s, in units of the total stiffness, if the fraction `born` has formed by then.
    pub(super) fn force(&self, s: f64, born: f64) -> f64 {
        let sum: f64 = (0..).zip(self.force).map(|(n, factor)| factor * self.moment(s, n)).sum();
        // The exact number formed is better than the integral of the linear rate.
        sum + self.force[0] * (born - self.moment(s, 0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contacts that form at the stretch r and break at rates that parabolas in the age describe.
    fn formed(path: &Path) -> (FormedInStep, impl Fn(f64) -> f64) {
        let (r, left) = (0.3, |a: f64| 1.0 - 0.1 * a - 0.05 * a * a);
        let at = move |a: f64| CohortForce { stiffness: left(a), force: left(a) * (r + 0.2 * a) };
        let deaths = EarlyBreaks { early: 1.0 - left(GAUSS[1]), late: 1.0 - left(GAUSS[0]) };
        let ends = [at(GAUSS[1]), at(GAUSS[0])];
        (FormedInStep::new(path, [0.01, 0.02], deaths, [at(0.0); 2], ends), move |a| at(a).force)
    }

    #[test]
    fn forces_and_breaks_inside_a_step_are_integrals_over_formation() {
        let path = Path { duration: 2.0, by: 0.2 };
        let (formed, force) = formed(&path);
        // The linear rate whose halves of the two-point rule are the masses.
        let rate = |s: f64| 2.0 * (0.01 + (s - GAUSS[0]) / (GAUSS[1] - GAUSS[0]) * 0.01);
        for s in [0.0, 0.1, 0.5, 0.77, 1.0] {
            // Exact for polynomials.
            let over = |f: &dyn Fn(f64) -> f64| {
                crate::numerics::legendre::RULE.integrate(0.0, s, |at| rate(at) * f(s - at))
            };
            let born = over(&|_| 1.0);
            // Rounding.
            assert!((formed.force(s, born) - over(&force)).abs() < 1e-15, "{s}");
            assert!((formed.broken(s) - over(&|a| 0.1 * a + 0.05 * a * a)).abs() < 1e-15, "{s}");
        }
        let ends = 0.01 * force(GAUSS[1]) + 0.02 * force(GAUSS[0]);
        // The two-point rule misses 24/4320 of the quartic term of rate × force, 3.5e-4.
        assert!((formed.force(1.0, formed.mass()) - ends).abs() < 3e-6);
    }
}
