//! Slide–hold–slide tests behind the spring of a machine: against force and state integrated in time by another method.

use asperity::Error;
use asperity::rate_state::{HoldTests, MachineHealing, StateLaw, StateVariable};

const BEFORE: f64 = 0.6;
const VELOCITY: f64 = 10.0;
const STIFFNESS: f64 = 1e-3;
const HOLDS: [f64; 9] = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0, 10000.0];

/// Rate-and-state friction of a slider, with one state variable.
#[derive(Clone, Copy)]
struct Friction {
    a: f64,
    b: f64,
    distance: f64,
    law: StateLaw,
}

impl Friction {
    /// dF/dt and dθ/dt where the load point moves at `load`: the velocity of the slider follows from F and θ.
    fn slope(self, [force, theta]: [f64; 2], load: f64) -> [f64; 2] {
        let Self { a, b, distance, law } = self;
        let state = b * (VELOCITY * theta / distance).ln();
        let velocity = VELOCITY * ((force - BEFORE - state) / a).exp();
        let moved = velocity * theta / distance;
        let evolved = match law {
            StateLaw::Ageing => 1.0 - moved,
            StateLaw::Slip => -moved * moved.ln(),
        };
        [STIFFNESS * (load - velocity), evolved]
    }

    /// A step by the classical method of Runge and Kutta.
    fn step(self, y: [f64; 2], load: f64, by: f64) -> [f64; 2] {
        let moved = |k: [f64; 2], by: f64| [y[0] + by * k[0], y[1] + by * k[1]];
        let k = self.slope(y, load);
        let l = self.slope(moved(k, 0.5 * by), load);
        let m = self.slope(moved(l, 0.5 * by), load);
        let n = self.slope(moved(m, by), load);
        std::array::from_fn(|j| y[j] + by * (k[j] + 2.0 * (l[j] + m[j]) + n[j]) / 6.0)
    }

    /// The highest force after a hold, and the force at its end. Steps of the hold grow with time, as its rates fall.
    fn held(self, hold: f64) -> (f64, f64) {
        let shortest = (self.a / STIFFNESS).min(self.distance) / VELOCITY;
        let (mut y, mut time) = ([BEFORE, self.distance / VELOCITY], 0.0);
        while time < hold {
            let by = (2e-3 * (time + shortest)).min(hold - time);
            y = self.step(y, 0.0, by);
            time += by;
        }
        let end = y[0];
        let mut highest = end;
        // The velocity grows by the factor e in a/(K v), until it is reached.
        loop {
            y = self.step(y, VELOCITY, 2e-4 * shortest);
            if y[0] < highest {
                return (highest, end);
            }
            highest = y[0];
        }
    }
}

fn tests<'a>(peak: &'a [f64], held: Option<&'a [f64]>) -> HoldTests<'a> {
    HoldTests { hold: &HOLDS, peak, held, before: BEFORE, velocity: VELOCITY, stiffness: STIFFNESS }
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "{found} is not {expected}");
}

#[test]
fn peaks_and_relaxation_give_back_the_friction_they_were_made_of() {
    for (a, b, distance, law) in [
        (0.01, 0.013, 5.0, StateLaw::Ageing),
        (0.012, 0.008, 2.0, StateLaw::Ageing),
        (0.01, 0.013, 5.0, StateLaw::Slip),
    ] {
        let friction = Friction { a, b, distance, law };
        let (peak, held): (Vec<f64>, Vec<f64>) = HOLDS.iter().map(|hold| friction.held(*hold)).unzip();
        for (direct, held) in [(Some(a), None), (None, Some(held.as_slice())), (Some(a), Some(&held))] {
            let read = MachineHealing::read(&tests(&peak, held), law, direct, &mut ()).unwrap();
            // Integrated to 1e-8 of a factor e of velocity here, and with steps of 2e-3 of its time there, to the fourth power.
            assert!(read.residual_relative < 1e-6, "{read:?}");
            // Times what a fit amplifies.
            near(read.direct, a, 1e-4);
            near(read.state.evolution, b, 1e-4);
            near(read.state.distance, distance, 1e-3);
        }
    }
}

/// Peaks alone, by SciPy's LSODA with a relative tolerance of 1e-10, for a = 0.01, b = 0.013, D = 5 by the slip law: the sum of
/// squares is a narrow curved valley along b and D.
#[test]
fn peaks_of_the_slip_law_give_back_b_and_the_slip_distance() {
    let hold = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0];
    let peak = [
        0.605899755205299,
        0.6095719852540482,
        0.6144486784242149,
        0.619513872113248,
        0.6256037134305603,
        0.6315649747262321,
        0.6384674815860942,
        0.6450532201284391,
    ];
    let tests =
        HoldTests { hold: &hold, peak: &peak, held: None, before: 0.6, velocity: 10.0, stiffness: 0.01 };
    let read = MachineHealing::read(&tests, StateLaw::Slip, Some(0.01), &mut ()).unwrap();
    // The peaks are exact to 1e-8, which the valley amplifies.
    near(read.state.evolution, 0.013, 1e-3);
    near(read.state.distance, 5.0, 2e-3);
}

