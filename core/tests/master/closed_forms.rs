//! Closed forms against reference values found by independent routes (40-digit sums, Volterra solutions).
//!
//! Values are met to the digits they are printed with, hence the tolerances: half a unit of the last
//! digit, plus rounding.

use std::f64::consts::{E, LN_2, PI};
use std::sync::Arc;

use asperity::exact::{
    ClosedForm, Erlang, Gamma, Gaussian, Identical, Quenched, Rectangular, kinetic_friction,
    kinetic_friction_per_threshold, steady_variance, steady_variance_per_threshold,
};
use asperity::numerics::roots::brent_root;
use asperity::{Error, law};

#[track_caller]
fn close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} within {tolerance:e}");
}

/// Checks (X_s, F_s) and K_c of a form.
#[track_caller]
fn extrema(form: &dyn ClosedForm, position: f64, force: f64, stiffness: f64, tolerance: f64) {
    let (at, top) = form.static_friction().unwrap();
    close(at, position, tolerance);
    close(top, force, tolerance);
    close(form.critical_stiffness(), stiffness, 10.0 * tolerance);
}

fn figure_2() -> Gaussian {
    Gaussian::new(1.0, 0.05).starting_from(0.1, 0.025)
}

#[test]
fn gaussian_of_figure_2() {
    extrema(&figure_2(), 0.7917570228211, 0.8680791136123, 6.143622290680, 1e-13);
    close(figure_2().kinetic_friction(), 0.50125, 1e-15);
    // Three of these (k = 3, 8, 9) were recomputed with 40 digits: the theory's table is off by 1e-10 or 2e-10.
    let forces = [
        0.1,
        0.190393709474,
        0.280106990592,
        0.370022662032,
        0.460003418780,
        0.549854005753,
        0.636460197528,
        0.701134770463,
        0.704983812900,
        0.628338414127,
        0.505947075572,
    ];
    for (k, force) in forces.into_iter().enumerate() {
        close(figure_2().force(1.09 * k as f64), force, 6e-13);
    }
    close(figure_2().force(5.0), 0.297314325, 6e-10);
    close(figure_2().force(20.0), 0.432331699, 6e-10);
}

#[test]
fn gaussian_from_relaxed_contacts() {
    extrema(&Gaussian::new(1.0, 0.05), 0.9006972398250, 0.8799592699929, 6.988800539548, 1e-13);
    let form = Gaussian::new(1.0, 0.1);
    extrema(&form, 0.8441642907576, 0.7964360150770, 3.009222675584, 1e-13);
    let forces = [
        (0.9, 0.76554181852046),
        (1.0, 0.53989422803977),
        (2.18, 0.29409432179625),
        (5.45, 0.46337760258074),
        (21.8, 0.50940308970344),
    ];
    for (position, force) in forces {
        close(form.force(position), force, 2e-14);
    }
    close(Gaussian::new(1.0, 0.05).force(6.25), 0.271627, 6e-7);
}

/// The instability F' = −K, the force there and where an overdamped slip ends (F = K(X_T − X)).
#[test]
fn gaussian_instability_and_slip() {
    let cases = [
        (0.05, 1.0, 0.9193897819656, 0.8713694334127, 1.790759215378, 1.395379607689),
        (0.1, 1.0, 0.8925878043021, 0.7736105511280, 1.666198355430, 1.332802416243),
        (0.2, 0.5, 0.8855675280253, 0.6696859786180, 2.224939485261, 1.389965210192),
    ];
    for (std, stiffness, start, force, period, end) in cases {
        let form = Gaussian::new(1.0, std);
        let (top, _) = form.static_friction().unwrap();
        let at = brent_root(|x| form.slope(x) + stiffness, top, 1.0, 0.0).unwrap();
        close(at, start, 1e-13);
        close(form.force(at), force, 1e-13);
        let drive = at + form.force(at) / stiffness;
        close(drive, period, 1e-12);
        let excess = |x: f64| form.force(x) - stiffness * (drive - x);
        close(brent_root(excess, at + 0.2, drive, 0.0).unwrap(), end, 1e-12);
    }
}

/// Thresholds that begin at 0 break no contact before the slider moves.
#[test]
fn rectangular_thresholds_from_zero_carry_nothing_at_the_start() {
    let form = Rectangular { min: 0.0, max: 2.0 };
    assert_eq!(form.force(0.0), 0.0);
    // F = X − X²/4 + … for the first breaks.
    close(form.force(1e-6), 1e-6, 1e-12);
}

#[test]
fn static_over_kinetic_friction_tends_to_two_for_narrow_laws() {
    for (std, ratio) in [(0.001, 1.992540), (0.05, 1.755530), (0.1, 1.577101)] {
        let form = Gaussian::new(1.0, std);
        // Half a unit of the six digits printed.
        close(form.static_friction().unwrap().1 / form.kinetic_friction(), ratio, 6e-7);
    }
}

