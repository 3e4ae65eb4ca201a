//! The ensemble as contacts that move together: against the rigid pull, against contacts moved one by one, and in
//! its own books.

use std::iter::repeat_with;
use std::ops::ControlFlow;

use crate::common::{
    contacts, exponential, gamma, gaussian, initial, master, mixture, point, rectangular, weibull,
};
use asperity::contacts::{Contacts, Initial, Start, Stiffness};
use asperity::ensemble::{Disorder, Ensemble, EnsemblePopulation};
use asperity::law::SharedLaw;
use asperity::monitor::Monitor;
use asperity::population::{Direction, Population};
use asperity::random::{Purpose, Stream};
use asperity::{Error, Result};

use Direction::{Backward, Forward};

const SIZE: usize = 200;
const SEED: u64 = 7;

/// Says stop after being asked a number of times.
struct Patience(u32);

impl Monitor for Patience {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        assert!((0.0..=1.0).contains(&fraction));
        self.0 = self.0.saturating_sub(1);
        if self.0 == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn what_takes_long_with_many_contacts_can_be_stopped() {
    let contacts = contacts(&gaussian(1.0, 0.1), &point(0.0));
    // Two slices of contacts and a bit.
    let ensemble = Ensemble::new(contacts, initial(&point(0.0)), 600_000, 1, Disorder::Annealed).unwrap();
    // Drawn in three slices, put in place in two more, thrown onto rungs in twice two and, as they move, two.
    assert_eq!(asked(|monitor| ensemble.population_with(monitor).map(drop)), 11);
    let population = ensemble.population().unwrap();
    let of_population = |work: &dyn Fn(&mut EnsemblePopulation, &mut Patience) -> Result<()>| {
        asked(|monitor| work(&mut population.clone(), monitor))
    };
    // Taken from the rungs in two slices, broken in three, drawn in two more, put in place in two.
    assert_eq!(of_population(&|population, monitor| population.reset(Forward, monitor)), 9);
    // Seen from the other side before: mirrored in three slices, put in place in two more.
    assert_eq!(of_population(&|population, monitor| population.reset(Backward, monitor)), 14);
    // Taken, mirrored, put in place, thrown onto rungs in twice two and two.
    let turned = of_population(&|population, monitor| {
        let straight = population.smooth_interval(Backward, &mut ())?;
        population.advance(-straight.length)?;
        population.smooth_interval(Backward, monitor).map(drop)
    });
    assert_eq!(turned, 13);
    let released = of_population(&|population, monitor| {
        population.hold()?;
        go(population, 2.0);
        population.release(monitor)
    });
    // Drawn in two slices more, put in place in two.
    assert_eq!(released, 4);
    let recalled = of_population(&|population, monitor| {
        population.mark();
        population.recall(monitor)
    });
    // Taken, and put in place in three slices.
    assert_eq!(recalled, 5);
}

/// How often work asks until it does so no more; stopped at any of these, it says so.
fn asked(work: impl Fn(&mut Patience) -> Result<()>) -> u32 {
    let times = (1..100).find(|&times| match work(&mut Patience(times)) {
        Ok(()) => true,
        Err(stopped) => {
            assert_eq!(stopped, Error::Stopped);
            false
        }
    });
    times.unwrap() - 1
}

/// What is marked comes back: after breaks back and forth, while some contacts are free, and all of it goes on as if
/// nothing had been.
#[test]
fn what_is_marked_comes_back() {
    for case in cases() {
        let mut population = case.population();
        go(&mut population, 1.3);
        population.hold().unwrap();
        go(&mut population, 1.5);
        let mut copy = population.copy();
        population.mark();
        go(&mut population, -1.0);
        population.release(&mut ()).unwrap();
        go(&mut population, 2.0);
        population.reset(Backward, &mut ()).unwrap();
        go(&mut population, 0.7);
        population.recall(&mut ()).unwrap();
        for moved in [&mut population as &mut dyn Population, copy.as_mut()] {
            assert_eq!(moved.position(), 1.5);
            moved.release(&mut ()).unwrap();
            go(moved, 3.0);
            go(moved, -1.0);
        }
        assert_eq!(population.ahead(0.0), copy.ahead(0.0));
        assert_eq!(population.energies(), copy.energies());
        assert_eq!(
            population.smooth_interval(Backward, &mut ()).unwrap(),
            copy.smooth_interval(Backward, &mut ()).unwrap()
        );
    }
}

/// An ensemble's description: relaxed contacts of equal stiffness, 1 in all, unless changed.
#[derive(Clone)]
struct Case {
    thresholds: SharedLaw,
    reforming: SharedLaw,
    stiffness: Stiffness,
    initial: SharedLaw,
    start: Start,
    disorder: Disorder,
    size: usize,
}

impl Case {
    fn of(thresholds: SharedLaw) -> Self {
        Self {
            thresholds,
            reforming: point(0.0),
            stiffness: Stiffness::Equal(1.0),
            initial: point(0.0),
            start: Start::Conditional,
            disorder: Disorder::Annealed,
            size: SIZE,
        }
    }

