//! A step in time: of second order, and positive whatever its length.

use std::sync::Arc;

use super::floor::{Cut, place};
use super::{Diffusion, Factors};

/// √2.
pub(super) const SQRT_2: f64 = std::f64::consts::SQRT_2;

/// γ = 1 − 1/√2.
pub(super) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// A step of one duration t, in which an absorbing floor may rise.
///
/// Two stages u₁ = A₁m and A₂[(1 + √2)u₁ − √2m], with A = (1 − γtL)⁻¹, γ = 1 − 1/√2, for where the floor is after γt and after
/// t: L-stable and of second order (R. Alexander, SIAM J. Numer. Anal. 14, 1006 (1977)); a floor that rises through masses at rest
/// takes exactly what it meets, were they spread evenly over each cell. Where this makes a mass negative, it is brought back
/// towards backward Euler, which cannot, by limiting the flux between the two (S. T. Zalesak, J. Comput. Phys. 31, 335
/// (1979)).
#[derive(Debug, Clone)]
pub struct DiffusionStep {
    operator: Arc<Diffusion>,
    duration: f64,
    factors: Factors,
}

/// What a step takes away.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Lost {
    /// By the floor.
    pub absorbed: f64,
    /// By the sink.
    pub sunk: f64,
}

/// Room for steps, used again and again.
#[derive(Debug, Clone, Default)]
pub struct Work {
    first: Vec<f64>,
    second: Vec<f64>,
    sinking: Factors,
}

impl DiffusionStep {
    /// The step of that duration, 0 or above.
    pub fn new(operator: &Arc<Diffusion>, duration: f64) -> Self {
        Self { operator: operator.clone(), duration, factors: Factors::new(operator, GAMMA * duration, None) }
    }

    /// Its duration.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Moves masses on while the floor rises from one place to another; −∞ is no floor. A `sink` takes mass away at a rate
    /// per cell. There is no mass below the floor.
    pub fn advance(
        &self,
        masses: &mut [f64],
        floor: (f64, f64),
        sink: Option<&[f64]>,
        work: &mut Work,
    ) -> Lost {
        work.first.resize(masses.len(), 0.0);
        work.second.resize(masses.len(), 0.0);
        if sink.is_some() {
            work.sinking.renew(&self.operator, GAMMA * self.duration, sink);
        }
        let from = place(&self.operator, floor.0).0;
        if from == masses.len() {
            return Lost::default();
        }
        let Work { first, second, sinking } = work;
        let factors = if sink.is_some() { sinking } else { &self.factors };
        let taken = |masses: &[f64]| sunk(sink, &masses[from..], from, GAMMA * self.duration);
        let [early, late] = self.cuts(floor, from);
        let absorbed = factors.solve(&self.operator, &early, sink, masses, first);
        let once = Lost { absorbed, sunk: taken(first) };
        for (second, (first, mass)) in
            second[from..].iter_mut().zip(first[from..].iter().zip(&masses[from..]))
        {
            *second = (1.0 + SQRT_2) * first - SQRT_2 * mass;
        }
        let absorbed = factors.solve(&self.operator, &late, sink, second, first);
        let lost = Lost {
            absorbed: (1.0 + SQRT_2) * once.absorbed + absorbed,
            sunk: (1.0 + SQRT_2) * once.sunk + taken(first),
        };
        if first[from..].iter().chain([&lost.absorbed, &lost.sunk]).any(|&mass| mass < 0.0) {
            return self.limited(masses, floor, from, sink, work);
        }
        masses[from..].copy_from_slice(&first[from..]);
        lost
    }

    /// The floor at the two stages. What the second stage passes of a cell is what is still to be passed after the first
    /// one, extrapolated like the masses.
    fn cuts(&self, (start, end): (f64, f64), from: usize) -> [Cut; 2] {
        let middle = if start == end { end } else { start + GAMMA * (end - start) };
        let early = |edge: f64| (middle - edge.max(start)).max(0.0);
        let late = |edge: f64| (end - edge.max(middle)).max(0.0) - SQRT_2 * early(edge);
        [Cut::at(&self.operator, middle, from, early), Cut::at(&self.operator, end, from, late)]
    }

    /// The step by backward Euler, corrected towards the masses in `work.first` as far as none turns negative.
    fn limited(
        &self,
        masses: &mut [f64],
        floor: (f64, f64),
        from: usize,
        sink: Option<&[f64]>,
        work: &mut Work,
    ) -> Lost {
        let euler = Factors::new(&self.operator, self.duration, sink);
        let Work { first, second, .. } = work;
        let cut = Cut::at(&self.operator, floor.1, from, |edge| floor.1 - edge.max(floor.0));
        let absorbed = euler.solve(&self.operator, &cut, sink, masses, second);
        let sunk = sunk(sink, &second[from..], from, self.duration);
        let flow = correct(&second[from..], &mut first[from..], &mut masses[from..], absorbed + sunk);
        let left = 1.0 - flow / (absorbed + sunk).max(f64::MIN_POSITIVE);
        Lost { absorbed: absorbed * left, sunk: sunk * left }
    }
}

/// Writes into `out` the masses `safe`, corrected towards `better` by limited fluxes between neighbours, so that none is
/// below 0. What flows up into the lowest cell, out of what has been `lost` below it, is returned. `better` is spent.
fn correct(safe: &[f64], better: &mut [f64], out: &mut [f64], lost: f64) -> f64 {
    let flows = better;
    let mut flow = 0.0;
    for (better, safe) in flows.iter_mut().zip(safe).rev() {
        flow += *better - safe;
        *better = flow;
    }
    let above = |i: usize| flows.get(i + 1).copied().unwrap_or(0.0);
    let share = |held: f64, wanted: f64| if wanted > held { held / wanted } else { 1.0 };
    let giving = |i: usize| share(safe[i], (-flows[i]).max(0.0) + above(i).max(0.0));
    let allowed = |i: usize| {
        let giver = if flows[i] <= 0.0 { Some(i) } else { i.checked_sub(1) };
        flows[i] * giver.map_or_else(|| share(lost, flows[i]), giving)
    };
    let mut over = 0.0;
    for i in (0..safe.len()).rev() {
        let flow = allowed(i);
        out[i] = (safe[i] + flow - over).max(0.0);
        over = flow;
    }
    over
}

/// What a sink takes in a time a from masses that begin at the cell `from`.
fn sunk(sink: Option<&[f64]>, masses: &[f64], from: usize, a: f64) -> f64 {
    let taken = |w: &[f64]| w[from..].iter().zip(masses).map(|(w, m)| w * m).sum::<f64>();
    sink.map_or(0.0, |w| a * taken(w))
}