/// The sum over roots and the sum over breaks share nothing; at X = 3 the roots' converges in 40 terms.
#[test]
fn gaussian_relaxation() {
    close(Gaussian::new(1.0, 0.05).relaxation_length(), 20.2704854183, 6e-11);
    close(Gaussian::new(1.0, 0.1).relaxation_length(), 5.0909759368, 6e-11);
    let form = Gaussian::new(1.0, 0.1);
    for position in [3.0, 3.3, 7.7, 20.0] {
        let swing = |j| {
            let root = form.relaxation_root(j);
            2.0 * ((root * position).exp() / root).re
        };
        let force = form.kinetic_friction() - (1..=40).map(swing).sum::<f64>();
        close(form.force(position), force, 1e-14);
    }
}

/// F' = 1 − X Σ p_n/n with p_n = G(n x̄, √n σ).
#[test]
fn gaussian_slope_is_the_convolution_formula() {
    let form = Gaussian::new(1.0, 0.1);
    for position in [0.3, 0.9, 1.0, 2.2, 6.0] {
        let term = |n: i32| {
            let n = f64::from(n);
            let z = (position - n) / (0.1 * n.sqrt());
            (-0.5 * z * z).exp() / ((2.0 * PI * n).sqrt() * 0.1 * n)
        };
        let sum: f64 = (1..40).map(term).sum();
        close(form.slope(position), 1.0 - position * sum, 1e-13);
    }
}

/// The noise is that of the start until contacts break, and in the end that of steady sliding; where the
/// first generation has half broken, x is 0 or 1 with equal weights.
#[test]
fn gaussian_variance() {
    let form = figure_2();
    close(form.variance(0.0), 0.025 * 0.025, 1e-15);
    close(form.variance(0.4), 0.025 * 0.025, 1e-15);
    let steady = (1.0 + 3.0 * 0.0025) / 3.0 - 0.50125 * 0.50125;
    close(form.variance(400.0), steady, 1e-9);
    close(Gaussian::new(1.0, 1e-6).variance(1.0), 0.25, 1e-6);
}

/// A law with thresholds in [a, b] from relaxed contacts, piece by piece.
#[test]
fn rectangular_pieces() {
    let form = Rectangular { min: 0.75, max: 1.25 };
    let (a, b, x_s, w) = (0.75, 1.25, 1.0, 0.5_f64);
    for x in [0.0, 0.3, a] {
        close(form.force(x), x, 0.0);
    }
    for x in [0.76, 1.0, 1.24] {
        close(form.force(x), x + (a * a - x * x) / (2.0 * w), 1e-15);
    }
    for x in [b, 1.4, 1.5] {
        close(form.force(x), x - x_s, 1e-15);
    }
    for x in [1.6, 1.9, 2.0] {
        close(form.force(x), x - x_s - (x - 2.0 * a).powi(2) * (x + a) / (6.0 * w * w), 1e-15);
    }
    for x in [2.0, 2.1, 2.24] {
        close(form.force(x), x - 2.0 * x_s + (2.0 * b - x).powi(2) * (x + b) / (6.0 * w * w), 1e-15);
    }
    close(form.force(0.95), 0.61, 1e-15);
    close(form.force(1.05), 0.51, 1e-15);
    close(form.force(2.5), 0.483072916667, 6e-13);
}

#[test]
fn rectangular_extrema() {
    for half in [0.05, 0.25, 1.0 / 3.0] {
        let form = Rectangular { min: 1.0 - half, max: 1.0 + half };
        // A cusp at the lowest threshold; F' falls until the highest.
        extrema(&form, 1.0 - half, 1.0 - half, (1.0 - half) / (2.0 * half), 1e-14);
        close(form.kinetic_friction(), 0.5 * (1.0 + half * half / 3.0), 1e-15);
    }
    let form = Rectangular { min: 0.0, max: 2.0 };
    extrema(&form, 2.0 * LN_2, 2.0 * (2.0 * LN_2 - 1.0), E - 2.0, 4e-14);
    for x in [0.1, 1.0, 1.9] {
        close(form.force(x), 2.0 * x - 2.0 * (x / 2.0_f64).exp_m1(), 1e-15);
    }
}