    fn ensemble(&self) -> Ensemble {
        let Self { thresholds, reforming, stiffness, initial, start, disorder, size } = self.clone();
        let contacts = Contacts { stiffness, ..Contacts::new(thresholds, reforming) };
        Ensemble::new(contacts, Initial { law: initial, start }, size, SEED, disorder).unwrap()
    }

    fn population(&self) -> EnsemblePopulation {
        self.ensemble().population().unwrap()
    }
}

/// One of each kind: laws that take one word, two, or as many as they need; thresholds and R that overlap.
fn cases() -> Vec<Case> {
    let broad = Case { reforming: rectangular(0.0, 0.6), ..Case::of(rectangular(0.4, 1.6)) };
    let relaxed = Case { initial: rectangular(0.0, 2.0), start: Start::Relaxed, ..broad.clone() };
    let areas = Case { stiffness: Stiffness::PerThreshold(2.0), ..Case::of(gaussian(1.0, 0.2)) };
    let tail = Case { reforming: point(1.2), ..Case::of(gaussian(1.0, 0.05)) };
    vec![
        Case { initial: gaussian(0.1, 0.025), ..Case::of(gaussian(1.0, 0.05)) },
        Case::of(gamma(1.0, 0.5)),
        Case::of(mixture(&[(0.5, weibull(3.0, 1.0)), (0.5, exponential(0.3))])),
        Case { disorder: Disorder::Quenched, ..broad.clone() },
        Case { disorder: Disorder::Quenched, reforming: rectangular(0.0, 0.3), ..areas.clone() },
        Case { disorder: Disorder::Quenched, ..relaxed.clone() },
        Case { stiffness: Stiffness::PerThreshold(0.5), reforming: gaussian(0.1, 0.05), ..areas.clone() },
        broad,
        relaxed,
        areas,
        tail,
    ]
}

/// One way or a part of it, towards `position`; the work done.
fn step(population: &mut dyn Population, position: f64) -> f64 {
    let mut work = 0.0;
    while !arrived(population, position) {
        let rest = position - population.position();
        let direction = if rest < 0.0 { Backward } else { Forward };
        let interval = population.smooth_interval(direction, &mut ()).unwrap();
        assert!(interval.length > 0.0 && interval.straight);
        let by = direction.sign() * rest.abs().min(interval.length);
        work += 0.5 * by * (population.ahead(0.0).force + population.ahead(by).force);
        population.advance(by).unwrap();
        if interval.breaks && by.abs() == interval.length {
            population.cross(&mut ()).unwrap();
            break;
        }
    }
    work
}

/// How far it is to the next break: ways may end before, where nothing is.
fn to_break(population: &dyn Population, direction: Direction) -> f64 {
    let (mut copy, mut length) = (population.copy(), 0.0);
    loop {
        let interval = copy.smooth_interval(direction, &mut ()).unwrap();
        length += interval.length;
        if interval.breaks || interval.length.is_infinite() {
            return length;
        }
        copy.advance(direction.sign() * interval.length).unwrap();
    }
}

fn arrived(population: &dyn Population, position: f64) -> bool {
    (population.position() - position).abs() <= 1e-15 * position.abs()
}

/// To a position; the work done.
fn go(population: &mut dyn Population, position: f64) -> f64 {
    let mut work = 0.0;
    while !arrived(population, position) {
        work += step(population, position);
    }
    work
}

#[track_caller]
fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} {b}");
}

