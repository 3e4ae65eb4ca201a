//! Lives of contacts whose thresholds diffuse: reference values, limits, and the other way to solve for them.

use std::sync::Arc;

use crate::common::finite_volumes::{Diffusion, DiffusionStep, NO_FLOOR, Work};
use crate::common::gaussian;
use asperity::contacts::{Ageing, Barrier, Contacts, Stiffness, Temperature, ThresholdFokkerPlanck};
use asperity::law::{Exponential, Gamma, Point, Rectangular, SharedLaw};
use asperity::life::{Life, athermal, moving};

/// Contacts re-formed at 0.
fn contacts(fresh: SharedLaw, mature: SharedLaw, diffusion: f64) -> Contacts {
    let mut contacts = Contacts::new(fresh, Arc::new(Point::new(0.0).unwrap()));
    contacts.rules.ageing = Some(Ageing::Smoluchowski { mature, diffusion });
    contacts
}

/// G(0.5, 0.1) to G(1, 0.05) with κ = D/σ_f² = 1.
fn reference() -> Contacts {
    contacts(gaussian(0.5, 0.1), gaussian(1.0, 0.05), 0.0025)
}

fn life(contacts: &Contacts, velocity: f64) -> Life {
    moving(contacts, &contacts.reforming, true, velocity, false, &mut ()).unwrap()
}

/// ∫xS/∫S.
fn kinetic_friction(life: &Life) -> f64 {
    life.force().curve().integral() / life.survival().curve().integral()
}

/// The survival at the edges of even cells that rest, while the stretch passes one cell at each step.
fn survival_at_rest(contacts: &Contacts, velocity: f64, cells: usize) -> Vec<(f64, f64)> {
    let Some(Ageing::Smoluchowski { mature, diffusion }) = &contacts.rules.ageing else { panic!() };
    let maturing = ThresholdFokkerPlanck::new(contacts.thresholds.clone(), mature.clone(), *diffusion);
    let operator = Arc::new(Diffusion::of(&maturing, cells));
    let mut masses = maturing.fresh(&operator.middles(), 0.0, &mut ()).unwrap();
    let mut work = Work::default();
    let before = DiffusionStep::new(&operator, operator.edge(0) / velocity / cells as f64);
    for _ in 0..if operator.edge(0) > 0.0 { cells } else { 0 } {
        before.advance(&mut masses, NO_FLOOR, &mut work);
    }
    let step = DiffusionStep::new(&operator, operator.width() / velocity);
    let mut one = |cell: usize| {
        let floor = (operator.edge(cell), operator.edge(cell + 1));
        step.advance(&mut masses, floor, &mut work);
        (floor.1, masses.iter().sum())
    };
    (0..cells).map(&mut one).collect()
}

#[test]
fn friction_weakens_at_high_speed_and_falls_again_at_low_speed() {
    let contacts = reference();
    // To 1e-5, and to 1e-4 at the highest, as they are known.
    for (velocity, expected, known) in
        [(10.0, 0.2720, 1e-4), (1.0, 0.38468, 1e-5), (0.1, 0.49031, 1e-5), (0.01, 0.46235, 1e-5)]
    {
        let found = kinetic_friction(&life(&contacts, velocity));
        assert!((found - expected).abs() < known, "{velocity}: {found}");
    }
}

#[test]
fn cells_that_follow_and_cells_at_rest_agree() {
    // By how much twice as many cells at rest are better: of second order, unless they begin at a wall where thresholds are.
    let laws: [(SharedLaw, SharedLaw, f64); 4] = [
        (gaussian(0.5, 0.1), gaussian(1.0, 0.05), 3.5),
        (gaussian(0.5, 0.1), Arc::new(Gamma::new(1.0, 0.2).unwrap()), 3.5),
        (Arc::new(Rectangular::new(0.4, 0.6).unwrap()), gaussian(1.0, 0.1), 3.5),
        (gaussian(1.0, 0.05), Arc::new(Rectangular::new(0.6, 1.4).unwrap()), 2.0),
    ];
    for (fresh, mature, gain) in laws {
        let diffusion = mature.std().powi(2);
        let contacts = contacts(fresh, mature, diffusion);
        for velocity in [0.03, 0.5] {
            let life = life(&contacts, velocity);
            let survival = life.survival().curve();
            let worst = |cells: usize| {
                let at = |(x, s): (f64, f64)| if x > 0.7 { (survival.value(x) - s).abs() } else { 0.0 };
                survival_at_rest(&contacts, velocity, cells).into_iter().map(at).fold(0.0, f64::max)
            };
            let [coarse, fine] = [500, 1000].map(worst);
            // Finite volumes of 1000 cells are of first order beside the absorbing edge: they limit the agreement, not the life.
            assert!(coarse / fine > gain && fine < 3e-4, "{velocity} {coarse:e} {fine:e}");
        }
    }
}

