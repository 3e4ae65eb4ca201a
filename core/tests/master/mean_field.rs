//! The steady closure: closed moments between Gaussians, and the equation itself for other laws.

use std::sync::Arc;

use crate::common::gaussian;
use asperity::contacts::{Ageing, Closure, Contacts, ThresholdFokkerPlanck};
use asperity::law::{Gamma, Lognormal, Mixture, Point, Rectangular, SharedLaw};
use asperity::life::moving;

/// ⟨h²⟩/(2⟨h⟩) of the law between Gaussians, whose moments are closed; masses below 0 are kept.
fn closed(fresh: (f64, f64), mature: (f64, f64), velocity_over_rate: f64) -> f64 {
    let ((fresh, fresh_std), (mature, mature_std)) = (fresh, mature);
    let gap = mature - velocity_over_rate;
    let mean = 0.5 * (gap + (gap * gap + 4.0 * fresh * velocity_over_rate).sqrt());
    let ratio = mean / velocity_over_rate;
    let first = (fresh - mature) / (1.0 + ratio);
    let second = (fresh_std.powi(2) + (fresh - mature).powi(2) + 2.0 * ratio * mature_std.powi(2))
        / (1.0 + 2.0 * ratio);
    (second + 2.0 * mature * first + mature * mature) / (2.0 * mean)
}

/// Contacts that re-form at 0.
fn unstretched() -> SharedLaw {
    Arc::new(Point::new(0.0).unwrap())
}

fn kinetic_friction(fresh: SharedLaw, mature: SharedLaw, diffusion: f64, velocity: f64) -> f64 {
    let mut contacts = Contacts::new(fresh, Arc::new(Point::new(0.0).unwrap()));
    contacts.rules.ageing = Some(Ageing::MeanField { mature, diffusion });
    let life = moving(&contacts, &contacts.reforming, true, velocity, false, &mut ()).unwrap();
    life.force().curve().integral() / life.survival().curve().integral()
}

#[test]
fn between_gaussians_friction_is_that_of_the_closed_moments() {
    // Printed to ten digits; the solver cuts off what the fresh law has below 0.
    let known = [(10.0, 0.2718511722), (1.0, 0.3700809896), (0.1, 0.4831162958), (0.01, 0.4994032648)];
    for (velocity, expected) in known {
        assert!((closed((0.5, 0.1), (1.0, 0.05), velocity) - expected).abs() < 1e-10);
        let found = kinetic_friction(gaussian(0.5, 0.1), gaussian(1.0, 0.05), 0.0025, velocity);
        assert!((found - expected).abs() < 2.9e-7, "{velocity} {found}");
        // Nothing is cut off: what is left is the solver's.
        let far = closed((0.9, 0.1), (1.0, 0.08), velocity);
        let found = kinetic_friction(gaussian(0.9, 0.1), gaussian(1.0, 0.08), 0.0064, velocity);
        assert!((found - far).abs() < 1e-12, "{velocity} {found} {far}");
    }
}

#[test]
fn moments_of_broad_thresholds_fulfil_the_equations_of_the_moments() {
    // dC/dt = −D⟨U'⟩ + Dp(0) and d⟨h²⟩/dt = −2D⟨hU'⟩ + 2D with U' = (h − 1.5)/σ², for ages of mean C/v.
    let (mean, variance, diffusion) = (1.5, 0.2_f64.powi(2), 0.01);
    for variation in [0.3, 0.5, 1.0, 3.0] {
        let fresh: SharedLaw = Arc::new(Lognormal::new(1.0, variation).unwrap());
        let maturing = ThresholdFokkerPlanck::new(fresh.clone(), gaussian(mean, 0.2), diffusion);
        for velocity in [0.01, 0.1, 1.0] {
            let law =
                Closure { maturing: &maturing, reforming: &unstretched(), velocity }.law(&mut ()).unwrap();
            let (first, second) = (law.mean(), law.upper_moment(2, -1.0));
            let (age, rate) = (first / velocity, diffusion / variance);
            let first_expected = 1.0 + age * (diffusion * law.density(0.0) - rate * (first - mean));
            let second_expected =
                1.0 + variation.powi(2) + 2.0 * age * (diffusion - rate * (second - mean * first));
            // What elements leave out, times the age in units of the relaxation time, 25 at most.
            assert!(
                (first / first_expected - 1.0).abs() < 3e-11,
                "{variation} {velocity} {first} {first_expected}"
            );
            assert!(
                (second / second_expected - 1.0).abs() < 3e-11 * (1.0 + 2.0 * age * rate),
                "{variation} {velocity} {second} {second_expected}"
            );
        }
    }
}

