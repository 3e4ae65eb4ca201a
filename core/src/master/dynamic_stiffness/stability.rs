//! Linear stability of steady sliding of a slider with mass and damping: the roots of its characteristic
//! equation.
//!
//! M Ẍ = K(X_T − X) − F − γẊ with the top at X_T = vt + const. Small deviations from steady sliding vary as
//! e^{st} with
//!
//! D(s) = M s² + γ s + K + F̂(s) = 0,
//!
//! F̂ being the dynamic stiffness of the contacts ([`DynamicStiffness`]). Steady sliding is stable if no root has
//! Re s > 0. Since K is real, roots on a line Re s = a occur only at the ω with Im[D(a + iω)] = 0, and only
//! for K = K_j(a) = −Re[D(a + iω_j) − K]. By the argument principle (Nyquist's criterion for a = 0) the
//! number of roots to the right of the line, conjugate ones both counted, is twice the number of K_j > K at
//! which Im D rises with ω minus the number of those at which it falls; ω = 0 counts once. All roots are on
//! the left if K exceeds the largest K_j(0), the critical stiffness K_c(v; M, γ). (J. R. Rice and A. L.
//! Ruina, J. Appl. Mech. 50, 343 (1983), for friction with memory.)

use num_complex::Complex64;

use super::DynamicStiffness;
use crate::monitor::{Monitor, Watch};
use crate::numerics::roots::brent_root;
use crate::{Error, Float, Result};

/// A slider; without mass and damping by default, so that its spring is in balance with the contacts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Slider {
    /// M ≥ 0, the mass.
    pub mass: f64,
    /// γ ≥ 0, the damping, force per velocity.
    pub damping: f64,
}

/// A crossing of the line Re s = a by a root as K decreases.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Crossing {
    frequency: f64,
    stiffness: f64,
    /// By how many the number of roots on the right grows below `stiffness`.
    roots: i32,
}

/// The number of roots on the right of a line Re s = a.
#[derive(Debug, Clone, Copy)]
struct RootCount {
    /// a.
    rate: f64,
    roots: i32,
    /// Where a root crosses the line for the stiffness nearest to that of the slider.
    guess: Option<Complex64>,
}

impl RootCount {
    /// Whether this root is the only one on the right of the line, but for the conjugate.
    fn has_alone(&self, root: Complex64) -> bool {
        /// What rounding leaves of the imaginary part of a real root.
        const ROUNDING: f64 = 1e-9;
        root.re > self.rate && (self.roots == 1 || self.roots == 2 && root.im > ROUNDING * root.re)
    }
}

