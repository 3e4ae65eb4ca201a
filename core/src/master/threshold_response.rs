//! The response of the force on a pull to the probability of single thresholds.

use std::sync::Arc;

use super::force_after_break::force_kernel;
use super::pull::{Pull, at};
use super::renewal::RenewalSolution;
use crate::contacts::Start;
use crate::law::SharedLaw;
use crate::life::{Layer, Life, LifeDerivative, StartingContacts};
use crate::monitor::{Monitor, Part, Watch};
use crate::numerics::breakpoints::Atom;
use crate::numerics::legendre::NODES;
use crate::numerics::piecewise::Piecewise;
use crate::{Error, Result};

/// The response δF(X)/δP_c(ξ) of the force on a pull to the probability of some thresholds ξ.
#[derive(Debug, Clone)]
pub struct ThresholdResponse {
    thresholds: Vec<OneThreshold>,
    /// The contacts at X = 0, and those that form later.
    starting: [Generation; 2],
    /// What contacts lose that keep their distribution of thresholds.
    others: Vec<Piecewise>,
    /// F_R: the force of contacts that have all just re-formed, per unit stiffness.
    reformed: Piecewise,
    distance: f64,
    stiffness: f64,
}

/// What is known of a threshold ξ before a position is.
#[derive(Debug, Clone)]
struct OneThreshold {
    threshold: f64,
    /// ∫ν and ∫rν over r < ξ, of the contacts at X = 0 and of those that form later.
    moments: [[f64; 2]; 2],
    /// The fraction of the contacts at X = 0 that break at once with this threshold, if it does not depend on the stretch.
    at_once: f64,
    /// Its curve in `others`.
    others: usize,
}

/// Contacts by where they start, and functions of X that show when, on the same cells.
#[derive(Debug, Clone)]
struct Generation {
    starts: Layer,
    /// The number of contacts formed up to X.
    number: Piecewise,
    /// The sum of their advances, the integral of `number`.
    advances: Piecewise,
    /// The force that they would carry if each had broken at once, and re-formed.
    broken: Piecewise,
}

impl ThresholdResponse {
    /// The thresholds ξ.
    pub fn thresholds(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.thresholds.iter().map(|one| one.threshold)
    }

    /// δF/δP_c at the position X, for the threshold of this index: a force per unit of probability. At the position at
    /// which contacts with this threshold break together, they have broken.
    ///
    /// # Panics
    /// An index that is not below the number of thresholds.
    pub fn at(&self, index: usize, position: f64) -> f64 {
        let one = &self.thresholds[index];
        let own = self.starting.iter().zip(one.moments);
        let own: f64 = own.map(|(starting, moments)| starting.force(one.threshold, moments, position)).sum();
        let at_once = one.at_once * at(&self.reformed, position);
        self.stiffness * (own + at_once - at(&self.others[one.others], position))
    }

    /// The response at several positions: one row for each threshold.
    ///
    /// # Errors
    /// Positions outside of the pull; stopped by the monitor.
    pub fn rows_with(&self, positions: &[f64], monitor: &mut dyn Monitor) -> Result<Vec<Vec<f64>>> {
        self.inside(positions)?;
        let row = |_: &mut (), index: usize| positions.iter().map(|&x| self.at(index, x)).collect();
        Watch::new(monitor).share(self.thresholds.len(), || (), row)
    }

