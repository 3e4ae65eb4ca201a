//! The summary of a run, written to `summary.json`: a few numbers for each task.

mod catalogue;
mod creep;
mod fit;
mod posterior;
mod renormalisation;
mod stick_slip;
mod time;

use crate::block::{End, Point, Regime, Slide, StickSlip};
use crate::scenario::{Disorder, Units};
use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub use crate::rate_state::Fitted;
pub use catalogue::{Catalogue, Largest, MainShockNumbers, OmoriLaw, PowerLaw};
pub use creep::{CreepAtForce, CreepNumbers};
pub use fit::{FitFixed, FitFreeForm, FitFriction, FitLaw, FitLaws, FitNumber, FitSummary, Uncertain};
pub use posterior::{PosteriorNumber, PosteriorSummary};
pub use renormalisation::{Compared, FirstBreakStatistics, InterfaceSize};
pub use stick_slip::{SimulatedStickSlip, StickSlipKind, StickSlipNumbers};
pub use time::{
    CurveLimits, HealingCurve, MeasuredRateState, Peak, ProtocolStep, RateState, SlidingStability,
    SpringRateState,
};

/// The summary of a run: what it was, and the numbers of its task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Summary {
    /// The scenario's title.
    pub title: String,
    /// The version of asperity that ran it.
    pub version: String,
    /// Labels of units.
    pub units: Units,
    /// Estimated error of F/(N_c⟨k⟩), a length; absent where all contacts are followed one by one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub accuracy: Option<f64>,
    /// Number of contacts N_c of the forces.
    #[schemars(extend("x-dimension" = "1"))]
    pub contacts: f64,
    /// Background force B, which all friction forces of the results contain; absent if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub background_force: Option<f64>,
    /// Normal load, by which forces are divided for friction coefficients; absent if none is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub normal_load: Option<f64>,
    /// Number of contacts of the finite-size band and of the ensemble.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "1"))]
    pub sample: Option<f64>,
    /// Seed of the random numbers; null where none were drawn.
    pub seed: Option<u64>,
    /// Whether a contact of the ensemble got a new threshold when it re-formed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disorder: Option<Disorder>,
    /// The numbers of the task.
    #[serde(flatten)]
    pub numbers: Numbers,
    /// Warnings about valid but surprising input or results.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// The numbers of a task; the key `task` is its name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "task", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Numbers {
    /// Of `[pull]`.
    Pull(PullNumbers),
    /// Of `[drive]` of a slider.
    Drive(DriveNumbers),
    /// Of `[drive]` of an `[interface]`.
    InterfaceDrive(InterfaceNumbers),
    /// Of `[[protocol]]` of a rigid slider.
    Protocol(ProtocolNumbers),
    /// Of `[[protocol]]` of a `[block]`.
    BlockProtocol(BlockNumbers),
    /// Of `[velocity_curve]`.
    VelocityCurve(VelocityCurveNumbers),
    /// Of `[hold_curve]`.
    HoldCurve(HoldCurveNumbers),
    /// Of `[creep]`.
    Creep(CreepNumbers),
    /// Of `[spectrum]`.
    Spectrum(SpectrumNumbers),
    /// Of `[stability]`.
    Stability(StabilityNumbers),
    /// Of `[fit]`.
    Fit(FitNumbers),
    /// Of `[renormalisation]`.
    Renormalisation(RenormalisationNumbers),
}

/// The numbers of a pull.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PullNumbers {
    /// Static and kinetic friction, and the relaxation from one to the other.
    #[serde(flatten)]
    pub friction: Friction,
    /// The derivatives of friction by the parameters of the contacts, if they were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub derivatives: Vec<FrictionDerivative>,
    /// Comparison of a measured curve with F(X).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compare: Option<Comparison>,
}

/// The derivatives of friction by a parameter of the contacts, per unit of the parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrictionDerivative {
    /// Name of the parameter, as `thresholds.mean` or `count`.
    pub parameter: String,
    /// Value of the parameter.
    pub value: f64,
    /// ∂F_s/∂θ; absent if static friction was not reached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub static_friction: Option<f64>,
    /// ∂F_k/∂θ.
    pub kinetic_friction: f64,
    /// ∂X*/∂θ.
    pub relaxation_length: Extended,
    /// ∂K_c/∂θ.
    pub critical_stiffness: Extended,
}

