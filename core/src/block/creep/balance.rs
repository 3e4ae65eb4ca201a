//! The balance of contacts with an imposed force after a step of a slider.

use super::CreepAccuracy;
use crate::monitor::Monitor;
use crate::numerics::roots::brent_root;
use crate::rate_dependent::RateDependentContacts;
use crate::{Error, Result};

/// Ratio of the time of a step to that of the last one, per displacement, below which there is no balance.
const LOST: f64 = 1e-6;
/// Ratio between times of the search for a balance.
const LONGER: f64 = 8.0;
/// Accuracy of the force in balance, in tolerances.
const ACCURACY: f64 = 0.01;
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
        let left = self.ramp.end - time;
        let usual = (slowness * by).min(left);
        let (mut low, mut high) = (LOST * usual, usual);
        if self.excess(contacts, time, by, high)? < 0.0 {
            if self.excess(contacts, time, by, low)? < 0.0 {
                return Ok(Balance::Lost);
            }
        } else {
            loop {
                if high >= left {
                    return Ok(Balance::Later);
                }
                (low, high) = (high, (LONGER * high).min(left));
                if self.excess(contacts, time, by, high)? < 0.0 {
                    break;
                }
            }
        }
        let near = ACCURACY * self.accuracy.tolerance * self.scale / by;
        let duration = self
            .root((low, high), near.min(0.1) * high, |own, during| own.excess(contacts, time, by, during))?;
        let contacts = self.moved(contacts, by, duration)?;
        Ok(Balance::Found { duration, contacts })
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
        let by = self.root((0.0, most), AT_END * self.scale, |own, by| {
            own.moved(contacts, by, left).map(|moved| moved.force() - force)
        })?;
        let moved = self.moved(contacts, by, left)?;
        Ok((by, moved))
    }

    /// Force of contacts after a step, less the imposed one.
    fn excess(
        &mut self,
        contacts: &dyn RateDependentContacts,
        time: f64,
        by: f64,
        duration: f64,
    ) -> Result<f64> {
        let carried = self.moved(contacts, by, duration)?.force();
        Ok(carried - self.ramp.at(time + duration))
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

    /// A zero of `f`; the upper end if the signs at both ends are the same, which rounding makes them.
    fn root(
        &mut self,
        (low, high): (f64, f64),
        accuracy: f64,
        mut f: impl FnMut(&mut Self, f64) -> Result<f64>,
    ) -> Result<f64> {
        let mut failed = None;
        let value = |x: f64| {
            f(self, x).unwrap_or_else(|error| {
                failed = Some(error);
                f64::NAN
            })
        };
        let root = brent_root(value, low, high, accuracy);
        failed.map_or(Ok(root.unwrap_or(high)), Err)
    }
}
