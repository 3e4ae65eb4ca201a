//! Zeros of analytic functions in a rectangle, counted by the argument principle and told apart by bisection (L. M. Delves and
//! J. N. Lyness, Math. Comp. 21, 543 (1967)).

use std::f64::consts::TAU;

use num_complex::Complex64;

/// Evaluations that a path takes beyond its own steps, before its change of the argument counts as unknown.
const MOST_BISECTIONS: usize = 4000;

/// Change of the argument of `f` from a to b, in steps of at most `step` that are bisected until neither half changes the
/// argument by more than ½. `None` where that takes too many: beside a zero, or where `f` is noise or no number.
pub fn argument_change(
    f: &impl Fn(Complex64) -> Complex64,
    a: Complex64,
    b: Complex64,
    step: f64,
) -> Option<f64> {
    let steps = ((b - a).norm() / step).ceil().max(1.0) as usize;
    let mut left = 2 * steps + MOST_BISECTIONS;
    let mut before = (a, f(a));
    let mut sum = 0.0;
    for k in 1..=steps {
        let at = a + (b - a) * (k as f64 / steps as f64);
        let after = (at, f(at));
        sum += on_step(f, before, after, &mut left)?;
        before = after;
    }
    Some(sum)
}

/// The same between two points with their values.
fn on_step(
    f: &impl Fn(Complex64) -> Complex64,
    a: (Complex64, Complex64),
    b: (Complex64, Complex64),
    left: &mut usize,
) -> Option<f64> {
    *left = left.checked_sub(1)?;
    let middle = 0.5 * (a.0 + b.0);
    let middle = (middle, f(middle));
    let halves = [(middle.1 / a.1).arg(), (b.1 / middle.1).arg()];
    if halves.iter().all(|change| change.abs() < 0.5) {
        return Some(halves.iter().sum());
    }
    Some(on_step(f, a, middle, left)? + on_step(f, middle, b, left)?)
}

/// Whole turns, if the change of an argument is one.
pub fn turns(change: f64) -> Option<i64> {
    let turns = change / TAU;
    ((turns - turns.round()).abs() < 0.1).then_some(turns.round() as i64)
}

/// A rectangle by its lower left and its upper right corner.
#[derive(Debug, Clone, Copy)]
pub struct Rectangle {
    pub low: Complex64,
    pub high: Complex64,
}

impl Rectangle {
    fn middle(self) -> Complex64 {
        0.5 * (self.low + self.high)
    }

    fn holds(self, s: Complex64) -> bool {
        (self.low.re..=self.high.re).contains(&s.re) && (self.low.im..=self.high.im).contains(&s.im)
    }

    /// Number of zeros of `f`, which has no poles, in steps of at most `step`; `None` where it is not found.
    pub fn zeros(self, f: &impl Fn(Complex64) -> Complex64, step: f64) -> Option<i64> {
        let (Self { low, high }, corner) = (self, Complex64::new);
        let corners = [low, corner(high.re, low.im), high, corner(low.re, high.im), low];
        let sides = corners.windows(2).map(|side| argument_change(f, side[0], side[1], step));
        turns(sides.sum::<Option<f64>>()?)
    }

    /// Lower and upper, or left and right half.
    fn halves(self) -> [Self; 2] {
        let (Self { low, high }, middle) = (self, self.middle());
        let (first, second) = if high.re - low.re > high.im - low.im {
            (Complex64::new(middle.re, high.im), Complex64::new(middle.re, low.im))
        } else {
            (Complex64::new(high.re, middle.im), Complex64::new(low.re, middle.im))
        };
        [Self { low, high: first }, Self { low: second, high }]
    }

    /// Its `count` zeros of `f`, each by `refine` from the middle of a rectangle that holds it alone; `None` if one is not found.
    pub fn locate(
        self,
        f: &impl Fn(Complex64) -> Complex64,
        step: f64,
        refine: &impl Fn(Complex64) -> Option<Complex64>,
        count: i64,
    ) -> Option<Vec<Complex64>> {
        if count == 0 {
            return Some(Vec::new());
        }
        let size = (self.high - self.low).norm();
        if count < 0 || size < 1e-9 * self.middle().norm() {
            return None;
        }
        if count == 1
            && let Some(zero) = refine(self.middle()).filter(|&s| self.holds(s))
        {
            return Some(vec![zero]);
        }
        let [first, second] = self.halves();
        let of_first = first.zeros(f, step.min(0.25 * size))?;
        let mut zeros = first.locate(f, step, refine, of_first)?;
        zeros.extend(second.locate(f, step, refine, count - of_first)?);
        Some(zeros)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (s − a)(s − b)(s − c) e^s with zeros of very different distances.
    const ZEROS: [Complex64; 3] =
        [Complex64::new(-1.0, 2.0), Complex64::new(-1.001, 2.0), Complex64::new(0.3, 0.1)];

    fn product(s: Complex64) -> Complex64 {
        ZEROS.iter().map(|zero| s - zero).product::<Complex64>() * s.exp()
    }

    #[test]
    fn zeros_are_counted_and_told_apart() {
        let all = Rectangle { low: Complex64::new(-3.0, 0.01), high: Complex64::new(1.0, 5.0) };
        assert_eq!(all.zeros(&product, 0.5), Some(3));
        // Newton's method with one zero left out would do; the closest of the known ones is enough here.
        let refine =
            |s: Complex64| ZEROS.into_iter().min_by(|a, b| (a - s).norm().total_cmp(&(b - s).norm()));
        let mut found = all.locate(&product, 0.5, &refine, 3).unwrap();
        found.sort_by(|a, b| a.re.total_cmp(&b.re));
        assert_eq!(found, [ZEROS[1], ZEROS[0], ZEROS[2]]);
        let above = Rectangle { low: Complex64::new(-3.0, 2.1), ..all };
        assert_eq!(above.zeros(&product, 0.5), Some(0));
        assert_eq!(all.locate(&product, 0.5, &|_| None, 3), None, "a zero that is not found");
    }

    #[test]
    fn a_change_of_the_argument_that_is_not_found_is_none() {
        let (low, high) = (Complex64::new(-1.0, 0.0), Complex64::new(1.0, 2.0));
        let no_number = |s: Complex64| if s.re > 0.0 { Complex64::new(f64::NAN, 0.0) } else { s + 3.0 };
        assert_eq!(Rectangle { low, high }.zeros(&no_number, 0.5), None);
        // A zero on the side from below.
        assert_eq!(argument_change(&|s| s, low, Complex64::new(1.0, 0.0), 0.3), None);
        assert_eq!(turns(1.0), None);
        assert_eq!(turns(-12.6), Some(-2));
    }
}