/// The normal distribution function.
fn phi(z: f64) -> f64 {
    0.5 * libm::erfc(-z / std::f64::consts::SQRT_2)
}

#[test]
fn free_thresholds_are_met_as_bachelier_and_levy_have_it() {
    // Flat on [0, 3], so far up that none comes to the upper end.
    let contacts = contacts(gaussian(0.6, 0.06), Arc::new(Rectangular::new(0.0, 3.0).unwrap()), 0.04);
    for velocity in [0.4, 3.0] {
        let life = life(&contacts, velocity);
        for k in 1..=10 {
            let x = 0.12 * f64::from(k);
            let spread = (2.0 * 0.04 * x / velocity).sqrt();
            let left = |h: f64| phi((h - x) / spread) - (velocity * h / 0.04).exp() * phi(-(h + x) / spread);
            // The trapezoidal rule over twenty standard deviations is exact to rounding.
            let weight = |z: f64| (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
            let points = (-99..=400).map(|i| 0.1 * f64::from(i)).filter(|z| z.abs() < 9.9);
            let exact: f64 = points.map(|z| 0.1 * weight(z) * left(0.6 + 0.06 * z)).sum();
            let found = life.survival().curve().value(x);
            // The error reported; the reflecting ends are too far away to matter.
            assert!((found - exact).abs() < life.error().max(1e-12), "{velocity} {x} {found} {exact}");
        }
        assert!(life.error() < 1e-9, "{:e}", life.error());
    }
}

/// Φ(−z) e^{z²/2}, by its continued fraction where z is not small (P. S. Laplace).
fn scaled_tail(z: f64) -> f64 {
    if z < 3.0 {
        return phi(-z) * (0.5 * z * z).exp();
    }
    let below = (1..80).rev().fold(z, |sum, k| z + f64::from(k) / sum);
    1.0 / (below * (2.0 * std::f64::consts::PI).sqrt())
}

/// A density of thresholds with a pole at 0, free to diffuse: half of all contacts break before the stretch is a tenth of the mean.
#[test]
fn the_error_beside_a_pole_is_what_forces_feel_of_it() {
    let (mean, diffusion) = (0.3, 0.01);
    let fresh = Arc::new(Gamma::new(mean, mean * std::f64::consts::SQRT_2).unwrap());
    // Flat, and so far up that hardly any come to the upper end.
    let contacts = contacts(fresh, Arc::new(Rectangular::new(0.0, 12.0).unwrap()), diffusion);
    let velocity = 0.3;
    let life = life(&contacts, velocity);
    let mut worst = 0.0_f64;
    for x in [1e-6, 1e-4, 1e-2, 0.1, 0.2, 0.3, 0.5, 0.8, 1.5, 3.0] {
        let spread = (2.0 * diffusion * x / velocity).sqrt();
        // e^{vh/D} Φ(−(h + x)/spread), the exponents of which add up to that of the Gaussian at h − x.
        let reflected = |h: f64| scaled_tail((h + x) / spread) * (-0.5 * ((h - x) / spread).powi(2)).exp();
        let left = |h: f64| phi((h - x) / spread) - reflected(h);
        // With h = s² the density of shape ½ and scale 0.6 has no pole.
        let weight = |s: f64| 2.0 * (-s * s / 0.6).exp() / (std::f64::consts::PI * 0.6).sqrt();
        let (middle, width) = (x.sqrt(), 12.0 * spread);
        // Gauss points on pieces that are as narrow as the steepest change.
        let ends = [0.0, (x - width).max(0.0).sqrt(), middle, (x + width).sqrt(), 12.0_f64.sqrt()];
        let mut exact = 0.0;
        for pair in ends.windows(2) {
            let piece = (pair[1] - pair[0]) / 400.0;
            let point = |k: u32, t: f64| pair[0] + piece * (f64::from(k) + 0.5 + 0.5 * t);
            // The three-point rule: its error on 400 pieces is far below rounding of survival.
            for k in 0..400 {
                for (t, w) in [(-0.6_f64.sqrt(), 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.6_f64.sqrt(), 5.0 / 18.0)]
                {
                    let s = point(k, t);
                    exact += piece * w * weight(s) * left(s * s);
                }
            }
        }
        let apart = (life.survival().curve().value(x) - exact).abs();
        worst = worst.max((x / mean).min(1.0) * apart);
    }
    // What is reported is an upper limit, no more than a hundred times what is found, and 1e-12 of rounding.
    let reported = life.error();
    assert!(worst <= reported, "{velocity}: {worst:e}, reported {reported:e}");
    assert!(reported < 100.0 * worst + 1e-12, "{velocity}: {worst:e}, reported {reported:e}");
}

#[test]
fn thresholds_that_have_no_time_to_diffuse_are_the_fresh_ones() {
    for fresh in [gaussian(0.5, 0.1), Arc::new(Gamma::new(1.0, 0.3).unwrap()) as SharedLaw] {
        let fast = contacts(fresh.clone(), gaussian(1.0, 0.05), 0.0025);
        let slow = contacts(fresh, gaussian(1.0, 0.05), 1e-12);
        let still = athermal(&fast, &fast.reforming, true, &mut ()).unwrap();
        for (contacts, diffusion, velocity) in [(&fast, 0.0025, 1e7), (&slow, 1e-12, 1.0)] {
            let life = life(contacts, velocity);
            for k in 0..150 {
                let x = 0.01 * f64::from(k);
                let apart = life.survival().curve().value(x) - still.survival().curve().value(x);
                // Thresholds come down by DU'x/v, with U' up to 400 here, of a density up to 4.
                let allowed = 1e-11 + 1e3 * diffusion / velocity;
                assert!(apart.abs() < allowed, "{velocity} {x} {apart:e}");
            }
        }
    }
}

/// Where the layer D/v above the stretch is thin its mass is given by two terms, where it is not elements resolve it.
#[test]
fn thin_layers_go_on_from_layers_that_are_resolved() {
    let fresh: [SharedLaw; 2] = [gaussian(0.5, 0.1), Arc::new(Gamma::new(0.6, 0.2).unwrap())];
    for fresh in fresh {
        let mature = gaussian(1.0, 0.05);
        let limit = 2e-5 * ThresholdFokkerPlanck::new(fresh.clone(), mature.clone(), 1.0).resolution();
        let [thin, first, second, third] = [0.95, 1.05, 1.15, 1.25]
            .map(|part| life(&contacts(fresh.clone(), mature.clone(), part * limit), 1.0));
        for x in (1..90).map(|k| 0.01 * f64::from(k)) {
            let left = |life: &Life| life.survival().curve().value(x);
            let expected = 3.0 * (left(&first) - left(&second)) + left(&third);
            // Seven times what resolved ones are off by, 3e-11, and the third difference of S, 1e-3 of its change by diffusion.
            assert!((left(&thin) - expected).abs() < 5e-10, "{x}: {:e}", left(&thin) - expected);
        }
    }
}

#[test]
fn slow_contacts_are_caught_in_the_lower_tail_of_the_mature_law() {
    let contacts = reference();
    let lives = [1e-4, 1e-5].map(|velocity| (velocity, life(&contacts, velocity)));
    // Far below the mean the rate at which thresholds come down to x is DU'P_cf(1 − O(1/z²)), z = (1 − x)/σ_f, so that
    // −ln S = (D/v) P_cf (1 − O(1/z²)).
    for z in [4.0_f64, 4.5, 5.0] {
        let density = (-0.5 * z * z).exp() / (0.05 * (2.0 * std::f64::consts::PI).sqrt());
        for (velocity, life) in &lives {
            let exponent = -life.survival().curve().value(1.0 - 0.05 * z).ln() * velocity / 0.0025;
            let ratio = exponent / density;
            assert!(ratio < 1.0 && ratio > 1.0 - 1.5 / (z * z), "{z} {velocity} {ratio}");
        }
    }
    // Half of where (D/v) P_cf(x_b) = 1 rises with ln v like ½/U'(x_b), x_b = 1 − zσ_f; z changes by 0.5 in between.
    let fall = (kinetic_friction(&lives[0].1) - kinetic_friction(&lives[1].1)) / 10_f64.ln();
    let slope = |z: f64| 0.5 * 0.05 / z;
    assert!(fall < slope(3.0) && fall > slope(4.5), "{fall}");
}

#[test]
fn temperature_breaks_contacts_that_cannot_diffuse_as_it_does_those_that_do_not_age() {
    let temperature = Temperature { barrier: Barrier::Bell, ..Temperature::new(0.05, 7.0) };
    for stiffness in [Stiffness::Equal(1.3), Stiffness::PerThreshold(1.5)] {
        let mut ageing = contacts(gaussian(1.0, 0.1), gaussian(1.2, 0.1), 1e-12);
        ageing.stiffness = stiffness;
        ageing.rules.temperature = Some(temperature);
        let mut still = ageing.clone();
        still.rules.ageing = None;
        let [ageing, still] = [&ageing, &still].map(|contacts| life(contacts, 0.3));
        let curves = |life: &Life| {
            [life.survival(), life.force(), life.square(), life.breaking_energy()].map(|k| k.curve().clone())
        };
        let reported = ageing.error();
        // Elements miss 3e-12 of the density at each of some tens of steps.
        assert!(reported < 1e-10, "{reported:e}");
        // Thresholds come down by DU'x/v meanwhile, with U' of 40 where the density is 1.
        let moved = 40.0 * 1e-12 * 1.4 / 0.3;
        for (a, b) in curves(&ageing).iter().zip(&curves(&still)) {
            for k in 0..140 {
                let (a, b) = (a.value(0.01 * f64::from(k)), b.value(0.01 * f64::from(k)));
                // Carried force and energy have thresholds of up to 1.7 and stiffnesses of up to 2.6 as factors.
                let allowed = 10.0 * (reported + moved);
                assert!((a - b).abs() < allowed, "{k} {a} {b}: {:e}, reported {reported:e}", a - b);
            }
        }
        assert!(still.survival().curve().value(0.9) < 0.7);
    }
}

/// Fresh thresholds with edges, which diffuse, at a temperature.
fn warm_edges(barrier: Barrier, diffusion: f64) -> Contacts {
    let fresh = Arc::new(Rectangular::new(0.4, 0.6).unwrap());
    let mut contacts = contacts(fresh, gaussian(1.0, 0.3), diffusion);
    contacts.rules.temperature = Some(Temperature { barrier, ..Temperature::new(0.02, 7.0) });
    contacts
}

/// Where the layer D/v above the stretch is thin its mass is given by two terms, and thresholds that the stretch has passed are
/// followed, too; where it is not elements resolve it, and none are left below the stretch.
#[test]
fn thin_layers_go_on_from_layers_that_are_resolved_at_a_temperature() {
    // Barriers differ in the rates at the nodes only, which thin and resolved layers share.
    let barrier = Barrier::Bell;
    let limit = 2e-5 * 0.2;
    let lives = [0.95, 1.05, 1.15, 1.25].map(|part| life(&warm_edges(barrier, part * limit), 1.0));
    let [thin, first, second, third] = &lives;
    let reported = lives.iter().map(Life::error).fold(0.0, f64::max);
    // Elements miss 3e-12 of the density at each of some hundred steps.
    assert!(reported < 2e-9, "{barrier:?} {reported:e}");
    for x in (1..70).map(|k| 0.01 * f64::from(k)) {
        let left = |life: &Life| life.survival().curve().value(x);
        let expected = 3.0 * (left(first) - left(second)) + left(third);
        let apart = (left(thin) - expected).abs();
        // Seven times what resolved ones are off by, and the third difference of what diffusion changes: 1e-3 of it at an
        // edge, where it is 2√D/v = 4e-3 at most, and falls within ten of these lengths.
        let curved = if (x - 0.4).abs().min((x - 0.6).abs()) < 0.045 { 4e-6 } else { 0.0 };
        assert!(apart < 7.0 * reported + curved, "{barrier:?} {x}: {apart:e}");
    }
}

#[test]
fn edges_that_hardly_diffuse_break_as_those_that_do_not_age_at_a_temperature() {
    // The half power of the last barrier takes ten times as long; one of the other two is in the tests beside this one.
    for (barrier, smaller) in [(Barrier::Elastic, &[1e-9, 1e-12][..]), (Barrier::Catastrophe, &[])] {
        let mut still = warm_edges(barrier, 1.0);
        still.rules.ageing = None;
        let still = life(&still, 1.0).mean();
        let changed = |diffusion: f64| {
            let life = life(&warm_edges(barrier, diffusion), 1.0);
            // Elements miss 3e-12 of the density at each of some hundred steps.
            assert!(life.error() < 1e-9, "{barrier:?} {diffusion}: {:e}", life.error());
            life.mean() - still
        };
        // What diffusion changes of the mean is of its first order: U' of 6 on average, and a layer of D/v.
        let first = changed(1e-7);
        assert!(first.abs() < 10.0 * 1e-7 && first.abs() > 1e-8, "{barrier:?}: {first:e}");
        for &diffusion in smaller {
            // The error reported, twice over, and the next order, which edges make the power 3/2.
            let (found, expected) = (changed(diffusion), diffusion / 1e-7 * first);
            assert!((found - expected).abs() < 2e-10, "{barrier:?}: {found:e} {expected:e}");
        }
    }
}

/// Finite volumes at rest, half of what temperature breaks in a step before what diffuses in it and half after it (G. Strang,
/// SIAM J. Numer. Anal. 5, 506 (1968)).
#[test]
fn warm_edges_break_as_those_of_cells_at_rest() {
    let (velocity, cells) = (1.0, 4000);
    let barrier = Barrier::Bell;
    let contacts = warm_edges(barrier, 5e-6);
    let life = life(&contacts, velocity);
    let temperature = contacts.rules.temperature.unwrap();
    let Some(Ageing::Smoluchowski { mature, diffusion }) = &contacts.rules.ageing else { panic!() };
    let maturing = ThresholdFokkerPlanck::new(contacts.thresholds.clone(), mature.clone(), *diffusion);
    let operator = Arc::new(Diffusion::of(&maturing, cells));
    let middles: Vec<f64> = operator.middles();
    let mut masses = maturing.fresh(&middles, 0.0, &mut ()).unwrap();
    let (time, mut work) = (operator.width() / velocity, Work::default());
    let step = DiffusionStep::new(&operator, time);
    let burn = |masses: &mut [f64], stretch: f64| {
        for (mass, h) in masses.iter_mut().zip(&middles) {
            *mass *= (-0.5 * time * temperature.rate(stretch, *h, 1.0)).exp();
        }
    };
    let mut worst = 0.0_f64;
    for cell in 0..cells {
        let floor = (operator.edge(cell), operator.edge(cell + 1));
        burn(&mut masses, floor.0 + 0.25 * operator.width());
        step.advance(&mut masses, floor, &mut work);
        burn(&mut masses, floor.0 + 0.75 * operator.width());
        let left: f64 = masses.iter().sum();
        worst = worst.max((left - life.survival().curve().value(floor.1)).abs());
    }
    // Cells of width 5e-4, of a density of 5, are of first order where edges and the stretch cross them.
    assert!(worst < 3e-3, "{barrier:?} {worst:e}");
}

#[test]
fn edges_and_points_are_followed_however_little_they_diffuse() {
    let fresh: [SharedLaw; 3] = [
        Arc::new(Rectangular::new(0.4, 0.6).unwrap()),
        Arc::new(Point::new(0.5).unwrap()),
        Arc::new(Exponential::new(0.5).unwrap()),
    ];
    for law in fresh {
        let means = [1e-3, 1e-5, 1e-9].map(|diffusion| {
            let contacts = contacts(law.clone(), gaussian(1.0, 0.3), diffusion);
            let life = life(&contacts, 1.0);
            // Well below 1e-4, the default tolerance where thresholds diffuse.
            assert!(life.error() < 1e-8, "{} {diffusion}: {:e}", law.name(), life.error());
            life.mean()
        });
        // What diffusion changes is at most of its first order: thresholds drift by D U' x/v, and spread by √(2Dx/v) evenly.
        let still = law.mean();
        let [slow, slower, none] = means.map(|mean| (mean - still).abs());
        assert!(slower < 0.03 * slow + 1e-9 && none < 2e-8, "{}: {slow:e} {slower:e} {none:e}", law.name());
    }
}

#[test]
fn fresh_thresholds_with_edges_have_the_friction_of_a_finite_difference_solution() {
    let contacts = contacts(Arc::new(Rectangular::new(0.4, 0.6).unwrap()), gaussian(1.0, 0.05), 0.0025);
    for (velocity, expected) in [(5.0, 0.2792073), (50.0, 0.2558285), (500.0, 0.2535818)] {
        let found = kinetic_friction(&life(&contacts, velocity));
        // All digits that are known.
        assert!((found - expected).abs() < 5.1e-8, "{velocity}: {found}");
    }
}

#[test]
fn what_breaks_is_what_is_no_longer_left() {
    let warm = Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.05, 1.0) };
    let mut hot = reference();
    hot.rules.temperature = Some(warm);
    let steep = contacts(Arc::new(Exponential::new(1.0).unwrap()), gaussian(1.0, 0.2), 0.04);
    for (contacts, velocity) in [(reference(), 0.5), (hot, 0.1), (steep, 0.3)] {
        let life = life(&contacts, velocity);
        let (survival, breaking) = (life.survival().curve(), life.breaking().curve());
        for cell in 0..breaking.coefficients.len() {
            let (middle, half) = breaking.cell(cell);
            let fallen = survival.value_in(cell, middle - half) - survival.value_in(cell, middle + half);
            let broken = 2.0 * half * breaking.coefficients[cell][0];
            // Some hundred roundings of survival, in the sweeps of each step.
            assert!((fallen - broken).abs() < 3e-14, "{velocity} {middle}: {fallen:e} {broken:e}");
        }
        let whole = breaking.integral();
        assert!((whole - 1.0).abs() < 1e-13, "{velocity}: {:e}", whole - 1.0);
    }
}

