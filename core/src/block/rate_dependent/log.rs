//! The log of a slider's motion in time: trace, slips, and energy balance.

use serde::{Deserialize, Serialize};

use super::moment::Moment;
use super::sliding::SlidingBlock;
use crate::block::regime::{self, Jump, Oscillation};
use crate::block::trace::End;
use crate::block::{EnergyBalance, Regime};
use crate::dynamics::SLIP_VELOCITY;
use crate::record::{Quantity, Record};

/// A slip: the time during which the slider is more than ten times as fast as the drive, or until it comes to rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RateDependentSlip {
    /// State at its beginning.
    pub before: Moment,
    /// State at its end; at rest after an arrest.
    pub after: Moment,
    /// Position X_2, the largest that the contacts reached.
    pub position_turn: f64,
    /// Highest velocity.
    pub fastest: f64,
    /// Breaks in the slip, per contact.
    pub broken_fraction: f64,
    /// Energies of the slip.
    pub energy: EnergyBalance,
}

/// Results of a motion in time.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Slide {
    /// States at the requested times, and all steps of slips.
    pub trace: Vec<Moment>,
    /// Slips that have ended.
    pub slips: Vec<RateDependentSlip>,
    /// Energies of the whole motion.
    pub energy: EnergyBalance,
    /// The kind of sliding.
    pub regime: Regime,
    /// Upper estimate of the error of F at the requested times, if it was requested: the difference from a motion with larger
    /// tolerances of contacts and steps. `None` without such times, and for contacts that are followed one by one.
    pub error: Option<f64>,
}

/// The log of a motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Log {
    trace: Vec<Moment>,
    slips: Vec<RateDependentSlip>,
    /// Fraction of contacts that breaks in the smallest slip.
    fraction: f64,
    start: Moment,
    last: Moment,
    /// Time and velocity before `last`.
    earlier: (f64, f64),
    /// Whether the velocity was increasing.
    rising: bool,
    /// Oscillations since the last slip or the last change of the drive.
    oscillations: Vec<Oscillation>,
    /// Tolerance of a step, a length.
    tolerance: f64,
    /// Last velocity of the drive above 0; the first one before the drive moves.
    pulled: f64,
    open: Option<OpenSlip>,
    /// Largest force, and largest stiffness of all contacts.
    largest: (f64, f64),
}

/// A slip that has not ended.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct OpenSlip {
    before: Moment,
    fastest: f64,
}

/// The maximum of the parabola through three points, if the middle one is the highest.
fn top([(t0, v0), (t1, v1), (t2, v2)]: [(f64, f64); 3]) -> f64 {
    let (before, after) = ((v1 - v0) / (t1 - t0), (v2 - v1) / (t2 - t1));
    let bend = (after - before) / (t2 - t0);
    let slope = before + bend * (t1 - t0);
    if bend < 0.0 { v1 - 0.25 * slope * slope / bend } else { v1 }
}

impl RateDependentSlip {
    /// Force drop: F before minus F after.
    pub fn drop(&self) -> f64 {
        self.before.force - self.after.force
    }

    /// Displacement of the slider's base.
    pub fn slip(&self) -> f64 {
        self.after.position - self.before.position
    }

    fn jump(&self) -> Jump {
        Jump { before: self.before.point(), after: self.after.point() }
    }
}

impl Log {
    /// A log; `fraction` is the fraction of contacts in the smallest slip.
    pub fn new(slider: &SlidingBlock, fraction: f64) -> Self {
        let start = slider.moment();
        Self {
            trace: Vec::new(),
            slips: Vec::new(),
            fraction,
            start,
            last: start,
            earlier: start.time_and_velocity(),
            rising: false,
            oscillations: Vec::new(),
            tolerance: slider.motion.control.tolerance,
            pulled: slider.segment.pulled,
            open: None,
            largest: (slider.cell().force.abs(), slider.cell().contacts.tangent()),
        }
    }

    /// The drive continues, as `slider` does.
    pub fn begin_segment(&mut self, slider: &SlidingBlock) {
        self.pulled = slider.segment.pulled;
        self.oscillations.clear();
    }

    /// Adds a state to the trace.
    pub fn add_to_trace(&mut self, moment: Moment) {
        if self.trace.last().is_none_or(|last| last.time < moment.time) {
            self.trace.push(moment);
        }
    }

