//! The contacts of an ensemble under one slider that moves back and forth, from break to break.

mod mark;
mod state;

use std::ops::Range;

use mark::ReturnMark;

use super::Ensemble;
use super::lives::Lives;
use super::queue::{Queue, QueuedContact, SLICE};
use super::sums::Sums;
use crate::energy::ContactEnergies;
use crate::monitor::{Aside, Monitor, fits, report};
use crate::numerics::compensated::Compensated;
use crate::parallel;
use crate::population::{Direction, Population, Response, SmoothInterval};
use crate::rate_dependent::ContactsState;
use crate::{Error, Result};

/// Bytes per contact: in the queue, in another order meanwhile, and among free contacts or those broken in a
/// slip.
const BYTES: u64 = 4 * size_of::<QueuedContact>() as u64;

/// Contacts drawn together by one thread.
const CHUNK: usize = 1 << 12;

/// Distance in mean thresholds after which sums are recomputed: so rarely that it costs nothing, so often
/// that cancellation takes at most two digits.
const SPAN: f64 = 8.0;

/// The contacts of an ensemble that move together.
///
/// Under a slider that only moves forward they have the same lives as in [`Ensemble::pull`]. When it turns
/// back, stretches shrink; a contact also breaks at −x_s, and then re-forms at −r, r ~ R. Contacts break
/// simultaneously if they do so at exactly the same position; positions that differ by rounding are
/// different.
///
/// A break takes a few memory accesses, nearly independent of the number of contacts; so does unloading
/// without breaks. Breaks during unloading and [`Population::reset`] visit all contacts, each of which takes
/// 64 bytes, and about as much again meanwhile.
///
/// Limits: positions are double-precision numbers, so that at X stretches are right to 1e-16 X; sums over
/// contacts are right to 1e-12 after any number of breaks. Random numbers of a contact repeat after some 10⁹
/// lives.
#[derive(Debug, Clone)]
pub struct EnsemblePopulation {
    lives: Lives,
    size: usize,
    /// Where contacts last broke. Everything below is seen in that direction, in which positions rise.
    facing: Direction,
    /// Where the last move went.
    moved: Direction,
    position: f64,
    queue: Queue,
    /// No contact breaks on the way back to here.
    back: f64,
    /// Contacts that carry nothing.
    free: Vec<QueuedContact>,
    held: bool,
    sums: Sums,
    span: f64,
    lost: Compensated,
    breaks: u64,
    marked: Option<ReturnMark>,
    /// Ratio of real contacts to simulated ones, times the unit of stiffness.
    scale: f64,
}

impl Ensemble {
    /// Refuses populations that take more than `memory` bytes, or have more contacts than 32 bits count.
    ///
    /// # Errors
    /// [`Error::TooLarge`] and [`Error::Invalid`], naming their size.
    pub fn population_fits(&self, memory: u64) -> Result<()> {
        let what = format!("a population of {} contacts", self.size);
        fits("size", what, (self.size as u64).saturating_mul(BYTES), memory)?;
        if u32::try_from(self.size).is_err() {
            let expected = format!("up to {} contacts of a population", u32::MAX);
            return Err(Error::invalid("size", expected, self.size));
        }
        Ok(())
    }