/// The least λ of −f'' + z f' = λ f above z_0, where f = 0: the rate at which thresholds that diffuse are met by a stretch at
/// rest, in units of D/σ². By f(z) = λ ∫_{z_0}^z e^{s²/2} ∫_s^∞ e^{−t²/2} f dt ds, again and again, trapezoids extrapolated.
fn slowest_rate(least: f64) -> f64 {
    let by_trapezoids = |steps: usize| {
        let step = (8.0 - least) / steps as f64;
        let weights: Vec<f64> =
            (0..=steps).map(|i| (-0.5 * (least + step * i as f64).powi(2)).exp()).collect();
        let whole = |f: &[f64]| f.iter().zip(&weights).map(|(value, weight)| value * weight).sum::<f64>();
        let (mut f, mut rate) = (vec![1.0; steps + 1], 0.0);
        for _ in 0..20 {
            let mut above = vec![0.0; steps + 1];
            for i in (0..steps).rev() {
                above[i] = above[i + 1] + 0.5 * step * (weights[i] * f[i] + weights[i + 1] * f[i + 1]);
            }
            let mut next = vec![0.0; steps + 1];
            for i in 1..=steps {
                let [a, b] = [i - 1, i].map(|k| above[k] / weights[k]);
                next[i] = next[i - 1] + 0.5 * step * (a + b);
            }
            rate = whole(&f) / whole(&next);
            f = next.iter().map(|value| value * rate).collect();
        }
        rate
    };
    (4.0 * by_trapezoids(800) - by_trapezoids(400)) / 3.0
}

