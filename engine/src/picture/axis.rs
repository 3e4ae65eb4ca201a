//! An axis: its range, and the numbers that stand at it.

use serde::Serialize;

use crate::digits::{brief, rounded};

/// Powers of ten at an axis, at most.
const DECADES: usize = 7;

/// The values at the ends of an axis.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Axis {
    /// The value at its beginning.
    pub min: f64,
    /// The value at its end.
    pub max: f64,
    /// Whether equal distances are equal ratios.
    pub logarithmic: bool,
}

/// How far an axis goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Span {
    /// From the least value to the largest.
    Exact,
    /// A tenth farther on either side, but from 0 on where all values are above.
    Wider,
}

impl Axis {
    /// The axis of these values, as far as they have a place on it.
    pub fn of(values: &mut dyn Iterator<Item = f64>, span: Span, logarithmic: bool) -> Self {
        let known = values.filter(|&value| value.is_finite() && (value > 0.0 || !logarithmic));
        let (mut min, mut max) =
            known.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
        if min > max {
            (min, max) = if logarithmic { (0.1, 10.0) } else { (0.0, 1.0) };
        }
        if min == 0.0 && max == 0.0 {
            max = 1.0;
        }
        match (logarithmic, span) {
            (true, Span::Exact) if max > min => {}
            (true, _) => {
                let farther = (max / min).powf(0.1).max(1.3);
                (min, max) = (min / farther, max * farther);
            }
            (false, Span::Exact) if max > min => {}
            (false, _) => {
                let size = if max > min { max - min } else { max.abs() };
                let low = min - 0.1 * size;
                min = if min >= 0.0 { low.max(0.0) } else { low };
                max += 0.1 * size;
            }
        }
        Self { min, max, logarithmic }
    }

    /// How far along the axis a value is, from 0 to 1 within it; not finite where it has no place.
    pub fn share(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.min).ln() / (self.max / self.min).ln()
        } else {
            (value - self.min) / (self.max - self.min)
        }
    }

    /// The value within the axis that is nearest.
    pub fn within(&self, value: f64) -> f64 {
        value.max(self.min).min(self.max)
    }

    /// The values at which numbers stand, about `most` of them.
    pub fn ticks(&self, most: usize) -> Vec<f64> {
        let most = most.max(2);
        if !self.logarithmic {
            return self.linear_ticks(most);
        }
        let decades = self.decades();
        if decades.len() > 2 {
            // Ten decades do not fit side by side.
            let step = decades.len().div_ceil(most.min(DECADES));
            return decades.into_iter().step_by(step).collect();
        }
        let between = self.multiples(&[1.0, 2.0, 5.0]);
        if between.len() > 1 { between } else { self.linear_ticks(most) }
    }

    /// The number at a tick, with the digits by which it differs from its neighbours.
    pub fn label(&self, tick: f64) -> String {
        let times = self.min.abs().max(self.max.abs()) / (self.max - self.min);
        let digits = if self.logarithmic { 0.0 } else { times.log10().ceil() + 5.0 };
        let value = rounded(tick, digits.clamp(6.0, 15.0) as usize);
        // Exponents would make many digits longer.
        if digits > 6.0 && (1e-3..1e15).contains(&value.abs()) { value.to_string() } else { brief(value) }
    }

    /// Lines between the numbers of a logarithmic axis of few decades.
    pub fn lines(&self) -> Vec<f64> {
        if !self.logarithmic || self.decades().len() > 5 {
            return vec![];
        }
        self.multiples(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
    }

    fn decades(&self) -> Vec<f64> {
        self.multiples(&[1.0])
    }

    /// The powers of ten with these factors, in order.
    fn multiples(&self, factors: &[f64]) -> Vec<f64> {
        let [low, high] = [self.min, self.max].map(|value| value.log10().floor() as i32);
        let all = (low..=high).flat_map(|power| factors.iter().map(move |factor| factor * ten_to(power)));
        all.filter(|value| (self.min * (1.0 - 1e-9)..=self.max * (1.0 + 1e-9)).contains(value)).collect()
    }

    fn linear_ticks(&self, most: usize) -> Vec<f64> {
        let least = (self.max - self.min) / most as f64;
        let power = ten_to(least.log10().floor() as i32);
        let step = [1.0, 2.0, 2.5, 5.0].into_iter().map(|factor| factor * power).find(|step| *step >= least);
        let step = step.unwrap_or(10.0 * power);
        let (first, last) = ((self.min / step - 1e-9).ceil(), (self.max / step + 1e-9).floor());
        (0..=(last - first).max(0.0) as usize).map(|i| (first + i as f64) * step).collect()
    }
}

/// A power of ten as it is written.
fn ten_to(power: i32) -> f64 {
    if power < 0 { 1.0 / 10f64.powi(-power) } else { 10f64.powi(power) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_at_round_values() {
        let axis = |min, max, logarithmic| Axis { min, max, logarithmic };
        assert_eq!(axis(0.0, 12.0, false).ticks(7), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0]);
        assert_eq!(axis(0.1, 0.9, false).ticks(5).len(), 4);
        assert_eq!(axis(1e-6, 10.0, true).ticks(4), [1e-6, 1e-4, 1e-2, 1.0]);
        assert_eq!(axis(0.02, 1.0, true).ticks(7), [0.02, 0.05, 0.1, 0.2, 0.5, 1.0]);
        assert_eq!(axis(1.1, 1.3, true).ticks(4).len(), 5);
    }

    #[test]
    fn neighbours_have_different_numbers() {
        for (min, max) in [(0.0, 1.1), (1e6, 1e6 + 1.1), (-1e9 - 0.3, -1e9), (0.3, 0.3 + 1e-9)] {
            let axis = Axis { min, max, logarithmic: false };
            for most in [2, 7, 200] {
                let ticks = axis.ticks(most);
                let labels: Vec<String> = ticks.iter().map(|&tick| axis.label(tick)).collect();
                assert!(labels.windows(2).all(|pair| pair[0] != pair[1]), "{labels:?}");
                // Not the digits of rounding.
                assert!(labels.iter().all(|label| label.len() <= 17), "{labels:?}");
            }
        }
        let axis = Axis { min: 0.0, max: 0.7, logarithmic: false };
        assert_eq!(axis.ticks(7).into_iter().map(|tick| axis.label(tick)).next_back().unwrap(), "0.7");
    }

    #[test]
    fn an_axis_has_a_place_for_each_value() {
        let axis = Axis::of(&mut [0.0, 2.0, f64::NAN].into_iter(), Span::Wider, false);
        assert_eq!((axis.min, axis.max), (0.0, 2.2));
        let axis = Axis::of(&mut [0.0, 1e-3, 1.0].into_iter(), Span::Exact, true);
        assert_eq!((axis.min, axis.max), (1e-3, 1.0));
        assert!(!axis.share(0.0).is_finite() && (axis.share(1.0) - 1.0).abs() < 1e-12);
        let axis = Axis::of(&mut [0.0, 0.0].into_iter(), Span::Wider, false);
        assert_eq!((axis.min, axis.max), (0.0, 1.1));
        for same in [0.0, 3.0, -2.0] {
            let axis = Axis::of(&mut [same].into_iter(), Span::Exact, false);
            assert!(axis.max > axis.min && (0.0..=1.0).contains(&axis.share(same)), "{axis:?}");
        }
    }
}
