//! Contacts whose number is proportional to a normal load that steps.
//!
//! Contacts are independent of each other. With N_c contacts at the start and the relative load λ(t), those that form at a rise of the
//! load, at the time t_j, are a group of their own. Each group is followed from its formation on, as if it were alone, and
//!
//! F(t) = n_0(t) F_0(t) + Σ_j n_j(t) F_1(t; t_j),
//!
//! where F_0 is the force of N_c contacts that begin as those at the start, and F_1(t; t_j) that of N_c contacts that have just formed
//! at t_j, with stretches of R. At a rise from λ to λ' the new group has n_j = λ' − λ. At a fall contacts of all groups are lost at random:
//! every n is multiplied by λ'/λ. Hence Σ n = λ.

use super::{Trace, Transport};
use crate::contacts::{Contacts, Initial};
use crate::history::{LoadStep, LoadedHistory};
use crate::monitor::{Monitor, Part};
use crate::{Error, Result};

/// Contacts that formed together.
struct ContactGroup {
    transport: Transport,
    /// Index of the piece of the motion at whose beginning they form.
    piece: usize,
    /// Their number over that of all contacts at the start, when they form.
    share: f64,
}

/// Readings of a group at the times of a trace.
struct GroupReadings {
    trace: Trace,
    /// The share of the group at each reading of the whole trace, 0 before it forms.
    share: Vec<f64>,
    /// The reading of `trace` at each reading of the whole trace from the first one of the group on.
    place: Vec<usize>,
    /// Index of the first reading of the whole trace that has the group.
    first: usize,
}

impl Transport {
    /// Contacts that have all just formed, at the age 0 and with stretches of R: those that a rise of the normal load adds.
    ///
    /// # Errors
    /// As [`Transport::new_with`].
    pub fn fresh(contacts: &Contacts, tolerance: f64, monitor: &mut dyn Monitor) -> Result<Self> {
        let initial = Initial::new(contacts.reforming.clone());
        Self::new_with(contacts.clone(), &initial, tolerance, monitor)
    }

    /// Follows a motion that begins at the present time under a normal load that steps. The number of contacts is proportional to the
    /// load. Where the load rises by a factor f, new contacts form at once as those of `fresh`, which has as many contacts as this one;
    /// the old ones, attached and free, are 1/f of all. Where it falls contacts are lost at random. The time that it takes is
    /// proportional to the number of rises.
    ///
    /// At a time at which the load steps the trace has two readings, before and after the step, both with the velocity after it.
    ///
    /// # Errors
    /// As [`Transport::follow`]; contacts that share one distribution of thresholds; stopped by the monitor.
    pub fn follow_under_load(
        self,
        fresh: &Self,
        motion: &LoadedHistory,
        times: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Trace> {
        if self.model.table().is_some() {
            let expected =
                "none under a normal load that steps: contacts would not be independent of each other";
            return Err(Error::invalid("contacts.ageing.mean_field", expected, "one"));
        }
        motion.history().check_times(times)?;
        let (begun, origin) = (self.time, self.position);
        let readings = motion.readings(times);
        let groups = groups(self, fresh, motion);
        // A group takes time as long as it is there.
        let whole = motion.history().duration();
        let lasting = |group: &ContactGroup| whole - motion.history().knots()[group.piece].0;
        let (all, mut done) = (groups.iter().map(lasting).sum::<f64>(), 0.0);
        let mut found = Vec::new();
        for group in groups {
            let part = lasting(&group) / all;
            found.push(group.follow(motion, times, &readings, &mut Part::new(monitor, done, part))?);
            done += part;
        }
        let at = |&(time, load): &(f64, f64)| {
            let velocity = motion.history().pieces()[motion.history().piece_at(time)].velocity;
            (begun + time, origin + motion.history().position(time), velocity, load)
        };
        Ok(sum(&found, readings.iter().map(at)))
    }
}

/// All groups of contacts along a motion, in the order of their formation.
fn groups(start: Transport, fresh: &Transport, motion: &LoadedHistory) -> Vec<ContactGroup> {
    let rise = |step: LoadStep| ContactGroup {
        transport: fresh.clone(),
        piece: step.piece,
        share: step.after - step.before,
    };
    let rises = motion.steps().filter(|step| step.after > step.before).map(rise);
    std::iter::once(ContactGroup { transport: start, piece: 0, share: 1.0 }).chain(rises).collect()
}

impl ContactGroup {
    /// Follows the group alone from its formation on. `readings` are the times of the whole trace, twice where the load steps.
    fn follow(
        mut self,
        motion: &LoadedHistory,
        times: &[f64],
        readings: &[(f64, f64)],
        monitor: &mut dyn Monitor,
    ) -> Result<GroupReadings> {
        let (history, begin) = (motion.history(), motion.history().knots()[self.piece].0);
        let later = history.pieces_from(self.piece)?;
        let own: Vec<f64> = times.iter().copied().filter(|time| *time >= begin).collect();
        let asked = own.iter().map(|&time| history.time_in(&later, |piece| piece - self.piece, time));
        let asked: Vec<f64> = asked.collect();
        let trace = match asked.is_empty() {
            true => Trace::default(),
            false => self.transport.follow_with(&later, &asked, monitor)?,
        };
        let share = self.shares(motion, readings);
        let first = share.iter().position(|share| *share > 0.0).unwrap_or(readings.len());
        let place = readings[first..].iter().map(|reading| own.partition_point(|time| *time < reading.0));
        Ok(GroupReadings { trace, place: place.collect(), share, first })
    }