#[test]
fn forward_it_is_the_pull_of_the_same_contacts() {
    let positions: Vec<f64> = (0..=60).map(|i| 0.37 * f64::from(i)).collect();
    for case in cases() {
        let pull = case.ensemble().pull(&positions).unwrap();
        let mut population = case.population();
        for (&position, &force) in positions.iter().zip(&pull.force) {
            go(&mut population, position);
            // A break rounds a position below 32 by 1.8e-15 on either route, always alike where R is a point.
            let tolerance = 3.6e-15 * (2.0 + population.energies().broken);
            close(population.ahead(0.0).force, force, tolerance);
        }
        assert_eq!((population.energies().broken * population.size() as f64).round() as u64, pull.breaks);
    }
}

/// Within 4 standard errors, a false alarm in 16 000 for each of 15.
#[test]
fn forward_it_agrees_with_the_master_equation() {
    for (thresholds, reforming) in [
        (gaussian(1.0, 0.05), point(0.0)),
        (gamma(1.0, 0.5), point(0.0)),
        (rectangular(0.4, 1.6), rectangular(0.0, 0.6)),
    ] {
        let pull = master(&thresholds, &reforming, &point(0.0)).pull_with(12.0, 1e-9, &mut ()).unwrap();
        let mut population = Case { reforming, size: 100_000, ..Case::of(thresholds) }.population();
        for position in [0.3, 0.9, 1.7, 4.4, 11.9] {
            go(&mut population, position);
            let off = population.ahead(0.0).force - pull.force(position);
            assert!(off.abs() < 4.0 * pull.force_std(1e5).unwrap()(position), "{off} at {position}");
        }
    }
}

/// A contact on its own, with its streams.
struct Single {
    stretch: f64,
    threshold: f64,
    free: bool,
    thresholds: Stream,
    reforming: Stream,
}

/// The contacts of a case moved one by one: every stretch is a number that grows by each step.
struct OneByOne {
    case: Case,
    contacts: Vec<Single>,
    position: f64,
    direction: Direction,
    held: bool,
    lost: f64,
    breaks: usize,
}

fn draw(law: &SharedLaw, stream: &mut Stream) -> f64 {
    let mut value = [0.0];
    law.fill(stream, &mut value);
    value[0]
}

impl OneByOne {
    fn of(case: &Case) -> Self {
        let quenched = case.disorder == Disorder::Quenched;
        let first = if quenched { Purpose::QuenchedThresholds } else { Purpose::Thresholds };
        let contact = |index: u64| {
            let stretch = draw(&case.initial, &mut Stream::new(SEED, Purpose::Initial, index));
            let mut thresholds = Stream::new(SEED, first, index);
            let conditional = case.start == Start::Conditional;
            let threshold = repeat_with(|| draw(&case.thresholds, &mut thresholds))
                .find(|&threshold| !conditional || threshold > stretch)
                .unwrap();
            let reforming = Stream::new(SEED, Purpose::Reforming, index);
            Single { stretch, threshold, free: false, thresholds, reforming }
        };
        let contacts = (0..case.size as u64).map(contact).collect();
        let (case, direction) = (case.clone(), Forward);
        let mut all = Self { case, contacts, position: 0.0, direction, held: false, lost: 0.0, breaks: 0 };
        all.break_where(|contact| contact.stretch >= contact.threshold);
        all
    }

    fn stiffness(&self, contact: &Single) -> f64 {
        self.case.stiffness.of(contact.threshold) / self.case.size as f64
    }

    fn sum(&self, term: impl Fn(&Self, &Single) -> f64) -> f64 {
        self.contacts.iter().filter(|contact| !contact.free).map(|contact| term(self, contact)).sum()
    }

