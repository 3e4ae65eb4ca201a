//! Lives at a velocity against contacts followed one by one: each from where it forms to where it breaks, then averaged
//! over where contacts form and over their fresh thresholds, in the order that the lives do not take.

use crate::common::{gamma, gaussian, initial, mixture, point, rectangular};
use asperity::contacts::{Ageing, Barrier, Contacts, Rules, Stiffness, Temperature};
use asperity::law::SharedLaw;
use asperity::master::MasterEquation;
use asperity::numerics::legendre::RULE;

/// A kind of contacts at a velocity.
struct Case {
    thresholds: SharedLaw,
    reforming: SharedLaw,
    stiffness: Stiffness,
    rules: Rules,
    velocity: f64,
}

const EQUAL: Stiffness = Stiffness::Equal(1.0);

fn thermal(energy: f64, barrier: Barrier) -> Rules {
    Rules { temperature: Some(Temperature { barrier, ..Temperature::new(energy, 1.0) }), ..Rules::default() }
}

fn ageing(ageing: Ageing) -> Rules {
    Rules { ageing: Some(ageing), ..Rules::default() }
}

fn logarithmic() -> Ageing {
    Ageing::Logarithmic { growth: 0.05, time: 1.0 }
}

/// Thresholds that grow weaker.
fn weakening() -> Ageing {
    Ageing::FrozenRank { mature: gaussian(0.7, 0.15), time: 2.0 }
}

/// The sums of one contact over its life: u, k x, k² x² and, last, the energy ½k x² at which it breaks.
type Sums = [f64; 4];

/// Cells of a life, twice: they shrink towards its beginning, and towards its end, where rates are not smooth.
const CELLS: u32 = 10;

/// Where a cell begins, of a life from 0 to 1.
fn edge(cell: u32) -> f64 {
    let half = |k: u32| 0.5 * (f64::from(k) / f64::from(CELLS)).powi(3);
    if cell < CELLS { half(cell) } else { 1.0 - half(2 * CELLS - cell) }
}

impl Case {
    fn equation(&self) -> MasterEquation {
        let contacts = Contacts {
            stiffness: self.stiffness.clone(),
            rules: self.rules.clone(),
            ..Contacts::new(self.thresholds.clone(), self.reforming.clone())
        };
        MasterEquation::at(contacts, &initial(&self.reforming), self.velocity).unwrap()
    }

    /// h at the advance u.
    fn threshold(&self, fresh: f64, advance: f64) -> f64 {
        let age = advance / self.velocity;
        match &self.rules.ageing {
            Some(Ageing::Logarithmic { growth, time }) => fresh * (1.0 + growth * (1.0 + age / time).ln()),
            Some(Ageing::FrozenRank { mature, time }) => {
                let of = |law: &SharedLaw, k: usize| law.parameters()[k].value;
                let (born, left) = (&self.thresholds, (-age / time).exp());
                let mean = of(mature, 0) + (of(born, 0) - of(mature, 0)) * left;
                let variance =
                    of(mature, 1).powi(2) + (of(born, 1).powi(2) - of(mature, 1).powi(2)) * left * left;
                mean + variance.sqrt() * (fresh - of(born, 0)) / of(born, 1)
            }
            _ => fresh,
        }
    }

    fn stiffness(&self, threshold: f64) -> f64 {
        self.stiffness.of(threshold)
    }

    /// w/v at the advance u.
    fn rate(&self, start: f64, fresh: f64, advance: f64) -> f64 {
        let Some(temperature) = self.rules.temperature else { return 0.0 };
        let threshold = self.threshold(fresh, advance);
        let whole = 0.5 * self.stiffness(threshold) * threshold * threshold;
        let y = ((start + advance) / threshold).min(1.0);
        let barrier = match temperature.barrier {
            Barrier::Elastic => 1.0 - y * y,
            Barrier::Bell => 1.0 - y,
            Barrier::Catastrophe => (1.0 - y).powf(1.5),
            barrier => unreachable!("{barrier:?}"),
        };
        temperature.attempt_rate / self.velocity * (-whole * barrier / temperature.energy).exp()
    }