    /// The contacts at X = 0, to be moved. In a relaxed start, contacts at or above their thresholds have broken.
    ///
    /// # Errors
    /// Time-dependent contacts; more of them than fit in the memory that the monitor allows.
    pub fn population(&self) -> Result<EnsemblePopulation> {
        self.population_with(&mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::population`]; stopped by the monitor.
    pub fn population_with(&self, monitor: &mut dyn Monitor) -> Result<EnsemblePopulation> {
        if let Some(rule) = self.contacts.rules.first() {
            let expected =
                "contacts without time dependence, since a population is moved by displacements, not in time";
            return Err(Error::invalid(rule, expected, "time-dependent contacts"));
        }
        self.population_fits(monitor.memory())?;
        let mut population = EnsemblePopulation {
            lives: Lives::in_any_order(self),
            size: self.size,
            facing: Direction::Forward,
            moved: Direction::Forward,
            position: 0.0,
            queue: Queue::default(),
            back: f64::NEG_INFINITY,
            free: Vec::new(),
            held: false,
            sums: Sums::new(self.contacts.stiffness.clone()),
            span: SPAN * self.contacts.thresholds.mean(),
            lost: Compensated::default(),
            breaks: 0,
            marked: None,
            scale: self.contacts.stiffness.unit() * self.contacts.count / self.size as f64,
        };
        let contacts = fresh(&population.lives, self.size, monitor)?;
        let mut aside = Aside { fraction: 1.0, monitor };
        population.place(contacts, &mut aside)?;
        population.cross(&mut aside)?;
        Ok(population)
    }
}

/// Contacts as they are at X = 0.
fn fresh(lives: &Lives, size: usize, monitor: &mut dyn Monitor) -> Result<Vec<QueuedContact>> {
    let contact = |lives: &mut Lives, index: usize| {
        let life = lives.first(index as u64);
        QueuedContact {
            origin: -life.stretch,
            threshold: life.threshold,
            index: index as u32,
            drawn: lives.drawn(),
        }
    };
    let chunk = |lives: &mut Lives, _, chunk: Range<usize>| {
        chunk.map(|index| contact(lives, index)).collect::<Vec<_>>()
    };
    let mut contacts = Vec::with_capacity(size);
    while contacts.len() < size {
        report(monitor, contacts.len() as f64 / size as f64)?;
        let end = size.min(contacts.len() + SLICE);
        let chunks = (contacts.len()..end).step_by(CHUNK).map(|start| start..end.min(start + CHUNK));
        let drawn = parallel::map_with(chunks.collect(), 1, &|| lives.clone(), &chunk);
        contacts.extend(drawn.into_iter().flatten());
    }
    Ok(contacts)
}

/// Draws the next life of a broken contact, at a position of the slider.
#[inline]
fn reform(contact: &mut QueuedContact, lives: &mut Lives, position: f64) {
    lives.resume(contact.index.into(), contact.drawn, contact.threshold);
    let life = lives.next();
    (contact.origin, contact.threshold) = (position - life.stretch, life.threshold);
    contact.drawn = lives.drawn();
}

impl EnsemblePopulation {
    /// Number of simulated contacts.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Replaces the attached contacts.
    fn place(&mut self, contacts: Vec<QueuedContact>, monitor: &mut dyn Monitor) -> Result<()> {
        self.sums.renew(self.position, [].iter());
        self.back = f64::NEG_INFINITY;
        for (done, slice) in contacts.chunks(SLICE).enumerate() {
            if done > 0 {
                report(monitor, 0.0)?;
            }
            slice.iter().for_each(|contact| self.sums.add(contact));
            self.back = slice.iter().map(QueuedContact::back).fold(self.back, f64::max);
        }
        self.queue = Queue::of(contacts);
        Ok(())
    }

    /// Finds the next break in the backward direction.
    fn find_break_behind(&mut self) {
        self.back = self.queue.iter().map(QueuedContact::back).fold(f64::NEG_INFINITY, f64::max);
    }

    /// Reverses the direction, by mirroring all contacts.
    fn reverse(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        self.facing = self.facing.reversed();
        self.position = -self.position;
        let mut contacts = self.queue.drain(monitor)?;
        for slice in contacts.chunks_mut(SLICE) {
            report(monitor, 0.0)?;
            slice.iter_mut().for_each(|contact| *contact = contact.mirrored());
        }
        self.place(contacts, monitor)
    }

    /// Position of the next break ahead.
    ///
    /// A contact that re-formed within rounding of its threshold breaks at the next representable position.
    fn end(&mut self, monitor: &mut dyn Monitor) -> Result<f64> {
        let end = self.queue.first(monitor)?.map(QueuedContact::end);
        Ok(end.map_or(f64::INFINITY, |end| end.max(self.position.next_up())))
    }

    /// Breaks a contact, and leaves it free.
    #[inline]
    fn detach(&mut self, contact: &QueuedContact) {
        self.sums.remove(contact);
        self.lost.add(self.sums.energy(contact, self.position));
        self.breaks += 1;
        if let Some(mark) = &mut self.marked {
            mark.record(contact, self.facing);
        }
    }

    /// Re-forms the free contacts.
    fn reform_free(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        let (lives, position) = (&mut self.lives, self.position);
        for (done, slice) in self.free.chunks_mut(SLICE).enumerate() {
            if done > 0 {
                report(monitor, 0.0)?;
            }
            if slice.len() < CHUNK || parallel::current_num_threads() == 1 {
                slice.iter_mut().for_each(|contact| reform(contact, lives, position));
                continue;
            }
            let own = || lives.clone();
            // Contacts draw from streams of their own, so that the order of drawing does not matter.
            let each = |lives: &mut Lives, _, chunk: &mut [QueuedContact]| {
                chunk.iter_mut().for_each(|contact| reform(contact, lives, position));
            };
            parallel::map_with(slice.chunks_mut(CHUNK).collect(), 1, &own, &each);
        }
        for (done, contact) in self.free.drain(..).enumerate() {
            if done % SLICE == SLICE - 1 {
                report(monitor, 0.0)?;
            }
            self.lost.add(-self.sums.energy(&contact, position));
            self.sums.add(&contact);
            self.back = self.back.max(contact.back());
            self.queue.push(contact);
        }
        self.free.shrink_to(CHUNK);
        Ok(())
    }
}

impl Population for EnsemblePopulation {
    fn position(&self) -> f64 {
        self.facing.sign() * self.position
    }

    fn smooth_interval(&mut self, direction: Direction, monitor: &mut dyn Monitor) -> Result<SmoothInterval> {
        if direction != self.facing {
            // `back` is a bound for the breaks on unloading. It is computed anew only when it is reached.
            if self.position <= self.back {
                self.find_break_behind();
            }
            if self.position > self.back {
                return Ok(SmoothInterval {
                    length: self.position - self.back,
                    straight: true,
                    breaks: false,
                });
            }
            self.reverse(monitor)?;
        }
        let end = self.end(monitor)?;
        Ok(SmoothInterval { length: end - self.position, straight: true, breaks: end < f64::INFINITY })
    }

    fn ahead(&self, by: f64) -> Response {
        let sign = self.facing.sign();
        let force = self.sums.force(self.position + sign * by);
        Response { force: sign * self.scale * force, tangent: self.scale * self.sums.slope() }
    }

    fn advance(&mut self, by: f64) -> Result<()> {
        if by != 0.0 {
            self.moved = if by > 0.0 { Direction::Forward } else { Direction::Backward };
        }
        let by = by * self.facing.sign();
        // Moves end exactly at the position of a break or at `back`: contacts that break there are
        // found by comparison of equal numbers, without a tolerance.
        self.position = if by < 0.0 {
            (self.position + by).max(self.back)
        } else {
            let end = self.end(&mut ())?;
            if by < end - self.position { self.position + by } else { end }
        };
        // Keeps the base of the sums close, so that moments do not cancel.
        if (self.position - self.sums.base).abs() > self.span {
            self.sums.renew(self.position, self.queue.iter());
        }
        Ok(())
    }

    fn cross(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        while let Some(contact) = self.queue.pop(self.position, monitor)? {
            self.detach(&contact);
            self.free.push(contact);
        }
        if self.held { Ok(()) } else { self.reform_free(monitor) }
    }

    fn reset(&mut self, direction: Direction, monitor: &mut dyn Monitor) -> Result<()> {
        if direction != self.facing {
            self.reverse(monitor)?;
        }
        let mut contacts = self.queue.drain(monitor)?;
        for slice in contacts.chunks(SLICE) {
            report(monitor, 0.0)?;
            slice.iter().for_each(|contact| self.detach(contact));
        }
        contacts.append(&mut self.free);
        self.free = contacts;
        (self.back, self.moved, self.held) = (f64::NEG_INFINITY, direction, false);
        self.reform_free(monitor)
    }

    fn hold(&mut self) -> Result<()> {
        self.held = true;
        Ok(())
    }

    fn release(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        self.held = false;
        // Contacts re-form at +r in the direction of the last move, which the queue has to face for
        // that.
        if self.moved != self.facing && !self.free.is_empty() {
            self.reverse(monitor)?;
        }
        self.reform_free(monitor)
    }

    fn mark(&mut self) {
        let before = self.marked.take();
        self.marked = Some(ReturnMark::of(self, before));
    }

    fn recall(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        match self.marked.take() {
            Some(mark) => mark.restore(self, monitor),
            None => Ok(()),
        }
    }

    fn energies(&self) -> ContactEnergies {
        ContactEnergies {
            sliding: 0.0,
            elastic: self.scale * self.sums.elastic(self.position),
            lost: self.scale * self.lost.value(),
            strengthening: 0.0,
            broken: self.breaks as f64 / self.size as f64,
        }
    }

    fn stretches(&self) -> Option<Vec<f64>> {
        let sign = self.facing.sign();
        Some(self.queue.iter().map(|contact| sign * (self.position - contact.origin)).collect())
    }

    fn copy(&self) -> Box<dyn Population> {
        Box::new(self.clone())
    }

    fn state(&self) -> ContactsState {
        self.kept()
    }

    fn restore(&mut self, state: &ContactsState, _monitor: &mut dyn Monitor) -> Result<()> {
        self.take_up(state)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::contacts::{Contacts, Initial, Start, Stiffness};
    use crate::ensemble::Disorder;
    use crate::law::{Gaussian, Rectangular, SharedLaw};

    /// Sums over all breaks against sums over the contacts there are, to roundings of the latter.
    #[test]
    fn sums_do_not_drift() {
        let thresholds: SharedLaw = Arc::new(Gaussian::new(1.0, 0.2).unwrap());
        let reforming: SharedLaw = Arc::new(Rectangular::new(0.0, 0.2).unwrap());
        let initial = Initial { law: reforming.clone(), start: Start::Conditional };
        let contacts =
            Contacts { stiffness: Stiffness::PerThreshold(1.0), ..Contacts::new(thresholds, reforming) };
        let ensemble = Ensemble::new(contacts, initial, 20_000, 1, Disorder::Annealed).unwrap();
        let mut population = ensemble.population().unwrap();
        population.span = 50.0;
        while population.energies().broken < 45.0 {
            let interval = population.smooth_interval(Direction::Forward, &mut ()).unwrap();
            population.advance(interval.length).unwrap();
            population.cross(&mut ()).unwrap();
        }
        let (position, mut renewed) = (population.position, population.sums.clone());
        renewed.renew(position, population.queue.iter());
        assert!(population.sums.base == 0.0 && renewed.base > 30.0);
        let values = |sums: &Sums| [sums.slope(), sums.force(position), sums.elastic(position)];
        for (sum, fresh) in values(&population.sums).into_iter().zip(values(&renewed)) {
            assert!((sum / fresh - 1.0).abs() < 1e-12, "{sum} {fresh}");
        }
    }
}