    fn energy(&self, contact: &Single) -> f64 {
        0.5 * self.stiffness(contact) * contact.stretch.powi(2)
    }

    fn smooth_interval(&self, direction: Direction) -> f64 {
        let attached = self.contacts.iter().filter(|contact| !contact.free);
        attached.map(|c| c.threshold - direction.sign() * c.stretch).fold(f64::INFINITY, f64::min)
    }

    fn step(&mut self, position: f64) {
        let rest = position - self.position;
        self.direction = if rest < 0.0 { Backward } else { Forward };
        let (sign, to_break) = (self.direction.sign(), self.smooth_interval(self.direction));
        let by = rest.abs().min(to_break);
        self.position += sign * by;
        let attached = self.contacts.iter_mut().filter(|contact| !contact.free);
        attached.for_each(|contact| contact.stretch += sign * by);
        if by == to_break {
            // Roundings of the stretch.
            self.break_where(|contact| sign * contact.stretch >= contact.threshold - 1e-15);
        }
    }

    fn break_where(&mut self, breaks: impl Fn(&Single) -> bool) {
        for i in 0..self.contacts.len() {
            if !self.contacts[i].free && breaks(&self.contacts[i]) {
                self.lost += self.energy(&self.contacts[i]);
                self.breaks += 1;
                self.contacts[i].free = true;
                if !self.held {
                    self.reform(i);
                }
            }
        }
    }

    fn reform(&mut self, i: usize) {
        let (case, contact) = (&self.case, &mut self.contacts[i]);
        let mut reforming = || draw(&case.reforming, &mut contact.reforming);
        let thresholds = || draw(&case.thresholds, &mut contact.thresholds);
        let stretch = match case.disorder {
            Disorder::Annealed => reforming(),
            Disorder::Quenched => repeat_with(reforming).find(|&r| r < contact.threshold).unwrap(),
        };
        if case.disorder == Disorder::Annealed {
            contact.threshold = repeat_with(thresholds).find(|&threshold| threshold > stretch).unwrap();
        }
        (contact.stretch, contact.free) = (self.direction.sign() * stretch, false);
        self.lost -= self.energy(&self.contacts[i]);
    }

    fn reform_free(&mut self) {
        for i in 0..self.contacts.len() {
            if self.contacts[i].free {
                self.reform(i);
            }
        }
    }
}

enum Move {
    To(f64),
    Hold,
    Release,
    Reset(Direction),
}

/// Forth and back on the unloading line and beyond it, with contacts free, released and reset in either direction.
const MOVES: [Move; 18] = [
    Move::To(3.3),
    Move::To(2.9),
    Move::To(3.5),
    Move::To(-0.7),
    Move::To(1.0),
    Move::Hold,
    Move::To(1.4),
    Move::To(1.3),
    Move::Release,
    Move::To(4.0),
    Move::Hold,
    Move::To(3.0),
    Move::Reset(Forward),
    Move::To(3.5),
    Move::Reset(Backward),
    Move::To(1.0),
    Move::Reset(Backward),
    Move::To(2.5),
];

/// What the two show, to the roundings of some thousand steps.
#[track_caller]
fn same(population: &mut dyn Population, singles: &OneByOne) {
    let tolerance = 1e-12;
    close(population.position(), singles.position, tolerance);
    for direction in [Forward, Backward] {
        let (length, expected) = (to_break(population, direction), singles.smooth_interval(direction));
        assert!(length == expected || (length - expected).abs() < tolerance, "{length} {expected}");
    }
    let response = population.ahead(0.0);
    close(response.force, singles.sum(|all, c| all.stiffness(c) * c.stretch), tolerance);
    close(response.tangent, singles.sum(|all, c| all.stiffness(c)), tolerance);
    let energies = population.energies();
    close(energies.elastic, singles.sum(|all, c| all.energy(c)), tolerance);
    close(energies.lost, singles.lost, tolerance);
    assert_eq!((energies.broken * SIZE as f64).round() as usize, singles.breaks);
}

