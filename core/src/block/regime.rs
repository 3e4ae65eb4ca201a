//! Classification of sliding: smooth, transient or persistent stick-slip, runaway.

use serde::{Deserialize, Serialize};

use super::trace::{End, Point};

/// The kind of sliding since the last turn of the drive. Its text gives the reason in words.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Regime {
    /// No slip over a long distance.
    Smooth {
        /// Sliding distance.
        slid: f64,
    },
    /// Slips, and then none over a long distance, because the contacts have lost their common phase.
    Transient {
        /// Number of slips.
        slips: usize,
        /// Sliding distance since the last slip.
        slid: f64,
    },
    /// Slips to the end, with constant sizes apart from scatter.
    Persistent {
        /// Number of slips.
        slips: usize,
        /// Mean advance of the drive from slip to slip.
        period: f64,
        /// Mean force drop.
        drop: f64,
        /// Mean displacement of the slider in a slip.
        slip: f64,
        /// Coefficient of variation of the advances from slip to slip; 0 for exactly periodic slips.
        scatter: f64,
    },
    /// An imposed force that the contacts cannot carry.
    Runaway,
    /// The drive was too short to decide.
    Undecided {
        /// Number of slips.
        slips: usize,
        /// The reason.
        missing: Missing,
    },
}

/// The reason why a regime is undecided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Missing {
    /// No slip yet, but the sliding distance is too short.
    Distance,
    /// Slips to the end, but too few to see whether they continue.
    Slips,
    /// Slips to the end, with sizes that still change.
    Constancy,
    /// No slip for some distance, but not for long enough.
    Silence,
    /// No slip, but oscillations of the slider about the velocity of the drive that still grow.
    Calm,
}

/// Sliding distance without slips that counts as smooth, in units of the longest distance between two slips or of the
/// largest mean stretch of the contacts. The force then has gone through that many of its oscillations.
const LONG: f64 = 3.0;

/// Sliding distance after which the next slip is overdue, in units of the longest distance between two slips.
const LATE: f64 = 1.5;

/// Smallest number of slips, after the first, whose sizes are compared.
const FEWEST: usize = 3;

/// Largest relative difference of equal sizes.
const EQUAL: f64 = 1e-3;

/// Smallest number of slips for a test for a trend. For 6 slips, a linear trend makes the two halves differ by 5 standard
/// errors.
const FEWEST_SCATTERED: usize = 6;

/// Largest difference of the means of the two halves of scattered sizes, in standard errors.
const ERRORS: f64 = 3.0;

/// Number of slips from which on stick-slip is followed no further in search of an end of it. Near the end of persistence slips are
/// nearly equal for long before they cease.
pub(super) const PERSISTENT: usize = 40;

/// Number of slips from which on they are enough in motion in time, if by their trend they would remain equal through half of
/// [`PERSISTENT`] more: what remains of scatter makes a trend over fewer uncertain.
const SETTLED: usize = 16;

/// A slip, from one equilibrium to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Jump {
    pub before: Point,
    pub after: Point,
}

impl Jump {
    fn drop(&self) -> f64 {
        self.before.force - self.after.force
    }

    fn slip(&self) -> f64 {
        self.after.position - self.before.position
    }
}

/// The regime of a segment of the drive from `start` to `last` with these slips. `stretch` is the largest mean stretch of the
/// contacts.
pub(super) fn classify(events: &[Jump], start: Point, last: Point, stretch: f64, end: End) -> Regime {
    if end != End::Reached {
        return Regime::Runaway;
    }
    let slips = events.len();
    let undecided = |missing| Regime::Undecided { slips, missing };
    let Some(latest) = events.last() else {
        let slid = (last.position - start.position).abs();
        return if slid >= LONG * stretch { Regime::Smooth { slid } } else { undecided(Missing::Distance) };
    };
    let slid = (last.position - latest.after.position).abs();
    // The longest distance between two slips so far sets the scale on which the next one is
    // expected.
    let longest = longest_stick(events, start).max(stretch);
    if slid >= LONG * longest {
        return Regime::Transient { slips, slid };
    }
    if slid > LATE * longest {
        return undecided(Missing::Silence);
    }
    let tail = later_half(events);
    if tail.len() < FEWEST {
        return undecided(Missing::Slips);
    }
    if steady(tail) { persistent(slips, tail) } else { undecided(Missing::Constancy) }
}

