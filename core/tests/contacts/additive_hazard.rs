//! The additive hazard P(x) + r_T(x)/v: thermal breaking at the rate of the average contact.
//!
//! Comparisons of the ensemble are within 4 standard errors: a right program fails one of the 16 once in 1000 seeds.

use crate::common::{contacts, exponential, gamma, gaussian, initial, mixture, point, rectangular, weibull};
use asperity::contacts::{Ageing, Barrier, Contacts, Hazard, Initial, Rules, Start, Stiffness, Temperature};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::law::SharedLaw;
use asperity::life::moving;
use asperity::master::{DynamicStiffness, Limits, MasterEquation, Transport};
use asperity::random::{Purpose, Stream};

const BARRIERS: [Barrier; 3] = [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe];

fn with(thresholds: &SharedLaw, temperature: Temperature) -> Contacts {
    let rules = Rules { temperature: Some(temperature), ..Rules::default() };
    Contacts { rules, ..contacts(thresholds, &point(0.0)) }
}

fn additive(thresholds: &SharedLaw, energy: f64, barrier: Barrier) -> Contacts {
    with(thresholds, Temperature { barrier, hazard: Hazard::Additive, ..Temperature::new(energy, 1.0) })
}

fn at(contacts: &Contacts, velocity: f64) -> MasterEquation {
    MasterEquation::at(contacts.clone(), &initial(&contacts.reforming), velocity).unwrap()
}

fn friction(contacts: &Contacts, velocity: f64) -> f64 {
    at(contacts, velocity).steady_state().kinetic_friction()
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    let error = found / expected - 1.0;
    assert!(error.abs() <= tolerance, "{found:e} instead of {expected:e}: {error:e}");
}

/// e^{−ΔE/T} as in the table of barriers in docs/theory.md.
fn boltzmann(barrier: Barrier, energy: f64, stiffness: f64, x: f64, h: f64) -> f64 {
    let whole = 0.5 * stiffness * h * h;
    let barrier = match barrier {
        Barrier::Elastic => 0.5 * stiffness * (h * h - x * x),
        Barrier::Bell => 0.5 * stiffness * h * (h - x),
        _ => whole * (1.0 - x / h.max(f64::MIN_POSITIVE)).max(0.0).powf(1.5),
    };
    (-barrier / energy).exp()
}