impl DynamicStiffness {
    /// K_c(v; M, γ) of a slider, the stiffness of the spring above which steady sliding is stable, and the angular frequency of the
    /// oscillation that sets in there. Infinite if no spring makes steady sliding stable, as without damping whenever contacts give
    /// energy to high frequencies, Im F̂ < 0; its ω is then infinite, too. `None` if steady sliding is stable for every K > 0.
    ///
    /// Without mass and damping the limit −F̂ at ω → ∞ counts as well: there a step lowers the force by
    /// more than it relaxes the spring.
    ///
    /// # Errors
    /// Free times so much longer than lives that the frequencies are too many; stopped by the monitor.
    pub fn critical_stiffness(
        &self,
        slider: Slider,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(f64, f64)>> {
        let watch = Watch::new(monitor);
        let crossings = self.crossings(slider, 0.0, &watch)?.into_iter().map(|c| (c.stiffness, c.frequency));
        let critical = crossings.filter(|crossing| crossing.0 > 0.0).max_by(|a, b| a.0.total_cmp(&b.0));
        watch.check().map(|()| critical)
    }

    /// How many roots of the characteristic equation with a spring K have Re s > 0: 0 where steady sliding is stable.
    ///
    /// # Errors
    /// As [`Self::critical_stiffness`].
    pub fn unstable_roots(&self, slider: Slider, stiffness: f64, monitor: &mut dyn Monitor) -> Result<usize> {
        let watch = Watch::new(monitor);
        let roots = self.count(slider, stiffness, 0.0, &watch)?.roots.max(0) as usize;
        watch.check().map(|()| roots)
    }

    /// The root s = a + iω, ω ≥ 0, of the fastest growing deviation from steady sliding behind a spring K, which grows as
    /// e^{at}; `None` if steady sliding is stable.
    ///
    /// # Errors
    /// A slider without mass and damping, whose deviations may grow at any rate; the root is not found; those of
    /// [`Self::critical_stiffness`].
    pub fn growth(
        &self,
        slider: Slider,
        stiffness: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Complex64>> {
        /// Largest number of lines Re s = a on which roots are counted.
        const LINES: usize = 60;
        /// Ratio of the rates at which the search for an upper limit asks.
        const WIDER: f64 = 8.0;
        if !(slider.mass > 0.0 || slider.damping > 0.0) {
            return Err(Error::invalid("mass", "a mass or a damping above 0", slider.mass));
        }
        let watch = Watch::new(monitor);
        let mut last = self.count(slider, stiffness, 0.0, &watch)?;
        if last.roots <= 0 {
            return Ok(None);
        }
        // Bisection for a line with one root on its right, or one and its conjugate. That is the root of the fastest growth, and
        // Newton's method has found it if it ends there.
        let (mut high, mut next) = (f64::INFINITY, 1.0 / self.immediate.duration());
        for _ in 0..LINES {
            let found = last.guess.and_then(|guess| self.polish(slider, stiffness, guess));
            if let Some(root) = found.filter(|root| last.has_alone(*root)) {
                return Ok(Some(root));
            }
            let count = self.count(slider, stiffness, next, &watch)?;
            if count.roots > 0 {
                last = count;
            } else {
                high = next;
            }
            next = if high.is_finite() { 0.5 * (last.rate + high) } else { WIDER * next };
        }
        let what = "the rate at which deviations from steady sliding grow".to_owned();
        let (reached, wanted) = (Float(high - last.rate), Float(0.0));
        Err(Error::Accuracy { key: String::new(), what, reached, wanted })
    }

    /// D(s) − K.
    fn rest(&self, slider: Slider, s: Complex64) -> Complex64 {
        (slider.mass * s + slider.damping) * s + self.at(s)
    }

    /// How many roots have Re s > a.
    fn count(&self, slider: Slider, stiffness: f64, rate: f64, watch: &Watch<'_>) -> Result<RootCount> {
        let crossings = self.crossings(slider, rate, watch)?;
        watch.check()?;
        let before = crossings.iter().filter(|crossing| crossing.stiffness > stiffness);
        let roots = before.map(|crossing| crossing.roots).sum();
        let off = |crossing: &Crossing| (crossing.stiffness - stiffness).abs();
        let nearest = crossings.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        Ok(RootCount { rate, roots, guess: nearest.map(|crossing| Complex64::new(rate, crossing.frequency)) })
    }

    /// The crossings of the line Re s = a ≥ 0.
    fn crossings(&self, slider: Slider, rate: f64, watch: &Watch<'_>) -> Result<Vec<Crossing>> {
        let at = |frequency: f64| self.rest(slider, Complex64::new(rate, frequency));
        let imaginary = |frequency: f64| watch.value(|| at(frequency).im);
        let grid = self.frequencies()?;
        let line: Vec<(f64, f64)> =
            grid.into_iter().map(|frequency| (frequency, imaginary(frequency))).collect();
        // Bracketed sign changes of Im D.
        let inside =
            line.windows(2).filter(|pair| (pair[0].1 > 0.0) != (pair[1].1 > 0.0)).filter_map(|pair| {
                let frequency = brent_root(imaginary, pair[0].0, pair[1].0, 0.0)?;
                let roots = if pair[1].1 > 0.0 { 2 } else { -2 };
                Some(Crossing { frequency, stiffness: -at(frequency).re, roots })
            });
        let mut crossings: Vec<Crossing> = inside.collect();
        crossings.extend(self.beyond(slider, rate, line[line.len() - 1].0));
        if rate > 0.0 {
            // A real root: on the right of it Im D has the sign that it has at the lowest frequencies.
            let roots = if line[0].1 > 0.0 { 1 } else { -1 };
            crossings.push(Crossing { frequency: 0.0, stiffness: -at(0.0).re, roots });
        }
        Ok(crossings)
    }

    /// The crossing beyond the frequency `high`, up to which all are known. Contacts do not return in phase there.
    fn beyond(&self, slider: Slider, rate: f64, high: f64) -> Option<Crossing> {
        let viscous = |s: Complex64| (slider.mass * s + slider.damping) * s;
        let edge = Complex64::new(rate, high);
        let last = (viscous(edge) + self.without_return(edge)).im;
        let Slider { mass, damping } = slider;
        if mass == 0.0 && damping == 0.0 {
            let roots = if last > 0.0 { -1 } else { 1 };
            return Some(Crossing { frequency: f64::INFINITY, stiffness: -self.least_at_once(), roots });
        }
        if last >= 0.0 {
            return None;
        }
        // Im D = (2Ma + γ)ω − ρω/(a² + ω²).
        let drag = 2.0 * mass * rate + damping;
        let decay = (drag * high - last) * (rate * rate + high * high) / high;
        let frequency = (decay / drag - rate * rate).sqrt();
        let stiffness = if frequency.is_finite() {
            let s = Complex64::new(rate, frequency);
            -(viscous(s) + self.without_return(s)).re
        } else {
            f64::INFINITY
        };
        Some(Crossing { frequency, stiffness, roots: 2 })
    }

    /// Newton's method for D(s) = 0, with D' by finite differences.
    fn polish(&self, slider: Slider, stiffness: f64, guess: Complex64) -> Option<Complex64> {
        let value = |s| self.rest(slider, s) + stiffness;
        let mut s = guess;
        for _ in 0..50 {
            // Central differences are right to the square of the step, and Newton's method needs
            // the slope to a few digits only.
            let step = 1e-5 * s.norm().max(1.0 / self.immediate.duration());
            let slope = (value(s + step) - value(s - step)) / (2.0 * step);
            let change = value(s) / slope;
            s -= change;
            if change.norm() <= 1e-12 * s.norm() {
                return Some(Complex64::new(s.re, s.im.abs()));
            }
        }
        None
    }
}