/// The numbers of a slider whose top is driven.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DriveNumbers {
    /// Friction of a pull of its base, at the velocity of the drive if there is one.
    #[serde(flatten)]
    pub friction: Friction,
    /// The motion of the slider; absent for a rigid slider over time-dependent contacts.
    #[serde(flatten, default, skip_serializing_if = "Option::is_none")]
    pub sliding: Option<Sliding>,
}

/// The numbers of an interface that is driven.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InterfaceNumbers {
    /// The catalogue of events.
    pub catalogue: Catalogue,
}

/// The numbers of a rigid slider that is moved in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProtocolNumbers {
    /// Estimated upper limit of the error of the force.
    pub force_error: f64,
    /// The steps.
    pub steps: Vec<ProtocolStep>,
    /// Comparison of a measured curve with F(X).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compare: Option<Comparison>,
}

/// The numbers of a block that is moved in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BlockNumbers {
    /// The motion of the slider.
    #[serde(flatten)]
    pub sliding: Sliding,
    /// The steps, if a measured curve is compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<ProtocolStep>,
    /// Comparison of a measured curve with the force of the spring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compare: Option<Comparison>,
}

/// The numbers of a velocity curve, or of one for each of several temperatures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VelocityCurveNumbers {
    /// Limits of the curves.
    pub limits: Vec<CurveLimits>,
    /// Stability of steady sliding at all velocities of the curves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<SlidingStability>,
    /// A measured curve beside the computed one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compare: Option<Comparison>,
}

/// The numbers of a hold curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HoldCurveNumbers {
    /// Steady sliding, and the growth of static friction with the logarithm of the hold time.
    pub hold_curve: HealingCurve,
    /// A measured curve beside the computed one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compare: Option<Comparison>,
}

/// The numbers of the noise of steady sliding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpectrumNumbers {
    /// The noise.
    pub noise: Noise,
}

/// The noise of the force of a finite number of contacts in steady sliding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Noise {
    /// Number of contacts.
    pub size: f64,
    /// F_k, the mean force.
    #[schemars(extend("x-dimension" = "force"))]
    pub kinetic_friction: f64,
    /// Standard deviation of the force.
    #[schemars(extend("x-dimension" = "force"))]
    pub force_std: f64,
    /// Mean displacement between breaks of a contact; the spectrum has peaks at multiples of 2π over it.
    #[schemars(extend("x-dimension" = "length"))]
    pub mean_life: f64,
    /// S(0), a force squared times a length: the force averaged over a long displacement L has the variance S(0)/L.
    pub at_zero: f64,
    /// Limit of q² S(q)/(2 F_k) for large q with the F_k of the contacts alone, a force per length: the stiffness of one
    /// contact where contacts re-form at 0.
    pub tail: f64,
}

/// The numbers of a slider behind springs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StabilityNumbers {
    /// Whether it sticks and slips, at each velocity.
    pub stick_slip: Vec<StickSlipNumbers>,
}

/// The numbers of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitNumbers {
    /// What the fit has found.
    pub fit: FitSummary,
}

/// The numbers of a renormalisation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RenormalisationNumbers {
    /// The distribution of first breaks of coupled contacts.
    pub renormalisation: FirstBreakStatistics,
}

macro_rules! numbers {
    ($($of:ident => $variant:ident,)*) => {$(
        impl From<$of> for Numbers {
            fn from(numbers: $of) -> Self {
                Self::$variant(numbers)
            }
        }
    )*};
}

numbers! {
    PullNumbers => Pull,
    DriveNumbers => Drive,
    InterfaceNumbers => InterfaceDrive,
    ProtocolNumbers => Protocol,
    BlockNumbers => BlockProtocol,
    VelocityCurveNumbers => VelocityCurve,
    HoldCurveNumbers => HoldCurve,
    CreepNumbers => Creep,
    SpectrumNumbers => Spectrum,
    StabilityNumbers => Stability,
    FitNumbers => Fit,
    RenormalisationNumbers => Renormalisation,
}

impl Numbers {
    /// Static and kinetic friction; `None` unless the task has a pull at one velocity.
    pub fn friction(&self) -> Option<&Friction> {
        match self {
            Self::Pull(PullNumbers { friction, .. }) | Self::Drive(DriveNumbers { friction, .. }) => {
                Some(friction)
            }
            _ => None,
        }
    }