    /// The first advance at which the stretch is the threshold.
    fn meeting(&self, start: f64, fresh: f64) -> f64 {
        let ahead = |u: f64| self.threshold(fresh, u) - start - u;
        let (mut low, mut high) = (0.0, 1e-4);
        while ahead(high) > 0.0 {
            (low, high) = (high, high + 0.01);
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if ahead(middle) > 0.0 { low = middle } else { high = middle }
        }
        low
    }

    /// A contact from its birth on.
    fn life(&self, start: f64, fresh: f64) -> Sums {
        let end = self.meeting(start, fresh);
        let (mut broken, mut sums) = (0.0, [0.0; 4]);
        for cell in 0..2 * CELLS {
            let (low, high) = (edge(cell) * end, edge(cell + 1) * end);
            let rate = |u: f64| self.rate(start, fresh, u);
            for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
                let u = low + 0.5 * (high - low) * (1.0 + t);
                let left = (-broken - RULE.integrate(low, u, rate)).exp();
                let (weight, x) = (0.5 * (high - low) * w * left, start + u);
                let stiffness = self.stiffness(self.threshold(fresh, u));
                sums[0] += weight;
                sums[1] += weight * stiffness * x;
                sums[2] += weight * (stiffness * x).powi(2);
                sums[3] += weight * rate(u) * 0.5 * stiffness * x * x;
            }
            broken += RULE.integrate(low, high, rate);
        }
        let last = self.threshold(fresh, end);
        sums[3] += (-broken).exp() * 0.5 * self.stiffness(last) * (start + end).powi(2);
        sums
    }

    /// The mean over a law of what lies above `least`: Gauss points, `parts` times between `cuts`.
    fn mean(law: &SharedLaw, least: f64, cuts: &[f64], parts: u32, f: &dyn Fn(f64) -> Sums) -> Sums {
        let mut sums = [0.0; 4];
        let mut add = |x: f64, weight: f64| {
            sums.iter_mut().zip(f(x)).for_each(|(sum, term)| *sum += weight * term);
        };
        law.atoms().iter().filter(|a| a.position > least).for_each(|a| add(a.position, a.weight));
        let mut edges: Vec<f64> = law.breakpoints().iter().map(|b| b.position).collect();
        edges.extend(law.zones().iter().flat_map(|zone| [zone.low, zone.high]));
        let highest = edges.iter().copied().fold(0.0, f64::max);
        edges.extend(cuts.iter().filter(|&&x| x < highest));
        edges.retain(|&x| x > least);
        edges.push(least);
        edges.sort_by(f64::total_cmp);
        for pair in edges.windows(2) {
            for part in 0..parts {
                let at = |k: u32| pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(parts);
                let (middle, half) = (0.5 * (at(part) + at(part + 1)), 0.5 * (at(part + 1) - at(part)));
                for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
                    let x = middle + half * t;
                    let density = law.density(x);
                    if density > 1e-15 {
                        add(x, half * w * density);
                    }
                }
            }
        }
        sums
    }

    fn expected(&self) -> Sums {
        let of_start = |start: f64| {
            let all = Self::mean(&self.thresholds, start, &[], 4, &|fresh| self.life(start, fresh));
            all.map(|sum| sum / self.thresholds.survival(start))
        };
        let cuts: Vec<f64> = self.thresholds.breakpoints().iter().map(|b| b.position).collect();
        Self::mean(&self.reforming, -1.0, &cuts, 1, &of_start)
    }

    #[track_caller]
    fn check(&self, tolerance: f64) {
        let [life, force, square, energy] = self.expected();
        let equation = self.equation();
        let steady = equation.steady_state();
        let mean = life + self.velocity * self.rules.delay.mean();
        let found = [
            equation.life().mean(),
            steady.kinetic_friction(),
            steady.force_std(1.0),
            equation.life().breaking_energy().curve().value(0.0),
        ];
        let std = (square / mean - (force / mean).powi(2)).sqrt();
        for (found, expected) in found.into_iter().zip([mean, force / mean, std, energy]) {
            assert!(
                (found - expected).abs() < tolerance * expected,
                "{found} {expected} {:e}",
                found / expected - 1.0
            );
        }
    }
}

