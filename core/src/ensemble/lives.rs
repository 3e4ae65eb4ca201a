//! The lives of contacts: stretches of formation and thresholds, drawn from the random streams of each
//! contact.

use serde::{Deserialize, Serialize};

use super::{Disorder, Ensemble};
use crate::contacts::Start;
use crate::law::SharedLaw;
use crate::random::{Purpose, Stream};

/// Draws by rejection before the distribution is inverted instead; both are exact.
const TRIES: usize = 16;

/// Largest number of values drawn ahead: enough to hide the cost of a virtual call.
const BATCH: usize = 128;

/// A life: the stretch at which a contact forms, and its threshold.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactLife {
    pub(super) stretch: f64,
    pub(super) threshold: f64,
}

/// Position of a contact in its random streams: words taken from each, modulo 2³².
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Drawn {
    thresholds: u32,
    reforming: u32,
    conditional: u32,
}

impl From<[u32; 3]> for Drawn {
    fn from([thresholds, reforming, conditional]: [u32; 3]) -> Self {
        Self { thresholds, reforming, conditional }
    }
}

impl From<Drawn> for [u32; 3] {
    fn from(drawn: Drawn) -> Self {
        [drawn.thresholds, drawn.reforming, drawn.conditional]
    }
}

/// The lives of the contacts of an ensemble.
#[derive(Debug, Clone)]
pub(super) struct Lives {
    ensemble: Ensemble,
    thresholds: Draws,
    reforming: Draws,
    /// R, if it is a single point: then nothing is drawn.
    point: Option<f64>,
    /// The threshold of this contact, if it is quenched.
    quenched: Option<f64>,
    initial: Stream,
    conditional: Stream,
}

impl Lives {
    /// For contacts simulated one after another, each expected to break `expected` times.
    pub(super) fn new(ensemble: &Ensemble, expected: usize) -> Self {
        Self::drawing(ensemble, expected, BATCH)
    }

    /// For contacts whose lives are needed in any order: nothing is drawn ahead.
    pub(super) fn in_any_order(ensemble: &Ensemble) -> Self {
        Self::drawing(ensemble, 1, 1)
    }

    fn drawing(ensemble: &Ensemble, expected: usize, most: usize) -> Self {
        let contacts = &ensemble.contacts;
        let atoms = contacts.reforming.atoms();
        let stream = |purpose| Stream::new(ensemble.seed, purpose, 0);
        let (purpose, ahead) = match ensemble.disorder {
            Disorder::Annealed => (Purpose::Thresholds, expected),
            Disorder::Quenched => (Purpose::QuenchedThresholds, 1),
        };
        let draws =
            |law: &SharedLaw, purpose, expected| Draws::new(law.clone(), stream(purpose), expected, most);
        Self {
            thresholds: draws(&contacts.thresholds, purpose, ahead),
            reforming: draws(&contacts.reforming, Purpose::Reforming, expected),
            point: atoms.first().filter(|a| a.weight == 1.0).map(|a| a.position),
            quenched: None,
            initial: stream(Purpose::Initial),
            conditional: stream(Purpose::Conditional),
            ensemble: ensemble.clone(),
        }
    }

    pub(super) fn seed(&self) -> u64 {
        self.ensemble.seed
    }

    /// The number that selects the random streams of contact `index`.
    #[inline]
    pub(super) fn number(&self, index: u64) -> u64 {
        self.ensemble.first + index
    }

    /// Selects contact `index`, and returns its life at X = 0.
    pub(super) fn first(&mut self, index: u64) -> ContactLife {
        let index = self.number(index);
        let Ensemble { disorder, ref initial, .. } = self.ensemble;
        self.thresholds.seek(index, 0);
        self.reforming.seek(index, 0);
        self.initial.seek(index, 0);
        self.conditional.seek(index, 0);
        self.quenched = None;
        let mut stretch = [0.0];
        initial.law.fill(&mut self.initial, &mut stretch);
        let threshold = match initial.start {
            Start::Conditional => self.threshold_above(stretch[0]),
            Start::Relaxed => self.thresholds.next(),
        };
        if disorder == Disorder::Quenched {
            self.quenched = Some(threshold);
        }
        ContactLife { stretch: stretch[0], threshold }
    }

    /// Position of the present contact in its streams, if nothing is drawn ahead.
    pub(super) fn drawn(&self) -> Drawn {
        Drawn {
            thresholds: self.thresholds.stream.taken() as u32,
            reforming: self.reforming.stream.taken() as u32,
            conditional: self.conditional.taken() as u32,
        }
    }

