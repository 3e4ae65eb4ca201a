//! The balance of contacts with an imposed force after a step of a slider.

use super::CreepAccuracy;
use crate::monitor::Monitor;
use crate::numerics::roots::brent_root_between;
use crate::rate_dependent::RateDependentContacts;
use crate::{Error, Result};

/// Times at which a balance earlier than expected is looked for, in units of that expected from the last step: mostly velocities
/// change little. Before the last one there is no balance.
const EARLIER: [f64; 3] = [0.95, 0.6, 1e-6];
/// Ratios between times at which a later one is looked for, the last one repeated.
const LATER: [f64; 3] = [1.05, 1.6, 8.0];
/// Accuracy of the position in balance, in tolerances.
const ACCURACY: f64 = 1e-3;
/// Accuracy of the position at the end of a ramp, relative to the slip: well below the first step of the next ramp.
const AT_END: f64 = 1e-12;

/// A force that changes at a constant rate.
#[derive(Debug, Clone, Copy)]
pub(super) struct ForceRamp {
    /// Its beginning.
    pub time: f64,
    /// The force then.
    pub force: f64,
    pub rate: f64,
    pub end: f64,
}

impl ForceRamp {
    fn at(self, time: f64) -> f64 {
        self.force + self.rate * (time - self.time)
    }
}

/// What a slider meets that advances by a given length.
pub(super) enum Balance {
    /// A balance after a time.
    Found { duration: f64, contacts: Box<dyn RateDependentContacts> },
    /// A balance after the end of the ramp.
    Later,
    /// None: the contacts carry less than the force even if the slider advances at once.
    Lost,
}

/// Where the balance of contacts that advance by a given length is.
enum Bracket {
    /// Between two times, each with the force there less the imposed one.
    Between([(f64, f64); 2]),
    /// After the end of the ramp.
    Later,
    /// Nowhere.
    Lost,
}

/// Contacts that carry an imposed force.
pub(super) struct CreepBalance<'a> {
    pub ramp: ForceRamp,
    pub accuracy: CreepAccuracy,
    /// The length to which errors are relative.
    pub scale: f64,
    pub monitor: &'a mut dyn Monitor,
}

impl CreepBalance<'_> {
    /// The balance of `contacts` at a time after an advance, expected at a time per displacement.
    pub fn after(
        &mut self,
        contacts: &dyn RateDependentContacts,
        time: f64,
        by: f64,
        slowness: f64,
    ) -> Result<Balance> {
        let ends = match self.bracket(contacts, time, by, slowness)? {
            Bracket::Between(ends) => ends,
            Bracket::Later => return Ok(Balance::Later),
            Bracket::Lost => return Ok(Balance::Lost),
        };
        let exact = ACCURACY * self.accuracy.tolerance * self.scale;
        let balanced = exact * contacts.tangent().max(0.0);
        let mut last = None;
        let duration = self.root(ends, (exact / by).min(0.1) * ends[1].0, |own, during| {
            let moved = own.moved(contacts, by, during)?;
            let excess = own.excess(moved.as_ref(), time + during);
            last = Some((during, moved));
            Ok(if excess.abs() <= balanced { 0.0 } else { excess })
        })?;
        let contacts = match last {
            Some((during, moved)) if during == duration => moved,
            _ => self.moved(contacts, by, duration)?,
        };
        Ok(Balance::Found { duration, contacts })
    }

    /// Times around that of the balance.
    fn bracket(
        &mut self,
        contacts: &dyn RateDependentContacts,
        time: f64,
        by: f64,
        slowness: f64,
    ) -> Result<Bracket> {
        let left = self.ramp.end - time;
        let usual = (slowness * by).min(left);
        let mut at = |during: f64| -> Result<(f64, f64)> {
            let moved = self.moved(contacts, by, during)?;
            Ok((during, self.excess(moved.as_ref(), time + during)))
        };
        let mut low = at(usual)?;
        if low.1 < 0.0 {
            let mut high = low;
            for part in EARLIER {
                low = at(part * usual)?;
                if low.1 >= 0.0 {
                    return Ok(Bracket::Between([low, high]));
                }
                high = low;
            }
            return Ok(Bracket::Lost);
        }
        let (mut ratio, mut ratios) = (LATER[0], LATER.into_iter());
        while low.0 > 0.0 && low.0 < left {
            ratio = ratios.next().unwrap_or(ratio);
            let high = at((ratio * low.0).min(left))?;
            if high.1 < 0.0 {
                return Ok(Bracket::Between([low, high]));
            }
            low = high;
        }
        Ok(Bracket::Later)
    }

    /// The advance, up to `most`, at which `contacts` carry the force at the end of the ramp, `left` from now.
    pub fn at_end(
        &mut self,
        contacts: &dyn RateDependentContacts,
        most: f64,
        left: f64,
    ) -> Result<(f64, Box<dyn RateDependentContacts>)> {
        let force = self.ramp.at(self.ramp.end);
        let rest = self.moved(contacts, 0.0, left)?;
        let slack = self.accuracy.tolerance * self.accuracy.unit * contacts.tangent();
        if rest.force() - force > slack {
            let expected = format!(
                "one of at least {}, that of the contacts at t = {}, which would push the slider back",
                rest.force(),
                self.ramp.end
            );
            return Err(Error::invalid("force", expected, force));
        }
        if rest.force() >= force {
            return Ok((0.0, rest));
        }
        let whole = self.moved(contacts, most, left)?.force() - force;
        let ends = [(0.0, rest.force() - force), (most, whole)];
        let by = self.root(ends, AT_END * self.scale, |own, by| {
            own.moved(contacts, by, left).map(|moved| moved.force() - force)
        })?;
        let moved = self.moved(contacts, by, left)?;
        Ok((by, moved))
    }

    /// Force of contacts at a time, less the imposed one.
    fn excess(&self, contacts: &dyn RateDependentContacts, time: f64) -> f64 {
        contacts.force() - self.ramp.at(time)
    }

    /// A copy of the contacts, moved.
    fn moved(
        &mut self,
        contacts: &dyn RateDependentContacts,
        by: f64,
        during: f64,
    ) -> Result<Box<dyn RateDependentContacts>> {
        let mut moved = contacts.copy();
        moved.step(by, during, self.monitor)?;
        Ok(moved)
    }

    /// A zero of `f` between two positions with their values; the upper end if the signs at both ends are the same, which rounding
    /// makes them.
    fn root(
        &mut self,
        ends: [(f64, f64); 2],
        accuracy: f64,
        mut f: impl FnMut(&mut Self, f64) -> Result<f64>,
    ) -> Result<f64> {
        let mut failed = None;
        let value = |x: f64| {
            f(self, x).unwrap_or_else(|error| {
                // A zero ends the search.
                failed = Some(error);
                0.0
            })
        };
        let root = brent_root_between(value, ends, accuracy);
        failed.map_or(Ok(root.unwrap_or(ends[1].0)), Err)
    }
}
