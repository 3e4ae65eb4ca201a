//! Steady sliding of a slider with mass and damping: its characteristic equation against closed forms, quadrature, and motion in time.

use std::sync::{Arc, OnceLock};

use crate::common::{contacts, gaussian, point, rectangular};
use asperity::block::{Block, Loading, Regime, Slide, Slip};
use asperity::contacts::{
    Ageing, Barrier, Contacts, FreeFriction, FreeTime, Hazard, Initial, Rules, Stiffness, Temperature,
};
use asperity::history::{History, Piece};
use asperity::law::{Exponential, Gamma, Mixture, SharedLaw};
use asperity::master::{DynamicStiffness, MasterEquation, Slider, Transport};
use asperity::numerics::legendre::RULE;
use num_complex::Complex64;

/// Thresholds of mean 1 and σ = 0.2 that grow by 2 % per factor e in age, τ₀ = 1.
const GROWTH: f64 = 0.02;
const STD: f64 = 0.2;
const VELOCITY: f64 = 1e-3;

fn ageing() -> Contacts {
    let rules = Rules { ageing: Some(Ageing::Logarithmic { growth: GROWTH, time: 1.0 }), ..Rules::default() };
    Contacts { rules, ..contacts(&gaussian(1.0, STD), &point(0.0)) }
}

/// Computed once for all tests.
fn response() -> &'static DynamicStiffness {
    static RESPONSE: OnceLock<DynamicStiffness> = OnceLock::new();
    RESPONSE.get_or_init(|| DynamicStiffness::new(&ageing(), VELOCITY).unwrap())
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}: {:e}", found - expected);
}

/// Contacts whose force forgets a step as −e^{−t}: F̂ = −s/(1 + s).
fn forgetting() -> DynamicStiffness {
    let time: Vec<f64> = (0..=2500).map(|k| f64::from(k) * 8e-3).collect();
    let response = time.iter().map(|t| -(-t).exp()).collect();
    DynamicStiffness::of_step_response(1.0, time, response)
}

/// What straight lines between the times are off in `forgetting`: h²/8 of the response, h = 8e-3. At the last time 2e-9 are left.
const STRAIGHT: f64 = 1e-5;

#[test]
fn the_critical_stiffness_is_that_of_routh_and_hurwitz() {
    // (Ms² + γs + K)(1 + s) − s = Ms³ + (M + γ)s² + (γ + K − 1)s + K: stable for (M + γ)(γ + K − 1) > MK.
    let response = forgetting();
    for (mass, damping) in [(0.0, 0.3), (1.0, 0.3), (20.0, 0.3), (1.0, 0.9), (0.01, 0.1)] {
        let closed: f64 = (mass + damping) * (1.0 - damping) / damping;
        let (found, frequency) =
            response.critical_stiffness(Slider { mass, damping }, &mut ()).unwrap().unwrap();
        // Relative, 1/γ being what the error of F̂ is multiplied by.
        near(found / closed, 1.0, STRAIGHT * (1.0 + 1.0 / damping) * 10.0);
        let slider = Slider { mass, damping };
        assert_eq!(response.unstable_roots(slider, 1.001 * closed, &mut ()).unwrap(), 0);
        assert_eq!(response.unstable_roots(slider, 0.999 * closed, &mut ()).unwrap(), 2);
        assert!(frequency > 0.0);
    }
    // Damping that takes more than the contacts give, and no damping at all.
    assert_eq!(response.critical_stiffness(Slider { mass: 1.0, damping: 1.1 }, &mut ()).unwrap(), None);
    let undamped = Slider { mass: 1.0, damping: 0.0 };
    assert_eq!(response.critical_stiffness(undamped, &mut ()).unwrap(), Some((f64::INFINITY, f64::INFINITY)));
    assert_eq!(response.critical_stiffness(Slider::default(), &mut ()).unwrap(), Some((1.0, f64::INFINITY)));
}