    /// Returns to contact `index` at the position `drawn` of its streams, after it broke at `threshold`.
    pub(super) fn resume(&mut self, index: u64, drawn: Drawn, threshold: f64) {
        let index = self.number(index);
        self.thresholds.seek(index, drawn.thresholds.into());
        self.reforming.seek(index, drawn.reforming.into());
        self.conditional.seek(index, drawn.conditional.into());
        self.quenched = (self.ensemble.disorder == Disorder::Quenched).then_some(threshold);
    }

    /// The life after a break.
    #[inline]
    pub(super) fn next(&mut self) -> ContactLife {
        if let Some(threshold) = self.quenched {
            return ContactLife { stretch: self.stretch_below(threshold), threshold };
        }
        let stretch = self.point.unwrap_or_else(|| self.reforming.next());
        let threshold = self.thresholds.next();
        // The first draw serves as the first try of the rejection: x_s ~ P_c given x_s > r.
        let threshold = if threshold > stretch { threshold } else { self.threshold_above(stretch) };
        ContactLife { stretch, threshold }
    }

    /// Thresholds drawn ahead, and the stretch at which all contacts re-form, if that is a single point: the
    /// lives that [`Lives::next`] will return, as long as the thresholds are above the stretch.
    #[inline]
    pub(super) fn drawn_ahead(&mut self) -> (&[f64], f64) {
        match (self.point, self.quenched) {
            (Some(stretch), None) => (self.thresholds.ahead(), stretch),
            _ => (&[], 0.0),
        }
    }

    /// Skips lives that [`Lives::drawn_ahead`] has returned.
    #[inline]
    pub(super) fn skip(&mut self, lives: usize) {
        self.thresholds.used += lives;
    }

    /// x_s ~ P_c conditional on x_s > `stretch`.
    #[cold]
    fn threshold_above(&mut self, stretch: f64) -> f64 {
        // Rejection is fast if most thresholds are above the stretch. Inversion is as exact, and bounds the
        // time if they are not.
        let drawn = (0..TRIES).map(|_| self.thresholds.next()).find(|&threshold| threshold > stretch);
        drawn.unwrap_or_else(|| {
            let law = &self.thresholds.law;
            law.upper_quantile(law.survival(stretch) * self.conditional.uniform())
        })
    }

    /// r ~ R conditional on r < `threshold`.
    fn stretch_below(&mut self, threshold: f64) -> f64 {
        if let Some(point) = self.point {
            return point;
        }
        let drawn = (0..TRIES).map(|_| self.reforming.next()).find(|&stretch| stretch < threshold);
        drawn.unwrap_or_else(|| {
            let law = &self.reforming.law;
            law.quantile((1.0 - law.survival(threshold.next_down())) * self.conditional.uniform())
        })
    }
}

/// Random numbers of a distribution from a stream, in batches. [`Law::fill`] draws in order, so that the
/// sizes of batches do not change the values.
#[derive(Debug, Clone)]
struct Draws {
    law: SharedLaw,
    stream: Stream,
    batch: [f64; BATCH],
    used: usize,
    filled: usize,
    /// Number of draws that a contact is expected to need, and how many of them are left.
    expected: usize,
    left: usize,
    /// Most values drawn ahead.
    most: usize,
}

impl Draws {
    fn new(law: SharedLaw, stream: Stream, expected: usize, most: usize) -> Self {
        Self { law, stream, batch: [0.0; BATCH], used: 0, filled: 0, expected, left: 0, most }
    }

    /// Goes to the position of a contact in its stream.
    #[inline]
    fn seek(&mut self, index: u64, taken: u64) {
        self.stream.seek(index, taken);
        self.left = self.expected;
        (self.used, self.filled) = (0, 0);
    }

    /// The values drawn and not used yet, at least one.
    #[inline]
    fn ahead(&mut self) -> &[f64] {
        if self.used == self.filled {
            self.refill();
        }
        &self.batch[self.used..self.filled]
    }

    #[inline]
    fn next(&mut self) -> f64 {
        if self.used == self.filled {
            self.refill();
        }
        let value = self.batch[self.used % BATCH];
        self.used += 1;
        value
    }

    #[inline(never)]
    fn refill(&mut self) {
        // As many as the contact is expected to need, then a few at a time: unused numbers cost time.
        self.filled = self.left.clamp(1, self.most);
        self.left = self.left.saturating_sub(self.filled).max(4);
        self.law.fill(&mut self.stream, &mut self.batch[..self.filled]);
        self.used = 0;
    }
}
