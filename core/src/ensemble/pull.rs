//! The pull of an ensemble by a rigid slider, in parallel, with the same bits on any number of threads.

use std::ops::Range;
use std::time::Duration;

use super::Ensemble;
use super::snapshots::Snapshots;
use super::sweep::{Chunk, ContactPull};
use super::tally::{Different, Equal, PositionGrid, TallyCell, UniformGrid, forces};
use crate::monitor::{Aside, Monitor, fits, report};
use crate::parallel;
use crate::{Error, Result};

/// Most chunks of contacts between two reports to the monitor.
const ROUND: usize = 64;

/// Time between two reports to the monitor, if a chunk takes no longer.
const PERIOD: Duration = Duration::from_millis(50);

/// Number of breaks that take less than that, for any distribution.
const QUICK: usize = 2_000_000;

/// Breaks of a chunk between two reports, and the memory of a chunk for which breaks are fastest.
const PART: usize = 500_000;
const CACHE: usize = 16 << 20;

/// Memory of a round of more than one chunk.
const ROUND_BYTES: usize = 512 << 20;

/// The outcome of a pull.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsemblePull {
    /// Force at each position, scaled to the number of real contacts, after the breaks at the position.
    pub force: Vec<f64>,
    /// Its standard error, from the variance over contacts; not finite for an ensemble of one.
    ///
    /// It is that of the ensemble: N_c real contacts have √(size/N_c) of it.
    pub error: Vec<f64>,
    /// Breaks up to the last position, those of a relaxed start included.
    pub breaks: u64,
    /// Contacts in each bin at each snapshot.
    pub histograms: Vec<Vec<u64>>,
    pub(super) edges: Vec<f64>,
    pub(super) size: usize,
}

impl EnsemblePull {
    /// Stretch density in each bin, per length, averaged over a range of snapshots.
    ///
    /// # Panics
    /// If the range reaches past the last snapshot.
    #[must_use]
    pub fn stretch_density(&self, snapshots: Range<usize>) -> Vec<f64> {
        let contacts = (self.size * snapshots.len()) as f64;
        let histograms = &self.histograms[snapshots];
        let density = |(bin, edges): (usize, &[f64])| {
            let count: u64 = histograms.iter().map(|h| h[bin]).sum();
            count as f64 / (contacts * (edges[1] - edges[0]))
        };
        self.edges.windows(2).enumerate().map(density).collect()
    }
}

impl Ensemble {
    /// Pulls the slider through rising `positions` X ≥ 0.
    ///
    /// # Errors
    /// Time-dependent contacts; positions that do not rise, or are not finite; a job too big.
    pub fn pull(&self, positions: &[f64]) -> Result<EnsemblePull> {
        self.pull_with(positions, &Snapshots::default(), &mut ())
    }

    /// The same with `snapshots` on the way, watched by a monitor.
    ///
    /// # Errors
    /// As [`Self::pull`]; stopped by the monitor.
    pub fn pull_with(
        &self,
        positions: &[f64],
        snapshots: &Snapshots,
        monitor: &mut dyn Monitor,
    ) -> Result<EnsemblePull> {
        if let Some(rule) = self.contacts.rules.first() {
            return Err(Error::invalid(
                "velocity",
                format!("a velocity, since {rule} makes contacts time-dependent"),
                "none",
            ));
        }
        snapshots.check(positions)?;
        if self.contacts.stiffness.is_equal() {
            self.run::<Equal>(positions, snapshots, monitor)
        } else {
            self.run::<Different>(positions, snapshots, monitor)
        }
    }

    fn run<C: TallyCell>(
        &self,
        positions: &[f64],
        snapshots: &Snapshots,
        monitor: &mut dyn Monitor,
    ) -> Result<EnsemblePull> {
        let plan = self.plan::<C>(positions, snapshots, monitor.memory())?;
        let (grid, uniform) = (PositionGrid::new(positions), UniformGrid::of(positions));
        let table = self.contacts.stiffness.table();
        let sweep = ContactPull { ensemble: self, grid, uniform, positions, snapshots, table };
        report(monitor, 0.0)?;
        let mut total = sweep.nothing::<C>();
        report(monitor, 0.0)?;
        let (mut done, mut round) = (0, plan.first());
        while done < self.size {
            let begun = monitor.clock();
            let end = self.size.min(done.saturating_add(plan.chunk * round));
            let starts: Vec<usize> = (done..end).step_by(plan.chunk).collect();
            let chunk = |_, start: usize| (start..end.min(start + plan.chunk), sweep.nothing());
            let mut chunks: Vec<(Range<usize>, Chunk<C>)> = parallel::map(starts, &chunk);
            let mut aside = Aside { fraction: done as f64 / self.size as f64, monitor };
            report(&mut aside, 0.0)?;
            sweep.fill(&mut chunks, &plan, &mut aside)?;
            // Summed in the order of contacts, for any number of threads.
            for (_, chunk) in &chunks {
                total.merge(chunk);
                report(&mut aside, 0.0)?;
            }
            done = end;
            report(monitor, done as f64 / self.size as f64)?;
            round = plan.next(round, monitor.clock().saturating_sub(begun));
        }
        let scale = self.contacts.stiffness.unit() * self.contacts.count;
        let mut aside = Aside { fraction: 1.0, monitor };
        let (force, error) = forces(&total.cells, positions, self.size, scale, &mut aside)?;
        let Chunk { histograms, breaks, .. } = total;
        Ok(EnsemblePull { force, error, breaks, histograms, edges: snapshots.edges.clone(), size: self.size })
    }

