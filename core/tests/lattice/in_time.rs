//! The lattice at a velocity: uncoupled against the ensemble in time and the renewal equation, coupled against plain
//! programs that go on in small steps, and against the lattice without time.

use crate::common::sliders::Impatient;
use crate::common::{gaussian, initial, lognormal, point, rectangular};
use asperity::Error;
use asperity::contacts::{Ageing, Barrier, Contacts, Initial, Start, Temperature, ThresholdEvolution};
use asperity::ensemble::lattice::{Avalanche, Edges, Lattice, LatticeCoupling, Shape, Until};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::history::{History, Piece};
use asperity::law::SharedLaw;
use asperity::master::MasterEquation;
use asperity::random::{Purpose, Stream};
use asperity::task::interface::{DrivenContacts, DrivenContactsInTime, DrivenInterface, LoadPointMotion};

const SEED: u64 = 3;
const BARRIERS: [Barrier; 3] = [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe];

fn warm(energy: f64, attempt_rate: f64, barrier: Barrier) -> Option<Temperature> {
    Some(Temperature { barrier, ..Temperature::new(energy, attempt_rate) })
}

fn logarithmic() -> Ageing {
    Ageing::Logarithmic { growth: 0.05, time: 0.3 }
}

fn frozen(mature: SharedLaw) -> Ageing {
    Ageing::FrozenRank { mature, time: 1.5 }
}

/// Every combination of a barrier, or none, with a rule of ageing, or none.
fn rules() -> Vec<(Option<Temperature>, Option<Ageing>)> {
    let barriers = BARRIERS.map(|barrier| warm(0.05, 2.0, barrier));
    let ageing = [
        None,
        Some(logarithmic()),
        Some(frozen(gaussian(1.4, 0.05))),
        // It weakens contacts, and the strongest ones most.
        Some(frozen(gaussian(0.8, 0.02))),
    ];
    let temperatures = || [None].into_iter().chain(barriers);
    ageing.into_iter().flat_map(|ageing| temperatures().map(move |warm| (warm, ageing.clone()))).collect()
}

fn contacts(
    thresholds: SharedLaw,
    (temperature, ageing): &(Option<Temperature>, Option<Ageing>),
) -> Contacts {
    let mut contacts = Contacts::new(thresholds, point(0.0));
    contacts.rules.temperature = *temperature;
    contacts.rules.ageing = ageing.clone();
    contacts
}

fn square(side: usize, edges: Edges, share: f64) -> LatticeCoupling {
    LatticeCoupling::with_alpha(Shape::Square([side, side]), edges, share)
}

fn lattice(contacts: &Contacts, start: &SharedLaw, coupling: &LatticeCoupling, velocity: f64) -> Lattice {
    let contacts = Contacts { count: coupling.shape.size() as f64, ..contacts.clone() };
    Lattice::at(contacts, initial(start), coupling, velocity, SEED, Disorder::Annealed).unwrap()
}

fn events(lattice: &mut Lattice, events: u64) -> Vec<Avalanche> {
    let mut catalogue = Vec::new();
    lattice.run(Until::Events(events), &mut |avalanche| catalogue.push(*avalanche)).unwrap();
    catalogue
}