#[test]
fn other_laws_fulfil_the_equation_integrated_over_thresholds() {
    let laws: [(SharedLaw, SharedLaw); 3] = [
        (gaussian(0.5, 0.1), Arc::new(Gamma::new(1.0, 0.2).unwrap())),
        (gaussian(1.0, 0.1), Arc::new(Rectangular::new(0.4, 1.6).unwrap())),
        (Arc::new(Rectangular::new(0.4, 0.6).unwrap()), gaussian(1.0, 0.1)),
    ];
    for (fresh, mature) in laws {
        let diffusion = 0.5 * mature.std().powi(2);
        for velocity in [0.03, 1.0] {
            let maturing = ThresholdFokkerPlanck::new(fresh.clone(), mature.clone(), diffusion);
            let law =
                Closure { maturing: &maturing, reforming: &unstretched(), velocity }.law(&mut ()).unwrap();
            assert!((law.survival(-1.0) - 1.0).abs() < 1e-14);
            let spread = law.mean() / velocity * diffusion;
            for k in 1..30 {
                let h = 0.405 + 0.04 * f64::from(k);
                // Within some cells of a jump of the fresh law the slope is less well known.
                let near = fresh.breakpoints().iter().any(|b| (b.position - h).abs() < 0.02);
                if mature.density(h) < 1e-8 || mature.density(h + 2e-3) == 0.0 || near {
                    continue;
                }
                // S − S_i = −aJ at h, J = −D(U'p + p') = −D P_cf (p/P_cf)', by differences of fourth order.
                let ratio = |h: f64| law.density(h) / mature.density(h);
                let step = 1e-3;
                let slope = (8.0 * (ratio(h + step) - ratio(h - step)) - ratio(h + 2.0 * step)
                    + ratio(h - 2.0 * step))
                    / (12.0 * step);
                let flux = -spread * mature.density(h) * slope;
                let residual = law.survival(h) - fresh.survival(h) - flux;
                // The density is reported to 1e-9 of itself; differences and aD make 2000 times that of it at most.
                assert!(residual.abs() < 2e-6, "{} {velocity} {h} {residual:e}", fresh.name());
            }
        }
    }
}

#[test]
fn a_point_mass_without_weight_beyond_all_others_changes_nothing() {
    let mature = gaussian(1.5, 0.2);
    let alone = kinetic_friction(Arc::new(Point::new(1.0).unwrap()), mature.clone(), 0.01, 0.1);
    let point = |place: f64| Arc::new(Point::new(place).unwrap()) as SharedLaw;
    let both: SharedLaw = Arc::new(Mixture::new(vec![(1.0, point(1.0)), (1e-20, point(50.0))]).unwrap());
    // Rounding of some sums.
    assert!((kinetic_friction(both, mature, 0.01, 0.1) / alone - 1.0).abs() < 1e-11);
}

/// P_c between Gaussians as a sum over ages τ of Gaussians, each the solution of the Fokker–Planck equation in closed form.
struct SumOverAges {
    weights: Vec<(f64, SharedLaw)>,
}

impl SumOverAges {
    /// Ages of mean `age`, in units of the time in which the mean matures. Simpson's rule in √τ.
    fn new((fresh, fresh_std): (f64, f64), (mature, mature_std): (f64, f64), age: f64) -> Self {
        let (count, longest) = (1600_u32, 6.2_f64);
        let of = |k: u32| {
            let root = longest * f64::from(k) / f64::from(count);
            let simpson = if k == 0 || k == count { 1.0 } else { 2.0 * f64::from(1 + k % 2) };
            let weight = simpson * longest / f64::from(count) / 3.0 * 2.0 * root * (-root * root).exp();
            let left = (-root * root * age).exp();
            let variance = mature_std.powi(2) + (fresh_std.powi(2) - mature_std.powi(2)) * left * left;
            (weight, gaussian(mature + (fresh - mature) * left, variance.sqrt()))
        };
        Self { weights: (0..=count).map(of).collect() }
    }

