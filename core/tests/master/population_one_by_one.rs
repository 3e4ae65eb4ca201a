//! The contacts of a master equation moved back and forth against contacts moved one by one.
//!
//! Within 4 standard errors: a right program fails once in 16 000 comparisons for fresh seeds. There are some 480 here,
//! with fixed seeds.

use crate::common::walk::{drive, force};
use crate::common::{contacts, gamma, gaussian, mixture, point, rectangular, weibull};
use asperity::contacts::{Contacts, Initial, Start, Stiffness, StiffnessTable};
use asperity::law::Law;
use asperity::master::MasterEquation;
use asperity::population::Population;
use asperity::random::{Purpose, Stream};

/// Contacts of a sample.
const SIZE: u64 = 100_000;

/// A contact, with what it has gone through.
struct Contact {
    stretch: f64,
    threshold: f64,
    free: bool,
    lost: f64,
    broken: f64,
}

/// One number of a law.
fn drawn(law: &dyn Law, stream: &mut Stream) -> f64 {
    let mut out = [0.0];
    law.fill(stream, &mut out);
    out[0]
}

/// One number of a law above another.
fn above(law: &dyn Law, low: f64, stream: &mut Stream) -> f64 {
    loop {
        let x = drawn(law, stream);
        if x > low {
            return x;
        }
    }
}

impl Contact {
    fn stiffness(&self, contacts: &Contacts) -> f64 {
        contacts.stiffness.of(self.threshold)
    }

    fn energy(&self, contacts: &Contacts) -> f64 {
        if self.free { 0.0 } else { 0.5 * self.stiffness(contacts) * self.stretch * self.stretch }
    }

    /// Forms again as after a break on a move towards `sign`.
    fn form(&mut self, contacts: &Contacts, sign: f64, stream: &mut Stream) {
        let start = drawn(contacts.reforming.as_ref(), stream);
        (self.stretch, self.free) = (sign * start, false);
        self.threshold = above(contacts.thresholds.as_ref(), start, stream);
        self.lost -= self.energy(contacts);
    }

    /// Moves by `by`; what breaks re-forms at once, unless held.
    fn advance(&mut self, contacts: &Contacts, by: f64, held: bool, stream: &mut Stream) {
        let (sign, mut left) = (by.signum(), by.abs());
        while !self.free && sign * self.stretch + left >= self.threshold {
            left -= self.threshold - sign * self.stretch;
            self.stretch = sign * self.threshold;
            self.lost += self.energy(contacts);
            self.broken += 1.0;
            if held {
                self.free = true;
            } else {
                self.form(contacts, sign, stream);
            }
        }
        self.stretch += sign * left;
    }
}

/// What a move does.
enum Step {
    To(f64),
    Hold,
    Release,
}

const PATH: [Step; 15] = [
    Step::To(1.4),
    Step::To(-0.83),
    Step::To(0.31),
    Step::To(0.2),
    Step::Hold,
    Step::To(0.6),
    Step::To(1.1),
    Step::Release,
    Step::To(1.93),
    Step::To(-1.87),
    Step::Hold,
    Step::To(-1.4),
    Step::To(-2.3),
    Step::Release,
    Step::To(-1.2),
];

/// F, elastic energy, energy lost and breaks per contact at each step: means and their standard errors.
fn sampled(contacts: &Contacts, initial: &Initial) -> Vec<[(f64, f64); 4]> {
    let mut sums = vec![[(0.0, 0.0); 4]; PATH.len()];
    let mut stream = Stream::new(7, Purpose::Sample, 0);
    for _ in 0..SIZE {
        let stretch = drawn(initial.law.as_ref(), &mut stream);
        let threshold = above(contacts.thresholds.as_ref(), stretch, &mut stream);
        let mut contact = Contact { stretch, threshold, free: false, lost: 0.0, broken: 0.0 };
        let (mut position, mut sign, mut held) = (0.0, 1.0, false);
        for (step, sums) in PATH.iter().zip(&mut sums) {
            match step {
                Step::To(to) => {
                    contact.advance(contacts, to - position, held, &mut stream);
                    (position, sign) = (*to, (to - position).signum());
                }
                Step::Hold => held = true,
                Step::Release => {
                    held = false;
                    if contact.free {
                        contact.form(contacts, sign, &mut stream);
                    }
                }
            }
            let carried = if contact.free { 0.0 } else { contact.stiffness(contacts) * contact.stretch };
            let values = [carried, contact.energy(contacts), contact.lost, contact.broken];
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum = (sum.0 + value, sum.1 + value * value);
            }
        }
    }
    let size = SIZE as f64;
    let mean = |(sum, square): (f64, f64)| {
        let mean = sum / size;
        (mean, ((square / size - mean * mean).max(0.0) / size).sqrt())
    };
    sums.into_iter().map(|sums| sums.map(mean)).collect()
}

#[test]
fn every_way_agrees_with_contacts_one_by_one() {
    let half = mixture(&[(0.5, point(1.0)), (0.5, gaussian(0.8, 0.06))]);
    let table = StiffnessTable::new(vec![(0.7, 1.0), (0.9, 2.0), (1.1, 0.5)]).unwrap();
    let [linear, table] = [Stiffness::PerThreshold(1.0), Stiffness::Tabulated(table)];
    let cases = [
        (gaussian(1.0, 0.1), gaussian(0.2, 0.05), gaussian(0.3, 0.1), &linear),
        (weibull(2.5, 1.0), rectangular(0.0, 0.4), weibull(2.0, 0.3), &linear),
        (gamma(1.0, 0.4), point(0.1), rectangular(0.1, 0.5), &table),
        (half, rectangular(0.0, 0.3), point(0.2), &table),
    ];
    for (thresholds, reforming, start, unequal) in cases {
        for stiffness in [Stiffness::Equal(1.0), unequal.clone()] {
            let contacts = Contacts { stiffness: stiffness.clone(), ..contacts(&thresholds, &reforming) };
            let initial = Initial { law: start.clone(), start: Start::Conditional };
            let mut population = MasterEquation::new(contacts.clone(), &initial)
                .unwrap()
                .population_with(1e-10, &mut ())
                .unwrap();
            for (place, (step, sampled)) in PATH.iter().zip(sampled(&contacts, &initial)).enumerate() {
                match step {
                    Step::To(to) => drop(drive(&mut population, *to)),
                    Step::Hold => population.hold().unwrap(),
                    Step::Release => population.release(&mut ()).unwrap(),
                }
                let energies = population.energies();
                let found = [force(&mut population), energies.elastic, energies.lost, energies.broken];
                for (found, (mean, error)) in found.into_iter().zip(sampled) {
                    let off = (found - mean).abs();
                    assert!(
                        off <= 4.0 * error + 1e-12,
                        "{thresholds:?} {stiffness:?}, step {place}: {found}, not {mean} ± {error}"
                    );
                }
            }
        }
    }
}
