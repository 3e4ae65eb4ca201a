//! The lattice against a plain one that keeps forces and looks through all of them for every generation.

use crate::common::{exponential, gaussian, initial, mixture, point, rectangular, weibull};
use asperity::contacts::{Contacts, Initial, Start};
use asperity::ensemble::Disorder;
use asperity::ensemble::lattice::{Avalanche, Edges, Lattice, LatticeCoupling, Shape};
use asperity::law::SharedLaw;
use asperity::random::{Purpose, Stream};

const SEED: u64 = 11;

/// Rounding of forces to which thousands of drives were added one by one, and by which equal contacts may differ.
const ROUNDING: f64 = 1e-11;

/// Draws of a law, one after another.
struct Draws {
    law: SharedLaw,
    stream: Stream,
}

impl Draws {
    fn new(law: &SharedLaw, purpose: Purpose, contact: usize) -> Self {
        Self { law: law.clone(), stream: Stream::new(SEED, purpose, contact as u64) }
    }

    fn next(&mut self) -> f64 {
        let mut value = [0.0];
        self.law.fill(&mut self.stream, &mut value);
        value[0]
    }

    /// The first one above `stretch`: as the ensemble draws, as long as 16 draws are enough.
    fn above(&mut self, stretch: f64) -> f64 {
        (0..16).map(|_| self.next()).find(|&value| value > stretch).unwrap()
    }
}

struct Plain {
    coupling: LatticeCoupling,
    forces: Vec<f64>,
    thresholds: Vec<f64>,
    drive: f64,
    draws: Vec<[Draws; 2]>,
}

impl Plain {
    fn new(contacts: &Contacts, initial: &Initial, coupling: LatticeCoupling) -> Self {
        let draws = |contact| {
            let thresholds = Draws::new(&contacts.thresholds, Purpose::Thresholds, contact);
            [thresholds, Draws::new(&contacts.reforming, Purpose::Reforming, contact)]
        };
        let size = coupling.shape.size();
        let mut draws: Vec<_> = (0..size).map(draws).collect();
        let start = |contact| Draws::new(&initial.law, Purpose::Initial, contact).next();
        let forces: Vec<f64> = (0..size).map(start).collect();
        let threshold = |contact: usize| {
            let own = &mut draws[contact][0];
            if initial.start == Start::Relaxed { own.next() } else { own.above(forces[contact]) }
        };
        let thresholds = (0..size).map(threshold).collect();
        Self { coupling, thresholds, drive: 0.0, draws, forces }
    }

    /// The contacts next to one, by rows and columns.
    fn neighbours(&self, contact: usize) -> Vec<usize> {
        let [rows, columns] = self.coupling.shape.sides().map(|side| side as isize);
        let (row, column) = (contact as isize / columns, contact as isize % columns);
        let steps = [(0, -1), (0, 1), (-1, 0), (1, 0)];
        let steps = &steps[..self.coupling.shape.neighbours()];
        let places = steps.iter().map(|step| (row + step.0, column + step.1));
        let inside = |place: &(isize, isize)| {
            self.coupling.edges == Edges::Periodic
                || (0..rows).contains(&place.0) && (0..columns).contains(&place.1)
        };
        let number =
            |(row, column): (isize, isize)| row.rem_euclid(rows) * columns + column.rem_euclid(columns);
        places.filter(inside).map(|place| number(place) as usize).collect()
    }

    fn gap(&self, contact: usize) -> f64 {
        self.thresholds[contact] - self.forces[contact]
    }