    /// The derivatives of friction by the parameters of the contacts; none unless they were asked for.
    pub fn derivatives(&self) -> &[FrictionDerivative] {
        match self {
            Self::Pull(PullNumbers { derivatives, .. }) => derivatives,
            _ => &[],
        }
    }

    /// The motion of the slider; `None` unless its top was moved.
    pub fn sliding(&self) -> Option<&Sliding> {
        match self {
            Self::Drive(DriveNumbers { sliding, .. }) => sliding.as_ref(),
            Self::BlockProtocol(BlockNumbers { sliding, .. }) => Some(sliding),
            _ => None,
        }
    }

    /// The catalogue of events; `None` unless the task drives an interface.
    pub fn catalogue(&self) -> Option<&Catalogue> {
        match self {
            Self::InterfaceDrive(InterfaceNumbers { catalogue }) => Some(catalogue),
            _ => None,
        }
    }

    /// The steps of a protocol, of a block only beside a compared curve; none for other tasks.
    pub fn steps(&self) -> &[ProtocolStep] {
        match self {
            Self::Protocol(ProtocolNumbers { steps, .. })
            | Self::BlockProtocol(BlockNumbers { steps, .. }) => steps,
            _ => &[],
        }
    }

    /// The limits of velocity curves; none for other tasks.
    pub fn limits(&self) -> &[CurveLimits] {
        match self {
            Self::VelocityCurve(VelocityCurveNumbers { limits, .. }) => limits,
            _ => &[],
        }
    }

    /// Stability of steady sliding; `None` if it was not computed.
    pub fn stability(&self) -> Option<&SlidingStability> {
        match self {
            Self::VelocityCurve(VelocityCurveNumbers { stability, .. }) => stability.as_ref(),
            _ => None,
        }
    }

    /// The noise of steady sliding; of `[spectrum]`.
    pub fn noise(&self) -> Option<&Noise> {
        match self {
            Self::Spectrum(SpectrumNumbers { noise }) => Some(noise),
            _ => None,
        }
    }

    /// Whether a slider sticks and slips, at each velocity; none for tasks other than `[stability]`.
    pub fn stick_slip(&self) -> &[StickSlipNumbers] {
        match self {
            Self::Stability(StabilityNumbers { stick_slip }) => stick_slip,
            _ => &[],
        }
    }

    /// What a fit has found; `None` for other tasks.
    pub fn fit(&self) -> Option<&FitSummary> {
        match self {
            Self::Fit(FitNumbers { fit }) => Some(fit),
            _ => None,
        }
    }

    /// The healing found from a hold curve; `None` for other tasks.
    pub fn hold_curve(&self) -> Option<&HealingCurve> {
        match self {
            Self::HoldCurve(HoldCurveNumbers { hold_curve, .. }) => Some(hold_curve),
            _ => None,
        }
    }

    /// Creep under each force; none for other tasks.
    pub fn creep(&self) -> &[CreepAtForce] {
        match self {
            Self::Creep(CreepNumbers { creep }) => creep,
            _ => &[],
        }
    }

    /// The distribution of first breaks.
    pub fn renormalisation(&self) -> Option<&FirstBreakStatistics> {
        match self {
            Self::Renormalisation(RenormalisationNumbers { renormalisation }) => Some(renormalisation),
            _ => None,
        }
    }

    /// Comparison of a measured curve with the computed one; `None` without a measured curve.
    pub fn compare(&self) -> Option<&Comparison> {
        match self {
            Self::Pull(PullNumbers { compare, .. })
            | Self::Protocol(ProtocolNumbers { compare, .. })
            | Self::VelocityCurve(VelocityCurveNumbers { compare, .. })
            | Self::HoldCurve(HoldCurveNumbers { compare, .. })
            | Self::BlockProtocol(BlockNumbers { compare, .. }) => compare.as_ref(),
            _ => None,
        }
    }
}