    /// The derivatives of L = Σ w_i F(X_i) by the probability of each threshold, Σ w_i δF(X_i)/δP_c(ξ), for weights w_i and
    /// positions X_i. They may also be the derivatives ∂L/∂F(X_i) of a function of the forces.
    ///
    /// This is the adjoint of the response. With λ(Y) = Σ w_i \[δ(Y − X_i) + Γ(X_i − Y)\], the solution of the renewal
    /// equation read backwards, it is ∫λ(u) K_ξ(u) du for contacts that start as they re-form. Γ is known, so that neither
    /// λ nor the response to a threshold needs a solution of its own.
    ///
    /// # Errors
    /// Not as many weights as positions; positions outside of the pull.
    pub fn adjoint(&self, positions: &[f64], weights: &[f64]) -> Result<Vec<f64>> {
        self.adjoint_with(positions, weights, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::adjoint`]; stopped by the monitor.
    pub fn adjoint_with(
        &self,
        positions: &[f64],
        weights: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<f64>> {
        if weights.len() != positions.len() {
            let expected = format!("as many as positions, {}", positions.len());
            return Err(Error::invalid("weights", expected, weights.len()));
        }
        self.inside(positions)?;
        let sum = |_: &mut (), index: usize| -> f64 {
            positions.iter().zip(weights).map(|(&x, weight)| weight * self.at(index, x)).sum()
        };
        Watch::new(monitor).share(self.thresholds.len(), || (), sum)
    }

    fn inside(&self, positions: &[f64]) -> Result<()> {
        let outside = |x: &&f64| !(0.0..=self.distance * (1.0 + 1e-12)).contains(*x);
        match positions.iter().find(outside) {
            Some(x) => Err(Error::invalid("positions", format!("positions from 0 to {}", self.distance), x)),
            None => Ok(()),
        }
    }
}

impl Generation {
    /// The force at X of contacts that all have the threshold ξ if they start below it, each counted 1/S(r) times.
    ///
    /// A contact that formed at Y with the stretch r carries r + X − Y until X − Y = ξ − r, and F_R(X − Y − ξ + r) after it
    /// broke. With n contacts formed up to X, a = ∫n and B the sum of their F_R(X − Y), the sum over all is
    ///
    /// r n(X) + a(X) − \[ξ n(z) + a(z) − B(z)\], z = X − ξ + r, with the bracket for z ≥ 0 only.
    fn force(&self, threshold: f64, [count, stretch]: [f64; 2], position: f64) -> f64 {
        let rounding = 1e-13 * position.max(threshold);
        let since = position - threshold;
        let lost = |r: f64| {
            let z = since + r;
            if z < -rounding {
                return 0.0;
            }
            let cell = self.number.nearest(z);
            let [number, advances, broken] =
                [&self.number, &self.advances, &self.broken].map(|curve| curve.value_in(cell, z));
            threshold * number + advances - broken
        };
        let ends = &self.number.boundaries;
        let first = ends.partition_point(|end| *end <= since.max(0.0)).saturating_sub(1);
        let cuts = ends[first..].iter().map(|end| end - since).take_while(|r| *r < threshold);
        let cuts: Vec<f64> = cuts.collect();
        let held = stretch * at(&self.number, position) + count * at(&self.advances, position);
        held - self.starts.sum_within(threshold, lost, &cuts)
    }
}

impl Pull {
    /// The response δF(X)/δP_c(ξ) of the force to the probability of each of these thresholds ξ: the derivative of F with
    /// thresholds drawn from (1 − ε)P_c + ε δ(x_s − ξ) by ε at ε = 0.
    ///
    /// For a change δP_c of the distribution that keeps its total of 1, δF(X) = ∫ δF(X)/δP_c(ξ) δP_c(ξ) dξ. Any constant may
    /// be added to the response then; this one has the mean 0, ∫ P_c(ξ) δF(X)/δP_c(ξ) dξ = 0, and stays finite for large X.
    ///
    /// A contact that starts at r < ξ draws the threshold ξ with a probability that changes by 1/S(r) times that of a contact
    /// at 0. It then carries g_r(u) = r + u until u = ξ − r, and F_R(u − ξ + r) after it broke, instead of F_r(u). Per unit
    /// stiffness, with F_r the force of contacts that start at r, F_R = ∫R F_r dr and ν = R/S,
    ///
    /// δF/δP_c(ξ) = K_i + Γ∗K, K(u) = ∫_{r<ξ} ν(r) \[g_r(u) − F_r(u)\] dr,
    ///
    /// and K_i is the same for the contacts at X = 0. Where thresholds at X = 0 do not depend on the stretch, K_i = ∫ Q_ini g_r
    /// dr − F, with g_r = F_R for r ≥ ξ. For R = Q_ini = δ it is (δ + Γ)∗(h_ξ − F) with h_ξ(u) = u up to ξ and F(u − ξ) above:
    /// the response without normalisation is (δ + Γ)∗h_ξ.
    ///
    /// The parts with g_r are sums of Γ, its integrals and Γ∗F_R at X − ξ + r; only those with F_r need a solution, and the
    /// same one for all ξ above all starting stretches. Where ξ is in their range and P_c has edges or point masses
    /// there, the response is less accurate.
    ///
    /// # Errors
    /// Time-dependent contacts; those with k = κ x_s; a threshold that is not a finite length, 0 or above.
    pub fn threshold_response(&self, thresholds: &[f64]) -> Result<ThresholdResponse> {
        self.threshold_response_with(thresholds, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::threshold_response`]; stopped by the monitor.
    pub fn threshold_response_with(
        &self,
        thresholds: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<ThresholdResponse> {
        self.has_threshold_response()?;
        if let Some(threshold) = thresholds.iter().find(|xi| !(xi.is_finite() && **xi >= 0.0)) {
            return Err(Error::invalid("thresholds", "finite lengths, 0 or above", threshold));
        }
        let (equation, solution) = (&self.equation, &self.renewal.solution);
        let conditional = equation.initial.start == Start::Conditional;
        let reformed = self.after_re_forming(&mut Part::new(monitor, 0.0, 0.3))?;
        let part = &mut Part::new(monitor, 0.3, 0.1);
        let later = Generation {
            starts: Layer::starting(&equation.contacts, &equation.contacts.reforming, true)?,
            number: number(&solution.density, &solution.atoms),
            advances: integral(&number(&solution.density, &solution.atoms)),
            broken: solution.convolve(&Piecewise::default(), &force_kernel(&reformed), part)?,
        };
        let one = constant(1.0, &reformed.force);
        let first = Generation {
            starts: Layer::starting(&equation.contacts, &equation.initial.law, conditional)?,
            advances: integral(&one),
            number: one,
            broken: reformed.force.clone(),
        };
        let highest = |starts: &Layer| starts.range().map_or(0.0, |(_, high)| high);
        let limited = if conditional { highest(&first.starts) } else { 0.0 }.max(highest(&later.starts));
        let mut response = ThresholdResponse {
            thresholds: Vec::with_capacity(thresholds.len()),
            starting: [first, later],
            others: Vec::new(),
            reformed: reformed.force,
            distance: self.distance(),
            stiffness: self.stiffness,
        };
        // All thresholds above all starting stretches share a curve.
        let mut shared = None;
        for (k, &threshold) in thresholds.iter().enumerate() {
            let moment = |starts: &Layer| {
                [|_| 1.0, |r| r].map(|f: fn(f64) -> f64| starts.sum_within(threshold, f, &[]))
            };
            let moments = [0, 1].map(|k| moment(&response.starting[k].starts));
            let known = if threshold > limited { shared } else { None };
            let others = match known {
                Some(known) => known,
                None => {
                    let counts = [if conditional { moments[0][0] } else { 1.0 }, moments[1][0]];
                    let share = 0.6 / thresholds.len() as f64;
                    let part = &mut Part::new(monitor, 0.4 + k as f64 * share, share);
                    let number = &response.starting[1].number;
                    response.others.push(self.others(threshold, counts, number, part)?);
                    response.others.len() - 1
                }
            };
            if threshold > limited {
                shared = Some(others);
            }
            let at_once = if conditional { 0.0 } else { 1.0 - moments[0][0] };
            response.thresholds.push(OneThreshold { threshold, moments, at_once, others });
        }
        Ok(response)
    }

    /// Σ_i w_i δF(X_i)/δP_c(ξ) for each of these thresholds: [`ThresholdResponse::adjoint`].
    ///
    /// # Errors
    /// Those of [`Self::threshold_response`] and of [`ThresholdResponse::adjoint`].
    pub fn threshold_sensitivity(
        &self,
        positions: &[f64],
        weights: &[f64],
        thresholds: &[f64],
    ) -> Result<Vec<f64>> {
        self.threshold_sensitivity_with(positions, weights, thresholds, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::threshold_sensitivity`]; stopped by the monitor.
    pub fn threshold_sensitivity_with(
        &self,
        positions: &[f64],
        weights: &[f64],
        thresholds: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<f64>> {
        let response = self.threshold_response_with(thresholds, &mut Part::new(monitor, 0.0, 0.5))?;
        response.adjoint_with(positions, weights, &mut Part::new(monitor, 0.5, 0.5))
    }

    fn has_threshold_response(&self) -> Result<()> {
        let contacts = &self.equation.contacts;
        if let Some(rule) = contacts.rules.first() {
            let expected = "time-independent contacts: with others a threshold alone does not determine when a contact breaks";
            return Err(Error::invalid(rule, expected, "a response to thresholds"));
        }
        contacts.have_equal_stiffness()
    }

    /// The force of contacts that have all just re-formed.
    fn after_re_forming(&self, monitor: &mut dyn Monitor) -> Result<RenewalSolution> {
        if self.equation.starts_reformed() {
            return Ok(self.renewal.clone());
        }
        let (life, end): (&Arc<Life>, _) = (&self.renewal.reformed, self.renewal.force.end());
        RenewalSolution::solve(life, life, end, self.tolerance, monitor)
    }

    /// ∫_{r<ξ} ν_i F_r dr + Γ ∗ ∫_{r<ξ} ν F_r dr on the mesh of the solution, per unit stiffness: the force of the contacts
    /// that have the threshold ξ with another probability, with the thresholds that they had. `counts` are ∫ν of both, and
    /// `number` that of breaks.
    fn others(
        &self,
        threshold: f64,
        counts: [f64; 2],
        number: &Piecewise,
        monitor: &mut dyn Monitor,
    ) -> Result<Piecewise> {
        let (equation, solution) = (&self.equation, &self.renewal.solution);
        let mut below = |starts: &SharedLaw, life: &Life, share: f64| -> Result<LifeDerivative> {
            let starting = StartingContacts { contacts: &equation.contacts, starts, conditional: true, life };
            starting.renormalised_below(threshold, &mut Part::new(monitor, share, 0.2))
        };
        let reformed = below(&equation.contacts.reforming, &equation.reformed, 0.0)?;
        let [survival, force]: [&Piecewise; 2];
        let conditional;
        if equation.initial.start == Start::Conditional {
            conditional = below(&equation.initial.law, &equation.first, 0.2)?;
            [survival, force] = [conditional.survival().curve(), conditional.force().curve()];
        } else {
            [survival, force] = [equation.first.survival().curve(), equation.first.force().curve()];
        }
        let kernels = [reformed.survival(), reformed.force()].map(Some);
        let part = &mut Part::new(monitor, 0.4, 0.2);
        let mut held = solution.convolve_each(&[survival, force], &kernels, part)?.into_iter();
        let [unbroken, direct] = [(); 2].map(|()| held.next().unwrap_or_default());
        // Those that have broken at least once are all that formed without those that have not.
        let source = constant(counts[0], &unbroken).plus(counts[1], number).plus(-1.0, &unbroken);
        let carried = self.carried(&[source], vec![direct], &mut Part::new(monitor, 0.6, 0.4))?;
        Ok(carried.into_iter().next().unwrap_or_default())
    }
}

/// A constant on the cells of a curve.
fn constant(value: f64, on: &Piecewise) -> Piecewise {
    let mut cell = [0.0; NODES];
    cell[0] = value;
    Piecewise { boundaries: on.boundaries.clone(), coefficients: vec![cell; on.coefficients.len()] }
}

/// ∫₀^X of a density and its point masses, which lie on boundaries.
fn number(density: &Piecewise, atoms: &[Atom]) -> Piecewise {
    let atoms: Vec<_> = atoms.iter().map(|atom| (atom.position, atom.weight)).collect();
    let above = density.integrated_from_end(0.0, &atoms);
    constant(density.integral() + atoms.iter().map(|atom| atom.1).sum::<f64>(), density).plus(-1.0, &above)
}

/// ∫₀^X of a curve.
fn integral(curve: &Piecewise) -> Piecewise {
    number(curve, &[])
}