/// So slow that the thresholds above the stretch are always those that decay slowest, those of a slider at rest.
#[test]
fn a_slow_slider_meets_thresholds_at_the_rate_of_one_at_rest() {
    let (std, velocity) = (0.05, 1e-6);
    let contacts = contacts(gaussian(0.5, 0.1), gaussian(1.0, std), std * std);
    const PARTS: usize = 300;
    // Below, the rate is less than 1e-16.
    let (from, to) = (0.55, 0.9);
    let step = (to - from) / PARTS as f64;
    let rate = |half_steps: usize| slowest_rate((from + 0.5 * step * half_steps as f64 - 1.0) / std);
    let rates: Vec<f64> = (0..=2 * PARTS).map(rate).collect();
    let mut met = 0.0;
    let mut sums = [from, 0.5 * from * from];
    for part in 0..=PARTS {
        if part > 0 {
            let [a, b, c] = [2, 1, 0].map(|back| rates[2 * part - back]);
            met += step / 6.0 * (a + 4.0 * b + c) / velocity;
        }
        let simpson = if part == 0 || part == PARTS { 1.0 } else { 2.0 + 2.0 * (part % 2) as f64 };
        let weight = step / 3.0 * simpson * (-met).exp();
        sums[0] += weight;
        sums[1] += weight * (from + step * part as f64);
    }
    let found = kinetic_friction(&life(&contacts, velocity));
    // Thresholds lag behind the stretch by a part of order v, 6e-6 of the friction at 1e-4; what has matured takes 1e-6 of a length.
    assert!((found - sums[1] / sums[0]).abs() < 5e-7, "{found} {}", sums[1] / sums[0]);
}