#[test]
fn deviations_grow_as_the_roots_of_the_cubic_say() {
    let response = forgetting();
    for (stiffness, mass, damping) in [
        (0.5, 1.0, 0.0),
        (14.0, 1.0, 0.0),
        (0.5, 1.0, 0.3),
        (0.05, 0.2, 0.1),
        (0.3, 0.0, 0.1),
        (0.4, 1e-4, 1e-3),
    ] {
        let slider = Slider { mass, damping };
        let s = response.growth(slider, stiffness, &mut ()).unwrap().unwrap();
        let cubic = ((mass * s + (mass + damping)) * s + (damping + stiffness - 1.0)) * s + stiffness;
        let slope = (3.0 * mass * s + 2.0 * (mass + damping)) * s + (damping + stiffness - 1.0);
        // Where the root is by the cubic; 1 + s is what it was multiplied by.
        let off = (cubic / slope).norm();
        assert!(off < 1e-4 * s.norm(), "{slider:?} {stiffness}: {s}, off by {off:e}");
        // The product of all roots is −K/M and their sum −(M + γ)/M, so that the third root is known: it is not to the right.
        if mass > 0.0 && s.im > 0.0 {
            assert!(-(mass + damping) / mass - 2.0 * s.re < s.re);
        }
    }
    assert_eq!(response.growth(Slider { mass: 1.0, damping: 1.1 }, 0.5, &mut ()).unwrap(), None);
    assert!(response.growth(Slider::default(), 0.5, &mut ()).is_err());
}

/// F̂ of contacts with logarithmic ageing, per deviation e^{qX} of X = vt: every cohort has the threshold law P_c at x/g(a),
/// g = 1 + β ln(1 + a/τ₀), a = x/v, and the births change so that contacts stay as many.
fn by_quadrature(q: Complex64) -> Complex64 {
    let growth = |x: f64| 1.0 + GROWTH * (x / VELOCITY).ln_1p();
    let survival = |x: f64| asperity::law::Law::survival(gaussian(1.0, STD).as_ref(), x / growth(x));
    let density =
        |x: f64| asperity::law::Law::density(gaussian(1.0, STD).as_ref(), x / growth(x)) / growth(x);
    let mut walls: Vec<f64> =
        (0..=20).map(|k| VELOCITY * 10.0_f64.powf(-3.0 + 0.25 * f64::from(k))).collect();
    walls.extend((1..=150).map(|k| 0.02 * f64::from(k)));
    walls.insert(0, 0.0);
    walls.sort_by(f64::total_cmp);
    let integral = |f: &dyn Fn(f64) -> Complex64| -> Complex64 {
        let part = |pair: &[f64]| {
            let of = |part: fn(Complex64) -> f64| RULE.integrate(pair[0], pair[1], |x| part(f(x)));
            Complex64::new(of(|z| z.re), of(|z| z.im))
        };
        walls.windows(2).map(part).sum()
    };
    let late = |x: f64| (-q * x).exp();
    let lost = integral(&|x| (survival(x) - x * density(x)) * (1.0 - late(x)));
    let births = integral(&|x| density(x) * (1.0 - late(x))) / integral(&|x| survival(x) * late(x));
    (lost + births * integral(&|x| x * survival(x) * late(x))) / integral(&|x| survival(x).into())
}

#[test]
fn the_dynamic_stiffness_is_that_of_quadrature() {
    let response = response();
    let frequencies = [0.3, 1.0, 3.0, 6.0].map(|im| Complex64::new(0.0, im));
    for q in frequencies.into_iter().chain([Complex64::new(1.0, 3.0), Complex64::new(5.0, 0.0)]) {
        let (found, exact) = (response.at(VELOCITY * q), by_quadrature(q));
        // The panels of the reference, at most a tenth of the width of thresholds, and its lowest age: 1e-11.
        assert!((found - exact).norm() < 1e-10, "{q}: {found} instead of {exact}");
    }
}

/// Contacts that age and never break thermally, with an attempt rate of next to nothing, of which all ages are integrated.
fn by_ages() -> Contacts {
    let mut contacts = ageing();
    contacts.rules.temperature = Some(Temperature::new(0.01, 1e-30));
    contacts
}