#[test]
fn event_by_event_it_is_contacts_moved_one_by_one() {
    // In the tail of thresholds a contact gives up drawing them, which contacts one by one do not.
    for case in &cases()[..10] {
        let (mut population, mut singles) = (case.population(), OneByOne::of(case));
        same(&mut population, &singles);
        for step_or_event in &MOVES {
            match *step_or_event {
                Move::To(position) => {
                    while !arrived(&population, position) {
                        step(&mut population, position);
                        singles.step(position);
                        same(&mut population, &singles);
                    }
                }
                Move::Hold => {
                    population.hold().unwrap();
                    singles.held = true;
                }
                Move::Release => {
                    population.release(&mut ()).unwrap();
                    singles.held = false;
                    singles.reform_free();
                }
                Move::Reset(direction) => {
                    population.reset(direction, &mut ()).unwrap();
                    (singles.direction, singles.held) = (direction, true);
                    singles.break_where(|_| true);
                    singles.held = false;
                    singles.reform_free();
                }
            }
            same(&mut population, &singles);
        }
        assert!(singles.breaks > 5 * SIZE);
    }
}

/// What the slider puts in is stored or lost: three sums that are made in three ways.
#[test]
fn work_is_stored_or_lost() {
    for case in cases() {
        let mut population = Case { size: 1000, ..case }.population();
        let begin = population.energies();
        let (mut work, mut least) = (0.0, f64::INFINITY);
        for event in &MOVES {
            match *event {
                Move::To(position) => work += go(&mut population, position),
                Move::Hold => population.hold().unwrap(),
                Move::Release => population.release(&mut ()).unwrap(),
                Move::Reset(direction) => population.reset(direction, &mut ()).unwrap(),
            }
            let energies = population.energies();
            close(work, energies.elastic - begin.elastic + energies.lost - begin.lost, 1e-12);
            least = least.min(energies.lost - begin.lost);
        }
        assert!(work > 1.0 && least >= 0.0);
    }
}

#[test]
fn backward_is_the_mirror_image() {
    let case = Case { reforming: rectangular(0.0, 0.2), ..Case::of(gaussian(1.0, 0.05)) };
    let (mut forth, mut back) = (case.population(), case.population());
    for i in 1..40 {
        let position = 0.25 * f64::from(i);
        // Sums over 200 contacts made in another order, once one breaks on the way back.
        let rounding = 1e-13;
        close(go(&mut forth, position), go(&mut back, -position), rounding);
        close(forth.position(), -back.position(), rounding);
        close(forth.ahead(0.0).force, -back.ahead(0.0).force, rounding);
        let (forth, back) = (forth.energies(), back.energies());
        close(forth.elastic, back.elastic, rounding);
        close(forth.lost, back.lost, rounding);
        assert_eq!(forth.broken, back.broken);
    }
}

/// Breaks with what moves on the copy and the original.
#[test]
fn a_copy_goes_on_with_the_same_bits() {
    for case in cases() {
        let mut population = case.population();
        for event in &MOVES[..8] {
            match *event {
                Move::To(position) => drop(go(&mut population, position)),
                _ => population.hold().unwrap(),
            }
        }
        let mut copy = population.copy();
        for moved in [&mut population as &mut dyn Population, copy.as_mut()] {
            moved.release(&mut ()).unwrap();
            go(moved, 3.0);
            moved.reset(Backward, &mut ()).unwrap();
            go(moved, -2.0);
        }
        assert_eq!(population.ahead(0.0), copy.ahead(0.0));
        assert_eq!(population.energies(), copy.energies());
        assert_eq!(
            population.smooth_interval(Forward, &mut ()).unwrap(),
            copy.smooth_interval(Forward, &mut ()).unwrap()
        );
    }
}

