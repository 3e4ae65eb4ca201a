//! The response of steady sliding to a small step of the slider, followed in time.

use super::dense_output::RequestedReadings;
use super::merging::MergingRule;
use super::settled::ConstantRate;
use super::{Transport, step_control};
use crate::contacts::Contacts;
use crate::monitor::{Aside, Monitor, Part};
use crate::{Error, Result};

/// Size of the step, in units of the length on which lives vary.
const STEP: f64 = 0.01;

/// Number of times in the longest time step.
const FINER: f64 = 2.0;

/// Velocity of the step, in units of the sliding velocity.
const FAST: f64 = 1e4;

/// Largest number of times, in each of which all cohorts move.
const MOST: f64 = 4_194_304.0;

/// Refuses more times than can be followed.
fn fits(velocity: f64, count: f64) -> Result<()> {
    if count <= MOST {
        return Ok(());
    }
    let expected = format!(
        "one at which lives are not very much longer than the stretch over which they end: the response of steady sliding is followed in at most {MOST:.1e} steps"
    );
    Err(Error::invalid("velocity", expected, format!("{velocity:e}, at which it takes {count:.1e}")))
}

impl Transport {
    /// Times since a small step, evenly spaced from 0 over some mean lives; the change of the force and the fraction of contacts that
    /// have broken because of the step until then, per length: from two solutions, of steady sliding with and without the step.
    ///
    /// # Errors
    /// Those of [`Transport::steady_with`]; more times than can be followed; stopped by the monitor.
    pub(in crate::master) fn step_response(
        contacts: &Contacts,
        velocity: f64,
        lives: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<[Vec<f64>; 3]> {
        let aside = &mut Aside { fraction: 0.0, monitor };
        let mut steady = Transport::steady_with(contacts, velocity, tolerance, aside)?;
        (steady.rough, steady.constant) = (None, ConstantRate::unused());
        let by = STEP * step_control::scale(contacts);
        let during = by / (FAST * velocity);
        let duration = lives / steady.breaking_rate();
        let spacing = steady.pace.longest(velocity) / FINER;
        let count = (duration / spacing).ceil().max(1.0);
        fits(velocity, count)?;
        let time: Vec<f64> = (0..=count as u32).map(|k| f64::from(k) / count * duration).collect();
        let mut displaced = steady.clone();
        displaced.step(by, during, &mut Aside { fraction: 0.0, monitor })?;
        // Both solutions end steps at the times: their errors are then those of the same steps, and cancel.
        let after = displaced.readings(velocity, &time, &mut Part::new(monitor, 0.0, 0.5))?;
        let before = steady.readings(velocity, &time, &mut Part::new(monitor, 0.5, 0.5))?;
        let per_length = |of: usize| {
            after.iter().zip(&before).map(|(after, before)| (after[of] - before[of]) / by).collect()
        };
        let [response, breaks] = [per_length(0), per_length(1)];
        Ok([time, response, breaks])
    }

    /// Force and fraction of broken contacts at the times, while it slides on steadily.
    fn readings(&mut self, velocity: f64, times: &[f64], monitor: &mut dyn Monitor) -> Result<Vec<[f64; 2]>> {
        let (begun, duration) = (self.time, times[times.len() - 1]);
        let now =
            |transport: &Self| [transport.stiffness * transport.reading().force, transport.broken.all()];
        let mut readings = vec![now(self)];
        self.mark_kink();
        for ends in times.windows(2) {
            let asked = (&mut RequestedReadings::default(), MergingRule::Never);
            let part = |time: f64| ((time - begun) / duration).clamp(0.0, 1.0);
            self.advance_steadily(velocity, ends[1] - ends[0], asked, &part, monitor)?;
            self.time = begun + ends[1];
            readings.push(now(self));
        }
        Ok(readings)
    }
}