    fn survival(&self, x: f64) -> f64 {
        self.weights.iter().map(|(weight, law)| weight * law.survival(x)).sum()
    }

    /// ∫R ∫_r^∞ S(x)/S(r) dx dr and the same with x as a factor, R even between two stretches.
    fn ways(&self, (low, high): (f64, f64)) -> [f64; 2] {
        let (parts, end) = (4 * (300.0 * (high - low)).round() as u32, 1.8_f64);
        let step = (high - low) / f64::from(parts);
        let steps = ((end - low) / step).ceil() as usize;
        let steps = steps + steps % 2;
        let at = |k: usize| low + step * k as f64;
        let survival: Vec<f64> = (0..=steps).map(|k| self.survival(at(k))).collect();
        // Integrals from the end by Simpson's rule on pairs of steps; the starts are the even places.
        let (mut above, mut sums) = ([0.0; 2], [0.0; 2]);
        for k in (0..steps).step_by(2).rev() {
            let pair = |n: i32| {
                let f = |k: usize| survival[k] * at(k).powi(n);
                step / 3.0 * (f(k) + 4.0 * f(k + 1) + f(k + 2))
            };
            above = [above[0] + pair(0), above[1] + pair(1)];
            if k <= parts as usize {
                let inner = k / 2;
                let last = parts as usize / 2;
                let simpson = if inner == 0 || inner == last { 1.0 } else { 2.0 * (1 + inner % 2) as f64 };
                let weight = simpson * 2.0 * step / 3.0 / (high - low);
                (0..2).for_each(|n| sums[n] += weight * above[n] / survival[k]);
            }
        }
        sums
    }
}

#[test]
fn contacts_that_reform_stretched_are_as_old_as_their_mean_advance_takes() {
    let (fresh, mature, rate) = ((0.6, 0.08), (1.0, 0.05), 1.0);
    // Below all thresholds, and among them.
    for ends in [(0.0, 0.1), (0.3, 0.7)] {
        for velocity in [0.1, 1.0] {
            let mut contacts = Contacts::new(
                gaussian(fresh.0, fresh.1),
                Arc::new(Rectangular::new(ends.0, ends.1).unwrap()),
            );
            let mature_law = gaussian(mature.0, mature.1);
            let diffusion = rate * mature.1 * mature.1;
            contacts.rules.ageing = Some(Ageing::MeanField { mature: mature_law, diffusion });
            let life = moving(&contacts, &contacts.reforming, true, velocity, false, &mut ()).unwrap();
            let way = life.survival().curve().integral();
            // The age is the way over the velocity, with the way from the sum over ages.
            let sum = SumOverAges::new(fresh, mature, rate * way / velocity);
            let [expected, force] = sum.ways(ends);
            // Both rules of Simpson are accurate to 1e-10 here.
            assert!((way - expected).abs() < 1e-9, "{ends:?} {velocity}: {way} {expected}");
            let friction = life.force().curve().integral() / way;
            assert!((friction - force / expected).abs() < 1e-9, "{ends:?} {velocity}: {friction}");
        }
    }
    // Closed moments where R is below all thresholds: C = ⟨h⟩ − ⟨r⟩.
    let (velocity, start) = (0.3, 0.1);
    let gap = mature.0 - velocity - start;
    let way: f64 = 0.5 * (gap + (gap * gap + 4.0 * (fresh.0 - start) * velocity).sqrt());
    let reforming: SharedLaw = Arc::new(Point::new(start).unwrap());
    let maturing = ThresholdFokkerPlanck::new(gaussian(0.6, 0.08), gaussian(1.0, 0.05), 0.0025);
    let law = Closure { maturing: &maturing, reforming: &reforming, velocity }.law(&mut ()).unwrap();
    assert!((law.mean() - start - way).abs() < 1e-12, "{} {way}", law.mean() - start);
}
