//! The lives of one contact after another: where each begins and at which stretch it ends.

use super::{Disorder, Ensemble};
use crate::contacts::Start;
use crate::law::Law;
use crate::random::{Purpose, Stream};

/// Draws that may miss a condition before the law is inverted instead; either way the law is exact.
const TRIES: usize = 16;

/// Most values drawn ahead: enough to hide the cost of a call through the trait.
const BATCH: usize = 64;

/// A life: the stretch at which a contact forms, and the one at which it breaks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Life {
    pub(super) stretch: f64,
    pub(super) threshold: f64,
}

/// The lives of the contacts of an ensemble.
pub(super) struct Lives<'a> {
    ensemble: &'a Ensemble,
    index: u64,
    thresholds: Draws<'a>,
    reforming: Draws<'a>,
    /// R, if it is a single point, where nothing need be drawn.
    point: Option<f64>,
    /// The threshold of this contact, if it is quenched.
    quenched: Option<f64>,
    conditional: Stream,
}

impl<'a> Lives<'a> {
    /// For contacts of whom each is expected to break `expected` times.
    pub(super) fn new(ensemble: &'a Ensemble, expected: usize) -> Self {
        let contacts = &ensemble.contacts;
        let atoms = contacts.reforming.atoms();
        let draws = |law| Draws::new(law, Stream::new(0, Purpose::Thresholds, 0), expected);
        Self {
            ensemble,
            index: 0,
            thresholds: draws(contacts.thresholds.as_ref()),
            reforming: draws(contacts.reforming.as_ref()),
            point: atoms.first().filter(|a| a.weight == 1.0).map(|a| a.position),
            quenched: None,
            conditional: Stream::new(0, Purpose::Conditional, 0),
        }
    }

    /// Turns to contact number `index`, and gives its life at X = 0.
    pub(super) fn first(&mut self, index: u64) -> Life {
        let Ensemble { seed, disorder, ref initial, .. } = *self.ensemble;
        let stream = |purpose| Stream::new(seed, purpose, index);
        let (purpose, ahead) = match disorder {
            Disorder::Annealed => (Purpose::Thresholds, self.thresholds.expected),
            Disorder::Quenched => (Purpose::QuenchedThresholds, 1),
        };
        self.index = index;
        self.thresholds.restart(stream(purpose), ahead);
        self.reforming.restart(stream(Purpose::Reforming), self.reforming.expected);
        self.conditional = stream(Purpose::Conditional);
        self.quenched = None;
        let mut stretch = [0.0];
        initial.law.fill(&mut stream(Purpose::Initial), &mut stretch);
        let threshold = match initial.start {
            Start::Conditional => self.threshold_above(stretch[0]),
            Start::Relaxed => self.thresholds.next(),
        };
        if disorder == Disorder::Quenched {
            self.quenched = Some(threshold);
        }
        Life { stretch: stretch[0], threshold }
    }

    /// The life after a break.
    #[inline]
    pub(super) fn next(&mut self) -> Life {
        if let Some(threshold) = self.quenched {
            return Life { stretch: self.stretch_below(threshold), threshold };
        }
        let stretch = self.point.unwrap_or_else(|| self.reforming.next());
        let threshold = self.thresholds.next();
        let threshold = if threshold > stretch { threshold } else { self.threshold_above(stretch) };
        Life { stretch, threshold }
    }

    /// Thresholds drawn ahead and the stretch at which all contacts re-form, if that is a single point:
    /// the lives that [`Lives::next`] will give, as long as the thresholds are above the stretch.
    #[inline]
    pub(super) fn plain(&mut self) -> (&[f64], f64) {
        match (self.point, self.quenched) {
            (Some(stretch), None) => (self.thresholds.ahead(), stretch),
            _ => (&[], 0.0),
        }
    }

    /// Passes over lives that [`Lives::plain`] has shown.
    #[inline]
    pub(super) fn skip(&mut self, lives: usize) {
        self.thresholds.used += lives;
    }

    /// x_s ~ P_c conditional on x_s > `stretch`.
    #[cold]
    fn threshold_above(&mut self, stretch: f64) -> f64 {
        let drawn = (0..TRIES).map(|_| self.thresholds.next()).find(|&threshold| threshold > stretch);
        drawn.unwrap_or_else(|| {
            let law = self.thresholds.law;
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
            let law = self.reforming.law;
            law.quantile((1.0 - law.survival(threshold.next_down())) * self.conditional.uniform())
        })
    }
}

/// Draws of a law from a stream, in batches. [`Law::fill`] takes draws in order, so that the sizes of
/// batches do not change the values.
struct Draws<'a> {
    law: &'a dyn Law,
    stream: Stream,
    batch: [f64; BATCH],
    used: usize,
    filled: usize,
    /// Draws a contact is expected to need; how many of them are still to be drawn.
    expected: usize,
    left: usize,
}

impl<'a> Draws<'a> {
    fn new(law: &'a dyn Law, stream: Stream, expected: usize) -> Self {
        Self { law, stream, batch: [0.0; BATCH], used: 0, filled: 0, expected, left: 0 }
    }

    fn restart(&mut self, stream: Stream, expected: usize) {
        (self.stream, self.left) = (stream, expected);
        (self.used, self.filled) = (0, 0);
    }

    /// What has been drawn and not been used, at least one draw.
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
        self.filled = self.left.clamp(1, BATCH);
        self.left = self.left.saturating_sub(self.filled).max(4);
        self.law.fill(&mut self.stream, &mut self.batch[..self.filled]);
        self.used = 0;
    }
}
