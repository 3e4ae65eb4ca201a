//! The linear response of steady sliding from the renewal equation: the dynamic stiffness of the contacts, alone and behind a
//! spring.
//!
//! Contacts slide steadily at v. A deviation δX e^{st} of the slider stretches a contact of age a, formed at t − a, by
//! δx = (1 − e^{−sa}) δX e^{st} more. With S(a) the surviving fraction of contacts of one fresh threshold, w(x, h) their breaking
//! rate, x = va their stretch, h(a) their threshold and a_b the age at which x reaches h, the fraction that survives changes by
//!
//! δS(a) = −[S(a) Q(a) + S(a_b) (1 − e^{−s a_b})/(v − h'(a_b)) δ(a − a_b)] δX e^{st}, Q(a) = ∫₀^a ∂w/∂x (1 − e^{−sa'}) e^{−s(a − a')} da'.
//!
//! The rate of formation Γ changes so that contacts stay as many: with ⟨·⟩ the mean over fresh thresholds, Γ_s = 1/(⟨∫S da⟩ + ⟨τ⟩)
//! and the delay τ, in general of a distribution with the Laplace transform d̂(s), for one delay e^{−sτ},
//!
//! δΓ [⟨∫e^{−sa} S da⟩ + (1/d̂ − 1)/s] = −Γ_s ⟨∫δS da⟩, F̂(s) = N_c {δΓ [⟨∫k x e^{−sa} S da⟩ + f (1/d̂ − 1)/s] + Γ_s ⟨∫k [x δS +
//! (1 − e^{−sa}) S] da⟩}
//!
//! with f the friction force of a free contact.
//!
//! F̂(0) = 0, and F̂ ≈ s dF_k/dv for s → 0. Behind a spring K without mass and damping a displacement δX_T e^{st} of the load point
//! changes position and force by δX = K/(K + F̂) δX_T and δF = KF̂/(K + F̂) δX_T.

use std::f64::consts::PI;

use num_complex::Complex64;

use crate::contacts::{Ageing, Contacts, FreeTime, Rules, ThresholdEvolution};
use crate::error::positive;
use crate::master::{StepResponse, Transport};
use crate::monitor::{Aside, Monitor, Watch, report};
use crate::numerics::legendre::RULE;
use crate::numerics::roots::brent_root;
use crate::{Error, Result};

/// The dynamic stiffness F̂(s) of contacts in steady sliding, force per length.
#[derive(Debug, Clone)]
pub struct DynamicStiffness {
    velocity: f64,
    /// The mean fresh threshold, which sets the frequencies.
    length: f64,
    /// The mean free time.
    delay: f64,
    form: Form,
}

/// How F̂ is computed.
#[derive(Debug, Clone)]
enum Form {
    /// In closed form, of contacts with temperature and constant thresholds.
    Thermal(Box<StepResponse>),
    /// By quadrature over ages and thresholds.
    Quadrature(LifeQuadrature),
}

/// Contacts of all fresh thresholds.
#[derive(Debug, Clone)]
struct LifeQuadrature {
    count: f64,
    delay: FreeTime,
    /// Friction force of a free contact.
    friction: f64,
    /// Γ_s, per time.
    rate: f64,
    lives: Vec<ThresholdLife>,
}

/// Contacts of one fresh threshold in steady sliding, at evenly spaced ages from 0 to the last one.
#[derive(Debug, Clone)]
struct ThresholdLife {
    /// Fraction of all contacts.
    weight: f64,
    spacing: f64,
    ages: Vec<AtAge>,
    /// S(a_b)/(v − h'(a_b)).
    lost: f64,
}

/// Contacts of one age.
#[derive(Debug, Clone, Copy)]
struct AtAge {
    survival: f64,
    /// ∂w/∂x.
    slope: f64,
    stiffness: f64,
    stretch: f64,
}

/// The motion after a small change of the velocity of the load point, per change of the velocity.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SpringResponse {
    /// δX/δV, a time: the change of the position of the slider relative to its steady motion.
    pub position: Vec<f64>,
    /// δF/δV, force per velocity.
    pub force: Vec<f64>,
}