/// Without springs between them contacts have the lives of the ensemble, which integrates their rates by quadrature, through holds
/// and changes of the velocity.
#[test]
fn uncoupled_contacts_are_the_ensemble_in_time() {
    let pieces = [(0.5, 3.0), (0.0, 2.0), (0.05, 10.0), (2.0, 1.5)];
    let history =
        History::new(pieces.map(|(velocity, duration)| Piece { velocity, duration }).to_vec()).unwrap();
    let start = gaussian(0.2, 0.05);
    for rules in rules() {
        for (coupling, disorder) in [
            (square(10, Edges::Open, 0.0), Disorder::Annealed),
            (square(10, Edges::Periodic, 0.0), Disorder::Quenched),
        ] {
            let contacts = Contacts { count: 100.0, ..contacts(gaussian(1.0, 0.1), &rules) };
            let ensemble = Ensemble::new(contacts.clone(), initial(&start), 100, SEED, disorder).unwrap();
            let mut lattice =
                Lattice::at(contacts, initial(&start), &coupling, pieces[0].0, SEED, disorder).unwrap();
            let mut times = Vec::new();
            let (mut forces, mut begun, mut breaks) = (Vec::new(), 0.0, 0);
            for (velocity, duration) in pieces {
                lattice.set_velocity(velocity).unwrap();
                for step in 1..=7 {
                    times.push(begun + duration * (f64::from(step) - 0.123) / 7.0);
                    let until = Until::Time(times[times.len() - 1]);
                    lattice.run(until, &mut |avalanche| breaks += avalanche.size).unwrap();
                    forces.push(lattice.force());
                }
                begun += duration;
                lattice.run(Until::Time(begun), &mut |avalanche| breaks += avalanche.size).unwrap();
            }
            // The last time of the ensemble is that up to which breaks are counted.
            times.push(begun);
            forces.push(lattice.force());
            let trace = ensemble.follow(&history, &times).unwrap();
            assert_eq!(breaks, trace.breaks, "{rules:?}");
            for ((found, expected), time) in forces.iter().zip(&trace.force).zip(&times) {
                // The ensemble's integrals have errors of 1e-10 of a hazard of 1, for each of 100 contacts.
                assert!((found - expected).abs() < 1e-7, "{rules:?} at {time}: {found} {expected}");
            }
        }
    }
}

/// General distributions that keep their ranks, from a table.
#[test]
fn uncoupled_contacts_of_ranks_from_a_table() {
    let rules = (warm(0.05, 2.0, Barrier::Elastic), Some(frozen(lognormal(1.3, 0.1))));
    let contacts = Contacts { count: 25.0, ..contacts(lognormal(1.0, 0.1), &rules) };
    let start = point(0.0);
    let ensemble = Ensemble::new(contacts.clone(), initial(&start), 25, SEED, Disorder::Annealed).unwrap();
    let mut lattice = lattice(&contacts, &start, &square(5, Edges::Open, 0.0), 0.3);
    let times: Vec<f64> = (1..20).map(|k| 0.71 * f64::from(k)).collect();
    let trace =
        ensemble.follow(&History::new(vec![Piece { velocity: 0.3, duration: 20.0 }]).unwrap(), &times);
    for (&time, expected) in times.iter().zip(&trace.unwrap().force) {
        lattice.run(Until::Time(time), &mut |_| ()).unwrap();
        // As above, for 25 contacts.
        assert!((lattice.force() - expected).abs() < 1e-7, "{time}: {} {expected}", lattice.force());
    }
}

/// The force of uncoupled contacts against the renewal solver, in the first oscillations, within 4 standard
/// errors: 30 comparisons fail a right program once in 500 for a fresh seed. Lives of warm contacts whose ranks are frozen take the
/// renewal equation minutes; the ensemble in time has them above.
#[test]
fn uncoupled_contacts_carry_the_friction_of_the_renewal_equation() {
    let (velocity, side) = (0.2, 60);
    let is_long = |(warm, ageing): &(Option<Temperature>, Option<Ageing>)| {
        warm.is_some() && matches!(ageing, Some(Ageing::FrozenRank { .. }))
    };
    for rules in rules().into_iter().filter(|rules| !is_long(rules)) {
        let contacts = contacts(gaussian(1.0, 0.1), &rules);
        let renewal = MasterEquation::at(contacts.clone(), &Initial::default(), velocity).unwrap();
        let pull = renewal.pull_with(8.0, 1e-6, &mut ()).unwrap();
        let mut lattice = lattice(&contacts, &point(0.0), &square(side, Edges::Open, 0.0), velocity);
        for drive in [2.3, 4.1, 8.0] {
            lattice.run(Until::Drive(drive), &mut |_| ()).unwrap();
            let stretches = lattice.forces();
            let count = stretches.len() as f64;
            let mean = stretches.iter().sum::<f64>() / count;
            let variance = stretches.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
            let (error, off) = ((variance / count).sqrt(), mean - pull.force(drive));
            assert!(off.abs() < 4.0 * error, "{rules:?} at {drive}: {mean} ± {error}, {}", pull.force(drive));
        }
    }
}