/// Starts spread over a bell are the mean of starts at its points, summed by the trapezoidal rule: of steps of 0.8 standard
/// deviations it misses e^{−2π²/0.64} = 4e-14 (E. T. Goodwin, Proc. Camb. Phil. Soc. 45, 241 (1949)).
fn starts_spread_over_a_bell_are_the_mean_of_its_points(
    contacts: &Contacts,
    (mean, std): (f64, f64),
    velocity: f64,
    tolerance: f64,
) {
    let step = 0.8_f64;
    let starting = |law: SharedLaw| moving(contacts, &law, true, velocity, false, &mut ()).unwrap();
    let spread = starting(gaussian(mean, std));
    let points: Vec<(f64, Life)> = (-9..=9)
        .map(|k| {
            let z = step * f64::from(k);
            let weight = step * (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
            (weight, starting(Arc::new(Point::new(mean + std * z).unwrap())))
        })
        .collect();
    let mut seen = 0.0_f64;
    for u in (1..40).map(|k| 0.03 * f64::from(k)) {
        let [left, force] = [Life::survival, Life::force].map(|of| {
            let sum: f64 = points.iter().map(|(weight, life)| weight * of(life).curve().value(u)).sum();
            let found = of(&spread).curve().value(u);
            assert!((found - sum).abs() < tolerance, "{u}: {found} {sum}");
            found
        });
        seen = seen.max(left * (1.0 - left)).max(force);
    }
    // Contacts broke on the way.
    assert!(seen > 0.2);
}

#[test]
fn few_starts_stand_for_narrow_ones_where_thresholds_diffuse() {
    // Each life misses some 3e-12 of the density of thresholds at each of some hundred steps.
    starts_spread_over_a_bell_are_the_mean_of_its_points(&reference(), (0.1, 0.005), 1.0, 1e-9);
}

#[test]
fn few_starts_stand_for_narrow_ones_where_contacts_age_at_a_temperature() {
    let mut contacts = Contacts::new(gaussian(1.0, 0.2), Arc::new(Point::new(0.0).unwrap()));
    contacts.rules.ageing = Some(Ageing::Logarithmic { growth: 0.05, time: 1.0 });
    contacts.rules.temperature =
        Some(Temperature { barrier: Barrier::Elastic, ..Temperature::new(0.05, 10.0) });
    // What cells of a life leave out of it, 1e-13, and what lies beyond seven standard deviations, 1e-12.
    starts_spread_over_a_bell_are_the_mean_of_its_points(&contacts, (0.1, 0.005), 0.1, 1e-11);
}

#[test]
fn wide_starts_are_the_mean_of_single_ones_where_temperature_breaks_the_weakest_first() {
    let gamma: SharedLaw = Arc::new(Gamma::new(0.7, 0.14).unwrap());
    for (thresholds, energy, velocity) in [(gamma, 0.02, 1e-4), (gaussian(1.0, 0.2), 0.05, 1e-2)] {
        let mut contacts = Contacts::new(thresholds, Arc::new(Point::new(0.0).unwrap()));
        contacts.rules.ageing = Some(Ageing::Logarithmic { growth: 0.1, time: 3.0 });
        contacts.rules.temperature = Some(Temperature::new(energy, 1.0));
        // As above.
        starts_spread_over_a_bell_are_the_mean_of_its_points(&contacts, (0.15, 0.02), velocity, 1e-11);
    }
}
