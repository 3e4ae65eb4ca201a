//! The pull of an ensemble by a rigid slider, in parallel and yet the same bits on any number of threads.

use std::ops::Range;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::Ensemble;
use super::sweep::{Chunk, Sweep};
use super::tally::{Different, Equal, HistogramGrid, Ruler, TallyCell, forces};
use crate::contacts::Stiffness;
use crate::monitor::{Aside, Monitor, fits, report};
use crate::{Error, Result};

/// Most chunks of contacts between two reports to the monitor.
const ROUND: usize = 64;

/// Time between two reports to the monitor, if a chunk takes no longer.
const PERIOD: Duration = Duration::from_millis(50);

/// Breaks that take less than that, whatever the law.
const QUICK: usize = 2_000_000;

/// Breaks of a chunk between two reports, and what it may take for them to be as quick as they can be.
const PART: usize = 500_000;
const CACHE: usize = 16 << 20;

/// Bytes that a round of chunks may take, if it is more than one chunk.
const ROUND_BYTES: usize = 512 << 20;

/// Where to record the distribution of stretches.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Snapshots {
    /// Positions X, rising, none above the last position of the pull.
    pub positions: Vec<f64>,
    /// Edges of the bins of stretch, rising; a stretch at an edge counts below it, at the first above it.
    pub edges: Vec<f64>,
}

/// The outcome of a pull.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsemblePull {
    /// Force at each position, scaled to the number of real contacts; after the breaks at the position.
    pub force: Vec<f64>,
    /// Its standard error, from the scatter of single contacts; not finite for an ensemble of one.
    ///
    /// That of the ensemble: N_c real contacts scatter by √(size/N_c) of it.
    pub error: Vec<f64>,
    /// Breaks up to the last position, those of a relaxed start included.
    pub breaks: u64,
    /// Contacts in each bin at each snapshot.
    pub histograms: Vec<Vec<u64>>,
    pub(super) edges: Vec<f64>,
    pub(super) size: usize,
}

impl Snapshots {
    /// One histogram for each position.
    pub(super) fn histograms(&self) -> Vec<Vec<u64>> {
        vec![vec![0; self.edges.len().saturating_sub(1)]; self.positions.len()]
    }

    /// Counts a contact of this stretch.
    pub(super) fn count(&self, stretch: f64, histogram: &mut [u64]) {
        // Just re-formed contacts may lie below 0 by rounding.
        let stretch = stretch.max(0.0);
        let above = self.edges.partition_point(|&edge| edge < stretch);
        if let Some(bin) = histogram.get_mut(above.max(1) - 1)
            && stretch >= self.edges[0]
        {
            *bin += 1;
        }
    }

    /// Checks them for a pull through `positions`, and gives the last of these.
    pub(super) fn check(&self, positions: &[f64]) -> Result<f64> {
        rising("positions", positions)?;
        let last = *positions.last().ok_or_else(|| Error::invalid("positions", "at least one", "none"))?;
        rising("snapshots", &self.positions)?;
        rising("edges", &self.edges)?;
        match self.positions.last().filter(|&&x| x > last) {
            Some(beyond) => Err(Error::invalid("snapshots", format!("positions up to {last}"), beyond)),
            None => Ok(last),
        }
    }
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
    /// Pulls the slider through `positions` X ≥ 0, rising, and takes `snapshots` on the way.
    ///
    /// # Errors
    /// Time-dependent contacts; positions or edges that do not rise, or are not finite; a job too big; stopped by `monitor`.
    pub fn pull(
        &self,
        positions: &[f64],
        snapshots: &Snapshots,
        monitor: &mut dyn Monitor,
    ) -> Result<EnsemblePull> {
        if let Some(rule) = self.rule_of_time() {
            return Err(Error::invalid(
                "velocity",
                format!("a velocity, since {rule} makes contacts time-dependent"),
                "none",
            ));
        }
        snapshots.check(positions)?;
        match self.contacts.stiffness {
            Stiffness::Equal(stiffness) => self.run::<Equal>(stiffness, positions, snapshots, monitor),
            Stiffness::PerThreshold(factor) => self.run::<Different>(factor, positions, snapshots, monitor),
        }
    }