/// Far out, where alternating sums of the Irwin–Hall densities have lost all digits, the force is steady,
/// up to e^{−X/X*} with the X* of the theory's table.
#[test]
fn rectangular_settles() {
    for (half, length) in [(0.3, 1.583433), (0.5, 0.823987), (1.0, 0.957468)] {
        let form = Rectangular { min: 1.0 - half, max: 1.0 + half };
        let far = 70.0 * f64::min(length, 1.0);
        close(form.force(far), form.kinetic_friction(), 1e-13);
        close(form.slope(far), 0.0, 1e-13);
        // Largest distance from F_k in two windows ten lengths apart.
        let swing = |from: f64| {
            let at = |i: i32| form.force(from + f64::from(i) * 0.01) - form.kinetic_friction();
            (0..130).map(|i| at(i).abs()).fold(0.0, f64::max)
        };
        let measured = 10.0 * length / (swing(8.0 * length) / swing(18.0 * length)).ln();
        // Windows are not whole periods of the swing: up to 4 % of a length in ten.
        close(measured, length, 0.04 * length);
    }
}

#[test]
fn erlang() {
    let form = Erlang::with_mean(4, 1.0);
    close(form.force(0.5), 0.44710932792500, 2e-14);
    close(form.force(2.0), 0.62456937580373, 2e-14);
    close(form.force(40.0), form.kinetic_friction(), 1e-14);
    let (at, force) = Erlang::with_mean(16, 1.0).static_friction().unwrap();
    close(at, 0.77850125899485, 2e-14);
    close(force, 0.65057411698449, 2e-14);
    // A gamma law of coefficient of variation 0.1.
    close(Erlang::with_mean(100, 1.0).relaxation_length(), 5.0677261778, 6e-11);
}

/// The sums are not computed beyond the reach, and not for what is no number.
#[test]
fn forms_are_not_known_beyond_their_reach() {
    let forms: [&dyn ClosedForm; 3] = [
        &Gamma { mean: 1.0, std: 0.5 },
        &Gaussian { mean: 1.0, std: 0.1, initial_mean: 0.0, initial_std: 0.0 },
        &Rectangular { min: 0.5, max: 1.5 },
    ];
    for form in forms {
        for position in [form.reach().next_up(), f64::INFINITY, f64::NAN] {
            assert!(form.force(position).is_nan() && form.slope(position).is_nan(), "{position}");
        }
    }
}

/// Sums of incomplete gamma functions against sums of exponentials, with which they share nothing.
#[test]
fn gamma_of_whole_shapes_is_erlang() {
    for shape in [1_u32, 2, 7, 40] {
        let (erlang, gamma) =
            (Erlang::with_mean(shape, 1.5), Gamma { mean: 1.5, std: 1.5 / f64::from(shape).sqrt() });
        for k in 0..60 {
            let position = 0.37 * f64::from(k);
            // Rounding of sums up to 22, by terms that are right to 1e-14.
            close(gamma.force(position), erlang.force(position), 1e-12);
            close(gamma.slope(position), erlang.slope(position), 1e-12);
        }
        close(gamma.kinetic_friction(), erlang.kinetic_friction(), 1e-15);
        let [top, expected] = [&gamma as &dyn ClosedForm, &erlang].map(ClosedForm::static_friction);
        assert_eq!(top.is_some(), expected.is_some());
        for (top, expected) in top.into_iter().zip(expected) {
            // A place where the slope is 0 to rounding.
            close(top.0, expected.0, 1e-11);
            close(top.1, expected.1, 1e-12);
        }
        close(gamma.critical_stiffness(), erlang.critical_stiffness(), 1e-11);
    }
}

#[test]
fn exponential_is_the_first_erlang() {
    let form = Erlang::with_mean(1, 2.5);
    for x in [0.0_f64, 0.7, 3.0] {
        close(form.force(x), 2.5 * (1.0 - (-x / 2.5).exp()), 1e-15);
    }
    assert_eq!(form.static_friction(), None);
    assert_eq!(form.critical_stiffness(), 0.0);
    close(form.relaxation_length(), 2.5, 1e-15);
    close(form.kinetic_friction(), 2.5, 0.0);
}

#[test]
fn identical_contacts_never_settle() {
    let form = Identical { threshold: 2.0 };
    for (position, force) in [(0.0, 0.0), (1.5, 1.5), (2.0, 0.0), (1000.5, 0.5)] {
        close(form.force(position), force, 0.0);
    }
    close(form.stretch(1.5, 2.0), 1.5, 0.0);
    assert_eq!(form.static_friction(), Some((2.0, 2.0)));
    assert_eq!(form.critical_stiffness(), f64::INFINITY);
}

#[test]
fn quenched_thresholds_lose_step() {
    let form = Quenched { thresholds: Arc::new(law::Gaussian::new(1.0, 0.05).unwrap()) };
    assert!(form.force(1e12).is_nan());
    close(form.force(6.25), 0.452365, 6e-7);
    close(form.force(0.5), 0.5, 1e-14);
    close(form.kinetic_friction(), 0.5, 1e-15);
    // exp[−(X/X_d)²] at three lengths is 1.2e-4 of a swing of 1/π; the rest is of order σ².
    close(form.force(3.0 * form.dephasing_length()), 0.5, 5e-4);
}