/// Simpson's rule for values at an odd number of equidistant points.
fn simpson(step: f64, values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let last = values.len() - 1;
    let weight = |i: usize| if i == 0 || i == last { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
    step / 3.0 * values.enumerate().map(|(i, value)| weight(i) * value).sum::<f64>()
}

/// Contacts of a velocity, by Simpson's rule on a grid of stretches and of thresholds.
struct Quadrature {
    step: f64,
    /// S e^{−A} at every second stretch, and the same times the mean stiffness of the survivors.
    survival: Vec<f64>,
    stiffness: Vec<f64>,
}

impl Quadrature {
    /// Steps of 1/800 of the highest stretch, and of √(ξ − x) for thresholds.
    fn new(contacts: &Contacts, highest: f64, velocity: f64) -> Self {
        const COUNT: usize = 800;
        let law = contacts.thresholds.as_ref();
        let temperature = contacts.rules.temperature.unwrap();
        let own = |h: f64| match contacts.stiffness {
            Stiffness::PerThreshold(kappa) => kappa * h,
            _ => 1.0,
        };
        let step = highest / COUNT as f64;
        // ∫_x P_c f dξ with ξ = x + s²: the half power of a barrier is smooth in s.
        let above = |x: f64, f: &dyn Fn(f64) -> f64| {
            let fine = (highest - x).max(0.0).sqrt() / COUNT as f64;
            let values = (0..=COUNT).map(|i| {
                let s = i as f64 * fine;
                let h = x + s * s;
                2.0 * s * law.density(h) * f(h)
            });
            simpson(fine, values.collect::<Vec<_>>().into_iter())
        };
        let rate = |x: f64| {
            let thermal = |h: f64| boltzmann(temperature.barrier, temperature.energy, own(h), x, h);
            let all = above(x, &|_| 1.0);
            if all > 0.0 { temperature.attempt_rate * above(x, &thermal) / all } else { 0.0 }
        };
        let (mut broken, mut survival, mut stiffness) = (0.0, Vec::new(), Vec::new());
        let mut before = rate(0.0);
        for i in 0..=COUNT / 2 {
            let x = 2.0 * i as f64 * step;
            if i > 0 {
                let rates = [before, rate(x - step), rate(x)];
                broken += simpson(step, rates.into_iter()) / velocity;
                before = rates[2];
            }
            let left = f64::exp(-broken);
            survival.push(left * above(x, &|_| 1.0));
            stiffness.push(left * above(x, &own));
        }
        Self { step: 2.0 * step, survival, stiffness }
    }

    /// Kinetic friction of contacts that form at the stretches of a uniform distribution on [0, `top`].
    fn friction(&self, top: f64) -> f64 {
        // An even number of cells for each start.
        let starts = (top / self.step).round() as usize / 2 * 2;
        let of = |i: usize| {
            let count = (self.survival.len() - i - 1) / 2 * 2 + 1;
            let force = (i..i + count).map(|j| j as f64 * self.step * self.stiffness[j] / self.survival[i]);
            let life = (i..i + count).map(|j| self.survival[j] / self.survival[i]);
            [simpson(self.step, force), simpson(self.step, life)]
        };
        if starts == 0 {
            let [force, life] = of(0);
            return force / life;
        }
        let all: Vec<[f64; 2]> = (0..=starts).map(of).collect();
        let [force, life] = [0, 1].map(|i| simpson(self.step, all.iter().map(|one| one[i])));
        force / life
    }
}

#[test]
fn contacts_of_one_threshold_do_not_forget_it() {
    for barrier in BARRIERS {
        for velocity in [1e-8, 1e-4, 1e-2, 1.0] {
            let joint = with(&point(1.0), Temperature { barrier, ..Temperature::new(0.05, 1.0) });
            let both = [additive(&point(1.0), 0.05, barrier), joint].map(|c| friction(&c, velocity));
            near(both[0], both[1], 1e-12);
        }
    }
}

#[test]
fn friction_is_that_of_a_quadrature() {
    let per_threshold = |contacts: Contacts| Contacts { stiffness: Stiffness::PerThreshold(1.0), ..contacts };
    let laws = [(gaussian(1.0, 0.1), 1.8), (gamma(1.0, 0.3), 4.0), (gaussian(1.0, 0.2), 2.4)];
    for (i, (law, highest)) in laws.into_iter().enumerate() {
        for (j, barrier) in BARRIERS.into_iter().enumerate() {
            // Every law and every barrier meet both.
            let velocity = [1e-2, 1e-1][(i + j) % 2];
            let equal = additive(&law, 0.05, barrier);
            // Simpson's rule leaves some (step/width)⁴/180 of the narrowest peak: of the density, or of the breaks in slow sliding.
            near(friction(&equal, velocity), Quadrature::new(&equal, highest, velocity).friction(0.0), 1e-6);
        }
    }
    let law = gaussian(1.0, 0.2);
    let areas = per_threshold(additive(&law, 0.05, Barrier::Elastic));
    // As above.
    near(
        friction(&areas, 1e-2) / areas.stiffness.unit(),
        Quadrature::new(&areas, 2.4, 1e-2).friction(0.0),
        1e-6,
    );
    // Stretches of 0.24 are 80 steps of 2.4/800.
    let stretched = Contacts { reforming: rectangular(0.0, 0.24), ..additive(&law, 0.05, Barrier::Bell) };
    // As above; lives end after an odd number of steps or an even one.
    near(friction(&stretched, 1e-2), Quadrature::new(&stretched, 2.4, 1e-2).friction(0.24), 1e-6);
}

/// An equation closed on the distribution of stretches loses the contacts of high thresholds: by a factor of 34 here.
#[test]
fn slow_friction_is_far_below_that_of_contacts_that_keep_their_thresholds() {
    let law = gaussian(1.0, 0.1);
    let joint = with(&law, Temperature::new(0.05, 1.0));
    // Digits of the reference.
    near(friction(&additive(&law, 0.05, Barrier::Elastic), 1e-6), 0.0045517, 1e-5);
    near(friction(&joint, 1e-6), 0.155066, 4e-6);
}

#[test]
fn fast_sliding_is_athermal() {
    for law in [gaussian(1.0, 0.1), gamma(1.0, 0.3), rectangular(0.5, 1.5), exponential(1.0)] {
        let bare = contacts(&law, &point(0.0));
        let cold = MasterEquation::new(bare.clone(), &initial(&bare.reforming)).unwrap();
        let cold = cold.steady_state().kinetic_friction();
        let lost = |velocity: f64| 1.0 - friction(&additive(&law, 0.05, Barrier::Elastic), velocity) / cold;
        // At most ω/v of the contacts breaks thermally on a mean threshold.
        assert!(lost(1e9).abs() < 1e-9);
        // To first order in ω/v; the second is a thousandth of it.
        near(lost(1e3) / lost(1e4), 10.0, 1e-2);
    }
}

#[test]
fn slow_flow_is_viscous_for_every_distribution() {
    let (std, energy) = (0.1_f64, 0.015);
    // ⟨e^{−h²/2T}⟩ of Gaussian thresholds; 1e-23 of them are below 0.
    let widened = 1.0 + std * std / energy;
    let rate = (-0.5 / energy / widened).exp() / widened.sqrt();
    let mut flowing = additive(&gaussian(1.0, std), energy, Barrier::Elastic);
    let viscosity = |contacts: &Contacts| Limits::of(contacts, &mut ()).unwrap().viscosity.unwrap();
    // Rounding of exponents of 20.
    near(viscosity(&flowing), 1.0 / rate, 1e-12);
    // Stretches of 1e-8 at the break lower the barrier by 1e-14.
    near(friction(&flowing, 1e-8 * rate) / (1e-8 * rate), 1.0 / rate, 1e-12);
    flowing.rules.delay = (0.5 / rate).into();
    near(viscosity(&flowing), 1.0 / rate / 1.5, 1e-12);
    near(friction(&flowing, 1e-8 * rate) / (1e-8 * rate), 1.0 / rate / 1.5, 1e-12);
    for law in [exponential(1.0), gamma(1.0, 0.3), gamma(1.0, 1.3), weibull(0.6, 1.0)] {
        for barrier in BARRIERS {
            let broad = additive(&law, 0.05, barrier);
            // Stretches are 1e-8: the contacts with thresholds below are a fraction of 1e-8 to the power 0.6.
            near(friction(&broad, 1e-10) / 1e-10, viscosity(&broad), 1e-4);
        }
    }
    // ⟨e^{−h²/2T}⟩ of a gamma distribution with a pole, of shape a and scale θ, by Simpson's rule in t = h^{a/4}: on t the density is
    // 4t³ e^{−h/θ}/(aθ^a Γ(a)), and what it is divided by is its own integral.
    let (shape, scale, energy) = (1.0 / 1.69, 1.69, 0.05);
    let integral = |of: &dyn Fn(f64) -> f64| {
        let (count, width) = (20_000, 4.0_f64 / 20_000.0);
        let value = |i: i32| {
            let t = width * f64::from(i);
            let h = t.powf(4.0 / shape);
            t.powi(3) * (-h / scale).exp() * of(h)
        };
        (0..count / 2).map(|i| value(2 * i) + 4.0 * value(2 * i + 1) + value(2 * i + 2)).sum::<f64>()
    };
    let rate = integral(&|h| (-0.5 * h * h / energy).exp()) / integral(&|_| 1.0);
    // Errors of Simpson's rule for a function that has six derivatives at 0.
    near(viscosity(&additive(&gamma(1.0, 1.3), energy, Barrier::Elastic)), 1.0 / rate, 1e-10);
}

/// What breaks is all.
#[test]
fn edges_that_temperature_hardly_blurs_are_not_missed() {
    let few = mixture(&[(0.02, point(1.5)), (0.98, gaussian(1.0, 0.1))]);
    let two = mixture(&[(0.3, point(0.6)), (0.7, point(1.0))]);
    let motions = [(point(0.0), 1e-1), (point(0.0), 1e-3), (rectangular(0.0, 0.4), 1e-2)];
    for law in [rectangular(0.0, 2.0), rectangular(0.5, 1.5), few, two] {
        for (i, barrier) in BARRIERS.into_iter().enumerate() {
            for (j, energy) in [1e-1, 1e-2, 1e-3].into_iter().enumerate() {
                // Each with every barrier and with every temperature.
                let (starts, velocity) = motions[(i + j) % 3].clone();
                let hot = Contacts { reforming: starts, ..additive(&law, energy, barrier) };
                let life = moving(&hot, &hot.reforming, true, velocity, false, &mut ()).unwrap();
                let atoms: f64 = life.breaking().atoms().map(|atom| atom.weight).sum();
                // Half powers of the distance to a point mass of thresholds, which contacts of many starts pass, are resolved
                // to 4e-10; all others to some hundred cells of the averaged rate, each to 1e-13.
                near(life.breaking().curve().integral() + atoms, 1.0, 1e-9);
            }
        }
    }
}

fn ensemble(contacts: &Contacts, size: usize) -> Ensemble {
    Ensemble::new(contacts.clone(), initial(&contacts.reforming), size, 1, Disorder::Annealed).unwrap()
}

#[test]
fn the_ensemble_agrees() {
    for (law, barrier) in [(gaussian(1.0, 0.1), Barrier::Elastic), (gamma(1.0, 0.3), Barrier::Catastrophe)] {
        for velocity in [1e-3, 0.1] {
            let contacts = additive(&law, 0.05, barrier);
            let positions = [0.2, 0.5, 0.9, 2.0];
            let pulled = ensemble(&contacts, 20_000).pull_at(velocity, &positions).unwrap();
            let exact = at(&contacts, velocity).pull(2.0).unwrap();
            for (i, x) in positions.into_iter().enumerate() {
                let (force, error) = (pulled.force[i], pulled.error[i]);
                assert!((force - exact.force(x)).abs() < 4.0 * error, "{x}: {force} ± {error}");
            }
        }
    }
}

/// A contact that draws its threshold anew at every attempt has the rate of the average contact. Its mean force with its error after
/// a motion, by `size` of them.
fn redrawing(contacts: &Contacts, history: &[Piece], size: usize) -> (f64, f64) {
    let Temperature { energy, attempt_rate, barrier, .. } = contacts.rules.temperature.unwrap();
    let law = contacts.thresholds.as_ref();
    let mut random = Stream::new(7, Purpose::Breaking, 0);
    let mut forces = Vec::new();
    for _ in 0..size {
        let (mut x, mut threshold) = (0.0, law.upper_quantile(random.uniform()));
        for piece in history {
            let mut left = piece.duration;
            while left > 0.0 {
                let reached =
                    if piece.velocity > 0.0 { (threshold - x) / piece.velocity } else { f64::INFINITY };
                let attempt = -random.uniform().ln() / attempt_rate;
                let next = left.min(reached).min(attempt);
                x += piece.velocity * next;
                left -= next;
                let drawn = |random: &mut Stream| law.upper_quantile(law.survival(x) * random.uniform());
                let breaks = next == reached
                    || next == attempt && {
                        let h = drawn(&mut random);
                        random.uniform() < boltzmann(barrier, energy, 1.0, x, h)
                    };
                if breaks {
                    (x, threshold) = (0.0, law.upper_quantile(random.uniform()));
                }
            }
        }
        forces.push(x);
    }
    let mean = forces.iter().sum::<f64>() / size as f64;
    let variance = forces.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / (size - 1) as f64;
    (mean, (variance / size as f64).sqrt())
}

#[test]
fn contacts_that_draw_their_threshold_at_every_attempt_agree() {
    let pieces = |pieces: &[(f64, f64)]| -> Vec<Piece> {
        pieces.iter().map(|&(velocity, duration)| Piece { velocity, duration }).collect()
    };
    let slide_hold_slide = pieces(&[(0.04, 17.0), (0.0, 20.0), (0.1, 2.0)]);
    let slide = pieces(&[(0.1, 15.0)]);
    for (law, barrier, pieces) in [
        (gaussian(1.0, 0.2), Barrier::Elastic, slide_hold_slide.clone()),
        (gamma(1.0, 0.5), Barrier::Bell, slide_hold_slide),
        (gamma(1.0, 0.5), Barrier::Elastic, slide.clone()),
        (mixture(&[(0.3, point(0.6)), (0.7, point(1.0))]), Barrier::Catastrophe, slide),
    ] {
        let contacts = additive(&law, 0.1, barrier);
        let time = pieces.iter().map(|piece| piece.duration).sum::<f64>() * (1.0 - 1e-12);
        let (mean, error) = redrawing(&contacts, &pieces, 3000);
        let trace = ensemble(&contacts, 3000).follow(&History::new(pieces).unwrap(), &[time]).unwrap();
        let spread = trace.error[0].hypot(error);
        assert!((trace.force[0] - mean).abs() < 4.0 * spread, "{} {mean} ± {spread}", trace.force[0]);
    }
}

/// Refused with the key.
#[test]
fn solvers_that_follow_thresholds_refuse_it() {
    let contacts = additive(&gaussian(1.0, 0.1), 0.05, Barrier::Elastic);
    let start = Initial { law: point(0.0), start: Start::Conditional };
    let mut ageing = contacts.clone();
    ageing.rules.ageing = Some(Ageing::Logarithmic { growth: 0.02, time: 1.0 });
    let errors = [
        Transport::new(contacts.clone(), &start).unwrap_err(),
        Transport::steady(&contacts, 1.0).unwrap_err(),
        DynamicStiffness::new(&contacts, 1.0).unwrap_err(),
        MasterEquation::at(ageing, &start, 1.0).unwrap_err(),
    ];
    for error in errors {
        assert!(error.to_string().contains("temperature.hazard"), "{error}");
    }
}