/// Gauss points over a dozen standard deviations in four parts, and the cells of each life, leave out less.
const QUADRATURE: f64 = 1e-9;

#[test]
fn temperature_with_any_barrier_any_starts_and_either_stiffness() {
    for (stiffness, barrier, reforming, velocity) in [
        (EQUAL, Barrier::Elastic, rectangular(0.0, 0.3), 1e-3),
        (EQUAL, Barrier::Bell, rectangular(0.0, 0.3), 1.0),
        (EQUAL, Barrier::Catastrophe, point(0.1), 1e-3),
        (Stiffness::PerThreshold(1.0), Barrier::Elastic, point(0.1), 1.0),
        (Stiffness::PerThreshold(1.0), Barrier::Bell, rectangular(0.0, 0.3), 1e-3),
        (Stiffness::PerThreshold(1.0), Barrier::Catastrophe, point(0.1), 1.0),
    ] {
        let (thresholds, rules) = (gaussian(1.0, 0.1), thermal(0.05, barrier));
        Case { thresholds, reforming, stiffness, rules, velocity }.check(QUADRATURE);
    }
}

#[test]
fn starts_among_thresholds_with_edges() {
    for barrier in [Barrier::Elastic, Barrier::Bell] {
        let (thresholds, reforming) = (rectangular(0.4, 1.6), rectangular(0.0, 0.6));
        let rules = Rules { delay: 30.0.into(), ..thermal(0.05, barrier) };
        Case { thresholds, reforming, stiffness: EQUAL, rules, velocity: 1e-2 }.check(QUADRATURE);
    }
}

#[test]
fn thresholds_that_many_share() {
    let half = mixture(&[(0.5, point(1.0)), (0.5, gamma(1.2, 0.2))]);
    for reforming in [point(0.0), rectangular(0.0, 0.4)] {
        for velocity in [1e-3, 1.0] {
            let case = |thresholds: SharedLaw| Case {
                thresholds,
                reforming: reforming.clone(),
                stiffness: EQUAL,
                rules: thermal(0.05, Barrier::Elastic),
                velocity,
            };
            case(point(1.0)).check(QUADRATURE);
            case(half.clone()).check(QUADRATURE);
        }
    }
}

#[test]
fn ageing_with_and_without_temperature() {
    for stiffness in [EQUAL, Stiffness::PerThreshold(1.0)] {
        for law in [logarithmic(), weakening()] {
            for velocity in [1e-2, 1.0] {
                for rules in [
                    ageing(law.clone()),
                    Rules { ageing: Some(law.clone()), ..thermal(0.05, Barrier::Elastic) },
                ] {
                    let (thresholds, reforming) = (gaussian(1.0, 0.1), point(0.0));
                    Case { thresholds, reforming, stiffness: stiffness.clone(), rules, velocity }
                        .check(QUADRATURE);
                }
            }
        }
    }
}

#[test]
fn ageing_of_contacts_that_start_among_thresholds() {
    for velocity in [1e-2, 1.0] {
        let (thresholds, reforming) = (rectangular(0.4, 1.6), rectangular(0.0, 0.6));
        let rules = ageing(logarithmic());
        Case { thresholds, reforming, stiffness: EQUAL, rules, velocity }.check(QUADRATURE);
    }
}

#[test]
fn ageing_at_a_temperature_of_contacts_that_start_at_any_stretch() {
    for law in [logarithmic(), weakening()] {
        let (thresholds, reforming) = (gaussian(1.0, 0.1), rectangular(0.0, 0.2));
        let rules = Rules { ageing: Some(law), ..thermal(0.05, Barrier::Elastic) };
        Case { thresholds, reforming, stiffness: EQUAL, rules, velocity: 1e-2 }.check(QUADRATURE);
    }
}