/// A plain lattice that goes on in small steps of time, with the same random numbers. It adds up rates by Simpson's rule and
/// looks at all contacts in every step.
struct Plain {
    contacts: Contacts,
    evolution: ThresholdEvolution,
    coupling: LatticeCoupling,
    velocity: f64,
    time: f64,
    drive: f64,
    forces: Vec<f64>,
    fresh: Vec<f64>,
    births: Vec<f64>,
    left: Vec<f64>,
    thresholds: Vec<Stream>,
    breaking: Vec<Stream>,
}

impl Plain {
    fn new(contacts: &Contacts, start: &SharedLaw, coupling: LatticeCoupling, velocity: f64) -> Self {
        let size = coupling.shape.size();
        let stream = |purpose, contact: usize| Stream::new(SEED, purpose, contact as u64);
        let first = |law: &SharedLaw, stream: &mut Stream| {
            let mut value = [0.0];
            law.fill(stream, &mut value);
            value[0]
        };
        let forces: Vec<f64> =
            (0..size).map(|contact| first(start, &mut stream(Purpose::Initial, contact))).collect();
        let mut plain = Self {
            evolution: ThresholdEvolution::of(contacts).unwrap(),
            contacts: contacts.clone(),
            coupling,
            velocity,
            time: 0.0,
            drive: 0.0,
            fresh: vec![0.0; size],
            births: vec![0.0; size],
            left: vec![f64::INFINITY; size],
            thresholds: (0..size).map(|contact| stream(Purpose::Thresholds, contact)).collect(),
            breaking: (0..size).map(|contact| stream(Purpose::Breaking, contact)).collect(),
            forces,
        };
        for contact in 0..size {
            plain.form(contact, plain.forces[contact]);
        }
        plain
    }

    fn form(&mut self, contact: usize, stretch: f64) {
        let mut value = [0.0];
        while value[0] <= stretch {
            self.contacts.thresholds.fill(&mut self.thresholds[contact], &mut value);
        }
        self.forces[contact] = stretch;
        self.fresh[contact] = value[0];
        self.births[contact] = self.time;
        if self.contacts.rules.temperature.is_some() {
            self.left[contact] = -self.breaking[contact].uniform().ln();
        }
    }

    fn threshold(&self, contact: usize, time: f64) -> f64 {
        self.evolution.threshold(self.fresh[contact], time - self.births[contact])
    }

    fn rate(&self, contact: usize, elapsed: f64) -> f64 {
        let Some(temperature) = self.contacts.rules.temperature else { return 0.0 };
        let threshold = self.threshold(contact, self.time + elapsed);
        temperature.rate(self.forces[contact] + self.velocity * elapsed, threshold, 1.0)
    }

    /// The hazard of a contact in a time.
    fn hazard(&self, contact: usize, elapsed: f64) -> f64 {
        let [a, b, c] = [0.0, 0.5, 1.0].map(|part| self.rate(contact, part * elapsed));
        elapsed * (a + 4.0 * b + c) / 6.0
    }

    /// How far a contact is from breaking after a time, negative if it has broken.
    fn left(&self, contact: usize, elapsed: f64) -> f64 {
        let gap =
            self.threshold(contact, self.time + elapsed) - (self.forces[contact] + self.velocity * elapsed);
        (self.left[contact] - self.hazard(contact, elapsed)).min(gap)
    }

