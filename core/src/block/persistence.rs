//! Whether stick-slip persists behind a spring, and the stiffness of the spring at which it ceases to.

use super::regime::PERSISTENT;
use super::{Block, Drive, Loading, Regime, Slip};
use crate::error::positive;
use crate::monitor::{Aside, Monitor};
use crate::population::Population;
use crate::{Error, Result};

/// Largest number of drives until the regime is decided, each of which is twice as long as the one before, or as long as 40 slips
/// take.
const DRIVES: usize = 8;

/// Largest number of doublings of the stiffness in search of one at which stick-slip does not persist.
const DOUBLINGS: usize = 4;

/// The stiffness at which persistent stick-slip ends, enclosed by two stiffnesses.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PersistenceLimit {
    /// The largest stiffness, below [`Self::ended`], at which stick-slip was found to persist; 0 if there was none.
    pub persists: f64,
    /// The smallest stiffness above [`Self::persists`] at which it was found not to persist; infinite if there was none.
    pub ended: f64,
}

impl PersistenceLimit {
    /// Encloses the stiffness with a ratio of at most 1 + `resolution`, from the `regime` at single stiffnesses.
    ///
    /// The stiffness is doubled from `highest`, four times at most, until stick-slip does not persist, then halved down to
    /// `lowest` until it does, and the interval between is bisected on a logarithmic scale. If stick-slip persists in
    /// several intervals, this is the end of one of them. Where the regime stays undecided the bisection ends.
    ///
    /// # Errors
    /// Stiffnesses that are not numbers above 0, `lowest` above `highest`; a resolution that is not above 0; those of `regime`.
    pub fn find(
        [lowest, highest]: [f64; 2],
        resolution: f64,
        mut regime: impl FnMut(f64) -> Result<Regime>,
    ) -> Result<Self> {
        positive("lowest", lowest)?;
        positive("resolution", resolution)?;
        if !(highest >= lowest && highest.is_finite()) {
            return Err(Error::invalid("highest", format!("a finite number, {lowest} or more"), highest));
        }
        let (mut persists, mut ended, mut stiffness) = (0.0, f64::INFINITY, highest);
        for _ in 0..=DOUBLINGS {
            match regime(stiffness)? {
                Regime::Persistent { .. } => persists = stiffness,
                Regime::Undecided { .. } => {}
                _ => {
                    ended = stiffness;
                    break;
                }
            }
            stiffness *= 2.0;
        }
        stiffness = highest;
        while persists == 0.0 && stiffness > lowest {
            stiffness = (0.5 * stiffness).max(lowest);
            match regime(stiffness)? {
                Regime::Persistent { .. } => persists = stiffness,
                Regime::Undecided { .. } => {}
                _ => ended = stiffness,
            }
        }
        while persists > 0.0 && ended.is_finite() && ended > (1.0 + resolution) * persists {
            let middle = (persists * ended).sqrt();
            // No number is between them.
            if middle <= persists || middle >= ended {
                break;
            }
            match regime(middle)? {
                Regime::Persistent { .. } => persists = middle,
                Regime::Undecided { .. } => break,
                _ => ended = middle,
            }
        }
        Ok(Self { persists, ended })
    }

    /// The same with a regime that is known, if the stiffness is not enclosed on both sides.
    #[must_use]
    pub fn with(self, stiffness: f64, regime: &Regime) -> Self {
        let (is_open, is_inside) = (
            self.persists == 0.0 || self.ended == f64::INFINITY,
            stiffness > self.persists && stiffness < self.ended,
        );
        match regime {
            _ if !(is_open && is_inside) => self,
            Regime::Persistent { .. } => Self { persists: stiffness, ..self },
            Regime::Undecided { .. } => self,
            _ => Self { ended: stiffness, ..self },
        }
    }
}

impl Block {
    /// The same slider behind a spring of another stiffness.
    ///
    /// # Errors
    /// Those of [`Block::new`].
    pub fn with_stiffness(self, stiffness: f64) -> Result<Self> {
        let built = Self::new(Loading::Spring(stiffness), self.slip, self.slip_fraction)?;
        Ok(Self { background: self.background, ..built })
    }

    /// The smallest stiffness behind which a slip can be computed, 0 for most slip rules: γ ≤ 10³√(MK).
    pub fn least_stiffness(&self) -> f64 {
        match self.slip {
            Slip::Inertial { mass, damping } => (damping / super::MOST_DAMPING).powi(2) / mass,
            _ => 0.0,
        }
    }