    /// Chunks with so many breaks that merging them is cheap, but one for each core at least.
    ///
    /// # Errors
    /// More bytes than allowed; more breaks of a contact than can be counted.
    fn plan<C: TallyCell>(&self, positions: &[f64], snapshots: &Snapshots, memory: u64) -> Result<Plan> {
        /// Breaks of a contact, which are counted without rounding.
        const MOST: f64 = 1e15;
        let bins = snapshots.edges.len() * snapshots.positions.len();
        let bytes = positions.len() * size_of::<C>() + bins * size_of::<u64>();
        let round = (ROUND_BYTES / bytes).clamp(1, ROUND);
        // A round, the sums over all rounds, and the results.
        let needed = (round + 1) * bytes + positions.len() * size_of::<[f64; 2]>();
        let what = format!("an ensemble at {} positions", positions.len());
        fits("positions", what, needed as u64, memory)?;
        let last = positions[positions.len() - 1];
        let expected = self.expected_breaks(last);
        if expected > MOST {
            return Err(Error::invalid(
                "positions",
                format!("fewer than {MOST:.0e} breaks of a contact"),
                last,
            ));
        }
        let least = (bytes as f64).max(20_000.0);
        // A chunk has its own sums at all positions. With at least as many breaks as it has bytes,
        // merging them costs little beside the breaks.
        let breaks = (expected * self.size as f64 / ROUND as f64).clamp(least, least.max(1e6));
        let chunk = (breaks / expected).ceil() as usize;
        let quick = if bytes > CACHE { PART / 8 } else { PART };
        let part = (quick as f64 / expected).ceil() as usize;
        Ok(Plan { chunk, part, round, expected: expected as usize })
    }

    /// Rough number of breaks of a contact over `distance`, for dividing the work.
    fn expected_breaks(&self, distance: f64) -> f64 {
        let mean = self.contacts.thresholds.mean();
        let rise = (mean - self.contacts.reforming.mean()).max(0.1 * mean);
        1.0 + distance / rise
    }
}

impl ContactPull<'_> {
    /// Adds the remaining contacts to each chunk, part by part.
    fn fill<C: TallyCell>(
        &self,
        chunks: &mut [(Range<usize>, Chunk<C>)],
        plan: &Plan,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        while chunks.iter().any(|(left, _)| !left.is_empty()) {
            report(monitor, 0.0)?;
            parallel::map(chunks.iter_mut().collect(), &|_, (left, chunk): &mut (Range<usize>, Chunk<C>)| {
                let next = left.end.min(left.start + plan.part);
                self.add(left.start..next, plan.expected, chunk);
                left.start = next;
            });
        }
        Ok(())
    }
}

/// Division of the work; it does not depend on the machine or the number of threads.
struct Plan {
    /// Contacts in a chunk.
    chunk: usize,
    /// Contacts of a chunk between two reports to the monitor.
    part: usize,
    /// Most chunks in a round.
    round: usize,
    /// Draws that a contact is expected to need.
    expected: usize,
}

impl Plan {
    /// Chunks of the first round.
    fn first(&self) -> usize {
        self.possible(QUICK / (self.chunk * self.expected.max(1)))
    }

    /// Number of chunks of the next round, after one of `round` chunks that took `elapsed`; no result depends
    /// on it.
    fn next(&self, round: usize, elapsed: Duration) -> usize {
        match elapsed {
            short if short < PERIOD / 2 => self.possible(2 * round),
            long if long > PERIOD => self.possible(round / 2),
            _ => round,
        }
    }

    /// At least one chunk for each thread.
    fn possible(&self, round: usize) -> usize {
        round.max(parallel::current_num_threads()).min(self.round)
    }
}
