//! Motion at a fixed drive, from a loss of stability to the next equilibrium.

use super::events::{Event, MotionEnd};
use super::inertia::SwingEnd;
use super::quasistatic::QuasistaticRun;
use super::{EnergyBalance, Loading, Point, Slip};
use crate::Result;
use crate::population::Direction;

/// Difference of drives that counts as rounding, relative to the numbers from which it is computed.
const ROUNDING: f64 = 1e-12;

/// The end of a slide.
#[derive(Debug, Clone, Copy, PartialEq)]
enum SlideEnd {
    /// The slider is in equilibrium.
    Balanced,
    /// More contacts have broken than allowed.
    Exceeded,
    /// The slider has run away.
    Away,
}

impl QuasistaticRun<'_> {
    /// The motion at the present drive: after a loss of stability or, with `breaks`, with the simultaneous breaks here.
    pub fn event(&mut self, breaks: bool) -> Result<MotionEnd> {
        let (before, direction) = (self.point(), self.path.direction);
        let drive = before.drive;
        let approach = self.close_energy_balance(drive);
        self.memory.approach += approach;
        if breaks && self.dies_out(drive, direction)? {
            return Ok(MotionEnd::Balanced(self.record_event(before, self.path.position, self.broken())));
        }
        if self.stay_free(breaks) {
            self.path.hold()?;
        }
        // After breaks the net force decides the direction. At a smooth instability there is none, and the
        // slider moves on.
        let pushed = if breaks {
            self.path.cross()?;
            self.net_force_direction(drive, direction)?
        } else {
            Some(direction)
        };
        let Some(turn) = self.slip(drive, pushed, !breaks)? else { return Ok(MotionEnd::Away) };
        Ok(MotionEnd::Balanced(self.record_event(before, turn, self.broken())))
    }

    /// For `arrest`: whether the avalanche that the breaks here set off stays below the slip fraction. If it does not, the
    /// state before the breaks is restored.
    ///
    /// Contacts re-form as they break until there is a slip. If they stayed free, a slip would begin too early.
    fn dies_out(&mut self, drive: f64, direction: Direction) -> Result<bool> {
        let Some(most) = self.block.slip_fraction.filter(|_| self.block.slip == Slip::Arrest) else {
            return Ok(false);
        };
        // The avalanche is tried on the contacts themselves, and undone by the mark.
        self.path.mark();
        self.path.cross()?;
        let next = self.net_force_direction(drive, direction)?;
        if self.avalanche(drive, next, most)? == SlideEnd::Balanced && self.broken() <= most {
            return Ok(true);
        }
        self.path.recall()?;
        self.memory.open = EnergyBalance::default();
        Ok(false)
    }

    /// Whether contacts that break at the start of an event stay free: for `arrest` until the slider is at rest, for `reset`
    /// until all contacts re-form together.
    fn stay_free(&self, breaks: bool) -> bool {
        match self.block.slip {
            Slip::Arrest => true,
            Slip::Reset => breaks && self.block.slip_fraction.is_none(),
            Slip::Overdamped | Slip::Damped { .. } | Slip::Inertial { .. } => false,
        }
    }

    /// Moves by the slip rule, first in the direction `pushed` of the net force. `lost`: the slider is at an equilibrium that
    /// is unstable, without a net force. Returns the position of the turn or of the rest; `None` if the slider ran away.
    fn slip(&mut self, drive: f64, pushed: Option<Direction>, lost: bool) -> Result<Option<f64>> {
        let Some(direction) = pushed else {
            self.reattach()?;
            self.path.find_interval(self.path.direction)?;
            return Ok(Some(self.path.position));
        };
        let calm = match self.block.slip {
            Slip::Reset => self.reset(drive, direction)?,
            Slip::Overdamped | Slip::Damped { .. } | Slip::Arrest => {
                self.settle(drive, Some(direction), lost)?
            }
            Slip::Inertial { mass, damping } => {
                let (next, lost) = match self.swing(drive, direction, mass, damping)? {
                    SwingEnd::Arrested => (self.net_force_direction(drive, direction)?, false),
                    SwingEnd::Still => (Some(direction), true),
                    SwingEnd::Away => return Ok(None),
                };
                let turn = self.path.position;
                return Ok(self.settle(drive, next, lost)?.then_some(turn));
            }
        };
        Ok(calm.then_some(self.path.position))
    }

    /// Slides without inertia, in one direction after the other, to an equilibrium. Returns whether there is one.
    fn settle(&mut self, drive: f64, mut next: Option<Direction>, mut lost: bool) -> Result<bool> {
        while let Some(direction) = next {
            if self.slide(drive, direction, lost, None)? == SlideEnd::Away {
                return Ok(false);
            }
            lost = false;
            self.reattach()?;
            next = self.net_force_direction(drive, direction)?;
        }
        Ok(true)
    }

    /// Re-forms the contacts that stayed free.
    fn reattach(&mut self) -> Result<()> {
        if self.stay_free(true) { self.path.release() } else { Ok(()) }
    }

    /// Slides until more contacts have broken than the slip fraction. Then all contacts break, and re-form where the spring
    /// balances their force.
    fn reset(&mut self, drive: f64, direction: Direction) -> Result<bool> {
        let slid = match self.block.slip_fraction {
            Some(most) => self.avalanche(drive, Some(direction), most)?,
            None => SlideEnd::Exceeded,
        };
        match slid {
            SlideEnd::Balanced => Ok(true),
            SlideEnd::Exceeded => self.renew_contacts(drive),
            SlideEnd::Away => Ok(false),
        }
    }

    /// Slides without inertia, in one direction after the other, to an equilibrium or until more than `most` contacts broke.
    fn avalanche(&mut self, drive: f64, mut next: Option<Direction>, most: f64) -> Result<SlideEnd> {
        while let Some(direction) = next {
            // So many may break together at the start.
            if self.broken() > most {
                return Ok(SlideEnd::Exceeded);
            }
            match self.slide(drive, direction, false, Some(most))? {
                SlideEnd::Balanced => next = self.net_force_direction(drive, direction)?,
                end => return Ok(end),
            }
        }
        Ok(SlideEnd::Balanced)
    }

    /// Breaks and re-forms all contacts, and moves the slider to equilibrium. Returns whether there is one.
    fn renew_contacts(&mut self, drive: f64) -> Result<bool> {
        let (loading, direction) = (self.path.loading, self.path.direction);
        self.path.reset()?;
        self.path.find_interval(direction)?;
        let Loading::Spring(stiffness) = loading else { return Ok(false) };
        // Equilibrium of the spring with the force of the re-formed contacts.
        let position = drive - self.path.here.force / stiffness;
        // In a reset no contact carries the slider while it moves: all of the energy that the
        // spring releases is dissipated.
        let released = self.path.stored(drive, self.path.position) - self.path.stored(drive, position);
        let background = self.block.background * (position - self.path.position).abs();
        self.memory.open.background += background;
        self.memory.open.slip += released - background;
        self.path.carry(position);
        Ok(true)
    }

    /// The direction of the net force; `None` in equilibrium.
    fn net_force_direction(&mut self, drive: f64, direction: Direction) -> Result<Option<Direction>> {
        self.path.find_interval(direction)?;
        if self.is_balanced(drive) {
            return Ok(None);
        }
        let behind = direction.sign() * (drive - self.path.drive_here()) > 0.0;
        if behind {
            return Ok(Some(direction));
        }
        if self.block.background > 0.0 {
            // A slider moves back only if it overcomes the background force, which then has the other sign.
            self.path.find_interval(direction.reversed())?;
            let held = direction.sign() * (drive - self.path.drive_here()) >= 0.0;
            if held || self.is_balanced(drive) {
                return Ok(None);
            }
        }
        Ok(Some(direction.reversed()))
    }

    /// Whether the slider is in equilibrium at a given drive, within rounding.
    pub(super) fn is_balanced(&self, drive: f64) -> bool {
        let here = self.path.drive_here();
        // Stretches are differences of positions, so that positions set the scale of rounding even near drive 0.
        let scale =
            drive.abs() + here.abs() + self.drive_of(self.path.position.abs() + self.memory.rest.abs());
        (drive - here).abs() <= ROUNDING * scale
    }

    /// Slides in one direction to the next equilibrium at a fixed drive. `lost`: the present equilibrium is unstable.
    fn slide(
        &mut self,
        drive: f64,
        direction: Direction,
        mut lost: bool,
        most: Option<f64>,
    ) -> Result<SlideEnd> {
        let (loading, sign) = (self.path.loading, direction.sign());
        loop {
            self.find_interval(direction)?;
            // Only a stable equilibrium ends a slide, and a slide from a lost one has to leave it first.
            let rises = !std::mem::take(&mut lost) && self.path.rises();
            let ahead = sign * (self.path.drive_here() - drive) > 0.0;
            if rises && (ahead || self.is_balanced(drive)) {
                return Ok(SlideEnd::Balanced);
            }
            let (a, found) = self.landing(sign * drive, rises);
            if a.is_infinite() {
                return Ok(SlideEnd::Away);
            }
            // A slider without inertia dissipates the work of the net force.
            self.memory.open.work += loading.work_at_rest(drive, sign * a);
            self.memory.open.slip +=
                sign * self.path.integral(a, |x, response| loading.excess(drive, x, response.force));
            let breaks = self.path.interval.breaks;
            self.move_by(a)?;
            if found {
                return Ok(SlideEnd::Balanced);
            }
            if self.has_run_away(drive) {
                return Ok(SlideEnd::Away);
            }
            if breaks {
                self.path.cross()?;
            }
            if most.is_some_and(|most| self.broken() > most) {
                return Ok(SlideEnd::Exceeded);
            }
        }
    }

    /// The advance at which the equilibrium drive increases to `drive` (signed) on the interval ahead, and `true`; the end of
    /// the interval and `false` if it does not.
    fn landing(&self, drive: f64, rises: bool) -> (f64, bool) {
        // Every monotonic part of the equilibrium drive reaches `drive` at most once.
        let (mut from, mut rising) = (0.0, rises);
        loop {
            let turn = self.path.turn(from, rising);
            let to = turn.unwrap_or(self.path.interval.length);
            if rising && (to.is_infinite() || self.path.drive(to) >= drive) {
                return (self.path.reaches(drive, from, to), true);
            }
            match turn {
                Some(turn) => (from, rising) = (turn, !rising),
                None => return (to, false),
            }
        }
    }

    /// Closes the energy balance of an event and records it. Returns it unless it is too small; only a slip is kept.
    fn record_event(&mut self, before: Point, position_turn: f64, broken_fraction: f64) -> Option<Event> {
        let drive = before.drive;
        let energy = self.close_energy_balance(drive);
        let (position, force) = (self.path.position, self.path.friction_at_rest(drive));
        self.hold_at(drive);
        let spring_force = self.path.spring_force(drive, 0.0);
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
        // Simultaneous breaks under a rigid slider: an event without displacement is no slip.
        if slip == 0.0 {
            self.memory.approach += energy;
            return Some(Event { before, after, position_turn, broken_fraction, energy, approach });
        }
        if self.course.is_none() && matches!(self.block.slip, Slip::Inertial { .. }) {
            self.course = Some(std::mem::take(&mut self.offered).begun());
        }
        // A reset breaks all contacts, however many broke before the slip fraction was exceeded.
        let most = if self.block.slip == Slip::Reset { 1.0 } else { f64::INFINITY };
        let broken_fraction = broken_fraction.min(most);
        self.memory.approach = EnergyBalance::default();
        let event = Event { before, after, position_turn, broken_fraction, energy, approach };
        self.events.push(event);
        Some(event)
    }
}