    /// Its share at each reading: of two readings at a step of the load the first one is before the step.
    fn shares(&self, motion: &LoadedHistory, readings: &[(f64, f64)]) -> Vec<f64> {
        let begin = motion.history().knots()[self.piece].0;
        let steps: Vec<LoadStep> = motion.steps().collect();
        let share = |i: usize| {
            let time = readings[i].0;
            let is_before = readings.get(i + 1).is_some_and(|next| next.0 == time);
            let passed = |step: &&LoadStep| step.time < time || step.time == time && !is_before;
            let falls = |step: &&LoadStep| step.time > begin && step.after < step.before;
            let formed = self.piece == 0 || begin < time || begin == time && !is_before;
            let left: f64 =
                steps.iter().filter(passed).filter(falls).map(|step| step.after / step.before).product();
            if formed { self.share * left } else { 0.0 }
        };
        (0..readings.len()).map(share).collect()
    }
}

impl GroupReadings {
    /// Adds a reading of the group, times its share, to each of `sums`.
    fn add(&self, values: impl Fn(&Trace) -> &[f64], sums: &mut [f64]) {
        let values = values(&self.trace);
        for (i, &place) in (self.first..).zip(&self.place) {
            sums[i] += self.share[i] * values[place];
        }
    }

    /// The error of its force in the whole.
    fn error(&self) -> f64 {
        self.trace.error * self.share.iter().copied().fold(0.0, f64::max)
    }
}

/// The readings of all groups together, with the time, the position, the velocity and the relative load of each.
fn sum(groups: &[GroupReadings], at: impl Iterator<Item = (f64, f64, f64, f64)>) -> Trace {
    let mut trace = Trace::default();
    for (time, position, velocity, load) in at {
        trace.time.push(time);
        trace.position.push(position);
        trace.velocity.push(velocity);
        trace.relative_normal_load.push(load);
    }
    let summed = |values: fn(&Trace) -> &[f64]| {
        let mut sums = vec![0.0; trace.time.len()];
        groups.iter().for_each(|group| group.add(values, &mut sums));
        sums
    };
    let per_contact = |values: fn(&Trace) -> &[f64]| -> Vec<f64> {
        summed(values).iter().zip(&trace.relative_normal_load).map(|(sum, load)| sum / load).collect()
    };
    let (force, breaking_rate, free) =
        (summed(|of| &of.force), per_contact(|of| &of.breaking_rate), per_contact(|of| &of.free));
    let error = groups.iter().map(GroupReadings::error).sum();
    Trace { force, breaking_rate, free, error, ..trace }
}