/// The slips that are compared.
fn later_half(events: &[Jump]) -> &[Jump] {
    // The first slip starts from the initial state, unlike all others.
    let rest = events.get(1..).unwrap_or_default();
    // Sizes settle over the first slips.
    &rest[rest.len() / 2..]
}

/// Whether stick-slip that is persistent so far has lasted long enough to be called so: for [`PERSISTENT`] slips, or for
/// [`SETTLED`] slips that are equal and have no trend.
pub(super) fn lasts(events: &[Jump]) -> bool {
    let drops = drops(later_half(events));
    events.len() >= PERSISTENT
        || events.len() >= SETTLED
            && are_equal(&drops)
            && (trend(&drops) * 0.5 * PERSISTENT as f64).abs() <= EQUAL * mean(&drops)
}

/// A local maximum of the velocity of the slider, in units of the velocity of the drive, and its position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Oscillation {
    pub position: f64,
    pub velocity: f64,
}

/// The regime of a motion in time. It is undecided instead of smooth if the last oscillations grow monotonically to an
/// amplitude above `seen`, a length.
pub(super) fn with_oscillations(regime: Regime, oscillations: &[Oscillation], seen: f64) -> Regime {
    /// Number of oscillations compared. Noise makes so many increase in a row with probability 1/5! = 1/120.
    const LAST: usize = 5;
    /// Smallest growth factor from the first to the last of them.
    const GROWTH: f64 = 1.01;
    let slips = match regime {
        Regime::Smooth { .. } => 0,
        Regime::Transient { slips, .. } => slips,
        other => return other,
    };
    let Some([first, .., before, last]) =
        oscillations.len().checked_sub(LAST).map(|from| &oscillations[from..])
    else {
        return regime;
    };
    let excess = |oscillation: &Oscillation| oscillation.velocity - 1.0;
    let grow =
        oscillations[oscillations.len() - LAST..].windows(2).all(|pair| pair[1].velocity > pair[0].velocity);
    let amplitude = excess(last) * (last.position - before.position) / std::f64::consts::TAU;
    if grow && excess(last) > GROWTH * excess(first) && amplitude > seen {
        return Regime::Undecided { slips, missing: Missing::Calm };
    }
    regime
}

/// The longest distance between two slips, or from the start to the first one.
fn longest_stick(events: &[Jump], start: Point) -> f64 {
    let rests = std::iter::once(start.position).chain(events.iter().map(|e| e.after.position));
    rests.zip(events).map(|(rest, event)| (event.before.position - rest).abs()).fold(0.0, f64::max)
}

/// Whether force drops are equal, or scatter without a trend. The trend is tested by the means of the two halves.
fn steady(events: &[Jump]) -> bool {
    let drops = drops(events);
    if are_equal(&drops) {
        return true;
    }
    let (earlier, later) = drops.split_at(drops.len() / 2);
    // The variance from successive differences (von Neumann, 1941) is hardly affected by a trend.
    let squares: f64 = drops.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    let variance = squares / (2.0 * (drops.len() - 1) as f64);
    let error = (variance * (1.0 / earlier.len() as f64 + 1.0 / later.len() as f64)).sqrt();
    drops.len() >= FEWEST_SCATTERED && (mean(earlier) - mean(later)).abs() <= ERRORS * error
}

fn drops(events: &[Jump]) -> Vec<f64> {
    events.iter().map(|event| event.drop().abs()).collect()
}

fn are_equal(sizes: &[f64]) -> bool {
    let mean = mean(sizes);
    sizes.iter().all(|size| (size - mean).abs() <= EQUAL * mean)
}

/// The change from one size to the next, by the straight line of least squares.
fn trend(sizes: &[f64]) -> f64 {
    let middle = 0.5 * (sizes.len() - 1) as f64;
    let places = || (0..sizes.len()).map(|i| i as f64 - middle);
    let squares: f64 = places().map(|place| place * place).sum();
    places().zip(sizes).map(|(place, size)| place * size).sum::<f64>() / squares
}