    fn neighbours(&self, contact: usize) -> Vec<usize> {
        let [rows, columns] = self.coupling.shape.sides().map(|side| side as isize);
        let (row, column) = (contact as isize / columns, contact as isize % columns);
        let places = [(0, -1), (0, 1), (-1, 0), (1, 0)].map(|step| (row + step.0, column + step.1));
        let periodic = self.coupling.edges == Edges::Periodic;
        let inside = |&(row, column): &(isize, isize)| {
            periodic || (0..rows).contains(&row) && (0..columns).contains(&column)
        };
        let number =
            |(row, column): (isize, isize)| row.rem_euclid(rows) * columns + column.rem_euclid(columns);
        places.into_iter().filter(inside).map(|place| number(place) as usize).collect()
    }

    fn advance(&mut self, elapsed: f64) {
        for contact in 0..self.forces.len() {
            self.left[contact] -= self.hazard(contact, elapsed);
        }
        self.forces.iter_mut().for_each(|force| *force += self.velocity * elapsed);
        self.drive += self.velocity * elapsed;
        self.time += elapsed;
    }

    /// Goes on, in steps of a time, until a contact breaks, and through the avalanche.
    fn next_event(&mut self, step: f64) -> Avalanche {
        let size = self.forces.len();
        while (0..size).all(|contact| self.left(contact, step) > 0.0) {
            self.advance(step);
        }
        // Bisection for the first of those that break in this step.
        let broken: Vec<usize> = (0..size).filter(|&contact| self.left(contact, step) <= 0.0).collect();
        let when = |&contact: &usize| {
            let (mut low, mut high) = (0.0, step);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                *(if self.left(contact, middle) > 0.0 { &mut low } else { &mut high }) = middle;
            }
            (high, contact)
        };
        let (elapsed, epicentre) = broken.iter().map(when).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        self.advance(elapsed);
        self.avalanche(epicentre)
    }

    fn avalanche(&mut self, epicentre: usize) -> Avalanche {
        let size = self.forces.len();
        let (force_before, age) = (self.forces.iter().sum(), self.time - self.births[epicentre]);
        let (mut duration, mut released, mut breaks) = (0, 0.0, vec![0; size]);
        let mut front = vec![epicentre];
        while !front.is_empty() {
            duration += 1;
            let let_go: Vec<f64> = front.iter().map(|&contact| self.forces[contact]).collect();
            front.iter().for_each(|&contact| self.form(contact, 0.0));
            for (&contact, let_go) in front.iter().zip(&let_go) {
                for neighbour in self.neighbours(contact) {
                    self.forces[neighbour] += self.coupling.alpha() * let_go;
                }
                breaks[contact] += 1;
                released += let_go;
            }
            front = (0..size).filter(|&c| self.forces[c] >= self.threshold(c, self.time)).collect();
        }
        Avalanche {
            drive: self.drive,
            time: self.time,
            age,
            epicentre,
            size: breaks.iter().sum(),
            area: breaks.iter().filter(|&&breaks| breaks > 0).count() as u64,
            duration,
            released,
            force_before,
            force_after: self.forces.iter().sum(),
        }
    }
}

/// A small lattice, event by event.
#[test]
fn coupled_contacts_are_those_of_a_plain_program() {
    let start = rectangular(0.0, 0.5);
    for rules in rules() {
        for (edges, share) in [(Edges::Open, 0.24), (Edges::Periodic, 0.2)] {
            let (velocity, coupling) = (0.3, square(6, edges, share));
            let contacts = contacts(gaussian(1.0, 0.1), &rules);
            let mut plain = Plain::new(&contacts, &start, coupling, velocity);
            let mut lattice = lattice(&contacts, &start, &coupling, velocity);
            let mut largest = 0;
            for event in 0..250 {
                let (ours, theirs) = (lattice.next_event(&mut ()).unwrap(), plain.next_event(2e-3));
                let whole = |a: &Avalanche| (a.epicentre, a.size, a.area, a.duration);
                let context = || format!("{rules:?} {edges:?}, event {event}: {ours:?} {theirs:?}");
                assert_eq!(whole(&ours), whole(&theirs), "{}", context());
                let real =
                    |a: &Avalanche| [a.drive, a.time, a.age, a.released, a.force_before, a.force_after];
                for (a, b) in real(&ours).into_iter().zip(real(&theirs)) {
                    // Simpson's rule in steps of 2e-3 misses up to 1e-7 of a hazard where the barrier of the catastrophe is a half power;
                    // it moves breaks, of which there are up to 60 per contact.
                    assert!((a - b).abs() < 1e-4, "{}", context());
                }
                largest = largest.max(ours.size);
            }
            assert!(largest > 6, "no avalanches: {rules:?}");
        }
    }
}

