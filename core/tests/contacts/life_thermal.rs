//! Lives of contacts that temperature breaks, of every family of laws, at any temperature and velocity.

use crate::common::{
    contacts, exponential, gamma, gaussian, initial, lognormal, mixture, point, rectangular, weibull,
};
use asperity::contacts::{Ageing, Barrier, Contacts, Rules, Temperature};
use asperity::law::SharedLaw;
use asperity::life::moving;
use asperity::master::{Limits, MasterEquation};

fn thermal(thresholds: &SharedLaw, energy: f64, barrier: Barrier) -> Contacts {
    let temperature = Some(Temperature { barrier, ..Temperature::new(energy, 1.0) });
    Contacts { rules: Rules { temperature, ..Rules::default() }, ..contacts(thresholds, &point(0.0)) }
}

fn at(contacts: Contacts, velocity: f64) -> MasterEquation {
    let start = initial(&contacts.reforming);
    MasterEquation::at(contacts, &start, velocity).unwrap()
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    let error = found / expected - 1.0;
    assert!(error.abs() <= tolerance, "{found:e} instead of {expected:e}: {error:e}");
}

/// ∫P_c(h) m_n(h) dh, m_n = ∫₀ʰ xⁿ e^{−A} dx, n = 0 and 1, with A of Dawson's integral in closed form (elastic barrier): 24
/// Gauss points on panels that shrink in h towards 0 and in x towards both ends, in NumPy and SciPy.
#[test]
fn means_are_those_of_a_quadrature_over_thresholds() {
    let cases: [(SharedLaw, f64, f64, f64, f64); 8] = [
        (gaussian(1.0, 0.1), 0.05, 1e-4, 0.450_380_757_826_359_67, 0.298_066_811_163_366),
        (weibull(1.5, 1.0), 0.01, 0.1, 0.896_492_317_530_472_1, 0.662_159_018_510_408_8),
        (weibull(0.6, 1.0), 0.01, 0.1, 1.496_554_874_169_201, 3.093_006_643_127_979_2),
        (gamma(0.7, 0.56), 0.01, 0.1, 0.690_533_849_684_745_2, 0.578_847_181_371_864_1),
        (gamma(1.0, 2.0), 0.01, 0.1, 0.993_234_992_266_127_8, 2.515_937_280_245_263),
        (gamma(1.0, 3.0), 0.01, 0.1, 0.995_731_019_680_751_8, 5.020_786_999_980_446),
        // The few strongest carry most.
        (gaussian(1.0, 0.1), 0.05, 1e-20, 3.000_102_067_792_496e-15, 1.288_467_365_021_518e-11),
        (gaussian(1.0, 0.15), 0.1, 1e-12, 7.198_616_382_490_792e-10, 1.457_634_823_008_381e-7),
    ];
    for (law, energy, velocity, mean, friction) in cases {
        let steady = at(thermal(&law, energy, Barrier::Elastic), velocity).steady_state();
        // What that quadrature misses of densities that rise at 0.
        near(steady.mean_life(), mean, 1e-11);
        near(steady.kinetic_friction(), friction, 1e-11);
    }
}

#[test]
fn slow_flow_of_gaussian_thresholds_is_that_of_the_strongest() {
    for (std, energy) in [(0.1_f64, 0.05), (0.15, 0.1), (0.1, 0.1)] {
        // ⟨e^{n h²/2T}⟩ = exp[n/2T/(1 − nσ²/T)]/√(1 − nσ²/T), thresholds below 0 being none.
        let ln_mean = |n: f64| {
            let left = 1.0 - n * std * std / energy;
            n / (2.0 * energy) / left - 0.5 * left.ln()
        };
        let exact = (ln_mean(2.0) - ln_mean(1.0)).exp();
        let flowing = thermal(&gaussian(1.0, std), energy, Barrier::Elastic);
        let viscosity = Limits::of(&flowing, &mut ()).unwrap().viscosity.unwrap();
        // Rounding of exponents of about 40; thresholds below 0.
        near(viscosity, exact, 1e-10);
        // Contacts that hold longer than a way to their threshold are 7σ beyond the place that weighs most.
        near(at(flowing, 1e-30).steady_state().kinetic_friction() / 1e-30, exact, 1e-9);
    }
}

#[test]
fn there_is_no_slow_flow_where_the_tail_holds() {
    let cases: [(SharedLaw, f64); 4] = [
        // T < 2kσ².
        (gaussian(1.0, 0.1), 0.019),
        (exponential(1.0), 0.5),
        (gamma(1.0, 0.3), 0.05),
        (lognormal(1.0, 0.3), 10.0),
    ];
    for (law, energy) in cases {
        assert_eq!(Limits::of(&thermal(&law, energy, Barrier::Elastic), &mut ()).unwrap().viscosity, None);
    }
}

/// ∫dr R/S(r) ∫_r^∞ P_c [∫_r^h xⁿ e^{−A} dx] dh by the same quadrature, 12 points for r and for h.
#[test]
fn contacts_that_re_form_stretched_flow_and_hold() {
    let stretched = |velocity: f64| {
        let law = gamma(1.0, 0.3);
        let contacts =
            Contacts { reforming: rectangular(0.0, 0.35), ..thermal(&law, 0.05, Barrier::Elastic) };
        at(contacts, velocity).steady_state()
    };
    let steady = stretched(1e-8);
    // Thresholds above 4.5, one in 10¹¹, were left out there.
    near(steady.mean_life(), 0.089_847_085_005_16, 2e-9);
    near(steady.kinetic_friction(), 0.545_859_426_366_32, 3e-9);
    // Slower still it costs no more, and few hold.
    assert!(stretched(1e-11).mean_life() < steady.mean_life());
}