/// Friction from a pull and from steady sliding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Friction {
    /// Static friction F_s and its position X_s.
    pub static_friction: StaticFriction,
    /// Kinetic friction F_k.
    #[schemars(extend("x-dimension" = "force"))]
    pub kinetic_friction: f64,
    /// Relaxation length X*, from the slowest root of the characteristic equation.
    #[schemars(extend("x-dimension" = "length"))]
    pub relaxation_length: Extended,
    /// The paper's estimate x̄²/σ of X*.
    #[schemars(extend("x-dimension" = "length"))]
    pub relaxation_length_paper: Extended,
    /// Critical stiffness K_c.
    #[schemars(extend("x-dimension" = "force/length"))]
    pub critical_stiffness: Extended,
    /// Forces divided by the normal load; absent without a normal load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_coefficients: Option<FrictionCoefficients>,
}

/// The motion of a driven slider.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sliding {
    /// Smooth sliding, or a kind of stick-slip.
    pub regime: SlidingKind,
    /// The reason for that classification, in words.
    pub reason: String,
    /// Whether the slider moved in time. Its numbers are then right to some 1e-4, and to some 1e-10 otherwise.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub timed: bool,
    /// Number of slips.
    #[schemars(extend("x-dimension" = "1"))]
    pub slips: usize,
    /// Mean advance of the drive from slip to slip; absent unless stick-slip is persistent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub period: Option<f64>,
    /// Mean force drop of such a slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub mean_drop: Option<f64>,
    /// Mean displacement of the slider in such a slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub mean_slip: Option<f64>,
    /// Coefficient of variation of the advances from slip to slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "1"))]
    pub scatter: Option<f64>,
    /// State at the first instability; absent if there was none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_instability: Option<SliderState>,
    /// State from which the slider ran away under an imposed force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub runaway: Option<SliderState>,
    /// The motion over the ensemble.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ensemble: Option<Box<Sliding>>,
}

/// Kinds of sliding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SlidingKind {
    /// No slips.
    Smooth,
    /// Slips that end; smooth sliding afterwards.
    Transient,
    /// Periodic slips that do not end.
    Persistent,
    /// An imposed force that the contacts could not carry.
    Runaway,
    /// The drive was too short to decide.
    Undecided,
}

/// A state of the slider.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SliderState {
    /// Position X of its base.
    #[schemars(extend("x-dimension" = "length"))]
    pub position: f64,
    /// Friction force.
    #[schemars(extend("x-dimension" = "force"))]
    pub force: f64,
    /// The drive: position X_T of its top, or the imposed force.
    pub drive: f64,
}

impl Sliding {
    /// The summary of a quasistatic drive.
    pub fn new(run: &StickSlip) -> Self {
        let first = run.events.first().map(|event| event.before);
        let mut sliding = Self::of_regime(run.regime, run.events.len(), first);
        let counted = match run.regime {
            Regime::Smooth { .. } => 0,
            Regime::Transient { slips, .. } | Regime::Persistent { slips, .. } => slips,
            Regime::Undecided { slips, .. } => slips,
            Regime::Runaway => run.events.len(),
        };
        if counted < run.events.len() {
            sliding.reason = format!("since the drive turned last: {}", run.regime);
        }
        if let End::Runaway(point) = run.end {
            sliding.runaway = Some(point.into());
        }
        sliding
    }

    /// The summary of a motion in time.
    pub fn in_time(run: &Slide) -> Self {
        let first = run.slips.first().map(|slip| slip.before.point());
        Self { timed: true, ..Self::of_regime(run.regime, run.slips.len(), first) }
    }

    fn of_regime(regime: Regime, slips: usize, first: Option<Point>) -> Self {
        let mut sliding = Self {
            regime: SlidingKind::Undecided,
            reason: regime.to_string(),
            timed: false,
            slips,
            period: None,
            mean_drop: None,
            mean_slip: None,
            scatter: None,
            first_instability: first.map(SliderState::from),
            runaway: None,
            ensemble: None,
        };
        sliding.regime = match regime {
            Regime::Smooth { .. } => SlidingKind::Smooth,
            Regime::Transient { .. } => SlidingKind::Transient,
            Regime::Persistent { period, drop, slip, scatter, .. } => {
                (sliding.period, sliding.mean_drop) = (Some(period), Some(drop));
                (sliding.mean_slip, sliding.scatter) = (Some(slip), Some(scatter));
                SlidingKind::Persistent
            }
            Regime::Runaway => SlidingKind::Runaway,
            Regime::Undecided { .. } => SlidingKind::Undecided,
        };
        sliding
    }
}