    fn next_event(&mut self) -> Avalanche {
        let size = self.forces.len();
        let least = (0..size).min_by(|&a, &b| self.gap(a).total_cmp(&self.gap(b))).unwrap();
        let missing = self.gap(least).max(0.0);
        self.forces.iter_mut().for_each(|force| *force += missing);
        self.drive += missing;
        let force_before = self.forces.iter().sum();
        let mut breaks = vec![0; size];
        let (mut duration, mut released) = (0, 0.0);
        loop {
            let front: Vec<usize> = (0..size).filter(|&contact| self.gap(contact) <= ROUNDING).collect();
            if front.is_empty() {
                break;
            }
            duration += 1;
            let before = self.forces.clone();
            for &contact in &front {
                let [thresholds, reforming] = &mut self.draws[contact];
                self.forces[contact] = reforming.next();
                self.thresholds[contact] = thresholds.above(self.forces[contact]);
            }
            let after = self.forces.clone();
            for contact in front {
                let let_go = before[contact] - after[contact];
                for neighbour in self.neighbours(contact) {
                    self.forces[neighbour] += self.coupling.alpha() * let_go;
                }
                breaks[contact] += 1;
                released += let_go;
            }
        }
        Avalanche {
            drive: self.drive,
            time: 0.0,
            age: 0.0,
            epicentre: least,
            size: breaks.iter().sum(),
            area: breaks.iter().filter(|&&breaks| breaks > 0).count() as u64,
            duration,
            released,
            force_before,
            force_after: self.forces.iter().sum(),
        }
    }
}

/// Both catalogues are the same, event by event; the epicentre is not reported where several contacts tie.
fn compare(contacts: &Contacts, initial: &Initial, coupling: LatticeCoupling, events: usize) {
    let contacts = Contacts { count: coupling.shape.size() as f64, ..contacts.clone() };
    let mut plain = Plain::new(&contacts, initial, coupling);
    let ties = contacts.thresholds.std() == 0.0;
    let mut lattice = Lattice::new(contacts, initial.clone(), &coupling, SEED, Disorder::Annealed).unwrap();
    let mut largest = 0;
    for event in 0..events {
        let (ours, theirs) = (lattice.next_event(&mut ()).unwrap(), plain.next_event());
        let whole = |a: &Avalanche| (a.size, a.area, a.duration, if ties { 0 } else { a.epicentre });
        assert_eq!(whole(&ours), whole(&theirs), "{coupling:?}, event {event}: {ours:?}, {theirs:?}");
        let real = |a: &Avalanche| [a.drive, a.released, a.force_before, a.force_after];
        for (a, b) in real(&ours).into_iter().zip(real(&theirs)) {
            assert!(
                (a - b).abs() < 1e-9 * (1.0 + b.abs()),
                "{coupling:?}, event {event}: {ours:?}, {theirs:?}"
            );
        }
        largest = largest.max(ours.size);
    }
    assert!(largest > 4, "no avalanches by {coupling:?}");
}

fn couplings() -> impl Iterator<Item = LatticeCoupling> {
    let shapes = [Shape::Square([5, 9]), Shape::Square([13, 13]), Shape::Chain(40)];
    shapes.into_iter().flat_map(|shape| {
        let most = 1.0 / shape.neighbours() as f64;
        [
            LatticeCoupling::with_alpha(shape, Edges::Open, most),
            LatticeCoupling::with_alpha(shape, Edges::Open, 0.8 * most),
            LatticeCoupling { shape, edges: Edges::Open, neighbours: 2.0, connection: 3.0 },
            LatticeCoupling::with_alpha(shape, Edges::Periodic, 0.8 * most),
        ]
    })
}

#[test]
fn random_thresholds() {
    let two = mixture(&[(0.5, point(0.8)), (0.5, weibull(2.0, 1.5))]);
    for (thresholds, reforming) in [
        (gaussian(1.0, 0.05), point(0.0)),
        (rectangular(0.6, 1.4), rectangular(0.0, 0.3)),
        (exponential(1.0), point(0.1)),
        (two, gaussian(0.1, 0.05)),
    ] {
        for coupling in couplings() {
            let contacts = Contacts::new(thresholds.clone(), reforming.clone());
            compare(&contacts, &initial(&rectangular(0.0, 0.3)), coupling, 600);
        }
    }
}

/// Contacts that tie break together: from a relaxed start all of them, again and again.
#[test]
fn identical_thresholds() {
    for start in [point(0.0), rectangular(0.0, 0.9)] {
        for coupling in couplings() {
            for reforming in [point(0.0), point(0.2), rectangular(0.0, 0.4)] {
                compare(&Contacts::new(point(1.0), reforming), &initial(&start), coupling, 600);
            }
        }
    }
}

#[test]
fn relaxed_starts() {
    let start = Initial { law: rectangular(0.0, 1.5), start: Start::Relaxed };
    for coupling in couplings() {
        compare(&Contacts::new(gaussian(1.0, 0.1), point(0.0)), &start, coupling, 300);
    }
}