/// Ages of a contact; the trapezoidal rule errs by some 1e-5.
const AGES: usize = 2000;

/// Panels of thresholds, with 16 Gauss points each.
const PANELS: u32 = 4;

/// Fraction of thresholds beyond the panels on either side.
const BEYOND: f64 = 1e-10;

/// Frequencies of the transform into time: from and to, in units of v over the mean threshold, and their number without a delay.
const FREQUENCIES: (f64, f64, u32) = (1e-3, 300.0, 400);

/// Largest change of the phase of the delay between two frequencies, in radians.
const PHASE: f64 = 0.25;

/// Most frequencies, each of which takes a millisecond.
const MOST: f64 = 1e4;

impl DynamicStiffness {
    /// Of contacts that slide steadily at `velocity`.
    ///
    /// # Errors
    /// Those of [`Contacts::check`]; a velocity that is not above 0. Without temperature or with ageing: thresholds with point
    /// masses; contacts that re-form stretched; thresholds that diffuse or follow a mean field.
    pub fn new(contacts: &Contacts, velocity: f64) -> Result<Self> {
        Self::new_with(contacts, velocity, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::new`]; stopped by the monitor.
    pub fn new_with(contacts: &Contacts, velocity: f64, monitor: &mut dyn Monitor) -> Result<Self> {
        positive("velocity", velocity)?;
        contacts.check(&crate::contacts::Initial::default())?;
        contacts.have_no_stiffness_table()?;
        contacts.break_by_own_threshold()?;
        let aside = &mut Aside { fraction: 0.0, monitor };
        let Rules { delay, free_friction, .. } = &contacts.rules;
        if free_friction.viscosity > 0.0 {
            let expected =
                "free contacts without viscosity, with which the dynamic stiffness has no upper limit";
            return Err(Error::invalid("free_friction.viscosity", expected, free_friction.viscosity));
        }
        let form = match Transport::thermal_response(contacts, velocity, aside)? {
            Some(thermal) => Form::Thermal(Box::new(thermal)),
            None => {
                are_integrated(contacts)?;
                Form::Quadrature(LifeQuadrature::new(contacts, velocity, aside)?)
            }
        };
        Ok(Self { velocity, length: contacts.thresholds.mean(), delay: delay.mean(), form })
    }

    /// F̂(s) for Re s ≥ 0 up to some hundred v over the mean threshold, the highest frequency that the ages resolve; with
    /// temperature and without ageing at any frequency, in closed form ([`Transport::step_response`]).
    pub fn at(&self, s: Complex64) -> Complex64 {
        match &self.form {
            Form::Thermal(thermal) => thermal.at(s),
            Form::Quadrature(quadrature) => quadrature.at(s),
        }
    }

    /// F̂(∞), the response to a sudden displacement. With one delay for all breaks F̂ has no limit for s → i∞; this is its value at
    /// the frequencies of which the delay is a multiple of the period.
    pub fn instantaneous(&self) -> f64 {
        match &self.form {
            Form::Thermal(thermal) => thermal.instantaneous(),
            Form::Quadrature(quadrature) => quadrature.instantaneous(),
        }
    }

    /// The dynamic stiffness KF̂/(K + F̂) of contacts and a spring K in series: the change of the force per displacement
    /// δX_T e^{st} of the load point.
    pub fn behind(&self, stiffness: f64, s: Complex64) -> Complex64 {
        let contacts = self.at(s);
        stiffness * contacts / (stiffness + contacts)
    }

    /// The stiffness above which steady sliding behind a spring without mass and damping is stable, and the angular frequency of
    /// the oscillation that sets in there: the largest −Re F̂(iω) where Im F̂ = 0, or −F̂(∞), with an infinite frequency.
    /// `None` if steady sliding is stable behind every spring.
    ///
    /// # Errors
    /// A delay too long for the frequencies to resolve; stopped by the monitor.
    pub fn critical_stiffness(&self, monitor: &mut dyn Monitor) -> Result<Option<(f64, f64)>> {
        let watch = Watch::new(monitor);
        let imaginary = |frequency: f64| watch.value(|| self.at(Complex64::new(0.0, frequency)).im);
        let frequencies = self.frequencies()?;
        let values: Vec<f64> = frequencies.iter().map(|&frequency| imaginary(frequency)).collect();
        let mut found = vec![(-self.instantaneous(), f64::INFINITY)];
        for (ends, values) in frequencies.windows(2).zip(values.windows(2)) {
            if (values[0] > 0.0) != (values[1] > 0.0)
                && let Some(frequency) = brent_root(imaginary, ends[0], ends[1], 1e-9 * ends[0])
            {
                found.push((-self.at(Complex64::new(0.0, frequency)).re, frequency));
            }
        }
        watch.check()?;
        Ok(found.into_iter().filter(|one| one.0 > 0.0).max_by(|a, b| a.0.total_cmp(&b.0)))
    }

    /// The motion of steady sliding behind a spring K without mass and damping after a small change δV of the load-point
    /// velocity, at `times` since then.
    ///
    /// δF/δV = (2/π) ∫₀^∞ Im[KF̂/(K + F̂)] sin(ωt)/ω² dω, by Filon's rule to some 1e-3 of its largest value; K must be above the
    /// critical stiffness. The square of δV/v is left out.
    ///
    /// # Errors
    /// A stiffness that is not a finite number above 0; a delay too long for the frequencies to resolve; stopped by the monitor.
    pub fn after_velocity_change(
        &self,
        stiffness: f64,
        times: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<SpringResponse> {
        positive("stiffness", stiffness)?;
        let watch = Watch::new(monitor);
        let mut frequencies = self.frequencies()?;
        let part = |frequency: f64| {
            watch.value(|| self.behind(stiffness, Complex64::new(0.0, frequency)).im / frequency)
        };
        let parts: Vec<f64> = frequencies.iter().map(|&frequency| part(frequency)).collect();
        watch.check()?;
        // The pole at ω = 0, dF_k/dv/ω, is that of an exponential approach, in closed form; the rest is regular.
        let (steady, corner) = (parts[0], self.velocity / self.length);
        let rest = |(frequency, part): (&f64, &f64)| {
            (part - steady / (1.0 + (frequency / corner).powi(2))) / frequency
        };
        let mut rests: Vec<f64> = frequencies.iter().zip(&parts).map(rest).collect();
        frequencies.insert(0, 0.0);
        rests.insert(0, 0.0);
        let force_at = |&time: &f64| {
            let cells = frequencies.windows(2).zip(rests.windows(2));
            let sum: f64 = cells.map(|(ends, values)| filon(ends, values, time)).sum();
            2.0 / PI * sum - steady * (-corner * time).exp_m1()
        };
        let force: Vec<f64> = times.iter().map(force_at).collect();
        let position = times.iter().zip(&force).map(|(time, force)| time - force / stiffness).collect();
        Ok(SpringResponse { position, force })
    }

    /// Angular frequencies between which F̂ is smooth.
    fn frequencies(&self) -> Result<Vec<f64>> {
        let (low, high, count) = FREQUENCIES;
        let (unit, delay) = (self.velocity / self.length, self.delay);
        let needed = unit * high * delay / PHASE;
        if needed > MOST {
            let expected = format!(
                "at most {} at this velocity, so that the frequencies resolve it",
                MOST / needed * delay
            );
            return Err(Error::invalid("delay", expected, delay));
        }
        let sparse = (0..=count).map(|i| unit * low * (high / low).powf(f64::from(i) / f64::from(count)));
        let mut frequencies: Vec<f64> = Vec::new();
        for next in sparse {
            let last = frequencies.last().copied().unwrap_or(next);
            let parts = ((next - last) * delay / PHASE).ceil().max(1.0);
            frequencies.extend((1..=parts as u32).map(|i| last + f64::from(i) / parts * (next - last)));
        }
        Ok(frequencies)
    }
}

/// ∫ f sin(ωt) dω over an interval on which f is linear.
fn filon(ends: &[f64], values: &[f64], time: f64) -> f64 {
    let (half, middle) = (0.5 * (ends[1] - ends[0]), 0.5 * (ends[0] + ends[1]));
    let (mean, tilt) = (0.5 * (values[0] + values[1]), 0.5 * (values[1] - values[0]));
    let phase = half * time;
    let (sine, cosine) = (middle * time).sin_cos();
    // ∫ cos and ∫ u sin over u from −1 to 1, by series where they would lose digits.
    let (even, odd) = if phase.abs() < 1e-2 {
        (2.0 - phase * phase / 3.0, 2.0 * phase / 3.0)
    } else {
        (2.0 * phase.sin() / phase, 2.0 * (phase.sin() / phase - phase.cos()) / phase)
    };
    half * (mean * sine * even + tilt * cosine * odd)
}

/// Whether the trapezoidal rule of ages integrates the lives of contacts.
fn are_integrated(contacts: &Contacts) -> Result<()> {
    if contacts.reforming.upper_quantile(0.0) > 0.0 {
        let found = format!("up to {}", contacts.reforming.upper_quantile(0.0));
        return Err(Error::invalid("reforming", "contacts that re-form without stretch", found));
    }
    if let Some(atom) = contacts.thresholds.atoms().first() {
        let expected =
            "a distribution without point masses, whose simultaneous breaks have no linear response";
        return Err(Error::invalid("thresholds", expected, format!("one at {}", atom.position)));
    }
    if let Some(Ageing::Smoluchowski { .. } | Ageing::MeanField { .. }) = contacts.rules.ageing {
        let expected = "thresholds that follow from the age of a contact (logarithmic or frozen_rank)";
        return Err(Error::invalid("ageing", expected, "another"));
    }
    Ok(())
}

impl LifeQuadrature {
    fn new(contacts: &Contacts, velocity: f64, monitor: &mut dyn Monitor) -> Result<Self> {
        let law = contacts.thresholds.as_ref();
        let evolution = ThresholdEvolution::of_with(contacts, monitor)?;
        let (low, high) = (law.quantile(BEYOND), law.upper_quantile(BEYOND));
        let mut borders: Vec<f64> =
            (0..=PANELS).map(|i| low + (high - low) * f64::from(i) / f64::from(PANELS)).collect();
        borders.extend(law.breakpoints().iter().map(|b| b.position).filter(|at| (low..high).contains(at)));
        borders.sort_by(f64::total_cmp);
        let mut lives = Vec::new();
        for ends in borders.windows(2).filter(|ends| ends[1] > ends[0]) {
            let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            for (node, weight) in RULE.nodes.iter().zip(&RULE.weights) {
                report(monitor, 0.0)?;
                let fresh = middle + half * node;
                let weight = half * weight * law.density(fresh);
                lives.push(ThresholdLife::new(contacts, &evolution, velocity, fresh, weight));
            }
        }
        let all: f64 = lives.iter().map(|life| life.weight).sum();
        lives.iter_mut().for_each(|life| life.weight /= all);
        let delay = contacts.rules.delay.clone();
        let mean = lives.iter().map(|life| life.weight * life.sum(|at| at.survival)).sum::<f64>();
        let rate = 1.0 / (mean + delay.mean());
        let friction = contacts.rules.free_friction.force;
        Ok(Self { count: contacts.count, delay, friction, rate, lives })
    }

    fn at(&self, s: Complex64) -> Complex64 {
        let [mut held, mut lost, mut pulls, mut force] = [Complex64::ZERO; 4];
        for life in &self.lives {
            let sums = life.response(s).map(|sum| life.weight * sum);
            held += sums[0];
            lost += sums[1];
            pulls += sums[2];
            force += sums[3];
        }
        let free = self.free(s);
        self.count * self.rate * (force - lost / (held + free) * (pulls + self.friction * free))
    }

    /// The deviation of the free fraction per deviation of the rate of formation.
    fn free(&self, s: Complex64) -> Complex64 {
        let delay = self.delay.mean();
        if s.norm() * delay < 1e-8 {
            return Complex64::from(delay);
        }
        match &self.delay {
            FreeTime::Fixed(delay) => ((s * delay).exp() - 1.0) / s,
            FreeTime::Distributed(law) => (1.0 / law.laplace(s) - 1.0) / s,
        }
    }

    fn instantaneous(&self) -> f64 {
        let friction = if matches!(self.delay, FreeTime::Fixed(_)) { 0.0 } else { self.friction };
        let of = |life: &ThresholdLife| {
            let last = life.ages[life.ages.len() - 1];
            life.weight
                * (life.sum(|at| at.stiffness * at.survival)
                    + (friction - last.stiffness * last.stretch) * life.lost)
        };
        self.count * self.rate * self.lives.iter().map(of).sum::<f64>()
    }
}

impl ThresholdLife {
    /// Contacts of a fresh threshold, followed until they have reached their threshold.
    fn new(
        contacts: &Contacts,
        evolution: &ThresholdEvolution,
        velocity: f64,
        fresh: f64,
        weight: f64,
    ) -> Self {
        let ahead = |age: f64| velocity * age - evolution.threshold(fresh, age);
        let mut end = fresh / velocity;
        while ahead(end) < 0.0 {
            end *= 2.0;
        }
        let last = brent_root(ahead, 0.0, end, 0.0).unwrap_or(end);
        let spacing = last / AGES as f64;
        let Contacts { stiffness, rules, .. } = contacts;
        let (mut ages, mut hazard, mut before) = (Vec::with_capacity(AGES + 1), 0.0, 0.0);
        for i in 0..=AGES {
            let stretch = velocity * spacing * i as f64;
            let threshold = evolution.threshold(fresh, spacing * i as f64).max(stretch);
            let own: f64 = stiffness.of(threshold);
            let (rate, slope) = rules
                .temperature
                .map_or((0.0, 0.0), |temperature| temperature.rate_and_slope(stretch, threshold, own));
            hazard += if i > 0 { 0.5 * spacing * (before + rate) } else { 0.0 };
            before = rate;
            ages.push(AtAge { survival: (-hazard).exp(), slope, stiffness: own, stretch });
        }
        let speed = velocity - evolution.at(last).drift(fresh);
        let lost = ages[AGES].survival / speed;
        Self { weight, spacing, ages, lost }
    }

    /// ∫ over the ages by the trapezoidal rule.
    fn sum(&self, value: impl Fn(&AtAge) -> f64) -> f64 {
        let ends = 0.5 * (value(&self.ages[0]) + value(&self.ages[AGES]));
        self.spacing * (ends + self.ages[1..AGES].iter().map(value).sum::<f64>())
    }

    /// ∫e^{−sa} S, ∫δS, ∫k x e^{−sa} S and ∫k [x δS + (1 − e^{−sa}) S] over the ages a.
    fn response(&self, s: Complex64) -> [Complex64; 4] {
        let step = (-s * self.spacing).exp();
        let (mut late, mut change, mut forcing) = (Complex64::from(1.0), Complex64::ZERO, Complex64::ZERO);
        let mut sums = [Complex64::ZERO; 4];
        for (i, at) in self.ages.iter().enumerate() {
            if i > 0 {
                late *= step;
                let next = at.slope * (1.0 - late);
                change = step * (change + 0.5 * self.spacing * forcing) + 0.5 * self.spacing * next;
                forcing = next;
            }
            let weight = if i == 0 || i == AGES { 0.5 * self.spacing } else { self.spacing };
            let held = weight * at.survival;
            let pull = at.stiffness * at.stretch;
            sums[0] += held * late;
            sums[1] -= held * change;
            sums[2] += held * pull * late;
            sums[3] += held * (at.stiffness * (1.0 - late) - pull * change);
        }
        let (last, broken) = (self.ages[AGES], self.lost * (1.0 - late));
        sums[1] -= broken;
        sums[3] -= last.stiffness * last.stretch * broken;
        sums
    }
}
