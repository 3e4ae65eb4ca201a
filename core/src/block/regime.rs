//! What kind of sliding a drive showed, and why it is called so.

use super::trace::{End, Point};

/// What kind of sliding a drive showed since it last turned. Its text says why, in plain words.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Regime {
    /// No slip, over a long way.
    Smooth {
        /// How far the slider slid.
        slid: f64,
    },
    /// Slips, and then none over a long way: the contacts have lost step with each other.
    Transient {
        /// Number of slips.
        slips: usize,
        /// How far the slider has slid since the last one.
        slid: f64,
    },
    /// Slips to the end, of sizes that no longer change but for scatter.
    Persistent {
        /// Number of slips.
        slips: usize,
        /// Mean advance of the drive from slip to slip.
        period: f64,
        /// Mean drop of the force.
        drop: f64,
        /// Mean way of the slider in a slip.
        slip: f64,
        /// Scatter of the recurrence: standard deviation of the advances from slip to slip over their mean, 0 for
        /// clockwork.
        scatter: f64,
    },
    /// An imposed force that the contacts cannot carry.
    Runaway,
    /// The drive ended too early to tell.
    Undecided {
        /// Number of slips.
        slips: usize,
        /// What is missing.
        missing: Missing,
    },
}

/// What keeps a regime from being told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Missing {
    /// No slip yet, but the slider has not slid far.
    Way,
    /// Slips to the end, too few to see whether they go on.
    Slips,
    /// Slips to the end, of sizes that still change.
    Constancy,
    /// No slip for a while, but not for long.
    Silence,
    /// No slip, but oscillations of the slider about the velocity of the drive that still grow.
    Calm,
}

/// Sliding is smooth after this many times the longest way between two slips, or the largest mean stretch of the
/// contacts: the force has then gone through that many of its oscillations.
const LONG: f64 = 3.0;

/// Slips stop to be expected after this many times the longest way between two of them.
const LATE: f64 = 1.5;

/// Fewest slips, after the first, whose sizes can be called equal.
const FEWEST: usize = 3;

/// By how much equal sizes may differ.
const EQUAL: f64 = 1e-3;

/// Fewest slips of which a trend can be told from scatter: at 6, equal steps make a difference of the two halves
/// of 5 standard errors.
const FEWEST_SCATTERED: usize = 6;

/// Standard errors by which the two halves of scattered sizes may differ.
const ERRORS: f64 = 3.0;

/// A slip, from one balance to another.
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

/// The regime of the slips of a leg that began at `start` and ended at `last`, with contacts whose mean stretch was
/// `stretch` at most.
pub(super) fn tell(events: &[Jump], start: Point, last: Point, stretch: f64, end: End) -> Regime {
    if end != End::Reached {
        return Regime::Runaway;
    }
    let slips = events.len();
    let undecided = |missing| Regime::Undecided { slips, missing };
    let Some(latest) = events.last() else {
        let slid = (last.position - start.position).abs();
        return if slid >= LONG * stretch { Regime::Smooth { slid } } else { undecided(Missing::Way) };
    };
    let slid = (last.position - latest.after.position).abs();
    let longest = longest_stick(events, start).max(stretch);
    if slid >= LONG * longest {
        return Regime::Transient { slips, slid };
    }
    if slid > LATE * longest {
        return undecided(Missing::Silence);
    }
    // The first slip starts from other contacts than those after it.
    let rest = &events[1..];
    let tail = &rest[rest.len() / 2..];
    if tail.len() < FEWEST {
        return undecided(Missing::Slips);
    }
    if steady(tail) { persistent(slips, tail) } else { undecided(Missing::Constancy) }
}

/// A velocity of the slider that is higher than those before and after it, in units of that of the drive, and where.
#[derive(Debug, Clone, Copy)]
pub(super) struct Oscillation {
    pub position: f64,
    pub velocity: f64,
}

/// The regime of a motion in time: not smooth where the last oscillations grow, one after the other, to
/// more than `seen`.
pub(super) fn calm(regime: Regime, oscillations: &[Oscillation], seen: f64) -> Regime {
    /// Oscillations looked at: noise makes so many rise in a row once in 120.
    const LAST: usize = 5;
    /// Least growth from the first to the last of them.
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
    let way = excess(last) * (last.position - before.position) / std::f64::consts::TAU;
    if grow && excess(last) > GROWTH * excess(first) && way > seen {
        return Regime::Undecided { slips, missing: Missing::Calm };
    }
    regime
}

/// The longest way in balance before a slip.
fn longest_stick(events: &[Jump], start: Point) -> f64 {
    let rests = std::iter::once(start.position).chain(events.iter().map(|e| e.after.position));
    rests.zip(events).map(|(rest, event)| (event.before.position - rest).abs()).fold(0.0, f64::max)
}

/// Whether force drops are equal, or scatter without a trend.
fn steady(events: &[Jump]) -> bool {
    let drops: Vec<f64> = events.iter().map(|e| e.drop().abs()).collect();
    let mean = mean(&drops);
    if drops.iter().all(|drop| (drop - mean).abs() <= EQUAL * mean) {
        return true;
    }
    let (earlier, later) = drops.split_at(drops.len() / 2);
    // From differences of neighbours, which a trend hardly enters.
    let squares: f64 = drops.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    let variance = squares / (2.0 * (drops.len() - 1) as f64);
    let error = (variance * (1.0 / earlier.len() as f64 + 1.0 / later.len() as f64)).sqrt();
    drops.len() >= FEWEST_SCATTERED && (self::mean(earlier) - self::mean(later)).abs() <= ERRORS * error
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
            Self::Smooth { .. } => write!(f, "smooth sliding: no slip on a long way"),
            Self::Transient { slips, .. } => {
                write!(f, "transient stick-slip: {}, then smooth sliding", counted(slips))
            }
            Self::Persistent { slips, .. } => {
                write!(f, "persistent stick-slip: {}, steady period", counted(slips))
            }
            Self::Runaway => write!(f, "runaway: the force is more than the contacts can carry"),
            Self::Undecided { slips, missing } => {
                let why = match missing {
                    Missing::Way => "no slip, but the slider has not slid far",
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