#[test]
fn the_integrals_over_ages_give_the_dynamic_stiffness() {
    let integrated = DynamicStiffness::new(&by_ages(), VELOCITY).unwrap();
    for q in [[0.0, 0.3], [0.0, 3.0], [0.0, 6.0], [1.0, 3.0]].map(|q| Complex64::new(q[0], q[1])) {
        let (found, exact) = (integrated.at(VELOCITY * q), by_quadrature(q));
        // The trapezoidal rule over 2000 ages of each threshold, (|q|/2000)²/12, which is extrapolated, and rounding of sums.
        assert!((found - exact).norm() < 1e-5, "{q}: {found} instead of {exact}");
    }
    let (critical, frequency) = integrated.critical_stiffness(Slider::default(), &mut ()).unwrap().unwrap();
    let closed = response().critical_stiffness(Slider::default(), &mut ()).unwrap().unwrap();
    // The same rule.
    near(critical, closed.0, 1e-5);
    assert_eq!(frequency, closed.1);
}

/// Contacts that re-form over a range have no closed form, and are followed in time.
#[test]
fn ageing_contacts_followed_in_time_have_the_response_in_closed_form() {
    let spread = Contacts { reforming: rectangular(0.0, 2e-3), ..ageing() };
    let followed = DynamicStiffness::followed(&spread, VELOCITY, 20.0, 3e-6, &mut ()).unwrap();
    for q in [[0.0, 0.3], [0.0, 1.0], [0.0, 3.0], [0.0, 6.0], [1.0, 3.0]].map(|q| Complex64::new(q[0], q[1]))
    {
        let (found, exact) = (followed.at(VELOCITY * q), response().at(VELOCITY * q));
        // The step is a hundredth of the width of thresholds, and its second order that share of the response; so is the range, of
        // the mean threshold. Forces between the times are on straight lines.
        assert!((found - exact).norm() < 2e-2 * exact.norm() + 1e-3, "{q}: {found} instead of {exact}");
    }
}