    /// Records the end of a step: slips begin and end, oscillations have their maximum.
    pub fn record_step(&mut self, slider: &SlidingBlock) {
        let (moment, fast) = (slider.moment(), SLIP_VELOCITY * self.pulled);
        let cell = slider.cell();
        let contacts = moment.force - slider.motion.equation.background(cell, slider.motion.drive);
        self.largest = (self.largest.0.max(contacts.abs()), self.largest.1.max(cell.contacts.tangent()));
        // A slip begins inside the step, where the velocity passes the limit.
        if self.open.is_none() && moment.velocity > fast {
            let before = self.last.until(&moment, fast);
            self.add_to_trace(before);
            self.open = Some(OpenSlip { before, fastest: 0.0 });
        }
        if let Some(open) = &mut self.open {
            open.fastest = open.fastest.max(moment.velocity);
            if moment.velocity > fast || slider.motion.is_stopping() {
                self.add_to_trace(moment);
            } else {
                self.end(moment, fast, slider);
            }
        }
        // The velocity has a maximum within the last three points where it ceases to increase.
        let rising = moment.velocity > self.last.velocity;
        if self.rising && !rising {
            let velocity =
                top([self.earlier, self.last.time_and_velocity(), moment.time_and_velocity()]) / self.pulled;
            self.oscillations.push(Oscillation { position: self.last.position, velocity });
        }
        self.rising = rising;
        self.earlier = self.last.time_and_velocity();
        self.last = moment;
    }

    /// Ends the open slip in the step to `moment`, in which the slider comes to rest or becomes slower than `fast`.
    fn end(&mut self, moment: Moment, fast: f64, slider: &SlidingBlock) {
        let Some(open) = self.open.take() else { return };
        self.oscillations.clear();
        let cell = slider.cell();
        // A slider with a mass comes to rest beyond its balance, where the forces jump, so that values between do not occur.
        let arrested = cell.velocity == 0.0 && slider.motion.equation.mass > 0.0;
        let slows = self.last.velocity > fast && !arrested;
        let after = if slows { self.last.until(&moment, fast) } else { moment };
        self.add_to_trace(after);
        let broken_fraction = after.broken - open.before.broken;
        // Single contacts of an ensemble make the slider jump a little at each break; these jumps
        // are not counted as slips.
        if broken_fraction < self.fraction {
            return;
        }
        self.slips.push(RateDependentSlip {
            before: open.before,
            after,
            position_turn: if arrested { cell.position } else { after.position },
            fastest: open.fastest,
            broken_fraction,
            energy: after.energy - open.before.energy,
        });
    }

    /// The slip that has just ended. Nothing else of the log is kept but what a slip that begins later needs.
    pub fn take_slip(&mut self) -> Option<RateDependentSlip> {
        self.trace.clear();
        self.slips.pop()
    }

    /// The kind of sliding so far.
    fn regime(&self) -> Regime {
        /// Smallest amplitude of an oscillation, in tolerances.
        const SEEN: f64 = 10.0;
        let (start, last) = (self.start.point(), self.last.point());
        let regime =
            regime::classify(&self.jumps(), start, last, self.largest.0 / self.largest.1, End::Reached);
        // The breaks of single contacts make random oscillations, which say nothing about stability.
        let seen = if self.fraction > 0.0 { f64::INFINITY } else { SEEN * self.tolerance };
        regime::with_oscillations(regime, &self.oscillations, seen)
    }

    fn jumps(&self) -> Vec<Jump> {
        self.slips.iter().map(RateDependentSlip::jump).collect()
    }

    /// The kind of sliding, once it is decided: stick-slip that [`regime::lasts`], or no slip any more while the load point has
    /// moved by `sliding` since the first loading, which ends with the first slip, or after the advance `loading` of the load
    /// point.
    pub fn decided(&self, [loading, sliding]: [f64; 2]) -> Option<Regime> {
        if self.open.is_some() {
            return None;
        }
        let driven = |moment: &Moment| moment.drive - self.start.drive;
        let loaded = self.slips.first().map_or(loading, |first| driven(&first.before).min(loading));
        let regime = self.regime();
        let is_decided = match regime {
            Regime::Smooth { .. } | Regime::Transient { .. } => driven(&self.last) >= loaded + sliding,
            Regime::Persistent { .. } => regime::lasts(&self.jumps()),
            Regime::Runaway | Regime::Undecided { .. } => false,
        };
        is_decided.then_some(regime)
    }