#[test]
fn heat_and_ageing_at_low_temperature_are_ageing() {
    let aged = |temperature: Option<Temperature>| {
        let ageing = Some(Ageing::Logarithmic { growth: 0.02, time: 1.0 });
        let rules = Rules { temperature, ageing, ..Rules::default() };
        at(Contacts { rules, ..contacts(&gaussian(1.0, 0.1), &point(0.0)) }, 1e-2).steady_state()
    };
    let cold = aged(None).kinetic_friction();
    for energy in [1e-4, 1e-5, 1e-7, 4e-9] {
        let temperature = Temperature { barrier: Barrier::Elastic, ..Temperature::new(energy, 1.0) };
        let friction = aged(Some(temperature)).kinetic_friction();
        // x_s − x_b ≈ T ln(1 + ωT/v)/x.
        assert!((friction - cold).abs() < 3.0 * energy * (100.0 * energy).ln_1p() + 1e-12, "{energy}");
    }
}

/// ∫ of a function between two positions by Simpson's rule.
fn simpson(steps: u32, low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let width = (high - low) / f64::from(steps);
    let weight = |k: u32| if k == 0 || k == steps { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
    (0..=steps).map(|k| weight(k) * f(low + width * f64::from(k))).sum::<f64>() * width / 3.0
}

/// The threshold at an age of contacts with a fresh threshold.
type ThresholdAt<'a> = &'a dyn Fn(f64, f64) -> f64;

/// ∫dr R ∫_y^∞ P_c e^{−A} dh by Simpson's rule, A too; y is the largest fresh threshold reached.
#[test]
fn ageing_contacts_that_re_form_stretched_survive_as_nested_integrals_say() {
    let (law, reforming, velocity) = (gaussian(1.0, 0.1), rectangular(0.0, 0.2), 0.2);
    let (growth, time) = (0.05, 1.0);
    let ranked = |h: f64, t: f64| {
        let left = (-t / time).exp();
        let std = (0.0225 + (0.01 - 0.0225) * left * left).sqrt();
        1.3 - 0.3 * left + std * (h - 1.0) / 0.1
    };
    let strengthened = |h: f64, t: f64| h * (1.0 + growth * (t / time).ln_1p());
    let ages: [(Ageing, ThresholdAt<'_>); 2] = [
        (Ageing::Logarithmic { growth, time }, &strengthened),
        (Ageing::FrozenRank { mature: gaussian(1.3, 0.15), time }, &ranked),
    ];
    for (ageing, threshold) in ages {
        for barrier in [Barrier::Elastic, Barrier::Bell] {
            let temperature = Temperature { barrier, ..Temperature::new(0.1, 1.0) };
            let rules =
                Rules { temperature: Some(temperature), ageing: Some(ageing.clone()), ..Rules::default() };
            let aged = Contacts { rules, reforming: reforming.clone(), ..contacts(&law, &point(0.0)) };
            let life = moving(&aged, &aged.reforming, true, velocity, false, &mut ()).unwrap();
            for advance in [0.5, 0.9] {
                let left = |r: f64, h: f64| {
                    let rate = |u: f64| temperature.rate(r + u, threshold(h, u / velocity), 1.0) / velocity;
                    (-simpson(200, 0.0, advance, rate)).exp()
                };
                let survival = simpson(60, 0.0, 0.2, |r| {
                    // Thresholds rise with h, and the stretch reaches them from below.
                    let (mut low, mut high) = (0.0, 2.0);
                    while high - low > 1e-15 {
                        let middle = 0.5 * (low + high);
                        let met = threshold(middle, advance / velocity) < r + advance;
                        *(if met { &mut low } else { &mut high }) = middle;
                    }
                    5.0 * simpson(600, low.max(0.3), 1.8, |h| law.density(h) * left(r, h))
                });
                let found = life.survival().curve().value(advance);
                // What Simpson's rules leave out.
                assert!((found - survival).abs() < 1e-8, "{ageing:?} {barrier:?} {}", found - survival);
            }
        }
    }
}

/// What breaks is all, and the mean life that of single thresholds, each a life of its own, by Simpson's rule.
#[test]
fn edges_that_temperature_hardly_blurs_are_not_missed() {
    let few = mixture(&[(0.02, point(1.5)), (0.98, gaussian(1.0, 0.1))]);
    let laws = [rectangular(0.0, 2.0), rectangular(0.5, 1.5), few];
    for barrier in [Barrier::Catastrophe, Barrier::Bell, Barrier::Elastic] {
        for energy in [1e-2, 1e-4, 1e-6, 1e-7, 1e-9] {
            for (law, velocity) in laws.iter().flat_map(|law| [1e-1, 1e-3].map(|v| (law, v))) {
                let hot = thermal(law, energy, barrier);
                let life = moving(&hot, &hot.reforming, true, velocity, false, &mut ()).unwrap();
                let atoms: f64 = life.breaking().atoms().map(|atom| atom.weight).sum();
                // Some ten cells, each to 1e-14.
                near(life.breaking().curve().integral() + atoms, 1.0, 1e-13);
            }
        }
    }
    let (barrier, energy, velocity) = (Barrier::Catastrophe, 1e-6, 1e-3);
    let mean = |law: &SharedLaw| at(thermal(law, energy, barrier), velocity).steady_state().mean_life();
    let steps = 200;
    let one = |k: u32| {
        let weight = if k == 0 || k == steps { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
        weight * mean(&point(0.5 + f64::from(k) / f64::from(steps)))
    };
    let expected = (0..=steps).map(one).sum::<f64>() / f64::from(3 * steps);
    // What the lives of single thresholds leave out; lives are smooth in thresholds.
    near(mean(&laws[1]), expected, 1e-11);
}