/// Without temperature and ageing, and at temperatures at which no contact breaks below its threshold, avalanches are those
/// without time.
#[test]
fn cold_contacts_are_those_without_time() {
    let (start, coupling) = (rectangular(0.0, 0.3), square(40, Edges::Open, 0.24));
    let make = |thresholds: &SharedLaw| Contacts {
        count: 1600.0,
        ..Contacts::new(thresholds.clone(), rectangular(0.0, 0.1))
    };
    for thresholds in [gaussian(1.0, 0.1), point(1.0)] {
        let mut timeless =
            Lattice::new(make(&thresholds), initial(&start), &coupling, SEED, Disorder::Annealed).unwrap();
        let expected = events(&mut timeless, 5000);
        for temperature in [None].into_iter().chain(BARRIERS.map(|barrier| warm(1e-30, 1.0, barrier))) {
            let mut contacts = make(&thresholds);
            contacts.rules.temperature = temperature;
            let mut lattice = lattice(&contacts, &start, &coupling, 0.7);
            for (found, expected) in events(&mut lattice, 5000).into_iter().zip(&expected) {
                // Drives and times are sums of up to 10 bases.
                assert!((0.7 * found.time - found.drive).abs() < 1e-13 * found.drive);
                assert_eq!(Avalanche { time: 0.0, age: 0.0, ..found }, *expected);
            }
            assert_eq!(lattice.forces(), timeless.forces());
        }
    }
}

/// A plain program with random numbers of its own: in each short step a contact breaks with the probability 1 − e^{−wΔt}. The mean
/// force and the rate of breaks agree within 4 standard errors of the means over 40 stretches of time.
#[test]
fn means_are_those_of_breaking_by_chance_in_short_steps() {
    let coupling = square(6, Edges::Periodic, 0.2);
    for barrier in BARRIERS {
        let contacts = contacts(gaussian(1.0, 0.1), &(warm(0.1, 2.0, barrier), Some(logarithmic())));
        let (velocity, step, span, blocks) = (0.3, 1e-3, 10.0, 40);
        let mut plain = Plain::new(&contacts, &point(0.0), coupling, velocity);
        let mut stream = Stream::new(77, Purpose::Sample, 0);
        let mut lattice = lattice(&contacts, &point(0.0), &coupling, velocity);
        let mut means = [[Vec::new(), Vec::new()], [Vec::new(), Vec::new()]];
        for block in 0..blocks + 1 {
            let (mut force, mut breaks) = (0.0, 0);
            let steps = (span / step) as u32;
            for _ in 0..steps {
                plain.time += step;
                plain.forces.iter_mut().for_each(|force| *force += velocity * step);
                for contact in 0..36 {
                    let risk = 1.0 - (-plain.rate(contact, -0.5 * step) * step).exp();
                    let over = plain.forces[contact] >= plain.threshold(contact, plain.time);
                    if over || stream.uniform() < risk {
                        breaks += plain.avalanche(contact).size;
                    }
                }
                force += plain.forces.iter().sum::<f64>() / f64::from(steps);
            }
            let (mut ours, mut our_breaks) = (0.0, 0);
            for k in 1..=1000 {
                let until = Until::Time(span * (f64::from(block) + f64::from(k) / 1000.0));
                lattice.run(until, &mut |avalanche| our_breaks += avalanche.size).unwrap();
                ours += lattice.force() / 1000.0;
            }
            // The first stretch of time has the transient.
            if block > 0 {
                means[0][0].push(force);
                means[0][1].push(ours);
                means[1][0].push(breaks as f64);
                means[1][1].push(our_breaks as f64);
            }
        }
        for [plain, ours] in means {
            let of = |values: &[f64]| {
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
                (mean, square / (values.len() * (values.len() - 1)) as f64)
            };
            let ((a, va), (b, vb)) = (of(&plain), of(&ours));
            // Steps of 1e-3 delay breaks by half a step, of lives of some units of time.
            assert!(
                (a - b).abs() < 4.0 * (va + vb).sqrt() + 5e-4 * a,
                "{barrier:?}: {a} {b} ± {}",
                (va + vb).sqrt()
            );
        }
    }
}

