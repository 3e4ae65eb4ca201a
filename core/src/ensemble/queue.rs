//! A priority queue of contacts by the position at which they break: a ladder queue.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::mem;

use serde::{Deserialize, Serialize};

use super::lives::Drawn;
use crate::Result;
use crate::monitor::{Monitor, report};

/// Mean number of contacts on a rung: few enough to be sorted in the first-level cache.
const PER_RUNG: usize = 32;

/// Largest number of rungs: few enough that their ends stay in cache while contacts are distributed.
const RUNGS: usize = 1 << 14;

/// Contacts processed between two reports to a monitor.
pub(super) const SLICE: usize = 1 << 18;

/// A contact between two breaks: its stretch is `position − origin`.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(from = "QueuedNumbers", into = "QueuedNumbers")]
pub(super) struct QueuedContact {
    pub(super) origin: f64,
    pub(super) threshold: f64,
    pub(super) index: u32,
    pub(super) drawn: Drawn,
}

/// A contact as it is kept: without names, of which there would be one for every number.
type QueuedNumbers = (f64, f64, u32, [u32; 3]);

impl From<QueuedNumbers> for QueuedContact {
    fn from((origin, threshold, index, drawn): QueuedNumbers) -> Self {
        Self { origin, threshold, index, drawn: drawn.into() }
    }
}

impl From<QueuedContact> for QueuedNumbers {
    fn from(QueuedContact { origin, threshold, index, drawn }: QueuedContact) -> Self {
        (origin, threshold, index, drawn.into())
    }
}

impl QueuedContact {
    /// Position at which it breaks.
    #[inline]
    pub(super) fn end(&self) -> f64 {
        self.origin + self.threshold
    }

    /// Seen in the opposite direction.
    #[inline]
    pub(super) fn mirrored(self) -> Self {
        Self { origin: -self.origin, ..self }
    }

    /// Position at which it breaks in the backward direction.
    #[inline]
    pub(super) fn back(&self) -> f64 {
        self.origin - self.threshold
    }
}

/// The greater contact breaks first; at the same position the one with the smaller index.
impl Ord for QueuedContact {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        other.end().total_cmp(&self.end()).then(other.index.cmp(&self.index))
    }
}

impl PartialOrd for QueuedContact {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for QueuedContact {
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for QueuedContact {}

/// Contacts by where they break: a ladder queue (W. T. Tang, R. S. M. Goh and I. L.-J. Thng, ACM Trans. Model.
/// Comput. Simul. 15, 175 (2005), doi:10.1145/1103323.1103324) of one ladder.
///
/// What breaks far ahead is unordered; when its turn comes it is thrown onto rungs of equal width, and a rung is
/// ordered when it is reached. By Markov's inequality each throw places half of what is thrown or more, whatever
/// the thresholds, so that a contact is moved a few times in its life. At worst, where all break together, the
/// queue is a heap.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Queue {
    /// The present rung, sorted, next break last.
    near: Vec<QueuedContact>,
    /// Contacts added below the remaining rungs.
    late: BinaryHeap<QueuedContact>,
    rungs: Vec<Vec<QueuedContact>>,
    /// Number of rungs already processed.
    taken: usize,
    ladder: Ladder,
    /// Contacts beyond all rungs.
    beyond: Vec<QueuedContact>,
}

/// Start of the lowest rung, and rungs per length.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Ladder {
    low: f64,
    density: f64,
}

impl Ladder {
    /// The rung of a contact, if it exists.
    #[inline]
    fn rung(self, contact: &QueuedContact) -> usize {
        // The cast saturates: contacts below the ladder belong to its first rung.
        ((contact.end() - self.low) * self.density) as usize
    }
}

impl Queue {
    pub(super) fn of(contacts: Vec<QueuedContact>) -> Self {
        Self { beyond: contacts, ..Self::default() }
    }

    #[inline]
    pub(super) fn push(&mut self, contact: QueuedContact) {
        let rung = self.ladder.rung(&contact);
        // The rung has been sorted already: the contact goes to the heap.
        if rung < self.taken {
            self.late.push(contact);
        } else if let Some(contacts) = self.rungs.get_mut(rung) {
            contacts.push(contact);
        } else {
            self.beyond.push(contact);
        }
    }