/// |F − F_k| X reaches 0.701 again and again for thresholds uniform on [.9, 1.1].
#[test]
fn quenched_rectangular_settles_algebraically() {
    let form = Quenched { thresholds: Arc::new(law::Rectangular::new(0.9, 1.1).unwrap()) };
    for from in [200.0, 1000.0] {
        let swing = |i: i32| {
            let x = from + 0.01 * f64::from(i);
            x * (form.force(x) - 0.5).abs()
        };
        let largest = (0..2000).map(swing).fold(0.0, f64::max);
        close(largest, 0.701, 0.01);
    }
}

/// Where P_c(0) > 0 ever smaller thresholds count: exponential, ∫e^{−ξ}(X mod ξ)dξ = X − Σ_n [1 − (1 + X/n)e^{−X/n}]
/// summed to n = 4·10⁶, the rest being X²/(2·4·10⁶) to 1e-13.
#[test]
fn quenched_with_thresholds_down_to_zero() {
    let form = Quenched { thresholds: Arc::new(law::Exponential::new(1.0).unwrap()) };
    let (x, terms) = (2.0_f64, 4_000_000);
    let term = |n: u32| {
        let y = x / f64::from(n);
        -(-y).exp_m1() - y * (-y).exp()
    };
    let sum: f64 = (1..=terms).rev().map(term).sum();
    let rest = x * x / (2.0 * (f64::from(terms) + 0.5));
    close(form.force(x), x - sum - rest, 1e-11);
}

#[test]
fn steady_sliding_from_moments() {
    let rectangular = |min, max| law::Rectangular::new(min, max).unwrap();
    let relaxed = law::Point::new(0.0).unwrap();
    close(kinetic_friction(&rectangular(0.8, 1.2), &rectangular(0.0, 0.2)), 5.0 / 9.0, 1e-15);
    // Gaussian thresholds: ⟨x²⟩ = 1 + c², ⟨x³⟩ = 1 + 3c², so that areas raise F_k by (1 + 3c²)/(1 + c²).
    let narrow = law::Gaussian::new(1.0, 0.1).unwrap();
    let equal = kinetic_friction(&narrow, &relaxed);
    close(kinetic_friction_per_threshold(&narrow) / equal, 1.03 / 1.01, 1e-14);
    close(steady_variance(&narrow), 1.03 / 3.0 - 0.505 * 0.505, 1e-14);
    // Identical contacts: x uniform on [0, 1], variance 1/12 either way.
    let identical = law::Point::new(1.0).unwrap();
    close(steady_variance(&identical), 1.0 / 12.0, 1e-16);
    close(steady_variance_per_threshold(&identical), 1.0 / 12.0, 1e-16);
    // Exponential: ⟨ξ⁵⟩/(3⟨ξ⟩) − (⟨ξ³⟩/2⟨ξ⟩)² = 40 − 9.
    close(steady_variance_per_threshold(&law::Exponential::new(1.0).unwrap()), 31.0, 1e-13);
}

#[test]
fn forms_of_no_law_are_refused() {
    let refused = |form: &dyn ClosedForm| match form.check() {
        Err(Error::Invalid { key, .. }) => key,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&Gaussian::new(0.0, 0.1)), "mean");
    assert_eq!(refused(&Gaussian::new(1.0, f64::NAN)), "std");
    assert_eq!(refused(&Gaussian::new(1.0, 0.1).starting_from(-0.1, 0.1)), "initial_mean");
    assert_eq!(refused(&Rectangular { min: 1.0, max: 1.0 }), "max");
    assert_eq!(refused(&Erlang { shape: 0, rate: 1.0 }), "shape");
    assert_eq!(refused(&Gamma { mean: 1.0, std: 0.0 }), "std");
    assert_eq!(refused(&Gamma { mean: f64::NAN, std: 1.0 }), "mean");
    assert_eq!(refused(&Identical { threshold: f64::INFINITY }), "threshold");
    let forms: [&dyn ClosedForm; 5] = [
        &Gamma { mean: 1.0, std: 0.3 },
        &Gaussian::new(1.0, 0.1),
        &Rectangular { min: 0.0, max: 1.0 },
        &Erlang { shape: 1, rate: 1.0 },
        &Identical { threshold: 1.0 },
    ];
    for form in forms {
        form.check().unwrap();
        // Within reach the force is that of steady sliding, or still swings about it.
        let far = form.force(form.reach().min(1e5));
        assert!((0.0..=2.0 * form.kinetic_friction()).contains(&far), "{far}");
    }
}