/// In the bulk the drive takes 1 − zα of what is let go.
#[test]
fn force_is_lost_to_the_drive_alone() {
    for rules in rules() {
        let coupling = square(12, Edges::Periodic, 0.22);
        let mut contacts = contacts(gaussian(1.0, 0.1), &rules);
        contacts.reforming = rectangular(0.0, 0.3);
        let mut lattice = lattice(&contacts, &rectangular(0.0, 0.3), &coupling, 0.1);
        for avalanche in events(&mut lattice, 2000) {
            let bulk = coupling.dissipated() * avalanche.released;
            // Sums over all contacts, with a rounding for each break.
            assert!((avalanche.drop() - bulk).abs() < 1e-11 * (1.0 + avalanche.released.abs()));
        }
        let sum: f64 = lattice.forces().iter().sum();
        assert!((sum - lattice.force()).abs() < 1e-10);
    }
}

/// A lattice restored goes on bit for bit, at rest too.
#[test]
fn a_restored_lattice_goes_on() {
    for rules in rules() {
        let make = || {
            let contacts = contacts(gaussian(1.0, 0.1), &rules);
            lattice(&contacts, &rectangular(0.0, 0.3), &square(20, Edges::Open, 0.23), 0.1)
        };
        let mut whole = make();
        events(&mut whole, 1000);
        for velocity in [0.1, 0.0] {
            whole.set_velocity(velocity).unwrap();
            whole.run(Until::Time(whole.time() + 0.01), &mut |_| ()).unwrap();
            let mut restored = make();
            let mut state = Vec::new();
            ciborium::into_writer(&whole.state(), &mut state).unwrap();
            restored.restore(ciborium::from_reader(state.as_slice()).unwrap()).unwrap();
            let [mut found, mut expected] = [Vec::new(), Vec::new()];
            let until = Until::Time(whole.time() + 0.3);
            whole.run(until, &mut |one| expected.push(*one)).unwrap();
            restored.run(until, &mut |one| found.push(*one)).unwrap();
            assert_eq!(found, expected);
            assert_eq!(restored.forces(), whole.forces());
        }
    }
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let good = square(5, Edges::Periodic, 0.2);
    let make = |contacts: &Contacts, velocity| {
        let made =
            Lattice::at(contacts.clone(), Initial::default(), &good, velocity, SEED, Disorder::Annealed);
        match made.err() {
            Some(Error::Invalid { key, .. }) => key,
            other => format!("{other:?}"),
        }
    };
    let plain = Contacts::new(gaussian(1.0, 0.1), point(0.0));
    for velocity in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(make(&plain, velocity), "velocity");
    }
    let mut delayed = plain.clone();
    delayed.rules.delay = asperity::contacts::FreeTime::Fixed(0.1);
    assert_eq!(make(&delayed, 1.0), "delay");
    let mut aged = plain.clone();
    let mature = gaussian(1.5, 0.1);
    aged.rules.ageing = Some(Ageing::Smoluchowski { mature: mature.clone(), diffusion: 0.1 });
    assert_eq!(make(&aged, 1.0), "ageing.smoluchowski");
    aged.rules.ageing = Some(Ageing::MeanField { mature, diffusion: 0.1 });
    assert_eq!(make(&aged, 1.0), "ageing.mean_field");
    let timeless =
        |contacts: Contacts| Lattice::new(contacts, Initial::default(), &good, SEED, Disorder::Annealed);
    let mut at_rest = timeless(plain.clone()).unwrap();
    for (error, key) in [
        (at_rest.run(Until::Time(1.0), &mut |_| ()).unwrap_err(), "until"),
        (at_rest.set_velocity(1.0).unwrap_err(), "velocity"),
    ] {
        assert!(matches!(error, Error::Invalid { key: found, .. } if found == key));
    }
    // At rest and without temperature no contact breaks.
    let mut still = lattice(&plain, &point(0.0), &good, 1.0);
    still.set_velocity(0.0).unwrap();
    assert_eq!(still.next_time(), f64::INFINITY);
    assert!(still.next_event(&mut ()).is_err() && still.run(Until::Drive(1.0), &mut |_| ()).is_err());
    for end in [f64::INFINITY, f64::NAN].into_iter().flat_map(|end| [Until::Drive(end), Until::Time(end)]) {
        assert!(timeless(plain.clone()).unwrap().run(end, &mut |_| ()).is_err(), "{end:?}");
    }
    assert!(still.restore(timeless(plain).unwrap().state()).is_err());
}