/// v dF_k/dv of the renewal equation, by differences of fourth order over 2e-3 of v.
fn slope_of_friction(contacts: &Contacts, velocity: f64) -> f64 {
    let at = |k: f64| {
        let velocity = velocity * (1.0 + 1e-3 * k);
        let equation = MasterEquation::at(contacts.clone(), &Initial::default(), velocity).unwrap();
        equation.steady_state().kinetic_friction()
    };
    (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / 12e-3
}

/// F̂ ≈ s dF_k/dv at low frequencies, with F_k of the renewal equation: below and above the velocity
/// at which fresh thresholds grow faster than contacts stretch.
#[test]
fn the_response_of_ageing_contacts_integrates_to_the_slope_of_kinetic_friction() {
    let logarithmic = Ageing::Logarithmic { growth: 0.1, time: 1.0 };
    let weakening = Ageing::FrozenRank { mature: gaussian(0.8, 0.1), time: 2.0 };
    let gaussians = Ageing::FrozenRank { mature: gaussian(1.2, 0.05), time: 2.0 };
    let ranks = Ageing::FrozenRank { mature: Arc::new(Gamma::new(1.1, 0.2).unwrap()), time: 2.0 };
    let two: SharedLaw = Arc::new(Mixture::new(vec![(0.6, point(0.0)), (0.4, point(0.3))]).unwrap());
    let medium: SharedLaw = Arc::new(Gamma::new(1.0, 0.5).unwrap());
    let cases = [
        (gaussian(1.0, 0.2), point(0.0), &logarithmic),
        (gaussian(1.0, 0.01), point(0.1), &logarithmic),
        (rectangular(0.5, 1.5), two.clone(), &logarithmic),
        (gaussian(1.0, 0.1), two, &weakening),
        (medium.clone(), point(0.0), &logarithmic),
        (gaussian(1.0, 0.1), point(0.0), &gaussians),
        (medium, point(0.0), &ranks),
    ];
    for (thresholds, reforming, ageing) in cases {
        let rules = Rules { ageing: Some(ageing.clone()), ..Rules::default() };
        let contacts = Contacts { rules, ..contacts(&thresholds, &reforming) };
        for velocity in [1e-3, 0.03, 3.0] {
            let slope = slope_of_friction(&contacts, velocity);
            let response = DynamicStiffness::new(&contacts, velocity).unwrap();
            let found = velocity * response.integral();
            println!(
                "{} {} {velocity}: {found} {slope} {:e}",
                thresholds.name(),
                ageing.name(),
                found - slope
            );
            // F_k to 1e-14, and of tabulated ranks to 1e-11, over 1e-3 of v.
            near(found, slope, 1e-8);
        }
    }
}

/// A slider over contacts in steady sliding, stopped for a moment and pulled on by `drive`.
/// Contacts with a delay τ and the friction f of free contacts: F̂ in closed form for exponential thresholds of mean 1, with
/// φ̂ = v/(s + v), H = 1/(s + v) and P = v/(s + v)².
#[test]
fn a_delay_changes_the_dynamic_stiffness_as_the_closed_form_says() {
    let exponential: SharedLaw = Arc::new(Exponential::new(1.0).unwrap());
    let (velocity, delay, friction) = (0.7, 3.0, 0.4);
    let free_friction = FreeFriction { force: friction, ..FreeFriction::default() };
    let times: [FreeTime; 2] =
        [delay.into(), FreeTime::Distributed(Arc::new(Exponential::new(delay).unwrap()))];
    for (case, delay) in times.into_iter().enumerate() {
        let rules = Rules { delay, free_friction, ..Rules::default() };
        let contacts = Contacts { rules, ..contacts(&exponential, &point(0.0)) };
        let response = DynamicStiffness::new(&contacts, velocity).unwrap();
        let attached = 1.0 / (1.0 + 3.0 * velocity);
        let closed = |s: Complex64| {
            let back = if case == 0 { (-3.0 * s).exp() } else { 1.0 / (1.0 + 3.0 * s) };
            let [held, carried] = [1.0 / (s + velocity), velocity / (s + velocity).powi(2)];
            attached * s * (1.0 - back) * (friction * held - carried) / (1.0 - back * velocity * held)
        };
        for s in [[0.0, 0.01], [0.0, 0.5], [0.0, 2.0], [0.0, 30.0], [0.3, 1.0]] {
            let s = Complex64::new(s[0], s[1]);
            // Time-independent but for the delay: as accurate as the life, cut where 1e-18 of the contacts are left.
            assert!((response.at(s) - closed(s)).norm() < 1e-9, "{s} {} {}", response.at(s), closed(s));
        }
        let slope = closed(Complex64::new(1e-6, 0.0)).re / 1e-6;
        // The next order of the closed form at s = 1e-6.
        near(response.integral(), slope, 1e-5);
    }
}

/// K_c of contacts with a delay: Eqs. (small deviations) and (dynamic stiffness), integrated by trapezoids of 4000 ages and
/// thresholds on a grid of 1e5 frequencies (NumPy).
#[test]
fn the_critical_stiffness_with_a_delay_is_that_of_the_renewal_equation() {
    let delayed = |delay: f64| Rules { delay: delay.into(), ..Rules::default() };
    for (velocity, expected) in [(0.5, 22.77), (1.0, 20.339), (2.0, 13.46)] {
        let contacts = Contacts { rules: delayed(3.0), ..contacts(&gaussian(1.0, 0.1), &point(0.0)) };
        let response = DynamicStiffness::new(&contacts, velocity).unwrap();
        let found = response.critical_stiffness(Slider::default(), &mut ()).unwrap().unwrap();
        // Digits of the reference.
        near(found.0 / expected, 1.0, 5e-4);
    }
}

#[test]
fn contacts_that_are_all_alike_stay_in_phase_beside_one_delay() {
    let rules = |delay: FreeTime| Rules { delay, ..Rules::default() };
    let response = |delay: FreeTime| {
        let alike = Contacts { rules: rules(delay), ..contacts(&point(1.0), &point(0.0)) };
        DynamicStiffness::new(&alike, 0.5)
    };
    assert!(
        response(3.0.into()).unwrap_err().to_string().starts_with("thresholds: expected lives that differ")
    );
    // Free times that differ put them out of phase.
    assert!(response(FreeTime::Distributed(Arc::new(Exponential::new(3.0).unwrap()))).is_ok());
}

/// The same with ageing and the friction of free contacts.
#[test]
fn ageing_with_a_delay_has_the_dynamic_stiffness_of_the_renewal_equation() {
    for (force, expected) in [(0.0, 1.3849), (0.4, 0.5252), (0.6, 0.0777)] {
        let free_friction = FreeFriction { force, ..FreeFriction::default() };
        let delayed = |contacts: Contacts| {
            let rules = Rules { delay: 300.0.into(), free_friction, ..contacts.rules };
            Contacts { rules, ..contacts }
        };
        let contacts = delayed(ageing());
        let response = DynamicStiffness::new(&contacts, VELOCITY).unwrap();
        let found = response.critical_stiffness(Slider::default(), &mut ()).unwrap().unwrap();
        // Digits of the reference, which is off by as much as its trapezoids.
        near(found.0, expected, 2e-4);
        let integrated = DynamicStiffness::new(&delayed(by_ages()), VELOCITY).unwrap();
        near(integrated.critical_stiffness(Slider::default(), &mut ()).unwrap().unwrap().0, expected, 2e-4);
    }
}

fn follow(slip: Slip, stiffness: f64, drive: &[Piece], points: u32, tolerance: f64) -> Slide {
    let mut sliding = Transport::steady_with(&ageing(), VELOCITY, 1e-5, &mut ()).unwrap();
    sliding.step(0.0, 1e-9 / VELOCITY, &mut ()).unwrap();
    let drive = History::new(drive.to_vec()).unwrap();
    let times: Vec<f64> = (0..=points).map(|i| f64::from(i) / f64::from(points) * drive.duration()).collect();
    let block = Block::new(Loading::Spring(stiffness), slip, None).unwrap();
    block.follow_with(&sliding, &drive, &times, tolerance, &mut ()).unwrap()
}

/// How fast the swings of the velocity grow per length from the position `from` on, by least squares.
fn growth_of_swings(run: &Slide, from: f64) -> f64 {
    let swing = |three: &[asperity::block::Moment]| {
        let [before, here, after] = [0, 1, 2].map(|i: usize| three[i].velocity / VELOCITY - 1.0);
        let (tilt, bend) = (0.5 * (after - before), after - 2.0 * here + before);
        let top = here - 0.5 * tilt * tilt / bend;
        (before < here && here >= after).then(|| (three[1].time * VELOCITY, top.ln()))
    };
    let swings: Vec<(f64, f64)> = run.trace.windows(3).filter_map(swing).filter(|s| s.0 > from).collect();
    assert!(swings.len() > 5, "{swings:?}");
    let mean =
        |value: &dyn Fn(&(f64, f64)) -> f64| swings.iter().map(value).sum::<f64>() / swings.len() as f64;
    let (x, y) = (mean(&|s| s.0), mean(&|s| s.1));
    mean(&|s| (s.0 - x) * (s.1 - y)) / mean(&|s| (s.0 - x) * (s.0 - x))
}

#[test]
fn without_damping_no_spring_is_stiff_enough() {
    let response = response();
    let jump = response.critical_stiffness(Slider::default(), &mut ()).unwrap().unwrap();
    let stiffness = 14.0 * jump.0;
    // 12 swings per length or so: fast enough to be begun gently by a jump of the drive by 1/12 and a rest of a quarter swing.
    let swings = 12.0;
    let mass = stiffness / (swings * VELOCITY).powi(2);
    let slider = Slider { mass, damping: 0.0 };
    assert_eq!(response.critical_stiffness(slider, &mut ()).unwrap(), Some((f64::INFINITY, f64::INFINITY)));
    let root = response.growth(slider, stiffness, &mut ()).unwrap().unwrap() / VELOCITY;
    // By the dynamic stiffness itself, Newton's method from the root found.
    let equation = |q: Complex64| mass * VELOCITY * VELOCITY * q * q + stiffness + by_quadrature(q);
    let exact = (0..8).fold(root, |q, _| {
        let slope = (equation(q + 1e-5) - equation(q - 1e-5)) / 2e-5;
        q - equation(q) / slope
    });
    let quick = 1e-3 / (swings * VELOCITY);
    let rest = std::f64::consts::FRAC_PI_2 / (swings * VELOCITY) - quick;
    let drive = [
        Piece { velocity: 1.0 / (swings * quick), duration: quick },
        Piece { velocity: 0.0, duration: rest },
        Piece { velocity: VELOCITY, duration: 6.0 / VELOCITY },
    ];
    let run = follow(Slip::Inertial { mass, damping: 0.0 }, stiffness, &drive, 3000, 1e-6);
    let growth = growth_of_swings(&run, 1.0);
    println!("root {root}, by quadrature {exact}, in time {growth}, {}", run.regime);
    // Newton's method and the reference, with the slope by differences. Steps in time and swings of some per cent of the mean
    // threshold are good to 3 %.
    near(root.re / exact.re, 1.0, 1e-7);
    near(root.im / exact.im, 1.0, 1e-7);
    near(growth / exact.re, 1.0, 0.05);
    assert!(matches!(run.regime, Regime::Undecided { .. }), "{}", run.regime);
}

#[test]
fn above_the_critical_stiffness_large_deviations_may_go_on() {
    // A damped slider without mass: 2 % above K_c small deviations die out, and larger ones come to slip after slip: the
    // bifurcation is subcritical here.
    let (response, damping) = (response(), 2.0);
    let stiffness =
        1.02 * response.critical_stiffness(Slider { mass: 0.0, damping }, &mut ()).unwrap().unwrap().0;
    let pulled = |kick: f64| {
        let lag = damping * VELOCITY / stiffness + kick;
        let quick = 1e-6 / VELOCITY;
        let drive = [
            Piece { velocity: lag / quick, duration: quick },
            Piece { velocity: VELOCITY, duration: 40.0 / VELOCITY },
        ];
        follow(Slip::Damped { damping }, stiffness, &drive, 400, 1e-4).regime
    };
    let (small, large) = (pulled(1e-3), pulled(0.1));
    assert!(matches!(small, Regime::Smooth { .. }), "{small}");
    assert!(matches!(large, Regime::Persistent { .. }), "{large}");
}

/// Contacts with a temperature T, an attempt rate of 1 and a barrier.
fn thermal(thresholds: &SharedLaw, reforming: &SharedLaw, barrier: Barrier, energy: f64) -> Contacts {
    let temperature = Temperature { energy, attempt_rate: 1.0, barrier, hazard: Hazard::Joint };
    let rules = Rules { temperature: Some(temperature), ..Rules::default() };
    Contacts { rules, ..contacts(thresholds, reforming) }
}

/// Where the barrier is low beside T, contacts break at the rate ω whatever their stretch: F̂ = ks/(s + ω), a Maxwell element.
#[test]
fn contacts_that_break_at_a_constant_rate_are_a_maxwell_element() {
    let contacts = thermal(&gaussian(1.0, 0.1), &point(0.0), Barrier::Bell, 1e7);
    let response = DynamicStiffness::new(&contacts, 1e-3).unwrap();
    for s in [[0.0, 0.01], [0.0, 1.0], [0.0, 100.0], [0.3, 2.0]].map(|s| Complex64::new(s[0], s[1])) {
        // E_0/T is 5e-8, and the correlation is resolved to 1e-9.
        assert!((response.at(s) - s / (s + 1.0)).norm() < 1e-6, "{s} {}", response.at(s));
    }
    near(response.integral(), 1.0, 1e-6);
}

/// F̂ ≈ s dF_k/dv at low frequencies, with F_k of the renewal equation, by differences of fourth order.
#[test]
fn the_response_in_closed_form_integrates_to_the_slope_of_kinetic_friction() {
    let [narrow, broad]: [SharedLaw; 2] = [gaussian(1.0, 0.1), Arc::new(Exponential::new(1.0).unwrap())];
    let medium: SharedLaw = Arc::new(Gamma::new(1.0, 0.5).unwrap());
    let components = vec![(0.6, point(0.0)), (0.4, point(0.3))];
    let two: SharedLaw = Arc::new(Mixture::new(components).unwrap());
    let mut cases = Vec::new();
    let (slow, fast): (&[f64], &[f64]) = (&[1e-4], &[0.3]);
    let both: &[f64] = &[1e-4, 0.3];
    // Barriers differ by a function of threshold and stretch: one of them at both velocities.
    for (barrier, velocities) in
        [(Barrier::Elastic, both), (Barrier::Bell, slow), (Barrier::Catastrophe, fast)]
    {
        for law in [&narrow, &medium, &broad, &point(1.0)] {
            cases.push((thermal(law, &point(0.0), barrier, 0.02), velocities));
        }
        cases.push((thermal(&narrow, &two, barrier, 0.1), velocities));
        let stiffness = Stiffness::PerThreshold(2.0);
        let per_threshold = Contacts { stiffness, ..thermal(&medium, &point(0.0), barrier, 0.1) };
        cases.push((per_threshold, velocities));
    }
    // Contacts that re-form over a range, in part above weak thresholds. Where these are slow, sums are long: two cases of them.
    let stiffness = Stiffness::PerThreshold(2.0);
    let weak = Contacts { stiffness, ..thermal(&medium, &rectangular(0.0, 0.3), Barrier::Bell, 0.1) };
    cases.push((weak, fast));
    cases.push((thermal(&rectangular(0.5, 1.5), &rectangular(0.1, 0.3), Barrier::Catastrophe, 0.1), both));
    let partly: SharedLaw =
        Arc::new(Mixture::new(vec![(0.4, rectangular(0.1, 0.5)), (0.6, point(0.3))]).unwrap());
    cases.push((thermal(&point(1.0), &partly, Barrier::Elastic, 0.02), both));
    cases.push((thermal(&narrow, &partly, Barrier::Elastic, 0.02), fast));
    cases.push((thermal(&broad, &gaussian(0.1, 0.1), Barrier::Elastic, 0.1), fast));
    for (contacts, velocities) in cases {
        for &velocity in velocities {
            let slope = slope_of_friction(&contacts, velocity) / velocity;
            let response = DynamicStiffness::new(&contacts, velocity).unwrap();
            // F_k to 1e-11 over 1e-3 of v, and 1e-9 of the correlation over its own length, some T/k.
            let expected = 1e-7 / velocity;
            near(response.integral(), slope, expected);
        }
    }
}

/// Friction falls with velocity where heat shortens the lives of weak contacts most. The motion in time of these contacts, known to
/// some 1e-3 of the stiffness per frequency, had a slope of the other sign.
#[test]
fn friction_of_broad_thresholds_that_re_form_stretched_falls_with_velocity() {
    let [thresholds, reforming]: [SharedLaw; 2] =
        [Arc::new(Gamma::new(1.0, 0.5).unwrap()), Arc::new(Exponential::new(0.1).unwrap())];
    let contacts = thermal(&thresholds, &reforming, Barrier::Elastic, 0.02);
    let velocity = 0.01;
    let slope = slope_of_friction(&contacts, velocity);
    // Digits of the number; F_k to 1e-11 over 1e-3 of v.
    near(slope, -7.587e-4, 1e-7);
    let response = DynamicStiffness::new(&contacts, velocity).unwrap();
    // The correlation is resolved to 1e-9, each panel of starts to 1e-11.
    near(velocity * response.integral(), slope, 1e-8);
}

/// The closed form against the trapezoidal rule of contacts that age by next to nothing, and, where contacts re-form over a range of
/// stretches, against their motion in time.
#[test]
fn the_response_in_closed_form_is_that_of_quadrature_and_of_the_motion_in_time() {
    let velocity = 0.1;
    let friction = FreeFriction { force: 0.3, ..FreeFriction::default() };
    let distributed = FreeTime::Distributed(Arc::new(Exponential::new(2.0).unwrap()));
    for delay in [FreeTime::default(), 2.0.into(), distributed] {
        let of = |reforming: &SharedLaw, ageing: Option<Ageing>| {
            let mut contacts = thermal(&gaussian(1.0, 0.2), reforming, Barrier::Elastic, 0.1);
            (contacts.rules.delay, contacts.rules.ageing) = (delay.clone(), ageing);
            if !contacts.rules.delay.is_none() {
                contacts.rules.free_friction = friction;
            }
            contacts
        };
        let respond = |contacts: &Contacts| DynamicStiffness::new(contacts, velocity).unwrap();
        let closed = respond(&of(&point(0.0), None));
        let little = Some(Ageing::Logarithmic { growth: 1e-12, time: 1.0 });
        let quadrature = DynamicStiffness::new(&of(&point(0.0), little.clone()), velocity).unwrap();
        // The motion in time takes seconds: without a delay, and with one that is distributed.
        let in_time = !matches!(delay, FreeTime::Fixed(time) if time > 0.0);
        let in_time =
            in_time.then(|| [None, little].map(|ageing| respond(&of(&rectangular(0.0, 0.3), ageing))));
        for frequency in [0.003, 0.03, 0.1, 0.3, 1.0] {
            let s = Complex64::new(0.0, frequency);
            // Trapezoids over a two-thousandth of the life, in which the phase changes by up to 0.005.
            let apart = (closed.at(s) - quadrature.at(s)).norm();
            assert!(apart < 5e-5, "{s}: {} {}", closed.at(s), quadrature.at(s));
            // Forces of steps are known to some 1e-3 of the stiffness of the contacts.
            if let Some([spread, followed]) = &in_time {
                let [spread, followed] = [spread.at(s), followed.at(s)];
                assert!((spread - followed).norm() < 5e-3, "{s}: {spread} {followed}");
            }
        }
        let thermal = DynamicStiffness::new(&of(&point(0.0), None), velocity).unwrap();
        near(thermal.instantaneous(), quadrature.instantaneous(), 5e-5);
    }
}

/// R with a density against a Gauss rule of sixteen points for it, each followed alone: ν is smooth over it.
#[test]
fn the_response_of_contacts_that_re_form_over_a_range_is_that_of_its_gauss_points() {
    let nodes = RULE.nodes.iter().zip(&RULE.weights).map(|(t, weight)| (0.5 * weight, *t));
    let components = nodes.map(|(weight, t)| (weight, point(0.15 * (1.0 + t)))).collect();
    let points: SharedLaw = Arc::new(Mixture::new(components).unwrap());
    for (barrier, energy, velocity) in
        [(Barrier::Elastic, 0.02, 0.01), (Barrier::Bell, 0.1, 1e-3), (Barrier::Catastrophe, 0.1, 1e-3)]
    {
        let [whole, few] = [&rectangular(0.0, 0.3), &points].map(|reforming| {
            let contacts = thermal(&gaussian(1.0, 0.15), reforming, barrier, energy);
            DynamicStiffness::new(&contacts, velocity).unwrap()
        });
        for frequency in [0.03, 0.3, 1.0, 3.0, 10.0, 30.0] {
            let s = Complex64::new(0.0, frequency * velocity);
            // Both correlations are resolved to 1e-9, and the rule misses 1e-9 of contacts that break early.
            assert!((whole.at(s) - few.at(s)).norm() < 1e-8, "{s}: {} {}", whole.at(s), few.at(s));
        }
    }
}