fn persistent(slips: usize, tail: &[Jump]) -> Regime {
    let column = |f: &dyn Fn(&Jump) -> f64| tail.iter().map(f).collect::<Vec<_>>();
    let advances: Vec<f64> =
        tail.windows(2).map(|pair| (pair[1].before.drive - pair[0].before.drive).abs()).collect();
    let period = mean(&advances);
    let variance = mean(&advances.iter().map(|a| (a - period).powi(2)).collect::<Vec<_>>());
    let (drop, slip) = (mean(&column(&|e| e.drop().abs())), mean(&column(&|e| e.slip().abs())));
    Regime::Persistent { slips, period, drop, slip, scatter: variance.sqrt() / period }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

impl std::fmt::Display for Regime {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match *self {
            Self::Smooth { .. } => write!(f, "smooth sliding: no slip over a long distance"),
            Self::Transient { slips, .. } => {
                write!(f, "transient stick-slip: {}, then smooth sliding", counted(slips))
            }
            Self::Persistent { slips, .. } => {
                write!(f, "persistent stick-slip: {}, steady period", counted(slips))
            }
            Self::Runaway => write!(f, "runaway: the force is more than the contacts can carry"),
            Self::Undecided { slips, missing } => {
                let why = match missing {
                    Missing::Distance => "no slip, but the slider has not slid far",
                    Missing::Slips => "too few slips to see whether they go on",
                    Missing::Constancy => "the slips still change in size",
                    Missing::Silence => "no slip for a while, but not long enough to call it smooth",
                    Missing::Calm => "no slip, but oscillations about the velocity of the drive still grow",
                };
                write!(f, "undecided after {}, the drive is too short: {why}", counted(slips))
            }
        }
    }
}

fn counted(slips: usize) -> String {
    format!("{slips} slip{}", if slips == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slips of these force drops, one for each unit of the drive.
    fn slips(drops: &[f64]) -> Vec<Jump> {
        let at = |drive: f64, force: f64| Point { drive, position: drive, force, spring_force: force };
        let jump = |(i, drop): (usize, &f64)| Jump {
            before: at(i as f64 + 0.5, 1.0),
            after: at(i as f64 + 0.9, 1.0 - drop),
        };
        drops.iter().enumerate().map(jump).collect()
    }

    fn regime(drops: &[f64]) -> Regime {
        let at = |drive: f64| Point { drive, position: drive, force: 0.0, spring_force: 0.0 };
        classify(&slips(drops), at(0.0), at(drops.len() as f64), 0.5, End::Reached)
    }

    #[test]
    fn slips_that_still_change_in_size_are_undecided() {
        // Eight of twelve slips are compared; each is 10 % larger than the one before, or smaller.
        for factor in [1.1_f64, 0.9] {
            let drops: Vec<f64> = (0..16).map(|i| 0.1 * factor.powi(i)).collect();
            let expected = Regime::Undecided { slips: 16, missing: Missing::Constancy };
            assert_eq!(regime(&drops), expected, "factor {factor}");
        }
        assert!(regime(&[0.1, 0.2, 0.3, 0.2, 0.3, 0.4, 0.5]).to_string().contains("still change in size"));
    }

    #[test]
    fn equal_slips_and_slips_that_scatter_without_a_trend_are_persistent() {
        let scattered: Vec<f64> = (0..17).map(|i| if i % 2 == 0 { 0.2 } else { 0.3 }).collect();
        for drops in [vec![0.25; 8], scattered] {
            let found = regime(&drops);
            let Regime::Persistent { slips, period, drop, .. } = found else { panic!("{found:?}") };
            assert_eq!((slips, period), (drops.len(), 1.0));
            // The mean of eight or nine of them.
            assert!((drop - 0.25).abs() < 0.01, "{drop}");
        }
    }

    #[test]
    fn equal_slips_last_after_16_and_slips_that_drift_or_scatter_after_40() {
        let drifting = |change: f64| move |i: usize| 0.1 * (1.0 + change * i as f64);
        let scattered = |i: usize| if i.is_multiple_of(2) { 0.2 } else { 0.3 };
        // Through 20 slips more, a drift of 4e-5 per slip changes their size by less than 1e-3, one of 6e-5 by more.
        let cases: [(&dyn Fn(usize) -> f64, usize); 4] =
            [(&drifting(0.0), 16), (&drifting(4e-5), 16), (&drifting(6e-5), 40), (&scattered, 40)];
        for (case, (drop, expected)) in cases.into_iter().enumerate() {
            let lasting = |slips: usize| lasts(&self::slips(&Vec::from_iter((0..slips).map(drop))));
            assert!((0..50).all(|slips| lasting(slips) == (slips >= expected)), "case {case}");
        }
    }

    #[test]
    fn few_slips_are_too_few() {
        assert_eq!(regime(&[0.2; 4]), Regime::Undecided { slips: 4, missing: Missing::Slips });
    }
}