/// In a hold contacts break whose thresholds fall below their stretches, however much more slowly than those at the edges of fresh
/// thresholds change at first: a distribution with jumps, and one that broadens.
#[test]
fn contacts_that_weaken_break_in_a_hold() {
    for (fresh, mature, loaded) in
        [(rectangular(0.9, 1.1), gaussian(0.8, 0.05), 0.8), (gaussian(1.0, 0.01), gaussian(1.0, 0.1), 0.85)]
    {
        let ageing = Ageing::FrozenRank { mature, time: 1.0 };
        let contacts = Contacts { count: 400.0, ..contacts(fresh, &(None, Some(ageing))) };
        let (start, coupling) = (point(0.0), square(20, Edges::Open, 0.0));
        let pieces = [(100.0, loaded / 100.0), (0.0, 10.0)];
        let mut lattice =
            Lattice::at(contacts.clone(), initial(&start), &coupling, 100.0, SEED, Disorder::Annealed)
                .unwrap();
        let (mut begun, mut breaks, mut forces) = (0.0, 0, Vec::new());
        for (velocity, duration) in pieces {
            lattice.set_velocity(velocity).unwrap();
            begun += duration;
            lattice.run(Until::Time(begun), &mut |avalanche| breaks += avalanche.size).unwrap();
            forces.push(lattice.force());
        }
        let pieces = pieces.map(|(velocity, duration)| Piece { velocity, duration });
        let history = History::new(pieces.to_vec()).unwrap();
        let ensemble = Ensemble::new(contacts, initial(&start), 400, SEED, Disorder::Annealed).unwrap();
        let trace = ensemble.follow(&history, &[pieces[0].duration, history.duration()]).unwrap();
        assert_eq!(breaks, trace.breaks);
        assert!(breaks > 0);
        for (found, expected) in forces.iter().zip(&trace.force) {
            // The same contacts, with sums of 400 forces in another order.
            assert!((found - expected).abs() < 1e-10, "{found} {expected}");
        }
    }
}