impl From<Point> for SliderState {
    fn from(Point { position, force, drive, .. }: Point) -> Self {
        Self { position, force, drive }
    }
}

/// Static friction: the highest force of the pull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StaticFriction {
    /// The force had not passed its maximum when the pull ended.
    NotReached,
    /// The force had passed its maximum.
    Reached {
        /// F_s.
        force: f64,
        /// X_s.
        position: f64,
    },
}

/// A number that may be infinite (`"infinite"` in JSON) or unknown (`null`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extended(pub f64);

/// Friction coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrictionCoefficients {
    /// The normal load.
    #[schemars(extend("x-dimension" = "force"))]
    pub normal_load: f64,
    /// Static friction coefficient: F_s divided by the load; absent if static friction was not reached.
    #[serde(rename = "static", default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "1"))]
    pub at_rest: Option<f64>,
    /// Kinetic friction coefficient: F_k divided by the load.
    #[schemars(extend("x-dimension" = "1"))]
    pub kinetic: f64,
}

/// Comparison of a measured curve with the computed one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Comparison {
    /// Number of measured points within the computed curve.
    pub points: usize,
    /// Number of all measured points.
    #[serde(default)]
    pub measured: usize,
    /// Root mean square of measured minus computed force at these points; absent if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub residual_rms: Option<f64>,
}

const NOT_REACHED: &str = "not reached";
const INFINITE: &str = "infinite";

/// JSON form of these values: a word or the value itself.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum WordOr<T> {
    Word(String),
    Value(T),
}

fn unexpected<E: serde::de::Error>(word: &str, known: &str) -> E {
    E::custom(format!("expected a value or \"{known}\", got \"{word}\""))
}

impl Serialize for StaticFriction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::NotReached => WordOr::<Peak>::Word(NOT_REACHED.to_owned()),
            Self::Reached { force, position } => WordOr::Value(Peak { force, position }),
        }
        .serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for StaticFriction {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match WordOr::<Peak>::deserialize(deserializer)? {
            WordOr::Value(Peak { force, position }) => Ok(Self::Reached { force, position }),
            WordOr::Word(word) if word == NOT_REACHED => Ok(Self::NotReached),
            WordOr::Word(word) => Err(unexpected(&word, NOT_REACHED)),
        }
    }
}

impl Serialize for Extended {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_infinite() { WordOr::Word(INFINITE.to_owned()) } else { WordOr::Value(self.0) }
            .serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Extended {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match WordOr::<Option<f64>>::deserialize(deserializer)? {
            WordOr::Value(value) => Ok(Self(value.unwrap_or(f64::NAN))),
            WordOr::Word(word) if word == INFINITE => Ok(Self(f64::INFINITY)),
            WordOr::Word(word) => Err(unexpected(&word, INFINITE)),
        }
    }
}

impl JsonSchema for StaticFriction {
    fn schema_name() -> Cow<'static, str> {
        "StaticFriction".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let reached = generator.subschema_for::<Peak>();
        json_schema!({ "anyOf": [reached, { "type": "string", "const": NOT_REACHED }] })
    }
}

impl JsonSchema for Extended {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Extended".into()
    }

    fn json_schema(_generator: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": ["number", "string", "null"] })
    }
}

impl std::fmt::Display for Extended {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_infinite() { f.pad(INFINITE) } else { self.0.fmt(f) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stand_for_what_has_no_number() {
        let json = serde_json::to_string(&(StaticFriction::NotReached, Extended(f64::INFINITY))).unwrap();
        assert_eq!(json, r#"["not reached","infinite"]"#);
        let back: (StaticFriction, Extended) = serde_json::from_str(&json).unwrap();
        assert_eq!(back, (StaticFriction::NotReached, Extended(f64::INFINITY)));
    }

    #[test]
    fn what_is_not_known_is_null() {
        assert_eq!(serde_json::to_string(&Extended(f64::NAN)).unwrap(), "null");
        assert!(serde_json::from_str::<Extended>("null").unwrap().0.is_nan());
    }

    #[test]
    fn other_words_are_refused() {
        let error = serde_json::from_str::<Extended>(r#""many""#).unwrap_err().to_string();
        assert!(error.contains("infinite") && error.contains("many"), "{error}");
    }
}