    fn run<C: TallyCell>(
        &self,
        stiffness: f64,
        positions: &[f64],
        snapshots: &Snapshots,
        monitor: &mut dyn Monitor,
    ) -> Result<EnsemblePull> {
        let plan = self.plan::<C>(positions, snapshots, monitor.memory())?;
        let (grid, ruler) = (HistogramGrid::new(positions), Ruler::of(positions));
        let sweep = Sweep { ensemble: self, grid, ruler, positions, snapshots };
        report(monitor, 0.0)?;
        let mut total = sweep.nothing::<C>();
        report(monitor, 0.0)?;
        let (mut done, mut round) = (0, plan.first());
        while done < self.size {
            let begun = Instant::now();
            let end = self.size.min(done.saturating_add(plan.chunk * round));
            let starts: Vec<usize> = (done..end).step_by(plan.chunk).collect();
            let chunk = |&start: &usize| (start..end.min(start + plan.chunk), sweep.nothing());
            let mut chunks: Vec<(Range<usize>, Chunk<C>)> = starts.par_iter().map(chunk).collect();
            let mut aside = Aside { fraction: done as f64 / self.size as f64, monitor };
            report(&mut aside, 0.0)?;
            sweep.fill(&mut chunks, &plan, &mut aside)?;
            // Summed in the order of contacts, whichever thread was first.
            for (_, chunk) in &chunks {
                total.merge(chunk);
                report(&mut aside, 0.0)?;
            }
            done = end;
            report(monitor, done as f64 / self.size as f64)?;
            round = plan.next(round, begun.elapsed());
        }
        let scale = stiffness * self.contacts.count;
        let mut aside = Aside { fraction: 1.0, monitor };
        let (force, error) = forces(&total.cells, positions, self.size, scale, &mut aside)?;
        let Chunk { histograms, breaks, .. } = total;
        Ok(EnsemblePull { force, error, breaks, histograms, edges: snapshots.edges.clone(), size: self.size })
    }

    /// Chunks with so many breaks that merging them costs little, so few that there is one for each core.
    fn plan<C: TallyCell>(&self, positions: &[f64], snapshots: &Snapshots, memory: u64) -> Result<Plan> {
        let bins = snapshots.edges.len() * snapshots.positions.len();
        let bytes = positions.len() * size_of::<C>() + bins * size_of::<u64>();
        let round = (ROUND_BYTES / bytes).clamp(1, ROUND);
        // A round, the sums over all rounds, and what is made of them.
        let needed = (round + 1) * bytes + positions.len() * size_of::<[f64; 2]>();
        let what = format!("an ensemble at {} positions", positions.len());
        fits("pull.points", what, needed as u64, memory)?;
        let expected = self.expected_breaks(positions[positions.len() - 1]);
        let least = (bytes as f64).max(20_000.0);
        let breaks = (expected * self.size as f64 / ROUND as f64).clamp(least, least.max(1e6));
        let chunk = (breaks / expected).ceil() as usize;
        let quick = if bytes > CACHE { PART / 8 } else { PART };
        let part = (quick as f64 / expected).ceil() as usize;
        Ok(Plan { chunk, part, round, expected: expected as usize })
    }

    /// Rough number of breaks of a contact on the way to `distance`, by which the work is cut up.
    fn expected_breaks(&self, distance: f64) -> f64 {
        let mean = self.contacts.thresholds.mean();
        let rise = (mean - self.contacts.reforming.mean()).max(0.1 * mean);
        1.0 + distance / rise
    }
}

impl Sweep<'_> {
    /// Adds to each chunk the contacts it still lacks, part by part.
    fn fill<C: TallyCell>(
        &self,
        chunks: &mut [(Range<usize>, Chunk<C>)],
        plan: &Plan,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        while chunks.iter().any(|(left, _)| !left.is_empty()) {
            report(monitor, 0.0)?;
            chunks.par_iter_mut().for_each(|(left, chunk)| {
                let next = left.end.min(left.start + plan.part);
                self.add(left.start..next, plan.expected, chunk);
                left.start = next;
            });
        }
        Ok(())
    }
}

/// How the work is cut up: nothing of it depends on the machine or on threads.
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

    /// Chunks of the next round, after one of `round` chunks that took `elapsed`; no result depends on it.
    fn next(&self, round: usize, elapsed: Duration) -> usize {
        match elapsed {
            short if short < PERIOD / 2 => self.possible(2 * round),
            long if long > PERIOD => self.possible(round / 2),
            _ => round,
        }
    }

    /// At least one chunk for each thread.
    fn possible(&self, round: usize) -> usize {
        round.max(rayon::current_num_threads()).min(self.round)
    }
}

/// Whether values are finite, not negative and never fall.
pub(super) fn rising(key: &str, values: &[f64]) -> Result<()> {
    let expected = "finite values that rise from 0 or above";
    if let Some(bad) = values.iter().find(|x| !x.is_finite() || **x < 0.0) {
        return Err(Error::invalid(key, expected, bad));
    }
    match values.windows(2).find(|pair| pair[0] > pair[1]) {
        Some(pair) => Err(Error::invalid(key, expected, format!("{} before {}", pair[0], pair[1]))),
        None => Ok(()),
    }
}