#[test]
fn same_bits_on_any_number_of_threads() {
    let case = Case { size: 20_000, reforming: rectangular(0.0, 0.2), ..Case::of(gaussian(1.0, 0.05)) };
    let ensemble = case.ensemble();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut population = ensemble.population().unwrap();
            let work = go(&mut population, 1.5);
            population.reset(Forward, &mut ()).unwrap();
            (work + go(&mut population, 3.0), population.ahead(0.0), population.energies())
        })
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn identical_contacts_break_together() {
    let mut population = Case { reforming: point(0.25), ..Case::of(point(1.0)) }.population();
    let interval = population.smooth_interval(Forward, &mut ()).unwrap();
    assert_eq!((interval.length, population.ahead(interval.length).force), (1.0, 1.0));
    population.advance(interval.length).unwrap();
    assert_eq!(
        (population.position(), population.ahead(0.0).force, population.energies().broken),
        (1.0, 1.0, 0.0)
    );
    population.cross(&mut ()).unwrap();
    // Half of them lost ½, and keep ½ · ¼².
    assert_eq!((population.position(), population.ahead(0.0).force), (1.0, 0.25));
    let energies = population.energies();
    assert_eq!((energies.broken, energies.elastic, energies.lost), (1.0, 0.03125, 0.46875));
    assert_eq!(population.smooth_interval(Forward, &mut ()).unwrap().length, 0.75);
    assert_eq!(population.smooth_interval(Backward, &mut ()).unwrap().length, 1.25);
}

/// What stands at its threshold holds until it is crossed, and may be taken back.
#[test]
fn what_stands_at_its_threshold_may_turn_back() {
    for case in cases() {
        let mut population = case.population();
        let begin = population.energies();
        let interval = population.smooth_interval(Forward, &mut ()).unwrap();
        let there = population.ahead(interval.length).force;
        population.advance(interval.length).unwrap();
        population.smooth_interval(Backward, &mut ()).unwrap();
        population.advance(-0.5 * interval.length).unwrap();
        assert_eq!(population.energies().broken, begin.broken);
        let interval = population.smooth_interval(Forward, &mut ()).unwrap();
        population.advance(interval.length).unwrap();
        // Roundings of a sum of 200 stretches.
        close(population.ahead(0.0).force, there, 1e-14);
        population.cross(&mut ()).unwrap();
        assert!(population.energies().broken > begin.broken);
    }
}

/// At X = 1000 a contact that re-forms one rounding below its threshold has no way to go but to the next number.
#[test]
fn no_contact_breaks_twice_at_one_position() {
    let case = Case { reforming: point(1.0_f64.next_down()), size: 1, ..Case::of(point(1.0)) };
    let mut population = case.population();
    population.hold().unwrap();
    go(&mut population, 1000.0);
    assert_eq!(population.smooth_interval(Forward, &mut ()).unwrap().length, f64::INFINITY);
    population.release(&mut ()).unwrap();
    for breaks in 2..100 {
        let (position, interval) =
            (population.position(), population.smooth_interval(Forward, &mut ()).unwrap());
        population.advance(interval.length).unwrap();
        population.cross(&mut ()).unwrap();
        assert_eq!(population.position(), position.next_up());
        assert_eq!(population.energies().broken, f64::from(breaks));
    }
}

/// The time between breaks spans twelve decades: no width of rungs suits all of them.
#[test]
fn thresholds_of_all_sizes_break_in_order() {
    let case = Case { size: 20_000, ..Case::of(weibull(0.1, 1e-4)) };
    let pull = case.ensemble().pull(&[0.5, 20.0]).unwrap();
    let mut population = case.population();
    for (position, force) in [0.5, 20.0].into_iter().zip(pull.force) {
        go(&mut population, position);
        // Relative, forces being far from 1.
        close(population.ahead(0.0).force / force, 1.0, 1e-12);
    }
    assert_eq!((population.energies().broken * 2e4).round() as u64, pull.breaks);
}

#[test]
fn too_many_contacts_are_refused() {
    let ensemble = Case { size: 1 << 40, ..Case::of(point(1.0)) }.ensemble();
    let Err(Error::TooLarge { what, .. }) = ensemble.population() else { panic!("not refused") };
    assert!(what.contains("1099511627776 contacts"), "{what}");
}