#[test]
fn the_curve_of_a_reading_is_that_of_its_friction() {
    let friction = Friction { a: 0.01, b: 0.013, distance: 5.0, law: StateLaw::Ageing };
    let (peak, held): (Vec<f64>, Vec<f64>) = HOLDS.iter().map(|hold| friction.held(*hold)).unzip();
    let read = MachineHealing::read(&tests(&peak, Some(&held)), friction.law, None, &mut ()).unwrap();
    // Holds that were not fitted, in any order.
    for (hold, (peak, end)) in [20.0, 2.0, 500.0].into_iter().zip(read.forces(&[20.0, 2.0, 500.0])) {
        let expected = friction.held(hold);
        // As above, of forces of the size of 1.
        assert!((peak - expected.0).abs() < 1e-7 && (end - expected.1).abs() < 1e-7);
    }
}

#[test]
fn after_long_holds_peaks_of_the_ageing_law_grow_by_b_and_less_in_a_soft_machine() {
    let state = StateVariable { evolution: 0.013, distance: 5.0 };
    let friction = Friction { a: 0.01, b: state.evolution, distance: state.distance, law: StateLaw::Ageing };
    let (peak, held): (Vec<f64>, Vec<f64>) = HOLDS.iter().map(|hold| friction.held(*hold)).unzip();
    let read = MachineHealing::read(&tests(&peak, Some(&held)), friction.law, None, &mut ()).unwrap();
    let peaks = read.forces(&[1e7, 1e8]);
    // β = b once V θ/D is small, which falls as t^{1 − b/a} = t^{−0.3}: to 0.004 here, times D over the slip of some a/K.
    near((peaks[1].0 - peaks[0].0) / f64::ln(10.0), 0.013, 2e-3);
    // A rigid slider does not move in the hold: θ = D/v + t.
    assert!(peaks[0].0 - BEFORE < 0.013 * (VELOCITY * 1e7 / 5.0).ln());
}

#[test]
fn the_misfit_tells_the_law() {
    let friction = Friction { a: 0.01, b: 0.013, distance: 5.0, law: StateLaw::Slip };
    let (peak, held): (Vec<f64>, Vec<f64>) = HOLDS.iter().map(|hold| friction.held(*hold)).unzip();
    let misfit =
        |law| MachineHealing::read(&tests(&peak, Some(&held)), law, None, &mut ()).unwrap().residual_relative;
    assert!(misfit(StateLaw::Ageing) > 100.0 * misfit(StateLaw::Slip));
}

#[test]
fn wrong_arguments_are_refused() {
    let peak: Vec<f64> = HOLDS.iter().map(|hold| BEFORE + 0.01 * hold.ln_1p()).collect();
    let right = tests(&peak, None);
    let key = |tests: HoldTests<'_>, direct| match MachineHealing::read(
        &tests,
        StateLaw::Ageing,
        direct,
        &mut (),
    ) {
        Err(Error::Invalid { key, .. }) => key,
        other => panic!("{other:?}"),
    };
    let direct = Some(0.01);
    assert_eq!(key(HoldTests { hold: &HOLDS[..3], peak: &peak[..3], ..right }, direct), "hold");
    assert_eq!(key(HoldTests { peak: &peak[1..], ..right }, direct), "force");
    assert_eq!(key(HoldTests { held: Some(&peak[1..]), ..right }, direct), "held");
    assert_eq!(key(HoldTests { hold: &HOLDS.map(|hold| hold - 3.0), ..right }, direct), "hold.0");
    assert_eq!(key(HoldTests { before: f64::NAN, ..right }, direct), "before");
    assert_eq!(key(HoldTests { velocity: 0.0, ..right }, direct), "velocity");
    assert_eq!(key(HoldTests { stiffness: -1.0, ..right }, direct), "stiffness");
    assert_eq!(key(HoldTests { peak: &[BEFORE; 9], ..right }, direct), "force");
    assert_eq!(key(right, Some(0.0)), "a");
    let Err(Error::Invalid { key, expected, .. }) =
        MachineHealing::read(&right, StateLaw::Ageing, None, &mut ())
    else {
        panic!("neither a nor the forces in the holds")
    };
    assert!(key == "a" && expected.contains("peaks alone do not determine a"), "{expected}");
}