    /// The results of the motion so far.
    pub fn close(self) -> Slide {
        let regime = self.regime();
        let Self { trace, slips, start, last, .. } = self;
        Slide { trace, slips, energy: last.energy - start.energy, regime, error: None }
    }
}

impl Slide {
    /// The largest difference of F from that of another motion at the `times` requested of both; `None` without times.
    pub(super) fn difference(&self, other: &Self, times: &[f64]) -> Option<f64> {
        let forces = self.forces(times).zip(other.forces(times));
        forces.map(|(own, other)| (own - other).abs()).reduce(f64::max)
    }

    /// F at the `times` that were requested.
    pub(crate) fn forces(&self, times: &[f64]) -> impl Iterator<Item = f64> {
        times.iter().map(|&time| self.trace[self.trace.partition_point(|moment| moment.time < time)].force)
    }

    /// The trace: `time`, `drive`, `position`, `velocity`, `force`, `spring_force`, `free`.
    pub fn trace_record(&self) -> Record {
        trace_record(&self.trace)
    }

    /// The slips: `time`, `drive`, `position_before`, `position_after`, `position_turn`, `force_before`, `force_after`,
    /// `drop`, `slip`, `duration`, `velocity`, `broken_fraction`, `dissipated_breaks`, `dissipated_slip`, `strengthening`.
    pub fn events_record(&self) -> Record {
        events_record(&self.slips)
    }

    /// The columns of a trace and of slips, without values.
    pub fn columns() -> [Record; 2] {
        [trace_record(&[]), events_record(&[])]
    }
}

/// The columns of a trace in time.
fn trace_record(trace: &[Moment]) -> Record {
    let mut record = Record::default();
    let mut column = |name: &str, long_name: &str, quantity, value: fn(&Moment) -> f64| {
        record.push(name, long_name, quantity, &["point"], trace.iter().map(value).collect());
    };
    column("time", "time", Quantity::Time, |m| m.time);
    column("drive", "drive", Quantity::Length, |m| m.drive);
    column("position", "position of the slider's base", Quantity::Length, |m| m.position);
    column("velocity", "velocity of the slider's base", Quantity::Velocity, |m| m.velocity);
    column("force", "friction force", Quantity::Force, |m| m.force);
    column("spring_force", "force of the spring", Quantity::Force, |m| m.spring_force);
    column("free", "fraction of contacts that are detached", Quantity::Number, |m| m.free);
    record
}

/// The columns of slips in time.
pub(super) fn events_record(slips: &[RateDependentSlip]) -> Record {
    let mut record = Record::default();
    let mut column = |name: &str, long_name: &str, quantity, value: fn(&RateDependentSlip) -> f64| {
        record.push(name, long_name, quantity, &["event"], slips.iter().map(value).collect());
    };
    let (length, force) = (Quantity::Length, Quantity::Force);
    column("time", "time at which the slip begins", Quantity::Time, |s| s.before.time);
    column("drive", "drive at which the slip begins", length, |s| s.before.drive);
    column("position_before", "position before", length, |s| s.before.position);
    column("position_after", "position after", length, |s| s.after.position);
    column("position_turn", "position of the first rest", length, |s| s.position_turn);
    column("force_before", "force before", force, |s| s.before.force);
    column("force_after", "force after", force, |s| s.after.force);
    column("drop", "force drop", force, RateDependentSlip::drop);
    column("slip", "slip", length, RateDependentSlip::slip);
    column("duration", "how long the slip lasts", Quantity::Time, |s| s.after.time - s.before.time);
    column("velocity", "highest velocity", Quantity::Velocity, |s| s.fastest);
    column("broken_fraction", "breaks per contact", Quantity::Number, |s| s.broken_fraction);
    column("dissipated_breaks", "energy lost in breaks", Quantity::Energy, |s| s.energy.breaks);
    column("dissipated_slip", "energy lost by the slider", Quantity::Energy, |s| s.energy.dissipated());
    let words = "energy that ageing brought by stiffening stretched contacts";
    column("strengthening", words, Quantity::Energy, |s| s.energy.strengthening);
    record
}
