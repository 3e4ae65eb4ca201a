//! What happens at a fixed drive, from the loss of balance to the next one.

use super::events::Event;
use super::inertia::Swung;
use super::quasistatic::QuasistaticRun;
use super::{EnergyBalance, Loading, Point, Slip};
use crate::Result;
use crate::population::Direction;

/// A lag of the drive, relative to what it is computed from, that is rounding.
const ROUNDING: f64 = 1e-12;

/// How a slide ended.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Slid {
    /// In balance.
    Balanced,
    /// More contacts have broken than may.
    Exceeded,
    /// Nowhere.
    Away,
}

impl QuasistaticRun<'_> {
    /// All that happens here at a fixed drive, after a loss of balance or, if it `breaks`, with the contacts that
    /// break here: what has happened, if it is no less than an event; none if the slider found no new balance.
    pub fn event(&mut self, breaks: bool) -> Result<Option<Option<Event>>> {
        let (before, direction) = (self.point(), self.look.direction);
        let drive = before.drive;
        let approach = self.closed(drive);
        self.memory.approach += approach;
        if breaks && self.dies_out(drive, direction)? {
            return Ok(Some(self.account(before, self.look.position, self.broken())));
        }
        if self.holds(breaks) {
            self.look.hold()?;
        }
        let pushed = if breaks {
            self.look.cross()?;
            self.pushed(drive, direction)?
        } else {
            Some(direction)
        };
        let Some(turn) = self.slip(drive, pushed, !breaks)? else { return Ok(None) };
        Ok(Some(self.account(before, turn, self.broken())))
    }

    /// In `arrest`, whether the contacts that break here take along no more than may break without a slip; if they do,
    /// all is as it was before them.
    ///
    /// Until there is a slip contacts re-form as they break: held free from here on they would begin one before its time.
    fn dies_out(&mut self, drive: f64, direction: Direction) -> Result<bool> {
        let Some(most) = self.block.slip_fraction.filter(|_| self.block.slip == Slip::Arrest) else {
            return Ok(false);
        };
        self.look.mark();
        self.look.cross()?;
        let next = self.pushed(drive, direction)?;
        if self.avalanche(drive, next, most)? == Slid::Balanced && self.broken() <= most {
            return Ok(true);
        }
        self.look.recall()?;
        self.memory.open = EnergyBalance::default();
        Ok(false)
    }

    /// Whether contacts that break at the start of an event stay free: in `arrest` until the slider is at rest, in
    /// a `reset` until all re-form together.
    fn holds(&self, breaks: bool) -> bool {
        match self.block.slip {
            Slip::Arrest => true,
            Slip::Reset => breaks && self.block.slip_fraction.is_none(),
            Slip::Overdamped | Slip::Damped { .. } | Slip::Inertial { .. } => false,
        }
    }

    /// Moves by the rule of slip, first in the direction `pushed`, from a balance that is `lost` there without a push
    /// or with one. Where the slider turned or came to rest; `None` if it ran away.
    fn slip(&mut self, drive: f64, pushed: Option<Direction>, lost: bool) -> Result<Option<f64>> {
        let Some(direction) = pushed else {
            self.let_go()?;
            self.look.towards(self.look.direction)?;
            return Ok(Some(self.look.position));
        };
        let calm = match self.block.slip {
            Slip::Reset => self.reset(drive, direction)?,
            Slip::Overdamped | Slip::Damped { .. } | Slip::Arrest => {
                self.settle(drive, Some(direction), lost)?
            }
            Slip::Inertial { mass, damping } => {
                let (next, lost) = match self.swing(drive, direction, mass, damping)? {
                    Swung::Arrested => (self.pushed(drive, direction)?, false),
                    Swung::Still => (Some(direction), true),
                    Swung::Away => return Ok(None),
                };
                let turn = self.look.position;
                return Ok(self.settle(drive, next, lost)?.then_some(turn));
            }
        };
        Ok(calm.then_some(self.look.position))
    }

    /// Slides without inertia, in one direction after the other, until there is balance; whether there is one.
    fn settle(&mut self, drive: f64, mut next: Option<Direction>, mut lost: bool) -> Result<bool> {
        while let Some(direction) = next {
            if self.slide(drive, direction, lost, None)? == Slid::Away {
                return Ok(false);
            }
            lost = false;
            self.let_go()?;
            next = self.pushed(drive, direction)?;
        }
        Ok(true)
    }

    /// What is held free re-forms.
    fn let_go(&mut self) -> Result<()> {
        if self.holds(true) { self.look.release() } else { Ok(()) }
    }

    /// Slides until more contacts have broken than a slip needs; then all break, and re-form where the spring meets
    /// their force.
    fn reset(&mut self, drive: f64, direction: Direction) -> Result<bool> {
        let slid = match self.block.slip_fraction {
            Some(most) => self.avalanche(drive, Some(direction), most)?,
            None => Slid::Exceeded,
        };
        match slid {
            Slid::Balanced => Ok(true),
            Slid::Exceeded => self.renew(drive),
            Slid::Away => Ok(false),
        }
    }

    /// Slides without inertia, in one direction after the other, until there is balance or `most` is exceeded.
    fn avalanche(&mut self, drive: f64, mut next: Option<Direction>, most: f64) -> Result<Slid> {
        while let Some(direction) = next {
            match self.slide(drive, direction, false, Some(most))? {
                Slid::Balanced => next = self.pushed(drive, direction)?,
                end => return Ok(end),
            }
        }
        Ok(Slid::Balanced)
    }

    fn renew(&mut self, drive: f64) -> Result<bool> {
        let (loading, direction) = (self.look.loading, self.look.direction);
        self.look.reset()?;
        self.look.towards(direction)?;
        let Loading::Spring(stiffness) = loading else { return Ok(false) };
        let position = drive - self.look.here.force / stiffness;
        let released = loading.stored(drive, self.look.position) - loading.stored(drive, position);
        self.memory.open.slip += released;
        self.look.carry(position);
        Ok(true)
    }

    /// The direction in which the slider is out of balance, after a look ahead.
    fn pushed(&mut self, drive: f64, direction: Direction) -> Result<Option<Direction>> {
        self.look.towards(direction)?;
        if self.is_balanced(drive) {
            return Ok(None);
        }
        let behind = direction.sign() * (drive - self.look.drive_here()) > 0.0;
        Ok(Some(if behind { direction } else { direction.reversed() }))
    }

    /// Whether the slider is in balance here at a given drive, but for rounding.
    pub(super) fn is_balanced(&self, drive: f64) -> bool {
        let here = self.look.drive_here();
        // Where all of these are near 0, stretches are still differences of positions as far away as the slider was.
        let scale =
            drive.abs() + here.abs() + self.drive_of(self.look.position.abs() + self.memory.rest.abs());
        (drive - here).abs() <= ROUNDING * scale
    }

    /// Slides in one direction to the next balance at a fixed drive, from one that is `lost` there or from none.
    fn slide(&mut self, drive: f64, direction: Direction, mut lost: bool, most: Option<f64>) -> Result<Slid> {
        let (loading, sign) = (self.look.loading, direction.sign());
        loop {
            self.towards(direction)?;
            let rises = !std::mem::take(&mut lost) && self.look.rises();
            let ahead = sign * (self.look.drive_here() - drive) > 0.0;
            if rises && (ahead || self.is_balanced(drive)) {
                return Ok(Slid::Balanced);
            }
            let (a, found) = self.landing(sign * drive, rises);
            if a.is_infinite() {
                return Ok(Slid::Away);
            }
            self.memory.open.work += loading.work_at_rest(drive, sign * a);
            self.memory.open.slip +=
                sign * self.look.integral(a, |x, response| loading.excess(drive, x, response.force));
            let breaks = self.look.way.breaks;
            self.look.advance(a)?;
            if found {
                return Ok(Slid::Balanced);
            }
            if self.is_gone(drive) {
                return Ok(Slid::Away);
            }
            if breaks {
                self.look.cross()?;
            }
            if most.is_some_and(|most| self.broken() > most) {
                return Ok(Slid::Exceeded);
            }
        }
    }

    /// Where on the way ahead the drive in balance comes back to `drive` (signed), and whether it does; else the
    /// end of the way.
    fn landing(&self, drive: f64, rises: bool) -> (f64, bool) {
        let (mut from, mut rising) = (0.0, rises);
        loop {
            let turn = self.look.turn(from, rising);
            let to = turn.unwrap_or(self.look.way.length);
            if rising && (to.is_infinite() || self.look.drive(to) >= drive) {
                return (self.look.reaches(drive, from, to), true);
            }
            match turn {
                Some(turn) => (from, rising) = (turn, !rising),
                None => return (to, false),
            }
        }
    }

    /// Enters what has happened in the energy balance; it is told unless it is too little, and kept if it is a slip.
    fn account(&mut self, before: Point, position_turn: f64, broken_fraction: f64) -> Option<Event> {
        let drive = before.drive;
        let energy = self.closed(drive);
        let (position, force) = (self.look.position, self.look.here.force);
        let spring_force = self.look.loading.pull(drive, position, force);
        let after = Point { drive, position, force, spring_force };
        let (slip, drop) = (position - before.position, before.force - force);
        self.sizes.add(broken_fraction, slip, drop);
        let shown = self.block.slip_fraction.is_none_or(|least| broken_fraction > least);
        if !shown || (slip == 0.0 && drop == 0.0) {
            self.memory.approach += energy;
            return None;
        }
        self.trace.extend([before, after]);
        let approach = self.memory.approach;
        if slip == 0.0 {
            self.memory.approach += energy;
            return Some(Event { before, after, position_turn, broken_fraction, energy, approach });
        }
        if self.course.is_none() && matches!(self.block.slip, Slip::Inertial { .. }) {
            self.course = Some(std::mem::take(&mut self.offered).begun());
        }
        // In a reset all have broken, however many did so before the share was exceeded.
        let most = if self.block.slip == Slip::Reset { 1.0 } else { f64::INFINITY };
        let broken_fraction = broken_fraction.min(most);
        self.memory.approach = EnergyBalance::default();
        let event = Event { before, after, position_turn, broken_fraction, energy, approach };
        self.events.push(event);
        Some(event)
    }
}