    /// The contact that breaks first.
    #[inline]
    pub(super) fn first(&mut self, monitor: &mut dyn Monitor) -> Result<Option<&QueuedContact>> {
        // Contacts added late are kept in a heap of their own; the next one is the first of both.
        if self.near.is_empty() {
            self.descend(monitor)?;
        }
        Ok(self.near.last().max(self.late.peek()))
    }

    /// Removes the contact that breaks first, if it does so up to `position`.
    #[inline]
    pub(super) fn pop(&mut self, position: f64, monitor: &mut dyn Monitor) -> Result<Option<QueuedContact>> {
        if self.first(monitor)?.is_none_or(|contact| contact.end() > position) {
            return Ok(None);
        }
        Ok(if self.late.peek() > self.near.last() { self.late.pop() } else { self.near.pop() })
    }

    /// Number of contacts.
    pub(super) fn len(&self) -> usize {
        let rungs = self.rungs.iter().map(Vec::len).sum::<usize>();
        self.near.len() + self.late.len() + rungs + self.beyond.len()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &QueuedContact> {
        self.near.iter().chain(&self.late).chain(self.rungs.iter().flatten()).chain(&self.beyond)
    }

    /// Removes all contacts, in no order.
    pub(super) fn drain(&mut self, monitor: &mut dyn Monitor) -> Result<Vec<QueuedContact>> {
        let mut queue = mem::take(self);
        // `beyond` holds most contacts of a queue that has just been filled.
        let mut contacts = queue.beyond;
        let rest = queue.near.len() + queue.late.len() + queue.rungs.iter().map(Vec::len).sum::<usize>();
        contacts.reserve_exact(rest);
        contacts.append(&mut queue.near);
        contacts.extend(queue.late);
        let mut reported = contacts.len();
        for rung in &mut queue.rungs {
            contacts.append(rung);
            if contacts.len() > reported + SLICE {
                reported = contacts.len();
                report(monitor, 0.0)?;
            }
        }
        Ok(contacts)
    }

    /// Takes the next rung that is not empty, unless a late contact breaks before.
    #[cold]
    fn descend(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        while self.near.is_empty() && self.late.is_empty() {
            if let Some(rung) = self.rungs.get_mut(self.taken) {
                self.near = mem::take(rung);
                // Equal elements do not occur: contacts that break together are ordered by their
                // index. The order is hence unique, and so are the sums made in it.
                self.near.sort_unstable();
                self.taken += 1;
            } else if self.beyond.is_empty() {
                break;
            } else {
                self.raise(monitor)?;
            }
        }
        Ok(())
    }

    /// Distributes the contacts beyond onto new rungs, from the first break to as far above the mean as that
    /// is above the first.
    fn raise(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        let (mut low, mut sum) = (f64::INFINITY, 0.0);
        sliced(&self.beyond, monitor, |contact| {
            low = low.min(contact.end());
            sum += contact.end();
        })?;
        // Markov's inequality: at least half of the contacts break before twice the mean distance.
        let rungs = (self.beyond.len() / PER_RUNG).clamp(1, RUNGS);
        let width = 2.0 * (sum / self.beyond.len() as f64 - low) / rungs as f64;
        // Infinite for contacts that all break together; the first is then on the lowest rung all the same.
        self.ladder = Ladder { low, density: width.max(0.0).recip() };
        self.taken = 0;
        // Counting first gives each rung its exact capacity: no reallocation while millions of
        // contacts are moved.
        let mut counts = vec![0; rungs];
        let rung = |contact: &QueuedContact| self.ladder.rung(contact);
        sliced(&self.beyond, monitor, |contact| {
            if let Some(count) = counts.get_mut(rung(contact)) {
                *count += 1;
            }
        })?;
        self.rungs.clear();
        self.rungs.extend(counts.into_iter().map(Vec::with_capacity));
        let thrown = self.beyond.extract_if(.., |contact| rung(contact) < rungs);
        for (done, contact) in thrown.enumerate() {
            if done % SLICE == SLICE - 1 {
                report(monitor, 0.0)?;
            }
            self.rungs[rung(&contact)].push(contact);
        }
        Ok(())
    }
}

/// Visits contacts, asking the monitor after every slice.
fn sliced(
    contacts: &[QueuedContact],
    monitor: &mut dyn Monitor,
    visit: impl FnMut(&QueuedContact),
) -> Result<()> {
    let mut visit = visit;
    for slice in contacts.chunks(SLICE) {
        slice.iter().for_each(&mut visit);
        if slice.len() == SLICE {
            report(monitor, 0.0)?;
        }
    }
    Ok(())
}