    /// The regime of sliding over time-independent contacts that are not moved themselves. The drive is as long as it takes to
    /// decide: first a length `distance`, then up to seven times twice as much. Stick-slip is persistent if it is so after 40
    /// slips.
    ///
    /// # Errors
    /// A distance that is not above 0; those of [`Block::pull`]; stopped by the monitor.
    pub fn regime(
        &self,
        contacts: &dyn Population,
        distance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Regime> {
        decided(distance, monitor, |distance, monitor| {
            let drive = Drive { turning_points: vec![distance], points: 2 };
            self.pull_with(contacts.copy().as_mut(), &drive, monitor).map(|run| run.regime)
        })
    }
}

/// The regime of drives of increasing length until one is decided.
fn decided(
    mut distance: f64,
    monitor: &mut dyn Monitor,
    mut regime: impl FnMut(f64, &mut dyn Monitor) -> Result<Regime>,
) -> Result<Regime> {
    positive("distance", distance)?;
    let mut found = regime(distance, &mut Aside { fraction: 0.0, monitor })?;
    for _ in 1..DRIVES {
        distance *= match found {
            // A little more than as many slips take, the first of which are apart by other lengths.
            Regime::Persistent { slips, .. } if slips < PERSISTENT => 1.2 * PERSISTENT as f64 / slips as f64,
            Regime::Undecided { .. } => 2.0,
            _ => break,
        };
        found = regime(distance, &mut Aside { fraction: 0.0, monitor })?;
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn persistent_below(limit: f64) -> impl FnMut(f64) -> Result<Regime> {
        move |stiffness| {
            Ok(if stiffness < limit {
                Regime::Persistent { slips: 9, period: 1.0, drop: 1.0, slip: 1.0, scatter: 0.0 }
            } else {
                Regime::Smooth { slid: 1.0 }
            })
        }
    }

    #[test]
    fn a_limit_below_the_first_stiffness_and_one_above_are_enclosed() {
        for limit in [0.0123, 0.7, 5.0] {
            let found = PersistenceLimit::find([1e-3, 1.0], 0.01, persistent_below(limit)).unwrap();
            assert!(found.persists < limit && found.ended >= limit, "{found:?}");
            assert!(found.ended <= 1.01 * found.persists, "{found:?}");
        }
    }

    #[test]
    fn without_a_limit_one_side_is_open() {
        let never = PersistenceLimit::find([1e-3, 1.0], 0.01, persistent_below(0.0)).unwrap();
        assert_eq!(never, PersistenceLimit { persists: 0.0, ended: 1e-3 });
        let always = PersistenceLimit::find([1e-3, 1.0], 0.01, persistent_below(1e9)).unwrap();
        assert_eq!(always, PersistenceLimit { persists: 16.0, ended: f64::INFINITY });
    }

    #[test]
    fn a_known_regime_counts_where_one_side_is_open() {
        let [persistent, smooth] = [0.0, 1.0].map(|k| persistent_below(0.5)(k).unwrap());
        let limit = |persists, ended| PersistenceLimit { persists, ended };
        assert_eq!(limit(16.0, f64::INFINITY).with(20.0, &persistent), limit(20.0, f64::INFINITY));
        assert_eq!(limit(16.0, f64::INFINITY).with(20.0, &smooth), limit(16.0, 20.0));
        assert_eq!(limit(16.0, f64::INFINITY).with(2.0, &smooth), limit(16.0, f64::INFINITY));
        assert_eq!(limit(0.0, 1.0).with(0.5, &persistent), limit(0.5, 1.0));
        assert_eq!(limit(0.9, 1.0).with(0.95, &persistent), limit(0.9, 1.0));
    }

    #[test]
    fn an_undecided_regime_does_not_count_for_either_side() {
        let undecided = Regime::Undecided { slips: 0, missing: super::super::Missing::Slips };
        let mut decided = persistent_below(0.1);
        let regime = |k: f64| if (0.09..0.12).contains(&k) { Ok(undecided) } else { decided(k) };
        let found = PersistenceLimit::find([1e-3, 1.0], 0.01, regime).unwrap();
        // Regimes between 0.09 and 0.12 are undecided.
        assert!(found.persists < 0.09 && found.ended >= 0.12, "{found:?}");
        assert_eq!(PersistenceLimit::find([1e-3, 1.0], 0.01, |_| Ok(undecided)).unwrap().persists, 0.0);
    }

    #[test]
    fn a_few_equal_slips_are_followed_further() {
        // Slips of the length 1 that end after a distance of 30.
        let drives = std::cell::RefCell::new(Vec::new());
        let regime = |distance: f64, _: &mut dyn Monitor| {
            drives.borrow_mut().push(distance);
            let slips = distance.min(30.0) as usize;
            Ok(match distance {
                _ if distance < 8.0 => Regime::Undecided { slips, missing: super::super::Missing::Slips },
                _ if distance < 30.0 => {
                    Regime::Persistent { slips, period: 1.0, drop: 1.0, slip: 1.0, scatter: 0.0 }
                }
                _ => Regime::Transient { slips, slid: distance - 30.0 },
            })
        };
        assert!(matches!(decided(5.0, &mut (), regime).unwrap(), Regime::Transient { slips: 30, .. }));
        assert_eq!(*drives.borrow(), [5.0, 10.0, 48.0]);
    }

    #[test]
    fn wrong_arguments_are_refused() {
        for (range, resolution) in [([0.0, 1.0], 0.1), ([2.0, 1.0], 0.1), ([0.1, 1.0], 0.0)] {
            assert!(PersistenceLimit::find(range, resolution, persistent_below(1.0)).is_err());
        }
    }
}