/// After a hold that was stopped the load point moves on at its velocity: drive and time grow together again.
#[test]
fn a_stopped_hold_is_left_behind() {
    let (velocity, to) = (0.1, 2.0);
    let contacts = contacts(gaussian(1.0, 0.1), &(warm(0.05, 2.0, Barrier::Elastic), None));
    let lattice = lattice(&contacts, &rectangular(0.0, 0.5), &square(8, Edges::Open, 0.2), velocity);
    let driven = DrivenContacts { lattice, chain: false };
    let mut driven = DrivenContactsInTime::new(driven, LoadPointMotion::Velocity(velocity));
    assert!(driven.advance(1.0, u64::MAX, &mut (), &mut |_| ()).unwrap());
    // The first two questions are those of the change of the velocity, the third is that of the first event.
    assert_eq!(driven.hold_with(1e6, &mut Impatient(3)), Err(Error::Stopped));
    let begun = driven.time();
    assert!(driven.advance(to, u64::MAX, &mut (), &mut |_| ()).unwrap());
    assert_eq!(driven.drive(), to);
    // Sums of times of some tens.
    let apart = driven.time() - begun - (to - 1.0) / velocity;
    assert!(apart.abs() < 1e-12 * driven.time(), "{apart:e}");
}

/// A change of the velocity that is stopped leaves the contacts as they were, bit for bit.
#[test]
fn a_change_of_velocity_that_is_stopped_changes_nothing() {
    for rules in rules() {
        let contacts = contacts(gaussian(1.0, 0.1), &rules);
        let started = || {
            let mut started = lattice(&contacts, &rectangular(0.0, 0.5), &square(8, Edges::Open, 0.2), 0.1);
            started.run(Until::Drive(1.0), &mut |_| ()).unwrap();
            started
        };
        let (mut whole, mut stopped) = (started(), started());
        // One question before hazards are counted, and one before the next breaks are computed.
        for question in 1..=2 {
            let outcome = stopped.set_velocity_with(0.02, &mut Impatient(question));
            assert_eq!((outcome, stopped.velocity()), (Err(Error::Stopped), Some(0.1)));
        }
        whole.set_velocity(0.02).unwrap();
        stopped.set_velocity(0.02).unwrap();
        assert_eq!(events(&mut stopped, 50), events(&mut whole, 50));
    }
}

/// Velocity times duration, divided by the velocity, may be below the duration by a rounding: the next piece begins all the same.
#[test]
fn a_piece_of_a_protocol_ends_where_its_time_is_reached_to_rounding() {
    let contacts = contacts(gaussian(1.0, 0.1), &(None, Some(logarithmic())));
    for (velocity, duration) in [(0.1, 0.7), (0.3, 0.7), (0.7, 0.9), (1.1, 0.3), (1e-3, 0.7)] {
        let pieces = [(velocity, duration), (0.0, 10.0), (velocity, duration), (3.0 * velocity, duration)];
        let pieces = pieces.map(|(velocity, duration)| Piece { velocity, duration });
        let history = History::new(pieces.to_vec()).unwrap();
        let end = history.duration();
        let lattice = lattice(&contacts, &point(0.0), &square(4, Edges::Open, 0.2), velocity);
        let driven = DrivenContacts { lattice, chain: false };
        let mut driven = DrivenContactsInTime::new(driven, LoadPointMotion::History(history));
        // Four pieces, each in one turn, or in two where it is entered a rounding early; events need one each.
        assert!(driven.advance(end, 100, &mut (), &mut |_| ()).unwrap(), "{velocity} {duration}");
        assert!((driven.drive() - 5.0 * velocity * duration).abs() < 1e-12);
    }
}

/// A relaxed start breaks what is above its threshold at t = 0, together.
#[test]
fn a_relaxed_start_breaks_at_once() {
    let contacts = contacts(point(1.0), &(warm(0.05, 1.0, Barrier::Bell), None));
    let start = Initial { law: rectangular(0.0, 2.0), start: Start::Relaxed };
    let coupling = square(20, Edges::Open, 0.1);
    let mut lattice = Lattice::at(contacts, start, &coupling, 1.0, SEED, Disorder::Annealed).unwrap();
    let above = lattice.forces().into_iter().filter(|f| *f * 400.0 >= 1.0).count() as u64;
    let first = lattice.next_event(&mut ()).unwrap();
    assert!(above > 100 && first.time == 0.0 && first.area >= above, "{above} {first:?}");
    assert!(lattice.next_event(&mut ()).unwrap().time > 0.0);
}
